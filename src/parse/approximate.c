/* SPDX-License-Identifier: BSD-2-Clause */
/* approximate: what `--approximate` replaces.
 *
 * Every kind is noted once, with its number and what the picture lacks by it: bis_scene_desc keeps the list, and the
 * terminal, the EXR and --stats tell it. */
#include "approximate.h"

#include <stdarg.h>
#include <string.h>

#define LIGHT_MISSING "its light is missing"
#define THROUGH_MISSING "a mirror of its reflectance; what it lets through, and other surfaces in it, are black"
#define UNDER_MISSING "diffuse under a smooth coat; light enters and leaves at one point"
#define GREY "diffuse grey; its file is not read"
#define EMPTY "there is no medium; nothing dims or scatters light"
#define SHAPE_MISSING "left out: it is not seen and casts no shadow"
#define ONE_BOUNCE "one bounce: light that surfaces reflect onto each other is missing"
#define NOT_USED "ignored: the methods of bis are its own"
#define MEAN "one value all over, the mean of its parts"
#define HALF "one value all over, 0.5"
#define OTHER_CAMERA "a perspective camera with its fov: it shows another part of the scene"

typedef struct replaced {
    const char *directive, *name, *consequence; /* name NULL: whatever name follows */
} replaced;

static const replaced table[] = {
    {"AreaLightSource", NULL, LIGHT_MISSING},
    {"LightSource", "point", LIGHT_MISSING},
    {"LightSource", "spot", LIGHT_MISSING},
    {"LightSource", "distant", "a disc in the map, half a degree wide, of the same irradiance"},
    {"LightSource", "goniometric", LIGHT_MISSING},
    {"LightSource", "projection", LIGHT_MISSING},
    {"LightSource", "diffuse", LIGHT_MISSING},
    {"LightSource", "a second", "left out: only the first gives light"},
    {"Material", "dielectric", THROUGH_MISSING},
    {"Material", "thindielectric", THROUGH_MISSING},
    {"Material", "glass", THROUGH_MISSING},
    {"Material", "mirror", "a smooth metal that shows the map, blurred by two degrees; other surfaces in it are black"},
    {"Material", "shinymetal", "a metal of facets, with the colours of both of its reflections"},
    {"Material", "coatedconductor", "the metal under the coat alone"},
    {"Material", "disney", "facets over a diffuse base; sheen, clearcoat and transmission are missing"},
    {"Material", "diffusetransmission", "its reflection alone; light from behind is missing"},
    {"Material", "translucent", "its reflection alone; light from behind is missing"},
    {"Material", "subsurface", UNDER_MISSING},
    {"Material", "kdsubsurface", UNDER_MISSING},
    {"Material", "measured", GREY},
    {"Material", "fourier", GREY},
    {"Material", "hair", "diffuse in the colour of the hair"},
    {"Material", "mix", "one material with the mean colours and the lobe of the stronger one"},
    {"Material", "interface", "its shapes are left out: light passes them unchanged"},
    {"Material", "none", "its shapes are left out: light passes them unchanged"},
    {"Material", "", "its shapes are left out: light passes them unchanged"},
    {"MakeNamedMedium", NULL, EMPTY},
    {"MediumInterface", NULL, EMPTY},
    {"Volume", NULL, EMPTY},
    {"ActiveTransform", NULL, "nothing moves: all stand where they are when the shutter opens"},
    {"TransformTimes", NULL, "nothing moves: all stand where they are when the shutter opens"},
    {"Attribute", NULL, "ignored: its parameters are not taken"},
    {"Import", NULL, "read as Include"},
    {"SurfaceIntegrator", NULL, ONE_BOUNCE},
    {"VolumeIntegrator", NULL, NOT_USED},
    {"Renderer", NULL, NOT_USED},
    {"SearchPath", NULL, "ignored: files are looked for beside the scene"},
    {"ColorSpace", NULL, "taken for srgb: colours are off"},
    {"Camera", "realistic", OTHER_CAMERA},
    {"Camera", "environment", OTHER_CAMERA},
    {"Camera", "spherical", OTHER_CAMERA},
    {"Film", "gbuffer", "an ordinary film: give the layers by --layers"},
    {"Film", "spectral", "an ordinary film"},
    {"Shape", "curve", SHAPE_MISSING},
    {"Texture", "directionmix", MEAN},
    {"Texture", "ptex", "one value all over, 0.5; its file is not read"},
};

static const replaced *find(const char *directive, const char *name)
{
    for (size_t i = 0; i < BIS_COUNT(table); i++) {
        const replaced *r = &table[i];
        if (strcmp(r->directive, directive) == 0 && (!r->name || (name && strcmp(r->name, name) == 0))) return r;
    }
    return NULL;
}

/* ---- the list ---- */

