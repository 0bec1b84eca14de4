/* SPDX-License-Identifier: BSD-2-Clause */
/* Assignment sir: src/thesis/set.c, src/thesis/choose.c and src/thesis/sir.c. Weights by the textbooks' formulas,
 * choices by hand, means against brute force, and rays counted (tests/support/lit.h): not even the right mean counts
 * where more are cast than N. Statistical tests: 24. */
#include "mark.h"

#include "bis/base/mem.h"
#include "thesis/set.h"

static const char *const hint = "L = (Zhat/N) sum of F/phat V over the chosen, Zhat = W/M: the mean weight of these "
    "very candidates.";

static bis_material glossy(void) { return bis_phong((rgb){0.1f, 0.4f, 0.3f}, (rgb){0.5f, 0.3f, 0.1f}, 10); }

static bis_settings sir(bis_proposal proposal, uint32_t M, uint32_t N, bool stratify)
{
    bis_settings s = bis_settings_default(&bis_sir);

    s.proposal = proposal;
    s.candidates = M;
    s.shadowrays = N;
    s.stratify = stratify;
    return s;
}

/* ---- weights ---- */

/* What the student makes of the candidates x, which are ours. */
typedef struct weighed {
    const bis_set *x;
    float *w, *F[3];
    double Zhat;
} weighed;

static double weight_of(const weighed *g, uint32_t number)
{
    return (double)g->w[number] * g->x->unit_of_f * g->x->unit_of_Le;
}

/* Candidate i of a half against F = f Le and w = phat/q, q = beta q_L + (1 - beta) q_f. Le and q_L are those that it
 * was drawn with. */
static bool check_candidate(const lit *l, const weighed *g, const bis_half *half, uint32_t i, double beta,
                            const char *what)
{
    const bis_lanes y = half->x;
    const uint32_t number = half->first + i;
    const double wi[3] = {(double)y.x[i], (double)y.y[i], (double)y.z[i]}, unit_of_Le = g->x->unit_of_Le,
        unit = g->x->unit_of_f * unit_of_Le;
    const double cosine = dot(l->pt.n, (vec3){y.x[i], y.y[i], y.z[i]}), w = weight_of(g, number);
    double q_f;
    const rgbd f = lit_f(l, wi, &q_f);
    const rgbd F = {f.r * (double)y.r[i] * unit_of_Le, f.g * (double)y.g[i] * unit_of_Le,
                    f.b * (double)y.b[i] * unit_of_Le};
    const double q = beta * (double)y.q[i] + (1 - beta) * q_f, degrees = acos(fmin(1, cosine)) * 180 / PI;

    if (cosine <= 0) {
        if (w != 0) mark_wrong("%s: candidate %u lies below the horizon, but has weight %g", what, number, w);
        return false;
    }
    mark_near(w, rgbd_sum(F) * cosine / q, 0, 1e-3, "%s: the weight of candidate %u, %.0f degrees from the normal, "
              "phat/q = (f cos Le summed over RGB)/q,", what,
              number, degrees);
    mark_near((double)g->F[0][number] * unit, F.r, 0, 1e-3, "%s: F_r of candidate %u, f Le without the cosine,", what,
              number);
    mark_near((double)g->F[1][number] * unit, F.g, 0, 1e-3, "%s: F_g of candidate %u, f Le without the cosine,", what,
              number);
    mark_near((double)g->F[2][number] * unit, F.b, 0, 1e-3, "%s: F_b of candidate %u, f Le without the cosine,", what,
              number);
    return w > 0;
}

enum { CANDIDATES = 400 };

/* The candidates of the claims about weights: the same ones here and in the student's process. The unit of f, which
 * weighing stores in a set, is asked of the material. */
static ask_scene drawn(lit *l, bis_scratch *scratch, bis_proposal proposal)
{
    bis_settings s = sir(proposal, CANDIDATES, 1, false);
    ask_scene scene = mark_scene(LIT_SMOOTH, glossy(), LIT_OPEN, ASK_SIR, &s);
    bis_sampler sampler;

    scene.seed = mark_seed(9);
    mark_lit(l, &scene);
    if (bis_scratch_init(scratch, &s, NULL)) mark_wrong("no memory");
    bis_stream stream = answers_stream(scene.seed, 1, &sampler);
    bis_set *x = scratch->set;
    bis_set_draw(x, CANDIDATES, proposal, false, &l->pt, &stream);
    float memory[5][BIS_LANES_BLOCK];
    const bis_reflected f = {memory[0], memory[1], memory[2], memory[3], memory[4]};
    x->unit_of_f = bis_bsdf_f_many(&f, &l->pt.bsdf, x->map.n ? &x->map.x : &x->brdf.x, 1);
    return scene;
}

