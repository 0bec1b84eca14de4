/* SPDX-License-Identifier: BSD-2-Clause */
/* world: see world.h. */
#include "world.h"

#include "bis/base/mem.h"
#include "bis/thesis/phong.h"
#include "bis/scene/light_load.h"
#include "claim.h"

#include <math.h>
#include <string.h>

static void add_floor(bis_geometry *g)
{
    const vec3 corners[4] = {{-9, -1, -9}, {9, -1, -9}, {9, -1, 9}, {-9, -1, 9}};
    const uint32_t index[6] = {0, 1, 2, 0, 2, 3};
    const bis_xform identity = bis_xform_identity();
    bis_mesh m = {.n_vertices = 4, .n_triangles = 2};
    m.p = bis_alloc(4, sizeof *m.p);
    m.index = bis_alloc(6, sizeof *m.index);
    memcpy(m.p, corners, sizeof corners);
    memcpy(m.index, index, sizeof index);
    assert_int_equal(bis_geometry_add_mesh(g, &m, &identity, 0, NULL), BIS_OK);
    bis_mesh_clear(&m);
}

static bis_light *random_light(const bis_light_desc *desc)
{
    bis_image image;
    bis_envmap em;
    bis_light *light;
    bis_rng rng;
    bis_rng_init(&rng, 5, 0, 0, 0);
    assert_int_equal(bis_image_init(&image, 16, 8, NULL), BIS_OK);
    for (int i = 0; i < 16 * 8; i++) {
        double v = pow(bis_rng_double(&rng), 4);
        image.pixels[i] = rgb_from(v, v * bis_rng_double(&rng), v / 2);
    }
    assert_int_equal(bis_envmap_from_latlong(&em, &image, NULL), BIS_OK);
    assert_int_equal(bis_light_from_envmap(&light, &em, desc, BIS_NEED_TABLE | BIS_NEED_CURVE, NULL), BIS_OK);
    return light;
}

void make_world(world *w, const bis_integrator *integrator)
{
    *w = (world){0};
    bis_scene_desc *d = &w->desc;
    w->scene.desc = d;
    w->materials[0] = bis_phong((rgb){0.5f, 0.4f, 0.3f}, (rgb){0.2f, 0.2f, 0.2f}, 20);
    w->materials[1] = bis_phong((rgb){0.1f, 0.4f, 0.3f}, (rgb){0.5f, 0.5f, 0.2f}, 100);
    d->materials = w->materials;
    d->n_materials = 2;
    w->shapes[0] = (bis_shape_desc){.kind = BIS_SHAPE_TRIANGLES, .material = 0};
    w->shapes[1] = (bis_shape_desc){.kind = BIS_SHAPE_SPHERE, .material = 1};
    d->shapes = w->shapes;
    d->n_shapes = 2;
    d->view.camera = (bis_camera){.fov_deg = 60, .to_world = bis_xform_translate(0, 0, -3)};
    d->view.sampler = (bis_sampler){.kind = BIS_SAMPLER_STRATIFIED, .seed = 1, .jitter = true};
    bis_sampler_set_spp(&d->view.sampler, 4);
    d->view.pixel_jitter = true;
    d->view.settings = bis_settings_default(integrator);
    d->view.settings.candidates = 24;
    d->view.settings.shadowrays = 3;
    d->view.settings.samples = 4;
    d->has_light = true;
    d->light = (bis_light_desc){.L = {1, 1, 1},
        .scale = 1,
        .area_exponent = 0.15,
        .levels = 8,
        .visible = true,
        .to_world = bis_xform_identity()};

    bis_geometry *g = &w->scene.geometry;
    const bis_quadric ball = {.kind = BIS_SPHERE, .radius = 1, .to_world = bis_xform_identity(), .material = 1};
    const bis_accel_options accel = {.kind = BIS_ACCEL_GRID};
    add_floor(g);
    assert_int_equal(bis_geometry_add_quadric(g, &ball, NULL), BIS_OK);
    assert_int_equal(bis_accel_new(&w->scene.accel, g, &accel, NULL), BIS_OK);
    w->scene.light = random_light(&d->light);
}

void clear_world(world *w)
{
    bis_accel_free(w->scene.accel);
    bis_geometry_clear(&w->scene.geometry);
    bis_light_free(w->scene.light);
}

const double whole[4] = {0, 1, 0, 1};

void render(
    bis_film *film, bis_render_result *result, const world *w, const double crop[4], const bis_render_options *options)
{
    assert_int_equal(bis_film_init(film, WIDTH, HEIGHT, crop, (bis_loc){0}, NULL), BIS_OK);
    assert_int_equal(bis_render(result, film, &w->scene, &w->desc.view, options, NULL), BIS_OK);
}

