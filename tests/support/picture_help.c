/* SPDX-License-Identifier: BSD-2-Clause */
#include "picture_help.h"

#include "claim.h"

#include <stdlib.h>
#include <string.h>

#include <png.h>

void picture_in(bis_image *image, const char *drawing, const char *name)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    char mark[64];
    snprintf(mark, sizeof mark, "<image id=\"%s\"", name);
    const char *at = strstr(drawing, mark);
    assert_non_null(at);
    at = strstr(at, "base64,") + 7;
    unsigned char *file = malloc(strlen(at)), *rows;
    size_t n = 0;
    unsigned long bits = 0;
    for (size_t i = 0; strchr(digits, at[i]); i++) {
        bits = bits << 6 | (unsigned long)(strchr(digits, at[i]) - digits);
        if (i % 4 > 0) file[n++] = (unsigned char)(bits >> (6 - 2 * (i % 4)));
    }
    png_image png = {.version = PNG_IMAGE_VERSION};
    assert_true(png_image_begin_read_from_memory(&png, file, n));
    png.format = PNG_FORMAT_RGB;
    rows = malloc(PNG_IMAGE_SIZE(png));
    assert_true(png_image_finish_read(&png, NULL, rows, 0, NULL));
    assert_int_equal(bis_image_init(image, (int)png.width, (int)png.height, NULL), BIS_OK);
    for (size_t i = 0; i < (size_t)png.width * png.height; i++) {
        double c[3];
        for (size_t k = 0; k < 3; k++) c[k] = bis_image_to_linear(rows[3 * i + k] / 255.0, BIS_GAMMA_SRGB);
        image->pixels[i] = rgb_from(c[0], c[1], c[2]);
    }
    free(rows);
    free(file);
}
