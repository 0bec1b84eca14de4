/* SPDX-License-Identifier: BSD-2-Clause */
/* cmd_render: `bis [render] [options] SCENE`: parse, override, plan or build, render, write, report.
 *
 * Whatever can be known to fail is tried before the rendering: options, the endings and folders of the output files,
 * the scene. Ctrl-C (and SIGTERM, SIGHUP) during the rendering ends it soon; what is done is written, if there is
 * anything, and the exit status is 130. A second one kills.
 *
 * A checkpoint is read before the scene is built, because a damaged one should not be found after minutes of loading;
 * whether it belongs to the scene is known after that. */
#include "base/text.h"
#include "bis/base/clock.h"

#include "help.h"
#include "override.h"
#include "progress.h"
#include "render/checkpoint.h"
#include "render/ranks.h"
#include "render_part.h"
#include "tools/memory.h"

#include <assert.h>
#include <string.h>
#include <unistd.h>

/* What the command line says, and the state of the command. */
typedef struct render_options {
    bis_render_files files;
    bis_override over;
    bis_film *film;
    const bis_scene *scene;
    const bis_scene_desc *desc;
    bool quiet, plan, approximate, has_every;
    double seconds, error, every, write_every;
    bis_render_part part;
    bool agreed; /* all ranks have */
    double start; /* of the command, on bis_clock_now's clock */
} render_options;

static void show_progress(const bis_progress *p, void *user)
{
    char text[BIS_PROGRESS_TEXT];
    (void)user;
    fprintf(stderr, "\r%s   \033[K", bis_progress_text(text, p));
    fflush(stderr);
}

/* --write-every: the pictures of the passes so far. That one of them cannot be written stops nothing. */
static void write_so_far(const bis_render_result *result, void *user)
{
    const render_options *o = user;
    bis_texts written = {.n = 0};
    bis_diag diag = {0};
    double exposure;
    const bis_stats stats = bis_stats_of(o->desc, bis_scene_figures_of(o->scene), o->scene->seconds, o->film, result);

    if (bis_render_files_write_pictures(&written, &exposure, &o->files, &stats, &diag) && !o->quiet)
        fprintf(stderr, "%sbis: warning: --write-every wrote nothing, the render goes on\n",
                isatty(STDERR_FILENO) ? "\r\033[K" : "");
    if (!o->quiet) bis_cli_print_diag(&diag, false);
    bis_diag_clear(&diag);
}

/* Said early, after the first passes, so that nobody waits for what cannot come: an error that another budget will cut
 * off, or that takes over ten minutes. */
static void print_forecast(const bis_forecast *f, void *user)
{
    const render_options *o = user;
    const double late = 600;
    char time[32], error[BIS_PERCENT];
    const char *end = "Ctrl-C ends it earlier and writes what is done";

    if (o->seconds > 0 && f->seconds > o->seconds) end = "--time ends it before";
    else if (o->over.spp && f->spp > (double)o->over.spp) end = "--spp ends it before";
    else if (!(f->seconds > late)) return;
    fprintf(stderr,
            "%sbis: warning: --error %g would take about %s and %.3g camera samples a pixel; %s (the error is at most "
            "%s so far)\n",
            isatty(STDERR_FILENO) ? "\r\033[K" : "", o->error, bis_duration(time, f->seconds), f->spp, end,
            bis_percent_above(error, f->error));
}

static void warn_of_checkpoint(const char *message)
{
    fprintf(stderr, "%sbis: warning: no checkpoint was written, the render goes on: %s\n",
            isatty(STDERR_FILENO) ? "\r\033[K" : "", message);
}

/* What --checkpoint and --resume ask for; of the file, if there is one, all but the state is read. */
static bis_status open_checkpoint(bis_checkpoint *c, const render_options *o, bis_diag *diag)
{
    const char *resume = o->files.resume;

    *c = (bis_checkpoint){
        .path = o->files.checkpoint, .every = o->every, .warn = o->quiet ? NULL : warn_of_checkpoint};
    if (o->has_every && !c->path) bis_warn(diag, bis_cli_loc, "--checkpoint-every has no effect without --checkpoint");
    if (o->write_every > 0 && o->part.share.n)
        bis_warn(diag, bis_cli_loc, "--write-every has no effect with --part, whose file is no picture");
    if (!resume || !bis_rank_leads(bis_cli_ranks)) return BIS_OK;
    if (access(resume, F_OK) == 0) return bis_checkpoint_read(c, resume, diag);
    if (!o->quiet) fprintf(stderr, "bis: note: there is no \"%s\" yet: the render starts afresh\n", resume);
    return BIS_OK;
}

