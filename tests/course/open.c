/* SPDX-License-Identifier: BSD-2-Clause */
/* Assignment open: a density of one's own for src/beyond/microfacet.c. Any density may come: it must be a density,
 * be the one that is drawn, leave f alone; then it is judged by its noise, against the cosine's and against ours.
 * Statistical tests: 19. */
#include "mark.h"

#include "bis/beyond/microfacet.h"

static const double roughnesses[] = {0.3, 0.6, 1};

static bis_material metal(double roughness)
{
    return bis_microfacet((rgb){0, 0, 0}, (rgb){0.9f, 0.8f, 0.7f}, roughness);
}
static bis_material plastic(double roughness)
{
    return bis_microfacet((rgb){0.5f, 0.4f, 0.3f}, (rgb){0.1f, 0.1f, 0.1f}, roughness);
}

/* In the frame of the normal, which is z. What brute force needs stays with us, the surface goes to the student. */
static ask_surface seen(lit *l, bis_light *light, bis_material m, double degrees)
{
    lit_init(l, light, m, (vec3){0, 0, 1}, degrees, LIT_OPEN);
    m.model = NULL; /* an address of this process */
    return (ask_surface){m, l->pt.n, l->pt.wo};
}

/* Midpoint k of n x n in cos theta and phi, over the sphere or the upper half; the weight is its solid angle. */
static vec3 midpoint(int k, int n, double lowest, double wi[3], double *solid_angle)
{
    const double z = 1 - (1 - lowest) * ((int)(k / n) + 0.5) / n, s = sqrt(1 - z * z), phi = 2 * PI * (k % n + 0.5) / n;

    wi[0] = s * cos(phi);
    wi[1] = s * sin(phi);
    wi[2] = z;
    *solid_angle = (1 - lowest) * 2 * PI / n / n;
    return vec3_from(wi[0], wi[1], wi[2]);
}

/* All n x n midpoints, and the student's densities there. */
typedef struct midpoints {
    vec3 *w;
    double *pdf;
} midpoints;

static midpoints density_at_midpoints(const ask_surface *s, int n, double lowest)
{
    const size_t all = (size_t)n * (size_t)n;
    midpoints m = {mark_alloc(all, sizeof *m.w), mark_alloc(all, sizeof *m.pdf)};

    for (int i = 0; i < n * n; i++) {
        double wi[3], d;
        m.w[i] = midpoint(i, n, lowest, wi, &d);
    }
    ASK(ASK_F, GIVE(s, 1), GIVE(m.w, all), TAKE(m.w, 0), TAKE(m.pdf, 0), TAKE(m.pdf, all));
    return m;
}

static void check_f(void)
{
    enum { N = 900 };
    bis_light *light = lit_new_light(LIT_CONSTANT, 1, 0, false);
    rgb mine[N];
    double pdf[N];
    vec3 w[N];

    for (int k = 0; k < 6; k++) {
        lit l;
        const ask_surface s = seen(&l, light, k % 2 ? metal(roughnesses[k / 2]) : plastic(roughnesses[k / 2]), 15 * k);
        double wi[3], d;
        for (int i = 0; i < N; i++) w[i] = midpoint(i, 30, 0, wi, &d);
        ASK(ASK_F, GIVE(&s, 1), GIVE(w, N), TAKE(mine, N), TAKE(pdf, N), TAKE(pdf, 0));
        for (int i = 0; i < N; i++) {
            double q;
            midpoint(i, 30, 0, wi, &d);
            const rgbd f = lit_f(&l, wi, &q);
            const double got[] = {(double)mine[i].r, (double)mine[i].g, (double)mine[i].b}, must[] = {f.r, f.g, f.b};
            for (int c = 0; c < 3; c++) {
                mark_near(got[c], must[c], 1e-6, 1e-4, "roughness %g, wo at %d, wi at %.0f degrees: channel %d of f",
                          roughnesses[k / 2], 15 * k,
                          acos(wi[2]) * 180 / PI, c);
            }
        }
    }
}

static void f_is_left_as_it_was_and_the_density_integrates_to_1(void)
{
    enum { N = 700 };
    bis_light *light = lit_new_light(LIT_CONSTANT, 1, 0, false);

    check_f();
    for (int k = 0; k < 6; k++) {
        const double degrees = k % 2 ? 65 : 10;
        lit l;
        const ask_surface s = seen(&l, light, k % 3 ? metal(roughnesses[k / 2]) : plastic(roughnesses[k / 2]), degrees);
        midpoints m = density_at_midpoints(&s, N, -1);
        double sum = 0;
        for (int i = 0; i < N * N; i++) {
            if (!(m.pdf[i] >= 0)) mark_wrong("the density is %g", m.pdf[i]);
            sum += m.pdf[i] * 4 * PI / N / N;
        }
        mark_near(sum, 1, 0.01, 0, "roughness %g, seen at %g degrees: the integral of the density over the sphere",
                  roughnesses[k / 2], degrees);
    }
}

