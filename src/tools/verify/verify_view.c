/* verify_view: is what an integrator computes at a point of the scene what eq. 3.2 says?
 *
 * The reference visits every lit patch of the light with a few rays at random places in it, so that its own error is
 * known. It is a loop of its own here, which shares light, material and accelerator with src/thesis/exact.c, not its code;
 * `exact` is one of the tested.
 *
 * An integrator's mean over many runs is compared with it by Student's t. That is only fair where the mean is normally
 * distributed, and under a sun BRDF sampling is not: with 3 expected hits, a run of bad luck is 5 standard errors away.
 * So the loop also sums F^2/q, F^3/q^2 and max F/q for each estimator's density q: where its mean is too skew for a
 * t-test, Bernstein's inequality bounds p instead, which holds for any bounded variables (and finds less); where it has
 * no such bound, the test is skipped with a word.
 *   Skewness: for a mean of skewness s, tails at 4 standard errors are off by about exp(s 4^3/3): 3 for s = 0.05.
 *   Bernstein (1927): P(|mean - mu| >= e) <= 2 exp(-n e^2 / (2 E[X^2] + 2 B e/3)), 0 <= X <= B. */
#include "verify.h"

#include "bis/base/mem.h"

#include <assert.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>

enum { REPLICATES = 4, EXACT_RUNS = 2, MAX_ESTIMATORS = BIS_VERIFY_MAX_INTEGRATORS, BLOCK = 4096, LEAST_ACCEPTED = 1000 };

static const double most_skewness = 0.05;
static const double least_seen = 0.03; /* of the light: below, a handful of rays decides, and no test is fair */
static const uint64_t purpose_reference = (uint64_t)0x78 << 40;

/* ---- many runs ---- */

bis_status bis_verify_runs(rgb *estimate, uint32_t n, const bis_point *pt, const bis_settings *s, bis_sampler_kind kind, uint64_t seed,
                           bis_counters *counters, bis_diag *diag)
{
    const bis_sampler sampler = {.kind = kind, .seed = seed, .spp = 1, .xsamples = 1, .ysamples = 1, .jitter = true};
    atomic_bool failed = false;
    uint64_t accepted = 0, fallbacks = 0, rays = 0;

#pragma omp parallel reduction(+ : accepted, fallbacks, rays)
    {
        bis_counters own = {0};
        bis_point mine = *pt;
        bis_scratch scratch;
        const bool ok = bis_scratch_init(&scratch, s, NULL) == BIS_OK;
        mine.counters = &own;
        if (!ok) failed = true;
#pragma omp for schedule(dynamic, 16)
        for (uint32_t run = 0; run < n; run++) {
            bis_stream stream;
            if (!ok) continue;
            bis_stream_init(&stream, &sampler, run, 0);
            estimate[run] = s->integrator->Lo(s, &mine, &stream, &scratch);
        }
        accepted += own.accepted;
        fallbacks += own.fallbacks;
        rays += own.shadow_rays;
        if (ok) bis_scratch_clear(&scratch);
    }
    counters->accepted += accepted;
    counters->fallbacks += fallbacks;
    counters->shadow_rays += rays;
    return failed ? bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for a thread's workspace") : BIS_OK;
}

/* ---- the reference ---- */

/* The density of an estimator's single samples, from_map q_L + from_bsdf q_f; n of them in a run; both 0: not known. */
typedef struct density {
    double from_map, from_bsdf, n;
} density;

static density density_of(const bis_settings *s, bool constant)
{
    const char *name = s->integrator->name;
    if (strcmp(name, "em") == 0) return (density){1, 0, s->samples};
    if (strcmp(name, "brdf") == 0) return (density){0, 1, s->samples};
    if (strcmp(name, "mis") == 0) return (density){s->split, 1 - s->split, s->samples};
    if (strcmp(name, "sir") != 0 && strcmp(name, "unoccluded") != 0) return (density){0, 0, 0};
    if (s->proposal == BIS_PROPOSAL_BRDF || constant) return (density){0, 1, s->candidates};
    return s->proposal == BIS_PROPOSAL_EM ? (density){1, 0, s->candidates} : (density){0.5, 0.5, s->candidates};
}

