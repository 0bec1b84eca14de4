/* SPDX-License-Identifier: BSD-2-Clause */
/* map_sky: out of doors, under the sun and under clouds.
 *
 * Clear sky: the CIE's clear sky (CIE S 003, 1996): luminance depends on the height above the horizon and on the angle
 * to the sun. Overcast: the CIE's overcast sky, (1 + 2 sin height) / 3, a little cloudy. The colours are ours: blue
 * overhead, white and warm near the horizon and the sun.
 * The sun's disc is 0.53 degrees wide; it gives about five times the irradiance of the rest, as at noon in clear air,
 * from a patch of 6.7e-5 sr.
 * Below the horizon lie a paved place, a meadow, and two ridges of hills that the air makes pale. */
#include "map.h"

#include <math.h>

typedef struct weather {
    vec3 sun; /* unit */
    bool overcast;
} weather;

static const double SUN_RADIUS = 0.265 * PI / 180;
static const rgb SUN_L = {62000, 55000, 46000}, SUN_E = {4.3f, 3.8f, 3.2f}; /* SUN_E = SUN_L * pi sin^2(SUN_RADIUS) */

static rgb clear_sky(vec3 w, vec3 sun)
{
    double height = fmax(0.012, (double)w.z), gamma = acos(fmin(1, dot(w, sun))), sun_zenith = acos((double)sun.z);
    double near_sun = 0.91 + 10 * exp(-3 * gamma) + 0.45 * pow(cos(gamma), 2),
           overhead = 0.91 + 10 * exp(-3 * sun_zenith) + 0.45 * pow((double)sun.z, 2);
    double L = near_sun * (1 - exp(-0.32 / height)) / (overhead * (1 - exp(-0.32)));
    double pale = exp(-4.5 * height), warm = exp(-2.2 * gamma);
    rgb colour = map_mix((rgb){0.16f, 0.34f, 0.95f}, (rgb){0.72f, 0.82f, 0.95f}, pale);

    colour = map_mix(colour, (rgb){1.0f, 0.94f, 0.82f}, 0.75 * warm);
    double aureole = 9 * exp(-28 * gamma) + 60 * exp(-120 * gamma);
    return rgb_add(rgb_scale(colour, 0.30 * L), rgb_scale((rgb){1, 0.93f, 0.8f}, aureole));
}

/* Flat-bottomed clouds on a plane overhead, brighter towards the sun. */
static rgb with_clouds(rgb sky, vec3 w, vec3 sun)
{
    double height = fmax(0.02, (double)w.z), x = (double)w.x / (height + 0.08), y = (double)w.y / (height + 0.08);
    double d = map_clouds(0.9 * x + 3, 0.9 * y, 0.5, 5),
           cover = map_smooth(0.56, 0.74, d) * map_smooth(0.03, 0.12, (double)w.z);
    double silver = pow(fmax(0, dot(w, sun)), 12), thick = map_smooth(0.60, 0.85, d);
    rgb cloud = rgb_scale(map_mix((rgb){1.05f, 1.05f, 1.05f}, (rgb){0.55f, 0.58f, 0.64f}, thick), 0.9 + 2.5 * silver);

    return map_mix(sky, cloud, 0.92 * cover);
}

static rgb overcast_sky(vec3 w)
{
    double height = fmax(0, (double)w.z), x = (double)w.x / (height + 0.25), y = (double)w.y / (height + 0.25);
    double billows = 0.80 + 0.40 * map_clouds(1.3 * x, 1.3 * y, 0.5, 4);

    return rgb_scale((rgb){0.90f, 0.95f, 1.03f}, 1.1 * (1 + 2 * height) / 3 * billows);
}

/* No ridge is higher than this. */
static const double RIDGES_TOP = 0.105;

/* Height of a ridge's line above the horizon, as the tangent of its angle. The azimuth goes in as a circle, so that it
 * has no seam. */
static double ridge(vec3 w, double seed, double high)
{
    double l = hypot((double)w.x, (double)w.y), x = (double)w.x / l, y = (double)w.y / l;
    return high * (0.25 + 1.1 * map_clouds(3 * x + seed, 3 * y, seed, 5));
}

static rgb paved(double x, double y)
{
    double gx = fabs(x - 1.2 * round(x / 1.2)), gy = fabs(y - 1.2 * round(y / 1.2));
    double tone = map_hash((int64_t)floor(x / 1.2 + 0.5), (int64_t)floor(y / 1.2 + 0.5), 7);

    return rgb_scale((rgb){0.36f, 0.32f, 0.27f}, gx < 0.02 || gy < 0.02 ? 0.45 : 0.85 + 0.3 * tone);
}

static rgb ground_albedo(double x, double y, double distance)
{
    if (distance < 8.5) return paved(x, y);
    rgb meadow = rgb_scale((rgb){0.085f, 0.125f, 0.035f}, 0.7 + 0.6 * map_clouds(0.5 * x, 0.5 * y, 3, 4));
    return map_mix(paved(x, y), meadow, map_smooth(9, 9.6, distance + 0.5 * map_noise(x, y, 5)));
}

static rgb land(vec3 w, const weather *now, rgb haze)
{
    const double eye = 1.6;
    rgb sky_e = now->overcast ? (rgb){2.2f, 2.3f, 2.5f} : (rgb){1.1f, 1.2f, 1.5f};
    rgb sun_e = now->overcast ? (rgb){0, 0, 0} : rgb_scale(SUN_E, (double)now->sun.z);
    rgb lit = rgb_scale(rgb_add(sky_e, sun_e), INV_PI), albedo;
    double distance, l = hypot((double)w.x, (double)w.y);

    if (w.z < 0) {
        distance = eye * l / -(double)w.z;
        albedo = ground_albedo(eye * (double)w.x / -(double)w.z, eye * (double)w.y / -(double)w.z, distance);
    } else { /* woods on the ridges */
        bool front = (double)w.z / l < ridge(w, 11, 0.035);
        distance = front ? 900 : 3500;
        albedo = rgb_scale((rgb){0.045f, 0.065f, 0.028f},
            0.6 + 0.8 * map_clouds(60 * (double)w.x, 60 * (double)w.y, 90 * (double)w.z, 3));
    }
    return map_mix(rgb_mul(albedo, lit), rgb_scale(haze, 0.8), 1 - exp(-distance / 4500));
}

static rgb outdoors(const void *data, vec3 w)
{
    const weather *now = data;
    vec3 level = normalize(vec3_from((double)w.x, (double)w.y, 0.03));
    double slope = (double)w.z / hypot((double)w.x, (double)w.y);

    if (slope < 0 || (slope < RIDGES_TOP && slope < fmax(ridge(w, 11, 0.035), ridge(w, 40, 0.075)))) {
        return land(w, now, now->overcast ? overcast_sky(level) : clear_sky(level, now->sun));
    }
    return now->overcast ? overcast_sky(w) : with_clouds(clear_sky(w, now->sun), w, now->sun);
}

bis_status map_outdoor(bis_image *image, bis_diag *diag)
{
    const weather clear = {normalize((vec3){-0.50f, -0.62f, 0.60f}), false};
    bis_status status = map_paint(image, 1024, 2, outdoors, &clear, diag);

    if (!status) map_add_disc(image, clear.sun, SUN_RADIUS, SUN_L);
    return status;
}

bis_status map_overcast(bis_image *image, bis_diag *diag)
{
    const weather cloudy = {(vec3){0, 0, 1}, true};
    return map_paint(image, 512, 2, outdoors, &cloudy, diag);
}
