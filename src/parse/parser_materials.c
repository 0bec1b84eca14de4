/* SPDX-License-Identifier: BSD-2-Clause */
/* parser_materials: pbrt's own materials, made of what bis has; docs/scene-format.md, "pbrt's materials", says which
 * are exact and which are near.
 *
 * All of them become GGX facets with Ks = the reflectance head on. Those of metals, plastics and coats follow Fresnel's
 * equations; substrate has Schlick's curve over Ashikhmin and Shirley's base. alpha is what pbrt makes of a roughness;
 * bis_microfacet's own roughness is its square root. */
#include "approximate.h"
#include "bis/base/fresnel.h"
#include "spectrum.h"
#include "bis/beyond/coat.h"
#include "bis/beyond/microfacet.h"
#include "parser_colours.h"
#include "parser_materials.h"
#include "parser_textures.h"

#include <string.h>

static const bis_interval unit = {0, 1, false, false};
static const bis_interval positive_or_0 = {0, HUGE_VAL, false, false};

/* ---- roughness ---- */

/* How pbrt makes alpha of a roughness: v4's square root, or v3's polynomial in the logarithm. */
typedef enum remap { V3, V4 } remap;

static double alpha_of(double roughness, bool remaps, remap how)
{
    return !remaps ? roughness : how == V4 ? sqrt(roughness) : bis_texture_alpha(roughness);
}

/* bis's roughness. What pbrt takes for a perfect mirror (alpha 0) and what is rougher than bis has are brought into
 * its range with a warning. */
static double own_roughness(bis_parser *p, double alpha, bis_loc at)
{
    const double least = BIS_MICROFACET_MIN_ROUGHNESS * BIS_MICROFACET_MIN_ROUGHNESS;
    if (alpha < least && bis_parser_once(p, "smooth"))
        bis_warn(p->diag, at, "a perfect mirror is not modelled: it becomes a lobe with alpha = %g", least);
    if (alpha > 1 && bis_parser_once(p, "rough"))
        bis_warn(p->diag, at, "this roughness has alpha = %.4g; it is taken as 1", alpha);
    return sqrt(fmin(fmax(alpha, least), 1));
}

/* A roughness of the scene: a number, or the mean of a texture's. */
typedef struct rough {
    double value;
    uint32_t texture;
} rough;

static void read_rough(bis_parser *p, const char *name, rough *r)
{
    if (!bis_params_has(p, name)) return;
    r->texture = BIS_NO_TEXTURE;
    bis_params_number(p, name, &r->value, positive_or_0, &r->texture);
}

/* uroughness and vroughness, by default `roughness`, where either is given. They must agree, because one width of the
 * lobe would not look like two; --approximate takes the circle of the ellipse's area, or the one that is a texture. */
static double alpha_of_two(bis_parser *p, rough *r, bool remaps, remap how)
{
    rough u = *r, v = *r;
    read_rough(p, "uroughness", &u);
    read_rough(p, "vroughness", &v);
    *r = u.texture != BIS_NO_TEXTURE ? u : v;
    if (u.texture == v.texture && (u.texture != BIS_NO_TEXTURE || u.value == v.value))
        return alpha_of(u.value, remaps, how);
    const bool varies = r->texture != BIS_NO_TEXTURE;
    const bis_loc at = bis_params_at(p, bis_params_has(p, "vroughness") ? "vroughness" : "uroughness");
    bis_approximate_or_refuse(p, at, "\"uroughness\" and \"vroughness\" that differ",
                              varies ? "a round lobe, as wide as the texture says"
                                     : "a round lobe, its alpha the root of the product of both",
                              "\"uroughness\" and \"vroughness\" differ: anisotropic surfaces are not modelled, give "
                              "both the same value");
    if (varies) return alpha_of(r->value, remaps, how);
    return sqrt(fmax(0, alpha_of(u.value, remaps, how) * alpha_of(v.value, remaps, how)));
}

static double read_roughness(bis_parser *p, double usual, remap how, bis_material_textures *t)
{
    bool remaps = true;
    rough r = {usual, BIS_NO_TEXTURE};
    bis_params_bool(p, "remaproughness", &remaps);
    read_rough(p, "roughness", &r);
    const double alpha = alpha_of_two(p, &r, remaps, how);
    if (r.texture == BIS_NO_TEXTURE) return own_roughness(p, alpha, bis_params_at(p, "roughness"));
    uint32_t texture = r.texture;
    if (remaps && how == V3) {
        const bis_texture x = {.kind = BIS_TEXTURE_ALPHA, .of = {texture}, .value = {alpha, alpha, alpha},
                               .steps = p->desc->textures.list[texture].steps + 1};
        bis_parser_add_texture(p, &x, &texture);
    }
    t->width = texture;
    t->power = remaps && how == V4 ? 0.25 : 0.5; /* roughness = sqrt(alpha) */
    return sqrt(fmin(fmax(alpha, 1e-4), 1));
}

