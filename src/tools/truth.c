/* SPDX-License-Identifier: BSD-2-Clause */
/* truth: a sum over cells, two rays at random places in each.
 *
 * With a fixed number of rays in each patch, what these scatter is no measure of the error: where a bright patch is
 * hidden by a tenth, four rays see all of it two times in three, and seem to know it exactly. So a patch is cut in
 * four, and again, until no ray can add more than B/2 to the sum, whatever V is. B comes from the bounds of F alone,
 * not from rays. Then for S = sum of Y_j, independent, 0 <= Y_j <= M: Bernstein (1927):        P(|S - E S| >= s sqrt(2
 * l) + M l/3) <= 2 exp(-l),        s^2 = sum of Var Y_j; s is not known, but the two rays of a cell are alike: Q = sum
 * over cells of (Y - Y')^2 has E Q = s^2. Its terms are independent, not negative, and E (Y - Y')^4 <= M^2 E (Y -
 * Y')^2, so (Maurer 2003, theorem 2.1) P(s^2 - Q >= e) <= exp(-e^2 / (2 M^2 s^2)), or P(s >= sqrt(Q + M^2 l/2) + M
 * sqrt(l/2)) <= exp(-l). With l = log(3/chance) both hold but for that chance. Nothing is normal here, and no scatter
 * of 0 promises an error of 0: M l remains, 40 M at a chance of 1e-7. (Maurer and Pontil 2009 call such a bound an
 * empirical Bernstein bound.)
 *
 * The bound of F in a cell: Le is constant in a patch, f cos is smooth but for its lobe, which lies about r. Where r is
 * within three radii of the cell's centre, it is the material's own max f cos. Elsewhere the lobe falls off from r, its
 * largest value lies on the cell's edge, and between a corner and the nearest place of the edge it grows less than
 * twofold where it counts: exp(-d^2/(2 w^2)) by exp(r^2/(4 w^2)), at two radii from r. So it is twice the largest of
 * corners and centre. Every ray is held against it, or B where that is larger: bis_truth.worst. */
#include "truth.h"

#include "bis/base/mem.h"
#include "bis/thesis/rng.h"

#include <assert.h>
#include <string.h>

enum { MOST_BLOCKS = 4096, MAX_DEPTH = 24, MAX_PASSES = 12, PAIR = 2 };
static const uint64_t purpose_truth = (uint64_t)0x78 << 40;

/* ---- cells ---- */

/* A square of the unit square of patch i, which is uniform in solid angle. */
typedef struct cell {
    size_t patch;
    double x, y, size;
} cell;

/* What all cells share. */
typedef struct question {
    const bis_point *pt;
    const double *weight;
    const bis_truth_density *q;
    size_t n;
    double max_f_cos;
    double B; /* of a cell; infinite: none is cut */
} question;

/* f cos Le towards y, in RGB and weighted, in units of radiance per solid angle. */
static void product(double F[4], const question *k, const bis_light_point *y, rgb f, double c)
{
    F[0] = (double)f.r * (double)y->Le.r * c;
    F[1] = (double)f.g * (double)y->Le.g * c;
    F[2] = (double)f.b * (double)y->Le.b * c;
    F[3] = k->weight[0] * F[0] + k->weight[1] * F[1] + k->weight[2] * F[2];
}

static double distance(vec3 a, vec3 b) { return (double)length(sub(a, b)); }

/* What F dO can be at most in a cell: bound of the cell's own integral, too. */
static double bound_of(const question *k, const cell *c)
{
    static const double place[5][2] = {{0.5, 0.5}, {0, 0}, {0, 1}, {1, 0}, {1, 1}};
    const bis_bsdf *b = &k->pt->bsdf;
    bis_light_point y = {.pdf = 1};
    double largest = 0, radius = 0;
    vec3 centre = {0, 0, 0};

    for (int i = 0; i < 5; i++) {
        double F[4];
        bis_light_patch(k->pt->light, c->patch, (double[]){c->x + c->size * place[i][0], c->y + c->size * place[i][1]},
                        &y);
        if (i == 0) centre = y.wi;
        radius = fmax(radius, distance(centre, y.wi));
        const double cos_theta = bis_bsdf_cos(b, y.wi);
        if (cos_theta <= 0) continue;
        product(F, k, &y, bis_bsdf_f(b, y.wi), cos_theta);
        largest = fmax(largest, F[3]);
    }
    const double Le = k->weight[0] * (double)y.Le.r + k->weight[1] * (double)y.Le.g + k->weight[2] * (double)y.Le.b;
    const double any = k->max_f_cos * Le, here = distance(centre, b->r) <= 3 * radius ? any : fmin(2 * largest, any);
    return here / y.pdf * c->size * c->size;
}

