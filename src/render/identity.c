/* SPDX-License-Identifier: BSD-2-Clause */
/* identity: a hash of each part of the render, by what it holds. Files of the scene count by their content, not by
 * name. Threads and budgets are not part of it, because no pass depends on them; only the camera samples by which
 * "stratified" and "halton" divide a pixel.
 *
 * A new field of a struct is an entry of its table, or a word of bis_identity_structs if no picture depends on it. */
#include "identity.h"

#include "walk.h"

#include "base/text.h"
#include "scene/light_fields.h"

#include <stddef.h>
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

/* ---- the fields that count ---- */

#define FIELD BIS_FIELD
#define FIELDS(name) static const bis_field name[]
#define END BIS_FIELDS_END

FIELDS(film) = {
    FIELD(bis_film, full_width, int), FIELD(bis_film, full_height, int), FIELD(bis_film, step, int),
    FIELD(bis_film, picture_width, int), FIELD(bis_film, picture_height, int), FIELD(bis_film, x0, int),
    FIELD(bis_film, y0, int), FIELD(bis_film, width, int), FIELD(bis_film, height, int), END};
FIELDS(camera) = {
    FIELD(bis_camera, orthographic, bool), FIELD(bis_camera, fov_deg, double), FIELD(bis_camera, has_screen, bool),
    FIELD(bis_camera, screen, double), FIELD(bis_camera, frame_aspect, double), FIELD(bis_camera, to_world, double),
    END};
FIELDS(sampler) = {
    FIELD(bis_sampler, kind, bis_sampler_kind), FIELD(bis_sampler, seed, uint64_t), FIELD(bis_sampler, jitter, bool),
    END};
FIELDS(division) = {
    FIELD(bis_sampler, spp, uint64_t), FIELD(bis_sampler, xsamples, uint64_t), FIELD(bis_sampler, ysamples, uint64_t),
    END};
FIELDS(view) = {
    FIELD(bis_view, pixel_jitter, bool), FIELD(bis_view, edge_samples, uint32_t), FIELD(bis_view, edge_light, double),
    END};
FIELDS(quadric) = {
    FIELD(bis_quadric, kind, bis_quadric_kind), FIELD(bis_quadric, radius, double),
    FIELD(bis_quadric, height, double), FIELD(bis_quadric, to_world, double), FIELD(bis_quadric, material, uint32_t),
    END};
FIELDS(material_textures) = {
    FIELD(bis_material_textures, Kd, uint32_t), FIELD(bis_material_textures, Ks, uint32_t),
    FIELD(bis_material_textures, width, uint32_t), FIELD(bis_material_textures, power, double),
    FIELD(bis_material_textures, bump, uint32_t), FIELD(bis_material_textures, normals, uint32_t), END};
FIELDS(texture) = {
    FIELD(bis_texture, kind, bis_texture_kind), FIELD(bis_texture, of, uint32_t), FIELD(bis_texture, value, double),
    FIELD(bis_texture, mapping, bis_texture_mapping), FIELD(bis_texture, factor, double),
    FIELD(bis_texture, offset, double), FIELD(bis_texture, from_world, double), FIELD(bis_texture, image, uint32_t),
    FIELD(bis_texture, wrap, bis_wrap), FIELD(bis_texture, octaves, uint32_t), FIELD(bis_texture, roughness, double),
    FIELD(bis_texture, variation, double), FIELD(bis_texture, scale, double), FIELD(bis_texture, invert, bool),
    FIELD(bis_texture, is_float, bool), END};
FIELDS(accel) = {
    FIELD(bis_accel_options, density, double), END};

FIELDS(by_hand) = {END}; /* by a function of their own, below */

