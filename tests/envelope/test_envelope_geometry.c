/* SPDX-License-Identifier: BSD-2-Clause */
/* envelope, geometry: scenes where every answer is known in advance: walls cut into triangles, met at a known distance;
 * closed shells, from which nothing escapes; shadow rays that must leave their surface. At scales of 1e-6 to 1e6, a
 * million away from the origin, in slivers and duplicates, along axes and cell walls, in one cell and in many millions,
 * by both backends. */
#include "claim.h"
#include "envelope.h"
#include "mesh_help.h"

#include "bis/shape/accel.h"
#include "bis/scene/camera.h"
#include "bis/base/mem.h"
#include "shape/grid.h"

#include <float.h>
#include <string.h>

#define COUNT(a) ((int)(sizeof(a) / sizeof *(a)))

/* ---- backends ---- */

enum { MAX_BACKENDS = 4 };

typedef struct backends {
    bis_accel *a[MAX_BACKENDS];
    int n;
} backends;

/* The grid of one cell, of the default density, of 100 cells a primitive; Embree. */
static backends make_backends(const bis_geometry *g)
{
    static const double densities[] = {1e-9, 0, 100};
    backends b = {.n = 0};

    for (int i = 0; i < COUNT(densities); i++) {
        assert_int_equal(
            bis_accel_new(&b.a[b.n++], g, &(bis_accel_options){BIS_ACCEL_GRID, densities[i], 1, NULL}, NULL), BIS_OK);
    }
    if (bis_accel_embree_version())
        assert_int_equal(
            bis_accel_new(&b.a[b.n++], g, &(bis_accel_options){BIS_ACCEL_EMBREE, 0, 1, NULL}, NULL), BIS_OK);
    return b;
}

static void free_backends(backends *b)
{
    while (b->n > 0) bis_accel_free(b->a[--b->n]);
}

/* Where scenes stand: scale and shift, such that floats still resolve the scene. */
typedef struct place {
    double scale, shift;
} place;

static const place places[] = {{1, 0}, {1e-6, 0}, {1e6, 0}, {1e3, 1e6}, {1e6, 1e6}, {64, -1e6}};

static bis_xform place_xform(const place *at)
{
    const bis_xform scale = bis_xform_scale(at->scale, at->scale, at->scale),
                    move = bis_xform_translate(at->shift, at->shift, at->shift);
    return bis_xform_compose(&move, &scale);
}

/* ---- walls ---- */

typedef enum cut { SQUARES, SLIVERS, TWICE, WITH_FLAT_ONES, N_CUTS } cut;

static const char *const cut_names[] = {"squares", "slivers of 1 : 2000", "every triangle twice",
                                        "triangles without area between"};

static void put_quad(bis_mesh *m, const uint32_t v[4])
{
    const uint32_t six[] = {v[0], v[1], v[2], v[1], v[3], v[2]};
    for (int i = 0; i < 6; i++) m->index[3 * m->n_triangles + (size_t)i] = six[i];
    m->n_triangles += 2;
}

/* [-1, 1]^2 at z = 0 in nx x ny cells of two triangles. */
static bis_mesh wall_mesh(cut kind)
{
    const uint32_t nx = kind == SLIVERS ? 2000 : 16, ny = kind == SLIVERS ? 1 : 16;
    bis_mesh m = new_mesh((nx + 1) * (ny + 1), 6 * (size_t)nx * ny);

    m.n_triangles = 0;
    for (uint32_t i = 0; i < (nx + 1) * (ny + 1); i++)
        m.p[i] = vec3_from(2.0 * (i % (nx + 1)) / nx - 1, 2.0 * (i / (nx + 1)) / ny - 1, 0);
    for (uint32_t i = 0; i < nx * ny; i++) {
        const uint32_t corner = i / nx * (nx + 1) + i % nx,
                       v[4] = {corner, corner + 1, corner + nx + 1, corner + nx + 2};
        const uint32_t line[4] = {corner, corner + 1, corner, corner + 1}, point[4] = {corner, corner, corner, corner};
        put_quad(&m, v);
        if (kind == TWICE) put_quad(&m, v);
        if (kind == WITH_FLAT_ONES) {
            put_quad(&m, line);
            put_quad(&m, point);
        }
    }
    return m;
}

