/* SPDX-License-Identifier: BSD-2-Clause */
/* errata_estimators: pictures of the errata of errors and estimators (thesis 3.2.1, chapter 4, 5): E9, E24, E25, E26,
 * E28, E30, E31, E32. Random numbers are independent and candidates not stratified, as in the thesis's formulas. */
#include "errata_plots.h"

#include "bis/scene/parameters.h"
#include "bis/thesis/phong.h"

#include "drawing.h"
#include "thesis/candidates.h"
#include "thesis/set.h"

static rgb grey(double v) { return rgb_from(v, v, v); }

static const vec3 up = {0, 0, 1};

static bis_settings settings(const bis_integrator *integrator, uint32_t M, uint32_t N, bis_proposal proposal)
{
    bis_settings s = bis_settings_default(integrator);

    s.samples = s.shadowrays = N;
    s.candidates = M;
    s.proposal = proposal;
    s.resampling = BIS_RESAMPLING_MULTINOMIAL;
    s.estimator = BIS_ESTIMATOR_PLAIN;
    s.stratify = false;
    return s;
}

static rgb smooth(int x, int y, int width, int height)
{
    const double phi = 2 * PI * (x + 0.5) / width;

    return grey(1.2 + cos(phi) + 0.8 * sin(2 * phi) * y / height);
}

static rgb sun_and_sky(int x, int y, int width, int height)
{
    if (x == width / 5 && y == height / 5) return grey(20000);
    return smooth(x, y, width, height);
}

static rgb uniform(int x, int y, int width, int height)
{
    (void)x, (void)y, (void)width, (void)height;
    return grey(1);
}

/* ---- E9: error against N ---- */

void errata_E9(FILE *svg)
{
    enum { N = 6 };
    bis_light *light = errata_light(64, 32, smooth, BIS_TABLE_ALIAS);
    errata_plane p = errata_plane_over(svg, 1, 1024, 1e-3, 3);
    double n[N], error[N], root[N], printed[N];
    errata_spot s;

    errata_spot_init(&s, light, bis_phong(grey(0.8), grey(0), 1), up, 40, true);
    for (int i = 0; i < N; i++) {
        const bis_settings em = settings(&bis_em, 1, 1u << 2 * i, BIS_PROPOSAL_EM);
        const errata_moments m = errata_run(&s, &em, 4000);
        n[i] = em.samples;
        error[i] = sqrt(m.variance) / m.mean;
        root[i] = error[0] / sqrt(n[i]);
        printed[i] = error[0] / (n[i] * n[i]);
    }
    p.log_x = p.log_y = true;
    errata_axes(&p, "N", "1 4 16 64 256 1024", "relative error", "1e-3 1e-2 1e-1 1");
    errata_line(&p, n, printed, N, errata_printed());
    errata_line(&p, n, root, N, errata_right());
    errata_dots(&p, n, error, N, errata_right());
    errata_say(svg, 60, 180, errata_printed(), "as printed: N^-2");
    errata_say(svg, 250, 60, errata_right(), "right: N^-1/2, dots: measured");
    bis_light_free(light);
}

/* ---- E24: which f, and where w stands ---- */

void errata_E24(FILE *svg)
{
    enum { TILTS = 17, DRAWS = 40000 };
    bis_light *light = errata_light(64, 32, smooth, BIS_TABLE_ALIAS);
    const bis_settings sir = settings(&bis_sir, 16, 4, BIS_PROPOSAL_EM);
    errata_plane p = errata_plane_over(svg, 0, 160, 0, 2);
    double degrees[TILTS], ours[TILTS], over[TILTS] = {0}, times[TILTS] = {0};

    for (int i = 0; i < TILTS; i++) {
        const double t = (degrees[i] = 10 * i) * PI / 180;
        errata_spot s;
        bis_rng r;
        errata_spot_init(&s, light, bis_phong(grey(0.8), grey(0), 1), vec3_from(sin(t), 0, cos(t)), 0, false);
        ours[i] = errata_run(&s, &sir, DRAWS / 16).mean / 3;
        bis_rng_init(&r, ERRATA_SEED, 0, 0, 0);
        for (int k = 0; k < DRAWS; k++) {
            const double u[4] = {bis_rng_double(&r), bis_rng_double(&r), bis_rng_double(&r), bis_rng_double(&r)};
            bis_light_point y;
            bis_light_sample(light, u, &y);
            const double F = 0.8 / PI * fmax(0, dot(s.pt.n, y.wi)) * (double)y.Le.r, w = F / y.pdf;
            if (w > 0) over[i] += F / (w * y.pdf) / DRAWS;
            times[i] += F * w / DRAWS;
        }
    }
    errata_axes(&p, "tilt of a patch, degrees", "0 40 80 120 160", "mean estimate of what a patch reflects", "0 0.5 1 1.5 2");
    errata_line(&p, degrees, over, TILTS, errata_printed());
    errata_line(&p, degrees, times, TILTS, errata_printed());
    errata_line(&p, degrees, ours, TILTS, errata_right());
    errata_dots(&p, degrees, ours, TILTS, errata_right());
    errata_say(svg, 60, 60, errata_right(), "right: F w/phat, resampled");
    errata_say(svg, 250, errata_y(&p, times[9]) + 28, errata_printed(), "eq. 4.9 with the f of eq. 4.8: F w");
    errata_say(svg, 150, errata_y(&p, over[9]) - 8, errata_printed(), "the line before it: F/(w q)");
    bis_light_free(light);
}

