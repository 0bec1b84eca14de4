/* phong_lanes: weights, colours and draws of many directions at once against phong.c in double, one by one. Family-wise
 * significance 1e-3. */
#include "beyond/phong_lanes.h"

#include "bis/base/mem.h"
#include "bis/thesis/phong.h"
#include "bis/thesis/rng.h"
#include "bis/thesis/warp.h"
#include "clones.h"
#include "stat.h"

#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

enum { SEED = 1729, N = 4096 };

static const double exponents[] = {0, 1, 2.5, 10, 50, 1e3, 1e5, 1e6, 1e8};
enum { N_EXPONENTS = sizeof exponents / sizeof *exponents, N_DRAWN = 8 /* those that are drawn */ };

/* draws: 8 exponents x 3 shares of the lobe, and 3 twins */
static double alpha(void) { return stat_level(1e-3, 8 * 3); }

static bis_lanes new_lanes(uint32_t n) { return bis_lanes_in(bis_alloc(BIS_LANES_ARRAYS * (size_t)n, sizeof(float)), n); }
static void free_lanes(const bis_lanes *l) { bis_free(l->x); }
static vec3 direction(const bis_lanes *l, uint32_t i) { return (vec3){l->x[i], l->y[i], l->z[i]}; }

static void seen_from(bis_bsdf *b, const bis_material *m, double degrees)
{
    const frame about_n = frame_about(normalize(vec3_from(0.3, -0.5, 0.7)));
    const double t = degrees * PI / 180;

    bis_bsdf_init(b, m, about_n.z, normalize(to_world(&about_n, vec3_from(sin(t) * 0.6, sin(t) * 0.8, cos(t)))));
}

/* Directions within the lobe and far out of it, next to both horizons, on the axes, everywhere; radiance over 24
 * decades, some of it black in a channel or in all. */
static void fill(const bis_lanes *l, uint32_t n, const bis_bsdf *b, uint64_t seed)
{
    const double width = 1 / sqrt(b->material->exponent + 1);
    bis_rng r;

    bis_rng_init(&r, SEED, seed, 0, 0);
    for (uint32_t i = 0; i < n; i++) {
        const double u = bis_rng_double(&r), phi = 2 * PI * bis_rng_double(&r), near = exp(-30 * u);
        double theta = fmin(PI, 12 * u * width);
        const frame *f = &b->lobe;
        if (i % 4 == 1) theta = PI / 2 + (i % 8 < 4 ? near : -near);
        if (i % 4 == 2) theta = PI / 2 + (i % 8 < 4 ? near : -near), f = &b->local;
        if (i % 4 == 3) theta = acos(1 - 2 * u);
        vec3 w = to_world(f, vec3_from(sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta)));
        if (i < 6) w = (const vec3[]){b->r, neg(b->r), b->local.z, neg(b->local.z), b->local.x, b->lobe.x}[i];
        l->x[i] = w.x, l->y[i] = w.y, l->z[i] = w.z;
        const double level = exp2(40 * bis_rng_double(&r) - 40);
        l->r[i] = i % 7 == 3 ? 0 : (float)(level * bis_rng_double(&r));
        l->g[i] = i % 7 == 3 ? 0 : (float)(level * bis_rng_double(&r));
        l->b[i] = i % 7 == 3 || i % 7 == 5 ? 0 : (float)(level * bis_rng_double(&r));
        l->q[i] = i % 7 == 3 ? 0 : (float)(level * (0.1 + bis_rng_double(&r))); /* a black pixel may have no density at all */
    }
}

/* ---- weights ---- */

typedef struct exact {
    double w, log_power, cos_theta, cos_alpha;
    double F[3];
} exact;

