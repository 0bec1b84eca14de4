/* SPDX-License-Identifier: BSD-2-Clause */
/* envelope, exponents and lobes: the Phong lobe (thesis 3.5), the cosine lobe, their mixture and bounds, from n = 0 to
 * 1e8, at grazing views, with the first and the last random numbers. The other road: long double formulas of the angle,
 * where the library has vectors of float. */
#include "claim.h"
#include "envelope.h"
#include "mesh_help.h"

#include "bis/thesis/bsdf.h"
#include "bis/thesis/phong.h"
#include "bis/thesis/warp.h"

#define COUNT(a) ((int)(sizeof(a) / sizeof *(a)))

static const double exponents[] = {0, 1e-12, 0.1, 0.5, 1, 2.5, 10, 50, 1e3, 12345.678, 1e5, 1e6, 1e7, 1e8};
static const double few[] = {0, 0x1p-53, 0.25, 0.5, 1 - 0x1p-24, 1 - 0x1p-53};
static const double numbers[] = {0, 0x1p-53, 0x1p-24, 1e-3, 0.25, 0.5, 0.75, 0.999, 1 - 0x1p-24, 1 - 0x1p-53};

/* | |w| - 1 |. */
static double length_error(vec3 w) { return fabs(length(w) - 1); }

/* ---- one lobe ---- */

static void directions_of_the_lobe_are_unit_and_at_their_angle(void **state)
{
    envelope unit = envelope_row("lobe of eq. 3.16, n = 0 to 1e8 and fractional; u from 0 to 1 - 2^-53",
                                 "length of the direction - 1", 1.2e-7);
    envelope side = envelope_row("the same", "directions below the lobe's equator, or not finite", 0);
    envelope angle = envelope_row("the same", "relative error of sin^2, against long double", 3e-7);

    for (int i = 0; i < COUNT(exponents); i++) {
        for (int j = 0; j < COUNT(numbers) * COUNT(numbers); j++) {
            const double n = exponents[i], u1 = numbers[j / COUNT(numbers)], u2 = numbers[j % COUNT(numbers)];
            double pdf;
            vec3 w;
            bis_phong_lobe_sample(&w, &pdf, n, u1, u2);
            const long double sin2 = -expm1l(2 / ((long double)n + 1) * log1pl(-(long double)u1));
            const double x = (double)w.x, y = (double)w.y;
            envelope_try(&unit, length_error(w), "n %g u %.17g %.17g", n, u1, u2);
            envelope_expect(&side, vec3_is_finite(w) && w.z >= 0 && isfinite(pdf) && pdf > 0, "n %g u %.17g %.17g", n,
                            u1, u2);
            envelope_try(&angle, relative_error(x * x + y * y, (double)sin2), "n %g u %.17g %.17g", n, u1, u2);
        }
    }
    envelope_close(&unit);
    envelope_close(&side);
    envelope_close(&angle);
}

static void density_of_the_lobe_is_good_from_the_angle_and_limited_by_float_directions(void **state)
{
    envelope own =
        envelope_row("density of eq. 3.15 with the sample, n = 0 to 1e8", "relative error against long double", 3e-14);
    envelope direction =
        envelope_row("density of a float direction, n = 0 to 1e8, down to a cosine of 1e-6",
                     "relative error over 1 + n tan alpha: what moving the direction by that angle does", 1.5e-7);

    for (int i = 0; i < COUNT(exponents); i++) {
        for (int j = 0; j < 2000; j++) {
            const double n = exponents[i], u1 = j < COUNT(numbers) ? numbers[j] : (j + 0.5) / 2000,
                         u2 = fmod(j * 0.618, 1);
            double pdf;
            vec3 w;
            bis_phong_lobe_sample(&w, &pdf, n, u1, u2);
            const long double log_cos = log1pl(-(long double)u1) / ((long double)n + 1);
            const double truth = (double)(((long double)n + 1) / (2 * acosl(-1)) * expl((long double)n * log_cos));
            envelope_try(&own, relative_error(pdf, truth), "n %g u %.17g", n, u1);

            const double cos_alpha = (double)expl(log_cos), tan_alpha = sqrt(-expm1(2 * (double)log_cos)) / cos_alpha;
            if (cos_alpha < 1e-6) continue;
            const double found = bis_phong_lobe_pdf((vec3){0, 0, 1}, w, n);
            envelope_try(&direction, relative_error(found, truth) / (1 + n * tan_alpha), "n %g u %.17g", n, u1);
        }
    }
    envelope_close(&own);
    envelope_close(&direction);
}

