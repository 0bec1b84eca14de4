/* SPDX-License-Identifier: BSD-2-Clause */
/* Assignment mis: src/thesis/mis.c. Each estimate is replayed (replay.h), because either technique alone, and an
 * integral with noise, too, has the right mean.
 *
 * All estimates are made by the same two functions, so one slip in one of them would fail all claims but the last. It
 * counts once, in the first claim: where that one fails, the others look only at estimates to which one technique
 * brings nothing, and ask for what the other brings (check_parts). Where one sample of each technique is drawn half in
 * shadow, every fourth estimate is of that kind. */
#include "replay.h"

#include "thesis/mis.h"

static const char *const hint = "Each sample is worth F/(n_i q_i) times its weight. The weights contain the counts "
    "n_i, and at every direction the two sum to 1.";
static const char *const drawn_by = "em.c and brdf.c";

typedef struct mis_case {
    const char *what;
    bool is_glossy;
    lit_map map;
    lit_hidden hidden;
    bis_heuristic heuristic;
    uint32_t samples;
    double split;
    double recorded[REPLAY_KIT]; /* r + g + b of the kit's first estimates */
} mis_case;

static ask_scene scene_of(const mis_case *c)
{
    const bis_material diffuse = bis_phong((rgb){0.8f, 0.5f, 0.2f}, (rgb){0, 0, 0}, 1),
        glossy = bis_phong((rgb){0.2f, 0.2f, 0.2f}, (rgb){0.5f, 0.4f, 0.3f}, 10);
    bis_settings s = bis_settings_default(&bis_mis);

    s.samples = c->samples;
    s.split = c->split;
    s.heuristic = c->heuristic;
    return mark_scene(c->map, c->is_glossy ? glossy : diffuse, c->hidden, ASK_MIS, &s);
}

/* of: what the samples of each technique bring with a weight of 1: em and brdf, which are given, draw the same ones. */
typedef struct played {
    replay r;
    ask_estimate of[2][REPLAY_RUNS];
} played;

static void ask(played *p, const mis_case *c, uint32_t runs)
{
    replay *r = &p->r;
    const ask_scene scene = scene_of(c);
    const uint32_t n_em = bis_mis_samples_em(&scene.settings);

    replay_ask(r, &scene, &bis_mis, runs, c->recorded);
    replay_by(p->of[0], r, &bis_em, n_em);
    replay_by(p->of[1], r, &bis_brdf, c->samples - n_em);
    for (uint32_t k = 0; k < r->n; k++) {
        const ask_estimate *em = &p->of[0][k], *brdf = &p->of[1][k];
        lit_rays *first = &r->must[k].first;
        *first = em->first;
        for (uint32_t j = 0; j < brdf->first.n && first->n < LIT_RAYS; j++) first->to[first->n++] = brdf->first.to[j];
        r->must[k].rays = em->rays + brdf->rays;
    }
    r->knows_rays = true;
}

/* Where both weights are 1/2, the mean is right already. */
static rgb halves(const played *p, uint32_t k)
{
    const rgb em = p->of[0][k].L, brdf = p->of[1][k].L;

    return rgb_scale((rgb){em.r + brdf.r, em.g + brdf.g, em.b + brdf.b}, 0.5);
}

static bool are_halves(const played *p)
{
    for (uint32_t k = 0; k < p->r.n; k++) {
        if (!replay_is_near(&p->r, k, halves(p, k))) return false;
    }
    return true;
}

static bool holds(const mis_case *c)
{
    static played p;

    ask(&p, c, REPLAY_RUNS);
    return replay_first_wrong(&p.r) == p.r.n || are_halves(&p);
}

/* Is each technique right where the other one brings nothing? Its weights are those of the heuristic, or all 1/2. */
static void alone(bool right[2], const mis_case *c)
{
    static played p;

    ask(&p, c, REPLAY_RUNS);
    for (int t = 0; t < 2; t++) {
        uint32_t n = 0, asked = 0, half = 0;
        for (uint32_t k = 0; k < p.r.n; k++) {
            if (rgb_sum(p.of[t][k].L) <= 0 || rgb_sum(p.of[1 - t][k].L) > 0) continue;
            n++;
            asked += replay_is_near(&p.r, k, p.r.must[k].L);
            half += replay_is_near(&p.r, k, halves(&p, k));
        }
        right[t] = n > 0 && (asked == n || half == n);
    }
}

/* ---- the cases, the first of a claim half in shadow and with few samples ---- */

