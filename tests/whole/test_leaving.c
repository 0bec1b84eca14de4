/* SPDX-License-Identifier: BSD-2-Clause */
/* Leaving a surface: no shadow ray from a flat mesh meets that mesh, whatever its plane, size and turn, with either
 * accelerator, and nothing that rests on it is missed. Expected values are geometry: above a plane nothing of it is in
 * the way; below a lid on it everything is. The twin is the sheared test alone, as it was: it must be caught.
 * Some 10^6 shadow rays; BIS_LONG=1 in the environment: more than 10^7. */
#include "bis/scene/scene.h"
#include "bis/shape/accel.h"
#include "claim.h"
#include "mesh_help.h"
#include "shape/triangle.h"

#include <stdlib.h>
#include <string.h>

enum { RAYS = 1000000 };
#define COUNT(a) (int)(sizeof(a) / sizeof *(a))

static int n_rays(void) { return getenv("BIS_LONG") ? 15 * RAYS : RAYS; }

/* ---- flat meshes ---- */

static const double heights[] = {0, 1e-30, 1e-10, 1, -1e5}, scales[] = {1e-6, 1e-3, 1, 1e3, 1e6};
static const int squares[] = {1, 40};

/* Of squares cut in two, over [-1, 1]^2 times scale, across this axis at this height. uneven: places like x^3, so that
 * small triangles lie beside large ones. */
static bis_mesh flat_mesh(int n, int axis, double height, double scale, bool uneven)
{
    bis_mesh m = new_mesh((size_t)(n + 1) * (size_t)(n + 1), 2 * (size_t)n * (size_t)n);
    uint32_t *index = m.index;

    for (int k = 0; k < (n + 1) * (n + 1); k++) {
        const double u = 2.0 * (k % (n + 1)) / n - 1, v = 2.0 * (k / (n + 1)) / n - 1; /* NOLINT: whole rows */
        float c[3];
        c[axis] = (float)height;
        c[(axis + 1) % 3] = (float)(scale * (uneven ? u * u * u : u));
        c[(axis + 2) % 3] = (float)(scale * (uneven ? v * v * v : v));
        m.p[k] = (vec3){c[0], c[1], c[2]};
    }
    for (int j = 0; j < n; j++) {
        for (int i = 0; i < n; i++) {
            const uint32_t a = (uint32_t)(j * (n + 1) + i), b = a + (uint32_t)n + 1;
            const uint32_t two[6] = {a, a + 1, b, a + 1, b + 1, b};
            memcpy(index, two, sizeof two);
            index += 6;
        }
    }
    return m;
}

/* Accelerators to try: the packed grid, the plain one (8 cells a primitive and more are not packed), Embree. */
enum { BACKENDS = 3 };

static int make_backends(bis_accel *a[BACKENDS], const bis_geometry *g)
{
    const bis_accel_options options[BACKENDS] = {{.kind = BIS_ACCEL_GRID, .n_threads = 1},
                                                 {.kind = BIS_ACCEL_GRID, .density = 64, .n_threads = 1},
                                                 {.kind = BIS_ACCEL_EMBREE, .n_threads = 1}};
    const int n = bis_accel_embree_version() ? 3 : 2;

    for (int i = 0; i < n; i++) assert_int_equal(bis_accel_new(&a[i], g, &options[i], NULL), BIS_OK);
    return n;
}

/* A ray to a random point of the triangles' plane, from a distance of up to 4 times the mesh's size. */
static ray eye_ray(const bis_geometry *g, uint64_t *seed)
{
    const uint32_t *v = g->index + 3 * (size_t)(random_double(seed) * (double)g->n_triangles);
    double u = random_double(seed), w = random_double(seed);
    const double size = length(sub(g->box.hi, g->box.lo));
    const int shape = (int)(random_double(seed) * 4); /* inside; on an edge; near a vertex; near an edge */

    if (u + w > 1) u = 1 - u, w = 1 - w;
    if (shape == 1) w = 0;
    if (shape == 2) u *= 1e-6, w *= 1e-7;
    if (shape == 3) w *= 1e-9;
    const vec3 a = g->p[v[0]], b = g->p[v[1]], c = g->p[v[2]];
    const vec3 at = add(add(mul(a, 1 - u - w), mul(b, u)), mul(c, w));
    const vec3 out = random_direction(seed), o = add(at, mul(out, size * random_between(seed, 1e-3, 4))),
               d = sub(at, o);
    return (ray){o, length(d) > 0 ? normalize(d) : neg(out), INFINITY};
}