/* cos = 1 - |a-b|^2/2 of the very floats. */
static void the_power_is_exact_for_the_floats_it_gets(void **state)
{
    envelope e = envelope_row("max(0, cos)^n of two float directions, n = 0 to 1e8, any angle",
                              "relative error against long double, over 1 + n (1 - cos)/cos", 1e-15);
    envelope dark = envelope_row("the same beyond 90 degrees", "values other than 0", 0);
    uint64_t seed = 1;

    for (int i = 0; i < COUNT(exponents); i++) {
        for (int j = 0; j < 3000; j++) {
            const vec3 a = random_direction(&seed);
            const double spread = pow(10, random_between(&seed, -9, 0.5));
            const vec3 b = normalize(add(a, mul(random_direction(&seed), spread)));
            const long double x = (long double)a.x - (long double)b.x, y = (long double)a.y - (long double)b.y,
                              z = (long double)a.z - (long double)b.z;
            const long double one_minus_cos = (x * x + y * y + z * z) / 2, n = (long double)exponents[i];
            const double found = bis_phong_power(a, b, exponents[i]);
            if (one_minus_cos >= 1) {
                envelope_expect(&dark, found == 0, "n %g 1 - cos %Lg", exponents[i], one_minus_cos);
                continue;
            }
            const long double log_power = n * log1pl(-one_minus_cos),
                              steepness = n * one_minus_cos / (1 - one_minus_cos);
            if (log_power < -700) continue; /* cut to 0 at -708 */
            envelope_try(&e, relative_error(found, (double)expl(log_power)) / (1 + (double)steepness),
                         "n %g 1 - cos %Lg", exponents[i], one_minus_cos);
        }
    }
    envelope_close(&e);
    envelope_close(&dark);
}

/* Both means over evenly spread numbers; the closed form. */
static void mean_of_the_lobe_is_its_closed_form(void **state)
{
    enum { N = 1 << 16 };
    envelope e =
        envelope_row("mean of 1 - cos over 65536 even numbers, n = 0 to 1e8", "relative error against 1/(n+2)", 1e-4);

    for (int i = 0; i < COUNT(exponents); i++) {
        double sum = 0, pdf;
        for (int j = 0; j < N; j++) {
            vec3 w;
            bis_phong_lobe_sample(&w, &pdf, exponents[i], (j + 0.5) / N, fmod(j * 0.618, 1));
            const double sin2 = (double)w.x * (double)w.x + (double)w.y * (double)w.y;
            sum += sin2 / (1 + sqrt(fmax(0, 1 - sin2)));
        }
        envelope_try(&e, relative_error(sum / N, 1 / (exponents[i] + 2)), "n %g", exponents[i]);
    }
    envelope_close(&e);
}

static void warps_survive_the_ends_of_the_unit_interval(void **state)
{
    envelope unit =
        envelope_row("uniform sphere and cosine lobe, u from 0 to 1 - 2^-53", "length of the direction - 1", 1.2e-7);
    envelope z = envelope_row("cosine lobe, the same", "relative error of z against long double", 1.2e-7);

    for (int j = 0; j < COUNT(numbers) * COUNT(numbers); j++) {
        const double u1 = numbers[j / COUNT(numbers)], u2 = numbers[j % COUNT(numbers)];
        const vec3 s = bis_warp_sphere(u1, u2), c = bis_warp_cosine(u1, u2);
        envelope_try(&unit, length_error(s), "sphere %.17g %.17g", u1, u2);
        envelope_try(&unit, length_error(c), "cosine %.17g %.17g", u1, u2);
        envelope_try(&z, relative_error((double)c.z, (double)sqrtl(1 - (long double)u1)), "%.17g %.17g", u1, u2);
    }
    envelope_close(&unit);
    envelope_close(&z);
}

