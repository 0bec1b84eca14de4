/* SPDX-License-Identifier: BSD-2-Clause */
/* pixel_rays: what a method does in one pixel: the candidates of SIR with their weights, and the shadow rays of any
 * integrator.
 *
 * The candidates are what src/thesis/sir.c leaves in its set after one estimate, so that what is shown is what sir
 * does, equations as printed included. Those of proposal "product" are the ones that the first pass of a render draws
 * there.
 *
 * Shadow rays are overheard: the point gets an accelerator that asks the real one and writes down question and answer.
 * So no integrator needs to know that it is watched, and a new one is shown without a line of code. A candidate chosen
 * several times is traced, and written down, once. */
#include "pixel.h"

#include "base/grow.h"

#include "beyond/guide.h"
#include "thesis/proposal.h"

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
    if (c->w <= 0) return false;
    c->product = bis_pixel_product(pt, c->wi);
    c->q_L = bis_light_pdf(pt->light, c->wi);
    c->q_f = bis_bsdf_pdf(&pt->bsdf, c->wi);
    c->q = c->product / c->w;
    return true;
}

/* Copies the candidates of one half to c[n...] and returns the number of all. */
static uint32_t copy_half(bis_pixel_candidates *c, uint32_t n, const bis_set *set, const bis_half *half)
{
    for (uint32_t i = 0; i < half->n; i++) {
        c->c[n++] = (bis_pixel_candidate){.wi = {half->x.x[i], half->x.y[i], half->x.z[i]},
                                          .w = bis_set_weight(set, half->first + i),
                                          .from_map = half == &set->map};
    }
    return n;
}

static void sum_up(bis_pixel_candidates *c, const bis_set *set, const bis_point *pt)
{
    for (uint32_t i = 0; i < c->M; i++) {
        const double w = c->c[i].w;
        c->positive += resolve_q(&c->c[i], pt);
        c->W += w;
        c->square_sum += w * w;
        c->largest = fmax(c->largest, w);
    }
    c->share_em = c->W > 0 ? set->beta : (double)NAN;
    if (c->W <= 0) return;
    c->ess = c->W / c->square_sum * c->W;
    c->largest /= c->W;
}

/* Counts how often each candidate was chosen, and asks once more which of them see the light. The candidates of the
 * BRDF follow those of the map without a gap. */
static void count_chosen(bis_pixel_candidates *c, const bis_point *pt, const bis_set *set)
{
    for (uint32_t j = 0; j < set->choice.n_chosen; j++) {
        uint32_t i;
        const bis_half *half = bis_set_half(set, set->choice.item[j], &i);
        bis_pixel_candidate *y = &c->c[half == &set->map ? i : c->n_map + i];
        y->chosen = set->choice.times[j];
        y->seen = bis_point_sees(pt, y->wi);
        c->distinct++;
        if (y->seen) c->seen += y->chosen;
    }
}

bis_status bis_pixel_candidates_draw(bis_pixel_candidates *c, const bis_point *pt, const bis_settings *s,
                                     bis_stream *stream, bis_diag *diag)
{
    bis_probe probe;
    bis_status status = bis_probe_init(&probe, s, pt->light, diag);

    *c = (bis_pixel_candidates){.M = s->candidates, .N = s->shadowrays};
    if (status) return status;
    c->c = bis_alloc(c->M, sizeof *c->c);
    if (!c->c) {
        status = bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for %u candidates", (unsigned)c->M);
        goto done;
    }
    bis_probe_begin_pass(&probe, pt->light, stream->sampler->seed, 0);
    const rgb L = bis_sir.Lo(s, pt, stream, &probe.scratch);
    const bis_set *set = probe.scratch.set;
    c->L = (rgbd){(double)L.r, (double)L.g, (double)L.b};
    c->n_map = copy_half(c, 0, set, &set->map);
    copy_half(c, c->n_map, set, &set->brdf);
    sum_up(c, set, pt);
    if (c->W <= 0) goto done;
    c->L_ns = bis_set_mean(set);
    count_chosen(c, pt, set);
done:
    bis_probe_clear(&probe);
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
    bis_probe probe;
    const bis_status status = bis_probe_init(&probe, s, pt->light, diag);

    *r = (bis_pixel_rays){.runs = runs};
    if (status) return status;
    watched.accel = &l.accel;
    for (l.run = 0; l.run < runs && !no_memory; l.run++) {
        bis_stream stream;
        bis_stream_init(&stream, sampler, pixel, l.run);
        bis_probe_begin_pass(&probe, pt->light, sampler->seed, l.run);
        s->integrator->Lo(s, &watched, &stream, &probe.scratch);
    }
    bis_probe_clear(&probe);
    return no_memory ? bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for the shadow rays of %u estimates",
                                 (unsigned)runs)
                     : BIS_OK;
}

void bis_pixel_rays_clear(bis_pixel_rays *r)
{
    bis_free(r->ray);
    *r = (bis_pixel_rays){.n = 0};
}

bis_pixel_direction bis_pixel_angles(vec3 w)
{
    const double phi = atan2((double)w.y, (double)w.x) * 180 / PI;
    const double theta = atan2(hypot((double)w.x, (double)w.y), (double)w.z) * 180 / PI;
    return (bis_pixel_direction){theta, phi < 0 ? phi + 360 : phi};
}

bis_pixel_direction bis_pixel_direction_of(const bis_xform *light_to_world, vec3 wi)
{
    const bis_xform to_light = bis_xform_inverse(light_to_world);
    return bis_pixel_angles(bis_xform_vector(&to_light, wi));
}
