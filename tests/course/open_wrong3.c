/* SPDX-License-Identifier: BSD-2-Clause */
/* A bound that is of no use; the base drawn where the lobe is due, on which proposals count. */
/* loses: samples_have_the_density */
/* loses: the_albedo_comes_out_of_the_samples */
/* loses: the_bound_of_rejection_holds */
/* [facet-draw] */
-FORMULA OF(direction) OF(draw)(const OF(draws) *k, int specular, REAL u1, REAL u2)
+FORMULA OF(direction) OF(draw)(const OF(draws) *k, int is_specular, REAL u1, REAL u2)
 {
+    const int specular = !is_specular;
/* [end] */
/* [facet-bound] */
-    return fmax(specular, diffuse) * unit_slack;
+    return fmax(specular, diffuse) * 1e30;
/* [end] */
