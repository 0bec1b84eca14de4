/* SPDX-License-Identifier: BSD-2-Clause */
/* trade: what does a scene cost with which method, and how far is the picture from right? For
 * src/tools/trade/trade_*.c and src/cli/cmd_trade.c alone.
 *
 * A sweep is a table of settings (integrator, M, N, proposal, b, ...) x budgets of 1, 2, 4, ... passes x seeds. Each of
 * these runs is a render of its own, the one that `bis render --spp --seed` would make, compared with a reference that
 * no method of its own family has made:
 *
 *     pilot (what does a pass cost?) -> plan.txt -> references/ -> runs.csv, a line a run -> pictures/ -> tables,
 *     report.html
 *
 * Everything that was measured is in the folder at once, written under a temporary name and renamed, so that a run can
 * be interrupted and resumed anywhere; what follows from the runs (means, slopes, the front, the page) is computed
 * again from runs.csv. */
#pragma once

#include "bis/base/clock.h"
#include "bis/render/render.h"

enum {
    BIS_TRADE_SETTINGS = 40,         /* at most */
    BIS_TRADE_LEVELS = 21,           /* budgets of 1 ... 2^20 passes */
    BIS_TRADE_SEEDS = 16,            /* at most */
    BIS_TRADE_MOST_PASSES = 1 << 22, /* of a replicate of a reference: four times the longest budget */
    BIS_TRADE_NAME = 48,
    BIS_TRADE_LIGHTS = 6,
    BIS_TRADE_MOST_PIXELS =
        90000, /* of the thin film in the mean; a step is a whole number: up to 2.25 times as many */
    BIS_TRADE_REFERENCE_BUDGETS = 4, /* with --passes: a replicate of a reference has so many times the passes */
    BIS_TRADE_REPLICATES = 8,        /* independent renders behind a reference: where its standard error comes from */
    BIS_TRADE_STRIP = 8              /* pictures in the report */
};

/* ---- what is swept ---- */

typedef struct bis_trade_setting {
    char name[BIS_TRADE_NAME]; /* "sir 256/16", without a comma: the key in all files */
    bis_settings settings;
    double area_exponent;      /* b of the map's importance */
    bool is_biased, is_scenes; /* by its claim; the scene's own setting */
    bool is_swept;             /* else only a candidate for the reference */
    double pass_seconds;       /* of one pass of the sweep's size, from the pilot */
    double fill_seconds;       /* of these, what a pass of any size takes: pools, clusters */
    double pass_relmse;        /* estimated by the pilot from the scatter of passes; NAN: not known */
    int levels;                /* budgets 1 ... 2^(levels-1) passes; 0: one pass is too slow for this plan */
} bis_trade_setting;

typedef struct bis_trade_plan {
    uint64_t fingerprint;           /* of the scene's text */
    int full_width, full_height;    /* as the scene asks for */
    int step, width, height;        /* as measured: of each step x step pixels one (bis_film_init_thin) */
    int n_seeds;
    uint64_t seed;
    double run_seconds;             /* of the longest runs: the time of the equal-time pictures */
    int reference[2];               /* settings of the references, a mis and a sir; -1: given or not needed */
    uint32_t reference_passes[2];   /* of each replicate */
    bool is_given;                  /* --reference: references/given.exr */
    bis_trade_setting settings[BIS_TRADE_SETTINGS];
    int n_settings;
} bis_trade_plan;

/* One render and its error. */
typedef struct bis_trade_run {
    int setting, level, replicate;
    uint64_t seed;
    double seconds;
    uint64_t camera_rays, shadow_rays, candidates;
    double rmse, relmse, bias; /* of bis_compare, with the reference by another method */
    double relmse_both;        /* and with the mean of both */
} bis_trade_run;

typedef struct bis_trade_reference {
    bis_image image;
    double relmse;   /* what its own noise adds to anyone's relMSE; 0 where given: not known */
    double mean, se; /* over the picture; se from the replicates, 0 where given */
    bool is_ready;
} bis_trade_reference;

/* A picture of the equal-time strips. */
typedef struct bis_trade_picture {
    int setting;
    uint32_t passes;
    double seconds, relmse;
    bis_image image;
} bis_trade_picture;

/* ---- what follows ---- */

