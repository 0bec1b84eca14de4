/* The cosine for all, with its own density: a density that is drawn, but not the one that was asked for. */
/* loses: the_density_is_q_and_integrates_to_1 */
/* loses: samples_have_the_density */
/* [phong-density] */
static rgb f_pdf(const bis_bsdf *b, vec3 wi, double *pdf)
{
    const bis_material *m = b->material;
    double cos_theta = bis_bsdf_cos(b, wi);
    double lobe = b->p_specular > 0 ? bis_phong_lobe_pdf(b->r, wi, m->exponent) : 0;

    *pdf = bis_warp_cosine_pdf(cos_theta);
    if (cos_theta <= 0 || bis_bsdf_cos(b, b->wo) <= 0) return (rgb){0, 0, 0};
    return rgb_from((double)m->Ks.r * lobe + (double)m->Kd.r * INV_PI, (double)m->Ks.g * lobe + (double)m->Kd.g * INV_PI,
                    (double)m->Ks.b * lobe + (double)m->Kd.b * INV_PI);
}
/* [end] */
/* [phong-sample] */
static bool sample(const bis_bsdf *b, double u0, double u1, double u2, vec3 *wi)
{
    if (rgb_is_black(b->material->Kd) && rgb_is_black(b->material->Ks)) return false;
    (void)u0;
    *wi = to_world(&b->local, bis_warp_cosine(u1, u2));
    return true;
}
/* [end] */