/* Eq. 3.14 and 4.9 in double. No power below 2^-64, as stated. */
static exact weigh_one(const bis_bsdf *b, const bis_lanes *l, uint32_t i, double beta)
{
    const bis_material *m = b->material;
    const vec3 wi = direction(l, i), d = sub(wi, b->r);
    const double power = bis_phong_power(b->r, wi, m->exponent), peak = (m->exponent + 1) * (INV_PI / 2);
    const double lobe = peak * (power > 0 ? fmax(power, 0x1p-64) : dot(d, d) < 2 ? 0x1p-64 : 0), cos_theta = bis_bsdf_cos(b, wi);
    const double Le[3] = {(double)l->r[i], (double)l->g[i], (double)l->b[i]};
    const double Ks[3] = {(double)m->Ks.r, (double)m->Ks.g, (double)m->Ks.b}, Kd[3] = {(double)m->Kd.r, (double)m->Kd.g, (double)m->Kd.b};
    const double q_f = b->p_specular * lobe + (1 - b->p_specular) * fmax(0, cos_theta) * INV_PI;
    const double q = beta * (double)l->q[i] + (1 - beta) * q_f;
    exact e = {.log_power = power > 0 ? log(fmax(power, 0x1p-64)) : -45, .cos_theta = cos_theta, .cos_alpha = 1 - dot(d, d) / 2};

    for (int c = 0; c < 3; c++) e.F[c] = (Ks[c] * (b->p_specular > 0 ? lobe : 0) + Kd[c] * INV_PI) * fmax(0, cos_theta) * Le[c];
    const double phat = e.F[0] + e.F[1] + e.F[2];
    e.w = phat > 0 ? phat / q : 0;
    return e;
}

/* The stated relative error: of the power, and of the two cosines, which are good to 2^-22 by themselves. */
static double stated(const exact *e, double exponent, bool has_lobe)
{
    const double of_cosine = 0x1p-22 / e->cos_theta, of_lobe = 0x1p-20 * (1 - e->log_power) + exponent * 0x1p-22 * (1 / e->cos_alpha - 1);
    const bool ahead = e->cos_alpha > 0;

    return 0x1p-20 + of_cosine + (has_lobe && ahead ? of_lobe : 0);
}
static double stated_in_head(const exact *e) { return 0x1p-20 * (1 - e->log_power); }

typedef struct errors {
    double of_stated, of_head, in_lobe; /* largest ratio of an error to what is stated; largest error where the power is above 0.01 */
    uint32_t n;
} errors;

static void check_weights(errors *most, const bis_bsdf_lanes *lanes, const bis_bsdf *b, const bis_lanes *l, uint32_t n, double beta)
{
    float *w = bis_alloc(bis_lanes_round_up(n), sizeof *w);
    const double unit = lanes->weigh(w, b, l, n, beta);
    const bool has_lobe = b->p_specular > 0;

    assert_true(isfinite(unit) && unit > 0);
    for (uint32_t i = 0; i < n; i++) {
        const exact e = weigh_one(b, l, i, beta);
        assert_true(isfinite(w[i]) && w[i] >= 0);
        if (e.cos_theta < -0x1p-22) assert_true(w[i] == 0);
        if (fabs(e.cos_theta) <= 0x1p-20 || (has_lobe && fabs(e.cos_alpha) <= 0x1p-20)) continue; /* next to a horizon a float does not know the side */
        if (e.w == 0) {
            assert_true(w[i] == 0);
            continue;
        }
        if ((e.F[0] + e.F[1] + e.F[2]) / unit < 1e-36) continue; /* a float's denormals: a lobe at its floor times a dark pixel */
        const double error = fabs((double)w[i] * unit / e.w - 1);
        most->of_stated = fmax(most->of_stated, error / stated(&e, b->material->exponent, has_lobe));
        if (e.cos_theta > 0.3 && (!has_lobe || e.cos_alpha > 0.3)) most->of_head = fmax(most->of_head, error / stated_in_head(&e));
        if (e.cos_theta > 0.3 && e.log_power > log(0.01)) most->in_lobe = fmax(most->in_lobe, error);
        most->n++;
    }
    bis_free(w);
}

static const double betas[] = {1, 0.5, 1.0 / 800, 799.0 / 800};

