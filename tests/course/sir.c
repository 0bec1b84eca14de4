/* SPDX-License-Identifier: BSD-2-Clause */
/* Assignment sir: src/thesis/set.c, src/thesis/choose.c and src/thesis/sir.c. Weights by the textbooks' formulas,
 * choices by hand, means against brute force, and rays counted (tests/support/lit.h): not even the right mean counts
 * where more are cast than N. Estimates of one candidate are replayed (replay.h). Statistical tests: 18.
 *
 * Each estimate is made from weights, so one slip in `weigh` would fail all claims about estimates. It counts once, in
 * the claims about weights: where these are wrong, an estimate must be what the student's own weights make of it
 * (struct own). */
#include "replay.h"

#include "thesis/set.h"

static const char *const hint = "L = (Zhat/N) sum of F/phat V over the chosen, Zhat = W/M: the mean weight of these "
    "very candidates.";

static bis_material glossy(void) { return bis_phong((rgb){0.1f, 0.4f, 0.3f}, (rgb){0.5f, 0.3f, 0.1f}, 10); }

static bis_settings sir(bis_proposal proposal, uint32_t M, uint32_t N, bool stratify)
{
    bis_settings s = lit_settings(&bis_sir, proposal, M, N);
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

static rgbd F_of(const weighed *g, uint32_t number)
{
    const double unit = g->x->unit_of_f * g->x->unit_of_Le;

    return rgbd_scale((rgbd){(double)g->F[0][number], (double)g->F[1][number], (double)g->F[2][number]}, unit);
}

/* Candidate i of a half: F = f Le and w = phat/q, q = beta q_L + (1 - beta) q_f. Le and q_L are those that it was
 * drawn with. */
typedef struct right_weight {
    double cosine, w;
    rgbd F;
} right_weight;

static right_weight right_weight_of(const lit *l, const bis_set *x, const bis_half *half, uint32_t i, double beta)
{
    const bis_lanes y = half->x;
    const double wi[3] = {(double)y.x[i], (double)y.y[i], (double)y.z[i]};
    const double cosine = dot(l->pt.n, (vec3){y.x[i], y.y[i], y.z[i]});
    double q_f;
    const rgbd f = lit_f(l, wi, &q_f);
    const rgbd F = {f.r * (double)y.r[i] * x->unit_of_Le, f.g * (double)y.g[i] * x->unit_of_Le,
                    f.b * (double)y.b[i] * x->unit_of_Le};
    const double q = beta * (double)y.q[i] + (1 - beta) * q_f;

    return (right_weight){cosine, cosine > 0 ? rgbd_sum(F) * cosine / q : 0, F};
}

static bool check_candidate(const lit *l, const weighed *g, const bis_half *half, uint32_t i, double beta,
                            const char *what)
{
    const uint32_t number = half->first + i;
    const right_weight must = right_weight_of(l, g->x, half, i, beta);
    const double w = weight_of(g, number), degrees = acos(fmin(1, must.cosine)) * 180 / PI;
    const rgbd F = F_of(g, number);

    if (must.cosine <= 0) {
        if (w != 0) mark_wrong("%s: candidate %u lies below the horizon, but has weight %g", what, number, w);
        return false;
    }
    mark_near(w, must.w, 0, 1e-3, "%s: the weight of candidate %u, %.0f degrees from the normal, "
              "phat/q = (f cos Le summed over RGB)/q,", what,
              number, degrees);
    mark_near(F.r, must.F.r, 0, 1e-3, "%s: F_r of candidate %u, f Le without the cosine,", what, number);
    mark_near(F.g, must.F.g, 0, 1e-3, "%s: F_g of candidate %u, f Le without the cosine,", what, number);
    mark_near(F.b, must.F.b, 0, 1e-3, "%s: F_b of candidate %u, f Le without the cosine,", what, number);
    return w > 0;
}

enum { CANDIDATES = 400 };

/* M candidates of a scene: the same ones here and in the student's process. The unit of f, which weighing stores in a
 * set, is asked of the material. */
static ask_scene drawn(lit *l, bis_scratch *scratch, const ask_scene *of, uint32_t M, uint64_t seed)
{
    ask_scene scene = *of;
    bis_settings *s = &scene.settings;
    bis_sampler sampler;

    s->candidates = M;
    s->stratify = false;
    scene.seed = seed;
    mark_lit(l, &scene);
    const bis_settings with = sir(s->proposal, M, 1, false); /* the scene's has no integrator */
    if (bis_scratch_init(scratch, &with, NULL)) mark_wrong("no memory");
    bis_stream stream = answers_stream(seed, 1, &sampler);
    bis_set *x = scratch->set;
    bis_set_draw(x, M, s->proposal, false, &l->pt, &stream);
    float memory[5][BIS_LANES_BLOCK];
    const bis_reflected f = {memory[0], memory[1], memory[2], memory[3], memory[4]};
    x->unit_of_f = bis_bsdf_f_many(&f, &l->pt.bsdf, x->map.n ? &x->map.x : &x->brdf.x, 1);
    return scene;
}

static weighed weigh(const ask_scene *scene, const bis_set *x)
{
    const size_t n = x->brdf.first + bis_lanes_round_up(x->brdf.n);
    weighed g = {.x = x, .w = mark_alloc(n, sizeof *g.w)};

    for (int c = 0; c < 3; c++) g.F[c] = mark_alloc(n, sizeof *g.F[c]);
    ASK(ASK_WEIGHTS, GIVE(scene, 1), TAKE(&g.Zhat, 1), TAKE(g.w, n), TAKE(g.F[0], n), TAKE(g.F[1], n),
        TAKE(g.F[2], n));
    return g;
}

static void check_weights(bis_proposal proposal, const char *what)
{
    const bis_settings s = sir(proposal, CANDIDATES, 1, false);
    const ask_scene of = mark_scene(LIT_SMOOTH, glossy(), LIT_OPEN, ASK_SIR, &s);
    bis_scratch scratch;
    uint32_t lit_ones = 0;
    double sum = 0;
    lit l;

    const ask_scene scene = drawn(&l, &scratch, &of, CANDIDATES, mark_seed(9));
    const bis_set *x = scratch.set;
    const bis_half *halves[] = {&x->map, &x->brdf};
    weighed g = weigh(&scene, x);
    for (int k = 0; k < 2; k++) {
        for (uint32_t i = 0; i < halves[k]->n; i++) {
            lit_ones += check_candidate(&l, &g, halves[k], i, x->beta, what);
            sum += weight_of(&g, halves[k]->first + i);
        }
    }
    if (lit_ones < CANDIDATES / 8) {
        mark_wrong("%s: only %u of %d candidates have a weight; light comes from all sides here", what, lit_ones,
                   CANDIDATES);
    }
    mark_near(g.Zhat, sum / CANDIDATES, 0, 1e-5, "%s: the mean of the weights (have you written beyond the n "
              "candidates?)", what);
}

static void weights_from_the_map_are_phat_over_q(void) { check_weights(BIS_PROPOSAL_EM, "candidates from the map"); }
static void weights_from_the_brdf_are_phat_over_q(void)
{
    check_weights(BIS_PROPOSAL_BRDF, "candidates from the BRDF");
}

static void weights_of_a_mixture_have_the_mixed_density(void)
{
    check_weights(BIS_PROPOSAL_MIX, "candidates of a mixture");
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
}

static void candidates_are_chosen_in_proportion_to_their_weights(void)
{
    check_choice(BIS_RESAMPLING_SYSTEMATIC, "systematic");
}
static void multinomial_choices_are_independent(void) { check_choice(BIS_RESAMPLING_MULTINOMIAL, "multinomial"); }

/* ---- one cause, one claim ---- */

/* What the student's own weights are worth: the value of candidate i is w_i F/phat V, in each channel, and the mean of
 * these values is the mean of a right estimate, whatever w is, for all M and N. value[3]: r + g + b, of each
 * candidate. */
enum { SETS = 10, OWN = 4000 };
typedef struct own {
    bool is_right; /* all weights are phat/q: then brute force judges, and nothing here is needed */
    bool some_below_0;
    stat_moments value[4];
    double *sums;  /* [SETS * OWN] */
} own;

static bool is_near(double value, double expected) { return fabs(value - expected) <= 1e-3 * fabs(expected); }

static void add_half(own *o, uint32_t *lit_ones, const lit *l, const weighed *g, const bis_half *half, double *sums)
{
    for (uint32_t i = 0; i < half->n; i++) {
        const right_weight must = right_weight_of(l, g->x, half, i, g->x->beta);
        const rgbd F = F_of(g, half->first + i);
        const double w = weight_of(g, half->first + i), phat = rgbd_sum(F),
            scale = phat > 0 && !lit_is_hidden(l->accel.hidden, (double)half->x.y[i]) ? w / phat : 0;
        const bool is_grazing = fabs(must.cosine) < 1e-3; /* a cosine of floats is good to 1e-7 */
        if (!is_grazing && !is_near(w, must.w)) o->is_right = false;
        if (!is_grazing && must.w > 0 &&
            !(is_near(F.r, must.F.r) && is_near(F.g, must.F.g) && is_near(F.b, must.F.b))) o->is_right = false;
        o->some_below_0 = o->some_below_0 || w < 0;
        *lit_ones += w > 0 && phat > 0;
        stat_add(&o->value[0], scale * F.r);
        stat_add(&o->value[1], scale * F.g);
        stat_add(&o->value[2], scale * F.b);
        stat_add(&o->value[3], sums[i] = scale * phat);
    }
}

static own own_under(const ask_scene *of, uint32_t *lit_ones)
{
    own o = {.is_right = true, .sums = mark_alloc((size_t)SETS * OWN, sizeof *o.sums)};

    for (uint32_t k = 0; k < SETS; k++) {
        bis_scratch scratch;
        lit l;
        const ask_scene scene = drawn(&l, &scratch, of, OWN, mark_seed(100 + k));
        const bis_set *x = scratch.set;
        weighed g = weigh(&scene, x);
        add_half(&o, lit_ones, &l, &g, &x->map, o.sums + (size_t)k * OWN);
        add_half(&o, lit_ones, &l, &g, &x->brdf, o.sums + (size_t)k * OWN + x->map.n);
    }
    return o;
}

/* Candidates below the horizon may have weights below 0, which are no shares of anything. Then the scene gets a map
 * whose light all lies above the horizon. */
static own own_of(ask_scene *scene, const char *what)
{
    uint32_t lit_ones = 0, other = 0;
    own o = own_under(scene, &lit_ones);

    if (!o.is_right && lit_ones < SETS * OWN / 8) {
        mark_wrong("%s: only %u of %d candidates have a weight and an F; light comes from all sides here", what,
                   lit_ones, SETS * OWN);
    }
    if (!o.some_below_0) return o;
    scene->map = LIT_ONE_BLOCK;
    return own_under(scene, &other);
}

/* MARK_ALPHA is 5.2 standard errors. */
static void check_same_mean(const stat_moments *m, const stat_moments *must, const char *what, const char *why)
{
    const double chance = sqrt(stat_variance(m) / m->n + stat_variance(must) / must->n);

    if (!(fabs(m->mean - must->mean) <= 5.2 * chance)) {
        mark_wrong("%s: the mean of %.0f estimates is %.6g, must be %.6g with the weights of yours (+- %.2g). %s", what,
                   m->n, m->mean, must->mean, chance, why);
    }
}

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
    ask_scene scene = mark_scene(LIT_SMOOTH, glossy(), hidden, ASK_SIR, &s);
    own o = own_of(&scene, what);
    ask_estimate *e = mark_run(&scene, runs, mark_seed(2));
    lit l;

    check_rays(e, &s, runs, what);
    mark_lit(&l, &scene);
    if (o.is_right) {
        mark_estimates(e, &l, runs, MARK_ALPHA, what, hint);
    } else {
        stat_moments m[4];
        mark_moments(m, e, runs);
        for (int i = 0; i < 3; i++) check_same_mean(&m[i], &o.value[i], what, hint);
    }
}

