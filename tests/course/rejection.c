/* SPDX-License-Identifier: BSD-2-Clause */
/* Assignment rejection: src/thesis/rejection.c: which bound, who is accepted, what the accepted are worth. Means
 * against brute force and rays counted (tests/support/lit.h). Statistical tests: 22. */
#include "mark.h"

#include "bis/base/mem.h"
#include "thesis/candidates.h"

static const char *const hint = "Accept with probability w/B; each traced candidate stands for A/n accepted ones; "
    "divide by M, accepted or not.";

static bis_material shiny(void) { return bis_phong((rgb){0.5f, 0.5f, 0.5f}, (rgb){0.5f, 0.5f, 0.5f}, 5); }

static bis_settings rejection(bis_proposal proposal, uint32_t M, uint32_t N, bis_estimator estimator)
{
    bis_settings s = lit_settings(&bis_rejection, proposal, M, N);
    s.estimator = estimator;
    return s;
}

static ask_scene scene_of(bis_material m, lit_hidden hidden, const bis_settings *s)
{
    return mark_scene(LIT_SMOOTH, m, hidden, ASK_REJECTION, s);
}

/* How many of 8 are accepted, and the square of how far that is from `expected`. */
static stat_moments acceptance(bis_proposal proposal, double expected, stat_moments *square)
{
    enum { RUNS = 30000 };
    const bis_settings s = rejection(proposal, 8, 4, BIS_ESTIMATOR_PLAIN);
    const ask_scene scene = scene_of(shiny(), LIT_OPEN, &s);
    ask_estimate *e = mark_run(&scene, RUNS, mark_seed(1));
    stat_moments accepted = {0};

    *square = accepted;
    for (int run = 0; run < RUNS; run++) {
        const double A = (double)e[run].accepted;
        stat_add(&accepted, A);
        stat_add(square, (A - expected) * (A - expected));
    }
    bis_free(e);
    return accepted;
}

/* The scene in the open, for what is expected there. bis_light_free(l->light) afterwards. */
static void in_the_open(lit *l, bis_material m)
{
    const bis_settings any = rejection(BIS_PROPOSAL_EM, 1, 1, BIS_ESTIMATOR_PLAIN);
    const ask_scene scene = scene_of(m, LIT_OPEN, &any);

    mark_lit(l, &scene);
}

/* Independent candidates, each accepted with probability p = L_ns/B: A is binomial. */
static void check_acceptance(bis_proposal proposal, const char *what, const char *square_of_what)
{
    stat_moments square;
    lit l;

    in_the_open(&l, shiny());
    const double p = rgbd_sum(lit_truth(&l, false)) / bis_candidates_bound(&l.pt, proposal);
    const stat_moments m = acceptance(proposal, 8 * p, &square);
    mark_mean(&m, 8 * p, MARK_ALPHA, what, "In the mean, a candidate is accepted with probability L_ns/B. "
              "bis_set_weight has w in the unit of B.");
    mark_mean(&square, 8 * p * (1 - p), MARK_ALPHA, square_of_what, "Each candidate has a random number of its own.");
    bis_light_free(l.light);
}

static void candidates_of_the_map_are_accepted_with_probability_w_over_B(void)
{
    check_acceptance(BIS_PROPOSAL_EM, "how many of 8 from the map are accepted",
                     "how many of 8 from the map are accepted, less the mean, squared");
}

static void candidates_of_the_brdf_are_accepted_with_probability_w_over_B(void)
{
    check_acceptance(BIS_PROPOSAL_BRDF, "how many of 8 from the BRDF are accepted",
                     "how many of 8 from the BRDF are accepted, less the mean, squared");
}

