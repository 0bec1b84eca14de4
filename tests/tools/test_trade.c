/* SPDX-License-Identifier: BSD-2-Clause */
/* `bis trade`: its figures against others' arithmetic (bis render and bis compare for a run, sums of this file for the
 * tables, replicates read back for the references), its folder through interruption and --resume, its page through a
 * checker that is itself checked, and bad input. */
#include "tools/trade/trade_advice.h"
#include "tools/trade/trade_files.h"
#include "tools/trade/trade_page.h"
#include "tools/trade/trade_pictures.h"
#include "tools/trade/trade_scene.h"
#include "tools/trade/trade_settings.h"
#include "tools/trade/trade_stats.h"

#include "bis/tools/compare.h"
#include "bis/base/file.h"
#include "bis/base/mem.h"
#include "bis/files/image_file.h"
#include "files/image_png.h"
#include "claim.h"
#include "expect.h"
#include "file_help.h"
#include "html_check.h"
#include "json_check.h"
#include "page_help.h"
#include "program.h"

#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#define DIR "build/test_trade"
#define SCENE DIR "/scene.txt"
#define SMALL "trade " SCENE " --nthreads 1 --time 4 --passes 4 --seeds 2 --integrator mis --integrator sir --output "

static void remove_tree(const char *path)
{
    char command[512];
    snprintf(command, sizeof command, "rm -rf %s", path);
    assert_int_equal(system(command), 0);
}

/* One measurement with references of its own, one with a given reference: most tests read them. */
static int setup(void **state)
{
    program_run r;
    remove_tree(DIR);
    program_folder(DIR);
    program_write_scene(DIR, "Sampler \"stratified\"\n");
    program_expect(&r, 0, SMALL DIR "/own");
    program_expect(&r, 0, SCENE " --integrator mis --samples 64 --spp 64 --seed 77 --outfile " DIR "/given.exr");
    program_expect(&r, 0, SMALL DIR "/given --reference " DIR "/given.exr");
    program_expect(&r, 0, SCENE " --integrator mis --samples 64 --spp 256 --seed 99 --outfile " DIR "/truth.exr");
    return 0;
}

/* ---- CSV ---- */

enum { COLUMNS = 24, ROWS = 256 };

typedef struct table {
    unsigned char *data;
    char *cell[ROWS][COLUMNS]; /* row 0: the header */
    int n_rows, n_columns;
} table;

static void read_table(table *t, const char *path)
{
    size_t size;
    bis_diag diag = {0};
    if (bis_file_read(&t->data, &size, path, (bis_loc){0}, &diag))
        fail_msg("%s", diag.n ? diag.messages[0].text : path);
    bis_diag_clear(&diag);
    t->n_rows = 0;
    for (char *line = (char *)t->data, *end; (end = strchr(line, '\n')) != NULL; line = end + 1) {
        int n = 0;
        *end = '\0';
        assert_true(t->n_rows < ROWS);
        for (char *cell = line; cell; n++) {
            char *comma = strchr(cell, ',');
            assert_true(n < COLUMNS);
            t->cell[t->n_rows][n] = cell;
            if (comma) *comma++ = '\0';
            cell = comma;
        }
        if (t->n_rows == 0) t->n_columns = n;
        assert_int_equal(n, t->n_columns);
        t->n_rows++;
    }
}

static void clear_table(table *t) { bis_free(t->data); }

static const char *text_at(const table *t, int row, const char *column)
{
    for (int i = 0; i < t->n_columns; i++) {
        if (strcmp(t->cell[0][i], column) == 0) return t->cell[row][i];
    }
    fail_msg("no column %s", column);
    return NULL;
}

static double number_at(const table *t, int row, const char *column)
{
    const char *text = text_at(t, row, column), *end;
    double v = bis_parse_double(text, &end);
    return end == text || *end ? (double)NAN : v;
}

static void read_image(bis_image *image, const char *path)
{
    bis_diag diag = {0};
    if (bis_image_read(image, path, (bis_loc){0}, &diag)) fail_msg("%s", diag.n ? diag.messages[0].text : path);
    bis_diag_clear(&diag);
}

static bool is_near(double a, double b) { return fabs(a - b) <= 1e-9 * fmax(fabs(a), fabs(b)); }

/* ---- runs ---- */

/* Run `row` of runs.csv, made by `bis render` with these options; its error by `bis compare`'s arithmetic. */
static void assert_run_is(const table *runs, const char *setting, const char *options, const char *passes)
{
    int row = 1;
    while (row < runs->n_rows &&
           (strcmp(text_at(runs, row, "setting"), setting) != 0 || strcmp(text_at(runs, row, "passes"), passes) != 0))
        row++;
    if (row == runs->n_rows) fail_msg("no run of %s", setting);

    program_run r;
    bis_image a, b;
    bis_comparison c;
    program_expect(
        &r, 0, SCENE " %s --spp %s --seed %s --outfile " DIR "/run.exr", options, passes, text_at(runs, row, "seed"));
    read_image(&a, DIR "/run.exr");
    read_image(&b, DIR "/given.exr");
    assert_int_equal(bis_compare(&c, &a, &b, NULL), BIS_OK);
    assert_true(number_at(runs, row, "rmse") == c.rmse);
    assert_true(number_at(runs, row, "relmse") == c.relmse && number_at(runs, row, "relmse_both") == c.relmse);
    assert_true(number_at(runs, row, "bias") == c.bias);
    bis_image_clear(&a);
    bis_image_clear(&b);
}

static void each_run_is_the_render_of_its_seed_bit_for_bit(void **state)
{
    table runs;
    read_table(&runs, DIR "/given/runs.csv");
    assert_run_is(&runs, "mis 16", "--integrator mis --samples 16", "2");
    assert_run_is(&runs, "sir 64/4", "--candidates 64 --shadowrays 4", "4");
    assert_run_is(&runs, "sir 256/16 brdf", "--candidates 256 --shadowrays 16 --proposal brdf", "1");
    assert_run_is(&runs, "sir 20/2 scene's own", "", "4");
    clear_table(&runs);
}

/* A picture too large to be measured whole: a run has of each k x k pixels of the full render one, bit for bit. So its
 * error is that of the full picture as far as these tell, whatever its size. */
static void a_run_has_the_pixels_of_the_full_render(void **state)
{
    enum { W = 240, H = 160 };
    static const char given[] = DIR "/large.exr", size[] = "--resolution 240x160";
    program_run r;
    table runs;
    bis_image a, b, thin_a, thin_b;
    bis_comparison c;
    int k = 0;

    program_expect(&r, 0, SCENE " %s --integrator mis --samples 4 --spp 4 --seed 5 --outfile %s", size, given);
    program_expect(&r, 0,
        "trade " SCENE " %s --reference %s --nthreads 1 --time 0.5 --passes 2 --seeds 1 --integrator em --output " DIR
        "/thin",
        size, given);
    FILE *f = fopen(DIR "/thin/plan.txt", "r");
    for (char line[256]; fgets(line, sizeof line, f);) (void)sscanf(line, "step %d", &k);
    fclose(f);
    assert_true(k >= 2);
    read_table(&runs, DIR "/thin/runs.csv");
    int row = 1;
    while (strcmp(text_at(&runs, row, "setting"), "em 16") != 0) row++;
    program_expect(&r, 0, SCENE " %s --integrator em --samples 16 --spp %s --seed %s --outfile " DIR "/run.exr", size,
        text_at(&runs, row, "passes"), text_at(&runs, row, "seed"));
    read_image(&a, DIR "/run.exr");
    read_image(&b, given);
    const int w = (W - k / 2 + k - 1) / k, h = (H - k / 2 + k - 1) / k;
    assert_int_equal(bis_image_init(&thin_a, w, h, NULL), BIS_OK);
    assert_int_equal(bis_image_init(&thin_b, w, h, NULL), BIS_OK);
    for (int i = 0; i < w * h; i++) {
        const int there = (i / w * k + k / 2) * W + i % w * k + k / 2;
        thin_a.pixels[i] = a.pixels[there];
        thin_b.pixels[i] = b.pixels[there];
    }
    assert_int_equal(bis_compare(&c, &thin_a, &thin_b, NULL), BIS_OK);
    assert_true(number_at(&runs, row, "rmse") == c.rmse && number_at(&runs, row, "relmse") == c.relmse &&
                number_at(&runs, row, "bias") == c.bias);
    bis_image_clear(&a);
    bis_image_clear(&b);
    bis_image_clear(&thin_a);
    bis_image_clear(&thin_b);
    clear_table(&runs);
}

