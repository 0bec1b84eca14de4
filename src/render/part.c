/* SPDX-License-Identifier: BSD-2-Clause */
/* part: files of parts.
 *
 * What a pixel gets depends on the seed, its place, the number of the pass and, where it learns, on its own tile. So
 * the tiles can be rendered anywhere, and sums that lie side by side are the picture: only counters are added up.
 *
 * The file is a state (state.h) of the part's tiles alone, without what only further passes need, and with what the
 * header of the picture needs. A file says how large the picture is; before there is memory for it, all parts must be
 * there, whose lengths sum up to it. */
#include "part.h"

#include "share.h"

#include "base/text.h"
#include "bis/base/file.h"
#include "bis/base/mem.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

static void walk_seconds(bis_walk *w, double *s)
{
    bis_walk_f64(w, s);
    w->bad |= !(*s >= 0 && isfinite(*s));
}

static void walk_about(bis_walk *w, bis_part_about *a)
{
    bis_walk_text(w, a->scene, sizeof a->scene);
    bis_walk_text(w, a->command, sizeof a->command);
    bis_walk_text(w, a->approximated, sizeof a->approximated);
    bis_walk_u64(w, &a->seed);
    bis_walk_u32(w, &a->edge_samples);
    bis_walk_f64(w, &a->edge_light);
    w->bad |= !(a->edge_light >= 0 && a->edge_light <= 1);
    bis_walk_u32(w, &a->n_threads);
    w->bad |= a->n_threads > INT_MAX;
    bis_walk_u64(w, &a->bytes);
    walk_seconds(w, &a->seconds.parse);
    walk_seconds(w, &a->seconds.load);
    walk_seconds(w, &a->seconds.envmap);
    walk_seconds(w, &a->seconds.accel);
    bis_walk_u64(w, &a->figures.triangles);
    bis_walk_name(w, a->figures.accelerator);
    bis_walk_f64(w, &a->figures.mesh);
    bis_walk_f64(w, &a->figures.accel);
    bis_walk_f64(w, &a->figures.envmap);
}

static void walk_side(bis_walk *w, int *full, int *first, int *n)
{
    uint32_t v[3] = {(uint32_t)*full, (uint32_t)*first, (uint32_t)*n};

    for (int i = 0; i < 3; i++) bis_walk_u32(w, &v[i]);
    w->bad |= v[0] > BIS_IMAGE_MAX_SIDE || v[1] >= v[0] || v[2] == 0 || v[2] > v[0] - v[1];
    if (w->bad) return;
    *full = (int)v[0], *first = (int)v[1], *n = (int)v[2];
}

/* Sizes and layers; the layers of a film that is read have no sums yet. */
static void walk_film(bis_walk *w, bis_film *f)
{
    uint32_t layers = f->layers.asked, transparent = f->transparent;

    walk_side(w, &f->full_width, &f->x0, &f->width);
    walk_side(w, &f->full_height, &f->y0, &f->height);
    bis_walk_u32(w, &layers);
    w->bad |= layers > BIS_LAYERS_ALL;
    bis_walk_u32(w, &transparent);
    w->bad |= transparent > 1;
    if (!w->in) return;
    f->layers.asked = layers;
    f->transparent = transparent;
}

bis_status bis_part_write(const char *path, const bis_state_head *head, const bis_part_about *about, bis_film *film,
                          const bis_render_result *result, bis_diag *diag)
{
    bis_state_head h = *head;
    bis_part_about a = *about;
    bis_done done = {.spp = result->spp, .seconds = result->seconds, .rmse_upper = (double)NAN,
                     .counters = result->counters};
    bis_workspace of = {.film = film};
    bis_outfile *file = NULL;

    a.n_threads = (uint32_t)result->n_threads;
    a.bytes = result->bytes;
    bis_status status = bis_share_tiles(&of.own, &of.n_own, film, h.part, diag);
    if (!status) status = bis_outfile_open(&file, path, diag);
    if (!status) {
        bis_walk w = {.out = bis_outfile_stream(file), .hash = BIS_FNV1A};
        bis_state_begin(&w, BIS_STATE_PART);
        bis_state_walk_head(&w, &h);
        walk_about(&w, &a);
        walk_film(&w, film);
        bis_state_walk_done(&w, &done, film);
        bis_state_walk_sums(&w, &of);
        bis_state_end(&w);
        status = bis_outfile_commit(file, diag);
    }
    bis_free(of.own);
    return status;
}

/* ---- reading ---- */

/* A file that has been read up to its sums. */
typedef struct part {
    const char *path;
    unsigned char *data;
    bis_walk walk; /* at the sums */
    bis_state_head head;
    bis_part_about about;
    bis_film film; /* sizes, weights; no sums */
    bis_done done;
    int *own, n_own;
} part;

static void clear(part *p)
{
    bis_free(p->data);
    bis_free(p->own);
    p->data = NULL;
    p->own = NULL;
}

static bis_status damaged(const char *path, bis_diag *diag)
{
    return bis_error(diag, BIS_INPUT, (bis_loc){path, 0, 0}, "this part is damaged");
}

