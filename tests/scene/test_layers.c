/* SPDX-License-Identifier: BSD-2-Clause */
/* layers: what a film carries beside its colours is what its name says, and costs only those who ask. Family-wise
 * significance of the statistical tests: 0.01. */
#include "bis/base/mem.h"
#include "bis/thesis/phong.h"
#include "bis/thesis/rng.h"
#include "bis/base/stats.h"

#include "claim.h"
#include "world.h"

#include <math.h>
#include <string.h>

/* The plane of that name, or a failure. */
static const float *plane_of(const bis_film *f, const char *name, float *planes)
{
    bis_channel channels[BIS_FILM_MAX_CHANNELS];
    int n = bis_film_layers(f, channels, planes);
    for (int i = 0; i < n; i++)
        if (strcmp(channels[i].name, name) == 0) return channels[i].data;
    fail_msg("no channel \"%s\"", name);
    return NULL;
}

static float *new_planes(const bis_film *f)
{
    float *planes = bis_alloc((size_t)f->width * (size_t)f->height, BIS_FILM_MAX_CHANNELS * sizeof *planes);
    assert_non_null(planes);
    return planes;
}

static double sum_of(const float *plane, const bis_film *f)
{
    double sum = 0;
    for (int i = 0; i < f->width * f->height; i++) sum += (double)plane[i];
    return sum;
}

/* ---- names ---- */

static void every_layer_is_found_by_its_name_and_all_are_all(void **state)
{
    unsigned all = 0, together = 0;
    for (int i = 0; i < BIS_N_LAYERS; i++) {
        unsigned set = 0;
        assert_true(bis_layers_include(&set, bis_layer_name((bis_layer)i)));
        assert_int_equal(set, 1u << i);
        together |= set;
    }
    assert_true(bis_layers_include(&all, "all"));
    assert_int_equal(all, together);
    assert_false(bis_layers_include(&all, "Albedo"));
    assert_string_equal(bis_layer_nearest("Albedo"), "albedo");
    assert_null(bis_layer_nearest("motion"));
}

static void channels_have_names_that_an_EXR_can_hold_and_no_name_twice(void **state)
{
    bis_film f;
    bis_channel c[BIS_FILM_MAX_CHANNELS];
    assert_int_equal(bis_film_init(&f, 1, 1, whole, (bis_loc){0}, NULL), BIS_OK);
    assert_int_equal(bis_film_want(&f, BIS_LAYERS_ALL, NULL), BIS_OK);
    f.passes = 2;
    int n = bis_film_layers(&f, c, NULL);
    assert_int_equal(n, 3 + 3 + 1 + 1 + 1 + 3 + 1 + 3 + 3 + 1);
    for (int i = 0; i < n; i++) {
        assert_true(strlen(c[i].name) < 32); /* what every reader takes */
        for (int j = 0; j < i; j++) assert_string_not_equal(c[i].name, c[j].name);
    }
    bis_film_clear(&f);
}

/* ---- cost ---- */

static void asking_for_layers_changes_no_bit_of_the_picture_and_no_count(void **state)
{
    for (int i = -1; i < 0 || bis_integrators[i]; i++) {
        world w;
        bis_film plain, layered;
        bis_render_result a, b;
        make_world(&w, i < 0 ? &bis_sir : bis_integrators[i]);
        if (i < 0) { /* learns from pass to pass: from the picture's own rays alone */
            w.desc.view.settings.proposal = BIS_PROPOSAL_PRODUCT;
            w.desc.view.settings.candidates = 64;
            w.desc.view.settings.learn = true;
        }
        render(&plain, &a, &w, whole, &(bis_render_options){.budget = {.spp = 3}});
        render_layers(&layered, &b, &w, whole, BIS_LAYERS_ALL, &(bis_render_options){.budget = {.spp = 3}});
        assert_same_bits(&plain, &layered);
        assert_memory_equal(&a.counters, &b.counters, sizeof a.counters);
        bis_film_clear(&plain);
        bis_film_clear(&layered);
        clear_world(&w);
    }
}

static void layers_have_the_same_bits_for_any_number_of_threads(void **state)
{
    world w;
    bis_film one, many;
    bis_render_result result;
    make_world(&w, &bis_sir);
    render_layers(
        &one, &result, &w, whole, BIS_LAYERS_ALL, &(bis_render_options){.budget = {.spp = 3}, .n_threads = 1});
    render_layers(
        &many, &result, &w, whole, BIS_LAYERS_ALL, &(bis_render_options){.budget = {.spp = 3}, .n_threads = 5});
    assert_memory_equal(
        one.layers.sum, many.layers.sum, (size_t)one.layers.n_values * WIDTH * HEIGHT * sizeof *one.layers.sum);
    bis_film_clear(&one);
    bis_film_clear(&many);
    clear_world(&w);
}

