/* SPDX-License-Identifier: BSD-2-Clause */
/* trade_settings: the settings that `bis trade` sweeps, in words and as they stand in a scene file.
 *
 * One table. Rows differ from the first of their integrator in one thing, so that what is compared is that thing: N,
 * then M, then the proposal, the stratification, b. The thesis's own setting, 15 of 800, is there for rejection and
 * SIR. A new option of an integrator that changes cost or variance wants a row here; a new integrator without one is
 * swept with its defaults. */
#include "trade_settings.h"

#include "bis/base/file.h"
#include "tools/describe.h"

#include <string.h>

typedef struct recipe {
    const char *integrator;
    uint32_t M, N; /* M = 0: no candidates */
    const char *variant;
    bool quick;    /* in the short sweep, too */
} recipe;

static const recipe recipes[] = {
    {"em", 0, 4, "", false},
    {"em", 0, 16, "", true},
    {"em", 0, 64, "", false},
    {"em", 0, 16, "stratified", true},
    {"em", 0, 16, "b=0", false},
    {"em", 0, 16, "b=0.5", false},
    {"brdf", 0, 4, "", false},
    {"brdf", 0, 16, "", true},
    {"brdf", 0, 64, "", false},
    {"mis", 0, 4, "", false},
    {"mis", 0, 16, "", true},
    {"mis", 0, 64, "", true},
    {"mis", 0, 16, "stratified", true},
    {"mis", 0, 16, "power", false},
    {"mis", 0, 16, "compensated", true},
    {"rejection", 100, 8, "", true},
    {"rejection", 800, 15, "", false},
    {"rejection", 800, 15, "plain", false},
    {"sir", 16, 1, "", false},
    {"sir", 64, 1, "", false},
    {"sir", 64, 4, "", true},
    {"sir", 256, 4, "", false},
    {"sir", 256, 16, "", true},
    {"sir", 1024, 16, "", false},
    {"sir", 800, 15, "", true},
    {"sir", 256, 16, "em", false},
    {"sir", 256, 16, "brdf", false},
    {"sir", 256, 16, "product", true},
    {"sir", 256, 16, "product learned", true},
    {"sir", 256, 16, "independent", false},
    {"sir", 256, 16, "b=0", false},
    {"sir", 256, 16, "b=0.5", false},
};
enum { N_RECIPES = sizeof recipes / sizeof *recipes };

static void name_setting(bis_trade_setting *s, const recipe *r)
{
    char counts[24];
    if (r->M) snprintf(counts, sizeof counts, "%u/%u", (unsigned)r->M, (unsigned)r->N);
    else snprintf(counts, sizeof counts, "%u", (unsigned)r->N);
    snprintf(s->name, sizeof s->name, "%s %s%s%s", r->integrator, counts, *r->variant ? " " : "", r->variant);
}

static bool is_variant(const recipe *r, const char *name) { return strcmp(r->variant, name) == 0; }
static bool is_of_b(const recipe *r) { return strncmp(r->variant, "b=", 2) == 0; }

static double b_of(const recipe *r)
{
    const char *end;
    return bis_parse_double(r->variant + 2, &end);
}

static bool has(const bis_settings *s, const char *parameter)
{
    return bis_parameter_of(s->integrator, parameter) != NULL;
}
static bool is_biased(const bis_settings *s) { return has(s, "estimator") && s->estimator == BIS_ESTIMATOR_RATIO; }

/* N: what a setting spends on rays. */
static uint32_t rays_of(const bis_settings *s) { return has(s, "shadowrays") ? s->shadowrays : s->samples; }

static bis_trade_setting setting_of(const recipe *r, double scenes_b)
{
    bis_trade_setting s = {.settings = bis_settings_default(bis_integrator_find(r->integrator)),
                           .area_exponent = scenes_b,
                           .is_swept = true};

    name_setting(&s, r);
    s.settings.samples = r->N;
    s.settings.shadowrays = r->N;
    if (r->M) s.settings.candidates = r->M;
    if (is_variant(r, "power")) s.settings.heuristic = BIS_HEURISTIC_POWER;
    if (is_variant(r, "compensated")) s.settings.compensate = true;
    if (is_variant(r, "plain")) s.settings.estimator = BIS_ESTIMATOR_PLAIN;
    if (is_variant(r, "em")) s.settings.proposal = BIS_PROPOSAL_EM;
    if (is_variant(r, "brdf")) s.settings.proposal = BIS_PROPOSAL_BRDF;
    if (is_variant(r, "product") || is_variant(r, "product learned")) s.settings.proposal = BIS_PROPOSAL_PRODUCT;
    if (is_variant(r, "product learned")) s.settings.learn = true;
    if (is_variant(r, "stratified")) s.settings.stratify = true;
    if (is_variant(r, "independent")) {
        s.settings.stratify = false;
        s.settings.resampling = BIS_RESAMPLING_MULTINOMIAL;
    }
    if (is_of_b(r)) s.area_exponent = b_of(r);
    s.is_biased = is_biased(&s.settings);
    return s;
}

