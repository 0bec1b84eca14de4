/* What falls below the horizon is thrown away, although the density counts it (E34). */
/* loses: samples_have_the_density */
/* loses: the_albedo_comes_out_of_the_samples */
/* [phong-sample] */
static bool sample(const bis_bsdf *b, double u0, double u1, double u2, vec3 *wi)
{
    vec3 local;

    if (rgb_is_black(b->material->Kd) && rgb_is_black(b->material->Ks)) return false;
    if (u0 < b->p_specular) {
        lobe_direction(&local, b->material->exponent, u1, u2);
        *wi = to_world(&b->lobe, local);
    } else {
        local = bis_warp_cosine(u1, u2);
        *wi = to_world(&b->local, local);
    }
    return bis_bsdf_cos(b, *wi) > 0;
}
/* [end] */
