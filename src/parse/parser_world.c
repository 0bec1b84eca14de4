/* SPDX-License-Identifier: BSD-2-Clause */
/* parser_world: the materials. */
#include "bis/beyond/microfacet.h"
#include "bis/thesis/phong.h"
#include "base/grow.h"
#include "approximate.h"
#include "directives.h"
#include "parser_materials.h"
#include "parser_shapes.h"
#include "parser_textures.h"
#include "parser_version.h"

#include <float.h>
#include <string.h>

static const bis_interval unit = {0, 1, false, false};
static const bis_interval positive_or_0 = {0, HUGE_VAL, false, false};

void bis_parser_warn_energy(bis_parser *p, bis_loc at, rgb Kd, rgb Ks)
{
    const double sum[3] = {(double)Kd.r + (double)Ks.r, (double)Kd.g + (double)Ks.g, (double)Kd.b + (double)Ks.b};
    /* 0.6 and 0.4 as floats sum to 1 + 3e-8: each is rounded by half an ulp of its own, together at most this */
    const double one = 1 + (double)FLT_EPSILON / 2;
    for (int i = 0; i < 3; i++) {
        if (sum[i] <= one) continue;
        bis_warn(p->diag, at, "Kd + Ks is %.7g in %s: the material reflects more light than it receives. Make one of "
                 "them smaller",
                 sum[i], (const char *const[]){"red", "green", "blue"}[i]);
        return;
    }
}

/* A model of ours: each value is a number, a colour or a texture, as the model's ranges and defaults say. */
static bis_material read_model(bis_parser *p, bis_material_textures *t, const bis_bsdf_model *model)
{
    const bis_material none = {.model = model};
    const bis_bsdf_width w = model->width(&none);
    rgb Kd = model->usual.Kd, Ks = model->usual.Ks;
    double width = model->usual.width;
    bis_params_colour(p, "Kd", &Kd, unit, &t->Kd);
    if (w.scene_name) {
        bis_params_colour(p, "Ks", &Ks, unit, &t->Ks);
        bis_params_number(p, w.scene_name, &width, (bis_interval){w.least, w.most, false, false}, &t->width);
    }
    /* with textures: when their images are known, by bis_textures_check */
    if (model->gains_beyond_1 && t->Kd == BIS_NO_TEXTURE && t->Ks == BIS_NO_TEXTURE)
        bis_parser_warn_energy(p, p->name_at, Kd, Ks);
    return model->remake(&none, Kd, Ks, &width);
}

static bis_material read_diffuse(bis_parser *p, bis_material_textures *t)
{
    rgb Kd = {0.5f, 0.5f, 0.5f};
    double sigma = 0;
    if (bis_params_colour(p, "reflectance", &Kd, unit, &t->Kd) && bis_params_has(p, "Kd"))
        bis_parser_error(p, bis_params_at(p, "Kd"), "\"Kd\" and \"reflectance\" are the same: give one");
    bis_params_colour(p, "Kd", &Kd, unit, &t->Kd); /* v2, v3 */
    if (bis_params_float(p, "sigma", &sigma, positive_or_0) && sigma != 0)
        bis_approximate_or_refuse(p, bis_params_at(p, "sigma"), "\"sigma\"", "the surface is Lambert's",
                                  "a rough diffuse surface (Oren and Nayar) is not modelled: \"sigma\" must be 0");
    return bis_phong(Kd, (rgb){0, 0, 0}, 50);
}

/* pbrt-v4's displacement, which is v1's to v3's bumpmap, and its normal map. A constant displacement bends nothing. */
static void read_bump(bis_parser *p, bis_material_textures *t)
{
    static const bis_interval any = {-HUGE_VAL, HUGE_VAL, false, false};
    static const bis_stand_in no_normals = {"a normal map that is not there", "the surface is as smooth as its shape",
                                            "a normal map that cannot be read", false};
    const char *name;
    double constant;

    bis_params_number(p, bis_params_has(p, "displacement") ? "displacement" : "bumpmap", &constant, any, &t->bump);
    if (!bis_params_string(p, "normalmap", &name)) return;
    const bis_loc at = bis_params_at(p, "normalmap");
    bool lacks;
    char *path = bis_approximate_path(p, &lacks, at, name, &no_normals);
    if (!lacks) bis_parser_add_image(p, path, &(bis_texture_file){.gamma = 1, .loc = at}, &t->normals);
}

