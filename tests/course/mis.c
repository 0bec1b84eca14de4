/* SPDX-License-Identifier: BSD-2-Clause */
/* Assignment mis: src/thesis/mis.c. Means against brute force (tests/support/lit.h), variances against those that
 * the definition of the weights gives, by quadrature; rays are counted, since either technique alone has the right
 * mean, too. Statistical tests: 34.
 *
 * All estimates are made by the same two functions, so one slip in one of them would fail all claims but the last. It
 * counts once, in the first claim: where that one fails, the others ask only for the part that the other technique
 * brings (check_other_part). */
#include "mark.h"

#include "bis/base/mem.h"
#include "bis/thesis/envmap.h"

static const char *const hint = "Each sample is worth F/(n_i q_i) times its weight, and at every direction the two "
    "weights sum to 1.";

static bis_material diffuse(void) { return bis_phong((rgb){0.8f, 0.5f, 0.2f}, (rgb){0, 0, 0}, 1); }
static bis_material glossy(void) { return bis_phong((rgb){0.2f, 0.2f, 0.2f}, (rgb){0.5f, 0.4f, 0.3f}, 10); }

static bis_settings mis(uint32_t samples, double split, bis_heuristic heuristic)
{
    bis_settings s = bis_settings_default(&bis_mis);

    s.samples = samples;
    s.split = split;
    s.heuristic = heuristic;
    return s;
}

/* How many samples of an estimate are worth a ray: F is positive there. By quadrature, V left out. */
static double worthy(const lit *l, const double n[2])
{
    enum { W = 256, H = 128 };
    double sum = 0;

    for (int i = 0; i < W * H; i++) {
        const double c0 = cos(PI * (i / W) / H), c1 = cos(PI * ((int)(i / W) + 1) / H), z = (c0 + c1) / 2,
            s = sqrt(1 - z * z);
        const double phi = 2 * PI * (i % W + 0.5) / W, wi[3] = {s * cos(phi), s * sin(phi), z},
            d = (c0 - c1) * 2 * PI / W;
        const vec3 w = vec3_from(wi[0], wi[1], wi[2]);
        double q;
        if (dot(l->pt.n, w) <= 0 || rgbd_sum(lit_f(l, wi, &q)) <= 0 || rgb_is_black(bis_light_Le(l->light, w))) {
            continue;
        }
        sum += (n[0] * bis_light_pdf(l->light, w) + n[1] * q) * d;
    }
    return sum;
}

static ask_scene scene_of(bis_material m, lit_map map, lit_hidden hidden, const bis_settings *s)
{
    return mark_scene(map, m, hidden, ASK_MIS, s);
}

/* The samples of each technique. */
static void counts(double n[2], const bis_settings *s)
{
    n[0] = s->split * s->samples;
    n[1] = (1 - s->split) * s->samples;
}

/* Nine tenths of the rays at least: the quadrature is good to a percent. */
static bool both_work(const ask_estimate *e, const lit *l, const bis_settings *s, uint32_t runs)
{
    double n[2];

    counts(n, s);
    return mark_rays(e, runs) >= 0.9 * worthy(l, n);
}

static void check_both_work(const ask_estimate *e, const lit *l, const bis_settings *s, uint32_t runs, const char *what)
{
    double n[2];

    counts(n, s);
    const double must = worthy(l, n), rays = mark_rays(e, runs);
    if (!both_work(e, l, s, runs)) {
        mark_wrong("%s: %.2f shadow rays in the mean, must be %.2f: of %.0f samples of the map and %.0f of the BRDF, "
                   "so many have light to bring. "
                   "Do both techniques draw theirs?", what, rays, must, n[0], n[1]);
    }
}

static void check_mean(bis_material m, lit_map map, lit_hidden hidden, bis_settings s, const char *what)
{
    enum { RUNS = 12000 };
    const ask_scene scene = scene_of(m, map, hidden, &s);
    ask_estimate *e = mark_run(&scene, RUNS, mark_seed(1));
    lit l;

    mark_lit(&l, &scene);
    mark_estimates(e, &l, RUNS, MARK_ALPHA, what, hint);
    check_both_work(e, &l, &s, RUNS, what);
    bis_light_free(l.light);
    bis_free(e);
}

