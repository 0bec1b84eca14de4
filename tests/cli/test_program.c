/* SPDX-License-Identifier: BSD-2-Clause */
/* The program itself: options in, files and exit status out, docs/command-line.md. The scene is made here; what is
 * looked at is read back by the library (which has tests of its own) and, for EXR headers, by OpenEXR. */
#include "bis/shape/accel.h"
#include "bis/tools/compare.h"
#include "bis/base/file.h"
#include "bis/base/mem.h"
#include "bis/files/image_file.h"

#include "claim.h"
#include "expect.h"
#include "file_help.h"
#include "json_check.h"
#include "program.h"

#include <fcntl.h>
#include <math.h>
#include <openexr.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>

#define DIR "build/test_program"
#define SCENE DIR "/scene.txt"
#define ALONE DIR "/alone" /* the same scene again, where nothing is written */

static int setup(void **state)
{
    program_folder(DIR);
    program_write_scene(DIR, "Sampler \"stratified\" \"integer pixelsamples\" 4\n");
    program_folder(ALONE);
    program_write_scene(ALONE, "Sampler \"stratified\" \"integer pixelsamples\" 4\n");
    return 0;
}

static void read_image(bis_image *image, const char *path)
{
    bis_diag diag = {0};
    if (bis_image_read(image, path, (bis_loc){0}, &diag)) fail_msg("%s", diag.n ? diag.messages[0].text : path);
    bis_diag_clear(&diag);
}

static double relmse(const char *path_a, const char *path_b)
{
    bis_image a, b;
    bis_comparison c;
    read_image(&a, path_a);
    read_image(&b, path_b);
    assert_int_equal(bis_compare(&c, &a, &b, NULL), BIS_OK);
    assert_int_equal(c.nonfinite, 0);
    bis_image_clear(&a);
    bis_image_clear(&b);
    return c.relmse;
}

/* ---- rendering ---- */

static void a_scene_renders_to_the_file_it_names(void **state)
{
    program_run r;
    bis_image image;
    program_expect(&r, 0, SCENE);
    assert_string_equal(r.output, "");
    program_expect_only_the_result(&r);
    read_image(&image, DIR "/film.exr");
    assert_int_equal(image.width, 24);
    assert_int_equal(image.height, 16);
    double sum = 0;
    for (int i = 0; i < 24 * 16; i++) sum += rgb_sum(image.pixels[i]);
    assert_true(sum > 0);
    bis_image_clear(&image);
    unlink(DIR "/film.exr");
}

static void the_word_render_may_be_left_out_and_the_seed_decides(void **state)
{
    program_run r;
    program_expect(&r, 0, "render " SCENE " --outfile " DIR "/a.exr --nthreads 1");
    program_expect(&r, 0, SCENE " --outfile " DIR "/b.exr --nthreads 3");
    program_expect(&r, 0, SCENE " --outfile " DIR "/c.exr --seed 99");
    assert_true(relmse(DIR "/a.exr", DIR "/b.exr") == 0);
    assert_true(relmse(DIR "/a.exr", DIR "/c.exr") > 0);
    assert_false(program_exists(DIR "/film.exr"));
}

static void every_format_holds_the_same_picture(void **state)
{
    program_run r;
    program_expect(&r, 0,
        SCENE " --outfile " DIR "/f.exr --outfile " DIR "/f.pfm --outfile=" DIR "/f.hdr --outfile " DIR "/f.png");
    program_expect(&r, 0, "compare --tolerance 0 " DIR "/f.pfm " DIR "/f.exr");
    assert_string_equal(r.messages, "");
    double error = relmse(DIR "/f.hdr", DIR "/f.exr");
    assert_true(error > 0 && error < 1e-3); /* 8 bits of mantissa for the largest channel, fewer for the others */
    FILE *f = fopen(DIR "/f.png", "rb");
    unsigned char head[24];
    assert_int_equal(fread(head, 1, 24, f), 24);
    fclose(f);
    assert_memory_equal(head, "\x89PNG\r\n\x1a\n", 8);
    assert_int_equal(head[19], 24); /* IHDR: width, height */
    assert_int_equal(head[23], 16);
}

static void exposure_makes_a_png_brighter(void **state)
{
    program_run r;
    struct stat dark, bright;
    program_expect(&r, 0, SCENE " --exposure -99 --outfile " DIR "/dark.png");
    program_expect(&r, 0, SCENE " --exposure 0 --outfile " DIR "/bright.png");
    assert_int_equal(stat(DIR "/dark.png", &dark), 0);
    assert_int_equal(stat(DIR "/bright.png", &bright), 0);
    assert_true(dark.st_size < bright.st_size / 2); /* all black compresses well */
}

/* ---- EXR ---- */

static exr_context_t open_exr(const char *path)
{
    exr_context_t file;
    exr_context_initializer_t init = EXR_DEFAULT_CONTEXT_INITIALIZER;
    assert_int_equal(exr_start_read(&file, path, &init), EXR_ERR_SUCCESS);
    return file;
}

static void assert_text(exr_context_t file, const char *name, const char *expected)
{
    const char *text = NULL;
    int32_t length;
    if (exr_attr_get_string(file, 0, name, &length, &text)) fail_msg("no attribute %s", name);
    assert_string_equal(text, expected);
}

static double number(exr_context_t file, const char *name)
{
    double v = (double)NAN;
    if (exr_attr_get_double(file, 0, name, &v)) fail_msg("no attribute %s", name);
    return v;
}

static void an_exr_says_how_it_was_made_E39(void **state)
{
    program_run r;
    program_expect(
        &r, 0, SCENE " --outfile " DIR "/attr.exr --resolution 144x96 --spp 64 --seed 7 --candidates 30 --proposal em");
    exr_context_t file = open_exr(DIR "/attr.exr");
    assert_text(file, "scene", SCENE);
    assert_text(file, "integrator", "sir");
    assert_text(file, "proposal", "em");
    assert_text(file, "resampling", "systematic");
    assert_text(file, "stratify", "true");
    assert_true(number(file, "candidates") == 30);
    assert_true(number(file, "shadowrays") == 2);
    assert_true(number(file, "spp") == 64);
    assert_true(number(file, "seed") == 7);
    assert_true(number(file, "render_seconds") > 0);
    assert_true(number(file, "estimated_relative_rmse") > 0);
    const char *version;
    int32_t length;
    assert_int_equal(exr_attr_get_string(file, 0, "bis:version", &length, &version), EXR_ERR_SUCCESS);
    exr_finish(&file);
}

static void an_exr_has_float_channels_and_alpha_where_its_background_is_transparent(void **state)
{
    program_run r;
    const char *const names[4] = {"A", "B", "G", "R"};
    for (int opaque = 0; opaque < 2; opaque++) {
        program_expect(&r, 0, SCENE "%s --outfile " DIR "/alpha.exr", opaque ? "" : " --transparent");
        exr_context_t file = open_exr(DIR "/alpha.exr");
        const exr_attr_chlist_t *channels;
        assert_int_equal(exr_get_channels(file, 0, &channels), EXR_ERR_SUCCESS);
        assert_int_equal(channels->num_channels, 4 - opaque);
        for (int i = opaque; i < 4; i++) {
            assert_string_equal(channels->entries[i - opaque].name.str, names[i]);
            assert_int_equal(channels->entries[i - opaque].pixel_type, EXR_PIXEL_FLOAT);
        }
        exr_finish(&file);
    }
}

static void layers_are_further_channels_of_an_exr_alone(void **state)
{
    program_run r;
    const exr_attr_chlist_t *channels;
    const char *const names[7] = {"B", "G", "Ns.X", "Ns.Y", "Ns.Z", "R", "Z"};
    program_expect(&r, 0, SCENE " --layers depth,normal --outfile " DIR "/layers.exr --outfile " DIR "/layers.pfm");
    program_expect_only_the_result(&r);
    exr_context_t file = open_exr(DIR "/layers.exr");
    assert_int_equal(exr_get_channels(file, 0, &channels), EXR_ERR_SUCCESS);
    assert_int_equal(channels->num_channels, 7);
    for (int i = 0; i < 7; i++) assert_string_equal(channels->entries[i].name.str, names[i]);
    exr_finish(&file);
    assert_true(relmse(DIR "/layers.exr", DIR "/layers.pfm") == 0);

    program_expect(&r, 0, SCENE " --layers all --outfile " DIR "/layers.pfm");
    assert_non_null(strstr(r.messages, "layers go into an .exr, and no output file is one"));
    static const char *const scatter[] = {"interval", "stderr"};
    for (int i = 0; i < 2; i++) {
        program_expect(&r, 0, SCENE " --layers %s --spp 1 --outfile " DIR "/layers.exr", scatter[i]);
        assert_non_null(strstr(r.messages, "one pass has no scatter"));
        program_expect(&r, 0, SCENE " --layers %s --spp 2 --outfile " DIR "/layers.exr", scatter[i]);
        program_expect_only_the_result(&r);
    }
    program_expect(&r, 2, SCENE " --layers albedo,deth --outfile " DIR "/none.exr");
    assert_non_null(strstr(r.messages, "no layer \"deth\" (did you mean \"depth\"?)"));
    assert_false(program_exists(DIR "/none.exr"));
}

