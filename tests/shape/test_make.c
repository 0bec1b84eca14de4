/* SPDX-License-Identifier: BSD-2-Clause */
/* make: shapes that become meshes. Surfaces of revolution are measured by their implicit equations, NURBS by a sphere,
 * Loop's subdivision by powers of its matrix around a vertex, which the test sets up from the rules alone. */
#include "bis/base/mem.h"
#include "bis/shape/make.h"
#include "claim.h"
#include "mesh_help.h"

#include <stdio.h>
#include <string.h>

#define N_POINTS 20000

static void d3(double out[3], vec3 v)
{
    out[0] = (double)v.x;
    out[1] = (double)v.y;
    out[2] = (double)v.z;
}

static void unit3(double a[3])
{
    const double size = sqrt(dot3(a, a));
    for (int c = 0; c < 3; c++) a[c] /= size;
}

/* A point of a random triangle with area: p, its interpolated unit normal and (u, v). */
typedef struct sample {
    double p[3], n[3], uv[2];
} sample;

static bool draw(sample *out, const bis_mesh *m, uint64_t *state)
{
    const size_t i = (size_t)(random_double(state) * (double)m->n_triangles);
    double b[3] = {random_double(state), random_double(state), 0}, v[3], w[3];
    if (b[0] + b[1] > 1) {
        b[0] = 1 - b[0];
        b[1] = 1 - b[1];
    }
    b[2] = 1 - b[0] - b[1];
    *out = (sample){{0}, {0}, {0}};
    double corner[3][3];
    for (int k = 0; k < 3; k++) {
        const uint32_t at = m->index[3 * i + (size_t)k];
        d3(corner[k], m->p[at]);
        d3(w, m->n ? m->n[at] : (vec3){0, 0, 1});
        for (int c = 0; c < 3; c++) {
            out->p[c] += b[k] * corner[k][c];
            out->n[c] += b[k] * w[c];
        }
        out->uv[0] += b[k] * (double)m->uv[at].u;
        out->uv[1] += b[k] * (double)m->uv[at].v;
    }
    for (int c = 0; c < 3; c++) {
        v[c] = corner[1][c] - corner[0][c];
        w[c] = corner[2][c] - corner[0][c];
    }
    const double area[3] = {v[1] * w[2] - v[2] * w[1], v[2] * w[0] - v[0] * w[2], v[0] * w[1] - v[1] * w[0]};
    if (!(dot3(area, area) > 1e-20)) return false; /* at a pole */
    unit3(out->n);
    return true;
}

/* ---- surfaces of revolution ---- */

/* What pbrt says of a shape: the radius of the circle at height z, and v there. */
typedef struct shape {
    const char *name;
    bis_revolved r;
    double (*radius)(double z);
    double (*v)(double z, double radius);
    double height;
    size_t pieces[2]; /* around, of 256 for a whole turn; along: a line 1, a skew one 256, a curve 128 */
} shape;

static double radius_cylinder(double z) { (void)z; return 2; }
static double v_cylinder(double z, double r) { (void)r; return (z + 1) / 4; }
static double radius_cone(double z) { return 1.5 * (1 - z / 3); }
static double v_cone(double z, double r) { (void)r; return z / 3; }
static double radius_parabola(double z) { return 2 * sqrt(z / 3); }
static double v_parabola(double z, double r) { (void)r; return (z - .5) / 2.5; }
static double radius_sphere(double z) { return sqrt(fmax(4 - z * z, 0)); }
static double v_sphere(double z, double r) { return (acos(z / hypot(z, r)) - acos(-.5)) / (acos(.75) - acos(-.5)); }
/* from (1, 0.5, -1) to (-0.5, 1, 1) */
static double radius_skew(double z)
{
    const double t = (z + 1) / 2;
    return hypot(1 - 1.5 * t, .5 + .5 * t);
}
static double v_skew(double z, double r) { (void)r; return (z + 1) / 2; }
static double radius_tip(double z) { return z + 1; }

