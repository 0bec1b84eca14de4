/* SPDX-License-Identifier: BSD-2-Clause */
/* mapping: where pixels look, by hand; energy; round trips; shapes. The angular mapping has its own tests in
 * tests/thesis/test_envmap.c. */
#include "bis/beyond/mapping.h"

#include "beyond/mapping_models.h"
#include "bis/base/mem.h"
#include "bis/thesis/lanes.h"
#include "claim.h"
#include "map_help.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#ifdef _OPENMP
#include <omp.h>
#else
#define omp_set_num_threads(n)
#endif

/* In the light's frame the middle of a picture looks along -x, to its right is -y, up is +z. */
static vec3 seen(double front, double right, double up)
{
    const double length = sqrt(front * front + right * right + up * up);
    return vec3_from(-front / length, -right / length, up / length);
}

static bis_image black(int width, int height)
{
    bis_image image;
    assert_int_equal(bis_image_init(&image, width, height, NULL), BIS_OK);
    return image;
}

/* A picture of each mapping, as large as is usual for a lat-long map of 256 x 128. */
static const struct { bis_mapping mapping; int width, height; } shapes[] = {
    {BIS_MAPPING_ANGULAR, 128, 128},         {BIS_MAPPING_EQUALAREA, 128, 128}, {BIS_MAPPING_MIRRORBALL, 128, 128},
    {BIS_MAPPING_VERTICAL_CROSS, 192, 256},  {BIS_MAPPING_HORIZONTAL_CROSS, 256, 192},
    {BIS_MAPPING_CUBE_STRIP, 384, 64},       {BIS_MAPPING_CUBE_STRIP, 64, 384},
};
enum { N_SHAPES = sizeof shapes / sizeof *shapes };

/* The solid angle of the brightest direction's neighbourhood does not matter: where is its centre of light? */
static vec3 centre_of_light(const bis_envmap *em)
{
    double sum[3] = {0, 0, 0};
    for (int y = 0; y < em->height; y++)
        for (int x = 0; x < em->width; x++) {
            const double light = map_intensity(em, (size_t)y * (size_t)em->width + (size_t)x) * em->row_solid_angle[y];
            const vec3 w = bis_envmap_direction(em, x, y, .5, .5);
            sum[0] += light * (double)w.x;
            sum[1] += light * (double)w.y;
            sum[2] += light * (double)w.z;
        }
    return seen(-sum[0], -sum[1], sum[2]);
}

/* One pixel of a picture is lit: its direction, worked out by hand from the picture that the mapping's page shows. */
static void a_lit_pixel_shines_from_its_direction(void **state)
{
    /* x, y: in shares of the picture; a is tan(22.5 degrees), half way from a face's middle to its edge in angle */
    const double a = .5, h = sqrt(.5);
    const struct { bis_mapping mapping; int width, height; double x, y; vec3 w; } rows[] = {
        {BIS_MAPPING_EQUALAREA, 129, 129, .5, .5, {0, 0, 1}},
        {BIS_MAPPING_EQUALAREA, 129, 129, .999, .5, {1, 0, 0}},
        {BIS_MAPPING_EQUALAREA, 129, 129, .5, .999, {0, 1, 0}},
        {BIS_MAPPING_EQUALAREA, 129, 129, .001, .5, {-1, 0, 0}},
        {BIS_MAPPING_EQUALAREA, 129, 129, .5, .001, {0, -1, 0}},
        {BIS_MAPPING_EQUALAREA, 129, 129, .999, .001, {0, 0, -1}},
        {BIS_MAPPING_EQUALAREA, 129, 129, .001, .999, {0, 0, -1}},
        /* r = 1/2 along +u: z = 3/4, sin = sqrt(7)/4; r = 1 on the diagonal: the horizon at 45 degrees */
        {BIS_MAPPING_EQUALAREA, 129, 129, .75, .5, {0.6614378f, 0, 0.75f}},
        {BIS_MAPPING_EQUALAREA, 129, 129, .25, .75, {-0.7071068f, 0.7071068f, 0}},
        /* (.75, .75) of the first quadrant: 1 - .75 - .75 = -1/2, so r = 1/2 below, half way around */
        {BIS_MAPPING_EQUALAREA, 129, 129, .875, .125, {0.4677072f, -0.4677072f, -0.75f}},
        {BIS_MAPPING_MIRRORBALL, 129, 129, .5, .5, seen(1, 0, 0)},
        {BIS_MAPPING_MIRRORBALL, 129, 129, .5 + .5 * h, .5, seen(0, 1, 0)}, /* sin 45 degrees: 90 degrees */
        {BIS_MAPPING_MIRRORBALL, 129, 129, .5, .5 - .5 * h, seen(0, 0, 1)},
        {BIS_MAPPING_MIRRORBALL, 129, 129, .5, .5 + .25, seen(.5, 0, -sqrt(.75))}, /* sin 30 degrees: 60 degrees */
        {BIS_MAPPING_VERTICAL_CROSS, 99, 132, .5, 1.5 / 4, seen(1, 0, 0)},
        {BIS_MAPPING_VERTICAL_CROSS, 99, 132, .5 / 3, 1.5 / 4, seen(0, -1, 0)},
        {BIS_MAPPING_VERTICAL_CROSS, 99, 132, 2.5 / 3, 1.5 / 4, seen(0, 1, 0)},
        {BIS_MAPPING_VERTICAL_CROSS, 99, 132, .5, .5 / 4, seen(0, 0, 1)},
        {BIS_MAPPING_VERTICAL_CROSS, 99, 132, .5, 2.5 / 4, seen(0, 0, -1)},
        {BIS_MAPPING_VERTICAL_CROSS, 99, 132, .5, 3.5 / 4, seen(-1, 0, 0)},
        {BIS_MAPPING_VERTICAL_CROSS, 99, 132, 1.75 / 3, 1.25 / 4, seen(1, a, a)},
        {BIS_MAPPING_VERTICAL_CROSS, 99, 132, 1.75 / 3, 3.25 / 4, seen(-1, a, -a)},
        {BIS_MAPPING_HORIZONTAL_CROSS, 132, 99, 1.5 / 4, .5, seen(1, 0, 0)},
        {BIS_MAPPING_HORIZONTAL_CROSS, 132, 99, 3.5 / 4, .5, seen(-1, 0, 0)},
        {BIS_MAPPING_HORIZONTAL_CROSS, 132, 99, 3.75 / 4, 1.25 / 3, seen(-1, -a, a)},
        {BIS_MAPPING_HORIZONTAL_CROSS, 132, 99, 1.5 / 4, 2.5 / 3, seen(0, 0, -1)},
        {BIS_MAPPING_CUBE_STRIP, 198, 33, .5 / 6, .5, seen(0, 1, 0)},
        {BIS_MAPPING_CUBE_STRIP, 198, 33, 1.5 / 6, .5, seen(0, -1, 0)},
        {BIS_MAPPING_CUBE_STRIP, 198, 33, 2.5 / 6, .5, seen(0, 0, 1)},
        {BIS_MAPPING_CUBE_STRIP, 198, 33, 3.5 / 6, .5, seen(0, 0, -1)},
        {BIS_MAPPING_CUBE_STRIP, 198, 33, 4.5 / 6, .5, seen(1, 0, 0)},
        {BIS_MAPPING_CUBE_STRIP, 198, 33, 5.5 / 6, .5, seen(-1, 0, 0)},
        /* OpenGL's table: s to the right and t down are (-z, -y) on +x, (+x, +z) on +y, (-x, -y) on -z */
        {BIS_MAPPING_CUBE_STRIP, 198, 33, .75 / 6, .25, seen(-a, 1, a)},
        {BIS_MAPPING_CUBE_STRIP, 33, 198, .75, 2.25 / 6, seen(-a, a, 1)},
        {BIS_MAPPING_CUBE_STRIP, 33, 198, .75, 5.25 / 6, seen(-1, -a, a)},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        bis_image image = black(rows[i].width, rows[i].height);
        bis_envmap em;
        const int x = (int)(rows[i].x * rows[i].width), y = (int)(rows[i].y * rows[i].height);
        image.pixels[y * rows[i].width + x] = (rgb){1, 1, 1};
        assert_int_equal(bis_envmap_from_mapping(&em, &image, rows[i].mapping, 0, NULL), BIS_OK);
        /* the middle of the pixel is at most half of a pixel from (x, y): 4 of 129 pixels of a ball near its rim */
        const double off = acos(fmin(1, (double)dot(centre_of_light(&em), rows[i].w)));
        if (off > .04) print_message("row %zu: %g\n", i, off);
        assert_true(off < .04);
        bis_envmap_clear(&em);
        bis_image_clear(&image);
    }
}

