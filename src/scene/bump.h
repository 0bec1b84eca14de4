/* SPDX-License-Identifier: BSD-2-Clause */
/* bump: normals that textures bend. For src/scene alone. */
#pragma once

#include "bis/scene/texture.h"
#include "bis/shape/geometry.h"

/* bis_bump_normal returns the unit shading normal that the normal map or the displacement of a material makes at (u, v)
 * and p of a surface that lies as *t says. It is on t->outside's side. of->bump or of->normals must be a texture; a
 * material that has both takes the normal map, as in pbrt. */
vec3 bis_bump_normal(const bis_textures *textures, const bis_texture_image *images, const bis_material_textures *of,
                     const bis_tangents *t, const double uv[2], vec3 p);
