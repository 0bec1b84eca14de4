/* SPDX-License-Identifier: BSD-2-Clause */
/* image: what holds for all formats: which one, messages, what a failure leaves behind. */
#include "claim.h"
#include "image_help.h"

#include "bis/base/file.h"
#include "bis/base/mem.h"
#include "bis/files/image_file.h"

#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

static const char *const endings[] = {"x.exr", "x.pfm", "x.hdr", "x.png"};
enum { N_ENDINGS = 4, N_READABLE = 3 };

/* Values that an .hdr holds exactly. Noise: nothing compresses it away. */
static bis_image noise(int width, int height)
{
    bis_image image;
    uint32_t seed = 1;
    assert_int_equal(bis_image_init(&image, width, height, NULL), BIS_OK);
    for (int i = 0; i < width * height; i++)
        image.pixels[i] = (rgb){(float)(128 + next_random(&seed) % 128), (float)(next_random(&seed) % 256),
                                (float)(next_random(&seed) % 256)};
    return image;
}

static void what_is_saved_is_read_whatever_the_name(void **state)
{
    bis_image image = noise(31, 17);
    for (int i = 0; i < N_READABLE; i++) {
        bis_image back;
        assert_int_equal(bis_image_save(&image, scratch(endings[i]), NULL), BIS_OK);
        assert_int_equal(rename(scratch(endings[i]), scratch("lying name.png")), 0);
        expect_image(&back, scratch("lying name.png"), NULL);
        assert_int_equal(back.width, 31);
        assert_int_equal(back.height, 17);
        assert_memory_equal(image.pixels, back.pixels, 31 * 17 * sizeof(rgb));
        bis_image_clear(&back);
    }
    bis_image_clear(&image);
}

static void only_four_endings_can_be_written_in_any_case_of_letters(void **state)
{
    assert_true(bis_image_can_write("a.exr") && bis_image_can_write("a.b/c.PFM") && bis_image_can_write("a.Hdr"));
    assert_true(bis_image_can_write("./a.png"));
    const char *const bad[] = {"a", "exr", "a.jpg", "a.exr.gz", "a.exr/b", "", "a."};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
        assert_false(bis_image_can_write(bad[i]));

    bis_image image = noise(1, 1);
    bis_diag diag = {0};
    assert_int_equal(bis_image_save(&image, "build/a.jpg", &diag), BIS_INPUT);
    assert_string_equal(diag.messages[0].text,
                        "build/a.jpg: error: cannot write \"build/a.jpg\": its ending must be .exr, .pfm, .hdr or "
                        ".png");
    bis_diag_clear(&diag);
    bis_image_clear(&image);
}

#define FOR_A_SCREEN(kind) "it is a " kind ": 8 bits for a screen, no radiance; take an .exr, .pfm or .hdr (`bis " \
    "SCENE --outfile NAME.exr` writes one)"
#define UNKNOWN(first) "it begins with the bytes " first ", must be a Radiance .hdr (#?), OpenEXR (76 2f 31 01) or " \
    "PFM (PF, Pf)"

/* Four bytes are enough to know a PNG, three a JPEG: the fourth is e0, e1, db, ... One byte that differs makes another
 * file of it. */
static void what_is_no_image_is_refused_by_its_first_bytes(void **state)
{
    static const bad_file others[] = {
        {BYTES(""), "the file is empty"}, {BYTES("ab"), "its 2 bytes are too few for an image"},
        {BYTES("this is text"), UNKNOWN("74 68 69 73")}, {BYTES("\x89PNG"), FOR_A_SCREEN("PNG")},
        {BYTES("\x89PNG\r\n\x1a\n"), FOR_A_SCREEN("PNG")}, {BYTES("\x89PNF...."), UNKNOWN("89 50 4e 46")},
        {BYTES("\x88PNG...."), UNKNOWN("88 50 4e 47")}, {BYTES("\xff\xd8\xff\xe0\0\x10JFIF"), FOR_A_SCREEN("JPEG")},
        {BYTES("\xff\xd8\xff\xdb"), FOR_A_SCREEN("JPEG")}, {BYTES("\xff\xd8\xfe\xe0...."), UNKNOWN("ff d8 fe e0")},
        {BYTES("\xfe\xd8\xff\xe0...."), UNKNOWN("fe d8 ff e0")},
        {BYTES("\xff\xd8\xff"), "its 3 bytes are too few for an image"},
    };
    expect_refusals(others, sizeof others / sizeof *others, "other.hdr");
}

static void expect_io(const char *path, const char *message)
{
    bis_image image;
    bis_diag diag = {0};
    assert_int_equal(bis_image_read(&image, path, (bis_loc){"scene.txt", 7, 12}, &diag), BIS_IO);
    assert_null(image.pixels);
    assert_int_equal(diag.n, 1);
    assert_string_equal(diag.messages[0].text, message);
    bis_diag_clear(&diag);
}

static void missing_and_directory_paths_are_io_errors_at_the_line_that_named_them(void **state)
{
    expect_io(
        "build/no such.exr", "scene.txt:7:12: error: cannot open \"build/no such.exr\": No such file or directory");
    expect_io("build", "scene.txt:7:12: error: \"build\" is a folder, must be a regular file");
    store(scratch("locked.hdr"), "#?", 2);
    chmod(scratch("locked.hdr"), 0);
    if (access(scratch("locked.hdr"), R_OK) == 0) return; /* the superuser may read anything */
    char message[256];
    snprintf(
        message, sizeof message, "scene.txt:7:12: error: cannot open \"%s\": Permission denied", scratch("locked.hdr"));
    expect_io(scratch("locked.hdr"), message);
}

/* A file system that is full after `bytes` of a file: the same errors, no root needed. */
static void limit_files_to(rlim_t n_bytes, struct rlimit *before)
{
    struct rlimit limit;
    assert_int_equal(getrlimit(RLIMIT_FSIZE, before), 0);
    limit = *before;
    limit.rlim_cur = n_bytes;
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &limit), 0);
}

static void a_full_disk_leaves_the_older_file_and_nothing_else(void **state)
{
    const rlim_t limits[] = {0, 1, 100, 4000, 20000};
    bis_image image = noise(200, 100); /* 40 kB or more in every format */
    signal(SIGXFSZ, SIG_IGN);
    for (int i = 0; i < N_ENDINGS; i++)
        for (size_t k = 0; k < sizeof limits / sizeof limits[0]; k++) {
            struct rlimit before;
            bis_diag diag = {0};
            store(scratch(endings[i]), "older", 5);
            int n_files = scratch_count();
            limit_files_to(limits[k], &before);
            bis_status status = bis_image_save(&image, scratch(endings[i]), &diag);
            setrlimit(RLIMIT_FSIZE, &before);
            assert_int_equal(status, BIS_IO);
            assert_int_equal(diag.n, 1);
            assert_true(holds(scratch(endings[i]), "older", 5));
            assert_int_equal(scratch_count(), n_files);
            bis_diag_clear(&diag);
        }
    signal(SIGXFSZ, SIG_DFL);
    bis_image_clear(&image);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_saved_is_read_whatever_the_name),
        cmocka_unit_test(only_four_endings_can_be_written_in_any_case_of_letters),
        cmocka_unit_test(what_is_no_image_is_refused_by_its_first_bytes),
        cmocka_unit_test(missing_and_directory_paths_are_io_errors_at_the_line_that_named_them),
        cmocka_unit_test(a_full_disk_leaves_the_older_file_and_nothing_else),
    };
    return cmocka_run_group_tests(tests, NULL, scratch_remove);
}
