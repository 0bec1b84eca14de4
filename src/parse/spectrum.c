/* SPDX-License-Identifier: BSD-2-Clause */
/* spectrum: sums over 41 wavelengths. Sources: CIE 1931 2-degree observer and CIE standard illuminant D65, each every
 * 10 nm (CIE 015:2018); the matrix of IEC 61966-2-1. What is reflected is divided by what white reflects, so that white
 * is exactly (1, 1, 1), whatever the digits of the tables. */
#include "spectrum.h"

#include "bis/base/fresnel.h"

#include <math.h>

enum { FIRST = 380, STEP = 10, N = 41 };

/* x, y, z of the observer, and D65. */
static const double table[N][4] = {
    {0.001368, 3.9e-05, 0.00645, 49.9755},
    {0.004243, 0.00012, 0.02005, 54.6482},
    {0.01431, 0.000396, 0.06785, 82.7549},
    {0.04351, 0.00121, 0.2074, 91.486},
    {0.13438, 0.004, 0.6456, 93.4318},
    {0.2839, 0.0116, 1.3856, 86.6823},
    {0.34828, 0.023, 1.74706, 104.865},
    {0.3362, 0.038, 1.77211, 117.008},
    {0.2908, 0.06, 1.6692, 117.812},
    {0.19536, 0.09098, 1.28764, 114.861},
    {0.09564, 0.13902, 0.81295, 115.923},
    {0.03201, 0.20802, 0.46518, 108.811},
    {0.0049, 0.323, 0.272, 109.354},
    {0.0093, 0.503, 0.1582, 107.802},
    {0.06327, 0.71, 0.07825, 104.79},
    {0.1655, 0.862, 0.04216, 107.689},
    {0.2904, 0.954, 0.0203, 104.405},
    {0.43345, 0.99495, 0.00875, 104.046},
    {0.5945, 0.995, 0.0039, 100},
    {0.7621, 0.952, 0.0021, 96.3342},
    {0.9163, 0.87, 0.00165, 95.788},
    {1.0263, 0.757, 0.0011, 88.6856},
    {1.0622, 0.631, 0.0008, 90.0062},
    {1.0026, 0.503, 0.00034, 89.5991},
    {0.85445, 0.381, 0.00019, 87.6987},
    {0.6424, 0.265, 5e-05, 83.2886},
    {0.4479, 0.175, 2e-05, 83.6992},
    {0.2835, 0.107, 0, 80.0268},
    {0.1649, 0.061, 0, 80.2146},
    {0.0874, 0.032, 0, 82.2778},
    {0.04677, 0.017, 0, 78.2842},
    {0.0227, 0.00821, 0, 69.7213},
    {0.0113592, 0.004102, 0, 71.6091},
    {0.00579035, 0.002091, 0, 74.349},
    {0.00289933, 0.001047, 0, 61.604},
    {0.00143997, 0.00052, 0, 69.8856},
    {0.000690079, 0.0002492, 0, 75.087},
    {0.000332301, 0.00012, 0, 63.5927},
    {0.00016615, 6e-05, 0, 46.4182},
    {8.30753e-05, 3e-05, 0, 66.8054},
    {4.15099e-05, 1.499e-05, 0, 63.3828},
};

static double wavelength(int i) { return FIRST + STEP * i; }

rgbd bis_xyz_to_rgb(double x, double y, double z)
{
    return (rgbd){3.2404542 * x - 1.5371385 * y - 0.4985314 * z, -0.9692660 * x + 1.8760108 * y + 0.0415560 * z,
                  0.0556434 * x - 0.2040259 * y + 1.0572252 * z};
}

/* Of values at the 41 wavelengths; by_d65: times the illuminant. */
static rgbd colour_of(const double value[N], bool by_d65)
{
    double sum[3] = {0, 0, 0};

    for (int i = 0; i < N; i++)
        for (int k = 0; k < 3; k++) sum[k] += value[i] * table[i][k] * (by_d65 ? table[i][3] : 1);
    return bis_xyz_to_rgb(sum[0], sum[1], sum[2]);
}

static rgbd reflected(const double value[N])
{
    double one[N];

    for (int i = 0; i < N; i++) one[i] = 1;
    const rgbd white = colour_of(one, true), c = colour_of(value, true);
    return (rgbd){c.r / white.r, c.g / white.g, c.b / white.b};
}

double bis_spectrum_at(const bis_spectrum *s, double nm)
{
    size_t lo = 0, hi = s->n - 1;

    if (nm <= s->pairs[lo][0]) return s->pairs[lo][1];
    if (nm >= s->pairs[hi][0]) return s->pairs[hi][1];
    while (hi - lo > 1) {
        const size_t middle = lo + (hi - lo) / 2;
        if (s->pairs[middle][0] <= nm) lo = middle;
        else hi = middle;
    }
    const double w = (nm - s->pairs[lo][0]) / (s->pairs[hi][0] - s->pairs[lo][0]);
    return (1 - w) * s->pairs[lo][1] + w * s->pairs[hi][1];
}

rgbd bis_spectrum_reflected(const bis_spectrum *s)
{
    double value[N];

    for (int i = 0; i < N; i++) value[i] = bis_spectrum_at(s, wavelength(i));
    return reflected(value);
}

void bis_spectrum_conductor(rgbd *head_on, rgbd *mean, const bis_spectrum *eta, const bis_spectrum *k)
{
    double along[N], all[N];

    for (int i = 0; i < N; i++) {
        const double n = bis_spectrum_at(eta, wavelength(i)), a = bis_spectrum_at(k, wavelength(i));
        along[i] = ((n - 1) * (n - 1) + a * a) / ((n + 1) * (n + 1) + a * a);
        all[i] = bis_fresnel_mean(n, a * a);
    }
    *head_on = reflected(along);
    *mean = reflected(all);
}

/* What light of these values looks like: of 1 at all wavelengths it has luminance 1. */
static rgbd emitted(const double value[N])
{
    double sum = 0;

    for (int i = 0; i < N; i++) sum += table[i][1];
    return rgbd_scale(colour_of(value, false), 1 / sum);
}

rgbd bis_spectrum_emitted(const bis_spectrum *s, bool ends)
{
    double value[N];

    for (int i = 0; i < N; i++) {
        const double nm = wavelength(i);
        const bool is_outside = ends && (nm < s->pairs[0][0] || nm > s->pairs[s->n - 1][0]);
        value[i] = is_outside ? 0 : bis_spectrum_at(s, nm);
    }
    return emitted(value);
}

/* Planck's law at the 41 wavelengths, over its value at `nm`. */
static void planck(double value[N], double kelvin, double nm)
{
    const double c2 = 14387768.775; /* h c / k_B in nm K */

    for (int i = 0; i < N; i++)
        value[i] = pow(nm / wavelength(i), 5) * expm1(c2 / (nm * kelvin)) / expm1(c2 / (wavelength(i) * kelvin));
}

rgbd bis_spectrum_blackbody(double kelvin)
{
    double value[N];

    planck(value, kelvin, 560); /* below 500 K nothing of the values themselves would be left in a double */
    const rgbd c = colour_of(value, false);
    return rgbd_scale(c, 1 / (0.2126 * c.r + 0.7152 * c.g + 0.0722 * c.b));
}

rgbd bis_spectrum_blackbody_peak(double kelvin)
{
    double value[N];

    planck(value, kelvin, 2897771.955 / kelvin);
    return emitted(value);
}
