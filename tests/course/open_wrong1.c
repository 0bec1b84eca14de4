/* The cosine for all: a density, and the one that is drawn, but noisy; the bound is still the other one's. */
/* loses: the_bound_of_rejection_holds */
/* loses: it_is_less_noisy_than_the_cosine */
/* loses: it_is_nearly_as_good_as_visible_normals */
/* [facet-density] */
static rgb f_pdf(const bis_bsdf *b, vec3 wi, double *pdf)
{
    const double a = b->material->alpha, c_i = bis_bsdf_cos(b, wi), c_o = bis_bsdf_cos(b, b->wo);
    double D = 0, cos_d = 0;

    *pdf = 0;
    if (c_o <= 0) return (rgb){0, 0, 0};
    const double S_o = stretched(a, c_o);
    if (b->p_specular > 0) facet_between(b, wi, c_i + c_o, &D, &cos_d);
    *pdf = bis_warp_cosine_pdf(c_i);
    if (c_i < least_cos || c_o < least_cos) return (rgb){0, 0, 0};
    const double specular = D / (2 * (c_i * S_o + c_o * stretched(a, c_i)));
    const double base = base_norm * INV_PI * through_coat(b->material, c_i) * through_coat(b->material, c_o);
    return rgbd_round(blend(b->material, cos_d, specular, base));
}
/* [end] */
/* [facet-sample] */
static bool sample(const bis_bsdf *b, double u0, double u1, double u2, vec3 *wi)
{
    (void)u0, (void)visible_facet, (void)mirrored;
    if (bis_bsdf_is_black(b)) return false;
    *wi = to_world(&b->local, bis_warp_cosine(u1, u2));
    return true;
}
/* [end] */
