/* SPDX-License-Identifier: BSD-2-Clause */
/* cmd_merge: `bis merge PART... --outfile F`: the picture of the parts that `bis render --part` has made. */
#include "bis/base/clock.h"
#include "bis/base/mem.h"
#include "bis/thesis/errata.h"

#include "render/part.h"
#include "render_files.h"

#include <string.h>

typedef struct merge_options {
    bis_render_files files;
    bool quiet;
} merge_options;

/* The outputs are no inputs. */
static bis_status check_files(const bis_render_files *files, const char *const *parts, int n, bis_diag *diag)
{
    const char *outputs[BIS_MAX_TEXTS + 1];
    size_t n_outputs = 0;

    if (files->pictures.n == 0)
        return bis_error(diag, BIS_INPUT, bis_cli_loc, "where to? give --outfile picture.exr");
    const bis_status status = bis_render_files_check(files, diag);
    if (status) return status;
    for (int i = 0; i < files->pictures.n; i++) outputs[n_outputs++] = files->pictures.text[i];
    if (files->stats) outputs[n_outputs++] = files->stats;
    return bis_cli_check_distinct(parts, (size_t)n, outputs, n_outputs, diag);
}

static bis_status merge(const merge_options *o, const char *const *parts, int n, bis_diag *diag)
{
    const double start = bis_clock_now();
    bis_merged *m = bis_alloc(1, sizeof *m);
    bis_texts written = {.n = 0};

    if (!m) return bis_error(diag, BIS_NOMEM, bis_cli_loc, "no memory");
    bis_status status = check_files(&o->files, parts, n, diag);
    if (!status) status = bis_part_merge(m, parts, n, diag);
    if (!status) {
        /* a picture's header tells of its scene; of this one is known what the parts have kept */
        bis_scene_desc desc = {.path = m->about.scene};
        desc.view.settings = m->head.settings;
        desc.view.sampler.seed = m->about.seed;
        desc.view.edge_samples = m->about.edge_samples;
        desc.view.edge_light = m->about.edge_light;
        bis_stats stats = bis_stats_of(&desc, m->about.figures, m->about.seconds, &m->film, &m->result);
        snprintf(stats.approximated, sizeof stats.approximated, "%s", m->about.approximated);
        bis_render_files_warn_of_counts(&m->result.counters, diag);
        const double before = bis_clock_now();
        double exposure;
        status = bis_render_files_write_pictures(&written, &exposure, &o->files, &stats, diag);
        stats.seconds.write = bis_clock_now() - before;
        stats.seconds.total = stats.seconds.parse + stats.seconds.load + stats.seconds.envmap + stats.seconds.accel +
                              stats.seconds.render + bis_clock_now() - start;
        /* also where a picture could not be written: the figures are not lost with it */
        const bis_status other = bis_render_files_write_stats(&o->files, &stats, diag);
        if (!status) status = other;
        if (!o->quiet && written.n) bis_render_files_print_result(&written, exposure, &stats);
    }
    bis_film_clear(&m->film);
    bis_free(m);
    return status;
}

int bis_cmd_merge(int argc, char **argv)
{
    merge_options o = {.quiet = false};
    const bis_option options[] = {
        {.help = "output"},
        {.name = "outfile", .argument = "F",
         .help = "write the picture to F, by its ending .exr, .pfm, .hdr or .png; may be repeated",
         .kind = BIS_OPTION_LIST, .value = &o.files.pictures},
        {.name = "stats", .argument = "F",
         .help = "write figures about all parts together to F as JSON; \"-\": standard output",
         .kind = BIS_OPTION_TEXT, .value = &o.files.stats},
        {.name = "exposure", .argument = "EV",
         .help = "PNG: multiply radiance by 2^EV (default: from the picture's log-average)", .kind = BIS_OPTION_REAL,
         .value = &o.files.exposure, .given = &o.files.has_exposure, .lo = -100, .hi = 100},
        {.name = "quiet", .help = "no warnings, no line about what was written", .kind = BIS_OPTION_FLAG,
         .value = &o.quiet},
    };
    const bis_command command = {
        .name = "merge",
        .usage = "merge PART... --outfile F",
        .summary = "put together the parts of a picture that `bis SCENE --part K/N` has made, in any order: the "
                   "picture has the bits of one render",
        .options = options, .n_options = sizeof options / sizeof *options,
        .min_operands = 1, .max_operands = argc > 1 ? argc : 1,
        .notes = "A part that is missing is named, with the command that makes it. Parts of\n"
                 "different renders are refused by what differs. The same part twice is fine.\n"
                 "Exit status: 0 done; 1 could not read or write, or out of memory; 2 bad usage,\n"
                 "or the parts are no picture.\n",
    };
    const char **parts = bis_alloc((size_t)argc + 1, sizeof *parts);
    bis_diag diag = {0};
    int n, exit_status;

    if (!parts) {
        fputs("bis: error: no memory\n", stderr);
        return BIS_EXIT_FAILED;
    }
    if (bis_cli_parse(&command, argc, argv, parts, &n, &exit_status)) {
        exit_status = bis_cli_exit_status(merge(&o, parts, n, &diag));
        bis_cli_print_diag(&diag, o.quiet);
        bis_diag_clear(&diag);
        exit_status = bis_cli_finish(exit_status);
    }
    bis_free(parts);
    return exit_status;
}
