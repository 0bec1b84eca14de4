/* SPDX-License-Identifier: BSD-2-Clause */
/* mapping_models: a mapping as functions of pixels and directions. For src/beyond/mapping*.c alone. */
#pragma once

#include "bis/beyond/mapping.h"

/* A picture and how it covers the sphere. */
typedef struct bis_raster {
    bis_mapping mapping;
    int width, height;
    double scale; /* of the formula's solid angles, such that they sum up to 4 pi */
    rgb *pixels;
} bis_raster;

enum { BIS_SAMPLES = 1024 /* that are looked up together: a whole number of lane blocks */ };

/* Places of a picture and what they show, in lanes (bis/thesis/lanes.h). */
typedef struct bis_samples {
    float x[BIS_SAMPLES], y[BIS_SAMPLES], z[BIS_SAMPLES]; /* unit directions */
    float weight[BIS_SAMPLES]; /* the solid angle by area there, up to a factor of the whole picture; 0: outside */
    uint32_t pixel[BIS_SAMPLES];
} bis_samples;

/* Places of one pixel, or of it and those to its right: (dx[i], dy[i]) pixels from its centre. n is a whole number of
 * blocks, at most BIS_SAMPLES. */
typedef struct bis_places {
    const float *dx, *dy;
    uint32_t n;
} bis_places;

typedef struct bis_mapping_model {
    const char *shape;
    int columns, rows; /* the picture consists of square cells: faces of a cube, or 1 x 1; lat-long: 2 x 1 */
    /* Pixels around the sphere where they are densest, in widths of a cell; of a cube the middle of its faces counts
     * with the corners: four faces make a turn. */
    double turn;
    int detail; /* the width in cells of the lat-long map that shows all detail */
    /* Stores the direction and the weight of places of pixel (x, y), in its row and cell. A weight of 0: no part of the
     * sphere. */
    void (*directions)(bis_samples *s, const bis_raster *r, int x, int y, const bis_places *places);
    /* Stores the pixels that show n directions. */
    void (*pixels)(const bis_raster *r, bis_samples *s, uint32_t n);
    /* The solid angle of pixel (x, y) in sr, by the formula; 0: outside. */
    double (*solid_angle)(const bis_raster *r, int x, int y);
} bis_mapping_model;

extern const bis_mapping_model bis_mapping_models[BIS_N_MAPPINGS];
