/* SPDX-License-Identifier: BSD-2-Clause */
/* polygon: triangles of polygons by ear clipping.
 *
 * A polygon is projected along the largest component of its normal by Newell's sums, so that it turns counterclockwise
 * and has the largest area. Its corners need not lie in a plane. There, a fan covers it if no triangle of the fan turns
 * the other way: so it is with every convex polygon.
 * Else ears are cut off: an ear is a corner whose neighbours see each other inside of the polygon (Meisters 1975: there
 * are two at least). A hole is joined to the outline by two edges that lie on each other, so that corners have equal
 * places; the chain beyond such a place is kept out by the angles at both ends of the cut (O'Rourke 1998, InCone).
 * What crosses itself has no inside. There the corner is cut that turns left the most, and a triangle comes out for
 * each corner but two all the same.
 * Corners are sorted by x, so that an ear is compared with those beside it alone: about O(n^1.5) for an outline of n
 * corners, at worst O(n^3), which is why there is a limit. */
#include "polygon.h"

#include "base/grow.h"

#include <stdlib.h>

/* A corner in the plane, and its neighbours among those that are left. */
typedef struct corner {
    double x, y;
    uint32_t vertex, before, next, rank; /* next CUT: it is not left; rank: its place in by_x */
} corner;

typedef struct place {
    double x;
    uint32_t corner;
} place;

enum { CUT = UINT32_MAX };

/* Comparisons of corners in all polygons of a file, about half a minute. */
#define MOST_WORK ((uint64_t)1 << 31)

typedef struct clipper {
    corner *c;
    place *by_x;
    size_t capacity_c, capacity_by_x;
    uint32_t n; /* corners of the polygon */
    uint64_t work;
} clipper;

bool bis_polygons_note(polygons *p, const bis_mesh *m, size_t first)
{
    const size_t n = m->n_triangles - first;

    if (n < 2) return true;
    if (m->n_triangles > UINT32_MAX || !BIS_ROOM(p->list, p->capacity, p->n)) return false;
    p->list[p->n++] = (polygon){(uint32_t)first, (uint32_t)n};
    return true;
}

/* ---- in the plane ---- */

/* Twice the area of a triangle; > 0: it turns counterclockwise. */
static double turn(const corner *a, const corner *b, const corner *c)
{
    return (b->x - a->x) * (c->y - a->y) - (b->y - a->y) * (c->x - a->x);
}

static bool is_same_place(const corner *a, const corner *b) { return a->x == b->x && a->y == b->y; }

/* The corners of a fan, in the plane. False: they have no normal. */
static bool project(corner *c, const bis_mesh *m, const polygon *p)
{
    const uint32_t *index = m->index + 3 * (size_t)p->first;
    const uint32_t n = p->n + 2;
    double normal[3] = {0, 0, 0};

    c[0].vertex = index[0];
    for (uint32_t i = 1; i + 1 < n; i++) c[i].vertex = index[3 * (size_t)(i - 1) + 1];
    c[n - 1].vertex = index[3 * (size_t)(n - 3) + 2];
    for (uint32_t i = 0; i < n; i++) { /* from the first corner, so that a distant polygon loses no digits */
        const vec3 o = m->p[c[0].vertex], a = m->p[c[i].vertex], b = m->p[c[(i + 1) % n].vertex];
        const double v[2][3] = {{(double)a.x - (double)o.x, (double)a.y - (double)o.y, (double)a.z - (double)o.z},
                                {(double)b.x - (double)o.x, (double)b.y - (double)o.y, (double)b.z - (double)o.z}};
        for (int k = 0; k < 3; k++) normal[k] += v[0][(k + 1) % 3] * v[1][(k + 2) % 3] -
                                                 v[0][(k + 2) % 3] * v[1][(k + 1) % 3];
    }
    int axis = 0;
    for (int k = 1; k < 3; k++)
        if (fabs(normal[k]) > fabs(normal[axis])) axis = k;
    for (uint32_t i = 0; i < n; i++) {
        const vec3 at = m->p[c[i].vertex];
        const double v[3] = {(double)at.x, (double)at.y, (double)at.z};
        c[i].x = v[(axis + 1) % 3];
        c[i].y = normal[axis] < 0 ? -v[(axis + 2) % 3] : v[(axis + 2) % 3];
        c[i].before = i == 0 ? n - 1 : i - 1;
        c[i].next = i + 1 == n ? 0 : i + 1;
    }
    return normal[axis] != 0;
}

/* Does no triangle of the fan turn the wrong way? Coordinates are rounded to float, each by 2^-24 of the largest, and a
 * difference of two by twice that: a turn that is less than what this makes of it is none. */
static bool fan_covers(const corner *c, uint32_t n)
{
    double most = 0;

    for (uint32_t i = 0; i < n; i++) most = fmax(most, fmax(fabs(c[i].x), fabs(c[i].y)));
    for (uint32_t i = 1; i + 1 < n; i++) {
        const double sides = fabs(c[i].x - c[0].x) + fabs(c[i].y - c[0].y) + fabs(c[i + 1].x - c[0].x) +
                             fabs(c[i + 1].y - c[0].y);
        if (turn(&c[0], &c[i], &c[i + 1]) < -0x1p-23 * most * sides) return false;
    }
    return true;
}

