/* SPDX-License-Identifier: BSD-2-Clause */
/* grid_build: which cell holds which primitives. Storage is that of Lagae and Dutré 2008, "Compact, fast and robust
 * grids for ray tracing": one array of offsets, one of items, no lists. Two passes over the primitives, a counting
 * sort: count the items of each cell; turn counts into ends; fill each cell from its end, going backwards through the
 * primitives, so that items ascend and offsets end up at the starts. O(primitives + items + cells).
 *
 * A triangle goes into the cells that it overlaps, not into all of its box: a triangle and a cell are apart if the
 * triangle's plane or one of its edges, seen along an axis, separates them (Schwarz and Seidel 2010, "Fast parallel
 * surface and solid voxelization"). Each of these tests is linear in the cell's place, so along a row of cells in x it
 * is a bound of i, and a row costs the same whether it has one cell or a thousand.
 *
 * Parallel: threads own slabs of layers in z and go through all primitives; no two touch the same cell, and no bit
 * depends on their number. The resolution follows the primitives' density and the box's shape; if large triangles make
 * too many items, it is coarsened until they fit. A few primitives that are much wider than all others are set aside
 * (set_aside). */
#include "grid.h"
#include "grid_block.h"

#include "bis/base/mem.h"
#include "quadric.h"
#include "rounding.h"
#include "triangle.h"

#include <assert.h>
#include <float.h>
#include <string.h>
#ifdef _OPENMP
#include <omp.h>
#endif

/* Of cells (i, j, k): a i + b j + c k + d >= 0. */
typedef struct bound {
    double a, b, c, d;
} bound;

/* The cells that a primitive's box touches, and for a triangle what else they must fulfil. */
typedef struct cover {
    int lo[3], hi[3];
    bound bounds[11];
    int n_bounds;
} cover;

/* What a build carries through its passes. */
typedef struct build {
    bis_grid *grid;
    const bis_geometry *geometry;
    int n_threads;
    size_t max_items;
    bis_box box; /* of all primitives that are not set aside */
    uint32_t aside[BIS_GRID_LANES], n_aside; /* ascending */
} build;

/* ---- where a primitive lies, in units of cells ---- */

/* The cells of the box lo ... hi, given in cells, in layers [from, to). */
static bool cover_box(const bis_grid *g, const double lo[3], const double hi[3], int from, int to, cover *c)
{
    for (int a = 0; a < 3; a++) {
        const double first = lo[a] - BIS_GRID_SLACK, last = hi[a] + BIS_GRID_SLACK;
        c->lo[a] = first > 0 ? (int)first : 0;
        c->hi[a] = last < g->n[a] ? (int)last : g->n[a] - 1;
    }
    c->n_bounds = 0;
    return c->lo[2] < to && c->hi[2] >= from;
}

/* All cells whose enlarged box reaches into n.p >= d; n is given for cell coordinates, 0 for the axis left out. */
static bound half_space(double nx, double ny, double nz, double d)
{
    const double half = 0.5 + BIS_GRID_SLACK;
    double reach = half * (fabs(nx) + fabs(ny) + fabs(nz));

    return (bound){nx, ny, nz, 0.5 * (nx + ny + nz) - d + reach};
}

/* Its edges, seen along axis a, bound the triangle from n[a]'s side. */
static void add_edges(const double v[3][3], int a, double side, cover *c)
{
    const int b1 = a == 2 ? 0 : a + 1, b2 = b1 == 2 ? 0 : b1 + 1;

    for (int i = 0; i < 3; i++) {
        const double *p = v[i], *q = v[i == 2 ? 0 : i + 1];
        double m[3];
        m[a] = 0;
        m[b1] = side * (p[b2] - q[b2]);
        m[b2] = side * (q[b1] - p[b1]);
        c->bounds[c->n_bounds++] = half_space(m[0], m[1], m[2], m[b1] * p[b1] + m[b2] * p[b2]);
    }
}

/* What else than its box bounds a triangle, v in cell coordinates:
 * - a box of one row of cells: nothing, the triangle meets each of them;
 * - a box of one layer: the edges, seen across the layer;
 * - else the plane, from both sides, and the edges seen along each axis.
 *
 * v is wrong by at most 2^-40 (4096 cells, double). With L bounding all lengths here, the normal is wrong by
 * 4 * 2^-40 L and a bound by 4 * 2^-40 L^2: below half the slack's share, 2^-11 |n|, where |n| >= 2^-27 L^2. A sliver
 * too thin for that does without the bound, and so keeps some cells too many. */