/* ---- by quadrature ---- */

/* Of each technique: the integral of h F, which its samples bring in the mean, and that of (h F)^2/q. F is r + g + b
 * in the open. */
typedef struct parts {
    double mean[2], square[2];
} parts;

static parts integrate(const lit *l, const double n[2], double power)
{
    enum { W = 256, H = 128 };
    const bis_envmap *em = bis_light_envmap(l->light);
    parts p = {.mean = {0}};

    for (int i = 0; i < W * H; i++) {
        const double c0 = cos(PI * (i / W) / H), c1 = cos(PI * ((int)(i / W) + 1) / H), z = (c0 + c1) / 2,
            s = sqrt(1 - z * z);
        const double phi = 2 * PI * (i % W + 0.5) / W, wi[3] = {s * cos(phi), s * sin(phi), z},
            d = (c0 - c1) * 2 * PI / W;
        const vec3 w = vec3_from(wi[0], wi[1], wi[2]);
        double q[2];
        const rgbd f = lit_f(l, wi, &q[1]);
        const rgb Le = bis_envmap_Le(em, w);
        const double F = (f.r * (double)Le.r + f.g * (double)Le.g + f.b * (double)Le.b) * fmax(0, dot(l->pt.n, w));
        if (F <= 0) continue;
        q[0] = bis_light_pdf(l->light, w);
        const double all = pow(n[0] * q[0], power) + pow(n[1] * q[1], power);
        for (int k = 0; k < 2; k++) {
            const double h = pow(n[k] * q[k], power) / all;
            p.mean[k] += h * F * d;
            p.square[k] += q[k] > 0 ? h * F * h * F / q[k] * d : 0;
        }
    }
    return p;
}

/* ---- one cause, one claim ---- */

static double exponent(bis_heuristic heuristic) { return heuristic == BIS_HEURISTIC_POWER ? 2 : 1; }

/* What each technique brings under one small window in the open. There each sample of the map casts a ray, and few of
 * the BRDF do: estimates with the fewest rays are the map's part, and what the mean of all has beyond them is the
 * BRDF's. */
static void window_parts(bool right[2], bool some[2], bis_material material, const bis_settings *s)
{
    enum { RUNS = 12000 };
    ask_scene scene = scene_of(material, LIT_ONE_BLOCK, LIT_OPEN, s);
    stat_moments all = {0}, least = {0};
    double n[2];
    lit l;

    scene.kind = BIS_SAMPLER_RANDOM; /* the number of rays tells nothing of the map's samples */
    ask_estimate *e = mark_run(&scene, RUNS, mark_seed(4));
    uint64_t fewest = e[0].rays;
    for (int i = 1; i < RUNS; i++) fewest = e[i].rays < fewest ? e[i].rays : fewest;
    for (int i = 0; i < RUNS; i++) {
        stat_add(&all, rgb_sum(e[i].L));
        if (e[i].rays == fewest) stat_add(&least, rgb_sum(e[i].L));
    }
    counts(n, s);
    mark_lit(&l, &scene);
    const parts must = integrate(&l, n, exponent(s->heuristic));
    const double part[2] = {least.mean, all.mean - least.mean}, of_map = stat_variance(&least) / least.n,
        chance[2] = {sqrt(of_map), sqrt(of_map + stat_variance(&all) / all.n)};
    for (int k = 0; k < 2; k++) {
        some[k] = part[k] > 5.2 * chance[k];
        right[k] = fabs(part[k] - must.mean[k]) <= 5.2 * chance[k] + 0.01 * must.mean[k]; /* 0.01: the quadrature */
    }
    bis_light_free(l.light);
    bis_free(e);
}