/* A sum over independent parts, each known as the mean of REPLICATES values. Its error comes from what the values
 * scatter within each part: nearly exact, with as many degrees of freedom as there are parts that matter (Satterthwaite
 * 1946). */
typedef struct part_sum {
    double mean, variance; /* of the sum of means */
    double squares;        /* sum over parts of variance^2 */
} part_sum;

static void add_part(part_sum *e, const double x[REPLICATES])
{
    double mean = 0, m2 = 0;
    for (int k = 0; k < REPLICATES; k++) mean += x[k] / REPLICATES;
    for (int k = 0; k < REPLICATES; k++) m2 += (x[k] - mean) * (x[k] - mean);
    const double variance = m2 / (REPLICATES - 1) / REPLICATES;
    e->mean += mean;
    e->variance += variance;
    e->squares += variance * variance;
}

static double dof_of(const part_sum *e) { return e->squares > 0 ? (REPLICATES - 1) * e->variance * e->variance / e->squares : REPLICATES - 1; }

static void add_part_sum(part_sum *a, const part_sum *b)
{
    a->mean += b->mean;
    a->variance += b->variance;
    a->squares += b->squares;
}

/* Reflected radiance with V and without, and the moments of each estimator's single samples. */
typedef struct reference {
    part_sum lit, open;
    double second[MAX_ESTIMATORS], third[MAX_ESTIMATORS], most[MAX_ESTIMATORS];
} reference;

static void add_reference(reference *a, const reference *b)
{
    add_part_sum(&a->lit, &b->lit);
    add_part_sum(&a->open, &b->open);
    for (int i = 0; i < MAX_ESTIMATORS; i++) {
        a->second[i] += b->second[i];
        a->third[i] += b->third[i];
        a->most[i] = fmax(a->most[i], b->most[i]);
    }
}

static void add_moments(reference *ref, const bis_point *pt, const density *q, size_t n, vec3 wi, double q_f, double x, double area)
{
    const double q_L = bis_light_pdf(pt->light, wi);
    for (size_t i = 0; i < n; i++) {
        const double qi = q[i].from_map * q_L + q[i].from_bsdf * q_f;
        if (qi <= 0) continue;
        ref->second[i] += x * x / qi * area;
        ref->third[i] += x * x * x / (qi * qi) * area;
        ref->most[i] = fmax(ref->most[i], x / qi);
    }
}

/* F dO at one place in a patch, with V and without. False: black, and so is all of the patch. */
static bool add_ray(reference *ref, const bis_point *pt, const density *q, size_t n, size_t patch, const double u[2], double *lit, double *open)
{
    bis_light_point y;
    double q_f;

    *lit = *open = 0;
    bis_light_patch(pt->light, patch, u, &y);
    if (rgb_is_black(y.Le)) return false;
    const double c = bis_bsdf_cos(&pt->bsdf, y.wi), area = 1 / y.pdf;
    if (c <= 0) return true;
    const rgb f = bis_bsdf_f_pdf(&pt->bsdf, y.wi, &q_f);
    const rgbd F = {(double)f.r * (double)y.Le.r * c, (double)f.g * (double)y.Le.g * c, (double)f.b * (double)y.Le.b * c};
    const double x = bis_verify_measure(F);
    if (x <= 0) return true;
    *open = x * area;
    if (!bis_point_sees(pt, y.wi)) return true;
    *lit = x * area;
    add_moments(ref, pt, q, n, y.wi, q_f, x, area / REPLICATES);
    return true;
}

