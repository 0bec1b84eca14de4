/* clone_map_lanes: see clones.h. */
#define BIS_ONE_CLONE
#define bis_envmap_pixels plain_envmap_pixels
#define bis_light_look plain_light_look
#include "beyond/map_lanes.c"
