/* SPDX-License-Identifier: BSD-2-Clause */
/* directives: what parser.c calls: a function for each directive, by file, and what follows when the scene has ended.
 *
 * A directive is a function bis_directive_<name>(p, at). It reads what follows its name from p->token on, and writes
 * into p->desc. It complains by bis_parser_error and goes on; where the syntax itself is broken it returns at once, and
 * bis_scene_parse looks for the next directive. */
#pragma once

#include "parser.h"

typedef void bis_directive(bis_parser *p, bis_loc at);

/* parser_transform.c */
bis_directive bis_directive_identity, bis_directive_translate, bis_directive_scale, bis_directive_rotate,
    bis_directive_look_at, bis_directive_transform, bis_directive_concat_transform, bis_directive_coordinate_system,
    bis_directive_coord_sys_transform;

/* bis_parser_is_usable returns whether the matrix and its inverse are finite. */
bool bis_parser_is_usable(const bis_xform *t);

/* bis_parser_name_system gives a transformation a name, for CoordSysTransform. */
void bis_parser_name_system(bis_parser *p, const char *name, const bis_xform *t, bis_loc at);

/* parser_options.c: what stands before WorldBegin */
bis_directive bis_directive_camera, bis_directive_film, bis_directive_filter, bis_directive_accelerator,
    bis_directive_option, bis_directive_color_space, bis_directive_medium_interface;

/* parser_integrator.c */
bis_directive bis_directive_integrator, bis_directive_sampler;

/* parser_blocks.c */
bis_directive bis_directive_attribute_begin, bis_directive_attribute_end, bis_directive_transform_begin,
    bis_directive_transform_end, bis_directive_object_begin, bis_directive_object_end, bis_directive_object_instance,
    bis_directive_reverse_orientation;

/* bis_parser_check_blocks complains of blocks that are still open when the scene ends. */
void bis_parser_check_blocks(bis_parser *p);

/* parser_light.c */
bis_directive bis_directive_light;

/* bis_parser_finish_light puts the parts of the light together. Without one it warns, or makes a sky. */
void bis_parser_finish_light(bis_parser *p);

/* parser_world.c */
bis_directive bis_directive_material, bis_directive_make_named_material, bis_directive_named_material;

/* bis_parser_check_materials complains of named materials that were used and never made. */
void bis_parser_check_materials(bis_parser *p);

/* bis_parser_clear_words frees what is kept of materials for shapes that override them. */
void bis_parser_clear_words(bis_parser *p);

/* parser_textures.c */
bis_directive bis_directive_texture;

/* parser_shapes.c */
bis_directive bis_directive_shape;

/* bis_parser_drop_uv frees the texture coordinates of meshes whose materials have no textures. */
void bis_parser_drop_uv(bis_parser *p);
