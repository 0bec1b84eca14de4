/* set: draw, weigh, choose, trace. */
#include "set.h"

#include "bis/base/mem.h"
#include "beyond/map_lanes.h"
#include "candidates.h"
#include "proposal.h"

#include "bis/thesis/curve.h"

#include <assert.h>
#include <float.h>

enum { BLOCK = BIS_LANES_BLOCK };

/* ---- draw: x_i ~ q ---- */

static void put(const bis_lanes *l, uint32_t i, const bis_light_point *y, double unit)
{
    const bis_light_point p = y && y->pdf >= (double)FLT_MIN ? *y : (bis_light_point){.pdf = 1};

    l->x[i] = p.wi.x;
    l->y[i] = p.wi.y;
    l->z[i] = p.wi.z;
    l->r[i] = (float)((double)p.Le.r / unit);
    l->g[i] = (float)((double)p.Le.g / unit);
    l->b[i] = (float)((double)p.Le.b / unit);
    l->q[i] = (float)p.pdf;
}

/* From the map's importance, for this point alone. */
static void draw_map(bis_set *x, uint32_t n, bool stratify, const bis_point *pt, bis_stream *stream)
{
    double u[2], one[1][2];

    for (uint32_t i = 0; i < n; i++) {
        bis_light_point y;
        bool drawn;
        if (stratify) {
            const double t = bis_stratum(i, bis_stream_random(stream), n);
            u[0] = bis_stream_random(stream);
            u[1] = bis_stream_random(stream);
            drawn = bis_light_sample_curve(pt->light, t, u, &y);
        } else {
            if (n == 1) {
                bis_stream_points(stream, BIS_DIM_EM, 1, one);
                u[0] = one[0][0], u[1] = one[0][1];
            } else {
                u[0] = bis_stream_random(stream);
                u[1] = bis_stream_random(stream);
            }
            drawn = bis_propose_em(&y, pt->light, stream, u);
        }
        put(&x->own, i, drawn ? &y : NULL, x->mean);
    }
    for (uint32_t i = n; i < bis_lanes_round_up(n); i++) put(&x->own, i, NULL, 1);
    x->map = x->own;
    x->n_map = n;
}

/* A set of the pool, which all points of a pass share. */
static void draw_pool(bis_set *x, bis_stream *stream)
{
    x->map = bis_pool_lanes(x->pool, bis_pool_choose(x->pool, &stream->rng));
    x->left_out = (uint32_t)(bis_rng_u64(&stream->rng) >> 32);
    x->n_map = x->M;
}

/* Where the product can be large (src/beyond/product.c). */
static bool draw_product(bis_set *x, uint32_t n, const bis_point *pt, bis_stream *stream)
{
    double marks[1][2], phase[1][2]; /* over the camera samples of a pixel evenly spread */

    if (!bis_product_weigh(&x->product, x->clusters, x->foresight->h, pt)) return false;
    bis_stream_points(stream, BIS_DIM_MARKS, 1, marks);
    bis_stream_points(stream, BIS_DIM_PHASE, 1, phase);
    bis_product_draw(&x->product, x->clusters, n, marks[0][0], phase[0][0], stream->pixel);
    x->map = x->own = x->product.y;
    x->n_map = n;
    x->offset = marks[0][1];
    return true;
}

static void draw_brdf(bis_set *x, uint32_t n, bool stratify, const bis_point *pt, bis_stream *stream)
{
    double one[1][2];

    if (stratify) {
        bis_lanes_points(x->u1, x->u2, n, bis_rng_u64(&stream->rng));
    } else {
        if (n == 1) bis_stream_points(stream, BIS_DIM_BRDF, 1, one);
        for (uint32_t i = 0; i < bis_lanes_round_up(n); i++) {
            x->u1[i] = fminf((float)(n == 1 ? one[0][0] : i < n ? bis_stream_random(stream) : 0), 0x1.fffffep-1f);
            x->u2[i] = fminf((float)(n == 1 ? one[0][1] : i < n ? bis_stream_random(stream) : 0), 0x1.fffffep-1f);
        }
    }
    bis_bsdf_sample_many(&x->brdf, &pt->bsdf, x->u1, x->u2, n);
    bis_light_look(pt->light, &x->brdf, x->pixel, n);
}