static void check_weights(bis_proposal proposal, double beta, const char *what)
{
    bis_scratch scratch;
    uint32_t lit_ones = 0;
    double sum = 0;
    lit l;

    const ask_scene scene = drawn(&l, &scratch, proposal);
    const bis_set *x = scratch.set;
    const bis_half *halves[] = {&x->map, &x->brdf};
    const size_t n = x->brdf.first + bis_lanes_round_up(x->brdf.n);
    weighed g = {.x = x, .w = mark_alloc(n, sizeof *g.w)};
    for (int c = 0; c < 3; c++) g.F[c] = mark_alloc(n, sizeof *g.F[c]);
    ASK(ASK_WEIGHTS, GIVE(&scene, 1), TAKE(&g.Zhat, 1), TAKE(g.w, n), TAKE(g.F[0], n), TAKE(g.F[1], n),
        TAKE(g.F[2], n));
    for (int k = 0; k < 2; k++) {
        for (uint32_t i = 0; i < halves[k]->n; i++) {
            lit_ones += check_candidate(&l, &g, halves[k], i, beta, what);
            sum += weight_of(&g, halves[k]->first + i);
        }
    }
    if (lit_ones < CANDIDATES / 8) {
        mark_wrong("%s: only %u of %d candidates have a weight; light comes from all sides here", what, lit_ones,
                   CANDIDATES);
    }
    mark_near(g.Zhat, sum / CANDIDATES, 0, 1e-5, "%s: the mean of the weights (have you written beyond the n "
              "candidates?)", what);
    bis_free(g.w);
    for (int c = 0; c < 3; c++) bis_free(g.F[c]);
    bis_scratch_clear(&scratch);
    bis_light_free(l.light);
}

static void weights_from_the_map_are_phat_over_q(void) { check_weights(BIS_PROPOSAL_EM, 1, "candidates from the map"); }
static void weights_from_the_brdf_are_phat_over_q(void)
{
    check_weights(BIS_PROPOSAL_BRDF, 0, "candidates from the BRDF");
}

static void weights_of_a_mixture_have_the_mixed_density(void)
{
    bis_scratch scratch;
    lit l;

    drawn(&l, &scratch, BIS_PROPOSAL_MIX);
    const double beta = scratch.set->beta;
    bis_scratch_clear(&scratch);
    bis_light_free(l.light);
    check_weights(BIS_PROPOSAL_MIX, beta, "candidates of a mixture");
}

/* ---- choices ---- */

/* Four blocks of 16. One has no weight at all, and the last weight of the third is far from its end. */
static const double weights[] = {[1] = 1, [3] = 3, [4] = 0.5, [6] = 2.5, [7] = 1, [31] = 0.25, [48] = 1.5, [50] = 4,
                                 [52] = 0.75, [63] = 0};
enum { ITEMS = sizeof weights / sizeof *weights };

/* What a student chose in many runs: item[run][ITEMS + 1] and times[run][ITEMS + 1], of which n[run] count. */
enum { ROOM = ITEMS + 1 };
typedef struct chosen {
    uint32_t *n, *item, *times;
} chosen;

static double sum_of_weights(void)
{
    double W = 0;

    for (int i = 0; i < ITEMS; i++) W += weights[i];
    return W;
}

static chosen choose(uint32_t N, double W, bis_resampling kind, size_t runs)
{
    const ask_marks m = {.N = N, .W = W, .kind = kind, .seed = mark_seed(9)};
    chosen c = {mark_alloc(runs, sizeof *c.n), mark_alloc(runs * ROOM, sizeof *c.item),
                mark_alloc(runs * ROOM, sizeof *c.times)};
    float w[ITEMS];

    for (int i = 0; i < ITEMS; i++) w[i] = (float)weights[i];
    ASK(ASK_CHOICES, GIVE(&m, 1), GIVE(w, ITEMS), TAKE(c.n, runs), TAKE(c.item, runs * ROOM),
        TAKE(c.times, runs * ROOM));
    return c;
}

static void chosen_clear(chosen *c)
{
    bis_free(c->n);
    bis_free(c->item);
    bis_free(c->times);
}

