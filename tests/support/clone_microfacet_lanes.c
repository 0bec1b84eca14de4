/* clone_microfacet_lanes: see clones.h. */
#define BIS_ONE_CLONE
#define bis_microfacet_f_pdf_double plainm_f_pdf
#define bis_microfacet_lanes plain_microfacet_lanes
#include "beyond/microfacet_lanes.c"
