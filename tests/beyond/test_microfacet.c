/* SPDX-License-Identifier: BSD-2-Clause */
/* microfacet: GGX and its base against the papers' formulas in long double, closed forms, and quadrature over facets
 * and over directions that shares no code with it. What every model gets for nothing is elsewhere:
 * tests/thesis/test_integrators.c, tests/thesis/test_directions.c, tests/tools/test_verify_bsdf.c (docs/extending.md).
 * Family-wise significance of this file 1e-3. */
#include "bis/beyond/microfacet.h"
#include "bis/thesis/rng.h"
#include "bis/scene/scene.h"
#include "bis/thesis/warp.h"
#include "tools/verify/verify.h"

#include "claim.h"
#include "facets.h"

#include <stdio.h>

#define SEED 2018u
#define COUNT(a) ((int)(sizeof(a) / sizeof *(a)))

static const double roughnesses[] = {0.01, 0.03, 0.1, 0.3, 0.55, 0.8, 1};

/* facets 7 x 4, mixture 3 x 4, furnace 5 x 6; twins are not counted */
static double alpha(void)
{
    return stat_level(1e-3, 28 + 12 + 30);
}

static void assert_near(double a, double b, double tolerance)
{
    if (!(fabs(a - b) <= tolerance)) fail_msg("%.12g is not %.12g within %g", a, b, tolerance);
}

static vec3 view(vec3 n, double degrees)
{
    const frame f = frame_about(n);
    const double t = degrees * PI / 180;

    return normalize(to_world(&f, vec3_from(sin(t) * 0.6, sin(t) * 0.8, cos(t))));
}

static vec3 tilted(void)
{
    return normalize(vec3_from(0.3, -0.5, 0.7));
}

static void seen_from(bis_bsdf *b, const bis_material *m, double degrees)
{
    bis_bsdf_init(b, m, tilted(), view(tilted(), degrees));
}

/* ---- the papers' formulas ---- */

typedef long double real;

static real smith(real a, real c)
{
    return (sqrtl(1 + a * a * (1 - c * c) / (c * c)) - 1) / 2;
}

/* D of the half vector's cosine and tangent squared (Walter et al. 2007, eq. 33). */
static real ggx(real a, real c, real tan2)
{
    return a * a / (acosl(-1) * c * c * c * c * (a * a + tan2) * (a * a + tan2));
}

/* Both in one channel, for the normal (0, 0, 1) and the very floats of wi and wo. */
static void by_the_papers(real *f, real *q, real a, real Kd, real Ks, real p_specular, vec3 wi, vec3 wo)
{
    const real x = (real)wi.x + (real)wo.x, y = (real)wi.y + (real)wo.y, z = (real)wi.z + (real)wo.z, c_i = (real)wi.z,
               c_o = (real)wo.z;
    const real s2 = x * x + y * y + z * z, c_h = z / sqrtl(s2), c_d = sqrtl(s2) / 2,
               D = ggx(a, c_h, (x * x + y * y) / (z * z));
    const real F = Ks > 0 ? Ks + (1 - Ks) * powl(1 - c_d, 5) : 0, pi = acosl(-1);

    *q = (1 - p_specular) * fmaxl(0, c_i) / pi;
    if (z > 0) *q += p_specular * D / (1 + smith(a, c_o)) / (4 * c_o); /* D_v / (4 wo h) */
    *f = 0;
    if (c_i > 0)
        *f = F * D / (1 + smith(a, c_o) + smith(a, c_i)) / (4 * c_i * c_o) +
             28 / (23 * pi) * Kd * (1 - Ks) * (1 - powl(1 - c_i / 2, 5)) * (1 - powl(1 - c_o / 2, 5));
}

static void f_and_density_are_those_of_the_papers(void **state)
{
    static const double degrees[] = {0, 30, 60, 85, 89.9, 89.999};
    bis_rng r;

    bis_rng_init(&r, SEED, 1, 0, 0);
    for (int i = 0; i < 42 * 500; i++) {
        const bis_material m = bis_microfacet((rgb){0.1f, 0.8f, 0}, (rgb){0.6f, 0.04f, 0}, roughnesses[i % 7]);
        const vec3 wo = view((vec3){0, 0, 1}, degrees[i / 7 % 6]);
        bis_bsdf b;
        vec3 wi;
        bis_bsdf_init(&b, &m, (vec3){0, 0, 1}, wo);
        assert_true(bis_bsdf_sample(&b, bis_rng_double(&r), bis_rng_double(&r), bis_rng_double(&r), &wi));
        if (i % 3 == 0) wi = bis_warp_sphere(bis_rng_double(&r), bis_rng_double(&r));
        real red, green, q;
        double pdf;
        const rgb f = bis_bsdf_f_pdf(&b, wi, &pdf);
        by_the_papers(&red, &q, (real)m.alpha, (real)0.1f, (real)0.6f, (real)b.p_specular, wi, wo);
        by_the_papers(&green, &q, (real)m.alpha, (real)0.8f, (real)0.04f, (real)b.p_specular, wi, wo);
        assert_near(pdf, (double)q, 1e-11 * (double)q);
        if (wi.z > 0 && wi.z < 0x1p-24f) continue; /* counts as the horizon */
        assert_near((double)f.r, (double)red, 1e-6 * (double)red);
        assert_near((double)f.g, (double)green, 1e-6 * (double)green);
        assert_true(f.b == 0); /* Ks = 0, Kd = 0: no lobe, not even at grazing angles */
    }
}

