/* SPDX-License-Identifier: BSD-2-Clause */
/* importance: the density with which directions are drawn from an environment map. Source: thesis 3.3 with the area
 * weighting of 3.4.
 *
 * A pixel has the weight w per steradian: its intensity I = r+g+b (3.3, step 1), times min(0.01 sr, A_k)^b if b > 0,
 * where A_k is the solid angle of its component (3.4, docs/errata.md E17). It is drawn with probability P = w dO /
 * sum over all pixels (E3), and a direction in it is uniform by solid angle (E2). The density is therefore
 *
 *     q = P / dO = w / sum.
 *
 * Area weighting changes which directions are drawn, never the result: estimators that divide by this q are right for
 * every w that is positive where the map is positive (E20). All that matters is that q is exactly the density of what
 * is drawn. Tests compare the two to 1e-8.
 *
 * Of w only the area factors are stored. Cost: O(W H) to build, O(1) to draw. */
#include "bis/thesis/importance.h"

#include "bis/base/mem.h"
#include "bis/thesis/regions.h"
#include "importance_parts.h"

#include <assert.h>
#include <float.h>

struct bis_importance {
    bis_weights weights;
    float *area;      /* of the weights, which may be without them (E20); the curve draws with them */
    float least_area; /* of all lit pixels; 1 without area factors */
    double power, most; /* of the map: bis_envmap_measure */
    double total;     /* sum of w dO */
    double max_ratio;
    bis_table table;
    bis_curve curve;
    bool has_table, has_curve;
};

static size_t n_pixels(const bis_envmap *em) { return (size_t)em->width * (size_t)em->height; }

/* [area] */
/* Computes the factor of thesis 3.4 for every lit pixel, and the least of them. The factors take the place of the
 * labels, because a map may have 10^8 pixels. */
static bis_status find_area_factors(bis_weights *w, float *least, int levels, double b, bis_diag *diag)
{
    bis_regions regions;
    const bis_status status = bis_regions_init(&regions, w->em, levels, diag);
    if (status) return status;
    double *factor = regions.solid_angle; /* of which they take the place, too */
    for (uint32_t k = 0; k < regions.n; k++) {
        /* FLT_TRUE_MIN: an absurd b (4 and more) underflows. A lit pixel must stay possible, and any positive weight
         * is right */
        const float f = fmaxf((float)bis_area_factor(regions.solid_angle[k], b), FLT_TRUE_MIN);
        *least = fminf(*least, f);
        factor[k] = (double)f;
    }
    const uint32_t *label = regions.label;
    w->area = (void *)regions.label;
    regions.label = NULL;
#pragma omp parallel for
    for (size_t i = 0; i < n_pixels(w->em); i++) {
        const uint32_t k = label[i];
        w->area[i] = k == BIS_REGION_NONE ? 0 : (float)factor[k];
    }
    bis_regions_clear(&regions);
    return BIS_OK;
}
/* [end] */

/* MIS compensation (Karlik et al. 2019): what lies below the mean is left to the BRDF's samples. If no pixel exceeds
 * the mean by more than the rounding of its sum (n additions, each 2^-53), nothing would be left to draw, so such a
 * map is drawn uncompensated. */
static double mean_to_subtract(const bis_importance *im)
{
    const double mean = im->power / (4 * PI), rounding = (double)n_pixels(im->weights.em) * DBL_EPSILON * mean;
    return im->most - mean > rounding ? mean : 0;
}

/* Adds up the weights of each row. The order does not depend on the number of threads. */
static void sum_rows(const bis_weights *w, double *row_weight)
{
    const size_t width = (size_t)w->em->width;
#pragma omp parallel for
    for (int y = 0; y < w->em->height; y++) {
        double sum = 0;
        for (size_t x = 0; x < width; x++) sum += bis_weight(w, (size_t)y * width + x);
        row_weight[y] = sum;
    }
}

/* Adds up the rows over the sphere, and makes their weights probabilities but for a factor. */
static void sum_sphere(bis_importance *im, double *row_weight)
{
    const bis_envmap *em = im->weights.em;
    im->total = 0;
    for (int y = 0; y < em->height; y++) {
        im->total += row_weight[y] * em->row_solid_angle[y];
        row_weight[y] *= bis_row_measure(&im->weights, (size_t)y);
    }
}

/* Returns the largest I/q = sum * I/w. Without compensation I/w is 1 or 1/area. There are four roundings: of I *
 * area, of its division by sum, of the caller's I/q and of this function. Each is below 2^-53, and the factor 1 + 8 *
 * 2^-53 makes the result a bound of the computed numbers, too. */
static double find_max_ratio(const bis_importance *im)
{
    if (im->total == 0) return 0;
    if (im->weights.mean > 0) return (double)INFINITY;
    return im->total / (double)im->least_area * (1 + 4 * DBL_EPSILON);
}

/* As printed (E20): directions are drawn with the area factors, by the tables that exist already, but weighed as if
 * there were none. */
