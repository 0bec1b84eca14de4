/* SPDX-License-Identifier: BSD-2-Clause */
/* Assignment rejection: src/thesis/rejection.c: which bound, who is accepted, what the accepted are worth. Acceptance,
 * and estimates of one candidate, are replayed (replay.h); estimates of more are compared with brute force, and their
 * rays counted (tests/support/lit.h), so that who accepts wrongly loses no points for what comes after. Statistical
 * tests: 14. */
#include "replay.h"

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

/* How many of M are accepted in each estimate: their random numbers decide it. recorded: in the kit's first ones, a
 * digit each. */
static void ask_accepted(replay *r, const bis_settings *s, const char *recorded, const char *what, const char *why)
{
    const ask_scene scene = scene_of(shiny(), LIT_OPEN, s);
    double mine = 0, must = 0;
    uint32_t wrong = 0, first = 0;

    replay_ask(r, &scene, &bis_rejection, REPLAY_RUNS, NULL);
    for (uint32_t k = r->n; k-- > 0;) {
        if (r->knows_sum_only) r->must[k].accepted = (uint64_t)(recorded[k] - '0');
        mine += (double)r->mine[k].accepted / r->n;
        must += (double)r->must[k].accepted / r->n;
        if (r->mine[k].accepted == r->must[k].accepted) continue;
        wrong++;
        first = k;
    }
    if (wrong > r->n / 100) {
        mark_wrong("%s: estimate %u accepts %u of %u candidates, must accept %u by its random numbers; in the mean of "
                   "%u estimates it is %.3g, must be %.3g. %s", what, (unsigned)r->run[first],
                   (unsigned)r->mine[first].accepted, s->candidates, (unsigned)r->must[first].accepted, r->n, mine,
                   must, why);
    }
}

static void check_acceptance(bis_proposal proposal, const char *recorded, const char *what, const char *why)
{
    static replay r;
    const bis_settings s = rejection(proposal, 8, 4, BIS_ESTIMATOR_PLAIN);

    ask_accepted(&r, &s, recorded, what, why);
}

static const char *const accept_hint = "Accept candidate i if bis_stream_random times B is below w_i, which "
    "bis_set_weight has in the unit of B. Each candidate with a weight has a random number of its own.";

static void candidates_of_the_map_are_accepted_with_probability_w_over_B(void)
{
    check_acceptance(BIS_PROPOSAL_EM, "010000101011", "candidates of the map", accept_hint);
}

static void candidates_of_the_brdf_are_accepted_with_probability_w_over_B(void)
{
    check_acceptance(BIS_PROPOSAL_BRDF, "335334553223", "candidates of the BRDF", accept_hint);
}

static void the_smaller_bound_is_chosen_more_often(void)
{
    check_acceptance(BIS_PROPOSAL_CHOOSE, "355121450513", "proposal \"choose\"",
                     "The map if bis_stream_random is below c_brdf/(c_em + c_brdf).");
}

static void check_one(bis_proposal proposal, const double recorded[REPLAY_KIT], const char *what)
{
    static replay r;
    const bis_settings s = rejection(proposal, 1, 1, BIS_ESTIMATOR_PLAIN);
    const ask_scene scene = scene_of(shiny(), LIT_HALF, &s);

    replay_ask(&r, &scene, &bis_rejection, REPLAY_RUNS, recorded);
    replay_check(&r, what, "the candidates", hint);
}

static void one_candidate_and_one_ray_are_right(void)
{
    static const double of_map[REPLAY_KIT] = {[3] = 31.9005, [5] = 31.9005},
        of_brdf[REPLAY_KIT] = {0, 6.38502, 0, 6.38502, 6.38502, 0, 6.38502, 0, 6.38502, 0, 6.38502, 6.38502};

    check_one(BIS_PROPOSAL_EM, of_map, "M = 1, N = 1, from the map");
    check_one(BIS_PROPOSAL_BRDF, of_brdf, "M = 1, N = 1, from the BRDF");
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
}

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

