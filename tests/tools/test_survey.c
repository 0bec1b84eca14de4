/* SPDX-License-Identifier: BSD-2-Clause */
/* Tests of survey and of `bis envmap`: figures against sorting and closed forms, pictures against what they stand for,
 * exit statuses. */
#include "tools/survey/survey.h"

#include "bis/beyond/mapping.h"
#include "bis/base/file.h"
#include "bis/base/mem.h"
#include "bis/files/image_file.h"
#include "bis/scene/light_load.h"
#include "out/palette.h"
#include "claim.h"
#include "expect.h"
#include "html_check.h"
#include "json_check.h"
#include "lack.h"
#include "map_help.h"
#include "page_help.h"
#include "picture_help.h"
#include "program.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static bis_survey survey_of(const bis_envmap *em, int levels)
{
    bis_survey s;
    bis_regions r;
    assert_int_equal(bis_regions_init(&r, em, levels, NULL), BIS_OK);
    assert_int_equal(bis_survey_init(&s, em, &r, levels, NULL), BIS_OK);
    bis_regions_clear(&r);
    return s;
}

/* ---- figures ---- */

typedef struct patch {
    double intensity, solid_angle;
} patch;

static int by_intensity(const void *a, const void *b)
{
    const double x = ((const patch *)a)->intensity, y = ((const patch *)b)->intensity;
    return (x < y) - (x > y); /* the brightest first */
}

/* Median and brightest share by sorting all pixels. */
static void quantiles_agree_with_sorting(void **state)
{
    bis_envmap em = map_random(128, 64, 9, 0.1, 3);
    const size_t n = map_n(&em);
    patch *p = malloc(n * sizeof *p);
    for (size_t i = 0; i < n; i++) p[i] = (patch){map_intensity(&em, i), map_solid_angle(&em, i)};
    qsort(p, n, sizeof *p, by_intensity);
    double covered = 0, above = 0, median = 0;
    for (size_t i = 0; i < n; i++) {
        const double left = 0.001 * 4 * PI - covered;
        if (left > 0) above += p[i].intensity * fmin(left, p[i].solid_angle);
        if (covered < 2 * PI) median = p[i].intensity;
        covered += p[i].solid_angle;
    }
    const bis_survey s = survey_of(&em, 8);
    assert_near(s.median / median, 1, 1.0 / 2048);
    assert_near(s.brightest / (above / bis_envmap_power(&em)), 1, 1.0 / 2048);
    assert_true(s.most == p[0].intensity && map_intensity(&em, s.peak) == s.most);
    free(p);
    bis_envmap_clear(&em);
}

static void levels_and_regions_account_for_everything(void **state)
{
    bis_envmap em = map_random(40, 20, 6, 0.2, 5);
    const bis_survey s = survey_of(&em, 5);
    double sphere = s.black, power = 0;
    size_t pixels = 0;
    uint32_t regions = 0;
    assert_int_equal(s.n_levels, 5);
    for (int k = 0; k < 5; k++) {
        sphere += s.level[k].sphere;
        power += s.level[k].power;
        pixels += s.level[k].pixels;
        regions += s.level[k].regions;
        assert_near(s.level[k].most / s.level[k].least, pow(s.most / s.least, 0.2), 1e-9);
    }
    assert_near(sphere, 1, 1e-12);
    assert_near(power, 1, 1e-12);
    assert_int_equal(regions, s.n_regions);
    for (size_t i = 0; i < map_n(&em); i++) pixels += map_intensity(&em, i) == 0;
    assert_int_equal(pixels, map_n(&em));
    for (int k = 1; k < s.n_largest; k++) assert_true(s.largest[k].power <= s.largest[k - 1].power);
    bis_envmap_clear(&em);
}

static void a_lamp_is_found_where_it_hangs(void **state)
{
    bis_envmap em = map_new(64, 32);
    for (size_t i = 0; i < map_n(&em); i++) em.pixels[i] = (rgb){0, 1e-3f, 0};
    em.pixels[10 * 64] = em.pixels[10 * 64 + 63] = (rgb){1e4f, 0, 0}; /* on the seam: phi = 0 */
    const bis_survey s = survey_of(&em, 8);
    assert_int_equal(s.n_regions, 2);
    assert_near(s.largest[0].solid_angle, 2 * em.row_solid_angle[10], 1e-15);
    const double theta = PI * 10.5 / 32;
    assert_near((double)s.largest[0].direction.x, sin(theta), 1e-3);
    assert_near((double)s.largest[0].direction.y, 0, 1e-6);
    assert_near((double)s.largest[0].direction.z, cos(theta), 1e-3);
    bis_envmap_clear(&em);
}

static void constant_and_black_maps_have_plain_surveys(void **state)
{
    bis_envmap em = map_new(16, 8);
    bis_survey s = survey_of(&em, 8);
    assert_true(
        s.power == 0 && s.n_regions == 0 && s.n_levels == 0 && s.black > 0.999 && s.median == 0 && s.least == 0);
    for (size_t i = 0; i < map_n(&em); i++) em.pixels[i] = (rgb){1, 2, 4};
    s = survey_of(&em, 8);
    assert_near(s.median, 7, 1e-9);
    assert_near(s.brightest, 0.001, 1e-12);
    assert_near(s.mean_rgb[2], 4, 1e-12);
    assert_int_equal(s.n_regions, 1);
    assert_true(s.largest[0].direction.x == 0 && s.largest[0].direction.z == 0); /* the whole sphere has no centre */
    for (size_t i = 0; i < map_n(&em); i++) em.pixels[i] = (rgb){0, 0x1p-149f, 0}; /* the smallest float */
    assert_true(survey_of(&em, 8).median == 0x1p-149);
    bis_envmap_clear(&em);
}

/* ---- pictures ---- */

static bool same(rgb a, rgb b) { return a.r == b.r && a.g == b.g && a.b == b.b; }
static double grey(rgb c) { return 0.2126 * (double)c.r + 0.7152 * (double)c.g + 0.0722 * (double)c.b; }