/* n draws, by u[n][3], or as proposals do, by u[n][2]. */
static void draw(const ask_surface *s, bool proposed, const double *u, size_t n, vec3 *w)
{
    uint8_t *drawn = mark_alloc(n, sizeof *drawn);

    ASK(proposed ? ASK_DRAW : ASK_SAMPLE, GIVE(s, 1), GIVE(u, (proposed ? 2 : 3) * n), TAKE(w, n), TAKE(drawn, n));
    for (size_t i = 0; i < n; i++) {
        if (!drawn[i]) mark_wrong("nothing is drawn from a material that reflects");
        if (!(fabs(length(w[i]) - 1) < 1e-4)) mark_wrong("the length of a direction is %g", length(w[i]));
    }
}

/* Draws by three numbers, or as proposals do, by two: there what u0 leaves within its lobe's share of [0, 1) is the
 * place in the lobe. */
static void check_samples(bool proposed, const char *what, const char *hint)
{
    enum { RINGS = 10, SECTORS = 8, CELLS = RINGS * SECTORS, FINE = 60, EACH = FINE * FINE, DRAWS = 60000 };
    bis_light *light = lit_new_light(LIT_CONSTANT, 1, 0, false);
    vec3 *w = mark_alloc(DRAWS, sizeof *w), *at = mark_alloc(CELLS * EACH, sizeof *at);
    double *pdf = mark_alloc(CELLS * EACH, sizeof *pdf);

    for (int i = 0; i < CELLS * EACH; i++) {
        const int c = i / EACH, j = i % EACH;
        const double z = 1 - 2 * (c / SECTORS + (j / FINE + 0.5) / FINE) / RINGS, s = sqrt(1 - z * z);
        const double phi = 2 * PI * ((c % SECTORS + (j % FINE + 0.5) / FINE) / SECTORS - 0.5);
        at[i] = vec3_from(s * cos(phi), s * sin(phi), z);
    }
    for (int k = 0; k < 6; k++) {
        const double degrees = k % 2 ? 65 : 10;
        double observed[CELLS] = {0}, expected[CELLS] = {0}, sum = 0;
        double *u = mark_uniforms(3 * DRAWS, mark_seed(proposed ? 5 : 1), (uint64_t)k);
        lit l; /* a proposal's with two lobes */
        const ask_surface s = seen(&l, light, k % 3 && !proposed
                                   ? metal(roughnesses[k / 2]) : plastic(roughnesses[k / 2]), degrees);
        draw(&s, proposed, u, DRAWS, w);
        for (int i = 0; i < DRAWS; i++) {
            const int ring = (int)((1 - (double)w[i].z) / 2 * RINGS),
                sector = (int)((atan2((double)w[i].y, (double)w[i].x) / (2 * PI) + 0.5) * SECTORS);
            observed[(ring < 0 ? 0 : ring < RINGS ? ring : RINGS - 1) * SECTORS + (sector < SECTORS
                    ? sector : SECTORS - 1)]++;
        }
        ASK(ASK_F, GIVE(&s, 1), GIVE(at, CELLS * EACH), TAKE(at, 0), TAKE(pdf, 0), TAKE(pdf, CELLS * EACH));
        for (int i = 0; i < CELLS * EACH; i++) {
            expected[i / EACH] += pdf[i];
            sum += pdf[i];
        }
        for (int i = 0; i < CELLS; i++) expected[i] *= DRAWS / sum; /* whether it is 1 in all is another claim */
        mark_fit(observed, expected, CELLS, MARK_ALPHA, what, hint);
    }
}

static void samples_have_the_density(void)
{
    check_samples(false, "rings and sectors about the normal",
                  "pdf must be the density of what sample returns: of the mixture, in solid angle of "
                  "wi (a density of half vectors is divided by 4 wo h).");
    check_samples(true, "rings and sectors, drawn by a proposal",
                  "Proposals count on the lobe where u0 < p_specular, and nowhere else.");
}

