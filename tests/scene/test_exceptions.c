/* exceptions: several Integrators in one scene, each for its materials: their numbers, what each pixel then shows, what
 * is built for them, and what the program tells of them. */
#include "bis/base/mem.h"
#include "bis/thesis/phong.h"

#include "json_check.h"
#include "program.h"
#include "stat.h"
#include "world.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

#define DIR "build/test_exceptions"

/* --- numbers
 * ------------------------------------------------------------------------------------------------------- */

static void materials_are_numbered_by_value_in_the_order_of_the_shapes(void **state)
{
    (void)state;
    const rgb grey = {0.5f, 0.5f, 0.5f}, red = {0.5f, 0.1f, 0.1f}, black = {0, 0, 0};
    bis_material materials[] = {bis_phong(grey, black, 50), bis_phong(red, black, 50), bis_phong(red, grey, 50), bis_phong(red, black, 50), bis_phong(red, grey, 51)};
    bis_shape_desc shapes[] = {{.material = 2}, {.material = 3}, {.material = 2}, {.material = 1}, {.material = 4}};
    const bis_scene_desc d = {.materials = materials, .n_materials = 5, .shapes = shapes, .n_shapes = 5};
    uint32_t *number, n;
    assert_int_equal(bis_scene_number_materials(&number, &n, &d, NULL), BIS_OK);
    assert_int_equal(n, 3);
    assert_true(number[0] == BIS_NO_NUMBER);
    assert_int_equal(number[2], 0);
    assert_int_equal(number[3], 1);
    assert_int_equal(number[1], 1);
    assert_int_equal(number[4], 2);
    bis_free(number);
}

/* The other road: comparing each with each. */
static void numbers_are_those_that_comparing_all_pairs_gives(void **state)
{
    (void)state;
    enum { N = 60, SHAPES = 200 };
    bis_material materials[N];
    bis_shape_desc shapes[SHAPES];
    bis_rng rng;
    bis_rng_init(&rng, 3, 0, 0, 0);
    for (int i = 0; i < N; i++) {
        const float kd = (float)bis_rng_below(&rng, 3) / 4, ks = (float)bis_rng_below(&rng, 3) / 4;
        materials[i] = bis_phong((rgb){kd, 0, kd}, (rgb){0, ks, 0}, (double)bis_rng_below(&rng, 2));
    }
    for (int i = 0; i < SHAPES; i++) shapes[i] = (bis_shape_desc){.material = (uint32_t)bis_rng_below(&rng, N)};
    const bis_scene_desc d = {.materials = materials, .n_materials = N, .shapes = shapes, .n_shapes = SHAPES};
    uint32_t *number, n, expected = 0;
    assert_int_equal(bis_scene_number_materials(&number, &n, &d, NULL), BIS_OK);
    for (int i = 0; i < SHAPES; i++) {
        const bis_material *m = &materials[shapes[i].material];
        int k = 0;
        while (k < i) {
            const bis_material *other = &materials[shapes[k].material];
            if (rgb_sum(m->Kd) == rgb_sum(other->Kd) && rgb_sum(m->Ks) == rgb_sum(other->Ks) && m->exponent == other->exponent) break;
            k++;
        }
        assert_int_equal(number[shapes[i].material], k < i ? number[shapes[k].material] : expected++);
    }
    assert_int_equal(n, expected);
    bis_free(number);
}

/* --- pictures
 * ------------------------------------------------------------------------------------------------------ */

static bis_settings sir_product(void)
{
    bis_settings s = bis_settings_default(&bis_sir);
    s.candidates = 24;
    s.shadowrays = 3;
    s.proposal = BIS_PROPOSAL_PRODUCT;
    return s;
}

static bis_settings mis_stratified(void)
{
    bis_settings s = bis_settings_default(&bis_mis);
    s.samples = 4;
    s.stratify = true;
    return s;
}

/* The floor by a, the ball by b. of_material must live as long. */
static void make_mixed(world *w, const bis_settings *a, const bis_settings *b, unsigned char of_material[2])
{
    make_world(w, &bis_sir);
    w->desc.settings = *a;
    of_material[0] = 0;
    of_material[1] = 1;
    w->desc.exceptions.n = 1;
    w->desc.exceptions.settings[0] = *b;
    w->desc.exceptions.of_material = of_material;
}

