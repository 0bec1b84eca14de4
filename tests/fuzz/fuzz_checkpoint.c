/* SPDX-License-Identifier: BSD-2-Clause */
/* fuzz_checkpoint: checkpoints, as `bis --resume` reads them and goes on. Two things are made right first, because no
 * mutation would: the checksum at the end, and the hashes of the render that it belongs to (tests/fuzz/checkpoint.txt).
 * What stands behind them must hold on its own. */
#include "base/text.h"
#include "bis/scene/scene.h"
#include "input.h"
#include "render/checkpoint.h"

#include <string.h>

static bis_scene_desc *desc;
static bis_scene *scene;
static bis_state_head right; /* of the render without a checkpoint */

/* Renders up to 12 camera samples a pixel. */
static bis_status render(bis_film *film, bis_render_result *result, bis_checkpoint *c, bis_diag *diag)
{
    const bis_film_desc *f = &desc->view.film;
    const bis_render_options options = {.budget.spp = 12, .n_threads = 1, .checkpoint = c};

    fuzz_require(!bis_film_init(film, f->width, f->height, f->crop, (bis_loc){0}, NULL), "a film");
    return bis_render(result, film, scene, &desc->view, &options, diag);
}

static void prepare(void)
{
    bis_checkpoint none = {.every = 1e9};
    bis_film film;
    bis_render_result result;

    fuzz_require(!bis_scene_parse(&desc, "tests/fuzz/checkpoint.txt", NULL), "the scene is read");
    desc->accel = (bis_accel_options){.kind = BIS_ACCEL_GRID, .n_threads = 1};
    fuzz_require(!bis_scene_build(&scene, desc, NULL), "the scene is built");
    fuzz_require(!render(&film, &result, &none, NULL), "the scene is rendered");
    bis_film_clear(&film);
    right = none.head;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static uint8_t sealed[1 << 16];
    bis_checkpoint c = {.every = 1e9};
    bis_diag diag = {0};
    bis_film film;
    bis_render_result result;

    if (size < 8 || size > sizeof sealed) return 0;
    if (!scene) prepare();
    memcpy(sealed, data, size);
    const uint64_t hash = bis_fnv1a(BIS_FNV1A, sealed, size - 8);
    for (int i = 0; i < 8; i++) sealed[size - 8 + (size_t)i] = (uint8_t)(hash >> 8 * i);
    bis_status status = bis_checkpoint_read(&c, fuzz_file(sealed, size), &diag);
    fuzz_check_diag(status, &diag);
    fuzz_require((status == BIS_OK) == (c.data != NULL), "all of the checkpoint or none");
    if (status) goto done;
    memcpy(c.head.parts, right.parts, sizeof right.parts);
    c.head.part = right.part;
    status = render(&film, &result, &c, &diag);
    fuzz_check_diag(status, &diag);
    fuzz_require(!c.data, "what was read is freed");
    if (!status) fuzz_require(result.spp == 12 || result.passes == UINT32_MAX, "the rest was rendered");
    bis_film_clear(&film);
done:
    bis_diag_clear(&diag);
    return 0;
}