/* ---- one block of patches ---- */

typedef struct block {
    bis_truth t;          /* moments still about 0 */
    double bounds;        /* sum over cells */
    double m1, m2, m3, variance_of_m1; /* of one ray in the patch at hand */
    double q_L;           /* in all of it: a ray on its border, looked up, may be its neighbour's for rounding */
} block;

static void add_moments(block *b, const question *k, double q_f, double F, double area)
{
    for (size_t i = 0; i < k->n; i++) {
        const double q = k->q[i].from_map * b->q_L + k->q[i].from_bsdf * q_f + k->q[i].uniform / (4 * PI);
        const double x = q > 0 ? F / q : (double)INFINITY;
        bis_truth_moments *m = &b->t.sample[i];
        m->variance += F * x * area;
        m->third += F * x * x * area;
        m->most = fmax(m->most, x);
    }
}

/* F dO of a ray somewhere in a cell, with V and without. */
static void cast(double lit[4], double open[4], block *b, const question *k, const cell *c, bis_rng *rng)
{
    bis_light_point y;
    double q_f;

    const double u0 = bis_rng_double(rng), u1 = bis_rng_double(rng);
    bis_light_patch(k->pt->light, c->patch, (double[]){c->x + c->size * u0, c->y + c->size * u1}, &y);
    const double cos_theta = bis_bsdf_cos(&k->pt->bsdf, y.wi);
    const double area = c->size * c->size / y.pdf; /* solid angle of the cell */
    if (cos_theta <= 0) return;
    product(open, k, &y, bis_bsdf_f_pdf(&k->pt->bsdf, y.wi, &q_f), cos_theta);
    const double F = open[3];
    for (int i = 0; i < 4; i++) open[i] *= area;
    if (F <= 0) return;
    b->t.rays++;
    if (!bis_point_sees(k->pt, y.wi)) return;
    memcpy(lit, open, 4 * sizeof *lit);
    if (k->n) add_moments(b, k, q_f, F, area / PAIR);
}

static void add_pair(bis_truth_sum *s, double x[PAIR][4], double most)
{
    for (int i = 0; i < 4; i++) {
        s->mean[i] += (x[0][i] + x[1][i]) / PAIR;
        s->variance[i] += (x[0][i] - x[1][i]) * (x[0][i] - x[1][i]) / (PAIR * PAIR);
    }
    s->most = fmax(s->most, most / PAIR);
}

static void add_cell(block *b, const question *k, const cell *c, double bound, bis_rng *rng)
{
    double lit[PAIR][4] = {{0}}, open[PAIR][4] = {{0}};

    for (int j = 0; j < PAIR; j++) cast(lit[j], open[j], b, k, c, rng);
    const double largest = fmax(open[0][3], open[1][3]), times = 1 / (c->size * c->size);
    if (largest > 0) b->t.worst = fmax(b->t.worst, largest / fmax(bound, k->B));
    add_pair(&b->t.lit, lit, fmax(bound, largest));
    add_pair(&b->t.open, open, fmax(bound, largest));
    for (int j = 0; j < PAIR; j++) { /* a ray anywhere in the patch falls into this cell once in `times` */
        const double x = lit[j][3];
        b->m1 += x / PAIR;
        b->m2 += x * x * times / PAIR;
        b->m3 += x * x * x * times * times / PAIR;
        b->t.one_ray.most = fmax(b->t.one_ray.most, x * times);
    }
    b->variance_of_m1 += (lit[0][3] - lit[1][3]) * (lit[0][3] - lit[1][3]) / (PAIR * PAIR);
}

/* rng NULL: only the bounds are added. */
static void visit_cell(block *b, const question *k, const cell *c, int depth, bis_rng *rng)
{
    const double bound = bound_of(k, c), half = c->size / 2;

    if (bound > k->B && depth < MAX_DEPTH) {
        for (int i = 0; i < 4; i++) {
            const cell quarter = {c->patch, c->x + (i & 1) * half, c->y + (i >> 1) * half, half};
            visit_cell(b, k, &quarter, depth + 1, rng);
        }
        return;
    }
    b->bounds += bound;
    if (rng) add_cell(b, k, c, bound, rng);
}

