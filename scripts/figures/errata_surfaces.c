/* SPDX-License-Identifier: BSD-2-Clause */
/* errata_surfaces: the numbers behind the errata of the BRDF (thesis 3.5) and of normals: E33, E35, E36, E37. */
#include "still.h"

#include "bis/thesis/phong.h"
#include "bis/shape/geometry.h"
#include "bis/base/xform.h"


static rgb grey(double v) { return rgb_from(v, v, v); }

static const vec3 up = {0, 0, 1};

static vec3 at_angles(double theta, double phi)
{
    return vec3_from(sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta));
}

/* ---- E33: what a white surface reflects ---- */

/* Integral of f over the upper hemisphere, with its cosine or without. */
static double integral_of_f(const bis_bsdf *b, bool with_cosine)
{
    enum { ROWS = 120, COLUMNS = 240 };
    double sum = 0;

    for (int i = 0; i < ROWS; i++) {
        const double theta = PI / 2 * (i + 0.5) / ROWS;
        for (int j = 0; j < COLUMNS; j++)
            sum += (double)bis_bsdf_f(b, at_angles(theta, PI * (j + 0.5) / COLUMNS)).r * sin(theta) *
                   (with_cosine ? cos(theta) : 1);
    }
    return 2 * sum * (PI / 2 / ROWS) * (PI / COLUMNS); /* both sides of the plane of incidence */
}

void errata_E33(bis_json *j)
{
    enum { N = 45 };
    const bis_material diffuse = bis_phong(grey(1), grey(0), 1), glossy = bis_phong(grey(0), grey(1), 10);
    double degrees[N], value[4][N];

    for (int i = 0; i < N; i++) {
        degrees[i] = 2 * i;
        for (int k = 0; k < 4; k++) {
            bis_bsdf b;
            bis_bsdf_init(&b, k < 2 ? &diffuse : &glossy, up, at_angles(degrees[i] * PI / 180, 0));
            value[k][i] = integral_of_f(&b, k % 2 == 1);
        }
    }
    still_list(j, "angle_deg", degrees, N);
    still_list(j, "printed_diffuse", value[0], N);
    still_list(j, "right_diffuse", value[1], N);
    still_list(j, "printed_lobe", value[2], N);
    still_list(j, "right_lobe", value[3], N);
}

/* ---- E35: the two lobes ---- */

void errata_E35(bis_json *j)
{
    enum { BINS = 30, DRAWS = 200000, FINE = 20, COLUMNS = 180 };
    const bis_material m = bis_phong(grey(0.5), grey(0.5), 50);
    double degrees[BINS], ours[BINS] = {0}, printed[BINS] = {0}, density[BINS] = {0};
    bis_bsdf b;
    bis_rng r;

    bis_bsdf_init(&b, &m, up, at_angles(40 * PI / 180, 0));
    bis_rng_init(&r, ERRATA_SEED, 0, 0, 0);
    for (int k = 0; k < DRAWS; k++) {
        const double u0 = bis_rng_double(&r), u1 = bis_rng_double(&r), u2 = bis_rng_double(&r);
        vec3 wi;
        bis_bsdf_sample(&b, u0, u1, u2, &wi);
        double z = (double)wi.z;
        if (z > 0) ours[(int)fmin(BINS - 1, BINS * acos(fmin(1, z)) / (PI / 2))] += 1.0 / DRAWS / 3;
        if (u0 >= b.p_specular) z = u1; /* the diffuse lobe uniform over the hemisphere */
        if (z > 0) printed[(int)fmin(BINS - 1, BINS * acos(fmin(1, z)) / (PI / 2))] += 1.0 / DRAWS / 3;
    }
    for (int i = 0; i < BINS * FINE; i++) {
        const double theta = PI / 2 * (i + 0.5) / (BINS * FINE);
        for (int k = 0; k < COLUMNS; k++)
            density[i / FINE] += bis_bsdf_pdf(&b, at_angles(theta, 2 * PI * (k + 0.5) / COLUMNS)) * sin(theta) *
                                 (2 * PI / COLUMNS) * (PI / 2) / (90 * FINE);
    }
    for (int i = 0; i < BINS; i++) degrees[i] = 3 * (i + 0.5);
    still_list(j, "angle_deg", degrees, BINS);
    still_list(j, "density", density, BINS);
    still_list(j, "printed", printed, BINS);
    still_list(j, "right", ours, BINS);
}

/* ---- E36: large exponents, float and double ---- */

/* Relative errors of the mean of 1 - cos (over the same u in long double) and, root mean square, of the density of own
 * samples. */
