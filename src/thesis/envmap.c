/* SPDX-License-Identifier: BSD-2-Clause */
/* envmap: the sphere of eq. 3.2, divided into W x H patches of constant radiance (thesis 3.1).
 *
 * Everything follows from one choice (docs/errata.md E2): a pixel is not a point light. It is the patch between two
 * meridians and two circles of latitude. On the sphere z is uniform (Archimedes). A patch of row j therefore has the
 * solid angle (2 pi / W)(cos t_j - cos t_{j+1}). A direction that is uniform in it has phi uniform between the
 * meridians and cos(theta) uniform between the circles. Nothing is divided by sin(theta), so the poles need no
 * special case.
 *
 * Numbers: cos t_j - cos t_{j+1} cancels at the poles (in float with 8192 rows it is 19% wrong). The same number is 2
 * sin(mid) sin(half), which does not cancel. sin(theta) = sqrt(1 - cos^2) cancels there, too. We keep h = 1 -
 * |cos(theta)| instead, and sin^2 = h (2 - h). Cost: O(W H) to clean, O(1) for everything else. */
#include "bis/thesis/envmap.h"

#include "bis/base/mem.h"
#include "bis/base/image.h"
#include "base/sine.h"
#include "envmap_parts.h"

#include <assert.h>
#include <float.h>

/* sin and cos of the polar angle pi j / n, computed from the distance to the nearer pole. They are exactly symmetric
 * and have full precision at both poles. Not by libm, whose last bit depends on the machine. */
static double sin_polar(double j, int n) { return bis_sine(PI * fmin(j, n - j) / n); }

static double cos_polar(double j, int n)
{
    if (2 * j == n) return 0; /* the equator: the cosine of PI / 2, rounded to double, is 6e-17 */
    return 2 * j < n ? bis_cosine(PI * j / n) : -bis_cosine(PI * (n - j) / n);
}

bis_status bis_envmap_init_rows(bis_envmap *em, int width, int height, bis_diag *diag)
{
    assert(width > 0 && height > 0 && (uint64_t)width * (uint64_t)height <= UINT32_MAX);
    em->width = width;
    em->height = height;
    em->cos_edge = bis_alloc((size_t)height + 1, sizeof *em->cos_edge);
    em->row_solid_angle = bis_alloc((size_t)height, sizeof *em->row_solid_angle);
    if (!em->cos_edge || !em->row_solid_angle) {
        return bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for the %d rows of an environment map", height);
    }
    /* [solid-angle] */
    const double sin_half = bis_sine(PI / (2.0 * height));
    for (int y = 0; y < height; y++) {
        em->cos_edge[y] = cos_polar(y, height);
        em->row_solid_angle[y] = 2 * PI / width * 2 * sin_polar(y + 0.5, height) * sin_half;
    }
    em->cos_edge[height] = -1; /* the loop ends before it */
    /* [end] */
    return BIS_OK;
}

static bool is_radiance(float v) { return v >= 0 && v <= FLT_MAX; } /* false for a NaN */

/* A bad channel becomes 0 and the others stay, because a single NaN of a map would spoil every pixel that sees it. The
 * first place is kept for the warning, and what kind it was decides which warning. */
static float clean_channel(bis_envmap_defects *d, float v, char name, int x, int y)
{
    if (is_radiance(v)) return v;
    if (d->n_nan + d->n_infinite + d->n_negative == 0) {
        d->first_x = x;
        d->first_y = y;
        d->first_channel = name;
    }
    if (isnan(v)) {
        d->n_nan++;
    } else if (isinf(v)) {
        d->n_infinite++;
    } else {
        d->n_negative++;
    }
    return 0;
}

rgb bis_envmap_clean(bis_envmap_defects *defects, rgb c, int x, int y, double solid_angle)
{
    if (is_radiance(c.r) && is_radiance(c.g) && is_radiance(c.b)) return c;
    defects->solid_angle += solid_angle; /* of the whole pixel, once: the warning says what share of the sphere it is */
    const float r = clean_channel(defects, c.r, 'R', x, y);
    const float g = clean_channel(defects, c.g, 'G', x, y);
    const float b = clean_channel(defects, c.b, 'B', x, y);
    return (rgb){r, g, b};
}

/* Counts good channels, and does not stop at the first one: hardly any map has one, and a loop that may stop does not
 * become vectors. */
static bool is_row_of_radiance(const rgb *row, int width)
{
    int n_good = 0;
#pragma omp simd reduction(+ : n_good)
    for (int x = 0; x < width; x++) n_good += is_radiance(row[x].r) + is_radiance(row[x].g) + is_radiance(row[x].b);
    return n_good == 3 * width;
}

bis_status bis_envmap_from_latlong(bis_envmap *em, bis_image *image, bis_diag *diag)
{
    *em = (bis_envmap){.pixels = image->pixels};
    const int width = image->width, height = image->height;
    *image = (bis_image){0};
    const bis_status status = bis_envmap_init_rows(em, width, height, diag);
    if (status) {
        bis_envmap_clear(em);
        return status;
    }
    /* The first row with a bad value: usually there is none. All threads look for it; one thread then cleans, so that
     * the first place and the counts do not depend on how many there are. */
    int first = height;
#pragma omp parallel for reduction(min : first)
    for (int y = 0; y < height; y++) {
        /* `first` is a thread's own here: it spares rows behind the first bad one that this thread has seen */
        if (y < first && !is_row_of_radiance(em->pixels + (size_t)y * (size_t)width, width)) first = y;
    }
    for (int y = first; y < height; y++) {
        rgb *row = em->pixels + (size_t)y * (size_t)width;
        for (int x = 0; x < width; x++) {
            row[x] = bis_envmap_clean(&em->defects, row[x], x, y, em->row_solid_angle[y]);
        }
    }
    return BIS_OK;
}