/* What must hold whenever N marks are given. */
static void check_marks(uint32_t n, const uint32_t *item, const uint32_t *all_times, uint32_t N, double W,
                        bis_resampling kind)
{
    uint64_t marks = 0;

    if (n > ITEMS) mark_wrong("%u items are said to be chosen, of %d", n, ITEMS);
    for (uint32_t k = 0; k < n; k++) {
        const uint32_t i = item[k], times = all_times[k];
        if (i >= ITEMS) mark_wrong("item[%u] is %u, of %d candidates", k, i, ITEMS);
        if (weights[i] == 0) mark_wrong("candidate %u is chosen, its weight is 0", i);
        if (k > 0 && i <= item[k - 1]) {
            mark_wrong("items must ascend, each once: %u follows %u (who has several marks is traced by one ray)", i,
                       item[k - 1]);
        }
        if (times == 0 || times > N) mark_wrong("candidate %u is chosen %u times, with %u marks", i, times, N);
        const double share = N * weights[i] / W;
        if (kind == BIS_RESAMPLING_SYSTEMATIC && fabs(times - share) >= 1) {
            mark_wrong("systematic: candidate %u has weight %g of %g and is chosen %u times of %u; one of the two "
                       "whole numbers next to %.3g would be right", i,
                       weights[i], W, times, N, share);
        }
        marks += times;
    }
    if (marks != N) mark_wrong("%u marks of %u are given to candidates", (unsigned)marks, N);
}

/* A W that is too large, as rounding can make it by an ulp: what marks lie beyond the sum belong to the last one
 * with a weight. */
static void check_last_marks(bis_resampling kind)
{
    enum { N = 8, LAST = 52, RUNS = 100 };
    chosen c = choose(N, 2 * sum_of_weights(), kind, RUNS);

    for (uint32_t run = 0; run < RUNS; run++) {
        uint64_t marks = 0;
        for (uint32_t k = 0; k < c.n[run] && k < ITEMS; k++) {
            const uint32_t i = c.item[run * ROOM + k];
            marks += c.times[run * ROOM + k];
            if (i >= ITEMS || weights[i] == 0) {
                mark_wrong("a mark lies beyond all weights, as rounding may put it, and chooses %u, which has no "
                           "weight: it must be the last one that has one, %d",
                           i, LAST);
            }
        }
        if (marks != N) {
            mark_wrong("%u marks of %d are given where some lie beyond all weights, as rounding may put them: they "
                       "belong to the last candidate that has a weight, %d",
                       (unsigned)marks, N, LAST);
        }
    }
    chosen_clear(&c);
}

static void check_choice(bis_resampling kind, const char *what)
{
    enum { RUNS = 20000, N = 5 };
    const double W = sum_of_weights();
    double count[ITEMS] = {0}, expected[ITEMS];
    stat_moments square = {0};

    check_last_marks(kind);
    chosen c = choose(N, W, kind, RUNS);
    for (uint32_t run = 0; run < RUNS; run++) {
        const uint32_t *item = c.item + run * ROOM, *times = c.times + run * ROOM;
        double of_3 = 0;
        check_marks(c.n[run], item, times, N, W, kind);
        for (uint32_t k = 0; k < c.n[run]; k++) {
            count[item[k]] += times[k];
            if (item[k] == 3) of_3 = times[k];
        }
        stat_add(&square, (of_3 - N * 3 / W) * (of_3 - N * 3 / W));
    }
    for (int i = 0; i < ITEMS; i++) expected[i] = weights[i] / W * RUNS * N;
    /* systematic choices vary less than independent ones, which a chi-square test takes for granted: it errs on the
     * safe side */
    mark_fit(count, expected, ITEMS, MARK_ALPHA, what, "Candidate i owns the marks between the running sums before and "
             "after w_i.");
    if (kind == BIS_RESAMPLING_MULTINOMIAL) {
        mark_mean(&square, N * (3 / W) * (1 - 3 / W), MARK_ALPHA, "multinomial: the square of how far the count of "
                  "candidate 3 is from its mean", "N independent marks: next_mark gives them in order.");
    }
    chosen_clear(&c);
}

static void candidates_are_chosen_in_proportion_to_their_weights(void)
{
    check_choice(BIS_RESAMPLING_SYSTEMATIC, "systematic");
}
static void multinomial_choices_are_independent(void) { check_choice(BIS_RESAMPLING_MULTINOMIAL, "multinomial"); }

/* ---- the estimate ---- */

/* N rays at most, whatever M: they are what is dear. */
static void check_rays(const ask_estimate *e, const bis_settings *s, uint32_t runs, const char *what)
{
    const uint32_t most = s->shadowrays < s->candidates ? s->shadowrays : s->candidates;
    const uint64_t rays = mark_most_rays(e, runs);

    if (rays > most) {
        mark_wrong("%s: an estimate casts %u shadow rays, must be %u at most: N of the candidates are chosen, and "
                   "only they are traced", what,
                   (unsigned)rays, most);
    }
}

