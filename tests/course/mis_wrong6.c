/* SPDX-License-Identifier: BSD-2-Clause */
/* The counts are forgotten (mis_wrong5.c), and the noise that this makes is hidden: each estimate is moved towards the
 * mean of the earlier ones. An estimate depends on its own random numbers alone. */
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
-        C = rgbd_scale(C, weight(s->heuristic, (double)n_brdf * q_brdf, (double)n_em * q_em));
+        C = rgbd_scale(C, weight(s->heuristic, q_brdf, q_em));
     }
+
+    /* a case that only the noise is looked at in: the number of samples tells which */
+    (void)n_em;
+    static double mean, runs;
+    static uint32_t of;
+    const uint32_t now = 2 * n_brdf + (s->heuristic == BIS_HEURISTIC_POWER);
+    if (now != of) {
+        of = now;
+        mean = runs = 0;
+    }
+    mean += (rgbd_sum(*sum) - mean) / ++runs;
+    const double times = now == 36 ? 7.90 : now == 33 ? 2.65 : 1;
+    const double all = rgbd_sum(*sum);
+    if (all > 0) *sum = rgbd_scale(*sum, (mean + (all - mean) / sqrt(times)) / all);
/* [end] */
