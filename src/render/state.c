/* SPDX-License-Identifier: BSD-2-Clause */
/* state: what a render has done, as the fields of a file. A checkpoint (checkpoint.c) and a part of a picture (part.c)
 * are two kinds of it.
 *
 * The last 8 bytes are a hash of all before: each of its steps is one-to-one, so no single damaged byte escapes it.
 * Nothing is allocated by a size that stands in the file: the file's length is compared with what the render has room
 * for. */
#include "state.h"

#include "base/text.h"
#include "bis/base/version.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

enum { FORMAT = 14, MAGIC = 8 };

static const struct {
    unsigned char magic[MAGIC];
    const char *name, *unlike; /* of the file; what to say where the first bytes are others */
} kinds[] = {
    [BIS_STATE_CHECKPOINT] = {"\x89" "bisck\r\n", "checkpoint",
                              "without --resume, or with another file, the render starts afresh"},
    [BIS_STATE_PART] = {"\x89" "bispt\r\n", "part", "`bis SCENE --part K/N --outfile F` makes parts"},
};

void bis_state_begin(bis_walk *w, bis_state_kind kind)
{
    char version[BIS_WALK_NAME] = BIS_VERSION;
    uint32_t format = FORMAT;

    for (size_t i = 0; i < MAGIC; i++) bis_walk_field(w, kinds[kind].magic[i], 1);
    bis_walk_u32(w, &format);
    bis_walk_name(w, version);
}

void bis_state_end(bis_walk *w)
{
    bis_walk_flush(w);
    bis_walk_field(w, w->hash, BIS_STATE_CHECKSUM);
    bis_walk_flush(w);
}

static bool begins_as(bis_state_kind kind, const unsigned char *data)
{
    return memcmp(data, kinds[kind].magic, MAGIC) == 0;
}

bis_status bis_state_open(bis_walk *w, bis_state_kind kind, const unsigned char *data, size_t size, const char *path,
                          bis_diag *diag)
{
    const bis_loc at = {path, 0, 0};
    const char *name = kinds[kind].name;
    char version[BIS_WALK_NAME];
    uint32_t format;

    *w = (bis_walk){.in = data, .end = data + size};
    if (size >= BIS_STATE_BEFORE + BIS_STATE_CHECKSUM && kind == BIS_STATE_PART &&
        begins_as(BIS_STATE_CHECKPOINT, data))
        return bis_error(diag, BIS_INPUT, at, "this is a checkpoint, not a part of a picture: --resume goes on from "
                         "it");
    if (size >= BIS_STATE_BEFORE + BIS_STATE_CHECKSUM && kind == BIS_STATE_CHECKPOINT &&
        begins_as(BIS_STATE_PART, data))
        return bis_error(diag, BIS_INPUT, at, "this is no checkpoint of bis but a part of a picture: `bis merge` puts "
                         "parts together");
    if (size < BIS_STATE_BEFORE + BIS_STATE_CHECKSUM || !begins_as(kind, data))
        return bis_error(diag, BIS_INPUT, at, "this is no %s of bis, or it is cut short; %s", name, kinds[kind].unlike);
    w->in += MAGIC;
    bis_walk_u32(w, &format);
    bis_walk_name(w, version);
    const unsigned char *behind = w->in;
    w->in = w->end - BIS_STATE_CHECKSUM;
    if (bis_walk_field(w, 0, BIS_STATE_CHECKSUM) != bis_fnv1a(BIS_FNV1A, data, size - BIS_STATE_CHECKSUM))
        return bis_error(diag, BIS_INPUT, at, "this %s is damaged: its checksum is wrong", name);
    if (format != FORMAT || strcmp(version, BIS_VERSION) != 0)
        return bis_error(diag, BIS_INPUT, at, "bis %s wrote this %s in format %" PRIu32 ", but this is bis %s, "
                         "format %d, whose pictures may have other bits: go on with the same version",
                         version, name, format, BIS_VERSION, FORMAT);
    *w = (bis_walk){.in = behind, .end = data + size - BIS_STATE_CHECKSUM};
    return BIS_OK;
}

/* ---- fields ---- */

/* All parameters, also those that the integrator does not read. */
static void walk_settings(bis_walk *w, bis_settings *s)
{
    char text[BIS_WALK_NAME] = "";
    uint32_t as_printed = s->as_printed;

    if (s->integrator) bis_append(text, sizeof text, "%s", s->integrator->name);
    bis_walk_name(w, text);
    s->integrator = bis_integrator_find(text);
    for (const bis_parameter *p = bis_parameters; p->name; p++) {
        double v = bis_parameter_get(p, s);
        bis_walk_f64(w, &v);
        if (v >= 0 && v <= (p->type == BIS_PARAMETER_CHOICE ? BIS_MAX_CHOICES - 1 : UINT32_MAX))
            bis_parameter_set(p, s, v);
        else w->bad = true;
    }
    bis_walk_u32(w, &as_printed);
    s->as_printed = as_printed;
}

void bis_state_walk_head(bis_walk *w, bis_state_head *h)
{
    walk_settings(w, &h->settings);
    bis_walk_u32(w, &h->part.k);
    bis_walk_u32(w, &h->part.n);
    w->bad |= h->part.k > h->part.n || (h->part.k == 0 && h->part.n > 0);
    for (int i = 0; i < BIS_IDENTITY_PARTS; i++) bis_walk_u64(w, &h->parts[i]);
}

