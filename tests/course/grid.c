/* SPDX-License-Identifier: BSD-2-Clause */
/* Assignment grid: src/shape/grid_walk.c. Every ray is compared with brute force over all triangles, in long double;
 * ties within 4 ulps of an edge are left out. Brute force itself is found out by cells that hold what they should
 * not. */
#include "mark.h"

#include "shape/grid.h"
#include "mesh_help.h"

#include <string.h>

/* A mesh, the geometry of it, and how dense the student's grid is. */
typedef struct world {
    bis_geometry g;
    double density;
} world;

static void world_init(world *w, bis_mesh m, double density)
{
    const bis_xform identity = bis_xform_identity();

    *w = (world){.density = density};
    add_mesh(&w->g, &m, &identity, 0);
}

/* What the student's walk finds by n rays. */
static ask_hit *trace(const world *w, const ray *r, size_t n)
{
    ask_hit *h = mark_alloc(n, sizeof *h);

    ASK(ASK_RAYS, GIVE(w->g.p, w->g.n_vertices), GIVE(w->g.index, 3 * w->g.n_triangles), GIVE(&w->density, 1),
        GIVE(r, n), TAKE(h, n),
        GIVE(w->g.p, 0), GIVE(w->g.p, 0), GIVE(w->g.p, 0), GIVE(w->g.p, 0));
    return h;
}

static long double determinant(const long double a[3], const long double b[3], const long double c[3])
{
    return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
}

static void flat(long double out[3], vec3 v)
{
    out[0] = (long double)v.x;
    out[1] = (long double)v.y;
    out[2] = (long double)v.z;
}

/* Cramer's rule: another road than the library's. */
static bool brute_triangle(const bis_geometry *g, uint32_t prim, const ray *r, long double *t)
{
    long double v[3][3], o[3], d[3], e[3], f[3], s[3], back[3];

    flat(o, r->o);
    flat(d, r->d);
    for (int i = 0; i < 3; i++) flat(v[i], g->p[g->index[3 * (size_t)prim + (size_t)i]]);
    for (int a = 0; a < 3; a++) {
        e[a] = v[1][a] - v[0][a];
        f[a] = v[2][a] - v[0][a];
        s[a] = o[a] - v[0][a];
        back[a] = -d[a];
    }
    const long double det = determinant(back, e, f);
    if (det == 0) return false;
    const long double b1 = determinant(back, s, f) / det, b2 = determinant(back, e, s) / det;
    *t = determinant(s, e, f) / det;
    return b1 >= 0 && b2 >= 0 && b1 + b2 <= 1 && *t > 0 && *t < (long double)r->tmax;
}

/* Is the ray's line so far from the triangle that it neither meets it nor nearly does? The triangle lies within r of
 * its centroid; a thousandth of r and of the way there is much more than the 4 ulps of is_tie. It saves brute force
 * most of its work. */