static void pictures_show_levels_regions_and_importance(void **state)
{
    bis_envmap em = map_random(48, 24, 6, 0.1, 9);
    bis_regions r;
    assert_int_equal(bis_regions_init(&r, &em, 8, NULL), BIS_OK);
    bis_importance *im;
    const bis_importance_options options = {.table = true, .levels = 8};
    assert_int_equal(bis_importance_new(&im, &em, &options, NULL), BIS_OK);
    bis_image levels, regions, importance;
    assert_int_equal(bis_survey_levels_picture(&levels, &em, 8, NULL), BIS_OK);
    assert_int_equal(bis_survey_regions_picture(&regions, &em, &r, NULL), BIS_OK);
    assert_int_equal(bis_survey_importance_picture(&importance, &em, im, 0, NULL), BIS_OK);
    for (size_t a = 0; a < map_n(&em); a++) {
        for (size_t b = 0; b < a; b++) {
            const bool lit = map_intensity(&em, a) > 0 && map_intensity(&em, b) > 0;
            if (!lit) continue;
            const uint8_t la = r.level[r.label[a]], lb = r.level[r.label[b]];
            assert_true(same(levels.pixels[a], levels.pixels[b]) == (la == lb));
            if (la > lb) assert_true(grey(levels.pixels[a]) > grey(levels.pixels[b]));
            if (r.label[a] == r.label[b]) assert_true(same(regions.pixels[a], regions.pixels[b]));
            if (map_intensity(&em, a) > map_intensity(&em, b))
                assert_true(grey(importance.pixels[a]) >= grey(importance.pixels[b]));
        }
    }
    for (size_t i = 0; i < map_n(&em); i++) {
        const bool black = map_intensity(&em, i) == 0;
        assert_true(rgb_is_black(levels.pixels[i]) == black && rgb_is_black(regions.pixels[i]) == black);
        assert_true(rgb_is_finite(regions.pixels[i]) && rgb_max(regions.pixels[i]) <= 1 && regions.pixels[i].r >= 0);
    }
    bis_image_clear(&levels);
    bis_image_clear(&regions);
    bis_image_clear(&importance);
    bis_importance_free(im);
    bis_regions_clear(&r);
    bis_envmap_clear(&em);
}

/* ---- the command ---- */

#define DIR "build/test_survey"

static int setup(void **state)
{
    program_folder(DIR);
    bis_envmap em = map_random(32, 16, 4, 0.1, 2);
    const bis_image image = {32, 16, em.pixels, NULL}, square = {16, 16, em.pixels, NULL};
    assert_int_equal(bis_image_save(&image, DIR "/map.pfm", NULL), BIS_OK);
    assert_int_equal(bis_image_save(&square, DIR "/probe.pfm", NULL), BIS_OK);
    bis_envmap_clear(&em);
    return 0;
}

static void the_command_reports_and_draws(void **state)
{
    program_run r;
    program_expect(&r, 0, "envmap " DIR "/map.pfm --out " DIR "/p.png --levels 4");
    assert_non_null(strstr(r.output, "32 x 16, latlong"));
    assert_non_null(strstr(r.output, "in 4 levels"));
    assert_string_equal(r.messages, "");
    assert_true(program_exists(DIR "/p-map.png") && program_exists(DIR "/p-levels.png"));
    assert_true(program_exists(DIR "/p-regions.png") && program_exists(DIR "/p-importance.png"));
    program_expect(&r, 0, "envmap " DIR "/map.pfm --json --outdir " DIR);
    assert_true(r.output[0] == '{' && strstr(r.output, "\"largest_regions\""));
    assert_true(program_exists(DIR "/map-levels.png"));
    program_expect(&r, 0, "envmap " DIR "/probe.pfm --mapping angular --width 8");
    assert_non_null(strstr(r.output, "8 x 4, resampled from angular"));
}

/* ---- a map of 4 x 2 pixels by hand ---- */

/* Every pixel is pi/2 sr. r+g+b: 3 0 1 0 above, 3 3 16 3 below; what is 0 was bad: in all 3 negative, 2 infinite
 * values, and a NaN in the pixel below the first bad one. Four levels, 1 to 2 to 4 to 8 to 16. */
static bis_image map_by_hand(rgb pixels[8])
{
    const rgb values[8] = {{1, 1, 1}, {-1, -2, -3}, {1, 0, 0},          {INFINITY, INFINITY, 0},
                           {0, 3, 0}, {NAN, 2, 1},  {8, 6, 2}, {0, 0, 3}};
    memcpy(pixels, values, sizeof values);
    return (bis_image){4, 2, pixels, NULL};
}

static const char report_above[] =
    "map         " DIR "/hand.pfm, 4 x 2, latlong\n"
    "intensity   min 1, median 3, mean 3.625, max 16 (r+g+b; min: of the pixels that are not black)\n"
    "mean        1.25 1.5 0.875 (red, green, blue)\n"
    "power       45.5531 (r+g+b integrated over the sphere)\n"
    "bad values  1 NaN, 2 infinite, 3 negative, set to 0\n"
    "black       25% of the sphere\n"
    "contrast    16 : 1\n"
    "brightest   0.1% of the sphere holds 0.44% of the power\n"
    "peak        pixel (2, 1), theta 120.0, phi 225.0 degrees, direction (-0.612 -0.612 -0.500)\n"
    "regions     3 in 4 levels\n"
    "table       ";

static const char report_below[] =
    "\nlevel       from         to    pixels    sphere     power   regions\n"
    "    0          1          2         1  12.5000%   3.4483%         1\n"
    "    1          2          4         4  50.0000%  41.3793%         1\n"
    "    2          4          8         0   0.0000%   0.0000%         0\n"
    "    3          8         16         1  12.5000%  55.1724%         1\n"
    "\nregions with most power\n"
    "  rank level     power   solid angle  theta    phi   direction\n"
    "     1     3  55.1724%      1.571 sr  120.0  225.0   (-0.612 -0.612 -0.500)\n"
    "     2     1  41.3793%      6.283 sr  120.0   45.0   (0.612 0.612 -0.500)\n"
    "     3     0   3.4483%      1.571 sr   60.0  225.0   (-0.612 -0.612 0.500)\n";

/* Level 1 is one region: it holds together over the seam. Its centre: pixels 0 and 4 cancel but for x and y, so do 5
 * and 7: (2a, 2a, -1), a = sqrt(3/8); its length is 2. */
