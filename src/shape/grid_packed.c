/* grid_packed: the fast walk, beside the plain one of grid_walk.c: the same triangle test, bit by bit the same answers
 * (tests/shape/test_accel.c), in half of the time or less. What makes the difference:
 * - Eight at a time: the triangles of the items lie in blocks of eight, coordinate by coordinate, in the order of the
 *   cells. A loop that the compiler turns into vectors of float rules most of a block out; the few that it cannot are
 *   tested by the plain code, in double. Blocks do not begin with cells: what a cell shares its block with is tested,
 *   too, which is harmless, as a hit is a hit wherever it is found.
 * - Slabs for steps: along the axis m in which the ray passes the most cells it passes at most three of a slab, the
 *   cells of equal index in m. Sixteen slabs are looked up at once, in a bit map for each m of the cells that are not
 *   empty or next to such (towards larger indices in the other two axes). No t of the next wall is kept.
 *
 * Rounding: as with the plain walk, positions are wrong by less than the slack (grid.h). A cell that the ray enters by
 * less may be left out: what could be hit there is in the cell beside it, too.
 * Space: 36.5 bytes an item and 3 bits a cell on top of the grid's. */
#include "grid.h"

#include "bis/base/clones.h"
#include "bis/base/mem.h"
#include "bis/shape/geometry.h"
#include "rounding.h"
#include "triangle.h"

#include <assert.h>
#include <float.h>
#include <sys/mman.h>

/* [grid-packed] */
enum { LANES = BIS_GRID_LANES, LOOK = 16 /* slabs */ };

static inline BIS_INLINE int clamp(int i, int lo, int hi) { return i < lo ? lo : i > hi ? hi : i; }

/* ---- the ray among the cells ---- */

/* A ray in units of cells. q counts slabs along m in the ray's direction; in the other axes it is at (u0 + q du, v0 + q
 * dv). */
typedef struct slabs {
    double q0, q1;         /* where it enters and leaves */
    double u0, v0, du, dv; /* |du|, |dv| <= 1 */
    double t0, dq;         /* t at q0; slabs per t */
    int first, last;       /* slabs that it passes */
    int m, u, v, n_u, n_v; /* the axes; cells along u and v */
    int zero, sign;        /* slab 0 has index zero in m, the next one zero + sign */
} slabs;

/* Cut the ray to the grid's box. A component of 0 gives a reciprocal that is as good as infinite, but for 0/0. */
static inline BIS_INLINE bool clip(const bis_grid *g, const double o[3], const double d[3], double t[2])
{
    for (int a = 0; a < 3; a++) {
        const double inverse = d[a] != 0 ? 1 / d[a] : DBL_MAX;
        const double lo = (g->lo[a] - o[a]) * inverse, hi = (g->hi[a] - o[a]) * inverse;
        t[0] = larger(t[0], smaller(lo, hi));
        t[1] = smaller(t[1], larger(lo, hi));
    }
    return t[0] <= t[1];
}

static inline BIS_INLINE bool enter(const bis_grid *g, const ray *r, slabs *s)
{
    const double o[3] = {(double)r->o.x, (double)r->o.y, (double)r->o.z};
    const double d[3] = {(double)r->d.x, (double)r->d.y, (double)r->d.z};
    double p[3], w[3], t[2] = {0, (double)r->tmax};

    if (!clip(g, o, d, t)) return false;
    for (int a = 0; a < 3; a++) {
        p[a] = (o[a] + t[0] * d[a] - g->lo[a]) * g->inv_cell[a];
        w[a] = d[a] * g->inv_cell[a];
    }
    const double x = fabs(w[0]), y = fabs(w[1]), z = fabs(w[2]);
    s->m = x > y ? (x > z ? 0 : 2) : (y > z ? 1 : 2);
    s->u = s->m == 0 ? 1 : 0;
    s->v = s->m == 2 ? 1 : 2;
    s->n_u = g->n[s->u];
    s->n_v = g->n[s->v];
    const bool back = w[s->m] < 0;
    const int n = g->n[s->m];
    s->zero = back ? n - 1 : 0;
    s->sign = back ? -1 : 1;
    s->t0 = t[0];
    s->dq = fabs(w[s->m]);
    s->q0 = back ? n - p[s->m] : p[s->m];
    s->q1 = s->q0 + (t[1] - t[0]) * s->dq;
    s->du = w[s->u] / s->dq;
    s->dv = w[s->v] / s->dq;
    s->u0 = p[s->u] - s->q0 * s->du;
    s->v0 = p[s->v] - s->q0 * s->dv;
    /* Within rounding q0 and q1 are in [0, n]: n itself belongs to the last slab. */
    s->first = clamp((int)s->q0, 0, n - 1);
    s->last = clamp((int)s->q1, 0, n - 1);
    return true;
}