static const shape shapes[] = {
    {"cylinder", {.p = {{2, 0, -1}, {2, 0, 3}}, .phi_max_deg = 360}, radius_cylinder, v_cylinder, 4, {256, 1}},
    {"part of a cylinder", {.p = {{2, 0, -1}, {2, 0, 3}}, .phi_max_deg = 100}, radius_cylinder, v_cylinder, 4,
     {72, 1}}, /* 71.1 pieces */
    {"cone", {.p = {{1.5, 0, 0}, {0, 0, 3}}, .phi_max_deg = 360}, radius_cone, v_cone, 3, {256, 1}},
    {"cone on its tip", {.p = {{0, 0, -1}, {2, 0, 1}}, .phi_max_deg = 360}, radius_tip, v_skew, 2, {256, 1}},
    {"paraboloid", {.profile = BIS_PROFILE_PARABOLA, .radius = 2, .z = {.5, 3}, .phi_max_deg = 360}, radius_parabola,
     v_parabola, 3, {256, 128}},
    {"sphere", {.profile = BIS_PROFILE_CIRCLE, .radius = 2, .z = {-1, 1.5}, .phi_max_deg = 270}, radius_sphere,
     v_sphere, 2, {192, 128}},
    {"hyperboloid", {.p = {{1, .5, -1}, {-.5, 1, 1}}, .phi_max_deg = 360}, radius_skew, v_skew, 2, {256, 256}},
    /* in a plane with the axis, whichever plane that is */
    {"cylinder over y", {.p = {{0, 2, -1}, {0, 2, 3}}, .phi_max_deg = 360}, radius_cylinder, v_cylinder, 4, {256, 1}},
    {"cylinder between", {.p = {{1.6, -1.2, -1}, {1.6, -1.2, 3}}, .phi_max_deg = 360}, radius_cylinder, v_cylinder, 4,
     {256, 1}},
};

/* The angle by which the profile's point at height z is turned to p, over phi_max. */
static double u_of(const shape *s, const double p[3], double v)
{
    double phi = atan2(p[1], p[0]);
    if (s->r.profile == BIS_PROFILE_LINE && s->r.p[0][1] != 0)
        phi -= atan2((1 - v) * s->r.p[0][1] + v * s->r.p[1][1], (1 - v) * s->r.p[0][0] + v * s->r.p[1][0]);
    const double u = phi / (2 * PI);
    return (u - floor(u)) * 360 / s->r.phi_max_deg;
}

/* Outside is where pbrt's dpdu x dpdv points: away from the axis for all of these. */
static void check_point(const shape *s, const sample *at, double *furthest, double *most_tilted)
{
    const double r = hypot(at->p[0], at->p[1]), h = 1e-6, z = at->p[2];
    const double slope = (s->radius(z + h) - s->radius(z - h)) / (2 * h);
    const double away = fabs(r - s->radius(z)) / hypot(1, slope), v = s->v(z, r);
    double n[3] = {at->p[0] / r, at->p[1] / r, -slope};
    unit3(n);
    assert_true(isfinite(away) && isfinite(dot3(n, at->n))); /* fmax passes over what is not a number */
    *furthest = fmax(*furthest, away);
    *most_tilted = fmax(*most_tilted, acos(fmin(dot3(n, at->n), 1)));
    assert_true(fabs(at->uv[1] - v) < 2e-3);
    const double u = u_of(s, at->p, v);
    /* near the seam u may be 0 or 1 */
    if (u > .01 && u < .99) assert_true(fabs(at->uv[0] - u) < 1. / 256 + 1e-6);
}

