/* SPDX-License-Identifier: BSD-2-Clause */
/* spectrum: every entry of its tables against the published ones (CIE 018:2019, the observer in its seven digits; CIE
 * standard illuminant D65), through a matrix worked out from the chromaticities of IEC 61966-2-1. */
#include "bis/base/fresnel.h"
#include "parse/spectrum.h"
#include "claim.h"

#include <math.h>

enum { N = 41 };

/* 380, 390, ..., 780 nm. */
static const double observer[N][3] = {
    {0.001368, 0.000039, 0.006450001}, {0.004243, 0.00012, 0.02005001}, {0.01431, 0.000396, 0.06785001},
    {0.04351, 0.00121, 0.2074},
    {0.13438, 0.004, 0.6456}, {0.2839, 0.0116, 1.3856}, {0.34828, 0.023, 1.74706}, {0.3362, 0.038, 1.77211},
    {0.2908, 0.06, 1.6692}, {0.19536, 0.09098, 1.28764}, {0.09564, 0.13902, 0.8129501}, {0.03201, 0.20802, 0.46518},
    {0.0049, 0.323, 0.272}, {0.0093, 0.503, 0.1582}, {0.06327, 0.71, 0.07824999}, {0.1655, 0.862, 0.04216},
    {0.2904, 0.954, 0.0203}, {0.4334499, 0.9949501, 0.008749999}, {0.5945, 0.995, 0.0039}, {0.7621, 0.952, 0.0021},
    {0.9163, 0.87, 0.001650001}, {1.0263, 0.757, 0.0011}, {1.0622, 0.631, 0.0008}, {1.0026, 0.503, 0.00034},
    {0.8544499, 0.381, 0.00019}, {0.6424, 0.265, 0.0000499999}, {0.4479, 0.175, 0.00002}, {0.2835, 0.107, 0},
    {0.1649, 0.061, 0}, {0.0874, 0.032, 0}, {0.04677, 0.017, 0}, {0.0227, 0.00821, 0},
    {0.01135916, 0.004102, 0}, {0.005790346, 0.002091, 0}, {0.002899327, 0.001047, 0}, {0.001439971, 0.00052, 0},
    {0.0006900786, 0.0002492, 0}, {0.0003323011, 0.00012, 0}, {0.0001661505, 0.00006, 0}, {0.00008307527, 0.00003, 0},
    {0.00004150994, 0.00001499, 0}};
static const double d65[N] = {49.9755, 54.6482, 82.7549, 91.486, 93.4318, 86.6823, 104.865, 117.008, 117.812, 114.861,
    115.923, 108.811, 109.354, 107.802, 104.79, 107.689, 104.405, 104.046, 100, 96.3342, 95.788, 88.6856, 90.0062,
    89.5991, 87.6987, 83.2886, 83.6992, 80.0268, 80.2146, 82.2778, 78.2842, 69.7213, 71.6091, 74.349, 61.604, 69.8856,
    75.087, 63.5927, 46.4182, 66.8054, 63.3828};

/* XYZ of the three primaries: each has its chromaticity, and together they are the white (0.95047, 1, 1.08883).
 * Cramer's rule for the three weights. */
static double det(const double a[3], const double b[3], const double c[3])
{
    return a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
}

static void to_xyz(double xyz[3], rgbd c)
{
    static const double r[3] = {0.64, 0.33, 0.03}, g[3] = {0.30, 0.60, 0.10}, b[3] = {0.15, 0.06, 0.79},
                        white[3] = {0.95047, 1, 1.08883};
    const double all = det(r, g, b), s[3] = {det(white, g, b) / all, det(r, white, b) / all, det(r, g, white) / all};
    for (int k = 0; k < 3; k++) xyz[k] = s[0] * r[k] * c.r + s[1] * g[k] * c.g + s[2] * b[k] * c.b;
}

static void assert_xyz(const double found[3], const double expected[3], double relative, int what)
{
    const double size = fmax(fabs(expected[0]), fmax(fabs(expected[1]), fabs(expected[2])));
    for (int k = 0; k < 3; k++)
        if (!(fabs(found[k] - expected[k]) <= relative * size))
            fail_msg("%d: %c is %.9g, must be %.9g", what, "XYZ"[k], found[k], expected[k]);
}

static void xyz_becomes_rgb_by_the_primaries(void **state)
{
    for (int k = 0; k < 3; k++) {
        double one[3] = {0}, back[3];
        one[k] = 1;
        to_xyz(back, bis_xyz_to_rgb(one[0], one[1], one[2]));
        assert_xyz(back, one, 5e-7, k); /* its nine numbers have seven digits */
    }
}

/* A surface that reflects one wavelength alone shows one row of the tables; white is their sum. The tables differ in
 * the seventh digit of the observer, at most 1e-8, and the rows' largest numbers are above 4e-5. */
static void each_wavelength_has_the_published_weight(void **state)
{
    double white[3] = {0};
    for (int i = 0; i < N; i++)
        for (int k = 0; k < 3; k++) white[k] += observer[i][k] * d65[i];
    const rgbd w = bis_xyz_to_rgb(white[0], white[1], white[2]);
    for (int i = 0; i < N; i++) {
        const double nm = 380 + 10 * i, hat[3][2] = {{nm - 10, 0}, {nm, 1}, {nm + 10, 0}};
        const rgbd c = bis_spectrum_reflected(&(bis_spectrum){hat, 3});
        double found[3], expected[3];
        to_xyz(found, (rgbd){c.r * w.r, c.g * w.g, c.b * w.b});
        for (int k = 0; k < 3; k++) expected[k] = observer[i][k] * d65[i];
        assert_xyz(found, expected, 4e-6, (int)nm);
    }
}

