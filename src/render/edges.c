/* SPDX-License-Identifier: BSD-2-Clause */
/* edges: where camera samples are worth more than light samples.
 *
 * A pixel that is half background has more noise from the place of its camera samples than from all its shadow rays
 * (docs/trust.md, "Outlines"). So a ray goes through every pixel's corner. Where one corner sees the background and
 * another a surface, other materials, or normals more than 60 degrees apart, pass.c takes edgesamples camera samples in
 * each pass instead of one. Where the surface turns so far that the material's lobe passes from one part of the map to
 * another, it takes half as many, because there each of them sees light of its own.
 *
 * How far that is depends on the material: a lobe of density q at its peak is about as wide as a cone of 1/q. Half of
 * its opening is 60 degrees for a diffuse surface, 25 for n = 10, 11 for n = 50. What counts is the geometric mean of
 * the two lobes, by the chances that they are drawn with. To the same error, a dragon with n = 50 takes 0.45 to 0.7 of
 * the time that it takes without this, with n = 10 0.6 to 0.9, half of it diffuse 0.85 (2 camera samples) to 1.1 (16).
 * Unbiased: how many samples a pixel gets is settled before the first of them, by rays through fixed points. What slips
 * between four corners gets one sample a pass, as everything else. */
#include "edges.h"

#include "bis/base/mem.h"

#include <stdbool.h>

enum { SQUARE = 8 }; /* corners along each side of what the accelerator gets at once */

/* What a corner sees. */
typedef struct corner {
    bool hit;
    uint32_t material;
    double turn; /* cosine of the angle that counts */
    vec3 n;
} corner;

static double turn_of(const bis_material *m)
{
    const vec3 n = {0, 0, 1};
    bis_bsdf b;

    bis_bsdf_init(&b, m, n, n);
    const double p = b.p_specular, diffuse = (1 - p) / PI; /* at the peak, of the density of both */
    if (bis_bsdf_is_black(&b) || p <= 0) return 0.5;
    const double cone = 1 - p / (2 * PI * (bis_bsdf_pdf(&b, b.r) - diffuse));
    /* A diffuse lobe is the widest, 60 degrees by this measure: any turn below its width is harmless. */
    const double lobe = acos(fmax(cone, 0.5));
    const double turn = pow(lobe, p) * pow(PI / 3, 1 - p);
    return cos(fmax(turn, PI / 180)); /* on a plane, normals differ by rounding */
}

double *bis_edges_turns(const bis_scene_desc *desc)
{
    double *turns = bis_alloc(desc->n_materials, sizeof *turns);

    for (size_t i = 0; turns && i < desc->n_materials; i++) turns[i] = turn_of(&desc->materials[i]);
    return turns;
}

/* Neighbours share corners, but not in a thin film: corner 2 i + k is then the k-th of pixel i. */
static int corners_a_pixel(const bis_film *film) { return film->step > 1 ? 2 : 1; }
static int corners_of(const bis_film *film, int n) { return film->step > 1 ? 2 * n : n + 1; }

/* Where the i-th corner stands in the picture, along one side; first: the area's first pixel. */
static double place_of(const bis_film *film, int first, int i)
{
    const int n = corners_a_pixel(film);
    return (first + i / n) * film->step + film->step / 2 + i % n;
}

/* The corners of a rectangle's pixels. */
typedef struct corners {
    corner *c; /* c[down][across] */
    int across, down;
    bis_rect rect;
} corners;

/* What the rays through the corners of one square see: side by side in fours, so that each packet of 16 is a square,
 * too. (x, y) is the square's first corner. */
