/* SPDX-License-Identifier: BSD-2-Clause */
/* Estimators against their exact laws, enumerated on a map of 8 pixels (tests/support/tiny.h): where SIR's rays go at M
 * = 1, 2, 3 and how that approaches p; the mean of every estimator, unbiased or not; its variance (docs/errata.md E31).
 * Family-wise significance 1e-3. */
#include "thesis/candidates.h"
#include "claim.h"
#include "lit.h"
#include "tiny.h"

#include <math.h>
#include <stdio.h>
#include <sys/stat.h>

#define SEED 71u

/* 24 + 11 laws; 4 moments of 18 + 27 + 9 settings; 9 + 6 variances; 4 moments of 68 settings. */
static double alpha(void) { return stat_level(1e-3, 24 + 11 + 4 * 54 + 15 + 4 * 68); }

static bis_settings settings_of(const bis_integrator *integrator, bis_proposal proposal, uint32_t M, uint32_t N)
{
    bis_settings s = lit_settings(integrator, proposal, M, N);
    s.stratify = false;
    s.resampling = BIS_RESAMPLING_MULTINOMIAL;
    return s;
}

/* ---- the law of a resampled direction ---- */

typedef struct law_sum {
    const tiny_candidates *c;
    double law[TINY_STATES];
} law_sum;

/* The candidates of one tuple are resampled with probabilities w/W; without a positive weight nothing is traced. */
static void add_to_law(const int state[TINY_MAX_M], double probability, void *data)
{
    law_sum *sum = data;
    double W = 0;

    for (uint32_t i = 0; i < sum->c->M; i++) W += rgbd_sum(sum->c->C[state[i]]);
    if (W == 0) {
        sum->law[TINY_NOTHING] += probability;
        return;
    }
    for (uint32_t i = 0; i < sum->c->M; i++) sum->law[state[i]] += probability * rgbd_sum(sum->c->C[state[i]]) / W;
}

/* p of eq. 4.4, the law for M -> infinity. */
static void product_law(double p[TINY_STATES], const tiny_candidates *c)
{
    double total = 0;

    for (int k = 0; k < TINY_STATES; k++) total += p[k] = c->P[0][k] * rgbd_sum(c->C[k]);
    for (int k = 0; k < TINY_STATES; k++) p[k] /= total;
}

/* Where the rays of `runs` estimates with N = 1 went; in the last cell those that cast none. */
static void observe(double observed[TINY_STATES], tiny *t, const bis_settings *s, uint32_t runs)
{
    bis_scratch scratch;

    assert_int_equal(bis_scratch_init(&scratch, s, NULL), BIS_OK);
    for (int k = 0; k < TINY_PIXELS; k++) t->rays[k] = 0;
    for (uint32_t run = 0; run < runs; run++) tiny_once(t, s, &scratch, SEED, run);
    observed[TINY_NOTHING] = runs;
    for (int k = 0; k < TINY_PIXELS; k++) observed[TINY_NOTHING] -= observed[k] = t->rays[k];
    bis_scratch_clear(&scratch);
}

static void scaled(double expected[TINY_STATES], const double law[TINY_STATES], double count)
{
    for (int k = 0; k < TINY_STATES; k++) expected[k] = count * law[k];
}

static const struct {
    bis_proposal proposal;
    bool stratify;
} ways[] = {{BIS_PROPOSAL_EM, false}, {BIS_PROPOSAL_EM, true}, {BIS_PROPOSAL_BRDF, false}, {BIS_PROPOSAL_MIX, false}};