/* Planck's law in SI units, 2 h c^2 / (l^5 (exp(h c / (l k T)) - 1)), summed with the published observer. */
static void a_black_body_has_plancks_colour(void **state)
{
    const double h = 6.62607015e-34, c = 299792458, k_B = 1.380649e-23,
                 kelvins[] = {1000, 1500, 2856, 6504, 20000, 1e6};
    for (size_t j = 0; j < sizeof kelvins / sizeof *kelvins; j++) {
        double sum[3] = {0}, found[3];
        for (int i = 0; i < N; i++) {
            const double l = (380 + 10 * i) * 1e-9,
                         B = 2 * h * c * c / (pow(l, 5) * (exp(h * c / (l * k_B * kelvins[j])) - 1));
            for (int k = 0; k < 3; k++) sum[k] += B * observer[i][k];
        }
        const rgbd body = bis_spectrum_blackbody(kelvins[j]);
        to_xyz(found, body);
        const double chromaticity[3] = {sum[0] / sum[1], 1, sum[2] / sum[1]},
                     of_found[3] = {found[0] / found[1], 1, found[2] / found[1]};
        assert_xyz(of_found, chromaticity, 4e-6, (int)kelvins[j]);
        assert_true(fabs(0.2126 * body.r + 0.7152 * body.g + 0.0722 * body.b - 1) < 1e-12);
    }
}

/* Five pairs at uneven places: every interval, both ends, every pair itself, and one pair alone. */
static void a_spectrum_is_linear_in_every_interval(void **state)
{
    static const double pairs[5][2] = {{400, 1}, {410, 3}, {450, 7}, {451, 5}, {700, 0}};
    static const struct { double nm, value; } cases[] = {
        {0, 1}, {399, 1}, {400, 1}, {405, 2}, {407.5, 2.5}, {410, 3}, {420, 4}, {440, 6}, {450, 7}, {450.5, 6},
        {451, 5},
        {500.8, 4}, {650.2, 1}, {700, 0}, {701, 0}};
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++)
        assert_true(fabs(bis_spectrum_at(&(bis_spectrum){pairs, 5}, cases[n].nm) - cases[n].value) < 1e-9);
    for (double nm = 300; nm < 900; nm += 100) assert_true(bis_spectrum_at(&(bis_spectrum){pairs + 2, 1}, nm) == 7);
}

static rgbd head_on(const bis_spectrum *eta, const bis_spectrum *k)
{
    rgbd straight, mean;
    bis_spectrum_conductor(&straight, &mean, eta, k);
    return straight;
}

/* Constant eta and k: any colour is grey, of Fresnel's value: eta 2, k 3: (1 + 9) / (9 + 9). Two wavelengths of another
 * metal each: a sum of two rows. */
static void a_conductor_reflects_fresnels_share_at_each_wavelength(void **state)
{
    const double two[1][2] = {{500, 2}}, three[1][2] = {{500, 3}}, one[1][2] = {{500, 1}}, none[1][2] = {{500, 0}};
    const rgbd grey = head_on(&(bis_spectrum){two, 1}, &(bis_spectrum){three, 1});
    assert_true(
        fabs(grey.r - 10.0 / 18) < 1e-12 && fabs(grey.g - 10.0 / 18) < 1e-12 && fabs(grey.b - 10.0 / 18) < 1e-12);
    rgbd straight, mean; /* the mean over all directions is that of fresnel.h */
    bis_spectrum_conductor(&straight, &mean, &(bis_spectrum){two, 1}, &(bis_spectrum){three, 1});
    const double all = bis_fresnel_mean(2, 9);
    assert_true(fabs(mean.r - all) < 1e-12 && fabs(mean.g - all) < 1e-12 && fabs(mean.b - all) < 1e-12);
    assert_true(straight.r == grey.r && straight.g == grey.g && straight.b == grey.b);
    const rgbd air = head_on(&(bis_spectrum){one, 1}, &(bis_spectrum){none, 1});
    assert_true(air.r == 0 && air.g == 0 && air.b == 0);
    /* eta 1; k 2 at 600 nm alone reflects a half there: 4 / (4 + 4) */
    const double peak[3][2] = {{590, 0}, {600, 2}, {610, 0}}, half[3][2] = {{590, 0}, {600, 0.5}, {610, 0}};
    const rgbd a = head_on(&(bis_spectrum){one, 1}, &(bis_spectrum){peak, 3});
    const rgbd b = bis_spectrum_reflected(&(bis_spectrum){half, 3});
    assert_true(fabs(a.r - b.r) < 1e-12 && fabs(a.g - b.g) < 1e-12 && fabs(a.b - b.b) < 1e-12);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(xyz_becomes_rgb_by_the_primaries),
        cmocka_unit_test(each_wavelength_has_the_published_weight),
        cmocka_unit_test(a_black_body_has_plancks_colour),
        cmocka_unit_test(a_spectrum_is_linear_in_every_interval),
        cmocka_unit_test(a_conductor_reflects_fresnels_share_at_each_wavelength),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
