/* scene: what was described (bis_scene_desc, filled by the parser and overridden by the command line), and the same
 * built and ready to be asked (bis_scene). Building looks at what the integrator requires and makes that and no more;
 * bis_scene_plan says what and why. */
#ifndef BIS_SCENE_H
#define BIS_SCENE_H

#include "bis/shape/accel.h"
#include "bis/scene/camera.h"
#include "bis/shape/geometry.h"
#include "bis/thesis/integrator.h"
#include "bis/scene/layers.h"
#include "bis/scene/light_load.h"
#include "bis/thesis/sampler.h"
#include "bis/base/status.h"

#include <stdio.h>

typedef enum bis_shape_kind { BIS_SHAPE_PLY, BIS_SHAPE_OBJ, BIS_SHAPE_TRIANGLES, BIS_SHAPE_SPHERE, BIS_SHAPE_DISK } bis_shape_kind;

/* A mesh that shapes use: read once, however many shapes and instances use it. */
typedef struct bis_mesh_desc {
    bis_shape_kind kind; /* PLY, OBJ, TRIANGLES */
    char *filename;      /* PLY, OBJ: resolved path */
    bool smooth;         /* invent vertex normals where the file has none */
    bis_mesh mesh;       /* TRIANGLES */
    bis_loc loc;         /* of the file's name, or of the directive */
} bis_mesh_desc;

/* One shape in the world. An instance of an object is a shape like any other, with a transformation of its own. */
typedef struct bis_shape_desc {
    bis_shape_kind kind;
    uint32_t mesh;         /* PLY, OBJ, TRIANGLES: index into meshes */
    double radius, height; /* SPHERE, DISK */
    bis_xform to_world;
    uint32_t material;     /* index into materials */
    bis_loc loc;
} bis_shape_desc;

typedef struct bis_film_desc {
    int width, height;
    char *filename; /* as written; relative to the working directory, like pbrt */
    double crop[4]; /* x0, x1, y0, y1 */
    unsigned layers; /* a set of bis/layers.h */
} bis_film_desc;

enum { BIS_MAX_EXCEPTIONS = 3 };

/* Materials that are rendered with other settings than the rest. */
typedef struct bis_exceptions {
    int n;
    bis_settings settings[BIS_MAX_EXCEPTIONS];
    bis_loc loc[BIS_MAX_EXCEPTIONS];
    unsigned char *of_material; /* of_material[n_materials]: 0: as the rest, k: settings[k - 1]; NULL where n is 0; owned */
} bis_exceptions;

typedef struct bis_scene_desc {
    char *path;
    bis_camera camera;
    bis_film_desc film;
    bis_sampler sampler;
    bool pixel_jitter;
    bool adaptive; /* passes of several camera samples, more where the error is */
    uint32_t edge_samples; /* camera samples in a pass where an outline crosses the pixel (src/render/edges.h); 0 or 1: as everywhere */
    bis_settings settings;     /* of all materials but the exceptions */
    bis_exceptions exceptions;
    bis_loc integrator_loc;
    unsigned light_needs; /* BIS_NEED_*: what to build of the light, for who asks more of it than one integrator; 0: what the integrators need */
    bis_accel_options accel;
    bool has_light;
    bis_light_desc light;
    bis_material *materials;
    size_t n_materials, capacity_materials;
    bis_mesh_desc *meshes;
    size_t n_meshes, capacity_meshes;
    bis_shape_desc *shapes;
    size_t n_shapes, capacity_shapes;
    char **files; /* names that bis_locs point into; owned */
    size_t n_files, capacity_files;
} bis_scene_desc;

/* Read a scene file. Errors go to diag, several in one go; the status is that of the first. A desc is only handed out
 * without errors. seconds: none of this builds anything. */
bis_status bis_scene_parse(bis_scene_desc **out, const char *path, bis_diag *diag);
void bis_scene_desc_free(bis_scene_desc *d);

/* spp >= 1 camera samples a pixel; the stratified sampler gets the most square xsamples x ysamples = spp. For the
 * parser and the command line. */
void bis_scene_set_spp(bis_scene_desc *d, uint32_t spp);

/* Methods: 0 is desc->settings, k the exception k - 1. */
const bis_settings *bis_scene_settings(const bis_scene_desc *d, int method);
int bis_scene_method_of(const bis_scene_desc *d, uint32_t material);

/* Does a shape have it? Without exceptions: yes. */
bool bis_scene_uses_method(const bis_scene_desc *d, int method);

/* BIS_NEED_* of all methods in use. */
unsigned bis_scene_light_needs(const bis_scene_desc *d);

/* All materials by desc->settings from now on, for who renders with settings of his own; with a warning, unless what
 * ("bis trade", say) is NULL. Nothing happens where there are no exceptions. */
void bis_scene_drop_exceptions(bis_scene_desc *d, const char *what, bis_diag *diag);

/* Materials have numbers: different ones (by value) in the order in which shapes first use them, from 0.
 * (*number)[n_materials], by bis_alloc; BIS_NO_NUMBER: no shape uses it. Cost: n log n. Errors: BIS_NOMEM. */
#define BIS_NO_NUMBER UINT32_MAX
bis_status bis_scene_number_materials(uint32_t **number, uint32_t *n_numbers, const bis_scene_desc *d, bis_diag *diag);

typedef struct bis_scene_seconds {
    double parse, load, envmap, accel, render, write, total;
} bis_scene_seconds;

typedef struct bis_scene {
    bis_geometry geometry;
    bis_accel *accel; /* NULL: no geometry */
    bis_light *light; /* a black constant where the scene has none */
    size_t *shape_end; /* shape_end[n_shapes]: triangles of the shapes up to and including this one */
    bis_scene_seconds seconds;
} bis_scene;

/* Load meshes and map, build what desc's settings need. desc is borrowed for the life of the scene. Errors: those of the
 * loaders and of bis_scene_accel. */
bis_status bis_scene_build(bis_scene **out, const bis_scene_desc *desc, bis_diag *diag);
void bis_scene_free(bis_scene *s);

/* An accelerator over the scene's geometry, of this kind, for desc's camera: as bis_scene_build makes it. Errors: those
 * of bis_accel_new; a camera that stands beyond the largest float (BIS_INPUT). */
bis_status bis_scene_accel(bis_accel **out, const bis_scene *s, const bis_scene_desc *desc, bis_accel_kind kind, bis_diag *diag);

/* The shape (an index into desc->shapes) that primitive prim of the geometry belongs to; *part: its triangle there,
 * from 0; 0 for a sphere or disk. */
size_t bis_scene_shape_of(const bis_scene *s, const bis_scene_desc *desc, uint32_t prim, size_t *part);

/* Print what the scene requires, what will be built for it, what is left out, and why. Loads nothing: sizes come from
 * the files' headers where cheap. */
void bis_scene_plan(const bis_scene_desc *desc, FILE *out);

#endif