/* Which of LANES slabs from `first` on may hold anything for the ray? Bit k: slab first + k. */
static inline BIS_INLINE unsigned look(const bis_grid *g, const slabs *s, int first)
{
    const uint32_t *near = g->near[s->m];
    const int n_m = g->n[s->m], n_u = s->n_u, n_v = s->n_v, index = s->zero + s->sign * first, sign = s->sign;
    const double q0 = s->q0, q1 = s->q1, u0 = s->u0, v0 = s->v0, du = s->du, dv = s->dv;
    unsigned mask = 0;

#pragma omp simd reduction(| : mask)
    for (int k = 0; k < LOOK; k++) {
        double a = (double)(first + k), b = a + 1;
        a = a > q0 ? a : q0;
        b = b < q1 ? b : q1;
        const double ua = u0 + a * du, ub = u0 + b * du, va = v0 + a * dv, vb = v0 + b * dv;
        const int i = clamp(index + sign * k, 0, n_m - 1);
        const int j = clamp((int)(ua < ub ? ua : ub), 0, n_u - 1), l = clamp((int)(va < vb ? va : vb), 0, n_v - 1);
        const int bit = (l * n_u + j) * n_m + i;
        mask |= (near[bit >> 5] >> (bit & 31) & 1) << k;
    }
    const int left = s->last - first + 1;
    return left < LOOK ? mask & ((1u << left) - 1) : mask;
}

/* The cells that the ray passes in a slab, in its order: one to three. In an axis it passes one wall at most; where
 * rounding says two, the last cell is one that it touches within the slack. */
static inline BIS_INLINE int cells_of(const bis_grid *g, const slabs *s, int slab, size_t cells[3])
{
    const ptrdiff_t stride[3] = {1, g->n[0], (ptrdiff_t)g->n[0] * g->n[1]};
    const double a = larger(slab, s->q0), b = smaller(slab + 1, s->q1);
    const double ua = s->u0 + a * s->du, ub = s->u0 + b * s->du, va = s->v0 + a * s->dv, vb = s->v0 + b * s->dv;
    const int j0 = clamp((int)ua, 0, s->n_u - 1), j1 = clamp(clamp((int)ub, 0, s->n_u - 1), j0 - 1, j0 + 1);
    const int l0 = clamp((int)va, 0, s->n_v - 1), l1 = clamp(clamp((int)vb, 0, s->n_v - 1), l0 - 1, l0 + 1);
    const ptrdiff_t base = (s->zero + s->sign * slab) * stride[s->m], su = stride[s->u], sv = stride[s->v];
    int n = 0;

    cells[n++] = (size_t)(base + j0 * su + l0 * sv);
    if (j0 != j1 && l0 != l1) {
        const double to_u = fabs((j1 > j0 ? j1 : j0) - ua), to_v = fabs((l1 > l0 ? l1 : l0) - va);
        const bool u_first = to_u * fabs(s->dv) < to_v * fabs(s->du);
        cells[n++] = (size_t)(base + (u_first ? j1 : j0) * su + (u_first ? l0 : l1) * sv);
    }
    if (j0 != j1 || l0 != l1) cells[n++] = (size_t)(base + j1 * su + l1 * sv);
    return n;
}

/* ---- triangles ---- */

/* What a block is tested against: the sheared ray in float, from a point p of it that is near the block; what is wrong
 * with p and with the coordinates of shear_test, at most. */
typedef struct near_ray {
    float p[3], sx, sy, wrong;
    int kx, ky, kz;
} near_ray;