static void cover_triangle(const double v[3][3], cover *c)
{
    const bool wide[3] = {c->hi[0] > c->lo[0], c->hi[1] > c->lo[1], c->hi[2] > c->lo[2]};
    const int n_wide = wide[0] + wide[1] + wide[2];
    double e[3], f[3], reach = 2;

    if (n_wide < 2) return;
    for (int a = 0; a < 3; a++) {
        e[a] = v[1][a] - v[0][a];
        f[a] = v[2][a] - v[0][a];
        reach += fabs(e[a]) + fabs(f[a]);
    }
    const double n[3] = {e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]};
    const double least = 0x1p-27 * reach * reach;
    if (n_wide == 3 && fabs(n[0]) + fabs(n[1]) + fabs(n[2]) >= least) {
        double d = n[0] * v[0][0] + n[1] * v[0][1] + n[2] * v[0][2];
        c->bounds[c->n_bounds++] = half_space(n[0], n[1], n[2], d);
        c->bounds[c->n_bounds++] = half_space(-n[0], -n[1], -n[2], -d);
    }
    for (int a = 0; a < 3; a++)
        if ((n_wide == 3 || !wide[a]) && fabs(n[a]) >= least) add_edges(v, a, n[a] > 0 ? 1 : -1, c);
}

/* The cells of a triangle in layers [from, to); false if there are none, or if it has no area: nothing can hit it
 * then. */
static bool cover_triangle_cells(const bis_grid *grid, uint32_t prim, int from, int to, cover *c)
{
    const bis_geometry *g = grid->base.geometry;
    const uint32_t *index = g->index + 3 * (size_t)prim;
    const vec3 corners[3] = {g->p[index[0]], g->p[index[1]], g->p[index[2]]};
    double v[3][3], lo[3], hi[3];

    for (int i = 0; i < 3; i++) {
        v[i][0] = ((double)corners[i].x - grid->lo[0]) * grid->inv_cell[0];
        v[i][1] = ((double)corners[i].y - grid->lo[1]) * grid->inv_cell[1];
        v[i][2] = ((double)corners[i].z - grid->lo[2]) * grid->inv_cell[2];
    }
    for (int a = 0; a < 3; a++) {
        lo[a] = smaller(v[0][a], smaller(v[1][a], v[2][a]));
        hi[a] = larger(v[0][a], larger(v[1][a], v[2][a]));
    }
    if (!cover_box(grid, lo, hi, from, to, c) || !has_area(corners)) return false;
    cover_triangle((const double (*)[3])v, c);
    return true;
}

static bool cover_quadric_cells(const bis_grid *grid, const bis_box *box, int from, int to, cover *c)
{
    const float box_lo[3] = {box->lo.x, box->lo.y, box->lo.z}, box_hi[3] = {box->hi.x, box->hi.y, box->hi.z};
    double lo[3], hi[3];

    for (int a = 0; a < 3; a++) {
        lo[a] = ((double)box_lo[a] - grid->lo[a]) * grid->inv_cell[a];
        hi[a] = ((double)box_hi[a] - grid->lo[a]) * grid->inv_cell[a];
    }
    return cover_box(grid, lo, hi, from, to, c);
}

static bool cover_primitive(const build *b, uint32_t prim, int from, int to, cover *c)
{
    if (prim < b->geometry->n_triangles) return cover_triangle_cells(b->grid, prim, from, to, c);
    const bis_box box = bis_geometry_bounds(b->geometry, prim);
    return cover_quadric_cells(b->grid, &box, from, to, c);
}

/* The cells first ... last of row (j, k) that fulfil all bounds; false if none does. */
static bool cover_row(const cover *c, int j, int k, int *first, int *last)
{
    double lo = c->lo[0], hi = c->hi[0];

    for (int i = 0; i < c->n_bounds; i++) {
        const bound *b = &c->bounds[i];
        double rest = b->b * j + b->c * k + b->d;
        if (b->a > 0) lo = larger(lo, -rest / b->a);
        else if (b->a < 0) hi = smaller(hi, -rest / b->a);
        else if (rest < 0) return false;
    }
    if (lo > hi) return false;
    *first = (int)ceil(lo);
    *last = (int)hi;
    return *first <= *last;
}

