/* SPDX-License-Identifier: BSD-2-Clause */
/* `bis trade` by hand: a sweep whose runs stand in this file. What follows from them, points, curves, the front,
 * advice, tables, plots and page, was worked out on paper; so were a plan from a pilot's figures and the words for a
 * damaged folder. One small measurement is resumed, for its order and its progress. Texts and tables are held by
 * tests/data/expect/trade; what is C here compares figures that they round, or says what a folder is damaged by. */
#include "base/text.h"
#include "tools/trade/trade_advice.h"
#include "tools/trade/trade_files.h"
#include "tools/trade/trade_page.h"
#include "tools/trade/trade_pictures.h"
#include "tools/trade/trade_plan.h"
#include "tools/trade/trade_scene.h"
#include "tools/trade/trade_settings.h"
#include "tools/trade/trade_stats.h"
#include "tools/trade/trade_tables.h"

#include "bis/base/file.h"
#include "bis/base/mem.h"
#include "bis/base/version.h"
#include "bis/files/image_file.h"
#include "cli/cli.h"
#include "claim.h"
#include "expect.h"
#include "file_help.h"
#include "further.h"
#include "json_check.h"
#include "page_help.h"
#include "picture_help.h"
#include "program.h"
#include "bis/tools/compare.h"

#include <dlfcn.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#define DIR "build/test_trade_hand"

static int setup(void **state)
{
    assert_int_equal(system("rm -rf " DIR), 0); /* its folders, too */
    program_folder(DIR);
    program_write_scene(DIR, "Sampler \"stratified\"\n");
    return 0;
}

static void assert_near(double a, double b)
{
    if (!(fabs(a - b) <= 1e-9 * fmax(fabs(a), fabs(b))) && !(isnan(a) && isnan(b))) fail_msg("%.17g is not %.17g", a,
        b);
}

/* ---- time ---- */

/* This program's own clock, which the library reads: once it is set, it stands where it was put, and goes on by `step`
 * whenever the thread that set it reads it. Nanoseconds. From `alarm` on there is a signal. Other threads read the true
 * one, because those of Embree's scheduler read it whenever they wait. */
static _Thread_local struct {
    bool is_set;
    int64_t now, step, alarm;
    volatile sig_atomic_t signal;
} watch;

int clock_gettime(clockid_t of, struct timespec *t)
{
    static int (*real)(clockid_t, struct timespec *);
    if (!real) *(void **)&real = dlsym(RTLD_NEXT, "clock_gettime");
    if (!watch.is_set || of != CLOCK_MONOTONIC) return real(of, t);
    *t = (struct timespec){watch.now / 1000000000, watch.now % 1000000000};
    watch.now += watch.step;
    watch.signal |= watch.now > watch.alarm;
    return 0;
}

/* The clock shows 1000 s, and each reading takes so many seconds. */
static void set_watch(double step)
{
    watch.is_set = true;
    watch.now = 1000 * (int64_t)1000000000;
    watch.step = (int64_t)(1e9 * step);
    watch.alarm = INT64_MAX;
    watch.signal = 0;
}

/* The signal comes so many seconds from now. */
static void set_alarm(double seconds) { watch.alarm = watch.now + (int64_t)(1e9 * seconds); }

static void move_watch(double seconds) { watch.now += (int64_t)(1e9 * seconds); }

/* What the last reading was. */
static double last_reading(void) { return 1e-9 * (double)(watch.now - watch.step); }

/* ---- the sweep ---- */

enum { EM, MIS, MIS_LONG, SIR, REJECTION, BRDF, N_SETTINGS };

static void add_setting(bis_trade *t, const char *name, const bis_integrator *integrator, int levels)
{
    bis_trade_setting *s = &t->plan.settings[t->plan.n_settings++];
    *s = (bis_trade_setting){.settings = bis_settings_default(integrator), .area_exponent = 1, .is_swept = true,
        .levels = levels};
    snprintf(s->name, sizeof s->name, "%s", name);
}

/* One run of each of n seeds, the last first: a mean over them does not depend on their order, and a median must
 * sort. */
static void add_runs(bis_trade *t, int setting, int level, int n, const double *seconds, const double *noise)
{
    static const double rmse[] = {3, 4, 5}, relmse[] = {0.1, 0.2, 0.6}, bias[] = {-0.1, 0.2, 0.2};
    for (int k = n - 1; k >= 0; k--) {
        const uint64_t passes = (uint64_t)(k + 1) << level;
        const bis_trade_run run = {setting, level, k, 77, seconds[k], 100 * passes, 10 * passes, 1000 * passes, rmse[k],
                                   relmse[k], bias[k], noise[k] + 1 / 64.0};
        assert_int_equal(bis_trade_add_run(t, &run, NULL), BIS_OK);
    }
}

/* The references add 1/64 to a relMSE. em keeps the root law, with seeds of unlike noise and speed. mis is twice as
 * good for twice the time, until it goes below what the references can tell. sir is the best by its mean alone: one of
 * its seeds was far worse. A brdf was too slow. */
static void forge(bis_trade *t)
{
    static const double unlike[] = {1.5, 1, 2}, steps[] = {0.25, 0.0625, 1 / 64.0, 1 / 512.0};
    *t = (bis_trade){.desc = bis_alloc(1, sizeof(bis_scene_desc)), .n_threads = 2, .o = {.scene = "a/hand.txt",
        .folder = DIR}};
    assert_non_null(t->desc);
    t->desc->view.film.crop[1] = t->desc->view.film.crop[3] = 1;
    t->desc->light.area_exponent = 1;
    t->plan = (bis_trade_plan){.n_seeds = 3, .full_width = 8, .full_height = 4, .step = 2, .width = 4, .height = 2,
        .run_seconds = 4,
                               .reference = {MIS_LONG, SIR}, .reference_passes = {5, 7}};
    add_setting(t, "em 16", &bis_em, 3);
    add_setting(t, "mis 16", &bis_mis, 4);
    add_setting(t, "mis 64", &bis_mis, 1);
    add_setting(t, "sir 64/4", &bis_sir, 1);
    add_setting(t, "rejection 100/8", &bis_rejection, 2);
    add_setting(t, "brdf 16", &bis_brdf, 0);
    t->plan.settings[MIS_LONG].is_scenes = t->plan.settings[REJECTION].is_biased = true;
    t->plan.settings[MIS_LONG].settings.samples = 64;
    t->plan.settings[SIR].settings.candidates = 64;
    t->plan.settings[SIR].settings.shadowrays = 4;
    t->plan.settings[SIR].fill_seconds = 0.2;
    t->plan.settings[BRDF].pass_seconds = 30;
    t->both = (bis_trade_reference){.relmse = 1 / 64.0, .mean = 0.5, .is_ready = true};
    t->references[0] = (bis_trade_reference){.relmse = 0.04, .mean = 0.5, .se = 0.03, .is_ready = true};
    t->references[1] = (bis_trade_reference){.relmse = 0.0225, .mean = 0.51, .se = 0.04, .is_ready = true};
    assert_int_equal(bis_image_init(&t->both.image, 4, 2, NULL), BIS_OK);
    for (int level = 0; level < 3; level++) {
        double s[3], v[3];
        for (int k = 0; k < 3; k++) s[k] = unlike[k] * exp2(level), v[k] = 0.25 * (k + 1) / exp2(level);
        add_runs(t, EM, level, 3, s, v);
    }
    for (int level = 0; level < 4; level++) {
        const double s = exp2(level), v = steps[level];
        add_runs(t, MIS, level, 3, (double[]){s, s, s}, (double[]){v, v, v});
    }
    add_runs(t, MIS_LONG, 0, 1, (double[]){3}, (double[]){0.0625});
    add_runs(t, SIR, 0, 3, (double[]){1, 1, 1}, (double[]){0.01, 0.01, 0.13});
    add_runs(t, REJECTION, 0, 2, (double[]){0.5, 0.5}, (double[]){0.04, 0.04});
    add_runs(t, REJECTION, 1, 2, (double[]){1, 1}, (double[]){0.04, 0.04});
    assert_int_equal(bis_trade_summarise(t, NULL), BIS_OK);
}

static void clear(bis_trade *t)
{
    if (!t->scene) bis_free(t->desc), t->desc = NULL;
    bis_trade_clear(t);
}

/* ---- points and curves ---- */

static void points_are_means_and_medians_of_their_seeds(void **state)
{
    bis_trade t;
    forge(&t);
    static const struct {
        int setting, level, n;
        double seconds, noise, noise_se;
        bool on_front;
    } expected[] = {
        {EM, 0, 3, 1.5, 0.5, 0.25 / 1.7320508075688772, false}, /* of 0.25, 0.5, 0.75 the deviation is 0.25 */
        {EM, 1, 3, 3, 0.25, 0.125 / 1.7320508075688772, false},
        {EM, 2, 3, 6, 0.125, 0.0625 / 1.7320508075688772, false},
        {MIS, 0, 3, 1, 0.25, 0, false},
        {MIS, 1, 3, 2, 0.0625, 0, false},
        {MIS, 2, 3, 4, 1 / 64.0, 0, true},
        {MIS, 3, 3, 8, 1 / 512.0, 0, true},
        {MIS_LONG, 0, 1, 3, 0.0625, (double)NAN, false},
        {SIR, 0, 3, 1, 0.05, 0.04, false}, /* sqrt((2 x 0.04^2 + 0.08^2)/2/3) */
        {REJECTION, 0, 2, 0.5, 0.04, 0, true},
        {REJECTION, 1, 2, 1, 0.04, 0, false}, /* as right as the one before, later */
    };
    assert_int_equal(t.result.n_points, sizeof expected / sizeof *expected);
    for (int i = 0; i < t.result.n_points; i++) {
        const bis_trade_point *p = &t.result.points[i];
        const double passes = exp2(p->level), n = expected[i].n, each = passes * (n + 1) / 2; /* of 1 ... n passes */
        assert_true(p->setting == expected[i].setting && p->level == expected[i].level && p->n == expected[i].n);
        assert_true(p->passes == passes && p->on_front == expected[i].on_front);
        assert_near(p->seconds, expected[i].seconds);
        assert_near(p->noise, expected[i].noise);
        if (expected[i].noise_se > 0) assert_near(p->noise_se, expected[i].noise_se);
        else assert_true(n == 1 ? isnan(p->noise_se) : fabs(p->noise_se) < 1e-15);
        assert_near(p->cost_variance, expected[i].seconds * expected[i].noise);
        assert_true(p->camera_rays == 100 * each && p->shadow_rays == 10 * each && p->candidates == 1000 * each);
        const double se = p->setting == SIR || p->setting == REJECTION ? 0.03 : 0.04;
            /* of the reference by the other */
        assert_near(p->rmse, n == 3 ? sqrt(50 / 3.0) : n == 2 ? sqrt(12.5) : 3);
        assert_near(p->relmse, n == 3 ? 0.3 : n == 2 ? 0.15 : 0.1);
        assert_near(p->relmse_se, n == 3 ? sqrt(0.14 / 6) : n == 2 ? 0.05 : (double)NAN);
        assert_near(p->bias, n == 3 ? 0.1 : n == 2 ? 0.05 : -0.1);
        assert_near(p->bias_se, n == 3 ? hypot(0.1, se) : n == 2 ? hypot(0.15, se) : (double)NAN);
    }
    clear(&t);
}

/* Five seeds of 1, 2, 3, 4, 5 s, or four of 1, 2, 4, 8 s, in each of their orders: the median is 3. */
static void a_median_does_not_depend_on_the_order(void **state)
{
    static const double seconds[2][5] = {{1, 2, 3, 4, 5}, {1, 2, 4, 8}};
    for (int k = 0; k < 2; k++) {
        const int n = 5 - k;
        for (int order = 0; order < (k ? 24 : 120); order++) {
            double left[5];
            bis_trade t = {.desc = bis_alloc(1, sizeof(bis_scene_desc)),
                           .plan = {.full_width = 1, .full_height = 1, .width = 1, .height = 1, .n_seeds = n}};
            assert_non_null(t.desc);
            memcpy(left, seconds[k], sizeof left);
            add_setting(&t, "em 16", &bis_em, 1);
            for (int i = 0, rest = order; i < n; i++) { /* one of those that are left, which are n - i */
                const int at = rest % (n - i);
                const bis_trade_run run = {.replicate = i, .seconds = left[at], .relmse_both = 1};
                rest /= n - i;
                left[at] = left[n - i - 1];
                assert_int_equal(bis_trade_add_run(&t, &run, NULL), BIS_OK);
            }
            assert_int_equal(bis_trade_summarise(&t, NULL), BIS_OK);
            assert_true(t.result.n_points == 1 && t.result.points[0].seconds == 3);
            clear(&t);
        }
    }
}

/* A seed's cost is that of its budgets, weighted by their passes. em: seconds x noise is 0.25 x 1.5, 2, 6 for the
 * three. mis: (1 x 1/4 + 2 x 2/16 + 4 x 4/64 + 8 x 8/512)/15; each budget but the last, which the references hide, is
 * half the error for twice the time. */
static void curves_are_weighted_by_passes_and_leave_out_what_is_hidden(void **state)
{
    bis_trade t;
    forge(&t);
    static const struct {
        int first, n;
        double cost, se, slope, pass;
    } expected[] = {{0, 3, 0.25 * 9.5 / 3, 0.25 * 1.4240006242195884, -0.5, 1.5}, {3, 4, 0.875 / 15, 0, -1, 1}, {7, 1,
        0.1875, (double)NAN, (double)NAN, 3},
                    {8, 1, 0.05, 0.04, (double)NAN, 1}, {9, 2, 0.1 / 3, 0, (double)NAN, 0.5}};
    for (int i = 0; i < 5; i++) {
        const bis_trade_curve *c = &t.result.curves[i];
        assert_true(c->first == expected[i].first && c->n == expected[i].n);
        assert_near(c->cost_variance, expected[i].cost);
        if (expected[i].se == 0) assert_true(c->cost_variance_se < 1e-15);
        else assert_near(c->cost_variance_se, expected[i].se);
        assert_near(c->slope, expected[i].slope);
        assert_true(isnan(expected[i].slope) ? isnan(c->slope_se) : c->slope_se < 1e-12);
        assert_near(c->pass_seconds, expected[i].pass);
    }
    assert_int_equal(t.result.curves[BRDF].n, 0);

    /* an error that is seen, and a clock that did not tick: the slope is that of the other three, 2, 4, 8 s and errors
     * of 2^-2, 2^-3, 2^-3.5 */
    for (size_t i = 0; i < t.n_runs; i++) {
        bis_trade_run *r = &t.runs[i];
        if (r->setting == MIS && r->level == 0) r->seconds = 0;
        if (r->setting == MIS && r->level == 3) r->relmse_both = 1 / 64.0 + 1 / 128.0;
    }
    bis_free(t.result.points);
    t.result = (bis_trade_result){0};
    assert_int_equal(bis_trade_summarise(&t, NULL), BIS_OK);
    assert_near(t.result.curves[MIS].slope, -0.75);
    clear(&t);
}

/* Two equal points hide neither the other; one as fast and less right, or as right and slower, is hidden; all come in
 * the order of time. */
static void equal_points_are_both_on_the_front(void **state)
{
    bis_trade t;
    forge(&t);
    t.n_runs = 0;
    bis_free(t.result.points);
    t.result = (bis_trade_result){0};
    add_runs(&t, EM, 0, 1, (double[]){2}, (double[]){0.5});
    add_runs(&t, MIS, 0, 1, (double[]){1}, (double[]){1});
    add_runs(&t, SIR, 0, 1, (double[]){2}, (double[]){0.5});
    add_runs(&t, REJECTION, 0, 1, (double[]){1}, (double[]){2});
    add_runs(&t, REJECTION, 1, 1, (double[]){1.5}, (double[]){1});
    assert_int_equal(bis_trade_summarise(&t, NULL), BIS_OK);
    static const int order[] = {MIS, EM, SIR};
    int n = 0;
    for (const bis_trade_point *p = NULL; (p = bis_trade_next_on_front(&t.result, p));) assert_int_equal(p->setting,
        order[n++]);
    assert_int_equal(n, 3);
    clear(&t);
}

/* ---- advice ---- */

static void errors_at_a_time_and_times_to_an_error_lie_on_lines_between_the_budgets(void **state)
{
    const double end = sqrt(1 / 512.0), none = (double)NAN;
    const struct {
        int setting;
        double at, value;
        bool extrapolated;
    } errors[] = {{MIS, 0.99, none, false}, {MIS, 1, 0.5, false}, {MIS, 1.6, 0.5 / 1.6, false}, {MIS, 3, 0.5 / 3,
        false}, /* error x time is 0.5 */
                  {MIS, 4, 0.125, false}, {MIS, sqrt(32.0), sqrt(0.125 * end), false}, {MIS, 8, end, false}, {MIS, 32,
                      end / 2, true},
                  {MIS, 512, end / 8, true}, {MIS, 513, none, true}, {MIS_LONG, 3, 0.25, false}, {MIS_LONG, 12, 0.125,
                      true},
                  {REJECTION, 0.7, 0.2, false}, {REJECTION, 1, 0.2, false}, {REJECTION, 1.01, none, true}, {BRDF, 1,
                      none, false}},
      times[] = {{MIS, 0.6, 1, false}, {MIS, 0.5, 1, false}, {MIS, 0.3, 0.5 / 0.3, false}, {MIS, 0.2, 2.5, false},
          {MIS, 0.125, 4, false},
                 {MIS, sqrt(0.125 * end), sqrt(32.0), false}, {MIS, end / 2, 32, true}, {MIS, end / 7.9,
                     8 * 7.9 * 7.9, true},
                 {MIS, end / 8.1, none, true}, {EM, 0.25, 12, true}, {REJECTION, 0.2, 0.5, false}, {REJECTION, 0.1,
                     none, true},
                 {BRDF, 1, none, false}};
    bis_trade t;
    bool extrapolated;
    forge(&t);
    for (size_t i = 0; i < sizeof errors / sizeof *errors; i++) {
        extrapolated = !errors[i].extrapolated;
        assert_near(bis_trade_error_at(&t.result, &t.plan, errors[i].setting, errors[i].at, &extrapolated),
            errors[i].value);
        assert_int_equal(extrapolated, errors[i].extrapolated);
    }
    for (size_t i = 0; i < sizeof times / sizeof *times; i++) {
        extrapolated = !times[i].extrapolated;
        assert_near(bis_trade_seconds_to(&t.result, &t.plan, times[i].setting, times[i].at, &extrapolated),
            times[i].value);
        assert_int_equal(extrapolated, times[i].extrapolated);
    }
    t.result.points[4].noise = -0.001; /* without a logarithm: the budget before */
    assert_near(bis_trade_error_at(&t.result, &t.plan, MIS, 1.5, &extrapolated), 0.5);
    assert_near(bis_trade_seconds_to(&t.result, &t.plan, MIS, 0.3, &extrapolated), 2);
    t.result.points[3].seconds = 0;
    t.result.points[4].noise = 0.0625;
    assert_near(bis_trade_error_at(&t.result, &t.plan, MIS, 1.5, &extrapolated), 0.5);
    clear(&t);
}

