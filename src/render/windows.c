/* SPDX-License-Identifier: BSD-2-Clause */
/* windows: rectangles that serve as portals, found without being told.
 *
 * Rays start where camera rays of the whole picture end. If few escape, it is asked which planes that shapes lie in
 * they cross. All triangles leave segments in such a plane. About a crossing the nearest segments in four directions,
 * along the nearest of all and across it, are a rectangle. It is a window if segments cover its sides and none lies
 * inside. So its corners are exactly those of the shapes, because a portal a little too small saves little
 * (docs/theory.md). Of the rectangles on its way a ray votes for the last, the outer edge of a wall. Rays vote anew for
 * the one that looks smallest: this is the window in a loggia, where the last is the loggia's open side, which has up
 * to 1.9 times the error x time of no portal. It is taken where the sum of areas is at most a third.
 *
 * Portals pay as long as little light comes in, and through few of them. Where a share s of the rays escapes, error x
 * time is .03 to .4 of that without for s < .14, .5 to 1.0 for .41, 1.04 to 2 for .69; with 4, 8 and 14 windows of a
 * hall .4 to .9, .4 to 1.1, and 1.3 to 2.5. Hence the bounds of windows.h. (Diffuse surfaces; where all is a Phong of
 * exponent 1000 and s = .14, .2 to 1.1.)
 *
 * Rays are the same for crops, parts and threads. Cost: in the open some 20 rays, else 4096 of the camera and as many
 * from surfaces, 200 ns a triangle for the planes, and 5 ns a triangle and plane, a sixth of the
 * time of Embree's tree; up to 1.7 of its time where millions lie in planes that rays cross. */
#include "windows.h"

#include "base/grow.h"
#include "bis/base/hash.h"
#include "bis/base/mem.h"
#include "bis/thesis/warp.h"

#include <math.h>
#include <string.h>

enum { RAYS = 4096, ESCAPED = 64, SLOTS = 4096, PLANES = 16, FOUND = 64, MARKS = 32, MOST = 4 };

static void take(double to[3], vec3 v) { to[0] = (double)v.x, to[1] = (double)v.y, to[2] = (double)v.z; }

static void corners_of(double p[3][3], const bis_geometry *g, size_t t)
{
    for (size_t k = 0; k < 3; k++) take(p[k], g->p[g->index[3 * t + k]]);
}

/* ---- rays that escape ---- */

typedef struct line {
    double o[3], d[3];
} line;

/* Stores those that escape in a room, escaped[ESCAPED], and returns their number, or 0 in the open. What a camera ray
 * sees without a surface is open, and so is a place from where two opposite rays escape. Where the rays are is a
 * recurrence by powers of 1/g, g^5 = g + 1 (Roberts 2018). */
static uint32_t look_out(line *escaped, const bis_scene *s, const bis_camera *camera, const bis_film *film)
{
    const int width = film->picture_width, height = film->picture_height;
    static const double step[4] = {0.8566748838545029, 0.733891856627126, 0.6287067210378086, 0.53859725722361};
    uint32_t n = 0, open = 0, i;

    for (i = 0; i < RAYS && n < ESCAPED; i++) {
        double u[4];
        for (int k = 0; k < 4; k++) u[k] = (i + 1) * step[k] - floor((i + 1) * step[k]);
        const ray eye = bis_camera_ray(camera, width, height, u[0] * width, u[1] * height);
        bis_surface at = {.p = eye.o, .ng = neg(eye.d)}; /* a given point, if there is no camera */
        bis_hit hit;
        const bool sees = camera->points || bis_accel_intersect(s->accel, &eye, &hit);
        if (sees && !camera->points) bis_geometry_surface(&s->geometry, hit.prim, &eye, &at);
        const frame f = frame_about(at.ng);
        const vec3 o = bis_surface_offset(&at), w = bis_warp_cosine(u[2], u[3]);
        const ray one = {o, to_world(&f, w), INFINITY}, other = {o, to_world(&f, (vec3){-w.x, -w.y, w.z}), INFINITY};
        if (sees && bis_accel_occluded(s->accel, &one)) continue;
        if (sees && bis_accel_occluded(s->accel, &other)) {
            take(escaped[n].o, o);
            take(escaped[n++].d, one.d);
        } else {
            open++;
        }
        if (open + n > 16 + i / 4) return 0;
    }
    return 4 * (open + n) > i ? 0 : n;
}

/* ---- planes ---- */

