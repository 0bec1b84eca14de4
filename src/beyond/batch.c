/* batch: sampling-importance resampling (sir.c, thesis 4.4) with all candidates of a point side by side.
 *
 * The estimator is that of sir.c and candidates.c, step by step: candidates, weights, N marks over their running sum,
 * rays. What differs is how the numbers lie in memory (bis/lanes.h), and that a candidate is a weight of 4 bytes until
 * it is chosen. M = 800 from a pool take 1 us instead of 20, 50 of them from the BRDF another microsecond instead of 9.
 *
 * Unbiased as sir.c is: the float weights decide which candidates are traced, and the estimate divides by these very
 * weights. With Zhat = W/M,
 *     L = (Zhat/N) sum_j F/phat V,
 * where F/phat is a candidate's colour: neither q nor the cosine is needed again.
 *
 * Proposal "product" draws the map's candidates for this point alone (product.c), which pays where the lobe is narrow
 * and the light spotty. */
#include "batch.h"

/* [batch] */
#include "bis/beyond/bsdf_lanes.h"
#include "map_lanes.h"
#include "product.h"
#include "thesis/candidates.h"

#include "bis/base/mem.h"

#include <assert.h>

enum { SMALLEST = BIS_LANES_BLOCK };

struct bis_batch {
    bis_blocks weights; /* those from the map, whole blocks, then those from the BRDF */
    bis_lanes brdf;     /* candidates from the BRDF, M at most */
    float *u1, *u2;
    uint32_t *pixel;    /* of the map; with clusters, then the clusters that these belong to */
    bis_product product; /* proposal "product" alone */
    bis_lanes traced;   /* [N]: what was chosen; q_L: what its weight was multiplied by beyond phat/q */
    uint32_t *cluster;  /* [N] */
    float *floats;      /* what holds all the float arrays */
};

/* ---- workspace ---- */

static bool wants_product(const bis_settings *s) { return s->proposal == BIS_PROPOSAL_PRODUCT && s->stratify; }

bis_fast_needs bis_fast_needs_of(const bis_settings *s)
{
    const uint32_t n_pool = bis_pool_needs(s);
    const bool is_sir = s->integrator == &bis_sir || s->integrator == &bis_auto, product = is_sir && wants_product(s);
    const bool batch = is_sir && s->vectorize && !s->as_printed && s->candidates >= SMALLEST && (n_pool > 0 || product);

    return (bis_fast_needs){
        .n_pool = n_pool, .batch = batch, .clusters = batch && product, .visibility = batch && product && s->learn};
}

bis_Lo *bis_fast_Lo(const bis_settings *s) { return bis_fast_needs_of(s).batch ? bis_batch_Lo : s->integrator->Lo; }

/* For brdf, u1, u2, traced. */
static size_t floats_needed(uint32_t m, uint32_t n)
{
    return (BIS_LANES_ARRAYS + 2) * (size_t)m + BIS_LANES_ARRAYS * (size_t)n;
}

size_t bis_fast_bytes(const bis_settings *s)
{
    if (!bis_fast_needs_of(s).batch) return 0;
    const uint32_t m = bis_lanes_round_up(s->candidates), N = s->shadowrays, n = bis_lanes_round_up(N);
    const size_t arrays = floats_needed(m, n) * sizeof(float) + m * sizeof(uint32_t) +
                          N * sizeof(uint32_t);

    return sizeof(bis_batch) + arrays + bis_blocks_bytes(2 * m, N) +
           (wants_product(s) ? bis_product_bytes(s->candidates) : 0);
}

static void batch_free(bis_batch *b)
{
    if (!b) return;
    bis_blocks_clear(&b->weights);
    bis_product_clear(&b->product);
    bis_free(b->floats);
    bis_free(b->pixel);
    bis_free(b->cluster);
    bis_free(b);
}

static bis_batch *batch_new(const bis_settings *s)
{
    const uint32_t m = bis_lanes_round_up(s->candidates), N = s->shadowrays, n = bis_lanes_round_up(N);
    bis_batch *b = bis_alloc(1, sizeof *b);

    if (!b) return NULL;
    const bool blocks = bis_blocks_init(&b->weights, 2 * m, N);
    const bool product = !wants_product(s) || bis_product_init(&b->product, s->candidates);
    b->floats = bis_alloc(floats_needed(m, n), sizeof *b->floats);
    b->pixel = bis_alloc(m, sizeof *b->pixel);
    b->cluster = bis_alloc(N, sizeof *b->cluster);
    if (!blocks || !product || !b->floats || !b->pixel || !b->cluster) {
        batch_free(b);
        return NULL;
    }
    b->u1 = b->floats;
    b->u2 = b->u1 + m;
    b->brdf = bis_lanes_in(b->u2 + m, m);
    b->traced = bis_lanes_in(b->u2 + (1 + BIS_LANES_ARRAYS) * (size_t)m, n);
    return b;
}

