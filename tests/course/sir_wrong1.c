/* SPDX-License-Identifier: BSD-2-Clause */
/* As printed (E23): w = f Le/q, without the cosine. */
/* loses: weights_from_the_map_are_phat_over_q */
/* loses: weights_from_the_brdf_are_phat_over_q */
/* loses: weights_of_a_mixture_have_the_mixed_density */
/* [weigh] */
-        const float phat = f.cos[i] * (F_r[i] + F_g[i] + F_b[i]), q = beta_map * x.q[i] + beta_f * f.q[i];
-        /* where q is 0, as at a black pixel outside the lobe, phat is 0, too */
+        const float phat = F_r[i] + F_g[i] + F_b[i], q = beta_map * x.q[i] + beta_f * f.q[i];
/* [end] */
