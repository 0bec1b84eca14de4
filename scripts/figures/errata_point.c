/* SPDX-License-Identifier: BSD-2-Clause */
/* errata_point: a point under a painted map, in the open or half hidden, and what an integrator says of it. */
#include "still.h"

#include "bis/base/mem.h"
#include "bis/scene/light_load.h"

void errata_map(bis_envmap *em, int width, int height, errata_paint *paint)
{
    bis_image image;

    still_check(bis_image_init(&image, width, height, NULL));
    for (int i = 0; i < width * height; i++) image.pixels[i] = paint(i % width, i / width, width, height);
    still_check(bis_envmap_from_latlong(em, &image, NULL));
}

bis_light *errata_light(int width, int height, errata_paint *paint, bis_table_kind kind)
{
    const bis_light_desc desc = {
        .L = {1, 1, 1}, .scale = 1, .levels = 8, .table_kind = kind, .to_world = bis_xform_identity()};
    bis_light *light;
    bis_envmap em;

    errata_map(&em, width, height, paint);
    still_check(bis_light_from_envmap(&light, &em, &desc, BIS_NEED_TABLE | BIS_NEED_CURVE, NULL));
    return light;
}

static bool hidden_behind(const bis_accel *a, const ray *r)
{
    (void)a;
    return r->d.y > 0;
}

static bool open_sky(const bis_accel *a, const ray *r)
{
    (void)a;
    (void)r;
    return false;
}

static const bis_accel_ops half = {.name = "half", .occluded = hidden_behind},
                           whole = {.name = "whole", .occluded = open_sky};

void errata_spot_init(errata_spot *s, const bis_light *light, bis_material m, vec3 n, double degrees, bool half_hidden)
{
    const double t = degrees * PI / 180;
    const frame about_n = frame_about(n);

    *s = (errata_spot){.accel = {.ops = half_hidden ? &half : &whole}, .material = m};
    s->pt = (bis_point){.n = n, .ng = n, .light = light, .accel = &s->accel, .counters = &s->counters};
    s->pt.wo = normalize(to_world(&about_n, vec3_from(sin(t), 0, cos(t))));
    bis_bsdf_init(&s->pt.bsdf, &s->material, n, s->pt.wo);
}

errata_moments errata_run(errata_spot *s, const bis_settings *settings, uint32_t runs)
{
    const bis_sampler sampler = {
        .kind = BIS_SAMPLER_RANDOM, .seed = ERRATA_SEED, .spp = 1, .xsamples = 1, .ysamples = 1};
    double mean = 0, m2 = 0;
    bis_scratch scratch;

    still_check(bis_scratch_init(&scratch, settings, NULL));
    for (uint32_t run = 0; run < runs; run++) { /* Welford 1962 */
        bis_stream stream;
        bis_stream_init(&stream, &sampler, run, 0);
        const double L = rgb_sum(settings->integrator->Lo(settings, &s->pt, &stream, &scratch)), d = L - mean;
        mean += d / (run + 1);
        m2 += d * (L - mean);
    }
    bis_scratch_clear(&scratch);
    return (errata_moments){mean, m2 / (runs - 1)};
}
