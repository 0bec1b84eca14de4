/* Assignment phong: src/thesis/phong.c, the lobe's direction, f with its density, and the choice of a lobe. Closed forms, and quadrature over
 * the sphere. Statistical tests: 12, at 1e-4 each. */
#include "mark.h"

#include "bis/thesis/phong.h"
#include "bis/thesis/rng.h"

#include <stdio.h>

static const double ALPHA = 1e-4;
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

    bis_rng_init(&r, 1, 0, 0, 0);
    for (int k = 0; k < DRAWS; k++) {
        vec3 wi;
        double pdf;
        bis_phong_lobe_sample(&wi, &pdf, 5, bis_rng_double(&r), bis_rng_double(&r));
        const int i = (int)((atan2((double)wi.y, (double)wi.x) / (2 * PI) + 0.5) * CELLS);
        observed[i < CELLS ? i : CELLS - 1]++;
    }
    for (int i = 0; i < CELLS; i++) expected[i] = DRAWS / (double)CELLS;
    mark_fit(observed, expected, CELLS, ALPHA, "sixteen sectors about the lobe's axis", "phi = 2 pi u2.");
}

static void narrow_lobes_keep_their_precision(void)
{
    const double n = 1e6;
    stat_moments m = {0};
    bis_rng r;

    bis_rng_init(&r, 2, 0, 0, 0);
    for (int k = 0; k < 20000; k++) {
        vec3 wi;
        double pdf;
        bis_phong_lobe_sample(&wi, &pdf, n, bis_rng_double(&r), bis_rng_double(&r));
        stat_add(&m, (double)wi.x * (double)wi.x + (double)wi.y * (double)wi.y); /* sin^2: not through a cosine near 1 */
    }
    mark_mean(&m, 2 / (n + 3), ALPHA, "n = 1e6: sin^2 theta", "1 - cos^2 of a float cancels near the axis. expm1 "
              "and log1p do not.");
}

static rgb f_by_hand(const bis_bsdf *b, vec3 wi)
{
    const bis_material *m = b->material;
    const vec3 n = b->local.z;
    const double c_i = dot(n, wi), c_o = dot(n, b->wo), a = 2 * c_i * c_o - dot(wi, b->wo);
    const double lobe = a > 0 ? (m->exponent + 1) / (2 * PI) * pow(a, m->exponent) : 0;

    if (c_i <= 0 || c_o <= 0) return (rgb){0, 0, 0};
    return rgb_add(rgb_scale(m->Ks, lobe), rgb_scale(m->Kd, 1 / PI));
}

static void f_is_eq_3_14(void)
{
    const bis_material m = bis_phong((rgb){0.1f, 0.3f, 0.2f}, (rgb){0.6f, 0.5f, 0.4f}, 12);
    bis_rng r;

    bis_rng_init(&r, 3, 0, 0, 0);
    for (int k = 0; k < 300; k++) {
        const bis_bsdf b = seen(&m, k % 89);
        const double z = 2 * bis_rng_double(&r) - 1, phi = 2 * PI * bis_rng_double(&r), s = sqrt(1 - z * z);
        const vec3 wi = vec3_from(s * cos(phi), s * sin(phi), z);
        const rgb f = bis_bsdf_f(&b, wi), must = f_by_hand(&b, wi);
        const double got[] = {(double)f.r, (double)f.g, (double)f.b}, hand[] = {(double)must.r, (double)must.g, (double)must.b};
        for (int i = 0; i < 3; i++) {
            mark_near(got[i], hand[i], 1e-6, 1e-5, "seen at %d degrees, light at %.0f degrees from the normal: "
                      "channel %d of f", k % 89, acos(fmax(-1, fmin(1, bis_bsdf_cos(&b, wi)))) * 180 / PI, i);
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

static void the_density_integrates_to_1(void)
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
}

/* The cells: 8 rings of equal solid angle about the normal x 8 sectors. */
static void samples_have_the_density(void)
{
    enum { RINGS = 8, SECTORS = 8, CELLS = RINGS * SECTORS, FINE = 48, DRAWS = 60000 };
    const double angles[] = {20, 60, 80};

    for (int a = 0; a < 3; a++) {
        const bis_material m = bis_phong((rgb){0.4f, 0.3f, 0.2f}, (rgb){0.5f, 0.6f, 0.7f}, 6);
        const bis_bsdf b = seen(&m, angles[a]);
        double observed[CELLS] = {0}, expected[CELLS] = {0};
        bis_rng r;
        bis_rng_init(&r, 4, (uint64_t)a, 0, 0);
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
                expected[i] += bis_bsdf_pdf(&b, to_world(&b.local, vec3_from(s * cos(phi), s * sin(phi), z))) * 4 * PI / CELLS / (FINE * FINE) * DRAWS;
            }
        }
        mark_fit(observed, expected, CELLS, ALPHA, "rings and sectors about the normal", "Is the density that of "
                 "the mixture, whichever lobe a direction came from (errata E35)?");
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
        bis_rng_init(&r, 5, (uint64_t)degrees, 0, 0);
        for (int i = 0; i < K * K; i++) {
            const double z = (i / K + 0.5) / K, s = sqrt(1 - z * z), phi = 2 * PI * (i % K + 0.5) / K;
            truth += (double)f_by_hand(&b, to_world(&b.local, vec3_from(s * cos(phi), s * sin(phi), z))).r * z * 2 * PI / K / K;
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
        mark_mean(&mean, truth, ALPHA, what, in_lobe);
    }
}

static void work(void)
{
    const bis_material m = bis_phong((rgb){0.4f, 0.3f, 0.2f}, (rgb){0.5f, 0.6f, 0.7f}, 50);
    const bis_bsdf b = seen(&m, 40);
    double sum = 0;
    bis_rng r;

    bis_rng_init(&r, 6, 0, 0, 0);
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
        {"the_density_integrates_to_1", 10, the_density_integrates_to_1},
        {"samples_have_the_density", 20, samples_have_the_density},
        {"the_albedo_comes_out_of_the_samples", 10, the_albedo_comes_out_of_the_samples},
    };

    return mark_main(argc, argv, claims, sizeof claims / sizeof *claims, work);
}
