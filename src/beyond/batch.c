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
 * and the light spotty.
 *
 * Earlier rays have learned V: its mean g is known for the neighbourhood of the pixel (bis/beyond/visibility.h). The
 * weights are multiplied by h, which sends rays where V is uncertain, and g serves as a control variate:
 *     L = (1/M) sum_i F_i/q_i g_i + (Zhat/N) sum_j F/(phat h) (V - g),    Zhat = (1/M) sum_i phat_i h_i/q_i,
 * where the first sum needs no rays. Whatever g and h are, the mean of the second sum is that of F (V - g). An estimate
 * may be below 0 where little light arrives, because g promised more. */
#include "batch.h"

/* [batch] */
#include "bis/beyond/bsdf_lanes.h"
#include "map_lanes.h"
#include "product.h"
#include "thesis/candidates.h"
#include "thesis/proposal.h"

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
    bis_foresight_clear(&f->foresight);
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

/* The weights times h of their clusters. */
static void weigh_visibility(bis_batch *b, const bis_mixture *m, uint32_t first_brdf, const float *h)
{
    for (uint32_t i = 0; i < m->n_em; i++) b->weights.w[i] *= h[b->product.cluster[i]];
    for (uint32_t i = 0; i < m->n_brdf; i++) b->weights.w[first_brdf + i] *= h[b->pixel[i]];
}

/* What was chosen has a weight that is h times too large: its colour is divided by it. */
static void find_clusters(bis_batch *b, uint32_t first_brdf, const float *h)
{
    for (uint32_t k = 0; k < b->weights.n_chosen; k++) {
        const uint32_t i = b->weights.lane[k];
        b->cluster[k] = i < first_brdf ? b->product.cluster[i] : b->pixel[i - first_brdf];
        b->traced.q_L[k] = h[b->cluster[k]];
    }
}

/* Where the k-th of what was chosen is to be counted if light arrives; NULL: nowhere. Counts the ray itself. */
static uint16_t *count_ray(const bis_batch *b, uint32_t k, const bis_fast *f)
{
    return f->foresight.h ? bis_foresight_count(&f->foresight, b->cluster[k], f->clusters->n) : NULL;
}

/* Does the control pay? Not under a mirror's lobe alone: it sees few clusters, which the marks divide well enough. */
static bool has_control(const bis_point *pt, const bis_fast *f, const bis_mixture *m)
{
    return f->foresight.knows && m->n_brdf == 0 && !rgb_is_black(pt->bsdf.material->Kd);
}

/* The sum of w g over the candidates, in colour; w g is what a weight, w h, times the control g/h is. The lanes of a
 * block are summed side by side, in an order that no vector width changes. */
