/* SPDX-License-Identifier: BSD-2-Clause */
/* flat_taught: tables, maps and materials of chapter 3, step by step, for the figures that live. */
#include "bis/flat/taught.h"

#include "base/text.h"
#include "bis/base/file.h"
#include "bis/base/mem.h"
#include "bis/beyond/mapping.h"
#include "bis/scene/light_load.h"
#include "bis/thesis/alias.h"
#include "bis/thesis/cdf.h"
#include "bis/thesis/marsaglia.h"
#include "bis/thesis/regions.h"
#include "bis/thesis/rng.h"
#include "bis/thesis/sampler.h"
#include "bis/thesis/warp.h"
#include "bis/tools/compare.h"
#include "flat/say.h"
#include "tools/verify/verify.h"

#include <assert.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

static const bis_loc nowhere = {0};

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

int bis_flat_points(const char *kind, uint64_t seed, uint32_t pixel, uint32_t sample, uint32_t spp, uint32_t dim,
                    size_t n, double *u, char *say, size_t size)
{
    bis_diag diag = {0};
    bis_sampler sampler = {.seed = seed, .jitter = true};
    bis_stream stream;
    int k = 0;
    bis_status status = BIS_FLAT_GIVEN(&diag, kind);

    if (!status && n > 0) status = BIS_FLAT_GIVEN(&diag, u);
    while (!status && k <= BIS_SAMPLER_HALTON && strcmp(kind, bis_sampler_name((bis_sampler_kind)k)) != 0) k++;
    if (k > BIS_SAMPLER_HALTON)
        status = bis_error(&diag, BIS_INPUT, nowhere,
                           "there is no sampler \"%.40s\": give random, stratified, sobol or halton", kind);
    if (!status && !(spp > 0 && n <= UINT32_MAX && (dim < INT32_MAX || dim == UINT32_MAX)))
        status = bis_error(&diag, BIS_INPUT, nowhere, "%zu points of %u samples, dimension %" PRIu32 ": give at most "
                           "2^32 - 1 points, a sample or more, a dimension below 2^31 - 1", n, (unsigned)spp, dim);
    if (status) return bis_flat_end(status, &diag, say, size);
    sampler.kind = (bis_sampler_kind)k;
    bis_sampler_set_spp(&sampler, spp);
    for (size_t i = 0; dim == UINT32_MAX && i < n; i++) {
        bis_stream_init(&stream, &sampler, pixel, sample + i);
        bis_stream_camera(&stream, u + 2 * i);
    }
    bis_stream_init(&stream, &sampler, pixel, sample);
    if (dim != UINT32_MAX) bis_stream_points(&stream, dim, (uint32_t)n, (double(*)[2])u);
    return bis_flat_end(BIS_OK, &diag, say, size);
}

int bis_flat_histogram(size_t n, const double *values, const double *unit, double most, size_t cells, uint32_t *count,
                       char *say, size_t size)
{
    bis_diag diag = {0};
    bis_status status = BIS_FLAT_GIVEN(&diag, unit, count);

    if (!status && n > 0) status = BIS_FLAT_GIVEN(&diag, values);
    const double hi = status ? 0 : most * *unit;
    if (!status && !(cells >= 1 && isfinite(hi) && *unit >= 0 && most >= 0))
        status = bis_error(&diag, BIS_INPUT, nowhere, "%zu cells from 0 to %g times %g: give a cell or more, and "
                           "numbers >= 0", cells, most, *unit);
    for (size_t k = 0; !status && k < cells; k++) count[k] = 0;
    for (size_t i = 0; !status && i < n; i++) {
        if (isnan(values[i])) status = bis_error(&diag, BIS_INPUT, nowhere, "value %zu is no number", i);
        else if (values[i] >= hi) count[cells - 1]++;
        else count[values[i] > 0 ? (size_t)(values[i] / hi * (double)cells) : 0]++; /* the quotient rounds to below 1 */
    }
    return bis_flat_end(status, &diag, say, size);
}

_Static_assert((int)BIS_N_BITS <= (int)BIS_FLAT_BITS, "the rows have room");

