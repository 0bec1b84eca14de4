/* SPDX-License-Identifier: BSD-2-Clause */
/* tiny: see tiny.h. */
#include "tiny.h"

#include "bis/thesis/rng.h"
#include "bis/scene/light_load.h"
#include "claim.h"
#include "set_help.h"

#include <math.h>

#define OCTANT (PI / 2) /* sr */

int tiny_pixel(vec3 w)
{
    static const int column[2][2] = {{0, 1}, {3, 2}}; /* phi grows from +x to +y to -x to -y */

    return (w.z < 0 ? 4 : 0) + column[w.y < 0][w.x < 0];
}

/* ---- the BRDF ---- */

static const tiny_material *material_of(const bis_bsdf *b) { return (const tiny_material *)b->material; }

/* Two "lobes" that are one: half the numbers go to each, so that what the mixture makes of p_specular is at work. */
static void init(bis_bsdf *b)
{
    b->r = b->local.z;
    b->lobe = b->local;
    b->p_specular = 0.5;
}

static rgb f_pdf(const bis_bsdf *b, vec3 wi, double *pdf)
{
    double cos_theta = bis_bsdf_cos(b, wi);

    *pdf = material_of(b)->pick[tiny_pixel(wi)] / OCTANT;
    return cos_theta > 0 ? rgb_scale(material_of(b)->f_cos[tiny_pixel(wi)], 1 / cos_theta) : (rgb){0, 0, 0};
}

static vec3 in_octant(int pixel, double u1, double u2)
{
    double z = (pixel < 4 ? 1 : -1) * u1, phi = PI / 2 * (pixel % 4 + u2), s = sqrt(1 - z * z);
    return vec3_from(s * cos(phi), s * sin(phi), z);
}

static bool sample(const bis_bsdf *b, double u0, double u1, double u2, vec3 *wi)
{
    const double *pick = material_of(b)->pick;
    int k = 0;

    while (k < TINY_PIXELS - 1 && u1 >= pick[k]) u1 -= pick[k++];
    *wi = in_octant(k, fmin(u1 / pick[k], 1), u2);
    return true;
}

/* Bounds that are not tight: nothing may depend on that. */
static double max_f_cos(const bis_bsdf *b)
{
    double m = 0;
    for (int k = 0; k < TINY_PIXELS; k++) m = fmax(m, rgb_max(material_of(b)->f_cos[k]));
    return 1.1 * m;
}

static double max_ratio(const bis_bsdf *b)
{
    double m = 0;
    for (int k = 0; k < TINY_PIXELS; k++)
        m = fmax(m, rgb_max(material_of(b)->f_cos[k]) / (material_of(b)->pick[k] / OCTANT));
    return 1.1 * m;
}

static const bis_bsdf_model model = {
    .name = "tiny", .init = init, .sample = sample, .f_pdf = f_pdf, .max_f_cos = max_f_cos, .max_ratio = max_ratio};

/* ---- the point ---- */

static bool occluded(const bis_accel *a, const ray *r)
{
    const tiny_accel *accel = (const tiny_accel *)a;
    int k = tiny_pixel(r->d);

    accel->rays[k]++;
    return accel->hidden[k];
}

static const bis_accel_ops counting = {.name = "tiny", .occluded = occluded};

static void init_light(tiny *t)
{
    static const rgb L[TINY_PIXELS] = {{1, 2, 3}, {9, 7, 5}, {0.5f, 0.1f, 0.2f}, {2, 0, 0},
                                       {0, 1, 4}, {0, 0, 0}, {30, 20, 10},       {0.3f, 0.3f, 0.3f}};
    const bis_light_desc desc = {.L = {1, 1, 1}, .scale = 1, .levels = 8, .to_world = bis_xform_identity()};
    double power = 0;
    bis_image image;
    bis_envmap em;

    assert_int_equal(bis_image_init(&image, 4, 2, NULL), BIS_OK);
    for (int k = 0; k < TINY_PIXELS; k++) image.pixels[k] = L[k];
    assert_int_equal(bis_envmap_from_latlong(&em, &image, NULL), BIS_OK);
    assert_int_equal(bis_light_from_envmap(&t->light, &em, &desc, BIS_NEED_TABLE | BIS_NEED_CURVE, NULL), BIS_OK);
    for (int k = 0; k < TINY_PIXELS; k++) power += rgb_sum(L[k]);
    for (int k = 0; k < TINY_PIXELS; k++) t->p_em[k] = rgb_sum(L[k]) / power;
}