/* Twin: p itself. At these M it is not the law of what is traced, and the same test sees it. */
static void resampled_directions_have_the_law_of_finite_M_and_not_p(void **state)
{
    enum { RUNS = 50000 };
    tiny t;

    tiny_init(&t);
    for (int i = 0; i < 4 * 3 * 2; i++) {
        const uint32_t M = (uint32_t)(i / 4 % 3 + 1);
        bis_settings s = settings_of(&bis_sir, ways[i % 4].proposal, M, 1);
        double observed[TINY_STATES], expected[TINY_STATES], p[TINY_STATES];
        s.stratify = ways[i % 4].stratify;
        s.resampling = i / 12 ? BIS_RESAMPLING_MULTINOMIAL : BIS_RESAMPLING_SYSTEMATIC;
        tiny_candidates c = tiny_enumerate(&t, s.proposal, s.stratify, M),
                        one = tiny_enumerate(&t, s.proposal, false, 1);
        law_sum sum = {.c = &c};
        tiny_for_all(&c, add_to_law, &sum);
        observe(observed, &t, &s, RUNS);
        scaled(expected, sum.law, RUNS);
        stat_assert_fit("sir_law", SEED, observed, expected, TINY_STATES, alpha());

        product_law(p, &one);
        scaled(expected, p, RUNS - observed[TINY_NOTHING]);
        observed[TINY_NOTHING] = 0;
        stat_assert_no_fit("sir_law_is_not_p", SEED, observed, expected, TINY_STATES, alpha());
    }
    tiny_clear(&t);
}

/* The law for any M of independent candidates, by w/W = integral of w exp(-t W) dt: with phi(t) = E[exp(-t w)] of one
 * candidate,
 *     law[k] = M P[k] w[k] integral of exp(-t w[k]) phi(t)^(M-1) dt,     trapezoids in log t. */
static void law_of_M(double law[TINY_STATES], const tiny_candidates *c, double M)
{
    const double *P = c->P[0], step = 0.01;

    law[TINY_NOTHING] = pow(P[TINY_NOTHING], M);
    for (int k = 0; k < TINY_PIXELS; k++) {
        double w = rgbd_sum(c->C[k]), sum = 0;
        for (double x = -30; x < 10 && w > 0; x += step) {
            double t = exp(x), phi = P[TINY_NOTHING];
            for (int j = 0; j < TINY_PIXELS; j++) phi += P[j] * exp(-t * rgbd_sum(c->C[j]));
            sum += t * step * exp(-t * w) * pow(phi, M - 1);
        }
        law[k] = M * P[k] * w * sum;
    }
}

/* Of the directions that are traced, to p. */
static double distance(const double law[TINY_STATES], const double p[TINY_STATES])
{
    double total = 0, sum = 0;

    for (int k = 0; k < TINY_PIXELS; k++) total += law[k];
    for (int k = 0; k < TINY_PIXELS; k++) sum += fabs(law[k] / total - p[k]) / 2;
    return sum;
}

/* The bias of a ratio: total variation falls as 1/M. The table of law and measurement is
 * build/sir_total_variation.txt. */
static void total_variation_to_p_falls_as_1_over_M(void **state)
{
    static const uint32_t Ms[] = {1, 2, 3, 4, 8, 16, 32, 64, 128, 256, 512};
    double previous = 1;
    tiny t;

    mkdir("build", 0777);
    FILE *f = fopen("build/sir_total_variation.txt", "w");
    assert_non_null(f);
    fprintf(f, "# total variation between SIR's resampled directions and p (eq. 4.4): candidates from the map, N = 1\n"
               "#   M  exact law   measured\n");
    tiny_init(&t);
    tiny_candidates one = tiny_enumerate(&t, BIS_PROPOSAL_EM, false, 1);
    double p[TINY_STATES];
    product_law(p, &one);
    for (int i = 0; i < 11; i++) {
        const bis_settings s = settings_of(&bis_sir, BIS_PROPOSAL_EM, Ms[i], 1);
        const uint32_t runs = Ms[i] <= 32 ? 100000 : 3200000 / Ms[i];
        double law[TINY_STATES], observed[TINY_STATES], expected[TINY_STATES];
        law_of_M(law, &one, Ms[i]);
        if (Ms[i] <= 3) {
            tiny_candidates c = tiny_enumerate(&t, BIS_PROPOSAL_EM, false, Ms[i]);
            law_sum sum = {.c = &c};
            tiny_for_all(&c, add_to_law, &sum);
            for (int k = 0; k < TINY_STATES; k++) assert_true(fabs(law[k] - sum.law[k]) < 1e-9);
        }
        observe(observed, &t, &s, runs);
        scaled(expected, law, runs);
        stat_assert_fit("sir_law_of_M", SEED, observed, expected, TINY_STATES, alpha());

        double exact = distance(law, p), measured = distance(observed, p);
        fprintf(f, "%5u  %9.5f  %9.5f\n", (unsigned)Ms[i], exact, measured);
        assert_true(exact < previous);
        if (Ms[i] >= 128) assert_true(fabs(exact / previous - 0.5) < 0.05);
        /* what noise adds: at most E|deviation|/2 in each cell, 3 times */
        assert_true(fabs(measured - exact) < 3 * TINY_PIXELS * 0.2 / sqrt(runs));
        previous = exact;
    }
    fclose(f);
    tiny_clear(&t);
}

