/* SPDX-License-Identifier: BSD-2-Clause */
/* importance_table: draws a pixel in two passes. Source: thesis 3.3 and figure 3.5. The first pass draws a scanline
 * by the sum of its pixels' importances, m(y) of eq. 3.10; the second draws a pixel of it by c(x|y) of eq. 3.11.
 *
 * Each pass is one discrete distribution, by Vose's alias method (3.2.2, appendix A) or by inverting a CDF (eq.
 * 3.12). The sums are of intensity times solid angle and not the printed averages of intensity (docs/errata.md E3).
 *
 * An alias table costs O(1) whatever the map, but it scatters neighbouring numbers. CDFs keep the order of the
 * numbers: the remainders of u[0] and u[1] give the place inside the pixel, so stratified and low-discrepancy points
 * stay so on the sphere (E12). Build: O(W H), rows in parallel. A row's table depends only on the row. */
#include "bis/base/mem.h"
#include "bis/base/image.h"
#include "importance_parts.h"

#include <assert.h>
#include <stdatomic.h>

/* Stores the importance of row y's pixels per steradian. The solid angle is the same for all of them and cancels. */
static void row_weights(const bis_weights *w, size_t y, size_t width, double *out)
{
    for (size_t x = 0; x < width; x++) out[x] = bis_weight(w, y * width + x);
}

/* Returns the builder from normalised weights or, as printed, from raw ones (docs/errata.md E13). */
static bis_alias_builder *alias_builder(const bis_weights *w)
{
    if (w->as_printed & BIS_E13) return bis_alias_build_raw;
    return bis_alias_build;
}

static void build_alias_row(bis_table *t, const bis_weights *w, size_t y, uint32_t *alias, uint32_t *work)
{
    double *prob = t->prob + y * t->width; /* the weights first, then the table in their place */
    row_weights(w, y, t->width, prob);
    alias_builder(w)(prob, alias, prob, work, t->width);
    for (size_t x = 0; x < t->width; x++) t->alias[y * t->width + x] = (uint16_t)alias[x];
}

/* Builds all rows on all threads; each thread has its own scratch. */
static bis_status build_alias_rows(bis_table *t, const bis_weights *w)
{
    atomic_bool failed = false;
#pragma omp parallel
    {
        uint32_t *alias = bis_alloc(t->width, sizeof *alias), *work = bis_alloc(t->width, sizeof *work);
        const bool ok = alias && work;
        if (!ok) failed = true;
#pragma omp for schedule(dynamic, 8)
        for (size_t y = 0; y < t->height; y++) {
            if (ok) build_alias_row(t, w, y, alias, work);
        }
        bis_free(alias);
        bis_free(work);
    }
    return failed ? BIS_NOMEM : BIS_OK;
}

static bis_status build_cdf_rows(bis_table *t, const bis_weights *w, const double *row_weight)
{
    atomic_bool failed = false;
#pragma omp parallel
    {
        double *weights = bis_alloc(t->width, sizeof *weights);
        if (!weights) failed = true;
#pragma omp for schedule(dynamic, 8)
        for (size_t y = 0; y < t->height; y++) {
            if (!weights || row_weight[y] == 0) continue;
            row_weights(w, y, t->width, weights);
            if (bis_cdf_init(&t->columns[y], weights, t->width, NULL)) failed = true;
        }
        bis_free(weights);
    }
    return failed ? BIS_NOMEM : BIS_OK;
}

static bis_status init_alias(bis_table *t, const bis_weights *w, const double *row_weight)
{
    t->prob = bis_alloc(t->height * t->width, sizeof *t->prob);
    t->alias = bis_alloc(t->height * t->width, sizeof *t->alias);
    if (!t->prob || !t->alias) return BIS_NOMEM;
    const bis_status status = bis_alias_init_by(&t->row_alias, alias_builder(w), row_weight, t->height, NULL);
    return status ? status : build_alias_rows(t, w);
}

static bis_status init_cdf(bis_table *t, const bis_weights *w, const double *row_weight)
{
    t->columns = bis_alloc(t->height, sizeof *t->columns);
    if (!t->columns) return BIS_NOMEM;
    const bis_status status = bis_cdf_init(&t->row_cdf, row_weight, t->height, NULL);
    return status ? status : build_cdf_rows(t, w, row_weight);
}