/* Copper, gold's blue, silver's green; a dielectric, a metal next to a mirror, one with total reflection. */
static bis_material metal_of(int which, double roughness)
{
    static const float Ks[][3] = {{0.952f, 0.62f, 0.511f}, {0.324f, 0.957f, 0.04f}, {0.999f, 0.11f, 1}};
    static const float eta[][3] = {{0.2f, 0.924f, 1.102f}, {1.442f, 0.117f, 1.5f}, {30, 0.6f, 2}};

    return bis_microfacet_metal((rgb){Ks[which][0], Ks[which][1], Ks[which][2]},
                                (rgb){eta[which][0], eta[which][1], eta[which][2]}, roughness);
}

/* A material's f and pdf against those of complex numbers (lit_f), at directions that it draws. The tolerances are
 * relative. */
static void assert_follows(bis_material (*material_of)(int which, double roughness), uint64_t stream, double of_pdf,
                           double of_f)
{
    static const double degrees[] = {0, 30, 60, 85, 89.9};
    bis_rng r;

    bis_rng_init(&r, SEED, stream, 0, 0);
    for (int i = 0; i < 105 * 200; i++) {
        const bis_material m = material_of(i % 3, roughnesses[i % 7]);
        lit l;
        double pdf, q;
        vec3 wi;
        lit_init(&l, NULL, m, (vec3){0, 0, 1}, degrees[i / 7 % 5], LIT_OPEN);
        const bis_bsdf *b = &l.pt.bsdf;
        assert_true(bis_bsdf_sample(b, bis_rng_double(&r), bis_rng_double(&r), bis_rng_double(&r), &wi));
        const rgb f = bis_bsdf_f_pdf(b, wi, &pdf);
        const rgbd g = lit_f(&l, (const double[]){(double)wi.x, (double)wi.y, (double)wi.z}, &q);
        assert_near(pdf, q, of_pdf * q);
        if (bis_bsdf_cos(b, wi) < 0x1p-24) continue;
        assert_near((double)f.r, g.r, of_f * g.r);
        assert_near((double)f.g, g.g, of_f * g.g);
        assert_near((double)f.b, g.b, of_f * g.b);
        if (m.model == &bis_plastic_model)
            assert_near((double)f.b, 0.3 / PI, 1e-7); /* no lobe: Lambert's base, whole */
    }
}

/* Seen along the normal, F is Ks. */
static void metals_follow_fresnels_equations(void **state)
{
    assert_follows(metal_of, 8, 1e-9, 1e-6);
    /* alpha = 1, wi = wo = n: D = 1/pi, G2 = 1, f = Ks/(4 pi) */
    const bis_material copper = metal_of(0, 1);
    bis_bsdf b;
    bis_bsdf_init(&b, &copper, (vec3){0, 0, 1}, (vec3){0, 0, 1});
    assert_near((double)bis_bsdf_f(&b, (vec3){0, 0, 1}).g, 0.62 / (4 * PI), 1e-7);
}

/* Of glass, of something heavier, and with total reflection; without a lobe in a channel. */
static bis_material plastic_of(int which, double roughness)
{
    static const double eta[] = {1.5, 2.4, 0.6}, head_on[] = {0.04, 0.16955, 0.0625};
    const double R = head_on[which];

    return bis_plastic((rgb){0.1f, 0.8f, 0.3f}, rgb_from(R, 0.25 * R, 0), eta[which], roughness);
}

/* Against complex numbers; and by hand, alpha = 1: head on D = 1/pi, G2 = 1, F = Ks/0.04 0.04, and with both directions
 * at 60 degrees on opposite sides D = 1/pi, G2 = 1/2, F = Ks/0.04 0.08919. Under it lies Lambert's base, whole. */
static void plastic_is_fresnels_glass_over_lambert(void **state)
{
    assert_follows(plastic_of, 10, 1e-6, 2e-6); /* eta is a float */
    const bis_material m = bis_plastic(grey(0.5), grey(0.02), 1.5, 1);
    const vec3 aside = normalize(vec3_from(sqrt(3), 0, 1)), opposite = normalize(vec3_from(-sqrt(3), 0, 1));
    bis_bsdf b;
    bis_bsdf_init(&b, &m, (vec3){0, 0, 1}, (vec3){0, 0, 1});
    assert_near((double)bis_bsdf_f(&b, (vec3){0, 0, 1}).g, 0.02 / (4 * PI) + 0.5 / PI, 1e-7);
    bis_bsdf_init(&b, &m, (vec3){0, 0, 1}, aside);
    assert_near((double)bis_bsdf_f(&b, opposite).g, 0.5 * 0.08919 * 0.5 / PI + 0.5 / PI, 1e-6);
    const bis_material most = bis_plastic(grey(0), grey(1), 1.5, 1); /* in proportion to Ks up to 1 */
    bis_bsdf_init(&b, &most, (vec3){0, 0, 1}, aside);
    assert_near((double)bis_bsdf_f(&b, opposite).g, 25 * 0.08919 * 0.5 / PI, 5e-5);
    assert_string_equal(m.model->name, "plastic");
    assert_true(m.model->of_half_vector && m.model->width(&m).value == 1);
    /* of an index of 1 nothing is reflected but by the base */
    const bis_material air = bis_plastic(grey(0.5), grey(0.3), 1, 0.3);
    bis_bsdf_init(&b, &air, (vec3){0, 0, 1}, aside);
    assert_near((double)bis_bsdf_f(&b, opposite).g, 0.5 / PI, 1e-7);
}

