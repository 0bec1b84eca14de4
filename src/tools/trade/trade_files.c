/* SPDX-License-Identifier: BSD-2-Clause */
/* trade_files: the folder of a measurement: plan.txt and runs.csv, written and read back by --resume.
 *
 * Both are text that a user may look at, with numbers that read back as the same doubles. Every file is written whole
 * under a temporary name and renamed: after a crash there is the older one. What is read is not trusted: a name that
 * the table has not, or a number out of range, is an error with its line. The plan belongs to one text of one scene and
 * to one version of bis, which its fingerprint tells. */
#include "trade_files.h"
#include "trade_plan.h"
#include "trade_scene.h"
#include "trade_settings.h"

#include "base/grow.h"
#include "base/text.h"
#include "bis/base/file.h"
#include "bis/base/version.h"

#include <dirent.h>
#include <errno.h>
#include <float.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const char runs_header[] =
    "setting,passes,replicate,seed,seconds,camera_rays,shadow_rays,candidates,rmse,relmse,bias,relmse_both";

const char *bis_trade_path(char buf[4096], const bis_trade *t, const char *name)
{
    snprintf(buf, 4096, "%s/%s", t->o.folder, name);
    return buf;
}

bis_status bis_trade_write(const bis_trade *t, const char *name, bis_trade_put *put, bis_diag *diag)
{
    char path[4096];
    bis_outfile *file;
    bis_status status = bis_outfile_open(&file, bis_trade_path(path, t, name), diag);

    if (status) return status;
    put(bis_outfile_stream(file), t);
    return bis_outfile_commit(file, diag);
}

/* ---- the folder ---- */

static bis_status cannot_make(const char *path, bis_diag *diag)
{
    return bis_error(diag, BIS_IO, (bis_loc){path, 0, 0}, "cannot make the folder \"%s\": %s", path, strerror(errno));
}

/* The first entry of a folder in name, "" for an empty one. */
static bis_status first_entry(char name[256], const char *folder, bis_diag *diag)
{
    DIR *d = opendir(folder);

    name[0] = '\0';
    if (!d)
        return bis_error(diag, errno == ENOTDIR ? BIS_INPUT : BIS_IO, (bis_loc){folder, 0, 0},
                         "\"%s\" is no folder that can be read: %s", folder, strerror(errno));
    for (const struct dirent *e; (e = readdir(d)) != NULL && !name[0];)
        if (strcmp(e->d_name, ".") != 0 && strcmp(e->d_name, "..") != 0) snprintf(name, 256, "%s", e->d_name);
    closedir(d);
    return BIS_OK;
}

bis_status bis_trade_check_folder(bis_trade *t, bis_diag *diag)
{
    const char *folder = t->o.folder;
    char name[256], path[4096];

    if (strlen(folder) > 3800)
        return bis_error(diag, BIS_INPUT, (bis_loc){0}, "--output has a name of %zu bytes; take a shorter one",
                         strlen(folder));
    t->made_folder = mkdir(folder, 0777) == 0;
    if (!t->made_folder && errno != EEXIST) return cannot_make(folder, diag);
    bis_status status = first_entry(name, folder, diag);
    if (status) return status;
    if (!name[0]) {
        if (t->o.resume)
            bis_warn(diag, (bis_loc){folder, 0, 0}, "there is no measurement to go on with; a new one begins");
        t->o.resume = false;
        return BIS_OK;
    }
    if (access(bis_trade_path(path, t, "plan.txt"), F_OK) != 0) {
        return bis_error(
            diag, BIS_INPUT, (bis_loc){folder, 0, 0},
            "\"%s\" holds other things (\"%s\") and no plan.txt of `bis trade`; name a new or empty folder by --output",
            folder, name);
    }
    if (t->o.resume) return BIS_OK;
    return bis_error(diag, BIS_INPUT, (bis_loc){folder, 0, 0},
                     "\"%s\" holds a measurement; --resume goes on with it, --output names another folder", folder);
}

bis_status bis_trade_make_folder(const bis_trade *t, const char *name, bis_diag *diag)
{
    char path[4096];
    bis_trade_path(path, t, name);
    return mkdir(path, 0777) == 0 || errno == EEXIST ? BIS_OK : cannot_make(path, diag);
}

/* ---- the plan ---- */

/* FNV-1a over the bytes of all scene files, the version and the names in the table. Meshes and maps are not looked
 * into. */
