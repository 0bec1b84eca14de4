/* Assignment rejection: src/thesis/rejection.c: which bound, who is accepted, what the accepted are worth. Means against brute force
 * and rays counted (tests/support/lit.h). Statistical tests: 21. */
#include "mark.h"

#include "bis/thesis/phong.h"
#include "thesis/candidates.h"

static const char *const hint = "Accept with probability w/B; each traced candidate stands for A/n accepted ones; divide by M, accepted or not.";

static vec3 tilted(void) { return normalize(vec3_from(0.2, -0.3, 0.8)); }
static bis_material shiny(void) { return bis_phong((rgb){0.5f, 0.5f, 0.5f}, (rgb){0.5f, 0.5f, 0.5f}, 5); }

static bis_settings rejection(bis_proposal proposal, uint32_t M, uint32_t N, bis_estimator estimator)
{
    bis_settings s = bis_settings_default(&bis_rejection);

    s.proposal = proposal;
    s.candidates = M;
    s.shadowrays = N;
    s.estimator = estimator;
    return s;
}

/* How many of 8 are accepted, and the square of how far that is from `expected`. */
static stat_moments acceptance(lit *l, bis_proposal proposal, double expected, stat_moments *square)
{
    const bis_settings s = rejection(proposal, 8, 4, BIS_ESTIMATOR_PLAIN);
    stat_moments accepted = {0};
    bis_scratch scratch;

    *square = accepted;
    if (bis_scratch_init(&scratch, &s, NULL)) mark_wrong("no memory");
    for (uint64_t run = 0; run < 30000; run++) {
        const uint64_t before = l->counters.accepted;
        lit_once(l, &s, &scratch, mark_seed(1), run);
        const double A = (double)(l->counters.accepted - before);
        stat_add(&accepted, A);
        stat_add(square, (A - expected) * (A - expected));
    }
    bis_scratch_clear(&scratch);
    return accepted;
}

/* Independent candidates, each accepted with probability p = L_ns/B: A is binomial. */
static void check_acceptance(bis_proposal proposal, const char *what, const char *square_of_what)
{
    bis_light *light = lit_new_light(LIT_SMOOTH, 1, 0, false);
    stat_moments square;
    lit l;

    lit_init(&l, light, shiny(), tilted(), 40, LIT_OPEN);
    const double p = rgbd_sum(lit_truth(&l, false)) / bis_candidates_bound(&l.pt, proposal);
    const stat_moments m = acceptance(&l, proposal, 8 * p, &square);
    mark_mean(&m, 8 * p, MARK_ALPHA, what, "In the mean, a candidate is accepted with probability L_ns/B. bis_set_weight has w in the unit of B.");
    mark_mean(&square, 8 * p * (1 - p), MARK_ALPHA, square_of_what, "Each candidate has a random number of its own.");
    bis_light_free(light);
}

static void candidates_of_the_map_are_accepted_with_probability_w_over_B(void)
{
    check_acceptance(BIS_PROPOSAL_EM, "how many of 8 from the map are accepted", "how many of 8 from the map are accepted, less the mean, squared");
}

static void candidates_of_the_brdf_are_accepted_with_probability_w_over_B(void)
{
    check_acceptance(BIS_PROPOSAL_BRDF, "how many of 8 from the BRDF are accepted", "how many of 8 from the BRDF are accepted, less the mean, squared");
}

static void the_smaller_bound_is_chosen_more_often(void)
{
    bis_light *light = lit_new_light(LIT_SMOOTH, 1, 0, false);
    lit l;

    lit_init(&l, light, shiny(), tilted(), 40, LIT_OPEN);
    const double c_em = bis_candidates_bound(&l.pt, BIS_PROPOSAL_EM), c_brdf = bis_candidates_bound(&l.pt, BIS_PROPOSAL_BRDF);
    const double p_em = c_brdf / (c_em + c_brdf), L = rgbd_sum(lit_truth(&l, false));
    stat_moments square;
    const stat_moments m = acceptance(&l, BIS_PROPOSAL_CHOOSE, 0, &square);
    mark_mean(&m, 8 * (p_em * L / c_em + (1 - p_em) * L / c_brdf), MARK_ALPHA, "how many of 8 are accepted, proposal "
              "\"choose\"", "P(em) = c_brdf/(c_em + c_brdf).");
    bis_light_free(light);
}

static void check(bis_proposal proposal, uint32_t M, uint32_t N, lit_hidden hidden, const char *what)
{
    bis_light *light = lit_new_light(LIT_SMOOTH, 1, 0, false);
    const bis_settings s = rejection(proposal, M, N, BIS_ESTIMATOR_PLAIN);
    lit l;

    lit_init(&l, light, shiny(), tilted(), 40, hidden);
    const uint64_t rays = lit_most_rays(&l, &s, 2000, mark_seed(6));
    if (rays > N) mark_wrong("%s: an estimate casts %u shadow rays, must be N = %u at most", what, (unsigned)rays, N);
    mark_estimates(&l, &s, 30000, mark_seed(2), MARK_ALPHA, what, hint);
    bis_light_free(light);
}

static void one_candidate_and_one_ray_are_right(void) { check(BIS_PROPOSAL_EM, 1, 1, LIT_HALF, "M = 1, N = 1"); }
static void many_rays_are_right(void) { check(BIS_PROPOSAL_EM, 8, 8, LIT_HALF, "M = 8, N = 8, so that all accepted are traced"); }

static void fewer_rays_than_accepted_are_right(void)
{
    check(BIS_PROPOSAL_EM, 32, 1, LIT_HALF, "M = 32, N = 1");
    check(BIS_PROPOSAL_BRDF, 32, 3, LIT_HALF, "M = 32, N = 3, from the BRDF");
    check(BIS_PROPOSAL_CHOOSE, 16, 2, LIT_OPEN, "M = 16, N = 2, \"choose\"");
}