/* ---- each mapping's formula ---- */

/* Where a face of a cube looks, what is to its right, and what above: Front, Back, Right, Left, Up, Down. By cells of
 * the picture, row by row; "" is empty. */
static const char *const cells_of[][12] = {
    [BIS_MAPPING_VERTICAL_CROSS] = {"", "URB", "", "LFU", "FRU", "RBU", "", "DRF", "", "", "BRD", ""},
    [BIS_MAPPING_HORIZONTAL_CROSS] = {"", "URB", "", "", "LFU", "FRU", "RBU", "BLU", "", "DRF", "", ""},
    [BIS_MAPPING_CUBE_STRIP] = {"RBU", "LFU", "URB", "DRF", "FRU", "BLU"},
};

/* Adds to w as much of one of the six directions, in the light's frame. */
static void go(double w[3], char where, double much)
{
    const char *const ways = "BFLRUD", *const way = strchr(ways, where);
    w[(way - ways) / 2] += (way - ways) % 2 ? -much : much;
}

/* The direction at an angle from the front, towards the azimuth a from the right, counter-clockwise. */
static void turned(double w[3], double angle, double a)
{
    go(w, 'F', cos(angle));
    go(w, 'R', sin(angle) * cos(a));
    go(w, 'U', sin(angle) * sin(a));
}

/* What a place of a picture shows, in double: (x, y) pixels from its upper left corner. false: nothing. */
static bool shown_at(const bis_raster *r, double x, double y, double w[3])
{
    const double u = 2 * x / r->width - 1, v = 1 - 2 * y / r->height, from_middle = hypot(u, v), a = atan2(v, u);
    const int columns[] = {1, 1, 1, 1, 3, 4, r->height > r->width ? 1 : 6}, side = r->width / columns[r->mapping];
    w[0] = w[1] = w[2] = 0;
    if (r->mapping == BIS_MAPPING_LATLONG) {
        const double theta = PI * y / r->height, phi = 2 * PI * x / r->width;
        w[0] = sin(theta) * cos(phi), w[1] = sin(theta) * sin(phi), w[2] = cos(theta);
    } else if (r->mapping == BIS_MAPPING_ANGULAR) {
        turned(w, PI * from_middle, a);
    } else if (r->mapping == BIS_MAPPING_MIRRORBALL) {
        turned(w, 2 * asin(fmin(from_middle, 1)), a);
    } else if (r->mapping == BIS_MAPPING_EQUALAREA) {
        /* the lower hemisphere is folded back first: one quarter of one hemisphere is left */
        const bool below = fabs(u) + fabs(v) > 1;
        const double p = below ? 1 - fabs(v) : fabs(u), q = below ? 1 - fabs(u) : fabs(v), t = p + q;
        const double phi = t > 0 ? PI / 2 * q / t : 0, z = 1 - t * t;
        w[0] = copysign(sqrt(1 - z * z) * cos(phi), u);
        w[1] = copysign(sqrt(1 - z * z) * sin(phi), -v);
        w[2] = below ? -z : z;
    } else {
        const int column = (int)x / side, row = (int)y / side;
        const char *const face = cells_of[r->mapping][row * columns[r->mapping] + column];
        const double across = 2 * (x / side - column) - 1, up = 1 - 2 * (y / side - row);
        const double length = sqrt(1 + across * across + up * up);
        if (!*face) return false;
        go(w, face[0], 1 / length);
        go(w, face[1], across / length);
        go(w, face[2], up / length);
    }
    return from_middle <= 1 || (r->mapping != BIS_MAPPING_ANGULAR && r->mapping != BIS_MAPPING_MIRRORBALL);
}

/* The solid angle by area there, in sr for a pixel: the area of a small parallelogram on the sphere. */
static double spread_at(const bis_raster *r, double x, double y)
{
    const double h = 1e-5;
    double a[3], b[3], c[3], d[3];
    shown_at(r, x + h, y, a);
    shown_at(r, x - h, y, b);
    shown_at(r, x, y + h, c);
    shown_at(r, x, y - h, d);
    for (int i = 0; i < 3; i++) a[i] = (a[i] - b[i]) / (2 * h), c[i] = (c[i] - d[i]) / (2 * h);
    return sqrt(pow(a[1] * c[2] - a[2] * c[1], 2) + pow(a[2] * c[0] - a[0] * c[2], 2) +
                pow(a[0] * c[1] - a[1] * c[0], 2));
}

/* Odd and even sides: with a pixel in the middle and without. */
static const bis_raster small_pictures[] = {
    {.mapping = BIS_MAPPING_LATLONG, .width = 12, .height = 6},
    {.mapping = BIS_MAPPING_LATLONG, .width = 9, .height = 5},
    {.mapping = BIS_MAPPING_ANGULAR, .width = 9, .height = 9},
    {.mapping = BIS_MAPPING_ANGULAR, .width = 14, .height = 14},
    {.mapping = BIS_MAPPING_EQUALAREA, .width = 9, .height = 9},
    {.mapping = BIS_MAPPING_EQUALAREA, .width = 14, .height = 14},
    {.mapping = BIS_MAPPING_MIRRORBALL, .width = 9, .height = 9},
    {.mapping = BIS_MAPPING_MIRRORBALL, .width = 14, .height = 14},
    {.mapping = BIS_MAPPING_VERTICAL_CROSS, .width = 9, .height = 12},
    {.mapping = BIS_MAPPING_VERTICAL_CROSS, .width = 12, .height = 16},
    {.mapping = BIS_MAPPING_HORIZONTAL_CROSS, .width = 20, .height = 15},
    {.mapping = BIS_MAPPING_HORIZONTAL_CROSS, .width = 8, .height = 6},
    {.mapping = BIS_MAPPING_CUBE_STRIP, .width = 18, .height = 3},
    {.mapping = BIS_MAPPING_CUBE_STRIP, .width = 4, .height = 24},
};
enum { N_SMALL = sizeof small_pictures / sizeof *small_pictures, BLOCK = BIS_LANES_BLOCK };