static void an_error_out_of_reach_is_said_early_and_loses_nothing(void **state)
{
    program_run r;
    program_expect(&r, 0, SCENE " --error 1e-6 --spp 6 --outfile " DIR "/far.exr");
    assert_non_null(strstr(r.messages, "warning: --error 1e-06 would take about "));
    assert_non_null(strstr(r.messages, " camera samples a pixel; --spp ends it before (the error is at most "));
    const char *const missed = strstr(r.messages, "warning: --error 1e-06 was not reached: the error is at most ");
    assert_non_null(missed);
    assert_non_null(strstr(missed, "% after 4 passes\n")); /* of 1, 1, 2 and 2 samples */
    assert_true(program_exists(DIR "/far.exr"));
    program_expect(&r, 0, SCENE " --error 1e-6 --spp 6 --quiet --outfile " DIR "/far.exr");
    assert_string_equal(r.messages, "");
    program_expect(&r, 0, SCENE " --error 1e-6 --time 1e6 --spp 6 --outfile " DIR "/far.exr");
    assert_non_null(strstr(r.messages, " camera samples a pixel; --time ends it before (the error is at most "));
    program_expect(&r, 0, SCENE " --error 900%% --outfile " DIR "/near.exr");
    program_expect_only_the_result(&r);
    program_expect(&r, 0, SCENE " --error 10%% --outfile " DIR "/near.exr"); /* after more than the first passes */
    program_expect_only_the_result(&r);
    program_expect(&r, 0, SCENE " --error 1e-6 --spp 1 --outfile " DIR "/far.exr");
    assert_non_null(
        strstr(r.messages, "was not reached: the error is unknown after 1 pass, because one pass is too few"));
}

/* What the program writes to standard error where that is a terminal; standard output goes nowhere. */
static void run_on_terminal(char *text, size_t size, const char *arguments)
{
    const int master = posix_openpt(O_RDWR | O_NOCTTY);
    size_t n = 0;
    int status;
    assert_true(master >= 0 && grantpt(master) == 0 && unlockpt(master) == 0);
    const int terminal = open(ptsname(master), O_RDWR | O_NOCTTY);
    struct termios as_it_is;
    assert_true(terminal >= 0 && tcgetattr(terminal, &as_it_is) == 0);
    cfmakeraw(&as_it_is);
    assert_int_equal(tcsetattr(terminal, TCSANOW, &as_it_is), 0);
    const pid_t pid = fork();
    assert_true(pid >= 0);
    if (pid == 0) {
        static char words[1024];
        char *argv[64] = {0};
        int argc = 0;
        const char *program = getenv("BIS_PROGRAM");
        snprintf(words, sizeof words, "%s %s", program && *program ? program : "build/release/bis", arguments);
        for (char *word = strtok(words, " "); word; word = strtok(NULL, " ")) argv[argc++] = word;
        dup2(open("/dev/null", O_WRONLY), STDOUT_FILENO);
        dup2(terminal, STDERR_FILENO);
        close(terminal);
        close(master);
        execv(argv[0], argv);
        _exit(127);
    }
    close(terminal);
    for (ssize_t got; n + 1 < size && (got = read(master, text + n, size - 1 - n)) > 0;) n += (size_t)got;
    text[n] = '\0';
    assert_int_equal(waitpid(pid, &status, 0), pid);
    if (status != 0) fail_msg("%s: %d, %s", arguments, status, text);
    close(master);
}

/* A line that is written anew, and gone at the end. No word of it with --quiet. */
static void on_a_terminal_a_line_tells_how_far_it_is(void **state)
{
    static const char *const cases[][12] = {
        {SCENE " --spp 3 --outfile " DIR "/shown.pfm",
         "\rpass 3 of 3, 100%, 0 s left   \033[K\r\033[Kbis: wrote " DIR "/shown.pfm: "},
        {SCENE " --spp 3 --quiet --outfile " DIR "/shown.pfm", NULL},
        {"trade " SCENE " --integrator em --passes 1 --seeds 1 --time 3 --error 60% --output " DIR "/shown",
         "\rreading the scene   \033[K", "\rpilot, 0%   \033[K", "\rpilot, 9%   \033[K",
         "\rbuilding the map's importance   \033[K", "\rreference by sir, 50%, ", " left   \033[K",
         "\rrun 1 of 6, 0%, ", "\rrun 6 of 6, ", "\rpictures, 0%, ", " left   \033[K\r\033[K"},
        {"trade " SCENE " --integrator em --passes 1 --seeds 1 --time 3 --quiet --output " DIR "/quiet", NULL},
        {"verify " DIR "/map.pfm", "\rthe map ...\033[K\ralias ...\033[K\rcdf ...\033[K\rcurve ...\033[K\r\033[K"},
    };
    static char text[1 << 16];
    assert_int_equal(system("rm -rf " DIR "/shown " DIR "/quiet"), 0);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        run_on_terminal(text, sizeof text, cases[i][0]);
        const char *at = text;
        for (int k = 1; k < 12 && cases[i][k]; k++) {
            const char *const next = strstr(at, cases[i][k]);
            if (!next) fail_msg("%s: no \"%s\" in \"%s\"", cases[i][0], cases[i][k], at);
            at = next + strlen(cases[i][k]);
        }
        if (!cases[i][1] || i >= 2) assert_string_equal(at, "");
    }
}

static void a_crop_keeps_the_display_window_and_the_pixels(void **state)
{
    program_run r;
    bis_image full, crop;
    program_expect(&r, 0, SCENE " --outfile " DIR "/full.exr");
    program_expect(&r, 0, SCENE " --cropwindow 0.25,0.75,0.5,1 --outfile " DIR "/crop.exr --outfile " DIR "/crop.pfm");
    exr_context_t file = open_exr(DIR "/crop.exr");
    exr_attr_box2i_t data, display;
    assert_int_equal(exr_get_data_window(file, 0, &data), EXR_ERR_SUCCESS);
    assert_int_equal(exr_get_display_window(file, 0, &display), EXR_ERR_SUCCESS);
    exr_finish(&file);
    const int expected[8] = {6, 8, 17, 15, 0, 0, 23, 15};
    const int found[8] = {
        data.min.x, data.min.y, data.max.x, data.max.y, display.min.x, display.min.y, display.max.x, display.max.y};
    assert_memory_equal(found, expected, sizeof expected);
    read_image(&full, DIR "/full.exr");
    for (int format = 0; format < 2; format++) {
        read_image(&crop, format ? DIR "/crop.pfm" : DIR "/crop.exr");
        assert_int_equal(crop.width, 12);
        assert_int_equal(crop.height, 8);
        for (int y = 0; y < 8; y++)
            assert_memory_equal(&crop.pixels[y * 12], &full.pixels[(y + 8) * 24 + 6], 12 * sizeof(rgb));
        bis_image_clear(&crop);
    }
    bis_image_clear(&full);
}

/* ---- statistics ---- */

static void stats_are_json_with_exactly_the_keys_of_the_contract(void **state)
{
    program_run r;
    char keys[1024];
    program_expect(&r, 0, SCENE " --outfile " DIR "/s.exr --stats -");
    assert_true(json_is_valid(r.output));
    assert_string_equal(json_keys(keys, sizeof keys, r.output, ""),
                        "version scene integrator proposal candidates shadowrays samples spp seed threads accelerator "
                        "triangles width height extent seconds rays "
                        "candidates_drawn accepted fallbacks peak_memory_bytes memory estimated_relative_rmse "
                        "relative_rmse_at_most interrupted ");
    assert_string_equal(
        json_keys(keys, sizeof keys, r.output, "seconds"), "parse load envmap accel render write total ");
    assert_string_equal(json_keys(keys, sizeof keys, r.output, "rays"), "camera shadow ");
    assert_string_equal(json_keys(keys, sizeof keys, r.output, "memory"), "mesh accel envmap film ");
}

