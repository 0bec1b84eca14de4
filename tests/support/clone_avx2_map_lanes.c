/* clone_avx2_map_lanes: see clones.h. */
#define BIS_ONE_CLONE
#define bis_envmap_pixels avx2_envmap_pixels
#define bis_light_look avx2_light_look
#include "bis/thesis/lanes.h"
#if defined(__x86_64__)
#undef BIS_LANES
#define BIS_LANES __attribute__((target("avx2")))
#endif
#include "beyond/map_lanes.c"
