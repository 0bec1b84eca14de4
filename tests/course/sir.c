/* Assignment sir: src/thesis/candidates.c and src/thesis/sir.c, one candidate after the other ("vectorize" is off: src/beyond/batch.c, the fast double, has no part in
 * it). Weights by the textbooks' formulas, choices by hand, means against brute force, and rays counted (tests/support/lit.h): not even the
 * right mean counts where more are cast than N. Statistical tests: 23. */
#include "mark.h"

#include "bis/thesis/phong.h"
#include "thesis/candidates.h"

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
    s.vectorize = false;
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

/* Each candidate's C against f cos Le/q, q = beta q_L + (1 - beta) q_f. */
static void check_weights(bis_proposal proposal, double beta, const char *what)
{
    enum { M = 400 };
    bis_light *light = lit_new_light(LIT_SMOOTH, 1, 0, false);
    static bis_candidate c[M];
    bis_sampler sampler;
    int lit_ones = 0;
    lit l;

    lit_init(&l, light, glossy(), tilted(), 40, LIT_OPEN);
    bis_stream stream = stream_of(1, &sampler);
    const double W = bis_candidates_draw(c, M, proposal, false, NULL, &l.pt, &stream);
    double sum = 0;
    for (int i = 0; i < M; i++) {
        sum += c[i].w;
        if (c[i].w == 0) continue;
        const double wi[3] = {(double)c[i].wi.x, (double)c[i].wi.y, (double)c[i].wi.z}, cosine = dot(l.pt.n, c[i].wi);
        double q_f;
        const rgbd f = lit_f(&l, wi, &q_f);
        const rgb Le = bis_light_Le(light, c[i].wi);
        const double q = beta * bis_light_pdf(light, c[i].wi) + (1 - beta) * q_f;
        const double w = (f.r * (double)Le.r + f.g * (double)Le.g + f.b * (double)Le.b) * cosine / q;
        if (cosine <= 0) mark_wrong("%s: candidate %d lies below the horizon, but has weight %g", what, i, c[i].w);
        mark_near(c[i].w, w, 0, 1e-3, "%s: the weight of candidate %d, %.0f degrees from the normal, phat/q = (f "
                  "cos Le summed over RGB)/q,", what, i, acos(fmin(1, cosine)) * 180 / PI);
        mark_near(rgbd_sum(c[i].C), c[i].w, 0, 1e-9, "%s: C.r + C.g + C.b of candidate %d", what, i);
        mark_near(c[i].C.r, f.r * (double)Le.r * cosine / q, 0, 1e-3, "%s: C.r of candidate %d", what, i);
        mark_near(c[i].C.g, f.g * (double)Le.g * cosine / q, 0, 1e-3, "%s: C.g of candidate %d", what, i);
        lit_ones++;
    }
    if (lit_ones < M / 8) {
        mark_wrong("%s: only %d of %d candidates have a weight; light comes from all sides here", what, lit_ones, M);
    }
    mark_near(W, sum, 0, 1e-9, "%s: the sum of the weights", what);
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

static const double weights[] = {0, 1, 0, 3, 0.5, 0, 2.5, 1, 0, 0};
enum { M10 = sizeof weights / sizeof *weights };

/* How often each of ten is chosen in `runs` choices of N; checks what must hold each time. */
static void choose(double *count, uint32_t N, bis_resampling kind, uint32_t runs, stat_moments *of_3)
{
    bis_candidate c[M10] = {{.w = 0}};
    bis_sampler sampler;
    uint32_t chosen[16];
    double W = 0;

    for (int i = 0; i < M10; i++) W += c[i].w = weights[i];
    for (uint32_t run = 0; run < runs; run++) {
        bis_stream stream = stream_of(run, &sampler);
        double now[M10] = {0};
        for (uint32_t j = 0; j < 16; j++) chosen[j] = UINT32_MAX;
        bis_candidates_resample(chosen, N, c, M10, W, kind, &stream);
        for (uint32_t j = 0; j < N; j++) {
            if (chosen[j] >= M10) mark_wrong("choice %u of %u is %u, of 10 candidates", j, N, chosen[j]);
            if (weights[chosen[j]] == 0) mark_wrong("candidate %u is chosen, its weight is 0", chosen[j]);
            if (j > 0 && chosen[j] < chosen[j - 1]) {
                mark_wrong("choices must ascend: %u follows %u (tracing counts on repeats being neighbours)",
                           chosen[j], chosen[j - 1]);
            }
            now[chosen[j]]++;
        }
        for (int i = 0; i < M10; i++) {
            count[i] += now[i];
            const double share = N * weights[i] / W;
            if (kind == BIS_RESAMPLING_SYSTEMATIC && fabs(now[i] - share) >= 1) {
                mark_wrong("systematic: candidate %d has weight %g of %g and is chosen %.0f times of %u; one of the "
                           "two whole numbers next to %.3g would be right", i, weights[i], W, now[i], N, share);
            }
        }
        stat_add(of_3, (now[3] - N * 3 / W) * (now[3] - N * 3 / W));
    }
}

/* A W that is too large, as rounding can make it by an ulp: what marks lie beyond the sum belong to the last one with a weight. */
static void check_last_marks(bis_resampling kind)
{
    enum { N = 8 };
    bis_candidate c[M10] = {{.w = 0}};
    bis_sampler sampler;
    uint32_t chosen[N];
    double W = 0;

    for (int i = 0; i < M10; i++) W += c[i].w = weights[i];
    for (uint32_t run = 0; run < 100; run++) {
        bis_stream stream = stream_of(run, &sampler);
        for (uint32_t j = 0; j < N; j++) chosen[j] = UINT32_MAX;
        bis_candidates_resample(chosen, N, c, M10, 2 * W, kind, &stream);
        for (uint32_t j = 0; j < N; j++) {
            if (chosen[j] < M10 && weights[chosen[j]] > 0) continue;
            mark_wrong("choice %u is %u (-1: none was made), where its mark lies beyond all weights, as rounding may put it: it must be the last "
                       "one that has a weight, 7", j, (unsigned)chosen[j]);
        }
    }
}

static void check_choice(bis_resampling kind, const char *what)
{
    enum { RUNS = 20000, N = 5 };
    double count[M10] = {0}, expected[M10], W = 0;
    stat_moments square = {0};

    check_last_marks(kind);
    choose(count, N, kind, RUNS, &square);
    for (int i = 0; i < M10; i++) W += weights[i];
    for (int i = 0; i < M10; i++) expected[i] = weights[i] / W * RUNS * N;
    /* systematic choices vary less than independent ones, which a chi-square test takes for granted: it errs on the safe side */
    mark_fit(count, expected, M10, MARK_ALPHA, what, "Candidate i owns the marks between the running sums before and "
             "after w_i.");
    if (kind == BIS_RESAMPLING_MULTINOMIAL) {
        mark_mean(&square, N * (3 / W) * (1 - 3 / W), MARK_ALPHA, "multinomial: the square of how far the count of "
                  "candidate 3 is from its mean", "N independent marks: bis_marks_next gives them in order.");
    }
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
