/* SPDX-License-Identifier: BSD-2-Clause */
/* `bis verify` of a map must be able to fail: each check is handed something wrong and must reject it, and something
 * right, for several seeds, and must accept it. */
#include "tools/verify/verify.h"
#include "bis/base/mem.h"
#include "claim.h"
#include "map_help.h"
#include "verify_help.h"

#include <stdio.h>
#include <string.h>

static void upside_down(bis_envmap *to, const bis_envmap *from)
{
    *to = map_new(from->width, from->height);
    for (int y = 0; y < from->height; y++) {
        memcpy(to->pixels + y * from->width, from->pixels + (from->height - 1 - y) * from->width,
            (size_t)from->width * sizeof *to->pixels);
    }
}

static void right_maps_pass(void **state)
{
    for (uint64_t seed = 0; seed < VERIFY_SEEDS; seed++) {
        bis_envmap em = map_random(64, 32, 6, 0.2, seed);
        for (int k = 0; k < 2; k++) {
            bis_verify v = {.seed = seed, .halvings = 1};
            assert_int_equal(bis_verify_map(&v, &em, 0.15 * k, 8, NULL), BIS_OK);
            assert_int_equal(v.n, 14);
            verify_assert_accepted(&v);
        }
        bis_envmap_clear(&em);
    }
}

static void odd_maps_pass(void **state)
{
    const int sizes[][2] = {{1, 1}, {2, 1}, {1, 5}, {5, 3}};
    for (int i = 0; i < 4; i++) {
        bis_envmap em = map_random(sizes[i][0], sizes[i][1], 3, 0, 7);
        bis_verify v = {.seed = 2};
        assert_int_equal(bis_verify_map(&v, &em, 0.15, 8, NULL), BIS_OK);
        verify_assert_accepted(&v);
        bis_envmap_clear(&em);
    }
    bis_envmap black = map_new(8, 4);
    bis_verify v = {.seed = 2};
    assert_int_equal(bis_verify_map(&v, &black, 0.15, 8, NULL), BIS_OK);
    assert_int_equal(v.n, 3); /* solid angles; nothing to draw */
    assert_string_equal(v.tests[2].name, "alias, cdf, curve");
    assert_string_equal(v.tests[2].note, "the map gives no light, nothing can be drawn from it");
    assert_int_equal(v.tests[2].verdict, BIS_VERDICT_SKIPPED);
    verify_assert_accepted(&v);
    bis_envmap_clear(&black);
}

/* Beside a lamp of 1e10 the pixels of its row have some 1e-13 of the light: a step of a CDF is good to 2^-52 only,
 * which is a thousandth of that, and right. */
static void a_lamp_beside_darkness_passes(void **state)
{
    bis_envmap em = map_random(64, 32, 1, 0, 6);
    em.pixels[11 * 64 + 20] = (rgb){1e10f, 1e10f, 1e10f};
    bis_verify v = {.seed = 3, .halvings = 2};
    assert_int_equal(bis_verify_map(&v, &em, 0, 8, NULL), BIS_OK);
    assert_int_equal(v.n, 14);
    verify_assert_accepted(&v);
    bis_envmap_clear(&em);
}

static void wrong_solid_angles_are_rejected(void **state)
{
    bis_envmap em = map_new(64, 32);
    for (int y = 0; y < 32; y++)
        em.row_solid_angle[y] = PI / 32 * 2 * PI / 64 * sin(PI * (y + 0.5) / 32); /* at the middle: 0.04 % too much */
    bis_verify v = {.seed = 1};
    bis_verify_solid_angles(&v, &em);
    assert_int_equal(verify_failures(&v), 2);
    bis_envmap_clear(&em);
}

/* What the importance of another map looks like when it is checked against this one. */
static size_t failures_against(const bis_envmap *em, const bis_envmap *forged, bis_table_kind kind)
{
    const bis_importance_options options = {.table = true, .table_kind = kind, .levels = 8};
    bis_importance *im;
    bool is_lit;
    double *pmf = bis_alloc(map_n(em), sizeof *pmf);
    bis_verify v = {.seed = 3};
    assert_int_equal(bis_verify_definition(pmf, &is_lit, em, 0, 8, NULL), BIS_OK);
    assert_int_equal(bis_importance_new(&im, forged, &options, NULL), BIS_OK);
    assert_int_equal(bis_verify_importance(&v, &(bis_verify_drawing){"forged", kind, im}, em, pmf, NULL), BIS_OK);
    bis_importance_free(im);
    bis_free(pmf);
    return verify_failures(&v);
}