/* ---- E25: sets without weight ---- */

void errata_E25(FILE *svg)
{
    enum { N = 8, RUNS = 40000 };
    bis_light *light = errata_light(64, 32, uniform, BIS_TABLE_ALIAS);
    errata_plane p = errata_plane_over(svg, 0.5, N + 0.5, 0, 2.2);
    double M[N], ours[N], left_out[N];
    bis_scratch scratch;
    errata_spot s;

    errata_spot_init(&s, light, bis_phong(grey(1), grey(0), 1), up, 0, false);
    for (int i = 0; i < N; i++) {
        const bis_sampler sampler = {.kind = BIS_SAMPLER_RANDOM, .seed = ERRATA_SEED, .spp = 1, .xsamples = 1, .ysamples = 1};
        const bis_settings sir = settings(&bis_sir, (uint32_t)i + 1, 1, BIS_PROPOSAL_EM);
        double sum = 0;
        int n = 0;
        errata_check(bis_scratch_init(&scratch, &sir, NULL));
        for (uint64_t run = 0; run < RUNS; run++) {
            bis_stream stream;
            bis_stream_init(&stream, &sampler, run, 0);
            const double L = (double)bis_sir.Lo(&sir, &s.pt, &stream, &scratch).r;
            sum += L;
            n += L > 0;
        }
        bis_scratch_clear(&scratch);
        M[i] = i + 1;
        ours[i] = sum / RUNS;
        left_out[i] = sum / n;
    }
    errata_axes(&p, "M", "1 2 3 4 5 6 7 8", "light of a white patch under L = 1", "0 0.5 1 1.5 2");
    errata_line(&p, M, left_out, N, errata_printed());
    errata_dots(&p, M, left_out, N, errata_printed());
    errata_line(&p, M, ours, N, errata_right());
    errata_dots(&p, M, ours, N, errata_right());
    errata_say(svg, 130, 70, errata_printed(), "0/0 as printed; such sets left out of the mean: 1/(1 - 2^-M)");
    errata_say(svg, 130, 140, errata_right(), "right: they count as 0");
    bis_light_free(light);
}

/* ---- E26: which proposal ---- */

/* Relative error of the mean of M weights phat/q in the open, beta M of them from q_L, the others from q_f, q = beta q_L
 * + (1 - beta) q_f: by a sum over the map. (A measured one would miss what is not found in a few thousand runs: the sun,
 * by candidates from the BRDF.) */
static double error_of_candidates(const bis_point *pt, double beta, double M)
{
    enum { SIDE = 8 };
    const bis_envmap *em = bis_light_envmap(pt->light);
    double from_L = 0, from_f = 0, square = 0; /* means of phat/q under q_L and q_f, E[(phat/q)^2] under q */

    for (int i = 0; i < em->width * em->height; i++) {
        const double part = em->row_solid_angle[i / em->width] / (SIDE * SIDE), I = rgb_sum(em->pixels[i]) / 3;
        for (int k = 0; k < SIDE * SIDE; k++) {
            const vec3 w = bis_envmap_direction(em, i % em->width, i / em->width, (k % SIDE + 0.5) / SIDE, ((int)(k / SIDE) + 0.5) / SIDE);
            double q_f;
            const double phat = rgb_sum(bis_bsdf_f_pdf(&pt->bsdf, w, &q_f)) * fmax(0, dot(pt->n, w)) * I;
            const double q_L = bis_light_pdf(pt->light, w), q = beta * q_L + (1 - beta) * q_f;
            if (phat == 0) continue;
            from_L += phat / q * q_L * part;
            from_f += phat / q * q_f * part;
            square += phat * phat / q * part;
        }
    }
    const double mean = beta * from_L + (1 - beta) * from_f;
    return sqrt((square - beta * from_L * from_L - (1 - beta) * from_f * from_f) / M) / mean;
}

