/* SPDX-License-Identifier: BSD-2-Clause */
/* film: sums and deviations. film_error.c says what they tell about the error, film_layers.c makes channels.
 *
 * A picture is the mean over passes; a pass adds one value to every pixel, so one weight serves all pixels: the pass's
 * number of camera samples, settled before it is rendered. Sums of light are double: a million passes of float radiance
 * add up without loss (2^-53 a step).
 *
 * The scatter of the passes is kept as its root mean square, which is updated pass by pass (Welford 1962): no
 * difference of large sums cancels, and float is enough: a step rounds by 2^-25, and the value settles.
 *
 * The sum of hits is float, because it is a count. weight x share is the number of hits of a pass, or on outlines
 * that number divided by edgesamples. With 8 of them these are multiples of 1/8, and 2^24 such steps have no
 * rounding: the sum is exact up to 2^21 = 2 million camera samples a pixel. Shares that are no such multiples (3
 * edgesamples) are rounded in each pass by at most 2^-24 of the sum so far. With n passes of equal weight and a share
 * a, the sums so far are a, 2a .. na: together their roundings are at most 2^-24 a n(n+1)/2, so that alpha, the sum
 * over n, errs by at most 2^-25 a (n+1). This is 0.001 for 10^5 passes of a = 1/3, half a step of an 8-bit picture.
 *
 * A film also keeps its mean as it was when it had half as many camera samples, because the difference between halves
 * tells something of the error (film_error.c). It is float: a difference below 2^-24 of the mean does not matter to an
 * error. 52 bytes a pixel. */
#include "bis/render/film.h"

#include "bis/base/file.h"
#include "bis/base/mem.h"

#include <assert.h>
#include <math.h>
#include <string.h>

/* How many pixels of a thin film lie before pixel `at` of the picture: ceil((at - k/2) / k), which is not below 0. */
static int thin(int at, int step) { return (at - step / 2 + step - 1) / step; }

/* One side of the crop, pbrt's rounding: neighbouring crops (0,0.3) and (0.3,1) meet without overlap or gap. */
static void crop_side(int full, double lo, double hi, int step, int *first, int *n)
{
    *first = thin((int)ceil(full * lo), step);
    *n = thin((int)ceil(full * hi), step) - *first;
}

bool bis_film_read_crop(double crop[4], const char *text)
{
    double read[4];
    for (int i = 0; i < 4; i++) {
        const char *end;
        read[i] = bis_parse_double(text, &end);
        if (end == text || !(read[i] >= 0 && read[i] <= 1) || *end != (i < 3 ? ',' : '\0')) return false;
        text = end + 1;
    }
    if (read[0] >= read[1] || read[2] >= read[3]) return false;
    memcpy(crop, read, sizeof read);
    return true;
}

bis_film bis_film_place(int width, int height, const double crop[4], int step)
{
    bis_film f = {.full_width = thin(width, step),
                  .full_height = thin(height, step),
                  .step = step,
                  .picture_width = width,
                  .picture_height = height};
    crop_side(width, crop[0], crop[1], step, &f.x0, &f.width);
    crop_side(height, crop[2], crop[3], step, &f.y0, &f.height);
    return f;
}

bis_status bis_film_init_like(bis_film *f, const bis_film *sizes, bis_loc at, bis_diag *diag)
{
    const size_t n = (size_t)sizes->width * (size_t)sizes->height;
    bis_film film = {.full_width = sizes->full_width, .full_height = sizes->full_height, .step = sizes->step,
                     .picture_width = sizes->picture_width, .picture_height = sizes->picture_height,
                     .x0 = sizes->x0, .y0 = sizes->y0, .width = sizes->width, .height = sizes->height,
                     .transparent = sizes->transparent};

    *f = (bis_film){0};
    film.sum = bis_alloc(n, 3 * sizeof *film.sum);
    film.deviation = bis_alloc(n, 3 * sizeof *film.deviation);
    film.half = bis_alloc(n, 3 * sizeof *film.half);
    film.hits = bis_alloc(n, sizeof *film.hits);
    if (!film.sum || !film.deviation || !film.half || !film.hits) {
        const bis_status status =
            bis_error(diag, BIS_NOMEM, at, "no memory for a picture of %d x %d pixels", film.width, film.height);
        bis_film_clear(&film);
        return status;
    }
    *f = film;
    return BIS_OK;
}

bis_status bis_film_init(bis_film *f, int full_width, int full_height, const double crop[4], bis_loc at, bis_diag *diag)
{
    return bis_film_init_thin(f, full_width, full_height, crop, 1, at, diag);
}

bis_status bis_film_init_thin(bis_film *f, int width, int height, const double crop[4], int step, bis_loc at,
                              bis_diag *diag)
{
    *f = (bis_film){0};
    assert(step >= 1);

    for (int i = 0; i < 4; i++) {
        if (!(crop[i] >= 0 && crop[i] <= 1)) {
            return bis_error(diag, BIS_INPUT, at, "the crop window holds %g; x0, x1, y0, y1 must lie in [0, 1]",
                             crop[i]);
        }
    }
    bis_film film = bis_film_place(width, height, crop, step);
    if (film.width <= 0 || film.height <= 0) {
        return bis_error(
            diag, BIS_INPUT, at,
            "the crop window %g, %g, %g, %g holds no pixel of %d x %d%s; it reads x0, x1, y0, y1 with x0 < x1, y0 < y1",
            crop[0], crop[1], crop[2], crop[3], width, height, step > 1 ? " that a thin film has" : "");
    }

    return bis_film_init_like(f, &film, at, diag);
}

