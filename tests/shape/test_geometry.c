/* SPDX-License-Identifier: BSD-2-Clause */
/* geometry: meshes become one, quadrics have their boxes, and the surface at a hit lies where exact arithmetic puts it,
 * within its bound; a shadow ray that starts beside it leaves the surface for good, at every scale. */
#include "claim.h"
#include "mesh_help.h"

#include "bis/shape/accel.h"
#include "bis/base/mem.h"
#include "bis/thesis/rng.h"
#include "shape/quadric.h"
#include "shape/rounding.h"

#include <float.h>
#include <stdio.h>
#include <string.h>

static bis_xform scale_then_move(double s, double x)
{
    const bis_xform scale = bis_xform_scale(s, s, s), move = bis_xform_translate(x, x, x);

    return bis_xform_compose(&move, &scale);
}

static bis_mesh triangle_mesh(vec3 a, vec3 b, vec3 c)
{
    bis_mesh m = new_mesh(3, 1);

    m.p[0] = a;
    m.p[1] = b;
    m.p[2] = c;
    for (uint32_t i = 0; i < 3; i++) m.index[i] = i;
    return m;
}

/* ---- meshes ---- */

/* A box's corner has three faces, of any size, cut into one or two triangles each: the angles alone count. */
static void smooth_normals_are_weighted_by_angle_not_by_triangles(void **state)
{
    static const uint32_t faces[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                          {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    bis_mesh m = new_mesh(9, 13);
    for (size_t i = 0; i < 8; i++) m.p[i] = (vec3){(float)(i & 1), 2 * (float)(i >> 1 & 1), 4 * (float)(i >> 2)};
    memcpy(m.index, faces, sizeof faces);
    m.index[36] = m.index[37] = m.index[38] = 8; /* a point: vertex 8 has no proper face */
    assert_int_equal(bis_mesh_smooth_normals(&m, NULL), BIS_OK);
    for (size_t i = 0; i < 8; i++) {
        assert_true(fabs(dot(m.n[i], m.n[i]) - 1) < 1e-6);
        const vec3 out = {i & 1 ? 1 : -1, i >> 1 & 1 ? 1 : -1, i >> 2 ? 1 : -1}; /* all at right angles: sqrt(3) */
        assert_true((double)dot(m.n[i], out) > sqrt(3) - 1e-6);
    }
    assert_true(m.n[8].x == 0 && m.n[8].y == 0 && m.n[8].z == 0);
    const long live = bis_mem_live();
    assert_int_equal(bis_mesh_smooth_normals(&m, NULL), BIS_OK); /* once more: they replace those that were there */
    assert_int_equal(bis_mem_live(), live);
    bis_mesh_clear(&m);
}

/* Random parts, with and without normals and (u, v): each part taken has the corners of its triangles in their order,
    and
 * no vertex twice. Some parts are empty. */
static void parts_are_sorted_and_taken_with_their_vertices(void **state)
{
    enum { N = 200, VERTICES = 50, PARTS = 30 };
    for (int has = 0; has < 4; has++) { /* bits: normals, (u, v) */
        uint32_t index[N][3], part[N];
        uint64_t seed = 5;
        bis_mesh m = new_mesh(VERTICES, N);
        bis_mesh_parts parts;
        m.part = bis_alloc(N, sizeof *m.part);
        if (has & 1) m.n = bis_alloc(VERTICES, sizeof *m.n);
        if (has & 2) m.uv = bis_alloc(VERTICES, sizeof *m.uv);
        for (int i = 0; i < VERTICES; i++) {
            m.p[i].x = (float)i;
            if (m.n) m.n[i].y = (float)(10 + i);
            if (m.uv) m.uv[i].v = (float)(20 + i);
        }
        for (int i = 0; i < N; i++) {
            for (int k = 0; k < 3; k++) index[i][k] = (uint32_t)(VERTICES * random_double(&seed));
            m.part[i] = part[i] = (uint32_t)(PARTS * random_double(&seed)) / 2 * 2;
        }
        memcpy(m.index, index, sizeof index);
        assert_int_equal(bis_mesh_sort_parts(&parts, &m, PARTS, NULL), BIS_OK);
        for (uint32_t k = 0; k < 2 * PARTS; k++) { /* twice: taking a part leaves nothing behind */
            bis_mesh out;
            size_t n = 0;
            assert_int_equal(bis_mesh_take_part(&out, &m, &parts, k % PARTS, NULL), BIS_OK);
            assert_true(!out.n == !m.n && !out.uv == !m.uv && !out.part);
            for (int i = 0; i < N; i++) {
                if (part[i] != k % PARTS) continue;
                for (int c = 0; c < 3; c++) {
                    const uint32_t v = out.index[3 * n + (size_t)c];
                    const float x = (float)index[i][c];
                    assert_true(v < out.n_vertices && out.p[v].x == x && (!out.n || out.n[v].y == 10 + x) &&
                                (!out.uv || out.uv[v].v == 20 + x));
                }
                n++;
            }
            assert_int_equal(out.n_triangles, n);
            for (size_t i = 0; i < out.n_vertices; i++)
                for (size_t j = 0; j < i; j++) assert_true(out.p[i].x != out.p[j].x);
            bis_mesh_clear(&out);
        }
        bis_mesh_parts_clear(&parts);
        bis_mesh_clear(&m);
    }
}

static void what_does_not_fit_into_a_float_or_an_index_is_refused(void **state)
{
    const bis_xform identity = bis_xform_identity(), huge = bis_xform_scale(1e38, 1, 1);
    const bis_quadric q = {BIS_SPHERE, 1, 0, bis_xform_scale(1, 1e39, 1), 0}, ball = {BIS_SPHERE, 1, 0, identity, 0};
    const bis_mesh many = {.n_triangles = UINT32_MAX}, large = {.n_vertices = (size_t)UINT32_MAX + 1};
    bis_geometry g = {0}, full = {.n_triangles = UINT32_MAX - 1};
    bis_diag diag = {0};
    for (int k = 0; k < 7; k++) {
        bis_mesh m = triangle_mesh((vec3){1, 0, 0}, (vec3){5, 2, 3}, (vec3){0, 1, 0});
        if (k == 1) m.index[1] = 3;
        if (k == 2) m.p[2].y = NAN;
        if (k > 2) bis_mesh_clear(&m);
        if (k == 3) m = many;
        if (k == 4) m = large;
        assert_int_equal(k == 5   ? bis_geometry_add_quadric(&g, &q, &diag)
                         : k == 6 ? bis_geometry_add_quadric(&full, &ball, &diag)
                                  : bis_geometry_add_mesh(&g, &m, k ? &identity : &huge, 0, &diag), BIS_INPUT);
        if (k < 3) bis_mesh_clear(&m);
    }
    static const char *const says[7] = {"vertex 1 (5, 2, 3) or its normal", "triangle 0 has index 3", "vertex 2",
                                        " triangles: a scene may have at most", " vertices: a scene may have at most",
                                        "a sphere of radius 1", "at most"};
    for (int k = 0; k < 7; k++)
        if (!strstr(diag.messages[k].text, says[k])) fail_msg("%s", diag.messages[k].text);
    assert_int_equal(bis_geometry_primitives(&g), 0);
    bis_geometry_clear(&g);
    bis_diag_clear(&diag);
}

/* ---- quadrics ---- */

/* Random and not too flat, at distance up to `away`. */
static bis_quadric random_quadric(uint64_t *seed, double away)
{
    const bis_xform scale =
        bis_xform_scale(random_between(seed, 0.3, 2), random_between(seed, 0.3, 2), random_between(seed, -2, -0.3));
    const bis_xform turn =
        bis_xform_rotate(random_between(seed, 0, 360), random_between(seed, 0.1, 1), random_between(seed, -1, 1), 1);
    const bis_xform move =
        bis_xform_translate(random_between(seed, -away, away), random_between(seed, -away, away), away);
    const bis_xform turned = bis_xform_compose(&turn, &scale);

    return (bis_quadric){random_double(seed) < 0.5 ? BIS_SPHERE : BIS_DISK, random_between(seed, 0.5, 2),
                         random_between(seed, -1, 1), bis_xform_compose(&move, &turned), 3};
}

/* A random point of q, in double. */
static void quadric_point(const bis_quadric *q, uint64_t *seed, double p[3])
{
    const vec3 w = random_direction(seed);
    double o[3] = {q->radius * (double)w.x, q->radius * (double)w.y, q->radius * (double)w.z};
    const double phi = random_between(seed, 0, 2 * PI);

    if (q->kind == BIS_DISK) {
        o[0] = q->radius * cos(phi);
        o[1] = q->radius * sin(phi);
        o[2] = q->height;
    }
    for (int i = 0; i < 3; i++) {
        const double *row = q->to_world.m[i];
        p[i] = row[0] * o[0] + row[1] * o[1] + row[2] * o[2] + row[3];
    }
}

static void a_quadrics_box_holds_it_and_is_tight(void **state)
{
    uint64_t seed = 1;
    for (int n = 0; n < 100; n++) {
        bis_geometry g = {0};
        const bis_quadric q = random_quadric(&seed, 5);
        double lo[3] = {1e9, 1e9, 1e9}, hi[3] = {-1e9, -1e9, -1e9};
        assert_int_equal(bis_geometry_add_quadric(&g, &q, NULL), BIS_OK);
        const bis_box box = bis_geometry_bounds(&g, 0);
        const float box_lo[3] = {box.lo.x, box.lo.y, box.lo.z}, box_hi[3] = {box.hi.x, box.hi.y, box.hi.z};
        for (int i = 0; i < 20000; i++) {
            double p[3];
            quadric_point(&q, &seed, p);
            for (int a = 0; a < 3; a++) {
                lo[a] = fmin(lo[a], p[a]);
                hi[a] = fmax(hi[a], p[a]);
            }
        }
        for (int a = 0; a < 3; a++) {
            /* unit directions are floats: 1e-7 of the radius */
            assert_true((double)box_lo[a] <= lo[a] + 1e-6 && hi[a] - 1e-6 <= (double)box_hi[a]);
            assert_true(lo[a] - (double)box_lo[a] < 0.02 && (double)box_hi[a] - hi[a] < 0.02);
        }
        bis_geometry_clear(&g);
    }
}

/* Another road: Newton's search for the nearest root is replaced by a walk in small steps of the implicit function. */
static void a_quadric_is_met_where_its_implicit_function_first_changes_sign(void **state)
{
    enum { STEPS = 4000 };
    uint64_t seed = 2;
    int hits = 0;
    for (int n = 0; n < 300; n++) {
        bis_quadric q = random_quadric(&seed, 2);
        q.kind = BIS_SPHERE;
        const vec3 o = mul(random_direction(&seed), random_between(&seed, 0, 6));
        const vec3 centre = vec3_from(q.to_world.m[0][3], q.to_world.m[1][3], q.to_world.m[2][3]);
        const ray r = {o, mul(normalize(add(sub(centre, o), random_direction(&seed))), 2), 6};
        double before = 0, at = -1;
        for (int i = 0; i <= STEPS; i++) {
            const double t = (double)r.tmax * i / STEPS;
            const double p[3] = {(double)r.o.x + t * (double)r.d.x, (double)r.o.y + t * (double)r.d.y,
                (double)r.o.z + t * (double)r.d.z};
            double value = -q.radius * q.radius;
            for (int a = 0; a < 3; a++) {
                const double *row = q.to_world.inv[a];
                const double x = row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3];
                value += x * x;
            }
            if (i > 0 && before * value < 0) {
                at = t;
                break;
            }
            before = value;
        }
        float t = -1;
        const bool hit = bis_quadric_intersect(&q, &r, &t);
        hits += hit;
        if (at < 0 && hit) assert_true(t > 0); /* grazed within a step */
        if (at >= 0) assert_true(hit && fabs((double)t - at) <= (double)r.tmax / STEPS + 1e-6);
    }
    assert_true(hits > 50);
}

static void a_quadrics_range_is_open_and_tmax_is_kept(void **state)
{
    const bis_quadric sphere = {BIS_SPHERE, 1, 0, bis_xform_identity(), 0},
                      disk = {BIS_DISK, 1, 2, bis_xform_identity(), 0};
    float t = 0;
    assert_true(bis_quadric_intersect(&sphere, &(ray){{0, 0, -3}, {0, 0, 1}, INFINITY}, &t) && t == 2);
    assert_true(bis_quadric_intersect(&sphere, &(ray){{0, 0, -3}, {0, 0, 0.5f}, INFINITY}, &t) && t == 4);
    assert_true(bis_quadric_intersect(&sphere, &(ray){{0, 0, 0}, {0, -0.0f, 1}, INFINITY}, &t) && t == 1);
    assert_true(bis_quadric_intersect(&sphere, &(ray){{0, 0, -1}, {0, 0, 1}, INFINITY}, &t) && t == 2);
    assert_false(bis_quadric_intersect(&sphere, &(ray){{0, 0, -1}, {0, 0, -1}, INFINITY}, &t));
    assert_false(bis_quadric_intersect(&sphere, &(ray){{0, 0, -3}, {0, 0, 1}, 2}, &t));
    assert_true(bis_quadric_intersect(&sphere, &(ray){{0, 0, -3}, {0, 0, 1}, nextafterf(2, 3)}, &t));
    assert_false(bis_quadric_intersect(&sphere, &(ray){{1, 0, 0}, {0, 0, 1}, INFINITY}, &t)); /* touches at t = 0 */
    assert_true(
        bis_quadric_intersect(&disk, &(ray){{1, 0, 0}, {0, 0, 1}, INFINITY}, &t) && t == 2); /* the rim belongs to it */
    assert_false(bis_quadric_intersect(&disk, &(ray){{1.0001f, 0, 0}, {0, 0, 1}, INFINITY}, &t));
    assert_false(bis_quadric_intersect(&disk, &(ray){{0, 0, 2}, {1, 0, 0}, INFINITY}, &t)); /* in its plane */
    assert_false(bis_quadric_intersect(&disk, &(ray){{0, 0, 2}, {0, 0, 1}, INFINITY}, &t));
}

/* ---- the surface ---- */

/* Is |a| <= b for each component, with nothing that is NaN? */
static bool within(const double a[3], vec3 b)
{
    return fabs(a[0]) <= (double)b.x && fabs(a[1]) <= (double)b.y && fabs(a[2]) <= (double)b.z;
}

/* Where a ray from o through a point of the shape meets it, is that point. The disk at z = 3 and the ball about the
 * middle, of radius 2, stand in the world by: x' = 4 + 2 y, y' = -1 + 3 z, z' = 5 + x. So the disk's plane is y' = 8.
 */
static void a_quadrics_point_is_where_the_ray_was_aimed(void **state)
{
    static const double columns[16] = {0, 0, 1, 0, 2, 0, 0, 0, 0, 3, 0, 0, 4, -1, 5, 1};
    bis_quadric q[2] = {{BIS_DISK, 2, 3, bis_xform_identity(), 7}, {BIS_SPHERE, 2, 0, bis_xform_identity(), 7}};
    bis_rng rng;
    bis_rng_init(&rng, 31, 0, 0, 0);
    for (int k = 0; k < 2; k++) {
        assert_true(bis_xform_from_columns(&q[k].to_world, columns));
        for (int i = 0; i < 2000; i++) {
            const double z = 1 - 2 * bis_rng_double(&rng), phi = 2 * PI * bis_rng_double(&rng),
                         far = 2 * sqrt(fmax(0, 1 - z * z));
            const double at[3] = {far * cos(phi), far * sin(phi), k == 0 ? 3 : 2 * z};
            const double w[3] = {4 + 2 * at[1], -1 + 3 * at[2], 5 + at[0]}; /* in the world */
            const double n[3] = {
                k == 0 ? 0 : at[1] / 2, k == 0 ? 1 : at[2] / 3, k == 0 ? 0 : at[0]}; /* of x^2 + y^2 + z^2 */
            const double up = k == 0 && i % 2 ? -1 : 1, d = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]) * up;
            double from[3];
            for (int c = 0; c < 3; c++)
                from[c] = w[c] + 6 * n[c] / d + (bis_rng_double(&rng) - 0.5); /* outside; slanted */
            const vec3 o = vec3_from(from[0], from[1], from[2]), to = vec3_from(w[0], w[1], w[2]);
            const ray r = {o, normalize(sub(to, o)), INFINITY};
            bis_surface s;
            float t;
            if (k == 0 && far > 1.999) continue; /* too near the rim for a float */
            assert_true(bis_quadric_intersect(&q[k], &r, &t));
            bis_quadric_surface(&q[k], &r, &s);
            assert_true(fabs((double)t - (double)length(sub(to, o))) < 1e-4);
            assert_true((double)length(sub(s.p, to)) < 1e-4);
            assert_true((double)length(sub(s.ng, vec3_from(n[0] / d, n[1] / d, n[2] / d))) < 1e-4);
            assert_int_equal(s.material, 7);
        }
    }
}

