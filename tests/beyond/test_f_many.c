/* SPDX-License-Identifier: BSD-2-Clause */
/* f_many: f_many, sample_many and reach of every model against the same model one by one in double, which
 * tests/thesis/test_phong.c and tests/beyond/test_microfacet.c hold to closed forms and to the papers. Nothing here is
 * random but directions: the bounds are those derived in src/beyond/microfacet_formulas.h and
 * include/bis/thesis/lanes.h. */
#include "bis/base/mem.h"
#include "bis/beyond/microfacet.h"
#include "bis/thesis/phong.h"
#include "bis/thesis/rng.h"
#include "bis/thesis/warp.h"
#include "thesis/curve_many.h"

#include "claim.h"
#include "clones.h"
#include "lit.h"

#include <string.h>

enum { SEED = 1729, N = 2048 };
#define COUNT(a) ((int)(sizeof(a) / sizeof *(a)))

static const double exponents[] = {0, 1, 2.5, 10, 50, 1e3, 1e5, 1e6, 1e8};
static const double roughnesses[] = {BIS_MICROFACET_MIN_ROUGHNESS, 0.03, 0.1, 0.3, 0.55, 0.8, 1};
static const double degrees[] = {0, 40, 85, 89.9, 89.999};
enum { PHONGS = 4 * COUNT(exponents), FACETS = 12 * COUNT(roughnesses), MATERIALS = PHONGS + FACETS };

/* The k-th of all: lobes with and without a base, bases alone, channels without; metals and plastic whose channels
 * absorb, reflect totally, reflect all, or have no index. */
static bis_material material(int k)
{
    const rgb orange = {0.9f, 0.5f, 0.1f}, blue = {0.1f, 0, 0.7f};
    const double r = roughnesses[k < PHONGS ? 0 : (k - PHONGS) / 12];
    const rgb pair[][2] = {{grey(0), orange}, {orange, grey(0)}, {blue, orange}, {orange, {0, 0, 1e-6f}}};

    if (k < PHONGS)
        return (bis_material){.model = &bis_phong_model, .Kd = pair[k % 4][0], .Ks = pair[k % 4][1],
                              .exponent = exponents[k / 4]};
    switch ((k - PHONGS) % 12) {
    case 0: return bis_microfacet(grey(0), orange, r);
    case 1: return bis_microfacet((rgb){0.8f, 0.3f, 0}, grey(0.04), r);
    case 2: return bis_microfacet(orange, grey(0), r);
    case 3: return bis_microfacet(grey(0), grey(1), r);
    case 4: return bis_microfacet(grey(1e-19), (rgb){1e-20f, 0, 1e-3f}, r);
    case 5: return bis_microfacet_metal((rgb){0.952f, 0.62f, 0.511f}, (rgb){0.2f, 0.924f, 1.102f}, r); /* copper */
    case 6: return bis_microfacet_metal((rgb){0.05f, 0.11f, 1}, (rgb){1.5f, 0.6f, 3}, r);
    case 7: return bis_plastic((rgb){0.2f, 0.5f, 0.3f}, (rgb){0.04f, 0.02f, 0}, 1.5, r);
    case 8: return bis_plastic((rgb){0.1f, 0, 0.7f}, (rgb){0.0625f, 0.03f, 0.01f}, 0.6, r);
    case 9: return bis_plastic((rgb){0.8f, 0.3f, 0}, grey(0), 1.5, r);
    case 10: return bis_plastic(grey(0.1), (rgb){1, 0.9f, 0.1f}, 1.5, r);
    default: return bis_plastic(grey(0.5), grey(0.3), 1, r);
    }
}

static bool is_phong(const bis_bsdf *b) { return b->material->alpha == 0; }

static void seen_from(bis_bsdf *b, const bis_material *m, double angle)
{
    const frame about_n = frame_about(normalize(vec3_from(0.3, -0.5, 0.7)));
    const double t = angle * PI / 180;

    bis_bsdf_init(b, m, about_n.z, normalize(to_world(&about_n, vec3_from(sin(t) * 0.6, sin(t) * 0.8, cos(t)))));
}

/* Lanes, cones and numbers for N directions. */
typedef struct lanes {
    bis_lanes y;
    bis_cones cones;
    bis_reflected f;
    float *u1, *u2, *w;
} lanes;

static lanes new_lanes(void)
{
    float *m = bis_alloc((BIS_LANES_ARRAYS + BIS_CONES_ARRAYS + 8) * N, sizeof *m);
    float *o = m + (BIS_LANES_ARRAYS + BIS_CONES_ARRAYS) * N;

    return (lanes){bis_lanes_in(m, N), bis_cones_in(m + BIS_LANES_ARRAYS * N, N),
                   {o, o + N, o + 2 * N, o + 3 * N, o + 4 * N}, o + 5 * N, o + 6 * N, o + 7 * N};
}
static void free_lanes(const lanes *l) { bis_free(l->y.x); }
static vec3 direction(const bis_lanes *l, uint32_t i) { return (vec3){l->x[i], l->y[i], l->z[i]}; }

