/* SPDX-License-Identifier: BSD-2-Clause */
/* approximate_materials: the nearest that bis has to pbrt's materials, and what is made of them at the end.
 *
 * Reflectances are those of pbrt's defaults where the scene does not say. Of what lets light through only the
 * reflection is left: it is the smooth or rough mirror of GGX facets with the reflectance of glass at normal incidence,
 * ((eta - 1)/(eta + 1))^2. What is perfectly smooth gets the roughness SMOOTH: a lobe of some two degrees, because a
 * narrower one is noisier and shows no more of a map of usual size. */
#include "approximate.h"
#include "parser_ask.h"
#include "parser_colours.h"

#include "bis/base/mem.h"
#include "bis/beyond/microfacet.h"
#include "bis/thesis/phong.h"

#include <string.h>

#define SMOOTH 0.1

/* A colour or number of the scene, clamped to [0, 1], of a texture its mean; what is missing is the default. */
static rgb colour(bis_parser *p, const char *name, double usual)
{
    const bis_param *param = bis_params_find(p, name);
    rgbd mean;
    rgb value = {(float)usual, (float)usual, (float)usual};
    if (param && param->type & BIS_TYPES_OF_COLOUR) {
        bis_params_reflectance(p, name, &value);
        return value;
    }
    if (bis_params_mean(p, name, &mean))
        return rgb_from(fmin(fmax(mean.r, 0), 1), fmin(fmax(mean.g, 0), 1), fmin(fmax(mean.b, 0), 1));
    const bool is_rgb = param && param->type == BIS_TYPE_RGB && param->n == 3;
    const bool is_grey = param && param->type == BIS_TYPE_FLOAT && param->n == 1;
    double v[3] = {usual, usual, usual};

    for (int i = 0; i < 3 && (is_rgb || is_grey); i++)
        v[i] = fmin(fmax(p->params.numbers[param->first + (is_rgb ? (size_t)i : 0)], 0), 1);
    return rgb_from(v[0], v[1], v[2]);
}

static double number(bis_parser *p, const char *name, double usual)
{
    const bis_param *param = bis_params_find(p, name);
    rgbd mean;
    if (bis_params_mean(p, name, &mean)) return rgbd_sum(mean) / 3;
    return param && param->type == BIS_TYPE_FLOAT && param->n == 1 ? p->params.numbers[param->first] : usual;
}

/* pbrt's roughness as ours: pbrt-v4's alpha is sqrt(roughness), or roughness itself without remapping; ours is the
 * square of ours. */
static double roughness(bis_parser *p, const char *name, double usual)
{
    const bis_param *remap = bis_params_find(p, "remaproughness");
    const bool says = remap && remap->type == BIS_TYPE_BOOL && remap->n == 1;
    const bool is_alpha = says && !(p->params.numbers[remap->first] > 0);
    const double both = number(p, name, usual);
    const double u = number(p, "uroughness", both), v = number(p, "vroughness", both);
    const double r = sqrt(fmax(u, 0) * fmax(v, 0)); /* of a lobe longer than wide: the circle of its area */
    if (!(r > 0)) return SMOOTH;
    return fmin(fmax(is_alpha ? sqrt(r) : sqrt(sqrt(r)), BIS_MICROFACET_MIN_ROUGHNESS), 1);
}

/* The reflectance of an interface at normal incidence. */
static double fresnel(bis_parser *p)
{
    const double eta = number(p, "eta", number(p, "index", 0));
    const double r = eta > 0 ? (eta - 1) / (eta + 1) : 0.2; /* that of the usual index, 1.5 */
    return r * r;
}

static rgb rest_of(rgb share) { return rgb_from(1 - (double)share.r, 1 - (double)share.g, 1 - (double)share.b); }

static rgb black(void) { return (rgb){0, 0, 0}; }

static bis_material diffuse(rgb Kd) { return bis_phong(Kd, black(), 50); }

static bool has(bis_parser *p, const char *name) { return bis_params_find(p, name) != NULL; }

