/* SPDX-License-Identifier: BSD-2-Clause */
/* `bis verify` of the accelerators: backends that lose rays are rejected, rays that graze an edge may go either way. */
#include "tools/verify/verify.h"
#include "bis/base/mem.h"
#include "claim.h"
#include "mesh_help.h"
#include "verify_help.h"

#include <string.h>

/* One ray in a thousand, by its bits, goes through. */
static bool is_lost(const ray *r)
{
    uint32_t bits;
    memcpy(&bits, &r->d.x, sizeof bits);
    return bis_hash(bits) % 1000 == 0;
}

static bool forgetful_intersect(const bis_accel *a, const ray *r, bis_hit *hit)
{
    return !is_lost(r) && bis_accel_intersect(((const accel_twin *)a)->right, r, hit);
}

static bool forgetful_occluded(const bis_accel *a, const ray *r)
{
    return bis_accel_occluded(((const accel_twin *)a)->right, r);
}

static bool blind(const bis_accel *a, const ray *r)
{
    return !is_lost(r) && bis_accel_occluded(((const accel_twin *)a)->right, r);
}

static void a_backend_that_loses_rays_is_rejected(void **state)
{
    static const bis_accel_ops loses = {
        .name = "loses", .intersect = forgetful_intersect, .occluded = forgetful_occluded};
    static const bis_accel_ops is_blind = {.name = "blind", .intersect = right_intersect, .occluded = blind};
    static const bis_accel_ops is_right = {
        .name = "right", .intersect = right_intersect, .occluded = forgetful_occluded};
    const bis_quadric ball = {.kind = BIS_SPHERE, .radius = 1, .to_world = bis_xform_identity()};
    bis_geometry g = {0};
    bis_accel *grid;
    const bis_accel_options options = {.kind = BIS_ACCEL_GRID};
    assert_int_equal(bis_geometry_add_quadric(&g, &ball, NULL), BIS_OK);
    assert_int_equal(bis_accel_new(&grid, &g, &options, NULL), BIS_OK);
    const bis_accel_ops *const ops[] = {&is_right, &loses, &is_blind};
    for (int i = 0; i < 3; i++) {
        const accel_twin f = {{ops[i], &g}, grid};
        bis_verify v = {.seed = 4};
        bis_verify_backends(&v, grid, &f.accel, 50000);
        /* of some 75000 rays one in a thousand, half of which miss the ball anyway */
        assert_true(i == 0 ? v.tests[0].statistic == 0 : v.tests[0].statistic > 5 && v.tests[0].statistic < 150);
        assert_int_equal(verify_failures(&v), i > 0);
    }
    bis_accel_free(grid);
    bis_geometry_clear(&g);
}

/* A floor at z = 0 alone, and one backend: only rays that start on it can tell. The right grid passes, alone and beside
 * Embree. */
