/* SPDX-License-Identifier: BSD-2-Clause */
/* errata_estimators: the numbers behind the errata of errors and estimators (thesis 3.2.1, chapter 4, 5): E9, E24, E25,
 * E26, E28, E30, E31, E32. Random numbers are independent and candidates not stratified, as in the thesis's formulas.
 */
#include "still.h"

#include "bis/scene/parameters.h"
#include "bis/thesis/phong.h"

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

void errata_E9(bis_json *j)
{
    enum { N = 6 };
    bis_light *light = errata_light(64, 32, smooth, BIS_TABLE_ALIAS);
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
    still_list(j, "N", n, N);
    still_list(j, "measured", error, N);
    still_list(j, "printed", printed, N);
    still_list(j, "right", root, N);
    bis_light_free(light);
}

/* ---- E24: which f, and where w stands ---- */

void errata_E24(bis_json *j)
{
    enum { TILTS = 17, DRAWS = 40000 };
    bis_light *light = errata_light(64, 32, smooth, BIS_TABLE_ALIAS);
    const bis_settings sir = settings(&bis_sir, 16, 4, BIS_PROPOSAL_EM);
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
    still_list(j, "tilt_deg", degrees, TILTS);
    still_list(j, "right", ours, TILTS);
    still_list(j, "printed_times", times, TILTS);
    still_list(j, "printed_over", over, TILTS);
    bis_light_free(light);
}

/* ---- E25: sets without weight ---- */

