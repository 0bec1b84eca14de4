/* Assignment phong: src/thesis/phong_formulas.h, the lobe's direction, f with its density, and the choice of a lobe. Closed forms, and quadrature over
 * the sphere. Statistical tests: 10. */
#include "mark.h"

#include "bis/thesis/phong.h"
#include "bis/thesis/rng.h"
#include "bis/thesis/warp.h"

#include <stdio.h>

static const char *const in_lobe = "Eq. 3.16 draws cos theta = (1 - u1)^(1/(n+1)).";

static bis_bsdf seen(const bis_material *m, double degrees)
{
    const frame about_n = frame_about(normalize(vec3_from(0.3, -0.5, 0.7)));
    const double t = degrees * PI / 180;
    bis_bsdf b;

    bis_bsdf_init(&b, m, about_n.z, normalize(to_world(&about_n, vec3_from(sin(t) * 0.6, sin(t) * 0.8, cos(t)))));
    return b;
}

static void the_lobe_is_drawn_by_eq_3_16(void)
{
    const double exponents[] = {0, 1, 10, 1000};

    for (int e = 0; e < 4; e++) {
        const double n = exponents[e];
        for (int k = 0; k < 8; k++) {
            const double u1 = (k + 0.5) / 8, u2 = 0.125 + 0.09 * k, cosine = pow(1 - u1, 1 / (n + 1));
            vec3 wi;
            double pdf;
            bis_phong_lobe_sample(&wi, &pdf, n, u1, u2);
            mark_near((double)wi.z, cosine, 1e-6, 0, "n = %g, u1 = %g: cos theta of the direction", n, u1);
            mark_near(length(wi), 1, 1e-6, 0, "n = %g, u1 = %g: the length of the direction", n, u1);
            mark_near(pdf, (n + 1) / (2 * PI) * pow(cosine, n), 0, 1e-6, "n = %g, u1 = %g: the density, (n+1)/(2 "
                      "pi) cos^n,", n, u1);
        }
    }
}

static void the_azimuth_of_the_lobe_is_uniform(void)
{
    enum { CELLS = 16, DRAWS = 40000 };
    double observed[CELLS] = {0}, expected[CELLS];
    bis_rng r;

    bis_rng_init(&r, mark_seed(1), 0, 0, 0);
    for (int k = 0; k < DRAWS; k++) {
        vec3 wi;
        double pdf;
        const double u1 = bis_rng_double(&r), u2 = bis_rng_double(&r);
        bis_phong_lobe_sample(&wi, &pdf, 5, u1, u2);
        const int i = (int)((atan2((double)wi.y, (double)wi.x) / (2 * PI) + 0.5) * CELLS);
        observed[i < CELLS ? i : CELLS - 1]++;
    }
    for (int i = 0; i < CELLS; i++) expected[i] = DRAWS / (double)CELLS;
    mark_fit(observed, expected, CELLS, MARK_ALPHA, "sixteen sectors about the lobe's axis", "phi = 2 pi u2.");
}

