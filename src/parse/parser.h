/* SPDX-License-Identifier: BSD-2-Clause */
/* parser: the state that parser.c, parser_params.c and the files of directives (parser_*.c) share. Nobody else includes
 * this.
 *
 * A directive is a function bis_directive_<name>(p, at). It reads what follows its name from p->token on, and writes
 * into p->desc. It complains by bis_parser_error and goes on; where the syntax itself is broken it returns at once, and
 * bis_scene_parse looks for the next directive. */
#pragma once

#include "bis/base/spectrum.h"
#include "bis/scene/scene.h"
#include "lexer.h"
#include "base/grow.h"
#include "base/names.h"
#include "base/text.h"
#include "scene/scene_desc.h"

#define BIS_MAX_PARAMS 64
#define BIS_MAX_ERRORS 50
#define BIS_MAX_BLOCKS 4096
#define BIS_MAX_SHAPES (1u << 20) /* after instancing; 0.4 kB each, before any triangle */
#define BIS_MAX_INCLUDES 100000   /* in all: 64 files that include each other twice would be 2^64 */

/* ---- parameters ---- */

/* pbrt's types. v2 and v3 spellings ("color", "point", "vector") are the same. */
enum {
    BIS_TYPE_INTEGER = 1 << 0,
    BIS_TYPE_FLOAT = 1 << 1,
    BIS_TYPE_BOOL = 1 << 2,
    BIS_TYPE_STRING = 1 << 3,
    BIS_TYPE_RGB = 1 << 4,
    BIS_TYPE_POINT3 = 1 << 5,
    BIS_TYPE_VECTOR3 = 1 << 6,
    BIS_TYPE_NORMAL = 1 << 7,
    BIS_TYPE_OTHER = 1 << 8, /* pbrt's types of which bis has no parameter: vector2, ... */
    BIS_TYPE_POINT2 = 1 << 9,
    BIS_TYPE_TEXTURE = 1 << 10,
    BIS_TYPE_SPECTRUM = 1 << 11,
    BIS_TYPE_XYZ = 1 << 12,
    BIS_TYPE_BLACKBODY = 1 << 13,
    BIS_TYPES_OF_COLOUR = BIS_TYPE_SPECTRUM | BIS_TYPE_XYZ | BIS_TYPE_BLACKBODY
};

typedef struct bis_param {
    bis_loc at;            /* of its declaration */
    unsigned type;         /* BIS_TYPE_* */
    const char *type_name; /* as we spell it */
    size_t name;           /* in the parser's text */
    size_t first, n;       /* in the parser's numbers (bools: 0 or 1) or strings */
    bool is_strings, used;
} bis_param;

/* The parameters of one directive. Values of all of them lie in three arrays that the next directive uses again: ten
 * million vertices cost a few reallocations, and nothing has to be freed one by one. */
typedef struct bis_params {
    bis_param list[BIS_MAX_PARAMS];
    size_t n;
    double *numbers;
    size_t n_numbers, capacity_numbers;
    size_t *strings; /* offsets in text */
    size_t n_strings, capacity_strings;
    char *text;
    size_t n_text, capacity_text;
    const char *asked[BIS_MAX_PARAMS]; /* the names that the directive knows, for "did you mean" */
    size_t n_asked;
} bis_params;

/* ---- state ---- */

typedef enum bis_block_kind { BIS_BLOCK_ATTRIBUTE, BIS_BLOCK_TRANSFORM, BIS_BLOCK_OBJECT } bis_block_kind;

/* What blocks save and restore. */
typedef struct bis_attributes {
    bis_xform ctm; /* the current transformation matrix: object to world */
    bool is_flat;  /* --approximate: it is singular in truth, and what stands under it is left out */
    uint32_t material;
    bool at_end; /* ActiveTransform EndTime, with --approximate: what is not shown moves */
} bis_attributes;

typedef struct bis_block {
    bis_block_kind kind;
    bis_loc at; /* where it was opened */
    bis_attributes saved;
} bis_block;

/* ObjectBegin "name": shapes [first, first + n) of the parser's. */
typedef struct bis_object {
    bis_loc at;
    size_t first, n;
} bis_object;

/* A named material. pbrt-v4 lets a scene use one before it is made. */
typedef struct bis_named_material {
    uint32_t index;     /* in desc->materials */
    bis_loc made, used; /* line 0: not yet */
} bis_named_material;