static errors weigh_everything(const bis_bsdf_lanes *lanes, double exponent, float scale)
{
    const rgb none = {0, 0, 0}, orange = {0.9f * scale, 0.5f * scale, 0.1f * scale}, blue = {0.1f * scale, 0, 0.7f * scale};
    const rgb pair[][2] = {{none, orange}, {orange, none}, {blue, orange}, {orange, {0, 0, 1e-6f * scale}}};
    static const double degrees[] = {0, 40, 85, 89.9};
    const bis_lanes l = new_lanes(N);
    errors most = {0};

    for (uint64_t k = 0; k < 4 * 4 * 4; k++) {
        const bis_material m = {.model = &bis_phong_model, .Kd = pair[k % 4][0], .Ks = pair[k % 4][1], .exponent = exponent};
        bis_bsdf b;
        seen_from(&b, &m, degrees[k / 4 % 4]);
        fill(&l, N, &b, k);
        for (uint32_t i = 0; k / 16 == 0 && i < N; i++) l.q[i] = fmaxf(l.q[i], FLT_MIN); /* what was drawn from the map alone has a density */
        check_weights(&most, lanes, &b, &l, N, betas[k / 16]);
    }
    free_lanes(&l);
    return most;
}

static void weights_are_those_of_phong_within_the_stated_error(void **state)
{
    (void)state;
    for (int e = 0; e < N_EXPONENTS; e++) {
        for (int tiny = 0; tiny < 2; tiny++) {
            const errors most = weigh_everything(&bis_phong_lanes, exponents[e], tiny ? 1e-37f : 1);
            print_message("n = %g%s: %u weights, %.2f of the error stated, %.2f of that of the lobe; in the lobe %.2g\n", exponents[e],
                          tiny ? ", Ks and Kd near 1e-38" : "", (unsigned)most.n, most.of_stated, most.of_head, most.in_lobe);
            assert_true(most.n > N);
            assert_true(most.of_stated < 1);
        }
    }
}

/* Twin: the exponent is off by 1e-5 of itself. */
static double weigh_off(float *w, const bis_bsdf *b, const bis_lanes *y, uint32_t n, double beta)
{
    bis_material m = *b->material;
    bis_bsdf off = *b;

    m.exponent *= 1.00001;
    off.material = &m;
    return bis_phong_lanes.weigh(w, &off, y, n, beta);
}

static void an_exponent_that_is_off_by_1e_5_is_found(void **state)
{
    const bis_bsdf_lanes twin = {.weigh = weigh_off};

    (void)state;
    assert_true(weigh_everything(&twin, 50, 1).of_stated >= 1);
}

static void below_the_horizon_weights_are_0_and_nothing_is_ever_nan(void **state)
{
    const bis_lanes l = new_lanes(16);
    float w[16];

    (void)state;
    for (int e = 0; e < N_EXPONENTS; e++) {
        const bis_material m = bis_phong((rgb){0, 0, 0}, (rgb){1, 1, 1}, exponents[e]);
        bis_bsdf b;
        bis_bsdf_init(&b, &m, (vec3){0, 0, 1}, (vec3){0, 0, 1});
        for (uint32_t i = 0; i < 16; i++) {
            const vec3 wi = (const vec3[]){{0, 0, -1}, {1, 0, 0}, {0, -1, 0}, {0.6f, 0, -0.8f}, {0, 1, 1e-30f}, {1, 0, -1e-30f}, {0, 0, 0}, {0, 0, 1}}[i % 8];
            l.x[i] = wi.x, l.y[i] = wi.y, l.z[i] = wi.z;
            l.r[i] = l.g[i] = l.b[i] = i < 8;
            l.q[i] = 0;
        }
        bis_phong_lanes.weigh(w, &b, &l, 16, 0.5);
        for (int i = 0; i < 16; i++) assert_true(isfinite(w[i]) && w[i] >= 0 && (i == 4 || i == 7 || w[i] == 0));
        assert_true(w[7] > 0);
        bis_phong_lanes.colour(&b, &l, 16);
        for (int i = 0; i < 16; i++) assert_true(isfinite(l.r[i]) && (i < 8 || l.r[i] == 0));
    }
    free_lanes(&l);
}

/* ---- bounds over cones ---- */

static double angle(vec3 a, vec3 b) { return acos(fmax(-1, fmin(1, (double)dot(a, b)))); }

