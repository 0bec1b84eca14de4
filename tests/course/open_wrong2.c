/* SPDX-License-Identifier: BSD-2-Clause */
/* All facets are drawn, not those that the eye sees. */
/* loses: samples_have_the_density */
/* loses: the_albedo_comes_out_of_the_samples */
/* [facet-draw] */
-    const real hx = k->a * (sine * c + k->v[0]), hy = k->a * (sine * s + k->v[1]), hz = (1 - u1) * k->t;
+    const real hx = k->a * (sine * c), hy = k->a * (sine * s), hz = (1 - u1) * k->t;
/* [end] */
