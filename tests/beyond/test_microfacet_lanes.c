/* microfacet_lanes: weights, colours and draws of many directions at once against microfacet.c in double, one by one,
 * and against quadrature and closed forms. Family-wise significance 1e-3. */
#include "beyond/microfacet_lanes.h"

#include "beyond/batch.h"
#include "bis/base/mem.h"
#include "bis/beyond/microfacet.h"
#include "bis/thesis/rng.h"
#include "bis/thesis/warp.h"
#include "clones.h"
#include "facets.h"

#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

enum { SEED = 2019, N = 4096 };
#define COUNT(a) ((int)(sizeof(a) / sizeof *(a)))

static const double roughnesses[] = {BIS_MICROFACET_MIN_ROUGHNESS, 0.03, 0.1, 0.3, 0.55, 0.8, 1};
enum { N_ROUGHNESSES = COUNT(roughnesses) };

/* facets 7 x 4, mixtures 3 x 3, furnace 7 x 5 + 5, sir 32 x 4; and twins */
static double alpha(void)
{
    return stat_level(1e-3, 28 + 9 + 40 + 128);
}

/* Copper; all kinds of channels: a dielectric that absorbs little, one with total reflection, a mirror without any. */
static bis_material copper(double roughness)
{
    return bis_microfacet_metal((rgb){0.952f, 0.62f, 0.511f}, (rgb){0.2f, 0.924f, 1.102f}, roughness);
}
static bis_material odd_metal(double roughness)
{
    return bis_microfacet_metal((rgb){0.05f, 0.11f, 1}, (rgb){1.5f, 0.6f, 3}, roughness);
}

/* One channel has the base alone; total reflection. */
static bis_material plastic(double roughness)
{
    return bis_plastic((rgb){0.2f, 0.5f, 0.3f}, (rgb){0.04f, 0.02f, 0}, 1.5, roughness);
}
static bis_material odd_plastic(double roughness)
{
    return bis_plastic((rgb){0.1f, 0, 0.7f}, (rgb){0.0625f, 0.03f, 0.01f}, 0.6, roughness);
}

/* One of the kinds whose F is Fresnel's; plastic of an index of 1, which has no lobe. */
static bis_material fresnels(int k, double roughness)
{
    if (k % 5 == 4) return bis_plastic(grey(0.5), grey(0.3), 1, roughness);
    return (bis_material(*const[])(double)){odd_metal, copper, plastic, odd_plastic}[k % 5](roughness);
}

static bis_lanes new_lanes(uint32_t n)
{
    return bis_lanes_in(bis_alloc(BIS_LANES_ARRAYS * (size_t)n, sizeof(float)), n);
}
static void free_lanes(const bis_lanes *l)
{
    bis_free(l->x);
}
static vec3 direction(const bis_lanes *l, uint32_t i)
{
    return (vec3){l->x[i], l->y[i], l->z[i]};
}

static void seen_from(bis_bsdf *b, const bis_material *m, double degrees)
{
    const frame about_n = frame_about(normalize(vec3_from(0.3, -0.5, 0.7)));
    const double t = degrees * PI / 180;

    bis_bsdf_init(b, m, about_n.z, normalize(to_world(&about_n, vec3_from(sin(t) * 0.6, sin(t) * 0.8, cos(t)))));
}

/* wo mirrored about a facet of tangent t and azimuth phi. */
static vec3 mirrored(const bis_bsdf *b, double t, double phi)
{
    const vec3 h = normalize(to_world(&b->local, vec3_from(t * cos(phi), t * sin(phi), 1)));
    const double k = 2 * dot(h, b->wo);

    return normalize(vec3_from(k * (double)h.x - (double)b->wo.x, k * (double)h.y - (double)b->wo.y,
                               k * (double)h.z - (double)b->wo.z));
}

/* Directions of facets from the core of the lobe far into its tail, next to the horizon, about the mirror direction,
 * everywhere; radiance over 12 decades, some of it black in a channel or in all. */
static void fill(const bis_lanes *l, uint32_t n, const bis_bsdf *b, uint64_t seed)
{
    const double a = b->material->alpha;
    bis_rng r;

    bis_rng_init(&r, SEED, seed, 0, 0);
    for (uint32_t i = 0; i < n; i++) {
        const double u = bis_rng_double(&r), phi = 2 * PI * bis_rng_double(&r), near = exp(-16 * u);
        vec3 w = mirrored(b, a * exp(12 * u - 6), phi);
        if (i % 4 == 1) w = to_world(&b->local, vec3_from(cos(near) * cos(phi), cos(near) * sin(phi), sin(near)));
        if (i % 4 == 2) w = normalize(add(b->r, mul(bis_warp_sphere(bis_rng_double(&r), bis_rng_double(&r)), near)));
        if (i % 4 == 3) w = bis_warp_sphere(u, phi / (2 * PI));
        if (i < 6) w = (const vec3[]){b->r, neg(b->r), b->local.z, neg(b->local.z), neg(b->wo), b->wo}[i];
        l->x[i] = w.x, l->y[i] = w.y, l->z[i] = w.z;
        const double level = exp2(20 * bis_rng_double(&r) - 20);
        l->r[i] = i % 7 == 3 ? 0 : (float)(level * bis_rng_double(&r));
        l->g[i] = i % 7 == 3 ? 0 : (float)(level * bis_rng_double(&r));
        l->b[i] = i % 7 == 3 || i % 7 == 5 ? 0 : (float)(level * bis_rng_double(&r));
        l->q[i] =
            i % 7 == 3 ? 0 : (float)(level * (0.1 + bis_rng_double(&r))); /* a black pixel may have no density at all */
    }
}