/* By angles, in double: a cone's direction nearest to an axis is nearer by its half angle. The bound is the product of
 * two such maxima. It may be too large by what is added to the cosines (2^-20) and by the errors of float, and too small
 * by the latter alone; a cone that lies below the horizon has 0. */
static void what_reaches_a_cone_is_bounded_by_its_nearest_directions(void **state)
{
    static const double exponent = 20;
    const bis_material m = bis_phong((rgb){0.3f, 0.3f, 0.3f}, (rgb){0.5f, 0.5f, 0.5f}, exponent);
    const double lobe = (double)m.Ks.r * (exponent + 1) / (2 * PI), base = (double)m.Kd.r / PI;
    const bis_lanes l = new_lanes(N);
    float *sine = bis_alloc(N, sizeof *sine), *w = bis_alloc(N, sizeof *w);
    int n_below = 0, n_within = 0, n_judged = 0;
    bis_rng r;
    bis_bsdf b;

    (void)state;
    seen_from(&b, &m, 40);
    bis_rng_init(&r, SEED, 99, 0, 0);
    for (uint32_t i = 0; i < N; i++) {
        const double z = 2 * bis_rng_double(&r) - 1, phi = 2 * PI * bis_rng_double(&r), s = sqrt(1 - z * z);
        const double half = i % 5 == 0 ? 0 : 1.2 * bis_rng_double(&r);
        l.x[i] = (float)(s * cos(phi)), l.y[i] = (float)(s * sin(phi)), l.z[i] = (float)z;
        l.r[i] = 0.5f, l.g[i] = 0.25f, l.b[i] = 0.25f;
        l.q[i] = (float)cos(half);
        sine[i] = (float)sin(half);
    }
    bis_phong_lanes.reach(w, &b, &l, sine, N);
    for (uint32_t i = 0; i < N; i++) {
        const vec3 axis = direction(&l, i);
        const double half = atan2((double)sine[i], (double)l.q[i]);
        const double theta = angle(b.local.z, axis) - half, alpha = angle(b.r, axis) - half;
        if (theta > PI / 2 + 1e-5) {
            assert_true(w[i] == 0);
            n_below++;
            continue;
        }
        if (theta > PI / 2 - 1e-3) continue;
        const double cos_theta = cos(fmax(0, theta)), cos_alpha = alpha > PI / 2 ? 0 : cos(fmax(0, alpha));
        const double power = pow(cos_alpha, exponent), expected = cos_theta * (base + lobe * power) / fmax(lobe, base);
        const double unit = 0x1p-20, of_alpha = power < 1e-9 ? 0 : exponent * unit / cos_alpha + unit * -log(power);
        const double slack = unit / cos_theta + of_alpha + 4 * unit + 1e-8;
        if (!((double)w[i] > expected * (1 - 4 * unit - of_alpha) && (double)w[i] < expected * (1 + 2 * slack)))
            fail_msg("cone %u: %g, expected %g", (unsigned)i, (double)w[i], expected);
        n_within += alpha < 0;
        n_judged++;
    }
    assert_true(n_below > N / 10 && n_within > N / 100 && n_judged > N / 3);
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
    for (int k = 0; k < 2 * N_EXPONENTS; k++) {
        const float s = k % 2 ? 1e-37f : 1;
        const bis_material m = {.model = &bis_phong_model, .Kd = {0.2f * s, 0, 0.4f * s}, .Ks = {0.1f * s, 0.7f * s, 0.3f * s}, .exponent = exponents[k / 2]};
        bis_bsdf b;
        seen_from(&b, &m, 50);
        fill(&l, N, &b, (uint64_t)k);
        memcpy(c.x, l.x, BIS_LANES_ARRAYS * N * sizeof(float));
        bis_phong_lanes.colour(&b, &c, N);
        for (uint32_t i = 0; i < N; i++) {
            const exact e = weigh_one(&b, &l, i, 0.5);
            const double phat = e.F[0] + e.F[1] + e.F[2], got[3] = {(double)c.r[i], (double)c.g[i], (double)c.b[i]};
            const double sum = got[0] + got[1] + got[2];
            assert_true(sum == 0 || fabs(sum - 1) < 0x1p-22);
            assert_true((sum == 0) == (l.r[i] + l.b[i] == 0 && l.g[i] == 0));
            if (e.cos_theta <= 0x1p-20 || fabs(e.cos_alpha) <= 0x1p-20 || phat == 0 || e.w < 1e-36) continue;
            for (int j = 0; j < 3; j++) most = fmax(most, fabs(got[j] - e.F[j] / phat) / stated(&e, m.exponent, true));
        }
    }
    print_message("%.2f of the error stated\n", most);
    assert_true(most < 1);
    free_lanes(&l);
    free_lanes(&c);
}

