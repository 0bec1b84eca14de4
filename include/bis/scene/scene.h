/* SPDX-License-Identifier: BSD-2-Clause */
/* scene: the description of a scene (bis_scene_desc), which the parser fills and the command line changes, and the
 * same scene built (bis_scene). Building looks at what the integrator needs and makes only that. bis_scene_plan
 * prints what is built and why. */
#pragma once

#include "bis/shape/accel.h"
#include "bis/shape/make.h"
#include "bis/scene/camera.h"
#include "bis/shape/geometry.h"
#include "bis/scene/parameters.h"
#include "bis/thesis/integrator.h"
#include "bis/scene/layers.h"
#include "bis/scene/light_load.h"
#include "bis/scene/texture.h"
#include "bis/thesis/sampler.h"
#include "bis/base/status.h"

#include <stdio.h>

typedef enum bis_shape_kind {
    BIS_SHAPE_PLY,
    BIS_SHAPE_OBJ,
    BIS_SHAPE_TRIANGLES,
    BIS_SHAPE_SPHERE,
    BIS_SHAPE_DISK
} bis_shape_kind;

/* bis_shape_is_mesh returns whether a shape of this kind is made of triangles. */
static inline bool bis_shape_is_mesh(bis_shape_kind kind) { return kind != BIS_SHAPE_SPHERE && kind != BIS_SHAPE_DISK; }

/* How the mesh of a shape comes about when the scene is built. A description and a plan are small. */
typedef enum bis_making {
    BIS_MAKING_NONE,      /* it is there */
    BIS_MAKING_REVOLVED,
    BIS_MAKING_SUBDIVIDED /* of it, by so many levels */
} bis_making;

/* A mesh of a file or of the scene. It is read once, however many shapes and instances use it. */
typedef struct bis_mesh_desc {
    bis_shape_kind kind; /* PLY, OBJ, TRIANGLES */
    char *filename;      /* PLY, OBJ: resolved path */
    bool smooth;         /* compute vertex normals if the file has none */
    double fit;          /* PLY, OBJ: above 0: it stands on the origin, and its longest side is this */
    bool is_y_up;        /* with fit: turned, so that its y is z */
    bool has_parts;      /* OBJ: its shapes are its parts, see bis_shape_desc.part */
    size_t n_parts;      /* names of materials that the file had when it was described */
    bis_mesh mesh;       /* TRIANGLES */
    bis_making making;
    bis_revolved revolved;
    bool lacks_uv;       /* REVOLVED: no texture asks for (u, v) */
    uint32_t levels;
    bis_made_size size;  /* TRIANGLES: of what is built */
    bis_loc loc;         /* the place of the file's name, or of the directive */
} bis_mesh_desc;

/* bis_mesh_desc_make makes the mesh that no file holds: as it is (a copy), of a formula, or subdivided. The caller
 * clears *m, after an error, too. Errors: BIS_NOMEM. */
bis_status bis_mesh_desc_make(bis_mesh *m, const bis_mesh_desc *desc, bis_diag *diag);

/* One shape in the world. An instance of an object is a shape like any other, with its own transformation. */
typedef struct bis_shape_desc {
    bis_shape_kind kind;
    uint32_t mesh;         /* PLY, OBJ, TRIANGLES: index into meshes */
    uint32_t part;         /* OBJ that has_parts: the part of the mesh that this shape is */
    double radius, height; /* SPHERE, DISK */
    bis_xform to_world;
    uint32_t material;     /* index into materials */
    bis_loc loc;
} bis_shape_desc;

typedef struct bis_film_desc {
    int width, height;
    double crop[4]; /* x0, x1, y0, y1 */
    unsigned layers; /* a set of bis/scene/layers.h */
} bis_film_desc;

/* The film of a scene that says nothing of it, and the name of its picture. */
extern const bis_film_desc bis_film_default;
#define BIS_FILM_FILENAME "bis.exr"

/* What one wants to see of a scene, and how: a plain value that owns nothing, made to be copied and changed. */
typedef struct bis_view {
    bis_camera camera;
    bis_film_desc film;
    bis_sampler sampler;
    bool pixel_jitter;
    /* camera samples of a pass in a pixel that an outline crosses; half as many where a lobe turns away
     * (src/render/edges.h); 0, 1: as in other pixels */
    uint32_t edge_samples;
    double edge_light; /* in (0,1]: the share of a camera sample's light samples that each of these has; 0: all */
    bis_settings settings;
} bis_view;