/* What a directive's replacements do to the picture, and what there are others of. */
static const struct effect_row {
    const char *directive, *among;
    bis_effect effect;
} effects[] = {
    {"LightSource", "lights", BIS_EFFECT_LIGHT},         {"AreaLightSource", "lights", BIS_EFFECT_LIGHT},
    {"Shape", "shapes", BIS_EFFECT_SHAPE},               {"Material", "materials", BIS_EFFECT_MATERIAL},
    {"MakeNamedMaterial", "materials", BIS_EFFECT_MATERIAL}, {"NamedMaterial", NULL, BIS_EFFECT_MATERIAL},
    {"Texture", "textures", BIS_EFFECT_TEXTURE},         {"ObjectInstance", NULL, BIS_EFFECT_SHAPE},
    {"MakeNamedMedium", NULL, BIS_EFFECT_SHAPE},         {"MediumInterface", NULL, BIS_EFFECT_SHAPE},
    {"Volume", NULL, BIS_EFFECT_SHAPE},
};

static const struct effect_row *find_effect(const char *directive)
{
    static const struct effect_row other = {"", NULL, BIS_EFFECT_SETTING};
    for (size_t i = 0; i < BIS_COUNT(effects); i++)
        if (strcmp(effects[i].directive, directive) == 0) return &effects[i];
    return &other;
}

const char *bis_approximate_begin(bis_parser *p, const char *directive)
{
    if (!p->approximate) return ""; /* nobody asks */
    const struct effect_row *row = find_effect(directive);
    if (row->among) p->n_of[row->effect]++;
    return row->directive;
}

/* One more of its kind. */
static void count_one(bis_parser *p, bis_approximation **list, size_t *n, size_t *capacity,
                      const bis_approximation *one)
{
    for (size_t i = 0; i < *n; i++) {
        if (strcmp((*list)[i].kind, one->kind) != 0) continue;
        (*list)[i].n++;
        return;
    }
    if (!bis_room(list, capacity, *n + 1, sizeof **list)) bis_parser_nomem(p, one->loc);
    else (*list)[(*n)++] = *one;
}

static void note(bis_parser *p, bis_loc at, bis_effect effect, const char *consequence, const char *kind)
{
    bis_scene_desc *d = p->desc;
    const struct effect_row *row = find_effect(p->directive);
    /* a light or shape that lacks a parameter is there */
    if (effect < BIS_EFFECT_MATERIAL && strncmp(kind, "parameter ", 10) == 0) effect = BIS_EFFECT_SETTING;
    bis_approximation one = {.n = 1, .consequence = consequence, .loc = at, .effect = effect};

    one.among = row->effect == effect ? row->among : NULL;
    snprintf(one.kind, sizeof one.kind, "%s", kind);
    count_one(p, &d->approximations, &d->n_approximations, &d->capacity_approximations, &one);
}

static bis_effect effect_now(const bis_parser *p) { return find_effect(p->directive)->effect; }

void bis_approximate_note(bis_parser *p, bis_loc at, const char *consequence, const char *fmt, ...)
{
    char kind[BIS_APPROXIMATION_KIND];
    va_list args;

    va_start(args, fmt);
    vsnprintf(kind, sizeof kind, fmt, args);
    va_end(args);
    note(p, at, effect_now(p), consequence, kind);
}

char *bis_approximate_path(bis_parser *p, bool *lacks, bis_loc at, const char *name, const bis_stand_in *other)
{
    const char *kind;
    char *path = bis_parser_path_or(p, &kind, at, name, other);
    *lacks = kind != NULL;
    if (kind) bis_approximate_note(p, at, other->consequence, "%s", kind);
    return path;
}

void bis_approximate_pass(bis_parser *p, bis_loc at, const char *consequence, const char *fmt, ...)
{
    bis_approximation one = {.n = 1, .consequence = consequence, .loc = at, .effect = BIS_EFFECT_SETTING};
    va_list args;

    va_start(args, fmt);
    vsnprintf(one.kind, sizeof one.kind, fmt, args);
    va_end(args);
    if (p->approximate) note(p, at, BIS_EFFECT_SETTING, consequence, one.kind);
    else count_one(p, &p->notes, &p->n_notes, &p->capacity_notes, &one);
}

bool bis_approximate(bis_parser *p, const char *directive, const char *name, bis_loc at)
{
    const replaced *r = p->approximate ? find(directive, name) : NULL;

    if (!r) return false;
    if (r->name) bis_approximate_note(p, at, r->consequence, "%s \"%s\"", directive, r->name);
    else note(p, at, find_effect(directive)->effect, r->consequence, directive);
    return true;
}

