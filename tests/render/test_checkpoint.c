/* SPDX-License-Identifier: BSD-2-Clause */
/* checkpoint: a render that is broken off and goes on has the bits of one that is not, and what cannot be gone on from
 * is refused by name. Expected pictures are those of renders without a checkpoint. The twin is a checkpoint in which
 * one number is another, with a checksum that fits: its picture must be another. */
#include "bis/base/mem.h"
#include "claim.h"
#include "file_help.h"
#include "program.h"
#include "state_help.h"

#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#define DIR_NAME "build/test_checkpoint"
#define PATH DIR_NAME "/state"

#define COUNT(a) (sizeof(a) / sizeof *(a))

static int setup(void **state)
{
    program_folder(DIR_NAME);
    return 0;
}

/* ---- what is rendered ---- */

/* 4 x 3 pixels, all on the floor or the ball, in one tile. */
static const double small[4] = {18 / 37.0, 22 / 37.0, 9 / 21.0, 12 / 21.0}, middle[4] = {0.3, 0.7, 0.2, 0.8};

static const kind kinds[] = {
    {"plain", &bis_sir, BIS_SAMPLER_STRATIFIED, .crop = whole},
    {"halton", &bis_mis, BIS_SAMPLER_HALTON, .crop = whole},
    {"learn", &bis_sir, BIS_SAMPLER_SOBOL, .learns = true, .crop = whole},
    {"learn, crop", &bis_sir, BIS_SAMPLER_SOBOL, .learns = true, .crop = middle},
    {"error", &bis_sir, BIS_SAMPLER_SOBOL, .error = 1e-9, .crop = whole},
    {"layers", &bis_sir, BIS_SAMPLER_SOBOL, .layers = BIS_LAYERS_ALL, .crop = whole},
    {"edges", &bis_em, BIS_SAMPLER_SOBOL, .edges = true, .crop = whole},
    {"all", &bis_sir, BIS_SAMPLER_STRATIFIED, true, true, 1e-9, BIS_LAYERS_ALL, middle},
};

static void render_kind(bis_film *f, bis_render_result *result, const world *w, const kind *k,
                        bis_render_options options, bis_checkpoint *c)
{
    bis_diag diag = {0};
    if (try_render(f, result, w, k, options, c, &diag)) fail_msg("%s: %s", k->name, diag.messages[0].text);
    bis_diag_clear(&diag);
}

static bis_checkpoint read_state(const char *path)
{
    bis_checkpoint c = {.path = PATH, .every = 1e9};
    bis_diag diag = {0};
    if (bis_checkpoint_read(&c, path, &diag)) fail_msg("%s", diag.messages[0].text);
    return c;
}

static bis_render_options budget(const kind *k, uint32_t spp, int n_threads)
{
    return (bis_render_options){.budget = {.spp = spp, .error = k->error}, .n_threads = n_threads};
}

/* ---- the same bits ---- */

/* Broken off after n samples, for each n: behind a whole pass, and amid the order of sizes, where the last pass is
 * smaller than one render's and must be left out. 22 camera samples end with a smaller pass, too. */
static void a_render_that_goes_on_has_the_bits_of_one_render(void **state)
{
    static const uint32_t breaks[] = {1, 2, 3, 4, 6, 8, 12, 13, 20, 22};

    for (size_t i = 0; i < COUNT(kinds); i++) {
        const kind *k = &kinds[i];
        world w;
        bis_film whole_film, f;
        bis_render_result expected, result;
        make_kind(&w, k);
        render_kind(&whole_film, &expected, &w, k, budget(k, 22, 2), NULL);
        for (size_t j = 0; j < COUNT(breaks); j++) {
            bis_checkpoint c = {.path = PATH, .every = 1e9};
            unlink(PATH);
            render_kind(&f, &result, &w, k, budget(k, breaks[j], j % 2 ? 1 : 3), &c);
            bis_film_clear(&f);
            assert_false(c.failed);
            c = read_state(PATH);
            render_kind(&f, &result, &w, k, budget(k, 22, j % 2 ? 3 : 1), &c);
            assert_same_film(&whole_film, &f);
            assert_same_result(&expected, &result);
            bis_film_clear(&f);
        }
        bis_film_clear(&whole_film);
        clear_world(&w);
    }
}

