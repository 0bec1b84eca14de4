/* film: sums, sums of squares, and what they say about the error.
 *
 * A picture is the mean over passes; a pass adds one value to every pixel, so one weight serves all pixels: the pass's
 * number of camera samples, settled before it is rendered. Sums of light are
 * double: a million passes of float radiance add up without loss that matters (2^-53 a step), and squares of FLT_MAX do
 * not overflow.
 *
 * The sum of hits is float, because it is a count. weight x share is the number of hits of a pass, or on outlines that
 * number divided by edgesamples. With 8 of them these are multiples of 1/8, and 2^24 such steps have no rounding: the
 * sum is exact up to 2^21 = 2 million camera samples a pixel. Shares that are no such multiples (3 edgesamples; tiles
 * of adaptive sampling, whose samples differ from the weight) are rounded in each pass by at most 2^-24 of the sum so
 * far. With n passes of equal weight and a share a, the sums so far are a, 2a .. na: together their roundings are at
 * most 2^-24 a n(n+1)/2, so that alpha, the sum over n, errs by at most 2^-25 a (n+1). This is 0.001 for 10^5 passes
 * of a = 1/3, half a step of an 8-bit picture.
 *
 * 52 bytes a pixel. Source of the error estimate: docs/errata.md E32 (errors come from whole, independent replicates:
 * the passes), the measure itself is relMSE of docs/budgets.md, "Error". */
#include "bis/render/film.h"

#include "bis/base/mem.h"

#include <assert.h>
#include <math.h>

/* How many pixels of a thin film lie before pixel `at` of the picture: ceil((at - k/2) / k), none below 0. */
static int thin(int at, int step) { return at <= step / 2 ? 0 : (at - step / 2 + step - 1) / step; }

