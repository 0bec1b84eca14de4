/* SPDX-License-Identifier: BSD-2-Clause */
/* A bound that is of no use; the base drawn where the lobe is due, on which proposals count. */
/* loses: samples_have_the_density */
/* loses: the_albedo_comes_out_of_the_samples */
/* loses: the_bound_of_rejection_holds */
/* [facet-draw] */
-FORMULA direction draw(const draws *k, int specular, real u1, real u2)
+FORMULA direction draw(const draws *k, int is_specular, real u1, real u2)
 {
+    const int specular = !is_specular;
/* [end] */
/* [facet-bound] */
-    return fmax(specular, diffuse) * unit_slack;
+    return fmax(specular, diffuse) * 1e30;
/* [end] */
