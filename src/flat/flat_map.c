/* SPDX-License-Identifier: BSD-2-Clause */
/* flat_map: maps: opened, looked at, drawn from, and what is known of them (thesis 3.3, 3.4). */
#include "bis/flat/map.h"

#include "bis/base/file.h"
#include "bis/beyond/mapping.h"
#include "bis/thesis/importance.h"
#include "bis/thesis/regions.h"
#include "flat/face.h"

#include <inttypes.h>
#include <string.h>

/* ---- opening ---- */

/* A map that is asked for: its description, and its pixels; NULL: the file that the description names. */
typedef struct asked {
    bis_light_desc desc;
    int width, height;
    const float *pixels;
} asked;

static asked asked_for(const char *name, int width, int height, const float *pixels)
{
    asked a = {bis_light_desc_default(), width, height, pixels};
    a.desc.filename = (char *)(uintptr_t)name; /* only read */
    return a;
}

static bis_status set_kind(bis_light_desc *desc, const char *kind, bis_diag *diag)
{
    const bool is_cdf = strcmp(kind, "cdf") == 0;

    desc->has_table_kind = true;
    desc->table_kind = is_cdf ? BIS_TABLE_CDF : BIS_TABLE_ALIAS;
    if (is_cdf || strcmp(kind, "alias") == 0) return BIS_OK;
    return bis_flat_refuse(diag, "there is no table \"%.40s\": give \"alias\" or \"cdf\"", kind);
}

static bis_status set_area_exponent(bis_light_desc *desc, double b, bis_diag *diag)
{
    desc->area_exponent = b;
    if (b >= 0 && b <= BIS_AREA_EXPONENT_MAX) return BIS_OK;
    return bis_flat_refuse(diag, "area_exponent is %g: give a number in [0, %g]", b, BIS_AREA_EXPONENT_MAX);
}

bis_status bis_flat_no_mapping(bis_diag *diag, const char *mapping)
{
    return bis_flat_refuse(diag, "there is no mapping \"%.40s\": give latlong, angular, equalarea, mirrorball, "
                           "verticalcross, horizontalcross or cubestrip", mapping);
}

static bis_status set_mapping(bis_light_desc *desc, const char *mapping, bis_diag *diag)
{
    desc->has_mapping = true;
    desc->mapping = bis_mapping_find(mapping);
    if (desc->mapping != BIS_N_MAPPINGS) return BIS_OK;
    return bis_flat_no_mapping(diag, mapping);
}

static bis_status set(bis_light_desc *desc, const char *setting, bis_diag *diag)
{
    const size_t n = strcspn(setting, "=");
    const char *text = setting[n] ? setting + n + 1 : "", *end;
    const double v = bis_parse_double(text, &end);
    const bool is_number = end != text && !*end, is_count = is_number && v == floor(v) && v >= 1;

    if (strncmp(setting, "kind=", 5) == 0) return set_kind(desc, text, diag);
    if (strncmp(setting, "mapping=", 8) == 0) return set_mapping(desc, text, diag);
    if (strncmp(setting, "area_exponent=", 14) == 0 && is_number) return set_area_exponent(desc, v, diag);
    if (strncmp(setting, "levels=", 7) == 0 && is_count && v <= BIS_LEVELS_MAX) desc->levels = (int)v;
    else if (strncmp(setting, "width=", 6) == 0 && is_count && v <= 2 * BIS_IMAGE_MAX_SIDE) desc->width = (int)v;
    else if (strncmp(setting, "as_printed=", 11) == 0 && bis_erratum_find(text))
        desc->as_printed |= bis_erratum_find(text)->flag;
    else
        return bis_flat_refuse(diag, "\"%.60s\" is no setting of a map: give kind=alias or cdf, area_exponent=0 to %g, "
                               "levels=1 to %d, mapping=latlong or another, width=1 to %d, as_printed=E3", setting,
                               BIS_AREA_EXPONENT_MAX, BIS_LEVELS_MAX, 2 * BIS_IMAGE_MAX_SIDE);
    return BIS_OK;
}

static bis_status open_light(bis_light **light, const asked *a, bis_diag *diag)
{
    bis_image image = {0};

    if (!a->pixels) return bis_light_load(light, &a->desc, BIS_NEED_TABLE, NULL, diag);
    const bis_status status = bis_flat_image_of(&image, a->width, a->height, 3, a->pixels, diag);
    return status ? status : bis_light_from_image(light, &image, &a->desc, BIS_NEED_TABLE, diag);
}

static bis_status open_as(bis_light **light, asked *a, const char *const *settings, bis_diag *diag)
{
    bis_status status = BIS_OK;

    a->desc.loc.file = a->desc.filename;
    for (; !status && *settings; settings++) status = set(&a->desc, *settings, diag);
    return status ? status : open_light(light, a, diag);
}

