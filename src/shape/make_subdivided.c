/* SPDX-License-Identifier: BSD-2-Clause */
/* make_subdivided: Loop's subdivision of a triangle mesh, and its limit.
 *
 * A step puts a vertex on each edge and moves the old ones (n: valence; the weights are Warren's, as in pbrt):
 *   old, inside:     (1 - n beta) p + beta sum of neighbours, beta = 3/(8n), 3/16 for n = 3
 *   old, border:     3/4 p + 1/8 of each of the two neighbours along the border
 *   edge, inside:    3/8 of each end + 1/8 of each of the two opposite vertices
 *   edge, border:    the middle
 * so that a border is a cubic B-spline of its own vertices. Sums run in the order of the edges, in double.
 *
 * The limit of a vertex, and its tangents, are left eigenvectors of the step's matrix around it, of the eigenvalue 1
 * and of the next ones (tests/shape/test_make.c finds them by powers of that matrix):
 *   inside:  (1 - n g) p + g sum, g = 1/(n + 3/(8 beta)); tangents: cos and sin(2 pi j/n) of the ring
 *   border:  2/3 p + 1/6 of each neighbour; tangents: along it the difference of the neighbours; across it, with k
 *            triangles and theta = pi/k, sin(j theta) of the ring's inner vertex j, a of both its ends, the rest of the
 *            centre, so that the sum is 0; a = (sin theta - cot(theta/2))/(1 + 2 cos theta). For k = 1: 1 of both ends.
 * pbrt has 3/5 and 1/5 on the border, and for k > 3 another tangent across it. These are limits of other rules for
 * borders (Hoppe and others 1994), not of those that it steps by; with its 3 levels the border differs by 1/1920 of the
 * control mesh's second difference. */
#include "bis/shape/make.h"

#include "bis/base/mem.h"
#include "make_grid.h"

#include <stdlib.h>
#include <string.h>

#define NONE UINT32_MAX
#define MAX_TRIANGLES ((size_t)1 << 30) /* so that three sides of each have 32-bit numbers */

/* Side 3 i + c of a net runs from corner c of triangle i to the next one. */
typedef struct net {
    size_t n, n_triangles, n_edges;
    double (*p)[3];
    uint32_t *index;              /* index[n_triangles][3] */
    uint32_t *edge, *twin;        /* of each side: its edge, and the side along it in the next triangle or NONE */
    double (*sum)[3];             /* of a vertex: its neighbours, on the border those along it */
    uint32_t *valence, *start;    /* how many these are; a side that starts there, NONE: no triangle has it */
    bool *is_border;
} net;

static void clear_net(net *s)
{
    bis_free(s->p);
    bis_free(s->index);
    bis_free(s->edge);
    bis_free(s->twin);
    bis_free(s->sum);
    bis_free(s->valence);
    bis_free(s->start);
    bis_free(s->is_border);
    *s = (net){0};
}

static uint32_t next(uint32_t side) { return side % 3 == 2 ? side - 2 : side + 1; }
static uint32_t before(uint32_t side) { return side % 3 == 0 ? side + 2 : side - 1; }
static uint32_t from(const net *s, uint32_t side) { return s->index[side]; }
static uint32_t to(const net *s, uint32_t side) { return s->index[next(side)]; }

/* ---- edges ---- */

typedef struct end_pair {
    uint32_t lo, hi, side;
} end_pair;

static int order_pairs(const void *a, const void *b)
{
    const end_pair *x = a, *y = b;
    if (x->lo != y->lo) return x->lo < y->lo ? -1 : 1;
    if (x->hi != y->hi) return x->hi < y->hi ? -1 : 1;
    return (x->side > y->side) - (x->side < y->side);
}

static bis_status join(net *s, const end_pair *pair, size_t n, bis_loc at, bis_diag *diag)
{
    for (size_t i = 0; i < n; s->n_edges++) {
        size_t k = i + 1;
        while (k < n && pair[k].lo == pair[i].lo && pair[k].hi == pair[i].hi) k++;
        if (k - i > 2 || pair[i].lo == pair[i].hi)
            return bis_error(diag, BIS_INPUT, at, k - i > 2 ? "more than two triangles share the edge between "
                             "points %u and %u: split the surface there" : "triangle with points %u and %u: all three "
                             "must differ", pair[i].lo, pair[i].hi);
        if (k - i == 2 && from(s, pair[i].side) == from(s, pair[i + 1].side))
            return bis_error(diag, BIS_INPUT, at, "triangles %u and %u (counted from 0) turn against each "
                             "other: exchange two indices of one of them", pair[i].side / 3, pair[i + 1].side / 3);
        for (size_t j = i; j < k; j++) {
            s->edge[pair[j].side] = (uint32_t)s->n_edges;
            s->twin[pair[j].side] = k - i == 1 ? NONE : pair[j == i ? i + 1 : i].side;
        }
        i = k;
    }
    return BIS_OK;
}

