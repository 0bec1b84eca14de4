/* SPDX-License-Identifier: BSD-2-Clause */
/* distant: a light from one direction, which a map cannot hold, becomes a disc as wide as the sun's.
 *
 * pbrt's light gives the irradiance E to a surface that faces it. The disc has the radiance E / S, where S is the sum
 * of (covered share) x (solid angle) x (cosine to the axis) over the map's pixels. So the irradiance is E however
 * coarse the pixels are. A pixel's covered share is counted with GRID x GRID directions. */
#include "distant.h"

enum { GRID = 8 };

static double chord(vec3 a, const double b[3])
{
    const double x = (double)a.x - b[0], y = (double)a.y - b[1], z = (double)a.z - b[2];
    return sqrt(x * x + y * y + z * z);
}

/* The share of a pixel that lies on the disc. */
static double covered(const bis_envmap *em, int x, int y, const double axis[3])
{
    const double radius = 2 * sin(BIS_DISTANT_HALF_ANGLE / 2);
    const double reach = radius + PI / em->height + 2 * PI / em->width; /* no pixel is longer */
    int n = 0;

    if (chord(bis_envmap_direction(em, x, y, 0.5, 0.5), axis) > reach) return 0;
    for (int k = 0; k < GRID * GRID; k++) {
        const vec3 w = bis_envmap_direction(em, x, y, (k % GRID + 0.5) / GRID, (k / GRID + 0.5) / GRID);
        n += chord(w, axis) <= radius;
    }
    return (double)n / (GRID * GRID);
}

static double cosine(const bis_envmap *em, int x, int y, const double axis[3])
{
    const vec3 w = bis_envmap_direction(em, x, y, 0.5, 0.5);
    return (double)w.x * axis[0] + (double)w.y * axis[1] + (double)w.z * axis[2];
}

/* The rows that the disc may touch. */
static void find_rows(const bis_envmap *em, const double axis[3], int *first, int *last)
{
    const double theta = atan2(hypot(axis[0], axis[1]), axis[2]);
    *first = (int)fmax(0, floor((theta - BIS_DISTANT_HALF_ANGLE) / PI * em->height));
    *last = (int)fmin(em->height - 1, floor((theta + BIS_DISTANT_HALF_ANGLE) / PI * em->height));
}

static rgb sum_of(rgb a, rgb E, double share)
{
    return rgb_from((double)a.r + share * (double)E.r, (double)a.g + share * (double)E.g,
                    (double)a.b + share * (double)E.b);
}

bool bis_distant_add(bis_envmap *em, const bis_distant *light)
{
    const double *axis = light->towards;
    int first, last;
    double S = 0;
    const size_t middle = bis_envmap_pixel(em, vec3_from(axis[0], axis[1], axis[2]));

    find_rows(em, axis, &first, &last);
    for (int y = first; y <= last; y++)
        for (int x = 0; x < em->width; x++) {
            const double share = covered(em, x, y, axis);
            if (share > 0) S += share * em->row_solid_angle[y] * cosine(em, x, y, axis);
        }
    const int row = (int)(middle / (size_t)em->width), column = (int)(middle % (size_t)em->width);
    const double one = em->row_solid_angle[row] * cosine(em, column, row, axis); /* of the pixel in the middle */
    const double scale = 1 / (S > 0 ? S : one);
    if (!rgb_is_finite(rgb_scale(light->irradiance, scale))) return false;
    if (!(S > 0)) em->pixels[middle] = sum_of(em->pixels[middle], light->irradiance, scale);
    for (int y = first; y <= last && S > 0; y++)
        for (int x = 0; x < em->width; x++) {
            rgb *pixel = &em->pixels[(size_t)y * (size_t)em->width + (size_t)x];
            *pixel = sum_of(*pixel, light->irradiance, covered(em, x, y, axis) * scale);
        }
    return true;
}
