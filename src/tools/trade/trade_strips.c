/* SPDX-License-Identifier: BSD-2-Clause */
/* trade_strips: the pictures of the page: equal-time strips with crops and false-colour errors, and the slider.
 *
 * A picture is a PNG in base64, once in the page, as a CSS variable; what shows it, whole or a crop of it, is an
 * element with that background. All have one exposure, from the reference, so that what differs is the method. Crops
 * are windows of a quarter of the picture's sides: the one in which the methods err most, and the next that does not
 * overlap it. Errors are those of `bis compare --diff`. */
#include "base/text.h"
#include "trade_page.h"

#include "bis/tools/compare.h"
#include "bis/base/mem.h"
#include "files/image_png.h"
#include "out/markup.h"

#include <stdlib.h>

enum { CROP = 4, N_CROPS = 2 }; /* a crop is 1/CROP of the sides */

/* ---- exposure ---- */

/* The share of geometry in each pixel of the measured window, by 16 rays a pixel, for channel "A" of the reference: its
 * files hold colours alone. NULL: no memory. */
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

    if (!coverage) return bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for the pictures of the report");
    channels[3] = (bis_channel){"A", coverage, 1};
    picture.n_channels = 4;
    *exposure = bis_png_exposure(&picture);
    bis_free(coverage);
    return BIS_OK;
}

/* ---- pictures ---- */

static bis_status put_picture(bis_json *j, const char *name, const bis_image *image, double exposure, bis_diag *diag)
{
    char *png = bis_markup_png(image, exposure, diag);

    if (!png) return BIS_NOMEM;
    bis_json_open(j, NULL, '{');
    bis_json_text(j, "name", name);
    bis_json_text(j, "png", png);
    bis_json_close(j);
    free(png);
    return BIS_OK;
}

/* Picture i of the strip and its error. */
static bis_status put_pair(bis_json *j, const bis_trade *t, int i, double exposure, bis_diag *diag)
{
    bis_image error;
    char name[16];

    snprintf(name, sizeof name, "p%d", i);
    bis_status status = put_picture(j, name, &t->strip[i].image, exposure, diag);
    if (!status) status = bis_compare_picture(&error, &t->strip[i].image, &t->both.image, diag);
    if (status) return status;
    snprintf(name, sizeof name, "e%d", i);
    status = put_picture(j, name, &error, 0, diag);
    bis_image_clear(&error);
    return status;
}

bis_status bis_trade_put_pictures(bis_json *j, const bis_trade *t, bis_diag *diag)
{
    double exposure;
    bis_status status = bis_trade_exposure(&exposure, t, diag);

    if (status) return status;
    bis_trade_say(j, "ratio=%d/%d", t->both.image.width, t->both.image.height);
    bis_json_open(j, "pictures", '[');
    status = put_picture(j, "ref", &t->both.image, exposure, diag);
    for (int i = 0; i < t->n_strip && !status; i++) status = put_pair(j, t, i, exposure, diag);
    bis_json_close(j);
    return status;
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

/* ---- the strip ---- */

/* Where a window lies, in percent as CSS counts for backgrounds: of what is left beside it. */
static double share(int at, int full)
{
    const int left = full - (full + CROP - 1) / CROP;
    return left > 0 ? 100.0 * at / left : 0;
}

/* Frames in the whole picture, and the enlarged parts of picture `name`. */
static void put_crops(bis_json *j, const char *name, const bis_image *image, const window crops[N_CROPS])
{
    bis_json_open(j, "crops", '[');
    for (int k = 0; k < N_CROPS; k++)
        bis_trade_say_all(j, NULL, "number=%d; left=%.2f; top=%.2f; picture=%s; x=%.2f; y=%.2f", k,
                          100.0 * crops[k].x / image->width, 100.0 * crops[k].y / image->height, name,
                          share(crops[k].x, image->width), share(crops[k].y, image->height));
    bis_json_close(j);
}

static void put_shot(bis_json *j, const bis_trade *t, int i, const window crops[N_CROPS])
{
    const bis_trade_picture *p = &t->strip[i];
    const bis_trade_setting *s = &t->plan.settings[p->setting];
    char name[16], time[24], error[24];

    snprintf(name, sizeof name, "p%d", i);
    bis_json_open(j, NULL, '{');
    bis_trade_put_name(j, s);
    bis_trade_say(j, "made=%u pass%s, %s%s", (unsigned)p->passes, p->passes == 1 ? "" : "es",
                  bis_duration(time, p->seconds), s->is_biased ? ", biased" : "");
    bis_trade_say(j, "picture=%s; errors=e%d; error=%s", name, i, bis_percent(error, sqrt(p->relmse)));
    put_crops(j, name, &p->image, crops);
    bis_json_close(j);
}

/* The slider begins with the worst at its left and the best at its right. */
static void put_slider(bis_json *j, const bis_trade *t)
{
    int worst = 0, best = 0;

    for (int i = 1; i < t->n_strip; i++) {
        if (t->strip[i].relmse > t->strip[worst].relmse) worst = i;
        if (t->strip[i].relmse < t->strip[best].relmse) best = i;
    }
    if (worst == best) bis_trade_say(j, "left=ref; right=p%d", best);
    else bis_trade_say(j, "left=p%d; right=p%d", worst, best);
    bis_json_open(j, "choice", '[');
    bis_trade_say_all(j, NULL, "picture=ref; name=reference");
    for (int i = 0; i < t->n_strip; i++)
        bis_trade_say_all(j, NULL, "picture=p%d; name=%s", i, t->plan.settings[t->strip[i].setting].name);
    bis_json_close(j);
}

void bis_trade_put_strip(bis_json *j, const bis_trade *t)
{
    window crops[N_CROPS];
    char time[24];

    if (t->n_strip == 0) {
        bis_json_null(j, "strip");
        return;
    }
    find_crops(t, crops);
    bis_json_open(j, "strip", '{');
    bis_trade_say(j, "time=%s; reference=ref; made=%s", bis_duration(time, t->plan.run_seconds),
                  t->plan.is_given ? "as given" : "the mean of both");
    put_crops(j, "ref", &t->both.image, crops);
    bis_json_open(j, "shots", '[');
    for (int i = 0; i < t->n_strip; i++) put_shot(j, t, i, crops);
    bis_json_close(j);
    put_slider(j, t);
    bis_json_close(j);
}