static void revolved_meshes_lie_on_the_implicit_surfaces(void **state)
{
    double worst = 0;
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
        const shape *s = &shapes[i];
        uint64_t random = i;
        double furthest = 0, tilted = 0, size = s->height;
        bis_mesh m;
        sample at;
        assert_int_equal(bis_make_revolved(&m, &s->r, (bis_loc){0}, NULL), BIS_OK);
        assert_sound(&m);
        assert_int_equal(m.n_triangles, 2 * s->pieces[0] * s->pieces[1]);
        assert_int_equal(m.n_vertices, (s->pieces[0] + 1) * (s->pieces[1] + 1));
        for (size_t k = 0; k < m.n_vertices; k++) size = fmax(size, hypot((double)m.p[k].x, (double)m.p[k].y));
        const bool is_line = s->r.profile == BIS_PROFILE_LINE;
        for (int end = 0; end < 2; end++) { /* the first and the last vertex lie at the ends of the profile */
            const size_t k = end ? m.n_vertices - 1 : 0;
            assert_true(fabs((double)m.p[k].z - (is_line ? s->r.p[end][2] : s->r.z[end])) < 1e-6);
            assert_true(m.uv[k].u == (float)end && fabs((double)m.uv[k].v - end) < 1e-6);
        }
        int n_points = 0;
        for (int k = 0; k < N_POINTS; k++) {
            if (!draw(&at, &m, &random) || !(hypot(at.p[0], at.p[1]) > 1e-3)) continue;
            check_point(s, &at, &furthest, &tilted);
            n_points++;
        }
        assert_true(n_points > N_POINTS / 3); /* half of the triangles of a cone have no area */
        print_message("%-20s %6zu triangles, %.2e of its size away, normals %.4f degrees off\n", s->name, m.n_triangles,
                      furthest / size, tilted * 180 / PI);
        assert_true(furthest < BIS_MAKE_REVOLVED_ERROR * size);
        /* A cone's normals turn by a piece of the turn towards its tip: 360/256 degrees. Else the error is of second
         * order. */
        assert_true(tilted * 180 / PI < (strstr(s->name, "cone") ? 360. / 256 : .1));
        worst = fmax(worst, furthest / size);
        bis_mesh_clear(&m);
    }
    assert_true(4 * worst > BIS_MAKE_REVOLVED_ERROR); /* half as many pieces, 4 times the error, would break it */
}

static void a_ring_is_flat_and_a_whole_turn_closes(void **state)
{
    const bis_revolved ring = {.p = {{2, 0, 1}, {.5, 0, 1}}, .phi_max_deg = 360};
    bis_mesh m;
    assert_int_equal(bis_make_revolved(&m, &ring, (bis_loc){0}, NULL), BIS_OK);
    for (size_t i = 0; i < m.n_vertices; i++) {
        assert_true(m.p[i].z == 1 && m.n[i].z == 1 && m.n[i].x == 0 && m.n[i].y == 0);
        const double r = hypot((double)m.p[i].x, (double)m.p[i].y);
        assert_true(fabs(r - (m.uv[i].v == 0 ? 2 : .5)) < 1e-6); /* as pbrt's disk: v is 0 at the rim */
    }
    const size_t n = m.n_vertices / 2;
    assert_memory_equal(&m.p[0], &m.p[n - 1], sizeof *m.p);
    assert_memory_equal(&m.p[n], &m.p[2 * n - 1], sizeof *m.p);
    bis_mesh_clear(&m);
}

/* ---- patches, height fields, NURBS ---- */

static void patches_lie_on_the_hyperbolic_paraboloid(void **state)
{
    /* z = x y over the unit square, beside a parallelogram, which needs two triangles */
    static const float points[6][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 1}, {2, 0, 0}, {2, 1, 1}};
    static const uint32_t corner[2][4] = {{0, 1, 2, 3}, {1, 4, 3, 5}};
    const double diagonal = sqrt(4 + 1 + 1);
    bis_mesh m = new_mesh(6, 0);
    uint64_t random = 3;
    double furthest = 0;
    sample at;
    memcpy(m.p, points, sizeof points);
    assert_int_equal(bis_make_patches(&m, corner, 2, (bis_loc){0}, NULL), BIS_OK);
    assert_sound(&m);
    /* |twist| = 1: n = ceil(sqrt(1/(4e-4 sqrt 6))) = 32 */
    assert_int_equal(m.n_triangles, 2 * 32 * 32 + 2);
    for (int k = 0; k < N_POINTS; k++) {
        if (!draw(&at, &m, &random) || at.p[0] > 1) continue;
        furthest = fmax(furthest, fabs(at.p[2] - at.p[0] * at.p[1]));
        double n[3] = {-at.p[1], -at.p[0], 1};
        unit3(n);
        assert_true(dot3(n, at.n) > 1 - 1e-6);
        assert_true(fabs(at.uv[0] - at.p[0]) < 1e-6 && fabs(at.uv[1] - at.p[1]) < 1e-6);
    }
    assert_true(furthest < BIS_MAKE_PATCH_ERROR * diagonal && furthest > BIS_MAKE_PATCH_ERROR * diagonal / 2);
    const vec3 n = m.n[m.n_vertices - 1]; /* of the parallelogram: (0, -1, 1)/sqrt 2 */
    assert_true(fabsf(n.x) < 1e-6f && fabs((double)n.z - sqrt(.5)) < 1e-6 && fabs((double)n.y + sqrt(.5)) < 1e-6);
    bis_mesh_clear(&m);
}

