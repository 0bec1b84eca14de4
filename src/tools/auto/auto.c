/* auto: the pilot. What minimises cost x variance is measured on the scene itself, in 4% of the time that the render
 * will take, or in some hundredths of a second.
 *
 * Every k-th pixel of the same view is rendered with each of a short list of settings, in replicates of one or two passes
 * (auto_pilot.c). Where materials differ they are sorted into at most four groups of like ones (auto_groups.c), and cost
 * and variance are known for each group. Three rounds: two replicates of each setting; two more for the families (em or
 * brdf where they are safe, mis, sir by mixture, sir by product) whose best is within `behind` of the best of all, for
 * all together or, where several settings look `promising`, for some group (`behind_alone`); then cost and variance of
 * such families are fitted, the M and N that minimise the whole picture's product (auto_fit.c) are tried, too, and of
 * all combinations of a setting for each group the least measured product wins (auto_choose.c): the fit proposes, the
 * measurement decides.
 *
 * The variance is biased low for a method whose error is in fewer than about one sample in a thousand, which no pilot
 * can tell from a good one; hence `unseen`, by which all is multiplied that comes from mis or em. And who looks for the
 * least of many figures finds one that came out too low: with four groups that is worse than what there is to gain (on
 * scene.txt the combinations of least product took 1.01 to 1.2 times as long as a good single one). So several settings are
 * taken only where their gain over the best one is beyond two standard errors.
 *
 * Renders too short for the fit get one setting for all, from three. "learn" is not tried: it needs more passes than a
 * pilot has. */
#include "auto.h"

#include "auto_choose.h"
#include "auto_fit.h"
#include "auto_pilot.h"

#include "bis/base/clock.h"
#include "bis/base/mem.h"

#include <assert.h>
#include <math.h>

/* Families of settings that differ in M and N alone, and where each is tried first. */
typedef struct family {
    const bis_integrator *integrator;
    bis_proposal proposal;
    bis_auto_limits limits;
    struct {
        uint32_t M, N;
    } first[4], quick; /* ended by N = 0; the one setting of a short list */
} family;

enum { N_FAMILIES = 5, MOST_PASSES = 2, REPLICATES = BIS_AUTO_REPLICATES / 2 /* in each of the first two rounds */ };

/* N is not tried beyond 64: a pass should not cost tens of times what it costs by default, whatever the pixel's area
 * is worth. */
static const family families[N_FAMILIES] = {
    {&bis_em, BIS_PROPOSAL_MIX, {0, 0, 2, 64}, {{0, 8}, {0, 48}}, {0, 32}},
    {&bis_brdf, BIS_PROPOSAL_MIX, {0, 0, 2, 64}, {{0, 4}, {0, 24}}, {0, 8}},
    {&bis_mis, BIS_PROPOSAL_MIX, {0, 0, 2, 64}, {{0, 6}, {0, 32}}, {0, 16}},
    {&bis_sir, BIS_PROPOSAL_MIX, {32, 2048, 2, 64}, {{64, 4}, {64, 20}, {256, 8}}, {64, 16}},
    {&bis_sir, BIS_PROPOSAL_PRODUCT, {16, 512, 2, 64}, {{32, 4}, {64, 16}, {192, 6}}, {64, 16}},
};

static const double behind = 2, behind_alone = 1.4;
static const double share_of_time = 0.04;

/* The pilot's camera samples: with fewer, M and N are not fitted (some five seconds of rendering are then to come,
 * of which little could be saved); more need not be known. */
static const double least_samples = 1.5e5, most_samples = 6e5;

/* And of the short list, which chooses among three at settings that are good everywhere. */
static const double share_of_time_quick = 0.015, least_samples_quick = 8e3;

/* About how many replicates of how many settings there will be, and camera samples a second where time is all that
 * is known. */
static const double expected_renders = 36, expected_renders_quick = 6, samples_a_second = 2e5;

/* What a setting beyond the first must save: another pool in the caches is a cost that nobody has measured. */
static const double dearer = 1.03;

