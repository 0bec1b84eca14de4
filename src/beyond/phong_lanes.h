/* phong_lanes: phong.c for many directions at once; see bis/bsdf.h, bis_bsdf_lanes. */
#ifndef BIS_PHONG_LANES_H
#define BIS_PHONG_LANES_H

#include "bis/thesis/bsdf.h"

extern const bis_bsdf_lanes bis_phong_lanes;

#endif
