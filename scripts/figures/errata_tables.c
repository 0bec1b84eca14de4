/* SPDX-License-Identifier: BSD-2-Clause */
/* errata_tables: the numbers behind the errata of discrete sampling (thesis 3.2.2, 3.3, appendix A): E8, E10, E11, E12,
 * E14, E15. */
#include "still.h"

#include "bis/flat/taught.h"
#include "bis/thesis/alias.h"
#include "bis/thesis/cdf.h"
#include "bis/base/mem.h"

#include <string.h>

/* ---- E8: P = {0.1, 0.2, 0.4, 0.3} from the CDF ---- */

void errata_E8(bis_json *j)
{
    enum { DRAWS = 100000 };
    static const double P[4] = {0.1, 0.2, 0.4, 0.3}, wanted_printed[5] = {0, 0.1, 0.2, 0.4, 0.3};
    double C[6] = {0}, ours[4] = {0}, printed[5] = {0};
    bis_cdf cdf;
    bis_rng r;

    still_check(bis_cdf_init(&cdf, P, 4, NULL));
    bis_rng_init(&r, ERRATA_SEED, 0, 0, 0);
    for (int i = 1; i <= 4; i++) C[i] = C[i - 1] + P[i - 1]; /* C[i] = p[1] + ... + p[i] */
    C[5] = 1;
    for (int k = 0; k < DRAWS; k++) {
        const double u = bis_rng_double(&r);
        int i = 0;
        while (i < 4 && !(C[i] <= u && u < C[i + 1])) i++; /* C[i] <= u < C[i+1] */
        printed[i] += 1.0 / DRAWS;
        ours[bis_cdf_sample(&cdf, u, NULL)] += 1.0 / DRAWS;
    }
    bis_cdf_clear(&cdf);
    still_list(j, "printed", printed, 5);
    still_list(j, "printed_P", wanted_printed, 5);
    still_list(j, "right", ours, 4);
    still_list(j, "P", P, 4);
}

/* ---- E10: the inverse of C, tabulated ---- */

void errata_E10(bis_json *j)
{
    enum { N = 64 };
    double w[N], rank[N], ours[N], printed[N] = {0};
    int lost = 0;
    bis_cdf cdf;

    for (int i = 0; i < N; i++) w[i] = exp(12.0 * i / N); /* contrast 1e5 */
    still_check(bis_cdf_init(&cdf, w, N, NULL));
    for (int k = 0; k < N; k++)
        printed[bis_cdf_sample(&cdf, (k + 0.5) / N, NULL)] += 1.0 / N; /* entry k of the table of inverses */
    for (int i = 0; i < N; i++) {
        rank[i] = i + 0.5;
        ours[i] = bis_cdf_pmf(&cdf, (size_t)i);
        lost += printed[i] == 0;
    }
    bis_cdf_clear(&cdf);
    still_list(j, "rank", rank, N);
    still_list(j, "printed", printed, N);
    still_list(j, "right", ours, N);
    bis_json_count(j, "never_drawn", (uint64_t)lost);
}

/* ---- E11: prob of those who give ---- */

void errata_E11(bis_json *j)
{
    enum { N = 3 };
    static const double P[N] = {0.1, 0.45, 0.45};
    double ours[N], printed[N];
    bis_alias a;

    still_check(bis_alias_init(&a, P, N, NULL));
    bis_alias_implied_pmf(&a, ours);
    for (int i = 0; i < N; i++)
        if (P[i] > 1.0 / N) a.prob[i] = 1;
    bis_alias_implied_pmf(&a, printed);
    bis_alias_clear(&a);
    still_list(j, "P", P, N);
    still_list(j, "printed", printed, N);
    still_list(j, "right", ours, N);
}

/* ---- E12: Sobol' points through both tables ---- */

static rgb glow(int x, int y, int width, int height)
{
    const double phi = 2 * PI * (x + 0.5) / width, theta = PI * (y + 0.5) / height;
    const double c = sin(theta) * cos(phi - 2.4) * sin(1.1) + cos(theta) * cos(1.1); /* to the light's middle */
    const double L = 0.2 + 3 * exp(6 * (c - 1));

    return rgb_from(L, L, L);
}

