/* SPDX-License-Identifier: BSD-2-Clause */
/* point: many rays at once answer what they answer one by one, on both backends, among triangles and quadrics; the
 * terms of an estimate are added or noted, and rays are counted. */
#include "claim.h"
#include "mesh_help.h"

#include "bis/shape/accel.h"
#include "bis/base/mem.h"
#include "bis/thesis/point.h"
#include "files/ply.h"

#include <stdlib.h>
#include <string.h>

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

/* What many rays at once answer, and what they answer one by one. Returns how many rays were hidden. */
static uint32_t same_as_one_by_one(const bis_accel *a, const ray *r, uint32_t n)
{
    bool occluded[MOST + 1];
    uint32_t prim[MOST + 1], hidden = 0;
    bis_hit hit;

    memset(occluded, 2, sizeof occluded);
    prim[n] = 77;
    bis_accel_occluded_many(a, r, n, occluded);
    bis_accel_intersect_many(a, r, n, prim);
    for (uint32_t i = 0; i < n; i++) {
        assert_int_equal(occluded[i], bis_accel_occluded(a, &r[i]));
        assert_int_equal(prim[i], bis_accel_intersect(a, &r[i], &hit) ? hit.prim : BIS_NO_PRIM);
        hidden += occluded[i];
    }
    unsigned char beyond;
    memcpy(&beyond, &occluded[n], 1);
    assert_int_equal(beyond, 2); /* not a bool's value: left alone */
    assert_int_equal(prim[n], 77);
    return hidden;
}

static void many_rays_answer_as_one_by_one(void **state)
{
    for (int what = 0; what < N_CONTENTS; what++) {
        bis_geometry g;
        make_scene(&g, (content)what);
        for (int k = 0; k < 2; k++) {
            bis_accel *a = backend(&g, k);
            uint32_t hidden = 0, all = 0;
            uint64_t seed = 3;
            for (int c = 0; a && c < 60 * N_COUNTS; c++) {
                const uint32_t n = counts[c % N_COUNTS];
                ray r[MOST + 1];
                for (uint32_t i = 0; i <= n; i++) {
                    r[i] =
                        (ray){{(float)random_double(&seed), (float)random_double(&seed), (float)random_double(&seed)},
                            random_direction(&seed), INFINITY};
                    if (c % 3 == 1) r[i].o = r[0].o;                         /* from one point */
                    if (c % 3 == 2) r[i].o = (vec3){2, 2, (float)i / MOST}; /* side by side */
                    if (c % 3 == 2) r[i].d = normalize((vec3){-1, -1, -0.3f});
                    if (i % 7 == 3) r[i].tmax = (float)random_double(&seed); /* with an end */
                }
                if (n > 5) r[3].d = (vec3){0, 0, 1}, r[4].d = (vec3){-0.0f, -1, 0}, r[5] = r[2];
                hidden += same_as_one_by_one(a, r, n);
                all += n;
            }
            if (a) assert_true(hidden > all / 20 && hidden < all - all / 20);
            bis_accel_free(a);
        }
        bis_geometry_clear(&g);
    }
}

/* Four real meshes, the last with spheres among its triangles: packets of neighbouring camera rays, and of shadow rays
 * from where they hit. BIS_LONG=1: 10^6 rays of each kind. */
static void packets_answer_as_single_rays_on_real_meshes(void **state)
{
    static const char *const names[] = {
        "mesh/armadillo_86k.ply", "mesh/igea_269k.ply", "mesh/nefertiti_100k.ply", "mesh/dragon_871k.ply"};
    const int n_packets = getenv("BIS_LONG") ? 250000 / 128 : 100;
    long rays = 0, hidden = 0;

    for (int m = 0; m < 4; m++) {
        const char *path = shared_file(names[m]);
        bis_geometry g = {0};
        bis_mesh mesh;
        uint64_t seed = 5;
        if (!path || !bis_accel_embree_version()) skip();
        assert_int_equal(bis_ply_read(&mesh, path, (bis_loc){0}, NULL), BIS_OK);
        add_mesh(&g, &mesh, NULL, 0);
        const vec3 lo = g.box.lo, hi = g.box.hi;
        const double size = fmax((double)(hi.x - lo.x), fmax((double)(hi.y - lo.y), (double)(hi.z - lo.z)));
        for (int i = 0; m == 3 && i < 20; i++) {
            const bis_xform move = bis_xform_translate(random_between(&seed, (double)lo.x, (double)hi.x),
                random_between(&seed, (double)lo.y, (double)hi.y), random_between(&seed, (double)lo.z, (double)hi.z));
            const bis_quadric q = {BIS_SPHERE, 0.05 * size, 0, move, 0};
            assert_int_equal(bis_geometry_add_quadric(&g, &q, NULL), BIS_OK);
        }
        bis_accel *a = backend(&g, 1);
        const vec3 middle =
            vec3_from(0.5 * (double)(lo.x + hi.x), 0.5 * (double)(lo.y + hi.y), 0.5 * (double)(lo.z + hi.z));
        for (int k = 0; k < n_packets; k++) {
            ray eye[128], shadow[128];
            uint32_t prim[128], n = 0;
            const vec3 side = random_direction(&seed), aim = random_direction(&seed);
            for (int i = 0; i < 128; i++) { /* a bundle of camera rays, a hundredth of the mesh wide */
                const vec3 jitter = random_direction(&seed);
                const vec3 from = vec3_from((double)middle.x + 2 * size * (double)side.x,
                    (double)middle.y + 2 * size * (double)side.y, (double)middle.z + 2 * size * (double)side.z);
                const vec3 to = vec3_from((double)middle.x + size * (0.3 * (double)aim.x + 0.005 * (double)jitter.x),
                    (double)middle.y + size * (0.3 * (double)aim.y + 0.005 * (double)jitter.y),
                    (double)middle.z + size * (0.3 * (double)aim.z + 0.005 * (double)jitter.z));
                eye[i] = (ray){from, normalize((vec3){to.x - from.x, to.y - from.y, to.z - from.z}), INFINITY};
            }
            same_as_one_by_one(a, eye, 128);
            bis_accel_intersect_many(a, eye, 128, prim);
            for (int i = 0; i < 128; i++) {
                bis_surface at;
                if (prim[i] == BIS_NO_PRIM) continue;
                bis_geometry_surface(&g, prim[i], &eye[i], &at);
                vec3 d = random_direction(&seed);
                shadow[n++] = (ray){bis_surface_offset(&at), dot(d, at.ng) > 0 ? d : neg(d), INFINITY};
            }
            hidden += same_as_one_by_one(a, shadow, n);
            rays += n;
        }
        bis_accel_free(a);
        bis_geometry_clear(&g);
    }
    assert_true(rays > 4 * n_packets * 16 && hidden > rays / 50 && hidden < rays - rays / 50);
}