static bis_material disney(bis_parser *p)
{
    const rgb base = colour(p, "color", 0.5);
    const double metallic = fmin(fmax(number(p, "metallic", 0), 0), 1), dielectric = fmin(fresnel(p), 1);
    const rgb Ks = rgb_add(rgb_scale(base, metallic), rgb_scale((rgb){1, 1, 1}, dielectric * (1 - metallic)));
    const double r = fmin(fmax(number(p, "roughness", 0.5), BIS_MICROFACET_MIN_ROUGHNESS), 1);
    return bis_microfacet(rgb_scale(base, 1 - metallic), Ks, r); /* Disney's alpha is a square, too */
}

static bis_material of_table(bis_parser *p, const char *name)
{
    const double R = fmin(fresnel(p), 1), rough = roughness(p, "roughness", 0);
    const rgb white = {1, 1, 1}, Kd = colour(p, has(p, "Kd") ? "Kd" : "reflectance", 0.5);

    if (strcmp(name, "dielectric") == 0) return bis_microfacet(black(), rgb_scale(white, R), rough);
    if (strcmp(name, "glass") == 0) return bis_microfacet(black(), rgb_scale(colour(p, "Kr", 1), R), rough);
    if (strcmp(name, "thindielectric") == 0) /* both sides, and all reflections between them */
        return bis_microfacet(black(), rgb_scale(white, 2 * R / (1 + R)), SMOOTH);
    if (strcmp(name, "mirror") == 0)
        return bis_microfacet(black(), colour(p, "Kr", 0.9), SMOOTH);
    if (strcmp(name, "shinymetal") == 0)
        return bis_microfacet(black(), rgb_scale(rgb_add(colour(p, "Ks", 1), colour(p, "Kr", 1)), 0.5),
                              roughness(p, "roughness", 0.1));
    if (strcmp(name, "coatedconductor") == 0)
        return bis_microfacet(black(), colour(p, "reflectance", 0.9), roughness(p, "conductor.roughness", 0));
    if (strcmp(name, "disney") == 0) return disney(p);
    if (strcmp(name, "diffusetransmission") == 0) return diffuse(colour(p, "reflectance", 0.25));
    if (strcmp(name, "translucent") == 0) {
        const rgb back = colour(p, "reflect", 0.5), Ks = rgb_scale(colour(p, "Ks", 0.25), R);
        return bis_microfacet(rgb_mul(colour(p, "Kd", 0.25), back), rgb_mul(Ks, back), roughness(p, "roughness", 0.1));
    }
    if (strcmp(name, "subsurface") == 0 || strcmp(name, "kdsubsurface") == 0)
        return bis_microfacet(Kd, rgb_scale(white, R), rough);
    if (strcmp(name, "hair") == 0) return diffuse(colour(p, has(p, "color") ? "color" : "reflectance", 0.2));
    return diffuse(rgb_scale(white, 0.5)); /* measured, fourier */
}

/* A copy of name i of a parameter, or NULL. */
static char *name_of(bis_parser *p, const char *parameter, size_t i)
{
    const bis_param *param = bis_params_find(p, parameter);
    if (!param || param->type != BIS_TYPE_STRING || i >= param->n) return NULL;
    return bis_strdup(bis_parser_text(p, p->params.strings[param->first + i]));
}

static bool has_names(bis_parser *p, const char *parameter, size_t n)
{
    const bis_param *param = bis_params_find(p, parameter);
    return param && param->type == BIS_TYPE_STRING && param->n == n;
}

/* pbrt-v4's "materials" and "amount", the share of the second; pbrt-v3's and v2's two names, and the share of the
 * first. */
static void note_mix(bis_parser *p, uint32_t index)
{
    const bool is_v4 = has_names(p, "materials", 2);
    const rgb amount = colour(p, "amount", 0.5);

    if (!is_v4 && !(has_names(p, "namedmaterial1", 1) && has_names(p, "namedmaterial2", 1))) {
        bis_parser_error(p, p->name_at, "Material \"mix\" needs the names of two materials, \"string materials\" [A B] "
                                        "or \"string namedmaterial1\" and \"string namedmaterial2\"");
        return;
    }
    if (!BIS_ROOM(p->mixes, p->capacity_mixes, p->n_mixes)) {
        bis_parser_nomem(p, p->name_at);
        return;
    }
    bis_mix *mix = &p->mixes[p->n_mixes++];
    *mix = (bis_mix){.index = index, .at = p->name_at};
    mix->share = is_v4 ? rest_of(amount) : amount;
    mix->name[0] = name_of(p, is_v4 ? "materials" : "namedmaterial1", 0);
    mix->name[1] = name_of(p, is_v4 ? "materials" : "namedmaterial2", is_v4);
    if (!mix->name[0] || !mix->name[1]) bis_parser_nomem(p, p->name_at);
}

