/* SPDX-License-Identifier: BSD-2-Clause */
/* accel: both backends against brute force in long double, and against each other, where rays, scenes and scales are at
 * their worst. A difference is allowed only where it is a tie: the ray passes an edge within 4 ulps. */
#include "claim.h"
#include "mesh_help.h"

#include "bis/shape/accel.h"
#include "bis/base/mem.h"
#include "shape/grid_block.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Is a result that differs from brute force's explained? At most so many ulps from an edge. */
enum { TIE_ULPS = 4 };

typedef struct truth {
    bool hit;
    uint32_t prim;
    long double t;
} truth;

static long double determinant(const long double a[3], const long double b[3], const long double c[3])
{
    return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
}

/* By Cramer's rule (Möller and Trumbore), another road than the library's. */
static bool brute_triangle(const bis_geometry *g, uint32_t prim, const ray *r, long double *t)
{
    const long double d[3] = {(long double)r->d.x, (long double)r->d.y, (long double)r->d.z};
    long double v[3][3], e[3], f[3], s[3];
    const float o[3] = {r->o.x, r->o.y, r->o.z};

    for (int i = 0; i < 3; i++) {
        const vec3 p = g->p[g->index[3 * (size_t)prim + (size_t)i]];
        const float flat[3] = {p.x, p.y, p.z};
        for (int a = 0; a < 3; a++) v[i][a] = (long double)flat[a];
    }
    for (int a = 0; a < 3; a++) {
        e[a] = v[1][a] - v[0][a];
        f[a] = v[2][a] - v[0][a];
        s[a] = (long double)o[a] - v[0][a];
    }
    const long double minus_d[3] = {-d[0], -d[1], -d[2]};
    const long double det = determinant(minus_d, e, f);
    if (det == 0) return false;
    const long double b1 = determinant(minus_d, s, f) / det, b2 = determinant(minus_d, e, s) / det;
    *t = determinant(s, e, f) / det;
    return b1 >= 0 && b2 >= 0 && b1 + b2 <= 1 && *t > 0 && *t < (long double)r->tmax;
}

static truth brute_force(const bis_geometry *g, const ray *r)
{
    truth best = {false, BIS_NO_PRIM, (long double)INFINITY};

    for (uint32_t prim = 0; prim < bis_geometry_primitives(g); prim++) {
        long double t;
        float quadric_t;
        if (prim < g->n_triangles) {
            if (!brute_triangle(g, prim, r, &t)) continue;
        } else {
            if (!bis_quadric_intersect(&g->quadrics[prim - g->n_triangles], r, &quadric_t)) continue;
            t = (long double)quadric_t;
        }
        if (t < best.t) best = (truth){true, prim, t};
    }
    return best;
}

/* Equal up to rounding: 4 ulps of a float, or what 4 ulps of a coordinate mean along the ray. */
static bool same_distance(double a, double b, const ray *r)
{
    const double o = fmax(fabs((double)r->o.x), fmax(fabs((double)r->o.y), fabs((double)r->o.z)));

    return fabs(a - b) <= TIE_ULPS * 0x1p-23 * (fmax(fabs(a), fabs(b)) + o / length(r->d));
}

static bool near_an_edge(const bis_geometry *g, uint32_t prim, const ray *r)
{
    return prim < g->n_triangles && is_tie(g, prim, r, TIE_ULPS);
}

