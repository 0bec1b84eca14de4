/* SPDX-License-Identifier: BSD-2-Clause */
/* The ends of what bis is made for, where no test of a layer comes: contrasts to 1e76, M = 1 to 1e6, the horizon
 * itself, radiances beyond the largest float, rays of any length; with BIS_LONG=1 (make test-long) also the largest map
 * and 10^8 items and cells. The other road: closed forms, quadrature, long double, a grid of one cell. */
#include "claim.h"
#include "lit.h"
#include "map_help.h"
#include "mesh_help.h"

#include "bis/base/mem.h"
#include "bis/render/render.h"
#include "bis/thesis/alias.h"
#include "bis/thesis/cdf.h"
#include "bis/thesis/phong.h"
#include "shape/grid.h"

#include <float.h>
#include <stdlib.h>
#include <sys/stat.h>

#define COUNT(a) ((int)(sizeof(a) / sizeof *(a)))

static const uint64_t SEED = 20;
static const double PERCENTILE = 4.9; /* |z| of 1e-6: some hundred are looked at */
static const double numbers[] = {0, 0x1p-53, 0x1p-24, 0.5, 1 - 0x1p-24, 1 - 0x1p-53};

static bool is_long(void)
{
    const char *wish = getenv("BIS_LONG");
    return wish && strcmp(wish, "1") == 0;
}

static double relative_error(double a, double b) { return a == b ? 0 : fabs(a - b) / fabs(b); }

/* ---- estimators ---- */

/* All integrators and proposals that are unbiased, but `exact`, which is nobody's extreme. */
static const struct method {
    const char *name;
    const bis_integrator *integrator;
    bis_proposal proposal;
    bool stratify;
} methods[] = {
    {"em", &bis_em, BIS_PROPOSAL_EM, false},
    {"brdf", &bis_brdf, BIS_PROPOSAL_EM, false},
    {"mis balance", &bis_mis, BIS_PROPOSAL_EM, false},
    {"mis power", &bis_mis, BIS_PROPOSAL_EM, true},
    {"rejection em", &bis_rejection, BIS_PROPOSAL_EM, false},
    {"rejection brdf", &bis_rejection, BIS_PROPOSAL_BRDF, false},
    {"rejection choose", &bis_rejection, BIS_PROPOSAL_CHOOSE, false},
    {"sir em", &bis_sir, BIS_PROPOSAL_EM, true},
    {"sir brdf", &bis_sir, BIS_PROPOSAL_BRDF, true},
    {"sir mix", &bis_sir, BIS_PROPOSAL_MIX, true},
    {"sir mix, independent", &bis_sir, BIS_PROPOSAL_MIX, false},
    {"unoccluded", &bis_unoccluded, BIS_PROPOSAL_MIX, true},
};

static bis_settings settings_of(int i, uint32_t M, uint32_t N)
{
    bis_settings s = bis_settings_default(methods[i].integrator);
    s.proposal = methods[i].proposal;
    s.stratify = methods[i].stratify;
    s.heuristic = i == 3 ? BIS_HEURISTIC_POWER : BIS_HEURISTIC_BALANCE;
    s.candidates = M;
    s.shadowrays = N;
    s.samples = N < 2 ? 2 : N;
    return s;
}

/* Estimates, of which each is 0 or more, and finite unless `overflows`. How many were infinite. */
static int run(stat_moments *green, lit *l, const bis_settings *s, uint32_t runs, bool overflows)
{
    bis_scratch scratch;
    int n_infinite = 0;
    *green = (stat_moments){0};
    assert_int_equal(bis_scratch_init(&scratch, s, NULL), BIS_OK);
    for (uint32_t i = 0; i < runs; i++) {
        const rgb L = lit_once(l, s, &scratch, SEED, i);
        n_infinite += !rgb_is_finite(L);
        if (!(L.r >= 0 && L.g >= 0 && L.b >= 0) || (n_infinite > 0 && !overflows))
            fail_msg("%s, run %u: %g %g %g", s->integrator->name, i, (double)L.r, (double)L.g, (double)L.b);
        stat_add(green, (double)L.g);
    }
    bis_scratch_clear(&scratch);
    return n_infinite;
}

