/* SPDX-License-Identifier: BSD-2-Clause */
/* verify_view: is what an integrator computes at a point of the scene what eq. 3.2 says?
 *
 * The reference (src/tools/truth.c) is a sum over all patches of the light, known within e but for a chance of 1e-7. An
 * integrator's mean over many runs may differ from it by e and by what its own scatter explains: p is the chance of the
 * rest of the difference, plus 1e-7.
 *
 * Student's t tells that chance where a mean is normally distributed, and under a sun that of BRDF sampling is not:
 * with 3 expected hits, a run of bad luck is 5 standard errors away. So the reference also tells variance, skewness and
 * largest value of the single samples F/q, q being the density of the estimator, as if they were independent. A small
 * skewness s of the mean enlarges p (bis_verify_t). A skewness that the runs tell counts as well, and where no other is
 * known it may be BIS_VERIFY_MOST_SKEWNESS. For |s| beyond that, Bernstein's inequality bounds p, which holds for any
 * bounded variables, and finds less (1927): P(|mean - mu| >= e) <= 2 exp(-n e^2 / (2 E[X^2] + 2 B e/3)), 0 <= X <= B.
 *   Where the density is not known, the test is skipped with a word. An integrator that is none of ours may miss a lamp
 * in all its runs, which then look as if they hardly scattered. It is held to what directions uniform over the sphere
 * would do: where it is too dark, p is at least their Bernstein's bound. */
#include "verify.h"

#include "base/text.h"
#include "bis/base/mem.h"
#include "bis/base/stats.h"

#include "beyond/guide.h"
#include "tools/truth.h"

#include <assert.h>
#include <stdatomic.h>
#include <stdio.h>

enum { LEAST_ACCEPTED = 1000, RUNS_WITH_CLUSTERS = 256 };
enum { CELLS = 1 << 15 /* the reference is good to 2e-3 of what were there without shadows */ };

static const double most_skewness = 0.05; /* where Bernstein's inequality can take over */
static const double least_seen = 0.03;  /* of the light: below, a handful of rays decides, and no test is fair */
static const double most_unknown = 0.05; /* of the reference: beyond, it judges nobody */
static const double chance = 1e-7;      /* that a reference is farther off than it says */

/* ---- many runs ---- */

bis_status bis_verify_runs(rgb *estimate, const bis_verify_job *job, bis_counters *counters, bis_diag *diag)
{
    const bis_settings *s = job->settings;
    const bis_point *pt = job->pt;
    bis_sampler sampler = {.kind = job->kind, .seed = job->seed};
    atomic_bool failed = false;
    uint64_t accepted = 0, fallbacks = 0, rays = 0;

    bis_sampler_set_spp(&sampler, 1);
#pragma omp parallel reduction(+ : accepted, fallbacks, rays)
    {
        bis_counters own = {0};
        bis_point mine = *pt;
        bis_probe probe;
        const bool ok = bis_probe_init(&probe, s, pt->light, NULL) == BIS_OK;
        mine.counters = &own;
        if (!ok) failed = true;
#pragma omp for schedule(dynamic, 16)
        for (uint32_t run = 0; run < job->n; run++) {
            bis_stream stream;
            if (!ok || (job->stop && *job->stop)) continue;
            bis_stream_init(&stream, &sampler, run, 0);
            bis_probe_begin_pass(&probe, pt->light, job->seed, run); /* the runs share nothing */
            estimate[run] = s->integrator->Lo(s, &mine, &stream, &probe.scratch);
        }
        accepted += own.accepted;
        fallbacks += own.fallbacks;
        rays += own.shadow_rays;
        if (ok) bis_probe_clear(&probe);
    }
    counters->accepted += accepted;
    counters->fallbacks += fallbacks;
    counters->shadow_rays += rays;
    if (job->stop && *job->stop) return bis_error(diag, BIS_INPUT, (bis_loc){0}, "the estimates were stopped");
    return failed ? bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for a thread's workspace") : BIS_OK;
}

/* ---- the reference ---- */

/* The density of an estimator's single samples, n of them in a run. n = 0: not known. is_guess: the integrator is none
 * of ours, and n will be its shadow rays. sample: what the reference says of one of them; NULL: not known. */
typedef struct sampling {
    bis_truth_density q;
    double n;
    bool is_guess;
    const bis_truth_moments *sample;
} sampling;

