/* SPDX-License-Identifier: BSD-2-Clause */
/* layers: names of layers, and sums of those that must be gathered while rendering.
 *
 * A pixel's values stand side by side in the order of the enum, those of layers that nobody asked for take no place: a
 * pixel with albedo and depth has four values, one without layers none. Sums are double, as the film's. Standard errors
 * and intervals come from the film alone. */
#include "bis/scene/layers.h"

#include "base/text.h"
#include "bis/base/mem.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static const struct {
    const char *name;
    int n_values;
} layers[BIS_N_LAYERS] = {
    [BIS_LAYER_STDERR] = {"stderr", 0},         [BIS_LAYER_INTERVAL] = {"interval", 0},
    [BIS_LAYER_SAMPLES] = {"samples", 1},       [BIS_LAYER_SHADOWRAYS] = {"shadowrays", 1},
    [BIS_LAYER_CANDIDATES] = {"candidates", 1}, [BIS_LAYER_UNOCCLUDED] = {"unoccluded", 3},
    [BIS_LAYER_VISIBILITY] = {"visibility", 2}, [BIS_LAYER_ALBEDO] = {"albedo", 3},
    [BIS_LAYER_NORMAL] = {"normal", 3},         [BIS_LAYER_DEPTH] = {"depth", 1},
};

const char *bis_layer_name(bis_layer layer) { return layers[layer].name; }

int bis_layer_values(bis_layer layer) { return layers[layer].n_values; }

bool bis_layers_include(unsigned *set, const char *name)
{
    if (strcmp(name, "all") == 0) {
        *set = BIS_LAYERS_ALL;
        return true;
    }
    for (int i = 0; i < BIS_N_LAYERS; i++) {
        if (strcmp(name, layers[i].name) != 0) continue;
        *set |= 1u << i;
        return true;
    }
    return false;
}

const char *bis_layer_nearest(const char *name)
{
    const char *names[BIS_N_LAYERS + 1] = {"all"};
    for (int i = 0; i < BIS_N_LAYERS; i++) names[i + 1] = layers[i].name;
    return bis_nearest_name(name, names, BIS_N_LAYERS + 1);
}

bis_status bis_layers_read(unsigned *set, const char *list, const char *what, bis_loc at, bis_diag *diag)
{
    *set = 0;
    if (strcmp(list, "none") == 0) return BIS_OK;
    for (const char *end; *list; list = *end ? end + 1 : end) {
        char name[64], hint[BIS_HINT];
        size_t n = strcspn(list, ",");
        end = list + n;
        snprintf(name, sizeof name, "%.*s", (int)(n < sizeof name ? n : sizeof name - 1), list);
        if (bis_layers_include(set, name)) continue;
        return bis_error(diag, BIS_INPUT, at, "%s: there is no layer \"%s\"%s; `bis --help` lists them", what, name,
                         bis_hint(hint, bis_layer_nearest(name)));
    }
    return BIS_OK;
}

bis_status bis_layers_init(bis_layers *l, unsigned asked, size_t n_pixels, bis_diag *diag)
{
    *l = (bis_layers){.asked = asked};
    for (int i = 0; i < BIS_N_LAYERS; i++) {
        bool gathered = asked >> i & 1 && layers[i].n_values > 0;
        l->first[i] = gathered ? l->n_values : -1;
        if (gathered) l->n_values += layers[i].n_values;
    }
    if (l->n_values == 0) return BIS_OK;
    l->sum = bis_alloc(n_pixels, (size_t)l->n_values * sizeof *l->sum);
    if (l->sum) return BIS_OK;
    *l = (bis_layers){0};
    return bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for the layers of %zu pixels; fewer layers need less",
                     n_pixels);
}

void bis_layers_clear(bis_layers *l)
{
    bis_free(l->sum);
    *l = (bis_layers){0};
}

void bis_layers_add(bis_layers *l, size_t pixel, const float *values)
{
    double *sum = l->sum + pixel * (size_t)l->n_values;

    for (int i = 0; i < l->n_values; i++) {
        assert(isfinite(values[i]));
        sum[i] += (double)values[i];
    }
}
