/* [facet-density] */
static rgb f_pdf(const bis_bsdf *b, vec3 wi, double *pdf)
{
    const double a = b->material->alpha, c_i = bis_bsdf_cos(b, wi), c_o = bis_bsdf_cos(b, b->wo);
    double D = 0, cos_d = 0;

    *pdf = 1;
    if (c_o <= 0) return (rgb){0, 0, 0};
    const double S_o = stretched(a, c_o);
    if (b->p_specular > 0) facet_between(b, wi, c_i + c_o, &D, &cos_d);
    /* Yours to write: the density of what `sample` draws, at wi. The rest of this function is f, and right. */
    *pdf = 1;
    if (c_i < least_cos || c_o < least_cos) return (rgb){0, 0, 0};
    const double specular = D / (2 * (c_i * S_o + c_o * stretched(a, c_i)));
    const double base = base_norm * INV_PI * through_coat(b->material, c_i) * through_coat(b->material, c_o);
    return rgbd_round(blend(b->material, cos_d, specular, base));
}
/* [end] */
/* [facet-visible] */
/* Yours to write: what `sample` needs, if anything. Ours stood here: the head of this file derives it. */
/* [end] */
/* [facet-sample] */
static bool sample(const bis_bsdf *b, double u0, double u1, double u2, vec3 *wi)
{
    /* Yours to write: wi from three uniform numbers; the lobe where u0 < b->p_specular, as proposals count on it. */
    (void)u0, (void)u1, (void)u2;
    *wi = b->local.z;
    return false;
}
/* [end] */
/* [facet-bound] */
static double max_ratio(const bis_bsdf *b)
{
    /* Yours to write: a bound of f cos/pdf over all wi. Of use: most_fresnel. */
    (void)b;
    return 0;
}
/* [end] */
