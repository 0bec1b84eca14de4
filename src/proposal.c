/* proposal: one direction from the map or from the BRDF. */
#include "proposal.h"

bool bis_propose_em(bis_light_point *y, const bis_light *light, bis_stream *stream, const double u[2])
{
    double v[4] = {u[0], u[1]};

    v[2] = bis_stream_random(stream);
    v[3] = bis_stream_random(stream);
    return bis_light_sample(light, v, y);
}

bool bis_propose_brdf(vec3 *wi, const bis_bsdf *bsdf, const double u[2])
{
    const double p = bsdf->p_specular;
    double rest = u[0] < p ? u[0] / p : (u[0] - p) / (1 - p);

    rest = fmin(rest, 1 - 0x1p-53); /* u[0] < 1, but the difference and the quotient may round up to 1 */
    return bis_bsdf_sample(bsdf, u[0], rest, u[1], wi);
}
