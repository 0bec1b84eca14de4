/* SPDX-License-Identifier: BSD-2-Clause */
/* film: the sums behind the pixels. A pass adds one value to every pixel, from one or several camera samples. The
 * picture is the mean over the passes, weighted by their camera samples. */
#pragma once

#include "bis/base/image.h"
#include "bis/scene/layers.h"
#include "bis/base/status.h"
#include "bis/base/vec.h"

#include <stdbool.h>
#include <stdint.h>

/* A film covers the pixels [x0, x0 + width) x [y0, y0 + height) of the full image. A thin film holds one pixel of
 * each k x k pixels of a picture: its pixel (x, y) is pixel (k x + k/2, k y + k/2) of the picture, and it receives
 * the same values bit for bit (except for methods that learn, see src/render/pass.c). A thin film therefore shows
 * the noise of a large picture in a part of the time. */
typedef struct bis_film {
    int full_width, full_height;
    int step;                  /* k; 1: the picture itself */
    int picture_width, picture_height; /* the size of what the camera sees; with step 1 the full image */
    int x0, y0, width, height; /* the crop */
    double *sum;               /* sum[height][width][3] of weight x radiance over passes */
    float *deviation;          /* the same shape: root of the weighted mean of (radiance of a pass - mean)^2 */
    float *half;               /* half[height][width][3]: the mean of the first passes, those of weight half_weight */
    /* hits[height][width]: sum over passes of weight x the share of the pass's camera samples that hit geometry. How
     * exact it is: src/render/film.c. */
    float *hits;
    uint32_t passes;           /* complete passes */
    double weight;             /* the sum of the weights of the passes, the same in every pixel */
    double half_weight;        /* of the first passes whose mean is kept, about half; 0 before the second pass */
    double most;               /* the weight expected at the end, so that the halves come out alike; 0: unknown */
    bool independent;          /* no sequence spreads the camera samples of a pixel; set before the first pass */
    bool transparent;          /* its background is no light that the camera sees: hits / weight is alpha */
    bis_layers layers;         /* none, unless bis_film_want asks for some */
    double *twin;              /* twin[bis_film_twins][2][3]: `sum` and `half` of the second renders; NULL: none */
} bis_film;

/* Pixels [x0, x1) x [y0, y1) of the full picture. */
typedef struct bis_rect {
    int x0, y0, x1, y1;
} bis_rect;

/* bis_is_in returns whether pixel (x, y) is in r. */
static inline bool bis_is_in(bis_rect r, int x, int y) { return x >= r.x0 && x < r.x1 && y >= r.y0 && y < r.y1; }

/* bis_film_crop returns the pixels that the film covers. */
static inline bis_rect bis_film_crop(const bis_film *f)
{
    return (bis_rect){f->x0, f->y0, f->x0 + f->width, f->y0 + f->height};
}

/* bis_film_place returns a film with its sizes and places but without sums: nothing is allocated, and nothing can be
 * rendered into it. step >= 1. crop[4] = x0, x1, y0, y1 in [0,1], with pbrt's rounding: ceil(full * x). width or
 * height is <= 0 if the crop holds no pixel. */
bis_film bis_film_place(int width, int height, const double crop[4], int step);

/* bis_film_read_crop reads "0.25,0.75,0,1" into crop[4]: x0 < x1 and y0 < y1, all in [0,1]. Returns false if the text
 * is something else. */
bool bis_film_read_crop(double crop[4], const char *text);

/* bis_film_init allocates a film of full_width x full_height pixels and a crop of them, all sums 0. `at` is the place
 * that messages name. Errors: BIS_INPUT (a crop outside [0,1], or empty), BIS_NOMEM. */
bis_status bis_film_init(bis_film *f, int full_width, int full_height, const double crop[4], bis_loc at,
                         bis_diag *diag);

/* bis_film_init_thin does the same for a thin film of a picture of width x height pixels; step >= 1. Errors: also
 * BIS_INPUT if the crop holds none of its pixels. */
bis_status bis_film_init_thin(bis_film *f, int width, int height, const double crop[4], int step, bis_loc at,
                              bis_diag *diag);

/* bis_film_init_like allocates a film of the sizes and the place of `sizes`, which need not have sums, all sums 0 and
 * without layers. Errors: BIS_NOMEM. */
bis_status bis_film_init_like(bis_film *f, const bis_film *sizes, bis_loc at, bis_diag *diag);

/* bis_film_clear frees the sums; f may be NULL. *f is empty afterwards. */
void bis_film_clear(bis_film *f);

/* bis_film_tiles returns how many tiles of `side` x `side` pixels the crop touches; *across receives how many of them
 * lie side by side. Tiles are counted from the corner of the full picture, so a crop has the same tiles as its
 * picture. */
int bis_film_tiles(const bis_film *f, int side, int *across);

/* bis_film_tile returns the t-th of these tiles in reading order: the part that lies in the picture. */
bis_rect bis_film_tile(const bis_film *f, int side, int t);

/* bis_film_tile_at returns the number of the tile that holds the pixel at column x and row y of the picture. */
int bis_film_tile_at(const bis_film *f, int side, int x, int y);

