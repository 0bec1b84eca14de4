/* SPDX-License-Identifier: BSD-2-Clause */
/* identity: a hash of each part of the render, by what it holds. Files of the scene count by their content, not by
 * name. Threads and budgets are not part of it, because no pass depends on them; only whether there is an error to
 * reach, and the camera samples by which "stratified" and "halton" divide a pixel. */
#include "identity.h"

#include "walk.h"

#include "base/text.h"

#include <string.h>

static const char *const part_names[BIS_IDENTITY_PARTS] = {
    "the size of the picture, or its crop",
    "the layers",
    "the camera",
    "the sampler, or its seed",
    "the camera samples for which samplers \"stratified\" and \"halton\" divide a pixel (--spp)",
    "pixel jitter, or camera samples on edges",
    "the integrator, or its parameters",
    "the shapes",
    "the materials, or their textures",
    "the pixels of the map",
    "the parameters of the light",
    "the accelerator",
};

static bis_walk *hash_f32s(bis_walk *w, const float *v, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        uint32_t bits;
        memcpy(&bits, &v[i], sizeof bits);
        bis_walk_u32(w, &bits);
    }
    return w;
}

static void hash_count(bis_walk *w, uint64_t v) { bis_walk_u64(w, &v); }
static void hash_real(bis_walk *w, double v) { bis_walk_f64(w, &v); }
static void hash_rgb(bis_walk *w, rgb c) { hash_f32s(w, (const float[3]){c.r, c.g, c.b}, 3); }

static void hash_vectors(bis_walk *w, const vec3 *v, size_t n)
{
    for (size_t i = 0; i < n; i++) hash_f32s(w, (const float[3]){v[i].x, v[i].y, v[i].z}, 3);
}

static void hash_xform(bis_walk *w, const bis_xform *x)
{
    for (int i = 0; i < 16; i++) hash_real(w, x->m[i / 4][i % 4]);
}

static void hash_text(bis_walk *w, const char *text)
{
    for (size_t i = 0; i <= strlen(text); i++) bis_walk_field(w, (unsigned char)text[i], 1);
}

static void hash_film(bis_walk *w, const bis_film *f)
{
    const int sizes[] = {f->full_width, f->full_height, f->step, f->picture_width, f->picture_height,
                         f->x0, f->y0, f->width, f->height};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) hash_count(w, (uint64_t)sizes[i]);
}

static void hash_camera(bis_walk *w, const bis_camera *c)
{
    hash_count(w, c->orthographic);
    hash_real(w, c->fov_deg);
    hash_count(w, c->has_screen);
    for (int i = 0; i < 4 && c->has_screen; i++) hash_real(w, c->screen[i]);
    hash_real(w, c->frame_aspect);
    hash_xform(w, &c->to_world);
}

/* What an integrator does not read may differ. */
static void hash_settings(bis_walk *w, const bis_settings *s)
{
    hash_text(w, s->integrator->name);
    for (const bis_parameter *p = NULL; (p = bis_parameter_next(s->integrator, p)) != NULL;) {
        hash_text(w, p->name);
        hash_real(w, bis_parameter_get(p, s));
    }
    hash_count(w, s->as_printed);
}

static void hash_geometry(bis_walk *w, const bis_geometry *g)
{
    hash_count(w, g->n_vertices);
    hash_vectors(w, g->p, g->n_vertices);
    hash_count(w, g->n != NULL);
    if (g->n) hash_vectors(w, g->n, g->n_vertices);
    for (size_t i = 0; g->uv && i < g->n_vertices; i++) hash_f32s(w, (const float[2]){g->uv[i].u, g->uv[i].v}, 2);
    for (size_t i = 0; i < 3 * g->n_triangles; i++) bis_walk_field(w, g->index[i], 4);
    for (size_t i = 0; i < g->n_ranges; i++) hash_count(w, (uint64_t)g->ranges[i].first << 32 | g->ranges[i].material);
    for (size_t i = 0; i < g->n_quadrics; i++) {
        const bis_quadric *q = &g->quadrics[i];
        hash_count(w, (uint64_t)q->kind << 32 | q->material);
        hash_real(w, q->radius);
        hash_real(w, q->height);
        hash_xform(w, &q->to_world);
    }
}

static void hash_materials(bis_walk *w, const bis_scene_desc *desc)
{
    for (size_t i = 0; i < desc->n_materials; i++) {
        const bis_material *m = &desc->materials[i];
        double v[BIS_MATERIAL_NUMBERS];
        hash_text(w, m->model->name);
        bis_material_numbers(v, m);
        for (int k = 0; k < BIS_MATERIAL_NUMBERS; k++) hash_real(w, v[k]);
    }
}