static void every_setting_budget_and_seed_is_measured_once_with_a_seed_of_its_own(void **state)
{
    table runs;
    read_table(&runs, DIR "/own/runs.csv");
    assert_true(runs.n_rows - 1 >= 15 * 3 * 2);
    assert_int_equal((runs.n_rows - 1) % 6, 0);
    for (int i = 1; i < runs.n_rows; i++) {
        for (int k = 1; k < i; k++) {
            const bool same = strcmp(text_at(&runs, i, "setting"), text_at(&runs, k, "setting")) == 0 &&
                              number_at(&runs, i, "passes") == number_at(&runs, k, "passes");
            assert_false(same && number_at(&runs, i, "replicate") == number_at(&runs, k, "replicate"));
            assert_string_not_equal(text_at(&runs, i, "seed"), text_at(&runs, k, "seed"));
        }
    }
    clear_table(&runs);
}

/* ---- tables ---- */

/* A reader that knows columns by name finds each of them: no two have the same, in any table. */
static void no_two_columns_of_a_table_have_one_name(void **state)
{
    assert_int_equal(system("for f in " DIR "/own/*.csv " DIR "/given/*.csv; do head -n 1 $f | tr ',' '\\n' | sort | "
                            "uniq -d | sed \"s|^|$f: |\"; done > " DIR "/twice && ls " DIR "/own/equal_error.csv && ! "
                            "test -s "
                            DIR "/twice"), 0);
}

/* `bis render` meters on the shapes, and so does the page: a picture has the exposure here that its PNG has there,
 * but for the noise of 16 rays a pixel for the pixels that shapes fill partly. The twin, a mean over the bright
 * background as well, is more than a third of a stop off. */
static void the_pages_exposure_is_that_of_bis_render(void **state)
{
    bis_trade t = {.o = {.scene = SCENE, .n_threads = 1}, .plan = {.width = 24, .height = 16}};
    bis_film film;
    bis_render_result result;
    bis_channel channels[4];
    double exposure;
    const double whole[4] = {0, 1, 0, 1};
    const bis_render_options options = {.budget = {.spp = 16}, .n_threads = 1};
    enum { N = 24 * 16 };
    float rgba[4 * N];
    assert_int_equal(bis_trade_load(&t, NULL), BIS_OK);
    assert_int_equal(bis_film_init(&film, 24, 16, whole, (bis_loc){0}, NULL), BIS_OK);
    bis_sampler_set_spp(&t.desc->view.sampler, 16);
    assert_int_equal(bis_render(&result, &film, t.scene, &t.desc->view, &options, NULL), BIS_OK);
    bis_film_resolve(&film, rgba);
    assert_int_equal(bis_image_init(&t.both.image, 24, 16, NULL), BIS_OK);
    for (int i = 0; i < N; i++) t.both.image.pixels[i] = (rgb){rgba[4 * i], rgba[4 * i + 1], rgba[4 * i + 2]};
    bis_picture picture = bis_image_picture(&t.both.image, channels);
    const double without_alpha = bis_png_exposure(&picture);
    picture.subject = &(const bis_channel){"A", rgba + 3, 4};
    assert_int_equal(bis_trade_exposure(&exposure, &t, NULL), BIS_OK);
    const double rendered = bis_png_exposure(&picture);
    if (fabs(exposure - rendered) > 0.02) fail_msg("%g is not the %g of bis render", exposure, rendered);
    assert_true(fabs(without_alpha - exposure) > 1 / 3.0);
    bis_image_clear(&t.both.image);
    bis_film_clear(&film);
    bis_trade_unload(&t);
}

/* A square of 1 x 1.25 before four pixels of 1 x 1: it covers an eighth of each of the upper two, half of each of the
 * lower, where 16 rays a pixel say so exactly. The upper have a luminance of 8 and the lower of 1, so the weighted mean
 * of the logarithms to base 2 is 3 (1/8) / (1/8 + 1/2) = 0.6. */
static void the_exposure_weighs_each_pixel_by_what_is_covered_of_it(void **state)
{
    bis_trade t = {.o = {.scene = DIR "/ortho.txt", .n_threads = 1}, .plan = {.width = 2, .height = 2}};
    double exposure;
    program_write_file(DIR "/ortho.txt",
        "Film \"rgb\" \"integer xresolution\" 2 \"integer yresolution\" 2\nIntegrator \"em\"\n"
        "Camera \"orthographic\" \"float screenwindow\" [-1 1 -1 1]\nWorldBegin\n"
        "LightSource \"infinite\" \"string filename\" \"map.pfm\"\n"
        "Shape \"trianglemesh\" \"integer indices\" [0 1 2 0 2 3] \"point3 P\" [-.5 -1 2  .5 -1 2  .5 .25 2  -.5 .25 "
        "2]\n");
    assert_int_equal(bis_trade_load(&t, NULL), BIS_OK);
    assert_int_equal(bis_image_init(&t.both.image, 2, 2, NULL), BIS_OK);
    for (int i = 0; i < 4; i++) t.both.image.pixels[i] = i < 2 ? (rgb){8, 8, 8} : (rgb){1, 1, 1};
    assert_int_equal(bis_trade_exposure(&exposure, &t, NULL), BIS_OK);
    if (fabs(exposure - (log2(0.18) - 0.6)) > 1e-6) fail_msg("%.9g is not %.9g", exposure, log2(0.18) - 0.6);
    bis_image_clear(&t.both.image);
    bis_trade_unload(&t);
}

/* All runs of a row of trade.csv; returns how many. */
static int values_of(double *v, const table *runs, const table *trade, int row, const char *column)
{
    int n = 0;
    for (int i = 1; i < runs->n_rows; i++) {
        if (strcmp(text_at(runs, i, "setting"), text_at(trade, row, "setting")) != 0) continue;
        if (number_at(runs, i, "passes") == number_at(trade, row, "passes")) v[n++] = number_at(runs, i, column);
    }
    return n;
}

/* Every figure of trade.csv from runs.csv. Two seeds: mean (a + b)/2, its standard error |a - b|/2, the median is the
 * mean. share: of both references in relmse_both. */
static void assert_table_follows(const char *folder, double share, double se_mis, double se_sir)
{
    char path[256];
    table runs, trade;
    double v[4];

    snprintf(path, sizeof path, "%s/runs.csv", folder);
    read_table(&runs, path);
    snprintf(path, sizeof path, "%s/trade.csv", folder);
    read_table(&trade, path);
    assert_int_equal(2 * (trade.n_rows - 1), runs.n_rows - 1);
    for (int i = 1; i < trade.n_rows; i++) {
        const bool by_sir = strcmp(text_at(&trade, i, "integrator"), "mis") == 0;
        assert_int_equal(values_of(v, &runs, &trade, i, "seconds"), 2);
        const double seconds = (v[0] + v[1]) / 2;
        assert_true(is_near(number_at(&trade, i, "seconds"), seconds));
        values_of(v, &runs, &trade, i, "relmse_both");
        const double noise = (v[0] + v[1]) / 2 - share;
        values_of(v, &runs, &trade, i, "relmse");
        assert_true(is_near(number_at(&trade, i, "relmse"), (v[0] + v[1]) / 2));
        assert_true(is_near(number_at(&trade, i, "relmse_se"), fabs(v[0] - v[1]) / 2));
        assert_true(is_near(number_at(&trade, i, "noise"), noise));
        assert_true(is_near(number_at(&trade, i, "cost_variance"), seconds * noise));
        values_of(v, &runs, &trade, i, "rmse");
        assert_true(is_near(number_at(&trade, i, "rmse"), sqrt((v[0] * v[0] + v[1] * v[1]) / 2)));
        values_of(v, &runs, &trade, i, "bias");
        assert_true(is_near(number_at(&trade, i, "bias"), (v[0] + v[1]) / 2));
        assert_true(is_near(number_at(&trade, i, "bias_se"), hypot((v[0] - v[1]) / 2, by_sir ? se_sir : se_mis)));
        bool dominated = false;
        for (int k = 1; k < trade.n_rows; k++) {
            dominated |= number_at(&trade, k, "seconds") < number_at(&trade, i, "seconds") &&
                         number_at(&trade, k, "noise") < number_at(&trade, i, "noise");
        }
        assert_int_equal(number_at(&trade, i, "pareto"), !dominated);
    }
    clear_table(&runs);
    clear_table(&trade);
}