/* ---- weights ---- */

typedef struct exact {
    double w, cos_i, cos_d, F[3], of_fresnel; /* F = f cos Le; the relative error that is stated for Fresnel's term */
} exact;

/* Of F, what a cos theta_d that is off by 2^-21 changes, and the roundings of a root of F that is sqrt(Ks) at least. */
static double stated_of_metal(double Ks, double eta, double c)
{
    const double F = lit_fresnel(Ks, eta, c), up = lit_fresnel(Ks, eta, fmin(1, c + 0x1p-21)),
                 down = lit_fresnel(Ks, eta, fmax(0, c - 0x1p-21));

    return fmax(fabs(up - F), fabs(down - F)) / F + 0x1p-19 / sqrt(Ks);
}

static exact weigh_one(const bis_bsdf *b, const bis_lanes *l, uint32_t i, double beta)
{
    const vec3 wi = direction(l, i);
    const double s[3] = {(double)wi.x + (double)b->wo.x, (double)wi.y + (double)b->wo.y,
                         (double)wi.z + (double)b->wo.z};
    const double Ks[3] = {(double)b->material->Ks.r, (double)b->material->Ks.g, (double)b->material->Ks.b};
    const double eta[3] = {(double)b->material->eta.r, (double)b->material->eta.g, (double)b->material->eta.b};
    double q_f;
    const rgb f = bis_bsdf_f_pdf(b, wi, &q_f);
    exact e = {.cos_i = bis_bsdf_cos(b, wi), .cos_d = sqrt(s[0] * s[0] + s[1] * s[1] + s[2] * s[2]) / 2};
    const double c = fmax(0, e.cos_i), x4 = pow(1 - e.cos_d, 4);

    e.F[0] = (double)f.r * c * (double)l->r[i];
    e.F[1] = (double)f.g * c * (double)l->g[i];
    e.F[2] = (double)f.b * c * (double)l->b[i];
    for (int k = 0; k < 3; k++)
        if (Ks[k] > 0 && eta[k] > 0)
            e.of_fresnel = fmax(e.of_fresnel, stated_of_metal(Ks[k], eta[k], e.cos_d));
        else if (Ks[k] > 0)
            e.of_fresnel =
                fmax(e.of_fresnel, 0x1p-21 * 5 * (1 - Ks[k]) * x4 / (Ks[k] + (1 - Ks[k]) * x4 * (1 - e.cos_d)));
    const double phat = e.F[0] + e.F[1] + e.F[2];
    e.w = phat > 0 ? phat / (beta * (double)l->q[i] + (1 - beta) * q_f) : 0;
    return e;
}

/* What is stated for f cos; for q as well, the lobe and a cosine once more. */
static double stated_f(const exact *e, bool has_lobe)
{
    return 2 * 0x1p-20 / e->cos_i + 0x1p-19 + (has_lobe ? 0x1p-18 / e->cos_d + e->of_fresnel : 0);
}

static double stated_w(const exact *e, bool has_lobe)
{
    return stated_f(e, has_lobe) + 0x1p-20 / e->cos_i + (has_lobe ? 0x1p-18 / e->cos_d : 0);
}

typedef struct errors {
    double of_stated, in_head; /* the largest ratio of an error to what is stated; the largest error where both cosines
                                  are above 0.3 */
    uint32_t n;
} errors;

static void check_weights(errors *most, const bis_bsdf_lanes *lanes, const bis_bsdf *b, const bis_lanes *l, uint32_t n,
                          double beta)
{
    float *w = bis_alloc(bis_lanes_round_up(n), sizeof *w);
    const double unit = lanes->weigh(w, b, l, n, beta);
    const bool has_lobe = b->p_specular > 0;

    assert_true(isfinite(unit) && unit > 0);
    for (uint32_t i = 0; i < n; i++) {
        const exact e = weigh_one(b, l, i, beta);
        assert_true(isfinite(w[i]) && w[i] >= 0);
        if (e.cos_i < -0x1p-20) assert_true(w[i] == 0);
        if (fabs(e.cos_i) <= 0x1p-20) continue; /* next to the horizon a float does not know the side */
        if (e.w == 0) {
            assert_true(w[i] == 0);
            continue;
        }
        assert_true(w[i] > 0);
        const double error = fabs((double)w[i] * unit / e.w - 1);
        most->of_stated = fmax(most->of_stated, error / stated_w(&e, has_lobe));
        if (e.cos_i > 0.3 && e.cos_d > 0.3 && e.of_fresnel < 1e-5) most->in_head = fmax(most->in_head, error);
        most->n++;
    }
    bis_free(w);
}

static const double betas[] = {1, 0.5, 1.0 / 800, 799.0 / 800};

static errors weigh_everything(const bis_bsdf_lanes *lanes, double roughness)
{
    const bis_material materials[] = {bis_microfacet(grey(0), (rgb){0.9f, 0.5f, 0.1f}, roughness),
                                      bis_microfacet((rgb){0.8f, 0.3f, 0}, grey(0.04), roughness),
                                      bis_microfacet((rgb){0.8f, 0.3f, 0.1f}, grey(0), roughness),
                                      bis_microfacet(grey(0), grey(1), roughness),
                                      bis_microfacet(grey(1e-19), (rgb){1e-20f, 0, 1e-3f}, roughness),
                                      copper(roughness), odd_metal(roughness), plastic(roughness), odd_plastic(roughness),
                                      bis_plastic((rgb){0.8f, 0.3f, 0}, grey(0), 1.5, roughness),
                                      bis_plastic(grey(0.5), grey(0.3), 1, roughness)};
    static const double degrees[] = {0, 40, 85, 89.9, 89.999};
    const bis_lanes l = new_lanes(N);
    errors most = {0};

    for (int k = 0; k < COUNT(materials) * COUNT(degrees) * COUNT(betas); k++) {
        const double beta = betas[k % 4];
        bis_bsdf b;
        seen_from(&b, &materials[k / 4 % COUNT(materials)], degrees[k / 4 / COUNT(materials)]);
        fill(&l, N, &b, (uint64_t)k);
        for (uint32_t i = 0; beta == 1 && i < N; i++)
            l.q[i] = fmaxf(l.q[i], FLT_MIN); /* what was drawn from the map alone has a density */
        check_weights(&most, lanes, &b, &l, N, beta);
    }
    free_lanes(&l);
    return most;
}