bis_status bis_fast_init(bis_fast *f, const bis_settings *s, bis_diag *diag)
{
    *f = (bis_fast){.batch = NULL};
    if (!bis_fast_needs_of(s).batch) return BIS_OK;
    f->batch = batch_new(s);
    if (f->batch) return BIS_OK;
    return bis_error(diag, BIS_NOMEM, (bis_loc){NULL, 0, 0},
                     "no memory for a thread's %u candidates and %u chosen ones; fewer of them need less",
                     (unsigned)s->candidates, (unsigned)s->shadowrays);
}

void bis_fast_clear(bis_fast *f)
{
    batch_free(f->batch);
    bis_free(f->visible);
    *f = (bis_fast){.batch = NULL};
}

static bool fits(const bis_point *pt, const bis_fast *f)
{
    return f && f->batch && (f->clusters || f->pool) && bis_bsdf_lanes_of(pt->bsdf.material->model) &&
           !bis_bsdf_is_black(&pt->bsdf);
}

/* ---- candidates and their weights ---- */

/* From the map: a set of the pool. Where the BRDF takes n_brdf of the M, so many of the set, evenly spread, are left
 * out: their weights become 0. Returns the unit of the weights. */
static double weigh_set(bis_batch *b, const bis_lanes *set, const bis_mixture *m, const bis_point *pt,
                        bis_stream *stream)
{
    const uint32_t M = m->n_em + m->n_brdf, phase = (uint32_t)(bis_rng_u64(&stream->rng) >> 32);
    const double unit = bis_bsdf_lanes_of(pt->bsdf.material->model)->weigh(b->weights.w, &pt->bsdf, set, M, m->beta);

    for (uint32_t j = 0; j < m->n_brdf; j++) b->weights.w[bis_one_of_set(j, m->n_brdf, M, phase)] = 0;
    return unit;
}

/* From the BRDF. With a product, the density that it would have drawn them with stands in the place of q_L. */
static void weigh_brdf(bis_batch *b, float *w, const bis_mixture *m, const bis_clusters *clusters, const bis_point *pt,
                       bis_stream *stream)
{
    const bis_bsdf_lanes *lanes = bis_bsdf_lanes_of(pt->bsdf.material->model);

    bis_lanes_points(b->u1, b->u2, m->n_brdf, bis_rng_u64(&stream->rng));
    lanes->sample(&b->brdf, &pt->bsdf, b->u1, b->u2, m->n_brdf);
    bis_light_look(pt->light, &b->brdf, b->pixel, m->n_brdf);
    for (uint32_t i = 0; clusters && i < m->n_brdf; i++) {
        b->pixel[i] = bis_cluster_of_pixel(clusters, b->pixel[i]);
        b->brdf.q_L[i] *= (float)bis_product_scale(&b->product, clusters, b->pixel[i]);
    }
    lanes->weigh(w, &pt->bsdf, &b->brdf, m->n_brdf, m->beta); /* the same material: in the same unit */
}

/* ---- learned visibility ---- */

/* The weights times g of their clusters. */
static void weigh_visibility(bis_batch *b, const bis_mixture *m, uint32_t first_brdf, const float *visible)
{
    for (uint32_t i = 0; i < m->n_em; i++) b->weights.w[i] *= visible[b->product.cluster[i]];
    for (uint32_t i = 0; i < m->n_brdf; i++) b->weights.w[first_brdf + i] *= visible[b->pixel[i]];
}

/* What was chosen has a weight that is g times too large: its colour is divided by it. */
static void find_clusters(bis_batch *b, uint32_t first_brdf, const float *visible)
{
    for (uint32_t k = 0; k < b->weights.n_chosen; k++) {
        const uint32_t i = b->weights.lane[k];
        b->cluster[k] = i < first_brdf ? b->product.cluster[i] : b->pixel[i - first_brdf];
        b->traced.q_L[k] = visible[b->cluster[k]];
    }
}

