/* `bis verify` of the accelerators: backends that lose rays are rejected, rays that graze an edge may go either way. */
#include "shape/triangle.h"
#include "tools/verify/verify.h"
#include "bis/base/mem.h"
#include "mesh_help.h"
#include "verify_help.h"

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

typedef struct forgetful {
    bis_accel accel;
    const bis_accel *right;
} forgetful;

/* One ray in a thousand, by its bits, goes through. */
static bool is_lost(const ray *r)
{
    uint32_t bits;
    memcpy(&bits, &r->d.x, sizeof bits);
    return bis_hash(bits) % 1000 == 0;
}

static bool forgetful_intersect(const bis_accel *a, const ray *r, bis_hit *hit)
{
    return !is_lost(r) && bis_accel_intersect(((const forgetful *)a)->right, r, hit);
}

static bool forgetful_occluded(const bis_accel *a, const ray *r) { return bis_accel_occluded(((const forgetful *)a)->right, r); }
static bool blind(const bis_accel *a, const ray *r) { return !is_lost(r) && bis_accel_occluded(((const forgetful *)a)->right, r); }

static bool right_intersect(const bis_accel *a, const ray *r, bis_hit *hit)
{
    return bis_accel_intersect(((const forgetful *)a)->right, r, hit);
}

static void a_backend_that_loses_rays_is_rejected(void **state)
{
    (void)state;
    static const bis_accel_ops loses = {.name = "loses", .intersect = forgetful_intersect, .occluded = forgetful_occluded};
    static const bis_accel_ops is_blind = {.name = "blind", .intersect = right_intersect, .occluded = blind};
    static const bis_accel_ops is_right = {.name = "right", .intersect = right_intersect, .occluded = forgetful_occluded};
    const bis_quadric ball = {.kind = BIS_SPHERE, .radius = 1, .to_world = bis_xform_identity()};
    bis_geometry g = {0};
    bis_accel *grid;
    const bis_accel_options options = {.kind = BIS_ACCEL_GRID};
    assert_int_equal(bis_geometry_add_quadric(&g, &ball, NULL), BIS_OK);
    assert_int_equal(bis_accel_new(&grid, &g, &options, NULL), BIS_OK);
    const bis_accel_ops *const ops[] = {&is_right, &loses, &is_blind};
    for (int i = 0; i < 3; i++) {
        const forgetful f = {{ops[i], &g}, grid};
        bis_verify v = {.seed = 4};
        bis_verify_backends(&v, grid, &f.accel, 50000);
        /* of some 75000 rays one in a thousand, half of which miss the ball anyway */
        assert_true(i == 0 ? v.tests[0].statistic == 0 : v.tests[0].statistic > 5 && v.tests[0].statistic < 150);
        assert_int_equal(verify_failures(&v), i > 0);
    }
    bis_accel_free(grid);
    bis_geometry_clear(&g);
}

/* The grid's triangle test as it once was: the sign of t by sheared coordinates alone. */
static bool sheared_occluded(const bis_accel *a, const ray *r)
{
    const bis_geometry *g = a->geometry;
    const sheared_ray sheared = shear_ray(r);
    for (size_t i = 0; i < g->n_triangles; i++) {
        float v[9];
        double e[3], det, z;
        for (size_t k = 0; k < 3; k++) memcpy(v + 3 * k, &g->p[g->index[3 * i + k]], 3 * sizeof *v);
        if (shear_test(&sheared, v, e, &det, &z) && z / det > 0) return true;
    }
    return false;
}

/* A floor at z = 0 alone, and one backend: only rays that start on it can tell. The right grid passes, alone and beside
 * Embree. */
