/* SPDX-License-Identifier: BSD-2-Clause */
/* cmd_trade: `bis trade SCENE`: measure error against time for several estimators, into a folder with tables and a page
 * (trade.h).
 *
 * Ctrl-C (SIGTERM, SIGHUP) abandons the render under way; what was measured is written, tables and page included, and
 * the exit status is 130. A second one kills, and loses a second of measurements at most. */
#include "tools/trade/trade_page.h"
#include "tools/trade/trade_plan.h"
#include "tools/trade/trade_settings.h"

#include "base/text.h"
#include "bis/base/file.h"
#include "bis/base/mem.h"

#include "cli.h"

#include <string.h>
#include <unistd.h>

enum { MAX_INTEGRATORS = 16, DEFAULT_SECONDS = 150, QUICK_SECONDS = 28 };

typedef struct trade_options {
    const char *output, *reference;
    bis_texts integrators;
    bool quick, resume, quiet, approximate;
    bool has_seconds, has_seed, has_seeds, has_passes;
    bool has_size;
    double seconds, error;
    uint64_t seed, seeds, passes, threads;
    int size[2];
} trade_options;

/* ---- what is asked ---- */

/* The plan of a measurement stays as it is. */
static bis_status check_resume(const trade_options *o, bis_diag *diag)
{
    static const char why[] = "--resume goes on by the plan in the folder, which %s would change; leave it out, or "
                              "measure into another folder";
    const struct {
        bool given;
        const char *name;
    } of_plan[] = {{o->quick, "--quick"}, {o->has_seeds, "--seeds"}, {o->has_passes, "--passes"},
                   {o->has_seed, "--seed"}, {o->has_size, "--resolution"}, {o->reference != NULL, "--reference"},
                   {o->integrators.n > 0, "--integrator"}};
    for (size_t i = 0; i < sizeof of_plan / sizeof *of_plan && o->resume; i++)
        if (of_plan[i].given) return bis_error(diag, BIS_INPUT, bis_cli_loc, why, of_plan[i].name);
    return BIS_OK;
}

static bis_status check_integrators(const trade_options *o, bis_diag *diag)
{
    const char *names[32];
    char list[256] = "", hint[BIS_HINT];
    bis_status status = BIS_OK;
    size_t n = 0;

    for (const bis_integrator *const *i = bis_integrators; *i; i++)
        if (bis_trade_is_rival(*i)) names[n++] = (*i)->name;
    for (size_t i = 0; i < n; i++)
        bis_append(list, sizeof list, "%s%s", i == 0 ? "" : i + 1 < n ? ", " : " or ", names[i]);
    for (int i = 0; i < o->integrators.n; i++) {
        const bis_integrator *known = bis_integrator_find(o->integrators.text[i]);
        if (known && bis_trade_is_rival(known)) continue;
        status = bis_error(diag, BIS_INPUT, bis_cli_loc, "--integrator %s: must be %s%s", o->integrators.text[i], list,
                           bis_hint(hint, bis_nearest_name(o->integrators.text[i], names, n)));
    }
    return status;
}

/* "a/b/scene.txt": "scene-trade". */
static char *default_folder(const char *scene)
{
    const char *slash = strrchr(scene, '/'), *name = slash ? slash + 1 : scene, *dot = strrchr(name, '.');
    const size_t n = dot && dot > name ? (size_t)(dot - name) : strlen(name), size = n + sizeof "-trade";
    char *folder = bis_alloc(size, 1);
    if (folder) snprintf(folder, size, "%.*s-trade", (int)n, name);
    return folder;
}

/* ---- the command ---- */

static void print_progress(const char *what, double share, double seconds_left, void *user)
{
    char left[24];
    (void)user;
    fprintf(stderr, "\r%s", what);
    if (share >= 0) fprintf(stderr, ", %.0f%%", 100 * share);
    if (isfinite(seconds_left)) fprintf(stderr, ", %s left", bis_duration(left, seconds_left));
    fputs("   \033[K", stderr);
}

static int run(const trade_options *o, const char *scene, const char *folder, bis_diag *diag)
{
    const bool show = !o->quiet && isatty(STDERR_FILENO);
    const bis_trade_options options = {
        .scene = scene,
        .folder = folder,
        .reference = o->reference,
        .seconds = o->has_seconds ? o->seconds : o->quick ? QUICK_SECONDS : DEFAULT_SECONDS,
        .error = o->error,
        .quick = o->quick,
        .resume = o->resume,
        .approximate = o->approximate,
        .width = o->size[0],
        .height = o->size[1],
        .n_seeds = (int)o->seeds,
        .passes = (uint32_t)o->passes,
        .seed = o->has_seed ? o->seed : 1,
        .n_threads = (int)o->threads,
        .integrators = o->integrators.text,
        .n_integrators = o->integrators.n,
        .interrupted = &bis_cli_signal,
        .progress = show ? print_progress : NULL,
    };
    bis_trade t = {.n_runs = 0};
    bool interrupted;

    bis_cli_catch_signals();
    const bis_status status = bis_trade_measure(&t, &options, &interrupted, diag);
    if (show) fputs("\r\033[K", stderr);
    if (t.nonfinite)
        bis_warn(diag, bis_cli_loc, "%llu estimates were not finite and count as black (docs/envelope.md)",
                 (unsigned long long)t.nonfinite);
    if (t.is_reported) bis_trade_print_summary(stdout, &t);
    if (!status && !t.is_reported && t.n_runs)
        bis_warn(diag, bis_cli_loc,
                 "interrupted before anything new was measured: %s is as it was, with %zu of %zu runs", folder,
                 t.n_runs, bis_trade_planned_runs(&t.plan));
    if (!status && !t.is_reported && !t.n_runs)
        bis_warn(diag, bis_cli_loc, "interrupted before the first run: there is no table and no page");
    bis_trade_clear(&t);
    const int exit_status = bis_cli_exit_status(status);
    return interrupted && !exit_status ? BIS_EXIT_INTERRUPTED : exit_status;
}

