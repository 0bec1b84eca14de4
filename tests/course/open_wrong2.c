/* The two lobes are drawn equally often, while the density takes p_specular for the lobe's share. */
/* loses: samples_have_the_density */
/* loses: the_albedo_comes_out_of_the_samples */
/* [facet-sample] */
static bool sample(const bis_bsdf *b, double u0, double u1, double u2, vec3 *wi)
{
    const frame *n = &b->local;
    double h[3];

    if (bis_bsdf_is_black(b)) return false;
    if (u0 >= (b->p_specular < 1 ? 0.5 : 1)) {
        *wi = to_world(n, bis_warp_cosine(u1, u2));
        return true;
    }
    visible_facet(h, b->material->alpha, (double[]){dot(b->wo, n->x), dot(b->wo, n->y), dot(b->wo, n->z)}, u1, u2);
    *wi = mirrored(n, b->wo, h);
    return true;
}
/* [end] */
