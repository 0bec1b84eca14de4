/* SPDX-License-Identifier: BSD-2-Clause */
/* windows: rectangles that serve as portals, without being told.
 *
 * Rays start where camera rays of the whole picture end. Where few of them escape, the planes are sought that most
 * shapes lie in, and of these the ones that escaped rays cross. The section of all triangles with such a plane is a set
 * of segments. About the place of a crossing the nearest segments in four directions make a rectangle: parallel to the
 * nearest one of all, which is an edge of the opening. It is a window if its sides are covered by segments and none
 * lies inside. So it has the exact coordinates of the shapes, which matters (docs/theory.md). Of several on its way an
 * escaped ray votes for the last, which is the outer edge of a wall.
 *
 * All rays are fixed: crops, parts and threads find the same. Cost: in the open about 20 rays, else at most 8192 and
 * some ns for each triangle and plane. */
#include "windows.h"

#include "base/grow.h"
#include "bis/base/hash.h"
#include "bis/base/mem.h"
#include "bis/thesis/warp.h"

#include <math.h>
#include <string.h>

enum { RAYS = 4096, ESCAPED = 64, SLOTS = 4096, PLANES = 16, RECTANGLES = 64, MARKS = 32 };

/* ---- rays that escape ---- */

/* Additive recurrence in four dimensions by powers of the root of g^5 = g + 1 (Roberts 2018). */
static void place_of_ray(double u[4], int i)
{
    const double g = 1.16730397826141868;

    for (int k = 0; k < 4; k++) u[k] = fmod((i + 1) * pow(g, -1 - k), 1);
}

/* Stores the rays in escaped[ESCAPED] and returns their number, or 0 in the open. A camera ray that sees no surface
 * escapes, too. */
static uint32_t look_out(ray *escaped, const bis_scene *s, const bis_camera *camera, const bis_film *film)
{
    const int width = film->picture_width, height = film->picture_height;
    uint32_t n = 0;
    int missed = 0, i;

    for (i = 0; i < RAYS && n < ESCAPED; i++) {
        double u[4];
        place_of_ray(u, i);
        const ray eye = bis_camera_ray(camera, width, height, u[0] * width, u[1] * height);
        bis_surface at = {.p = eye.o, .ng = neg(eye.d)};
        bis_hit hit;
        if (!camera->points && !bis_accel_intersect(s->accel, &eye, &hit)) {
            missed++;
        } else {
            if (!camera->points) bis_geometry_surface(&s->geometry, hit.prim, &eye, &at);
            const frame f = frame_about(at.ng);
            const ray r = {bis_surface_offset(&at), to_world(&f, bis_warp_cosine(u[2], u[3])), INFINITY};
            if (!bis_accel_occluded(s->accel, &r)) escaped[n++] = r;
        }
        if (missed + (int)n > 16 + i / 4) return 0;
    }
    return 4 * (missed + (int)n) > i ? 0 : n;
}

/* ---- planes ---- */

/* n x = d, and a box around the triangles in it. What is nearer than `tolerance` lies in it. */
typedef struct plane {
    uint64_t key;
    double n[3], d, tolerance, area;
    bis_box box;
    uint32_t crossed; /* by so many rays within the box */
} plane;

static void triangle_of(double p[3][3], const bis_geometry *g, size_t t)
{
    for (int k = 0; k < 3; k++) {
        const vec3 v = g->p[g->index[3 * t + (size_t)k]];
        p[k][0] = (double)v.x, p[k][1] = (double)v.y, p[k][2] = (double)v.z;
    }
}

/* far: the largest coordinate of the geometry, by which floats are exact. Triangles that are smaller than a millionth
 * of its square are no walls. */
