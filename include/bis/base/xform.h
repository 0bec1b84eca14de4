/* xform: affine (and, for cameras, projective) transformations with their inverses, in double, column vectors, with
 * pbrt's conventions: left-handed world, Rotate in degrees, LookAt maps world to camera. */
#ifndef BIS_XFORM_H
#define BIS_XFORM_H

#include "bis/base/vec.h"

/* m[row][column]; p' = m p. inv is m's inverse. */
typedef struct bis_xform {
    double m[4][4], inv[4][4];
} bis_xform;

bis_xform bis_xform_identity(void);
bis_xform bis_xform_translate(double x, double y, double z);

/* None of x, y, z may be 0 (the caller's check: it can name the place). */
bis_xform bis_xform_scale(double x, double y, double z);

/* degrees about the axis (x, y, z), which must not be the zero vector. */
bis_xform bis_xform_rotate(double degrees, double x, double y, double z);

/* World to camera. Returns false when eye = look or up is parallel to the view: no such camera. */
bool bis_xform_look_at(bis_xform *out, const double eye[3], const double look[3], const double up[3]);

/* From 16 numbers column by column, pbrt's argument order (the translation is numbers 13-15). False: singular, judged
 * by a determinant of 0 or a non-finite inverse. */
bool bis_xform_from_columns(bis_xform *out, const double v[16]);

/* a after b: (a b) p = a (b p). */
bis_xform bis_xform_compose(const bis_xform *a, const bis_xform *b);
bis_xform bis_xform_inverse(const bis_xform *t);

vec3 bis_xform_point(const bis_xform *t, vec3 p);
vec3 bis_xform_vector(const bis_xform *t, vec3 v);

/* Normals go by the inverse transpose; the result is not normalised. */
vec3 bis_xform_normal(const bis_xform *t, vec3 n);

/* bis_xform_is_orthonormal tells whether the linear part is a rotation or a reflection, to `tolerance` in every
 * element of m^T m - 1. */
bool bis_xform_is_orthonormal(const bis_xform *t, double tolerance);

/* How far m^T m of a frame in a scene file may be from 1. Exporters write matrices with few digits. Three digits after
 * the point, rounded, give an error of up to 2 sqrt(3) 0.0005 = 0.0017. */
#define BIS_XFORM_FRAME_TOLERANCE 2e-3

/* bis_xform_rotation returns the rotation or reflection that is nearest in the sense of Gram and Schmidt: the columns of
 * t in their order, made exactly orthonormal, without the translation. The handedness is kept, so a reflection stays
 * one. t must be orthonormal to BIS_XFORM_FRAME_TOLERANCE. */
bis_xform bis_xform_rotation(const bis_xform *t);

#endif