static bool is_far(const bis_geometry *g, uint32_t prim, const ray *r)
{
    const vec3 *p[3];
    double c[3], to[3], radius2 = 0;
    const double o[3] = {(double)r->o.x, (double)r->o.y, (double)r->o.z},
        d[3] = {(double)r->d.x, (double)r->d.y, (double)r->d.z};

    for (int i = 0; i < 3; i++) p[i] = &g->p[g->index[3 * (size_t)prim + (size_t)i]];
    c[0] = ((double)p[0]->x + (double)p[1]->x + (double)p[2]->x) / 3;
    c[1] = ((double)p[0]->y + (double)p[1]->y + (double)p[2]->y) / 3;
    c[2] = ((double)p[0]->z + (double)p[1]->z + (double)p[2]->z) / 3;
    for (int i = 0; i < 3; i++) {
        const double x = (double)p[i]->x - c[0], y = (double)p[i]->y - c[1], z = (double)p[i]->z - c[2];
        radius2 = fmax(radius2, x * x + y * y + z * z);
    }
    for (int a = 0; a < 3; a++) to[a] = c[a] - o[a];
    const double x = to[1] * d[2] - to[2] * d[1], y = to[2] * d[0] - to[0] * d[2], z = to[0] * d[1] - to[1] * d[0];
    const double way = sqrt(to[0] * to[0] + to[1] * to[1] + to[2] * to[2]), reach = 1.001 * sqrt(radius2) + 1e-3 * way;
    return x * x + y * y + z * z > reach * reach * (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
}

/* 1 when the ray hits. Both queries must agree with brute force. */
static int check(const world *w, const ray *r, const ask_hit *h, const char *what)
{
    uint32_t prim = BIS_NO_PRIM;
    long double t = (long double)INFINITY;

    for (uint32_t k = 0; k < w->g.n_triangles; k++) {
        long double here;
        if (is_far(&w->g, k, r)) continue;
        if (is_tie(&w->g, k, r, 4)) return 0;
        if (brute_triangle(&w->g, k, r, &here) && here < t) {
            t = here;
            prim = k;
        }
    }
    const bool must = prim != BIS_NO_PRIM;
    const bis_hit hit = h->hit;
    const double ox = (double)r->o.x, oy = (double)r->o.y, oz = (double)r->o.z, dx = (double)r->d.x,
        dy = (double)r->d.y, dz = (double)r->d.z;
    if (h->found && !must) {
        mark_wrong("%s: ray from (%g %g %g) towards (%g %g %g) hits triangle %u at t = %g; it must hit nothing", what,
                   ox, oy, oz, dx, dy, dz, hit.prim, (double)hit.t);
    }
    if (!h->found && must) {
        mark_wrong("%s: ray from (%g %g %g) towards (%g %g %g) hits nothing; it must hit triangle %u at t = %Lg",
                   what, ox, oy, oz, dx, dy, dz, prim, t);
    }
    if (h->any != must) {
        mark_wrong("%s: ray from (%g %g %g) towards (%g %g %g): the any-hit query says %d, must be %d", what, ox, oy,
                   oz, dx, dy, dz, h->any, must);
    }
    if (must && !(fabsl((long double)hit.t - t) <= 1e-5L * (t + 1))) {
        mark_wrong("%s: ray from (%g %g %g) towards (%g %g %g) hits triangle %u at t = %g; the nearest hit is "
                   "triangle %u at t = %Lg", what, ox, oy, oz, dx, dy, dz, hit.prim, (double)hit.t, prim, t);
    }
    return must;
}

/* How many of n rays hit. */
static int check_all(const world *w, const ray *r, size_t n, const char *what)
{
    ask_hit *h = trace(w, r, n);
    int hits = 0;

    for (size_t k = 0; k < n; k++) hits += check(w, &r[k], &h[k], what);
    return hits;
}

static void expect_hits(int hits, int least, const char *what)
{
    if (hits < least) mark_wrong("%s: only %d hits, %d at least are expected", what, hits, least);
}

static void one_triangle_is_hit_and_missed(void)
{
    bis_mesh m = new_mesh(3, 1);
    m.p[0] = (vec3){0, 0, 0.5f};
    m.p[1] = (vec3){1, 0, 0.5f};
    m.p[2] = (vec3){0, 1, 0.6f};
    for (uint32_t i = 0; i < 3; i++) m.index[i] = i;
    world w;
    world_init(&w, m, 0);
    ray down[400], up[400];

    for (int k = 0; k < 400; k++) {
        const float x = (float)(k % 20 + 0.37) / 20, y = (float)((int)(k / 20) + 0.41) / 20;
        down[k] = (ray){{x, y, 3}, {0.01f, 0.02f, -1}, INFINITY};
        up[k] = (ray){{x, y, -3}, {0.01f, -0.02f, 1}, INFINITY};
    }
    expect_hits(check_all(&w, down, 400, "one triangle from above") + check_all(&w, up, 400,
            "one triangle from below"), 300, "one triangle");
}

/* From inside and outside the unit cube towards a point in it. */
static ray random_ray(uint64_t *seed, double away)
{
    const vec3 o = random_point(seed, -away, 1 + away), to = random_point(seed, 0, 1);

    return (ray){o, normalize(sub(to, o)), INFINITY};
}

enum { RAYS = 3000 };

/* Towards larger x, y and z, so that a mistake in the other directions costs the claims that look at all of them,
 * and no others. */
static ray upwards(ray r)
{
    r.d = (vec3){fabsf(r.d.x), fabsf(r.d.y), fabsf(r.d.z)};
    return r;
}

static ray *random_rays(uint64_t *seed, double away, size_t n)
{
    ray *r = mark_alloc(n, sizeof *r);

    for (size_t k = 0; k < n; k++) r[k] = random_ray(seed, away);
    return r;
}

/* Longer in x than in z: no two axes have as many cells. */
static bis_mesh oblong(bis_mesh m)
{
    for (uint32_t i = 0; i < m.n_vertices; i++) m.p[i] = (vec3){2 * m.p[i].x, m.p[i].y, 0.6f * m.p[i].z};
    return m;
}

static void check_soup(size_t n, double size, double density, double away, bool any_way, int least, const char *what)
{
    uint64_t seed = mark_seed(n);
    world w;
    world_init(&w, oblong(soup_mesh(mark_size(n), size, mark_seed(11))), density);
    ray *r = random_rays(&seed, away, RAYS);

    for (int k = 0; !any_way && k < RAYS; k++) r[k] = upwards(r[k]);
    expect_hits(check_all(&w, r, RAYS, what), least, what);
}

static void small_triangles_from_outside_are_met(void)
{
    check_soup(500, 0.1, 0, 0.8, false, 200, "500 small triangles, from outside, towards larger x, y and z");
}
static void small_triangles_from_inside_are_met(void)
{
    check_soup(500, 0.1, 0, 0, true, 200, "500 small triangles, from inside");
}

/* They reach through many cells: a hit is found before its cell is reached. */
static void the_nearest_of_large_triangles_is_found(void)
{
    check_soup(60, 0.9, 40, 0.5, false, 500, "60 large triangles in small cells, towards larger x, y and z");
}

static void rays_along_an_axis_are_met(void)
{
    static const float zeros[] = {0.0f, -0.0f};
    uint64_t seed = mark_seed(3);
    world w;
    world_init(&w, soup_mesh(mark_size(800), 0.15, mark_seed(12)), 0);
    static ray r[RAYS];

    for (int k = 0; k < RAYS; k++) {
        float o[3], d[3];
        const int axis = k % 3, flat_axis = k / 3 % 3;
        for (int a = 0; a < 3; a++) {
            o[a] = (float)random_double(&seed);
            d[a] = k % 2 ? (a == axis ? 1.0f : zeros[k / 2 % 2]) : (float)random_between(&seed, -1, 1);
        }
        if (k % 2) o[axis] = k / 2 % 2 ? -1 : 2; /* outside, along one axis, there or back */
        if (k % 2 && o[axis] > 1) d[axis] = -1;
        if (k % 2 == 0) d[flat_axis] = zeros[k / 2 % 2];
        r[k] = (ray){{o[0], o[1], o[2]}, normalize((vec3){d[0], d[1], d[2]}), INFINITY};
    }
    expect_hits(check_all(&w, r, RAYS, "a direction with a component of 0 or -0"), 300, "rays along axes");
}

/* A plane of the box itself, and rays that lie in a wall between cells. */
static void the_last_cell_is_visited(void)
{
    bis_mesh m = new_mesh(8, 4);
    for (int i = 0; i < 8; i++) m.p[i] = (vec3){(float)(i & 1), (float)(i >> 1 & 1), (float)(i >> 2)};
    const uint32_t index[] = {0, 1, 2, 1, 3, 2, 4, 5, 6, 5, 7, 6};
    for (int i = 0; i < 12; i++) m.index[i] = index[i];
    world w;
    world_init(&w, m, 100);
    uint64_t seed = mark_seed(4);
    static ray inside[2000];

    for (int k = 0; k < 2000; k++) {
        const double x = random_between(&seed, 0.05, 0.95), y = random_between(&seed, 0.05, 0.95);
        const double dx = random_between(&seed, -0.1, 0.1), dy = random_between(&seed, -0.1, 0.1);
        inside[k] = (ray){vec3_from(x, y, 0.5), normalize(vec3_from(dx, dy, k % 2 ? 1 : -1)), INFINITY};
    }
    expect_hits(check_all(&w, inside, 2000, "a box open at the sides: from its middle to floor or ceiling, in the "
                          "first and last layer of cells"), 1500,
                "floor and ceiling");
}

/* Where the ray is inside of cell c enlarged by `slack` of its size on each side: t from in to out. False: nowhere. */
static bool passes(const bis_grid *g, size_t c, const ray *r, long double slack, long double *in, long double *out)
{
    const size_t i[3] = {c % (size_t)g->n[0], c / (size_t)g->n[0] % (size_t)g->n[1],
                         c / ((size_t)g->n[0] * (size_t)g->n[1])};
    long double o[3], d[3];

    flat(o, r->o);
    flat(d, r->d);
    *in = 0;
    *out = (long double)INFINITY;
    for (int a = 0; a < 3; a++) {
        const long double lo = (long double)g->lo[a] + ((long double)i[a] - slack) * (long double)g->cell[a];
        const long double hi = lo + (1 + 2 * slack) * (long double)g->cell[a];
        if (d[a] == 0) {
            if (o[a] < lo || o[a] > hi) return false;
            continue;
        }
        const long double t0 = (lo - o[a]) / d[a], t1 = (hi - o[a]) / d[a];
        *in = fmaxl(*in, fminl(t0, t1));
        *out = fminl(*out, fmaxl(t0, t1));
    }
    return *in <= *out;
}

/* A sheet across the ray, before all else: in the geometry's list, but only in those cells' that the ray does not
 * need: off its way, or behind the end of the nearest hit's cell. Who finds it looks where there is nothing to look
 * for. */
static void set_decoy(world *w, uint32_t decoy, const ray *r)
{
    const frame f = frame_about(r->d);
    const vec3 middle = add(r->o, mul(r->d, 1e-3));

    for (uint32_t k = 0; k < 3; k++) {
        const double phi = 2 * PI * k / 3;
        w->g.p[w->g.index[3 * (size_t)decoy + k]] = add(middle, add(mul(f.x, cos(phi)), mul(f.y, sin(phi))));
    }
}

/* t of the nearest triangle but the decoy; infinite: none. */
static long double nearest_but(const world *w, uint32_t decoy, const ray *r)
{
    long double t = (long double)INFINITY, here;

    for (uint32_t k = 0; k < w->g.n_triangles; k++) {
        if (k == decoy || is_far(&w->g, k, r)) continue;
        if (is_tie(&w->g, k, r, 4)) return -1;
        if (brute_triangle(&w->g, k, r, &here) && here < t) t = here;
    }
    return t;
}

/* What lies in the cells, in the place of what the grid put there. */
typedef struct cells {
    uint32_t *offsets, *items;
    uint64_t *occupied;
    size_t n_words;
} cells;

/* Each cell that the ray needs to look into, up to the nearest hit at t, holds what it held, but for the decoy;
 * every other cell holds the decoy alone. Returns how many do. */
static int lay_traps(cells *c, const bis_grid *g, uint32_t decoy, const ray *r, long double t)
{
    const long double last = fminl(t, (long double)r->tmax);
    long double in, out, end = last; /* where the walk may end: the wall behind the hit */
    uint32_t n = 0;
    int traps = 0;

    for (size_t i = 0; i < g->n_cells; i++) {
        if (passes(g, i, r, 0.01L, &in, &out) && in <= last && out > end) end = out;
    }
    memset(c->occupied, 0, c->n_words * sizeof *c->occupied);
    for (size_t i = 0; i < g->n_cells; i++) {
        c->offsets[i] = n;
        if (passes(g, i, r, 0.01L, &in, &out) && in <= end) {
            for (uint32_t k = g->offsets[i]; k < g->offsets[i + 1]; k++) {
                if (g->items[k] != decoy) c->items[n++] = g->items[k];
            }
        } else {
            c->items[n++] = decoy;
            traps++;
        }
        if (n > c->offsets[i]) c->occupied[i >> 6] |= (uint64_t)1 << (i & 63);
    }
    c->offsets[g->n_cells] = c->offsets[g->n_cells + 1] = n;
    return traps;
}

static void only_the_cells_on_the_way_are_looked_at(void)
{
    uint64_t seed = mark_seed(8);
    bis_mesh m = oblong(soup_mesh(40, 0.25, mark_seed(16)));
    const uint32_t decoy = 17; /* whatever it was: no cell holds it now but by our hand */
    bis_accel *grid;
    world w;
    int traps = 0;

    world_init(&w, m, 8);
    if (bis_grid_new(&grid, &w.g, w.density, 1, NULL)) mark_wrong("no memory for a grid");
    const bis_grid *g = (const bis_grid *)grid;
    const size_t n_p = w.g.n_vertices, n_items = g->offsets[g->n_cells] + g->n_cells;
    vec3 *p = mark_alloc(n_p, sizeof *p); /* as the grid was built */
    cells c = {mark_alloc(g->n_cells + 2, sizeof *c.offsets), mark_alloc(n_items, sizeof *c.items), NULL,
               g->n_cells / 64 + 1};
    c.occupied = mark_alloc(c.n_words, sizeof *c.occupied);
    memcpy(p, w.g.p, n_p * sizeof *p);
    for (int k = 0; k < 400; k++) {
        ray r = random_ray(&seed, 0.8);
        if (k % 3 == 0) r.tmax = 0.4f; /* nor are those behind the ray's end */
        set_decoy(&w, decoy, &r);
        const long double t = nearest_but(&w, decoy, &r);
        if (t < 0) continue;
        traps += lay_traps(&c, g, decoy, &r, t);
        ask_hit h;
        ASK(ASK_RAYS, GIVE(p, n_p), GIVE(w.g.index, 3 * w.g.n_triangles), GIVE(&w.density, 1), GIVE(&r, 1),
            TAKE(&h, 1), GIVE(w.g.p, n_p),
            GIVE(c.offsets, g->n_cells + 2), GIVE(c.items, n_items), GIVE(c.occupied, c.n_words));
        if ((h.found && h.hit.prim == decoy) || (h.any && isinf(t))) {
            mark_wrong("ray %d finds triangle %u, which lies only in cells that it does not pass, or passes after its "
                       "nearest hit: a walk looks into the "
                       "cells on its way, in order, and ends with the cell of the hit", k, decoy);
        }
        if (h.found != !isinf(t) || h.any != !isinf(t)) {
            mark_wrong("ray %d: nearest hit %d, any hit %d, must be %d: are all cells on the way looked at?", k,
                       h.found, h.any, !isinf(t));
        }
    }
    if (traps == 0) mark_wrong("not a single cell was off the way");
}

static void tmax_ends_the_ray(void)
{
    uint64_t seed = mark_seed(5);
    world w;
    world_init(&w, soup_mesh(mark_size(300), 0.2, mark_seed(13)), 0);
    ray *r = random_rays(&seed, 0.5, RAYS);
    int n = 0, cut = 0;

    for (int k = 0; k < RAYS; k++) r[k] = upwards(r[k]);
    ask_hit *h = trace(&w, r, RAYS);
    for (int k = 0; k < RAYS; k++) {
        if (!h[k].found) continue;
        r[n] = r[k];
        r[n++].tmax = h[k].hit.t * (k % 2 ? 0.99f : 1.01f);
        cut += k % 2;
    }
    expect_hits(check_all(&w, r, (size_t)n, "a ray that ends just before or just behind its nearest hit"), 200,
                "rays that end behind a hit");
    expect_hits(cut, 200, "rays that end before a hit");
}

static void far_origins_are_met(void)
{
    enum { N = 1000 };
    uint64_t seed = mark_seed(6);
    world w;
    world_init(&w, soup_mesh(mark_size(300), 0.2, mark_seed(14)), 0);
    static ray there[N], away[N];

    for (int k = 0; k < N; k++) {
        const vec3 to = random_point(&seed, 0, 1);
        const vec3 o = add(to, mul(random_direction(&seed), 500));
        there[k] = (ray){o, normalize(sub(to, o)), INFINITY};
        away[k] = (ray){o, neg(there[k].d), INFINITY};
    }
    check_all(&w, away, N, "a ray that flies away from the box");
    expect_hits(check_all(&w, there, N, "an origin 500 boxes away"), 200, "far origins");
}

static void work(void)
{
    enum { LOOKED_AT = 100 }; /* rays: who leaves out a share p of the work gets by with probability (1 - p)^100 */
    const size_t n = mark_size(60000);
    uint64_t seed = mark_seed(7);
    world w;
    world_init(&w, soup_mesh(mark_size(20000), 0.03, mark_seed(15)), 8);
    ray *r = random_rays(&seed, 0.5, n);
    ask_hit *h = trace(&w, r, n);

    for (int i = 0; i < LOOKED_AT; i++) {
        const size_t k = (size_t)(random_double(&seed) * (double)n);
        check(&w, &r[k], &h[k], "the load that is timed");
    }
}

int main(int argc, char **argv)
{
    static const mark_claim claims[] = {
        {"one_triangle_is_hit_and_missed", 10, one_triangle_is_hit_and_missed},
        {"small_triangles_from_outside_are_met", 10, small_triangles_from_outside_are_met},
        {"small_triangles_from_inside_are_met", 5, small_triangles_from_inside_are_met},
        {"the_nearest_of_large_triangles_is_found", 15, the_nearest_of_large_triangles_is_found},
        {"only_the_cells_on_the_way_are_looked_at", 10, only_the_cells_on_the_way_are_looked_at},
        {"rays_along_an_axis_are_met", 10, rays_along_an_axis_are_met},
        {"the_last_cell_is_visited", 5, the_last_cell_is_visited},
        {"tmax_ends_the_ray", 10, tmax_ends_the_ray},
        {"far_origins_are_met", 5, far_origins_are_met},
    };

    return mark_main(argc, argv, claims, sizeof claims / sizeof *claims, work, 8.0);
}
