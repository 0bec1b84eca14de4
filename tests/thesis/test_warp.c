/* SPDX-License-Identifier: BSD-2-Clause */
/* warp: each shape is hit with its stated density. Histograms over cells whose measure is known in closed form; the
 * numbers come from a fixed-seed rng. Family-wise significance 0.01. */
#include "bis/thesis/rng.h"
#include "bis/thesis/warp.h"
#include "claim.h"
#include "stat.h"

enum { RINGS = 16, SECTORS = 24, CELLS = RINGS * SECTORS, DRAWS = 1 << 20 };

static double alpha(void) { return stat_level(0.01, 2); }

/* A shape draws a point and says how far out it lies, as the share of the whole that lies further in (in [0,1], uniform
 * if the shape is right), and its azimuth. */
typedef void shape_fn(double *share, double azimuth_xy[2], double u1, double u2);

static void count_shape(double observed[CELLS], double expected[CELLS], uint64_t seed, shape_fn *shape)
{
    bis_rng r;
    bis_rng_init(&r, seed, 0, 0, 0);
    for (int i = 0; i < CELLS; i++) {
        observed[i] = 0;
        expected[i] = (double)DRAWS / CELLS;
    }
    for (int k = 0; k < DRAWS; k++) {
        double share, xy[2], u1 = bis_rng_double(&r), u2 = bis_rng_double(&r);
        shape(&share, xy, u1, u2);
        double turn = atan2(xy[1], xy[0]) / (2 * PI) + 0.5;
        int ring = (int)fmin(share * RINGS, RINGS - 1), sector = (int)fmin(turn * SECTORS, SECTORS - 1);
        observed[ring * SECTORS + sector]++;
    }
}

static void sphere(double *share, double xy[2], double u1, double u2)
{
    vec3 w = bis_warp_sphere(u1, u2);
    *share = ((double)w.z + 1) / 2;
    xy[0] = (double)w.x, xy[1] = (double)w.y;
}

static void cosine(double *share, double xy[2], double u1, double u2)
{
    vec3 w = bis_warp_cosine(u1, u2);
    *share = 1 - (double)w.z * (double)w.z;
    xy[0] = (double)w.x, xy[1] = (double)w.y;
}

/* Twin: a uniform hemisphere has no cosine. */
static void uniform_hemisphere(double *share, double xy[2], double u1, double u2)
{
    vec3 w = bis_warp_sphere(u1 / 2, u2);
    *share = 1 - (double)w.z * (double)w.z;
    xy[0] = (double)w.x, xy[1] = (double)w.y;
}

static void assert_shape(const char *name, uint64_t seed, shape_fn *shape, shape_fn *twin)
{
    double observed[CELLS], expected[CELLS];
    count_shape(observed, expected, seed, shape);
    stat_assert_fit(name, seed, observed, expected, CELLS, alpha());
    if (!twin) return;
    count_shape(observed, expected, seed, twin);
    stat_assert_no_fit(name, seed, observed, expected, CELLS, alpha());
}

static void the_sphere_is_hit_uniformly(void **state)
{
    assert_shape("warp_sphere", 1, sphere, NULL);
}

static void the_hemisphere_is_hit_in_proportion_to_the_cosine(void **state)
{
    assert_shape("warp_cosine", 3, cosine, uniform_hemisphere);
}

static void directions_are_unit_at_all_corners(void **state)
{
    const double corners[] = {
        0, 0x1p-53, 0x1p-30, 0.25, 0.5 - 0x1p-54, 0.5, 0.5 + 0x1p-53, 0.75, 1 - 0x1p-30, 1 - 0x1p-53};
    for (int i = 0; i < 10; i++)
        for (int j = 0; j < 10; j++) {
            double u1 = corners[i], u2 = corners[j];
            vec3 s = bis_warp_sphere(u1, u2), c = bis_warp_cosine(u1, u2);
            assert_true(fabs(length(s) - 1) < 2e-7);
            assert_true(fabs(length(c) - 1) < 2e-7);
            assert_true(c.z > 0); /* u1 = 1 is never drawn */
        }
}

/* sqrt(1 - x^2 - y^2) is 0 for the outermost 2^-53 of the disc, and has 3 good digits at z = 1e-7. By another road: z
 * is the root of the area outside the ring. */
static void z_keeps_its_digits_near_the_rim(void **state)
{
    for (double outside = 0x1p-53; outside < 0.1; outside *= 2) {
        double z = (double)bis_warp_cosine(1 - outside, 0.5).z;
        assert_true(fabs(z - sqrt(outside)) <= 1e-7 * z);
    }
}

/* By hand. The sphere: u1 leads from the north pole to the south, u2 round +z from +x to +y. The
 * cosine: sin theta is the root of u1. */
static void numbers_lead_to_the_places_worked_out(void **state)
{
    const double h = sqrt(0.75);
    const struct { vec3 w; double x, y, z; } places[] = {
        {bis_warp_sphere(0, 0.3), 0, 0, 1}, {bis_warp_sphere(0.25, 0), h, 0, 0.5},
        {bis_warp_sphere(0.25, 0.25), 0, h, 0.5},
        {bis_warp_sphere(0.75, 0.5), -h, 0, -0.5}, {bis_warp_sphere(0.5, 0.75), 0, -1, 0},
        {bis_warp_cosine(0, 0.3), 0, 0, 1}, {bis_warp_cosine(0.36, 0), 0.6, 0, 0.8},
        {bis_warp_cosine(0.64, 0.25), 0, 0.8, 0.6}, {bis_warp_cosine(0.25, 0.5), -0.5, 0, h}};
    for (size_t i = 0; i < sizeof places / sizeof *places; i++) {
        const vec3 w = places[i].w;
        const double off =
            fabs((double)w.x - places[i].x) + fabs((double)w.y - places[i].y) + fabs((double)w.z - places[i].z);
        if (!(off < 3e-7)) fail_msg("place %zu: %g %g %g", i, (double)w.x, (double)w.y, (double)w.z);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_sphere_is_hit_uniformly),
        cmocka_unit_test(the_hemisphere_is_hit_in_proportion_to_the_cosine),
        cmocka_unit_test(directions_are_unit_at_all_corners),
        cmocka_unit_test(numbers_lead_to_the_places_worked_out),
        cmocka_unit_test(z_keeps_its_digits_near_the_rim),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
