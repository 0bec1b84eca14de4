/* SPDX-License-Identifier: BSD-2-Clause */
/* n where eq. 3.16 has n + 1, and a sine from the rounded cosine. */
/* loses: the_lobe_is_drawn_by_eq_3_16 */
/* loses: narrow_lobes_keep_their_precision */
/* [phong-lobe] */
-    const REAL one_minus_cos = OF(one_minus_exp)(OF(log1m)(u1) * inverse_n1);
-    const REAL sine = OF(sqrt)(one_minus_cos * (2 - one_minus_cos));
+    const REAL n = 1 / inverse_n1 - 1, cos_theta = OF(exp)(OF(log1m)(u1) / OF(choose)(n > 0, n, 1));
+    const REAL sine = OF(sqrt)(1 - cos_theta * cos_theta);
-    return (OF(direction)){sine * c, sine * s, 1 - one_minus_cos};
+    return (OF(direction)){sine * c, sine * s, cos_theta};
/* [end] */