/* n x = d, and a box about the triangles in it. What is nearer than `tolerance` lies in it. */
typedef struct plane {
    uint64_t key; /* the same of planes that are nearly the same */
    double area, n[3], d, tolerance, low[3], high[3];
    uint32_t crossed; /* by so many rays within the box */
} plane;

/* The plane of a triangle; false: it has none. Floats are exact to 2^-24 of `far`. */
static bool plane_of(plane *q, double p[3][3], double far)
{
    double e[2][3];
    int most = 0;

    for (int i = 0; i < 6; i++) e[i / 3][i % 3] = p[1 + i / 3][i % 3] - p[0][i % 3];
    cross3(q->n, e[0], e[1]);
    for (int i = 1; i < 3; i++)
        if (fabs(q->n[i]) > 1.001 * fabs(q->n[most])) most = i; /* the sign is to be that of its neighbours */
    const double size = copysign(sqrt(dot3(q->n, q->n)), q->n[most]);
    q->key = 0;
    if (!(fabs(size) > 0)) return false;
    for (int i = 0; i < 3; i++) {
        q->n[i] /= size;
        q->key = q->key << 16 | (uint64_t)(q->n[i] * 0x1p12 + 0x1p13);
        q->low[i] = q->high[i] = p[0][i];
        for (int k = 1; k < 3; k++) {
            if (p[k][i] < q->low[i]) q->low[i] = p[k][i];
            if (p[k][i] > q->high[i]) q->high[i] = p[k][i];
        }
    }
    q->d = dot3(q->n, p[0]);
    q->key = bis_hash(q->key ^ bis_hash((uint64_t)(q->d / far * 0x1p18 + 0x1p20)));
    q->area = fabs(size) / 2;
    q->tolerance = 0x1p-16 * sqrt(q->area) + 0x1p-20 * far;
    return true;
}

/* Of the planes that share a slot the one stays that has most of their area (Boyer and Moore 1981). It is that of its
 * largest triangle, which is the most exact. */
static void find_planes(plane *slots, const bis_geometry *g)
{
    double p[3][3], low[3], high[3], far = 0;

    take(low, g->box.lo);
    take(high, g->box.hi);
    for (int i = 0; i < 3; i++) far = fmax(far, fmax(fabs(low[i]), fabs(high[i])));
    for (size_t t = 0; t < g->n_triangles; t++) {
        plane q = {.crossed = 0};
        corners_of(p, g, t);
        if (!plane_of(&q, p, far)) continue;
        plane *s = &slots[q.key % SLOTS];
        if (s->key != q.key && s->area > q.area) {
            s->area -= q.area;
        } else if (s->key != q.key) {
            q.area -= s->area;
            *s = q;
        } else {
            for (int i = 0; i < 3; i++) {
                s->low[i] = q.low[i] = fmin(s->low[i], q.low[i]);
                s->high[i] = q.high[i] = fmax(s->high[i], q.high[i]);
            }
            s->area = q.area += s->area;
            if (q.tolerance > s->tolerance) *s = q;
        }
    }
}

/* Where a ray crosses the plane, if that is in its box. */
static bool cross_at(double x[3], const plane *q, const line *r)
{
    const double c = dot3(q->n, r->d), t = c != 0 ? (q->d - dot3(q->n, r->o)) / c : 0;
    bool is_in = t > 0 && isfinite(t);

    for (int i = 0; i < 3; i++) {
        x[i] = r->o[i] + t * r->d[i];
        is_in &= x[i] > q->low[i] - q->tolerance && x[i] < q->high[i] + q->tolerance;
    }
    return is_in;
}

/* ---- the section of a plane ---- */

typedef struct segment {
    double p[2][2];
} segment;

typedef struct section {
    double axis[2][3]; /* unit vectors in the plane */
    segment *s;
    size_t n, capacity;
} section;

/* A triangle in the plane leaves its edges, one that touches it with an edge this edge, one that it cuts a segment.
 * false: no memory. */
static bool cut_triangle(section *c, const plane *q, double p[3][3])
{
    double h[3], x[3][3];
    int side[3], n = 0;

    for (int k = 0; k < 3; k++) {
        h[k] = dot3(q->n, p[k]) - q->d;
        side[k] = (h[k] > q->tolerance) - (h[k] < -q->tolerance);
    }
    for (int k = 0, j = 1; k < 3; k++, j = (k + 1) % 3) {
        if (side[k] == 0) memcpy(x[n++], p[k], sizeof x[0]);
        if (side[k] * side[j] >= 0) continue;
        for (int i = 0; i < 3; i++) x[n][i] = p[k][i] + (p[j][i] - p[k][i]) * (h[k] / (h[k] - h[j]));
        n++;
    }
    for (int k = 0; k < (n == 3 ? 3 : n - 1); k++) {
        if (!BIS_ROOM(c->s, c->capacity, c->n)) return false;
        for (int i = 0; i < 4; i++) c->s[c->n].p[i / 2][i % 2] = dot3(c->axis[i % 2], x[(k + i / 2) % 3]);
        c->n++;
    }
    return true;
}