/* To the outer side: anywhere, along a coordinate plane, or within 1e-6 of the surface. */
static vec3 outward(const bis_surface *s, int n, uint64_t *seed)
{
    vec3 w = random_direction(seed);
    const int axis = n / 3 % 3;

    if (n % 3 == 1) w = normalize((vec3){axis == 0 ? 0 : w.x, axis == 1 ? 0 : w.y, axis == 2 ? 0 : w.z});
    if (n % 3 == 2) w = normalize(add(w, mul(s->ng, -dot(w, s->ng) * (1 - pow(10, random_between(seed, -6, -1))))));
    return dot(w, s->ng) < 0 ? neg(w) : w;
}

/* ng is rounded to float where the plane is tilted: nearer than this to the plane a direction has no side. A needle's
 * normal is worse known, by its length over its width. */
static const double no_side = 0x1p-21;

typedef struct tally {
    long rays, own, others;
} tally;

/* n shadow rays from the mesh: how many meet the triangle that they left, how many another one? */
static void leave(tally *t, const bis_accel *a, const bis_geometry *g, int n, double least_cosine, uint64_t *seed)
{
    while (n-- > 0) {
        const ray r = eye_ray(g, seed);
        bis_hit hit, again;
        bis_surface s;
        if (!bis_accel_intersect(a, &r, &hit)) continue;
        bis_geometry_surface(g, hit.prim, &r, &s);
        const vec3 w = outward(&s, n, seed);
        if (dot(w, s.ng) <= least_cosine) continue;
        const ray shadow = {bis_surface_offset(&s), w, INFINITY};
        bool many = false;
        const bool met = bis_accel_intersect(a, &shadow, &again), one = bis_accel_occluded(a, &shadow);
        bis_accel_occluded_many(a, &shadow, 1, &many);
        assert_int_equal(one, many);
        t->rays++;
        t->own += met && again.prim == hit.prim;
        t->others += (met && again.prim != hit.prim) || one != met;
    }
}

/* Across an axis a mesh is flat to the bit: no ray from it meets any of it. */
static void no_flat_mesh_across_an_axis_shadows_itself_E37(void **state)
{
    tally t = {0};
    uint64_t seed = 21;
    for (int k = 0; k < 3 * COUNT(heights) * COUNT(scales) * COUNT(squares) * 2; k++) {
        const int axis = k % 3, n = squares[k / 3 % 2];
        const double height = heights[k / 6 % COUNT(heights)], scale = scales[k / 30 % COUNT(scales)];
        bis_mesh m = flat_mesh(n, axis, height, scale, k / 150);
        bis_geometry g = {0};
        bis_accel *a[BACKENDS];
        add_mesh(&g, &m, NULL, 0);
        const int backends = make_backends(a, &g);
        for (int i = 0; i < backends; i++) {
            leave(&t, a[i], &g, n_rays() / (2 * 300 * backends), 0, &seed);
            if (t.own || t.others) {
                fail_msg("%s: axis %d, height %g, scale %g, %d squares: %ld of %ld rays meet their own triangle, %ld "
                         "another",
                    bis_accel_name(a[i]), axis, height, scale, n, t.own, t.rays, t.others);
            }
            bis_accel_free(a[i]);
        }
        bis_geometry_clear(&g);
    }
    print_message("%ld shadow rays\n", t.rays);
    assert_true(t.rays > n_rays() / 4);
}

/* Tilted, or turned by quarter turns that rounding makes inexact: triangles are flat, the mesh is so but for rounding.
 */
static void no_turned_triangle_shadows_itself(void **state)
{
    tally t = {0};
    uint64_t seed = 22;
    for (int k = 0; k < COUNT(heights) * COUNT(scales) * 12; k++) {
        const double height = heights[k % COUNT(heights)], scale = scales[k / 5 % COUNT(scales)];
        const int turn = k / 25;
        if (scale < 1e-2 * fabs(height)) continue; /* floats there do not resolve the mesh */
        bis_mesh m = flat_mesh(squares[turn % 2], turn % 3, height, scale, turn % 4 == 3);
        /* a quarter turn in two eighths, in nine tenths of a right angle and the rest, or any turn */
        const bis_xform about[3] = {bis_xform_rotate(turn < 8 ? 45 : 13, 0, 1, turn % 2),
            bis_xform_rotate(turn < 4 ? 45 : 77, 0, 1, turn % 2), bis_xform_rotate(turn < 8 ? 0 : 31 * turn, 1, 2, 3)};
        const bis_xform two = bis_xform_compose(&about[0], &about[1]), all = bis_xform_compose(&about[2], &two);
        bis_geometry g = {0};
        bis_accel *a[BACKENDS];
        add_mesh(&g, &m, &all, 0);
        const int backends = make_backends(a, &g);
        for (int i = 0; i < backends; i++) {
            leave(&t, a[i], &g, n_rays() / (2 * 300 * backends), no_side, &seed);
            if (t.own) {
                fail_msg("%s: turn %d, height %g, scale %g: %ld of %ld rays meet their own triangle",
                    bis_accel_name(a[i]), turn, height, scale, t.own, t.rays);
            }
            bis_accel_free(a[i]);
        }
        bis_geometry_clear(&g);
    }
    print_message("%ld shadow rays\n", t.rays);
    assert_true(t.rays > n_rays() / 4);
}