void errata_E26(FILE *svg)
{
    enum { N = 9 };
    enum { M = 256 };
    bis_light *light = errata_light(128, 64, sun_and_sky, BIS_TABLE_ALIAS);
    const bis_settings sir = settings(&bis_sir, M, 15, BIS_PROPOSAL_MIX);
    errata_plane p = errata_plane_over(svg, 1, 1e4, 1e-3, 30);
    double n[N], error[3][N], measured[N];
    errata_spot s;

    for (int i = 0; i < N; i++) {
        n[i] = pow(10, i / 2.0);
        errata_spot_init(&s, light, bis_phong(grey(0), grey(1), n[i]), normalize(vec3_from(0.2, 0.3, 0.8)), 40, false);
        const double beta = bis_candidates_divide(M, BIS_PROPOSAL_MIX, &s.pt, NULL).beta; /* draws nothing where M > 1 */
        const errata_moments m = errata_run(&s, &sir, 1500);
        for (int k = 0; k < 3; k++) error[k][i] = error_of_candidates(&s.pt, k == 0 ? 1 : k == 1 ? 0 : beta, M);
        measured[i] = sqrt(m.variance) / m.mean;
    }
    p.log_x = p.log_y = true;
    errata_axes(&p, "exponent n", "1 1e1 1e2 1e3 1e4", "relative error, 15 rays of 256 candidates, sun and sky", "1e-3 1e-2 1e-1 1 1e1");
    for (int k = 0; k < 3; k++) errata_line(&p, n, error[k], N, k == 2 ? errata_right() : errata_printed());
    errata_dots(&p, n, measured, N, errata_right());
    errata_say(svg, 60, 180, errata_right(), "right: from both; dots: measured");
    errata_say(svg, 345, 90, errata_printed(), "from the map");
    errata_say(svg, 60, 48, errata_printed(), "from the BRDF");
    bis_light_free(light);
}

/* ---- E28: candidates for one accepted ---- */

enum { SUN_X = 40, SUN_Y = 20, MAP_WIDTH = 128, MAP_HEIGHT = 64 };

static rgb one_sun(int x, int y, int width, int height)
{
    (void)width, (void)height;
    return grey(x == SUN_X && y == SUN_Y ? 1 : 0);
}

void errata_E28(FILE *svg)
{
    enum { N = 8, RUNS = 4000, M = 800 };
    bis_light *light = errata_light(MAP_WIDTH, MAP_HEIGHT, one_sun, BIS_TABLE_ALIAS);
    const bis_envmap *em = bis_light_envmap(light);
    const vec3 sun = bis_envmap_direction(em, SUN_X, SUN_Y, 0.5, 0.5);
    const frame about_sun = frame_about(sun);
    const double solid_angle = em->row_solid_angle[SUN_Y];
    const bis_settings s = settings(&bis_rejection, M, 15, BIS_PROPOSAL_BRDF);
    errata_plane p = errata_plane_over(svg, 0, 90, 100, 1e5);
    double degrees[N], measured[N], derived[N], printed[N];

    for (int i = 0; i < N; i++) {
        const double a = (degrees[i] = 5 + 11.5 * i) * PI / 180;
        errata_spot spot;
        errata_spot_init(&spot, light, bis_phong(grey(1), grey(0), 1), normalize(to_world(&about_sun, vec3_from(sin(a), 0, cos(a)))), 30, false);
        errata_run(&spot, &s, RUNS);
        measured[i] = (double)RUNS * M / (double)spot.counters.accepted;
        derived[i] = PI / (cos(a) * solid_angle);
        printed[i] = 1 / solid_angle;
    }
    p.log_y = true;
    errata_axes(&p, "angle between the normal and the sun, degrees", "0 30 60 90", "candidates for one accepted; one lit pixel", "1e2 1e3 1e4 1e5");
    errata_line(&p, degrees, printed, N, errata_printed());
    errata_line(&p, degrees, derived, N, errata_right());
    errata_dots(&p, degrees, measured, N, errata_right());
    errata_say(svg, 80, 157, errata_printed(), "as printed: 1/dOmega = %.0f", printed[0]);
    errata_say(svg, 80, 90, errata_right(), "right: pi/(cos dOmega); dots: measured");
    bis_light_free(light);
}