static void the_table_says_what_the_runs_say(void **state)
{
    assert_table_follows(DIR "/given", 0, 0, 0);
}

enum { OWN_VALUES = 24 * 16 * 3 };

static void read_values(double v[OWN_VALUES], const char *path)
{
    bis_image image;

    read_image(&image, path);
    assert_int_equal(image.width * image.height * 3, OWN_VALUES);
    for (int i = 0; i < OWN_VALUES; i++) {
        const rgb c = image.pixels[i / 3];
        v[i] = (double)(i % 3 == 0 ? c.r : i % 3 == 1 ? c.g : c.b);
    }
    bis_image_clear(&image);
}

/* From the eight files: their mean, and Var of that, sum of squares minus square of the sum, over b^2 + m^2/100. */
static void judge_reference(const char *who, double picture[OWN_VALUES], double *share, double *se, double *mean)
{
    enum { R = 8, N = OWN_VALUES };
    static double v[R][N];
    double whole[R] = {0}, sum = 0, squares = 0;

    for (int r = 0; r < R; r++) {
        char path[256];
        snprintf(path, sizeof path, DIR "/own/references/%s-%d.exr", who, r + 1);
        read_values(v[r], path);
        for (int i = 0; i < N; i++) whole[r] += v[r][i] / N;
        sum += whole[r];
        squares += whole[r] * whole[r];
    }
    *mean = sum / R;
    *se = sqrt((squares - sum * sum / R) / (R - 1) / R);
    *share = 0;
    for (int i = 0; i < N; i++) {
        double s = 0, s2 = 0;
        for (int r = 0; r < R; r++) {
            s += v[r][i];
            s2 += v[r][i] * v[r][i];
        }
        picture[i] = s / R;
        *share += (s2 - s * s / R) / (R - 1) / R / (s / R * (s / R) + *mean * *mean / 100) / N;
    }
}

static double relmse_of(const double a[OWN_VALUES], const double b[OWN_VALUES])
{
    double m = 0, sum = 0;
    for (int i = 0; i < OWN_VALUES; i++) m += b[i] / OWN_VALUES;
    for (int i = 0; i < OWN_VALUES; i++)
        sum += (a[i] - b[i]) * (a[i] - b[i]) / (b[i] * b[i] + m * m / 100) / OWN_VALUES;
    return sum;
}

static void the_references_noise_is_measured_and_subtracted_and_no_method_judges_itself(void **state)
{
    static double picture[2][OWN_VALUES], both[OWN_VALUES], own[OWN_VALUES];
    double share[2], se[2], mean[2];
    judge_reference("mis", picture[0], &share[0], &se[0], &mean[0]);
    judge_reference("sir", picture[1], &share[1], &se[1], &mean[1]);
    assert_true(share[0] > 0 && share[1] > 0);
    assert_true(fabs(mean[0] - mean[1]) <
                5 * hypot(se[0], se[1])); /* two methods, one integral; se of 7 dof: beyond 5 once in 1000 */
    assert_table_follows(DIR "/own", 1 / (1 / share[0] + 1 / share[1]), se[0], se[1]);

    /* one run again, its distance from the reference by the other method and from the mean of both */
    const double weight = share[1] / (share[0] + share[1]);
    table runs;
    program_run r;
    read_table(&runs, DIR "/own/runs.csv");
    int row = 1;
    while (strcmp(text_at(&runs, row, "setting"), "sir 64/4") != 0) row++;
    program_expect(&r, 0,
        SCENE " --resolution 24x16 --candidates 64 --shadowrays 4 --spp %s --seed %s --outfile " DIR "/run.exr",
        text_at(&runs, row, "passes"), text_at(&runs, row, "seed"));
    read_values(own, DIR "/run.exr");
    for (int i = 0; i < OWN_VALUES; i++) both[i] = weight * picture[0][i] + (1 - weight) * picture[1][i];
    const double float_rounding = 1e-5; /* references are kept as float, and so is their mean */
    assert_true(fabs(number_at(&runs, row, "relmse") / relmse_of(own, picture[0]) - 1) < float_rounding);
    assert_true(fabs(number_at(&runs, row, "relmse_both") / relmse_of(own, both) - 1) < float_rounding);
    assert_true(fabs(number_at(&runs, row, "relmse_both") / relmse_of(own, picture[0]) - 1) >
                1e-3); /* the twin: the other method alone */
    clear_table(&runs);
}

/* ---- slopes and costs from runs that are known ---- */

/* relMSE = floor + v / passes and seconds = 0.01 passes, with one seed twice as noisy as the other. */
static void forge(bis_trade *t, double v, double floor)
{
    memset(t, 0, sizeof *t);
    t->desc = bis_alloc(1, sizeof *t->desc);
    assert_non_null(t->desc);
    t->plan = (bis_trade_plan){.n_settings = 1,
        .n_seeds = 2,
        .width = 10,
        .height = 10,
        .full_width = 20,
        .full_height = 10,
        .run_seconds = 0.32};
    t->plan.settings[0] =
        (bis_trade_setting){.name = "em 16", .settings = bis_settings_default(&bis_em), .is_swept = true, .levels = 6};
    t->both.relmse = 0.001;
    t->references[1].se = 0.25;
    for (int level = 0; level < 6; level++) {
        for (int k = 0; k < 2; k++) {
            const double passes = exp2(level);
            const bis_trade_run run = {.level = level,
                .replicate = k,
                .seconds = 0.01 * passes,
                .rmse = 1,
                .relmse_both = 0.001 + floor + (k + 1) * v / passes,
                .bias = k};
            assert_int_equal(bis_trade_add_run(t, &run, NULL), BIS_OK);
        }
    }
    assert_int_equal(bis_trade_summarise(t, NULL), BIS_OK);
}

static void clear_forged(bis_trade *t)
{
    bis_free(t->desc);
    t->desc = NULL;
    bis_trade_clear(t);
}

static void the_root_law_gives_slope_minus_half_and_a_constant_cost(void **state)
{
    bis_trade t;
    bool extrapolated;
    forge(&t, 0.36, 0);
    const bis_trade_curve *c = &t.result.curves[0];
    assert_true(fabs(c->slope + 0.5) < 1e-9 && isnan(c->slope_se)); /* two seeds do not tell how sure that is */
    assert_true(is_near(c->cost_variance, 0.01 * 1.5 * 0.36));
    assert_true(is_near(c->cost_variance_se, 0.01 * 0.5 * 0.36));
    assert_true(is_near(t.result.points[0].bias_se, hypot(0.5, 0.25)));

    const double at_one = sqrt(1.5 * 0.36); /* error of one pass, 0.01 s */
    assert_true(
        is_near(bis_trade_error_at(&t.result, &t.plan, 0, 0.03, &extrapolated), at_one / sqrt(3)) && !extrapolated);
    assert_true(is_near(bis_trade_error_at(&t.result, &t.plan, 0, 0.64, &extrapolated), at_one / 8) && extrapolated);
    assert_true(isnan(bis_trade_error_at(&t.result, &t.plan, 0, 0.009, &extrapolated)));
    assert_true(is_near(bis_trade_seconds_to(&t.result, &t.plan, 0, at_one / 3, &extrapolated), 0.09) && !extrapolated);
    assert_true(is_near(bis_trade_seconds_to(&t.result, &t.plan, 0, at_one / 10, &extrapolated), 1) && extrapolated);
    assert_true(bis_trade_seconds_to(&t.result, &t.plan, 0, 99, &extrapolated) == 0.01);

    /* 5%: 0.54 / 0.0025 = 216 passes of 0.01 s, twice the pixels */
    const bis_trade_advice *final = &t.result.advice[2];
    assert_int_equal(final->passes, 216);
    assert_true(is_near(final->seconds, 216 * 0.01 * 2) && final->is_extrapolated);

    /* 0.004 s of a pass are the same for any picture */
    t.plan.settings[0].fill_seconds = 0.004;
    bis_trade_advise(&t);
    assert_true(is_near(final->seconds, 216 * (0.004 + 0.006 * 2)));
    clear_forged(&t);
}

