/* SPDX-License-Identifier: BSD-2-Clause */
/* clones: files of src/ with BIS_LANES functions once more, under other names: for the plainest processor
 * (clone_*.c) and for AVX2 (clone_avx2_*.c). What the library holds chooses by the processor that it runs on; all must
 * give the same bits. */
#ifndef TESTS_CLONES_H
#define TESTS_CLONES_H

#include "bis/thesis/bsdf.h"
#include "bis/thesis/envmap.h"
#include "thesis/set.h"

typedef void clone_points(float *u1, float *u2, uint32_t n, uint64_t key);
typedef void clone_pixels(const bis_envmap *em, const vec3 axis[3], uint32_t *pixel, const bis_lanes *y, uint32_t n);
typedef double clone_weigh(bis_set *x, const bis_point *pt);
typedef rgbd clone_mean(const bis_set *x);
typedef void clone_choose(bis_set *x, uint32_t N, bis_resampling resampling, bis_stream *stream);

extern clone_points plain_curve_points, avx2_curve_points;
extern clone_pixels plain_envmap_pixels, avx2_envmap_pixels;
extern clone_weigh plain_set_weigh, avx2_set_weigh;
extern clone_mean plain_set_mean, avx2_set_mean;
extern clone_choose plain_set_choose, avx2_set_choose;
extern const bis_bsdf_many plain_phong_many, avx2_phong_many;
extern const bis_bsdf_many plain_microfacet_many, avx2_microfacet_many, plain_plastic_many, avx2_plastic_many;

/* May avx2_* be called here? */
static inline bool clone_has_avx2(void)
{
#if defined(__x86_64__)
    return __builtin_cpu_supports("avx2");
#else
    return true; /* compiled for what there is */
#endif
}

#endif
