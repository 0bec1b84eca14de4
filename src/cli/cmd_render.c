/* cmd_render: `bis [render] [options] SCENE`: parse, override, plan or build, render, write, report.
 *
 * Whatever can be known to fail is tried before the rendering: options, the endings and folders of the output files,
 * the scene. Ctrl-C (and SIGTERM, SIGHUP) during the rendering ends it soon; the complete passes are written, if there
 * are any, and the exit status is 130. A second one kills.
 *
 * A checkpoint is read before the scene is built, because a damaged one should not be found after minutes of loading;
 * whether it belongs to the scene is known after that. */
#include "base/text.h"
#include "bis/base/clock.h"
#include "bis/base/file.h"
#include "bis/base/mem.h"

#include "display.h"
#include "parameters.h"
#include "progress.h"
#include "render/checkpoint.h"
#include "render/crew.h"
#include "render/part.h"
#include "render_files.h"
#include "tools/memory.h"

#include <assert.h>
#include <float.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* What the command line says; has_ tells whether it does. */
typedef struct render_options {
    bis_render_files files;
    bis_texts as_printed;
    const char *integrator, *accelerator, *layers;
    const char *viewer; /* HOST:PORT */
    bis_display *display;
    const bis_film *film; /* what display shows */
    bool shows_progress;
    bis_parameter_option parameters[BIS_PARAMETER_OPTIONS];
    bool quiet, plan, no_jitter, adaptive, approximate;
    bool has_spp, has_seed, has_resolution, has_crop, has_every;
    uint64_t spp, seed, threads;
    int resolution[2];
    double crop[4];
    double seconds, error, every;
    bis_part part;
    char command[BIS_PART_COMMAND]; /* see keep_command */
    bool agreed; /* the crew has */
    double start; /* of the command, on bis_clock_now's clock */
} render_options;

/* ---- options ---- */

/* "0.25,0.75,0,1": x0 < x1 and y0 < y1, all in [0,1]. */
static bool read_crop(void *value, const char *text)
{
    double crop[4];
    for (int i = 0; i < 4; i++) {
        const char *end;
        crop[i] = bis_parse_double(text, &end);
        if (end == text || !(crop[i] >= 0 && crop[i] <= 1) || *end != (i < 3 ? ',' : '\0')) return false;
        text = end + 1;
    }
    if (crop[0] >= crop[1] || crop[2] >= crop[3]) return false;
    memcpy(value, crop, sizeof crop);
    return true;
}

/* "2/5": the second of five. */
static bool read_part(void *value, const char *text)
{
    int k, n;
    const char *rest = bis_cli_digits(text, 1, BIS_PART_MOST, &k);
    if (!rest || *rest != '/') return false;
    rest = bis_cli_digits(rest + 1, 1, BIS_PART_MOST, &n);
    if (!rest || *rest || k > n) return false;
    *(bis_part *)value = (bis_part){(uint32_t)k, (uint32_t)n};
    return true;
}

/* One argument, as a shell takes it. */
static void append_argument(char command[BIS_PART_COMMAND], const char *a)
{
    static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+./,:=@%";

    bis_append(command, BIS_PART_COMMAND, " ");
    if (*a && a[strspn(a, plain)] == '\0') {
        bis_append(command, BIS_PART_COMMAND, "%s", a);
        return;
    }
    bis_append(command, BIS_PART_COMMAND, "'");
    for (; *a; a++) bis_append(command, BIS_PART_COMMAND, *a == '\'' ? "'\\''" : "%c", *a);
    bis_append(command, BIS_PART_COMMAND, "'");
}

/* The command that makes the same part of a picture, or another one: all but --part and the files of one part. */
static void keep_command(char command[BIS_PART_COMMAND], int argc, char **argv)
{
    static const char *const own[] = {"--part", "--outfile", "--stats", "--checkpoint", "--checkpoint-every",
                                      "--resume", NULL};
    bool is_over = false;

    bis_append(command, BIS_PART_COMMAND, "bis");
    for (int i = 0; i < argc; i++) {
        const size_t n = strcspn(argv[i], "=");
        int k = 0;
        while (!is_over && own[k] && (strlen(own[k]) != n || strncmp(argv[i], own[k], n) != 0)) k++;
        is_over |= strcmp(argv[i], "--") == 0;
        if (is_over || !own[k]) append_argument(command, argv[i]);
        else if (!argv[i][n]) i++; /* its value */
    }
    if (strlen(command) == BIS_PART_COMMAND - 1) snprintf(command, BIS_PART_COMMAND, "bis (as the other parts)");
}