/* ---- E30: how many are accepted ---- */

void errata_E30(FILE *svg)
{
    enum { N = 9, RUNS = 3000 };
    bis_light *light = errata_light(64, 32, smooth, BIS_TABLE_ALIAS);
    const bis_settings s = settings(&bis_rejection, 800, 15, BIS_PROPOSAL_EM);
    errata_plane p = errata_plane_over(svg, 1, 1e4, 0.01, 1000);
    double n[N], accepted[N], printed[N];

    for (int i = 0; i < N; i++) {
        errata_spot spot;
        n[i] = pow(10, i / 2.0);
        errata_spot_init(&spot, light, bis_phong(grey(0), grey(1), n[i]), up, 40, false);
        errata_run(&spot, &s, RUNS);
        accepted[i] = (double)spot.counters.accepted / RUNS;
        printed[i] = 15;
    }
    p.log_x = p.log_y = true;
    errata_axes(&p, "exponent n", "1 1e1 1e2 1e3 1e4", "accepted of 800 candidates from the map", "1e-2 1 1e2");
    errata_line(&p, n, printed, N, errata_printed());
    errata_line(&p, n, accepted, N, errata_right());
    errata_dots(&p, n, accepted, N, errata_right());
    errata_say(svg, 310, errata_y(&p, 15) - 6, errata_printed(), "as printed: 15 of 800");
    errata_say(svg, 60, 170, errata_right(), "measured: %.0f to %.2g", accepted[0], accepted[N - 1]);
    bis_light_free(light);
}

/* ---- E31: the second term ---- */

void errata_E31(FILE *svg)
{
    enum { K = 9, M = 64, RUNS = 20000 };
    bis_light *light = errata_light(64, 32, smooth, BIS_TABLE_ALIAS);
    const bis_material m = bis_phong(grey(0.8), grey(0), 1);
    const bis_settings one = settings(&bis_sir, 1, 1, BIS_PROPOSAL_EM);
    errata_plane p = errata_plane_over(svg, 1, 256, 1e-3, 3);
    double N[K], measured[K], both[K], printed[K];
    errata_spot open, s;

    errata_spot_init(&open, light, m, up, 40, false);
    errata_spot_init(&s, light, m, up, 40, true);
    const double Lns = errata_run(&open, &one, 20 * RUNS).mean;
    const errata_moments single = errata_run(&s, &one, 20 * RUNS);
    const double L = single.mean, LL = L * L;
    for (int i = 0; i < K; i++) {
        const bis_settings sir = settings(&bis_sir, M, 1u << i, BIS_PROPOSAL_EM);
        const double rays = L * (Lns - L) / (N[i] = sir.shadowrays);
        measured[i] = errata_run(&s, &sir, RUNS).variance / LL;
        printed[i] = rays / LL;
        both[i] = (single.variance / M + (1 - 1.0 / M) * rays) / LL;
    }
    p.log_x = p.log_y = true;
    errata_axes(&p, "N rays of M = 64 candidates", "1 4 16 64 256", "variance / L^2", "1e-3 1e-2 1e-1 1");
    errata_line(&p, N, printed, K, errata_printed());
    errata_line(&p, N, both, K, errata_right());
    errata_dots(&p, N, measured, K, errata_right());
    errata_say(svg, 60, 180, errata_printed(), "as printed: that of the rays, L`ns^2  var(V)/N");
    errata_say(svg, 160, 60, errata_right(), "right: plus that of the candidates; dots: measured");
    errata_say(svg, 160, 76, errata_right(), "at N = 256 it is %.0f times as printed", measured[K - 1] / printed[K - 1]);
    bis_light_free(light);
}

/* ---- E32: error bars ---- */

enum { RAYS = 16, SET = 8 };

static const double t_15 = 2.1314; /* Student's t of 15 degrees of freedom: 95 % */

/* The mean of 16 numbers and the half width of their 95 % interval. */
static void interval(double *mean, double *half, const double *x)
{
    double square = 0;

    *mean = 0;
    for (int j = 0; j < RAYS; j++) *mean += x[j] / RAYS;
    for (int j = 0; j < RAYS; j++) square += (x[j] - *mean) * (x[j] - *mean);
    *half = t_15 * sqrt(square / (RAYS * (RAYS - 1)));
}