static void a_map_by_hand_has_the_report_by_hand(void **state)
{
    program_run text, json;
    rgb pixels[8];
    const bis_image image = map_by_hand(pixels);
    assert_int_equal(bis_image_save(&image, DIR "/hand.pfm", NULL), BIS_OK);
    program_expect(&text, 0, "envmap " DIR "/hand.pfm --levels 4");
    program_expect(&json, 0, "envmap " DIR "/hand.pfm --levels 4 --json");
    assert_string_equal(text.messages, json.messages);

    double bytes;
    assert_int_equal(strncmp(text.output, report_above, sizeof report_above - 1), 0);
    assert_int_equal(sscanf(text.output + sizeof report_above - 1, "%lf bytes a pixel beyond the map\n", &bytes), 1);
    assert_near(json_number(json.output, "table_bytes") / 8, bytes, 0.0501);
    assert_true(bytes >= 8); /* an alias table has a share and an index at least */
    assert_string_equal(strstr(text.output, "beyond the map\n") + 15, report_below);

    const double a = sqrt(3 / 8.0), sr = PI / 2;
    const struct { const char *path; double value; } numbers[] = {
        {"width", 4}, {"height", 2}, {"min", 1}, {"median", 3}, {"mean", 3.625}, {"max", 16}, {"contrast", 16},
        {"mean_rgb.0", 1.25}, {"mean_rgb.1", 1.5}, {"mean_rgb.2", 0.875}, {"power", 29 * sr}, {"black_share", 0.25},
        {"brightest_0.1_percent", 0.001 * 8 * 16 / 29}, {"peak.x", 2}, {"peak.y", 1}, {"peak.direction.theta_deg", 120},
        {"peak.direction.phi_deg", 225}, {"peak.direction.x", -a}, {"peak.direction.y", -a}, {"peak.direction.z", -0.5},
        {"bad_values.nan", 1}, {"bad_values.infinite", 2}, {"bad_values.negative", 3},
        {"bad_values.sphere_share", 3 / 8.0},
        {"regions", 3},
        {"levels.0.from", 1}, {"levels.0.to", 2}, {"levels.0.pixels", 1}, {"levels.0.sphere_share", 1 / 8.0},
        {"levels.0.power_share", 1 / 29.0}, {"levels.0.regions", 1},
        {"levels.1.from", 2}, {"levels.1.to", 4}, {"levels.1.pixels", 4}, {"levels.1.sphere_share", 0.5},
        {"levels.1.power_share", 12 / 29.0}, {"levels.1.regions", 1},
        {"levels.2.from", 4}, {"levels.2.to", 8}, {"levels.2.pixels", 0}, {"levels.2.sphere_share", 0},
        {"levels.2.power_share", 0}, {"levels.2.regions", 0},
        {"levels.3.from", 8}, {"levels.3.to", 16}, {"levels.3.pixels", 1}, {"levels.3.sphere_share", 1 / 8.0},
        {"levels.3.power_share", 16 / 29.0}, {"levels.3.regions", 1},
        {"largest_regions.0.level", 3}, {"largest_regions.0.power_share", 16 / 29.0},
        {"largest_regions.0.solid_angle", sr},
        {"largest_regions.0.direction.theta_deg", 120}, {"largest_regions.0.direction.phi_deg", 225},
        {"largest_regions.1.level", 1}, {"largest_regions.1.power_share", 12 / 29.0},
        {"largest_regions.1.solid_angle", 4 * sr},
        {"largest_regions.1.direction.theta_deg", 120}, {"largest_regions.1.direction.phi_deg", 45},
        {"largest_regions.1.direction.x", a}, {"largest_regions.1.direction.y", a},
        {"largest_regions.1.direction.z", -0.5},
        {"largest_regions.2.level", 0}, {"largest_regions.2.power_share", 1 / 29.0},
        {"largest_regions.2.solid_angle", sr},
        {"largest_regions.2.direction.theta_deg", 60}, {"largest_regions.2.direction.phi_deg", 225},
    };
    char value[64];
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        const double found = json_number(json.output, numbers[i].path), expected = numbers[i].value;
        if (!(fabs(found - expected) <= 3e-7 * fabs(expected)))
            fail_msg("%s is %.17g", numbers[i].path, found); /* directions are floats */
    }
    static const char *const none[] = {"levels.4", "largest_regions.3", "mean_rgb.3"};
    for (int i = 0; i < 3; i++) assert_string_equal(json_value(value, sizeof value, json.output, none[i]), "");
    assert_string_equal(json_value(value, sizeof value, json.output, "map"), "\"" DIR "/hand.pfm\"");
    assert_string_equal(json_value(value, sizeof value, json.output, "mapping"), "\"latlong\"");
    assert_string_equal(json_value(value, sizeof value, json.output, "power_before"), "null");
    assert_string_equal(json_value(value, sizeof value, json.output, "power_after"), "null");
}

/* A region of two pixels, from theta 0 to 45 and to 90 degrees. With a = cos 45 their shares of the solid angle are 1 -
 * a and a, the cosines in their middle (1 + a)/2 and a/2; so the sum of the cosines is (1 - a^2)/2 + a^2/2 = 1/2. */
static void the_centre_of_a_region_weighs_pixels_by_their_solid_angles(void **state)
{
    rgb pixels[32];
    program_run r;
    for (int i = 0; i < 32; i++) pixels[i] = i == 0 || i == 8 ? (rgb){16, 16, 16} : (rgb){1, 1, 1};
    const bis_image image = {8, 4, pixels, NULL};
    assert_int_equal(bis_image_save(&image, DIR "/two.pfm", NULL), BIS_OK);
    program_expect(&r, 0, "envmap " DIR "/two.pfm --json");
    assert_near(json_number(r.output, "largest_regions.0.solid_angle"), PI / 4, 1e-12);
    const double a = sqrt(0.5), sines = (1 - a) * sqrt(1 - (1 + a) * (1 + a) / 4) + a * sqrt(1 - a * a / 4);
    assert_near(json_number(r.output, "largest_regions.0.direction.theta_deg"), atan(2 * sines) * 180 / PI, 1e-4);
}

/* Black: no peak, no contrast, no levels; of one colour: a region on all sides. */
static void a_black_map_and_a_plain_one_have_short_reports(void **state)
{
    program_run r;
    char value[64];
    rgb black[8] = {{0, 0, 0}}, plain[8];
    const bis_image dark = {4, 2, black, NULL}, same_all_over = {4, 2, plain, NULL};
    for (int i = 0; i < 8; i++) plain[i] = (rgb){1, 2, 4};
    assert_int_equal(bis_image_save(&dark, DIR "/black.pfm", NULL), BIS_OK);
    assert_int_equal(bis_image_save(&same_all_over, DIR "/plain.pfm", NULL), BIS_OK);

    program_expect(&r, 0, "envmap " DIR "/black.pfm");
    const char *const end = strstr(r.output, "regions     0 in 0 levels\ntable       ");
    assert_non_null(end);
    assert_non_null(strstr(r.output, "intensity   min 0, median 0, mean 0, max 0 (r+g+b; min: of the pixels that are "
                                     "not black)\n"));
    assert_non_null(strstr(r.output, "black       100% of the sphere\nregions"));
    assert_string_equal(strstr(end, " beyond the map"), " beyond the map\n");
    program_expect(&r, 0, "envmap --json " DIR "/black.pfm");
    static const char *const nulls[] = {"peak", "contrast"};
    for (int i = 0; i < 2; i++) assert_string_equal(json_value(value, sizeof value, r.output, nulls[i]), "null");
    assert_near(json_number(r.output, "black_share"), 1, 1e-12);
    assert_true(json_number(r.output, "brightest_0.1_percent") == 0);
    assert_string_equal(json_value(value, sizeof value, r.output, "levels"), "[]");

    program_expect(&r, 0, "envmap " DIR "/plain.pfm");
    assert_non_null(strstr(r.output, "regions     1 in 1 level\n"));
    assert_non_null(strstr(r.output, "     1     0 100.0000%      12.57 sr  on all sides\n"));
    program_expect(&r, 0, "envmap --json " DIR "/plain.pfm");
    assert_string_equal(json_value(value, sizeof value, r.output, "largest_regions.0.direction"), "null");
    assert_string_equal(json_value(value, sizeof value, r.output, "levels.1"), "");
}