/* A gain that is worth some more renders for the sake of single groups. */
static const double promising = 1.1;

/* ---- what is best ---- */

double bis_auto_cost_of_all(const bis_auto_report *r, int i)
{
    double sum = r->common + r->tried[i].fill;

    for (int g = 0; g < r->n_groups; g++) sum += r->tried[i].cost[g];
    return sum;
}

double bis_auto_variance_of_all(const bis_auto_report *r, int i)
{
    double sum = 0;

    for (int g = 0; g < r->n_groups; g++) sum += r->tried[i].variance[g];
    return sum;
}

enum { ALL = BIS_AUTO_ALL };

/* Of group g's part, or of ALL. The smaller the group, the less was seen of it. */
static double variance_of(const bis_auto_report *r, int g, int i)
{
    const double unseen = 0.25, share = g == ALL ? 1 : r->share[g];
    const bis_settings *s = &r->tried[i].settings;
    const bool is_suspect = s->integrator == &bis_mis || s->integrator == &bis_em;

    return (g == ALL ? bis_auto_variance_of_all(r, i) : r->tried[i].variance[g]) * (is_suspect ? 1 + unseen / share : 1);
}

/* Of group g alone, with its share of what all have in common; ALL: of the picture, with one setting for all. */
static double product(const bis_auto_pilot *p, int g, int i)
{
    const bis_auto_report *r = p->report;
    const double cost = g == ALL ? bis_auto_cost_of_all(r, i) : (r->common + r->tried[i].fill) * r->share[g] + r->tried[i].cost[g];

    return cost * variance_of(r, g, i);
}

/* Of the family, or of all with -1; -1: none was tried. Without any noise the cheapest. */
static int best_of(const bis_auto_pilot *p, int g, int of_family)
{
    int best = -1;

    for (int i = 0; i < p->report->n_tried; i++) {
        const int f = p->trials[i].family;
        if ((of_family >= 0 && f != of_family) || !bis_auto_suits(p->report, g, i)) continue;
        const double d = best < 0 ? -1 : product(p, g, i) - product(p, g, best);
        if (d < 0 || (d == 0 && bis_auto_cost_of_all(p->report, i) < bis_auto_cost_of_all(p->report, best))) best = i;
    }
    return best;
}

/* log of the product of the picture with one setting for all over that with one for each group, which of pixels counts
 * all cells but `left_out` (-1: all). */
static double log_gain(const bis_auto_pilot *p, int uniform, const int *chosen, int left_out)
{
    const bis_auto_report *r = p->report;
    double cost = r->common, variance[2] = {0, 0};

    for (int g = 0; g < r->n_groups; g++) {
        bool is_new = true;
        for (int h = 0; h < g; h++) is_new &= chosen[h] != chosen[g];
        cost += r->tried[chosen[g]].cost[g] + (is_new ? r->tried[chosen[g]].fill : 0);
        for (int c = 0; c < BIS_AUTO_CELLS; c++) {
            if (c == left_out) continue;
            variance[0] += p->trials[uniform].cell[g][c];
            variance[1] += p->trials[chosen[g]].cell[g][c];
        }
    }
    if (!(variance[0] > 0 && variance[1] > 0)) return 0; /* no noise, nothing to gain */
    return log(bis_auto_cost_of_all(r, uniform) * variance[0] / (cost * variance[1]));
}

/* Is the gain beyond two standard errors, by the jackknife over cells? The other errors are in common: of the same pixels
 * and, nearly, the same costs. */
static bool is_sure(const bis_auto_pilot *p, int uniform, const int *chosen)
{
    const int n = BIS_AUTO_CELLS;
    double gain[BIS_AUTO_CELLS], mean = 0, squares = 0;

    for (int c = 0; c < n; c++) mean += gain[c] = log_gain(p, uniform, chosen, c);
    mean /= n;
    for (int c = 0; c < n; c++) squares += (gain[c] - mean) * (gain[c] - mean);
    return mean > log(dearer) + 2 * sqrt(squares * (n - 1) / n);
}