static sampling sampling_of(const bis_settings *s, bool constant)
{
    const bis_integrator *i = s->integrator;
    if (i == &bis_em) return (sampling){.q = {.from_map = 1}, .n = s->samples};
    if (i == &bis_brdf) return (sampling){.q = {.from_bsdf = 1}, .n = s->samples};
    if (i == &bis_mis) return (sampling){.q = {.from_map = s->split, .from_bsdf = 1 - s->split}, .n = s->samples};
    if (i == &bis_rejection || i == &bis_exact || bis_beyond_needs_of(s).clusters) return (sampling){.n = 0};
    if (i != &bis_sir && i != &bis_unoccluded) return (sampling){.q = {.uniform = 1}, .n = 1, .is_guess = true};
    if (s->proposal == BIS_PROPOSAL_EM) return (sampling){.q = {.from_map = 1}, .n = s->candidates};
    if (s->proposal == BIS_PROPOSAL_BRDF || constant) return (sampling){.q = {.from_bsdf = 1}, .n = s->candidates};
    return (sampling){.q = {.from_map = 0.5, .from_bsdf = 0.5}, .n = s->candidates};
}

/* ---- one integrator ---- */

typedef struct comparison {
    const char *name;
    const bis_integrator *integrator;
    const bis_verify_moments *runs;
    const bis_truth_sum *truth;
    const bis_truth_moments *sample; /* NULL: not known */
    double n;                        /* samples in a run */
    bool is_guess;                   /* both of these */
    double deviation;                /* of a run, where it is known beforehand; else NAN */
    uint64_t accepted;
    bool draws_independent;          /* the samples of a run, given their strata */
} comparison;

/* What neither rounding nor the reference's error explains. Runs are rounded to float, unit vectors are unit to 1e-7.
 */
static double excess_of(const comparison *c)
{
    const double difference = c->runs->mean - c->truth->mean[3];
    return copysign(fmax(0, fabs(difference) - 2e-6 * fabs(c->truth->mean[3]) - bis_truth_bound(c->truth, chance)),
                    difference);
}

static void put(bis_verify_test *t, const comparison *c, double z, double p, const char *what)
{
    char note[120], bound[BIS_PERCENT];
    snprintf(note, sizeof note, "z; %ssum over patches +- %s", what,
             bis_percent(bound, bis_truth_bound(c->truth, chance) / c->truth->mean[3]));
    bis_verify_p(t, z, p + chance, note);
}

/* Places inside patches are random: the largest F/q may be missed by some, the sum of squares by little. */
static double second_of(const comparison *c)
{
    const double mu = c->truth->mean[3];
    return 1.1 * (c->sample->variance + mu * mu);
}

static double p_by_bernstein(const comparison *c)
{
    const double B = 2 * c->sample->most * (c->draws_independent ? 1 : c->n), n = c->n * c->runs->n, e = excess_of(c);
    return 2 * exp(-n * e * e / (2 * second_of(c) + 2 * B * fabs(e) / 3));
}

static void judge_by_t(bis_verify_test *t, const comparison *c, double skewness)
{
    const double n = c->runs->n, e = excess_of(c), known = c->deviation;
    const double se = isnan(known) ? sqrt(c->runs->m2 / (n - 1) / n) : known / sqrt(n);
    const double z = e == 0 ? 0 : se > 0 ? e / se : copysign((double)INFINITY, e); /* runs that are all alike */
    const double p = z == 0 ? 1 : bis_verify_t(z, isnan(known) ? n - 1 : (double)INFINITY, skewness);
    const double least = c->is_guess && z < 0 ? fmin(1, p_by_bernstein(c)) : 0;
    put(t, c, z, fmax(p, least), least > p ? "p is that of uniform directions, which may miss what is bright; " : "");
}

static void judge_by_bernstein(bis_verify_test *t, const comparison *c)
{
    put(t, c, excess_of(c) / sqrt(second_of(c) / (c->n * c->runs->n)), p_by_bernstein(c),
        "rare and bright: p bounded by Bernstein's inequality; ");
}

static void judge(bis_verify *v, const comparison *c)
{
    bis_verify_test *t = bis_verify_new(v, "view", "%s: %s", c->name, c->integrator->name);
    const bool is_known = c->sample && !c->is_guess && c->sample->variance > 0;
    const double given = is_known ? c->sample->third / pow(c->sample->variance, 1.5) / sqrt(c->n * c->runs->n) : 0;
    const double skewness = fmax(fabs(given), isnan(c->deviation) ? fabs(bis_verify_skewness(c->runs)) : 0);

    if (isnan(c->runs->mean)) {
        bis_verify_p(t, c->runs->mean, 0, "not a number");
    } else if (bis_parameter_of(c->integrator, "estimator") && c->accepted < LEAST_ACCEPTED) {
        char why[120];
        snprintf(why, sizeof why, "only %llu of its candidates were accepted: too few to judge",
                 (unsigned long long)c->accepted);
        bis_verify_skip(t, why);
    } else if (skewness <= (is_known ? most_skewness : BIS_VERIFY_MOST_SKEWNESS)) {
        judge_by_t(t, c, skewness);
    } else if (bis_parameter_of(c->integrator, "resampling")) {
        bis_verify_skip(t, "a few candidates outweigh all others here: too few runs to judge");
    } else if (!is_known) {
        bis_verify_skip(t, "a few runs outweigh all others here: too few to judge");
    } else {
        judge_by_bernstein(t, c);
    }
}

