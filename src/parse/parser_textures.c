/* SPDX-License-Identifier: BSD-2-Clause */
/* parser_textures: Texture, and parameters of materials that may name one; docs/scene-format.md, "Texture".
 *
 * As in pbrt a texture is known from its directive on, and numbers and colours have names of their own. What a texture
 * is made of stands before it in the list, so that there are no cycles. A texture that is the same everywhere becomes
 * a constant here, and a material with only such textures is like any other. */
#include "approximate.h"
#include "bis/base/file.h"
#include "base/grow.h"
#include "directives.h"
#include "parser_colours.h"
#include "parser_textures.h"
#include "parser_version.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static const bis_interval anything = {-HUGE_VAL, HUGE_VAL, false, false};
static const bis_interval unit = {0, 1, false, false};

/* ---- the list ---- */

bool bis_parser_add_texture(bis_parser *p, const bis_texture *x, uint32_t *index)
{
    bis_textures *t = &p->desc->textures;
    if (!BIS_ROOM(t->list, t->capacity, t->n) || t->n >= UINT32_MAX - 1) return bis_parser_nomem(p, p->name_at);
    *index = (uint32_t)t->n;
    t->list[t->n++] = *x;
    return true;
}

static bis_texture constant(rgbd value)
{
    return (bis_texture){.kind = BIS_TEXTURE_CONSTANT, .value = value, .steps = 1};
}

bool bis_parser_find_texture(bis_parser *p, const bis_param *param, bool of_floats, uint32_t *index)
{
    const char *name = bis_parser_text(p, p->params.strings[param->first]);
    const bis_names *colours = &p->texture_names[0], *floats = &p->texture_names[1];

    if (!of_floats && bis_names_find(colours, name, index)) return true;
    if (bis_names_find(floats, name, index)) return true;
    if (of_floats && bis_names_find(colours, name, index)) {
        bis_approximate_or_refuse(p, param->at, "a texture of colours in place of numbers",
                                  "the parameter's default is taken",
                                  "texture \"%s\" is one of colours; \"%s\" needs one of numbers, "
                                  "Texture \"%s\" \"float\"", bis_parser_word(p, name),
                                  bis_parser_text(p, param->name), bis_parser_word(p, name));
        return false;
    }
    if (p->own_texture && strcmp(name, bis_parser_text(p, p->name)) == 0)
        return bis_parser_error(p, param->at, "texture \"%s\" would be made of itself: name one that is defined before",
                                bis_parser_word(p, name));
    const char *nearest = bis_names_nearest(of_floats ? floats : colours, name);
    char word[128];
    bis_approximate_or_refuse(p, param->at, "a texture that is not defined", "the parameter's default is taken",
                              "texture \"%s\" is not defined%s; as in pbrt, Texture must stand before its "
                              "first use", bis_printable(word, name, strlen(name)), bis_parser_hint(p, nearest));
    return false;
}

/* ---- parameters that may be textures ---- */

static bool is_texture(bis_parser *p, const char *name)
{
    const bis_param *param = bis_params_find(p, name);
    return param && param->type == BIS_TYPE_TEXTURE;
}

static double within(double v, bis_interval r) { return fmin(fmax(v, r.lo), r.hi); }

/* *value: of a constant, or a typical one. */
static bool take_texture(bis_parser *p, const char *name, bool of_floats, rgbd *value, bis_interval range,
                         uint32_t *texture)
{
    const bis_param *param = bis_params_take(p, name, BIS_TYPE_TEXTURE, 1);
    uint32_t index;
    if (!param || !bis_parser_find_texture(p, param, of_floats, &index)) return false;
    const bis_texture *x = &p->desc->textures.list[index];
    if (x->kind == BIS_TEXTURE_CONSTANT) {
        *value = x->value;
        return bis_parser_in_range(p, param->at, name, &value->r, range) &&
               bis_parser_in_range(p, param->at, name, &value->g, range) &&
               bis_parser_in_range(p, param->at, name, &value->b, range);
    }
    *texture = index;
    *value = (rgbd){within(x->value.r, range), within(x->value.g, range), within(x->value.b, range)};
    return true;
}