/* What a replacement does to the picture, the largest effect first. */
typedef enum bis_effect {
    BIS_EFFECT_SKY,      /* a light that the scene does not have */
    BIS_EFFECT_INDIRECT, /* light from surface to surface is missing */
    BIS_EFFECT_LIGHT,    /* a light is missing, or is another one */
    BIS_EFFECT_SHAPE,
    BIS_EFFECT_MATERIAL,
    BIS_EFFECT_TEXTURE,
    BIS_EFFECT_SETTING,
    BIS_N_EFFECTS
} bis_effect;

/* What --approximate has replaced (src/parse/approximate.c): n things of one kind, as `Material "glass"`, and what the
 * picture lacks by it. */
enum { BIS_APPROXIMATION_KIND = 160, BIS_APPROXIMATION_TEXT = 512 };
typedef struct bis_approximation {
    char kind[BIS_APPROXIMATION_KIND];
    const char *consequence;
    bis_effect effect;
    size_t n;
    size_t of; /* so many the scene has of `among` ("shapes"); 0: that says nothing */
    const char *among;
    bis_loc loc; /* of the first */
} bis_approximation;

/* bis_approximation_text writes `3 x Shape "cone" (of 12 shapes): CONSEQUENCE` and returns text. What a scene has once,
 * its sky and its integrator, has no number. */
const char *bis_approximation_text(char text[BIS_APPROXIMATION_TEXT], const bis_approximation *a);

/* A scene as its file describes it. It owns what its pointers point to: never copy it by =. */
typedef struct bis_scene_desc {
    char *path;
    bis_view view; /* the file's own */
    char *outfile; /* of its Film, as written; relative to the working directory, as in pbrt */
    bis_loc integrator_loc;
    bool names_integrator; /* false: view.settings are those of bis_settings_unnamed */
    /* BIS_NEED_*: what to build of the light, for a caller that needs more of it than one integrator does; 0: what
     * the integrator needs */
    unsigned light_needs;
    bis_accel_options accel;
    bool has_light;
    bis_light_desc light;
    bis_xform upright; /* the frame of a map in a scene that has none: z along the camera's "up" */
    bis_material *materials;
    size_t n_materials, capacity_materials;
    bis_textures textures;
    bis_mesh_desc *meshes;
    size_t n_meshes, capacity_meshes;
    bis_shape_desc *shapes;
    size_t n_shapes, capacity_shapes;
    char **files; /* the names that bis_locs point to; owned */
    size_t n_files, capacity_files;
    bis_approximation *approximations; /* by their effect, then in the order of the scene */
    size_t n_approximations, capacity_approximations;
    char version[256]; /* of pbrt, and what says so */
    char **missing; /* meshes and maps that are not there (BIS_PARSE_LIST_MISSING); owned */
    size_t n_missing, capacity_missing;
} bis_scene_desc;

/* bis_scene_parse reads a scene file. It continues after a mistake: diag receives all errors, and the status is that
 * of the first. *out is NULL if there was an error. It loads neither meshes nor maps. */
bis_status bis_scene_parse(bis_scene_desc **out, const char *path, bis_diag *diag);

/* How bis_scene_parse_as reads a scene; a set. */
enum {
    BIS_PARSE_APPROXIMATE = 1,  /* as if it began with Option "bool approximate" true */
    BIS_PARSE_LIST_MISSING = 2, /* meshes and maps may be missing: they are listed, for a plan */
    /* the scene's lights are passed over, because another takes their place: the light is a constant 1 whose frame
     * stands upright in the scene */
    BIS_PARSE_OTHER_LIGHT = 4,
};

/* bis_scene_parse_as does what bis_scene_parse does, in the way that `how` says. */
bis_status bis_scene_parse_as(bis_scene_desc **out, const char *path, unsigned how, bis_diag *diag);

/* bis_scene_parse_text does the same with text in the place of the file, where text is not NULL. path then is what
 * messages call it, and files are looked for in its folder: "scene" is in the working directory. */
bis_status bis_scene_parse_text(bis_scene_desc **out, const char *path, const char *text, unsigned how,
                                bis_diag *diag);

/* bis_scene_name_integrator takes another integrator, with its default settings, for the scene's. One that the scene
 * names itself keeps the scene's settings. as_printed stays, because an Option sets it. at: for messages. */
void bis_scene_name_integrator(bis_scene_desc *d, const bis_integrator *integrator, bis_loc at);

/* bis_scene_check_files looks at the head of each map, mesh and image that a render of the scene would read, and at the
 * textures that need no image. diag receives all that would stop the render, as far as it can be known without reading
 * the files whole. Files that are not there are left to the parser. It returns the status of the first error. */
bis_status bis_scene_check_files(const bis_scene_desc *desc, bis_diag *diag);