/* Rounding alone, 1e-6, is no error. */
static void assert_mean(lit *l, int i, uint32_t M, uint32_t N, uint32_t runs, double truth)
{
    const bis_settings s = settings_of(i, M, N);
    stat_moments m;
    run(&m, l, &s, runs, false);
    const double error = fmax(0, fabs(m.mean - truth) - 1e-6 * truth), deviation = sqrt(stat_variance(&m) / runs);
    if (error > PERCENTILE * deviation)
        fail_msg("%s, M %u, N %u: mean %g, truth %g, deviation %g", methods[i].name, M, N, m.mean, truth, deviation);
}

/* Reflected by a diffuse surface facing +z, of the green channel: Kd/pi sum Le pi/W (cos^2 t_j - cos^2 t_{j+1}) over
 * the upper rows, cut at the horizon. */
static double diffuse_truth(const bis_envmap *em, double Kd)
{
    const long double pi = acosl(-1);
    long double sum = 0;
    for (size_t i = 0; i < map_n(em); i++) {
        const size_t y = i / (size_t)em->width;
        const long double c0 = cosl(pi * (long double)y / em->height),
                          c1 = fmaxl(0, cosl(pi * (long double)(y + 1) / em->height));
        if (c0 > 0) sum += (long double)em->pixels[i].g * (c0 - c1) * (c0 + c1);
    }
    return (double)((long double)Kd / em->width * sum);
}

static void means_are_right_for_contrasts_of_1_to_1e76(void **state)
{
    static const double decades[] = {0, 3, 6, 12, 76};
    const bis_light_desc desc = {
        .L = {1, 1, 1}, .scale = 1, .area_exponent = 0.15, .levels = 8, .to_world = bis_xform_identity()};
    for (int k = 0; k < COUNT(decades); k++) {
        bis_envmap em = map_random(8, 4, decades[k], k % 2 ? 0.3 : 0, (uint64_t)k + 1);
        const double truth = diffuse_truth(&em, 0.5);
        bis_light *light;
        lit l;
        assert_int_equal(bis_light_from_envmap(&light, &em, &desc, BIS_NEED_TABLE | BIS_NEED_CURVE, NULL), BIS_OK);
        lit_init(&l, light, bis_phong(grey(0.5), grey(0), 0), (vec3){0, 0, 1}, 30, LIT_OPEN);
        for (int i = 0; i < COUNT(methods); i++) assert_mean(&l, i, 16, 4, 4000, truth);
        bis_light_free(light);
    }
}

/* From the fifth on, methods have M candidates. */
static void means_are_right_for_any_M_and_N(void **state)
{
    static const uint32_t counts[][3] = {{1, 1, 20000}, {1, 15, 20000}, {2, 1000, 1000}, {8, 9, 4000}, {800, 1, 400}};
    bis_light *light = lit_new_light(LIT_SMOOTH, 1, 0.15, false);
    lit half, open;
    lit_init(&half, light, bis_phong(grey(0.4), grey(0.6), 10), normalize((vec3){1, 2, 2}), 40, LIT_HALF);
    lit_init(&open, light, bis_phong(grey(0.4), grey(0.6), 10), normalize((vec3){1, 2, 2}), 40, LIT_OPEN);
    const rgbd unshadowed = lit_truth(&open, false);
    const double truth = lit_truth(&half, true).g, whole = unshadowed.g, all = rgbd_sum(unshadowed);
    for (int i = 4; i < COUNT(methods); i++) {
        for (int k = 0; k < COUNT(counts); k++)
            assert_mean(&half, i, counts[k][0], counts[k][1], counts[k][2],
                        methods[i].integrator == &bis_unoccluded ? whole : truth);
        const bis_settings many = settings_of(i, 1000000, 15);
        bis_scratch scratch;
        assert_int_equal(bis_scratch_init(&scratch, &many, NULL), BIS_OK);
        const double once = rgb_sum(lit_once(&open, &many, &scratch, SEED, (uint64_t)i));
        if (!(relative_error(once, all) <= 5e-3)) fail_msg("%s, M 1e6: %g, truth %g", methods[i].name, once, all);
        bis_scratch_clear(&scratch);
    }
    bis_light_free(light);
}