static void weights_are_those_of_microfacets_within_the_stated_error(void **state)
{
    (void)state;
    assert_ptr_equal(bis_bsdf_lanes_of(&bis_microfacet_model), &bis_microfacet_lanes);
    assert_ptr_equal(bis_bsdf_lanes_of(&bis_plastic_model), &bis_microfacet_lanes);
    for (int i = 0; i < N_ROUGHNESSES; i++) {
        const errors most = weigh_everything(&bis_microfacet_lanes, roughnesses[i]);
        print_message("roughness %g: %u weights, %.2f of the error stated; in the middle %.2g\n", roughnesses[i],
                      (unsigned)most.n, most.of_stated, most.in_head);
        assert_true(most.n > N);
        assert_true(most.of_stated < 1);
    }
}

/* Twin: alpha is off by 2e-5 of itself, and D at its peak by 4e-5. */
static double weigh_off(float *w, const bis_bsdf *b, const bis_lanes *y, uint32_t n, double beta)
{
    bis_material m = *b->material;
    bis_bsdf off = *b;

    m.alpha *= 1.00002;
    off.material = &m;
    return bis_microfacet_lanes.weigh(w, &off, y, n, beta);
}

/* Twin: wi + wo added up in float, as if wi had been rounded on a grid of 2^-23. */
static double weigh_coarse(float *w, const bis_bsdf *b, const bis_lanes *y, uint32_t n, double beta)
{
    const bis_lanes l = new_lanes(n);

    memcpy(l.x, y->x, BIS_LANES_ARRAYS * (size_t)n * sizeof(float));
    for (uint32_t i = 0; i < n; i++)
        l.x[i] = (y->x[i] + b->wo.x + 2) - 2 - b->wo.x;
    const double unit = bis_microfacet_lanes.weigh(w, b, &l, n, beta);
    free_lanes(&l);
    return unit;
}

static void an_alpha_or_a_direction_that_is_off_is_found(void **state)
{
    const bis_bsdf_lanes off = {.weigh = weigh_off}, coarse = {.weigh = weigh_coarse};

    (void)state;
    assert_true(weigh_everything(&off, 0.3).of_stated >= 1);
    assert_true(weigh_everything(&off, 0.01).of_stated >= 1);
    assert_true(weigh_everything(&coarse, 0.01).of_stated >= 1);
}

static void below_the_horizon_weights_are_0_and_nothing_is_ever_nan(void **state)
{
    static const float heights[] = {1, 0x1p-23f, 0x1p-25f};
    const bis_lanes l = new_lanes(16);
    float w[16];

    (void)state;
    for (int e = 0; e < N_ROUGHNESSES * 9; e++) {
        const bis_material m = e % 3 == 1   ? copper(roughnesses[e / 9])
                               : e % 3 == 2 ? plastic(roughnesses[e / 9])
                                            : bis_microfacet(grey(0), grey(1), roughnesses[e / 9]);
        const float height = heights[e / 3 % 3];
        bis_bsdf b;
        bis_bsdf_init(&b, &m, (vec3){0, 0, 1}, (vec3){sqrtf(1 - height * height), 0, height});
        for (uint32_t i = 0; i < 16; i++) {
            const vec3 wi = (const vec3[]){{0, 0, -1}, {1, 0, 0},       {0, -1, 0},      {0.6f, 0, -0.8f},
                                           neg(b.wo),  {1, 0, -1e-30f}, {-1, 0, height}, {0, 0, 1}}[i % 8];
            l.x[i] = wi.x, l.y[i] = wi.y, l.z[i] = wi.z;
            l.r[i] = l.g[i] = l.b[i] = i < 8;
            l.q[i] = 0;
        }
        assert_true(bis_microfacet_lanes.weigh(w, &b, &l, 16, 0.5) == 1);
        for (int i = 0; i < 16; i++)
            assert_true(isfinite(w[i]) && w[i] >= 0 && (i == 6 || i == 7 || w[i] == 0));
        assert_true((w[7] > 0) == (height >= 0x1p-24f)); /* nearer to the horizon nothing is reflected */
        bis_microfacet_lanes.colour(&b, &l, 16);
        for (int i = 0; i < 16; i++)
            assert_true(isfinite(l.r[i]) && (i < 8 || l.r[i] == 0));
    }
    free_lanes(&l);
}

/* Light of 4e-39 in all, below the smallest normal float: three quarters of it red, one green. The same share of a light
 * that is 2^120 times brighter. */