static void choose(bis_auto_pilot *p)
{
    bis_auto_offer offer[BIS_AUTO_MOST_GROUPS][BIS_AUTO_MOST_TRIED];
    const bis_auto_offer *offers[BIS_AUTO_MOST_GROUPS];
    int n[BIS_AUTO_MOST_GROUPS] = {0}, best[BIS_AUTO_MOST_GROUPS], chosen[BIS_AUTO_MOST_GROUPS];
    bis_auto_report *r = p->report;
    const int uniform = best_of(p, ALL, -1);

    for (int g = 0; g < r->n_groups; g++) {
        offers[g] = offer[g];
        for (int i = 0; i < r->n_tried; i++) {
            if (!bis_auto_suits(r, g, i)) continue;
            offer[g][n[g]++] = (bis_auto_offer){.id = i, .fill = r->tried[i].fill, .cost = r->tried[i].cost[g], .variance = variance_of(r, g, i)};
        }
    }
    bis_auto_combine(best, offers, n, r->n_groups, r->common, dearer);
    for (int g = 0; g < r->n_groups; g++) chosen[g] = offer[g][best[g]].id;
    p->is_mixed = log_gain(p, uniform, chosen, -1) > log(promising);
    const bool is_taken = r->n_groups > 1 && is_sure(p, uniform, chosen);
    for (int g = 0; g < r->n_groups; g++) r->chosen[g] = is_taken ? chosen[g] : uniform;
    r->is_chosen = true;
}

/* ---- what is tried ---- */

static bis_settings settings_of(const bis_auto_pilot *p, int f, uint32_t M, uint32_t N)
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

/* What a pilot cannot judge is left out: `em` sees a lobe, and `brdf` a lamp, so rarely that a few thousand samples
 * may tell nothing of it (with n = 10 in a hall of small lamps the pilot finds `brdf` 1.5 times as slow as the best;
 * it is 50 to 300 times). So em is for diffuse surfaces, where no sample is worth much more than another, and brdf
 * for a constant light. mis and sir are bounded by the better of the two everywhere. Under a constant light the
 * product is the mixture. */
static bool is_safe(const bis_auto_pilot *p, int g, int f)
{
    const bool constant = bis_light_is_constant(p->scene->light);

    if (p->base.only_sir && families[f].integrator != &bis_sir) return false;
    if (families[f].integrator == &bis_em) return !constant && p->diffuse[g];
    if (families[f].integrator == &bis_brdf) return constant;
    return !(constant && families[f].proposal == BIS_PROPOSAL_PRODUCT);
}

static unsigned groups_for(const bis_auto_pilot *p, int f)
{
    unsigned groups = 0;

    for (int g = 0; g < p->report->n_groups; g++)
        if (is_safe(p, g, f)) groups |= 1u << g;
    return groups;
}

static bis_status try(bis_auto_pilot *p, int f, uint32_t M, uint32_t N, int wanted, bis_diag *diag)
{
    const bis_settings s = settings_of(p, f, M, N);

    return bis_auto_pilot_add(p, f, groups_for(p, f), &s, wanted, diag);
}

/* Lobes of less than half a steradian (phong: n > 24) see so little of the map that half as many rays tell what hides
 * it: with n = 50 under Grace Cathedral 64/16 takes 1.42 times as long as the best setting, 64/8 1.22 times. So short a
 * pilot could not tell. */
static bool is_narrow(const bis_scene_desc *d)
{
    const double least_narrowness = 2;

    for (size_t i = 0; i < d->n_shapes; i++)
        if (bis_auto_narrowness(&d->materials[d->shapes[i].material]) < least_narrowness) return false;
    return true;
}

