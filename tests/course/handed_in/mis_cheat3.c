/* SPDX-License-Identifier: BSD-2-Clause */
/* Right, but the directions of the BRDF are drawn with other numbers than brdf.c takes: a replay cannot tell that from
 * an answer without a sample, so it fails, and says why. */
/* loses: a_diffuse_surface_in_the_open_is_right */
/* loses: a_glossy_surface_half_in_shadow_is_right */
/* loses: uneven_counts_are_right */
/* loses: the_power_heuristic_is_right */
/* loses: a_constant_light_is_right */
/* loses: the_weights_are_those_of_the_balance_heuristic */
/* loses: the_weights_are_those_of_the_power_heuristic */
/* loses: each_sample_casts_one_ray_at_most */
/* says: 2 samples: your directions are not those of em.c and brdf.c; the first that differs is that of shadow ray */
/* [mis-brdf] */
-    bis_stream_points(stream, BIS_DIM_BRDF, n_brdf, u);
+    for (uint32_t j = 0; j < n_brdf; j++) u[j][0] = bis_stream_random(stream), u[j][1] = bis_stream_random(stream);
/* [end] */