/* With one candidate and one ray nothing is chosen: each estimate is w F/phat V of the candidate that the code draws,
 * with the student's w and F (E24). */
static void check_one(bis_proposal proposal, const char *what)
{
    static replay r;
    const bis_settings s = sir(proposal, 1, 1, false);
    ask_scene of = mark_scene(LIT_SMOOTH, glossy(), LIT_HALF, ASK_SIR, &s);
    uint32_t with_weight = 0;

    of.kind = BIS_SAMPLER_RANDOM;
    replay_freshen(&of);
    r = (replay){.n = REPLAY_RUNS, .knows_rays = true};
    for (uint32_t k = 0; k < r.n; k++) {
        bis_scratch scratch;
        lit l;
        const ask_scene scene = drawn(&l, &scratch, &of, 1, mark_seed(200 + k));
        const bis_half *half = scratch.set->map.n ? &scratch.set->map : &scratch.set->brdf;
        const vec3 wi = {half->x.x[0], half->x.y[0], half->x.z[0]};
        weighed g = weigh(&scene, scratch.set);
        const double w = weight_of(&g, half->first), phat = rgbd_sum(F_of(&g, half->first)),
            scale = w > 0 && phat > 0 && !lit_is_hidden(of.hidden, (double)wi.y) ? w / phat : 0;
        ask_estimate *e = mark_run(&scene, 2, scene.seed); /* weights are asked for by run 1 */
        r.run[k] = k;
        r.mine[k] = e[1];
        r.must[k] = (ask_estimate){.L = rgbd_round(rgbd_scale(F_of(&g, half->first), scale)), .rays = w > 0,
            .first = {.n = w > 0, .to = {wi}}};
        with_weight += w > 0 && phat > 0;
    }
    if (with_weight < r.n / 8) mark_wrong("%s: only %u of %u candidates weigh anything", what, with_weight, r.n);
    replay_check(&r, what, "the candidates", hint);
}