/* o has film, scene and desc. */
static bis_status render(bis_render_result *result, bis_checkpoint *checkpoint, render_options *o, bis_diag *diag)
{
    bis_film *film = o->film;
    const bis_scene_desc *desc = o->desc;
    const bool leads = bis_rank_leads(bis_cli_ranks);
    bis_status status = BIS_OK;
    bool show = leads && !o->quiet && isatty(STDERR_FILENO);
    bis_render_options options = {
        .budget = {.spp = (uint32_t)o->over.spp, .seconds = o->seconds, .error = o->error},
        .n_threads = (int)o->over.threads,
        .interrupted = &bis_cli_signal,
        .progress = show ? show_progress : NULL,
        .forecast = o->quiet ? NULL : print_forecast,
        .user = o,
        .part = o->part.share,
        .ranks = bis_cli_ranks,
    };
    bis_cli_catch_signals();
    /* without one, nothing is hashed */
    if (leads && (checkpoint->path || o->part.share.n)) options.checkpoint = checkpoint;
    options.first_light = !options.checkpoint && !bis_cli_ranks;
    options.so_far = leads && o->write_every > 0 && !o->part.share.n ? write_so_far : NULL;
    options.every = o->write_every;
    if (!status) status = bis_render(result, film, o->scene, &desc->view, &options, diag);
    if (show) fputs("\r\033[K", stderr);
    fflush(stderr);
    char text[BIS_PERCENT];
    if (!status && leads && o->error > 0 && !(result->error.is_bounded && result->error.upper <= o->error)) {
        if (!result->error.is_bounded)
            bis_warn(diag, bis_cli_loc, "--error %g was not reached: the error is unknown after %u pass%s, because %s",
                     o->error, result->passes, result->passes == 1 ? "" : "es",
                     bis_render_files_why_unknown(&result->error));
        else
            bis_warn(diag, bis_cli_loc, "--error %g was not reached: the error is at most %s after %u passes",
                     o->error, bis_percent_above(text, result->error.upper), result->passes);
    }
    if (!status) bis_render_files_warn_of_counts(&result->counters, diag);
    if (!status && result->passes && leads && desc->has_light && !o->part.share.n)
        bis_render_files_warn_of_black(film, o->scene, &desc->view.camera, diag);
    return status;
}

/* A render that does not fit is slow, or the system ends it. */
static bis_status warn_of_memory(const bis_scene_desc *desc, bis_diag *diag)
{
    const double room = bis_memory_free();
    char less[BIS_MEMORY_ADVICE];
    bis_memory m;
    bis_status status = bis_memory_foresee(&m, desc, diag);

    if (status || !(room > 0) || m.peak <= room) return status;
    status = bis_memory_advise(less, &m, desc, room, diag);
    if (!status)
        bis_warn(diag, bis_cli_loc,
                 "this render takes about %.1f GB, but %.1f GB of memory are free: it will be slow, or the system will "
                 "end it. %s%s", m.peak / 1e9, room / 1e9,
                 *less ? "Less is taken by " : "Only a smaller map or mesh takes less", less);
    return status;
}

/* A map was resampled: by how much did its energy change? */
static void note_resampling(const bis_light *light)
{
    const bis_envmap *em = bis_light_envmap(light);
    if (!em || !(em->power_before > 0)) return;
    fprintf(stderr, "bis: note: %s map resampled to %d x %d; integral of r+g+b %g before, %g after (%+.3f%%)\n",
            em->resampled_from, em->width, em->height, em->power_before, em->power_after,
            100 * (em->power_after / em->power_before - 1));
}

/* Time was over in the first pass: which part of the picture has no camera sample of its own? */
static void warn_of_missing(const render_options *o, const bis_render_result *result, bis_diag *diag)
{
    char text[BIS_PERCENT];
    if (result->missing > 0 && !result->interrupted && !o->quiet)
        bis_warn(diag, bis_cli_loc, "--time %g was over in the first pass: %s of the pixels have no camera sample and "
                 "show a neighbour's colour", o->seconds, bis_percent(text, result->missing));
}

