/* SPDX-License-Identifier: BSD-2-Clause */
/* xform: affine transformations with their inverses, in double; for cameras also projective ones. Vectors are
 * columns. The conventions are pbrt's: the world is left-handed, Rotate takes degrees, LookAt maps world to camera. */
#pragma once

#include "bis/base/vec.h"

/* m[row][column]; p' = m p. inv is the inverse of m. */
typedef struct bis_xform {
    double m[4][4], inv[4][4];
} bis_xform;

/* bis_xform_identity returns the transformation that changes nothing. */
bis_xform bis_xform_identity(void);

/* bis_xform_translate returns the translation by (x, y, z). */
bis_xform bis_xform_translate(double x, double y, double z);

/* bis_xform_scale returns the scaling by x, y and z. None of them may be 0: the caller checks this, because the
 * caller can name the place in the scene. */
bis_xform bis_xform_scale(double x, double y, double z);

/* bis_xform_rotate returns the rotation by `degrees` about the axis (x, y, z). The axis must not be the zero vector. */
bis_xform bis_xform_rotate(double degrees, double x, double y, double z);

/* bis_xform_look_at stores in *out the transformation from world to camera space. Returns false if eye = look or if
 * up is parallel to the view, because such a camera does not exist. */
bool bis_xform_look_at(bis_xform *out, const double eye[3], const double look[3], const double up[3]);

/* bis_xform_from_columns makes a transformation from 16 numbers column by column, in pbrt's argument order (the
 * translation is v[12] to v[14]). A matrix whose last row is 0 0 0 w, up to rounding, is divided by w. Returns false if
 * the matrix is singular: its determinant is 0 or its inverse not finite. */
bool bis_xform_from_columns(bis_xform *out, const double v[16]);

/* bis_xform_is_affine returns whether the last row is 0 0 0 1: t keeps parallels. */
bool bis_xform_is_affine(const bis_xform *t);

/* bis_xform_compose returns a after b: (a b) p = a (b p). */
bis_xform bis_xform_compose(const bis_xform *a, const bis_xform *b);

/* bis_xform_inverse returns the inverse of t. */
bis_xform bis_xform_inverse(const bis_xform *t);

/* bis_xform_point transforms a point. */
vec3 bis_xform_point(const bis_xform *t, vec3 p);

/* bis_xform_vector transforms a vector: the translation has no effect. */
vec3 bis_xform_vector(const bis_xform *t, vec3 v);

/* bis_xform_normal transforms a normal by the inverse transpose. The result is not normalised. */
vec3 bis_xform_normal(const bis_xform *t, vec3 n);

/* bis_xform_is_orthonormal returns whether the linear part is a rotation or a reflection: no element of m^T m - 1
 * exceeds `tolerance`. */
bool bis_xform_is_orthonormal(const bis_xform *t, double tolerance);

/* How far m^T m of a frame in a scene file may be from 1. Exporters write matrices with few digits: three digits
 * after the point, rounded, give an error of up to 2 sqrt(3) 0.0005 = 0.0017. */
#define BIS_XFORM_FRAME_TOLERANCE 2e-3

/* bis_xform_rotation returns the nearest rotation or reflection in the sense of Gram and Schmidt: it makes the
 * columns of t exactly orthonormal in their order, and drops the translation. The handedness is kept, so a reflection
 * stays a reflection. t must be orthonormal to BIS_XFORM_FRAME_TOLERANCE. */
bis_xform bis_xform_rotation(const bis_xform *t);
