/* SPDX-License-Identifier: BSD-2-Clause */
/* errata_tables: pictures of the errata of discrete sampling (thesis 3.2.2, 3.3, appendix A): E8, E10, E11, E12, E14,
 * E15. */
#include "errata_plots.h"

#include "bis/flat/taught.h"
#include "bis/thesis/alias.h"
#include "bis/thesis/cdf.h"
#include "bis/base/mem.h"

#include "drawing.h"

#include <string.h>

/* ---- E8: P = {0.1, 0.2, 0.4, 0.3} from the CDF ---- */

static void bars(FILE *svg, double x, const double *drawn, const double *wanted, int first, int n, rgb colour)
{
    const double base = 200, scale = 255;

    for (int i = 0; i < n; i++) {
        const int left = (int)x + 42 * i, height = (int)lround(scale * drawn[i]), line = (int)(base - scale * wanted[i]);
        drawing_box(svg, left, (int)base - height, 32, height, colour);
        drawing_line(svg, left - 3, line, left + 35, line, 2, errata_ink());
        errata_say_middle(svg, left + 16, base + 15, errata_faint(), "%d", first + i);
        errata_say_middle(svg, left + 16, fmin(line, base - height) - 6, errata_ink(), "%.3f", drawn[i]);
    }
    drawing_line(svg, x - 6, base, x + 42 * n, base, 1.2, errata_ink());
}

void errata_E8(FILE *svg)
{
    enum { DRAWS = 100000 };
    static const double P[4] = {0.1, 0.2, 0.4, 0.3}, wanted_printed[5] = {0, 0.1, 0.2, 0.4, 0.3};
    double C[6] = {0}, ours[4] = {0}, printed[5] = {0};
    bis_cdf cdf;
    bis_rng r;

    errata_check(bis_cdf_init(&cdf, P, 4, NULL));
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
    errata_heads(svg, "items 1 to 4, and a 0 that is none", "items 0 to 3");
    bars(svg, 18, printed, wanted_printed, 0, 5, errata_printed());
    bars(svg, 276, ours, P, 0, 4, errata_right());
    errata_say_middle(svg, ERRATA_WIDTH / 2.0, 232, errata_faint(), "bars: share of 100,000 draws; lines: P");
}

/* ---- E10: the inverse of C, tabulated ---- */

void errata_E10(FILE *svg)
{
    enum { N = 64 };
    double w[N], rank[N], ours[N], printed[N] = {0};
    errata_plane p = errata_plane_over(svg, 0, N, 1e-6, 1);
    int lost = 0;
    bis_cdf cdf;

    for (int i = 0; i < N; i++) w[i] = exp(12.0 * i / N); /* contrast 1e5 */
    errata_check(bis_cdf_init(&cdf, w, N, NULL));
    for (int k = 0; k < N; k++) printed[bis_cdf_sample(&cdf, (k + 0.5) / N, NULL)] += 1.0 / N; /* entry k of the table of inverses */
    for (int i = 0; i < N; i++) {
        rank[i] = i + 0.5;
        ours[i] = bis_cdf_pmf(&cdf, (size_t)i);
        lost += printed[i] == 0;
    }
    bis_cdf_clear(&cdf);
    p.log_y = true;
    errata_axes(&p, "item, in the order of weight", "0 16 32 48 64", "P", "1e-6 1e-4 1e-2 1");
    errata_line(&p, rank, ours, N, errata_right());
    errata_dots(&p, rank, printed, N, errata_printed());
    for (int i = 0; i < N; i++)
        if (printed[i] == 0) drawing_disc(svg, errata_x(&p, rank[i]), errata_y(&p, p.y0), 3, errata_printed());
    errata_say(svg, 60, 48, errata_printed(), "as printed: multiples of 1/64,");
    errata_say(svg, 60, 62, errata_printed(), "%d of 64 items are never drawn", lost);
    errata_say(svg, 60, 80, errata_right(), "right: it only tells where to start");
}

/* ---- E11: prob of those who give ---- */

void errata_E11(FILE *svg)
{
    enum { N = 3 };
    static const double P[N] = {0.1, 0.45, 0.45};
    double ours[N], printed[N];
    bis_alias a;

    errata_check(bis_alias_init(&a, P, N, NULL));
    bis_alias_implied_pmf(&a, ours);
    for (int i = 0; i < N; i++)
        if (P[i] > 1.0 / N) a.prob[i] = 1;
    bis_alias_implied_pmf(&a, printed);
    bis_alias_clear(&a);
    errata_heads(svg, "prob = 1 for all above 1/N", "a giver may fall below 1/N");
    bars(svg, 60, printed, P, 0, N, errata_printed());
    bars(svg, 300, ours, P, 0, N, errata_right());
    errata_say_middle(svg, ERRATA_WIDTH / 2.0, 232, errata_faint(), "bars: probability that the tables imply; lines: P");
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
    const bis_sampler sampler = {.kind = BIS_SAMPLER_SOBOL, .seed = ERRATA_SEED, .spp = 1, .xsamples = 1, .ysamples = 1};
    double (*pair)[2] = bis_alloc(n, sizeof *pair);
    bis_stream stream;

    if (!pair) errata_check(BIS_NOMEM);
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

    if (!u) errata_check(BIS_NOMEM);
    for (uint64_t run = 1; run <= RUNS; run++) {
        sobol(u, n, run);
        const double E = irradiance(light, u, n);
        mean += E / RUNS;
        square += E * E / RUNS;
    }
    bis_free(u);
    return sqrt(square - mean * mean) / mean;
}