/* pbrt's material "mix", with --approximate: what it is of may be made later. */
typedef struct bis_mix {
    char *name[2]; /* owned */
    uint32_t index, of[2];
    rgb share; /* of the first */
    bis_loc at;
    bool done;
} bis_mix;

/* Directives of which a scene has one; a second replaces the first with a warning, as pbrt does silently. */
typedef enum bis_single {
    BIS_SINGLE_CAMERA,
    BIS_SINGLE_FILM,
    BIS_SINGLE_FILTER,
    BIS_SINGLE_SAMPLER,
    BIS_SINGLE_INTEGRATOR,
    BIS_SINGLE_ACCELERATOR,
    BIS_N_SINGLES
} bis_single;

/* Errors of one cause: the first is listed, the others are counted. */
enum { BIS_CAUSE = 160, BIS_OTHERS = 1024 };
typedef struct bis_cause {
    char name[BIS_CAUSE];
    size_t message; /* in the list of messages */
    size_t n;       /* of the others */
    bis_loc others[4];
} bis_cause;

typedef struct bis_parser {
    bis_lexer lexer;
    bis_token token; /* the next one, not yet taken */
    bis_scene_desc *desc;
    bis_diag *diag;
    bis_status status; /* of the first error */
    unsigned n_errors, n_listed, n_includes; /* n_listed: without those that are counted with another */
    bis_cause causes[BIS_MAX_ERRORS];
    size_t n_causes;
    bool lost; /* the syntax is broken here: skip to the next directive */
    bool stop; /* no memory, or too many errors */

    bool in_world, ended;
    bool is_v2;          /* the scene is of pbrt-v2 or v1, because it says v2_word at v2_at */
    const char *v2_word; /* a constant; NULL: nothing says so */
    bis_loc v2_at;
    const char *v3_word; /* the same of pbrt-v1 to v3 */
    bis_loc seen[BIS_N_SINGLES];
    bis_attributes now;
    bis_block *blocks;
    size_t n_blocks, capacity_blocks;
    bool in_object;

    bis_params params;
    size_t name; /* the string that follows a directive ("perspective"), in params.text */
    bis_loc name_at;

    bis_names mesh_names, material_names, object_names, system_names;
    bis_names texture_names[2]; /* of colours, of numbers */
    bis_names texture_file_names;
    bool own_texture;           /* a Texture is being read */
    bis_named_material *named; /* by the value of material_names */
    size_t n_named, capacity_named;
    bis_object *objects;
    size_t n_objects, capacity_objects;
    bis_shape_desc *object_shapes;
    size_t n_object_shapes, capacity_object_shapes;
    bis_xform *systems;
    size_t n_systems, capacity_systems;

    bool approximate;   /* --approximate, see approximate.h */
    const char *directive; /* that is read now: a constant, or "" */
    void (*convert)(struct bis_parser *p, bis_param *param, unsigned wanted); /* bis_parser_convert */
    size_t n_of[BIS_N_EFFECTS]; /* lights, shapes, materials, textures of the scene so far */
    bis_approximation *notes;   /* what pbrt-v1 to v3 let pass without a word, without --approximate */
    size_t n_notes, capacity_notes;
    bool other_light;   /* BIS_PARSE_OTHER_LIGHT */
    double up[3];       /* of the last LookAt before WorldBegin; 0: there was none */
    double film_scale;  /* multiplies the picture; 1 */
    bis_distant *distants; /* in the world; they belong to the light at the end */
    size_t n_distants, capacity_distants;
    bool lists_missing; /* a file that is not there is listed in desc->missing, and no error */
    bis_names missing;
    bis_mix *mixes;
    size_t n_mixes, capacity_mixes;
    char way_out[256];

    const char *warned[BIS_MAX_PARAMS]; /* names that have had their one warning */
    size_t n_warned;
    char word[128], hint[BIS_HINT]; /* of the message that is being made */
} bis_parser;

/* ---- parser.c ---- */

/* Complain of the input; pieces of it are cut to a readable length by the caller, and the whole to 1 kB. Both return
 * false; after bis_parser_lose the parser goes on with the next directive, because the syntax is broken. */
