/* SPDX-License-Identifier: BSD-2-Clause */
/* facets: see facets.h. */
#include "facets.h"

#include <math.h>

static double smith(double a, double c)
{
    return (sqrt(1 + a * a * (1 - c * c) / (c * c)) - 1) / 2;
}

/* A facet h at the quantile v = tan^2/(a^2 + tan^2), where D cos theta_h is uniform over (v, phi). The eye sees it with
 * density G1 (wo h)+/(cos theta_o cos theta_h) dv dphi/2 pi, and (wo h)/cos theta_h = cos theta_o + sin theta_o tan
 * theta_h cos(phi - phi_o). */
void facets_expect(double expected[FACETS_CELLS], double a, double degrees, double count)
{
    enum { K = 64 };
    const double c = cos(degrees * PI / 180), s = sin(degrees * PI / 180), G1 = 1 / (1 + smith(a, c)),
                 phi_o = atan2(0.8, 0.6);

    for (int i = 0; i < FACETS_CELLS; i++) {
        const int ring = i / FACETS_SECTORS, sector = i % FACETS_SECTORS;
        double sum = 0;
        for (int k = 0; k < K * K; k++) {
            /* w^2 = 1 - v evens out the pole of tan at v = 1: dv = 2 w dw */
            const double w0 = sqrt(1 - (double)ring / FACETS_RINGS), w1 = sqrt(1 - (double)(ring + 1) / FACETS_RINGS);
            const double w = w1 + (w0 - w1) * (k % K + 0.5) / K, tangent = a * sqrt(1 - w * w) / w;
            const double phi = 2 * PI * (sector + ((int)(k / K) + 0.5) / K) / FACETS_SECTORS;
            sum += fmax(0, c + s * tangent * cos(phi - phi_o)) * 2 * w * (w0 - w1);
        }
        expected[i] = count * sum / (K * K) / FACETS_SECTORS * G1 / c;
    }
}

int facets_cell(const bis_bsdf *b, double a, vec3 wi)
{
    const double s[3] = {(double)wi.x + (double)b->wo.x, (double)wi.y + (double)b->wo.y,
                         (double)wi.z + (double)b->wo.z};
    const double x = s[0] * (double)b->local.x.x + s[1] * (double)b->local.x.y + s[2] * (double)b->local.x.z;
    const double y = s[0] * (double)b->local.y.x + s[1] * (double)b->local.y.y + s[2] * (double)b->local.y.z;
    const double z = s[0] * (double)b->local.z.x + s[1] * (double)b->local.z.y + s[2] * (double)b->local.z.z;
    const double r2 = x * x + y * y, v = r2 / (a * a * z * z + r2), phi = atan2(y, x);
    const int ring = (int)fmin(v * FACETS_RINGS, FACETS_RINGS - 1),
              sector = (int)((phi < 0 ? phi + 2 * PI : phi) / (2 * PI) * FACETS_SECTORS) % FACETS_SECTORS;

    return ring * FACETS_SECTORS + sector;
}

void mixture_expect(double expected[MIXTURE_CELLS], const bis_material *m, double degrees, double count)
{
    enum { K = 24 };
    lit l;

    lit_init(&l, NULL, *m, (vec3){0, 0, 1}, degrees, LIT_OPEN);
    for (int cell = 0; cell < MIXTURE_CELLS; cell++) {
        expected[cell] = 0;
        for (int k = 0; k < K * K; k++) {
            const double z = -1 + 2 * (cell / MIXTURE_PHI + (k % K + 0.5) / K) / MIXTURE_Z, s = sqrt(1 - z * z);
            const double phi = 2 * PI * (cell % MIXTURE_PHI + ((int)(k / K) + 0.5) / K) / MIXTURE_PHI;
            double pdf;
            lit_f(&l, (double[]){s * cos(phi), s * sin(phi), z}, &pdf);
            expected[cell] += pdf * 4 * PI / MIXTURE_CELLS / (K * K) * count;
        }
    }
}

int mixture_cell(vec3 wi)
{
    const double phi = atan2((double)wi.y, (double)wi.x), turns = phi < 0 ? phi / (2 * PI) + 1 : phi / (2 * PI);
    const int row = (int)fmin(((double)wi.z + 1) / 2 * MIXTURE_Z, MIXTURE_Z - 1);

    return row * MIXTURE_PHI + (int)(turns * MIXTURE_PHI) % MIXTURE_PHI;
}

/* Over the quantiles of facets_expect: c_i = 2 (wo h) cos theta_h - c_o. */
double facets_albedo_of_white(double a, double degrees)
{
    enum { K = 400 };
    const double c_o = cos(degrees * PI / 180), s_o = sin(degrees * PI / 180);
    double sum = 0;

    for (int k = 0; k < K * K; k++) {
        const double w = (k % K + 0.5) / K, tangent = a * sqrt(1 - w * w) / w,
                     seen = c_o + s_o * tangent * cos(2 * PI * ((int)(k / K) + 0.5) / K);
        const double c_i = 2 * seen / (1 + tangent * tangent) - c_o;
        if (seen > 0 && c_i > 0) sum += seen / c_o * 2 * w / (1 + smith(a, c_o) + smith(a, c_i));
    }
    return sum / (K * K);
}