/* The centre of a pixel and 15 other places in it. */
static void spread_places(float dx[BLOCK], float dy[BLOCK])
{
    for (int i = 0; i < BLOCK; i++) {
        dx[i] = i ? (float)(0.96 * (fmod(0.61803 * i, 1) - 0.5)) : 0;
        dy[i] = i ? (float)(0.96 * (fmod(0.75488 * i, 1) - 0.5)) : 0;
    }
}

/* Directions and weights: each place shows what the mapping's words say, and counts by its solid angle. */
static void a_place_shows_what_the_words_say(void **state)
{
    float dx[BLOCK], dy[BLOCK];
    const bis_places places = {dx, dy, BLOCK};
    spread_places(dx, dy);
    for (int k = 0; k < N_SMALL; k++) {
        const bis_raster *const r = &small_pictures[k];
        const bis_mapping_model *const m = &bis_mapping_models[r->mapping];
        bis_samples s;
        const int x0 = r->width / 2, y0 = r->height / 2; /* by which the weights' unit is known */
        m->directions(&s, r, x0, y0, &places);
        const double unit = (double)s.weight[1] / spread_at(r, x0 + .5 + (double)dx[1], y0 + .5 + (double)dy[1]);
        const double most = unit * 4 * PI * PI / r->width / r->height; /* about: of an angular map's middle */
        for (int i = 0; i < r->width * r->height; i++) {
            const int x = i % r->width, y = i / r->width;
            m->directions(&s, r, x, y, &places);
            for (int j = 0; j < BLOCK; j++) {
                const double px = x + .5 + (double)dx[j], py = y + .5 + (double)dy[j];
                double w[3];
                if (!shown_at(r, px, py, w)) {
                    assert_true(s.weight[j] == 0);
                    continue;
                }
                assert_near((double)s.x[j], w[0], 4e-6);
                assert_near((double)s.y[j], w[1], 4e-6);
                assert_near((double)s.z[j], w[2], 4e-6);
                assert_true(s.weight[j] > 0); /* the centre of a pixel may lie on a fold of the equal-area square */
                if (j > 0) assert_near((double)s.weight[j], unit * spread_at(r, px, py), 1e-5 * most);
            }
        }
    }
}

/* The pixel of a disc that a place belongs to: its own, or, if the centre of that lies outside, the one half a diagonal
 * nearer to the middle. */
static int pixel_of_disc(const bis_raster *r, double x, double y)
{
    const double half = r->width / 2.0, d = hypot(x - half, y - half), nearer = d - half * 1.4143 / r->width;
    if (hypot((int)x + .5 - half, (int)y + .5 - half) <= half) return (int)y * r->width + (int)x;
    return (int)(half + (y - half) * nearer / d) * r->width + (int)(half + (x - half) * nearer / d);
}

/* Pixels of directions, the other way round. Those within are found wherever the direction is among others. */
static void a_direction_is_found_in_its_pixel(void **state)
{
    float dx[BLOCK], dy[BLOCK];
    int elsewhere = 0;
    spread_places(dx, dy);
    for (int k = 0; k < N_SMALL; k++) {
        const bis_raster *const r = &small_pictures[k];
        const bool is_disc = r->mapping == BIS_MAPPING_ANGULAR || r->mapping == BIS_MAPPING_MIRRORBALL;
        for (int i = 0; i < r->width * r->height; i++) {
            const int x = i % r->width, y = i / r->width;
            bis_samples s;
            bool shown[BLOCK];
            for (int j = 0; j < BLOCK; j++) {
                double w[3];
                shown[j] = shown_at(r, x + .5 + (double)dx[j], y + .5 + (double)dy[j], w);
                s.x[j] = (float)w[0], s.y[j] = (float)w[1], s.z[j] = (float)w[2];
                s.pixel[j] = 0xaaaaaaaa;
            }
            bis_mapping_models[r->mapping].pixels(r, &s, BLOCK);
            for (int j = 0; j < BLOCK; j++) {
                if (!shown[j]) continue;
                const int pixel = is_disc ? pixel_of_disc(r, x + .5 + (double)dx[j], y + .5 + (double)dy[j]) : i;
                elsewhere += pixel != i;
                assert_int_equal(s.pixel[j], pixel);
            }
        }
    }
    assert_true(elsewhere > 100);
}

/* Directions on the edges of pixels, faces and hemispheres belong to a pixel next to them. */
static void a_direction_on_an_edge_is_found_next_to_it(void **state)
{
    for (int k = 0; k < N_SMALL; k++) {
        const bis_raster *const r = &small_pictures[k];
        const bool is_disc = r->mapping == BIS_MAPPING_ANGULAR || r->mapping == BIS_MAPPING_MIRRORBALL;
        for (int i = 0; i < 125; i++) {
            double w[3], n[3] = {i % 5 - 2, i / 5 % 5 - 2, i / 25 - 2};
            bis_samples s;
            if (i == 62 || (is_disc && n[0] > 0 && n[1] == 0 && n[2] == 0)) continue; /* 0; all of the rim */
            const double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
            for (int j = 0; j < BLOCK; j++) {
                s.x[j] = (float)(n[0] / length), s.y[j] = (float)(n[1] / length), s.z[j] = (float)(n[2] / length);
                s.pixel[j] = 0xaaaaaaaa;
            }
            bis_mapping_models[r->mapping].pixels(r, &s, BLOCK);
            assert_in_range(s.pixel[BLOCK - 1], 0, r->width * r->height - 1);
            const int x = (int)s.pixel[0] % r->width, y = (int)s.pixel[0] / r->width;
            assert_true(shown_at(r, x + .5, y + .5, w));
            const double off = acos(fmin(1, (w[0] * n[0] + w[1] * n[1] + w[2] * n[2]) / length));
            if (off >= .95) print_message("picture %d, direction %d: %g\n", k, i, off);
            assert_true(off < .95);
        }
    }
}

/* The solid angle of the spherical triangle of three unit vectors (Van Oosterom and Strackee 1983). */
static double triangle(const double a[3], const double b[3], const double c[3])
{
    const double det = a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
                       a[2] * (b[0] * c[1] - b[1] * c[0]);
    const double ab = a[0] * b[0] + a[1] * b[1] + a[2] * b[2], bc = b[0] * c[0] + b[1] * c[1] + b[2] * c[2],
                 ca = c[0] * a[0] + c[1] * a[1] + c[2] * a[2];
    return 2 * atan2(fabs(det), 1 + ab + bc + ca);
}

/* Of cubes a pixel's edges are great circles; of a disc the formula is that of its centre; the others are bands. */
static void solid_angles_are_those_of_the_words(void **state)
{
    for (int k = 0; k < N_SMALL; k++) {
        const bis_raster *const r = &small_pictures[k];
        const double e = 1e-9; /* within the face */
        for (int i = 0; i < r->width * r->height; i++) {
            const int x = i % r->width, y = i / r->width;
            double centre[3], corner[4][3], expected = 0;
            const bool shown = shown_at(r, x + .5, y + .5, centre);
            for (int j = 0; j < 4; j++)
                shown_at(r, x + (j % 3 ? 1 - e : e), y + (j > 1 ? 1 - e : e), corner[j]);
            if (shown && r->mapping == BIS_MAPPING_LATLONG)
                expected = 2 * PI / r->width * (cos(PI * y / r->height) - cos(PI * (y + 1) / r->height));
            else if (shown && r->mapping == BIS_MAPPING_EQUALAREA) expected = 4 * PI / r->width / r->height;
            else if (shown && r->mapping >= BIS_MAPPING_VERTICAL_CROSS)
                expected = triangle(corner[0], corner[1], corner[2]) + triangle(corner[0], corner[2], corner[3]);
            else if (shown) expected = spread_at(r, x + .5, y + .5);
            assert_near(bis_mapping_models[r->mapping].solid_angle(r, x, y), expected, 1e-7);
        }
    }
}

