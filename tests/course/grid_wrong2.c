/* SPDX-License-Identifier: BSD-2-Clause */
/* Nothing guards a component of 0, and a walk upwards ends one cell early. */
/* loses: small_triangles_from_outside_are_met */
/* loses: small_triangles_from_inside_are_met */
/* loses: the_nearest_of_large_triangles_is_found */
/* loses: only_the_cells_on_the_way_are_looked_at */
/* loses: rays_along_an_axis_are_met */
/* loses: the_last_cell_is_visited */
/* loses: far_origins_are_met */
/* [grid-axis] */
-    if (d == 0) return (axis){(double)INFINITY, 0, 0, 0};
-    return (axis){(wall - p) / d, g->cell[a] / fabs(d), d > 0 ? stride : -stride, d > 0 ? n - 1 - i : i};
+    return (axis){
+        (wall - p) / d, g->cell[a] / fabs(d), d > 0 ? stride : -stride, d > 0 ? (i < n - 1 ? n - 2 - i : 0) : i};
/* [end] */