/* From scene to files; *interrupted: a signal came. */
static bis_status run(render_options *o, bis_scene_desc *desc, double parse_seconds, bool *interrupted,
                      bis_diag *diag)
{
    bis_scene *scene = NULL;
    bis_film film = {0};
    bis_render_result result;
    bis_texts written = {.n = 0};
    bis_checkpoint checkpoint;
    bis_status status = open_checkpoint(&checkpoint, o, diag);

    if (status) goto done;
    status = warn_of_memory(desc, diag);
    if (status) goto done;
    bis_cli_print_diag(diag, o->quiet); /* before anything is loaded */
    bis_diag_clear(diag);
    status =
        bis_film_init(&film, desc->view.film.width, desc->view.film.height, desc->view.film.crop, bis_cli_loc, diag);
    if (!status) status = bis_film_want(&film, desc->view.film.layers, diag);
    if (status) goto done;
    film.transparent = !desc->light.visible;
    status = bis_scene_build(&scene, desc, diag);
    if (status) goto done;
    bis_cli_print_diag(diag, o->quiet); /* warnings, before the wait */
    bis_diag_clear(diag);
    if (!o->quiet) note_resampling(scene->light);
    o->agreed = true;
    status = bis_ranks_agree(bis_cli_ranks, BIS_OK, diag);
    if (status) goto done;
    o->film = &film;
    o->scene = scene;
    o->desc = desc;
    status = render(&result, &checkpoint, o, diag);
    if (status || !bis_rank_leads(bis_cli_ranks)) goto done;
    *interrupted = bis_cli_signal;
    warn_of_missing(o, &result, diag);
    /* an older picture is worth more than a black one; said also when quiet, as an error is */
    if (result.passes == 0) {
        fputs("bis: interrupted before the first pass was complete: nothing was written\n", stderr);
        goto done;
    }

    bis_stats stats = bis_stats_of(desc, bis_scene_figures_of(scene), scene->seconds, &film, &result);
    stats.extent = bis_geometry_primitives(&scene->geometry) > 0 ? &scene->geometry.box : NULL;
    stats.seconds.parse = parse_seconds;
    double before = bis_clock_now(), exposure = NAN;
    status = o->part.share.n ? bis_render_part_write(&o->part, &o->files, &checkpoint, &film, &stats, o->quiet, diag)
                             : bis_render_files_write_pictures(&written, &exposure, &o->files, &stats, diag);
    stats.seconds.write = bis_clock_now() - before;
    stats.seconds.total = bis_clock_now() - o->start;
    const bis_status other = bis_render_files_write_stats(&o->files, &stats, diag);
    if (!status) status = other;
    if (checkpoint.failed)
        status = bis_error(diag, BIS_IO, bis_cli_loc, "the last checkpoint could not be written to \"%s\"",
                           checkpoint.path);
    *interrupted = bis_cli_signal;
    if (!o->quiet && written.n) bis_render_files_print_result(&written, exposure, &stats);
done:
    bis_checkpoint_clear(&checkpoint);
    bis_film_clear(&film);
    bis_scene_free(scene);
    return status;
}

/* `bis --as-printed list` needs no scene. */
static bool asks_for_errata(int argc, char **argv)
{
    for (int i = 0; i < argc && strcmp(argv[i], "--") != 0; i++) {
        if (strcmp(argv[i], "--as-printed=list") == 0) return true;
        if (strcmp(argv[i], "--as-printed") == 0 && i + 1 < argc && strcmp(argv[i + 1], "list") == 0) return true;
    }
    return false;
}

static void list_errata(void)
{
    for (const bis_erratum *e = bis_errata; e->name; e++)
        printf("%-4s thesis %s; integrators: %s\n     %s\n", e->name, e->section, e->integrators, e->effect);
}

