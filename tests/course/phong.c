/* SPDX-License-Identifier: BSD-2-Clause */
/* Assignment phong: src/thesis/phong_formulas.h, the lobe's direction, f with its density, and the choice of a lobe.
 * Closed forms, and quadrature over the sphere. Statistical tests: 10. */
#include "mark.h"

#include "bis/thesis/rng.h"
#include "bis/thesis/warp.h"

#include <stdio.h>

static const char *const in_lobe = "Eq. 3.16 draws cos theta = (1 - u1)^(1/(n+1)).";

/* A surface about a tilted normal, seen at so many degrees from it; b: our own view of it, for its frames. m must
 * stay where it is. */
static ask_surface seen(bis_bsdf *b, const bis_material *m, double degrees)
{
    const frame about_n = frame_about(normalize(vec3_from(0.3, -0.5, 0.7)));
    const double t = degrees * PI / 180;
    ask_surface s = {*m, about_n.z, normalize(to_world(&about_n, vec3_from(sin(t) * 0.6, sin(t) * 0.8, cos(t))))};

    bis_bsdf_init(b, m, s.n, s.wo);
    s.material.model = NULL; /* an address of this process */
    return s;
}

/* The student's draws, of a surface alone. */
static void sample(const ask_surface *s, const double *u, size_t n, vec3 *wi)
{
    uint8_t *drawn = mark_alloc(n, sizeof *drawn);

    ASK(ASK_SAMPLE, GIVE(s, 1), GIVE(u, 3 * n), TAKE(wi, n), TAKE(drawn, n));
    for (size_t k = 0; k < n; k++) {
        if (!drawn[k]) {
            mark_wrong("nothing is drawn from a material that reflects (a direction below the horizon is returned, "
                       "not refused: errata E34)");
        }
    }
}

static void the_lobe_is_drawn_by_eq_3_16(void)
{
    enum { N = 32 };
    const double exponents[] = {0, 1, 10, 1000};
    double in[N][3], pdf[N];
    vec3 wi[N];

    for (int k = 0; k < N; k++) {
        in[k][0] = exponents[k / 8];
        in[k][1] = (k % 8 + 0.5) / 8;
        in[k][2] = 0.125 + 0.09 * (k % 8);
    }
    ASK(ASK_LOBE, GIVE(in, N), TAKE(wi, N), TAKE(pdf, N));
    for (int k = 0; k < N; k++) {
        const double n = in[k][0], u1 = in[k][1], cosine = pow(1 - u1, 1 / (n + 1));
        mark_near((double)wi[k].z, cosine, 1e-6, 0, "n = %g, u1 = %g: cos theta of the direction", n, u1);
        mark_near(length(wi[k]), 1, 1e-6, 0, "n = %g, u1 = %g: the length of the direction", n, u1);
        mark_near(pdf[k], (n + 1) / (2 * PI) * pow(cosine, n), 0, 1e-6, "n = %g, u1 = %g: the density, (n+1)/(2 "
                  "pi) cos^n,", n, u1);
    }
}

/* Is the direction of the lobe right? Who fails the claim before does not fail again for it. */
static bool lobe_is_right(void)
{
    double in[1][3] = {{6, 0.4, 0.3}}, pdf[1];
    vec3 wi[1];

    ASK(ASK_LOBE, GIVE(in, 1), TAKE(wi, 1), TAKE(pdf, 1));
    return fabs((double)wi[0].z - pow(0.6, 1.0 / 7)) < 1e-5 && fabs(length(wi[0]) - 1) < 1e-5;
}

static void the_azimuth_of_the_lobe_is_uniform(void)
{
    enum { CELLS = 16, DRAWS = 40000 };
    double observed[CELLS] = {0}, expected[CELLS], *u = mark_uniforms(2 * DRAWS, mark_seed(1), 0),
        *pdf = mark_alloc(DRAWS, sizeof *pdf);
    double(*in)[3] = mark_alloc(DRAWS, sizeof *in);
    vec3 *wi = mark_alloc(DRAWS, sizeof *wi);

    for (int k = 0; k < DRAWS; k++) {
        in[k][0] = 5;
        in[k][1] = u[2 * k];
        in[k][2] = u[2 * k + 1];
    }
    ASK(ASK_LOBE, GIVE(in, DRAWS), TAKE(wi, DRAWS), TAKE(pdf, DRAWS));
    for (int k = 0; k < DRAWS; k++) {
        const double turn = (atan2((double)wi[k].y, (double)wi[k].x) / (2 * PI) + 0.5) * CELLS;
        if (!isfinite(turn)) mark_wrong("a direction is not finite");
        observed[turn < CELLS ? (int)turn : CELLS - 1]++;
    }
    for (int i = 0; i < CELLS; i++) expected[i] = DRAWS / (double)CELLS;
    mark_fit(observed, expected, CELLS, MARK_ALPHA, "sixteen sectors about the lobe's axis", "phi = 2 pi u2.");
}

