/* clone_avx2_phong_lanes: see clones.h. */
#define BIS_ONE_CLONE
#define bis_phong_model avx2x_model
#define bis_phong avx2x_phong
#define bis_phong_power avx2x_power
#define bis_phong_lobe_pdf avx2x_lobe_pdf
#define bis_phong_lobe_sample avx2x_lobe_sample
#define bis_phong_lanes avx2_phong_lanes
#include "bis/thesis/lanes.h"
#if defined(__x86_64__)
#undef BIS_LANES
#define BIS_LANES __attribute__((target("avx2")))
#endif
#include "thesis/phong.c"