/* Shapes that a mapping takes, and the lat-long map that shows all of them. */
static void a_shape_fits_or_not(void **state)
{
    static const struct { bis_mapping mapping; int width, height, to; } rows[] = { /* to 0: does not fit */
        {BIS_MAPPING_LATLONG, 7, 3, 7}, {BIS_MAPPING_LATLONG, 1, 1, 1}, {BIS_MAPPING_LATLONG, 3, 9, 3},
        {BIS_MAPPING_LATLONG, 0, 1, 0}, {BIS_MAPPING_LATLONG, 1, 0, 0},
        {BIS_MAPPING_ANGULAR, 1, 1, 2}, {BIS_MAPPING_ANGULAR, 9, 9, 18}, {BIS_MAPPING_ANGULAR, 2, 1, 0},
        {BIS_MAPPING_ANGULAR, 0, 0, 0}, {BIS_MAPPING_EQUALAREA, 7, 7, 14}, {BIS_MAPPING_EQUALAREA, 7, 8, 0},
        {BIS_MAPPING_MIRRORBALL, 8, 8, 16}, {BIS_MAPPING_MIRRORBALL, 8, 7, 0},
        {BIS_MAPPING_VERTICAL_CROSS, 3, 4, 4}, {BIS_MAPPING_VERTICAL_CROSS, 9, 12, 12},
        {BIS_MAPPING_VERTICAL_CROSS, 4, 3, 0}, {BIS_MAPPING_VERTICAL_CROSS, 4, 5, 0},
        {BIS_MAPPING_VERTICAL_CROSS, 0, 0, 0}, {BIS_MAPPING_VERTICAL_CROSS, 6, 9, 0},
        {BIS_MAPPING_HORIZONTAL_CROSS, 4, 3, 4}, {BIS_MAPPING_HORIZONTAL_CROSS, 20, 15, 20},
        {BIS_MAPPING_HORIZONTAL_CROSS, 3, 4, 0}, {BIS_MAPPING_HORIZONTAL_CROSS, 8, 7, 0},
        {BIS_MAPPING_CUBE_STRIP, 6, 1, 4}, {BIS_MAPPING_CUBE_STRIP, 1, 6, 4}, {BIS_MAPPING_CUBE_STRIP, 30, 5, 20},
        {BIS_MAPPING_CUBE_STRIP, 5, 30, 20}, {BIS_MAPPING_CUBE_STRIP, 5, 1, 0}, {BIS_MAPPING_CUBE_STRIP, 1, 5, 0},
        {BIS_MAPPING_CUBE_STRIP, 6, 6, 0}, {BIS_MAPPING_CUBE_STRIP, 12, 1, 0}, {BIS_MAPPING_CUBE_STRIP, 1, 12, 0},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        const bool is_latlong = rows[i].mapping == BIS_MAPPING_LATLONG;
        assert_int_equal(bis_mapping_fits(rows[i].mapping, rows[i].width, rows[i].height), rows[i].to > 0);
        if (rows[i].to == 0) continue;
        assert_int_equal(bis_mapping_width(rows[i].mapping, rows[i].width, rows[i].height, 0), rows[i].to);
        assert_int_equal(bis_mapping_width(rows[i].mapping, rows[i].width, rows[i].height, 10),
                         is_latlong ? rows[i].to : 10);
        assert_int_equal(bis_mapping_width(rows[i].mapping, rows[i].width, rows[i].height, 11),
                         is_latlong ? rows[i].to : 12);
    }
    for (int i = 0; i < BIS_N_MAPPINGS; i++) assert_int_equal(bis_mapping_find(bis_mapping_names[i]), i);
    assert_int_equal(bis_mapping_find("cube"), BIS_N_MAPPINGS);
    assert_string_equal(bis_mapping_shape(BIS_MAPPING_LATLONG), "twice as wide as high");
}

/* As many pixels around the sphere as the map has, where they are densest: a disc's whole width is one turn of an
 * angular map; a ball's middle pixel is 4/n wide, an equal-area one 2 sqrt(pi)/n, and four faces make a turn. */
static void a_picture_is_as_large_as_its_map(void **state)
{
    static const struct { bis_mapping mapping; int from, width, height; } rows[] = {
        {BIS_MAPPING_LATLONG, 100, 100, 50}, {BIS_MAPPING_LATLONG, 18, 18, 9}, {BIS_MAPPING_ANGULAR, 100, 100, 100},
        {BIS_MAPPING_MIRRORBALL, 100, 64, 64}, {BIS_MAPPING_EQUALAREA, 100, 57, 57}, /* 63.7, 56.4 */
        {BIS_MAPPING_VERTICAL_CROSS, 100, 75, 100}, {BIS_MAPPING_VERTICAL_CROSS, 102, 78, 104},
        {BIS_MAPPING_HORIZONTAL_CROSS, 100, 100, 75}, {BIS_MAPPING_CUBE_STRIP, 100, 150, 25},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        bis_envmap em = map_new(rows[i].from, rows[i].from / 2);
        bis_image image;
        double power[2];
        assert_int_equal(bis_envmap_to_mapping(&image, &em, rows[i].mapping, 0, power, NULL), BIS_OK);
        assert_int_equal(image.width, rows[i].width);
        assert_int_equal(image.height, rows[i].height);
        bis_image_clear(&image);
        bis_envmap_clear(&em);
    }
}

/* The weight of a pixel in a mean over the sphere, for one who has the picture alone and knows the formula at a pixel's
 * centre. 0: no part of the map. */
static double weight_by_hand(bis_mapping mapping, int width, int height, int x, int y)
{
    const double u = 2 * (x + .5) / width - 1, v = 2 * (y + .5) / height - 1, r = hypot(u, v);
    const int columns[] = {2, 1, 1, 1, 3, 4, height > width ? 1 : 6}, side = width / columns[mapping];
    const int face = y / side * columns[mapping] + x / side;
    const double a = 2 * (x % side + .5) / side - 1, b = 2 * (y % side + .5) / side - 1;
    switch (mapping) {
    case BIS_MAPPING_LATLONG: return sin(PI * (y + .5) / height);
    case BIS_MAPPING_ANGULAR: return r > 1 ? 0 : r > 0 ? sin(PI * r) / r : PI;
    case BIS_MAPPING_MIRRORBALL: return r <= 1;
    case BIS_MAPPING_EQUALAREA: return 1;
    case BIS_MAPPING_VERTICAL_CROSS: if (!(1 << face & 02272)) return 0; break;   /* rows of 010 111 010 010 */
    case BIS_MAPPING_HORIZONTAL_CROSS: if (!(1 << face & 01362)) return 0; break; /* rows of 0100 1111 0100, mirrored */
    default: break;
    }
    return pow(1 + a * a + b * b, -1.5);
}

static double channel_of(rgb c, int channel) { return (double)(channel == 0 ? c.r : channel == 1 ? c.g : c.b); }

static double mean_by_hand(const bis_image *image, bis_mapping mapping, int channel)
{
    double sum = 0, weights = 0;
    for (int y = 0; y < image->height; y++)
        for (int x = 0; x < image->width; x++) {
            const double w = weight_by_hand(mapping, image->width, image->height, x, y);
            const double c = channel_of(image->pixels[(size_t)y * (size_t)image->width + (size_t)x], channel);
            sum += w * c;
            weights += w;
            assert_true(c >= 0 && (w > 0 || c == 0));
        }
    return sum / weights;
}