/* ---- values ---- */

static void counts_of_pixels_add_up_to_the_counts_of_the_render(void **state)
{
    for (int i = 0; bis_integrators[i]; i++) {
        world w;
        bis_film f;
        bis_render_result result;
        make_world(&w, bis_integrators[i]);
        render_layers(&f, &result, &w, whole, BIS_LAYERS_ALL, &(bis_render_options){.budget = {.spp = 3}});
        float *planes = new_planes(&f);
        assert_true(sum_of(plane_of(&f, "samples.Y", planes), &f) == (double)result.counters.camera_rays);
        assert_true(sum_of(plane_of(&f, "shadowrays.Y", planes), &f) == (double)result.counters.shadow_rays);
        assert_true(sum_of(plane_of(&f, "candidates.Y", planes), &f) == (double)result.counters.candidates);
        bis_free(planes);
        bis_film_clear(&f);
        clear_world(&w);
    }
}

/* Through pixel centres the floor's depth, normal and albedo are known; the camera stands at z = -3 and looks along
 * +z. */
static void depth_normal_and_albedo_are_those_of_the_floor(void **state)
{
    world w;
    bis_film f;
    bis_render_result result;
    make_world(&w, &noise);
    w.desc.view.pixel_jitter = false;
    render_layers(&f, &result, &w, whole, BIS_LAYERS_ALL, &(bis_render_options){.budget = {.spp = 2}});
    float *planes = new_planes(&f);
    const float *z = plane_of(&f, "Z", planes), *up = plane_of(&f, "Ns.Y", planes),
                *red = plane_of(&f, "Albedo.R", planes), *blue = plane_of(&f, "Albedo.B", planes);
    for (int x = 0; x < WIDTH; x++) {
        size_t i = (size_t)((HEIGHT - 1) * WIDTH + x);
        ray r = bis_camera_ray(&w.desc.view.camera, WIDTH, HEIGHT, x + 0.5, HEIGHT - 0.5);
        double t = (-1 - (double)r.o.y) / (double)r.d.y;
        assert_true(fabs((double)z[i] - t * (double)r.d.z) < 1e-5);
        assert_true(up[i] == 1);
        assert_true(red[i] == 0.5f + 0.2f && blue[i] == 0.3f + 0.2f);
        assert_true(z[x] == 0 && up[x] == 0 && red[x] == 0); /* the sky */
    }
    bis_free(planes);
    bis_film_clear(&f);
    clear_world(&w);
}

/* A camera whose transformation scales by 3, 1 and 2: there the ball is an ellipsoid, |q'| = 1 with q' = S^-1 (q - c),
 * and its normal the gradient S^-1 q'. The twin, S q', is what a normal that is taken for a vector would be. */
static void normals_stand_on_what_a_scaled_camera_sees(void **state)
{
    static const double S[3] = {3, 1, 2};
    world w;
    bis_film f;
    bis_render_result result;
    bis_xform look;
    make_world(&w, &noise);
    w.desc.view.pixel_jitter = false;
    assert_true(bis_xform_look_at(&look, (double[3]){2, 1.5, -1}, (double[3]){0, 0, 0}, (double[3]){0, 1, 0}));
    const bis_xform scale = bis_xform_scale(S[0], S[1], S[2]), to_camera = bis_xform_compose(&scale, &look);
    w.desc.view.camera.to_world = bis_xform_inverse(&to_camera);
    render_layers(&f, &result, &w, whole, BIS_LAYERS_ALL, &(bis_render_options){.budget = {.spp = 1}});
    float *planes = new_planes(&f);
    const float *Z = plane_of(&f, "Z", planes),
                *N[3] = {plane_of(&f, "Ns.X", planes), plane_of(&f, "Ns.Y", planes), plane_of(&f, "Ns.Z", planes)};
    const vec3 c = bis_xform_point(&to_camera, (vec3){0, 0, 0});
    const double centre[3] = {(double)c.x, (double)c.y, (double)c.z},
                 half = tan(PI / 6) / (WIDTH < HEIGHT ? WIDTH : HEIGHT);
    int n_hits = 0, n_twin = 0;
    for (size_t i = 0; i < WIDTH * HEIGHT; i++) {
        const double z = (double)Z[i], q[3] = {z * half * (2 * (double)(i % WIDTH) + 1 - WIDTH),
                                           z * half * (HEIGHT - 2 * (double)(i / WIDTH) - 1), z};
        double own[3], to_surface = 0, gradient = 0, cos_right = 0, cos_twin = 0, twin = 0;
        for (int k = 0; k < 3; k++) own[k] = (q[k] - centre[k]) / S[k], to_surface += own[k] * own[k];
        if (!(fabs(to_surface - 1) < 1e-4)) continue; /* the floor, or the sky */
        for (int k = 0; k < 3; k++) gradient += pow(own[k] / S[k], 2), twin += pow(own[k] * S[k], 2);
        for (int k = 0; k < 3; k++)
            cos_right += (double)N[k][i] * own[k] / S[k] / sqrt(gradient),
                cos_twin += (double)N[k][i] * own[k] * S[k] / sqrt(twin);
        n_hits++;
        n_twin += cos_twin < 0.99;
        if (!(fabs(cos_right - 1) < 1e-5))
            fail_msg("pixel %zu: the cosine between the normal and the ellipsoid's is %.7f", i, cos_right);
    }
    if (n_hits < 40 || n_twin <= n_hits / 2) fail_msg("%d pixels, the twin fails in %d", n_hits, n_twin);
    bis_free(planes);
    bis_film_clear(&f);
    clear_world(&w);
}