int bis_flat_bits(uint32_t *hash, uint32_t *expected, uint8_t *name, uint32_t *n, char *say, size_t size)
{
    bis_diag diag = {0};
    bis_bits rows[BIS_N_BITS];
    bis_status status = BIS_FLAT_GIVEN(&diag, hash, expected, name, n);

    if (!status) status = bis_verify_bits(rows, &diag);
    for (int i = 0; i < BIS_N_BITS && !status; i++) {
        for (int half = 0; half < 2; half++) {
            hash[2 * i + half] = (uint32_t)(rows[i].hash >> 32 * half);
            expected[2 * i + half] = (uint32_t)(rows[i].expected >> 32 * half);
        }
        snprintf((char *)name + (size_t)i * 64, 64, "%s", rows[i].name);
    }
    if (!status) *n = BIS_N_BITS;
    return bis_flat_end(status, &diag, say, size);
}

/* ---- thesis 3.2: discrete distributions ---- */

int bis_flat_marsaglia(size_t n, const uint32_t *w, size_t room, uint32_t *list, uint32_t *length, char *say,
                       size_t size)
{
    bis_diag diag = {0};
    bis_marsaglia m = {0};
    bis_status status = BIS_FLAT_GIVEN(&diag, w, list, length);
    uint64_t *wide = status ? NULL : bis_alloc(n, sizeof *wide);

    if (!status && !wide) status = bis_error(&diag, BIS_NOMEM, nowhere, "no memory for %zu weights", n);
    for (size_t i = 0; !status && i < n; i++) wide[i] = w[i];
    if (!status) status = bis_marsaglia_init(&m, wide, n, &diag);
    if (!status && m.length > room)
        status = bis_error(&diag, BIS_INPUT, nowhere, "the list has %zu items, the array has room for %zu", m.length,
                           room);
    if (!status) {
        memcpy(list, m.list, m.length * sizeof *list);
        *length = (uint32_t)m.length;
    }
    bis_marsaglia_clear(&m);
    bis_free(wide);
    return bis_flat_end(status, &diag, say, size);
}

/* order[n]: a bin is named after all that it gives to, because only then is its own part final. waits[i] counts the
 * bins that i still has to give to. */
static void order_bins(uint32_t *order, uint32_t *waits, const bis_alias *a)
{
    size_t named = 0;

    for (size_t i = 0; i < a->n; i++) waits[i] = 0;
    for (size_t i = 0; i < a->n; i++) waits[a->alias[i]] += a->alias[i] != i;
    for (size_t i = 0; i < a->n; i++)
        if (waits[i] == 0) order[named++] = (uint32_t)i;
    for (size_t k = 0; k < named; k++) {
        const uint32_t from = a->alias[order[k]];
        if (from != order[k] && --waits[from] == 0) order[named++] = from;
    }
}

int bis_flat_alias_stage(size_t n, const double *w, size_t steps, uint32_t *order, double *height, char *say,
                         size_t size)
{
    bis_diag diag = {0};
    bis_alias a = {0};
    bis_status status = BIS_FLAT_GIVEN(&diag, w, order, height);
    uint32_t *waits = status ? NULL : bis_alloc(n, sizeof *waits);

    if (!status && !waits) status = bis_error(&diag, BIS_NOMEM, nowhere, "no memory for %zu items", n);
    if (!status) status = bis_flat_weights(n, w, &diag);
    if (!status) status = bis_alias_init(&a, w, n, &diag);
    if (!status) {
        order_bins(order, waits, &a);
        for (size_t i = 0; i < n; i++) height[i] = a.prob[i];
        for (size_t k = steps; k < n; k++) { /* what was not given yet */
            const uint32_t bin = order[k];
            height[a.alias[bin]] += 1 - a.prob[bin];
            if (a.alias[bin] == bin) height[bin] -= 1 - a.prob[bin];
        }
    }
    bis_alias_clear(&a);
    bis_free(waits);
    return bis_flat_end(status, &diag, say, size);
}