static bool read_viewer(void *value, const char *text)
{
    *(const char **)value = text;
    return bis_display_is_address(text);
}

/* ---- the command line over the scene ---- */

/* The errata to render as printed: those of the scene and of the command line. */
static bis_status switch_errata(bis_settings *s, const bis_texts *names, bis_diag *diag)
{
    bis_status status = BIS_OK;
    char hint[BIS_HINT];

    for (int i = 0; i < names->n; i++) {
        const bis_erratum *e = bis_erratum_find(names->text[i]);
        if (e) s->as_printed |= e->flag;
        else
            status = bis_error(diag, BIS_INPUT, bis_cli_loc,
                               "--as-printed: no erratum \"%s\" can be switched%s; `bis --as-printed list` lists them",
                               names->text[i], bis_hint(hint, bis_erratum_nearest(names->text[i])));
    }
    for (const bis_erratum *e = bis_errata; e->name; e++) {
        if (!(s->as_printed & e->flag) || bis_erratum_reaches(e, s->integrator->name)) continue;
        bis_warn(diag, bis_cli_loc, "%s as printed has no effect on integrator \"%s\", only on: %s", e->name,
                 s->integrator->name, e->integrators);
    }
    return status;
}

static bis_status override_settings(bis_scene_desc *d, const render_options *o, bis_diag *diag)
{
    bis_settings *s = &d->view.settings;

    if (o->integrator && (!d->names_integrator || strcmp(o->integrator, s->integrator->name) != 0)) {
        const unsigned as_printed = s->as_printed;
        *s = bis_settings_default(bis_integrator_find(o->integrator));
        s->as_printed = as_printed;
        d->integrator_loc = bis_cli_loc;
    }
    /* the scene left open what the command line says */
    if (s->only_sir && bis_parameter_given(o->parameters, "candidates")) s->integrator = &bis_sir;
    bis_parameter_override(s, o->parameters, diag);
    if (bis_parameter_given(o->parameters, "learn") && s->learn && s->proposal != BIS_PROPOSAL_PRODUCT &&
        bis_parameter_of(s->integrator, "learn"))
        bis_warn(diag, bis_cli_loc, "--learn has no effect on proposal \"%s\", only on \"product\"",
                 bis_proposal_name(s->proposal));
    bis_settings_leave_open(s);
    bis_status status = switch_errata(s, &o->as_printed, diag);
    return status ? status : bis_settings_check(s, bis_cli_loc, diag);
}

/* "albedo,normal", "all" or "none". */
static bis_status read_layers(unsigned *set, const char *list, bis_diag *diag)
{
    *set = 0;
    if (strcmp(list, "none") == 0) return BIS_OK;
    for (const char *end; *list; list = *end ? end + 1 : end) {
        char name[64], hint[BIS_HINT];
        size_t n = strcspn(list, ",");
        end = list + n;
        snprintf(name, sizeof name, "%.*s", (int)(n < sizeof name ? n : sizeof name - 1), list);
        if (bis_layers_include(set, name)) continue;
        return bis_error(diag, BIS_INPUT, bis_cli_loc, "--layers: there is no layer \"%s\"%s; `bis --help` lists them",
                         name, bis_hint(hint, bis_layer_nearest(name)));
    }
    return BIS_OK;
}

