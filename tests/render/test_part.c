/* SPDX-License-Identifier: BSD-2-Clause */
/* part: the parts of a picture, in any order, have the bits of one render; what does not belong together is refused by
 * name. Expected pictures are those of renders without parts. The twins are files in which one field is another, with a
 * checksum that fits: each is refused, or what comes out is another. */
#include "bis/base/mem.h"
#include "render/part.h"
#include "render/share.h"

#include "claim.h"
#include "file_help.h"
#include "image_help.h"
#include "program.h"
#include "state_help.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define DIR_NAME "build/test_part"
#define STATE DIR_NAME "/state"

#define COUNT(a) (sizeof(a) / sizeof *(a))

static int setup(void **state)
{
    program_folder(DIR_NAME);
    return 0;
}

/* ---- what is rendered ---- */

/* 37 x 21 pixels have 3 x 2 tiles; this crop touches all of them. */
static const double middle[4] = {0.2, 0.9, 0.2, 0.95};

static const kind kinds[] = {
    {"all", &bis_sir, BIS_SAMPLER_STRATIFIED, .learns = true, .edges = true, .layers = BIS_LAYERS_ALL, .crop = whole},
    {"all, crop", &bis_sir, BIS_SAMPLER_STRATIFIED, .learns = true, .edges = true, .layers = BIS_LAYERS_ALL,
     .crop = middle},
    {"plain", &bis_sir, BIS_SAMPLER_SOBOL, .crop = whole},
    {"plain, crop", &bis_sir, BIS_SAMPLER_SOBOL, .crop = middle},
    {"halton", &bis_mis, BIS_SAMPLER_HALTON, .crop = whole},
    {"learn", &bis_sir, BIS_SAMPLER_SOBOL, .learns = true, .crop = whole},
    {"edges", &bis_em, BIS_SAMPLER_SOBOL, .edges = true, .crop = middle},
    {"layers", &bis_sir, BIS_SAMPLER_SOBOL, .layers = BIS_LAYERS_ALL, .crop = whole},
    {"rejection", &bis_rejection, BIS_SAMPLER_SOBOL, .crop = whole},
};

static const bis_part_about about_all = {.scene = "a/scene.txt", .command = "bis a/scene.txt --spp 9",
                                          .approximated = "1 x glass: opaque", .seed = 1,
                                         .edge_samples = 3, .edge_light = 0.25, .seconds = {1, 2, 4, 8, 0, 0, 0},
                                         .figures = {.triangles = 7, .accelerator = "grid", .mesh = 100, .accel = 200,
                                                     .envmap = (double)NAN}};

static void part_path(char path[128], int k, int n) { snprintf(path, 128, DIR_NAME "/part-%d-%d", k, n); }

static bis_render_options budget(uint32_t spp, int n_threads)
{
    return (bis_render_options){.budget = {.spp = spp}, .n_threads = n_threads};
}

/* Renders part k of n and writes it; returns its camera rays. */
static uint64_t write_part(const world *w, const kind *k, int part, int n, uint32_t spp)
{
    char path[128];
    bis_checkpoint c = {.every = 1e9};
    bis_film f;
    bis_render_result result;
    bis_render_options options = budget(spp, part % 3 + 1);
    bis_diag diag = {0};

    options.part = (bis_part){(uint32_t)part, (uint32_t)n};
    part_path(path, part, n);
    if (try_render(&f, &result, w, k, options, &c, &diag)) fail_msg("%s: %s", k->name, diag.messages[0].text);
    assert_true(isnan(result.error.relative_rmse));
    assert_int_equal(bis_part_write(path, &c.head, &about_all, &f, &result, NULL), BIS_OK);
    bis_film_clear(&f);
    return result.counters.camera_rays;
}

/* ---- the same bits ---- */

static void swap(const char **a, const char **b)
{
    const char *c = *a;
    *a = *b;
    *b = c;
}