/* Triangles of width 1e-1 to 1e-25 of their length, in coordinate planes and tilted. */
static void no_needle_shadows_itself(void **state)
{
    uint64_t seed = 23;
    long own = 0, rays = 0;
    for (int k = 0; k < 1500; k++) {
        const double width = pow(10, -random_between(&seed, 1, k % 2 ? 25 : 4)), along = random_between(&seed, -1, 1);
        const int axis = k / 2 % 3, x = (axis + 1) % 3, y = (axis + 2) % 3;
        bis_geometry g = {0};
        bis_mesh m = new_mesh(3, 1);
        bis_accel *a[BACKENDS];
        float c[3][3] = {{0}};
        c[1][x] = (float)along, c[1][y] = (float)(1 - along);
        c[2][x] = (float)(along / 3 + width), c[2][y] = (float)((1 - along) / 3);
        for (int i = 0; i < 3; i++) m.p[i] = (vec3){c[i][0], c[i][1], c[i][2]}, m.index[i] = (uint32_t)i;
        const bis_xform turn = bis_xform_rotate(k, 3, 1, 2);
        add_mesh(
            &g, &m, k % 2 ? NULL : &turn, 0); /* rounding may take away what area a turned needle has: not below 1e-4 */
        const int backends = make_backends(a, &g);
        for (int i = 0; i < backends; i++) {
            tally t = {0};
            leave(&t, a[i], &g, n_rays() / 20000, no_side / (k % 2 ? 1 : width), &seed);
            own += t.own, rays += t.rays;
            if (t.own) fail_msg("%s: width %g, axis %d, number %d", bis_accel_name(a[i]), width, axis, k);
            bis_accel_free(a[i]);
        }
        bis_geometry_clear(&g);
    }
    print_message("%ld shadow rays\n", rays);
    assert_true(own == 0 && rays > n_rays() / 100);
}

/* The twin: t > 0 by the sheared test alone. */
static void the_sheared_test_alone_meets_its_own_triangle_E37(void **state)
{
    int met = 0, rays = 0;
    uint64_t seed = 24;
    bis_mesh m = flat_mesh(1, 2, 0, 1, false);
    bis_geometry g = {0};
    bis_accel *a[BACKENDS];
    add_mesh(&g, &m, NULL, 0);
    const int backends = make_backends(a, &g);
    for (int n = 0; n < 5000; n++) {
        const ray r = eye_ray(&g, &seed);
        bis_hit hit;
        bis_surface s;
        float v[9];
        double e[3], det, z;
        if (!bis_accel_intersect(a[0], &r, &hit)) continue;
        bis_geometry_surface(&g, hit.prim, &r, &s);
        const vec3 w = outward(&s, 0, &seed);
        const ray shadow = {bis_surface_offset(&s), w, INFINITY};
        const sheared_ray sheared = shear_ray(&shadow);
        for (int i = 0; i < 3; i++) memcpy(v + 3 * i, &g.p[g.index[3 * (size_t)hit.prim + (size_t)i]], 3 * sizeof *v);
        rays++;
        met += shear_test(&sheared, v, e, &det, &z) && z / det > 0;
    }
    for (int i = 0; i < backends; i++) bis_accel_free(a[i]);
    bis_geometry_clear(&g);
    print_message("%d of %d\n", met, rays);
    assert_true(met > rays / 50);
}

/* ---- disks: their plane is exact in object space ---- */

