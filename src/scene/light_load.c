/* SPDX-License-Identifier: BSD-2-Clause */
/* light_load: from a scene's description to a light: which mapping the file has, what is wrong with its values, what
 * the description multiplies it by. The light itself (thesis 3.1) knows pixels and a frame, no files. */
#include "bis/scene/light_load.h"

#include "base/text.h"
#include "bis/base/clock.h"
#include "bis/files/image_file.h"
#include "distant.h"
#include "light_fields.h"

#include <stdio.h>
#include <string.h>

const bis_field bis_light_fields[] = {
    BIS_FIELD(bis_light_desc, L, float), BIS_FIELD(bis_light_desc, scale, double),
    BIS_FIELD(bis_light_desc, mapping, bis_mapping), BIS_FIELD(bis_light_desc, width, int),
    BIS_FIELD(bis_light_desc, area_exponent, double), BIS_FIELD(bis_light_desc, levels, int),
    BIS_FIELD(bis_light_desc, has_table_kind, bool), BIS_FIELD(bis_light_desc, table_kind, bis_table_kind),
    BIS_FIELD(bis_light_desc, visible, bool), BIS_FIELD(bis_light_desc, is_smooth, bool),
    BIS_FIELD(bis_light_desc, to_world, double), BIS_FIELD(bis_light_desc, portals, double),
    BIS_FIELD(bis_light_desc, n_portals, uint32_t), BIS_FIELD(bis_light_desc, windows, bool), BIS_FIELDS_END};

/* One warning for all bad values of a map (E7). */
static void warn_defects(const bis_envmap_defects *d, const char *filename, bis_loc at, bis_diag *diag)
{
    const size_t counts[] = {d->n_nan, d->n_infinite, d->n_negative};
    const char *const kinds[] = {"NaN", "infinite", "negative"};
    char list[128] = "", share[BIS_PERCENT];
    size_t used = 0;
    for (int i = 0; i < 3; i++) {
        if (counts[i] == 0) continue;
        used += (size_t)snprintf(list + used, sizeof list - used, "%s%zu %s", used ? ", " : "", counts[i], kinds[i]);
    }
    if (used == 0) return;
    bis_warn(
        diag, at,
        "\"%s\": bad channel values set to 0: %s; the first is %c of pixel (%d, %d); they cover %s of the sphere",
        filename, list, d->first_channel, d->first_x, d->first_y,
        bis_percent(share, d->solid_angle / (4 * PI)));
}

bis_status bis_light_check_size(const bis_light_desc *desc, int width, int height, bis_diag *diag)
{
    const bis_mapping mapping = bis_light_mapping(desc, width, height);
    if (!bis_mapping_fits(mapping, width, height))
        return bis_error(diag, BIS_INPUT, desc->loc,
                         "\"%s\" is %d x %d; a map of mapping \"%s\" must be %s (\"latlong\" maps are 2:1)",
                         desc->filename, width, height, bis_mapping_names[mapping], bis_mapping_shape(mapping));
    if (mapping != desc->mapping)
        bis_warn(diag, desc->loc,
                 "\"%s\" is square, %d x %d, and named by \"filename\": it is taken for an equal-area map, as in "
                 "pbrt-v4; \"string mapping\" says otherwise (\"angular\" for a light probe), or bis envmap "
                 "--mapping angular --to latlong makes a map that needs no word",
                 desc->filename, width, height);
    else if (width == height && !desc->has_mapping)
        return bis_error(diag, BIS_INPUT, desc->loc,
                         "\"%s\" is square, %d x %d: give its mapping, \"angular\" for a light probe, \"equalarea\" "
                         "for a map of pbrt-v4, \"mirrorball\", or \"latlong\" if that is meant",
                         desc->filename, width, height);
    if (height > width && !desc->has_mapping)
        bis_warn(diag, desc->loc,
                 "\"%s\" is %d x %d, higher than wide, and is taken for a lat-long map all the same: each of its rows "
                 "goes all the way round. Give its mapping, as \"verticalcross\", or \"latlong\" if that is meant (%s)",
                 desc->filename, width, height, desc->loc.line ? "string mapping" : "--light-mapping");
    return BIS_OK;
}

static bis_status make_envmap(bis_envmap *em, bis_image *image, const bis_light_desc *desc, bis_diag *diag)
{
    const bis_mapping mapping = bis_light_mapping(desc, image->width, image->height);
    const bis_status status = bis_light_check_size(desc, image->width, image->height, diag);
    return status ? status : bis_envmap_from_mapping(em, image, mapping, desc->width, diag);
}

/* What a message calls the map. */
static const char *name_of(const bis_light_desc *desc)
{
    return desc->filename ? desc->filename : "the distant lights";
}

static bis_status add_distants(bis_envmap *em, const bis_light_desc *desc, bis_diag *diag)
{
    for (size_t i = 0; i < desc->n_distants; i++)
        if (!bis_distant_add(em, &desc->distants[i]))
            return bis_error(diag, BIS_INPUT, desc->loc,
                             "a distant light exceeds the largest float as a disc of half a degree: give it a "
                             "smaller \"L\"");
    return BIS_OK;
}