bool bis_parser_error(bis_parser *p, bis_loc at, const char *fmt, ...) BIS_PRINTF(3, 4);
bool bis_parser_lose(bis_parser *p, bis_loc at, const char *fmt, ...) BIS_PRINTF(3, 4);

/* bis_parser_count_causes writes behind the message of each cause how many errors it stands for. */
void bis_parser_count_causes(bis_parser *p);

/* Count an error that another module has complained of; BIS_OK is fine. */
void bis_parser_note(bis_parser *p, bis_status status);
bool bis_parser_nomem(bis_parser *p, bis_loc at); /* false */
void bis_parser_advance(bis_parser *p);

/* True the first time for this name (a string constant or one that lives as long). */
bool bis_parser_once(bis_parser *p, const char *name);

/* ` (did you mean "X"?)` or "", and text of the input fit for a message; each lasts until it is asked for the next. */
const char *bis_parser_hint(bis_parser *p, const char *nearest);
const char *bis_parser_word(bis_parser *p, const char *text);

/* bis_parser_path returns the resolved path of a file that a scene names at `at`: beside the main scene, in the working
 * directory, or beside the file that names it. It returns NULL after a complaint: the file must exist. The complaint
 * ends with "; WAY_OUT", unless that is NULL. The caller owns the path. */
char *bis_parser_path(bis_parser *p, bis_loc at, const char *name, const char *way_out);

/* What --approximate takes for a file that is not there: "1 x KIND: CONSEQUENCE". Both are string constants. is_beside:
 * the file lies only beside the one that names it, as the libraries of a mesh. */
typedef struct bis_stand_in {
    const char *kind, *consequence;
    bool is_beside;
} bis_stand_in;

/* bis_parser_path_or returns what bis_parser_path does of a file that --approximate can do without, for
 * bis_approximate_path alone. *lacks becomes whether it does without: then it returns NULL, and a plan lists the file.
 */
char *bis_parser_path_or(bis_parser *p, bool *lacks, bis_loc at, const char *name, const bis_stand_in *other);

/* bis_parser_is_missing returns whether a path that was returned names a file that is not there (lists_missing). */
bool bis_parser_is_missing(const bis_parser *p, const char *path);

/* ---- parser_params.c ---- */

/* Forget the last directive's text and numbers. */
void bis_params_start(bis_parser *p);

/* Take the string that names what a directive is about; False: complained, p->lost. Starts afresh. */
bool bis_parser_name(bis_parser *p, const char *directive);
/* Take a further string. *text: its offset in the parser's text. */
bool bis_parser_next_name(bis_parser *p, const char *directive, size_t *text, bis_loc *at);
bool bis_parser_peek_name(bis_parser *p, const char *directive); /* the string stays the next token */
const char *bis_parser_text(const bis_parser *p, size_t offset);

/* Read "type name" value ... up to the next directive. False: complained, p->lost. */
bool bis_params_read(bis_parser *p);
void bis_params_clear(bis_params *ps);
bis_param *bis_params_find(bis_parser *p, const char *name); /* NULL: not given */

/* "rgb or float": the types of a mask. */
const char *bis_param_type_names(char buf[64], unsigned mask);

/* ---- parser_ask.c ---- */

/* [lo, hi], without its ends where they are open; HUGE_VAL: no such end. */
typedef struct bis_interval {
    double lo, hi;
    bool lo_open, hi_open;
} bis_interval;

/* Does *value lie in range? Else complain and say so. With --approximate it is brought to the range's end, if that is
 * part of it. */
bool bis_parser_in_range(bis_parser *p, bis_loc at, const char *name, double *value, bis_interval range);

/* Each asks for one parameter: true and *value where it is there and right; false where it is absent, or after a
 * complaint. *value is then untouched. */
const bis_param *bis_params_take(bis_parser *p, const char *name, unsigned types, size_t count);
bool bis_params_float(bis_parser *p, const char *name, double *value, bis_interval range);
bool bis_params_floats(bis_parser *p, const char *name, double *values, size_t n, bis_interval range);
bool bis_params_integer(bis_parser *p, const char *name, uint64_t *value, uint64_t lo, uint64_t hi);
bool bis_params_uint32(bis_parser *p, const char *name, uint32_t *value, uint32_t lo, uint32_t hi);
bool bis_params_bool(bis_parser *p, const char *name, bool *value);
bool bis_params_string(bis_parser *p, const char *name, const char **value);
bool bis_params_rgb(bis_parser *p, const char *name, rgb *value, bis_interval range, bool or_float);