static void stats_in_a_file_are_those_of_standard_output(void **state)
{
    program_run r;
    char text[4096], value[64];
    struct stat st;
    program_expect(&r, 0, SCENE " --outfile " DIR "/s.exr --stats " DIR "/s.json");
    assert_string_equal(r.output, "");
    read_text(text, sizeof text, DIR "/s.json");
    assert_string_equal(json_value(value, sizeof value, text, "rays.camera"), "1536");
    /* A device is written to, not replaced by a file. */
    program_expect(&r, 0, SCENE " --outfile " DIR "/s.exr --stats /dev/null");
    assert_int_equal(stat("/dev/null", &st), 0);
    assert_true(S_ISCHR(st.st_mode));
}

static void without_jitter_a_picture_of_one_colour_has_no_scatter(void **state)
{
    program_run r;
    char value[64];
    program_write_file(DIR "/empty.txt", "WorldBegin LightSource \"infinite\" \"rgb L\" [1 2 3]\n");
    program_expect(&r, 0, DIR "/empty.txt --resolution 8x8 --disable-pixel-jitter --outfile " DIR "/e.pfm --stats -");
    assert_string_equal(json_value(value, sizeof value, r.output, "estimated_relative_rmse"), "0");
    assert_string_equal(json_value(value, sizeof value, r.output, "accelerator"), "null");
    assert_string_equal(json_value(value, sizeof value, r.output, "memory.accel"), "null");
    assert_string_equal(json_value(value, sizeof value, r.output, "memory.envmap"), "null");
    bis_image image;
    read_image(&image, DIR "/e.pfm");
    for (int i = 0; i < 64; i++)
        assert_true(image.pixels[i].r == 1 && image.pixels[i].g == 2 && image.pixels[i].b == 3);
    bis_image_clear(&image);
}

static void a_time_budget_renders_for_a_while_and_says_how_much(void **state)
{
    program_run r;
    char value[64];
    program_expect(&r, 0, SCENE " --time 0.2 --outfile " DIR "/t.exr --stats -");
    assert_true(atof(json_value(value, sizeof value, r.output, "spp")) >= 1);
    assert_null(strstr(r.output, "\"missing\""));
    program_expect(&r, 0, SCENE " --time 1e-9 --outfile " DIR "/t.exr --stats -");
    assert_string_equal(json_value(value, sizeof value, r.output, "spp"), "1");
    assert_true(fabs(atof(json_value(value, sizeof value, r.output, "missing")) - (1 - 3 * 2. / (24 * 16))) < 1e-9);
    assert_non_null(strstr(r.messages, "98% of them without a camera sample"));
    assert_non_null(strstr(r.messages, "--time 1e-09 was over in the first pass: 98% of the pixels have no camera"));
    /* a checkpoint holds whole passes only */
    program_expect(&r, 0, SCENE " --time 1e-9 --checkpoint " DIR "/t.ckpt --outfile " DIR "/t.exr --stats -");
    assert_null(strstr(r.output, "\"missing\""));
}

/* The picture is there while the render goes on; then it is interrupted, and what is written last has more samples.
 * Twin: without the option there is no picture before the end. */
static void write_every_writes_the_picture_while_it_is_rendered(void **state)
{
    const struct timespec pause = {0, 50000000};
    program_run r;
    for (int asks = 0; asks < 2; asks++) {
        bool early = false;
        unlink(DIR "/so_far.pfm");
        const pid_t pid = program_start(asks ? SCENE " --spp 1000000000 --write-every 0.01 --outfile " DIR "/so_far.pfm"
                                             : SCENE " --spp 1000000000 --outfile " DIR "/so_far.pfm");
        program_wait_for_handler(pid, SIGINT);
        for (int i = 0; i < (asks ? 2400 : 20) && !early; i++) {
            nanosleep(&pause, NULL);
            early = program_exists(DIR "/so_far.pfm");
        }
        kill(pid, SIGINT);
        program_finish(&r, pid);
        assert_int_equal(early, asks);
        assert_int_equal(r.exit_status, 130);
        bis_image image;
        read_image(&image, DIR "/so_far.pfm");
        assert_int_equal(image.width, 24);
        bis_image_clear(&image);
    }
    program_run_limited(&r, 2000, SCENE " --spp 16 --write-every 1e-6 --outfile " DIR "/too_large.pfm");
    assert_int_equal(r.exit_status, 1);
    assert_non_null(strstr(r.messages, "bis: warning: --write-every wrote nothing, the render goes on\n" DIR
                                       "/too_large.pfm: error: cannot write "));
    program_expect(&r, 0, SCENE " --spp 2 --part 1/2 --write-every 1 --outfile " DIR "/w.bispart");
    assert_non_null(strstr(r.messages, "--write-every has no effect with --part"));
}

static void an_option_without_effect_is_a_warning(void **state)
{
    program_run r;
    program_expect(&r, 0, SCENE " --outfile " DIR "/w.exr --integrator em --candidates 9");
    assert_non_null(strstr(r.messages, "bis: warning: --candidates has no effect on integrator \"em\"\n"));
    program_expect(&r, 0, SCENE " --outfile " DIR "/w.exr --integrator em --candidates 9 --quiet");
    assert_string_equal(r.messages, "");
}

/* Says where the shapes are: a box of 2 x 4 x 4 about (10, 20, 30) lies in a ball of radius 3, which fills the 90
 * degrees of the picture from 3/sin(45 degrees) along (1, 2, 2)/3. The camera stands behind the box and looks away. Up
 * is what is left of z across that: (-2, -4, 5)/sqrt(45). A scale of the world is no other view; its up is shorter.
 * Where there is no ball to fill a picture, no camera is told. */
static void a_black_picture_tells_where_the_shapes_are(void **state)
{
    static const char box[] = "Film \"rgb\" \"integer xresolution\" 2 \"integer yresolution\" 2 %s\n"
        "LookAt 13 26 36  14 28 38  0 0 1 Camera \"%s WorldBegin LightSource \"infinite\" \"bool visible\" false\n"
        "Shape \"trianglemesh\" \"point3 P\" [9 18 28  11 22 28  10 20 32]\n";
    static const char *const cameras[][2] = {{"", "perspective\" \"float fov\" 90"},
        {"Scale 4 4 4", "perspective\" \"float fov\" 90"}, {"", "orthographic\""},
        {"", "perspective\" \"float fov\" 90 \"float screenwindow\" [-1 1 -1 1]"}};
    static const char place[] = "the camera sees no shape, and no light behind them. "
        "They lie in x 9 to 11, y 18 to 22, z 28 to 32";
    char text[1024], camera[256];
    program_run r;
    const double k = 3 / sqrt(0.5), l = sqrt(45);

    for (int i = 0; i < 4; i++) {
        const double up = (i == 1 ? 0.25 : 1) / l;
        snprintf(camera, sizeof camera, "; \"LookAt %.6g %.6g %.6g  10 20 30  %.6g %.6g %.6g\" as all that moves its "
            "Camera sees all of them\n", 10 - k / 3, 20 - 2 * k / 3, 30 - 2 * k / 3, -2 * up, -4 * up, 5 * up);
        snprintf(text, sizeof text, box, cameras[i][0], cameras[i][1]);
        program_write_file(DIR "/away.txt", text);
        program_expect(&r, 0, DIR "/away.txt --spp 1 --outfile " DIR "/away.pfm");
        const char *const at = strstr(r.messages, place);
        assert_non_null(at);
        if (strncmp(at + strlen(place), i < 2 ? camera : "\n", i < 2 ? strlen(camera) : 1) != 0)
            fail_msg("%d: %s", i, r.messages);
    }
    unlink(DIR "/away.txt");
}