/* Of r + g + b in the open, where it is W/M. */
static void check_noise_of_ratio(uint32_t M, const char *what, const char *why)
{
    enum { RUNS = 20000 };
    const bis_settings s = rejection(BIS_PROPOSAL_EM, M, 2, BIS_ESTIMATOR_RATIO);
    const ask_scene scene = scene_of(bis_phong((rgb){0.8f, 0.8f, 0.8f}, (rgb){0, 0, 0}, 1), LIT_OPEN, &s);
    ask_estimate *e = mark_run(&scene, RUNS, mark_seed(8));
    stat_moments square = {0};
    lit l;

    mark_lit(&l, &scene);
    const double truth = rgbd_sum(lit_truth(&l, false));
    for (uint32_t run = 0; run < RUNS; run++) {
        const double d = rgb_sum(e[run].L) - truth;
        stat_add(&square, d * d);
    }
    mark_mean(&square, lit_variance_em(&l) / M, MARK_ALPHA, what, why);
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
    check_noise_of_ratio(16, "the ratio estimator, M = 16, N = 2, in the open: the squared error",
                         "It must be that of 16 samples: W/M has all candidates in it. Is this the plain estimator?");
}

static void at_most_N_of_the_accepted_are_traced(void)
{
    static replay r;
    const bis_settings s = rejection(BIS_PROPOSAL_EM, 32, 3, BIS_ESTIMATOR_PLAIN);

    ask_accepted(&r, &s, "343423251403", "32 candidates of the map", accept_hint);
    for (uint32_t k = 0; k < r.n; k++) {
        const uint64_t A = r.mine[k].accepted, traced = r.mine[k].rays;
        if (traced != (A < 3 ? A : 3)) {
            mark_wrong("N = 3, %u are accepted, %u rays traced: each accepted one is to be traced once, while there "
                       "are rays", (unsigned)A, (unsigned)traced);
        }
    }
}

/* Some of its estimates are looked at, too; which, nobody knows before. Half in shadow, so that rays count. */
static void work(void)
{
    static const double recorded[REPLAY_KIT] = {
        0.623537, 3.09274, 2.54403, 1.24611, 2.79345, 1.99378, 1.87061, 1.49649, 0.996891, 1.72096, 2.61684, 2.09508};
    static replay r;
    const bis_settings s = rejection(BIS_PROPOSAL_CHOOSE, (uint32_t)mark_size(64), 4, BIS_ESTIMATOR_PLAIN);
    const ask_scene scene = scene_of(shiny(), LIT_HALF, &s);

    replay_ask(&r, &scene, &bis_rejection, 8000, recorded);
    replay_check(&r, "the load that is timed", "the candidates", hint);
}

int main(int argc, char **argv)
{
    static const mark_claim claims[] = {
        {"candidates_of_the_map_are_accepted_with_probability_w_over_B", 10,
         candidates_of_the_map_are_accepted_with_probability_w_over_B},
        {"candidates_of_the_brdf_are_accepted_with_probability_w_over_B", 5,
         candidates_of_the_brdf_are_accepted_with_probability_w_over_B},
        {"the_smaller_bound_is_chosen_more_often", 10, the_smaller_bound_is_chosen_more_often},
        {"one_candidate_and_one_ray_are_right", 15, one_candidate_and_one_ray_are_right},
        {"many_rays_are_right", 10, many_rays_are_right},
        {"fewer_rays_than_accepted_are_right", 15, fewer_rays_than_accepted_are_right},
        {"the_ratio_estimator_is_right_to_two_percent", 5, the_ratio_estimator_is_right_to_two_percent},
        {"at_most_N_of_the_accepted_are_traced", 10, at_most_N_of_the_accepted_are_traced},
    };

    return mark_main(argc, argv, claims, sizeof claims / sizeof *claims, work, 3.0);
}
