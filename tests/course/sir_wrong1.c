/* SPDX-License-Identifier: BSD-2-Clause */
/* As printed (E23): w = f Le/q, without the cosine. */
/* loses: weights_from_the_map_are_phat_over_q */
/* loses: weights_from_the_brdf_are_phat_over_q */
/* loses: weights_of_a_mixture_have_the_mixed_density */
/* [weigh] */
BIS_LANES
static void weigh(float *restrict w, float *restrict F_r, float *restrict F_g, float *restrict F_b,
                  const bis_lanes *candidates, const bis_reflected *reflected, float beta_L, float beta_f, uint32_t n)
{
    const bis_lanes x = *candidates;
    const bis_reflected f = *reflected;

#pragma omp simd
    for (uint32_t i = 0; i < n; i++) {
        F_r[i] = f.r[i] * x.r[i];
        F_g[i] = f.g[i] * x.g[i];
        F_b[i] = f.b[i] * x.b[i];
        const float phat = F_r[i] + F_g[i] + F_b[i], q = beta_L * x.q[i] + beta_f * f.q[i];
        w[i] = bis_lanes_choose(f.cos[i] > 0, phat / bis_lanes_choose(q > 0, q, 1), 0);
    }
}
/* [end] */
