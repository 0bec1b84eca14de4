/* SPDX-License-Identifier: BSD-2-Clause */
/* agree: do all integrators give the same picture?
 *
 *     agree [--replicates R] [--reference exact|mis] [--reference-replicates Q] [--resolution WxH] [--alpha A] SCENE...
 *
 * For each scene each unbiased setting of each integrator is rendered R (16) times with different seeds, and a
 * reference (`exact`; with --reference mis a long mis) Q (4) times, all through the centres of the same pixels. The
 * mean over the image and over each of 4 x 4 tiles must agree in R, G and B: Welch's t with standard errors from the R
 * independent renders, Sidak-corrected over all tests of the run.
 *
 * A standard error says nothing where the energy lies in samples that have hardly been drawn: the BRDF alone under a
 * pinpoint light. So a mean is tested only if its largest possible sample (the proposal's bound, thesis 4.3) would
 * change it by less than 2%; this is known before anything is drawn. What cannot be tested at this cost is named, not
 * passed. Exit status 1 where a test fails. */
#include "bis/base/mem.h"
#include "bis/render/render.h"
#include "bis/base/stats.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TILES = 4, CELLS = TILES * TILES + 1, CHANNELS = 3, VALUES = CELLS * CHANNELS };

typedef struct estimate {
    double mean[VALUES], se[VALUES];
    double samples[CELLS]; /* directions drawn for each mean, in all renders together; for sir: candidates */
    double bound;          /* no sample of r+g+b is larger */
} estimate;

enum { SAMPLES = 32, CANDIDATES_M = 256, SPP = 4 };

typedef struct candidate {
    const char *name, *integrator;
    bis_proposal proposal;
    bis_resampling resampling;
    bis_estimator estimator;
    bis_heuristic heuristic;
    bool stratify, compensate, one_by_one, learn;
} candidate;

/* Every unbiased setting. rejection "ratio" has an O(1/M) bias and is not among them. */
static const candidate CANDIDATES[] = {
    {.name = "em", .integrator = "em"},
    {.name = "brdf", .integrator = "brdf"},
    {.name = "mis balance", .integrator = "mis"},
    {.name = "mis power", .integrator = "mis", .heuristic = BIS_HEURISTIC_POWER},
    {.name = "em stratified", .integrator = "em", .stratify = true},
    {.name = "mis stratified", .integrator = "mis", .stratify = true},
    {.name = "mis compensated", .integrator = "mis", .compensate = true},
    {.name = "rejection plain em", .integrator = "rejection", .estimator = BIS_ESTIMATOR_PLAIN,
     .proposal = BIS_PROPOSAL_EM},
    {.name = "rejection plain brdf", .integrator = "rejection", .estimator = BIS_ESTIMATOR_PLAIN,
     .proposal = BIS_PROPOSAL_BRDF},
    {.name = "rejection plain choose", .integrator = "rejection", .estimator = BIS_ESTIMATOR_PLAIN,
     .proposal = BIS_PROPOSAL_CHOOSE},
    {.name = "sir em", .integrator = "sir", .proposal = BIS_PROPOSAL_EM, .stratify = true},
    {.name = "sir brdf", .integrator = "sir", .proposal = BIS_PROPOSAL_BRDF, .stratify = true},
    {.name = "sir mix", .integrator = "sir", .proposal = BIS_PROPOSAL_MIX, .stratify = true},
    {.name = "sir product", .integrator = "sir", .proposal = BIS_PROPOSAL_PRODUCT, .stratify = true},
    {.name = "sir product learned", .integrator = "sir", .proposal = BIS_PROPOSAL_PRODUCT, .stratify = true,
     .learn = true},
    {.name = "sir mix independent", .integrator = "sir", .proposal = BIS_PROPOSAL_MIX},
    {.name = "sir mix multinomial", .integrator = "sir", .proposal = BIS_PROPOSAL_MIX, .stratify = true,
     .resampling = BIS_RESAMPLING_MULTINOMIAL},
    {.name = "sir em independent multinomial", .integrator = "sir", .proposal = BIS_PROPOSAL_EM,
     .resampling = BIS_RESAMPLING_MULTINOMIAL},
};
enum { N_CANDIDATES = sizeof CANDIDATES / sizeof *CANDIDATES };

typedef struct options {
    unsigned replicates, reference_replicates;
    int width, height;
    double alpha;
    const char *reference;
} options;

static void print_diag(bis_diag *diag)
{
    for (size_t i = 0; i < diag->n; i++)
        if (diag->messages[i].is_error) fprintf(stderr, "%s\n", diag->messages[i].text);
    bis_diag_clear(diag);
}

