/* SPDX-License-Identifier: BSD-2-Clause */
/* parser_blocks: AttributeBegin/End, TransformBegin/End, ObjectBegin/End on one explicit stack, and instances.
 *
 * The shapes between ObjectBegin and ObjectEnd are kept aside with their transformation to the world as it was there;
 * an instance adds each of them again under CTM * theirs (pbrt's rule). Meshes are shared, see bis_mesh_desc. */
#include "base/grow.h"
#include "approximate.h"
#include "directives.h"
#include "parser_shapes.h"

#include <string.h>

static const char *const begin_names[] = {"AttributeBegin", "TransformBegin", "ObjectBegin"};
static const char *const end_names[] = {"AttributeEnd", "TransformEnd", "ObjectEnd"};

static bool open_block(bis_parser *p, bis_block_kind kind, bis_loc at)
{
    if (p->n_blocks == BIS_MAX_BLOCKS) {
        /* stop: what follows would close other blocks than its author means, and each would be an error */
        p->stop = !bis_parser_error(p, at, "blocks nest deeper than %d", BIS_MAX_BLOCKS);
        return false;
    }
    if (!BIS_ROOM(p->blocks, p->capacity_blocks, p->n_blocks)) return bis_parser_nomem(p, at);
    p->blocks[p->n_blocks++] = (bis_block){kind, at, p->now};
    return true;
}

/* To pbrt an object is a block of attributes, and it does not look which End closes which; a block of transformations
 * has a stack of its own. */
static void check_kind(bis_parser *p, const bis_block *top, bis_block_kind kind, bis_loc at)
{
    if (top->kind == kind) return;
    if (top->kind != BIS_BLOCK_TRANSFORM && kind != BIS_BLOCK_TRANSFORM)
        bis_approximate_pass(p, at, "it closes the last block that was opened, as in pbrt-v3", "%s where %s is due",
                             end_names[kind], end_names[top->kind]);
    else if (p->approximate)
        bis_approximate_note(p, at, "it closes the last block that was opened", "%s where %s is due", end_names[kind],
                             end_names[top->kind]);
    else
        bis_parser_error(p, at, "%s where %s is due: it would close the %s of %s:%d", end_names[kind],
                         end_names[top->kind], begin_names[top->kind], top->at.file, top->at.line);
}

/* Closes the block on top, whatever it is: after a wrong End the rest of the file makes most sense that way. */
static void close_block(bis_parser *p, bis_block_kind kind, bis_loc at)
{
    const bool ends_object = kind == BIS_BLOCK_OBJECT && p->in_object;

    if (p->n_blocks) {
        const bis_block *top = &p->blocks[--p->n_blocks];
        check_kind(p, top, kind, at);
        /* as in pbrt, TransformEnd restores the transformation alone */
        const uint32_t material = top->kind == BIS_BLOCK_TRANSFORM ? p->now.material : top->saved.material;
        p->now = top->saved;
        p->now.material = material;
    } else if (!ends_object) {
        char kind_text[64];
        snprintf(kind_text, sizeof kind_text, "%s without %s", end_names[kind], begin_names[kind]);
        bis_approximate_or_refuse(p, at, kind_text, "ignored, as in pbrt", "%s", kind_text);
    }
    if (!ends_object) return;
    bis_object *object = &p->objects[p->n_objects - 1];
    object->n = p->n_object_shapes - object->first;
    p->in_object = false;
}

void bis_directive_attribute_begin(bis_parser *p, bis_loc at) { open_block(p, BIS_BLOCK_ATTRIBUTE, at); }
void bis_directive_attribute_end(bis_parser *p, bis_loc at) { close_block(p, BIS_BLOCK_ATTRIBUTE, at); }
void bis_directive_transform_begin(bis_parser *p, bis_loc at) { open_block(p, BIS_BLOCK_TRANSFORM, at); }
void bis_directive_transform_end(bis_parser *p, bis_loc at) { close_block(p, BIS_BLOCK_TRANSFORM, at); }

/* Both sides of a surface are lit, so that its orientation changes nothing. */
void bis_directive_reverse_orientation(bis_parser *p, bis_loc at)
{
    (void)p;
    (void)at;
}