static void a_floor_that_shadows_itself_is_found_with_one_backend(void **state)
{
    static const bis_accel_ops once = {.name = "once", .intersect = right_intersect, .occluded = sheared_occluded};
    static const float p[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    static const uint32_t index[6] = {0, 1, 2, 0, 2, 3};
    const bis_xform here = bis_xform_identity();
    bis_geometry g = {0};
    bis_accel *grid;
    bis_mesh m = {
        .p = bis_alloc(4, sizeof *m.p), .index = bis_alloc(2, 3 * sizeof *m.index), .n_vertices = 4, .n_triangles = 2};
    for (int i = 0; i < 4; i++) m.p[i] = (vec3){p[i][0], p[i][1], 0};
    memcpy(m.index, index, sizeof index);
    assert_int_equal(bis_geometry_add_mesh(&g, &m, &here, 0, NULL), BIS_OK);
    bis_mesh_clear(&m);
    assert_int_equal(bis_accel_new(&grid, &g, &(bis_accel_options){.kind = BIS_ACCEL_GRID}, NULL), BIS_OK);
    const accel_twin wrong = {{&once, &g}, grid};
    bis_verify right_alone = {.seed = 5}, wrong_alone = {.seed = 5};
    bis_verify_backends(&right_alone, grid, NULL, 5000);
    bis_verify_backends(&wrong_alone, &wrong.accel, NULL, 5000);
    assert_int_equal(verify_failures(&right_alone), 0);
    assert_int_equal(verify_failures(&wrong_alone), 1);
    if (bis_accel_embree_version()) {
        bis_accel *embree;
        bis_verify both = {.seed = 5};
        assert_int_equal(bis_accel_new(&embree, &g, &(bis_accel_options){.kind = BIS_ACCEL_EMBREE}, NULL), BIS_OK);
        bis_verify_backends(&both, grid, embree, 5000);
        assert_int_equal(verify_failures(&both), 0);
        bis_accel_free(embree);
    }
    bis_accel_free(grid);
    bis_geometry_clear(&g);
}

/* Rays at edges within a few ulps, from far and near: whatever float Embree and the double grid say, the search knows
 * that both are right; but not where one of them loses a hit or sees one that is not there 1e-4 beside the edge. */
static void a_grazing_ray_may_go_either_way_and_no_other(void **state)
{
    bis_geometry g = {0};
    const bis_xform here = bis_xform_identity();
    bis_rng rng;
    int ties = 0;
    bis_rng_init(&rng, 6, 0, 0, 1);
    bis_mesh m = {
        .p = bis_alloc(3, sizeof *m.p), .index = bis_alloc(1, 3 * sizeof *m.index), .n_vertices = 3, .n_triangles = 1};
    m.p[0] = (vec3){0.1f, 0.2f, 0.3f}, m.p[1] = (vec3){1.7f, 0.4f, -0.2f}, m.p[2] = (vec3){0.3f, 1.9f, 0.5f};
    for (uint32_t i = 0; i < 3; i++) m.index[i] = i;
    const vec3 p[3] = {m.p[0], m.p[1], m.p[2]};
    assert_int_equal(bis_geometry_add_mesh(&g, &m, &here, 0, NULL), BIS_OK);
    bis_mesh_clear(&m);
    for (int n = 0; n < 20000; n++) {
        const double along = .01 + .98 * bis_rng_double(&rng),
                     beside = n % 4 == 3   ? 1e-4
                              : n % 4 == 2 ? -1e-4
                                           : 1e-7 * (n % 4) * (bis_rng_double(&rng) - .5);
        const double b[3] = {1 - along - beside / 2, along - beside / 2, beside}; /* beside > 0: within */
        const vec3 at = add(add(mul(p[0], b[0]), mul(p[1], b[1])), mul(p[2], b[2]));
        const vec3 o =
            add(at, vec3_from(bis_rng_double(&rng) - .5, bis_rng_double(&rng) - .5, 1 + 3 * bis_rng_double(&rng)));
        const double l = length(sub(at, o));
        const ray r = {o, mul(sub(at, o), 1 / l), INFINITY};
        const bis_verify_answer answer[2] = {{l, true}, {(double)INFINITY, false}},
                                wrong[2] = {{l, false}, {l / 2, true}};
        bool right[2], of_wrong[2];
        bis_verify_search(right, &g, &r, BIS_NO_PRIM, answer, 2);
        bis_verify_search(of_wrong, &g, &r, BIS_NO_PRIM, wrong, 2);
        if (n % 4 == 3) assert_true(right[0] && !right[1] && !of_wrong[0]);
        if (n % 4 == 2) assert_true(!right[0] && right[1]);
        if (n % 4 < 2) ties += right[0] && right[1];
        assert_false(of_wrong[1]);
    }
    assert_true(ties > 9900);
    bis_geometry_clear(&g);
}

/* What is exactly met is never called missed, and the other way round, however near the edge and far the origin. The
 * truth by volumes in long double, products of three floats' differences: 2^-60 of them. A weight that was surely
 * negative, but by less than Embree may count as inside, made the search sure of a hit: both accelerators were accused
 * of a ray in 4 million. */
static void the_truth_is_always_right(void **state)
{
    static const float corner[3][3] = {{0.1f, 0.2f, 0.3f}, {1.7f, 0.4f, -0.2f}, {0.3f, 1.9f, 0.5f}};
    const bis_xform here = bis_xform_identity();
    bis_geometry g = {0};
    bis_rng rng;
    int near_edge = 0;
    bis_rng_init(&rng, 7, 0, 0, 1);
    bis_mesh m = {
        .p = bis_alloc(3, sizeof *m.p), .index = bis_alloc(1, 3 * sizeof *m.index), .n_vertices = 3, .n_triangles = 1};
    memcpy(m.p, corner, sizeof corner);
    for (uint32_t i = 0; i < 3; i++) m.index[i] = i;
    const vec3 p[3] = {m.p[0], m.p[1], m.p[2]};
    assert_int_equal(bis_geometry_add_mesh(&g, &m, &here, 0, NULL), BIS_OK);
    bis_mesh_clear(&m);
    for (int n = 0; n < 100000; n++) {
        const double along = .01 + .98 * bis_rng_double(&rng), side = bis_rng_double(&rng) - .5;
        const double beside = copysign(pow(10, -9 + 5 * bis_rng_double(&rng)), side),
                     far = 1 + 30 * bis_rng_double(&rng);
        const vec3 at = add(add(mul(p[0], 1 - along - beside / 2), mul(p[1], along - beside / 2)), mul(p[2], beside));
        const vec3 o = add(at, vec3_from(far * (bis_rng_double(&rng) - .5), far * (bis_rng_double(&rng) - .5), far));
        const double l = length(sub(at, o));
        const ray r = {o, mul(sub(at, o), 1 / l), INFINITY};
        long double v[3][3], w[3];
        for (int i = 0; i < 3; i++) {
            v[i][0] = (long double)p[i].x - (long double)o.x;
            v[i][1] = (long double)p[i].y - (long double)o.y;
            v[i][2] = (long double)p[i].z - (long double)o.z;
        }
        for (int i = 0; i < 3; i++) {
            const long double *a = v[i], *b = v[(i + 1) % 3];
            w[i] = (long double)r.d.x * (a[1] * b[2] - a[2] * b[1]) + (long double)r.d.y * (a[2] * b[0] - a[0] * b[2]) +
                   (long double)r.d.z * (a[0] * b[1] - a[1] * b[0]);
        }
        const bool met = (w[0] > 0 && w[1] > 0 && w[2] > 0) || (w[0] < 0 && w[1] < 0 && w[2] < 0);
        const bis_verify_answer answer[2] = {{l, true}, {(double)INFINITY, false}};
        bool right[2];
        bis_verify_search(right, &g, &r, BIS_NO_PRIM, answer, 2);
        if (!right[met ? 0 : 1])
            fail_msg("ray %d, %g beside the edge, from %g: %s", n, beside, far, met ? "met" : "missed");
        near_edge += right[0] && right[1];
    }
    assert_true(near_edge > 10000 && near_edge < 90000);
    bis_geometry_clear(&g);
}

/* One of 40 triangles is a point. */
static void a_backend_that_loses_a_triangle_is_rejected(void **state)
{
    const bis_xform here = bis_xform_identity();
    const bis_accel_options options = {.kind = BIS_ACCEL_GRID};
    bis_geometry g[2] = {{0}, {0}};
    bis_accel *grid[2];
    for (int i = 0; i < 2; i++) {
        bis_mesh m = soup_mesh(40, 0.3, 1);
        for (int k = 1; k < 3 && i == 1; k++) m.index[5 * 3 + k] = m.index[5 * 3];
        add_mesh(&g[i], &m, &here, 0);
        assert_int_equal(bis_accel_new(&grid[i], &g[i], &options, NULL), BIS_OK);
    }
    bis_verify v = {.seed = 4};
    bis_verify_backends(&v, grid[0], grid[1], 20000);
    assert_int_equal(verify_failures(&v), 1);
    for (int i = 0; i < 2; i++) {
        bis_accel_free(grid[i]);
        bis_geometry_clear(&g[i]);
    }
}

/* ---- the search by hand ---- */

/* x y z moved on by `turn` places: the same figure about another axis. */
static vec3 turned(double x, double y, double z, int turn)
{
    return turn == 0 ? vec3_from(x, y, z) : turn == 1 ? vec3_from(z, x, y) : vec3_from(y, z, x);
}

static void add_triangle(bis_geometry *g, vec3 a, vec3 b, vec3 c)
{
    const bis_xform here = bis_xform_identity();
    bis_mesh m = {.p = bis_alloc(3, sizeof *m.p), .index = bis_alloc(1, 3 * sizeof *m.index), .n_vertices = 3,
                  .n_triangles = 1};
    m.p[0] = a, m.p[1] = b, m.p[2] = c;
    for (uint32_t i = 0; i < 3; i++) m.index[i] = i;
    assert_int_equal(bis_geometry_add_mesh(g, &m, &here, 0, NULL), BIS_OK);
    bis_mesh_clear(&m);
}

/* A ray is surely met at t, to within the error, or surely missed, or in doubt: then both answers are right. */
typedef enum seen { SURELY_MISSED, IN_DOUBT, SURELY_MET } seen;

static seen search_for(const bis_geometry *g, const ray *r, uint32_t left, double t)
{
    const bis_verify_answer answer[4] = {{t, true}, {(double)INFINITY, false}, {t, false}, {(double)INFINITY, true}};
    bool right[4];
    for (int i = 0; i < 4; i += 2) bis_verify_search(right + i, g, r, left, answer + i, 2);
    assert_true(right[0] || right[1]);
    /* an answer that contradicts itself is right in doubt alone */
    assert_true(right[2] == (right[0] && right[1]) && right[3] == (right[0] && right[1]));
    return right[0] && right[1] ? IN_DOUBT : right[0] ? SURELY_MET : SURELY_MISSED;
}

static bool is_right(const bis_geometry *g, const ray *r, double t)
{
    const bis_verify_answer answer = {t, true};
    bool right;
    bis_verify_search(&right, g, r, BIS_NO_PRIM, &answer, 1);
    return right;
}

/* A distance may err by so many u = 2^-24, a hundredth of one less, `margin` more. */
static void assert_error(const bis_geometry *g, const ray *r, double t, double error, double margin)
{
    const double u = 0x1p-24;
    assert_int_equal(search_for(g, r, BIS_NO_PRIM, t), SURELY_MET);
    for (int side = -1; side <= 1; side += 2) {
        if (!is_right(g, r, t + side * (error - 0.01) * u)) fail_msg("%g: %g u less is wrong", t, side * error);
        if (is_right(g, r, t + side * (error + margin) * u)) fail_msg("%g: %g u more is right", t, side * error);
    }
}

/* The triangle (0,0,0), (2,0,0), (0,4,0): n = (0,0,8), its only terms are 8 along z. From (0.5,0.5,8) along -z: T =
 * -64, D.n = -8, t = 8. T errs by u (4 x 8 x 8 + 13 x 8 x 8) = 1088 u. The vertices lie up to 1.5, 3.5 and 8 from
 * the ray's start, so D.n errs by u (2 x 1.5 x 4 + 2 x 3.5 x 2 + 8 x 8) = 90 u: 136 + 90 + 4 x 8 = 258 u of t. Along
 * (0.5,0.25,-1) from (-3.5,-1.5,8) they lie up to 5.5, 5.5 and 8 away: u (0.5 x 2 x 8 x 4 + 0.25 x 2 x 8 x 2 + 2 x
 * 5.5 x 4 + 2 x 5.5 x 2 + 64) = 170 u: 338 u. */
static void a_triangle_is_met_to_within_the_error_by_hand(void **state)
{
    for (int k = 0; k < 3; k++) {
        bis_geometry g = {0};
        add_triangle(&g, turned(0, 0, 0, k), turned(2, 0, 0, k), turned(0, 4, 0, k));
        const ray down = {turned(0.5, 0.5, 8, k), turned(0, 0, -1, k), INFINITY};
        const ray oblique = {turned(-3.5, -1.5, 8, k), turned(0.5, 0.25, -1, k), INFINITY};
        assert_error(&g, &down, 8, 258, 0.01);
        assert_error(&g, &oblique, 8, 338, 0.01);
        /* behind, beside, from the triangle itself, along its plane */
        const ray up = {down.o, turned(0, 0, 1, k), INFINITY}, beside = {turned(1.5, 1.5, 8, k), down.d, INFINITY},
                  along = {turned(-1, 1, 0, k), turned(1, 0, 0, k), INFINITY},
                  above = {turned(-1, 1, 0.125, k), turned(1, 0, 0, k), INFINITY};
        assert_int_equal(search_for(&g, &up, BIS_NO_PRIM, 8), SURELY_MISSED);
        assert_int_equal(search_for(&g, &beside, BIS_NO_PRIM, 8), SURELY_MISSED);
        assert_int_equal(search_for(&g, &down, 0, 8), SURELY_MISSED);
        assert_int_equal(search_for(&g, &along, BIS_NO_PRIM, 1), IN_DOUBT);
        assert_int_equal(search_for(&g, &along, 0, 1), IN_DOUBT);
        assert_int_equal(search_for(&g, &above, BIS_NO_PRIM, 1), SURELY_MISSED);
        bis_geometry_clear(&g);
    }
}

/* Rays along z beside the edge from (-1000,-1000) to (1000,1000), at (s,-s): its weight is 8000 s, which errs by 18
 * u 2000^2 = 72e6 u. The three weights are 8e6 together, of which 2 u may be missing: outside it is surely missed
 * from s = 88e6/8000 u = 11000 u on, inside surely met from 9000 u on. */
static void an_edge_is_in_doubt_within_the_bound_by_hand(void **state)
{
    const double u = 0x1p-24;
    static const struct {
        double s;
        seen seen;
    } cases[] = {{11100, SURELY_MISSED}, {10900, IN_DOUBT}, {0, IN_DOUBT}, {-8900, IN_DOUBT}, {-9100, SURELY_MET}};
    for (int k = 0; k < 3; k++) {
        for (int order = 0; order < 2; order++) {
            bis_geometry g = {0};
            const vec3 a = turned(-1000, -1000, 0, k), b = turned(1000, 1000, 0, k), c = turned(-1000, 1000, 0, k);
            add_triangle(&g, order ? b : a, order ? a : b, c);
            for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
                const double s = cases[i].s * u;
                const ray r = {turned(s, -s, 8, k), turned(0, 0, -1, k), INFINITY};
                const seen found = search_for(&g, &r, BIS_NO_PRIM, 8);
                if (found != cases[i].seen) fail_msg("axis %d, %g u: %d", k, cases[i].s, (int)found);
            }
            bis_geometry_clear(&g);
        }
    }
}

