/* SPDX-License-Identifier: BSD-2-Clause */
/* flat_render: a scene into memory, with settings as text. */
#include "base/text.h"
#include "bis/base/clock.h"
#include "bis/base/file.h"
#include "bis/base/mem.h"
#include "bis/flat/taught.h"
#include "flat/say.h"
#include "tools/describe.h"

#include <stdlib.h>
#include <string.h>

struct bis_flat_picture {
    int width, height;
    float *rgba;
    char *stats; /* of open_memstream */
    double pass_seconds;
    float *planes;                            /* the channels of all layers, [height][width] each */
    int first[BIS_N_LAYERS], n[BIS_N_LAYERS]; /* the channels of a layer; n = 0: the picture does not have it */
};

static const bis_loc nowhere = {0};

/* What is said of the render and not of the scene. */
typedef struct wishes {
    uint64_t spp, threads;
    double seconds, error;
    const bis_light *light;
    bis_flat_watcher *watcher;
    void *user;
    const volatile sig_atomic_t *stop;
} wishes;

/* ---- settings ---- */

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
    return bis_error(diag, BIS_INPUT, nowhere, "%s is \"%.40s\": give %s in %s%.16g, %.16g]", name, text,
                     r.kind == WHOLE ? "an integer" : "a number", r.kind == REAL_ABOVE ? "(" : "[", r.lo, r.hi);
}

