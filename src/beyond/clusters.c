/* SPDX-License-Identifier: BSD-2-Clause */
/* clusters: cutting the curve, drawing from the pieces, and cones around what was drawn. Cost: once, O(tiles); for each
 * pass, 80 ns a direction, some 30,000 of them. */
#include "bis/beyond/clusters.h"

#include "bis/base/curve.h"
#include "bis/base/image.h"
#include "bis/base/mem.h"
#include "bis/base/xform.h"
#include "bis/thesis/rng.h"
#include "bis/thesis/envmap.h"
#include "bis/thesis/importance.h"

#include <assert.h>
#include <float.h>
#include <math.h>

static const uint64_t purpose_clusters = 0x636c7573; /* no pixel's stream has it */

/* Divides the curve into runs of tiles. A run ends when it holds 1/K of the importance or of the sphere. Run k is the
 * interval [t[k], t[k+1]) of the curve; each has some importance, and there are at most 2 K + 2 of them, because each
 * but the last has 1/K of the one or the other. */
static bis_status cut(bis_clusters *c, const bis_importance *im, uint32_t K)
{
    const size_t n_tiles = bis_importance_n_tiles(im, &c->side);
    double sphere = 0; /* solid angle of the current run */
    uint32_t k = 0;

    assert(2 * (uint64_t)K + 2 <= UINT16_MAX);
    c->t = bis_alloc(2 * (size_t)K + 3, sizeof *c->t);
    c->of_tile = bis_alloc(n_tiles, sizeof *c->of_tile);
    if (!c->t || !c->of_tile) return BIS_NOMEM;
    for (size_t i = 0; i < n_tiles; i++) {
        const bis_curve_tile tile = bis_importance_tile(im, i);
        c->of_tile[tile.tile] = (uint16_t)k;
        sphere += tile.solid_angle;
        /* Neither this run nor the rest may be without importance. */
        if (tile.end > c->t[k] && tile.end < 1 && ((tile.end - c->t[k]) * K >= 1 || sphere * K >= 4 * PI)) {
            c->t[++k] = tile.end;
            sphere = 0;
        }
    }
    c->n = k + 1;
    c->t[c->n] = 1;
    return BIS_OK;
}

/* 2048 pixels, a tile each: 8 for each of 256 clusters. */
static bis_status make_map(bis_light **out, const bis_light *constant, bis_diag *diag)
{
    const bis_importance_options curve = {.curve = true, .levels = 1};
    const bis_xform unturned = bis_xform_identity();
    bis_image image;
    bis_envmap em;
    bis_status status = bis_image_init(&image, 64, 32, diag);

    if (status) return status;
    for (size_t i = 0; i < 64 * 32; i++) image.pixels[i] = bis_light_Le(constant, (vec3){0, 0, 1});
    status = bis_envmap_from_latlong(&em, &image, diag);
    return status ? status : bis_light_new(out, &em, &unturned, &curve, diag);
}

bis_status bis_clusters_init(bis_clusters *c, const bis_light *light, uint32_t M, bis_diag *diag)
{
    /* weighing them should not cost more than the candidates do */
    const uint32_t K = M < 32 ? BIS_CLUSTERS_FEW : M < BIS_CLUSTERS / 2 ? 2 * M : BIS_CLUSTERS;
    bis_status status;
    uint32_t n_portals;

    *c = (bis_clusters){.n = 0};
    const bis_portal *portals = bis_light_portals(light, &n_portals);
    status = bis_light_is_constant(light) ? make_map(&c->as_map, light, NULL) : BIS_OK;
    if (status) goto done;
    if (c->as_map) light = c->as_map;
    c->width = (uint32_t)bis_light_envmap(light)->width;
    status = cut(c, bis_light_importance(light), K);
    if (status) goto done;
    bis_clusters_open(c, portals, n_portals);
    c->columns = (c->width + c->side - 1) / c->side; /* the last tile of a row may reach beyond the map */
    const uint32_t padded = bis_lanes_round_up(c->n);
    /* all points of a pass share the directions: where clusters are few, each has more */
    for (c->directions = BIS_CLUSTER_DIRECTIONS; c->n * c->directions < BIS_CLUSTERS_FEW * BIS_CLUSTER_DIRECTIONS;)
        c->directions *= 2;
    c->y = bis_alloc((size_t)c->n * c->directions, sizeof *c->y);
    c->memory = bis_alloc(BIS_CONES_ARRAYS * (size_t)padded, sizeof *c->memory);
    if (!c->y || !c->memory) {
        status = BIS_NOMEM;
        goto done;
    }
    c->cone = bis_cones_in(c->memory, padded);
done:
    if (!status) return BIS_OK;
    bis_clusters_clear(c);
    return bis_error(diag, status, (bis_loc){0},
                     "no memory for the clusters of the environment map; proposal \"mix\" needs none");
}