/* Distance by |t - expected| in ulps of what matters: the coordinates. */
static double ulps(double found, double expected, const ray *r)
{
    const double size = fmax(fabs((double)r->o.x), fmax(fabs((double)r->o.y), fabs((double)r->o.z)));
    return fabs(found - expected) / (0x1p-24 * (size + expected));
}

static void walls_are_met_at_their_distance(void **state)
{
    envelope miss = envelope_row("walls with slivers, doubles, or no area; scaled by 1e-6 to 1e6, 1e6 away; rays "
                                 "through vertices, edges, cell walls; grids, Embree",
                                 "rays that miss, or hit a triangle without area", 0);
    envelope t = envelope_row("the same", "error of the distance in units of 2^-24 of the coordinates", 2);

    for (int k = 0; k < N_CUTS * COUNT(places); k++) {
        const cut kind = (cut)(k % N_CUTS);
        const place *at = &places[k / N_CUTS];
        const bis_xform placed = place_xform(at);
        bis_mesh m = wall_mesh(kind);
        bis_geometry g = {0};
        uint64_t seed = (uint64_t)k;
        add_mesh(&g, &m, &placed, 0);
        backends b = make_backends(&g);
        for (int n = 0; n < 3000; n++) {
            double x = random_between(&seed, -0.99, 0.99), y = random_between(&seed, -0.99, 0.99);
            if (n % 3 == 0) x = floor(x * 8) / 8; /* an edge of the squares, and of many a cell */
            if (n % 6 == 0) y = floor(y * 8) / 8;
            if (n % 3 == 1) x = y; /* a diagonal */
            const double height = (n % 2 ? 0.5 : -0.5) * (n % 5 + 1);
            ray r = {bis_xform_point(&placed, vec3_from(x, y, height)),
                     {n % 4 < 2 ? 0.0f : -0.0f, 0, height > 0 ? -1 : 1},
                     INFINITY};
            const vec3 *p = g.p; /* all vertices have the same z, as rounded */
            const double expected = fabs((double)r.o.z - (double)p[0].z);
            const vec3 vertex = p[(size_t)n % g.n_vertices];
            if (n % 7 == 0)
                r.o = (vec3){vertex.x, kind == SLIVERS ? r.o.y : vertex.y,
                             r.o.z}; /* all of the slivers' lie on the rim */
            if (r.o.x <= g.box.lo.x || r.o.x >= g.box.hi.x || r.o.y <= g.box.lo.y || r.o.y >= g.box.hi.y)
                continue; /* the rim itself is a tie */
            for (int i = 0; i < b.n; i++) {
                bis_hit hit = {-1, 0};
                const bool found = bis_accel_intersect(b.a[i], &r, &hit), hidden = bis_accel_occluded(b.a[i], &r);
                envelope_expect(&miss, found && hidden && (kind != WITH_FLAT_ONES || hit.prim % 6 < 2),
                                "%s, scale %g, shift %g, %s %d, ray %g %g", cut_names[kind], at->scale, at->shift,
                                bis_accel_name(b.a[i]), i, x, y);
                if (found)
                    envelope_try(&t, ulps((double)hit.t, expected, &r), "%s, scale %g, shift %g, %s: %g, truth %g",
                                 cut_names[kind], at->scale, at->shift, bis_accel_name(b.a[i]), (double)hit.t,
                                 expected);
            }
        }
        free_backends(&b);
        bis_geometry_clear(&g);
    }
    envelope_close(&miss);
    envelope_close(&t);
}

/* The grid's own walls, as floats; the mesh is a cube of 12 triangles around many small ones, so that there are many
 * cells. */
