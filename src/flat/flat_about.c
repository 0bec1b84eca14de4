/* SPDX-License-Identifier: BSD-2-Clause */
/* flat_about: what the library has, and what a picture would be of, as JSON: names, parameters, ranges and claims stand
 * in the tables of the library, and no other language keeps a copy. */
#include "bis/base/mem.h"
#include "bis/scene/layers.h"
#include "bis/shape/accel.h"
#include "bis/thesis/errata.h"
#include "bis/thesis/importance.h"
#include "bis/thesis/integrator.h"
#include "flat/face.h"
#include "flat/wishes.h"
#include "tools/describe.h"

#include <stdlib.h>
#include <string.h>

void bis_flat_put_parameter(bis_json *j, const char *key, const bis_parameter *p, double v)
{
    if (p->type == BIS_PARAMETER_BOOL) bis_json_bool(j, key, v > 0);
    else if (p->type == BIS_PARAMETER_CHOICE) bis_json_text(j, key, bis_parameter_text(NULL, p, v));
    else bis_json_number(j, key, v);
}

/* ---- the library ---- */

static void put_parameter(bis_json *j, const bis_parameter *p)
{
    static const char *const types[] = {[BIS_PARAMETER_COUNT] = "count", [BIS_PARAMETER_FRACTION] = "fraction",
                                        [BIS_PARAMETER_BOOL] = "bool", [BIS_PARAMETER_CHOICE] = "choice"};
    bis_json_open(j, NULL, '{');
    bis_json_text(j, "name", p->name);
    bis_json_text(j, "type", types[p->type]);
    bis_flat_put_parameter(j, "default", p, p->usual);
    if (p->type == BIS_PARAMETER_CHOICE) {
        bis_json_open(j, "choices", '[');
        for (int i = 0; i < BIS_MAX_CHOICES; i++)
            if (p->choices >> i & 1) bis_json_text(j, NULL, p->names[i]);
        bis_json_close(j);
    } else if (p->type != BIS_PARAMETER_BOOL) {
        BIS_JSON_NUMBERS(j, {"low", p->lo}, {"high", p->hi});
    }
    bis_json_bool(j, "is_option", p->is_option);
    bis_json_close(j);
}

static void put_library(bis_json *j)
{
    bis_json_open(j, NULL, '{');
    bis_json_open(j, "integrators", '[');
    for (const bis_integrator *const *i = bis_integrators; *i; i++) {
        bis_settings s = bis_settings_default(*i);
        bis_json_open(j, NULL, '{');
        bis_json_text(j, "name", (*i)->name);
        bis_json_text(j, "claim", (*i)->claim);
        bis_json_open(j, "parameters", '[');
        for (const bis_parameter *p = NULL; (p = bis_parameter_next(s.integrator, p)) != NULL;) put_parameter(j, p);
        bis_json_close(j);
        bis_json_close(j);
    }
    bis_json_close(j);
    bis_json_open(j, "layers", '[');
    for (int i = 0; i < BIS_N_LAYERS; i++) bis_json_text(j, NULL, bis_layer_name((bis_layer)i));
    bis_json_close(j);
    bis_json_open(j, "accelerators", '[');
    if (bis_accel_embree_version()) bis_json_text(j, NULL, "embree");
    bis_json_text(j, NULL, "grid");
    bis_json_close(j);
    bis_json_text(j, "embree_version", bis_accel_embree_version());
    BIS_JSON_OBJECT(j, "limits", {"image_side", BIS_IMAGE_MAX_SIDE}, {"seed", (double)BIS_SEED_MAX},
                    {"area_exponent", BIS_AREA_EXPONENT_MAX}, {"levels", BIS_LEVELS_MAX});
    BIS_JSON_OBJECT(j, "defaults", {"area_exponent", BIS_AREA_EXPONENT}, {"levels", BIS_LEVELS});
    bis_json_close(j);
}

const char *bis_flat_about(void)
{
    static char *text; /* made once, and never freed */
    size_t n;

    if (text) return text;
    FILE *f = open_memstream(&text, &n);
    bis_json j = {.out = f};
    if (!f) return NULL;
    put_library(&j);
    if (fclose(f) != 0) text = NULL;
    return text;
}

/* ---- a scene ---- */

