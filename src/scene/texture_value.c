/* SPDX-License-Identifier: BSD-2-Clause */
/* texture_value: the value of a texture at a point.
 *
 * An image is interpolated bilinearly between the centres of its texels, and never filtered, and the noise of the
 * patterns has all of its octaves: where these are smaller than pixels, the camera samples average them. */
#include "texture_value.h"

#include "noise.h"

#include <math.h>

double bis_texture_alpha(double roughness)
{
    const double x = log(fmax(roughness, 1e-3));
    return 1.62142 + x * (0.819955 + x * (0.1734 + x * (0.0171201 + x * 0.000640711)));
}

/* The texel, or one of the image's border, or of its repetition. False: it is black. i may be any whole number. */
static bool wrap_index(double i, int n, bis_wrap wrap, size_t *index)
{
    if (wrap == BIS_WRAP_REPEAT) i -= n * floor(i / n);
    else if (wrap == BIS_WRAP_BLACK && (i < 0 || i >= n)) return false;
    *index = i <= 0 ? 0 : i >= n - 1 ? (size_t)n - 1 : (size_t)i; /* also what rounding makes of a huge i */
    return true;
}

static rgbd texel(const bis_image *image, double x, double y, bis_wrap wrap)
{
    size_t column, row;

    if (!wrap_index(x, image->width, wrap, &column) || !wrap_index(y, image->height, wrap, &row))
        return (rgbd){0, 0, 0};
    const rgb c = image->pixels[row * (size_t)image->width + column];
    return (rgbd){(double)c.r, (double)c.g, (double)c.b};
}

static rgbd lerp(double w, rgbd a, rgbd b) { return rgbd_add(rgbd_scale(a, 1 - w), rgbd_scale(b, w)); }

/* Texel i has its centre at (i + 1/2)/n. Row 0 is at the top, where t = 1. */
rgbd bis_texture_bilinear(const bis_image *image, double s, double t, bis_wrap wrap)
{
    const double x = s * image->width - 0.5, y = (1 - t) * image->height - 0.5, x0 = floor(x), y0 = floor(y);
    const rgbd top = lerp(x - x0, texel(image, x0, y0, wrap), texel(image, x0 + 1, y0, wrap));
    const rgbd bottom = lerp(x - x0, texel(image, x0, y0 + 1, wrap), texel(image, x0 + 1, y0 + 1, wrap));

    return lerp(y - y0, top, bottom);
}

static rgbd image_value(const bis_texture *x, const bis_image *image, double s, double t)
{
    rgbd v = bis_texture_bilinear(image, s, t, x->wrap);

    if (x->is_float) v.r = v.g = v.b = rgbd_sum(v) / 3;
    return (rgbd){bis_texture_of_image(x, v.r), bis_texture_of_image(x, v.g), bis_texture_of_image(x, v.b)};
}

static rgbd mix(rgbd a, rgbd b, rgbd w)
{
    return (rgbd){(1 - w.r) * a.r + w.r * b.r, (1 - w.g) * a.g + w.g * b.g, (1 - w.b) * a.b + w.b * b.b};
}

/* As in pbrt-v4, "Texture coordinate generation". */
static void to_texture(double q[3], const bis_texture *x, const double p[3])
{
    for (int i = 0; i < 3; i++)
        q[i] = x->from_world[i][0] * p[0] + x->from_world[i][1] * p[1] + x->from_world[i][2] * p[2] +
               x->from_world[i][3];
}

static void map_point(double st[2], const bis_texture *x, const double uv[2], const double p[3])
{
    double q[3];

    if (x->mapping == BIS_TEXTURE_UV) {
        for (int i = 0; i < 2; i++) st[i] = x->factor[i] * uv[i] + x->offset[i];
        return;
    }
    to_texture(q, x, p);
    const double phi = atan2(q[1], q[0]);
    if (x->mapping == BIS_TEXTURE_SPHERICAL) {
        st[0] = atan2(hypot(q[0], q[1]), q[2]) / PI;
        st[1] = (phi < 0 ? phi + 2 * PI : phi) / (2 * PI);
    } else if (x->mapping == BIS_TEXTURE_CYLINDRICAL) {
        st[0] = (PI + phi) / (2 * PI);
        st[1] = q[2];
    } else {
        st[0] = q[0];
        st[1] = q[1];
    }
}

/* ---- patterns ---- */

/* pbrt's colours of marble, linear RGB; neighbours of four are the points of a Bezier curve. */
const double bis_marble_colours[BIS_MARBLE_COLOURS][3] = {{.58, .58, .6}, {.58, .58, .6}, {.58, .58, .6},
                                                          {.5, .5, .5},   {.6, .59, .58}, {.58, .58, .6},
                                                          {.58, .58, .6}, {.2, .2, .33},  {.58, .58, .6}};