static void errors_of_exponent(double n, double of_mean[2], double of_pdf[2])
{
    enum { N = 1 << 14 };
    const frame lobe = frame_about(normalize(vec3_from(-0.4, 0.8, 0.2)));
    double sum[2] = {0, 0}, square[2] = {0, 0};
    long double true_sum = 0;

    for (int i = 0; i < N; i++) {
        const double u = (i + 0.5) / N;
        double pdf;
        vec3 local;
        bis_phong_lobe_sample(&local, &pdf, n, u, fmod(i * 0.61803398875, 1));
        const double truth = (n + 1) / (2 * PI) * exp(n / (n + 1) * log1p(-u));
        const double s2 = (double)local.x * (double)local.x + (double)local.y * (double)local.y;
        const vec3 wi = to_world(&lobe, local), z = lobe.z;
        const float c = wi.x * z.x + wi.y * z.y + wi.z * z.z; /* the obvious forms, in float */
        const double obvious = (n + 1) / (2 * PI) * (double)powf(fmaxf(0, c), (float)n);
        true_sum -= expm1l(log1pl(-(long double)u) / ((long double)n + 1));
        sum[0] += 1 - (double)powf((float)(1 - u), (float)(1 / (n + 1)));
        sum[1] += s2 / (1 + sqrt(1 - s2));
        square[0] += pow(obvious / truth - 1, 2);
        square[1] += pow(bis_phong_lobe_pdf(z, wi, n) / truth - 1, 2);
    }
    for (int k = 0; k < 2; k++) {
        of_mean[k] = fmax(1e-17, fabs(sum[k] / (double)true_sum - 1));
        of_pdf[k] = sqrt(square[k] / N);
    }
}

void errata_E36(bis_json *j)
{
    enum { N = 22 };
    double n[N], mean[2][N], pdf[2][N];

    for (int i = 0; i < N; i++) {
        double of_mean[2], of_pdf[2];
        n[i] = pow(10, 8.0 * i / (N - 1));
        errors_of_exponent(n[i], of_mean, of_pdf);
        for (int k = 0; k < 2; k++) mean[k][i] = of_mean[k], pdf[k][i] = of_pdf[k];
    }
    still_list(j, "exponent", n, N);
    still_list(j, "printed_pdf", pdf[0], N);
    still_list(j, "printed_mean", mean[0], N);
    still_list(j, "right_pdf", pdf[1], N);
    still_list(j, "right_mean", mean[1], N);
}

/* ---- E37: a ball that must not shadow itself ---- */

static void sunlit_ball(bis_json *j, const char *key, const bis_accel *a, bool offset)
{
    enum { SIZE = 180 };
    const vec3 sun = normalize(vec3_from(-0.75, 0.45, -0.5));
    bis_image field = still_field(SIZE, SIZE);
    int lit = 0, lost = 0;

    for (int y = 0; y < SIZE; y++) {
        for (int x = 0; x < SIZE; x++) {
            const ray eye = {vec3_from(2.2 * ((x + 0.5) / SIZE - 0.5) + 3, 3 - 2.2 * ((y + 0.5) / SIZE - 0.5), 0),
                {0, 0, 1}, INFINITY};
            bis_surface s;
            bis_hit hit;
            rgb colour = grey(0.85);
            if (bis_accel_intersect(a, &eye, &hit)) {
                bis_geometry_surface(a->geometry, hit.prim, &eye, &s);
                const ray shadow = {offset ? bis_surface_offset(&s) : s.p, sun, INFINITY};
                const double c = dot(s.n, sun);
                const bool sees = c > 0 && !bis_accel_occluded(a, &shadow);
                lit += c > 0;
                lost += c > 0 && !sees;
                colour = grey(0.03 + (sees ? 0.9 * c : 0));
            }
            field.pixels[y * SIZE + x] = colour;
        }
    }
    bis_json_open(j, key, '{');
    still_picture(j, "picture", &field);
    bis_json_number(j, "in_own_shadow", (double)lost / lit);
    bis_json_close(j);
}

void errata_E37(bis_json *j)
{
    const bis_quadric q = {BIS_SPHERE, 1, 0, bis_xform_translate(3, 3, 3), 0};
    bis_geometry g = {0};
    bis_accel *a;

    still_check(bis_geometry_add_quadric(&g, &q, NULL));
    still_check(bis_accel_new(&a, &g, &(bis_accel_options){BIS_ACCEL_GRID, 0, 1, NULL}, NULL));
    sunlit_ball(j, "printed", a, false);
    sunlit_ball(j, "right", a, true);
    bis_accel_free(a);
    bis_geometry_clear(&g);
}