static bis_status set_parameter(bis_settings *s, const char *name, const char *text, bis_diag *diag)
{
    const bis_parameter *p = bis_parameter_of(s->integrator, name);
    char list[128];
    double v = 0;

    if (!p)
        return bis_error(diag, BIS_INPUT, nowhere,
                         "integrator \"%s\" has no parameter \"%.40s\"; `bis help integrators` lists what each reads",
                         s->integrator->name, name);
    if (p->type == BIS_PARAMETER_CHOICE) {
        unsigned i = 0;
        while (i < BIS_MAX_CHOICES && (!(p->choices >> i & 1) || strcmp(p->names[i], text) != 0)) i++;
        if (i == BIS_MAX_CHOICES)
            return bis_error(diag, BIS_INPUT, nowhere, "%s is \"%.40s\": integrator \"%s\" takes %s", name, text,
                             s->integrator->name, bis_parameter_list(list, p, "\""));
        v = i;
    } else if (p->type == BIS_PARAMETER_BOOL) {
        v = strcmp(text, "true") == 0;
        if (v <= 0 && strcmp(text, "false") != 0)
            return bis_error(diag, BIS_INPUT, nowhere, "%s is \"%.40s\": give true or false", name, text);
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
        return bis_error(diag, BIS_INPUT, nowhere,
                         "there is no integrator \"%.40s\"; `bis help integrators` lists them", name);
    bis_scene_name_integrator(d, integrator, nowhere);
    return BIS_OK;
}

static bis_status set_accelerator(bis_scene_desc *d, const char *name, bis_diag *diag)
{
    const bool is_grid = strcmp(name, "grid") == 0;

    if (!is_grid && (strcmp(name, "embree") != 0 || !bis_accel_embree_version()))
        return bis_error(diag, BIS_INPUT, nowhere, "accelerator \"%.40s\" is not there: give %s", name,
                         bis_accel_embree_version() ? "\"grid\" or \"embree\"" : "\"grid\"");
    d->accel.kind = is_grid ? BIS_ACCEL_GRID : BIS_ACCEL_EMBREE;
    return BIS_OK;
}

static bis_status set_crop(bis_film_desc *f, const char *text, bis_diag *diag)
{
    if (bis_film_read_crop(f->crop, text)) return BIS_OK;
    return bis_error(diag, BIS_INPUT, nowhere,
                     "crop is \"%.60s\": give x0,x1,y0,y1 in [0, 1] with x0 < x1 and y0 < y1, as 0.25,0.75,0,1", text);
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

/* The settings that say how the scene is read. */
static const char *const of_parse[] = {"text", "approximate"};
enum { TEXT, APPROXIMATE, N_OF_PARSE };

/* The value of the last setting of this name, or NULL. */
static const char *value_of(const char *const *settings, const char *name)
{
    const size_t n = strlen(name);
    const char *value = NULL;

    for (; *settings; settings++)
        if (strncmp(*settings, name, n) == 0 && (*settings)[n] == '=') value = *settings + n + 1;
    return value;
}

static bis_status parse(bis_scene_desc **d, const char *path, const char *const *settings, const bis_light *light,
                        bis_diag *diag)
{
    const char *approximate = value_of(settings, of_parse[APPROXIMATE]);

    if (approximate && strcmp(approximate, "true") != 0 && strcmp(approximate, "false") != 0)
        return bis_error(diag, BIS_INPUT, nowhere, "approximate is \"%.40s\": give true or false", approximate);
    const unsigned how = (approximate && *approximate == 't' ? BIS_PARSE_APPROXIMATE : 0) |
                         (light ? BIS_PARSE_OTHER_LIGHT : 0);
    return bis_scene_parse_text(d, path, value_of(settings, of_parse[TEXT]), how, diag);
}

static bis_status set(bis_scene_desc *d, wishes *w, const char *name, const char *text, bis_diag *diag)
{
    const struct {
        const char *name;
        range r;
    } rows[] = {{"spp", {1, UINT32_MAX, WHOLE}},
                {"threads", {1, 1024, WHOLE}},
                {"seconds", {0, 1e8, REAL_ABOVE}}, /* as --time and --error */
                {"error", {0, 10, REAL_ABOVE}},
                {"width", {1, BIS_IMAGE_MAX_SIDE, WHOLE}},
                {"height", {1, BIS_IMAGE_MAX_SIDE, WHOLE}},
                {"seed", {0, BIS_SEED_MAX, WHOLE}}};
    const size_t n_rows = sizeof rows / sizeof *rows;
    double v;

    if (strcmp(name, "integrator") == 0) return BIS_OK; /* was set first */
    for (int k = 0; k < N_OF_PARSE; k++)
        if (strcmp(name, of_parse[k]) == 0) return BIS_OK;
    if (strcmp(name, "accelerator") == 0) return set_accelerator(d, text, diag);
    if (strcmp(name, "camera") == 0) return set_camera(&d->view.camera, text, diag);
    if (strcmp(name, "crop") == 0) return set_crop(&d->view.film, text, diag);
    if (strcmp(name, "layers") == 0) return bis_layers_read(&d->view.film.layers, text, name, nowhere, diag);
    size_t i = 0;
    while (i < n_rows && strcmp(rows[i].name, name) != 0) i++;
    if (i == n_rows) return set_parameter(&d->view.settings, name, text, diag);
    const bis_status status = number(&v, name, text, rows[i].r, diag);
    if (status) return status;
    if (i == 0) w->spp = (uint64_t)v;
    if (i == 1) w->threads = (uint64_t)v;
    if (i == 2) w->seconds = v;
    if (i == 3) w->error = v;
    if (i == 4) d->view.film.width = (int)v;
    if (i == 5) d->view.film.height = (int)v;
    if (i == 6) d->view.sampler.seed = (uint64_t)v;
    return BIS_OK;
}

static bis_status apply(bis_scene_desc *d, wishes *w, const char *const *settings, bis_diag *diag)
{
    bis_status status = BIS_OK;

    /* the integrator first, because it says which parameters there are */
    for (const char *const *s = settings; !status && *s; s++)
        if (strncmp(*s, "integrator=", 11) == 0) status = set_integrator(d, *s + 11, diag);
    for (const char *const *s = settings; !status && *s; s++) {
        char name[64];
        const size_t n = strcspn(*s, "=");
        if (!(*s)[n] || n >= sizeof name)
            return bis_error(diag, BIS_INPUT, nowhere, "\"%.60s\" is no setting: give name=value", *s);
        snprintf(name, sizeof name, "%.*s", (int)n, *s);
        status = set(d, w, name, *s + n + 1, diag);
    }
    if (status) return status;
    if (w->spp) bis_sampler_set_spp(&d->view.sampler, w->spp);
    if (w->threads) d->accel.n_threads = (int)w->threads;
    return bis_settings_check(&d->view.settings, nowhere, diag);
}

bis_status bis_flat_describe(bis_scene_desc **out, const char *path, const char *const *settings, bis_diag *diag)
{
    wishes w = {0};
    bis_status status = BIS_FLAT_GIVEN(diag, out, path, settings);

    if (!status) status = parse(out, path, settings, NULL, diag);
    if (!status) status = apply(*out, &w, settings, diag);
    return status;
}

bis_status bis_flat_apply(bis_scene_desc *d, const char *const *settings, bis_diag *diag)
{
    wishes w = {0};
    const bis_status status = BIS_FLAT_GIVEN(diag, d, settings);

    return status ? status : apply(d, &w, settings, diag);
}

/* ---- rendering ---- */

/* The layers, each by itself, so that it is known which channels are whose. */
static bool keep_layers(bis_flat_picture *p, const bis_film *film)
{
    const size_t n_pixels = (size_t)p->width * (size_t)p->height;
    bis_channel channels[BIS_FILM_MAX_CHANNELS];
    const int n = bis_film_layers(film, channels, NULL);

    p->planes = n > 0 ? bis_alloc((size_t)n * n_pixels, sizeof *p->planes) : NULL;
    if (n > 0 && !p->planes) return false;
    bis_film one = *film;
    for (int i = 0, at = 0; i < BIS_N_LAYERS; at += p->n[i++]) {
        one.layers.asked = film->layers.asked & 1u << i;
        p->first[i] = at;
        p->n[i] = one.layers.asked ? bis_film_layers(&one, channels, p->planes + (size_t)at * n_pixels) : 0;
    }
    return true;
}

static bis_status keep(bis_flat_picture **out, const bis_film *film, const bis_stats *stats, bis_diag *diag)
{
    bis_flat_picture *p = bis_alloc(1, sizeof *p);
    size_t n;

    if (!p) return bis_error(diag, BIS_NOMEM, nowhere, "no memory for the picture");
    p->width = film->width;
    p->height = film->height;
    p->pass_seconds = stats->seconds.render / stats->result->passes;
    p->rgba = bis_alloc((size_t)film->width * (size_t)film->height, 4 * sizeof *p->rgba);
    FILE *f = p->rgba && keep_layers(p, film) ? open_memstream(&p->stats, &n) : NULL;
    if (f) bis_stats_print(stats, f);
    if (!f || fclose(f) != 0) {
        bis_flat_picture_close(p);
        return bis_error(diag, BIS_NOMEM, nowhere, "no memory for the picture");
    }
    bis_film_resolve(film, p->rgba);
    *out = p;
    return BIS_OK;
}

/* A light of this picture in the place of the scene's, whose frame stands upright (BIS_PARSE_OTHER_LIGHT). */
static bis_status replace_light(bis_light_desc *desc, bis_image *image, const bis_light *light, bis_diag *diag)
{
    const bis_envmap *em = bis_light_envmap(light);

    *image = (bis_image){em->width, em->height, em->pixels, NULL};
    desc->image = image;
    desc->filename = bis_strdup("the given light");
    desc->has_mapping = true; /* lat-long by now, even where it is square */
    return desc->filename ? BIS_OK : bis_error(diag, BIS_NOMEM, nowhere, "no memory for the light");
}

static void watch(const bis_progress *p, void *user)
{
    const wishes *w = user;
    w->watcher(p->share, p->seconds, p->seconds_left, w->user);
}

static bis_status render(bis_flat_picture **out, const char *path, const char *const *settings, wishes *w,
                         bis_diag *diag)
{
    bis_scene_desc *desc = NULL;
    bis_scene *scene = NULL;
    bis_film film = {0};
    bis_image pixels;
    bis_render_result result;
    const double start = bis_clock_now();

    bis_status status = parse(&desc, path, settings, w->light, diag);
    if (!status) status = apply(desc, w, settings, diag);
    if (!status && w->light) status = replace_light(&desc->light, &pixels, w->light, diag);
    if (status) goto done;
    const double parsed = bis_clock_now();
    const bis_film_desc *size = &desc->view.film;
    const bis_render_options options = {
        .budget = {.spp = (uint32_t)w->spp, .seconds = w->seconds, .error = w->error},
        .n_threads = (int)w->threads,
        .interrupted = w->stop,
        .progress = w->watcher ? watch : NULL,
        .user = w,
    };
    status = bis_film_init(&film, size->width, size->height, size->crop, nowhere, diag);
    if (!status) status = bis_film_want(&film, size->layers, diag);
    if (!status) status = bis_scene_build(&scene, desc, diag);
    if (status) goto done;
    status = bis_render(&result, &film, scene, &desc->view, &options, diag);
    if (!status && result.passes == 0)
        status = bis_error(diag, BIS_INPUT, nowhere, "the render was stopped before its first pass was complete");
    if (status) goto done;

    bis_stats stats = bis_stats_of(desc, bis_scene_figures_of(scene), scene->seconds, &film, &result);
    stats.extent = bis_geometry_primitives(&scene->geometry) > 0 ? &scene->geometry.box : NULL;
    stats.seconds.parse = parsed - start;
    stats.seconds.total = bis_clock_now() - start;
    status = keep(out, &film, &stats, diag);
done:
    bis_film_clear(&film);
    bis_scene_free(scene);
    bis_scene_desc_free(desc);
    return status;
}

/* Another language has only int to give. */
_Static_assert(sizeof(sig_atomic_t) == sizeof(int), "stop is as large as an int");

int bis_flat_render_with(bis_flat_picture **picture, const char *scene, const char *const *settings,
                         const bis_light *light, bis_flat_watcher *watcher, void *user,
                         const volatile sig_atomic_t *stop, char *say, size_t size)
{
    bis_diag diag = {0};
    wishes w = {.light = light, .watcher = watcher, .user = user, .stop = stop};
    bis_status status = BIS_FLAT_GIVEN(&diag, picture, scene, settings);

    if (picture) *picture = NULL;
    if (!status) status = render(picture, scene, settings, &w, &diag);
    return bis_flat_end(status, &diag, say, size);
}

int bis_flat_render(bis_flat_picture **picture, const char *scene, const char *const *settings,
                    const volatile sig_atomic_t *stop, char *say, size_t size)
{
    return bis_flat_render_with(picture, scene, settings, NULL, NULL, NULL, stop, say, size);
}

void bis_flat_picture_close(bis_flat_picture *picture)
{
    if (!picture) return;
    bis_free(picture->rgba);
    bis_free(picture->planes);
    free(picture->stats);
    bis_free(picture);
}

void bis_flat_picture_shape(const bis_flat_picture *picture, int shape[2])
{
    if (!shape) return;
    shape[0] = picture ? picture->width : 0;
    shape[1] = picture ? picture->height : 0;
}

void bis_flat_picture_pixels(const bis_flat_picture *picture, float *rgba)
{
    if (!picture || !rgba) return;
    memcpy(rgba, picture->rgba, (size_t)picture->width * (size_t)picture->height * 4 * sizeof *rgba);
}

const char *bis_flat_layer_name(int i) { return i >= 0 && i < BIS_N_LAYERS ? bis_layer_name((bis_layer)i) : NULL; }

int bis_flat_picture_layer(const bis_flat_picture *picture, const char *name, float *values)
{
    int layer = 0;

    if (!picture || !name) return 0;
    while (layer < BIS_N_LAYERS && strcmp(name, bis_layer_name((bis_layer)layer)) != 0) layer++;
    if (layer == BIS_N_LAYERS) return 0;
    const size_t n = (size_t)picture->n[layer], n_pixels = (size_t)picture->width * (size_t)picture->height;
    const float *planes = n > 0 ? picture->planes + (size_t)picture->first[layer] * n_pixels : NULL;
    for (size_t i = 0; values && i < n * n_pixels; i++) values[i] = planes[i % n * n_pixels + i / n];
    return (int)n;
}

double bis_flat_picture_pass_seconds(const bis_flat_picture *picture)
{
    return picture ? picture->pass_seconds : (double)NAN;
}

const char *bis_flat_picture_stats(const bis_flat_picture *picture) { return picture ? picture->stats : NULL; }