static bis_status override(bis_scene_desc *d, const render_options *o, bis_diag *diag)
{
    bis_status status = override_settings(d, o, diag);
    if (!status && o->layers) status = read_layers(&d->view.film.layers, o->layers, diag);
    if (status) return status;

    if (o->has_spp) bis_sampler_set_spp(&d->view.sampler, (uint32_t)o->spp);
    if (o->has_seed) d->view.sampler.seed = o->seed;
    if (o->accelerator) d->accel.kind = strcmp(o->accelerator, "grid") == 0 ? BIS_ACCEL_GRID : BIS_ACCEL_EMBREE;
    if (d->accel.kind == BIS_ACCEL_EMBREE && !bis_accel_embree_version())
        return bis_error(diag, BIS_INPUT, bis_cli_loc,
                         "accelerator \"embree\" is not built in; use \"grid\", or build with Embree installed");
    if (o->threads) d->accel.n_threads = (int)o->threads;
    bis_cli_use_threads(o->threads);
    if (o->has_resolution) {
        d->view.film.width = o->resolution[0];
        d->view.film.height = o->resolution[1];
    }
    if (o->has_crop) memcpy(d->view.film.crop, o->crop, sizeof o->crop);
    if (o->no_jitter) d->view.pixel_jitter = false;
    if (o->adaptive) d->view.adaptive = true;
    return BIS_OK;
}

/* What needs the whole picture would make another one of its parts. */
static bis_status check_part(const render_options *o, const bis_scene_desc *d, bis_diag *diag)
{
    const char *what = NULL;

    if (!o->part.n) return BIS_OK;
    if (bis_cli_crew) what = "MPI: its ranks share the tiles already. Leave out --part";
    else if (o->seconds > 0) what = "--time: each part would end after another number of camera samples. Give --spp N";
    else if (o->error > 0)
        what = "--error: it is the error of the whole picture, which no part knows. Give --spp N; a small --resolution "
               "with --error tells how many";
    else if (d->view.adaptive)
        what = "adaptive sampling: it weighs each tile against the whole picture. Leave out --adaptive, and \"bool "
               "adaptive\" of the scene";
    else if (bis_auto_is_wanted(&d->view.settings))
        what = "integrator \"auto\": it goes by the clock, so each part would choose anew. `bis SCENE --time 60 "
               "--stats -` runs it once; give all parts the Integrator line in \"chosen\"";
    if (!what) return BIS_OK;
    return bis_error(diag, BIS_INPUT, bis_cli_loc, "--part %u/%u cannot have %s", (unsigned)o->part.k,
                     (unsigned)o->part.n, what);
}

/* The output of a part is no picture. */
static bis_status name_part(render_options *o, bis_diag *diag)
{
    bis_render_files *files = &o->files;

    if (!o->part.n) return BIS_OK;
    if (files->pictures.n == 1) {
        const char *path = files->pictures.text[0], ending[] = ".bispart";
        const size_t n = strlen(path), m = strlen(ending);
        files->pictures.n = 0;
        files->part = path;
        if (n > m && strcmp(path + n - m, ending) == 0) return BIS_OK;
    }
    return bis_error(diag, BIS_INPUT, bis_cli_loc, "--part %u/%u writes one file that is no picture yet: give "
                     "--outfile part-%u.bispart", (unsigned)o->part.k, (unsigned)o->part.n, (unsigned)o->part.k);
}

/* ---- rendering ---- */

/* While a pass is rendered, the film holds those before it. */
static void show_progress(const bis_progress *p, void *user)
{
    const render_options *o = user;
    char text[BIS_PROGRESS_TEXT];
    if (o->shows_progress) fprintf(stderr, "\r%s   \033[K", bis_progress_text(text, p));
    if (o->display) bis_display_offer(o->display, o->film);
}

/* Said early, after the pilot, so that nobody waits for what cannot come: an error that another budget will cut off, or
 * that takes over ten minutes. */
static void print_forecast(const bis_forecast *f, void *user)
{
    const render_options *o = user;
    const double late = 600;
    char time[32];
    const char *end = "Ctrl-C ends it earlier and writes what is done";

    if (o->seconds > 0 && f->seconds > o->seconds) end = "--time ends it before";
    else if (o->spp && f->spp > (double)o->spp) end = "--spp ends it before";
    else if (!(f->seconds > late)) return;
    fprintf(stderr,
            "%sbis: warning: --error %g would take about %s and %.3g camera samples a pixel; %s (the error is at most "
            "%.2g so far)\n",
            isatty(STDERR_FILENO) ? "\r\033[K" : "", o->error, bis_duration(time, f->seconds), f->spp, end,
            f->error);
}

