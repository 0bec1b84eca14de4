/* SPDX-License-Identifier: BSD-2-Clause */
/* measure: scenes from templates, renders, references and their cache, relMSE. */
#include "measure.h"

#include "bis/base/file.h"
#include "bis/base/mem.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

const measure_setting measure_materials[] = {
    {"n10", "\"rgb Ks\" [1 1 1] \"rgb Kd\" [0 0 0] \"float exponent\" 10"},
    {"n50", "\"rgb Ks\" [1 1 1] \"rgb Kd\" [0 0 0] \"float exponent\" 50"},
    {"mixed", "\"rgb Ks\" [.5 .5 .5] \"rgb Kd\" [.5 .5 .5] \"float exponent\" 50"},
    {"diffuse", "\"rgb Ks\" [0 0 0] \"rgb Kd\" [1 1 1]"},
    {"black", "\"rgb Ks\" [0 0 0] \"rgb Kd\" [0 0 0]"},
};

/* The pair of methods behind a reference. Sobol's sequence goes on from pass to pass, so that any number of passes is
 * evenly spread. */
static const measure_setting reference_methods[] = {
    {"mis", "Sampler \"sobol\" \"integer pixelsamples\" 1 Integrator \"mis\" \"integer samples\" 256 \"float split\" "
     "0.75 \"bool stratify\" true"},
    {"sir", "Sampler \"sobol\" \"integer pixelsamples\" 1 Integrator \"sir\" \"integer candidates\" 800 \"integer "
     "shadowrays\" 100 "
            "\"string proposal\" \"product\""},
};

#define REFERENCE_FOLDER "build/bench/ref"
static const uint64_t reference_seed = 1000001; /* no measurement has such a seed */

void measure_check(bis_status status, bis_diag *diag)
{
    if (!status) return;
    for (size_t i = 0; i < diag->n; i++) fprintf(stderr, "%s\n", diag->messages[i].text);
    exit(1);
}

static void give_up(const char *what, const char *path)
{
    fprintf(stderr, "%s %s: %s\n", what, path, strerror(errno));
    exit(1);
}

/* ---- scenes ---- */

static void put_setting(FILE *out, const char *text, unsigned N)
{
    for (; *text; text++) {
        if (*text == '@') fprintf(out, "%u", N);
        else putc(*text, out);
    }
}

static void fill_template(FILE *out, const char *t, const char *setting, unsigned N, const char *material)
{
    static const char integrator[] = "@integrator", parameters[] = "@material";

    while (*t) {
        if (strncmp(t, integrator, sizeof integrator - 1) == 0) {
            put_setting(out, setting, N);
            t += sizeof integrator - 1;
        } else if (strncmp(t, parameters, sizeof parameters - 1) == 0) {
            fputs(material, out);
            t += sizeof parameters - 1;
        } else {
            putc(*t++, out);
        }
    }
}

/* The filled template stands beside it while it is read, for the names in it are relative. */
bis_scene_desc *measure_parse(const char *path, const char *setting, unsigned N, const char *material)
{
    bis_diag diag = {0};
    bis_scene_desc *desc;
    unsigned char *text;
    size_t size;
    char name[4096];

    snprintf(name, sizeof name, "%s.%ld", path, (long)getpid());
    measure_check(bis_file_read(&text, &size, path, (bis_loc){0}, &diag), &diag);
    FILE *out = fopen(name, "w");
    if (!out) give_up("cannot write", name);
    fill_template(out, (const char *)text, setting, N, material);
    if (fclose(out) != 0) give_up("cannot write", name);
    bis_status status = bis_scene_parse(&desc, name, &diag);
    remove(name);
    measure_check(status, &diag);
    bis_free(text);
    bis_diag_clear(&diag);
    return desc;
}

bis_scene *measure_build(const bis_scene_desc *desc)
{
    bis_diag diag = {0};
    bis_scene *scene;

    measure_check(bis_scene_build(&scene, desc, &diag), &diag);
    bis_diag_clear(&diag);
    return scene;
}