/* ---- means and second moments ---- */

/* What an estimator makes of one set of candidates: the mean of L in RGB, and the mean of the square of its sum. */
typedef struct outcome {
    rgbd L;
    double square;
} outcome;

typedef struct expectation {
    const tiny *t;
    const bis_settings *s;
    const tiny_candidates *c;
    double B;
    outcome sum;
} expectation;

static bool is_seen(const expectation *e, int k) { return k != TINY_NOTHING && !e->t->accel.hidden[k]; }

/* Z/n times the sum of F/phat V over n of the A candidates of a set, drawn without replacement: the number of those
 * seen is hypergeometric. Z is the scale when n = A = all are seen, and the sum over RGB of F/phat is 1. */
static outcome without_replacement(const expectation *e, const int state[TINY_MAX_M], unsigned set, double Z)
{
    double A = 0, K = 0;
    outcome o = {.square = 0};

    for (uint32_t i = 0; i < e->c->M; i++) {
        if (!(set >> i & 1)) continue;
        A++;
        if (!is_seen(e, state[i])) continue;
        K++;
        o.L = rgbd_add(o.L, rgbd_scale(e->c->C[state[i]], 1 / rgbd_sum(e->c->C[state[i]])));
    }
    double n = fmin(A, e->s->shadowrays), mean = K / A,
           variance = A > 1 ? mean * (1 - mean) / n * (A - n) / (A - 1) : 0;
    o.L = rgbd_scale(o.L, Z / A);
    o.square = Z * Z * (mean * mean + variance);
    return o;
}

/* SIR: the mean of C V; multinomial marks see each candidate with w/W, independently. */
static outcome resampled(const expectation *e, const int state[TINY_MAX_M])
{
    const double M = e->c->M;
    double W = 0, seen = 0;
    outcome o = {.square = 0};

    for (uint32_t i = 0; i < e->c->M; i++) {
        double w = rgbd_sum(e->c->C[state[i]]);
        W += w;
        if (!is_seen(e, state[i])) continue;
        seen += w;
        o.L = rgbd_add(o.L, rgbd_scale(e->c->C[state[i]], 1 / M));
    }
    if (W > 0) o.square = (seen * seen + seen * (W - seen) / e->s->shadowrays) / (M * M);
    return o;
}

static outcome unoccluded(const expectation *e, const int state[TINY_MAX_M])
{
    outcome o = {.square = 0};

    for (uint32_t i = 0; i < e->c->M; i++) o.L = rgbd_add(o.L, rgbd_scale(e->c->C[state[i]], 1 / (double)e->c->M));
    o.square = rgbd_sum(o.L) * rgbd_sum(o.L);
    return o;
}

static outcome fallen_back(const expectation *e, const int state[TINY_MAX_M], double W)
{
    unsigned positive = 0;

    if (e->s->fallback == BIS_FALLBACK_UNOCCLUDED) return unoccluded(e, state);
    if (e->s->fallback == BIS_FALLBACK_RESAMPLE) return resampled(e, state);
    for (uint32_t i = 0; i < e->c->M; i++) positive |= (unsigned)(state[i] != TINY_NOTHING) << i;
    return without_replacement(e, state, positive, W / e->c->M);
}