static double map_mean(const bis_envmap *em, int channel)
{
    const bis_image image = {em->width, em->height, em->pixels, NULL};
    return mean_by_hand(&image, BIS_MAPPING_LATLONG, channel);
}

static void a_constant_stays_constant_there_and_back(void **state)
{
    for (size_t k = 0; k < N_SHAPES; k++) {
        bis_image image = black(shapes[k].width, shapes[k].height), back;
        bis_envmap em;
        double power[2];
        for (int i = 0; i < image.width * image.height; i++) image.pixels[i] = (rgb){.25f, 1, 4};
        assert_int_equal(bis_envmap_from_mapping(&em, &image, shapes[k].mapping, 0, NULL), BIS_OK);
        assert_true(em.width == 256 && em.height == 128);
        assert_string_equal(em.resampled_from, bis_mapping_names[shapes[k].mapping]);
        for (size_t i = 0; i < map_n(&em); i++)
            assert_true(em.pixels[i].r == .25f && em.pixels[i].g == 1 && em.pixels[i].b == 4);
        /* 5.25 from all around */
        assert_true(fabs(em.power_before / (5.25 * 4 * PI) - 1) < 1e-9);
        assert_true(fabs(em.power_after / (5.25 * 4 * PI) - 1) < 1e-9);
        assert_int_equal(bis_envmap_to_mapping(&back, &em, shapes[k].mapping, 0, power, NULL), BIS_OK);
        assert_true(fabs(power[0] / (5.25 * 4 * PI) - 1) < 1e-9 && fabs(power[1] / (5.25 * 4 * PI) - 1) < 1e-9);
        size_t lit = 0;
        for (int i = 0; i < back.width * back.height; i++) {
            const rgb c = back.pixels[i];
            lit += c.g > 0;
            assert_true(c.g == 0 || (c.r == .25f && c.g == 1 && c.b == 4));
        }
        /* all of a square or strip, the disc, half of a cross */
        const double share = (double)lit / back.width / back.height;
        const bool is_cross =
            shapes[k].mapping == BIS_MAPPING_VERTICAL_CROSS || shapes[k].mapping == BIS_MAPPING_HORIZONTAL_CROSS;
        const bool is_disc = shapes[k].mapping == BIS_MAPPING_ANGULAR || shapes[k].mapping == BIS_MAPPING_MIRRORBALL;
        assert_true(fabs(share - (is_cross ? .5 : is_disc ? PI / 4 : 1)) < .01);
        bis_image_clear(&back);
        bis_image_clear(&image);
        bis_envmap_clear(&em);
    }
}

/* 2 + x, 2 + y, 2 + z, which has the integral 24 pi over the sphere. */
static bis_envmap smooth_map(int width)
{
    bis_image image = black(width, width / 2);
    for (int y = 0; y < width / 2; y++)
        for (int x = 0; x < width; x++) {
            const double phi = 2 * PI * (x + .5) / width, theta = PI * (y + .5) / (width / 2);
            image.pixels[y * width + x] =
                rgb_from(2 + sin(theta) * cos(phi), 2 + sin(theta) * sin(phi), 2 + cos(theta));
        }
    bis_envmap em;
    assert_int_equal(bis_envmap_from_latlong(&em, &image, NULL), BIS_OK);
    return em;
}

static void a_smooth_map_comes_back(void **state)
{
    for (size_t k = 0; k < N_SHAPES; k++) {
        bis_envmap em = smooth_map(256), back;
        bis_image image;
        double power[2], worst = 0;
        assert_int_equal(bis_envmap_to_mapping(&image, &em, shapes[k].mapping, 0, power, NULL), BIS_OK);
        assert_true(fabs(power[1] / (24 * PI) - 1) < 1e-3);
        assert_true(fabs(mean_by_hand(&image, shapes[k].mapping, 0) / 2 - 1) < 1e-3); /* of red, 2 + x */
        assert_int_equal(bis_envmap_from_mapping(&back, &image, shapes[k].mapping, 256, NULL), BIS_OK);
        assert_true(fabs(back.power_after / (24 * PI) - 1) < 1e-3);
        for (size_t i = 0; i < map_n(&em); i++) {
            const rgb a = em.pixels[i], b = back.pixels[i];
            worst = fmax(
                worst, fmax(fabs((double)(a.r - b.r)), fmax(fabs((double)(a.g - b.g)), fabs((double)(a.b - b.b)))));
        }
        /* a pixel away: 2 pi / 256 where pixels are as wide as usual, and the last rows of a disc's rim are wider: the
         * outermost ring of the ball's 163 pixels across spans acos(1 - 4/163) */
        assert_true(worst < (shapes[k].mapping == BIS_MAPPING_MIRRORBALL ? .23 : .06));
        bis_envmap_clear(&em);
        bis_envmap_clear(&back);
        bis_image_clear(&image);
    }
}

static bis_envmap grey_map(int width, float grey)
{
    bis_envmap em = map_new(width, width / 2);
    for (size_t i = 0; i < map_n(&em); i++) em.pixels[i] = (rgb){grey, grey, grey};
    return em;
}

/* ---- the mean of k x k places ---- */

/* The solid angle of a pixel, where all together are 4 pi. */
static double share_of_sphere(const bis_raster *r, int i)
{
    const bis_mapping_model *const m = &bis_mapping_models[r->mapping];
    double sum = 0;
    for (int k = 0; k < r->width * r->height; k++) sum += m->solid_angle(r, k % r->width, k / r->width);
    return m->solid_angle(r, i % r->width, i / r->width) / sum * 4 * PI;
}

/* Stores the integrals of the channels. */
static void integrals(double sum[3], const bis_raster *r)
{
    for (int c = 0; c < 3; c++) sum[c] = 0;
    for (int i = 0; i < r->width * r->height; i++) {
        const double area = share_of_sphere(r, i);
        for (int c = 0; c < 3 && area > 0; c++) sum[c] += area * channel_of(r->pixels[i], c);
    }
}

/* What pixel i of `to` is before energies are made equal: the mean over k x k places, each by its solid angle. */
static rgb mean_of_places(const bis_raster *to, const bis_raster *from, int k, int i)
{
    double sum[3] = {0}, weights = 0;
    for (int first = 0; first < k * k; first += BLOCK) {
        float dx[BLOCK] = {0}, dy[BLOCK] = {0};
        const bis_places places = {dx, dy, BLOCK};
        bis_samples s;
        for (int j = 0; j < BLOCK; j++) {
            dx[j] = (float)(((first + j) / k + 0.5) / k - 0.5);
            dy[j] = (float)(((first + j) % k + 0.5) / k - 0.5);
        }
        bis_mapping_models[to->mapping].directions(&s, to, i % to->width, i / to->width, &places);
        bis_mapping_models[from->mapping].pixels(from, &s, BLOCK);
        for (int j = 0; j < BLOCK && first + j < k * k; j++) {
            const double w = (double)s.weight[j];
            for (int c = 0; c < 3 && w > 0; c++) sum[c] += w * channel_of(from->pixels[s.pixel[j]], c);
            weights += w;
        }
    }
    return rgb_from(sum[0] / weights, sum[1] / weights, sum[2] / weights);
}