/* wo so near the horizon that its cosine, or the mirrored one, rounds to nothing; diffuse, glossy and mirror-like. */
static void views_at_the_very_horizon_are_survived(void **state)
{
    static const float cosines[] = {1e-3f, 1.7e-5f, 1e-7f, 1e-12f, 1e-30f, 1e-38f, 1e-45f, 0, -1e-45f, -1e-3f};
    const vec3 normals[] = {{0, 0, 1}, {0, 0, -1}, {1, 0, 0}, normalize((vec3){1, -2, 0.5f})};
    bis_light *lights[] = {lit_new_light(LIT_SPOTTY, 1, 0.15, false), lit_new_light(LIT_CONSTANT, 1, 0, false)};
    for (int k = 0; k < COUNT(cosines) * 3 * 4 * 2; k++) {
        const double kd = (const double[]){1, 0.5, 0}[k / COUNT(cosines) % 3], n = kd > 0 ? 10 : 1e8;
        const vec3 normal = normals[k / COUNT(cosines) / 3 % 4];
        const frame about = frame_about(normal);
        lit l;
        lit_init(&l, lights[k / COUNT(cosines) / 12], bis_phong(grey(kd), grey(1 - kd), n), normal, 0, LIT_HALF);
        l.pt.wo = to_world(&about, vec3_from(0.6, 0.8, (double)cosines[k % COUNT(cosines)]));
        bis_bsdf_init(&l.pt.bsdf, &l.material, normal, l.pt.wo);
        for (int i = 0; i < COUNT(methods); i++) {
            const bis_settings s = settings_of(i, 8, 4);
            stat_moments m;
            run(&m, &l, &s, 20, false);
        }
    }
    for (int i = 0; i < 2; i++) bis_light_free(lights[i]);
}

/* Beyond FLT_MAX an estimate is +infinity: the film counts it, leaves it out, and stays finite. Never a NaN, never a
 * wrong finite number. */
static void estimates_beyond_the_largest_float_are_infinite_and_counted(void **state)
{
    static const char path[] = "build/envelope_overflow.txt";
    static const char text[] =
        "LookAt 0 0 5  0 0 0  0 1 0\nCamera \"perspective\" \"float fov\" 20\n"
        "Film \"image\" \"integer xresolution\" 8 \"integer yresolution\" 8\n"
        "Sampler \"random\" \"integer pixelsamples\" 4\nIntegrator \"em\" \"integer samples\" 1\nWorldBegin\n"
        "LightSource \"infinite\" \"rgb L\" [3.4e38 3.4e38 3.4e38]\nMaterial \"matte\" \"rgb Kd\" [1 1 1]\n"
        "Shape \"disk\" \"float radius\" 100\n";
    const double crop[4] = {0, 1, 0, 1};
    const bis_render_options options = {.budget = {.spp = 4}, .n_threads = 1};
    bis_light *light = lit_new_light(LIT_CONSTANT, (double)FLT_MAX, 0, false);
    bis_scene_desc *desc;
    bis_scene *scene;
    bis_render_result result;
    bis_film picture;
    float pixels[8 * 8 * 4];
    int n_infinite = 0;
    lit l;

    lit_init(&l, light, bis_phong(grey(1), grey(0), 0), (vec3){0, 0, 1}, 10, LIT_OPEN);
    for (int i = 0; i < COUNT(methods); i++) {
        const bis_settings s = settings_of(i, 1, 1);
        stat_moments m;
        n_infinite += run(&m, &l, &s, 200, true);
    }
    assert_true(n_infinite > 0);
    bis_light_free(light);

    mkdir("build", 0777);
    FILE *f = fopen(path, "w");
    assert_true(f && fputs(text, f) >= 0 && fclose(f) == 0);
    assert_int_equal(bis_scene_parse(&desc, path, NULL), BIS_OK);
    assert_int_equal(bis_scene_build(&scene, desc, NULL), BIS_OK);
    assert_int_equal(bis_film_init(&picture, 8, 8, crop, (bis_loc){0}, NULL), BIS_OK);
    assert_int_equal(bis_render(&result, &picture, scene, &desc->view, &options, NULL), BIS_OK);
    bis_film_resolve(&picture, pixels);
    for (int i = 0; i < 8 * 8 * 4; i++) assert_true(isfinite(pixels[i]) && pixels[i] >= 0);
    assert_in_range(result.counters.nonfinite, 1, 255);
    bis_film_clear(&picture);
    bis_scene_free(scene);
    bis_scene_desc_free(desc);
    remove(path);
}

/* ---- maps and tables ---- */