static void narrow_lobes_keep_their_precision(void)
{
    enum { N = 2000 };
    double *u = mark_uniforms(2 * N, mark_seed(2), 0), pdf[N];
    static double in[N][3];
    vec3 wi[N];

    for (int k = 0; k < N; k++) {
        in[k][0] = 1e6;
        in[k][1] = pow(10, -8 * u[2 * k]) / 2; /* near the axis, too */
        in[k][2] = u[2 * k + 1];
    }
    ASK(ASK_LOBE, GIVE(in, N), TAKE(wi, N), TAKE(pdf, N));
    for (int k = 0; k < N; k++) {
        const long double versine = -expm1l(log1pl(-(long double)in[k][1]) / (1e6L + 1));
        const double sine = (double)sqrtl(versine * (2 - versine));
        mark_near(hypot((double)wi[k].x, (double)wi[k].y), sine, 0, 1e-6,
                  "n = 1e6, u1 = %g, where 1 - cos theta is %.2Lg (what do pow and "
                  "sqrt(1 - cos^2) leave of it? expm1 and log1p do better): sin theta", in[k][1], versine);
    }
}

/* f, and the density q of the handout. */
static rgb f_by_hand(const bis_bsdf *b, vec3 wi, double *q)
{
    const bis_material *m = b->material;
    const vec3 n = b->local.z;
    const double c_i = dot(n, wi), c_o = dot(n, b->wo), a = 2 * c_i * c_o - dot(wi, b->wo);
    const double lobe = a > 0 ? (m->exponent + 1) / (2 * PI) * pow(a, m->exponent) : 0;

    *q = b->p_specular * lobe + (1 - b->p_specular) * fmax(0, c_i) / PI;
    if (c_i <= 0 || c_o <= 0) return (rgb){0, 0, 0};
    return rgb_add(rgb_scale(m->Ks, lobe), rgb_scale(m->Kd, 1 / PI));
}

static vec3 any_direction(bis_rng *r)
{
    const double z = 2 * bis_rng_double(r) - 1, phi = 2 * PI * bis_rng_double(r), s = sqrt(1 - z * z);

    return vec3_from(s * cos(phi), s * sin(phi), z);
}

/* Exponents from 1 on: below, the power is steep where the lobe ends, and float vectors decide. */
static bis_material material(int k)
{
    static const double exponents[] = {12, 1, 3, 80};
    const rgb Kd = {0.1f, 0.3f, 0.2f}, Ks = {0.6f, 0.5f, 0.4f}, none = {0, 0, 0};

    return bis_phong(k % 7 == 5 ? none : Kd, k % 7 == 6 ? none : Ks, exponents[k / 4 % 4]);
}

/* Three unit vectors of floats: the lobe's cosine is good to 4e-7, its 80th power to 4e-5. From the normal: above
 * the horizon, and below it, where smooth normals may bring the eye. */
static int angle_of_eye(int k) { return k % 4 == 3 ? 92 + k % 80 : k % 89; }

static const char *place_of_eye(int degrees) { return degrees > 90 ? " (the eye lies below the horizon)" : ""; }

/* A thousand surfaces with a direction each, and what the student says of them. `out`: floats may put the
 * direction on the other side of the horizon. */
enum { LOOKS = 1000 };
typedef struct looks {
    bis_material m[LOOKS];
    bis_bsdf b[LOOKS];
    ask_surface s[LOOKS];
    vec3 wi[LOOKS];
    rgb f[LOOKS];
    double pdf[LOOKS], alone[LOOKS];
    bool out[LOOKS];
} looks;

static looks *look(uint64_t seed)
{
    looks *l = mark_alloc(1, sizeof *l);
    bis_rng r;

    bis_rng_init(&r, mark_seed(seed), 0, 0, 0);
    for (int k = 0; k < LOOKS; k++) {
        l->m[k] = material(k);
        l->s[k] = seen(&l->b[k], &l->m[k], angle_of_eye(k));
        l->wi[k] = any_direction(&r);
        l->out[k] = fabs(bis_bsdf_cos(&l->b[k], l->wi[k])) < 1e-6;
    }
    ASK(ASK_F, GIVE(l->s, LOOKS), GIVE(l->wi, LOOKS), TAKE(l->f, LOOKS), TAKE(l->pdf, LOOKS), TAKE(l->alone, LOOKS));
    return l;
}