static void the_best_counts_its_standard_error_and_no_bias(void **state)
{
    bis_trade t;
    int heads[BIS_TRADE_STRIP];
    forge(&t);
    assert_int_equal(t.result.best, MIS); /* sir: 0.05 + 0.04; rejection is biased */
    assert_int_equal(bis_trade_best_of(&t, "rejection"), REJECTION);
    assert_int_equal(bis_trade_best_of(&t, "mis"), MIS);
    assert_int_equal(bis_trade_best_of(&t, "brdf"), -1);
    assert_int_equal(bis_trade_best_of(&t, "em"), EM); /* the first */
    assert_int_equal(bis_trade_heads(&t, heads), 5); /* mis 64 is the scene's own */
    for (int i = 0; i < 5; i++) assert_true(heads[i] == i && bis_trade_is_head(&t, i));
    t.plan.settings[MIS_LONG].is_scenes = false;
    assert_int_equal(bis_trade_heads(&t, heads), 4);
    assert_true(heads[2] == SIR && !bis_trade_is_head(&t, MIS_LONG) && bis_trade_is_head(&t, REJECTION));

    /* mis 16, 0.875/15 a second of the film, 4 times that many pixels: 0.05 wants 23.3 passes of 4 s. sir has 0.05, 20
     * passes of 0.2 + 0.8 x 4 s: less, but not with its doubt, 1.8 times. */
    static const unsigned passes[] = {1, 3, 24};
    static const double errors[] = {0.5, 0.15, 0.05};
    static const char *const purposes[] = {"preview", "good picture", "final picture"};
    for (int i = 0; i < BIS_TRADE_ADVICE; i++) {
        const bis_trade_advice *a = &t.result.advice[i];
        assert_string_equal(a->purpose, purposes[i]);
        assert_true(a->setting == MIS && a->passes == passes[i] && a->error == errors[i] &&
            a->is_extrapolated == (i == 2));
        assert_near(a->seconds, 4.0 * passes[i]);
        assert_near(a->expected_error, sqrt(0.875 / 15 / passes[i]));
    }
    for (int more = 0; more < 2; more++) { /* 8 passes were measured, 9 are more */
        t.o.error = sqrt(0.875 / 15 / (7.5 + more));
        bis_trade_advise(&t);
        assert_true(t.result.advice[2].passes == 8u + (unsigned)more && t.result.advice[2].is_extrapolated == more);
    }
    t.result.curves[SIR].cost_variance_se = 0;
    t.o.error = 0.2;
    bis_trade_advise(&t);
    assert_true(t.result.best == SIR && t.result.advice[0].error == 0.5 && t.result.advice[1].error == 0.2);
    assert_true(t.result.advice[2].setting == SIR && t.result.advice[2].passes == 2 && t.result.advice[2].error == 0.2);
    assert_near(t.result.advice[2].seconds, 6.8);
    t.plan.n_settings = SIR; /* without sir; then sir is the last */
    assert_int_equal(bis_trade_best_of(&t, NULL), MIS);
    t.plan.n_settings = SIR + 1;
    assert_int_equal(bis_trade_best_of(&t, NULL), SIR);
    t.plan.n_settings = N_SETTINGS;
    t.o.error = 1e-6; /* 5e10 passes */
    bis_trade_advise(&t);
    assert_int_equal(t.result.advice[2].setting, -1);
    clear(&t);
}

static void no_more_heads_than_the_strip_has_places(void **state)
{
    bis_trade t = {.n_runs = 0};
    int heads[BIS_TRADE_STRIP + 1] = {0};
    for (int i = 0; i < BIS_TRADE_STRIP + 2; i++) {
        add_setting(&t, "em 16", &bis_em, 1);
        t.plan.settings[i].is_scenes = true;
        t.result.curves[i].n = 1;
    }
    heads[BIS_TRADE_STRIP] = 99;
    assert_int_equal(bis_trade_heads(&t, heads), BIS_TRADE_STRIP);
    assert_int_equal(heads[BIS_TRADE_STRIP], 99);
}

static void columns_are_halves_of_the_longest_run_and_round_errors(void **state)
{
    static const double halves[] = {0.5, 1, 2, 4}, rounded[] = {0.02, 0.03, 0.05, 0.1, 0.15, 0.2};
        /* from sqrt(1/512)/4 = 0.011 on */
    bis_trade t;
    double v[BIS_TRADE_COLUMNS];
    forge(&t);
    assert_int_equal(bis_trade_times(&t, v), 4);
    for (int i = 0; i < 4; i++) assert_near(v[i], halves[i]);
    assert_int_equal(bis_trade_errors(&t, v), 6);
    for (int i = 0; i < 6; i++) assert_near(v[i], rounded[i]);
    for (int i = 0; i < t.result.n_points; i++) t.result.points[i].noise = 4 * 4 * 0.03 * 0.03;
        /* a quarter of it is 3% */
    assert_int_equal(bis_trade_errors(&t, v), 6);
    assert_near(v[0], 0.03);
    for (int i = 0; i < t.result.n_points; i++) t.result.points[i].noise = 4 * 4 * 0.9 * 0.9;
    assert_int_equal(bis_trade_errors(&t, v), 3); /* the last steps: 100, 200, 500 % */
    assert_true(v[0] == 1 && v[1] == 2 && v[2] == 5);
    /* the first point alone, and the last alone */
    for (int k = 0; k < 2; k++) {
        bis_trade_point *const one = &t.result.points[k ? t.result.n_points - 1 : 0];
        for (int i = 0; i < t.result.n_points; i++) t.result.points[i].noise = 0, t.result.points[i].seconds = 3;
        one->noise = 0.4 * 0.4;
        one->seconds = 0.13;
        assert_int_equal(bis_trade_errors(&t, v), 6);
        assert_near(v[0], 0.1);
        assert_int_equal(bis_trade_times(&t, v), 5);
        assert_near(v[0], 0.25);
        one->noise = 0;
        assert_int_equal(bis_trade_errors(&t, v), 0); /* nothing that noise tells */
    }
    clear(&t);
}

/* `table FILE` of the forged runs; equal_error.csv with a noise of 8% for mis 16 with 8 passes. */
static int table(const expect_command *c)
{
    bis_trade t;
    char path[256];
    forge(&t);
    if (strcmp(c->arguments, "equal_error.csv") == 0) t.result.points[6].noise = 0.0064;
    assert_int_equal(bis_trade_write_tables(&t, NULL), BIS_OK);
    snprintf(path, sizeof path, DIR "/%s", c->arguments);
    char *text = read_whole(path);
    fputs(text, c->output);
    bis_free(text);
    clear(&t);
    return 0;
}

/* ---- the page ---- */

/* t keeps the plan, and gets the scene of DIR for its exposure. */
static void write_page(bis_trade *t)
{
    const bis_trade_plan plan = t->plan;
    const char *const scene = t->o.scene;
    bis_diag diag = {0};

    if (!t->scene) {
        t->o.scene = DIR "/scene.txt";
        bis_free(t->desc);
        assert_int_equal(bis_trade_load(t, NULL), BIS_OK);
    }
    t->o.scene = scene;
    t->plan = plan;
    for (int i = 0; i < plan.n_settings; i++) {
        t->plan.settings[i].area_exponent = t->desc->light.area_exponent + (i == SIR);
    }
    assert_int_equal(bis_trade_write_report(t, &diag), BIS_OK);
    bis_diag_clear(&diag);
}

static char *data_of(bis_trade *t)
{
    write_page(t);
    char *text = page_data(DIR "/report.html");
    if (!json_is_valid(text)) fail_msg("no JSON: %.300s", text);
    return text;
}

/* The words of the page; where no node shows it there is nothing to look at. */
static void assert_shown(const char *const *parts)
{
    char *text = page_shown(DIR "/report.html", DIR);
    if (text) page_in_order(text, parts);
    free(text);
}

/* What stands at a path: text with its quotation marks, or null. */
static void assert_value(const char *text, const char *path, const char *wanted)
{
    char is[256], mark[256] = "";
    for (size_t i = 0; wanted[i]; i++) mark[i] = wanted[i] == '`' ? '"' : wanted[i];
    json_value(is, sizeof is, text, path);
    if (strcmp(is, mark) != 0) fail_msg("%s is %s, not %s", path, is, mark);
}

/* The strip's methods err most at the lower right corner, both of them; one has a firefly, which counts as half. What
 * errs beside the corner is in no window that leaves the first alone. */
static void make_strip(bis_trade *t)
{
    bis_image_clear(&t->both.image);
    for (int k = 0; k < 3; k++) {
        bis_image *image = k == 2 ? &t->both.image : &t->strip[k].image;
        assert_int_equal(bis_image_init(image, 16, 8, NULL), BIS_OK);
        for (int i = 0; i < 16 * 8; i++) image->pixels[i] = (rgb){1, 1, 1};
        if (k == 2) break;
        image->pixels[7 * 16 + 15] = (rgb){9, 9, 9};
        image->pixels[6 * 16 + 13] = (rgb){1.5f, 1.5f, 1.5f};
    }
    t->strip[0].image.pixels[3 * 16 + 5] = (rgb){1e6f, 1e6f, 1e6f};
    t->strip[0].setting = REJECTION, t->strip[0].passes = 8, t->strip[0].seconds = 3.9, t->strip[0].relmse = 0.04;
    t->strip[1].setting = MIS, t->strip[1].passes = 1, t->strip[1].seconds = 4.1, t->strip[1].relmse = 0.0025;
    t->n_strip = 2;
}

/* The errors of shot 1 are those of `bis compare --diff` for its picture against the reference; the other way round
 * they are others. */
static void assert_error_picture(const bis_trade *t, const char *text)
{
    const size_t size = strlen(text) + 100;
    char *address = malloc(size), *drawing = malloc(size);
    bis_image image, right[2];
    double off[2] = {0};
    snprintf(drawing, size, "<image id=\"e\" href=%s", json_value(address, size, text, "shots.1.errors"));
    picture_in(&image, drawing, "e");
    assert_true(image.width == 16 && image.height == 8);
    for (int k = 0; k < 2; k++) {
        const bis_image *a = &t->strip[1].image, *b = &t->both.image;
        assert_int_equal(bis_compare_picture(&right[k], k ? b : a, k ? a : b, NULL), BIS_OK);
        for (int i = 0; i < 16 * 8; i++) off[k] = fmax(off[k],
            fabs(rgb_sum(image.pixels[i]) - rgb_sum(right[k].pixels[i])));
        bis_image_clear(&right[k]);
    }
    assert_true(off[0] < 0.03 && off[1] > 0.3); /* three bytes of sRGB, 0.009 each */
    bis_image_clear(&image);
    free(address);
    free(drawing);
}

static void forge_page(bis_trade *t)
{
    forge(t);
    t->plan.settings[MIS].is_scenes = true;
    t->plan.settings[MIS_LONG].is_scenes = false;
    t->result.curves[EM].slope_se = 0.02;
    t->result.advice[0].setting = -1;
    t->result.advice[1] = (bis_trade_advice){"good picture", 0.15, SIR, 3, 10.2, 0.13, false};
    add_setting(t, "brdf 64", &bis_brdf, 0);
    t->plan.settings[BRDF + 1].pass_seconds = 90;
    t->result.points[5].bias = -0.1; /* of mis 16 with 4 passes; from one seed */
    t->result.points[5].bias_se = (double)NAN;
    make_strip(t);
    t->plan.width = 16, t->plan.height = 8, t->plan.full_width = 32, t->plan.full_height = 16;
}

/* `data KEY NAME...`: what stands at these names of the object KEY ("-": of the whole), in a row. */
static int data(const expect_command *c)
{
    static char *text; /* of the one page, made once */
    char names[512], value[256];
    if (!text) {
        bis_trade t;
        forge_page(&t);
        text = data_of(&t);
        clear(&t);
    }
    snprintf(names, sizeof names, "%s", c->arguments);
    const char *const key = strtok(names, " "), *comma = "";
    for (const char *name; (name = strtok(NULL, " ")); comma = ",") {
        char path[256];
        snprintf(path, sizeof path, "%s%s%s", *key == '-' ? "" : key, *key == '-' ? "" : ".", name);
        fprintf(c->output, "%s%s", comma, json_value(value, sizeof value, text, path));
    }
    fputs("\n", c->output);
    return 0;
}

/* The pictures of the page; and that a setting may be left out that is the first of all. */
static void the_data_have_pictures_and_what_was_left_out(void **state)
{
    bis_trade t;
    forge_page(&t);
    char *text = data_of(&t);
    assert_error_picture(&t, text);
    free(text);
    t.plan.settings[EM].levels = 0;
    t.plan.settings[EM].pass_seconds = 45;
    text = data_of(&t);
    assert_value(text, "left_out.0.name", "`em 16`");
    free(text);
    clear(&t);
}

/* The members of each object of the page's data, in their order. */
static void the_data_have_their_members_in_order(void **state)
{
    static const char *const of[][2] = {
        {"", "scene version complete runs planned advice times errors best settings film run_seconds seeds threads "
             "references given noise difference difference_se left_out crops reference shots "},
        {"advice.0", "purpose setting "},
        {"advice.1", "purpose setting method candidates shadowrays samples error seconds passes extrapolated options "
                     "line "},
        {"settings.0", "name method biased own head cost_variance cost_variance_se slope slope_se points error_at "
                       "seconds_to "},
        {"settings.0.points.0", "passes seconds rays error error_se bias bias_se pareto "},
        {"settings.0.error_at.0", "value extrapolated "}, {"settings.0.seconds_to.0", "value extrapolated "},
        {"film", "width height full_width full_height step "},
        {"references.0", "judges name renders passes mean se noise "}, {"left_out.0", "name pass_seconds "},
        {"crops.0", "x y width height "}, {"shots.0", "setting passes seconds error picture errors "}};
    bis_trade t;
    char keys[512];
    forge_page(&t);
    char *const text = data_of(&t);
    for (size_t i = 0; i < sizeof of / sizeof *of; i++)
        assert_string_equal(json_keys(keys, sizeof keys, text, of[i][0]), of[i][1]);
    free(text);
    clear(&t);
}

/* The parts that are enlarged are those of make_strip, whatever the unit of radiance: the first where both methods err,
 * the second, by rows, that holds the firefly. */
static void the_enlarged_parts_do_not_depend_on_the_unit(void **state)
{
    static const double units[] = {1, 0x1p-20, 0x1p20};
    for (size_t i = 0; i < sizeof units / sizeof *units; i++) {
        bis_trade t;
        forge_page(&t);
        for (int k = 0; k < 3; k++) {
            rgb *pixels = k == 2 ? t.both.image.pixels : t.strip[k].image.pixels;
            for (int p = 0; p < 16 * 8; p++) pixels[p] = rgb_scale(pixels[p], units[i]);
        }
        char *text = data_of(&t);
        assert_true(json_number(text, "crops.0.x") == 12 && json_number(text, "crops.0.y") == 6);
        assert_true(json_number(text, "crops.1.x") == 2 && json_number(text, "crops.1.y") == 2);
        free(text);
        clear(&t);
    }
}

/* The place of a point of the plot, by the words that a browser shows at it. */
static void assert_point(const char *page, const char *title, double x, double y)
{
    const char *axis = strstr(page, "class=\"p-axis\" d=\"M"), *at = strstr(page, title);
    double left, top, bottom, right, is[2];
    assert_true(axis && at);
    assert_int_equal(sscanf(axis, "class=\"p-axis\" d=\"M%lf %lfV%lfH%lf", &left, &top, &bottom, &right), 4);
    while (at > page && strncmp(at, "<path d=\"M", 10) != 0) at--;
    assert_int_equal(sscanf(at, "<path d=\"M%lf %lf", is, is + 1), 2);
    if (fabs(is[0] - (left + x * (right - left))) > 0.0051 || fabs(is[1] - (bottom + y * (top - bottom))) > 0.0051)
        fail_msg("%s is at %g, %g, not at %g, %g", title, is[0], is[1], left + x * (right - left),
            bottom + y * (top - bottom));
}

/* Axes: 0.5 ... 8 s are 0.4 ... 10 s, a ratio of 25; errors sqrt(1/512) ... sqrt(1/2), a ratio of 16, are one of 23.04.
 */
static void points_stand_where_the_axes_have_them(void **state)
{
    bis_trade t;
    forge_page(&t);
    write_page(&t);
    char *page = page_shown(DIR "/report.html", DIR);
    for (int k = 0; page && k < 3; k++) {
        static const char *const at[] = {
            "em 16, 2 passes: 50% in 3 s<", "mis 16, 8 passes: 4.4% in 8 s<", "rejection 100/8, 1 pass: 20% in 0.5 s<"};
        static const double seconds[] = {3, 8, 0.5}, squares[] = {0.25, 1 / 512.0, 0.04};
        assert_point(page, at[k], log(seconds[k] / 0.4) / log(25), log(1.2 * sqrt(512 * squares[k])) / log(23.04));
    }
    free(page);
    clear(&t);
}

/* All are biased, or none was measured: nothing to compare, no picture. */
static void assert_page_of_nothing(bis_trade *t)
{
    bis_image_clear(&t->strip[0].image);
    t->n_strip = 0;
    t->result.best = -1;
    char *text = data_of(t);
    assert_value(text, "best", "null");
    assert_value(text, "shots", "[]");
    assert_value(text, "crops", "[]");
    free(text);
    assert_shown((const char *const[]){"all methods are exact here", "How it was measured", NULL});
    for (int i = 0; i < 4; i++) t->result.curves[i].n = 0;
    t->result.n_points = 0;
    text = data_of(t);
    assert_value(text, "settings", "[]");
    free(text);
    assert_shown((const char *const[]){"<h1>", "How it was measured", NULL});
}

/* One seed, one thread, every pixel, a given reference, one picture; the best is the first of the table, a biased one
 * has nothing but the reference's noise. */
static void forge_one(bis_trade *t)
{
    *t = (bis_trade){.desc = bis_alloc(1, sizeof(bis_scene_desc)), .n_threads = 1,
                   .o = {.scene = "hand.txt", .folder = DIR}, .is_complete = true};
    assert_non_null(t->desc);
    t->desc->view.film.crop[1] = t->desc->view.film.crop[3] = 1;
    t->plan = (bis_trade_plan){.n_seeds = 1, .full_width = 4, .full_height = 2, .step = 1, .width = 4, .height = 2,
                              .run_seconds = 4, .reference = {-1, -1}, .is_given = true};
    add_setting(t, "em 16 stratified", &bis_em, 1);
    add_setting(t, "mis 16 scene's own", &bis_mis, 1);
    add_setting(t, "rejection 100/8", &bis_rejection, 1);
    add_setting(t, "sir 64/1 independent", &bis_sir, 0);
    t->plan.settings[0].settings.samples = t->plan.settings[3].settings.shadowrays = 1;
    t->plan.settings[1].is_scenes = t->plan.settings[2].is_biased = true;
    t->plan.settings[3].settings.candidates = 64;
    t->plan.settings[3].is_swept = false;
    for (int k = 0; k < 2; k++) t->references[k] = (bis_trade_reference){.mean = 0.5, .is_ready = true};
    t->both = (bis_trade_reference){.mean = 0.5, .is_ready = true};
    for (int k = 0; k < 2; k++) {
        bis_image *const image = k ? &t->both.image : &t->strip[0].image;
        assert_int_equal(bis_image_init(image, 4, 2, NULL), BIS_OK);
        for (int i = 0; i < 4 * 2; i++) image->pixels[i] = (rgb){1, 1, 1};
    }
    t->strip[0].passes = 1, t->strip[0].seconds = 2, t->strip[0].relmse = 0.25;
    t->n_strip = 1;
    add_runs(t, 0, 0, 1, (double[]){2}, (double[]){0.25 - 1 / 64.0});
    add_runs(t, 1, 0, 1, (double[]){4}, (double[]){0.25 - 1 / 64.0});
    add_runs(t, 2, 0, 1, (double[]){1}, (double[]){-1 / 64.0});
    assert_int_equal(bis_trade_summarise(t, NULL), BIS_OK);
    assert_int_equal(t->result.best, 0);
    t->result.advice[0] = (bis_trade_advice){"preview", 0.5, 0, 1, 2, 0.5, false};
    t->result.advice[1] = (bis_trade_advice){"good picture", 0.15, 3, 2, 3, 0.2, true};
    t->result.advice[2].setting = -1;
}

/* `page runs`, `page one`: what the page of these shows. */
static int page(const expect_command *c)
{
    bis_trade t;
    if (strcmp(c->arguments, "one") == 0) forge_one(&t);
    else forge_page(&t);
    write_page(&t);
    char *text = page_shown(DIR "/report.html", DIR);
    if (text) fputs(text, c->output);
    clear(&t);
    const int status = text ? 0 : EXPECT_SKIPPED;
    free(text);
    return status;
}

/* References of its own, of which one is not ready: that one is not named, and there is nothing to agree with. */
static void the_page_of_one_names_no_reference_that_is_not_ready(void **state)
{
    bis_trade t;
    forge_one(&t);
    t.plan.is_given = false;
    t.plan.reference[0] = 1, t.plan.reference[1] = 3;
    t.references[1].is_ready = false;
    char *text = data_of(&t);
    assert_value(text, "references.0.name", "`mis 16 scene's own`");
    assert_value(text, "references.1.name", "");
    assert_value(text, "difference", "null");
    free(text);
    assert_shown((const char *const[]){"the mean of both", "reference for sir and rejection", NULL});

    assert_page_of_nothing(&t);
    clear(&t);
}

/* Where nothing has noise there is no plot. Beyond 2.6 decades only powers of ten have a figure; thousands of rays are
 * k: 100 and 2000 for each pixel, of 8. */