/* The ray's exact point on the plane, in long double, against p: off the plane by no more than the error box allows. */
static void a_triangles_point_lies_within_its_error_of_the_plane_and_of_the_ray(void **state)
{
    uint64_t seed = 3;
    for (int n = 0; n < 20000; n++) {
        const double scale = pow(10, random_between(&seed, -6, 6)), move = n % 3 ? 0 : 1e6 * random_double(&seed);
        vec3 v[3];
        for (int i = 0; i < 3; i++) {
            v[i] = vec3_from(move + scale * random_between(&seed, -1, 1), move + scale * random_between(&seed, -1, 1),
                             scale * random_between(&seed, -1, 1));
        }
        const vec3 target = mul(add(add(v[0], v[1]), v[2]), 1.0 / 3);
        const vec3 o = add(target, mul(random_direction(&seed), scale * 10));
        const ray r = {o, sub(target, o), INFINITY};
        long double e[2][3], x[3], nn[3], size = 0, off = 0, reach = 0;
        const float flat[3][3] = {{v[0].x, v[0].y, v[0].z}, {v[1].x, v[1].y, v[1].z}, {v[2].x, v[2].y, v[2].z}};
        for (int a = 0; a < 3; a++) {
            e[0][a] = (long double)flat[1][a] - (long double)flat[0][a];
            e[1][a] = (long double)flat[2][a] - (long double)flat[0][a];
        }
        for (int a = 0; a < 3; a++)
            nn[a] = e[0][(a + 1) % 3] * e[1][(a + 2) % 3] - e[0][(a + 2) % 3] * e[1][(a + 1) % 3];
        for (int a = 0; a < 3; a++) size += nn[a] * nn[a];
        if (size == 0) continue;
        bis_geometry g = {0};
        bis_mesh m = triangle_mesh(v[0], v[1], v[2]);
        bis_surface s;
        add_mesh(&g, &m, NULL, 0);
        bis_geometry_surface(&g, 0, &r, &s);
        const float at[3] = {s.p.x, s.p.y, s.p.z}, error[3] = {s.p_error.x, s.p_error.y, s.p_error.z};
        for (int a = 0; a < 3; a++) {
            x[a] = (long double)at[a] - (long double)flat[0][a];
            off += nn[a] * x[a];
            reach += fabsl(nn[a]) * (long double)error[a];
        }
        assert_true(fabsl(off) <= reach);
        assert_true(vec3_is_finite(s.p) && vec3_is_finite(s.n) && fabs(length(s.ng) - 1) < 1e-6);
        assert_true(dot(s.ng, r.d) <= 0);
        bis_geometry_clear(&g);
    }
}