static void forget_area_factors(bis_importance *im, double *row_weight)
{
    im->weights.area = NULL;
    im->least_area = 1;
    sum_rows(&im->weights, row_weight);
    sum_sphere(im, row_weight);
    im->max_ratio = find_max_ratio(im);
}

bis_status bis_importance_new(bis_importance **out, const bis_envmap *em, const bis_importance_options *options,
                              bis_diag *diag)
{
    bis_status status = BIS_OK;
    double *row_weight = bis_alloc((size_t)em->height, sizeof *row_weight);
    bis_importance *im = bis_alloc(1, sizeof *im);

    *out = NULL;
    if (!im || !row_weight) {
        status = bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for the importance of a map");
        goto done;
    }
    im->weights = (bis_weights){.em = em, .as_printed = options->as_printed};
    im->least_area = 1;
    assert(isfinite(options->area_exponent) && options->area_exponent >= 0);
    if (options->area_exponent > 0) {
        status = find_area_factors(&im->weights, &im->least_area, options->levels, options->area_exponent, diag);
        im->area = im->weights.area;
        if (status) goto done;
    }
    bis_envmap_measure(em, &im->power, &im->most);
    if (options->compensate) im->weights.mean = mean_to_subtract(im);
    im->has_table = options->table;
    im->has_curve = options->curve;
    if (im->has_curve) status = bis_curve_init(&im->curve, &im->weights, row_weight, diag);
    else sum_rows(&im->weights, row_weight);
    if (status) goto done;
    sum_sphere(im, row_weight);
    im->max_ratio = find_max_ratio(im);
    if (im->total == 0) bis_curve_clear(&im->curve); /* a black map */
    if (im->total > 0 && im->has_table) {
        status = bis_table_init(&im->table, &im->weights, row_weight, options->table_kind, diag);
        if (status) goto done;
    }
    if (im->weights.as_printed & BIS_E20) forget_area_factors(im, row_weight);
    *out = im;
    im = NULL;
done:
    bis_importance_free(im);
    bis_free(row_weight);
    return status;
}

void bis_importance_free(bis_importance *im)
{
    if (!im) return;
    bis_table_clear(&im->table);
    bis_curve_clear(&im->curve);
    bis_free(im->area);
    bis_free(im);
}

/* [sample] */
bool bis_importance_sample(const bis_importance *im, const double u[4], bis_map_sample *s)
{
    assert(im->has_table);
    if (im->total == 0) return false;
    const bis_envmap *em = im->weights.em;
    const bis_drawn d = bis_table_draw(&im->table, u);
    s->pixel = d.y * (size_t)em->width + d.x;
    s->w_local = bis_envmap_direction(em, (int)d.x, (int)d.y, d.u[0], d.u[1]);
    s->pdf = bis_importance_pdf_pixel(im, s->pixel);
    return true;
}
/* [end] */

bool bis_importance_sample_curve(const bis_importance *im, double t, const double u[2], bis_map_sample *s)
{
    assert(im->has_curve);
    if (im->total == 0) return false;
    const bis_envmap *em = im->weights.em;
    const size_t width = (size_t)em->width;
    s->pixel = bis_curve_draw(&im->curve, t);
    s->w_local = bis_envmap_direction(em, (int)(s->pixel % width), (int)(s->pixel / width), u[0], u[1]);
    s->pdf = bis_importance_pdf_pixel(im, s->pixel);
    return true;
}

/* [density] */
double bis_importance_pdf_pixel(const bis_importance *im, size_t pixel)
{
    return im->total > 0 ? bis_weight(&im->weights, pixel) / im->total : 0;
}
/* [end] */

double bis_importance_pdf(const bis_importance *im, vec3 w_local)
{
    return bis_importance_pdf_pixel(im, bis_envmap_pixel(im->weights.em, w_local));
}

size_t bis_importance_n_tiles(const bis_importance *im, uint32_t *side)
{
    assert(im->has_curve && im->total > 0);
    *side = im->curve.side;
    return im->curve.n_tiles;
}

bis_curve_tile bis_importance_tile(const bis_importance *im, size_t i) { return bis_curve_tile_at(&im->curve, i); }

double bis_importance_in_tile(const bis_importance *im, double t) { return bis_curve_in_tile(&im->curve, t); }

void bis_importance_measured(const bis_importance *im, double *power, double *most)
{
    *power = im->power;
    *most = im->most;
}

double bis_importance_max_ratio(const bis_importance *im) { return im->max_ratio; }

size_t bis_importance_bytes(const bis_importance *im)
{
    _Static_assert(sizeof *im->area == BIS_AREA_BYTES, "importance.h promises it");
    const size_t area = im->area ? n_pixels(im->weights.em) * BIS_AREA_BYTES : 0;
    return sizeof *im + area + bis_table_bytes(&im->table) + bis_curve_bytes(&im->curve);
}

bis_status bis_importance_implied_pmf(const bis_importance *im, double *pmf, bis_diag *diag)
{
    assert(im->has_table);
    if (im->total > 0) return bis_table_implied_pmf(&im->table, pmf, diag);
    for (size_t i = 0; i < n_pixels(im->weights.em); i++) pmf[i] = 0;
    return BIS_OK;
}
