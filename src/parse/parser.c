/* SPDX-License-Identifier: BSD-2-Clause */
/* parser: from a scene file to a bis_scene_desc, docs/scene-format.md.
 *
 * A table names every directive with the half of the scene where it may stand and the function that reads it; a second
 * table names pbrt's directives that bis does not model, so that the answer to them is more than "unknown". After a
 * mistake the parser goes on with the next directive and reports up to 50 errors in one go; a description is handed out
 * only when there is none. Nothing here recurses: includes, blocks and instances are explicit stacks with limits. */
#include "approximate.h"
#include "directives.h"
#include "parser_ask.h"
#include "parser_version.h"

#include "bis/base/file.h"
#include "bis/base/mem.h"
#include "scene/scene_peek.h"

#include <string.h>

/* A map or a page in place of a scene gets one line, not one for each of its words. */
static bool is_stranger(bis_parser *p, const char *path, bis_loc at)
{
    char instead[512];
    bis_stranger_kind kind;
    const char *what = bis_scene_peek_stranger(path, &kind), *word = bis_parser_word(p, path);

    if (!what) return false;
    switch (kind) {
    case BIS_STRANGER_MAP:
        snprintf(instead, sizeof instead, "try `bis envmap %s` or `bis verify %s`; a scene names it in LightSource "
                 "\"infinite\" \"string filename\"", word, word);
        break;
    case BIS_STRANGER_PLY:
    case BIS_STRANGER_OBJ:
        snprintf(instead, sizeof instead, "a scene names it in Shape \"%s\" \"string filename\"",
                 kind == BIS_STRANGER_PLY ? "plymesh" : "objmesh");
        break;
    case BIS_STRANGER_MODEL:
        snprintf(instead, sizeof instead, "%s", BIS_MODEL_ADVICE);
        break;
    case BIS_STRANGER_OTHER:
        snprintf(instead, sizeof instead, "a scene is text in pbrt's format (`bis help scene`), such as scene.txt");
        break;
    }
    if (at.file) bis_parser_error(p, at, "\"%s\" is %s, no part of a scene: %s", word, what, instead);
    else bis_parser_error(p, (bis_loc){p->desc->files[0], 0, 0}, "this is %s, no scene: %s", what, instead);
    return true;
}

/* Counts a file that has just been opened, if it was included before. */
static void count_bytes(bis_parser *p, const char *name, bis_loc at)
{
    const bis_source *s = &p->lexer.sources[p->lexer.n_sources - 1];
    if (bis_names_find(&p->included, name, NULL)) p->n_repeated += (uint64_t)(s->end - s->next);
    else if (!bis_names_set(&p->included, name, 0)) bis_parser_nomem(p, at);
    if (p->n_repeated <= BIS_MAX_REPEATED) return;
    p->stop = !bis_parser_error(p, at, "files that were included before are more than %llu MB in all: put what they "
                                "hold into an object (ObjectBegin), and show that several times",
                                BIS_MAX_REPEATED >> 20);
}

/* The name is looked at, not taken: the next token to be taken is the included file's first. */
static void directive_include(bis_parser *p, bis_loc at)
{
    if (!bis_parser_peek_name(p, "Include")) return;
    if (++p->n_includes > BIS_MAX_INCLUDES) {
        p->stop = !bis_parser_error(p, at, "more than %d Includes in all", BIS_MAX_INCLUDES);
        return;
    }
    char *path = bis_parser_path(p, p->name_at, bis_parser_text(p, p->name), NULL);
    if (path && bis_parser_is_missing(p, path)) { /* a plan lists it, and goes on without */
        bis_free(path);
        bis_parser_advance(p);
        return;
    }
    if (path && is_stranger(p, path, p->name_at)) {
        bis_free(path);
        bis_parser_advance(p);
        return;
    }
    const char *name = path ? bis_scene_desc_add_file(p->desc, path) : NULL;
    if (path && !name) bis_parser_nomem(p, at);
    bis_status status = name ? bis_lexer_push(&p->lexer, name, p->name_at) : BIS_OK;
    if (status == BIS_NOMEM) p->stop = true;
    bis_parser_note(p, status);
    if (name && !status) count_bytes(p, name, at);
    bis_parser_advance(p);
}

/* ---- directives ---- */