/* bis_scene_desc_free frees a description; NULL is allowed. */
void bis_scene_desc_free(bis_scene_desc *d);

/* The number of a material that no shape uses. */
#define BIS_NO_NUMBER UINT32_MAX

/* bis_scene_number_materials gives numbers to the materials: materials with different values get different numbers,
 * from 0, in the order in which shapes first use them. (*number)[n_materials] comes from bis_alloc; BIS_NO_NUMBER
 * means that no shape uses the material. Cost: n log n. Errors: BIS_NOMEM. */
bis_status bis_scene_number_materials(uint32_t **number, uint32_t *n_numbers, const bis_scene_desc *d, bis_diag *diag);

typedef struct bis_scene_seconds {
    double parse, load, envmap, accel, render, write, total;
} bis_scene_seconds;

typedef struct bis_scene {
    const bis_scene_desc *desc; /* which it was built of; borrowed */
    bis_geometry geometry;
    bis_accel *accel; /* NULL: no geometry */
    bis_light *light; /* a black constant where the scene has none */
    /* images[n_images]: of desc->textures.files, those that a shape shows; others are empty */
    bis_texture_image *images;
    size_t n_images;
    size_t *shape_end; /* shape_end[n_shapes]: the number of triangles of all shapes up to and including this one */
    bis_scene_seconds seconds;
} bis_scene;

/* bis_scene_build loads the meshes and the map and builds what desc's settings need. desc is borrowed for the life of
 * the scene. Errors: those of the loaders and of bis_scene_accel. */
bis_status bis_scene_build(bis_scene **out, const bis_scene_desc *desc, bis_diag *diag);

/* bis_scene_free frees the scene; NULL is allowed. */
void bis_scene_free(bis_scene *s);

/* How large a scene is, for reports. */
typedef struct bis_scene_figures {
    uint64_t triangles;
    char accelerator[16];        /* its name; "": there is no geometry */
    double mesh, accel, envmap;  /* bytes; NAN: there is none */
} bis_scene_figures;

/* bis_scene_figures_of returns the figures of a scene that has been built. */
bis_scene_figures bis_scene_figures_of(const bis_scene *s);

/* bis_scene_accel makes an accelerator of this kind over the scene's geometry, for desc's camera, as bis_scene_build
 * does. Errors: those of bis_accel_new; BIS_INPUT if the camera stands beyond the largest float. */
bis_status bis_scene_accel(bis_accel **out, const bis_scene *s, const bis_scene_desc *desc, bis_accel_kind kind,
                           bis_diag *diag);

/* bis_scene_accel_suits returns whether the accelerator of a scene that was built serves desc's camera, too: where rays
 * start decides which one is the default. */
bool bis_scene_accel_suits(const bis_scene *s, const bis_scene_desc *desc);

/* The material of a point. Where it has textures, the point's bsdf points to `own`, so that this lives as long. */
typedef struct bis_own_material {
    uint32_t index;   /* into desc->materials */
    bis_material own; /* with the values of its textures there; not set where it has none */
} bis_own_material;

/* bis_scene_point finds the surface that the camera ray `eye` meets first and stores it in *pt, with its
 * material and with wo = -eye.d. *m receives this material; it must live as long as *pt. m may be NULL for a scene
 * without textures. Rays traced from *pt are counted in *counters; this one is not. *hit (may be NULL) receives the
 * distance and the primitive. Returns false if the ray meets nothing. */
bool bis_scene_point(bis_point *pt, bis_own_material *m, const bis_scene *s, ray eye, bis_counters *counters,
                     bis_hit *hit);

/* bis_scene_point_at does the same where it is known that `eye` meets primitive prim first. */
void bis_scene_point_at(bis_point *pt, bis_own_material *m, const bis_scene *s, ray eye, uint32_t prim,
                        bis_counters *counters);

/* bis_scene_point_given stores in *pt a white diffuse surface (Kd = 1) at `eye` of bis_camera.points, which no shape
 * needs to be. Its radiance is the irradiance there over pi. */
void bis_scene_point_given(bis_point *pt, const bis_scene *s, ray eye, bis_counters *counters);

/* bis_scene_shape_of returns the shape (an index into desc->shapes) that primitive `prim` of the geometry belongs to.
 * *part receives the triangle in this shape, from 0; for a sphere or disk it is 0. */
size_t bis_scene_shape_of(const bis_scene *s, uint32_t prim, size_t *part);

/* bis_scene_plan prints what the scene requires, what will be built for it, what is left out, and why. It loads
 * nothing: where this is cheap, sizes come from the headers of the files. */
void bis_scene_plan(const bis_scene_desc *desc, FILE *out);
