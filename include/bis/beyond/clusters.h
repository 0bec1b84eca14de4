/* SPDX-License-Identifier: BSD-2-Clause */
/* clusters: the map divided into pieces of similar direction. Each piece has a cone around it, its energy, and some
 * directions that are ready to be drawn.
 *
 * The clusters serve proposal "product" (src/beyond/product.c). If the lobe is narrow and the light spotty, few of M
 * candidates that are drawn by the map's importance alone fall into the lobe. It costs a nanosecond to weigh a piece
 * of the map by a bound of f cos over its cone. The weights show where the product can be large at all, and
 * candidates are then drawn from there (Clarberg and Akenine-Moller 2008; Conty Estevez and Kulla 2018 bound lights
 * by cones in the same way).
 *
 * A cluster is a run of tiles along the curve of the importance (src/thesis/importance_curve.c). It is therefore
 * compact, and it is known by its interval of the curve, whose length is its share of the importance. */
#pragma once

#include "bis/thesis/cone.h"
#include "bis/thesis/light.h"

/* A direction as in bis_lanes: Le is the radiance over the light's mean radiance. */
typedef struct bis_cluster_point {
    vec3 wi;
    rgb Le;
    float q_L, unused; /* the struct has 32 bytes: half a cache line */
} bis_cluster_point;

typedef struct bis_clusters {
    uint32_t n;           /* the number of clusters; each has a positive share */
    uint32_t n_parts;     /* to which candidates belong: the clusters, and n more for the squares of portals */
    uint32_t directions;  /* of each cluster: a power of two, at least BIS_CLUSTER_DIRECTIONS */
    double *t;            /* t[n + 1]: cluster k is the interval [t[k], t[k+1]) of the curve */
    uint16_t *of_tile;    /* of_tile[rows][columns]: the cluster of each tile of side x side pixels */
    uint32_t width, side, columns;
    /* y[n][directions]: the directions of this pass, one in each part of the cluster */
    bis_cluster_point *y;
    bis_cones cone;        /* the cones around these directions */
    float *memory;         /* what holds them */
    bis_portal portals[BIS_PORTALS_MAX]; /* through which candidates are drawn as well */
    uint32_t n_portals;
    bis_light *as_map;     /* what stands for a constant light here: the same as a small map; NULL: the light is one */
} bis_clusters;

/* 256 clusters of 64 directions have the error of 1024 of 32, and take 3 us less at each point (relmse of the dragon
 * under Grace Cathedral, 256 candidates and 30 rays, 4 passes). */
enum {
    BIS_CLUSTER_DIRECTIONS = 64,
    BIS_CLUSTERS = 256,    /* the largest K of bis_clusters_init */
    BIS_CLUSTERS_MOST = 2 * BIS_CLUSTERS + 2,
    BIS_CLUSTERS_FEW = 64  /* the smallest K: only a map of few lit pixels has fewer clusters */
};

/* bis_clusters_are_wide returns whether the map has so few lit pixels that its clusters may be wider than lobes.
 * They then tell where the light is, but not where it meets a lobe. */
static inline bool bis_clusters_are_wide(const bis_clusters *c) { return c->n < BIS_CLUSTERS_FEW; }

/* bis_clusters_init divides the map for M candidates per point. K is 2 M, but at least 64 and at most BIS_CLUSTERS.
 * No cluster holds more than 1/K of the importance, nor more than 1/K of the sphere's solid angle, except for the
 * tile that completes it. There are at most 2 K + 2 clusters. The light must be a constant or a map with a curve, and
 * must not be black. Errors: BIS_NOMEM. */
bis_status bis_clusters_init(bis_clusters *c, const bis_light *light, uint32_t M, bis_diag *diag);

/* bis_clusters_open gives clusters that were made n <= BIS_PORTALS_MAX portals in the place of the light's. */
void bis_clusters_open(bis_clusters *c, const bis_portal *portals, uint32_t n);

/* bis_clusters_clear frees the clusters. *c is empty afterwards. */
void bis_clusters_clear(bis_clusters *c);

/* bis_clusters_bytes returns the bytes that the clusters take. */
size_t bis_clusters_bytes(const bis_clusters *c);

/* bis_clusters_fill draws all directions anew, as a function of (seed, pass), and puts cones around them. n_threads =
 * 0 uses all threads. */
void bis_clusters_fill(bis_clusters *c, const bis_light *light, uint64_t seed, uint32_t pass, int n_threads);

/* bis_cluster_of_pixel returns the cluster of a pixel (y * width + x) of the map. */
static inline uint32_t bis_cluster_of_pixel(const bis_clusters *c, uint32_t pixel)
{
    if (c->side == 1) return c->of_tile[pixel];
    const uint32_t x = pixel % c->width, y = pixel / c->width;
    return c->of_tile[y / c->side * c->columns + x / c->side];
}

/* bis_cluster_share returns the share of the importance that cluster k has. */
static inline double bis_cluster_share(const bis_clusters *c, uint32_t k) { return c->t[k + 1] - c->t[k]; }