static void add_neighbour(net *s, uint32_t to_vertex, uint32_t neighbour)
{
    for (int c = 0; c < 3; c++) s->sum[to_vertex][c] += s->p[neighbour][c];
    s->valence[to_vertex]++;
}

/* Each edge once: of its two sides, the one of the smaller number. */
static bool is_first(const net *s, uint32_t side) { return s->twin[side] > side; }

static void sum_neighbours(net *s)
{
    const uint32_t n = (uint32_t)(3 * s->n_triangles);

    for (size_t i = 0; i < s->n; i++) s->start[i] = NONE;
    for (uint32_t side = 0; side < n; side++) {
        s->start[from(s, side)] = side;
        if (s->twin[side] == NONE) s->is_border[from(s, side)] = s->is_border[to(s, side)] = true;
    }
    for (uint32_t side = 0; side < n; side++) {
        const uint32_t a = from(s, side), b = to(s, side);
        if (!is_first(s, side)) continue;
        if (!s->is_border[a] || s->twin[side] == NONE) add_neighbour(s, a, b);
        if (!s->is_border[b] || s->twin[side] == NONE) add_neighbour(s, b, a);
    }
}

static bis_status find_edges(net *s, bis_loc at, bis_diag *diag)
{
    const size_t n = 3 * s->n_triangles;
    end_pair *pair = bis_alloc(n, sizeof *pair);
    bis_status status;

    s->n_edges = 0;
    s->edge = bis_alloc(n, sizeof *s->edge);
    s->twin = bis_alloc(n, sizeof *s->twin);
    s->sum = bis_alloc(s->n, sizeof *s->sum);
    s->valence = bis_alloc(s->n, sizeof *s->valence);
    s->start = bis_alloc(s->n, sizeof *s->start);
    s->is_border = bis_alloc(s->n, sizeof *s->is_border);
    if (!pair || !s->edge || !s->twin || !s->sum || !s->valence || !s->start || !s->is_border) {
        status = bis_error(diag, BIS_NOMEM, at, "no memory for %zu triangles", s->n_triangles);
    } else {
        for (uint32_t i = 0; i < n; i++) {
            const uint32_t a = from(s, i), b = to(s, i);
            pair[i] = (end_pair){a < b ? a : b, a < b ? b : a, i};
        }
        qsort(pair, n, sizeof *pair, order_pairs);
        status = join(s, pair, n, at, diag);
    }
    bis_free(pair);
    if (!status) sum_neighbours(s);
    return status;
}

/* ---- a step ---- */

static double beta_of(uint32_t valence) { return valence == 3 ? 3.0 / 16 : 3 / (8.0 * valence); }

/* (1 - n w) p + w sum */
static void weigh(double out[3], const net *s, size_t i, double w)
{
    for (int c = 0; c < 3; c++) out[c] = (1 - s->valence[i] * w) * s->p[i][c] + w * s->sum[i][c];
}

static void edge_point(double out[3], const net *s, uint32_t side)
{
    const double *a = s->p[from(s, side)], *b = s->p[to(s, side)];
    const uint32_t other = s->twin[side];

    for (int c = 0; c < 3; c++) {
        out[c] = (a[c] + b[c]) / 2;
        if (other == NONE) continue;
        out[c] = 3.0 / 8 * (a[c] + b[c]) +
                 1.0 / 8 * (s->p[from(s, before(side))][c] + s->p[from(s, before(other))][c]);
    }
}

static void split(uint32_t *out, const net *s, size_t triangle)
{
    const uint32_t *v = s->index + 3 * triangle, first = (uint32_t)s->n;
    uint32_t e[3];
    for (size_t c = 0; c < 3; c++) e[c] = first + s->edge[3 * triangle + c];
    const uint32_t four[12] = {v[0], e[0], e[2], e[0], v[1], e[1], e[2], e[1], v[2], e[0], e[1], e[2]};
    memcpy(out, four, sizeof four);
}