/* bis_film_tile_of_crop returns the part of the t-th tile that lies in the crop. */
bis_rect bis_film_tile_of_crop(const bis_film *f, int side, int t);

/* bis_film_add adds one pass of one pixel. L, the mean of the pass's camera samples, must be finite; `hit` is the share
 * of them that hit geometry; weight > 0 is the pass's. A pixel belongs to one thread at a time. */
void bis_film_add(bis_film *f, int x, int y, rgb L, double hit, double weight);

/* bis_film_end_pass counts a pass of this weight, after every pixel was added. The weight must not depend on what was
 * rendered, because the picture would otherwise be biased. */
void bis_film_end_pass(bis_film *f, double weight);

/* bis_film_resolve stores in rgba[height][width][4] the mean radiance and the share of samples that hit. A mean below
 * 0, which a control variate (src/beyond/guide.c) may leave where little light arrives, becomes 0. */
void bis_film_resolve(const bis_film *f, float *rgba);

/* bis_film_raised returns how much that adds, as a share of the sum of all values; usually 0, seldom above 1e-5. */
double bis_film_raised(const bis_film *f);

/* ---- twins, pixels that are rendered twice: src/render/film_twins.c ---- */

enum { BIS_TWIN_VALUES = 6 }; /* in film->twin, of each */

/* A twin: its pixel in the full picture, and its place in film->twin. */
typedef struct bis_twin {
    int x, y;
    size_t at;
    int next; /* of the squares, that bis_film_next_twin looks at */
} bis_twin;

/* bis_film_twin_side returns K: one pixel of each K x K pixels of the full picture has a twin. */
int bis_film_twin_side(const bis_film *f);

/* bis_film_twins returns how many places film->twin has: one for each of these squares that the crop touches. Where the
 * pixel of a square lies beside the crop, its place stays 0. */
size_t bis_film_twins(const bis_film *f);

/* bis_film_next_twin stores the next twin of the rectangle r of the crop in *t, which is all 0 before the first one.
 * Returns false if there is none left. */
bool bis_film_next_twin(const bis_film *f, bis_rect r, bis_twin *t);

/* bis_film_want_twins gives the film twins. It is called before the first pass; each pass must then be added to all of
 * them (bis_film_add_twin). Errors: BIS_NOMEM. */
bis_status bis_film_want_twins(bis_film *f, bis_diag *diag);

/* bis_film_add_twin adds one pass of a twin, as bis_film_add adds one of a pixel. */
void bis_film_add_twin(bis_film *f, const bis_twin *t, rgb L, double weight);

/* ---- the error: src/render/film_error.c ---- */

/* What a film says about its own error. */
typedef struct bis_film_error {
    double relative_rmse; /* sqrt(relMSE), estimated without a reference; NAN: fewer than two passes */
    double upper;         /* a bound that the error of this picture exceeds in one of 20 renders; NAN as above */
    double scatter;       /* relative_rmse if the passes were independent: what strata gain is not seen; NAN as above */
    /* false: few pixels carry the error, and the figure may be wrong by a fifth or more, with fewer than 8 samples by a
     * third */
    bool is_known;
    bool has_upper;       /* false: the error is so large that `upper` tells nothing */
    bool is_bounded;      /* `upper` is near enough to the error to end a render by. True wherever is_known is */
} bis_film_error;

/* bis_film_estimate_error estimates the relative RMSE of the picture without a reference: sqrt(relMSE) of
 * docs/trust.md, "Error", which defines it. The means of the pixels stand in for the reference values. What strata
 * gain is estimated, too, unless the film is told that its passes are independent. */
bis_film_error bis_film_estimate_error(const bis_film *f);

/* bis_film_variance estimates the variance of value i of the picture [height][width][3] from the scatter of the passes,
 * at least 2, as if they were independent. Where strata gain something, it is too large. */
double bis_film_variance(const bis_film *f, size_t i);

/* ---- layers: src/render/film_layers.c ---- */

/* bis_film_want requests layers, a set of bis/scene/layers.h. It is called once, before the first pass. Errors:
 * BIS_NOMEM. */
bis_status bis_film_want(bis_film *f, unsigned layers, bis_diag *diag);

enum { BIS_FILM_MAX_CHANNELS = 24 };

/* bis_film_layers returns the number n of the layers' channels, at most BIS_FILM_MAX_CHANNELS, and fills channels[n],
 * ready for an EXR. planes[n][height][width] receives the values, and the channels point into it. If planes is NULL,
 * it gives only names and number. Standard errors and intervals need two passes and are left out of a film with
 * fewer. Pixels without a surface hold 0. */
int bis_film_layers(const bis_film *f, bis_channel channels[BIS_FILM_MAX_CHANNELS], float *planes);

/* The bytes of a pixel's sums, without layers. */
enum { BIS_FILM_BYTES = 3 * sizeof(double) + 7 * sizeof(float) };

/* bis_film_bytes returns the bytes that the sums take. */
size_t bis_film_bytes(const bis_film *f);