/* What a name that nobody knows becomes; consequence NULL: the caller notes it. */
static const struct unknown {
    const char *directive, *instead, *consequence;
} unknowns[] = {
    {"Material", "matte", "matte, as in pbrt"},
    {"Shape", "curve", SHAPE_MISSING},
    {"LightSource", "point", LIGHT_MISSING},
    {"Texture", "ptex", HALF},
    {"Integrator", "path", NULL},
    {"Camera", "realistic", OTHER_CAMERA},
    {"Sampler", "sobol", "\"sobol\""},
    {"Film", "rgb", "an ordinary film"},
    {"Accelerator", "bvh", "the default"},
    {"PixelFilter", "triangle", NULL},
};

const char *bis_approximate_unknown(bis_parser *p, const char *directive, const char *name, bis_loc at)
{
    for (size_t i = 0; i < BIS_COUNT(unknowns) && p->approximate; i++) {
        const struct unknown *u = &unknowns[i];
        if (strcmp(u->directive, directive) != 0) continue;
        if (u->consequence)
            bis_approximate_note(p, at, u->consequence, "unknown %s \"%s\"", directive, bis_parser_word(p, name));
        return u->instead;
    }
    return NULL;
}

void bis_approximate_integrator(bis_parser *p, bis_loc at, const char *directive, const char *name)
{
    static const char *const direct[] = {"directlighting", "whitted"}, *const occlusion[] = {"ao", "ambientocclusion"};
    char kind[BIS_APPROXIMATION_KIND];
    const char *consequence = ONE_BOUNCE;
    bis_effect effect = BIS_EFFECT_INDIRECT;

    for (size_t i = 0; i < 2; i++) {
        if (strcmp(name, direct[i]) == 0) consequence = "one bounce: what mirrors and glass show of other surfaces is "
                                                        "missing";
        if (strcmp(name, occlusion[i]) != 0) continue;
        consequence = "the scene's own light and materials are shown instead";
        effect = BIS_EFFECT_SETTING;
    }
    snprintf(kind, sizeof kind, "%s \"%s\"", directive, bis_parser_word(p, name));
    note(p, at, effect, consequence, kind);
}

const char *bis_approximate_unknown_hint(bis_parser *p, const char *directive)
{
    for (size_t i = 0; i < BIS_COUNT(unknowns) && !p->approximate; i++) {
        const struct unknown *u = &unknowns[i];
        if (strcmp(u->directive, directive) != 0 || !u->consequence) continue;
        snprintf(p->way_out, sizeof p->way_out, "; with --approximate: %s", u->consequence);
        return p->way_out;
    }
    return "";
}

const char *bis_approximate_hint(bis_parser *p, const char *directive, const char *name)
{
    const replaced *r = p->approximate ? NULL : find(directive, name);

    if (!r) return "";
    snprintf(p->way_out, sizeof p->way_out, "; with --approximate: %s", r->consequence);
    return p->way_out;
}

bool bis_approximate_or_refuse(bis_parser *p, bis_loc at, const char *kind, const char *consequence, const char *fmt,
                               ...)
{
    char text[512];
    va_list args;

    if (p->approximate) {
        note(p, at, effect_now(p), consequence, kind);
        return true;
    }
    va_start(args, fmt);
    vsnprintf(text, sizeof text, fmt, args);
    va_end(args);
    return bis_parser_error(p, at, "%s; with --approximate: %s", text, consequence);
}

void bis_approximate_sky(bis_parser *p)
{
    note(p, (bis_loc){p->desc->files[0], 0, 0}, BIS_EFFECT_SKY,
         "a white sky of radiance 1 is used; bis render --light MAP takes another", "no light from infinity");
}

/* ---- the end ---- */

/* Stable, and there are a few dozen at most. */
static void sort_by_effect(bis_approximation *list, size_t n)
{
    for (size_t i = 1; i < n; i++) {
        const bis_approximation one = list[i];
        size_t k = i;
        for (; k > 0 && list[k - 1].effect > one.effect; k--) list[k] = list[k - 1];
        list[k] = one;
    }
}

static void warn_of_each(bis_parser *p, bis_approximation *list, size_t n, const char *word)
{
    char text[BIS_APPROXIMATION_TEXT];

    for (size_t i = 0; i < n; i++) {
        if (list[i].among) list[i].of = p->n_of[list[i].effect];
        bis_warn(p->diag, list[i].loc, "%s%s", word, bis_approximation_text(text, &list[i]));
    }
}

void bis_approximate_finish(bis_parser *p)
{
    bis_scene_desc *d = p->desc;

    for (unsigned i = 0; i < p->n_rests; i++)
        note(p, p->rest_at, BIS_EFFECT_SETTING, "the number at its beginning, as in pbrt",
             "a number and more in one word");
    warn_of_each(p, p->notes, p->n_notes, "");
    if (!d->n_approximations) return;
    sort_by_effect(d->approximations, d->n_approximations);
    warn_of_each(p, d->approximations, d->n_approximations, "approximated: ");
}