/* ---- Fresnel ---- */

static double head_on(double eta)
{
    const double r = (eta - 1) / (eta + 1);
    return r * r;
}

/* ---- textures of products ---- */

/* A colour or a texture times a factor in [0,1]. */
static void scale_colour(bis_parser *p, rgb *c, uint32_t *texture, double factor)
{
    const bis_texture constant = {.kind = BIS_TEXTURE_CONSTANT, .value = {factor, factor, factor}, .steps = 1};
    bis_texture x = {.kind = BIS_TEXTURE_SCALE, .scale = 1};
    *c = rgb_scale(*c, factor);
    if (*texture == BIS_NO_TEXTURE || factor == 1) return;
    const bis_texture *part = &p->desc->textures.list[*texture];
    x.of[0] = *texture;
    x.value = rgbd_scale(part->value, factor);
    x.steps = part->steps + 2;
    if (bis_parser_add_texture(p, &constant, &x.of[1])) bis_parser_add_texture(p, &x, texture);
}

/* ---- the materials ---- */

/* What bis keeps of eta and k: the reflectance head on, and in each channel the eta whose mean over all directions is
 * that of the spectra (bis_fresnel_eta). */
typedef struct metal {
    const char *name;
    rgb head_on, eta;
} metal;

/* Under D65, from the optical constants of www.luxpop.com, which pbrt and Mitsuba ship, and of the oxides from those
 * that pbrt-v4 ships (src/pbrt/util/spectrum.cpp): sums of Fresnel's equations over the spectrum
 * (tests/scene/test_pbrt_materials.c repeats two of them). Gold's red is 1.0219, outside of RGB, and has no eta. */
static const metal metals[] = {
    {"Ag", {0.97153f, 0.95992f, 0.91533f}, {0.1283f, 0.1270f, 0.1512f}},
    {"Al", {0.91317f, 0.92150f, 0.92445f}, {1.4358f, 0.9308f, 0.5930f}},
    {"Au", {1.00000f, 0.78260f, 0.34342f}, {0.0000f, 0.3994f, 1.5819f}},
    {"Cu", {0.95564f, 0.63756f, 0.53816f}, {0.2328f, 0.9777f, 1.2141f}},
    {"MgO", {0.07204f, 0.07307f, 0.07489f}, {1.7337f, 1.7409f, 1.7535f}},
    {"TiO2", {0.23216f, 0.24476f, 0.27267f}, {2.8596f, 2.9583f, 3.1856f}},
};
enum { ALUMINIUM = 1, GOLD, COPPER };

/* "metal-Cu-eta" with end "eta"? The metal, or NULL. */
static const metal *named_metal(bis_parser *p, const char *name, const char *end)
{
    const bis_param *param = bis_params_find(p, name);
    if (!param || param->type != BIS_TYPE_SPECTRUM || !param->is_strings || param->n != 1) return NULL;
    const char *text = bis_parser_text(p, p->params.strings[param->first]);
    for (size_t i = 0; i < BIS_COUNT(metals); i++) {
        char wanted[32];
        snprintf(wanted, sizeof wanted, "metal-%s-%s", metals[i].name, end);
        if (strcmp(text, wanted) == 0) return &metals[i];
    }
    return NULL;
}

/* A name of a metal that bis has no constants of. --approximate: *m is gold for pbrt's brass, CuZn, else aluminium. */
static bool replace_metal(bis_parser *p, const char *name, metal *m)
{
    char kind[64];
    const bis_param *param = bis_params_find(p, name);
    if (!param || param->type != BIS_TYPE_SPECTRUM || !param->is_strings || param->n != 1) return false;
    const char *text = bis_parser_text(p, p->params.strings[param->first]);
    if (strncmp(text, "metal-", 6) != 0) return false;
    const bool is_brass = strncmp(text, "metal-CuZn-", 11) == 0;
    snprintf(kind, sizeof kind, "\"%s\"", bis_parser_word(p, text));
    *m = metals[is_brass ? GOLD : ALUMINIUM];
    bis_approximate_or_refuse(p, param->at, kind, is_brass ? "gold" : "aluminium",
                              "the metal of \"%s\" is not known; bis has Ag, Al, Au, Cu, MgO and TiO2: give \"rgb "
                              "reflectance\", or eta and k as spectra", bis_parser_word(p, text));
    return true;
}

static const char *const eta_and_k[] = {"eta", "k"};