/* For the claims after the first one, where that one fails. The slip is in one technique, if the other one brings what
 * it must with the balance heuristic; then it must bring that here, too, and that decides. */
static void check_other_part(bis_material material, const bis_settings *here, const char *what)
{
    static const char *const techniques[] = {"map", "BRDF"};
    const bis_settings balance = mis(20, 0.1, BIS_HEURISTIC_BALANCE); /* 2 of the map: a count of 1 hides its lack */
    bool right[2], some[2], right_here[2], some_here[2];

    window_parts(right, some, diffuse(), &balance);
    window_parts(right_here, some_here, material, here);
    for (int k = 0; k < 2; k++) {
        if (!some[k] || !some_here[k]) {
            mark_wrong("%s: under a window, the samples of the %s bring nothing. (Mend "
                       "a_diffuse_surface_in_the_open_is_right first.)", what, techniques[k]);
        }
        if (right[k] && !right_here[k]) {
            mark_wrong("%s: under a window, the samples of the %s do not bring the integral of their weight times F "
                       "V. (Mend a_diffuse_surface_in_the_open_is_right first.)", what, techniques[k]);
        }
    }
    if (!right[0] && !right[1]) {
        mark_wrong("%s: under a window, neither the samples of the map nor those of the BRDF bring the integral of "
                   "their weight times F V. (Mend a_diffuse_surface_in_the_open_is_right first.)", what);
    }
}

/* Does the first claim hold? */
static bool first_is_right(void)
{
    enum { RUNS = 12000 };
    const bis_settings s = mis(8, 0.5, BIS_HEURISTIC_BALANCE);
    const ask_scene scene = scene_of(diffuse(), LIT_SMOOTH, LIT_OPEN, &s);
    ask_estimate *e = mark_run(&scene, RUNS, mark_seed(1));
    stat_moments m[4];
    lit l;

    mark_lit(&l, &scene);
    mark_moments(m, e, RUNS);
    const rgbd truth = lit_truth(&l, true);
    const bool right = both_work(e, &l, &s, RUNS) && !stat_mean(&m[0], truth.r, MARK_ALPHA).rejected &&
                       !stat_mean(&m[1], truth.g, MARK_ALPHA).rejected &&
                       !stat_mean(&m[2], truth.b, MARK_ALPHA).rejected;
    bis_light_free(l.light);
    bis_free(e);
    return right;
}

/* A claim after the first one: is it judged by the other part? */
static bool is_judged_by_part(bis_material material, uint32_t samples, double split, bis_heuristic heuristic,
                              const char *what)
{
    const bis_settings s = mis(samples, split, heuristic);

    if (first_is_right()) return false;
    check_other_part(material, &s, what);
    return true;
}

static void a_diffuse_surface_in_the_open_is_right(void)
{
    check_mean(diffuse(), LIT_SMOOTH, LIT_OPEN, mis(8, 0.5, BIS_HEURISTIC_BALANCE),
               "a diffuse surface, balance heuristic");
}

static void a_glossy_surface_half_in_shadow_is_right(void)
{
    if (is_judged_by_part(glossy(), 20, 0.05, BIS_HEURISTIC_BALANCE, "a glossy surface")) return;
    check_mean(glossy(), LIT_SMOOTH, LIT_HALF, mis(8, 0.5, BIS_HEURISTIC_BALANCE),
               "a glossy surface half in shadow, balance heuristic");
    check_mean(glossy(), LIT_SPOTTY, LIT_HALF, mis(8, 0.5, BIS_HEURISTIC_BALANCE),
               "a glossy surface under spots of light");
}

static void uneven_counts_are_right(void)
{
    if (is_judged_by_part(diffuse(), 20, 0.15, BIS_HEURISTIC_BALANCE, "3 samples of the map, 17 of the BRDF")) return;
    check_mean(glossy(), LIT_SMOOTH, LIT_OPEN, mis(10, 0.2, BIS_HEURISTIC_BALANCE),
               "2 samples of the map, 8 of the BRDF");
    check_mean(glossy(), LIT_SMOOTH, LIT_OPEN, mis(10, 0.8, BIS_HEURISTIC_BALANCE),
               "8 samples of the map, 2 of the BRDF");
    check_mean(diffuse(), LIT_SMOOTH, LIT_HALF, mis(2, 0.5, BIS_HEURISTIC_BALANCE),
               "1 sample of the map, 1 of the BRDF");
}

