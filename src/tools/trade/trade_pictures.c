/* SPDX-License-Identifier: BSD-2-Clause */
/* trade_pictures: the same seconds for each method: what does one see? (As the thesis's figures 5.1-5.8, 12 seconds
 * each.)
 *
 * The best setting of each integrator and the scene's own get as many passes as fit the time of the longest runs of the
 * sweep, one at least. The pictures stay in pictures/ as EXR, for `bis compare`; pictures.csv says what they are, and a
 * resumed measurement renders only those that have changed. */
#include "trade_files.h"
#include "trade_pictures.h"
#include "trade_scene.h"
#include "trade_stats.h"

#include "bis/tools/compare.h"
#include "bis/base/file.h"
#include "bis/files/image_file.h"

#include <string.h>
#include <unistd.h>

static const char *file_of(char name[32], int setting)
{
    snprintf(name, 32, "pictures/%02d.exr", setting + 1);
    return name;
}

static uint32_t passes_of(const bis_trade *t, int setting)
{
    return (uint32_t)fmin(fmax(round(t->plan.run_seconds / t->result.curves[setting].pass_seconds), 1), 1 << 20);
}

/* ---- pictures.csv ---- */

/* The seconds of a picture that was made before; 0: it was not, or with another number of passes. */
static double seconds_before(const bis_trade *t, int setting, uint32_t passes)
{
    char line[256], name[BIS_TRADE_NAME + 16], path[4096];
    double seconds = 0;
    FILE *f = fopen(bis_trade_path(path, t, "pictures.csv"), "r");

    if (!f) return 0;
    const int n = snprintf(name, sizeof name, "%s,%u,", t->plan.settings[setting].name, (unsigned)passes);
    while (fgets(line, sizeof line, f)) {
        const char *end;
        if (strncmp(line, name, (size_t)n) == 0) seconds = bis_parse_double(line + n, &end);
    }
    fclose(f);
    return seconds > 0 ? seconds : 0;
}

static void put_list(FILE *out, const bis_trade *t)
{
    char name[32], a[32], b[32];

    fputs("setting,passes,seconds,relmse,file\n", out);
    for (const bis_trade_picture *p = t->strip; p < t->strip + t->n_strip; p++)
        fprintf(out, "%s,%u,%s,%s,%s\n", t->plan.settings[p->setting].name, (unsigned)p->passes,
                bis_format_double(a, p->seconds), bis_format_double(b, p->relmse), file_of(name, p->setting));
}

/* ---- one picture ---- */

/* *complete is false when interrupted; nothing is left then. */
static bis_status make_picture(bis_trade_picture *p, bis_trade *t, bool *complete, bis_diag *diag)
{
    const bis_trade_setting *s = &t->plan.settings[p->setting];
    char path[4096], name[32];
    bis_comparison c;
    bis_render_result result;
    bis_status status;

    bis_trade_path(path, t, file_of(name, p->setting));
    p->seconds = seconds_before(t, p->setting, p->passes);
    *complete = p->seconds > 0 && access(path, F_OK) == 0;
    if (*complete) {
        status = bis_image_read(&p->image, path, (bis_loc){0}, diag);
    } else {
        if (bis_trade_interrupted(t)) return BIS_OK;
        const bis_trade_job job = {s, t->plan.step, p->passes, bis_trade_seed(&t->plan, 2, (uint64_t)p->setting)};
        status = bis_trade_render(t, &job, &p->image, &result, diag);
        *complete = !status && !result.interrupted;
        if (*complete) status = bis_image_save(&p->image, path, diag);
        p->seconds = result.seconds;
    }
    if (!status && *complete) status = bis_compare(&c, &p->image, &t->both.image, diag);
    if (!status && *complete) p->relmse = c.relmse;
    else bis_image_clear(&p->image);
    return status;
}

bis_status bis_trade_make_pictures(bis_trade *t, bis_diag *diag)
{
    int heads[BIS_TRADE_STRIP];
    const int n = bis_trade_heads(t, heads);
    bis_status status = bis_trade_make_folder(t, "pictures", diag);

    for (int i = 0; i < n && !status; i++) {
        bis_trade_picture p = {.setting = heads[i], .passes = passes_of(t, heads[i])};
        bool complete;
        bis_trade_tell(t, "pictures", (double)i / n, t->plan.run_seconds * (n - i));
        status = make_picture(&p, t, &complete, diag);
        if (!status && complete) t->strip[t->n_strip++] = p;
    }
    return status ? status : bis_trade_write(t, "pictures.csv", put_list, diag);
}