static void render_all_by(bis_film *film, const bis_settings *s, unsigned layers)
{
    world w;
    bis_render_result result;
    make_world(&w, &bis_sir);
    w.desc.settings = *s;
    render_layers(film, &result, &w, whole, layers, &(bis_render_options){.budget = {.spp = 4}, .n_threads = 1});
    clear_world(&w);
}

static rgb one_Lo(const bis_settings *s, const bis_point *pt, bis_stream *stream, bis_scratch *scratch)
{
    (void)s;
    (void)pt;
    (void)stream;
    (void)scratch;
    return (rgb){1, 1, 1};
}

static rgb zero_Lo(const bis_settings *s, const bis_point *pt, bis_stream *stream, bis_scratch *scratch)
{
    (void)s;
    (void)pt;
    (void)stream;
    (void)scratch;
    return (rgb){0, 0, 0};
}

static const bis_integrator one = {.name = "one", .light_needs = no_light_needs,
                                   .scratch_needs = no_scratch, .Lo = one_Lo};
static const bis_integrator zero = {.name = "zero", .light_needs = no_light_needs,
                                    .scratch_needs = no_scratch, .Lo = zero_Lo};

/* sum > 0 where a camera sample of the same seed meets material m. */
static void render_places(bis_film *film, int m)
{
    const bis_settings yes = bis_settings_default(&one), no = bis_settings_default(&zero);
    bis_render_result result;
    unsigned char of_material[2];
    world w;
    make_mixed(&w, m == 0 ? &yes : &no, m == 1 ? &yes : &no, of_material);
    w.desc.light.visible = false;
    render(film, &result, &w, whole, &(bis_render_options){.budget = {.spp = 4}, .n_threads = 1});
    clear_world(&w);
}

/* In how many of those pixels that show nothing but material m do the two differ? *n: of how many. */
static int differing(int *n, const bis_film *x, const bis_film *y, const bis_film *of, const bis_film *others)
{
    int d = 0;
    *n = 0;
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        if (!(of->sum[3 * i] > 0) || others->sum[3 * i] > 0) continue;
        ++*n;
        d += memcmp(x->sum + 3 * i, y->sum + 3 * i, 3 * sizeof *x->sum) != 0;
    }
    return d;
}

/* The same random numbers, the same pools: the same bits. The twin: the two exchanged. */
static void each_material_looks_as_if_its_settings_were_those_of_all(void **state)
{
    (void)state;
    const bis_settings s[2] = {sir_product(), mis_stratified()};
    bis_film alone[2], mixed, shows[2];
    bis_render_result result;
    unsigned char of_material[2];
    world w;
    int n;
    for (int i = 0; i < 2; i++) render_all_by(&alone[i], &s[i], 0);
    for (int i = 0; i < 2; i++) render_places(&shows[i], i);
    make_mixed(&w, &s[0], &s[1], of_material);
    render(&mixed, &result, &w, whole, &(bis_render_options){.budget = {.spp = 4}, .n_threads = 1});
    for (int i = 0; i < 2; i++) {
        assert_int_equal(differing(&n, &mixed, &alone[i], &shows[i], &shows[1 - i]), 0);
        assert_true(n > 50);
        assert_true(differing(&n, &mixed, &alone[1 - i], &shows[i], &shows[1 - i]) > n / 2);
    }
    for (int i = 0; i < 2; i++) {
        bis_film_clear(&alone[i]);
        bis_film_clear(&shows[i]);
    }
    bis_film_clear(&mixed);
    clear_world(&w);
}

static void an_exception_with_the_same_settings_changes_no_bit(void **state)
{
    (void)state;
    const bis_settings s = sir_product();
    bis_film alone, mixed;
    bis_render_result result;
    unsigned char of_material[2];
    world w;
    render_all_by(&alone, &s, 0);
    make_mixed(&w, &s, &s, of_material);
    render(&mixed, &result, &w, whole, &(bis_render_options){.budget = {.spp = 4}, .n_threads = 1});
    assert_same_bits(&alone, &mixed);
    bis_film_clear(&alone);
    bis_film_clear(&mixed);
    clear_world(&w);
}

