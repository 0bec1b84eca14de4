/* SPDX-License-Identifier: BSD-2-Clause */
/* parser_light: LightSource.
 *
 * A LightSource's frame is object space at its place, so the CTM must be a rotation, perhaps with a reflection. A
 * uniform scale changes no direction. Exporters write matrices with few digits, so an error up to
 * BIS_XFORM_FRAME_TOLERANCE is allowed, and the matrix is made exactly orthonormal. */
#include "base/grow.h"
#include "bis/base/mem.h"
#include "approximate.h"
#include "directives.h"
#include "parser_ask.h"
#include "parser_colours.h"
#include "scene/light_fields.h"

#include <string.h>

static const bis_interval anything = {-HUGE_VAL, HUGE_VAL, false, false};
static const bis_interval positive_or_0 = {0, HUGE_VAL, false, false};

static void light_filename(bis_parser *p, bis_light_desc *light)
{
    const char *name;
    bis_loc at = bis_params_at(p, "filename");
    bool given = light->is_v4 = bis_params_string(p, "filename", &name);
    const bool both = given && bis_params_has(p, "mapname");
    if (both) {
        bis_parser_error(p, bis_params_at(p, "mapname"), "\"mapname\" and \"filename\" are the same: give one");
        bis_params_skip(p, &(const char *){"mapname"}, 1);
        return;
    }
    if (!given) {
        at = bis_params_at(p, "mapname");
        given = bis_params_string(p, "mapname", &name); /* pbrt-v3 */
    }
    if (given) light->filename = bis_parser_path(p, at, name, "--light MAP takes another");
}

/* A number, or pbrt-v3's rgb, which goes into L. */
static void light_radiance(bis_parser *p, bis_light_desc *light)
{
    rgb scale;
    const bis_param *L = bis_params_find(p, "L");
    if (L && L->type & BIS_TYPES_OF_COLOUR) bis_params_emission(p, "L", &light->L);
    else bis_params_rgb(p, "L", &light->L, positive_or_0, false);
    if (!bis_params_rgb(p, "scale", &scale, positive_or_0, true)) return;
    if (scale.r == scale.g && scale.g == scale.b) {
        light->scale = (double)scale.r;
        return;
    }
    light->L = rgb_mul(light->L, scale);
    if (!rgb_is_finite(light->L)) {
        bis_parser_error(p, bis_params_at(p, "scale"), "\"L\" times \"scale\" is not finite");
        light->L = (rgb){1, 1, 1};
    }
}

/* pbrt-v4's "illuminance" of a surface that faces up; 0: not given. What is not above 0 means that there as here. */
static double light_illuminance(bis_parser *p)
{
    double illuminance = 0;

    bis_params_float(p, "illuminance", &illuminance, anything);
    return fmax(illuminance, 0);
}

static void light_map(bis_parser *p, bis_light_desc *light)
{
    static const char *const tables[] = {"alias", "cdf"};
    static const bis_table_kind table[] = {BIS_TABLE_ALIAS, BIS_TABLE_CDF};
    uint32_t width = 0, levels = BIS_LEVELS;
    int i;
    light->has_mapping = bis_params_choice(p, "mapping", &i, bis_mapping_names, BIS_N_MAPPINGS);
    if (light->has_mapping) light->mapping = (bis_mapping)i;
    bis_params_uint32(p, "width", &width, 2, BIS_IMAGE_MAX_SIDE);
    light->width = (int)width;
    bis_params_float(p, "areaexponent", &light->area_exponent, (bis_interval){0, BIS_AREA_EXPONENT_MAX, false, false});
    bis_params_uint32(p, "levels", &levels, 1, BIS_LEVELS_MAX);
    light->levels = (int)levels;
    light->has_table_kind = bis_params_choice(p, "sampler", &i, tables, BIS_COUNT(tables));
    if (light->has_table_kind) light->table_kind = table[i];
}

/* What the camera sees of a map: its pixels, or smooth. */
static void light_filter(bis_parser *p, bis_light_desc *light)
{
    static const char *const filters[] = {"point", "bilinear"};
    int i = 0;
    bis_params_choice(p, "filter", &i, filters, BIS_COUNT(filters));
    light->is_smooth = i == 1;
}

/* The light's frame, which is the CTM without its scale. False: it stretches or shears. */
static bool light_frame(const bis_parser *p, bis_xform *turn)
{
    bis_xform t = p->now.ctm;
    const double scale = hypot(hypot(t.m[0][0], t.m[1][0]), t.m[2][0]);
    if (!bis_xform_is_orthonormal(&t, BIS_XFORM_FRAME_TOLERANCE))
        for (int i = 0; i < 9; i++) t.m[i / 3][i % 3] /= scale;
    if (!bis_xform_is_orthonormal(&t, BIS_XFORM_FRAME_TOLERANCE)) return false;
    *turn = bis_xform_rotation(&t);
    return true;
}