/* Makes the section of another plane. false: no memory. */
static bool cut(section *c, const plane *q, const bis_geometry *g)
{
    double p[3][3];
    int most = 0;

    for (int i = 1; i < 3; i++)
        if (fabs(q->n[i]) > fabs(q->n[most])) most = i;
    double *a = c->axis[0];
    const int next = (most + 1) % 3; /* an axis of the world, if the plane has one */
    for (int i = 0; i < 3; i++) a[i] = (i == next) - q->n[i] * q->n[next];
    const double size = sqrt(dot3(a, a));
    for (int i = 0; i < 3; i++) a[i] /= size;
    cross3(c->axis[1], q->n, a);
    c->n = 0;
    for (size_t t = 0; t < g->n_triangles; t++) {
        corners_of(p, g, t);
        if (!cut_triangle(c, q, p)) return false;
    }
    return true;
}

/* ---- rectangles ---- */

/* Turns the section so that the segment nearest to a point lies along its first axis, and stores the point in x. */
static void turn(double x[2], section *c, const double at[3])
{
    double least = HUGE_VAL, by[2] = {1, 0};

    for (int k = 0; k < 2; k++) x[k] = dot3(c->axis[k], at);
    for (const segment *s = c->s; s < c->s + c->n; s++) {
        const double d[2] = {s->p[1][0] - s->p[0][0], s->p[1][1] - s->p[0][1]};
        const double v[2] = {x[0] - s->p[0][0], x[1] - s->p[0][1]}, size = hypot(d[0], d[1]);
        if (!(size > 0)) continue;
        const double t = fmin(fmax((v[0] * d[0] + v[1] * d[1]) / (size * size), 0), 1);
        const double off = hypot(v[0] - t * d[0], v[1] - t * d[1]);
        if (!(off < least)) continue;
        least = off;
        for (int k = 0; k < 2; k++) by[k] = d[k] / size;
    }
    for (int i = 0; i < 3; i++) {
        const double a = c->axis[0][i], b = c->axis[1][i];
        c->axis[0][i] = by[0] * a + by[1] * b;
        c->axis[1][i] = by[0] * b - by[1] * a;
    }
    for (size_t i = 0; i < 2 * c->n; i++) {
        double *p = c->s[i / 2].p[i % 2];
        const double a = p[0], b = p[1];
        p[0] = by[0] * a + by[1] * b;
        p[1] = by[0] * b - by[1] * a;
    }
    for (int k = 0; k < 2; k++) x[k] = dot3(c->axis[k], at);
}

/* The limits side[k] of the rectangle about x along axis k. */
static void reach(double side[2][2], const section *c, const double x[2])
{
    for (int k = 0; k < 4; k++) side[k / 2][k % 2] = k % 2 ? HUGE_VAL : -HUGE_VAL;
    for (size_t i = 0; i < 2 * c->n; i++) {
        const size_t k = i % 2;
        const double(*p)[2] = (const double(*)[2])c->s[i / 2].p;
        const double a = p[0][1 - k] - x[1 - k], b = p[1][1 - k] - x[1 - k];
        if (a == b || a * b > 0) continue;
        const double at = p[0][k] + (p[1][k] - p[0][k]) * (a / (a - b));
        if (at <= x[k]) side[k][0] = fmax(side[k][0], at);
        else side[k][1] = fmin(side[k][1], at);
    }
}

/* Whether a part of the segment lies inside the rectangle. */
static bool is_inside(const segment *s, double side[2][2], double tolerance)
{
    double first = 0, last = 1;

    for (int k = 0; k < 2; k++) {
        const double a = s->p[0][k], d = s->p[1][k] - a, low = side[k][0] + tolerance, high = side[k][1] - tolerance;
        if (d == 0 && (a <= low || a >= high)) return false;
        if (d == 0) continue;
        first = fmax(first, fmin((low - a) / d, (high - a) / d));
        last = fmin(last, fmax((low - a) / d, (high - a) / d));
    }
    return first < last;
}

