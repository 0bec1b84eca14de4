/* trade_truth: what relative error have renders that should be alike? For scripts/bench/trade_truth.sh.
 *
 *     trade_truth N REFERENCE... PICTURE...
 *
 * The variance of a pixel is that of the pictures (R >= 2, equal but for their seeds) about their mean, over R - 1; it is
 * divided by b^2 + m^2/100 as in relMSE, b the mean of the N references, m the mean of that. Prints the root of the mean,
 * and its standard error by the halves of the pictures' pixels, odd and even. No reference needs to be better than the
 * pictures: it stands in the denominator alone. */
#include "bis/base/mem.h"
#include "bis/files/image_file.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { MOST = 32 };

static double channel(const bis_image *image, size_t i)
{
    const rgb c = image->pixels[i / 3];
    return (double)(i % 3 == 0 ? c.r : i % 3 == 1 ? c.g : c.b);
}

static double mean_of(const bis_image *images, int n, size_t i)
{
    double sum = 0;
    for (int k = 0; k < n; k++) sum += channel(&images[k], i);
    return sum / n;
}

int main(int argc, char **argv)
{
    bis_image images[MOST] = {{0}};
    const int n = argc - 2, N = argc > 1 ? atoi(argv[1]) : 0, R = n - N;
    bis_diag diag = {0};

    if (N < 1 || R < 2 || n > MOST) {
        fprintf(stderr, "trade_truth: usage: trade_truth N REFERENCE... PICTURE..., two pictures at least\n");
        return 2;
    }
    for (int k = 0; k < n; k++) {
        if (!bis_image_read(&images[k], argv[k + 2], (bis_loc){0}, &diag)) continue;
        fprintf(stderr, "trade_truth: %s: %s\n", argv[k + 2], diag.n ? diag.messages[0].text : "cannot be read");
        return 1;
    }
    const size_t size = 3 * (size_t)images[0].width * (size_t)images[0].height;
    double m = 0, half[2] = {0};
    for (int k = 1; k < n; k++) {
        if (images[k].width == images[0].width && images[k].height == images[0].height) continue;
        fprintf(stderr, "trade_truth: %s has another size\n", argv[k + 2]);
        return 2;
    }
    for (size_t i = 0; i < size; i++) m += mean_of(images, N, i) / (double)size;
    for (size_t i = 0; i < size; i++) {
        const double b = mean_of(images, N, i), mean = mean_of(images + N, R, i);
        double squares = 0;
        for (int k = 0; k < R; k++) squares += pow(channel(&images[N + k], i) - mean, 2) / (R - 1);
        if (squares > 0) half[i / 3 % 2] += squares / (b * b + m * m / 100) / ((double)size / 2);
    }
    const double error = sqrt((half[0] + half[1]) / 2);
    printf("%.4f %.4f\n", error, error > 0 ? fabs(half[0] - half[1]) / (4 * error) : 0);
    for (int k = 0; k < n; k++) bis_image_clear(&images[k]);
    return 0;
}