/* All seeds of one setting and budget. */
typedef struct bis_trade_point {
    int setting, level, n; /* n: seeds measured */
    uint32_t passes;
    double seconds;                /* median */
    double camera_rays, shadow_rays, candidates;
    double rmse, relmse, relmse_se;
    double noise;                  /* relmse from both references' mean, less their share; <= 0: they are too short */
    double noise_se;               /* NAN: one seed */
    double bias, bias_se;          /* NAN: one seed */
    double cost_variance;          /* seconds * noise */
    bool on_front;
} bis_trade_point;

/* All budgets of one setting: points[first ... first + n - 1]. */
typedef struct bis_trade_curve {
    int first, n;
    double cost_variance, cost_variance_se; /* mean over budgets; se from the seeds */
    double slope, slope_se;                 /* of log error over log seconds; NAN: fewer than three budgets */
    double pass_seconds;                    /* at the longest budget */
} bis_trade_curve;

/* What to use for an error. */
typedef struct bis_trade_advice {
    const char *purpose;
    double error;
    int setting;              /* -1: nothing was measured */
    uint32_t passes;
    double seconds;           /* expected for the full picture */
    double expected_error;
    bool is_extrapolated;     /* it was measured with another number of passes */
} bis_trade_advice;

enum { BIS_TRADE_ADVICE = 3 };

typedef struct bis_trade_result {
    bis_trade_point *points;
    int n_points;
    bis_trade_curve curves[BIS_TRADE_SETTINGS];
    bis_trade_advice advice[BIS_TRADE_ADVICE];
    int best;                 /* the unbiased setting of least cost x variance, -1: none */
} bis_trade_result;

/* ---- a measurement ---- */

typedef struct bis_trade_options {
    const char *scene, *folder, *reference; /* reference: NULL or a file */
    double seconds;       /* of everything */
    double error;         /* relative RMSE to reach; 0: none asked for */
    bool quick, resume, approximate;
    int width, height;    /* of the full picture; 0: the scene's */
    int n_seeds;          /* 0: by the time */
    uint32_t passes;      /* the largest budget of every setting; 0: by the time */
    uint64_t seed;
    int n_threads;        /* 0: all */
    const char *const *integrators; /* the only ones to sweep */
    int n_integrators;    /* 0: all */
    const volatile sig_atomic_t *interrupted;
    /* may be NULL; seconds_left may be NAN */
    void (*progress)(const char *what, double share, double seconds_left, void *user);
    void *user;
} bis_trade_options;

typedef struct bis_trade {
    bis_trade_options o;
    bis_scene_desc *desc;
    bis_scene *scene;
    struct {
        double b;
        bool compensated;
        bis_light *light; /* [0] is the scene's, borrowed */
    } lights[BIS_TRADE_LIGHTS];
    int n_lights;
    bis_trade_plan plan;
    bis_trade_run *runs;
    size_t n_runs, capacity_runs;
    bis_trade_reference references[2]; /* by mis, by sir; given: both the same */
    bis_trade_reference both;          /* their mean; se is not known */
    bis_trade_picture strip[BIS_TRADE_STRIP];
    int n_strip;
    bis_trade_result result;
    double start;         /* on bis_clock_now's clock */
    int n_threads;        /* as used */
    uint64_t nonfinite;
    bool made_folder;     /* it was not there before */
    bool is_complete;     /* every run of the plan was measured */
    bool is_reported;     /* the tables and the page were written from what is in runs and result */
} bis_trade;

/* The whole measurement, into o->folder. t is zero-initialised; bis_trade_clear it. *interrupted: by the signal flag,
 * with what was measured written. Errors: BIS_INPUT (scene, budget, reference, folder), BIS_IO, BIS_NOMEM. */
bis_status bis_trade_measure(bis_trade *t, const bis_trade_options *o, bool *interrupted, bis_diag *diag);
void bis_trade_clear(bis_trade *t);

/* bis_trade_seed returns the seed of a render: other purposes and places have others; 53 bits, as --seed takes. */
static inline uint64_t bis_trade_seed(const bis_trade_plan *plan, unsigned purpose, uint64_t place)
{
    return bis_hash(bis_hash(plan->seed + purpose) + place) >> 11;
}

/* Channel k of a colour. */
static inline double bis_trade_channel(rgb c, int k) { return (double)(k == 0 ? c.r : k == 1 ? c.g : c.b); }

/* --- trade_settings.c --- */

/* The table: the scene's own setting, then all others that make sense for its light. */
void bis_trade_list_settings(bis_trade *t, bool small_map);
int bis_trade_find_setting(const bis_trade_plan *plan, const char *name);