static int measure(void *options, const char *const *operands, bis_diag *diag)
{
    const trade_options *o = options;

    bis_cli_use_threads(o->threads);
    char *folder = o->output ? bis_strdup(o->output) : default_folder(operands[0]);
    bis_status status = folder ? check_resume(o, diag) : bis_error(diag, BIS_NOMEM, bis_cli_loc, "no memory");
    if (!status) status = check_integrators(o, diag);
    if (!status && strcmp(operands[0], "-") == 0)
        status = bis_error(diag, BIS_INPUT, bis_cli_loc,
                           "bis trade reads the scene again with --resume: give a file, not -");
    const int exit_status = status ? bis_cli_exit_status(status) : run(o, operands[0], folder, diag);
    bis_free(folder);
    return exit_status;
}

int bis_cmd_trade(int argc, char **argv)
{
    trade_options o = {0};
    const bis_option options[] = {
        {.help = "what is written"},
        {.name = "output", .argument = "DIR",
         .help = "folder for tables, pictures and report.html (default: the scene's name with -trade, in the working "
                 "folder); new, empty, or with --resume", .kind = BIS_OPTION_TEXT, .value = &o.output},
        {.name = "resume", .help = "go on with the measurement in the folder, by its plan", .kind = BIS_OPTION_FLAG,
         .value = &o.resume},
        {.name = "quiet", .help = "no progress and no warnings", .kind = BIS_OPTION_FLAG, .value = &o.quiet},
        {.help = "how long"},
        {.name = "time", .argument = "SECONDS", .help = "for everything (150); size, passes and seeds follow from "
            "it", .kind = BIS_OPTION_SECONDS, .value = &o.seconds,
         .given = &o.has_seconds, .above = true, .hi = 1e7},
        {.name = "quick", .help = "a shorter table of settings, in 30 s", .kind = BIS_OPTION_FLAG, .value = &o.quick},
        {.name = "error", .argument = "E",
         .help = "the relative RMSE of a final picture (0.05): measure until there; an error right after the pilot "
                 "where that is out of reach", .kind = BIS_OPTION_SHARE, .value = &o.error, .above = true,
         .hi = 10},
        {.name = "seeds", .argument = "N", .help = "renders of each setting and budget (2, 3 or 5, by the time)",
         .kind = BIS_OPTION_COUNT, .value = &o.seeds, .given = &o.has_seeds, .lo = 1, .hi = BIS_TRADE_SEEDS},
        {.name = "passes", .argument = "N",
         .help = "budgets of 1, 2, 4 ... up to N passes for every setting, instead of what the time allows",
         .kind = BIS_OPTION_COUNT, .value = &o.passes, .given = &o.has_passes, .lo = 1,
         .hi = 1 << (BIS_TRADE_LEVELS - 1)},
        {.help = "what is measured"},
        {.name = "integrator", .argument = "NAME", .help = "em, brdf, mis, rejection or sir alone; may be repeated",
         .kind = BIS_OPTION_LIST, .value = &o.integrators},
        {.name = "reference", .argument = "F",
         .help = "compare with this picture (.exr, .pfm, .hdr) of the scene's size, instead of rendering references",
         .kind = BIS_OPTION_TEXT, .value = &o.reference},
        {.name = "approximate",
         .help = "what of pbrt bis does not model is replaced by the nearest that it does, and listed",
         .kind = BIS_OPTION_FLAG, .value = &o.approximate},
        {.name = "resolution", .argument = "WxH",
         .help = "size of the full picture; measured is a smaller one of the same view", .kind = BIS_OPTION_OWN,
         .value = o.size, .given = &o.has_size, 
         .read = bis_cli_read_size, .rule = BIS_SIZE_RULE},
        {.name = "seed", .argument = "N", .help = "other random numbers (1)", .kind = BIS_OPTION_COUNT,
         .value = &o.seed, .given = &o.has_seed, .hi = BIS_SEED_MAX},
        {.name = "nthreads", .argument = "N", .help = "threads (default: one for each processor)",
         .kind = BIS_OPTION_COUNT, .value = &o.threads, .lo = 1, .hi = 1024},
    };
    const bis_command command = {
        .name = "trade",
        .usage = "trade [options] SCENE",
        .summary = "measure error against time for several estimators",
        .options = options, .n_options = sizeof options / sizeof *options,
        .min_operands = 1, .max_operands = 1,
        .notes = "Ctrl-C ends it with what was measured; --resume goes on.\n"
                 "Exit status: 0 done; 1 could not read or write, or out of memory; 2 bad usage or\n"
                 "bad scene, or what cannot be done in the time; 130 interrupted.\n",
    };
    return bis_cli_run(&command, argc, argv, measure, &o);
}