/* Where the choice is left to us: a pilot first; desc->view.settings becomes what it chose, or the default
 * if the render is too short for a pilot, and is told. */
static bis_status choose(bis_auto_report *choice, const bis_scene *scene, bis_scene_desc *desc,
                         const bis_render_options *options, bool quiet, bis_diag *diag)
{
    char line[BIS_MAX_LINE];
    bis_status status = bis_auto_choose(choice, scene, desc, options, diag);

    if (status) return status;
    desc->view.settings = choice->settings;
    if (quiet) return BIS_OK;
    fprintf(stderr, "bis: note: auto %s%s\n", choice->is_chosen ? "chose " : "takes the default, ",
            bis_describe_choice(line, choice));
    return BIS_OK;
}

/* As choose, but a checkpoint knows what was chosen. */
static void choose_again(bis_auto_report *choice, bis_scene_desc *desc, const bis_checkpoint *c, bool quiet)
{
    char line[BIS_MAX_LINE];

    *choice = (bis_auto_report){.is_chosen = true, .settings = c->head.settings, .seconds = c->head.pilot_seconds};
    desc->view.settings = choice->settings;
    bis_describe_line(line, &choice->settings, true);
    if (!quiet) fprintf(stderr, "bis: note: auto goes on with %s, as the checkpoint says\n", line);
}

/* What rank 0 has chosen, to all ranks of the crew. */
static bis_status tell_choice(bis_scene_desc *desc, bis_status status, bis_diag *diag)
{
    bis_crew *crew = bis_cli_crew;
    char name[32] = "";

    status = bis_crew_agree(crew, status, diag);
    if (status || !crew) return status;
    bis_settings s = desc->view.settings;
    snprintf(name, sizeof name, "%s", s.integrator->name);
    crew->broadcast(crew, name, sizeof name);
    crew->broadcast(crew, &s, sizeof s);
    s.integrator = bis_integrator_find(name); /* an address is of one process */
    desc->view.settings = s;
    return BIS_OK;
}

static void warn_of_checkpoint(const char *message)
{
    const char *text = strstr(message, "error: ");
    fprintf(stderr, "%sbis: warning: no checkpoint was written, the render goes on: %s\n",
            isatty(STDERR_FILENO) ? "\r\033[K" : "", text ? text + strlen("error: ") : message);
}

/* What --checkpoint and --resume ask for; of the file, if there is one, all but the state is read. */
static bis_status open_checkpoint(bis_checkpoint *c, const render_options *o, bis_diag *diag)
{
    const char *resume = o->files.resume;

    *c = (bis_checkpoint){
        .path = o->files.checkpoint, .every = o->every, .warn = o->quiet ? NULL : warn_of_checkpoint};
    if (o->has_every && !c->path) bis_warn(diag, bis_cli_loc, "--checkpoint-every has no effect without --checkpoint");
    if (!resume || !bis_crew_leads(bis_cli_crew)) return BIS_OK;
    if (access(resume, F_OK) == 0) return bis_checkpoint_read(c, resume, diag);
    if (!o->quiet) fprintf(stderr, "bis: note: there is no \"%s\" yet: the render starts afresh\n", resume);
    return BIS_OK;
}