static void rays_in_cell_walls_and_from_corners_find_the_far_side(void **state)
{
    envelope e = envelope_row("rays in the walls, edges and corners of a grid's cells, along all axes, zeros of both "
                              "signs, from inside and outside the box",
                              "rays that do not reach the far side of the box", 0);

    for (int k = 0; k < COUNT(places); k++) {
        const bis_xform placed = place_xform(&places[k]);
        bis_geometry g = {0};
        for (int axis = 0; axis < 3; axis++) { /* a box of six walls, each 16 x 16 squares */
            for (int side = -1; side <= 1; side += 2) {
                bis_mesh m = wall_mesh(SQUARES);
                for (size_t i = 0; i < m.n_vertices; i++) {
                    const float c[3] = {m.p[i].x, m.p[i].y, (float)side};
                    m.p[i] = (vec3){c[(3 - axis) % 3], c[(4 - axis) % 3], c[(5 - axis) % 3]};
                }
                add_mesh(&g, &m, &placed, 0);
            }
        }
        bis_accel *a;
        assert_int_equal(bis_grid_new(&a, &g, 0, 1, NULL), BIS_OK);
        const bis_grid *grid = (const bis_grid *)a;
        for (int n = 0; n < 6 * 3000; n++) {
            const int axis = n % 3,
                      cell[3] = {n / 6 % grid->n[0] + 1, n / 6 / 7 % grid->n[1] + 1, n / 6 / 11 % grid->n[2] + 1};
            const bool positive = n / 3 % 2, inside = n % 5 < 3;
            const float zero = n % 2 ? 0.0f : -0.0f;
            float o[3], d[3];
            for (int c = 0; c < 3; c++) {
                const double wall = grid->lo[c] + cell[c] * grid->cell[c];
                d[c] = c == axis ? (positive ? 1.0f : -1.0f) : zero;
                o[c] = (float)(c == axis && !inside
                                   ? (positive ? 2 * grid->lo[c] - grid->hi[c] : 2 * grid->hi[c] - grid->lo[c])
                                   : wall);
            }
            const float far_lo[3] = {g.box.lo.x, g.box.lo.y, g.box.lo.z},
                        far_hi[3] = {g.box.hi.x, g.box.hi.y, g.box.hi.z};
            bool on_box = false; /* rays along the box's own faces are ties */
            for (int c = 0; c < 3; c++) on_box |= (c != axis || inside) && (o[c] <= far_lo[c] || o[c] >= far_hi[c]);
            if (on_box) continue;
            const ray r = {{o[0], o[1], o[2]}, {d[0], d[1], d[2]}, INFINITY};
            bis_hit hit = {-1, 0};
            const bool found = bis_accel_intersect(a, &r, &hit);
            const double near = inside ? (positive ? (double)far_hi[axis] : (double)far_lo[axis])
                                       : (positive ? (double)far_lo[axis] : (double)far_hi[axis]);
            envelope_expect(
                &e, found && bis_accel_occluded(a, &r) && ulps((double)hit.t, fabs(near - (double)o[axis]), &r) <= 2,
                "scale %g, shift %g, axis %d, from %g %g %g", places[k].scale, places[k].shift, axis, (double)o[0],
                (double)o[1], (double)o[2]);
        }
        bis_accel_free(a);
        bis_geometry_clear(&g);
    }
    envelope_close(&e);
}

/* ---- shells ---- */

static vec3 vec3_of(const frame *f, double theta, double phi)
{
    return to_world(f, vec3_from(sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta)));
}

/* A vertex, an edge's middle or any direction of the unit sphere mesh, from inside. */
static vec3 shell_target(const bis_geometry *g, int n, uint64_t *seed)
{
    const uint32_t *v = g->index + 3 * ((size_t)n * 7919 % g->n_triangles);

    if (n % 3 == 0) return g->p[v[0]];
    if (n % 3 == 1) return mul(add(mul(g->p[v[0]], 0.5), mul(g->p[v[1]], 0.5)), 1);
    return add(mul(g->p[v[0]], random_double(seed)), mul(g->p[v[1]], 0.01));
}