/* p is in the box, where it is rounded to float (2^-24 of a coordinate), and both it and shear_test compute with the
 * distance from the origin in double (2^-50 of that). Twice as much is taken. */
static inline BIS_INLINE near_ray near_ray_of(const bis_grid *g, const sheared_ray *s)
{
    double box = 0, o = 0;

    for (int a = 0; a < 3; a++) {
        box = larger(box, larger(fabs(g->lo[a]), fabs(g->hi[a])));
        o = larger(o, fabs(s->o[a]));
    }
    return (near_ray){.sx = (float)s->sx, .sy = (float)s->sy, .wrong = (float)(0x1p-23 * box + 0x1p-49 * (box + o)),
                      .kx = s->kx, .ky = s->ky, .kz = s->kz};
}

/* Move p to the middle of what the ray has of a slab; d: its direction's component kz. */
static inline BIS_INLINE void move_near(near_ray *near, const slabs *s, const sheared_ray *sheared, double d, int slab)
{
    const double q = 0.5 * (larger(slab, s->q0) + smaller(slab + 1, s->q1)), t = s->t0 + (q - s->q0) / s->dq;
    const int kx = near->kx, ky = near->ky, kz = near->kz;

    near->p[kz] = (float)(sheared->o[kz] + t * d);
    const double z = (double)near->p[kz] - sheared->o[kz];
    near->p[kx] = (float)(sheared->o[kx] + sheared->sx * z);
    near->p[ky] = (float)(sheared->o[ky] + sheared->sy * z);
}

/* Which triangles of a block may shear_test call met? It says no where it finds weights of both signs, so those are
 * ruled out whose weights in float have both signs by more than all rounding. With u = 2^-24, M the largest |v - p| of
 * the block (M <= |first vertex - p| + reach), w = wrong and |sx|, |sy| <= 1:
 * - a sheared coordinate is at most 2M and wrong by w + 7uM: u M each from v - p twice, from sx, from the product, 2uM
 *   from the last difference, and second order;
 * - a weight is the difference of two products of such: wrong by 8.2M (w + 7uM) from its factors, by 18uM^2 from its
 * own
 *   rounding; shear_test's own errors are in w. In all below 9Mw + 84uM^2, and FLT_MIN for what underflows.
 * What overflows or is no number rules nothing out. */
static inline BIS_INLINE unsigned filter(const bis_grid_block v, float reach, const near_ray *r)
{
    const float *x = v[r->kx], *y = v[r->ky], *z = v[r->kz];
    const float px = r->p[r->kx], py = r->p[r->ky], pz = r->p[r->kz], sx = r->sx, sy = r->sy;
    const float dx = fabsf(x[0] - px), dy = fabsf(y[0] - py), dz = fabsf(z[0] - pz);
    const float size = (dx > dy ? (dx > dz ? dx : dz) : (dy > dz ? dy : dz)) + reach;
    const float e = size * (9 * r->wrong + 84 * 0x1p-24f * size) + FLT_MIN;
    enum { B = 3 * LANES, C = 6 * LANES };
    unsigned mask = 0;

#pragma omp simd reduction(| : mask)
    for (int k = 0; k < LANES; k++) {
        const float az = z[k] - pz, bz = z[B + k] - pz, cz = z[C + k] - pz;
        const float ax = x[k] - px - sx * az, ay = y[k] - py - sy * az;
        const float bx = x[B + k] - px - sx * bz, by = y[B + k] - py - sy * bz;
        const float cx = x[C + k] - px - sx * cz, cy = y[C + k] - py - sy * cz;
        const float e0 = cx * by - cy * bx, e1 = ax * cy - ay * cx, e2 = bx * ay - by * ax;
        const bool some_less = (e0 < -e) | (e1 < -e) | (e2 < -e), some_more = (e0 > e) | (e1 > e) | (e2 > e);
        mask |= (unsigned)!(some_less & some_more) << k;
    }
    return mask;
}

