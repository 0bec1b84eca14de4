/* checkpoint: sums, counts and the number of passes; no random number has a state that could be lost.
 *
 * What a pass makes depends on its number, its first camera sample and its size (pass.c), on what earlier passes left
 * in the film, in adapt.h and in visibility.h, and on the scene. All but the scene is here, and of the scene a hash of
 * each of its parts, so that a checkpoint is refused where it would continue another picture. Files of the scene count
 * by what they hold, not by name. Threads and budgets are not part of it, because no pass depends on them; only whether
 * there is an error to reach, and the camera samples by which "stratified" and "halton" divide a pixel.
 *
 * One walk over the fields, in the order of the file, writes or reads or hashes them. Numbers are little-endian. The
 * last 8 bytes are a hash of all before: each of its steps is one-to-one, so no single damaged byte escapes it. Nothing
 * is allocated by a size that stands in the file: the file's length is compared with what the render has room for.
 *
 * Cost: 56 bytes a pixel (and 8 for each value of a layer, 1 KB for each tile that learns), written in one go. */
#include "checkpoint.h"

#include "base/text.h"
#include "bis/base/file.h"
#include "bis/base/mem.h"
#include "bis/base/version.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

enum { FORMAT = 1, NAME = 16 };

static const char magic[8] = {'\x89', 'b', 'i', 's', 'c', 'k', '\r', '\n'};

static const char *const part_names[BIS_CHECKPOINT_PARTS] = {
    "the size of the picture, or its crop",
    "the layers",
    "the camera",
    "the sampler, or its seed",
    "the camera samples for which samplers \"stratified\" and \"halton\" divide a pixel (--spp)",
    "pixel jitter, adaptive sampling, or camera samples on edges",
    "that an --error is asked for, or that none is",
    "the integrator, or its parameters",
    "the shapes",
    "the materials, or their textures",
    "the pixels of the map",
    "the parameters of the light",
    "the accelerator",
};

/* ---- fields ---- */

/* Exactly one of out and in is set, or none: then the fields are only hashed. */
typedef struct walk {
    FILE *out;
    const unsigned char *in, *end;
    bool bad;      /* in: a field lies beyond the end, or cannot be right */
    uint64_t hash; /* of what has been flushed */
    size_t n;
    unsigned char buffer[1 << 15];
} walk;

static void flush(walk *w)
{
    w->hash = bis_fnv1a(w->hash, w->buffer, w->n);
    if (w->out) fwrite(w->buffer, 1, w->n, w->out); /* bis_outfile_commit looks for errors */
    w->n = 0;
}

static inline uint64_t field(walk *w, uint64_t v, unsigned n_bytes)
{
    if (w->in) {
        v = 0;
        if ((size_t)(w->end - w->in) < n_bytes) w->bad = true;
        else
            for (unsigned i = 0; i < n_bytes; i++) v |= (uint64_t)*w->in++ << 8 * i;
        return v;
    }
    if (w->n + n_bytes > sizeof w->buffer) flush(w);
    for (unsigned i = 0; i < n_bytes; i++) w->buffer[w->n++] = (unsigned char)(v >> 8 * i);
    return v;
}

static void u64(walk *w, uint64_t *v) { *v = field(w, *v, 8); }
static void u32(walk *w, uint32_t *v) { *v = (uint32_t)field(w, *v, 4); }

static void f64(walk *w, double *v)
{
    uint64_t bits;
    memcpy(&bits, v, sizeof bits);
    bits = field(w, bits, 8);
    memcpy(v, &bits, sizeof bits);
}

static void f64s(walk *w, double *v, size_t n)
{
    for (size_t i = 0; i < n; i++) f64(w, &v[i]);
}

/* A name of fewer than NAME bytes, with zeros behind it. */
static void name(walk *w, char text[NAME])
{
    for (int i = 0; i < NAME; i++) text[i] = (char)field(w, (unsigned char)text[i], 1);
    if (text[NAME - 1]) w->bad = true;
    text[NAME - 1] = '\0';
}

/* ---- who the render is ---- */

static walk *hash_f32s(walk *w, const float *v, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        uint32_t bits;
        memcpy(&bits, &v[i], sizeof bits);
        u32(w, &bits);
    }
    return w;
}