static const mis_case in_the_open[] = {
    {"a diffuse surface in the open, 2 samples", false, LIT_SMOOTH, LIT_OPEN, BIS_HEURISTIC_BALANCE, 2, 0.5,
     {1.75754, 1.34863, 1.7041, 2.53336, 1.42231, 3.06981, 0.964079, 0.398302, 1.76538, 2.05684, 2.93516, 1.56181}},
    {"a diffuse surface in the open, 16 samples", false, LIT_SMOOTH, LIT_OPEN, BIS_HEURISTIC_BALANCE, 16, 0.5,
     {1.71939, 1.27281, 1.50002, 1.77368, 1.77564, 1.44852, 1.78494, 2.03848, 1.51806, 1.77941, 1.84909, 1.49029}},
};
static const mis_case half_in_shadow[] = {
    {"a glossy surface half in shadow, 2 samples", true, LIT_SMOOTH, LIT_HALF, BIS_HEURISTIC_BALANCE, 2, 0.5,
     {1.71206, 1.42542, 1.42647, 1.93732, 1.30748, 1.99786, 1.23052, 0, 1.59587, 1.24219, 1.67999, 2.07593}},
    {"a glossy surface under spots of light, 16 samples", true, LIT_SPOTTY, LIT_HALF, BIS_HEURISTIC_BALANCE, 16, 0.5,
     {194.551, 142.242, 167.127, 197.963, 175.725, 194.51, 198.862, 167.108, 192.79, 111.94, 147.844, 168.823}},
};
static const mis_case uneven[] = {
    {"1 sample of the map, 2 of the BRDF", false, LIT_SMOOTH, LIT_HALF, BIS_HEURISTIC_BALANCE, 3, 0.3,
     {0, 1.75767, 0, 1.55641, 1.08341, 1.70391, 0.912868, 0.905527, 0.810038, 2.13193, 1.14723, 0}},
    {"2 samples of the map, 8 of the BRDF", true, LIT_SMOOTH, LIT_OPEN, BIS_HEURISTIC_BALANCE, 10, 0.2,
     {1.90668, 1.73966, 1.40943, 1.67446, 1.60515, 1.75129, 1.93741, 1.8297, 1.99507, 1.46711, 1.84187, 1.37229}},
    {"8 samples of the map, 2 of the BRDF", true, LIT_SMOOTH, LIT_OPEN, BIS_HEURISTIC_BALANCE, 10, 0.8,
     {1.52998, 1.3337, 1.36123, 1.76052, 1.30426, 0.740348, 2.21589, 1.6134, 1.50775, 1.34906, 1.42847, 1.57505}},
};
static const mis_case power[] = {
    {"power heuristic, 2 samples", false, LIT_SMOOTH, LIT_HALF, BIS_HEURISTIC_POWER, 2, 0.5,
     {2.07718, 1.52449, 2.01292, 2.39052, 1.70586, 0.544466, 1.1036, 0, 2.08334, 0.93818, 1.8224, 1.8543}},
    {"power heuristic, 16 samples", true, LIT_SPOTTY, LIT_OPEN, BIS_HEURISTIC_POWER, 16, 0.5,
     {196.166, 143.468, 168.212, 199.45, 177.787, 196.173, 201.557, 166.66, 192.425, 112.947, 149.851, 169.359}},
};
static const mis_case constant_light[] = {
    {"a constant light, 2 samples", true, LIT_CONSTANT, LIT_HALF, BIS_HEURISTIC_BALANCE, 2, 0.5,
     {0.826246, 0.607972, 0.760972, 1.29197, 0.582705, 0.692333, 0.640589, 0, 0.806268, 1.62991, 0.762449,
     0.935612}},
    {"one lit window, 16 samples", false, LIT_ONE_BLOCK, LIT_OPEN, BIS_HEURISTIC_BALANCE, 16, 0.5,
     {0.112002, 0.11457, 0.12306, 0.117026, 0.11705, 0.114064, 0.116162, 0.112307, 0.112139, 0.127902, 0.114567,
     0.111871}},
};
static const mis_case balance_weights[] = {
    {"balance, 1 sample of the map and 2 of the BRDF", true, LIT_SMOOTH, LIT_HALF, BIS_HEURISTIC_BALANCE, 3, 0.3,
     {1.51034, 1.52986, 0.845878, 1.88759, 0.826387, 1.62893, 1.00734, 1.04556, 1.25178, 1.62651, 1.09554,
     0.918821}},
    {"balance, 2 samples of the map and 18 of the BRDF", true, LIT_SMOOTH, LIT_OPEN, BIS_HEURISTIC_BALANCE, 20, 0.1,
     {1.81338, 1.65428, 1.68889, 1.99463, 1.81179, 1.71088, 1.74165, 1.72529, 1.92598, 1.65408, 1.62426, 1.90587}},
};
static const mis_case power_weights[] = {
    {"power, 1 sample of the map and 2 of the BRDF", true, LIT_SMOOTH, LIT_HALF, BIS_HEURISTIC_POWER, 3, 0.3,
     {1.6293, 1.67621, 0.899336, 1.56716, 0.855028, 0.695285, 1.04548, 1.10633, 1.43103, 1.50534, 1.15472,
     0.950723}},
    {"power, 4 samples of the map and 16 of the BRDF", false, LIT_SMOOTH, LIT_OPEN, BIS_HEURISTIC_POWER, 20, 0.2,
     {1.85286, 2.0457, 1.81493, 2.0219, 1.62716, 1.83321, 1.93297, 1.94199, 1.91277, 1.64628, 1.84094, 2.06119}},
};
static const mis_case timed = { /* half in shadow: it pays for no ray left out */
    "the load that is timed", true, LIT_SMOOTH, LIT_HALF, BIS_HEURISTIC_BALANCE, 16, 0.5,
    {1.58764, 1.38744, 1.14638, 1.69164, 1.49163, 1.26333, 1.46309, 1.53543, 1.69385, 1.41315, 1.72035, 1.16075}
};