static bool quadric_touches(const build *b, uint32_t prim, int i, int j, int k)
{
    const bis_grid *g = b->grid;
    const double at[3] = {i + 0.5, j + 0.5, k + 0.5};
    double centre[3], half[3];

    for (int a = 0; a < 3; a++) {
        centre[a] = g->lo[a] + at[a] * g->cell[a];
        half[a] = (0.5 + BIS_GRID_SLACK) * g->cell[a];
    }
    return bis_quadric_may_touch(&b->geometry->quadrics[prim - b->geometry->n_triangles], centre, half);
}

/* ---- primitives that are set aside ---- */

static double width_of(const bis_box *b)
{
    const double x = (double)b->hi.x - (double)b->lo.x, y = (double)b->hi.y - (double)b->lo.y,
                 z = (double)b->hi.z - (double)b->lo.z;

    return larger(x, larger(y, z));
}

static bool is_empty(const bis_geometry *g, uint32_t prim)
{
    if (prim >= g->n_triangles) return false; /* without triangles there are no indices, and no pointer to add to */
    const uint32_t *index = g->index + 3 * (size_t)prim;

    return !has_area((const vec3[3]){g->p[index[0]], g->p[index[1]], g->p[index[2]]});
}

/* A floor of radius 80 under a chess board of width 10 would make a grid in which the board fills a few cells ("a
 * teapot in a stadium"). So up to eight primitives that are wider than half of the scene are set aside, if all others
 * lie in a box of at most half of the scene's width. Every ray is tested against them, in one block, before it walks.
 * More than eight stay in the grid, because then each ray would be tested against a list. A triangle without area is
 * neither set aside nor does it count, because nothing can hit it. */
static void set_aside(build *b)
{
    const bis_geometry *g = b->geometry;
    const double half = 0.5 * width_of(&g->box);
    const uint32_t n_prims = (uint32_t)bis_geometry_primitives(g);
    bis_box rest = {{FLT_MAX, FLT_MAX, FLT_MAX}, {-FLT_MAX, -FLT_MAX, -FLT_MAX}};
    uint32_t n = 0;

    b->box = g->box;
    b->n_aside = 0;
    for (uint32_t prim = 0; prim < n_prims; prim++) {
        const bis_box box = bis_geometry_bounds(g, prim);
        if (width_of(&box) > half) {
            if (is_empty(g, prim)) continue;
            if (n == BIS_GRID_LANES) return;
            b->aside[n++] = prim;
        } else {
            bis_box_include(&rest, box.lo);
            bis_box_include(&rest, box.hi);
        }
    }
    if (rest.lo.x > rest.hi.x || width_of(&rest) > half) return; /* lo > hi: there are no others */
    b->box = rest;
    b->n_aside = n;
}

static bool is_aside(const build *b, uint32_t prim)
{
    for (uint32_t i = 0; i < b->n_aside; i++)
        if (b->aside[i] == prim) return true;
    return false;
}

/* ---- the two passes ---- */

/* Visit prim's cells in layers [from, to): count them, or, with items, put prim into them. Returns how many. */
static size_t visit(const build *b, uint32_t prim, int from, int to, uint32_t *items)
{
    const bis_grid *g = b->grid;
    size_t n = 0;
    cover c;

    if (is_aside(b, prim) || !cover_primitive(b, prim, from, to, &c)) return 0;
    int k0 = c.lo[2] > from ? c.lo[2] : from, k1 = c.hi[2] < to - 1 ? c.hi[2] : to - 1;
    for (int k = k0; k <= k1; k++) {
        for (int j = c.lo[1]; j <= c.hi[1]; j++) {
            int first = c.lo[0], last = c.hi[0];
            if (c.n_bounds > 0 && !cover_row(&c, j, k, &first, &last)) continue;
            const size_t row = ((size_t)k * (size_t)g->n[1] + (size_t)j) * (size_t)g->n[0];
            for (int i = first; i <= last; i++) {
                if (prim >= b->geometry->n_triangles && !quadric_touches(b, prim, i, j, k)) continue;
                if (items) items[--g->offsets[row + (size_t)i]] = prim;
                else g->offsets[row + (size_t)i]++;
                n++;
            }
        }
    }
    return n;
}