static void f_is_reciprocal(void **state)
{
    bis_rng r;

    bis_rng_init(&r, SEED, 2, 0, 0);
    for (int i = 0; i < 7000; i++) {
        const bis_material m = i % 2 ? bis_microfacet((rgb){0.3f, 0.6f, 0}, (rgb){0.6f, 0.04f, 1}, roughnesses[i % 7])
                               : i % 4 ? plastic_of(i / 4 % 3, roughnesses[i % 7])
                                       : metal_of(i / 4 % 3, roughnesses[i % 7]);
        const vec3 n = bis_warp_sphere(bis_rng_double(&r), bis_rng_double(&r)), wo = view(n, 90 * bis_rng_double(&r));
        bis_bsdf there, back;
        vec3 wi;
        bis_bsdf_init(&there, &m, n, wo);
        if (!bis_bsdf_sample(&there, bis_rng_double(&r), bis_rng_double(&r), bis_rng_double(&r), &wi)) continue;
        if (bis_bsdf_cos(&there, wi) <= 0) continue;
        bis_bsdf_init(&back, &m, n, wi);
        const rgb f = bis_bsdf_f(&there, wi), g = bis_bsdf_f(&back, wo);
        assert_near((double)f.r, (double)g.r, 2e-7 * (double)f.r); /* one rounding to float */
        assert_near((double)f.g, (double)g.g, 2e-7 * (double)f.g);
        assert_near((double)f.b, (double)g.b, 2e-7 * (double)f.b);
    }
}

/* ---- the sampler: facets ---- */

typedef enum wrong { RIGHT, SMOOTHER, ALL_FACETS, REDRAWN, UNIFORM_BASE, WITHOUT_G2 } wrong;

/* Walter's sampling: facets by D cos, seen or not; what the eye does not see is drawn again. */
static vec3 mirrored_at_any_facet(const bis_bsdf *b, bis_rng *r)
{
    for (;;) {
        const double u = bis_rng_double(r), tangent = b->material->alpha * sqrt(u / (1 - u)),
                     phi = 2 * PI * bis_rng_double(r);
        const vec3 h = to_world(&b->local, normalize(vec3_from(tangent * cos(phi), tangent * sin(phi), 1)));
        if (dot(h, b->wo) > 0) return sub(mul(h, 2 * dot(h, b->wo)), b->wo);
    }
}

static vec3 draw(const bis_bsdf *b, bis_rng *r, wrong how)
{
    vec3 wi;

    if (how == ALL_FACETS) return mirrored_at_any_facet(b, r);
    do {
        const double u0 = bis_rng_double(r), u1 = bis_rng_double(r), u2 = bis_rng_double(r);
        assert_true(bis_bsdf_sample(b, u0, u1, u2, &wi));
        const double s = sqrt(1 - u1 * u1);
        if (how == UNIFORM_BASE && u0 >= b->p_specular)
            wi = to_world(&b->local, vec3_from(s * cos(2 * PI * u2), s * sin(2 * PI * u2), u1));
    } while (how == REDRAWN && bis_bsdf_cos(b, wi) <= 0);
    return wi;
}

enum { N_DRAWS = 1 << 17 };

static void check_facets(double roughness, double degrees, wrong how)
{
    const bis_material m = bis_microfacet(grey(0), grey(1), roughness),
                       drawn = bis_microfacet(grey(0), grey(1), how == SMOOTHER ? 0.98 * roughness : roughness);
    double expected[FACETS_CELLS], observed[FACETS_CELLS] = {0};
    bis_bsdf b;
    bis_rng r;

    seen_from(&b, &drawn, degrees);
    facets_expect(expected, m.alpha, degrees, N_DRAWS);
    bis_rng_init(&r, SEED, 4, 0, 0);
    for (int i = 0; i < N_DRAWS; i++)
        observed[facets_cell(&b, m.alpha, draw(&b, &r, how))]++;
    if (how == RIGHT) {
        stat_assert_fit("microfacet_visible", SEED, observed, expected, FACETS_CELLS, alpha());
    } else {
        stat_assert_no_fit("microfacet_visible_wrong", SEED, observed, expected, FACETS_CELLS, alpha());
    }
}

static void facets_are_drawn_as_they_are_seen(void **state)
{
    static const double degrees[] = {0, 45, 80, 88};

    for (int i = 0; i < COUNT(roughnesses) * COUNT(degrees); i++)
        check_facets(roughnesses[i % 7], degrees[i / 7], RIGHT);
    check_facets(0.1, 45, SMOOTHER); /* alpha off by 4 % */
    check_facets(0.8, 45, SMOOTHER);
    check_facets(0.5, 80, ALL_FACETS);
    check_facets(0.1, 88, ALL_FACETS);
    check_facets(0.8, 80, REDRAWN); /* E34 */
}

/* ---- the sampler: directions of the mixture ---- */

static void check_mixture(const bis_material *m, double degrees, wrong how)
{
    double expected[MIXTURE_CELLS], observed[MIXTURE_CELLS] = {0};
    bis_rng r;
    lit l;

    lit_init(&l, NULL, *m, (vec3){0, 0, 1}, degrees, LIT_OPEN);
    mixture_expect(expected, m, degrees, N_DRAWS);
    bis_rng_init(&r, SEED, 5, 0, 0);
    for (int i = 0; i < N_DRAWS; i++) observed[mixture_cell(draw(&l.pt.bsdf, &r, how))]++;
    if (how == RIGHT) {
        stat_assert_fit("microfacet_mixture", SEED, observed, expected, MIXTURE_CELLS, alpha());
    } else {
        stat_assert_no_fit("microfacet_mixture_wrong", SEED, observed, expected, MIXTURE_CELLS, alpha());
    }
}