static void f_is_eq_3_14(void)
{
    looks *l = look(3);

    for (int k = 0; k < LOOKS; k++) {
        const int degrees = angle_of_eye(k);
        const bis_bsdf *b = &l->b[k];
        if (l->out[k]) continue;
        double q;
        const rgb must = f_by_hand(b, l->wi[k], &q);
        const double got[] = {(double)l->f[k].r, (double)l->f[k].g, (double)l->f[k].b},
            hand[] = {(double)must.r, (double)must.g, (double)must.b};
        for (int i = 0; i < 3; i++) {
            mark_near(got[i], hand[i], 1e-6, 5e-5, "n = %g, seen at %d degrees from the normal%s, light at %.0f "
                      "degrees: channel %d of f",
                      l->m[k].exponent, degrees, place_of_eye(degrees),
                          acos(fmax(-1, fmin(1, bis_bsdf_cos(b, l->wi[k])))) * 180 / PI, i);
        }
    }
}

/* Integral over the sphere, by midpoints about the lobe's axis. */
static double integral_of_pdf(const ask_surface *s, const bis_bsdf *b)
{
    enum { K = 600 };
    vec3 *wi = mark_alloc(K * K, sizeof *wi);
    double *pdf = mark_alloc(K * K, sizeof *pdf), sum = 0;

    for (int i = 0; i < K * K; i++) {
        const double z = 1 - 2 * (i / K + 0.5) / K, t = sqrt(1 - z * z), phi = 2 * PI * (i % K + 0.5) / K;
        wi[i] = to_world(&b->lobe, vec3_from(t * cos(phi), t * sin(phi), z));
    }
    ASK(ASK_F, GIVE(s, 1), GIVE(wi, K * K), TAKE(wi, 0), TAKE(pdf, 0), TAKE(pdf, K * K));
    for (int i = 0; i < K * K; i++) sum += pdf[i];
    return sum * 4 * PI / K / K;
}

static void check_density(void)
{
    looks *l = look(7);

    for (int k = 0; k < LOOKS; k++) {
        const int degrees = angle_of_eye(k);
        double must;
        if (l->out[k]) continue;
        f_by_hand(&l->b[k], l->wi[k], &must);
        const double both[] = {l->alone[k], l->pdf[k]};
        for (int i = 0; i < 2; i++) {
            mark_near(both[i], must, 1e-6, 5e-5, "n = %g, p_s = %g, seen at %d degrees from the normal%s, light at "
                      "%.0f degrees: the "
                      "density q%s", l->m[k].exponent, l->b[k].p_specular, degrees, place_of_eye(degrees),
                      acos(fmax(-1, fmin(1, bis_bsdf_cos(&l->b[k], l->wi[k])))) * 180 / PI, i
                          ? " that comes with f" : "");
        }
    }
}

static void the_density_is_q_and_integrates_to_1(void)
{
    const double mixes[][2] = {{1, 0}, {0, 1}, {0.3, 0.7}, {0.5, 0.2}};

    for (int k = 0; k < 4; k++) {
        const bis_material m = bis_phong(rgb_from(mixes[k][0], mixes[k][0], mixes[k][0]),
                                         rgb_from(mixes[k][1], mixes[k][1], mixes[k][1]), 8);
        for (int degrees = 0; degrees <= 80; degrees += 40) {
            bis_bsdf b;
            const ask_surface s = seen(&b, &m, degrees);
            mark_near(integral_of_pdf(&s, &b), 1, 3e-3, 0, "Kd %g, Ks %g, seen at %d degrees: the integral of the "
                      "density over the sphere, below the horizon too,", mixes[k][0], mixes[k][1], degrees);
        }
    }
    check_density();
}

/* u0 alone chooses: below p_s the direction is the student's own of the lobe about its axis, which other claims look
 * at, else the cosine about the normal. */
