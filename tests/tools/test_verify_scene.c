/* SPDX-License-Identifier: BSD-2-Clause */
/* `bis verify` as a command and for whole scenes. */
#include "tools/verify/verify.h"
#include "claim.h"
#include "bis/files/image_file.h"
#include "json_check.h"
#include "map_help.h"
#include "program.h"
#include "verify_help.h"

#include <stdio.h>
#include <string.h>

static void the_command_verifies_maps_and_scenes(void **state)
{
    program_run r;
    bis_envmap em = map_random(32, 16, 4, 0.1, 2);
    const bis_image square = {16, 16, em.pixels, NULL};
    verify_write_map();
    assert_int_equal(bis_image_save(&square, VERIFY_DIR "/probe.PFM", NULL), BIS_OK);
    verify_write_scene("scene.txt", verify_one_pixel);

    program_expect(&r, 0, "verify " VERIFY_DIR "/map.pfm");
    assert_string_equal(r.messages, "");
    assert_non_null(strstr(r.output, "14 tests, 0 failed, 0 skipped"));
    assert_non_null(strstr(r.output, "\npassed\n"));
    program_expect(&r, 0, "verify --json " VERIFY_DIR "/scene.txt --seed 5");
    assert_true(json_is_valid(r.output));
    assert_non_null(strstr(r.output, "\"passed\": true"));
    assert_non_null(strstr(r.output, ": rejection\""));
    program_expect(&r, 0, "verify " VERIFY_DIR "/probe.PFM --mapping angular");

    program_expect(&r, 2, "verify " VERIFY_DIR "/probe.PFM");
    assert_string_equal(r.output, "");
    bis_envmap_clear(&em);
}

/* ---- which tests a scene gets, by hand ---- */

static void run_text(bis_verify *v, const char *options, const char *world)
{
    static char text[8192];
    snprintf(text, sizeof text, "%s\nWorldBegin\n%s\n", options, world);
    program_write_file(VERIFY_DIR "/hand.txt", text);
    verify_run_file(v, VERIFY_DIR "/hand.txt");
}

static bool has_skip(const bis_verify *v, const char *group, const char *name, const char *why)
{
    for (size_t i = 0; i < v->n; i++) {
        const bis_verify_test *t = &v->tests[i];
        if (strcmp(t->group, group) == 0 && strcmp(t->name, name) == 0)
            return t->verdict == BIS_VERDICT_SKIPPED && strcmp(t->note, why) == 0;
    }
    return false;
}

static size_t count(const bis_verify *v, const char *group, const char *begin)
{
    size_t n = 0;
    for (size_t i = 0; i < v->n; i++)
        n += strcmp(v->tests[i].group, group) == 0 && strncmp(v->tests[i].name, begin, strlen(begin)) == 0;
    return n;
}

#define MAP_LIGHT "LightSource \"infinite\" \"string filename\" \"map.pfm\" "
#define PHONG(Kd, Ks, n) "Material \"phong\" \"float Kd\" " Kd " \"float Ks\" " Ks " \"float exponent\" " n " "

static void what_a_scene_lacks_is_skipped_and_says_why(void **state)
{
    bis_verify v = {.seed = 1, .halvings = 5};
    run_text(&v, verify_one_pixel, MAP_LIGHT);
    assert_int_equal(count(&v, "map", ""), 14);
    assert_int_equal(count(&v, "materials", ""), 0);
    assert_true(has_skip(&v, "view", "all integrators", "there is no geometry"));
    assert_true(has_skip(&v, "accelerators", "grid and embree", "there is no geometry"));
    assert_int_equal(v.n, 16);
    verify_assert_accepted(&v);

    v = (bis_verify){.seed = 1, .halvings = 5};
    run_text(&v, verify_one_pixel, "LightSource \"infinite\" \"rgb L\" [0 0 0] Shape \"sphere\"");
    assert_true(has_skip(&v, "map", "alias, cdf, curve", "the light is a constant, there is no map"));
    assert_true(has_skip(&v, "view", "all integrators", "there is no light"));
    assert_int_equal(count(&v, "accelerators", ""), 1);
    verify_assert_accepted(&v);

    v = (bis_verify){.seed = 1, .halvings = 5};
    run_text(&v, verify_one_pixel, "LightSource \"infinite\" Translate 50 0 0 Shape \"sphere\"");
    assert_true(has_skip(&v, "view", "all integrators", "no pixel was found that sees a surface in the light"));
    verify_assert_accepted(&v);
}

/* Each material once, at four angles; what is black or too narrow is left out, and what is beyond the 24th. Of 0.25 and
 * its like all angles have equally many tests. */