static void nothing_leaves_a_closed_shell_and_no_surface_shadows_itself(void **state)
{
    envelope leak = envelope_row("closed mesh of 2000 triangles, scaled by 1e-6 to 1e6, 1e6 away; rays from inside to "
                                 "vertices, edges and between; both backends",
                                 "rays that escape", 0);
    envelope shadow =
        envelope_row("the same; shadow rays from where these hit, to the outside, at angles up to 89.999 degrees",
                     "points that shadow themselves", 0);
    envelope offset = envelope_row("the same", "length of the offset in units of 2^-24 of the coordinates", 16);

    for (int k = 0; k < COUNT(places); k++) {
        const bis_xform placed = place_xform(&places[k]);
        bis_mesh m = sphere_mesh(23);
        bis_geometry g = {0};
        uint64_t seed = 3;
        add_mesh(&g, &m, &placed, 0);
        backends b = make_backends(&g);
        const vec3 centre = bis_xform_point(&placed, (vec3){0.1f, -0.2f, 0.05f});
        for (int n = 0; n < 6000; n++) {
            const vec3 target = shell_target(&g, n, &seed);
            const ray r = {centre, n % 3 == 2 ? random_direction(&seed) : normalize(sub(target, centre)), INFINITY};
            for (int i = 0; i < b.n; i++) {
                bis_hit hit;
                if (!bis_accel_intersect(b.a[i], &r, &hit)) {
                    envelope_expect(&leak, false, "scale %g, shift %g, %s", places[k].scale, places[k].shift,
                                    bis_accel_name(b.a[i]));
                    continue;
                }
                envelope_expect(&leak, bis_accel_occluded(b.a[i], &r), "scale %g, shift %g, %s", places[k].scale,
                                places[k].shift, bis_accel_name(b.a[i]));
                bis_surface s;
                bis_geometry_surface(&g, hit.prim, &r, &s);
                s.ng = neg(s.ng); /* the outer side */
                const vec3 o = bis_surface_offset(&s);
                const frame f = frame_about(s.ng);
                const double t = (double)(n % 10) / 9 * 89.999 * PI / 180, phi = random_between(&seed, 0, 6.28);
                const ray away = {o, normalize(vec3_of(&f, t, phi)), INFINITY};
                envelope_expect(&shadow, !bis_accel_occluded(b.a[i], &away), "scale %g, shift %g, %s, at %g degrees",
                                places[k].scale, places[k].shift, bis_accel_name(b.a[i]), t * 180 / PI);
                const double size = fmax(fabs((double)s.p.x), fmax(fabs((double)s.p.y), fabs((double)s.p.z)));
                envelope_try(&offset, length(sub(o, s.p)) / (0x1p-24 * fmax(size, places[k].scale)),
                             "scale %g, shift %g", places[k].scale, places[k].shift);
            }
        }
        free_backends(&b);
        bis_geometry_clear(&g);
    }
    envelope_close(&leak);
    envelope_close(&shadow);
    envelope_close(&offset);
}

/* pbrt's mesh for this question: rows of a sphere, whose vertices stand at random 1 to 6 from the middle. */
static bis_mesh spiky_mesh(uint32_t n)
{
    bis_mesh m = new_mesh(n * n, 6 * (size_t)n * (n - 1));
    uint64_t seed = 5;

    m.n_triangles = 0;
    for (uint32_t i = 0; i < n * n; i++) {
        const double theta = PI * (i / n) / (n - 1), phi = 2 * PI * (i % n) / (n - 1);
        const double r = random_between(&seed, 1, 6);
        m.p[i] = vec3_from(r * sin(theta) * cos(phi), r * sin(theta) * sin(phi), r * cos(theta));
        if (i / n == 0) m.p[i] = (vec3){0, 0, 1};
        else if (i / n == n - 1) m.p[i] = (vec3){0, 0, -1};
        else if (i % n == n - 1) m.p[i] = m.p[i + 1 - n];
    }
    for (uint32_t i = 0; i < n * (n - 1); i++)
        if (i % n != n - 1) put_quad(&m, (uint32_t[4]){i, i + 1, i + n, i + n + 1});
    return m;
}