static bis_status too_many(bis_loc at, bis_diag *diag)
{
    return bis_error(diag, BIS_INPUT, at, "the levels make more than 2^30 triangles: give fewer levels");
}

static bis_status step(net *s, bis_loc at, bis_diag *diag)
{
    net t = {.n = s->n + s->n_edges, .n_triangles = 4 * s->n_triangles};

    if (t.n_triangles > MAX_TRIANGLES) return too_many(at, diag);
    t.p = bis_alloc(t.n, sizeof *t.p);
    t.index = bis_alloc(t.n_triangles, 3 * sizeof *t.index);
    if (!t.p || !t.index) {
        clear_net(&t);
        return bis_error(diag, BIS_NOMEM, at, "no memory for %zu triangles", 4 * s->n_triangles);
    }
    for (size_t i = 0; i < s->n; i++)
        weigh(t.p[i], s, i, !s->valence[i] ? 0 : s->is_border[i] ? 1.0 / 8 : beta_of(s->valence[i]));
    for (uint32_t side = 0; side < 3 * s->n_triangles; side++)
        if (is_first(s, side)) edge_point(t.p[s->n + s->edge[side]], s, side);
    for (size_t i = 0; i < s->n_triangles; i++) split(t.index + 12 * i, s, i);
    clear_net(s);
    *s = t;
    return find_edges(s, at, diag);
}

/* ---- the limit ---- */

static void add_weighted(double out[3], double w, const double p[3])
{
    for (int c = 0; c < 3; c++) out[c] += w * p[c];
}

/* The ring from side `o`, which starts at the vertex: with the sum of cos and of sin, turning as pbrt does. Returns how
 * many vertices it has. */
static uint32_t inner_tangents(double along[3], double across[3], const net *s, uint32_t o, uint32_t n)
{
    uint32_t side = o, j = 0;
    do {
        const double angle = 2 * PI * j++ / n;
        add_weighted(along, cos(angle), s->p[to(s, side)]);
        add_weighted(across, sin(angle), s->p[to(s, side)]);
        side = next(s->twin[side]);
    } while (side != o);
    return j;
}

/* The first side of a border vertex's ring: turn until there is no further triangle. (Another surface that touches
 * the border in this point has no end.) */
static uint32_t first_of_border(const net *s, uint32_t start)
{
    uint32_t side = start;
    while (s->twin[side] != NONE && next(s->twin[side]) != start) side = next(s->twin[side]);
    return side;
}

/* How many triangles meet at a vertex, from the first side of a border, or from any side inside. */
static uint32_t fan(const net *s, uint32_t o)
{
    uint32_t n = 0, side = o;
    do {
        n++;
        side = s->twin[before(side)];
    } while (side != NONE && side != o);
    return n;
}

static void border_tangents(double along[3], double across[3], const net *s, uint32_t o)
{
    const uint32_t k = fan(s, o), vertex = from(s, o);
    const double theta = PI / k, half_cot = 1 / tan(theta / 2); /* the sum of sin(j theta) */
    const double end = k == 1 ? 1 : (sin(theta) - half_cot) / (1 + 2 * cos(theta));
    uint32_t side = o;

    add_weighted(along, -1, s->p[to(s, o)]);
    add_weighted(across, end, s->p[to(s, o)]);
    for (uint32_t j = 1; j < k; j++) {
        add_weighted(across, sin(j * theta), s->p[from(s, before(side))]);
        side = s->twin[before(side)];
    }
    add_weighted(along, 1, s->p[from(s, before(side))]);
    add_weighted(across, end, s->p[from(s, before(side))]);
    add_weighted(across, -2 * end - (k == 1 ? 0 : half_cot), s->p[vertex]);
}

/* After find_edges. The normal's side is that of pbrt. */
static void to_limit(bis_mesh *m, const net *s)
{
    for (size_t i = 0; i < s->n; i++) {
        double p[3], along[3] = {0}, across[3] = {0}, n[3];
        const uint32_t valence = s->valence[i];
        const bool is_border = s->is_border[i];
        const double w = !valence ? 0 : is_border ? 1.0 / 6 : 1 / (valence + 3 / (8 * beta_of(valence)));
        weigh(p, s, i, w);
        m->p[i] = vec3_from(p[0], p[1], p[2]);
        if (!valence) continue;
        if (is_border) border_tangents(along, across, s, first_of_border(s, s->start[i]));
        else inner_tangents(along, across, s, s->start[i], valence);
        cross3(n, along, across);
        const double size = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        if (size > 0 && isfinite(size)) m->n[i] = vec3_from(n[0] / size, n[1] / size, n[2] / size);
    }
}

