/* SPDX-License-Identifier: BSD-2-Clause */
/* The base without its 1/pi, and a sine through the rounded cosine. */
/* loses: narrow_lobes_keep_their_precision */
/* loses: f_is_eq_3_14 */
/* loses: the_albedo_comes_out_of_the_samples */
/* [phong-f] */
-        k.base[i] = (REAL)(Kd[i] * INV_PI / unit);
+        k.base[i] = (REAL)(Kd[i] / unit);
/* [end] */
/* [phong-lobe] */
-    const REAL one_minus_cos = OF(one_minus_exp)(OF(log1m)(u1) * inverse_n1);
-    const REAL sine = OF(sqrt)(one_minus_cos * (2 - one_minus_cos));
+    const REAL cos_theta = OF(exp)(OF(log1m)(u1) * inverse_n1), sine = OF(sqrt)(1 - cos_theta * cos_theta);
-    return (OF(direction)){sine * c, sine * s, 1 - one_minus_cos};
+    return (OF(direction)){sine * c, sine * s, cos_theta};
/* [end] */