/* Sum over all sets of accepted candidates, each in with probability w/B. */
static outcome rejected(const expectation *e, const int state[TINY_MAX_M])
{
    const uint32_t M = e->c->M;
    double W = 0;
    outcome sum = {.square = 0};

    for (uint32_t i = 0; i < M; i++) W += rgbd_sum(e->c->C[state[i]]);
    for (unsigned set = 0; set < 1u << M; set++) {
        double probability = 1, A = 0;
        for (uint32_t i = 0; i < M; i++) {
            double a = rgbd_sum(e->c->C[state[i]]) / e->B;
            probability *= set >> i & 1 ? a : 1 - a;
            A += set >> i & 1;
        }
        outcome o = {.square = 0};
        if (probability == 0) continue;
        if (e->s->estimator == BIS_ESTIMATOR_PLAIN) {
            if (A > 0) o = without_replacement(e, state, set, e->B / M * A);
        } else if (W > 0) {
            o = A > 0 ? without_replacement(e, state, set, W / M) : fallen_back(e, state, W);
        }
        sum.L = rgbd_add(sum.L, rgbd_scale(o.L, probability));
        sum.square += probability * o.square;
    }
    return sum;
}

static void add_expectation(const int state[TINY_MAX_M], double probability, void *data)
{
    expectation *e = data;
    const bis_integrator *by = e->s->integrator;
    outcome o = by == &bis_rejection    ? rejected(e, state)
                : by == &bis_unoccluded ? unoccluded(e, state)
                                        : resampled(e, state);

    e->sum.L = rgbd_add(e->sum.L, rgbd_scale(o.L, probability));
    e->sum.square += probability * o.square;
}

static outcome expect_from(tiny *t, const bis_settings *s, bis_proposal proposal)
{
    const tiny_candidates c = tiny_enumerate(t, proposal, s->stratify, s->candidates);
    expectation e = {
        .t = t, .s = s, .c = &c, .B = s->integrator == &bis_rejection ? bis_candidates_bound(&t->pt, proposal) : 1};

    tiny_for_all(&c, add_expectation, &e);
    return e.sum;
}

/* "choose": one of the two proposals, the smaller bound more often. */
static outcome expect(tiny *t, const bis_settings *s)
{
    if (s->proposal != BIS_PROPOSAL_CHOOSE) return expect_from(t, s, s->proposal);

    double em = bis_candidates_bound(&t->pt, BIS_PROPOSAL_EM), brdf = bis_candidates_bound(&t->pt, BIS_PROPOSAL_BRDF);
    double share = brdf / (em + brdf);
    outcome a = expect_from(t, s, BIS_PROPOSAL_EM), b = expect_from(t, s, BIS_PROPOSAL_BRDF);
    return (outcome){
        rgbd_add(rgbd_scale(a.L, share), rgbd_scale(b.L, 1 - share)), share * a.square + (1 - share) * b.square};
}

/* Measured: the three means, and the square of the sum. */
static void measure(stat_moments m[4], tiny *t, const bis_settings *s, uint32_t runs)
{
    bis_scratch scratch;

    assert_int_equal(bis_settings_check(s, (bis_loc){NULL, 0, 0}, NULL), BIS_OK);
    assert_int_equal(bis_scratch_init(&scratch, s, NULL), BIS_OK);
    for (int i = 0; i < 4; i++) m[i] = (stat_moments){0};
    for (uint32_t run = 0; run < runs; run++) {
        rgb L = tiny_once(t, s, &scratch, SEED, run);
        stat_add(&m[0], (double)L.r);
        stat_add(&m[1], (double)L.g);
        stat_add(&m[2], (double)L.b);
        stat_add(&m[3], rgb_sum(L) * rgb_sum(L));
    }
    bis_scratch_clear(&scratch);
}

static void check(const char *name, const stat_moments m[4], outcome expected)
{
    const double mean[3] = {expected.L.r, expected.L.g, expected.L.b};

    for (int i = 0; i < 3; i++) stat_assert_mean(name, SEED, &m[i], mean[i], alpha());
    stat_assert_mean(name, SEED, &m[3], expected.square, alpha());
}

static bool near(rgbd a, rgbd b) { return fabs(a.r - b.r) + fabs(a.g - b.g) + fabs(a.b - b.b) < 1e-5 * rgbd_sum(b); }

/* The enumeration itself says: no bias, at any M and N; and the integrator has the enumerated mean and second
 * moment. */