static int render_scene(void *options, const char *const *operands, bis_diag *diag)
{
    render_options *o = options;
    bis_scene_desc *desc = NULL;
    bool interrupted = false;

    if (!o->files.checkpoint) o->files.checkpoint = o->files.resume;
    const bool leads = bis_rank_leads(bis_cli_ranks);
    const unsigned approximate = o->approximate ? BIS_PARSE_APPROXIMATE | (o->plan ? BIS_PARSE_LIST_MISSING : 0) : 0;
    const unsigned how = approximate | (o->over.light ? BIS_PARSE_OTHER_LIGHT : 0);
    bis_status status = o->plan ? BIS_OK : bis_render_part_name(o->part.share, &o->files, diag);
    if (!status && leads) status = bis_render_files_check(&o->files, diag);
    if (!status) status = bis_cli_parse_scene(&desc, operands[0], how, diag);
    if (!status) status = bis_override_scene(desc, &o->over, diag);
    const bis_budget budget = {.seconds = o->seconds, .error = o->error};
    if (!status) status = bis_render_part_check(o->part.share, &budget, diag);
    const double parse_seconds = bis_clock_now() - o->start;
    if (status) goto done;
    if (o->plan) {
        bis_scene_plan(desc, stdout);
        status = warn_of_memory(desc, diag);
        if (!status) status = bis_scene_check_files(desc, diag);
        goto done;
    }
    if (o->files.pictures.n == 0 && !o->files.part && leads) {
        o->files.pictures.text[o->files.pictures.n++] = desc->outfile;
        status = bis_render_files_check(&o->files, diag);
    }
    if (!status && leads) status = bis_render_files_check_distinct(&o->files, desc, diag);
    if (o->over.transparent && leads) bis_render_files_warn_of_alpha(&o->files.pictures, diag);
    if (!status) status = run(o, desc, parse_seconds, &interrupted, diag);
done:
    if (!o->agreed) status = bis_ranks_agree(bis_cli_ranks, status, diag);
    bis_scene_desc_free(desc);
    const int exit_status = bis_cli_exit_status(status);
    return interrupted && !exit_status ? BIS_EXIT_INTERRUPTED : exit_status;
}

enum { MAX_INTEGRATORS = 16, MAX_OPTIONS = 56 };

/* The options, and the names and texts that they borrow. */
typedef struct option_table {
    bis_option options[MAX_OPTIONS];
    size_t n;
    const char *integrators[MAX_INTEGRATORS + 1];
    char layer_help[256], integrator_help[256];
} option_table;

static void list_names(option_table *t)
{
    snprintf(t->layer_help, sizeof t->layer_help, "what an EXR carries beside R, G, B, A: ");
    for (int i = 0; i < BIS_N_LAYERS; i++)
        bis_append(t->layer_help, sizeof t->layer_help, "%s%s", i == 0 ? "" : ", ", bis_layer_name((bis_layer)i));
    bis_append(t->layer_help, sizeof t->layer_help, "; all; none");
    for (int i = 0; bis_integrators[i] && i < MAX_INTEGRATORS; i++) {
        t->integrators[i] = bis_integrators[i]->name;
        bis_append(t->integrator_help, sizeof t->integrator_help, "%s%s",
                   i == 0 ? "" : bis_integrators[i + 1] ? ", " : " or ", t->integrators[i]);
    }
    bis_append(t->integrator_help, sizeof t->integrator_help, " (default: the scene's; see `bis help sir`)");
}

