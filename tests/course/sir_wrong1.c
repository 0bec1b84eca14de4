/* As printed (E23): w = f for candidates from the map, without the cosine. */
/* loses: weights_from_the_map_are_phat_over_q */
/* loses: weights_of_a_mixture_have_the_mixed_density */
/* loses: unbiased_for_one_candidate_and_one_ray */
/* loses: unbiased_for_few_candidates */
/* loses: unbiased_for_many_candidates */
/* loses: rays_add_no_noise_where_nothing_is_hidden */
/* [weigh-em] */
static void weigh_em(bis_candidate *c, const bis_point *pt, const bis_light_point *y, double beta)
{
    double q = y->pdf, cos_theta = bis_bsdf_cos(&pt->bsdf, y->wi), q_f;

    if (cos_theta <= 0) return;
    rgb f = bis_bsdf_f_pdf(&pt->bsdf, y->wi, &q_f);
    c->wi = y->wi;
    c->C = bis_estimate(f, y->Le, 1, beta * q + (1 - beta) * q_f);
    c->w = rgbd_sum(c->C);
}
/* [end] */
