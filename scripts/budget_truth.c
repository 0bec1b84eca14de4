/* budget_truth: does `--error E` keep its word? Renders a scene many times with an error budget, each with a seed of
 * its own, and holds the true error of each picture against E, by a reference of many more samples. For
 * scripts/budget_truth.sh; the shorter version is tests/test_budgets.c.
 *
 *     budget_truth [--adaptive] RUNS WxH REFERENCE_SPP E SCENE
 *
 * prints one row of docs/budgets.md: scene, E, runs, mean camera samples a pixel, mean true error over E, share of runs
 * with a true error of at most E, of runs below E/2 among those that needed more than the minimum of passes, and the
 * bias of the mean picture (over E), with its standard error. */
#include "bis/mem.h"
#include "bis/render.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MINIMUM = 4 };

typedef struct truth {
    bis_scene_desc *desc;
    bis_scene *scene;
    bis_film reference;
    double floor; /* m^2/100 of relMSE */
} truth;

static bis_status render(bis_film *film, bis_render_result *result, const truth *t, const bis_budget *budget, bis_diag *diag)
{
    const bis_film_desc *f = &t->desc->film;
    const bis_render_options options = {.budget = *budget, .n_threads = 1}; /* small pictures */
    bis_status status = bis_film_init(film, f->width, f->height, f->crop, (bis_loc){0}, diag);
    return status ? status : bis_render(result, film, t->scene, t->desc, &options, diag);
}

static size_t values_of(const bis_film *f) { return 3 * (size_t)f->width * (size_t)f->height; }

static bis_status make_reference(truth *t, uint32_t spp, bis_diag *diag)
{
    const bool adaptive = t->desc->adaptive;
    bis_render_result result;
    double mean = 0;

    t->desc->adaptive = false;
    t->desc->sampler.seed = 1000000;
    bis_scene_set_spp(t->desc, spp);
    bis_status status = render(&t->reference, &result, t, &(bis_budget){.spp = spp}, diag);
    t->desc->adaptive = adaptive;
    if (status) return status;
    for (size_t i = 0; i < values_of(&t->reference); i++) mean += t->reference.sum[i] / t->reference.passes;
    mean /= (double)values_of(&t->reference);
    t->floor = mean * mean / 100;
    return BIS_OK;
}

/* Root of relMSE against the reference; *bias: mean of (a-b)/sqrt(b^2 + floor). */
static double true_error(const truth *t, const bis_film *f, double *bias)
{
    double sum = 0;
    const size_t n = values_of(f);

    *bias = 0;
    for (size_t i = 0; i < n; i++) {
        double b = t->reference.sum[i] / t->reference.passes, d = f->sum[i] / f->passes - b, scale = b * b + t->floor;
        sum += d * d / scale;
        *bias += d / sqrt(scale);
    }
    *bias /= (double)n;
    return sqrt(sum / (double)n);
}

static bis_status measure(truth *t, const char *name, double E, unsigned runs, bis_diag *diag)
{
    double spp = 0, ratio = 0, bias = 0, squares = 0;
    unsigned kept = 0, needed_more = 0, wasted = 0;

    for (unsigned i = 0; i < runs; i++) {
        bis_film film = {0};
        bis_render_result result;
        double b;
        t->desc->sampler.seed = i + 1;
        bis_status status = render(&film, &result, t, &(bis_budget){.error = E}, diag);
        if (status) return status;
        double error = true_error(t, &film, &b);
        bool more = result.passes > MINIMUM;
        spp += (double)result.spp / runs;
        ratio += error / E / runs;
        bias += b / runs;
        squares += b * b;
        kept += error <= E;
        needed_more += more;
        wasted += more && error < E / 2;
        bis_film_clear(&film);
    }
    double se = sqrt(fmax(0, squares / runs - bias * bias) / (runs - 1.0));
    printf("| %s%s | %g | %u | %.0f | %.2f | %.0f%% | %.0f%% of %u | %+.3f +- %.3f |\n", name, t->desc->adaptive ? ", adaptive" : "", E, runs, spp, ratio,
           100.0 * kept / runs, needed_more ? 100.0 * wasted / needed_more : 0, needed_more, bias / E, se / E);
    fflush(stdout);
    return BIS_OK;
}

static const char *base_name(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

int main(int argc, char **argv)
{
    truth t = {0};
    bis_diag diag = {0};
    bool adaptive = argc > 1 && strcmp(argv[1], "--adaptive") == 0;
    int width, height;

    argv += adaptive;
    if (argc - adaptive != 6 || sscanf(argv[2], "%dx%d", &width, &height) != 2) {
        fprintf(stderr, "usage: budget_truth [--adaptive] RUNS WxH REFERENCE_SPP E SCENE\n");
        return 2;
    }
    bis_status status = bis_scene_parse(&t.desc, argv[5], &diag);
    if (status) goto done;
    t.desc->film.width = width;
    t.desc->film.height = height;
    t.desc->adaptive = adaptive;
    status = bis_scene_build(&t.scene, t.desc, &diag);
    if (!status) status = make_reference(&t, (uint32_t)strtoul(argv[3], NULL, 10), &diag);
    if (!status) status = measure(&t, base_name(argv[5]), strtod(argv[4], NULL), (unsigned)strtoul(argv[1], NULL, 10), &diag);
done:
    for (size_t i = 0; i < diag.n; i++)
        if (diag.messages[i].is_error) fprintf(stderr, "%s\n", diag.messages[i].text);
    bis_diag_clear(&diag);
    bis_film_clear(&t.reference);
    bis_scene_free(t.scene);
    bis_scene_desc_free(t.desc);
    return status ? 1 : 0;
}
