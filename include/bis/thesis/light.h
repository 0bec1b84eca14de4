/* SPDX-License-Identifier: BSD-2-Clause */
/* light: the light that comes from infinity, in world space: an environment map or a constant. An integrator asks it
 * for Le, a sample and a density. It never learns which of the two the light is, nor where the pixels came from. */
#pragma once

#include "bis/base/status.h"
#include "bis/base/vec.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* What an integrator needs of the light. The scene builds only that. */
enum {
    BIS_NEED_TABLE = 1,     /* bis_light_sample */
    BIS_NEED_CURVE = 2,     /* bis_light_sample_curve */
    BIS_NEED_COMPENSATED = 4, /* with BIS_NEED_TABLE: MIS compensation */
    /* with BIS_NEED_TABLE: the numbers that go through the table are points of a sampler, whose even spread a table of
     * CDFs keeps and an alias table loses (docs/errata.md E12); without it they are independent */
    BIS_NEED_SPREAD = 8
};

typedef struct bis_light bis_light;

/* Types of bis/thesis/envmap.h, bis/thesis/importance.h and bis/base/xform.h, for callers that make a light. */
typedef struct bis_envmap bis_envmap;
typedef struct bis_importance bis_importance;
typedef struct bis_importance_options bis_importance_options;
typedef struct bis_xform bis_xform;

/* A direction towards the light, the radiance from there, and the density of drawing it in 1/sr. */
typedef struct bis_light_point {
    vec3 wi;
    rgb Le;
    double pdf;
} bis_light_point;

/* A rectangle in world space through which the light is expected, such as a window: a corner and two edges, which are
 * at right angles. It changes no light: src/beyond/portal.h draws directions through it. */
typedef struct bis_portal {
    double corner[3], edge[2][3];
} bis_portal;

enum { BIS_PORTALS_MAX = 16 };

/* bis_light_new makes a light of a map. It takes over em, which is empty afterwards, on failure too. to_world is the
 * map's frame in the world: a rotation or reflection, to BIS_XFORM_FRAME_TOLERANCE; the light makes it exactly
 * orthonormal. `importance` says what to build for drawing directions. If it is NULL, nothing is built, and the light
 * can only be looked up. Errors: BIS_NOMEM. */
bis_status bis_light_new(bis_light **out, bis_envmap *em, const bis_xform *to_world,
                         const bis_importance_options *importance, bis_diag *diag);

/* bis_light_constant makes a light with the same radiance L from all directions. L is finite and >= 0. Errors:
 * BIS_NOMEM. */
bis_status bis_light_constant(bis_light **out, rgb L, bis_diag *diag);

/* bis_light_set_portals copies n <= BIS_PORTALS_MAX portals into the light; bis_light_portals returns them, and *n. */
void bis_light_set_portals(bis_light *light, const bis_portal *portals, uint32_t n);
const bis_portal *bis_light_portals(const bis_light *light, uint32_t *n);

/* bis_light_free frees the light; NULL is allowed. */
void bis_light_free(bis_light *light);

/* bis_light_Le returns the radiance that arrives from wi, a unit direction in world space. */
rgb bis_light_Le(const bis_light *light, vec3 wi);

/* bis_light_sample draws a direction by the light's importance over the whole sphere (docs/errata.md E1). u[4] are
 * the numbers of bis_importance_sample. A constant draws uniformly over the sphere, by u[0] and u[1] alone. Returns
 * false if there is no light; *s is then not set. Needs BIS_NEED_TABLE. */
bool bis_light_sample(const bis_light *light, const double u[4], bis_light_point *s);

/* bis_light_sample_curve draws the direction at position t of the map's curve, as bis_importance_sample_curve does.
 * Returns false if there is no light. Needs BIS_NEED_CURVE. */
bool bis_light_sample_curve(const bis_light *light, double t, const double u[2], bis_light_point *s);

/* bis_light_pdf returns the density in 1/sr of drawing the unit direction wi. */
double bis_light_pdf(const bis_light *light, vec3 wi);

/* bis_light_Le_pdf returns the radiance and stores the density in *pdf. It needs one look-up instead of two and gives
 * the same bits. */
rgb bis_light_Le_pdf(const bis_light *light, vec3 wi, double *pdf);

/* bis_light_mean returns the mean of r+g+b over the sphere. */
double bis_light_mean(const bis_light *light);

/* bis_light_max_ratio returns the largest I/pdf over the sphere, I = r+g+b. Rejection uses it as a bound. */
double bis_light_max_ratio(const bis_light *light);

/* bis_light_max_intensity returns the largest I = r+g+b over the sphere. Rejection uses it as a bound. */
double bis_light_max_intensity(const bis_light *light);

/* bis_light_power returns the integral of r+g+b over the sphere. */
double bis_light_power(const bis_light *light);

/* bis_light_patches returns the number of patches of eq. 3.2: the pixels of a map, or 512 x 256 patches of equal
 * solid angle of a constant. */
size_t bis_light_patches(const bis_light *light);

/* bis_light_patch stores in *s a direction of patch i, its radiance, and s->pdf = 1 / solid angle of the patch. If
 * u[2] is uniform in [0,1)^2, the direction is uniform by solid angle in the patch. */
void bis_light_patch(const bis_light *light, size_t i, const double u[2], bis_light_point *s);

/* bis_light_is_constant returns whether the light is a constant and not a map. */
bool bis_light_is_constant(const bis_light *light);

/* bis_light_is_black returns whether the radiance is 0 everywhere. */
bool bis_light_is_black(const bis_light *light);

/* bis_light_axes stores in axis[3] the x, y and z axes of the map as unit vectors in world space. The light must be a
 * map. */
void bis_light_axes(const bis_light *light, vec3 axis[3]);

/* bis_light_envmap returns the map, or NULL for a constant. For pictures, `bis envmap` and reports, not for
 * integrators. */
const bis_envmap *bis_light_envmap(const bis_light *light);

/* bis_light_importance returns what was built for drawing directions, or NULL if nothing was. Not for integrators. */
const bis_importance *bis_light_importance(const bis_light *light);

/* bis_light_bytes returns the bytes that the light takes. */
size_t bis_light_bytes(const bis_light *light);