/* L_ns by the integrator's own road, against integrator `unoccluded`, in the mean over the picture (its standard error
 * is 0.3%), and V = L/L_ns. */
static void unoccluded_is_L_ns_and_visibility_is_L_over_L_ns(void **state)
{
    const bis_integrator *const all[] = {&bis_em, &bis_brdf, &bis_mis, &bis_rejection, &bis_sir, &bis_exact};
    for (int i = 0; i < 6; i++) {
        world w;
        bis_film f, open;
        bis_render_result result;
        const uint32_t spp = all[i] == &bis_exact ? 2 : 40;
        make_world(&w, all[i]);
        w.desc.light.visible = false;
        w.desc.view.pixel_jitter = false;
        w.desc.view.settings.samples = 16;
        render_layers(&f, &result, &w, whole, BIS_LAYERS_ALL, &(bis_render_options){.budget = {.spp = spp}});
        w.desc.view.settings = bis_settings_default(&bis_unoccluded);
        w.desc.view.settings.candidates = 64;
        w.desc.view.sampler.seed = 7;
        render(&open, &result, &w, whole, &(bis_render_options){.budget = {.spp = 20}});
        float *planes = new_planes(&f);
        const float *L_ns = plane_of(&f, "unoccluded.G", planes), *V = plane_of(&f, "visibility.Y", planes);
        double mean = 0, expected = 0, hidden = 0;
        for (size_t k = 0; k < WIDTH * HEIGHT; k++) {
            mean += (double)L_ns[k];
            expected += open.sum[3 * k + 1] / open.weight;
            hidden += V[k] < 0.9f && f.hits[k] > 0;
            /* Sample by sample L <= L_ns; both are rounded to floats. */
            assert_true(V[k] >= 0 && V[k] <= 1 + 1e-5f);
        }
        assert_true(fabs(mean - expected) < 0.02 * expected);
        assert_true(hidden > 50); /* below the ball */
        bis_free(planes);
        bis_film_clear(&f);
        bis_film_clear(&open);
        clear_world(&w);
    }
}

/* Where a pixel is half sky. The integrator `place` returns p + 10 and the sky is black, so the film's own colours say
 * what depth is: the mean over the samples that hit. Albedo and normal are means over all samples: the columns at the
 * left see only the floor. */
static void in_pixels_half_sky_depth_is_of_the_hits_and_the_rest_of_all_samples(void **state)
{
    world w;
    bis_film f;
    bis_render_result result;
    int n_mixed = 0;
    make_world(&w, &place);
    w.desc.light.visible = false;
    bis_sampler_set_spp(&w.desc.view.sampler, 16);
    render_layers(&f, &result, &w, whole, BIS_LAYERS_ALL, &(bis_render_options){.budget = {.spp = 16}});
    float *planes = new_planes(&f);
    const float *z = plane_of(&f, "Z", planes), *up = plane_of(&f, "Ns.Y", planes), *green = plane_of(&f, "Albedo.G",
        planes);
    for (size_t i = 0; i < WIDTH * HEIGHT; i++) {
        const double hits = (double)f.hits[i], share = hits / 16;
        if (hits == 0) continue;
        assert_true(fabs((double)z[i] - (f.sum[3 * i + 2] / hits - 10 + 3)) < 1e-5); /* the camera stands at z = -3 */
        if (i % WIDTH >= 4) continue;
        assert_true(fabs((double)up[i] - share) < 1e-6 && fabs((double)green[i] - share * (0.4 + 0.2)) < 1e-6);
        n_mixed += hits < 16;
    }
    assert_true(n_mixed >= 3);
    bis_free(planes);
    bis_film_clear(&f);
    clear_world(&w);
}