/* Heap's algorithm: the next of the 5! orders; c[5] begins as zeros. False: that was the last. */
static bool permute(const char *paths[5], int c[5])
{
    for (int i = 1; i < 5; c[i++] = 0) {
        if (c[i] >= i) continue;
        swap(&paths[i % 2 ? c[i] : 0], &paths[i]);
        c[i]++;
        return true;
    }
    return false;
}

static void five_parts_in_each_order_have_the_bits_of_one_render(void **state)
{
    for (size_t i = 0; i < COUNT(kinds); i++) {
        char names[5][128];
        const char *paths[5];
        int c[5] = {0}, orders = 0;
        uint64_t rays = 0;
        world w;
        bis_film expected;
        bis_render_result result;
        make_kind(&w, &kinds[i]);
        assert_int_equal(try_render(&expected, &result, &w, &kinds[i], budget(9, 2), NULL, NULL), BIS_OK);
        for (int k = 0; k < 5; k++) {
            rays += write_part(&w, &kinds[i], k + 1, 5, 9);
            part_path(names[k], k + 1, 5);
            paths[k] = names[k];
        }
        assert_int_equal(rays, result.counters.camera_rays);
        do {
            bis_merged *m = bis_alloc(1, sizeof *m);
            bis_diag diag = {0};
            if (bis_part_merge(m, paths, 5, &diag)) fail_msg("%s: %s", kinds[i].name, diag.messages[0].text);
            assert_same_film(&expected, &m->film);
            assert_same_result(&result, &m->result);
            bis_film_clear(&m->film);
            bis_free(m);
            orders++;
        } while (permute(paths, c) && i < 2);
        assert_int_equal(orders, i < 2 ? 120 : 1);
        bis_film_clear(&expected);
        clear_world(&w);
    }
}

/* Broken off after 6 camera samples, and gone on; the checkpoint is as large as the part. */
static void a_part_may_be_rendered_in_several_runs(void **state)
{
    world w;
    bis_film f;
    bis_render_result result;
    struct stat st;
    off_t sum = 0;

    make_kind(&w, &kinds[0]);
    for (uint32_t k = 0; k <= 3; k++) {
        bis_render_options options = budget(6, 1);
        bis_checkpoint c = {.path = STATE, .every = 1e9};
        options.part = (bis_part){k, k ? 3 : 0};
        unlink(STATE);
        assert_int_equal(try_render(&f, &result, &w, &kinds[0], options, &c, NULL), BIS_OK);
        bis_film_clear(&f);
        assert_int_equal(stat(STATE, &st), 0);
        sum += k ? st.st_size : -st.st_size;
    }
    /* three heads instead of one, and for each byte of sums one place */
    assert_in_range(sum, 1, 2000);

    assert_int_equal(write_part(&w, &kinds[0], 3, 3, 9) > 0, 1);
    bis_checkpoint c = {0};
    assert_int_equal(bis_checkpoint_read(&c, STATE, NULL), BIS_OK);
    bis_render_options options = budget(9, 2);
    options.part = (bis_part){3, 3};
    assert_int_equal(try_render(&f, &result, &w, &kinds[0], options, &c, NULL), BIS_OK);
    result.seconds = 0;
    assert_int_equal(bis_part_write(DIR_NAME "/resumed", &c.head, &about_all, &f, &result, NULL), BIS_OK);
    bis_film_clear(&f);

    /* the same file but for the seconds of rendering: eight bytes, the threads, the checksum */
    assert_in_range(differing_bytes(DIR_NAME "/part-3-3", DIR_NAME "/resumed"), 1, 8 + 4 + 8 + 8);

    static const bis_part others[] = {{2, 3}, {3, 4}, {0, 0}};
    for (size_t i = 0; i < COUNT(others); i++) {
        bis_diag diag = {0};
        c = (bis_checkpoint){0};
        assert_int_equal(bis_checkpoint_read(&c, STATE, NULL), BIS_OK);
        options.part = others[i];
        assert_int_equal(try_render(&f, &result, &w, &kinds[0], options, &c, &diag), BIS_INPUT);
        assert_non_null(strstr(diag.messages[0].text, "is one of part 3 of 3, not of "));
        bis_diag_clear(&diag);
        bis_film_clear(&f);
    }
    clear_world(&w);
}