/* From picture to picture, k by hand: 4 places for a pixel of the source along the densest way around the sphere, of an
 * angular map 8, rounded up, at least 2. How many pixels the map or the cell counts as around the sphere stands in
 * a_picture_is_as_large_as_its_map. */
static const struct { bis_mapping to; int width, height; bis_mapping from; int from_width, from_height, k; }
    resamplings[] = {
        {BIS_MAPPING_ANGULAR, 13, 13, BIS_MAPPING_LATLONG, 18, 9, 6},         /* 72/13 */
        {BIS_MAPPING_MIRRORBALL, 12, 12, BIS_MAPPING_LATLONG, 18, 9, 4},      /* 72/18.8 */
        {BIS_MAPPING_EQUALAREA, 14, 14, BIS_MAPPING_LATLONG, 18, 9, 3},       /* 72/24.8 */
        {BIS_MAPPING_VERTICAL_CROSS, 12, 16, BIS_MAPPING_LATLONG, 18, 9, 5},  /* 72/16 */
        {BIS_MAPPING_HORIZONTAL_CROSS, 12, 9, BIS_MAPPING_LATLONG, 18, 9, 6}, /* 72/12 */
        {BIS_MAPPING_CUBE_STRIP, 24, 4, BIS_MAPPING_LATLONG, 18, 9, 5},       /* 72/16 */
        {BIS_MAPPING_LATLONG, 32, 16, BIS_MAPPING_LATLONG, 8, 4, 2},          /* 32/32 */
        {BIS_MAPPING_LATLONG, 16, 8, BIS_MAPPING_LATLONG, 8, 16, 8}, /* 128/16: rows are as dense as columns */
        {BIS_MAPPING_ANGULAR, 6, 6, BIS_MAPPING_LATLONG, 66, 33, 44},         /* 264/6: each pixel in two portions */
        {BIS_MAPPING_LATLONG, 16, 8, BIS_MAPPING_ANGULAR, 11, 11, 6},         /* 88/16 */
        {BIS_MAPPING_LATLONG, 16, 8, BIS_MAPPING_EQUALAREA, 10, 10, 5},       /* 70.9/16 */
        {BIS_MAPPING_LATLONG, 16, 8, BIS_MAPPING_MIRRORBALL, 10, 10, 4},      /* 62.8/16 */
        {BIS_MAPPING_LATLONG, 16, 8, BIS_MAPPING_VERTICAL_CROSS, 9, 12, 3},   /* 48/16 */
        {BIS_MAPPING_LATLONG, 16, 8, BIS_MAPPING_HORIZONTAL_CROSS, 20, 15, 5}, /* 80/16 */
        {BIS_MAPPING_LATLONG, 16, 8, BIS_MAPPING_CUBE_STRIP, 18, 3, 3},       /* 48/16 */
        {BIS_MAPPING_LATLONG, 16, 8, BIS_MAPPING_CUBE_STRIP, 5, 30, 5},       /* 80/16 */
};

/* Resamples an image to a raster of another mapping and stores the powers before and after. */
static bis_raster resampled(bis_mapping mapping, int width, bis_image *image, bis_mapping from, double power[2])
{
    bis_envmap em;
    bis_raster to = {.mapping = mapping, .scale = 1};
    if (mapping == BIS_MAPPING_LATLONG && from != BIS_MAPPING_LATLONG) {
        assert_int_equal(bis_envmap_from_mapping(&em, image, from, width, NULL), BIS_OK);
        bis_image_clear(image);
        power[0] = em.power_before, power[1] = em.power_after;
        *image = (bis_image){em.width, em.height, em.pixels, NULL};
        em.pixels = NULL;
    } else {
        assert_int_equal(bis_envmap_from_latlong(&em, image, NULL), BIS_OK);
        assert_int_equal(bis_envmap_to_mapping(image, &em, mapping, width, power, NULL), BIS_OK);
    }
    bis_envmap_clear(&em);
    to.width = image->width, to.height = image->height, to.pixels = image->pixels;
    return to;
}

/* No pixel is a lamp: all are between 1.4 and 1.6. Afterwards each channel has the energy that it had. */
static void a_pixel_is_the_mean_of_k_x_k_places(void **state)
{
    for (size_t n = 0; n < sizeof resamplings / sizeof *resamplings; n++) {
        bis_image image = black(resamplings[n].from_width, resamplings[n].from_height);
        bis_image source = black(image.width, image.height);
        const bis_raster from = {resamplings[n].from, image.width, image.height, 1, source.pixels};
        double power[2], before[3], after[3];
        for (int i = 0; i < image.width * image.height; i++)
            source.pixels[i] = rgb_from(1.4 + 0.2 * fmod(0.618 * i, 1), 1.4 + 0.2 * fmod(0.755 * i, 1),
                                        1.6 - 0.2 * fmod(0.570 * i, 1));
        memcpy(image.pixels, source.pixels, (size_t)image.width * (size_t)image.height * sizeof *image.pixels);
        integrals(before, &from);
        const bis_raster to = resampled(resamplings[n].to, resamplings[n].width, &image, from.mapping, power);
        assert_true(to.width == resamplings[n].width && to.height == resamplings[n].height);
        bis_image other = black(to.width, to.height);
        const bis_raster expected = {to.mapping, to.width, to.height, 1, other.pixels};
        for (int i = 0; i < to.width * to.height; i++)
            if (share_of_sphere(&to, i) > 0) other.pixels[i] = mean_of_places(&to, &from, resamplings[n].k, i);
        integrals(after, &expected);
        for (int i = 0; i < 3 * to.width * to.height; i++)
            assert_near(channel_of(to.pixels[i / 3], i % 3),
                        channel_of(other.pixels[i / 3], i % 3) * before[i % 3] / after[i % 3], 2e-6);
        assert_near(power[0] / (before[0] + before[1] + before[2]), 1, 1e-12);
        assert_near(power[1] / power[0], 1, 1e-6);
        bis_image_clear(&other);
        bis_image_clear(&image);
        bis_image_clear(&source);
    }
}

/* The map goes to the mapping and comes back: means by hand of each channel, there and back, are those of the map.
 * Returns the map that came back. */
static bis_envmap there_and_back(const bis_envmap *em, size_t k, int width, double *worst)
{
    bis_image image;
    bis_envmap back;
    double power[2];
    assert_int_equal(bis_envmap_to_mapping(&image, em, shapes[k].mapping, width, power, NULL), BIS_OK);
    assert_near(power[0] / bis_envmap_power(em), 1, 1e-9);
    for (int c = 0; c < 3; c++)
        *worst = fmax(*worst, fabs(mean_by_hand(&image, shapes[k].mapping, c) / map_mean(em, c) - 1));
    assert_int_equal(bis_envmap_from_mapping(&back, &image, shapes[k].mapping, em->width, NULL), BIS_OK);
    for (int c = 0; c < 3; c++) *worst = fmax(*worst, fabs(map_mean(&back, c) / map_mean(em, c) - 1));
    assert_near(power[1] / power[0], 1, 1e-5);
    assert_near(back.power_before / power[1], 1, 1e-5);
    assert_near(back.power_after / power[1], 1, 1e-5);
    assert_near(bis_envmap_power(&back) / back.power_after, 1, 1e-9);
    bis_image_clear(&image);
    return back;
}

/* A sun of one pixel and little else, at poles, on rims, at a cube's corner and anywhere: the hardest case for an
 * average of samples. */