static void the_smaller_bound_is_chosen_more_often(void)
{
    lit l;

    in_the_open(&l, shiny());
    const double c_em = bis_candidates_bound(&l.pt, BIS_PROPOSAL_EM),
        c_brdf = bis_candidates_bound(&l.pt, BIS_PROPOSAL_BRDF);
    const double p_em = c_brdf / (c_em + c_brdf), L = rgbd_sum(lit_truth(&l, false));
    stat_moments square;
    const stat_moments m = acceptance(BIS_PROPOSAL_CHOOSE, 0, &square);
    mark_mean(&m, 8 * (p_em * L / c_em + (1 - p_em) * L / c_brdf), MARK_ALPHA, "how many of 8 are accepted, proposal "
              "\"choose\"", "P(em) = c_brdf/(c_em + c_brdf).");
    bis_light_free(l.light);
}

static void check(bis_proposal proposal, uint32_t M, uint32_t N, lit_hidden hidden, const char *what)
{
    enum { RUNS = 30000 };
    const bis_settings s = rejection(proposal, M, N, BIS_ESTIMATOR_PLAIN);
    const ask_scene scene = scene_of(shiny(), hidden, &s);
    ask_estimate *e = mark_run(&scene, RUNS, mark_seed(2));
    const uint64_t rays = mark_most_rays(e, RUNS);
    lit l;

    if (rays > N) mark_wrong("%s: an estimate casts %u shadow rays, must be N = %u at most", what, (unsigned)rays, N);
    mark_lit(&l, &scene);
    mark_estimates(e, &l, RUNS, MARK_ALPHA, what, hint);
    bis_light_free(l.light);
    bis_free(e);
}

static void one_candidate_and_one_ray_are_right(void) { check(BIS_PROPOSAL_EM, 1, 1, LIT_HALF, "M = 1, N = 1"); }
static void many_rays_are_right(void)
{
    check(BIS_PROPOSAL_EM, 8, 8, LIT_HALF, "M = 8, N = 8, so that all accepted are traced");
}

static void fewer_rays_than_accepted_are_right(void)
{
    check(BIS_PROPOSAL_EM, 32, 1, LIT_HALF, "M = 32, N = 1");
    check(BIS_PROPOSAL_BRDF, 32, 3, LIT_HALF, "M = 32, N = 3, from the BRDF");
    check(BIS_PROPOSAL_CHOOSE, 16, 2, LIT_OPEN, "M = 16, N = 2, \"choose\"");
}

/* Of r + g + b in the open, where it is W/M by the ratio estimator, and A B/M by the plain one, whose A is binomial:
 * proposal "choose" alone is asked for by it. */
static double variance(const lit *l, const bis_settings *s, double L)
{
    const double c_em = bis_candidates_bound(&l->pt, BIS_PROPOSAL_EM),
        c_brdf = bis_candidates_bound(&l->pt, BIS_PROPOSAL_BRDF), p_em = c_brdf / (c_em + c_brdf);

    if (s->estimator == BIS_ESTIMATOR_RATIO) return lit_variance_em(l) / s->candidates;
    return (p_em * L * (c_em - L) + (1 - p_em) * L * (c_brdf - L)) / s->candidates;
}

static void check_noise(bis_settings s, double degrees, uint32_t runs, const char *what, const char *why)
{
    ask_scene scene = scene_of(bis_phong((rgb){0.8f, 0.8f, 0.8f}, (rgb){0, 0, 0}, 1), LIT_OPEN, &s);
    scene.degrees = degrees;
    ask_estimate *e = mark_run(&scene, runs, mark_seed(8));
    stat_moments square = {0};
    lit l;

    mark_lit(&l, &scene);
    const double truth = rgbd_sum(lit_truth(&l, false));
    for (uint32_t run = 0; run < runs; run++) {
        const double d = rgb_sum(e[run].L) - truth;
        stat_add(&square, d * d);
    }
    mark_mean(&square, variance(&l, &s, truth), MARK_ALPHA, what, why);
    mark_repeats(&scene, e, runs, mark_seed(8));
    bis_light_free(l.light);
    bis_free(e);
}

