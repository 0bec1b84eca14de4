/* microfacet_lanes: microfacet.c for many directions at once; see bis/beyond/bsdf_lanes.h. */
#pragma once

#include "bis/beyond/bsdf_lanes.h"

extern const bis_bsdf_lanes bis_microfacet_lanes;
