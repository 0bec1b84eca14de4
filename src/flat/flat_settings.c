/* SPDX-License-Identifier: BSD-2-Clause */
/* flat_settings: what a caller asks of a scene as "name=value" (bis/flat/flat.h), put into its description. */
#include "base/text.h"
#include "bis/base/file.h"
#include "bis/base/mem.h"
#include "bis/render/film.h"
#include "bis/thesis/errata.h"
#include "flat/face.h"
#include "flat/wishes.h"

#include <string.h>

/* Where a number must lie: in [lo, hi], or in (lo, hi]. */
typedef struct range {
    double lo, hi;
    enum { REAL, REAL_ABOVE, WHOLE } kind;
} range;

/* The number behind "name=", or an error. */
static bis_status number(double *v, const char *name, const char *text, range r, bis_diag *diag)
{
    const char *end;

    *v = bis_parse_double(text, &end);
    if (end != text && !*end && *v >= r.lo && *v <= r.hi && (r.kind != WHOLE || floor(*v) == *v) &&
        (r.kind != REAL_ABOVE || *v > r.lo))
        return BIS_OK;
    return bis_flat_refuse(diag, "%s is \"%.40s\": give %s in %s%.16g, %.16g]", name, text,
                           r.kind == WHOLE ? "an integer" : "a number", r.kind == REAL_ABOVE ? "(" : "[", r.lo, r.hi);
}

static bis_status set_parameter(bis_settings *s, const char *name, const char *text, bis_diag *diag)
{
    const bis_parameter *p = bis_parameter_of(s->integrator, name);
    char list[128];
    double v = 0;

    if (!p)
        return bis_flat_refuse(diag, "integrator \"%s\" has no parameter \"%.40s\"; `bis help integrators` lists what "
                               "each reads", s->integrator->name, name);
    if (p->type == BIS_PARAMETER_CHOICE) {
        unsigned i = 0;
        while (i < BIS_MAX_CHOICES && (!(p->choices >> i & 1) || strcmp(p->names[i], text) != 0)) i++;
        if (i == BIS_MAX_CHOICES)
            return bis_flat_refuse(diag, "%s is \"%.40s\": integrator \"%s\" takes %s", name, text,
                                   s->integrator->name, bis_parameter_list(list, p, "\""));
        v = i;
    } else if (p->type == BIS_PARAMETER_BOOL) {
        v = strcmp(text, "true") == 0;
        if (v <= 0 && strcmp(text, "false") != 0)
            return bis_flat_refuse(diag, "%s is \"%.40s\": give true or false", name, text);
    } else {
        /* the integrator's range is tested with the others' */
        const range r = p->type == BIS_PARAMETER_COUNT ? (range){0, UINT32_MAX, WHOLE} : (range){0, 1, REAL};
        const bis_status status = number(&v, name, text, r, diag);
        if (status) return status;
    }
    bis_parameter_set(p, s, v);
    return BIS_OK;
}

static bis_status set_integrator(bis_scene_desc *d, const char *name, bis_diag *diag)
{
    const bis_integrator *integrator = bis_integrator_find(name);

    if (!integrator)
        return bis_flat_refuse(diag, "there is no integrator \"%.40s\"; `bis help integrators` lists them", name);
    bis_scene_name_integrator(d, integrator, nowhere);
    return BIS_OK;
}

static bis_status set_accelerator(bis_scene_desc *d, const char *name, bis_diag *diag)
{
    const bool is_grid = strcmp(name, "grid") == 0;

    if (!is_grid && (strcmp(name, "embree") != 0 || !bis_accel_embree_version()))
        return bis_flat_refuse(diag, "accelerator \"%.40s\" is not there: give %s", name,
                               bis_accel_embree_version() ? "\"grid\" or \"embree\"" : "\"grid\"");
    d->accel.kind = is_grid ? BIS_ACCEL_GRID : BIS_ACCEL_EMBREE;
    return BIS_OK;
}

static bis_status set_crop(bis_film_desc *f, const char *text, bis_diag *diag)
{
    if (bis_film_read_crop(f->crop, text)) return BIS_OK;
    return bis_flat_refuse(diag, "crop is \"%.60s\": give x0,x1,y0,y1 in [0, 1] with x0 < x1 and y0 < y1, as "
                           "0.25,0.75,0,1", text);
}

static bis_status set_camera(bis_camera *camera, const char *text, bis_diag *diag)
{
    static const char world[] = "\nWorldBegin\nLightSource \"infinite\"\n"; /* without a light there is a warning */
    const size_t size = strlen(text) + sizeof world;
    char *whole = bis_alloc(size, 1);
    bis_scene_desc *d;

    if (!whole) return bis_error(diag, BIS_NOMEM, nowhere, "no memory for the camera");
    snprintf(whole, size, "%s%s", text, world);
    const bis_status status = bis_scene_parse_text(&d, "camera", whole, 0, diag);
    bis_free(whole);
    if (!status) *camera = d->view.camera;
    bis_scene_desc_free(d);
    return status;
}

const char *bis_flat_setting(const char *const *settings, const char *name)
{
    const size_t n = strlen(name);
    const char *value = NULL;

    for (; *settings; settings++)
        if (strncmp(*settings, name, n) == 0 && (*settings)[n] == '=') value = *settings + n + 1;
    return value;
}

