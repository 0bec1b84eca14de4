/* f where the eye lies below the horizon, and a sine through the rounded cosine. */
/* loses: narrow_lobes_keep_their_precision */
/* loses: f_is_eq_3_14 */
/* [phong-density] */
static rgb f_pdf(const bis_bsdf *b, vec3 wi, double *pdf)
{
    const bis_material *m = b->material;
    double cos_theta = bis_bsdf_cos(b, wi);
    double lobe = b->p_specular > 0 ? bis_phong_lobe_pdf(b->r, wi, m->exponent) : 0;

    *pdf = b->p_specular * lobe + (1 - b->p_specular) * bis_warp_cosine_pdf(cos_theta);
    if (cos_theta <= 0) return (rgb){0, 0, 0};
    return rgb_from((double)m->Ks.r * lobe + (double)m->Kd.r * INV_PI, (double)m->Ks.g * lobe + (double)m->Kd.g * INV_PI,
                    (double)m->Ks.b * lobe + (double)m->Kd.b * INV_PI);
}
/* [end] */
/* [phong-lobe] */
static double lobe_direction(vec3 *wi, double n, double u1, double u2)
{
    double cos_theta = pow(1 - u1, 1 / (n + 1)), sin_theta = sqrt(1 - cos_theta * cos_theta);
    double phi = 2 * PI * u2;

    *wi = vec3_from(sin_theta * cos(phi), sin_theta * sin(phi), cos_theta);
    return log(cos_theta);
}
/* [end] */