/* Both queries of one ray against the truth. Returns 1 for a tie. */
static int check_ray(const bis_accel *a, const ray *r, const truth *expected)
{
    const bis_geometry *g = a->geometry;
    bis_hit hit = {-1, BIS_NO_PRIM};
    const bool found = bis_accel_intersect(a, r, &hit), occluded = bis_accel_occluded(a, r);

    if (found) {
        assert_true(hit.t > 0 && hit.t < r->tmax);
        assert_true(hit.prim < bis_geometry_primitives(g));
    }
    if (found == expected->hit && occluded == expected->hit) {
        if (!found || hit.prim == expected->prim) {
            assert_true(!found || same_distance((double)hit.t, (double)expected->t, r));
            return 0;
        }
        /* Another primitive: a duplicate, a shared edge, two that cross; or one of the two hits is a tie. */
        if (same_distance((double)hit.t, (double)expected->t, r)) return 0;
    }
    if ((found && near_an_edge(g, hit.prim, r)) || (expected->hit && near_an_edge(g, expected->prim, r))) return 1;
    /* A hit at an end of the ray: an origin in the triangle, or t that rounds to tmax. */
    if (found && (same_distance((double)hit.t, 0, r) || same_distance((double)hit.t, (double)r->tmax, r))) return 1;
    if (expected->hit &&
        (same_distance((double)expected->t, 0, r) || same_distance((double)expected->t, (double)r->tmax, r)))
        return 1;
    print_message(
        "%s: found %d prim %u t %.9g, occluded %d; truth %d prim %u t %.9Lg; ray %.9g %.9g %.9g, %.9g %.9g %.9g, %g\n",
        bis_accel_name(a), found, hit.prim, (double)hit.t, occluded, expected->hit, expected->prim, expected->t,
        (double)r->o.x, (double)r->o.y, (double)r->o.z, (double)r->d.x, (double)r->d.y, (double)r->d.z,
        (double)r->tmax);
    fail();
    return 1;
}

/* All backends there are, the grid at three densities. */
typedef struct backends {
    bis_accel *a[5];
    int n;
} backends;

/* Embree multiplies three lengths in float, so it has no part in scenes smaller than 1e-12 or larger than 1e12. */
static backends make_backends(const bis_geometry *g)
{
    static const double densities[] = {0, 1e-9, 30};
    const double size = length(sub(g->box.hi, g->box.lo));
    backends b = {.n = 0};

    for (int i = 0; i < 3; i++) {
        assert_int_equal(
            bis_accel_new(&b.a[b.n++], g, &(bis_accel_options){BIS_ACCEL_GRID, densities[i], 1, NULL}, NULL), BIS_OK);
    }
    if (bis_accel_embree_version() && size > 1e-12 && size < 1e12) {
        assert_int_equal(
            bis_accel_new(&b.a[b.n++], g, &(bis_accel_options){BIS_ACCEL_EMBREE, 0, 1, NULL}, NULL), BIS_OK);
    }
    return b;
}

static void free_backends(backends *b)
{
    while (b->n > 0) bis_accel_free(b->a[--b->n]);
}

/* A ray for the box: from inside, outside, far away, along axes, in walls, with -0, with an end. */
static ray nasty_ray(const bis_geometry *g, uint64_t *seed)
{
    const float lo[3] = {g->box.lo.x, g->box.lo.y, g->box.lo.z}, hi[3] = {g->box.hi.x, g->box.hi.y, g->box.hi.z};
    float o[3], d[3];
    double size = 0;

    for (int a = 0; a < 3; a++) size = fmax(size, (double)hi[a] - (double)lo[a]);
    const double away = random_double(seed) < 0.2 ? 100 : 0.5;
    for (int a = 0; a < 3; a++) {
        const double u = random_double(seed), l = (double)lo[a], h = (double)hi[a];
        o[a] = u < 0.1 ? lo[a] : u < 0.2 ? hi[a] : u < 0.35 ? (float)(l + (h - l) * floor(9 * random_double(seed)) / 8)
                       : (float)random_between(seed, l - away * size, h + away * size);
        d[a] = (float)(random_between(seed, l, h) - (double)o[a]);
    }
    const int kind = (int)(8 * random_double(seed));
    for (int a = 0; a < 3; a++) {
        if (kind == 0)
            d[a] = a == (int)(3 * random_double(seed)) ? 1
                   : random_double(seed) < 0.5         ? 0.0f
                                                       : -0.0f; /* often along an axis */
        if (kind == 1 && a == 1) d[a] = -0.0f;
        if (kind == 2) d[a] = d[a] > 0 ? 1.0f : -1.0f;
        if (kind == 3) d[a] = a == 1 || random_double(seed) < 0.5 ? (float)random_between(seed, -1, 1) : 1e-30f;
    }
    if (d[0] == 0 && d[1] == 0 && d[2] == 0) d[2] = -1;
    vec3 w = {d[0], d[1], d[2]};
    if (length(w) < 1e-3 || length(w) > 1e3) w = normalize(w);
    const double end = random_between(seed, 0, 2) * fmax(size, length(w)) / length(w);
    return (ray){{o[0], o[1], o[2]}, w, random_double(seed) < 0.25 ? (float)end : INFINITY};
}