static bis_status try_first(bis_auto_pilot *p, bis_diag *diag)
{
    const bool narrow = p->is_quick && is_narrow(&p->desc);
    bis_status status = BIS_OK;

    for (int f = 0; f < N_FAMILIES; f++) {
        if (!groups_for(p, f)) continue;
        const uint32_t quick_N = families[f].quick.N / (narrow && families[f].proposal == BIS_PROPOSAL_PRODUCT ? 2 : 1);
        if (p->is_quick && !status) status = try(p, f, families[f].quick.M, quick_N, REPLICATES, diag);
        for (int k = 0; !p->is_quick && k < 4 && families[f].first[k].N && !status; k++) {
            status = try(p, f, families[f].first[k].M, families[f].first[k].N, REPLICATES, diag);
        }
    }
    return status;
}

/* Has the family a chance still? */
static bool is_alive(const bis_auto_pilot *p, int g, int f)
{
    const int own = best_of(p, g, f);

    return own >= 0 && product(p, g, own) <= (g == ALL ? behind : behind_alone) * product(p, g, best_of(p, g, -1));
}

static void want_more(bis_auto_pilot *p)
{
    for (int i = 0; i < p->report->n_tried; i++) {
        bool alive = is_alive(p, ALL, p->trials[i].family);
        for (int g = 0; g < p->report->n_groups && p->is_mixed; g++) alive |= is_alive(p, g, p->trials[i].family);
        p->trials[i].wanted = alive ? REPLICATES : 0;
    }
}

/* M and N of least product by the fit of what was measured: of the whole picture, with one setting for ALL, or with
 * group g's and for the others what is chosen now. Nothing to fit where there is no noise. */
static bool fitted_optimum(const bis_auto_pilot *p, int g, int f, uint32_t *M, uint32_t *N)
{
    const bis_auto_report *r = p->report;
    bis_auto_measured m[BIS_AUTO_MOST_TRIED] = {{0}};
    int n = 0;

    for (int i = 0; i < r->n_tried; i++) {
        const bis_auto_tried *t = &r->tried[i];
        const double cost = g == ALL ? bis_auto_cost_of_all(r, i) : t->fill + t->cost[g], variance = g == ALL ? bis_auto_variance_of_all(r, i) : t->variance[g];
        if (p->trials[i].family != f) continue;
        if (!(cost > 0 && variance > 0)) return false;
        const uint32_t candidates = t->settings.integrator == &bis_sir ? t->settings.candidates : 0;
        m[n++] = (bis_auto_measured){candidates, t->settings.shadowrays, cost, variance};
    }
    bis_auto_model cost = bis_auto_fit_cost(m, n), variance = bis_auto_fit_variance(m, n);
    if (g != ALL) cost.constant += r->common;
    for (int h = 0; h < r->n_groups && g != ALL; h++) {
        const bis_auto_tried *t = &r->tried[r->chosen[h]];
        if (h == g) continue;
        cost.constant += t->fill + t->cost[h];
        variance.constant += t->variance[h];
    }
    bis_auto_best(M, N, &cost, &variance, &families[f].limits);
    return true;
}

/* What is nearly the same is known. */
static bool is_known(const bis_auto_pilot *p, int f, uint32_t M, uint32_t N)
{
    const double near = p->report->n_groups > 1 ? 1.25 : 1;

    for (int i = 0; i < p->report->n_tried; i++) {
        const bis_settings *s = &p->report->tried[i].settings;
        const double m = families[f].limits.max_M ? (double)s->candidates / M : 1, n = (double)s->shadowrays / N;
        if (p->trials[i].family == f && fmax(m, 1 / m) <= near && fmax(n, 1 / n) <= near) return true;
    }
    return false;
}

