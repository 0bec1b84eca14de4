/* Assignment sir: src/thesis/set.c, src/thesis/choose.c and src/thesis/sir.c. Weights by the textbooks' formulas, choices by hand, means against brute force, and
 * rays counted (tests/support/lit.h): not even the right mean counts where more are cast than N. Statistical tests: 23. */
#include "mark.h"

#include "bis/thesis/phong.h"
#include "thesis/candidates.h"
#include "thesis/set.h"

static const char *const hint = "L = (Zhat/N) sum of F/phat V over the chosen, Zhat = W/M: the mean weight of these very candidates.";

static vec3 tilted(void) { return normalize(vec3_from(0.2, -0.3, 0.8)); }
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

static bis_stream stream_of(uint64_t run, bis_sampler *sampler)
{
    bis_stream stream;

    *sampler = (bis_sampler){.kind = BIS_SAMPLER_RANDOM, .seed = mark_seed(9), .spp = 1, .xsamples = 1, .ysamples = 1, .jitter = true};
    bis_stream_init(&stream, sampler, run, 0);
    return stream;
}

/* ---- weights ---- */

/* Candidate i of a half against F = f Le and w = phat/q, q = beta q_L + (1 - beta) q_f. Le and q_L are those that it was drawn with. */
static bool check_candidate(const lit *l, const bis_set *x, const bis_half *half, uint32_t i, double beta, const char *what)
{
    const bis_lanes y = half->x;
    const uint32_t number = half->first + i;
    const double wi[3] = {(double)y.x[i], (double)y.y[i], (double)y.z[i]}, unit = x->unit_of_f * x->unit_of_Le;
    const double cosine = dot(l->pt.n, (vec3){y.x[i], y.y[i], y.z[i]}), w = bis_set_weight(x, number);
    double q_f;
    const rgbd f = lit_f(l, wi, &q_f);
    const rgbd F = {f.r * (double)y.r[i] * x->unit_of_Le, f.g * (double)y.g[i] * x->unit_of_Le, f.b * (double)y.b[i] * x->unit_of_Le};
    const double q = beta * (double)y.q[i] + (1 - beta) * q_f, degrees = acos(fmin(1, cosine)) * 180 / PI;

    if (cosine <= 0) {
        if (w != 0) mark_wrong("%s: candidate %u lies below the horizon, but has weight %g", what, number, w);
        return false;
    }
    mark_near(w, rgbd_sum(F) * cosine / q, 0, 1e-3, "%s: the weight of candidate %u, %.0f degrees from the normal, phat/q = (f cos Le summed over RGB)/q,", what,
              number, degrees);
    mark_near((double)x->F[0][number] * unit, F.r, 0, 1e-3, "%s: F_r of candidate %u, f Le without the cosine,", what, number);
    mark_near((double)x->F[1][number] * unit, F.g, 0, 1e-3, "%s: F_g of candidate %u, f Le without the cosine,", what, number);
    mark_near((double)x->F[2][number] * unit, F.b, 0, 1e-3, "%s: F_b of candidate %u, f Le without the cosine,", what, number);
    return w > 0;
}

static void check_weights(bis_proposal proposal, double beta, const char *what)
{
    enum { M = 400 };
    bis_light *light = lit_new_light(LIT_SMOOTH, 1, 0, false);
    const bis_settings s = sir(proposal, M, 1, false);
    bis_sampler sampler;
    bis_scratch scratch;
    uint32_t lit_ones = 0;
    double sum = 0;
    lit l;

    lit_init(&l, light, glossy(), tilted(), 40, LIT_OPEN);
    if (bis_scratch_init(&scratch, &s, NULL)) mark_wrong("no memory");
    bis_set *x = scratch.set;
    bis_stream stream = stream_of(1, &sampler);
    bis_set_draw(x, M, proposal, false, &l.pt, &stream);
    const double Zhat = bis_set_weigh(x, &l.pt);
    const bis_half *halves[] = {&x->map, &x->brdf};
    for (int k = 0; k < 2; k++) {
        for (uint32_t i = 0; i < halves[k]->n; i++) {
            lit_ones += check_candidate(&l, x, halves[k], i, beta, what);
            sum += bis_set_weight(x, halves[k]->first + i);
        }
    }
    if (lit_ones < M / 8) mark_wrong("%s: only %u of %d candidates have a weight; light comes from all sides here", what, lit_ones, M);
    mark_near(Zhat, sum / M, 0, 1e-5, "%s: the mean of the weights (have you written beyond the n candidates?)", what);
    bis_scratch_clear(&scratch);
    bis_light_free(light);
}

static void weights_from_the_map_are_phat_over_q(void) { check_weights(BIS_PROPOSAL_EM, 1, "candidates from the map"); }
static void weights_from_the_brdf_are_phat_over_q(void) { check_weights(BIS_PROPOSAL_BRDF, 0, "candidates from the BRDF"); }

