/* Assignment rejection: src/thesis/rejection.c: which bound, who is accepted, what the accepted are worth. Means against brute force
 * (tests/lit.h). Statistical tests: 20, at 1e-5 each. */
#include "mark.h"

#include "bis/thesis/phong.h"
#include "thesis/candidates.h"

static const double ALPHA = 1e-5;
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

/* The mean number of accepted ones among 8. */
static stat_moments acceptance(lit *l, bis_proposal proposal)
{
    const bis_settings s = rejection(proposal, 8, 4, BIS_ESTIMATOR_PLAIN);
    stat_moments accepted = {0};
    bis_scratch scratch;

    if (bis_scratch_init(&scratch, &s, NULL)) mark_wrong("no memory");
    for (uint64_t run = 0; run < 30000; run++) {
        const uint64_t before = l->counters.accepted;
        lit_once(l, &s, &scratch, 1, run);
        stat_add(&accepted, (double)(l->counters.accepted - before));
    }
    bis_scratch_clear(&scratch);
    return accepted;
}

static void check_acceptance(bis_proposal proposal, const char *what)
{
    bis_light *light = lit_new_light(LIT_SMOOTH, 1, 0, false);
    lit l;

    lit_init(&l, light, shiny(), tilted(), 40, LIT_OPEN);
    const stat_moments m = acceptance(&l, proposal);
    mark_mean(&m, 8 * rgbd_sum(lit_truth(&l, false)) / bis_candidates_bound(&l.pt, proposal), ALPHA, what,
              "In the mean, a candidate is accepted with probability L_ns/B.");
    bis_light_free(light);
}

static void candidates_of_the_map_are_accepted_with_probability_w_over_B(void) { check_acceptance(BIS_PROPOSAL_EM, "how many of 8 from the map are accepted"); }
static void candidates_of_the_brdf_are_accepted_with_probability_w_over_B(void) { check_acceptance(BIS_PROPOSAL_BRDF, "how many of 8 from the BRDF are accepted"); }

static void the_smaller_bound_is_chosen_more_often(void)
{
    bis_light *light = lit_new_light(LIT_SMOOTH, 1, 0, false);
    lit l;

    lit_init(&l, light, shiny(), tilted(), 40, LIT_OPEN);
    const double c_em = bis_candidates_bound(&l.pt, BIS_PROPOSAL_EM), c_brdf = bis_candidates_bound(&l.pt, BIS_PROPOSAL_BRDF);
    const double p_em = c_brdf / (c_em + c_brdf), L = rgbd_sum(lit_truth(&l, false));
    const stat_moments m = acceptance(&l, BIS_PROPOSAL_CHOOSE);
    mark_mean(&m, 8 * (p_em * L / c_em + (1 - p_em) * L / c_brdf), ALPHA, "how many of 8 are accepted, proposal "
              "\"choose\"", "P(em) = c_brdf/(c_em + c_brdf).");
    bis_light_free(light);
}

static void check(bis_proposal proposal, uint32_t M, uint32_t N, lit_hidden hidden, const char *what)
{
    bis_light *light = lit_new_light(LIT_SMOOTH, 1, 0, false);
    const bis_settings s = rejection(proposal, M, N, BIS_ESTIMATOR_PLAIN);
    lit l;

    lit_init(&l, light, shiny(), tilted(), 40, hidden);
    mark_estimates(&l, &s, 30000, 2, ALPHA, what, hint);
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

static void the_ratio_estimator_is_right_to_two_percent(void)
{
    bis_light *light = lit_new_light(LIT_SMOOTH, 1, 0, false);
    const bis_settings s = rejection(BIS_PROPOSAL_EM, 200, 4, BIS_ESTIMATOR_RATIO);
    stat_moments m[4];
    lit l;

    lit_init(&l, light, shiny(), tilted(), 40, LIT_HALF);
    mark_run(m, &l, &s, 3000, 3);
    if (l.counters.accepted == 0) mark_wrong("no candidate is accepted at all");
    mark_near(m[3].mean, rgbd_sum(lit_truth(&l, true)), 0, 0.02, "the ratio estimator, M = 200, N = 4: L");
    bis_light_free(light);
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
        lit_once(&l, &s, &scratch, 4, run);
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
    mark_run(m, &l, &s, 5000, 5);
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