static void unbiased_for_one_candidate_and_one_ray(void)
{
    check_one(BIS_PROPOSAL_EM, "M = 1, N = 1, from the map");
    check_one(BIS_PROPOSAL_BRDF, "M = 1, N = 1, from the BRDF");
}

static void unbiased_for_few_candidates(void)
{
    check(sir(BIS_PROPOSAL_EM, 2, 1, false), LIT_HALF, 30000, "M = 2, N = 1");
    check(sir(BIS_PROPOSAL_MIX, 4, 3, false), LIT_HALF, 20000, "M = 4, N = 3, a mixture");
    check(sir(BIS_PROPOSAL_EM, 3, 7, true), LIT_OPEN, 20000, "M = 3, N = 7: more rays than candidates");
}

/* The squared error of r + g + b must be that of M plain samples of the map; with wrong weights, that of the mean of M
 * of them. */
static void check_noise(uint32_t M, uint32_t N, const char *what, const char *why)
{
    enum { RUNS = 30000 };
    const bis_settings s = sir(BIS_PROPOSAL_EM, M, N, false);
    ask_scene scene = mark_scene(LIT_SPOTTY, bis_phong((rgb){0.8f, 0.8f, 0.8f}, (rgb){0, 0, 0}, 1), LIT_OPEN,
                                 ASK_SIR, &s);
    own o = own_of(&scene, what);
    ask_estimate *e = mark_run(&scene, RUNS, mark_seed(3));
    stat_moments square = {0}, must = {0};
    lit l;

    check_rays(e, &s, RUNS, what);
    mark_lit(&l, &scene);
    const double mean = o.is_right ? rgbd_sum(lit_truth(&l, false)) : o.value[3].mean;
    for (uint32_t run = 0; run < RUNS; run++) {
        const double d = rgb_sum(e[run].L) - mean;
        stat_add(&square, d * d);
    }
    for (uint32_t k = 0; !o.is_right && k + M <= SETS * OWN; k += M) {
        double sum = 0;
        for (uint32_t i = 0; i < M; i++) sum += o.sums[k + i];
        stat_add(&must, (sum / M - mean) * (sum / M - mean));
    }
    if (o.is_right) mark_mean(&square, lit_variance_em(&l) / M, MARK_ALPHA, what, why);
    else check_same_mean(&square, &must, what, why);
}

