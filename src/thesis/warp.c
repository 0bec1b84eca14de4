/* warp: the maps of bis/thesis/warp.h, computed in double. The sines come from products that do not cancel, because
 * sqrt(1 - z^2) near z = 1 would lose half its digits. */
#include "bis/thesis/warp.h"

vec3 bis_warp_sphere(double u1, double u2)
{
    /* Archimedes: z is uniform in (-1, 1]. sin^2 theta = (1 - z)(1 + z) with z = 1 - 2 u1. */
    double sin_theta = 2 * sqrt(u1 * (1 - u1)), phi = 2 * PI * u2;
    return vec3_from(sin_theta * cos(phi), sin_theta * sin(phi), 1 - 2 * u1);
}

/* Maps squares about the centre to circles about the centre: the radius is r = max(|a|, |b|), and the angle is in
 * proportion to the place along the side. one_minus_r is 1 - r without rounding: 1 - |2u - 1| = 2 min(u, 1 - u).
 * Source: Shirley and Chiu 1997, "A Low Distortion Map Between Disk and Square". */
static void concentric(double d[2], double *r, double *one_minus_r, double u1, double u2)
{
    double a = 2 * u1 - 1, b = 2 * u2 - 1, phi;

    if (fabs(a) > fabs(b)) {
        *r = a;
        *one_minus_r = 2 * fmin(u1, 1 - u1);
        phi = PI / 4 * (b / a);
    } else {
        *r = b;
        *one_minus_r = 2 * fmin(u2, 1 - u2);
        phi = b == 0 ? 0 : PI / 2 - PI / 4 * (a / b); /* b = 0 is the centre, which has no angle */
    }
    d[0] = *r * cos(phi);
    d[1] = *r * sin(phi);
}

void bis_warp_disc(double d[2], double u1, double u2)
{
    double r, one_minus_r;
    concentric(d, &r, &one_minus_r, u1, u2);
}

/* Malley: a uniform disc, lifted to the hemisphere, is cosine-weighted. z^2 = 1 - r^2 = (1 - |r|)(1 + |r|). */
vec3 bis_warp_cosine(double u1, double u2)
{
    double d[2], r, one_minus_r;
    concentric(d, &r, &one_minus_r, u1, u2);
    return vec3_from(d[0], d[1], sqrt(one_minus_r * (1 + fabs(r))));
}

double bis_warp_cosine_pdf(double cos_theta) { return cos_theta > 0 ? cos_theta * INV_PI : 0; }
