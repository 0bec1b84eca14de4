/* SPDX-License-Identifier: BSD-2-Clause */
/* noise: at the corners of unit cubes stand gradients, chosen by a permutation of the corner's coordinates; between
 * them their linear functions are blended by 6 t^5 - 15 t^4 + 10 t^3.
 * Sources: Perlin 2002, "Improving noise", whose reference implementation has this permutation; pbrt, "Noise", for the
 * choice of gradients (which differs for 4 of the 16 numbers), the 1.99 between octaves and the 0.2. */
#include "noise.h"

#include <math.h>
#include <stdint.h>

static const uint8_t permutation[256] = {
    151, 160, 137, 91,  90,  15,  131, 13,  201, 95,  96,  53,  194, 233, 7,   225, 140, 36,  103, 30,  69,  142,
    8,   99,  37,  240, 21,  10,  23,  190, 6,   148, 247, 120, 234, 75,  0,   26,  197, 62,  94,  252, 219, 203,
    117, 35,  11,  32,  57,  177, 33,  88,  237, 149, 56,  87,  174, 20,  125, 136, 171, 168, 68,  175, 74,  165,
    71,  134, 139, 48,  27,  166, 77,  146, 158, 231, 83,  111, 229, 122, 60,  211, 133, 230, 220, 105, 92,  41,
    55,  46,  245, 40,  244, 102, 143, 54,  65,  25,  63,  161, 1,   216, 80,  73,  209, 76,  132, 187, 208, 89,
    18,  169, 200, 196, 135, 130, 116, 188, 159, 86,  164, 100, 109, 198, 173, 186, 3,   64,  52,  217, 226, 250,
    124, 123, 5,   202, 38,  147, 118, 126, 255, 82,  85,  212, 207, 206, 59,  227, 47,  16,  58,  17,  182, 189,
    28,  42,  223, 183, 170, 213, 119, 248, 152, 2,   44,  154, 163, 70,  221, 153, 101, 155, 167, 43,  172, 9,
    129, 22,  39,  253, 19,  98,  108, 110, 79,  113, 224, 232, 178, 185, 112, 104, 218, 246, 97,  228, 251, 34,
    242, 193, 238, 210, 144, 12,  191, 179, 162, 241, 81,  51,  145, 235, 249, 14,  239, 107, 49,  192, 214, 31,
    181, 199, 106, 157, 184, 84,  204, 176, 115, 121, 50,  45,  127, 4,   150, 254, 138, 236, 205, 93,  222, 114,
    67,  29,  24,  72,  243, 141, 128, 195, 78,  66,  215, 61,  156, 180};

static unsigned permuted(unsigned i) { return permutation[i & 255]; }

/* The gradient of corner (x, y, z) times d, the way from it. */
static double slope(const unsigned corner[3], const double d[3])
{
    const unsigned h = permuted(permuted(permuted(corner[0]) + corner[1]) + corner[2]) & 15;
    const double a = h < 8 || h == 12 || h == 13 ? d[0] : d[1], b = h < 4 || h == 12 || h == 13 ? d[1] : d[2];
    return (h & 1 ? -a : a) + (h & 2 ? -b : b);
}

double bis_noise(const double p[3])
{
    unsigned cell[3];
    double d[3], w[3], sum = 0;

    for (int i = 0; i < 3; i++) {
        const double whole = floor(p[i]);
        cell[i] = (unsigned)(whole - 256 * floor(whole / 256)); /* exact, and in [0, 255] */
        d[i] = p[i] - whole;
        w[i] = d[i] * d[i] * d[i] * (d[i] * (6 * d[i] - 15) + 10);
    }
    for (unsigned k = 0; k < 8; k++) {
        const unsigned on[3] = {k & 1, k >> 1 & 1, k >> 2};
        const unsigned corner[3] = {cell[0] + on[0], cell[1] + on[1], cell[2] + on[2]};
        const double way[3] = {d[0] - on[0], d[1] - on[1], d[2] - on[2]};
        double share = 1;
        for (int i = 0; i < 3; i++) share *= on[i] ? w[i] : 1 - w[i];
        sum += share * slope(corner, way);
    }
    return sum;
}

double bis_noise_fbm(const double p[3], double roughness, unsigned octaves)
{
    double sum = 0, scale = 1, weight = 1;

    for (unsigned i = 0; i < octaves; i++, scale *= 1.99, weight *= roughness)
        sum += weight * bis_noise((double[]){scale * p[0], scale * p[1], scale * p[2]});
    return sum;
}

double bis_noise_turbulence(const double p[3], double roughness, unsigned octaves)
{
    double sum = 0, scale = 1, weight = 1;

    for (unsigned i = 0; i < octaves; i++, scale *= 1.99, weight *= roughness)
        sum += weight * fabs(bis_noise((double[]){scale * p[0], scale * p[1], scale * p[2]}));
    return sum + 0.2 * weight;
}

double bis_noise_weights(double roughness, unsigned octaves)
{
    double sum = 0, weight = 1;

    for (unsigned i = 0; i < octaves; i++, weight *= roughness) sum += weight;
    return sum;
}
