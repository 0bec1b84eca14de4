/* SPDX-License-Identifier: BSD-2-Clause */
/* flat_tables: random numbers, and the discrete distributions of thesis 3.2 step by step. */
#include "bis/flat/taught.h"

#include "base/text.h"
#include "bis/base/mem.h"
#include "bis/thesis/alias.h"
#include "bis/thesis/cdf.h"
#include "bis/thesis/marsaglia.h"
#include "bis/thesis/rng.h"
#include "bis/thesis/sampler.h"
#include "flat/face.h"
#include "tools/verify/verify.h"

#include <assert.h>
#include <inttypes.h>
#include <string.h>

/* ---- numbers, hashes ---- */

void bis_flat_fnv(uint32_t hash[2], size_t n, const uint8_t *bytes)
{
    if (!hash || (n > 0 && !bytes)) return;
    uint64_t h = (uint64_t)hash[1] << 32 | hash[0];
    h = bis_fnv1a(h ? h : BIS_FNV1A, bytes, n);
    hash[0] = (uint32_t)h;
    hash[1] = (uint32_t)(h >> 32);
}

void bis_flat_uniform(uint32_t seed, uint32_t stream, size_t n, double *u)
{
    bis_rng rng;

    bis_rng_init(&rng, seed, stream, 0, 0);
    for (size_t i = 0; u && i < n; i++) u[i] = bis_rng_double(&rng);
}

bis_status bis_do_points(const char *kind, uint64_t seed, uint32_t pixel, uint32_t sample, uint32_t spp, uint32_t dim,
                         size_t n, double *u, bis_diag *diag)
{
    bis_sampler sampler = {.seed = seed, .jitter = true};
    bis_stream stream;
    int k = 0;

    while (k <= BIS_SAMPLER_HALTON && strcmp(kind, bis_sampler_name((bis_sampler_kind)k)) != 0) k++;
    if (k > BIS_SAMPLER_HALTON)
        return bis_flat_refuse(diag, "there is no sampler \"%.40s\": give random, stratified, sobol or halton", kind);
    if (!(spp > 0 && n <= UINT32_MAX && (dim < INT32_MAX || dim == UINT32_MAX)))
        return bis_flat_refuse(diag, "%zu points of %u samples, dimension %" PRIu32 ": give at most "
                               "2^32 - 1 points, a sample or more, a dimension below 2^31 - 1", n, (unsigned)spp, dim);
    sampler.kind = (bis_sampler_kind)k;
    bis_sampler_set_spp(&sampler, spp);
    for (size_t i = 0; dim == UINT32_MAX && i < n; i++) {
        bis_stream_init(&stream, &sampler, pixel, sample + i);
        bis_stream_camera(&stream, u + 2 * i);
    }
    bis_stream_init(&stream, &sampler, pixel, sample);
    if (dim != UINT32_MAX) bis_stream_points(&stream, dim, (uint32_t)n, (double(*)[2])u);
    return BIS_OK;
}

bis_status bis_do_histogram(size_t n, const double *values, const double *unit, double most, size_t cells,
                            uint32_t *count, bis_diag *diag)
{
    const double hi = most * *unit;

    if (!(cells >= 1 && isfinite(hi) && *unit >= 0 && most >= 0))
        return bis_flat_refuse(diag, "%zu cells from 0 to %g times %g: give a cell or more, and numbers >= 0", cells,
                               most, *unit);
    memset(count, 0, cells * sizeof *count);
    for (size_t i = 0; i < n; i++) {
        if (isnan(values[i])) return bis_flat_refuse(diag, "value %zu is no number", i);
        if (values[i] >= hi) count[cells - 1]++;
        else count[values[i] > 0 ? (size_t)(values[i] / hi * (double)cells) : 0]++; /* the quotient rounds to below 1 */
    }
    return BIS_OK;
}

_Static_assert((int)BIS_N_BITS <= (int)BIS_FLAT_BITS, "the rows have room");

bis_status bis_do_bits(uint32_t *hash, uint32_t *expected, uint8_t *name, uint32_t *n, bis_diag *diag)
{
    bis_bits rows[BIS_N_BITS];
    const bis_status status = bis_verify_bits(rows, diag);

    if (status) return status;
    for (int i = 0; i < BIS_N_BITS; i++) {
        for (int half = 0; half < 2; half++) {
            hash[2 * i + half] = (uint32_t)(rows[i].hash >> 32 * half);
            expected[2 * i + half] = (uint32_t)(rows[i].expected >> 32 * half);
        }
        snprintf((char *)name + (size_t)i * 64, 64, "%s", rows[i].name);
    }
    *n = BIS_N_BITS;
    return BIS_OK;
}