static void the_shares_of_the_faintest_light_are_right(void **state)
{
    (void)state;
    const bis_lanes l = new_lanes(16);
    const bis_material m = bis_microfacet(grey(0.5), grey(0), 0.3);
    bis_bsdf b;
    bis_bsdf_init(&b, &m, (vec3){0, 0, 1}, (vec3){0, 0, 1});
    for (uint32_t i = 0; i < 16; i++) {
        const float bright = i % 2 ? 0x1p120f : 1;
        l.x[i] = 0.6f, l.y[i] = 0, l.z[i] = 0.8f;
        l.r[i] = 3e-39f * bright, l.g[i] = 1e-39f * bright, l.b[i] = 0;
    }
    bis_microfacet_lanes.colour(&b, &l, 16);
    for (int i = 0; i < 16; i++)
        assert_true(fabs((double)l.r[i] - 0.75) < 1e-4 && fabs((double)l.g[i] - 0.25) < 1e-4 && l.b[i] == 0);
    free_lanes(&l);
}

/* ---- bounds over cones ---- */

static void put_cone(const bis_lanes *l, float *sine, uint32_t i, double half, bis_rng *r, const bis_bsdf *b)
{
    const double u = bis_rng_double(r), phi = 2 * PI * bis_rng_double(r);
    const vec3 axis =
        i % 3 ? bis_warp_sphere(u, phi / (2 * PI)) : mirrored(b, b->material->alpha * exp(8 * u - 4), phi);

    l->x[i] = axis.x, l->y[i] = axis.y, l->z[i] = axis.z;
    l->r[i] = 0.5f, l->g[i] = 0.25f, l->b[i] = 0.25f;
    l->q[i] = (float)cos(half);
    sine[i] = (float)sin(half);
}

static double f_cos(const bis_bsdf *b, vec3 wi)
{
    const rgb f = bis_bsdf_f(b, wi);

    return (0.5 * (double)f.r + 0.25 * (double)f.g + 0.25 * (double)f.b) * fmax(0, bis_bsdf_cos(b, wi));
}

/* Brute force: no direction of the cone, on its rim or within, has a larger f cos; a cone that lies below the horizon
 * has 0. What is added to the bound's cosines is 2^-20: beside a lobe as narrow as that, it holds all the more. */
static void what_reaches_a_cone_is_bounded_above_all_its_directions(void **state)
{
    const bis_lanes l = new_lanes(N);
    float *sine = bis_alloc(N, sizeof *sine), *w = bis_alloc(N, sizeof *w);
    int n_below = 0, n_judged = 0;

    (void)state;
    for (int k = 0; k < N_ROUGHNESSES * 12; k++) {
        const double roughness = roughnesses[k / 4 % N_ROUGHNESSES];
        const bis_material m = k < N_ROUGHNESSES * 4 ? bis_microfacet((rgb){0.3f, 0, 0.1f}, (rgb){0.04f, 0.9f, 0}, roughness)
                               : k < N_ROUGHNESSES * 8 ? (k % 2 ? copper : odd_metal)(roughness)
                                                       : (k % 2 ? plastic : odd_plastic)(roughness);
        bis_bsdf b;
        bis_rng r;
        seen_from(&b, &m, (const double[]){0, 40, 80, 89}[k % 4]);
        bis_rng_init(&r, SEED, 99, (uint64_t)k, 0);
        for (uint32_t i = 0; i < N; i++)
            put_cone(&l, sine, i, i % 5 ? 1.2 * pow(bis_rng_double(&r), 3) : 0, &r, &b);
        bis_microfacet_lanes.reach(w, &b, &l, sine, N);
        for (uint32_t i = 0; i < N; i++) {
            const double half = atan2((double)sine[i], (double)l.q[i]);
            const frame f = frame_about(direction(&l, i));
            double most = 0;
            for (int j = 0; j < 32; j++) {
                const double t = half * (j % 2 ? 1 : sqrt(bis_rng_double(&r))), phi = 2 * PI * j / 32;
                most = fmax(most, f_cos(&b, to_world(&f, vec3_from(sin(t) * cos(phi), sin(t) * sin(phi), cos(t)))));
            }
            if (!((double)w[i] >= most * (1 - 0x1p-17)))
                fail_msg("roughness %g, cone %u: %g, but there is %g", roughness, (unsigned)i, (double)w[i], most);
            if (bis_bsdf_cos(&b, f.z) < -sin(half) - 1e-5) {
                assert_true(w[i] == 0);
                n_below++;
            }
            n_judged += most > 0;
        }
    }
    assert_true(n_below > N && n_judged > 10 * N);
    bis_free(sine);
    bis_free(w);
    free_lanes(&l);
}

/* A cone of half angle 0 has the f cos of its axis, but for the 2^-20 that is added. So the bound is no larger than it
 * must be: in the middle, and for a lobe that is much wider than that. */
static void a_cone_of_one_direction_is_bounded_by_its_f_cos(void **state)
{
    const bis_lanes l = new_lanes(N);
    float *sine = bis_alloc(N, sizeof *sine), *w = bis_alloc(N, sizeof *w);
    int n_judged = 0;

    (void)state;
    for (int k = 0; k < 3 * 3; k++) {
        const bis_material m =
            bis_microfacet((rgb){0.3f, 0, 0.1f}, (rgb){0.04f, 0.9f, 0}, (const double[]){0.5, 0.8, 1}[k / 3]);
        bis_bsdf b;
        bis_rng r;
        seen_from(&b, &m, (const double[]){0, 40, 70}[k % 3]);
        bis_rng_init(&r, SEED, 98, (uint64_t)k, 0);
        for (uint32_t i = 0; i < N; i++)
            put_cone(&l, sine, i, 0, &r, &b);
        bis_microfacet_lanes.reach(w, &b, &l, sine, N);
        for (uint32_t i = 0; i < N; i++) {
            const double expected = f_cos(&b, direction(&l, i));
            if (bis_bsdf_cos(&b, direction(&l, i)) < 0.01) continue;
            assert_true((double)w[i] < expected * (1 + 0.002));
            n_judged++;
        }
    }
    assert_true(n_judged > N);
    bis_free(sine);
    bis_free(w);
    free_lanes(&l);
}

