/* SPDX-License-Identifier: BSD-2-Clause */
/* flat_map: maps opened by settings, and what is known of them. */
#include "bis/flat/map.h"

#include "bis/base/file.h"
#include "bis/beyond/mapping.h"
#include "bis/scene/light_load.h"
#include "bis/thesis/importance.h"
#include "bis/thesis/regions.h"
#include "flat/say.h"

#include <inttypes.h>
#include <string.h>

static const bis_loc nowhere = {0};

/* ---- settings ---- */

typedef struct number {
    double value;
    bool is_number, is_whole;
} number;

static number number_of(const char *text)
{
    const char *end;
    const double v = bis_parse_double(text, &end);
    const bool is_number = end != text && !*end;
    return (number){v, is_number, is_number && v == floor(v)};
}

/* How a map is described: what bis_flat_light_describe takes, and the rest. */
typedef struct asked {
    const char *kind, *mapping;
    double area_exponent;
    int levels, width;
    unsigned as_printed;
} asked;

static bis_status take(asked *s, const char *setting, bis_diag *diag)
{
    const size_t n = strcspn(setting, "=");
    const char *text = setting[n] ? setting + n + 1 : "";
    const number v = number_of(text);

    if (strncmp(setting, "kind=", 5) == 0) s->kind = text;
    else if (strncmp(setting, "mapping=", 8) == 0) s->mapping = text;
    else if (strncmp(setting, "area_exponent=", 14) == 0 && v.is_number) s->area_exponent = v.value;
    else if (strncmp(setting, "levels=", 7) == 0 && v.is_whole && v.value >= 1 && v.value <= BIS_LEVELS_MAX)
        s->levels = (int)v.value;
    else if (strncmp(setting, "width=", 6) == 0 && v.is_whole && v.value >= 1 && v.value <= 2 * BIS_IMAGE_MAX_SIDE)
        s->width = (int)v.value;
    else if (strncmp(setting, "as_printed=", 11) == 0 && bis_erratum_find(text))
        s->as_printed |= bis_erratum_find(text)->flag;
    else
        return bis_error(diag, BIS_INPUT, nowhere,
                         "\"%.60s\" is no setting of a map: give kind=alias or cdf, area_exponent=0 to %g, levels=1 "
                         "to %d, mapping=latlong or another, width=1 to %d, as_printed=E3", setting,
                         BIS_AREA_EXPONENT_MAX, BIS_LEVELS_MAX, 2 * BIS_IMAGE_MAX_SIDE);
    return BIS_OK;
}

static bis_status describe(bis_light_desc *desc, const char *name, const char *const *list, bis_diag *diag)
{
    asked s = {.kind = NULL, .area_exponent = BIS_AREA_EXPONENT, .levels = BIS_LEVELS};
    bis_status status = BIS_OK;

    for (size_t i = 0; !status && list[i]; i++) status = take(&s, list[i], diag);
    if (!status)
        status = bis_flat_light_describe(desc, name, s.kind ? s.kind : "alias", s.area_exponent, s.mapping, diag);
    if (status) return status;
    desc->loc = (bis_loc){name, 0, 0};
    desc->has_table_kind = s.kind != NULL;
    desc->levels = s.levels;
    desc->width = s.width;
    desc->as_printed = s.as_printed;
    return BIS_OK;
}

int bis_flat_light_open_as(bis_light **light, const char *path, const char *const *settings, char *say, size_t size)
{
    bis_diag diag = {0};
    bis_light_desc desc;
    bis_status status = BIS_FLAT_GIVEN(&diag, light, path, settings);

    if (light) *light = NULL;
    if (!status) status = describe(&desc, path, settings, &diag);
    if (!status) status = bis_light_load(light, &desc, BIS_NEED_TABLE, NULL, &diag);
    return bis_flat_end(status, &diag, say, size);
}