/* The marks on a side, which goes along axis k, that the segment covers. */
static uint32_t covered(const segment *s, int k, const double side[2], double tolerance)
{
    const double low = fmin(s->p[0][k], s->p[1][k]) - tolerance, high = fmax(s->p[0][k], s->p[1][k]) + tolerance;
    uint32_t marks = 0;

    for (int i = 0; i < MARKS; i++) {
        const double x = side[0] + (side[1] - side[0]) * (i + 0.5) / MARKS;
        if (x >= low && x <= high) marks |= 1u << i;
    }
    return marks;
}

/* The window in which a point of the plane lies; false: it lies in none. */
static bool find_window(bis_portal *w, section *c, const plane *q, const double at[3])
{
    const double near = q->tolerance;
    double x[2], side[2][2];
    uint32_t marks[4] = {0};

    turn(x, c, at);
    reach(side, c, x);
    const double size = fmin(side[0][1] - side[0][0], side[1][1] - side[1][0]);
    if (!(size > 8 * near) || !isfinite(side[0][1] - side[0][0] + side[1][1] - side[1][0])) return false;
    for (const segment *s = c->s; s < c->s + c->n; s++) {
        if (is_inside(s, side, 2 * near)) return false;
        for (int i = 0; i < 4; i++) {
            const int k = i / 2;
            const double limit = side[k][i % 2];
            if (fabs(s->p[0][k] - limit) <= near && fabs(s->p[1][k] - limit) <= near)
                marks[i] |= covered(s, 1 - k, side[1 - k], near);
        }
    }
    for (int i = 0; i < 3; i++) {
        w->corner[i] = q->d * q->n[i] + side[0][0] * c->axis[0][i] + side[1][0] * c->axis[1][i];
        for (int k = 0; k < 2; k++) w->edge[k][i] = (side[k][1] - side[k][0]) * c->axis[k][i];
    }
    return (marks[0] & marks[1] & marks[2] & marks[3]) == UINT32_MAX;
}

/* The distance at which a ray passes the rectangle; 0: it does not. */
static double passes(const bis_portal *w, const line *r)
{
    const double *a = w->edge[0], *b = w->edge[1];
    double v[3], n[3];

    cross3(n, a, b);
    for (int i = 0; i < 3; i++) v[i] = w->corner[i] - r->o[i];
    const double c = dot3(n, r->d), t = c != 0 ? dot3(n, v) / c : 0;
    for (int i = 0; i < 3; i++) v[i] = t * r->d[i] - v[i];
    const double x = dot3(v, a) / dot3(a, a), y = dot3(v, b) / dot3(b, b);
    return t > 0 && isfinite(t) && x >= 0 && x <= 1 && y >= 0 && y <= 1 ? t : 0;
}

/* ---- all of it ---- */

typedef struct search {
    line escaped[ESCAPED];
    uint32_t n_escaped;
    plane slots[SLOTS];
    section section;
    bis_portal found[FOUND];
    uint32_t n_found;
} search;

/* The plane that most rays cross, of those that at least a sixteenth does; NULL: there is none. */
static plane *next_plane(search *s)
{
    plane *best = s->slots;

    for (plane *q = s->slots; q < s->slots + SLOTS; q++)
        if (q->crossed > best->crossed) best = q;
    return best->crossed && 16 * best->crossed >= s->n_escaped ? best : NULL;
}

/* false: no memory. */
static bool search_plane(search *s, const plane *q, const bis_geometry *g)
{
    const uint32_t first = s->n_found;

    if (!cut(&s->section, q, g)) return false;
    for (const line *r = s->escaped; r < s->escaped + s->n_escaped && s->n_found < FOUND; r++) {
        double x[3];
        bool is_new = cross_at(x, q, r);
        for (uint32_t j = first; j < s->n_found && is_new; j++) is_new = passes(&s->found[j], r) == 0;
        if (is_new && find_window(&s->found[s->n_found], &s->section, q, x)) s->n_found++;
    }
    return true;
}

/* Panes and slits: *a becomes the rectangle around both, if they lie in a plane and fill four fifths of it, because
 * each portal takes time. */