/* Light in one channel of the last pixel, beside a wall in front of the first, is light. */
static void one_lit_channel_is_no_black_picture(void **state)
{
    static const char half[] = "Film \"rgb\" \"integer xresolution\" 2 \"integer yresolution\" 1\n"
        "Camera \"orthographic\" WorldBegin LightSource \"infinite\" \"rgb L\" [%d %d %d]\n"
        "Material \"diffuse\" \"rgb reflectance\" [0 0 0] "
        "Shape \"trianglemesh\" \"integer indices\" [0 1 2 0 2 3] \"point3 P\" [-9 -9 5  0 -9 5  0 9 5  -9 9 5]\n";
    char text[1024];
    program_run r;
    bis_image image;

    for (int i = 0; i < 4; i++) {
        snprintf(text, sizeof text, half, i == 0, i == 1, i == 2);
        program_write_file(DIR "/half.txt", text);
        program_expect(&r, 0, DIR "/half.txt --spp 1 --outfile " DIR "/half.pfm");
        assert_int_equal(strstr(r.messages, "the picture is black") != NULL, i == 3);
        read_image(&image, DIR "/half.pfm");
        assert_true(rgb_sum(image.pixels[0]) == 0 && rgb_sum(image.pixels[1]) == (i < 3));
        bis_image_clear(&image);
    }
    unlink(DIR "/half.txt");
}

/* ---- plan ---- */

static void plan_renders_and_writes_nothing(void **state)
{
    program_run r;
    int before = program_count_files(DIR);
    program_expect(&r, 0, "--plan " SCENE);
    assert_non_null(strstr(r.output, "sir"));
    assert_string_equal(r.messages, "");
    assert_int_equal(program_count_files(DIR), before);
}

/* ---- notes and mistakes; more of them stand in tests/data/expect/program ---- */

/* The pixels of an equal-area map have one solid angle, so the integral of r+g+b is 4 pi times their mean, whatever
 * they are; what the resampling changes of it is told in percent. */
static void the_note_on_a_resampled_map_tells_its_energy(void **state)
{
    enum { SIDE = 8 };
    float pixels[SIDE * SIDE][3];
    double sum = 0, before, after, change;
    program_run r;
    for (int i = 0; i < SIDE * SIDE; i++)
        for (int k = 0; k < 3; k++) sum += (double)(pixels[i][k] = (float)((i * 7 + k * 5) % 23) / 4);
    FILE *f = fopen(DIR "/square.pfm", "wb");
    assert_non_null(f);
    fprintf(f, "PF\n%d %d\n-1.0\n", SIDE, SIDE);
    assert_int_equal(fwrite(pixels, sizeof pixels, 1, f), 1);
    fclose(f);
    program_write_file(DIR "/square.txt",
        "Film \"rgb\" \"integer xresolution\" 2 \"integer yresolution\" 2 WorldBegin\n"
        "LightSource \"infinite\" \"string filename\" \"square.pfm\" \"string mapping\" \"equalarea\"\n");
    program_expect(&r, 0, DIR "/square.txt --spp 1 --outfile " DIR "/square.exr");
    const char *note = strstr(r.messages, "integral of r+g+b ");
    assert_non_null(note);
    assert_int_equal(sscanf(note, "integral of r+g+b %lf before, %lf after (%lf%%)", &before, &after, &change), 3);
    assert_true(fabs(before / (4 * PI * sum / (SIDE * SIDE)) - 1) < 1e-5); /* six digits */
    assert_true(fabs(after / before - 1) < 1e-2);
    assert_true(
        fabs(change - 100 * (after - before) / before) < 1e-3 + 100 * 1e-5); /* its own digits, and those of both */
    assert_int_equal(system("rm " DIR "/square.*"), 0);
}

/* One line each, whatever the file holds; a scene that is none of these is still read. */
static void what_is_no_scene_gets_one_line(void **state)
{
    const struct { const char *name, *bytes, *what; } cases[] = {
        {"a.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n", "a Radiance map"},
        {"scene", "#?RGBE\n", "a Radiance map"},
        {"a.exr", "\x76\x2f\x31\x01", "an OpenEXR image"},
        {"a.ply", "ply\nformat ascii 1.0\n", "a PLY mesh"},
        {"a.png", "\x89PNG\r\n", "a PNG picture"},
        {"a.txt", "<scene version=\"3\"></scene>", "a page or scene in XML or HTML"},
        {"a.json", "{}", "a file in JSON"},
        {"a.obj", "v 0 0 0\n", "a Wavefront mesh"},
        {"a.MD", "# Title\n\nWords, one after the other.\n", "a page in Markdown"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        program_run r;
        char path[128], expected[256];
        snprintf(path, sizeof path, DIR "/%s", cases[i].name);
        program_write_file(path, cases[i].bytes);
        program_expect(&r, 2, "%s", path);
        snprintf(expected, sizeof expected, "%s: error: this is %s, no scene: ", path, cases[i].what);
        assert_ptr_equal(strstr(r.messages, expected), r.messages);
        assert_null(strchr(strchr(r.messages, '\n') + 1, '\n'));
    }
    program_run r;
    program_write_file(DIR "/includes.txt", "Include \"a.ply\"\nWorldBegin\n");
    program_expect(&r, 2, DIR "/includes.txt");
    assert_non_null(strstr(r.messages, "includes.txt:1:9: error: \"" DIR "/a.ply\" is a PLY mesh, no part of a "
        "scene: a scene names it in Shape"));
    program_write_file(DIR "/comment.txt", "#? is this a scene?\n");
    program_expect(&r, 2, DIR "/comment.txt");
    assert_non_null(strstr(r.messages, "the scene has no WorldBegin"));
    assert_int_equal(system("rm " DIR "/a.* " DIR "/scene " DIR "/includes.txt " DIR "/comment.txt"), 0);
}

/* The scene with these lines in the place of its Sampler and Integrator, rendered to DIR/NAME.pfm. */
static void render_with(const char *name, const char *sampler, const char *integrator, const char *options)
{
    program_run r;
    char command[1024];

    snprintf(command, sizeof command,
             "sed -e 's/^Sampler.*/%s/' -e 's/^Integrator.*/%s/' " SCENE " > " DIR "/%s.txt", sampler, integrator,
             name);
    assert_int_equal(system(command), 0);
    program_expect(&r, 0, DIR "/%s.txt --outfile " DIR "/%s.pfm %s", name, name, options);
    program_expect_only_the_result(&r);
}

#define SAMPLER(kind, edges) \
    "Sampler \"" kind "\" \"integer pixelsamples\" 16 \"integer seed\" 0 \"integer edgesamples\" " edges " \"float " \
    "edgelight\" 0.25"
#define SIR(proposal, M, N, learn) \
    "Integrator \"sir\" \"string proposal\" \"" proposal "\" \"integer candidates\" " M \
    " \"integer shadowrays\" " N " \"bool learn\" " learn
#define USUAL_SAMPLER SAMPLER("sobol", "8")
#define USUAL SIR("product", "64", "24", "true")
#define THESIS SIR("mix", "800", "15", "false")
#define EM "Integrator \"em\" \"integer samples\" 16 \"bool stratify\" false"
#define SIR_9 "Integrator \"sir\" \"integer candidates\" 9"

/* What a scene leaves out, and what it could have written, are the same bits; each of the two lines alone, too; and
 * where the command line names the integrator. The twins: another line makes another picture. */
static void what_a_scene_leaves_out_is_what_it_could_have_written(void **state)
{
    static const struct {
        const char *sampler, *integrator, *options;          /* as given */
        const char *full_sampler, *full_integrator;          /* written out */
        const char *other_sampler, *other_integrator;        /* a twin */
    } cases[] = {
        {"", "", "", USUAL_SAMPLER, USUAL, SAMPLER("stratified", "4"), USUAL},
        {"", "", "", USUAL_SAMPLER, USUAL, SAMPLER("sobol", "1"), USUAL},
        {"", "", "", USUAL_SAMPLER, USUAL, USUAL_SAMPLER, THESIS},
        {"Sampler \"stratified\"", "", "", SAMPLER("stratified", "1"), USUAL, SAMPLER("stratified", "4"), USUAL},
        {"Sampler \"sobol\"", "", "", SAMPLER("sobol", "1"), USUAL, USUAL_SAMPLER, USUAL},
        {"", "Integrator \"sir\"", "", USUAL_SAMPLER, THESIS, USUAL_SAMPLER, USUAL},
        {"", "Integrator \"em\"", "", USUAL_SAMPLER, EM, SAMPLER("sobol", "1"), EM},
        {"", "", "--candidates 100", USUAL_SAMPLER, SIR("product", "100", "24", "true"), USUAL_SAMPLER, USUAL},
        {"", "", "--integrator sir", USUAL_SAMPLER, THESIS, USUAL_SAMPLER, USUAL},
        {"", "", "--integrator em", USUAL_SAMPLER, EM, SAMPLER("stratified", "1"), EM},
        {"", SIR_9, "--integrator sir", USUAL_SAMPLER, SIR("mix", "9", "15", "false"), USUAL_SAMPLER, THESIS},
    };

    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        render_with("given", cases[i].sampler, cases[i].integrator, cases[i].options);
        render_with("full", cases[i].full_sampler, cases[i].full_integrator, "");
        render_with("other", cases[i].other_sampler, cases[i].other_integrator, "");
        if (system("cmp -s " DIR "/given.pfm " DIR "/full.pfm") != 0) fail_msg("%zu: other bits than written out", i);
        if (system("cmp -s " DIR "/given.pfm " DIR "/other.pfm") == 0) fail_msg("%zu: the twin has the same bits", i);
    }
    assert_int_equal(system("cd " DIR " && rm given.* full.* other.*"), 0);
}