static void sir_and_plain_rejection_have_the_enumerated_mean_which_is_the_truth_and_variance_E31(void **state)
{
    static const bis_proposal proposals[2][3] = {{BIS_PROPOSAL_EM, BIS_PROPOSAL_BRDF, BIS_PROPOSAL_MIX},
                                                 {BIS_PROPOSAL_EM, BIS_PROPOSAL_BRDF, BIS_PROPOSAL_CHOOSE}};
    tiny t;

    tiny_init(&t);
    for (int i = 0; i < 2 * 3 * 3; i++) {
        const uint32_t M = (uint32_t)(i / 6 + 1), N = (uint32_t)(i % 5 / 2 + 1);
        bis_settings s = settings_of(i % 2 ? &bis_rejection : &bis_sir, proposals[i % 2][i / 2 % 3], M, N);
        stat_moments m[4];
        s.estimator = BIS_ESTIMATOR_PLAIN;
        outcome expected = expect(&t, &s);
        assert_true(near(expected.L, tiny_truth(&t, true)));
        measure(m, &t, &s, i % 2 ? 240000 : 60000);
        check(i % 2 ? "plain_enumerated" : "sir_enumerated", m, expected);
        /* twin: the variance as printed, that of N samples of V alone */
        double L = rgbd_sum(tiny_truth(&t, true)), Lns = rgbd_sum(tiny_truth(&t, false));
        stat_assert_not_mean("E31_printed", SEED, &m[3], L * L + L * (Lns - L) / s.shadowrays, alpha());
    }
    tiny_clear(&t);
}

/* SIR's two moments for any M in closed form. The square of one set is (S^2 + S (W - S)/N)/M^2, S the sum of w V, W
 * that of w (`resampled`). The candidates are independent, so E[S^2] and E[S W] are made of sums over single ones. */
static outcome closed_form(const tiny *t, const tiny_candidates *c, double N)
{
    double S = 0, W = 0, SS = 0, SW = 0;
    const double M = c->M;
    outcome o = {.square = 0};

    for (uint32_t i = 0; i < c->M; i++) {
        double s = 0, w = 0, both = 0;
        for (int k = 0; k < TINY_STATES; k++) {
            const double w_k = rgbd_sum(c->C[k]), V = k != TINY_NOTHING && !t->accel.hidden[k];
            w += c->P[i][k] * w_k;
            s += c->P[i][k] * w_k * V;
            both += c->P[i][k] * w_k * w_k * V;
            o.L = rgbd_add(o.L, rgbd_scale(c->C[k], c->P[i][k] * V / M));
        }
        S += s;
        W += w;
        SS += both - s * s;
        SW += both - s * w;
    }
    o.square = ((SS + S * S) * (1 - 1 / N) + (SW + S * W) / N) / (M * M);
    return o;
}

/* There is no least M: one candidate, a block of lanes less one, a block, a block and one. */
static void sir_has_the_mean_and_variance_of_the_closed_form_for_every_M_from_1_to_17_E21(void **state)
{
    tiny t;

    tiny_init(&t);
    for (uint32_t i = 0; i < 17 * 4; i++) {
        bis_settings s = settings_of(&bis_sir, ways[i % 4].proposal, i / 4 + 1, i % 3 + 1);
        stat_moments m[4];
        s.stratify = ways[i % 4].stratify;
        const tiny_candidates c = tiny_enumerate(&t, s.proposal, s.stratify, s.candidates);
        const outcome expected = closed_form(&t, &c, s.shadowrays);
        assert_true(near(expected.L, tiny_truth(&t, true)));
        if (s.candidates <= 3) {
            const outcome enumerated = expect(&t, &s);
            assert_true(near(expected.L, enumerated.L) && fabs(expected.square / enumerated.square - 1) < 1e-9);
        }
        measure(m, &t, &s, 20000);
        check("sir_closed_form", m, expected);
        stat_assert_not_mean("sir_closed_form_variance_halved", SEED, &m[3],
            (expected.square + pow(rgbd_sum(expected.L), 2)) / 2, alpha());
    }
    tiny_clear(&t);
}