static bool join(bis_portal *a, const bis_portal *b)
{
    double n[3], m[3], v[3], low[2] = {0, 0}, high[2] = {1, 1};

    cross3(n, a->edge[0], a->edge[1]);
    cross3(m, b->edge[0], b->edge[1]);
    const double size = sqrt(dot3(n, n));
    for (int i = 0; i < 4; i++) {
        for (int k = 0; k < 3; k++) v[k] = b->corner[k] - a->corner[k] + i % 2 * b->edge[0][k] + i / 2 * b->edge[1][k];
        if (fabs(dot3(n, v)) > 1e-4 * size * sqrt(size)) return false;
        for (int k = 0; k < 2; k++) {
            const double at = dot3(v, a->edge[k]) / dot3(a->edge[k], a->edge[k]);
            low[k] = fmin(low[k], at);
            high[k] = fmax(high[k], at);
        }
    }
    if ((high[0] - low[0]) * (high[1] - low[1]) > 1.25 * (1 + sqrt(dot3(m, m)) / size)) return false;
    for (int i = 0; i < 3; i++) {
        a->corner[i] += low[0] * a->edge[0][i] + low[1] * a->edge[1][i];
        for (int k = 0; k < 2; k++) a->edge[k][i] *= high[k] - low[k];
    }
    return true;
}

/* false: there are no two. */
static bool join_two(search *s, uint32_t votes[FOUND])
{
    for (uint32_t j = 0; j < s->n_found; j++) {
        for (uint32_t k = j + 1; k < s->n_found && votes[j]; k++) {
            if (!votes[k] || !join(&s->found[j], &s->found[k])) continue;
            votes[j] += votes[k];
            votes[k] = 0;
            return true;
        }
    }
    return false;
}

static double area_of(const bis_portal *w) { return sqrt(dot3(w->edge[0], w->edge[0]) * dot3(w->edge[1], w->edge[1])); }

/* Each ray votes for the last rectangle on its way, or for that which looks smallest. */
static void vote(uint32_t votes[FOUND], const search *s, bool smallest)
{
    memset(votes, 0, FOUND * sizeof *votes);
    for (const line *r = s->escaped; r < s->escaped + s->n_escaped; r++) {
        double most = 0;
        uint32_t best = 0;
        for (uint32_t j = 0; j < s->n_found; j++) {
            const double t = passes(&s->found[j], r), rank = smallest ? t * t / area_of(&s->found[j]) : t;
            if (rank > most) most = rank, best = j;
        }
        votes[best] += most > 0;
    }
}

/* Stores windows and their number, and returns the sum of their areas. What fewer than an eighth of the rays passes is
 * left out where the smallest are asked for. */
static double choose(bis_portal windows[MOST], uint32_t *n, search *s, bool smallest)
{
    uint32_t votes[FOUND], all = 0;
    double area = 0;

    *n = 0;
    vote(votes, s, smallest);
    while (join_two(s, votes)) {}
    for (uint32_t j = 0; j < s->n_found; j++) {
        if (!votes[j] || (smallest && 8 * votes[j] < s->n_escaped)) continue;
        if (*n < MOST) windows[*n] = s->found[j];
        ++*n;
        all += votes[j];
        area += area_of(&s->found[j]);
    }
    if (*n > MOST || 4 * all < 3 * s->n_escaped) *n = 0;
    return area;
}

static uint32_t choose_either(bis_portal windows[MOST], search *s)
{
    static const size_t bytes = sizeof s->found;
    bis_portal small[MOST], found[FOUND];
    uint32_t n, n_small;

    memcpy(found, s->found, bytes); /* panes are joined in place */
    const double area = choose(windows, &n, s, false);
    memcpy(s->found, found, bytes);
    const double of_small = choose(small, &n_small, s, true);
    if (!n || !n_small || 3 * of_small > area) return n;
    memcpy(windows, small, sizeof small);
    return n_small;
}

bis_status bis_windows_find(bis_portal *windows, uint32_t *n, const bis_scene *scene, const bis_camera *camera,
                            const bis_film *film, bis_diag *diag)
{
    search *s = bis_alloc(1, sizeof *s);
    bool good = s != NULL;
    double x[3];
    plane *q;

    *n = 0;
    if (good && scene->geometry.n_triangles) s->n_escaped = look_out(s->escaped, scene, camera, film);
    if (good && s->n_escaped) {
        find_planes(s->slots, &scene->geometry);
        for (q = s->slots; q < s->slots + SLOTS; q++)
            for (uint32_t i = 0; i < s->n_escaped && q->area > 0; i++) q->crossed += cross_at(x, q, &s->escaped[i]);
        for (int k = 0; k < PLANES && good && (q = next_plane(s)); k++) {
            good = search_plane(s, q, &scene->geometry);
            q->crossed = 0;
        }
        if (good) *n = choose_either(windows, s);
        bis_free(s->section.s);
    }
    bis_free(s);
    return good ? BIS_OK : bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory to look for windows");
}
