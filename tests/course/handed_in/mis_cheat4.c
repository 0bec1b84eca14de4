/* SPDX-License-Identifier: BSD-2-Clause */
/* All is right, but the samples of the BRDF cast no ray after the first 3000 estimates: faster, and right in the open.
 * It has no points for speed, because the load is half in shadow. */
/* [mis-brdf] */
-    bis_stream_points(stream, BIS_DIM_BRDF, n_brdf, u);
+    static uint64_t runs;
+    runs++;
+    bis_stream_points(stream, BIS_DIM_BRDF, n_brdf, u);
-        bis_point_add(sum, pt, wi, C, NULL);
+        if (runs > 3000)
+            *sum = rgbd_add(*sum, C);
+        else
+            bis_point_add(sum, pt, wi, C, NULL);
/* [end] */