/* From 10^13 radii away t is known to 10^-3 of a radius. The point lies on the ball all the same. */
static void a_point_of_a_ball_is_at_its_radius_from_however_far(void **state)
{
    for (int i = 0; i < 6; i++) {
        const double side = i < 3 ? 1 : -1;
        double from[3], d[3];
        bis_surface s;
        for (int c = 0; c < 3; c++) {
            from[c] = c == i % 3 ? 1e13 * side : c == (i + 1) % 3 ? 0.7 : 0.6;
            d[c] = c == i % 3 ? -side : 0;
        }
        const bis_quadric q = {BIS_SPHERE, 1, 0, bis_xform_identity(), 0};
        const ray r = {vec3_from(from[0], from[1], from[2]), vec3_from(d[0], d[1], d[2]), INFINITY};
        bis_quadric_surface(&q, &r, &s);
        assert_true(fabs((double)length(s.p) - 1) < 2e-7 && fabs((double)length(s.ng) - 1) < 2e-7);
        assert_true(fabs((double)dot(s.p, s.ng) - 1) < 2e-7 && (double)dot(s.ng, r.d) < 0);
    }
}

static void a_quadrics_point_lies_within_its_error_of_the_surface(void **state)
{
    uint64_t seed = 5;
    int hits = 0;
    for (int n = 0; n < 20000; n++) {
        bis_quadric q = random_quadric(&seed, n % 2 ? 2 : 1e5);
        const bis_xform scale = scale_then_move(pow(10, random_between(&seed, -6, 6)), 0);
        q.to_world = bis_xform_compose(&scale, &q.to_world);
        bis_geometry g = {0};
        double target[3], off[3];
        bis_surface s;
        float t;
        quadric_point(&q, &seed, target);
        const vec3 p = vec3_from(target[0], target[1], target[2]);
        const vec3 o = add(p, mul(random_direction(&seed), length(p)));
        const ray r = {o, sub(p, o), INFINITY};
        if (!bis_quadric_intersect(&q, &r, &t)) continue;
        hits++;
        assert_int_equal(bis_geometry_add_quadric(&g, &q, NULL), BIS_OK);
        bis_geometry_surface(&g, 0, &r, &s);
        /* Nearest point of the surface, in long double: to object space, onto the shape, back. */
        const float at[3] = {s.p.x, s.p.y, s.p.z};
        long double object[3], size = 0;
        for (int a = 0; a < 3; a++) {
            const double *row = q.to_world.inv[a];
            object[a] = (long double)row[0] * (long double)at[0] + (long double)row[1] * (long double)at[1] +
                        (long double)row[2] * (long double)at[2] + (long double)row[3];
            size += object[a] * object[a];
        }
        for (int a = 0; a < 3; a++) {
            if (q.kind == BIS_SPHERE) object[a] *= (long double)q.radius / sqrtl(size);
        }
        if (q.kind == BIS_DISK) object[2] = (long double)q.height;
        for (int a = 0; a < 3; a++) {
            const double *row = q.to_world.m[a];
            const long double back = (long double)row[0] * object[0] + (long double)row[1] * object[1] +
                                     (long double)row[2] * object[2] + (long double)row[3];
            off[a] = (double)((long double)at[a] - back);
        }
        /* The radial projection is not the nearest point: at most the axes' ratio, here 7 squared, farther. */
        const float most = (float)(50 * length(s.p_error));
        const vec3 allowed = {most, most, most};
        assert_true(within(off, allowed));
        assert_true(fabs(length(s.ng) - 1) < 1e-6 && dot(s.ng, r.d) <= 0);
        bis_geometry_clear(&g);
    }
    assert_true(hits > 10000);
}

