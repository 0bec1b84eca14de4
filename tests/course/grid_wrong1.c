/* SPDX-License-Identifier: BSD-2-Clause */
/* The first cell with a hit ends the walk, although the hit may lie in a later cell, with a nearer one before it. */
/* loses: small_triangles_from_outside_are_met */
/* loses: small_triangles_from_inside_are_met */
/* loses: the_nearest_of_large_triangles_is_found */
/* loses: rays_along_an_axis_are_met */
/* loses: tmax_ends_the_ray */
/* loses: far_origins_are_met */
/* [grid-walk] */
             if (test_cell(g, cell, leaves, s, any)) return true;
+            if (s->best.prim != BIS_NO_PRIM) return false;
/* [end] */