static bis_status fingerprint(uint64_t *hash, const bis_trade *t, bis_diag *diag)
{
    uint64_t h = bis_fnv1a(BIS_FNV1A, BIS_VERSION, strlen(BIS_VERSION));

    for (int i = 0; i < t->plan.n_settings; i++)
        h = bis_fnv1a(h, t->plan.settings[i].name, strlen(t->plan.settings[i].name));
    for (size_t i = 0; i < t->desc->n_files; i++) {
        unsigned char *data;
        size_t size;
        bis_status status = bis_file_read(&data, &size, t->desc->files[i], (bis_loc){0}, diag);
        if (status) return status;
        h = bis_fnv1a(h, data, size);
        bis_free(data);
    }
    *hash = h;
    return BIS_OK;
}

static void put_plan(FILE *out, const bis_trade *t)
{
    const bis_trade_plan *p = &t->plan;
    char a[32], b[32], c[32];

    fprintf(out, "fingerprint %016llx\nfull %d %d\nstep %d\nsize %d %d\nseeds %d\nseed %llu\n",
            (unsigned long long)p->fingerprint, p->full_width, p->full_height, p->step, p->width, p->height, p->n_seeds,
            (unsigned long long)p->seed);
    fprintf(out, "run_seconds %s\ngiven %d\n", bis_format_double(a, p->run_seconds), p->is_given);
    for (int k = 0; k < 2; k++) {
        if (p->reference[k] >= 0)
            fprintf(out, "reference %d %u %s\n", k, (unsigned)p->reference_passes[k],
                    p->settings[p->reference[k]].name);
    }
    for (int i = 0; i < p->n_settings; i++) {
        const bis_trade_setting *s = &p->settings[i];
        if (!s->is_swept) continue;
        fprintf(out, "setting %d %s %s %s %s\n", s->levels, bis_format_double(a, s->pass_seconds),
                bis_format_double(b, s->fill_seconds), bis_format_double(c, s->pass_relmse), s->name);
    }
}

bis_status bis_trade_write_plan(bis_trade *t, bis_diag *diag)
{
    const bis_status status = fingerprint(&t->plan.fingerprint, t, diag);
    return status ? status : bis_trade_write(t, "plan.txt", put_plan, diag);
}

/* Takes a number in [lo, hi] and the blank or comma behind it; NAN when there is none. */
static double read_number(const char **s, double lo, double hi)
{
    const char *end;
    double v = bis_parse_double(*s, &end);
    if (end == *s || !(v >= lo && v <= hi) || (*end && *end != ' ' && *end != ',')) return (double)NAN;
    *s = end + (*end != '\0');
    return v;
}

/* A whole number in [0, most], most <= 2^63, beyond which doubles are not whole. */
static bool read_whole(const char **s, double most, uint64_t *value)
{
    const double v = read_number(s, 0, most);
    if (!(v == floor(v))) return false; /* NAN as well */
    *value = (uint64_t)v;
    return true;
}

static bool read_count(const char **s, int lo, int hi, int *value)
{
    uint64_t v;
    if (!read_whole(s, hi, &v) || v < (uint64_t)lo) return false;
    *value = (int)v;
    return true;
}

static bool read_size(const char **s, int *width, int *height)
{
    return read_count(s, 1, BIS_IMAGE_MAX_SIDE, width) && read_count(s, 1, BIS_IMAGE_MAX_SIDE, height);
}

/* The hash of the scene's files and the options, as written: runs of another scene must not be mixed with these. */
static bool read_fingerprint(const char **s, uint64_t *hash)
{
    static const char digits[] = "0123456789abcdef";
    *hash = 0;
    for (int i = 0; i < 16; i++, ++*s) {
        const char *digit = **s ? strchr(digits, **s) : NULL;
        if (!digit) return false;
        *hash = *hash << 4 | (uint64_t)(digit - digits);
    }
    return true;
}

/* Are width and height those of the thin film? */
static bool is_size_of(const bis_trade_plan *p)
{
    static const double whole[4] = {0, 1, 0, 1};
    if (p->full_width < 1 || p->step < 1) return false;
    const bis_film f = bis_film_place(p->full_width, p->full_height, whole, p->step);
    return p->width == f.width && p->height == f.height;
}

static bool read_reference_line(const char **s, bis_trade_plan *p)
{
    int k, passes;
    if (!read_count(s, 0, 1, &k) || !read_count(s, 1, BIS_TRADE_MOST_PASSES, &passes) || p->reference[k] >= 0)
        return false;
    const int i = bis_trade_find_setting(p, *s);
    if (i < 0 || !bis_trade_may_be_reference(&p->settings[i], k)) return false;
    p->reference[k] = i;
    p->reference_passes[k] = (uint32_t)passes;
    *s += strlen(*s);
    return true;
}

