/* SPDX-License-Identifier: BSD-2-Clause */
/* gather: what layers want to know of one camera sample.
 *
 * L_ns (eq. 4.5) is L with V = 1, so that is how it is made: the integrator is asked again, with the same random
 * numbers, about the same point in an empty scene. Directions, candidates and weights are those behind L itself; hence
 * L / L_ns is the mean of V over the product (eq. 4.6), with sir within [0,1] sample by sample, and both converge as
 * fast as L does. It costs the candidates a second time, and no ray; only where a layer asks.
 * V = 1 below the geometric surface, too: eq. 4.5 has no V, and unoccluded.c does the same. */
#include "gather.h"

#include "thesis/set.h"

static void put_rgb(float *values, rgb c)
{
    values[0] += c.r;
    values[1] += c.g;
    values[2] += c.b;
}

/* Where the layer's values stand, or NULL. */
static float *place(float *values, const bis_layers *l, bis_layer layer)
{
    return l->first[layer] < 0 ? NULL : values + l->first[layer];
}

static rgb unoccluded(const bis_gathered *of)
{
    bis_counters ignored = {0};
    bis_point open = *of->pt;
    bis_stream stream = of->stream;
    bis_guide *guide = of->scratch->guide;

    if (bis_bsdf_is_black(&open.bsdf)) return (rgb){0};
    open.accel = NULL;
    open.ng = open.n;
    open.counters = &ignored;
    open.ray_sink = NULL;
    const bool learns = guide && guide->learns;
    if (guide) guide->learns = false; /* V = 1 is not to be learned from */
    const rgb L_ns = of->settings->integrator->Lo(of->settings, &open, &stream, of->scratch);
    if (guide) guide->learns = learns;
    return L_ns;
}

/* open: L without shadows. */
static bool gather_light(float *L_ns, float *visibility, rgb open, rgb L)
{
    if (!isfinite((float)rgb_sum(open)) || !isfinite((float)rgb_sum(L))) return false;
    if (L_ns) put_rgb(L_ns, open);
    if (visibility) {
        visibility[0] += (float)rgb_sum(L);
        visibility[1] += (float)rgb_sum(open);
    }
    return true;
}

bool bis_gather_surface(float *values, const bis_layers *layers, const bis_xform *to_camera, const bis_gathered *of)
{
    const bis_point *pt = of->pt;
    float *albedo = place(values, layers, BIS_LAYER_ALBEDO), *normal = place(values, layers, BIS_LAYER_NORMAL),
          *depth = place(values, layers, BIS_LAYER_DEPTH), *L_ns = place(values, layers, BIS_LAYER_UNOCCLUDED),
          *visibility = place(values, layers, BIS_LAYER_VISIBILITY);

    if (albedo) put_rgb(albedo, rgb_add(pt->bsdf.material->Kd, pt->bsdf.material->Ks));
    if (normal) {
        vec3 n = normalize(bis_xform_normal(to_camera, pt->n));
        put_rgb(normal, (rgb){n.x, n.y, n.z});
    }
    if (depth) *depth += bis_xform_point(to_camera, pt->p).z;
    if (!L_ns && !visibility) return true;
    return gather_light(L_ns, visibility, unoccluded(of), of->L);
}

void bis_gather_counts(float *values, const bis_layers *layers, const bis_counters *before, const bis_counters *after)
{
    float *samples = place(values, layers, BIS_LAYER_SAMPLES), *rays = place(values, layers, BIS_LAYER_SHADOWRAYS),
          *candidates = place(values, layers, BIS_LAYER_CANDIDATES);

    if (samples) *samples += (float)(after->camera_rays - before->camera_rays);
    if (rays) *rays += (float)(after->shadow_rays - before->shadow_rays);
    if (candidates) *candidates += (float)(after->candidates - before->candidates);
}

void bis_gather_mean(float *values, const bis_layers *layers, double n)
{
    for (int i = BIS_LAYER_UNOCCLUDED; i < BIS_N_LAYERS; i++) {
        float *value = place(values, layers, (bis_layer)i);
        for (int k = 0; value && k < bis_layer_values((bis_layer)i); k++) value[k] = (float)((double)value[k] / n);
    }
}
