/* clone_avx2_lanes: see clones.h. */
#define BIS_ONE_CLONE
#define bis_lanes_points avx2_lanes_points
#include "bis/thesis/lanes.h"
#if defined(__x86_64__)
#undef BIS_LANES
#define BIS_LANES __attribute__((target("avx2")))
#endif
#include "beyond/lanes.c"
