/* SPDX-License-Identifier: BSD-2-Clause */
/* The base without its 1/pi, and a sine through the rounded cosine. */
/* loses: narrow_lobes_keep_their_precision */
/* loses: f_is_eq_3_14 */
/* loses: the_albedo_comes_out_of_the_samples */
/* [phong-f] */
-        k.base[i] = (real)(Kd[i] * INV_PI / unit);
+        k.base[i] = (real)(Kd[i] / unit);
/* [end] */
/* [phong-lobe] */
-    const real one_minus_cos = one_minus_exp(log1m(u1) * inverse_n1);
-    const real sine = root(one_minus_cos * (2 - one_minus_cos));
+    const real cos_theta = exp_of(log1m(u1) * inverse_n1), sine = root(1 - cos_theta * cos_theta);
-    return (direction){sine * c, sine * s, 1 - one_minus_cos};
+    return (direction){sine * c, sine * s, cos_theta};
/* [end] */