/* wo mirrored about a facet of tangent t and azimuth phi. */
static vec3 mirrored(const bis_bsdf *b, double t, double phi)
{
    const vec3 h = normalize(to_world(&b->local, vec3_from(t * cos(phi), t * sin(phi), 1)));

    return normalize(sub(mul(h, 2 * dot(h, b->wo)), b->wo));
}

/* A direction in the lobe, from its core far into its tail. */
static vec3 in_lobe(const bis_bsdf *b, double u, double phi)
{
    const double theta = fmin(PI, 12 * u / sqrt(b->material->exponent + 1));

    if (!is_phong(b)) return mirrored(b, b->material->alpha * exp(12 * u - 6), phi);
    return to_world(&b->lobe, vec3_from(sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta)));
}

/* Directions in the lobe, next to both horizons, about the mirror direction, on axes, everywhere. */
static void fill(const bis_lanes *l, const bis_bsdf *b, uint64_t seed)
{
    bis_rng r;

    bis_rng_init(&r, SEED, seed, 0, 0);
    for (uint32_t i = 0; i < N; i++) {
        const double u = bis_rng_double(&r), phi = 2 * PI * bis_rng_double(&r), near = exp(-30 * u);
        const vec3 rim = vec3_from(cos(near) * cos(phi), cos(near) * sin(phi), i % 10 < 5 ? sin(near) : -sin(near));
        vec3 w = in_lobe(b, u, phi);
        if (i % 5 == 1) w = to_world(&b->local, rim);
        if (i % 5 == 2) w = to_world(&b->lobe, rim);
        if (i % 5 == 3) w = normalize(add(b->r, mul(bis_warp_sphere(bis_rng_double(&r), bis_rng_double(&r)), near)));
        if (i % 5 == 4) w = bis_warp_sphere(u, phi / (2 * PI));
        if (i < 6) w = (const vec3[]){b->r, neg(b->r), b->local.z, neg(b->local.z), neg(b->wo), b->wo}[i];
        l->x[i] = w.x, l->y[i] = w.y, l->z[i] = w.z;
    }
}

/* ---- f, cosine, density ---- */

/* The errors that are stated: relative ones of f and q, absolute ones of the cosine, and of f and q where the power of
 * a lobe is not allowed below 2^-64. `blind`: next to a horizon a float does not know the side. */
typedef struct stated {
    double f, q, cos, least_f, least_q;
    bool blind_f, blind_q;
} stated;

/* The power of the lobe: that of log and exp, 2^-20 (1 + |log|), and n times what float vectors leave of 1 - cos. */
static stated stated_of_phong(const bis_bsdf *b, vec3 wi, double cos_i)
{
    const bis_material *m = b->material;
    const vec3 d = sub(wi, b->r);
    const double cos_alpha = 1 - dot(d, d) / 2, peak = (m->exponent + 1) / (2 * PI);
    const double log_power = log(fmax(bis_phong_power(b->r, wi, m->exponent), 0x1p-64));
    const bool has_lobe = b->p_specular > 0, ahead = has_lobe && cos_alpha > 0;
    const double lobe = ahead ? 0x1p-20 * (1 - log_power) + m->exponent * 0x1p-22 * (1 / cos_alpha - 1) : 0;
    const bool blind = has_lobe && fabs(cos_alpha) <= 0x1p-20;

    return (stated){0x1p-20 + lobe, 0x1p-20 + lobe + 0x1p-22 / fabs(cos_i), 0x1p-22,
                    ahead ? 0x1.001p-64 * peak * rgb_max(m->Ks) : 0,
                    ahead ? 0x1.001p-64 * peak * b->p_specular : 0, blind, blind};
}

/* Of F, what a cos theta_d that is off by 2^-21 changes, and the roundings of a root of F that is sqrt(Ks) at least. */
static double stated_of_fresnel(double Ks, double eta, double c)
{
    const double up = fmin(1, c + 0x1p-21), down = fmax(0, c - 0x1p-21), x4 = pow(1 - c, 4);

    if (Ks == 0) return 0;
    if (eta == 0) return 0x1p-21 * 5 * (1 - Ks) * x4 / (Ks + (1 - Ks) * x4 * (1 - c));
    return fmax(fabs(lit_fresnel(Ks, eta, up) / lit_fresnel(Ks, eta, c) - 1),
                fabs(lit_fresnel(Ks, eta, down) / lit_fresnel(Ks, eta, c) - 1)) + 0x1p-19 / sqrt(Ks);
}

