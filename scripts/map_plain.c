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
    const rgb rest = {0.05f, 0.05f, 0.05f};
    bis_status status = map_paint(image, 512, 1, even, &rest, diag);

    if (status) return status;
    map_add_disc(image, towards(205, 30), 0.05, (rgb){170, 14, 6});
    map_add_disc(image, towards(335, 30), 0.05, (rgb){6, 95, 150});
    return BIS_OK;
}

/* Squares on a grid of 12 x 3, side 0.6 to 14 degrees, every colour of the wheel, each of the same power: the smaller the brighter. */
static rgb squares(const void *data, vec3 w)
{
    double azimuth = atan2((double)w.y, (double)w.x), height = asin((double)w.z);
    double cell = 30 * PI / 180, i = floor(azimuth / cell), j = floor(height / cell);
    double u = azimuth - (i + 0.5) * cell, v = height - (j + 0.5) * cell;
    double k = 3 * (i + 6) + j, half = (0.3 + 6.7 * pow(map_hash((int64_t)k, 4, 2), 2.5)) * PI / 180, hue = k / 36 * 2 * PI;
    double power = 0.035;

    (void)data;
    if (j < 0 || fabs(v) > half || fabs(u) * cos((j + 0.5) * cell) > half) return (rgb){0.02f, 0.02f, 0.02f};
    double L = power / (4 * half * half);
    return rgb_from(L * (0.55 + 0.45 * cos(hue)), L * (0.55 + 0.45 * cos(hue - 2 * PI / 3)), L * (0.55 + 0.45 * cos(hue + 2 * PI / 3)));
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

bis_status map_halves(bis_image *image, bis_diag *diag) { return map_paint(image, 64, 1, halves, NULL, diag); }

bis_status map_constant(bis_image *image, bis_diag *diag)
{
    const rgb one = {1, 1, 1};
    return map_paint(image, 32, 1, even, &one, diag);
}