/* ---- Marsaglia's list ---- */

bis_status bis_do_marsaglia(size_t n, const uint32_t *w, size_t room, uint32_t *list, uint32_t *length, bis_diag *diag)
{
    bis_marsaglia m = {0};
    uint64_t *wide = bis_alloc(n, sizeof *wide);

    if (!wide) return bis_error(diag, BIS_NOMEM, nowhere, "no memory for %zu weights", n);
    for (size_t i = 0; i < n; i++) wide[i] = w[i];
    bis_status status = bis_marsaglia_init(&m, wide, n, diag);
    bis_free(wide);
    if (!status && m.length > room)
        status = bis_flat_refuse(diag, "the list has %zu items, the array has room for %zu", m.length, room);
    if (!status) {
        if (m.length) memcpy(list, m.list, m.length * sizeof *list);
        *length = (uint32_t)m.length;
    }
    bis_marsaglia_clear(&m);
    return status;
}

/* ---- alias tables ---- */

/* The table of w[n], which a caller gives. */
static bis_status alias_of(bis_alias *a, size_t n, const double *w, bis_diag *diag)
{
    const bis_status status = bis_flat_weights(n, w, diag);
    return status ? status : bis_alias_init(a, w, n, diag);
}

bis_status bis_do_alias_build(size_t n, const double *w, double *prob, uint32_t *alias, double *total, bis_diag *diag)
{
    bis_alias a = {0};
    const bis_status status = alias_of(&a, n, w, diag);

    if (status) return status;
    memcpy(prob, a.prob, n * sizeof *prob);
    memcpy(alias, a.alias, n * sizeof *alias);
    *total = a.total;
    bis_alias_clear(&a);
    return BIS_OK;
}

bis_status bis_do_alias_sample(size_t n, const double *prob, const uint32_t *alias, size_t m, const double *u,
                               uint32_t *item, bis_diag *diag)
{
    if (n == 0) return bis_flat_refuse(diag, "the tables are empty: there is nothing to draw");
    if (n > UINT32_MAX) return bis_flat_refuse(diag, "there are %zu bins: give 1 to %" PRIu32, n, UINT32_MAX);
    for (size_t i = 0; i < n; i++) {
        if (!(prob[i] >= 0 && prob[i] <= 1))
            return bis_flat_refuse(diag, "prob of bin %zu is %g: give numbers in [0, 1]", i, prob[i]);
        if (alias[i] >= n)
            return bis_flat_refuse(diag, "alias of bin %zu is %" PRIu32 ": give items below %zu", i, alias[i], n);
    }
    const bis_status status = bis_flat_numbers(m, 1, u, diag);
    for (size_t i = 0; !status && i < m; i++) item[i] = (uint32_t)bis_alias_pick(prob, alias, n, u[i]);
    return status;
}

/* order[n]: a bin is named after all that it gives to, because only then is its own part final. waits[i] counts the
 * bins that i still has to give to. */
static void order_bins(uint32_t *order, uint32_t *waits, const bis_alias *a)
{
    size_t named = 0;

    for (size_t i = 0; i < a->n; i++) waits[a->alias[i]] += a->alias[i] != i;
    for (size_t i = 0; i < a->n; i++)
        if (waits[i] == 0) order[named++] = (uint32_t)i;
    for (size_t k = 0; k < named; k++) {
        const uint32_t from = a->alias[order[k]];
        if (from != order[k] && --waits[from] == 0) order[named++] = from;
    }
}

bis_status bis_do_alias_stage(size_t n, const double *w, size_t steps, uint32_t *order, double *height, bis_diag *diag)
{
    bis_alias a = {0};
    bis_status status = alias_of(&a, n, w, diag);
    uint32_t *waits = status ? NULL : bis_alloc(n, sizeof *waits); /* zeros */

    if (!status && !waits) status = bis_error(diag, BIS_NOMEM, nowhere, "no memory for %zu items", n);
    if (!status) {
        order_bins(order, waits, &a);
        memcpy(height, a.prob, n * sizeof *height);
        for (size_t k = steps; k < n; k++) { /* what was not given yet */
            const uint32_t bin = order[k];
            height[a.alias[bin]] += 1 - a.prob[bin];
            if (a.alias[bin] == bin) height[bin] -= 1 - a.prob[bin];
        }
    }
    bis_alias_clear(&a);
    bis_free(waits);
    return status;
}