static stated stated_of_facets(const bis_bsdf *b, vec3 wi, double cos_i)
{
    const double s[3] = {(double)wi.x + (double)b->wo.x, (double)wi.y + (double)b->wo.y,
                         (double)wi.z + (double)b->wo.z};
    const double cos_d = sqrt(s[0] * s[0] + s[1] * s[1] + s[2] * s[2]) / 2, s_z = cos_i + bis_bsdf_cos(b, b->wo);
    const rgb Ks = b->material->Ks, eta = b->material->eta;
    const double F = fmax(stated_of_fresnel((double)Ks.r, (double)eta.r, cos_d),
                          fmax(stated_of_fresnel((double)Ks.g, (double)eta.g, cos_d),
                               stated_of_fresnel((double)Ks.b, (double)eta.b, cos_d)));
    const bool has_lobe = b->p_specular > 0;
    const double of_cosine = 0x1p-20 / fabs(cos_i) + 0x1p-19, lobe = !has_lobe   ? 0
                                                                     : cos_d > 0 ? 0x1p-18 / cos_d
                                                                                 : (double)INFINITY;

    return (stated){of_cosine + lobe + (has_lobe ? F : 0), of_cosine + lobe, 0x1p-20, 0, 0, false,
                    has_lobe && fabs(s_z) <= 0x1p-20};
}

/* The largest ratio of an error to what is stated, over all of `l`: f_many of `many`, whose f is `scale` times that of
 * `one`, one by one. */
static double f_errors(const lanes *l, const bis_bsdf *many, const bis_bsdf *one, double scale, uint32_t *n_judged)
{
    const double unit = bis_bsdf_f_many(&l->f, many, &l->y, N);
    double most = 0;

    assert_true(isfinite(unit) && unit > 0);
    for (uint32_t i = 0; i < N; i++) {
        const vec3 wi = direction(&l->y, i);
        const double cos_i = bis_bsdf_cos(one, wi);
        const stated s = is_phong(one) ? stated_of_phong(one, wi, cos_i) : stated_of_facets(one, wi, cos_i);
        const float got[3] = {l->f.r[i], l->f.g[i], l->f.b[i]};
        double q;
        const rgb f = bis_bsdf_f_pdf(one, wi, &q);
        const double expected[3] = {(double)f.r, (double)f.g, (double)f.b};
        assert_true(isfinite(got[0]) && isfinite(got[1]) && isfinite(got[2]) && isfinite(l->f.q[i]) && l->f.q[i] >= 0);
        most = fmax(most, fabs((double)l->f.cos[i] - cos_i) / s.cos);
        if (fabs(cos_i) <= 0x1p-20) continue;
        if (!s.blind_q) most = fmax(most, fabs((double)l->f.q[i] - q) / (s.q * q + s.least_q + 0x1p-126));
        for (int c = 0; c < 3 && cos_i > 0 && !s.blind_f; c++) {
            assert_true(got[c] >= 0 && (got[c] > 0 || expected[c] == 0));
            const double allowed = s.f * expected[c] + s.least_f + 0x1p-126 * fmax(1, unit / scale);
            most = fmax(most, fabs((double)got[c] * unit / scale - expected[c]) / allowed);
            ++*n_judged;
        }
    }
    return most;
}

static void f_and_density_are_those_of_single_directions_within_the_stated_error(void **state)
{
    const lanes l = new_lanes();
    double most[2] = {0, 0};
    uint32_t n = 0;

    for (int k = 0; k < MATERIALS * COUNT(degrees); k++) {
        const bis_material m = material(k % MATERIALS);
        bis_bsdf b;
        seen_from(&b, &m, degrees[k / MATERIALS]);
        fill(&l.y, &b, (uint64_t)k);
        const double error = f_errors(&l, &b, &b, 1, &n);
        if (error >= 1)
            fail_msg("material %d at %g degrees: %.2f of the error", k % MATERIALS, degrees[k / MATERIALS], error);
        most[!is_phong(&b)] = fmax(most[!is_phong(&b)], error);
    }
    print_message("%u values; of the error stated: phong %.2f, facets %.2f\n", (unsigned)n, most[0], most[1]);
    assert_true(n > MATERIALS * COUNT(degrees) * N);
    free_lanes(&l);
}

/* f of Phong is in proportion to Kd and Ks, which are far from 1 here: floats would not hold it without its unit. */
static void reflectances_of_1e_38_and_of_1e33_lose_nothing(void **state)
{
    static const double scales[] = {0x1p-105, 0x1p110};
    const lanes l = new_lanes();
    uint32_t n = 0;

    for (int k = 0; k < PHONGS * 2; k++) {
        const bis_material m = material(k % PHONGS);
        bis_material scaled = m;
        bis_bsdf b, other;
        scaled.Kd = rgb_scale(m.Kd, scales[k / PHONGS]);
        scaled.Ks = rgb_scale(m.Ks, scales[k / PHONGS]);
        seen_from(&b, &m, 40);
        seen_from(&other, &scaled, 40);
        fill(&l.y, &b, (uint64_t)k);
        const double error = f_errors(&l, &other, &b, scales[k / PHONGS], &n);
        if (error >= 1)
            fail_msg("material %d times %g: %.2f of the error stated", k % PHONGS, scales[k / PHONGS], error);
    }
    free_lanes(&l);
}