static void patches_interpolate_normals_and_coordinates(void **state)
{
    static const uint32_t corner[1][4] = {{0, 1, 2, 3}};
    bis_mesh m = new_mesh(4, 0);
    m.n = bis_alloc(4, sizeof *m.n);
    m.uv = bis_alloc(4, sizeof *m.uv);
    m.p[1] = (vec3){1, 0, 0};
    m.p[2] = (vec3){0, 1, 0};
    m.p[3] = (vec3){1, 1, 0};
    for (int i = 0; i < 4; i++) {
        m.n[i] = (vec3){i == 3, 0, i != 3};
        m.uv[i] = (bis_uv){(float)(3 * i), (float)(i * i)};
    }
    assert_int_equal(bis_make_patches(&m, corner, 1, (bis_loc){0}, NULL), BIS_OK);
    assert_int_equal(m.n_triangles, 2);
    for (int i = 0; i < 4; i++) assert_true(m.n[i].x == (i == 3) && m.n[i].z == (i != 3));
    for (int i = 0; i < 4; i++) assert_true(m.uv[i].u == (float)(3 * i) && m.uv[i].v == (float)(i * i));
    bis_mesh_clear(&m);
}

static void a_height_field_spans_the_unit_square(void **state)
{
    static const double z[12] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};
    static const uint32_t least[6] = {0, 1, 2, 4, 5, 6}; /* the corner of each piece */
    bis_mesh m;
    assert_int_equal(bis_make_height_field(&m, z, 4, 3, (bis_loc){0}, NULL), BIS_OK);
    assert_int_equal(m.n_vertices, 12);
    assert_int_equal(m.n_triangles, 12);
    assert_null(m.n);
    for (size_t i = 0; i < 12; i++) {
        assert_true(m.p[i].x == (float)(i % 4) / 3 && m.p[i].y == (float)(i / 4) / 2 && m.p[i].z == (float)i);
        assert_true(m.uv[i].u == m.p[i].x && m.uv[i].v == m.p[i].y);
    }
    for (size_t i = 0; i < 6; i++) {
        assert_triangle(&m, 2 * i, least[i], least[i] + 1, least[i] + 5);
        assert_triangle(&m, 2 * i + 1, least[i], least[i] + 5, least[i] + 4);
    }
    bis_mesh_clear(&m);
}

/* A quarter of a circle that turns by a quarter of another: rational quadratics give an octant of a sphere exactly. It
 * does not lie around the origin, so that the pole's tangent is rounding noise: the row
 * there has the normals of the faces, the other rows have those of the sphere. pole = 0 has the pole at v = 0. */