/* Both as rgb or float: each channel by itself. */
static void conductor_of_rgb(bis_parser *p, metal *m)
{
    rgb eta = {1, 1, 1}, k = {0, 0, 0};
    const bool has_eta = bis_params_rgb(p, "eta", &eta, positive_or_0, true),
               has_k = bis_params_rgb(p, "k", &k, positive_or_0, true);
    if (!bis_params_has(p, "eta") || !bis_params_has(p, "k"))
        bis_parser_error(p, p->name_at, "give both \"eta\" and \"k\", or none (copper), or \"rgb reflectance\"");
    if (!has_eta || !has_k) return;
    const double n[3] = {(double)eta.r, (double)eta.g, (double)eta.b}, a[3] = {(double)k.r, (double)k.g, (double)k.b};
    double F[3];
    for (int i = 0; i < 3; i++)
        F[i] = ((n[i] - 1) * (n[i] - 1) + a[i] * a[i]) / ((n[i] + 1) * (n[i] + 1) + a[i] * a[i]);
    m->head_on = rgb_from(F[0], F[1], F[2]);
    m->eta = eta;
}

/* 0 where no surface reflects R: Schlick's curve, which is then constant. */
static double eta_of(double R, double mean) { return R > 0 && R < 1 ? bis_fresnel_eta(R, mean) : 0; }

static void conductor_of_spectra(bis_parser *p, metal *m)
{
    rgbd F, mean;
    bis_parser_spectrum eta, k;
    const bool has_eta = bis_params_spectrum(p, "eta", &eta), has_k = bis_params_spectrum(p, "k", &k);
    if (has_eta && has_k) {
        bis_spectrum_conductor(&F, &mean, &eta.is, &k.is);
        m->head_on = bis_parser_into_unit(p, F, "eta and k", bis_params_at(p, "eta"));
        m->eta = rgb_from(eta_of(F.r, mean.r), eta_of(F.g, mean.g), eta_of(F.b, mean.b));
    } else if (!bis_params_has(p, "eta") || !bis_params_has(p, "k")) {
        bis_parser_error(p, p->name_at, "give both \"eta\" and \"k\", or none (copper), or \"rgb reflectance\"");
    }
    bis_parser_spectrum_clear(&eta);
    bis_parser_spectrum_clear(&k);
}

static bool is_of_type(bis_parser *p, const char *name, unsigned type)
{
    const bis_param *param = bis_params_find(p, name);
    return param && param->type == type;
}

static metal read_eta_and_k(bis_parser *p)
{
    metal m = metals[COPPER]; /* as in pbrt */
    const metal *eta = named_metal(p, "eta", "eta"), *k = named_metal(p, "k", "k");
    const bool has_eta = bis_params_has(p, "eta"), has_k = bis_params_has(p, "k");
    if (!has_eta && !has_k) return m;
    if ((eta && eta == k) || (eta && !has_k && eta == &metals[COPPER]) || (k && !has_eta && k == &metals[COPPER])) {
        bis_params_skip(p, eta_and_k, 2);
        return eta ? *eta : *k;
    }
    if (eta || k || replace_metal(p, "eta", &m) || replace_metal(p, "k", &m)) {
        if (eta || k)
            bis_parser_error(p, bis_params_at(p, has_k ? "k" : "eta"), "\"eta\" and \"k\" must be of one metal");
        bis_params_skip(p, eta_and_k, 2);
        return m;
    }
    if (is_of_type(p, "eta", BIS_TYPE_SPECTRUM) || is_of_type(p, "k", BIS_TYPE_SPECTRUM)) conductor_of_spectra(p, &m);
    else conductor_of_rgb(p, &m);
    return m;
}

/* Ignored: what only pbrt's random walk in layers needs. */
static void skip_walk(bis_parser *p)
{
    static const char *const walk[] = {"g", "maxdepth", "nsamples"};
    bis_params_skip(p, walk, BIS_COUNT(walk));
}

static bis_material read_conductor(bis_parser *p, bis_material_textures *t, double usual, remap how)
{
    metal m = {.eta = {1, 1, 1}}; /* pbrt-v4's for a reflectance */
    if (bis_params_has(p, "reflectance")) {
        bis_params_colour(p, "reflectance", &m.head_on, unit, &t->Ks);
        if (bis_params_has(p, "eta") || bis_params_has(p, "k"))
            bis_parser_error(p, bis_params_at(p, "reflectance"), "give \"reflectance\", or \"eta\" and \"k\"");
        bis_params_skip(p, eta_and_k, 2);
    } else {
        m = read_eta_and_k(p);
    }
    return bis_microfacet_metal(m.head_on, m.eta, read_roughness(p, usual, how, t));
}

bis_material bis_parser_conductor(bis_parser *p, bis_material_textures *t) { return read_conductor(p, t, 0, V4); }
bis_material bis_parser_metal(bis_parser *p, bis_material_textures *t) { return read_conductor(p, t, 0.01, V3); }