static void weights_of_a_mixture_have_the_mixed_density(void)
{
    bis_light *light = lit_new_light(LIT_SMOOTH, 1, 0, false);
    bis_sampler sampler;
    lit l;

    lit_init(&l, light, glossy(), tilted(), 40, LIT_OPEN);
    bis_stream stream = stream_of(1, &sampler);
    const bis_mixture m = bis_candidates_divide(400, BIS_PROPOSAL_MIX, &l.pt, &stream);
    bis_light_free(light);
    check_weights(BIS_PROPOSAL_MIX, m.beta, "candidates of a mixture");
}

/* ---- choices ---- */

/* Four blocks of 16. One has no weight at all, and the last weight of the third is far from its end. */
static const double weights[] = {[1] = 1, [3] = 3, [4] = 0.5, [6] = 2.5, [7] = 1, [31] = 0.25, [48] = 1.5, [50] = 4, [52] = 0.75, [63] = 0};
enum { ITEMS = sizeof weights / sizeof *weights };

static bis_choice choice_of_weights(double *W)
{
    bis_choice c = {.n = 0};
    bis_claims claims = {0};

    bis_choice_claim(&c, ITEMS, &claims);
    if (claims.failed) mark_wrong("no memory");
    for (int i = 0; i < ITEMS; i++) c.w[i] = (float)weights[i];
    *W = bis_choice_sum(&c, ITEMS);
    return c;
}

static void choose(bis_choice *c, uint32_t N, double W, bis_resampling kind, uint64_t run)
{
    bis_sampler sampler;
    bis_stream stream = stream_of(run, &sampler);

    for (int k = 0; k <= ITEMS; k++) c->item[k] = c->times[k] = UINT32_MAX;
    if (kind == BIS_RESAMPLING_MULTINOMIAL) bis_choose_multinomial(c, N, W, &stream);
    else bis_choose_systematic(c, N, W, bis_stream_random(&stream));
}

/* What must hold whenever N marks are given. */
static void check_marks(const bis_choice *c, uint32_t N, double W, bis_resampling kind)
{
    uint64_t marks = 0;

    if (c->n_chosen > ITEMS) mark_wrong("%u items are said to be chosen, of %d", c->n_chosen, ITEMS);
    for (uint32_t k = 0; k < c->n_chosen; k++) {
        const uint32_t i = c->item[k], times = c->times[k];
        if (i >= ITEMS) mark_wrong("item[%u] is %u, of %d candidates", k, i, ITEMS);
        if (weights[i] == 0) mark_wrong("candidate %u is chosen, its weight is 0", i);
        if (k > 0 && i <= c->item[k - 1]) {
            mark_wrong("items must ascend, each once: %u follows %u (who has several marks is traced by one ray)", i, c->item[k - 1]);
        }
        if (times == 0 || times > N) mark_wrong("candidate %u is chosen %u times, with %u marks", i, times, N);
        const double share = N * weights[i] / W;
        if (kind == BIS_RESAMPLING_SYSTEMATIC && fabs(times - share) >= 1) {
            mark_wrong("systematic: candidate %u has weight %g of %g and is chosen %u times of %u; one of the two whole numbers next to %.3g would be right", i,
                       weights[i], W, times, N, share);
        }
        marks += times;
    }
    if (marks != N) mark_wrong("%u marks of %u are given to candidates", (unsigned)marks, N);
}

/* A W that is too large, as rounding can make it by an ulp: what marks lie beyond the sum belong to the last one with a weight. */
static void check_last_marks(bis_resampling kind)
{
    enum { N = 8, LAST = 52 };
    double W;
    bis_choice c = choice_of_weights(&W);

    for (uint32_t run = 0; run < 100; run++) {
        choose(&c, N, 2 * W, kind, run);
        uint64_t marks = 0;
        for (uint32_t k = 0; k < c.n_chosen && k < ITEMS; k++) {
            const uint32_t i = c.item[k];
            marks += c.times[k];
            if (i >= ITEMS || weights[i] == 0) {
                mark_wrong("a mark lies beyond all weights, as rounding may put it, and chooses %u, which has no weight: it must be the last one that has one, %d",
                           i, LAST);
            }
        }
        if (marks != N) {
            mark_wrong("%u marks of %d are given where some lie beyond all weights, as rounding may put them: they belong to the last candidate that has a weight, %d",
                       (unsigned)marks, N, LAST);
        }
    }
    bis_choice_clear(&c);
}