static void the_pole_of_a_nurbs_surface_has_the_normals_of_the_faces(void **state)
{
    static const double knots[6] = {2, 2, 2, 4, 4, 4}, quarter[3][2] = {{1, 0}, {1, 1}, {0, 1}};
    static const double centre[3] = {.3, -.7, 1.9};
    for (int pole = 0; pole < 2; pole++) {
        double net[9][4];
        bis_mesh m;
        for (int k = 0; k < 9; k++) {
            const double *up = quarter[pole ? k / 3 : 2 - k / 3], *round = quarter[k % 3];
            const double w = (k % 3 == 1 ? sqrt(.5) : 1) * (k / 3 == 1 ? sqrt(.5) : 1);
            const double p[3] = {up[0] * round[0], up[0] * round[1], up[1]};
            for (int c = 0; c < 3; c++) net[k][c] = w * (centre[c] + .1 * p[c]);
            net[k][3] = w;
        }
        const bis_nurbs s = {{3, 3}, {3, 3}, {knots, knots}, (const double (*)[4])net, {{2, 4}, {2, 4}}};
        assert_int_equal(bis_make_nurbs(&m, &s, (bis_loc){0}, NULL), BIS_OK);
        for (size_t i = 0; i < m.n_vertices; i++) {
            double p[3], n[3];
            d3(p, m.p[i]);
            d3(n, m.n[i]);
            for (int c = 0; c < 3; c++) p[c] = (p[c] - centre[c]) * (pole ? 10 : -10);
            assert_true(fabs(dot3(p, p) - 1) < 1e-5);
            if (i / 65 == (pole ? 64 : 0)) assert_true(n[0] == 0 && n[1] == 0 && n[2] == 0);
            else assert_true(dot3(p, n) > 1 - 1e-5);
        }
        bis_mesh_clear(&m);
    }
}

/* N_i of this order by its definition (Cox and de Boor), right of x, or left of it at the end of the knots. */
static double basis(const double *knot, size_t i, size_t order, double x, double last)
{
    if (order == 1) return knot[i] <= x && (x < knot[i + 1] || (x == last && knot[i] < x && knot[i + 1] == x));
    const double left = knot[i + order - 1] - knot[i], right = knot[i + order] - knot[i + 1];
    return (left > 0 ? (x - knot[i]) / left * basis(knot, i, order - 1, x, last) : 0) +
           (right > 0 ? (knot[i + order] - x) / right * basis(knot, i + 1, order - 1, x, last) : 0);
}

static void nurbs_point(double p[3], const bis_nurbs *s, const double at[2])
{
    double h[4] = {0};
    for (size_t j = 0; j < s->n[1]; j++)
        for (size_t i = 0; i < s->n[0]; i++)
            for (int c = 0; c < 4; c++)
                h[c] += basis(s->knots[0], i, s->order[0], at[0], s->knots[0][s->n[0]]) *
                        basis(s->knots[1], j, s->order[1], at[1], s->knots[1][s->n[1]]) * s->point[j * s->n[0] + i][c];
    for (int c = 0; c < 3; c++) p[c] = h[c] / h[3];
}

/* 6 x 5 points at random heights and weights, orders 3 and 4; simple and double knots inside, one of them on a place
 * where the surface is asked. The normal is by central differences, but at knots. */
static void a_nurbs_surface_is_that_of_its_definition(void **state)
{
    static const double u[9] = {0, 0, 0, 1, 1, 2.5, 4, 4, 4}, v[9] = {-1, -1, -1, -1, 0.75, 2, 2, 2, 2};
    static const double ends[2][2][2] = {{{0, 4}, {-1, 2}}, {{0.5, 3.25}, {-0.5, 1.5}}};
    uint64_t random = 17;
    double net[30][4];
    for (int i = 0; i < 30; i++) {
        const double w = random_between(&random, 0.5, 2);
        const double p[4] = {w * (i % 6), w * (i / 6), w * random_between(&random, -1, 1), w};
        memcpy(net[i], p, sizeof p);
    }
    for (int e = 0; e < 2; e++) {
        bis_nurbs s = {{6, 5}, {3, 4}, {u, v}, (const double (*)[4])net, {{0}}};
        bis_mesh m;
        memcpy(s.end, ends[e], sizeof s.end);
        assert_int_equal(bis_make_nurbs(&m, &s, (bis_loc){0}, NULL), BIS_OK);
        for (size_t i = 0; i < m.n_vertices; i++) {
            const double share[2] = {(double)(i % 65) / 64, (double)(i / 65) / 64}, h = 1e-5;
            double at[2], p[3], q[2][3], n[3], along[2][3];
            bool is_inside = true;
            for (int k = 0; k < 2; k++) at[k] = s.end[k][0] + share[k] * (s.end[k][1] - s.end[k][0]);
            nurbs_point(p, &s, at);
            assert_true(fabs((double)m.p[i].x - p[0]) < 1e-6 && fabs((double)m.p[i].y - p[1]) < 1e-6);
            assert_true(fabs((double)m.p[i].z - p[2]) < 1e-6);
            for (int k = 0; k < 9; k++) is_inside &= fabs(at[0] - u[k]) > h && fabs(at[1] - v[k]) > h;
            if (!is_inside) continue;
            for (int k = 0; k < 2; k++) {
                for (int side = 0; side < 2; side++)
                    nurbs_point(q[side], &s, (double[]){at[0] + (k == 0 ? side ? h : -h : 0),
                                                        at[1] + (k == 1 ? side ? h : -h : 0)});
                for (int c = 0; c < 3; c++) along[k][c] = q[1][c] - q[0][c];
            }
            for (int c = 0; c < 3; c++)
                n[c] = along[0][(c + 1) % 3] * along[1][(c + 2) % 3] - along[0][(c + 2) % 3] * along[1][(c + 1) % 3];
            unit3(n);
            assert_true((double)m.n[i].x * n[0] + (double)m.n[i].y * n[1] + (double)m.n[i].z * n[2] > 1 - 1e-6);
        }
        bis_mesh_clear(&m);
    }
}

