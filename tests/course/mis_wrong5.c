/* SPDX-License-Identifier: BSD-2-Clause */
/* The counts are forgotten, and nothing else: h = q_1/(q_1 + q_2). Where the counts are equal it is right. */
/* loses: uneven_counts_are_right */
/* loses: the_weights_are_those_of_the_balance_heuristic */
/* loses: the_weights_are_those_of_the_power_heuristic */
/* [mis-em] */
-    const bis_em_samples samples = bis_em_samples_start(n_em, s, stream, scratch);
+    (void)n_brdf;
+    const bis_em_samples samples = bis_em_samples_start(n_em, s, stream, scratch);
-        C = rgbd_scale(C, weight(s->heuristic, (double)n_em * y.pdf, (double)n_brdf * q_brdf));
+        C = rgbd_scale(C, weight(s->heuristic, y.pdf, q_brdf));
/* [end] */
/* [mis-brdf] */
-    bis_stream_points(stream, BIS_DIM_BRDF, n_brdf, u);
+    (void)n_em;
+    bis_stream_points(stream, BIS_DIM_BRDF, n_brdf, u);
-        C = rgbd_scale(C, weight(s->heuristic, (double)n_brdf * q_brdf, (double)n_em * q_em));
+        C = rgbd_scale(C, weight(s->heuristic, q_brdf, q_em));
/* [end] */