void bis_film_clear(bis_film *f)
{
    if (!f) return;
    bis_free(f->sum);
    bis_free(f->deviation);
    bis_free(f->half);
    bis_free(f->hits);
    bis_free(f->twin);
    bis_layers_clear(&f->layers);
    *f = (bis_film){0};
}

/* ---- tiles ---- */

int bis_film_tiles(const bis_film *f, int side, int *across)
{
    const int down = (f->y0 + f->height - 1) / side - f->y0 / side + 1;
    *across = (f->x0 + f->width - 1) / side - f->x0 / side + 1;
    return *across * down;
}

static int lesser(int a, int b) { return a < b ? a : b; }
static int greater(int a, int b) { return a > b ? a : b; }

bis_rect bis_film_tile(const bis_film *f, int side, int t)
{
    int across;
    bis_film_tiles(f, side, &across);
    const int x0 = (f->x0 / side + t % across) * side, y0 = (f->y0 / side + t / across) * side;
    return (bis_rect){x0, y0, lesser(x0 + side, f->full_width), lesser(y0 + side, f->full_height)};
}

int bis_film_tile_at(const bis_film *f, int side, int x, int y)
{
    int across;
    bis_film_tiles(f, side, &across);
    return (y / side - f->y0 / side) * across + x / side - f->x0 / side;
}

bis_rect bis_film_tile_of_crop(const bis_film *f, int side, int t)
{
    const bis_rect all = bis_film_tile(f, side, t);
    return (bis_rect){greater(all.x0, f->x0), greater(all.y0, f->y0), lesser(all.x1, f->x0 + f->width),
                      lesser(all.y1, f->y0 + f->height)};
}

/* ---- passes ---- */

/* Before a pass: have the camera samples doubled since the mean was last kept, and are half as many still to come? A
 * difference of many samples and a few would say little of the many. */
static bool has_doubled(const bis_film *f)
{
    return f->passes && f->weight >= 2 * f->half_weight && !(f->most > 0 && f->most < 1.5 * f->weight);
}

void bis_film_end_pass(bis_film *f, double weight)
{
    if (has_doubled(f)) f->half_weight = f->weight;
    f->passes++;
    f->weight += weight;
}

void bis_film_add(bis_film *f, int x, int y, rgb L, double hit, double weight)
{
    assert(x >= f->x0 && x < f->x0 + f->width && y >= f->y0 && y < f->y0 + f->height);
    assert(rgb_is_finite(L));
    size_t i = (size_t)(y - f->y0) * (size_t)f->width + (size_t)(x - f->x0);
    const double c[3] = {(double)L.r, (double)L.g, (double)L.b}, share = weight / (f->weight + weight);
    const bool keeps = has_doubled(f);

    for (size_t k = 3 * i; k < 3 * i + 3; k++) {
        const double mean = f->passes ? f->sum[k] / f->weight : 0, d = c[k - 3 * i] - mean;
        const double old = (double)f->deviation[k];
        /* the mean of the squares of two groups, and what their means are apart */
        f->deviation[k] = f->passes ? (float)sqrt((1 - share) * (old * old + share * d * d)) : 0;
        if (keeps) f->half[k] = (float)mean;
        f->sum[k] += weight * c[k - 3 * i];
    }
    f->hits[i] = (float)((double)f->hits[i] + weight * hit);
}

void bis_film_add_twin(bis_film *f, const bis_twin *t, rgb L, double weight)
{
    const double c[3] = {(double)L.r, (double)L.g, (double)L.b};
    double *const sum = f->twin + BIS_TWIN_VALUES * t->at, *const half = sum + 3;

    for (int k = 0; k < 3; k++) {
        if (has_doubled(f)) half[k] = sum[k] / f->weight;
        sum[k] += weight * c[k];
    }
}

void bis_film_resolve(const bis_film *f, float *rgba)
{
    size_t n = (size_t)f->width * (size_t)f->height;
    double scale = f->passes ? 1 / f->weight : 0; /* no pass yet: black, and so are the sums */

#pragma omp parallel for
    for (size_t i = 0; i < n; i++) {
        for (size_t k = 0; k < 3; k++) rgba[4 * i + k] = (float)(fmax(0, f->sum[3 * i + k]) * scale);
        rgba[4 * i + 3] = (float)((double)f->hits[i] * scale);
    }
}

double bis_film_raised(const bis_film *f)
{
    const size_t n = 3 * (size_t)f->width * (size_t)f->height;
    double raised = 0, all = 0;

    for (size_t i = 0; i < n; i++) {
        all += fabs(f->sum[i]);
        if (f->sum[i] < 0) raised -= f->sum[i];
    }
    return all > 0 ? raised / all : 0;
}

size_t bis_film_bytes(const bis_film *f)
{
    return (size_t)f->width * (size_t)f->height *
               (BIS_FILM_BYTES + (size_t)f->layers.n_values * sizeof *f->layers.sum) +
           (f->twin ? bis_film_twins(f) * BIS_TWIN_VALUES * sizeof *f->twin : 0);
}