static void an_importance_of_another_map_is_rejected(void **state)
{
    bis_envmap em = map_random(64, 32, 4, 0.1, 5), forged;
    assert_int_equal(failures_against(&em, &em, BIS_TABLE_ALIAS), 0);
    assert_int_equal(failures_against(&em, &em, BIS_TABLE_CDF), 0);
    upside_down(&forged, &em);
    assert_true(failures_against(&em, &forged, BIS_TABLE_ALIAS) > 0);
    memcpy(forged.pixels, em.pixels, map_n(&em) * sizeof *em.pixels);
    forged.pixels[1000].g += 1e-6f; /* one pixel, by little */
    assert_true(failures_against(&em, &forged, BIS_TABLE_CDF) > 0);
    for (int y = 0; y < 32; y++) forged.row_solid_angle[y] = 4 * PI / (64 * 32); /* solid angle forgotten, E3 */
    assert_true(failures_against(&em, &forged, BIS_TABLE_ALIAS) > 0);
    bis_envmap_clear(&em);
    bis_envmap_clear(&forged);
}

static const bis_verify_test *test_named(const bis_verify *v, const char *name)
{
    for (size_t i = 0; i < v->n; i++)
        if (strcmp(v->tests[i].name, name) == 0) return &v->tests[i];
    fail_msg("no test \"%s\"", name);
    return NULL;
}

/* What is told of an importance of `em` where the map is said to have rows of these sizes, and to be drawn by `pmf`. */
static void tell_importance(bis_verify *v, const bis_envmap *em, bis_table_kind kind, const double *sizes,
                            const double *pmf)
{
    const bis_importance_options options = {.table = true, .table_kind = kind, .levels = 8};
    bis_envmap said = *em;
    bis_importance *im;
    assert_int_equal(bis_importance_new(&im, em, &options, NULL), BIS_OK);
    said.row_solid_angle = bis_alloc((size_t)em->height, sizeof *sizes);
    memcpy(said.row_solid_angle, sizes, (size_t)em->height * sizeof *sizes);
    *v = (bis_verify){.seed = 1};
    assert_int_equal(bis_verify_importance(v, &(bis_verify_drawing){"t", kind, im}, &said, pmf, NULL), BIS_OK);
    assert_int_equal(bis_verify_judge(v, NULL), BIS_OK);
    bis_free(said.row_solid_angle);
    bis_importance_free(im);
}

/* Maps of 1 to 4 columns and 3 rows. A row that is said to be larger by 1e-5: each of its pixels is drawn by that much
 * too rarely, the density claims that much more than there is, and the integral has that share of the row too much. A
 * pixel whose share is said to be larger by 1e-5, or 0, is found wherever it is; so is a row without any size, in which
 * nothing should be drawn. */
