/* trade_files: the folder of a measurement: plan.txt and runs.csv, written and read back by --resume.
 *
 * Both are text that a user may look at, with numbers that read back as the same doubles. Every file is written whole
 * under a temporary name and renamed: after a crash there is the older one. What is read is not trusted: a name that
 * the table has not, or a number out of range, is an error with its line. The plan belongs to one text of one scene and
 * to one version of bis, which its fingerprint tells. */
#include "trade.h"

#include "bis/base/file.h"
#include "bis/base/mem.h"
#include "bis/base/version.h"

#include <dirent.h>
#include <errno.h>
#include <float.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const char runs_header[] = "setting,passes,replicate,seed,seconds,camera_rays,shadow_rays,candidates,rmse,relmse,bias,relmse_both";

const char *bis_trade_path(char buf[4096], const bis_trade *t, const char *name)
{
    snprintf(buf, 4096, "%s/%s", t->o.folder, name);
    return buf;
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
    if (!d) return bis_error(diag, errno == ENOTDIR ? BIS_INPUT : BIS_IO, (bis_loc){folder, 0, 0}, "\"%s\" is no folder that can be read: %s", folder, strerror(errno));
    for (const struct dirent *e; (e = readdir(d)) != NULL && !name[0];) {
        if (strcmp(e->d_name, ".") != 0 && strcmp(e->d_name, "..") != 0) snprintf(name, 256, "%s", e->d_name);
    }
    closedir(d);
    return BIS_OK;
}

bis_status bis_trade_check_folder(bis_trade *t, bis_diag *diag)
{
    const char *folder = t->o.folder;
    char name[256], path[4096];

    if (strlen(folder) > 3800) return bis_error(diag, BIS_INPUT, (bis_loc){0}, "--output has a name of %zu bytes; take a shorter one", strlen(folder));
    t->made_folder = mkdir(folder, 0777) == 0;
    if (!t->made_folder && errno != EEXIST) return cannot_make(folder, diag);
    bis_status status = first_entry(name, folder, diag);
    if (status) return status;
    if (!name[0]) {
        if (t->o.resume) bis_warn(diag, (bis_loc){folder, 0, 0}, "there is no measurement to go on with; a new one begins");
        t->o.resume = false;
        return BIS_OK;
    }
    if (access(bis_trade_path(path, t, "plan.txt"), F_OK) != 0) {
        return bis_error(diag, BIS_INPUT, (bis_loc){folder, 0, 0}, "\"%s\" holds other things (\"%s\") and no plan.txt of `bis trade`; name a new or empty folder by --output",
                         folder, name);
    }
    if (t->o.resume) return BIS_OK;
    return bis_error(diag, BIS_INPUT, (bis_loc){folder, 0, 0}, "\"%s\" holds a measurement; --resume goes on with it, --output names another folder", folder);
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
    uint64_t h = 0xcbf29ce484222325u;

    for (const char *c = BIS_VERSION; *c; c++) h = (h ^ (unsigned char)*c) * 0x100000001b3u;
    for (int i = 0; i < t->plan.n_settings; i++) {
        for (const char *c = t->plan.settings[i].name; *c; c++) h = (h ^ (unsigned char)*c) * 0x100000001b3u;
    }
    for (size_t i = 0; i < t->desc->n_files; i++) {
        unsigned char *data;
        size_t size;
        bis_status status = bis_file_read(&data, &size, t->desc->files[i], (bis_loc){0}, diag);
        if (status) return status;
        for (size_t k = 0; k < size; k++) h = (h ^ data[k]) * 0x100000001b3u;
        bis_free(data);
    }
    *hash = h;
    return BIS_OK;
}

bis_status bis_trade_write_plan(bis_trade *t, bis_diag *diag)
{
    bis_trade_plan *p = &t->plan;
    bis_outfile *file;
    char path[4096], a[32], b[32], c[32];

    bis_status status = fingerprint(&p->fingerprint, t, diag);
    if (!status) status = bis_outfile_open(&file, bis_trade_path(path, t, "plan.txt"), diag);
    if (status) return status;
    FILE *out = bis_outfile_stream(file);
    fprintf(out, "fingerprint %016llx\nfull %d %d\nsize %d %d\nseeds %d\nseed %llu\n", (unsigned long long)p->fingerprint, p->full_width, p->full_height,
            p->width, p->height, p->n_seeds, (unsigned long long)p->seed);
    fprintf(out, "run_seconds %s\ngiven %d\n", bis_format_double(a, p->run_seconds), p->is_given);
    for (int k = 0; k < 2; k++) {
        if (p->reference[k] >= 0) fprintf(out, "reference %d %u %s\n", k, (unsigned)p->reference_passes[k], p->settings[p->reference[k]].name);
    }
    for (int i = 0; i < p->n_settings; i++) {
        const bis_trade_setting *s = &p->settings[i];
        if (!s->is_swept) continue;
        fprintf(out, "setting %d %s %s %s %s\n", s->levels, bis_format_double(a, s->pass_seconds), bis_format_double(b, s->fill_seconds), bis_format_double(c, s->pass_relmse), s->name);
    }
    return bis_outfile_commit(file, diag);
}