static void add_patch(reference *ref, const bis_point *pt, const density *q, size_t n, size_t patch, bis_rng *rng)
{
    double lit[REPLICATES], open[REPLICATES];

    for (int k = 0; k < REPLICATES; k++) {
        const double u0 = bis_rng_double(rng), u[2] = {u0, bis_rng_double(rng)};
        if (!add_ray(ref, pt, q, n, patch, u, &lit[k], &open[k])) return;
    }
    add_part(&ref->lit, lit);
    add_part(&ref->open, open);
}

/* All patches; blocks are added in their order, whatever the threads. */
static bis_status visit_patches(reference *ref, const bis_point *pt, const density *q, size_t n, uint64_t seed, bis_diag *diag)
{
    const size_t n_patches = bis_light_patches(pt->light), n_blocks = (n_patches + BLOCK - 1) / BLOCK;
    reference *blocks = bis_alloc(n_blocks, sizeof *blocks);

    *ref = (reference){0};
    if (!blocks) return bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for a sum over %zu patches", n_patches);
#pragma omp parallel for schedule(dynamic)
    for (size_t block = 0; block < n_blocks; block++) {
        bis_counters counters = {0};
        bis_point mine = *pt;
        bis_rng rng;
        mine.counters = &counters;
        bis_rng_init(&rng, seed, block, 0, purpose_reference);
        for (size_t i = block * BLOCK; i < n_patches && i < (block + 1) * BLOCK; i++) add_patch(&blocks[block], &mine, q, n, i, &rng);
    }
    for (size_t block = 0; block < n_blocks; block++) add_reference(ref, &blocks[block]);
    bis_free(blocks);
    return BIS_OK;
}

/* ---- means ---- */

typedef struct moments {
    double n, mean, m2;
} moments;

static void add_value(moments *m, double x)
{
    const double d = x - m->mean;
    m->n++;
    m->mean += d / m->n;
    m->m2 += d * (x - m->mean);
}

/* ---- one integrator ---- */

typedef struct comparison {
    const char *name, *integrator;
    const moments *runs;
    const part_sum *truth;
    double second, third, most, n; /* of single samples; n of them in all; 0: not known */
    uint64_t accepted;
    bool draws_independent;        /* the samples of a run, given their strata */
} comparison;

/* Welch's t. `exact` has too few runs of its own and borrows the variance of the reference, which is the same
 * estimator. Where the reference's error counts, a sun's edge, say, known from few rays, Welch's degrees of freedom
 * promise too much: the smaller ones are taken. */
static void judge_by_t(bis_verify *v, const comparison *c, double slack)
{
    const double n = c->runs->n, b = c->truth->variance, dof_truth = dof_of(c->truth);
    const bool is_exact = n == EXACT_RUNS;
    const double a = is_exact ? b * REPLICATES / n : c->runs->m2 / (n - 1) / n;
    const double dof = is_exact || b > 0.1 * a ? fmin(dof_truth, is_exact ? dof_truth : n - 1) : n - 1;
    bis_verify_difference(v, "view", c->runs->mean - c->truth->mean, slack, sqrt(a + b), dof, "%s: %s", c->name, c->integrator);
}

static void judge_by_bernstein(bis_verify *v, const comparison *c, double slack, double samples_in_run)
{
    /* Places inside patches are random: the largest F/q may be missed by some, the sum of squares by little. */
    const double B = 2 * c->most * (c->draws_independent ? 1 : samples_in_run), second = 1.1 * c->second;
    const double difference = c->runs->mean - c->truth->mean;
    const double e = fmax(0, fabs(difference) - slack - 4 * sqrt(c->truth->variance));
    bis_verify_p(v, "view", copysign(e, difference) / sqrt(second / c->n), 2 * exp(-c->n * e * e / (2 * second + 2 * B * e / 3)),
                 "z; rare and bright: p bounded by Bernstein's inequality", "%s: %s", c->name, c->integrator);
}

