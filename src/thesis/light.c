/* SPDX-License-Identifier: BSD-2-Clause */
/* light: the illumination as an integrator sees it: directions and densities in world space. Source: thesis 3.1.
 *
 * A light is a constant or a map. For a constant nothing is built, and directions are uniform over the sphere. A map
 * comes with its importance (3.3, 3.4) and is turned by the rotation or reflection that stood where the scene
 * declared it. A rotation preserves solid angles, so densities do not change. It is kept in double and made exactly
 * orthonormal, because its inverse is then its transpose.
 *
 * A drawn direction carries the radiance of the pixel that was drawn, and not that of the pixel that the rounded
 * direction looks up. The two pixels differ for about one direction in 10^5 of a 4096 x 2048 map, next to a pixel's
 * edge. */
#include "bis/thesis/light.h"

#include "bis/base/curve.h"
#include "bis/base/mem.h"
#include "bis/thesis/warp.h"
#include "bis/thesis/envmap.h"
#include "bis/thesis/importance.h"
#include "bis/base/xform.h"

#include <assert.h>
#include <float.h>

/* The patches of a constant for eq. 3.2: equal steps of z and of phi, so patches of equal solid angle, 10^-4 sr each.
 * So many, because `exact` is the truth beside other methods, and a patch of 0.6 degrees is far narrower than what V
 * and f do in most pictures. */
enum { PATCHES_X = 512, PATCHES_Y = 256 };

struct bis_light {
    bool is_constant;
    rgb L;                      /* radiance of a constant */
    bis_envmap em;
    bis_importance *importance; /* NULL: nothing was needed */
    double rotation[3][3];      /* local to world, column by column: rotation[i] is the image of axis i */
    double power, max_intensity;
    bis_portal portals[BIS_PORTALS_MAX];
    uint32_t n_portals;
};

/* ---- the frame ---- */

static vec3 to_world_frame(const bis_light *light, vec3 w)
{
    const double(*r)[3] = light->rotation;
    const double x = (double)w.x, y = (double)w.y, z = (double)w.z;
    return vec3_from(x * r[0][0] + y * r[1][0] + z * r[2][0], x * r[0][1] + y * r[1][1] + z * r[2][1],
                     x * r[0][2] + y * r[1][2] + z * r[2][2]);
}

static vec3 to_map_frame(const bis_light *light, vec3 w)
{
    const double v[3] = {(double)w.x, (double)w.y, (double)w.z};
    return vec3_from(dot3(v, light->rotation[0]), dot3(v, light->rotation[1]), dot3(v, light->rotation[2]));
}

/* ---- making one ---- */

bis_status bis_light_new(bis_light **out, bis_envmap *em, const bis_xform *to_world,
                         const bis_importance_options *importance, bis_diag *diag)
{
    const bis_xform rotation = bis_xform_rotation(to_world); /* of what is orthonormal only to some digits */
    bis_status status = BIS_OK;
    bis_light *light = bis_alloc(1, sizeof *light);

    *out = NULL;
    if (!light) {
        bis_envmap_clear(em);
        return bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for a light");
    }
    light->em = *em; /* from here on bis_light_free frees it, after a failure, too */
    *em = (bis_envmap){0};
    for (int axis = 0; axis < 3; axis++) {
        for (int i = 0; i < 3; i++) light->rotation[axis][i] = rotation.m[i][axis];
    }
    if (importance) status = bis_importance_new(&light->importance, &light->em, importance, diag);
    if (status) goto done;
    /* both are asked for at every point, and the map does not change any more */
    if (importance) bis_importance_measured(light->importance, &light->power, &light->max_intensity);
    else bis_envmap_measure(&light->em, &light->power, &light->max_intensity);
    *out = light;
    light = NULL;
done:
    bis_light_free(light);
    return status;
}

bis_status bis_light_constant(bis_light **out, rgb L, bis_diag *diag)
{
    assert(rgb_is_finite(L) && L.r >= 0 && L.g >= 0 && L.b >= 0);
    *out = bis_alloc(1, sizeof **out);
    if (!*out) return bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for a light");
    **out = (bis_light){.is_constant = true, .L = L, .power = 4 * PI * rgb_sum(L), .max_intensity = rgb_sum(L)};
    return BIS_OK;
}

void bis_light_set_portals(bis_light *light, const bis_portal *portals, uint32_t n)
{
    for (light->n_portals = 0; light->n_portals < n; light->n_portals++)
        light->portals[light->n_portals] = portals[light->n_portals];
}

const bis_portal *bis_light_portals(const bis_light *light, uint32_t *n)
{
    *n = light->n_portals;
    return light->portals;
}

void bis_light_free(bis_light *light)
{
    if (!light) return;
    bis_importance_free(light->importance);
    bis_envmap_clear(&light->em);
    bis_free(light);
}

/* ---- asking it ---- */

rgb bis_light_Le(const bis_light *light, vec3 wi)
{
    return light->is_constant ? light->L : bis_envmap_Le(&light->em, to_map_frame(light, wi));
}

