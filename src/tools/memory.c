/* SPDX-License-Identifier: BSD-2-Clause */
/* memory: bytes a pixel, a texel and a triangle, for what scene_needs.h says that is built.
 *
 * Sizes of arrays follow from their types. The program itself, what a table takes beside its arrays, and an accelerator
 * are measured (tests/tools/test_memory.c holds all to 15 %); how long a line of a text file is, is guessed. */
#include "memory.h"

#include "base/text.h"

#include "bis/base/mem.h"
#include "bis/beyond/visibility.h"
#include "bis/render/render.h"
#include "bis/thesis/regions.h"
#include "scene/distant.h"
#include "scene/scene_needs.h"
#include "scene/scene_peek.h"

#include <math.h>

/* the program alone: `time -f %M bis` takes 12e6 for a sphere of 1 x 1 pixel with 2 threads, and more with more */
static const double program = 14e6;
/* a pixel: its sums; the pass under way, with the kind of its edge */
static const double film_sums = BIS_FILM_BYTES, pass = BIS_PASS_BYTES + 1.0 / 4;
static const double layer_sum = BIS_LAYER_SUM_BYTES, layer_pass = BIS_LAYER_PASS_BYTES; /* a pixel's value */
static const double chunk_rows = 16, chunk_copies = 3; /* of an EXR: packed, its bytes in another order, compressed */
/* of learned visibility, a pixel: what is known and what is counted, in cells up to 2^23 pixels, else in tiles */
static const double tiles = 2.0 * sizeof(bis_seen) / (BIS_RENDER_TILE * BIS_RENDER_TILE);
static const double cells = 2.0 * sizeof(bis_seen) * BIS_VISIBILITY_CELLS / (BIS_RENDER_TILE * BIS_RENDER_TILE);
/* and of the full picture's, in squares of tiles (src/render/survey.c), a third as many as tiles */
static const double squares = (2.0 * sizeof(bis_seen) + sizeof(bis_square)) / 3 / (BIS_RENDER_TILE * BIS_RENDER_TILE);
/* a texel of the map: radiance; table: 0.4 more than its arrays (--stats); curve: its tiles are 4 x 4 texels */
static const double texel = sizeof(rgb), table = BIS_TABLE_BYTES + 0.4, curve = BIS_CURVE_BYTES / 16.0,
                    curve_beside = BIS_CURVE_SUM_BYTES / 16.0, area = BIS_AREA_BYTES, regions = BIS_REGIONS_BYTES;
static const double vertex = sizeof(vec3), uv = sizeof(bis_uv), triangle = 3 * sizeof(uint32_t);
/* a triangle, measured: Embree 3.13 and the grid, 10^6 and 10^7 triangles; both take as much. Embree keeps
 * less of many (BIS_EMBREE_COMPACT) */
static const double accel_kept = 82, accel_built = 100, compact_kept = 35, compact_built = 40;
static const double obj_triangle = 50, obj_vertex = 100; /* bytes of a text file for each of them, guessed */

typedef struct counts {
    double vertices, triangles;
} counts;

static counts counts_of(const bis_mesh_desc *m, bool *guessed)
{
    long vertices, faces;
    const counts c = {(double)m->size.vertices, (double)m->size.triangles};

    if (!m->filename) return c;
    if (m->kind == BIS_SHAPE_PLY && bis_scene_peek_ply(m->filename, &vertices, &faces))
        return (counts){(double)vertices, (double)faces};
    const double bytes = (double)bis_scene_peek_bytes(m->filename);
    *guessed = true;
    return (counts){bytes / obj_vertex, bytes / obj_triangle};
}

/* Each shape has vertices and triangles of its own; a mesh of several shapes is kept until the last one has them. */
static double add_meshes(bis_memory *m, const bis_scene_desc *d, const bis_scene_needs *needs)
{
    const size_t *uses = needs->uses;
    double triangles = 0, kept = 0;
    bool has_uv = false; /* of one mesh, then of all */

    for (size_t i = 0; i < d->n_meshes; i++) has_uv |= needs->with_uv[i];
    for (size_t i = 0; i < d->n_meshes; i++) {
        if (!uses[i]) continue;
        const counts c = counts_of(&d->meshes[i], &m->guessed);
        const double a_vertex = vertex * (d->meshes[i].smooth ? 2 : 1) + (has_uv ? uv : 0);
        const double bytes = c.vertices * a_vertex + c.triangles * triangle;
        m->meshes += bytes * (double)uses[i];
        triangles += c.triangles * (double)uses[i];
        if (uses[i] > 1 && bytes > kept) kept = bytes;
    }
    m->meshes += kept;
    return triangles;
}