/* The library's own resampling is tested elsewhere; here that the report tells its figures, and each its own. */
static void the_report_of_a_probe_has_its_power_before_and_after(void **state)
{
    enum { N = 8 };
    program_run r;
    char value[64], line[256];
    bis_image probe;
    bis_envmap em;
    assert_int_equal(bis_image_init(&probe, N, N, NULL), BIS_OK);
    for (int i = 0; i < N * N; i++) probe.pixels[i] = (rgb){(float)(i * 37 % 23), (float)(i % N), 1};
    assert_int_equal(bis_image_save(&probe, DIR "/power.pfm", NULL), BIS_OK);
    for (int width = 0; width <= 6; width += 6) {
        char option[32] = "";
        if (width) snprintf(option, sizeof option, " --width %d", width);
        assert_int_equal(bis_envmap_from_mapping(&em, &probe, BIS_MAPPING_ANGULAR, width, NULL), BIS_OK);
        const double before = em.power_before, after = em.power_after;
        bis_envmap_clear(&em);
        assert_true(before > 1 && fabs(after / before - 1) > 1e-10); /* they differ by the rounding of floats */
        program_expect(&r, 0, "envmap --mapping angular --json " DIR "/power.pfm%s", option);
        assert_near(json_number(r.output, "power_before") / before, 1, 1e-12);
        assert_near(json_number(r.output, "power_after") / after, 1, 1e-12);
        assert_near(json_number(r.output, "power") / after, 1, 1e-12);
        assert_true(json_number(r.output, "width") == (width ? width : 2 * N) &&
                    json_number(r.output, "height") == (width ? width / 2 : N));
        assert_string_equal(json_value(value, sizeof value, r.output, "mapping"), "\"angular\"");
        program_expect(&r, 0, "envmap --mapping angular " DIR "/power.pfm%s", option);
        snprintf(line, sizeof line,
            "%d x %d, resampled from angular\npower       %.6g before, %.6g after resampling (%+.3f%%)\nintensity ",
            width ? width : 2 * N, width ? width / 2 : N, before, after, 100 * (after / before - 1));
        if (!strstr(r.output, line)) fail_msg("no %s in %s", line, r.output);
    }
    bis_image_clear(&probe);
}

/* ---- pictures by hand ---- */

static void assert_colour(rgb c, rgb expected)
{
    assert_near((double)c.r, (double)expected.r, 1e-6);
    assert_near((double)c.g, (double)expected.g, 1e-6);
    assert_near((double)c.b, (double)expected.b, 1e-6);
}

static void read_picture(bis_image *image, const char *path)
{
    bis_diag diag = {0};
    if (bis_image_read(image, path, (bis_loc){0}, &diag)) fail_msg("%s", path);
    bis_diag_clear(&diag);
    assert_true(image->width == 4 && image->height == 2);
}

/* The map by hand: its regions are, in reading order, of levels 1, 0 and 3; their hues 0, 0.618 and 0.236 turns, their
 * saturations 0.75 - 0.45 h, values 0.25 + 0.75 h, h = 1/3, 0, 1. In sixths of a turn 0.618 is 3.708, between cyan and
 * blue: least, least + what is left, most; 0.236 is 1.416, between yellow and green. All regions are larger than a
 * small light: importance is as intensity is, and the heat of log 3 over log 16. */
static void pictures_of_a_map_by_hand_have_the_colours_by_hand(void **state)
{
    static const struct { const char *options, *name; } ways[] = {
        {"--out " DIR "/by.hand.pfm", "by.hand"}, {"--out " DIR "/by.v2/hand.pfm", "by.v2/hand"}};
    program_run r;
    rgb pixels[8];
    const bis_image map = map_by_hand(pixels);
    const double g = 0.6180339887498949, blue = 6 * g - 3, green = 6 * (2 * g - 1) - 1;
    const rgb black = {0, 0, 0}, of_1 = bis_palette_srgb(0.5, 0.2, 0.2),
              of_3 = bis_palette_srgb(0.7 + 0.3 * (1 - green), 1, 0.7),
              of_0 = bis_palette_srgb(0.0625, 0.0625 + (1 - blue) * 0.1875, 0.25);
    const rgb regions[8] = {of_1, black, of_0, black, of_1, of_1, of_3, of_1};
    const double level[8] = {1, -1, 0, -1, 1, 1, 3, 1}, q = log(3) / log(16), heat[8] = {q, -1, 0, -1, q, q, 1, q};
    program_folder(DIR "/by.v2");
    assert_int_equal(bis_image_save(&map, DIR "/hand.pfm", NULL), BIS_OK);
    for (int w = 0; w < 2; w++) {
        static const char *const what[] = {"map", "levels", "regions", "importance"};
        program_expect(&r, 0, "envmap --levels 4 --samples 0 " DIR "/hand.pfm %s", ways[w].options);
        for (int k = 0; k < 4; k++) {
            char path[256];
            bis_image image;
            snprintf(path, sizeof path, DIR "/%s-%s.pfm", ways[w].name, what[k]);
            read_picture(&image, path);
            for (int i = 0; i < 8; i++) {
                const rgb good = rgb_is_finite(pixels[i]) && pixels[i].r >= 0
                                     ? pixels[i]
                                     : (rgb){0, pixels[i].g > 0 && i == 5 ? 2 : 0, i == 5 ? 1 : 0};
                if (k == 0) assert_colour(image.pixels[i], good);
                if (k == 1) assert_colour(image.pixels[i], level[i] < 0 ? black : bis_palette_heat(level[i] / 3));
                if (k == 2) assert_colour(image.pixels[i], regions[i]);
                if (k == 3) assert_colour(image.pixels[i], heat[i] < 0 ? black : bis_palette_heat(heat[i]));
            }
            bis_image_clear(&image);
        }
    }
    program_expect(&r, 0, "envmap --levels 1 --samples 0 " DIR "/hand.pfm --out " DIR "/one.pfm");
    bis_image image;
    read_picture(&image, DIR "/one-levels.pfm");
    for (int i = 0; i < 8; i++) assert_colour(image.pixels[i], heat[i] < 0 ? black : bis_palette_heat(0));
    bis_image_clear(&image);
}

