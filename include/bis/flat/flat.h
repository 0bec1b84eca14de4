/* SPDX-License-Identifier: BSD-2-Clause */
/* flat: bis for other languages, by numbers, arrays and text alone. scripts/python/bis is its Python face.
 *
 * A language that calls C by hand-written declarations (ctypes in Python, ccall in Julia) would have to repeat the
 * layout of every struct, and a field that is out of place is read as rubbish without a message. So no struct crosses
 * this line: what must live longer is a pointer that the caller does not look into. There is nothing here that the
 * other headers do not have; a program in C may prefer those.
 *
 * A function that returns int returns a bis_status: 0 is success, 1 a failure of the disk, 2 no memory, 3 a mistake
 * in the input. It writes its messages to say[size], one a line, cut to the size; after a success these are warnings.
 * Arrays are dense, in the order of C. Values in arrays are checked, because the caller is no C compiler: a NaN must
 * not become an index. NULL where something is due is BIS_INPUT; an array of no items may be NULL, and so may say. What
 * is opened is NULL after a failure. A function without a status takes a NULL in the place of what was opened, too: its
 * shape is 0 x 0, it has no pixels, its power is NaN and its text NULL. It does nothing where the array that it should
 * fill is NULL.
 *
 * A prototype and the shapes in its comment, as u[n][4], are the one place where a signature stands: src/flat/face.awk
 * makes the checks for NULL of it, and what bis_flat_signatures tells other languages. */
#pragma once

#include "bis/thesis/bsdf.h"
#include "bis/thesis/light.h"

#include <signal.h>
#include <stddef.h>
#include <stdint.h>

/* bis_flat_version returns the version of bis, "0.1.0". */
const char *bis_flat_version(void);

/* bis_flat_build returns a sum over all code of this build, "1dcf2a98-6914384". A program and a library of one build
 * have the same one: make writes it. */
const char *bis_flat_build(void);

/* bis_flat_said stores in say[size] all messages of this thread's last call, where its own say was too short, and
 * forgets them. It returns the size that they need; 0: nothing was cut. say may be NULL, to learn it. */
size_t bis_flat_said(char *say, size_t size);

/* bis_flat_signatures returns a line for each function of these headers:
 *
 *     bis_flat_light_sample s light:h n:n u:d[n] w:F[n] L:F[n] pdf:D[n]
 *
 * Behind its name stands what it returns, then each argument with its name. Returned: s a status, v nothing, z a
 * text, and i, n and r as below. ~ before it: the last bits are those of the C library. After the arguments of a
 * function with a status come say and size. Taken: i int, n size_t, k uint32_t, q uint64_t, r double; z a text, l a
 * list of texts that ends with NULL; d double, f float, u uint32_t, b uint8_t, w uint64_t: an array that is read; D,
 * F, U, B, W, and I int, N size_t, T a text: one that is written; O a pointer that receives what is opened, h what
 * was opened; p a pointer for C alone: NULL. [n]: it may be NULL where the argument n is 0. ?: it may be NULL. */
const char *bis_flat_signatures(void);

/* ---- maps ---- */

/* bis_flat_light_open reads a map for drawing directions by its importance. kind is "alias" or "cdf"; area_exponent
 * is b of thesis 3.4, in [0, BIS_AREA_EXPONENT_MAX]. mapping (may be NULL: as in a scene that does not say it) says how
 * the picture covers the sphere: "latlong", "angular" and the others of bis_mapping_names. The frame is the map's own,
 * z up. Errors: those of bis_light_load, BIS_INPUT (kind, area_exponent, mapping). */
int bis_flat_light_open(bis_light **light, const char *path, const char *kind, double area_exponent,
                        const char *mapping, char *say, size_t size);

/* bis_flat_light_make does the same with radiance in pixels[height][width][3], row 0 at the top, which is copied.
 * mapping (may be NULL) is as above.
 * Values that a file may hold are accepted as there: NaN, infinite and negative ones become 0, with a warning. Errors:
 * BIS_INPUT (a side below 1 or above BIS_IMAGE_MAX_SIDE), too. */