/* Of two triangles the nearer one counts, whichever comes first; a ray between them meets the other one. */
static void the_nearest_triangle_is_met(void **state)
{
    for (int first = 0; first < 2; first++) {
        bis_geometry g = {0};
        for (int i = 0; i < 2; i++) {
            const double z = i == first ? 0 : 4;
            add_triangle(&g, vec3_from(0, 0, z), vec3_from(2, 0, z), vec3_from(0, 4, z));
        }
        const ray r = {{0.5f, 0.5f, 8}, {0, 0, -1}, INFINITY}, between = {{0.5f, 0.5f, 2}, {0, 0, -1}, INFINITY};
        assert_true(is_right(&g, &r, 4) && !is_right(&g, &r, 8) && !is_right(&g, &r, 6));
        assert_true(is_right(&g, &between, 2) && !is_right(&g, &between, 6));
        const uint32_t upper = first ? 0 : 1;
        assert_int_equal(search_for(&g, &r, upper, 8), SURELY_MET); /* what it left does not hide the other */
        bis_geometry_clear(&g);
    }
}

/* Discs of radius 2 at z = 1, spheres of radius 2, both moved to (16,-32,8). The distance may err by 4 u of itself.
 * Besides 2^-40 of all sizes, up to 124, are in doubt: u/500 of a plane's distance. Of a sphere it is 4 x 124 times
 * as much of the square of half the chord, 3/16 or more: 2.2 u of its half. */
