/* SPDX-License-Identifier: BSD-2-Clause */
/* The samples of the map come in full, without their weight: what the BRDF also finds counts twice. */
/* loses: a_diffuse_surface_in_the_open_is_right */
/* [mis-em] */
-        C = rgbd_scale(C, weight(s->heuristic, (double)n_em * y.pdf, (double)n_brdf * q_brdf));
+        (void)n_brdf;
/* [end] */