/* Which pixel comes when along the curve: only the order is asked for, the shares are known. */
static void find_order(tiny *t)
{
    int n = 0;

    for (int i = 0; i < 4096; i++) {
        bis_light_point y;
        assert_true(bis_light_sample_curve(t->light, (i + 0.5) / 4096, (double[2]){0.5, 0.5}, &y));
        if (n == 0 || t->place[n - 1] != tiny_pixel(y.wi)) t->place[n++] = tiny_pixel(y.wi);
        assert_true(n < TINY_PIXELS); /* one of the 8 is black */
    }
    t->place[n] = 5;
}

static void find_horizon(tiny *t)
{
    enum { K = 400 };

    for (int k = 0; k < TINY_PIXELS; k++) {
        int n = 0;
        for (int i = 0; i < K * K; i++)
            n += dot(t->pt.n, in_octant(k, (i % K + 0.5) / K, ((int)(i / K) + 0.5) / K)) > 0;
        t->above[k] = (double)n / (K * K);
    }
}

void tiny_init(tiny *t)
{
    static const rgb f_cos[TINY_PIXELS] = {{0.3f, 0.3f, 0.3f}, {0.02f, 0.1f, 0.2f}, {0.2f, 0.2f, 0}, {0.1f, 0.1f, 0.3f},
        {0.3f, 0.05f, 0.05f}, {0.1f, 0.1f, 0.1f}, {0.05f, 0.02f, 0.04f}, {0.1f, 0.2f, 0.3f}};
    static const double pick[TINY_PIXELS] = {0.3, 0.05, 0.15, 0.1, 0.15, 0.1, 0.05, 0.1};
    const vec3 n = normalize(vec3_from(0.4, -0.5, 0.6));

    *t = (tiny){.material = {.material = {.model = &model, .Kd = {0.5f, 0.5f, 0.5f}, .Ks = {0.5f, 0.5f, 0.5f}}},
                .accel = {.accel = {.ops = &counting}}};
    for (int k = 0; k < TINY_PIXELS; k++) {
        t->material.f_cos[k] = f_cos[k];
        t->material.pick[k] = pick[k];
    }
    t->accel.rays = t->rays;
    /* octants of large weights: V and w depend on each other */
    t->accel.hidden[0] = t->accel.hidden[3] = t->accel.hidden[7] = true;
    init_light(t);
    t->pt =
        (bis_point){.n = n, .ng = n, .wo = n, .light = t->light, .accel = &t->accel.accel, .counters = &t->counters};
    bis_bsdf_init(&t->pt.bsdf, &t->material.material, n, n);
    find_order(t);
    find_horizon(t);
}

void tiny_clear(tiny *t) { bis_light_free(t->light); }

/* ---- enumeration ---- */

static rgbd F(const tiny *t, int k)
{
    const rgb a = t->material.f_cos[k], L = bis_light_envmap(t->light)->pixels[k];
    return (rgbd){(double)a.r * (double)L.r, (double)a.g * (double)L.g, (double)a.b * (double)L.b};
}

rgbd tiny_truth(const tiny *t, bool with_V)
{
    rgbd sum = {0, 0, 0};

    for (int k = 0; k < TINY_PIXELS; k++) {
        if (!with_V || !t->accel.hidden[k]) sum = rgbd_add(sum, rgbd_scale(F(t, k), t->above[k] * OCTANT));
    }
    return sum;
}

/* beta of the mixture, from the weight of the first candidate that has one: F/w = q = beta q_L + (1 - beta) q_f. w is
 * off by less than 2^-21, because seven roundings to a float make it: F's three factors, two sums, q, the quotient. */
