/* Each candidate by its own density, not the mixture's; marks that are random but not in proportion: every candidate with a weight has the same chance. */
/* loses: weights_of_a_mixture_have_the_mixed_density */
/* loses: candidates_are_chosen_in_proportion_to_their_weights */
/* loses: multinomial_choices_are_independent */
/* loses: unbiased_for_few_candidates */
/* loses: unbiased_for_many_candidates */
/* [weigh-brdf] */
static void weigh_brdf(bis_candidate *c, const bis_point *pt, vec3 wi, double beta)
{
    double q, cos_theta = bis_bsdf_cos(&pt->bsdf, wi);

    (void)beta;
    if (cos_theta <= 0) return;
    rgb f = bis_bsdf_f_pdf(&pt->bsdf, wi, &q);
    if (q <= 0) return;
    c->wi = wi;
    c->C = bis_estimate(f, bis_light_Le(pt->light, wi), cos_theta, q);
    c->w = rgbd_sum(c->C);
}
/* [end] */
/* [resample] */
void bis_candidates_resample(uint32_t *chosen, uint32_t N, const bis_candidate *c, uint32_t M, double W,
                             bis_resampling resampling, bis_stream *stream)
{
    bis_marks marks = bis_marks_start(resampling, N, stream);
    uint32_t n = 0, j = 0;

    (void)W;
    for (uint32_t i = 0; i < M; i++) n += c[i].w > 0;
    double mark = bis_marks_next(&marks, stream) * n, seen = 0;
    for (uint32_t i = 0; i < M && j < N; i++) {
        if (c[i].w <= 0) continue;
        seen++;
        while (j < N && mark < seen) {
            chosen[j++] = i;
            if (j < N) mark = bis_marks_next(&marks, stream) * n;
        }
    }
}
/* [end] */
