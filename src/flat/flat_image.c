/* SPDX-License-Identifier: BSD-2-Clause */
/* flat_image: pictures as arrays, from files and into them. */
#include "bis/flat/image.h"

#include "bis/base/mem.h"
#include "bis/beyond/mapping.h"
#include "bis/files/image_file.h"
#include "files/image_png.h"
#include "flat/face.h"

#include <stdlib.h>
#include <string.h>

struct bis_flat_image {
    bis_image image;
    bis_image_place place;
};

/* ---- reading ---- */

/* Hands over what was made, or frees it. */
static bis_status hand_over(bis_flat_image **image, bis_status status, const bis_flat_image *made, bis_diag *diag)
{
    bis_flat_image *kept = status ? NULL : bis_alloc(1, sizeof *kept);
    bis_image all = made->image;

    if (!status && !kept) status = bis_error(diag, BIS_NOMEM, nowhere, "no memory for an image");
    if (kept) *kept = *made;
    else bis_image_clear(&all);
    *image = kept;
    return status;
}

bis_status bis_do_image_read(bis_flat_image **image, const char *path, bis_diag *diag)
{
    bis_flat_image made = {0};
    return hand_over(image, bis_image_read_part(&made.image, NULL, &made.place, path, nowhere, diag), &made, diag);
}

bis_status bis_do_image_of_light(bis_flat_image **image, const bis_light *light, const char *mapping, int width,
                                 double *power, bis_diag *diag)
{
    const bis_mapping to = bis_mapping_find(mapping);
    bis_flat_image made = {0};

    if (to == BIS_N_MAPPINGS) return bis_flat_no_mapping(diag, mapping);
    if (width < 0) return bis_flat_refuse(diag, "width is %d: give a width, or 0 for one that shows all detail", width);
    const bis_status status = bis_envmap_to_mapping(&made.image, bis_light_envmap(light), to, width, power, diag);
    made.place = (bis_image_place){.full_width = made.image.width, .full_height = made.image.height};
    return hand_over(image, status, &made, diag);
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
    memcpy(pixels, image->image.pixels, (size_t)image->image.width * (size_t)image->image.height * 3 * sizeof *pixels);
}

/* ---- an array as an image ---- */

enum { MOST_ATTRIBUTES = 16, MOST_NAME = 64 };

/* "name=text"; the names are cut out into names. */
static bis_status read_attributes(bis_attribute *all, char names[][MOST_NAME], int *n, const char *const *texts,
                                  bis_diag *diag)
{
    *n = 0;
    for (; texts && texts[*n]; ++*n) {
        const size_t length = strcspn(texts[*n], "=");
        if (*n == MOST_ATTRIBUTES || length == 0 || length >= MOST_NAME || !texts[*n][length])
            return bis_flat_refuse(diag, "\"%.80s\" is no attribute: give at most %d as name=text, a name of at most "
                                   "%d bytes", texts[*n], MOST_ATTRIBUTES, MOST_NAME - 1);
        memcpy(names[*n], texts[*n], length);
        names[*n][length] = '\0';
        all[*n] = (bis_attribute){.name = names[*n], .text = texts[*n] + length + 1};
    }
    return BIS_OK;
}

bis_status bis_do_image_save(const char *path, int width, int height, const float *pixels, const float *alpha,
                             double exposure, const char *const *attributes, bis_diag *diag)
{
    bis_image image = {0};
    bis_channel channels[4];
    bis_attribute all[MOST_ATTRIBUTES];
    char names[MOST_ATTRIBUTES][MOST_NAME];
    int n;
    bis_status status = read_attributes(all, names, &n, attributes, diag);

    if (!status) status = bis_flat_image_of(&image, width, height, 3, pixels, diag);
    if (!status) {
        bis_picture picture = bis_image_picture(&image, channels);
        channels[3] = (bis_channel){"A", alpha, 1};
        picture.n_channels = alpha ? 4 : 3;
        picture.attributes = all;
        picture.n_attributes = n;
        picture.has_exposure = !isnan(exposure);
        picture.exposure = exposure;
        status = bis_image_write(path, &picture, diag);
    }
    bis_image_clear(&image);
    return status;
}

bis_status bis_do_image_png(int width, int height, const float *pixels, double exposure, size_t room, uint8_t *bytes,
                            size_t *length, bis_diag *diag)
{
    bis_image image = {0};
    bis_channel channels[4];
    char *png = NULL;
    size_t n = 0;
    bis_status status = bis_flat_image_of(&image, width, height, 3, pixels, diag);

    if (!status) {
        FILE *stream = open_memstream(&png, &n);
        bis_picture picture = bis_image_picture(&image, channels);
        picture.has_exposure = true;
        picture.exposure = exposure;
        const bool ok = stream && bis_png_write(stream, &picture, "picture", NULL) == BIS_OK;
        if (!(stream && fclose(stream) == 0 && ok))
            status = bis_error(diag, BIS_NOMEM, nowhere, "no memory for a picture of %d x %d", width, height);
    }
    if (!status && n > room) status = bis_flat_refuse(diag, "room is %zu: the picture has %zu bytes", room, n);
    if (!status) {
        memcpy(bytes, png, n);
        *length = n;
    }
    free(png); /* the C library's, not ours */
    bis_image_clear(&image);
    return status;
}

bis_status bis_do_image_exposure(double *exposure, int width, int height, const float *pixels, const float *coverage,
                                 bis_diag *diag)
{
    bis_image image = {0};
    bis_channel channels[4];
    const bis_channel subject = {"A", coverage, 1};
    const bis_status status = bis_flat_image_of(&image, width, height, 3, pixels, diag);

    if (!status) {
        bis_picture picture = bis_image_picture(&image, channels);
        picture.subject = coverage ? &subject : NULL;
        *exposure = bis_png_exposure(&picture);
    }
    bis_image_clear(&image);
    return status;
}
