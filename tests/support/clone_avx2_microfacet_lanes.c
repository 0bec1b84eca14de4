/* clone_avx2_microfacet_lanes: see clones.h. */
#define BIS_ONE_CLONE
#define bis_microfacet_f_pdf_double avx2m_f_pdf
#define bis_microfacet_lanes avx2_microfacet_lanes
#include "bis/thesis/lanes.h"
#if defined(__x86_64__)
#undef BIS_LANES
#define BIS_LANES __attribute__((target("avx2")))
#endif
#include "beyond/microfacet_lanes.c"