static void in_an_empty_scene_nothing_is_hit(void **state)
{
    const ray r[2] = {{{0, 0, 0}, {0, 0, 1}, INFINITY}, {{0, 0, 0}, {1, 0, 0}, INFINITY}};
    bool occluded[2] = {true, true};
    uint32_t prim[2] = {0, 0};

    bis_accel_occluded_many(NULL, r, 2, occluded);
    bis_accel_intersect_many(NULL, r, 2, prim);
    assert_true(!occluded[0] && !occluded[1] && prim[0] == BIS_NO_PRIM && prim[1] == BIS_NO_PRIM);
}

/* ---- terms of an estimate ---- */

/* Takes what is put off: its last ray, and how many there were. */
typedef struct listener {
    bis_ray_sink ray_sink;
    int n;
    vec3 wi;
    rgbd C;
    uint16_t *seen;
} listener;

static void listen(bis_ray_sink *ray_sink, const bis_point *pt, vec3 wi, const rgbd *C, uint16_t *seen)
{
    listener *l = (listener *)ray_sink;
    assert_ptr_equal(pt->ray_sink, ray_sink);
    *l = (listener){l->ray_sink, l->n + 1, wi, *C, seen};
}

static void terms_are_added_where_light_arrives_and_never_below_the_surface(void **state)
{
    bis_geometry g;

    make_scene(&g, BOTH);
    for (int k = 0; k < 2; k++) {
        bis_accel *a = backend(&g, k);
        uint64_t seed = 9;
        listener l = {.ray_sink = {listen}};
        bis_counters now = {0}, put_off = {0}, single = {0};
        for (int c = 0; a && c < 3000; c++) {
            const bis_point pt = {
                .ng = random_direction(&seed), .origin = {0.5f, 0.4f, 0.6f}, .accel = a, .counters = &now};
            bis_point later = pt, one = pt;
            const vec3 wi = random_direction(&seed);
            const bool above = dot(pt.ng, wi) > 0;
            later.ray_sink = &l.ray_sink, later.counters = &put_off, one.counters = &single;
            rgbd sum = {1, 2, 3}, untouched = {1, 2, 3};
            uint16_t seen = 40, waiting = 40;
            bis_point_add(&sum, &pt, wi, (rgbd){4, 5, 6}, c % 2 ? &seen : NULL);
            const bool V = bis_point_sees(&one, wi);
            assert_true(sum.r == (V ? 5 : 1) && sum.g == (V ? 7 : 2) && sum.b == (V ? 9 : 3));
            assert_int_equal(seen, 40 + (c % 2 && V));
            const int before = l.n;
            bis_point_add(&untouched, &later, wi, (rgbd){4, 5, 6}, &waiting);
            assert_int_equal(l.n, before + above);
            if (above)
                assert_true(l.wi.x == wi.x && l.wi.y == wi.y && l.wi.z == wi.z && l.C.b == 6 && l.seen == &waiting);
            assert_true(untouched.r == 1 && untouched.g == 2 && untouched.b == 3 && waiting == 40);
            assert_true(above || !V);
        }
        assert_true(!a || (single.shadow_rays > 1000 && single.shadow_rays < 2000));
        assert_int_equal(now.shadow_rays, single.shadow_rays);
        assert_int_equal(put_off.shadow_rays, single.shadow_rays);
        bis_accel_free(a);
    }
    bis_geometry_clear(&g);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(many_rays_answer_as_one_by_one),
        cmocka_unit_test(packets_answer_as_single_rays_on_real_meshes),
        cmocka_unit_test(in_an_empty_scene_nothing_is_hit),
        cmocka_unit_test(terms_are_added_where_light_arrives_and_never_below_the_surface),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