/* One thread, because the fuse is shared; a pass of 4 samples has 4 x 37 x 21 calls at most. */
static void a_render_that_is_interrupted_again_and_again_has_the_bits_of_one_render(void **state)
{
    static const double intervals[] = {0, 1e9};
    const kind k = {"fused", &fused, BIS_SAMPLER_SOBOL, .crop = whole};
    world w;
    bis_film expected, f;
    bis_render_result result;

    make_kind(&w, &k);
    render_kind(&expected, &result, &w, &k, budget(&k, 31, 2), NULL);
    for (size_t i = 0; i < COUNT(intervals); i++) {
        int runs = 0;
        unlink(PATH);
        do {
            bis_render_options options = budget(&k, 31, 1);
            bis_checkpoint c = {.path = PATH, .every = intervals[i]};
            if (runs) c = read_state(PATH), c.every = intervals[i];
            set_fuse(4L * WIDTH * HEIGHT + 300 * runs++);
            options.interrupted = &world_flag;
            if (result.interrupted) bis_film_clear(&f);
            render_kind(&f, &result, &w, &k, options, &c);
        } while (result.interrupted);
        assert_in_range(runs, 4, 31);
        assert_same_film(&expected, &f);
        bis_film_clear(&f);
    }
    bis_film_clear(&expected);
    clear_world(&w);
}

/* The error is looked at in some of the passes only; from the 20th on one is left out. Broken off by camera samples in
 * every pass from there to the end, and by a larger error. */
static void an_error_is_reached_by_the_same_pass_and_a_smaller_one_may_follow(void **state)
{
    const kind k = {"error", &bis_sir, BIS_SAMPLER_SOBOL, .error = 0.07, .crop = middle};
    const bis_render_options options = {.budget = {.error = k.error}, .n_threads = 2};
    world w;
    bis_film expected, f;
    bis_render_result first, result;

    make_kind(&w, &k);
    render_kind(&expected, &first, &w, &k, options, NULL);
    assert_true(first.error.upper <= k.error);
    assert_in_range(first.passes, 24, 80);
    for (uint32_t passes = 18; passes <= first.passes; passes++) {
        bis_checkpoint c = {.path = PATH, .every = 1e9};
        bis_render_options before = budget(&k, 4 + 4 * (passes - 4), 1);
        if (passes == 18) before.budget = (bis_budget){.error = 0.12};
        if (passes == first.passes) before.budget = options.budget; /* it is reached: no pass may follow */
        render_kind(&f, &result, &w, &k, before, &c);
        bis_film_clear(&f);
        c = read_state(PATH);
        render_kind(&f, &result, &w, &k, options, &c);
        assert_same_film(&expected, &f);
        assert_same_result(&first, &result);
        bis_film_clear(&f);
    }
    bis_film_clear(&expected);
    clear_world(&w);
}

/* ---- the file ---- */

/* A checkpoint of a few pixels that learn, and its bytes. */
static const kind tiny = {"tiny", &bis_sir, BIS_SAMPLER_SOBOL, .learns = true, .crop = small};

static unsigned char *tiny_state(const world *w, size_t *size, size_t *at)
{
    bis_checkpoint c = {.path = PATH, .every = 1e9};
    bis_film f;
    bis_render_result result;

    unlink(PATH);
    render_kind(&f, &result, w, &tiny, budget(&tiny, 12, 1), &c);
    bis_film_clear(&f);
    c = read_state(PATH);
    *at = c.at;
    bis_checkpoint_clear(&c);
    return read_bytes(PATH, size);
}

/* A message begins with the file, without a line. */
static bool names_file(const char *message, const char *path)
{
    const size_t n = strlen(path);
    return strncmp(message, path, n) == 0 && strncmp(message + n, ": error: ", 9) == 0;
}

static void expect_refusal(const char *path, bis_status status, const char *words)
{
    bis_checkpoint c = {0};
    bis_diag diag = {0};
    assert_int_equal(bis_checkpoint_read(&c, path, &diag), status);
    assert_null(c.data);
    assert_int_equal(diag.n, 1);
    assert_true(names_file(diag.messages[0].text, path));
    assert_non_null(strstr(diag.messages[0].text, words));
    bis_diag_clear(&diag);
}