/* The table of --help. Values go to *o. The parameters of integrators stand in the middle. */
static void make_options(option_table *t, render_options *o)
{
    static const char *const accelerators[] = {"grid", "embree", NULL};

    *t = (option_table){.n = 0};
    list_names(t);

    const bis_option before[] = {
        {.help = "output"},
        {.name = "outfile", .argument = "F",
         .help = "write the picture to F, by its ending .exr, .pfm, .hdr or .png; may be repeated (default: the "
                 "filename of the scene's Film)", .kind = BIS_OPTION_LIST, .value = &o->files.pictures},
        {.name = "layers", .argument = "L,...",
         .help = t->layer_help, .kind = BIS_OPTION_TEXT, .value = &o->over.layers},
        {.name = "stats", .argument = "F", .help = "write figures about the run to F as JSON; \"-\": standard output",
         .kind = BIS_OPTION_TEXT, .value = &o->files.stats},
        {.name = "exposure", .argument = "EV",
         .help = "PNG: multiply radiance by 2^EV (default: from the picture's log-average)", .kind = BIS_OPTION_REAL,
         .value = &o->files.exposure, .given = &o->files.has_exposure, .lo = -100, .hi = 100},
        {.name = "write-every", .argument = "SECONDS",
         .help = "write the picture of the passes so far to its files at intervals, looked at between passes, so that "
                 "any viewer can look", .kind = BIS_OPTION_SECONDS, .value = &o->write_every, .above = true, .hi = 1e8},
        {.name = "quiet", .help = "no progress, no warnings, no line about what was written", .kind = BIS_OPTION_FLAG,
         .value = &o->quiet},
        {.name = "plan", .help = "print what the scene requires and what will be built for it; render nothing",
         .kind = BIS_OPTION_FLAG, .value = &o->plan},
        {.name = "approximate",
         .help = "what of pbrt bis does not model is replaced by the nearest that it does, and listed; with --plan, "
                 "meshes and maps may be missing, and are listed", .kind = BIS_OPTION_FLAG, .value = &o->approximate},

        {.help = "what to render (these override the scene file)"},
        {.name = "light", .argument = "MAP",
         .help = "the environment map MAP in place of all lights of the scene, upright: its top is where the scene's "
                 "own map has it, else the axis nearest to the camera's \"up\"",
         .kind = BIS_OPTION_TEXT, .value = &o->over.light},
        {.name = "light-rotate", .argument = "DEGREES", .help = "turn that map about its vertical axis",
         .kind = BIS_OPTION_REAL, .value = &o->over.light_rotate, .given = &o->over.has_light_rotate, .lo = -360,
         .hi = 360},
        {.name = "light-mapping", .argument = "M", .help = "how that map covers the sphere (latlong; equalarea for a "
         "square): see `bis help lights`", .kind = BIS_OPTION_NAME, .value = &o->over.light_mapping,
         .names = bis_mapping_names},
        {.name = "light-scale", .argument = "S", .help = "multiply that map by S", .kind = BIS_OPTION_REAL,
         .value = &o->over.light_scale, .given = &o->over.has_light_scale, .above = true, .hi = 1e30},
        {.name = "transparent", .help = "the camera sees no light behind the shapes, which still receive it: alpha in "
         "an .exr or .png tells what covers a pixel", .kind = BIS_OPTION_FLAG, .value = &o->over.transparent},
        {.name = "integrator", .argument = "NAME",
         .help = t->integrator_help, .kind = BIS_OPTION_NAME, .value = &o->over.integrator, .names = t->integrators,
         .rule = ". Without it the default renders; `bis trade SCENE` recommends settings"},
    };
    const bis_option behind[] = {
        {.name = "seed", .argument = "N", .help = "another seed, other noise", .kind = BIS_OPTION_COUNT,
         .value = &o->over.seed, .given = &o->over.has_seed, .hi = BIS_SEED_MAX},
        {.name = "accelerator", .argument = "A", .help = "grid or embree", .kind = BIS_OPTION_NAME,
         .value = &o->over.accelerator, .names = accelerators},
        {.name = "resolution", .argument = "WxH", .help = "size of the full picture in pixels", .kind = BIS_OPTION_OWN,
         .value = o->over.resolution, .given = &o->over.has_resolution, .read = bis_cli_read_size,
         .rule = BIS_SIZE_RULE},
        {.name = "cropwindow", .argument = "x0,x1,y0,y1",
         .help = "render this part alone, in shares of the full picture; pixels are the same as those of the full "
                 "picture. An EXR keeps the full display window, other formats hold the crop", .kind = BIS_OPTION_OWN,
         .value = o->over.crop, .given = &o->over.has_crop, .read = bis_override_read_crop,
         .rule = "x0,x1,y0,y1 in [0, 1] with x0 < x1 and y0 < y1, as in 0.25,0.75,0,1"},
        {.name = "as-printed", .argument = "E",
         .help = "follow the thesis to the letter where docs/errata.md departs from it, as in E6: a wrong picture, to "
                 "see why; may be repeated; \"list\" prints all", .kind = BIS_OPTION_LIST,
         .value = &o->over.as_printed},
        {.name = "disable-pixel-jitter", .help = "camera rays through pixel centres", .kind = BIS_OPTION_FLAG,
         .value = &o->over.no_jitter},
        {.name = "nthreads", .argument = "N",
         .help = "threads (default: one for each processor); pictures do not depend on it",
         /* where the system gives fewer, OpenMP's runtime says so and exits with 1: it has no way to ask */
         .kind = BIS_OPTION_COUNT, .value = &o->over.threads, .lo = 1, .hi = 1024},

        {.help = "how long (whichever comes first; default: the scene's pixelsamples)"},
        {.name = "spp", .argument = "N", .help = "camera samples in each pixel", .kind = BIS_OPTION_COUNT,
         .value = &o->over.spp, .given = &o->over.has_spp, .lo = 1, .hi = 1e9},
        {.name = "time", .argument = "SECONDS", .help = "seconds of rendering, loading and building not counted; "
            "ends within one pass; also 10s, 2min, 1.5h",
         .kind = BIS_OPTION_SECONDS, .value = &o->seconds, .above = true, .hi = 1e8},
        {.name = "error", .argument = "E", .help = "until an upper 95% bound of the relative RMSE is at most E, as "
            "in 0.05 or 5%",
         .kind = BIS_OPTION_SHARE, .value = &o->error, .above = true, .hi = 10},

        {.help = "a render in several runs (the picture has the bits of one run)"},
        {.name = "checkpoint", .argument = "F",
         .help = "keep the state of the render in F: at intervals, at the end, at Ctrl-C and SIGTERM",
         .kind = BIS_OPTION_TEXT, .value = &o->files.checkpoint},
        {.name = "checkpoint-every", .argument = "SECONDS",
         .help = "the interval, looked at between passes; 0: after each pass (default: 60)",
         .kind = BIS_OPTION_SECONDS, .value = &o->every, .given = &o->has_every, .hi = 1e8},
        {.name = "resume", .argument = "F",
         .help = "go on from the checkpoint F, or start afresh where there is no such file; --spp, --time and --error "
                 "count from the very start and may be more than before. Without --checkpoint, F is written as well",
         .kind = BIS_OPTION_TEXT, .value = &o->files.resume},

        {.help = "a render on several machines (the picture has the bits of one run)"},
        {.name = "part", .argument = "K/N",
         .help = "render the K-th of N shares of the picture's tiles into --outfile F.bispart; `bis merge` makes the "
                 "picture of them. Not with --time or --error, which need the whole picture",
         .kind = BIS_OPTION_OWN, .value = &o->part.share, .read = bis_render_part_read,
         .rule = "K/N with K from 1 to N, as in 2/5"},
    };
    memcpy(t->options, before, sizeof before);
    t->n = sizeof before / sizeof *before;
    bis_parameter_options(t->options, &t->n, o->over.parameters);
    assert(t->n + sizeof behind / sizeof *behind <= MAX_OPTIONS);
    memcpy(t->options + t->n, behind, sizeof behind);
    t->n += sizeof behind / sizeof *behind;
}

