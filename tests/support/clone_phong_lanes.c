/* clone_phong_lanes: see clones.h. */
#define BIS_ONE_CLONE
#define bis_phong_lanes plain_phong_lanes
#include "beyond/phong_lanes.c"