static void no_disk_shadows_itself(void **state)
{
    uint64_t seed = 25;
    tally t = {0};
    for (int k = 0; k < COUNT(heights) * COUNT(scales) * 6; k++) {
        const double height = heights[k % COUNT(heights)], scale = scales[k / 5 % COUNT(scales)];
        const int turn = k / 25;
        bis_xform place = bis_xform_identity();
        /* quarter turns, in up to 60 steps: products of rounded matrices, and their inverses */
        for (int i = 0; i < (turn < 3 ? 1 : 60); i++) {
            const bis_xform step =
                bis_xform_rotate(turn < 3 ? 90 : 91.5 * (turn - 2), turn % 3 == 0, turn % 3 == 1, turn % 3 == 2);
            place = bis_xform_compose(&step, &place);
        }
        const bis_quadric q = {BIS_DISK, scale, height, place, 0};
        bis_geometry g = {0};
        bis_accel *a[BACKENDS];
        assert_int_equal(bis_geometry_add_quadric(&g, &q, NULL), BIS_OK);
        const int backends = make_backends(a, &g);
        for (int i = 0; i < backends; i++) {
            for (int n = 0; n < n_rays() / (20 * 150 * backends); n++) {
                const double u = random_between(&seed, -.7, .7), v = random_between(&seed, -.7, .7);
                const vec3 at = bis_xform_point(&place, vec3_from(scale * u, scale * v, height));
                const vec3 o = add(at, mul(random_direction(&seed), scale)), d = sub(at, o);
                if (length(d) < .5 * scale) continue; /* the disk is smaller than an ulp of its place */
                const ray r = {o, normalize(d), INFINITY};
                bis_hit hit;
                bis_surface s;
                if (!bis_accel_intersect(a[i], &r, &hit)) continue;
                bis_geometry_surface(&g, hit.prim, &r, &s);
                const vec3 w = outward(&s, n, &seed);
                if (dot(w, s.ng) < no_side) continue;
                const ray shadow = {bis_surface_offset(&s), w, INFINITY};
                t.rays++;
                t.own += bis_accel_occluded(a[i], &shadow);
            }
            if (t.own)
                fail_msg("%s: turn %d, height %g, radius %g: %ld of %ld", bis_accel_name(a[i]), turn, height, scale,
                    t.own, t.rays);
            bis_accel_free(a[i]);
        }
        bis_geometry_clear(&g);
    }
    assert_true(t.rays > n_rays() / 100);
}

/* ---- what rests on a floor ---- */

/* A closed box [-h, h]^2 x [z0, z0 + h], with or without its bottom. */
static void add_box(bis_geometry *g, double h, double z0, bool bottom)
{
    static const uint32_t faces[12][3] = {{4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4}, {2, 6, 3}, {3, 6, 7},
                                          {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}, {0, 2, 1}, {1, 2, 3}};
    bis_mesh m = new_mesh(8, bottom ? 12 : 10);

    for (size_t i = 0; i < 8; i++) m.p[i] = vec3_from(i & 1 ? h : -h, i & 2 ? h : -h, z0 + (i & 4 ? h : 0));
    memcpy(m.index, faces, m.n_triangles * sizeof faces[0]);
    add_mesh(g, &m, NULL, 0);
}

/* A floor with a box that stands on it, or hovers by `gap`. The floor's points are made as a renderer does, by a ray
 * from just above them. Below the box nothing of the sky is seen; beside its wall no direction towards the wall is
 * free. On the outer sides every direction is occluded that meets floor or box by geometry. */
