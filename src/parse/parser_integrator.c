/* SPDX-License-Identifier: BSD-2-Clause */
/* parser_integrator: Integrator and Sampler (docs/scene-format.md).
 *
 * Each integrator has its own parameters; one that belongs to another is unknown here, because a scene that gives
 * `candidates` to "em" does not mean what it says. pbrt's integrators and samplers are replaced, with a warning, by
 * what comes nearest. */
#include "bis/base/file.h"
#include "approximate.h"
#include "directives.h"
#include "parser_ask.h"

#include <assert.h>
#include <string.h>

#define MAX_SPP 1000000000u

/* ---- Integrator ---- */

enum { MAX_INTEGRATORS = 32 };

static void read_choice(bis_parser *p, const bis_parameter *parameter, bis_settings *s)
{
    const char *names[BIS_MAX_CHOICES];
    unsigned values[BIS_MAX_CHOICES];
    size_t n = 0;
    int i;

    for (unsigned v = 0; v < BIS_MAX_CHOICES; v++) {
        if (!(parameter->choices >> v & 1)) continue;
        names[n] = parameter->names[v];
        values[n++] = v;
    }
    if (bis_params_choice(p, parameter->name, &i, names, n)) bis_parameter_set(parameter, s, values[i]);
}

static void read_parameter(bis_parser *p, const bis_parameter *parameter, bis_settings *s)
{
    const bis_interval range = {parameter->lo, parameter->hi, false, false};
    uint32_t count;
    double fraction;
    bool is;

    switch (parameter->type) {
    case BIS_PARAMETER_COUNT: /* where lo is 2, bis_settings_check says why */
        if (bis_params_uint32(p, parameter->name, &count, 1, (uint32_t)parameter->hi))
            bis_parameter_set(parameter, s, count);
        break;
    case BIS_PARAMETER_FRACTION:
        if (bis_params_float(p, parameter->name, &fraction, range)) bis_parameter_set(parameter, s, fraction);
        break;
    case BIS_PARAMETER_BOOL:
        if (bis_params_bool(p, parameter->name, &is)) bis_parameter_set(parameter, s, is);
        break;
    case BIS_PARAMETER_CHOICE: read_choice(p, parameter, s); break;
    }
}

static bis_settings read_settings(bis_parser *p, const bis_integrator *integrator)
{
    bis_settings s = bis_settings_default(integrator);

    for (const bis_parameter *q = NULL; (q = bis_parameter_next(integrator, q)) != NULL;) read_parameter(p, q, &s);
    return s;
}

void bis_directive_integrator(bis_parser *p, bis_loc at)
{
    static const char *const pbrt[] = {
        "path",      "volpath",    "bdpt",             "mlt",      "sppm",      "directlighting", "whitted", "ao",
        "lightpath", "randomwalk", "ambientocclusion", "function", "photonmap", "exphotonmap",    "igi",
        "irradiancecache", "simplepath", "simplevolpath",
    };
    bis_choice choices[BIS_COUNT(pbrt) + MAX_INTEGRATORS];
    size_t n = 0;

    for (; bis_integrators[n]; n++) choices[n] = (bis_choice){bis_integrators[n]->name, 0};
    assert(n < MAX_INTEGRATORS);
    for (size_t i = 0; i < BIS_COUNT(pbrt); i++) choices[n++] = (bis_choice){pbrt[i], BIS_REPLACED};
    if (!bis_parser_name(p, "Integrator") || !bis_params_read(p)) return;
    const char *name = bis_parser_text(p, p->name);
    if (strcmp(name, "auto") == 0) { /* of builds before 0.1.0 */
        bis_parser_error(p, p->name_at, "there is no Integrator \"auto\" any more: leave the line out, and the default "
                         "renders without choosing; `bis trade SCENE` recommends settings");
        return;
    }
    const bis_choice *chosen = bis_parser_choose(p, "Integrator", name, p->name_at, choices, n);
    if (!chosen) return;
    const bis_integrator *integrator = bis_integrator_find(chosen->name);
    bis_parser_single(p, BIS_SINGLE_INTEGRATOR, "Integrator", at);
    p->desc->integrator_loc = p->name_at;
    p->desc->names_integrator = integrator != NULL;
    if (!integrator) {
        if (p->approximate)
            bis_approximate_integrator(p, p->name_at, "Integrator", bis_parser_text(p, p->name));
        else bis_warn(p->diag, p->name_at,
                 "Integrator \"%s\" is pbrt's and replaced by the default, \"%s\", one bounce; its parameters are "
                 "ignored",
                 chosen->name, bis_sir.name);
        bis_settings_replace(&p->desc->view.settings, bis_settings_unnamed());
        return;
    }
    bis_settings_replace(&p->desc->view.settings, read_settings(p, integrator));
    if (integrator == &bis_sir) bis_params_ignore(p, "Integrator");
    bis_params_end(p, "Integrator", chosen->name);
}