static void mixture_is_drawn_with_its_density_also_below_the_horizon(void **state)
{
    static const double rough[] = {0.5, 0.8, 1};

    for (int i = 0; i < 3; i++) {
        const bis_material metal = bis_microfacet(grey(0), (rgb){0.9f, 0.6f, 0.3f}, rough[i]),
                           dull = bis_microfacet(grey(1), grey(0), rough[i]);
        const bis_material plastic = bis_microfacet((rgb){0.3f, 0.2f, 0.1f}, (rgb){0.1f, 0.2f, 0.3f}, rough[i]);
        const bis_material copper = metal_of(0, rough[i]);
        check_mixture(&metal, 60, RIGHT);
        check_mixture(&copper, 60, RIGHT);
        check_mixture(&plastic, 60, RIGHT);
        check_mixture(&dull, 60, RIGHT);
        check_mixture(&metal, 60, REDRAWN); /* E34 */
        check_mixture(&plastic, 60, UNIFORM_BASE);
    }
}

/* ---- quadrature over facets ---- */

typedef double integrand(const bis_bsdf *b, vec3 wi);

/* Integral over directions as one over facets h in the hemisphere about wo, d wi = 4 (wo h) dh: rings at 1 - cos
 * theta_h that grow geometrically from inside the lobe's core, with an edge at the facets' horizon, where the density
 * jumps. */
static double integrate(const bis_bsdf *b, double a, int n_phi, integrand *g)
{
    static const double node[3] = {0.1127016653792583, 0.5, 0.8872983346207417},
                        mass[3] = {5 / 18.0, 8 / 18.0, 5 / 18.0};
    const frame *f = &b->local;
    double edge = 0, step = 0.02 * a * a, sum = 0;

    while (edge < 2) {
        const double next = edge < 1 ? fmin(edge + step, 1) : fmin(edge + step, 2);
        for (int i = 0; i < 3 * n_phi; i++) {
            const double t = edge + (next - edge) * node[i % 3], s = sqrt(t * (2 - t)),
                         phi = 2 * PI * ((int)(i / 3) + 0.5) / n_phi;
            const double h[3] = {s * cos(phi), s * sin(phi), 1 - t};
            const double x = h[0] * (double)f->x.x + h[1] * (double)f->y.x + h[2] * (double)f->z.x;
            const double y = h[0] * (double)f->x.y + h[1] * (double)f->y.y + h[2] * (double)f->z.y;
            const double z = h[0] * (double)f->x.z + h[1] * (double)f->y.z + h[2] * (double)f->z.z;
            const double c = x * (double)b->wo.x + y * (double)b->wo.y + z * (double)b->wo.z;
            if (c <= 0) continue;
            const vec3 wi =
                vec3_from(2 * c * x - (double)b->wo.x, 2 * c * y - (double)b->wo.y, 2 * c * z - (double)b->wo.z);
            sum += 4 * c * g(b, wi) * mass[i % 3] * (next - edge) * 2 * PI / n_phi;
        }
        edge = next;
        step = fmin(step * 1.15, 0.05);
    }
    return sum;
}

static double density(const bis_bsdf *b, vec3 wi)
{
    return bis_bsdf_pdf(b, wi);
}

static double density_above(const bis_bsdf *b, vec3 wi)
{
    return bis_bsdf_cos(b, wi) > 0 ? bis_bsdf_pdf(b, wi) : 0;
}

/* Mirrored at all facets, not at those that the eye sees: D cos theta_h / (4 wo h). */
static double density_of_all_facets(const bis_bsdf *b, vec3 wi)
{
    const vec3 s = add(wi, b->wo);
    const double c = dot(s, b->local.z) / length(s);

    return c > 0 ? (double)ggx((real)b->material->alpha, (real)c, 1 / ((real)c * (real)c) - 1) * c / (2 * length(s))
                 : 0;
}

static void density_integrates_to_1_over_the_sphere(void **state)
{
    static const double degrees[] = {0, 30, 60, 85, 89.9};

    for (int i = 0; i < COUNT(roughnesses) * COUNT(degrees); i++) {
        const bis_material m = bis_microfacet(grey(0.3), grey(0.5), roughnesses[i % 7]);
        bis_bsdf b;
        seen_from(&b, &m, degrees[i / 7]);
        assert_near(integrate(&b, m.alpha, 128, density), 1,
                    roughnesses[i % 7] < 0.1 ? 2e-3 : 2e-4); /* the horizon's kink; float directions at 89.9 degrees */
    }
    const bis_material rough = bis_microfacet(grey(0), grey(1), 1);
    bis_bsdf b;
    seen_from(&b, &rough, 60); /* twins: what falls below the horizon forgotten; the density of Walter's sampling, right
                                  in itself only head on */
    assert_true(integrate(&b, 1, 128, density_above) < 0.9);
    assert_true(fabs(integrate(&b, 1, 128, density_of_all_facets) - 1) > 0.02);
}

/* ---- energy ---- */

/* Albedo by lit_f, in the green channel, over the same facets. */
static const lit *point;

static double textbook_f_cos(const bis_bsdf *b, vec3 wi)
{
    const double w[3] = {(double)wi.x, (double)wi.y, (double)wi.z};
    double pdf;

    return lit_f(point, w, &pdf).g * fmax(0, bis_bsdf_cos(b, wi));
}