/* ---- the mixture at grazing views ---- */

/* A view so many degrees from the normal, exact to float; the turned normal is rounded, and so is what it means to be
 * grazing. */
static vec3 view(vec3 n, double degrees)
{
    const frame f = frame_about(n);
    const double t = degrees * PI / 180;
    return to_world(&f, vec3_from(sin(t) * 0.6, sin(t) * 0.8, cos(t)));
}

static const double degrees[] = {0, 60, 85, 89, 89.9, 89.99, 89.999, 89.99999};

static void mixture_and_its_bounds_hold_for_any_material_view_and_number(void **state)
{
    static const double reflectances[][2] = {{1, 0},     {0, 1},         {0.5, 0.5}, {1e-45, 1}, {1, 1e-45}, {1e-45, 0},
                                             {0, 1e-45}, {1e-38, 1e-38}, {0, 1e-20}, {1e-20, 1}, {0, 0}};
    const vec3 normals[] = {
        {0, 0, 1}, {0, 0, -1}, {1, 0, 0}, normalize((vec3){1, -2, 0.5f}), normalize((vec3){-1e-4f, 1e-4f, -1})};
    envelope finite = envelope_row("mixture of lobes: reflectances 0, 1e-45 to 1; n = 0 to 1e8; views at 0 to 89.99999 "
                                   "degrees; any u",
                                   "f, density, direction not finite or negative; f > 0 at density 0", 0);
    envelope unit = envelope_row("the same", "length of the direction - 1", 1e-6);
    envelope ratio = envelope_row("the same", "f cos / density over its bound - 1 (E27)", 0);
    envelope product = envelope_row("the same", "f cos over its bound - 1 (E27)", 0);

    for (int i = 0; i < COUNT(reflectances) * COUNT(normals) * COUNT(degrees) * COUNT(exponents); i++) {
        const double *k = reflectances[i % COUNT(reflectances)];
        const vec3 n = normals[i / COUNT(reflectances) % COUNT(normals)];
        const double angle = degrees[i / COUNT(reflectances) / COUNT(normals) % COUNT(degrees)];
        const double exponent = exponents[i / COUNT(reflectances) / COUNT(normals) / COUNT(degrees)];
        const bis_material m = bis_phong(rgb_from(k[0], k[0], k[0]), rgb_from(k[1], k[1], k[1]), exponent);
        bis_bsdf b;
        bis_bsdf_init(&b, &m, n, view(n, angle));
        for (int j = 0; j < 216; j++) {
            const double u[3] = {few[j % 6], few[j / 6 % 6], few[j / 36]};
            double q;
            vec3 wi;
            if (!bis_bsdf_sample(&b, u[0], u[1], u[2], &wi)) break;
            const rgb f = bis_bsdf_f_pdf(&b, wi, &q);
            const double fcos = (double)f.g * fmax(0, bis_bsdf_cos(&b, wi));
            envelope_expect(&finite,
                            isfinite(q) && q >= 0 && rgb_is_finite(f) && f.g >= 0 && vec3_is_finite(wi) &&
                                (q > 0 || f.g == 0),
                            "k %g %g n %g view %g u %.17g %.17g %.17g", k[0], k[1], exponent, angle, u[0], u[1], u[2]);
            envelope_try(&unit, length_error(wi), "k %g %g n %g view %g", k[0], k[1], exponent, angle);
            if (q > 0)
                envelope_try(&ratio, fmax(0, fcos / q / bis_bsdf_max_ratio(&b) - 1), "k %g %g n %g view %g", k[0], k[1],
                             exponent, angle);
            if (fcos > 0)
                envelope_try(&product, fmax(0, fcos / bis_bsdf_max_f_cos(&b) - 1), "k %g %g n %g view %g", k[0], k[1],
                             exponent, angle);
        }
    }
    envelope_close(&finite);
    envelope_close(&unit);
    envelope_close(&ratio);
    envelope_close(&product);
}

