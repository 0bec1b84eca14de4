/* n where eq. 3.16 has n + 1, and a sine from the rounded cosine. */
/* loses: the_lobe_is_drawn_by_eq_3_16 */
/* loses: narrow_lobes_keep_their_precision */
/* loses: samples_have_the_density */
/* loses: the_albedo_comes_out_of_the_samples */
/* [phong-lobe] */
static double lobe_direction(vec3 *wi, double n, double u1, double u2)
{
    double cos_theta = n > 0 ? pow(1 - u1, 1 / n) : 1 - u1, sin_theta = sqrt(1 - cos_theta * cos_theta);
    *wi = vec3_from(sin_theta * cos(2 * PI * u2), sin_theta * sin(2 * PI * u2), cos_theta);
    return log(cos_theta);
}
/* [end] */