/* The nearest of the block's hits before *best, or any. */
static inline BIS_INLINE bool test_block(const bis_grid *g, uint32_t block, const near_ray *near, const sheared_ray *s,
                                         const ray *r, bis_grid_best *best, const bool any)
{
    bool found = false;

    for (unsigned mask = filter(g->blocks[block], g->reach[block], near); mask; mask &= mask - 1) {
        const int k = __builtin_ctz(mask);
        float v[9];
        double t;
        for (int i = 0; i < 9; i++) v[i] = g->blocks[block][i][k];
        if (!shear_hit(s, r, v, best->t, &t)) continue;
        if (any) return true;
        found |= bis_grid_take(best, t, g->items[LANES * (size_t)block + (size_t)k]);
    }
    return found;
}

/* Quadrics are a cell's last items. */
static inline BIS_INLINE bool test_quadrics(const bis_grid *g, uint32_t begin, uint32_t end, const ray *r,
                                            bis_grid_best *best, const bool any)
{
    const bis_geometry *geometry = g->base.geometry;

    while (end-- > begin && g->items[end] >= geometry->n_triangles) {
        float t;
        if (!bis_quadric_intersect(&geometry->quadrics[g->items[end] - geometry->n_triangles], r, &t)) continue;
        if (any && (double)t < best->t) return true;
        bis_grid_take(best, (double)t, g->items[end]);
    }
    return false;
}

/* ---- the walk ---- */

/* The walk of both queries; any is a constant in each. */
static inline BIS_INLINE bool walk(const bis_grid *g, const ray *r, bis_grid_best *best, const bool any)
{
    slabs s;
    uint32_t tested = UINT32_MAX; /* the last block: neighbours may share it */

    if (!enter(g, r, &s)) return false;
    const sheared_ray sheared = shear_ray(r);
    const float d[3] = {r->d.x, r->d.y, r->d.z};
    near_ray near = near_ray_of(g, &sheared);
    for (int first = s.first; first <= s.last; first += LOOK) {
        for (unsigned mask = look(g, &s, first); mask; mask &= mask - 1) {
            const int slab = first + __builtin_ctz(mask);
            size_t cells[3];
            if (!any && s.q0 + (best->t - s.t0) * s.dq <= slab) return best->prim != BIS_NO_PRIM;
            const int n = cells_of(g, &s, slab, cells);
            move_near(&near, &s, &sheared, (double)d[sheared.kz], slab);
            for (int c = 0; c < n; c++) {
                const uint32_t begin = g->offsets[cells[c]], end = g->offsets[cells[c] + 1];
                if (begin == end) continue;
                for (uint32_t block = begin / LANES; block <= (end - 1) / LANES; block++) {
                    if (block == tested) continue;
                    tested = block;
                    if (test_block(g, block, &near, &sheared, r, best, any) && any) return true;
                }
                if (g->base.geometry->n_quadrics > 0 && test_quadrics(g, begin, end, r, best, any) && any) return true;
            }
        }
    }
    return best->prim != BIS_NO_PRIM;
}

BIS_LANES
static bool walk_nearest(const bis_grid *g, const ray *r, bis_grid_best *best)
{
    return walk(g, r, best, false);
}

BIS_LANES
static bool walk_any(const bis_grid *g, const ray *r, bis_grid_best *best)
{
    return walk(g, r, best, true);
}

bool bis_grid_packed_intersect(const bis_accel *a, const ray *r, bis_hit *hit)
{
    bis_grid_best best = {(double)r->tmax, BIS_NO_PRIM};

    if (!walk_nearest((const bis_grid *)a, r, &best)) return false;
    *hit = (bis_hit){(float)best.t, best.prim};
    return true;
}

bool bis_grid_packed_occluded(const bis_accel *a, const ray *r)
{
    bis_grid_best best = {(double)r->tmax, BIS_NO_PRIM};

    return walk_any((const bis_grid *)a, r, &best);
}

/* ---- construction ---- */