int bis_flat_alias_pmf(size_t n, const double *w, double *pmf, double *P, char *say, size_t size)
{
    bis_diag diag = {0};
    bis_alias a = {0};
    bis_status status = BIS_FLAT_GIVEN(&diag, w, pmf, P);

    if (!status) status = bis_flat_weights(n, w, &diag);
    if (!status) status = bis_alias_init(&a, w, n, &diag);
    if (!status) bis_alias_implied_pmf(&a, pmf);
    for (size_t i = 0; !status && i < n; i++) P[i] = w[i] / a.total;
    bis_alias_clear(&a);
    return bis_flat_end(status, &diag, say, size);
}

int bis_flat_alias_few_bits(size_t n, const double *w, int bits, double *printed, double *right, double *impossible,
                            char *say, size_t size)
{
    bis_diag diag = {0};
    bis_alias a = {0};
    bis_status status = BIS_FLAT_GIVEN(&diag, w, printed, right, impossible);

    if (!status && !(bits >= 0 && bits <= 24))
        status = bis_error(&diag, BIS_INPUT, nowhere, "numbers of %d bits: give 0 to 24", bits);
    if (!status) status = bis_flat_weights(n, w, &diag);
    if (!status) status = bis_alias_init(&a, w, n, &diag);
    for (size_t i = 0; !status && i < n; i++) printed[i] = right[i] = 0;
    double theirs = 0, drawn[2] = {0, 0};
    for (size_t k = 0; !status && k < (size_t)1 << bits; k++) {
        const double u = ldexp((double)k, -bits), x = u * (double)n;
        const size_t i = (size_t)x;
        const size_t item[2] = {x - (double)i > a.prob[i] ? a.alias[i] : i, bis_alias_sample(&a, u)}; /* E14 */
        printed[item[0]] += ldexp(1, -bits);
        right[item[1]] += ldexp(1, -bits);
        theirs += w[i] <= 0;
        for (int way = 0; way < 2; way++) drawn[way] += w[item[way]] <= 0;
    }
    for (int way = 0; !status && way < 2; way++) impossible[way] = theirs > 0 ? drawn[way] / theirs : 0;
    bis_alias_clear(&a);
    return bis_flat_end(status, &diag, say, size);
}

int bis_flat_cdf_build(size_t n, const double *w, double *c, uint32_t *guide, uint32_t *n_guide, char *say,
                       size_t size)
{
    bis_diag diag = {0};
    bis_cdf cdf = {0};
    bis_status status = BIS_FLAT_GIVEN(&diag, w, c, guide, n_guide);

    if (!status) status = bis_flat_weights(n, w, &diag);
    if (!status) status = bis_cdf_init(&cdf, w, n, &diag);
    if (!status) {
        assert(cdf.n_guide <= 2 * n + 1);
        memcpy(c, cdf.c, (n + 1) * sizeof *c);
        memcpy(guide, cdf.guide, (cdf.n_guide + 1) * sizeof *guide);
        *n_guide = (uint32_t)cdf.n_guide;
    }
    bis_cdf_clear(&cdf);
    return bis_flat_end(status, &diag, say, size);
}

int bis_flat_cdf_sample(size_t n, const double *w, size_t m, const double *u, uint32_t *item, uint32_t *part,
                        uint32_t *first, char *say, size_t size)
{
    bis_diag diag = {0};
    bis_cdf cdf = {0};
    bis_status status = BIS_FLAT_GIVEN(&diag, w);

    if (!status && m > 0) status = BIS_FLAT_GIVEN(&diag, u, item, part, first);
    if (!status) status = bis_flat_weights(n, w, &diag);
    if (!status) status = bis_cdf_init(&cdf, w, n, &diag);
    for (size_t i = 0; !status && i < m; i++) {
        if (!(u[i] >= 0 && u[i] < 1)) {
            status = bis_error(&diag, BIS_INPUT, nowhere, "u of sample %zu is %g: give numbers in [0, 1)", i, u[i]);
            break;
        }
        item[i] = (uint32_t)bis_cdf_sample(&cdf, u[i], NULL);
        part[i] = (uint32_t)bis_cdf_part(&cdf, u[i]);
        first[i] = cdf.guide[part[i]];
    }
    bis_cdf_clear(&cdf);
    return bis_flat_end(status, &diag, say, size);
}