/* n points into u[][4]: two of Sobol', two plain ones for the place in the pixel. */
static void sobol(double (*u)[4], uint32_t n, uint64_t pixel)
{
    const bis_sampler sampler = {
        .kind = BIS_SAMPLER_SOBOL, .seed = ERRATA_SEED, .spp = 1, .xsamples = 1, .ysamples = 1};
    double (*pair)[2] = bis_alloc(n, sizeof *pair);
    bis_stream stream;

    if (!pair) still_check(BIS_NOMEM);
    bis_stream_init(&stream, &sampler, pixel, 0);
    bis_stream_points(&stream, 0, n, pair);
    for (uint32_t i = 0; i < n; i++) {
        u[i][0] = pair[i][0], u[i][1] = pair[i][1];
        u[i][2] = bis_stream_random(&stream), u[i][3] = bis_stream_random(&stream);
    }
    bis_free(pair);
}

/* Irradiance of a tilted patch from n points. */
static double irradiance(const bis_light *light, double (*u)[4], uint32_t n)
{
    const vec3 normal = {0.6f, 0, 0.8f};
    double sum = 0;

    for (uint32_t i = 0; i < n; i++) {
        bis_light_point y;
        bis_light_sample(light, u[i], &y);
        sum += rgb_sum(y.Le) * fmax(0, dot(normal, y.wi)) / y.pdf;
    }
    return sum / n;
}

static double relative_error(const bis_light *light, uint32_t n)
{
    enum { RUNS = 100 };
    double (*u)[4] = bis_alloc(n, sizeof *u), mean = 0, square = 0;

    if (!u) still_check(BIS_NOMEM);
    for (uint64_t run = 1; run <= RUNS; run++) {
        sobol(u, n, run);
        const double E = irradiance(light, u, n);
        mean += E / RUNS;
        square += E * E / RUNS;
    }
    bis_free(u);
    return sqrt(square - mean * mean) / mean;
}

static void points(bis_json *j, const char *key, bis_table_kind kind)
{
    enum { N = 512 };
    bis_light *light = errata_light(64, 32, glow, kind);
    double u[N][4], phi[N], theta[N];

    sobol(u, N, 0);
    for (uint32_t i = 0; i < N; i++) {
        bis_light_point y;
        bis_light_sample(light, u[i], &y);
        const double a = atan2((double)y.wi.y, (double)y.wi.x);
        phi[i] = (a < 0 ? a + 2 * PI : a) * 180 / PI, theta[i] = acos((double)y.wi.z) * 180 / PI;
    }
    bis_json_open(j, key, '{');
    still_list(j, "phi_deg", phi, N);
    still_list(j, "theta_deg", theta, N);
    BIS_JSON_NUMBERS(j, {"error_512", relative_error(light, 512)}, {"error_4096", relative_error(light, 4096)});
    bis_json_close(j);
    bis_light_free(light);
}

void errata_E12(bis_json *j)
{
    enum { WIDTH = 64, HEIGHT = 32 };
    double L[WIDTH * HEIGHT];

    for (int i = 0; i < WIDTH * HEIGHT; i++) L[i] = (double)glow(i % WIDTH, i / WIDTH, WIDTH, HEIGHT).r;
    bis_json_count(j, "width", WIDTH);
    bis_json_count(j, "height", HEIGHT);
    still_list(j, "map", L, WIDTH * HEIGHT);
    points(j, "printed", BIS_TABLE_ALIAS);
    points(j, "right", BIS_TABLE_CDF);
}

/* ---- E14: few bits ---- */

void errata_E14(bis_json *j)
{
    enum { LOG_N = 12, LEFT = 12 };
    double w[1 << LOG_N], share[2][1 << LOG_N], impossible[2], left[LEFT], printed[LEFT], ours[LEFT];

    for (int i = 0; i < 1 << LOG_N; i++) w[i] = i % 2;
    for (int k = 0; k < LEFT; k++) {
        left[k] = k + 1;
        still_check(
            (bis_status)bis_flat_alias_few_bits(1 << LOG_N, w, LOG_N + k + 1, share[0], share[1], impossible, NULL, 0));
        printed[k] = impossible[0];
        ours[k] = impossible[1];
    }
    still_list(j, "bits", left, LEFT);
    still_list(j, "printed", printed, LEFT);
    still_list(j, "right", ours, LEFT);
}