/* All triangles of a vertex must be one fan. */
static bis_status check_fans(const net *s, bis_loc at, bis_diag *diag)
{
    uint32_t *meet = bis_alloc(s->n, sizeof *meet);
    bis_status status = meet ? BIS_OK : bis_error(diag, BIS_NOMEM, at, "no memory for %zu points", s->n);

    for (size_t i = 0; meet && i < 3 * s->n_triangles; i++) meet[s->index[i]]++;
    for (size_t i = 0; meet && i < s->n && !status; i++) {
        if (s->start[i] == NONE) continue;
        const uint32_t o = s->is_border[i] ? first_of_border(s, s->start[i]) : s->start[i];
        if (fan(s, o) != meet[i])
            status = bis_error(diag, BIS_INPUT, at, "two surfaces touch in point %zu: give each a point of "
                               "its own there", i);
    }
    bis_free(meet);
    return status;
}

static bis_status take_mesh(net *s, const bis_mesh *m, bis_loc at, bis_diag *diag)
{
    *s = (net){.n = m->n_vertices, .n_triangles = m->n_triangles};
    s->p = bis_alloc(s->n, sizeof *s->p);
    s->index = bis_alloc(s->n_triangles, 3 * sizeof *s->index);
    if (!s->p || !s->index)
        return bis_error(diag, BIS_NOMEM, at, "no memory for %zu triangles", s->n_triangles);
    for (size_t i = 0; i < s->n; i++) {
        s->p[i][0] = (double)m->p[i].x;
        s->p[i][1] = (double)m->p[i].y;
        s->p[i][2] = (double)m->p[i].z;
    }
    if (s->n_triangles) memcpy(s->index, m->index, s->n_triangles * 3 * sizeof *s->index);
    if (s->n_triangles > MAX_TRIANGLES)
        return bis_error(diag, BIS_INPUT, at, "%zu triangles, at most 2^30 can be subdivided", s->n_triangles);
    bis_status status = find_edges(s, at, diag);
    return status ? status : check_fans(s, at, diag);
}

/* A step puts a vertex on each edge, cuts each edge in two and adds three to each triangle. */
bis_status bis_make_subdivided_size(bis_made_size *size, const bis_mesh *m, unsigned levels, bis_loc at, bis_diag *diag)
{
    net s;
    bis_status status = take_mesh(&s, m, at, diag);
    size_t n_edges = s.n_edges;

    *size = (bis_made_size){s.n, s.n_triangles};
    for (unsigned i = 0; i < levels && !status; i++) {
        size->vertices += n_edges;
        n_edges = 2 * n_edges + 3 * size->triangles;
        size->triangles *= 4;
        if (size->triangles > MAX_TRIANGLES) status = too_many(at, diag);
    }
    clear_net(&s);
    return status;
}

bis_status bis_make_subdivided(bis_mesh *m, unsigned levels, bis_loc at, bis_diag *diag)
{
    net s;
    bis_mesh out = {0};
    bis_status status = take_mesh(&s, m, at, diag);

    for (unsigned i = 0; i < levels && !status; i++) status = step(&s, at, diag);
    if (!status) {
        out = (bis_mesh){.p = bis_alloc(s.n, sizeof *out.p), .n = bis_alloc(s.n, sizeof *out.n), .n_vertices = s.n,
                         .index = s.index, .n_triangles = s.n_triangles};
        s.index = NULL;
        if (!out.p || !out.n)
            status = bis_error(diag, BIS_NOMEM, at, "no memory for %zu vertices", out.n_vertices);
    }
    if (!status) {
        s.index = out.index;
        to_limit(&out, &s);
        s.index = NULL;
        bis_mesh_clear(m);
        *m = out;
        out = (bis_mesh){0};
    }
    if (status == BIS_NOMEM) bis_mesh_clear(m);
    bis_mesh_clear(&out);
    clear_net(&s);
    return status;
}