/* For the claims after the first one, where that one fails: what is right of the two there must be right here, too. */
static void check_parts(const mis_case *here)
{
    static const char *const techniques[] = {"map", "BRDF"};
    static played p;
    bool right[2], right_here[2];

    alone(right, &half_in_shadow[0]);
    alone(right_here, here);
    for (int t = 0; t < 2; t++) {
        if (right[t] && !right_here[t]) {
            mark_wrong("%s: where the other technique brings nothing, the samples of the %s do not bring their weight "
                       "times F V/(n q). (Mend a_diffuse_surface_in_the_open_is_right first.)", here->what,
                       techniques[t]);
        }
    }
    if (right[0] || right[1]) return;
    ask(&p, here, REPLAY_RUNS);
    replay_check(&p.r, here->what, drawn_by, "(Mend a_diffuse_surface_in_the_open_is_right first.)");
    mark_wrong("%s: it is right, and a_diffuse_surface_in_the_open is not: mend that one first", here->what);
}

/* any: weights of 1/2 will do. */
static void check(const mis_case *c, bool any)
{
    static played p;

    ask(&p, c, REPLAY_RUNS);
    if (replay_first_wrong(&p.r) < p.r.n && are_halves(&p)) {
        if (any) return;
        mark_wrong("%s: both of your weights are 1/2. Any that sum to 1 leave the mean right; these are noisier than "
                   "those of the heuristic", c->what);
    }
    replay_check(&p.r, c->what, drawn_by, hint);
}

static void check_all(const mis_case *c, int n, bool any)
{
    if (c != in_the_open && !(holds(&in_the_open[0]) && holds(&in_the_open[1]))) {
        check_parts(&c[0]);
        return;
    }
    for (int i = 0; i < n; i++) check(&c[i], any);
}
#define CHECK(cases, any) check_all(cases, sizeof cases / sizeof *cases, any)

static void a_diffuse_surface_in_the_open_is_right(void) { CHECK(in_the_open, true); }
static void a_glossy_surface_half_in_shadow_is_right(void) { CHECK(half_in_shadow, true); }
static void uneven_counts_are_right(void) { CHECK(uneven, true); }
static void the_power_heuristic_is_right(void) { CHECK(power, true); }
static void a_constant_light_is_right(void) { CHECK(constant_light, true); }
static void the_weights_are_those_of_the_balance_heuristic(void) { CHECK(balance_weights, false); }
static void the_weights_are_those_of_the_power_heuristic(void) { CHECK(power_weights, false); }

static void each_sample_casts_one_ray_at_most(void)
{
    const mis_case *cases[] = {&in_the_open[1], &constant_light[1]};
    static played p;

    for (int i = 0; i < 2; i++) {
        uint64_t all = 0, all_right = 0;
        ask(&p, cases[i], REPLAY_RUNS);
        for (uint32_t k = 0; k < p.r.n; k++) {
            const uint64_t mine = p.r.mine[k].rays, must = p.r.must[k].rays;
            all += mine;
            all_right += must;
            if (mine <= must) continue;
            mark_wrong("%s: estimate %u casts %u shadow rays, must cast %u: one for a sample, and none for one from "
                       "where no light comes", cases[i]->what, (unsigned)p.r.run[k], (unsigned)mine, (unsigned)must);
        }
        if (i == 0 && 2 * all < all_right) mark_wrong("%s: do both techniques trace their samples?", cases[i]->what);
    }
}

/* Some of its estimates are looked at, too; which, nobody knows before. */
static void work(void)
{
    static played p;

    ask(&p, &timed, 10000);
    replay_check(&p.r, timed.what, drawn_by, hint);
}

int main(int argc, char **argv)
{
    static const mark_claim claims[] = {
        {"a_diffuse_surface_in_the_open_is_right", 25, a_diffuse_surface_in_the_open_is_right},
        {"a_glossy_surface_half_in_shadow_is_right", 10, a_glossy_surface_half_in_shadow_is_right},
        {"uneven_counts_are_right", 5, uneven_counts_are_right},
        {"the_power_heuristic_is_right", 10, the_power_heuristic_is_right},
        {"a_constant_light_is_right", 5, a_constant_light_is_right},
        {"the_weights_are_those_of_the_balance_heuristic", 10, the_weights_are_those_of_the_balance_heuristic},
        {"the_weights_are_those_of_the_power_heuristic", 10, the_weights_are_those_of_the_power_heuristic},
        {"each_sample_casts_one_ray_at_most", 5, each_sample_casts_one_ray_at_most},
    };

    return mark_main(argc, argv, claims, sizeof claims / sizeof *claims, work, 3.4);
}
