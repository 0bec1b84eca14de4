/* SPDX-License-Identifier: BSD-2-Clause */
/* parser_options: what stands before WorldBegin: Camera, Film, PixelFilter, Accelerator, Option, and the two directives
 * that pbrt needs and bis only has to understand, ColorSpace and MediumInterface.
 *
 * A directive that is given again starts from the defaults, as in pbrt. */
#include "bis/base/file.h"
#include "bis/base/mem.h"
#include "approximate.h"
#include "directives.h"
#include "parser_ask.h"
#include "parser_version.h"

#include <string.h>

static const bis_interval any = {-HUGE_VAL, HUGE_VAL, false, false};

/* ---- Camera ---- */

static void camera_screen(bis_parser *p, bis_camera *c)
{
    double s[4];
    bis_params_float(p, "frameaspectratio", &c->frame_aspect, (bis_interval){0, HUGE_VAL, true, false});
    if (!bis_params_floats(p, "screenwindow", s, 4, any)) return;
    if (s[0] == s[1] || s[2] == s[3]) {
        bis_parser_error(p, bis_params_at(p, "screenwindow"),
                         "\"screenwindow\" is empty: it wants x0 x1 y0 y1 with x0 != x1, y0 != y1");
        return;
    }
    memcpy(c->screen, s, sizeof s);
    c->has_screen = true;
}

/* A pinhole is a lens of radius 0; anything wider is pbrt's thin lens. The distance that a pinhole is focused at means
 * nothing. */
static void camera_lens(bis_parser *p)
{
    static const char *const focus[] = {"focaldistance"};
    double radius = 0;
    if (bis_params_float(p, "lensradius", &radius, any) && radius != 0) {
        bis_approximate_or_refuse(p, bis_params_at(p, "lensradius"), "\"lensradius\"", "all is in focus",
                                  "a thin lens is not modelled: \"lensradius\" must be 0");
    }
    bis_params_skip(p, focus, BIS_COUNT(focus));
}

/* In pbrt-v4 the film gathers light for as long as the shutter is open. Source: src/pbrt/scene.cpp. */
static void camera_shutter(bis_parser *p)
{
    double open = 0, close = 1;
    p->exposure.shutter = 1;
    bis_params_float(p, "shutteropen", &open, any);
    bis_params_float(p, "shutterclose", &close, any);
    if (bis_parser_predates_v4(p)) bis_params_ignore(p, "Camera");
    if (close - open == 1 || bis_parser_is_before_v4(p, bis_params_at(p, "shutterclose"), "the shutter", "the picture "
                                                     "is as bright as it is long open", "it changes nothing"))
        return;
    p->exposure.shutter = close - open;
    if (!(close > open))
        bis_parser_error(p, bis_params_at(p, "shutterclose"), "the shutter is open from %g to %g, so that the picture "
                         "would be black, and pbrt-v4 ends: \"shutterclose\" must exceed \"shutteropen\"", open, close);
}

/* halffov is that of structure synth, as in pbrt-v2 to v4. */
static void camera_fov(bis_parser *p, bis_camera *c)
{
    double half = -1;
    bis_params_float(p, "fov", &c->fov_deg, (bis_interval){0, 180, true, true});
    if (bis_params_float(p, "halffov", &half, (bis_interval){-HUGE_VAL, 90, false, true}) && half > 0)
        c->fov_deg = 2 * half;
}

void bis_directive_camera(bis_parser *p, bis_loc at)
{
    enum { PERSPECTIVE, ORTHOGRAPHIC };
    static const bis_choice cameras[] = {
        {"perspective", PERSPECTIVE}, {"orthographic", ORTHOGRAPHIC}, {"environment", BIS_FOREIGN},
        {"spherical", BIS_FOREIGN},   {"realistic", BIS_FOREIGN},
    };
    const bis_choice *chosen = bis_parser_begin(p, "Camera", cameras, BIS_COUNT(cameras));
    if (!chosen) return;
    bis_parser_single(p, BIS_SINGLE_CAMERA, "Camera", at);

    bis_camera c = {.orthographic = chosen->value == ORTHOGRAPHIC, .fov_deg = 90,
                    .to_world = bis_xform_inverse(&p->now.ctm)};
    if (!c.orthographic) camera_fov(p, &c);
    camera_screen(p, &c);
    camera_lens(p);
    camera_shutter(p);
    bis_params_end(p, "Camera", chosen->name);
    p->desc->view.camera = c;
    bis_parser_name_system(p, "camera", &c.to_world, at);
}

/* ---- Film ---- */

