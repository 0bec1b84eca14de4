/* mapping: where pixels look, by hand; energy; round trips; shapes. The angular mapping has its own tests in
 * tests/thesis/test_envmap.c. */
#include "bis/beyond/mapping.h"

#include "bis/base/mem.h"
#include "map_help.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

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
    (void)state;
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

static void a_constant_stays_constant_there_and_back(void **state)
{
    (void)state;
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
        /* 5.25 from all around; the midpoint rule on the disc's pixels is exact to a few of its rim's */
        assert_true(fabs(em.power_before / (5.25 * 4 * PI) - 1) < 2e-3);
        assert_true(fabs(em.power_after / (5.25 * 4 * PI) - 1) < 1e-9);
        assert_int_equal(bis_envmap_to_mapping(&back, &em, shapes[k].mapping, 0, power, NULL), BIS_OK);
        assert_true(fabs(power[1] / power[0] - 1) < 2e-3);
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
    (void)state;
    for (size_t k = 0; k < N_SHAPES; k++) {
        bis_envmap em = smooth_map(256), back;
        bis_image image;
        double power[2], worst = 0;
        assert_int_equal(bis_envmap_to_mapping(&image, &em, shapes[k].mapping, 0, power, NULL), BIS_OK);
        /* the pixels of a ball's disc are those whose centre lies in it: their number is that of its area but for some
         * of the 510 on the rim (Gauss's circle), 0.1 % of all */
        assert_true(fabs(power[1] / (24 * PI) - 1) < (shapes[k].mapping == BIS_MAPPING_MIRRORBALL ? 2e-3 : 1e-3));
        assert_int_equal(bis_envmap_from_mapping(&back, &image, shapes[k].mapping, 256, NULL), BIS_OK);
        assert_true(fabs(back.power_after / (24 * PI) - 1) < 1e-3);
        for (size_t i = 0; i < map_n(&em); i++) {
            const rgb a = em.pixels[i], b = back.pixels[i];
            worst = fmax(worst, fmax(fabs((double)(a.r - b.r)), fmax(fabs((double)(a.g - b.g)), fabs((double)(a.b - b.b)))));
        }
        /* a pixel away: 2 pi / 256 where pixels are as wide as usual, and the last rows of a disc's rim are wider: the
         * outermost ring of the ball's 163 pixels across spans acos(1 - 4/163) */
        assert_true(worst < (shapes[k].mapping == BIS_MAPPING_MIRRORBALL ? .23 : .06));
        bis_envmap_clear(&em);
        bis_envmap_clear(&back);
        bis_image_clear(&image);
    }
}

/* A sun of one pixel and little else, anywhere: the hardest case for an average of samples. */
static void a_sun_of_one_pixel_keeps_its_energy(void **state)
{
    (void)state;
    double worst_there = 0, worst_back = 0;
    uint32_t seed = 7;
    for (size_t k = 0; k < N_SHAPES; k++) {
        for (int i = 0; i < 2; i++) {
            bis_image map = black(256, 128), image;
            bis_envmap em, back;
            double power[2];
            seed = seed * 1664525 + 1013904223;
            /* not at the very poles, nor behind a disc's middle, where a pixel of the disc is a crescent */
            const int x = (int)(seed >> 8) % 180 + 38, y = (int)(seed >> 20) % 100 + 14;
            for (int j = 0; j < 256 * 128; j++) map.pixels[j] = (rgb){.01f, .01f, .01f};
            map.pixels[256 * y + x] = (rgb){5000, 5000, 5000};
            assert_int_equal(bis_envmap_from_latlong(&em, &map, NULL), BIS_OK);
            assert_int_equal(bis_envmap_to_mapping(&image, &em, shapes[k].mapping, 0, power, NULL), BIS_OK);
            worst_there = fmax(worst_there, fabs(power[1] / power[0] - 1));
            assert_int_equal(bis_envmap_from_mapping(&back, &image, shapes[k].mapping, 0, NULL), BIS_OK);
            worst_back = fmax(worst_back, fabs(back.power_after / back.power_before - 1));
            assert_true((double)dot(centre_of_light(&back), bis_envmap_direction(&em, x, y, .5, .5)) > .999);
            bis_envmap_clear(&em);
            bis_envmap_clear(&back);
            bis_image_clear(&image);
        }
    }
    print_message("a sun's energy: %.4f%% to a mapping, %.4f%% from it\n", 100 * worst_there, 100 * worst_back);
    /* The worst that 256 x 256 shifted samples can do: an edge so inclined that it meets every other row at the same
     * place of a sample, which loses half a sample in each of 256 rows, 0.2 %, on two edges. A picture's straight edges
     * are along the grid, or turn slowly: from a mapping it is less. */
    assert_true(worst_there < 4e-3 && worst_back < 1e-3);
}