/* The number of ties. */
static int check_scene(const bis_geometry *g, int n_rays, uint64_t seed)
{
    backends b = make_backends(g);
    int ties = 0, hits = 0;

    for (int n = 0; n < n_rays; n++) {
        const ray r = nasty_ray(g, &seed);
        const truth expected = brute_force(g, &r);
        hits += expected.hit;
        for (int i = 0; i < b.n; i++) ties += check_ray(b.a[i], &r, &expected);
    }
    assert_true(hits > n_rays / 100);
    free_backends(&b);
    return ties;
}

static void random_soups_are_met_as_by_brute_force(void **state)
{
    static const double sizes[] = {0.05, 0.1, 1};
    for (int i = 0; i < 3; i++) {
        bis_geometry g = {0};
        bis_mesh m = soup_mesh(300, sizes[i], (uint64_t)i);
        add_mesh(&g, &m, NULL, 0);
        assert_true(check_scene(&g, 4000, (uint64_t)i) < 10);
        bis_geometry_clear(&g);
    }
}

static void soups_at_every_scale_and_shift_are_met_as_by_brute_force(void **state)
{
    static const double scales[] = {1e-6, 1e6, 1, 1e3, 1e-18, 1e15}, shifts[] = {0, 0, 1e3, 1e6, 0, 0};
    for (int i = 0; i < 6; i++) {
        const bis_xform scale = bis_xform_scale(scales[i], scales[i], scales[i]),
                        move = bis_xform_translate(shifts[i], -shifts[i], shifts[i]);
        const bis_xform t = bis_xform_compose(&move, &scale);
        bis_geometry g = {0};
        bis_mesh m = soup_mesh(200, 0.3, (uint64_t)i + 10);
        add_mesh(&g, &m, &t, 0);
        assert_true(check_scene(&g, 2000, (uint64_t)i) < 40);
        bis_geometry_clear(&g);
    }
}

