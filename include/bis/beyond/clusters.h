/* clusters: the map in pieces of like direction, each with a cone around it, its energy, and some directions ready to
 * be drawn.
 *
 * For proposal "product" (src/beyond/batch.c): where the lobe is narrow and the light spotty, few of M candidates drawn by the
 * map's importance alone fall into the lobe. Weighing pieces of the map by a bound of f cos over their cones costs a
 * nanosecond each and tells where the product can be large at all; candidates are then drawn from there (Clarberg and
 * Akenine-Moller 2008; Conty Estevez and Kulla 2018 bound lights by cones in the same way).
 *
 * A cluster is a run of tiles along the curve of the importance (src/thesis/importance_curve.c): compact, and known by the
 * share of the curve it takes, which is its share of the importance. */
#ifndef BIS_CLUSTERS_H
#define BIS_CLUSTERS_H

#include "bis/beyond/lanes.h"
#include "bis/thesis/light.h"

/* A direction as in bis_lanes: radiance over the light's mean. */
typedef struct bis_cluster_point {
    vec3 wi;
    rgb Le;
    float q_L, unused; /* 32 bytes: half a cache line */
} bis_cluster_point;

typedef struct bis_clusters {
    uint32_t n;           /* how many; each has a positive share */
    double *t;            /* t[n + 1]: cluster k is the part [t[k], t[k+1]) of the curve */
    uint16_t *of_tile;    /* of_tile[rows][columns]: the cluster that a tile of side x side pixels belongs to */
    uint32_t width, side, columns;
    bis_cluster_point *y; /* y[n][BIS_CLUSTER_DIRECTIONS]: this pass's directions, one in each part of the cluster */
    bis_lanes cone;       /* about these: the axis in x, y, z; the cosine of the half angle in q_L; in r, g, b the energy (radiance over the light's mean, times 1/density, times share) */
    float *sine;          /* of the half angle */
    float *memory;
} bis_clusters;

enum { BIS_CLUSTER_DIRECTIONS = 64, BIS_CLUSTERS = 256 /* at most */ };

/* Cut the map for M candidates a point: into K = 2 M clusters, 64 at least and BIS_CLUSTERS at most, to twice as many:
 * none has more than 1/K of the importance and another such part of the sphere's solid angle, but for the tile that
 * fills it up. The light must be a map with a curve, not black. Errors: BIS_NOMEM. */
bis_status bis_clusters_init(bis_clusters *c, const bis_light *light, uint32_t M, bis_diag *diag);
void bis_clusters_clear(bis_clusters *c);
size_t bis_clusters_bytes(const bis_clusters *c);

/* Draw all directions anew, as a function of (seed, pass), and put cones around them. */
void bis_clusters_fill(bis_clusters *c, const bis_light *light, uint64_t seed, uint32_t pass, int n_threads);

/* The cluster of a map's pixel (y * width + x). */
static inline uint32_t bis_cluster_of_pixel(const bis_clusters *c, uint32_t pixel)
{
    const uint32_t x = pixel % c->width, y = pixel / c->width;
    return c->of_tile[y / c->side * c->columns + x / c->side];
}

/* Its share of the importance. */
static inline double bis_cluster_share(const bis_clusters *c, uint32_t k) { return c->t[k + 1] - c->t[k]; }

#endif