/* ---- subdivision ---- */

enum { MOST = 13 };

/* A fan of k triangles around point 0, closed or with a border: random heights over a slightly random circle. */
static bis_mesh fan_mesh(uint32_t k, bool closed, uint64_t *random)
{
    const uint32_t ring = closed ? k : k + 1;
    bis_mesh m = new_mesh(ring + 1, k);
    m.p[0].z = (float)random_double(random);
    for (uint32_t j = 0; j < ring; j++) {
        const double angle = (closed ? 2 * PI : 1.3 * PI) * j / k + .2 * random_double(random);
        m.p[j + 1] = vec3_from(cos(angle) * random_between(random, .7, 1.3), sin(angle), random_double(random));
    }
    for (uint32_t j = 0; j < k; j++) {
        m.index[3 * j + j % 3] = 0; /* any of the corners */
        m.index[3 * j + (j + 1) % 3] = j + 1;
        m.index[3 * j + (j + 2) % 3] = (j + 1) % ring + 1;
    }
    return m;
}

/* The rules around point 0 as a matrix on (point 0, ring): the step takes it and its ring to the new vertex and the new
 * ones on its edges. */
static void step_matrix(double s[MOST][MOST], uint32_t k, bool closed)
{
    const uint32_t ring = closed ? k : k + 1;
    memset(s, 0, MOST * sizeof *s);
    if (closed) {
        const double beta = k == 3 ? 3. / 16 : 3. / (8 * k);
        s[0][0] = 1 - k * beta;
        for (uint32_t j = 1; j <= ring; j++) s[0][j] = beta;
    } else {
        s[0][0] = .75;
        s[0][1] += .125;
        s[0][ring] += .125;
    }
    for (uint32_t j = 1; j <= ring; j++) {
        if (!closed && (j == 1 || j == ring)) {
            s[j][0] = s[j][j] = .5;
            continue;
        }
        s[j][0] += .375;
        s[j][j] += .375;
        s[j][j == 1 ? ring : j - 1] += .125;
        s[j][j == ring ? 1 : j + 1] += .125;
    }
}

/* p after so many steps. */
static void brute(long double p[MOST][3], double s[MOST][MOST], uint32_t n, int steps)
{
    for (int t = 0; t < steps; t++) {
        long double q[MOST][3] = {{0}};
        for (uint32_t i = 0; i < n; i++)
            for (uint32_t j = 0; j < n; j++)
                for (int c = 0; c < 3; c++) q[i][c] += (long double)s[i][j] * p[j][c];
        memcpy(p, q, MOST * sizeof *p);
    }
}