/* A cone of no width is a direction: the bound is f cos times the energy, each channel by itself, relative to the first. */
static void a_cone_of_no_width_is_its_direction(void **state)
{
    enum { N_CONES = 192 };
    static const double Kd[3] = {0.1, 0.3, 0.5}, Ks[3] = {0.45, 0.2, 0.05};
    const bis_material m = bis_phong((rgb){0.1f, 0.3f, 0.5f}, (rgb){0.45f, 0.2f, 0.05f}, 10);
    const bis_lanes l = new_lanes(N_CONES);
    float w[N_CONES], sine[N_CONES] = {0};
    double expected[N_CONES];
    bis_bsdf b;
    bis_rng r;

    (void)state;
    seen_from(&b, &m, 40);
    bis_rng_init(&r, SEED, 0, 0, 5);
    for (uint32_t i = 0; i < N_CONES; i++) {
        const double theta = 1.5 * bis_rng_double(&r), phi = 2 * PI * bis_rng_double(&r);
        const vec3 at = to_world(&b.local, vec3_from(sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta)));
        const double e[3] = {i % 4 == 0 || i % 4 == 3 ? 0.7 : 0, i % 4 == 1 || i % 4 == 3 ? 1.1 : 0, i % 4 > 1 ? 1.9 : 0};
        const double power = pow(fmax(0, (double)dot(b.r, at)), 10);
        l.x[i] = at.x, l.y[i] = at.y, l.z[i] = at.z, l.q[i] = 1;
        l.r[i] = (float)e[0], l.g[i] = (float)e[1], l.b[i] = (float)e[2];
        expected[i] = 0;
        for (int c = 0; c < 3; c++) expected[i] += (Kd[c] / PI + Ks[c] * 11 / (2 * PI) * power) * e[c] * (double)dot(b.local.z, at);
    }
    bis_phong_lanes.reach(w, &b, &l, sine, N_CONES);
    for (int i = 0; i < N_CONES; i++) {
        const double ratio = (double)w[i] * expected[0] / ((double)w[0] * expected[i]);
        if (!(fabs(ratio - 1) < 1e-4)) fail_msg("cone %d: %g times the bound of the first", i, ratio);
    }
    free_lanes(&l);
}

/* ---- draws ---- */

/* Rings about the lobe's axis: equal shares of the lobe, then what is left down to 90 and to 180 degrees; each in 16
 * pieces. */
enum { N_PHI = 16, N_LOBE = 16, N_OUTER = 8, N_RINGS = N_LOBE + 2 * N_OUTER - 1, N_CELLS = N_RINGS * N_PHI, N_DRAWS = 1 << 16 };

static void ring_edges(double x[N_RINGS + 1], double n)
{
    int k = 0;

    for (int i = 0; i < N_LOBE; i++) x[k++] = -expm1(log1p(-(double)i / N_LOBE) / (n + 1));
    const double outer = x[k - 1];
    for (int i = 1; i <= N_OUTER; i++) x[k++] = outer + (1 - outer) * i / N_OUTER;
    for (int i = 1; i <= N_OUTER; i++) x[k++] = 1 + (double)i / N_OUTER;
}

static int cell(const double x[N_RINGS + 1], const frame *lobe, vec3 w)
{
    const vec3 d = sub(w, lobe->z);
    const double one_minus_cos = dot(d, d) / 2, phi = atan2(dot(w, lobe->y), dot(w, lobe->x));
    const int j = (int)floor((phi + PI) / (2 * PI) * N_PHI);
    int i = 0;

    while (i < N_RINGS - 1 && one_minus_cos >= x[i + 1]) i++;
    return i * N_PHI + (j < 0 ? 0 : j >= N_PHI ? N_PHI - 1 : j);
}

