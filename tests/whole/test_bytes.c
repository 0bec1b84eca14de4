/* SPDX-License-Identifier: BSD-2-Clause */
/* What a module says that it takes (`--plan`, `--stats`) is what the C library gave it.
 *
 * The other road is malloc's own account: bytes in use before and after. Beyond what is asked for, a block costs at
 * most 128 bytes of header and alignment (mem.c), 64 + 16 of malloc's alignment and header, and, where the kernel gives
 * it, the rest of a page. */
#include "bis/base/mem.h"
#include "bis/beyond/clusters.h"
#include "bis/beyond/pool.h"
#include "bis/beyond/visibility.h"
#include "bis/render/film.h"
#include "bis/shape/accel.h"
#include "bis/thesis/alias.h"
#include "bis/thesis/cdf.h"
#include "bis/scene/light_load.h"
#include "claim.h"
#include "lit.h"
#include "map_help.h"
#include "render/ranks.h"
#include "render/workspace.h"
#include "world.h"

#include <malloc.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#if defined(__SANITIZE_ADDRESS__) || !defined(__GLIBC__)
enum { MALLOC_COUNTS = 0 };
static size_t in_use(void) { return 0; }
#else
enum { MALLOC_COUNTS = 1 };
static size_t in_use(void)
{
    const struct mallinfo2 m = mallinfo2();
    return m.uordblks + m.hblkhd;
}
#endif

typedef struct account {
    size_t bytes;
    long blocks;
} account;

static account begin(void) { return (account){in_use(), bis_mem_live()}; }

/* Whether `said` bytes were taken since `before`, in the blocks that are live now and were not then. */
static bool is_true(account before, size_t said)
{
    const size_t taken = in_use() - before.bytes, blocks = (size_t)(bis_mem_live() - before.blocks);
    const size_t page = 4096, most = said + blocks * (128 + 64 + 16) + (taken > 131072 ? blocks * page : 0);

    if (taken >= said && taken <= most) return true;
    print_message("said %zu bytes, taken %zu in %zu blocks\n", said, taken, blocks);
    return false;
}

static void expect(account before, size_t said) { assert_true(is_true(before, said)); }

static void malloc_sees_a_block_of_ours_and_the_account_can_fail(void **state)
{
    const account before = begin();
    void *p = bis_alloc(1000, 8);
    assert_true(is_true(before, 8000));
    assert_false(is_true(before, 8200));
    assert_false(is_true(before, 7800));
    bis_free(p);
    assert_true(is_true(before, 0));
}

static void tables_of_weights(void **state)
{
    enum { N = 5000 };
    static double weights[N];
    bis_alias alias;
    bis_cdf cdf;

    for (int i = 0; i < N; i++) weights[i] = 1 + i % 7;
    account before = begin();
    assert_int_equal(bis_alias_init(&alias, weights, N, NULL), BIS_OK);
    expect(before, bis_alias_bytes(&alias));
    bis_alias_clear(&alias);

    before = begin();
    assert_int_equal(bis_cdf_init(&cdf, weights, N, NULL), BIS_OK);
    expect(before, bis_cdf_bytes(&cdf));
    bis_cdf_clear(&cdf);
}

/* Maps of three sizes, with both kinds of table, with and without area weighting and the curve. */
static void a_light_with_its_map_and_tables(void **state)
{
    static const int sides[] = {10, 67, 128};
    static const unsigned needs[] = {0, BIS_NEED_TABLE, BIS_NEED_CURVE, BIS_NEED_TABLE | BIS_NEED_CURVE};

    bis_light_free(lit_new_light(LIT_SPOTTY, 1, 0.15, false)); /* threads are made once, with memory of their own */
    for (size_t i = 0; i < 3; i++)
        for (size_t k = 0; k < 4; k++)
            for (int kind = 0; kind < 4; kind++) {
                const bis_light_desc desc = {
                    .L = {1, 1, 1},
                    .scale = 1,
                    .levels = 8,
                    .area_exponent = kind & 1 ? 0.15 : 0,
                    .has_table_kind = true,
                    .table_kind = kind & 2 ? BIS_TABLE_CDF : BIS_TABLE_ALIAS,
                    .to_world = bis_xform_identity(),
                };
                bis_light *light;
                const account before = begin();
                bis_envmap em = map_random(2 * sides[i], sides[i], 3, 0.1, 7);
                assert_int_equal(bis_light_from_envmap(&light, &em, &desc, needs[k], NULL), BIS_OK);
                expect(before, bis_light_bytes(light));
                bis_light_free(light);
            }
}