int bis_flat_light_make_as(bis_light **light, int width, int height, const float *pixels, const char *const *settings,
                           char *say, size_t size)
{
    bis_diag diag = {0};
    bis_light_desc desc;
    bis_image image = {0};
    bis_status status = BIS_FLAT_GIVEN(&diag, light, pixels, settings);

    if (light) *light = NULL;
    if (!status) status = describe(&desc, "the array", settings, &diag);
    if (!status) status = bis_image_init(&image, width, height, &diag);
    if (status) return bis_flat_end(status, &diag, say, size);
    for (size_t i = 0; i < (size_t)width * (size_t)height; i++)
        image.pixels[i] = (rgb){pixels[3 * i], pixels[3 * i + 1], pixels[3 * i + 2]};
    status = bis_light_from_image(light, &image, &desc, BIS_NEED_TABLE, &diag);
    return bis_flat_end(status, &diag, say, size);
}

/* ---- what is known ---- */

const char *bis_flat_light_source(const bis_light *light)
{
    const char *from = light ? bis_light_envmap(light)->resampled_from : NULL;
    return !light ? NULL : from ? from : bis_mapping_names[BIS_MAPPING_LATLONG];
}

void bis_flat_light_facts(const bis_light *light, double *facts)
{
    if (!light || !facts) return;
    const bis_envmap *em = bis_light_envmap(light);
    const bis_envmap_defects *bad = &em->defects;
    const double all[] = {em->power_before, em->power_after, (double)bad->n_nan, (double)bad->n_infinite,
                          (double)bad->n_negative, bad->solid_angle,
                          (double)bis_importance_bytes(bis_light_importance(light))};

    memcpy(facts, all, sizeof all);
}

void bis_flat_light_angles(const bis_light *light, double *angles)
{
    if (!light || !angles) return;
    const bis_envmap *em = bis_light_envmap(light);
    memcpy(angles, em->row_solid_angle, (size_t)em->height * sizeof *angles);
}

int bis_flat_light_centres(const bis_light *light, size_t n, const uint32_t *pixel, float *w, char *say, size_t size)
{
    bis_diag diag = {0};
    bis_status status = BIS_FLAT_GIVEN(&diag, light);

    if (!status && n > 0) status = BIS_FLAT_GIVEN(&diag, pixel, w);
    if (status) return bis_flat_end(status, &diag, say, size);
    const bis_envmap *em = bis_light_envmap(light);
    const size_t width = (size_t)em->width, pixels = width * (size_t)em->height;
    for (size_t i = 0; !status && i < n; i++) {
        if (pixel[i] >= pixels) {
            status = bis_error(&diag, BIS_INPUT, nowhere, "pixel %zu is %" PRIu32 ", not below %zu", i, pixel[i],
                               pixels);
            break;
        }
        const vec3 d = bis_envmap_direction(em, (int)(pixel[i] % width), (int)(pixel[i] / width), 0.5, 0.5);
        w[3 * i] = d.x;
        w[3 * i + 1] = d.y;
        w[3 * i + 2] = d.z;
    }
    return bis_flat_end(status, &diag, say, size);
}

int bis_flat_light_draw(const bis_light *light, size_t n, const double *u, uint32_t *pixel, char *say, size_t size)
{
    bis_diag diag = {0};
    bis_status status = BIS_FLAT_GIVEN(&diag, light);

    if (!status && n > 0) status = BIS_FLAT_GIVEN(&diag, u, pixel);
    if (!status) status = bis_flat_check_numbers(n, 4, u, &diag);
    for (size_t i = 0; !status && i < n; i++) {
        bis_map_sample s;
        if (bis_importance_sample(bis_light_importance(light), u + 4 * i, &s)) pixel[i] = (uint32_t)s.pixel;
        else status = bis_error(&diag, BIS_INPUT, nowhere, "the map is black: it has no directions to draw");
    }
    return bis_flat_end(status, &diag, say, size);
}