static void spikes_lose_few_rays_to_their_tips_and_the_grid_none(void **state)
{
    envelope none = envelope_row("closed mesh of spikes of 1 to 6 radii (pbrt's test of watertight triangles); rays "
                                 "from inside in any direction, both backends, and to vertices, grids",
                                 "rays that escape", 0);
    envelope few = envelope_row("the same; rays to vertices, Embree", "share of rays that escape", 2e-3);
    bis_mesh m = spiky_mesh(16);
    const bis_xform here = bis_xform_identity();
    bis_geometry g = {0};
    uint64_t seed = 6;
    int lost = 0, n_tips = 0;

    add_mesh(&g, &m, &here, 0);
    backends b = make_backends(&g);
    for (int n = 0; n < 200000; n++) {
        const vec3 o = mul(random_direction(&seed), 0.5);
        const vec3 tip = g.p[(size_t)(random_double(&seed) * (double)g.n_vertices)];
        const bool to_tip = n % 2;
        const ray r = {o, to_tip ? normalize(sub(tip, o)) : random_direction(&seed), INFINITY};
        n_tips += to_tip;
        for (int i = 0; i < b.n; i++) {
            const bool is_held = bis_accel_occluded(b.a[i], &r);
            if (to_tip && strcmp(bis_accel_name(b.a[i]), "grid") != 0) lost += !is_held;
            else envelope_expect(&none, is_held, "ray %d, %s", n, bis_accel_name(b.a[i]));
        }
    }
    envelope_try(&few, (double)lost / n_tips, "%d of %d", lost, n_tips);
    free_backends(&b);
    bis_geometry_clear(&g);
    envelope_close(&none);
    envelope_close(&few);
}

/* ---- quadrics ---- */

/* A sphere about c of radius R: from outside towards its centre, t = distance - R, c and R in double, the ray in float.
 */
static void spheres_are_met_at_their_distance(void **state)
{
    envelope t = envelope_row("sphere scaled by 1e-6 to 1e6, 1e6 away, from 1 to 1e6 radii",
                              "error of the distance in units of 2^-24 of the coordinates, against long double", 4);
    envelope shadow = envelope_row("the same; shadow rays from there, at angles up to 89.999 degrees",
                                   "points that shadow themselves", 0);

    for (int k = 0; k < COUNT(places); k++) {
        const bis_xform placed = place_xform(&places[k]);
        const bis_quadric q = {BIS_SPHERE, 1, 0, placed, 0};
        const double R = places[k].scale, c = places[k].shift;
        bis_geometry g = {0};
        uint64_t seed = 4;
        assert_int_equal(bis_geometry_add_quadric(&g, &q, NULL), BIS_OK);
        backends b = make_backends(&g);
        for (int n = 0; n < 3000; n++) {
            const double far = R * pow(10, random_between(&seed, 0, 6)) + R;
            const vec3 from = random_direction(&seed);
            const ray r = {vec3_from(c + far * (double)from.x, c + far * (double)from.y, c + far * (double)from.z),
                           neg(from), INFINITY};
            const long double o[3] = {(long double)r.o.x - (long double)c, (long double)r.o.y - (long double)c,
                                      (long double)r.o.z - (long double)c};
            const long double d[3] = {(long double)r.d.x, (long double)r.d.y, (long double)r.d.z};
            const long double A = d[0] * d[0] + d[1] * d[1] + d[2] * d[2],
                              B = -(o[0] * d[0] + o[1] * d[1] + o[2] * d[2]) / A;
            const long double f[3] = {o[0] + B * d[0], o[1] + B * d[1], o[2] + B * d[2]},
                              D = (long double)R * (long double)R - (f[0] * f[0] + f[1] * f[1] + f[2] * f[2]);
            if (D <= (long double)R * (long double)R / 2) continue; /* floats did not aim well enough */
            const double expected = (double)(B - sqrtl(D / A));
            if (expected <= 0) continue;
            for (int i = 0; i < b.n; i++) {
                bis_hit hit = {-1, 0};
                bis_surface s;
                const bool found = bis_accel_intersect(b.a[i], &r, &hit);
                envelope_try(&t, found ? ulps((double)hit.t, expected, &r) : (double)INFINITY,
                             "scale %g, shift %g, %s: %g, truth %g", R, c, bis_accel_name(b.a[i]), (double)hit.t,
                             expected);
                if (!found) continue;
                bis_geometry_surface(&g, hit.prim, &r, &s);
                const frame about = frame_about(s.ng);
                const double angle = (double)(n % 10) / 9 * 89.999 * PI / 180;
                const ray away = {bis_surface_offset(&s),
                                  normalize(vec3_of(&about, angle, random_between(&seed, 0, 6.28))), INFINITY};
                envelope_expect(&shadow, !bis_accel_occluded(b.a[i], &away), "scale %g, shift %g, %s, at %g degrees", R,
                                c, bis_accel_name(b.a[i]), angle * 180 / PI);
            }
        }
        free_backends(&b);
        bis_geometry_clear(&g);
    }
    envelope_close(&t);
    envelope_close(&shadow);
}

