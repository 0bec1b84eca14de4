/* SPDX-License-Identifier: BSD-2-Clause */
/* Plain loops, without vectors and without the sums of blocks. */
/* [weigh] */
static void weigh(float *restrict w, float *restrict F_r, float *restrict F_g, float *restrict F_b,
                  const bis_lanes *x, const bis_reflected *f, float beta_map, float beta_f, uint32_t n)
{
    for (uint32_t i = 0; i < n; i++) {
        const double q = (double)beta_map * (double)x->q[i] + (double)beta_f * (double)f->q[i];
        F_r[i] = f->r[i] * x->r[i];
        F_g[i] = f->g[i] * x->g[i];
        F_b[i] = f->b[i] * x->b[i];
        w[i] = 0;
        if (f->cos[i] > 0 && q > 0) w[i] = (float)((double)(f->cos[i] * (F_r[i] + F_g[i] + F_b[i])) / q);
    }
}
/* [end] */
/* [choose] */
static uint32_t choose_systematic(uint32_t *restrict item, uint32_t *restrict times, const float *restrict w,
                                  const float *restrict sum, uint32_t n_blocks, uint32_t N, double W, double offset)
{
    uint32_t n = 0, i = 0, last = 0;
    double S = (double)w[0];

    (void)sum, (void)marks_below, (void)sums_of_block;
    for (uint32_t k = 0; k < BLOCK * n_blocks; k++) {
        if (w[k] > 0) last = k;
    }
    for (uint32_t j = 0; j < N; j++) {
        while (i < last && S <= (j + offset) / N * W) S += (double)w[++i];
        if (n > 0 && item[n - 1] == i) {
            times[n - 1]++;
        } else {
            item[n] = i;
            times[n++] = 1;
        }
    }
    return n;
}
/* [end] */