static void the_albedo_comes_out_of_the_samples(void)
{
    enum { N = 400, DRAWS = 30000 };
    bis_light *light = lit_new_light(LIT_CONSTANT, 1, 0, false);
    vec3 *w = mark_alloc(DRAWS, sizeof *w);
    rgb *f = mark_alloc(DRAWS, sizeof *f);
    double *pdf = mark_alloc(DRAWS, sizeof *pdf);

    for (int k = 0; k < 6; k++) {
        const double degrees = k % 2 ? 65 : 10;
        lit l;
        const ask_surface s = seen(&l, light, k % 3 ? metal(roughnesses[k / 2]) : plastic(roughnesses[k / 2]), degrees);
        stat_moments mean = {0};
        double truth = 0, *u = mark_uniforms(3 * DRAWS, mark_seed(2), (uint64_t)k);
        for (int i = 0; i < N * N; i++) {
            double wi[3], d, q;
            midpoint(i, N, 0, wi, &d);
            truth += lit_f(&l, wi, &q).r * wi[2] * d;
        }
        draw(&s, false, u, DRAWS, w);
        ASK(ASK_F, GIVE(&s, 1), GIVE(w, DRAWS), TAKE(f, DRAWS), TAKE(pdf, DRAWS), TAKE(pdf, 0));
        for (int i = 0; i < DRAWS; i++) {
            const double c = bis_bsdf_cos(&l.pt.bsdf, w[i]);
            stat_add(&mean, c > 0 && pdf[i] > 0 ? (double)f[i].r * c / pdf[i] : 0);
        }
        mark_mean(&mean, truth, MARK_ALPHA, "the mean of f cos/q over the samples", "q must be positive wherever f cos "
                  "is, and be the density of what is drawn.");
    }
}

static void the_bound_of_rejection_holds(void)
{
    enum { N = 2000 };
    bis_light *light = lit_new_light(LIT_CONSTANT, 1, 0, false);
    double *u = mark_uniforms(60 * N * 2, mark_seed(3), 0), pdf[N], bound;
    rgb f[N];
    vec3 w[N];

    for (int k = 0; k < 60; k++) {
        lit l;
        const ask_surface s = seen(&l, light, k % 3 ? metal(roughnesses[k / 20]) : plastic(roughnesses[k / 20]),
                                   1.45 * k);
        double most = 0;
        ASK(ASK_BOUND, GIVE(&s, 1), TAKE(&bound, 1));
        if (!isfinite(bound)) {
            mark_wrong("roughness %g, seen at %g degrees: max_ratio is not finite: rejection would accept nothing",
                       roughnesses[k / 20], 1.45 * k);
        }
        for (int i = 0; i < N; i++) {
            const double *v = u + 2 * (k * N + i), z = 1 - v[0], t = sqrt(1 - z * z), phi = 2 * PI * v[1];
            w[i] = vec3_from(t * cos(phi), t * sin(phi), z);
        }
        ASK(ASK_F, GIVE(&s, 1), GIVE(w, N), TAKE(f, N), TAKE(pdf, N), TAKE(pdf, 0));
        for (int i = 0; i < N; i++) {
            const double z = 1 - u[2 * (k * N + i)], worst = rgb_max(f[i]) * z;
            if (worst > bound * pdf[i]) {
                mark_wrong("roughness %g, wo at %g degrees, wi at %.0f: f cos/q is %g, max_ratio promises %g at most",
                           roughnesses[k / 20], 1.45 * k, acos(z) * 180 / PI, worst / pdf[i], bound);
            }
            if (worst > 0) most = fmax(most, worst / pdf[i]);
        }
        if (1.45 * k < 45 && bound > 100 * most) {
            mark_wrong("roughness %g, wo at %g degrees: max_ratio is %g, and %g is the most among 2000 directions: a "
                       "bound 100 times too large lets "
                       "rejection accept nothing", roughnesses[k / 20], 1.45 * k, bound, most);
        }
    }
}

/* ---- noise ---- */

typedef struct noise {
    /* of one sample f cos/q, red: the mean; the mean square by the student's, the cosine's, our density */
    double mean, mine, cosine, ours;
} noise;

enum { NOISE_N = 450 }; /* midpoints: variances come out within 5 % of those of 900 */