static void every_truncation_and_every_changed_byte_is_refused(void **state)
{
    static const char bad[] = DIR_NAME "/bad";
    static const unsigned char masks[] = {0x01, 0xff};
    world w;
    size_t size, at;

    make_kind(&w, &tiny);
    unsigned char *data = tiny_state(&w, &size, &at);
    for (size_t n = 0; n < size; n++) {
        store(bad, data, n);
        expect_refusal(bad, BIS_INPUT, "checkpoint");
    }
    for (size_t i = 0; i < size; i++) {
        for (size_t j = 0; j < COUNT(masks); j++) {
            data[i] ^= masks[j];
            store(bad, data, size);
            data[i] ^= masks[j];
            expect_refusal(bad, BIS_INPUT, "checkpoint");
        }
    }
    unsigned char *longer = bis_alloc(size + 1, 1);
    memcpy(longer, data, size);
    store(bad, longer, size + 1);
    expect_refusal(bad, BIS_INPUT, "checksum");
    bis_free(longer);
    data[8]++; /* the format */
    seal(data, size);
    store(bad, data, size);
    expect_refusal(bad, BIS_INPUT, "the same version");
    data[8]--, data[12]++; /* the version of bis */
    seal(data, size);
    store(bad, data, size);
    expect_refusal(bad, BIS_INPUT, "the same version");
    store(bad, (const unsigned char *)"\x89PNG\r\n\x1a\n and other things, more than a head's worth", 50);
    expect_refusal(bad, BIS_INPUT, "no checkpoint of bis");
    expect_refusal(DIR_NAME, BIS_IO, "a folder");
    bis_free(data);
    clear_world(&w);
}

enum { BEFORE_SUMS = 96 }; /* bytes of the state that come before the film's sums */

/* A forged file may be refused or not; it must not break anything. */
static void a_forged_head_breaks_nothing(void **state)
{
    static const unsigned char masks[] = {0x01, 0x80, 0xff};
    int n_refused = 0;
    world w;
    size_t size, at;

    make_kind(&w, &tiny);
    unsigned char *data = tiny_state(&w, &size, &at);
    for (size_t i = 0; i < at + BEFORE_SUMS; i++) {
        for (size_t j = 0; j < COUNT(masks); j++) {
            bis_checkpoint c = {0};
            bis_film f;
            bis_render_result result;
            data[i] ^= masks[j];
            seal(data, size);
            store(PATH, data, size);
            data[i] ^= masks[j];
            bis_status status = bis_checkpoint_read(&c, PATH, NULL);
            if (!status) {
                status = try_render(&f, &result, &w, &tiny, budget(&tiny, 16, 1), &c, NULL);
                bis_film_clear(&f);
            }
            assert_true(status == BIS_OK || status == BIS_INPUT);
            n_refused += status != BIS_OK;
        }
    }
    /* all hashes of parts are, but not the seconds */
    assert_in_range(n_refused, 3 * BIS_IDENTITY_PARTS * 8, 3 * (at + BEFORE_SUMS - 1));
    bis_free(data);
    clear_world(&w);
}

/* The second field of the state: 1000 s are spent, so a budget of 500 s allows no pass, and one of 2000 s does. What is
 * kept then is no longer than what the render took with them. */
static void seconds_that_were_spent_before_count(void **state)
{
    static const double spent = 1000;
    world w;
    size_t size, at;

    make_kind(&w, &tiny);
    unsigned char *data = tiny_state(&w, &size, &at);
    uint64_t bits;
    memcpy(&bits, &spent, 8);
    for (int i = 0; i < 8; i++) data[at + 8 + (size_t)i] = (unsigned char)(bits >> 8 * i);
    seal(data, size);
    for (int i = 0; i < 2; i++) {
        bis_film f;
        bis_render_result result;
        store(PATH, data, size);
        bis_checkpoint c = read_state(PATH);
        const bis_budget b = {.spp = 16, .seconds = i ? 2000 : 500};
        render_kind(&f, &result, &w, &tiny, (bis_render_options){.budget = b, .n_threads = 1}, &c);
        assert_int_equal(result.spp, i ? 16 : 12);
        assert_true(result.seconds >= spent && result.seconds < 1500);
        size_t n;
        unsigned char *kept = read_bytes(PATH, &n);
        double seconds;
        assert_int_equal(n, size);
        for (int k = 8; k-- > 0;) bits = bits << 8 | kept[at + 8 + (size_t)k];
        memcpy(&seconds, &bits, 8);
        assert_true(seconds >= spent && seconds <= result.seconds);
        bis_free(kept);
        bis_film_clear(&f);
    }
    bis_free(data);
    clear_world(&w);
}