/* 16 rays of one set of candidates. */
static void rays_of_one_set(double *x, const errata_spot *s, uint64_t run)
{
    const bis_sampler sampler = {.kind = BIS_SAMPLER_RANDOM, .seed = ERRATA_SEED, .spp = 1, .xsamples = 1, .ysamples = 1};
    const bis_settings sir = settings(&bis_sir, SET, RAYS, BIS_PROPOSAL_MIX);
    bis_scratch scratch;
    bis_stream stream;
    int n = 0;

    errata_check(bis_scratch_init(&scratch, &sir, NULL));
    bis_set *set = scratch.set;
    bis_stream_init(&stream, &sampler, run, 0);
    bis_set_draw(set, SET, BIS_PROPOSAL_MIX, false, &s->pt, &stream);
    const double Zhat = bis_set_weigh(set, &s->pt);
    bis_set_choose(set, RAYS, BIS_RESAMPLING_MULTINOMIAL, &stream);
    for (uint32_t j = 0; j < set->choice.n_chosen; j++) {
        const double y = Zhat * bis_point_sees(&s->pt, (vec3){set->y.x[j], set->y.y[j], set->y.z[j]});
        for (uint32_t k = 0; k < set->choice.times[j]; k++) x[n++] = y;
    }
    bis_scratch_clear(&scratch);
}

/* 16 sets, a ray each. */
static void replicates(double *x, errata_spot *s, uint64_t run)
{
    const bis_sampler sampler = {.kind = BIS_SAMPLER_RANDOM, .seed = ERRATA_SEED, .spp = RAYS, .xsamples = 4, .ysamples = 4};
    const bis_settings sir = settings(&bis_sir, SET, 1, BIS_PROPOSAL_MIX);
    bis_scratch scratch;

    errata_check(bis_scratch_init(&scratch, &sir, NULL));
    for (uint32_t j = 0; j < RAYS; j++) {
        bis_stream stream;
        bis_stream_init(&stream, &sampler, run, j);
        x[j] = rgb_sum(bis_sir.Lo(&sir, &s->pt, &stream, &scratch));
    }
    bis_scratch_clear(&scratch);
}

static void intervals(FILE *svg, int left, errata_spot *s, double truth, bool shared)
{
    enum { SHOWN = 36, SETS = 4000 };
    const rgb hit = shared ? errata_printed() : errata_right(), miss = errata_ink();
    const errata_plane p = {svg, left, 42, 216, 160, -1, SHOWN, 0, 2 * truth, false, false};
    int held = 0;

    for (int k = 0; k < SETS; k++) {
        double x[RAYS], mean, half;
        if (shared)
            rays_of_one_set(x, s, (uint64_t)k);
        else
            replicates(x, s, (uint64_t)k);
        interval(&mean, &half, x);
        const bool holds = fabs(mean - truth) <= half;
        held += holds;
        if (k >= SHOWN) continue;
        drawing_line(svg, errata_x(&p, k), errata_y(&p, fmax(0, mean - half)), errata_x(&p, k), errata_y(&p, fmin(2 * truth, mean + half)), 2,
                        holds ? hit : miss);
        errata_dots(&p, &(double){k}, &mean, 1, holds ? hit : miss);
    }
    drawing_line(svg, p.x, errata_y(&p, truth), p.x + p.w, errata_y(&p, truth), 1, errata_ink());
    errata_say_middle(svg, left + p.w / 2, 222, hit, "%.1f %% of %d hold the truth", 100.0 * held / SETS, SETS);
}

void errata_E32(FILE *svg)
{
    bis_light *light = errata_light(64, 32, smooth, BIS_TABLE_ALIAS);
    const bis_settings sir = settings(&bis_sir, SET, 4, BIS_PROPOSAL_MIX);
    errata_spot s;

    errata_spot_init(&s, light, bis_phong(grey(0.6), grey(0.3), 5), up, 40, true);
    const double truth = errata_run(&s, &sir, 400000).mean;
    errata_heads(svg, "95 % from 16 rays of one set", "95 % from 16 sets of one ray");
    intervals(svg, 12, &s, truth, true);
    intervals(svg, 252, &s, truth, false);
    bis_light_free(light);
}