static double albedo(const bis_material *m, double degrees)
{
    lit l;

    lit_init(&l, NULL, *m, (vec3){0, 0, 1}, degrees, LIT_OPEN);
    point = &l;
    return integrate(&l.pt.bsdf, m->alpha, 192, textbook_f_cos);
}

/* alpha = 1: D = 1/pi and S = 1, so that the albedo is the integral of c/(c + c_o) over c in [0, 1]. */
static void white_facets_of_alpha_1_keep_1_minus_c_log_1_plus_1_over_c(void **state)
{
    static const double degrees[] = {0, 30, 60, 80, 89};
    const bis_material m = bis_microfacet(grey(0), grey(1), 1);

    for (int i = 0; i < COUNT(degrees); i++) {
        const double c = cos(degrees[i] * PI / 180), closed = 1 - c * log1p(1 / c);
        assert_near(albedo(&m, degrees[i]), closed, 5e-4); /* the horizon's kink */
    }
}

/* What facets throw at each other is lost. The table of docs/scene-format.md. */
static void white_facets_lose_next_to_nothing_where_smooth_and_two_thirds_where_rough(void **state)
{
    static const double table[][3] = {{0.1, 0.9999, 0.9992},
                                      {0.3, 0.9906, 0.9345},
                                      {0.5, 0.9159, 0.8393},
                                      {0.7, 0.6976, 0.7647},
                                      {1, 0.3068, 0.5906}};

    for (int i = 0; i < COUNT(table); i++) {
        const bis_material m = bis_microfacet(grey(0), grey(1), table[i][0]);
        assert_near(albedo(&m, 0), table[i][1], 2e-4);
        assert_near(albedo(&m, 75), table[i][2], 2e-4);
    }
}

static void no_reflectances_reflect_more_than_is_received(void **state)
{
    static const double degrees[] = {0, 45, 75, 85, 89.5}, Ks[] = {0, 0.04, 0.3, 0.7, 1};

    for (int i = 0; i < COUNT(roughnesses) * COUNT(degrees) * COUNT(Ks); i++) {
        const bis_material m = bis_microfacet(grey(1), grey(Ks[i % 5]), roughnesses[i / 25]);
        const double A = albedo(&m, degrees[i / 5 % 5]);
        if (!(A <= 1 + 5e-4))
            fail_msg("roughness %g, Ks %g, %g degrees: %g", roughnesses[i / 25], Ks[i % 5], degrees[i / 5 % 5], A);
    }
    /* twin: Kd (1 - Ks)/pi for the base */
    const bis_material lobe = bis_microfacet(grey(0), grey(0.04), 0.1);
    assert_true(albedo(&lobe, 85) + 0.96 > 1.3);
}

static double weight(const bis_bsdf *b, vec3 wi, wrong how)
{
    double q;
    const double f = (double)bis_bsdf_f_pdf(b, wi, &q).g * fmax(0, bis_bsdf_cos(b, wi));

    if (how != WITHOUT_G2) return q > 0 ? f / q : 0;
    const double c_d = length(add(wi, b->wo)) / 2,
                 F = (double)b->material->Ks.g + (1 - (double)b->material->Ks.g) * pow(1 - c_d, 5);
    return f > 0 ? F : 0;
}

static void furnace(const bis_material *m, double degrees, wrong how)
{
    const double expected = albedo(m, degrees);
    stat_moments mean = {0};
    bis_bsdf b;
    bis_rng r;

    seen_from(&b, m, degrees);
    bis_rng_init(&r, SEED, 6, 0, 0);
    for (int i = 0; i < 1 << 16; i++)
        stat_add(&mean, weight(&b, draw(&b, &r, how), how));
    if (how == RIGHT) {
        stat_assert_mean("microfacet_furnace", SEED, &mean, expected, alpha());
    } else {
        stat_assert_not_mean("microfacet_furnace_wrong", SEED, &mean, expected, alpha());
    }
}

static void furnace_agrees_with_quadrature_to_grazing(void **state)
{
    static const double degrees[] = {0, 45, 70, 85, 89.5};

    for (int i = 0; i < COUNT(degrees); i++) {
        const bis_material white = bis_microfacet(grey(0), grey(1), 0.6),
                           metal = bis_microfacet(grey(0), (rgb){0, 0.5f, 1}, 0.9);
        const bis_material plastic = bis_microfacet(grey(0.8), grey(0.04), 0.4),
                           both = bis_microfacet((rgb){1, 0.4f, 0}, (rgb){0, 0.5f, 1}, 1);
        const bis_material copper = metal_of(0, 0.7);
        const bis_material glass = plastic_of(0, 0.5);
        furnace(&copper, degrees[i], RIGHT);
        furnace(&glass, degrees[i], RIGHT);
        furnace(&white, degrees[i], RIGHT);
        furnace(&metal, degrees[i], RIGHT);
        furnace(&plastic, degrees[i], RIGHT);
        furnace(&both, degrees[i], RIGHT);
        if (i == 2) furnace(&white, degrees[i], WITHOUT_G2);
        if (i == 3) furnace(&white, degrees[i], REDRAWN);
    }
}

/* ---- bounds ---- */