static void visit_patch(block *b, const question *k, size_t patch, bis_rng *rng)
{
    const cell all = {patch, 0, 0, 1};
    bis_light_point y;

    bis_light_patch(k->pt->light, patch, (double[]){0.5, 0.5}, &y);
    if (rgb_is_black(y.Le)) return;
    b->m1 = b->m2 = b->m3 = b->variance_of_m1 = 0;
    if (rng && k->n) b->q_L = bis_light_pdf(k->pt->light, y.wi);
    visit_cell(b, k, &all, 0, rng);
    b->t.one_ray.variance += b->m2 - b->m1 * b->m1 + b->variance_of_m1; /* E[m1^2] = (E m1)^2 + Var m1: unbiased */
    b->t.one_ray.third += b->m3 - 3 * b->m1 * b->m2 + 2 * b->m1 * b->m1 * b->m1;
}

/* ---- all blocks ---- */

static void add_sum(bis_truth_sum *a, const bis_truth_sum *b)
{
    for (int i = 0; i < 4; i++) {
        a->mean[i] += b->mean[i];
        a->variance[i] += b->variance[i];
    }
    a->most = fmax(a->most, b->most);
}

static void add_sample(bis_truth_moments *a, const bis_truth_moments *b)
{
    a->variance += b->variance;
    a->third += b->third;
    a->most = fmax(a->most, b->most);
}

static void add_block(bis_truth *t, double *bounds, const block *b)
{
    add_sum(&t->lit, &b->t.lit);
    add_sum(&t->open, &b->t.open);
    add_sample(&t->one_ray, &b->t.one_ray);
    for (int i = 0; i < BIS_TRUTH_MAX_DENSITIES; i++) add_sample(&t->sample[i], &b->t.sample[i]);
    t->worst = fmax(t->worst, b->t.worst);
    t->rays += b->t.rays;
    *bounds += b->bounds;
}

/* All patches in blocks, which are added in their order, whatever the threads. Returns the sum of the bounds. */
static double visit_all(bis_truth *t, block *blocks, const question *k, bool with_rays, uint64_t seed)
{
    const size_t n = t->patches, size = (n + MOST_BLOCKS - 1) / MOST_BLOCKS, n_blocks = (n + size - 1) / size;
    double bounds = 0;

#pragma omp parallel for schedule(dynamic)
    for (size_t i = 0; i < n_blocks; i++) {
        bis_counters counters = {0};
        bis_point mine = *k->pt;
        question own = *k;
        bis_rng rng;
        mine.counters = &counters;
        own.pt = &mine;
        bis_rng_init(&rng, seed, i, 0, purpose_truth);
        blocks[i] = (block){.bounds = 0};
        for (size_t p = i * size; p < n && p < (i + 1) * size; p++)
            visit_patch(&blocks[i], &own, p, with_rays ? &rng : NULL);
    }
    for (size_t i = 0; i < n_blocks; i++) add_block(t, &bounds, &blocks[i]);
    return bounds;
}

/* From moments about 0 to central ones. */
static void centre(bis_truth_moments *m, double mean)
{
    m->third += mean * (2 * mean * mean - 3 * m->variance);
    m->variance -= mean * mean;
}

bis_status bis_truth_of(bis_truth *t, const bis_truth_question *asked, bis_diag *diag)
{
    const bis_point *pt = asked->pt;
    question k = {pt, asked->weight, asked->q, asked->n, bis_bsdf_max_f_cos(&pt->bsdf), (double)INFINITY};
    block *blocks = bis_alloc(MOST_BLOCKS, sizeof *blocks);

    assert(asked->n <= BIS_TRUTH_MAX_DENSITIES);
    *t = (bis_truth){.patches = bis_light_patches(pt->light)};
    if (!blocks) return bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for a sum over %zu patches", t->patches);
    /* B from the bounds of whole patches; where these are far too large, for a lobe narrower than a patch, say, from
     * those of the cells that it made, and so on. */
    double bounds = visit_all(t, blocks, &k, false, 0), before = (double)INFINITY;
    for (int pass = 0; pass < MAX_PASSES && bounds < before / 2; pass++) {
        k.B = bounds / asked->cells;
        before = bounds;
        bounds = visit_all(t, blocks, &k, false, 0);
    }
    visit_all(t, blocks, &k, true, asked->seed);
    bis_free(blocks);
    for (size_t i = 0; i < asked->n; i++) centre(&t->sample[i], t->lit.mean[3]);
    return BIS_OK;
}

/* ---- the error ---- */

/* But for exp(-l). */
static double deviation(const bis_truth_sum *s, double l)
{
    return sqrt(s->variance[3] + s->most * s->most * l / 2) + s->most * sqrt(l / 2);
}

double bis_truth_deviation(const bis_truth_sum *s, double chance) { return deviation(s, -log(chance)); }

double bis_truth_bound(const bis_truth_sum *s, double chance)
{
    const double l = log(3 / chance);
    return deviation(s, l) * sqrt(2 * l) + s->most * l / 3;
}