/* The lobe's share in closed form, the cosine's by midpoints. */
static void expect_draws(double *expected, const double x[N_RINGS + 1], const bis_bsdf *b, double n)
{
    enum { K = 32 };
    const vec3 normal = b->local.z;
    const double p = b->p_specular, h = dot(normal, b->lobe.z), hx = dot(normal, b->lobe.x), hy = dot(normal, b->lobe.y);

    for (int i = 0; i < N_RINGS; i++) {
        const double in_lobe = (pow(fmax(0, 1 - x[i]), n + 1) - pow(fmax(0, 1 - x[i + 1]), n + 1)) / N_PHI;
        for (int j = 0; j < N_PHI; j++) {
            double sum = 0;
            for (int k = 0; p < 1 && k < K * K; k++) {
                const double c = 1 - (x[i] + (x[i + 1] - x[i]) * (k % K + 0.5) / K), s = sqrt(fmax(0, 1 - c * c));
                const double phi = -PI + 2 * PI * (j + ((int)(k / K) + 0.5) / K) / N_PHI;
                sum += fmax(0, c * h + s * (cos(phi) * hx + sin(phi) * hy));
            }
            expected[i * N_PHI + j] = N_DRAWS * (p * in_lobe + (1 - p) * sum / (K * K) * (x[i + 1] - x[i]) * 2 / N_PHI);
        }
    }
}

static void check_draws(double n, double ks, double drawn_n)
{
    const float s = (float)ks, d = (float)(1 - ks);
    const bis_material m = bis_phong((rgb){d, d, d}, (rgb){s, s, s}, drawn_n);
    double x[N_RINGS + 1], observed[N_CELLS] = {0}, expected[N_CELLS];
    const bis_lanes l = new_lanes(N_DRAWS);
    float *u = bis_alloc(2 * N_DRAWS, sizeof *u);
    bis_bsdf b;
    bis_rng r;

    seen_from(&b, &m, 60);
    ring_edges(x, n);
    expect_draws(expected, x, &b, n);
    bis_rng_init(&r, SEED, (uint64_t)n, (uint64_t)(ks * 10), 1);
    for (int i = 0; i < 2 * N_DRAWS; i++) u[i] = (float)(bis_rng_u64(&r) >> 40) * 0x1p-24f;
    bis_phong_lanes.sample(&l, &b, u, u + N_DRAWS, N_DRAWS);
    for (uint32_t i = 0; i < N_DRAWS; i++) {
        assert_true(fabs(length(direction(&l, i)) - 1) < 1e-6);
        observed[cell(x, &b.lobe, direction(&l, i))]++;
    }
    if (drawn_n == n) {
        stat_assert_fit("phong-lanes", SEED, observed, expected, N_CELLS, alpha());
    } else {
        stat_assert_no_fit("phong-lanes-twin", SEED, observed, expected, N_CELLS, alpha());
    }
    free_lanes(&l);
    bis_free(u);
}

static void draws_have_the_density_of_the_mixture(void **state)
{
    (void)state;
    for (int e = 0; e < N_DRAWN; e++) {
        check_draws(exponents[e], 1, exponents[e]);
        check_draws(exponents[e], 0.4, exponents[e]);
        check_draws(exponents[e], 0.01, exponents[e]);
    }
    check_draws(0, 1, 1); /* twins: n + 1 for n */
    check_draws(2.5, 0.4, 3.5);
    check_draws(10, 1, 11);
}