/* ---- colours ---- */

static void colours_are_F_over_phat_and_sum_to_1(void **state)
{
    const bis_lanes l = new_lanes(N), c = new_lanes(N);
    double most = 0;

    (void)state;
    for (int k = 0; k < 8 * N_ROUGHNESSES; k++) {
        const bis_material m = k >= 3 * N_ROUGHNESSES ? fresnels(k, roughnesses[k % N_ROUGHNESSES])
                               : k % 3 ? bis_microfacet((rgb){0.2f, 0, 0.4f}, (rgb){0.1f, 0.7f, 0.3f}, roughnesses[k / 3])
                                     : bis_microfacet((rgb){0.2f, 0.9f, 0.4f}, grey(0), roughnesses[k / 3]);
        bis_bsdf b;
        seen_from(&b, &m, k % 3 == 1 ? 50 : 88);
        fill(&l, N, &b, (uint64_t)k);
        memcpy(c.x, l.x, BIS_LANES_ARRAYS * N * sizeof(float));
        bis_microfacet_lanes.colour(&b, &c, N);
        for (uint32_t i = 0; i < N; i++) {
            const exact e = weigh_one(&b, &l, i, 0.5);
            const double phat = e.F[0] + e.F[1] + e.F[2], got[3] = {(double)c.r[i], (double)c.g[i], (double)c.b[i]};
            const double sum = got[0] + got[1] + got[2];
            assert_true(sum == 0 || fabs(sum - 1) < 0x1p-22);
            if (fabs(e.cos_i) <= 0x1p-20) continue;
            assert_true((sum == 0) == (phat == 0));
            for (int j = 0; phat > 0 && j < 3; j++)
                most = fmax(most, fabs(got[j] - e.F[j] / phat) / stated_f(&e, true));
        }
    }
    print_message("%.2f of the error stated\n", most);
    assert_true(most < 1);
    free_lanes(&l);
    free_lanes(&c);
}

/* ---- draws ---- */

enum { N_DRAWS = 1 << 17 };

static void draw(const bis_lanes *l, const bis_bsdf *b, uint64_t key)
{
    float *u = bis_alloc(2 * N_DRAWS, sizeof *u);
    bis_rng r;

    bis_rng_init(&r, SEED, key, 0, 1);
    for (int i = 0; i < 2 * N_DRAWS; i++)
        u[i] = (float)(bis_rng_u64(&r) >> 40) * 0x1p-24f;
    bis_microfacet_lanes.sample(l, b, u, u + N_DRAWS, N_DRAWS);
    bis_free(u);
}

static void check_facets(double roughness, double degrees, double drawn)
{
    const bis_material m = bis_microfacet(grey(0), grey(1), roughness), other = bis_microfacet(grey(0), grey(1), drawn);
    double expected[FACETS_CELLS], observed[FACETS_CELLS] = {0};
    const bis_lanes l = new_lanes(N_DRAWS);
    bis_bsdf b;

    seen_from(&b, &other, degrees);
    facets_expect(expected, m.alpha, degrees, N_DRAWS);
    draw(&l, &b, 1);
    for (uint32_t i = 0; i < N_DRAWS; i++) {
        assert_true(fabs(length(direction(&l, i)) - 1) < 1e-6);
        observed[facets_cell(&b, m.alpha, direction(&l, i))]++;
    }
    if (drawn == roughness) {
        stat_assert_fit("microfacet-lanes", SEED, observed, expected, FACETS_CELLS, alpha());
    } else {
        stat_assert_no_fit("microfacet-lanes-twin", SEED, observed, expected, FACETS_CELLS, alpha());
    }
    free_lanes(&l);
}

static void facets_are_drawn_as_they_are_seen(void **state)
{
    static const double degrees[] = {0, 45, 80, 88};

    (void)state;
    for (int i = 0; i < N_ROUGHNESSES * COUNT(degrees); i++)
        check_facets(roughnesses[i % N_ROUGHNESSES], degrees[i / N_ROUGHNESSES], roughnesses[i % N_ROUGHNESSES]);
    check_facets(0.1, 45, 0.098); /* twins: alpha off by 4 % */
    check_facets(0.8, 88, 0.784);
}

static void check_mixture(const bis_material *m, double degrees, bool twin)
{
    double expected[MIXTURE_CELLS], observed[MIXTURE_CELLS] = {0};
    const bis_lanes y = new_lanes(N_DRAWS);
    lit l;

    lit_init(&l, NULL, *m, (vec3){0, 0, 1}, degrees, LIT_OPEN);
    mixture_expect(expected, m, degrees, N_DRAWS);
    if (twin) l.pt.bsdf.p_specular *= 0.9;
    draw(&y, &l.pt.bsdf, 2);
    for (uint32_t i = 0; i < N_DRAWS; i++)
        observed[mixture_cell(direction(&y, i))]++;
    if (twin) {
        stat_assert_no_fit("microfacet-lanes-mixture-twin", SEED, observed, expected, MIXTURE_CELLS, alpha());
    } else {
        stat_assert_fit("microfacet-lanes-mixture", SEED, observed, expected, MIXTURE_CELLS, alpha());
    }
    free_lanes(&y);
}