static void normals_are_turned_to_the_eyes_side(void **state)
{
    const vec3 a = {0, 0, 0}, b = {1, 0, 0}, c = {0, 1, 0};
    for (int side = 0; side < 2; side++) {
        for (int kind = 0; kind < 5; kind++) {
            const float z = side ? 1.0f : -1.0f;
            const ray r = {{0.25f, 0.25f, z}, {0, 0, -z}, INFINITY};
            bis_geometry g = {0};
            bis_mesh m = triangle_mesh(a, b, c);
            bis_surface s;
            if (kind > 0) {
                m.n = bis_alloc(3, sizeof *m.n);
                /* 1: along z; 2: against; 3: all (0,0,0); 4: they cancel at (1/4, 1/4): n0/2 + n1/4 + n2/4 */
                for (int i = 0; i < 3; i++) {
                    m.n[i] = (vec3){kind == 4 ? (i == 0 ? 1.0f : -1.0f) : 0, 0,
                        kind == 1   ? 2.0f
                        : kind == 2 ? -3.0f
                                    : 0.0f};
                }
            }
            add_mesh(&g, &m, NULL, 0);
            bis_geometry_surface(&g, 0, &r, &s);
            assert_true(s.ng.x == 0 && s.ng.y == 0 && s.ng.z == z);
            assert_true(s.n.x == 0 && s.n.y == 0 && s.n.z == z);
            bis_geometry_clear(&g);
        }
    }
}