int bis_flat_fit(size_t n, const double *P, size_t m, const uint32_t *item, double *observed, double *fit, char *say,
                 size_t size)
{
    bis_diag diag = {0};
    bis_verify v = {0};
    bis_status status = BIS_FLAT_GIVEN(&diag, P, observed, fit);

    if (!status && m > 0) status = BIS_FLAT_GIVEN(&diag, item);
    if (!status) status = bis_flat_weights(n, P, &diag);
    double *expected = status ? NULL : bis_alloc(n, sizeof *expected);

    if (!status && !expected) status = bis_error(&diag, BIS_NOMEM, nowhere, "no memory for %zu items", n);
    for (size_t i = 0; !status && i < n; i++) {
        expected[i] = (double)m * P[i];
        observed[i] = 0;
    }
    for (size_t i = 0; !status && i < m; i++) {
        if (item[i] < n) observed[item[i]]++;
        else status = bis_error(&diag, BIS_INPUT, nowhere, "item %zu is %" PRIu32 ", not below %zu", i, item[i], n);
    }
    if (!status) bis_verify_fit(bis_verify_new(&v, "figure", "draws"), observed, expected, n);
    if (!status && v.n != 1) status = bis_error(&diag, BIS_NOMEM, nowhere, "no memory for a test");
    if (!status) memcpy(fit, (double[]){v.tests[0].statistic, v.tests[0].dof, v.tests[0].p}, 3 * sizeof *fit);
    bis_verify_clear(&v);
    bis_free(expected);
    return bis_flat_end(status, &diag, say, size);
}

/* ---- thesis 3.3, 3.4: maps ---- */

int bis_flat_light_find(const bis_light *light, size_t n, const float *w, uint32_t *pixel, char *say, size_t size)
{
    bis_diag diag = {0};
    bis_status status = BIS_FLAT_GIVEN(&diag, light);

    if (!status && n > 0) status = BIS_FLAT_GIVEN(&diag, w, pixel);
    for (size_t i = 0; !status && i < n; i++) {
        vec3 d;
        status = bis_flat_direction(&d, w, i, &diag);
        if (!status) pixel[i] = (uint32_t)bis_envmap_pixel(bis_light_envmap(light), d);
    }
    return bis_flat_end(status, &diag, say, size);
}

int bis_flat_light_shrink(bis_light **small, const bis_light *light, int width, char *say, size_t size)
{
    bis_diag diag = {0};
    bis_image image = {0};
    bis_light_desc desc = bis_light_desc_default();
    double power[2];
    bis_status status = BIS_FLAT_GIVEN(&diag, small, light);

    if (small) *small = NULL;
    if (!status && width < 1) status = bis_error(&diag, BIS_INPUT, nowhere, "%d columns: give 1 or more", width);
    if (status) return bis_flat_end(status, &diag, say, size);
    const bis_envmap *em = bis_light_envmap(light);
    desc.filename = (char *)(uintptr_t)"the shrunk map"; /* only read */
    desc.has_mapping = true;                             /* lat-long, even where it is square */
    status = bis_envmap_to_mapping(&image, em, BIS_MAPPING_LATLONG, width < em->width ? width : em->width, power,
                                   &diag);
    if (!status) status = bis_light_from_image(small, &image, &desc, BIS_NEED_TABLE, &diag);
    return bis_flat_end(status, &diag, say, size);
}

int bis_flat_light_density(const bis_light *light, double *pdf, double *peak, double *share, char *say, size_t size)
{
    bis_diag diag = {0};
    const bis_status status = BIS_FLAT_GIVEN(&diag, light, pdf, peak, share);

    if (status) return bis_flat_end(status, &diag, say, size);
    const bis_envmap *em = bis_light_envmap(light);
    *peak = 0;
    for (int y = 0; y < em->height; y++) {
        share[y] = 0;
        for (int x = 0; x < em->width; x++) {
            const size_t i = (size_t)y * (size_t)em->width + (size_t)x;
            pdf[i] = bis_importance_pdf_pixel(bis_light_importance(light), i);
            *peak = fmax(*peak, pdf[i]);
            share[y] += pdf[i] * em->row_solid_angle[y];
        }
    }
    return bis_flat_end(BIS_OK, &diag, say, size);
}