/* ---- shares ---- */

static bis_film film_of_tiles(int across, int down)
{
    return bis_film_place(16 * across, 16 * down, whole, 1);
}

static void each_tile_is_in_one_share_and_shares_are_alike(void **state)
{
    static const int sizes[][2] = {{1, 1}, {1, 17}, {40, 1}, {3, 2}, {8, 8}, {13, 7}, {40, 30}, {120, 68}};

    for (size_t i = 0; i < COUNT(sizes); i++) {
        const bis_film f = film_of_tiles(sizes[i][0], sizes[i][1]);
        const int n_tiles = sizes[i][0] * sizes[i][1];
        for (uint32_t n = 1; n <= (uint32_t)n_tiles && n < 70; n += n / 3 + 1) {
            int *seen = bis_alloc((size_t)n_tiles, sizeof *seen);
            for (uint32_t k = 1; k <= n; k++) {
                int *tiles, n_own;
                assert_int_equal(bis_share_tiles(&tiles, &n_own, &f, (bis_part){k, n}, NULL), BIS_OK);
                assert_in_range(n_own, n_tiles / (int)n, (n_tiles + (int)n - 1) / (int)n);
                for (int t = 0; t < n_own; t++) {
                    assert_true(t == 0 || tiles[t] > tiles[t - 1]);
                    seen[tiles[t]]++;
                }
                bis_free(tiles);
            }
            for (int t = 0; t < n_tiles; t++) assert_int_equal(seen[t], 1);
            bis_free(seen);
        }
    }
}

/* ---- the file ---- */

/* Merges, and returns whether the words stand in a message; NULL: nothing fails. */
static bis_status merge_paths(bis_merged *m, const char *const *paths, int n, const char *words)
{
    bis_diag diag = {0};
    const bis_status status = bis_part_merge(m, paths, n, &diag);
    bool found = !words;

    for (size_t i = 0; i < diag.n; i++) found |= words && strstr(diag.messages[i].text, words);
    if (!found) fail_msg("no \"%s\" in: %s", words, diag.n ? diag.messages[0].text : "nothing");
    assert_int_equal(status == BIS_OK, diag.n_errors == 0);
    assert_int_equal(status == BIS_OK, m->film.sum != NULL);
    bis_diag_clear(&diag);
    return status;
}

#define FIRST DIR_NAME "/part-1-2"
#define OTHER DIR_NAME "/part-2-2"
#define BAD DIR_NAME "/bad"

/* 20 x 16 pixels in two tiles. */
static const double two_tiles[4] = {12 / 37.0, 32 / 37.0, 0, 15 / 21.0};
static const kind small = {"small", &bis_sir, BIS_SAMPLER_SOBOL, .layers = 1u << BIS_LAYER_DEPTH, .crop = two_tiles};

static void write_two(world *w)
{
    make_kind(w, &small);
    write_part(w, &small, 1, 2, 2);
    write_part(w, &small, 2, 2, 2);
}

static void every_truncation_and_every_changed_byte_of_a_part_is_refused(void **state)
{
    static const char *const paths[] = {OTHER, BAD};
    bis_merged *m = bis_alloc(1, sizeof *m);
    world w;
    size_t size, step;

    write_two(&w);
    unsigned char *data = read_bytes(FIRST, &size);
    for (size_t n = 0; n < size; n += step) {
        step = n < 900 ? 1 : 53; /* all of the head */
        store(BAD, data, n);
        assert_int_equal(merge_paths(m, paths, 2, BAD ": error: this "), BIS_INPUT);
        data[n] ^= 0x10;
        store(BAD, data, size);
        data[n] ^= 0x10;
        assert_int_equal(merge_paths(m, paths, 2, BAD ": error: this "), BIS_INPUT);
    }
    bis_free(data);
    bis_free(m);
    clear_world(&w);
}