static void add_textures(bis_memory *m, const bis_scene_desc *d, const bis_scene_needs *needs)
{
    long w, h;

    for (size_t i = 0; i < d->textures.n_files; i++) {
        if (!needs->images[i]) continue;
        if (bis_scene_peek_image(d->textures.files[i].filename, &w, &h)) m->textures += texel * (double)w * (double)h;
        else m->guessed = true;
    }
}

/* Returns what the film takes while it is written: the picture is in the place of the pass and of what was learned, and
 * each thread has a chunk of it. */
static double add_film(bis_memory *m, const bis_scene_desc *d)
{
    const bis_film f = bis_film_place(d->view.film.width, d->view.film.height, d->view.film.crop, 1);
    const double pixels = (double)f.width * f.height, all = (double)f.full_width * f.full_height;
    int n = 0;

    for (int i = 0; i < BIS_N_LAYERS; i++)
        if (d->view.film.layers >> i & 1) n += bis_layer_values((bis_layer)i);
    const double learned =
        bis_scene_learns(d) ? pixels * (all > BIS_VISIBILITY_LARGE ? tiles : cells) + all * squares : 0;
    m->film = pixels * (film_sums + pass + n * (layer_sum + layer_pass)) + learned;

    const double pixel = (double)sizeof(float) * (4 + n); /* R, G, B, A and the layers */
    const double threads = bis_render_threads(&(bis_render_options){0});
    const double chunks = fmin(threads, ceil(f.height / chunk_rows));
    return pixels * (film_sums + n * layer_sum + pixel) + chunks * chunk_copies * chunk_rows * f.width * pixel;
}

bool bis_memory_map_size(const bis_light_desc *light, long *width, long *height, bis_mapping *mapping)
{
    *mapping = light->mapping;
    if (!light->filename && light->n_distants) {
        *width = BIS_DISTANT_WIDTH;
        *height = BIS_DISTANT_WIDTH / 2;
        return true;
    }
    if (!light->filename || !bis_scene_peek_image(light->filename, width, height)) return false;
    *mapping = bis_light_mapping(light, *width, *height);
    if (*mapping == BIS_MAPPING_LATLONG) return true;
    if (*width > BIS_IMAGE_MAX_SIDE || *height > BIS_IMAGE_MAX_SIDE ||
        !bis_mapping_fits(*mapping, (int)*width, (int)*height))
        return false;
    *width = bis_mapping_width(*mapping, (int)*width, (int)*height, light->width);
    *height = *width / 2;
    return true;
}

/* Returns what stands beside it at worst: the file while it is read, the regions while areas are found,
 * or the sums of tiles while the curve is made. */
static double add_map(bis_memory *m, const bis_scene_desc *d, const bis_scene_needs *needs)
{
    bis_mapping mapping;
    long w, h;

    if (!bis_light_desc_has_map(&d->light)) return 0;
    if (!bis_memory_map_size(&d->light, &w, &h, &mapping)) {
        m->guessed = true;
        w = (long)(bis_scene_peek_bytes(d->light.filename) / 4);
        h = 1;
    }
    const double texels = (double)w * (double)h;
    const bool has_table = needs->light & BIS_NEED_TABLE, has_curve = needs->light & BIS_NEED_CURVE;
    const bool has_area = (has_table || has_curve) && d->light.area_exponent > 0;
    m->map = texels * (texel + (has_table ? table : 0) + (has_curve ? curve : 0) + (has_area ? area : 0));
    const double file = d->light.filename ? (double)bis_scene_peek_bytes(d->light.filename) : 0;
    const double while_read = texels * texel + file - m->map;
    const double with_regions = has_area ? texels * (texel + regions) - m->map : 0;
    return fmax(fmax(with_regions, has_curve ? texels * curve_beside : 0), while_read);
}

