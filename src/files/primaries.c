/* SPDX-License-Identifier: BSD-2-Clause */
/* primaries: to XYZ and back. The columns of the matrix to XYZ are the primaries' (x, y, 1 - x - y), each scaled by
 * what makes R = G = B = 1 the white of luminance 1. A primary may have no luminance (y = 0): X and Z of XYZ. */
#include "primaries.h"

#include "base/text.h"

#include <math.h>

const float bis_xyz[8] = {1, 0, 0, 1, 0, 0, 1.f / 3, 1.f / 3};
const float bis_rec709[8] = {.64f, .33f, .3f, .6f, .15f, .06f, .3127f, .329f};

/* Cramer's rule, with a column in the place of another. */
static double det(const double m[3][3])
{
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

static bool solve(double x[3], const double m[3][3], const double b[3])
{
    const double d = det(m);

    for (int k = 0; k < 3; k++) {
        double n[3][3];
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++) n[i][j] = j == k ? b[i] : m[i][j];
        x[k] = d != 0 ? det(n) / d : HUGE_VAL;
    }
    return isfinite(x[0]) && isfinite(x[1]) && isfinite(x[2]);
}

static bool to_xyz(double m[3][3], const float c[8])
{
    const double x = (double)c[6], y = (double)c[7];
    double scale[3];

    if (!(y != 0)) return false;
    const double white[3] = {x / y, 1, (1 - x - y) / y};
    for (int j = 0; j < 3; j++) {
        m[0][j] = (double)c[2 * j];
        m[1][j] = (double)c[2 * j + 1];
        m[2][j] = 1 - m[0][j] - m[1][j];
    }
    if (!solve(scale, m, white)) return false;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) m[i][j] *= scale[j];
    return true;
}

bool bis_primaries_matrix(double m[3][3], const float c[8])
{
    double from[3][3], to[3][3];

    if (!to_xyz(from, c) || !to_xyz(to, bis_rec709)) return false;
    for (int j = 0; j < 3; j++) {
        const double column[3] = {from[0][j], from[1][j], from[2][j]};
        double x[3];
        if (!solve(x, to, column)) return false;
        for (int i = 0; i < 3; i++) m[i][j] = x[i];
    }
    return true;
}

void bis_primaries_convert(bis_image *image, const double m[3][3], const image_input *in)
{
    const size_t n = (size_t)image->width * (size_t)image->height;
    size_t n_outside = 0;

    for (size_t k = 0; k < n; k++) {
        const rgb c = image->pixels[k];
        const double v[3] = {(double)c.r, (double)c.g, (double)c.b};
        double out[3];
        bool is_outside = false;
        for (int i = 0; i < 3; i++) {
            out[i] = m[i][0] * v[0] + m[i][1] * v[1] + m[i][2] * v[2];
            if (!(out[i] < 0 && v[0] >= 0 && v[1] >= 0 && v[2] >= 0)) continue;
            out[i] = 0;
            is_outside = true;
        }
        n_outside += is_outside;
        image->pixels[k] = rgb_from(out[0], out[1], out[2]);
    }
    if (!n_outside) {
        bis_image_remark(in, "its colours are converted from its own primaries to those of Rec. 709");
        return;
    }
    char share[BIS_PERCENT];
    bis_image_remark(in, "its colours are converted from its own primaries to those of Rec. 709; %s of its pixels "
                     "lie outside of these, and their negative parts are set to 0",
                     bis_percent(share, (double)n_outside / (double)n));
}