/* --learn is the scene's "bool learn": the same bits; it says where it can have no effect. */
static void learn_is_an_option(void **state)
{
    program_run r;
    assert_int_equal(system("sed 's/^Integrator.*/& \"string proposal\" \"product\"/' " SCENE " > " DIR "/plain.txt && "
                            "sed 's/^Integrator.*/& \"bool learn\" true/' " DIR "/plain.txt > " DIR "/learns.txt"), 0);
    program_expect(&r, 0, DIR "/learns.txt --outfile " DIR "/l1.pfm");
    program_expect(&r, 0, DIR "/plain.txt --learn on --outfile " DIR "/l2.pfm");
    program_expect_only_the_result(&r);
    program_expect(&r, 0, DIR "/plain.txt --outfile " DIR "/l3.pfm");
    program_expect(&r, 0, DIR "/learns.txt --learn off --outfile " DIR "/l4.pfm");
    assert_int_equal(system("cmp " DIR "/l1.pfm " DIR "/l2.pfm && cmp " DIR "/l3.pfm " DIR "/l4.pfm && ! cmp -s "
                            DIR "/l1.pfm " DIR "/l3.pfm"), 0);
    program_expect(&r, 0, SCENE " --integrator sir --learn on --spp 1 --outfile " DIR "/l1.pfm");
    assert_non_null(strstr(r.messages, "--learn has no effect on proposal \"mix\", only on \"product\""));
    program_expect(&r, 0, SCENE " --integrator em --learn on --spp 1 --outfile " DIR "/l1.pfm");
    assert_non_null(strstr(r.messages, "--learn has no effect on integrator \"em\""));
    assert_int_equal(system("rm " DIR "/l?.pfm " DIR "/learns.txt " DIR "/plain.txt"), 0);
}

/* The limit of 1024 bytes a file is what a full disk looks like to write(). Every picture is larger, and LLVM's OpenMP
 * needs that much in a file of its own. */
static void a_full_disk_keeps_the_older_file_and_leaves_no_other(void **state)
{
    const char *const endings[] = {"exr", "pfm", "hdr", "png"};
    for (int i = 0; i < 4; i++) {
        program_run r;
        char path[64], arguments[256], text[64] = "";
        snprintf(path, sizeof path, DIR "/kept.%s", endings[i]);
        program_write_file(path, "an older picture");
        int before = program_count_files(DIR);
        snprintf(arguments, sizeof arguments, SCENE " --resolution 48x32 --outfile %s", path);
        program_run_limited(&r, 1024, arguments);
        assert_int_equal(r.exit_status, 1);
        assert_non_null(strstr(r.messages, path));
        read_text(text, sizeof text, path);
        assert_string_equal(text, "an older picture");
        assert_int_equal(program_count_files(DIR), before);
    }
}

static void one_file_that_fails_does_not_lose_the_others(void **state)
{
    program_run r;
    /* 24 x 16 pixels: 4.6 kB as PFM, under 2 kB as PNG. */
    program_run_limited(&r, 2000, SCENE " --spp 1 --outfile " DIR "/lost.pfm --outfile " DIR "/saved.png");
    assert_int_equal(r.exit_status, 1);
    assert_false(program_exists(DIR "/lost.pfm"));
    assert_true(program_exists(DIR "/saved.png"));
}

/* Found before the work: the scene, which does not exist, is not even looked for. */
static void an_output_that_cannot_be_is_refused_before_the_scene_is_read(void **state)
{
    program_run r;
    symlink("no/such/folder.exr", DIR "/astray.exr");
    program_expect(&r, 1, DIR "/nosuch.txt --outfile " DIR "/astray.exr");
    assert_non_null(strstr(r.messages, "No such file or directory"));
    assert_null(strstr(r.messages, "nosuch"));
    program_expect(&r, 1, DIR "/nosuch.txt --outfile " DIR "/%0300d.exr", 0);
    assert_non_null(strstr(r.messages, "File name too long"));
    assert_null(strstr(r.messages, "nosuch"));
    program_expect(&r, 1, DIR "/nosuch.txt --stats " DIR "/%0300d.json --outfile " DIR "/x.exr", 0);
    assert_non_null(strstr(r.messages, "File name too long"));
    unlink(DIR "/astray.exr");
}

static void copy(const char *to, const char *from)
{
    char bytes[1 << 14];
    FILE *in = fopen(from, "rb"), *out = fopen(to, "wb");
    assert_true(in && out);
    const size_t n = fread(bytes, 1, sizeof bytes, in);
    assert_true(n > 0 && n < sizeof bytes);
    assert_int_equal(fwrite(bytes, 1, n, out), n);
    fclose(in);
    assert_int_equal(fclose(out), 0);
}

#define OVER DIR "/over"

/* Every file that a command reads, under every name that it goes by; and one output under two names. */
static void what_is_read_is_never_written_over(void **state)
{
    static const char *const files[] = {"scene.txt", "part.txt", "map.pfm", "ball.ply", "a.pfm", "b.pfm"};
    const struct { const char *arguments, *names[2]; } cases[] = {
        {OVER "/scene.txt --stats " OVER "/scene.txt", {"scene.txt", "scene.txt"}},
        {OVER "/scene.txt --stats " OVER "/hard.txt", {"hard.txt", "scene.txt"}},
        {OVER "/scene.txt --outfile " OVER "/map.pfm", {"map.pfm", "map.pfm"}},
        {OVER "/scene.txt --outfile " OVER "/soft.pfm", {"soft.pfm", "map.pfm"}},
        {OVER "/scene.txt --outfile " OVER "/../over/map.pfm", {"over/../over/map.pfm", "over/map.pfm"}},
        {OVER "/scene.txt --stats " OVER "/part.txt --outfile " OVER "/x.pfm", {"part.txt", "part.txt"}},
        {OVER "/scene.txt --stats " OVER "/ball.ply --outfile " OVER "/x.pfm", {"ball.ply", "ball.ply"}},
        {OVER "/scene.txt --outfile " OVER "/x.pfm --stats " OVER "/x.pfm", {"x.pfm", "x.pfm"}},
        {OVER "/scene.txt --outfile " OVER "/x.pfm --outfile " OVER "/./x.pfm", {"over/x.pfm", "over/./x.pfm"}},
        {OVER "/scene.txt --stats " OVER "/film.exr", {"film.exr", "film.exr"}},
        {"compare " OVER "/a.pfm " OVER "/b.pfm --diff " OVER "/a.pfm", {"a.pfm", "a.pfm"}},
        {"compare " OVER "/a.pfm " OVER "/b.pfm --diff " OVER "/b.pfm", {"b.pfm", "b.pfm"}},
        {"envmap " OVER "/sky-map.pfm --out " OVER "/sky.pfm", {"sky-map.pfm", "sky-map.pfm"}},
    };
    program_folder(OVER);
    program_write_scene(OVER, "");
    copy(OVER "/part.txt", OVER "/scene.txt");
    program_write_file(OVER "/scene.txt", "Include \"part.txt\"\nShape \"plymesh\" \"string filename\" \"ball.ply\"\n");
    program_write_file(OVER "/ball.ply",
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 1\n1 0 1\n0 1 1\n3 0 1 2\n");
    copy(OVER "/a.pfm", OVER "/map.pfm");
    copy(OVER "/b.pfm", OVER "/map.pfm");
    copy(OVER "/sky-map.pfm", OVER "/map.pfm");
    assert_int_equal(symlink("map.pfm", OVER "/soft.pfm"), 0);
    assert_int_equal(link(OVER "/scene.txt", OVER "/hard.txt"), 0);
    program_folder(OVER "2");
    for (size_t k = 0; k < sizeof files / sizeof *files; k++) {
        char from[64], to[64];
        snprintf(from, sizeof from, OVER "/%s", files[k]);
        snprintf(to, sizeof to, OVER "2/%s", files[k]);
        copy(to, from);
    }
    const int before = program_count_files(OVER);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        program_run r;
        program_expect(&r, 2, "%s", cases[i].arguments);
        const char *first = strstr(r.messages, cases[i].names[0]);
        if (!first || !strstr(first + 1, cases[i].names[1]))
            fail_msg("bis %s: says %s", cases[i].arguments, r.messages);
        assert_int_equal(program_count_files(OVER), before);
        for (size_t k = 0; k < sizeof files / sizeof *files; k++) {
            char now[64], then[64];
            snprintf(now, sizeof now, OVER "/%s", files[k]);
            snprintf(then, sizeof then, OVER "2/%s", files[k]);
            assert_same_file(now, then);
        }
    }
    program_run r;
    program_expect(&r, 0, OVER "/scene.txt --outfile " OVER "/x.pfm --stats /dev/null");
}

