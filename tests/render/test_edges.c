/* SPDX-License-Identifier: BSD-2-Clause */
/* edges: where outlines cross pixels, and what more camera samples there do. Significance of the one statistical test:
 * 1e-3. */
#include "bis/base/mem.h"
#include "bis/base/stats.h"
#include "bis/beyond/microfacet.h"
#include "bis/thesis/phong.h"
#include "render/edges.h"
#include "claim.h"
#include "stat.h"
#include "world.h"

#include <math.h>
#include <string.h>

static double alpha(void) { return stat_level(1e-3, 1); }

/* A pixel is an edge where some of many rays through it see the background and others the ball or the floor, but for
 * what slips between corners. */
static void edges_are_where_the_picture_is_half_background(void **state)
{
    world w;
    bis_film film;
    bis_render_result result;
    int edges = 0, mixed = 0, missed = 0, n = 0;

    make_world(&w, &place);
    bis_sampler_set_spp(&w.desc.view.sampler, 256);
    render(&film, &result, &w, whole, &(bis_render_options){.budget = {.spp = 256}});
    const bis_rect all = {0, 0, WIDTH, HEIGHT};
    unsigned char *edge = bis_alloc(bis_edges_bytes(all), 1);
    double *turns = bis_edges_turns(&w.desc);
    assert_true(bis_edges_find(edge, all, all, &(bis_edge_eye){&film, &w.scene, &w.desc.view, turns}, 2));
    bis_free(turns);
    for (int i = 0; i < WIDTH * HEIGHT; i++, n++) {
        const double share = (double)film.hits[i] / 256;
        const bool outline = bis_edges_kind(edge, all, i % WIDTH, i / WIDTH) == BIS_EDGE_OUTLINE;
        edges += outline;
        mixed += share > 0.1 && share < 0.9;
        missed += share > 0.1 && share < 0.9 && !outline;
    }
    assert_true(mixed > 10 && missed <= mixed / 10);
    assert_true(edges >= mixed / 2 && edges < n / 2);
    bis_free(edge);
    bis_film_clear(&film);
    clear_world(&w);
}

/* A roof of two planes, z = |x| tan(angle/2), seen head on: normals differ by `angle`, and the ridge crosses the
 * middle column of pixels alone. Both sides have material m; left and right are its numbers, two materials if they
 * differ. Returns how many pixels are of the kind, -1 if any pixel elsewhere is of any kind. */
static int count_ridge(double angle_deg, int left, int right, bis_material m, int kind)
{
    const float far = 90, z = (float)(90 * tan(angle_deg * PI / 360));
    const bis_xform identity = bis_xform_identity();
    bis_material materials[2] = {m, m};
    const bis_scene_desc desc = {.materials = materials, .n_materials = 2};
    world w;
    bis_film film;
    int n = 0;

    make_world(&w, &place);
    clear_world(&w);
    w.scene = (bis_scene){.desc = &w.desc};
    for (int side = 0; side < 2; side++) {
        const float x = side ? far : -far;
        const vec3 corners[4] = {{0, -far, 0}, {0, far, 0}, {x, far, z}, {x, -far, z}};
        const uint32_t index[6] = {0, 1, 2, 0, 2, 3};
        bis_mesh mesh = {.n_vertices = 4, .n_triangles = 2};
        mesh.p = bis_alloc(4, sizeof *mesh.p);
        mesh.index = bis_alloc(6, sizeof *mesh.index);
        memcpy(mesh.p, corners, sizeof corners);
        memcpy(mesh.index, index, sizeof index);
        assert_int_equal(bis_geometry_add_mesh(&w.scene.geometry, &mesh, &identity, (uint32_t)(side ? right : left),
            NULL), BIS_OK);
        bis_mesh_clear(&mesh);
    }
    assert_int_equal(bis_accel_new(&w.scene.accel, &w.scene.geometry, &(bis_accel_options){.kind = BIS_ACCEL_GRID},
        NULL), BIS_OK);
    assert_int_equal(bis_film_init(&film, WIDTH, HEIGHT, whole, (bis_loc){0}, NULL), BIS_OK);
    const bis_rect all = {0, 0, WIDTH, HEIGHT};
    unsigned char *edge = bis_alloc(bis_edges_bytes(all), 1);
    double *turns = bis_edges_turns(&desc);
    assert_true(bis_edges_find(edge, all, all, &(bis_edge_eye){&film, &w.scene, &w.desc.view, turns}, 1));
    bis_free(turns);
    for (int i = 0; i < WIDTH * HEIGHT && n >= 0; i++) {
        const int k = bis_edges_kind(edge, all, i % WIDTH, i / WIDTH);
        if (k) n = i % WIDTH == WIDTH / 2 ? n + (k == kind) : -1;
    }
    bis_free(edge);
    bis_film_clear(&film);
    clear_world(&w);
    return n;
}

