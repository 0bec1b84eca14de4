/* SPDX-License-Identifier: BSD-2-Clause */
/* scene_desc: how a scene's description begins and grows. For the parser (src/parse) alone. */
#pragma once

#include "bis/scene/scene.h"

/* bis_scene_desc_new returns the description of a scene whose file `path` says nothing: all defaults. NULL: no
 * memory. */
bis_scene_desc *bis_scene_desc_new(const char *path);

/* bis_scene_desc_add_shape appends a copy of *shape. False: no memory. */
bool bis_scene_desc_add_shape(bis_scene_desc *d, const bis_shape_desc *shape);

/* bis_scene_desc_add_missing takes over the name of a mesh or map that is not there. False: no memory; the name is then
 * freed. */
bool bis_scene_desc_add_missing(bis_scene_desc *d, char *name);

/* bis_scene_desc_set_textures gives textures to a material. False: no memory. */
bool bis_scene_desc_set_textures(bis_scene_desc *d, uint32_t material, const bis_material_textures *textures);

/* bis_scene_desc_add_file takes over the name of a file that the scene consists of, and returns it. NULL: no memory;
 * the name is then freed. */
const char *bis_scene_desc_add_file(bis_scene_desc *d, char *name);