/* What a right checksum does not tell: that a number makes sense. */
static bool is_sound(const part *p)
{
    int across;
    const bis_film *f = &p->film;

    if (p->walk.bad || p->head.part.n == 0 || p->head.part.n > BIS_PART_MOST) return false;
    if (p->head.part.n > (uint32_t)bis_film_tiles(f, BIS_RENDER_TILE, &across)) return false;
    return p->done.spp > 0 && p->done.spp <= UINT32_MAX && f->passes > 0 && f->weight > 0 && isfinite(f->weight) &&
           f->half_weight >= 0 && f->half_weight < f->weight && p->done.seconds >= 0 && isfinite(p->done.seconds);
}

static int values_of(unsigned layers)
{
    int n = 0;
    for (int i = 0; i < BIS_N_LAYERS; i++) n += layers >> i & 1 ? bis_layer_values((bis_layer)i) : 0;
    return n;
}

/* All but the sums; that they are as many as the part has. */
static bis_status read_head(part *p, bis_diag *diag)
{
    size_t size;
    bis_status status = bis_file_read(&p->data, &size, p->path, (bis_loc){p->path, 0, 0}, diag);

    if (!status) status = bis_state_open(&p->walk, BIS_STATE_PART, p->data, size, p->path, diag);
    if (status) return status;
    p->film.step = 1;
    bis_state_walk_head(&p->walk, &p->head);
    walk_about(&p->walk, &p->about);
    walk_film(&p->walk, &p->film);
    if (p->walk.bad) return damaged(p->path, diag);
    bis_state_walk_done(&p->walk, &p->done, &p->film);
    if (!is_sound(p)) return damaged(p->path, diag);
    if (!p->head.settings.integrator)
        return bis_error(diag, BIS_INPUT, (bis_loc){p->path, 0, 0},
                         "this part was made by an integrator that this program does not have");
    status = bis_share_tiles(&p->own, &p->n_own, &p->film, p->head.part, diag);
    if (status) return status;
    bis_film sizes = p->film;
    sizes.layers.n_values = values_of(sizes.layers.asked);
    const bis_workspace of = {.film = &sizes, .own = p->own, .n_own = p->n_own};
    if ((uint64_t)(p->walk.end - p->walk.in) != bis_state_sums_bytes(&of)) return damaged(p->path, diag);
    return BIS_OK;
}

/* ---- do they belong together? ---- */

/* Are all numbers of the second part those of the first one? */
static bis_status compare(const part *a, const part *b, bis_diag *diag)
{
    const bis_loc at = {b->path, 0, 0};
    const bis_film *f = &a->film, *g = &b->film;
    char list[1024];

    if (bis_identity_differs(list, sizeof list, a->head.parts, b->head.parts))
        return bis_error(diag, BIS_INPUT, at, "this part and \"%s\" belong to different pictures. These differ: %s. "
                         "Render the part again with the scene and options of the others", a->path, list);
    if (a->head.part.n != b->head.part.n)
        return bis_error(diag, BIS_INPUT, at, "this is a part of %" PRIu32 ", but \"%s\" is one of %" PRIu32
                         ": all must have the N of the same --part K/N", b->head.part.n, a->path, a->head.part.n);
    if (a->done.spp != b->done.spp)
        return bis_error(diag, BIS_INPUT, at, "this part has %" PRIu64 " camera samples a pixel, but \"%s\" has %"
                         PRIu64 ": give all parts the same --spp", b->done.spp, a->path, a->done.spp);
    if (f->passes != g->passes || f->weight != g->weight || f->half_weight != g->half_weight ||
        f->independent != g->independent ||
        f->layers.asked != g->layers.asked || f->full_width != g->full_width || f->full_height != g->full_height ||
        f->x0 != g->x0 || f->y0 != g->y0 || f->width != g->width || f->height != g->height)
        return damaged(b->path, diag); /* the hashes say that they are alike */
    return BIS_OK;
}

enum { MOST_TOLD = 10 };

/* has[n_parts]. One message for each missing part, with the command that makes it. */
static bis_status look_for_missing(const bool *has, uint32_t n_parts, const char *command, bis_diag *diag)
{
    bis_status status = BIS_OK;
    uint32_t n = 0;

    for (uint32_t k = 1; k <= n_parts; k++) {
        if (has[k - 1] || n++ >= MOST_TOLD) continue;
        status = bis_error(diag, BIS_INPUT, (bis_loc){0}, "part %" PRIu32 " of %" PRIu32 " is missing; this makes it: "
                           "%s --part %" PRIu32 "/%" PRIu32 " --outfile part-%" PRIu32 ".bispart",
                           k, n_parts, command, k, n_parts, k);
    }
    if (n > MOST_TOLD)
        status = bis_error(diag, BIS_INPUT, (bis_loc){0}, "and %" PRIu32 " more parts are missing", n - MOST_TOLD);
    return status;
}

/* ---- putting together ---- */

static double larger(double a, double b) { return a > b || isnan(b) ? a : b; }