/* The same numbers give the same direction as one by one, but for rounding. */
static void draws_of_the_lobe_are_those_of_phong_at_the_ends_of_the_square(void **state)
{
    const float ends[] = {0, 0x1p-24f, 0.25f, 0.4f, 0.5f, 0.75f, 0x1.fffffcp-1f, 0x1.fffffep-1f};
    const bis_lanes l = new_lanes(64);
    float u1[64], u2[64];

    (void)state;
    for (int i = 0; i < 64; i++) u1[i] = ends[i / 8], u2[i] = ends[i % 8];
    for (int k = 0; k < 3 * N_EXPONENTS; k++) {
        const float s = (const float[]){0, 0.4f, 1}[k % 3];
        const bis_material m = bis_phong((rgb){1 - s, 1 - s, 1 - s}, (rgb){s, s, s}, exponents[k / 3]);
        bis_bsdf b;
        seen_from(&b, &m, 60);
        bis_phong_lanes.sample(&l, &b, u1, u2, 64);
        for (uint32_t i = 0; i < 64; i++) {
            const double p = b.p_specular, u = (double)u1[i], rest = fmin(u < p ? u / p : (u - p) / (1 - p), 1 - 0x1p-24);
            vec3 wi, before, after; /* a float's u is good to 2^-22 */
            if (u > p - 1e-6) continue; /* the cosine is drawn along other lines than by bis_warp_cosine; the density is tested above */
            assert_true(bis_bsdf_sample(&b, u, rest, (double)u2[i], &wi));
            assert_true(bis_bsdf_sample(&b, u, fmax(rest - 0x1p-22, 0), (double)u2[i], &before));
            assert_true(bis_bsdf_sample(&b, u, fmin(rest + 0x1p-22, 1 - 0x1p-26), (double)u2[i], &after));
            assert_true(length(sub(wi, direction(&l, i))) < length(sub(wi, before)) + length(sub(wi, after)) + 1e-6);
        }
    }
    free_lanes(&l);
}

/* ---- the same bits ---- */

static void weights_colours_and_draws_have_the_same_bits_on_every_processor(void **state)
{
    const bis_bsdf_lanes *const clones[] = {&plain_phong_lanes, clone_has_avx2() ? &avx2_phong_lanes : &plain_phong_lanes};
    const bis_lanes a = new_lanes(N), b = new_lanes(N);
    float *w = bis_alloc(N, sizeof *w), *v = bis_alloc(N, sizeof *v);

    (void)state;
    for (int k = 0; k < 3 * N_EXPONENTS; k++) {
        const float s = (const float[]){0, 0.4f, 1}[k % 3];
        const bis_material m = bis_phong((rgb){1 - s, 0.5f * (1 - s), 0}, (rgb){s, 0, 0.3f * s}, exponents[k / 3]);
        bis_bsdf at;
        seen_from(&at, &m, 70);
        for (int c = 0; c < 2; c++) {
            fill(&a, N, &at, (uint64_t)k);
            memcpy(b.x, a.x, BIS_LANES_ARRAYS * N * sizeof(float));
            assert_true(bis_phong_lanes.weigh(w, &at, &a, N, 0.9) == clones[c]->weigh(v, &at, &b, N, 0.9));
            assert_memory_equal(w, v, N * sizeof *w);
            bis_phong_lanes.colour(&at, &a, N);
            clones[c]->colour(&at, &b, N);
            assert_memory_equal(a.x, b.x, BIS_LANES_ARRAYS * N * sizeof(float));
            bis_lanes_points(w, v, N, (uint64_t)k);
            bis_phong_lanes.sample(&a, &at, w, v, N);
            clones[c]->sample(&b, &at, w, v, N);
            assert_memory_equal(a.x, b.x, 3 * N * sizeof(float));
        }
    }
    free_lanes(&a);
    free_lanes(&b);
    bis_free(w);
    bis_free(v);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(weights_are_those_of_phong_within_the_stated_error),
        cmocka_unit_test(an_exponent_that_is_off_by_1e_5_is_found),
        cmocka_unit_test(below_the_horizon_weights_are_0_and_nothing_is_ever_nan),
        cmocka_unit_test(what_reaches_a_cone_is_bounded_by_its_nearest_directions),
        cmocka_unit_test(a_cone_of_no_width_is_its_direction),
        cmocka_unit_test(colours_are_F_over_phat_and_sum_to_1),
        cmocka_unit_test(draws_have_the_density_of_the_mixture),
        cmocka_unit_test(draws_of_the_lobe_are_those_of_phong_at_the_ends_of_the_square),
        cmocka_unit_test(weights_colours_and_draws_have_the_same_bits_on_every_processor),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