bool bis_params_colour(bis_parser *p, const char *name, rgb *value, bis_interval range, uint32_t *texture)
{
    rgbd v;
    const bis_param *param = bis_params_find(p, name);
    if (param && param->type & BIS_TYPES_OF_COLOUR) return bis_params_reflectance(p, name, value);
    if (!is_texture(p, name)) return bis_params_rgb(p, name, value, range, true);
    if (!take_texture(p, name, false, &v, range, texture)) return false;
    *value = rgbd_round(v);
    return true;
}

void bis_params_number(bis_parser *p, const char *name, double *value, bis_interval range, uint32_t *texture)
{
    rgbd v;
    if (!is_texture(p, name)) bis_params_float(p, name, value, range);
    else if (take_texture(p, name, true, &v, range, texture)) *value = v.r;
}

/* ---- what a texture is made of ---- */

/* A part of a texture: one of the list. False: complained. Its values may be any, because the texture may serve nothing
 * that bis shows; where it does, its range is looked at. */
static bool read_part(bis_parser *p, const char *name, bool of_floats, double usual, bis_interval range,
                      uint32_t *index)
{
    rgbd value = {usual, usual, usual};
    if (is_texture(p, name)) {
        const bis_param *param = bis_params_take(p, name, BIS_TYPE_TEXTURE, 1);
        return param && bis_parser_find_texture(p, param, of_floats, index);
    }
    const bool usual_will_do = !bis_params_has(p, name) || p->approximate;
    bool ok = true;
    if (of_floats) {
        ok = bis_params_float(p, name, &value.r, range) || usual_will_do;
        value.g = value.b = value.r;
    } else {
        rgb c;
        if (bis_params_rgb(p, name, &c, range, true)) value = (rgbd){(double)c.r, (double)c.g, (double)c.b};
        else ok = usual_will_do;
    }
    const bis_texture x = constant(value);
    return ok && bis_parser_add_texture(p, &x, index);
}

/* From the world to the space of the texture, which is the current transformation's in pbrt-v4. pbrt-v1 to v3 take the
 * world for "planar", and for patterns in space the matrix itself where v4 takes its inverse. */
static bool take_space(bis_parser *p, bis_texture *x, bool is_pattern)
{
    const bis_xform *ctm = &p->now.ctm, world = bis_xform_identity();
    const double (*m)[4] = ctm->inv;
    bool ok = true, moves = false;
    for (int i = 0; i < 12; i++) moves |= ctm->m[i / 4][i % 4] != world.m[i / 4][i % 4];
    if (is_pattern && moves && bis_parser_is_before_v4(p, p->name_at, "the space of a pattern",
                                                       "the current transformation takes it to the world",
                                                       "the transformation is used the other way round"))
        m = ctm->m;
    else if (!is_pattern && x->mapping == BIS_TEXTURE_PLANAR && moves &&
             bis_parser_is_before_v4(p, p->name_at, "the mapping \"planar\"",
                                     "by the point in the space of the current transformation",
                                     "by the point in the world"))
        m = world.m;
    for (int i = 0; i < 12; i++) {
        x->from_world[i / 4][i % 4] = m[i / 4][i % 4];
        ok &= fabs(x->from_world[i / 4][i % 4]) <= 1e30;
    }
    if (x->mapping == BIS_TEXTURE_CYLINDRICAL &&
        bis_parser_is_before_v4(p, p->name_at, "the mapping \"cylindrical\"", "t is z", "t is z over the distance") &&
        p->approximate)
        bis_approximate_note(p, p->name_at, "t is z, as in pbrt-v4; earlier it is z over the distance",
                             "mapping \"cylindrical\" of a Texture");
    return ok || bis_parser_error(p, bis_params_at(p, "mapping"), "the current transformation shrinks this texture's "
                                  "space by more than 1e30: write Identity before it");
}

/* pbrt takes the mean over what a pixel sees of it. */
static void note_filter(bis_parser *p, const char *name)
{
    if (p->approximate)
        bis_approximate_note(p, p->name_at, "looked up at points; the camera samples of a pixel average it",
                             "filter of Texture \"%s\"", name);
}

/* The rows are v1 and v2 in the space of the texture, so that (x, y) is (s, t). */
static void read_plane(bis_parser *p, bis_texture *x)
{
    static const char *const names[] = {"v1", "v2"};
    double row[2][4];
    for (int i = 0; i < 2; i++) {
        double v[3] = {i == 0, i == 1, 0};
        const bis_param *param = bis_params_take(p, names[i], BIS_TYPE_VECTOR3, 3);
        for (int k = 0; k < 3 && param; k++) v[k] = p->params.numbers[param->first + (size_t)k];
        for (int k = 0; k < 4; k++)
            row[i][k] = v[0] * x->from_world[0][k] + v[1] * x->from_world[1][k] + v[2] * x->from_world[2][k];
        row[i][3] += x->offset[i];
    }
    memcpy(x->from_world, row, sizeof row);
}