static void what_the_points_of_a_pass_share(void **state)
{
    bis_light *light = lit_new_light(LIT_SPOTTY, 1, 0.15, false);

    for (uint32_t M = 9; M <= 260; M += 251) {
        bis_clusters clusters;
        bis_visibility visibility;
        account before = begin();
        assert_int_equal(bis_clusters_init(&clusters, light, M, NULL), BIS_OK);
        expect(before, bis_clusters_bytes(&clusters));
        bis_clusters_clear(&clusters);

        before = begin();
        assert_int_equal(bis_visibility_init(&visibility, M, 0, 1, NULL), BIS_OK);
        expect(before, bis_visibility_bytes(&visibility));
        bis_visibility_clear(&visibility);

        bis_pool pool;
        before = begin();
        assert_int_equal(bis_pool_init(&pool, M, NULL), BIS_OK);
        expect(before, bis_pool_bytes(&pool));
        bis_pool_clear(&pool);
    }
    bis_light_free(light);
}

static void what_a_thread_has(void **state)
{
    for (int i = 0; bis_integrators[i]; i++)
        for (uint32_t M = 8; M <= 300; M += 97)
            for (int proposal = BIS_PROPOSAL_EM; proposal <= BIS_PROPOSAL_PRODUCT; proposal++) {
                bis_settings s = bis_settings_default(bis_integrators[i]);
                bis_scratch scratch;
                s.candidates = M;
                s.shadowrays = s.samples = M / 3;
                s.proposal = (bis_proposal)proposal;
                const account before = begin();
                assert_int_equal(bis_scratch_init(&scratch, &s, NULL), BIS_OK);
                expect(before, bis_scratch_bytes(&s));
                bis_scratch_clear(&scratch);
            }
}

/* Without visibility, and with it. */
static void what_a_thread_knows_beyond_the_thesis(void **state)
{
    bis_light *light = lit_new_light(LIT_SPOTTY, 1, 0.15, false);
    bis_clusters clusters;
    bis_visibility visibility;

    assert_int_equal(bis_clusters_init(&clusters, light, 260, NULL), BIS_OK);
    assert_int_equal(bis_visibility_init(&visibility, 4, 0, 1, NULL), BIS_OK);
    for (int learns = 0; learns < 2; learns++) {
        bis_product_guide guide = {.clusters = NULL};
        const account before = begin();
        assert_true(is_true(before, bis_product_guide_bytes(&guide)));
        assert_int_equal(bis_product_guide_init(&guide, &clusters, learns ? &visibility : NULL, NULL), BIS_OK);
        expect(before, bis_product_guide_bytes(&guide));
        assert_true(learns == (guide.guess.memory != NULL)); /* what is not learned takes nothing */
        bis_product_guide_clear(&guide);
    }
    bis_visibility_clear(&visibility);
    bis_clusters_clear(&clusters);
    bis_light_free(light);
}

static void a_film_its_layers_and_its_twins(void **state)
{
    const double crop[4] = {0.1, 0.9, 0, 1};

    for (int kind = 0; kind < 4; kind++) {
        bis_film film;
        const account before = begin();
        assert_int_equal(bis_film_init(&film, 310, 170, crop, (bis_loc){0}, NULL), BIS_OK);
        if (kind & 1) assert_int_equal(bis_film_want(&film, ~0u, NULL), BIS_OK);
        if (kind & 2) assert_int_equal(bis_film_want_twins(&film, NULL), BIS_OK);
        expect(before, bis_film_bytes(&film));
        bis_film_clear(&film);
    }
}

/* The picture's workspace: without and with layers, a pool, clusters, learned visibility, materials
 * of textures; for one thread and for three. */