/* (2 pi/W)(cos t_j - cos t_{j+1}) as a product. */
static long double solid_angle(const bis_envmap *em, int y)
{
    const long double pi = acosl(-1), half = pi / 2 / em->height;
    return 2 * pi / em->width * 2 * sinl((2 * y + 1) * half) * sinl(half);
}

static bis_importance *new_importance(const bis_envmap *em, bis_table_kind kind)
{
    const bis_importance_options options = {
        .table = true, .curve = true, .table_kind = kind, .area_exponent = 0.15, .levels = 8};
    bis_importance *im;
    assert_int_equal(bis_importance_new(&im, em, &options, NULL), BIS_OK);
    return im;
}

static void the_largest_map_is_as_right_as_the_smallest(void **state)
{
    enum { W = 16384, H = 8192 };
    static const size_t at[] = {0, W - 1, (size_t)H / 2 * W, (size_t)H / 2 * W + W - 1, (size_t)(H - 1) * W,
                                (size_t)W * H - 1, 12345678};
    if (!is_long()) skip();
    bis_envmap em = map_random(W, H, 12, 0.1, 1);
    for (int y = 0; y < H; y++)
        assert_true(relative_error(em.row_solid_angle[y], (double)solid_angle(&em, y)) <= 1e-15);

    bis_importance *im = new_importance(&em, BIS_TABLE_ALIAS);
    double *pmf = bis_alloc(map_n(&em), sizeof *pmf);
    long double sum = 0;
    assert_non_null(pmf);
    assert_int_equal(bis_importance_implied_pmf(im, pmf, NULL), BIS_OK);
    for (size_t i = 0; i < map_n(&em); i++) {
        const double P = bis_importance_pdf_pixel(im, i) * map_solid_angle(&em, i);
        sum += (long double)P;
        if (i % 1009 == 0 && P > 0 && !(relative_error(pmf[i], P) <= 1e-8)) fail_msg("pixel %zu", i);
    }
    assert_true(fabsl(sum - 1) <= 1e-11L);
    bis_free(pmf);
    bis_importance_free(im);

    for (int i = 0; i < COUNT(at); i++) { /* one lit texel at each pole, on the seam, anywhere */
        memset(em.pixels, 0, map_n(&em) * sizeof *em.pixels);
        em.pixels[at[i]] = (rgb){1, 1, 1};
        im = new_importance(&em, i % 2 ? BIS_TABLE_CDF : BIS_TABLE_ALIAS);
        for (int k = 0; k < 216; k++) {
            const double u[4] = {numbers[k % 6], numbers[k / 6 % 6], numbers[k / 36], 0.5};
            bis_map_sample s, t;
            assert_true(bis_importance_sample(im, u, &s) && s.pixel == at[i]);
            assert_true(bis_importance_sample_curve(im, u[0], u + 1, &t) && t.pixel == at[i]);
        }
        bis_importance_free(im);
    }
    bis_envmap_clear(&em);
}

/* Weights spread over 12 powers of ten. */
static void a_hundred_million_items_are_as_right_as_one(void **state)
{
    const size_t n = 100000000;
    if (!is_long()) skip();
    double *w = bis_alloc(n, sizeof *w), *implied = bis_alloc(n, sizeof *implied);
    long double sum = 0;
    bis_alias a;
    bis_cdf c;
    assert_true(w && implied);
    for (size_t i = 0; i < n; i++) {
        w[i] = pow(10, 12 * (double)(bis_hash(i) >> 40) * 0x1p-24);
        sum += (long double)w[i];
    }
    assert_int_equal(bis_alias_init(&a, w, n, NULL), BIS_OK);
    bis_alias_implied_pmf(&a, implied);
    for (size_t i = 0; i < n; i++)
        if (!(relative_error(implied[i], (double)((long double)w[i] / sum)) <= 1e-8)) fail_msg("alias, item %zu", i);
    for (int i = 0; i < COUNT(numbers); i++) assert_true(bis_alias_sample(&a, numbers[i]) < n);
    bis_alias_clear(&a);
    bis_free(implied);
    assert_int_equal(bis_cdf_init(&c, w, n, NULL), BIS_OK);
    for (size_t i = 0; i < n; i++)
        if (!(fabs(bis_cdf_pmf(&c, i) - (double)((long double)w[i] / sum)) <= 0x1p-51)) fail_msg("cdf, item %zu", i);
    for (size_t i = 0; i < 1000000 + COUNT(numbers); i++) {
        const double u = i < 1000000 ? c.c[i * 99] : numbers[i - 1000000];
        const size_t item = bis_cdf_sample(&c, u, NULL);
        assert_true(item < n && c.c[item] <= u && u < c.c[item + 1]);
    }
    bis_cdf_clear(&c);
    bis_free(w);
}