static bis_status open_by(bis_light **light, asked *a, const char *kind, double area_exponent, const char *mapping,
                          bis_diag *diag)
{
    bis_status status = set_kind(&a->desc, kind, diag);

    if (!status) status = set_area_exponent(&a->desc, area_exponent, diag);
    if (!status && mapping) status = set_mapping(&a->desc, mapping, diag);
    return status ? status : open_light(light, a, diag);
}

bis_status bis_do_light_open_as(bis_light **light, const char *path, const char *const *settings, bis_diag *diag)
{
    asked a = asked_for(path, 0, 0, NULL);
    return open_as(light, &a, settings, diag);
}

bis_status bis_do_light_make_as(bis_light **light, int width, int height, const float *pixels,
                                const char *const *settings, bis_diag *diag)
{
    asked a = asked_for("the array", width, height, pixels);
    return open_as(light, &a, settings, diag);
}

bis_status bis_do_light_open(bis_light **light, const char *path, const char *kind, double area_exponent,
                             const char *mapping, bis_diag *diag)
{
    asked a = asked_for(path, 0, 0, NULL);
    return open_by(light, &a, kind, area_exponent, mapping, diag);
}

bis_status bis_do_light_make(bis_light **light, int width, int height, const float *pixels, const char *kind,
                             double area_exponent, const char *mapping, bis_diag *diag)
{
    asked a = asked_for("the array", width, height, pixels);
    return open_by(light, &a, kind, area_exponent, mapping, diag);
}

bis_status bis_do_light_shrink(bis_light **small, const bis_light *light, int width, bis_diag *diag)
{
    const bis_envmap *em = bis_light_envmap(light);
    bis_image image = {0};
    bis_light_desc desc = bis_light_desc_default();
    double power[2];

    if (width < 1) return bis_flat_refuse(diag, "%d columns: give 1 or more", width);
    desc.filename = (char *)(uintptr_t)"the shrunk map"; /* only read */
    desc.has_mapping = true;                             /* lat-long, even where it is square */
    if (width > em->width) width = em->width;
    const bis_status status = bis_envmap_to_mapping(&image, em, BIS_MAPPING_LATLONG, width, power, diag);
    return status ? status : bis_light_from_image(small, &image, &desc, BIS_NEED_TABLE, diag);
}

void bis_flat_light_close(bis_light *light) { bis_light_free(light); }

/* ---- what is known ---- */

static size_t pixels_of(const bis_envmap *em) { return (size_t)em->width * (size_t)em->height; }

void bis_flat_light_shape(const bis_light *light, int shape[2])
{
    if (!shape) return;
    shape[0] = light ? bis_light_envmap(light)->width : 0;
    shape[1] = light ? bis_light_envmap(light)->height : 0;
}

void bis_flat_light_pixels(const bis_light *light, float *pixels)
{
    if (!light || !pixels) return;
    const bis_envmap *em = bis_light_envmap(light);
    memcpy(pixels, em->pixels, pixels_of(em) * 3 * sizeof *pixels);
}

double bis_flat_light_power(const bis_light *light) { return light ? bis_light_power(light) : (double)NAN; }

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

/* ---- directions and pixels ---- */

static rgb value_of(const void *light, vec3 w, double *pdf) { return bis_light_Le_pdf(light, w, pdf); }

bis_status bis_do_light_look(const bis_light *light, size_t n, const float *w, float *L, double *pdf, bis_diag *diag)
{
    return bis_flat_look(value_of, light, n, w, L, pdf, diag);
}

static bis_status is_black(bis_diag *diag)
{
    return bis_flat_refuse(diag, "the map is black: it has no directions to draw");
}

bis_status bis_do_light_sample(const bis_light *light, size_t n, const double *u, float *w, float *L, double *pdf,
                               bis_diag *diag)
{
    const bis_status status = bis_flat_numbers(n, 4, u, diag);

    for (size_t i = 0; !status && i < n; i++) {
        bis_light_point p;
        if (!bis_light_sample(light, u + 4 * i, &p)) return is_black(diag);
        memcpy(w + 3 * i, &p.wi, 3 * sizeof *w);
        memcpy(L + 3 * i, &p.Le, 3 * sizeof *L);
        pdf[i] = p.pdf;
    }
    return status;
}

bis_status bis_do_light_draw(const bis_light *light, size_t n, const double *u, uint32_t *pixel, bis_diag *diag)
{
    const bis_status status = bis_flat_numbers(n, 4, u, diag);

    for (size_t i = 0; !status && i < n; i++) {
        bis_map_sample s;
        if (!bis_importance_sample(bis_light_importance(light), u + 4 * i, &s)) return is_black(diag);
        pixel[i] = (uint32_t)s.pixel;
    }
    return status;
}