/* "normals more than 60 degrees apart", "other materials": on both sides of the bound. */
static void ridges_are_edges_from_60_degrees_on_and_borders_of_materials_always(void **state)
{
    const bis_material matt = bis_phong((rgb){0.5f, 0.5f, 0.5f}, (rgb){0, 0, 0}, 1);
    const int outline = BIS_EDGE_OUTLINE;
    assert_int_equal(count_ridge(58, 0, 0, matt, outline), 0);
    assert_int_equal(count_ridge(58, 0, 0, matt, BIS_EDGE_TURN), 0);
    assert_int_equal(count_ridge(62, 0, 0, matt, outline), HEIGHT);
    assert_int_equal(count_ridge(85, 1, 1, matt, outline), HEIGHT);
    assert_int_equal(count_ridge(0, 0, 0, matt, outline), 0);
    assert_int_equal(count_ridge(0, 0, 1, matt, outline), HEIGHT);
    assert_int_equal(count_ridge(20, 1, 0, matt, outline), HEIGHT);
}

/* Phong's lobe has the density (n + 1)/(2 pi) at its peak, which is that of a cone of cosine 1 - 1/(n + 1): 24.6
 * degrees for n = 10. Half of a diffuse surface makes it sqrt(24.6 * 60) = 38.4. A lobe of n = 0.5 would be wider than
 * a diffuse surface, 70.5 degrees; one of 10^6 narrower than the degree that is asked for at least. */
static void the_turn_that_counts_is_that_of_the_lobe(void **state)
{
    static const struct {
        float kd, ks;
        double n, angle;
    } cases[] = {{0, 0.5f, 10, 24.6}, {0, 0.01f, 10, 24.6}, {0.25f, 0.25f, 10, 38.4}, {0, 1, 50, 11.36}, {0, 1, 1e6, 1},
                 {0, 1, 0.5, 60}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const float d = cases[i].kd, s = cases[i].ks;
        const bis_material m = bis_phong((rgb){d, d, d}, (rgb){s, s, s}, cases[i].n);
        const int above = cases[i].angle * 1.03 > 60 ? BIS_EDGE_OUTLINE : BIS_EDGE_TURN;
        assert_int_equal(count_ridge(cases[i].angle * 0.97, 0, 0, m, BIS_EDGE_TURN), 0);
        assert_int_equal(count_ridge(cases[i].angle * 1.03, 0, 0, m, above), HEIGHT);
        assert_int_equal(count_ridge(0, 0, 0, m, BIS_EDGE_TURN), 0);
    }
    /* 4 a^2 pi is one over the density of visible normals of GGX, mirrored, head on: 1 - 2 a^2 is the cosine */
    const bis_material facets = bis_microfacet((rgb){0, 0, 0}, (rgb){1, 1, 1}, sqrt(0.2)); /* alpha = 0.2 */
    assert_int_equal(count_ridge(23.07 * 0.97, 0, 0, facets, BIS_EDGE_TURN), 0);
    assert_int_equal(count_ridge(23.07 * 1.03, 0, 0, facets, BIS_EDGE_TURN), HEIGHT);
    assert_int_equal(bis_edges_samples(BIS_EDGE_NONE, 8), 1);
    assert_int_equal(bis_edges_samples(BIS_EDGE_TURN, 8), 4);
    assert_int_equal(bis_edges_samples(BIS_EDGE_TURN, 1), 1);
    assert_int_equal(bis_edges_samples(BIS_EDGE_OUTLINE, 8), 8);
}