static void plots_have_the_figures_of_their_range(void **state)
{
    bis_trade t;
    forge(&t);
    for (int i = 2; i < t.result.n_points; i++) t.result.points[i].noise = 0;
    bis_trade_point *const p = t.result.points;
    p[0].seconds = 0.025, p[0].noise = 1;
    p[1].seconds = 40, p[1].noise = 0.0013 * 0.0013;
    p[0].camera_rays = 600, p[0].shadow_rays = 200;
    p[1].camera_rays = 4000, p[1].shadow_rays = 12000;
    write_page(&t);
    assert_shown(
        (const char *const[]){"<svg", ">0.1 s</text>", ">1 s</text>", ">10 s</text>", ">1%</text>", ">10%</text>",
            ">100%</text>", "<svg", ">100</text>", ">200</text>", ">500</text>", ">1k</text>", ">2k</text>", NULL});
    char *page = page_shown(DIR "/report.html", DIR);
    if (page) assert_null(strstr(page, ">2 s</text>")), assert_null(strstr(page, ">5%</text>"));
    free(page);
    for (int i = 0; i < 2; i++) p[i].noise = 0;
    write_page(&t);
    assert_shown((const char *const[]){"there is nothing to plot", "there is nothing to plot", NULL});
    clear(&t);
}

/* A browser without JavaScript gets the advice and the runs as text. */
static void without_a_script_the_page_is_text(void **state)
{
    bis_trade t;
    forge(&t);
    t.o.folder = DIR;
    write_page(&t);
    char *page = read_whole(DIR "/report.html");
    page_in_order(page, (const char *const[]){"<noscript>", "<pre id=`text`>", "final picture", "~96 s",
        "29 of 33 runs in " DIR "/report.html\n\nsetting                            passes       time      error "
        "on the Pareto front\n", "em 16 ", " 1 ", "1.5 s", "71%", "mis 16 ", " 8 ", "8 s",
        "4.4% yes\n",
        "rejection 100/8 ", "</pre>", "</noscript>", NULL});
    bis_free(page);
    clear(&t);
}

/* Without any advice the summary says what to do. */
static void a_summary_without_advice_says_so(void **state)
{
    bis_trade t;
    char *text;
    size_t n;
    forge(&t);
    for (int i = 0; i < BIS_TRADE_ADVICE; i++) t.result.advice[i].setting = -1;
    FILE *const out = open_memstream(&text, &n);
    bis_trade_print_summary(out, &t);
    fclose(out);
    assert_string_equal(text, "no advice: no setting has enough runs; give --resume --time more\n29 of 33 runs in "
                              DIR "/report.html\n");
    free(text);
    clear(&t);
}

/* The enlarged parts are quarters of the sides, rounded up: of 13 x 9 pixels 4 x 3. */
static void enlarged_parts_are_quarters_rounded_up(void **state)
{
    bis_trade t;
    forge(&t);
    t.plan.width = 13, t.plan.height = 9, t.plan.full_width = 26, t.plan.full_height = 18;
    bis_image_clear(&t.both.image);
    for (int k = 0; k < 2; k++) {
        bis_image *const image = k ? &t.both.image : &t.strip[0].image;
        assert_int_equal(bis_image_init(image, 13, 9, NULL), BIS_OK);
        for (int i = 0; i < 13 * 9; i++) image->pixels[i] = (rgb){1, 1, 1};
    }
    t.strip[0].setting = MIS, t.strip[0].passes = 1;
    t.n_strip = 1;
    char *const text = data_of(&t);
    for (int k = 0; k < 2; k++) {
        assert_true(json_number(text, k ? "crops.1.width" : "crops.0.width") == 4);
        assert_true(json_number(text, k ? "crops.1.height" : "crops.0.height") == 3);
    }
    free(text);
    clear(&t);
}

/* ---- the plan ---- */

/* cost: seconds of a pixel; the scatter of a pass is what makes the best of an integrator. */
static void add_piloted(bis_trade *t, const char *name, const bis_integrator *integrator, double cost, double relmse)
{
    add_setting(t, name, integrator, 99);
    t->plan.settings[t->plan.n_settings - 1].pass_seconds = cost;
    t->plan.settings[t->plan.n_settings - 1].pass_relmse = relmse;
}

enum { P_REJECTION, P_EM, P_SIR_LARGE, P_SIR, P_MIS, P_MIS_LONG, P_MIS_DEAR, P_MIS_SLOW, N_PILOTED };

/* Microseconds: the best have 8, 1, 4 and 2. */
static void pilot(bis_trade *t, bis_scene_desc *desc)
{
    *t = (bis_trade){.desc = desc, .o = {.seconds = 10}, .plan = {.full_width = 480, .full_height = 320, .n_seeds = 2}};
    *desc = (bis_scene_desc){.view.film = {.crop = {0, 1, 0, 1}}};
    add_piloted(t, "rejection 100/8", &bis_rejection, 8e-6, 0.01);
    add_piloted(t, "em 16", &bis_em, 1e-6, 0.5);
    add_piloted(t, "sir 256/16", &bis_sir, 1e-6, (double)NAN);
    add_piloted(t, "sir 64/4", &bis_sir, 4e-6, 0.07);
    add_piloted(t, "mis 16", &bis_mis, 2e-6, 0.125);
    add_piloted(t, "mis 64", &bis_mis, 4e-6, 0.1);
    add_piloted(t, "mis 16 power", &bis_mis, 16e-6, 0.1);
    add_piloted(t, "mis 16 compensated", &bis_mis, 64e-6, 0.1);
    t->plan.settings[P_SIR_LARGE].is_swept = false; /* a candidate for the reference alone */
    t->plan.settings[P_REJECTION].is_biased = true;
}

static void assert_levels(const bis_trade *t, const int *levels)
{
    for (int i = 0; i < t->plan.n_settings; i++) {
        if (t->plan.settings[i].levels != levels[i]) fail_msg("%s: %d", t->plan.settings[i].name,
            t->plan.settings[i].levels);
    }
}

/* The middle one of the long curves (1, 2, 4, 8 microseconds) gets 8 passes, 16 microseconds a pixel: 16, 8, 4 and 2
 * passes, 5, 4, 3 and 2 budgets. Of the short ones mis 64 and mis 16 power, with a quarter of that, get one, the last
 * none: twice (31 x 1 + 15 x 2 + 7 x 4 + 3 x 8 + 4 + 16) = 266 microseconds. Half of 10.64 s are 20000 such pixels;
 * every third one is nearest, 160 x 107. Then runs may take until a further budget would come, at 2^4.5 passes of em.
 * A replicate gets 22% of the time over 2 x 8: 0.1463 s. */
static void a_plan_fills_half_of_the_time(void **state)
{
    static const int levels[] = {2, 5, 0, 3, 4, 1, 1, 0};
    bis_scene_desc desc;
    bis_trade t;
    const bis_trade_plan *p = &t.plan;
    pilot(&t, &desc);
    assert_int_equal(bis_trade_fit_plan(&t, 10.64, NULL), BIS_OK);
    assert_true(p->step == 3 && p->width == 160 && p->height == 107);
    assert_levels(&t, levels);
    assert_near(p->settings[P_SIR].pass_seconds, 4e-6 * 160 * 107);
    assert_near(p->run_seconds, 1e-6 * 160 * 107 * exp2(4.5));
    assert_true(p->reference[0] == P_MIS && p->reference[1] == P_SIR);
    assert_true(p->reference_passes[0] == 4 && p->reference_passes[1] == 2); /* of 0.0342 s, of 0.0685 s */
    assert_int_equal(bis_trade_planned_runs(p), 2 * 16);
    assert_near(bis_trade_planned_seconds(p, P_SIR, 2), 16e-6 * 160 * 107);

    pilot(&t, &desc); /* one integrator: its references are all the time's; the scene's own gets the long curve, too */
    for (int i = 0; i < N_PILOTED; i++) t.plan.settings[i].is_swept = i == P_MIS || i == P_MIS_LONG;
    t.plan.settings[P_MIS_LONG].is_scenes = true;
    assert_int_equal(bis_trade_fit_plan(&t, 10.64, NULL), BIS_OK);
    assert_true(p->reference[0] == -1 && p->reference[1] == P_SIR);
    assert_true(p->settings[P_MIS].levels == p->settings[P_MIS_LONG].levels + 1);
    assert_true(p->reference_passes[1] == (uint32_t)(0.22 * 10.64 / 8 / p->settings[P_SIR].pass_seconds));

    pilot(&t, &desc); /* the last of the table alone */
    for (int i = 0; i < N_PILOTED; i++) t.plan.settings[i].is_swept = i == P_MIS_SLOW;
    assert_int_equal(bis_trade_fit_plan(&t, 10.64, NULL), BIS_OK);
    assert_true(p->reference[0] == -1 && p->reference[1] == P_SIR && p->settings[P_MIS_SLOW].levels > 0);

    pilot(&t, &desc); /* a given reference */
    t.plan.is_given = true;
    assert_int_equal(bis_trade_fit_plan(&t, 10.64, NULL), BIS_OK);
    assert_true(p->reference[0] == -1 && p->reference[1] == -1);
}

/* With --passes 11: 1, 2, 4, 8 of each. Twice 15 x 99 microseconds; 4.7 s/(2970 microseconds) are 1582 pixels, at least
 * 4800 are taken: of 153600 every 5.66th, the sixth. */
static void a_plan_with_passes_has_as_many_of_each(void **state)
{
    static const int levels[] = {4, 4, 0, 4, 4, 4, 4, 4};
    bis_scene_desc desc;
    bis_trade t;
    pilot(&t, &desc);
    t.o.passes = 11;
    t.o.error = 1e-9; /* out of reach; but a user who counts passes knows that */
    assert_int_equal(bis_trade_fit_plan(&t, 9.4, NULL), BIS_OK);
    assert_true(t.plan.step == 6 && t.plan.width == 80 && t.plan.height == 53);
    assert_levels(&t, levels);
    assert_near(t.plan.run_seconds, 8 * 64e-6 * 80 * 53);
    assert_true(t.plan.reference_passes[0] == 44 && t.plan.reference_passes[1] == 44);
}

/* What is biased is not the best, however little it costs: a quarter of the time. All 60 x 60 pixels are fewer than
 * wanted; 31 + 7 passes of 0.0036 s fit into 0.2 s, 63 + 15 do not. */
static void a_biased_setting_gets_the_short_curve(void **state)
{
    bis_scene_desc desc;
    bis_trade t;
    pilot(&t, &desc);
    t.plan.n_settings = 0;
    t.plan.n_seeds = 1;
    t.plan.is_given = true;
    t.plan.full_width = t.plan.full_height = 60;
    add_piloted(&t, "rejection ratio", &bis_rejection, 1e-6, 0.01);
    add_piloted(&t, "rejection plain", &bis_rejection, 1e-6, 1);
    t.plan.settings[0].is_biased = true;
    assert_int_equal(bis_trade_fit_plan(&t, 0.4, NULL), BIS_OK);
    assert_levels(&t, (int[]){3, 5});
    assert_true(t.plan.step == 1 && t.plan.width == 60);
    assert_near(t.plan.run_seconds, 0.0036 * exp2(4.5));
}

/* Five settings of 1, 2, 4, 8, 16 microseconds in each order: in the time of eight passes of the middle one they have
 * 63 x 1, 31 x 2, 15 x 4, 7 x 8 and 3 x 16, twice, 578 microseconds; so 11.56 s have room for 20000 pixels, every
 * third. */
static void the_middle_cost_does_not_depend_on_the_order(void **state)
{
    static const bis_integrator *const integrators[5] = {&bis_rejection, &bis_em, &bis_sir, &bis_mis, &bis_brdf};
    for (int order = 0; order < 120; order++) {
        double costs[5] = {1e-6, 2e-6, 4e-6, 8e-6, 16e-6};
        bis_scene_desc desc;
        bis_trade t;
        pilot(&t, &desc);
        t.plan.n_settings = 0;
        t.plan.is_given = true;
        for (int i = 0, rest = order; i < 5; i++) { /* one of those that are left, which are 5 - i */
            const int at = rest % (5 - i);
            add_piloted(&t, "any", integrators[i], costs[at], 0.1);
            rest /= 5 - i;
            costs[at] = costs[4 - i];
        }
        assert_int_equal(bis_trade_fit_plan(&t, 23.12, NULL), BIS_OK);
        assert_int_equal(t.plan.step, 3);
    }
}

/* The slowest of the table takes 24 microseconds a pixel where runs take 22.6 at most: it is left out. As the scene's
 * own, of 64, it is not. Then the middle one of five long curves costs 4, and with 8 passes of that all take twice (63
 * x 1 + 31 x 2 + 15 x 4 + 7 x 8 + 64 + 3 x 4 + 16) = 666 microseconds: 7988 pixels, every fourth of 480 x 320. Again
 * runs may take 2^4.5 passes of em: with more there would be all of those, too much. */
static void a_setting_is_left_out_if_its_pass_takes_too_long(void **state)
{
    static const int levels[N_PILOTED] = {2, 5, 0, 3, 4, 1, 1, 0};
    bis_scene_desc desc;
    for (int is_own = 0; is_own < 2; is_own++) {
        bis_trade t;
        pilot(&t, &desc);
        if (is_own) t.plan.settings[P_MIS_SLOW].is_scenes = true;
        else t.plan.settings[P_MIS_SLOW].pass_seconds = 24e-6;
        assert_int_equal(bis_trade_fit_plan(&t, 10.64, NULL), BIS_OK);
        assert_int_equal(t.plan.step, is_own ? 4 : 3);
        if (!is_own) assert_levels(&t, levels);
        assert_int_equal(t.plan.settings[P_MIS_SLOW].levels, is_own);
        assert_near(t.plan.run_seconds, 1e-6 * t.plan.width * t.plan.height * exp2(4.5));
    }
}

/* With all the time of the world: of 4800 x 3200 pixels 90000 are wanted, every thirteenth, and each budget is 2^20
 * passes. Those are over after 5.8 million of the 500 million seconds, which are then a run's. Replicates have 2^22
 * passes, the most. Of a picture of two rows or columns each second pixel is the thinnest film. */
static void a_plan_has_no_more_than_the_most(void **state)
{
    static const int levels[] = {21, 21, 0, 21, 21, 21, 21, 21};
    bis_scene_desc desc;
    bis_trade t;
    const bis_trade_plan *p = &t.plan;
    pilot(&t, &desc);
    t.plan.full_width = 4800, t.plan.full_height = 3200;
    assert_int_equal(bis_trade_fit_plan(&t, 1e9, NULL), BIS_OK);
    assert_true(p->step == 13 && p->width == 369 && p->height == 246);
    assert_levels(&t, levels);
    assert_near(p->run_seconds, 5e8);
    assert_true(p->reference_passes[0] == 4194304 && p->reference_passes[1] == 4194304);
    for (int tall = 0; tall < 2; tall++) {
        pilot(&t, &desc);
        t.plan.full_width = tall ? 2 : 32768, t.plan.full_height = tall ? 32768 : 2;
        assert_int_equal(bis_trade_fit_plan(&t, 1, NULL), BIS_OK);
        assert_true(p->step == 2 && p->width * p->height == 16384);
    }
}

/* 80 x 53 pixels at least; a pass of each of the best for two seeds: 30 microseconds a pixel, 0.1272 s. With the 12 s
 * that the pilot took, a fifth more than 12.2544 s are wanted. */
static void a_plan_without_time_is_refused(void **state)
{
    bis_scene_desc desc;
    bis_trade t;
    for (int i = 0; i < 2; i++) {
        bis_diag diag = {0};
        pilot(&t, &desc);
        set_watch(0);
        t.start = 988;
        assert_int_equal(bis_trade_fit_plan(&t, i ? 0.2546 : 0.2542, &diag), i ? BIS_OK : BIS_INPUT);
        watch.is_set = false;
        if (!i) assert_non_null(strstr(diag.messages[0].text, "error: 10 s are too few: a single pass of the best "
            "setting of each integrator, 80 x 53 pixels and 2 seeds, wants about 15 s in all; give --time more than "
            "that, or name fewer integrators by --integrator"));
        bis_diag_clear(&diag);
    }
}

/* mis 16 has 12.5% of noise a pass of 0.03424 s: 5% want 50 passes, 1.712 s; sir wants more. Runs
 * get 0.3874 s, and twice that is forgiven: 0.0743 = sqrt(0.125 0.03424/(2 x 0.3874)) can be reached. */
static void an_error_out_of_reach_is_refused(void **state)
{
    bis_scene_desc desc;
    bis_trade t;
    bis_diag diag = {0};
    pilot(&t, &desc);
    t.o.error = 0.05;
    assert_int_equal(bis_trade_fit_plan(&t, 10.64, &diag), BIS_INPUT);
    assert_non_null(strstr(diag.messages[0].text, "error: a relative error of 0.05 is out of reach: by the pilot "
        "\"mis 16\", the best, needs about 1.7 s for one "
                           "picture of 160 x 107 pixels, and in 10 s of measurement a run gets 0.39 s. Give --error "
                               "0.11 or more, or --time for "
                           "about 44 s"));
    bis_diag_clear(&diag);
    pilot(&t, &desc); /* the last of the table may be the best */
    t.plan.settings[P_MIS_SLOW].pass_relmse = 1e-5;
    t.o.error = 1e-3;
    assert_int_equal(bis_trade_fit_plan(&t, 10.64, &diag), BIS_INPUT);
    assert_non_null(strstr(diag.messages[0].text, "by the pilot \"mis 16 compensated\", the best, needs about "));
    bis_diag_clear(&diag);
    for (int i = 0; i < 2; i++) {
        pilot(&t, &desc);
        t.o.error = i ? 0.0745 : 0.0742;
        assert_int_equal(bis_trade_fit_plan(&t, 10.64, NULL), i ? BIS_OK : BIS_INPUT);
    }
}

/* ---- the settings and their pilot ---- */

typedef struct told {
    char what[40];
    double share, left;
} told;

typedef struct diary {
    told entry[64];
    int n;
} diary;

static void note(const char *what, double share, double left, void *user)
{
    diary *d = user;
    if (strncmp(what, "run ", 4) == 0) move_watch(1e5);
    assert_true(d->n < 64);
    told *e = &d->entry[d->n++];
    snprintf(e->what, sizeof e->what, "%s", what);
    e->share = share;
    e->left = left;
}

/* `settings all`, `quick` or `em`: those that are swept, each with its line of a scene. What else they are follows from
 * their names. */
static int settings(const expect_command *c)
{
    const char *const em[] = {"em"};
    bis_trade t = {.o = {.scene = DIR "/scene.txt", .quick = strcmp(c->arguments, "quick") == 0, .integrators = em,
        .n_integrators = strcmp(c->arguments, "em") == 0}};
    assert_int_equal(bis_trade_load(&t, NULL), BIS_OK);
    for (int k = 0; k < t.plan.n_settings; k++) {
        const bis_trade_setting *s = &t.plan.settings[k];
        char line[256];
        if (is_further(s->settings.integrator)) continue;
        bis_trade_scene_text(line, s, t.desc->light.area_exponent);
        if (s->is_swept) fprintf(c->output, "%s: %s\n", s->name, line);
        const char *b = strstr(s->name, "b=");
        assert_near(s->area_exponent, b ? atof(b + 2) : t.desc->light.area_exponent);
        assert_int_equal(s->is_scenes, strstr(s->name, "own") != NULL);
        assert_int_equal(s->is_biased, s->settings.integrator == &bis_rejection && !strstr(s->name, "plain"));
        assert_int_equal(bis_trade_judge_of(s), s->name[0] != 's' && s->name[0] != 'r');
    }
    bis_trade_clear(&t);
    return 0;
}

/* 4 of another b and 1 compensated. */
static void a_map_that_is_too_large_is_built_once(void **state)
{
    bis_trade t = {.o = {.scene = DIR "/scene.txt"}};
    assert_int_equal(bis_trade_load(&t, NULL), BIS_OK);
    const int n = t.plan.n_settings;
    bis_trade_list_settings(&t, false);
    assert_int_equal(t.plan.n_settings, n - 5);
    bis_trade_clear(&t);
}

