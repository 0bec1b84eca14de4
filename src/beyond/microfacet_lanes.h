/* microfacet_lanes: microfacet.c for many directions at once. For microfacet.c alone. */
#pragma once

#include "bis/thesis/bsdf.h"

double bis_microfacet_f_many(const bis_reflected *f, const bis_bsdf *b, const bis_lanes *y, uint32_t n);
void bis_microfacet_sample_many(const bis_lanes *y, const bis_bsdf *b, const float *u1, const float *u2, uint32_t n);
void bis_microfacet_reach(float *w, const bis_bsdf *b, const bis_cones *cones, uint32_t n);
rgb bis_microfacet_f_pdf_double(const bis_bsdf *b, vec3 wi, double *pdf);