/* Asserts that what m does stays below its bounds, and above these shares of them. */
static void assert_bounds(const bis_material *m, double degrees, double least, double least_ratio, bis_rng *r)
{
    double best = 0, best_ratio = 0;
    bis_bsdf b;
    seen_from(&b, m, degrees);
    for (int k = 0; k < 20000; k++) {
        vec3 wi = b.r;
        if (k % 3 == 1) wi = bis_warp_sphere(bis_rng_double(r), bis_rng_double(r));
        if (k % 3 == 2) bis_bsdf_sample(&b, bis_rng_double(r), bis_rng_double(r), bis_rng_double(r), &wi);
        double pdf, cos_theta = fmax(0, bis_bsdf_cos(&b, wi)), f = rgb_max(bis_bsdf_f_pdf(&b, wi, &pdf));
        best = fmax(best, f * cos_theta);
        if (f > 0) best_ratio = fmax(best_ratio, f * cos_theta / pdf);
    }
    assert_true(best <= bis_bsdf_max_f_cos(&b) && best > least * bis_bsdf_max_f_cos(&b));
    assert_true(best_ratio <= bis_bsdf_max_ratio(&b) && best_ratio > least_ratio * bis_bsdf_max_ratio(&b));
}

/* A metal's F is largest head on or far from it; plastic's at the horizon, and its base has no smaller maximum
 * anywhere. */
static void bounds_hold_and_are_nearly_reached_E27(void **state)
{
    static const double degrees[] = {0, 50, 85, 89.9};
    bis_rng r[3];

    for (uint32_t k = 0; k < 3; k++) bis_rng_init(&r[k], SEED, 7 + 2 * k, 0, 0);
    for (int i = 0; i < COUNT(roughnesses) * COUNT(degrees) * 3; i++) {
        const double roughness = roughnesses[i / 12], angle = degrees[i / 3 % 4];
        const bool is_mirror = i % 3 == 0, is_steep = angle < 60;
        const bis_material m =
            is_mirror ? bis_microfacet(grey(0), (rgb){0.9f, 0.8f, 0.5f}, roughness)
                      : bis_microfacet((rgb){0.1f, 0.5f, 0}, i % 3 == 1 ? grey(0.04) : (rgb){0, 1e-6f, 0.3f},
                                       roughness);
        const bis_material metal = metal_of(i % 3, roughness), plastic = plastic_of(i % 3, roughness);
        assert_bounds(&m, angle, is_mirror ? 0.4 : 0, is_mirror && is_steep ? roughness < 0.9 ? 0.8 : 0.4 : 0, &r[0]);
        assert_bounds(&metal, angle, 0.3, is_steep ? 0.4 : 0, &r[1]);
        assert_bounds(&plastic, angle, 0, 0, &r[2]);
    }
    /* without a lobe the bounds are the base's own: f cos = Kd/pi at the normal, f cos/pdf = Kd */
    const bis_material dull = bis_plastic(grey(0.8), grey(0), 1.5, 0.5);
    bis_bsdf b;
    seen_from(&b, &dull, 70);
    assert_near(bis_bsdf_max_f_cos(&b), 0.8 / PI, 1e-6);
    assert_near(bis_bsdf_max_ratio(&b), 0.8, 1e-6);
}

/* ---- zero is a value; extremes ---- */

/* Seen from above, a rough coat that reflects a thousandth at most leaves the base, whose maximum is at the normal. */
static void bounds_of_a_base_alone_are_reached_at_the_normal(void **state)
{
    const bis_material m = bis_microfacet((rgb){0.1f, 0.8f, 0.3f}, grey(0), 1);
    bis_bsdf b;
    double pdf;

    seen_from(&b, &m, 0);
    const double f = rgb_max(bis_bsdf_f_pdf(&b, b.wo, &pdf));
    assert_true(f > 0.99 * bis_bsdf_max_f_cos(&b));
    assert_true(f / pdf > 0.9 * bis_bsdf_max_ratio(&b));

    /* a dark metal has no base: F is 0.05 at the normal and, at 90 degrees to it, 0.052 at most */
    const bis_material dark = bis_microfacet(grey(0), grey(0.05), 0.1);
    seen_from(&b, &dark, 0);
    assert_true(b.p_specular == 1 && bis_bsdf_max_ratio(&b) > 0.05 && bis_bsdf_max_ratio(&b) < 0.053);
}

static void black_material_and_hidden_surface_draw_nothing(void **state)
{
    const bis_material black = bis_microfacet(grey(0), grey(0), 0.5), shiny = bis_microfacet(grey(0.5), grey(0.5), 0.5);
    bis_bsdf b;
    vec3 wi;

    seen_from(&b, &black, 30);
    assert_true(bis_bsdf_is_black(&b));
    assert_false(bis_bsdf_sample(&b, 0.5, 0.5, 0.5, &wi));
    seen_from(&b, &shiny, 91);
    assert_true(bis_bsdf_is_black(&b));
    assert_false(bis_bsdf_sample(&b, 0.5, 0.5, 0.5, &wi));
    assert_true(rgb_is_black(bis_bsdf_f(&b, b.local.z)));
    assert_true(bis_bsdf_pdf(&b, b.local.z) == 0);
    seen_from(&b, &shiny, 89);
    assert_false(bis_bsdf_is_black(&b));
    assert_true(rgb_is_black(bis_bsdf_f(&b, neg(b.local.z))));
    assert_true(bis_bsdf_pdf(&b, neg(b.wo)) == 0); /* wi = -wo: no facet mirrors that */
}

/* Permuted channels, in plastics and in metals, leave the probability of the lobe and the bounds of rejection what they
 * are, because these are sums or maxima over the channels. Only the order of the sums may differ: 3 roundings each. */