bool bis_set_draw(bis_set *x, const bis_settings *s, bis_proposal proposal, const bis_point *pt, bis_stream *stream)
{
    const uint32_t M = s->candidates;
    const bool stratify = s->stratify && s->integrator != &bis_rejection;

    if (bis_bsdf_is_black(&pt->bsdf) || bis_light_is_black(pt->light)) return false;
    pt->counters->candidates += M;
    const bis_mixture m = bis_candidates_divide(M, proposal, pt, stream);
    x->M = M;
    x->beta = m.beta;
    x->n_map = 0;
    x->n_brdf = m.n_brdf;
    x->mean = bis_light_mean(pt->light);
    x->offset = -1;
    if (m.n_em && x->clusters) {
        if (!draw_product(x, m.n_em, pt, stream)) return false;
    } else if (m.n_em && x->pool) {
        draw_pool(x, stream);
    } else if (m.n_em) {
        draw_map(x, m.n_em, stratify, pt, stream);
    }
    x->first_brdf = bis_lanes_round_up(x->n_map);
    if (!m.n_brdf) return true;
    draw_brdf(x, m.n_brdf, stratify, pt, stream);
    for (uint32_t i = 0; x->clusters && m.n_em && i < m.n_brdf; i++) { /* q_P instead of q_L */
        const uint32_t k = bis_cluster_of_pixel(x->clusters, x->pixel[i]);
        x->cluster[x->first_brdf + i] = (uint16_t)k;
        x->brdf.q[i] *= (float)bis_product_scale(&x->product, x->clusters, k);
    }
    return true;
}

/* ---- weigh: w_i = phat/q h_i, eq. 4.9 ---- */

/* 1/sum of a denormal would be infinite: it is made a normal float first, by lift, which rounds nothing. */
static inline BIS_INLINE float lift_of(float sum) { return bis_lanes_choose(sum < FLT_MIN, 0x1p64f, 1); }
static inline BIS_INLINE float share_of(float sum)
{
    return 1 / (bis_lanes_choose(sum > 0, sum, 1) * lift_of(sum));
}

/* [weigh] */
BIS_LANES
static void weigh_lanes(float *restrict w, const bis_lanes *x, const bis_reflected *f, float beta_L, float beta_f,
                        uint32_t n)
{
    const bis_lanes l = *x;
    const bis_reflected k = *f;

#pragma omp simd
    for (uint32_t i = 0; i < n; i++) {
        const float phat = k.cos[i] * (k.r[i] * l.r[i] + k.g[i] * l.g[i] + k.b[i] * l.b[i]);
        const float q = beta_L * l.q[i] + beta_f * k.q[i];
        /* q = 0: a black pixel, outside the lobe; phat is 0, too */
        w[i] = bis_lanes_choose(k.cos[i] > 0, phat / bis_lanes_choose(q > 0, q, 1), 0);
    }
}
/* [end] */

/* r, g, b become F/phat, the share of each channel: 1 in all, or 0. */
BIS_LANES
static void share_lanes(const bis_lanes *x, uint32_t n)
{
    const bis_lanes l = *x;

#pragma omp simd
    for (uint32_t i = 0; i < n; i++) {
        const float sum = l.r[i] + l.g[i] + l.b[i], share = share_of(sum);
        l.r[i] = l.r[i] * lift_of(sum) * share;
        l.g[i] = l.g[i] * lift_of(sum) * share;
        l.b[i] = l.b[i] * lift_of(sum) * share;
    }
}

BIS_LANES
static void foresee(float *restrict w, const float *restrict h, const uint16_t *restrict cluster, uint32_t n)
{
    for (uint32_t i = 0; i < n; i++) w[i] *= h[cluster[i]];
}

bis_reflected bis_set_reflected(const bis_set *x, uint32_t first)
{
    const size_t n = 2 * (size_t)x->capacity;

    return (bis_reflected){x->f + first, x->f + n + first, x->f + 2 * n + first, x->f + 3 * n + first, x->f + 4 * n + first};
}

static void weigh(bis_set *x, const bis_lanes *lanes, uint32_t first, uint32_t n, const bis_point *pt)
{
    const bis_reflected f = bis_set_reflected(x, first);

    x->unit = bis_bsdf_f_many(&f, &pt->bsdf, lanes, n);
    weigh_lanes(x->w.w + first, lanes, &f, (float)x->beta, (float)(1 - x->beta), bis_lanes_round_up(n));
}

bool bis_set_has_control(const bis_set *x, const bis_point *pt)
{
    return x->foresight && x->foresight->knows && x->n_brdf == 0 && !rgb_is_black(pt->bsdf.material->Kd);
}

