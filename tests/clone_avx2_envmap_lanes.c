/* clone_avx2_envmap_lanes: see clones.h. */
#define BIS_ONE_CLONE
#define bis_envmap_pixels avx2_envmap_pixels
#include "bis/beyond/lanes.h"
#if defined(__x86_64__)
#undef BIS_LANES
#define BIS_LANES __attribute__((target("avx2")))
#endif
#include "../src/beyond/envmap_lanes.c"