static void the_power_heuristic_is_right(void)
{
    if (is_judged_by_part(diffuse(), 20, 0.05, BIS_HEURISTIC_POWER, "power heuristic")) return;
    check_mean(glossy(), LIT_SMOOTH, LIT_OPEN, mis(8, 0.5, BIS_HEURISTIC_POWER), "power heuristic");
    check_mean(glossy(), LIT_SPOTTY, LIT_HALF, mis(9, 0.3, BIS_HEURISTIC_POWER),
               "power heuristic, 3 samples of the map, 6 of the BRDF");
}

static void a_constant_light_is_right(void)
{
    if (is_judged_by_part(diffuse(), 10, 0.1, BIS_HEURISTIC_BALANCE, "one lit window")) return;
    check_mean(glossy(), LIT_CONSTANT, LIT_OPEN, mis(8, 0.5, BIS_HEURISTIC_BALANCE), "a constant light");
    check_mean(diffuse(), LIT_ONE_BLOCK, LIT_OPEN, mis(8, 0.5, BIS_HEURISTIC_BALANCE), "one lit window");
}

/* ---- the variance ---- */

/* Of one estimate of r + g + b: sum over the techniques of ((integral of (h F)^2/q) - (integral of h F)^2)/n. */
static double variance(const lit *l, const double n[2], double power)
{
    const parts p = integrate(l, n, power);

    return (p.square[0] - p.mean[0] * p.mean[0]) / n[0] + (p.square[1] - p.mean[1] * p.mean[1]) / n[1];
}

/* degrees: of the eye */
static void check_variance(bis_material material, bis_heuristic heuristic, uint32_t samples, double split,
                           double degrees, uint32_t runs, const char *what)
{
    const bis_settings s = mis(samples, split, heuristic);
    ask_scene scene = scene_of(material, LIT_SMOOTH, LIT_OPEN, &s);
    double n[2];
    stat_moments m[4];
    lit l;

    scene.kind = BIS_SAMPLER_RANDOM;
    scene.degrees = degrees;
    ask_estimate *e = mark_run(&scene, runs, mark_seed(2));
    counts(n, &s);
    mark_lit(&l, &scene);
    mark_moments(m, e, runs);
    const double expected = variance(&l, n, exponent(heuristic));
    /* About the truth, so that a wrong mean is no gain. The kurtosis of an estimate is 2.9 to 3.1 here, so that the
     * variance of n values has a standard error of at most sqrt(2.1/n); MARK_ALPHA is 5.2 of them, 4.4 % where
     * n = 30000. The rest is room for the quadrature. */
    const double off = m[3].mean - rgbd_sum(lit_truth(&l, false));
    const double times = (stat_variance(&m[3]) + off * off) / expected;
    if (!(fabs(times - 1) <= 5.2 * sqrt(2.1 / runs) + 0.036)) {
        mark_wrong("%s: the estimates have %.2f times the squared error (the noise) that the weights of this "
                   "heuristic give. Does the "
                   "weight contain the counts n_i?", what, times);
    }
    mark_repeats(&scene, e, runs, mark_seed(2));
    bis_light_free(l.light);
    bis_free(e);
}

/* Cases in which a mistake has more noise, and not less, as it would have with 18 samples of the map and 2 of the
 * BRDF. Weights without the counts: 8 times and, below, 2.6 times. The balance heuristic for the power heuristic, on
 * the diffuse surface: 1.3 times. */