/* A part that is the whole picture, in which eight bytes at a time are another number, with a checksum that fits. It is
 * refused, or makes a picture of finite numbers; nothing breaks. */
static void a_forged_part_breaks_nothing(void **state)
{
    static const double numbers[] = {0, -1, 1e300, (double)INFINITY, (double)NAN};
    static const char *const path[] = {BAD};
    char name[128];
    world w;
    size_t size, refused = 0;

    make_kind(&w, &small);
    write_part(&w, &small, 1, 1, 2);
    part_path(name, 1, 1);
    unsigned char *data = read_bytes(name, &size), kept[8];
    for (size_t at = 8; at + 16 <= size; at += at < 1000 ? 4 : 500)
        for (size_t i = 0; i < COUNT(numbers); i++) {
            bis_merged *m = bis_alloc(1, sizeof *m);
            bis_diag diag = {0};
            memcpy(kept, data + at, 8);
            memcpy(data + at, &numbers[i], 8);
            seal(data, size);
            store(BAD, data, size);
            memcpy(data + at, kept, 8);
            const bis_status status = bis_part_merge(m, path, 1, &diag);
            assert_true(status == BIS_OK || (status == BIS_INPUT && diag.n > 0));
            refused += status != BIS_OK;
            for (int k = 0; !status && k < 3 * m->film.width * m->film.height; k++)
                assert_true(isfinite(m->film.sum[k]) && isfinite(m->film.deviation[k]));
            bis_film_clear(&m->film);
            bis_diag_clear(&diag);
            bis_free(m);
        }
    assert_true(refused > 100);
    bis_free(data);
    clear_world(&w);
}

/* make fuzz begins with these: a part of two, and one that is the whole picture. */
static void parts_are_read_and_begin_the_fuzzing(void **state)
{
    static const char seed[] = DIR_NAME "/seed.part", *const paths[] = {FIRST, DIR_NAME "/part-1-1"};
    bis_merged *m = bis_alloc(1, sizeof *m);
    world w;

    write_two(&w);
    write_part(&w, &small, 1, 1, 2);
    for (int i = 0; i < 2; i++) {
        size_t n;
        unsigned char *data = read_bytes(paths[i], &n);
        store(seed, data, n);
        keep_as_seed(seed);
        bis_free(data);
        assert_int_equal(merge_paths(m, &paths[i], 1, i ? NULL : "part 2 of 2 is missing"), i ? BIS_OK : BIS_INPUT);
        bis_film_clear(&m->film);
    }
    bis_free(m);
    clear_world(&w);
}

/* ---- what does not belong together ---- */

static void figures_of_parts_are_added_up(void **state)
{
    static const char *const paths[] = {FIRST, OTHER, FIRST};
    bis_merged *m = bis_alloc(1, sizeof *m);
    world w;

    write_two(&w);
    assert_int_equal(merge_paths(m, paths, 3, NULL), BIS_OK); /* the third counts for nothing */
    assert_string_equal(m->about.scene, about_all.scene);
    assert_string_equal(m->about.command, about_all.command);
    assert_string_equal(m->about.approximated, about_all.approximated);
    assert_int_equal(m->about.edge_samples, about_all.edge_samples);
    assert_true(m->about.edge_light == about_all.edge_light);
    assert_int_equal(m->about.seed, 1);
    assert_true(m->about.seconds.parse == 2 && m->about.seconds.load == 4 && m->about.seconds.envmap == 8 &&
                m->about.seconds.accel == 16);
    assert_int_equal(m->result.n_threads, bis_render_threads(&(bis_render_options){.n_threads = 3})); /* of 2 and 3 */
    assert_string_equal(m->about.figures.accelerator, "grid");
    assert_int_equal(m->about.figures.triangles, 7);
    assert_true(m->about.figures.mesh == 100 && isnan(m->about.figures.envmap));
    assert_false(m->result.interrupted);
    bis_film_clear(&m->film);
    bis_free(m);
    clear_world(&w);
}