/* Each that is swept or may be a reference is piloted: six em and five others. */
static void the_pilot_tells_how_far_it_is(void **state)
{
    const char *const em[] = {"em"};
    diary d = {.n = 0};
    bis_trade t = {.o = {.scene = DIR "/scene.txt", .integrators = em, .n_integrators = 1, .seconds = 0.01,
        .passes = 1, .seed = 9, .n_threads = 1,
                         .progress = note, .user = &d}, .plan = {.full_width = 24, .full_height = 16}};
    assert_int_equal(bis_trade_load(&t, NULL), BIS_OK);
    int first = d.n;
    t.start = bis_clock_now();
    assert_int_equal(bis_trade_make_plan(&t, NULL), BIS_OK);
    assert_int_equal(d.n, first + 11);
    for (int i = 0; i < 11; i++) assert_near(d.entry[first + i].share, i / 11.0);
    assert_true(t.plan.seed == 9 && t.plan.n_seeds == 3 && !t.plan.is_given && t.plan.reference[0] == -1 &&
        t.plan.reference[1] >= 0);
    for (int i = 0; i < t.plan.n_settings; i++) {
        const bis_trade_setting *s = &t.plan.settings[i];
        assert_int_equal(s->levels, s->is_swept);
        const bool piloted = s->is_swept || bis_trade_may_be_reference(s, 0) || bis_trade_may_be_reference(s, 1);
        assert_int_equal(s->pass_seconds > 0 && s->fill_seconds > 0 && s->pass_relmse > 0, piloted);
    }
    bis_trade_clear(&t);
}

/* With all the time of the world the pilot has 256 passes of each setting, with none two; the seed is the next one. Its
 * relMSE is that of one pass. */
static void the_pilot_has_as_many_passes_as_its_time_allows(void **state)
{
    const char *const em[] = {"em"};
    for (int rich = 0; rich < 2; rich++) {
        const uint32_t passes = rich ? 256 : 2;
        bis_trade t = {.o = {.scene = DIR "/scene.txt", .integrators = em, .n_integrators = 1,
                             .seconds = rich ? 1e6 : 1e-9, .passes = 1, .seed = 9, .n_threads = 1},
                       .plan = {.full_width = 6, .full_height = 4}};
        int n = 0;
        double longest = 0;
        assert_int_equal(bis_trade_load(&t, NULL), BIS_OK);
        t.start = bis_clock_now();
        assert_int_equal(bis_trade_make_plan(&t, NULL), BIS_OK);
        for (int i = 0; i < t.plan.n_settings; i++) {
            const bis_trade_setting *s = &t.plan.settings[i];
            bis_render_result result;
            if (!(s->pass_seconds > 0)) continue;
            assert_int_equal(bis_trade_render(&t, &(bis_trade_job){s, 1, passes, 10}, NULL, &result, NULL), BIS_OK);
            assert_near(s->pass_relmse, result.error.relative_rmse * result.error.relative_rmse * passes);
            if (s->is_swept) longest = fmax(longest, s->pass_seconds);
            n++;
        }
        assert_int_equal(n, 11);
        assert_true(t.plan.run_seconds == longest); /* of one pass */
        bis_trade_clear(&t);
    }
}

/* The seconds of a render by the clock that is set, of a setting of a plan that has been made. */
static double seconds_of(bis_trade *t, const bis_trade_setting *s, int step, uint32_t passes, uint64_t seed,
                         double *relmse)
{
    bis_render_result result;
    assert_int_equal(bis_trade_render(t, &(bis_trade_job){s, step, passes, seed}, NULL, &result, NULL), BIS_OK);
    if (relmse) *relmse = result.error.relative_rmse * result.error.relative_rmse * passes;
    return result.seconds;
}

/* A sweep of em, --quick, of 96 x 64 pixels, whose pilot has 7 settings. */
static void load_for_pilot(bis_trade *t, double seconds)
{
    static const char *const em[] = {"em"};
    *t = (bis_trade){.o = {.scene = DIR "/scene.txt", .integrators = em, .n_integrators = 1, .seconds = seconds,
                           .n_seeds = 1, .seed = 9, .n_threads = 1, .quick = true}};
    assert_int_equal(bis_trade_load(t, NULL), BIS_OK);
    t->plan.full_width = 96, t->plan.full_height = 64;
    set_watch(1);
    t->start = bis_clock_now();
}

/* The plan is the one that the pilot's figures give for so many seconds. */
static void assert_fitted_to(const bis_trade *t, double left)
{
    bis_trade u = *t;
    for (int i = 0; i < u.plan.n_settings; i++)
        u.plan.settings[i].pass_seconds /= bis_trade_pixels(t, t->plan.step);
    assert_int_equal(bis_trade_fit_plan(&u, left, NULL), BIS_OK);
    assert_near(t->plan.run_seconds, u.plan.run_seconds);
    assert_int_equal(t->plan.reference_passes[1], u.plan.reference_passes[1]);
    for (int i = 0; i < u.plan.n_settings; i++)
        assert_int_equal(t->plan.settings[i].levels, u.plan.settings[i].levels);
}

/* A clock of one second a reading, which comes between passes and after tiles. Four passes of one pixel take 5 s, so a
 * pass of any size takes 1.25. The probe has every eleventh pixel, 9 x 6, and takes 3 s: 1.75/54 for each. Three passes
 * are to fit into twice the setting's share, 8% of the time over 7: with 4100 s these are 964 pixels, with 4250 s 999,
 * with 11500 s 2704, where every second one is nearest from 983 to 2731. In 400 s it is 16 x 1.25 s that counts, 617
 * pixels, every third. Passes are those that fit into the share, two at least. */
static void the_pilot_has_as_many_pixels_as_its_time_allows(void **state)
{
    static const struct { double seconds; int step; uint32_t passes; } cases[] = {
        {400, 3, 2}, {4100, 3, 7}, {4250, 2, 6}, {11500, 2, 16}};
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        bis_trade t;
        int n = 0;
        load_for_pilot(&t, cases[c].seconds);
        assert_int_equal(bis_trade_make_plan(&t, NULL), BIS_OK);
        assert_fitted_to(&t, cases[c].seconds - (last_reading() - t.start));
        for (int i = 0; i < t.plan.n_settings; i++) {
            const bis_trade_setting *const s = &t.plan.settings[i];
            const int step = cases[c].step;
            const uint32_t passes = cases[c].passes;
            double relmse;
            if (!(s->pass_seconds > 0)) continue;
            assert_true(s->fill_seconds == 1.25);
            const double share = 0.08 * cases[c].seconds / 7, one = seconds_of(&t, s, step, 1, 9, NULL);
            assert_true(one == (step == 3 ? 6 : 8)); /* 2 x 2 tiles, or 3 x 2, and 2 */
            assert_true(share < one * (passes + 1) && (passes == 2 || share >= one * passes));
            const double each = seconds_of(&t, s, step, passes, 10, &relmse) / passes;
            assert_near(s->pass_seconds, each / bis_trade_pixels(&t, step) * bis_trade_pixels(&t, t.plan.step));
            assert_near(s->pass_relmse, relmse);
            n++;
        }
        assert_int_equal(n, 7);
        watch.is_set = false;
        bis_trade_clear(&t);
    }
}

static void interrupt_late(const char *what, double share, double left, void *user)
{
    bis_trade *t = user;
    if (strcmp(what, "pilot") != 0 || share < 0.1) return;
    move_watch(1000);
    *(volatile sig_atomic_t *)t->o.interrupted = 1;
}

/* A setting takes 29 readings of a second. After each but the last the pilot must not have taken all the time, as 58 s
 * are after two; if it has, it wants as much for each of the 7. Nobody who counts passes or has interrupted it is told
 * that. What is left for the measurement is a tenth of the time at least. */
static void a_pilot_that_takes_all_the_time_is_given_up(void **state)
{
    for (int i = 0; i < 5; i++) {
        static const double seconds[] = {59, 58, 59, 59, 190};
        static volatile sig_atomic_t flag;
        bis_trade t;
        bis_diag diag = {0};
        diary d = {.n = 0};
        char need[BIS_DURATION], expected[256];
        load_for_pilot(&t, seconds[i]);
        flag = 0;
        t.o.progress = i == 3 ? interrupt_late : note, t.o.user = i == 3 ? (void *)&t : &d, t.o.interrupted = &flag;
        if (i == 2) t.o.passes = 1;
        if (i == 4) t.plan.full_width = 24, t.plan.full_height = 16;
        if (i == 4) t.start -= 25;
        assert_int_equal(bis_trade_make_plan(&t, &diag), i < 2 ? BIS_INPUT : BIS_OK);
        const double elapsed = last_reading() - t.start;
        if (i < 2) {
            const int done = 3 - i;
            assert_true(elapsed == 29 * done);
            assert_int_equal(d.n, done);
            bis_duration(need, elapsed / done * 7);
            snprintf(expected, sizeof expected, "error: %g s are too few: the pilot alone, a look at each of 7 "
                     "settings, wants about %s; give --time some times that, or name fewer integrators by "
                     "--integrator", seconds[i], need);
            assert_int_equal(diag.n, 1);
            assert_non_null(strstr(diag.messages[0].text, expected));
        }
        if (i == 4) {
            assert_true(elapsed > 171 && elapsed < 190);
            assert_fitted_to(&t, 19);
        }
        watch.is_set = false;
        bis_diag_clear(&diag);
        bis_trade_clear(&t);
    }
}

/* em 16, or mis 16, is the scene's own. Its probe costs 1.75/54 s a pixel, and of 96 x 64 all are measured, for two
 * seeds: 398.2 s, half of 796.4. If that is more than there is, a probe of 16 x 11 pixels is made, 1.75/176 s each:
 * half of 244.4 s. What it tells counts from then on: the pilot has 2011 pixels instead of 617. Whoever counts passes
 * is not refused, and neither is a setting for what is not swept or not the scene's. */
static void the_scenes_own_setting_is_refused_if_a_pass_takes_too_long(void **state)
{
    static const struct {
        double seconds;
        bool is_own, is_swept;
        uint32_t passes;
        int step; /* of the pilot; 0: there is none */
        const char *what;
    } cases[] = {
        {800, true, true, 0, 3, NULL}, {790, true, true, 0, 2, NULL}, {790, true, true, 1, 1, NULL},
        {790, false, true, 0, 3, NULL}, {790, true, false, 0, 3, NULL},
        {246, true, true, 0, 2, "the best setting of each integrator"},
        {243, true, true, 0, 0, "the scene's own setting"}, {243, true, true, 1, 1, NULL},
        {243, false, true, 0, 3, "the best setting of each integrator"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        bis_trade t;
        bis_diag diag = {0};
        char need[BIS_DURATION], expected[256];
        double relmse;
        load_for_pilot(&t, cases[i].seconds);
        t.o.n_seeds = 2;
        t.o.passes = cases[i].passes;
        for (int k = 0; k < t.plan.n_settings; k++) t.plan.settings[k].is_swept = t.plan.settings[k].is_scenes = false;
        t.plan.settings[bis_trade_find_setting(&t.plan, "em 16")].is_swept = true;
        bis_trade_setting *const own =
            &t.plan.settings[bis_trade_find_setting(&t.plan, cases[i].is_swept ? "em 16" : "mis 16")];
        own->is_scenes = cases[i].is_own;
        assert_int_equal(bis_trade_make_plan(&t, &diag), cases[i].what ? BIS_INPUT : BIS_OK);
        if (cases[i].what) {
            const double least = cases[i].step ? 2 * own->pass_seconds : 2 * 96 * 64 * 1.75 / 176;
            bis_duration(need, 1.2 * (2 * least + last_reading() - t.start));
            snprintf(expected, sizeof expected, "error: %g s are too few: a single pass of %s, 96 x 64 pixels and 2 "
                     "seeds, wants about %s in all; ", cases[i].seconds, cases[i].what, need);
            assert_non_null(strstr(diag.messages[0].text, expected));
        }
        assert_int_equal(own->pass_seconds > 0, cases[i].step > 0);
        if (cases[i].step && cases[i].seconds > 700 && !cases[i].passes) {
            seconds_of(&t, own, cases[i].step, 2, 10, &relmse);
            assert_near(own->pass_relmse, relmse);
        }
        watch.is_set = false;
        bis_diag_clear(&diag);
        bis_trade_clear(&t);
    }
}

/* As many as were asked for; else 2 of a quick run, 5 of one of ten minutes or more, 3. */
static void seeds_are_those_asked_for_or_follow_from_the_time(void **state)
{
    static const struct {
        int asked;
        bool quick;
        double seconds;
        int n;
    } cases[] = {{0, true, 1000, 2}, {0, false, 600, 5}, {0, false, 599, 3}, {7, false, 600, 7}, {1, true, 1000, 1}};
    volatile sig_atomic_t interrupted = 1;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        bis_trade t = {.o = {.seconds = cases[i].seconds, .quick = cases[i].quick, .n_seeds = cases[i].asked, .seed = 6,
                             .interrupted = &interrupted, .reference = i == 3 ? "ref.pfm" : NULL}};
        assert_int_equal(bis_trade_make_plan(&t, NULL), BIS_OK);
        assert_int_equal(t.plan.n_seeds, cases[i].n);
        assert_true(t.plan.seed == 6 && t.plan.is_given == (i == 3));
    }
}

/* A dim map with lamps of one pixel, which are so small that b weighs them. */
static void write_small_lamps(const char *path)
{
    bis_image map;
    assert_int_equal(bis_image_init(&map, 64, 32, NULL), BIS_OK);
    for (int i = 0; i < 64 * 32; i++) {
        const float v = i % 97 == 5 ? 20 + (float)(i % 7) : 0.25f;
        map.pixels[i] = (rgb){v, v, v / 2};
    }
    assert_int_equal(bis_image_save(&map, path, NULL), BIS_OK);
    bis_image_clear(&map);
}

/* A setting with another b, or compensated, has a map of its own, built as the scene's is: with the table that the
 * scene file names, or that its sampler is for. So it makes the picture of the scene file that has these settings, bit
 * for bit. */
static void a_light_of_its_own_is_built_as_the_scenes(void **state)
{
    static const struct { const char *sampler, *table; } scenes[] = {{"", ""}, {"Sampler \"sobol\"\n", ""},
        {"", " \"string sampler\" \"cdf\""}, {"Sampler \"halton\"\n", " \"string sampler\" \"alias\""}};
    static const struct { const char *setting, *integrator, *b; } cases[] = {
        {"em 16 b=0", "em\"", " \"float areaexponent\" 0"}, {"em 16 b=0.5", "em\"", " \"float areaexponent\" 0.5"},
        {"mis 16 compensated", "mis\" \"bool compensate\" true", ""}};
    program_folder(DIR "/own");
    for (int i = 0; i < 12; i++) {
        program_write_scene(DIR "/own", scenes[i / 3].sampler);
        write_small_lamps(DIR "/own/map.pfm");
        char *const scene = read_whole(DIR "/own/scene.txt"), text[4096];
        const char *const setting = strstr(scene, "sir\""), *const end = strchr(setting, '\n');
        const char *const map = strstr(scene, "\"map.pfm\"") + strlen("\"map.pfm\"");
        snprintf(text, sizeof text, "%.*s%s%s", (int)(map - scene), scene, scenes[i / 3].table, map);
        program_write_file(DIR "/own/scene.txt", text);
        snprintf(text, sizeof text, "%.*s%s%.*s%s%s%s", (int)(setting - scene), scene, cases[i % 3].integrator,
                 (int)(map - end), end, scenes[i / 3].table, cases[i % 3].b, map);
        program_write_file(DIR "/own/right.txt", text);
        bis_free(scene);
        bis_trade t = {.o = {.scene = DIR "/own/scene.txt", .n_threads = 1}};
        bis_render_result result;
        bis_image image, right;
        program_run r;
        assert_int_equal(bis_trade_load(&t, NULL), BIS_OK);
        t.plan.full_width = 24, t.plan.full_height = 16;
        const bis_trade_setting *s = &t.plan.settings[bis_trade_find_setting(&t.plan, cases[i % 3].setting)];
        assert_int_equal(bis_trade_render(&t, &(bis_trade_job){s, 1, 2, 7}, &image, &result, NULL), BIS_OK);
        program_expect(
            &r, 0, DIR "/own/right.txt --samples 16 --spp 2 --seed 7 --quiet --outfile " DIR "/own/right.pfm");
        assert_int_equal(bis_image_read(&right, DIR "/own/right.pfm", (bis_loc){0}, NULL), BIS_OK);
        assert_memory_equal(image.pixels, right.pixels, 24 * 16 * sizeof(rgb));
        bis_image_clear(&image);
        /* the twin: with the scene's light it is another picture */
        s = &t.plan.settings[bis_trade_find_setting(&t.plan, i % 3 < 2 ? "em 16" : "mis 16")];
        assert_int_equal(bis_trade_render(&t, &(bis_trade_job){s, 1, 2, 7}, &image, &result, NULL), BIS_OK);
        assert_memory_not_equal(image.pixels, right.pixels, 24 * 16 * sizeof(rgb));
        bis_image_clear(&image);
        bis_image_clear(&right);
        bis_trade_clear(&t);
    }
}

/* ---- the folder ---- */

#define RUNS "setting,passes,replicate,seed,seconds,camera_rays,shadow_rays,candidates,rmse,relmse,bias,relmse_both\n"
static const char plan_text[] = "full 24 16\nstep 4\nsize 6 4\nseeds 1\nseed 5\nrun_seconds 2.5\ngiven 0\n"
                                "reference 0 3 mis 16\nreference 1 4194304 sir 64/4\n"
                                "setting 2 1 0.25 nan em 16\nsetting 1 4 0 0.125 sir 64/4\n";

/* The scene of DIR with a plan of two settings. */
static void load(bis_trade *t)
{
    *t = (bis_trade){.o = {.scene = DIR "/scene.txt", .folder = DIR "/folder", .n_threads = 1, .seconds = 1e6,
        .error = 0.9}};
    assert_int_equal(bis_trade_load(t, NULL), BIS_OK);
}

static void plan_two(bis_trade *t)
{
    bis_trade_plan *p = &t->plan;
    for (int i = 0; i < p->n_settings; i++) p->settings[i].is_swept = false, p->settings[i].levels = 0;
    const int em = bis_trade_find_setting(p, "em 16"), mis = bis_trade_find_setting(p, "mis 16"),
        sir = bis_trade_find_setting(p, "sir 64/4");
    p->full_width = 24, p->full_height = 16, p->step = 4, p->width = 6, p->height = 4;
    p->n_seeds = 1, p->seed = 5, p->run_seconds = 2.5;
    p->reference[0] = mis, p->reference_passes[0] = 3, p->reference[1] = sir, p->reference_passes[1] = 1 << 22;
    bis_trade_setting *a = &p->settings[em], *b = &p->settings[sir];
    a->is_swept = b->is_swept = true;
    a->levels = 2, a->pass_seconds = 1, a->fill_seconds = 0.25, a->pass_relmse = (double)NAN;
    b->levels = 1, b->pass_seconds = 4, b->fill_seconds = 0, b->pass_relmse = 0.125;
}

/* A new folder with the plan of *t, which is cleared then, and with a grey picture as its reference. */
static void store_plan(bis_trade *t, const char *folder)
{
    char text[256];
    bis_image grey;

    t->o.folder = folder;
    t->plan.is_given = true;
    t->plan.run_seconds = 1e-4;
    t->plan.reference[0] = t->plan.reference[1] = -1;
    snprintf(text, sizeof text, "rm -rf %s && mkdir -p %s/references", folder, folder);
    assert_int_equal(system(text), 0);
    assert_int_equal(bis_trade_write_plan(t, NULL), BIS_OK);
    bis_trade_clear(t);
    assert_int_equal(bis_image_init(&grey, 6, 4, NULL), BIS_OK);
    for (int i = 0; i < 24; i++) grey.pixels[i] = (rgb){0.5f, 0.5f, 0.5f};
    snprintf(text, sizeof text, "%s/references/given.exr", folder);
    assert_int_equal(bis_image_save(&grey, text, NULL), BIS_OK);
    bis_image_clear(&grey);
}

/* FNV-1a, 64 bits. */
static uint64_t fnv(const char *text)
{
    uint64_t h = 14695981039346656037u;
    for (; *text; text++) h = (h ^ (unsigned char)*text) * 1099511628211u;
    return h;
}