static void check_limit(uint32_t k, bool closed, unsigned levels, uint64_t seed)
{
    uint64_t random = seed;
    bis_mesh m = fan_mesh(k, closed, &random);
    const uint32_t n = (uint32_t)m.n_vertices;
    double s[MOST][MOST], limit[3], at[3], normal[3], expected[3], e[3], f[3];
    long double p[MOST][3] = {{0}}, q[MOST][3];

    for (uint32_t i = 0; i < n; i++) {
        d3(at, m.p[i]);
        for (int c = 0; c < 3; c++) p[i][c] = (long double)at[c];
    }
    step_matrix(s, k, closed);
    memcpy(q, p, sizeof p);
    brute(q, s, n, 200);
    for (int c = 0; c < 3; c++) limit[c] = (double)q[0][c];
    for (uint32_t i = 0; i < n; i++)
        for (int c = 0; c < 3; c++) p[i][c] -= q[0][c]; /* so that the tangents do not drown in it */
    /* The tangent plane: all other parts decay faster; after 60 steps less than 4e-4 of them is left. On a border, the
     * direction along it is that between its points, and that across it shows in sums which are the same from both
     * ends. (Beyond six triangles a further part decays more slowly than that along the border. It cancels in such
     * sums.) One triangle, and three, have no such other parts; their own decay so fast that 60 steps would lose them.
     */
    brute(p, s, n, k == 1 || k == 3 ? 20 : 60);
    for (int c = 0; c < 3; c++) {
        e[c] = (double)(closed ? p[1][c] - p[0][c] : p[n - 1][c] - p[1][c]);
        f[c] = (double)(closed ? p[1 + k / 3][c] - p[0][c] : p[1 + k / 2][c] + p[1 + (k + 1) / 2][c] - 2 * p[0][c]);
    }
    unit3(e);
    unit3(f);
    for (int c = 0; c < 3; c++) expected[c] = e[(c + 1) % 3] * f[(c + 2) % 3] - e[(c + 2) % 3] * f[(c + 1) % 3];
    unit3(expected);

    assert_int_equal(bis_make_subdivided(&m, levels, (bis_loc){0}, NULL), BIS_OK);
    assert_sound(&m);
    d3(at, m.p[0]);
    d3(normal, m.n[0]);
    for (int c = 0; c < 3; c++) assert_true(fabs(at[c] - limit[c]) < 2e-7);
    /* pbrt's side: against the order of the corners; e x f is along it in a closed fan, and f x e is in an open one */
    const double cosine = dot3(normal, expected) * (closed ? -1 : 1);
    if (!(cosine > 1 - 1e-5))
        fail_msg("%s fan of %u, %u levels: 1 - cos = %g", closed ? "closed" : "open", k, levels, 1 - cosine);
    bis_mesh_clear(&m);
}

static void vertices_and_normals_are_the_limits_of_the_rules(void **state)
{
    for (uint32_t k = 1; k <= 11; k++)
        for (unsigned levels = 0; levels < 4; levels++)
            for (uint64_t seed = 0; seed < 5; seed++) {
                if (k >= 3) check_limit(k, true, levels, seed);
                check_limit(k, false, levels, seed);
            }
}

/* The sides of a cube turn outside; pbrt's normals are against the order of the corners. */
static void a_cube_becomes_round_and_closed(void **state)
{
    static const uint32_t index[36] = {0, 2, 1, 0, 3, 2, 4, 5, 6, 4, 6, 7, 0, 1, 5, 0, 5, 4,
                                       1, 2, 6, 1, 6, 5, 2, 3, 7, 2, 7, 6, 3, 0, 4, 3, 4, 7};
    bis_mesh m = new_mesh(8, 12);
    for (int i = 0; i < 8; i++)
        m.p[i] = (vec3){i % 4 == 1 || i % 4 == 2 ? 1 : -1, i % 4 > 1 ? 1 : -1, i < 4 ? -1 : 1};
    memcpy(m.index, index, sizeof index);
    assert_int_equal(bis_make_subdivided(&m, 3, (bis_loc){0}, NULL), BIS_OK);
    assert_int_equal(m.n_triangles, 12 * 64);
    assert_int_equal(m.n_vertices, 2 + 12 * 64 / 2); /* Euler */
    for (size_t i = 0; i < m.n_triangles; i++) {
        double v[3][3], e[3], f[3], n[3];
        for (int k = 0; k < 3; k++) d3(v[k], m.p[m.index[3 * i + (size_t)k]]);
        for (int c = 0; c < 3; c++) {
            e[c] = v[1][c] - v[0][c];
            f[c] = v[2][c] - v[0][c];
        }
        for (int c = 0; c < 3; c++) n[c] = e[(c + 1) % 3] * f[(c + 2) % 3] - e[(c + 2) % 3] * f[(c + 1) % 3];
        unit3(n);
        assert_true(dot3(n, v[0]) > 0);
        for (int k = 0; k < 3; k++) {
            double vn[3];
            d3(vn, m.n[m.index[3 * i + (size_t)k]]);
            assert_true(dot3(n, vn) < -.8);
        }
    }
    bis_mesh_clear(&m);
}

