/* candidates: draw M, weigh, resample N, trace. These are the steps of thesis 4.4.
 *
 * Proposal. q is q_L, q_f, or their mixture q = beta q_L + (1 - beta) q_f with beta = M_em/M. A candidate of a
 * mixture has this density, whichever of the two it came from (docs/errata.md E26). No weight then exceeds
 * min(phat/(beta q_L), phat/((1-beta) q_f)), so neither a sun nor a narrow lobe spoils the estimate. beta may depend
 * on the material and the light, which are known before anything is drawn (share_of_brdf). It must never depend on
 * what was drawn.
 *
 * Weight. w = phat/q with phat = F.r + F.g + F.b and F = f cos Le. The printed weights w = f and w = L forget the
 * cosine and the true q_f (E23).
 *
 * Order. Stratified candidates from the map take one direction in each equal part of the importance along a
 * space-filling curve. Those from the BRDF take one in each equal part of a Hilbert curve over (u1, u2). Neighbours
 * in the array are then neighbours in direction, and N equally spaced marks over the running sum of weights reach all
 * parts of the product evenly. Only stratified candidates and equally spaced marks together pay: the squared error at
 * N = 15 is 1.2 to 4 times smaller.
 *
 * Sets. The stratified directions from the map may come from sets that all pixels of a pass share. This is 10 times
 * cheaper than drawing them. The estimate has the same distribution, but pixels with the same set share their luck.
 * candidates_from_em draws directions for this point alone.
 *
 * Unbiased. The density of each candidate is q (if stratified, the densities of the candidates average to q), so
 * E[(1/M) sum w V] is right. Resampling gives candidate i on average N w_i/W of the marks, whatever the scheme, so
 * E[(W/M) (1/N) sum V | candidates] = (1/M) sum w V. */
#include "candidates.h"

#include "proposal.h"
#include "resample.h"


/* ---- the proposal ---- */

/* c_em and c_brdf of figure 4.4. */
double bis_candidates_bound(const bis_point *pt, bis_proposal proposal)
{
    if (proposal == BIS_PROPOSAL_EM) return bis_bsdf_max_f_cos(&pt->bsdf) * bis_light_max_ratio(pt->light);
    return bis_bsdf_max_ratio(&pt->bsdf) * bis_light_max_intensity(pt->light);
}

/* Returns the BRDF's share of a mixture.
 *
 * The thesis's own measure (4.3) compares the proposals' bounds: the smaller a bound, the larger the share. Here the
 * shares go by the squares of the bounds, because these compare variances. Under a smooth sky the BRDF gets nearly
 * everything.
 *
 * Under a sun it would get nothing, although the rest of the map needs it if the lobe is narrow. Of M candidates
 * spread evenly over the sphere, k = M/(4 pi q_f(R)) would fall into the lobe about R. If k is small, the BRDF
 * therefore gets up to half.
 *
 * Every share is unbiased. With this one, the error of independent candidates stays within 1.4 times that of the
 * better proposal alone (tests/thesis/test_sir.c, E26). At n = 50 under a church, 6 % of M = 800 are as good as half of
 * them, at half the time.
 *
 * The candidates of the product find the lobe by themselves, down to the size of a cluster. The BRDF's share is then
 * as if there were 64 times as many candidates. */
static double share_of_brdf(uint32_t M, bis_proposal proposal, const bis_point *pt)
{
    double c_em = bis_candidates_bound(pt, BIS_PROPOSAL_EM), c_brdf = bis_candidates_bound(pt, BIS_PROPOSAL_BRDF);
    double k = M / (4 * PI * bis_bsdf_pdf(&pt->bsdf, pt->bsdf.r)), r = c_brdf / c_em;

    if (proposal == BIS_PROPOSAL_PRODUCT) return pt->bsdf.p_specular / 2 / (1 + 64 * k);
    return fmax(1 / (1 + r * r), pt->bsdf.p_specular / 2 / (1 + k));
}

/* Under a constant light q_f alone is nearly the product, so all candidates come from the BRDF. A specular lobe
 * always gets at least one candidate, except with the product: it needs none, and a single one would cost as much as
 * a whole block. A diffuse surface gets none if its share rounds to 0. M = 1 cannot be divided: its technique is
 * drawn at random, and the density is that of the mixture. */