/* SIGKILL, 40 times, spread over a whole run that does little but write. The outputs are new each time, so that they
 * appear by one step. */
static void killed_at_any_moment_it_leaves_no_litter(void **state)
{
    static const char arguments[] = DIR "/empty.txt --quiet --spp 1 --nthreads 1 --outfile " DIR
                                        "/killed/a.exr --outfile " DIR "/killed/a.png --outfile " DIR "/killed/b.exr";
    struct timespec start, end;
    program_run r;

    program_write_file(DIR "/empty.txt", "Film \"rgb\" \"integer xresolution\" 200 \"integer yresolution\" 150\n"
                       "WorldBegin LightSource \"infinite\" \"string filename\" \"map.pfm\"\n");
    program_folder(DIR "/killed");
    const int probe = open(DIR "/killed", O_TMPFILE | O_WRONLY, 0600);
    if (probe < 0) skip(); /* a file system without unnamed files */
    close(probe);
    clock_gettime(CLOCK_MONOTONIC, &start);
    program_expect(&r, 0, "%s", arguments);
    clock_gettime(CLOCK_MONOTONIC, &end);
    const double whole = (double)(end.tv_sec - start.tv_sec) + 1e-9 * (double)(end.tv_nsec - start.tv_nsec);
    for (int i = 0; i < 40; i++) {
        const double wait = whole * i / 40;
        const struct timespec pause = {(time_t)wait, (long)(1e9 * fmod(wait, 1))};
        program_folder(DIR "/killed");
        const pid_t pid = program_start(arguments);
        nanosleep(&pause, NULL);
        kill(pid, SIGKILL);
        program_finish(&r, pid);
        int n = program_exists(DIR "/killed/a.exr") + program_exists(DIR "/killed/a.png") +
                program_exists(DIR "/killed/b.exr");
        assert_int_equal(program_count_files(DIR "/killed"), n);
    }
}

/* ---- interruption ---- */

/* A signal after the first pass is complete. How long that takes nobody knows: each try waits twice as long. */
static void interrupt(program_run *r, int number, const char *arguments)
{
    for (long wait = 10000000; wait < 100000000000; wait *= 2) {
        const struct timespec pause = {wait / 1000000000, wait % 1000000000};
        const pid_t pid = program_start(arguments);
        program_wait_for_handler(pid, number);
        nanosleep(&pause, NULL);
        assert_int_equal(kill(pid, number), 0);
        program_finish(r, pid);
        assert_int_equal(r->exit_status, 130);
        if (strstr(r->messages, "interrupted after ")) return;
    }
    fail_msg("not a pass in two minutes");
}

/* An error that takes more than ten minutes, and no other budget: a signal ends it. Each try waits twice as long. */
static void an_error_that_takes_long_is_for_a_signal_to_end(void **state)
{
    program_run r;
    for (long wait = 100000000; wait < 100000000000; wait *= 2) {
        const struct timespec pause = {wait / 1000000000, wait % 1000000000};
        const pid_t pid = program_start(SCENE " --error 1e-7 --outfile " DIR "/long.exr");
        program_wait_for_handler(pid, SIGINT);
        nanosleep(&pause, NULL);
        assert_int_equal(kill(pid, SIGINT), 0);
        program_finish(&r, pid);
        assert_int_equal(r.exit_status, 130);
        const char *const said = strstr(r.messages, "bis: warning: --error 1e-07 would take about ");
        if (!said) continue;
        assert_non_null(strstr(said, " camera samples a pixel; Ctrl-C ends it earlier and writes what is done (the "
                                     "error is at most "));
        return;
    }
    fail_msg("no forecast in two minutes");
}

static void a_signal_ends_the_render_and_writes_the_picture(void **state)
{
    const int signals[] = {SIGINT, SIGTERM, SIGHUP};
    for (int i = 0; i < 3; i++) {
        program_run r;
        char value[64];
        unlink(DIR "/stopped.exr");
        interrupt(&r, signals[i], SCENE " --spp 1000000000 --outfile " DIR "/stopped.exr --stats -");
        assert_string_equal(json_value(value, sizeof value, r.output, "interrupted"), "true");
        assert_int_equal(strncmp(r.messages, "bis: interrupted after ", 23), 0);
        assert_non_null(strstr(r.messages, "; wrote " DIR "/stopped.exr: 24 x 16 pixels, "));
        bis_image image;
        read_image(&image, DIR "/stopped.exr");
        assert_int_equal(image.width, 24);
        bis_image_clear(&image);
    }
}

/* A long pass: 512 x 256 patches a pixel in `exact`. A black picture is worth less than the older one. */
static void a_signal_in_the_first_pass_keeps_the_older_files(void **state)
{
    program_run r;
    char text[64] = "";
    program_write_file(DIR "/long.txt",
        "Integrator \"exact\" \"integer perpatch\" 100\nWorldBegin LightSource \"infinite\" "
        "Translate 0 0 3 Shape \"sphere\" \"float radius\" 5\n");
    program_write_file(DIR "/first.exr", "an older picture");
    for (int quiet = 0; quiet < 2; quiet++) {
        const pid_t pid = program_start(quiet ? DIR "/long.txt --quiet --resolution 400x400 --outfile " DIR
                                                    "/first.exr --outfile " DIR "/first.png --stats " DIR "/first.json"
                                              : DIR "/long.txt --resolution 400x400 --outfile " DIR
                                                    "/first.exr --outfile " DIR "/first.png --stats -");
        program_wait_for_handler(pid, SIGINT);
        assert_int_equal(kill(pid, SIGINT), 0);
        program_finish(&r, pid);
        assert_int_equal(r.exit_status, 130);
        assert_string_equal(r.output, "");
        assert_string_equal(r.messages, "bis: interrupted before the first pass was complete: nothing was written\n");
        read_text(text, sizeof text, DIR "/first.exr");
        assert_string_equal(text, "an older picture");
        assert_false(program_exists(DIR "/first.png"));
        assert_false(program_exists(DIR "/first.json"));
    }
}

/* The figures again from --stats; quiet says nothing, and so does a picture that could not be written. */
static void a_render_ends_with_one_line_about_what_was_written(void **state)
{
    const struct { const char *options, *passes; } cases[] = {
        {"--resolution 192x128 --spp 9", "9 camera samples a pixel in 5 passes, "},
        {"--spp 9", "9 camera samples a pixel in 5 passes, "}, {"--spp 1", "1 camera sample a pixel in 1 pass, "},
        {"--resolution 192x128 --spp 8 --cropwindow 0,0.75,0,1", "8 camera samples a pixel in 4 passes, "},
    };
    for (int i = 0; i < 4; i++) {
        program_run r;
        char expected[256], error[64], width[64], height[64], value[64];
        program_expect(&r, 0, SCENE " %s --stats - --outfile " DIR "/m.pfm --outfile " DIR "/l.exr --outfile " DIR
                       "/l.png", cases[i].options);
        program_expect_only_the_result(&r);
        json_value(width, sizeof width, r.output, "width");
        json_value(height, sizeof height, r.output, "height");
        snprintf(expected, sizeof expected, "bis: wrote " DIR "/m.pfm, " DIR "/l.exr, " DIR "/l.png: %s x %s pixels, "
                 "%s", width, height, cases[i].passes);
        assert_int_equal(strncmp(r.messages, expected, strlen(expected)), 0);
        json_value(value, sizeof value, r.output, "estimated_relative_rmse");
        const double percent = 100 * strtod(value, NULL);
        if (strstr(cases[i].passes, "in 1 pass,"))
            snprintf(error, sizeof error, "s, error unknown: one pass is too few; exposure ");
        else if (i == 1) snprintf(error, sizeof error, "s, error at most ");
        else
            snprintf(error, sizeof error,
                     percent < 9.95 ? "s, error about %.2g%%; exposure " : "s, error about %.0f%%; exposure ", percent);
        assert_non_null(strstr(r.messages, error));
        if (i < 3) { /* with it, the picture of the EXR is the PNG but for rounding; a crop has another size */
            program_run other;
            const char *exposure = strstr(r.messages, "; exposure ") + strlen("; exposure ");
            program_expect(&other, 0, "convert " DIR "/l.exr " DIR "/again.png --exposure %.*s",
                           (int)strcspn(exposure, "\n"), exposure);
            program_expect(&other, 0, "compare --tolerance 1e-3 " DIR "/again.png " DIR "/l.png");
        }
        program_expect(&r, 0, SCENE " --quiet %s --outfile " DIR "/l.exr", cases[i].options);
        assert_string_equal(r.messages, "");
    }
}