static void a_zero_vertex_normal_is_the_faces_in_the_interpolation(void **state)
{
    const ray r = {{0.25f, 0.25f, 1}, {0, 0, -1}, INFINITY};
    bis_geometry g = {0};
    bis_mesh m = triangle_mesh((vec3){0, 0, 0}, (vec3){1, 0, 0}, (vec3){0, 1, 0});
    bis_surface s;
    m.n = bis_alloc(3, sizeof *m.n);
    m.n[0] = (vec3){1, 0, 0};
    add_mesh(&g, &m, NULL, 0);
    bis_geometry_surface(&g, 0, &r, &s);
    assert_true(fabs((double)s.n.x - sqrt(0.5)) < 1e-6 && fabs((double)s.n.z - sqrt(0.5)) < 1e-6); /* (1/2, 0, 1/2) */
    bis_geometry_clear(&g);
}

/* ---- leaving a surface ---- */

/* ng and w are unit vectors of floats, each 2^-24 sqrt(3) off: below four times that a direction has no side. */
#define GRAZING (4 * 1.7320508 * 0x1p-24)

static void for_each_backend(
    void (*check)(const bis_accel *a, const bis_geometry *g, double scale), const bis_geometry *g, double scale)
{
    const bis_accel_kind kinds[] = {BIS_ACCEL_GRID, BIS_ACCEL_EMBREE};

    for (int i = 0; i < (bis_accel_embree_version() ? 2 : 1); i++) {
        bis_accel *a;
        assert_int_equal(bis_accel_new(&a, g, &(bis_accel_options){kinds[i], 0, 1, NULL}, NULL), BIS_OK);
        check(a, g, scale);
        bis_accel_free(a);
    }
}

