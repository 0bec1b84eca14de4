/* film: the sums behind the pixels. A pass adds one value to every pixel, of one or several camera samples; the picture
 * is the mean over the passes. */
#ifndef BIS_FILM_H
#define BIS_FILM_H

#include "bis/base/image.h"
#include "bis/scene/layers.h"
#include "bis/base/status.h"
#include "bis/base/vec.h"

#include <stdint.h>

/* [x0, x1) x [y0, y1) of the full image. A thin film holds of each k x k pixels of a picture one, (k/2, k/2): its pixel
 * (x, y) is (k x + k/2, k y + k/2) of the picture, and what it gets is what that one gets, bit for bit (but for what
 * learns, see render.c). So a thin film tells what the noise of a large picture is, for a part of the time. */
typedef struct bis_film {
    int full_width, full_height;
    int step;                  /* k; 1: the picture itself */
    int picture_width, picture_height; /* what the camera sees; with step 1 the full image */
    int x0, y0, width, height; /* the crop */
    double *sum;               /* sum[height][width][3] of radiance over passes */
    double *sum_squares;       /* the same of the squares: the error estimate */
    double *hits;              /* hits[height][width]: the share of a pass's camera samples that hit geometry, summed over passes */
    uint32_t passes;           /* complete passes; each counts as much as any other in every pixel */
    bis_layers layers;         /* none, unless bis_film_want asks for them */
} bis_film;

/* Pixels [x0, x1) x [y0, y1) of the full picture. */
typedef struct bis_rect {
    int x0, y0, x1, y1;
} bis_rect;

/* The sizes and places of a film of step `step` >= 1 without its sums: nothing to clear, nothing to render into.
 * crop[4] = x0, x1, y0, y1 in [0,1] (pbrt's rounding: ceil(full * x)); width or height <= 0 where it holds no pixel. */
bis_film bis_film_place(int width, int height, const double crop[4], int step);

/* Errors: BIS_INPUT (a crop outside [0,1], or empty), BIS_NOMEM. */
bis_status bis_film_init(bis_film *f, int full_width, int full_height, const double crop[4], bis_loc at, bis_diag *diag);
/* A thin one, of width x height pixels and a crop of them; step >= 1. Errors: also BIS_INPUT where the crop holds none of
 * its pixels. */
bis_status bis_film_init_thin(bis_film *f, int width, int height, const double crop[4], int step, bis_loc at, bis_diag *diag);
void bis_film_clear(bis_film *f);

/* Tiles of `side` x `side` pixels, counted from the corner of the full picture: how many of them the crop meets, *across
 * of them side by side. The tiles of a crop are those of its picture. */
int bis_film_tiles(const bis_film *f, int side, int *across);

/* The t-th of them in reading order: all of it that lies in the picture, and of that what lies in the crop. */
bis_rect bis_film_tile(const bis_film *f, int side, int t);
bis_rect bis_film_tile_of_crop(const bis_film *f, int side, int t);

/* One pass of one pixel; each pixel belongs to one thread at a time. L must be finite. hit: the share of its camera
 * samples that hit geometry. */
void bis_film_add(bis_film *f, int x, int y, rgb L, double hit);

/* rgba[height][width][4]: means, and the share of samples that hit. */
void bis_film_resolve(const bis_film *f, float *rgba);

/* Estimated relative RMSE of the picture, sqrt(relMSE) of SPEC 5 with what the picture's own pixels tell of it in place
 * of the reference, from the scatter of the passes (docs/errata.md E32); *upper (may be NULL): an upper 95% bound of
 * it. NAN with fewer than 2 passes. The scatter overestimates the error of stratified and low-discrepancy passes. */
double bis_film_relative_rmse(const bis_film *f, double *upper);

/* The same for the tiles of bis_film_tiles: errors[tile] = sum over its pixels of the expected
 * relative squared error. 2 passes or more. */
void bis_film_tile_errors(const bis_film *f, int tile, double *errors);

/* ---- layers: src/render/film_layers.c ---- */

/* Layers to gather, a set of bis/layers.h, once, before the first pass. Errors: BIS_NOMEM. */
bis_status bis_film_want(bis_film *f, unsigned layers, bis_diag *diag);

enum { BIS_FILM_MAX_CHANNELS = 24 };

/* The layers' channels, ready for an EXR; returns their number n, at most BIS_FILM_MAX_CHANNELS.
 * planes[n][height][width] receives the values, channels point into it; planes NULL: names and number only. Standard
 * errors and intervals need two passes and are left out of a film with fewer. What has no surface holds 0. */
int bis_film_layers(const bis_film *f, bis_channel channels[BIS_FILM_MAX_CHANNELS], float *planes);

size_t bis_film_bytes(const bis_film *f);

#endif