static void hash_count(walk *w, uint64_t v) { u64(w, &v); }
static void hash_real(walk *w, double v) { f64(w, &v); }
static void hash_rgb(walk *w, rgb c) { hash_f32s(w, (const float[3]){c.r, c.g, c.b}, 3); }

static void hash_vectors(walk *w, const vec3 *v, size_t n)
{
    for (size_t i = 0; i < n; i++) hash_f32s(w, (const float[3]){v[i].x, v[i].y, v[i].z}, 3);
}

static void hash_xform(walk *w, const bis_xform *x)
{
    for (int i = 0; i < 16; i++) hash_real(w, x->m[i / 4][i % 4]);
}

static void hash_text(walk *w, const char *text)
{
    for (size_t i = 0; i <= strlen(text); i++) field(w, (unsigned char)text[i], 1);
}

/* The hash so far; the next one begins. */
static uint64_t take_hash(walk *w)
{
    flush(w);
    const uint64_t hash = w->hash;
    w->hash = BIS_FNV1A;
    return hash;
}

static void hash_film(walk *w, const bis_film *f)
{
    const int sizes[] = {f->full_width, f->full_height, f->step, f->picture_width, f->picture_height,
                         f->x0, f->y0, f->width, f->height};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) hash_count(w, (uint64_t)sizes[i]);
}

static void hash_camera(walk *w, const bis_camera *c)
{
    hash_count(w, c->orthographic);
    hash_real(w, c->fov_deg);
    hash_count(w, c->has_screen);
    for (int i = 0; i < 4 && c->has_screen; i++) hash_real(w, c->screen[i]);
    hash_real(w, c->frame_aspect);
    hash_xform(w, &c->to_world);
}

/* What an integrator does not read may differ. */
static void hash_settings(walk *w, const bis_settings *s)
{
    hash_text(w, s->integrator->name);
    for (const bis_parameter *p = NULL; (p = bis_parameter_next(s->integrator, p)) != NULL;) {
        hash_text(w, p->name);
        hash_real(w, bis_parameter_get(p, s));
    }
    hash_count(w, s->as_printed);
}

static void hash_geometry(walk *w, const bis_geometry *g)
{
    hash_count(w, g->n_vertices);
    hash_vectors(w, g->p, g->n_vertices);
    hash_count(w, g->n != NULL);
    if (g->n) hash_vectors(w, g->n, g->n_vertices);
    for (size_t i = 0; g->uv && i < g->n_vertices; i++) hash_f32s(w, (const float[2]){g->uv[i].u, g->uv[i].v}, 2);
    for (size_t i = 0; i < 3 * g->n_triangles; i++) field(w, g->index[i], 4);
    for (size_t i = 0; i < g->n_ranges; i++) hash_count(w, (uint64_t)g->ranges[i].first << 32 | g->ranges[i].material);
    for (size_t i = 0; i < g->n_quadrics; i++) {
        const bis_quadric *q = &g->quadrics[i];
        hash_count(w, (uint64_t)q->kind << 32 | q->material);
        hash_real(w, q->radius);
        hash_real(w, q->height);
        hash_xform(w, &q->to_world);
    }
}

static void hash_materials(walk *w, const bis_scene_desc *desc)
{
    for (size_t i = 0; i < desc->n_materials; i++) {
        const bis_material *m = &desc->materials[i];
        hash_text(w, m->model->name);
        hash_rgb(w, m->Kd);
        hash_rgb(w, m->Ks);
        hash_real(w, m->exponent);
        hash_real(w, m->alpha);
    }
}

static void hash_texture(walk *w, const bis_texture *t)
{
    const uint64_t counts[] = {t->kind, t->of[0], t->of[1], t->of[2], t->image, t->wrap, t->invert, t->is_float};

    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) hash_count(w, counts[i]);
    const double numbers[] = {t->value.r, t->value.g, t->value.b, t->factor[0], t->factor[1], t->offset[0],
                              t->offset[1], t->scale};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) hash_real(w, numbers[i]);
}

