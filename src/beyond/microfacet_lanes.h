/* microfacet_lanes: microfacet.c for many directions at once; see bis/beyond/bsdf_lanes.h. */
#ifndef BIS_MICROFACET_LANES_H
#define BIS_MICROFACET_LANES_H

#include "bis/beyond/bsdf_lanes.h"

extern const bis_bsdf_lanes bis_microfacet_lanes;

#endif
