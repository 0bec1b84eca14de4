/* SPDX-License-Identifier: BSD-2-Clause */
/* trade_strips: the pictures of the page: those of equal time, with their false-colour errors, and where to look.
 *
 * A picture is a PNG in base64. All have one exposure, from the reference, so that what differs is the method. Crops
 * are windows of a quarter of the picture's sides: the one in which the methods err most, and the next that does not
 * overlap it. Errors are those of `bis compare --diff`. */
#include "base/text.h"
#include "trade_page.h"

#include "bis/tools/compare.h"
#include "bis/base/mem.h"
#include "files/image_png.h"
#include "out/page.h"

#include <stdlib.h>

enum { CROP = 4, N_CROPS = 2 }; /* a crop is 1/CROP of the sides */

/* ---- exposure ---- */

/* The share of geometry in each pixel of the measured window, by 16 rays a pixel, because the files of the reference
 * hold colours alone. NULL: no memory. */
static float *new_coverage(const bis_trade *t, int width, int height)
{
    enum { SIDE = 4 };
    const bis_film film = bis_film_place(t->plan.width, t->plan.height, t->desc->view.film.crop, 1);
    float *coverage = bis_alloc((size_t)width * (size_t)height, sizeof *coverage);

    for (int i = 0; coverage && i < width * height; i++) {
        int hits = 0;
        for (int k = 0; k < SIDE * SIDE; k++) {
            const double x = film.x0 + i % width + (k % SIDE + 0.5) / SIDE;
            const double y = film.y0 + i / width + (k / SIDE + 0.5) / SIDE;
            const ray eye = bis_camera_ray(&t->desc->view.camera, film.full_width, film.full_height, x, y);
            bis_hit hit;
            hits += bis_accel_intersect(t->scene->accel, &eye, &hit);
        }
        coverage[i] = (float)hits / (SIDE * SIDE);
    }
    return coverage;
}

bis_status bis_trade_exposure(double *exposure, const bis_trade *t, bis_diag *diag)
{
    const bis_image *image = &t->both.image;
    bis_channel channels[4];
    bis_picture picture = bis_image_picture(image, channels);
    float *coverage = new_coverage(t, image->width, image->height);
    const bis_channel subject = {"A", coverage, 1};

    if (!coverage) return bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for the pictures of the report");
    picture.subject = &subject;
    *exposure = bis_png_exposure(&picture);
    bis_free(coverage);
    return BIS_OK;
}

/* ---- crops ---- */

typedef struct window {
    int x, y;
} window;

/* The methods' squared differences in a window, each pixel's bounded: one firefly does not choose the place. */
static double error_in(const bis_trade *t, window w, int width, int height)
{
    double sum = 0;
    for (int i = 0; i < t->n_strip; i++) {
        const bis_image *a = &t->strip[i].image, *b = &t->both.image;
        for (int y = w.y; y < w.y + height; y++) {
            for (int x = w.x; x < w.x + width; x++) {
                const size_t at = (size_t)y * (size_t)a->width + (size_t)x;
                const double va = rgb_sum(a->pixels[at]), vb = rgb_sum(b->pixels[at]), d = fabs(va - vb);
                sum += d > 0 ? fmin(d / fmax(va, vb), 0.5) : 0;
            }
        }
    }
    return sum;
}

static bool overlap(window a, window b, int width, int height)
{
    return abs(a.x - b.x) < width && abs(a.y - b.y) < height;
}

static void find_crops(const bis_trade *t, window crops[N_CROPS])
{
    const bis_image *image = &t->both.image;
    const int width = (image->width + CROP - 1) / CROP, height = (image->height + CROP - 1) / CROP;

    for (int k = 0; k < N_CROPS; k++) {
        double most = -1;
        crops[k] = (window){0, 0};
        for (int y = 0; y + height <= image->height; y += height / 3 + 1) {
            for (int x = 0; x + width <= image->width; x += width / 3 + 1) {
                const window w = {x, y};
                if (k > 0 && overlap(w, crops[0], width, height)) continue;
                const double error = error_in(t, w, width, height);
                if (error <= most) continue;
                most = error;
                crops[k] = w;
            }
        }
    }
}

/* ---- pictures ---- */

static bis_status put_picture(bis_json *j, const char *key, const bis_image *image, double exposure, bis_diag *diag)
{
    char *png = bis_page_png(image, exposure, diag);

    if (!png) return BIS_NOMEM;
    bis_json_text(j, key, png);
    free(png);
    return BIS_OK;
}

/* In pixels of the measured film. */
static void put_crops(bis_json *j, const bis_trade *t)
{
    const bis_image *image = &t->both.image;
    window crops[N_CROPS];

    if (t->n_strip) find_crops(t, crops);
    bis_json_open(j, "crops", '[');
    for (int k = 0; k < N_CROPS && t->n_strip; k++)
        BIS_JSON_OBJECT(j, NULL, {"x", crops[k].x}, {"y", crops[k].y}, {"width", (image->width + CROP - 1) / CROP},
                        {"height", (image->height + CROP - 1) / CROP});
    bis_json_close(j);
}

static bis_status put_shot(bis_json *j, const bis_trade *t, int i, double exposure, bis_diag *diag)
{
    const bis_trade_picture *p = &t->strip[i];
    bis_image error;

    bis_json_open(j, NULL, '{');
    bis_json_text(j, "setting", t->plan.settings[p->setting].name);
    BIS_JSON_NUMBERS(j, {"passes", p->passes}, {"seconds", p->seconds}, {"error", sqrt(p->relmse)});
    bis_status status = put_picture(j, "picture", &p->image, exposure, diag);
    if (!status) status = bis_compare_picture(&error, &p->image, &t->both.image, diag);
    if (!status) {
        status = put_picture(j, "errors", &error, 0, diag);
        bis_image_clear(&error);
    }
    bis_json_close(j);
    return status;
}

bis_status bis_trade_put_pictures(bis_json *j, const bis_trade *t, bis_diag *diag)
{
    double exposure;
    bis_status status = bis_trade_exposure(&exposure, t, diag);

    if (status) return status;
    put_crops(j, t);
    status = put_picture(j, "reference", &t->both.image, exposure, diag);
    bis_json_open(j, "shots", '[');
    for (int i = 0; i < t->n_strip && !status; i++) status = put_shot(j, t, i, exposure, diag);
    bis_json_close(j);
    return status;
}