static vec3 box_point(const bis_box *b, uint64_t *seed)
{
    return vec3_from(random_between(seed, (double)b->lo.x, (double)b->hi.x),
        random_between(seed, (double)b->lo.y, (double)b->hi.y), random_between(seed, (double)b->lo.z, (double)b->hi.z));
}

/* Eyes around a convex body: what leaves a point into the outer hemisphere never comes back. */
static void expect_no_shadow_outside(const bis_accel *a, const bis_geometry *g, double scale)
{
    uint64_t seed = 6;
    int hits = 0;

    for (int n = 0; n < 20000; n++) {
        const vec3 target = box_point(&g->box, &seed), eye = add(target, mul(random_direction(&seed), 5 * scale));
        const ray r = {eye, sub(target, eye), INFINITY};
        bis_hit hit;
        bis_surface s;
        if (!bis_accel_intersect(a, &r, &hit)) continue;
        hits++;
        bis_geometry_surface(g, hit.prim, &r, &s);
        for (int k = 0; k < 4; k++) {
            vec3 w = random_direction(&seed);
            if (k == 3) w = normalize(add(w, mul(s.ng, -dot(w, s.ng) * (1 - 1e-4)))); /* grazing */
            if (dot(w, s.ng) < 0) w = neg(w);
            if (dot(w, s.ng) < GRAZING) continue;
            const ray shadow = {bis_surface_offset(&s), w, INFINITY};
            bis_hit other;
            if (!bis_accel_occluded(a, &shadow)) continue;
            /* Near an edge a grazing ray passes the next face at a few ulps, and so wide are Embree's edges. */
            assert_true(bis_accel_intersect(a, &shadow, &other));
            assert_true(other.prim != hit.prim && other.prim < g->n_triangles && is_tie(g, other.prim, &shadow, 4));
        }
    }
    assert_true(hits > 3000);
}

/* Eyes inside a closed body: no light from outside. */
static void expect_darkness_inside(const bis_accel *a, const bis_geometry *g, double scale)
{
    const vec3 centre = mul(add(g->box.lo, g->box.hi), 0.5);
    uint64_t seed = 7;

    for (int n = 0; n < 20000; n++) {
        const ray r = {centre, random_direction(&seed), INFINITY};
        bis_hit hit;
        bis_surface s;
        assert_true(bis_accel_intersect(a, &r, &hit));
        bis_geometry_surface(g, hit.prim, &r, &s);
        vec3 w = random_direction(&seed);
        if (dot(w, s.ng) < 0) w = neg(w);
        if (dot(w, s.ng) < GRAZING) continue;
        if (bis_accel_occluded(a, &(ray){bis_surface_offset(&s), w, INFINITY})) continue;
        /* On an edge, rounding may put p outside the next face. */
        assert_true(hit.prim < g->n_triangles && is_tie(g, hit.prim, &r, 4));
    }
}