/* Images count by their texels, as maps do. */
static void hash_textures(walk *w, const bis_textures *t, const bis_scene *s)
{
    for (size_t i = 0; i < t->n_of_material; i++) {
        const bis_material_textures *m = &t->of_material[i];
        const uint64_t counts[] = {i, m->Kd, m->Ks, m->width};
        for (int k = 0; k < 4; k++) hash_count(w, counts[k]);
        hash_real(w, m->power);
    }
    for (size_t i = 0; i < t->n; i++) hash_texture(w, &t->list[i]);
    for (size_t i = 0; i < s->n_images; i++) {
        const bis_image *image = &s->images[i].image;
        hash_count(w, (uint64_t)image->width << 32 | (uint64_t)image->height);
        for (size_t k = 0; k < (size_t)image->width * (size_t)image->height; k++) hash_rgb(w, image->pixels[k]);
    }
}

/* The light's scale is in the pixels: another one changes this part as well as its parameters. */
static void hash_map(walk *w, const bis_light *light)
{
    const bis_envmap *em = bis_light_envmap(light);
    if (!em) return;
    hash_count(w, (uint64_t)em->width << 32 | (uint64_t)em->height);
    for (size_t i = 0; i < (size_t)em->width * (size_t)em->height; i++) hash_rgb(w, em->pixels[i]);
}

static void hash_light(walk *w, const bis_light_desc *l)
{
    const uint64_t counts[] = {l->angular, (uint64_t)l->width, (uint64_t)l->levels, l->has_table_kind,
                               l->has_table_kind ? l->table_kind : 0, l->visible};
    hash_rgb(w, l->L);
    hash_real(w, l->scale);
    hash_real(w, l->area_exponent);
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) hash_count(w, counts[i]);
    hash_xform(w, &l->to_world);
}

static void identify(uint64_t parts[BIS_CHECKPOINT_PARTS], walk *w, const bis_workspace *of)
{
    const bis_view *view = of->view;
    const bis_sampler *s = &view->sampler;
    const bool divides = !of->independent && (s->kind == BIS_SAMPLER_STRATIFIED || s->kind == BIS_SAMPLER_HALTON);
    int n = 0;

    *w = (walk){.hash = BIS_FNV1A};
    hash_film(w, of->film);
    parts[n++] = take_hash(w);
    hash_count(w, of->film->layers.asked);
    parts[n++] = take_hash(w);
    hash_camera(w, &view->camera);
    hash_real(w, of->options->footprint);
    parts[n++] = take_hash(w);
    hash_count(w, s->kind);
    hash_count(w, s->seed);
    hash_count(w, s->jitter);
    parts[n++] = take_hash(w);
    if (divides) hash_count(w, s->spp);
    parts[n++] = take_hash(w);
    hash_count(w, view->pixel_jitter);
    hash_count(w, view->adaptive);
    hash_count(w, of->edge ? view->edge_samples : 1);
    hash_count(w, of->options->pass_size);
    parts[n++] = take_hash(w);
    hash_count(w, of->options->budget.error > 0);
    parts[n++] = take_hash(w);
    hash_settings(w, &view->settings);
    parts[n++] = take_hash(w);
    hash_geometry(w, &of->scene->geometry);
    parts[n++] = take_hash(w);
    hash_materials(w, of->desc);
    hash_textures(w, &of->desc->textures, of->scene);
    parts[n++] = take_hash(w);
    hash_map(w, of->scene->light);
    parts[n++] = take_hash(w);
    hash_light(w, &of->desc->light);
    parts[n++] = take_hash(w);
    hash_text(w, of->scene->accel ? bis_accel_name(of->scene->accel) : "");
    hash_real(w, of->desc->accel.density);
    parts[n++] = take_hash(w);
}

/* ---- the file ---- */

/* All parameters, also those that the integrator does not read. */
static void walk_settings(walk *w, bis_settings *s)
{
    char text[NAME] = "";
    uint32_t as_printed = s->as_printed;

    if (s->integrator) bis_append(text, sizeof text, "%s", s->integrator->name);
    name(w, text);
    s->integrator = bis_integrator_find(text);
    for (const bis_parameter *p = bis_parameters; p->name; p++) {
        double v = bis_parameter_get(p, s);
        f64(w, &v);
        if (v >= 0 && v <= (p->type == BIS_PARAMETER_CHOICE ? BIS_MAX_CHOICES - 1 : UINT32_MAX))
            bis_parameter_set(p, s, v);
        else w->bad = true;
    }
    u32(w, &as_printed);
    s->as_printed = as_printed;
}

