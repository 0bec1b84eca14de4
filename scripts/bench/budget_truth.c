/* budget_truth: does `--error E` keep its word? Renders a scene many times with an error budget, each with a seed of
 * its own, and holds the true error of each picture against E. For scripts/bench/budget_truth.sh; the shorter version
 * is tests/render/test_budgets.c.
 *
 *     budget_truth [--adaptive] NAME RUNS E REFERENCE_A REFERENCE_B SCENE
 *
 * The references are two pictures of the scene with seeds of their own, by many more samples; their mean is the truth,
 * half their difference tells its noise. The renders have their size. Prints one row of docs/budgets.md: name, E, runs,
 * mean camera samples a pixel, mean true error over E, share of runs with a true error of at most E, of runs below E/2
 * among those that needed more than the minimum of passes, and, all over E:
 * - the bias of the picture's mean, with its standard error;
 * - the bias of a pixel (root mean square): an upper 95% bound;
 * - the noise of the truth.
 *
 * With d_i the relative error of run i in one value, the squared bias of that value is E d_i d_j, i != j, whose mean
 * over all pairs is ((sum d)^2 - sum d^2) / (R (R - 1)): no noise of runs is in it, that of the truth is taken off. Its
 * standard error is the jackknife's, over runs, so that pixels may err together. */
#include "bis/files/image_file.h"
#include "bis/base/mem.h"
#include "bis/render/render.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MINIMUM = 4 };

typedef struct truth {
    int width, height;
    size_t n;              /* values: three a pixel */
    double *value, *scale; /* scale: sqrt(value^2 + m^2/100), of relMSE */
    double noise;          /* relative, root mean square over values */
    double mean_noise;     /* standard error of the mean relative value */
} truth;

typedef struct tally {
    unsigned kept, needed_more, wasted;
    double spp, error; /* sums over runs */
    double *d;         /* d[runs][n]: relative errors */
} tally;

/* ---- the truth ---- */

static double value_of(const bis_image *image, size_t i)
{
    const rgb c = image->pixels[i / 3];
    return (double)(i % 3 == 0 ? c.r : i % 3 == 1 ? c.g : c.b);
}

static bis_status combine(truth *t, const bis_image *a, const bis_image *b, const char *path, bis_diag *diag)
{
    const size_t n_pixels = (size_t)a->width * (size_t)a->height;
    double mean = 0;

    if (a->width != b->width || a->height != b->height) {
        return bis_error(diag, BIS_INPUT, (bis_loc){path, 0, 0}, "%d x %d pixels, the first reference has %d x %d", b->width, b->height, a->width, a->height);
    }
    *t = (truth){.width = a->width, .height = a->height, .n = 3 * n_pixels};
    t->value = bis_alloc(t->n, sizeof *t->value);
    t->scale = bis_alloc(t->n, sizeof *t->scale);
    if (!t->value || !t->scale) return bis_error(diag, BIS_NOMEM, (bis_loc){path, 0, 0}, "no memory for the reference");
    for (size_t i = 0; i < t->n; i++) t->value[i] = 0.5 * (value_of(a, i) + value_of(b, i));
    for (size_t i = 0; i < t->n; i++) mean += t->value[i] / (double)t->n;
    for (size_t i = 0; i < t->n; i++) t->scale[i] = sqrt(t->value[i] * t->value[i] + mean * mean / 100);
    for (size_t pixel = 0; pixel < n_pixels; pixel++) {
        double sum = 0;
        for (size_t i = 3 * pixel; i < 3 * pixel + 3; i++) {
            const double d = 0.5 * (value_of(a, i) - value_of(b, i)) / t->scale[i];
            t->noise += d * d;
            sum += d;
        }
        t->mean_noise += sum * sum;
    }
    t->noise = sqrt(t->noise / (double)t->n);
    t->mean_noise = sqrt(t->mean_noise) / (double)t->n;
    return BIS_OK;
}

static bis_status read_truth(truth *t, char **paths, bis_diag *diag)
{
    bis_image a = {0}, b = {0};
    bis_status status = bis_image_read(&a, paths[0], (bis_loc){0}, diag);

    if (!status) status = bis_image_read(&b, paths[1], (bis_loc){0}, diag);
    if (!status) status = combine(t, &a, &b, paths[1], diag);
    bis_image_clear(&a);
    bis_image_clear(&b);
    return status;
}

/* ---- the runs ---- */

static void count(tally *sum, const truth *t, const bis_film *f, const bis_render_result *result, double E, double *d)
{
    const bool more = result->passes > MINIMUM;
    double squares = 0;

    for (size_t i = 0; i < t->n; i++) {
        d[i] = (f->sum[i] / f->weight - t->value[i]) / t->scale[i];
        squares += d[i] * d[i];
    }
    const double error = sqrt(squares / (double)t->n);
    sum->spp += (double)result->spp;
    sum->error += error;
    sum->kept += error <= E;
    sum->needed_more += more;
    sum->wasted += more && error < E / 2;
}