static void the_noise_is_that_of_the_balance_heuristic(void)
{
    if (is_judged_by_part(diffuse(), 30, 0.1, BIS_HEURISTIC_BALANCE, "balance")) return;
    check_variance(glossy(), BIS_HEURISTIC_BALANCE, 8, 0.5, 40, 30000, "balance, 4 and 4");
    check_variance(glossy(), BIS_HEURISTIC_BALANCE, 20, 0.1, 40, 30000,
                   "balance, 2 samples of the map and 18 of the BRDF");
}

static void the_noise_is_that_of_the_power_heuristic(void)
{
    if (is_judged_by_part(diffuse(), 30, 0.1, BIS_HEURISTIC_POWER, "power")) return;
    check_variance(glossy(), BIS_HEURISTIC_POWER, 8, 0.5, 40, 30000, "power, 4 and 4");
    check_variance(diffuse(), BIS_HEURISTIC_POWER, 20, 0.2, 40, 30000,
                   "power, a diffuse surface, 4 samples of the map and 16 of the BRDF");
}

/* A window that few samples of the BRDF see: the others have no light to bring. The spread of a sum of so many is
 * below 1 %. */
static void samples_without_light_cast_no_ray(void)
{
    enum { RUNS = 5000 };
    const bis_settings s = mis(8, 0.5, BIS_HEURISTIC_BALANCE);
    const ask_scene scene = scene_of(diffuse(), LIT_ONE_BLOCK, LIT_OPEN, &s);
    ask_estimate *e = mark_run(&scene, RUNS, mark_seed(6));
    double n[2];
    lit l;

    mark_lit(&l, &scene);
    counts(n, &s);
    const double rays = mark_rays(e, RUNS), must = worthy(&l, n);
    if (rays > 1.1 * must) {
        mark_wrong("one lit window: %.2f shadow rays in the mean, must be %.2f: a sample from where no light comes "
                   "asks for none", rays, must);
    }
    bis_light_free(l.light);
    bis_free(e);
}

static void each_sample_casts_one_ray_at_most(void)
{
    const bis_settings s = mis(8, 0.5, BIS_HEURISTIC_BALANCE);
    ask_scene scene = scene_of(diffuse(), LIT_SMOOTH, LIT_OPEN, &s);

    scene.n = (vec3){0, 0, 1};
    scene.degrees = 0;
    ask_estimate *e = mark_run(&scene, 1000, mark_seed(3));
    const uint64_t most = mark_most_rays(e, 1000);
    if (most > 8) mark_wrong("8 samples cast %u shadow rays, must be at most 8", (unsigned)most);
    if (most < 4) {
        mark_wrong("8 samples cast at most %u shadow rays; the 4 of the BRDF alone all lie above the horizon, and are "
                   "to be traced", (unsigned)most);
    }
    bis_free(e);
    samples_without_light_cast_no_ray();
}

/* Noise and mean of it are looked at, too; from where, nobody knows before. */
static void work(void)
{
    check_variance(glossy(), BIS_HEURISTIC_BALANCE, (uint32_t)mark_size(16) & ~1u, 0.5, (double)mark_size(40), 10000,
                   "the load that is timed");
}

int main(int argc, char **argv)
{
    static const mark_claim claims[] = {
        {"a_diffuse_surface_in_the_open_is_right", 25, a_diffuse_surface_in_the_open_is_right},
        {"a_glossy_surface_half_in_shadow_is_right", 10, a_glossy_surface_half_in_shadow_is_right},
        {"uneven_counts_are_right", 5, uneven_counts_are_right},
        {"the_power_heuristic_is_right", 10, the_power_heuristic_is_right},
        {"a_constant_light_is_right", 5, a_constant_light_is_right},
        {"the_noise_is_that_of_the_balance_heuristic", 10, the_noise_is_that_of_the_balance_heuristic},
        {"the_noise_is_that_of_the_power_heuristic", 10, the_noise_is_that_of_the_power_heuristic},
        {"each_sample_casts_one_ray_at_most", 5, each_sample_casts_one_ray_at_most},
    };

    return mark_main(argc, argv, claims, sizeof claims / sizeof *claims, work, 3.9);
}