/* Of the version, the names and the scene's text, one behind the other. */
static uint64_t fingerprint_of(const bis_trade_plan *p)
{
    char all[8192], *scene = read_whole(DIR "/scene.txt");
    int n = snprintf(all, sizeof all, "%s", BIS_VERSION);
    for (int i = 0; i < p->n_settings; i++) n += snprintf(all + n, sizeof all - (size_t)n, "%s", p->settings[i].name);
    snprintf(all + n, sizeof all - (size_t)n, "%s", scene);
    bis_free(scene);
    assert_true(fnv("a") == 0xaf63dc4c8601ec8c && fnv("foobar") == 0x85944171f73967e8); /* its authors' */
    return fnv(all);
}

static void plan_and_runs_are_written_and_read_back(void **state)
{
    bis_trade t, u;
    char *text;
    unsigned long long print;
    load(&t);
    plan_two(&t);
    assert_int_equal(mkdir(DIR "/folder", 0777), 0);
    assert_int_equal(bis_trade_write_plan(&t, NULL), BIS_OK);
    const int em = bis_trade_find_setting(&t.plan, "em 16"), sir = bis_trade_find_setting(&t.plan, "sir 64/4");
    const bis_trade_run runs[] = {{sir, 0, 0, 9, 4.5, 1, 2, 3, 0.5, 0.25, -0.125, 0.75}, {em, 1, 0, 8, 2, 10, 20, 30,
        1, 2, 3, 4},
                                  {em, 0, 0, BIS_SEED_MAX, 1, 11, 21, 31, 5, 6, 7, 8}};
    for (int i = 0; i < 3; i++) assert_int_equal(bis_trade_add_run(&t, &runs[i], NULL), BIS_OK);
    assert_int_equal(bis_trade_write_runs(&t, NULL), BIS_OK);
    text = read_whole(DIR "/folder/plan.txt");
    assert_int_equal(sscanf(text, "fingerprint %16llx\n", &print), 1);
    assert_true(print == t.plan.fingerprint && text[28] == '\n');
    assert_string_equal(text + 29, plan_text);
    bis_free(text);
    assert_true(print == fingerprint_of(&t.plan));
    text = read_whole(DIR "/folder/runs.csv");
    assert_string_equal(text, RUNS "em 16,1,1,9007199254740991,1,11,21,31,5,6,7,8\nem 16,2,1,8,2,10,20,30,1,2,3,4\n"
                        "sir 64/4,1,1,9,4.5,1,2,3,0.5,0.25,-0.125,0.75\n");
                            /* in the order of settings, passes, seeds */
    bis_free(text);
    load(&u);
    assert_int_equal(bis_trade_read_plan(&u, NULL), BIS_OK);
    assert_int_equal(bis_trade_read_runs(&u, NULL), BIS_OK);
    const bis_trade_plan *p = &t.plan, *q = &u.plan;
    assert_true(p->fingerprint == q->fingerprint && q->full_width == 24 && q->full_height == 16 && q->step == 4 &&
        q->width == 6 && q->height == 4);
    assert_true(q->n_seeds == 1 && q->seed == 5 && q->run_seconds == 2.5 && !q->is_given);
    assert_memory_equal(p->reference, q->reference, sizeof p->reference);
    assert_memory_equal(p->reference_passes, q->reference_passes, sizeof p->reference_passes);
    for (int i = 0; i < p->n_settings; i++) {
        const bis_trade_setting *a = &p->settings[i], *b = &q->settings[i];
        assert_true(a->is_swept == b->is_swept && a->levels == b->levels && a->pass_seconds == b->pass_seconds);
        assert_true(a->fill_seconds == b->fill_seconds && (a->pass_relmse == b->pass_relmse || (i == em &&
            isnan(b->pass_relmse))));
    }
    assert_int_equal(u.n_runs, 3);
    for (int i = 0; i < 3; i++) {
        const bis_trade_run *a = &runs[2 - i], *b = bis_trade_find_run(&u, a->setting, a->level, a->replicate);
        assert_ptr_equal(b, &u.runs[i]);
        assert_true(a->seed == b->seed && a->seconds == b->seconds && a->rmse == b->rmse && a->relmse == b->relmse &&
            a->bias == b->bias);
        assert_true(a->camera_rays == b->camera_rays && a->shadow_rays == b->shadow_rays &&
            a->candidates == b->candidates);
        assert_true(a->relmse_both == b->relmse_both);
    }
    bis_trade_clear(&t);
    bis_trade_clear(&u);
}

/* Settings, passes, replicates: in this order, however they were measured. A plan without a setting is none. */
static void runs_are_written_in_order(void **state)
{
    static const char names[][12] = {"em 16", "sir 64/4"};
    static const int shuffled[] = {5, 0, 7, 2, 4, 1, 6, 3};
    char expected[2048];
    int n = snprintf(expected, sizeof expected, "%s", RUNS);
    bis_trade t;
    load(&t);
    plan_two(&t);
    t.o.folder = DIR "/order";
    assert_int_equal(system("rm -rf " DIR "/order; mkdir " DIR "/order"), 0);
    for (int k = 0; k < 8; k++) {
        const int i = shuffled[k]; /* bits: setting, level, replicate */
        const bis_trade_run run = {.setting = bis_trade_find_setting(&t.plan, names[i >> 2]), .level = i >> 1 & 1,
                                   .replicate = i & 1, .seed = (uint64_t)i};
        assert_int_equal(bis_trade_add_run(&t, &run, NULL), BIS_OK);
        n += snprintf(expected + n, sizeof expected - (size_t)n, "%s,%d,%d,%d,0,0,0,0,0,0,0,0\n", names[k >> 2],
                      1 << (k >> 1 & 1), (k & 1) + 1, k);
    }
    assert_int_equal(bis_trade_write_runs(&t, NULL), BIS_OK);
    char *text = read_whole(DIR "/order/runs.csv");
    assert_string_equal(text, expected);
    bis_free(text);

    for (int i = 0; i < t.plan.n_settings; i++) t.plan.settings[i].is_swept = false, t.plan.settings[i].levels = 0;
    t.plan.reference[0] = t.plan.reference[1] = -1;
    assert_int_equal(bis_trade_write_plan(&t, NULL), BIS_OK);
    bis_diag diag = {0};
    assert_int_equal(bis_trade_read_plan(&t, &diag), BIS_INPUT);
    assert_string_equal(diag.messages[0].text, DIR "/order/plan.txt: error: a plan has a line \"setting\", and this "
                                               "one has none; the file is damaged, measure into a new folder");
    bis_diag_clear(&diag);
    bis_trade_clear(&t);
}

/* A folder with nothing in it is taken, and --resume begins anew with a warning; one that is not there is made. */
static void an_empty_folder_is_taken(void **state)
{
    for (int i = 0; i < 4; i++) {
        bis_trade t = {.o = {.folder = DIR "/empty", .resume = i % 2 == 1}};
        bis_diag diag = {0};
        assert_int_equal(system(i < 2 ? "rm -rf " DIR "/empty; mkdir " DIR "/empty" : "rm -rf " DIR "/empty"), 0);
        assert_int_equal(bis_trade_check_folder(&t, &diag), BIS_OK);
        assert_int_equal(t.made_folder, i >= 2);
        assert_false(t.o.resume);
        assert_int_equal(diag.n, i % 2);
        if (i % 2)
            assert_string_equal(diag.messages[0].text, DIR "/empty: warning: there is no measurement to go on with; a "
                                                       "new one begins");
        bis_diag_clear(&diag);
    }
}

/* A name of 3800 bytes is taken. What cannot be read, here a link to nothing, and a folder that cannot be made are told
 * with their names, and not as bad input. */
static void a_folder_that_cannot_be_used_is_told(void **state)
{
    char longest[3801] = DIR;
    memset(longest + strlen(DIR), '/', sizeof longest - 1 - strlen(DIR));
    bis_trade t = {.o = {.folder = longest}};
    bis_diag diag = {0};
    assert_int_equal(bis_trade_check_folder(&t, &diag), BIS_INPUT); /* what this test has written is there */
    assert_non_null(strstr(diag.messages[0].text, "\" holds other things (\""));
    bis_diag_clear(&diag);

    unlink(DIR "/astray");
    assert_int_equal(symlink("nothing", DIR "/astray"), 0);
    t = (bis_trade){.o = {.folder = DIR "/astray"}};
    assert_int_equal(bis_trade_check_folder(&t, &diag), BIS_IO);
    assert_string_equal(diag.messages[0].text, DIR "/astray: error: \"" DIR "/astray\" is no folder that can be read: "
                                               "No such file or directory");
    bis_diag_clear(&diag);
    assert_int_equal(bis_trade_make_folder(&t, "pictures", &diag), BIS_IO);
    assert_string_equal(diag.messages[0].text, DIR "/astray/pictures: error: cannot make the folder \"" DIR
                                               "/astray/pictures\": No such file or directory");
    bis_diag_clear(&diag);
    t.o.folder = DIR "/astray/new";
    assert_int_equal(bis_trade_check_folder(&t, &diag), BIS_IO);
    assert_string_equal(diag.messages[0].text, DIR "/astray/new: error: cannot make the folder \"" DIR "/astray/new\": "
                                               "No such file or directory");
    assert_false(t.made_folder);
    bis_diag_clear(&diag);
}

/* A folder with the plan of plan_text and three runs; t is to read them. */
static void store_sound_folder(bis_trade *t)
{
    load(t);
    const bis_trade_plan fresh = t->plan;
    plan_two(t);
    if (!program_exists(DIR "/folder")) assert_int_equal(mkdir(DIR "/folder", 0777), 0);
    assert_int_equal(bis_trade_write_plan(t, NULL), BIS_OK);
    program_write_file(DIR "/folder/runs.csv", RUNS "em 16,1,1,9007199254740991,1,11,21,31,5,6,7,8\n"
                       "em 16,2,1,8,2,10,20,30,1,2,3,4\nsir 64/4,1,1,9,4.5,1,2,3,0.5,0.25,-0.125,0.75\n");
    t->plan = fresh;
}

/* `damage FILE LINE`: what is said of a sound folder in whose file the input takes the place of this line. */
static int damage(const expect_command *c)
{
    bis_trade t;
    bis_diag diag = {0};
    char path[64], text[2048];
    int line;
    assert_int_equal(sscanf(c->arguments, "%*s %d", &line), 1);
    snprintf(path, sizeof path, DIR "/folder/%.*s", (int)strcspn(c->arguments, " "), c->arguments);
    store_sound_folder(&t);
    char *const sound = read_whole(path), *from = sound;
    for (; line > 1; line--) from = strchr(from, '\n') + 1;
    snprintf(text, sizeof text, "%.*s%s%s", (int)(from - sound), sound, c->input, strchr(from, '\n') + 1);
    program_write_file(path, text);
    bis_free(sound);
    bis_status status = bis_trade_read_plan(&t, &diag);
    if (!status) status = bis_trade_read_runs(&t, &diag);
    for (size_t i = 0; i < diag.n; i++) fprintf(c->messages, "%s\n", diag.messages[i].text);
    bis_diag_clear(&diag);
    bis_trade_clear(&t);
    return bis_cli_exit_status(status);
}

/* A plan measures at least a pixel and at most 360000: 600 x 600, one row more is refused. Of 24 x 16 it measures every
 * fourth, 2, 6, 10, ...: a crop of row 8 alone, or of column 12, has none. */
static void a_plan_has_pixels_and_not_too_many(void **state)
{
    static const struct {
        int full_width, full_height, step, width, height;
        double crop[4];
        const char *pixels; /* NULL: it is taken */
    } cases[] = {
        {600, 600, 1, 600, 600, {0, 1, 0, 1}, NULL}, {600, 601, 1, 600, 601, {0, 1, 0, 1}, "600 x 601"},
        {24, 16, 4, 6, 4, {0, 1, 0.5, 0.51}, "6 x 0"}, {24, 16, 4, 6, 4, {0.5, 0.53, 0, 1}, "0 x 4"},
        {24, 16, 4, 6, 4, {0.55, 0.6, 0.6, 0.7}, NULL}, {600, 601, 1, 600, 601, {0, 0.5, 0, 1}, NULL},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        bis_trade t;
        bis_diag diag = {0};
        char expected[256];
        load(&t);
        plan_two(&t);
        t.o.folder = DIR;
        t.plan.full_width = cases[i].full_width, t.plan.full_height = cases[i].full_height;
        t.plan.step = cases[i].step, t.plan.width = cases[i].width, t.plan.height = cases[i].height;
        memcpy(t.desc->view.film.crop, cases[i].crop, sizeof cases[i].crop);
        assert_int_equal(bis_trade_write_plan(&t, NULL), BIS_OK);
        assert_int_equal(bis_trade_read_plan(&t, &diag), cases[i].pixels ? BIS_INPUT : BIS_OK);
        snprintf(expected, sizeof expected,
            DIR "/plan.txt: error: by \"full\" and \"step\" %s pixels are to be measured, must "
                "be at least 1 and at most 360000; the file is damaged, measure into a new folder",
            cases[i].pixels ? cases[i].pixels : "no");
        assert_int_equal(diag.n, cases[i].pixels ? 1 : 0);
        if (diag.n) assert_string_equal(diag.messages[0].text, expected);
        bis_diag_clear(&diag);
        bis_trade_clear(&t);
    }
}

/* ---- references ---- */

/* Replicate k of "mis" or "sir": k + 1 in red, as much and twice as much in green and blue of all pixels but one, which
 * is 3 in each channel, and one that is 64 times as dark. */
static rgb of_replicate(int which, int k, int pixel)
{
    const double v = (which ? 4 * (k + 1) : k + 1) / (pixel == 5 ? 64.0 : 1);
    return pixel == 7 ? (rgb){3, 3, 3} : rgb_from(v, v, 2 * v);
}

/* What the files of eight replicates say, channel by channel as the page defines it: the mean, its standard error, the
 * variance of the mean over mean^2 + m^2/100. */
static void assert_reference(const bis_trade_reference *ref, int which)
{
    double means[8] = {0}, mean = 0, squares = 0, relative = 0;
    assert_true(ref->is_ready && ref->image.width == 6 && ref->image.height == 4);
    for (int k = 0; k < 8; k++) {
        for (int i = 0; i < 24; i++) means[k] += rgb_sum(of_replicate(which, k, i)) / 72;
        mean += means[k] / 8;
    }
    for (int k = 0; k < 8; k++) squares += pow(means[k] - mean, 2);
    assert_near(ref->mean, mean);
    assert_near(ref->se, sqrt(squares / 7 / 8));
    const double v = which ? 18 : 4.5, variance = which ? 96 : 6; /* of 1 ... 8, times 4: 60/10, times 16 */
    for (int dark = 0; dark < 2; dark++) {
        const double s = dark ? 1 / 4096.0 : 1, m = mean * mean / 100, own = s * variance / 8;
        relative += (dark ? 1 : 22) * (2 * own / (s * v * v + m) + 4 * own / (4 * s * v * v + m));
    }
    assert_near(ref->relmse, relative / 72);
    for (int i = 0; i < 24; i++) {
        const rgb c = ref->image.pixels[i];
        const float grey = (float)(i == 5 ? v / 64 : v);
        if (i == 7) assert_true(c.r == 3 && c.g == 3 && c.b == 3);
        else assert_true(c.r == grey && c.g == grey && c.b == 2 * grey);
    }
}

/* Files of both, of mis alone, of sir alone. Of both the mean is weighted by 1/variance, and so is its noise. */
static void references_are_read_and_combined(void **state)
{
    for (int which = 1; which < 4; which++) {
        bis_trade t;
        bis_image image;
        diary d = {.n = 0};
        load(&t);
        plan_two(&t);
        t.o.folder = DIR "/replicates";
        t.o.progress = note, t.o.user = &d;
        assert_int_equal(system("rm -rf " DIR "/replicates"), 0);
        assert_int_equal(mkdir(DIR "/replicates", 0777), 0);
        assert_int_equal(mkdir(DIR "/replicates/references", 0777), 0);
        for (int k = 0; k < 16; k++) {
            char path[64];
            if (!(which >> (k / 8) & 1)) continue;
            assert_int_equal(bis_image_init(&image, 6, 4, NULL), BIS_OK);
            for (int i = 0; i < 24; i++) image.pixels[i] = of_replicate(k / 8, k % 8, i);
            snprintf(path, sizeof path, DIR "/replicates/references/%s-%d.exr", k < 8 ? "mis" : "sir", k % 8 + 1);
            assert_int_equal(bis_image_save(&image, path, NULL), BIS_OK);
            bis_image_clear(&image);
        }
        for (int k = 0; k < 2; k++)
            if (!(which >> k & 1)) t.plan.reference[k] = -1;
        const bis_trade_setting *const maker = &t.plan.settings[t.plan.reference[which == 2]];
        const double seconds = maker->pass_seconds * t.plan.reference_passes[which == 2];
        d.n = 0;
        assert_int_equal(bis_trade_make_references(&t, NULL), BIS_OK);
        assert_int_equal(d.n, which == 3 ? 16 : 8);
        assert_string_equal(d.entry[0].what, which == 2 ? "reference by sir" : "reference by mis");
        assert_near(d.entry[5].share, 5 / 8.0);
        assert_near(d.entry[5].left, 3 * seconds);
        for (int k = 0; k < 2; k++) {
            if (which >> k & 1) assert_reference(&t.references[k], k);
            else assert_false(t.references[k].is_ready);
        }
        const bis_trade_reference *const a = &t.references[0], *const b = &t.references[1];
        const double w = which == 1 ? 1 : which == 2 ? 0 : b->relmse / (a->relmse + b->relmse);
        assert_true(t.both.is_ready && t.both.image.width == 6);
        assert_near(t.both.mean, w * a->mean + (1 - w) * b->mean);
        assert_near(t.both.relmse, which == 3 ? 1 / (1 / a->relmse + 1 / b->relmse) : a->relmse + b->relmse);
        const double red = w * 4.5 + (1 - w) * 18;
        for (int i = 0; i < 24; i++) {
            const rgb c = t.both.image.pixels[i];
            const double own = i == 5 ? red / 64 : red;
            const double expected[3] = {i == 7 ? 3 : own, i == 7 ? 3 : own, i == 7 ? 3 : 2 * own};
            assert_true(fabs((double)c.r - expected[0]) < 1e-5 && fabs((double)c.g - expected[1]) < 1e-5);
            assert_true(fabs((double)c.b - expected[2]) < 1e-5);
        }
        bis_trade_clear(&t);
    }
}

