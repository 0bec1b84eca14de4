/* SPDX-License-Identifier: BSD-2-Clause */
/* distant: pbrt's distant lights in a map. For light_load.c. */
#pragma once

#include "bis/scene/light_load.h"

/* The map of a scene that has distant lights and no map of its own: a pixel is a third of the disc's diameter. */
enum { BIS_DISTANT_WIDTH = 2048 };

/* bis_distant_add adds a disc to the map, of the radiance that gives the light's irradiance. towards: a unit vector in
 * the map's frame. A map whose pixels are larger than the disc gets one pixel. False: the radiance exceeds the largest
 * float; the map is then unchanged. */
bool bis_distant_add(bis_envmap *em, const bis_distant *light);