static void a_meter_counts_the_points_of_each_group_and_changes_no_bit(void **state)
{
    (void)state;
    const bis_settings s = sir_product(), dear = bis_settings_default(&bis_sir), cheap = bis_settings_default(&zero);
    const unsigned char group[2] = {1, 0};
    double seconds[2] = {0, 0}, hits = 0, places = 0;
    uint64_t points[2] = {0, 0};
    bis_meter meter = {group, seconds, points};
    bis_film plain, metered, floor, other;
    bis_render_result result;
    unsigned char of_material[2];
    world w;
    render_all_by(&plain, &s, 0);
    make_world(&w, &bis_sir);
    w.desc.settings = s;
    render(&metered, &result, &w, whole, &(bis_render_options){.budget = {.spp = 4}, .n_threads = 1, .meter = &meter});
    assert_same_bits(&plain, &metered);
    clear_world(&w);
    render_places(&floor, 0);
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        hits += plain.hits[i];
        places += floor.sum[3 * i];
    }
    assert_true((double)(points[0] + points[1]) == hits && (double)points[1] == places);
    assert_true(seconds[0] > 0 && seconds[1] > 0);
    /* The time is that of the group: of nothing on the floor, of 800 candidates on the ball. */
    seconds[0] = seconds[1] = 0;
    make_mixed(&w, &cheap, &dear, of_material);
    render(&other, &result, &w, whole, &(bis_render_options){.budget = {.spp = 4}, .n_threads = 1, .meter = &meter});
    assert_true(seconds[0] / (double)points[0] > 2 * seconds[1] / (double)points[1]);
    bis_film_clear(&plain);
    bis_film_clear(&metered);
    bis_film_clear(&floor);
    bis_film_clear(&other);
    clear_world(&w);
}

static void threads_change_no_bit_of_a_mixed_picture(void **state)
{
    (void)state;
    bis_settings a = sir_product(), b = mis_stratified();
    bis_film film[2];
    bis_render_result result;
    unsigned char of_material[2];
    world w;
    a.learn = true;
    make_mixed(&w, &a, &b, of_material);
    w.desc.edge_samples = 3;
    for (int i = 0; i < 2; i++) render_layers(&film[i], &result, &w, whole, 1u << BIS_LAYER_UNOCCLUDED, &(bis_render_options){.budget = {.spp = 4}, .n_threads = 1 + i});
    assert_same_bits(&film[0], &film[1]);
    for (int i = 0; i < 2; i++) bis_film_clear(&film[i]);
    clear_world(&w);
}

/* Nothing but the masked settings' own numbers may be in a layer: L_ns of a material is that of its own method. */
static void layers_are_made_by_each_materials_own_method(void **state)
{
    (void)state;
    const bis_settings s[2] = {sir_product(), mis_stratified()};
    const unsigned layers = 1u << BIS_LAYER_UNOCCLUDED | 1u << BIS_LAYER_CANDIDATES;
    bis_film alone[2], mixed, shows[2];
    bis_render_result result;
    unsigned char of_material[2];
    world w;
    int n[2] = {0, 0};
    for (int i = 0; i < 2; i++) render_all_by(&alone[i], &s[i], layers);
    for (int i = 0; i < 2; i++) render_places(&shows[i], i);
    make_mixed(&w, &s[0], &s[1], of_material);
    render_layers(&mixed, &result, &w, whole, layers, &(bis_render_options){.budget = {.spp = 4}, .n_threads = 1});
    const int v = mixed.layers.n_values;
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        if ((shows[0].sum[3 * i] > 0) == (shows[1].sum[3 * i] > 0)) continue;
        const int m = shows[1].sum[3 * i] > 0;
        assert_memory_equal(mixed.layers.sum + i * v, alone[m].layers.sum + i * v, (size_t)v * sizeof *mixed.layers.sum);
        n[m]++;
    }
    assert_true(n[0] > 50 && n[1] > 50);
    for (int i = 0; i < 2; i++) {
        bis_film_clear(&alone[i]);
        bis_film_clear(&shows[i]);
    }
    bis_film_clear(&mixed);
    clear_world(&w);
}

