/* SPDX-License-Identifier: BSD-2-Clause */
/* fresnel: Fresnel's equations without differences of equals.
 *
 * (a + i b)^2 = (eta + i k)^2 - sin^2 theta. The larger of a and b is the root of a sum; the other is eta k over it.
 *
 *     r_s = (c - a - i b)/(c + a + i b),   r_p/r_s = (a c - sin^2 theta + i b c)/(a c + sin^2 theta + i b c) */
#include "bis/base/fresnel.h"

#include <math.h>

double bis_fresnel(double eta, double k2, double c)
{
    const double s2 = fmax(0, 1 - c * c); /* of float vectors c may be 1 + 2^-23 */
    const double real = eta * eta - k2 - s2, half = eta * eta * k2; /* half of the imaginary part, squared */
    const double more = (sqrt(real * real + 4 * half) + fabs(real)) / 2, less = more > 0 ? half / more : 0;
    const double a = sqrt(real >= 0 ? more : less), b2 = real >= 0 ? less : more;
    const double R_s = ((c - a) * (c - a) + b2) / ((c + a) * (c + a) + b2);
    const double of_p = (a * c + s2) * (a * c + s2) + b2 * c * c; /* 0: head on, where both are alike */
    const double p_over_s = of_p > 0 ? ((a * c - s2) * (a * c - s2) + b2 * c * c) / of_p : 1;

    return R_s * (1 + p_over_s) / 2;
}

double bis_fresnel_mean(double eta, double k2)
{
    enum { N = 256 };
    double sum = 0;

    for (int i = 0; i < N; i++) {
        const double c = (i + 0.5) / N;
        sum += 2 * c * bis_fresnel(eta, k2, c) / N;
    }
    return sum;
}

double bis_fresnel_k2(double R, double eta)
{
    return fmax(0, (R * (eta + 1) * (eta + 1) - (eta - 1) * (eta - 1)) / (1 - R));
}

/* Of all that reflect R head on, those with a smaller eta reflect more on average. The ends are the two dielectrics. */
double bis_fresnel_eta(double R, double mean)
{
    double lo = (1 - sqrt(R)) / (1 + sqrt(R)), hi = 1 / lo;

    for (int i = 0; i < 48; i++) {
        const double middle = (lo + hi) / 2;
        if (bis_fresnel_mean(middle, bis_fresnel_k2(R, middle)) > mean) lo = middle;
        else hi = middle;
    }
    return (lo + hi) / 2;
}