static void a_biased_method_shows_in_the_slope_and_is_never_extrapolated_nor_recommended(void **state)
{
    bis_trade t;
    bool extrapolated;
    forge(&t, 0.36, 0.2); /* the twin: a floor that no time removes */
    assert_true(t.result.curves[0].slope > -0.4);
    t.plan.settings[0].is_biased = true;
    bis_trade_advise(&t);
    assert_true(isnan(bis_trade_error_at(&t.result, &t.plan, 0, 0.64, &extrapolated)));
    assert_true(isnan(bis_trade_seconds_to(&t.result, &t.plan, 0, 0.1, &extrapolated)));
    for (int i = 0; i < BIS_TRADE_ADVICE; i++) assert_int_equal(t.result.advice[i].setting, -1);
    clear_forged(&t);
}

/* ---- settings as text ---- */

/* Each setting's line, put into a scene, is read as that setting. */
static void the_line_for_a_scene_file_is_the_setting(void **state)
{
    bis_trade t = {.o = {.scene = SCENE}};
    int seen = 0;
    assert_int_equal(bis_trade_load(&t, NULL), BIS_OK);
    assert_true(t.plan.n_settings <= BIS_TRADE_SETTINGS);
    for (int i = 0; i < t.plan.n_settings; i++) {
        const bis_trade_setting *s = &t.plan.settings[i];
        char text[256], scene[512];
        bis_scene_desc *desc;
        bis_diag diag = {0};
        bis_trade_scene_text(text, s, t.desc->light.area_exponent);
        char *semicolon = strchr(text, ';');
        assert_int_equal(semicolon != NULL, s->area_exponent != t.desc->light.area_exponent);
        if (semicolon) *semicolon = '\0';
        snprintf(scene, sizeof scene, "%s\nWorldBegin\n", text);
        program_write_file(DIR "/line.txt", scene);
        if (bis_scene_parse(&desc, DIR "/line.txt", &diag))
            fail_msg("%s: %s", text, diag.n ? diag.messages[0].text : "?");
        bis_diag_clear(&diag);
        const bis_settings *a = &desc->view.settings, *b = &s->settings;
        assert_ptr_equal(a->integrator, b->integrator);
        const bool by_candidates = a->integrator == &bis_sir || a->integrator == &bis_rejection;
        if (by_candidates)
            assert_true(a->candidates == b->candidates && a->shadowrays == b->shadowrays && a->proposal == b->proposal);
        else assert_true(a->samples == b->samples);
        assert_true(a->stratify == b->stratify && a->resampling == b->resampling && a->estimator == b->estimator);
        assert_true(a->heuristic == b->heuristic && a->compensate == b->compensate && a->split == b->split);
        assert_true(a->learn == b->learn);
        bis_scene_desc_free(desc);
        seen++;
    }
    assert_true(seen >= 25);
    bis_trade_clear(&t);
}

/* What learns is another method than what does not: it has a row of its own, and is not mistaken for the scene's. */
static void a_product_that_learns_has_a_row_of_its_own(void **state)
{
    for (int learn = 0; learn < 2; learn++) {
        bis_trade t = {.o = {.scene = DIR "/learn.txt"}};
        char text[128], scene[512];
        snprintf(scene, sizeof scene,
            "Integrator \"sir\" \"integer candidates\" 256 \"integer shadowrays\" 16 \"string proposal\" \"product\" "
            "\"bool learn\" %s\nWorldBegin\nLightSource \"infinite\"\nShape \"sphere\"\n",
            learn ? "true" : "false");
        program_write_file(DIR "/learn.txt", scene);
        assert_int_equal(bis_trade_load(&t, NULL), BIS_OK);
        const int plain = bis_trade_find_setting(&t.plan, "sir 256/16 product"),
                  learned = bis_trade_find_setting(&t.plan, "sir 256/16 product learned");
        assert_true(plain >= 0 && learned >= 0);
        assert_true(!t.plan.settings[plain].settings.learn && t.plan.settings[learned].settings.learn);
        assert_int_equal(t.plan.settings[plain].is_scenes, !learn);
        assert_int_equal(t.plan.settings[learned].is_scenes, learn);
        bis_trade_option_text(text, &t.plan.settings[plain], t.desc->light.area_exponent);
        assert_string_equal(text, "--integrator sir --candidates 256 --shadowrays 16 --proposal product");
        bis_trade_option_text(text, &t.plan.settings[learned], t.desc->light.area_exponent);
        assert_string_equal(text, "--integrator sir --candidates 256 --shadowrays 16 --proposal product --learn on");
        const int independent =
            bis_trade_find_setting(&t.plan, "sir 256/16 independent"); /* resampling has no option */
        bis_trade_option_text(text, &t.plan.settings[independent], t.desc->light.area_exponent);
        assert_string_equal(text, "");
        bis_trade_clear(&t);
    }
}

/* ---- what is advised ---- */

/* A setting that is advised twice is timed once: a pass of it takes as long in either. Twins: the seconds of the whole,
 * and those of another setting. */
static void the_seconds_of_a_setting_are_those_of_its_passes(void **state)
{
    bis_trade_advice all[3] = {{.setting = 4, .passes = 5, .seconds = 10}, {.setting = 2, .passes = 3, .seconds = 99},
        {.setting = 4, .passes = 20, .seconds = 1}};
    assert_false(bis_trade_take_known_seconds(all, 0));
    assert_false(bis_trade_take_known_seconds(all, 1));
    assert_true(all[1].seconds == 99);
    assert_true(bis_trade_take_known_seconds(all, 2));
    assert_true(is_near(all[2].seconds, 40)); /* 2 s a pass */
}

/* The page enlarges two parts of a quarter of the sides each, not one of them twice. */
static void the_enlarged_parts_do_not_overlap(void **state)
{
    static const char *const pages[] = {DIR "/own/report.html", DIR "/given/report.html"};
    for (int i = 0; i < 2; i++) {
        char *data = page_data(pages[i]);
        const double width = json_number(data, "crops.0.width"), height = json_number(data, "crops.0.height");
        const double across = fabs(json_number(data, "crops.0.x") - json_number(data, "crops.1.x"));
        assert_true(width > 0 && height > 0);
        assert_true(across >= width || fabs(json_number(data, "crops.0.y") - json_number(data, "crops.1.y")) >= height);
        free(data);
    }
}

/* Three renders of two pixels, by hand: variances 1 and 3, means 5 and 2. A reference without noise stands in the
 * denominator alone (m = 5). Of one as noisy as the renders' mean, which has a third of their scatter, half is
 * taken. */
static void the_scatter_of_renders_is_their_variance(void **state)
{
    const float values[3][2] = {{4, 1}, {6, 1}, {5, 4}}; /* grey */
    bis_trade_reference reference = {.relmse = 0};
    bis_image images[3];
    assert_int_equal(bis_image_init(&reference.image, 2, 1, NULL), BIS_OK);
    reference.image.pixels[0] = (rgb){7, 7, 7};
    reference.image.pixels[1] = (rgb){3, 3, 3};
    for (int k = 0; k < 3; k++) {
        assert_int_equal(bis_image_init(&images[k], 2, 1, NULL), BIS_OK);
        for (int i = 0; i < 2; i++) images[k].pixels[i] = (rgb){values[k][i], values[k][i], values[k][i]};
    }
    assert_true(is_near(bis_trade_scatter(images, 3, 0, &reference), (1 / (49 + 0.25) + 3 / (9 + 0.25)) / 2));
    reference.relmse = (1 / (25 + 0.1225) + 3 / (4 + 0.1225)) / 2 / 3; /* m = 3.5 */
    const double mixed = (1 / (36 + 0.180625) + 3 / (6.25 + 0.180625)) / 2; /* b = 6, 2.5 */
    assert_true(is_near(bis_trade_scatter(images, 3, 0, &reference), mixed));
    for (int k = 0; k < 3; k++) bis_image_clear(&images[k]);
    bis_image_clear(&reference.image);
}