/* All settings come back, also those that sir does not read. */
static void settings_are_read_back(void **state)
{
    kind k = kinds[0];
    bis_checkpoint c = {.path = PATH, .every = 1e9};
    bis_render_result result;
    bis_film f;
    world w;

    unlink(PATH);
    make_kind(&w, &k);
    bis_settings *s = &w.desc.view.settings;
    s->samples = 7, s->shadowrays = 3, s->candidates = 24, s->perpatch = 5;
    s->heuristic = BIS_HEURISTIC_POWER, s->estimator = BIS_ESTIMATOR_RATIO, s->proposal = BIS_PROPOSAL_BRDF;
    s->resampling = BIS_RESAMPLING_MULTINOMIAL, s->stratify = false, s->compensate = true, s->learn = true;
    s->as_printed = BIS_E6 | BIS_E21;
    render_kind(&f, &result, &w, &k, budget(&k, 4, 1), &c);
    c = read_state(PATH);
    assert_ptr_equal(c.head.settings.integrator, &bis_sir);
    for (const bis_parameter *p = bis_parameters; p->name; p++)
        if (bis_parameter_get(p, &c.head.settings) != bis_parameter_get(p, s)) fail_msg("%s", p->name);
    assert_int_equal(c.head.settings.as_printed, BIS_E6 | BIS_E21);
    bis_checkpoint_clear(&c);
    bis_film_clear(&f);
    clear_world(&w);
}

/* ---- another render ---- */

#define OTHER world *w, kind *k, bis_render_options *o

static void other_crop(OTHER) { (void)w, (void)o, k->crop = middle; }
static void other_layers(OTHER) { (void)w, (void)o, k->layers = BIS_LAYERS_ALL; }
static void other_fov(OTHER) { (void)k, (void)o, w->desc.view.camera.fov_deg = 61; }
static void other_seed(OTHER) { (void)k, (void)o, w->desc.view.sampler.seed++; }
static void other_jitter(OTHER) { (void)k, (void)o, w->desc.view.pixel_jitter = false; }
static void other_edges(OTHER) { (void)k, (void)o, w->desc.view.edge_samples = 2; }
static void other_edge_light(OTHER) { (void)k, (void)o, w->desc.view.edge_light = 0.5; }
static void other_error(OTHER) { (void)w, (void)k, o->budget.error = 0.1; }
static void other_learn(OTHER) { (void)k, (void)o, w->desc.view.settings.candidates++; }
static void other_E6(OTHER) { (void)k, (void)o, w->desc.view.settings.as_printed = 1; }
static void other_vertex(OTHER) { (void)k, (void)o, w->scene.geometry.p[3].z += 1; }
static void other_index(OTHER) { (void)k, (void)o, w->scene.geometry.index[4] = 1; }
static void other_ball(OTHER) { (void)k, (void)o, w->scene.geometry.quadrics[0].radius = 2; }
static void other_material(OTHER) { (void)k, (void)o, w->materials[1].exponent++; }
static void other_scale(OTHER) { (void)k, (void)o, w->desc.light.scale = 2; }
static void other_turn(OTHER) { (void)k, (void)o, w->desc.light.to_world.m[0][1] = 1; }
static void other_density(OTHER) { (void)k, (void)o, w->desc.accel.density = 3; }

static void other_spp(OTHER)
{
    bis_sampler_set_spp(&w->desc.view.sampler, 9);
}

static void other_pixel(OTHER)
{
    bis_light_envmap(w->scene.light)->pixels[77].g += 1;
}

static void other_name(OTHER)
{
    static char name[] = "elsewhere/map.exr";
    w->desc.light.filename = name;
}

static void fewer_samples(OTHER) { (void)w, (void)k, o->budget.spp = 3; }
static void more_samples(OTHER) { (void)w, (void)k, o->budget.spp = 5; }

static const struct {
    void (*change)(OTHER);
    const char *words; /* NULL: it goes on */
} other_renders[] = {
    {other_crop, "differ: the size of the picture, or its crop. "},
    {other_layers, "differ: the layers. "},
    {other_fov, "differ: the camera. "},
    {other_seed, "differ: the sampler, or its seed. "},
    {other_spp, "for which samplers \"stratified\" and \"halton\" divide a pixel (--spp). "},
    {other_jitter, "differ: pixel jitter, "},
    {other_edges, "differ: pixel jitter, or camera samples on edges"},
    {other_edge_light, "differ: pixel jitter, or camera samples on edges"},
    {other_learn, "differ: the integrator, or its parameters. "},
    {other_E6, "differ: the integrator, or its parameters. "},
    {other_vertex, "differ: the shapes. "},
    {other_index, "differ: the shapes. "},
    {other_ball, "differ: the shapes. "},
    {other_material, "differ: the materials, or their textures. "},
    {other_pixel, "differ: the pixels of the map. "},
    {other_scale, "differ: the parameters of the light. "},
    {other_turn, "differ: the parameters of the light. "},
    {other_density, "differ: the accelerator. "},
    {fewer_samples, "has 4 camera samples a pixel already"},
    {other_error, NULL},
    {other_name, NULL},
    {more_samples, NULL},
};

