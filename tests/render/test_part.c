/* SPDX-License-Identifier: BSD-2-Clause */
/* part: the parts of a picture, in any order, have the bits of one render; what does not belong together is refused by
 * name. Expected pictures are those of renders without parts. The twins are files in which one field is another, with a
 * checksum that fits: each is refused, or what comes out is another. */
#include "bis/base/mem.h"
#include "bis/base/version.h"
#include "render/part.h"
#include "render/share.h"

#include "claim.h"
#include "file_help.h"
#include "image_help.h"
#include "lack.h"
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

/* Of all rectangles of the picture with `area` tiles: the largest share that one of n parts has of one, over the fair
 * one. */
static double worst_share(const int *part_of, int across, int down, int n, int width, int height)
{
    double worst = 0;

    for (int y = 0; y + height <= down; y++) {
        for (int x = 0; x + width <= across; x++) {
            int count[64] = {0};
            for (int i = 0; i < width * height; i++) count[part_of[(y + i / width) * across + x + i % width]]++;
            for (int k = 0; k < n; k++) worst = fmax(worst, count[k] * (double)n / (width * height));
        }
    }
    return worst;
}

/* A costly region of 12 x 12 tiles, or of half as many in a bar that stands or lies, costs none of 2 to 8 parts more
 * than twice what is fair. The twin: shares by reading order, which are columns where n divides the row. */
