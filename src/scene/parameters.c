/* SPDX-License-Identifier: BSD-2-Clause */
/* parameters: the table of the integrators' parameters. A new parameter is a row here and a field of bis_settings; a
 * new integrator stands beside the parameters that it reads. */
#include "bis/scene/parameters.h"

#include "base/text.h"
#include "bis/base/file.h"
#include "bis/thesis/integrator.h"

#include <stdio.h>
#include <math.h>
#include <string.h>

/* ---- the table ---- */

#define MAX_COUNT (1u << 24) /* of candidates and rays in a camera sample, because each thread holds them */

static const char *const proposals[] = {[BIS_PROPOSAL_EM] = "em",
                                        [BIS_PROPOSAL_BRDF] = "brdf",
                                        [BIS_PROPOSAL_MIX] = "mix",
                                        [BIS_PROPOSAL_CHOOSE] = "choose",
                                        [BIS_PROPOSAL_PRODUCT] = "product"};
static const char *const heuristics[] = {"balance", "power"};
static const char *const resamplings[] = {"systematic", "multinomial"};
static const char *const estimators[] = {"ratio", "plain"};
static const char *const fallbacks[] = {"resample", "subset", "unoccluded"};

_Static_assert(sizeof(bis_proposal) == sizeof(unsigned) && sizeof(bis_fallback) == sizeof(unsigned),
               "bis_parameter_get reads an enum as unsigned");

#define ROW(field, kind) .name = #field, .type = BIS_PARAMETER_##kind, .offset = offsetof(bis_settings, field)
#define COUNT(field, standard, least) ROW(field, COUNT), .usual = standard, .lo = least, .hi = MAX_COUNT
#define SWITCH(field, standard) ROW(field, BOOL), .usual = standard, .hi = 1
#define CHOICE(field, standard, all, set) ROW(field, CHOICE), .usual = standard, .names = all, .choices = set
#define VALUE(name) (1u << BIS_PROPOSAL_##name)

/* A row is a parameter. An integrator that reads no row of a name has the default of the first: with it, it draws its
 * candidates. */
const bis_parameter bis_parameters[] = {
    {COUNT(candidates, 800, 1), .is_option = true, .words = "candidates for each camera sample",
     .readers = {&bis_rejection, &bis_sir, &bis_unoccluded}},
    {COUNT(shadowrays, 15, 1), .is_option = true, .words = "candidates that are shadow-tested",
     .readers = {&bis_rejection, &bis_sir}},
    {COUNT(samples, 16, 1), .is_option = true, .words = "light samples for each camera sample",
     .readers = {&bis_em, &bis_brdf}},
    {COUNT(samples, 16, 2), .is_option = true, .note = "at least 2", .readers = {&bis_mis},
     .demand = "divides them between map and BRDF and needs at least 2 (for a single one take \"em\" or \"brdf\")"},
    {COUNT(perpatch, 1, 1), .words = "shadow rays for each lit pixel of the map", .readers = {&bis_exact}},
    {CHOICE(proposal, BIS_PROPOSAL_MIX, proposals, VALUE(EM) | VALUE(BRDF) | VALUE(MIX) | VALUE(PRODUCT)),
     .is_option = true, .words = "what draws the candidates", .readers = {&bis_sir}},
    {CHOICE(proposal, BIS_PROPOSAL_CHOOSE, proposals, VALUE(EM) | VALUE(BRDF) | VALUE(CHOOSE)),
     .is_option = true, .readers = {&bis_rejection}},
    {CHOICE(heuristic, BIS_HEURISTIC_BALANCE, heuristics, 3), .words = "how the two densities are weighed",
     .readers = {&bis_mis}},
    {ROW(split, FRACTION), .usual = 0.5, .lo = 0, .hi = 1, .note = "the map's share",
     .words = "the map's share of the samples", .readers = {&bis_mis}},
    {SWITCH(compensate, false), .words = "leave to the BRDF what it draws well anyway", .readers = {&bis_mis}},
    {CHOICE(resampling, BIS_RESAMPLING_SYSTEMATIC, resamplings, 3), .words = "how candidates are chosen",
     .readers = {&bis_sir}},
    {CHOICE(estimator, BIS_ESTIMATOR_RATIO, estimators, 3),
     .words = "scale by the weights of all candidates, or by the number of accepted ones", .readers = {&bis_rejection}},
    {CHOICE(fallback, BIS_FALLBACK_RESAMPLE, fallbacks, 7), .words = "what takes over if none is accepted",
     .readers = {&bis_rejection}},
    {SWITCH(stratify, true), .words = "take the map's samples along its curve", .readers = {&bis_sir}},
    {SWITCH(stratify, false), .readers = {&bis_em, &bis_mis}},
    {SWITCH(learn, false), .is_option = true, .note = "product: go where light was seen to arrive",
     .words = "with proposal product, go where earlier rays saw light arrive", .readers = {&bis_sir}},
    {.name = NULL},
};

/* ---- reading it ---- */

static bool is_read_by(const bis_parameter *p, const bis_integrator *integrator)
{
    for (size_t i = 0; i < sizeof p->readers / sizeof *p->readers; i++)
        if (p->readers[i] == integrator) return integrator != NULL;
    return false;
}

const bis_parameter *bis_parameter_next(const bis_integrator *integrator, const bis_parameter *p)
{
    for (p = p ? p + 1 : bis_parameters; p->name; p++)
        if (is_read_by(p, integrator)) return p;
    return NULL;
}

const bis_parameter *bis_parameter_of(const bis_integrator *integrator, const char *name)
{
    const bis_parameter *p = NULL;

    while ((p = bis_parameter_next(integrator, p)) != NULL && strcmp(p->name, name) != 0) {}
    return p;
}

