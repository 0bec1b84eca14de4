/* SPDX-License-Identifier: BSD-2-Clause */
/* wishes: what settings as text ask of a scene, for src/flat alone. */
#pragma once

#include "bis/flat/scene.h"
#include "bis/scene/parameters.h"
#include "bis/scene/scene.h"
#include "tools/json.h"

/* What is said of the render and not of the scene. 0 and NULL: nothing is. */
typedef struct bis_flat_wishes {
    uint64_t spp, threads;
    double seconds, error;
    bool has_area_exponent; /* the description has it */
    double turn; /* degrees: the map, about its own upright axis */
    int step;    /* a thin film: of each step x step pixels one */
    const bis_light *light;
    bis_flat_watcher *watcher;
    void *user;
    const volatile sig_atomic_t *stop;
} bis_flat_wishes;

/* bis_flat_parse reads a scene as these settings and a light in the place of its own (NULL: none) ask. The caller frees
 * *d. Errors: those of bis_scene_parse, BIS_INPUT (a setting). */
bis_status bis_flat_parse(bis_scene_desc **d, const char *path, const char *const *settings, const bis_light *light,
                          bis_diag *diag);

/* bis_flat_wish changes a description by settings, and stores in *w what is no part of it. Errors: BIS_INPUT. */
bis_status bis_flat_wish(bis_scene_desc *d, bis_flat_wishes *w, const char *const *settings, bis_diag *diag);

/* bis_flat_setting returns the value of the last setting of this name, or NULL. */
const char *bis_flat_setting(const char *const *settings, const char *name);

/* An open scene. */
enum { BIS_FLAT_LIGHTS = 8 };
struct bis_flat_scene {
    bis_scene_desc *desc;
    bis_scene *scene;
    ray *points;      /* of bis_flat_scene_points */
    bis_view view;    /* the scene's own, while points stand in the place of its pixels */
    bis_image pixels; /* of a light in the place of the scene's; borrowed */
    double parse_seconds;
    bool is_kept;     /* built for all methods, because more than one picture is made of it */
    unsigned needs;   /* of the light, with is_kept */
    struct {
        bis_light_desc desc; /* its texts are those of the scene */
        unsigned needs;
        bis_light *light;
    } lights[BIS_FLAT_LIGHTS]; /* the same map with other settings; the oldest one makes room */
    int n_lights, next_light;
    bis_light *given; /* of the last picture that another light was given for */
    char *about;      /* of open_memstream: what bis_flat_scene_about said last */
};

/* bis_flat_scene_begin parses and builds into *s, which is all 0. With is_kept it builds what any method needs, else
 * what the settings need. Errors: those of bis_flat_parse and bis_scene_build; bis_flat_scene_end is due then, too. */
bis_status bis_flat_scene_begin(bis_flat_scene *s, const char *path, const char *const *settings, bis_flat_wishes *w,
                                bool is_kept, bis_diag *diag);
void bis_flat_scene_end(bis_flat_scene *s);

/* bis_flat_scene_check refuses what a scene that is built can no longer become. Errors: BIS_INPUT. */
bis_status bis_flat_scene_check(const bis_flat_scene *s, const bis_scene_desc *d, const bis_flat_wishes *w,
                                bis_diag *diag);

/* bis_flat_scene_given builds the light w->light, for these needs, and makes it that of d. The caller frees it. Errors:
 * those of bis_light_load. */
bis_status bis_flat_scene_given(bis_light **light, bis_scene_desc *d, const bis_flat_wishes *w, unsigned needs,
                                bis_diag *diag);

/* bis_flat_scene_light finds the light that d and the wishes ask for, which is s's: the scene's own, the same map with
 * other settings, or w->light. It changes d's light to that. Errors: those of bis_light_load. */
bis_status bis_flat_scene_light(bis_light **light, bis_flat_scene *s, bis_scene_desc *d, const bis_flat_wishes *w,
                                bis_diag *diag);

/* bis_flat_put_parameter writes the value v of a parameter as JSON. */
void bis_flat_put_parameter(bis_json *j, const char *key, const bis_parameter *p, double v);
