/* SPDX-License-Identifier: BSD-2-Clause */
/* thesis: what figures 3.3, 3.4, 3.8, 3.9, 4.3, 4.4 and 4.5 of the thesis show. Lists, tables, directions and densities
 * are those of the library, points are drawn by the same generator as the renderer's, and the rates are counted or
 * integrated. */
#include "still.h"

#include "bis/base/mem.h"
#include "bis/thesis/alias.h"
#include "bis/thesis/marsaglia.h"
#include "bis/thesis/phong.h"
#include "bis/thesis/rng.h"

#include <math.h>

/* ---- 3.3, 3.4: P = {0.1, 0.2, 0.4, 0.3} ---- */

enum { ITEMS = 4 };
static const double P[ITEMS] = {0.1, 0.2, 0.4, 0.3};

void thesis_marsaglia(bis_json *j)
{
    static const uint64_t w[ITEMS] = {1, 2, 4, 3};
    bis_marsaglia m;

    still_check(bis_marsaglia_init(&m, w, ITEMS, NULL));
    still_list(j, "P", P, ITEMS);
    bis_json_open(j, "list", '[');
    for (size_t i = 0; i < m.length; i++) bis_json_count(j, NULL, m.list[i]);
    bis_json_close(j);
    bis_marsaglia_clear(&m);
}

void thesis_alias(bis_json *j)
{
    bis_alias a;

    still_check(bis_alias_init(&a, P, ITEMS, NULL));
    still_list(j, "P", P, ITEMS);
    still_list(j, "prob", a.prob, ITEMS);
    bis_json_open(j, "alias", '[');
    for (int i = 0; i < ITEMS; i++) bis_json_count(j, NULL, a.alias[i]);
    bis_json_close(j);
    bis_alias_clear(&a);
}

/* ---- 3.8, 3.9: Phong, seen from the left at 45 degrees ---- */

static const vec3 up = {0, 0, 1};

static vec3 in_plane(double angle) { return vec3_from(sin(angle), 0, cos(angle)); }

static bis_material material(double ks, double kd, double n)
{
    return bis_phong(rgb_from(kd, kd, kd), rgb_from(ks, ks, ks), n);
}

/* f over the angle to the normal, in the plane of incidence. */
static void lobe(bis_json *j, double ks, double kd, double n)
{
    enum { N = 720 };
    const bis_material m = material(ks, kd, n);
    double angle[N + 1], f[N + 1];
    bis_bsdf b;

    bis_bsdf_init(&b, &m, up, in_plane(-PI / 4));
    for (int i = 0; i <= N; i++) {
        angle[i] = -PI / 2 + PI * i / N;
        f[i] = (double)bis_bsdf_f(&b, in_plane(angle[i])).r;
    }
    bis_json_open(j, NULL, '{');
    BIS_JSON_NUMBERS(j, {"ks", ks}, {"kd", kd}, {"exponent", n});
    still_list(j, "angle", angle, N + 1);
    still_list(j, "f", f, N + 1);
    bis_json_close(j);
}

void thesis_phong(bis_json *j)
{
    bis_json_open(j, "lobes", '[');
    lobe(j, 0, 1, 0);
    lobe(j, 1, 0, 5);
    lobe(j, 1, 0, 10);
    lobe(j, 1, 0, 20);
    bis_json_close(j);
}

/* Directions that the material draws, from above; those below the horizon are counted. */
static void draws(bis_json *j, double ks, double kd)
{
    enum { N = 300 };
    const bis_material m = material(ks, kd, 50);
    double x[N], y[N], from_lobe[N];
    int specular = 0, below = 0, n = 0;
    bis_bsdf b;
    bis_rng r;

    bis_bsdf_init(&b, &m, up, in_plane(-PI / 4));
    bis_rng_init(&r, 1, 0, 0, 0);
    for (int i = 0; i < N; i++) {
        const double u0 = bis_rng_double(&r), u1 = bis_rng_double(&r), u2 = bis_rng_double(&r);
        const bool is_specular = u0 < b.p_specular;
        vec3 wi;
        if (!bis_bsdf_sample(&b, u0, u1, u2, &wi)) continue;
        specular += is_specular;
        below += wi.z <= 0;
        if (wi.z <= 0) continue;
        x[n] = (double)wi.x, y[n] = (double)wi.y;
        from_lobe[n++] = is_specular;
    }
    bis_json_open(j, NULL, '{');
    BIS_JSON_NUMBERS(j, {"ks", ks}, {"kd", kd}, {"exponent", 50}, {"specular", specular},
                     {"diffuse", N - specular}, {"below", below});
    still_list(j, "x", x, n);
    still_list(j, "y", y, n);
    still_list(j, "is_specular", from_lobe, n);
    bis_json_close(j);
}