static bool is_interface(const char *name)
{
    return !*name || strcmp(name, "none") == 0 || strcmp(name, "interface") == 0;
}

bis_material bis_approximate_material(bis_parser *p, const char *name, uint32_t index)
{
    const bis_material m = of_table(p, name);

    if (strcmp(name, "mix") == 0) note_mix(p, index);
    return is_interface(name) ? (bis_material){.model = NULL} : m;
}

static rgb blend(rgb a, rgb b, rgb share) { return rgb_add(rgb_mul(a, share), rgb_mul(b, rest_of(share))); }

/* The mean colours, with the model and the lobe of the one that reflects more by its lobe. */
static bis_material mixed(const bis_material *a, const bis_material *b, rgb share)
{
    const bool first = rgb_sum(rgb_mul(a->Ks, share)) >= rgb_sum(rgb_mul(b->Ks, rest_of(share)));
    bis_material m = first ? *a : *b;

    if (!a->model || !b->model) return a->model ? *a : *b; /* of an interface nothing is seen */
    m.Kd = blend(a->Kd, b->Kd, share);
    m.Ks = blend(a->Ks, b->Ks, share);
    m.eta = black(); /* no metal has the mean of two colours; Schlick's curve does for all */
    if (m.model == &bis_plastic_model) m.model = &bis_microfacet_model;
    return m;
}

static bool is_open(const bis_parser *p, uint32_t index)
{
    for (size_t i = 0; i < p->n_mixes; i++)
        if (!p->mixes[i].done && p->mixes[i].index == index) return true;
    return false;
}

/* From names to numbers. False: a material is not made. */
static bool find_components(bis_parser *p)
{
    for (size_t i = 0; i < p->n_mixes; i++) {
        for (int k = 0; k < 2; k++) {
            const char *name = p->mixes[i].name[k];
            uint32_t n;
            if (!name) return false; /* no memory: said already */
            if (!bis_names_find(&p->material_names, name, &n) || !p->named[n].made.line)
                return bis_parser_error(p, p->mixes[i].at, "material \"%s\" is not made anywhere%s",
                                        bis_parser_word(p, name),
                                        bis_parser_hint(p, bis_names_nearest(&p->material_names, name)));
            p->mixes[i].of[k] = p->named[n].index;
        }
    }
    return true;
}

/* A mix may be of mixes that stand behind it: as many rounds as they are deep. */
static void mix_materials(bis_parser *p)
{
    bis_material *m = p->desc->materials;
    if (!find_components(p)) return;
    for (bool any = true; any;) {
        any = false;
        for (size_t i = 0; i < p->n_mixes; i++) {
            bis_mix *x = &p->mixes[i];
            if (x->done || is_open(p, x->of[0]) || is_open(p, x->of[1])) continue;
            m[x->index] = mixed(&m[x->of[0]], &m[x->of[1]], x->share);
            any = x->done = true;
        }
    }
    for (size_t i = 0; i < p->n_mixes; i++) {
        if (p->mixes[i].done) continue;
        bis_parser_error(p, p->mixes[i].at, "Material \"mix\" is, by its names, a mix of itself");
        return;
    }
}

static void leave_out_interfaces(bis_parser *p)
{
    bis_scene_desc *d = p->desc;
    size_t n = 0;

    for (size_t i = 0; i < d->n_shapes; i++)
        if (d->materials[d->shapes[i].material].model) d->shapes[n++] = d->shapes[i];
    d->n_shapes = n;
    for (size_t i = 0; i < d->n_materials; i++)
        if (!d->materials[i].model) d->materials[i] = d->materials[0];
}

void bis_approximate_finish_materials(bis_parser *p)
{
    if (!p->approximate) return;
    mix_materials(p);
    leave_out_interfaces(p);
}

void bis_approximate_clear(bis_parser *p)
{
    bis_free(p->notes);
    for (size_t i = 0; i < p->n_mixes; i++) {
        bis_free(p->mixes[i].name[0]);
        bis_free(p->mixes[i].name[1]);
    }
    bis_free(p->mixes);
    bis_names_clear(&p->missing);
}
