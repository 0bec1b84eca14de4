/* SPDX-License-Identifier: BSD-2-Clause */
/* flat_image: pictures as arrays, from files and into them, and compared. */
#include "bis/flat/image.h"

#include "bis/base/mem.h"
#include "bis/beyond/mapping.h"
#include "bis/files/image_file.h"
#include "bis/tools/compare.h"
#include "files/image_png.h"
#include "flat/say.h"

#include <stdlib.h>
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

int bis_flat_image_of_light(bis_flat_image **image, const bis_light *light, const char *mapping, int width,
                            double *power, char *say, size_t size)
{
    bis_diag diag = {0};
    bis_status status = BIS_FLAT_GIVEN(&diag, image, light, mapping, power);
    const bis_mapping to = status ? BIS_N_MAPPINGS : bis_mapping_find(mapping);
    bis_flat_image *made = status ? NULL : bis_alloc(1, sizeof *made);

    if (image) *image = NULL;
    if (!status && !made) status = bis_error(&diag, BIS_NOMEM, nowhere, "no memory for an image");
    if (!status) *made = (bis_flat_image){0};
    if (!status && (to == BIS_N_MAPPINGS || width < 0))
        status = bis_error(&diag, BIS_INPUT, nowhere, "mapping \"%.40s\" and width %d: give one of `bis help lights` "
                           "and a width, or 0", mapping, width);
    if (!status) status = bis_envmap_to_mapping(&made->image, bis_light_envmap(light), to, width, power, &diag);
    if (!status) made->place = (bis_image_place){.full_width = made->image.width, .full_height = made->image.height};
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

enum { MOST_ATTRIBUTES = 16, MOST_NAME = 64 };

/* "name=text"; the names are cut out into names. */
static bis_status read_attributes(bis_attribute *all, char names[][MOST_NAME], int *n, const char *const *texts,
                                  bis_diag *diag)
{
    *n = 0;
    for (; texts && texts[*n]; ++*n) {
        const size_t length = strcspn(texts[*n], "=");
        if (*n == MOST_ATTRIBUTES || length == 0 || length >= MOST_NAME || !texts[*n][length])
            return bis_error(diag, BIS_INPUT, nowhere, "\"%.80s\" is no attribute: give at most %d as name=text, a "
                             "name of at most %d bytes", texts[*n], MOST_ATTRIBUTES, MOST_NAME - 1);
        memcpy(names[*n], texts[*n], length);
        names[*n][length] = '\0';
        all[*n] = (bis_attribute){.name = names[*n], .text = texts[*n] + length + 1};
    }
    return BIS_OK;
}

int bis_flat_image_save(const char *path, int width, int height, const float *pixels, double exposure,
                        const char *const *attributes, char *say, size_t size)
{
    bis_diag diag = {0};
    bis_image image = {0};
    bis_channel channels[4];
    bis_attribute all[MOST_ATTRIBUTES];
    char names[MOST_ATTRIBUTES][MOST_NAME];
    int n = 0;
    bis_status status = BIS_FLAT_GIVEN(&diag, path, pixels);

    if (!status) status = read_attributes(all, names, &n, attributes, &diag);
    if (!status) status = image_of(&image, width, height, pixels, &diag);
    if (!status) {
        bis_picture picture = bis_image_picture(&image, channels);
        picture.attributes = all;
        picture.n_attributes = n;
        picture.has_exposure = !isnan(exposure);
        picture.exposure = exposure;
        status = bis_image_write(path, &picture, &diag);
    }
    bis_image_clear(&image);
    return bis_flat_end(status, &diag, say, size);
}

int bis_flat_image_png(int width, int height, const float *pixels, double exposure, size_t room, uint8_t *bytes,
                       size_t *length, char *say, size_t size)
{
    bis_diag diag = {0};
    bis_image image = {0};
    bis_channel channels[4];
    char *png = NULL;
    size_t n = 0;
    bis_status status = BIS_FLAT_GIVEN(&diag, pixels, bytes, length);

    if (!status) status = image_of(&image, width, height, pixels, &diag);
    if (!status) {
        FILE *stream = open_memstream(&png, &n);
        bis_picture picture = bis_image_picture(&image, channels);
        picture.has_exposure = true;
        picture.exposure = exposure;
        const bool ok = stream && bis_png_write(stream, &picture, "picture", NULL) == BIS_OK;
        if (!(stream && fclose(stream) == 0 && ok))
            status = bis_error(&diag, BIS_NOMEM, nowhere, "no memory for a picture of %d x %d", width, height);
    }
    if (!status && n > room)
        status = bis_error(&diag, BIS_INPUT, nowhere, "room is %zu: the picture has %zu bytes", room, n);
    if (!status) {
        memcpy(bytes, png, n);
        *length = n;
    }
    free(png); /* the C library's, not ours */
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