/* Layers where thread t of n starts. */
static int slab(const bis_grid *g, int t, int n) { return (int)((long)g->n[2] * t / n); }

/* Number of items of all cells; more than max_items means: too many, the counts are not complete. */
static size_t count_items(const build *b)
{
    const uint32_t n_prims = (uint32_t)bis_geometry_primitives(b->geometry);
    size_t total = 0;

#pragma omp parallel for num_threads(b->n_threads) reduction(+ : total) schedule(static, 1)
    for (int t = 0; t < b->n_threads; t++) {
        const int from = slab(b->grid, t, b->n_threads), to = slab(b->grid, t + 1, b->n_threads);
        size_t n = 0;
        for (uint32_t prim = 0; prim < n_prims && n <= b->max_items; prim++) n += visit(b, prim, from, to, NULL);
        total += n;
    }
    return total;
}

static void fill_items(const build *b)
{
    const uint32_t n_prims = (uint32_t)bis_geometry_primitives(b->geometry);

#pragma omp parallel for num_threads(b->n_threads) schedule(static, 1)
    for (int t = 0; t < b->n_threads; t++) {
        const int from = slab(b->grid, t, b->n_threads), to = slab(b->grid, t + 1, b->n_threads);
        for (uint32_t prim = n_prims; prim-- > 0;) visit(b, prim, from, to, b->grid->items);
    }
}

/* ---- the box and its cells ---- */

/* The geometry's box, a little larger: rounding in the walk's entry then never cuts a primitive off, and a flat box has
 * a thickness. 2^-20 of the largest extent, and 2^-20 of the coordinates where the box is a single point. A small flat
 * mesh far from the origin would lose so little to rounding, so it gets 2^-40 of its coordinates at least: far above
 * the last bit of a double, far below that of a float. */
static void set_box(bis_grid *grid, const bis_box *box)
{
    const double lo[3] = {(double)box->lo.x, (double)box->lo.y, (double)box->lo.z};
    const double hi[3] = {(double)box->hi.x, (double)box->hi.y, (double)box->hi.z};
    double extent = 0, size = 0;

    for (int a = 0; a < 3; a++) {
        extent = fmax(extent, hi[a] - lo[a]);
        size = fmax(size, fmax(fabs(lo[a]), fabs(hi[a])));
    }
    const double pad = fmax(0x1p-40 * size, 0x1p-20 * (extent > 0 ? extent : size > 0 ? size : 1));
    for (int a = 0; a < 3; a++) {
        grid->lo[a] = lo[a] - pad;
        grid->hi[a] = hi[a] + pad;
    }
}

/* Cells as cubic as the box allows, `target` in all. An axis shorter than a cell gets one cell, and the others share
 * the target anew: a flat box becomes a grid in two axes. */
static void set_resolution(bis_grid *g, double target)
{
    bool thin[3] = {false, false, false};
    double size = 0;

    for (bool again = true; again;) {
        double volume = 1;
        int axes = 0;
        for (int a = 0; a < 3; a++) {
            if (thin[a]) continue;
            volume *= g->hi[a] - g->lo[a];
            axes++;
        }
        if (axes == 0) break;
        size = pow(volume / target, 1.0 / axes);
        again = false;
        for (int a = 0; a < 3; a++) {
            if (thin[a] || g->hi[a] - g->lo[a] > size) continue;
            thin[a] = again = true;
        }
    }
    g->n_cells = 1;
    for (int a = 0; a < 3; a++) {
        double extent = g->hi[a] - g->lo[a];
        g->n[a] = thin[a] ? 1 : (int)fmin(BIS_GRID_MAX_RES, fmax(1, round(extent / size)));
        g->cell[a] = extent / g->n[a];
        g->inv_cell[a] = g->n[a] / extent;
        g->n_cells *= (size_t)g->n[a];
    }
}