static void judge(bis_verify *v, const comparison *c, const density *q)
{
    const double mu = c->truth->mean, slack = 2e-6 * fabs(mu); /* runs are rounded to float, unit vectors are unit to 1e-7 */
    const double variance = c->second - mu * mu;
    const double skewness = q->n > 0 && variance > 0 ? (c->third - 3 * mu * c->second + 2 * mu * mu * mu) / pow(variance, 1.5) / sqrt(c->n) : 0;

    if (strcmp(c->integrator, "rejection") == 0 && c->accepted < LEAST_ACCEPTED) {
        char why[120];
        snprintf(why, sizeof why, "only %llu of its candidates were accepted: too few to judge", (unsigned long long)c->accepted);
        bis_verify_skip(v, "view", why, "%s: %s", c->name, c->integrator);
    } else if (fabs(skewness) <= most_skewness) {
        judge_by_t(v, c, slack);
    } else if (strcmp(c->integrator, "sir") == 0) {
        bis_verify_skip(v, "view", "a few candidates outweigh all others here: too few runs to judge", "%s: %s", c->name, c->integrator);
    } else {
        judge_by_bernstein(v, c, slack, q->n);
    }
}

/* As many runs as take about as long as those of the others. */
static uint32_t runs_for(const bis_settings *s)
{
    const char *name = s->integrator->name;
    if (strcmp(name, "exact") == 0) return EXACT_RUNS;
    const bool by_candidates = strcmp(name, "sir") == 0 || strcmp(name, "rejection") == 0 || strcmp(name, "unoccluded") == 0;
    const double cost = by_candidates ? s->candidates + 8.0 * s->shadowrays : 8.0 * s->samples;
    return (uint32_t)fmin(fmax(round((1 << 21) / cost), 64), 1 << 14);
}

static bis_status compare(bis_verify *v, const bis_point *pt, const bis_settings *s, size_t i, const density *q, const reference *ref,
                          bis_sampler_kind kind, const char *name, bis_diag *diag)
{
    const uint32_t n = runs_for(s);
    rgb *estimate = bis_alloc(n, sizeof *estimate);
    bis_counters counters = {0};
    moments runs = {0};

    if (!estimate) return bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for %u runs", (unsigned)n);
    bis_status status = bis_verify_runs(estimate, n, pt, s, kind, bis_verify_seed(v), &counters, diag);
    for (uint32_t run = 0; run < n; run++) {
        add_value(&runs, bis_verify_measure((rgbd){(double)estimate[run].r, (double)estimate[run].g, (double)estimate[run].b}));
    }
    bis_free(estimate);
    if (status) return status;
    const comparison c = {
        .name = name,
        .integrator = s->integrator->name,
        .runs = &runs,
        .truth = strcmp(s->integrator->name, "unoccluded") == 0 ? &ref->open : &ref->lit,
        .second = ref->second[i],
        .third = ref->third[i],
        .most = ref->most[i],
        .n = q[i].n * n,
        .accepted = counters.accepted,
        .draws_independent = !bis_sampler_is_low_discrepancy(kind),
    };
    judge(v, &c, &q[i]);
    return BIS_OK;
}

bis_status bis_verify_point(bis_verify *v, const bis_point *pt, const bis_settings *settings, size_t n, bis_sampler_kind kind, const char *name,
                            bool *tested, bis_diag *diag)
{
    density q[MAX_ESTIMATORS] = {0};
    reference ref;
    bis_status status;

    *tested = false;
    assert(n <= MAX_ESTIMATORS);
    for (size_t i = 0; i < n; i++) q[i] = density_of(&settings[i], bis_light_is_constant(pt->light));
    status = visit_patches(&ref, pt, q, n, bis_verify_seed(v), diag);
    if (status || !(ref.lit.mean > least_seen * ref.open.mean)) return status;
    *tested = true;
    for (size_t i = 0; i < n && !status; i++) status = compare(v, pt, &settings[i], i, q, &ref, kind, name, diag);
    return status;
}