void thesis_draws(bis_json *j)
{
    bis_json_open(j, "materials", '[');
    draws(j, 0, 1);
    draws(j, 1, 0);
    draws(j, 0.5, 0.5);
    bis_json_close(j);
}

/* ---- 4.3 to 4.5: one dimension, x in [0,1) ---- */

static double bump(double x, double centre, double width)
{
    return exp(-0.5 * (x - centre) * (x - centre) / (width * width));
}

typedef double curve(double x);

/* A map: a wide light, two narrow ones, dark between. A BRDF: one broad lobe. */
static double map_light(double x)
{
    return 0.15 + 1.6 * bump(x, 0.28, 0.07) + 3.2 * bump(x, 0.55, 0.018) + 2.4 * bump(x, 0.86, 0.015);
}

static double brdf(double x) { return bump(x, 0.5, 0.16); }
static double product(double x) { return map_light(x) * brdf(x); }

static double integral(curve *f)
{
    enum { N = 20000 };
    double sum = 0;

    for (int i = 0; i < N; i++) sum += f((i + 0.5) / N) / N;
    return sum;
}

static double maximum(curve *f)
{
    double most = 0;

    for (int i = 0; i < 20000; i++) most = fmax(most, f((i + 0.5) / 20000));
    return most;
}

static double inverse(curve *f, double u)
{
    enum { N = 4000 };
    const double target = u * integral(f);
    double sum = 0;

    for (int i = 0; i < N; i++) {
        const double step = f((i + 0.5) / N) / N;
        if (sum + step > target) return (i + (target - sum) / step) / N;
        sum += step;
    }
    return 1;
}

/* f at `steps` + 1 places from 0 to 1. */
static void values(bis_json *j, const char *key, curve *f)
{
    enum { STEPS = 620 };
    double v[STEPS + 1];

    for (int i = 0; i <= STEPS; i++) v[i] = f((double)i / STEPS);
    still_list(j, key, v, STEPS + 1);
}

static void map_brdf_product(bis_json *j)
{
    values(j, "map", map_light);
    values(j, "brdf", brdf);
    values(j, "product", product);
    BIS_JSON_NUMBERS(j, {"most_of_map", maximum(map_light)}, {"most_of_brdf", maximum(brdf)},
                     {"most_of_product", maximum(product)});
}

/* Candidates from the map, accepted with probability product/(bound f). */
void thesis_rejection(bis_json *j)
{
    enum { N = 500 };
    const double bound = maximum(brdf);
    double x[N], y[N], accepted[N];
    int n = 0;
    bis_rng r;

    bis_rng_init(&r, 1, 0, 0, 0);
    for (int i = 0; i < N; i++) {
        x[i] = inverse(map_light, bis_rng_double(&r));
        y[i] = bis_rng_double(&r) * bound * map_light(x[i]);
        accepted[i] = y[i] < product(x[i]);
        n += accepted[i] > 0;
    }
    map_brdf_product(j);
    BIS_JSON_NUMBERS(j, {"candidates", N}, {"share", (double)n / N},
                     {"integrated", integral(product) / (bound * integral(map_light))});
    still_list(j, "x", x, N);
    still_list(j, "y", y, N);
    still_list(j, "accepted", accepted, N);
}

void thesis_bounds(bis_json *j)
{
    const double p = integral(product);

    map_brdf_product(j);
    BIS_JSON_NUMBERS(j, {"accepted_from_brdf", p / (maximum(map_light) * integral(brdf))},
                     {"accepted_from_map", p / (maximum(brdf) * integral(map_light))});
}

/* M from the BRDF, weighed by L; N = 6 marks on the running sum of the weights. */
void thesis_resampling(bis_json *j)
{
    enum { M = 40, N = 6 };
    double x[M], w[M], times[M] = {0}, at_product[M], sum = 0, at = 0;
    int chosen = 0;
    bis_rng r;

    bis_rng_init(&r, 2, 0, 0, 0);
    for (int i = 0; i < M; i++) {
        x[i] = inverse(brdf, (i + bis_rng_double(&r)) / M);
        w[i] = map_light(x[i]);
        at_product[i] = product(x[i]);
        sum += w[i];
    }
    double mark = bis_rng_double(&r) * sum / N;
    for (int i = 0; i < M; i++) {
        for (at += w[i]; mark < at; mark += sum / N) times[i]++;
        chosen += (int)times[i];
    }
    map_brdf_product(j);
    BIS_JSON_NUMBERS(j, {"candidates", M}, {"chosen", chosen});
    still_list(j, "x", x, M);
    still_list(j, "weight", w, M);
    still_list(j, "at_product", at_product, M);
    still_list(j, "times", times, M);
}