static bis_status sort_into_cells(const build *b, double target, bis_diag *diag)
{
    bis_grid *g = b->grid;
    size_t n_items;

    for (;; target /= 8) {
        set_resolution(g, target);
        bis_free(g->offsets);
        g->offsets = bis_alloc(g->n_cells + 2, sizeof *g->offsets);
        if (!g->offsets) goto no_memory;
        n_items = count_items(b);
        if (n_items <= b->max_items || g->n_cells == 1) break;
    }
    uint32_t end = 0;
    bis_free(g->occupied);
    bis_free(g->items);
    g->occupied = bis_alloc(g->n_cells / 64 + 1, sizeof *g->occupied);
    g->items = bis_alloc(n_items + b->n_aside, sizeof *g->items);
    if (!g->items || !g->occupied) goto no_memory;
    for (size_t c = 0; c < g->n_cells; c++) {
        if (g->offsets[c] > 0) g->occupied[c >> 6] |= (uint64_t)1 << (c & 63);
        end += g->offsets[c];
        g->offsets[c] = end;
    }
    g->offsets[g->n_cells] = end;
    g->offsets[g->n_cells + 1] = end + b->n_aside;
    memcpy(g->items + end, b->aside, b->n_aside * sizeof *g->items);
    fill_items(b);
    return BIS_OK;
no_memory:
    return bis_error(diag, BIS_NOMEM, (bis_loc){0},
                     "no memory for a grid of %d x %d x %d cells; a smaller density needs less", g->n[0], g->n[1],
                     g->n[2]);
}


static size_t bytes(const bis_accel *a)
{
    const bis_grid *g = (const bis_grid *)a;

    return sizeof *g + (g->n_cells + 2) * sizeof *g->offsets + bis_grid_items(g) * sizeof *g->items +
           (g->n_cells / 64 + 1) * sizeof *g->occupied + (g->blocks ? bis_grid_packed_bytes(bis_grid_items(g)) : 0);
}

static void free_grid(bis_accel *a)
{
    bis_grid *g = (bis_grid *)a;

    if (!g) return;
    bis_free(g->offsets);
    bis_free(g->items);
    bis_free(g->occupied);
    bis_free(g->blocks);
    bis_free(g->reach);
    bis_free(g);
}

static const bis_accel_ops ops = {
    .name = "grid", .intersect = bis_grid_intersect, .occluded = bis_grid_occluded, .bytes = bytes, .free = free_grid};

/* May the grid be packed? Where mesh and grid stay below 150 bytes a primitive, or 300 if the density was asked for; a
 * free 64k items. */
static bool may_pack(const bis_grid *g, bool asked)
{
    const size_t free_items = 65536, all = bis_geometry_bytes(g->base.geometry) + bytes(&g->base) +
                                           bis_grid_packed_bytes(bis_grid_items(g));

    return bis_grid_items(g) <= free_items || all <= (asked ? 300 : 150) * bis_geometry_primitives(g->base.geometry);
}

static int threads_of(int wanted)
{
#ifdef _OPENMP
    return wanted > 0 ? wanted : omp_get_max_threads();
#else
    (void)wanted;
    return 1;
#endif
}

bis_status bis_grid_new(bis_accel **out, const bis_geometry *geometry, double density, int n_threads, bis_diag *diag)
{
    const double n = (double)bis_geometry_primitives(geometry);
    bis_grid *grid = bis_alloc(1, sizeof *grid);
    bis_status status;

    assert(n > 0 && density >= 0);
    *out = NULL;
    if (!grid) return bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for a grid");
    const bool asked = density > 0;
    if (!asked) density = BIS_GRID_DENSITY;
    /* A scan's triangles need some 3 items each; 8, and a free 64k, keep even a soup of large triangles that share no
     * vertex below 150 bytes a triangle in all: mesh 48, copy 36, cells 33, items 32. Who asks for more cells may have
     * more items, too.
     * Offsets hold 32 bits. */
    const double items = 8 + 4 * larger(0, density - BIS_GRID_PLAIN_DENSITY);
    const double most = smaller(items * n + 65536, (double)(UINT32_MAX - 1 - BIS_GRID_LANES));
    build b = {.grid = grid, .geometry = geometry, .n_threads = threads_of(n_threads), .max_items = (size_t)most};
    grid->base = (bis_accel){&ops, geometry};
    set_aside(&b);
    set_box(grid, &b.box);
    status = sort_into_cells(&b, fmin(density * n, 0x1p31), diag);
    if (status) goto done;
    if (may_pack(grid, asked)) {
        status = bis_grid_pack(grid, b.n_threads, diag);
        if (status) goto done;
    } else if (!asked) {
        status = sort_into_cells(&b, fmin(BIS_GRID_PLAIN_DENSITY * n, 0x1p31), diag);
        if (status) goto done;
    }
    *out = &grid->base;
    grid = NULL;
done:
    free_grid((bis_accel *)grid);
    return status;
}