/* `bis render` with the command of an advice, four seeds, against a reference by another method. */
static double error_of_command(unsigned passes, const bis_image *reference)
{
    double sum = 0;
    for (int k = 0; k < 4; k++) {
        program_run r;
        bis_image a;
        bis_comparison c;
        program_expect(&r, 0, SCENE " --integrator em --samples 16 --spp %u --seed %d --outfile " DIR "/advised.exr",
                       passes, 900 + k);
        read_image(&a, DIR "/advised.exr");
        assert_int_equal(bis_compare(&c, &a, reference, NULL), BIS_OK);
        bis_image_clear(&a);
        sum += c.relmse / 4;
    }
    return sqrt(sum);
}

/* Advised are passes whose grid is square or nearly so, and for a reason: 13, a grid of 1 x 13, leave more noise than
 * 12, 3 x 4 (twice as much; beyond 1.5 times by chance less than once in 10^6, by the scatter of the four seeds). */
static void passes_are_advised_that_make_a_square_grid(void **state)
{
    static const unsigned least[] = {0, 1, 2, 3, 4, 5, 7, 9, 10, 13, 17, 21, 150, 157, 169, 1000000},
                          good[] = {1, 1, 2, 4, 4, 6, 9, 9, 12, 16, 20, 25, 156, 169, 169, 1000000};
    bis_scene_desc desc = {.view.sampler = {.kind = BIS_SAMPLER_STRATIFIED}};
    const bis_trade t = {.desc = &desc};
    bis_image truth;
    const size_t n = sizeof good / sizeof *good;
    for (size_t i = 0; i < n; i++) assert_int_equal(bis_trade_square_passes(&t, least[i]), good[i]);
    assert_int_equal(bis_trade_square_passes(&t, 12.01), 16);
    desc.view.sampler.kind = BIS_SAMPLER_SOBOL;
    assert_int_equal(bis_trade_square_passes(&t, 13), 13);
    read_image(&truth, DIR "/truth.exr");
    assert_true(error_of_command(13, &truth) > sqrt(1.5) * error_of_command(12, &truth));
    bis_image_clear(&truth);
}

/* A curve's word, here four times or a quarter of what is right, is replaced by what the advised passes leave: the
 * error that is promised comes out within a quarter. (relMSE of four renders of 1152 values: some 5%.) The reference,
 * of 4 passes, is noisier than what it judges, and must not spoil it. Twin: the same command with a quarter of the
 * passes. */
static void what_is_promised_comes_out(void **state)
{
    static const uint32_t said[] = {90, 6}; /* by a curve */
    const double error = 0.04;
    bis_image truth;
    read_image(&truth, DIR "/truth.exr");
    for (int i = 0; i < 2; i++) {
        bis_trade t = {.o = {.scene = SCENE, .folder = DIR, .passes = 4, .n_threads = 1}, .plan = {.step = 1}};
        bis_render_result result;
        assert_int_equal(bis_trade_load(&t, NULL), BIS_OK);
        t.plan.full_width = t.plan.width = 24;
        t.plan.full_height = t.plan.height = 16;
        const int em = bis_trade_find_setting(&t.plan, "em 16"), mis = bis_trade_find_setting(&t.plan, "mis 16");
        assert_int_equal(
            bis_trade_render(&t, &(bis_trade_job){&t.plan.settings[mis], 1, 4, 5}, &t.both.image, &result, NULL),
            BIS_OK);
        bis_comparison reference;
        assert_int_equal(bis_compare(&reference, &t.both.image, &truth, NULL), BIS_OK);
        t.both.relmse = reference.relmse;
        assert_true(reference.relmse > error * error);
        for (int k = 0; k < BIS_TRADE_ADVICE; k++) t.result.advice[k].setting = -1;
        t.result.advice[2] = (bis_trade_advice){.setting = em, .error = error, .passes = said[i]};
        t.result.advice[2].seconds = 3.0 * said[i];
        t.result.curves[em].pass_seconds = 0.5;
        assert_int_equal(bis_trade_check_advice(&t, NULL), BIS_OK);
        const bis_trade_advice *a = &t.result.advice[2];
        const double measured = error_of_command(a->passes, &truth);
        if (fabs(a->expected_error / measured - 1) > 0.25) {
            fail_msg("%u passes: %g for %g", a->passes, measured, a->expected_error);
        }
        if (a->expected_error > error || a->is_extrapolated) {
            fail_msg("from %u: %u passes, %g", said[i], a->passes, a->expected_error);
        }
        assert_true(is_near(a->seconds, 3.0 * a->passes));
        assert_true(error_of_command(a->passes / 4, &truth) > 1.25 * error);
        bis_trade_clear(&t);
    }
    bis_image_clear(&truth);
}

/* Black spheres before a white sky: all error is at edges, and falls as n^-3/2. --passes 1 lets renders have 64 passes
 * at most, and some 400 are advised: the error that is promised comes out within a quarter. (With eight other seeds of
 * the measurement it was 0.78 to 1.30 times what came out; this one is fixed.) Twin: the root law from what 55 passes
 * leave, the most that are rendered, wants some 900, which have 1/1.46 to 1/1.72 of the error that it promises. */
static void what_is_extrapolated_comes_out_where_all_error_is_at_edges(void **state)
{
    static const char scene[] = DIR "/edges.txt";
    const double error = 0.0043;
    bis_trade t = {.o = {.scene = scene, .folder = DIR, .passes = 1, .n_threads = 1}, .plan = {.step = 1}};
    bis_trade_reference *const truth = &t.both; /* without noise */
    bis_render_result result;
    double of[2];
    program_write_file(scene,
        "Film \"rgb\" \"integer xresolution\" 60 \"integer yresolution\" 40\nLookAt 0 -10 0  0 0 0  0 0 1\n"
        "Camera \"perspective\" \"float fov\" 40\nSampler \"sobol\"\nIntegrator \"em\"\nWorldBegin\n"
        "LightSource \"infinite\" \"rgb L\" [1 1 1]\nMaterial \"phong\" \"rgb Kd\" [0 0 0] \"rgb Ks\" [0 0 0]\n"
        "Shape \"sphere\" \"float radius\" 2\n"
        "AttributeBegin\nTranslate 3 0 1\nShape \"sphere\" \"float radius\" .7\nAttributeEnd\n"
        "AttributeBegin\nTranslate -3 0 -1\nShape \"sphere\" \"float radius\" .9\nAttributeEnd\n");
    assert_int_equal(bis_trade_load(&t, NULL), BIS_OK);
    t.plan.full_width = t.plan.width = 60;
    t.plan.full_height = t.plan.height = 40;
    const bis_trade_setting *em = &t.plan.settings[bis_trade_find_setting(&t.plan, "em 16")];
    assert_int_equal(bis_trade_render(&t, &(bis_trade_job){em, 1, 16384, 5}, &truth->image, &result, NULL), BIS_OK);
    for (int k = 0; k < BIS_TRADE_ADVICE; k++) t.result.advice[k].setting = -1;
    bis_trade_advice *const a = &t.result.advice[2];
    *a = (bis_trade_advice){.setting = (int)(em - t.plan.settings), .error = error, .passes = 900, .seconds = 900};
    t.result.curves[a->setting].pass_seconds = 0.5;
    assert_int_equal(bis_trade_check_advice(&t, NULL), BIS_OK);
    if (!a->is_extrapolated || a->passes <= 64 || a->expected_error > error)
        fail_msg("%u passes: %g%s", a->passes, a->expected_error, a->is_extrapolated ? "" : ", measured");
    for (int k = 0; k < 2; k++) {
        const uint32_t passes = k ? 900 : a->passes;
        double sum = 0;
        for (uint64_t seed = 1; seed <= 4; seed++) {
            bis_image image;
            bis_comparison c;
            assert_int_equal(bis_trade_render(&t, &(bis_trade_job){em, 1, passes, seed}, &image, &result, NULL),
                             BIS_OK);
            assert_int_equal(bis_compare(&c, &image, &truth->image, NULL), BIS_OK);
            sum += c.relmse / 4;
            bis_image_clear(&image);
        }
        of[k] = sqrt(sum);
    }
    if (fabs(a->expected_error / of[0] - 1) > 0.25) fail_msg("%u: %g for %g", a->passes, of[0], a->expected_error);
    assert_true(of[1] < error / 1.5);
    bis_trade_clear(&t);
}