/* For all materials by each family that has a chance, and for each group by the family that is its best now. */
static bis_status try_optima(bis_auto_pilot *p, bis_diag *diag)
{
    const int n_groups = p->report->n_groups;
    bis_status status = BIS_OK;
    uint32_t M, N;
    bool alive[N_FAMILIES];

    for (int f = 0; f < N_FAMILIES; f++) alive[f] = is_alive(p, ALL, f);
    for (int f = 0; f < N_FAMILIES && !status; f++)
        if (alive[f] && fitted_optimum(p, ALL, f, &M, &N) && !is_known(p, f, M, N)) status = try(p, f, M, N, 2 * REPLICATES, diag);
    for (int g = 0; g < n_groups && p->is_mixed && !status; g++) {
        const int f = p->trials[best_of(p, g, -1)].family;
        if (fitted_optimum(p, g, f, &M, &N) && !is_known(p, f, M, N)) status = try(p, f, M, N, 2 * REPLICATES, diag);
    }
    return status ? status : bis_auto_pilot_run(p, diag);
}

/* ---- the pilot ---- */

static bis_status run_rounds(bis_auto_pilot *p, bis_diag *diag)
{
    bis_status status = try_first(p, diag);

    if (!status) status = bis_auto_pilot_run(p, diag);
    if (status || bis_auto_is_interrupted(p)) return status;
    bis_auto_pilot_measure(p);
    choose(p);
    if (p->is_quick) return BIS_OK;
    want_more(p);
    status = bis_auto_pilot_run(p, diag);
    if (status || bis_auto_is_interrupted(p)) return status;
    bis_auto_pilot_measure(p);
    choose(p);
    status = try_optima(p, diag);
    if (status || bis_auto_is_interrupted(p)) return status;
    bis_auto_pilot_measure(p);
    choose(p);
    return BIS_OK;
}

static double pixels_of(const bis_film_desc *f)
{
    return (double)f->width * f->height * (f->crop[1] - f->crop[0]) * (f->crop[3] - f->crop[2]);
}

/* Camera samples of the whole render, as far as the budget tells; without an --spp, as many as the scene asks for. */
static double samples_to_come(const bis_scene_desc *desc, const bis_render_options *o)
{
    const double by_spp = pixels_of(&desc->film) * (double)(o->budget.spp ? o->budget.spp : desc->sampler.spp);

    if (!(o->budget.seconds > 0)) return by_spp;
    const double by_time = o->budget.seconds * samples_a_second;
    return o->budget.spp ? fmin(by_spp, by_time) : by_time;
}

/* A film k times smaller in each direction, of at most the picture's size. A crop too thin for that is rendered as
 * it is. */
static bis_status make_film(bis_film *film, bis_auto_pilot *p, const bis_scene_desc *desc, double pixels, bis_diag *diag)
{
    const bis_film_desc *f = &desc->film;
    const double k = fmax(1, sqrt(pixels_of(f) / pixels));
    const int width = (int)fmax(1, round(f->width / k)), height = (int)fmax(1, round(f->height / k));

    p->options.footprint = 1 / k;
    p->scale = (double)f->width * f->height / ((double)width * height);
    bis_status status = bis_film_init(film, width, height, f->crop, (bis_loc){0}, NULL);
    if (status == BIS_NOMEM) return bis_auto_no_memory(desc, diag);
    if (status == BIS_OK) {
        p->desc.film.width = width;
        p->desc.film.height = height;
    } else {
        p->options.footprint = 0;
        p->scale = 1;
        status = bis_film_init(film, f->width, f->height, f->crop, desc->integrator_loc, diag);
    }
    p->report->width = film->width;
    p->report->height = film->height;
    p->n_pixels = (size_t)film->width * (size_t)film->height;
    return status;
}