/* A number in [lo, hi] and the blank behind it; NAN when there is none. */
static double read_number(const char **s, double lo, double hi)
{
    const char *end;
    double v = bis_parse_double(*s, &end);
    if (end == *s || !(v >= lo && v <= hi)) return (double)NAN;
    *s = end + (*end == ' ' || *end == ',');
    return v;
}

static bool read_count(const char **s, int lo, int hi, int *value)
{
    const double v = read_number(s, lo, hi);
    if (!(v == floor(v))) return false;
    *value = (int)v;
    return true;
}

static bool read_reference_line(bis_trade_plan *p, const char *s)
{
    int k, passes;
    if (!read_count(&s, 0, 1, &k) || !read_count(&s, 1, 1 << 30, &passes)) return false;
    p->reference[k] = bis_trade_find_setting(p, s);
    p->reference_passes[k] = (uint32_t)passes;
    return p->reference[k] >= 0;
}

static bool read_setting_line(bis_trade_plan *p, const char *s)
{
    int levels;
    const char *end;

    if (!read_count(&s, 0, BIS_TRADE_LEVELS, &levels)) return false;
    const double seconds = read_number(&s, 0, 1e9), fill = read_number(&s, 0, 1e9), relmse = bis_parse_double(s, &end);
    if (!(seconds > 0) || isnan(fill) || *end != ' ') return false;
    const int i = bis_trade_find_setting(p, end + 1);
    if (i < 0) return false;
    p->settings[i].is_swept = true;
    p->settings[i].levels = levels;
    p->settings[i].pass_seconds = seconds;
    p->settings[i].fill_seconds = fill;
    p->settings[i].pass_relmse = relmse;
    return true;
}