static void every_material_is_looked_at_once(void **state)
{
    static char world[8192] = MAP_LIGHT "Translate 50 0 0 "; /* out of view */
    bis_verify v = {.seed = 2, .halvings = 5};
    strcat(world, PHONG("0.25", "0.25", "7") "Shape \"sphere\" " PHONG("0.25", "0.25",
                      "8") "Shape \"sphere\" Shape \"disk\" " PHONG("0.25", "0.25", "7") "Shape \"sphere\" " PHONG("0",
                      "0", "7") "Shape \"sphere\" " PHONG("0.25", "0.25", "1e9") "Shape \"sphere\" " PHONG("0.5",
                      "0.25", "7") "Shape \"sphere\" " PHONG("0.25", "0.5", "7") "Shape \"sphere\" ");
    run_text(&v, verify_one_pixel, world);
    assert_true(has_skip(&v, "materials", "3", "it is black: nothing is drawn"));
    assert_true(has_skip(&v, "materials", "4, n 1e+09", "unit vectors in float cannot resolve exponents beyond 1e8"));
    static const char *const names[] = {"1, n 7, 0 degrees", "1, n 7, 45 degrees", "1, n 7, 75 degrees",
        "1, n 7, 89 degrees", "2, n 8, 0 degrees", "2, n 8, 89 degrees", "5, n 7, 45 degrees", "6, n 7, 75 degrees"};
    const size_t each = count(&v, "materials", names[0]);
    assert_true(each >= 3);
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) assert_int_equal(count(&v, "materials", names[i]), each);
    assert_int_equal(count(&v, "materials", ""), 4 * 4 * each + 2);
    verify_assert_accepted(&v);

    strcpy(world, MAP_LIGHT "Translate 50 0 0 " PHONG("0", "0", "7") "Shape \"sphere\" ");
    for (int i = 1; i < 24; i++)
        snprintf(world + strlen(world), 256, PHONG("0.25", "0.25", "1e%d") "Shape \"sphere\" ", 8 + i);
    v = (bis_verify){.seed = 2, .halvings = 5};
    run_text(&v, verify_one_pixel, world);
    assert_int_equal(count(&v, "materials", ""), 24);
    assert_true(has_skip(&v, "materials", "24, n 1e+31", "unit vectors in float cannot resolve exponents beyond 1e8"));
    verify_assert_accepted(&v);
    strcat(world, PHONG("0.25", "0.25", "2e30") "Shape \"sphere\" ");
    v = (bis_verify){.seed = 2, .halvings = 5};
    run_text(&v, verify_one_pixel, world);
    assert_int_equal(count(&v, "materials", ""), 25);
    assert_true(has_skip(&v, "materials", "25 and on", "too many: only the first are looked at"));
    verify_assert_accepted(&v);
}

/* Three columns of the table as the numbers that JSON has, "-" for none. */
static void assert_columns(const char *line, const char *json, int test)
{
    static const char *const names[] = {"statistic", "p", "threshold"};
    for (int k = 0; k < 3; k++) {
        char path[64], expected[32];
        snprintf(path, sizeof path, "tests.%d.%s", test, names[k]);
        const double x = json_number(json, path);
        if (isnan(x)) snprintf(expected, sizeof expected, " %10s", "-");
        else snprintf(expected, sizeof expected, " %10.3g", x);
        if (strncmp(line + 46 + 11 * k, expected, 11) != 0) fail_msg("%s is %s in\n%.120s", path, expected, line);
    }
}

/* A ball that is drawn from as printed, wrong on purpose, in the dark, where its material alone is looked at: the
 * status is 1, and table and JSON agree in each line about what failed, its numbers and how many there are. */