/* In the open and without colour all F/phat are equal, so that L = W/M: its noise is that of M samples, whatever was accepted. */
static void check_noise_of_ratio(void)
{
    bis_light *light = lit_new_light(LIT_SMOOTH, 1, 0, false);
    const bis_settings s = rejection(BIS_PROPOSAL_EM, 16, 2, BIS_ESTIMATOR_RATIO);
    stat_moments square = {0};
    bis_scratch scratch;
    lit l;

    lit_init(&l, light, bis_phong((rgb){0.8f, 0.8f, 0.8f}, (rgb){0, 0, 0}, 1), tilted(), 40, LIT_OPEN);
    const double truth = rgbd_sum(lit_truth(&l, false)), variance = lit_variance_em(&l);
    if (bis_scratch_init(&scratch, &s, NULL)) mark_wrong("no memory");
    for (uint64_t run = 0; run < 20000; run++) {
        const double d = rgb_sum(lit_once(&l, &s, &scratch, mark_seed(8), run)) - truth;
        stat_add(&square, d * d);
    }
    mark_mean(&square, variance / 16, MARK_ALPHA, "the ratio estimator, M = 16, N = 2, in the open: the squared error", "It must be that of 16 samples: "
              "W/M has all candidates in it. Is this the plain estimator?");
    bis_scratch_clear(&scratch);
    bis_light_free(light);
}

/* Its bias, of the order 1/M, is allowed 2 %: the mean is tested against the nearest value that is. */
static void the_ratio_estimator_is_right_to_two_percent(void)
{
    bis_light *light = lit_new_light(LIT_SMOOTH, 1, 0, false);
    const bis_settings s = rejection(BIS_PROPOSAL_EM, 200, 24, BIS_ESTIMATOR_RATIO);
    stat_moments m[4];
    lit l;

    lit_init(&l, light, shiny(), tilted(), 40, LIT_HALF);
    mark_run(m, &l, &s, 3000, mark_seed(3));
    if (l.counters.accepted == 0) mark_wrong("no candidate is accepted at all");
    const uint64_t rays = lit_most_rays(&l, &s, 1000, mark_seed(7));
    if (rays > 24) mark_wrong("the ratio estimator: an estimate casts %u shadow rays, must be N = 24 at most", (unsigned)rays);
    const double truth = rgbd_sum(lit_truth(&l, true)), allowed = fmin(fmax(m[3].mean, 0.98 * truth), 1.02 * truth);
    mark_mean(&m[3], allowed, MARK_ALPHA, "the ratio estimator, M = 200, N = 24", "It may be wrong by 2 %, and no more than chance beyond that.");
    bis_light_free(light);
    check_noise_of_ratio();
}

static void at_most_N_of_the_accepted_are_traced(void)
{
    bis_light *light = lit_new_light(LIT_SMOOTH, 1, 0, false);
    const bis_settings s = rejection(BIS_PROPOSAL_EM, 32, 3, BIS_ESTIMATOR_PLAIN);
    bis_scratch scratch;
    uint64_t all = 0;
    lit l;

    lit_init(&l, light, shiny(), tilted(), 40, LIT_OPEN);
    if (bis_scratch_init(&scratch, &s, NULL)) mark_wrong("no memory");
    for (uint64_t run = 0; run < 2000; run++) {
        const uint64_t accepted = l.counters.accepted, rays = l.counters.shadow_rays;
        lit_once(&l, &s, &scratch, mark_seed(4), run);
        const uint64_t A = l.counters.accepted - accepted, traced = l.counters.shadow_rays - rays;
        if (traced > 3) mark_wrong("N = 3, but %u rays are traced", (unsigned)traced);
        if (traced != (A < 3 ? A : 3)) {
            mark_wrong("N = 3, %u are accepted, %u rays traced: each accepted one is to be traced once, while there "
                       "are rays", (unsigned)A, (unsigned)traced);
        }
        all += traced;
    }
    if (all == 0) mark_wrong("not a single ray was traced");
    bis_scratch_clear(&scratch);
    bis_light_free(light);
}

static void work(void)
{
    bis_light *light = lit_new_light(LIT_SMOOTH, 1, 0, false);
    const bis_settings s = rejection(BIS_PROPOSAL_CHOOSE, 64, 4, BIS_ESTIMATOR_PLAIN);
    stat_moments m[4];
    lit l;

    lit_init(&l, light, shiny(), tilted(), 40, LIT_HALF);
    mark_run(m, &l, &s, 5000, mark_seed(5));
    bis_light_free(light);
}

int main(int argc, char **argv)
{
    static const mark_claim claims[] = {
        {"candidates_of_the_map_are_accepted_with_probability_w_over_B", 10, candidates_of_the_map_are_accepted_with_probability_w_over_B},
        {"candidates_of_the_brdf_are_accepted_with_probability_w_over_B", 5, candidates_of_the_brdf_are_accepted_with_probability_w_over_B},
        {"the_smaller_bound_is_chosen_more_often", 10, the_smaller_bound_is_chosen_more_often},
        {"one_candidate_and_one_ray_are_right", 10, one_candidate_and_one_ray_are_right},
        {"many_rays_are_right", 10, many_rays_are_right},
        {"fewer_rays_than_accepted_are_right", 20, fewer_rays_than_accepted_are_right},
        {"the_ratio_estimator_is_right_to_two_percent", 5, the_ratio_estimator_is_right_to_two_percent},
        {"at_most_N_of_the_accepted_are_traced", 10, at_most_N_of_the_accepted_are_traced},
    };

    return mark_main(argc, argv, claims, sizeof claims / sizeof *claims, work);
}