/* The ratio estimator and each fallback: their bias is there, and it is the one that enumeration predicts. */
static void biased_estimators_have_the_bias_that_enumeration_predicts_E29(void **state)
{
    static const bis_proposal proposals[] = {BIS_PROPOSAL_EM, BIS_PROPOSAL_BRDF, BIS_PROPOSAL_CHOOSE};
    static const char *const names[] = {"ratio_resample", "ratio_subset", "ratio_unoccluded"};
    double largest[3] = {0};
    tiny t;

    tiny_init(&t);
    const double truth = rgbd_sum(tiny_truth(&t, true));
    for (int i = 0; i < 3 * 3 * 3; i++) {
        bis_settings s = settings_of(&bis_rejection, proposals[i % 3], (uint32_t)(i / 9 + 1), (uint32_t)(i % 2 + 1));
        stat_moments m[4], sum = {0};
        s.fallback = (bis_fallback[]){BIS_FALLBACK_RESAMPLE, BIS_FALLBACK_SUBSET, BIS_FALLBACK_UNOCCLUDED}[i / 3 % 3];
        outcome expected = expect(&t, &s);
        double bias = rgbd_sum(expected.L) / truth - 1;
        measure(m, &t, &s, 60000);
        check(names[i / 3 % 3], m, expected);
        largest[i / 3 % 3] = fmax(largest[i / 3 % 3], fabs(bias));
        sum = (stat_moments){m[0].n, m[0].mean + m[1].mean + m[2].mean, 0};
        sum.m2 = (m[3].mean - sum.mean * sum.mean) * (sum.n - 1);
        if (fabs(bias) > 0.07) stat_assert_not_mean("ratio_as_if_unbiased", SEED, &sum, truth, alpha());
        print_message("%s, proposal %s, M = %u, N = %u: bias %+.1f %%\n", names[i / 3 % 3],
            bis_proposal_name(s.proposal), (unsigned)s.candidates, (unsigned)s.shadowrays, 100 * bias);
    }
    assert_true(largest[0] > 0.03 && largest[1] > 0.08 && largest[2] > 1);
    tiny_clear(&t);
}

/* Unoccluded has the mean of L_ns: seen as an estimate of the picture, its bias is what visibility takes away. */
static void unoccluded_has_the_mean_L_ns_and_its_variance_over_M(void **state)
{
    tiny t;

    tiny_init(&t);
    for (int i = 0; i < 3 * 3; i++) {
        bis_settings s = settings_of(&bis_unoccluded, (bis_proposal)(i % 3), (uint32_t)(i / 3 + 1), 1);
        stat_moments m[4];
        outcome expected = expect(&t, &s);
        assert_true(near(expected.L, tiny_truth(&t, false)));
        measure(m, &t, &s, 60000);
        check("unoccluded_enumerated", m, expected);
        stat_assert_not_mean("unoccluded_as_the_picture", SEED, &m[1], tiny_truth(&t, true).g, alpha());
    }
    tiny_clear(&t);
}

/* ---- variances in closed form ---- */

/* Mean and second moment of h(k) over the states of one candidate, h = sum of C if seen. */
static void moments_of_one(double *mean, double *square, const tiny *t, const tiny_candidates *c)
{
    *mean = *square = 0;
    for (int k = 0; k < TINY_PIXELS; k++) {
        double w = t->accel.hidden[k] ? 0 : rgbd_sum(c->C[k]);
        *mean += c->P[0][k] * w;
        *square += c->P[0][k] * w * w;
    }
}

/* Independent candidates, multinomial resampling, any M and N: by the law of total variance, with
 *     E[sum w V sum w (1-V)] = M (M-1) E[wV] E[w(1-V)],
 *     Var L = Var(w V)/M + (1 - 1/M) L (L_ns - L)/N:
 * the first term is the candidates', the second the rays'. Open: the first alone. The printed variance has only the
 * second. */