bis_help_entry bis_render_option(char term[BIS_CLI_TERM], const char *name)
{
    render_options o = {.every = 0};
    option_table t;
    const bis_option *option = t.options;

    make_options(&t, &o);
    for (; !option->name || strcmp(option->name, name) != 0; option++) assert(option < t.options + t.n);
    return (bis_help_entry){bis_cli_term(term, option), option->help};
}

int bis_cmd_render(int argc, char **argv)
{
    render_options o = {.every = 60, .start = bis_clock_now()};
    option_table table;

    bis_render_part_keep_command(o.part.command, argc, argv);
    if (asks_for_errata(argc, argv)) {
        list_errata();
        return bis_cli_finish(BIS_EXIT_DONE);
    }
    make_options(&table, &o);
    const bis_command command = {
        .name = "render",
        .usage = "[render] [options] SCENE",
        .summary = "render a scene",
        .options = table.options,
        .n_options = table.n,
        .min_operands = 1, .max_operands = 1,
        .notes = BIS_CLI_SCENE_NOTE
                 "\n"
                 "Exit status: 0 done; 1 could not read or write, or out of memory; 2 bad usage or\n"
                 "bad scene; 130 interrupted, after what is done has been written.\n",
    };
    return bis_cli_run(&command, argc, argv, render_scene, &o);
}