const bis_identity_struct bis_identity_structs[] = {
    /* what passes add up; of the layers those that are asked for count; whether the film is transparent follows from
     * `visible` of the light */
    {"bis_film", film, "sum deviation half hits passes weight half_weight most independent transparent layers twin"},
    {"bis_camera", camera, "points"}, /* they are given to a process that keeps no checkpoint */
    {"bis_sampler", sampler, ""},
    {"bis_sampler", division, ""},
    /* of the film the sizes of a bis_film count; settings: hash_settings */
    {"bis_view", view, "camera film sampler settings"},
    {"bis_quadric", quadric, ""},
    {"bis_material_textures", material_textures, "loc"},
    {"bis_texture", texture, "steps"}, /* they follow from the parts */
    /* of a map its pixels count, whatever they are made of; as_printed is that of the settings */
    {"bis_light_desc", bis_light_fields, "filename image illuminance has_mapping is_v4 distants n_distants "
                                         "capacity_distants as_printed loc"},
    {"bis_accel_options", accel, "kind n_threads eyes"}, /* the name of what is built counts */
    {"bis_geometry", by_hand, "p n uv index n_vertices n_triangles capacity_vertices capacity_triangles ranges "
                              "n_ranges quadrics n_quadrics box"},
    {"bis_material", by_hand, "model Kd Ks exponent alpha eta"},
    {"bis_textures", by_hand, "list n capacity files n_files capacity_files of_material n_of_material "
                              "capacity_of_material cuts_off"},
    /* of files and meshes what is built of them counts */
    {"bis_scene_desc", by_hand, "path view outfile integrator_loc names_integrator light_needs accel has_light light "
                                "upright materials n_materials capacity_materials textures meshes n_meshes "
                                "capacity_meshes shapes n_shapes capacity_shapes files n_files capacity_files "
                                "approximations n_approximations capacity_approximations version missing n_missing "
                                "capacity_missing"},
    /* shape_end: for messages */
    {"bis_scene", by_hand, "desc geometry accel light images n_images shape_end seconds"},
    /* pass_size counts; the others say when and where a render ends, and who is told */
    {"bis_render_options", by_hand, "budget n_threads pass_size interrupted progress forecast first_light "
                                    "so_far every user part ranks checkpoint"},
    {NULL, NULL, NULL},
};

/* ---- hashes ---- */

/* n numbers of `bytes` bytes each. Bits and not values: -0 and 0 may give different pictures. */
static void hash_numbers(bis_walk *w, const void *of, size_t n, size_t bytes)
{
    const unsigned char *at = of;

    for (size_t i = 0; i < n; i++, at += bytes) {
        uint64_t v = *at;
        uint32_t v32;
        if (bytes == sizeof v) memcpy(&v, at, sizeof v);
        if (bytes == sizeof v32) v = (memcpy(&v32, at, sizeof v32), v32);
        bis_walk_field(w, v, (unsigned)bytes);
    }
}

static void hash_count(bis_walk *w, uint64_t v) { bis_walk_u64(w, &v); }
static void hash_real(bis_walk *w, double v) { bis_walk_f64(w, &v); }

/* With its end, so that "ab", "c" and "a", "bc" differ. */
static void hash_text(bis_walk *w, const char *text) { hash_numbers(w, text, strlen(text) + 1, 1); }

static void hash_fields(bis_walk *w, const void *of, const bis_field *fields)
{
    for (const bis_field *f = fields; f->name; f++)
        hash_numbers(w, (const char *)of + f->offset, f->n, f->bytes);
}

static void hash_camera(bis_walk *w, bis_camera c)
{
    if (!c.has_screen) memset(c.screen, 0, sizeof c.screen);
    hash_fields(w, &c, camera);
}

static void hash_division(bis_walk *w, bis_sampler s)
{
    if (s.kind != BIS_SAMPLER_STRATIFIED && s.kind != BIS_SAMPLER_HALTON) return;
    if (s.kind == BIS_SAMPLER_HALTON) s.xsamples = s.ysamples = 0; /* it has other cells */
    hash_fields(w, &s, division);
}