/* ---- geometry ---- */

/* Origins 1e-30 to 1.3e8 away, components down to the least float; Embree's range is narrower. */
static void rays_of_any_length_and_origin_meet_a_wall(void **state)
{
    static const float lengths[] = {1e-30f, 1e-10f, 1, 1e10f, 1e30f}, distances[] = {1e-30f, 1e-6f, 1, 1e6f, 1.3e8f};
    bis_mesh m = new_mesh(4, 2);
    bis_geometry g = {0};
    bis_accel *a;
    for (int i = 0; i < 4; i++) m.p[i] = (vec3){i % 2 ? 1 : -1, i / 2 ? 1 : -1, 0};
    memcpy(m.index, (uint32_t[]){0, 1, 2, 1, 3, 2}, 6 * sizeof *m.index);
    add_mesh(&g, &m, NULL, 0);
    assert_int_equal(bis_grid_new(&a, &g, 0, 1, NULL), BIS_OK);
    for (int k = 0; k < COUNT(lengths) * COUNT(distances) * 4; k++) {
        const float size = lengths[k % COUNT(lengths)], away = distances[k / COUNT(lengths) % COUNT(distances)],
                    small = k / 25 % 2 ? 1e-45f : -1e-45f;
        const ray r = {{0.3f, -0.7f, k / 50 ? away : -away}, {small, -small, k / 50 ? -size : size}, INFINITY};
        const double expected = (double)away / (double)size;
        bis_hit hit = {-1, 0};
        if (expected > (double)FLT_MAX || expected < (double)FLT_MIN) continue; /* no float t */
        if (!bis_accel_intersect(a, &r, &hit) || !bis_accel_occluded(a, &r) ||
            relative_error((double)hit.t, expected) > 2e-7)
            fail_msg("length %g, distance %g: %g", (double)size, (double)away, (double)hit.t);
    }
    bis_accel_free(a);
    bis_geometry_clear(&g);
}

/* Rays through all of a closed mesh, and from inside to vertices and edges. */
static void a_hundred_million_cells_are_built_and_walked(void **state)
{
    if (!is_long()) skip();
    bis_mesh m = sphere_mesh(23);
    bis_geometry g = {0};
    bis_accel *many, *one;
    uint64_t seed = 7;
    add_mesh(&g, &m, NULL, 0);
    assert_int_equal(bis_grid_new(&many, &g, 1e8 / (double)g.n_triangles, 1, NULL), BIS_OK);
    assert_int_equal(bis_grid_new(&one, &g, 1e-9, 1, NULL), BIS_OK);
    assert_true(((const bis_grid *)many)->n_cells > 50000000);
    for (size_t n = 0; n < 20000; n++) {
        const uint32_t *v = g.index + 3 * (n * 7919 % g.n_triangles);
        const vec3 o = mul(random_direction(&seed), n % 2 ? 0.3 : 3),
                   target = n % 3 ? mul(add(g.p[v[0]], g.p[v[1]]), 0.5) : g.p[v[0]];
        const ray r = {o, normalize(sub(target, o)), INFINITY};
        bis_hit a = {0, BIS_NO_PRIM}, b = {0, BIS_NO_PRIM};
        const bool found = bis_accel_intersect(many, &r, &a);
        assert_true(found == bis_accel_intersect(one, &r, &b) && a.t == b.t && found == bis_accel_occluded(many, &r));
    }
    bis_accel_free(many);
    bis_accel_free(one);
    bis_geometry_clear(&g);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(means_are_right_for_contrasts_of_1_to_1e76),
        cmocka_unit_test(means_are_right_for_any_M_and_N),
        cmocka_unit_test(views_at_the_very_horizon_are_survived),
        cmocka_unit_test(estimates_beyond_the_largest_float_are_infinite_and_counted),
        cmocka_unit_test(the_largest_map_is_as_right_as_the_smallest),
        cmocka_unit_test(a_hundred_million_items_are_as_right_as_one),
        cmocka_unit_test(rays_of_any_length_and_origin_meet_a_wall),
        cmocka_unit_test(a_hundred_million_cells_are_built_and_walked),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