static void a_failure_is_told_in_table_and_json(void **state)
{
    static char json[1 << 17];
    program_run r;
    char value[256], path[64], expected[512], text[1024];
    int n = 0, failed = 0, statistical = 0, skipped = 0;
    snprintf(text, sizeof text, "Option \"string asprinted\" \"E34\"\nWorldBegin LightSource "
                       "\"infinite\" \"rgb L\" [0 0 0]\nTranslate 0 0 -5 " PHONG("0.1", "0.8", "5")
                       "Shape \"sphere\"\n");
    program_write_file(VERIFY_DIR "/wrong.txt", text);
    program_expect(&r, 1, "verify --json " VERIFY_DIR "/wrong.txt --seed 3");
    assert_true(json_is_valid(r.output) && strlen(r.output) < sizeof json);
    strcpy(json, r.output);
    program_expect(&r, 1, "verify " VERIFY_DIR "/wrong.txt --seed 3");
    for (const char *line = r.output; *line; line = strchr(line, '\n') + 1) {
        if (strncmp(line, "  ", 2) != 0) continue;
        snprintf(path, sizeof path, "tests.%d.name", n);
        json_value(value, sizeof value, json, path);
        snprintf(expected, sizeof expected, "  %-44.*s", (int)strlen(value) - 2, value + 1);
        if (strncmp(line, expected, strlen(expected)) != 0) fail_msg("%s is %s in\n%.120s", path, value, line);
        assert_columns(line, json, n);
        snprintf(path, sizeof path, "tests.%d.verdict", n);
        json_value(value, sizeof value, json, path);
        const bool is_failed = strcmp(value, "\"failed\"") == 0;
        failed += is_failed;
        skipped += strcmp(value, "\"skipped\"") == 0;
        snprintf(path, sizeof path, "tests.%d.p", n);
        statistical += !isnan(json_number(json, path));
        const char *const said = line + 46 + 33 + 2;
        const char *const word = is_failed ? "FAILED" : value[1] == 's' ? "skipped" : "passed";
        if (strncmp(said, word, strlen(word)) != 0) fail_msg("%s in\n%.120s", value, line);
        n++;
    }
    assert_true(failed > 0 && skipped == 2 && n > failed + skipped);
    snprintf(expected, sizeof expected, "\n%d tests, %d failed, %d skipped. %d of them are statistical: each fails "
             "below p = %.3g, so that", n, failed, skipped, statistical, 1 - pow(0.99, 1.0 / statistical));
    assert_non_null(strstr(r.output, expected));
    assert_non_null(strstr(r.output, "\nseed 3\nFAILED\n"));
    assert_true(json_number(json, "failed") == failed && json_number(json, "skipped") == skipped);
    assert_true(json_number(json, "statistical") == statistical && json_number(json, "seed") == 3);
    assert_near(json_number(json, "corrected"), 1 - pow(0.99, 1.0 / statistical), 1e-9);
    assert_string_equal(json_value(value, sizeof value, json, "passed"), "false");
    snprintf(path, sizeof path, "tests.%d.name", n);
    assert_string_equal(json_value(value, sizeof value, json, path), ""); /* no more tests than lines */
}

static void assert_same_tests(const bis_verify *a, const bis_verify *b)
{
    assert_int_equal(a->n, b->n);
    for (size_t i = 0; i < a->n; i++) {
        const bis_verify_test *x = &a->tests[i], *y = &b->tests[i];
        assert_string_equal(x->name, y->name);
        if (x->verdict != y->verdict || memcmp(&x->p, &y->p, sizeof x->p) != 0 ||
            memcmp(&x->statistic, &y->statistic, sizeof x->statistic) != 0)
            fail_msg("%s: %g, p %g, %s, and %g, p %g, %s", x->name, x->statistic, x->p, x->note, y->statistic, y->p,
                     y->note);
    }
}

/* Radiance has no natural unit: a light a million times as dim or as bright is judged in the same way. Times a power of
 * two each number keeps its digits, so that each statistic and each p is the same. */
static void the_unit_of_radiance_does_not_matter(void **state)
{
    static const char *const scales[] = {"1", "9.5367431640625e-07", "1048576"}; /* 1, 2^-20, 2^20 */
    static const char film[] = "Film \"rgb\" \"integer xresolution\" 8 \"integer yresolution\" 6 Integrator \"mis\"";
    bis_verify v[3];
    verify_write_map();
    for (int i = 0; i < 3; i++) {
        char world[512];
        snprintf(world, sizeof world, MAP_LIGHT "\"float scale\" %s Translate 0 0 4 " PHONG("0.5", "0.25", "7")
                 "Shape \"sphere\" Material \"diffuse\" Translate 0.5 0 2 Shape \"sphere\"", scales[i]);
        v[i] = (bis_verify){.seed = 4, .halvings = 5};
        run_text(&v[i], film, world);
        assert_int_equal(bis_verify_judge(&v[i], NULL), BIS_OK);
    }
    assert_true(count(v, "picture", "") > 1 && count(v, "view", "") > 1);
    for (int i = 1; i < 3; i++) assert_same_tests(&v[0], &v[i]);
    for (int i = 0; i < 3; i++) bis_verify_clear(&v[i]);
}

static void our_own_files_pass(void **state)
{
    static const char *const paths[] = {"data/scenes/figure-5.3.txt", "data/scenes/louvres.txt"};
    for (int i = 0; i < 2; i++) {
        bis_verify v = {.seed = 3, .halvings = 4};
        verify_run_file(&v, paths[i]);
        verify_assert_accepted(&v);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_command_verifies_maps_and_scenes),
        cmocka_unit_test(what_a_scene_lacks_is_skipped_and_says_why),
        cmocka_unit_test(every_material_is_looked_at_once),
        cmocka_unit_test(a_failure_is_told_in_table_and_json),
        cmocka_unit_test(the_unit_of_radiance_does_not_matter),
        cmocka_unit_test(our_own_files_pass),
    };
    return cmocka_run_group_tests_name("verify_scene", tests, NULL, NULL);
}