/* Three pixels of one row, as bright as 1, 4 and 16 in each order: the darkest has the heat 0, the next that of log 4
 * over log 16, the brightest 1, wherever they stand. Their sizes are equal. */
static void importance_is_seen_from_the_darkest_to_the_brightest_pixel(void **state)
{
    static const int orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    const bis_importance_options options = {.table = true, .levels = 8};
    for (int o = 0; o < 6; o++) {
        bis_envmap em = map_new(3, 1);
        bis_importance *im;
        bis_image image;
        for (int i = 0; i < 3; i++) em.pixels[i] = (rgb){(float)(1 << 2 * orders[o][i]), 0, 0};
        assert_int_equal(bis_importance_new(&im, &em, &options, NULL), BIS_OK);
        assert_int_equal(bis_survey_importance_picture(&image, &em, im, 0, NULL), BIS_OK);
        for (int i = 0; i < 3; i++) assert_colour(image.pixels[i], bis_palette_heat(orders[o][i] / 2.0));
        bis_image_clear(&image);
        bis_importance_free(im);
        bis_envmap_clear(&em);
    }
}

/* The same three pixels as regions: the darkest is of level 0, the brightest of 7, of eight, the other of 4, which
 * begins at 16^(4/8). With h their share of the highest level, the largest channel is as bright as 0.25 + 0.75 h, and
 * the least has 0.25 + 0.45 h of that. */
static void regions_are_brighter_and_paler_the_higher_their_level(void **state)
{
    static const int orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    static const double height[3] = {0, 4 / 7.0, 1};
    for (int o = 0; o < 6; o++) {
        bis_envmap em = map_new(3, 1);
        bis_regions r;
        bis_image image;
        for (int i = 0; i < 3; i++) em.pixels[i] = (rgb){(float)(1 << 2 * orders[o][i]), 0, 0};
        assert_int_equal(bis_regions_init(&r, &em, 8, NULL), BIS_OK);
        assert_int_equal(bis_survey_regions_picture(&image, &em, &r, NULL), BIS_OK);
        for (int i = 0; i < 3; i++) {
            const double h = height[orders[o][i]], most = 0.25 + 0.75 * h;
            const rgb c = image.pixels[i], expected = bis_palette_srgb(most, most * (0.25 + 0.45 * h), 0);
            assert_near((double)rgb_max(c), (double)expected.r, 1e-6);
            assert_near(fmin(fmin((double)c.r, (double)c.g), (double)c.b), (double)expected.g, 1e-6);
        }
        bis_image_clear(&image);
        bis_regions_clear(&r);
        bis_envmap_clear(&em);
    }
}

/* A picture that has no memory says so. */
static void pictures_without_memory_say_so(void **state)
{
    bis_envmap em = map_random(8, 4, 4, 0, 2);
    bis_regions r;
    bis_importance *im;
    const bis_importance_options options = {.table = true, .levels = 8};
    assert_int_equal(bis_regions_init(&r, &em, 8, NULL), BIS_OK);
    assert_int_equal(bis_importance_new(&im, &em, &options, NULL), BIS_OK);
    for (int k = 0; k < 3; k++) {
        FOR_LACK(l) {
            bis_image image;
            if (k == 0) LACK(l, bis_survey_levels_picture(&image, &em, 8, NULL));
            if (k == 1) LACK(l, bis_survey_regions_picture(&image, &em, &r, NULL));
            if (k == 2) LACK(l, bis_survey_importance_picture(&image, &em, im, 3, NULL));
            assert_int_equal(l.status, l.over ? BIS_OK : BIS_NOMEM);
            if (!l.status) bis_image_clear(&image);
        }
    }
    bis_importance_free(im);
    bis_regions_clear(&r);
    bis_envmap_clear(&em);
}

/* One dot, in a corner, a lamp that outshines all. Of `rows` rows a radius is rows/200 pixels: within it is bright,
 * within 1.6 of it the rest is dimmed to 0.3, across the seam, not across the pole. */
static void assert_dot(int rows, double radius)
{
    enum { W = 40 };
    bis_envmap em = map_new(W, rows);
    bis_importance *im;
    bis_image plain, dotted;
    const bis_importance_options options = {.table = true, .levels = 8};
    for (size_t i = 0; i < map_n(&em); i++) em.pixels[i] = (rgb){1e-9f, 0, 0};
    em.pixels[0] = (rgb){1e12f, 0, 0};
    assert_int_equal(bis_importance_new(&im, &em, &options, NULL), BIS_OK);
    assert_int_equal(bis_survey_importance_picture(&plain, &em, im, 0, NULL), BIS_OK);
    assert_int_equal(bis_survey_importance_picture(&dotted, &em, im, 1, NULL), BIS_OK);
    const rgb bright = bis_palette_srgb(0.55, 1, 0.95);
    for (int y = 0; y < rows; y++) {
        for (int x = 0; x < W; x++) {
            const int dx = x < W / 2 ? x : W - x, i = y * W + x;
            const double d = sqrt(dx * dx + y * y) / radius;
            assert_colour(dotted.pixels[i], d <= 1     ? bright
                                            : d <= 1.6 ? rgb_scale(plain.pixels[i], 0.3)
                                                       : plain.pixels[i]);
        }
    }
    bis_image_clear(&plain);
    bis_image_clear(&dotted);
    bis_importance_free(im);
    bis_envmap_clear(&em);
}

static void a_dot_has_a_rim_and_goes_around_the_seam(void **state)
{
    assert_dot(20, 0.5);
    assert_dot(250, 1.25); /* 1.6 of it are two pixels, and they are still dimmed */
    assert_dot(300, 1.5);
    assert_dot(450, 2.25);
}

/* ---- the page ---- */

