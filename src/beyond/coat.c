/* SPDX-License-Identifier: BSD-2-Clause */
/* coat: means over POINTS directions and visible facets (microfacet.c draws them in the same way). A facet h that a
 * direction w meets lets 1 - F through, of which G2/G1 is not shadowed. Points are Hammersley's: the error is 1e-3. */
#include "bis/beyond/coat.h"

#include "bis/base/fresnel.h"
#include "bis/base/vec.h"

#include <math.h>

enum { POINTS = 4096 };

/* i in base b, mirrored about the point. */
static double mirrored(unsigned i, unsigned b)
{
    double u = 0, place = 1.0 / b;

    for (; i; i /= b, place /= b) u += i % b * place;
    return u;
}

/* A direction above the interface by its cosine, a facet that it sees by its z, and the cosine between both. */
typedef struct meeting {
    double c, h, cos_d;
} meeting;

static meeting meet(unsigned i, double a)
{
    const double u1 = mirrored(i, 2), phi = 2 * PI * mirrored(i, 3);
    const double c = sqrt((i + 0.5) / POINTS), s = sqrt(1 - c * c), scale = 1 / sqrt(a * a * s * s + c * c);
    const double v[2] = {a * s * scale, c * scale}, z = 1 - u1 * (1 + v[1]), r = sqrt(fmax(0, 1 - z * z));
    const double h[3] = {a * (r * cos(phi) + v[0]), a * r * sin(phi), z + v[1]};
    const double size = sqrt(h[0] * h[0] + h[1] * h[1] + h[2] * h[2]);

    return (meeting){c, h[2] / size, fmin(1, (s * h[0] + c * h[2]) / size)};
}

static double lambda(double a, double c) { return (sqrt(1 + a * a * (1 - c * c) / (c * c)) - 1) / 2; }

/* G2/G1 of the cosines before and after, and what the layer leaves over. */
static double kept(double a, double before, double after, double path)
{
    if (after <= 0) return 0;
    return (1 + lambda(a, before)) / (1 + lambda(a, before) + lambda(a, after)) * exp(-path);
}

void bis_coat_shares(double *in, double *back, double alpha, double eta, double thickness)
{
    *in = *back = 0;
    for (unsigned i = 0; i < POINTS; i++) {
        const meeting m = meet(i, alpha);
        const double along = sqrt(1 - (1 - m.cos_d * m.cos_d) / (eta * eta)); /* Snell's law */
        const double down = m.c / eta + m.h * (along - m.cos_d / eta), up = 2 * m.cos_d * m.h - m.c;
        *in += (1 - bis_fresnel(eta, 0, m.cos_d)) * kept(alpha, m.c, down, thickness / down) / POINTS;
        *back += bis_fresnel(1 / eta, 0, m.cos_d) * kept(alpha, m.c, up, thickness / m.c + thickness / up) / POINTS;
    }
}
