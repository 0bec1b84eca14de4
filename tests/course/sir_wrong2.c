/* SPDX-License-Identifier: BSD-2-Clause */
/* Every candidate by the map's density, as if all had come from there; marks that are random but not in proportion:
 * every candidate with a weight has the same chance. */
/* loses: weights_from_the_brdf_are_phat_over_q */
/* loses: weights_of_a_mixture_have_the_mixed_density */
/* loses: candidates_are_chosen_in_proportion_to_their_weights */
/* loses: unbiased_for_few_candidates */
/* loses: unbiased_for_many_candidates */
/* [weigh] */
BIS_LANES
static void weigh(float *restrict w, float *restrict F_r, float *restrict F_g, float *restrict F_b,
                  const bis_lanes *candidates, const bis_reflected *reflected, float beta_L, float beta_f, uint32_t n)
{
    const bis_lanes x = *candidates;
    const bis_reflected f = *reflected;

    (void)beta_L, (void)beta_f;
    for (uint32_t i = 0; i < n; i++) {
        F_r[i] = f.r[i] * x.r[i];
        F_g[i] = f.g[i] * x.g[i];
        F_b[i] = f.b[i] * x.b[i];
        w[i] = f.cos[i] > 0 && x.q[i] > 0 ? f.cos[i] * (F_r[i] + F_g[i] + F_b[i]) / x.q[i] : 0;
    }
}
/* [end] */
/* [choose] */
BIS_LANES
static uint32_t choose_systematic(uint32_t *restrict item, uint32_t *restrict times, const float *restrict w,
                                  const float *restrict sum, uint32_t n_blocks, uint32_t N, double W, double offset)
{
    uint32_t n = 0, j = 0, positive = 0;
    double seen = 0;

    (void)sum, (void)W, (void)marks_below;
    for (uint32_t i = 0; i < BLOCK * n_blocks; i++) positive += w[i] > 0;
    for (uint32_t i = 0; i < BLOCK * n_blocks; i++) {
        if (w[i] <= 0) continue;
        seen++;
        const uint32_t before = j;
        while (j < N && (j + offset) / N * positive < seen) j++;
        if (j > before) {
            item[n] = i;
            times[n++] = j - before;
        }
    }
    return n;
}
/* [end] */
