/* auto: the pilot. What minimises cost x variance is measured on the scene itself, in 4% of the time that the render
 * will take, or in some hundredths of a second.
 *
 * Every k-th pixel of the same view is rendered (bis_render with a footprint of 1/k) with each of a short list of
 * settings, in replicates of one or two passes with seeds of their own. Three rounds: two replicates each; two more
 * for the families (em or brdf where they are safe, mis, sir by mixture, sir by product) whose best is within
 * `behind` of the best of all; then cost and variance of each such family are fitted, the M and N that minimise
 * their product (auto_fit.c) are tried, too, and the least measured product wins: the fit proposes, the measurement
 * decides.
 *
 * Cost: processor seconds, the least of the replicates, since whatever disturbs only adds. What a pass costs at any
 * size (pools, clusters) is told apart by a picture of one pixel: cost = fill + (pixels of the picture)/(pixels of
 * the pilot) (time - fill).
 *
 * Variance: relMSE of SPEC 5 over the pixels that show a surface, the scatter of the replicates in place of the
 * error, and in place of the reference the mean of all that was rendered, weighted by 1/variance (a median would
 * come out too low where most methods miss a highlight, and blame those that find it). Of the pixels' values the
 * mean is taken in nine groups, and of these the mean, with the largest replaced by the second largest: one firefly
 * in the pilot is forgiven, two are not. (The median of the groups, more robust, forgives so many that a method
 * which makes nothing but fireflies looks like the best: nine times too long on data/scenes/glossy-row.txt. To
 * reject a good method for its bad luck costs far less.) The figure is biased low for a method whose error is in
 * fewer than about one sample in a thousand, which no pilot can tell from a good one; hence `unseen`, by which all
 * is multiplied that comes from mis or em.
 *
 * Two passes in a replicate know what a stratified camera makes of the noise of the pixel's area, or half of it.
 * "learn" is not tried: it needs more passes than a pilot has. */
#include "auto.h"

#include "auto_fit.h"

#include "bis/clock.h"
#include "bis/mem.h"
#include "bis/rng.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <time.h>

/* Families of settings that differ in M and N alone, and where each is tried first. */
typedef struct family {
    const bis_integrator *integrator;
    bis_proposal proposal;
    bis_auto_limits limits;
    struct {
        uint32_t M, N;
    } first[4], quick; /* ended by N = 0; the one setting of a short list */
} family;

enum { N_FAMILIES = 5, GROUPS = 9, MOST_PASSES = 2, REPLICATES = 2 /* in each of the first two rounds */ };

/* N is not tried beyond 64: a pass should not cost tens of times what it costs by default, whatever the pixel's area
 * is worth. */
static const family families[N_FAMILIES] = {
    {&bis_em, BIS_PROPOSAL_MIX, {0, 0, 2, 64}, {{0, 8}, {0, 48}}, {0, 32}},
    {&bis_brdf, BIS_PROPOSAL_MIX, {0, 0, 2, 64}, {{0, 4}, {0, 24}}, {0, 8}},
    {&bis_mis, BIS_PROPOSAL_MIX, {0, 0, 2, 64}, {{0, 6}, {0, 32}}, {0, 16}},
    {&bis_sir, BIS_PROPOSAL_MIX, {32, 2048, 2, 64}, {{64, 4}, {64, 20}, {256, 8}}, {64, 16}},
    {&bis_sir, BIS_PROPOSAL_PRODUCT, {16, 512, 2, 64}, {{32, 4}, {64, 16}, {192, 6}}, {64, 16}},
};

static const double behind = 2;
static const double share_of_time = 0.04;

/* The pilot's camera samples: with fewer, M and N are not fitted (some five seconds of rendering are then to come,
 * of which little could be saved); more need not be known. */
static const double least_samples = 1.5e5, most_samples = 6e5;