/* A map of radiance 1, for distant lights without one. */
static bis_status make_white(bis_image *image, bis_diag *diag)
{
    const bis_status status = bis_image_init(image, BIS_DISTANT_WIDTH, BIS_DISTANT_WIDTH / 2, diag);
    for (size_t i = 0; !status && i < (size_t)image->width * (size_t)image->height; i++)
        image->pixels[i] = (rgb){1, 1, 1};
    return status;
}

/* pbrt-v4 takes, of a map, half of what it sheds onto a surface that faces up (2 pi / N in src/pbrt/lights.cpp, where a
 * pixel has 4 pi / N), so that its light is twice as bright as asked; of a constant light, pi. */
static double illuminance_of(const bis_envmap *em)
{
    double sum = 0;

    if (!em) return PI;
    for (int j = 0; j < em->height && em->cos_edge[j] > 0; j++) {
        const double below = fmax(em->cos_edge[j + 1], 0);
        const double cosine = PI / em->width * (em->cos_edge[j] * em->cos_edge[j] - below * below);
        for (int i = 0; i < em->width; i++) {
            const rgb c = em->pixels[(size_t)j * (size_t)em->width + (size_t)i];
            sum += cosine * (0.2126 * (double)c.r + 0.7152 * (double)c.g + 0.0722 * (double)c.b);
        }
    }
    return sum / 2;
}

/* L times scale, and what makes of it the illuminance that is asked for. em: NULL: of a constant light. */
static rgb factor_of(const bis_light_desc *desc, const bis_envmap *em)
{
    return rgb_scale(desc->L, desc->scale * (desc->illuminance > 0 ? desc->illuminance / illuminance_of(em) : 1));
}

/* The factor is checked by itself, too: L and scale may overflow where every pixel is 0. */
static bis_status scale_envmap(bis_envmap *em, const bis_light_desc *desc, bis_diag *diag)
{
    const bis_envmap *of = desc->filename ? em : NULL; /* else it is the white of distant lights */
    if (desc->illuminance > 0 && !(illuminance_of(of) > 0))
        return bis_error(diag, BIS_INPUT, desc->loc, "\"%s\" is black above, so that no factor gives its "
                         "\"illuminance\"", name_of(desc));
    const rgb scale = factor_of(desc, of);
    if (rgb_is_finite(scale) && !bis_envmap_scale(em, scale, NULL)) return BIS_OK;
    return bis_error(diag, BIS_INPUT, desc->loc,
                     "\"%s\" times \"L\" (%g %g %g) and \"scale\" %g exceeds the largest float; choose a smaller scale",
                     name_of(desc), (double)desc->L.r, (double)desc->L.g, (double)desc->L.b, desc->scale);
}

static bis_status new_constant(bis_light **out, const bis_light_desc *desc, bis_diag *diag)
{
    const rgb L = factor_of(desc, NULL);
    if (rgb_is_finite(L)) return bis_light_constant(out, L, diag);
    return bis_error(diag, BIS_INPUT, desc->loc,
                     "\"L\" (%g %g %g) times \"scale\" %g exceeds the largest float; choose a smaller scale",
                     (double)desc->L.r, (double)desc->L.g, (double)desc->L.b, desc->scale);
}

bis_status bis_light_from_envmap(bis_light **out, bis_envmap *em, const bis_light_desc *desc, unsigned needs,
                                 bis_diag *diag)
{
    const bool draws = needs & (BIS_NEED_TABLE | BIS_NEED_CURVE);
    const bis_importance_options importance = {
        .table = needs & BIS_NEED_TABLE,
        .curve = needs & BIS_NEED_CURVE,
        .table_kind = desc->table_kind,
        .area_exponent = desc->area_exponent,
        .levels = desc->levels,
        .compensate = needs & BIS_NEED_COMPENSATED,
        .as_printed = desc->as_printed,
    };

    *out = NULL;
    /* the tables hold solid angles, which only a rotation or a reflection keeps */
    if (bis_xform_is_orthonormal(&desc->to_world, BIS_XFORM_FRAME_TOLERANCE)) {
        return bis_light_new(out, em, &desc->to_world, draws ? &importance : NULL, diag);
    }
    bis_envmap_clear(em);
    return bis_error(
        diag, BIS_INPUT, desc->loc,
        "the current transformation stretches or shears the environment light (by more than %g); it must be a "
        "rotation or a reflection: put LightSource before any Scale, or between AttributeBegin and AttributeEnd",
        BIS_XFORM_FRAME_TOLERANCE);
}