/* ---- interruption ---- */

/* All that is not time. */
static void assert_same_runs(const char *path_a, const char *path_b)
{
    static const char *const columns[] = {"setting", "passes", "replicate", "seed", "camera_rays", "shadow_rays",
        "candidates", "rmse", "relmse", "bias", "relmse_both"};
    table a, b;
    read_table(&a, path_a);
    read_table(&b, path_b);
    assert_int_equal(a.n_rows, b.n_rows);
    for (int row = 1; row < a.n_rows; row++) {
        for (int k = 0; k < 10; k++) assert_string_equal(text_at(&a, row, columns[k]), text_at(&b, row, columns[k]));
    }
    clear_table(&a);
    clear_table(&b);
}

static void lost_runs_are_measured_again_and_are_the_same(void **state)
{
    program_run r;
    assert_int_equal(system("cp -r " DIR "/own " DIR "/lost && sed -i '5,40d' " DIR "/lost/runs.csv && rm " DIR
                            "/lost/report.html " DIR "/lost/references/sir-3.exr"),
        0);
    program_expect(&r, 0, "trade " SCENE " --resume --nthreads 1 --output " DIR "/lost");
    assert_same_runs(DIR "/own/runs.csv", DIR "/lost/runs.csv");
    assert_true(program_exists(DIR "/lost/report.html"));
    assert_int_equal(system("cmp -s " DIR "/own/references/sir-3.exr " DIR "/lost/references/sir-3.exr"), 0);
    assert_int_equal(system("cmp -s " DIR "/own/plan.txt " DIR "/lost/plan.txt"), 0);
}

/* The time is over before the first run: there is nothing to advise from, which must not look like a measurement. */
static void no_run_at_all_is_an_error(void **state)
{
    program_run r;
    assert_int_equal(
        system("cp -r " DIR "/own " DIR "/none && sed -i '2,$d' " DIR "/none/runs.csv && rm " DIR "/none/report.html"),
        0);
    program_expect(&r, 2, "trade " SCENE " --resume --time 0.001 --nthreads 1 --output " DIR "/none");
    assert_non_null(strstr(r.messages, "bis: error: 0 of "));
    assert_non_null(strstr(r.messages, "none fitted into 0.001 s, so there is no advice and no page; go on with "
                                       "--resume --time for about "));
    assert_string_equal(r.output, "");
    assert_false(program_exists(DIR "/none/report.html"));
    program_expect(&r, 0,
        "trade " SCENE " --resume --time 100 --nthreads 1 --output " DIR "/none"); /* the twin, and the way out */
    assert_same_runs(DIR "/own/runs.csv", DIR "/none/runs.csv");
}

/* By the probe, and not after a pilot of minutes: 384 pixels of this setting take some 30 s each pass, of 4 s for
 * everything. */
static void a_scene_that_is_too_slow_is_refused_before_its_pilot(void **state)
{
    program_run r;
    assert_int_equal(system("sed 's/^Integrator.*/Integrator \"sir\" \"integer candidates\" 1048576 \"integer "
                            "shadowrays\" 4096/' " SCENE " >" DIR "/slow.txt && "
                            "grep -q 1048576 " DIR "/slow.txt"),
        0);
    program_expect(
        &r, 2, "trade " DIR "/slow.txt --time 4 --nthreads 1 --seeds 2 --integrator sir --output " DIR "/slow");
    /* the second: the machine has so much other work that the rest of the pilot took the 4 s */
    assert_true(strstr(r.messages, "bis: error: 4 s are too few: a single pass of the scene's own setting, ") ||
                strstr(r.messages, "bis: error: 4 s are too few: the pilot alone, "));
    assert_false(program_exists(DIR "/slow"));
}

static void a_finished_measurement_resumes_to_itself(void **state)
{
    program_run r;
    assert_int_equal(system("cp -r " DIR "/own " DIR "/again"), 0);
    program_expect(&r, 0, "trade " SCENE " --resume --nthreads 1 --output " DIR "/again");
    assert_non_null(strstr(r.output, DIR "/again/report.html\n"));
    assert_int_equal(system("cmp -s " DIR "/own/runs.csv " DIR "/again/runs.csv && cmp -s " DIR "/own/trade.csv " DIR
                            "/again/trade.csv"),
        0);
    assert_int_equal(system("cmp -s " DIR "/own/pictures.csv " DIR "/again/pictures.csv"), 0);
}

static void a_signal_keeps_what_was_measured_and_resume_goes_on(void **state)
{
    const struct timespec pause = {0, 5000000};
    program_run r;
    table t;
    const char command[] =
        "trade " SCENE " --passes 4096 --seeds 1 --nthreads 1 --time 10 --integrator mis --reference " DIR
        "/given.exr --output " DIR "/stopped";
    pid_t pid = program_start(command);
    program_wait_for_handler(pid, SIGINT);
    for (int i = 0; i < 12000 && !program_exists(DIR "/stopped/runs.csv"); i++)
        nanosleep(&pause, NULL); /* the first is written after a second */
    kill(pid, SIGINT);
    program_finish(&r, pid);
    assert_int_equal(r.exit_status, 130);
    assert_true(program_exists(DIR "/stopped/report.html"));
    read_table(&t, DIR "/stopped/runs.csv");
    const int before = t.n_rows;
    assert_true(before > 1);
    assert_int_equal((int)number_at(&t, 1, "passes"), 1);
    clear_table(&t);
    assert_int_equal(
        system("cp " DIR "/stopped/runs.csv " DIR "/before.csv && sed -i 's/^setting 13 /setting 6 /;s/^run_seconds "
                                                  ".*/run_seconds 0.01/' " DIR "/stopped/plan.txt && "
               "awk -F, 'NR == 1 || $2 <= 32' " DIR "/before.csv > " DIR "/stopped/runs.csv"),
        0); /* enough for a test */
    program_expect(&r, 0, "trade " SCENE " --resume --nthreads 1 --output " DIR "/stopped");
    read_table(&t, DIR "/stopped/runs.csv");
    assert_true((t.n_rows - 1) % 6 == 0);
    clear_table(&t);
}

/* Before anything new: no advice, and the folder as it was. */
static void a_signal_right_after_resume_leaves_everything_as_it_was(void **state)
{
    static volatile sig_atomic_t flag = 1;
    const char *const integrators[] = {"mis"};
    const bis_trade_options o = {.scene = SCENE,
        .folder = DIR "/own",
        .seconds = 4,
        .resume = true,
        .n_threads = 1,
        .integrators = integrators,
        .interrupted = &flag};
    bis_trade t = {.n_runs = 0};
    bis_diag diag = {0};
    bool interrupted;
    assert_int_equal(bis_trade_measure(&t, &o, &interrupted, &diag), BIS_OK);
    assert_true(interrupted && !t.is_reported && t.n_runs > 0);
    bis_trade_clear(&t);
    bis_diag_clear(&diag);

    program_run r;
    assert_int_equal(system("cp -r " DIR "/own " DIR "/soon"), 0);
    pid_t pid = program_start("trade " SCENE " --resume --nthreads 1 --output " DIR "/soon");
    program_wait_for_handler(pid, SIGINT);
    kill(pid, SIGINT);
    program_finish(&r, pid);
    assert_int_equal(r.exit_status, 130);
    assert_null(strstr(r.output, "(null)"));
    if (!r.output[0]) assert_non_null(strstr(r.messages, "interrupted before anything new was measured"));
    assert_int_equal(system("cmp -s " DIR "/own/runs.csv " DIR "/soon/runs.csv"), 0);
}

static void stop_at_the_proof(const char *what, double share, double seconds_left, void *user)
{
    if (strcmp(what, "error of the advice") == 0) *(volatile sig_atomic_t *)user = 1;
}

/* A finished measurement, resumed, and stopped while its advice is proven: the older page and tables stay. They do not
 * if a run is new, or if there is no page: what there is, is written. */