static void hash_texture(bis_walk *w, const bis_texture *t)
{
    const uint64_t counts[] = {t->kind, t->of[0],  t->of[1],    t->of[2],   t->of[3],
                               t->image, t->wrap, t->invert, t->is_float, t->mapping, t->octaves};
    const double numbers[] = {t->value.r, t->value.g, t->value.b, t->factor[0], t->factor[1], t->offset[0],
                              t->offset[1], t->scale, t->roughness, t->variation};

    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) hash_count(w, counts[i]);
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) hash_real(w, numbers[i]);
    for (int i = 0; i < 12; i++) hash_real(w, t->from_world[i / 4][i % 4]);
}

/* Images count by their texels, as maps do. */
static void hash_textures(bis_walk *w, const bis_textures *t, const bis_scene *s)
{
    for (size_t i = 0; i < t->n_of_material; i++) {
        const bis_material_textures *m = &t->of_material[i];
        const uint64_t counts[] = {i, m->Kd, m->Ks, m->width, m->bump, m->normals};
        for (size_t k = 0; k < sizeof counts / sizeof *counts; k++) hash_count(w, counts[k]);
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
static void hash_map(bis_walk *w, const bis_light *light)
{
    const bis_envmap *em = bis_light_envmap(light);
    if (!em) return;
    hash_count(w, (uint64_t)em->width << 32 | (uint64_t)em->height);
    for (size_t i = 0; i < (size_t)em->width * (size_t)em->height; i++) hash_rgb(w, em->pixels[i]);
}

static void hash_light(bis_walk *w, const bis_light_desc *l)
{
    const uint64_t counts[] = {l->mapping, (uint64_t)l->width, (uint64_t)l->levels, l->has_table_kind,
                               l->has_table_kind ? l->table_kind : 0, l->visible, l->is_smooth};
    hash_rgb(w, l->L);
    hash_real(w, l->scale);
    hash_real(w, l->area_exponent);
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) hash_count(w, counts[i]);
    hash_xform(w, &l->to_world);
}

void bis_identify(uint64_t parts[BIS_IDENTITY_PARTS], const bis_workspace *of)
{
    const bis_view *view = of->view;
    const bis_sampler *s = &view->sampler;
    const bool divides = s->kind == BIS_SAMPLER_STRATIFIED || s->kind == BIS_SAMPLER_HALTON;
    bis_walk own = {.hash = BIS_FNV1A}, *w = &own;
    int n = 0;

    hash_film(w, of->film);
    parts[n++] = bis_walk_take_hash(w);
    hash_count(w, of->film->layers.asked);
    parts[n++] = bis_walk_take_hash(w);
    hash_camera(w, &view->camera);
    parts[n++] = bis_walk_take_hash(w);
    hash_count(w, s->kind);
    hash_count(w, s->seed);
    hash_count(w, s->jitter);
    parts[n++] = bis_walk_take_hash(w);
    if (divides) hash_count(w, s->spp);
    parts[n++] = bis_walk_take_hash(w);
    hash_count(w, view->pixel_jitter);
    hash_count(w, of->edge ? view->edge_samples : 1);
    hash_real(w, of->edge ? view->edge_light : 1);
    hash_count(w, of->options->pass_size);
    parts[n++] = bis_walk_take_hash(w);
    hash_settings(w, &view->settings);
    parts[n++] = bis_walk_take_hash(w);
    hash_geometry(w, &of->scene->geometry);
    parts[n++] = bis_walk_take_hash(w);
    hash_materials(w, of->desc);
    hash_textures(w, &of->desc->textures, of->scene);
    parts[n++] = bis_walk_take_hash(w);
    hash_map(w, of->scene->light);
    parts[n++] = bis_walk_take_hash(w);
    hash_light(w, &of->desc->light);
    parts[n++] = bis_walk_take_hash(w);
    hash_text(w, of->scene->accel ? bis_accel_name(of->scene->accel) : "");
    hash_real(w, of->desc->accel.density);
    parts[n++] = bis_walk_take_hash(w);
}

bool bis_identity_differs(char *list, size_t size, const uint64_t a[BIS_IDENTITY_PARTS],
                          const uint64_t b[BIS_IDENTITY_PARTS])
{
    *list = '\0';
    for (int i = 0; i < BIS_IDENTITY_PARTS; i++)
        if (a[i] != b[i]) bis_append(list, size, "%s%s", *list ? "; " : "", part_names[i]);
    return *list != '\0';
}