/* The twins: an exponent off by 1e-5 of itself, an alpha by 2e-5; wi rounded as if wi + wo were added up in float. */
static void an_exponent_an_alpha_or_a_direction_that_is_off_is_found(void **state)
{
    const bis_material narrow = material(4 * 4 + 2), smooth = material(PHONGS + 3);
    const lanes l = new_lanes();
    uint32_t n = 0;
    bis_bsdf b, other;

    for (int k = 0; k < 2; k++) {
        bis_material off = k ? smooth : narrow;
        off.exponent *= 1.00001;
        off.alpha *= 1.00002;
        seen_from(&b, k ? &smooth : &narrow, 40);
        seen_from(&other, &off, 40);
        other.p_specular = b.p_specular;
        fill(&l.y, &b, 1);
        assert_true(f_errors(&l, &b, &b, 1, &n) < 1);
        assert_true(f_errors(&l, &other, &b, 1, &n) >= 1);
    }
    const double unit = bis_bsdf_f_many(&l.f, &b, &l.y, N);
    double most = 0;
    for (uint32_t i = 0; i < N; i++) {
        const vec3 wi = direction(&l.y, i), coarse = {(wi.x + b.wo.x + 2) - 2 - b.wo.x, wi.y, wi.z};
        const double f = (double)bis_bsdf_f(&b, coarse).g, cos_i = bis_bsdf_cos(&b, wi);
        if (cos_i > 0.1) most = fmax(most, fabs((double)l.f.g[i] * unit / f - 1) / stated_of_facets(&b, wi, cos_i).f);
    }
    assert_true(most >= 1);
    free_lanes(&l);
}

/* Views and directions on horizons, at the smallest angles that floats hold, and no direction at all. */
static void nothing_is_ever_nan(void **state)
{
    static const float heights[] = {1, 0x1p-23f, 0x1p-25f};
    const lanes l = new_lanes();

    for (int k = 0; k < MATERIALS * COUNT(heights); k++) {
        const bis_material m = material(k % MATERIALS);
        const float h = heights[k / MATERIALS];
        bis_bsdf b;
        const float side = sqrtf(1 - h * h);
        bis_bsdf_init(&b, &m, (vec3){0, 0, 1}, (vec3){side, 0, h});
        for (uint32_t i = 0; i < 16; i++) {
            const vec3 wi = (const vec3[]){{0, 0, -1}, {1, 0, 0}, {0, -1, 0}, {0.6f, 0, -0.8f}, neg(b.wo),
                                           {1, 0, -1e-30f}, {-side, 0, h}, {0, 0, 1}, {0, 1, 1e-30f},
                                            {0, 0, 0}}[i % 10];
            l.y.x[i] = wi.x, l.y.y[i] = wi.y, l.y.z[i] = wi.z;
        }
        bis_bsdf_f_many(&l.f, &b, &l.y, 16);
        for (int i = 0; i < 16; i++) {
            assert_true(isfinite(l.f.r[i]) && isfinite(l.f.g[i]) && isfinite(l.f.b[i]) && isfinite(l.f.q[i]));
            assert_true(l.f.r[i] >= 0 && l.f.g[i] >= 0 && l.f.b[i] >= 0 && l.f.q[i] >= 0);
        }
        if (is_phong(&b)) continue;
        /* nearer to the horizon facets reflect nothing */
        assert_true((l.f.r[7] + l.f.g[7] + l.f.b[7] > 0) == (h >= 0x1p-24f));
    }
    free_lanes(&l);
}

/* ---- draws ---- */

/* |h| of the facet between wo and wi as it is drawn: h_z = (1 - u) (1 + v_z). */
static double size_of_facet(const bis_bsdf *b, vec3 wi, double u)
{
    const vec3 s = add(wi, b->wo);
    const double a = b->material->alpha, c_o = bis_bsdf_cos(b, b->wo);
    const double v_z = c_o / sqrt(a * a * (1 - c_o * c_o) + c_o * c_o);

    return (1 - u) * (1 + v_z) * length(s) / dot(s, b->local.z);
}

