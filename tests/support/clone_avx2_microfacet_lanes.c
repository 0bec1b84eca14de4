/* clone_avx2_microfacet_lanes: see clones.h. */
#define BIS_ONE_CLONE
#define bis_microfacet_lanes avx2_microfacet_lanes
#include "bis/beyond/lanes.h"
#if defined(__x86_64__)
#undef BIS_LANES
#define BIS_LANES __attribute__((target("avx2")))
#endif
#include "beyond/microfacet_lanes.c"
