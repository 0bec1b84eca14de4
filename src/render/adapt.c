/* SPDX-License-Identifier: BSD-2-Clause */
/* adapt: camera samples go where the error is.
 *
 * What the picture is judged by is the sum over pixels of their relative variances, v_t/m for a tile whose single
 * camera sample has variance v_t and that gets m of them; for a given number in all it is least where m is in
 * proportion to sqrt(v_t) (Neyman 1934). v_t comes from the scatter of the passes.
 *
 * Unbiased for every fixed number of passes, by three rules:
 * - m is chosen from earlier passes alone, so within a pass the mean of m samples has the right expectation, whatever m
 * is;
 * - m >= 1, so that there is such a mean in every pass;
 * - every pass weighs as much as any other in each pixel, whatever its m. (Weighing samples alike instead, which looks
 * natural, gives more weight to passes that were
 *   asked for because earlier ones came out bright: a correlation, hence a bias; Kirk and Arvo 1991.
 *   tests/render/test_adapt.c shows it.)
 * And passes stay what error estimates want: replicates whose errors are uncorrelated. Their variances differ, but the
 * scatter of their means over n (n - 1) estimates the variance of the whole without bias all the same: E sum (x_p -
 * x)^2 = (1 - 1/n) sum var(x_p).
 *
 * Tiles of 16 x 16 pixels: hundreds of values stand behind one v_t after two passes, so that choices hardly depend on
 * chance. That m is at least a quarter of the mean keeps a place where an error still hides from being starved: at most
 * four times the variance of plain passes, for ever. */
#include "adapt.h"

#include "bis/base/mem.h"

#include <math.h>

bis_status bis_adapt_init(bis_adapt *a, const bis_film *f, int tile, bis_diag *diag)
{
    *a = (bis_adapt){.tile = tile};
    a->n_tiles = bis_film_tiles(f, tile, &a->tiles_x);
    a->samples = bis_alloc((size_t)a->n_tiles, sizeof *a->samples);
    a->inverse = bis_alloc((size_t)a->n_tiles, sizeof *a->inverse);
    a->noise = bis_alloc((size_t)a->n_tiles, sizeof *a->noise);
    if (!a->samples || !a->inverse || !a->noise) {
        const bis_status status = bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for %d tiles", a->n_tiles);
        bis_adapt_clear(a);
        return status;
    }
    for (int t = 0; t < a->n_tiles; t++) a->samples[t] = BIS_ADAPT_SAMPLES;
    return BIS_OK;
}

void bis_adapt_clear(bis_adapt *a)
{
    bis_free(a->samples);
    bis_free(a->inverse);
    bis_free(a->noise);
    *a = (bis_adapt){0};
}

static double pixels_of(const bis_adapt *a, const bis_film *f, int t)
{
    const bis_rect r = bis_film_tile_of_crop(f, a->tile, t);
    return (double)(r.x1 - r.x0) * (r.y1 - r.y0);
}

/* The film knows the relative variance of each pixel's mean over n passes, sum of v/m over n^2. */
static void measure_noise(bis_adapt *a, const bis_film *f)
{
    const double n = f->passes;

    bis_film_tile_errors(f, a->tile, a->noise);
    for (int t = 0; t < a->n_tiles; t++) a->noise[t] = sqrt(a->noise[t] / pixels_of(a, f, t) * n * n / a->inverse[t]);
}

static uint32_t share(double noise, double scale)
{
    return (uint32_t)fmax(1, fmin(BIS_ADAPT_MOST, floor(noise * scale + 0.5)));
}

static double samples_at(const bis_adapt *a, const bis_film *f, double scale)
{
    double sum = 0;
    for (int t = 0; t < a->n_tiles; t++) sum += pixels_of(a, f, t) * share(a->noise[t], scale);
    return sum;
}

/* The largest scale at which the picture gets no more than its samples, by bisection. The noisiest tile's would be MOST
 * at hi. */
static double find_scale(const bis_adapt *a, const bis_film *f)
{
    const double budget = (double)BIS_ADAPT_SAMPLES * f->width * f->height;
    double most = 0, lo = 0;

    for (int t = 0; t < a->n_tiles; t++) most = fmax(most, a->noise[t]);
    if (most == 0) return 0;
    double hi = 2 * BIS_ADAPT_MOST / most;
    for (int i = 0; i < 50; i++) {
        double scale = 0.5 * (lo + hi);
        if (samples_at(a, f, scale) <= budget) lo = scale;
        else hi = scale;
    }
    return lo;
}

void bis_adapt_next(bis_adapt *a, const bis_film *f)
{
    for (int t = 0; t < a->n_tiles; t++) a->inverse[t] += 1.0 / a->samples[t];
    if (f->passes < BIS_ADAPT_PILOT) return;
    measure_noise(a, f);
    const double scale = find_scale(a, f);
    for (int t = 0; t < a->n_tiles; t++) a->samples[t] = share(a->noise[t], scale);
}

size_t bis_adapt_bytes(const bis_adapt *a)
{
    return (size_t)a->n_tiles * (sizeof *a->samples + sizeof *a->inverse + sizeof *a->noise);
}