static void hash_edges(bis_walk *w, bis_view v, bool has_edges)
{
    if (!has_edges) v.edge_samples = 1, v.edge_light = 1;
    hash_fields(w, &v, view);
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

/* Counts come before arrays, so that no number can move from one array to the next. */
static void hash_geometry(bis_walk *w, const bis_geometry *g)
{
    hash_count(w, g->n_vertices);
    hash_numbers(w, g->p, 3 * g->n_vertices, sizeof(float));
    hash_count(w, g->n != NULL);
    if (g->n) hash_numbers(w, g->n, 3 * g->n_vertices, sizeof(float));
    if (g->uv) hash_numbers(w, g->uv, 2 * g->n_vertices, sizeof(float));
    hash_numbers(w, g->index, 3 * g->n_triangles, sizeof *g->index);
    hash_numbers(w, g->ranges, 3 * g->n_ranges, sizeof(uint32_t));
    for (size_t i = 0; i < g->n_quadrics; i++) hash_fields(w, &g->quadrics[i], quadric);
}

/* The numbers of the model. */
static void hash_materials(bis_walk *w, const bis_scene_desc *desc)
{
    for (size_t i = 0; i < desc->n_materials; i++) {
        const bis_material *m = &desc->materials[i];
        double v[BIS_MATERIAL_NUMBERS];
        hash_text(w, m->model->name);
        bis_material_numbers(v, m);
        hash_numbers(w, v, BIS_MATERIAL_NUMBERS, sizeof *v);
    }
}

static void hash_pixels(bis_walk *w, int width, int height, const rgb *pixels)
{
    hash_count(w, (uint64_t)width << 32 | (uint64_t)height);
    hash_numbers(w, pixels, 3 * (size_t)width * (size_t)height, sizeof(float));
}

/* Images count by their texels, as maps do. */
static void hash_textures(bis_walk *w, const bis_textures *t, const bis_scene *s)
{
    for (size_t i = 0; i < t->n_of_material; i++) {
        hash_count(w, i);
        hash_fields(w, &t->of_material[i], material_textures);
    }
    for (size_t i = 0; i < t->n; i++) hash_fields(w, &t->list[i], texture);
    for (size_t i = 0; i < s->n_images; i++) {
        const bis_image *image = &s->images[i].image;
        hash_pixels(w, image->width, image->height, image->pixels);
        hash_count(w, s->images[i].holds_normals);
    }
}

/* The light's scale is in the pixels: another one changes this part as well as its parameters. */
static void hash_map(bis_walk *w, const bis_light *built)
{
    const bis_envmap *em = bis_light_envmap(built);
    if (em) hash_pixels(w, em->width, em->height, em->pixels);
}

/* What a scene leaves open is hashed as open: table_kind is set when the light is built, and follows from the rest. */
static void hash_light(bis_walk *w, bis_light_desc l)
{
    if (!l.has_table_kind) l.table_kind = 0;
    hash_fields(w, &l, bis_light_fields);
}

/* Part by part, in the order of part_names. What is not hashed must not change a picture (see above). */
void bis_identify(uint64_t parts[BIS_IDENTITY_PARTS], const bis_workspace *of)
{
    bis_walk own = {.hash = BIS_FNV1A}, *w = &own;
    int n = 0;

    hash_fields(w, of->film, film);
    parts[n++] = bis_walk_take_hash(w);
    hash_count(w, of->film->layers.asked);
    parts[n++] = bis_walk_take_hash(w);
    hash_camera(w, of->view->camera);
    parts[n++] = bis_walk_take_hash(w);
    hash_fields(w, &of->view->sampler, sampler);
    parts[n++] = bis_walk_take_hash(w);
    hash_division(w, of->view->sampler);
    parts[n++] = bis_walk_take_hash(w);
    hash_edges(w, *of->view, of->edge);
    hash_count(w, of->options->pass_size);
    parts[n++] = bis_walk_take_hash(w);
    hash_settings(w, &of->view->settings);
    parts[n++] = bis_walk_take_hash(w);
    hash_geometry(w, &of->scene->geometry);
    parts[n++] = bis_walk_take_hash(w);
    hash_materials(w, of->desc);
    hash_textures(w, &of->desc->textures, of->scene);
    parts[n++] = bis_walk_take_hash(w);
    hash_map(w, of->scene->light);
    parts[n++] = bis_walk_take_hash(w);
    hash_light(w, of->desc->light);
    parts[n++] = bis_walk_take_hash(w);
    hash_text(w, of->scene->accel ? bis_accel_name(of->scene->accel) : "");
    hash_fields(w, &of->desc->accel, accel);
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
