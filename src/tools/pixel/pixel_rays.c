/* pixel_rays: what a method does in one pixel: the candidates of SIR with their weights, and the shadow rays of any
 * integrator.
 *
 * The candidates are what src/thesis/sir.c leaves in its workspace after one estimate, so that what is shown is what
 * sir does, equations as printed included. Which of them came from the map is not written on a candidate, but its
 * density is: q = phat/w, and q = beta q_L + (1 - beta) q_f has one unknown, which the candidate tells best for which
 * q_L and q_f differ most. The first beta M are from the map.
 *
 * Shadow rays are overheard: the point gets an accelerator that asks the real one and writes down question and answer.
 * So no integrator needs to know that it is watched, and a new one is shown without a line of code. A candidate chosen
 * several times is traced, and written down, once. */
#include "pixel.h"

#include "base/grow.h"

#include "thesis/as_printed.h"
#include "thesis/candidates.h"
#include "thesis/proposal.h"
#include "thesis/sir.h"

double bis_pixel_product(const bis_point *pt, vec3 wi)
{
    const double cos_theta = bis_bsdf_cos(&pt->bsdf, wi);
    if (cos_theta <= 0) return 0;
    return rgbd_sum(bis_estimate(bis_bsdf_f(&pt->bsdf, wi), bis_light_Le(pt->light, wi), cos_theta, 1));
}

/* ---- candidates ---- */

static bool resolve_q(bis_pixel_candidate *c, const bis_point *pt)
{
    c->q_L = c->q_f = c->q = (double)NAN;
    if (c->x.w <= 0) return false;
    c->product = bis_pixel_product(pt, c->x.wi);
    c->q_L = bis_light_pdf(pt->light, c->x.wi);
    c->q_f = bis_bsdf_pdf(&pt->bsdf, c->x.wi);
    c->q = c->product / c->x.w;
    return true;
}

/* beta of the mixture, NAN where no candidate tells, and where q is another mixture. */
static double share_of_map(const bis_pixel_candidates *c, bis_proposal proposal, const bis_point *pt)
{
    double best = 0, beta = (double)NAN;

    if (proposal == BIS_PROPOSAL_EM) return 1;
    if (proposal == BIS_PROPOSAL_BRDF || bis_light_is_constant(pt->light)) return 0;
    if (c->M == 1 || (proposal != BIS_PROPOSAL_MIX && proposal != BIS_PROPOSAL_PRODUCT)) return beta;
    for (uint32_t i = 0; i < c->M; i++) {
        const bis_pixel_candidate *x = &c->c[i];
        if (x->x.w <= 0) continue;
        const double difference = fabs(x->q_L - x->q_f) / (x->q_L + x->q_f);
        if (difference <= best) continue;
        best = difference;
        beta = (x->q - x->q_f) / (x->q_L - x->q_f);
    }
    return round(beta * c->M) / c->M; /* q is rounded, n_em/M is not */
}

static void sum_up(bis_pixel_candidates *c, bis_proposal proposal, const bis_point *pt)
{
    for (uint32_t i = 0; i < c->M; i++) {
        const double w = c->c[i].x.w;
        c->positive += resolve_q(&c->c[i], pt);
        c->square_sum += w * w;
        c->largest = fmax(c->largest, w);
    }
    if (c->W <= 0) {
        c->share_em = (double)NAN;
        return;
    }
    c->ess = c->W / c->square_sum * c->W;
    c->largest /= c->W;
    c->share_em = share_of_map(c, proposal, pt);
    for (uint32_t i = 0; i < c->M; i++) c->c[i].from_map = i < c->share_em * c->M;
}

/* Counts how often each candidate was chosen, and asks once more which of them see the light. */
static void count_chosen(bis_pixel_candidates *c, const bis_point *pt, const bis_scratch *scratch)
{
    for (uint32_t j = 0; j < c->N; j++) c->c[scratch->chosen[j]].chosen++;
    for (uint32_t i = 0; i < c->M; i++) {
        bis_pixel_candidate *x = &c->c[i];
        if (x->chosen == 0) continue;
        x->seen = bis_point_sees(pt, x->x.wi);
        c->distinct++;
        if (x->seen) c->seen += x->chosen;
    }
}

bis_status bis_pixel_candidates_draw(bis_pixel_candidates *c, const bis_point *pt, const bis_settings *s,
                                     bis_stream *stream, bis_diag *diag)
{
    bis_scratch scratch;
    bis_status status = bis_scratch_init(&scratch, s, diag);

    *c = (bis_pixel_candidates){.M = s->candidates, .N = s->shadowrays};
    if (status) return status;
    c->c = bis_alloc(c->M, sizeof *c->c);
    if (!c->c) {
        status = bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for %u candidates", (unsigned)c->M);
        goto done;
    }
    c->L = bis_sir_estimate(s, pt, stream, &scratch, &c->W);
    for (uint32_t i = 0; c->W > 0 && i < c->M; i++) c->c[i].x = scratch.candidates[i];
    sum_up(c, s->proposal, pt);
    if (c->W <= 0) goto done;
    c->L_ns = bis_candidates_unoccluded(scratch.candidates, c->M);
    count_chosen(c, pt, &scratch);
done:
    bis_scratch_clear(&scratch);
    return status;
}

void bis_pixel_candidates_clear(bis_pixel_candidates *c)
{
    bis_free(c->c);
    *c = (bis_pixel_candidates){.M = 0};
}

/* ---- shadow rays ---- */

typedef struct listener {
    bis_accel accel; /* first: what an integrator sees */
    const bis_accel *real;
    bis_pixel_rays *rays;
    uint32_t run;
    bool *no_memory;
} listener;

static bool listen(const bis_accel *a, const ray *r)
{
    const listener *l = (const listener *)a;
    const bool occluded = bis_accel_occluded(l->real, r);
    bis_pixel_rays *rays = l->rays;
    if (BIS_ROOM(rays->ray, rays->capacity, rays->n))
        rays->ray[rays->n++] = (bis_pixel_ray){.wi = r->d, .run = l->run, .seen = !occluded};
    else *l->no_memory = true;
    return occluded;
}

bis_status bis_pixel_rays_record(bis_pixel_rays *r, const bis_point *pt, const bis_settings *s,
                                 const bis_sampler *sampler, uint64_t pixel, uint32_t runs, bis_diag *diag)
{
    static const bis_accel_ops ops = {.name = "listener", .occluded = listen};
    bool no_memory = false;
    listener l = {.accel = {&ops, NULL}, .real = pt->accel, .rays = r, .no_memory = &no_memory};
    bis_point watched = *pt;
    bis_scratch scratch;
    bis_status status = bis_scratch_init(&scratch, s, diag);

    *r = (bis_pixel_rays){.runs = runs};
    if (status) return status;
    watched.accel = &l.accel;
    for (l.run = 0; l.run < runs && !no_memory; l.run++) {
        bis_stream stream;
        bis_stream_init(&stream, sampler, pixel, l.run);
        s->integrator->Lo(s, &watched, &stream, &scratch);
    }
    bis_scratch_clear(&scratch);
    return no_memory ? bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for the shadow rays of %u estimates",
                                 (unsigned)runs)
                     : BIS_OK;
}

void bis_pixel_rays_clear(bis_pixel_rays *r)
{
    bis_free(r->ray);
    *r = (bis_pixel_rays){.n = 0};
}
