/* SPDX-License-Identifier: BSD-2-Clause */
/* parser_colours: colours in other words than rgb: spectra, xyz, blackbody. */
#pragma once

#include "spectrum.h"
#include "parser.h"

/* A spectrum: one number, pairs, or a file of pairs. own: what `is` borrows, for bis_parser_spectrum_clear, which is
 * called after a failure, too. */
typedef struct bis_parser_spectrum {
    bis_spectrum is;
    double (*own)[2];
} bis_parser_spectrum;

/* bis_params_spectrum asks for a spectrum: true if it is given and right. */
bool bis_params_spectrum(bis_parser *p, const char *name, bis_parser_spectrum *s);

/* bis_parser_spectrum_clear frees what the spectrum owns. */
void bis_parser_spectrum_clear(bis_parser_spectrum *s);

/* bis_params_reflectance asks for a surface's colour as a spectrum, xyz or blackbody; bis_params_emission for a
 * light's. Both return false if it is not given in these words. */
bool bis_params_reflectance(bis_parser *p, const char *name, rgb *value);
bool bis_params_emission(bis_parser *p, const char *name, rgb *value);

/* bis_parser_into_unit cuts a colour off to [0,1], with a warning. */
rgb bis_parser_into_unit(bis_parser *p, rgbd c, const char *name, bis_loc at);