double bis_verify_cost(const bis_settings *s, size_t patches)
{
    if (bis_parameter_of(s->integrator, "perpatch")) return 8.0 * s->perpatch * (double)patches;
    if (bis_parameter_of(s->integrator, "candidates")) return s->candidates + 8.0 * s->shadowrays;
    return 8.0 * s->samples;
}

/* As many runs as take about as long as those of the others. With clusters a run takes 1 to 3 ms, because it draws some
 * 30,000 directions of its own: runs that shared them would have one error together. */
static uint32_t runs_for(const bis_settings *s, size_t patches, unsigned halvings)
{
    if (bis_beyond_needs_of(s).clusters) return (uint32_t)fmax(RUNS_WITH_CLUSTERS >> halvings, 64);
    if (bis_parameter_of(s->integrator, "perpatch"))
        return (uint32_t)fmin(fmax(ceil((double)(1 << 18 >> halvings) / (double)patches), 2), 1 << 12);
    return (uint32_t)fmin(fmax(round((1 << 21 >> halvings) / bis_verify_cost(s, patches)), 64), 1 << 14);
}

static bis_status compare(bis_verify *v, const bis_verify_place *at, const bis_truth *truth, const bis_settings *s,
                          const sampling *how, bis_diag *diag)
{
    const bool is_exact = bis_parameter_of(s->integrator, "perpatch") != NULL;
    const uint32_t n = runs_for(s, truth->patches, v->halvings);
    rgb *estimate = bis_alloc(n, sizeof *estimate);
    bis_counters counters = {0};
    bis_verify_moments runs = {0};

    if (!estimate) return bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for %u runs", (unsigned)n);
    const uint64_t seed = bis_verify_seed(v, "%s: %s", at->name, s->integrator->name);
    bis_status status =
        bis_verify_runs(estimate, &(bis_verify_job){at->pt, s, at->kind, n, seed, NULL}, &counters, diag);
    for (uint32_t run = 0; run < n; run++) {
        bis_verify_add(&runs, bis_verify_measure(
                                  (rgbd){(double)estimate[run].r, (double)estimate[run].g, (double)estimate[run].b}));
    }
    bis_free(estimate);
    if (status) return status;
    /* `exact` has few runs, and its variance is that of one ray in each patch. That is known from pairs, as the
     * reference's own is, and with the same bound: no patch that is one cell adds more than its bound. */
    const bis_truth_sum one_ray = {.variance = {0, 0, 0, fmax(0, truth->one_ray.variance)},
                                   .most = 2 * truth->lit.most};
    const comparison c = {
        .name = at->name,
        .integrator = s->integrator,
        .runs = &runs,
        .truth = s->integrator->without_shadows ? &truth->open : &truth->lit,
        .sample = is_exact ? &truth->one_ray : how->sample,
        .n = is_exact ? 1 : how->is_guess ? fmax(1, (double)counters.shadow_rays / n) : how->n,
        .is_guess = how->is_guess,
        .deviation = is_exact ? bis_truth_deviation(&one_ray, chance) : (double)NAN,
        .accepted = counters.accepted,
        .draws_independent = !bis_sampler_is_low_discrepancy(at->kind),
    };
    judge(v, &c);
    return BIS_OK;
}

bis_status bis_verify_point(bis_verify *v, const bis_verify_place *at, const bis_settings *settings, size_t n,
                            bool *tested, bis_diag *diag)
{
    bis_truth_density q[BIS_TRUTH_MAX_DENSITIES];
    sampling how[BIS_TRUTH_MAX_DENSITIES];
    bis_truth_question asked = {at->pt, {4, 2, 1}, CELLS >> v->halvings / 2, /* the weights of bis_verify_measure */
                                bis_verify_seed(v, "%s: reference", at->name), q, 0};
    bis_truth truth;

    *tested = false;
    for (size_t i = 0; i < n; i++) {
        how[i] = sampling_of(&settings[i], bis_light_is_constant(at->pt->light));
        if (how[i].n <= 0) continue;
        assert(asked.n < BIS_TRUTH_MAX_DENSITIES);
        how[i].sample = &truth.sample[asked.n];
        q[asked.n++] = how[i].q;
    }
    bis_status status = bis_truth_of(&truth, &asked, diag);
    if (status || !(truth.lit.mean[3] > least_seen * truth.open.mean[3])) return status;
    *tested = true;
    const double unknown = bis_truth_bound(&truth.lit, chance) / truth.lit.mean[3];
    if (!(unknown <= most_unknown)) {
        bis_verify_skip(bis_verify_new(v, "view", "%s: all integrators", at->name),
                        "the sum over patches is known too badly: the lobe is too narrow");
        return BIS_OK;
    }
    for (size_t i = 0; i < n && !status; i++) status = compare(v, at, &truth, &settings[i], &how[i], diag);
    return status;
}
