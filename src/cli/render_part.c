/* SPDX-License-Identifier: BSD-2-Clause */
/* render_part: `bis render --part K/N`: a share of the picture's tiles into a file, of which `bis merge` makes the
 * picture. */
#include "render_part.h"

#include "base/text.h"
#include "progress.h"
#include "render/checkpoint.h"

#include <string.h>

bool bis_render_part_read(void *value, const char *text)
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

void bis_render_part_keep_command(char command[BIS_PART_COMMAND], int argc, char **argv)
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

bis_status bis_render_part_name(bis_part share, bis_render_files *files, bis_diag *diag)
{
    if (!share.n) return BIS_OK;
    if (files->pictures.n == 1) {
        const char *path = files->pictures.text[0], ending[] = ".bispart";
        const size_t n = strlen(path), m = strlen(ending);
        files->pictures.n = 0;
        files->part = path;
        if (n > m && strcmp(path + n - m, ending) == 0) return BIS_OK;
    }
    return bis_error(diag, BIS_INPUT, bis_cli_loc, "--part %u/%u writes one file that is no picture yet: give "
                     "--outfile part-%u.bispart", (unsigned)share.k, (unsigned)share.n, (unsigned)share.k);
}

bis_status bis_render_part_check(bis_part share, const bis_budget *budget, const bis_scene_desc *desc,
                                 bis_diag *diag)
{
    const char *what = NULL;

    if (!share.n) return BIS_OK;
    if (bis_cli_ranks) what = "MPI: its ranks share the tiles already. Leave out --part";
    else if (budget->seconds > 0)
        what = "--time: each part would end after another number of camera samples. Give --spp N";
    else if (budget->error > 0)
        what = "--error: it is the error of the whole picture, which no part knows. Give --spp N; a small --resolution "
               "with --error tells how many";
    if (!what) return BIS_OK;
    return bis_error(diag, BIS_INPUT, bis_cli_loc, "--part %u/%u cannot have %s", (unsigned)share.k,
                     (unsigned)share.n, what);
}

bis_status bis_render_part_write(const bis_render_part *part, const bis_render_files *files, const bis_checkpoint *c,
                                 bis_film *film, const bis_stats *stats, bool quiet, bis_diag *diag)
{
    const bis_render_result *r = stats->result;
    bis_part_about about = {.seed = stats->desc->view.sampler.seed, .edge_samples = stats->desc->view.edge_samples,
                            .edge_light = stats->desc->view.edge_light,
                            .seconds = stats->seconds, .figures = stats->scene};
    char seconds[32];

    snprintf(about.scene, sizeof about.scene, "%s", stats->desc->path);
    memcpy(about.command, part->command, sizeof about.command);
    snprintf(about.approximated, sizeof about.approximated, "%s", stats->approximated);
    if (r->interrupted) {
        fprintf(stderr, "bis: interrupted: part %u of %u is not complete, nothing was written%s\n",
                (unsigned)part->share.k, (unsigned)part->share.n, c->path ? "; --resume goes on" : "");
        return BIS_OK;
    }
    const bis_status status = bis_part_write(files->part, &c->head, &about, film, r, diag);
    if (!status && !quiet)
        fprintf(stderr, "bis: wrote %s: part %u of %u of %d x %d pixels, %llu camera samples a pixel, %s\n",
                files->part, (unsigned)part->share.k, (unsigned)part->share.n, film->width, film->height,
                (unsigned long long)r->spp, bis_duration(seconds, r->seconds));
    return status;
}