bis_status bis_table_init(bis_table *t, const bis_weights *w, const double *row_weight, bis_table_kind kind,
                          bis_diag *diag)
{
    *t = (bis_table){.kind = kind, .width = (size_t)w->em->width, .height = (size_t)w->em->height};
    assert(t->width <= (size_t)UINT16_MAX + 1); /* at most twice BIS_IMAGE_MAX_SIDE: the resampling of an angular map */
    const bis_status status = kind == BIS_TABLE_ALIAS ? init_alias(t, w, row_weight) : init_cdf(t, w, row_weight);
    if (!status) return BIS_OK;
    return bis_error(diag, status, (bis_loc){0}, "no memory for the %s of a %d x %d environment map",
                     kind == BIS_TABLE_ALIAS ? "alias tables" : "CDFs", w->em->width, w->em->height);
}

void bis_table_clear(bis_table *t)
{
    bis_alias_clear(&t->row_alias);
    bis_cdf_clear(&t->row_cdf);
    for (size_t y = 0; t->columns && y < t->height; y++) bis_cdf_clear(&t->columns[y]);
    bis_free(t->columns);
    bis_free(t->prob);
    bis_free(t->alias);
    *t = (bis_table){0};
}

/* Does the same as bis_alias_pick, for short columns. */
/* [pick-column] */
static size_t pick_column(const bis_table *t, size_t y, double u)
{
    const double *prob = t->prob + y * t->width;
    const double scaled = u * (double)t->width; /* < width: u <= 1 - 2^-53, and width < 2^53 */
    const size_t x = (size_t)scaled;
    return scaled - (double)x < prob[x] ? x : t->alias[y * t->width + x];
}
/* [end] */

/* [two-passes] */
bis_drawn bis_table_draw(const bis_table *t, const double u[4])
{
    bis_drawn d;
    if (t->kind == BIS_TABLE_ALIAS) {
        d.y = bis_alias_sample(&t->row_alias, u[0]);
        d.x = pick_column(t, d.y, u[1]);
        d.u[0] = u[2];
        d.u[1] = u[3];
    } else {
        d.y = bis_cdf_sample(&t->row_cdf, u[0], &d.u[1]);
        d.x = bis_cdf_sample(&t->columns[d.y], u[1], &d.u[0]);
    }
    return d;
}
/* [end] */

size_t bis_table_bytes(const bis_table *t)
{
    _Static_assert(sizeof *t->prob + sizeof *t->alias == BIS_TABLE_BYTES, "importance.h promises it");
    const size_t n = t->width * t->height;
    if (t->kind == BIS_TABLE_ALIAS) return t->prob ? n * BIS_TABLE_BYTES + bis_alias_bytes(&t->row_alias) : 0;
    if (!t->columns) return 0;
    size_t bytes = t->height * sizeof *t->columns + bis_cdf_bytes(&t->row_cdf);
    for (size_t y = 0; y < t->height; y++) bytes += bis_cdf_bytes(&t->columns[y]);
    return bytes;
}

bis_status bis_table_implied_pmf(const bis_table *t, double *pmf, bis_diag *diag)
{
    double *rows = bis_alloc(t->height, sizeof *rows);
    uint32_t *alias = bis_alloc(t->width, sizeof *alias);
    bis_status status = BIS_OK;
    if (!rows || !alias) {
        status = bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for the probabilities of a row");
        goto done;
    }
    if (t->kind == BIS_TABLE_ALIAS) bis_alias_implied_pmf(&t->row_alias, rows);
    for (size_t y = 0; y < t->height; y++) {
        double *row = pmf + y * t->width;
        if (t->kind == BIS_TABLE_ALIAS) {
            for (size_t x = 0; x < t->width; x++) alias[x] = t->alias[y * t->width + x];
            const bis_alias view = {t->width, 1, t->prob + y * t->width, alias};
            bis_alias_implied_pmf(&view, row);
        } else {
            rows[y] = bis_cdf_pmf(&t->row_cdf, y);
            for (size_t x = 0; x < t->width; x++) row[x] = bis_cdf_pmf(&t->columns[y], x);
        }
        for (size_t x = 0; x < t->width; x++) row[x] = rows[y] > 0 ? row[x] * rows[y] : 0;
    }
done:
    bis_free(rows);
    bis_free(alias);
    return status;
}