static void a_box_on_the_floor_occludes_at_its_contact(void **state)
{
    const double gaps[] = {0, 1e-12, 1e-6, 1e-3}; /* heights of the bottom, in units of the box */
    uint64_t seed = 26;
    long below = 0, beside = 0;
    for (int k = 0; k < COUNT(scales) * COUNT(gaps) * 2; k++) {
        const double scale = scales[k % COUNT(scales)], gap = gaps[k / 5 % COUNT(gaps)], room = 100 * scale;
        bis_geometry g = {0};
        bis_accel *a[BACKENDS];
        bis_mesh floor = flat_mesh(k / 20 ? 40 : 1, 2, 0, room, false);
        add_mesh(&g, &floor, NULL, 0);
        add_box(&g, scale, gap * scale, gap > 0);
        const int backends = make_backends(a, &g);
        for (int n = 0; n < 4000; n++) {
            const double x = random_between(&seed, -1, 1), y = random_between(&seed, -1, 1),
                         out = pow(10, random_between(&seed, -6, 0));
            const bool under = n % 2;
            const vec3 at = under ? vec3_from(.999 * scale * x, .999 * scale * y, 0)
                                  : vec3_from(scale * (1 + out), scale * y * .999, 0);
            const ray r = {
                {at.x, at.y, (float)(gap > 0 && under ? .5 * gap * scale : .5 * scale)}, {0, 0, -1}, INFINITY};
            for (int i = 0; i < backends; i++) {
                bis_hit hit;
                bis_surface s;
                assert_true(bis_accel_intersect(a[i], &r, &hit));
                if (hit.prim >= 2 * (uint32_t)(k / 20 ? 1600 : 1)) continue;
                bis_geometry_surface(&g, hit.prim, &r, &s);
                vec3 w = outward(&s, n / 2, &seed);
                /* below a gap: up through the bottom, not out at the sides, 1e-4 from the border */
                if (under && gap > 0) w = normalize((vec3){w.x * 1e-3f, w.y * 1e-3f, 1});
                if (!under)
                    w = normalize((vec3){-1, 0, (float)(gap + (.9 - gap) * random_double(&seed) * .5 / (1 + out))});
                if (!under && gap > 0 && out < 1e-2) continue; /* such a ray passes below a box that hovers */
                const ray shadow = {bis_surface_offset(&s), w, INFINITY};
                if (!(under ? fabs(x) < .9 && fabs(y) < .9 : gap == 0) || dot(w, s.ng) <= 0) continue;
                if (!bis_accel_occluded(a[i], &shadow)) {
                    fail_msg("%s: light leaks %s a box of %g at a gap of %g: from %g %g %g to %g %g %g",
                        bis_accel_name(a[i]), under ? "below" : "beside", scale, gap, (double)shadow.o.x,
                        (double)shadow.o.y, (double)shadow.o.z, (double)w.x, (double)w.y, (double)w.z);
                }
                *(under ? &below : &beside) += 1;
            }
        }
        for (int i = 0; i < backends; i++) bis_accel_free(a[i]);
        bis_geometry_clear(&g);
    }
    assert_true(below > 50000 && beside > 10000);
}

/* How far a shadow ray starts from p, in ulps (2^-23): the rounding of p is at most 0.9 of p's largest coordinate along
 * ng, that of the start at most 1.7; of a right triangle's diagonal, tilt is at most 1 and sums, with |e||f| = |n|, at
 * most 3 sqrt(3) / 2: 3.6 in all. Below 6 of coordinate and diagonal together. */
static void the_offset_is_at_most_six_ulps(void **state)
{
    uint64_t seed = 27;
    double most = 0;
    for (int k = 0; k < COUNT(heights) * COUNT(scales) * 4; k++) {
        const double height = heights[k % COUNT(heights)], scale = scales[k / 5 % COUNT(scales)];
        if (scale < 1e-2 * fabs(height)) continue;
        const bis_xform turn = bis_xform_rotate(k / 25 * 23, 1, 2, 3);
        bis_mesh m = flat_mesh(40, 2, height, scale, false);
        bis_geometry g = {0};
        bis_accel *a;
        add_mesh(&g, &m, &turn, 0);
        assert_int_equal(bis_accel_new(&a, &g, &(bis_accel_options){BIS_ACCEL_GRID, 0, 1, NULL}, NULL), BIS_OK);
        for (int n = 0; n < 500; n++) {
            const ray r = eye_ray(&g, &seed);
            bis_hit hit;
            bis_surface s;
            if (!bis_accel_intersect(a, &r, &hit)) continue;
            bis_geometry_surface(&g, hit.prim, &r, &s);
            const bis_box b = bis_geometry_bounds(&g, hit.prim);
            const double size = fmax(fabs((double)s.p.x), fmax(fabs((double)s.p.y), fabs((double)s.p.z)));
            most = fmax(most, length(sub(bis_surface_offset(&s), s.p)) / (0x1p-23 * (size + length(sub(b.hi, b.lo)))));
        }
        bis_accel_free(a);
        bis_geometry_clear(&g);
    }
    print_message("%.2f ulps\n", most);
    assert_true(most <= 6);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_flat_mesh_across_an_axis_shadows_itself_E37),
        cmocka_unit_test(no_turned_triangle_shadows_itself),
        cmocka_unit_test(no_needle_shadows_itself),
        cmocka_unit_test(the_sheared_test_alone_meets_its_own_triangle_E37),
        cmocka_unit_test(no_disk_shadows_itself),
        cmocka_unit_test(a_box_on_the_floor_occludes_at_its_contact),
        cmocka_unit_test(the_offset_is_at_most_six_ulps),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
