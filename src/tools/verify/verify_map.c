/* SPDX-License-Identifier: BSD-2-Clause */
/* verify_map: is a direction drawn from this map as its density says, and does the density say what thesis 3.3 and 3.4
 * define?
 *
 * Four questions in a row, each by another road than the one that the library takes:
 *   1. solid angles: they sum to 4 pi, and each row's is the difference of cosines, in long double;
 *   2. the density: q dO is w dO / sum, w from pixels and regions alone (docs/errata.md E3, E17), and integrates to 1;
 *   3. the table: the probability that alias tables or CDFs really give each pixel is that density times dO (E15): no
 *   chance involved;
 *   4. the draws: counted by pixel, and by 4 x 4 cells inside the pixels, equal in solid angle (E2). Dim pixels are
 *   pooled until each of the
 *      16 places expects 5 draws, so what is wrong inside pixels is seen even where each is hit rarely or never.
 * Cost: O(W H) and at most 2^22 draws of each kind; 32 bytes a pixel beside the map and one of its tables. */
#include "verify.h"

#include "bis/base/mem.h"
#include "bis/thesis/regions.h"

#include <float.h>

enum { CELLS = 4, CELLS2 = CELLS * CELLS, BLOCK = 1 << 14 };

static const uint64_t purpose_draws = (uint64_t)0x76 << 40;

static size_t n_pixels(const bis_envmap *em) { return (size_t)em->width * (size_t)em->height; }
static double solid_angle(const bis_envmap *em, size_t pixel) { return em->row_solid_angle[pixel / (size_t)em->width]; }

/* ---- 1. solid angles ---- */

void bis_verify_solid_angles(bis_verify *v, const bis_envmap *em)
{
    const long double pi = 3.14159265358979323846264338327950288L;
    const int H = em->height;
    double sum = 0, worst = 0;
    for (int y = 0; y < H; y++) {
        const long double exact = 2 * pi / em->width * (cosl(pi * y / H) - cosl(pi * (y + 1) / H));
        sum += em->width * em->row_solid_angle[y];
        worst = fmax(worst, (double)fabsl((long double)em->row_solid_angle[y] / exact - 1));
    }
    /* H additions, a few roundings in each term; the difference of cosines loses what the first row's is smaller than
     * 1. */
    bis_verify_bound(bis_verify_new(v, "map", "solid angles sum to 4 pi"), fabs(sum / (4 * PI) - 1),
                     (H + 8) * DBL_EPSILON, "relative error of their sum");
    const double cancelled = (double)(4 * LDBL_EPSILON / (1 - cosl(pi / H)));
    bis_verify_bound(bis_verify_new(v, "map", "solid angles are differences of cosines"), worst,
                     8 * DBL_EPSILON + cancelled, "largest relative error of a row");
}

/* ---- 2. the density ---- */

static bis_status weigh(double *w, const bis_envmap *em, double area_exponent, int levels, bis_diag *diag)
{
    bis_regions regions = {0};
    bis_status status = area_exponent > 0 ? bis_regions_init(&regions, em, levels, diag) : BIS_OK;
    if (status) return status;
    for (size_t i = 0; i < n_pixels(em); i++) {
        w[i] = rgb_sum(em->pixels[i]) * solid_angle(em, i);
        if (area_exponent == 0 || w[i] == 0) continue;
        const double area = pow(fmin(1, regions.solid_angle[regions.label[i]] / BIS_AREA_CLAMP), area_exponent);
        w[i] *= (double)fmaxf((float)area, FLT_TRUE_MIN); /* kept as a float by the library, too, and never 0 */
    }
    bis_regions_clear(&regions);
    return BIS_OK;
}

bis_status bis_verify_definition(double *pmf, bool *lit, const bis_envmap *em, double area_exponent, int levels,
                                 bis_diag *diag)
{
    long double sum = 0;
    const bis_status status = weigh(pmf, em, area_exponent, levels, diag);
    if (status) return status;
    for (size_t i = 0; i < n_pixels(em); i++) sum += (long double)pmf[i];
    *lit = sum > 0;
    for (size_t i = 0; *lit && i < n_pixels(em); i++) pmf[i] = (double)((long double)pmf[i] / sum);
    return BIS_OK;
}

/* |a/b - 1|; 0 where both are 0. */
static double relative(double a, double b) { return a == b ? 0 : fabs(a - b) / b; }