static void look_at_square(const corners *all, int x, int y, const bis_edge_eye *from)
{
    const bis_film *film = from->film;
    corner *c = all->c;
    ray eye[SQUARE * SQUARE];
    uint32_t prim[SQUARE * SQUARE];
    ptrdiff_t at[SQUARE * SQUARE];
    int n = 0;

    for (int i = 0; i < SQUARE * SQUARE; i++) {
        const int column = x + i / 16 % 2 * 4 + i % 4, row = y + i / 32 * 4 + i / 4 % 4;
        if (column >= all->across || row >= all->down) continue;
        eye[n] = bis_camera_ray(&from->view->camera, film->picture_width, film->picture_height,
                                place_of(film, all->rect.x0, column), place_of(film, all->rect.y0, row));
        at[n++] = row * (ptrdiff_t)all->across + column;
    }
    bis_accel_intersect_many(from->scene->accel, eye, (uint32_t)n, prim);
    bis_geometry_prefetch(&from->scene->geometry, prim, (uint32_t)n);
    for (int i = 0; i < n; i++) {
        bis_surface s;
        c[at[i]] = (corner){.hit = prim[i] != BIS_NO_PRIM};
        if (!c[at[i]].hit) continue;
        bis_geometry_surface(&from->scene->geometry, prim[i], &eye[i], &s);
        c[at[i]] = (corner){true, s.material, from->turns[s.material], s.n};
    }
}

/* Of a side from `first` to `end`, in an area that ends at `last`. */
static uint64_t counted(const bis_film *film, int first, int end, int last)
{
    const bool is_shared = film->step == 1 && end < last;
    return (uint64_t)corners_of(film, end - first) - is_shared;
}

uint64_t bis_edges_rays(const bis_film *film, bis_rect area, bis_rect rect)
{
    return counted(film, rect.x0, rect.x1, area.x1) * counted(film, rect.y0, rect.y1, area.y1);
}

static unsigned char change(const corner *a, const corner *b)
{
    if (a->hit != b->hit) return BIS_EDGE_OUTLINE;
    if (!a->hit) return BIS_EDGE_NONE;
    const double cosine = dot(a->n, b->n);
    if (a->material != b->material || cosine < 0.5) return BIS_EDGE_OUTLINE;
    return cosine < a->turn ? BIS_EDGE_TURN : BIS_EDGE_NONE;
}

static unsigned char more(unsigned char a, unsigned char b) { return a > b ? a : b; }

size_t bis_edges_bytes(bis_rect area)
{
    return (bis_edges_place(area, area.x1 - 1, area.y1 - 1) / (BIS_RENDER_TILE * BIS_RENDER_TILE) + 1) *
           (BIS_RENDER_TILE * BIS_RENDER_TILE / 4);
}

bool bis_edges_find(unsigned char *edge, bis_rect area, bis_rect rect, const bis_edge_eye *from, int n_threads)
{
    const bis_film *film = from->film;
    const int width = rect.x1 - rect.x0, height = rect.y1 - rect.y0, n = corners_a_pixel(film);
    const int across = corners_of(film, width), down = corners_of(film, height);
    corner *c = bis_alloc((size_t)across * (size_t)down, sizeof *c);

    const corners all = {c, across, down, rect};

    if (!c) return false;
    (void)n_threads; /* a compiler without OpenMP has one thread */
#pragma omp parallel for schedule(dynamic) num_threads(n_threads)
    for (int y = 0; y < down; y += SQUARE)
        for (int x = 0; x < across; x += SQUARE)
            look_at_square(&all, x, y, from);
    for (int y = 0; y < height; y++) {
        for (int x = 0; x < width; x++) {
            const corner *a = &c[n * y * (ptrdiff_t)across + n * x], *b = a + across;
            const unsigned char sides = more(more(change(a, a + 1), change(b, b + 1)),
                                             more(change(a, b), change(a + 1, b + 1)));
            const unsigned char kind = more(sides, more(change(a, b + 1), change(a + 1, b)));
            const size_t place = bis_edges_place(area, rect.x0 + x, rect.y0 + y);
            edge[place / 4] |= (unsigned char)(kind << 2 * (place % 4));
        }
    }
    bis_free(c);
    return true;
}