/* Is it compared? `exact` and `unoccluded` are not, because one is a reference and the other leaves the shadows out.
 */
bool bis_trade_is_rival(const bis_integrator *i);

/* Which reference judges this setting: 0, by mis, or 1, by sir. Never one of its own family. */
int bis_trade_judge_of(const bis_trade_setting *s);

/* May it make reference 0 (a mis) or 1 (a sir)? trade_plan.c */
bool bis_trade_may_be_reference(const bis_trade_setting *s, int which);

/* As text: what differs from the defaults, for a scene file; and options for the command line, "" where it has none. */
void bis_trade_scene_text(char text[256], const bis_trade_setting *s, double scenes_b);
void bis_trade_option_text(char text[128], const bis_trade_setting *s, double scenes_b);

/* --- trade_scene.c --- */

bool bis_trade_interrupted(const bis_trade *t);
void bis_trade_tell(const bis_trade *t, const char *what, double share, double seconds_left);

/* Parse, apply the options, build everything that the settings need. */
bis_status bis_trade_load(bis_trade *t, bis_diag *diag);
void bis_trade_unload(bis_trade *t);

/* The film that is measured, of each step x step pixels one; step 0: a film of one pixel that sees all. How many pixels
 * it has. */
bis_film bis_trade_film(const bis_trade *t, int step);
double bis_trade_pixels(const bis_trade *t, int step);

/* Render `passes` into it; image (may be NULL) is cleared by the caller, *relative_rmse (may be NULL) from
 * the passes' scatter. An interrupted render leaves result->passes < passes. */
bis_status bis_trade_render(bis_trade *t, const bis_trade_setting *s, int step, uint32_t passes, uint64_t seed,
                            bis_image *image, bis_render_result *result, bis_diag *diag);

/* --- trade_plan.c --- */

bis_status bis_trade_make_plan(bis_trade *t, bis_diag *diag);

/* bis_trade_fit_plan fits the plan to `left` seconds: its size, levels, run_seconds and references, from what the pilot
 * found: pass_seconds of a pixel, which become those of a pass, and pass_relmse. Errors: BIS_INPUT. */
bis_status bis_trade_fit_plan(bis_trade *t, double left, bis_diag *diag);
size_t bis_trade_planned_runs(const bis_trade_plan *plan);
double bis_trade_planned_seconds(const bis_trade_plan *plan, int setting, int level);

/* --- trade_files.c --- */

/* folder/name in buf. */
const char *bis_trade_path(char buf[4096], const bis_trade *t, const char *name);

/* bis_trade_write writes a file of the folder: what put prints. Errors: BIS_IO, BIS_NOMEM. */
typedef void bis_trade_put(FILE *out, const bis_trade *t);
bis_status bis_trade_write(const bis_trade *t, const char *name, bis_trade_put *put, bis_diag *diag);

/* Make the folder. Is it new or empty, or, with --resume, one of ours? An empty one turns o.resume off. */
bis_status bis_trade_check_folder(bis_trade *t, bis_diag *diag);
bis_status bis_trade_make_folder(const bis_trade *t, const char *name, bis_diag *diag);
bis_status bis_trade_write_plan(bis_trade *t, bis_diag *diag);
bis_status bis_trade_read_plan(bis_trade *t, bis_diag *diag);
bis_status bis_trade_write_runs(const bis_trade *t, bis_diag *diag);
bis_status bis_trade_read_runs(bis_trade *t, bis_diag *diag);
/* bis_trade_find_run returns the run of these, or NULL. */
const bis_trade_run *bis_trade_find_run(const bis_trade *t, int setting, int level, int replicate);
bis_status bis_trade_add_run(bis_trade *t, const bis_trade_run *run, bis_diag *diag);

/* --- trade_reference.c --- */

/* Read what references/ holds, render what it lacks. Interrupted: is_ready stays false where replicates are missing. */
bis_status bis_trade_make_references(bis_trade *t, bis_diag *diag);

/* Of a given one, of the size of film `all`, the pixels that the thin film `some` of the same picture has. */
bis_status bis_trade_thin(bis_image *out, const bis_image *full, const bis_film *all, const bis_film *some,
                          bis_diag *diag);

/* --- trade_stats.c, trade_advice.c --- */

bis_status bis_trade_summarise(bis_trade *t, bis_diag *diag);