bis_mixture bis_candidates_divide(uint32_t M, bis_proposal proposal, const bis_point *pt, bis_stream *stream)
{
    const bis_mixture em = {M, 0, 1}, brdf = {0, M, 0};

    if (proposal == BIS_PROPOSAL_EM) return em;
    if (proposal == BIS_PROPOSAL_BRDF || bis_light_is_constant(pt->light)) return brdf;

    double share = share_of_brdf(M, proposal, pt);
    if (M == 1) {
        uint32_t n_brdf = bis_stream_random(stream) < share;
        return (bis_mixture){1 - n_brdf, n_brdf, 1 - share};
    }
    const bool product = proposal == BIS_PROPOSAL_PRODUCT, always = pt->bsdf.p_specular > 0 && !product;
    const double n = product ? floor(share * M) : round(share * M);
    const uint32_t n_brdf = (uint32_t)fmax(always, fmin(n, M - 1));
    return (bis_mixture){M - n_brdf, n_brdf, (double)(M - n_brdf) / M};
}

unsigned bis_candidates_light_needs(bis_proposal proposal, bool stratify)
{
    if (proposal == BIS_PROPOSAL_BRDF) return 0;
    return stratify ? BIS_NEED_CURVE : BIS_NEED_TABLE;
}

uint32_t bis_candidates_set_needs(const bis_settings *s)
{
    const bool from_map = s->proposal == BIS_PROPOSAL_EM || s->proposal == BIS_PROPOSAL_MIX;

    return s->stratify && from_map ? s->candidates : 0;
}

/* ---- the numbers behind a candidate ---- */

/* Stores one of n independent points. If n = 1, it is the set of one point that plain importance sampling uses,
 * because M = N = 1 must give the same bits (E24). */
static void independent_point(double u[2], bis_stream *stream, unsigned dim, uint32_t n)
{
    if (n == 1) {
        double set[1][2];
        bis_stream_points(stream, dim, 1, set);
        u[0] = set[0][0];
        u[1] = set[0][1];
        return;
    }
    u[0] = bis_stream_random(stream);
    u[1] = bis_stream_random(stream);
}

static bool draw_em(bis_light_point *y, const bis_light *light, bis_stream *stream, uint32_t i, uint32_t n,
                    bool stratify)
{
    double u[2];

    if (!stratify) {
        independent_point(u, stream, BIS_DIM_EM, n);
        return bis_propose_em(y, light, stream, u);
    }
    double t = bis_stratum(i, bis_stream_random(stream), n);
    u[0] = bis_stream_random(stream);
    u[1] = bis_stream_random(stream);
    return bis_light_sample_curve(light, t, u, y);
}

static bool draw_brdf(vec3 *wi, const bis_bsdf *bsdf, bis_stream *stream, uint32_t i, uint32_t n, bool stratify)
{
    double u[2];

    if (stratify) {
        bis_curve_hilbert(bis_stratum(i, bis_stream_random(stream), n), u);
    } else {
        independent_point(u, stream, BIS_DIM_BRDF, n);
    }
    return bis_bsdf_draw(bsdf, u, wi);
}

/* ---- the weights ---- */

/* Weighs a direction from the map. q_L came with it; q_f is computed only for a mixture. */
/* [weigh-em] */
static void weigh_em(bis_candidate *c, const bis_point *pt, const bis_light_point *y, double beta)
{
    double q = y->pdf, cos_theta = bis_bsdf_cos(&pt->bsdf, y->wi);
    rgb f;

    if (cos_theta <= 0) return;
    if (beta < 1) {
        double q_f;
        f = bis_bsdf_f_pdf(&pt->bsdf, y->wi, &q_f);
        q = beta * q + (1 - beta) * q_f;
    } else {
        f = bis_bsdf_f(&pt->bsdf, y->wi);
    }
    c->wi = y->wi;
    c->C = bis_estimate(f, y->Le, cos_theta, q);
    c->w = rgbd_sum(c->C);
}
/* [end] */

/* Weighs a direction from the BRDF. Its radiance is looked up, and q_L, too, for a mixture. */
/* [weigh-brdf] */
static void weigh_brdf(bis_candidate *c, const bis_point *pt, vec3 wi, double beta)
{
    double q, cos_theta = bis_bsdf_cos(&pt->bsdf, wi);

    if (cos_theta <= 0) return;
    rgb f = bis_bsdf_f_pdf(&pt->bsdf, wi, &q);
    if (q <= 0) return; /* the lobe underflows: f = 0 here, too */
    rgb Le;
    if (beta > 0) {
        double q_L;
        Le = bis_light_Le_pdf(pt->light, wi, &q_L);
        q = beta * q_L + (1 - beta) * q;
    } else {
        Le = bis_light_Le(pt->light, wi);
    }
    c->wi = wi;
    c->C = bis_estimate(f, Le, cos_theta, q);
    c->w = rgbd_sum(c->C);
}
/* [end] */

