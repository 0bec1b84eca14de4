/* integrator: the list of estimators, the defaults and limits of their parameters, and a thread's workspace. */
#include "bis/thesis/integrator.h"

#include "bis/base/mem.h"

#include <string.h>

const bis_integrator *const bis_integrators[] = {&bis_em, &bis_brdf, &bis_mis, &bis_rejection,
                                                 &bis_sir, &bis_exact, &bis_unoccluded, NULL};

const bis_integrator *bis_integrator_find(const char *name)
{
    for (const bis_integrator *const *p = bis_integrators; *p; p++) {
        if (strcmp((*p)->name, name) == 0) return *p;
    }
    return strcmp(bis_auto.name, name) == 0 ? &bis_auto : NULL;
}

bis_settings bis_settings_default(const bis_integrator *integrator)
{
    return (bis_settings){
        .integrator = integrator,
        .samples = 16,
        .candidates = 800,
        .shadowrays = 15,
        .perpatch = 1,
        .proposal = integrator == &bis_rejection ? BIS_PROPOSAL_CHOOSE : BIS_PROPOSAL_MIX,
        .heuristic = BIS_HEURISTIC_BALANCE,
        .resampling = BIS_RESAMPLING_SYSTEMATIC,
        .estimator = BIS_ESTIMATOR_RATIO,
        .fallback = BIS_FALLBACK_RESAMPLE,
        .split = 0.5,
        .compensate = false,
        .stratify = integrator != &bis_em && integrator != &bis_mis,
        .learn = false,
        .vectorize = true,
    };
}

void bis_settings_leave_open(bis_settings *s)
{
    if (s->integrator != &bis_sir || s->candidates > 0) return;
    s->integrator = &bis_auto;
    s->only_sir = true;
    s->candidates = bis_settings_default(&bis_sir).candidates;
}

const char *bis_proposal_name(bis_proposal p)
{
    static const char *const names[] = {[BIS_PROPOSAL_EM] = "em",
                                        [BIS_PROPOSAL_BRDF] = "brdf",
                                        [BIS_PROPOSAL_MIX] = "mix",
                                        [BIS_PROPOSAL_CHOOSE] = "choose",
                                        [BIS_PROPOSAL_PRODUCT] = "product"};

    return names[p];
}

/* ---- limits ---- */

static bis_status check_count(uint32_t value, const char *name, const char *what, const bis_settings *s, bis_loc at,
                              bis_diag *diag)
{
    if (value >= 1) return BIS_OK;
    return bis_error(diag, BIS_INPUT, at, "\"%s\" is 0: integrator \"%s\" needs at least 1 %s", name,
                     s->integrator->name, what);
}

static bis_status check_mis(const bis_settings *s, bis_loc at, bis_diag *diag)
{
    if (s->samples < 2) {
        return bis_error(diag, BIS_INPUT, at,
                         "\"samples\" is %u: integrator \"mis\" divides them between map and BRDF and needs at least 2 "
                         "(for a single one take "
                         "\"em\" or \"brdf\")",
                         (unsigned)s->samples);
    }
    if (s->split >= 0 && s->split <= 1) return BIS_OK;
    return bis_error(diag, BIS_INPUT, at,
                     "\"split\" is %g: the share of samples from the map must be in [0, 1] (0.5 is the default)",
                     s->split);
}

static bis_status check_proposal(const bis_settings *s, bis_loc at, bis_diag *diag)
{
    const bool rejects = s->integrator == &bis_rejection;
    const bis_proposal foreign = rejects ? BIS_PROPOSAL_MIX : BIS_PROPOSAL_CHOOSE;

    if (s->proposal != foreign && (s->proposal != BIS_PROPOSAL_PRODUCT || s->integrator == &bis_sir)) return BIS_OK;
    return bis_error(diag, BIS_INPUT, at, "\"proposal\" is \"%s\": integrator \"%s\" takes \"em\", \"brdf\"%s",
                     bis_proposal_name(s->proposal), s->integrator->name,
                     rejects                     ? " or \"choose\""
                     : s->integrator == &bis_sir ? ", \"mix\" or \"product\""
                                                 : " or \"mix\"");
}

bis_status bis_settings_check(const bis_settings *s, bis_loc at, bis_diag *diag)
{
    const bis_integrator *i = s->integrator;

    if (i == &bis_auto) return BIS_OK;
    if (i == &bis_mis) return check_mis(s, at, diag);
    if (i == &bis_em || i == &bis_brdf) return check_count(s->samples, "samples", "sample", s, at, diag);
    if (i == &bis_exact) return check_count(s->perpatch, "perpatch", "ray in a patch", s, at, diag);

    bis_status status = check_count(s->candidates, "candidates", "candidate", s, at, diag);
    bis_status rays =
        i == &bis_unoccluded ? BIS_OK : check_count(s->shadowrays, "shadowrays", "shadow ray", s, at, diag);
    bis_status proposal = check_proposal(s, at, diag);
    return status ? status : rays ? rays : proposal;
}

/* ---- workspace ---- */

static bis_needs needs_of(const bis_settings *s)
{
    bis_needs need = {0, 0, 0, 0};

    s->integrator->scratch_needs(s, &need);
    return need;
}

bis_status bis_scratch_init(bis_scratch *scratch, const bis_settings *s, bis_diag *diag)
{
    const bis_needs need = needs_of(s);

    *scratch = (bis_scratch){
        .candidates = bis_alloc(need.n_candidates, sizeof *scratch->candidates),
        .u = bis_alloc(need.n_points, sizeof *scratch->u),
        .chosen = bis_alloc(need.n_chosen, sizeof *scratch->chosen),
    };
    if (scratch->candidates && scratch->u && scratch->chosen) return BIS_OK;
    bis_scratch_clear(scratch);
    return bis_error(diag, BIS_NOMEM, (bis_loc){NULL, 0, 0},
                     "no memory for a thread's %u candidates, %u chosen ones and %u sample points of integrator "
                     "\"%s\"; fewer of them need less",
                     (unsigned)need.n_candidates, (unsigned)need.n_chosen, (unsigned)need.n_points,
                     s->integrator->name);
}

void bis_scratch_clear(bis_scratch *scratch)
{
    bis_free(scratch->candidates);
    bis_free(scratch->u);
    bis_free(scratch->chosen);
    *scratch = (bis_scratch){.sets = NULL};
}

size_t bis_scratch_bytes(const bis_settings *s)
{
    const bis_needs need = needs_of(s);

    return need.n_candidates * sizeof(bis_candidate) + need.n_points * sizeof(double[2]) +
           need.n_chosen * sizeof(uint32_t);
}

/* ---- auto ---- */

static unsigned auto_light_needs(const bis_settings *s) { return bis_sir.light_needs(s); }
static void auto_scratch_needs(const bis_settings *s, bis_needs *need) { bis_sir.scratch_needs(s, need); }
static rgb auto_Lo(const bis_settings *s, const bis_point *pt, bis_stream *stream, bis_scratch *scratch)
{
    return bis_sir.Lo(s, pt, stream, scratch);
}

const bis_integrator bis_auto = {"auto", "that of the method which a pilot chooses: unbiased", auto_light_needs,
                                 auto_scratch_needs, auto_Lo};
