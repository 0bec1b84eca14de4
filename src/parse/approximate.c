/* approximate: what `--approximate` replaces.
 *
 * Every kind is noted once, with its number and what the picture lacks by it: bis_scene_desc keeps the list, and the
 * terminal, the EXR and --stats tell it. */
#include "approximate.h"

#include <stdarg.h>
#include <string.h>

#define LIGHT_MISSING "its light is missing"
#define THROUGH_MISSING "a mirror of its reflectance; what it lets through is black"
#define UNDER_MISSING "diffuse under a smooth coat; light enters and leaves at one point"
#define GREY "diffuse grey; its file is not read"
#define EMPTY "there is no medium; nothing dims or scatters light"
#define SHAPE_MISSING "left out: it is not seen and casts no shadow"
#define NOT_USED "ignored: the methods of bis are its own"
#define MEAN "one value all over, the mean of its parts"
#define HALF "one value all over, 0.5"

typedef struct replaced {
    const char *directive, *name, *consequence; /* name NULL: whatever name follows */
} replaced;

static const replaced table[] = {
    {"AreaLightSource", NULL, LIGHT_MISSING},
    {"LightSource", "point", LIGHT_MISSING},
    {"LightSource", "spot", LIGHT_MISSING},
    {"LightSource", "distant", LIGHT_MISSING},
    {"LightSource", "goniometric", LIGHT_MISSING},
    {"LightSource", "projection", LIGHT_MISSING},
    {"LightSource", "diffuse", LIGHT_MISSING},
    {"LightSource", "a second", "left out: only the first gives light"},
    {"Material", "dielectric", THROUGH_MISSING},
    {"Material", "thindielectric", THROUGH_MISSING},
    {"Material", "glass", THROUGH_MISSING},
    {"Material", "mirror", "a smooth metal; its reflections are blurred by two degrees"},
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
    {"SurfaceIntegrator", NULL, NOT_USED},
    {"VolumeIntegrator", NULL, NOT_USED},
    {"Renderer", NULL, NOT_USED},
    {"SearchPath", NULL, "ignored: paths are relative to the file that names them"},
    {"ColorSpace", NULL, "taken for srgb: colours are off"},
    {"Film", "gbuffer", "an ordinary film: give the layers by --layers"},
    {"Film", "spectral", "an ordinary film"},
    {"Shape", "curve", SHAPE_MISSING},
    {"Shape", "cylinder", SHAPE_MISSING},
    {"Shape", "cone", SHAPE_MISSING},
    {"Shape", "paraboloid", SHAPE_MISSING},
    {"Shape", "hyperboloid", SHAPE_MISSING},
    {"Shape", "heightfield", SHAPE_MISSING},
    {"Shape", "nurbs", SHAPE_MISSING},
    {"Shape", "loopsubdiv", "its control mesh: coarser, and a little too large"},
    {"Shape", "bilinearmesh", "two flat triangles a patch"},
    {"Texture", "bilerp", MEAN},
    {"Texture", "directionmix", MEAN},
    {"Texture", "dots", MEAN},
    {"Texture", "fbm", HALF},
    {"Texture", "marble", HALF},
    {"Texture", "ptex", "one value all over, 0.5; its file is not read"},
    {"Texture", "uv", HALF},
    {"Texture", "windy", HALF},
    {"Texture", "wrinkled", HALF},
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

static void note(bis_parser *p, bis_loc at, const char *consequence, const char *kind)
{
    bis_scene_desc *d = p->desc;

    for (size_t i = 0; i < d->n_approximations; i++) {
        if (strcmp(d->approximations[i].kind, kind) != 0) continue;
        d->approximations[i].n++;
        return;
    }
    if (!BIS_ROOM(d->approximations, d->capacity_approximations, d->n_approximations)) {
        bis_parser_nomem(p, at);
        return;
    }
    bis_approximation *a = &d->approximations[d->n_approximations++];
    *a = (bis_approximation){.n = 1, .consequence = consequence, .loc = at};
    snprintf(a->kind, sizeof a->kind, "%s", kind);
}

void bis_approximate_note(bis_parser *p, bis_loc at, const char *consequence, const char *fmt, ...)
{
    char kind[BIS_APPROXIMATION_KIND];
    va_list args;

    va_start(args, fmt);
    vsnprintf(kind, sizeof kind, fmt, args);
    va_end(args);
    note(p, at, consequence, kind);
}

bool bis_approximate(bis_parser *p, const char *directive, const char *name, bis_loc at)
{
    const replaced *r = p->approximate ? find(directive, name) : NULL;

    if (!r) return false;
    if (r->name) bis_approximate_note(p, at, r->consequence, "%s \"%s\"", directive, r->name);
    else note(p, at, r->consequence, directive);
    return true;
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
        note(p, at, consequence, kind);
        return true;
    }
    va_start(args, fmt);
    vsnprintf(text, sizeof text, fmt, args);
    va_end(args);
    return bis_parser_error(p, at, "%s; with --approximate: %s", text, consequence);
}