/* Where the k-th of what was chosen is to be counted if light arrives; NULL: nowhere. Counts the ray itself. */
static uint32_t *count_ray(const bis_batch *b, uint32_t k, const bis_fast *f)
{
    if (!f->visible || !f->counted) return NULL;
    bis_seen *part = &f->counted[bis_visibility_part(b->cluster[k], f->clusters->n)];
    part->rays++;
    return &part->seen;
}

/* ---- rays ---- */

static void copy_lane(const bis_lanes *to, uint32_t k, const bis_lanes *from, uint32_t i)
{
    to->x[k] = from->x[i];
    to->y[k] = from->y[i];
    to->z[k] = from->z[i];
    to->r[k] = from->r[i];
    to->g[k] = from->g[i];
    to->b[k] = from->b[i];
}

/* What was chosen, side by side: lanes below first_brdf are the map's, the others the BRDF's. */
static void gather(bis_batch *b, const bis_lanes *map, uint32_t first_brdf)
{
    const uint32_t n = b->weights.n_chosen;

    for (uint32_t k = 0; k < n; k++) {
        const uint32_t i = b->weights.lane[k];
        const bool brdf = i >= first_brdf;
        copy_lane(&b->traced, k, brdf ? &b->brdf : map, brdf ? i - first_brdf : i);
        b->traced.q_L[k] = 1;
    }
    for (uint32_t k = n; k < bis_lanes_round_up(n); k++) b->traced.r[k] = b->traced.g[k] = b->traced.b[k] = 0;
}

/* The sum of Z F/phat V over the marks. */
static rgbd trace(bis_batch *b, const bis_point *pt, double Z, const bis_fast *f)
{
    const uint32_t n = b->weights.n_chosen;
    const bis_lanes *y = &b->traced;
    rgbd sum = {0, 0, 0};

    bis_bsdf_lanes_of(pt->bsdf.material->model)->colour(&pt->bsdf, y, n);
    for (uint32_t k = 0; k < n; k++) {
        const rgbd colour = {(double)y->r[k], (double)y->g[k], (double)y->b[k]};
        const rgbd C = rgbd_scale(colour, Z * b->weights.times[k] / (double)y->q_L[k]);
        bis_point_add(&sum, pt, (vec3){y->x[k], y->y[k], y->z[k]}, C, count_ray(b, k, f));
    }
    return sum;
}

/* ---- the estimate ---- */

rgb bis_batch_Lo(const bis_settings *s, const bis_point *pt, bis_stream *stream, bis_scratch *scratch)
{
    const bis_fast *f = scratch->fast;

    if (!fits(pt, f)) return bis_sir.Lo(s, pt, stream, scratch);
    bis_batch *b = f->batch;
    const uint32_t M = s->candidates, N = s->shadowrays;
    const bis_clusters *clusters = f->clusters;
    const double mean = bis_light_mean(pt->light);
    const bis_mixture m = bis_candidates_divide(M, s->proposal, pt, stream);
    bis_lanes map;
    uint32_t n_map;
    double unit;

    pt->counters->candidates += M;
    if (clusters) {
        n_map = m.n_em;
        /* nothing of the map is above the horizon */
        if (!bis_product_weigh(&b->product, clusters, f->visible, pt)) return (rgb){0, 0, 0};
        bis_product_draw(&b->product, clusters, n_map, stream);
        map = b->product.y;
        unit = bis_bsdf_lanes_of(pt->bsdf.material->model)->weigh(b->weights.w, &pt->bsdf, &map, n_map, m.beta);
    } else {
        n_map = M;
        map = bis_pool_lanes(f->pool, bis_pool_choose(f->pool, &stream->rng));
        unit = weigh_set(b, &map, &m, pt, stream);
    }
    const uint32_t first_brdf = bis_lanes_round_up(n_map);
    if (m.n_brdf) weigh_brdf(b, b->weights.w + first_brdf, &m, clusters, pt, stream);
    if (f->visible) weigh_visibility(b, &m, first_brdf, f->visible);
    const double W = bis_blocks_sum(&b->weights, first_brdf + bis_lanes_round_up(m.n_brdf));
    if (W <= 0) return (rgb){0, 0, 0};

    bis_blocks_choose(&b->weights, N, W, s->resampling, stream);
    gather(b, &map, first_brdf);
    if (f->visible) find_clusters(b, first_brdf, f->visible);
    const double Zhat = W / M * unit * mean;
    return rgbd_round(trace(b, pt, Zhat / N, f));
}
/* [end] */
