/* SPDX-License-Identifier: BSD-2-Clause */
/* n where eq. 3.16 has n + 1, and a sine from the rounded cosine. */
/* loses: the_lobe_is_drawn_by_eq_3_16 */
/* loses: narrow_lobes_keep_their_precision */
/* [phong-lobe] */
-    const real one_minus_cos = one_minus_exp(log1m(u1) * inverse_n1);
-    const real sine = root(one_minus_cos * (2 - one_minus_cos));
+    const real n = 1 / inverse_n1 - 1, cos_theta = exp_of(log1m(u1) / choose(n > 0, n, 1));
+    const real sine = root(1 - cos_theta * cos_theta);
-    return (direction){sine * c, sine * s, 1 - one_minus_cos};
+    return (direction){sine * c, sine * s, cos_theta};
/* [end] */