/* What leaves the base: light goes through the coat, is reflected from inside it again and again, and leaves. */
static void into_coat(bis_parser *p, rgb *Kd, uint32_t *texture, double inside)
{
    const double v[3] = {(double)Kd->r, (double)Kd->g, (double)Kd->b};
    bis_texture x = {.kind = BIS_TEXTURE_COAT, .of = {*texture}, .scale = inside};
    double out[3];
    for (int i = 0; i < 3; i++) out[i] = (1 - inside) * v[i] / (1 - inside * v[i]);
    *Kd = rgb_from(out[0], out[1], out[2]);
    if (*texture == BIS_NO_TEXTURE) return;
    x.value = (rgbd){out[0], out[1], out[2]};
    x.steps = p->desc->textures.list[*texture].steps + 1;
    bis_parser_add_texture(p, &x, texture);
}

bis_material bis_parser_coated_diffuse(bis_parser *p, bis_material_textures *t)
{
    rgb Kd = {0.5f, 0.5f, 0.5f};
    rgb albedo = {0, 0, 0};
    double eta = 1.5, thickness = 0.01, in, back;
    uint32_t of_albedo = BIS_NO_TEXTURE;
    bis_params_colour(p, "reflectance", &Kd, unit, &t->Kd);
    bis_params_float(p, "eta", &eta, (bis_interval){1, 10, false, false});
    bis_params_float(p, "thickness", &thickness, positive_or_0);
    bis_params_colour(p, "albedo", &albedo, unit, &of_albedo);
    if (!rgb_is_black(albedo) || of_albedo != BIS_NO_TEXTURE)
        bis_approximate_or_refuse(p, bis_params_at(p, "albedo"), "\"albedo\" of Material \"coateddiffuse\"",
                                  "the coat is clear", "a coat that scatters is not modelled: \"albedo\" must be 0");
    skip_walk(p);
    const double F = head_on(eta), roughness = read_roughness(p, 0, V4, t);
    /* a coat of the base's own index is none, whatever its facets; of a texture of roughness nothing is known yet */
    const bool is_rough = eta > 1 && t->width == BIS_NO_TEXTURE;
    bis_coat_shares(&in, &back, is_rough ? roughness * roughness : 1e-4, eta, thickness);
    into_coat(p, &Kd, &t->Kd, back);
    scale_colour(p, &Kd, &t->Kd, in * in / (eta * eta * (1 - back)));
    return bis_plastic(Kd, rgb_from(F, F, F), eta, roughness);
}

/* pbrt-v3's eta or index of an uber. */
static double read_eta(bis_parser *p)
{
    static const bis_interval range = {0.01, 100, false, false};
    double eta = 1.5;
    if (!bis_params_float(p, "eta", &eta, range)) bis_params_float(p, "index", &eta, range);
    return eta;
}

static bis_material read_plastic(bis_parser *p, bis_material_textures *t, double eta)
{
    rgb Kd = {0.25f, 0.25f, 0.25f}, Ks = {0.25f, 0.25f, 0.25f};
    bis_params_colour(p, "Kd", &Kd, unit, &t->Kd);
    bis_params_colour(p, "Ks", &Ks, unit, &t->Ks);
    scale_colour(p, &Ks, &t->Ks, head_on(eta));
    return bis_plastic(Kd, Ks, eta, read_roughness(p, 0.1, V3, t));
}

bis_material bis_parser_plastic(bis_parser *p, bis_material_textures *t) { return read_plastic(p, t, 1.5); }

bis_material bis_parser_uber(bis_parser *p, bis_material_textures *t)
{
    static const char *const names[] = {"Kr", "Kt", "opacity"};
    static const float none[] = {0, 0, 1};
    static const char *const kinds[] = {"\"Kr\" of Material \"uber\"", "\"Kt\" of Material \"uber\"",
                                        "\"opacity\" of Material \"uber\""};
    for (int i = 0; i < 3; i++) {
        rgb c = {none[i], none[i], none[i]};
        bis_params_rgb(p, names[i], &c, unit, true);
        if (c.r == none[i] && c.g == none[i] && c.b == none[i]) continue;
        bis_approximate_or_refuse(p, bis_params_at(p, names[i]), kinds[i], "Kd and Ks alone are left",
                                  "an \"uber\" that is a mirror or lets light through is not modelled: \"%s\" must "
                                  "be %g", names[i], (double)none[i]);
    }
    return read_plastic(p, t, read_eta(p));
}

bis_material bis_parser_substrate(bis_parser *p, bis_material_textures *t)
{
    rgb Kd = {0.5f, 0.5f, 0.5f}, Ks = {0.5f, 0.5f, 0.5f};
    bis_params_colour(p, "Kd", &Kd, unit, &t->Kd);
    bis_params_colour(p, "Ks", &Ks, unit, &t->Ks);
    return bis_microfacet(Kd, Ks, read_roughness(p, 0.1, V3, t));
}
