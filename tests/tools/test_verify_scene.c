/* `bis verify` as a command and for whole scenes. */
#include "tools/verify/verify.h"
#include "stat.h"
#include "bis/files/image_file.h"
#include "json_check.h"
#include "map_help.h"
#include "program.h"
#include "verify_help.h"

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

static double alpha(void) { return stat_level(1e-3, 113); }

static void the_command_verifies_maps_and_scenes(void **state)
{
    (void)state;
    program_run r;
    bis_envmap em = map_random(32, 16, 4, 0.1, 2);
    const bis_image square = {16, 16, em.pixels};
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
    program_expect(&r, 2, "verify");
    program_expect(&r, 2, "verify " VERIFY_DIR "/map.pfm --seed x");
    program_expect(&r, 1, "verify " VERIFY_DIR "/no_such_map.hdr");
    program_expect(&r, 1, "verify " VERIFY_DIR "/no_such_scene.txt");
    assert_string_equal(r.output, "");
    bis_envmap_clear(&em);
}

/* The lattice comes back to the pixels of a small film: each is looked at once. */
static void a_pixel_is_looked_at_once(void **state)
{
    (void)state;
    bis_verify v = {.seed = 1, .halvings = 1}; /* three pixels are wanted */
    size_t in_view = 0;
    verify_write_map();
    verify_write_scene("small.txt", "Film \"rgb\" \"integer xresolution\" 2 \"integer yresolution\" 2\n");
    verify_run_file(&v, VERIFY_DIR "/small.txt");
    for (size_t k = 0; k < v.n; k++) {
        in_view += strcmp(v.tests[k].group, "view") == 0;
        for (size_t j = 0; j < k; j++) assert_string_not_equal(v.tests[j].name, v.tests[k].name);
    }
    assert_int_equal(in_view, 12); /* of four pixels, two see a surface in the light; sir is rendered */
    verify_assert_accepted(&v, alpha());
}

static void our_own_files_pass(void **state)
{
    (void)state;
    static const char *const paths[] = {"data/scenes/figure-5.3.txt", "data/scenes/louvres.txt"};
    for (int i = 0; i < 2; i++) {
        bis_verify v = {.seed = 3, .halvings = 4};
        verify_run_file(&v, paths[i]);
        verify_assert_accepted(&v, alpha());
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_command_verifies_maps_and_scenes),
        cmocka_unit_test(a_pixel_is_looked_at_once),
        cmocka_unit_test(our_own_files_pass),
    };
    return cmocka_run_group_tests_name("verify_scene", tests, NULL, NULL);
}