/* A block of unit cubes: faces in planes of whole numbers, all of them twice, where cell walls may lie, too. */
static bis_mesh block_mesh(int n)
{
    static const uint32_t faces[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                          {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    const size_t cubes = (size_t)(n * n * n);
    bis_mesh m = new_mesh(8 * cubes, 12 * cubes);

    for (size_t c = 0; c < cubes; c++) {
        const size_t at[3] = {c % (size_t)n, c / (size_t)n % (size_t)n, c / (size_t)(n * n)};
        for (size_t i = 0; i < 8; i++) {
            m.p[8 * c + i] = (vec3){(float)(at[0] + (i & 1)), (float)(at[1] + (i >> 1 & 1)), (float)(at[2] + (i >> 2))};
        }
        for (size_t i = 0; i < 36; i++) m.index[36 * c + i] = (uint32_t)(8 * c) + faces[i / 3][i % 3];
    }
    return m;
}

static void walls_axes_corners_and_duplicates_are_met_as_by_brute_force(void **state)
{
    for (int n = 1; n <= 4; n++) {
        bis_geometry g = {0};
        bis_mesh m = block_mesh(n);
        add_mesh(&g, &m, NULL, 0);
        check_scene(&g, 3000, (uint64_t)n);
        bis_geometry_clear(&g);
    }
}

/* From inside a closed mesh every ray meets it: also exactly through vertices and edges. */
static void nothing_escapes_through_edges_and_vertices(void **state)
{
    bis_geometry g = {0};
    bis_mesh m = sphere_mesh(24);
    uint64_t seed = 1;
    size_t lost = 0;
    add_mesh(&g, &m, NULL, 0);
    backends b = make_backends(&g);
    for (size_t t = 0; t < g.n_triangles; t++) {
        for (int k = 0; k < 12; k++) {
            const vec3 u = g.p[g.index[3 * t + (size_t)k % 3]], v = g.p[g.index[3 * t + (size_t)(k + 1) % 3]];
            const vec3 o = k < 6 ? (vec3){0, 0, 0} : mul(random_direction(&seed), 0.9);
            const double w = k % 6 < 3 ? 0 : random_double(&seed);
            const ray r = {o, sub(add(mul(u, 1 - w), mul(v, w)), o), INFINITY};
            for (int i = 0; i < b.n; i++) {
                bis_hit hit;
                const bool found = bis_accel_intersect(b.a[i], &r, &hit);
                assert_int_equal(bis_accel_occluded(b.a[i], &r), found);
                if (found) assert_true(fabs((double)hit.t - 1) < 1e-4);
                if (found) continue;
                /* Embree's robust mode does lose some of the rays aimed at the very vertex; the grid none. */
                assert_string_equal(bis_accel_name(b.a[i]), "embree");
                assert_true(w == 0);
                lost++;
            }
        }
    }
    assert_true(lost < 12 * g.n_triangles / 500);
    free_backends(&b);
    bis_geometry_clear(&g);
}

static void triangles_without_area_are_never_hit(void **state)
{
    uint64_t seed = 2;
    bis_geometry g = {0};
    bis_mesh m = new_mesh(3 * 200 + 3, 201);
    for (size_t i = 0; i < 200; i++) {
        /* on a line, in steps that floats hold exactly: points, doubled corners, three apart */
        const vec3 d = {(float)(int)random_between(&seed, -8, 9), (float)(int)random_between(&seed, -8, 9), 4};
        const vec3 a = {(float)(int)random_between(&seed, -8, 9), (float)(int)random_between(&seed, -8, 9), -2};
        m.p[3 * i] = a;
        m.p[3 * i + 1] = i % 3 == 0 ? a : add(a, d);
        m.p[3 * i + 2] = i % 2 == 0 ? m.p[3 * i + 1] : add(a, mul(d, 0.5));
    }
    m.p[600] = (vec3){-100, -100, 50};
    m.p[601] = (vec3){100, -100, 50};
    m.p[602] = (vec3){0, 100, 50};
    for (uint32_t i = 0; i < 603; i++) m.index[i] = i;
    add_mesh(&g, &m, NULL, 0);
    backends b = make_backends(&g);
    for (int n = 0; n < 20000; n++) {
        const size_t i = (size_t)(200 * random_double(&seed));
        const vec3 target = add(mul(g.p[3 * i], 0.25), mul(g.p[3 * i + 1], 0.75)), o = mul(random_direction(&seed), 20);
        const ray r = {o, sub(target, o), INFINITY};
        const truth expected = brute_force(&g, &r);
        if (expected.hit && expected.prim != 200) continue; /* brute force, too, may see an area by its rounding */
        for (int k = 0; k < b.n; k++) {
            bis_hit hit;
            if (bis_accel_intersect(b.a[k], &r, &hit)) assert_int_equal(hit.prim, 200);
            assert_int_equal(bis_accel_occluded(b.a[k], &r), expected.hit);
        }
    }
    free_backends(&b);
    bis_geometry_clear(&g);
}

static void slivers_flat_scenes_and_coplanar_triangles_are_met_as_by_brute_force(void **state)
{
    for (int kind = 0; kind < 4; kind++) {
        bis_geometry g = {0};
        bis_mesh m = soup_mesh(200, 0.2, (uint64_t)kind + 20);
        for (size_t i = 0; i < m.n_vertices; i++) {
            if (kind == 0) m.p[i].z = 0.25f;                                                /* all in a plane */
            if (kind == 1) m.p[i].y *= 1e-4f;                                               /* nearly */
            if (kind == 2 && i % 3 == 2)
                m.p[i] = add(m.p[i - 1], mul(sub(m.p[i - 2], m.p[i - 1]), 0.5)); /* slivers by rounding */
            if (kind == 3) m.p[i].x = m.p[i].x < 0.5f ? 0.0f : 1.0f; /* walls, and triangles between */
        }
        add_mesh(&g, &m, NULL, 0);
        if (kind == 2) { /* slivers alone are hardly hit: something behind them */
            bis_mesh wall = sphere_mesh(6);
            add_mesh(&g, &wall, NULL, 0);
        }
        if (kind == 0) {
            uint64_t seed = 3;
            backends b = make_backends(&g);
            for (int n = 0; n < 3000; n++) {
                const vec3 o = {(float)random_double(&seed), (float)random_double(&seed), n % 2 ? 5 : -5};
                const vec3 target = {(float)random_double(&seed), (float)random_double(&seed), 0.25f};
                const ray r = {o, n % 3 ? sub(target, o) : (vec3){-0.0f, 0, n % 2 ? -1 : 1}, INFINITY};
                const truth expected = brute_force(&g, &r);
                for (int i = 0; i < b.n; i++) check_ray(b.a[i], &r, &expected);
            }
            free_backends(&b);
        } else {
            check_scene(&g, 3000, (uint64_t)kind);
        }
        bis_geometry_clear(&g);
    }
}

static void quadrics_under_any_transformation_are_met_as_by_brute_force(void **state)
{
    for (int with_mesh = 0; with_mesh < 2; with_mesh++) {
        uint64_t seed = 4;
        bis_geometry g = {0};
        if (with_mesh) {
            bis_mesh m = soup_mesh(100, 0.3, 5);
            add_mesh(&g, &m, NULL, 0);
        }
        for (int i = 0; i < 40; i++) {
            const bis_xform scale = bis_xform_scale(random_between(&seed, 0.02, 0.3), random_between(&seed, 0.02, 0.3),
                                                    random_between(&seed, -0.3, -0.02));
            const bis_xform turn =
                bis_xform_rotate(random_between(&seed, 0, 360), 1, random_double(&seed), random_double(&seed));
            const bis_xform move =
                bis_xform_translate(random_double(&seed), random_double(&seed), random_double(&seed));
            const bis_xform turned = bis_xform_compose(&turn, &scale);
            const bis_quadric q = {i % 2 ? BIS_SPHERE : BIS_DISK, random_between(&seed, 0.2, 1),
                random_between(&seed, -1, 1), bis_xform_compose(&move, &turned), 0};
            assert_int_equal(bis_geometry_add_quadric(&g, &q, NULL), BIS_OK);
        }
        check_scene(&g, 6000, 6);
        bis_geometry_clear(&g);
    }
}

/* One huge sphere about many small triangles, and a floor: the grid leaves the sphere out of its inner cells. */
static void a_sphere_around_everything_costs_no_hit(void **state)
{
    bis_geometry g = {0};
    bis_mesh m = soup_mesh(300, 0.05, 7);
    const bis_quadric q = {BIS_SPHERE, 1.2, 0, bis_xform_translate(0.5, 0.5, 0.5), 0};
    add_mesh(&g, &m, NULL, 0);
    assert_int_equal(bis_geometry_add_quadric(&g, &q, NULL), BIS_OK);
    check_scene(&g, 4000, 8);
    bis_geometry_clear(&g);
}

/* Triangles in walls of cells, twice, seen edge-on, too thin for a double's area, in one point, among
 * seven that are much wider: worlds for the next test. */
static bis_mesh nasty_mesh(int kind)
{
    uint64_t seed = 21;
    bis_mesh m =
        kind == 0 ? sphere_mesh(20) : soup_mesh(kind == 1 ? 2000 : 400, kind == 1 ? 0.05 : 0.4, (uint64_t)kind);

    for (size_t i = 0; i < m.n_vertices; i++) {
        vec3 *p = &m.p[i];
        if (kind == 2) p->z = 0.25f;
        if (kind == 3 && i % 3 == 2) *p = add(m.p[i - 1], mul(sub(m.p[i - 2], m.p[i - 1]), 0.5));
        if (kind == 4) *p = (vec3){roundf(8 * p->x), roundf(8 * p->y), roundf(8 * p->z)};
        if (kind == 5 && i % 9 > 3) *p = m.p[i - i % 9];
        if (kind == 6 && i < 21) *p = i % 3 == 1 ? add(*p, mul(m.p[i - 1], -1)) : mul(random_direction(&seed), 90);
    }
    return m;
}

/* At a vertex, at a point of an edge, or inside a triangle: from anywhere, along an axis, or from another vertex. */
static ray aimed_ray(const bis_geometry *g, uint64_t *seed)
{
    const double size = length(sub(g->box.hi, g->box.lo)), b = random_double(seed), u = random_double(seed),
                 end = random_double(seed);
    const uint32_t *t = g->index + 3 * (size_t)(random_double(seed) * (double)g->n_triangles);
    const uint32_t from =
        random_double(seed) < 0.5 ? 0 : g->index[(size_t)(random_double(seed) * 3 * (double)g->n_triangles)];
    const vec3 edge = add(mul(g->p[t[0]], b), mul(g->p[t[1]], 1 - b));
    const vec3 target = u < 0.3 ? g->p[t[0]] : u < 0.6 ? edge : add(mul(edge, b), mul(g->p[t[2]], 1 - b));
    const int axis = (int)(3 * random_double(seed));
    vec3 d = mul(random_direction(seed), size);

    if (random_double(seed) < 0.3)
        d = (vec3){axis == 0 ? (float)size : 0, axis == 1 ? -(float)size : -0.0f, axis == 2 ? (float)size : 0};
    if (random_double(seed) < 0.2) d = sub(target, g->p[from]);
    if (d.x == 0 && d.y == 0 && d.z == 0) d.x = 1;
    const double u2 = random_double(seed), away = u2 < 0.1    ? 0
                                                  : u2 < 0.2  ? 1000
                                                  : u2 < 0.25 ? 1e7
                                                              : random_double(seed);
    const vec3 o = sub(target, mul(d, away));
    return (ray){o, d, end < 0.3 ? (float)(3 * end) : end < 0.4 ? 1 : INFINITY};
}

/* The nearest hit of the triangle and quadric tests alone: all primitives in turn, no cell, no block, no float. */
static bis_hit nearest_of_all(const bis_geometry *g, const ray *r)
{
    const sheared_ray s = shear_ray(r);
    uint32_t prim = BIS_NO_PRIM;
    double best = (double)r->tmax;

    for (uint32_t k = 0; k < g->n_triangles; k++) {
        const vec3 p[3] = {g->p[g->index[3 * k]], g->p[g->index[3 * k + 1]], g->p[g->index[3 * k + 2]]};
        const float v[9] = {p[0].x, p[0].y, p[0].z, p[1].x, p[1].y, p[1].z, p[2].x, p[2].y, p[2].z};
        double t;
        if (!shear_hit(&s, r, v, best, &t) || !has_area(p) || !(t < best)) continue;
        best = t;
        prim = k;
    }
    for (uint32_t k = 0; k < g->n_quadrics; k++) {
        float t;
        if (!bis_quadric_intersect(&g->quadrics[k], r, &t) || !((double)t < best)) continue;
        best = (double)t;
        prim = (uint32_t)g->n_triangles + k;
    }
    return (bis_hit){(float)best, prim};
}

static void check_bits(const bis_accel *a, const ray *r, bis_hit expected)
{
    bis_hit hit = {r->tmax, BIS_NO_PRIM};
    const bool must = expected.prim != BIS_NO_PRIM;

    assert_int_equal(bis_accel_intersect(a, r, &hit), must);
    assert_int_equal(bis_accel_occluded(a, r), must);
    assert_true(hit.t == expected.t);
    /* t of a quadric is rounded to float before it is compared, so within an ulp of it the cells decide who is first */
    if (expected.prim < a->geometry->n_triangles && hit.prim < a->geometry->n_triangles)
        assert_int_equal(hit.prim, expected.prim);
}

/* Neither cells nor the filter in float lose or add a hit, in grids that are packed and in those that are not. */
static void the_grid_answers_as_a_loop_over_all_primitives_bit_by_bit(void **state)
{
    static const double densities[] = {0, 0.05, 20}, scales[] = {1, 1e-6, 1e6, 1}, shifts[] = {0, 0, 0, 1e4};
    const bis_quadric q = {BIS_SPHERE, 0.3, 0, bis_xform_translate(0.5, 0.5, 0.5), 0};
    const bis_quadric floor_disk = {BIS_DISK, 50, 0, bis_xform_translate(0.5, 0.5, -0.1), 0};
    uint64_t seed = 20;
    for (int n = 0; n < 7 * 4 * 3; n++) {
        const int kind = n % 7, place = n / 7 % 4;
        const bis_xform scale = bis_xform_scale(scales[place], scales[place], scales[place]);
        const bis_xform move = bis_xform_translate(shifts[place], -shifts[place], shifts[place]),
                        t = bis_xform_compose(&move, &scale);
        bis_geometry g = {0};
        bis_mesh m = nasty_mesh(kind);
        bis_accel *a;
        add_mesh(&g, &m, &t, 0);
        if (kind == 1 && place == 0) assert_int_equal(bis_geometry_add_quadric(&g, &q, NULL), BIS_OK);
        if (kind == 6 && place == 0) assert_int_equal(bis_geometry_add_quadric(&g, &floor_disk, NULL), BIS_OK);
        assert_int_equal(
            bis_accel_new(&a, &g, &(bis_accel_options){BIS_ACCEL_GRID, densities[n / 28], 1, NULL}, NULL), BIS_OK);
        bis_grid *grid = (bis_grid *)a;
        assert_int_equal(bis_grid_items(grid) - grid->offsets[grid->n_cells], kind == 6 ? place == 0 ? 8 : 7 : 0);
        if (!grid->blocks) assert_int_equal(bis_grid_pack(grid, 1, NULL), BIS_OK);
        bis_grid_block *blocks = grid->blocks;
        for (int k = 0; k < 1000; k++) {
            const ray r = k % 2 ? aimed_ray(&g, &seed) : nasty_ray(&g, &seed);
            const bis_hit expected = nearest_of_all(&g, &r);
            grid->blocks = blocks;
            check_bits(a, &r, expected);
            grid->blocks = NULL;
            check_bits(a, &r, expected);
        }
        grid->blocks = blocks;
        bis_accel_free(a);
        bis_geometry_clear(&g);
    }
}

/* Large triangles fill many cells each; the grid gives up resolution, not memory. */
static void a_soup_of_large_triangles_stays_within_its_items(void **state)
{
    bis_geometry g = {0};
    bis_mesh m = soup_mesh(20000, 1, 9);
    bis_accel *a;
    add_mesh(&g, &m, NULL, 0);
    assert_int_equal(bis_accel_new(&a, &g, &(bis_accel_options){BIS_ACCEL_GRID, 0, 1, NULL}, NULL), BIS_OK);
    assert_null(((const bis_grid *)a)->blocks);
    assert_true(bis_accel_bytes(a) + bis_geometry_bytes(&g) < 150 * g.n_triangles + 65536 * 4);
    bis_accel_free(a);
    bis_geometry_clear(&g);
}

static void memory_is_at_most_150_bytes_a_triangle_in_all(void **state)
{
    bis_geometry g = {0};
    bis_mesh m = sphere_mesh(300);
    bis_accel *a;
    assert_int_equal(bis_mesh_smooth_normals(&m, NULL), BIS_OK);
    add_mesh(&g, &m, NULL, 0);
    assert_int_equal(bis_accel_new(&a, &g, &(bis_accel_options){BIS_ACCEL_GRID, 0, 1, NULL}, NULL), BIS_OK);
    const double each = (double)(bis_accel_bytes(a) + bis_geometry_bytes(&g)) / (double)g.n_triangles;
    print_message("%.1f bytes a triangle\n", each);
    assert_true(each <= 150);
    bis_accel_free(a);
    bis_geometry_clear(&g);
}

/* A ray is open at both ends: what lies exactly at tmax is not on it, what lies an ulp before is. A square and a unit
 * ball, both met at t = 4 without any rounding. */
static void what_lies_at_the_end_of_a_ray_is_not_on_it(void **state)
{
    for (int ball = 0; ball < 2; ball++) {
        const vec3 corners[4] = {{-2, -2, 1}, {3, -2, 1}, {3, 3, 1}, {-2, 3, 1}};
        const uint32_t index[6] = {0, 1, 2, 0, 2, 3};
        const bis_xform identity = bis_xform_identity();
        const bis_quadric q = {.kind = BIS_SPHERE, .radius = 1, .to_world = identity};
        bis_geometry g = {0};
        bis_mesh m = {.n_vertices = 4, .n_triangles = 2};
        m.p = bis_alloc(4, sizeof *m.p);
        m.index = bis_alloc(6, sizeof *m.index);
        memcpy(m.p, corners, sizeof corners);
        memcpy(m.index, index, sizeof index);
        assert_int_equal(ball ? bis_geometry_add_quadric(&g, &q, NULL) : bis_geometry_add_mesh(&g, &m, &identity, 0,
            NULL), BIS_OK);
        bis_mesh_clear(&m);
        backends b = make_backends(&g);
        for (int i = 0; i < b.n; i++) {
            const float tmax[] = {nextafterf(4, 0), 4, nextafterf(4, 5), INFINITY};
            for (int k = 0; k < 4; k++) {
                const ray r = {{0, 0, 5}, {0, 0, -1}, tmax[k]};
                bis_hit hit;
                assert_int_equal(bis_accel_occluded(b.a[i], &r), k >= 2);
                assert_int_equal(bis_accel_intersect(b.a[i], &r, &hit), k >= 2);
                if (k >= 2) assert_true(hit.t == 4);
            }
        }
        free_backends(&b);
        bis_geometry_clear(&g);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(random_soups_are_met_as_by_brute_force),
        cmocka_unit_test(soups_at_every_scale_and_shift_are_met_as_by_brute_force),
        cmocka_unit_test(walls_axes_corners_and_duplicates_are_met_as_by_brute_force),
        cmocka_unit_test(nothing_escapes_through_edges_and_vertices),
        cmocka_unit_test(triangles_without_area_are_never_hit),
        cmocka_unit_test(slivers_flat_scenes_and_coplanar_triangles_are_met_as_by_brute_force),
        cmocka_unit_test(quadrics_under_any_transformation_are_met_as_by_brute_force),
        cmocka_unit_test(a_sphere_around_everything_costs_no_hit),
        cmocka_unit_test(the_grid_answers_as_a_loop_over_all_primitives_bit_by_bit),
        cmocka_unit_test(a_soup_of_large_triangles_stays_within_its_items),
        cmocka_unit_test(memory_is_at_most_150_bytes_a_triangle_in_all),
        cmocka_unit_test(what_lies_at_the_end_of_a_ray_is_not_on_it),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