static void film_crop(bis_parser *p, bis_film_desc *film)
{
    double c[4];
    if (!bis_params_floats(p, "cropwindow", c, 4, (bis_interval){0, 1, false, false})) return;
    if (c[0] < c[1] && c[2] < c[3]) {
        memcpy(film->crop, c, sizeof c);
        return;
    }
    bis_parser_error(p, bis_params_at(p, "cropwindow"),
                     "\"cropwindow\" is empty: it wants x0 x1 y0 y1 with x0 < x1, y0 < y1");
}

/* One name, or several, of what the picture shall carry beside its colours. */
static void film_layers(bis_parser *p, bis_film_desc *film)
{
    const bis_param *param = bis_params_take(p, "layers", BIS_TYPE_STRING, 0);
    for (size_t i = 0; param && i < param->n; i++) {
        const char *name = bis_parser_text(p, p->params.strings[param->first + i]);
        if (bis_layers_include(&film->layers, name)) continue;
        bis_parser_error(p, param->at, "\"layers\" is \"%s\": there is no such layer%s",
                         bis_parser_word(p, name), bis_parser_hint(p, bis_layer_nearest(name)));
    }
}

/* pbrt-v4's: the picture is multiplied by the exposure time times ISO / 100. Source: src/pbrt/film.cpp, whose earlier
 * versions had exposuretime, instead of the shutter's, and imagingratio, instead of the product. */
static void film_exposure(bis_parser *p)
{
    static const bis_interval positive = {0, HUGE_VAL, true, false};
    p->exposure.iso = 100;
    p->exposure.time = p->exposure.ratio = 0;
    bis_params_float(p, "iso", &p->exposure.iso, positive);
    bis_params_float(p, "exposuretime", &p->exposure.time, positive);
    bis_params_float(p, "imagingratio", &p->exposure.ratio, positive);
}

void bis_directive_film(bis_parser *p, bis_loc at)
{
    static const bis_choice films[] = {{"rgb", 0}, {"image", 0}, {"gbuffer", BIS_FOREIGN}, {"spectral", BIS_FOREIGN}};
    const bis_choice *type = bis_parser_begin(p, "Film", films, BIS_COUNT(films));
    if (!type) return;
    bis_parser_single(p, BIS_SINGLE_FILM, "Film", at);

    bis_film_desc film = bis_film_default;
    uint32_t width = (uint32_t)film.width, height = (uint32_t)film.height;
    const char *filename = BIS_FILM_FILENAME;
    bis_params_uint32(p, "xresolution", &width, 1, BIS_IMAGE_MAX_SIDE);
    bis_params_uint32(p, "yresolution", &height, 1, BIS_IMAGE_MAX_SIDE);
    if (bis_params_string(p, "filename", &filename) && !*filename)
        bis_parser_error(p, bis_params_at(p, "filename"), "\"filename\" is empty");
    film.width = (int)width;
    film.height = (int)height;
    p->film_scale = 1;
    bis_params_float(p, "scale", &p->film_scale, (bis_interval){0, HUGE_VAL, false, false});
    film_crop(p, &film);
    film_layers(p, &film);
    film_exposure(p);
    bis_params_ignore(p, "Film");
    char *outfile = bis_strdup(filename);
    if (outfile) {
        bis_free(p->desc->outfile);
        p->desc->outfile = outfile;
    } else {
        bis_parser_nomem(p, at);
    }
    bis_params_end(p, "Film", type->name);
    p->desc->view.film = film;
}

/* ---- PixelFilter ---- */

void bis_directive_filter(bis_parser *p, bis_loc at)
{
    static const bis_choice filters[] = {
        {"box", 0},           {"gaussian", BIS_REPLACED}, {"mitchell", BIS_REPLACED},
        {"sinc", BIS_REPLACED}, {"triangle", BIS_REPLACED}, {"lanczossinc", BIS_REPLACED},
    };
    static const char *const radii[] = {"xradius", "yradius", "xwidth", "ywidth"};
    const bis_choice *chosen = bis_parser_begin(p, "PixelFilter", filters, BIS_COUNT(filters));
    if (!chosen) return;
    bis_parser_single(p, BIS_SINGLE_FILTER, "PixelFilter", at);
    if (chosen->value == BIS_REPLACED && p->approximate) {
        bis_approximate_note(p, p->name_at, "the box of one pixel is used", "PixelFilter \"%s\"",
                             bis_parser_word(p, bis_parser_text(p, p->name)));
        return;
    }
    if (chosen->value == BIS_REPLACED) {
        bis_warn(p->diag, p->name_at, "PixelFilter \"%s\" is ignored, which changes sharpness: the box of one pixel "
                 "is used", chosen->name);
        return;
    }
    for (size_t i = 0; i < BIS_COUNT(radii); i++) {
        double radius;
        if (bis_params_float(p, radii[i], &radius, (bis_interval){0, HUGE_VAL, true, false}) && radius != 0.5)
            bis_warn(p->diag, bis_params_at(p, radii[i]), "\"%s\" is ignored: the box has the size of one pixel (0.5)",
                     radii[i]);
    }
    bis_params_end(p, "PixelFilter", "box");
}