static void an_error_of_any_row_or_pixel_is_told_by_its_size(void **state)
{
    const double e = 1e-5, near = 1e-9;
    for (int width = 1; width <= 4; width++)
        for (int kind = 0; kind < 2; kind++) {
            const bis_table_kind of = kind ? BIS_TABLE_CDF : BIS_TABLE_ALIAS;
            bis_envmap em = map_random(width, 3, 1, 0, (uint64_t)width);
            double pmf[12], sum = 0, sizes[3];
            bis_verify v;
            for (size_t i = 0; i < map_n(&em); i++) sum += pmf[i] = map_intensity(&em, i) * map_solid_angle(&em, i);
            for (size_t i = 0; i < map_n(&em); i++) pmf[i] /= sum;
            for (int y = -1; y < 3; y++) {
                double row = 0;
                memcpy(sizes, em.row_solid_angle, sizeof sizes);
                if (y >= 0) sizes[y] *= 1 + e;
                for (int x = 0; x < width && y >= 0; x++) row += pmf[y * width + x];
                tell_importance(&v, &em, of, sizes, pmf);
                assert_int_equal(v.n, 3);
                const bis_verify_test *defined = test_named(&v, "t: density as defined");
                const bis_verify_test *whole = test_named(&v, "t: density integrates to 1");
                const bis_verify_test *table = test_named(&v, "t: table gives that density");
                assert_near(defined->statistic, y < 0 ? 0 : e, near);
                assert_near(whole->statistic, e * row, near);
                assert_near(table->statistic, y < 0 ? 0 : e / (1 + e), near);
                assert_near(defined->threshold, (width + 3 + 16) * 0x1p-52, 1e-20);
                assert_near(whole->threshold, (width + 3 + 16) * 0x1p-52, 1e-20);
                assert_true(table->threshold == 1e-8);
                assert_int_equal(v.n_failed, y < 0 ? 0 : 3);
                bis_verify_clear(&v);
                if (y < 0) continue;
                sizes[y] = 0;
                tell_importance(&v, &em, of, sizes, pmf);
                assert_true(test_named(&v, "t: table gives that density")->statistic == 1);
                assert_true(test_named(&v, "t: density as defined")->statistic == 1);
                bis_verify_clear(&v);
            }
            for (size_t i = 0; i < map_n(&em); i++) {
                const double right = pmf[i];
                for (int none = 0; none < 2; none++) {
                    pmf[i] = none ? 0 : right * (1 + e);
                    tell_importance(&v, &em, of, em.row_solid_angle, pmf);
                    assert_near(test_named(&v, "t: density as defined")->statistic, none ? 1 : e / (1 + e), near);
                    assert_int_equal(v.n_failed, 1);
                    bis_verify_clear(&v);
                }
                pmf[i] = right;
            }
            bis_envmap_clear(&em);
        }
}

/* An importance asks its map for what a pixel weighs, and its table does not change with the map: a pixel that has
 * become twice as bright is drawn half as often as its density says, whichever it is. */
static void an_error_of_any_pixel_of_a_table_is_told_by_its_size(void **state)
{
    for (int width = 1; width <= 4; width++)
        for (int kind = 0; kind < 2; kind++) {
            const bis_table_kind of = kind ? BIS_TABLE_CDF : BIS_TABLE_ALIAS;
            const bis_importance_options options = {.table = true, .table_kind = of, .levels = 8};
            bis_envmap em = map_random(width, 3, 1, 0, (uint64_t)width);
            bis_importance *im;
            double pmf[12], sum = 0;
            for (size_t i = 0; i < map_n(&em); i++) sum += pmf[i] = map_intensity(&em, i) * map_solid_angle(&em, i);
            for (size_t i = 0; i < map_n(&em); i++) pmf[i] /= sum;
            assert_int_equal(bis_importance_new(&im, &em, &options, NULL), BIS_OK);
            for (size_t i = 0; i < map_n(&em); i++) {
                bis_verify v = {.seed = 1};
                const rgb right = em.pixels[i];
                em.pixels[i] = rgb_scale(right, 2);
                assert_int_equal(bis_verify_importance(&v, &(bis_verify_drawing){"t", of, im}, &em, pmf, NULL), BIS_OK);
                em.pixels[i] = right;
                assert_near(test_named(&v, "t: table gives that density")->statistic, 0.5, 1e-9);
                assert_near(test_named(&v, "t: density as defined")->statistic, 1, 1e-9);
                assert_near(test_named(&v, "t: density integrates to 1")->statistic, pmf[i], 1e-9);
                bis_verify_clear(&v);
            }
            bis_importance_free(im);
            bis_envmap_clear(&em);
        }
}

/* Eight pixels of a row that has 1e-9 of the light: a step of its own CDF is good to 2^-52, one of the column's to
 * 2^-52 of all, which is 1e-7 of the row's. So of an error of 1e-5 most is still told. */
