/* SPDX-License-Identifier: BSD-2-Clause */
/* Uniform in theta instead of in its cosine: directions crowd at the poles. */
/* loses: directions_are_uniform_in_solid_angle */
/* loses: directions_are_drawn_from_alias_tables */
/* loses: directions_are_drawn_from_cdfs */
/* [patch] */
-    /* From the nearer pole: the cosines of its side's edges, 1 at the pole. Where 1 - near is small, it is exact
-     * (Sterbenz). */
-    const bool north = 2 * y < em->height;
-    const double near = north ? em->cos_edge[y] : -em->cos_edge[y + 1];
-    const double far = north ? em->cos_edge[y + 1] : -em->cos_edge[y];
-    const double h = (1 - near) + (north ? u2 : 1 - u2) * (near - far);
-    *sin_theta = sqrt(h * (2 - h));
-    *cos_theta = north ? 1 - h : h - 1;
+    const double theta = PI * (y + u2) / em->height;
+    *sin_theta = sin(theta);
+    *cos_theta = cos(theta);
/* [end] */
