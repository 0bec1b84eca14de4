/* SPDX-License-Identifier: BSD-2-Clause */
/* trade_truth: what relative error have renders that should be alike? For scripts/bench/trade_truth.sh.
 *
 *     trade_truth N REFERENCE n PICTURE...
 *
 * The reference has N passes, each of the R >= 2 pictures n; their seeds differ. The error of a picture is the root of
 * the mean over pixels and channels of (x - c)^2 / (b^2 + m^2/100) as in relMSE: b is the reference, m its mean, and c
 * the mean of all N + R n passes, the picture's own among them, which hide the share n / (N + R n) of its variance; so
 * what is left is divided by 1 less that. Prints the median of the R errors, which half of the pictures have at most,
 * their root mean square, which a single bright pixel in one of them can rule, the least and the largest. */
#include "bis/base/mem.h"
#include "bis/files/image_file.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { MOST = 64 };

static double channel(const bis_image *image, size_t i)
{
    const rgb c = image->pixels[i / 3];
    return (double)(i % 3 == 0 ? c.r : i % 3 == 1 ? c.g : c.b);
}

static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

int main(int argc, char **argv)
{
    bis_image reference = {0}, pictures[MOST] = {{0}};
    double square[MOST] = {0}, m = 0, sum = 0;
    bis_diag diag = {0};
    const int R = argc - 4;

    if (R < 2 || R > MOST) {
        fprintf(stderr, "trade_truth: usage: trade_truth N REFERENCE n PICTURE..., two pictures at least\n");
        return 2;
    }
    const double N = atof(argv[1]), n = atof(argv[3]), own = n / (N + R * n);
    for (int k = -1; k < R; k++) {
        const char *name = k < 0 ? argv[2] : argv[k + 4];
        bis_image *image = k < 0 ? &reference : &pictures[k];
        if (bis_image_read(image, name, (bis_loc){0}, &diag)) {
            fprintf(stderr, "trade_truth: %s: %s\n", name, diag.n ? diag.messages[0].text : "cannot be read");
            return 1;
        }
        if (image->width == reference.width && image->height == reference.height) continue;
        fprintf(stderr, "trade_truth: %s has another size\n", name);
        return 2;
    }
    const size_t size = 3 * (size_t)reference.width * (size_t)reference.height;
    for (size_t i = 0; i < size; i++) m += channel(&reference, i) / (double)size;
    for (size_t i = 0; i < size; i++) {
        const double b = channel(&reference, i);
        double c = (1 - R * own) * b;
        for (int k = 0; k < R; k++) c += own * channel(&pictures[k], i);
        for (int k = 0; k < R; k++) {
            const double d = channel(&pictures[k], i) - c;
            if (d != 0) square[k] += d * d / (b * b + m * m / 100) / (double)size / (1 - own);
        }
    }
    for (int k = 0; k < R; k++) sum += square[k];
    qsort(square, (size_t)R, sizeof *square, ascending);
    const double median = (sqrt(square[(R - 1) / 2]) + sqrt(square[R / 2])) / 2;
    printf("%.4f %.4f %.4f %.4f\n", median, sqrt(sum / R), sqrt(square[0]), sqrt(square[R - 1]));
    bis_image_clear(&reference);
    for (int k = 0; k < R; k++) bis_image_clear(&pictures[k]);
    return 0;
}