static void sir_has_the_variance_of_candidates_over_M_plus_that_of_rays_over_N_E31(void **state)
{
    static const uint32_t Ms[] = {1, 8, 64}, Ns[] = {1, 4, 15};
    tiny t;

    tiny_init(&t);
    const double L = rgbd_sum(tiny_truth(&t, true)), Lns = rgbd_sum(tiny_truth(&t, false));
    for (int i = 0; i < 9; i++) {
        const uint32_t M = Ms[i % 3], N = Ns[i / 3];
        const bis_settings s = settings_of(&bis_sir, BIS_PROPOSAL_EM, M, N);
        tiny_candidates one = tiny_enumerate(&t, BIS_PROPOSAL_EM, false, 1);
        double mean, square;
        stat_moments m[4];
        moments_of_one(&mean, &square, &t, &one);
        assert_true(fabs(mean / L - 1) < 1e-5);
        measure(m, &t, &s, 40000);
        double candidates = (square - L * L) / M, rays = (1 - 1.0 / M) * L * (Lns - L) / N;
        stat_assert_mean("E31_sir", SEED, &m[3], L * L + candidates + rays, alpha());
        if (M > 1 && N == 1) stat_assert_not_mean("E31_candidates_alone", SEED, &m[3], L * L + candidates, alpha());
        if (M < 64) stat_assert_not_mean("E31_rays_alone", SEED, &m[3], L * L + L * (Lns - L) / N, alpha());
    }
    tiny_clear(&t);
}

/* em and brdf: variance of one sample over N. mis, balance: that of each technique's share, added. */
static void em_brdf_and_mis_have_the_variance_of_their_samples_E31(void **state)
{
    tiny t;

    tiny_init(&t);
    const double L = rgbd_sum(tiny_truth(&t, true));
    tiny_candidates em = tiny_enumerate(&t, BIS_PROPOSAL_EM, false, 1),
                    brdf = tiny_enumerate(&t, BIS_PROPOSAL_BRDF, false, 1);
    for (int i = 0; i < 6; i++) {
        const bis_integrator *integrators[] = {&bis_em, &bis_brdf, &bis_mis};
        bis_settings s = bis_settings_default(integrators[i % 3]);
        const double N = s.samples = i / 3 ? 15 : 2;
        double mean, square, variance = 0;
        stat_moments m[4];
        if (i % 3 < 2) {
            moments_of_one(&mean, &square, &t, i % 3 ? &brdf : &em);
            variance = (square - L * L) / N;
        } else {
            const double n_em = round(N / 2), n_brdf = N - n_em;
            tiny_candidates share = {.M = 1};
            for (int k = 0; k < TINY_PIXELS; k++) { /* F/(n_em q_em + n_brdf q_brdf), from either */
                double q = n_em * t.p_em[k] + n_brdf * t.material.pick[k];
                share.C[k] = t.p_em[k] > 0 ? rgbd_scale(em.C[k], t.p_em[k] / q) : (rgbd){0, 0, 0};
            }
            for (int j = 0; j < 2; j++) {
                for (int k = 0; k < TINY_STATES; k++) share.P[0][k] = j ? brdf.P[0][k] : em.P[0][k];
                moments_of_one(&mean, &square, &t, &share);
                variance += (j ? n_brdf : n_em) * (square - mean * mean);
            }
        }
        measure(m, &t, &s, 60000);
        stat_assert_mean("E31_one_sampler", SEED, &m[3], L * L + variance, alpha());
        stat_assert_not_mean("E31_one_sampler_wrong", SEED, &m[3], L * L + 1.25 * variance, alpha());
    }
    tiny_clear(&t);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(resampled_directions_have_the_law_of_finite_M_and_not_p),
        cmocka_unit_test(total_variation_to_p_falls_as_1_over_M),
        cmocka_unit_test(sir_and_plain_rejection_have_the_enumerated_mean_which_is_the_truth_and_variance_E31),
        cmocka_unit_test(sir_has_the_mean_and_variance_of_the_closed_form_for_every_M_from_1_to_17_E21),
        cmocka_unit_test(biased_estimators_have_the_bias_that_enumeration_predicts_E29),
        cmocka_unit_test(unoccluded_has_the_mean_L_ns_and_its_variance_over_M),
        cmocka_unit_test(sir_has_the_variance_of_candidates_over_M_plus_that_of_rays_over_N_E31),
        cmocka_unit_test(em_brdf_and_mis_have_the_variance_of_their_samples_E31),
    };

    return cmocka_run_group_tests_name("enumeration", tests, NULL, NULL);
}
