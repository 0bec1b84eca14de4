/* SPDX-License-Identifier: BSD-2-Clause */
/* film_layers: a film's layers as channels of an EXR.
 *
 * Names are those that other programs look for: Albedo.R/G/B and Ns.X/Y/Z as in pbrt-v4, whose denoiser reads them, Z
 * as OpenEXR itself names depth.
 * The rest is LAYER.R/G/B, or LAYER.Y for one value, a grey picture: viewers group channels by what stands before the
 * last point.
 *
 * Error bars come from whole passes (docs/errata.md E32). Where passes are independent (bis/render.h) the mean of n of
 * them has the standard error s/sqrt(n), and the truth lies within t(0.975, n-1) of it in 95% of all pixels. Where the
 * samples of a pixel are spread over passes, it lies nearer: the scatter of n passes of variance V(1) has the
 * expectation (V(1) - V(n))/(n-1) >= V(n). So the interval is not too short there. What all pixels gain together is
 * known (film_error.c). It is one factor for the standard errors of all, so that their root mean square, relative as
 * the figure is, is the figure. No pixel tells its own gain. Where the figure is not known, the factor is 1. */
#include "bis/render/film.h"

#include "bis/base/stats.h"

#include <assert.h>
#include <math.h>

static const struct {
    size_t n;
    const char *names[3];
} shown[BIS_N_LAYERS] = {
    [BIS_LAYER_STDERR] = {3, {"stderr.R", "stderr.G", "stderr.B"}},
    [BIS_LAYER_INTERVAL] = {3, {"interval.R", "interval.G", "interval.B"}},
    [BIS_LAYER_SAMPLES] = {1, {"samples.Y"}},
    [BIS_LAYER_SHADOWRAYS] = {1, {"shadowrays.Y"}},
    [BIS_LAYER_CANDIDATES] = {1, {"candidates.Y"}},
    [BIS_LAYER_UNOCCLUDED] = {3, {"unoccluded.R", "unoccluded.G", "unoccluded.B"}},
    [BIS_LAYER_VISIBILITY] = {1, {"visibility.Y"}},
    [BIS_LAYER_ALBEDO] = {3, {"Albedo.R", "Albedo.G", "Albedo.B"}},
    [BIS_LAYER_NORMAL] = {3, {"Ns.X", "Ns.Y", "Ns.Z"}},
    [BIS_LAYER_DEPTH] = {1, {"Z"}},
};

/* t with P(|T| > t) = 0.05 for Student's T, by bisection: p falls with t, and 12.7 is the largest, at one degree of
 * freedom. */
static double student_975(double dof)
{
    double lo = 1, hi = 16;

    for (int i = 0; i < 60; i++) {
        double t = 0.5 * (lo + hi);
        if (bis_stats_student_p(t, dof) > 0.05) lo = t;
        else hi = t;
    }
    return 0.5 * (lo + hi);
}

/* What the standard errors of independent passes are multiplied by for one of the two layers. */
static double factor_of(const bis_film *f, bis_layer layer)
{
    if (layer == BIS_LAYER_INTERVAL) return student_975(f->passes - 1.0);
    const bis_film_error error = bis_film_estimate_error(f);
    return error.is_known && error.scatter > 0 ? error.relative_rmse / error.scatter : 1;
}

/* Value k of a layer in pixel i. factor: of the standard error. */
static double value(const bis_film *f, bis_layer layer, size_t i, size_t k, double factor)
{
    if (layer == BIS_LAYER_STDERR || layer == BIS_LAYER_INTERVAL)
        return factor * sqrt(bis_film_variance(f, 3 * i + k));

    const double *sum = f->layers.sum + i * (size_t)f->layers.n_values + f->layers.first[layer];
    switch (layer) {
    case BIS_LAYER_SAMPLES:
    case BIS_LAYER_SHADOWRAYS:
    case BIS_LAYER_CANDIDATES: return sum[k];
    case BIS_LAYER_VISIBILITY: return sum[1] > 0 ? sum[0] / sum[1] : 0;
    case BIS_LAYER_DEPTH: return f->hits[i] > 0 ? sum[0] / (double)f->hits[i] : 0;
    default: return f->passes ? sum[k] / f->weight : 0;
    }
}

bis_status bis_film_want(bis_film *f, unsigned layers, bis_diag *diag)
{
    assert(f->passes == 0 && f->layers.asked == 0);
    return bis_layers_init(&f->layers, layers, (size_t)f->width * (size_t)f->height, diag);
}

int bis_film_layers(const bis_film *f, bis_channel channels[BIS_FILM_MAX_CHANNELS], float *planes)
{
    const size_t n_pixels = (size_t)f->width * (size_t)f->height;
    int n = 0;

    for (int layer = 0; layer < BIS_N_LAYERS; layer++) {
        if (!bis_layers_has(&f->layers, (bis_layer)layer)) continue;
        const bool is_error = layer == BIS_LAYER_STDERR || layer == BIS_LAYER_INTERVAL;
        if (is_error && f->passes < 2) continue;
        const double factor = is_error && planes ? factor_of(f, (bis_layer)layer) : 1;
        for (size_t k = 0; k < shown[layer].n; k++, n++) {
            float *plane = planes ? planes + (size_t)n * n_pixels : NULL;
            channels[n] = (bis_channel){shown[layer].names[k], plane, 1};
            if (!plane) continue;
#pragma omp parallel for
            for (size_t i = 0; i < n_pixels; i++)
                plane[i] = (float)value(f, (bis_layer)layer, i, k, factor);
        }
    }
    return n;
}