void bis_envmap_clear(bis_envmap *em)
{
    bis_free(em->pixels);
    bis_free(em->cos_edge);
    bis_free(em->row_solid_angle);
    *em = (bis_envmap){0};
}

static size_t n_pixels(const bis_envmap *em) { return (size_t)em->width * (size_t)em->height; }

bis_status bis_envmap_scale(bis_envmap *em, rgb scale, bis_diag *diag)
{
    assert(is_radiance(scale.r) && is_radiance(scale.g) && is_radiance(scale.b));
    if (scale.r == 1 && scale.g == 1 && scale.b == 1) return BIS_OK;
    const size_t n = n_pixels(em);
    float r = 0, g = 0, b = 0; /* the largest of each channel. Rounding is monotone: their products bound all others */
#pragma omp parallel for reduction(max : r, g, b)
    for (size_t i = 0; i < n; i++) {
        const rgb c = em->pixels[i];
        r = c.r > r ? c.r : r;
        g = c.g > g ? c.g : g;
        b = c.b > b ? c.b : b;
    }
    const rgb most = {r, g, b}, scaled = rgb_mul(most, scale);
    if (!rgb_is_finite(scaled)) { /* asked before anything is changed, so that the map stays usable */
        return bis_error(diag, BIS_INPUT, (bis_loc){0},
                         "the largest radiance of the map, (%g %g %g), times (%g %g %g) exceeds the largest float, %g; "
                         "choose a smaller scale",
                         (double)most.r, (double)most.g, (double)most.b, (double)scale.r, (double)scale.g,
                         (double)scale.b, (double)FLT_MAX);
    }
#pragma omp parallel for
    for (size_t i = 0; i < n; i++) em->pixels[i] = rgb_mul(em->pixels[i], scale);
    return BIS_OK;
}

/* [lookup] */
size_t bis_envmap_pixel(const bis_envmap *em, vec3 w_local)
{
    const double x = (double)w_local.x, y = (double)w_local.y, z = (double)w_local.z;
    const double phi = atan2(y, x), theta = atan2(sqrt(x * x + y * y), z);

    /* West of the seam (phi < 0) columns are counted from the right end, because adding 2 pi would round phi = -1e-17
     * to 2 pi, which is column W. |phi| of floats is at least 2^-149, so the count is at least 1. */
    const double turns = phi / (2 * PI) * em->width;
    const int column = phi >= 0 ? (int)turns : em->width - (int)ceil(-turns);
    const int row = (int)(theta / PI * em->height);
    assert(column >= 0 && column < em->width);

    /* Only theta = pi gives row H: the south pole itself belongs to the last row. */
    return (size_t)(row < em->height ? row : em->height - 1) * (size_t)em->width + (size_t)column;
}
/* [end] */

/* [patch] */
void bis_envmap_circle(const bis_envmap *em, int y, double u2, double *sin_theta, double *cos_theta)
{
    /* From the nearer pole: the cosines of its side's edges, 1 at the pole. Where 1 - near is small, it is exact
     * (Sterbenz). */
    const bool north = 2 * y < em->height;
    const double near = north ? em->cos_edge[y] : -em->cos_edge[y + 1];
    const double far = north ? em->cos_edge[y + 1] : -em->cos_edge[y];
    const double h = (1 - near) + (north ? u2 : 1 - u2) * (near - far);
    *sin_theta = sqrt(h * (2 - h));
    *cos_theta = north ? 1 - h : h - 1;
}

vec3 bis_envmap_direction(const bis_envmap *em, int x, int y, double u1, double u2)
{
    double sin_theta, cos_theta;
    bis_envmap_circle(em, y, u2, &sin_theta, &cos_theta);
    const double phi = 2 * PI * (x + u1) / em->width;
    return vec3_from(sin_theta * cos(phi), sin_theta * sin(phi), cos_theta);
}
/* [end] */

void bis_envmap_measure(const bis_envmap *em, double *power, double *most)
{
    /* All threads make sums of rows, and one adds them, in their order: the bits do not depend on the number of
     * threads. TOGETHER rows at a time, because their sums lie on the stack: 8 kB. */
    enum { TOGETHER = 1024 };
    double sum[TOGETHER], largest = 0;
    *power = 0;
    for (int first = 0; first < em->height; first += TOGETHER) {
        const int n = em->height - first < TOGETHER ? em->height - first : TOGETHER;
#pragma omp parallel for reduction(max : largest)
        for (int i = 0; i < n; i++) {
            const rgb *row = em->pixels + (size_t)(first + i) * (size_t)em->width;
            double in_row = 0;
            for (int x = 0; x < em->width; x++) {
                const double intensity = rgb_sum(row[x]);
                in_row += intensity;
                largest = intensity > largest ? intensity : largest;
            }
            sum[i] = in_row;
        }
        for (int i = 0; i < n; i++) *power += sum[i] * em->row_solid_angle[first + i];
    }
    *most = largest;
}

double bis_envmap_power(const bis_envmap *em)
{
    double power, most;
    bis_envmap_measure(em, &power, &most);
    return power;
}

double bis_envmap_max_intensity(const bis_envmap *em)
{
    double power, most;
    bis_envmap_measure(em, &power, &most);
    return most;
}

size_t bis_envmap_bytes(const bis_envmap *em)
{
    return n_pixels(em) * sizeof *em->pixels + (size_t)em->height * sizeof *em->row_solid_angle +
           ((size_t)em->height + 1) * sizeof *em->cos_edge;
}
