/* SPDX-License-Identifier: BSD-2-Clause */
/* image: pixels in memory. */
#include "bis/base/image.h"

#include "bis/base/mem.h"

#include <math.h>

bis_status bis_image_init(bis_image *image, int width, int height, bis_diag *diag)
{
    const bis_loc nowhere = {0};
    *image = (bis_image){0};
    if (width < 1 || height < 1 || width > BIS_IMAGE_MAX_SIDE || height > BIS_IMAGE_MAX_SIDE)
        return bis_error(diag, BIS_INPUT, nowhere, "an image of %d x %d pixels: a side must be 1 to %d", width, height,
                         BIS_IMAGE_MAX_SIDE);
    rgb *pixels = bis_alloc((size_t)width * (size_t)height, sizeof *pixels); /* zero is black */
    if (!pixels) return bis_error(diag, BIS_NOMEM, nowhere, "no memory for %d x %d pixels", width, height);
    *image = (bis_image){width, height, pixels, NULL};
    return BIS_OK;
}

bis_status bis_image_add_alpha(bis_image *image, bis_diag *diag)
{
    image->alpha = bis_alloc((size_t)image->width * (size_t)image->height, sizeof *image->alpha);
    return image->alpha ? BIS_OK : bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for alpha");
}

void bis_image_clear(bis_image *image)
{
    bis_free(image->pixels);
    bis_free(image->alpha);
    *image = (bis_image){0};
}

/* IEC 61966-2-1. */
double bis_image_to_linear(double v, double gamma)
{
    if (gamma != BIS_GAMMA_SRGB) return pow(v, gamma);
    return v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4);
}

double bis_image_from_linear(double v, double gamma)
{
    if (gamma != BIS_GAMMA_SRGB) return pow(v, 1 / gamma);
    return v <= 0.0031308 ? 12.92 * v : 1.055 * pow(v, 1 / 2.4) - 0.055;
}