static void directive_world_begin(bis_parser *p, bis_loc at)
{
    if (p->in_world) {
        bis_parser_error(p, at, "a second WorldBegin: a scene has one world");
        return;
    }
    p->in_world = true;
    p->now.ctm = bis_xform_identity();
    p->now.is_flat = p->now.at_end = false; /* as in pbrt: what follows is of both ends of a motion again */
    bis_parser_name_system(p, "world", &p->now.ctm, at);
}

static void directive_world_end(bis_parser *p, bis_loc at)
{
    (void)at;
    p->ended = true; /* and not stop: what follows must be said */
}

/* Where a directive may stand: before WorldBegin, after it, or both. */
enum { OPTIONS = 1, WORLD = 2, ANYWHERE = 3 };

static const struct directive {
    const char *name;
    int where;
    bis_directive *run;
} directives[] = {
    {"Include", ANYWHERE, directive_include},
    {"LookAt", ANYWHERE, bis_directive_look_at},
    {"Translate", ANYWHERE, bis_directive_translate},
    {"Scale", ANYWHERE, bis_directive_scale},
    {"Rotate", ANYWHERE, bis_directive_rotate},
    {"Identity", ANYWHERE, bis_directive_identity},
    {"Transform", ANYWHERE, bis_directive_transform},
    {"ConcatTransform", ANYWHERE, bis_directive_concat_transform},
    {"CoordinateSystem", ANYWHERE, bis_directive_coordinate_system},
    {"CoordSysTransform", ANYWHERE, bis_directive_coord_sys_transform},
    {"TransformBegin", ANYWHERE, bis_directive_transform_begin},
    {"TransformEnd", ANYWHERE, bis_directive_transform_end},
    {"ColorSpace", ANYWHERE, bis_directive_color_space},
    {"MediumInterface", ANYWHERE, bis_directive_medium_interface},
    {"Camera", OPTIONS, bis_directive_camera},
    {"Film", OPTIONS, bis_directive_film},
    {"PixelFilter", OPTIONS, bis_directive_filter},
    {"Sampler", OPTIONS, bis_directive_sampler},
    {"Integrator", OPTIONS, bis_directive_integrator},
    {"Accelerator", OPTIONS, bis_directive_accelerator},
    {"Option", OPTIONS, bis_directive_option},
    {"WorldBegin", ANYWHERE, directive_world_begin},
    {"WorldEnd", WORLD, directive_world_end},
    {"AttributeBegin", WORLD, bis_directive_attribute_begin},
    {"AttributeEnd", WORLD, bis_directive_attribute_end},
    {"ReverseOrientation", WORLD, bis_directive_reverse_orientation},
    {"ObjectBegin", WORLD, bis_directive_object_begin},
    {"ObjectEnd", WORLD, bis_directive_object_end},
    {"ObjectInstance", WORLD, bis_directive_object_instance},
    {"LightSource", WORLD, bis_directive_light},
    {"Material", WORLD, bis_directive_material},
    {"MakeNamedMaterial", WORLD, bis_directive_make_named_material},
    {"NamedMaterial", WORLD, bis_directive_named_material},
    {"Texture", WORLD, bis_directive_texture},
    {"Shape", WORLD, bis_directive_shape},
};

/* pbrt's directives (v1 to v4) that have no meaning here, and the way out. */
static const struct foreign {
    const char *name, *instead;
} foreign[] = {
    {"AreaLightSource", "light comes from LightSource \"infinite\" alone"},
    {"MakeNamedMedium", "there is no medium but the vacuum"},
    {"ActiveTransform", "nothing moves"},
    {"TransformTimes", "nothing moves"},
    {"Attribute", "give the parameters to each directive"},
    {"Import", "use Include"},
    {"SurfaceIntegrator", "use Integrator"},
    {"VolumeIntegrator", "use Integrator"},
    {"Renderer", "use Integrator"},
    {"Volume", "there is no medium but the vacuum"},
    {"SearchPath", "files are looked for beside the scene"},
};

/* What follows ActiveTransform looks like a directive: StartTime, EndTime, All. */
static bool is_active_transform(const bis_parser *p, const char *name)
{
    return strcmp(name, "ActiveTransform") == 0 && p->token.kind == BIS_TOKEN_WORD;
}