static void a_signal_at_the_proof_of_nothing_new_leaves_the_older_page(void **state)
{
    static const char *const change[] = {"true", "sed -i '$d' " DIR "/proof/runs.csv", "rm " DIR "/proof/report.html"};
    for (int i = 0; i < 3; i++) {
        char command[512];
        volatile sig_atomic_t flag = 0;
        const bis_trade_options o = {.scene = SCENE, .folder = DIR "/proof", .seconds = 4, .resume = true,
            .n_threads = 1, .interrupted = &flag, .progress = stop_at_the_proof, .user = (void *)&flag};
        bis_trade t;
        bis_diag diag = {0};
        bool interrupted;
        snprintf(command, sizeof command, "rm -rf " DIR "/proof && cp -r " DIR "/own " DIR "/proof && %s", change[i]);
        assert_int_equal(system(command), 0);
        memset(&t, 0, sizeof t);
        assert_int_equal(bis_trade_measure(&t, &o, &interrupted, &diag), BIS_OK);
        assert_true(interrupted && t.is_complete && t.is_reported == (i > 0));
        assert_true(program_exists(DIR "/proof/report.html"));
        if (i == 0) assert_int_equal(system("diff -rq " DIR "/own " DIR "/proof"), 0);
        if (i == 1) assert_int_not_equal(system("cmp -s " DIR "/own/report.html " DIR "/proof/report.html"), 0);
        bis_trade_clear(&t);
        bis_diag_clear(&diag);
    }
}

/* During the pilot: nothing to keep, and the folder goes. */
static void a_signal_before_the_first_run_says_that_nothing_was_measured(void **state)
{
    program_run r;
    pid_t pid = program_start("trade " SCENE " --nthreads 1 --time 1000 --output " DIR "/early");
    program_wait_for_handler(pid, SIGINT);
    kill(pid, SIGINT);
    program_finish(&r, pid);
    assert_int_equal(r.exit_status, 130);
    assert_non_null(strstr(r.messages, "interrupted before the first run"));
    assert_false(program_exists(DIR "/early"));
}

static void the_page_is_well_formed_and_needs_nothing_else(void **state)
{
    static const char *const folders[] = {DIR "/own", DIR "/given"};
    for (int i = 0; i < 2; i++) {
        char why[200], path[256];
        table pictures;
        snprintf(path, sizeof path, "%s/pictures.csv", folders[i]);
        read_table(&pictures, path);
        const int n = pictures.n_rows - 1; /* mis, sir, and the scene's own where another sir is better */
        clear_table(&pictures);
        assert_true(n == 2 || n == 3);
        snprintf(path, sizeof path, "%s/report.html", folders[i]);
        char *page = read_whole(path);
        if (!html_is_well_formed(page, why, sizeof why)) fail_msg("%s: %s", path, why);
        if (!html_is_self_contained(page, why, sizeof why)) fail_msg("%s: %s", path, why);
        bis_free(page);
        page = page_data(path);
        assert_true(json_is_valid(page));
        assert_int_equal(html_count(page, "data:image/png;base64,"), 1 + 2 * n);
        free(page);
        page = page_shown(path, folders[i]);
        if (!page) continue;
        assert_int_equal(html_count(page, "<svg"), 2);
        assert_int_equal(html_count(page, "class=\"card "), 3);
        assert_int_equal(html_count(page, "class=\"shot"), 1 + n);
        assert_int_equal(html_count(page, "id=\"cut\""), 1);
        assert_true(html_count(page, "<tr>") > 20);
        static const char *const no_figures[] = {"nan", "NaN", "undefined", ">inf", " inf ", "inf%", "Infinity"};
        for (int k = 0; k < 7; k++) assert_int_equal(html_count(page, no_figures[k]), 0);
        free(page);
    }
}

static void the_checker_of_pages_can_fail(void **state)
{
    static const char *const broken[] = {
        "<p></p>", "<!DOCTYPE html><p>", "<!DOCTYPE html></p>", "<!DOCTYPE html><p><b></p></b>",
        "<!DOCTYPE html><p class=x></p>", "<!DOCTYPE html><p>a & b</p>",
        "<!DOCTYPE html><p>a < b</p>", "<!DOCTYPE html><p title=\"a></p>", "<!DOCTYPE html><style>p{}",
        "<!DOCTYPE html><br>",
    };
    static const char *const foreign[] = {
        "<a href=\"x\"/>", "see http://example.org", "url(x.png)", "<img src=\"x\"/>", "@import x"};
    char why[200];
    assert_true(html_is_well_formed(
        "<!DOCTYPE html>\n<p a=\"1\">x &amp; <b>y</b><br/></p><script>a<b&&c</script>", why, sizeof why));
    for (size_t i = 0; i < sizeof broken / sizeof *broken; i++)
        assert_false(html_is_well_formed(broken[i], why, sizeof why));
    for (size_t i = 0; i < sizeof foreign / sizeof *foreign; i++)
        assert_false(html_is_self_contained(foreign[i], why, sizeof why));
    assert_true(html_is_self_contained("url(data:image/png;base64,AAAA)", why, sizeof why));
}

static void odd_names_do_not_break_the_page(void **state)
{
    char why[200];
    program_run r;
    assert_int_equal(rename(SCENE, DIR "/a<b>&\"c'.txt"), 0);
    program_expect(&r, 0,
        "trade " DIR "/a<b>&\"c'.txt --nthreads 1 --time 2 --passes 1 --seeds 1 --integrator em --output " DIR "/odd");
    assert_int_equal(rename(DIR "/a<b>&\"c'.txt", SCENE), 0);
    char *page = read_whole(DIR "/odd/report.html");
    if (!html_is_well_formed(page, why, sizeof why)) fail_msg("%s", why);
    bis_free(page);
    page = page_shown(DIR "/odd/report.html", DIR);
    if (page) assert_non_null(strstr(page, "<h1>a&lt;b&gt;&amp;&quot;c&#39;.txt</h1>"));
    free(page);
}

/* ---- bad input ---- */

static void a_folder_with_other_things_is_left_alone(void **state)
{
    program_run r;
    assert_int_equal(mkdir(DIR "/mine", 0777), 0);
    program_write_file(DIR "/mine/letter.txt", "dear");
    program_expect(&r, 2, SMALL DIR "/mine");
    assert_non_null(strstr(r.messages, "letter.txt"));
    program_expect(&r, 2, "trade " SCENE " --resume --output " DIR "/mine");
    assert_int_equal(program_count_files(DIR "/mine"), 1);

    program_expect(&r, 2, SMALL DIR "/own"); /* a measurement, and no --resume */
    assert_non_null(strstr(r.messages, "--resume"));
    program_expect(&r, 2, "trade " SCENE " --resume --seeds 3 --output " DIR "/own");
    program_expect(&r, 2, SMALL SCENE); /* a file */
    program_expect(&r, 1, SMALL DIR "/no/such/place");
    char longest[3802] = DIR;
    memset(longest + strlen(DIR), '/', sizeof longest - 1 - strlen(DIR));
    program_expect(&r, 2, SMALL "%s", longest);
    assert_string_equal(r.messages, "bis: error: --output has a name of 3801 bytes; take a shorter one\n");
}

/* Of plan.txt, the line that is named where a field is outside its range. Whole messages are in
 * tests/data/expect/trade/damages.expect, the fields of runs.csv in test_trade_hand.c. */
static const struct {
    int line;
    const char *edit; /* a script for sed */
} damages[] = {
    {1, "s/^fingerprint .*/fingerprint 12/"}, {2, "s/^full .*/full 0 16/"}, {2, "s/^full .*/full 24.5 16/"},
    {2, "s/^full .*/full 24 16 3/"}, {3, "s/^step .*/step 0/"}, {4, "s/^size .*/size 24/"},
    {5, "s/^seeds .*/seeds 0/"}, {5, "s/^seeds .*/seeds nan/"}, {6, "s/^seed .*/seed abc/"},
    {6, "s/^seed .*/seed -1/"}, {6, "s/^seed .*/seed 1.5/"}, {6, "s/^seed .*/seed 7x/"},
    {7, "s/^run_seconds .*/run_seconds 0/"}, {7, "s/^run_seconds .*/run_seconds inf/"},
    {9, "9s/^reference 0/reference 2/"}, {9, "9s/mis [0-9]*$/sir 64\\/4/"}, /* a sir must not judge sir */
    {9, "9s/mis [0-9]*$/nobody/"}, {10, "10s/^reference 1/reference 0/"},
    {11, "11s/^setting [0-9]* [^ ]*/setting 3 0/"}, {11, "11s/^\\(setting [^ ]* [^ ]*\\) [^ ]*/\\1 -1/"},
    {11, "11s/^\\(setting [^ ]* [^ ]* [^ ]*\\) [^ ]*/\\1 -1/"},
    {11, "11s/^\\(setting [^ ]* [^ ]* [^ ]*\\) [^ ]*/\\1 x/"}, {12, "11p"},
};