void render_layers(bis_film *film, bis_render_result *result, const world *w, const double crop[4], unsigned layers,
    const bis_render_options *options)
{
    assert_int_equal(bis_film_init(film, WIDTH, HEIGHT, crop, (bis_loc){0}, NULL), BIS_OK);
    assert_int_equal(bis_film_want(film, layers, NULL), BIS_OK);
    assert_int_equal(bis_render(result, film, &w->scene, &w->desc.view, options, NULL), BIS_OK);
}

long first_k_without_failure(const world *w, unsigned layers)
{
    for (long k = 1;; k++) {
        bis_film film = {0};
        bis_render_result result;
        bis_diag diag = {0};
        bis_mem_fail_at(k);
        bis_status status = bis_film_init(&film, WIDTH, HEIGHT, whole, (bis_loc){0}, &diag);
        if (!status && layers) status = bis_film_want(&film, layers, &diag);
        if (!status)
            status = bis_render(&result, &film, &w->scene, &w->desc.view,
                &(bis_render_options){.budget = {.spp = 1}, .n_threads = 2}, &diag);
        bis_mem_fail_at(0);
        bis_film_clear(&film);
        const size_t n_errors = diag.n_errors;
        for (size_t i = 0; i < diag.n; i++)
            assert_null(strstr(diag.messages[i].text, "for 0 ")); /* the size that there was no room for */
        bis_diag_clear(&diag);
        if (status == BIS_OK) return k;
        assert_int_equal(status, BIS_NOMEM);
        assert_int_equal(n_errors, 1);
        assert_in_range(k, 1, 200);
    }
}

void assert_same_bits(const bis_film *a, const bis_film *b)
{
    size_t n = (size_t)a->width * (size_t)a->height;
    assert_int_equal(a->passes, b->passes);
    assert_memory_equal(a->sum, b->sum, 3 * n * sizeof *a->sum);
    assert_memory_equal(a->deviation, b->deviation, 3 * n * sizeof *a->deviation);
    assert_memory_equal(a->hits, b->hits, n * sizeof *a->hits);
    /* a film that a test has put together may have none */
    for (size_t i = 0; a->twin && b->twin && i < BIS_TWIN_VALUES * bis_film_twins(a); i += BIS_TWIN_VALUES)
        assert_memory_equal(a->twin + i, b->twin + i, 3 * sizeof *a->twin);
}

/* ---- integrators of our own ---- */

unsigned no_light_needs(const bis_settings *s)
{
    return 0;
}

void no_scratch(const bis_settings *s, bis_needs *need)
{
}

/* A random number, hence noise. */
rgb noise_Lo(const bis_settings *s, const bis_point *pt, bis_stream *stream, bis_scratch *scratch)
{
    double u = bis_stream_random(stream);
    return rgb_from(u, 0.5 + u, 1);
}

/* The place: what a camera ray saw. */
static rgb place_Lo(const bis_settings *s, const bis_point *pt, bis_stream *stream, bis_scratch *scratch)
{
    return (rgb){pt->p.x + 10, pt->p.y + 10, pt->p.z + 10};
}

/* NaN or infinity for a quarter of the samples. */
static rgb sick_Lo(const bis_settings *s, const bis_point *pt, bis_stream *stream, bis_scratch *scratch)
{
    double u = bis_stream_random(stream);
    return (rgb){1, u < 0.125 ? NAN : u < 0.25 ? INFINITY : 1, 1};
}

const bis_integrator noise = {.name = "noise", .light_needs = no_light_needs,
                              .scratch_needs = no_scratch, .Lo = noise_Lo};
const bis_integrator place = {.name = "place", .light_needs = no_light_needs,
                              .scratch_needs = no_scratch, .Lo = place_Lo};
const bis_integrator sick = {.name = "sick", .light_needs = no_light_needs, .scratch_needs = no_scratch, .Lo = sick_Lo};

atomic_long world_calls;
volatile sig_atomic_t world_flag;
static atomic_long fuse;

void set_fuse(long n)
{
    world_calls = 0;
    world_flag = 0;
    fuse = n;
}

static rgb fuse_Lo(const bis_settings *s, const bis_point *pt, bis_stream *stream, bis_scratch *scratch)
{
    if (atomic_fetch_add(&world_calls, 1) + 1 == fuse) __atomic_store_n(&world_flag, 1, __ATOMIC_RELAXED);
    return noise_Lo(s, pt, stream, scratch);
}

const bis_integrator fused = {.name = "fused", .light_needs = no_light_needs, .scratch_needs = no_scratch,
                              .Lo = fuse_Lo};
