/* SPDX-License-Identifier: BSD-2-Clause */
/* parser_textures: textures, and the parameters that a texture may give. */
#pragma once

#include "parser_ask.h"

/* bis_params_colour asks for a colour, or a texture of colours or numbers. *texture stays as it was where *value says
 * all; else it is the texture's index, and *value a typical value. bis_params_number does the same for a number, and
 * does not say whether it is given, because nobody asks. */
bool bis_params_colour(bis_parser *p, const char *name, rgb *value, bis_interval range, uint32_t *texture);
void bis_params_number(bis_parser *p, const char *name, double *value, bis_interval range, uint32_t *texture);

/* bis_parser_find_texture stores the index of the texture that a parameter names. A colour may be given by a texture of
 * numbers, and is then grey. Returns false after a complaint. */
bool bis_parser_find_texture(bis_parser *p, const bis_param *param, bool of_floats, uint32_t *index);

/* bis_parser_add_texture adds a texture to the scene and stores its index. Returns false after a complaint. */
bool bis_parser_add_texture(bis_parser *p, const bis_texture *x, uint32_t *index);

/* bis_parser_add_image adds an image file, or finds it, if it has been added by whatever path with the same meaning of
 * its values, and stores its index. path is that of the file, which it takes over; NULL: there is none. `as` has all
 * but the path. Returns false after a complaint. */
bool bis_parser_add_image(bis_parser *p, char *path, const bis_texture_file *as, uint32_t *image);
