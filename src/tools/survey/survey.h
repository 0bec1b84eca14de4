/* SPDX-License-Identifier: BSD-2-Clause */
/* survey: what is in an environment map, in numbers and in pictures: for `bis envmap` (src/cli/cmd_envmap.c) alone.
 *
 * Shows the steps of thesis 3.3 and 3.4 one by one: intensities, levels, regions (figure 3.6), importance. */
#pragma once

#include "bis/thesis/importance.h"
#include "bis/thesis/light.h"
#include "bis/thesis/regions.h"
#include "bis/base/image.h"

#include "out/json.h"

enum { BIS_SURVEY_LARGEST = 8 };

/* All intensities are r+g+b; shares are of the sphere (4 pi sr) or of the power, in [0,1]. */
typedef struct bis_survey_level {
    double least, most; /* the level's bounds */
    size_t pixels;
    uint32_t regions;
    double sphere, power;
} bis_survey_level;

typedef struct bis_survey_region {
    uint32_t label;
    uint8_t level;
    double solid_angle; /* sr */
    double power;       /* share */
    vec3 direction;     /* of its centre of power; the zero vector where it has none (a constant map) */
} bis_survey_region;

typedef struct bis_survey {
    double least, most, mean, median; /* least: of the positive ones; median by solid angle, to 1/4096 of its value */
    double power;                     /* integral over the sphere */
    double mean_rgb[3];
    double black;                     /* share of the sphere */
    double brightest;                 /* share of the power in the brightest 0.1% of the sphere */
    size_t peak;                      /* the brightest pixel */
    int n_levels;
    bis_survey_level level[BIS_LEVEL_NONE];
    uint32_t n_regions;
    int n_largest;
    bis_survey_region largest[BIS_SURVEY_LARGEST]; /* by power */
} bis_survey;

/* bis_survey_init surveys a map and its regions. Errors: BIS_NOMEM. */
bis_status bis_survey_init(bis_survey *s, const bis_envmap *em, const bis_regions *regions, int levels, bis_diag *diag);

/* bis_survey_levels_picture and bis_survey_regions_picture make false-colour pictures as large as the map, to be shown
 * without any exposure. Errors: BIS_NOMEM. */
bis_status bis_survey_levels_picture(bis_image *out, const bis_envmap *em, int levels, bis_diag *diag);
bis_status bis_survey_regions_picture(bis_image *out, const bis_envmap *em, const bis_regions *regions, bis_diag *diag);

/* bis_survey_importance_picture shows the density q of each pixel on a logarithmic scale, and n_samples directions
 * drawn by it as dots (figure 3.5). Errors: BIS_NOMEM. */
bis_status bis_survey_importance_picture(bis_image *out, const bis_envmap *em, const bis_importance *im, int n_samples,
                                         bis_diag *diag);

enum { BIS_SURVEY_PAGE_WIDTH = 720 };

/* bis_survey_put_page writes what the page of a map shows beyond its survey, into an open object: "places", of each
 * pixel or of each step x step of them, and "samples", n_samples directions. Errors: BIS_NOMEM. */
bis_status bis_survey_put_page(bis_json *j, const bis_survey *s, const bis_light *light, const bis_regions *regions,
                               int n_samples, bis_diag *diag);

/* page.html with its scripts, as make puts it into the program. */
extern const char bis_survey_page[];