/* ---- Accelerator ---- */

void bis_directive_accelerator(bis_parser *p, bis_loc at)
{
    static const bis_choice accelerators[] = {
        {"grid", BIS_ACCEL_GRID}, {"embree", BIS_ACCEL_EMBREE}, {"bvh", BIS_REPLACED}, {"kdtree", BIS_REPLACED}};
    const bis_choice *chosen = bis_parser_begin(p, "Accelerator", accelerators, BIS_COUNT(accelerators));
    if (!chosen) return;
    bis_parser_single(p, BIS_SINGLE_ACCELERATOR, "Accelerator", at);
    p->desc->accel = (bis_accel_options){.kind = BIS_ACCEL_DEFAULT};
    if (chosen->value == BIS_REPLACED) {
        if (strcmp(chosen->name, bis_parser_text(p, p->name)) == 0) /* else it was said that this one is unknown */
            bis_warn(p->diag, p->name_at, "Accelerator \"%s\" is replaced by the default", chosen->name);
        return;
    }
    p->desc->accel.kind = (bis_accel_kind)chosen->value;
    if (chosen->value == BIS_ACCEL_GRID)
        bis_params_float(p, "density", &p->desc->accel.density, (bis_interval){0, 100, true, false});
    bis_params_end(p, "Accelerator", chosen->name);
}

/* ---- Option, ColorSpace, MediumInterface ---- */

/* Which of the thesis's equations to follow to the letter. */
static void option_as_printed(bis_parser *p)
{
    const bis_param *param = bis_params_take(p, "asprinted", BIS_TYPE_STRING, 0);
    for (size_t i = 0; param && i < param->n; i++) {
        const char *name = bis_parser_text(p, p->params.strings[param->first + i]);
        const bis_erratum *e = bis_erratum_find(name);
        if (e) p->desc->view.settings.as_printed |= e->flag;
        else
            bis_parser_error(p, param->at, "\"asprinted\" is \"%s\": no erratum of that name can be switched%s",
                             bis_parser_word(p, name), bis_parser_hint(p, bis_erratum_nearest(name)));
    }
}

void bis_directive_option(bis_parser *p, bis_loc at)
{
    if (p->token.kind != BIS_TOKEN_STRING && p->token.kind != BIS_TOKEN_BAD)
        bis_parser_error(p, at, "Option wants \"type name\" and a value");
    p->lost = p->token.kind != BIS_TOKEN_STRING;
    bis_params_start(p);
    if (p->lost || !bis_params_read(p)) return;
    bool disable;
    if (bis_params_bool(p, "disablepixeljitter", &disable)) p->desc->view.pixel_jitter = !disable;
    if (bis_params_bool(p, "approximate", &disable)) p->approximate |= disable;
    option_as_printed(p);
    bis_params_ignore(p, "Option");
    bis_params_end(p, "Option", NULL);
}

void bis_directive_color_space(bis_parser *p, bis_loc at)
{
    (void)at;
    if (!bis_parser_name(p, "ColorSpace")) return;
    const char *name = bis_parser_text(p, p->name);
    if (strcmp(name, "srgb") == 0 || bis_approximate(p, "ColorSpace", NULL, p->name_at)) return;
    bis_parser_error(p, p->name_at, "ColorSpace is \"%s\", must be \"srgb\"%s", bis_parser_word(p, name),
                     bis_approximate_hint(p, "ColorSpace", NULL));
}

/* One or two names, both empty: the vacuum inside and outside. */
void bis_directive_medium_interface(bis_parser *p, bis_loc at)
{
    (void)at;
    for (int i = 0; i == 0 || (i == 1 && p->token.kind == BIS_TOKEN_STRING); i++) {
        if (!bis_parser_name(p, "MediumInterface")) return;
        const char *name = bis_parser_text(p, p->name);
        if (*name && !bis_approximate(p, "MediumInterface", NULL, p->name_at))
            bis_parser_error(p, p->name_at, "MediumInterface is \"%s\", must be \"\": media are not modelled%s",
                             bis_parser_word(p, name), bis_approximate_hint(p, "MediumInterface", NULL));
    }
}