static void walk_head(walk *w, bis_settings *settings, double *pilot_seconds, uint64_t parts[BIS_CHECKPOINT_PARTS])
{
    walk_settings(w, settings);
    f64(w, pilot_seconds);
    for (int i = 0; i < BIS_CHECKPOINT_PARTS; i++) u64(w, &parts[i]);
}

static void walk_counters(walk *w, bis_counters *c)
{
    u64(w, &c->camera_rays);
    u64(w, &c->shadow_rays);
    u64(w, &c->candidates);
    u64(w, &c->accepted);
    u64(w, &c->fallbacks);
    u64(w, &c->nonfinite);
}

static void walk_done(walk *w, bis_done *d, uint32_t *passes, double *weight, double *weight_squares)
{
    u64(w, &d->spp);
    f64(w, &d->seconds);
    u32(w, &d->next_check);
    f64(w, &d->rmse_upper);
    walk_counters(w, &d->counters);
    u32(w, passes);
    f64(w, weight);
    f64(w, weight_squares);
}

static void walk_adapt(walk *w, bis_adapt *a)
{
    for (int t = 0; t < a->n_tiles; t++) {
        u32(w, &a->samples[t]);
        f64(w, &a->inverse[t]);
        f64(w, &a->noise[t]);
    }
}

static void walk_visibility(walk *w, bis_visibility *v)
{
    for (size_t t = 0; t < v->n_tiles; t++) {
        for (int i = 0; i < BIS_VISIBILITY_PARTS; i++) {
            u32(w, &v->known[t][i].rays);
            u32(w, &v->known[t][i].seen);
        }
    }
}

/* Of what the walks below take. */
static uint64_t sums_bytes(const bis_workspace *of)
{
    const bis_film *f = of->film;
    const uint64_t pixel = 8 * (7 + (uint64_t)f->layers.n_values);

    return (uint64_t)f->width * (uint64_t)f->height * pixel + (uint64_t)of->adapt.n_tiles * 20 +
           (uint64_t)of->visibility.n_tiles * BIS_VISIBILITY_PARTS * 8;
}

static void walk_sums(walk *w, bis_workspace *of)
{
    bis_film *f = of->film;
    const size_t n = (size_t)f->width * (size_t)f->height;

    f64s(w, f->sum, 3 * n);
    f64s(w, f->sum_squares, 3 * n);
    f64s(w, f->hits, n);
    f64s(w, f->layers.sum, n * (size_t)f->layers.n_values);
    walk_adapt(w, &of->adapt);
    walk_visibility(w, &of->visibility);
}

/* ---- reading ---- */

enum { BEFORE = sizeof magic + 4 + NAME, CHECKSUM = 8 }; /* bytes before the head, at the end */

/* Magic, version and checksum. */
static bis_status check_bytes(const unsigned char *data, size_t size, const char *path, bis_diag *diag)
{
    const bis_loc at = {path, 0, 0};
    char version[NAME];
    uint32_t format;
    walk w = {.in = data, .end = data + size};

    if (size < BEFORE + CHECKSUM || memcmp(data, magic, sizeof magic) != 0)
        return bis_error(diag, BIS_INPUT, at, "this is no checkpoint of bis, or it is cut short; "
                         "without --resume, or with another file, the render starts afresh");
    w.in += sizeof magic;
    u32(&w, &format);
    name(&w, version);
    w.in = w.end - CHECKSUM;
    if (field(&w, 0, CHECKSUM) != bis_fnv1a(BIS_FNV1A, data, size - CHECKSUM))
        return bis_error(diag, BIS_INPUT, at, "this checkpoint is damaged: its checksum is wrong");
    if (format != FORMAT || strcmp(version, BIS_VERSION) != 0)
        return bis_error(diag, BIS_INPUT, at, "bis %s wrote this checkpoint in format %" PRIu32 ", but this is bis %s, "
                         "format %d, whose pictures may have other bits: go on with the same version",
                         version, format, BIS_VERSION, FORMAT);
    return BIS_OK;
}

bis_status bis_checkpoint_read(bis_checkpoint *c, const char *path, bis_diag *diag)
{
    c->settings = bis_settings_default(&bis_auto);
    c->source = path;
    bis_status status = bis_file_read(&c->data, &c->size, path, (bis_loc){path, 0, 0}, diag);
    if (status) return status;
    status = check_bytes(c->data, c->size, path, diag);
    walk w = {.in = c->data + BEFORE, .end = c->data + c->size - CHECKSUM};
    if (!status) walk_head(&w, &c->settings, &c->pilot_seconds, c->parts);
    if (!status && w.bad) status = bis_error(diag, BIS_INPUT, (bis_loc){path, 0, 0}, "this checkpoint is damaged");
    c->at = status ? 0 : (size_t)(w.in - c->data);
    if (status) bis_checkpoint_clear(c);
    return status;
}