/* ---- ears ---- */

/* Does the line from a to b begin inside of the polygon? */
static bool is_in_angle(const corner *c, const corner *a, const corner *b)
{
    const corner *before = &c[a->before], *next = &c[a->next];

    if (turn(before, a, next) >= 0) return turn(a, b, before) >= 0 && turn(b, a, next) >= 0;
    return !(turn(a, b, next) > 0 && turn(b, a, before) > 0);
}

static int order_places(const void *a, const void *b)
{
    const place *p = a, *q = b;
    if (p->x != q->x) return p->x < q->x ? -1 : 1;
    return (p->corner > q->corner) - (p->corner < q->corner);
}

static void sort_by_x(clipper *s)
{
    for (uint32_t i = 0; i < s->n; i++) s->by_x[i] = (place){s->c[i].x, i};
    qsort(s->by_x, s->n, sizeof *s->by_x, order_places);
    for (uint32_t i = 0; i < s->n; i++) s->c[s->by_x[i].corner].rank = i;
}

/* Is corner i an ear? strict: no other corner may touch it, either. */
static bool is_ear(clipper *s, uint32_t i, bool strict)
{
    const corner *c = s->c, *b = &c[i], *a = &c[b->before], *d = &c[b->next], *left = a->x < b->x ? a : b;
    const double right = fmax(fmax(a->x, b->x), d->x);

    if (!(turn(a, b, d) > 0) || !is_in_angle(c, a, d) || !is_in_angle(c, d, a)) return false;
    if (d->x < left->x) left = d;
    uint32_t k = left->rank;
    while (k > 0 && s->by_x[k - 1].x == left->x) k--;
    for (; k < s->n && s->by_x[k].x <= right; k++, s->work++) {
        const corner *q = &c[s->by_x[k].corner];
        if (q->next == CUT || is_same_place(q, a) || is_same_place(q, b) || is_same_place(q, d)) continue;
        const double ab = turn(a, b, q), bd = turn(b, d, q), da = turn(d, a, q);
        if (strict ? ab >= 0 && bd >= 0 && da >= 0 : ab > 0 && bd > 0 && da > 0) return false;
    }
    return true;
}

/* The corner to cut, from `from` on. One that is no corner, because a neighbour has its place or because the outline
 * turns back there, has nothing of the area, and is cut first. */
static uint32_t choose(clipper *s, uint32_t from)
{
    const corner *c = s->c;
    uint32_t i = from, most = from;

    for (int strict = 1; strict >= 0 && s->work < MOST_WORK; strict--) {
        i = from;
        do {
            const corner *b = &c[i], *a = &c[b->before], *d = &c[b->next];
            if (is_same_place(a, b) || is_same_place(b, d) || is_same_place(a, d) || is_ear(s, i, strict)) return i;
            if (turn(a, b, d) > turn(&c[c[most].before], &c[most], &c[c[most].next])) most = i;
            i = b->next;
            s->work++;
        } while (i != from);
    }
    return most;
}

static void clip(uint32_t *index, clipper *s)
{
    corner *c = s->c;
    uint32_t from = 0;

    sort_by_x(s);
    for (uint32_t left = s->n; left >= 3; left--, index += 3) {
        const uint32_t i = left == 3 ? from : choose(s, from), next = c[i].next;
        index[0] = c[c[i].before].vertex;
        index[1] = c[i].vertex;
        index[2] = c[next].vertex;
        c[c[i].before].next = next;
        c[next].before = c[i].before;
        c[i].next = CUT;
        from = c[next].next; /* not always the same corner's: no long slivers */
    }
}

bis_status bis_polygons_triangulate(bis_mesh *m, polygons *p, const mesh_input *in)
{
    clipper s = {0};
    bis_status status = BIS_OK;

    for (size_t i = 0; i < p->n && !status; i++) {
        s.n = p->list[i].n + 2;
        if (!bis_room(&s.c, &s.capacity_c, s.n, sizeof *s.c) ||
            !bis_room(&s.by_x, &s.capacity_by_x, s.n, sizeof *s.by_x))
            status = bis_mesh_refuse(in, 0, BIS_NOMEM, "no memory for a polygon of %u corners", s.n);
        else if (project(s.c, m, &p->list[i]) && !fan_covers(s.c, s.n))
            clip(m->index + 3 * (size_t)p->list[i].first, &s);
    }
    if (s.work >= MOST_WORK)
        bis_mesh_remark(in, "polygons of very many corners that are not convex: some triangles lie outside of them. "
                        "Triangulate them in the program that wrote the file");
    bis_free(s.c);
    bis_free(s.by_x);
    bis_free(p->list);
    *p = (polygons){0};
    return status;
}