static void check_directions(const bis_bsdf *b, const double *u, const vec3 *wi, size_t n)
{
    double(*in)[3] = mark_alloc(n, sizeof *in), *pdf = mark_alloc(n, sizeof *pdf);
    vec3 *about_axis = mark_alloc(n, sizeof *about_axis);

    for (size_t k = 0; k < n; k++) {
        in[k][0] = b->material->exponent;
        in[k][1] = u[3 * k + 1];
        in[k][2] = u[3 * k + 2];
    }
    ASK(ASK_LOBE, GIVE(in, n), TAKE(about_axis, n), TAKE(pdf, n));
    for (size_t k = 0; k < n; k++) {
        const bool lobe = u[3 * k] < b->p_specular;
        const double cosine = lobe ? (double)about_axis[k].z : (double)bis_warp_cosine(in[k][1], in[k][2]).z;
        mark_near(dot(wi[k], lobe ? b->r : b->local.z), cosine, 1e-5, 0,
                  "u0 = %.3f, p_s = %.3f, u1 = %.3f: the cosine about the %s", u[3 * k], b->p_specular, in[k][1],
                  lobe ? "lobe's axis" : "normal");
    }
}

static void check_choice_of_a_lobe(void)
{
    enum { N = 1000 };
    const bis_material m = bis_phong((rgb){0.4f, 0.3f, 0.2f}, (rgb){0.5f, 0.6f, 0.7f}, 6), mirror = material(5);
    const bis_material black = bis_phong((rgb){0, 0, 0}, (rgb){0, 0, 0}, 6);
    bis_bsdf b, other;
    const ask_surface s = seen(&b, &m, 50), only_lobe = seen(&other, &mirror, 50), none = seen(&other, &black, 50);
    double *u = mark_uniforms(3 * N, mark_seed(8), 0);
    const double half[] = {0.5, 0.5, 0.5};
    uint8_t drawn;
    vec3 wi[N];

    sample(&s, u, N, wi);
    check_directions(&b, u, wi, N);
    sample(&only_lobe, half, 1, wi);
    ASK(ASK_SAMPLE, GIVE(&none, 1), GIVE(half, 3), TAKE(wi, 1), TAKE(&drawn, 1));
    if (drawn) mark_wrong("a black material: the result must be false, nothing is drawn");
}

/* The cells: 8 rings of equal solid angle about the normal x 8 sectors. */
static void samples_have_the_density(void)
{
    enum { RINGS = 8, SECTORS = 8, CELLS = RINGS * SECTORS, FINE = 48, DRAWS = 60000 };
    const double angles[] = {20, 60, 80};
    vec3 *wi = mark_alloc(DRAWS, sizeof *wi);

    check_choice_of_a_lobe();
    for (int a = 0; a < 3 && lobe_is_right(); a++) {
        const bis_material m = bis_phong((rgb){0.4f, 0.3f, 0.2f}, (rgb){0.5f, 0.6f, 0.7f}, 6);
        double observed[CELLS] = {0}, expected[CELLS] = {0}, *u = mark_uniforms(3 * DRAWS, mark_seed(4), (uint64_t)a);
        bis_bsdf b;
        const ask_surface s = seen(&b, &m, angles[a]);
        sample(&s, u, DRAWS, wi);
        for (int k = 0; k < DRAWS; k++) {
            const vec3 w = to_local(&b.local, wi[k]);
            if (!(fabs(length(w) - 1) < 1e-5)) mark_wrong("a direction has length %g, must be 1", length(w));
            const int ring = (int)((1 - (double)w.z) / 2 * RINGS),
                sector = (int)((atan2((double)w.y, (double)w.x) / (2 * PI) + 0.5) * SECTORS);
            observed[(ring < RINGS ? ring : RINGS - 1) * SECTORS + (sector < SECTORS ? sector : SECTORS - 1)]++;
        }
        for (int i = 0; i < CELLS; i++) {
            for (int k = 0; k < FINE * FINE; k++) {
                const double z = 1 - 2 * (i / SECTORS + ((int)(k / FINE) + 0.5) / FINE) / RINGS, t = sqrt(1 - z * z);
                const double phi = 2 * PI * ((i % SECTORS + (k % FINE + 0.5) / FINE) / SECTORS - 0.5);
                double q;
                f_by_hand(&b, to_world(&b.local, vec3_from(t * cos(phi), t * sin(phi), z)), &q);
                expected[i] += q * 4 * PI / CELLS / (FINE * FINE) * DRAWS;
            }
        }
        mark_fit(observed, expected, CELLS, MARK_ALPHA, "rings and sectors about the normal",
                 "The cosine and the lobe, "
                 "which reaches below the horizon, each with its share (errata E34, E35).");
    }
}

