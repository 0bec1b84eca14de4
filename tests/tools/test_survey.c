/* Tests of survey and of `bis envmap`: figures against sorting and closed forms, pictures against what they stand for,
 * exit statuses. */
#include "tools/survey/survey.h"

#include "bis/base/mem.h"
#include "bis/files/image_file.h"
#include "map_help.h"
#include "program.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

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
    (void)state;
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
    (void)state;
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
    (void)state;
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
    (void)state;
    bis_envmap em = map_new(16, 8);
    bis_survey s = survey_of(&em, 8);
    assert_true(s.power == 0 && s.n_regions == 0 && s.n_levels == 0 && s.black > 0.999 && s.median == 0 && s.least == 0);
    for (size_t i = 0; i < map_n(&em); i++) em.pixels[i] = (rgb){1, 2, 4};
    s = survey_of(&em, 8);
    assert_near(s.median, 7, 1e-9);
    assert_near(s.brightest, 0.001, 1e-12);
    assert_near(s.mean_rgb[2], 4, 1e-12);
    assert_int_equal(s.n_regions, 1);
    assert_true(s.largest[0].direction.x == 0 && s.largest[0].direction.z == 0); /* the whole sphere has no centre */
    bis_envmap_clear(&em);
}

/* ---- pictures ---- */

static bool same(rgb a, rgb b) { return a.r == b.r && a.g == b.g && a.b == b.b; }
static double grey(rgb c) { return 0.2126 * (double)c.r + 0.7152 * (double)c.g + 0.0722 * (double)c.b; }

static void pictures_show_levels_regions_and_importance(void **state)
{
    (void)state;
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
            if (map_intensity(&em, a) > map_intensity(&em, b)) assert_true(grey(importance.pixels[a]) >= grey(importance.pixels[b]));
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

static void the_command_reports_draws_and_refuses(void **state)
{
    (void)state;
    program_run r;
    program_folder(DIR);
    bis_envmap em = map_random(32, 16, 4, 0.1, 2);
    const bis_image image = {32, 16, em.pixels}, square = {16, 16, em.pixels};
    assert_int_equal(bis_image_save(&image, DIR "/map.pfm", NULL), BIS_OK);
    assert_int_equal(bis_image_save(&square, DIR "/probe.pfm", NULL), BIS_OK);

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

    program_expect(&r, 2, "envmap " DIR "/probe.pfm");
    assert_non_null(strstr(r.messages, "is square"));
    program_expect(&r, 2, "envmap " DIR "/map.pfm --out " DIR "/x.gif");
    program_expect(&r, 2, "envmap " DIR "/map.pfm --out " DIR "/x.png --outdir " DIR);
    program_expect(&r, 2, "envmap " DIR "/map.pfm --levels 0");
    program_expect(&r, 2, "envmap " DIR "/map.pfm --areaexponent 10.5");
    /* The limit of a scene, tests/data/bad/light-areaexponent-large.txt. */
    assert_non_null(strstr(r.messages, "must be a number in [0, 10]"));
    program_expect(&r, 2, "envmap");
    program_expect(&r, 1, "envmap " DIR "/no_such_map.hdr");
    assert_string_equal(r.output, "");
    bis_envmap_clear(&em);
}

static void every_allocation_may_fail(void **state)
{
    (void)state;
    bis_envmap em = map_random(16, 8, 4, 0.1, 1);
    bis_regions r;
    assert_int_equal(bis_regions_init(&r, &em, 8, NULL), BIS_OK);
    bis_status status = BIS_NOMEM;
    for (long k = 1; status; k++) {
        bis_survey s;
        bis_mem_fail_at(k);
        status = bis_survey_init(&s, &em, &r, 8, NULL);
        bis_mem_fail_at(0);
        assert_true(status == BIS_OK || status == BIS_NOMEM);
        assert_true(k < 100);
    }
    bis_regions_clear(&r);
    bis_envmap_clear(&em);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(quantiles_agree_with_sorting),
        cmocka_unit_test(levels_and_regions_account_for_everything),
        cmocka_unit_test(a_lamp_is_found_where_it_hangs),
        cmocka_unit_test(constant_and_black_maps_have_plain_surveys),
        cmocka_unit_test(pictures_show_levels_regions_and_importance),
        cmocka_unit_test(the_command_reports_draws_and_refuses),
        cmocka_unit_test(every_allocation_may_fail),
    };
    return cmocka_run_group_tests_name("survey", tests, NULL, NULL);
}
