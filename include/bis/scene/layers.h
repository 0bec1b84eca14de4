/* SPDX-License-Identifier: BSD-2-Clause */
/* layers: what a picture can contain beside its colours, and the sums that gather it. A scene pays only for the
 * layers that it asks for. */
#pragma once

#include "bis/base/status.h"

typedef enum bis_layer {
    BIS_LAYER_STDERR,     /* standard error of each pixel, R, G, B */
    BIS_LAYER_INTERVAL,   /* half-width of its 95% interval, R, G, B */
    BIS_LAYER_SAMPLES,    /* camera samples */
    BIS_LAYER_SHADOWRAYS, /* shadow rays that were cast */
    BIS_LAYER_CANDIDATES, /* candidates, or light samples, that were drawn */
    BIS_LAYER_UNOCCLUDED, /* this and the following: means over camera samples. L_ns of eq. 4.5, R, G, B */
    BIS_LAYER_VISIBILITY, /* mean of V over the product: L / L_ns (eq. 4.6) */
    BIS_LAYER_ALBEDO,     /* Kd + Ks */
    BIS_LAYER_NORMAL,     /* shading normal in camera space */
    BIS_LAYER_DEPTH,      /* z in camera space */
    BIS_N_LAYERS
} bis_layer;

/* A set of layers is the sum of 1u << layer. */
enum { BIS_LAYERS_ALL = (1 << BIS_N_LAYERS) - 1 };

/* bis_layer_name returns the name of a layer, as a scene writes it. */
const char *bis_layer_name(bis_layer layer);

/* bis_layers_include adds the layer with this name to *set, or all layers for "all". Returns false if there is no
 * such name. */
bool bis_layers_include(unsigned *set, const char *name);

/* bis_layers_read makes a set of "albedo,normal", "all" or "none". Messages begin with `what`, the name of the option.
 * Errors: BIS_INPUT (there is no such layer). */
bis_status bis_layers_read(unsigned *set, const char *list, const char *what, bis_loc at, bis_diag *diag);

/* bis_layer_nearest returns the name that is most like the misspelt `name`, or NULL. */
const char *bis_layer_nearest(const char *name);

/* Sums over passes of what must be gathered while rendering. All zeros: no layer is requested. */
typedef struct bis_layers {
    unsigned asked;           /* the set of requested layers */
    int n_values;             /* values per pixel; 0: nothing is gathered */
    int first[BIS_N_LAYERS];  /* the index of a layer's first value; -1: the layer has no values of its own */
    double *sum;              /* sum[pixels][n_values] */
} bis_layers;

/* bis_layer_values returns the number of values of a layer per pixel: 3 for L_ns, albedo and normal, 2 for visibility
 * (L, L_ns), 1 for counts and depth. */
int bis_layer_values(bis_layer layer);

/* bis_layers_init allocates the sums of the set `asked` for n_pixels pixels, all 0. Errors: BIS_NOMEM. */
bis_status bis_layers_init(bis_layers *l, unsigned asked, size_t n_pixels, bis_diag *diag);

/* bis_layers_clear frees the sums. *l is empty afterwards. */
void bis_layers_clear(bis_layers *l);

/* bis_layers_add adds one pass of one pixel. values[n_values] must be finite. */
void bis_layers_add(bis_layers *l, size_t pixel, const float *values);

/* bis_layers_has returns whether the layer is requested. */
static inline bool bis_layers_has(const bis_layers *l, bis_layer layer) { return l->asked >> layer & 1; }