double measure_clock(void)
{
    struct timespec t;

    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

double measure_render(bis_film *film, const bis_scene *scene, bis_scene_desc *desc, uint64_t seed, uint32_t spp,
    int threads, bis_render_result *result)
{
    const bis_render_options options = {.budget = {.spp = spp}, .n_threads = threads};
    bis_diag diag = {0};
    bis_render_result own;

    if (!result) result = &own;

    desc->view.sampler.seed = seed;
    bis_sampler_set_spp(&desc->view.sampler, spp);
    bis_film_clear(film);
    measure_check(
        bis_film_init(film, desc->view.film.width, desc->view.film.height, desc->view.film.crop, (bis_loc){0}, &diag),
        &diag);
    double start = measure_clock();
    measure_check(bis_render(result, film, scene, &desc->view, &options, &diag), &diag);
    double cpu = measure_clock() - start;
    bis_diag_clear(&diag);
    return cpu;
}

size_t measure_shaded(const bis_film *film)
{
    const size_t n = (size_t)film->width * (size_t)film->height;
    size_t shaded = 0;

    for (size_t i = 0; i < n; i++) shaded += film->hits[i] > 0;
    return shaded ? shaded : 1;
}

/* ---- relMSE ---- */

/* Which pixels count, and m^2 times the floor's factor. */
static double floor_of(const double *L, const bis_film *film, bool antialiased)
{
    const size_t n = (size_t)film->width * (size_t)film->height;
    double sum = 0;
    size_t count = 0;

    for (size_t i = 0; i < n; i++) {
        if (!antialiased && film->hits[i] <= 0) continue;
        sum += L[3 * i] + L[3 * i + 1] + L[3 * i + 2];
        count += 3;
    }
    double m = count ? sum / (double)count : 0;
    return m * m * (antialiased ? 1e-2 : 1e-4);
}

static int descending(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;

    return (x < y) - (x > y);
}

/* Of a - b over the pixels that count in film; L is what they are relative to. */
static measure_error relative_error(
    const double *a, const double *b, const double *L, const bis_film *film, bool antialiased)
{
    const size_t n = (size_t)film->width * (size_t)film->height;
    const double floor2 = floor_of(L, film, antialiased);
    double *e = bis_alloc(n, sizeof *e), sum = 0, rest = 0;
    size_t count = 0;

    if (!e) give_up("no memory for", "errors");
    for (size_t i = 0; i < n; i++) {
        if (!antialiased && film->hits[i] <= 0) continue;
        for (size_t c = 3 * i; c < 3 * i + 3; c++)
            e[count] += (a[c] - b[c]) * (a[c] - b[c]) / (L[c] * L[c] + floor2) / 3;
        sum += e[count++];
    }
    qsort(e, count, sizeof *e, descending);
    for (size_t i = count / 100; i < count; i++) rest += e[i];
    bis_free(e);
    if (!count) return (measure_error){0, 0};
    return (measure_error){sum / (double)count, rest / (double)(count - count / 100)};
}

/* Means over passes, [height][width][3]; bis_free it. */
static double *means(const bis_film *film)
{
    const size_t n = 3 * (size_t)film->width * (size_t)film->height;
    double *L = bis_alloc(n, sizeof *L);

    if (!L) give_up("no memory for", "a picture");
    for (size_t i = 0; i < n; i++) L[i] = film->sum[i] / film->weight;
    return L;
}

measure_error measure_relmse(const bis_film *film, const measure_reference *ref, bool antialiased)
{
    double *L = means(film);
    measure_error e = relative_error(L, ref->L, ref->L, film, antialiased);

    bis_free(L);
    return e;
}

/* ---- references ---- */

/* FNV-1a (Fowler, Noll, Vo). */
static uint64_t hash_text(uint64_t h, const char *s)
{
    for (; *s; s++) h = (h ^ (unsigned char)*s) * 1099511628211u;
    return h;
}

static uint64_t hash_file_size(uint64_t h, const char *path)
{
    struct stat st;
    char size[32] = "";

    if (path && stat(path, &st) == 0) snprintf(size, sizeof size, "%lld", (long long)st.st_size);
    return hash_text(h, size);
}

static uint64_t reference_key(const char *path, const char *material, double seconds)
{
    bis_scene_desc *desc = measure_parse(path, reference_methods[0].text, 0, material);
    bis_diag diag = {0};
    unsigned char *text;
    size_t size;
    char budget[32];

    measure_check(bis_file_read(&text, &size, path, (bis_loc){0}, &diag), &diag);
    uint64_t h = hash_text(hash_text(14695981039346656037u, (const char *)text), material);
    for (int i = 0; i < 2; i++) h = hash_text(h, reference_methods[i].text);
    snprintf(budget, sizeof budget, "%g", seconds); /* and the version of this file's format and method: */
    h = hash_text(h, "2");
    h = hash_file_size(hash_text(h, budget), desc->light.filename);
    for (size_t i = 0; i < desc->n_meshes; i++) h = hash_file_size(h, desc->meshes[i].filename);
    bis_free(text);
    bis_scene_desc_free(desc);
    return h;
}

/* One method's picture: the mean of two halves, so many processor seconds each, and half of their difference, whose
 * square estimates the error of the mean. */
typedef struct halves {
    double *L, *difference, mean;
} halves;

static halves render_halves(bis_film *film, const bis_scene *scene, bis_scene_desc *desc, uint64_t seed, double seconds)
{
    const double pass = measure_render(film, scene, desc, seed, 1, 0, NULL);
    const uint32_t spp = (uint32_t)ceil(seconds / pass);
    const size_t n = 3 * (size_t)film->width * (size_t)film->height;
    halves h = {.mean = 0};

    measure_render(film, scene, desc, seed, spp, 0, NULL);
    h.L = means(film);
    measure_render(film, scene, desc, seed + 1, spp, 0, NULL);
    h.difference = means(film);
    for (size_t i = 0; i < n; i++) {
        const double a = h.L[i], b = h.difference[i];
        h.L[i] = (a + b) / 2;
        h.difference[i] = (a - b) / 2;
        h.mean += h.L[i] / (double)n;
    }
    return h;
}

/* to = w a + (1-w) b. */
static void blend(double *to, const double *a, const double *b, double w, size_t n)
{
    for (size_t i = 0; i < n; i++) to[i] = w * a[i] + (1 - w) * b[i];
}

/* Both methods' errors are taken relative to the blend, not to their own pictures: a far too bright pixel would excuse
 * itself. The blend needs the errors: the second round's weights are good enough. */
static void combine(measure_reference *ref, const halves h[2], const bis_film *film, bool antialiased)
{
    const size_t n = 3 * (size_t)film->width * (size_t)film->height;
    double *zero = bis_alloc(n, sizeof *zero), error[2], w = 0;

    ref->L = bis_alloc(n, sizeof *ref->L);
    if (!zero || !ref->L) give_up("no memory for", "a reference");
    for (int round = 0; round < 3; round++) {
        blend(ref->L, h[0].L, h[1].L, w, n);
        for (int i = 0; i < 2; i++) error[i] = relative_error(h[i].difference, zero, ref->L, film, antialiased).mean;
        w = error[0] + error[1] > 0 ? error[1] / (error[0] + error[1]) : 0.5;
    }
    ref->width = film->width;
    ref->height = film->height;
    ref->error = w * error[0];
    ref->disagree = relative_error(h[0].L, h[1].L, ref->L, film, antialiased).mean / (error[0] + error[1]);
    ref->difference = h[0].mean / h[1].mean - 1;
    bis_free(zero);
}

static measure_reference make_reference(const char *path, const char *material, double seconds)
{
    measure_reference ref = {.seconds = seconds};
    bis_film film = {0};
    bool antialiased = false;
    halves h[2];

    for (int i = 0; i < 2; i++) {
        bis_scene_desc *desc = measure_parse(path, reference_methods[i].text, 0, material);
        bis_scene *scene = measure_build(desc);
        h[i] = render_halves(&film, scene, desc, reference_seed + 2 * (uint64_t)i, seconds / 4);
        antialiased = desc->view.pixel_jitter;
        bis_scene_free(scene);
        bis_scene_desc_free(desc);
    }
    combine(&ref, h, &film, antialiased);
    for (int i = 0; i < 2; i++) {
        bis_free(h[i].L);
        bis_free(h[i].difference);
    }
    bis_film_clear(&film);
    return ref;
}

static bool read_reference(measure_reference *ref, const char *name)
{
    FILE *in = fopen(name, "rb");
    if (!in) return false;
    bool ok = fread(ref, sizeof *ref, 1, in) == 1;
    ref->L = NULL;
    if (ok) {
        const size_t n = 3 * (size_t)ref->width * (size_t)ref->height;
        ref->L = bis_alloc(n, sizeof *ref->L);
        ok = ref->L && fread(ref->L, sizeof *ref->L, n, in) == n;
    }
    fclose(in);
    if (!ok) bis_free(ref->L);
    return ok;
}

static void write_reference(const measure_reference *ref, const char *name)
{
    bis_diag diag = {0};
    bis_outfile *f;

    measure_check(bis_outfile_open(&f, name, &diag), &diag);
    fwrite(ref, sizeof *ref, 1, bis_outfile_stream(f));
    fwrite(ref->L, sizeof *ref->L, 3 * (size_t)ref->width * (size_t)ref->height, bis_outfile_stream(f));
    measure_check(bis_outfile_commit(f, &diag), &diag);
}

measure_reference measure_reference_get(const char *path, const char *material, double seconds)
{
    measure_reference ref;
    char name[64];

    snprintf(
        name, sizeof name, REFERENCE_FOLDER "/%016llx", (unsigned long long)reference_key(path, material, seconds));
    if (read_reference(&ref, name)) return ref;
    if (mkdir(REFERENCE_FOLDER, 0777) != 0 && errno != EEXIST) give_up("cannot make", REFERENCE_FOLDER);
    ref = make_reference(path, material, seconds);
    write_reference(&ref, name);
    return ref;
}

void measure_reference_free(measure_reference *ref)
{
    bis_free(ref->L);
    ref->L = NULL;
}
