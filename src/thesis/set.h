/* set: the M candidates of thesis 4.3 and 4.4 side by side, and the verbs that sir, rejection and unoccluded are made
 * of: draw, weigh, choose, trace.
 *
 *     x_i ~ q,    w_i = phat(x_i)/q(x_i) h_i,    y_j = x_i with probability w_i/sum w,    sum_j Z F/(phat h) V (y_j)
 *
 * phat = F.r + F.g + F.b, F = f cos Le. h is 1, or what earlier rays say of V (bis/beyond/visibility.h). Numbers are
 * floats in arrays, so that loops over i become vectors. Radiance is over the light's mean, f over the material's
 * `unit`; so any map and material fits a float. */
#pragma once

#include "bis/thesis/bsdf.h"
#include "bis/beyond/clusters.h"
#include "bis/beyond/pool.h"
#include "bis/beyond/visibility.h"
#include "beyond/blocks.h"
#include "beyond/product.h"

typedef struct bis_set {
    /* x_i: directions, radiance, density q_L: `map` n_map from the map, `brdf` n_brdf from the BRDF. Of a shared set of
     * M directions, n_brdf are left out: they have weight 0 */
    bis_lanes map, brdf, own;
    uint32_t M, n_map, n_brdf, first_brdf, n_lanes, left_out; /* lane first_brdf + i is the BRDF's x_i; left_out: a phase */
    double beta;             /* q = beta q_L + (1 - beta) q_f */
    bis_blocks w;            /* the weights of all lanes; what was chosen: w.lane[j], w.times[j], j < w.n_chosen */
    uint16_t *cluster;       /* of each lane, with proposal product */
    double unit, mean;       /* w, C and radiance are in unit * mean */

    bis_lanes y;             /* what was chosen: F/phat in r, g, b; h in q_L */
    uint16_t *cluster_y;
    double offset;           /* of systematic marks; < 0: not drawn yet */

    bis_product product;
    float *f;                /* f.r, f.g, f.b, cos, q_f of all lanes of one kind */
    float *u1, *u2, *floats;
    uint32_t *pixel;
    uint32_t capacity;

    /* what all points of a pass share; borrowed; NULL: none */
    const bis_pool *pool;
    const bis_clusters *clusters;
    const bis_foresight *foresight;
} bis_set;

bis_status bis_set_init(bis_set *x, const bis_settings *s, bis_diag *diag);
void bis_set_clear(bis_set *x);
struct bis_fast;
void bis_set_share(bis_set *x, const struct bis_fast *f);

/* Draw M candidates from s->proposal. False: there is no light, or nothing can be reflected. */
bool bis_set_draw(bis_set *x, const bis_settings *s, bis_proposal proposal, const bis_point *pt, bis_stream *stream);

/* Weigh them. Returns W, their sum. */
double bis_set_weigh(bis_set *x, const bis_point *pt);

/* f, cos, q_f of the lanes from `first` on, as bis_set_weigh found them. */
bis_reflected bis_set_reflected(const bis_set *x, uint32_t first);

/* Choose N by marks over the running sum of the weights, W > 0. */
void bis_set_choose(bis_set *x, uint32_t N, double W, bis_resampling resampling, const bis_point *pt,
                    bis_stream *stream);

/* F/phat of what was chosen, for trace: bis_set_choose has done it. */
void bis_set_gather(bis_set *x, const bis_point *pt);

/* The first n of w.lane[] are chosen, each once. For rejection. */
void bis_set_take(bis_set *x, uint32_t n);

/* Is a control variate worth its while? */
bool bis_set_has_control(const bis_set *x, const bis_point *pt);

/* (1/M) sum_i F/q g - Z sum_j F/(phat h) g: what earlier rays know of V, without a ray. Its mean is 0 minus ... */
rgbd bis_set_expected(const bis_set *x, double Z);

/* (1/M) sum_i F/q: eq. 4.5. */
rgbd bis_set_mean(const bis_set *x);

/* L + Z sum_j F/(phat h) V over what was chosen. */
rgbd bis_set_trace(rgbd L, const bis_set *x, const bis_point *pt, double Z);