/* One of words; with --approximate any other word leaves the default. False: complained. */
static bool read_word(bis_parser *p, const char *name, int *value, const char *const *words, size_t n)
{
    const bool given = bis_params_has(p, name);
    return bis_params_choice(p, name, value, words, n) || !given || p->approximate;
}

static bool read_mapping(bis_parser *p, bis_texture *x)
{
    static const char *const names[] = {"uscale", "vscale"}, *const deltas[] = {"udelta", "vdelta"};
    static const char *const mappings[] = {"uv", "spherical", "cylindrical", "planar"}; /* bis_texture_mapping */
    int chosen = BIS_TEXTURE_UV;
    const bool ok = read_word(p, "mapping", &chosen, mappings, BIS_COUNT(mappings));
    x->mapping = (bis_texture_mapping)chosen;
    for (int i = 0; i < 2; i++) {
        if (x->mapping == BIS_TEXTURE_UV) bis_params_float(p, names[i], &x->factor[i], anything);
        if (x->mapping == BIS_TEXTURE_UV || x->mapping == BIS_TEXTURE_PLANAR)
            bis_params_float(p, deltas[i], &x->offset[i], anything);
    }
    if (x->mapping != BIS_TEXTURE_UV && !take_space(p, x, false)) return false;
    if (x->mapping == BIS_TEXTURE_PLANAR) read_plane(p, x);
    return ok;
}

/* "sRGB", "linear", "gamma 2.2"; pbrt-v3's bool gamma: false is linear; pbrt-v2's float gamma: an exponent. */
static bool read_encoding(bis_parser *p, double *gamma)
{
    const char *text, *end;
    bool by_curve = true;

    const bool is_v2 = p->version == BIS_PBRT_V2;
    *gamma = is_v2 ? 1 : BIS_GAMMA_SRGB;
    const bis_param *given = bis_params_find(p, "gamma");
    if (given && given->type == BIS_TYPE_FLOAT && is_v2) {
        bis_params_float(p, "gamma", gamma, (bis_interval){0, 100, true, false});
    } else if (given && given->type == BIS_TYPE_FLOAT) {
        bis_approximate_pass(p, given->at, "ignored, as in pbrt-v3", "\"float gamma\" of a texture");
        bis_params_skip(p, &(const char *){"gamma"}, 1);
    } else if (bis_params_bool(p, "gamma", &by_curve)) {
        *gamma = by_curve ? BIS_GAMMA_SRGB : 1;
    }
    if (!bis_params_string(p, "encoding", &text) || strcmp(text, "sRGB") == 0) return true;
    if (strcmp(text, "linear") == 0) {
        *gamma = 1;
        return true;
    }
    if (strncmp(text, "gamma ", 6) == 0) {
        *gamma = bis_parse_double(text + 6, &end);
        if (end > text + 6 && *end == '\0' && *gamma > 0 && *gamma <= 100) return true;
    }
    *gamma = BIS_GAMMA_SRGB;
    return bis_parser_error(p, bis_params_at(p, "encoding"),
                            "\"encoding\" is \"%s\", must be \"sRGB\", \"linear\" or \"gamma X\", X in (0, 100]",
                            bis_parser_word(p, text));
}

bool bis_parser_add_image(bis_parser *p, char *path, const bis_texture_file *as, uint32_t *index)
{
    if (!path) return false;
    bis_textures *t = &p->desc->textures;
    const size_t room = strlen(path) + 80;
    char *key = bis_alloc(room, 1), number[32];
    bool ok = key != NULL;
    struct stat st;

    bis_format_double(number, as->gamma);
    if (ok && stat(path, &st) == 0)
        snprintf(key, room, "%s,%d=%ju/%ju", number, (int)as->meaning, (uintmax_t)st.st_dev, (uintmax_t)st.st_ino);
    else if (ok) snprintf(key, room, "%s,%d:%s", number, (int)as->meaning, path);
    if (ok && bis_names_find(&p->texture_file_names, key, index)) {
        bis_free(path);
        bis_free(key);
        return true;
    }
    ok = ok && BIS_ROOM(t->files, t->capacity_files, t->n_files) && t->n_files < UINT32_MAX &&
         bis_names_set(&p->texture_file_names, key, (uint32_t)t->n_files);
    bis_free(key);
    if (!ok) {
        bis_free(path);
        return bis_parser_nomem(p, as->loc);
    }
    *index = (uint32_t)t->n_files;
    t->files[t->n_files] = *as;
    t->files[t->n_files++].filename = path;
    return true;
}