static void the_mixture_is_drawn_with_its_density_also_below_the_horizon(void **state)
{
    static const double rough[] = {0.5, 0.8, 1};

    (void)state;
    for (int i = 0; i < 3; i++) {
        const bis_material metal = bis_microfacet(grey(0), (rgb){0.9f, 0.6f, 0.3f}, rough[i]),
                           dull = bis_microfacet(grey(1), grey(0), rough[i]);
        const bis_material plastic = bis_microfacet((rgb){0.3f, 0.2f, 0.1f}, (rgb){0.1f, 0.2f, 0.3f}, rough[i]);
        check_mixture(&metal, 60, false);
        check_mixture(&plastic, 60, false);
        check_mixture(&dull, 60, false);
        if (i == 0) check_mixture(&plastic, 60, true);
    }
}

/* |h| of the facet between wo and wi as it is drawn: h_z = (1 - u) (1 + v_z). */
static double size_of_facet(const bis_bsdf *b, vec3 wi, double u)
{
    const vec3 s = add(wi, b->wo);
    const double a = b->material->alpha, c_o = bis_bsdf_cos(b, b->wo),
                 v_z = c_o / sqrt(a * a * (1 - c_o * c_o) + c_o * c_o);

    return (1 - u) * (1 + v_z) * length(s) / dot(s, b->local.z);
}

/* The same numbers give the same direction as one by one. u1 and u2 in float are good to 2^-22 after the lobe was
 * chosen; h across the normal, a sum of two parts up to a, to 2^-21 a, and wi turns twice as far as h; d, what wi
 * differs from the mirror direction by, is good to 2^-20 besides; and wi is rounded to floats. So a lobe of alpha =
 * 1e-4 is drawn as finely as one by one. */
static void draws_of_the_lobe_are_those_one_by_one(void **state)
{
    static const float ends[] = {0, 0x1p-24f, 0.25f, 0.4f, 0.5f, 0.75f, 0x1.fffffcp-1f, 0x1.fffffep-1f};
    static const double degrees[] = {0, 60, 85, 89.9};
    const bis_lanes l = new_lanes(N);
    float u1[N], u2[N];
    double most = 0;
    int n_judged = 0;

    (void)state;
    bis_lanes_points(u1, u2, N, SEED);
    for (int i = 0; i < 64; i++)
        u1[i] = ends[i / 8], u2[i] = ends[i % 8];
    for (int k = 0; k < 2 * COUNT(degrees) * N_ROUGHNESSES; k++) {
        const bis_material m = bis_microfacet(grey(k % 2 ? 0.5 : 0), grey(k % 2 ? 0.04 : 1), roughnesses[k / 8]);
        bis_bsdf b;
        seen_from(&b, &m, degrees[k / 2 % 4]);
        bis_microfacet_lanes.sample(&l, &b, u1, u2, N);
        for (uint32_t i = 0; i < N; i++) {
            const double p = b.p_specular, u = (double)u1[i], v = (double)u2[i], rest = fmin(u / p, 1 - 0x1p-24),
                         h = 0x1p-22;
            vec3 wi, other;
            if (u > p - 1e-6)
                continue; /* the cosine is drawn along other lines than by bis_warp_cosine; the density is tested above
                           */
            assert_true(bis_bsdf_sample(&b, 0, rest, v, &wi));
            double slack =
                1.5 * 0x1p-23 + 0x1p-20 * length(sub(wi, b.r)) + 2 * 0x1p-21 * m.alpha / size_of_facet(&b, wi, rest);
            for (int j = 0; j < 4; j++) {
                const double s = fmin(fmax(rest + (j == 0 ? h : j == 1 ? -h : 0), 0), 1 - 0x1p-26);
                assert_true(bis_bsdf_sample(&b, 0, s, v + (j == 2 ? h : j == 3 ? -h : 0), &other));
                slack += length(sub(wi, other));
            }
            most = fmax(most, length(sub(wi, direction(&l, i))) / slack);
            n_judged++;
        }
    }
    print_message("%d draws, %.2f of the slack\n", n_judged, most);
    assert_true(n_judged > 20 * N && most < 1);
    free_lanes(&l);
}

/* A component is rounded by 2^-25 at most, but not always to the same side: the mean over N draws of what lanes and
 * single draws differ by has a standard error below 2^-25 sqrt(2/(3 N)), of which 2^-28 is ten. Had the mirror
 * direction been rounded alone, all draws would be shifted by what it lost, a tenth of the lobe's width at 89.9
 * degrees. */
static void draws_are_not_shifted_by_the_rounding_of_the_mirror_direction(void **state)
{
    static const double degrees[] = {0, 30, 60, 80};
    const bis_material m = bis_microfacet(grey(0), grey(1), BIS_MICROFACET_MIN_ROUGHNESS);
    const bis_lanes l = new_lanes(N);
    float u1[N], u2[N];

    (void)state;
    bis_lanes_points(u1, u2, N, SEED);
    for (int k = 0; k < COUNT(degrees); k++) {
        double sum[3] = {0};
        bis_bsdf b;
        seen_from(&b, &m, degrees[k]);
        assert_true(b.p_specular == 1);
        bis_microfacet_lanes.sample(&l, &b, u1, u2, N);
        for (uint32_t i = 0; i < N; i++) {
            vec3 wi;
            assert_true(bis_bsdf_sample(&b, 0, (double)u1[i], (double)u2[i], &wi));
            sum[0] += (double)l.x[i] - (double)wi.x;
            sum[1] += (double)l.y[i] - (double)wi.y;
            sum[2] += (double)l.z[i] - (double)wi.z;
        }
        for (int c = 0; c < 3; c++)
            assert_true(fabs(sum[c] / N) < 0x1p-28);
    }
    free_lanes(&l);
}

/* ---- furnace ---- */