static double find_beta(tiny *t, bis_proposal proposal, uint32_t M)
{
    static const bis_sampler sampler = {.kind = BIS_SAMPLER_RANDOM, .seed = 1, .spp = 1};
    bis_settings s = bis_settings_default(&bis_sir);
    bis_scratch scratch;
    double beta = -1;

    s.candidates = M;
    assert_int_equal(bis_scratch_init(&scratch, &s, NULL), BIS_OK);
    for (uint64_t run = 0; beta < 0; run++) {
        const bis_set *x = scratch.set;
        bis_stream stream;
        bis_stream_init(&stream, &sampler, run, 0);
        assert_true(bis_set_draw(scratch.set, M, proposal, false, &t->pt, &stream));
        bis_set_weigh(scratch.set, &t->pt);
        const uint32_t number = set_number(x, 0);
        const int k = tiny_pixel(set_direction(x, number));
        if (bis_set_weight(x, number) <= 0) continue;
        const double em = t->p_em[k], brdf = t->material.pick[k],
                     q = rgbd_sum(F(t, k)) / bis_set_weight(x, number) * OCTANT;
        beta = (q - brdf) / (em - brdf);
        const double n_em = round(beta * M), error = 0x1p-21 * q / fabs(em - brdf);
        if (M == 1) continue;
        assert_true(fabs(beta - n_em / M) <= error);
        beta = n_em / M;
    }
    bis_scratch_clear(&scratch);
    return beta;
}

/* P of one candidate from the map; the i-th of n strata of the curve. */
static void states_em(double P[TINY_STATES], const tiny *t, uint32_t i, uint32_t n)
{
    double at = 0;

    P[TINY_NOTHING] = 1;
    for (int j = 0; j < TINY_PIXELS; j++) {
        int k = t->place[j];
        double from = fmax(at, (double)i / n), to = fmin(at + t->p_em[k], (double)(i + 1) / n);
        P[k] = rgbd_sum(F(t, k)) > 0 ? fmax(0, to - from) * n * t->above[k] : 0;
        P[TINY_NOTHING] -= P[k];
        at += t->p_em[k];
    }
}

static void states_brdf(double P[TINY_STATES], const tiny *t)
{
    P[TINY_NOTHING] = 1;
    for (int k = 0; k < TINY_PIXELS; k++) {
        P[k] = rgbd_sum(F(t, k)) > 0 ? t->material.pick[k] * t->above[k] : 0;
        P[TINY_NOTHING] -= P[k];
    }
}

tiny_candidates tiny_enumerate(tiny *t, bis_proposal proposal, bool stratify, uint32_t M)
{
    tiny_candidates c = {.M = M};
    double beta = proposal == BIS_PROPOSAL_EM ? 1 : proposal == BIS_PROPOSAL_BRDF ? 0 : find_beta(t, proposal, M);
    uint32_t n_em = (uint32_t)lround(beta * M);

    assert_true(!stratify || proposal == BIS_PROPOSAL_EM);
    assert_true(beta >= 0 && beta <= 1);
    for (int k = 0; k < TINY_PIXELS; k++) {
        double q = (beta * t->p_em[k] + (1 - beta) * t->material.pick[k]) / OCTANT;
        c.C[k] = q > 0 ? rgbd_scale(F(t, k), 1 / q) : (rgbd){0, 0, 0};
    }
    for (uint32_t i = 0; i < M; i++) {
        double em[TINY_STATES], brdf[TINY_STATES], share = M == 1 ? beta : i < n_em;
        states_em(em, t, stratify ? i : 0, stratify ? M : 1);
        states_brdf(brdf, t);
        for (int k = 0; k < TINY_STATES; k++) c.P[i][k] = share * em[k] + (1 - share) * brdf[k];
    }
    return c;
}

void tiny_for_all(const tiny_candidates *c, tiny_visit *visit, void *data)
{
    int n = 1;

    assert_true(c->M <= 3);
    for (uint32_t i = 0; i < c->M; i++) n *= TINY_STATES;
    for (int tuple = 0; tuple < n; tuple++) {
        int state[TINY_MAX_M] = {0}, rest = tuple;
        double probability = 1;
        for (uint32_t i = 0; i < c->M; i++, rest /= TINY_STATES) probability *= c->P[i][state[i] = rest % TINY_STATES];
        if (probability > 0) visit(state, probability, data);
    }
}

rgb tiny_once(tiny *t, const bis_settings *s, bis_scratch *scratch, uint64_t seed, uint64_t run)
{
    const bis_sampler sampler = {.kind = BIS_SAMPLER_RANDOM, .seed = seed, .spp = 1};
    bis_stream stream;

    bis_stream_init(&stream, &sampler, run, 0);
    return s->integrator->Lo(s, &t->pt, &stream, scratch);
}