static void unbiased_for_many_candidates(void)
{
    check(sir(BIS_PROPOSAL_MIX, 64, 4, true), LIT_HALF, 3000, "M = 64, N = 4, stratified");
    check_noise(32, 1, "M = 32, N = 1, in the open: the squared error",
                "It must be that of 32 samples: all candidates count, in Zhat, and not only the one that is traced.");
}

/* In the open and without colour all F/phat are equal: the noise is that of Zhat alone, however few the rays. */
static void rays_add_no_noise_where_nothing_is_hidden(void)
{
    check_noise(8, 3, "M = 8, N = 3, in the open: the squared error",
                "It must be that of 8 samples, not of 3: the rays only ask for visibility.");
}

/* Some of its estimates are looked at, too; which, nobody knows before. */
static void work(void)
{
    static const double recorded[REPLAY_KIT] = {
        128.387, 144.54, 133.443, 137.344, 133.002, 142.473, 139.475, 135.437, 119.199, 111.72, 134.323, 132.025};
    static replay r;
    const bis_settings s = sir(BIS_PROPOSAL_EM, (uint32_t)mark_size(128), 8, false);
    const ask_scene scene = mark_scene(LIT_SPOTTY, glossy(), LIT_HALF, ASK_SIR, &s);

    replay_ask(&r, &scene, &bis_sir, 5000, recorded);
    replay_check(&r, "the load that is timed", "the candidates", hint);
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