void bis_directive_object_begin(bis_parser *p, bis_loc at)
{
    if (!bis_parser_name(p, "ObjectBegin")) return;
    if (p->in_object) {
        bis_parser_error(p, at, "ObjectBegin inside ObjectBegin: objects do not nest");
        open_block(p, BIS_BLOCK_OBJECT, at); /* so that its ObjectEnd has a block to close */
        return;
    }
    const char *name = bis_parser_text(p, p->name);
    const bool known = bis_names_find(&p->object_names, name, NULL);
    if (known)
        bis_approximate_pass(p, p->name_at, "the last one counts from there on", "an object defined again");
    if (!BIS_ROOM(p->objects, p->capacity_objects, p->n_objects) ||
        !bis_names_set(&p->object_names, name, (uint32_t)p->n_objects)) {
        bis_parser_nomem(p, at);
        return;
    }
    p->objects[p->n_objects++] = (bis_object){p->name_at, p->n_object_shapes, 0};
    p->in_object = open_block(p, BIS_BLOCK_OBJECT, at);
}

void bis_directive_object_end(bis_parser *p, bis_loc at) { close_block(p, BIS_BLOCK_OBJECT, at); }

/* Adds a shape of the world. A few lines of text may ask for more triangles than any memory holds, by levels of
 * subdivision and by instances. */
static bool add_to_world(bis_parser *p, const bis_shape_desc *shape, bis_loc at)
{
    if (shape->kind == BIS_SHAPE_TRIANGLES) p->n_triangles += p->desc->meshes[shape->mesh].size.triangles;
    if (p->n_triangles > BIS_MAX_TRIANGLES)
        p->stop = !bis_parser_error(p, at, "from here on the scene's own meshes have more than %zu triangles, "
                                    "instances included: give fewer levels or instances", BIS_MAX_TRIANGLES);
    else if (!bis_scene_desc_add_shape(p->desc, shape)) bis_parser_nomem(p, at);
    return !p->stop;
}

void bis_parser_add_shape(bis_parser *p, const bis_shape_desc *shape)
{
    if (p->now.is_flat) {
        bis_approximate_note(p, shape->loc, "left out: it has no extent in one direction, or a perspective",
                             "a shape under a singular transformation");
    } else if (p->desc->n_shapes + p->n_object_shapes >= BIS_MAX_SHAPES) {
        p->stop = !bis_parser_error(p, shape->loc, "more than %u shapes", BIS_MAX_SHAPES);
    } else if (!p->in_object) {
        add_to_world(p, shape, shape->loc);
    } else if (BIS_ROOM(p->object_shapes, p->capacity_object_shapes, p->n_object_shapes)) {
        p->object_shapes[p->n_object_shapes++] = *shape;
    } else {
        bis_parser_nomem(p, shape->loc);
    }
}

static void add_instance(bis_parser *p, const bis_object *object, bis_loc at)
{
    /* before anything is added: objects of instances could be 2^20 times 2^20 shapes */
    if (object->n > BIS_MAX_SHAPES - p->desc->n_shapes) {
        p->stop = !bis_parser_error(p, at, "more than %u shapes, instances included", BIS_MAX_SHAPES);
        return;
    }
    for (size_t i = 0; i < object->n && p->now.is_flat; i++)
        bis_approximate_note(p, at, "left out: it has no extent in one direction, or a perspective",
                             "a shape under a singular transformation");
    for (size_t i = 0; i < object->n && !p->now.is_flat; i++) {
        bis_shape_desc shape = p->object_shapes[object->first + i];
        shape.to_world = bis_xform_compose(&p->now.ctm, &shape.to_world);
        if (!bis_parser_is_usable(&shape.to_world)) {
            bis_parser_error(p, at, "ObjectInstance makes the transformation singular or infinite");
            return;
        }
        if (!add_to_world(p, &shape, at)) return;
    }
}

void bis_directive_object_instance(bis_parser *p, bis_loc at)
{
    uint32_t i;
    if (!bis_parser_name(p, "ObjectInstance")) return;
    const char *name = bis_parser_text(p, p->name);
    if (p->in_object) {
        bis_parser_error(p, at, "ObjectInstance inside ObjectBegin: objects do not nest");
        return;
    }
    if (bis_names_find(&p->object_names, name, &i)) {
        add_instance(p, &p->objects[i], at);
        return;
    }
    bis_approximate_or_refuse(p, p->name_at, "ObjectInstance of an object that is not defined", "left out",
                              "object \"%s\" is not defined%s", bis_parser_word(p, name),
                              bis_parser_hint(p, bis_names_nearest(&p->object_names, name)));
}

void bis_parser_check_blocks(bis_parser *p)
{
    for (size_t i = p->n_blocks; i-- > 0;) {
        const bis_block *b = &p->blocks[i];
        char kind[64];
        snprintf(kind, sizeof kind, "%s has no %s", begin_names[b->kind], end_names[b->kind]);
        bis_approximate_or_refuse(p, b->at, kind, "it ends with the scene", "%s", kind);
        if (p->stop) return;
    }
}