static void map_with_points(FILE *svg, int left, const bis_light *light, uint32_t n, rgb colour)
{
    enum { WIDTH = 220, HEIGHT = 110, TOP = 50 };
    bis_image field = errata_field(WIDTH, HEIGHT);
    double u[1024][4];

    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        field.pixels[i] = errata_grey(0.55 + 0.14 * (double)glow(i % WIDTH, i / WIDTH, WIDTH, HEIGHT).r);
    }
    errata_show(svg, left, TOP, &field);
    sobol(u, n, 0);
    for (uint32_t i = 0; i < n; i++) {
        bis_light_point y;
        bis_light_sample(light, u[i], &y);
        const double phi = atan2((double)y.wi.y, (double)y.wi.x), theta = acos((double)y.wi.z);
        drawing_disc(svg, left + WIDTH * (phi < 0 ? phi + 2 * PI : phi) / (2 * PI), TOP + HEIGHT * theta / PI, 1.5, colour);
    }
    errata_say_middle(svg, left + WIDTH / 2.0, TOP + HEIGHT + 20, colour, "error with 512 points: %.2f %%", 100 * relative_error(light, 512));
    errata_say_middle(svg, left + WIDTH / 2.0, TOP + HEIGHT + 36, colour, "with 4096: %.3f %%", 100 * relative_error(light, 4096));
}

void errata_E12(FILE *svg)
{
    bis_light *alias = errata_light(64, 32, glow, BIS_TABLE_ALIAS), *cdf = errata_light(64, 32, glow, BIS_TABLE_CDF);

    errata_heads(svg, "512 Sobol' points, alias tables", "512 Sobol' points, CDFs");
    map_with_points(svg, 10, alias, 512, errata_printed());
    map_with_points(svg, 250, cdf, 512, errata_right());
    bis_light_free(alias);
    bis_light_free(cdf);
}

/* ---- E14: few bits ---- */

void errata_E14(FILE *svg)
{
    enum { LOG_N = 12, LEFT = 12 };
    double w[1 << LOG_N], share[2][1 << LOG_N], impossible[2], left[LEFT], printed[LEFT], ours[LEFT];
    errata_plane p = errata_plane_over(svg, 0, LEFT, 1e-5, 1);

    for (int i = 0; i < 1 << LOG_N; i++) w[i] = i % 2;
    p.log_y = true;
    errata_axes(&p, "bits of u that are left for the coin", "0 4 8 12", "impossible items, share of the draws that fall into their bins", "1e-4 1e-2 1");
    for (int k = 0; k < LEFT; k++) {
        left[k] = k + 1;
        errata_check((bis_status)bis_flat_alias_few_bits(1 << LOG_N, w, LOG_N + k + 1, share[0], share[1], impossible, NULL, 0));
        printed[k] = impossible[0];
        ours[k] = impossible[1];
        if (ours[k] == 0) drawing_disc(svg, errata_x(&p, left[k]), errata_y(&p, p.y0), 3, errata_right());
    }
    errata_line(&p, left, printed, LEFT, errata_printed());
    errata_dots(&p, left, printed, LEFT, errata_printed());
    errata_dots(&p, left, ours, LEFT, errata_right());
    errata_say(svg, 210, 70, errata_printed(), "as printed: u - i > prob");
    errata_say(svg, 110, 192, errata_right(), "right: frac < prob, none");
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

    if (!pmf) errata_check(BIS_NOMEM);
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

void errata_E15(FILE *svg)
{
    enum { N = 65536 };
    double *w = bis_alloc(N, sizeof *w), *prob = bis_alloc(N, sizeof *prob), sum = 0;
    double at[BINS], ours[BINS], printed[BINS];
    uint32_t *alias = bis_alloc(3 * N, sizeof *alias);
    float *single = bis_alloc(N, sizeof *single);
    errata_plane p = errata_plane_over(svg, 1e-6, 100, 1e-16, 1e4);
    bis_alias right;
    bis_rng r;

    if (!w || !prob || !alias || !single) errata_check(BIS_NOMEM);
    bis_rng_init(&r, ERRATA_SEED, 0, 0, 0);
    for (int i = 0; i < N; i++) sum += w[i] = i == N / 2 ? 0 : pow(contrast, bis_rng_double(&r));
    w[N / 2] = sum; /* a sun, half of all light: it gives to all others, and its rounding errors add up */
    sum += sum;
    errata_check(bis_alias_init(&right, w, N, NULL));
    for (int i = 0; i < N; i++) single[i] = (float)(w[i] / sum);
    appendix_A(single, alias, alias + N, alias + 2 * N, N);
    for (int i = 0; i < N; i++) prob[i] = (double)single[i];
    const bis_alias wrong = {N, 1, prob, alias};
    const double ours_most = worst_by_bin(ours, &right, w, sum), printed_most = worst_by_bin(printed, &wrong, w, sum);
    for (int k = 0; k < BINS; k++) at[k] = N * pow(contrast, (k + 0.5) / BINS) / sum;
    p.log_x = p.log_y = true;
    errata_axes(&p, "N P, from the dimmest to the brightest of 65,536 items", "1e-6 1e-4 1e-2 1 1e2",
                "worst relative error of P", "1e-16 1e-12 1e-8 1e-4 1 1e4");
    errata_line(&p, at, printed, BINS, errata_printed());
    errata_line(&p, at, ours, BINS, errata_right());
    errata_say(svg, 180, 18, errata_printed(), "as printed, in float: one item %.0f times too often", printed_most);
    errata_say(svg, 110, 150, errata_right(), "right, in double: up to %.1g", ours_most);
    bis_alias_clear(&right);
    bis_free(w);
    bis_free(prob);
    bis_free(alias);
    bis_free(single);
}
