/* SPDX-License-Identifier: BSD-2-Clause */
/* map_studio: a photographer's studio, for glossy things: each light gives a highlight of its own shape.
 *
 * A dark room with a pale sweep; in it rectangular lights, each a quadrilateral somewhere about the eye, brightest in
 * its middle as a softbox is, with a black frame. One ray for each direction; the nearest light that it meets
 * counts. */
#include "map.h"

#include <math.h>

/* A rectangle: its middle in metres, half sides, turned to face the eye's neighbourhood at `aim`. */
typedef struct panel {
    vec3 middle, aim;
    double half_width, half_height;
    rgb L;
    double core; /* how much brighter the middle is: 0 even, 8 a bare bulb behind cloth */
    bool round;
} panel;

static const panel PANELS[] = {
    {{-3.2f, -2.2f, 2.6f}, {0, 0, 0}, 1.0, 0.75, {14, 13.4f, 12.6f}, 9, false},      /* key */
    {{3.6f, -0.6f, 1.2f}, {0, 0, 0}, 0.16, 1.5, {16, 17, 19}, 3, false},             /* strip, right */
    {{3.0f, 1.9f, 1.2f}, {0, 0, 0}, 0.13, 1.4, {10, 11, 13}, 3, false},              /* strip, back right */
    {{-2.6f, 3.2f, 1.6f}, {0, 0, 0}, 0.14, 1.3, {24, 19, 14}, 3, false},             /* strip, back left, warm */
    {{0.6f, 0.6f, 3.4f}, {0, 0, 0}, 1.1, 0.5, {4.5f, 4.5f, 4.5f}, 1, false},         /* overhead */
    {{2.2f, -3.4f, 0.6f}, {0, 0, 0}, 0.9, 0.9, {1.4f, 1.4f, 1.45f}, 5, true},        /* umbrella, fill */
    {{-3.4f, 0.9f, 0.1f}, {0, 0, 0}, 0.5, 0.9, {0.8f, 0.78f, 0.72f}, 0, false},      /* reflector */
};

static bool hit_panel(const panel *p, vec3 w, double *nearest, rgb *L)
{
    vec3 n = normalize(sub(p->aim, p->middle)), x = normalize(cross((vec3){0, 0, 1}, n)), y = cross(n, x);
    double t = dot(p->middle, n) / dot(w, n);

    if (!(t > 0 && t < *nearest)) return false;
    vec3 q = sub(mul(w, t), p->middle);
    double u = dot(q, x) / p->half_width, v = dot(q, y) / p->half_height, r = hypot(u, v);
    const double rim = 0.03;
    if (p->round ? r > 1 + rim : fmax(fabs(u) - rim / p->half_width, fabs(v) - rim / p->half_height) > 1) return false;
    *nearest = t;
    *L = (rgb){0.004f, 0.004f, 0.004f};
    if (p->round ? r > 1 : fmax(fabs(u), fabs(v)) > 1) return true;
    double ribs = p->round ? 1 - 0.55 * map_smooth(0.93, 1, fabs(cos(4 * atan2(v, u)))) * r : 1;
    *L = rgb_scale(p->L, ribs * (1 + p->core * exp(-3.5 * r * r)) / (1 + 0.35 * p->core));
    return true;
}

static rgb room(vec3 w)
{
    double sweep = map_smooth(-0.75, 0.55, (double)w.z), back = map_smooth(-0.2, 0.95, (double)w.y);
    rgb wall = map_mix((rgb){0.10f, 0.10f, 0.105f}, (rgb){0.010f, 0.011f, 0.014f}, sweep);
    double pool = exp(-9 * (pow((double)w.x + 0.1, 2) + pow((double)w.z + 0.12, 2))) * back;

    wall = rgb_add(wall, rgb_scale((rgb){0.30f, 0.33f, 0.40f}, pool)); /* a spot on the background */
    return rgb_scale(wall, 0.9 + 0.2 * map_clouds(4 * (double)w.x, 4 * (double)w.y, 4 * (double)w.z, 2));
}

static rgb studio(const void *data, vec3 w)
{
    double nearest = (double)INFINITY;
    rgb L;
    bool lit = false;

    (void)data;
    for (size_t i = 0; i < sizeof PANELS / sizeof PANELS[0]; i++) lit |= hit_panel(&PANELS[i], w, &nearest, &L);
    return lit ? L : room(w);
}

bis_status map_studio(bis_image *image, bis_diag *diag)
{
    bis_status status = map_paint(image, 1024, 2, studio, NULL, diag);

    /* Two bare modelling lamps. */
    if (!status) map_add_disc(image, normalize((vec3){-0.9f, 1.6f, 1.5f}), 0.006, (rgb){4200, 3300, 2300});
    if (!status) map_add_disc(image, normalize((vec3){1.5f, 1.5f, 1.8f}), 0.006, (rgb){3000, 3200, 3600});
    return status;
}