/* Draws from a constant at the point (u1, u2) of the square. */
static bool constant_point(const bis_light *light, double u1, double u2, bis_light_point *s)
{
    *s = (bis_light_point){bis_warp_sphere(u1, u2), light->L, 1 / (4 * PI)};
    return light->max_intensity > 0;
}

/* Le is that of the drawn pixel, see above: a look-up by wi would give its neighbour's now and then, with this pixel's
 * density. */
static void map_point(const bis_light *light, const bis_map_sample *m, bis_light_point *s)
{
    *s = (bis_light_point){to_world_frame(light, m->w_local), light->em.pixels[m->pixel], m->pdf};
}

bool bis_light_sample(const bis_light *light, const double u[4], bis_light_point *s)
{
    if (light->is_constant) return constant_point(light, u[0], u[1], s);
    assert(light->importance);
    bis_map_sample m;
    if (!bis_importance_sample(light->importance, u, &m)) return false;
    map_point(light, &m, s);
    return true;
}

bool bis_light_sample_curve(const bis_light *light, double t, const double u[2], bis_light_point *s)
{
    if (light->is_constant) {
        double q[2];
        bis_curve_hilbert(t, q); /* u is the place in the curve's last cell, which is 2^-26 wide */
        return constant_point(light, q[0] + u[0] * 0x1p-26, q[1] + u[1] * 0x1p-26, s);
    }
    assert(light->importance);
    bis_map_sample m;
    if (!bis_importance_sample_curve(light->importance, t, u, &m)) return false;
    map_point(light, &m, s);
    return true;
}

double bis_light_pdf(const bis_light *light, vec3 wi)
{
    if (light->is_constant) return light->max_intensity > 0 ? 1 / (4 * PI) : 0;
    assert(light->importance);
    return bis_importance_pdf(light->importance, to_map_frame(light, wi));
}

rgb bis_light_Le_pdf(const bis_light *light, vec3 wi, double *pdf)
{
    if (light->is_constant) {
        *pdf = bis_light_pdf(light, wi);
        return light->L;
    }
    assert(light->importance);
    /* one look-up for both: density and radiance are those of one pixel, or their quotient is wrong at its edge */
    const size_t pixel = bis_envmap_pixel(&light->em, to_map_frame(light, wi));
    *pdf = bis_importance_pdf_pixel(light->importance, pixel);
    return light->em.pixels[pixel];
}

double bis_light_mean(const bis_light *light) { return light->power / (4 * PI); }

double bis_light_max_ratio(const bis_light *light)
{
    /* The caller divides I by the rounded 1/(4 pi). The factor 1 + 8 * 2^-53 covers these roundings and ours. */
    if (light->is_constant) return light->max_intensity * (4 * PI) * (1 + 4 * DBL_EPSILON);
    assert(light->importance);
    return bis_importance_max_ratio(light->importance);
}

double bis_light_max_intensity(const bis_light *light) { return light->max_intensity; }

double bis_light_power(const bis_light *light) { return light->power; }

size_t bis_light_patches(const bis_light *light)
{
    if (light->is_constant) return PATCHES_X * PATCHES_Y;
    return (size_t)light->em.width * (size_t)light->em.height;
}

void bis_light_patch(const bis_light *light, size_t i, const double u[2], bis_light_point *s)
{
    assert(i < bis_light_patches(light));
    if (light->is_constant) {
        const double x = (double)(i % PATCHES_X), y = (double)(i / PATCHES_X);
        constant_point(light, (x + u[0]) / PATCHES_X, (y + u[1]) / PATCHES_Y, s);
        s->pdf = PATCHES_X * PATCHES_Y / (4 * PI); /* in the patch, and not on the sphere */
        return;
    }
    const size_t width = (size_t)light->em.width;
    const int x = (int)(i % width), y = (int)(i / width);
    s->wi = to_world_frame(light, bis_envmap_direction(&light->em, x, y, u[0], u[1]));
    s->Le = light->em.pixels[i];
    s->pdf = 1 / light->em.row_solid_angle[y];
}

void bis_light_axes(const bis_light *light, vec3 axis[3])
{
    const double(*r)[3] = light->rotation;

    assert(!light->is_constant);
    for (int i = 0; i < 3; i++) axis[i] = vec3_from(r[i][0], r[i][1], r[i][2]);
}

bool bis_light_is_constant(const bis_light *light) { return light->is_constant; }
bool bis_light_is_black(const bis_light *light) { return light->max_intensity == 0; }
const bis_envmap *bis_light_envmap(const bis_light *light) { return light->is_constant ? NULL : &light->em; }
const bis_importance *bis_light_importance(const bis_light *light) { return light->importance; }

size_t bis_light_bytes(const bis_light *light)
{
    const size_t map = light->is_constant ? 0 : bis_envmap_bytes(&light->em);
    return sizeof *light + map + (light->importance ? bis_importance_bytes(light->importance) : 0);
}