static bis_status render(bis_render_result *result, bis_film *film, bis_auto_report *choice, bis_checkpoint *checkpoint,
                         const bis_scene *scene, bis_scene_desc *desc, render_options *o, bis_diag *diag)
{
    const bool chooses = bis_auto_is_wanted(&desc->view.settings), leads = bis_crew_leads(bis_cli_crew);
    bis_status status = BIS_OK;
    bool show = leads && !o->quiet && isatty(STDERR_FILENO);
    bis_render_options options = {
        .budget = {.spp = (uint32_t)o->spp, .seconds = o->seconds, .error = o->error},
        .n_threads = (int)o->threads,
        .interrupted = &bis_cli_signal,
        .progress = show || (leads && o->viewer) ? show_progress : NULL,
        .forecast = o->quiet ? NULL : print_forecast,
        .user = o,
        .part = o->part,
        .crew = bis_cli_crew,
    };
    bis_cli_catch_signals();
    o->shows_progress = show;
    o->film = film;
    if (chooses && leads && checkpoint->head.settings.integrator) choose_again(choice, desc, checkpoint, o->quiet);
    else if (chooses && leads) status = choose(choice, scene, desc, &options, o->quiet, diag);
    if (chooses) status = tell_choice(desc, status, diag);
    /* without one, nothing is hashed */
    if (leads && (checkpoint->path || o->part.n)) options.checkpoint = checkpoint;
    if (!leads) options.interrupted = NULL; /* rank 0 ends the render */
    checkpoint->head.pilot_seconds = choice->seconds;
    /* the pilot's time is the user's: 0 would be no limit */
    if (o->seconds > 0) options.budget.seconds = fmax(o->seconds - choice->seconds, DBL_MIN);
    if (!status && o->viewer) {
        const char *name = o->files.part ? o->files.part : o->files.pictures.text[0];
        if (leads) status = bis_display_open(&o->display, o->viewer, name, film, diag);
        status = bis_crew_agree(bis_cli_crew, status, diag);
    }
    if (!status) status = bis_render(result, film, scene, desc, &desc->view, &options, diag);
    bis_display_close(o->display, !status && result->passes ? film : NULL, diag);
    if (show) fputs("\r\033[K", stderr);
    if (!status && leads && o->error > 0 && !(result->error_bound <= o->error)) {
        if (isnan(result->error_bound))
            bis_warn(diag, bis_cli_loc, "--error %g was not reached: the error is unknown, %u pass is too few",
                     o->error, result->passes);
        else
            bis_warn(diag, bis_cli_loc, "--error %g was not reached: the error is at most %.3g after %u passes",
                     o->error, result->error_bound, result->passes);
    }
    if (!status) bis_render_files_warn_of_nonfinite(&result->counters, diag);
    return status;
}

