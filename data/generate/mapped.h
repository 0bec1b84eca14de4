/* SPDX-License-Identifier: BSD-2-Clause */
/* mapped: maps that are not lat-long, and compressed files, for data/scenes/pbrt.
 * For data/generate/make_data.c alone. */
#ifndef MAPPED_H
#define MAPPED_H

#include "bis/base/status.h"

/* Write dir/maps/sky_equalarea.exr, clouds_verticalcross.hdr.gz, clouds_horizontalcross.pfm, sky_cubestrip.exr,
 * sky_mirrorball.hdr and clouds_angular.hdr, of the maps that are there already, and the compressed copies
 * dir/models/vase.ply.gz and crates.obj.gz. */
bis_status mapped_make(const char *dir, bis_diag *diag);

#endif