/* Mean over the picture of one render: with edge samples it estimates the same number. */
static void mean_is_the_same_and_its_scatter_less(void **state)
{
    enum { RUNS = 40 };
    world w;
    stat_moments plain = {0}, more = {0}, longer = {0};

    make_world(&w, &bis_sir);
    w.desc.view.edge_light = 0.5;
    for (int k = 0; k < 2; k++) {
        w.desc.view.edge_samples = k ? 6 : 1;
        for (uint64_t run = 0; run < RUNS; run++) {
            bis_film film;
            bis_render_result result;
            double sum = 0;
            w.desc.view.sampler.seed = 1000 + run;
            bis_sampler_set_spp(&w.desc.view.sampler, 2);
            render(&film, &result, &w, whole, &(bis_render_options){.budget = {.spp = 2}});
            for (size_t i = 0; i < 3 * WIDTH * HEIGHT; i++) sum += film.sum[i] / film.weight / (3 * WIDTH * HEIGHT);
            stat_add(k ? &more : &plain, sum);
            bis_film_clear(&film);
        }
    }
    w.desc.view.edge_samples = 1;
    for (uint64_t run = 0; run < 40; run++) {
        bis_film film;
        bis_render_result result;
        double sum = 0;
        w.desc.view.sampler.seed = run;
        bis_sampler_set_spp(&w.desc.view.sampler, 8);
        render(&film, &result, &w, whole, &(bis_render_options){.budget = {.spp = 8}});
        for (size_t i = 0; i < 3 * WIDTH * HEIGHT; i++) sum += film.sum[i] / film.weight / (3 * WIDTH * HEIGHT);
        stat_add(&longer, sum);
        bis_film_clear(&film);
    }
    /* Welch: the difference of two means over its standard error, some 70 degrees of freedom */
    const double se = sqrt(stat_variance(&more) / RUNS + stat_variance(&longer) / 40);
    const double p = bis_stats_student_p((more.mean - longer.mean) / se, 70);
    stat_judges(1);
    assert_true(p > alpha());
    assert_true(stat_variance(&more) < stat_variance(&plain));
    /* twin: an estimate that counts an edge's samples as if each were a pass of its own would be far off: the edges'
     * light times six */
    assert_true(bis_stats_student_p((1.03 * more.mean - longer.mean) / se, 70) < alpha());
    clear_world(&w);
}

static void bits_do_not_depend_on_threads_and_one_is_none(void **state)
{
    world w;
    bis_film a, b;
    bis_render_result ra, rb;

    make_world(&w, &bis_sir);
    w.desc.view.edge_samples = 5;
    render(&a, &ra, &w, whole, &(bis_render_options){.budget = {.spp = 3}, .n_threads = 1});
    render(&b, &rb, &w, whole, &(bis_render_options){.budget = {.spp = 3}, .n_threads = 3});
    assert_same_bits(&a, &b);
    assert_true(ra.counters.camera_rays == rb.counters.camera_rays &&
                ra.counters.camera_rays > (WIDTH + 1) * (HEIGHT + 1) + 3 * WIDTH * HEIGHT);
    bis_film_clear(&b);
    w.desc.view.pixel_jitter = false; /* all rays through the centre: nothing to find */
    render(&b, &rb, &w, whole, &(bis_render_options){.budget = {.spp = 3}});
    assert_true(rb.counters.camera_rays == 3 * WIDTH * HEIGHT);
    bis_film_clear(&a);
    w.desc.view.edge_samples = 1;
    render(&a, &ra, &w, whole, &(bis_render_options){.budget = {.spp = 3}});
    assert_same_bits(&a, &b);
    bis_film_clear(&a);
    bis_film_clear(&b);
    clear_world(&w);
}

/* 2^29 camera samples and 8 times as many on outlines are 2^32: in 32 bits none, which was divided by. 600000000 times
 * 8 is more than 2^32, too. What one pass of these holds can be told: one camera sample, or 8, a pixel. */
static void camera_samples_times_edge_samples_may_pass_32_bits(void **state)
{
    static const uint32_t spps[] = {1u << 29, 1u << 30, 600000000};
    world w;

    make_world(&w, &bis_brdf);
    for (int i = 0; i < 3; i++) {
        bis_film film;
        bis_render_result result;
        bis_sampler_set_spp(&w.desc.view.sampler, spps[i]);
        w.desc.view.edge_samples = 8;
        assert_int_equal(bis_film_init(&film, 8, 6, whole, (bis_loc){0}, NULL), BIS_OK);
        assert_int_equal(bis_render(&result, &film, &w.scene, &w.desc.view,
                             &(bis_render_options){.budget = {.spp = 2}}, NULL),
            BIS_OK);
        assert_int_equal(result.passes, 2);
        assert_in_range(
            result.counters.camera_rays, 2 * 48 + 7 * 9 + 1, 2 * 8 * 48 + 7 * 9); /* outlines are found by 9 x 7 rays */
        bis_film_clear(&film);
    }
    clear_world(&w);
}

/* ---- every corner ---- */

/* An accelerator that counts its rays. */
typedef struct counting {
    bis_accel accel;
    const bis_accel *inner;
    uint64_t *n;
} counting;

static bool counting_intersect(const bis_accel *a, const ray *r, bis_hit *hit)
{
    const counting *c = (const counting *)a;
    ++*c->n;
    return bis_accel_intersect(c->inner, r, hit);
}

static bool counting_occluded(const bis_accel *a, const ray *r) { return false; }