/* Mean over phi of max(0, cos theta_i) where cos theta_i = A + B cos phi. */
static long double mean_cosine(long double A, long double B)
{
    if (A >= B) return A;
    if (A <= -B) return 0;
    const long double phi = acosl(-A / B);
    return (A * phi + B * sinl(phi)) / acosl(-1);
}

/* The albedo of a pure lobe: the mean of max(0, cos theta_i) over eq. 3.16, by the midpoint rule in u, where cos alpha
 * = u^(1/(n+1)). */
static double albedo(double n, double angle)
{
    enum { STEPS = 20000 };
    const long double t = (long double)angle * acosl(-1) / 180;
    long double sum = 0;

    for (int i = 0; i < STEPS; i++) {
        const long double log_cos = logl((i + 0.5L) / STEPS) / ((long double)n + 1);
        sum += mean_cosine(cosl(t) * expl(log_cos), sinl(t) * sqrtl(-expm1l(2 * log_cos)));
    }
    return (double)(sum / STEPS);
}

static void white_furnace_is_right_at_grazing_views(void **state)
{
    enum { SIDE = 128 };
    const vec3 normals[] = {{0, 0, 1}, normalize((vec3){1, -2, 0.5f})};
    envelope e[] = {envelope_row("white furnace, n = 0 to 1e8, views at 0 to 89.99 degrees",
                                 "relative error of the albedo against quadrature", 2e-3),
                    envelope_row("the same at 89.999 and 89.99999 degrees", "the same", 2e-3)};
    envelope turned =
        envelope_row("the same, 0 to 89.99999 degrees, about a normal that is no axis (floats hold it to 6e-8)",
                     "absolute error of the albedo", 1e-3);

    for (int i = 0; i < COUNT(exponents) * COUNT(degrees) * 2; i++) {
        const double n = exponents[i / 2 / COUNT(degrees)], angle = degrees[i / 2 % COUNT(degrees)];
        const vec3 normal = normals[i % 2];
        const bis_material m = bis_phong((rgb){0, 0, 0}, (rgb){1, 1, 1}, n);
        double sum = 0;
        bis_bsdf b;
        bis_bsdf_init(&b, &m, normal, view(normal, angle));
        for (int j = 0; j < SIDE * SIDE; j++) {
            double q;
            vec3 wi;
            assert_true(bis_bsdf_sample(&b, 0.5, (j % SIDE + 0.5) / SIDE, (j / SIDE + 0.5) / SIDE, &wi));
            const rgb f = bis_bsdf_f_pdf(&b, wi, &q);
            if (q > 0) sum += (double)f.g * fmax(0, bis_bsdf_cos(&b, wi)) / q;
        }
        const double truth = albedo(n, angle), found = sum / SIDE / SIDE;
        if (i % 2) {
            envelope_try(&turned, fabs(found - truth), "n %g view %g: %g, truth %g", n, angle, found, truth);
        } else {
            envelope_try(&e[angle > 89.99], relative_error(found, truth), "n %g view %g: %g, truth %g", n, angle, found,
                         truth);
        }
    }
    envelope_close(&e[0]);
    envelope_close(&e[1]);
    envelope_close(&turned);
}

static void page_has_the_same_rows(void **state)
{
    envelope_finish(1, "Exponents and lobes");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(directions_of_the_lobe_are_unit_and_at_their_angle),
        cmocka_unit_test(density_of_the_lobe_is_good_from_the_angle_and_limited_by_float_directions),
        cmocka_unit_test(the_power_is_exact_for_the_floats_it_gets),
        cmocka_unit_test(mean_of_the_lobe_is_its_closed_form),
        cmocka_unit_test(warps_survive_the_ends_of_the_unit_interval),
        cmocka_unit_test(mixture_and_its_bounds_hold_for_any_material_view_and_number),
        cmocka_unit_test(white_furnace_is_right_at_grazing_views),
        cmocka_unit_test(page_has_the_same_rows),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