/* Not one pixel can be compared: relmse is NaN, which is within no tolerance. */
static void nothing_to_compare_is_no_success(void **state)
{
    program_run r;
    char value[64];
    bis_image image;
    assert_int_equal(bis_image_init(&image, 3, 2, NULL), BIS_OK);
    for (int i = 0; i < 6; i++) image.pixels[i] = (rgb){NAN, 1, 1};
    assert_int_equal(bis_image_save(&image, DIR "/nan.pfm", NULL), BIS_OK);
    bis_image_clear(&image);
    program_expect(&r, 1, "compare --json --tolerance 1e300 " DIR "/nan.pfm " DIR "/nan.pfm");
    assert_string_equal(json_value(value, sizeof value, r.output, "relmse"), "null");
    assert_string_equal(json_value(value, sizeof value, r.output, "nonfinite"), "6");
    assert_string_equal(json_value(value, sizeof value, r.output, "pixels"), "0");
}

/* OpenMP tells the size of each team that it forms: GNU's on standard error, LLVM's on standard output. A map, a mesh,
 * both accelerators, all with N threads where the system's default is another number. */
static void nthreads_holds_for_everything(void **state)
{
    static const char *const accelerators[] = {"grid", "embree"};
    program_run r;
    int n_teams = 0;

    setenv("OMP_DISPLAY_AFFINITY", "true", 1);
    setenv("OMP_AFFINITY_FORMAT", "a team of %N", 1);
    setenv("OMP_NUM_THREADS", "5", 1);
    for (int a = 0; a < (bis_accel_embree_version() ? 2 : 1); a++) {
        program_expect(&r, 0, SCENE " --nthreads 3 --accelerator %s --outfile " DIR "/n.exr", accelerators[a]);
        for (int i = 0; i < 2; i++) {
            const char *at = i ? r.output : r.messages;
            for (; (at = strstr(at, "a team of ")); at++, n_teams++) assert_int_equal(atoi(at + 10), 3);
        }
    }
#ifdef _OPENMP
    assert_true(n_teams > 0);
#endif
    unsetenv("OMP_DISPLAY_AFFINITY");
    unsetenv("OMP_AFFINITY_FORMAT");
    unsetenv("OMP_NUM_THREADS");
}

/* More of it: tests/cli/test_options.c. */
static void compare_refuses_other_sizes_and_a_folder_that_is_not_there(void **state)
{
    program_run r;
    program_expect(&r, 0, SCENE " --outfile " DIR "/ca.exr");
    program_expect(&r, 0, SCENE " --outfile " DIR "/cc.exr --resolution 5x5");
    program_expect(&r, 2, "compare " DIR "/ca.exr " DIR "/cc.exr");
    assert_string_equal(r.output, "");
    assert_int_equal(strncmp(r.messages, "bis: error: images of ", 22), 0);
    program_expect(&r, 1, "compare --diff " DIR "/no/d.png " DIR "/ca.exr " DIR "/ca.exr");
    program_expect(&r, 0, "compare --tolerance 0 " DIR "/ca.exr " DIR "/ca.exr");
}

/* The scenes of pbrt that we ship: what is replaced stands on the terminal, in --stats, in the EXR and in the plan; and
 * without --approximate they are refused. */
static void what_is_approximated_is_said_everywhere(void **state)
{
    static const char *const names[] = {"v2", "v3", "v4"};
    static const char *const said[] = {"1 x AreaLightSource (of 3 lights): its light is missing",
        "2 x ActiveTransform: nothing moves", "1 x Material \"mix\" (of 8 materials): one material"};
    program_run r;
    for (int i = 0; i < 3; i++) {
        char word[100];
        program_expect(&r, 2, "data/scenes/pbrt/approximate-%s.pbrt --outfile " DIR "/no.exr", names[i]);
        assert_non_null(strstr(r.messages, "; with --approximate: "));
        program_expect(&r, 0,
            "--approximate data/scenes/pbrt/approximate-%s.pbrt --resolution 12x8 --spp 1 --outfile " DIR
            "/a.exr --stats -",
            names[i]);
        snprintf(word, sizeof word, "warning: approximated: %s", said[i]);
        assert_non_null(strstr(r.messages, word));
        assert_non_null(strstr(r.output, "\"approximated\": ["));
        size_t size;
        unsigned char *exr = read_bytes(DIR "/a.exr", &size);
        assert_true(memmem(exr, size, "bis:approximated", 16) && memmem(exr, size, said[i], strlen(said[i])));
        bis_free(exr);
        program_expect(&r, 0, "--plan --approximate data/scenes/pbrt/approximate-%s.pbrt", names[i]);
        snprintf(word, sizeof word, "approximated %s", said[i]);
        assert_non_null(strstr(r.output, word));
    }
    program_expect(
        &r, 0, SCENE " --approximate --stats - --outfile " DIR "/a.exr"); /* nothing to replace: nothing said */
    assert_true(!strstr(r.output, "approximated") && !strstr(r.messages, "approximated"));
}

/* Each reads the scene in the same way, but only the first two have time to do something with it. */
static void every_command_that_reads_a_scene_approximates(void **state)
{
    static const char film[] =
        "Film \"rgb\" \"integer xresolution\" 8 \"integer yresolution\" 8 LookAt 0 0 0 0 1 0 0 0 1\n"
        "WorldBegin LightSource \"infinite\" Material \"hair\" Shape \"sphere\" \"float gleam\" 1\n",
                      mesh[] = "Shape \"plymesh\" \"string filename\" \"no.ply\"\n";
    static const char *const hair = "Material \"hair\"", *const gleam = "unknown parameter \"gleam\" of Shape "
                                                                          "\"sphere\"; with --approximate: ignored";
    static const char *const commands[] = {"verify %s " DIR "/hair.txt",
        "pixel %s --repeats 2 --output " DIR "/p " DIR "/hair.txt 4 4", "verify %s " DIR "/lost.txt",
        "pixel %s " DIR "/lost.txt 4 4", "trade --quiet %s --output " DIR "/t " DIR "/lost.txt"};
    program_run r;
    FILE *f = fopen(DIR "/hair.txt", "w"), *g = fopen(DIR "/lost.txt", "w");
    fprintf(f, "%s", film);
    fprintf(g, "%s%s", film, mesh);
    assert_true(fclose(f) == 0 && fclose(g) == 0);
    for (int i = 0; i < 5; i++) {
        char line[300];
        snprintf(line, sizeof line, commands[i], "");
        program_expect(&r, 2, "%s", line);
        assert_true(strstr(r.messages, hair) && strstr(r.messages, gleam));
        snprintf(line, sizeof line, commands[i], "--approximate");
        program_expect(&r, i < 2 ? 0 : 2, "%s", line); /* no.ply is looked for first */
        assert_true(i < 2 || strstr(r.messages, "no.ply"));
        assert_true(strstr(line, "--quiet") || strstr(r.messages, "approximated: 1 x Material \"hair\""));
    }
}