/* --approximate: a directive that is left out with all that follows it, up to the next. Two are not. */
static void approximate_directive(bis_parser *p, const char *name, bis_loc at)
{
    if (strcmp(name, "Import") == 0) {
        directive_include(p, at);
        return;
    }
    p->lost = true;
    if (is_active_transform(p, name))
        p->now.at_end = p->token.length == strlen("EndTime") && memcmp(p->token.text, "EndTime", p->token.length) == 0;
}

/* pbrt-v1's and v2's directives. Volumes are another matter. */
static bool is_integrator(const char *name) { return strcmp(name, "SurfaceIntegrator") == 0; }

static void note_integrator(bis_parser *p, const char *directive, bis_loc at)
{
    if (!bis_parser_name(p, directive)) return;
    p->lost = true; /* its parameters are passed over */
    bis_approximate_integrator(p, at, directive, bis_parser_text(p, p->name));
}

static void unknown_directive(bis_parser *p, const char *name, bis_loc at)
{
    const char *names[BIS_COUNT(directives)];
    const bool takes_word = is_active_transform(p, name); /* asked before anything moves the token */

    if (p->other_light && strcmp(name, "AreaLightSource") == 0) {
        p->lost = true; /* passed over with what follows it */
        return;
    }
    if (p->approximate && is_integrator(name) && p->token.kind == BIS_TOKEN_STRING) {
        note_integrator(p, name, at);
        return;
    }
    if (bis_approximate(p, name, NULL, at)) {
        approximate_directive(p, name, at);
        if (takes_word) bis_parser_advance(p);
        return;
    }
    p->lost = true;
    if (takes_word) bis_parser_advance(p);

    for (size_t i = 0; i < BIS_COUNT(foreign); i++) {
        if (strcmp(name, foreign[i].name) != 0) continue;
        bis_parser_error(p, at, "%s is a directive of pbrt that bis does not model: %s%s", name, foreign[i].instead,
                         bis_approximate_hint(p, name, NULL));
        return;
    }
    for (size_t i = 0; i < BIS_COUNT(directives); i++) names[i] = directives[i].name;
    bis_parser_error(p, at, "unknown directive \"%s\"%s", bis_parser_word(p, name),
                     bis_parser_hint(p, bis_nearest_name(name, names, BIS_COUNT(directives))));
}

static void run_directive(bis_parser *p, const char *name, bis_loc at)
{
    const struct directive *d = directives, *end = directives + BIS_COUNT(directives);
    while (d < end && strcmp(d->name, name) != 0) d++;

    bis_parser_advance(p);
    p->directive = bis_approximate_begin(p, name); /* counts lights, shapes, ... that are left out, too */
    if (d == end) {
        unknown_directive(p, name, at);
    } else if (p->ended && p->approximate) {
        bis_approximate_note(p, at, "left out: it is of another picture", "what follows WorldEnd");
        p->stop = true;
    } else if (p->ended) {
        p->stop = !bis_parser_lose(p, at, "%s after WorldEnd: a scene has one world", name);
    } else if (d->where & (p->in_world ? WORLD : OPTIONS)) {
        d->run(p, at);
    } else {
        bis_parser_lose(p, at, "%s must stand %s WorldBegin", name, d->where == OPTIONS ? "before" : "after");
    }
}

/* A word that is likely a directive's name: after a mistake we go on there. Infinity is a number's, and was told. */
static bool starts_directive(const bis_token *t)
{
    return t->kind == BIS_TOKEN_WORD && t->text[0] >= 'A' && t->text[0] <= 'Z' && t->length >= 4 &&
           !bis_token_is_nonfinite(t);
}

/* Takes one directive, or one token more of what is lost. */
static void next_directive(bis_parser *p)
{
    char name[64], buf[64];
    const bis_token t = p->token;

    if (t.kind == BIS_TOKEN_END) {
        if (bis_lexer_pop(&p->lexer)) bis_parser_advance(p);
        else p->stop = true;
    } else if (t.kind == BIS_TOKEN_BAD || (p->lost && !starts_directive(&t))) {
        p->lost = true;
        bis_parser_advance(p);
    } else if (t.kind != BIS_TOKEN_WORD) {
        bis_parser_lose(p, t.at, "expected a directive, found %s", bis_token_name(buf, &t));
    } else {
        p->lost = false;
        snprintf(name, sizeof name, "%.*s", t.length < sizeof name ? (int)t.length : (int)sizeof name - 1, t.text);
        run_directive(p, name, t.at);
    }
}