/* Of a surface without the lobe where that is wrong, which costs other claims. */
static void the_albedo_comes_out_of_the_samples(void)
{
    const float Ks = lobe_is_right() ? 0.7f : 0;
    enum { K = 400, DRAWS = 30000 };
    vec3 *wi = mark_alloc(DRAWS, sizeof *wi);
    rgb *f = mark_alloc(DRAWS, sizeof *f);
    double *pdf = mark_alloc(DRAWS, sizeof *pdf);

    for (int degrees = 0; degrees <= 85; degrees += 17) {
        const bis_material m = bis_phong((rgb){0.3f, 0.3f, 0.3f}, (rgb){Ks, Ks, Ks}, 10);
        bis_bsdf b;
        const ask_surface s = seen(&b, &m, degrees);
        stat_moments mean = {0};
        double truth = 0, *u = mark_uniforms(3 * DRAWS, mark_seed(5), (uint64_t)degrees);
        for (int i = 0; i < K * K; i++) {
            const double z = (i / K + 0.5) / K, t = sqrt(1 - z * z), phi = 2 * PI * (i % K + 0.5) / K;
            double q;
            truth += (double)f_by_hand(&b, to_world(&b.local, vec3_from(t * cos(phi), t * sin(phi), z)),
                                       &q).r * z * 2 * PI / K / K;
        }
        sample(&s, u, DRAWS, wi);
        ASK(ASK_F, GIVE(&s, 1), GIVE(wi, DRAWS), TAKE(f, DRAWS), TAKE(pdf, DRAWS), TAKE(pdf, 0));
        for (int k = 0; k < DRAWS; k++) {
            const double c = bis_bsdf_cos(&b, wi[k]);
            stat_add(&mean, c > 0 ? (double)f[k].r * c / pdf[k] : 0);
        }
        char what[64];
        snprintf(what, sizeof what, "albedo seen at %d degrees, n = 10", degrees);
        if (Ks > 0) mark_mean(&mean, truth, MARK_ALPHA, what, in_lobe);
        else mark_near(mean.mean, truth, 1e-4, 0, "%s, without the lobe", what); /* Kd, but for quadrature */
    }
}

static void work(void)
{
    enum { LOOKED_AT = 1000 }; /* who leaves out a share p of the work gets by with probability (1 - p)^1000 */
    const bis_material m = bis_phong((rgb){0.4f, 0.3f, 0.2f}, (rgb){0.5f, 0.6f, 0.7f}, (double)mark_size(50));
    bis_bsdf b;
    const ask_surface s = seen(&b, &m, (double)mark_size(40));
    const size_t n = mark_size(500000);
    double *u = mark_uniforms(3 * n, mark_seed(6), 0), *pdf = mark_alloc(n, sizeof *pdf), q;
    vec3 *wi = mark_alloc(n, sizeof *wi);
    rgb *f = mark_alloc(n, sizeof *f);

    sample(&s, u, n, wi);
    ASK(ASK_F, GIVE(&s, 1), GIVE(wi, n), TAKE(f, n), TAKE(pdf, n), TAKE(pdf, 0));
    for (size_t i = 0; i < LOOKED_AT; i++) {
        const size_t k = (size_t)(u[i] * (double)n);
        check_directions(&b, &u[3 * k], &wi[k], 1);
        if (fabs(bis_bsdf_cos(&b, wi[k])) < 1e-6) continue; /* floats may put it on the other side */
        const rgb must = f_by_hand(&b, wi[k], &q);
        mark_near((double)f[k].g, (double)must.g, 1e-6, 5e-5, "the load that is timed: f");
        mark_near(pdf[k], q, 1e-6, 5e-5, "the load that is timed: the density");
    }
}

int main(int argc, char **argv)
{
    static const mark_claim claims[] = {
        {"the_lobe_is_drawn_by_eq_3_16", 15, the_lobe_is_drawn_by_eq_3_16},
        {"the_azimuth_of_the_lobe_is_uniform", 5, the_azimuth_of_the_lobe_is_uniform},
        {"narrow_lobes_keep_their_precision", 5, narrow_lobes_keep_their_precision},
        {"f_is_eq_3_14", 15, f_is_eq_3_14},
        {"the_density_is_q_and_integrates_to_1", 10, the_density_is_q_and_integrates_to_1},
        {"samples_have_the_density", 20, samples_have_the_density},
        {"the_albedo_comes_out_of_the_samples", 10, the_albedo_comes_out_of_the_samples},
    };

    return mark_main(argc, argv, claims, sizeof claims / sizeof *claims, work, 5.4);
}
