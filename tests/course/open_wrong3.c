/* A bound that is none of use; the base drawn where u0 is small, on which proposals do not count. */
/* loses: samples_have_the_density */
/* loses: the_bound_of_rejection_holds */
/* [facet-sample] */
static bool sample(const bis_bsdf *b, double u0, double u1, double u2, vec3 *wi)
{
    const frame *n = &b->local;
    double h[3];

    if (bis_bsdf_is_black(b)) return false;
    if (u0 < 1 - b->p_specular) {
        *wi = to_world(n, bis_warp_cosine(u1, u2));
        return true;
    }
    visible_facet(h, b->material->alpha, (double[]){dot(b->wo, n->x), dot(b->wo, n->y), dot(b->wo, n->z)}, u1, u2);
    *wi = mirrored(n, b->wo, h);
    return true;
}
/* [end] */
/* [facet-bound] */
static double max_ratio(const bis_bsdf *b)
{
    const double A = through_coat(b->material, fmax(0, bis_bsdf_cos(b, b->wo))) * through_coat(b->material, 1);
    const rgbd F = most_fresnel(b), Kd = blend(b->material, 1, 0, base_norm * A);
    const double specular = b->p_specular > 0 ? fmax(F.r, fmax(F.g, F.b)) / b->p_specular : 0;
    const double diffuse = b->p_specular < 1 ? fmax(Kd.r, fmax(Kd.g, Kd.b)) / (1 - b->p_specular) : 0;

    return fmax(specular, diffuse) * 1e30;
}
/* [end] */
