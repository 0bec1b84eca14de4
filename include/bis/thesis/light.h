/* light: what shines from infinity, in world space: an environment map or a constant. An integrator asks it for Le, a
 * sample, a density, and never learns which of the two it is, nor where the pixels came from. */
#ifndef BIS_LIGHT_H
#define BIS_LIGHT_H

#include "bis/base/status.h"
#include "bis/base/vec.h"

#include <stdbool.h>
#include <stddef.h>

/* What an integrator needs of the light; the scene builds that and no more. */
enum {
    BIS_NEED_TABLE = 1,     /* bis_light_sample */
    BIS_NEED_CURVE = 2,     /* bis_light_sample_curve */
    BIS_NEED_COMPENSATED = 4 /* with BIS_NEED_TABLE: MIS compensation */
};

typedef struct bis_light bis_light;

/* bis/thesis/envmap.h, bis/thesis/importance.h and bis/base/xform.h: for those who make a light. */
typedef struct bis_envmap bis_envmap;
typedef struct bis_importance bis_importance;
typedef struct bis_importance_options bis_importance_options;
typedef struct bis_xform bis_xform;

/* Direction towards the light, its radiance from there, its density. */
typedef struct bis_light_point {
    vec3 wi;
    rgb Le;
    double pdf;
} bis_light_point;

/* bis_light_new makes a light of a map. It takes over em, which is empty afterwards, on failure too. to_world is the
 * map's frame in the world: a rotation or reflection, to BIS_XFORM_FRAME_TOLERANCE; it is made exactly orthonormal.
 * importance: what to build for drawing directions; NULL: nothing, the light can then only be looked up.
 * Errors: BIS_NOMEM. */
bis_status bis_light_new(bis_light **out, bis_envmap *em, const bis_xform *to_world, const bis_importance_options *importance,
                         bis_diag *diag);

/* bis_light_constant makes a light of the same radiance L from everywhere; L finite and >= 0. Errors: BIS_NOMEM. */
bis_status bis_light_constant(bis_light **out, rgb L, bis_diag *diag);
void bis_light_free(bis_light *light);

/* Radiance that arrives from unit world direction wi. */
rgb bis_light_Le(const bis_light *light, vec3 wi);

/* Draw a direction by the light's importance over the whole sphere (docs/errata.md E1). u as bis_importance_sample.
 * False: no light. A constant: uniform over the sphere by u[0] and u[1] alone. */
bool bis_light_sample(const bis_light *light, const double u[4], bis_light_point *s);
bool bis_light_sample_curve(const bis_light *light, double t, const double u[2], bis_light_point *s);
double bis_light_pdf(const bis_light *light, vec3 wi);

/* Radiance and density at once: one lookup instead of two, the same bits. */
rgb bis_light_Le_pdf(const bis_light *light, vec3 wi, double *pdf);

/* Mean radiance over the sphere, r+g+b. */
double bis_light_mean(const bis_light *light);

/* Bounds for rejection: the largest I/pdf, and the largest I, I = r+g+b. */
double bis_light_max_ratio(const bis_light *light);
double bis_light_max_intensity(const bis_light *light);

/* Integral of r+g+b over the sphere. */
double bis_light_power(const bis_light *light);

/* The patches of eq. 3.2: pixels of a map, 512 x 256 of equal solid angle of a constant. */
size_t bis_light_patches(const bis_light *light);

/* A direction uniform in patch i at u, its radiance, and the patch's solid angle (s->pdf = 1 / solid angle). */
void bis_light_patch(const bis_light *light, size_t i, const double u[2], bis_light_point *s);

bool bis_light_is_constant(const bis_light *light);
bool bis_light_is_black(const bis_light *light);

/* bis_light_axes gives the axes of the map in the world, unit vectors: what its x, y and z axes are turned to. Not of a
 * constant. */
void bis_light_axes(const bis_light *light, vec3 axis[3]);

/* NULL for a constant. For pictures, `bis envmap` and reports, not for integrators. */
const bis_envmap *bis_light_envmap(const bis_light *light);
const bis_importance *bis_light_importance(const bis_light *light);
size_t bis_light_bytes(const bis_light *light);

#endif