double bis_set_weigh(bis_set *x, const bis_point *pt)
{
    float *w = x->w.w;

    if (x->n_map) weigh(x, &x->map, 0, x->n_map, pt);
    if (x->n_map == x->M) /* of a shared set */
        for (uint32_t j = 0; j < x->n_brdf; j++) w[bis_one_of_set(j, x->n_brdf, x->M, x->left_out)] = 0;
    if (x->n_brdf) weigh(x, &x->brdf, x->first_brdf, x->n_brdf, pt);
    if (x->foresight && x->foresight->h && x->clusters) {
        foresee(w, x->foresight->h, x->product.cluster, x->n_map);
        foresee(w + x->first_brdf, x->foresight->h, x->cluster + x->first_brdf, x->n_brdf);
    }
    x->n_lanes = x->first_brdf + bis_lanes_round_up(x->n_brdf);
    return bis_blocks_sum(&x->w, x->n_lanes);
}

/* ---- choose: y_j = x_i with probability w_i/W ---- */

/* y_j with F over its unit in r, g, b. */
static void take(bis_set *x, uint32_t j, const bis_lanes *from, uint32_t i, uint32_t lane)
{
    const bis_reflected f = bis_set_reflected(x, 0);

    x->y.x[j] = from->x[i];
    x->y.y[j] = from->y[i];
    x->y.z[j] = from->z[i];
    x->y.r[j] = f.r[lane] * from->r[i];
    x->y.g[j] = f.g[lane] * from->g[i];
    x->y.b[j] = f.b[lane] * from->b[i];
}

void bis_set_gather(bis_set *x, const bis_point *pt)
{
    const uint32_t n = x->w.n_chosen;
    const bool learned = x->foresight && x->foresight->h && x->clusters;

    (void)pt;
    for (uint32_t j = 0; j < n; j++) {
        const uint32_t i = x->w.lane[j];
        const bool brdf = i >= x->first_brdf;
        take(x, j, brdf ? &x->brdf : &x->map, brdf ? i - x->first_brdf : i, i);
        x->y.q[j] = 1;
        if (!learned) continue;
        x->cluster_y[j] = brdf ? x->cluster[i] : x->product.cluster[i];
        x->y.q[j] = x->foresight->h[x->cluster_y[j]];
    }
    for (uint32_t j = n; j < bis_lanes_round_up(n); j++) x->y.r[j] = x->y.g[j] = x->y.b[j] = 0;
    share_lanes(&x->y, bis_lanes_round_up(n));
}

void bis_set_take(bis_set *x, uint32_t n)
{
    x->w.n_chosen = n;
    for (uint32_t j = 0; j < n; j++) x->w.times[j] = 1;
    bis_set_gather(x, NULL);
}

void bis_set_choose(bis_set *x, uint32_t N, double W, bis_resampling resampling, const bis_point *pt,
                    bis_stream *stream)
{
    if (x->offset >= 0 && resampling == BIS_RESAMPLING_SYSTEMATIC)
        bis_blocks_choose_systematic(&x->w, N, W, x->offset);
    else
        bis_blocks_choose(&x->w, N, W, resampling, stream);
    bis_set_gather(x, pt);
}

/* ---- the control variate ---- */

/* The sum of w g/h F/phat over the candidates. The lanes of a block are summed side by side, in an order that no
 * vector width changes. */
static inline BIS_INLINE rgbd sum_as(const bis_lanes *x, const bis_reflected *f, const float *restrict w,
                                     const uint16_t *restrict cluster, const float *restrict control, uint32_t n,
                                     const bool controlled)
{
    const bis_lanes l = *x;
    const bis_reflected k = *f;
    float r[BLOCK] = {0}, g[BLOCK] = {0}, b[BLOCK] = {0};
    rgbd sum = {0, 0, 0};

    for (uint32_t first = 0; first < n; first += BLOCK) {
        float wg[BLOCK];
        for (uint32_t i = 0; i < BLOCK; i++)
            wg[i] = controlled ? w[first + i] * control[cluster[first + i]] : w[first + i];
#pragma omp simd
        for (uint32_t i = 0; i < BLOCK; i++) {
            const float Fr = k.r[first + i] * l.r[first + i], Fg = k.g[first + i] * l.g[first + i],
                        Fb = k.b[first + i] * l.b[first + i], total = Fr + Fg + Fb, share = share_of(total);
            r[i] += wg[i] * (Fr * lift_of(total) * share);
            g[i] += wg[i] * (Fg * lift_of(total) * share);
            b[i] += wg[i] * (Fb * lift_of(total) * share);
        }
    }
    for (uint32_t i = 0; i < BLOCK; i++) sum = rgbd_add(sum, (rgbd){(double)r[i], (double)g[i], (double)b[i]});
    return sum;
}

BIS_LANES
static rgbd sum_of_known(const bis_lanes *x, const bis_reflected *f, const float *w, const uint16_t *cluster,
                         const float *control, uint32_t n)
{
    if (control) return sum_as(x, f, w, cluster, control, n, true);
    return sum_as(x, f, w, NULL, NULL, n, false);
}

