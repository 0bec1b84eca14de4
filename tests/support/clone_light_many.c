/* SPDX-License-Identifier: BSD-2-Clause */
/* clone_light_many: see clones.h. */
#include "clone.h"
#define bis_envmap_pixels CLONE(envmap_pixels)
#define bis_light_look CLONE(light_look)
#define bis_lanes_put CLONE(lanes_put)
#include "thesis/light_many.c"