/* A string that is one of choices[n]; *value: its index. */
bool bis_params_choice(bis_parser *p, const char *name, int *value, const char *const *choices, size_t n);

bool bis_params_has(bis_parser *p, const char *name);
bis_loc bis_params_at(bis_parser *p, const char *name);

/* Parameters of pbrt's that do not matter: without a word, or with a warning the first time. names[n]. */
void bis_params_skip(bis_parser *p, const char *const *names, size_t n);
void bis_params_ignore(bis_parser *p, const char *const *names, size_t n);

/* Complain of all that nobody asked for. what: `Camera "perspective"`. */
void bis_params_end(bis_parser *p, const char *directive, const char *what);

/* A colour or a number, or a texture of such (parser_textures.c). *texture stays as it was where *value says all; else
 * it is the texture's index, and *value a typical value. */
bool bis_params_colour(bis_parser *p, const char *name, rgb *value, bis_interval range, uint32_t *texture);
bool bis_params_number(bis_parser *p, const char *name, double *value, bis_interval range, uint32_t *texture);

/* A spectrum: one number, pairs, or a file of pairs. own: what `is` borrows, for bis_parser_spectrum_clear, which is
 * called after a failure, too. */
typedef struct bis_parser_spectrum {
    bis_spectrum is;
    double (*own)[2];
} bis_parser_spectrum;
bool bis_params_spectrum(bis_parser *p, const char *name, bis_parser_spectrum *s);
void bis_parser_spectrum_clear(bis_parser_spectrum *s);

/* parser_colours.c. A colour in other words than rgb: of a surface as a spectrum, xyz or blackbody; of a light the
 * same. bis_parser_into_unit cuts a
 * colour off to [0,1] with a warning. */
bool bis_params_reflectance(bis_parser *p, const char *name, rgb *value);
bool bis_params_emission(bis_parser *p, const char *name, rgb *value);
rgb bis_parser_into_unit(bis_parser *p, rgbd c, const char *name, bis_loc at);

/* ---- parser_convert.c ---- */

/* bis_params_mean stores the mean of the texture that a parameter names, where a colour or a number is asked for. It
 * returns false without --approximate, and where the parameter is no texture. */
bool bis_params_mean(bis_parser *p, const char *name, rgbd *value);

/* bis_parser_convert makes of *param one of the types `wanted`, where it can; else it leaves it as it is. */
void bis_parser_convert(bis_parser *p, bis_param *param, unsigned wanted);

/* What a directive's name stands for. */
enum { BIS_REPLACED = -1, BIS_FOREIGN = -2 };
typedef struct bis_choice {
    const char *name;
    int value; /* >= 0: ours; BIS_REPLACED: pbrt's, replaced by what the caller says; BIS_FOREIGN: pbrt's, an error */
} bis_choice;

/* Look up a name. NULL: complained. */
const bis_choice *bis_parser_choose(bis_parser *p, const char *directive, const char *name, bis_loc at,
                                    const bis_choice *choices, size_t n);

/* Read a directive's name and parameters, and look up the name. NULL: complained. */
const bis_choice *bis_parser_begin(bis_parser *p, const char *directive, const bis_choice *choices, size_t n);

/* Warn of a directive given again. */
void bis_parser_single(bis_parser *p, bis_single which, const char *directive, bis_loc at);

/* ---- the directives, by file ---- */
typedef void bis_directive(bis_parser *p, bis_loc at);

/* parser_transform.c */
bis_directive bis_directive_identity, bis_directive_translate, bis_directive_scale, bis_directive_rotate,
    bis_directive_look_at, bis_directive_transform, bis_directive_concat_transform, bis_directive_coordinate_system,
    bis_directive_coord_sys_transform;

/* Are the matrix and its inverse finite? */
bool bis_parser_is_usable(const bis_xform *t);
void bis_parser_name_system(bis_parser *p, const char *name, const bis_xform *t, bis_loc at);

/* parser_state.c. What only scenes of pbrt-v2 and v1 say. word: a constant. */
void bis_parser_is_v2(bis_parser *p, const char *word, bis_loc at);