static void in_a_dark_row_an_error_is_told_but_for_the_steps_rounding(void **state)
{
    bis_envmap em = map_new(8, 3);
    double pmf[24], sum = 0, sizes[3];
    bis_verify v;
    for (size_t i = 0; i < 24; i++) em.pixels[i].g = i < 8 ? 2e-9f : 1;
    for (size_t i = 0; i < 24; i++) sum += pmf[i] = map_intensity(&em, i) * map_solid_angle(&em, i);
    for (size_t i = 0; i < 24; i++) pmf[i] /= sum;
    memcpy(sizes, em.row_solid_angle, sizeof sizes);
    sizes[0] *= 1 + 1e-5;
    tell_importance(&v, &em, BIS_TABLE_CDF, sizes, pmf);
    const double told = test_named(&v, "t: table gives that density")->statistic;
    assert_true(told > 8e-6 && told < 1e-5);
    bis_verify_clear(&v);
    bis_envmap_clear(&em);
}

/* Samplers of a map, one right and many wrong. */
typedef struct wrong_sampler {
    const bis_envmap *em;
    const bis_importance *im;
} wrong_sampler;

static bool draw_right(const void *self, bis_rng *rng, bis_map_sample *s)
{
    const wrong_sampler *w = self;
    double u[4];
    for (int i = 0; i < 4; i++) u[i] = bis_rng_double(rng);
    return bis_importance_sample(w->im, u, s);
}

static vec3 in_pixel(const bis_envmap *em, size_t pixel, double u1, double u2)
{
    return bis_envmap_direction(em, (int)(pixel % (size_t)em->width), (int)(pixel / (size_t)em->width), u1, u2);
}

/* Pixels are drawn with given probabilities, and uniformly inside. */
typedef struct by_pmf {
    const bis_envmap *em;
    const double *pmf;
} by_pmf;

static vec3 in_pixel(const bis_envmap *em, size_t pixel, double u1, double u2);

static bool draw_by_pmf(const void *self, bis_rng *rng, bis_map_sample *s)
{
    const by_pmf *d = self;
    double u = bis_rng_double(rng);
    *s = (bis_map_sample){0};
    while (s->pixel + 1 < map_n(d->em) && u >= d->pmf[s->pixel]) u -= d->pmf[s->pixel++];
    const double u1 = bis_rng_double(rng);
    s->w_local = in_pixel(d->em, s->pixel, u1, bis_rng_double(rng));
    return true;
}

/* 65536 draws; a group of pixels has at least 80 / 65536 = 0.00122 of them, so that each of its 16 places expects 5.
 * One group: 15 degrees of freedom; two: 31; a last pixel with less joins its neighbour. */
static void neighbours_share_a_group_until_each_place_expects_five(void **state)
{
    static const struct { int width; double pmf[4]; double groups; } cases[] = {
        {2, {0.001, 0.999}, 1}, {2, {0.0013, 0.9987}, 2}, {2, {0.999, 0.001}, 1}, {3, {0.0007, 0.0007, 0.9986}, 2},
        {3, {0.5, 0.0011, 0.4989}, 2}, {4, {0.25, 0.25, 0.25, 0.25}, 4}, {4, {0.0004, 0.0004, 0.0003, 0.9989}, 1},
        {1, {1}, 1}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        bis_envmap em = map_new(cases[i].width, 1);
        const by_pmf self = {&em, cases[i].pmf};
        const bis_verify_sampler sampler = {"by pmf", draw_by_pmf, &self};
        bis_verify v = {.seed = 4};
        assert_int_equal(bis_verify_draws(&v, &sampler, &em, cases[i].pmf, NULL), BIS_OK);
        assert_int_equal(v.n, 2);
        assert_string_equal(v.tests[1].name, "by pmf: draws in 4 x 4 cells inside pixels");
        if (v.tests[1].dof != 16 * cases[i].groups - 1) fail_msg("case %zu: %g degrees of freedom", i, v.tests[1].dof);
        verify_assert_accepted(&v);
        bis_envmap_clear(&em);
    }
}

/* What stands in front of the word "draws" of a test that has failed at once; 0: of another. */
static double draws_that_fell(const bis_verify_test *t)
{
    double n = 0;
    return sscanf(t->note, "chi-square; %lf draws fell where nothing can be drawn", &n) == 1 ? n : 0;
}