static void check_density(bis_verify *v, const bis_verify_drawing *d, const bis_envmap *em, const double *pmf)
{
    const size_t width = (size_t)em->width;
    long double integral = 0;
    double worst = 0;
    for (size_t i = 0; i < n_pixels(em); i++) {
        const vec3 centre = bis_envmap_direction(em, (int)(i % width), (int)(i / width), 0.5, 0.5);
        const double q = bis_importance_pdf(d->im, centre);
        integral += (long double)(q * solid_angle(em, i));
        worst = fmax(worst, pmf[i] < 1e-290 ? (q > 0) != (pmf[i] > 0) : relative(q * solid_angle(em, i), pmf[i]));
    }
    const double rounding = (em->width + em->height + 16) * DBL_EPSILON; /* of the library's sum, row by row */
    bis_verify_bound(bis_verify_new(v, "map", "%s: density as defined", d->name), worst, rounding,
                     "largest relative error of q dO against w dO / sum");
    bis_verify_bound(bis_verify_new(v, "map", "%s: density integrates to 1", d->name), fabs((double)integral - 1),
                     rounding, "error of the integral");
}

/* ---- 3. the table ---- */

static double sum_of(const double *row, size_t width)
{
    double sum = 0;
    for (size_t x = 0; x < width; x++) sum += row[x];
    return sum;
}

/* A step of a CDF is good to 2^-52 only, however small it is, and the steps of a row and of a column in it are
 * multiplied. */
static void check_table(bis_verify *v, const bis_verify_drawing *d, const bis_envmap *em, const double *implied)
{
    const size_t width = (size_t)em->width;
    double worst = 0;
    for (size_t y = 0; y < (size_t)em->height; y++) {
        const double *row = implied + y * width;
        const double p_row = d->kind == BIS_TABLE_CDF ? sum_of(row, width) : 0;
        for (size_t x = 0; x < width; x++) {
            const double claimed = bis_importance_pdf_pixel(d->im, y * width + x) * em->row_solid_angle[y];
            const double slack = p_row > 0 ? 4 * DBL_EPSILON * (p_row + claimed / p_row) : 0;
            const double excess = fmax(0, fabs(row[x] - claimed) - slack);
            if (claimed == 0) {
                worst = fmax(worst, row[x] == 0 ? 0 : 1);
            } else if (claimed >= 1e-290) {
                worst = fmax(worst, excess / claimed);
            }
        }
    }
    bis_verify_bound(bis_verify_new(v, "map", "%s: table gives that density", d->name), worst, 1e-8,
                     "largest relative error of a pixel's probability against q dO");
}

bis_status bis_verify_importance(bis_verify *v, const bis_verify_drawing *d, const bis_envmap *em, const double *pmf,
                                 bis_diag *diag)
{
    double *implied = bis_alloc(n_pixels(em), sizeof *implied);
    bis_status status;
    if (!implied)
        return bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory to verify the table of a %d x %d map", em->width,
                         em->height);
    status = bis_importance_implied_pmf(d->im, implied, diag);
    if (!status) {
        check_density(v, d, em, pmf);
        check_table(v, d, em, implied);
    }
    bis_free(implied);
    return status;
}

/* ---- 4. the draws ---- */

/* Counts of one sampler's draws; pooled pixels share a group. */
typedef struct tally {
    uint32_t *pixel;            /* pixel[height * width] */
    uint32_t *group;            /* group[height * width] */
    uint32_t (*place)[CELLS2];  /* place[n_groups]: by the cell inside the pixel */
    double *group_pmf;          /* group_pmf[n_groups] */
    size_t n_groups;
    const double *pmf;          /* pmf[n]: what is expected of each of the pixels, borrowed */
    size_t n;
    double n_draws;
    uint32_t outside, none;     /* directions not in the pixel that they claim; nothing drawn */
} tally;

static void tally_clear(tally *t)
{
    bis_free(t->pixel);
    bis_free(t->group);
    bis_free(t->place);
    bis_free(t->group_pmf);
}