/* The largest ratio of what a direction differs from that of the same numbers, one by one, to what floats leave.
 * - u1, stretched to its lobe's part, is good to 2^-22 over the part's width, u2 to 2^-22.
 * - The cosine and Phong's lobe: sin, cos and a root, 2^-22 each at most, and three products in each component: 1e-6.
 * - A facet: h across the normal, a sum of two parts up to a, to 2^-21 a, and wi turns twice as far as h; d, what wi
 *   differs from the mirror direction by, to 2^-20; and wi is rounded to floats. So a lobe of alpha = 1e-4 is drawn as
 *   finely as one by one. */
static double draw_errors(const lanes *l, const bis_bsdf *many, const bis_bsdf *one)
{
    double most = 0;

    bis_bsdf_sample_many(&l->y, many, l->u1, l->u2, N);
    for (uint32_t i = 0; i < N; i++) {
        const double p = one->p_specular, u = (double)l->u1[i], v = (double)l->u2[i], last = 1 - 0x1p-24;
        const bool specular = u < p;
        const double part = specular ? p : 1 - p, u0 = specular ? 0 : 1 - 0x1p-53, h[2] = {0x1p-22 / part, 0x1p-22};
        const double place = fmin((specular ? u : u - p) / part, last);
        vec3 wi, other;
        if (fabs(u - p) < 1e-6 || part < 0x1p-20) continue; /* which lobe, a float does not know */
        assert_true(bis_bsdf_sample(one, u0, place, v, &wi));
        double slack = 1e-6;
        if (!is_phong(one) && specular)
            slack = 1.5 * 0x1p-23 + 0x1p-20 * length(sub(wi, one->r)) +
                    2 * 0x1p-21 * one->material->alpha / size_of_facet(one, wi, place);
        for (int j = 0; j < 4; j++) {
            const double sign = j % 2 ? 1 : -1, at = place + (j < 2 ? sign * h[0] : 0);
            bis_bsdf_sample(one, u0, fmin(fmax(at, 0), 1 - 0x1p-26), v + (j < 2 ? 0 : sign * h[1]), &other);
            slack += length(sub(wi, other));
        }
        most = fmax(most, length(sub(wi, direction(&l->y, i))) / slack);
        assert_true(fabs(length(direction(&l->y, i)) - 1) < 1e-6);
    }
    return most;
}

static void draws_are_those_of_single_directions(void **state)
{
    static const float ends[] = {0, 0x1p-24f, 0.25f, 0.4f, 0.5f, 0.75f, 0x1.fffffcp-1f, 0x1.fffffep-1f};
    const lanes l = new_lanes();
    double most[2] = {0, 0};

    bis_curve_points(l.u1, l.u2, N, SEED);
    for (int i = 0; i < 64; i++) l.u1[i] = ends[i / 8], l.u2[i] = ends[i % 8];
    for (int k = 0; k < MATERIALS * (COUNT(degrees) - 1); k++) {
        const bis_material m = material(k % MATERIALS);
        bis_bsdf b;
        seen_from(&b, &m, degrees[k / MATERIALS]);
        if (bis_bsdf_is_black(&b)) continue;
        const double error = draw_errors(&l, &b, &b);
        if (error >= 1)
            fail_msg("material %d at %g degrees: %.2f of the slack", k % MATERIALS, degrees[k / MATERIALS], error);
        most[!is_phong(&b)] = fmax(most[!is_phong(&b)], error);
    }
    print_message("of the slack: phong %.2f, facets %.2f\n", most[0], most[1]);
    for (int k = 0; k < 2; k++) { /* twins: a lobe's part of [0, 1) is a thousandth too wide */
        const bis_material m = material(k ? PHONGS + 12 + 1 : 2);
        bis_bsdf b;
        seen_from(&b, &m, 40);
        bis_bsdf other = b;
        other.p_specular *= 1.001;
        assert_true(draw_errors(&l, &other, &b) >= 1);
    }
    free_lanes(&l);
}

/* The direction of (u1, u2), in double and without rounding to floats: wo is mirrored about a visible facet, which is
 * the sum of wo and a point of the sphere's cap, both stretched to alpha = 1 (Dupuy and Benyoub, Sampling Visible GGX
 * Normals with Spherical Caps, 2023). */
static void mirrored_about_a_facet(double wi[3], const bis_bsdf *b, double u1, double u2)
{
    const vec3 x = b->local.x, y = b->local.y, z = b->local.z, wo = b->wo;
    const double a = b->material->alpha, o[3] = {a * dot(wo, x), a * dot(wo, y), dot(wo, z)};
    const double size = sqrt(o[0] * o[0] + o[1] * o[1] + o[2] * o[2]), c = 1 - u1 * (1 + o[2] / size);
    const double s = sqrt(1 - c * c);
    const double h[3] = {a * (o[0] / size + s * cos(2 * PI * u2)), a * (o[1] / size + s * sin(2 * PI * u2)),
                         o[2] / size + c};
    const double m[3] = {h[0] * (double)x.x + h[1] * (double)y.x + h[2] * (double)z.x,
                         h[0] * (double)x.y + h[1] * (double)y.y + h[2] * (double)z.y,
                         h[0] * (double)x.z + h[1] * (double)y.z + h[2] * (double)z.z};
    const double w[3] = {(double)wo.x, (double)wo.y, (double)wo.z};
    const double k = 2 * (w[0] * m[0] + w[1] * m[1] + w[2] * m[2]) / (m[0] * m[0] + m[1] * m[1] + m[2] * m[2]);

    for (int i = 0; i < 3; i++) wi[i] = k * m[i] - w[i];
}