/* --light on a scene with lights of its own gives the picture of a scene that names the map, turned and scaled. */
static void another_light_may_be_put_over_any_scene(void **state)
{
    static const char head[] = "Film \"rgb\" \"integer xresolution\" 16 \"integer yresolution\" 12 LookAt 0 -5 2 0 0 0 "
                               "0 0 1 Camera \"perspective\" \"float fov\" 40\n"
                               "WorldBegin\n",
                      shapes[] = "Shape \"sphere\" Shape \"disk\" \"float radius\" 4 \"float height\" -1\n";
    static const char *const lights[] = {
        "LightSource \"point\" LightSource \"infinite\" \"string filename\" \"gone.exr\" AreaLightSource \"diffuse\" "
        "\"rgb L\" [1 1 1]\n",
        "AttributeBegin Rotate 30 0 0 1 LightSource \"infinite\" \"string filename\" \"data/maps/outdoor.hdr\" \"float "
        "scale\" 2 AttributeEnd\n"};
    program_run r;
    for (int i = 0; i < 2; i++) {
        FILE *f = fopen(i ? DIR "/named.txt" : DIR "/other.txt", "w");
        fprintf(f, "%s%s%s", head, lights[i], shapes);
        assert_int_equal(fclose(f), 0);
    }
    program_expect(&r, 0,
        DIR "/other.txt --light data/maps/outdoor.hdr --light-rotate 30 --light-scale 2 --spp 2 --outfile " DIR
            "/other.pfm");
    program_expect(&r, 0, DIR "/named.txt --spp 2 --outfile " DIR "/named.pfm");
    assert_same_file(DIR "/other.pfm", DIR "/named.pfm");
    program_expect(&r, 0, DIR "/other.txt --plan --light data/maps/outdoor.hdr");
    assert_non_null(strstr(r.output, "light        map data/maps/outdoor.hdr, latlong, "));
    program_expect(&r, 2, DIR "/named.txt --plan --light-scale 2");
    assert_non_null(strstr(r.messages, "--light-rotate, --light-scale and --light-mapping are about the map that "
                                       "--light names: give --light MAP, too"));
    program_expect(&r, 2, DIR "/named.txt --plan --light-mapping latlong");
    /* another mapping, and a map that is higher than wide: a cross, which nothing says is one */
    program_expect(
        &r, 0, DIR "/other.txt --spp 1 --light data/maps/clouds_verticalcross.hdr.gz --outfile " DIR "/other.pfm");
    assert_non_null(strstr(r.messages, "higher than wide, and is taken for a lat-long map all the same"));
    assert_non_null(strstr(r.messages, "(--light-mapping)"));
    program_expect(&r, 0,
        DIR "/other.txt --spp 1 --light data/maps/clouds_verticalcross.hdr.gz --light-mapping verticalcross "
            "--outfile " DIR "/other.pfm");
    assert_null(strstr(r.messages, "higher than wide"));
    program_expect(
        &r, 0, "--approximate " DIR "/other.txt --spp 1 --light data/maps/outdoor.hdr --outfile " DIR "/other.pfm");
    assert_null(strstr(r.messages, "approximated"));
}

/* The program's standard input is a pipe that holds text[size], at most the 4096 bytes that each pipe has room for. */
static void run_on(program_run *r, int exit_status, const char *text, size_t size, const char *arguments)
{
    const int input = dup(STDIN_FILENO);
    int ends[2];

    assert_true(size <= 4096 && pipe(ends) == 0);
    assert_int_equal(write(ends[1], text, size), size);
    close(ends[1]);
    assert_int_equal(dup2(ends[0], STDIN_FILENO), STDIN_FILENO);
    close(ends[0]);
    program_expect(r, exit_status, "%s", arguments);
    dup2(input, STDIN_FILENO);
    close(input);
}

/* The scene of the file, whose map is named as seen from here: the same picture, and the same figures. */
static void a_pipe_is_read_where_that_is_asked_for(void **state)
{
    program_run r;
    unsigned char *file;
    size_t size;
    char text[4096], *map;
    bis_image a, b;

    assert_int_equal(bis_file_read(&file, &size, SCENE, (bis_loc){0}, NULL), BIS_OK);
    assert_non_null(map = strstr((char *)file, "map.pfm"));
    snprintf(text, sizeof text, "%.*s" DIR "/%s", (int)(map - (char *)file), (char *)file, map);
    bis_free(file);
    program_expect(&r, 0, SCENE " --outfile " DIR "/file.pfm");
    run_on(&r, 0, text, strlen(text), "--outfile " DIR "/pipe.pfm -");
    read_image(&a, DIR "/file.pfm");
    read_image(&b, DIR "/pipe.pfm");
    assert_memory_equal(a.pixels, b.pixels, (size_t)a.width * (size_t)a.height * sizeof *a.pixels);
    bis_image_clear(&a);
    bis_image_clear(&b);
    run_on(&r, 0, text, strlen(text), "pixel - 12 8 --output " DIR "/pixel");
    assert_non_null(strstr(r.output, "(12, 8) of 24 x 16, <stdin>\n"));
    run_on(&r, 0, text, strlen(text), "verify -");
    assert_non_null(strstr(r.output, "\npassed\n"));

    run_on(&r, 2, "WorldBegin\nShape \"cube\"", 23, "-");
    assert_non_null(strstr(r.messages, "<stdin>:2:7: error: "));
    run_on(&r, 2, "WorldBegin\0", 11, "-");
    assert_string_equal(r.messages, "<stdin>: error: byte 11 is 0: a scene is text\n");
    run_on(&r, 2, text, strlen(text), "trade -");
    assert_non_null(strstr(r.messages, "give a file, not -"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_command_that_reads_a_scene_approximates),
        cmocka_unit_test(what_is_approximated_is_said_everywhere),
        cmocka_unit_test(another_light_may_be_put_over_any_scene),
        cmocka_unit_test(a_scene_renders_to_the_file_it_names),
        cmocka_unit_test(the_word_render_may_be_left_out_and_the_seed_decides),
        cmocka_unit_test(every_format_holds_the_same_picture),
        cmocka_unit_test(exposure_makes_a_png_brighter),
        cmocka_unit_test(an_exr_says_how_it_was_made_E39),
        cmocka_unit_test(an_exr_has_float_channels_and_alpha_where_its_background_is_transparent),
        cmocka_unit_test(layers_are_further_channels_of_an_exr_alone),
        cmocka_unit_test(an_error_out_of_reach_is_said_early_and_loses_nothing),
        cmocka_unit_test(on_a_terminal_a_line_tells_how_far_it_is),
        cmocka_unit_test(a_crop_keeps_the_display_window_and_the_pixels),
        cmocka_unit_test(stats_are_json_with_exactly_the_keys_of_the_contract),
        cmocka_unit_test(stats_in_a_file_are_those_of_standard_output),
        cmocka_unit_test(without_jitter_a_picture_of_one_colour_has_no_scatter),
        cmocka_unit_test(a_time_budget_renders_for_a_while_and_says_how_much),
        cmocka_unit_test(write_every_writes_the_picture_while_it_is_rendered),
        cmocka_unit_test(an_option_without_effect_is_a_warning),
        cmocka_unit_test(a_black_picture_tells_where_the_shapes_are),
        cmocka_unit_test(one_lit_channel_is_no_black_picture),
        cmocka_unit_test(plan_renders_and_writes_nothing),
        cmocka_unit_test(a_pipe_is_read_where_that_is_asked_for),
        cmocka_unit_test(the_note_on_a_resampled_map_tells_its_energy),
        cmocka_unit_test(what_is_no_scene_gets_one_line),
        cmocka_unit_test(what_a_scene_leaves_out_is_what_it_could_have_written),
        cmocka_unit_test(learn_is_an_option),
        cmocka_unit_test(a_full_disk_keeps_the_older_file_and_leaves_no_other),
        cmocka_unit_test(an_output_that_cannot_be_is_refused_before_the_scene_is_read),
        cmocka_unit_test(what_is_read_is_never_written_over),
        cmocka_unit_test(killed_at_any_moment_it_leaves_no_litter),
        cmocka_unit_test(one_file_that_fails_does_not_lose_the_others),
        cmocka_unit_test(an_error_that_takes_long_is_for_a_signal_to_end),
        cmocka_unit_test(a_signal_ends_the_render_and_writes_the_picture),
        cmocka_unit_test(a_signal_in_the_first_pass_keeps_the_older_files),
        cmocka_unit_test(a_render_ends_with_one_line_about_what_was_written),
        cmocka_unit_test(nothing_to_compare_is_no_success),
        cmocka_unit_test(nthreads_holds_for_everything),
        cmocka_unit_test(compare_refuses_other_sizes_and_a_folder_that_is_not_there),
    };
    static const expect_text texts[] = {{"end", "\n"}, {"scene", ALONE "/scene.txt"}, {"folder", ALONE}, {NULL, NULL}};
    return expect_run("program", tests, sizeof tests / sizeof *tests, setup, NULL,
                      &(expect_folder){"tests/data/expect/program", NULL, texts});
}
