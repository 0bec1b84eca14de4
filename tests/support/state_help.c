/* SPDX-License-Identifier: BSD-2-Clause */
/* state_help: see the header. */
#include "state_help.h"

#include "base/text.h"
#include "claim.h"

void make_kind(world *w, const kind *k)
{
    make_world(w, k->integrator);
    w->desc.view.sampler.kind = k->sampler;
    if (k->edges) w->desc.view.edge_samples = 3;
    if (!k->learns) return;
    w->desc.view.settings.proposal = BIS_PROPOSAL_PRODUCT;
    w->desc.view.settings.learn = true;
}

bis_status try_render(bis_film *f, bis_render_result *result, const world *w, const kind *k,
                      bis_render_options options, bis_checkpoint *c, bis_diag *diag)
{
    options.checkpoint = c;
    assert_int_equal(bis_film_init(f, WIDTH, HEIGHT, k->crop, (bis_loc){0}, NULL), BIS_OK);
    assert_int_equal(bis_film_want(f, k->layers, NULL), BIS_OK);
    const bis_status status = bis_render(result, f, &w->scene, &w->desc.view, &options, diag);
    if (c) bis_checkpoint_clear(c);
    return status;
}

void assert_same_film(const bis_film *a, const bis_film *b)
{
    const size_t n_pixels = (size_t)a->width * (size_t)a->height, n = n_pixels * (size_t)a->layers.n_values;
    assert_same_bits(a, b);
    assert_true(!a->twin == !b->twin);
    assert_memory_equal(a->half, b->half, 3 * n_pixels * sizeof *a->half);
    assert_int_equal(a->layers.asked, b->layers.asked);
    assert_memory_equal(a->layers.sum, b->layers.sum, n * sizeof *a->layers.sum);
    assert_true(a->weight == b->weight && a->half_weight == b->half_weight && a->passes == b->passes);
    assert_true(a->full_width == b->full_width && a->full_height == b->full_height && a->x0 == b->x0 && a->y0 == b->y0);
}

void assert_same_result(const bis_render_result *a, const bis_render_result *b)
{
    assert_memory_equal(&a->counters, &b->counters, sizeof a->counters);
    assert_int_equal(a->spp, b->spp);
    assert_int_equal(a->passes, b->passes);
    assert_memory_equal(&a->error.relative_rmse, &b->error.relative_rmse, sizeof a->error.relative_rmse);
    assert_memory_equal(&a->error.upper, &b->error.upper, sizeof a->error.upper);
}

void seal(unsigned char *data, size_t size)
{
    const uint64_t hash = bis_fnv1a(BIS_FNV1A, data, size - 8);
    for (int i = 0; i < 8; i++) data[size - 8 + (size_t)i] = (unsigned char)(hash >> 8 * i);
}