/* Takes n_em of the M directions of a set. The n_brdf = M - n_em directions that are left out are evenly spread. */
static void candidates_from_set(bis_candidate *c, const bis_mixture *m, const bis_sets *sets, const bis_point *pt,
                                bis_stream *stream)
{
    const bis_light_point *set = sets->choose(sets, stream);
    const uint32_t M = m->n_em + m->n_brdf;
    const uint32_t phase = (uint32_t)(bis_rng_u64(&stream->rng) >> 32);
    uint32_t n = 0, left_out = 0;

    for (uint32_t i = 0; i < M; i++) {
        if (left_out < m->n_brdf && i == bis_one_of_set(left_out, m->n_brdf, M, phase)) {
            left_out++;
            continue;
        }
        c[n] = (bis_candidate){.w = 0};
        weigh_em(&c[n++], pt, &set[i], m->beta);
    }
}

static void candidates_from_em(bis_candidate *c, uint32_t n, double beta, bool stratify, const bis_point *pt,
                               bis_stream *stream)
{
    for (uint32_t i = 0; i < n; i++) {
        bis_light_point y;
        c[i] = (bis_candidate){.w = 0};
        if (draw_em(&y, pt->light, stream, i, n, stratify)) weigh_em(&c[i], pt, &y, beta);
    }
}

static void candidates_from_brdf(bis_candidate *c, uint32_t n, double beta, bool stratify, const bis_point *pt,
                                 bis_stream *stream)
{
    for (uint32_t i = 0; i < n; i++) {
        vec3 wi;
        c[i] = (bis_candidate){.w = 0};
        if (draw_brdf(&wi, &pt->bsdf, stream, i, n, stratify)) weigh_brdf(&c[i], pt, wi, beta);
    }
}

double bis_candidates_draw(bis_candidate *c, uint32_t M, bis_proposal proposal, bool stratify, const bis_sets *sets,
                           const bis_point *pt, bis_stream *stream)
{
    double W = 0;

    if (bis_bsdf_is_black(&pt->bsdf) || bis_light_is_black(pt->light)) return 0;
    pt->counters->candidates += M;

    const bis_mixture m = bis_candidates_divide(M, proposal, pt, stream);
    if (m.n_em && sets) {
        candidates_from_set(c, &m, sets, pt, stream);
    } else {
        candidates_from_em(c, m.n_em, m.beta, stratify, pt, stream);
    }
    candidates_from_brdf(c + m.n_em, m.n_brdf, m.beta, stratify, pt, stream);
    for (uint32_t i = 0; i < M; i++) W += c[i].w;
    return W;
}

/* ---- resampling ---- */

/* Walks along the running sum S of the weights: the same sum in the same order that made W. A mark that rounds to 1
 * would lie at W, which no S exceeds. It belongs to the last candidate with a positive weight, which need not be the
 * last of all. */
/* [resample] */
void bis_candidates_resample(uint32_t *chosen, uint32_t N, const bis_candidate *c, uint32_t M, double W,
                             bis_resampling resampling, bis_stream *stream)
{
    bis_marks marks = bis_marks_start(resampling, N, stream);
    uint32_t j = 0, last = 0;
    double S = 0;

    double mark = bis_marks_next(&marks, stream) * W;
    for (uint32_t i = 0; i < M; i++) {
        if (c[i].w <= 0) continue;
        S += c[i].w;
        last = i;
        while (mark < S) {
            chosen[j++] = i;
            if (j == N) return;
            mark = bis_marks_next(&marks, stream) * W;
        }
    }
    while (j < N) chosen[j++] = last;
}
/* [end] */

/* ---- the estimate ---- */

/* F/phat = C/w. Z/w is computed first: with M = N = 1 it is w/w = 1, and C remains, which is plain importance
 * sampling (E24). */
/* [trace] */
rgbd bis_candidates_trace(const bis_point *pt, const bis_candidate *c, const uint32_t *chosen, uint32_t N, double Z)
{
    rgbd sum = {0, 0, 0};

    for (uint32_t j = 0, k; j < N; j += k) {
        const bis_candidate *y = &c[chosen[j]];
        for (k = 1; j + k < N && chosen[j + k] == chosen[j];) k++;
        bis_point_add(&sum, pt, y->wi, rgbd_scale(y->C, (double)k * (Z / y->w)), NULL);
    }
    return sum;
}
/* [end] */

rgbd bis_candidates_unoccluded(const bis_candidate *c, uint32_t M)
{
    rgbd sum = {0, 0, 0};

    for (uint32_t i = 0; i < M; i++) sum = rgbd_add(sum, c[i].C);
    return rgbd_scale(sum, 1 / (double)M);
}
