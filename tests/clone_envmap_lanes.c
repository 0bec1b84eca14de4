/* clone_envmap_lanes: see clones.h. */
#define BIS_ONE_CLONE
#define bis_envmap_pixels plain_envmap_pixels
#include "../src/beyond/envmap_lanes.c"
