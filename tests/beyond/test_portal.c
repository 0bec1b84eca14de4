/* SPDX-License-Identifier: BSD-2-Clause */
/* Portals: what is drawn through one against quadrature over its area, and the mean of estimates with any portal,
 * right or wrong, against brute force without portals. Family-wise significance 1e-3. */
#include "bis/base/mem.h"
#include "bis/thesis/phong.h"

#include "claim.h"
#include "guided.h"

#define SEED 41u

enum { FITS = 5, CASES = 10, LIGHTS = 3, TESTS = FITS + CASES * LIGHTS * 2 };

static double alpha(void) { return stat_level(1e-3, TESTS); }

/* ---- one portal ---- */

enum { SIDE = 6, STEPS = 60, DRAWS = 40000 };

/* The unit square in z = 0 from points near, far (below 1e-8 sr), oblique and grazing. */
static const vec3 eyes[FITS] = {{0.5f, 0.5f, 1}, {0.3f, 0.2f, 0.05f}, {5, -3, 2}, {30000, 20000, 10000},
                                {2, 0.5f, 0.001f}};
static const bis_portal square = {.edge = {{1, 0, 0}, {0, 1, 0}}};

/* The solid angle of each of SIDE x SIDE pieces, by midpoints: the integral of z/r^3. */
static double quadrature(double piece[SIDE * SIDE], vec3 p)
{
    const int n = SIDE * STEPS;
    double sum = 0;

    for (int i = 0; i < SIDE * SIDE; i++) piece[i] = 0;
    for (int i = 0; i < n * n; i++) {
        const double x = (i % n + 0.5) / n - (double)p.x, y = (i / n + 0.5) / n - (double)p.y, z = (double)p.z;
        const double dA = z / pow(x * x + y * y + z * z, 1.5) / n / n;
        piece[i / n / STEPS * SIDE + i % n / STEPS] += dA;
        sum += dA;
    }
    return sum;
}

static void draw_pieces(double observed[SIDE * SIDE], const bis_portal_view *v, vec3 p)
{
    static float memory[BIS_LANES_ARRAYS * DRAWS], u[2][DRAWS];
    const bis_lanes l = bis_lanes_in(memory, DRAWS);
    bis_rng rng;

    bis_rng_init(&rng, SEED, 0, 0, 0);
    for (int i = 0; i < SIDE * SIDE; i++) observed[i] = 0;
    for (int i = 0; i < 2 * DRAWS; i++) u[i % 2][i / 2] = (float)(bis_rng_u64(&rng) >> 40) * 0x1p-24f;
    bis_portal_sample(&l, v, u[0], u[1], DRAWS);
    for (int i = 0; i < DRAWS; i++) {
        const vec3 wi = {l.x[i], l.y[i], l.z[i]};
        const double t = -(double)p.z / (double)wi.z, x = (double)p.x + t * (double)wi.x,
                     y = (double)p.y + t * (double)wi.y;
        assert_true(wi.z < 0 && fabs(length(wi) - 1) < 1e-6);
        assert_true(x > -1e-2 && x < 1 + 1e-2 && y > -1e-2 && y < 1 + 1e-2); /* far away by a float's rounding */
        const int a = (int)fmin(fmax(x, 0) * SIDE, SIDE - 1), b = (int)fmin(fmax(y, 0) * SIDE, SIDE - 1);
        observed[b * SIDE + a]++;
    }
}

static void directions_through_a_portal_are_even_over_its_solid_angle(void **state)
{
    double expected[SIDE * SIDE], observed[SIDE * SIDE];

    for (int k = 0; k < FITS; k++) {
        bis_portal_view v;
        const double all = quadrature(expected, eyes[k]);
        bis_portal_look(&v, &square, eyes[k]);
        assert_true(v.by_area == (k == 3) && fabs(v.solid_angle - all) < 0.02 * all);
        for (int i = 0; i < SIDE * SIDE; i++) expected[i] *= DRAWS / all;
        draw_pieces(observed, &v, eyes[k]);
        stat_assert_fit("portal", SEED, observed, expected, SIDE * SIDE, alpha());
        if (k != 1) continue;
        v.by_area = true; /* twin */
        draw_pieces(observed, &v, eyes[k]);
        stat_assert_no_fit("portal-by-area", SEED, observed, expected, SIDE * SIDE, alpha());
    }
}