/* A render that does not fit is slow, or the system ends it. */
static bis_status warn_of_memory(const bis_scene_desc *desc, bis_diag *diag)
{
    const double room = bis_memory_free();
    bis_memory m;

    if (bis_memory_foresee(&m, desc, diag)) return BIS_NOMEM;
    if (room > 0 && m.peak > room)
        bis_warn(diag, bis_cli_loc,
                 "this render takes about %.1f GB, but %.1f GB of memory are free: it will be slow, or the system will "
                 "end it. Crops (--cropwindow), --layers none and --learn off take less, as `bis --plan` tells",
                 m.peak / 1e9, room / 1e9);
    return BIS_OK;
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

/* Of a part: its sums instead of pictures. */
static bis_status write_part(const render_options *o, const bis_stats *stats, const bis_checkpoint *c, bis_film *film,
                             bis_diag *diag)
{
    const bis_render_result *r = stats->result;
    bis_part_about about = {.seed = stats->desc->view.sampler.seed, .edge_samples = stats->desc->view.edge_samples,
                            .edge_light = stats->desc->view.edge_light,
                            .seconds = stats->seconds, .figures = stats->scene};
    char seconds[32];

    snprintf(about.scene, sizeof about.scene, "%s", stats->desc->path);
    memcpy(about.command, o->command, sizeof about.command);
    snprintf(about.approximated, sizeof about.approximated, "%s", stats->approximated);
    if (r->interrupted) {
        fprintf(stderr, "bis: interrupted: part %u of %u is not complete, nothing was written%s\n",
                (unsigned)o->part.k, (unsigned)o->part.n, c->path ? "; --resume goes on" : "");
        return BIS_OK;
    }
    const bis_status status = bis_part_write(o->files.part, &c->head, &about, film, r, diag);
    if (!status && !o->quiet)
        fprintf(stderr, "bis: wrote %s: part %u of %u of %d x %d pixels, %llu camera samples a pixel, %s\n",
                o->files.part, (unsigned)o->part.k, (unsigned)o->part.n, film->width, film->height,
                (unsigned long long)r->spp, bis_duration(seconds, r->seconds));
    return status;
}

/* From scene to files; *interrupted: a signal came. */
static bis_status run(render_options *o, bis_scene_desc *desc, double parse_seconds, bool *interrupted,
                      bis_diag *diag)
{
    bis_scene *scene = NULL;
    bis_film film = {0};
    bis_render_result result;
    bis_texts written = {.n = 0};
    bis_auto_report choice = {.is_chosen = false};
    bis_checkpoint checkpoint;
    const bool chooses = bis_auto_is_wanted(&desc->view.settings);
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
    status = bis_scene_build(&scene, desc, diag);
    if (status) goto done;
    bis_cli_print_diag(diag, o->quiet); /* warnings, before the wait */
    bis_diag_clear(diag);
    if (!o->quiet) note_resampling(scene->light);
    o->agreed = true;
    status = bis_crew_agree(bis_cli_crew, BIS_OK, diag);
    if (status) goto done;
    status = render(&result, &film, &choice, &checkpoint, scene, desc, o, diag);
    if (status || !bis_crew_leads(bis_cli_crew)) goto done;
    *interrupted = bis_cli_signal;
    /* an older picture is worth more than a black one; said also when quiet, as an error is */
    if (result.passes == 0) {
        fputs("bis: interrupted before the first pass was complete: nothing was written\n", stderr);
        goto done;
    }

    bis_stats stats = bis_stats_of(desc, bis_scene_figures_of(scene), scene->seconds, &film, &result);
    stats.choice = chooses ? &choice : NULL;
    stats.seconds.parse = parse_seconds;
    double before = bis_clock_now();
    status = o->part.n ? write_part(o, &stats, &checkpoint, &film, diag)
                       : bis_render_files_write_pictures(&written, &o->files, &stats, diag);
    stats.seconds.write = bis_clock_now() - before;
    stats.seconds.total = bis_clock_now() - o->start;
    const bis_status other = bis_render_files_write_stats(&o->files, &stats, diag);
    if (!status) status = other;
    if (checkpoint.failed)
        status = bis_error(diag, BIS_IO, bis_cli_loc, "the last checkpoint could not be written to \"%s\"",
                           checkpoint.path);
    *interrupted = bis_cli_signal;
    if (!o->quiet && written.n) bis_render_files_print_result(&written, &stats);
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
    const bool leads = bis_crew_leads(bis_cli_crew);
    const unsigned how = o->approximate ? BIS_PARSE_APPROXIMATE | (o->plan ? BIS_PARSE_LIST_MISSING : 0) : 0;
    bis_status status = o->plan ? BIS_OK : name_part(o, diag);
    if (!status && leads) status = bis_render_files_check(&o->files, diag);
    if (!status) status = bis_scene_parse_as(&desc, operands[0], how, diag);
    if (!status) status = override(desc, o, diag);
    if (!status) status = check_part(o, desc, diag);
    const double parse_seconds = bis_clock_now() - o->start;
    if (status) goto done;
    if (o->plan) {
        bis_scene_plan(desc, stdout);
        goto done;
    }
    if (o->files.pictures.n == 0 && !o->files.part && leads) {
        o->files.pictures.text[o->files.pictures.n++] = desc->outfile;
        status = bis_render_files_check(&o->files, diag);
    }
    if (!status && leads) status = bis_render_files_check_distinct(&o->files, desc, diag);
    if (!status) status = run(o, desc, parse_seconds, &interrupted, diag);
done:
    if (!o->agreed) status = bis_crew_agree(bis_cli_crew, status, diag);
    bis_scene_desc_free(desc);
    const int exit_status = bis_cli_exit_status(status);
    return interrupted && !exit_status ? BIS_EXIT_INTERRUPTED : exit_status;
}

int bis_cmd_render(int argc, char **argv)
{
    enum { MAX_INTEGRATORS = 16, MAX_OPTIONS = 52 };
    static const char *const accelerators[] = {"grid", "embree", NULL};
    render_options o = {.every = 60, .start = bis_clock_now()};
    const char *integrators[MAX_INTEGRATORS + 1] = {0};
    char integrator_help[256] = "";
    int i = 0;

    keep_command(o.command, argc, argv);
    if (asks_for_errata(argc, argv)) {
        list_errata();
        return bis_cli_finish(BIS_EXIT_DONE);
    }
    for (; bis_integrators[i] && i < MAX_INTEGRATORS - 1; i++) {
        integrators[i] = bis_integrators[i]->name;
        bis_append(integrator_help, sizeof integrator_help, "%s, ", integrators[i]);
    }
    integrators[i] = bis_auto.name;
    bis_append(integrator_help, sizeof integrator_help,
               "or auto: a pilot chooses, if the render is long enough for it (default: the scene's; see `bis help "
               "sir`)");

    /* clang-format off: the rows are broken by hand */
    const bis_option before[] = {
        {.help = "output"},
        {.name = "outfile", .argument = "F",
         .help = "write the picture to F, by its ending .exr, .pfm, .hdr or .png; may be repeated (default: the "
                 "filename of the scene's Film)", .kind = BIS_OPTION_LIST, .value = &o.files.pictures},
        {.name = "layers", .argument = "L,...",
         .help = "what an EXR carries beside R, G, B, A: stderr, interval, samples, shadowrays, candidates, "
                 "unoccluded, visibility, albedo, normal, depth; all; none", .kind = BIS_OPTION_TEXT,
         .value = &o.layers},
        {.name = "stats", .argument = "F", .help = "write figures about the run to F as JSON; \"-\": standard output",
         .kind = BIS_OPTION_TEXT, .value = &o.files.stats},
        {.name = "exposure", .argument = "EV",
         .help = "PNG: multiply radiance by 2^EV (default: from the picture's log-average)", .kind = BIS_OPTION_REAL,
         .value = &o.files.exposure, .given = &o.files.has_exposure, .lo = -100, .hi = 100},
        {.name = "display", .argument = "HOST:PORT",
         .help = "show the picture in tev (localhost:14158) while it is rendered; a viewer that is missing or gone "
                 "stops nothing", .kind = BIS_OPTION_OWN, .value = &o.viewer, .read = read_viewer,
         .rule = "HOST:PORT with a port in [1, 65535], as in localhost:14158"},
        {.name = "quiet", .help = "no progress, no warnings, no line about what was written", .kind = BIS_OPTION_FLAG,
         .value = &o.quiet},
        {.name = "plan", .help = "print what the scene requires and what will be built for it; render nothing",
         .kind = BIS_OPTION_FLAG, .value = &o.plan},
        {.name = "approximate",
         .help = "what of pbrt bis does not model is replaced by the nearest that it does, and listed; with --plan, "
                 "meshes and maps may be missing, and are listed", .kind = BIS_OPTION_FLAG, .value = &o.approximate},

        {.help = "what to render (these override the scene file)"},
        {.name = "integrator", .argument = "NAME",
         .help = integrator_help, .kind = BIS_OPTION_NAME, .value = &o.integrator, .names = integrators},
    };
    const bis_option behind[] = {
        {.name = "seed", .argument = "N", .help = "another seed, other noise", .kind = BIS_OPTION_COUNT,
         .value = &o.seed, .given = &o.has_seed, .hi = 0x1p53},
        {.name = "accelerator", .argument = "A", .help = "grid or embree", .kind = BIS_OPTION_NAME,
         .value = &o.accelerator, .names = accelerators},
        {.name = "resolution", .argument = "WxH", .help = "size of the full picture in pixels", .kind = BIS_OPTION_OWN,
         .value = o.resolution, .given = &o.has_resolution, .read = bis_cli_read_size, .rule = BIS_SIZE_RULE},
        {.name = "cropwindow", .argument = "x0,x1,y0,y1",
         .help = "render this part alone, in shares of the full picture; pixels are the same as those of the full "
                 "picture. An EXR keeps the full display window, other formats hold the crop", .kind = BIS_OPTION_OWN,
         .value = o.crop, .given = &o.has_crop, .read = read_crop,
         .rule = "x0,x1,y0,y1 in [0, 1] with x0 < x1 and y0 < y1, as in 0.25,0.75,0,1"},
        {.name = "as-printed", .argument = "E",
         .help = "follow the thesis to the letter where docs/errata.md departs from it, as in E6: a wrong picture, to "
                 "see why; may be repeated; \"list\" prints all", .kind = BIS_OPTION_LIST, .value = &o.as_printed},
        {.name = "disable-pixel-jitter", .help = "camera rays through pixel centres", .kind = BIS_OPTION_FLAG,
         .value = &o.no_jitter},
        {.name = "nthreads", .argument = "N",
         .help = "threads (default: one for each processor); pictures do not depend on it",
         /* where the system gives fewer, OpenMP's runtime says so and exits with 1: it has no way to ask */
         .kind = BIS_OPTION_COUNT, .value = &o.threads, .lo = 1, .hi = 1024},

        {.help = "how long (whichever comes first; default: the scene's pixelsamples)"},
        {.name = "spp", .argument = "N", .help = "camera samples in each pixel", .kind = BIS_OPTION_COUNT,
         .value = &o.spp, .given = &o.has_spp, .lo = 1, .hi = 1e9},
        {.name = "time", .argument = "SECONDS", .help = "seconds of rendering, loading and building not counted; "
            "ends within one pass; also 10s, 2min, 1.5h",
         .kind = BIS_OPTION_SECONDS, .value = &o.seconds, .above = true, .hi = 1e8},
        {.name = "error", .argument = "E", .help = "until an upper 95% bound of the relative RMSE is at most E, as "
            "in 0.05 or 5%",
         .kind = BIS_OPTION_SHARE, .value = &o.error, .above = true, .hi = 10},
        {.name = "adaptive",
         .help = "camera samples go where the error is, by tiles of 16 x 16 pixels; --spp is then their mean, rounded "
                 "up to a multiple of 4", .kind = BIS_OPTION_FLAG, .value = &o.adaptive},

        {.help = "a render in several runs (the picture has the bits of one run)"},
        {.name = "checkpoint", .argument = "F",
         .help = "keep the state of the render in F: at intervals, at the end, at Ctrl-C and SIGTERM",
         .kind = BIS_OPTION_TEXT, .value = &o.files.checkpoint},
        {.name = "checkpoint-every", .argument = "SECONDS",
         .help = "the interval, looked at between passes; 0: after each pass (default: 60)",
         .kind = BIS_OPTION_SECONDS, .value = &o.every, .given = &o.has_every, .hi = 1e8},
        {.name = "resume", .argument = "F",
         .help = "go on from the checkpoint F, or start afresh where there is no such file; --spp, --time and --error "
                 "count from the very start and may be more than before. Without --checkpoint, F is written as well",
         .kind = BIS_OPTION_TEXT, .value = &o.files.resume},

        {.help = "a render on several machines (the picture has the bits of one run)"},
        {.name = "part", .argument = "K/N",
         .help = "render the K-th of N shares of the picture's tiles into --outfile F.bispart; `bis merge` makes the "
                 "picture of them. Not with --time, --error, --adaptive or auto, which need the whole picture",
         .kind = BIS_OPTION_OWN, .value = &o.part, .read = read_part,
         .rule = "K/N with K from 1 to N, as in 2/5"},
    };
    /* clang-format on */
    bis_option options[MAX_OPTIONS];
    size_t n_options = sizeof before / sizeof *before;
    memcpy(options, before, sizeof before);
    bis_parameter_options(options, &n_options, o.parameters);
    assert(n_options + sizeof behind / sizeof *behind <= MAX_OPTIONS);
    memcpy(options + n_options, behind, sizeof behind);
    const bis_command command = {
        .name = "render",
        .usage = "[render] [options] SCENE",
        .summary = "render a scene",
        .options = options,
        .n_options = n_options + sizeof behind / sizeof *behind,
        .min_operands = 1, .max_operands = 1,
        .notes = "Exit status: 0 done; 1 could not read or write, or out of memory; 2 bad usage or\n"
                 "bad scene; 130 interrupted, after the complete passes have been written.\n",
    };
    return bis_cli_run(&command, argc, argv, render_scene, &o);
}