/* And of the short list, which chooses among three at settings that are good everywhere. */
static const double share_of_time_quick = 0.015, least_samples_quick = 8e3, most_samples_quick = 6e4;

/* About how many replicates of how many settings there will be, and camera samples a second where time is all that
 * is known. */
static const double expected_renders = 36, expected_renders_quick = 6, samples_a_second = 2e5;

static const uint64_t purpose_pilot = 0x70696c6f74; /* "pilot" */

typedef struct trial {
    int family, wanted;    /* wanted: replicates in this round */
    bis_status status;
    double *sum, *squares; /* [pixels][3] over replicates */
    double seconds, fill;  /* of a replicate, the least so far: the pilot's film, and a film of one pixel */
} trial;

typedef struct pilot {
    const bis_scene *scene;
    bis_scene_desc desc; /* a shallow copy, with the pilot's film and sampler; each replicate makes its own of it */
    bis_settings base;   /* what was asked for */
    bis_render_options options;
    int n_threads;
    bool is_quick;       /* the short list */
    uint32_t passes;     /* of a replicate */
    double scale;        /* pixels of the picture : pixels of the pilot */
    size_t n_values;     /* 3 a pixel */
    double *picture;     /* [n_values] the mean of all trials */
    bool *shaded;        /* [n_values / 3] has been seen to show a surface: the others are the same with any setting */
    trial trials[BIS_AUTO_MOST_TRIED];
    bis_auto_report *report;
} pilot;

static bis_status no_memory(const bis_scene_desc *desc, bis_diag *diag)
{
    return bis_error(diag, BIS_NOMEM, desc->integrator_loc,
                     "no memory for the pilot of integrator \"auto\"; a fixed integrator needs none");
}

/* ---- one replicate ---- */