static bool draw_the_same(const void *self, bis_rng *rng, bis_map_sample *s)
{
    *s = *(const bis_map_sample *)self;
    return true;
}

/* Whether a pixel is said to have a direction at the shares u of its longitudes and w of its solid angle. */
static bool lies_in(const bis_envmap *em, int x, int y, double u, double w)
{
    const double t[2] = {cos(PI * y / em->height), cos(PI * (y + 1) / em->height)};
    const double z = t[0] + w * (t[1] - t[0]), side = sqrt(1 - z * z), phi = 2 * PI * (x + u) / em->width;
    const bis_map_sample s = {.pixel = (size_t)(y * em->width + x),
                              .w_local = vec3_from(side * cos(phi), side * sin(phi), z)};
    const bis_verify_sampler sampler = {"same", draw_the_same, &s};
    double *pmf = bis_alloc(map_n(em), sizeof *pmf);
    bis_verify v = {.seed = 1, .halvings = 5};
    pmf[s.pixel] = 1;
    assert_int_equal(bis_verify_draws(&v, &sampler, em, pmf, NULL), BIS_OK);
    const double n = draws_that_fell(&v.tests[0]);
    assert_true(n == 0 || n == 16384);
    bis_verify_clear(&v);
    bis_free(pmf);
    return n == 0;
}

/* A direction of three floats may miss its pixel by 2^-22 of the map's longer side: by 0.7 of that it does not, by 1.4
 * it does, on each of the four edges, wherever the pixel is, also where the longitudes begin anew. */
static void a_draw_lies_in_its_pixel_but_for_its_rounding(void **state)
{
    static const int sizes[][2] = {{64, 32}, {16, 64}};
    for (int k = 0; k < 2; k++) {
        const int W = sizes[k][0], H = sizes[k][1], columns[] = {0, 5, W / 2 - 1, W / 2, W - 1};
        bis_envmap em = map_new(W, H);
        for (int i = 0; i < 5; i++)
            for (int y = H / 4; y < H; y += H / 4) {
                const int x = columns[i];
                for (int off = 0; off < 2; off++) {
                    const double m = (off ? 1.4 : 0.7) * 0x1p-22 * 64;
                    if (lies_in(&em, x, y, -m, 0.4) == off || lies_in(&em, x, y, 1 + m, 0.4) == off ||
                        lies_in(&em, x, y, 0.3, -m) == off || lies_in(&em, x, y, 0.3, 1 + m) == off)
                        fail_msg("%d x %d, pixel (%d, %d), off by %g", W, H, x, y, m);
                }
                assert_true(lies_in(&em, x, y, 0.5, 0.5) && !lies_in(&em, x, y, 0.5 + W / 2, 0.5));
            }
        bis_envmap_clear(&em);
    }
}

static bool draw_next_column(const void *self, bis_rng *rng, bis_map_sample *s)
{
    const bis_envmap *em = ((const wrong_sampler *)self)->em;
    const bool drawn = draw_right(self, rng, s);
    if (bis_rng_double(rng) < 0.02)
        s->pixel = s->pixel / 64 * 64 + (s->pixel + 1) % 64; /* alias off by one, for one draw in fifty */
    s->w_local = in_pixel(em, s->pixel, bis_rng_double(rng), bis_rng_double(rng));
    return drawn;
}

static bool draw_uniform_in_theta(const void *self, bis_rng *rng, bis_map_sample *s)
{
    const bool drawn = draw_right(self, rng, s);
    const double y = (double)(s->pixel / 64),
                 theta = PI * (y + bis_rng_double(rng)) / 32; /* the sine forgotten inside a pixel */
    const double phi = 2 * PI * ((double)(s->pixel % 64) + bis_rng_double(rng)) / 64;
    s->w_local = vec3_from(sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta));
    return drawn;
}

static bool draw_centre(const void *self, bis_rng *rng, bis_map_sample *s)
{
    const bool drawn = draw_right(self, rng, s);
    s->w_local = in_pixel(((const wrong_sampler *)self)->em, s->pixel, 0.5, 0.5);
    return drawn;
}