/* A component is rounded by 2^-25 at most, but not always to the same side: the mean over N draws of what it lost has a
 * standard error below 2^-25 sqrt(1/(3 N)), of which 2^-27.5 is fourteen. Had the mirror direction been rounded alone,
 * all draws would be shifted by what it lost, a tenth of the lobe's width at 89.9 degrees. The frame is good to 2^-23,
 * which turns a draw by 2^-23 of the lobe's width: nothing here. */
static void draws_are_not_shifted_by_the_rounding_of_the_mirror_direction(void **state)
{
    const bis_material m = bis_microfacet(grey(0), grey(1), BIS_MICROFACET_MIN_ROUGHNESS);
    const lanes l = new_lanes();

    bis_curve_points(l.u1, l.u2, N, SEED);
    for (int k = 0; k < 4; k++) {
        double many[3] = {0}, single[3] = {0};
        bis_bsdf b;
        seen_from(&b, &m, (const double[]){0, 30, 60, 80}[k]);
        assert_true(b.p_specular == 1);
        bis_bsdf_sample_many(&l.y, &b, l.u1, l.u2, N);
        for (uint32_t i = 0; i < N; i++) {
            const vec3 lane = direction(&l.y, i);
            double exact[3];
            vec3 wi;
            mirrored_about_a_facet(exact, &b, (double)l.u1[i], (double)l.u2[i]);
            assert_true(bis_bsdf_sample(&b, 0, (double)l.u1[i], (double)l.u2[i], &wi));
            const float drawn[2][3] = {{lane.x, lane.y, lane.z}, {wi.x, wi.y, wi.z}};
            for (int c = 0; c < 3; c++) many[c] += (double)drawn[0][c] - exact[c];
            for (int c = 0; c < 3; c++) single[c] += (double)drawn[1][c] - exact[c];
        }
        for (int c = 0; c < 3; c++) assert_true(fabs(many[c] / N) < 0x1p-28 * sqrt(2));
        for (int c = 0; c < 3; c++) assert_true(fabs(single[c] / N) < 0x1p-28 * sqrt(2));
    }
    free_lanes(&l);
}

/* ---- bounds over cones ---- */

static void fill_cones(const bis_cones *c, const bis_bsdf *b, bis_rng *r, double widest)
{
    for (uint32_t i = 0; i < N; i++) {
        const double half = i % 5 ? widest * pow(bis_rng_double(r), 3) : 0;
        const double u = bis_rng_double(r), phi = 2 * PI * bis_rng_double(r);
        const vec3 axis = i % 3 ? bis_warp_sphere(u, phi / (2 * PI)) : in_lobe(b, u, phi);
        c->x[i] = axis.x, c->y[i] = axis.y, c->z[i] = axis.z;
        c->cosine[i] = (float)cos(half);
        c->sine[i] = (float)sin(half);
        c->r[i] = (float)bis_rng_double(r), c->g[i] = (float)bis_rng_double(r), c->b[i] = (float)bis_rng_double(r);
    }
}

static double f_cos(const bis_bsdf *b, vec3 wi, const bis_cones *c, uint32_t i)
{
    const rgb f = bis_bsdf_f(b, wi);

    return ((double)c->r[i] * (double)f.r + (double)c->g[i] * (double)f.g + (double)c->b[i] * (double)f.b) *
           fmax(0, bis_bsdf_cos(b, wi));
}

/* The unit of reach is that of f_many. */
static double reach(const lanes *l, const bis_bsdf *b)
{
    bis_bsdf_reach(l->w, b, &l->cones, N);
    return bis_bsdf_f_many(&l->f, b, &l->y, N);
}

/* Brute force: the largest ratio of f cos on a cone's rim or within to its bound. 0 for a cone below the horizon. */
static double excess(const lanes *l, const bis_bsdf *b, bis_rng *r, uint32_t *n_below)
{
    const double unit = reach(l, b);
    double most = 0;

    for (uint32_t i = 0; i < N; i++) {
        const double half = atan2((double)l->cones.sine[i], (double)l->cones.cosine[i]);
        const frame f = frame_about((vec3){l->cones.x[i], l->cones.y[i], l->cones.z[i]});
        for (int j = 0; j < 16; j++) {
            const double t = half * (j % 2 ? 1 : sqrt(bis_rng_double(r))), phi = 2 * PI * j / 16;
            const vec3 wi = to_world(&f, vec3_from(sin(t) * cos(phi), sin(t) * sin(phi), cos(t)));
            const double x = f_cos(b, wi, &l->cones, i);
            if (x > 0) most = fmax(most, x / ((double)l->w[i] * unit));
        }
        if (bis_bsdf_cos(b, f.z) >= -sin(half) - 1e-5) continue;
        assert_true(l->w[i] == 0);
        ++*n_below;
    }
    return most;
}

