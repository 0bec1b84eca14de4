/* SPDX-License-Identifier: BSD-2-Clause */
/* plan: what a scene requires, what will be built for it, what is left out, and why (`bis --plan`).
 *
 * It reads what scene.c reads (src/scene/scene_needs.h), and decides nothing by itself. Each line starts with what it
 * is about, so that a script finds it: "light", "geometry" and so on describe, "build" and "skip" decide. */
#include "bis/base/file.h"
#include "bis/base/mem.h"
#include "scene/distant.h"
#include "scene/scene_needs.h"
#include "scene/scene_peek.h"
#include "scene/texture_value.h"

#include "tools/describe.h"
#include "tools/memory.h"

#include <inttypes.h>
#include <string.h>

static const char *megabytes(char buf[32], double bytes)
{
    snprintf(buf, 32, "%.1f MB", bytes / 1e6);
    return buf;
}

/* ---- what is described ---- */

static void print_settings(const bis_settings *s, FILE *out)
{
    const char *between = " ";
    char buf[32];

    fprintf(out, "%s:", s->integrator->name);
    for (const bis_parameter *p = NULL; (p = bis_parameter_next(s->integrator, p)) != NULL; between = ", ")
        fprintf(out, "%s%s %s", between, p->name, bis_parameter_text(buf, p, bis_parameter_get(p, s)));
    fprintf(out, "\nclaim        %s\n", s->integrator->claim);
}

static void print_integrators(const bis_scene_desc *d, FILE *out)
{
    const bis_settings *s = &d->view.settings;

    fputs("integrator   ", out);
    print_settings(s, out);
    for (const bis_erratum *e = bis_errata; e->name; e++)
        if (s->as_printed & e->flag) fprintf(out, "as printed   %s (%s): %s\n", e->name, e->section, e->effect);
}

static void print_view(const bis_scene_desc *d, FILE *out)
{
    char a[32], c[4][32];
    const bis_sampler *s = &d->view.sampler;
    for (int i = 0; i < 4; i++) bis_format_double(c[i], d->view.film.crop[i]);
    fprintf(out, "scene        %s\nversion      %s\n", d->path, d->version);
    fprintf(out, "film         %d x %d, cropwindow %s %s %s %s, to %s\n", d->view.film.width, d->view.film.height, c[0],
            c[1], c[2], c[3], d->outfile);
    if (d->view.camera.orthographic) fprintf(out, "camera       orthographic\n");
    else fprintf(out, "camera       perspective, fov %s\n", bis_format_double(a, d->view.camera.fov_deg));
    fprintf(out, "sampler      %s, %" PRIu64 " camera samples a pixel", bis_sampler_name(s->kind), s->spp);
    if (s->kind == BIS_SAMPLER_STRATIFIED) fprintf(out, " (%" PRIu64 " x %" PRIu64 ")", s->xsamples, s->ysamples);
    if (d->view.edge_samples > 1 && d->view.pixel_jitter)
        fprintf(out, ", %" PRIu32 " for each of them on outlines", d->view.edge_samples);
    if (d->view.edge_samples > 1 && d->view.pixel_jitter && d->view.edge_light < 1)
        fprintf(out, " with %s of its light samples each", bis_format_double(a, d->view.edge_light));
    fprintf(out, ", seed %" PRIu64 "%s\n", s->seed, d->view.pixel_jitter ? "" : ", all through the pixel's centre");
}

static void print_tiles(const bis_scene_desc *d, FILE *out)
{
    const bis_film f = bis_film_place(d->view.film.width, d->view.film.height, d->view.film.crop, 1);
    int across;

    if (f.width <= 0 || f.height <= 0 || !bis_scene_learns(d)) return;
    const int n = bis_film_tiles(&f, BIS_RENDER_TILE, &across);
    const bis_rect first = bis_film_tile(&f, BIS_RENDER_TILE, 0), last = bis_film_tile(&f, BIS_RENDER_TILE, n - 1);
    const int width = last.x1 - first.x0, height = last.y1 - first.y0;
    if (width == f.width && height == f.height) return;
    fprintf(out,
            "crop         %d x %d pixels are rendered for its %d x %d, whole tiles of %d x %d: \"learn\" is by tiles\n",
            width, height, f.width, f.height, (int)BIS_RENDER_TILE, (int)BIS_RENDER_TILE);
}