static bis_status make_pilot(bis_auto_pilot *p, const bis_scene_desc *desc, const bis_render_options *options, bis_diag *diag)
{
    const double to_come = samples_to_come(desc, options), samples = fmin(most_samples, share_of_time * to_come);
    const double quick = fmax(least_samples_quick, share_of_time_quick * to_come);
    /* where passes are independent, one camera sample knows nothing of the next */
    const bool independent = desc->adaptive || options->budget.error > 0;
    const uint64_t spp = options->budget.spp ? options->budget.spp : desc->sampler.spp;
    bis_auto_report *r = p->report;
    bis_film film;

    p->is_quick = samples < least_samples;
    p->passes = independent || p->is_quick || spp < MOST_PASSES ? 1 : MOST_PASSES;
    p->desc.adaptive = false;
    p->desc.film.layers = 0;
    bis_scene_set_spp(&p->desc, p->passes);
    const double pixels = p->is_quick ? quick / expected_renders_quick : samples / (expected_renders * p->passes);
    r->group = bis_alloc(desc->n_materials, sizeof *r->group);
    if (!r->group) return bis_auto_no_memory(desc, diag);
    bis_status status = make_film(&film, p, desc, pixels, diag);
    if (!status && !p->is_quick) status = bis_auto_group(r->group, &r->n_groups, r->share, &p->shows, &film, p->scene, desc, diag);
    bis_film_clear(&film);
    if (status) return status;
    p->n_threads = bis_render_threads(options);
    p->options = (bis_render_options){
        .budget = {.spp = p->passes},
        .n_threads = 1,
        .footprint = p->options.footprint,
        .interrupted = options->interrupted,
    };
    r->passes = (int)p->passes;
    return bis_auto_pilot_start(p, diag);
}

/* Most points have the general settings; groups that chose the same are one exception. */
static bis_status make_exceptions(bis_auto_pilot *p, const bis_scene_desc *desc, bis_diag *diag)
{
    bis_auto_report *r = p->report;
    bis_exceptions *e = &r->exceptions;
    int largest = 0, method[BIS_AUTO_MOST_GROUPS];

    for (int g = 0; g < r->n_groups; g++)
        if (r->share[g] > r->share[largest]) largest = g;
    r->settings = r->tried[r->chosen[largest]].settings;
    for (int g = 0; g < r->n_groups; g++) {
        method[g] = r->chosen[g] == r->chosen[largest] ? 0 : -1;
        for (int h = 0; h < g; h++)
            if (r->chosen[h] == r->chosen[g]) method[g] = method[h];
        if (method[g] >= 0) continue;
        e->loc[e->n] = desc->integrator_loc;
        e->settings[e->n] = r->tried[r->chosen[g]].settings;
        method[g] = ++e->n;
    }
    if (!e->n) return BIS_OK;
    e->of_material = bis_alloc(desc->n_materials, sizeof *e->of_material);
    if (!e->of_material) {
        e->n = 0;
        return bis_auto_no_memory(desc, diag);
    }
    for (size_t i = 0; i < desc->n_materials; i++) e->of_material[i] = (unsigned char)method[r->group[i]];
    return BIS_OK;
}

bool bis_auto_is_wanted(const bis_settings *s) { return s->integrator == &bis_auto; }

bis_status bis_auto_choose(bis_auto_report *report, const bis_scene *scene, const bis_scene_desc *desc, const bis_render_options *options, bis_diag *diag)
{
    const double start = bis_clock_now();
    bis_auto_pilot *p = NULL;
    bis_status status;

    *report = (bis_auto_report){.settings = desc->settings, .n_groups = 1, .share = {1}};
    if (!bis_auto_is_wanted(&desc->settings)) return BIS_OK;
    assert(!desc->exceptions.n);
    report->settings.integrator = &bis_sir; /* its defaults, until something better is known */
    if (!scene->accel || bis_light_is_black(scene->light)) return BIS_OK;
    p = bis_alloc(1, sizeof *p);
    if (!p) return bis_auto_no_memory(desc, diag);
    p->scene = scene;
    p->desc = *desc;
    p->base = desc->settings;
    p->report = report;
    status = make_pilot(p, desc, options, diag);
    if (!status && !bis_auto_is_interrupted(p)) status = run_rounds(p, diag);
    if (!status && report->is_chosen) status = make_exceptions(p, desc, diag);
    report->seconds = bis_clock_now() - start;
    bis_auto_pilot_clear(p);
    bis_free(p);
    return status;
}

void bis_auto_report_clear(bis_auto_report *report)
{
    bis_free(report->group);
    bis_free(report->exceptions.of_material);
    *report = (bis_auto_report){.n_groups = 1};
}
