/* bsdf_lanes: which models have vector code. The models themselves do not know. */
#include "bis/beyond/bsdf_lanes.h"

#include "bis/beyond/microfacet.h"
#include "bis/thesis/phong.h"
#include "microfacet_lanes.h"
#include "phong_lanes.h"

const bis_bsdf_lanes *bis_bsdf_lanes_of(const bis_bsdf_model *model)
{
    if (model == &bis_phong_model) return &bis_phong_lanes;
    if (model == &bis_microfacet_model || model == &bis_plastic_model) return &bis_microfacet_lanes;
    return NULL;
}
