/* SPDX-License-Identifier: BSD-2-Clause */
/* flat_compare: how far one array of pixels is from another. Needs no files, so pages have it, too. */
#include "bis/flat/image.h"
#include "bis/tools/compare.h"
#include "flat/face.h"

#include <string.h>

/* Two arrays of so many channels as images. The caller clears both, after an error too. */
static bis_status images_of(bis_image pair[2], int width, int height, int channels, const float *const pixels[2],
                            bis_diag *diag)
{
    const bis_status status = bis_flat_image_of(&pair[0], width, height, channels, pixels[0], diag);
    return status ? status : bis_flat_image_of(&pair[1], width, height, channels, pixels[1], diag);
}

static bis_status compare(bis_comparison *c, int width, int height, int channels, const float *const pixels[2],
                          bis_diag *diag)
{
    bis_image pair[2] = {{0}};
    bis_status status = images_of(pair, width, height, channels, pixels, diag);

    if (!status) status = bis_compare(c, &pair[0], &pair[1], diag);
    for (int k = 0; k < 2; k++) bis_image_clear(&pair[k]);
    return status;
}

bis_status bis_do_compare(int width, int height, const float *a, const float *b, double *sum, bis_diag *diag)
{
    bis_comparison c;
    const bis_status status = compare(&c, width, height, 4, (const float *const[]){a, b}, diag);

    if (!status) memcpy(sum, (double[]){c.rmse, c.relmse, c.bias}, 3 * sizeof *sum);
    return status;
}

bis_status bis_do_image_compare(double *figures, int width, int height, const float *a, const float *b, bis_diag *diag)
{
    bis_comparison c;
    const bis_status status = compare(&c, width, height, 3, (const float *const[]){a, b}, diag);

    if (status) return status;
    const double all[BIS_FLAT_COMPARED] = {c.mean_a, c.mean_b, c.bias, c.bias_se, c.rmse, c.relmse, c.max_abs,
                                          (double)c.pixels, (double)c.nonfinite};
    memcpy(figures, all, sizeof all);
    return BIS_OK;
}

bis_status bis_do_image_errors(float *colours, int width, int height, const float *a, const float *b, bis_diag *diag)
{
    bis_image pair[2] = {{0}}, made = {0};
    bis_status status = images_of(pair, width, height, 3, (const float *const[]){a, b}, diag);

    if (!status) status = bis_compare_picture(&made, &pair[0], &pair[1], diag);
    if (!status) memcpy(colours, made.pixels, (size_t)width * (size_t)height * sizeof *made.pixels);
    bis_image_clear(&made);
    for (int k = 0; k < 2; k++) bis_image_clear(&pair[k]);
    return status;
}