bis_status bis_flat_parse(bis_scene_desc **d, const char *path, const char *const *settings, const bis_light *light,
                          bis_diag *diag)
{
    const char *approximate = bis_flat_setting(settings, "approximate");

    if (approximate && strcmp(approximate, "true") != 0 && strcmp(approximate, "false") != 0)
        return bis_flat_refuse(diag, "approximate is \"%.40s\": give true or false", approximate);
    const unsigned how = (approximate && *approximate == 't' ? BIS_PARSE_APPROXIMATE : 0) |
                         (light ? BIS_PARSE_OTHER_LIGHT : 0);
    return bis_scene_parse_text(d, path, bis_flat_setting(settings, "text"), how, diag);
}

/* Names of errata with commas, or "none". */
static bis_status set_as_printed(bis_settings *s, const char *text, bis_diag *diag)
{
    s->as_printed = 0;
    for (const char *at = strcmp(text, "none") == 0 ? "" : text; *at;) {
        char name[8];
        const size_t n = strcspn(at, ",");
        snprintf(name, sizeof name, "%.*s", (int)(n < sizeof name ? n : 0), at);
        const bis_erratum *e = bis_erratum_find(name);
        if (!e) return bis_flat_refuse(diag, "as_printed is \"%.60s\": give none, or errata as in E3,E13", text);
        s->as_printed |= e->flag;
        at += n + (at[n] == ',');
    }
    return BIS_OK;
}

static bis_status set(bis_scene_desc *d, bis_flat_wishes *w, const char *name, const char *text, bis_diag *diag)
{
    const struct row {
        const char *name;
        range r;
        uint64_t *count; /* where it goes: one of the three */
        int *whole;
        double *real;
    } rows[] = {{"spp", {1, UINT32_MAX, WHOLE}, .count = &w->spp},
                {"threads", {1, 1024, WHOLE}, .count = &w->threads},
                {"seconds", {0, 1e8, REAL_ABOVE}, .real = &w->seconds}, /* as --time and --error */
                {"error", {0, 10, REAL_ABOVE}, .real = &w->error},
                {"width", {1, BIS_IMAGE_MAX_SIDE, WHOLE}, .whole = &d->view.film.width},
                {"height", {1, BIS_IMAGE_MAX_SIDE, WHOLE}, .whole = &d->view.film.height},
                {"seed", {0, BIS_SEED_MAX, WHOLE}, .count = &d->view.sampler.seed},
                {"step", {1, BIS_IMAGE_MAX_SIDE, WHOLE}, .whole = &w->step},
                {"area_exponent", {0, BIS_AREA_EXPONENT_MAX, REAL}, .real = &d->light.area_exponent},
                {"turn", {-1e6, 1e6, REAL}, .real = &w->turn},
                {NULL, {0, 0, REAL}, NULL, NULL, NULL}};
    const struct row *row = rows;
    double v;

    if (strcmp(name, "integrator") == 0) return BIS_OK; /* was set first */
    if (strcmp(name, "text") == 0 || strcmp(name, "approximate") == 0) return BIS_OK; /* said how to read the scene */
    if (strcmp(name, "accelerator") == 0) return set_accelerator(d, text, diag);
    if (strcmp(name, "camera") == 0) return set_camera(&d->view.camera, text, diag);
    if (strcmp(name, "crop") == 0) return set_crop(&d->view.film, text, diag);
    if (strcmp(name, "as_printed") == 0) return set_as_printed(&d->view.settings, text, diag);
    if (strcmp(name, "layers") == 0) return bis_layers_read(&d->view.film.layers, text, name, nowhere, diag);
    while (row->name && strcmp(row->name, name) != 0) row++;
    if (!row->name) return set_parameter(&d->view.settings, name, text, diag);
    const bis_status status = number(&v, name, text, row->r, diag);
    if (status) return status;
    if (row->count) *row->count = (uint64_t)v;
    else if (row->whole) *row->whole = (int)v;
    else *row->real = v;
    w->has_area_exponent |= row->real == &d->light.area_exponent;
    return BIS_OK;
}

bis_status bis_flat_wish(bis_scene_desc *d, bis_flat_wishes *w, const char *const *settings, bis_diag *diag)
{
    bis_status status = BIS_OK;

    /* the integrator first, because it says which parameters there are */
    for (const char *const *s = settings; !status && *s; s++)
        if (strncmp(*s, "integrator=", 11) == 0) status = set_integrator(d, *s + 11, diag);
    for (const char *const *s = settings; !status && *s; s++) {
        char name[64];
        const size_t n = strcspn(*s, "=");
        if (!(*s)[n] || n >= sizeof name) return bis_flat_refuse(diag, "\"%.60s\" is no setting: give name=value", *s);
        snprintf(name, sizeof name, "%.*s", (int)n, *s);
        status = set(d, w, name, *s + n + 1, diag);
    }
    if (status) return status;
    if (w->spp) bis_sampler_set_spp(&d->view.sampler, w->spp);
    if (w->threads) d->accel.n_threads = (int)w->threads;
    return bis_settings_check(&d->view.settings, nowhere, diag);
}
