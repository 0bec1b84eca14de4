/* SPDX-License-Identifier: BSD-2-Clause */
/* The cosine for all, with its own density: a density that is drawn, but not the one that was asked for. */
/* loses: the_density_is_q_and_integrates_to_1 */
/* loses: samples_have_the_density */
/* [phong-f] */
-                       .pdf_lobe = (REAL)(p * peak), .pdf_base = (REAL)((1 - p) * INV_PI), .kind = p > 0};
+                       .pdf_lobe = 0, .pdf_base = (REAL)INV_PI, .kind = p > 0};
/* [end] */
/* [phong-draw] */
FORMULA OF(direction) OF(draw)(const OF(draws) *k, int specular, REAL u1, REAL u2)
{
    (void)specular;
    return OF(turned)(&k->local, OF(cosine)(u1, u2));
}
/* [end] */