/* ---- floats at their limits ---- */

static void rays_of_any_length_and_origin_meet_a_wall(void **state)
{
    static const float lengths[] = {1e-30f, 1e-10f, 1, 1e10f, 1e30f}, distances[] = {1e-30f, 1e-6f, 1, 1e6f, 1.3e8f};
    envelope e = envelope_row(
        "directions of length 1e-30 to 1e30, origins 1e-30 to 1.3e8 away, small components down to 1e-45, grid only",
        "rays that miss a wall, or meet it elsewhere", 0);
    bis_mesh m = wall_mesh(SQUARES);
    bis_geometry g = {0};
    bis_accel *a;

    add_mesh(&g, &m, NULL, 0);
    assert_int_equal(bis_grid_new(&a, &g, 0, 1, NULL), BIS_OK);
    for (int k = 0; k < COUNT(lengths) * COUNT(distances) * 4; k++) {
        const float size = lengths[k % COUNT(lengths)], away = distances[k / COUNT(lengths) % COUNT(distances)],
                    small = k / 25 % 2 ? 1e-45f : -1e-45f;
        const ray r = {{0.3f, -0.7f, k / 50 ? away : -away}, {small, -small, k / 50 ? -size : size}, INFINITY};
        const double expected = (double)away / (double)size;
        bis_hit hit = {-1, 0};
        if (expected > (double)FLT_MAX || expected < (double)FLT_MIN) continue; /* no float t */
        const bool found = bis_accel_intersect(a, &r, &hit);
        envelope_expect(&e, found && bis_accel_occluded(a, &r) && relative_error((double)hit.t, expected) < 2e-7,
                        "length %g, distance %g: %g", (double)size, (double)away, (double)hit.t);
    }
    bis_accel_free(a);
    bis_geometry_clear(&g);
    envelope_close(&e);
}

/* What a camera may be asked for. */
static void cameras_of_any_angle_give_unit_rays(void **state)
{
    static const double angles[] = {1e-6, 1e-3, 1, 90, 179, 179.999, 179.999999};
    static const int frames[][2] = {{1, 1}, {1, 32768}, {32768, 1}, {640, 480}};
    envelope e =
        envelope_row("cameras of 1e-6 to 179.999999 degrees, frames of 1 x 1, 1 x 32768, 32768 x 1, corners and centre",
                     "length of a ray's direction - 1", 1e-6);

    for (int k = 0; k < COUNT(angles) * COUNT(frames) * 9; k++) {
        const bis_camera c = {.fov_deg = angles[k % COUNT(angles)], .to_world = bis_xform_identity()};
        const int *frame_size = frames[k / COUNT(angles) % COUNT(frames)], at = k / COUNT(angles) / COUNT(frames);
        const ray r = bis_camera_ray(&c, frame_size[0], frame_size[1], frame_size[0] * (at % 3) / 2.0,
                                     frame_size[1] * (at / 3) / 2.0);
        envelope_try(&e, fabs(length(r.d) - 1), "%g degrees, %d x %d", angles[k % COUNT(angles)], frame_size[0],
                     frame_size[1]);
    }
    envelope_close(&e);
}

/* ---- work ---- */

/* Triangles as large as the scene would make a grid of many cells hold each of them in thousands: it becomes coarser
 * instead. */