/* Its bias, of the order 1/M, is allowed 2 %: the mean is tested against the nearest value that is. */
static void the_ratio_estimator_is_right_to_two_percent(void)
{
    enum { RUNS = 3000 };
    const bis_settings s = rejection(BIS_PROPOSAL_EM, 200, 24, BIS_ESTIMATOR_RATIO);
    const ask_scene scene = scene_of(shiny(), LIT_HALF, &s);
    ask_estimate *e = mark_run(&scene, RUNS, mark_seed(3));
    const uint64_t rays = mark_most_rays(e, RUNS);
    uint64_t accepted = 0;
    stat_moments m[4];
    lit l;

    for (int run = 0; run < RUNS; run++) accepted += e[run].accepted;
    if (accepted == 0) mark_wrong("no candidate is accepted at all");
    if (rays > 24) {
        mark_wrong("the ratio estimator: an estimate casts %u shadow rays, must be N = 24 at most", (unsigned)rays);
    }
    mark_lit(&l, &scene);
    mark_moments(m, e, RUNS);
    const double truth = rgbd_sum(lit_truth(&l, true)), allowed = fmin(fmax(m[3].mean, 0.98 * truth), 1.02 * truth);
    mark_mean(&m[3], allowed, MARK_ALPHA, "the ratio estimator, M = 200, N = 24",
              "It may be wrong by 2 %, and no more than chance beyond that.");
    bis_light_free(l.light);
    bis_free(e);
    check_noise(rejection(BIS_PROPOSAL_EM, 16, 2, BIS_ESTIMATOR_RATIO), 40, 20000,
                "the ratio estimator, M = 16, N = 2, in the open: the squared error",
                "It must be that of 16 samples: W/M has all candidates in it. Is this the plain estimator?");
}

static void at_most_N_of_the_accepted_are_traced(void)
{
    enum { RUNS = 2000 };
    const bis_settings s = rejection(BIS_PROPOSAL_EM, 32, 3, BIS_ESTIMATOR_PLAIN);
    const ask_scene scene = scene_of(shiny(), LIT_OPEN, &s);
    ask_estimate *e = mark_run(&scene, RUNS, mark_seed(4));
    uint64_t all = 0;

    for (int run = 0; run < RUNS; run++) {
        const uint64_t A = e[run].accepted, traced = e[run].rays;
        if (traced > 3) mark_wrong("N = 3, but %u rays are traced", (unsigned)traced);
        if (traced != (A < 3 ? A : 3)) {
            mark_wrong("N = 3, %u are accepted, %u rays traced: each accepted one is to be traced once, while there "
                       "are rays", (unsigned)A, (unsigned)traced);
        }
        all += traced;
    }
    if (all == 0) mark_wrong("not a single ray was traced");
    bis_free(e);
}

/* The noise of it is looked at, too; from where, nobody knows before. */
static void work(void)
{
    const bis_settings s = rejection(BIS_PROPOSAL_CHOOSE, (uint32_t)mark_size(64), 4, BIS_ESTIMATOR_PLAIN);

    check_noise(s, (double)mark_size(40), 8000, "the load that is timed, in the open: the squared error",
                "It is that of a binomial number of accepted candidates.");
}

int main(int argc, char **argv)
{
    static const mark_claim claims[] = {
        {"candidates_of_the_map_are_accepted_with_probability_w_over_B", 10,
         candidates_of_the_map_are_accepted_with_probability_w_over_B},
        {"candidates_of_the_brdf_are_accepted_with_probability_w_over_B", 5,
         candidates_of_the_brdf_are_accepted_with_probability_w_over_B},
        {"the_smaller_bound_is_chosen_more_often", 10, the_smaller_bound_is_chosen_more_often},
        {"one_candidate_and_one_ray_are_right", 10, one_candidate_and_one_ray_are_right},
        {"many_rays_are_right", 10, many_rays_are_right},
        {"fewer_rays_than_accepted_are_right", 20, fewer_rays_than_accepted_are_right},
        {"the_ratio_estimator_is_right_to_two_percent", 5, the_ratio_estimator_is_right_to_two_percent},
        {"at_most_N_of_the_accepted_are_traced", 10, at_most_N_of_the_accepted_are_traced},
    };

    return mark_main(argc, argv, claims, sizeof claims / sizeof *claims, work, 3.4);
}