/* By name: a model of ours, or a reader that asks for pbrt's parameters (what is left over is an error); neither: pbrt
 * has it and bis does not model it. */
static const struct {
    const char *name;
    const bis_bsdf_model *model;
    bis_material_reader *read;
} materials[] = {
    {"phong", .model = &bis_phong_model},
    {"microfacet", .model = &bis_microfacet_model},
    {"diffuse", .read = read_diffuse},
    {"matte", .read = read_diffuse},
    {"coateddiffuse", .read = bis_parser_coated_diffuse},
    {"conductor", .read = bis_parser_conductor},
    {"metal", .read = bis_parser_metal},
    {"plastic", .read = bis_parser_plastic},
    {"substrate", .read = bis_parser_substrate},
    {"uber", .read = bis_parser_uber},
    {.name = "coatedconductor"}, {.name = "dielectric"}, {.name = "diffusetransmission"}, {.name = "disney"},
    {.name = "fourier"}, {.name = "glass"}, {.name = "hair"}, {.name = "interface"}, {.name = "kdsubsurface"},
    {.name = "measured"}, {.name = "mirror"}, {.name = "mix"}, {.name = "none"}, {.name = "shinymetal"},
    {.name = "subsurface"}, {.name = "thindielectric"}, {.name = "translucent"}, {.name = ""},
};
enum { N_MATERIALS = BIS_COUNT(materials) };

/* The number of the material called type, or N_MATERIALS after a complaint. */
static int choose_material(bis_parser *p, const char *directive, const char *type, bis_loc at)
{
    bis_choice choices[N_MATERIALS];
    for (int i = 0; i < N_MATERIALS; i++)
        choices[i] = (bis_choice){materials[i].name, materials[i].model || materials[i].read ? i : BIS_FOREIGN};
    const bis_choice *chosen = bis_parser_choose(p, directive, type, at, choices, N_MATERIALS);
    return chosen ? (int)(chosen - choices) : N_MATERIALS;
}

/* The material that the parameters describe goes to desc->materials[index]. Returns its name if all of its parameters
 * have been asked for, else NULL. */
static const char *make_material(bis_parser *p, const char *type, bis_loc at, uint32_t index)
{
    const int k = choose_material(p, "Material", type, at);
    if (k == N_MATERIALS) return NULL;
    if (strcmp(materials[k].name, type) != 0) /* pbrt's matte, of what it does not know, takes what it can use */
        for (size_t i = 0; i < p->params.n; i++) p->params.list[i].used = true;
    bis_material_textures t = BIS_NO_TEXTURES;
    t.loc = at;
    const bis_material m = materials[k].model  ? read_model(p, &t, materials[k].model)
                           : materials[k].read ? materials[k].read(p, &t)
                                               : bis_approximate_material(p, materials[k].name, index);
    read_bump(p, &t);
    p->desc->materials[index] = m;
    if (bis_textures_any(&t) && m.model && !bis_scene_desc_set_textures(p->desc, index, &t)) bis_parser_nomem(p, at);
    return materials[k].model || materials[k].read ? materials[k].name : NULL;
}

static void read_material(bis_parser *p, const char *type, bis_loc at, uint32_t index)
{
    const char *name = make_material(p, type, at, index);
    if (name) bis_params_end(p, "Material", name);
}

bool bis_parser_add_material(bis_parser *p, uint32_t *index)
{
    bis_scene_desc *d = p->desc;
    if (!BIS_ROOM(d->materials, d->capacity_materials, d->n_materials) || d->n_materials >= UINT32_MAX)
        return bis_parser_nomem(p, p->name_at);
    d->materials[d->n_materials] = d->materials[0]; /* the default, which a reader that complains leaves in place */
    *index = (uint32_t)d->n_materials++;
    return true;
}

/* ---- what a shape gives itself ---- */

/* A copy of an array's first n elements; NULL: n is 0, or no memory. */
static void *copy_of(const void *from, size_t n, size_t size)
{
    void *copy = n ? bis_alloc(n, size) : NULL;
    if (copy) memcpy(copy, from, n * size);
    return copy;
}

