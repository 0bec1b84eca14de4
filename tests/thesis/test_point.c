/* point: many shadow rays at once see what they see one by one, on both backends, among triangles and quadrics; and
 * they are counted. */
#include "mesh_help.h"

#include "bis/shape/accel.h"
#include "bis/base/mem.h"
#include "bis/thesis/point.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

enum { MOST = 200 };
static const uint32_t counts[] = {0, 1, 15, 16, 17, 63, 64, 65, 128, 129, MOST};
enum { N_COUNTS = sizeof counts / sizeof *counts };

typedef enum content { TRIANGLES, QUADRICS, BOTH, N_CONTENTS } content;

static void make_scene(bis_geometry *g, content what)
{
    uint64_t seed = 11;

    *g = (bis_geometry){0};
    if (what != QUADRICS) {
        bis_mesh m = soup_mesh(300, 0.15, 7);
        add_mesh(g, &m, NULL, 0);
    }
    for (int i = 0; what != TRIANGLES && i < 30; i++) {
        const bis_xform move = bis_xform_translate(random_double(&seed), random_double(&seed), random_double(&seed));
        const bis_quadric q = {i % 3 ? BIS_SPHERE : BIS_DISK, random_between(&seed, 0.03, 0.12), 0, move, 0};
        assert_int_equal(bis_geometry_add_quadric(g, &q, NULL), BIS_OK);
    }
}

/* The k-th backend, NULL when there is none. */
static bis_accel *backend(const bis_geometry *g, int k)
{
    const bis_accel_options options = {k ? BIS_ACCEL_EMBREE : BIS_ACCEL_GRID, 0, 1, NULL};
    bis_accel *a = NULL;

    if (k && !bis_accel_embree_version()) return NULL;
    assert_int_equal(bis_accel_new(&a, g, &options, NULL), BIS_OK);
    return a;
}

static void many_rays_are_occluded_as_one_by_one(void **state)
{
    (void)state;
    for (int what = 0; what < N_CONTENTS; what++) {
        bis_geometry g;
        make_scene(&g, (content)what);
        for (int k = 0; k < 2; k++) {
            bis_accel *a = backend(&g, k);
            uint32_t hidden = 0, all = 0;
            uint64_t seed = 3;
            for (int c = 0; a && c < 30 * N_COUNTS; c++) {
                const uint32_t n = counts[c % N_COUNTS];
                const vec3 o = {(float)random_double(&seed), (float)random_double(&seed), (float)random_double(&seed)};
                vec3 d[MOST];
                bool occluded[MOST + 1];
                for (uint32_t i = 0; i < n; i++) d[i] = random_direction(&seed);
                if (n > 5) d[3] = (vec3){0, 0, 1}, d[4] = (vec3){-0.0f, -1, 0}, d[5] = d[2];
                memset(occluded, 2, sizeof occluded);
                bis_accel_occluded_many(a, o, d, n, occluded);
                for (uint32_t i = 0; i < n; i++) {
                    const ray r = {o, d[i], INFINITY};
                    assert_int_equal(occluded[i], bis_accel_occluded(a, &r));
                    hidden += occluded[i];
                }
                all += n;
                unsigned char beyond;
                memcpy(&beyond, &occluded[n], 1);
                assert_int_equal(beyond, 2); /* not a bool's value: left alone */
            }
            if (a) assert_true(hidden > all / 20 && hidden < all - all / 20);
            bis_accel_free(a);
        }
        bis_geometry_clear(&g);
    }
}

static void in_an_empty_scene_nothing_is_occluded(void **state)
{
    const vec3 d[2] = {{0, 0, 1}, {1, 0, 0}};
    bool occluded[2] = {true, true};

    (void)state;
    bis_accel_occluded_many(NULL, (vec3){0, 0, 0}, d, 2, occluded);
    assert_true(!occluded[0] && !occluded[1]);
}

static void many_directions_are_seen_and_counted_as_one_by_one_and_never_below_the_surface(void **state)
{
    bis_geometry g;

    (void)state;
    make_scene(&g, BOTH);
    for (int k = 0; k < 2; k++) {
        bis_accel *a = backend(&g, k);
        uint64_t seed = 9;
        for (int c = 0; a && c < 10 * N_COUNTS; c++) {
            const uint32_t n = counts[c % N_COUNTS];
            bis_counters many = {0}, single = {0};
            const bis_point pt = {.ng = random_direction(&seed), .origin = {0.5f, 0.4f, 0.6f}, .accel = a, .counters = &many};
            bis_point one = pt;
            bool sees[MOST];
            vec3 wi[MOST];
            one.counters = &single;
            for (uint32_t i = 0; i < n; i++) {
                wi[i] = random_direction(&seed);
                if (c % 5 == 1) wi[i] = dot(wi[i], pt.ng) > 0 ? neg(wi[i]) : wi[i]; /* all below */
                if (c % 5 == 2) wi[i] = dot(wi[i], pt.ng) < 0 ? neg(wi[i]) : wi[i]; /* all above */
            }
            bis_point_sees_many(&pt, wi, n, sees);
            for (uint32_t i = 0; i < n; i++) assert_int_equal(sees[i], bis_point_sees(&one, wi[i]));
            assert_int_equal(many.shadow_rays, single.shadow_rays);
            if (c % 5 == 1) assert_int_equal(many.shadow_rays, 0);
            if (c % 5 == 2) assert_int_equal(many.shadow_rays, n);
        }
        bis_accel_free(a);
    }
    bis_geometry_clear(&g);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(many_rays_are_occluded_as_one_by_one),
        cmocka_unit_test(in_an_empty_scene_nothing_is_occluded),
        cmocka_unit_test(many_directions_are_seen_and_counted_as_one_by_one_and_never_below_the_surface),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