double bis_parameter_get(const bis_parameter *p, const bis_settings *s)
{
    const void *at = (const char *)s + p->offset;
    unsigned v;

    if (p->type == BIS_PARAMETER_COUNT) return *(const uint32_t *)at;
    if (p->type == BIS_PARAMETER_FRACTION) return *(const double *)at;
    if (p->type == BIS_PARAMETER_BOOL) return *(const bool *)at;
    memcpy(&v, at, sizeof v);
    return v;
}

void bis_parameter_set(const bis_parameter *p, bis_settings *s, double v)
{
    void *at = (char *)s + p->offset;
    const unsigned value = p->type == BIS_PARAMETER_CHOICE ? (unsigned)v : 0;

    if (p->type == BIS_PARAMETER_COUNT) *(uint32_t *)at = (uint32_t)v;
    if (p->type == BIS_PARAMETER_FRACTION) *(double *)at = v;
    if (p->type == BIS_PARAMETER_BOOL) *(bool *)at = v > 0;
    if (p->type == BIS_PARAMETER_CHOICE) memcpy(at, &value, sizeof value);
}

const char *bis_parameter_text(char buf[32], const bis_parameter *p, double v)
{
    if (p->type == BIS_PARAMETER_BOOL) return v > 0 ? "true" : "false";
    if (p->type == BIS_PARAMETER_CHOICE) return p->names[(unsigned)v];
    return bis_format_double(buf, v);
}

const char *bis_parameter_list(char buf[128], const bis_parameter *p, const char *quote)
{
    *buf = '\0';
    for (unsigned v = 0, left = p->choices; left; left &= ~(1u << v++)) {
        if (!(left >> v & 1)) continue;
        const char *between = left == p->choices ? "" : left >> v == 1 ? " or " : ", ";
        bis_append(buf, 128, "%s%s%s%s", between, quote, p->names[v], quote);
    }
    return buf;
}

const char *bis_proposal_name(bis_proposal p) { return proposals[p]; }

/* ---- settings ---- */

bis_settings bis_settings_default(const bis_integrator *integrator)
{
    bis_settings s = {.integrator = integrator};

    for (size_t i = sizeof bis_parameters / sizeof *bis_parameters - 1; i-- > 0;)
        bis_parameter_set(&bis_parameters[i], &s, bis_parameters[i].usual);
    for (const bis_parameter *p = NULL; (p = bis_parameter_next(integrator, p)) != NULL;)
        bis_parameter_set(p, &s, p->usual);
    return s;
}

/* Of what the thesis does not have, that which pays on nearly every scene (docs/integrators.md). */
bis_settings bis_settings_unnamed(void)
{
    bis_settings s = bis_settings_default(&bis_sir);

    s.proposal = BIS_PROPOSAL_PRODUCT;
    s.candidates = 64;
    s.shadowrays = 24;
    s.learn = true;
    return s;
}

void bis_settings_replace(bis_settings *s, bis_settings by)
{
    by.as_printed = s->as_printed;
    *s = by;
}

static uint32_t share_of(uint32_t n, double share, uint32_t least)
{
    const uint32_t part = (uint32_t)ceil(n * share);

    if (n < least) return n;
    return part > least ? part : least;
}

bis_settings bis_settings_thin(const bis_settings *s, double share)
{
    enum { LANES = 16 }; /* a vector's candidates */
    const bis_parameter *samples = bis_parameter_of(s->integrator, "samples");
    const bool in_sets = s->stratify && bis_parameter_of(s->integrator, "stratify");
    bis_settings thin = *s;

    if (samples && !in_sets) thin.samples = share_of(s->samples, share, (uint32_t)samples->lo);
    thin.shadowrays = share_of(s->shadowrays, share, 1);
    if (s->proposal == BIS_PROPOSAL_PRODUCT) thin.candidates = share_of(s->candidates, share, LANES);
    return thin;
}

bool bis_settings_equal(const bis_settings *a, const bis_settings *b)
{
    if (a->integrator != b->integrator) return false;
    for (const bis_parameter *p = NULL; (p = bis_parameter_next(a->integrator, p)) != NULL;)
        if (bis_parameter_get(p, a) != bis_parameter_get(p, b)) return false;
    return true;
}

static bis_status check(const bis_parameter *p, const bis_settings *s, bis_loc at, bis_diag *diag)
{
    const double v = bis_parameter_get(p, s);
    char demand[160], list[128];

    if (p->type == BIS_PARAMETER_CHOICE) {
        if (p->choices >> (unsigned)v & 1) return BIS_OK;
        return bis_error(diag, BIS_INPUT, at, "\"%s\" is \"%s\": integrator \"%s\" takes %s", p->name,
                         p->names[(unsigned)v], s->integrator->name, bis_parameter_list(list, p, "\""));
    }
    if (v >= p->lo && v <= p->hi) return BIS_OK;
    if (v < p->lo && p->demand) snprintf(demand, sizeof demand, "%s", p->demand);
    else if (v < p->lo) snprintf(demand, sizeof demand, "needs at least %.9g", p->lo);
    else snprintf(demand, sizeof demand, "takes at most %.9g", p->hi);
    return bis_error(diag, BIS_INPUT, at, "\"%s\" is %.9g: integrator \"%s\" %s", p->name, v, s->integrator->name,
                     demand);
}

bis_status bis_settings_check(const bis_settings *s, bis_loc at, bis_diag *diag)
{
    bis_status first = BIS_OK;

    for (const bis_parameter *p = NULL; (p = bis_parameter_next(s->integrator, p)) != NULL;) {
        const bis_status status = check(p, s, at, diag);
        if (!first) first = status;
    }
    return first;
}