/* A replicate, or a given picture, of another size than the plan's is refused, and nothing is made of the others. */
static void a_reference_of_another_size_is_refused(void **state)
{
    static const struct {
        int which, width, height;
        const char *name;
    } cases[] = {{0, 5, 4, "mis-1"}, {0, 6, 5, "mis-8"}, {1, 4, 6, "sir-3"}, {2, 7, 4, "given"}, {2, 6, 3, "given"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        bis_trade t;
        bis_diag diag = {0};
        bis_image image;
        char path[96], expected[256];
        load(&t);
        plan_two(&t);
        t.o.folder = DIR "/sizes";
        assert_int_equal(system("rm -rf " DIR "/sizes; mkdir -p " DIR "/sizes/references"), 0);
        for (int k = 0; k < 17; k++) {
            snprintf(path, sizeof path, k < 16 ? "%s-%d" : "given", k < 8 ? "mis" : "sir", k % 8 + 1);
            const bool is_bad = strcmp(path, cases[i].name) == 0;
            assert_int_equal(bis_image_init(&image, is_bad ? cases[i].width : 6, is_bad ? cases[i].height : 4, NULL),
                             BIS_OK);
            snprintf(expected, sizeof expected, DIR "/sizes/references/%s.exr", path);
            assert_int_equal(bis_image_save(&image, expected, NULL), BIS_OK);
            bis_image_clear(&image);
        }
        t.plan.is_given = cases[i].which == 2;
        t.plan.reference[0] = cases[i].which == 0 ? t.plan.reference[0] : -1;
        t.plan.reference[1] = cases[i].which == 1 ? t.plan.reference[1] : -1;
        assert_int_equal(bis_trade_make_references(&t, &diag), BIS_INPUT);
        snprintf(expected, sizeof expected, DIR "/sizes/references/%s.exr: error: %d x %d pixels, must have the 6 x 4 "
                 "of plan.txt; remove it and it is made again", cases[i].name, cases[i].width, cases[i].height);
        assert_int_equal(diag.n, 1);
        assert_string_equal(diag.messages[0].text, expected);
        assert_false(t.both.is_ready);
        bis_diag_clear(&diag);
        bis_trade_clear(&t);
    }
}

/* Two renders of one pixel, (1, 2, 4) and (3, 2, 0): the variances are 2, 0 and 8, the mean is (2, 2, 2), and so is m.
 */
static void each_channel_scatters_by_itself(void **state)
{
    bis_image images[2];
    bis_trade_reference reference = {.relmse = 1e30};
    for (int k = 0; k < 2; k++) {
        assert_int_equal(bis_image_init(&images[k], 1, 1, NULL), BIS_OK);
        images[k].pixels[0] = k ? (rgb){3, 2, 0} : (rgb){1, 2, 4};
    }
    assert_int_equal(bis_image_init(&reference.image, 1, 1, NULL), BIS_OK);
    reference.image.pixels[0] = (rgb){1, 2, 3};
    assert_near(bis_trade_scatter(images, 2, 0, &reference), (2 + 8) / 4.04 / 3);
    reference.relmse = 0; /* a reference without noise is what is right */
    assert_near(bis_trade_scatter(images, 2, 0, &reference), (2 / 1.04 + 8 / 9.04) / 3);
    for (int k = 0; k < 2; k++) bis_image_clear(&images[k]);
    bis_image_clear(&reference.image);
}

/* Two renders of six grey pixels, 1 + d and 1 - d: variances 2 d^2, means 1. Left out are those of the largest d. */
static void the_worst_pixels_are_spared(void **state)
{
    static const float d[6] = {0.25f, 0.75f, 0, 0.875f, 0.5f, 0.625f};
    static const double left[BIS_TRADE_MOST_SPARED + 1] = { /* sums of d^2 */
        0.0625 + 0.5625 + 0.765625 + 0.25 + 0.390625, 0.0625 + 0.5625 + 0.25 + 0.390625, 0.0625 + 0.25 + 0.390625,
        0.0625 + 0.25, 0.0625, 0};
    bis_image images[2];
    bis_trade_reference reference = {.relmse = 0};
    for (int k = 0; k < 2; k++) assert_int_equal(bis_image_init(&images[k], 3, 2, NULL), BIS_OK);
    assert_int_equal(bis_image_init(&reference.image, 3, 2, NULL), BIS_OK);
    for (int i = 0; i < 6; i++) {
        const float more = 1 + d[i], less = 1 - d[i];
        images[0].pixels[i] = (rgb){more, more, more};
        images[1].pixels[i] = (rgb){less, less, less};
        reference.image.pixels[i] = (rgb){1, 1, 1};
    }
    for (int spared = 0; spared <= BIS_TRADE_MOST_SPARED; spared++)
        assert_near(bis_trade_scatter(images, 2, spared, &reference), 2 * left[spared] / 1.01 / 6);
    for (int k = 0; k < 2; k++) bis_image_clear(&images[k]);
    bis_image_clear(&reference.image);
}

/* ---- resumed ---- */

/* A plan of 1 + 2 and 4 + 8 64ths of a second, of which the em of 1 is there: the rest is 14 64ths, by rounds of one
 * budget. */
static void the_rest_is_measured_in_rounds_and_told(void **state)
{
    static const char *const what[] = {"run 2 of 4", "run 3 of 4", "run 4 of 4", "error of the advice"};
    static const double share[] = {0, 4 / 14.0, 6 / 14.0, 0};
    diary d = {.n = 0};
    bis_image grey;
    bis_trade t;
    bool interrupted;
    load(&t);
    plan_two(&t);
    t.plan.is_given = true;
    t.plan.run_seconds = 1e-4;
    t.plan.settings[bis_trade_find_setting(&t.plan, "sir 64/4")].levels = 2;
    for (int i = 0; i < t.plan.n_settings; i++) t.plan.settings[i].pass_seconds /= 64;
    t.plan.reference[0] = t.plan.reference[1] = -1;
    if (!program_exists(DIR "/folder")) assert_int_equal(mkdir(DIR "/folder", 0777), 0);
    assert_int_equal(bis_trade_write_plan(&t, NULL), BIS_OK);
    bis_trade_clear(&t);
    assert_int_equal(bis_image_init(&grey, 6, 4, NULL), BIS_OK);
    for (int i = 0; i < 24; i++) grey.pixels[i] = (rgb){0.5f, 0.5f, 0.5f};
    assert_int_equal(mkdir(DIR "/folder/references", 0777), 0);
    assert_int_equal(bis_image_save(&grey, DIR "/folder/references/given.exr", NULL), BIS_OK);
    bis_image_clear(&grey);
    program_write_file(DIR "/folder/runs.csv", RUNS "em 16,1,1,7,0.5,11,21,31,0.5,0.25,0.125,0.25\n");
    const bis_trade_options o = {.scene = DIR "/scene.txt", .folder = DIR "/folder", .seconds = 1e6, .error = 0.9,
        .n_threads = 1, .resume = true,
                                 .progress = note, .user = &d};
    set_watch(0.1);
    assert_int_equal(bis_trade_measure(&t, &o, &interrupted, NULL), BIS_OK);
    watch.is_set = false;
    assert_true(t.is_complete && t.is_reported && !interrupted && t.n_runs == 4);
    int first = 0;
    while (first < d.n && strncmp(d.entry[first].what, "run ", 4) != 0) first++; /* behind the scene and its maps */
    for (int i = 0; i < 4; i++) {
        assert_string_equal(d.entry[first + i].what, what[i]);
        assert_near(d.entry[first + i].share, share[i]);
    }
    assert_near(d.entry[first].left, 14 / 64.0); /* as planned, before anything was made */
    /* of 14 planned 64ths 4 took 10^5 s, then 6 took twice that: 10 x 10^5/4 are left, 8 x 2 x 10^5/6 */
    assert_true(fabs(d.entry[first + 1].left / 2.5e5 - 1) < 1e-4 && fabs(d.entry[first + 2].left * 3 / 8e5 - 1) < 1e-4);
    int parts[3] = {0};
    for (int i = first + 3; i < d.n; i++) {
        static const char *const later[] = {"error of the advice", "seconds of the full picture", "pictures"};
        for (int k = 0; k < 3; k++) {
            if (strcmp(d.entry[i].what, later[k]) != 0) continue;
            assert_near(d.entry[i].share, parts[k] / (k < 2 ? 3.0 : 2.0));
            if (k == 0) assert_near(d.entry[i].left, 3e4 * (3 - parts[k]));
            if (k == 2) assert_near(d.entry[i].left, 1e-4 * (2 - parts[k]));
            parts[k]++;
        }
    }
    assert_true(parts[0] == 3 && parts[1] == 3 && parts[2] == 2); /* em and sir */
    assert_string_equal(d.entry[0].what, "reading the scene");
    assert_string_equal(d.entry[first - 1].what, "building the map's importance");
    assert_true(t.references[0].mean == 0.5 && t.both.mean == 0.5 && t.references[1].is_ready);
    for (int i = 0; i < BIS_TRADE_ADVICE; i++) assert_true(!t.result.advice[i].is_extrapolated &&
        t.result.advice[i].passes > 0);
    bis_trade_clear(&t);
}

/* A sweep in which each run takes some seconds by the clock, or is interrupted (-1); noted is how many lines the table
 * had when each began. */
typedef struct slow_sweep {
    double runs[4]; /* seconds */
    int seen[4], n;
} slow_sweep;

static void let_run(const char *what, double share, double left, void *user)
{
    slow_sweep *s = user;
    if (strcmp(what, "reading the scene") == 0) move_watch(30);
    if (strncmp(what, "run ", 4) != 0) return;
    assert_true(s->n < 4);
    s->seen[s->n] = 0;
    if (program_exists(DIR "/slow/runs.csv")) {
        char *const text = read_whole(DIR "/slow/runs.csv");
        for (const char *c = text; *c; c++) s->seen[s->n] += *c == '\n';
        bis_free(text);
    }
    if (s->runs[s->n] < 0) set_alarm(1e-6);
    else move_watch(s->runs[s->n]);
    s->n++;
}

/* Runs of 1 and 4 s, then 2 and 8 s, as planned, in the 40 s that 50 s leave, of which the scene takes 30: the last is
 * begun if 2 s are left over. The table is written after the first run, and then by the second. What does not fit at
 * all would take 15 s of 4 fifths. Where one run does not fit, a shorter one of the next round is not begun either. */
static void runs_are_begun_that_fit_and_written_by_the_second(void **state)
{
    static const struct { double seconds; slow_sweep by; int n; } cases[] = {
        {50, {{0.5, 0.4, 0.8, 8}, {0, 2, 2, 4}, 4}, 4}, {50, {{0.5, 0.4, 1.05}, {0, 2, 2, 4}, 4}, 4},
        {50, {{0.5, 0.4, 1.15}, {0, 2, 2}, 3}, 3}, {38.7, {{0}, {0}, 0}, 0}, {38.8, {{0.5}, {0}, 1}, 1},
        {50, {{7}, {0}, 1}, 1}, {50, {{0.5, -1}, {0, 2}, 2}, 1}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        slow_sweep s = cases[i].by;
        const bis_trade_options o = {.scene = DIR "/scene.txt", .folder = DIR "/slow", .seconds = cases[i].seconds,
                                     .error = 0.9, .n_threads = 1, .resume = true, .progress = let_run, .user = &s,
                                     .interrupted = &watch.signal};
        bis_trade t = {.n_runs = 0};
        bis_diag diag = {0};
        bool interrupted;
        load(&t);
        plan_two(&t);
        bis_trade_setting *const em = &t.plan.settings[bis_trade_find_setting(&t.plan, "em 16")];
        em[-1].levels = em->levels, em[-1].pass_seconds = em->pass_seconds; /* em 4, the first of all */
        em[-1].is_swept = true, em->is_swept = false, em->levels = 0;
        t.plan.settings[bis_trade_find_setting(&t.plan, "sir 64/4")].levels = 2;
        store_plan(&t, DIR "/slow");
        s.n = 0;
        set_watch(1e-6);
        const bis_status status = bis_trade_measure(&t, &o, &interrupted, &diag);
        watch.is_set = false;
        assert_int_equal(status, cases[i].n ? BIS_OK : BIS_INPUT);
        assert_true(t.is_complete == (cases[i].n == 4) && t.n_runs == (size_t)cases[i].n && s.n == cases[i].by.n);
        assert_int_equal(interrupted, s.n > cases[i].n);
        for (int k = 0; k < s.n; k++) assert_int_equal(s.seen[k], cases[i].by.seen[k]);
        if (status)
            assert_non_null(strstr(diag.messages[0].text, "error: 0 of 4 runs: none fitted into 38.7 s, so there is no "
                "advice and no page; go on with --resume --time for about 49 s, or measure into another folder with "
                "fewer integrators (--integrator)"));
        bis_diag_clear(&diag);
        bis_trade_clear(&t);
    }
}

/* ---- the advice, checked ---- */

/* Advice by em 16 for an error, of some passes of 4 s, put to the proof. *variance, where it is wanted: the scatter of
 * as many renders of so many passes as --passes allows, with the seeds of the first attempt, times passes. In vain
 * there is a reference: its noise is beyond all, so that only the renders count. */
static bis_trade_advice checked_from(uint32_t first, uint32_t passes, double error, const sig_atomic_t *interrupted,
                                     diary *d, double *variance)
{
    bis_trade t;
    load(&t);
    plan_two(&t);
    const int em = bis_trade_find_setting(&t.plan, "em 16");
    t.o.passes = passes;
    t.o.seconds = 1e-9; /* none */
    t.o.interrupted = interrupted;
    t.o.progress = note, t.o.user = d;
    t.both = (bis_trade_reference){.relmse = 1e30};
    assert_int_equal(bis_image_init(&t.both.image, 6, 4, NULL), BIS_OK);
    memset(t.both.image.pixels, 0, 24 * sizeof(rgb));
    t.result.curves[em] = (bis_trade_curve){.n = 1, .pass_seconds = 0.5};
    for (int i = 0; i < BIS_TRADE_ADVICE; i++) {
        t.result.advice[i] =
            (bis_trade_advice){"final picture", error, i == 1 ? em : -1, first, 4.0 * first, -1, false};
    }
    d->n = 0;
    if (variance) {
        enum { TURNS = 6, RENDERS = 8, ADVICE = 1 }; /* a seed for each render of each attempt at each advice */
        const int fitting = (int)(64 * passes / first), n = fitting < 2 ? 2 : fitting < RENDERS ? fitting : RENDERS;
        bis_image images[RENDERS] = {{0}};
        for (int k = 0; k < n; k++) {
            bis_render_result result;
            const uint64_t seed = bis_trade_seed(&t.plan, 3, ADVICE * TURNS * RENDERS + (uint64_t)k);
            assert_int_equal(bis_trade_render(&t, &(bis_trade_job){&t.plan.settings[em], t.plan.step, first, seed},
                                              &images[k], &result, NULL), BIS_OK);
        }
        *variance = first * bis_trade_scatter(images, n, 0, &t.both);
        for (int k = 0; k < RENDERS; k++) bis_image_clear(&images[k]);
    }
    assert_int_equal(bis_trade_check_advice(&t, NULL), BIS_OK);
    const bis_trade_advice a = t.result.advice[1];
    for (int i = 0; i < BIS_TRADE_ADVICE; i += 2)
        assert_true(t.result.advice[i].passes == first && t.result.advice[i].expected_error == -1);
    bis_trade_clear(&t);
    return a;
}

static bis_trade_advice checked(uint32_t passes, double error, const sig_atomic_t *interrupted, diary *d)
{
    return checked_from(3, passes, error, interrupted, d, NULL);
}

/* The next smaller number of passes of a stratified pixel: ... 9 = 3 x 3, 12 = 3 x 4, 16 = 4 x 4 ... */
static double one_less(double passes)
{
    const double side = ceil(sqrt(passes));
    return side * side == passes ? side * (side - 1) : (side - 1) * (side - 1);
}

/* Its passes are the fewest that leave no more than the error. Its seconds are 4 for each. */
static void assert_fewest(const bis_trade_advice *a)
{
    assert_true(a->expected_error > 0 && a->expected_error <= a->error * (1 + 1e-12));
    if (a->passes > 1) assert_true(a->expected_error * sqrt(a->passes / one_less(a->passes)) > a->error);
    assert_near(a->seconds, 4.0 * a->passes);
}

/* Without time there is one attempt, of one pass each: what follows for more passes is the root law's. --passes 1 asks
 * for no clock: it goes on with what is advised, as far as 64 passes; beyond, the root law again. */
static void advice_is_put_to_the_proof(void **state)
{
    static const double wanted[] = {1.9, 5.5, 15, 29};
    diary d;
    const bis_trade_advice rough = checked(0, 0.01, NULL, &d);
    assert_fewest(&rough);
    assert_true(rough.is_extrapolated && rough.passes > 1 && rough.setting >= 0 && rough.error == 0.01);
    assert_true(d.n > 0 && strcmp(d.entry[d.n - 1].what, "error of the advice") == 0);
    assert_near(d.entry[d.n - 1].share, 1 / 3.0);
    assert_near(d.entry[d.n - 1].left, 0.03e-9 * 2);
    const double variance = rough.expected_error * rough.expected_error * rough.passes;

    for (int i = 0; i < 4; i++) {
        const bis_trade_advice a = checked(1, sqrt(variance / wanted[i]), NULL, &d);
        assert_true(!a.is_extrapolated && a.passes < 64 && a.expected_error > 0 && a.expected_error <= a.error);
        assert_near(a.seconds, 4.0 * a.passes);
    }
    const bis_trade_advice far = checked(1, sqrt(variance / 4000), NULL, &d);
    assert_fewest(&far);
    assert_true(far.is_extrapolated && far.passes > 200);

    const bis_trade_advice easy = checked(0, 1e3, NULL, &d); /* a pass is more than enough */
    assert_true(easy.passes == 1 && !easy.is_extrapolated && easy.expected_error < 10 && easy.seconds == 4);

    const sig_atomic_t signal = 1;
    const bis_trade_advice none = checked(1, 0.01, &signal, &d);
    assert_true(none.passes == 3 && none.seconds == 12 && none.expected_error == -1 && !none.is_extrapolated);
}

/* The first attempt has 81 passes = 9 x 9. Its scatter says that 72 = 8 x 9, 81 or 90 = 9 x 10 are needed: by at most
 * 15 % others, so its word is the last. When it says 64, 100 or more, the next attempt is made with these. */
static void what_is_close_enough_is_not_rendered_again(void **state)
{
    static const struct { double wanted, passes; bool is_last; } cases[] = {
        {63.5, 64, false}, {71.5, 72, true}, {80.5, 81, true}, {89.5, 90, true}, {99.5, 100, false},
        {109.5, 110, false}};
    diary d;
    double variance;
    checked_from(81, 2, 0.5, NULL, &d, &variance);
    assert_true(variance > 0);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const double error = sqrt(variance / cases[i].wanted);
        const bis_trade_advice a = checked_from(81, 2, error, NULL, &d, NULL);
        const double of_first = sqrt(variance / cases[i].passes);
        assert_true(!a.is_extrapolated && a.expected_error > 0 && a.expected_error <= a.error);
        assert_near(a.seconds, 4.0 * a.passes);
        if (cases[i].is_last) assert_true(a.passes == cases[i].passes && fabs(a.expected_error / of_first - 1) < 1e-12);
        else assert_true(fabs(a.expected_error / of_first - 1) > 1e-6);
    }
}

/* What a check has found of one advice may serve another: the cheapest that keeps an error is its advice. No render is
 * made here, because the checks are interrupted. Rows: seconds and error of each before; which one is taken. */
static void the_cheapest_that_keeps_an_error_is_advised(void **state)
{
    static const struct { double seconds[3], error[3]; bool is_law; int taken[3]; } cases[] = {
        {{1, 2, 9}, {.4, .12, .05}, false, {0, 1, 2}}, {{1, 2, 9}, {.14, .15, .05}, false, {0, 0, 2}},
        {{2, 1, 9}, {.4, .12, .05}, false, {1, 1, 2}}, {{3, 2, 1}, {.4, .12, .05}, false, {2, 2, 2}},
        {{2, 2, 2}, {.4, .12, .05}, false, {2, 2, 2}}, {{1, 2, 9}, {.151, .15, .05}, false, {0, 1, 2}},
        {{1, 2, 9}, {.14, .15, .05}, true, {0, 1, 2}}};
    const double error[] = {.5, .15, .05};
    const char *const purpose[] = {"preview", "good picture", "final picture"};
    const sig_atomic_t signal = 1;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        bis_trade t;
        load(&t);
        plan_two(&t);
        t.o.interrupted = &signal;
        for (int k = 0; k < BIS_TRADE_ADVICE; k++)
            t.result.advice[k] = (bis_trade_advice){.purpose = purpose[k], .error = error[k], .setting = k == 1,
                                                    .passes = 5 + (uint32_t)k, .seconds = cases[i].seconds[k],
                                                    .expected_error = cases[i].error[k],
                                                    .is_extrapolated = k == 0 && cases[i].is_law};
        assert_int_equal(bis_trade_check_advice(&t, NULL), BIS_OK);
        for (int k = 0; k < BIS_TRADE_ADVICE; k++) {
            const bis_trade_advice *a = &t.result.advice[k];
            const int from = cases[i].taken[k];
            assert_string_equal(a->purpose, purpose[k]);
            assert_true(a->error == error[k] && a->setting == (from == 1) && a->passes == 5 + (uint32_t)from &&
                        a->seconds == cases[i].seconds[from] && a->expected_error == cases[i].error[from]);
        }
        bis_trade_clear(&t);
    }
}

/* All renders of an attempt have at most 64 times the passes of --passes together: with 1, four of 16 and eight of 4,
 * the most there are. With 7, four of 90, because five have two passes too many. */
static void renders_are_as_many_as_64_budgets_allow(void **state)
{
    static const uint32_t cases[3][2] = {{16, 1}, {4, 1}, {90, 7}};
    diary d;
    for (int i = 0; i < 3; i++) {
        const uint32_t passes = cases[i][0];
        double variance;
        checked_from(passes, cases[i][1], 0.5, NULL, &d, &variance);
        const double error = sqrt(variance / (passes - 0.5));
        const bis_trade_advice a = checked_from(passes, cases[i][1], error, NULL, &d, NULL);
        assert_int_equal(a.passes, passes);
        assert_near(a.expected_error, sqrt(variance / passes));
    }
}

static int falling(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x < y) - (x > y);
}

