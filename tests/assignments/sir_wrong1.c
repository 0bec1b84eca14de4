/* As printed (E23): w = f for candidates from the map, without the cosine. */
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