/* ---- E15: what is left over ---- */

/* Appendix A as printed, on normalised weights, in the float in which it is likely to be written. */
static void appendix_A(float *probs, uint32_t *alias, uint32_t *small, uint32_t *large, uint32_t n)
{
    const float standard = 1.0f / (float)n;
    uint32_t n_small = 0, n_large = 0;

    for (uint32_t i = 0; i < n; i++) {
        if (probs[i] > standard)
            large[n_large++] = i;
        else
            small[n_small++] = i;
    }
    while (n_large > 0 && n_small > 0) {
        const uint32_t s = small[--n_small], l = large[--n_large];
        probs[l] -= standard - probs[s];
        probs[s] *= (float)n;
        alias[s] = l;
        if (probs[l] > standard)
            large[n_large++] = l;
        else
            small[n_small++] = l;
    }
    while (n_small > 0) probs[small[--n_small]] = 1;
    while (n_large > 0) probs[large[--n_large]] = 1;
}

enum { BINS = 64 };

static const double contrast = 1e6;

/* The largest relative error of the implied probabilities in equal steps of log w, from 1 to the contrast and more. */
static double worst_by_bin(double worst[BINS], const bis_alias *a, const double *w, double sum)
{
    double *pmf = bis_alloc(a->n, sizeof *pmf), most = 0;

    if (!pmf) still_check(BIS_NOMEM);
    bis_alias_implied_pmf(a, pmf);
    for (int k = 0; k < BINS; k++) worst[k] = 1e-17;
    for (size_t i = 0; i < a->n; i++) {
        double *at = &worst[(int)fmin(BINS - 1, BINS * log(w[i]) / log(contrast))];
        *at = fmax(*at, fabs(pmf[i] / (w[i] / sum) - 1));
        most = fmax(most, *at);
    }
    bis_free(pmf);
    return most;
}

void errata_E15(bis_json *j)
{
    enum { N = 65536 };
    double *w = bis_alloc(N, sizeof *w), *prob = bis_alloc(N, sizeof *prob), sum = 0;
    double at[BINS], ours[BINS], printed[BINS];
    uint32_t *alias = bis_alloc(3 * N, sizeof *alias);
    float *single = bis_alloc(N, sizeof *single);
    bis_alias right;
    bis_rng r;

    if (!w || !prob || !alias || !single) still_check(BIS_NOMEM);
    bis_rng_init(&r, ERRATA_SEED, 0, 0, 0);
    for (int i = 0; i < N; i++) sum += w[i] = i == N / 2 ? 0 : pow(contrast, bis_rng_double(&r));
    w[N / 2] = sum; /* a sun, half of all light: it gives to all others, and its rounding errors add up */
    sum += sum;
    still_check(bis_alias_init(&right, w, N, NULL));
    for (int i = 0; i < N; i++) single[i] = (float)(w[i] / sum);
    appendix_A(single, alias, alias + N, alias + 2 * N, N);
    for (int i = 0; i < N; i++) prob[i] = (double)single[i];
    const bis_alias wrong = {N, 1, prob, alias};
    const double ours_most = worst_by_bin(ours, &right, w, sum), printed_most = worst_by_bin(printed, &wrong, w, sum);
    for (int k = 0; k < BINS; k++) at[k] = N * pow(contrast, (k + 0.5) / BINS) / sum;
    still_list(j, "NP", at, BINS);
    still_list(j, "printed", printed, BINS);
    still_list(j, "right", ours, BINS);
    BIS_JSON_NUMBERS(j, {"most_printed", printed_most}, {"most_right", ours_most});
    bis_alias_clear(&right);
    bis_free(w);
    bis_free(prob);
    bis_free(alias);
    bis_free(single);
}