/* Of eight renders as large as the full picture, the five worst pixels are left out, because in half of the pictures
 * there is none as bad: 8 log 2 = 5.5. Eight of a quarter of the pixels are two pictures, and spare one; those of a
 * sixteenth, half a picture, none. The reference is in vain, so each pixel's mean is that of its renders. */
static void the_promise_is_what_half_of_the_pictures_have(void **state)
{
    enum { RENDERS = 8, TURNS = 6, ADVICE = 2, MOST = 24 * 16 };
    static const struct { int step, spared; } cases[] = {{1, 5}, {2, 1}, {4, 0}};
    assert_int_equal(BIS_TRADE_MOST_SPARED, 5);
    for (int c = 0; c < 3; c++) {
        bis_trade t;
        bis_image images[RENDERS];
        double error[MOST] = {0}, m = 0, sum = 0;
        load(&t);
        plan_two(&t);
        t.plan.step = cases[c].step, t.plan.width = 24 / cases[c].step, t.plan.height = 16 / cases[c].step;
        const int n = t.plan.width * t.plan.height, em = bis_trade_find_setting(&t.plan, "em 16");
        t.o.passes = 1;
        t.both = (bis_trade_reference){.relmse = 1e30};
        assert_int_equal(bis_image_init(&t.both.image, t.plan.width, t.plan.height, NULL), BIS_OK);
        memset(t.both.image.pixels, 0, (size_t)n * sizeof(rgb));
        for (int k = 0; k < RENDERS; k++) {
            bis_render_result result;
            const uint64_t seed = bis_trade_seed(&t.plan, 3, ADVICE * TURNS * RENDERS + (uint64_t)k);
            assert_int_equal(bis_trade_render(&t, &(bis_trade_job){&t.plan.settings[em], t.plan.step, 1, seed},
                                              &images[k], &result, NULL), BIS_OK);
            for (int i = 0; i < n; i++) m += rgb_sum(images[k].pixels[i]) / (3 * n * RENDERS);
        }
        for (int i = 0; i < n; i++) {
            for (int channel = 0; channel < 3; channel++) {
                double mean = 0, square = 0;
                for (int k = 0; k < RENDERS; k++) {
                    const double v = bis_trade_channel(images[k].pixels[i], channel);
                    mean += v / RENDERS;
                    square += v * v / RENDERS;
                }
                error[i] += RENDERS / (RENDERS - 1.0) * (square - mean * mean) / (mean * mean + m * m / 100) / (3 * n);
            }
        }
        qsort(error, (size_t)n, sizeof *error, falling);
        for (int i = cases[c].spared; i < n; i++) sum += error[i];
        for (int i = 0; i < BIS_TRADE_ADVICE; i++)
            t.result.advice[i] = (bis_trade_advice){"final picture", 1e3, i == ADVICE ? em : -1, 1, 4, -1, false};
        t.result.curves[em] = (bis_trade_curve){.n = 1, .pass_seconds = 0.5};
        assert_int_equal(bis_trade_check_advice(&t, NULL), BIS_OK);
        const double promised = t.result.advice[ADVICE].expected_error;
        if (fabs(promised / sqrt(sum) - 1) > 1e-5) fail_msg("step %d: %g, not %g", cases[c].step, promised, sqrt(sum));
        if (cases[c].spared) assert_true(sum + error[cases[c].spared - 1] > 1.001 * sum); /* none more, none less */
        assert_true(error[cases[c].spared] > 0.001 * sum);
        for (int k = 0; k < RENDERS; k++) bis_image_clear(&images[k]);
        bis_trade_clear(&t);
    }
}

/* The scatter of n renders of the attempt `turn` at the second advice, in which the reference counts for nothing. */
static double scatter_of(bis_trade *t, const bis_trade_setting *s, int turn, uint32_t passes, int n)
{
    enum { TURNS = 6, RENDERS = 8, ADVICE = 1 };
    bis_image images[RENDERS] = {{0}};
    for (int k = 0; k < n; k++) {
        bis_render_result result;
        const uint64_t seed = bis_trade_seed(&t->plan, 3, (uint64_t)((ADVICE * TURNS + turn) * RENDERS + k));
        const bis_trade_job job = {s, t->plan.step, passes, seed};
        assert_int_equal(bis_trade_render(t, &job, &images[k], &result, NULL), BIS_OK);
    }
    const double scatter = bis_trade_scatter(images, n, 0, &t->both);
    for (int k = 0; k < n; k++) bis_image_clear(&images[k]);
    return scatter;
}

/* Advice of `passes` by em 16, whose pass takes 1.5 s, as the second of three. A measurement of so many seconds gives
 * each 3% of its time, and the second has the first one's, too. */
static const bis_trade_setting *load_advice(bis_trade *t, double seconds, uint64_t seed, uint32_t passes)
{
    load(t);
    plan_two(t);
    const int em = bis_trade_find_setting(&t->plan, "em 16");
    t->o.seconds = seconds;
    t->plan.seed = seed;
    t->both = (bis_trade_reference){.relmse = 1e30};
    assert_int_equal(bis_image_init(&t->both.image, 6, 4, NULL), BIS_OK);
    memset(t->both.image.pixels, 0, 24 * sizeof(rgb));
    t->result.curves[em] = (bis_trade_curve){.n = 1, .pass_seconds = 1.5};
    for (int i = 0; i < BIS_TRADE_ADVICE; i++) t->result.advice[i].setting = -1;
    t->result.advice[1] = (bis_trade_advice){.setting = em, .passes = passes, .seconds = 4.0 * passes};
    return &t->plan.settings[em];
}

/* A render of 4 passes takes 6 readings of a second, and a look at the clock one; after two another is begun if more
 * than the 6 s that it takes are left of half of the time. With 40 s for that half there are five, with 34 four, with
 * 20 two, with 89 eight, the most. What they say is the last word. A signal after 24 s interrupts the fourth, which
 * does not count. */
static void renders_of_an_advice_take_half_of_what_time_is_left(void **state)
{
    static const struct { double half; int n; } cases[] = {{40, 5}, {34, 4}, {20, 2}, {89, 8}, {40, 3}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        bis_trade t;
        const bis_trade_setting *const em = load_advice(&t, cases[i].half / 0.03, 5, 4);
        bis_trade_advice *const a = &t.result.advice[1];
        const double relmse = scatter_of(&t, em, 0, 4, cases[i].n);
        a->error = sqrt(relmse * 4 / 3.5);
        set_watch(1);
        if (i == 4) set_alarm(24);
        t.o.interrupted = &watch.signal;
        assert_int_equal(bis_trade_check_advice(&t, NULL), BIS_OK);
        watch.is_set = false;
        assert_true(a->passes == 4 && !a->is_extrapolated && a->seconds == 16);
        assert_near(a->expected_error, sqrt(relmse));
        bis_trade_clear(&t);
    }
}

/* 400 passes are too many for 78 s, in which two renders of 25 fit. The first attempt has an eighth of 25, 2 x 2
 * passes, four times, and the second what the rest has room for, a little less, 4 x 4, twice. Then there is no time for
 * more: what the error takes follows from both by n^-p, p in [1, 3/2]. Of the seeds some give p between, some an
 * end. */
static void what_there_is_no_time_for_follows_from_two_attempts(void **state)
{
    int inside = 0, low = 0, high = 0;
    for (uint64_t seed = 1; seed <= 8; seed++) {
        bis_trade t;
        const bis_trade_setting *const em = load_advice(&t, 39 / 0.03, seed, 400);
        bis_trade_advice *const a = &t.result.advice[1];
        const double first = scatter_of(&t, em, 0, 4, 4), second = scatter_of(&t, em, 1, 16, 2);
        a->error = sqrt(first / 60); /* by the first, 240 passes */
        const double slope = log(first / second) / log(16 / 4), p = slope < 1 ? 1 : slope > 1.5 ? 1.5 : slope;
        const double needed = pow(second / (a->error * a->error), 1 / p) * 16;
        set_watch(1);
        assert_int_equal(bis_trade_check_advice(&t, NULL), BIS_OK);
        watch.is_set = false;
        assert_int_equal(a->passes, bis_trade_square_passes(&t, needed));
        assert_near(a->expected_error, sqrt(second * pow(16.0 / a->passes, p)));
        assert_true(a->is_extrapolated && a->seconds == 4.0 * a->passes);
        inside += p > 1 && p < 1.5;
        low += p == 1;
        high += p == 1.5;
        bis_trade_clear(&t);
    }
    assert_true(inside > 0 && low + high > 0);
}

/* A picture of the strip of t is the render of its passes, and its error is that from the mean of both references. */
static void assert_picture(bis_trade *t, int i, int setting, uint32_t passes, double seconds)
{
    const bis_trade_picture *const p = &t->strip[i];
    const bis_trade_job job = {&t->plan.settings[setting], t->plan.step, passes,
                               bis_trade_seed(&t->plan, 2, (uint64_t)setting)};
    bis_render_result result;
    bis_comparison c;
    bis_image image;
    assert_true(p->setting == setting && p->passes == passes && p->seconds == seconds);
    assert_int_equal(bis_trade_render(t, &job, &image, &result, NULL), BIS_OK);
    assert_memory_equal(image.pixels, p->image.pixels, 24 * sizeof(rgb));
    assert_int_equal(bis_compare(&c, &image, &t->both.image, NULL), BIS_OK);
    assert_true(c.relmse == p->relmse);
    bis_image_clear(&image);
}

/* Makes the pictures of *t once more, and asserts that there are n. */
static void remake(bis_trade *t, int n)
{
    for (int i = 0; i < t->n_strip; i++) bis_image_clear(&t->strip[i].image);
    t->n_strip = 0;
    assert_int_equal(bis_trade_make_pictures(t, NULL), BIS_OK);
    assert_int_equal(t->n_strip, n);
}

/* Runs of 2.5 s have room for 8.33 passes of em, and for a fortieth of sir's; by the clock of a second a reading 8 take
 * 6 s, and 1 takes 3. What was made before is read, with its seconds, if it has as many passes and is there. */
static void pictures_have_the_passes_of_the_longest_runs(void **state)
{
    static const char header[] = "setting,passes,seconds,relmse,file\n";
    char text[512], a[32], b[32];
    bis_trade t;
    load(&t);
    plan_two(&t);
    t.o.folder = DIR "/strip";
    assert_int_equal(system("rm -rf " DIR "/strip; mkdir " DIR "/strip"), 0);
    assert_int_equal(bis_image_init(&t.both.image, 6, 4, NULL), BIS_OK);
    for (int i = 0; i < 24; i++) t.both.image.pixels[i] = (rgb){0.5f, 0.25f, 1};
    const int em = bis_trade_find_setting(&t.plan, "em 16"), sir = bis_trade_find_setting(&t.plan, "sir 64/4");
    t.result.curves[em] = (bis_trade_curve){.n = 1, .pass_seconds = 0.3};
    t.result.curves[sir] = (bis_trade_curve){.n = 1, .pass_seconds = 100};
    set_watch(1);
    remake(&t, 2);
    assert_picture(&t, 0, em, 8, 6);
    assert_picture(&t, 1, sir, 1, 3);
    const int files = program_count_files("/proc/self/fd");
    snprintf(text, sizeof text, "%sem 16,8,6,%s,pictures/%02d.exr\nsir 64/4,1,3,%s,pictures/%02d.exr\n", header,
             bis_format_double(a, t.strip[0].relmse), em + 1, bis_format_double(b, t.strip[1].relmse), sir + 1);
    char *made = read_whole(DIR "/strip/pictures.csv");
    assert_string_equal(made, text);
    bis_free(made);

    program_write_file(DIR "/strip/pictures.csv", "em 16,8,0.75,1,x\nsir 64/4,11,9,1,x\nsir 64/4,1,-4,1,x\n");
    remake(&t, 2);
    assert_picture(&t, 0, em, 8, 0.75); /* read */
    assert_picture(&t, 1, sir, 1, 3);  /* made */
    snprintf(text, sizeof text, DIR "/strip/pictures/%02d.exr", em + 1);
    assert_int_equal(unlink(text), 0);
    t.result.curves[sir].pass_seconds = 1;
    remake(&t, 2);
    assert_picture(&t, 0, em, 8, 6);
    assert_picture(&t, 1, sir, 3, 5); /* of 2.5, rounded */
    t.result.curves[em].pass_seconds = 1e-9; /* 2^20 at most */
    program_write_file(DIR "/strip/pictures.csv", "em 16,1048576,7.5,1,x\nsir 64/4,3,4.5,1,x\n");
    remake(&t, 2);
    assert_true(t.strip[0].passes == 1048576 && t.strip[0].seconds == 7.5);
    t.o.interrupted = &watch.signal; /* what is there is still read */
    t.result.curves[sir].pass_seconds = 100;
    watch.signal = 1;
    remake(&t, 1);
    assert_true(t.strip[0].setting == em && t.strip[0].seconds == 7.5);
    set_watch(1);
    set_alarm(2); /* within the picture */
    assert_int_equal(unlink(text), 0);
    remake(&t, 0);
    assert_false(program_exists(text));
    assert_int_equal(program_count_files("/proc/self/fd"), files); /* none stays open */
    watch.is_set = false;
    bis_trade_clear(&t);
}

/* ---- without memory ---- */

static bis_status parsed(bis_trade *t, bis_diag *diag) { return bis_trade_load(t, diag); }

static bis_status pictured(bis_trade *t, bis_diag *diag)
{
    bis_image_clear(&t->strip[0].image);
    t->n_strip = 0;
    return bis_trade_make_pictures(t, diag);
}

static bis_status tabled(bis_trade *t, bis_diag *diag) { return bis_trade_write_tables(t, diag); }
static bis_status reported(bis_trade *t, bis_diag *diag) { return bis_trade_write_report(t, diag); }

/* The parts of a measurement that goes on, each with its k-th allocation failing after the ones before it went well: it
 * says that there is no memory, and nothing stays behind. */
static void each_part_says_that_there_is_no_memory(void **state)
{
    bis_status (*const parts[])(bis_trade *, bis_diag *) = {
        parsed, bis_trade_read_plan, bis_trade_read_runs, bis_trade_make_references, bis_trade_summarise,
        bis_trade_check_advice, bis_trade_time_advice, pictured, tabled, reported};
    enum { N_PARTS = sizeof parts / sizeof *parts };
    const bis_trade_options o = {.scene = DIR "/scene.txt", .folder = DIR "/poor", .seconds = 1e6, .error = 0.9,
                                 .passes = 1, .n_threads = 1, .resume = true};
    bis_trade t;
    load(&t);
    plan_two(&t);
    t.plan.settings[bis_trade_find_setting(&t.plan, "em 16")].levels = 1;
    store_plan(&t, DIR "/poor");
    program_write_file(DIR "/poor/runs.csv", RUNS "em 16,1,1,7,0.5,11,21,31,0.5,0.25,0.125,0.25\n"
                                                  "sir 64/4,1,1,9,0.5,11,21,31,0.5,0.25,0.125,0.25\n");
    const long live = bis_mem_live();
    for (int part = 0; part < N_PARTS; part++) {
        bis_status status = BIS_NOMEM;
        long k = 1;
        for (; status; k += k < 50 ? 1 : k / 8) {
            bis_diag diag = {0};
            assert_int_equal(system("rm -rf " DIR "/poor/pictures " DIR "/poor/pictures.csv"), 0);
            t = (bis_trade){.o = o};
            for (int i = 0; i < part; i++) assert_int_equal(parts[i](&t, NULL), BIS_OK);
            bis_mem_fail_at(k);
            status = parts[part](&t, &diag);
            const bool failed = bis_mem_count() >= k;
            bis_mem_fail_at(0);
            if ((status == BIS_NOMEM) != failed) fail_msg("part %d, allocation %ld: status %d", part, k, (int)status);
            const char *const said = diag.n == 1 ? diag.messages[0].text : diag.n_lost ? "no memory for a message" : "";
            if (status && !strstr(said, "memory") && !strstr(said, "allocate")) /* OpenEXR's word */
                fail_msg("part %d, allocation %ld: \"%s\"", part, k, said);
            bis_diag_clear(&diag);
            bis_trade_clear(&t);
            assert_int_equal(bis_mem_live(), live);
        }
        assert_true(k > 1 + (part != 6)); /* the seconds of a thin film's pass alone need none */
    }
}

/* A pass of the full picture is rendered where the sweep's film was thinner, here in 24 x 16 pixels in far less than
 * the thousands of seconds that were said, and a setting that is advised twice has the seconds of a pass in both. Of a
 * pass of 1.7 x 10^5 s every third pixel would take 2% of 10^6 s; of 2 x 10^5 every fourth, and the sweep knows as
 * much. */
static void seconds_are_those_of_a_pass_of_the_full_picture(void **state)
{
    static const double pass[] = {1e4, 1e4, 1.7e5, 2e5};
    for (int i = 0; i < 4; i++) {
        bis_trade t;
        load(&t);
        plan_two(&t);
        if (i == 0) t.plan.step = 1;
        const int em = bis_trade_find_setting(&t.plan, "em 16");
        t.result.advice[0].setting = -1;
        t.result.advice[1] = (bis_trade_advice){.setting = em, .passes = 2, .seconds = 2 * pass[i]};
        t.result.advice[2] = (bis_trade_advice){.setting = em, .passes = 6, .seconds = 1};
        assert_int_equal(bis_trade_time_advice(&t, NULL), BIS_OK);
        assert_true(i == 0 || i == 3 ? t.result.advice[1].seconds == 2 * pass[i] : t.result.advice[1].seconds < 1e3);
        assert_near(t.result.advice[2].seconds, 3 * t.result.advice[1].seconds);
        bis_trade_clear(&t);
    }
}

/* By a clock of a second a reading, which comes between passes and after tiles, a pass of the full 24 x 16 pixels takes
 * 4 s, one of every third pixel, 8 x 5, or of every second takes 3. What any pass takes, a quarter of a second, does
 * not grow with the pixels; it is never more than the pass. A pass of 1.8 x 10^5 s is the longest that takes 2% of
 * 10^6 s by every third pixel. */
static void seconds_grow_with_the_pixels_but_for_what_any_pass_takes(void **state)
{
    static const struct { double pass, fill, seconds; } cases[] = {
        {2e4, 0.25, 2 * 4}, {2.1e4, 0.25, 2 * (0.25 + 2.75 * 4)}, {8.1e4, 0.25, 2 * (0.25 + 2.75 * 9.6)},
        {1.799e5, 0.25, 2 * (0.25 + 2.75 * 9.6)}, {1.7e5, 10, 2 * 3}, {1.81e5, 0.25, 2 * 1.81e5},
        {2e4, 0.25, 2 * 2e4}}; /* the last is interrupted */
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        bis_trade t;
        diary d = {.n = 0};
        load(&t);
        plan_two(&t);
        const int em = bis_trade_find_setting(&t.plan, "em 16");
        t.plan.settings[em].fill_seconds = cases[i].fill;
        for (int k = 0; k < BIS_TRADE_ADVICE; k++) t.result.advice[k].setting = -1;
        t.result.advice[1] = (bis_trade_advice){.setting = em, .passes = 2, .seconds = 2 * cases[i].pass};
        t.o.progress = note, t.o.user = &d, t.o.interrupted = &watch.signal;
        set_watch(1);
        if (i == 6) set_alarm(1);
        assert_int_equal(bis_trade_time_advice(&t, NULL), BIS_OK);
        watch.is_set = false;
        assert_near(t.result.advice[1].seconds, cases[i].seconds);
        assert_int_equal(d.n, 1);
        assert_string_equal(d.entry[0].what, "seconds of the full picture");
        assert_true(d.entry[0].share == 1 / 3.0 && isnan(d.entry[0].left));
        bis_trade_clear(&t);
    }
}

/* Makes the folder of the plan of two settings, and returns what names its scene there. */
static unsigned long long fingerprint_of_two(void)
{
    bis_trade t;

    load(&t);
    plan_two(&t);
    if (!program_exists(DIR "/folder")) assert_int_equal(mkdir(DIR "/folder", 0777), 0);
    assert_int_equal(bis_trade_write_plan(&t, NULL), BIS_OK);
    const unsigned long long print = t.plan.fingerprint;
    bis_trade_clear(&t);
    return print;
}

static const char run_at_its_limits[] =
    "em 16,1048576,16,9007199254740991,1e12,9223372036854775808,9223372036854775808,"
    "9223372036854775808,1.7e308,1.6e308,-1.5e308,1.4e308";