static void print_film(const bis_scene_desc *d, FILE *out)
{
    const double pixels = (double)d->view.film.width * d->view.film.height *
                          (d->view.film.crop[1] - d->view.film.crop[0]) * (d->view.film.crop[3] - d->view.film.crop[2]);
    char buf[32];
    int n = 0;

    fprintf(out, "build        film: about %s\n", megabytes(buf, pixels * (BIS_FILM_BYTES + BIS_PASS_BYTES)));
    if (!d->view.film.layers) {
        fprintf(out, "skip         layers: none is asked for\n");
        return;
    }
    fputs("build        layers", out);
    for (int i = 0; i < BIS_N_LAYERS; i++) {
        if (!(d->view.film.layers >> i & 1)) continue;
        fprintf(out, " %s", bis_layer_name((bis_layer)i));
        n += bis_layer_values((bis_layer)i);
    }
    fprintf(out, ": about %s\n", megabytes(buf, pixels * (BIS_LAYER_SUM_BYTES + BIS_LAYER_PASS_BYTES) * n));
}

static void print_light(const bis_scene_desc *d, FILE *out)
{
    const bis_light_desc *light = &d->light;
    char buf[32];
    long w, h;
    bis_mapping mapping = BIS_MAPPING_LATLONG;
    if (!d->has_light) {
        fprintf(out, "light        none: the picture will be black\n");
    } else if (!light->filename) {
        fprintf(out, "light        constant\n");
        if (light->n_distants)
            fprintf(out, "light        and %zu distant, as discs in a map of %d x %d\n", light->n_distants,
                    BIS_DISTANT_WIDTH, BIS_DISTANT_WIDTH / 2);
    } else if (bis_memory_map_size(light, &w, &h, &mapping)) {
        fprintf(out, "light        map %s, %s%s, %ld x %ld: %s of pixels\n", light->filename,
                bis_mapping_names[mapping], mapping == BIS_MAPPING_LATLONG ? "" : ", resampled to latlong", w, h,
                megabytes(buf, (double)w * (double)h * sizeof(rgb)));
    } else {
        fprintf(out, "light        map %s, %s, a file of %s\n", light->filename, bis_mapping_names[mapping],
                megabytes(buf, (double)bis_scene_peek_bytes(light->filename)));
    }
    if (light->n_portals) fprintf(out, "light        portals: %u\n", (unsigned)light->n_portals);
    if (d->has_light && !light->visible) fprintf(out, "light        not visible to camera rays\n");
}

/* ---- what is built ---- */

static void print_mesh(const bis_mesh_desc *m, size_t uses, FILE *out)
{
    char buf[32];
    long vertices, faces;
    const char *times = uses == 1 ? "shape" : "shapes";
    if (m->kind == BIS_SHAPE_TRIANGLES)
        fprintf(out, "build        mesh of the scene file, %zu triangles, for %zu %s\n", m->size.triangles, uses,
                times);
    else if (m->kind == BIS_SHAPE_PLY && bis_scene_peek_ply(m->filename, &vertices, &faces))
        fprintf(out, "build        mesh %s, %ld vertices, %ld faces, read once for %zu %s\n", m->filename, vertices,
                faces, uses, times);
    else
        fprintf(out, "build        mesh %s, a file of %s, read once for %zu %s\n", m->filename,
                megabytes(buf, (double)bis_scene_peek_bytes(m->filename)), uses, times);
}

static void print_geometry(const bis_scene_desc *d, const bis_scene_needs *needs, FILE *out)
{
    fprintf(out, "geometry     %zu shapes with instances: %zu of meshes, %zu spheres and disks\n", d->n_shapes,
            d->n_shapes - needs->n_quadrics, needs->n_quadrics);
    for (size_t i = 0; i < d->n_meshes; i++) {
        if (needs->uses[i]) print_mesh(&d->meshes[i], needs->uses[i], out);
        else fprintf(out, "skip         mesh %s: no shape or instance uses it\n",
                     d->meshes[i].filename ? d->meshes[i].filename : "of the scene file");
    }
}

