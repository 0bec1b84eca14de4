/* [weigh-em] */
static void weigh_em(bis_candidate *c, const bis_point *pt, const bis_light_point *y, double beta)
{
    /* Yours to write: c->wi, c->C = F/q, c->w = C.r + C.g + C.b. c->w is 0 as you get it, and stays so below the horizon. Of use: bis_bsdf_cos, bis_bsdf_f,
     * bis_bsdf_f_pdf, bis_estimate. */
    (void)c, (void)pt, (void)y, (void)beta;
}
/* [end] */
/* [weigh-brdf] */
static void weigh_brdf(bis_candidate *c, const bis_point *pt, vec3 wi, double beta)
{
    /* Yours to write. Of use, besides: bis_light_Le, bis_light_Le_pdf. */
    (void)c, (void)pt, (void)wi, (void)beta;
}
/* [end] */
/* [resample] */
void bis_candidates_resample(uint32_t *chosen, uint32_t N, const bis_candidate *c, uint32_t M, double W,
                             bis_resampling resampling, bis_stream *stream)
{
    /* Yours to write: chosen[N], in proportion to the weights. Of use: bis_marks_start, bis_marks_next, N marks in [0,1), ascending. Here the first candidate
     * with a weight is chosen N times, which keeps the program alive. */
    uint32_t first = 0;

    (void)W, (void)resampling, (void)stream;
    while (first + 1 < M && c[first].w <= 0) first++;
    for (uint32_t j = 0; j < N; j++) chosen[j] = first;
}
/* [end] */
    /* [sir-estimate] */
    /* Yours to write: choose N of x[M], trace them, put Zhat before the sum. Of use: bis_candidates_resample, bis_candidates_trace. */
    double Zhat = W / M;
    rgbd L = {0, 0, 0};
    (void)N;
    /* [end] */
