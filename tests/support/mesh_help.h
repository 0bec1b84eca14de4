/* SPDX-License-Identifier: BSD-2-Clause */
/* mesh_help: what the tests of meshes, geometry and accelerators share. Files and scratch names come from
 * image_help. */
#ifndef TESTS_MESH_HELP_H
#define TESTS_MESH_HELP_H

#include "bis/shape/accel.h"
#include "bis/shape/geometry.h"
#include "image_help.h"

/* An accelerator that goes another way than the right one in some of its operations. */
typedef struct accel_twin {
    bis_accel accel;
    const bis_accel *right;
} accel_twin;
bool right_intersect(const bis_accel *a, const ray *r, bis_hit *hit);

/* The grid's triangle test as it once was: the sign of t by sheared coordinates alone. */
bool sheared_occluded(const bis_accel *a, const ray *r);

typedef bis_status mesh_reader(bis_mesh *m, const char *path, bis_loc at, bis_diag *diag);

/* Is the path's shared test file there? Its name (until the next call), or NULL after saying so: then skip(). */
const char *shared_file(const char *name);

/* Reading b must succeed, without a word when text is NULL, else with the one warning `PATH: warning: TEXT`. */
void expect_mesh_of(mesh_reader *read, bis_mesh *m, const bytes *b, const char *name, const char *text);

/* The same, and the mesh in words must be these: "x y z n x y z t u v, ...; a b c, ...", where n is a vertex's normal,
 * t are its texture coordinates ("t none": they are not numbers), and a b c is a triangle. claim: for the message. */
void expect_mesh_words(mesh_reader *read, const bytes *b, const char *name, const char *warning, const char *claim,
                       const char *words);

/* Reading b must fail with BIS_INPUT, an empty mesh and exactly `PATH: error: TEXT`, or `PATH:LINE: error: TEXT` for
 * line > 0. */
void expect_mesh_refusal_of(mesh_reader *read, const bytes *b, const char *name, int line, const char *text);

/* Every prefix of b, and n copies with up to four bytes changed: any status, but no crash, and only sound meshes. */
void try_mesh_damage(mesh_reader *read, const bytes *b, const char *name, int n, uint32_t seed);

/* Fail the k-th allocation for k = 1, 2, ... until reading b works; no mesh and one error before. Returns how many
 * of these errors name a line. */
size_t try_mesh_memory(mesh_reader *read, const bytes *b, const char *name);

/* Indices in range, coordinates finite. */
void assert_sound(const bis_mesh *m);
void assert_triangle(const bis_mesh *m, size_t i, uint32_t a, uint32_t b, uint32_t c);

/* [0, 1), [lo, hi), a point of the cube [lo, hi)^3, x first, and a unit vector. splitmix64. In the arguments of one
 * call gcc draws the last number first, and clang the first. */
double random_double(uint64_t *state);
double random_between(uint64_t *state, double lo, double hi);
vec3 random_point(uint64_t *state, double lo, double hi);
vec3 random_direction(uint64_t *state);

/* A mesh with room for n_vertices and n_triangles, all zero; ends the test without memory. */
bis_mesh new_mesh(size_t n_vertices, size_t n_triangles);

/* A closed convex mesh: the unit sphere, in n rings of 2 n quads each cut in two. */
bis_mesh sphere_mesh(int n);

/* n random triangles in the unit cube, of about this size. */
bis_mesh soup_mesh(size_t n, double size, uint64_t seed);

/* Put the mesh, transformed, into a geometry; m is then empty. */
void add_mesh(bis_geometry *g, bis_mesh *m, const bis_xform *t, uint32_t material);

/* Does the ray's line pass an edge of triangle prim (or its middle, where it is seen edge-on) within so many ulps of
 * the largest coordinate among the ray's origin and the triangle's vertices? Computed in long double: what is so near
 * is a tie, that two sound backends may decide differently. */
bool is_tie(const bis_geometry *g, uint32_t prim, const ray *r, double ulps);

#endif
