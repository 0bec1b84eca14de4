/* SPDX-License-Identifier: BSD-2-Clause */
/* texture_value: the value of a texture at a point, and the functions of one number that its range needs, too. For
 * src/scene and src/tools/plan.c alone. */
#pragma once

#include "bis/scene/texture.h"

enum { BIS_MARBLE_COLOURS = 9 };
extern const double bis_marble_colours[BIS_MARBLE_COLOURS][3];
#define BIS_MARBLE_SCALE 1.5

/* bis_texture_of_image returns what IMAGE makes of a texel. */
static inline double bis_texture_of_image(const bis_texture *x, double v)
{
    return x->invert ? 1 - x->scale * v : x->scale * v;
}

/* bis_texture_coated returns what COAT makes of its part's value. Values above 1 pass only where they are cut off. */
static inline double bis_texture_coated(const bis_texture *x, double v)
{
    v = fmin(v, 1);
    return (1 - x->scale) * v / (1 - x->scale * v);
}

/* bis_texture_own_alpha returns what ALPHA makes of its part's value. */
static inline double bis_texture_own_alpha(double roughness) { return fmin(bis_texture_alpha(roughness), 1); }

/* bis_texture_n_parts returns how many textures of[] names. */
static inline int bis_texture_n_parts(const bis_texture *x)
{
    switch (x->kind) {
    case BIS_TEXTURE_BILERP:
        return 4;
    case BIS_TEXTURE_MIX:
        return 3;
    case BIS_TEXTURE_SCALE:
    case BIS_TEXTURE_CHECKERBOARD:
    case BIS_TEXTURE_CHECKERBOARD_3D:
    case BIS_TEXTURE_DOTS:
        return 2;
    case BIS_TEXTURE_COAT:
    case BIS_TEXTURE_ALPHA:
        return 1;
    default:
        return 0;
    }
}

/* bis_texture_maps_uv returns whether a texture itself, without its parts, may ask for (u, v). */
static inline bool bis_texture_maps_uv(const bis_texture *x)
{
    return (x->kind == BIS_TEXTURE_IMAGE || x->kind == BIS_TEXTURE_CHECKERBOARD || x->kind == BIS_TEXTURE_DOTS ||
            x->kind == BIS_TEXTURE_BILERP || x->kind == BIS_TEXTURE_UV_COLOUR) && x->mapping == BIS_TEXTURE_UV;
}

/* bis_texture_bilinear returns the value of an image between the centres of its texels. */
rgbd bis_texture_bilinear(const bis_image *image, double s, double t, bis_wrap wrap);

/* bis_texture_value returns what bis_textures_value does, at a point in double. */
rgbd bis_texture_value(const bis_textures *t, const bis_texture_image *images, uint32_t texture, const double uv[2],
                       const double p[3]);