static void print_drawing(const bis_scene_desc *d, const bis_scene_needs *needs, FILE *out)
{
    const bis_light_desc *light = &d->light;
    const char *why = needs->why_no_drawing;
    const bool cdf = needs->table == BIS_TABLE_CDF;
    char size[32] = "", bound[64] = "";
    bis_mapping mapping;
    long w, h;

    if (why) {
        fprintf(out, "skip         light table: %s\nskip         light curve: %s\nskip         light components: %s\n",
                why, why, why);
        return;
    }
    if (bis_memory_map_size(light, &w, &h, &mapping))
        snprintf(bound, sizeof bound, ": at most %s", megabytes(size, (double)w * (double)h * BIS_DRAWING_BYTES));
    if (needs->light & BIS_NEED_TABLE)
        fprintf(out, "build        light table, %s%s%s\n", cdf ? "CDFs" : "alias tables",
                needs->light & BIS_NEED_COMPENSATED ? ", compensated for mis" : "", bound);
    else fprintf(out, "skip         light table: this integrator, so set, draws along the curve\n");
    if (needs->light & BIS_NEED_CURVE)
        fprintf(out, "build        light curve, one CDF along a space-filling curve%s\n", bound);
    else fprintf(out, "skip         light curve: this integrator, so set, draws from the table\n");
    if (light->area_exponent > 0)
        fprintf(out, "build        light components, %d levels, areaexponent %s\n", light->levels,
                bis_format_double(size, light->area_exponent));
    else fprintf(out, "skip         light components: areaexponent is 0\n");
}

static void print_colour(const char *name, rgb c, FILE *out)
{
    char r[32], g[32], b[32];
    bis_format_float(r, c.r);
    fprintf(out, ", %s %s", name, r);
    if (c.g != c.r || c.b != c.r) fprintf(out, " %s %s", bis_format_float(g, c.g), bis_format_float(b, c.b));
}

/* The last part of an image's name. */
static const char *last_name(const bis_textures *t, uint32_t image)
{
    const char *slash = strrchr(t->files[image].filename, '/');
    return slash ? slash + 1 : t->files[image].filename;
}

/* The first image that a texture is made of, or BIS_NO_TEXTURE. */
static uint32_t image_of(const bis_textures *t, uint32_t texture)
{
    const bis_texture *x = &t->list[texture];
    uint32_t image = x->kind == BIS_TEXTURE_IMAGE ? x->image : BIS_NO_TEXTURE;
    for (int i = 0; i < bis_texture_n_parts(x) && image == BIS_NO_TEXTURE; i++) image = image_of(t, x->of[i]);
    return image;
}

static void print_texture(const char *name, const bis_textures *t, uint32_t texture, FILE *out)
{
    const uint32_t image = image_of(t, texture);
    const bool is_image = t->list[texture].kind == BIS_TEXTURE_IMAGE;
    fprintf(out, ", %s texture (%s", name, is_image ? "" : bis_texture_names[t->list[texture].kind]);
    if (image != BIS_NO_TEXTURE) fprintf(out, "%s%s", is_image ? "" : " of ", last_name(t, image));
    fputc(')', out);
}

/* Every image, and the texture coordinates. */
static void print_textures(const bis_scene_desc *d, const bis_scene_needs *needs, FILE *out)
{
    const bis_textures *t = &d->textures;
    bool any = false;
    for (size_t i = 0; i < d->n_meshes; i++) any |= needs->with_uv[i];
    for (size_t i = 0; i < t->n_files; i++) {
        const char *file = t->files[i].filename;
        char buf[32];
        long w, h;
        if (!needs->images[i]) fprintf(out, "skip         texture %s: no shape shows it\n", file);
        else if (bis_scene_peek_image(file, &w, &h))
            fprintf(out, "build        texture %s, %ld x %ld: %s\n", file, w, h,
                    megabytes(buf, (double)w * (double)h * sizeof(rgb)));
        else fprintf(out, "build        texture %s, a file of %s\n", file,
                     megabytes(buf, (double)bis_scene_peek_bytes(file)));
    }
    if (any) fprintf(out, "build        texture coordinates: %zu bytes for each vertex of the scene\n", sizeof(bis_uv));
}

