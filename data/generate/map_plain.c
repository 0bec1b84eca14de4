/* SPDX-License-Identifier: BSD-2-Clause */
/* map_plain: maps that are all idea: what they should do to a picture can be said in a sentence. */
#include "map.h"

#include <math.h>

static vec3 towards(double azimuth_deg, double height_deg)
{
    double a = azimuth_deg * PI / 180, h = height_deg * PI / 180;
    return vec3_from(cos(a) * cos(h), sin(a) * cos(h), sin(h));
}

static rgb even(const void *data, vec3 w)
{
    (void)w;
    return *(const rgb *)data;
}

/* Red from one side, green-blue from the other: together white. */
bis_status map_lamps(bis_image *image, bis_diag *diag)
{
    const rgb rest = {0.03f, 0.03f, 0.03f};
    bis_status status = map_paint(image, 512, 1, even, &rest, diag);

    if (status) return status;
    map_add_disc(image, towards(232, 36), 0.045, (rgb){170, 14, 6});
    map_add_disc(image, towards(308, 36), 0.045, (rgb){6, 95, 150});
    return BIS_OK;
}

/* Six squares in a row on the side of -y, half 0.3 to 7 degrees wide, of all colours, each of the same power: the
 * smaller the brighter. */
static rgb squares(const void *data, vec3 w)
{
    static const double half_deg[6] = {0.3, 7, 0.6, 4, 1.2, 7};
    const double cell = 25 * PI / 180, middle = 34 * PI / 180, power = 0.15;
    double u = atan2(-(double)w.y, (double)w.x) - 15 * PI / 180, v = asin((double)w.z); /* u from the row's end */
    int i = (int)floor(u / cell);

    (void)data;
    if (i < 0 || i > 5) return (rgb){0.01f, 0.01f, 0.01f};
    double half = half_deg[i] * PI / 180, hue = (5 * i) / 6.0 * 2 * PI;
    if (fabs(v - middle) > half || fabs(u - (i + 0.5) * cell) * cos(middle) > half) return (rgb){0.01f, 0.01f, 0.01f};
    double L = power / (4 * half * half);
    return rgb_from(L * (0.55 + 0.45 * cos(hue)), L * (0.55 + 0.45 * cos(hue - 2 * PI / 3)),
        L * (0.55 + 0.45 * cos(hue + 2 * PI / 3)));
}

bis_status map_squares(bis_image *image, bis_diag *diag) { return map_paint(image, 1024, 4, squares, NULL, diag); }

/* Pixel (36, 9) of 64 x 32 alone is lit. */
bis_status map_one_pixel(bis_image *image, bis_diag *diag)
{
    bis_status status = bis_image_init(image, 64, 32, diag);

    if (!status) image->pixels[9 * 64 + 36] = (rgb){300, 280, 250};
    return status;
}

static rgb halves(const void *data, vec3 w)
{
    (void)data;
    return w.x < 0 ? (rgb){1, 0, 0} : (rgb){0, 0, 1};
}

bis_status map_halves(bis_image *image, bis_diag *diag) { return map_paint(image, 32, 1, halves, NULL, diag); }

bis_status map_constant(bis_image *image, bis_diag *diag)
{
    const rgb one = {1, 1, 1};
    return map_paint(image, 32, 1, even, &one, diag);
}