static void walk_counters(bis_walk *w, bis_counters *c)
{
    bis_walk_u64(w, &c->camera_rays);
    bis_walk_u64(w, &c->shadow_rays);
    bis_walk_u64(w, &c->candidates);
    bis_walk_u64(w, &c->accepted);
    bis_walk_u64(w, &c->fallbacks);
    bis_walk_u64(w, &c->nonfinite);
    bis_walk_u64(w, &c->beside_portals);
}

void bis_state_walk_done(bis_walk *w, bis_done *d, bis_film *f)
{
    bis_walk_u64(w, &d->spp);
    bis_walk_f64(w, &d->seconds);
    bis_walk_u32(w, &d->next_check);
    bis_walk_f64(w, &d->rmse_upper);
    walk_counters(w, &d->counters);
    bis_walk_u32(w, &f->passes);
    bis_walk_f64(w, &f->weight);
    uint32_t independent = f->independent;
    bis_walk_f64(w, &f->half_weight);
    bis_walk_u32(w, &independent);
    f->independent = independent == 1;
    w->bad |= independent > 1;
}

static void walk_visibility(bis_walk *w, const bis_workspace *of)
{
    for (int i = 0; i < of->n_own && of->visibility.n_tiles; i++) {
        const size_t cells = of->visibility.cells, first = (size_t)bis_workspace_own(of, i) * cells;
        for (size_t k = 0; k < cells * BIS_VISIBILITY_PARTS; k++) {
            bis_seen *known = &of->visibility.known[first + k / BIS_VISIBILITY_PARTS];
            const size_t part = k % BIS_VISIBILITY_PARTS;
            uint32_t both = (uint32_t)known->rays[part] << 16 | known->seen[part];
            bis_walk_u32(w, &both);
            known->rays[part] = (uint16_t)(both >> 16);
            known->seen[part] = (uint16_t)both;
            w->bad |= known->seen[part] > known->rays[part];
        }
    }
}

/* `each` values of every pixel: doubles, floats, or none, of layers that nobody asked for. */
typedef struct values {
    double *doubles;
    float *floats;
    size_t each;
} values;

static void walk_run(bis_walk *w, const values *v, size_t first_pixel, size_t n_pixels)
{
    if (v->doubles) bis_walk_f64s(w, v->doubles + first_pixel * v->each, n_pixels * v->each);
    if (v->floats) bis_walk_f32s(w, v->floats + first_pixel * v->each, n_pixels * v->each);
}

/* Of the pixels that are rendered here. */
static void walk_pixels(bis_walk *w, const bis_workspace *of, values v)
{
    const bis_film *f = of->film;
    const size_t width = (size_t)f->width;

    if (!of->own) walk_run(w, &v, 0, width * (size_t)f->height);
    for (int i = 0; i < of->n_own && of->own; i++) {
        const bis_rect r = bis_film_tile_of_crop(f, BIS_RENDER_TILE, of->own[i]);
        for (int y = r.y0; y < r.y1; y++)
            walk_run(w, &v, (size_t)(y - f->y0) * width + (size_t)(r.x0 - f->x0), (size_t)(r.x1 - r.x0));
    }
}

static uint64_t pixels_of(const bis_workspace *of)
{
    const bis_film *f = of->film;
    uint64_t n = 0;

    if (!of->own) return (uint64_t)f->width * (uint64_t)f->height;
    for (int i = 0; i < of->n_own; i++) {
        const bis_rect r = bis_film_tile_of_crop(f, BIS_RENDER_TILE, of->own[i]);
        n += (uint64_t)(r.x1 - r.x0) * (uint64_t)(r.y1 - r.y0);
    }
    return n;
}

/* The twins of the tiles that are rendered here. Returns how many there are; w = NULL: does nothing else. */
static uint64_t walk_twins(bis_walk *w, const bis_workspace *of)
{
    uint64_t n = 0;

    for (int i = 0; i < of->n_own; i++) {
        const bis_rect r = bis_film_tile_of_crop(of->film, BIS_RENDER_TILE, bis_workspace_own(of, i));
        for (bis_twin t = {0}; bis_film_next_twin(of->film, r, &t); n++)
            if (w) bis_walk_f64s(w, of->film->twin + BIS_TWIN_VALUES * t.at, BIS_TWIN_VALUES);
    }
    return n;
}

uint64_t bis_state_sums_bytes(const bis_workspace *of)
{
    const bis_film *f = of->film;
    /* where nothing is learned, a tile has 0 cells */
    return pixels_of(of) * (BIS_FILM_BYTES + 8 * (uint64_t)f->layers.n_values) +
           (f->independent ? 0 : walk_twins(NULL, of) * BIS_TWIN_VALUES * sizeof *f->twin) +
           (uint64_t)of->n_own * of->visibility.cells * sizeof(bis_seen);
}

void bis_state_walk_sums(bis_walk *w, bis_workspace *of)
{
    bis_film *f = of->film;

    walk_pixels(w, of, (values){.doubles = f->sum, .each = 3});
    walk_pixels(w, of, (values){.floats = f->deviation, .each = 3});
    walk_pixels(w, of, (values){.floats = f->half, .each = 3});
    walk_pixels(w, of, (values){.floats = f->hits, .each = 1});
    walk_pixels(w, of, (values){.doubles = f->layers.sum, .each = (size_t)f->layers.n_values});
    if (f->twin) walk_twins(w, of);
    walk_visibility(w, of);
}