static void channels_count_alike(void **state)
{
    static const float Kd[5] = {0.1f, 0.8f, 0.3f, 0.1f, 0.8f}, Ks[5] = {0.04f, 0.2f, 0.6f, 0.04f, 0.2f},
                       eta[5] = {1.2f, 0.4f, 2.5f, 1.2f, 0.4f};
    for (int is_metal = 0; is_metal < 2; is_metal++) {
        double right[3] = {0, 0, 0};
        for (int k = 0; k < 3; k++) {
            const rgb s = {Ks[k], Ks[k + 1], Ks[k + 2]};
            const bis_material m =
                is_metal ? bis_microfacet_metal(s, (rgb){eta[k], eta[k + 1], eta[k + 2]}, 0.4)
                         : bis_plastic((rgb){Kd[k], Kd[k + 1], Kd[k + 2]}, s, 1.5, 0.4);
            bis_bsdf b;
            seen_from(&b, &m, 70);
            const double found[3] = {b.p_specular, bis_bsdf_max_ratio(&b), bis_bsdf_max_f_cos(&b)};
            for (int i = 0; i < 3; i++) {
                if (k == 0) right[i] = found[i];
                assert_true(found[i] > 0 && fabs(found[i] / right[i] - 1) < 1e-14);
            }
        }
    }
}

static void all_stays_finite_and_below_its_bounds_for_any_material_view_and_number(void **state)
{
    static const double reflectances[][2] = {{0, 1},     {1, 0},         {1, 1},     {1, 0.04}, {1, 1 - 0x1p-24},
                                             {0, 1e-20}, {1e-20, 1e-20}, {1, 1e-20}, {1e-20, 0}};
    static const double degrees[] = {0, 60, 89.9, 89.999, 89.99999, 90},
                        few[] = {0, 0x1p-53, 0.25, 0.5, 1 - 0x1p-24, 1 - 0x1p-53};
    const vec3 normals[] = {
        {0, 0, 1}, {0, 0, -1}, {1, 0, 0}, normalize((vec3){1, -2, 0.5f}), normalize((vec3){-1e-4f, 1e-4f, -1})};

    for (int i = 0; i < COUNT(reflectances) * COUNT(degrees) * COUNT(normals) * COUNT(roughnesses); i++) {
        const double *k = reflectances[i % 9], angle = degrees[i / 9 % 6];
        const bis_material m = bis_microfacet(grey(k[0]), grey(k[1]), roughnesses[i / 9 / 6 / 5]);
        bis_bsdf b;
        bis_bsdf_init(&b, &m, normals[i / 9 / 6 % 5], view(normals[i / 9 / 6 % 5], angle));
        for (int j = 0; j < 216; j++) {
            vec3 wi;
            double q;
            if (!bis_bsdf_sample(&b, few[j % 6], few[j / 6 % 6], few[j / 36], &wi)) break;
            const rgb f = bis_bsdf_f_pdf(&b, wi, &q);
            const double f_cos = (double)f.g * fmax(0, bis_bsdf_cos(&b, wi));
            assert_true(vec3_is_finite(wi) && fabs(length(wi) - 1) < 1e-6);
            assert_true(isfinite(q) && q >= 0 && rgb_is_finite(f) && f.g >= 0 && (q > 0 || f.g == 0));
            assert_true(f_cos <= bis_bsdf_max_f_cos(&b));
            assert_true(f_cos == 0 || f_cos / q <= bis_bsdf_max_ratio(&b));
            assert_true(isfinite(bis_bsdf_max_f_cos(&b)) && isfinite(bis_bsdf_max_ratio(&b)));
        }
    }
}

/* Directions on the horizon, or at the smallest angles that floats hold: f would be anything up to infinity. */
static void nearer_to_the_horizon_than_floats_can_tell_nothing_is_reflected(void **state)
{
    const bis_material m = bis_microfacet(grey(0), grey(1), 0.01);
    const vec3 n = {0, 0, 1};
    bis_bsdf b;

    bis_bsdf_init(&b, &m, n, (vec3){1, 0, 1e-38f});
    assert_true(rgb_is_black(bis_bsdf_f(&b, (vec3){-1, 0, 1e-38f})));
    assert_true(isfinite(bis_bsdf_pdf(&b, (vec3){-1, 0, 1e-38f})) &&
                isfinite(bis_bsdf_pdf(&b, (vec3){-1, 0, -1e-38f})));
    bis_bsdf_init(&b, &m, n, (vec3){1, 0, 0x1p-24f});
    const rgb f = bis_bsdf_f(&b, (vec3){-1, 0, 0x1p-24f});
    assert_true(f.g > 1e15f && isfinite(f.g));
}

/* At 89.9 degrees and beyond, the lobe of alpha = 1e-4 is narrower across than floats are apart: its density at a drawn
 * direction means nothing there, but f cos over it, F G2/G1, does. */
static void smoothest_mirror_keeps_its_albedo_up_to_89_99999_degrees(void **state)
{
    static const double degrees[] = {0, 60, 89, 89.9, 89.99, 89.999, 89.99999};
    const bis_material m = bis_microfacet(grey(0), grey(1), 0.01);
    bis_rng r;

    assert_near(facets_albedo_of_white(1, 60), 1 - 0.5 * log(3), 1e-4);
    bis_rng_init(&r, SEED, 8, 0, 0);
    for (int d = 0; d < COUNT(degrees); d++) {
        enum { N = 40000 };
        bis_bsdf b;
        double sum = 0;
        bis_bsdf_init(&b, &m, (vec3){0, 0, 1}, view((vec3){0, 0, 1}, degrees[d]));
        for (int i = 0; i < N; i++)
            sum += weight(&b, draw(&b, &r, RIGHT), RIGHT);
        assert_near(sum / N, facets_albedo_of_white(m.alpha, degrees[d]),
                    0.006); /* four standard errors, of G2/G1 between 0 and 1 */
    }
}