static void clear_words(bis_material_words *w)
{
    bis_free(w->list);
    bis_free(w->numbers);
    bis_free(w->strings);
    bis_free(w->text);
    *w = (bis_material_words){0};
}

void bis_parser_clear_words(bis_parser *p)
{
    for (size_t i = 0; i < p->n_words; i++) clear_words(&p->words[i]);
    bis_free(p->words);
}

/* Keeps the parameters that have been read for material `index`, before anyone asks for them. type: the place of its
 * name. */
static void keep_words(bis_parser *p, uint32_t index, size_t type)
{
    const bis_params *ps = &p->params;
    if (!bis_parser_predates_v4(p)) return;
    if (!BIS_ROOM(p->words, p->capacity_words, index)) {
        bis_parser_nomem(p, p->name_at);
        return;
    }
    while (p->n_words <= index) p->words[p->n_words++] = (bis_material_words){0};
    bis_material_words *w = &p->words[index];
    clear_words(w); /* of a material that is made again */
    *w = (bis_material_words){copy_of(ps->list, ps->n, sizeof *ps->list),
                              copy_of(ps->numbers, ps->n_numbers, sizeof *ps->numbers),
                              copy_of(ps->strings, ps->n_strings, sizeof *ps->strings),
                              copy_of(ps->text, ps->n_text, sizeof *ps->text),
                              ps->n, ps->n_numbers, ps->n_strings, ps->n_text, type};
    if ((ps->n && !w->list) || (ps->n_numbers && !w->numbers) || (ps->n_strings && !w->strings) || !w->text)
        bis_parser_nomem(p, p->name_at);
}

/* Appends the words of a material to the parameters of a shape, but those that the shape gives itself. */
static bool append_words(bis_parser *p, const bis_material_words *w)
{
    bis_params *ps = &p->params;
    const size_t numbers = ps->n_numbers, strings = ps->n_strings, text = ps->n_text;
    if (!BIS_ROOM(ps->numbers, ps->capacity_numbers, numbers + w->n_numbers) ||
        !BIS_ROOM(ps->strings, ps->capacity_strings, strings + w->n_strings) ||
        !BIS_ROOM(ps->text, ps->capacity_text, text + w->n_text))
        return bis_parser_nomem(p, p->name_at);
    for (size_t i = 0; i < w->n_numbers; i++) ps->numbers[ps->n_numbers++] = w->numbers[i];
    for (size_t i = 0; i < w->n_strings; i++) ps->strings[ps->n_strings++] = w->strings[i] + text;
    for (size_t i = 0; i < w->n_text; i++) ps->text[ps->n_text++] = w->text[i];
    for (size_t i = 0; i < w->n; i++) {
        bis_param param = w->list[i];
        param.name += text;
        param.first += param.is_strings ? strings : numbers;
        if (bis_params_find(p, bis_parser_text(p, param.name))) continue;
        if (ps->n == BIS_MAX_PARAMS)
            return bis_parser_error(p, p->name_at, "more than %d parameters with those of the material",
                                    BIS_MAX_PARAMS);
        ps->list[ps->n++] = param;
    }
    return true;
}

/* What the materials of pbrt-v1 to v3 ask for, between spaces. */
static bool is_of_materials(const char *name)
{
    static const char names[] = " Kd Ks Kr Kt sigma roughness uroughness vroughness remaproughness eta k index opacity "
                                "bumpmap color metallic reflect transmit ";
    char word[BIS_MAX_PARAM_NAME + 3];
    snprintf(word, sizeof word, " %s ", name);
    return strstr(names, word) != NULL;
}