/* ---- the whole ---- */

/* What only the end of the scene shows. The order is that of the messages, and materials must be there before shapes of
 * interfaces are left out, and those before texture coordinates are dropped. */
static void check_whole(bis_parser *p)
{
    const bool is_whole = p->ended || p->token.kind == BIS_TOKEN_END; /* a limit stops before the blocks' ends */
    if (is_whole) bis_parser_check_blocks(p);
    p->directive = "";
    bis_parser_check_materials(p);
    bis_approximate_finish_materials(p);
    const bool is_lit = p->desc->has_light || p->n_distants || p->other_light;
    if (is_lit || p->approximate) bis_parser_finish_light(p);
    bis_approximate_finish(p);
    if (!p->in_world) bis_parser_error(p, p->token.at, "the scene has no WorldBegin");
    if (p->status) return;
    bis_parser_drop_uv(p);
    p->desc->textures.cuts_off = p->approximate;
    bis_parser_note(p, bis_settings_check(&p->desc->view.settings, p->desc->integrator_loc, p->diag));
    if (!p->desc->has_light) bis_parser_finish_light(p); /* the last word */
}

static void parser_clear(bis_parser *p)
{
    bis_lexer_clear(&p->lexer);
    bis_params_clear(&p->params);
    bis_names_clear(&p->included);
    bis_names_clear(&p->mesh_names);
    bis_names_clear(&p->material_names);
    bis_names_clear(&p->object_names);
    bis_names_clear(&p->system_names);
    bis_names_clear(&p->texture_names[0]);
    bis_names_clear(&p->texture_names[1]);
    bis_names_clear(&p->texture_file_names);
    bis_free(p->blocks);
    bis_free(p->named);
    bis_parser_clear_words(p);
    bis_free(p->objects);
    bis_free(p->object_shapes);
    bis_free(p->systems);
    bis_free(p->distants);
    bis_approximate_clear(p);
}

bis_status bis_scene_parse(bis_scene_desc **out, const char *path, bis_diag *diag)
{
    return bis_scene_parse_as(out, path, 0, diag);
}

bis_status bis_scene_parse_as(bis_scene_desc **out, const char *path, unsigned how, bis_diag *diag)
{
    return bis_scene_parse_text(out, path, NULL, how, diag);
}

bis_status bis_scene_parse_text(bis_scene_desc **out, const char *path, const char *text, unsigned how,
                                bis_diag *diag)
{
    bis_status status = BIS_NOMEM;
    bis_scene_desc *desc = bis_scene_desc_new(path);
    bis_parser *p = bis_alloc(1, sizeof *p); /* 10 kB: the include stack and the parameters' list */

    *out = NULL;
    if (!desc || !p) {
        bis_error(diag, BIS_NOMEM, (bis_loc){path, 0, 0}, "no memory for the scene's description");
        goto done;
    }
    p->desc = desc;
    p->directive = "";
    p->convert = bis_parser_convert;
    p->film_scale = p->exposure.shutter = 1;
    p->exposure.iso = 100;
    p->other_light = how & BIS_PARSE_OTHER_LIGHT;
    p->diag = p->lexer.diag = diag;
    p->approximate = how & BIS_PARSE_APPROXIMATE;
    p->lists_missing = how & BIS_PARSE_LIST_MISSING;
    p->now.ctm = bis_xform_identity();
    if (!text) is_stranger(p, desc->files[0], (bis_loc){0});
    status = p->status ? p->status
             : text    ? bis_lexer_push_text(&p->lexer, desc->files[0], text)
                       : bis_lexer_push(&p->lexer, desc->files[0], (bis_loc){0});
    if (status) goto done;
    bis_parser_find_version(p);
    bis_parser_advance(p);
    while (!p->stop) next_directive(p);
    /* after too many errors, or without memory, the whole is not known well enough to complain of it */
    if (p->n_listed < BIS_MAX_ERRORS && p->status != BIS_NOMEM) {
        p->stop = false;
        check_whole(p);
    }
    bis_parser_count_causes(p);
    status = p->status;
    if (status) goto done;
    *out = desc;
    desc = NULL;
done:
    if (p) parser_clear(p);
    bis_free(p);
    bis_scene_desc_free(desc);
    return status;
}