int bis_flat_light_make(bis_light **light, int width, int height, const float *pixels, const char *kind,
                        double area_exponent, const char *mapping, char *say, size_t size);

/* bis_flat_light_close frees the map; NULL is allowed. */
void bis_flat_light_close(bis_light *light);

/* bis_flat_light_shape stores width and height of the map in pixels. */
void bis_flat_light_shape(const bis_light *light, int shape[2]);

/* bis_flat_light_pixels stores the radiance in pixels[height][width][3]. */
void bis_flat_light_pixels(const bis_light *light, float *pixels);

/* bis_flat_light_power returns the integral of r+g+b over the sphere. */
double bis_flat_light_power(const bis_light *light);

/* bis_flat_light_sample draws n directions w[n][3] from u[n][4], which is uniform in [0,1). L[n][3] receives the
 * radiance, pdf[n] the density in 1/sr. Errors: BIS_INPUT (u outside [0,1), a map without light). */
int bis_flat_light_sample(const bis_light *light, size_t n, const double *u, float *w, float *L, double *pdf,
                          char *say, size_t size);

/* bis_flat_light_look stores the radiance L[n][3] from the directions w[n][3], of any length but 0, and the density
 * pdf[n] of drawing them. Errors: BIS_INPUT (w is 0 or not finite). */
int bis_flat_light_look(const bis_light *light, size_t n, const float *w, float *L, double *pdf, char *say,
                        size_t size);

/* ---- alias tables ---- */

/* bis_flat_alias_build fills the tables prob[n] and alias[n] for weights w[n]; *total receives their sum. Errors:
 * BIS_INPUT (n is 0 or above 2^32 - 1, a weight is negative or not finite, all are 0), BIS_NOMEM. */
int bis_flat_alias_build(size_t n, const double *w, double *prob, uint32_t *alias, double *total, char *say,
                         size_t size);

/* bis_flat_alias_sample draws item[m] by the tables prob[n] and alias[n] from u[m], which is uniform in [0,1). It
 * looks at the whole tables first, in O(n + m). Errors: BIS_INPUT (u outside [0,1), n is 0 or above 2^32 - 1, a prob
 * outside [0,1], an alias not below n). */
int bis_flat_alias_sample(size_t n, const double *prob, const uint32_t *alias, size_t m, const double *u,
                          uint32_t *item, char *say, size_t size);

/* ---- materials ---- */

/* bis_flat_bsdf_open makes a material at a point. model is "phong" or "microfacet" (GGX); width is the exponent or
 * the roughness; Kd[3] and Ks[3] are in [0,1]; normal[3] and wo[3] have any length but 0. Errors: BIS_INPUT (a value
 * out of range), BIS_NOMEM. */
int bis_flat_bsdf_open(bis_bsdf **bsdf, const char *model, const double *Kd, const double *Ks, double width,
                       const double *normal, const double *wo, char *say, size_t size);

/* bis_flat_bsdf_metal makes a metal: facets that reflect by Fresnel's equations with the index eta[3] + i k[3] of R, G
 * and B, eta in (0, 1e15], k in [0, 1e15]. roughness, normal[3] and wo[3] are as those of bis_flat_bsdf_open. Errors:
 * BIS_INPUT (a value out of range), BIS_NOMEM. */
int bis_flat_bsdf_metal(bis_bsdf **bsdf, const double *eta, const double *k, double roughness, const double *normal,
                        const double *wo, char *say, size_t size);

/* bis_flat_bsdf_read makes a material of its text in a scene, as Material "coateddiffuse" "rgb reflectance" [.5 .4
 * .3]. normal[3] and wo[3] are as those of bis_flat_bsdf_open. Errors: those of bis_scene_parse, BIS_INPUT (a
 * texture, because a material on arrays has no place), BIS_NOMEM. */
int bis_flat_bsdf_read(bis_bsdf **bsdf, const char *text, const double *normal, const double *wo, char *say,
                       size_t size);

/* bis_flat_bsdf_close frees the material; NULL is allowed. */
void bis_flat_bsdf_close(bis_bsdf *bsdf);

