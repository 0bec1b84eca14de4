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

typedef struct bis_mapping_model {
    const char *name, *shape;
    int columns, rows; /* the picture consists of square cells: faces of a cube, or 1 x 1; lat-long: 2 x 1 */
    /* Pixels around the sphere where they are densest, in widths of a cell; of a cube the middle of its faces counts
     * with the corners: four faces make a turn. */
    double turn;
    int detail; /* the width in cells of the lat-long map that shows all detail */
    /* The direction d (a unit vector) that the picture shows at a distance of (dx, dy) pixels from the centre of pixel
     * (x, y), at most one: beyond the edge of a cube's face it is the direction there, on the next face. Returns the
     * solid angle by area there, up to a factor of the whole picture; 0: no part of the sphere. */
    double (*direction)(const bis_raster *r, int x, int y, double dx, double dy, double d[3]);
    /* The pixel that shows unit direction d. */
    size_t (*pixel)(const bis_raster *r, const double d[3]);
    /* The solid angle of pixel (x, y) in sr, by the formula; 0: outside. */
    double (*solid_angle)(const bis_raster *r, int x, int y);
} bis_mapping_model;

extern const bis_mapping_model bis_mapping_models[BIS_N_MAPPINGS];