/* A diffuse square whose shading normals lean by 60 degrees, under a constant light: by the BRDF's samples every
 * estimate of L_ns is Kd itself, whatever lies below the geometric surface; L lacks what does, and V is what is left:
 * (1 + cos 60)/2 of the cosine. */
static void unoccluded_has_no_surface_below_which_it_is_dark(void **state)
{
    const vec3 corners[4] = {{-9, -9, 0.3f}, {9, -9, 0.3f}, {9, 9, 0.3f}, {-9, 9, 0.3f}};
    const uint32_t index[6] = {0, 2, 1, 0, 3, 2};
    const bis_xform identity = bis_xform_identity();
    bis_mesh m = {.n_vertices = 4, .n_triangles = 2};
    world w;
    bis_film f;
    bis_render_result result;

    make_world(&w, &bis_brdf);
    clear_world(&w);
    w.scene = (bis_scene){.desc = &w.desc};
    w.materials[0] = bis_phong((rgb){0.5f, 0.25f, 0.125f}, (rgb){0, 0, 0}, 1);
    m.p = bis_alloc(4, sizeof *m.p);
    m.n = bis_alloc(4, sizeof *m.n);
    m.index = bis_alloc(6, sizeof *m.index);
    memcpy(m.p, corners, sizeof corners);
    memcpy(m.index, index, sizeof index);
    for (int i = 0; i < 4; i++) m.n[i] = vec3_from(sqrt(0.75), 0, -0.5);
    assert_int_equal(bis_geometry_add_mesh(&w.scene.geometry, &m, &identity, 0, NULL), BIS_OK);
    bis_mesh_clear(&m);
    assert_int_equal(bis_accel_new(&w.scene.accel, &w.scene.geometry, &(bis_accel_options){.kind = BIS_ACCEL_GRID},
        NULL), BIS_OK);
    assert_int_equal(bis_light_constant(&w.scene.light, (rgb){1, 1, 1}, NULL), BIS_OK);
    render_layers(&f, &result, &w, (double[4]){0.45, 0.55, 0.4, 0.6}, BIS_LAYERS_ALL,
        &(bis_render_options){.budget = {.spp = 200}});
    float *planes = new_planes(&f);
    const float *red = plane_of(&f, "unoccluded.R", planes), *blue = plane_of(&f, "unoccluded.B", planes),
        *V = plane_of(&f, "visibility.Y", planes);
    const int n = f.width * f.height;
    double mean = 0;
    for (int i = 0; i < n; i++) {
        assert_true(fabs((double)red[i] - 0.5) < 1e-5 && fabs((double)blue[i] - 0.125) < 1e-5);
        mean += (double)V[i] / n;
    }
    /* n 200 passes of 4 independent samples of a yes or no of probability 3/4: 7 standard deviations, stratified or
     * not */
    assert_true(n >= 12 && fabs(mean - 0.75) < 7 * sqrt(0.75 * 0.25 / (n * 800.0)));
    bis_free(planes);
    bis_film_clear(&f);
    clear_world(&w);
}

/* ---- error bars ---- */

/* One pixel, passes 1 and 3: s = sqrt 2, standard error 1, t(0.975, 1) = tan(0.475 pi) = 12.706. Passes 1, 3, 5: s = 2,
 * 2/sqrt 3, t(0.975, 2) = 4.30265. */
