/* SPDX-License-Identifier: BSD-2-Clause */
/* bump: normals that textures bend.
 *
 * A displacement d moves a point along its normal n, and is so small that only its slopes count: the tangents p_u and
 * p_v become p_u + d_u n and p_v + d_v n (Blinn 1978; pbrt, "Bump mapping"), and their cross product is the normal.
 * d_u is the difference over one texel of the finest image that d asks, half of it to each side. So the slope of an
 * image, which is bilinear, is continuous. For what has no texels, the whole is pbrt's step, 0.0005.
 * A normal map holds (n + 1)/2 in the frame of p_u, y and n, where y is n x p_u or, if that is away from p_v, its
 * opposite: glTF, MikkTSpace and Blender have y where v grows. pbrt-v4 has n x p_u always (FrameFromXZ), so that
 * there every map whose coordinates are mirrored is upside down.
 * On a smooth mesh p_u and p_v are first made perpendicular to the interpolated normal. */
#include "bump.h"

#include "texture_value.h"

#include <math.h>

/* a without its part along the unit vector n. */
static void beside(double out[3], const double a[3], const double n[3])
{
    const double along = dot3(a, n);
    for (int i = 0; i < 3; i++) out[i] = a[i] - along * n[i];
}

/* One texel of the finest image, in u and in v. */
static void find_steps(double step[2], const bis_textures *t, const bis_texture_image *images, uint32_t texture)
{
    const bis_texture *x = &t->list[texture];

    if (x->kind == BIS_TEXTURE_IMAGE && x->mapping == BIS_TEXTURE_UV) {
        const bis_image *im = &images[x->image].image;
        const double texel[2] = {1 / (double)im->width, 1 / (double)im->height};
        for (int i = 0; i < 2; i++) /* a factor of 0 gives no slope, however long the step */
            if (x->factor[i] != 0) step[i] = fmin(step[i], texel[i] / fabs(x->factor[i]));
    }
    for (int i = 0; i < bis_texture_n_parts(x); i++) find_steps(step, t, images, x->of[i]);
}

/* A displacement, and where it is asked for. */
typedef struct displacement {
    const bis_textures *textures;
    const bis_texture_image *images;
    uint32_t texture;
    const double *uv, *p;
} displacement;

static double displaced(const displacement *d, int axis, double step, const double along[3])
{
    double at[2] = {d->uv[0], d->uv[1]}, q[3];

    at[axis] += step;
    for (int i = 0; i < 3; i++) q[i] = d->p[i] + step * along[i];
    return bis_texture_value(d->textures, d->images, d->texture, at, q).r;
}

/* tangent + slope n */
static void tilt(double tangent[3], const displacement *d, int axis, double step, const double n[3])
{
    const double slope = (displaced(d, axis, step / 2, tangent) - displaced(d, axis, -step / 2, tangent)) / step;
    for (int i = 0; i < 3; i++) tangent[i] += slope * n[i];
}

static void bend(double out[3], const displacement *d, double pu[3], double pv[3], const double n[3])
{
    const double most = (double)INFINITY, pbrts = 0.0005;
    double step[2] = {most, most};

    find_steps(step, d->textures, d->images, d->texture);
    for (int i = 0; i < 2; i++)
        if (isinf(step[i])) step[i] = pbrts;
    tilt(pu, d, 0, step[0], n);
    tilt(pv, d, 1, step[1], n);
    cross3(out, pu, pv);
}

/* Where the coordinates give no frame, at a pole or all over a triangle, the normal stays. */
static void map_normal(double out[3], rgbd c, const bis_tangents *t, const double pu[3], const double pv[3])
{
    const double *n = t->outside, size = sqrt(dot3(pu, pu));
    double y[3], x[3];

    for (int i = 0; i < 3; i++) out[i] = n[i];
    if (!(size > 0) || t->is_arbitrary) return;
    for (int i = 0; i < 3; i++) x[i] = pu[i] / size;
    cross3(y, n, x);
    const double side = dot3(y, pv), up = side < 0 ? -1 : 1;
    if (side == 0) return;
    for (int i = 0; i < 3; i++) out[i] = (2 * c.r - 1) * x[i] + (2 * c.g - 1) * up * y[i] + (2 * c.b - 1) * n[i];
}

/* The texel of a displacement that turned out to be a normal map. Its x and y are those of the image, which a negative
 * factor mirrors. */
static rgbd displacing_normal(const bis_texture *x, const bis_image *image, const double uv[2])
{
    const rgbd c = bis_texture_bilinear(image, x->factor[0] * uv[0] + x->offset[0],
                                        x->factor[1] * uv[1] + x->offset[1], x->wrap);
    const double sx = x->factor[0] < 0 ? -x->scale : x->scale, sy = x->factor[1] < 0 ? -x->scale : x->scale;
    return (rgbd){0.5 + sx * (c.r - 0.5), 0.5 + sy * (c.g - 0.5), c.b};
}

vec3 bis_bump_normal(const bis_textures *textures, const bis_texture_image *images, const bis_material_textures *of,
                     const bis_tangents *t, const double uv[2], vec3 p)
{
    const double *n = t->outside, at[3] = {(double)p.x, (double)p.y, (double)p.z};
    double pu[3], pv[3], out[3];

    beside(pu, t->u, n);
    beside(pv, t->v, n);
    const bis_texture *x = of->bump != BIS_NO_TEXTURE ? &textures->list[of->bump] : NULL;
    if (of->normals != BIS_NO_TEXTURE)
        map_normal(out, bis_texture_bilinear(&images[of->normals].image, uv[0], uv[1], BIS_WRAP_REPEAT), t, pu, pv);
    else if (x->kind == BIS_TEXTURE_IMAGE && images[x->image].holds_normals)
        map_normal(out, displacing_normal(x, &images[x->image].image, uv), t, pu, pv);
    else bend(out, &(displacement){textures, images, of->bump, uv, at}, pu, pv, n);
    const double side = dot3(out, n) < 0 ? -1 : 1, size = side * sqrt(dot3(out, out));
    /* at a pole of a sphere p_u is 0; a normal of a map may be 0 */
    if (!(fabs(size) > 0) || !isfinite(size)) return vec3_from(n[0], n[1], n[2]);
    return vec3_from(out[0] / size, out[1] / size, out[2] / size);
}