/* What an image makes of 1/2, but 0 only if it is black. */
static rgbd typical_of(const bis_texture *x)
{
    const double v = x->invert ? 0.5 : fabs(0.5 * x->scale);
    return (rgbd){v, v, v};
}

/* pbrt-v1 and v2 have row 0 of an image at t = 0, later versions at t = 1: from t to 1 - t. The angle of "spherical"
 * turns back where y does. */
static void turn_over(bis_texture *x)
{
    const int row = x->mapping == BIS_TEXTURE_CYLINDRICAL ? 2 : 1;
    if (x->mapping == BIS_TEXTURE_UV) {
        x->factor[1] = -x->factor[1];
        x->offset[1] = 1 - x->offset[1];
        return;
    }
    for (int k = 0; k < 4; k++) x->from_world[row][k] = -x->from_world[row][k];
    if (x->mapping != BIS_TEXTURE_SPHERICAL) x->from_world[row][3] += 1;
}

/* What is taken for which version, and why. */
static void say_version(bis_parser *p)
{
    if (p->version != BIS_PBRT_V2 || !bis_parser_once(p, "version")) return;
    bis_warn(p->diag, p->name_at, "taken for %s: row 0 of an image texture is at t = 0, and its values are linear "
             "unless \"float gamma\" says otherwise", p->desc->version);
}

/* pbrt-v4's filter is bilinear if it does not say otherwise, as ours; earlier versions look at the footprint. */
static void read_filter(bis_parser *p)
{
    static const char *const earlier[] = {"trilinear", "maxanisotropy"};
    const char *name;
    const bool is_said = bis_params_has(p, "filter");
    const bool is_ours = is_said && bis_params_string(p, "filter", &name) && strcmp(name, "bilinear") == 0;
    if (!is_ours && (is_said || bis_params_has(p, earlier[0]) || bis_params_has(p, earlier[1]) ||
                     bis_parser_predates_v4(p)))
        note_filter(p, "imagemap");
    if (!is_ours && !p->approximate) bis_params_ignore(p, "Texture");
    bis_params_skip(p, earlier, BIS_COUNT(earlier));
}

/* Others share an image with textures of colours. */
static bool may_have_alpha(const char *path)
{
    char ending[8];
    bis_path_extension(ending, path);
    return strcmp(ending, ".png") == 0 || strcmp(ending, ".exr") == 0;
}

static bis_image_meaning meaning_of(bis_parser *p, const bis_texture *x, const char *path)
{
    if (!x->is_float) return BIS_IMAGE_COLOURS;
    if (bis_parser_is_before_v4(p, p->name_at, "an image as numbers", "the mean of its colours, or its alpha",
                                "the luminance of what the file holds, made linear after it"))
        return BIS_IMAGE_LUMINANCE;
    return path && may_have_alpha(path) ? BIS_IMAGE_ALPHA : BIS_IMAGE_COLOURS;
}

static bool read_imagemap(bis_parser *p, bis_texture *x)
{
    static const char *const wraps[] = {"repeat", "clamp", "black"};
    const char *name;
    int wrap = BIS_WRAP_REPEAT;
    double gamma;
    const bool given = bis_params_has(p, "filename");
    bool ok = read_mapping(p, x);

    ok = read_encoding(p, &gamma) && ok;
    ok = read_word(p, "wrap", &wrap, wraps, BIS_COUNT(wraps)) && ok;
    bis_params_float(p, "scale", &x->scale, anything);
    bis_params_bool(p, "invert", &x->invert);
    read_filter(p);
    if (p->version == BIS_PBRT_V2) turn_over(x);
    say_version(p);
    x->kind = BIS_TEXTURE_IMAGE;
    x->wrap = (bis_wrap)wrap;
    x->value = typical_of(x);
    if (!bis_params_string(p, "filename", &name))
        return given ? false : bis_parser_error(p, p->name_at, "Texture \"imagemap\" needs \"string filename\"");
    const bis_loc at = bis_params_at(p, "filename");
    const bis_stand_in no_image = {"an image that is not there", "grey", "an image that cannot be read", false};
    bool lacks;
    char *path = bis_approximate_path(p, &lacks, at, name, &no_image);
    if (!lacks) {
        const bis_texture_file as = {.gamma = gamma, .loc = at, .meaning = meaning_of(p, x, path)};
        return bis_parser_add_image(p, path, &as, &x->image) && ok;
    }
    *x = constant((rgbd){0.5, 0.5, 0.5});
    return ok;
}