/* Number i of those in the base64 at a path, each of `size` bytes, the highest first. */
static double number_in(const char *text, const char *path, int i, int size)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const size_t n = strlen(text) + 1;
    char *codes = malloc(n);
    double v = 0;
    json_value(codes, n, text, path);
    for (int at = i * size; at < (i + 1) * size; at++) { /* byte `at` has bits of two digits */
        const char *quad = codes + 1 + at / 3 * 4;
        unsigned long bits = 0;
        for (int k = 0; k < 4; k++)
            bits = bits << 6 | (quad[k] == '=' ? 0 : (unsigned long)(strchr(digits, quad[k]) - digits));
        v = 256 * v + (double)(bits >> (16 - 8 * (at % 3)) & 255);
    }
    free(codes);
    return v;
}

/* The samples of a page, in the middles of pixels, are the dots of the picture, a pixel each on so small a map. */
static void the_samples_of_a_page_are_the_dots_of_the_picture(void **state)
{
    bool is_drawn[32 * 16] = {false};
    program_run r;
    bis_image dots;
    program_expect(&r, 0, "envmap " DIR "/map.pfm --samples 20 --html " DIR "/dots.html --out " DIR "/dots.pfm");
    char *const text = page_data(DIR "/dots.html");
    for (int i = 0; i < 20; i++) {
        char path[32];
        snprintf(path, sizeof path, "samples.%d.theta_deg", i);
        const double y = json_number(text, path) * 16 / 180 - 0.5;
        snprintf(path, sizeof path, "samples.%d.phi_deg", i);
        const double x = json_number(text, path) * 32 / 360 - 0.5;
        assert_true(fabs(y - round(y)) < 1e-9 && fabs(x - round(x)) < 1e-9 && y > -1 && y < 16 && x > -1 && x < 32);
        is_drawn[(int)(32 * round(y) + round(x))] = true;
    }
    assert_true(isnan(json_number(text, "samples.20.phi_deg")));
    free(text);
    assert_int_equal(bis_image_read(&dots, DIR "/dots-importance.pfm", (bis_loc){0}, NULL), BIS_OK);
    const rgb bright = bis_palette_srgb(0.55, 1, 0.95);
    for (int i = 0; i < 32 * 16; i++) assert_int_equal(same(dots.pixels[i], bright), is_drawn[i]);
    bis_image_clear(&dots);
}

/* The picture of the page of a map of 4 x 2 pixels: each is `scale` times the map's, at most 1, to 8 bits. */
static void assert_page_picture(const char *path, const rgb map[8], double scale)
{
    char *const text = page_data(path);
    const size_t size = strlen(text) + 100;
    char *address = malloc(size), *drawing = malloc(size);
    bis_image image;
    snprintf(drawing, size, "<image id=\"m\" href=%s", json_value(address, size, text, "places.picture"));
    picture_in(&image, drawing, "m");
    assert_true(image.width == 4 && image.height == 2);
    for (int i = 0; i < 8; i++) {
        assert_near((double)image.pixels[i].r, fmin(1, scale * (double)map[i].r), 0.004);
        assert_near((double)image.pixels[i].g, fmin(1, scale * (double)map[i].g), 0.004);
        assert_near((double)image.pixels[i].b, fmin(1, scale * (double)map[i].b), 0.004);
    }
    bis_image_clear(&image);
    free(address);
    free(drawing);
    free(text);
}

/* A third of the median, or of an eighth of the mean if that is more, is a middle grey, 0.18. By hand: the median is 3,
 * of a channel 1. With a lamp of 363 among seven pixels of 3 the mean is 48: of a channel 2. What is black is black. */
static void the_picture_of_a_page_is_scaled_to_a_middle_grey(void **state)
{
    program_run r;
    rgb pixels[8];
    const bis_image image = map_by_hand(pixels);
    for (int k = 0; k < 3; k++) {
        static const double scales[] = {0.18, 0.09, 1};
        rgb shown[8] = {{1, 1, 1}, {0, 0, 0}, {1, 0, 0}, {0, 0, 0}, {0, 3, 0}, {0, 2, 1}, {8, 6, 2}, {0, 0, 3}};
        for (int i = 0; i < 8 && k; i++) pixels[i] = shown[i] = k == 2 ? (rgb){0, 0, 0} : (rgb){1, 1, 1};
        if (k == 1) pixels[6] = shown[6] = (rgb){121, 121, 121};
        assert_int_equal(bis_image_save(&image, DIR "/grey.pfm", NULL), BIS_OK);
        program_expect(&r, 0, "envmap " DIR "/grey.pfm --levels 4 --samples 1 --html " DIR "/grey.html");
        assert_page_picture(DIR "/grey.html", shown, scales[k]);
    }
}

/* The map by hand, without area weighting: densities are r+g+b over their integral, 29 pi/2; codes are logarithms
 * between 1 and 16. A region holds together over the seam. */
static void the_page_of_a_map_by_hand_has_its_levels_regions_and_densities(void **state)
{
    static const double intensity[] = {3, 0, 1, 0, 3, 3, 16, 3}, level[] = {1, 255, 0, 255, 1, 1, 3, 1};
    static const char *const shown[] = {"<h1>hand.pfm</h1>", "<b>4 × 2</b>pixels, latlong", "<b>16 : 1</b>contrast",
        "<b>45.5531</b>power", "<b>0.44%</b>of it in the brightest", "<b>25%</b>of the sphere is black",
        "<b>3</b>regions in 4 levels", "every pixel",
        "<th>3</th><td>8</td><td>16</td><td>1</td><td>12%</td> <td style=`--s:100%`>55%</td><td>1</td>",
        "<th>1</th><td>2</td><td>4</td><td>4</td><td>50%</td> <td style=`--s:75%`>41%</td><td>1</td>",
        "Regions with most power", "<th>1</th><td>3</td><td>55%</td><td>1.571 sr</td> <td>120.0</td><td>225.0</td>",
        NULL};
    program_run r;
    rgb pixels[8];
    char why[200];
    const bis_image image = map_by_hand(pixels);
    assert_int_equal(bis_image_save(&image, DIR "/hand.pfm", NULL), BIS_OK);
    program_expect(&r, 0, "envmap " DIR "/hand.pfm --levels 4 --areaexponent 0 --samples 50 --html " DIR "/hand.html");
    char *text = page_data(DIR "/hand.html");
    assert_true(json_is_valid(text));
    assert_string_equal(json_keys(why, sizeof why, text, "places"),
                        "width height step picture level region least most density ");
    assert_string_equal(json_keys(why, sizeof why, text, "samples.0"), "theta_deg phi_deg ");
    assert_true(json_number(text, "places.width") == 4 && json_number(text, "places.height") == 2 &&
                json_number(text, "places.step") == 1);
    assert_near(json_number(text, "power"), 29 * PI / 2, 1e-5); /* what --json says is there, too */
    assert_near(json_number(text, "places.least"), 1 / (29 * PI / 2), 1e-7);
    assert_near(json_number(text, "places.most"), 16 / (29 * PI / 2), 1e-6);
    for (int i = 0; i < 8; i++) {
        const double code = intensity[i] > 0 ? 1 + round(65534 * log(intensity[i]) / log(16)) : 0;
        const double region = number_in(text, "places.region", i, 4), first = number_in(text, "places.region", 0, 4);
        assert_true(number_in(text, "places.level", i, 1) == level[i]);
        assert_true(number_in(text, "places.density", i, 2) == code); /* 3 is 0.2 from where rounding turns */
        assert_true((region == UINT32_MAX) == (intensity[i] == 0));
        assert_true((region == first) == (intensity[i] == 3));
    }
    for (int i = 0; i < 50; i++) { /* in the middle of a pixel that is not black */
        char path[32];
        snprintf(path, sizeof path, "samples.%d.theta_deg", i);
        const double y = json_number(text, path) / 90 - 0.5;
        snprintf(path, sizeof path, "samples.%d.phi_deg", i);
        const double x = json_number(text, path) / 90 - 0.5;
        assert_true((y == 0 || y == 1) && x == floor(x) && intensity[(int)(4 * y + x)] > 0);
    }
    free(text);
    text = page_shown(DIR "/hand.html", DIR);
    if (text) page_in_order(text, shown);
    free(text);
    unsigned char *page;
    size_t size;
    assert_int_equal(bis_file_read(&page, &size, DIR "/hand.html", (bis_loc){0}, NULL), BIS_OK);
    text = (char *)page;
    if (!html_is_well_formed(text, why, sizeof why) || !html_is_self_contained(text, why, sizeof why))
        fail_msg("%s", why);
    page_in_order(text,
        (const char *const[]){"<pre id=`text`>map         " DIR "/hand.pfm, 4 x 2", "regions with most power", NULL});
    bis_free(text);
}