void errata_E25(bis_json *j)
{
    enum { N = 8, RUNS = 40000 };
    bis_light *light = errata_light(64, 32, uniform, BIS_TABLE_ALIAS);
    double M[N], ours[N], left_out[N];
    bis_scratch scratch;
    errata_spot s;

    errata_spot_init(&s, light, bis_phong(grey(1), grey(0), 1), up, 0, false);
    for (int i = 0; i < N; i++) {
        const bis_sampler sampler = {
            .kind = BIS_SAMPLER_RANDOM, .seed = ERRATA_SEED, .spp = 1, .xsamples = 1, .ysamples = 1};
        const bis_settings sir = settings(&bis_sir, (uint32_t)i + 1, 1, BIS_PROPOSAL_EM);
        double sum = 0;
        int n = 0;
        still_check(bis_scratch_init(&scratch, &sir, NULL));
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
    still_list(j, "M", M, N);
    still_list(j, "printed", left_out, N);
    still_list(j, "right", ours, N);
    bis_light_free(light);
}

/* ---- E26: which proposal ---- */

/* Relative error of the mean of M weights phat/q in the open, beta M of them from q_L, the others from q_f, q = beta
 * q_L
 * + (1 - beta) q_f: by a sum over the map. (A measured one would miss what is not found in a few thousand runs: the
 * sun, by candidates from the BRDF.) */
static double error_of_candidates(const bis_point *pt, double beta, double M)
{
    enum { SIDE = 8 };
    const bis_envmap *em = bis_light_envmap(pt->light);
    double from_L = 0, from_f = 0, square = 0; /* means of phat/q under q_L and q_f, E[(phat/q)^2] under q */

    for (int i = 0; i < em->width * em->height; i++) {
        const double part = em->row_solid_angle[i / em->width] / (SIDE * SIDE), I = rgb_sum(em->pixels[i]) / 3;
        for (int k = 0; k < SIDE * SIDE; k++) {
            const vec3 w = bis_envmap_direction(
                em, i % em->width, i / em->width, (k % SIDE + 0.5) / SIDE, ((int)(k / SIDE) + 0.5) / SIDE);
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

void errata_E26(bis_json *j)
{
    enum { N = 9 };
    enum { M = 256 };
    bis_light *light = errata_light(128, 64, sun_and_sky, BIS_TABLE_ALIAS);
    const bis_settings sir = settings(&bis_sir, M, 15, BIS_PROPOSAL_MIX);
    double n[N], error[3][N], measured[N];
    errata_spot s;

    for (int i = 0; i < N; i++) {
        n[i] = pow(10, i / 2.0);
        errata_spot_init(&s, light, bis_phong(grey(0), grey(1), n[i]), normalize(vec3_from(0.2, 0.3, 0.8)), 40, false);
        const double beta =
            bis_candidates_divide(M, BIS_PROPOSAL_MIX, &s.pt, NULL).beta; /* draws nothing where M > 1 */
        const errata_moments m = errata_run(&s, &sir, 1500);
        for (int k = 0; k < 3; k++) error[k][i] = error_of_candidates(&s.pt, k == 0 ? 1 : k == 1 ? 0 : beta, M);
        measured[i] = sqrt(m.variance) / m.mean;
    }
    still_list(j, "exponent", n, N);
    still_list(j, "from_map", error[0], N);
    still_list(j, "from_brdf", error[1], N);
    still_list(j, "right", error[2], N);
    still_list(j, "measured", measured, N);
    bis_light_free(light);
}

/* ---- E28: candidates for one accepted ---- */

enum { SUN_X = 40, SUN_Y = 20, MAP_WIDTH = 128, MAP_HEIGHT = 64 };

static rgb one_sun(int x, int y, int width, int height)
{
    (void)width, (void)height;
    return grey(x == SUN_X && y == SUN_Y ? 1 : 0);
}

void errata_E28(bis_json *j)
{
    enum { N = 8, RUNS = 4000, M = 800 };
    bis_light *light = errata_light(MAP_WIDTH, MAP_HEIGHT, one_sun, BIS_TABLE_ALIAS);
    const bis_envmap *em = bis_light_envmap(light);
    const vec3 sun = bis_envmap_direction(em, SUN_X, SUN_Y, 0.5, 0.5);
    const frame about_sun = frame_about(sun);
    const double solid_angle = em->row_solid_angle[SUN_Y];
    const bis_settings s = settings(&bis_rejection, M, 15, BIS_PROPOSAL_BRDF);
    double degrees[N], measured[N], derived[N], printed[N];

    for (int i = 0; i < N; i++) {
        const double a = (degrees[i] = 5 + 11.5 * i) * PI / 180;
        errata_spot spot;
        errata_spot_init(&spot, light, bis_phong(grey(1), grey(0), 1),
            normalize(to_world(&about_sun, vec3_from(sin(a), 0, cos(a)))), 30, false);
        errata_run(&spot, &s, RUNS);
        measured[i] = (double)RUNS * M / (double)spot.counters.accepted;
        derived[i] = PI / (cos(a) * solid_angle);
        printed[i] = 1 / solid_angle;
    }
    still_list(j, "angle_deg", degrees, N);
    still_list(j, "printed", printed, N);
    still_list(j, "right", derived, N);
    still_list(j, "measured", measured, N);
    bis_light_free(light);
}

/* ---- E30: how many are accepted ---- */

void errata_E30(bis_json *j)
{
    enum { N = 9, RUNS = 3000 };
    bis_light *light = errata_light(64, 32, smooth, BIS_TABLE_ALIAS);
    const bis_settings s = settings(&bis_rejection, 800, 15, BIS_PROPOSAL_EM);
    double n[N], accepted[N], printed[N];

    for (int i = 0; i < N; i++) {
        errata_spot spot;
        n[i] = pow(10, i / 2.0);
        errata_spot_init(&spot, light, bis_phong(grey(0), grey(1), n[i]), up, 40, false);
        errata_run(&spot, &s, RUNS);
        accepted[i] = (double)spot.counters.accepted / RUNS;
        printed[i] = 15;
    }
    still_list(j, "exponent", n, N);
    still_list(j, "printed", printed, N);
    still_list(j, "right", accepted, N);
    bis_light_free(light);
}

/* ---- E31: the second term ---- */

void errata_E31(bis_json *j)
{
    enum { K = 9, M = 64, RUNS = 20000 };
    bis_light *light = errata_light(64, 32, smooth, BIS_TABLE_ALIAS);
    const bis_material m = bis_phong(grey(0.8), grey(0), 1);
    const bis_settings one = settings(&bis_sir, 1, 1, BIS_PROPOSAL_EM);
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
    still_list(j, "N", N, K);
    still_list(j, "printed", printed, K);
    still_list(j, "right", both, K);
    still_list(j, "measured", measured, K);
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
    const bis_sampler sampler = {
        .kind = BIS_SAMPLER_RANDOM, .seed = ERRATA_SEED, .spp = 1, .xsamples = 1, .ysamples = 1};
    const bis_settings sir = settings(&bis_sir, SET, RAYS, BIS_PROPOSAL_MIX);
    bis_scratch scratch;
    bis_stream stream;
    int n = 0;

    still_check(bis_scratch_init(&scratch, &sir, NULL));
    bis_set *set = scratch.set;
    bis_stream_init(&stream, &sampler, run, 0);
    bis_set_draw(set, SET, BIS_PROPOSAL_MIX, false, &s->pt, &stream);
    const double Zhat = bis_set_weigh(set, &s->pt);
    bis_set_choose(set, RAYS, BIS_RESAMPLING_MULTINOMIAL, &stream);
    for (uint32_t j = 0; j < set->choice.n_chosen; j++) {
        const double y = Zhat * bis_point_sees(&s->pt, set->y.wi[j]);
        for (uint32_t k = 0; k < set->choice.times[j]; k++) x[n++] = y;
    }
    bis_scratch_clear(&scratch);
}

/* 16 sets, a ray each. */
static void replicates(double *x, errata_spot *s, uint64_t run)
{
    const bis_sampler sampler = {
        .kind = BIS_SAMPLER_RANDOM, .seed = ERRATA_SEED, .spp = RAYS, .xsamples = 4, .ysamples = 4};
    const bis_settings sir = settings(&bis_sir, SET, 1, BIS_PROPOSAL_MIX);
    bis_scratch scratch;

    still_check(bis_scratch_init(&scratch, &sir, NULL));
    for (uint32_t j = 0; j < RAYS; j++) {
        bis_stream stream;
        bis_stream_init(&stream, &sampler, run, j);
        x[j] = rgb_sum(bis_sir.Lo(&sir, &s->pt, &stream, &scratch));
    }
    bis_scratch_clear(&scratch);
}

static void intervals(bis_json *j, const char *key, errata_spot *s, double truth, bool shared)
{
    enum { SHOWN = 36, SETS = 4000 };
    double mean[SHOWN], half[SHOWN];
    int held = 0;

    for (int k = 0; k < SETS; k++) {
        double x[RAYS], m, h;
        if (shared)
            rays_of_one_set(x, s, (uint64_t)k);
        else
            replicates(x, s, (uint64_t)k);
        interval(&m, &h, x);
        held += fabs(m - truth) <= h;
        if (k < SHOWN) mean[k] = m, half[k] = h;
    }
    bis_json_open(j, key, '{');
    still_list(j, "mean", mean, SHOWN);
    still_list(j, "half", half, SHOWN);
    BIS_JSON_NUMBERS(j, {"intervals", SETS}, {"held", (double)held / SETS});
    bis_json_close(j);
}

void errata_E32(bis_json *j)
{
    bis_light *light = errata_light(64, 32, smooth, BIS_TABLE_ALIAS);
    const bis_settings sir = settings(&bis_sir, SET, 4, BIS_PROPOSAL_MIX);
    errata_spot s;

    errata_spot_init(&s, light, bis_phong(grey(0.6), grey(0.3), 5), up, 40, true);
    const double truth = errata_run(&s, &sir, 400000).mean;
    bis_json_number(j, "truth", truth);
    intervals(j, "printed", &s, truth, true);
    intervals(j, "right", &s, truth, false);
    bis_light_free(light);
}
