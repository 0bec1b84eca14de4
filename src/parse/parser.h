/* SPDX-License-Identifier: BSD-2-Clause */
/* parser: the state that the files of src/parse share, and what each of them needs of it (parser_state.c): complaints,
 * the next token, the path of a file. What one file offers to others stands in a header of its own: parser_params.h,
 * parser_ask.h, parser_colours.h, parser_textures.h, parser_shapes.h, parser_materials.h, directives.h, approximate.h.
 */
#pragma once

#include "bis/scene/scene.h"
#include "lexer.h"
#include "parser_params.h"
#include "base/grow.h"
#include "base/names.h"
#include "base/text.h"
#include "scene/scene_desc.h"

#define BIS_MAX_ERRORS 50
#define BIS_MAX_BLOCKS 4096
#define BIS_MAX_TRIANGLES ((size_t)1 << 26) /* of the scene's own meshes, after instancing; about 5 GB */
#define BIS_MAX_SHAPES (1u << 20) /* after instancing; 0.4 kB each, before any triangle */
#define BIS_MAX_INCLUDES 100000   /* in all: 64 files that include each other twice would be 2^64, */
#define BIS_MAX_REPEATED (1ull << 28) /* and bytes of files that were included before: some seconds */

#define BIS_COUNT(array) (sizeof(array) / sizeof *(array))

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

/* A coordinate system with a name. */
typedef struct bis_system {
    bis_xform ctm;
    bool is_flat;
} bis_system;

/* A named material. pbrt-v4 lets a scene use one before it is made. */
typedef struct bis_named_material {
    uint32_t index;     /* in desc->materials */
    bis_loc made, used; /* line 0: not yet */
} bis_named_material;

/* The words of a material in pbrt-v1 to v3, where a shape may give some of them itself (parser_world.c). */
typedef struct bis_material_words {
    bis_param *list; /* as in bis_params; owned. No text: there are none */
    double *numbers;
    size_t *strings;
    char *text;
    size_t n, n_numbers, n_strings, n_text;
    size_t type; /* in the text */
} bis_material_words;

/* pbrt's material "mix", with --approximate: what it is of may be made later. */
typedef struct bis_mix {
    char *name[2]; /* owned */
    uint32_t index, of[2];
    rgb share; /* of the first */
    bis_loc at;
    bool done;
} bis_mix;

/* Of which version of pbrt a scene is. Where its words do not tell, what differs is read as in V4. V2 is also v1. bis's
 * own scenes are V4. */
typedef enum bis_pbrt_version { BIS_PBRT_UNKNOWN, BIS_PBRT_V2, BIS_PBRT_V3, BIS_PBRT_V4 } bis_pbrt_version;

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

/* Each part of the state belongs to the files that it names; only the first is everybody's. */
struct bis_parser {
    struct { /* all */
        bis_scene_desc *desc;
        bis_diag *diag;
        bis_token token;       /* the next one, not yet taken */
        bis_params params;     /* of the directive that is read */
        size_t name;           /* the string that follows a directive ("perspective"), in params.text */
        bis_loc name_at;
        bis_attributes now;
        bool approximate;      /* --approximate, see approximate.h */
        const char *directive; /* that is read now: a constant, or "" */
    };
    struct { /* parser.c: the way through the files */
        bis_lexer lexer;
        bis_status status; /* of the first error */
        unsigned n_rests; /* numbers with something behind them, and the first of them */
        bis_loc rest_at;
        unsigned n_includes;
        bis_names included;
        uint64_t n_repeated; /* bytes of files that were included before */
        bool lost; /* the syntax is broken here: skip to the next directive */
        bool stop; /* no memory, or too many errors */
        bool in_world, ended;
        bool other_light;   /* BIS_PARSE_OTHER_LIGHT */
        bis_loc seen[BIS_N_SINGLES]; /* parser_ask.c */
        void (*convert)(struct bis_parser *p, bis_param *param, unsigned wanted); /* bis_parser_convert */
    };
    struct { /* parser_state.c: complaints and files that are missing */
        unsigned n_errors, n_listed; /* n_listed: without those that are counted with another */
        bis_cause causes[BIS_MAX_ERRORS];
        size_t n_causes;
        const char *warned[BIS_MAX_PARAMS]; /* names that have had their one warning */
        size_t n_warned;
        char word[128], hint[BIS_HINT]; /* of the message that is being made */
        bool lists_missing; /* a file that is not there is listed in desc->missing, and no error */
        bis_names missing;
    };
    bis_pbrt_version version; /* parser_version.h */
    struct { /* parser_blocks.c: blocks and objects */
        bis_block *blocks;
        size_t n_blocks, capacity_blocks;
        bool in_object;
        bis_names object_names;
        bis_object *objects;
        size_t n_objects, capacity_objects;
        bis_shape_desc *object_shapes;
        size_t n_object_shapes, capacity_object_shapes;
        size_t n_triangles; /* of the world's shapes whose meshes are the scene's own */
    };
    struct { /* parser_transform.c */
        bis_names system_names;
        bis_system *systems;
        size_t n_systems, capacity_systems;
        double up[3]; /* of the last LookAt before WorldBegin; 0: there was none */
    };
    struct { /* parser_world.c, parser_shapes.c, parser_textures.c: names of what is in the world */
        bis_names material_names, mesh_names;
        bis_names texture_names[2]; /* of colours, of numbers */
        bis_names texture_file_names;
        bool own_texture;          /* a Texture is being read */
        bis_named_material *named; /* by the value of material_names */
        size_t n_named, capacity_named;
        bis_material_words *words; /* by the material's index */
        size_t n_words, capacity_words;
    };
    struct { /* parser_light.c */
        double film_scale;  /* multiplies the picture; 1 (parser_options.c) */
        struct {
            double shutter, iso, time, ratio; /* of pbrt-v4: 1, 100; 0: not given */
        } exposure;
        bis_distant *distants; /* in the world; they belong to the light at the end */
        size_t n_distants, capacity_distants;
    };
    struct { /* approximate.c, approximate_materials.c */
        size_t n_of[BIS_N_EFFECTS]; /* lights, shapes, materials, textures of the scene so far */
        bis_approximation *notes;   /* what pbrt-v1 to v3 let pass without a word, without --approximate */
        size_t n_notes, capacity_notes;
        bis_mix *mixes;
        size_t n_mixes, capacity_mixes;
        char way_out[256];
    };
};