static void what_is_missing_or_foreign_is_named(void **state)
{
    bis_merged *m = bis_alloc(1, sizeof *m);
    world w;
    size_t size;

    write_two(&w);
    unsigned char *data = read_bytes(FIRST, &size);
    store(BAD, data, size);
    bis_free(data);
    assert_int_equal(merge_paths(m, (const char *[]){OTHER, OTHER}, 2,
                                 "part 1 of 2 is missing; this makes it: bis a/scene.txt --spp 9 --part 1/2 --outfile "
                                 "part-1.bispart"), BIS_INPUT);
    assert_int_equal(merge_paths(m, (const char *[]){FIRST, DIR_NAME "/none"}, 2, "/none"), BIS_IO);
    write_part(&w, &small, 2, 2, 3);
    assert_int_equal(merge_paths(m, (const char *[]){BAD, OTHER}, 2,
                                 OTHER ": error: this part has 3 camera samples a pixel, but \"" BAD "\" has 2"),
                     BIS_INPUT);
    w.desc.view.sampler.seed++;
    w.materials[1].exponent++;
    write_part(&w, &small, 2, 2, 2);
    assert_int_equal(merge_paths(m, (const char *[]){BAD, OTHER}, 2,
                                 "These differ: the sampler, or its seed; the materials, or their textures. "),
                                 BIS_INPUT);
    bis_film f;
    bis_render_result result;
    bis_diag diag = {0};
    bis_render_options options = budget(1, 1);
    options.part = (bis_part){3, 3}; /* of two tiles */
    assert_int_equal(try_render(&f, &result, &w, &small, options, NULL, &diag), BIS_INPUT);
    assert_non_null(strstr(diag.messages[0].text, "has 2 tiles of 16 x 16: 2 parts at most, not 3"));
    bis_diag_clear(&diag);
    bis_film_clear(&f);
    clear_world(&w);

    make_kind(&w, &kinds[2]); /* six parts, of which one is there */
    for (int k = 1; k <= 6; k++) write_part(&w, &kinds[2], k, 6, 1);
    assert_int_equal(merge_paths(m, (const char *[]){FIRST, DIR_NAME "/part-3-6"}, 2,
                                 "/part-3-6: error: this part and \"" FIRST "\" belong to different pictures. These "
                                 "differ: the size of the picture, or its crop; the layers. "), BIS_INPUT);
    for (int k = 1; k <= 6; k++) {
        char words[64];
        snprintf(words, sizeof words, "part %d of 6 is missing; ", k);
        if (k != 3) assert_int_equal(merge_paths(m, (const char *[]){DIR_NAME "/part-3-6"}, 1, words), BIS_INPUT);
    }
    write_part(&w, &kinds[2], 1, 5, 1);
    assert_int_equal(merge_paths(m, (const char *[]){DIR_NAME "/part-3-6", DIR_NAME "/part-1-5"}, 2,
                                 "this is a part of 5, but \"" DIR_NAME "/part-3-6\" is one of 6"), BIS_INPUT);
    bis_free(m);
    clear_world(&w);
}

/* Parts that were made on unlike machines: the largest of what each has needed, whichever part comes first; what one
 * does not know is that of the other. Seconds are added up. */