/* Neighbours in reading order, until they expect 5 draws in each of the 16 places; the last group takes the rest. */
static bis_status tally_init(tally *t, const bis_envmap *em, const double *pmf, double n_draws, bis_diag *diag)
{
    const size_t n = n_pixels(em);
    const double enough = 5 * CELLS2 / n_draws;
    double sum = 0;
    *t = (tally){.pixel = bis_alloc(n, sizeof *t->pixel), .group = bis_alloc(n, sizeof *t->group),
                 .pmf = pmf, .n = n, .n_draws = n_draws};
    if (!t->pixel || !t->group) goto no_memory;
    for (size_t i = 0; i < n; i++) {
        t->group[i] = (uint32_t)t->n_groups;
        sum += pmf[i];
        if (sum < enough) continue;
        sum = 0;
        t->n_groups++;
    }
    if (t->n_groups == 0) t->n_groups = 1;
    t->place = bis_alloc(t->n_groups, sizeof *t->place);
    t->group_pmf = bis_alloc(t->n_groups, sizeof *t->group_pmf);
    if (!t->place || !t->group_pmf) goto no_memory;
    for (size_t i = 0; i < n; i++) {
        if (t->group[i] == t->n_groups) t->group[i]--;
        t->group_pmf[t->group[i]] += pmf[i];
    }
    return BIS_OK;
no_memory:
    tally_clear(t);
    return bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory to count draws from a %d x %d map", em->width,
                     em->height);
}

/* The cell of a place u in [0, 1), which a direction of three floats misses by `margin` at most; -1: outside by
 * more. */
static int cell_of(double u, double margin)
{
    if (!(u >= -margin && u <= 1 + margin)) return -1;
    return (int)(fmin(fmax(u, 0), 0.999) * CELLS);
}

/* Where in its pixel a direction lies, by its own angles: shares of longitude and, cos t0 - cos t = 2 sin((t+t0)/2)
 * sin((t-t0)/2), of solid angle. */
static int place_of(const bis_envmap *em, const bis_map_sample *s)
{
    const double W = em->width, H = em->height, margin = 0x1p-22 * fmax(W, H);
    const double x = (double)(s->pixel % (size_t)em->width), y = (double)(s->pixel / (size_t)em->width);
    const double dx = (double)s->w_local.x, dy = (double)s->w_local.y, dz = (double)s->w_local.z;
    const double t = atan2(hypot(dx, dy), dz), t0 = PI * y / H, t1 = PI * (y + 1) / H;
    double u = atan2(dy, dx) / (2 * PI) * W - x;
    u -= W * round((u - 0.5) / W);
    const double w = sin((t + t0) / 2) * sin((t - t0) / 2) / (sin((t1 + t0) / 2) * sin((t1 - t0) / 2));
    const int column = cell_of(u, margin), row = cell_of(w, margin);
    return column < 0 || row < 0 ? -1 : row * CELLS + column;
}

static void count_draw(tally *t, const bis_envmap *em, const bis_map_sample *s)
{
    const int place = s->pixel < n_pixels(em) ? place_of(em, s) : -1;
    uint32_t *counter = place < 0 ? &t->outside : &t->place[t->group[s->pixel]][place];
#pragma omp atomic
    (*counter)++;
    if (place < 0) return;
    counter = &t->pixel[s->pixel];
#pragma omp atomic
    (*counter)++;
}

static void draw_all(tally *t, const bis_verify_sampler *sampler, const bis_envmap *em, uint64_t seed, size_t n_draws)
{
#pragma omp parallel for schedule(dynamic)
    for (size_t block = 0; block < n_draws / BLOCK; block++) {
        bis_rng rng;
        bis_rng_init(&rng, seed, block, 0, purpose_draws);
        for (int i = 0; i < BLOCK; i++) {
            bis_map_sample s;
            if (sampler->draw(sampler->self, &rng, &s)) {
                count_draw(t, em, &s);
            } else {
#pragma omp atomic
                t->none++;
            }
        }
    }
}

/* Both histograms; the last cell is for what must not happen. */
static bis_status judge_draws(bis_verify *v, const char *name, const tally *t, bis_diag *diag)
{
    const size_t n = t->n, n_places = t->n_groups * CELLS2, most = (n > n_places ? n : n_places) + 1;
    double *observed = bis_alloc(most, sizeof *observed), *expected = bis_alloc(most, sizeof *expected);
    bis_status status = BIS_OK;
    if (!observed || !expected) {
        status = bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for the histograms of a map's draws");
        goto done;
    }
    for (size_t i = 0; i < n; i++) {
        observed[i] = t->pixel[i];
        expected[i] = t->n_draws * t->pmf[i];
    }
    observed[n] = (double)t->outside + (double)t->none;
    expected[n] = 0;
    bis_verify_fit(bis_verify_new(v, "map", "%s: draws by pixel", name), observed, expected, n + 1);
    for (size_t i = 0; i < n_places; i++) {
        observed[i] = t->place[i / CELLS2][i % CELLS2];
        expected[i] = t->n_draws * t->group_pmf[i / CELLS2] / CELLS2;
    }
    bis_verify_fit(bis_verify_new(v, "map", "%s: draws in 4 x 4 cells inside pixels", name), observed,
                   expected, n_places);
done:
    bis_free(observed);
    bis_free(expected);
    return status;
}

