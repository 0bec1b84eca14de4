/* SPDX-License-Identifier: BSD-2-Clause */
/* Every candidate by the map's density, as if all had come from there; marks that are random but not in proportion:
 * every candidate with a weight has the same chance. */
/* loses: weights_from_the_brdf_are_phat_over_q */
/* loses: weights_of_a_mixture_have_the_mixed_density */
/* loses: candidates_are_chosen_in_proportion_to_their_weights */
/* loses: unbiased_for_few_candidates */
/* loses: unbiased_for_many_candidates */
/* [weigh] */
-#pragma omp simd
+    (void)beta_map, (void)beta_f;
-        const float phat = f.cos[i] * (F_r[i] + F_g[i] + F_b[i]), q = beta_map * x.q[i] + beta_f * f.q[i];
-        /* where q is 0, as at a black pixel outside the lobe, phat is 0, too */
-        w[i] = bis_lanes_choose(f.cos[i] > 0, phat / bis_lanes_choose(q > 0, q, 1), 0);
+        w[i] = f.cos[i] > 0 && x.q[i] > 0 ? f.cos[i] * (F_r[i] + F_g[i] + F_b[i]) / x.q[i] : 0;
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