void bis_checkpoint_clear(bis_checkpoint *c)
{
    bis_free(c->data);
    c->data = NULL;
}

static bis_status compare(const bis_checkpoint *c, const uint64_t parts[BIS_CHECKPOINT_PARTS], bis_diag *diag)
{
    char list[1024] = "";

    for (int i = 0; i < BIS_CHECKPOINT_PARTS; i++)
        if (c->parts[i] != parts[i]) bis_append(list, sizeof list, "%s%s", *list ? "; " : "", part_names[i]);
    if (!*list) return BIS_OK;
    return bis_error(diag, BIS_INPUT, (bis_loc){c->source, 0, 0},
                     "this checkpoint belongs to another render. These differ: %s. Give the scene and options that it "
                     "was made with, or start afresh without --resume", list);
}

/* Only a file with a forged checksum can fail here. */
static bool is_sound(const bis_adapt *a, const bis_done *d, uint32_t passes, double weight)
{
    if (passes == 0 || d->spp == 0 || !(weight > 0) || !(d->seconds >= 0)) return false;
    for (int t = 0; t < a->n_tiles; t++)
        if (a->samples[t] < 1 || a->samples[t] > BIS_ADAPT_MOST) return false;
    return true;
}

static bis_status restore(bis_checkpoint *c, bis_workspace *of, bis_done *done, bis_diag *diag)
{
    walk w = {.in = c->data + c->at, .end = c->data + c->size - CHECKSUM};
    bis_film *f = of->film;

    walk_done(&w, done, &f->passes, &f->weight, &f->weight_squares);
    w.bad |= (uint64_t)(w.end - w.in) != sums_bytes(of);
    if (!w.bad) walk_sums(&w, of);
    if (w.bad || !is_sound(&of->adapt, done, f->passes, f->weight))
        return bis_error(diag, BIS_INPUT, (bis_loc){c->source, 0, 0}, "this checkpoint is damaged");
    return BIS_OK;
}

bis_status bis_checkpoint_begin(bis_checkpoint *c, bis_workspace *w, bis_done *done, bis_diag *diag)
{
    uint64_t parts[BIS_CHECKPOINT_PARTS];
    walk own;

    identify(parts, &own, w);
    bis_status status = c->data ? compare(c, parts, diag) : BIS_OK;
    if (!status && c->data) status = restore(c, w, done, diag);
    memcpy(c->parts, parts, sizeof parts);
    c->settings = w->view->settings;
    bis_checkpoint_clear(c);
    return status;
}

/* ---- writing ---- */

static void write_all(walk *w, bis_checkpoint *c, bis_workspace *of, bis_done *done)
{
    char version[NAME] = BIS_VERSION;
    uint32_t format = FORMAT;
    bis_settings settings = c->settings; /* the walk looks for the integrator by its name */

    for (size_t i = 0; i < sizeof magic; i++) field(w, (unsigned char)magic[i], 1);
    u32(w, &format);
    name(w, version);
    walk_head(w, &settings, &c->pilot_seconds, c->parts);
    walk_done(w, done, &of->film->passes, &of->film->weight, &of->film->weight_squares);
    walk_sums(w, of);
    flush(w);
    field(w, w->hash, CHECKSUM);
    flush(w);
}

void bis_checkpoint_save(bis_checkpoint *c, bis_workspace *w, bis_done *done)
{
    const bool failed_before = c->failed;
    bis_diag diag = {0};
    bis_outfile *file;

    if (!c->path) return;
    c->failed = bis_outfile_open(&file, c->path, &diag) != BIS_OK;
    if (!c->failed) {
        walk out = {.out = bis_outfile_stream(file), .hash = BIS_FNV1A};
        write_all(&out, c, w, done);
        c->failed = bis_outfile_commit(file, &diag) != BIS_OK;
    }
    if (c->failed && !failed_before && c->warn) c->warn(diag.n ? diag.messages[0].text : "no memory");
    bis_diag_clear(&diag);
}