bis_status bis_do_light_find(const bis_light *light, size_t n, const float *w, uint32_t *pixel, bis_diag *diag)
{
    for (size_t i = 0; i < n; i++) {
        vec3 d;
        const bis_status status = bis_flat_direction(&d, w, i, diag);
        if (status) return status;
        pixel[i] = (uint32_t)bis_envmap_pixel(bis_light_envmap(light), d);
    }
    return BIS_OK;
}

static bis_status check_pixels(const bis_envmap *em, size_t n, const uint32_t *pixel, bis_diag *diag)
{
    for (size_t i = 0; i < n; i++)
        if (pixel[i] >= pixels_of(em))
            return bis_flat_refuse(diag, "pixel %zu is %" PRIu32 ", not below %zu", i, pixel[i], pixels_of(em));
    return BIS_OK;
}

bis_status bis_do_light_centres(const bis_light *light, size_t n, const uint32_t *pixel, float *w, bis_diag *diag)
{
    const bis_envmap *em = bis_light_envmap(light);
    const uint32_t width = (uint32_t)em->width;
    const bis_status status = check_pixels(em, n, pixel, diag);

    for (size_t i = 0; !status && i < n; i++) {
        const vec3 d = bis_envmap_direction(em, (int)(pixel[i] % width), (int)(pixel[i] / width), 0.5, 0.5);
        memcpy(w + 3 * i, &d, 3 * sizeof *w);
    }
    return status;
}

/* ---- densities and regions ---- */

bis_status bis_do_light_density(const bis_light *light, double *pdf, double *peak, double *share, bis_diag *diag)
{
    const bis_envmap *em = bis_light_envmap(light);
    const size_t width = (size_t)em->width;

    (void)diag; /* nothing can go wrong */
    *peak = 0;
    memset(share, 0, (size_t)em->height * sizeof *share);
    for (size_t i = 0; i < pixels_of(em); i++) {
        pdf[i] = bis_importance_pdf_pixel(bis_light_importance(light), i);
        *peak = fmax(*peak, pdf[i]);
        share[i / width] += pdf[i] * em->row_solid_angle[i / width];
    }
    return BIS_OK;
}

bis_status bis_do_light_rows(const bis_light *light, size_t n, const uint32_t *pixel, double degrees, uint32_t *count,
                             double *polar, bis_diag *diag)
{
    const bis_envmap *em = bis_light_envmap(light);
    const size_t width = (size_t)em->width, height = (size_t)em->height;

    if (isnan(degrees)) return bis_flat_refuse(diag, "degrees is not a number");
    const bis_status status = check_pixels(em, n, pixel, diag);
    if (status) return status;
    memset(count, 0, height * sizeof *count);
    memset(polar, 0, 2 * sizeof *polar);
    for (size_t i = 0; i < n; i++) count[pixel[i] / width]++;
    for (size_t y = 0; y < height; y++) {
        const double theta = 180 * ((double)y + 0.5) / (double)height;
        if (fmin(theta, 180 - theta) > degrees) continue;
        polar[0] += count[y];
        for (size_t x = 0; x < width; x++)
            polar[1] += (double)n * bis_importance_pdf_pixel(bis_light_importance(light), y * width + x) *
                        em->row_solid_angle[y];
    }
    return BIS_OK;
}

bis_status bis_do_light_regions(const bis_light *light, int levels, double b, uint32_t *label, uint32_t *level,
                                double *area, double *factor, uint32_t *n, bis_diag *diag)
{
    const bis_envmap *em = bis_light_envmap(light);
    bis_regions r = {0};

    if (!(levels >= 1 && levels <= BIS_LEVELS_MAX && b >= 0 && b <= BIS_AREA_EXPONENT_MAX))
        return bis_flat_refuse(diag, "%d levels and exponent %g: give 1 to %d and 0 to %g", levels, b, BIS_LEVELS_MAX,
                               BIS_AREA_EXPONENT_MAX);
    const bis_status status = bis_regions_init(&r, em, levels, diag);
    for (size_t i = 0; !status && i < pixels_of(em); i++) {
        const uint32_t k = label[i] = r.label[i];
        const bool lit = k != BIS_REGION_NONE;
        level[i] = lit ? r.level[k] : BIS_REGION_NONE;
        area[i] = lit ? r.solid_angle[k] : 0;
        factor[i] = lit ? bis_area_factor(r.solid_angle[k], b) : 0;
    }
    if (!status) *n = r.n;
    bis_regions_clear(&r);
    return status;
}