int bis_flat_light_rows(const bis_light *light, size_t n, const uint32_t *pixel, double degrees, uint32_t *count,
                        double *polar, char *say, size_t size)
{
    bis_diag diag = {0};
    bis_status status = BIS_FLAT_GIVEN(&diag, light, count, polar);

    if (!status && n > 0) status = BIS_FLAT_GIVEN(&diag, pixel);
    if (!status && isnan(degrees)) status = bis_error(&diag, BIS_INPUT, nowhere, "degrees is not a number");
    if (status) return bis_flat_end(status, &diag, say, size);
    const bis_envmap *em = bis_light_envmap(light);
    const size_t width = (size_t)em->width, height = (size_t)em->height;
    memset(count, 0, height * sizeof *count);
    memset(polar, 0, 2 * sizeof *polar);
    for (size_t i = 0; !status && i < n; i++) {
        if (pixel[i] < width * height) count[pixel[i] / width]++;
        else status = bis_error(&diag, BIS_INPUT, nowhere, "pixel %zu is %" PRIu32 ", not below %zu", i, pixel[i],
                                width * height);
    }
    for (size_t y = 0; !status && y < height; y++) {
        const double theta = 180 * ((double)y + 0.5) / (double)height;
        if (fmin(theta, 180 - theta) > degrees) continue;
        polar[0] += count[y];
        for (size_t x = 0; x < width; x++)
            polar[1] += (double)n * bis_importance_pdf_pixel(bis_light_importance(light), y * width + x) *
                        em->row_solid_angle[y];
    }
    return bis_flat_end(status, &diag, say, size);
}

int bis_flat_light_regions(const bis_light *light, int levels, double b, uint32_t *label, uint32_t *level, double *area,
                           double *factor, uint32_t *n, char *say, size_t size)
{
    bis_diag diag = {0};
    bis_regions r = {0};
    bis_status status = BIS_FLAT_GIVEN(&diag, light, label, level, area, factor, n);

    if (!status && !(levels >= 1 && levels <= BIS_LEVELS_MAX && b >= 0 && b <= BIS_AREA_EXPONENT_MAX))
        status = bis_error(&diag, BIS_INPUT, nowhere, "%d levels and exponent %g: give 1 to %d and 0 to %g", levels, b,
                           BIS_LEVELS_MAX, BIS_AREA_EXPONENT_MAX);
    const bis_envmap *em = status ? NULL : bis_light_envmap(light);
    if (!status) status = bis_regions_init(&r, em, levels, &diag);
    for (size_t i = 0; !status && i < (size_t)em->width * (size_t)em->height; i++) {
        const uint32_t k = label[i] = r.label[i];
        const bool lit = k != BIS_REGION_NONE;
        level[i] = lit ? r.level[k] : BIS_REGION_NONE;
        area[i] = lit ? r.solid_angle[k] : 0;
        factor[i] = lit ? bis_area_factor(r.solid_angle[k], b) : 0;
    }
    if (!status) *n = r.n;
    bis_regions_clear(&r);
    return bis_flat_end(status, &diag, say, size);
}

/* ---- thesis 3.5: materials ---- */

int bis_flat_bsdf_albedo(const bis_bsdf *bsdf, const double *normal, int n, double *sum, char *say, size_t size)
{
    bis_diag diag = {0};
    bis_status status = BIS_FLAT_GIVEN(&diag, bsdf, normal, sum);

    if (!status && !(n >= 1 && n <= 4096))
        status = bis_error(&diag, BIS_INPUT, nowhere, "n is %d: give 1 to 4096", n);
    vec3 up;
    if (!status) status = bis_flat_unit(&up, "normal", normal, &diag);
    if (status) return bis_flat_end(status, &diag, say, size);
    const frame about = frame_about(up);
    const double cell = 2 * PI / n / n;
    double reflected = 0, above = 0;
    for (int i = 0; i < n * n; i++) {
        const double cosine = (i / n + 0.5) / n;
        const vec3 wi = to_world(&about, bis_warp_cosine(1 - cosine * cosine, (i % n + 0.5) / n));
        reflected += cell * cosine * rgb_sum(bis_bsdf_f(bsdf, wi)) / 3;
        above += cell * bis_bsdf_pdf(bsdf, wi);
    }
    memcpy(sum, (double[]){reflected, above, 1 - above}, 3 * sizeof *sum);
    return bis_flat_end(BIS_OK, &diag, say, size);
}

