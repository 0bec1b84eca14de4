/* [phong-lobe] */
static double lobe_direction(vec3 *wi, double n, double u1, double u2)
{
    /* Yours to write. */
    (void)n, (void)u1, (void)u2;
    *wi = (vec3){0, 0.6f, 0.8f};
    return 0;
}
/* [end] */
/* [phong-density] */
static rgb f_pdf(const bis_bsdf *b, vec3 wi, double *pdf)
{
    /* Yours to write: the density of the mixture at wi into *pdf, f as the result. Of use: bis_phong_lobe_pdf, bis_warp_cosine_pdf, bis_bsdf_cos. */
    (void)b, (void)wi;
    *pdf = 1;
    return (rgb){0, 0, 0};
}
/* [end] */
/* [phong-sample] */
static bool sample(const bis_bsdf *b, double u0, double u1, double u2, vec3 *wi)
{
    /* Yours to write: the lobe where u0 < b->p_specular, else the cosine. False: the material is black. */
    (void)b, (void)u0, (void)u1, (void)u2, (void)lobe_direction;
    *wi = (vec3){0, 0, 1};
    return false;
}
/* [end] */