/* Means of pictures with one camera ray a pixel, by `exact` and mixed, with seeds of their own. Family: 2 tests and
 * their twins at 1 in 100. */
static stat_moments errors_of(const bis_settings *a, const bis_settings *b, bool of_ball)
{
    enum { RUNS = 10 };
    const bis_settings exact = bis_settings_default(&bis_exact), nothing = bis_settings_default(&zero);
    stat_moments m = {0};
    unsigned char of_material[2];
    world w;
    for (int run = 0; run < RUNS; run++) {
        double mean[2] = {0, 0};
        for (int i = 0; i < 2; i++) {
            bis_film film;
            bis_render_result result;
            make_mixed(&w, of_ball ? &nothing : i ? a : &exact, of_ball ? i ? b : &exact : &nothing, of_material);
            w.desc.pixel_jitter = false;
            w.desc.light.visible = false;
            w.desc.sampler.seed = (uint64_t)(100 + 2 * run + i);
            render(&film, &result, &w, whole, &(bis_render_options){.budget = {.spp = i ? 4 : 1}, .n_threads = 1});
            for (int k = 0; k < 3 * WIDTH * HEIGHT; k++) mean[i] += film.sum[k] / film.passes;
            bis_film_clear(&film);
            clear_world(&w);
        }
        stat_add(&m, mean[1] / mean[0]);
    }
    return m;
}

static void each_material_of_a_mixed_picture_is_unbiased(void **state)
{
    (void)state;
    const double alpha = stat_level(0.01, 2);
    const bis_settings a = sir_product(), b = mis_stratified(), open = bis_settings_default(&bis_unoccluded);
    stat_moments m = errors_of(&a, &b, false);
    stat_assert_mean("mixed_floor", 100, &m, 1, alpha);
    m = errors_of(&a, &b, true);
    stat_assert_mean("mixed_ball", 100, &m, 1, alpha);
    m = errors_of(&open, &b, false); /* the twins: the other material's settings, or none of their own, are found */
    stat_assert_not_mean("mixed_floor_open", 100, &m, 1, alpha);
    m = errors_of(&a, &open, true);
    stat_assert_not_mean("mixed_ball_open", 100, &m, 1, alpha);
}

static void only_what_a_method_in_use_needs_is_built(void **state)
{
    (void)state;
    const bis_settings a = bis_settings_default(&bis_brdf), b = mis_stratified();
    unsigned char of_material[2];
    world w;
    make_mixed(&w, &a, &b, of_material);
    assert_int_equal(bis_scene_light_needs(&w.desc), BIS_NEED_CURVE);
    of_material[1] = 0;
    assert_int_equal(bis_scene_light_needs(&w.desc), 0);
    of_material[0] = of_material[1] = 1;
    assert_int_equal(bis_scene_light_needs(&w.desc), BIS_NEED_CURVE);
    clear_world(&w);
}

static void every_failing_allocation_of_a_mixed_render_is_reported(void **state)
{
    (void)state;
    bis_settings a = sir_product(), b = mis_stratified();
    unsigned char of_material[2];
    world w;
    a.learn = true;
    make_mixed(&w, &a, &b, of_material);
    assert_true(first_k_without_failure(&w, 0) > 18);
    clear_world(&w);
}

/* --- the program
 * --------------------------------------------------------------------------------------------------- */

#define GENERAL "Integrator \"sir\" \"integer candidates\" 32 \"integer shadowrays\" 3\n"

static void write_scene(const char *path, const char *integrators)
{
    char text[4096];
    snprintf(text, sizeof text, "Film \"rgb\" \"integer xresolution\" 24 \"integer yresolution\" 16\n%s\nSampler \"stratified\" \"integer pixelsamples\" 4\n"
             "LookAt 0 -7 1  0 0 0  0 0 1\nCamera \"perspective\" \"float fov\" 29\nWorldBegin\nLightSource \"infinite\" \"string filename\" \"../../data/maps/interior.hdr\"\n"
             "Material \"phong\" \"float Ks\" 0.5 \"float Kd\" 0.4 \"float exponent\" 40\nShape \"sphere\"\n"
             "Material \"diffuse\"\nTranslate 0 0 -1\nShape \"disk\" \"float radius\" 30\n", integrators);
    program_write_file(path, text);
}