/* parser_options.c: what stands before WorldBegin */
bis_directive bis_directive_camera, bis_directive_film, bis_directive_filter, bis_directive_accelerator,
    bis_directive_option, bis_directive_color_space, bis_directive_medium_interface;

/* parser_integrator.c */
bis_directive bis_directive_integrator, bis_directive_sampler;

/* parser_blocks.c */
bis_directive bis_directive_attribute_begin, bis_directive_attribute_end, bis_directive_transform_begin,
    bis_directive_transform_end, bis_directive_object_begin, bis_directive_object_end, bis_directive_object_instance,
    bis_directive_reverse_orientation;
void bis_parser_check_blocks(bis_parser *p);

/* To the scene, or to the object that is open. */
void bis_parser_add_shape(bis_parser *p, const bis_shape_desc *shape);

/* parser_light.c. bis_parser_finish_light puts the parts of the light together. Without one it warns, or makes a sky.
 */
bis_directive bis_directive_light;
void bis_parser_finish_light(bis_parser *p);

/* parser_world.c. bis_parser_add_material makes room for one more, which starts as the default;
 * bis_parser_warn_energy warns if Phong's Kd + Ks exceeds 1. */
typedef bis_material bis_material_reader(bis_parser *p, bis_material_textures *t);
bool bis_parser_add_material(bis_parser *p, uint32_t *index);
void bis_parser_warn_energy(bis_parser *p, bis_loc at, rgb Kd, rgb Ks);
bis_directive bis_directive_material, bis_directive_make_named_material,
    bis_directive_named_material;
void bis_parser_check_materials(bis_parser *p);

/* parser_materials.c: pbrt's */
bis_material_reader bis_parser_conductor, bis_parser_metal, bis_parser_coated_diffuse, bis_parser_plastic,
    bis_parser_uber, bis_parser_substrate;

/* parser_textures.c. An image is a file that is named at `at`; it takes over its path, NULL: complained */
/* bis_parser_find_texture stores the index of the texture that a parameter names. A colour may be given by a texture of
 * numbers, and is then grey. False: complained. */
bool bis_parser_find_texture(bis_parser *p, const bis_param *param, bool of_floats, uint32_t *index);
bool bis_parser_add_texture(bis_parser *p, const bis_texture *x, uint32_t *index);
bool bis_parser_add_image(bis_parser *p, char *path, double gamma, bis_loc at, uint32_t *image);
bis_directive bis_directive_texture;

/* parser_points.c. bis_parser_add_mesh takes over what `mesh` owns. bis_parser_points reads P, N and uv of a shape into
 * m, bis_parser_indices its faces: index[n_faces][per_face] from bis_alloc, which is the caller's after a complaint,
 * too. Without "indices" the points are one face. False: complained. */
bool bis_parser_add_mesh(bis_parser *p, const bis_mesh_desc *mesh, uint32_t *index);
bool bis_parser_points(bis_parser *p, const char *shape, bis_mesh *m);
bool bis_parser_indices(bis_parser *p, const char *shape, size_t per_face, size_t n_points, uint32_t **index,
                        size_t *n_faces);

/* parser_shapes.c */
bis_directive bis_directive_shape;

/* parser_made.c. bis_parser_made reads a shape that is made by a formula or of a few points: a whole sphere or disk
 * becomes a quadric, all else a mesh. False: complained, or there is nothing of it. */
enum {
    BIS_MADE_SPHERE = 100, /* behind all of bis_shape_kind */
    BIS_MADE_DISK,
    BIS_MADE_CYLINDER,
    BIS_MADE_CONE,
    BIS_MADE_PARABOLOID,
    BIS_MADE_HYPERBOLOID,
    BIS_MADE_LOOP,
    BIS_MADE_PATCHES,
    BIS_MADE_HEIGHTS,
    BIS_MADE_NURBS
};
bool bis_parser_made(bis_parser *p, int made, bis_shape_desc *shape);
/* parser_mtl.c: of an OBJ with materials, the shapes of its parts */
void bis_parser_add_parts(bis_parser *p, const bis_shape_desc *shape);
void bis_parser_drop_uv(bis_parser *p); /* of meshes without textures */

#define BIS_COUNT(array) (sizeof(array) / sizeof *(array))