/* What lanes draw and weigh, under a light of radiance 1 in one channel: the mean is the albedo, but for the mean of
 * the errors that are stated for the weights. Forgetful: draws below the horizon do not count (E34). */
static void furnace(const bis_material *m, double degrees, double expected, bool forgetful)
{
    const bis_lanes l = new_lanes(N_DRAWS);
    float *w = bis_alloc(N_DRAWS, sizeof *w);
    stat_moments mean = {0};
    double slack = 0;
    bis_bsdf b;

    seen_from(&b, m, degrees);
    draw(&l, &b, 3);
    for (uint32_t i = 0; i < N_DRAWS; i++)
        l.r[i] = l.b[i] = 0, l.g[i] = 1, l.q[i] = 1;
    const double unit = bis_microfacet_lanes.weigh(w, &b, &l, N_DRAWS, 0);
    for (uint32_t i = 0; i < N_DRAWS; i++) {
        const exact e = weigh_one(&b, &l, i, 0);
        if (!forgetful || w[i] > 0) stat_add(&mean, (double)w[i] * unit);
        if (w[i] > 0) slack += (double)w[i] * unit * fmin(1, stated_w(&e, b.p_specular > 0)) / N_DRAWS;
    }
    if (forgetful) {
        stat_assert_not_mean("microfacet-lanes-furnace-twin", SEED, &mean, expected, alpha());
    } else {
        stat_assert_mean("microfacet-lanes-furnace", SEED, &mean,
                         fmin(fmax(mean.mean, expected - slack), expected + slack), alpha());
    }
    free_lanes(&l);
    bis_free(w);
}

/* White facets by quadrature over facets, and, for alpha = 1, by the closed form 1 - c log(1 + 1/c); a base under a
 * coat of Ks = 0 has the albedo Kd A(c_o), because the mean of 28/23 A cos over the hemisphere is 1. */
static void the_furnace_keeps_the_albedo_to_grazing(void **state)
{
    static const double degrees[] = {0, 45, 70, 85, 89};

    (void)state;
    for (int d = 0; d < COUNT(degrees); d++) {
        const double c = cos(degrees[d] * PI / 180);
        for (int i = 0; i < N_ROUGHNESSES; i++) {
            const bis_material white = bis_microfacet(grey(0), grey(1), roughnesses[i]);
            furnace(&white, degrees[d],
                    roughnesses[i] == 1 ? 1 - c * log1p(1 / c) : facets_albedo_of_white(white.alpha, degrees[d]),
                    false);
        }
        const bis_material dull = bis_microfacet(grey(0.7), grey(0), 0.5), rough = bis_microfacet(grey(0), grey(1), 1);
        furnace(&dull, degrees[d], (double)0.7f * (1 - pow(1 - c / 2, 5)), false);
        if (d == 2) furnace(&rough, degrees[d], 1 - c * log1p(1 / c), true);
    }
}

/* ---- sir ---- */

/* Estimates of one point, 25 that share a pool or clusters, whose mean is one value. */
static void estimate(stat_moments m[4], lit *l, const bis_settings *s, uint32_t runs)
{
    enum { PER_FILL = 25 };
    const bis_fast_needs needs = bis_fast_needs_of(s);
    bis_scratch scratch;
    bis_fast fast;
    bis_pool pool = {0};
    bis_clusters clusters = {0};

    for (int c = 0; c < 4; c++)
        m[c] = (stat_moments){0};
    assert_int_equal(bis_scratch_init(&scratch, s, NULL), BIS_OK);
    assert_int_equal(bis_fast_init(&fast, s, NULL), BIS_OK);
    assert_true(needs.batch == s->vectorize);
    if (needs.n_pool > 0) assert_int_equal(bis_pool_init(&pool, needs.n_pool, needs.batch, NULL), BIS_OK);
    if (needs.clusters) assert_int_equal(bis_clusters_init(&clusters, l->light, s->candidates, NULL), BIS_OK);
    pool.n_sets = PER_FILL;
    scratch.fast = &fast;
    fast.pool = needs.n_pool > 0 ? &pool : NULL;
    scratch.sets = needs.n_pool > 0 ? &pool.sets : NULL;
    fast.clusters = needs.clusters ? &clusters : NULL;
    for (uint32_t k = 0; k < runs; k++) {
        double sum[3] = {0};
        if (needs.n_pool > 0) bis_pool_fill(&pool, l->light, SEED, k, 1);
        if (needs.clusters) bis_clusters_fill(&clusters, l->light, SEED, k, 1);
        for (uint32_t j = 0; j < PER_FILL; j++) {
            const rgb L = lit_once(l, s, &scratch, SEED, (uint64_t)k * PER_FILL + j);
            sum[0] += (double)L.r / PER_FILL, sum[1] += (double)L.g / PER_FILL, sum[2] += (double)L.b / PER_FILL;
        }
        for (int c = 0; c < 3; c++)
            stat_add(&m[c], sum[c]);
        stat_add(&m[3], sum[0] + sum[1] + sum[2]);
    }
    bis_scratch_clear(&scratch);
    bis_fast_clear(&fast);
    bis_pool_clear(&pool);
    bis_clusters_clear(&clusters);
}