static bool plane_of(plane *q, double p[3][3], double far)
{
    double n[3], e[2][3], d = 0;

    for (int i = 0; i < 6; i++) e[i / 3][i % 3] = p[1 + i / 3][i % 3] - p[0][i % 3];
    for (int i = 0; i < 3; i++) n[i] = e[0][(i + 1) % 3] * e[1][(i + 2) % 3] - e[0][(i + 2) % 3] * e[1][(i + 1) % 3];
    const double square = dot3(n, n);
    if (!(square > 1e-12 * far * far * far * far)) return false;
    int most = 0;
    for (int i = 1; i < 3; i++)
        if (fabs(n[i]) > fabs(n[most]) * 1.001) most = i;
    const double size = copysign(sqrt(square), n[most]);
    q->key = 0;
    q->box = (bis_box){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    for (int i = 0; i < 3; i++) {
        q->n[i] = n[i] / size;
        d += q->n[i] * p[0][i];
        q->key = bis_hash(q->key ^ (uint64_t)llrint(q->n[i] * 0x1p12));
        bis_box_include(&q->box, vec3_from(p[i][0], p[i][1], p[i][2]));
    }
    q->key = bis_hash(q->key ^ (uint64_t)llrint(d / far * 0x1p18));
    q->d = d;
    q->area = fabs(size) / 2;
    q->tolerance = 0x1p-16 * sqrt(q->area) + 0x1p-20 * far;
    return true;
}

/* Of the planes that share a slot the one stays that has the most of their area, if it has half of it (Boyer and Moore
 * 1981). It is that of its largest triangle, which is the most exact. */
static void find_planes(plane *slots, const bis_geometry *g)
{
    const double low[3] = {(double)g->box.lo.x, (double)g->box.lo.y, (double)g->box.lo.z};
    const double high[3] = {(double)g->box.hi.x, (double)g->box.hi.y, (double)g->box.hi.z};
    double p[3][3], far = 0;

    for (int i = 0; i < 3; i++) far = fmax(far, fmax(fabs(low[i]), fabs(high[i])));
    for (size_t t = 0; t < g->n_triangles; t++) {
        plane q = {.crossed = 0};
        triangle_of(p, g, t);
        if (!plane_of(&q, p, far)) continue;
        plane *s = &slots[q.key % SLOTS], old = *s;
        if (old.area > 0 && old.key == q.key) {
            if (q.tolerance > old.tolerance) *s = q;
            s->area = old.area + q.area;
            s->box = old.box;
            bis_box_include(&s->box, q.box.lo);
            bis_box_include(&s->box, q.box.hi);
        } else if (old.area > q.area) {
            s->area -= q.area;
        } else {
            *s = q;
            s->area -= old.area;
        }
    }
}

/* Where a ray crosses the plane, if that is in its box. */
static bool cross_at(double x[3], const plane *q, const ray *r)
{
    const double o[3] = {(double)r->o.x, (double)r->o.y, (double)r->o.z};
    const double d[3] = {(double)r->d.x, (double)r->d.y, (double)r->d.z};
    const double low[3] = {(double)q->box.lo.x, (double)q->box.lo.y, (double)q->box.lo.z};
    const double high[3] = {(double)q->box.hi.x, (double)q->box.hi.y, (double)q->box.hi.z};
    const double t = (q->d - dot3(q->n, o)) / dot3(q->n, d);
    bool is_in = t > 0 && isfinite(t);

    for (int i = 0; i < 3; i++) {
        x[i] = o[i] + t * d[i];
        is_in &= x[i] > low[i] - q->tolerance && x[i] < high[i] + q->tolerance;
    }
    return is_in;
}

/* The plane that most rays cross of those left; NULL: fewer than a sixteenth cross any. */
static plane *next_plane(plane *slots, uint32_t n)
{
    plane *best = slots;

    for (plane *s = slots; s < slots + SLOTS; s++)
        if (s->crossed > best->crossed) best = s;
    return 16 * best->crossed >= n && best->crossed ? best : NULL;
}

/* ---- the section of a plane ---- */

typedef struct segment {
    double p[2][2];
} segment;

typedef struct section {
    double axis[2][3]; /* of the plane */
    segment *s;
    size_t n, capacity;
} section;

static bool add_segment(section *c, const double a[3], const double b[3])
{
    if (!BIS_ROOM(c->s, c->capacity, c->n)) return false;
    segment *s = &c->s[c->n++];
    for (int k = 0; k < 2; k++) {
        s->p[0][k] = dot3(c->axis[k], a);
        s->p[1][k] = dot3(c->axis[k], b);
    }
    return true;
}

/* A triangle in the plane leaves its edges, one that touches it with an edge this edge, one that it cuts a segment. */
static bool cut_triangle(section *c, const plane *q, double p[3][3])
{
    double h[3], x[3][3];
    int side[3], n = 0;

    for (int k = 0; k < 3; k++) {
        h[k] = dot3(q->n, p[k]) - q->d;
        side[k] = h[k] > q->tolerance ? 1 : h[k] < -q->tolerance ? -1 : 0;
    }
    if (side[0] == side[1] && side[1] == side[2] && side[0] != 0) return true;
    for (int k = 0; k < 3; k++) {
        const int j = (k + 1) % 3;
        if (side[k] == 0) memcpy(x[n++], p[k], sizeof x[0]);
        if (side[k] * side[j] >= 0) continue;
        for (int i = 0; i < 3; i++) x[n][i] = p[k][i] + (p[j][i] - p[k][i]) * (h[k] / (h[k] - h[j]));
        n++;
    }
    bool good = n < 2 || add_segment(c, x[0], x[1]);
    for (int k = 1; k < n && n == 3 && good; k++) good = add_segment(c, x[k], x[(k + 1) % 3]);
    return good;
}

/* Empties the section and makes that of another plane. false: no memory. */
static bool cut(section *c, const plane *q, const bis_geometry *g)
{
    double p[3][3];
    int most = 0;
    bool good = true;

    for (int i = 1; i < 3; i++)
        if (fabs(q->n[i]) > fabs(q->n[most])) most = i;
    double *a = c->axis[0], *b = c->axis[1];
    const int next = (most + 1) % 3; /* an axis in the plane, along that of the world where it can be */
    for (int i = 0; i < 3; i++) a[i] = (i == next) - q->n[i] * q->n[next];
    const double size = sqrt(dot3(a, a));
    for (int i = 0; i < 3; i++) a[i] /= size;
    for (int i = 0; i < 3; i++) b[i] = q->n[(i + 1) % 3] * a[(i + 2) % 3] - q->n[(i + 2) % 3] * a[(i + 1) % 3];
    c->n = 0;
    for (size_t t = 0; t < g->n_triangles && good; t++) {
        triangle_of(p, g, t);
        good = cut_triangle(c, q, p);
    }
    return good;
}

/* ---- rectangles ---- */

/* The direction of the segment that is nearest to x. */
static void nearest(double turn[2], const section *c, const double x[2])
{
    double least = HUGE_VAL;

    for (const segment *s = c->s; s < c->s + c->n; s++) {
        const double d[2] = {s->p[1][0] - s->p[0][0], s->p[1][1] - s->p[0][1]};
        const double v[2] = {x[0] - s->p[0][0], x[1] - s->p[0][1]}, l2 = d[0] * d[0] + d[1] * d[1];
        if (!(l2 > 0)) continue;
        const double t = fmin(fmax((v[0] * d[0] + v[1] * d[1]) / l2, 0), 1), off = hypot(v[0] - t * d[0], v[1] - t * d[1]);
        if (off >= least) continue;
        least = off;
        turn[0] = d[0] / sqrt(l2);
        turn[1] = d[1] / sqrt(l2);
    }
}

static segment turned(const segment *s, const double turn[2])
{
    segment r;

    for (int e = 0; e < 2; e++) {
        r.p[e][0] = turn[0] * s->p[e][0] + turn[1] * s->p[e][1];
        r.p[e][1] = turn[0] * s->p[e][1] - turn[1] * s->p[e][0];
    }
    return r;
}

/* The marks of a side from low to high that the segment's part from a to b covers. */
static uint32_t covered(double low, double high, double a, double b, double tolerance)
{
    uint32_t marks = 0;

    for (int k = 0; k < MARKS; k++) {
        const double x = low + (high - low) * (k + 0.5) / MARKS;
        if (x >= fmin(a, b) - tolerance && x <= fmax(a, b) + tolerance) marks |= 1u << k;
    }
    return marks;
}

/* Whether the segment has a part within the rectangle, but for its rim. */
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

/* The rectangle about x in the turned plane: side[k] are its limits along axis k. */
static void reach(double side[2][2], const section *c, const double turn[2], const double x[2])
{
    for (int k = 0; k < 4; k++) side[k / 2][k % 2] = k % 2 ? HUGE_VAL : -HUGE_VAL;
    for (const segment *s = c->s; s < c->s + c->n; s++) {
        const segment r = turned(s, turn);
        for (int k = 0; k < 2; k++) {
            const double a = r.p[0][1 - k] - x[1 - k], b = r.p[1][1 - k] - x[1 - k];
            if (a == b || a * b > 0) continue;
            const double at = r.p[0][k] + (r.p[1][k] - r.p[0][k]) * (a / (a - b));
            if (at <= x[k]) side[k][0] = fmax(side[k][0], at);
            else side[k][1] = fmin(side[k][1], at);
        }
    }
}

/* The window of the section in which x lies. false: it is none. */
static bool find_window(bis_portal *w, const section *c, const plane *q, const double at[3])
{
    const double in_plane[2] = {dot3(c->axis[0], at), dot3(c->axis[1], at)};
    double turn[2] = {1, 0}, side[2][2], corner[4][3];
    uint32_t marks[2][2] = {{0}};

    nearest(turn, c, in_plane);
    const segment place = {{{in_plane[0], in_plane[1]}}}, x = turned(&place, turn);
    reach(side, c, turn, x.p[0]);
    const double least = fmin(side[0][1] - side[0][0], side[1][1] - side[1][0]);
    const double tolerance = q->tolerance;
    if (!(least > 8 * tolerance) || !isfinite(side[0][1] - side[0][0]) || !isfinite(side[1][1] - side[1][0]))
        return false;
    for (const segment *s = c->s; s < c->s + c->n; s++) {
        const segment r = turned(s, turn);
        if (is_inside(&r, side, 2 * tolerance)) return false;
        for (int k = 0; k < 4; k++) {
            const double *along = side[1 - k / 2], limit = side[k / 2][k % 2];
            if (fabs(r.p[0][k / 2] - limit) <= tolerance && fabs(r.p[1][k / 2] - limit) <= tolerance)
                marks[k / 2][k % 2] |= covered(along[0], along[1], r.p[0][1 - k / 2], r.p[1][1 - k / 2], tolerance);
        }
    }
    for (int k = 0; k < 4; k++) {
        const double a = side[0][k == 1 || k == 2], b = side[1][k > 1]; /* going around it */
        const double u = turn[0] * a - turn[1] * b, v = turn[1] * a + turn[0] * b;
        for (int i = 0; i < 3; i++) corner[k][i] = q->d * q->n[i] + u * c->axis[0][i] + v * c->axis[1][i];
        if (marks[k / 2][k % 2] != UINT32_MAX) return false;
    }
    for (int i = 0; i < 3; i++) {
        w->corner[i] = corner[0][i];
        w->edge[0][i] = corner[1][i] - corner[0][i];
        w->edge[1][i] = corner[3][i] - corner[0][i];
    }
    return true;
}

/* The distance at which a ray passes the rectangle; 0: it does not. */
static double passes(const bis_portal *w, const ray *r)
{
    const double *a = w->edge[0], *b = w->edge[1];
    double v[3], n[3];
    const double o[3] = {(double)r->o.x, (double)r->o.y, (double)r->o.z};
    const double d[3] = {(double)r->d.x, (double)r->d.y, (double)r->d.z};

    for (int i = 0; i < 3; i++) n[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
    for (int i = 0; i < 3; i++) v[i] = w->corner[i] - o[i];
    const double t = dot3(n, v) / dot3(n, d);
    for (int i = 0; i < 3; i++) v[i] = t * d[i] - v[i];
    const double x = dot3(v, a) / dot3(a, a), y = dot3(v, b) / dot3(b, b);
    return t > 0 && isfinite(t) && x >= 0 && x <= 1 && y >= 0 && y <= 1 ? t : 0;
}

/* ---- all of it ---- */

typedef struct search {
    ray escaped[ESCAPED];
    uint32_t n_escaped;
    plane slots[SLOTS];
    bis_portal found[RECTANGLES];
    uint32_t n_found;
} search;

/* The windows in a plane. false: no memory. */
static bool search_plane(search *s, section *c, const plane *q, const bis_geometry *g)
{
    const uint32_t first = s->n_found;

    if (!cut(c, q, g)) return false;
    for (uint32_t i = 0; i < s->n_escaped && s->n_found < RECTANGLES; i++) {
        double x[3];
        bool is_new = cross_at(x, q, &s->escaped[i]);
        for (uint32_t j = first; j < s->n_found && is_new; j++) is_new = passes(&s->found[j], &s->escaped[i]) == 0;
        if (is_new && find_window(&s->found[s->n_found], c, q, x)) s->n_found++;
    }
    return true;
}

/* Each ray votes for the last rectangle on its way. */
static uint32_t choose(bis_portal *windows, const search *s)
{
    uint32_t votes[RECTANGLES] = {0}, n = 0, all = 0;

    for (uint32_t i = 0; i < s->n_escaped; i++) {
        double last = 0;
        uint32_t best = 0;
        for (uint32_t j = 0; j < s->n_found; j++) {
            const double t = passes(&s->found[j], &s->escaped[i]);
            if (t > last) last = t, best = j;
        }
        votes[best] += last > 0;
    }
    for (uint32_t j = 0; j < s->n_found && n < BIS_PORTALS_MAX; j++) {
        if (!votes[j]) continue;
        windows[n++] = s->found[j];
        all += votes[j];
    }
    return 4 * all >= 3 * s->n_escaped ? n : 0;
}

bis_status bis_windows_find(bis_portal *windows, uint32_t *n, const bis_scene *scene, const bis_camera *camera,
                            const bis_film *film, bis_diag *diag)
{
    section c = {.s = NULL};
    search *s = bis_alloc(1, sizeof *s);
    bool good = s != NULL;
    double x[3];

    *n = 0;
    if (good) s->n_escaped = look_out(s->escaped, scene, camera, film);
    if (good && s->n_escaped) {
        find_planes(s->slots, &scene->geometry);
        for (plane *q = s->slots; q < s->slots + SLOTS; q++)
            for (uint32_t i = 0; i < s->n_escaped && q->area > 0; i++) q->crossed += cross_at(x, q, &s->escaped[i]);
        plane *q;
        for (int k = 0; k < PLANES && good && (q = next_plane(s->slots, s->n_escaped)); k++) {
            good = search_plane(s, &c, q, &scene->geometry);
            q->crossed = 0;
        }
        if (good) *n = choose(windows, s);
    }
    bis_free(c.s);
    bis_free(s);
    return good ? BIS_OK : bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory to look for windows");
}