static void check_choice(bis_resampling kind, const char *what)
{
    enum { RUNS = 20000, N = 5 };
    double count[ITEMS] = {0}, expected[ITEMS], W;
    stat_moments square = {0};
    bis_choice c = choice_of_weights(&W);

    check_last_marks(kind);
    for (uint32_t run = 0; run < RUNS; run++) {
        double of_3 = 0;
        choose(&c, N, W, kind, run);
        check_marks(&c, N, W, kind);
        for (uint32_t k = 0; k < c.n_chosen; k++) {
            count[c.item[k]] += c.times[k];
            if (c.item[k] == 3) of_3 = c.times[k];
        }
        stat_add(&square, (of_3 - N * 3 / W) * (of_3 - N * 3 / W));
    }
    for (int i = 0; i < ITEMS; i++) expected[i] = weights[i] / W * RUNS * N;
    /* systematic choices vary less than independent ones, which a chi-square test takes for granted: it errs on the safe side */
    mark_fit(count, expected, ITEMS, MARK_ALPHA, what, "Candidate i owns the marks between the running sums before and "
             "after w_i.");
    if (kind == BIS_RESAMPLING_MULTINOMIAL) {
        mark_mean(&square, N * (3 / W) * (1 - 3 / W), MARK_ALPHA, "multinomial: the square of how far the count of "
                  "candidate 3 is from its mean", "N independent marks: next_mark gives them in order.");
    }
    bis_choice_clear(&c);
}

static void candidates_are_chosen_in_proportion_to_their_weights(void) { check_choice(BIS_RESAMPLING_SYSTEMATIC, "systematic"); }
static void multinomial_choices_are_independent(void) { check_choice(BIS_RESAMPLING_MULTINOMIAL, "multinomial"); }

/* ---- the estimate ---- */

/* N rays at most, whatever M: they are what is dear. */
static void check_rays(lit *l, const bis_settings *s, const char *what)
{
    const uint32_t most = s->shadowrays < s->candidates ? s->shadowrays : s->candidates;
    const uint64_t rays = lit_most_rays(l, s, 500, mark_seed(5));

    if (rays > most) {
        mark_wrong("%s: an estimate casts %u shadow rays, must be %u at most: N of the candidates are chosen, and only they are traced", what,
                   (unsigned)rays, most);
    }
}

static void check(bis_settings s, lit_hidden hidden, uint32_t runs, const char *what)
{
    bis_light *light = lit_new_light(LIT_SMOOTH, 1, 0, false);
    lit l;

    lit_init(&l, light, glossy(), tilted(), 40, hidden);
    check_rays(&l, &s, what);
    mark_estimates(&l, &s, runs, mark_seed(2), MARK_ALPHA, what, hint);
    bis_light_free(light);
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
static void check_noise(uint32_t M, uint32_t N, const char *what, const char *why)
{
    bis_light *light = lit_new_light(LIT_SPOTTY, 1, 0, false);
    const bis_settings s = sir(BIS_PROPOSAL_EM, M, N, false);
    stat_moments square = {0};
    bis_scratch scratch;
    lit l;

    lit_init(&l, light, bis_phong((rgb){0.8f, 0.8f, 0.8f}, (rgb){0, 0, 0}, 1), tilted(), 40, LIT_OPEN);
    check_rays(&l, &s, what);
    const double truth = rgbd_sum(lit_truth(&l, false)), variance = lit_variance_em(&l);
    if (bis_scratch_init(&scratch, &s, NULL)) mark_wrong("no memory");
    for (uint64_t run = 0; run < 30000; run++) {
        const double d = rgb_sum(lit_once(&l, &s, &scratch, mark_seed(3), run)) - truth;
        stat_add(&square, d * d);
    }
    mark_mean(&square, variance / M, MARK_ALPHA, what, why);
    bis_scratch_clear(&scratch);
    bis_light_free(light);
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

static void work(void)
{
    bis_light *light = lit_new_light(LIT_SPOTTY, 1, 0, false);
    const bis_settings s = sir(BIS_PROPOSAL_MIX, 128, 8, true);
    stat_moments m[4];
    lit l;

    lit_init(&l, light, glossy(), tilted(), 40, LIT_HALF);
    mark_run(m, &l, &s, 3000, mark_seed(4));
    bis_light_free(light);
}

int main(int argc, char **argv)
{
    static const mark_claim claims[] = {
        {"weights_from_the_map_are_phat_over_q", 10, weights_from_the_map_are_phat_over_q},
        {"weights_from_the_brdf_are_phat_over_q", 5, weights_from_the_brdf_are_phat_over_q},
        {"weights_of_a_mixture_have_the_mixed_density", 10, weights_of_a_mixture_have_the_mixed_density},
        {"candidates_are_chosen_in_proportion_to_their_weights", 10, candidates_are_chosen_in_proportion_to_their_weights},
        {"multinomial_choices_are_independent", 5, multinomial_choices_are_independent},
        {"unbiased_for_one_candidate_and_one_ray", 10, unbiased_for_one_candidate_and_one_ray},
        {"unbiased_for_few_candidates", 10, unbiased_for_few_candidates},
        {"unbiased_for_many_candidates", 10, unbiased_for_many_candidates},
        {"rays_add_no_noise_where_nothing_is_hidden", 10, rays_add_no_noise_where_nothing_is_hidden},
    };

    return mark_main(argc, argv, claims, sizeof claims / sizeof *claims, work);
}