/* What is added to the bound's cosines, 2^-20, covers the roundings of f but those of its value: 2^-17. */
static void no_direction_of_a_cone_reflects_more_than_its_bound(void **state)
{
    const lanes l = new_lanes();
    uint32_t n_below = 0;
    bis_rng r;

    bis_rng_init(&r, SEED, 99, 0, 0);
    for (int k = 0; k < MATERIALS * 2; k++) {
        const bis_material m = material(k % MATERIALS);
        bis_bsdf b;
        seen_from(&b, &m, (const double[]){0, 40, 80, 89}[k % 4]);
        fill_cones(&l.cones, &b, &r, 1.2);
        fill(&l.y, &b, 1);
        const double most = excess(&l, &b, &r, &n_below);
        if (!(most <= 1 + 0x1p-17)) fail_msg("material %d: %g times the bound", k % MATERIALS, most);
    }
    assert_true(n_below > N);
    const bis_material m = material(4 * 4); /* the twin: cones of half the width they say */
    bis_bsdf b;
    seen_from(&b, &m, 40);
    fill_cones(&l.cones, &b, &r, 1.2);
    const double unit = reach(&l, &b);
    double most = 0;
    for (uint32_t i = 0; i < N; i++) {
        const double half = 2 * atan2((double)l.cones.sine[i], (double)l.cones.cosine[i]);
        const frame f = frame_about((vec3){l.cones.x[i], l.cones.y[i], l.cones.z[i]});
        for (int j = 0; j < 16 && l.w[i] > 0; j++) {
            const vec3 rim = vec3_from(sin(half) * cos(PI * j / 8), sin(half) * sin(PI * j / 8), cos(half));
            most = fmax(most, f_cos(&b, to_world(&f, rim), &l.cones, i) / ((double)l.w[i] * unit));
        }
    }
    assert_true(most > 1.1);
    free_lanes(&l);
}

/* A cone of half angle 0 has the f cos of its axis, but for the 2^-20 that is added, for lobes that are much wider than
 * that. So the bound is no larger than it must be. */
static void a_cone_of_one_direction_is_bounded_by_its_f_cos(void **state)
{
    const lanes l = new_lanes();
    int n_judged = 0;

    for (int k = 0; k < MATERIALS; k++) {
        const bis_material m = material(k);
        bis_bsdf b;
        bis_rng r;
        if (is_phong(&(bis_bsdf){.material = &m}) ? m.exponent > 10 : m.alpha < 0.25) continue;
        seen_from(&b, &m, (const double[]){0, 40, 70}[k % 3]);
        bis_rng_init(&r, SEED, 98, (uint64_t)k, 0);
        fill_cones(&l.cones, &b, &r, 0);
        fill(&l.y, &b, 1);
        const double unit = reach(&l, &b);
        for (uint32_t i = 0; i < N; i++) {
            const vec3 axis = {l.cones.x[i], l.cones.y[i], l.cones.z[i]};
            if (bis_bsdf_cos(&b, axis) < 0.01 || (is_phong(&b) && dot(axis, b.r) < 0.1) || m.eta.r > 0) continue;
            const double expected = f_cos(&b, axis, &l.cones, i);
            if (!((double)l.w[i] * unit < expected * (1 + 0.002)))
                fail_msg("material %d: %g, is %g", k, (double)l.w[i] * unit, expected);
            n_judged++;
        }
    }
    assert_true(n_judged > N);
    free_lanes(&l);
}

/* ---- the same bits on every processor, and one by one ---- */

static void compare_bits(const lanes *a, const lanes *b, const bis_bsdf *ours, const bis_bsdf *theirs)
{
    assert_true(bis_bsdf_f_many(&a->f, ours, &a->y, N) == bis_bsdf_f_many(&b->f, theirs, &b->y, N));
    assert_memory_equal(a->f.r, b->f.r, 5 * N * sizeof(float));
    bis_bsdf_reach(a->w, ours, &a->cones, N);
    bis_bsdf_reach(b->w, theirs, &b->cones, N);
    assert_memory_equal(a->w, b->w, N * sizeof(float));
    bis_bsdf_sample_many(&a->y, ours, a->u1, a->u2, N);
    bis_bsdf_sample_many(&b->y, theirs, a->u1, a->u2, N);
    assert_memory_equal(a->y.x, b->y.x, 3 * N * sizeof(float));
}