static void put_film(bis_json *j, const bis_film_desc *f, int step)
{
    const bis_film place = bis_film_place(f->width, f->height, f->crop, step);

    BIS_JSON_NUMBERS(j, {"width", f->width}, {"height", f->height});
    bis_json_open(j, "crop", '[');
    for (int i = 0; i < 4; i++) bis_json_number(j, NULL, f->crop[i]);
    bis_json_close(j);
    BIS_JSON_OBJECT(j, "film", {"x0", place.x0}, {"y0", place.y0}, {"width", place.width}, {"height", place.height});
}

static void put_settings(bis_json *j, const bis_settings *s)
{
    char line[BIS_MAX_LINE], errata[BIS_ERRATA_TEXT];

    bis_json_text(j, "integrator", s->integrator->name);
    bis_json_text(j, "claim", s->integrator->claim);
    bis_json_open(j, "parameters", '{');
    for (const bis_parameter *p = NULL; (p = bis_parameter_next(s->integrator, p)) != NULL;)
        bis_flat_put_parameter(j, p->name, p, bis_parameter_get(p, s));
    bis_json_close(j);
    bis_json_text(j, "line", bis_describe_line(line, s, false));
    bis_json_text(j, "whole_line", bis_describe_line(line, s, true));
    bis_json_text(j, "as_printed", bis_errata_text(errata, s->as_printed));
}

static void put_light(bis_json *j, const bis_light *light, const bis_light_desc *d)
{
    const bis_envmap *em = bis_light_is_constant(light) ? NULL : bis_light_envmap(light);

    bis_json_open(j, "light", '{');
    bis_json_text(j, "file", d->image ? NULL : d->filename);
    bis_json_bool(j, "is_black", bis_light_is_black(light));
    bis_json_bool(j, "is_constant", bis_light_is_constant(light));
    BIS_JSON_NUMBERS(j, {"width", em ? em->width : 0}, {"height", em ? em->height : 0},
                     {"area_exponent", d->area_exponent}, {"levels", d->levels});
    bis_json_close(j);
}

static void put_scene(bis_json *j, const bis_flat_scene *s, const bis_scene_desc *d, const bis_flat_wishes *w)
{
    const bis_scene_figures figures = bis_scene_figures_of(s->scene);

    bis_json_open(j, NULL, '{');
    bis_json_text(j, "path", d->path);
    bis_json_open(j, "files", '[');
    for (size_t i = 0; i < d->n_files; i++) bis_json_text(j, NULL, d->files[i]);
    bis_json_close(j);
    put_film(j, &d->view.film, w->step ? w->step : 1);
    put_settings(j, &d->view.settings);
    bis_json_bool(j, "names_integrator", d->names_integrator);
    bis_json_text(j, "integrator_file", d->integrator_loc.file);
    BIS_JSON_NUMBERS(j, {"integrator_line", d->integrator_loc.line}, {"integrator_column", d->integrator_loc.column});
    bis_json_count(j, "spp", d->view.sampler.spp);
    bis_json_count(j, "seed", d->view.sampler.seed);
    bis_json_bool(j, "is_stratified", d->view.sampler.kind == BIS_SAMPLER_STRATIFIED);
    bis_json_text(j, "accelerator", *figures.accelerator ? figures.accelerator : NULL);
    bis_json_count(j, "triangles", figures.triangles);
    bis_json_bool(j, "has_surface", s->scene->accel != NULL);
    put_light(j, s->scene->light, &d->light);
    bis_json_close(j);
}

bis_status bis_do_scene_about(const char **text, bis_flat_scene *scene, const char *const *settings, bis_diag *diag)
{
    bis_flat_wishes w = {0};
    bis_scene_desc d = *scene->desc; /* shallow: the settings change values alone */
    const bis_status status = bis_flat_wish(&d, &w, settings, diag);
    size_t n;

    if (status) return status;
    free(scene->about);
    scene->about = NULL;
    FILE *f = open_memstream(&scene->about, &n);
    bis_json j = {.out = f, .keeps_bytes = true};
    if (f) put_scene(&j, scene, &d, &w);
    if (!f || fclose(f) != 0) return bis_error(diag, BIS_NOMEM, nowhere, "no memory for a text");
    *text = scene->about;
    return BIS_OK;
}