static void what_is_no_surface_is_refused(void **state)
{
    static const struct { uint32_t n_points, n, index[12]; const char *text; } rows[] = {
        {5, 3, {0, 1, 2, 1, 0, 3, 0, 1, 4},
         "more than two triangles share the edge between points 0 and 1: split the surface there"},
        {4, 2, {0, 1, 2, 0, 1, 3},
         "triangles 0 and 1 (counted from 0) turn against each other: exchange two indices of one of them"},
        {7, 3, {0, 1, 2, 3, 4, 5, 3, 4, 6},
         "triangles 1 and 2 (counted from 0) turn against each other: exchange two indices of one of them"},
        {5, 2, {0, 1, 2, 0, 3, 4}, "two surfaces touch in point 0: give each a point of its own there"},
        {6, 4, {0, 1, 2, 0, 2, 3, 0, 3, 1, 0, 4, 5}, "two surfaces touch in point 0: give each a point of its own "
         "there"},
        {3, 1, {0, 1, 1}, "triangle with points 1 and 1: all three must differ"},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        bis_mesh m = new_mesh(rows[i].n_points, rows[i].n);
        bis_diag diag = {0};
        char text[300];
        memcpy(m.index, rows[i].index, rows[i].n * 3 * sizeof *m.index);
        assert_int_equal(bis_make_subdivided(&m, 1, (bis_loc){"s.txt", 3, 1}, &diag), BIS_INPUT);
        snprintf(text, sizeof text, "s.txt:3:1: error: %s", rows[i].text);
        if (!strstr(diag.messages[0].text, text)) fail_msg("%s", diag.messages[0].text);
        assert_int_equal(m.n_triangles, rows[i].n); /* the control mesh is still there */
        bis_diag_clear(&diag);
        bis_mesh_clear(&m);
    }
}

static void a_point_of_no_triangle_stays(void **state)
{
    bis_mesh m = new_mesh(4, 1);
    for (uint32_t i = 0; i < 3; i++) m.index[i] = i;
    m.p[1].x = m.p[2].y = m.p[3].z = 1;
    assert_int_equal(bis_make_subdivided(&m, 2, (bis_loc){0}, NULL), BIS_OK);
    assert_true(m.p[3].z == 1 && m.n[3].x == 0 && m.n[3].y == 0 && m.n[3].z == 0 && m.n_triangles == 16);
    bis_mesh_clear(&m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(revolved_meshes_lie_on_the_implicit_surfaces),
        cmocka_unit_test(a_ring_is_flat_and_a_whole_turn_closes),
        cmocka_unit_test(patches_lie_on_the_hyperbolic_paraboloid),
        cmocka_unit_test(patches_interpolate_normals_and_coordinates),
        cmocka_unit_test(a_height_field_spans_the_unit_square),
        cmocka_unit_test(the_pole_of_a_nurbs_surface_has_the_normals_of_the_faces),
        cmocka_unit_test(a_nurbs_surface_is_that_of_its_definition),
        cmocka_unit_test(vertices_and_normals_are_the_limits_of_the_rules),
        cmocka_unit_test(a_cube_becomes_round_and_closed),
        cmocka_unit_test(what_is_no_surface_is_refused),
        cmocka_unit_test(a_point_of_no_triangle_stays),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