bis_status bis_do_alias_pmf(size_t n, const double *w, double *pmf, double *P, bis_diag *diag)
{
    bis_alias a = {0};
    const bis_status status = alias_of(&a, n, w, diag);

    if (status) return status;
    bis_alias_implied_pmf(&a, pmf);
    for (size_t i = 0; i < n; i++) P[i] = w[i] / a.total;
    bis_alias_clear(&a);
    return BIS_OK;
}

bis_status bis_do_alias_few_bits(size_t n, const double *w, int bits, double *printed, double *right,
                                 double *impossible, bis_diag *diag)
{
    bis_alias a = {0};

    if (!(bits >= 0 && bits <= 24)) return bis_flat_refuse(diag, "numbers of %d bits: give 0 to 24", bits);
    const bis_status status = alias_of(&a, n, w, diag);
    if (status) return status;
    for (size_t i = 0; i < n; i++) printed[i] = right[i] = 0;
    double theirs = 0, drawn[2] = {0, 0};
    for (size_t k = 0; k < (size_t)1 << bits; k++) {
        const double u = ldexp((double)k, -bits), x = u * (double)n;
        const size_t i = (size_t)x;
        const size_t item[2] = {x - (double)i > a.prob[i] ? a.alias[i] : i, bis_alias_sample(&a, u)}; /* E14 */
        printed[item[0]] += ldexp(1, -bits);
        right[item[1]] += ldexp(1, -bits);
        theirs += w[i] <= 0;
        for (int way = 0; way < 2; way++) drawn[way] += w[item[way]] <= 0;
    }
    for (int way = 0; way < 2; way++) impossible[way] = theirs > 0 ? drawn[way] / theirs : 0;
    bis_alias_clear(&a);
    return BIS_OK;
}

/* ---- the CDF ---- */

static bis_status cdf_of(bis_cdf *cdf, size_t n, const double *w, bis_diag *diag)
{
    const bis_status status = bis_flat_weights(n, w, diag);
    return status ? status : bis_cdf_init(cdf, w, n, diag);
}

bis_status bis_do_cdf_build(size_t n, const double *w, double *c, uint32_t *guide, uint32_t *n_guide, bis_diag *diag)
{
    bis_cdf cdf = {0};
    const bis_status status = cdf_of(&cdf, n, w, diag);

    if (status) return status;
    assert(cdf.n_guide <= 2 * n + 1);
    memcpy(c, cdf.c, (n + 1) * sizeof *c);
    memcpy(guide, cdf.guide, (cdf.n_guide + 1) * sizeof *guide);
    *n_guide = (uint32_t)cdf.n_guide;
    bis_cdf_clear(&cdf);
    return BIS_OK;
}

bis_status bis_do_cdf_sample(size_t n, const double *w, size_t m, const double *u, uint32_t *item, uint32_t *part,
                             uint32_t *first, bis_diag *diag)
{
    bis_cdf cdf = {0};
    bis_status status = cdf_of(&cdf, n, w, diag);

    for (size_t i = 0; !status && i < m; i++) {
        if (!(u[i] >= 0 && u[i] < 1)) {
            status = bis_flat_refuse(diag, "u of sample %zu is %g: give numbers in [0, 1)", i, u[i]);
            break;
        }
        item[i] = (uint32_t)bis_cdf_sample(&cdf, u[i], NULL);
        part[i] = (uint32_t)bis_cdf_part(&cdf, u[i]);
        first[i] = cdf.guide[part[i]];
    }
    bis_cdf_clear(&cdf);
    return status;
}

/* ---- draws against probabilities ---- */

bis_status bis_do_fit(size_t n, const double *P, size_t m, const uint32_t *item, double *observed, double *fit,
                      bis_diag *diag)
{
    bis_verify v = {0};
    bis_status status = bis_flat_weights(n, P, diag);

    if (status) return status;
    for (size_t i = 0; i < m; i++)
        if (item[i] >= n) return bis_flat_refuse(diag, "item %zu is %" PRIu32 ", not below %zu", i, item[i], n);
    double *expected = bis_alloc(n, sizeof *expected);
    if (!expected) return bis_error(diag, BIS_NOMEM, nowhere, "no memory for %zu items", n);
    for (size_t i = 0; i < n; i++) {
        expected[i] = (double)m * P[i];
        observed[i] = 0;
    }
    for (size_t i = 0; i < m; i++) observed[item[i]]++;
    bis_verify_fit(bis_verify_new(&v, "figure", "draws"), observed, expected, n);
    if (v.n == 1) memcpy(fit, (double[]){v.tests[0].statistic, v.tests[0].dof, v.tests[0].p}, 3 * sizeof *fit);
    else status = bis_error(diag, BIS_NOMEM, nowhere, "no memory for a test");
    bis_verify_clear(&v);
    bis_free(expected);
    return status;
}