static void narrow_lobes_keep_their_precision(void)
{
    const double n = 1e6;
    bis_rng r;

    bis_rng_init(&r, mark_seed(2), 0, 0, 0);
    for (int k = 0; k < 2000; k++) {
        vec3 wi;
        double pdf;
        const double u1 = pow(10, -8 * bis_rng_double(&r)) / 2; /* near the axis, too */
        const long double versine = -expm1l(log1pl(-(long double)u1) / ((long double)n + 1));
        const double sine = (double)sqrtl(versine * (2 - versine));
        bis_phong_lobe_sample(&wi, &pdf, n, u1, bis_rng_double(&r));
        mark_near(hypot((double)wi.x, (double)wi.y), sine, 0, 1e-6, "n = 1e6, u1 = %g, where 1 - cos theta is %.2Lg (what do pow and "
                  "sqrt(1 - cos^2) leave of it? expm1 and log1p do better): sin theta", u1, versine);
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

/* Three unit vectors of floats: the lobe's cosine is good to 4e-7, its 80th power to 4e-5. From the normal: above the horizon, and below it, where smooth normals may bring the eye. */
static int angle_of_eye(int k) { return k % 4 == 3 ? 92 + k % 80 : k % 89; }

static const char *place_of_eye(int degrees) { return degrees > 90 ? " (the eye lies below the horizon)" : ""; }

static void f_is_eq_3_14(void)
{
    bis_rng r;

    bis_rng_init(&r, mark_seed(3), 0, 0, 0);
    for (int k = 0; k < 1000; k++) {
        const bis_material m = material(k);
        const int degrees = angle_of_eye(k);
        const bis_bsdf b = seen(&m, degrees);
        const vec3 wi = any_direction(&r);
        if (fabs(bis_bsdf_cos(&b, wi)) < 1e-6) continue; /* floats may put it on the other side */
        double q;
        const rgb f = bis_bsdf_f_pdf(&b, wi, &q), must = f_by_hand(&b, wi, &q);
        const double got[] = {(double)f.r, (double)f.g, (double)f.b}, hand[] = {(double)must.r, (double)must.g, (double)must.b};
        for (int i = 0; i < 3; i++) {
            mark_near(got[i], hand[i], 1e-6, 5e-5, "n = %g, seen at %d degrees from the normal%s, light at %.0f degrees: channel %d of f",
                      m.exponent, degrees, place_of_eye(degrees), acos(fmax(-1, fmin(1, bis_bsdf_cos(&b, wi)))) * 180 / PI, i);
        }
    }
}

/* Integral over the sphere, by midpoints about the lobe's axis. */
static double integral_of_pdf(const bis_bsdf *b)
{
    enum { K = 600 };
    double sum = 0;

    for (int i = 0; i < K; i++) {
        const double z = 1 - 2 * (i + 0.5) / K, s = sqrt(1 - z * z);
        for (int j = 0; j < K; j++) {
            const double phi = 2 * PI * (j + 0.5) / K;
            sum += bis_bsdf_pdf(b, to_world(&b->lobe, vec3_from(s * cos(phi), s * sin(phi), z)));
        }
    }
    return sum * 4 * PI / K / K;
}

static void check_density(void)
{
    bis_rng r;

    bis_rng_init(&r, mark_seed(7), 0, 0, 0);
    for (int k = 0; k < 1000; k++) {
        const bis_material m = material(k);
        const int degrees = angle_of_eye(k);
        const bis_bsdf b = seen(&m, degrees);
        const vec3 wi = any_direction(&r);
        if (fabs(bis_bsdf_cos(&b, wi)) < 1e-6) continue;
        double must;
        f_by_hand(&b, wi, &must);
        mark_near(bis_bsdf_pdf(&b, wi), must, 1e-6, 5e-5, "n = %g, p_s = %g, seen at %d degrees from the normal%s, light at %.0f degrees: the "
                  "density q", m.exponent, b.p_specular, degrees, place_of_eye(degrees), acos(fmax(-1, fmin(1, bis_bsdf_cos(&b, wi)))) * 180 / PI);
    }
}

static void the_density_is_q_and_integrates_to_1(void)
{
    const double mixes[][2] = {{1, 0}, {0, 1}, {0.3, 0.7}, {0.5, 0.2}};

    for (int k = 0; k < 4; k++) {
        const bis_material m = bis_phong(rgb_from(mixes[k][0], mixes[k][0], mixes[k][0]), rgb_from(mixes[k][1], mixes[k][1], mixes[k][1]), 8);
        for (int degrees = 0; degrees <= 80; degrees += 40) {
            const bis_bsdf b = seen(&m, degrees);
            mark_near(integral_of_pdf(&b), 1, 3e-3, 0, "Kd %g, Ks %g, seen at %d degrees: the integral of the "
                      "density over the sphere, below the horizon too,", mixes[k][0], mixes[k][1], degrees);
        }
    }
    check_density();
}

/* u0 alone chooses: below p_s the direction is eq. 3.16 about the lobe's axis, else the cosine about the normal. */
static void check_choice_of_a_lobe(void)
{
    const bis_material m = bis_phong((rgb){0.4f, 0.3f, 0.2f}, (rgb){0.5f, 0.6f, 0.7f}, 6), mirror = material(5);
    const bis_material black = bis_phong((rgb){0, 0, 0}, (rgb){0, 0, 0}, 6);
    const bis_bsdf b = seen(&m, 50), only_lobe = seen(&mirror, 50), none = seen(&black, 50);
    bis_rng r;
    vec3 wi;

    bis_rng_init(&r, mark_seed(8), 0, 0, 0);
    for (int k = 0; k < 1000; k++) {
        const double u0 = bis_rng_double(&r), u1 = bis_rng_double(&r), u2 = bis_rng_double(&r);
        const bool lobe = u0 < b.p_specular;
        if (!bis_bsdf_sample(&b, u0, u1, u2, &wi)) mark_wrong("nothing is drawn from a material that reflects (errata E34)");
        const double cosine = lobe ? pow(1 - u1, 1 / (m.exponent + 1)) : (double)bis_warp_cosine(u1, u2).z;
        mark_near(dot(wi, lobe ? b.r : b.local.z), cosine, 1e-5, 0, "u0 = %.3f, p_s = %.3f, u1 = %.3f: the cosine about the %s", u0,
                  b.p_specular, u1, lobe ? "lobe's axis" : "normal");
    }
    if (!bis_bsdf_sample(&only_lobe, 0.5, 0.5, 0.5, &wi)) mark_wrong("nothing is drawn from a material without a diffuse part");
    if (bis_bsdf_sample(&none, 0.5, 0.5, 0.5, &wi)) mark_wrong("a black material: the result must be false, nothing is drawn");
}

/* The cells: 8 rings of equal solid angle about the normal x 8 sectors. */
static void samples_have_the_density(void)
{
    enum { RINGS = 8, SECTORS = 8, CELLS = RINGS * SECTORS, FINE = 48, DRAWS = 60000 };
    const double angles[] = {20, 60, 80};

    check_choice_of_a_lobe();
    for (int a = 0; a < 3; a++) {
        const bis_material m = bis_phong((rgb){0.4f, 0.3f, 0.2f}, (rgb){0.5f, 0.6f, 0.7f}, 6);
        const bis_bsdf b = seen(&m, angles[a]);
        double observed[CELLS] = {0}, expected[CELLS] = {0};
        bis_rng r;
        bis_rng_init(&r, mark_seed(4), (uint64_t)a, 0, 0);
        for (int k = 0; k < DRAWS; k++) {
            vec3 wi;
            const double u0 = bis_rng_double(&r), u1 = bis_rng_double(&r), u2 = bis_rng_double(&r);
            if (!bis_bsdf_sample(&b, u0, u1, u2, &wi)) {
                mark_wrong("nothing is drawn from a material that reflects (a direction below the horizon is "
                           "returned, not refused: errata E34)");
            }
            const vec3 w = to_local(&b.local, wi);
            const int ring = (int)((1 - (double)w.z) / 2 * RINGS), sector = (int)((atan2((double)w.y, (double)w.x) / (2 * PI) + 0.5) * SECTORS);
            observed[(ring < RINGS ? ring : RINGS - 1) * SECTORS + (sector < SECTORS ? sector : SECTORS - 1)]++;
        }
        for (int i = 0; i < CELLS; i++) {
            for (int k = 0; k < FINE * FINE; k++) {
                const double z = 1 - 2 * (i / SECTORS + ((int)(k / FINE) + 0.5) / FINE) / RINGS, s = sqrt(1 - z * z);
                const double phi = 2 * PI * ((i % SECTORS + (k % FINE + 0.5) / FINE) / SECTORS - 0.5);
                double q;
                f_by_hand(&b, to_world(&b.local, vec3_from(s * cos(phi), s * sin(phi), z)), &q);
                expected[i] += q * 4 * PI / CELLS / (FINE * FINE) * DRAWS;
            }
        }
        mark_fit(observed, expected, CELLS, MARK_ALPHA, "rings and sectors about the normal", "The cosine and the lobe, "
                 "which reaches below the horizon, each with its share (errata E34, E35).");
    }
}

static void the_albedo_comes_out_of_the_samples(void)
{
    enum { K = 400 };

    for (int degrees = 0; degrees <= 85; degrees += 17) {
        const bis_material m = bis_phong((rgb){0.3f, 0.3f, 0.3f}, (rgb){0.7f, 0.7f, 0.7f}, 10);
        const bis_bsdf b = seen(&m, degrees);
        stat_moments mean = {0};
        double truth = 0;
        bis_rng r;
        bis_rng_init(&r, mark_seed(5), (uint64_t)degrees, 0, 0);
        for (int i = 0; i < K * K; i++) {
            const double z = (i / K + 0.5) / K, s = sqrt(1 - z * z), phi = 2 * PI * (i % K + 0.5) / K;
            double q;
            truth += (double)f_by_hand(&b, to_world(&b.local, vec3_from(s * cos(phi), s * sin(phi), z)), &q).r * z * 2 * PI / K / K;
        }
        for (int k = 0; k < 30000; k++) {
            vec3 wi;
            double pdf;
            const double u0 = bis_rng_double(&r), u1 = bis_rng_double(&r), u2 = bis_rng_double(&r);
            if (!bis_bsdf_sample(&b, u0, u1, u2, &wi)) mark_wrong("nothing is drawn from a material that reflects");
            const rgb f = bis_bsdf_f_pdf(&b, wi, &pdf);
            const double c = bis_bsdf_cos(&b, wi);
            stat_add(&mean, c > 0 ? (double)f.r * c / pdf : 0);
        }
        char what[64];
        snprintf(what, sizeof what, "albedo seen at %d degrees, n = 10", degrees);
        mark_mean(&mean, truth, MARK_ALPHA, what, in_lobe);
    }
}

static void work(void)
{
    const bis_material m = bis_phong((rgb){0.4f, 0.3f, 0.2f}, (rgb){0.5f, 0.6f, 0.7f}, 50);
    const bis_bsdf b = seen(&m, 40);
    double sum = 0;
    bis_rng r;

    bis_rng_init(&r, mark_seed(6), 0, 0, 0);
    for (int k = 0; k < 500000; k++) {
        vec3 wi = {0, 0, 1};
        double pdf;
        const double u0 = bis_rng_double(&r), u1 = bis_rng_double(&r), u2 = bis_rng_double(&r);
        bis_bsdf_sample(&b, u0, u1, u2, &wi);
        sum += (double)bis_bsdf_f_pdf(&b, wi, &pdf).r + pdf;
    }
    if (sum == 0) mark_wrong("all is black");
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

    return mark_main(argc, argv, claims, sizeof claims / sizeof *claims, work);
}