rgbd bis_set_expected(const bis_set *x, double Z)
{
    const float *control = x->foresight->control;
    rgbd marks = {0, 0, 0};

    const bis_reflected f = bis_set_reflected(x, 0);
    const rgbd all = sum_of_known(&x->map, &f, x->w.w, x->product.cluster, control, x->n_map);
    for (uint32_t j = 0; j < x->w.n_chosen; j++) {
        const double s = Z * x->w.times[j] * (double)control[x->cluster_y[j]];
        marks = rgbd_add(marks, (rgbd){(double)x->y.r[j] * s, (double)x->y.g[j] * s, (double)x->y.b[j] * s});
    }
    const rgb L = rgbd_round(rgbd_add(rgbd_scale(all, x->unit * x->mean / x->M), rgbd_scale(marks, -1)));
    return (rgbd){(double)L.r, (double)L.g, (double)L.b}; /* a float, as where rays are only noted (bis_point_add) */
}

rgbd bis_set_mean(const bis_set *x)
{
    const bis_reflected f = bis_set_reflected(x, 0), f_brdf = bis_set_reflected(x, x->first_brdf);
    const rgbd map = sum_of_known(&x->map, &f, x->w.w, NULL, NULL, x->n_map);
    const rgbd brdf = sum_of_known(&x->brdf, &f_brdf, x->w.w + x->first_brdf, NULL, NULL, x->n_brdf);

    return rgbd_scale(rgbd_add(map, brdf), x->unit * x->mean / x->M);
}

/* ---- trace ---- */

rgbd bis_set_trace(rgbd L, const bis_set *x, const bis_point *pt, double Z)
{
    const bis_lanes *y = &x->y;
    const bool learned = x->foresight && x->foresight->h && x->clusters;

    for (uint32_t j = 0; j < x->w.n_chosen; j++) {
        const rgbd share = {(double)y->r[j], (double)y->g[j], (double)y->b[j]};
        const rgbd C = rgbd_scale(share, Z * x->w.times[j] / (double)y->q[j]);
        uint16_t *seen = learned ? bis_foresight_count((bis_foresight *)x->foresight, x->cluster_y[j], x->clusters->n)
                                 : NULL;
        bis_point_add(&L, pt, (vec3){y->x[j], y->y[j], y->z[j]}, C, seen);
    }
    return L;
}

/* ---- memory ---- */

bis_status bis_set_init(bis_set *x, const bis_settings *s, bis_diag *diag)
{
    const uint32_t M = s->candidates, m = bis_lanes_round_up(M), N = s->shadowrays;
    const bool rejects = s->integrator == &bis_rejection;
    const uint32_t most = rejects && M > N ? M : N, n = bis_lanes_round_up(most), c = m > n ? m : n;

    *x = (bis_set){.capacity = c};
    const bool product = s->proposal == BIS_PROPOSAL_PRODUCT && s->stratify;
    bool ok = bis_blocks_init(&x->w, 2 * c, most);
    if (product) ok = bis_product_init(&x->product, M) && ok;
    x->floats = bis_alloc((2 * BIS_LANES_ARRAYS + 2 + 10) * (size_t)c + BIS_LANES_ARRAYS * (size_t)n, sizeof(float));
    x->pixel = bis_alloc(c, sizeof *x->pixel);
    x->cluster = bis_alloc(2 * (size_t)c, sizeof *x->cluster);
    x->cluster_y = bis_alloc(n, sizeof *x->cluster_y);
    if (!ok || !x->floats || !x->pixel || !x->cluster || !x->cluster_y) {
        bis_set_clear(x);
        return bis_error(diag, BIS_NOMEM, (bis_loc){NULL, 0, 0},
                         "no memory for a thread's %u candidates and %u chosen ones; fewer of them need less",
                         (unsigned)M, (unsigned)N);
    }
    x->u1 = x->floats;
    x->u2 = x->u1 + c;
    x->f = x->u2 + c;
    x->brdf = bis_lanes_in(x->f + 10 * (size_t)c, c);
    x->own = bis_lanes_in(x->f + (10 + BIS_LANES_ARRAYS) * (size_t)c, c);
    x->y = bis_lanes_in(x->f + (10 + 2 * BIS_LANES_ARRAYS) * (size_t)c, n);
    return BIS_OK;
}

void bis_set_clear(bis_set *x)
{
    bis_blocks_clear(&x->w);
    bis_product_clear(&x->product);
    bis_free(x->floats);
    bis_free(x->pixel);
    bis_free(x->cluster);
    bis_free(x->cluster_y);
    *x = (bis_set){.M = 0};
}
