/* SPDX-License-Identifier: BSD-2-Clause */
/* With CDFs, too, the place in a pixel is told by u[2] and u[3]; the density of the intensities, without their weights.
 */
/* loses: the_density_is_the_intensity_over_the_power */
/* loses: directions_are_drawn_from_cdfs */
/* [density] */
-    return im->total > 0 ? bis_weight(&im->weights, pixel) / im->total : 0;
+    return im->total > 0 ? (double)rgb_sum(im->weights.em->pixels[pixel]) / im->total : 0;
/* [end] */
/* [two-passes] */
-        d.u[0] = u[2];
-        d.u[1] = u[3];
-        d.y = bis_cdf_sample(&t->row_cdf, u[0], &d.u[1]);
-        d.x = bis_cdf_sample(&t->columns[d.y], u[1], &d.u[0]);
+        d.y = bis_cdf_sample(&t->row_cdf, u[0], NULL);
+        d.x = bis_cdf_sample(&t->columns[d.y], u[1], NULL);
     }
+    d.u[0] = u[2];
+    d.u[1] = u[3];
/* [end] */