static void another_render_is_refused_by_what_differs(void **state)
{
    for (size_t i = 0; i < COUNT(other_renders); i++) {
        const bool edges = other_renders[i].change == other_edges || other_renders[i].change == other_edge_light;
        kind k = kinds[edges ? 6 : 0]; /* 6: has edges */
        bis_render_options options = budget(&k, 4, 1);
        bis_checkpoint c = {.path = PATH, .every = 1e9};
        bis_diag diag = {0};
        world w;
        bis_film f;
        bis_render_result result;
        unlink(PATH);
        make_kind(&w, &k);
        render_kind(&f, &result, &w, &k, options, &c);
        bis_film_clear(&f);
        other_renders[i].change(&w, &k, &options);
        c = read_state(PATH);
        const bis_status status = try_render(&f, &result, &w, &k, options, &c, &diag);
        assert_int_equal(status, other_renders[i].words ? BIS_INPUT : BIS_OK);
        if (other_renders[i].words) {
            assert_int_equal(diag.n, 1);
            if (!strstr(diag.messages[0].text, other_renders[i].words))
                fail_msg("\"%s\" has no \"%s\"", diag.messages[0].text, other_renders[i].words);
            assert_true(names_file(diag.messages[0].text, PATH));
        }
        bis_diag_clear(&diag);
        bis_film_clear(&f);
        clear_world(&w);
    }
}

/* ---- what fails ---- */

static int n_warnings;
static void count_warning(const char *message)
{
    assert_non_null(strstr(message, PATH));
    n_warnings++;
}

/* A limit of the size of files is what a full disk looks like. */
static void where_the_new_one_cannot_be_written_the_older_one_stays_and_the_render_goes_on(void **state)
{
    world w;
    bis_film expected, f;
    bis_render_result result;
    struct rlimit limit, low;
    size_t n_before, n_after;

    make_kind(&w, &kinds[0]);
    render_kind(&expected, &result, &w, &kinds[0], budget(&kinds[0], 16, 2), NULL);
    bis_checkpoint c = {.path = PATH, .every = 1e9};
    unlink(PATH);
    render_kind(&f, &result, &w, &kinds[0], budget(&kinds[0], 4, 1), &c);
    bis_film_clear(&f);
    unsigned char *before = read_bytes(PATH, &n_before);

    c = read_state(PATH);
    c.every = 0;
    c.warn = count_warning;
    n_warnings = 0;
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &limit), 0);
    low = (struct rlimit){n_before / 2, limit.rlim_max};
    signal(SIGXFSZ, SIG_IGN);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &low), 0);
    render_kind(&f, &result, &w, &kinds[0], budget(&kinds[0], 16, 2), &c);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &limit), 0);
    assert_true(c.failed);
    assert_int_equal(n_warnings, 1); /* of four failures */
    assert_same_film(&expected, &f);
    unsigned char *after = read_bytes(PATH, &n_after);
    assert_int_equal(n_before, n_after);
    assert_memory_equal(before, after, n_before);
    bis_free(before);
    bis_free(after);
    bis_film_clear(&expected);
    bis_film_clear(&f);
    clear_world(&w);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_render_that_goes_on_has_the_bits_of_one_render),
        cmocka_unit_test(a_render_that_is_interrupted_again_and_again_has_the_bits_of_one_render),
        cmocka_unit_test(an_error_is_reached_by_the_same_pass_and_a_smaller_one_may_follow),
        cmocka_unit_test(every_truncation_and_every_changed_byte_is_refused),
        cmocka_unit_test(a_forged_head_breaks_nothing),
        cmocka_unit_test(seconds_that_were_spent_before_count),
        cmocka_unit_test(settings_are_read_back),
        cmocka_unit_test(another_render_is_refused_by_what_differs),
        cmocka_unit_test(where_the_new_one_cannot_be_written_the_older_one_stays_and_the_render_goes_on),
    };
    return cmocka_run_group_tests(tests, setup, NULL);
}