/* Of a map of 1441 columns each third pixel is there, the one in the middle, or the last one. A place has the mean
 * density of its pixels, of nine, or of one in the corner. A map of one value has its highest code everywhere; a black
 * map has a page, and no densities. */
static void the_page_of_a_large_map_has_some_of_its_pixels(void **state)
{
    program_run r;
    bis_image image;
    assert_int_equal(bis_image_init(&image, 1441, 4, NULL), BIS_OK);
    for (int i = 0; i < 1441 * 4; i++) image.pixels[i] = (rgb){1, 1, 1};
    image.pixels[1441 + 4] = (rgb){16, 16, 16}; /* the middle of the second place */
    image.pixels[3 * 1441 + 1440] = (rgb){16, 16, 16};
    image.pixels[1441 + 6] = (rgb){16, 16, 16}; /* in no middle */
    assert_int_equal(bis_image_save(&image, DIR "/large.pfm", NULL), BIS_OK);
    program_expect(&r, 0, "envmap " DIR "/large.pfm --levels 2 --areaexponent 0 --html " DIR "/large.html");
    char *text = page_data(DIR "/large.html");
    assert_true(json_number(text, "places.width") == 481 && json_number(text, "places.height") == 2 &&
                json_number(text, "places.step") == 3);
    for (int i = 0; i < 481 * 2; i += i < 3 ? 1 : 479) {
        const bool is_bright = i == 1 || i == 2 * 481 - 1;
        assert_true(number_in(text, "places.level", i, 1) == is_bright);
    }
    assert_true(number_in(text, "places.density", 0, 2) == 1);
    assert_near(number_in(text, "places.density", 1, 2), 1 + 65534 * log((16 + 8) / 9.) / log(16.), 1);
    assert_near(number_in(text, "places.density", 2, 2), 1 + 65534 * log((16 + 8) / 9.) / log(16.), 1);
    assert_true(number_in(text, "places.density", 2 * 481 - 1, 2) == 65535);
    free(text);
    for (int black = 0; black < 2; black++) {
        for (int i = 0; i < 1441 * 4; i++) image.pixels[i] = black ? (rgb){0, 0, 0} : (rgb){1, 1, 1};
        assert_int_equal(bis_image_save(&image, DIR "/large.pfm", NULL), BIS_OK);
        program_expect(&r, 0, "envmap " DIR "/large.pfm --areaexponent 0 --html " DIR "/large.html");
        text = page_data(DIR "/large.html");
        assert_true(number_in(text, "places.density", 7, 2) == (black ? 0 : 65535));
        assert_true((json_number(text, "places.least") == 0) == black);
        free(text);
    }
    text = page_shown(DIR "/large.html", DIR);
    if (text) page_in_order(text, (const char *const[]){"<b>100%</b>of the sphere is black", NULL});
    free(text);
    program_expect(&r, 2, "envmap " DIR "/large.pfm --html " DIR "/large.pfm");
    bis_image_clear(&image);
}

/* Pictures of --outdir have the map's name up to its last dot, and all of a name that only begins with one; none of the
 * four replaces the map; a name of 4000 bytes is the longest. */
static void pictures_have_the_name_of_their_map(void **state)
{
    static const char *const what[] = {"map", "levels", "regions", "importance"};
    static const char *const maps[][2] = {{"a.b.pfm", "a.b"}, {".pfm", ".pfm"}};
    char path[128], command[4200];
    program_run r;
    program_folder(DIR "/named");
    for (int i = 0; i < 2; i++) {
        snprintf(path, sizeof path, "cp " DIR "/map.pfm " DIR "/named/%s", maps[i][0]);
        assert_int_equal(system(path), 0);
        program_expect(&r, 0, "envmap --json " DIR "/named/%s --outdir " DIR "/named", maps[i][0]);
        for (int k = 0; k < 4; k++) {
            snprintf(path, sizeof path, DIR "/named/%s-%s.png", maps[i][1], what[k]);
            assert_true(program_exists(path));
        }
    }
    for (int k = 0; k < 4; k++) {
        snprintf(path, sizeof path, "cp " DIR "/map.pfm " DIR "/named/sky-%s.pfm", what[k]);
        assert_int_equal(system(path), 0);
        program_expect(&r, 2, "envmap " DIR "/named/sky-%s.pfm --out " DIR "/named/sky.pfm", what[k]);
        assert_non_null(strstr(r.messages, "which is read; give the output another name"));
        snprintf(path, sizeof path, DIR "/named/sky-%s.pfm", what[k]);
        unlink(path);
    }
    for (int more = 0; more < 2; more++) {
        int n = snprintf(command, sizeof command, "envmap --json " DIR "/map.pfm --out ");
        const int begin = n;
        n += snprintf(command + n, sizeof command - (size_t)n, DIR);
        for (; n < begin + 4000 + more - 5; n++) command[n] = '/';
        snprintf(command + n, sizeof command - (size_t)n, "x.png");
        program_expect(&r, more ? 2 : 0, "%s", command);
        assert_string_equal(r.messages, more ? "bis: error: --out: the name is longer than 4000 bytes\n" : "");
    }
    assert_true(program_exists(DIR "/x-importance.png"));
}