/* One side of the crop, pbrt's rounding: neighbouring crops (0,0.3) and (0.3,1) meet without overlap or gap. */
static void crop_side(int full, double lo, double hi, int step, int *first, int *n)
{
    *first = thin((int)ceil(full * lo), step);
    *n = thin((int)ceil(full * hi), step) - *first;
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
                     .x0 = sizes->x0, .y0 = sizes->y0, .width = sizes->width, .height = sizes->height};

    *f = (bis_film){0};
    film.sum = bis_alloc(n, 3 * sizeof *film.sum);
    film.sum_squares = bis_alloc(n, 3 * sizeof *film.sum_squares);
    film.hits = bis_alloc(n, sizeof *film.hits);
    if (!film.sum || !film.sum_squares || !film.hits) {
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
    bis_free(f->sum_squares);
    bis_free(f->hits);
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

bis_rect bis_film_tile_of_crop(const bis_film *f, int side, int t)
{
    const bis_rect all = bis_film_tile(f, side, t);
    return (bis_rect){greater(all.x0, f->x0), greater(all.y0, f->y0), lesser(all.x1, f->x0 + f->width),
                      lesser(all.y1, f->y0 + f->height)};
}

/* ---- passes ---- */

void bis_film_end_pass(bis_film *f, double weight)
{
    f->passes++;
    f->weight += weight;
    f->weight_squares += weight * weight;
}

void bis_film_add(bis_film *f, int x, int y, rgb L, double hit, double weight)
{
    assert(x >= f->x0 && x < f->x0 + f->width && y >= f->y0 && y < f->y0 + f->height);
    assert(rgb_is_finite(L));
    size_t i = (size_t)(y - f->y0) * (size_t)f->width + (size_t)(x - f->x0);
    const double c[3] = {(double)L.r, (double)L.g, (double)L.b};

    for (int k = 0; k < 3; k++) {
        f->sum[3 * i + (size_t)k] += weight * c[k];
        f->sum_squares[3 * i + (size_t)k] += weight * c[k] * c[k];
    }
    f->hits[i] = (float)((double)f->hits[i] + weight * hit);
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

/* The variance of the mean of channel i, n > 1 passes (eq. 3.9). A pass of weight w is the mean of w camera samples:
 * its variance is v/w, sum w (L - mean)^2 over n - 1 estimates v, and the mean over a weight W has the variance v/W.
 * Where all passes agree the sum is 0 but for rounding, a few ulps of sum_squares, which may fall below it. */
double bis_film_variance(const bis_film *f, size_t i)
{
    return fmax(0, f->sum_squares[i] - f->sum[i] * (f->sum[i] / f->weight)) / (f->passes - 1.0) / f->weight;
}

/* The expected (a-b)^2 / (b^2 + m^2/100) of one pixel, mean over its channels: the variance of each channel's mean in
 * place of (a-b)^2. In place of b^2 there are two: mean^2, which holds that
 * variance as well, so that a lone bright sample hides behind its own brightness (scene.txt at 4 passes: estimate 0.35,
 * truth 0.70); and mean^2 less the variance, right in expectation, but 0 just there, as if the pixel were black. Their
 * geometric mean serves both: noise that is small beside the mean does not see it. */
static double pixel_error(const bis_film *f, size_t i, double floor)
{
    double total = 0;

    for (size_t k = 3 * i; k < 3 * i + 3; k++) {
        const double mean = f->sum[k] / f->weight, variance = bis_film_variance(f, k);
        /* Where estimates are not negative, sum_squares <= sum^2 and variance <= mean^2. A control variate may leave
         * some that are. */
        double square = mean * mean, less = fmax(0, square - variance);
        total += variance / (sqrt(square + floor) * sqrt(less + floor)); /* their product may underflow */
    }
    return total / 3;
}

/* m^2/100 of relMSE, m the mean of the picture; 0 where it is black. */
static double floor_of(const bis_film *f)
{
    const size_t n = (size_t)f->width * (size_t)f->height;
    double mean = 0;

    for (size_t i = 0; i < 3 * n; i++) mean += f->sum[i];
    mean /= 3 * (double)n * f->weight;
    return mean * mean / 100;
}

void bis_film_tile_errors(const bis_film *f, int tile, double *errors)
{
    int across;
    const int n = bis_film_tiles(f, tile, &across);
    const double floor = floor_of(f);

    assert(f->passes > 1);
#pragma omp parallel for schedule(dynamic)
    for (int t = 0; t < n; t++) {
        const bis_rect r = bis_film_tile_of_crop(f, tile, t);
        errors[t] = 0;
        for (int y = r.y0; floor > 0 && y < r.y1; y++) {
            for (int x = r.x0; x < r.x1; x++)
                errors[t] += pixel_error(f, (size_t)(y - f->y0) * (size_t)f->width + (size_t)(x - f->x0), floor);
        }
    }
}

/* Let X_i be pixel_error, R the mean of X over the P pixels: the estimate of relMSE. Pixels have independent random
 * numbers, so two things part R from the error that this very picture has:
 * - R is itself an estimate: var(R) <= sum (X_i - R)^2 / P^2, since the scatter over pixels holds that of their true
 * variances, too;
 * - the error is one draw: a pixel's squared error of expectation X_i has variance 2 X_i^2 (normal, its channels
 * alike),
 *   that of their mean 2 sum X_i^2 / P^2.
 * The bound is R plus 1.645 (the 95% point of a normal) times the root of the sum. But with few passes R is too low
 * where noise is skewed: pixels whose mean came out low show little scatter, and are weighed most. The loss falls with
 * 1/n; R (1 + 1.5/n) made good for it with exponential noise of 40% on every third pixel: true errors above the bound
 * in 2.6, 3.3, 2.8% of 2000 renders at 4, 16, 64 passes, without it in 16% at 4 (tests/render/test_film.c). Of passes
 * that differ in weight, n counts as many as would have the same mean of squared weights. The bound knows nothing of
 * lights that no pass has found yet. */
double bis_film_relative_rmse(const bis_film *f, double *upper)
{
    enum { BLOCK = 1024 };
    size_t n = (size_t)f->width * (size_t)f->height;
    double sum = 0, squares = 0;

    if (upper) *upper = (double)NAN;
    if (f->passes < 2) return (double)NAN;
    const double floor = floor_of(f);
    if (floor == 0) { /* black, hence without scatter */
        if (upper) *upper = 0;
        return 0;
    }
    /* threads find the terms, which are added in the order of the pixels: any number of threads gives the same bits */
#pragma omp parallel for ordered schedule(dynamic)
    for (size_t first = 0; first < n; first += BLOCK) {
        const size_t end = first + BLOCK < n ? first + BLOCK : n;
        double x[BLOCK];
        for (size_t i = first; i < end; i++) x[i - first] = pixel_error(f, i, floor);
#pragma omp ordered
        for (size_t i = 0; i < end - first; i++) {
            sum += x[i];
            squares += x[i] * x[i];
        }
    }
    double R = sum / (double)n, scatter = fmax(0, squares - sum * R); /* fmax: as in pixel_error */
    const double few = 1.5 * f->weight_squares / (f->weight * f->weight);
    if (upper) *upper = sqrt(R * (1 + few) + 1.645 * sqrt(scatter + 2 * squares) / (double)n);
    return sqrt(R);
}

size_t bis_film_bytes(const bis_film *f)
{
    return (size_t)f->width * (size_t)f->height *
           (BIS_FILM_BYTES + (size_t)f->layers.n_values * sizeof *f->layers.sum);
}
