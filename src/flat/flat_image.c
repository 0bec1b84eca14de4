/* SPDX-License-Identifier: BSD-2-Clause */
/* flat_image: pictures as arrays, from files and into them, and compared. */
#include "bis/flat/image.h"

#include "bis/base/mem.h"
#include "bis/files/image_file.h"
#include "bis/tools/compare.h"
#include "files/image_png.h"
#include "flat/say.h"

#include <string.h>

struct bis_flat_image {
    bis_image image;
    bis_image_place place;
};

static const bis_loc nowhere = {0};

/* ---- reading ---- */

int bis_flat_image_read(bis_flat_image **image, const char *path, char *say, size_t size)
{
    bis_diag diag = {0};
    bis_status status = BIS_FLAT_GIVEN(&diag, image, path);
    bis_flat_image *made = status ? NULL : bis_alloc(1, sizeof *made);

    if (image) *image = NULL;
    if (!status && !made) status = bis_error(&diag, BIS_NOMEM, nowhere, "no memory for an image");
    if (!status) *made = (bis_flat_image){0};
    if (!status) status = bis_image_read_part(&made->image, NULL, &made->place, path, nowhere, &diag);
    if (!status) *image = made;
    else bis_flat_image_close(made);
    return bis_flat_end(status, &diag, say, size);
}

void bis_flat_image_close(bis_flat_image *image)
{
    if (!image) return;
    bis_image_clear(&image->image);
    bis_free(image);
}

void bis_flat_image_place(const bis_flat_image *image, int shape[2], int place[4])
{
    const bis_image_place none = {0}, *at = image ? &image->place : &none;

    if (!shape || !place) return;
    shape[0] = image ? image->image.width : 0;
    shape[1] = image ? image->image.height : 0;
    memcpy(place, (const int[4]){at->x0, at->y0, at->full_width, at->full_height}, 4 * sizeof *place);
}

void bis_flat_image_pixels(const bis_flat_image *image, float *pixels)
{
    if (!image || !pixels) return;
    const size_t n = (size_t)image->image.width * (size_t)image->image.height;
    for (size_t i = 0; i < n; i++) {
        pixels[3 * i] = image->image.pixels[i].r;
        pixels[3 * i + 1] = image->image.pixels[i].g;
        pixels[3 * i + 2] = image->image.pixels[i].b;
    }
}

/* ---- an array as an image ---- */

/* The caller clears *image, on failure too. */
static bis_status image_of(bis_image *image, int width, int height, const float *pixels, bis_diag *diag)
{
    const bis_status status = bis_image_init(image, width, height, diag);

    for (size_t i = 0; !status && i < (size_t)width * (size_t)height; i++)
        image->pixels[i] = (rgb){pixels[3 * i], pixels[3 * i + 1], pixels[3 * i + 2]};
    return status;
}

int bis_flat_image_save(const char *path, int width, int height, const float *pixels, double exposure, char *say,
                        size_t size)
{
    bis_diag diag = {0};
    bis_image image = {0};
    bis_channel channels[4];
    bis_status status = BIS_FLAT_GIVEN(&diag, path, pixels);

    if (!status) status = image_of(&image, width, height, pixels, &diag);
    if (!status) {
        bis_picture picture = bis_image_picture(&image, channels);
        picture.has_exposure = !isnan(exposure);
        picture.exposure = exposure;
        status = bis_image_write(path, &picture, &diag);
    }
    bis_image_clear(&image);
    return bis_flat_end(status, &diag, say, size);
}

int bis_flat_image_exposure(double *exposure, int width, int height, const float *pixels, const float *coverage,
                            char *say, size_t size)
{
    bis_diag diag = {0};
    bis_image image = {0};
    bis_channel channels[4];
    const bis_channel subject = {"A", coverage, 1};
    bis_status status = BIS_FLAT_GIVEN(&diag, exposure, pixels);

    if (!status) status = image_of(&image, width, height, pixels, &diag);
    if (!status) {
        bis_picture picture = bis_image_picture(&image, channels);
        picture.subject = coverage ? &subject : NULL;
        *exposure = bis_png_exposure(&picture);
    }
    bis_image_clear(&image);
    return bis_flat_end(status, &diag, say, size);
}

/* ---- two of them ---- */

/* The caller clears both, on failure too. */
static bis_status two_images(bis_image pair[2], int width, int height, const float *const pixels[2], bis_diag *diag)
{
    bis_status status = image_of(&pair[0], width, height, pixels[0], diag);
    return status ? status : image_of(&pair[1], width, height, pixels[1], diag);
}

int bis_flat_image_compare(double *figures, int width, int height, const float *a, const float *b, char *say,
                           size_t size)
{
    bis_diag diag = {0};
    bis_image pair[2] = {{0}};
    bis_comparison c;
    bis_status status = BIS_FLAT_GIVEN(&diag, figures, a, b);

    if (!status) status = two_images(pair, width, height, (const float *const[]){a, b}, &diag);
    if (!status) status = bis_compare(&c, &pair[0], &pair[1], &diag);
    if (!status) {
        const double all[BIS_FLAT_COMPARED] = {c.mean_a, c.mean_b, c.bias, c.bias_se, c.rmse, c.relmse, c.max_abs,
                                              (double)c.pixels, (double)c.nonfinite};
        memcpy(figures, all, sizeof all);
    }
    for (int k = 0; k < 2; k++) bis_image_clear(&pair[k]);
    return bis_flat_end(status, &diag, say, size);
}

int bis_flat_image_errors(float *colours, int width, int height, const float *a, const float *b, char *say,
                          size_t size)
{
    bis_diag diag = {0};
    bis_image pair[2] = {{0}};
    bis_flat_image made = {0};
    bis_status status = BIS_FLAT_GIVEN(&diag, colours, a, b);

    if (!status) status = two_images(pair, width, height, (const float *const[]){a, b}, &diag);
    if (!status) status = bis_compare_picture(&made.image, &pair[0], &pair[1], &diag);
    if (!status) bis_flat_image_pixels(&made, colours);
    bis_image_clear(&made.image);
    for (int k = 0; k < 2; k++) bis_image_clear(&pair[k]);
    return bis_flat_end(status, &diag, say, size);
}
