/* SPDX-License-Identifier: BSD-2-Clause */
/* The cosine for all, with its own density: a density that is drawn, but not the one that was asked for. */
/* loses: the_density_is_q_and_integrates_to_1 */
/* loses: samples_have_the_density */
/* [phong-f] */
-                   .pdf_lobe = (real)(p * peak), .pdf_base = (real)((1 - p) * INV_PI), .kind = p > 0};
+                   .pdf_lobe = 0, .pdf_base = (real)INV_PI, .kind = p > 0};
/* [end] */
/* [phong-draw] */
FORMULA direction draw(const draws *k, int specular, real u1, real u2)
{
    (void)specular;
    return turned(&k->local, cosine(u1, u2));
}
/* [end] */