void bis_parser_override(bis_parser *p, uint32_t *material)
{
    static char matte[] = "matte"; /* of shapes before the first Material */
    static const bis_material_words none = {.text = matte, .n_text = sizeof matte};
    const bis_material_words *w = !*material ? &none : *material < p->n_words ? &p->words[*material] : NULL;
    const size_t text = p->params.n_text;
    const size_t n = p->params.n;
    uint32_t index;
    bool some = false;
    for (size_t i = 0; i < n; i++)
        some |= !p->params.list[i].used && is_of_materials(bis_parser_text(p, p->params.list[i].name));
    if (!some || !w || !w->text || !bis_parser_predates_v4(p)) return;
    if (!append_words(p, w) || !bis_parser_add_material(p, &index)) return;
    const size_t type = text + w->type;
    const bool asks = make_material(p, bis_parser_text(p, type), p->name_at, index);
    for (size_t i = asks ? n : 0; i < p->params.n; i++) p->params.list[i].used = true; /* the others are the shape's */
    *material = index;
}

/* ---- directives ---- */

void bis_directive_material(bis_parser *p, bis_loc at)
{
    uint32_t index;
    (void)at;
    if (!bis_parser_name(p, "Material") || !bis_params_read(p) || !bis_parser_add_material(p, &index)) return;
    p->now.material = index;
    keep_words(p, index, p->name);
    read_material(p, bis_parser_text(p, p->name), p->name_at, index);
}

/* The entry of a named material, made when the name is met first. */
static bis_named_material *named_material(bis_parser *p, const char *name, uint32_t *index)
{
    uint32_t i;
    if (bis_names_find(&p->material_names, name, &i)) {
        *index = p->named[i].index;
        return &p->named[i];
    }
    if (!BIS_ROOM(p->named, p->capacity_named, p->n_named) ||
        !bis_names_set(&p->material_names, name, (uint32_t)p->n_named)) {
        bis_parser_nomem(p, p->name_at);
        return NULL;
    }
    if (!bis_parser_add_material(p, index)) return NULL;
    p->named[p->n_named] = (bis_named_material){.index = *index};
    return &p->named[p->n_named++];
}

void bis_directive_make_named_material(bis_parser *p, bis_loc at)
{
    uint32_t index;
    if (!bis_parser_name(p, "MakeNamedMaterial") || !bis_params_read(p)) return;
    const char *name = bis_parser_text(p, p->name), *type;
    bis_named_material *named = named_material(p, name, &index);
    if (!named) return;
    if (named->made.line) {
        if (!bis_approximate_or_refuse(p, p->name_at, "a material made again", "the last one counts from there on",
                                       "material \"%s\" is made already, in %s:%d", bis_parser_word(p, name),
                                       named->made.file, named->made.line) ||
            !bis_parser_add_material(p, &index))
            return;
        named->index = index;
    }
    named->made = at;
    const bool has_type = bis_params_has(p, "type");
    if (bis_params_string(p, "type", &type)) {
        keep_words(p, index, (size_t)(type - p->params.text));
        read_material(p, type, bis_params_at(p, "type"), index);
    } else if (!has_type) {
        bis_parser_error(p, p->name_at, "MakeNamedMaterial \"%s\" needs \"string type\"", bis_parser_word(p, name));
    }
}

void bis_directive_named_material(bis_parser *p, bis_loc at)
{
    uint32_t index;
    (void)at;
    if (!bis_parser_name(p, "NamedMaterial")) return;
    bis_named_material *named = named_material(p, bis_parser_text(p, p->name), &index);
    if (!named) return;
    if (!named->used.line) named->used = p->name_at;
    p->now.material = index;
}

void bis_parser_check_materials(bis_parser *p)
{
    bis_names made = {0};
    p->directive = "NamedMaterial";
    for (size_t i = 0; i < p->n_named; i++)
        if (p->named[i].made.line && !bis_names_set(&made, p->material_names.names[i], 0))
            bis_parser_nomem(p, p->named[i].made);
    for (size_t i = 0; i < p->n_named && p->n_listed < BIS_MAX_ERRORS; i++) {
        const char *name = p->material_names.names[i];
        if (p->named[i].made.line) continue;
        char kind[BIS_APPROXIMATION_KIND];
        snprintf(kind, sizeof kind, "NamedMaterial \"%s\", which is not made anywhere", bis_parser_word(p, name));
        bis_approximate_or_refuse(p, p->named[i].used, kind, "diffuse grey", "material \"%s\" is not made anywhere%s",
                                  bis_parser_word(p, name), bis_parser_hint(p, bis_names_nearest(&made, name)));
    }
    bis_names_clear(&made);
}
