/* clone_phong_lanes: see clones.h. */
#define BIS_ONE_CLONE
#define bis_phong_model plainx_model
#define bis_phong plainx_phong
#define bis_phong_power plainx_power
#define bis_phong_lobe_pdf plainx_lobe_pdf
#define bis_phong_lobe_sample plainx_lobe_sample
#define bis_phong_lanes plain_phong_lanes
#include "thesis/phong.c"