/* A map with one lamp goes to each mapping and comes back: the program's own figures, the files' means, the lamp's
 * place. */
static void a_map_is_converted_and_comes_back(void **state)
{
    enum { W = 64, H = 32, LAMP = 9 * W + 25 };
    program_run r;
    bis_image map;
    assert_int_equal(bis_image_init(&map, W, H, NULL), BIS_OK);
    for (int i = 0; i < W * H; i++) map.pixels[i] = (rgb){.5f, .5f, .5f};
    map.pixels[LAMP] = (rgb){1000, 500, 250};
    assert_int_equal(bis_image_save(&map, DIR "/there.pfm", NULL), BIS_OK);
    bis_envmap em;
    assert_int_equal(bis_envmap_from_latlong(&em, &map, NULL), BIS_OK);
    const double power = bis_envmap_power(&em);
    for (int m = 1; m < BIS_N_MAPPINGS; m++) {
        const char *name = bis_mapping_names[m];
        program_expect(&r, 0, "envmap " DIR "/there.pfm --to %s --out " DIR "/%s.exr", name, name);
        const char *before = strstr(r.output, "power       "), *line = strstr(r.output, "wrote       " DIR "/");
        double figures[2];
        assert_true(line && before);
        figures[0] = strtod(before + 12, NULL);
        figures[1] = strtod(strstr(before, "before, ") + 8, NULL);
        assert_near(figures[0] / power, 1, 1e-5);
        assert_near(figures[1] / power, 1, 1e-5);
        program_expect(
            &r, 0, "envmap --mapping %s " DIR "/%s.exr --to latlong --width 64 --out " DIR "/back.pfm", name, name);
        bis_image back;
        bis_envmap other;
        assert_int_equal(bis_image_read(&back, DIR "/back.pfm", (bis_loc){0}, NULL), BIS_OK);
        assert_int_equal(bis_envmap_from_latlong(&other, &back, NULL), BIS_OK);
        assert_near(bis_envmap_power(&other) / power, 1, 1e-3);
        size_t best = 0;
        for (size_t i = 0; i < W * H; i++)
            if (map_intensity(&other, i) > map_intensity(&other, best)) best = i;
        assert_true(best == LAMP);
        bis_envmap_clear(&other);
    }
    bis_envmap_clear(&em);
}

static void every_allocation_may_fail(void **state)
{
    bis_envmap em = map_random(16, 8, 4, 0.1, 1);
    bis_regions r;
    assert_int_equal(bis_regions_init(&r, &em, 8, NULL), BIS_OK);
    FOR_LACK(l) {
        bis_survey s;
        LACK(l, bis_survey_init(&s, &em, &r, 8, NULL));
    }
    bis_regions_clear(&r);
    bis_envmap_clear(&em);
}

static void every_allocation_of_a_page_may_fail(void **state)
{
    const bis_light_desc desc = {
        .L = {1, 1, 1}, .scale = 1, .area_exponent = 0.15, .levels = 8, .to_world = bis_xform_identity()};
    bis_envmap em = map_random(16, 8, 4, 0.1, 1);
    const bis_survey s = survey_of(&em, 8);
    FILE *out = fopen("/dev/null", "w");
    bis_light *light;
    bis_regions r;
    assert_non_null(out);
    assert_int_equal(bis_regions_init(&r, &em, 8, NULL), BIS_OK);
    assert_int_equal(bis_light_from_envmap(&light, &em, &desc, BIS_NEED_TABLE, NULL), BIS_OK); /* em is the light's */
    FOR_LACK(l) {
        bis_json j = {.out = out};
        bis_diag diag = {0};
        bis_json_open(&j, NULL, '{');
        LACK(l, bis_survey_put_page(&j, &s, light, &r, 5, &diag));
        assert_int_equal(l.status == BIS_OK, l.over);
        assert_int_equal(diag.n_errors, !l.over);
        bis_diag_clear(&diag);
    }
    fclose(out);
    bis_regions_clear(&r);
    bis_light_free(light);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(quantiles_agree_with_sorting),
        cmocka_unit_test(levels_and_regions_account_for_everything),
        cmocka_unit_test(a_lamp_is_found_where_it_hangs),
        cmocka_unit_test(constant_and_black_maps_have_plain_surveys),
        cmocka_unit_test(pictures_show_levels_regions_and_importance),
        cmocka_unit_test(the_command_reports_and_draws),
        cmocka_unit_test(a_map_by_hand_has_the_report_by_hand),
        cmocka_unit_test(the_centre_of_a_region_weighs_pixels_by_their_solid_angles),
        cmocka_unit_test(a_black_map_and_a_plain_one_have_short_reports),
        cmocka_unit_test(the_report_of_a_probe_has_its_power_before_and_after),
        cmocka_unit_test(pictures_of_a_map_by_hand_have_the_colours_by_hand),
        cmocka_unit_test(importance_is_seen_from_the_darkest_to_the_brightest_pixel),
        cmocka_unit_test(regions_are_brighter_and_paler_the_higher_their_level),
        cmocka_unit_test(pictures_without_memory_say_so),
        cmocka_unit_test(a_dot_has_a_rim_and_goes_around_the_seam),
        cmocka_unit_test(the_samples_of_a_page_are_the_dots_of_the_picture),
        cmocka_unit_test(the_page_of_a_map_by_hand_has_its_levels_regions_and_densities),
        cmocka_unit_test(the_picture_of_a_page_is_scaled_to_a_middle_grey),
        cmocka_unit_test(the_page_of_a_large_map_has_some_of_its_pixels),
        cmocka_unit_test(pictures_have_the_name_of_their_map),
        cmocka_unit_test(a_map_is_converted_and_comes_back),
        cmocka_unit_test(every_allocation_may_fail),
        cmocka_unit_test(every_allocation_of_a_page_may_fail),
    };
    static const expect_text texts[] = {{"folder", DIR}, {NULL, NULL}};
    return expect_run("survey", tests, sizeof tests / sizeof *tests, setup, NULL,
                      &(expect_folder){"tests/data/expect/envmap", NULL, texts});
}