/* A rectangle in world space. Its corners may be off by 1e-4 of its size, as few digits leave them. */
static bool read_portal(bis_parser *p, bis_portal *portal)
{
    const bis_param *param = bis_params_take(p, "portal", BIS_TYPE_POINT3, 12);
    const double *v = param ? p->params.numbers + param->first : NULL;
    double off = 0, *along = portal->edge[0], *up = portal->edge[1];

    if (!v) return false;
    for (int i = 0; i < 3; i++) {
        portal->corner[i] = v[i];
        along[i] = v[3 + i] - v[i];
        up[i] = v[9 + i] - v[i];
        off = hypot(off, v[i] - v[3 + i] + v[6 + i] - v[9 + i]);
    }
    const double a = dot3(along, along), b = dot3(up, up), slant = dot3(along, up), size = 1e-4 * sqrt(fmin(a, b));
    if (!(size > 0 && off <= size && fabs(slant) <= size * sqrt(a)))
        return bis_parser_error(p, param->at, "\"portal\" is no rectangle: give its four corners, going around it, in "
                                "world space (the current transformation does not act on them)");
    for (int i = 0; i < 3; i++) up[i] -= slant / a * along[i];
    return true;
}

/* Whether a light is equal to the scene's but for its portal: then the scene's light gets this portal, too. */
static bool is_equal(const bis_light_desc *scene, bis_light_desc light)
{
    light.n_portals = scene->n_portals;
    memcpy(light.portals, scene->portals, sizeof light.portals);
    return strcmp(scene->filename ? scene->filename : "", light.filename ? light.filename : "") == 0 &&
           scene->illuminance == light.illuminance && bis_fields_are_equal(scene, &light, bis_light_fields);
}

static void add_portal(bis_parser *p, bis_loc at, const bis_portal *portal)
{
    bis_light_desc *light = &p->desc->light;

    if (light->n_portals < BIS_PORTALS_MAX) light->portals[light->n_portals++] = *portal;
    else bis_parser_error(p, at, "more than %d portals: take one around several openings", BIS_PORTALS_MAX);
}

static bool light_may_stand(bis_parser *p, bis_loc at)
{
    const bis_scene_desc *d = p->desc;
    if (d->has_light && bis_approximate(p, "LightSource", "a second", at)) return false;
    if (d->has_light)
        return bis_parser_error(p, at, "a second LightSource: a scene has at most one, and its first is that of "
                                "%s:%d%s", d->light.loc.file, d->light.loc.line,
                                bis_approximate_hint(p, "LightSource", "a second"));
    if (p->in_object)
        return bis_parser_error(p, at, "LightSource inside ObjectBegin: objects hold geometry only");
    return true;
}

/* The frame of a map of the scene tells where its "up" is, for the map that takes its place, and whether the background
 * is transparent. */
static void pass_over(bis_parser *p, bis_loc at)
{
    if (!bis_parser_name(p, "LightSource") || !bis_params_read(p)) return;
    const bool is_map = bis_params_has(p, "filename") || bis_params_has(p, "mapname");
    bis_portal portal;
    if (read_portal(p, &portal)) add_portal(p, at, &portal);
    bis_params_bool(p, "visible", &p->desc->light.visible);
    bis_params_bool(p, "windows", &p->desc->light.windows);
    if (is_map && !p->desc->has_light) p->desc->has_light = light_frame(p, &p->desc->light.to_world);
}

static void read_point(bis_parser *p, const char *name, double v[3])
{
    const bis_param *param = bis_params_take(p, name, BIS_TYPE_POINT3 | BIS_TYPE_VECTOR3, 3);
    for (int i = 0; i < 3 && param; i++) v[i] = p->params.numbers[param->first + (size_t)i];
}

/* pbrt's "distant", with --approximate: it shines from `from` towards `to`. */
static void read_distant(bis_parser *p, bis_loc at)
{
    double from[3] = {0, 0, 0}, to[3] = {0, 0, 1};
    bis_light_desc light = bis_light_desc_default();
    bis_distant one;

    read_point(p, "from", from);
    read_point(p, "to", to);
    light_radiance(p, &light);
    const double illuminance = light_illuminance(p);
    if (illuminance > 0) light.scale *= illuminance; /* pbrt's own light has the irradiance 1 */
    for (int i = 0; i < 3; i++) {
        one.towards[i] = 0;
        for (int k = 0; k < 3; k++) one.towards[i] += p->now.ctm.m[i][k] * (from[k] - to[k]);
    }
    const double length = hypot(hypot(one.towards[0], one.towards[1]), one.towards[2]);
    if (!(length > 0) || !isfinite(length)) {
        bis_parser_error(p, at, "LightSource \"distant\" has no direction: \"from\" and \"to\" are one point");
        return;
    }
    for (int i = 0; i < 3; i++) one.towards[i] /= length;
    one.irradiance = rgb_scale(light.L, light.scale);
    if (!rgb_is_finite(one.irradiance))
        bis_parser_error(p, at, "\"L\" times \"scale\" is not finite");
    else if (!BIS_ROOM(p->distants, p->capacity_distants, p->n_distants)) bis_parser_nomem(p, at);
    else p->distants[p->n_distants++] = one;
}

