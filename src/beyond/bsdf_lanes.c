/* bsdf_lanes: which models have vector code. The models themselves do not know. */
#include "bis/beyond/bsdf_lanes.h"

#include "bis/thesis/phong.h"
#include "phong_lanes.h"

const bis_bsdf_lanes *bis_bsdf_lanes_of(const bis_bsdf_model *model)
{
    return model == &bis_phong_model ? &bis_phong_lanes : NULL;
}