static bis_status render_runs(tally *sum, const truth *t, bis_scene_desc *desc, double E, unsigned runs, bis_diag *diag)
{
    const bis_render_options options = {.budget = {.error = E}, .n_threads = 1}; /* small pictures */
    bis_scene *scene;
    bis_status status = bis_scene_build(&scene, desc, diag);

    for (unsigned i = 0; i < runs && !status; i++) {
        bis_film film;
        bis_render_result result;
        desc->view.sampler.seed = i + 1;
        status = bis_film_init(&film, t->width, t->height, desc->view.film.crop, (bis_loc){0}, diag);
        if (status) break;
        status = bis_render(&result, &film, scene, desc, &desc->view, &options, diag);
        if (!status) count(sum, t, &film, &result, E, sum->d + i * t->n);
        bis_film_clear(&film);
    }
    bis_scene_free(scene);
    return status;
}

/* ---- what they come to ---- */

/* Of the mean over all values. */
static double mean_bias(double *se, const tally *sum, const truth *t, unsigned runs)
{
    double total = 0, squares = 0;

    for (unsigned i = 0; i < runs; i++) {
        double mean = 0;
        for (size_t k = 0; k < t->n; k++) mean += sum->d[i * t->n + k] / (double)t->n;
        total += mean;
        squares += mean * mean;
    }
    const double bias = total / runs;
    *se = sqrt(fmax(0, squares / runs - bias * bias) / (runs - 1.0) + t->mean_noise * t->mean_noise);
    return bias;
}

/* The mean over values of sum_{i != j} d_i d_j, over those runs but one; `one` = runs: over all. */
static double pairs(const double *with_all, const double *self, unsigned one, unsigned runs, double total, double squares)
{
    if (one == runs) return (total - squares) / (runs * (runs - 1.0));
    return (total - 2 * with_all[one] + 2 * self[one] - squares) / ((runs - 1.0) * (runs - 2.0));
}

/* An upper 95% bound of the root mean square over values of their bias. NAN: out of memory. */
static double pixel_bias(const tally *sum, const truth *t, unsigned runs)
{
    double *all = bis_alloc(t->n, sizeof *all);                   /* sum over runs of d */
    double *with_all = bis_alloc(2 * (size_t)runs, sizeof *with_all), *self = with_all + runs; /* d_i . all, d_i . d_i, over n */
    double total = 0, squares = 0, mean = 0, scatter = 0, bound = (double)NAN;

    if (!all || !with_all) goto done;
    for (unsigned i = 0; i < runs; i++)
        for (size_t k = 0; k < t->n; k++) all[k] += sum->d[i * t->n + k];
    for (unsigned i = 0; i < runs; i++) {
        for (size_t k = 0; k < t->n; k++) {
            const double d = sum->d[i * t->n + k];
            with_all[i] += d * all[k] / (double)t->n;
            self[i] += d * d / (double)t->n;
        }
        total += with_all[i];
        squares += self[i];
    }
    for (unsigned i = 0; i < runs; i++) mean += pairs(with_all, self, i, runs, total, squares) / runs;
    for (unsigned i = 0; i < runs; i++) scatter += pow(pairs(with_all, self, i, runs, total, squares) - mean, 2);
    const double square = pairs(with_all, self, runs, runs, total, squares) - t->noise * t->noise;
    bound = sqrt(fmax(0, square + 1.645 * sqrt(scatter * (runs - 1.0) / runs)));
done:
    bis_free(all);
    bis_free(with_all);
    return bound;
}

static void print_row(const char *name, const tally *sum, const truth *t, double E, unsigned runs)
{
    double se;
    const double bias = mean_bias(&se, sum, t, runs);

    printf("| %s | %g | %u | %.0f | %.2f | %.0f%% | %.0f%% of %u | %+.3f +- %.3f | %.3f | %.3f |\n", name, E, runs, sum->spp / runs, sum->error / runs / E,
           100.0 * sum->kept / runs, sum->needed_more ? 100.0 * sum->wasted / sum->needed_more : 0, sum->needed_more, bias / E, se / E,
           pixel_bias(sum, t, runs) / E, t->noise / E);
}

int main(int argc, char **argv)
{
    truth t = {0};
    tally sum = {0};
    bis_scene_desc *desc = NULL;
    bis_diag diag = {0};
    const bool adaptive = argc > 1 && strcmp(argv[1], "--adaptive") == 0;

    argv += adaptive;
    const unsigned runs = argc - adaptive == 7 ? (unsigned)strtoul(argv[2], NULL, 10) : 0;
    if (runs < 3) {
        fprintf(stderr, "usage: budget_truth [--adaptive] NAME RUNS E REFERENCE_A REFERENCE_B SCENE, three runs or more\n");
        return 2;
    }
    const double E = strtod(argv[3], NULL);
    bis_status status = read_truth(&t, argv + 4, &diag);
    if (!status) status = bis_scene_parse(&desc, argv[6], &diag);
    if (status) goto done;
    desc->view.film.width = t.width;
    desc->view.film.height = t.height;
    desc->view.adaptive = adaptive;
    sum.d = bis_alloc(runs * t.n, sizeof *sum.d);
    status = sum.d ? render_runs(&sum, &t, desc, E, runs, &diag) : BIS_NOMEM;
    if (!status) print_row(argv[1], &sum, &t, E, runs);
done:
    for (size_t i = 0; i < diag.n; i++)
        if (diag.messages[i].is_error) fprintf(stderr, "%s\n", diag.messages[i].text);
    bis_diag_clear(&diag);
    bis_free(sum.d);
    bis_free(t.value);
    bis_free(t.scale);
    bis_scene_desc_free(desc);
    return status ? 1 : 0;
}