int bis_flat_bsdf_plane(const bis_bsdf *bsdf, const double *normal, size_t n, const double *degrees, double *f_cos,
                        double *pdf, char *say, size_t size)
{
    bis_diag diag = {0};
    bis_status status = BIS_FLAT_GIVEN(&diag, bsdf, normal);

    vec3 up;
    if (!status && n > 0) status = BIS_FLAT_GIVEN(&diag, degrees, f_cos, pdf);
    if (!status) status = bis_flat_unit(&up, "normal", normal, &diag);
    if (status) return bis_flat_end(status, &diag, say, size);
    /* away from the eye; 0 where it looks straight down */
    const vec3 across = sub(mul(up, dot(up, bsdf->wo)), bsdf->wo);
    const vec3 side = dot(across, across) > 0 ? normalize(across) : frame_about(up).x;
    for (size_t i = 0; !status && i < n; i++) {
        const double t = degrees[i] * PI / 180;
        if (!isfinite(t)) {
            status = bis_error(&diag, BIS_INPUT, nowhere, "angle %zu is %g: give a number", i, degrees[i]);
            break;
        }
        const vec3 wi = normalize(add(mul(up, cos(t)), mul(side, sin(t))));
        f_cos[i] = (double)bis_bsdf_f(bsdf, wi).r * fmax(0, bis_bsdf_cos(bsdf, wi));
        pdf[i] = bis_bsdf_pdf(bsdf, wi);
    }
    return bis_flat_end(status, &diag, say, size);
}

int bis_flat_bsdf_below(const bis_bsdf *bsdf, size_t n, const float *wi, uint8_t *below, uint32_t *count, char *say,
                        size_t size)
{
    bis_diag diag = {0};
    bis_status status = BIS_FLAT_GIVEN(&diag, bsdf, count);

    if (!status && n > 0) status = BIS_FLAT_GIVEN(&diag, wi, below);
    if (status) return bis_flat_end(status, &diag, say, size);
    *count = 0;
    for (size_t i = 0; !status && i < n; i++) {
        const double cosine = bis_bsdf_cos(bsdf, (vec3){wi[3 * i], wi[3 * i + 1], wi[3 * i + 2]});
        if (isnan(cosine)) status = bis_error(&diag, BIS_INPUT, nowhere, "direction %zu is no number", i);
        *count += below[i] = cosine <= 0;
    }
    return bis_flat_end(status, &diag, say, size);
}

/* ---- pictures ---- */

int bis_flat_compare(int width, int height, const float *a, const float *b, double *sum, char *say, size_t size)
{
    bis_diag diag = {0};
    bis_image image[2] = {{0}, {0}};
    bis_comparison c;
    bis_status status = BIS_FLAT_GIVEN(&diag, a, b, sum);

    for (int k = 0; k < 2 && !status; k++) {
        const float *from = k ? b : a;
        status = bis_image_init(&image[k], width, height, &diag);
        for (size_t i = 0; !status && i < (size_t)width * (size_t)height; i++)
            image[k].pixels[i] = (rgb){from[4 * i], from[4 * i + 1], from[4 * i + 2]};
    }
    if (!status) status = bis_compare(&c, &image[0], &image[1], &diag);
    if (!status) memcpy(sum, (double[]){c.rmse, c.relmse, c.bias}, 3 * sizeof *sum);
    for (int k = 0; k < 2; k++) bis_image_clear(&image[k]);
    return bis_flat_end(status, &diag, say, size);
}