static void a_quadric_is_met_to_within_the_error_by_hand(void **state)
{
    static const struct {
        bis_quadric_kind kind;
        double o[3], d[3], t;
        seen seen;
    } cases[] = {
        {BIS_DISK, {0.25, 1.75, 9}, {0, 0, -1}, 8, SURELY_MET}, {BIS_DISK, {1.75, -0.25, 9}, {0, 0, -1}, 8, SURELY_MET},
        {BIS_DISK, {1.75, 1, 9}, {0, 0, -1}, 8, SURELY_MISSED},
        {BIS_DISK, {-1, -1.75, 9}, {0, 0, -1}, 8, SURELY_MISSED},
        /* to (-1.75,0.5,1) from either side; the other way */
        {BIS_DISK, {-5.75, 2.5, 9}, {0.5, -0.25, -1}, 8, SURELY_MET},
        {BIS_DISK, {-5.75, 2.5, 9}, {1, -0.5, -2}, 4, SURELY_MET},
        {BIS_DISK, {2.25, -1.5, -7}, {-0.5, 0.25, 1}, 8, SURELY_MET},
        {BIS_DISK, {-5.75, 2.5, 9}, {-0.5, 0.25, 1}, 8, SURELY_MISSED},
        /* in its plane, on it, and the next place of a float beside it */
        {BIS_DISK, {-4, 0, 1}, {1, 0, 0}, 2, SURELY_MISSED}, {BIS_DISK, {0, 0, 1}, {0, 0, 1}, 0, IN_DOUBT},
        {BIS_DISK, {0, 0, 1 + 0x1p-18}, {0, 0, 1}, 0, SURELY_MISSED},
        {BIS_DISK, {0, 0, 1 - 0x1p-18}, {0, 0, 1}, 0x1p-18, SURELY_MET},
        {BIS_SPHERE, {0, 0, 10}, {0, 0, -1}, 8, SURELY_MET}, {BIS_SPHERE, {0, 0, 10}, {0, 0, -2}, 4, SURELY_MET},
        {BIS_SPHERE, {0, -10, 0}, {0, 1, 0}, 8, SURELY_MET}, {BIS_SPHERE, {10, 0, 0}, {-1, 0, 0}, 8, SURELY_MET},
        {BIS_SPHERE, {0, 0, 1}, {0, 0, -1}, 3, SURELY_MET}, {BIS_SPHERE, {0, 0, -10}, {0, 0, -1}, 8, SURELY_MISSED},
        {BIS_SPHERE, {1.25, 1.5, 10}, {0, 0, -1}, 10 - 0.4330127018922193, SURELY_MET}, /* sqrt(4 - 3.8125) */
        {BIS_SPHERE, {-1.5, 0, 1.25}, {0, 2, 0}, 0.4330127018922193 / 2, SURELY_MET},
        {BIS_SPHERE, {2 + 0x1p-10, 0, 10}, {0, 0, -1}, 10, SURELY_MISSED},
        {BIS_SPHERE, {1.5, 1.5, 10}, {0, 0, -1}, 10, SURELY_MISSED},
        {BIS_SPHERE, {0, 1.5, 1.5}, {1, 0, 0}, 1, SURELY_MISSED},
        /* on it: outwards; inwards, where it may be met at once, and is at the far side; along it */
        {BIS_SPHERE, {0, 0, 2}, {0, 0, 1}, 0, IN_DOUBT}, {BIS_SPHERE, {0, 0, 2}, {0, 0, -1}, 0, SURELY_MET},
        {BIS_SPHERE, {0, 0, 2}, {0, 0, -1}, 4, SURELY_MET}, {BIS_SPHERE, {2, 0, 4}, {0, 0, -1}, 4, IN_DOUBT},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const bis_quadric q = {.kind = cases[i].kind, .radius = 2, .height = cases[i].kind == BIS_DISK ? 1 : 0,
                               .to_world = bis_xform_translate(16, -32, 8)};
        const double *o = cases[i].o, *d = cases[i].d, t = cases[i].t;
        const ray r = {vec3_from(16 + o[0], -32 + o[1], 8 + o[2]), vec3_from(d[0], d[1], d[2]), INFINITY};
        bis_geometry g = {0};
        assert_int_equal(bis_geometry_add_quadric(&g, &q, NULL), BIS_OK);
        const seen found = search_for(&g, &r, BIS_NO_PRIM, t);
        if (found != cases[i].seen) fail_msg("case %zu: %d", i, (int)found);
        assert_int_equal(search_for(&g, &r, 0, t), SURELY_MISSED); /* what a ray has left */
        if (found == SURELY_MET && t >= 3) assert_error(&g, &r, t, 4 * t, q.kind == BIS_DISK ? 0.01 : 3);
        bis_geometry_clear(&g);
    }
}

/* ---- which rays are looked at ---- */

/* Sums over all rays that a backend was asked for: [0] those that start around the scene, [1] those from the ball. */
typedef struct asked {
    bis_accel accel;
    const bis_accel *right;
    long n[2], octant[2][8], twice; /* twice: `occluded` was asked for the same ray */
    double place[3], place_squares[3], cosine, farthest;
} asked;

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_backend_that_loses_rays_is_rejected),
        cmocka_unit_test(a_floor_that_shadows_itself_is_found_with_one_backend),
        cmocka_unit_test(a_grazing_ray_may_go_either_way_and_no_other),
        cmocka_unit_test(the_truth_is_always_right),
        cmocka_unit_test(a_backend_that_loses_a_triangle_is_rejected),
        cmocka_unit_test(a_triangle_is_met_to_within_the_error_by_hand),
        cmocka_unit_test(an_edge_is_in_doubt_within_the_bound_by_hand),
        cmocka_unit_test(the_nearest_triangle_is_met),
        cmocka_unit_test(a_quadric_is_met_to_within_the_error_by_hand),
    };
    return cmocka_run_group_tests_name("verify_accel", tests, NULL, NULL);
}