static void a_sun_of_one_pixel_keeps_its_energy(void **state)
{
    /* behind, at the seam, is the rim of discs; (64, 31) is the middle of pictures; a corner of a cube is at 45 degrees
     * and atan(sqrt(1/2)) above the horizon */
    static const int places[][2] = {{0, 0}, {77, 0}, {127, 63}, {30, 1}, {0, 31}, {127, 32}, {127, 31}, {1, 30},
        {64, 31}, {16, 19}, {80, 19}, {47, 44}, {32, 32}};
    enum { PLACES = sizeof places / sizeof *places, RANDOM = 9 };
    double worst = 0;
    uint32_t seed = 7;
    for (size_t k = 0; k < N_SHAPES; k++) {
        for (int i = 0; i < PLACES + RANDOM; i++) {
            seed = seed * 1664525 + 1013904223;
            const int x = i < PLACES ? places[i][0] : (int)(seed >> 8) % 128,
                      y = i < PLACES ? places[i][1] : (int)(seed >> 20) % 64;
            bis_envmap em = grey_map(128, .01f);
            em.pixels[128 * y + x] = (rgb){5000 / (float)sin(PI * (y + .5) / 64), 4000, 3000};
            bis_envmap back = there_and_back(&em, k, 0, &worst);
            /* a pixel away, but the outermost ring of a ball of 81 pixels across spans .22 */
            const double off = acos(fmin(1, (double)dot(centre_of_light(&back), centre_of_light(&em))));
            if (off > 2 * PI / 128) print_message("shape %zu, (%d, %d): %g %g\n", k, x, y, off, worst);
            assert_true(off < (shapes[k].mapping == BIS_MAPPING_MIRRORBALL ? .22 : 2 * PI / 128));
            bis_envmap_clear(&em);
            bis_envmap_clear(&back);
        }
    }
    print_message("a sun's energy changes by at most %.5f%%\n", 100 * worst);
    assert_true(worst < 1e-3);
}

/* A red, a green and a blue sun under a dark sky, to larger and smaller pictures. */
static void each_channel_keeps_its_energy(void **state)
{
    static const int cells[] = {30, 110}; /* the width of a square or face */
    double worst = 0;
    for (size_t k = 0; k < N_SHAPES; k++) {
        for (int i = 0; i < 2; i++) {
            bis_envmap em = grey_map(128, .001f);
            em.pixels[128 * 20 + 100] = (rgb){3000, 0, 0};
            em.pixels[128 * 33 + 17] = (rgb){0, 7, 0}; /* little among all, most of green */
            em.pixels[128 * 60 + 64] = em.pixels[128 * 60 + 65] = (rgb){0, 0, 900};
            const int columns[] = {1, 1, 1, 3, 4, 6, 6};
            bis_envmap back = there_and_back(&em, k, cells[i] * columns[k], &worst);
            bis_envmap_clear(&em);
            bis_envmap_clear(&back);
        }
    }
    print_message("a channel's energy changes by at most %.5f%%\n", 100 * worst);
    assert_true(worst < 1e-3);
}

/* A pixel of 2 pi / 6 x 2 pi / 6 in pictures that are much finer: one radiance all over it, none elsewhere. */
static void a_large_lamp_is_even(void **state)
{
    static const int widths[] = {96, 96, 96, 180, 240, 360, 360};
    for (size_t k = 0; k < N_SHAPES; k++) {
        bis_envmap em = map_new(8, 4);
        em.pixels[8 + 2] = (rgb){7, 0, 0};
        bis_image image;
        double power[2], most = 0, on = 0, all = 0;
        assert_int_equal(bis_envmap_to_mapping(&image, &em, shapes[k].mapping, widths[k], power, NULL), BIS_OK);
        for (int i = 0; i < image.width * image.height; i++) most = fmax(most, (double)image.pixels[i].r);
        assert_near(most, 7, .07);
        for (int y = 0; y < image.height; y++)
            for (int x = 0; x < image.width; x++) {
                const double w = weight_by_hand(shapes[k].mapping, image.width, image.height, x, y);
                all += w;
                if ((double)image.pixels[y * image.width + x].r > .999999 * most) on += w;
            }
        /* (cos 45 - cos 90) / 16 of the sphere; pixels on its outline are in between: some 2 of 16 across */
        assert_true(on / all < .0442 && on / all > .7 * .0442);
        bis_image_clear(&image);
        bis_envmap_clear(&em);
    }
}

/* Source pixel 1 of 6 x 3 covers 2/3 of pixel 2 of 16 x 8 and all of 3 and 4, on both axes. */
static void a_lamp_has_its_shares_on_its_edges(void **state)
{
    bis_envmap em = map_new(6, 3);
    em.pixels[6 + 1] = (rgb){3, 0, 0};
    bis_image image;
    double power[2];
    assert_int_equal(bis_envmap_to_mapping(&image, &em, BIS_MAPPING_LATLONG, 16, power, NULL), BIS_OK);
    for (int y = 0; y < 8; y++)
        for (int x = 0; x < 16; x++) {
            const double across = x == 3 || x == 4 ? 1 : x == 5 ? 1. / 3 : x == 2 ? 1. / 3 : 0;
            /* rows 2 to 5: 60 to 120 degrees of 22.5 each */
            const double down = y == 3 || y == 4   ? 1
                                : y == 2 || y == 5 ? (cos(PI / 3) - cos(PI * 3 / 8)) / (cos(PI / 4) - cos(PI * 3 / 8))
                                                   : 0;
            assert_near((double)image.pixels[16 * y + x].r, 3 * across * down, .1);
        }
    bis_image_clear(&image);
    bis_envmap_clear(&em);
}

/* A sliver at the pole, between all samples of a coarse picture, goes to the pixel that shows it, with all its energy:
 * of equal pixels four surround the north pole, columns to +x and rows to +y. */
static void a_lamp_between_all_samples_goes_where_it_is_seen(void **state)
{
    enum { N = 256 };
    for (int x = 0; x < 1024; x += 301) {
        bis_envmap em = map_new(1024, 512);
        bis_image image;
        double power[2];
        em.pixels[x] = (rgb){64, 32, 16};
        assert_int_equal(bis_envmap_to_mapping(&image, &em, BIS_MAPPING_EQUALAREA, N, power, NULL), BIS_OK);
        const double all = em.row_solid_angle[0] / (4 * PI / N / N);
        const int column = x < 256 || x >= 768 ? N / 2 : N / 2 - 1, row = x < 512 ? N / 2 : N / 2 - 1;
        for (int i = 0; i < N * N; i++) {
            const double share = i == N * row + column ? all : 0;
            assert_near((double)image.pixels[i].r, 64 * share, 1e-4 * all);
            assert_near((double)image.pixels[i].b, 16 * share, 1e-4 * all);
        }
        bis_image_clear(&image);
        bis_envmap_clear(&em);
    }
}

/* A lamp of many pixels, each too dim to be one by itself, whose edges run along the picture's. */
static void a_lamp_of_many_pixels_keeps_its_energy(void **state)
{
    double worst = 0;
    for (size_t k = 0; k < N_SHAPES; k++) {
        bis_envmap em = grey_map(256, .1f);
        for (int y = 20; y < 60; y++)
            for (int x = 110; x < 150; x++) em.pixels[256 * y + x] = (rgb){20, 20, 20};
        bis_envmap back = there_and_back(&em, k, 0, &worst);
        bis_envmap_clear(&em);
        bis_envmap_clear(&back);
    }
    print_message("a wide lamp's energy changes by at most %.5f%%\n", 100 * worst);
    assert_true(worst < 1e-3);
}

