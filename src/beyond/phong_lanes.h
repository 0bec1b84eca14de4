/* phong_lanes: phong.c for many directions at once; see bis/beyond/bsdf_lanes.h. */
#ifndef BIS_PHONG_LANES_H
#define BIS_PHONG_LANES_H

#include "bis/beyond/bsdf_lanes.h"

extern const bis_bsdf_lanes bis_phong_lanes;

#endif