static bool draw_elsewhere(const void *self, bis_rng *rng, bis_map_sample *s)
{
    const bool drawn = draw_right(self, rng, s);
    if (bis_rng_double(rng) < 1e-4) s->w_local.z = -s->w_local.z; /* one draw in ten thousand lies elsewhere */
    return drawn;
}

static bool draw_nothing_at_times(const void *self, bis_rng *rng, bis_map_sample *s)
{
    return draw_right(self, rng, s) && bis_rng_double(rng) > 1e-4;
}

static bool draw_with_coarse_numbers(const void *self, bis_rng *rng, bis_map_sample *s)
{
    const wrong_sampler *w = self;
    double u[4];
    for (int i = 0; i < 4; i++) u[i] = floor(bis_rng_double(rng) * 256) / 256;
    return bis_importance_sample(w->im, u, s);
}

static void wrong_samplers_of_a_map_are_rejected(void **state)
{
    const struct {
        const char *name;
        bool (*draw)(const void *, bis_rng *, bis_map_sample *);
        bool right;
    } samplers[] = {{"right", draw_right, true}, {"next column", draw_next_column, false},
        {"uniform in theta", draw_uniform_in_theta, false}, {"centres", draw_centre, false},
        {"elsewhere", draw_elsewhere, false}, {"nothing at times", draw_nothing_at_times, false},
        {"coarse numbers", draw_with_coarse_numbers, false}};
    const bis_importance_options options = {.table = true, .levels = 8, .area_exponent = 0.15};
    bis_envmap em = map_random(64, 32, 4, 0.1, 11);
    double *pmf = bis_alloc(map_n(&em), sizeof *pmf);
    bis_importance *im;
    bool is_lit;
    assert_int_equal(bis_importance_new(&im, &em, &options, NULL), BIS_OK);
    assert_int_equal(bis_verify_definition(pmf, &is_lit, &em, 0.15, 8, NULL), BIS_OK);
    const wrong_sampler self = {&em, im};
    for (size_t i = 0; i < sizeof samplers / sizeof *samplers; i++) {
        for (uint64_t seed = 0; seed < VERIFY_SEEDS; seed++) {
            const bis_verify_sampler sampler = {samplers[i].name, samplers[i].draw, &self};
            bis_verify v = {.seed = seed, .halvings = 1};
            assert_int_equal(bis_verify_draws(&v, &sampler, &em, pmf, NULL), BIS_OK);
            if (samplers[i].right) verify_assert_accepted(&v);
            else if (verify_failures(&v) == 0) fail_msg("%s was accepted, seed %u", samplers[i].name, (unsigned)seed);
        }
    }
    /* the area factor forgotten in the density */
    bis_verify v = {.seed = 1};
    const bis_verify_sampler right = {"weighted", draw_right, &self};
    assert_int_equal(bis_verify_definition(pmf, &is_lit, &em, 0, 8, NULL), BIS_OK);
    assert_int_equal(bis_verify_draws(&v, &right, &em, pmf, NULL), BIS_OK);
    assert_true(verify_failures(&v) > 0);
    bis_importance_free(im);
    bis_free(pmf);
    bis_envmap_clear(&em);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_draw_lies_in_its_pixel_but_for_its_rounding),
        cmocka_unit_test(right_maps_pass),
        cmocka_unit_test(odd_maps_pass),
        cmocka_unit_test(neighbours_share_a_group_until_each_place_expects_five),
        cmocka_unit_test(a_lamp_beside_darkness_passes),
        cmocka_unit_test(wrong_solid_angles_are_rejected),
        cmocka_unit_test(an_importance_of_another_map_is_rejected),
        cmocka_unit_test(an_error_of_any_row_or_pixel_is_told_by_its_size),
        cmocka_unit_test(an_error_of_any_pixel_of_a_table_is_told_by_its_size),
        cmocka_unit_test(in_a_dark_row_an_error_is_told_but_for_the_steps_rounding),
        cmocka_unit_test(wrong_samplers_of_a_map_are_rejected),
    };
    return cmocka_run_group_tests_name("verify_map", tests, NULL, NULL);
}