void bis_directive_light(bis_parser *p, bis_loc at)
{
    static const bis_choice lights[] = {
        {"infinite", 0},          {"point", BIS_FOREIGN},       {"spot", BIS_FOREIGN},
        {"distant", BIS_FOREIGN}, {"goniometric", BIS_FOREIGN}, {"projection", BIS_FOREIGN},
        {"diffuse", BIS_FOREIGN},
    };

    if (p->other_light) {
        pass_over(p, at);
        return;
    }
    const bis_choice *chosen = bis_parser_begin(p, "LightSource", lights, BIS_COUNT(lights));
    if (chosen && strcmp(chosen->name, "distant") == 0) read_distant(p, at);
    bis_portal portal;
    const bool is_further = p->desc->light.n_portals && chosen && bis_params_has(p, "portal");
    if (!chosen || chosen->value == BIS_FOREIGN || (!is_further && !light_may_stand(p, at))) return;
    bis_light_desc light = bis_light_desc_default();
    light.loc = at;
    light_filename(p, &light);
    if (p->now.is_flat && light.filename)
        bis_approximate_note(p, at, "it stands as if that were not there: other parts of a map are seen",
                             "a light under a singular transformation, or one with a perspective");
    if (!light_frame(p, &light.to_world) && light.filename)
        bis_parser_error(p, at, "LightSource under a transformation that stretches or shears: only rotations, "
                         "reflections and a uniform scale are allowed");
    light_radiance(p, &light);
    light_map(p, &light);
    light.illuminance = light_illuminance(p);
    bis_params_bool(p, "visible", &light.visible);
    bis_params_bool(p, "windows", &light.windows);
    light_filter(p, &light);
    const bool has_portal = read_portal(p, &portal);
    bis_params_ignore(p, "LightSource");
    bis_params_end(p, "LightSource", "infinite");
    if (is_further) {
        const bool may_stand = is_equal(&p->desc->light, light) || light_may_stand(p, at);
        bis_free(light.filename);
        if (!may_stand) return;
    } else {
        p->desc->light = light;
        p->desc->has_light = true;
    }
    if (has_portal) add_portal(p, at, &portal);
}

/* ---- the whole ---- */

/* The light's frame with z along the axis of the world that is nearest to the camera's "up". */
static bis_xform upright(const bis_parser *p)
{
    double up[3] = {p->up[0], p->up[1], p->up[2]};
    const bool has_up = up[0] != 0 || up[1] != 0 || up[2] != 0;
    int axis = 0;

    for (int i = 0; i < 3 && !has_up; i++) up[i] = p->desc->view.camera.to_world.m[i][1];
    for (int i = 1; i < 3; i++)
        if (fabs(up[i]) > fabs(up[axis])) axis = i;
    if (axis == 0) return bis_xform_rotate(up[0] > 0 ? 90 : -90, 0, 1, 0);
    if (axis == 1) return bis_xform_rotate(up[1] > 0 ? -90 : 90, 1, 0, 0);
    return bis_xform_rotate(up[2] > 0 ? 0 : 180, 1, 0, 0);
}

/* The distant lights go into the frame of the map. */
static void take_distants(bis_parser *p)
{
    bis_light_desc *light = &p->desc->light;

    for (size_t i = 0; i < p->n_distants; i++) {
        double *w = p->distants[i].towards, local[3] = {0, 0, 0};
        for (int k = 0; k < 3; k++)
            for (int m = 0; m < 3; m++) local[k] += light->to_world.inv[k][m] * w[m];
        memcpy(w, local, sizeof local);
        p->distants[i].irradiance = rgb_scale(p->distants[i].irradiance, p->film_scale);
    }
    if (!p->desc->has_light) light->L = (rgb){0, 0, 0};
    light->distants = p->distants;
    light->n_distants = p->n_distants;
    light->capacity_distants = p->capacity_distants;
    p->distants = NULL;
    p->n_distants = p->capacity_distants = 0;
    p->desc->has_light = true;
}

void bis_parser_finish_light(bis_parser *p)
{
    bis_scene_desc *d = p->desc;
    const bis_loc whole = {d->files[0], 0, 0};

    d->upright = upright(p);
    if (p->other_light) {
        if (!d->has_light) d->light.to_world = d->upright;
        d->has_light = true;
        return;
    }
    if (!d->has_light) d->light.loc = whole;
    p->film_scale *= p->exposure.ratio > 0 ? p->exposure.ratio
                     : (p->exposure.time > 0 ? p->exposure.time : p->exposure.shutter) * p->exposure.iso / 100;
    d->light.scale *= p->film_scale;
    if (p->n_distants) take_distants(p);
    if (d->has_light) return;
    if (!p->approximate) {
        bis_warn(p->diag, whole, "no light: the scene has no LightSource and will be black");
        return;
    }
    d->light.scale = 1;
    d->has_light = true;
    bis_approximate_sky(p);
}