static rgbd value_of(const bis_parser *p, uint32_t texture) { return p->desc->textures.list[texture].value; }

static rgbd mixed(rgbd a, rgbd b, double w) { return rgbd_add(rgbd_scale(a, 1 - w), rgbd_scale(b, w)); }

/* One that is made of constants is itself one. */
static void make_of(bis_parser *p, bis_texture *x, bis_texture_kind kind, int n)
{
    rgbd a = value_of(p, x->of[0]), b = value_of(p, x->of[1]);
    bool is_constant = true;

    for (int i = 0; i < n; i++) {
        const bis_texture *part = &p->desc->textures.list[x->of[i]];
        is_constant &= part->kind == BIS_TEXTURE_CONSTANT;
        x->steps += part->steps; /* each at most the limit */
    }
    if (!is_constant) { /* so that parts of both signs do not cancel to 0, which would mean that it is 0 everywhere */
        a = (rgbd){fabs(a.r), fabs(a.g), fabs(a.b)};
        b = (rgbd){fabs(b.r), fabs(b.g), fabs(b.b)};
    }
    x->value = kind == BIS_TEXTURE_SCALE ? (rgbd){a.r * b.r, a.g * b.g, a.b * b.b}
                                         : mixed(a, b, within(value_of(p, x->of[2]).r, unit));
    x->kind = is_constant ? BIS_TEXTURE_CONSTANT : kind;
    if (is_constant) x->steps = 1;
}

/* pbrt-v4's tex and scale, or pbrt-v3's tex1 and tex2. */
static bool read_scale(bis_parser *p, bis_texture *x, bool of_floats)
{
    const bool v4 = bis_params_has(p, "tex") || bis_params_has(p, "scale");
    bool ok = read_part(p, v4 ? "tex" : "tex1", of_floats, 1, anything, &x->of[0]);
    ok = read_part(p, v4 ? "scale" : "tex2", of_floats, 1, anything, &x->of[1]) && ok;
    if (ok) make_of(p, x, BIS_TEXTURE_SCALE, 2);
    return ok;
}

static bool read_mix(bis_parser *p, bis_texture *x, bool of_floats)
{
    bool ok = read_part(p, "tex1", of_floats, 0, anything, &x->of[0]);
    ok = read_part(p, "tex2", of_floats, 1, anything, &x->of[1]) && ok;
    ok = read_part(p, "amount", true, 0.5, unit, &x->of[2]) && ok;
    if (ok) make_of(p, x, BIS_TEXTURE_MIX, 3);
    return ok;
}

/* ---- patterns ---- */

/* The parts of a pattern: their names, what each is if it is not given, and its share in the mean. */
typedef struct pattern {
    const char *part[4];
    double usual[4], share[4];
} pattern;

static const pattern checkers = {{"tex1", "tex2"}, {1, 0}, {0.5, 0.5}};
/* 0.402 of the cells of "dots" (tests/scene/test_procedural.c) hold a disc of radius 0.35 */
static const pattern dots = {{"inside", "outside"}, {1, 0}, {0.155, 0.845}};
static const pattern corners = {{"v00", "v01", "v10", "v11"}, {0, 1, 0, 1}, {0.25, 0.25, 0.25, 0.25}};
static const pattern sides = {{"tex1", "tex2"}, {0, 1}, {0.5, 0.5}}; /* of "directionmix" */