static rgbd marble(const bis_texture *x, const double q[3])
{
    enum { CURVES = BIS_MARBLE_COLOURS - 3 };
    const double s[3] = {x->scale * q[0], x->scale * q[1], x->scale * q[2]};
    const double t = (0.5 + 0.5 * sin(s[1] + x->variation * bis_noise_fbm(s, x->roughness, x->octaves))) * CURVES;
    const int first = t < CURVES - 1 ? (int)t : CURVES - 1;
    const double b = t - first, a = 1 - b, weight[4] = {a * a * a, 3 * a * a * b, 3 * a * b * b, b * b * b};
    double c[3] = {0, 0, 0};

    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 3; k++) c[k] += BIS_MARBLE_SCALE * weight[i] * bis_marble_colours[first + i][k];
    return (rgbd){c[0], c[1], c[2]};
}

/* What windy multiplies: how strong the wind is there, and how high a wave. */
static double windy(const double q[3])
{
    const double far[3] = {0.1 * q[0], 0.1 * q[1], 0.1 * q[2]};
    return fabs(bis_noise_fbm(far, 0.5, 3)) * bis_noise_fbm(q, 0.5, 6);
}

/* Two fifths of the cells, about whole numbers, hold a disc that noise moves. */
static bool is_in_dot(const double st[2])
{
    const double s = floor(st[0] + 0.5), t = floor(st[1] + 0.5), radius = 0.35, most = 0.5 - radius;

    if (!(bis_noise((double[]){s + 0.5, t + 0.5, 0.5}) > 0)) return false;
    const double ds = st[0] - (s + most * bis_noise((double[]){s + 1.5, t + 2.8, 0.5}));
    const double dt = st[1] - (t + most * bis_noise((double[]){s + 4.5, t + 9.8, 0.5}));
    return ds * ds + dt * dt < radius * radius;
}

static bool is_odd(double n) { return fmod(n, 2) != 0; }

/* Of the patterns that choose one of two parts: which. */
static int chosen_part(const bis_texture *x, const double uv[2], const double p[3])
{
    double st[2], q[3];

    if (x->kind == BIS_TEXTURE_CHECKERBOARD_3D) {
        to_texture(q, x, p);
        return is_odd(floor(q[0]) + floor(q[1]) + floor(q[2]));
    }
    map_point(st, x, uv, p);
    return x->kind == BIS_TEXTURE_DOTS ? !is_in_dot(st) : is_odd(floor(st[0]) + floor(st[1]));
}

/* Of the patterns in space, which have no parts. */
static rgbd solid(const bis_texture *x, const double p[3])
{
    double q[3], v;

    to_texture(q, x, p);
    if (x->kind == BIS_TEXTURE_MARBLE) return marble(x, q);
    if (x->kind == BIS_TEXTURE_FBM) v = bis_noise_fbm(q, x->roughness, x->octaves);
    else if (x->kind == BIS_TEXTURE_WRINKLED) v = bis_noise_turbulence(q, x->roughness, x->octaves);
    else v = windy(q);
    return (rgbd){v, v, v};
}

/* ---- values ---- */

/* Of the textures that ask all of their parts. */
static rgbd combined(const bis_texture *x, const rgbd v[4], const double uv[2], const double p[3])
{
    double st[2];

    switch (x->kind) {
    case BIS_TEXTURE_MIX:
        return mix(v[0], v[1], v[2]);
    case BIS_TEXTURE_COAT:
        return (rgbd){bis_texture_coated(x, v[0].r), bis_texture_coated(x, v[0].g), bis_texture_coated(x, v[0].b)};
    case BIS_TEXTURE_ALPHA:
        return (rgbd){bis_texture_own_alpha(v[0].r), bis_texture_own_alpha(v[0].g), bis_texture_own_alpha(v[0].b)};
    case BIS_TEXTURE_BILERP:
        map_point(st, x, uv, p);
        return lerp(st[0], lerp(st[1], v[0], v[1]), lerp(st[1], v[2], v[3]));
    default:
        return (rgbd){v[0].r * v[1].r, v[0].g * v[1].g, v[0].b * v[1].b};
    }
}

rgbd bis_texture_value(const bis_textures *textures, const bis_texture_image *images, uint32_t texture,
                       const double uv[2], const double p[3])
{
    const bis_texture *x = &textures->list[texture];
    double st[2];
    rgbd v[4];

    switch (x->kind) {
    case BIS_TEXTURE_CONSTANT:
        return x->value;
    case BIS_TEXTURE_IMAGE:
        map_point(st, x, uv, p);
        return image_value(x, &images[x->image].image, st[0], st[1]);
    case BIS_TEXTURE_UV_COLOUR:
        map_point(st, x, uv, p);
        return (rgbd){st[0] - floor(st[0]), st[1] - floor(st[1]), 0};
    case BIS_TEXTURE_CHECKERBOARD:
    case BIS_TEXTURE_CHECKERBOARD_3D:
    case BIS_TEXTURE_DOTS:
        return bis_texture_value(textures, images, x->of[chosen_part(x, uv, p)], uv, p);
    case BIS_TEXTURE_FBM:
    case BIS_TEXTURE_WRINKLED:
    case BIS_TEXTURE_WINDY:
    case BIS_TEXTURE_MARBLE:
        return solid(x, p);
    default:
        for (int i = 0; i < bis_texture_n_parts(x); i++)
            v[i] = bis_texture_value(textures, images, x->of[i], uv, p);
        return combined(x, v, uv, p);
    }
}