static void error_bars_are_what_the_formulas_give_by_hand(void **state)
{
    const double se[2] = {1, 2 / sqrt(3)}, t[2] = {tan(0.475 * PI), 4.302652729911275};
    bis_film f;
    float planes[BIS_FILM_MAX_CHANNELS];
    bis_channel channels[BIS_FILM_MAX_CHANNELS];
    assert_int_equal(bis_film_init(&f, 1, 1, whole, (bis_loc){0}, NULL), BIS_OK);
    assert_int_equal(bis_film_want(&f, 1u << BIS_LAYER_STDERR | 1u << BIS_LAYER_INTERVAL, NULL), BIS_OK);
    for (int n = 1; n <= 3; n++) {
        bis_film_add(&f, 0, 0, (rgb){(float)(2 * n - 1), 4, 0}, 1, 1);
        bis_film_end_pass(&f, 1);
        if (n == 1) { /* one pass has no scatter: rather no layer than a wrong one */
            assert_int_equal(bis_film_layers(&f, channels, planes), 0);
            continue;
        }
        assert_true(fabs((double)plane_of(&f, "stderr.R", planes)[0] - se[n - 2]) < 1e-6);
        assert_true(fabs((double)plane_of(&f, "interval.R", planes)[0] / (se[n - 2] * t[n - 2]) - 1) < 1e-6);
        assert_true(plane_of(&f, "stderr.G", planes)[0] == 0 && plane_of(&f, "interval.B", planes)[0] == 0);
    }
    bis_film_clear(&f);
}

/* Of a film without any pass every layer that stands for values is 0. Two passes of weights 1 and 3: a layer's value is
 * its sum by 4, the number of samples the sum itself. */
static void layers_of_no_pass_are_black_and_passes_count_by_their_weight(void **state)
{
    const unsigned asked = 1u << BIS_LAYER_UNOCCLUDED | 1u << BIS_LAYER_ALBEDO | 1u << BIS_LAYER_NORMAL |
                           1u << BIS_LAYER_DEPTH | 1u << BIS_LAYER_VISIBILITY | 1u << BIS_LAYER_SAMPLES;
    bis_film f;
    float planes[BIS_FILM_MAX_CHANNELS];
    bis_channel channels[BIS_FILM_MAX_CHANNELS];
    assert_int_equal(bis_film_init(&f, 1, 1, whole, (bis_loc){0}, NULL), BIS_OK);
    assert_int_equal(bis_film_want(&f, asked, NULL), BIS_OK);
    for (int i = 0; i < BIS_N_LAYERS; i++) /* the header's word for what is not asked for, or has no values */
        if (!(asked >> i & 1)) assert_int_equal(f.layers.first[i], -1);
    assert_int_equal(bis_film_layers(&f, channels, planes), 12);
    for (int i = 0; i < 12; i++)
        if (!(channels[i].data[0] == 0)) fail_msg("%s: %g", channels[i].name, (double)channels[i].data[0]);
    for (int pass = 0; pass < 2; pass++) {
        for (int k = 0; k < 3; k++) f.layers.sum[f.layers.first[BIS_LAYER_ALBEDO] + k] += 6 * (k + 1);
        f.layers.sum[f.layers.first[BIS_LAYER_SAMPLES]] += 6;
        bis_film_add(&f, 0, 0, (rgb){0, 0, 0}, 1, pass ? 3 : 1);
        bis_film_end_pass(&f, pass ? 3 : 1);
    }
    assert_true(plane_of(&f, "Albedo.R", planes)[0] == 3 && plane_of(&f, "Albedo.G", planes)[0] == 6);
    assert_true(plane_of(&f, "Albedo.B", planes)[0] == 9 && plane_of(&f, "samples.Y", planes)[0] == 12);
    bis_film_clear(&f);
}

typedef struct coverage {
    double all, inside, inside_normal; /* inside_normal: a twin that takes 1.96 for t */
} coverage;

/* One film of 1000 pixels of noise about 1, flat and a tent. */
static void cover(coverage *c, uint64_t seed, int passes)
{
    bis_rng rng;
    bis_film f;
    bis_channel channels[BIS_FILM_MAX_CHANNELS];
    float planes[6 * 1000];
    bis_rng_init(&rng, seed, 0, 0, 0);
    assert_int_equal(bis_film_init(&f, 1000, 1, whole, (bis_loc){0}, NULL), BIS_OK);
    assert_int_equal(bis_film_want(&f, 1u << BIS_LAYER_STDERR | 1u << BIS_LAYER_INTERVAL, NULL), BIS_OK);
    for (int pass = 0; pass < passes; pass++) {
        for (int i = 0; i < 1000; i++) {
            double u = bis_rng_double(&rng), v = bis_rng_double(&rng);
            bis_film_add(&f, i, 0, rgb_from(0.5 + u, u + v, 0), 1, 1); /* flat, and a tent */
        }
        bis_film_end_pass(&f, 1);
    }
    bis_film_layers(&f, channels, planes);
    for (int k = 0; k < 2; k++) {
        for (int i = 0; i < 1000; i++) {
            double error = fabs(f.sum[3 * i + k] / passes - 1);
            c->all++;
            c->inside += error <= (double)planes[(3 + k) * 1000 + i];
            c->inside_normal += error <= 1.96 * (double)planes[k * 1000 + i];
        }
    }
    bis_film_clear(&f);
}