static void the_plan_numbers_the_materials_and_tells_their_integrators(void **state)
{
    (void)state;
    program_run r;
    write_scene(DIR "/a.txt", GENERAL "Integrator \"brdf\" \"integer samples\" 8 \"integer material\" [1]");
    program_expect(&r, 0, DIR "/a.txt --plan");
    assert_non_null(strstr(r.output, "exception    1, brdf: samples 8\n"));
    assert_non_null(strstr(r.output, "material     0: phong, Kd 0.4, Ks 0.5, exponent 40; 1 shape\n"));
    assert_non_null(strstr(r.output, "material     1: phong, Kd 0.5, Ks 0, exponent 50; 1 shape; exception 1, brdf\n"));
    assert_non_null(strstr(r.output, "build        light curve"));
}

static void the_command_line_sets_all_materials_and_says_so(void **state)
{
    (void)state;
    char value[64];
    program_run r;
    write_scene(DIR "/a.txt", GENERAL "Integrator \"brdf\" \"integer samples\" 8 \"integer material\" 1");
    program_expect(&r, 0, DIR "/a.txt --stats - --outfile " DIR "/a.pfm");
    program_expect_only_the_result(&r);
    assert_true(json_is_valid(r.output));
    assert_non_null(strstr(json_value(value, sizeof value, r.output, "exceptions"), "brdf"));
    program_expect(&r, 0, DIR "/a.txt --candidates 16 --stats - --outfile " DIR "/b.pfm");
    assert_non_null(strstr(r.messages, "one integrator for all materials"));
    assert_null(strstr(r.output, "\"exceptions\""));
    write_scene(DIR "/b.txt", GENERAL);
    program_expect(&r, 0, DIR "/b.txt --candidates 16 --outfile " DIR "/c.pfm");
    program_expect(&r, 0, "compare " DIR "/b.pfm " DIR "/c.pfm --tolerance 0");
    program_expect(&r, 1, "compare " DIR "/a.pfm " DIR "/b.pfm --tolerance 0");
}

static void errata_as_printed_reach_all_integrators(void **state)
{
    (void)state;
    program_run r;
    write_scene(DIR "/a.txt", "Integrator \"brdf\"\nIntegrator \"sir\" \"integer candidates\" 32 \"integer material\" [0 1]");
    write_scene(DIR "/b.txt", "Integrator \"sir\" \"integer candidates\" 32");
    program_expect(&r, 0, DIR "/a.txt --as-printed E6 --outfile " DIR "/a.pfm");
    program_expect(&r, 0, DIR "/b.txt --as-printed E6 --outfile " DIR "/b.pfm");
    program_expect(&r, 0, DIR "/b.txt --outfile " DIR "/c.pfm");
    program_expect(&r, 0, "compare " DIR "/a.pfm " DIR "/b.pfm --tolerance 0");
    program_expect(&r, 1, "compare " DIR "/a.pfm " DIR "/c.pfm --tolerance 0");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(materials_are_numbered_by_value_in_the_order_of_the_shapes),
        cmocka_unit_test(numbers_are_those_that_comparing_all_pairs_gives),
        cmocka_unit_test(each_material_looks_as_if_its_settings_were_those_of_all),
        cmocka_unit_test(an_exception_with_the_same_settings_changes_no_bit),
        cmocka_unit_test(a_meter_counts_the_points_of_each_group_and_changes_no_bit),
        cmocka_unit_test(threads_change_no_bit_of_a_mixed_picture),
        cmocka_unit_test(layers_are_made_by_each_materials_own_method),
        cmocka_unit_test(each_material_of_a_mixed_picture_is_unbiased),
        cmocka_unit_test(only_what_a_method_in_use_needs_is_built),
        cmocka_unit_test(every_failing_allocation_of_a_mixed_render_is_reported),
        cmocka_unit_test(the_plan_numbers_the_materials_and_tells_their_integrators),
        cmocka_unit_test(the_command_line_sets_all_materials_and_says_so),
        cmocka_unit_test(errata_as_printed_reach_all_integrators),
    };
    program_folder(DIR);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