static void every_field_of_a_plan_is_checked(void **state)
{
    bis_trade t = {.o = {.scene = SCENE, .folder = DIR "/field", .resume = true, .n_threads = 1}};
    char command[512], place[16];
    assert_int_equal(mkdir(DIR "/field", 0777), 0);
    assert_int_equal(bis_trade_load(&t, NULL), BIS_OK);
    const bis_trade_plan empty = t.plan;
    for (size_t i = 0; i < sizeof damages / sizeof *damages; i++) {
        bis_diag diag = {0};
        snprintf(command, sizeof command, "cd " DIR "/field && cp ../own/plan.txt . && sed -i '%s' plan.txt && "
                 "! cmp -s plan.txt ../own/plan.txt", damages[i].edit);
        assert_int_equal(system(command), 0);
        t.plan = empty;
        const bis_status status = bis_trade_read_plan(&t, &diag);
        const char *text = diag.n ? diag.messages[diag.n - 1].text : "";
        snprintf(place, sizeof place, "plan.txt:%d:1", damages[i].line);
        if (status != BIS_INPUT || !strstr(text, place) || strstr(text, "(null)"))
            fail_msg("%s: %d\n%s", damages[i].edit, status, text);
        bis_diag_clear(&diag);
    }
    t.plan = empty;
    bis_trade_clear(&t);
}

static void a_scene_without_light_or_surface_has_nothing_to_trade(void **state)
{
    program_run r;
    program_write_file(DIR "/empty.txt", "WorldBegin\nLightSource \"infinite\"\n");
    program_expect(&r, 2, "trade " DIR "/empty.txt --output " DIR "/bad");
    assert_non_null(strstr(r.messages, "nothing to trade"));
    program_write_file(DIR "/dark.txt", "WorldBegin\nShape \"sphere\"\n");
    program_expect(&r, 2, "trade " DIR "/dark.txt --output " DIR "/bad");
    assert_non_null(strstr(r.messages, "no light"));
    assert_false(program_exists(DIR "/bad"));
}

static void a_constant_light_is_measured_too(void **state)
{
    program_run r;
    program_write_file(DIR "/constant.txt", "Film \"rgb\" \"integer xresolution\" 12 \"integer yresolution\" 8\nLookAt "
                                            "0 0 -4 0 0 0 0 1 0\nCamera \"perspective\"\nWorldBegin\n"
                                            "LightSource \"infinite\"\nShape \"sphere\"\n");
    program_expect(
        &r, 0, "trade " DIR "/constant.txt --nthreads 1 --time 4 --passes 2 --seeds 2 --output " DIR "/constant");
    char why[200], *page = read_whole(DIR "/constant/report.html");
    if (!html_is_well_formed(page, why, sizeof why)) fail_msg("%s", why);
    bis_free(page);
}

static void a_full_disk_is_told(void **state)
{
    program_run r;
    program_run_limited(&r, 2000, SMALL DIR "/full");
    assert_int_equal(r.exit_status, 1);
    assert_non_null(strstr(r.messages, "error"));
}

/* Of each 3 x 3 pixels of a picture the middle one, within a crop of columns 2 to 9 and rows 3 to 8. */
static void a_given_reference_gives_the_pixels_of_the_thin_film(void **state)
{
    const double crop[4] = {0.2, 0.9, 0.3, 0.8}; /* of 10 x 10: [2, 9) x [3, 8) */
    const bis_film all = bis_film_place(10, 10, crop, 1), some = bis_film_place(10, 10, crop, 3);
    bis_image full, thin;
    assert_int_equal(bis_image_init(&full, 7, 5, NULL), BIS_OK);
    for (int i = 0; i < 35; i++)
        full.pixels[i] = (rgb){(float)(2 + i % 7), (float)(3 + i / 7), 1}; /* its place in the picture */
    assert_int_equal(bis_trade_thin(&thin, &full, &all, &some, NULL), BIS_OK);
    assert_true(thin.width == 2 && thin.height == 2); /* 4 and 7 of 1, 4, 7; rows 4 and 7 */
    for (int i = 0; i < 4; i++)
        assert_true(thin.pixels[i].r == (float)(4 + 3 * (i % 2)) && thin.pixels[i].g == (float)(4 + 3 * (i / 2)));
    bis_image_clear(&full);
    bis_image_clear(&thin);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_run_is_the_render_of_its_seed_bit_for_bit),
        cmocka_unit_test(a_run_has_the_pixels_of_the_full_render),
        cmocka_unit_test(every_setting_budget_and_seed_is_measured_once_with_a_seed_of_its_own),
        cmocka_unit_test(the_table_says_what_the_runs_say),
        cmocka_unit_test(no_two_columns_of_a_table_have_one_name),
        cmocka_unit_test(the_pages_exposure_is_that_of_bis_render),
        cmocka_unit_test(the_exposure_weighs_each_pixel_by_what_is_covered_of_it),
        cmocka_unit_test(the_references_noise_is_measured_and_subtracted_and_no_method_judges_itself),
        cmocka_unit_test(the_root_law_gives_slope_minus_half_and_a_constant_cost),
        cmocka_unit_test(a_biased_method_shows_in_the_slope_and_is_never_extrapolated_nor_recommended),
        cmocka_unit_test(the_line_for_a_scene_file_is_the_setting),
        cmocka_unit_test(a_product_that_learns_has_a_row_of_its_own),
        cmocka_unit_test(the_seconds_of_a_setting_are_those_of_its_passes),
        cmocka_unit_test(the_enlarged_parts_do_not_overlap),
        cmocka_unit_test(the_scatter_of_renders_is_their_variance),
        cmocka_unit_test(passes_are_advised_that_make_a_square_grid),
        cmocka_unit_test(what_is_promised_comes_out),
        cmocka_unit_test(what_is_extrapolated_comes_out_where_all_error_is_at_edges),
        cmocka_unit_test(lost_runs_are_measured_again_and_are_the_same),
        cmocka_unit_test(no_run_at_all_is_an_error),
        cmocka_unit_test(a_scene_that_is_too_slow_is_refused_before_its_pilot),
        cmocka_unit_test(a_finished_measurement_resumes_to_itself),
        cmocka_unit_test(a_signal_keeps_what_was_measured_and_resume_goes_on),
        cmocka_unit_test(a_signal_right_after_resume_leaves_everything_as_it_was),
        cmocka_unit_test(a_signal_at_the_proof_of_nothing_new_leaves_the_older_page),
        cmocka_unit_test(a_signal_before_the_first_run_says_that_nothing_was_measured),
        cmocka_unit_test(the_page_is_well_formed_and_needs_nothing_else),
        cmocka_unit_test(the_checker_of_pages_can_fail),
        cmocka_unit_test(odd_names_do_not_break_the_page),
        cmocka_unit_test(a_folder_with_other_things_is_left_alone),
        cmocka_unit_test(every_field_of_a_plan_is_checked),
        cmocka_unit_test(a_scene_without_light_or_surface_has_nothing_to_trade),
        cmocka_unit_test(a_constant_light_is_measured_too),
        cmocka_unit_test(a_full_disk_is_told),
        cmocka_unit_test(a_given_reference_gives_the_pixels_of_the_thin_film),
    };
    static const expect_text texts[] = {{"scene", SCENE}, {"folder", DIR}, {NULL, NULL}};
    return expect_run("trade", tests, sizeof tests / sizeof *tests, setup, NULL,
                      &(expect_folder){"tests/data/expect/trade-command", NULL, texts});
}