/* By number, see src/scene/scene_materials.c. */
static void print_materials(const bis_scene_desc *d, FILE *out)
{
    uint32_t *number, n = 0;
    if (bis_scene_number_materials(&number, &n, d, NULL)) return; /* no memory: a plan without numbers */
    size_t *shapes = bis_alloc(n, sizeof *shapes), *first = bis_alloc(n, sizeof *first);
    for (size_t i = d->n_shapes; i-- > 0 && shapes && first;) {
        const uint32_t k = number[d->shapes[i].material];
        shapes[k]++;
        first[k] = d->shapes[i].material;
    }
    for (uint32_t k = 0; k < n && shapes && first; k++) {
        const bis_material *m = &d->materials[first[k]];
        char buf[32];
        fprintf(out, "material     %" PRIu32 ": %s", k, m->model->name);
        const bis_material_textures *t = bis_textures_of(&d->textures, (uint32_t)first[k]);
        const bis_bsdf_width w = m->model->width(m);
        if (t && t->Kd != BIS_NO_TEXTURE) print_texture("Kd", &d->textures, t->Kd, out);
        else print_colour("Kd", m->Kd, out);
        if (t && t->Ks != BIS_NO_TEXTURE) print_texture("Ks", &d->textures, t->Ks, out);
        else print_colour("Ks", m->Ks, out);
        if (!rgb_is_black(m->eta)) print_colour("eta", m->eta, out);
        if (t && t->width != BIS_NO_TEXTURE) print_texture(w.scene_name, &d->textures, t->width, out);
        else if (w.scene_name && w.scene_value > 0)
            fprintf(out, ", %s %s", w.scene_name, bis_format_double(buf, w.scene_value));
        if (t && t->bump != BIS_NO_TEXTURE) print_texture("bump", &d->textures, t->bump, out);
        if (t && t->normals != BIS_NO_TEXTURE) fprintf(out, ", normal map (%s)", last_name(&d->textures, t->normals));
        fprintf(out, "; %zu shape%s", shapes[k], shapes[k] == 1 ? "" : "s");
        fputc('\n', out);
    }
    bis_free(shapes);
    bis_free(first);
    bis_free(number);
}

static void print_lobes(const bis_scene_desc *d, const bis_scene_needs *needs, FILE *out)
{
    size_t n = 0, no_diffuse = 0, no_specular = 0;
    for (size_t i = 0; i < d->n_materials; i++) {
        if (!needs->materials[i]) continue;
        n++;
        no_diffuse += rgb_is_black(d->materials[i].Kd);
        no_specular += rgb_is_black(d->materials[i].Ks);
    }
    fprintf(out, "materials    %zu in use\n", n);
    print_materials(d, out);
    if (no_diffuse) fprintf(out, "skip         diffuse candidates: Kd is 0 in %zu of %zu materials\n", no_diffuse, n);
    if (no_specular)
        fprintf(out, "skip         specular candidates: Ks is 0 in %zu of %zu materials\n", no_specular, n);
}

static void print_accel(const bis_scene_desc *d, const bis_scene_needs *needs, FILE *out)
{
    char buf[32];
    if (!d->n_shapes) fprintf(out, "skip         accelerator: there is no geometry\n");
    else if (needs->embree) fprintf(out, "build        accelerator embree\n");
    else if (d->accel.density > 0)
        fprintf(out, "build        accelerator grid, density %s\n", bis_format_double(buf, d->accel.density));
    else fprintf(out, "build        accelerator grid, default density\n");
}

static void print_approximations(const bis_scene_desc *d, FILE *out)
{
    for (size_t i = 0; i < d->n_approximations; i++) {
        char text[BIS_APPROXIMATION_TEXT];
        fprintf(out, "approximated %s\n", bis_approximation_text(text, &d->approximations[i]));
    }
    for (size_t i = 0; i < d->n_missing; i++) fprintf(out, "missing      %s\n", d->missing[i]);
}

static void print_memory(const bis_scene_desc *d, FILE *out)
{
    bis_memory m;
    char c[6][32];

    if (bis_memory_foresee(&m, d, NULL)) return; /* no memory: a plan without it */
    fprintf(out, "memory       about %s at the peak: film %s, map %s, meshes %s, textures %s, accelerator %s%s\n",
            megabytes(c[0], m.peak), megabytes(c[1], m.film), megabytes(c[2], m.map), megabytes(c[3], m.meshes),
            megabytes(c[5], m.textures), megabytes(c[4], m.accel),
            m.guessed ? "; a file does not tell its size: guessed by its length" : "");
}

/* No memory: a plan without what is built. */
static void print_needs(const bis_scene_desc *desc, FILE *out)
{
    bis_scene_needs needs;

    if (!bis_scene_needs_of(&needs, desc, NULL)) {
        print_drawing(desc, &needs, out);
        print_geometry(desc, &needs, out);
        print_lobes(desc, &needs, out);
        print_textures(desc, &needs, out);
        print_accel(desc, &needs, out);
    }
    bis_scene_needs_clear(&needs);
}

void bis_scene_plan(const bis_scene_desc *desc, FILE *out)
{
    print_approximations(desc, out);
    print_view(desc, out);
    print_integrators(desc, out);
    print_light(desc, out);
    print_needs(desc, out);
    print_tiles(desc, out);
    print_film(desc, out);
    print_memory(desc, out);
}