/* What the four corners of the film's pixel (x, y) say: of all pairs of them, the most. */
static int kind_by_corners(const world *w, const bis_film *f, const double *turns, int x, int y)
{
    bis_surface s[4];
    bool hit[4];
    int kind = BIS_EDGE_NONE;

    for (int k = 0; k < 4; k++) {
        bis_hit h;
        const ray eye = bis_camera_ray(&w->desc.view.camera, f->picture_width, f->picture_height,
                                       x * f->step + f->step / 2 + k % 2, y * f->step + f->step / 2 + k / 2);
        hit[k] = bis_accel_intersect(w->scene.accel, &eye, &h);
        if (hit[k]) bis_geometry_surface(&w->scene.geometry, h.prim, &eye, &s[k]);
    }
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < i; k++) {
            if (!hit[i] && !hit[k]) continue;
            if (hit[i] != hit[k] || s[i].material != s[k].material) return BIS_EDGE_OUTLINE;
            const double cosine = dot(s[i].n, s[k].n);
            if (cosine < 0.5) return BIS_EDGE_OUTLINE;
            if (cosine < turns[s[i].material]) kind = BIS_EDGE_TURN;
        }
    return kind;
}

/* Pictures and thin films, whole and cropped, looked at whole and tile by tile. Each corner takes a ray; of a thin film
 * each pixel has four of its own. Tiles of an area trace those between them twice, and count them once. */
static void a_pixel_is_what_its_four_corners_say(void **state)
{
    static const bis_accel_ops ops = {
        .name = "counting", .intersect = counting_intersect, .occluded = counting_occluded};
    static const double crops[][4] = {{0, 1, 0, 1}, {0.3, 0.9, 0.2, 0.7}};
    int met[3] = {0, 0, 0};

    for (int i = 0; i < 6; i++) {
        const int step = 1 + i / 2, size = step > 1 ? 3 * step : 2; /* of the picture, in units of the world's */
        world w;
        bis_film f;
        uint64_t traced = 0, told = 0;
        int across;
        make_world(&w, &place);
        w.materials[1] = bis_phong((rgb){0, 0, 0}, (rgb){1, 1, 1}, 1000); /* each small turn counts */
        assert_int_equal(bis_film_init_thin(&f, size * WIDTH, size * HEIGHT, crops[i % 2], step, (bis_loc){0}, NULL),
                         BIS_OK);
        const bis_rect area = bis_film_crop(&f);
        const uint64_t n = step > 1 ? 4 * (uint64_t)f.width * (uint64_t)f.height
                                    : (uint64_t)(f.width + 1) * (uint64_t)(f.height + 1);
        unsigned char *edge = bis_alloc(bis_edges_bytes(area), 1), *by_tile = bis_alloc(bis_edges_bytes(area), 1);
        double *turns = bis_edges_turns(&w.desc);
        counting c = {{&ops, &w.scene.geometry}, w.scene.accel, &traced};
        bis_scene seen = w.scene;
        seen.accel = &c.accel;
        const bis_edge_eye from = {&f, &seen, &w.desc.view, turns};
        assert_true(bis_edges_find(edge, area, area, &from, 1));
        assert_true(traced == n && bis_edges_rays(&f, area, area) == n);
        for (int t = 0; t < bis_film_tiles(&f, BIS_RENDER_TILE, &across); t++) {
            const bis_rect tile = bis_film_tile_of_crop(&f, BIS_RENDER_TILE, t);
            assert_true(bis_edges_find(by_tile, area, tile, &from, 1));
            told += bis_edges_rays(&f, area, tile);
        }
        assert_true(told == n && across > 1);
        assert_memory_equal(edge, by_tile, bis_edges_bytes(area));
        for (int y = area.y0; y < area.y1; y++)
            for (int x = area.x0; x < area.x1; x++) {
                const int kind = bis_edges_kind(edge, area, x, y);
                assert_int_equal(kind, kind_by_corners(&w, &f, turns, x, y));
                met[kind]++;
            }
        bis_free(turns);
        bis_free(edge);
        bis_free(by_tile);
        bis_film_clear(&f);
        clear_world(&w);
    }
    if (!(met[BIS_EDGE_OUTLINE] > 100 && met[BIS_EDGE_TURN] > 100 && met[BIS_EDGE_NONE] > 1000))
        fail_msg("%d, %d and %d pixels", met[0], met[1], met[2]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(camera_samples_times_edge_samples_may_pass_32_bits),
        cmocka_unit_test(edges_are_where_the_picture_is_half_background),
        cmocka_unit_test(ridges_are_edges_from_60_degrees_on_and_borders_of_materials_always),
        cmocka_unit_test(the_turn_that_counts_is_that_of_the_lobe),
        cmocka_unit_test(mean_is_the_same_and_its_scatter_less),
        cmocka_unit_test(bits_do_not_depend_on_threads_and_one_is_none),
        cmocka_unit_test(a_pixel_is_what_its_four_corners_say),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