bis_status bis_light_from_image(bis_light **out, bis_image *image, const bis_light_desc *desc, unsigned needs,
                                bis_diag *diag)
{
    const bis_loc at = desc->loc.file ? desc->loc : (bis_loc){desc->filename, 0, 0};
    bis_envmap em = {0};

    *out = NULL;
    bis_status status = make_envmap(&em, image, desc, diag);
    bis_image_clear(image); /* of a resampled map; the pixels of a lat-long have moved */
    if (status) return status;
    warn_defects(&em.defects, desc->filename, at, diag);
    status = scale_envmap(&em, desc, diag);
    /* after the scale, which is the map's alone */
    if (!status) status = add_distants(&em, desc, diag);
    if (!status) status = bis_light_from_envmap(out, &em, desc, needs, diag);
    bis_envmap_clear(&em);
    if (status) return status;
    if (bis_light_is_black(*out))
        bis_warn(diag, at, "\"%s\" gives no light: none of its pixels is positive", name_of(desc));
    return BIS_OK;
}

/* ---- what the camera sees ---- */

/* Columns go round; beyond a pole a row goes on half a turn away. */
static rgb pixel_at(const bis_envmap *em, long x, long y)
{
    const long width = em->width, height = em->height;
    if (y < 0 || y >= height) {
        x += width / 2;
        y = y < 0 ? 0 : height - 1;
    }
    return em->pixels[(size_t)y * (size_t)width + (size_t)(((x % width) + width) % width)];
}

/* Between the centres of four pixels, as pbrt looks up its maps. Only for what the camera sees: an integrator's map has
 * pixels of constant radiance. */
static rgb smooth_Le(const bis_light *light, vec3 d)
{
    const bis_envmap *em = bis_light_envmap(light);
    vec3 axis[3];

    bis_light_axes(light, axis);
    const double x = (double)dot(d, axis[0]), y = (double)dot(d, axis[1]), z = (double)dot(d, axis[2]);
    const double column = atan2(y, x) / (2 * PI) * em->width - 0.5;
    const double row = atan2(hypot(x, y), z) / PI * em->height - 0.5;
    const long i = (long)floor(column), j = (long)floor(row);
    const double s = column - (double)i, t = row - (double)j;
    const rgb above = rgb_add(rgb_scale(pixel_at(em, i, j), 1 - s), rgb_scale(pixel_at(em, i + 1, j), s));
    const rgb below = rgb_add(rgb_scale(pixel_at(em, i, j + 1), 1 - s),
                              rgb_scale(pixel_at(em, i + 1, j + 1), s));
    return rgb_add(rgb_scale(above, 1 - t), rgb_scale(below, t));
}

rgb bis_light_seen(const bis_light_desc *desc, const bis_light *light, vec3 d)
{
    if (!desc->visible) return (rgb){0, 0, 0};
    return desc->is_smooth && !bis_light_is_constant(light) ? smooth_Le(light, d) : bis_light_Le(light, d);
}

/* ---- from a description ---- */

bis_light_desc bis_light_desc_default(void)
{
    return (bis_light_desc){.L = {1, 1, 1}, .scale = 1, .area_exponent = BIS_AREA_EXPONENT, .levels = BIS_LEVELS,
                            .visible = true, .windows = true, .to_world = bis_xform_identity()};
}

bis_table_kind bis_light_table_kind(const bis_light_desc *desc, unsigned needs, bis_sampler_kind sampler)
{
    if (desc->has_table_kind) return desc->table_kind;
    return needs & BIS_NEED_SPREAD && bis_sampler_is_low_discrepancy(sampler) ? BIS_TABLE_CDF : BIS_TABLE_ALIAS;
}

static bis_status copy_image(bis_image *image, const bis_image *of, bis_diag *diag)
{
    const bis_status status = bis_image_init(image, of->width, of->height, diag);
    if (!status)
        memcpy(image->pixels, of->pixels, (size_t)of->width * (size_t)of->height * sizeof *of->pixels);
    return status;
}

void bis_light_take_layout(bis_light_desc *desc, bool is_cube_strip)
{
    if (!is_cube_strip || desc->has_mapping) return;
    desc->mapping = BIS_MAPPING_CUBE_STRIP;
    desc->has_mapping = true;
}

bis_status bis_light_load(bis_light **out, const bis_light_desc *desc, unsigned needs, double seconds[2],
                          bis_diag *diag)
{
    const double start = bis_clock_now();
    bis_light_desc d = *desc;
    bis_image image = {0};
    bool is_strip = false;

    *out = NULL;
    bis_status status = desc->image        ? copy_image(&image, desc->image, diag)
                        : desc->filename   ? bis_image_read_map(&image, &is_strip, desc->filename, desc->loc, diag)
                        : desc->n_distants ? make_white(&image, diag)
                                           : BIS_OK;
    const double read = bis_clock_now();
    bis_light_take_layout(&d, is_strip);
    if (!status) {
        status = bis_light_desc_has_map(desc) ? bis_light_from_image(out, &image, &d, needs, diag)
                                              : new_constant(out, desc, diag);
    }
    if (!status) bis_light_set_portals(*out, desc->portals, desc->n_portals);
    if (seconds) {
        seconds[0] = read - start;
        seconds[1] = bis_clock_now() - read;
    }
    return status;
}