static void add_figures(bis_merged *m, const part *p)
{
    bis_part_about *a = &m->about;
    bis_render_result *r = &m->result;

    bis_counters_add(&r->counters, &p->done.counters);
    r->seconds += p->done.seconds;
    a->seconds.parse += p->about.seconds.parse;
    a->seconds.load += p->about.seconds.load;
    a->seconds.envmap += p->about.seconds.envmap;
    a->seconds.accel += p->about.seconds.accel;
    a->figures.mesh = larger(p->about.figures.mesh, a->figures.mesh);
    a->figures.accel = larger(p->about.figures.accel, a->figures.accel);
    if ((int)p->about.n_threads > r->n_threads) r->n_threads = (int)p->about.n_threads;
    if (p->about.bytes > r->bytes) r->bytes = (size_t)p->about.bytes;
}

/* Sums of rendered pixels are finite; a file with a forged checksum may hold anything. */
static bool is_finite(const bis_film *f)
{
    const size_t n = (size_t)f->width * (size_t)f->height;
    bool good = true;

    for (size_t i = 0; i < 3 * n; i++)
        good &= isfinite(f->sum[i]) && isfinite(f->deviation[i]) && isfinite(f->half[i]);
    for (size_t i = 0; i < n; i++) good &= isfinite(f->hits[i]) != 0;
    for (size_t i = 0; f->twin && i < BIS_TWIN_VALUES * bis_film_twins(f); i++) good &= isfinite(f->twin[i]) != 0;
    for (size_t i = 0; i < n * (size_t)f->layers.n_values; i++) good &= isfinite(f->layers.sum[i]) != 0;
    return good;
}

/* Room for the picture of which p is a part. */
static bis_status make_film(bis_film *f, const part *p, bis_diag *diag)
{
    bis_status status = bis_film_init_like(f, &p->film, (bis_loc){0}, diag);

    if (!status) status = bis_film_want(f, p->film.layers.asked, diag);
    f->passes = p->film.passes;
    f->weight = p->film.weight;
    f->half_weight = p->film.half_weight;
    f->independent = p->film.independent;
    if (!status && !f->independent) status = bis_film_want_twins(f, diag);
    return status;
}

/* The first reading of all files: *first receives the first one without its data, (*has)[k] whether part k + 1 is
 * there. */
static bis_status look_at_parts(part *first, bool **has, const char *const *paths, int n, bis_diag *diag)
{
    bis_status worst = BIS_OK;

    for (int i = 0; i < n; i++) {
        part p = {.path = paths[i]};
        bis_status status = read_head(&p, diag);
        if (!status && !*has) {
            *has = bis_alloc(p.head.part.n, sizeof **has);
            if (!*has) status = bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for %" PRIu32 " parts",
                                          p.head.part.n);
            *first = p;
        }
        if (!status) status = compare(first, &p, diag);
        if (!status) (*has)[p.head.part.k - 1] = true;
        clear(&p);
        if (!worst) worst = status;
        if (status == BIS_NOMEM) break;
    }
    first->data = NULL;
    first->own = NULL;
    return worst ? worst : look_for_missing(*has, first->head.part.n, first->about.command, diag);
}

/* The second reading: what has been looked at may have changed meanwhile. */
static bis_status put_part(bis_merged *m, bool *has, const part *first, const char *path, bis_diag *diag)
{
    part p = {.path = path};
    bis_status status = read_head(&p, diag);

    if (!status) status = compare(first, &p, diag);
    if (!status && has[p.head.part.k - 1]) {
        bis_workspace of = {.film = &m->film, .own = p.own, .n_own = p.n_own};
        bis_state_walk_sums(&p.walk, &of);
        add_figures(m, &p);
        has[p.head.part.k - 1] = false;
    }
    clear(&p);
    return status;
}

bis_status bis_part_merge(bis_merged *m, const char *const *paths, int n, bis_diag *diag)
{
    part *first = bis_alloc(1, sizeof *first);
    bool *has = NULL;

    *m = (bis_merged){0};
    if (!first) return bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for a part");
    bis_status status = look_at_parts(first, &has, paths, n, diag);
    if (!status) status = make_film(&m->film, first, diag);
    m->head = first->head;
    m->about = first->about;
    m->about.seconds = (bis_scene_seconds){0};
    m->result = (bis_render_result){.spp = first->done.spp, .passes = first->film.passes};
    for (int i = 0; i < n && !status; i++) status = put_part(m, has, first, paths[i], diag);
    for (uint32_t k = 0; k < first->head.part.n && !status; k++)
        if (has[k]) status = bis_error(diag, BIS_INPUT, (bis_loc){0}, "a part has changed while it was read");
    if (!status && !is_finite(&m->film))
        status = bis_error(diag, BIS_INPUT, (bis_loc){0}, "a part is damaged: a sum in it is not finite");
    if (!status) m->result.error = bis_film_estimate_error(&m->film);
    if (status) bis_film_clear(&m->film);
    bis_free(has);
    bis_free(first);
    return status;
}