/* bis_parser_error complains of the input: an error at `at`. The caller cuts pieces of the input to a readable length;
 * the whole is cut to 1 kB. Returns false. bis_parser_lose does the same where the syntax is broken: the parser goes on
 * with the next directive. */
bool bis_parser_error(bis_parser *p, bis_loc at, const char *fmt, ...) BIS_PRINTF(3, 4);
bool bis_parser_lose(bis_parser *p, bis_loc at, const char *fmt, ...) BIS_PRINTF(3, 4);

/* bis_parser_nomem complains that there is no memory, and stops the parser. Returns false. */
bool bis_parser_nomem(bis_parser *p, bis_loc at);

/* bis_parser_note counts an error that another module has complained of; BIS_OK is none. */
void bis_parser_note(bis_parser *p, bis_status status);

/* bis_parser_count_causes writes behind the message of each cause how many errors it stands for. */
void bis_parser_count_causes(bis_parser *p);

/* bis_parser_once returns true the first time for this name (a string constant or one that lives as long). */
bool bis_parser_once(bis_parser *p, const char *name);

/* bis_parser_hint returns ` (did you mean "X"?)` or "". It lasts until it is asked for the next. */
const char *bis_parser_hint(bis_parser *p, const char *nearest);

/* bis_parser_word returns text of the input, fit for a message. It lasts until it is asked for the next. */
const char *bis_parser_word(bis_parser *p, const char *text);

/* bis_parser_advance takes the token at hand: p->token is then the next one, of whichever file. */
void bis_parser_advance(bis_parser *p);

/* bis_parser_find_file returns the path of a file that a scene names at `at`: the first of its places where it is, or
 * the first place if it is in none. The caller owns it. NULL: no memory, and no complaint. */
char *bis_parser_find_file(bis_parser *p, bis_loc at, const char *name);

/* bis_parser_path returns the resolved path of a file that a scene names at `at`: beside the main scene, in the working
 * directory, or beside the file that names it. It returns NULL after a complaint: the file must exist. The complaint
 * ends with "; WAY_OUT", unless that is NULL. The caller owns the path. */
char *bis_parser_path(bis_parser *p, bis_loc at, const char *name, const char *way_out);

/* What --approximate takes for a file that is not there: "1 x KIND: CONSEQUENCE". Both are string constants. is_beside:
 * the file lies only beside the one that names it, as the libraries of a mesh. unread: the KIND of an image that is
 * there and cannot be read; NULL: the file is no image. */
typedef struct bis_stand_in {
    const char *kind, *consequence, *unread;
    bool is_beside;
} bis_stand_in;

/* bis_parser_path_or returns what bis_parser_path does of a file that --approximate can do without, for
 * bis_approximate_path alone. *lacks becomes NULL, or the KIND of what it does without: then it returns NULL, and a
 * plan lists the file. */
char *bis_parser_path_or(bis_parser *p, const char **lacks, bis_loc at, const char *name, const bis_stand_in *other);

/* bis_parser_is_missing returns whether a path that was returned names a file that is not there (lists_missing). */
bool bis_parser_is_missing(const bis_parser *p, const char *path);