static bool read_setting_line(const char **s, bis_trade_plan *p)
{
    int levels;
    const char *end;

    if (!read_count(s, 0, BIS_TRADE_LEVELS, &levels)) return false;
    const double seconds = read_number(s, 0, 1e9), fill = read_number(s, 0, 1e9), relmse = bis_parse_double(*s, &end);
    if (!(seconds > 0) || isnan(fill) || end == *s || relmse < 0 || isinf(relmse) || *end != ' ')
        return false; /* relmse may be NAN: not known */
    const int i = bis_trade_find_setting(p, end + 1);
    if (i < 0 || p->settings[i].is_swept) return false;
    p->settings[i].is_swept = true;
    p->settings[i].levels = levels;
    p->settings[i].pass_seconds = seconds;
    p->settings[i].fill_seconds = fill;
    p->settings[i].pass_relmse = relmse;
    *s = end + 1 + strlen(end + 1);
    return true;
}

/* The lines of a plan. */
enum { FINGERPRINT, FULL, STEP, SIZE, SEEDS, SEED, RUN_SECONDS, GIVEN, REFERENCE, SETTING, N_WORDS };

static const struct {
    const char *word, *rule;
} lines_of_plan[N_WORDS] = {
    [FINGERPRINT] = {"fingerprint", "16 digits 0-9, a-f"},
    [FULL] = {"full", "width and height in pixels, from 1 to 32768"},
    [STEP] = {"step", "a number from 1 to 32768"},
    [SIZE] = {"size", "width and height in pixels, those of \"full\" divided by \"step\", which stand before"},
    [SEEDS] = {"seeds", "a number from 1 to 16"},
    [SEED] = {"seed", "a whole number from 0 to 2^53 - 1"},
    [RUN_SECONDS] = {"run_seconds", "a number above 0, at most 1e9"},
    [GIVEN] = {"given", "0 or 1"},
    [REFERENCE] = {"reference", "0 (by a mis) or 1 (by a sir), each once, passes from 1 to 4194304, and the name of a "
                                "setting that may be one"},
    [SETTING] = {"setting", "levels from 0 to 21, seconds of a pass above 0, of its fill, relMSE of a pass, and the "
                            "name of a setting, once"},
};

_Static_assert(BIS_IMAGE_MAX_SIDE == 32768 && BIS_TRADE_SEEDS == 16 && BIS_TRADE_LEVELS == 21 &&
                   BIS_TRADE_MOST_PASSES == 4194304,
               "the rules above name these");

static bool read_fields(const char **s, int word, bis_trade_plan *p, uint64_t *hash)
{
    int given;

    switch (word) {
    case FINGERPRINT: return read_fingerprint(s, hash);
    case FULL: return read_size(s, &p->full_width, &p->full_height);
    case STEP: return read_count(s, 1, BIS_IMAGE_MAX_SIDE, &p->step);
    case SIZE: return read_size(s, &p->width, &p->height) && is_size_of(p);
    case SEEDS: return read_count(s, 1, BIS_TRADE_SEEDS, &p->n_seeds);
    case SEED: return read_whole(s, BIS_SEED_MAX, &p->seed);
    case RUN_SECONDS: return (p->run_seconds = read_number(s, 0, 1e9)) > 0;
    case REFERENCE: return read_reference_line(s, p);
    case SETTING: return read_setting_line(s, p);
    default: break;
    }
    if (!read_count(s, 0, 1, &given)) return false;
    p->is_given = given;
    return true;
}

/* seen[word] counts its lines; all but the last two stand once. */
static bis_status read_plan_line(bis_trade_plan *p, const char *line, bis_loc at, int seen[N_WORDS], uint64_t *hash,
                                 bis_diag *diag)
{
    static const char damaged[] = "the file is damaged, measure into a new folder";
    const size_t n = strcspn(line, " ");
    int word = 0;

    while (word < N_WORDS && (strlen(lines_of_plan[word].word) != n || strncmp(line, lines_of_plan[word].word, n) != 0))
        word++;
    if (word == N_WORDS) return bis_error(diag, BIS_INPUT, at, "\"%s\" is no line of a plan; %s", line, damaged);
    if (seen[word]++ && word < REFERENCE)
        return bis_error(diag, BIS_INPUT, at, "\"%s\" is the second line of its kind; %s", line, damaged);
    const char *s = line + n + (line[n] == ' ');
    if (read_fields(&s, word, p, hash) && !*s) return BIS_OK;
    return bis_error(diag, BIS_INPUT, at, "\"%s\": behind \"%s\" must stand %s; %s", line, lines_of_plan[word].word,
                     lines_of_plan[word].rule, damaged);
}

