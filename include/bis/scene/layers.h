/* layers: what a picture can carry beside its colours, and where it is gathered. A scene pays for what it asks and for
 * nothing else. */
#ifndef BIS_LAYERS_H
#define BIS_LAYERS_H

#include "bis/base/status.h"

typedef enum bis_layer {
    BIS_LAYER_STDERR,     /* standard error of each pixel, R, G, B */
    BIS_LAYER_INTERVAL,   /* half-width of its 95% interval, R, G, B */
    BIS_LAYER_SAMPLES,    /* camera samples */
    BIS_LAYER_SHADOWRAYS, /* shadow rays that were cast */
    BIS_LAYER_CANDIDATES, /* candidates, or light samples, that were drawn */
    BIS_LAYER_UNOCCLUDED, /* from here on: means over camera samples. L_ns of eq. 4.5, R, G, B */
    BIS_LAYER_VISIBILITY, /* mean of V over the product: L / L_ns (eq. 4.6) */
    BIS_LAYER_ALBEDO,     /* Kd + Ks */
    BIS_LAYER_NORMAL,     /* shading normal in camera space */
    BIS_LAYER_DEPTH,      /* z in camera space */
    BIS_N_LAYERS
} bis_layer;

/* A set of layers: 1u << layer for each. */
enum { BIS_LAYERS_ALL = (1 << BIS_N_LAYERS) - 1 };

const char *bis_layer_name(bis_layer layer);

/* Add the layer of that name to *set, or all for "all". False: no such name; bis_layer_nearest may know what was meant,
 * or return NULL. */
bool bis_layers_include(unsigned *set, const char *name);
const char *bis_layer_nearest(const char *name);

/* Sums over passes, of what must be gathered while rendering. All zeros: nothing is asked. */
typedef struct bis_layers {
    unsigned asked;           /* the set */
    int n_values;             /* a pixel's; 0: nothing is gathered */
    int first[BIS_N_LAYERS];  /* where a layer's own begin; -1: it has none */
    double *sum;              /* sum[pixels][n_values] */
} bis_layers;

/* Values a pixel has: 3 for L_ns, albedo and normal, 2 for visibility (L, L_ns), 1 for counts and depth. */
int bis_layer_values(bis_layer layer);

/* Errors: BIS_NOMEM. */
bis_status bis_layers_init(bis_layers *l, unsigned asked, size_t n_pixels, bis_diag *diag);
void bis_layers_clear(bis_layers *l);

/* One pass of one pixel. values[n_values], finite. */
void bis_layers_add(bis_layers *l, size_t pixel, const float *values);

static inline bool bis_layers_has(const bis_layers *l, bis_layer layer) { return l->asked >> layer & 1; }

#endif
