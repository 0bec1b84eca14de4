/* SPDX-License-Identifier: BSD-2-Clause */
/* lit: the light, the point and its estimates, see lit.h. */
#include "lit.h"

#include "bis/base/mem.h"
#include "bis/scene/light_load.h"
#include "claim.h"

enum { W = LIT_WIDTH, H = LIT_HEIGHT, BLOCK = 8 };

/* ---- the light ---- */

/* Any numbers will do: a fixed scramble of x and y in [0, 1). */
static double scramble(int x, int y, int salt)
{
    return (double)((x * 7919 + y * 104729 + salt * 1299709) % 1009) / 1009;
}

static rgb spotty(int px, int py)
{
    int x = px / BLOCK, y = py / BLOCK;
    double i = pow(10, 4 * scramble(x, y, 0) - 2);

    if (px == 90 && py == 18) return (rgb){57600, 44800, 25600};                       /* the sun */
    if (px % BLOCK == 3 && py % BLOCK == 5 && (x + y) % 3 == 0) return (rgb){90, 30, 60}; /* lamps */
    if ((x + y) % 5 == 0) return (rgb){0, 0, 0};
    return rgb_from(i * scramble(x, y, 1), i * scramble(x, y, 2), i * scramble(x, y, 3));
}

static rgb pixel(lit_map map, int x, int y)
{
    double phi = 2 * PI * x / W;

    switch (map) {
    case LIT_SPOTTY: return spotty(x, y);
    case LIT_SMOOTH: return rgb_from(1 + cos(phi), 1.2 - cos(2 * phi), 1 + 0.5 * sin(phi) + 1.6 * y / H);
    case LIT_RED_BLUE: return x < W / 2 ? (rgb){1, 0, 0} : (rgb){0, 0, 1};
    case LIT_ONE_BLOCK: return x / BLOCK == 12 && y / BLOCK == 2 ? (rgb){3, 2, 1} : (rgb){0, 0, 0};
    case LIT_BELOW: return y / BLOCK == H / BLOCK - 1 ? (rgb){1, 1, 1} : (rgb){0, 0, 0};
    default: return (rgb){0, 0, 0};
    }
}

bis_light *lit_new_light(lit_map map, double scale, double area_exponent, bool compensate)
{
    const unsigned needs = BIS_NEED_TABLE | BIS_NEED_CURVE | (compensate ? BIS_NEED_COMPENSATED : 0);
    const bis_light_desc desc = {
        .L = {1, 1, 1}, .scale = 1, .area_exponent = area_exponent, .levels = 8, .to_world = bis_xform_identity()};
    bis_image image = {.width = W, .height = H};
    bis_light *light;
    bis_envmap em;

    if (map == LIT_CONSTANT) {
        assert_int_equal(bis_light_constant(&light, rgb_from(scale, scale / 2, scale / 4), NULL), BIS_OK);
        return light;
    }
    image.pixels = bis_alloc(W * H, sizeof *image.pixels);
    for (int i = 0; i < W * H; i++) image.pixels[i] = rgb_scale(pixel(map, i % W, i / W), scale);
    assert_int_equal(bis_envmap_from_latlong(&em, &image, NULL), BIS_OK);
    assert_int_equal(bis_light_from_envmap(&light, &em, &desc, needs, NULL), BIS_OK);
    return light;
}

/* ---- the point ---- */

static bool occluded(const bis_accel *a, const ray *r)
{
    const lit_accel *l = (const lit_accel *)a;

    if (l->rays && l->rays->n < LIT_RAYS) l->rays->to[l->rays->n++] = r->d;
    return lit_is_hidden(l->hidden, (double)r->d.y);
}

static const bis_accel_ops fake = {.name = "fake", .occluded = occluded};

void lit_init(lit *l, bis_light *light, bis_material m, vec3 n, double degrees, lit_hidden hidden)
{
    double t = degrees * PI / 180;

    *l = (lit){.light = light,
        .accel = {.accel = {.ops = &fake}, .hidden = hidden},
        .material = m,
        .kind = BIS_SAMPLER_STRATIFIED};
    l->pt = (bis_point){.n = n, .ng = n, .light = light, .accel = &l->accel.accel, .counters = &l->counters};
    const frame about_n = frame_about(n);
    l->pt.wo = normalize(to_world(&about_n, vec3_from(sin(t) * 0.6, sin(t) * 0.8, cos(t))));
    bis_bsdf_init(&l->pt.bsdf, &l->material, n, l->pt.wo);
}

rgb lit_once(lit *l, const bis_settings *s, bis_scratch *scratch, uint64_t seed, uint64_t run)
{
    const bis_sampler sampler = {.kind = l->kind, .seed = seed, .spp = 1, .xsamples = 1, .ysamples = 1, .jitter = true};
    bis_stream stream;

    bis_stream_init(&stream, &sampler, run, 0);
    return s->integrator->Lo(s, &l->pt, &stream, scratch);
}