/* Lines of a file, each ended by a zero. next_line: NULL at the end. */
typedef struct lines {
    unsigned char *data;
    char *at;
    int number;
} lines;

static char *next_line(lines *l)
{
    char *line = l->at;
    if (!*line) return NULL;
    char *end = strchr(line, '\n');
    l->at = end ? end + 1 : line + strlen(line);
    if (end) *end = '\0';
    l->number++;
    return line;
}

static bis_status open_lines(lines *l, const char *path, bis_diag *diag)
{
    size_t size;
    bis_status status = bis_file_read(&l->data, &size, path, (bis_loc){0}, diag);
    l->at = (char *)l->data;
    l->number = 0;
    return status;
}

/* Is all there that the sweep needs, and no more pixels than a plan has? */
static bis_status check_plan(const bis_trade *t, const int seen[N_WORDS], bis_loc at, bis_diag *diag)
{
    const bis_trade_plan *p = &t->plan;

    for (int word = 0; word < N_WORDS; word++) {
        if (seen[word] || word == REFERENCE) continue;
        return bis_error(
            diag, BIS_INPUT, at,
            "a plan has a line \"%s\", and this one has none; the file is damaged, measure into a new folder",
            lines_of_plan[word].word);
    }
    const bis_film film = bis_trade_film(t, p->step);
    if (film.width < 1 || film.height < 1 || (double)film.width * film.height > 4.0 * BIS_TRADE_MOST_PIXELS) {
        return bis_error(diag, BIS_INPUT, at,
                         "by \"full\" and \"step\" %d x %d pixels are to be measured, must be at least 1 and at most "
                         "%d; the file is damaged, measure into a new folder",
                         film.width, film.height, 4 * BIS_TRADE_MOST_PIXELS);
    }
    for (int i = 0; i < p->n_settings && !p->is_given; i++) {
        const bis_trade_setting *s = &p->settings[i];
        const int k = bis_trade_judge_of(s);
        if (!s->is_swept || !s->levels || p->reference[k] >= 0) continue;
        return bis_error(diag, BIS_INPUT, at,
                         "\"%s\" is to be measured, and the line \"reference %d\" that says what it is compared with "
                         "is missing; the file is damaged, measure into a new folder",
                         s->name, k);
    }
    return BIS_OK;
}

bis_status bis_trade_read_plan(bis_trade *t, bis_diag *diag)
{
    bis_trade_plan *p = &t->plan;
    uint64_t theirs = 0;
    int seen[N_WORDS] = {0};
    char path[4096];
    lines l;

    bis_trade_path(path, t, "plan.txt");
    bis_status status = fingerprint(&p->fingerprint, t, diag);
    if (!status) status = open_lines(&l, path, diag);
    if (status) return status;
    p->reference[0] = p->reference[1] = -1;
    for (int i = 0; i < p->n_settings; i++) p->settings[i].is_swept = false;
    for (char *line; !status && (line = next_line(&l)) != NULL;)
        status = read_plan_line(p, line, (bis_loc){path, l.number, 1}, seen, &theirs, diag);
    bis_free(l.data);
    if (!status && seen[FINGERPRINT] && theirs != p->fingerprint) {
        return bis_error(diag, BIS_INPUT, (bis_loc){path, 0, 0},
                         "this measurement is of another scene than \"%s\" as it is now, or by another version of bis; "
                         "measure into a new folder", t->o.scene);
    }
    return status ? status : check_plan(t, seen, (bis_loc){path, 0, 0}, diag);
}

/* ---- runs ---- */

static int by_place(const void *x, const void *y)
{
    const bis_trade_run *a = x, *b = y;
    if (a->setting != b->setting) return a->setting - b->setting;
    return a->level != b->level ? a->level - b->level : a->replicate - b->replicate;
}