static bool read_plan_line(bis_trade_plan *p, const char *line, uint64_t *hash)
{
    const char *s = strchr(line, ' ');
    int given;

    if (!s) return false;
    const size_t n = (size_t)(s++ - line);
    if (strncmp(line, "fingerprint", n) == 0) return (*hash = strtoull(s, NULL, 16)) != 0;
    if (strncmp(line, "full", n) == 0) return read_count(&s, 1, BIS_IMAGE_MAX_SIDE, &p->full_width) && read_count(&s, 1, BIS_IMAGE_MAX_SIDE, &p->full_height);
    if (strncmp(line, "size", n) == 0) return read_count(&s, 1, BIS_IMAGE_MAX_SIDE, &p->width) && read_count(&s, 1, BIS_IMAGE_MAX_SIDE, &p->height);
    if (strncmp(line, "seeds", n) == 0 && n == 5) return read_count(&s, 1, BIS_TRADE_SEEDS, &p->n_seeds);
    if (strncmp(line, "seed", n) == 0) return (p->seed = (uint64_t)read_number(&s, 0, 0x1p53)) <= (uint64_t)1 << 53;
    if (strncmp(line, "run_seconds", n) == 0) return (p->run_seconds = read_number(&s, 0, 1e9)) > 0;
    if (strncmp(line, "reference", n) == 0) return read_reference_line(p, s);
    if (strncmp(line, "setting", n) == 0) return read_setting_line(p, s);
    if (strncmp(line, "given", n) != 0 || !read_count(&s, 0, 1, &given)) return false;
    p->is_given = given;
    return true;
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

bis_status bis_trade_read_plan(bis_trade *t, bis_diag *diag)
{
    bis_trade_plan *p = &t->plan;
    uint64_t theirs = 0;
    char path[4096];
    lines l;

    bis_trade_path(path, t, "plan.txt");
    bis_status status = fingerprint(&p->fingerprint, t, diag);
    if (!status) status = open_lines(&l, path, diag);
    if (status) return status;
    p->reference[0] = p->reference[1] = -1;
    for (int i = 0; i < p->n_settings; i++) p->settings[i].is_swept = false;
    for (char *line; (line = next_line(&l)) != NULL && !status;) {
        if (read_plan_line(p, line, &theirs)) continue;
        status = bis_error(diag, BIS_INPUT, (bis_loc){path, l.number, 1}, "\"%s\" is no line of a plan; the file is damaged, measure into a new folder", line);
    }
    bis_free(l.data);
    if (!status && theirs != p->fingerprint) {
        status = bis_error(diag, BIS_INPUT, (bis_loc){path, 0, 0}, "this measurement is of another scene than \"%s\" as it is now, or by another version of bis; measure "
                           "into a new folder", t->o.scene);
    }
    if (!status && (p->width < 1 || p->n_seeds < 1 || !(p->run_seconds > 0))) {
        status = bis_error(diag, BIS_INPUT, (bis_loc){path, 0, 0}, "the plan has no size, seeds or run_seconds; the file is damaged, measure into a new folder");
    }
    return status;
}

/* ---- runs ---- */

static int by_place(const void *x, const void *y)
{
    const bis_trade_run *a = x, *b = y;
    if (a->setting != b->setting) return a->setting - b->setting;
    return a->level != b->level ? a->level - b->level : a->replicate - b->replicate;
}

bis_status bis_trade_write_runs(const bis_trade *t, bis_diag *diag)
{
    bis_outfile *file;
    char path[4096], text[5][32];

    if (t->n_runs) qsort(t->runs, t->n_runs, sizeof *t->runs, by_place);
    bis_status status = bis_outfile_open(&file, bis_trade_path(path, t, "runs.csv"), diag);
    if (status) return status;
    fprintf(bis_outfile_stream(file), "%s\n", runs_header);
    for (size_t i = 0; i < t->n_runs; i++) {
        const bis_trade_run *r = &t->runs[i];
        const double values[5] = {r->seconds, r->rmse, r->relmse, r->bias, r->relmse_both};
        for (int k = 0; k < 5; k++) bis_format_double(text[k], values[k]);
        fprintf(bis_outfile_stream(file), "%s,%lu,%d,%llu,%s,%llu,%llu,%llu,%s,%s,%s,%s\n", t->plan.settings[r->setting].name, 1ul << r->level, r->replicate + 1,
                (unsigned long long)r->seed, text[0], (unsigned long long)r->camera_rays, (unsigned long long)r->shadow_rays,
                (unsigned long long)r->candidates, text[1], text[2], text[3], text[4]);
    }
    return bis_outfile_commit(file, diag);
}

static bool read_run(bis_trade_run *r, const bis_trade_plan *p, char *line)
{
    char *comma = strchr(line, ',');
    int passes;

    if (!comma) return false;
    *comma = '\0';
    const char *s = comma + 1;
    r->setting = bis_trade_find_setting(p, line);
    *comma = ',';
    if (r->setting < 0 || !read_count(&s, 1, 1 << (BIS_TRADE_LEVELS - 1), &passes) || (passes & (passes - 1)) != 0) return false;
    r->level = ilogb(passes);
    if (r->level >= p->settings[r->setting].levels || !read_count(&s, 1, p->n_seeds, &r->replicate)) return false;
    r->replicate--;
    const double most = 0x1p63, seed = read_number(&s, 0, 0x1p53), seconds = read_number(&s, 0, 1e12), camera = read_number(&s, 0, most);
    const double shadow = read_number(&s, 0, most), candidates = read_number(&s, 0, most);
    r->rmse = read_number(&s, 0, DBL_MAX);
    r->relmse = read_number(&s, 0, DBL_MAX);
    r->bias = read_number(&s, -DBL_MAX, DBL_MAX);
    r->relmse_both = read_number(&s, 0, DBL_MAX);
    if (isnan(seed + seconds + camera + shadow + candidates + r->rmse + r->relmse + r->bias + r->relmse_both) || *s) return false;
    r->seed = (uint64_t)seed;
    r->seconds = seconds;
    r->camera_rays = (uint64_t)camera;
    r->shadow_rays = (uint64_t)shadow;
    r->candidates = (uint64_t)candidates;
    return true;
}

bool bis_trade_has_run(const bis_trade *t, int setting, int level, int replicate)
{
    for (size_t i = 0; i < t->n_runs; i++) {
        const bis_trade_run *r = &t->runs[i];
        if (r->setting == setting && r->level == level && r->replicate == replicate) return true;
    }
    return false;
}

bis_status bis_trade_add_run(bis_trade *t, const bis_trade_run *run, bis_diag *diag)
{
    if (t->n_runs == t->capacity_runs) {
        const size_t capacity = t->capacity_runs ? 2 * t->capacity_runs : 256;
        bis_trade_run *grown = bis_realloc(t->runs, capacity, sizeof *grown);
        if (!grown) return bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for %zu runs", capacity);
        t->runs = grown;
        t->capacity_runs = capacity;
    }
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
    if (!header || strcmp(header, runs_header) != 0) status = bis_error(diag, BIS_INPUT, (bis_loc){path, 1, 1}, "the first line must be \"%s\"", runs_header);
    for (char *line; !status && (line = next_line(&l)) != NULL;) {
        bis_trade_run run;
        if (read_run(&run, &t->plan, line) && !bis_trade_has_run(t, run.setting, run.level, run.replicate)) status = bis_trade_add_run(t, &run, diag);
        else status = bis_error(diag, BIS_INPUT, (bis_loc){path, l.number, 1},
                                "\"%s\" is no run of plan.txt, or the second of its kind; remove the line and it is measured again", line);
    }
    bis_free(l.data);
    return status;
}
