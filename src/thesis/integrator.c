/* integrator: a thread's workspace, and the placeholder auto. */
#include "bis/thesis/integrator.h"

#include "bis/base/mem.h"

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

const bis_integrator bis_auto = {.name = "auto",
    .words = "a pilot tries the methods on the scene itself, and the render goes on with the best",
    .claim = "that of the method which a pilot chooses: unbiased",
    .light_needs = auto_light_needs, .scratch_needs = auto_scratch_needs, .Lo = auto_Lo};
