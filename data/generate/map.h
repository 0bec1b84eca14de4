/* SPDX-License-Identifier: BSD-2-Clause */
/* map: the environment maps of data/maps, drawn by formulas. Lat-long, z up, row 0 towards +z, linear radiance (a lit
 * white wall is about 0.1 to 1). For data/generate/make_data.c alone. */
#ifndef MAP_H
#define MAP_H

#include "bis/base/image.h"
#include "bis/base/status.h"

#include <stdint.h>

/* --- map_paint.c: what all maps share --- */

/* Radiance from direction w; data is the caller's. */
typedef rgb (*map_radiance)(const void *data, vec3 w);

/* A width x width/2 map: each pixel the mean of n x n directions in it, evenly spread in angle. */
bis_status map_paint(bis_image *image, int width, int n, map_radiance radiance, const void *data, bis_diag *diag);

/* Add a round source of radiance L whose middle lies towards `towards` (unit) and whose angular radius is `radius`
 * (rad, below 0.2). 16 x 16 directions a pixel, because a lamp is as small as a pixel. */
void map_add_disc(bis_image *image, vec3 towards, double radius, rgb L);

/* Smooth step from 0 at lo to 1 at hi. */
double map_smooth(double lo, double hi, double x);
rgb map_mix(rgb a, rgb b, double t);

/* In [0, 1), a fixed function of three whole numbers; and smooth noise in [0, 1] of a place, `octaves` sizes of it
 * added. */
double map_hash(int64_t i, int64_t j, int64_t k);
double map_noise(double x, double y, double z);
double map_clouds(double x, double y, double z, int octaves);

/* --- the maps --- */

/* A vaulted hall: 58 lamps (and their images in the floor), stained glass, sunlight through it, a polished floor. 1024
 * x 512, contrast above 1e7. */
bis_status map_interior(bis_image *image, bis_diag *diag);

/* Sun (0.53 degrees) in a clear sky with a few clouds, hills, a plaza; an overcast sky over the same; map_sky.c. */
bis_status map_outdoor(bis_image *image, bis_diag *diag);
bis_status map_overcast(bis_image *image, bis_diag *diag);

/* A photographer's studio: key light, strip lights, a large umbrella, a reflector. map_studio.c */
bis_status map_studio(bis_image *image, bis_diag *diag);

/* map_plain.c: maps that are all idea. Two coloured lamps opposite each other and a grey rest; six squares of light of
 * many sizes, each of equal power; one lit pixel; a red and a blue half of equal r+g+b; the same radiance
 * everywhere. */
bis_status map_lamps(bis_image *image, bis_diag *diag);
bis_status map_squares(bis_image *image, bis_diag *diag);
bis_status map_one_pixel(bis_image *image, bis_diag *diag);
bis_status map_halves(bis_image *image, bis_diag *diag);
bis_status map_constant(bis_image *image, bis_diag *diag);

#endif