/* Of directions all around: the density is 1 over the solid angle where they pass, and else 0. */
static void the_density_is_that_of_what_passes(void **state)
{
    static float memory[BIS_LANES_ARRAYS * 4096], q[4096];
    static uint32_t place[4096];
    const bis_lanes x = bis_lanes_in(memory, 4096);

    for (int k = 0; k < FITS; k++) {
        bis_portals p = {.n = 1, .share = {0.25}};
        double pieces[SIDE * SIDE];
        const double all = quadrature(pieces, eyes[k]);
        bis_rng rng;
        int passes = 0;
        bis_portal_look(&p.view[0], &square, eyes[k]);
        bis_rng_init(&rng, SEED, 1, 0, 0);
        for (int i = 0; i < 4096; i++) { /* to points of a square of 3 x 3 around it */
            const vec3 to = {(float)(3 * bis_rng_double(&rng) - 1), (float)(3 * bis_rng_double(&rng) - 1), 0};
            const vec3 wi = normalize(sub(to, eyes[k]));
            x.x[i] = wi.x, x.y[i] = wi.y, x.z[i] = wi.z;
            x.r[i] = to.x, x.g[i] = to.y;
        }
        bis_portals_pass(&p, q, place, &x, 4096, BIS_PORTALS_MAX);
        for (int i = 0; i < 4096; i++) {
            const double a = (double)x.r[i], b = (double)x.g[i], edge = k == 3 || k == 4 ? 1e-2 : 1e-4;
            const double out = fmax(fmax(-a, a - 1), fmax(-b, b - 1));
            if (fabs(out) < edge) continue; /* a float may round it to the other side */
            assert_true((q[i] > 0) == (out < 0) && (place[i] < BIS_PORTAL_SQUARES) == (out < 0));
            if (out < 0) assert_true(fabs((double)q[i] * all / 0.25 - 1) < 0.01);
            passes += out < 0;
        }
        assert_true(passes > 300);
    }
}

/* ---- estimates ---- */

static const struct {
    const char *where;
    uint32_t n;
    bis_portal portals[2];
} cases[CASES] = {
    {"open", 1, {{{1, -1, 0.5}, {{0, 1, 0}, {0, 0, 1}}}}},
    {"where half is hidden", 1, {{{-1, -1, 1}, {{2, 0, 0}, {0, 2, 0}}}}},
    {"behind", 1, {{{-1, -1, -1}, {{2, 0, 0}, {0, 2, 0}}}}},
    {"edge-on", 1, {{{1, 1e-7, 0}, {{1, 0, 0}, {0, 0, 1}}}}},
    {"grazing", 1, {{{-1, -2e-3, 0.1}, {{2, 0, 0}, {0, 0, 1}}}}},
    {"huge", 1, {{{-500, -500, 1}, {{1000, 0, 0}, {0, 1000, 0}}}}},
    {"tiny", 1, {{{0.3, -0.4, 1}, {{1e-6, 0, 0}, {0, 1e-6, 0}}}}},
    {"around the point", 1, {{{-1, -1, 0}, {{2, 0, 0}, {0, 2, 0}}}}},
    {"overlapping, one tiny", 2,
     {{{-1, -1, 1}, {{2, 0, 0}, {0, 2, 0}}}, {{0, -0.5, 0.5}, {{1e-6, 0, 0}, {0, 1e-6, 0}}}}},
    {"none", 0, {{{0}, {{0}, {0}}}}},
};