static void bad_values_count_inside_the_map_alone(void **state)
{
    (void)state;
    for (size_t k = 0; k < N_SHAPES; k++) {
        bis_image image = black(shapes[k].width, shapes[k].height);
        bis_envmap em;
        /* the first pixel is outside of discs and crosses; pixel (97, 70) is inside of all but the strips */
        const bool has_corner = shapes[k].mapping == BIS_MAPPING_EQUALAREA || shapes[k].mapping == BIS_MAPPING_CUBE_STRIP;
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
    (void)state;
    const struct { bis_mapping mapping; int width, height; const char *message; } rows[] = {
        {BIS_MAPPING_EQUALAREA, 8, 4, "error: a map of mapping \"equalarea\" must be square, this one is 8 x 4; is it a "
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
        assert_true(diag.n_errors == 1 && strstr(diag.messages[0].text, rows[i].message) && !em.pixels);
        bis_diag_clear(&diag);
        bis_image_clear(&image);
    }
    bis_envmap em = smooth_map(16);
    bis_image image;
    double power[2];
    assert_int_equal(bis_envmap_to_mapping(&image, &em, BIS_MAPPING_VERTICAL_CROSS, 16, power, NULL), BIS_INPUT);
    assert_int_equal(bis_envmap_to_mapping(&image, &em, BIS_MAPPING_VERTICAL_CROSS, 32766, power, NULL), BIS_INPUT);
    assert_null(image.pixels);
    bis_envmap_clear(&em);
    assert_int_equal(bis_mapping_find("cubestrip"), BIS_MAPPING_CUBE_STRIP);
    assert_int_equal(bis_mapping_find("cube"), BIS_N_MAPPINGS);
}

static void every_allocation_may_fail(void **state)
{
    (void)state;
    bis_envmap map = map_new(16, 8); /* black: nothing to be exact about */
    for (size_t k = 0; k < N_SHAPES; k++) {
        bis_status status = BIS_NOMEM;
        for (long i = 1; status; i++) {
            bis_image image = {0};
            bis_envmap em = {0};
            double power[2];
            bis_mem_fail_at(i);
            status = bis_envmap_to_mapping(&image, &map, shapes[k].mapping, 12, power, NULL);
            if (!status) status = bis_envmap_from_mapping(&em, &image, shapes[k].mapping, 0, NULL);
            bis_mem_fail_at(0);
            assert_true((status == BIS_OK || status == BIS_NOMEM) && i < 30);
            assert_true(!status == (em.pixels != NULL));
            bis_envmap_clear(&em);
            bis_image_clear(&image);
        }
    }
    bis_envmap_clear(&map);
    assert_int_equal(bis_mem_live(), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_lit_pixel_shines_from_its_direction),
        cmocka_unit_test(a_constant_stays_constant_there_and_back),
        cmocka_unit_test(a_smooth_map_comes_back),
        cmocka_unit_test(a_sun_of_one_pixel_keeps_its_energy),
        cmocka_unit_test(bad_values_count_inside_the_map_alone),
        cmocka_unit_test(a_shape_that_does_not_fit_is_an_error),
        cmocka_unit_test(every_allocation_may_fail),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