static void all_processors_give_the_same_bits(void **state)
{
    const lanes a = new_lanes(), b = new_lanes();

    bis_curve_points(a.u1, a.u2, N, SEED);
    for (int k = 0; k < 2 * MATERIALS; k++) {
        const bool avx2 = k / MATERIALS && clone_has_avx2();
        const bis_material ours = material(k % MATERIALS);
        bis_bsdf_model model = *ours.model;
        bis_material theirs = ours;
        bis_rng r;
        if (ours.model == &bis_phong_model) model.many = avx2 ? &avx2_phong_many : &plain_phong_many;
        else if (ours.model == &bis_plastic_model) model.many = avx2 ? &avx2_plastic_many : &plain_plastic_many;
        else model.many = avx2 ? &avx2_microfacet_many : &plain_microfacet_many;
        theirs.model = &model;
        bis_bsdf at;
        seen_from(&at, &ours, 70);
        bis_bsdf there = at;
        there.material = &theirs;
        bis_rng_init(&r, SEED, 97, (uint64_t)k, 0);
        fill(&a.y, &at, (uint64_t)k);
        fill_cones(&a.cones, &at, &r, 1.2);
        memcpy(b.y.x, a.y.x, (BIS_LANES_ARRAYS + BIS_CONES_ARRAYS) * N * sizeof(float));
        compare_bits(&a, &b, &at, &there);
    }
    free_lanes(&a);
    free_lanes(&b);
}

/* A model without such functions is asked one by one, for what fills the last block too; cones are all alike. */
static void a_model_without_them_is_asked_one_by_one(void **state)
{
    const bis_bsdf_model alone = {.name = "alone", .init = bis_phong_model.init, .sample = bis_phong_model.sample,
                                  .f_pdf = bis_phong_model.f_pdf, .max_f_cos = bis_phong_model.max_f_cos};
    const bis_material m = {.model = &alone, .Kd = grey(0x1p-130), .Ks = grey(0x1p-130), .exponent = 20};
    const lanes l = new_lanes();
    const uint32_t n = 37;
    bis_bsdf b;
    bis_rng r;

    seen_from(&b, &m, 40);
    bis_rng_init(&r, SEED, 96, 0, 0);
    fill(&l.y, &b, 5);
    fill_cones(&l.cones, &b, &r, 1);
    bis_curve_points(l.u1, l.u2, N, SEED);
    const double unit = bis_bsdf_f_many(&l.f, &b, &l.y, n);
    bis_bsdf_reach(l.w, &b, &l.cones, n);
    for (uint32_t i = 0; i < n; i++) {
        const vec3 wi = direction(&l.y, i);
        double q;
        const rgb f = bis_bsdf_f_pdf(&b, wi, &q);
        assert_true(fabs((double)l.f.g[i] * unit - (double)f.g) <= 0x1p-23 * (double)f.g);
        assert_true(l.f.q[i] == (float)q && l.f.cos[i] == (float)bis_bsdf_cos(&b, wi));
        assert_true(fabsf(l.w[i] - l.cones.r[i] - l.cones.g[i] - l.cones.b[i]) < 1e-6f);
    }
    for (uint32_t i = n; i < bis_lanes_round_up(n); i++) assert_true(isfinite(l.f.g[i]) && l.w[i] == 0);
    bis_bsdf_sample_many(&l.y, &b, l.u1, l.u2, n);
    for (uint32_t i = 0; i < n; i++) {
        const double u = (double)l.u1[i], p = b.p_specular;
        vec3 wi;
        assert_true(bis_bsdf_sample(&b, u, u < p ? u / p : (u - p) / (1 - p), (double)l.u2[i], &wi));
        assert_true(length(sub(wi, direction(&l.y, i))) < 1e-6);
    }
    free_lanes(&l);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(f_and_density_are_those_of_single_directions_within_the_stated_error),
        cmocka_unit_test(reflectances_of_1e_38_and_of_1e33_lose_nothing),
        cmocka_unit_test(an_exponent_an_alpha_or_a_direction_that_is_off_is_found),
        cmocka_unit_test(nothing_is_ever_nan),
        cmocka_unit_test(draws_are_those_of_single_directions),
        cmocka_unit_test(draws_are_not_shifted_by_the_rounding_of_the_mirror_direction),
        cmocka_unit_test(no_direction_of_a_cone_reflects_more_than_its_bound),
        cmocka_unit_test(a_cone_of_one_direction_is_bounded_by_its_f_cos),
        cmocka_unit_test(all_processors_give_the_same_bits),
        cmocka_unit_test(a_model_without_them_is_asked_one_by_one),
    };

    return cmocka_run_group_tests_name("f_many", tests, NULL, NULL);
}
