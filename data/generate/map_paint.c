/* SPDX-License-Identifier: BSD-2-Clause */
/* map_paint: from a radiance of directions to a map's pixels, and the noise that stone, clouds and grass are made
 * of. */
#include "map.h"

#include "bis/thesis/rng.h"

#include <math.h>

double map_smooth(double lo, double hi, double x)
{
    double t = fmin(1, fmax(0, (x - lo) / (hi - lo)));
    return t * t * (3 - 2 * t);
}

rgb map_mix(rgb a, rgb b, double t) { return rgb_add(rgb_scale(a, 1 - t), rgb_scale(b, t)); }

double map_hash(int64_t i, int64_t j, int64_t k)
{
    return (double)(bis_hash((uint64_t)i * 0x9e3779b97f4a7c15u + (uint64_t)j * 0xd1b54a32d192ed03u +
                             (uint64_t)k * 0x8cb92ba72f3d8dd7u) >>
                    11) *
           0x1p-53;
}

/* Values at whole numbers, joined by smooth steps. */
double map_noise(double x, double y, double z)
{
    double fx = floor(x), fy = floor(y), fz = floor(z), sum = 0;
    double tx = map_smooth(0, 1, x - fx), ty = map_smooth(0, 1, y - fy), tz = map_smooth(0, 1, z - fz);

    for (int c = 0; c < 8; c++) {
        int i = c & 1, j = c >> 1 & 1, k = c >> 2;
        double weight = (i ? tx : 1 - tx) * (j ? ty : 1 - ty) * (k ? tz : 1 - tz);
        sum += weight * map_hash((int64_t)fx + i, (int64_t)fy + j, (int64_t)fz + k);
    }
    return sum;
}

double map_clouds(double x, double y, double z, int octaves)
{
    double sum = 0, size = 1, total = 0;

    for (int i = 0; i < octaves; i++) {
        sum += size * map_noise(x / size + 7 * i, y / size + 3 * i, z / size + 5 * i);
        total += size;
        size *= 0.5;
    }
    return sum / total;
}

static vec3 direction(const bis_image *image, double x, double y)
{
    double phi = 2 * PI * x / image->width, theta = PI * y / image->height;
    return vec3_from(sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta));
}

bis_status map_paint(bis_image *image, int width, int n, map_radiance radiance, const void *data, bis_diag *diag)
{
    bis_status status = bis_image_init(image, width, width / 2, diag);

    if (status) return status;
#pragma omp parallel for schedule(dynamic, 4)
    for (int y = 0; y < image->height; y++) {
        for (int x = 0; x < image->width; x++) {
            rgb sum = {0, 0, 0};
            for (int s = 0; s < n * n; s++) {
                sum = rgb_add(sum, radiance(data, direction(image, x + (s % n + 0.5) / n, y + (s / n + 0.5) / n)));
            }
            image->pixels[(size_t)y * (size_t)image->width + (size_t)x] = rgb_scale(sum, 1.0 / (n * n));
        }
    }
    return BIS_OK;
}

/* The share of pixel (x, y) within the disc. */
static double disc_share(const bis_image *image, int x, int y, vec3 towards, double radius)
{
    enum { N = 16 };
    const double limit = 2 * sin(radius / 2); /* chord */
    int n = 0;

    for (int s = 0; s < N * N; s++) {
        n += length(sub(direction(image, x + (s % N + 0.5) / N, y + (s / N + 0.5) / N), towards)) < limit;
    }
    return (double)n / (N * N);
}

void map_add_disc(bis_image *image, vec3 towards, double radius, rgb L)
{
    double theta = atan2(hypot((double)towards.x, (double)towards.y), (double)towards.z),
           phi = atan2((double)towards.y, (double)towards.x);
    double half_phi =
        asin(fmin(1, sin(radius) / fmax(sin(theta), sin(radius)))); /* the widest meridians that touch it */
    int y0 = (int)floor(fmax(0, theta - radius) / PI * image->height),
        y1 = (int)floor((theta + radius) / PI * image->height);
    int x0 = (int)floor((phi - half_phi) / (2 * PI) * image->width) - 1,
        x1 = (int)floor((phi + half_phi) / (2 * PI) * image->width) + 1;

    for (int y = y0; y <= y1 && y < image->height; y++) {
        for (int x = x0; x <= x1; x++) {
            int column = (x + image->width) % image->width;
            rgb *pixel = &image->pixels[(size_t)y * (size_t)image->width + (size_t)column];
            *pixel = rgb_add(*pixel, rgb_scale(L, disc_share(image, column, y, towards, radius)));
        }
    }
}