/* Mean of the image (cell 0) and of each tile, per channel, of one film. */
static void cell_means(const bis_film *film, double value[VALUES])
{
    double pixels[CELLS] = {0};
    memset(value, 0, VALUES * sizeof *value);
    for (int y = 0; y < film->height; y++)
        for (int x = 0; x < film->width; x++) {
            int cell = 1 + y * TILES / film->height * TILES + x * TILES / film->width;
            const double *sum = film->sum + 3 * ((size_t)y * (size_t)film->width + (size_t)x);
            pixels[0]++, pixels[cell]++;
            for (int c = 0; c < CHANNELS; c++) {
                value[c] += sum[c] / film->weight;
                value[cell * CHANNELS + c] += sum[c] / film->weight;
            }
        }
    for (int i = 0; i < VALUES; i++) value[i] /= pixels[i / CHANNELS] > 0 ? pixels[i / CHANNELS] : 1;
}

/* The largest F/q that the proposals of these settings can give, over all materials at normal incidence (figure 4.4); a
 * mixture is bounded by twice the smaller of its two. */
static double largest_sample(const bis_scene *scene, const bis_scene_desc *desc, const candidate *c)
{
    bool em = strcmp(c->integrator, "em") == 0, brdf = strcmp(c->integrator, "brdf") == 0;
    double bound = 0;
    if (strcmp(c->integrator, "sir") == 0 || strcmp(c->integrator, "rejection") == 0) {
        em = c->proposal == BIS_PROPOSAL_EM;
        brdf = c->proposal == BIS_PROPOSAL_BRDF;
    }
    for (size_t i = 0; i < desc->n_materials; i++) {
        const vec3 n = {0, 0, 1};
        bis_bsdf b;
        bis_bsdf_init(&b, &desc->materials[i], n, n);
        if (bis_bsdf_is_black(&b)) continue;
        double c_em = bis_bsdf_max_f_cos(&b) * bis_light_power(scene->light),
               c_brdf = bis_bsdf_max_ratio(&b) * bis_light_max_intensity(scene->light);
        bound = fmax(bound, em ? c_em : brdf ? c_brdf : 2 * fmin(c_em, c_brdf));
    }
    return bound;
}

/* Means and standard errors over independent renders. Renders with an own seed each; two passes over nothing:
 * Welford. */
static bis_status measure(estimate *e, bis_scene_desc *desc, const candidate *c, unsigned replicates, uint64_t seed,
    uint32_t spp, bis_diag *diag)
{
    bis_scene *scene = NULL;
    bis_film film = {0};
    double value[VALUES], m2[VALUES] = {0};
    bis_status status = bis_scene_build(&scene, desc, diag);
    if (status) goto done;
    status =
        bis_film_init(&film, desc->view.film.width, desc->view.film.height, desc->view.film.crop, (bis_loc){0}, diag);
    if (status) goto done;
    memset(e, 0, sizeof *e);
    if (c) {
        bool sampled = desc->view.settings.integrator == &bis_em || desc->view.settings.integrator == &bis_brdf ||
                       desc->view.settings.integrator == &bis_mis;
        e->bound = largest_sample(scene, desc, c);
        for (int cell = 0; cell < CELLS; cell++)
            e->samples[cell] = (double)(film.width * film.height) / (cell ? TILES * TILES : 1) * replicates * spp *
                               (sampled ? SAMPLES : CANDIDATES_M);
    }
    for (unsigned r = 0; r < replicates; r++) {
        bis_render_options ro = {.budget.spp = spp};
        bis_render_result result;
        desc->view.sampler.seed = seed + r;
        bis_film_clear(&film);
        status = bis_film_init(
            &film, desc->view.film.width, desc->view.film.height, desc->view.film.crop, (bis_loc){0}, diag);
        if (!status) status = bis_render(&result, &film, scene, &desc->view, &ro, diag);
        if (status) goto done;
        cell_means(&film, value);
        for (int i = 0; i < VALUES; i++) {
            double delta = value[i] - e->mean[i];
            e->mean[i] += delta / (r + 1);
            m2[i] += delta * (value[i] - e->mean[i]);
        }
    }
    for (int i = 0; i < VALUES; i++) e->se[i] = sqrt(m2[i] / (replicates - 1) / replicates);
done:
    bis_film_clear(&film);
    bis_scene_free(scene);
    return status;
}

static void configure(bis_scene_desc *desc, const candidate *c)
{
    bis_settings s = bis_settings_default(bis_integrator_find(c->integrator));
    s.proposal = c->proposal;
    s.resampling = c->resampling;
    s.estimator = c->estimator;
    s.heuristic = c->heuristic;
    s.stratify = c->stratify;
    s.compensate = c->compensate;
    s.learn = c->learn;
    s.samples = SAMPLES;
    s.candidates = CANDIDATES_M;
    s.shadowrays = 8;
    desc->view.settings = s;
}

/* Welch's t-test of one value; both exact (se 0, as where all is background): they must be equal to rounding of the
 * sums. */
static double p_value(const estimate *a, unsigned n_a, const estimate *b, unsigned n_b, int i)
{
    double va = a->se[i] * a->se[i], vb = b->se[i] * b->se[i], d = a->mean[i] - b->mean[i];
    double rounding =
        1e-6 * fabs(b->mean[i]); /* float radiance: 2^-24 a sample, summed; far below any standard error here */
    if (sqrt(va + vb) <= rounding) return fabs(d) <= 4 * rounding ? 1 : 0;
    double dof = (va + vb) * (va + vb) / (va * va / (n_a - 1) + vb * vb / (n_b - 1));
    return bis_stats_student_p(d / sqrt(va + vb), dof);
}