static bis_mesh cube_mesh(void)
{
    static const uint32_t faces[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                          {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    bis_mesh m = new_mesh(8, 12);

    for (size_t i = 0; i < 8; i++)
        m.p[i] = (vec3){(float)(i & 1) - 0.5f, (float)(i >> 1 & 1) - 0.5f, (float)(i >> 2) - 0.5f};
    memcpy(m.index, faces, sizeof faces);
    return m;
}

/* At the weights 1/2, 1/8, 3/8 of the corners: from the corners' (u, v), or, if one of them has none, from pbrt's, (0,
 * 0), (1, 0) and (1, 1). */
static void a_corner_without_coordinates_gives_its_triangle_pbrts(void **state)
{
    const ray r = {{0.5f, 1.5f, 3}, {0, 0, -1}, INFINITY};
    for (int without = 0; without < 4; without++) { /* a corner; 3: none */
        bis_geometry g = {0};
        bis_mesh m = triangle_mesh((vec3){0, 0, 1}, (vec3){4, 0, 1}, (vec3){0, 4, 1});
        double uv[2];
        m.uv = bis_alloc(3, sizeof *m.uv);
        for (int k = 0; k < 3; k++) m.uv[k] = (bis_uv){k == without ? NAN : (float)(8 * k * k + 8), (float)(16 * k)};
        add_mesh(&g, &m, NULL, 0);
        bis_geometry_uv(&g, 0, &r, uv);
        assert_true(fabs(uv[0] - (without == 3 ? 4 + 2 + 15 : 0.5)) < 1e-12);
        assert_true(fabs(uv[1] - (without == 3 ? 2 + 12 : 0.375)) < 1e-12);
        bis_geometry_clear(&g);
    }
}

/* Scales and shifts of a scene; the body's size after a shift by 1e6 must be many ulps (1/16) there, or a mesh is not
 * convex. */
static const struct {
    double scale, move;
} placements[] = {{1, 0}, {1e-6, 0}, {1e6, 0}, {1e3, 1e6}, {1e6, 1e6}, {1e-6, 1}};

static void a_convex_mesh_never_shadows_itself_nor_leaks(void **state)
{
    for (size_t i = 0; i < sizeof placements / sizeof placements[0]; i++) {
        const bis_xform place = scale_then_move(placements[i].scale, placements[i].move);
        const bis_xform turn = bis_xform_rotate(33, 1, 2, 3), turned = bis_xform_compose(&place, &turn);
        if (placements[i].scale < 1 && placements[i].move > 0) continue; /* 8 ulps across: no convex mesh */
        for (int kind = 0; kind < 3; kind++) {
            bis_geometry g = {0};
            bis_mesh m = kind == 2 ? sphere_mesh(16) : cube_mesh();
            add_mesh(&g, &m, kind == 0 ? &place : &turned, 0);
            /* A turned cube's faces and a sphere's quads are planar but for rounding: not convex, by ulps. */
            if (kind == 0) for_each_backend(expect_no_shadow_outside, &g, placements[i].scale);
            for_each_backend(expect_darkness_inside, &g, placements[i].scale);
            bis_geometry_clear(&g);
        }
    }
}

static void spheres_never_shadow_themselves_nor_leak_E37(void **state)
{
    for (size_t i = 0; i < sizeof placements / sizeof placements[0]; i++) {
        const bool tiny =
            placements[i].scale < 1 && placements[i].move > 0; /* stretched, its least axis would have 3 ulps */
        for (int kind = 0; kind < (tiny ? 1 : 2); kind++) {
            const bis_xform place = scale_then_move(placements[i].scale, placements[i].move);
            const bis_xform stretch = bis_xform_scale(1, kind ? 0.4 : 1, kind ? 1.7 : 1),
                            turn = bis_xform_rotate(50, 1, 1, -2);
            const bis_xform turned = bis_xform_compose(&turn, &stretch);
            const bis_quadric q = {BIS_SPHERE, 1, 0, bis_xform_compose(&place, &turned), 0};
            bis_geometry g = {0};
            assert_int_equal(bis_geometry_add_quadric(&g, &q, NULL), BIS_OK);
            for_each_backend(expect_no_shadow_outside, &g, placements[i].scale);
            for_each_backend(expect_darkness_inside, &g, placements[i].scale);
            bis_geometry_clear(&g);
        }
    }
}

/* Both sides of a large tilted floor, near its middle: Embree's float arithmetic is off by its size, not by p's. */
static void a_large_tilted_plane_never_shadows_itself(void **state)
{
    uint64_t seed = 8;
    for (int n = 0; n < 200; n++) {
        const double size = pow(10, random_between(&seed, -6, 6));
        const frame f = frame_about(random_direction(&seed));
        const vec3 centre = mul(random_direction(&seed), size * random_between(&seed, 0, 2));
        bis_geometry g = {0};
        bis_mesh m = new_mesh(4, 2);
        static const uint32_t faces[] = {0, 1, 2, 0, 2, 3};
        for (int i = 0; i < 4; i++) {
            m.p[i] = add(centre, add(mul(f.x, i == 0 || i == 3 ? -size : size), mul(f.y, i < 2 ? -size : size)));
        }
        memcpy(m.index, faces, sizeof faces);
        add_mesh(&g, &m, NULL, 0);
        for (int kind = 0; kind < (bis_accel_embree_version() ? 2 : 1); kind++) {
            bis_accel *a;
            const bis_accel_options options = {kind ? BIS_ACCEL_EMBREE : BIS_ACCEL_GRID, 0, 1, NULL};
            assert_int_equal(bis_accel_new(&a, &g, &options, NULL), BIS_OK);
            for (int i = 0; i < 500; i++) {
                const double u = random_between(&seed, -1, 1), v = random_between(&seed, -1, 1);
                const vec3 target = add(centre, add(mul(f.x, size * u * u * u), mul(f.y, size * v * v * v)));
                const vec3 o = add(target, mul(random_direction(&seed), size));
                const ray r = {o, sub(target, o), INFINITY};
                bis_hit hit;
                bis_surface s;
                if (!bis_accel_intersect(a, &r, &hit)) continue;
                bis_geometry_surface(&g, hit.prim, &r, &s);
                /* The two triangles are one plane but for rounding: only the one that was hit is the claim. */
                vec3 w = random_direction(&seed);
                if (dot(w, s.ng) < 0) w = neg(w);
                const ray shadow = {bis_surface_offset(&s), w, INFINITY};
                bis_hit again;
                assert_false(dot(w, s.ng) > 0 && bis_accel_intersect(a, &shadow, &again) && again.prim == hit.prim);
            }
            bis_accel_free(a);
        }
        bis_geometry_clear(&g);
    }
}

/* The twin: without the offset a ray often meets what it starts from, or the tests above would see nothing. */
static void without_the_offset_a_point_does_shadow_itself_E37(void **state)
{
    const bis_quadric q = {BIS_SPHERE, 1, 0, bis_xform_translate(3, 3, 3), 0};
    uint64_t seed = 10;
    int shadowed = 0;
    bis_geometry g = {0};
    bis_accel *a;
    assert_int_equal(bis_geometry_add_quadric(&g, &q, NULL), BIS_OK);
    assert_int_equal(bis_accel_new(&a, &g, &(bis_accel_options){BIS_ACCEL_GRID, 0, 1, NULL}, NULL), BIS_OK);
    for (int n = 0; n < 1000; n++) {
        const ray r = {{0, 0, 0}, sub(box_point(&g.box, &seed), (vec3){0, 0, 0}), INFINITY};
        bis_hit hit;
        bis_surface s;
        if (!bis_accel_intersect(a, &r, &hit)) continue;
        bis_geometry_surface(&g, 0, &r, &s);
        shadowed += bis_accel_occluded(a, &(ray){s.p, s.ng, INFINITY});
    }
    assert_true(shadowed > 100);
    bis_accel_free(a);
    bis_geometry_clear(&g);
}

/* ---- rounding ---- */

/* The C library's nextafterf says what the neighbours are: the float is on its side of v, and the next one is not. */
static void rounded_numbers_are_the_nearest_floats_on_their_side(void **state)
{
    const double special[] = {
        0, -0.0, 1e-60, 0x1p-149, 0x1p-150, 0x1p-126, 1, 1 + 0x1p-24, 1 - 0x1p-30, (double)FLT_MAX};
    bis_rng r;

    bis_rng_init(&r, 7, 0, 0, 0);
    for (int i = 0; i < 200000; i++) {
        const double size = i < 20 ? special[i / 2] : ldexp(1 + bis_rng_double(&r), (int)(bis_rng_u64(&r) % 280) - 153);
        const double v = i % 2 ? -size : size;
        const float up = round_up(v), down = round_down(v);
        assert_true((double)up >= v && (double)nextafterf(up, -INFINITY) < v);
        assert_true((double)down <= v && (double)nextafterf(down, INFINITY) > v);
    }
}

/* Triangles at z = 0 and 1, with and without normals of their own: what has none faces as it lies. */
static void a_mesh_without_normals_beside_one_with_them_is_flat(void **state)
{
    for (int has = 0; has < 4; has++) { /* bit k: mesh k has normals */
        bis_geometry g = {0};
        for (int k = 0; k < 2; k++) {
            const float z = (float)k;
            bis_mesh m = triangle_mesh((vec3){0, 0, z}, (vec3){1, 0, z}, (vec3){0, 1, z});
            if (has >> k & 1) m.n = bis_alloc(3, sizeof *m.n);
            for (int i = 0; i < 3 && m.n; i++) m.n[i] = (vec3){0.6f, 0, 0.8f};
            add_mesh(&g, &m, NULL, 0);
        }
        for (uint32_t k = 0; k < 2; k++) {
            const ray r = {{0.25f, 0.25f, 9}, {0, 0, -1}, INFINITY};
            bis_surface s;
            bis_geometry_surface(&g, k, &r, &s);
            assert_true(fabs((double)s.n.x - (has >> k & 1 ? 0.6 : 0)) < 1e-6 && s.p.z == (float)k && s.ng.z == 1);
        }
        bis_geometry_clear(&g);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_mesh_without_normals_beside_one_with_them_is_flat),
        cmocka_unit_test(what_does_not_fit_into_a_float_or_an_index_is_refused),
        cmocka_unit_test(smooth_normals_are_weighted_by_angle_not_by_triangles),
        cmocka_unit_test(parts_are_sorted_and_taken_with_their_vertices),
        cmocka_unit_test(a_quadrics_box_holds_it_and_is_tight),
        cmocka_unit_test(a_quadric_is_met_where_its_implicit_function_first_changes_sign),
        cmocka_unit_test(a_quadrics_point_is_where_the_ray_was_aimed),
        cmocka_unit_test(a_quadrics_range_is_open_and_tmax_is_kept),
        cmocka_unit_test(a_triangles_point_lies_within_its_error_of_the_plane_and_of_the_ray),
        cmocka_unit_test(a_point_of_a_ball_is_at_its_radius_from_however_far),
        cmocka_unit_test(a_quadrics_point_lies_within_its_error_of_the_surface),
        cmocka_unit_test(normals_are_turned_to_the_eyes_side),
        cmocka_unit_test(a_zero_vertex_normal_is_the_faces_in_the_interpolation),
        cmocka_unit_test(a_corner_without_coordinates_gives_its_triangle_pbrts),
        cmocka_unit_test(a_convex_mesh_never_shadows_itself_nor_leaks),
        cmocka_unit_test(spheres_never_shadow_themselves_nor_leak_E37),
        cmocka_unit_test(a_large_tilted_plane_never_shadows_itself),
        cmocka_unit_test(without_the_offset_a_point_does_shadow_itself_E37),
        cmocka_unit_test(rounded_numbers_are_the_nearest_floats_on_their_side),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
