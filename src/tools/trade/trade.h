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
    bool is_reported;     /* true once tables and page agree with runs */
} bis_trade;

/* bis_trade_measure makes the whole measurement, into o->folder. t is zero-initialised, and to be cleared by
 * bis_trade_clear. *interrupted: by the signal flag, with what was measured written. Errors: BIS_INPUT (scene, budget,
 * reference, folder), BIS_IO, BIS_NOMEM. */
bis_status bis_trade_measure(bis_trade *t, const bis_trade_options *o, bool *interrupted, bis_diag *diag);
void bis_trade_clear(bis_trade *t);

/* bis_trade_seed returns the seed of a render: other purposes and places have others; 53 bits, as --seed takes. */
static inline uint64_t bis_trade_seed(const bis_trade_plan *plan, unsigned purpose, uint64_t place)
{
    return bis_hash(bis_hash(plan->seed + purpose) + place) >> 11;
}

/* bis_trade_channel returns channel k of a colour. */
static inline double bis_trade_channel(rgb c, int k) { return (double)(k == 0 ? c.r : k == 1 ? c.g : c.b); }