static bool read_pattern(bis_parser *p, bis_texture *x, const pattern *of, bool of_floats)
{
    bool ok = true;
    x->value = (rgbd){0, 0, 0};
    for (int k = 0; k < 4 && of->part[k]; k++) {
        if (!read_part(p, of->part[k], of_floats, of->usual[k], anything, &x->of[k])) {
            ok = false;
            continue;
        }
        const bis_texture *part = &p->desc->textures.list[x->of[k]];
        const rgbd v = {fabs(part->value.r), fabs(part->value.g), fabs(part->value.b)};
        x->value = rgbd_add(x->value, rgbd_scale(v, of->share[k]));
        x->steps += part->steps;
    }
    return ok;
}

static bool read_plane_pattern(bis_parser *p, bis_texture *x, bis_texture_kind kind, const pattern *of, bool of_floats)
{
    const bool ok = read_mapping(p, x);
    x->kind = kind;
    return read_pattern(p, x, of, of_floats) && ok;
}

static bool read_checkerboard(bis_parser *p, bis_texture *x, bool of_floats)
{
    const char *aamode = ""; /* pbrt-v1 to v3: how it is filtered */
    uint64_t dimension = 2;
    const bool given = bis_params_has(p, "dimension");
    bool ok = bis_params_integer(p, "dimension", &dimension, 2, 3) || !given;
    bis_params_string(p, "aamode", &aamode);
    if (dimension == 2 && strcmp(aamode, "none") != 0) note_filter(p, "checkerboard");
    if (dimension == 2) return read_plane_pattern(p, x, BIS_TEXTURE_CHECKERBOARD, &checkers, of_floats) && ok;
    x->kind = BIS_TEXTURE_CHECKERBOARD_3D;
    ok = take_space(p, x, true) && ok;
    return read_pattern(p, x, &checkers, of_floats) && ok;
}

/* uv and marble are colours, as in pbrt. */
static bool is_of_colours(bis_parser *p, bool of_floats, const char *name)
{
    return !of_floats || bis_parser_error(p, p->name_at, "Texture \"%s\" is one of colours: its type must be "
                                          "\"spectrum\" (or \"color\")", name);
}

/* fbm, wrinkled, windy, marble: of pbrt's defaults. */
static bool read_solid(bis_parser *p, bis_texture *x, const bis_choice *chosen, bool of_floats)
{
    const bis_texture_kind kind = (bis_texture_kind)chosen->value;
    uint32_t octaves = 8;
    x->kind = kind;
    note_filter(p, chosen->name);
    x->roughness = 0.5;
    if (kind != BIS_TEXTURE_WINDY) {
        bis_params_uint32(p, "octaves", &octaves, 0, BIS_TEXTURE_MAX_OCTAVES);
        bis_params_float(p, "roughness", &x->roughness, (bis_interval){0, 1e3, false, false});
        x->octaves = octaves;
    }
    if (kind == BIS_TEXTURE_MARBLE) {
        x->variation = 0.2;
        bis_params_float(p, "scale", &x->scale, (bis_interval){-1e30, 1e30, false, false});
        bis_params_float(p, "variation", &x->variation, (bis_interval){-1e30, 1e30, false, false});
    }
    return take_space(p, x, true) && (kind != BIS_TEXTURE_MARBLE || is_of_colours(p, of_floats, "marble"));
}

static bool read_uv_colour(bis_parser *p, bis_texture *x, bool of_floats)
{
    x->kind = BIS_TEXTURE_UV_COLOUR;
    return read_mapping(p, x) && is_of_colours(p, of_floats, "uv");
}

static bool read_constant(bis_parser *p, bis_texture *x, bool of_floats)
{
    uint32_t index;
    const bool ok = read_part(p, "value", of_floats, 1, anything, &index);
    if (ok) x->value = value_of(p, index);
    return ok;
}

/* --approximate: a texture of pbrt's whose parts are known is their mean; the initial 0.5 stays that of others. */
static bool read_mean(bis_parser *p, bis_texture *x, const char *name, bool of_floats)
{
    const bool ok = strcmp(name, "directionmix") != 0 || read_pattern(p, x, &sides, of_floats);
    x->steps = 1;
    for (size_t i = 0; i < p->params.n; i++) p->params.list[i].used = true; /* of its pattern */
    return ok;
}

/* ---- Texture ---- */