/* Of this thread: a render of one thread takes no other, and no other's waiting is counted. */
static double processor_seconds(void)
{
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static bool is_interrupted(const pilot *p) { return p->options.interrupted && *p->options.interrupted; }

/* Into *film, which is initialised here; *seconds: lowered to what this took. No diag: several threads do this. */
static bis_status render(bis_film *film, double *seconds, const pilot *p, const bis_scene_desc *desc)
{
    const bis_film_desc *f = &desc->film;
    bis_render_result result;
    bis_status status = bis_film_init(film, f->width, f->height, f->crop, (bis_loc){0}, NULL);
    const double start = processor_seconds();

    if (!status) status = bis_render(&result, film, p->scene, desc, &p->options, NULL);
    *seconds = fmin(*seconds, processor_seconds() - start);
    return status;
}

static bis_status render_one_pixel(double *seconds, const pilot *p, const bis_scene_desc *desc)
{
    bis_scene_desc small = *desc;
    bis_film film;

    small.film = (bis_film_desc){.width = 1, .height = 1, .crop = {0, 1, 0, 1}};
    bis_status status = render(&film, seconds, p, &small);
    bis_film_clear(&film);
    return status;
}

static bis_status replicate(pilot *p, int i)
{
    bis_auto_tried *tried = &p->report->tried[i];
    trial *t = &p->trials[i];
    bis_scene_desc desc = p->desc;
    bis_film film;
    bis_rng rng;

    /* The same camera rays with all settings: what they do to pixels is no difference. */
    bis_rng_init(&rng, p->desc.sampler.seed, (uint64_t)tried->replicates, 0, purpose_pilot);
    desc.sampler.seed = bis_rng_u64(&rng);
    desc.settings = tried->settings;
    bis_status status = render(&film, &t->seconds, p, &desc);
    if (!status && tried->replicates < REPLICATES) status = render_one_pixel(&t->fill, p, &desc);
    if (status || is_interrupted(p)) goto done;
    for (size_t k = 0; k < p->n_values; k++) {
        const double x = film.sum[k] / p->passes;
        t->sum[k] += x;
        t->squares[k] += x * x;
        if (i == 0) p->shaded[k / 3] |= film.hits[k / 3] > 0;
    }
    tried->replicates++;
done:
    bis_film_clear(&film);
    return status;
}

/* All replicates that are wanted, by as many threads as there are, each setting by one: what it costs is then what that
 * thread took. (Threads that wait for each other in one render would be counted as if they worked.) */
static bis_status replicates(pilot *p, bis_diag *diag)
{
    const int n = p->report->n_tried;

#pragma omp parallel for schedule(dynamic) num_threads(p->n_threads)
    for (int i = 0; i < n; i++) {
        trial *t = &p->trials[i];
        while (t->wanted > 0 && !t->status && !is_interrupted(p)) {
            t->status = replicate(p, i);
            t->wanted--;
        }
    }
    for (int i = 0; i < n; i++)
        if (p->trials[i].status) return no_memory(&p->desc, diag);
    return BIS_OK;
}

/* ---- the figures ---- */

static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The mean of all that was rendered, each setting weighted by 1/variance as known so far. */
static void make_picture(pilot *p)
{
    const bis_auto_report *r = p->report;
    double weight[BIS_AUTO_MOST_TRIED], total = 0;

    for (int i = 0; i < r->n_tried; i++) {
        const bis_auto_tried *t = &r->tried[i];
        weight[i] = t->variance > 0 ? t->replicates / t->variance : t->replicates;
        total += weight[i];
    }
    for (size_t k = 0; k < p->n_values; k++) {
        p->picture[k] = 0;
        for (int i = 0; i < r->n_tried; i++) {
            p->picture[k] += weight[i] / total * p->trials[i].sum[k] / r->tried[i].replicates;
        }
    }
}

/* relMSE's floor, m^2/100, m the mean of what shows a surface. */
static double floor_of(const pilot *p)
{
    double sum = 0;
    size_t n = 0;
    for (size_t k = 0; k < p->n_values; k++) {
        if (!p->shaded[k / 3]) continue;
        sum += p->picture[k];
        n++;
    }
    return n ? sum / (double)n * (sum / (double)n) / 100 : 0;
}

/* The mean of n >= 1 groups, the largest lowered to the second. */
static double forgiving_mean(double *group, int n)
{
    double sum = 0;

    qsort(group, (size_t)n, sizeof *group, ascending);
    if (n > 1) group[n - 1] = group[n - 2];
    for (int i = 0; i < n; i++) sum += group[i];
    return sum / n;
}

static double variance_of(const pilot *p, int i, double floor)
{
    const double n = p->report->tried[i].replicates;
    const trial *t = &p->trials[i];
    double group[GROUPS] = {0};
    size_t members[GROUPS] = {0};

    for (size_t k = 0; k < p->n_values; k++) {
        if (!p->shaded[k / 3]) continue;
        const size_t g = bis_hash(k / 3) % GROUPS;
        /* fmax: rounding, where all are equal */
        const double scatter = fmax(0, t->squares[k] - t->sum[k] * t->sum[k] / n) / (n - 1);
        members[g]++;
        /* without a floor all is black */
        if (scatter > 0) group[g] += scatter / (p->picture[k] * p->picture[k] + floor);
    }
    int filled = 0;
    for (int g = 0; g < GROUPS; g++)
        if (members[g]) group[filled++] = group[g] / (double)members[g];
    return filled ? p->passes * forgiving_mean(group, filled) : 0;
}

/* Variances and weights follow from each other; three turns settle both. */
static void measure(pilot *p)
{
    enum { TURNS = 3 };

    for (int i = 0; i < p->report->n_tried; i++) {
        const trial *t = &p->trials[i];
        p->report->tried[i].cost = (t->fill + fmax(0, t->seconds - t->fill) * p->scale) / p->passes;
        p->report->tried[i].variance = 0;
    }
    for (int turn = 0; turn < TURNS; turn++) {
        make_picture(p);
        const double floor = floor_of(p);
        for (int i = 0; i < p->report->n_tried; i++) p->report->tried[i].variance = variance_of(p, i, floor);
    }
}

static double product(const bis_auto_tried *t)
{
    const double unseen = 1.25;
    const bool is_suspect = t->settings.integrator == &bis_mis || t->settings.integrator == &bis_em;

    return t->cost * t->variance * (is_suspect ? unseen : 1);
}

/* Of the family, or of all with -1; -1: none was tried. Without any noise the cheapest. */
static int best_of(const pilot *p, int of_family)
{
    const bis_auto_tried *tried = p->report->tried;
    int best = -1;

    for (int i = 0; i < p->report->n_tried; i++) {
        if (of_family >= 0 && p->trials[i].family != of_family) continue;
        const double d = best < 0 ? -1 : product(&tried[i]) - product(&tried[best]);
        if (d < 0 || (d == 0 && tried[i].cost < tried[best].cost)) best = i;
    }
    return best;
}

/* ---- what is tried ---- */

static bis_settings settings_of(const pilot *p, int f, uint32_t M, uint32_t N)
{
    bis_settings s = p->base;

    s.integrator = families[f].integrator;
    s.proposal = families[f].proposal;
    s.only_sir = false;
    s.samples = s.shadowrays = N;
    if (M) s.candidates = M;
    if (s.integrator != &bis_sir) s.stratify = true;
    return s;
}

/* The first of all is the one that tells which pixels show a surface. */
static bis_status try(pilot *p, int f, uint32_t M, uint32_t N, int wanted, bis_diag *diag)
{
    const int i = p->report->n_tried;
    trial *t = &p->trials[i];

    assert(i < BIS_AUTO_MOST_TRIED);
    *t = (trial){.family = f, .wanted = wanted, .seconds = (double)INFINITY, .fill = (double)INFINITY};
    t->sum = bis_alloc(p->n_values, sizeof *t->sum);
    t->squares = bis_alloc(p->n_values, sizeof *t->squares);
    p->report->tried[i] = (bis_auto_tried){.settings = settings_of(p, f, M, N)};
    p->report->n_tried++;
    if (t->sum && t->squares) return BIS_OK;
    return no_memory(&p->desc, diag);
}

static bool is_diffuse(const bis_scene_desc *d)
{
    for (size_t i = 0; i < d->n_shapes; i++)
        if (!rgb_is_black(d->materials[d->shapes[i].material].Ks)) return false;
    return true;
}

/* What a pilot cannot judge is left out: `em` sees a lobe, and `brdf` a lamp, so rarely that a few thousand samples
 * may tell nothing of it (with n = 10 in a hall of small lamps the pilot finds `brdf` 1.5 times as slow as the best;
 * it is 50 to 300 times). So em is for diffuse surfaces, where no sample is worth much more than another, and brdf
 * for a constant light. mis and sir are bounded by the better of the two everywhere. Under a constant light the
 * product is the mixture. */
static bool is_eligible(const pilot *p, int f)
{
    const bool constant = bis_light_is_constant(p->scene->light);

    if (p->base.only_sir && families[f].integrator != &bis_sir) return false;
    if (families[f].integrator == &bis_em) return !constant && is_diffuse(&p->desc);
    if (families[f].integrator == &bis_brdf) return constant;
    return !(constant && families[f].proposal == BIS_PROPOSAL_PRODUCT);
}

static bis_status try_first(pilot *p, bis_diag *diag)
{
    bis_status status = BIS_OK;

    for (int f = 0; f < N_FAMILIES; f++) {
        if (!is_eligible(p, f)) continue;
        if (p->is_quick && !status) status = try(p, f, families[f].quick.M, families[f].quick.N, REPLICATES, diag);
        for (int k = 0; !p->is_quick && k < 4 && families[f].first[k].N && !status; k++) {
            status = try(p, f, families[f].first[k].M, families[f].first[k].N, REPLICATES, diag);
        }
    }
    return status;
}

/* Has the family a chance still? */
static bool is_alive(const pilot *p, int f)
{
    const bis_auto_tried *tried = p->report->tried;
    const int own = best_of(p, f);

    return own >= 0 && product(&tried[own]) <= behind * product(&tried[best_of(p, -1)]);
}

/* M and N of least product by the fit of what was measured. Nothing to fit where there is no noise. */
static bool fitted_optimum(const pilot *p, int f, uint32_t *M, uint32_t *N)
{
    bis_auto_measured m[BIS_AUTO_MOST_TRIED];
    int n = 0;

    for (int i = 0; i < p->report->n_tried; i++) {
        const bis_auto_tried *t = &p->report->tried[i];
        if (p->trials[i].family != f) continue;
        if (!(t->cost > 0 && t->variance > 0)) return false;
        const uint32_t candidates = t->settings.integrator == &bis_sir ? t->settings.candidates : 0;
        m[n++] = (bis_auto_measured){candidates, t->settings.shadowrays, t->cost, t->variance};
    }
    const bis_auto_model cost = bis_auto_fit_cost(m, n), variance = bis_auto_fit_variance(m, n);
    bis_auto_best(M, N, &cost, &variance, &families[f].limits);
    for (int i = 0; i < n; i++)
        if (m[i].M == *M && m[i].N == *N) return false; /* known */
    return true;
}

static bis_status try_optima(pilot *p, bis_diag *diag)
{
    bis_status status = BIS_OK;
    struct {
        bool is_new;
        uint32_t M, N;
    } optimum[N_FAMILIES];

    for (int f = 0; f < N_FAMILIES; f++) {
        optimum[f].is_new = is_alive(p, f) && fitted_optimum(p, f, &optimum[f].M, &optimum[f].N);
    }
    for (int f = 0; f < N_FAMILIES && !status; f++)
        if (optimum[f].is_new) status = try(p, f, optimum[f].M, optimum[f].N, 2 * REPLICATES, diag);
    return status ? status : replicates(p, diag);
}

/* ---- the pilot ---- */

static bis_status run_rounds(pilot *p, bis_diag *diag)
{
    bool alive[N_FAMILIES];
    bis_status status = try_first(p, diag);

    if (!status) status = replicates(p, diag);
    if (status || is_interrupted(p)) return status;
    measure(p);
    p->report->chosen = best_of(p, -1);
    if (p->is_quick) return BIS_OK;
    for (int f = 0; f < N_FAMILIES; f++) alive[f] = is_alive(p, f);
    for (int i = 0; i < p->report->n_tried; i++) p->trials[i].wanted = alive[p->trials[i].family] ? REPLICATES : 0;
    status = replicates(p, diag);
    if (status || is_interrupted(p)) return status;
    measure(p);
    status = try_optima(p, diag);
    if (status || is_interrupted(p)) return status;
    measure(p);
    p->report->chosen = best_of(p, -1);
    return BIS_OK;
}

static double pixels_of(const bis_film_desc *f)
{
    return (double)f->width * f->height * (f->crop[1] - f->crop[0]) * (f->crop[3] - f->crop[2]);
}

/* Camera samples of the whole render, as far as the budget tells; without an --spp, as many as the scene asks for. */
static double samples_to_come(const bis_scene_desc *desc, const bis_render_options *o)
{
    const double by_spp = pixels_of(&desc->film) * (o->budget.spp ? o->budget.spp : desc->sampler.spp);

    if (!(o->budget.seconds > 0)) return by_spp;
    const double by_time = o->budget.seconds * samples_a_second;
    return o->budget.spp ? fmin(by_spp, by_time) : by_time;
}

/* A film k times smaller in each direction, of at most the picture's size. A crop too thin for that is rendered as
 * it is. */
static bis_status make_film(pilot *p, const bis_scene_desc *desc, double pixels, bis_diag *diag)
{
    const bis_film_desc *f = &desc->film;
    const double k = fmax(1, sqrt(pixels_of(f) / pixels));
    const int width = (int)fmax(1, round(f->width / k)), height = (int)fmax(1, round(f->height / k));

    p->options.footprint = 1 / k;
    p->scale = (double)f->width * f->height / ((double)width * height);
    bis_film film;
    bis_status status = bis_film_init(&film, width, height, f->crop, (bis_loc){0}, NULL);
    if (status == BIS_NOMEM) return no_memory(desc, diag);
    if (status == BIS_OK) {
        p->desc.film.width = width;
        p->desc.film.height = height;
    } else {
        p->options.footprint = 0;
        p->scale = 1;
        status = bis_film_init(&film, f->width, f->height, f->crop, desc->integrator_loc, diag);
    }
    p->report->width = film.width;
    p->report->height = film.height;
    p->n_values = 3 * (size_t)film.width * (size_t)film.height;
    bis_film_clear(&film);
    return status;
}

static bis_status make_pilot(pilot *p, const bis_scene_desc *desc, const bis_render_options *options, bis_diag *diag)
{
    const double to_come = samples_to_come(desc, options), samples = fmin(most_samples, share_of_time * to_come);
    const double quick = fmin(most_samples_quick, fmax(least_samples_quick, share_of_time_quick * to_come));
    /* where passes are independent, one camera sample knows nothing of the next */
    const bool independent = desc->adaptive || options->budget.error > 0;
    const uint32_t spp = options->budget.spp ? options->budget.spp : desc->sampler.spp;

    p->is_quick = samples < least_samples;
    p->passes = independent || p->is_quick || spp < MOST_PASSES ? 1 : MOST_PASSES;
    p->desc.adaptive = false;
    p->desc.film.layers = 0;
    bis_scene_set_spp(&p->desc, p->passes);
    const double pixels = p->is_quick ? quick / expected_renders_quick : samples / (expected_renders * p->passes);
    bis_status status = make_film(p, desc, pixels, diag);
    if (status) return status;
    p->n_threads = bis_render_threads(options);
    p->options = (bis_render_options){
        .budget = {.spp = p->passes},
        .n_threads = 1,
        .footprint = p->options.footprint,
        .interrupted = options->interrupted,
    };
    p->picture = bis_alloc(p->n_values, sizeof *p->picture);
    p->shaded = bis_alloc(p->n_values / 3, sizeof *p->shaded);
    if (!p->picture || !p->shaded) return no_memory(desc, diag);
    p->report->passes = (int)p->passes;
    return BIS_OK;
}

bool bis_auto_is_wanted(const bis_settings *s) { return s->integrator == &bis_auto; }

bis_status bis_auto_choose(bis_settings *chosen, bis_auto_report *report, const bis_scene *scene,
                           const bis_scene_desc *desc, const bis_render_options *options, bis_diag *diag)
{
    pilot p = {.scene = scene, .desc = *desc, .base = desc->settings, .report = report};
    const double start = bis_clock_now();
    bis_status status = BIS_OK;

    *report = (bis_auto_report){.chosen = -1};
    *chosen = desc->settings;
    if (!bis_auto_is_wanted(&desc->settings)) return BIS_OK;
    chosen->integrator = &bis_sir; /* its defaults, until something better is known */
    if (!scene->accel || bis_light_is_black(scene->light)) return BIS_OK;
    status = make_pilot(&p, desc, options, diag);
    if (!status) status = run_rounds(&p, diag);
    if (!status && report->chosen >= 0) *chosen = report->tried[report->chosen].settings;
    report->seconds = bis_clock_now() - start;
    bis_free(p.picture);
    bis_free(p.shaded);
    for (int i = 0; i < report->n_tried; i++) {
        bis_free(p.trials[i].sum);
        bis_free(p.trials[i].squares);
    }
    return status;
}