/* Any positive h, any mean, dark or not: the estimate must not depend on what was learned. */
static void open_workspace(workspace *w, const bis_light *light, const bis_settings *s, bool is_dark)
{
    guided_open(w, light, s, true);
    bis_visibility_guess *f = &w->guide.guess;
    f->knows = true;
    f->is_dark = is_dark;
    for (uint32_t k = 0; k < w->c.n_parts; k++) {
        f->own[k] = f->h[k] = k % 3 ? 0.3f : 1;
        f->g[k] = f->control[k] = k % 5 ? 0.3f : 0.9f;
    }
}

/* Twin: portals draw, and q is that of the product alone. */
static bool (*honest_draw)(bis_guide *, bis_set *, uint32_t, const bis_point *, bis_stream *);

static bool forget_portals(bis_guide *g, bis_set *x, uint32_t n, const bis_point *pt, bis_stream *stream)
{
    const bis_product_guide *guide = (const bis_product_guide *)g;
    const bool drawn = honest_draw(g, x, n, pt, stream);
    static float q[256];
    static uint32_t place[256];

    bis_portals_pass(&guide->portals, q, place, &x->own, x->map.n, BIS_PORTALS_MAX);
    for (uint32_t i = 0; i < x->map.n; i++) x->map.x.q[i] -= q[i];
    return drawn;
}

static void run(stat_moments *m, lit *l, const bis_settings *s, bool is_dark, bool forgets)
{
    workspace w;

    *m = (stat_moments){0};
    open_workspace(&w, l->light, s, is_dark);
    if (forgets) honest_draw = w.guide.steps.draw, w.guide.steps.draw = forget_portals;
    for (uint64_t fill = 0; fill < 60; fill++) { /* points of a pass share the clusters' directions */
        double sum = 0;
        bis_clusters_fill(&w.c, l->light, SEED, (uint32_t)fill, 1);
        for (uint64_t k = 0; k < 60; k++) sum += rgb_sum(lit_once(l, s, &w.scratch, SEED, fill * 60 + k)) / 60;
        stat_add(m, sum);
    }
    guided_close(&w);
}

static void any_portal_leaves_the_mean_where_it_is(void **state)
{
    static const lit_map maps[LIGHTS] = {LIT_SPOTTY, LIT_SMOOTH, LIT_CONSTANT};
    bis_settings s = lit_settings(&bis_sir, BIS_PROPOSAL_PRODUCT, 48, 5);
    int found = 0;

    s.learn = true;
    for (int i = 0; i < CASES * LIGHTS * 2; i++) {
        const double exponent = i / CASES / LIGHTS ? 1000 : 10; /* of a narrow lobe the BRDF draws, too */
        bis_light *light = lit_new_light(maps[i / CASES % LIGHTS], 1, 0.15, false);
        stat_moments m;
        lit l;
        bis_light_set_portals(light, cases[i % CASES].portals, cases[i % CASES].n);
        lit_init(&l, light, bis_phong(grey(0.5), grey(0.3), exponent), lit_tilted(), 40, LIT_HALF);
        const double truth = rgbd_sum(lit_truth(&l, true));
        run(&m, &l, &s, i % 2, false);
        if (stat_mean(&m, truth, alpha()).rejected) print_error("%s, light %d\n", cases[i % CASES].where, i / CASES);
        stat_assert_mean("portals", SEED, &m, truth, alpha());
        run(&m, &l, &s, i % 2, true);
        found += stat_mean(&m, truth, alpha()).rejected;
        bis_light_free(light);
    }
    assert_true(found >= 30);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(directions_through_a_portal_are_even_over_its_solid_angle),
        cmocka_unit_test(the_density_is_that_of_what_passes),
        cmocka_unit_test(any_portal_leaves_the_mean_where_it_is),
    };

    return cmocka_run_group_tests_name("portal", tests, NULL, NULL);
}