/* bis_flat_bsdf_sample draws n directions wi[n][3] from u[n][3], which is uniform in [0,1). lobe[n] receives 1 where a
 * direction comes from the specular lobe, and 0 elsewhere. Errors: BIS_INPUT (u outside [0,1), a black material). */
int bis_flat_bsdf_sample(const bis_bsdf *bsdf, size_t n, const double *u, float *wi, uint8_t *lobe, char *say,
                         size_t size);

/* bis_flat_bsdf_look stores f[n][3] in 1/sr, without the cosine, and the density pdf[n] of drawing wi[n][3], which
 * has any length but 0. The last bits are those of libm. Errors: BIS_INPUT (wi is 0 or not finite). */
int bis_flat_bsdf_look(const bis_bsdf *bsdf, size_t n, const float *wi, float *f, double *pdf, char *say,
                       size_t size);

/* ---- pictures ---- */

typedef struct bis_flat_picture bis_flat_picture;

/* bis_flat_render renders a scene into memory. settings is a list of "name=value" that ends with NULL; what it does not
 * name is as the scene says. The names are integrator, accelerator (grid, embree), spp, seed, seconds, error, threads,
 * width, height, the parameters of the integrator (`bis help integrators`), and
 *
 *   text         the scene itself: scene then only names it in messages, and its files are looked for in scene's folder
 *   camera       a camera in the place of the scene's, in the scene's words: LookAt 0 -5 1 0 0 0 0 0 1 Camera "..."
 *   approximate  true: what of pbrt bis does not model is replaced by the nearest that it does (docs/scene-format.md)
 *   crop         x0,x1,y0,y1 in shares of the picture, as --cropwindow
 *   layers       albedo,normal,... or all, as --layers: bis_flat_picture_layer gives them
 *
 * *stop (may be NULL), an int, is set from another thread to end the render soon; the picture then has the passes that
 * were complete. Errors: those of bis_scene_parse, bis_scene_build and bis_render, BIS_INPUT (a name or value of the
 * settings). */
int bis_flat_render(bis_flat_picture **picture, const char *scene, const char *const *settings,
                    const volatile sig_atomic_t *stop, char *say, size_t size);

/* bis_flat_watcher hears of a render under way, a few times a second, from a thread of the library: the share of the
 * budget that is used, in [0,1], the seconds of rendering, and the seconds that are left (NaN: unknown). */
typedef void bis_flat_watcher(double share, double seconds, double seconds_left, void *user);

/* bis_flat_render_with does the same under another light, and tells how far it is. The radiance of light (may be
 * NULL: the scene's own) takes the place of all lights of the scene, upright as with --light; how directions are drawn
 * from it is as the scene says. watcher (may be NULL) is given user. Errors: those of bis_flat_render. */
int bis_flat_render_with(bis_flat_picture **picture, const char *scene, const char *const *settings,
                         const bis_light *light, bis_flat_watcher *watcher, void *user,
                         const volatile sig_atomic_t *stop, char *say, size_t size);

/* bis_flat_picture_close frees the picture; NULL is allowed. */
void bis_flat_picture_close(bis_flat_picture *picture);

/* bis_flat_picture_shape stores width and height in pixels. */
void bis_flat_picture_shape(const bis_flat_picture *picture, int shape[2]);

/* bis_flat_picture_pixels stores the radiance and the share of samples that hit a surface in rgba[height][width][4]. */
void bis_flat_picture_pixels(const bis_flat_picture *picture, float *rgba);

/* bis_flat_layer_name returns the name of the i-th layer, counted from 0, or NULL if there are fewer. */
const char *bis_flat_layer_name(int i);

/* bis_flat_picture_layer stores the layer of this name (docs/trust.md, "Layers") in values[height][width][n] and
 * returns n, 1 or 3. values may be NULL, to learn n. It returns 0 if the picture does not have the layer: it was not
 * asked for, or a standard error would need more passes. */
int bis_flat_picture_layer(const bis_flat_picture *picture, const char *name, float *values);

/* bis_flat_picture_stats returns what `bis --stats` writes, as JSON. It belongs to the picture. */
const char *bis_flat_picture_stats(const bis_flat_picture *picture);