static void what_a_render_works_with(void **state)
{
    static const struct {
        const bis_integrator *integrator;
        bis_proposal proposal;
        bool learns, layers, textures;
    } kinds[] = {
        {&noise, 0, false, false, false},
        {&bis_exact, 0, false, true, false},
        {&bis_em, 0, false, false, false},
        {&bis_sir, BIS_PROPOSAL_MIX, false, false, true},
        {&bis_sir, BIS_PROPOSAL_EM, false, true, false},
        {&bis_sir, BIS_PROPOSAL_PRODUCT, true, false, true},
        {&bis_sir, BIS_PROPOSAL_PRODUCT, true, true, false},
        {&bis_mis, 0, false, true, true},
        {&bis_rejection, BIS_PROPOSAL_CHOOSE, false, false, false},
    };

    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
        for (int n_threads = 1; n_threads <= 3; n_threads += 2) {
            const bis_render_options options = {.n_threads = n_threads};
            world w;
            bis_film film;
            bis_workspace work;

            make_world(&w, kinds[i].integrator);
            w.desc.view.settings.proposal = kinds[i].proposal;
            w.desc.view.settings.candidates = 300;
            w.desc.view.settings.shadowrays = 200;
            w.desc.view.settings.learn = kinds[i].learns;
            w.desc.textures.n_of_material = kinds[i].textures;
            assert_int_equal(bis_film_init(&film, 310, 170, whole, (bis_loc){0}, NULL), BIS_OK);
            if (kinds[i].layers) assert_int_equal(bis_film_want(&film, ~0u, NULL), BIS_OK);
            const account before = begin();
            work = (bis_workspace){.scene = &w.scene, .desc = &w.desc, .view = &w.desc.view, .options = &options,
                                   .film = &film};
            assert_int_equal(bis_workspace_init(&work, NULL), BIS_OK);
            assert_true((work.visibility.n_tiles > 0) == kinds[i].learns);
            if (!is_true(before, bis_workspace_bytes(&work))) fail_msg("kind %zu, %d threads", i, n_threads);
            bis_workspace_clear(&work);
            w.desc.textures.n_of_material = 0;
            bis_film_clear(&film);
            clear_world(&w);
        }
}

/* Without textures, and with them. */
static void what_a_wave_of_camera_samples_has(void **state)
{
    for (uint32_t k = 0; k < 2; k++) {
        const bis_scene_desc desc = {.textures.n_of_material = k};
        const bis_wave_task task = {.desc = &desc};
        const account before = begin();
        bis_wave *wave = bis_wave_new(&task, NULL, NULL, NULL);
        assert_non_null(wave);
        expect(before, bis_wave_bytes(&desc));
        bis_wave_free(wave);
    }
}

/* A colour of each twin, beside all else. */
static void what_a_render_with_twins_works_with(void **state)
{
    const bis_render_options options = {.n_threads = 1};
    size_t said[2];
    world w;
    bis_film film;

    make_world(&w, &noise);
    for (int twins = 0; twins < 2; twins++) {
        assert_int_equal(bis_film_init(&film, 310, 170, whole, (bis_loc){0}, NULL), BIS_OK);
        if (twins) assert_int_equal(bis_film_want_twins(&film, NULL), BIS_OK);
        const account before = begin();
        bis_workspace work = {.scene = &w.scene, .desc = &w.desc, .view = &w.desc.view, .options = &options,
                              .film = &film};
        assert_int_equal(bis_workspace_init(&work, NULL), BIS_OK);
        said[twins] = bis_workspace_bytes(&work);
        expect(before, said[twins]);
        if (twins) assert_int_equal(said[1] - said[0], bis_film_twins(&film) * 3 * sizeof(float));
        bis_workspace_clear(&work);
        bis_film_clear(&film);
    }
    clear_world(&w);
}

/* malloc counts what it keeps aside for reuse as in use; it must keep nothing. It reads this once, at the start. */
static void start_again_without_caches(char **argv)
{
    if (getenv("GLIBC_TUNABLES")) return;
    setenv("GLIBC_TUNABLES", "glibc.malloc.tcache_count=0:glibc.malloc.mxfast=0", 1);
    execv("/proc/self/exe", argv);
}

int main(int argc, char **argv)
{
    if (!MALLOC_COUNTS) {
        puts("malloc keeps no account here: it is the sanitizer's, or another C library's");
        return 0;
    }
    start_again_without_caches(argv);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(malloc_sees_a_block_of_ours_and_the_account_can_fail),
        cmocka_unit_test(tables_of_weights),
        cmocka_unit_test(a_light_with_its_map_and_tables),
        cmocka_unit_test(what_the_points_of_a_pass_share),
        cmocka_unit_test(what_a_thread_has),
        cmocka_unit_test(what_a_thread_knows_beyond_the_thesis),
        cmocka_unit_test(a_film_its_layers_and_its_twins),
        cmocka_unit_test(what_a_render_works_with),
        cmocka_unit_test(what_a_wave_of_camera_samples_has),
        cmocka_unit_test(what_a_render_with_twins_works_with),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