static const struct {
    int column;
    const char *value, *name; /* of the column that is named */
} beyond[] = {
    {0, "sir 64/4", "passes"}, {0, "mis 64", "setting"}, {1, "2097152", "passes"}, {1, "3", "passes"},
    {1, "0", "passes"}, {2, "17", "replicate"}, {2, "0", "replicate"}, {3, "9007199254740994", "seed"},
    {3, "-1", "seed"}, {4, "1.1e12", "seconds"}, {4, "-1e-9", "seconds"}, {5, "9223372036854777856", "camera_rays"},
    {5, "0.5", "camera_rays"}, {6, "9223372036854777856", "shadow_rays"}, {6, "-1", "shadow_rays"},
    {7, "9223372036854777856", "candidates"}, {7, "x", "candidates"}, {8, "1e309", "rmse"}, {8, "-1e-9", "rmse"},
    {9, "inf", "relmse"}, {9, "-1e-9", "relmse"}, {10, "1e309", "bias"}, {10, "-1e309", "bias"},
    {10, "nan", "bias"},
    {11, "1e309", "relmse_both"}, {11, "-1e-9", "relmse_both"}, {11, "1 1", "relmse_both"}, {11, "", "relmse_both"},
    {3, "1.5", "seed"}, {4, "nan", "seconds"}, {7, "", "candidates"}, {11, "1,5", "relmse_both"},
};

static void cut_last_newline(const char *path)
{
    char *whole = read_whole(path);
    assert_true(whole[strlen(whole) - 1] == '\n');
    whole[strlen(whole) - 1] = '\0';
    program_write_file(path, whole);
    bis_free(whole);
}

/* A run that has number i of `beyond`, and is otherwise good. */
static void expect_refused(bis_trade *t, size_t i)
{
    char line[512], text[1024], expected[1024];
    const char *from = run_at_its_limits;
    for (int k = 0; k < beyond[i].column; k++) from = strchr(from, ',') + 1;
    const char *end = from + strcspn(from, ",");
    snprintf(line, sizeof line, "%.*s%s%s", (int)(from - run_at_its_limits), run_at_its_limits, beyond[i].value, end);
    snprintf(text, sizeof text, RUNS "%s\n", line);
    program_write_file(DIR "/folder/runs.csv", text);
    bis_diag diag = {0};
    assert_int_equal(bis_trade_read_plan(t, NULL), BIS_OK);
    assert_int_equal(bis_trade_read_runs(t, &diag), BIS_INPUT);
    snprintf(expected, sizeof expected,
             DIR "/folder/runs.csv:2:1: error: \"%s\" is no run of plan.txt, by its %s; remove "
                 "the line and it is measured again", line, beyond[i].name);
    assert_string_equal(diag.messages[0].text, expected);
    bis_diag_clear(&diag);
}

/* What each field may be at most and at least is taken as it stands, and what lies beyond is refused by its name. */
static void each_field_of_a_folder_is_taken_up_to_its_limits(void **state)
{
    char text[2048];
    bis_trade t;
    const unsigned long long print = fingerprint_of_two();
    snprintf(text, sizeof text,
        "fingerprint %016llx\nfull 32768 32768\nstep 32768\nsize 1 1\nseeds 16\nseed 9007199254740991\n"
        "run_seconds 1e9\ngiven 1\nreference 0 1 mis 16\nreference 1 4194304 sir 64/4\nsetting 21 1e9 1e9 0 em 16\n"
        "setting 0 1e-300 0 nan sir 64/4\n",
        print);
    program_write_file(DIR "/folder/plan.txt", text);
    snprintf(text, sizeof text, RUNS "%s\nem 16,1,1,0,0,0,0,0,0,0,1.3e308,0\n", run_at_its_limits);
    program_write_file(DIR "/folder/runs.csv", text);
    load(&t);
    const bis_trade_plan *p = &t.plan, fresh = t.plan;
    assert_int_equal(bis_trade_read_plan(&t, NULL), BIS_OK);
    assert_int_equal(bis_trade_read_runs(&t, NULL), BIS_OK);
    assert_true(
        p->full_width == 32768 && p->full_height == 32768 && p->step == 32768 && p->width == 1 && p->height == 1);
    assert_true(p->n_seeds == 16 && p->seed == BIS_SEED_MAX && p->run_seconds == 1e9 && p->is_given);
    assert_true(p->reference_passes[0] == 1 && p->reference_passes[1] == 4194304);
    const int em = bis_trade_find_setting(p, "em 16"), sir = bis_trade_find_setting(p, "sir 64/4");
    const bis_trade_setting *a = &p->settings[em], *b = &p->settings[sir];
    assert_true(
        a->is_swept && a->levels == 21 && a->pass_seconds == 1e9 && a->fill_seconds == 1e9 && a->pass_relmse == 0);
    assert_true(
        b->is_swept && b->levels == 0 && b->pass_seconds == 1e-300 && b->fill_seconds == 0 && isnan(b->pass_relmse));
    assert_int_equal(t.n_runs, 2);
    const bis_trade_run *most = &t.runs[0], *least = &t.runs[1];
    assert_true(most->setting == em && most->level == 20 && most->replicate == 15 && most->seed == BIS_SEED_MAX);
    assert_true(
        most->seconds == 1e12 && most->camera_rays == (uint64_t)1 << 63 && most->shadow_rays == (uint64_t)1 << 63);
    assert_true(most->candidates == (uint64_t)1 << 63 && most->rmse == 1.7e308 && most->relmse == 1.6e308);
    assert_true(most->bias == -1.5e308 && most->relmse_both == 1.4e308);
    assert_true(least->level == 0 && least->replicate == 0 && least->seed == 0 && least->seconds == 0 &&
                least->bias == 1.3e308);

    /* the last line of a file needs no newline */
    cut_last_newline(DIR "/folder/plan.txt");
    cut_last_newline(DIR "/folder/runs.csv");
    t.plan = fresh;
    t.n_runs = 0;
    assert_int_equal(bis_trade_read_plan(&t, NULL), BIS_OK);
    assert_int_equal(bis_trade_read_runs(&t, NULL), BIS_OK);
    assert_true(b->is_swept && isnan(b->pass_relmse) && t.n_runs == 2 && t.runs[1].bias == 1.3e308);

    for (size_t i = 0; i < sizeof beyond / sizeof *beyond; i++) {
        t.plan = fresh;
        t.n_runs = 0;
        expect_refused(&t, i);
    }
    bis_trade_clear(&t);
}

/* What "size" must be follows from "full" and "step", so it stands behind both. One pixel is a picture. */
static void the_size_of_a_plan_stands_behind_what_it_follows_from(void **state)
{
    static const struct {
        const char *lines;
        int wrong; /* the line that is refused; 0: none */
    } cases[] = {
        {"full 1 1\nstep 1\nsize 1 1\n", 0},    {"step 1\nfull 6 4\nsize 6 4\n", 0},
        {"full 6 4\nsize 6 4\nstep 1\n", 3},    {"step 1\nsize 6 4\nfull 6 4\n", 3},
        {"size 6 4\nfull 6 4\nstep 1\n", 2},    {"full 6 4\nstep 1\nsize 4 4\n", 4},
        {"full 6 4\nstep 1\nsize 6 6\n", 4},    {"full 6 4\nstep 3\nsize 2 1\n", 0},
        {"full 1 2\nstep 2\nsize 1 1\n", 4},    {"full 2 2\nstep 2\nsize 1 1\n", 0},
    };
    char text[2048], expected[1024];
    bis_trade t;

    const unsigned long long print = fingerprint_of_two();
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        bis_diag diag = {0};
        snprintf(text, sizeof text, "fingerprint %016llx\n%sseeds 1\nseed 5\nrun_seconds 2.5\ngiven 1\n"
                 "setting 1 1 0 nan em 16\n", print,
                 cases[i].lines);
        program_write_file(DIR "/folder/plan.txt", text);
        load(&t);
        t.plan.full_width = t.plan.full_height = t.plan.step = 0;
        const bis_status status = bis_trade_read_plan(&t, &diag);
        if ((status == BIS_OK) != (cases[i].wrong == 0))
            fail_msg("case %zu: status %d, \"%s\"", i, (int)status, diag.n ? diag.messages[0].text : "");
        if (status) {
            const char *line = strstr(cases[i].lines, "size");
            snprintf(expected, sizeof expected, DIR "/folder/plan.txt:%d:1: error: \"%.8s\": behind \"size\" must "
                     "stand width and height in pixels, those of \"full\" divided by \"step\", which stand before; the "
                     "file is damaged, measure into a new folder", cases[i].wrong, line);
            assert_int_equal(diag.n, 1);
            assert_string_equal(diag.messages[0].text, expected);
        }
        bis_diag_clear(&diag);
        bis_trade_clear(&t);
    }
}

/* Whenever the list of runs has to grow and there is no memory, the message counts the run that has no place, and those
 * before it stay. */
static void runs_without_memory_are_counted(void **state)
{
    bis_trade t = {0};
    int refused = 0;
    for (uint64_t n = 0; n < 100; n++) {
        const bis_trade_run run = {.seed = n};
        bis_diag diag = {0};
        char expected[64];
        bis_mem_fail_at(1);
        const bis_status status = bis_trade_add_run(&t, &run, &diag);
        bis_mem_fail_at(0);
        if (status) {
            refused++;
            assert_true(status == BIS_NOMEM && t.n_runs == n && diag.n == 1);
            snprintf(expected, sizeof expected, "error: no memory for %u runs", (unsigned)n + 1);
            assert_non_null(strstr(diag.messages[0].text, expected));
            bis_diag_clear(&diag);
            assert_int_equal(bis_trade_add_run(&t, &run, NULL), BIS_OK);
        }
        assert_true(t.n_runs == n + 1 && t.runs[n].seed == n);
    }
    assert_true(refused >= 2);
    bis_trade_clear(&t);
}

/* A signal that comes when the maker's replicate is told. */
typedef struct stop_at {
    volatile sig_atomic_t flag;
    const char *what;
    int replicate, n; /* n: of those told */
} stop_at;

static void stop_there(const char *what, double share, double left, void *user)
{
    stop_at *s = user;
    const bool is_sir = strcmp(what, "reference by sir") == 0;
    if (!is_sir) assert_string_equal(what, "reference by mis");
    assert_near(share, s->n % 8 / 8.0);
    assert_near(left, (is_sir ? 5 : 1.5) * (8 - s->n % 8)); /* 3 passes of half a second, 1 of 5 s */
    assert_int_equal(is_sir, s->n / 8);
    if (strcmp(what, s->what) == 0 && s->n % 8 == s->replicate) s->flag = 1;
    s->n++;
}

static int replicates_of(const char *maker, bis_image *images)
{
    int n = 0;
    for (int k = 0; k < 8; k++) {
        char path[256];
        snprintf(path, sizeof path, DIR "/stopped/references/%s-%d.exr", maker, k + 1);
        if (!program_exists(path)) continue;
        assert_int_equal(n++, k); /* without a gap */
        if (images) assert_int_equal(bis_image_read(&images[k], path, (bis_loc){0}, NULL), BIS_OK);
    }
    return n;
}

/* A replicate that a signal ends is not kept, and neither is what would follow from all eight; those before it stay.
 * When it goes on, the missing ones are rendered and nothing else, to the same bits. */
static void a_replicate_that_was_interrupted_is_not_kept(void **state)
{
    static const struct {
        const char *what;
        int replicate, mis, sir; /* how many are kept */
    } cases[] = {{"reference by mis", 0, 0, 0}, {"reference by mis", 5, 5, 0}, {"reference by sir", 7, 8, 7},
                 {"", 0, 8, 8}};
    bis_image first[8] = {{0}}, now[8] = {{0}};
    assert_int_equal(system("rm -rf " DIR "/stopped && mkdir -p " DIR "/stopped/references"), 0);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        stop_at stop = {.what = cases[i].what, .replicate = cases[i].replicate};
        bis_trade t;
        load(&t);
        plan_two(&t);
        t.o.folder = DIR "/stopped";
        t.o.interrupted = &stop.flag, t.o.progress = stop_there, t.o.user = &stop;
        t.plan.reference_passes[1] = 1;
        t.plan.settings[t.plan.reference[0]].pass_seconds = 0.5;
        t.plan.settings[t.plan.reference[1]].pass_seconds = 5;
        assert_int_equal(bis_trade_make_references(&t, NULL), BIS_OK);
        assert_int_equal(replicates_of("mis", i < 2 ? NULL : i == 2 ? first : now), cases[i].mis);
        assert_int_equal(replicates_of("sir", NULL), cases[i].sir);
        assert_true(t.references[0].is_ready == (cases[i].mis == 8) && t.references[1].is_ready == (cases[i].sir == 8));
        assert_true(t.both.is_ready == (cases[i].mis == 8));
        bis_trade_clear(&t);
    }
    for (int k = 0; k < 8; k++) {
        assert_memory_equal(first[k].pixels, now[k].pixels, 24 * sizeof(rgb));
        bis_image_clear(&first[k]);
        bis_image_clear(&now[k]);
    }
}

/* The worst is at the left and the best at the right, wherever they stand in the strip; of equal ones the reference. */
static void the_slider_begins_with_the_worst_and_the_best(void **state)
{
    static const struct {
        double relmse[2];
        const char *says[3];
    } cases[] = {
        {{0.04, 0.0025}, {"`p0` selected=", "<label>right", "`p1` selected="}},
        {{0.0025, 0.04}, {"`p1` selected=", "<label>right", "`p0` selected="}},
        {{0.04, 0.04}, {"`ref`>", "<label>right", "`p0` selected="}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        bis_trade t;
        forge(&t);
        make_strip(&t);
        for (int k = 0; k < 2; k++) t.strip[k].relmse = cases[i].relmse[k];
        write_page(&t);
        assert_shown((const char *const[]){"<label>left", cases[i].says[0], cases[i].says[1], cases[i].says[2], NULL});
        clear(&t);
    }
}

/* Before the last run a folder takes the place of the table. */
static void block_the_table(const char *what, double share, double left, void *user)
{
    if (strcmp(what, "run 3 of 3") != 0) return;
    unlink(DIR "/last/runs.csv");
    assert_int_equal(mkdir(DIR "/last/runs.csv", 0777), 0);
}

/* All was measured, but not written: that is an error, and there is no report. */
static void runs_that_cannot_be_written_at_the_end_are_an_error(void **state)
{
    static const char message[] = DIR "/last/runs.csv: error: cannot write \"" DIR "/last/runs.csv\": ";
    bis_trade t;
    bis_diag diag = {0};
    bool interrupted;
    load(&t);
    plan_two(&t);
    store_plan(&t, DIR "/last");
    const bis_trade_options o = {.scene = DIR "/scene.txt", .folder = DIR "/last", .seconds = 1e6, .error = 0.9,
                                 .n_threads = 1, .resume = true, .progress = block_the_table};
    assert_int_equal(bis_trade_measure(&t, &o, &interrupted, &diag), BIS_IO);
    assert_true(t.is_complete && !t.is_reported && !interrupted && t.n_runs == 3);
    assert_int_equal(diag.n, 1);
    assert_int_equal(strncmp(diag.messages[0].text, message, sizeof message - 1), 0);
    assert_false(program_exists(DIR "/last/report.html"));
    bis_diag_clear(&diag);
    bis_trade_clear(&t);
}

static const expect_word words[] = {{"table", table}, {"data", data}, {"page", page}, {"settings", settings},
                                    {"damage", damage}, {NULL, NULL}};
static const expect_text texts[] = {{"version", BIS_VERSION}, {NULL, NULL}};

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(points_are_means_and_medians_of_their_seeds),
        cmocka_unit_test(a_median_does_not_depend_on_the_order),
        cmocka_unit_test(curves_are_weighted_by_passes_and_leave_out_what_is_hidden),
        cmocka_unit_test(equal_points_are_both_on_the_front),
        cmocka_unit_test(errors_at_a_time_and_times_to_an_error_lie_on_lines_between_the_budgets),
        cmocka_unit_test(the_best_counts_its_standard_error_and_no_bias),
        cmocka_unit_test(no_more_heads_than_the_strip_has_places),
        cmocka_unit_test(columns_are_halves_of_the_longest_run_and_round_errors),
        cmocka_unit_test(the_enlarged_parts_do_not_depend_on_the_unit),
        cmocka_unit_test(points_stand_where_the_axes_have_them),
        cmocka_unit_test(the_page_of_one_names_no_reference_that_is_not_ready),
        cmocka_unit_test(the_data_have_pictures_and_what_was_left_out),
        cmocka_unit_test(the_data_have_their_members_in_order),
        cmocka_unit_test(plots_have_the_figures_of_their_range),
        cmocka_unit_test(without_a_script_the_page_is_text),
        cmocka_unit_test(a_summary_without_advice_says_so),
        cmocka_unit_test(enlarged_parts_are_quarters_rounded_up),
        cmocka_unit_test(a_plan_fills_half_of_the_time),
        cmocka_unit_test(the_middle_cost_does_not_depend_on_the_order),
        cmocka_unit_test(a_plan_with_passes_has_as_many_of_each),
        cmocka_unit_test(a_biased_setting_gets_the_short_curve),
        cmocka_unit_test(a_setting_is_left_out_if_its_pass_takes_too_long),
        cmocka_unit_test(a_plan_has_no_more_than_the_most),
        cmocka_unit_test(a_plan_without_time_is_refused),
        cmocka_unit_test(an_error_out_of_reach_is_refused),
        cmocka_unit_test(a_map_that_is_too_large_is_built_once),
        cmocka_unit_test(the_pilot_tells_how_far_it_is),
        cmocka_unit_test(the_pilot_has_as_many_passes_as_its_time_allows),
        cmocka_unit_test(the_pilot_has_as_many_pixels_as_its_time_allows),
        cmocka_unit_test(a_pilot_that_takes_all_the_time_is_given_up),
        cmocka_unit_test(the_scenes_own_setting_is_refused_if_a_pass_takes_too_long),
        cmocka_unit_test(seeds_are_those_asked_for_or_follow_from_the_time),
        cmocka_unit_test(a_light_of_its_own_is_built_as_the_scenes),
        cmocka_unit_test(plan_and_runs_are_written_and_read_back),
        cmocka_unit_test(runs_are_written_in_order),
        cmocka_unit_test(an_empty_folder_is_taken),
        cmocka_unit_test(a_folder_that_cannot_be_used_is_told),
        cmocka_unit_test(a_plan_has_pixels_and_not_too_many),
        cmocka_unit_test(references_are_read_and_combined),
        cmocka_unit_test(a_reference_of_another_size_is_refused),
        cmocka_unit_test(each_channel_scatters_by_itself),
        cmocka_unit_test(the_worst_pixels_are_spared),
        cmocka_unit_test(the_rest_is_measured_in_rounds_and_told),
        cmocka_unit_test(runs_are_begun_that_fit_and_written_by_the_second),
        cmocka_unit_test(advice_is_put_to_the_proof),
        cmocka_unit_test(what_is_close_enough_is_not_rendered_again),
        cmocka_unit_test(the_cheapest_that_keeps_an_error_is_advised),
        cmocka_unit_test(renders_are_as_many_as_64_budgets_allow),
        cmocka_unit_test(the_promise_is_what_half_of_the_pictures_have),
        cmocka_unit_test(renders_of_an_advice_take_half_of_what_time_is_left),
        cmocka_unit_test(what_there_is_no_time_for_follows_from_two_attempts),
        cmocka_unit_test(pictures_have_the_passes_of_the_longest_runs),
        cmocka_unit_test(each_part_says_that_there_is_no_memory),
        cmocka_unit_test(seconds_are_those_of_a_pass_of_the_full_picture),
        cmocka_unit_test(seconds_grow_with_the_pixels_but_for_what_any_pass_takes),
        cmocka_unit_test(each_field_of_a_folder_is_taken_up_to_its_limits),
        cmocka_unit_test(the_size_of_a_plan_stands_behind_what_it_follows_from),
        cmocka_unit_test(runs_without_memory_are_counted),
        cmocka_unit_test(a_replicate_that_was_interrupted_is_not_kept),
        cmocka_unit_test(the_slider_begins_with_the_worst_and_the_best),
        cmocka_unit_test(runs_that_cannot_be_written_at_the_end_are_an_error),
    };
    return expect_run("trade by hand", tests, sizeof tests / sizeof *tests, setup, NULL,
                      &(expect_folder){"tests/data/expect/trade", words, texts});
}