static void a_floor_that_shadows_itself_is_found_with_one_backend(void **state)
{
    (void)state;
    static const bis_accel_ops once = {.name = "once", .intersect = right_intersect, .occluded = sheared_occluded};
    static const float p[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    static const uint32_t index[6] = {0, 1, 2, 0, 2, 3};
    const bis_xform here = bis_xform_identity();
    bis_geometry g = {0};
    bis_accel *grid;
    bis_mesh m = {.p = bis_alloc(4, sizeof *m.p), .index = bis_alloc(2, 3 * sizeof *m.index), .n_vertices = 4, .n_triangles = 2};
    for (int i = 0; i < 4; i++) m.p[i] = (vec3){p[i][0], p[i][1], 0};
    memcpy(m.index, index, sizeof index);
    assert_int_equal(bis_geometry_add_mesh(&g, &m, &here, 0, NULL), BIS_OK);
    bis_mesh_clear(&m);
    assert_int_equal(bis_accel_new(&grid, &g, &(bis_accel_options){.kind = BIS_ACCEL_GRID}, NULL), BIS_OK);
    const forgetful wrong = {{&once, &g}, grid};
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
    (void)state;
    bis_geometry g = {0};
    const bis_xform here = bis_xform_identity();
    bis_rng rng;
    int ties = 0;
    bis_rng_init(&rng, 6, 0, 0, 1);
    bis_mesh m = {.p = bis_alloc(3, sizeof *m.p), .index = bis_alloc(1, 3 * sizeof *m.index), .n_vertices = 3, .n_triangles = 1};
    m.p[0] = (vec3){0.1f, 0.2f, 0.3f}, m.p[1] = (vec3){1.7f, 0.4f, -0.2f}, m.p[2] = (vec3){0.3f, 1.9f, 0.5f};
    for (uint32_t i = 0; i < 3; i++) m.index[i] = i;
    const vec3 p[3] = {m.p[0], m.p[1], m.p[2]};
    assert_int_equal(bis_geometry_add_mesh(&g, &m, &here, 0, NULL), BIS_OK);
    bis_mesh_clear(&m);
    for (int n = 0; n < 20000; n++) {
        const double along = .01 + .98 * bis_rng_double(&rng), beside = n % 4 == 3 ? 1e-4 : n % 4 == 2 ? -1e-4 : 1e-7 * (n % 4) * (bis_rng_double(&rng) - .5);
        const double b[3] = {1 - along - beside / 2, along - beside / 2, beside}; /* beside > 0: within */
        const vec3 at = add(add(mul(p[0], b[0]), mul(p[1], b[1])), mul(p[2], b[2]));
        const vec3 o = add(at, vec3_from(bis_rng_double(&rng) - .5, bis_rng_double(&rng) - .5, 1 + 3 * bis_rng_double(&rng)));
        const double l = length(sub(at, o));
        const ray r = {o, mul(sub(at, o), 1 / l), INFINITY};
        const bis_verify_answer answer[2] = {{l, true}, {(double)INFINITY, false}}, wrong[2] = {{l, false}, {l / 2, true}};
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

/* What is exactly met is never called missed, and the other way round, however near the edge and far the origin. The truth
 * by volumes in long double, products of three floats' differences: 2^-60 of them. A weight that was surely negative, but
 * by less than Embree may count as inside, made the search sure of a hit: both accelerators were accused of a ray in 4 million. */
static void the_truth_is_always_right(void **state)
{
    (void)state;
    static const float corner[3][3] = {{0.1f, 0.2f, 0.3f}, {1.7f, 0.4f, -0.2f}, {0.3f, 1.9f, 0.5f}};
    const bis_xform here = bis_xform_identity();
    bis_geometry g = {0};
    bis_rng rng;
    int near_edge = 0;
    bis_rng_init(&rng, 7, 0, 0, 1);
    bis_mesh m = {.p = bis_alloc(3, sizeof *m.p), .index = bis_alloc(1, 3 * sizeof *m.index), .n_vertices = 3, .n_triangles = 1};
    memcpy(m.p, corner, sizeof corner);
    for (uint32_t i = 0; i < 3; i++) m.index[i] = i;
    const vec3 p[3] = {m.p[0], m.p[1], m.p[2]};
    assert_int_equal(bis_geometry_add_mesh(&g, &m, &here, 0, NULL), BIS_OK);
    bis_mesh_clear(&m);
    for (int n = 0; n < 100000; n++) {
        const double along = .01 + .98 * bis_rng_double(&rng), side = bis_rng_double(&rng) - .5;
        const double beside = copysign(pow(10, -9 + 5 * bis_rng_double(&rng)), side), far = 1 + 30 * bis_rng_double(&rng);
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
            w[i] = (long double)r.d.x * (a[1] * b[2] - a[2] * b[1]) + (long double)r.d.y * (a[2] * b[0] - a[0] * b[2]) + (long double)r.d.z * (a[0] * b[1] - a[1] * b[0]);
        }
        const bool met = (w[0] > 0 && w[1] > 0 && w[2] > 0) || (w[0] < 0 && w[1] < 0 && w[2] < 0);
        const bis_verify_answer answer[2] = {{l, true}, {(double)INFINITY, false}};
        bool right[2];
        bis_verify_search(right, &g, &r, BIS_NO_PRIM, answer, 2);
        if (!right[met ? 0 : 1]) fail_msg("ray %d, %g beside the edge, from %g: %s", n, beside, far, met ? "met" : "missed");
        near_edge += right[0] && right[1];
    }
    assert_true(near_edge > 10000 && near_edge < 90000);
    bis_geometry_clear(&g);
}

/* One of 40 triangles is a point. */
static void a_backend_that_loses_a_triangle_is_rejected(void **state)
{
    (void)state;
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

/* ---- which rays are looked at ---- */

/* Sums over all rays that a backend was asked for: [0] those that start around the scene, [1] those from the ball. */
typedef struct asked {
    bis_accel accel;
    const bis_accel *right;
    long n[2], octant[2][8], twice; /* twice: `occluded` was asked for the same ray */
    double place[3], place_squares[3], cosine, farthest;
} asked;

static bool note_ray(const bis_accel *a, const ray *r, bis_hit *hit)
{
    asked *s = (asked *)(uintptr_t)a;
    const double o[3] = {(double)r->o.x, (double)r->o.y, (double)r->o.z}, l = sqrt(o[0] * o[0] + o[1] * o[1] + o[2] * o[2]);
    const int from_ball = fabs(l - 1) < 1e-5;
#pragma omp critical(asked)
    {
        s->n[from_ball]++;
        s->octant[from_ball][(r->d.x > 0) + 2 * (r->d.y > 0) + 4 * (r->d.z > 0)]++;
        if (from_ball) s->cosine += (double)dot(r->o, r->d) * (l > 1 ? 1 : -1) / l; /* to the side where it starts */
        for (int k = 0; k < 3 && !from_ball; k++) {
            s->place[k] += o[k];
            s->place_squares[k] += o[k] * o[k];
            s->farthest = fmax(s->farthest, fabs(o[k]));
        }
    }
    return bis_accel_intersect(s->right, r, hit);
}

static bool note_shadow(const bis_accel *a, const ray *r)
{
    asked *s = (asked *)(uintptr_t)a;
#pragma omp atomic
    s->twice++;
    return bis_accel_occluded(s->right, r);
}

/* Five standard errors of a mean of n numbers. */
static void assert_mean(double mean, double expected, double variance, double n)
{
    if (!(fabs(mean - expected) < 5 * sqrt(variance / n))) fail_msg("%g is not %g", mean, expected);
}

/* Around a ball of radius 1: its box has the diagonal 2 sqrt 3, so rays start in a cube of half side a = 1 + 0.2 sqrt 3,
 * evenly: each coordinate has mean 0, mean square a^2/3, of variance 4 a^4/45. Towards the ball no octant is before
 * another. From the ball, or within it, rays leave evenly: the mean of the cosine is 1/2, its variance 1/12; again no octant is before
 * another. Each ray is asked for by both questions. */
static void rays_come_from_all_around_and_leave_to_all_sides(void **state)
{
    (void)state;
    static const bis_accel_ops notes = {.name = "notes", .intersect = note_ray, .occluded = note_shadow};
    enum { RAYS = 20000 };
    const double a = 1 + 0.2 * sqrt(3);
    const bis_quadric ball = {.kind = BIS_SPHERE, .radius = 1, .to_world = bis_xform_identity()};
    const bis_accel_options options = {.kind = BIS_ACCEL_GRID};
    bis_geometry g = {0};
    bis_accel *grid;
    assert_int_equal(bis_geometry_add_quadric(&g, &ball, NULL), BIS_OK);
    assert_int_equal(bis_accel_new(&grid, &g, &options, NULL), BIS_OK);
    asked s = {.accel = {&notes, &g}, .right = grid};
    bis_verify v = {.seed = 4, .halvings = 12};
    unsigned long rays, from, searched, grazing;
    bis_verify_backends(&v, &s.accel, NULL, RAYS);
    assert_int_equal(v.n, 1);
    assert_string_equal(v.tests[0].name, "notes sees what a search sees");
    assert_int_equal(sscanf(v.tests[0].note, "wrong of %lu rays and %lu from surfaces, %lu of them searched; %lu more",
                            &rays, &from, &searched, &grazing), 4);
    assert_true(v.tests[0].statistic == 0);
    assert_true(rays == RAYS && s.n[0] == RAYS && s.n[1] == (long)from && s.twice == s.n[0] + s.n[1]);
    /* 2^24 halved 12 times, and the rays that leave where these end */
    assert_true(searched > 4096 && searched < 2 * 4096);
    assert_true(from > RAYS / 2);
    bis_verify_clear(&v);

    const double n[2] = {(double)s.n[0], (double)s.n[1]};
    for (int k = 0; k < 3; k++) {
        assert_mean(s.place[k] / n[0], 0, a * a / 3, n[0]);
        assert_mean(s.place_squares[k] / n[0], a * a / 3, 4 * pow(a, 4) / 45, n[0]);
    }
    assert_true(s.farthest < a && s.farthest > 0.999 * a);
    assert_mean(s.cosine / n[1], 0.5, 1 / 12.0, n[1]);
    for (int i = 0; i < 2; i++)
        for (int k = 0; k < 8; k++) assert_mean((double)s.octant[i][k] / n[i], 1 / 8.0, 7 / 64.0, n[i]);

    /* two backends: 2^21 halved 12 times are 512 */
    v = (bis_verify){.seed = 4, .halvings = 12};
    bis_verify_backends(&v, &s.accel, grid, RAYS);
    assert_int_equal(sscanf(v.tests[0].note, "wrong of %*u rays and %*u from surfaces, %lu of them searched", &searched),
                     1);
    assert_true(searched > 512 && searched < 2 * 512);
    assert_string_equal(v.tests[0].name, "notes and grid see the same");
    bis_verify_clear(&v);
    bis_accel_free(grid);
    bis_geometry_clear(&g);
}

/* Points instead of triangles, so that no ray meets one: as many rays are searched as 2^24 tests allow, but 64; beside
 * another backend 2^21, but 4. */
static void large_scenes_have_fewer_rays_searched(void **state)
{
    (void)state;
    static const struct {
        size_t n;
        bool two;
        unsigned halvings;
        unsigned long searched;
    } cases[] = {{1 << 17, false, 0, 128}, {300000, false, 0, 64}, {300000, false, 3, 8}, {1 << 17, true, 0, 16},
                 {600000, true, 0, 4}, {600000, true, 1, 2}};
    const bis_accel_options options = {.kind = BIS_ACCEL_GRID};
    const bis_xform here = bis_xform_identity();
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        bis_geometry g = {0};
        bis_accel *grid;
        bis_rng rng;
        unsigned long rays, from, searched;
        bis_verify v = {.seed = 4, .halvings = cases[k].halvings};
        const size_t n = cases[k].n;
        bis_mesh m = {.p = bis_alloc(n, sizeof *m.p), .index = bis_alloc(n, 3 * sizeof *m.index), .n_vertices = n,
                      .n_triangles = n};
        bis_rng_init(&rng, 8, 0, 0, 1);
        for (size_t i = 0; i < n; i++) {
            m.p[i] = vec3_from(bis_rng_double(&rng), bis_rng_double(&rng), bis_rng_double(&rng));
            for (size_t j = 0; j < 3; j++) m.index[3 * i + j] = (uint32_t)i;
        }
        assert_int_equal(bis_geometry_add_mesh(&g, &m, &here, 0, NULL), BIS_OK);
        bis_mesh_clear(&m);
        assert_int_equal(bis_accel_new(&grid, &g, &options, NULL), BIS_OK);
        bis_verify_backends(&v, grid, cases[k].two ? grid : NULL, 200);
        assert_int_equal(sscanf(v.tests[0].note, "wrong of %lu rays and %lu from surfaces, %lu of", &rays, &from,
                                &searched), 3);
        assert_true(rays == 200 && from == 0 && searched == cases[k].searched);
        assert_int_equal(verify_failures(&v), 0);
        bis_accel_free(grid);
        bis_geometry_clear(&g);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_backend_that_loses_rays_is_rejected),
        cmocka_unit_test(a_floor_that_shadows_itself_is_found_with_one_backend),
        cmocka_unit_test(a_grazing_ray_may_go_either_way_and_no_other),
        cmocka_unit_test(the_truth_is_always_right),
        cmocka_unit_test(a_backend_that_loses_a_triangle_is_rejected),
        cmocka_unit_test(rays_come_from_all_around_and_leave_to_all_sides),
        cmocka_unit_test(large_scenes_have_fewer_rays_searched),
    };
    return cmocka_run_group_tests_name("verify_accel", tests, NULL, NULL);
}