/* ---- in scenes ---- */

static bis_scene_desc *parse(const char *material, bis_diag *diag)
{
    const char *path = "build/test_microfacet.txt";
    bis_scene_desc *d = NULL;
    FILE *f = fopen(path, "w");

    assert_non_null(f);
    fprintf(f, "WorldBegin LightSource \"infinite\"\n%s\nShape \"sphere\"\n", material);
    assert_int_equal(fclose(f), 0);
    bis_scene_parse(&d, path, diag);
    return d;
}

static void scenes_name_it(void **state)
{
    bis_diag diag = {0};
    bis_scene_desc *d =
        parse("Material \"microfacet\" \"rgb Kd\" [0.1 0.2 0.3] \"float Ks\" 0.25 \"float roughness\" 0.2", &diag);
    const bis_material *m = &d->materials[d->shapes[0].material];

    assert_ptr_equal(m->model, &bis_microfacet_model);
    assert_true(m->Kd.b == 0.3f && m->Ks.r == 0.25f && fabs(m->alpha - 0.04) < 1e-15);
    bis_scene_desc_free(d);

    d = parse("MakeNamedMaterial \"brass\" \"string type\" \"microfacet\" NamedMaterial \"brass\"", &diag);
    m = &d->materials[d->shapes[0].material];
    assert_true(m->model == &bis_microfacet_model && rgb_is_black(m->Kd) && m->Ks.g == 0.9f && m->alpha == 0.25);
    bis_scene_desc_free(d);
    assert_int_equal(diag.n, 0);
}

/* `bis verify` on what users may write, and on a model that claims the wrong density. */
static rgb f_pdf_of_all_facets(const bis_bsdf *b, vec3 wi, double *pdf)
{
    const rgb f = bis_microfacet_model.f_pdf(b, wi, pdf);

    *pdf = density_of_all_facets(b, wi);
    return f;
}

static size_t verified_failures(const bis_material *m, double degrees)
{
    const bis_settings s[] = {bis_settings_default(&bis_brdf), bis_settings_default(&bis_mis)};
    bis_verify v = {.seed = SEED};
    size_t n;

    assert_int_equal(bis_verify_material(&v, &(bis_verify_lobe){"microfacet", m, degrees}, s, 1, NULL), BIS_OK);
    assert_int_equal(bis_verify_judge(&v, NULL), BIS_OK);
    n = v.n_failed;
    bis_verify_clear(&v);
    return n;
}

static void verify_accepts_it_and_rejects_the_density_of_hidden_facets(void **state)
{
    for (int i = 0; i < COUNT(roughnesses); i++) {
        const bis_material metal = bis_microfacet(grey(0), (rgb){0.9f, 0.6f, 0.3f}, roughnesses[i]);
        const bis_material plastic = bis_microfacet((rgb){0.3f, 0.2f, 0.1f}, grey(0.04), roughnesses[i]);
        assert_int_equal(verified_failures(&metal, 75), 0);
        assert_int_equal(verified_failures(&plastic, 89), 0);
    }
    bis_bsdf_model forged = bis_microfacet_model;
    bis_material m = bis_microfacet(grey(0), grey(1), 0.6);
    forged.f_pdf = f_pdf_of_all_facets;
    m.model = &forged;
    assert_true(verified_failures(&m, 75) > 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(f_and_density_are_those_of_the_papers),
        cmocka_unit_test(metals_follow_fresnels_equations),
        cmocka_unit_test(plastic_is_fresnels_glass_over_lambert),
        cmocka_unit_test(f_is_reciprocal),
        cmocka_unit_test(facets_are_drawn_as_they_are_seen),
        cmocka_unit_test(mixture_is_drawn_with_its_density_also_below_the_horizon),
        cmocka_unit_test(density_integrates_to_1_over_the_sphere),
        cmocka_unit_test(white_facets_of_alpha_1_keep_1_minus_c_log_1_plus_1_over_c),
        cmocka_unit_test(white_facets_lose_next_to_nothing_where_smooth_and_two_thirds_where_rough),
        cmocka_unit_test(no_reflectances_reflect_more_than_is_received),
        cmocka_unit_test(furnace_agrees_with_quadrature_to_grazing),
        cmocka_unit_test(bounds_hold_and_are_nearly_reached_E27),
        cmocka_unit_test(bounds_of_a_base_alone_are_reached_at_the_normal),
        cmocka_unit_test(black_material_and_hidden_surface_draw_nothing),
        cmocka_unit_test(channels_count_alike),
        cmocka_unit_test(all_stays_finite_and_below_its_bounds_for_any_material_view_and_number),
        cmocka_unit_test(nearer_to_the_horizon_than_floats_can_tell_nothing_is_reflected),
        cmocka_unit_test(smoothest_mirror_keeps_its_albedo_up_to_89_99999_degrees),
        cmocka_unit_test(scenes_name_it),
        cmocka_unit_test(verify_accepts_it_and_rejects_the_density_of_hidden_facets),
    };

    return cmocka_run_group_tests_name("microfacet", tests, NULL, NULL);
}