/* 8 draws a pixel of a large map, up to 256 of a small one; one block at least, whatever is halved. */
static size_t draws_for(size_t pixels, unsigned halvings)
{
    const size_t least = (size_t)1 << 16, enough = (size_t)1 << 20, most = (size_t)1 << 22;
    const double n = fmax(8.0 * (double)pixels, fmin(256.0 * (double)pixels, (double)enough));
    const size_t n_blocks = ((size_t)fmin(fmax(n, (double)least), (double)most) >> halvings) / BLOCK;
    return (n_blocks > 0 ? n_blocks : 1) * BLOCK;
}

bis_status bis_verify_draws(bis_verify *v, const bis_verify_sampler *sampler, const bis_envmap *em, const double *pmf,
                            bis_diag *diag)
{
    const size_t n_draws = draws_for(n_pixels(em), v->halvings);
    tally t;
    bis_status status = tally_init(&t, em, pmf, (double)n_draws, diag);
    if (status) return status;
    draw_all(&t, sampler, em, bis_verify_seed(v, "%s: draws", sampler->name), n_draws);
    status = judge_draws(v, sampler->name, &t, diag);
    tally_clear(&t);
    return status;
}

/* ---- all of it ---- */

static bool draw_table(const void *self, bis_rng *rng, bis_map_sample *s)
{
    double u[4];
    for (int i = 0; i < 4; i++) u[i] = bis_rng_double(rng);
    return bis_importance_sample(self, u, s);
}

static bool draw_curve(const void *self, bis_rng *rng, bis_map_sample *s)
{
    const double t = bis_rng_double(rng), u0 = bis_rng_double(rng), u[2] = {u0, bis_rng_double(rng)};
    return bis_importance_sample_curve(self, t, u, s);
}

/* One way of drawing, built, checked and freed. */
static bis_status check_way(bis_verify *v, const char *name, const bis_importance_options *options,
                            const bis_envmap *em, const double *pmf, bis_diag *diag)
{
    bis_importance *im;
    bis_status status = bis_importance_new(&im, em, options, diag);
    if (status) return status;
    const bis_verify_sampler sampler = {name, options->table ? draw_table : draw_curve, im};
    const bis_verify_drawing drawing = {name, options->table_kind, im};
    if (options->table) status = bis_verify_importance(v, &drawing, em, pmf, diag);
    if (!status) status = bis_verify_draws(v, &sampler, em, pmf, diag);
    bis_importance_free(im);
    return status;
}

bis_status bis_verify_map(bis_verify *v, const bis_envmap *em, double area_exponent, int levels, bis_diag *diag)
{
    static const struct { const char *name; bool curve; bis_table_kind kind; } ways[] = {
        {"alias", false, BIS_TABLE_ALIAS}, {"cdf", false, BIS_TABLE_CDF}, {"curve", true, BIS_TABLE_ALIAS}};
    double *pmf = bis_alloc(n_pixels(em), sizeof *pmf);
    bool lit;

    if (!pmf)
        return bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory to verify a %d x %d map", em->width, em->height);
    bis_verify_begin(v, "the map");
    bis_verify_solid_angles(v, em);
    bis_status status = bis_verify_definition(pmf, &lit, em, area_exponent, levels, diag);
    if (!status && !lit)
        bis_verify_skip(bis_verify_new(v, "map", "alias, cdf, curve"),
                        "the map gives no light, nothing can be drawn from it");
    for (size_t i = 0; !status && lit && i < sizeof ways / sizeof *ways; i++) {
        const bis_importance_options options = {.table = !ways[i].curve,
                                                .curve = ways[i].curve,
                                                .table_kind = ways[i].kind,
                                                .area_exponent = area_exponent,
                                                .levels = levels,
                                                .as_printed = v->as_printed};
        bis_verify_begin(v, ways[i].name);
        status = check_way(v, ways[i].name, &options, em, pmf, diag);
    }
    bis_free(pmf);
    return status;
}