static int test_scene(const char *path, const options *o, double alpha_each)
{
    bis_diag diag = {0};
    bis_scene_desc *desc = NULL;
    estimate reference, e;
    int failures = 0;

    if (bis_scene_parse(&desc, path, &diag)) goto fail;
    desc->view.pixel_jitter = false;
    desc->view.film.width = o->width;
    desc->view.film.height = o->height;
    desc->view.film.crop[0] = desc->view.film.crop[2] = 0;
    desc->view.film.crop[1] = desc->view.film.crop[3] = 1;

    bool exact = strcmp(o->reference, "exact") == 0;
    desc->view.settings = bis_settings_default(bis_integrator_find(o->reference));
    desc->view.settings.samples = 1024;
    if (measure(&reference, desc, NULL, o->reference_replicates, 1000, exact ? 1 : 16, &diag)) goto fail;
    printf("%s  mean %.5g %.5g %.5g +- %.1e (%s)\n", path, reference.mean[0], reference.mean[1], reference.mean[2],
        reference.se[0], o->reference);
    fflush(stdout);

    for (int k = 0; k < N_CANDIDATES; k++) {
        configure(desc, &CANDIDATES[k]);
        if (measure(&e, desc, &CANDIDATES[k], o->replicates, 2000 + 100 * (uint64_t)k, SPP, &diag)) goto fail;
        double p = 1, relative_se = 0;
        int worst = 0, untested = 0;
        for (int cell = 0; cell < CELLS; cell++) {
            const double *mean = &reference.mean[cell * CHANNELS];
            if (e.bound / e.samples[cell] > 0.02 * (mean[0] + mean[1] + mean[2])) {
                untested++;
                continue;
            }
            for (int i = cell * CHANNELS; i < (cell + 1) * CHANNELS; i++) {
                double pi = p_value(&e, o->replicates, &reference, o->reference_replicates, i);
                if (pi < p) p = pi, worst = i;
            }
        }
        for (int c = 0; c < CHANNELS; c++)
            if (reference.mean[c] > 0) relative_se = fmax(relative_se, e.se[c] / reference.mean[c]);
        const char *verdict = p < alpha_each ? "DIFFERS" : untested == CELLS ? "not testable at this cost" : "agrees";
        failures += verdict[0] == 'D';
        printf("    %-32s smallest p %.2e (%s %d, %+.2f%%)  se of the mean %.3f%%  %s", CANDIDATES[k].name, p,
            worst < 3 ? "image" : "tile", worst / 3,
            reference.mean[worst] != 0 ? 100 * (e.mean[worst] / reference.mean[worst] - 1) : 0, 100 * relative_se,
            verdict);
        if (untested > 0 && untested < CELLS)
            printf(", %d of %d tiles not testable at this cost", untested, TILES * TILES);
        printf("\n");
        fflush(stdout);
    }
    print_diag(&diag);
    bis_scene_desc_free(desc);
    return failures;
fail:
    print_diag(&diag);
    bis_scene_desc_free(desc);
    return 1;
}

int main(int argc, char **argv)
{
    options o = {
        .replicates = 16, .reference_replicates = 4, .width = 16, .height = 12, .alpha = 0.01, .reference = "exact"};
    int i = 1, failures = 0;
    for (; i + 1 < argc && argv[i][0] == '-'; i += 2) {
        if (!strcmp(argv[i], "--replicates")) o.replicates = (unsigned)atoi(argv[i + 1]);
        else if (!strcmp(argv[i], "--reference-replicates")) o.reference_replicates = (unsigned)atoi(argv[i + 1]);
        else if (!strcmp(argv[i], "--resolution")) sscanf(argv[i + 1], "%dx%d", &o.width, &o.height);
        else if (!strcmp(argv[i], "--alpha")) o.alpha = atof(argv[i + 1]);
        else if (!strcmp(argv[i], "--reference")) o.reference = argv[i + 1];
        else break;
    }
    if (i >= argc || argv[i][0] == '-' || o.replicates < 2 || o.reference_replicates < 2 || o.width < TILES ||
        o.height < TILES) {
        fprintf(stderr, "usage: agree [--replicates R] [--reference exact|mis] [--reference-replicates Q] "
                        "[--resolution WxH] [--alpha A] SCENE...\n");
        return 2;
    }
    int tests = (argc - i) * N_CANDIDATES * VALUES;
    double alpha_each = bis_stats_sidak(o.alpha, (double)tests);
    printf("%d tests, family-wise significance %g, each at p < %.2e\n", tests, o.alpha, alpha_each);
    for (; i < argc; i++) failures += test_scene(argv[i], &o, alpha_each);
    printf("%d pairs differ\n", failures);
    return failures > 0;
}