static void threads_do_not_change_a_bit(void **state)
{
    bis_envmap em = map_random(64, 32, 6, .1, 5);
    for (size_t k = 0; k < N_SHAPES; k++) {
        bis_image first, image;
        double power[2];
        omp_set_num_threads(1);
        assert_int_equal(bis_envmap_to_mapping(&first, &em, shapes[k].mapping, 0, power, NULL), BIS_OK);
        omp_set_num_threads(5);
        assert_int_equal(bis_envmap_to_mapping(&image, &em, shapes[k].mapping, 0, power, NULL), BIS_OK);
        assert_memory_equal(
            first.pixels, image.pixels, (size_t)image.width * (size_t)image.height * sizeof *image.pixels);
        bis_image_clear(&first);
        bis_image_clear(&image);
    }
    omp_set_num_threads(2);
    bis_envmap_clear(&em);
}

/* A lamp of the greatest radiance: where its pixels receive too little of it, they would have to be brighter. */
static void a_radiance_that_no_float_holds_is_an_error(void **state)
{
    int n_errors = 0;
    for (int x = 0; x < 20; x++) {
        bis_diag diag = {0};
        bis_envmap em = map_new(64, 32), other;
        bis_image image;
        double power[2];
        em.pixels[64 * 13 + 3 * x] = (rgb){FLT_MAX, 0, 0};
        const bis_status status = bis_envmap_to_mapping(&image, &em, BIS_MAPPING_EQUALAREA, 60 + 2 * x, power, &diag);
        if (status == BIS_OK) {
            assert_near(power[1] / power[0], 1, 1e-3);
            assert_int_equal(bis_envmap_from_mapping(&other, &image, BIS_MAPPING_EQUALAREA, 30, NULL), BIS_OK);
            bis_envmap_clear(&other);
        } else {
            assert_true(diag.n_errors == 1 && status == BIS_INPUT);
            assert_non_null(
                strstr(diag.messages[0].text, "a map of mapping \"equalarea\" would get a radiance of more than "
                                              "3.40282e+38, which no float holds; divide the map by 1000"));
            assert_null(image.pixels);
            n_errors++;
        }
        bis_diag_clear(&diag);
        bis_image_clear(&image);
        bis_envmap_clear(&em);
    }
    assert_true(n_errors > 0 && n_errors < 20);
    assert_int_equal(bis_mem_live(), 0);
}

static void bad_values_count_inside_the_map_alone(void **state)
{
    for (size_t k = 0; k < N_SHAPES; k++) {
        bis_image image = black(shapes[k].width, shapes[k].height);
        bis_envmap em;
        /* the first pixel is outside of discs and crosses; pixel (97, 70) is inside of all but the strips */
        const bool has_corner =
            shapes[k].mapping == BIS_MAPPING_EQUALAREA || shapes[k].mapping == BIS_MAPPING_CUBE_STRIP;
        image.pixels[0].r = NAN;
        if (image.height > 70 && image.width > 97) image.pixels[70 * image.width + 97].b = -1;
        assert_int_equal(bis_envmap_from_mapping(&em, &image, shapes[k].mapping, 16, NULL), BIS_OK);
        assert_int_equal(em.defects.n_nan, has_corner);
        assert_int_equal(em.defects.n_negative, image.height > 70 && image.width > 97);
        for (size_t i = 0; i < map_n(&em); i++) assert_true(map_intensity(&em, i) == 0);
        bis_envmap_clear(&em);
        bis_image_clear(&image);
    }
}

static void a_shape_that_does_not_fit_is_an_error(void **state)
{
    const struct { bis_mapping mapping; int width, height; const char *message; } rows[] = {
        {BIS_MAPPING_EQUALAREA, 8, 4, "error: a map of mapping \"equalarea\" must be square, this one is 8 x 4; is it "
         "a "
                                      "\"latlong\" map?"},
        {BIS_MAPPING_MIRRORBALL, 4, 8, "must be square, this one is 4 x 8"},
        {BIS_MAPPING_VERTICAL_CROSS, 8, 6, "must be of 3 x 4 square faces, this one is 8 x 6"},
        {BIS_MAPPING_VERTICAL_CROSS, 4, 5, "must be of 3 x 4 square faces"},
        {BIS_MAPPING_HORIZONTAL_CROSS, 6, 8, "must be of 4 x 3 square faces"},
        {BIS_MAPPING_CUBE_STRIP, 5, 1, "must be a row or column of 6 square faces"},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        bis_image image = black(rows[i].width, rows[i].height);
        bis_diag diag = {0};
        bis_envmap em;
        assert_int_equal(bis_envmap_from_mapping(&em, &image, rows[i].mapping, 0, &diag), BIS_INPUT);
        assert_true(
            diag.n_errors == 1 && strstr(diag.messages[0].text, rows[i].message) && !em.pixels && !em.resampled_from);
        bis_diag_clear(&diag);
        bis_image_clear(&image);
    }
    bis_envmap em = smooth_map(16);
    bis_image image;
    double power[2];
    bis_diag diag = {0};
    assert_int_equal(bis_envmap_to_mapping(&image, &em, BIS_MAPPING_VERTICAL_CROSS, 16, power, &diag), BIS_INPUT);
    assert_int_equal(bis_envmap_to_mapping(&image, &em, BIS_MAPPING_VERTICAL_CROSS, 32766, power, &diag), BIS_INPUT);
    assert_non_null(strstr(diag.messages[0].text, "its width, 16, must be a multiple of 3"));
    assert_non_null(strstr(diag.messages[1].text, "would have 32766 x 43688 pixels"));
    bis_diag_clear(&diag);
    assert_null(image.pixels);
    bis_envmap_clear(&em);
    assert_int_equal(bis_mapping_find("cubestrip"), BIS_MAPPING_CUBE_STRIP);
    assert_int_equal(bis_mapping_find("cube"), BIS_N_MAPPINGS);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_lit_pixel_shines_from_its_direction),
        cmocka_unit_test(a_place_shows_what_the_words_say),
        cmocka_unit_test(a_direction_is_found_in_its_pixel),
        cmocka_unit_test(a_direction_on_an_edge_is_found_next_to_it),
        cmocka_unit_test(solid_angles_are_those_of_the_words),
        cmocka_unit_test(a_shape_fits_or_not),
        cmocka_unit_test(a_picture_is_as_large_as_its_map),
        cmocka_unit_test(a_pixel_is_the_mean_of_k_x_k_places),
        cmocka_unit_test(a_constant_stays_constant_there_and_back),
        cmocka_unit_test(a_smooth_map_comes_back),
        cmocka_unit_test(a_sun_of_one_pixel_keeps_its_energy),
        cmocka_unit_test(each_channel_keeps_its_energy),
        cmocka_unit_test(a_large_lamp_is_even),
        cmocka_unit_test(a_lamp_has_its_shares_on_its_edges),
        cmocka_unit_test(a_lamp_between_all_samples_goes_where_it_is_seen),
        cmocka_unit_test(a_lamp_of_many_pixels_keeps_its_energy),
        cmocka_unit_test(threads_do_not_change_a_bit),
        cmocka_unit_test(a_radiance_that_no_float_holds_is_an_error),
        cmocka_unit_test(bad_values_count_inside_the_map_alone),
        cmocka_unit_test(a_shape_that_does_not_fit_is_an_error),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