/* ---- Sampler ---- */

/* pbrt's xsamples and ysamples; pixelsamples alone is divided as squarely as possible. */
static void read_stratified(bis_parser *p, bis_sampler *s, bool has_spp)
{
    uint32_t x = 4, y = 4;
    const bool has_x = bis_params_uint32(p, "xsamples", &x, 1, 65535);
    const bool has_y = bis_params_uint32(p, "ysamples", &y, 1, 65535);
    bis_params_bool(p, "jitter", &s->jitter);
    if (!has_x && !has_y) return;
    if ((uint64_t)x * y > MAX_SPP || (has_spp && x * y != s->spp)) {
        bis_parser_error(p, bis_params_at(p, has_x ? "xsamples" : "ysamples"),
                         "\"xsamples\" %u times \"ysamples\" %u is %llu, must be %s%u", x, y, (unsigned long long)x * y,
                         has_spp ? "\"pixelsamples\" " : "at most ", has_spp ? (unsigned)s->spp : MAX_SPP);
        return;
    }
    s->xsamples = x;
    s->ysamples = y;
    s->spp = x * y;
}

void bis_directive_sampler(bis_parser *p, bis_loc at)
{
    static const bis_choice samplers[] = {
        {"random", BIS_SAMPLER_RANDOM}, {"independent", BIS_SAMPLER_RANDOM}, {"stratified", BIS_SAMPLER_STRATIFIED},
        {"sobol", BIS_SAMPLER_SOBOL},   {"halton", BIS_SAMPLER_HALTON},      {"zsobol", BIS_REPLACED},
        {"paddedsobol", BIS_REPLACED},  {"pmj02bn", BIS_REPLACED},           {"02sequence", BIS_REPLACED},
        {"lowdiscrepancy", BIS_REPLACED}, {"maxmindist", BIS_REPLACED},      {"bestcandidate", BIS_REPLACED},
        {"adaptive", BIS_REPLACED},
    };
    uint32_t spp = 16;

    const bis_choice *chosen = bis_parser_begin(p, "Sampler", samplers, BIS_COUNT(samplers));
    if (!chosen) return;
    bis_parser_single(p, BIS_SINGLE_SAMPLER, "Sampler", at);
    const bool replaced = chosen->value == BIS_REPLACED;
    if (replaced) bis_warn(p->diag, p->name_at, "Sampler \"%s\" is replaced by \"sobol\"", chosen->name);

    const bool has_spp = bis_params_uint32(p, "pixelsamples", &spp, 1, MAX_SPP);
    bis_sampler *s = &p->desc->view.sampler;
    *s = (bis_sampler){.kind = replaced ? BIS_SAMPLER_SOBOL : (bis_sampler_kind)chosen->value, .jitter = true};
    bis_sampler_set_spp(&p->desc->view.sampler, spp);
    bis_params_integer(p, "seed", &s->seed, 0, BIS_SEED_MAX);
    p->desc->view.edge_samples = 1;
    bis_params_uint32(p, "edgesamples", &p->desc->view.edge_samples, 1, 1024);
    p->desc->view.edge_light = 1;
    bis_params_float(p, "edgelight", &p->desc->view.edge_light, (bis_interval){0, 1, true, false});
    if (s->kind == BIS_SAMPLER_STRATIFIED) read_stratified(p, s, has_spp);
    bis_params_ignore(p, "Sampler");
    if (!replaced) bis_params_end(p, "Sampler", chosen->name);
}