static void of_unlike_parts_the_larger_figures_stand(void **state)
{
    static const char *const paths[] = {FIRST, OTHER}, *const turned[] = {OTHER, FIRST};
    bis_merged *m = bis_alloc(1, sizeof *m);
    bis_part_about about[2] = {about_all, about_all};
    world w;

    about[0].figures.mesh = 100, about[0].figures.accel = 300, about[0].seconds.accel = 8;
    about[1].figures.mesh = 150, about[1].figures.accel = 250, about[1].seconds.accel = 0.5;
    make_kind(&w, &small);
    for (int unknown = 0; unknown < 2; unknown++) {
        if (unknown) about[0].figures.accel = about[1].figures.mesh = (double)NAN;
        for (int k = 0; k < 2; k++) {
            bis_checkpoint c = {.every = 1e9};
            bis_film f;
            bis_render_result result;
            bis_render_options options = budget(2, 1);
            options.part = (bis_part){(uint32_t)k + 1, 2};
            assert_int_equal(try_render(&f, &result, &w, &small, options, &c, NULL), BIS_OK);
            result.bytes = k ? 4000 : 5000;
            result.seconds = k ? 0.25 : 4;
            assert_int_equal(bis_part_write(paths[k], &c.head, &about[k], &f, &result, NULL), BIS_OK);
            bis_film_clear(&f);
        }
        for (int order = 0; order < 2; order++) {
            assert_int_equal(merge_paths(m, order ? turned : paths, 2, NULL), BIS_OK);
            assert_true(
                m->about.figures.mesh == (unknown ? 100 : 150) && m->about.figures.accel == (unknown ? 250 : 300));
            assert_true(m->about.seconds.accel == 8.5 && m->result.seconds == 4.25);
            assert_int_equal(m->result.bytes, 5000);
            bis_film_clear(&m->film);
        }
    }
    bis_free(m);
    clear_world(&w);
}

/* All messages of merging, a line each. */
static const char *told(char text[4096], const char *const *paths, int n)
{
    bis_merged *m = bis_alloc(1, sizeof *m);
    bis_diag diag = {0};
    size_t at = 0;

    text[0] = '\0';
    if (bis_part_merge(m, paths, n, &diag) == BIS_OK) bis_film_clear(&m->film);
    for (size_t i = 0; i < diag.n; i++) at += (size_t)snprintf(text + at, 4096 - at, "%s\n", diag.messages[i].text);
    bis_diag_clear(&diag);
    bis_free(m);
    return text;
}

/* A file of the other kind is told from one that is cut short as soon as it is as long as the shortest. */
static void the_shortest_file_of_the_other_kind_is_known(void **state)
{
    enum { SHORTEST = 8 + 4 + 16 + 8 }; /* magic, format, a name, the checksum */
    static const char *const path[] = {BAD},
                      *const of_part[] = {BAD ": error: this is no part of bis, or it is cut short; `bis SCENE "
                                          "--part K/N --outfile F` makes parts\n",
                                          BAD ": error: this is a checkpoint, not a part of a picture: --resume goes "
                                          "on from it\n"},
                      *const of_checkpoint[] = {BAD ": error: this is no checkpoint of bis, or it is cut short; "
                                                "without --resume, or with another file, the render starts afresh",
                                                BAD ": error: this is no checkpoint of bis but a part of a picture: "
                                                "`bis merge` puts parts together"};
    unsigned char checkpoint[SHORTEST] = "\x89" "bisck\r\n", part[SHORTEST] = "\x89" "bispt\r\n";
    char text[4096];

    for (size_t more = 0; more < 2; more++) {
        bis_checkpoint c = {0};
        bis_diag diag = {0};
        store(BAD, checkpoint, SHORTEST - 1 + more);
        assert_string_equal(told(text, path, 1), of_part[more]);
        store(BAD, part, SHORTEST - 1 + more);
        assert_int_equal(bis_checkpoint_read(&c, BAD, &diag), BIS_INPUT);
        assert_string_equal(diag.messages[0].text, of_checkpoint[more]);
        bis_diag_clear(&diag);
    }
    unlink(BAD);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(five_parts_in_each_order_have_the_bits_of_one_render),
        cmocka_unit_test(a_part_may_be_rendered_in_several_runs),
        cmocka_unit_test(each_tile_is_in_one_share_and_shares_are_alike),
        cmocka_unit_test(every_truncation_and_every_changed_byte_of_a_part_is_refused),
        cmocka_unit_test(a_forged_part_breaks_nothing),
        cmocka_unit_test(parts_are_read_and_begin_the_fuzzing),
        cmocka_unit_test(figures_of_parts_are_added_up),
        cmocka_unit_test(what_is_missing_or_foreign_is_named),
        cmocka_unit_test(of_unlike_parts_the_larger_figures_stand),
        cmocka_unit_test(the_shortest_file_of_the_other_kind_is_known),
    };
    return cmocka_run_group_tests(tests, setup, NULL);
}