static bool equal_settings(const bis_trade_setting *x, const bis_trade_setting *y)
{
    return x->area_exponent == y->area_exponent && bis_settings_equal(&x->settings, &y->settings);
}

bool bis_trade_is_rival(const bis_integrator *i)
{
    return bis_parameter_of(i, "shadowrays") || bis_parameter_of(i, "samples");
}

/* An integrator without a row is compared with its defaults. */
static void add_newcomers(bis_trade *t)
{
    for (const bis_integrator *const *i = bis_integrators; *i; i++) {
        const bis_settings usual = bis_settings_default(*i);
        const recipe r = {(*i)->name, has(&usual, "candidates") ? usual.candidates : 0, rays_of(&usual), "", true};
        int k = 0;
        while (k < N_RECIPES && strcmp(recipes[k].integrator, (*i)->name) != 0) k++;
        if (k == N_RECIPES && bis_trade_is_rival(*i))
            t->plan.settings[t->plan.n_settings++] = setting_of(&r, t->desc->light.area_exponent);
    }
}

static void add_scenes_own(bis_trade *t)
{
    bis_trade_plan *plan = &t->plan;
    bis_trade_setting own = {.settings = t->desc->view.settings,
                             .area_exponent = t->desc->light.area_exponent,
                             .is_scenes = true,
                             .is_swept = true};

    own.settings.as_printed = 0;
    if (!bis_trade_is_rival(own.settings.integrator)) return;
    own.is_biased = is_biased(&own.settings);
    for (int i = 0; i < plan->n_settings; i++) {
        if (!equal_settings(&plan->settings[i], &own)) continue;
        plan->settings[i].is_scenes = true;
        return;
    }
    const recipe r = {own.settings.integrator->name, has(&own.settings, "candidates") ? own.settings.candidates : 0,
                      rays_of(&own.settings), "scene's own", true};
    name_setting(&own, &r);
    plan->settings[plan->n_settings++] = own;
}

/* b and compensation are about the map's importance: nothing of that in a constant light, and too much memory for
 * another in a huge map. */
static bool fits_light(const bis_trade *t, const recipe *r, bool small_map)
{
    if (!is_of_b(r) && !is_variant(r, "compensated")) return true;
    return small_map && (!is_of_b(r) || b_of(r) != t->desc->light.area_exponent);
}

static bool is_asked_for(const bis_trade_options *o, const char *integrator)
{
    for (int i = 0; i < o->n_integrators; i++)
        if (strcmp(o->integrators[i], integrator) == 0) return true;
    return o->n_integrators == 0;
}

void bis_trade_list_settings(bis_trade *t, bool small_map)
{
    bis_trade_plan *plan = &t->plan;

    plan->n_settings = 0;
    for (int i = 0; i < N_RECIPES; i++) {
        if (!fits_light(t, &recipes[i], small_map)) continue;
        bis_trade_setting s = setting_of(&recipes[i], t->desc->light.area_exponent);
        s.is_swept = !t->o.quick || recipes[i].quick;
        plan->settings[plan->n_settings++] = s;
    }
    add_newcomers(t);
    add_scenes_own(t);
    for (int i = 0; i < plan->n_settings; i++) {
        bis_trade_setting *s = &plan->settings[i];
        s->is_swept = (s->is_swept || s->is_scenes) && is_asked_for(&t->o, s->settings.integrator->name);
    }
}

int bis_trade_find_setting(const bis_trade_plan *plan, const char *name)
{
    for (int i = 0; i < plan->n_settings; i++)
        if (strcmp(plan->settings[i].name, name) == 0) return i;
    return -1;
}

int bis_trade_judge_of(const bis_trade_setting *s)
{
    return has(&s->settings, "shadowrays") ? 0 : 1;
}

/* ---- as text ---- */

void bis_trade_scene_text(char text[256], const bis_trade_setting *s, double scenes_b)
{
    char line[BIS_MAX_LINE], b[32];

    bis_describe_line(line, &s->settings, false);
    if (s->area_exponent == scenes_b) snprintf(text, 256, "%.255s", line);
    else
        snprintf(text, 256, "%.199s; in LightSource: \"float areaexponent\" %s", line,
                 bis_format_double(b, s->area_exponent));
}

void bis_trade_option_text(char text[128], const bis_trade_setting *s, double scenes_b)
{
    int n = snprintf(text, 128, "--integrator %s", s->settings.integrator->name);
    bool is_reachable = s->area_exponent == scenes_b;

    for (const bis_parameter *p = NULL; (p = bis_parameter_next(s->settings.integrator, p)) != NULL;) {
        const double v = bis_parameter_get(p, &s->settings);
        char buf[32];
        if (p->type != BIS_PARAMETER_COUNT && v == p->usual) continue;
        is_reachable &= p->is_option;
        const char *value = p->type == BIS_PARAMETER_BOOL ? (v > 0 ? "on" : "off") : bis_parameter_text(buf, p, v);
        if (n < 128) n += snprintf(text + n, 128 - (size_t)n, " --%s %s", p->name, value);
    }
    if (!is_reachable) text[0] = '\0';
}