/* near[m]: from each cell that holds anything, one back in each of the other axes. */
static void mark_near(bis_grid *g, int m)
{
    const int u = m == 0 ? 1 : 0, v = m == 2 ? 1 : 2;
    const size_t n_m = (size_t)g->n[m], n_u = (size_t)g->n[u];

    for (size_t word = 0; word <= g->n_cells / 64; word++) {
        for (uint64_t bits = g->occupied[word]; bits; bits &= bits - 1) {
            const size_t cell = 64 * word + (size_t)__builtin_ctzll(bits), row = cell / (size_t)g->n[0];
            const size_t at[3] = {cell % (size_t)g->n[0], row % (size_t)g->n[1], row / (size_t)g->n[1]};
            for (size_t l = at[v] > 0 ? at[v] - 1 : 0; l <= at[v]; l++) {
                for (size_t j = at[u] > 0 ? at[u] - 1 : 0; j <= at[u]; j++) {
                    const size_t bit = (l * n_u + j) * n_m + at[m];
                    g->near[m][bit >> 5] |= (uint32_t)1 << (bit & 31);
                }
            }
        }
    }
}

static void pack_block(bis_grid *g, size_t block, size_t n_items)
{
    const bis_geometry *geometry = g->base.geometry;
    float reach = 0;

    for (size_t k = 0; k < LANES && LANES * block + k < n_items; k++) {
        const uint32_t prim = g->items[LANES * block + k];
        if (prim >= geometry->n_triangles) continue; /* stays a triangle without area */
        for (size_t i = 0; i < 3; i++) {
            const vec3 p = geometry->p[geometry->index[3 * (size_t)prim + i]];
            g->blocks[block][3 * i][k] = p.x;
            g->blocks[block][3 * i + 1][k] = p.y;
            g->blocks[block][3 * i + 2][k] = p.z;
            const float *v = g->blocks[block][0];
            const float dx = fabsf(p.x - v[0]), dy = fabsf(p.y - v[LANES]), dz = fabsf(p.z - v[2 * LANES]);
            const float d = dx > dy ? (dx > dz ? dx : dz) : (dy > dz ? dy : dz);
            if (d > reach) reach = d;
        }
    }
    g->reach[block] = reach * (1 + 0x1p-22f); /* rounding of the differences */
}

static size_t n_blocks(size_t n_items) { return (n_items + LANES - 1) / LANES; }
static size_t n_words(size_t n_cells) { return n_cells / 32 + 1; }

size_t bis_grid_packed_bytes(size_t n_cells, size_t n_items)
{
    return n_blocks(n_items) * (sizeof(bis_grid_block) + sizeof(float)) + 3 * n_words(n_cells) * sizeof(uint32_t);
}

/* Rays jump about in the blocks: with pages of 2 MiB, where there are any, rays are 5% and the build is 15% faster. */
static void advise_large_pages(void *p, size_t bytes)
{
#ifdef MADV_HUGEPAGE
    const uintptr_t page = 4096, first = ((uintptr_t)p + page - 1) & ~(page - 1),
                    end = ((uintptr_t)p + bytes) & ~(page - 1);
    if (end > first) (void)madvise((void *)first, end - first, MADV_HUGEPAGE); /* advice: it may fail */
#else
    (void)p;
    (void)bytes;
#endif
}

bis_status bis_grid_pack(bis_grid *g, int n_threads, bis_diag *diag)
{
    const size_t n_items = g->offsets[g->n_cells];

    (void)n_threads; /* without OpenMP */
    assert(g->n_cells <= INT32_MAX);
    g->blocks = bis_alloc(n_blocks(n_items), sizeof *g->blocks);
    if (g->blocks) advise_large_pages(g->blocks, n_blocks(n_items) * sizeof *g->blocks);
    g->reach = bis_alloc(n_blocks(n_items), sizeof *g->reach);
    for (int m = 0; m < 3; m++) g->near[m] = bis_alloc(n_words(g->n_cells), sizeof *g->near[m]);
    if (!g->blocks || !g->reach || !g->near[0] || !g->near[1] || !g->near[2]) {
        return bis_error(diag, BIS_NOMEM, (bis_loc){0},
                         "no memory for the triangles of a grid; a smaller density needs less");
    }
#pragma omp parallel num_threads(n_threads)
    {
#pragma omp for schedule(static) nowait
        for (size_t block = 0; block < n_blocks(n_items); block++) pack_block(g, block, n_items);
#pragma omp for schedule(dynamic)
        for (int m = 0; m < 3; m++) mark_near(g, m);
    }
    return BIS_OK;
}
/* [end] */
