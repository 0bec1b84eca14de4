/* SPDX-License-Identifier: BSD-2-Clause */
/* [weigh] */
BIS_LANES
static void weigh(float *restrict w, float *restrict F_r, float *restrict F_g, float *restrict F_b,
                  const bis_lanes *candidates, const bis_reflected *reflected, float beta_map, float beta_f, uint32_t n)
{
    /* Yours to write, for each i < n: F = f Le in F_r[i], F_g[i], F_b[i], and the weight in w[i]. The candidates hold
     * Le in r, g, b and q_L in q; f, cos theta and q_f are in reflected. The cosine stands beside F and not in it. */
    (void)candidates, (void)reflected, (void)beta_map, (void)beta_f;
    for (uint32_t i = 0; i < n; i++) w[i] = F_r[i] = F_g[i] = F_b[i] = 0;
}
/* [end] */
/* [choose] */
BIS_LANES
static uint32_t choose_systematic(uint32_t *restrict item, uint32_t *restrict times, const float *restrict w,
                                  const float *restrict sum, uint32_t n_blocks, uint32_t N, double W, double offset)
{
    /* Yours to write: N marks, (j + offset)/N of W, on the running sum of the weights w[16 n_blocks]. item[k] and
     * times[k] > 0: which candidate got marks, in ascending order, and how many. The result is the number of such
     * items. sum[] has the sum of each block of 16 weights; a walk over all weights does not need it. Here the first
     * candidate with a weight gets all marks, which keeps the program alive. */
    uint32_t first = 0;

    (void)sum, (void)W, (void)offset, (void)marks_below;
    while (first + 1 < BLOCK * n_blocks && w[first] <= 0) first++;
    item[0] = first;
    times[0] = N;
    return 1;
}
/* [end] */
/* [choose-multinomial] */
void bis_choose_multinomial(bis_choice *c, uint32_t N, double W, bis_stream *stream)
{
    /* Yours to write: the same for N independent marks. c->w[c->n] holds the weights; c->item, c->times and c->n_chosen
     * are the result. Of use: next_mark, which gives the marks in ascending order, and add_mark. Here, too, the first
     * candidate with a weight gets all marks. */
    uint32_t first = 0;

    (void)W, (void)stream, (void)next_mark;
    while (first + 1 < c->n && c->w[first] <= 0) first++;
    c->n_chosen = 0;
    for (uint32_t j = 0; j < N; j++) add_mark(c, first);
}
/* [end] */
    /* [sir-estimate] */
    /* Yours to write: choose N candidates, and put into L what they are worth. Of use: bis_set_choose,
     * bis_set_trace. The line that is there belongs between the two: it makes an erratum of the thesis, if the
     * command line asks for it. */
    (void)N;
    if (s->as_printed & BIS_E6) bis_as_printed_colours(set);
    /* [end] */