/* By interpolation between budgets in log-log; beyond the longest by the root law, *extrapolated; NAN below one pass or
 * for a biased setting beyond its measurements. */
double bis_trade_error_at(const bis_trade_result *r, const bis_trade_plan *plan, int setting, double seconds,
                          bool *extrapolated);
double bis_trade_seconds_to(const bis_trade_result *r, const bis_trade_plan *plan, int setting, double error,
                            bool *extrapolated);

/* The setting of an integrator with the least cost x variance, its standard error added; NULL: of all that are
 * unbiased. -1: none was measured. */
int bis_trade_best_of(const bis_trade *t, const char *integrator);
/* The best of each integrator and the scene's own, in the order of the table, those that were measured. Returns how
 * many. */
int bis_trade_heads(const bis_trade *t, int setting[BIS_TRADE_STRIP]);

/* bis_trade_is_head returns whether setting is one of bis_trade_heads. */
bool bis_trade_is_head(const bis_trade *t, int setting);

/* bis_trade_square_passes returns the least number of passes >= least, in [1, 1e9], that the scene's sampler uses
 * well. A stratified one divides the pixel into the most square grid of so many cells: n x n and n x (n + 1) are
 * good. 13 = 1 x 13 leaves twice the relMSE of 12 = 3 x 4 where a picture has many edges (tests/tools/test_trade.c). */
uint32_t bis_trade_square_passes(const bis_trade *t, double least);

void bis_trade_advise(bis_trade *t); /* seconds by the sweep's thin film */

/* Columns of the two tables: each at most so many, ascending; returns how many. */
enum { BIS_TRADE_COLUMNS = 6 };
int bis_trade_times(const bis_trade *t, double seconds[BIS_TRADE_COLUMNS]);
int bis_trade_errors(const bis_trade *t, double error[BIS_TRADE_COLUMNS]);

/* --- trade_tables.c --- */

bis_status bis_trade_write_tables(const bis_trade *t, bis_diag *diag);

/* bis_trade_next_on_front returns the point of the Pareto front that is next in time after last (NULL: the first), or
 * NULL. Of equal ones both come. */
const bis_trade_point *bis_trade_next_on_front(const bis_trade_result *r, const bis_trade_point *last);

/* --- trade_pictures.c --- */

/* Equal-time pictures of the best setting of each integrator: read from pictures/ or rendered. */
bis_status bis_trade_make_pictures(bis_trade *t, bis_diag *diag);

/* --- trade_check.c --- */

/* Replaces the advice's passes and errors by such as were measured with that many passes, as far as there is time. */
bis_status bis_trade_check_advice(bis_trade *t, bis_diag *diag);

/* bis_trade_scatter returns the relMSE of one of n >= 2 renders that differ in their seeds alone: in each pixel and
 * channel their variance (over n - 1), divided by b^2 + m^2/100 as in bis_compare. b is the mean of the reference and
 * of the renders, weighted by 1/variance; with relmse = 0 the reference alone. m is the mean of b. The `spared` pixels
 * of the largest errors count as 0. All have one size. What noise is left in b makes the result biased, by terms of the
 * order of b's own relMSE. */
enum { BIS_TRADE_MOST_SPARED = 5 };
double bis_trade_scatter(const bis_image *images, int n, int spared, const bis_trade_reference *reference);

/* --- trade_seconds.c --- */

/* Replaces the advice's seconds, which are the sweep's times the pixels, by better ones. */
bis_status bis_trade_time_advice(bis_trade *t, bis_diag *diag);

/* An earlier advice takes the same setting: seconds from that one's, as many for each pass. False: there is none. */
bool bis_trade_take_known_seconds(bis_trade_advice *all, int i);

/* --- trade_page.c; its parts are in trade_page.h --- */

bis_status bis_trade_write_report(const bis_trade *t, bis_diag *diag);

/* bis_trade_print_summary prints what a user wants to know at once: the advice in short, and where the page is. */
void bis_trade_print_summary(FILE *out, const bis_trade *t);

/* --- trade_strips.c --- */

/* bis_trade_exposure sets *exposure to that of all pictures of the page: what `bis render` gives a PNG of the
 * reference, metered on the shapes and not on the background. t: loaded, with t->both. Errors: BIS_NOMEM. */
bis_status bis_trade_exposure(double *exposure, const bis_trade *t, bis_diag *diag);