/* Against brute force, and the plain path against the same. */
static void sir_is_unbiased_for_microfacets_with_and_without_vectors(void **state)
{
    const bis_material materials[] = {bis_microfacet(grey(0), (rgb){0.9f, 0.6f, 0.3f}, 0.4),
                                      bis_microfacet((rgb){0.2f, 0.5f, 0.8f}, grey(0.04), 0.7), copper(0.6),
                                      bis_plastic((rgb){0.02f, 0.05f, 0}, grey(0.16955), 2.4, 0.5)};
    bis_light *lights[] = {lit_new_light(LIT_SPOTTY, 1, 0.15, false), lit_new_light(LIT_SMOOTH, 1, 0, false)};
    const vec3 n = normalize((vec3){0.2f, -0.3f, 0.8f});

    (void)state;
    for (int i = 0; i < 32; i++) {
        bis_settings s = bis_settings_default(&bis_sir);
        stat_moments m[4];
        lit l;
        s.proposal = i % 2 ? BIS_PROPOSAL_PRODUCT : BIS_PROPOSAL_MIX;
        s.vectorize = i / 2 % 2;
        s.candidates = 64;
        s.shadowrays = 4;
        lit_init(&l, lights[i / 4 % 2], materials[i / 8], n, i / 8 % 2 ? 75 : 40, i % 4 < 2 ? LIT_HALF : LIT_OPEN);
        const rgbd truth = lit_truth(&l, true);
        const double expected[4] = {truth.r, truth.g, truth.b, rgbd_sum(truth)};
        estimate(m, &l, &s, 400);
        for (int c = 0; c < 4; c++)
            stat_assert_mean(s.vectorize ? "microfacet-lanes-sir" : "microfacet-plain-sir", SEED, &m[c], expected[c],
                             alpha());
        if (i % 4 < 2) continue;
        l.material.alpha *= 0.9; /* twin: lanes of another lobe */
        estimate(m, &l, &s, 400);
        stat_assert_not_mean("microfacet-lanes-sir-twin", SEED, &m[3], expected[3], alpha());
    }
    bis_light_free(lights[0]);
    bis_light_free(lights[1]);
}

/* ---- the same bits ---- */

static void weights_bounds_colours_and_draws_have_the_same_bits_on_every_processor(void **state)
{
    const bis_bsdf_lanes *const clones[] = {&plain_microfacet_lanes,
                                            clone_has_avx2() ? &avx2_microfacet_lanes : &plain_microfacet_lanes};
    const bis_lanes a = new_lanes(N), b = new_lanes(N);
    float *w = bis_alloc(N, sizeof *w), *v = bis_alloc(N, sizeof *v), *sine = bis_alloc(N, sizeof *sine);

    (void)state;
    for (int k = 0; k < 8 * N_ROUGHNESSES; k++) {
        const double ks = (const double[]){0, 0.04, 1}[k % 3];
        const bis_material m =
            k >= 3 * N_ROUGHNESSES ? fresnels(k, roughnesses[k % N_ROUGHNESSES])
            : bis_microfacet(rgb_from(1 - ks, 0.5 * (1 - ks), 0), rgb_from(ks, 0, 0.3 * ks), roughnesses[k / 3]);
        bis_bsdf at;
        seen_from(&at, &m, 70);
        for (int c = 0; c < 4; c++) {
            const double beta = c % 2 ? 0.9 : 1;
            fill(&a, N, &at, (uint64_t)k);
            memcpy(b.x, a.x, BIS_LANES_ARRAYS * N * sizeof(float));
            assert_true(bis_microfacet_lanes.weigh(w, &at, &a, N, beta) == clones[c / 2]->weigh(v, &at, &b, N, beta));
            assert_memory_equal(w, v, N * sizeof *w);
            for (uint32_t i = 0; i < N; i++) {
                const double half = 1.2 * i / N;
                sine[i] = (float)sin(half);
                a.q[i] = b.q[i] = (float)cos(half);
            }
            bis_microfacet_lanes.reach(w, &at, &a, sine, N);
            clones[c / 2]->reach(v, &at, &b, sine, N);
            assert_memory_equal(w, v, N * sizeof *w);
            bis_microfacet_lanes.colour(&at, &a, N);
            clones[c / 2]->colour(&at, &b, N);
            assert_memory_equal(a.x, b.x, BIS_LANES_ARRAYS * N * sizeof(float));
            bis_lanes_points(w, v, N, (uint64_t)k);
            bis_microfacet_lanes.sample(&a, &at, w, v, N);
            clones[c / 2]->sample(&b, &at, w, v, N);
            assert_memory_equal(a.x, b.x, 3 * N * sizeof(float));
        }
    }
    free_lanes(&a);
    free_lanes(&b);
    bis_free(w);
    bis_free(v);
    bis_free(sine);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(weights_are_those_of_microfacets_within_the_stated_error),
        cmocka_unit_test(an_alpha_or_a_direction_that_is_off_is_found),
        cmocka_unit_test(below_the_horizon_weights_are_0_and_nothing_is_ever_nan),
        cmocka_unit_test(the_shares_of_the_faintest_light_are_right),
        cmocka_unit_test(what_reaches_a_cone_is_bounded_above_all_its_directions),
        cmocka_unit_test(a_cone_of_one_direction_is_bounded_by_its_f_cos),
        cmocka_unit_test(colours_are_F_over_phat_and_sum_to_1),
        cmocka_unit_test(facets_are_drawn_as_they_are_seen),
        cmocka_unit_test(the_mixture_is_drawn_with_its_density_also_below_the_horizon),
        cmocka_unit_test(draws_of_the_lobe_are_those_one_by_one),
        cmocka_unit_test(draws_are_not_shifted_by_the_rounding_of_the_mirror_direction),
        cmocka_unit_test(the_furnace_keeps_the_albedo_to_grazing),
        cmocka_unit_test(sir_is_unbiased_for_microfacets_with_and_without_vectors),
        cmocka_unit_test(weights_bounds_colours_and_draws_have_the_same_bits_on_every_processor),
    };

    return cmocka_run_group_tests_name("microfacet_lanes", tests, NULL, NULL);
}