static void check(bis_settings s, lit_hidden hidden, uint32_t runs, const char *what)
{
    const ask_scene scene = mark_scene(LIT_SMOOTH, glossy(), hidden, ASK_SIR, &s);
    ask_estimate *e = mark_run(&scene, runs, mark_seed(2));
    lit l;

    check_rays(e, &s, runs, what);
    mark_lit(&l, &scene);
    mark_estimates(e, &l, runs, MARK_ALPHA, what, hint);
    bis_light_free(l.light);
    bis_free(e);
}

static void unbiased_for_one_candidate_and_one_ray(void)
{
    check(sir(BIS_PROPOSAL_EM, 1, 1, false), LIT_HALF, 40000, "M = 1, N = 1, from the map");
    check(sir(BIS_PROPOSAL_BRDF, 1, 1, false), LIT_HALF, 40000, "M = 1, N = 1, from the BRDF");
}

static void unbiased_for_few_candidates(void)
{
    check(sir(BIS_PROPOSAL_EM, 2, 1, false), LIT_HALF, 30000, "M = 2, N = 1");
    check(sir(BIS_PROPOSAL_MIX, 4, 3, false), LIT_HALF, 20000, "M = 4, N = 3, a mixture");
    check(sir(BIS_PROPOSAL_EM, 3, 7, true), LIT_OPEN, 20000, "M = 3, N = 7: more rays than candidates");
}

/* The squared error of r + g + b must be that of M plain samples of the map. */
static void check_noise(uint32_t M, uint32_t N, double degrees, uint32_t runs, const char *what, const char *why)
{
    const bis_settings s = sir(BIS_PROPOSAL_EM, M, N, false);
    ask_scene scene = mark_scene(LIT_SPOTTY, bis_phong((rgb){0.8f, 0.8f, 0.8f}, (rgb){0, 0, 0}, 1), LIT_OPEN,
                                 ASK_SIR, &s);
    scene.degrees = degrees;
    ask_estimate *e = mark_run(&scene, runs, mark_seed(3));
    stat_moments square = {0};
    lit l;

    check_rays(e, &s, runs, what);
    mark_lit(&l, &scene);
    const double truth = rgbd_sum(lit_truth(&l, false)), variance = lit_variance_em(&l);
    for (uint32_t run = 0; run < runs; run++) {
        const double d = rgb_sum(e[run].L) - truth;
        stat_add(&square, d * d);
    }
    mark_mean(&square, variance / M, MARK_ALPHA, what, why);
    mark_repeats(&scene, e, runs, mark_seed(3));
    bis_light_free(l.light);
    bis_free(e);
}

static void unbiased_for_many_candidates(void)
{
    check(sir(BIS_PROPOSAL_MIX, 64, 4, true), LIT_HALF, 3000, "M = 64, N = 4, stratified");
    check_noise(32, 1, 40, 30000, "M = 32, N = 1, in the open: the squared error",
                "It must be that of 32 samples: all candidates count, in Zhat, and not only the one that is traced.");
}

/* In the open and without colour all F/phat are equal: the noise is that of Zhat alone, however few the rays. */
static void rays_add_no_noise_where_nothing_is_hidden(void)
{
    check_noise(8, 3, 40, 30000, "M = 8, N = 3, in the open: the squared error",
                "It must be that of 8 samples, not of 3: the rays only ask for visibility.");
}

/* The noise of it is looked at, too; from where, nobody knows before. */
static void work(void)
{
    check_noise((uint32_t)mark_size(128), 8, (double)mark_size(40), 5000, "the load that is timed: the squared error",
                "It must be that of its M samples.");
}

int main(int argc, char **argv)
{
    static const mark_claim claims[] = {
        {"weights_from_the_map_are_phat_over_q", 10, weights_from_the_map_are_phat_over_q},
        {"weights_from_the_brdf_are_phat_over_q", 5, weights_from_the_brdf_are_phat_over_q},
        {"weights_of_a_mixture_have_the_mixed_density", 10, weights_of_a_mixture_have_the_mixed_density},
        {"candidates_are_chosen_in_proportion_to_their_weights", 10,
         candidates_are_chosen_in_proportion_to_their_weights},
        {"multinomial_choices_are_independent", 5, multinomial_choices_are_independent},
        {"unbiased_for_one_candidate_and_one_ray", 10, unbiased_for_one_candidate_and_one_ray},
        {"unbiased_for_few_candidates", 10, unbiased_for_few_candidates},
        {"unbiased_for_many_candidates", 10, unbiased_for_many_candidates},
        {"rays_add_no_noise_where_nothing_is_hidden", 10, rays_add_no_noise_where_nothing_is_hidden},
    };

    return mark_main(argc, argv, claims, sizeof claims / sizeof *claims, work, 5.4);
}