static void a_costly_region_is_dealt_out_to_all_parts(void **state)
{
    enum { ACROSS = 40, DOWN = 30 };
    static const int bars[][2] = {{12, 12}, {3, 24}, {24, 3}};
    const bis_film f = film_of_tiles(ACROSS, DOWN);
    double worst_column = 0;

    for (int n = 2; n <= 8; n++) {
        int part_of[ACROSS * DOWN], columns[ACROSS * DOWN];
        for (int k = 0; k < n; k++) {
            int *tiles, n_own;
            assert_int_equal(
                bis_share_tiles(&tiles, &n_own, &f, (bis_part){(uint32_t)k + 1, (uint32_t)n}, NULL), BIS_OK);
            for (int i = 0; i < n_own; i++) part_of[tiles[i]] = k;
            bis_free(tiles);
        }
        for (int t = 0; t < ACROSS * DOWN; t++) columns[t] = t % n;
        for (size_t i = 0; i < COUNT(bars); i++) {
            assert_true(worst_share(part_of, ACROSS, DOWN, n, bars[i][0], bars[i][1]) <= 2);
            worst_column = fmax(worst_column, worst_share(columns, ACROSS, DOWN, n, bars[i][0], bars[i][1]));
        }
    }
    assert_true(worst_column > 2);
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

/* What a field is for: a changed one is refused by these words, or comes out as another figure. */
typedef struct field {
    const char *name;
    size_t bytes; /* 0: of all parameters */
    size_t at;    /* the byte of the field that is changed */
    int mask;
    const char *words; /* NULL: it is accepted */
} field;

enum { WRITTEN = 4 * 15, TWINS = 6 }; /* pixels, and those of them that are rendered twice */
static const field format_fields[] = {
    {"magic", 8, 3, 1, "no part of bis"},
    {"format", 4, 0, 1, "the same version"},
    {"version", 16, 0, 1, "the same version"},
    {"integrator", 16, 0, 1, "an integrator that this program does not have"},
    {"parameters", 0, 7, 0x80, "damaged"}, /* negative; 8 bytes for each there is */
    {"as printed", 4, 0, 1, NULL},
    {"K", 4, 0, 2, "damaged"}, /* 1 to 3 */
    {"N", 4, 0, 1, "damaged"}, /* of two tiles, 3 */
    {"size, or crop", 8, 0, 1, "differ: the size of the picture, or its crop. "},
    {"layers", 8, 0, 1, "differ: the layers. "},
    {"camera", 8, 0, 1, "differ: the camera. "},
    {"sampler", 8, 0, 1, "differ: the sampler, or its seed. "},
    {"division", 8, 0, 1, "differ: the camera samples for which samplers"},
    {"jitter", 8, 0, 1, "differ: pixel jitter, or camera samples on edges. "},
    {"settings", 8, 0, 1, "differ: the integrator, or its parameters. "},
    {"shapes", 8, 0, 1, "differ: the shapes. "},
    {"materials", 8, 0, 1, "differ: the materials, or their textures. "},
    {"map", 8, 0, 1, "differ: the pixels of the map. "},
    {"light", 8, 0, 1, "differ: the parameters of the light. "},
    {"accelerator", 8, 7, 0x80, "differ: the accelerator. "},
    {"length of the scene's name", 4, 3, 1, "damaged"},
    {"scene", sizeof "a/scene.txt" - 1, 0, 0x60, "damaged"}, /* 'a' to a control character */
    {"length of the command", 4, 3, 1, "damaged"},
    {"command", sizeof "bis a/scene.txt --spp 9" - 1, 0, 1, NULL},
    {"length of what was replaced", 4, 3, 1, "damaged"},
    {"what was replaced", sizeof "1 x glass: opaque" - 1, 0, 1, NULL},
    {"seed", 8, 0, 1, NULL},
    {"edge samples", 4, 0, 1, NULL},
    {"edge light", 8, 7, 0x80, "damaged"},
    {"threads", 4, 0, 8, NULL},
    {"bytes", 8, 3, 1, NULL},
    {"parse", 8, 7, 0x80, "damaged"},
    {"load", 8, 7, 0x80, "damaged"},
    {"envmap", 8, 7, 0x80, "damaged"},
    {"accel", 8, 7, 0x80, "damaged"},
    {"triangles", 8, 0, 1, NULL},
    {"name of the accelerator", 16, 15, 1, "damaged"},
    {"bytes of the mesh", 8, 6, 0x20, NULL},
    {"bytes of the accelerator", 8, 6, 0x10, NULL},
    {"bytes of the map", 8, 5, 1, NULL},
    {"full width", 4, 0, 1, "damaged"},
    {"first column", 4, 0, 1, "damaged"},
    {"columns", 4, 1, 1, "damaged"},
    {"full height", 4, 2, 1, "damaged"},
    {"first row", 4, 1, 1, "damaged"},
    {"rows", 4, 0, 1, "damaged"},
    {"layers asked", 4, 1, 1, "damaged"},
    {"transparent", 4, 0, 2, "damaged"}, /* 0 or 1 */
    {"camera samples", 8, 0, 1, "give all parts the same --spp"},
    {"seconds", 8, 7, 0x80, "damaged"},
    {"next look at the error", 4, 0, 1, NULL},
    {"bound of the error", 8, 0, 1, NULL},
    {"camera rays", 8, 0, 1, NULL},
    {"shadow rays", 8, 0, 1, NULL},
    {"candidates", 8, 0, 1, NULL},
    {"accepted", 8, 0, 1, NULL},
    {"fallbacks", 8, 0, 1, NULL},
    {"not finite", 8, 0, 1, NULL},
    {"passes", 4, 0, 1, "damaged"},
    {"weight", 8, 5, 1, "damaged"},
    {"weight of the half", 8, 5, 1, "damaged"},
    {"independent", 4, 0, 2, "damaged"}, /* 0 or 1 */
    {"sum", WRITTEN * 24, 6, 1, NULL},
    {"deviation", WRITTEN * 12, 2, 1, NULL},
    {"half", WRITTEN * 12, 2, 1, NULL},
    {"hits", WRITTEN * 4, WRITTEN * 4 - 2, 1, NULL},
    {"depth", WRITTEN * 8, WRITTEN * 8 - 2, 1, NULL},
    {"twins", TWINS * 48, 6, 1, NULL},
    {"checksum", 8, 0, 1, "its checksum is wrong"},
};

/* Every field of the file once, in its order, written down from the description of the format. */
static void every_field_of_the_format_counts(void **state)
{
    size_t n_parameters = 0;
    for (const bis_parameter *p = bis_parameters; p->name; p++) n_parameters++;
    static const char *const paths[] = {BAD, OTHER}, *const turned[] = {OTHER, BAD};
    bis_merged *m = bis_alloc(1, sizeof *m), *right = bis_alloc(1, sizeof *right);
    world w;
    size_t size, at = 0;

    write_two(&w);
    unsigned char *data = read_bytes(FIRST, &size);
    store(BAD, data, size);
    assert_int_equal(merge_paths(right, paths, 2, NULL), BIS_OK);
    const size_t n = (size_t)right->film.width * (size_t)right->film.height;
    for (size_t i = 0; i < COUNT(format_fields); i++) {
        const field *f = &format_fields[i];
        data[at + f->at] ^= (unsigned char)f->mask;
        if (i + 1 < COUNT(format_fields)) seal(data, size);
        store(BAD, data, size);
        data[at + f->at] ^= (unsigned char)f->mask;
        if (i + 1 < COUNT(format_fields)) seal(data, size);
        at += f->bytes ? f->bytes : 8 * n_parameters;
        const bis_status status = merge_paths(m, turned, 2, f->words);
        if (status != (f->words ? BIS_INPUT : BIS_OK)) fail_msg("%s: status %d", f->name, (int)status);
        if (f->words) continue;
        bis_film_clear(&m->film);
        assert_int_equal(merge_paths(m, paths, 2, NULL), BIS_OK);
        /* what the next pass would need is no part of the picture */
        const bool is_idle = strcmp(f->name, "next look at the error") == 0 ||
                             strcmp(f->name, "bound of the error") == 0;
        const bool same = memcmp(&m->head.parts, &right->head.parts, sizeof m->head.parts) == 0 &&
                          m->head.settings.as_printed == right->head.settings.as_printed &&
                          strcmp(m->about.command, right->about.command) == 0 &&
                          strcmp(m->about.approximated, right->about.approximated) == 0 &&
                          m->about.seed == right->about.seed && m->about.edge_samples == right->about.edge_samples &&
                          fabs(m->about.edge_light - right->about.edge_light) < 1e-12 &&
                          memcmp(&m->about.figures, &right->about.figures, sizeof m->about.figures) == 0 &&
                          memcmp(&m->result.counters, &right->result.counters, sizeof m->result.counters) == 0 &&
                          m->result.n_threads == right->result.n_threads && m->result.bytes == right->result.bytes &&
                          memcmp(m->film.sum, right->film.sum, 24 * n) == 0 &&
                          memcmp(m->film.deviation, right->film.deviation, 12 * n) == 0 &&
                          memcmp(m->film.half, right->film.half, 12 * n) == 0 &&
                          memcmp(m->film.twin, right->film.twin, 48 * bis_film_twins(&m->film)) == 0 &&
                          memcmp(m->film.hits, right->film.hits, 4 * n) == 0 &&
                          memcmp(m->film.layers.sum, right->film.layers.sum, 8 * n) == 0;
        if (same != is_idle) fail_msg("%s: %s", f->name, same ? "nothing changes" : "something changes");
        bis_film_clear(&m->film);
    }
    assert_int_equal(at, size);
    bis_film_clear(&right->film);
    bis_free(right);
    bis_free(m);
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

/* Seven tiles in a row of 112 x 1 pixels would be enough for 7 parts; a file may claim 100000 of a picture of 32768 x
 * 32768 pixels: there is no memory taken for it, because the others are missing. */
static void without_memory_there_is_a_message(void **state)
{
    static const char *const paths[] = {FIRST, OTHER};
    bis_merged *m = bis_alloc(1, sizeof *m);
    world w;
    long n = 0;

    write_two(&w);
    FOR_LACK(l) {
        LACK(l, bis_part_merge(m, paths, 2, NULL));
        assert_int_equal(l.status == BIS_OK, l.over);
        if (l.over) bis_film_clear(&m->film);
        n++;
    }
    assert_true(n > 9);
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

static void put_bytes(unsigned char *to, uint64_t v, size_t n)
{
    for (size_t i = 0; i < n; i++) to[i] = (unsigned char)(v >> 8 * i);
}

static uint64_t bits_of(double v)
{
    uint64_t bits;
    memcpy(&bits, &v, sizeof bits);
    return bits;
}

/* One part that is the whole picture, so that nothing else contradicts it: 20 x 15 pixels at (12, 0) of 37 x 21. The
 * last number that is right and has as many twins, and the first that is not right. Places are told from where the
 * sizes stand: before them seconds, figures and settings, behind them what was done and, 100 bytes later, the sums. */
static void numbers_that_make_no_sense_are_refused(void **state)
{
    enum { PIXELS = 20 * 15, DONE = 32, SUMS = DONE + 100, DEVIATIONS = SUMS + 24 * PIXELS,
           HALF = DEVIATIONS + 12 * PIXELS, HITS = HALF + 12 * PIXELS, DEPTHS = HITS + 4 * PIXELS,
           /* of 7 x 5 squares of 3 x 3 pixels */
           TWINS_BEGIN = DEPTHS + 8 * PIXELS, END = TWINS_BEGIN + 48 * 35 };
    const double inf = (double)INFINITY, nan = (double)NAN;
    static const char bad[] = BAD ": error: this part is damaged\n",
                      sum[] = "error: a part is damaged: a sum in it is not finite\n";
    const struct {
        long at;
        uint64_t value;
        size_t bytes;
        const char *text;
    } cases[] = {
        {0, 32, 4, ""}, {0, 31, 4, bad}, {0, 1142, 4, ""}, {0, BIS_IMAGE_MAX_SIDE + 1, 4, bad},
        {4, 18, 4, bad}, {4, 37, 4, bad}, {8, 21, 4, bad}, {8, 0, 4, bad},
        {12, 15, 4, ""}, {12, 14, 4, bad}, {12, BIS_IMAGE_MAX_SIDE + 1, 4, bad}, {16, 6, 4, ""}, {16, 7, 4, bad},
        {20, 14, 4, bad}, {20, 16, 4, bad},
        {DONE, 0, 8, bad}, {DONE, UINT32_MAX, 8, ""}, {DONE, (uint64_t)UINT32_MAX + 1, 8, bad},
        {DONE + 8, bits_of(0), 8, ""}, {DONE + 8, bits_of(-1e-300), 8, bad}, {DONE + 8, bits_of(inf), 8, bad},
        {DONE + 8, bits_of(nan), 8, bad}, {DONE + 76, 0, 4, bad}, {DONE + 76, 1, 4, ""},
        {DONE + 80, bits_of(0), 8, bad}, {DONE + 80, bits_of(inf), 8, bad}, {DONE + 80, bits_of(nan), 8, bad},
        {DONE + 88, bits_of(-1), 8, bad}, {DONE + 88, bits_of(inf), 8, bad}, {DONE + 88, bits_of(nan), 8, bad},
        {-80, bits_of(0), 8, ""}, {-80, bits_of(inf), 8, bad}, {-72, bits_of(nan), 8, bad}, {-64, bits_of(inf), 8, bad},
        {-56, bits_of(-1), 8, bad}, {-92, INT32_MAX, 4, ""}, {-92, (uint64_t)INT32_MAX + 1, 4, bad},
        {-100, bits_of(0), 8, ""}, {-100, bits_of(1), 8, ""}, {-100, bits_of(1 + 0x1p-52), 8, bad},
        {-100, bits_of(nan), 8, bad},
        {SUMS, bits_of(nan), 8, sum}, {DEVIATIONS - 8, bits_of(inf), 8, sum}, {DEVIATIONS, 0x7f800000, 4, sum},
        {HALF - 4, 0x7fc00000, 4, sum}, {HALF, 0x7f800000, 4, sum},
        {HITS - 4, 0x7fc00000, 4, sum}, {HITS, 0x7f800000, 4, sum}, {DEPTHS - 4, 0x7fc00000, 4, sum},
        {DEPTHS, bits_of(nan), 8, sum}, {TWINS_BEGIN - 8, bits_of(inf), 8, sum}, {TWINS_BEGIN, bits_of(nan), 8, sum},
        {END - 8, bits_of(inf), 8, sum},
    };
    static const char *const path[] = {BAD};
    world w;
    size_t size;
    char text[4096], whole_name[128];

    make_kind(&w, &small);
    write_part(&w, &small, 1, 1, 2);
    part_path(whole_name, 1, 1);
    unsigned char *data = read_bytes(whole_name, &size), *copy = bis_alloc(size, 1);
    const long sizes = (long)size - 8 - END;
    assert_int_equal(data[sizes], 37);
    assert_int_equal(data[sizes + 4], 12);
    for (size_t i = 0; i < COUNT(cases); i++) {
        memcpy(copy, data, size);
        put_bytes(copy + sizes + cases[i].at, cases[i].value, cases[i].bytes);
        seal(copy, size);
        store(BAD, copy, size);
        if (strcmp(told(text, path, 1), cases[i].text) != 0)
            fail_msg("%ld: %llu: %s", cases[i].at, (unsigned long long)cases[i].value, text);
    }
    bis_free(copy);
    bis_free(data);
    clear_world(&w);
}

#define DAMAGED BAD ": error: this part is damaged\n"

/* No negative number, none above its largest; they stand from `at` on. Returns where they end. */
static size_t assert_numbers_have_limits(unsigned char *copy, const unsigned char *data, size_t size, size_t at)
{
    static const char *const path[] = {BAD};
    char text[4096];

    for (const bis_parameter *p = bis_parameters; p->name; p++, at += 8) {
        const double most = p->type == BIS_PARAMETER_CHOICE ? BIS_MAX_CHOICES - 1 : UINT32_MAX;
        const double values[] = {0, most, most + 1, -1, (double)NAN};
        for (size_t i = 0; i < COUNT(values); i++) {
            memcpy(copy, data, size);
            put_bytes(copy + at, bits_of(values[i]), 8);
            seal(copy, size);
            store(BAD, copy, size);
            if (strcmp(told(text, path, 1), i < 2 ? "" : DAMAGED) != 0) fail_msg("%s %g: %s", p->name, values[i], text);
        }
    }
    return at;
}

/* The head of a file: magic, format, version; the settings; the part. What may stand there, and the whole message
 * where it may not. */
static void a_head_is_read_up_to_its_limits(void **state)
{
    enum { FORMAT = 8, SETTINGS = 8 + 4 + 16 + 16, SHORTEST = 8 + 4 + 16 + 8 };
    static const char cut[] = BAD ": error: this is no part of bis, or it is cut short; `bis SCENE --part K/N "
                              "--outfile F` makes parts\n",
                      version[] = BAD ": error: bis " BIS_VERSION " wrote this part in format 4, but this is bis "
                                  BIS_VERSION ", format 13, whose pictures may have other bits: go on with the same "
                                  "version\n";
    static const char *const path[] = {BAD};
    world w;
    size_t size, at = SETTINGS;
    char text[4096], whole_name[128];
    bis_checkpoint c = {0};
    bis_diag diag = {0};

    make_kind(&w, &small);
    write_part(&w, &small, 1, 1, 2);
    part_path(whole_name, 1, 1);
    unsigned char *data = read_bytes(whole_name, &size), *copy = bis_alloc(size, 1);

    memcpy(copy, data, size); /* which ends behind its version: as good as its checksum, but without settings */
    seal(copy, SHORTEST);
    store(BAD, copy, SHORTEST);
    assert_string_equal(told(text, path, 1), DAMAGED);
    store(BAD, copy, SHORTEST - 1);
    assert_string_equal(told(text, path, 1), cut);

    memcpy(copy, data, size);
    copy[FORMAT] = 4;
    seal(copy, size);
    store(BAD, copy, size);
    assert_string_equal(told(text, path, 1), version);
    copy[FORMAT] = 5;
    memcpy(copy, "\x89" "bisck\r\n", 8);
    store(BAD, copy, size);
    assert_string_equal(told(text, path, 1),
                        BAD ": error: this is a checkpoint, not a part of a picture: --resume goes on from it\n");
    assert_int_equal(bis_checkpoint_read(&c, whole_name, &diag), BIS_INPUT);
    assert_null(c.data);
    snprintf(text, sizeof text, "%s: error: this is no checkpoint of bis but a part of a picture: `bis merge` puts "
             "parts together", whole_name);
    assert_string_equal(diag.messages[0].text, text);
    bis_diag_clear(&diag);

    at = assert_numbers_have_limits(copy, data, size, at);
    /* behind as_printed: K and N, 1 of 1 */
    at += 4;
    assert_true(data[at] == 1 && data[at + 4] == 1);
    static const unsigned char parts[][2] = {{0, 1}, {2, 1}, {0, 0}, {1, 3}};
    for (size_t i = 0; i < COUNT(parts); i++) {
        memcpy(copy, data, size);
        copy[at] = parts[i][0], copy[at + 4] = parts[i][1];
        seal(copy, size);
        store(BAD, copy, size);
        assert_string_equal(told(text, path, 1), DAMAGED);
    }
    bis_free(copy);
    bis_free(data);
    clear_world(&w);
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

/* Part k of n of a picture of n tiles in a row, one pass of nothing. */
static void write_empty(const char *path, uint32_t k, uint32_t n)
{
    const bis_state_head head = {.settings = bis_settings_default(&bis_em), .part = {k, n}};
    const bis_render_result result = {.spp = 1, .passes = 1, .n_threads = 1};
    bis_film f;

    assert_int_equal(bis_film_init(&f, 16 * (int)n, 16, whole, (bis_loc){0}, NULL), BIS_OK);
    f.independent = true; /* so it has no twins */
    f.passes = 1;
    f.weight = 1;
    assert_int_equal(bis_part_write(path, &head, &about_all, &f, &result, NULL), BIS_OK);
    bis_film_clear(&f);
}

#define MISSING(k, n) "error: part " k " of " n " is missing; this makes it: bis a/scene.txt --spp 9 --part " k "/" n \
    " --outfile part-" k ".bispart\n"

/* Each message whole, and no other beside it. */
static void messages_stand_alone(void **state)
{
    char text[4096];
    world w;
    size_t size;

    /* ten missing parts are named, more are counted */
    write_empty(BAD, 2, 11);
    assert_string_equal(told(text, (const char *[]){BAD}, 1),
        MISSING("1", "11") MISSING("3", "11") MISSING("4", "11") MISSING("5", "11") MISSING("6", "11")
        MISSING("7", "11") MISSING("8", "11") MISSING("9", "11") MISSING("10", "11") MISSING("11", "11"));
    write_empty(BAD, 12, 13);
    assert_string_equal(told(text, (const char *[]){BAD}, 1),
        MISSING("1", "13") MISSING("2", "13") MISSING("3", "13") MISSING("4", "13") MISSING("5", "13")
        MISSING("6", "13") MISSING("7", "13") MISSING("8", "13") MISSING("9", "13") MISSING("10", "13")
        "error: and 2 more parts are missing\n");

    write_empty(FIRST, 1, 2);
    write_empty(OTHER, 2, 2);
    assert_string_equal(told(text, (const char *[]){OTHER, FIRST}, 2), "");
    assert_string_equal(told(text, (const char *[]){FIRST}, 1), MISSING("2", "2"));
    write_two(&w);
    write_part(&w, &small, 2, 2, 3);
    assert_string_equal(told(text, (const char *[]){FIRST, OTHER}, 2),
                        OTHER ": error: this part has 3 camera samples a pixel, but \"" FIRST "\" has 2: give all "
                        "parts the same --spp\n");
    write_part(&w, &small, 1, 1, 2);
    assert_string_equal(told(text, (const char *[]){FIRST, DIR_NAME "/part-1-1"}, 2),
                        DIR_NAME "/part-1-1: error: this is a part of 1, but \"" FIRST "\" is one of 2: all must have "
                        "the N of the same --part K/N\n");
    w.desc.view.sampler.seed++;
    write_part(&w, &small, 2, 2, 2);
    assert_string_equal(told(text, (const char *[]){FIRST, OTHER}, 2),
                        OTHER ": error: this part and \"" FIRST "\" belong to different pictures. These differ: the "
                        "sampler, or its seed. Render the part again with the scene and options of the others\n");

    unsigned char *data = read_bytes(FIRST, &size);
    data[8 + 4 + 16] ^= 1; /* behind magic, format and version: the name of the integrator */
    seal(data, size);
    store(BAD, data, size);
    bis_free(data);
    assert_string_equal(told(text, (const char *[]){BAD}, 1),
                        BAD ": error: this part was made by an integrator that this program does not have\n");
    clear_world(&w);
}

/* A hundred thousand parts of a picture of as many tiles are the most that there may be. No memory is taken for it, and
 * of what is missing ten are named. */
static void a_picture_has_at_most_a_hundred_thousand_parts(void **state)
{
    static const uint32_t small_sides[6] = {32, 0, 32, 16, 0, 16};
    static const char *const path[] = {BAD};
    size_t size, sizes = 0, at = 8 + 4 + 16 + 16 + 4; /* of K: behind magic, format, version, settings */
    unsigned char wanted[24];
    char text[4096];

    write_empty(FIRST, 1, 2);
    unsigned char *data = read_bytes(FIRST, &size);
    for (int i = 0; i < 6; i++) put_bytes(wanted + 4 * i, small_sides[i], 4);
    while (sizes + 24 < size && memcmp(data + sizes, wanted, 24) != 0) sizes++;
    for (const bis_parameter *p = bis_parameters; p->name; p++) at += 8;
    assert_true(sizes + 24 < size && data[at] == 1 && data[at + 4] == 2);
    for (uint32_t n = 100000; n <= 100001; n++) {
        const uint32_t width = n > 100000 ? 6416 : 6400, sides[6] = {width, 0, width, 4000, 0, 4000}; /* x 250 tiles */
        put_bytes(data + at + 4, n, 4);
        for (int i = 0; i < 6; i++) put_bytes(data + sizes + 4 * (size_t)i, sides[i], 4);
        seal(data, size);
        store(BAD, data, size);
        told(text, path, 1);
        if (n > 100000) assert_string_equal(text, DAMAGED);
        else assert_non_null(strstr(text, MISSING("11", "100000") "error: and 99989 more parts are missing\n"));
    }
    bis_free(data);
    told(text, (const char *[]){DIR_NAME "/none"}, 1);
    assert_true(strncmp(text, DIR_NAME "/none: error: ", strlen(DIR_NAME "/none: error: ")) == 0);
}

/* A text is as long as the file says, whatever stood in its place before. */
static void a_text_ends_where_it_was_read_to(void **state)
{
    static const unsigned char file[6] = {2, 0, 0, 0, 'a', 'b'};
    bis_walk *w = bis_alloc(1, sizeof *w);
    char text[8] = "1234567";
    w->in = file, w->end = file + sizeof file;
    bis_walk_text(w, text, sizeof text);
    assert_false(w->bad);
    assert_string_equal(text, "ab");
    bis_free(w);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(five_parts_in_each_order_have_the_bits_of_one_render),
        cmocka_unit_test(a_part_may_be_rendered_in_several_runs),
        cmocka_unit_test(each_tile_is_in_one_share_and_shares_are_alike),
        cmocka_unit_test(a_costly_region_is_dealt_out_to_all_parts),
        cmocka_unit_test(every_truncation_and_every_changed_byte_of_a_part_is_refused),
        cmocka_unit_test(every_field_of_the_format_counts),
        cmocka_unit_test(parts_are_read_and_begin_the_fuzzing),
        cmocka_unit_test(figures_of_parts_are_added_up),
        cmocka_unit_test(what_is_missing_or_foreign_is_named),
        cmocka_unit_test(without_memory_there_is_a_message),
        cmocka_unit_test(of_unlike_parts_the_larger_figures_stand),
        cmocka_unit_test(numbers_that_make_no_sense_are_refused),
        cmocka_unit_test(a_head_is_read_up_to_its_limits),
        cmocka_unit_test(the_shortest_file_of_the_other_kind_is_known),
        cmocka_unit_test(a_text_ends_where_it_was_read_to),
        cmocka_unit_test(messages_stand_alone),
        cmocka_unit_test(a_picture_has_at_most_a_hundred_thousand_parts),
    };
    return cmocka_run_group_tests(tests, setup, NULL);
}
