/* SPDX-License-Identifier: BSD-2-Clause */
/* parser_materials: materials, ours and pbrt's. */
#pragma once

#include "parser.h"

/* bis_parser_add_material makes room for one more material, which starts as the default, and stores its index
 * (parser_world.c). Returns false after a complaint. */
bool bis_parser_add_material(bis_parser *p, uint32_t *index);

/* bis_parser_warn_energy warns if Phong's Kd + Ks exceeds 1. */
void bis_parser_warn_energy(bis_parser *p, bis_loc at, rgb Kd, rgb Ks);

/* A reader of one of pbrt's materials, by the parameters that are read (parser_materials.c). */
typedef bis_material bis_material_reader(bis_parser *p, bis_material_textures *t);
bis_material_reader bis_parser_conductor, bis_parser_metal, bis_parser_coated_diffuse, bis_parser_plastic,
    bis_parser_uber, bis_parser_substrate;