BIS_LANES
static rgbd control_sum(const bis_lanes *y, const float *restrict w, const uint16_t *restrict cluster,
                        const float *restrict control, uint32_t n)
{
    float r[SMALLEST] = {0}, g[SMALLEST] = {0}, b[SMALLEST] = {0};
    rgbd sum = {0, 0, 0};

    for (uint32_t first = 0; first < n; first += SMALLEST) {
        float wg[SMALLEST];
        for (uint32_t i = 0; i < SMALLEST; i++) wg[i] = w[first + i] * control[cluster[first + i]];
#pragma omp simd
        for (uint32_t i = 0; i < SMALLEST; i++) {
            r[i] += wg[i] * y->r[first + i];
            g[i] += wg[i] * y->g[first + i];
            b[i] += wg[i] * y->b[first + i];
        }
    }
    for (uint32_t i = 0; i < SMALLEST; i++) sum = rgbd_add(sum, (rgbd){(double)r[i], (double)g[i], (double)b[i]});
    return sum;
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

/* Adds the sum of Z F/phat V over the marks to L. */
static rgbd trace(rgbd L, const bis_batch *b, const bis_point *pt, double Z, const bis_fast *f)
{
    const bis_lanes *y = &b->traced;

    for (uint32_t k = 0; k < b->weights.n_chosen; k++) {
        const rgbd colour = {(double)y->r[k], (double)y->g[k], (double)y->b[k]};
        const rgbd C = rgbd_scale(colour, Z * b->weights.times[k] / (double)y->q_L[k]);
        bis_point_add(&L, pt, (vec3){y->x[k], y->y[k], y->z[k]}, C, count_ray(b, k, f));
    }
    return L;
}

/* The sum of Z F/phat g over the marks. */
static rgbd control_of_marks(const bis_batch *b, double Z, const float *control)
{
    const bis_lanes *y = &b->traced;
    rgbd sum = {0, 0, 0};

    for (uint32_t k = 0; k < b->weights.n_chosen; k++) {
        const double s = Z * b->weights.times[k] * (double)control[b->cluster[k]];
        sum = rgbd_add(sum, (rgbd){(double)y->r[k] * s, (double)y->g[k] * s, (double)y->b[k] * s});
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
    const bis_bsdf_lanes *lanes = bis_bsdf_lanes_of(pt->bsdf.material->model);
    const bis_mixture m = bis_candidates_divide(M, s->proposal, pt, stream);
    const bool control = has_control(pt, f, &m);
    double marks[1][2], phase[1][2]; /* over the camera samples of a pixel evenly spread */
    rgb L = {0, 0, 0}; /* what the control says; a float, as it is where rays are only noted (bis_point_add) */
    bis_lanes map;
    uint32_t n_map;
    double unit;

    pt->counters->candidates += M;
    if (clusters) {
        n_map = m.n_em;
        /* nothing of the map is above the horizon */
        if (!bis_product_weigh(&b->product, clusters, f->foresight.h, pt)) return (rgb){0, 0, 0};
        bis_stream_points(stream, BIS_DIM_MARKS, 1, marks);
        bis_stream_points(stream, BIS_DIM_PHASE, 1, phase);
        bis_product_draw(&b->product, clusters, n_map, marks[0][0], phase[0][0], stream->pixel);
        map = b->product.y;
        unit = lanes->weigh(b->weights.w, &pt->bsdf, &map, n_map, m.beta);
    } else {
        n_map = M;
        map = bis_pool_lanes(f->pool, bis_pool_choose(f->pool, &stream->rng));
        unit = weigh_set(b, &map, &m, pt, stream);
    }
    const uint32_t first_brdf = bis_lanes_round_up(n_map);
    if (m.n_brdf) weigh_brdf(b, b->weights.w + first_brdf, &m, clusters, pt, stream);
    if (f->foresight.h) weigh_visibility(b, &m, first_brdf, f->foresight.h);
    const double W = bis_blocks_sum(&b->weights, first_brdf + bis_lanes_round_up(m.n_brdf));
    if (W <= 0) return (rgb){0, 0, 0};

    if (clusters && s->resampling == BIS_RESAMPLING_SYSTEMATIC)
        bis_blocks_choose_systematic(&b->weights, N, W, marks[0][1]);
    else
        bis_blocks_choose(&b->weights, N, W, s->resampling, stream);
    if (control) lanes->colour(&pt->bsdf, &map, n_map);
    gather(b, &map, first_brdf);
    if (!control) lanes->colour(&pt->bsdf, &b->traced, b->weights.n_chosen);
    if (f->foresight.h) find_clusters(b, first_brdf, f->foresight.h);
    const double Zhat = W / M * unit * mean;
    if (control) {
        const rgbd all = control_sum(&map, b->weights.w, b->product.cluster, f->foresight.control, n_map);
        const rgbd marks_only = control_of_marks(b, Zhat / N, f->foresight.control);
        L = rgbd_round(rgbd_add(rgbd_scale(all, unit * mean / M), rgbd_scale(marks_only, -1)));
    }
    return rgbd_round(trace((rgbd){(double)L.r, (double)L.g, (double)L.b}, b, pt, Zhat / N, f));
}
/* [end] */