/* upper: of the student's density; NULL: not asked. all: its integral over the sphere. */
static noise by_quadrature(const lit *l, const midpoints *upper, double all)
{
    noise n = {0};

    for (int i = 0; i < NOISE_N * NOISE_N; i++) {
        double wi[3], d, q;
        midpoint(i, NOISE_N, 0, wi, &d);
        const double F = lit_f(l, wi, &q).r * wi[2];
        n.mean += F * d;
        n.cosine += F * F / (wi[2] / PI) * d;
        n.ours += F * F / q * d;
        /* a density that is none gains nothing by it */
        n.mine += upper && F > 0 ? F * F / (upper->pdf[i] / all) * d : 0;
    }
    return n;
}

static noise noise_of(double roughness, double degrees)
{
    enum { N = NOISE_N };
    bis_light *light = lit_new_light(LIT_CONSTANT, 1, 0, false);
    lit l;

    const ask_surface s = seen(&l, light, metal(roughness), degrees);
    midpoints sphere = density_at_midpoints(&s, N, -1), upper = density_at_midpoints(&s, N, 0);
    double all = 0;

    for (int i = 0; i < N * N; i++) all += sphere.pdf[i] * 4 * PI / N / N;
    const noise n = by_quadrature(&l, &upper, all);
    return n;
}

static void expect_noise(int n_cases, double share_of_cosine, double times_ours, const char *than)
{
    double sum = 0;

    for (int k = 0; k < n_cases; k++) {
        const double degrees = k % 2 ? 65 : 10;
        const noise n = noise_of(roughnesses[k / 2], degrees);
        const double mine = n.mine - n.mean * n.mean,
            limit = share_of_cosine * (n.cosine - n.mean * n.mean) + times_ours * (n.ours - n.mean * n.mean);
        if (!(mine <= limit)) {
            mark_wrong("roughness %g, seen at %g degrees: the variance of f cos/q is %.3g, %s %.3g at most. Where "
                       "is f cos large and q small?", roughnesses[k / 2], degrees, mine, than, limit);
        }
        sum += mine / (n.ours - n.mean * n.mean);
    }
    if (times_ours > 0) mark_note("%.2f times the variance of visible normals", sum / n_cases);
}

/* Of roughness 0.3 and 0.6: what is rougher reflects nearly as the cosine has it. */
static void it_is_less_noisy_than_the_cosine(void) { expect_noise(4, 0.6, 0, "six tenths of the cosine's are"); }
static void it_is_nearly_as_good_as_visible_normals(void)
{
    expect_noise(6, 0, 1.5, "one and a half times that of visible normals is");
}

static void work(void)
{
    const size_t n = mark_size(500000);
    bis_light *light = lit_new_light(LIT_CONSTANT, 1, 0, false);
    lit l;
    const ask_surface s = seen(&l, light, metal(0.5), (double)mark_size(40));
    double *u = mark_uniforms(3 * n, mark_seed(4), 0), *pdf = mark_alloc(n, sizeof *pdf);
    vec3 *w = mark_alloc(n, sizeof *w);
    rgb *f = mark_alloc(n, sizeof *f);
    stat_moments m = {0};

    draw(&s, false, u, n, w);
    ASK(ASK_F, GIVE(&s, 1), GIVE(w, n), TAKE(f, n), TAKE(pdf, n), TAKE(pdf, 0));
    /* a claim allows 1.5 times the noise at other angles; a cheaper density of this load alone has more than twice */
    const noise must = by_quadrature(&l, NULL, 1);
    for (size_t k = 0; k < n; k++) stat_add(&m, w[k].z > 0 ? (double)f[k].r * (double)w[k].z / pdf[k] : 0);
    mark_mean(&m, must.mean, MARK_ALPHA, "the load that is timed, f cos/q", "");
    const double times = stat_variance(&m) / (must.ours - must.mean * must.mean);
    if (!(times < 2)) mark_wrong("the load that is timed: f cos/q has %.2f times the variance of ours", times);
}

int main(int argc, char **argv)
{
    static const mark_claim claims[] = {
        {"f_is_left_as_it_was_and_the_density_integrates_to_1", 15,
         f_is_left_as_it_was_and_the_density_integrates_to_1},
        {"samples_have_the_density", 20, samples_have_the_density},
        {"the_albedo_comes_out_of_the_samples", 10, the_albedo_comes_out_of_the_samples},
        {"the_bound_of_rejection_holds", 10, the_bound_of_rejection_holds},
        {"it_is_less_noisy_than_the_cosine", 15, it_is_less_noisy_than_the_cosine},
        {"it_is_nearly_as_good_as_visible_normals", 10, it_is_nearly_as_good_as_visible_normals},
    };

    return mark_main(argc, argv, claims, sizeof claims / sizeof *claims, work, 7.6);
}