static void a_grid_never_holds_more_than_it_may(void **state)
{
    enum { N = 3000 };
    envelope items =
        envelope_row("3000 triangles as large as the scene, 1000 cells a triangle: 1e8 entries of cells",
                     "bytes of the grid, over the rule of 8 items a primitive and 4 more for each cell asked for", 1);
    envelope hit = envelope_row("the same, against the grid of one cell", "rays with another hit", 0);
    bis_mesh m = soup_mesh(N, 1, 5);
    bis_geometry g = {0};
    bis_accel *many, *one;
    uint64_t seed = 6;

    add_mesh(&g, &m, NULL, 0);
    assert_int_equal(bis_grid_new(&many, &g, 1000, 1, NULL), BIS_OK);
    assert_int_equal(bis_grid_new(&one, &g, 1e-9, 1, NULL), BIS_OK);
    const double cells = 1.3 * 1000 * N, most = 8.0 * N + 4 * 992.0 * N + 65536;
    envelope_try(&items, (double)bis_accel_bytes(many) / (4 * cells + cells / 8 + 4 * most + 36.0 * N + 4096),
                 "%zu bytes", bis_accel_bytes(many));
    for (int i = 0; i < 1000; i++) {
        const ray r = {mul(random_direction(&seed), 3), random_direction(&seed), INFINITY};
        bis_hit a = {0, BIS_NO_PRIM}, b = {0, BIS_NO_PRIM};
        const bool found = bis_accel_intersect(many, &r, &a);
        envelope_expect(&hit,
                        found == bis_accel_intersect(one, &r, &b) && a.prim == b.prim && a.t == b.t &&
                            found == bis_accel_occluded(many, &r),
                        "ray %d", i);
    }
    bis_accel_free(many);
    bis_accel_free(one);
    bis_geometry_clear(&g);
    envelope_close(&items);
    envelope_close(&hit);
}

static void a_hundred_million_cells_are_built_and_walked(void **state)
{
    if (!envelope_long()) skip();
    envelope e = envelope_long_row(
        "grid of 1e8 cells about a closed mesh; rays through all of it, and from inside to vertices and edges",
        "rays with another hit than by the grid of one cell", 0);
    bis_mesh m = sphere_mesh(23);
    bis_geometry g = {0};
    bis_accel *many, *one;
    uint64_t seed = 7;
    add_mesh(&g, &m, NULL, 0);
    assert_int_equal(bis_grid_new(&many, &g, 1e8 / (double)g.n_triangles, 1, NULL), BIS_OK);
    assert_int_equal(bis_grid_new(&one, &g, 1e-9, 1, NULL), BIS_OK);
    envelope_expect(&e, ((const bis_grid *)many)->n_cells > 50000000, "only %zu cells",
                    ((const bis_grid *)many)->n_cells);
    for (int n = 0; n < 20000; n++) {
        const vec3 o = mul(random_direction(&seed), n % 2 ? 0.3 : 3), target = shell_target(&g, n, &seed);
        const ray r = {o, normalize(sub(target, o)), INFINITY};
        bis_hit a = {0, BIS_NO_PRIM}, b = {0, BIS_NO_PRIM};
        const bool found = bis_accel_intersect(many, &r, &a);
        envelope_expect(
            &e, found == bis_accel_intersect(one, &r, &b) && a.t == b.t && found == bis_accel_occluded(many, &r),
            "ray %d", n);
    }
    bis_accel_free(many);
    bis_accel_free(one);
    bis_geometry_clear(&g);
    envelope_close(&e);
}

static void page_has_the_same_rows(void **state)
{
    envelope_finish(5, "Geometry");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(walls_are_met_at_their_distance),
        cmocka_unit_test(rays_in_cell_walls_and_from_corners_find_the_far_side),
        cmocka_unit_test(nothing_leaves_a_closed_shell_and_no_surface_shadows_itself),
        cmocka_unit_test(spikes_lose_few_rays_to_their_tips_and_the_grid_none),
        cmocka_unit_test(spheres_are_met_at_their_distance),
        cmocka_unit_test(rays_of_any_length_and_origin_meet_a_wall),
        cmocka_unit_test(cameras_of_any_angle_give_unit_rays),
        cmocka_unit_test(a_grid_never_holds_more_than_it_may),
        cmocka_unit_test(a_hundred_million_cells_are_built_and_walked),
        cmocka_unit_test(page_has_the_same_rows),
    };
    envelope_one_thread();
    return cmocka_run_group_tests(tests, NULL, NULL);
}
