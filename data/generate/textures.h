/* SPDX-License-Identifier: BSD-2-Clause */
/* textures: models with texture coordinates and images to lie on them. For data/generate/make_data.c alone. */
#ifndef TEXTURES_H
#define TEXTURES_H

#include "bis/base/status.h"

/* Write dir/maps/tiles.png, polish.png, weave.pfm, rings.exr, medal.hdr and stud.pfm, dir/models/vase.ply, crates.obj
 * and crates.mtl. The folders must exist. */
bis_status textures_make(const char *dir, bis_diag *diag);

#endif