static void intervals_cover_93_to_97_percent_of_pixels_from_four_passes_on(void **state)
{
    for (int passes = 4; passes <= 64; passes *= 2) {
        coverage c = {0};
        for (uint64_t seed = 1; seed <= 10; seed++) cover(&c, seed, passes);
        double share = c.inside / c.all, twin = c.inside_normal / c.all;
        if (!(share > 0.93 && share < 0.97)) fail_msg("%d passes: %g", passes, share);
        if (passes == 4 && twin > 0.93) fail_msg("1.96 standard errors of 4 passes cover %g", twin);
    }
}

/* In a rendered picture: 32 independent passes of sir, the truth from 3000 of another seed. The twin takes the 95%
 * point of t, one-sided, for that of both sides. */
static void intervals_cover_93_to_97_percent_of_a_rendered_picture(void **state)
{
    world w;
    bis_film truth, f;
    bis_render_result result;
    const double crop[4] = {0.35, 0.7, 0.4, 0.8};
    const double one_sided = 1.6955 / 2.0395; /* Student's t, 31 degrees of freedom */
    double all = 0, inside = 0, inside_twin = 0;
    make_world(&w, &bis_sir);
    w.desc.view.sampler.kind = BIS_SAMPLER_RANDOM;
    w.desc.view.pixel_jitter = false;
    w.desc.view.settings.shadowrays = 8;
    w.desc.view.sampler.seed = 1000;
    render(&truth, &result, &w, crop, &(bis_render_options){.budget = {.spp = 3000}});
    for (uint64_t seed = 1; seed <= 30; seed++) {
        w.desc.view.sampler.seed = seed;
        render_layers(&f, &result, &w, crop, 1u << BIS_LAYER_INTERVAL, &(bis_render_options){.budget = {.spp = 32}});
        float *planes = new_planes(&f);
        bis_channel channels[BIS_FILM_MAX_CHANNELS];
        const size_t n = (size_t)f.width * (size_t)f.height;
        bis_film_layers(&f, channels, planes);
        for (size_t i = 0; i < n; i++) {
            for (size_t k = 0; k < 3; k++) {
                if (planes[k * n + i] == 0) continue; /* black or the sky */
                const double error = fabs(f.sum[3 * i + k] / f.weight - truth.sum[3 * i + k] / truth.weight),
                             half = (double)planes[k * n + i];
                all++;
                inside += error <= half;
                inside_twin += error <= one_sided * half;
            }
        }
        bis_free(planes);
        bis_film_clear(&f);
    }
    if (!(inside / all > 0.93 && inside / all < 0.97)) fail_msg("%g of %g", inside / all, all);
    if (inside_twin / all > 0.93) fail_msg("the one-sided interval covers %g", inside_twin / all);
    bis_film_clear(&truth);
    clear_world(&w);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_layer_is_found_by_its_name_and_all_are_all),
        cmocka_unit_test(channels_have_names_that_an_EXR_can_hold_and_no_name_twice),
        cmocka_unit_test(asking_for_layers_changes_no_bit_of_the_picture_and_no_count),
        cmocka_unit_test(layers_have_the_same_bits_for_any_number_of_threads),
        cmocka_unit_test(counts_of_pixels_add_up_to_the_counts_of_the_render),
        cmocka_unit_test(depth_normal_and_albedo_are_those_of_the_floor),
        cmocka_unit_test(normals_stand_on_what_a_scaled_camera_sees),
        cmocka_unit_test(unoccluded_is_L_ns_and_visibility_is_L_over_L_ns),
        cmocka_unit_test(in_pixels_half_sky_depth_is_of_the_hits_and_the_rest_of_all_samples),
        cmocka_unit_test(unoccluded_has_no_surface_below_which_it_is_dark),
        cmocka_unit_test(layers_of_no_pass_are_black_and_passes_count_by_their_weight),
        cmocka_unit_test(error_bars_are_what_the_formulas_give_by_hand),
        cmocka_unit_test(intervals_cover_93_to_97_percent_of_pixels_from_four_passes_on),
        cmocka_unit_test(intervals_cover_93_to_97_percent_of_a_rendered_picture),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
