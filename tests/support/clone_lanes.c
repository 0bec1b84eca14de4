/* clone_lanes: see clones.h. */
#define BIS_ONE_CLONE
#define bis_lanes_points plain_lanes_points
#include "beyond/lanes.c"