bis_status bis_memory_foresee(bis_memory *m, const bis_scene_desc *desc, bis_diag *diag)
{
    bis_scene_needs needs;
    const bis_status status = bis_scene_needs_of(&needs, desc, diag);

    *m = (bis_memory){0};
    if (status) goto done;
    const double triangles = add_meshes(m, desc, &needs), beside = add_map(m, desc, &needs);
    const double written = add_film(m, desc);
    add_textures(m, desc, &needs);
    const bool compact = needs.embree && triangles >= BIS_EMBREE_COMPACT;
    const double built = triangles * (compact ? compact_built : accel_built);
    m->accel = triangles * (compact ? compact_kept : accel_kept);
    /* the film is zeros of the system, which take nothing, until the first pass */
    const double kept = program + m->meshes + m->textures + m->map;
    m->before = kept + fmax(beside, built);
    m->peak = fmax(m->before, kept + m->accel + fmax(m->film, written));
    m->merged = program + written;
done:
    bis_scene_needs_clear(&needs);
    return status;
}

/* Adds a way, if it takes less. */
static void add_way(char *text, const bis_memory *m, double peak, const char *way, const char *also)
{
    if (peak < 0.99 * m->peak)
        bis_append(text, BIS_MEMORY_ADVICE, "%s%s (%.1f GB%s)", *text ? ", " : "", way, peak / 1e9, also);
}

static bis_status add_change(char *text, const bis_memory *m, const bis_scene_desc *changed, const char *way,
                             bis_diag *diag)
{
    bis_memory other;
    const bis_status status = bis_memory_foresee(&other, changed, diag);
    if (!status) add_way(text, m, other.peak, way, "");
    return status;
}

/* The first row of 2, 4, 8, ... that fits, or of 64. */
static bis_status add_crop(char *text, const bis_memory *m, const bis_scene_desc *desc, double room, bis_diag *diag)
{
    bis_scene_desc d = *desc;
    double *c = d.view.film.crop;
    bis_memory row = *m;
    char way[96];

    for (int n = 2; n <= 64 && row.peak > room; n *= 2) {
        c[3] = c[2] + (desc->view.film.crop[3] - c[2]) / n;
        const bis_status status = bis_memory_foresee(&row, &d, diag);
        if (status) return status;
    }
    snprintf(way, sizeof way, "crops, as --cropwindow %g,%g,%g,%g", c[0], c[1], c[2], c[3]);
    add_way(text, m, row.peak, way, "");
    return BIS_OK;
}

/* The first of 16, 32, ... parts that fits, or of 1024. A part touches pages of memory that it shares with others, so
 * it takes more than its share: measured for 4 to 256 parts of 4096 x 4096 pixels. */
static void add_parts(char *text, const bis_memory *m, double room)
{
    const double others = m->peak - m->film;
    double peak;
    char way[64], also[64];
    int n = 8;

    do {
        n *= 2;
        peak = fmax(m->before, others + m->film * fmin(1, 8.0 / n + 0.06));
    } while (n < 1024 && peak > room);
    snprintf(way, sizeof way, "%d parts, as --part 1/%d", n, n);
    snprintf(also, sizeof also, "; bis merge takes %.1f GB", m->merged / 1e9);
    add_way(text, m, peak, way, also);
}

bis_status bis_memory_advise(char text[BIS_MEMORY_ADVICE], const bis_memory *m, const bis_scene_desc *desc,
                             double room, bis_diag *diag)
{
    bis_scene_desc layers = *desc, learn = *desc, embree = *desc;

    *text = '\0';
    layers.view.film.layers = 0;
    learn.view.settings.learn = false;
    if (bis_accel_embree_version()) embree.accel.kind = BIS_ACCEL_EMBREE;
    bis_status status = add_change(text, m, &layers, "--layers none", diag);
    if (!status) status = add_change(text, m, &learn, "--learn off", diag);
    if (!status) status = add_change(text, m, &embree, "--accelerator embree", diag);
    if (!status) status = add_crop(text, m, desc, room, diag);
    if (!status) add_parts(text, m, room);
    return status;
}

/* "MemAvailable: 23897572 kB". */
double bis_memory_free(void)
{
    char line[256];
    double kilobytes = 0;
    FILE *in = fopen("/proc/meminfo", "r");

    if (!in) return 0;
    while (fgets(line, sizeof line, in) && sscanf(line, "MemAvailable: %lf kB", &kilobytes) != 1) continue;
    fclose(in);
    return kilobytes * 1024;
}