void bis_clusters_open(bis_clusters *c, const bis_portal *portals, uint32_t n)
{
    for (c->n_portals = 0; c->n_portals < n; c->n_portals++) c->portals[c->n_portals] = portals[c->n_portals];
    c->n_parts = n ? 2 * c->n : c->n;
}

void bis_clusters_clear(bis_clusters *c)
{
    bis_free(c->t);
    bis_free(c->of_tile);
    bis_free(c->y);
    bis_free(c->memory);
    bis_light_free(c->as_map);
    *c = (bis_clusters){0};
}

size_t bis_clusters_bytes(const bis_clusters *c)
{
    if (!c->n) return 0;
    const size_t rows = ((size_t)c->width + 2 * c->side - 1) / (2 * c->side); /* maps are about twice as wide as high */
    return c->n * (c->directions * sizeof *c->y + sizeof *c->t + BIS_CONES_ARRAYS * sizeof(float)) +
           rows * c->columns * sizeof *c->of_tile + (c->as_map ? bis_light_bytes(c->as_map) : 0);
}

/* A direction of density below FLT_MIN is drawn once in 10^37; it counts as dark. */
static bis_cluster_point point_of(const bis_light_point *y, double unit)
{
    if (y->pdf < (double)FLT_MIN) return (bis_cluster_point){.wi = y->wi, .q_L = 1};
    return (bis_cluster_point){y->wi, rgb_scale(y->Le, 1 / unit), (float)y->pdf, 0};
}

/* The cone about cluster k's directions, and its energy: the share times the mean of Le/q_L. A mean direction of length
 * 0, of directions all around, gets the whole sphere as its cone. */
static void put_cone(bis_clusters *c, uint32_t k)
{
    const bis_cluster_point *y = c->y + (size_t)k * c->directions;
    double x[3] = {0, 0, 0}, least = 1;
    rgbd energy = {0, 0, 0};

    /* the axis is the plain mean of the directions: these follow the importance already */
    for (uint32_t i = 0; i < c->directions; i++) {
        const double s = bis_cluster_share(c, k) / (c->directions * (double)y[i].q_L);
        x[0] += (double)y[i].wi.x;
        x[1] += (double)y[i].wi.y;
        x[2] += (double)y[i].wi.z;
        energy = rgbd_add(energy, (rgbd){(double)y[i].Le.r * s, (double)y[i].Le.g * s, (double)y[i].Le.b * s});
    }
    const double norm = sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
    const vec3 axis = norm > 0 ? vec3_from(x[0] / norm, x[1] / norm, x[2] / norm) : (vec3){0, 0, 1};
    for (uint32_t i = 0; i < c->directions; i++) least = fmin(least, dot(axis, y[i].wi));
    if (norm == 0) least = -1;
    least = fmax(least, -1); /* floats are unit to 2^-23 only */
    c->cone.x[k] = axis.x;
    c->cone.y[k] = axis.y;
    c->cone.z[k] = axis.z;
    c->cone.r[k] = (float)energy.r;
    c->cone.g[k] = (float)energy.g;
    c->cone.b[k] = (float)energy.b;
    c->cone.cosine[k] = (float)least;
    c->cone.sine[k] = bis_cone_sine((float)least);
}

/* Where a map has few lit pixels, one of them may be all of a cluster, and a wide lamp. All points of a pass share the
 * directions, and so the error of directions that lie anywhere in it: under such a lamp it was half of the squared
 * error of 8 samples, and no twin saw it (film_twins.c). There the curve goes on inside the pixel. A tile is a pixel
 * then. */
void bis_clusters_fill(bis_clusters *c, const bis_light *light, uint64_t seed, uint32_t pass, int n_threads)
{
    if (c->as_map) light = c->as_map;
    const double unit = bis_light_mean(light);
    const bool ordered = bis_clusters_are_wide(c) && c->side == 1;

    (void)n_threads; /* a compiler without OpenMP has one thread */
#pragma omp parallel for schedule(static) num_threads(n_threads)
    for (uint32_t k = 0; k < c->n; k++) {
        bis_rng rng; /* each cluster has a stream of its own, so the threads may share the clusters in any way */
        bis_rng_init(&rng, seed, k, pass, purpose_clusters);
        for (uint32_t i = 0; i < c->directions; i++) {
            const double t = c->t[k] + bis_cluster_share(c, k) * bis_stratum(i, bis_rng_double(&rng), c->directions);
            /* t of the last cluster may round to 1, which is behind the curve's end */
            const double s = fmin(t, 1 - 0x1p-53);
            double u[2] = {bis_rng_double(&rng), bis_rng_double(&rng)};
            bis_light_point y;
            if (ordered) bis_curve_hilbert(bis_importance_in_tile(bis_light_importance(light), s), u);
            const bool drawn = bis_light_sample_curve(light, s, u, &y);
            assert(drawn);
            (void)drawn;
            c->y[(size_t)k * c->directions + i] = point_of(&y, unit);
        }
        put_cone(c, k);
    }
}