static bool read_kind(bis_parser *p, bis_texture *x, const bis_choice *chosen, bool of_floats)
{
    switch (chosen->value) {
    case BIS_FOREIGN:
        return read_mean(p, x, chosen->name, of_floats);
    case BIS_TEXTURE_IMAGE:
        return read_imagemap(p, x);
    case BIS_TEXTURE_SCALE:
        return read_scale(p, x, of_floats);
    case BIS_TEXTURE_MIX:
        return read_mix(p, x, of_floats);
    case BIS_TEXTURE_CHECKERBOARD:
        return read_checkerboard(p, x, of_floats);
    case BIS_TEXTURE_BILERP:
        return read_plane_pattern(p, x, BIS_TEXTURE_BILERP, &corners, of_floats);
    case BIS_TEXTURE_DOTS:
        return read_plane_pattern(p, x, BIS_TEXTURE_DOTS, &dots, of_floats);
    case BIS_TEXTURE_UV_COLOUR:
        return read_uv_colour(p, x, of_floats);
    case BIS_TEXTURE_FBM:
    case BIS_TEXTURE_WRINKLED:
    case BIS_TEXTURE_WINDY:
    case BIS_TEXTURE_MARBLE:
        return read_solid(p, x, chosen, of_floats);
    default:
        return read_constant(p, x, of_floats);
    }
}

static bool is_cheap(bis_parser *p, const bis_texture *x, bis_loc at)
{
    if (x->steps <= BIS_TEXTURE_MAX_STEPS) return true;
    return bis_parser_error(p, at, "a value of texture \"%s\" is made of %u others, must be at most %d: make it of "
                            "fewer, or paint it into an image", bis_parser_word(p, bis_parser_text(p, p->name)),
                            (unsigned)x->steps - 1, BIS_TEXTURE_MAX_STEPS - 1);
}

/* "float", or "spectrum" (pbrt-v4), "color" (pbrt-v2, v3) or "rgb". */
static bool read_type(bis_parser *p, const char *type, bis_loc at, bool *of_floats)
{
    static const char *const types[] = {"float", "spectrum", "color", "rgb"};
    for (size_t i = 0; i < BIS_COUNT(types); i++) {
        if (strcmp(type, types[i]) != 0) continue;
        *of_floats = i == 0;
        return true;
    }
    return bis_parser_error(p, at, "a Texture is of type \"float\" or \"spectrum\" (or \"color\", \"rgb\"), not \"%s\"",
                            bis_parser_word(p, type));
}

/* Known from now on; after a mistake as a constant, so that there is one complaint. */
static void name_texture(bis_parser *p, const bis_texture *x, bool of_floats)
{
    const char *name = bis_parser_text(p, p->name);
    bis_names *names = &p->texture_names[of_floats];
    uint32_t index;

    if (bis_names_find(names, name, NULL))
        bis_warn(p->diag, p->name_at, "texture \"%s\" is defined again: the new one counts from here on",
                 bis_parser_word(p, name));
    if (bis_parser_add_texture(p, x, &index) && !bis_names_set(names, name, index)) bis_parser_nomem(p, p->name_at);
}

void bis_directive_texture(bis_parser *p, bis_loc at)
{
    size_t type, kind;
    bis_loc type_at, kind_at;
    bool of_floats = false, ok = false;

    if (!bis_parser_name(p, "Texture") || !bis_parser_next_name(p, "Texture", &type, &type_at) ||
        !bis_parser_next_name(p, "Texture", &kind, &kind_at) || !bis_params_read(p))
        return;
    if (!read_type(p, bis_parser_text(p, type), type_at, &of_floats)) return;
    bis_texture x = {.value = {0.5, 0.5, 0.5}, .factor = {1, 1}, .scale = 1, .steps = 1, .is_float = of_floats};
    bis_choice kinds[] = {[BIS_TEXTURE_PBRTS] = {"directionmix", BIS_FOREIGN}, {"ptex", BIS_FOREIGN}};
    for (int i = 0; i < BIS_TEXTURE_PBRTS; i++) kinds[i] = (bis_choice){bis_texture_names[i], i};
    const bis_choice *chosen = bis_parser_choose(p, "Texture", bis_parser_text(p, kind), kind_at, kinds,
                                                 BIS_COUNT(kinds));
    if (chosen) {
        p->own_texture = true;
        ok = read_kind(p, &x, chosen, of_floats) && is_cheap(p, &x, at);
        p->own_texture = false;
        bis_params_end(p, "Texture", chosen->name);
    }
    if (!ok) x = constant((rgbd){0.5, 0.5, 0.5});
    name_texture(p, &x, of_floats);
}
