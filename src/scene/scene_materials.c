/* SPDX-License-Identifier: BSD-2-Clause */
/* scene_materials: the numbers of materials.
 *
 * A number stands for what the surface does, not for the directive that said so: materials of equal values have one
 * number, however often they are written, and one that no shape uses has none. Numbers follow the shapes, because these
 * are what one sees. */
#include "bis/scene/scene.h"

#include "bis/base/mem.h"

#include <stdlib.h>

typedef struct entry {
    bis_material material;
    const bis_material_textures *textures;
    uint32_t index;
} entry;

static int order(double a, double b) { return (a > b) - (a < b); }

/* Some order, in which equals are neighbours. */
static int order_materials(const bis_material *a, const bis_material *b)
{
    int c = ((uintptr_t)a->model > (uintptr_t)b->model) - ((uintptr_t)a->model < (uintptr_t)b->model);
    double x[BIS_MATERIAL_NUMBERS], y[BIS_MATERIAL_NUMBERS];
    bis_material_numbers(x, a);
    bis_material_numbers(y, b);
    for (int i = 0; i < BIS_MATERIAL_NUMBERS && !c; i++) c = order(x[i], y[i]);
    return c;
}

/* Where no textures are, none differ. */
static int order_textures(const bis_material_textures *a, const bis_material_textures *b)
{
    if (!a || !b) return (a != NULL) - (b != NULL);
    const bis_texture_slots x = bis_texture_slots_of(a), y = bis_texture_slots_of(b);
    int c = order(a->power, b->power);
    for (int i = 0; i < BIS_MATERIAL_TEXTURES && !c; i++) c = order(x.of[i], y.of[i]);
    return c ? c : order(a->normals, b->normals);
}

static int order_entries(const void *a, const void *b)
{
    const entry *x = a, *y = b;
    const int c = order_materials(&x->material, &y->material);

    return c ? c : order_textures(x->textures, y->textures);
}

bis_status bis_scene_number_materials(uint32_t **number, uint32_t *n_numbers, const bis_scene_desc *d, bis_diag *diag)
{
    bis_status status = BIS_OK;
    const size_t n = d->n_materials;
    entry *sorted = bis_alloc(n, sizeof *sorted);
    uint32_t *same = bis_alloc(n, sizeof *same); /* the first, in sorted order, of those equal to it */
    uint32_t *out = bis_alloc(n, sizeof *out);

    *number = NULL;
    *n_numbers = 0;
    if (!sorted || !same || !out) {
        status = bis_error(diag, BIS_NOMEM, (bis_loc){d->path, 0, 0}, "no memory to number %zu materials", n);
        goto done;
    }
    for (size_t i = 0; i < n; i++) {
        const bis_material_textures *textures = bis_textures_of(&d->textures, (uint32_t)i);
        sorted[i] = (entry){d->materials[i], textures, (uint32_t)i};
    }
    qsort(sorted, n, sizeof *sorted, order_entries);
    for (size_t i = 0; i < n; i++) {
        const bool is_new = i == 0 || order_entries(&sorted[i - 1], &sorted[i]) != 0;
        same[sorted[i].index] = is_new ? sorted[i].index : same[sorted[i - 1].index];
        out[i] = BIS_NO_NUMBER;
    }
    for (size_t i = 0; i < d->n_shapes; i++) {
        uint32_t *first = &out[same[d->shapes[i].material]];
        if (*first == BIS_NO_NUMBER) *first = (*n_numbers)++;
        out[d->shapes[i].material] = *first;
    }
    *number = out;
    out = NULL;
done:
    bis_free(sorted);
    bis_free(same);
    bis_free(out);
    return status;
}