static void put_runs(FILE *out, const bis_trade *t)
{
    char text[5][32];

    fprintf(out, "%s\n", runs_header);
    for (size_t i = 0; i < t->n_runs; i++) {
        const bis_trade_run *r = &t->runs[i];
        const double values[5] = {r->seconds, r->rmse, r->relmse, r->bias, r->relmse_both};
        for (int k = 0; k < 5; k++) bis_format_double(text[k], values[k]);
        fprintf(out, "%s,%lu,%d,%llu,%s,%llu,%llu,%llu,%s,%s,%s,%s\n",
                t->plan.settings[r->setting].name, 1ul << r->level, r->replicate + 1, (unsigned long long)r->seed,
                text[0], (unsigned long long)r->camera_rays, (unsigned long long)r->shadow_rays,
                (unsigned long long)r->candidates, text[1], text[2], text[3], text[4]);
    }
}

bis_status bis_trade_write_runs(const bis_trade *t, bis_diag *diag)
{
    if (t->n_runs) qsort(t->runs, t->n_runs, sizeof *t->runs, by_place);
    return bis_trade_write(t, "runs.csv", put_runs, diag);
}

/* NULL, or the name of the first column that holds no such thing. */
static const char *read_run(bis_trade_run *r, const bis_trade_plan *p, char *line)
{
    const double most = 0x1p63;
    char *comma = strchr(line, ',');
    int passes;

    if (!comma) return "setting";
    *comma = '\0';
    const char *s = comma + 1;
    r->setting = bis_trade_find_setting(p, line);
    *comma = ',';
    if (r->setting < 0 || !p->settings[r->setting].is_swept) return "setting";
    if (!read_count(&s, 1, 1 << (BIS_TRADE_LEVELS - 1), &passes) || (passes & (passes - 1)) != 0) return "passes";
    r->level = ilogb(passes);
    if (r->level >= p->settings[r->setting].levels) return "passes";
    if (!read_count(&s, 1, p->n_seeds, &r->replicate)) return "replicate";
    r->replicate--;
    if (!read_whole(&s, BIS_SEED_MAX, &r->seed)) return "seed";
    if (isnan(r->seconds = read_number(&s, 0, 1e12))) return "seconds";
    if (!read_whole(&s, most, &r->camera_rays)) return "camera_rays";
    if (!read_whole(&s, most, &r->shadow_rays)) return "shadow_rays";
    if (!read_whole(&s, most, &r->candidates)) return "candidates";
    if (isnan(r->rmse = read_number(&s, 0, DBL_MAX))) return "rmse";
    if (isnan(r->relmse = read_number(&s, 0, DBL_MAX))) return "relmse";
    if (isnan(r->bias = read_number(&s, -DBL_MAX, DBL_MAX))) return "bias";
    if (isnan(r->relmse_both = read_number(&s, 0, DBL_MAX)) || *s) return "relmse_both";
    return NULL;
}

const bis_trade_run *bis_trade_find_run(const bis_trade *t, int setting, int level, int replicate)
{
    for (size_t i = 0; i < t->n_runs; i++) {
        const bis_trade_run *r = &t->runs[i];
        if (r->setting == setting && r->level == level && r->replicate == replicate) return r;
    }
    return NULL;
}

bis_status bis_trade_add_run(bis_trade *t, const bis_trade_run *run, bis_diag *diag)
{
    if (!BIS_ROOM(t->runs, t->capacity_runs, t->n_runs))
        return bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for %zu runs", t->n_runs + 1);
    t->runs[t->n_runs++] = *run;
    return BIS_OK;
}

bis_status bis_trade_read_runs(bis_trade *t, bis_diag *diag)
{
    char path[4096];
    lines l;

    if (access(bis_trade_path(path, t, "runs.csv"), F_OK) != 0) return BIS_OK; /* interrupted before the first */
    bis_status status = open_lines(&l, path, diag);
    if (status) return status;
    const char *header = next_line(&l);
    if (!header || strcmp(header, runs_header) != 0)
        status = bis_error(diag, BIS_INPUT, (bis_loc){path, 1, 1}, "the first line must be \"%s\"", runs_header);
    for (char *line; !status && (line = next_line(&l)) != NULL;) {
        bis_trade_run run;
        const bis_loc at = {path, l.number, 1};
        const char *wrong = read_run(&run, &t->plan, line);
        if (wrong)
            status = bis_error(diag, BIS_INPUT, at,
                               "\"%s\" is no run of plan.txt, by its %s; remove the line and it is measured again",
                               line, wrong);
        else if (bis_trade_find_run(t, run.setting, run.level, run.replicate))
            status = bis_error(diag, BIS_INPUT, at, "\"%s\" is the second of its kind; remove one of them", line);
        else status = bis_trade_add_run(t, &run, diag);
    }
    bis_free(l.data);
    return status;
}
