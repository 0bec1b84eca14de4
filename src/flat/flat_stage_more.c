/* SPDX-License-Identifier: BSD-2-Clause */
/* flat_stage_more: one point of a scene for those who measure: the truth by colour, runs of a method against it, one
 * estimate taken apart, shadow rays, and what lies in given directions. src/tools/pixel computes it. */
#include "flat/stage.h"

#include "bis/base/mem.h"
#include "flat/say.h"
#include "tools/verify/verify.h"

#include <float.h>
#include <string.h>

static const bis_loc nowhere = {0};

/* ---- the truth, and methods against it ---- */

static void put_value(double *to, const bis_pixel_value *v)
{
    memcpy(to, v->mean, sizeof v->mean);
    memcpy(to + 4, v->se, sizeof v->se);
}

int bis_flat_stage_truth(bis_flat_stage *stage, uint64_t seed, double *value, double *moments, uint64_t *count,
                         char *say, size_t size)
{
    bis_diag diag = {0};
    bis_status status = BIS_FLAT_GIVEN(&diag, stage, value, moments, count);

    if (!status) status = bis_flat_stage_know(stage, seed, &diag);
    if (!status) {
        const bis_pixel_exact *e = &stage->exact;
        put_value(value, &e->lit);
        put_value(value + 8, &e->open);
        memcpy(moments, e->variance, sizeof e->variance);
        memcpy(moments + 3, e->third, sizeof e->third);
        memcpy(count, (uint64_t[]){e->by_patches, e->patches, e->rays}, 3 * sizeof *count);
    }
    return bis_flat_end(status, &diag, say, size);
}

int bis_flat_stage_method(bis_flat_stage *stage, const char *const *settings, uint64_t seed, size_t n,
                          const volatile sig_atomic_t *stop, float *L, double *value, double *figures, char *say,
                          size_t size)
{
    bis_diag diag = {0};
    bis_status status = BIS_FLAT_GIVEN(&diag, stage, settings, L, value, figures);
    bis_pixel_method m;

    if (!status) status = bis_flat_stage_ask(stage, settings, &diag);
    if (!status && !(n >= 2 && n <= 100000000))
        status = bis_error(&diag, BIS_INPUT, nowhere, "%zu estimates: give 2 to 100000000", n);
    if (!status && !stage->knows_exact)
        status = bis_error(&diag, BIS_INPUT, nowhere, "the truth is not known here: ask for it first");
    if (!status) {
        const bis_view *view = &stage->asked.view;
        const bis_verify_job job = {&stage->pt, NULL, view->sampler.kind, (uint32_t)n, seed, stop};
        m = (bis_pixel_method){.settings = view->settings, .is_open = view->settings.integrator->without_shadows};
        status = bis_pixel_method_run(&m, (rgb *)L, &stage->exact, job, &diag);
    }
    if (!status) {
        put_value(value, &m.L);
        memcpy(figures, (double[]){m.z, m.skewness, m.true_skewness, m.error, m.rays, m.accepted}, 6 * sizeof *figures);
    }
    return bis_flat_end(status, &diag, say, size);
}

/* ---- one estimate ---- */

/* The sampler of the scene with another seed, and the number of the chosen pixel in it. */
static uint64_t pixel_of(bis_sampler *sampler, const bis_flat_stage *stage, uint64_t seed)
{
    *sampler = stage->asked.view.sampler;
    sampler->seed = seed;
    return (uint64_t)stage->y * (uint64_t)stage->asked.view.film.width + (uint64_t)stage->x;
}

int bis_flat_stage_estimate(bis_flat_stage *stage, const char *const *settings, uint64_t seed, size_t room, float *wi,
                            double *w, uint32_t *count, double *sum, char *say, size_t size)
{
    bis_diag diag = {0};
    bis_pixel_candidates c = {0};
    bis_sampler sampler;
    bis_stream stream;
    bis_status status = BIS_FLAT_GIVEN(&diag, stage, settings, wi, w, count, sum);

    if (!status) status = bis_flat_stage_ask(stage, settings, &diag);
    if (!status) status = bis_flat_stage_sir(stage, room, &diag);
    if (!status) {
        const uint64_t pixel = pixel_of(&sampler, stage, seed);
        bis_stream_init(&stream, &sampler, pixel, 0);
        status = bis_pixel_candidates_draw(&c, &stage->pt, &stage->asked.view.settings, &stream, &diag);
    }
    for (size_t i = 0; !status && i < c.M; i++) {
        const bis_pixel_candidate *x = &c.c[i];
        memcpy(wi + 3 * i, &x->wi, 3 * sizeof *wi);
        w[i] = x->w;
        memcpy(count + 3 * i, (uint32_t[]){x->from_map, x->chosen, x->seen}, 3 * sizeof *count);
    }
    if (!status)
        memcpy(sum, (double[]){c.M, c.N, c.W, c.square_sum, c.ess, c.largest, c.share_em, c.n_map, c.positive,
                               c.distinct, c.seen, c.L.r, c.L.g, c.L.b, c.L_ns.r, c.L_ns.g, c.L_ns.b},
               17 * sizeof *sum);
    bis_pixel_candidates_clear(&c);
    return bis_flat_end(status, &diag, say, size);
}

int bis_flat_stage_rays(bis_flat_stage *stage, const char *const *settings, uint64_t seed, uint32_t runs, size_t room,
                        float *wi, uint32_t *which, size_t *n, char *say, size_t size)
{
    bis_diag diag = {0};
    bis_pixel_rays r = {0};
    bis_sampler sampler;
    bis_status status = BIS_FLAT_GIVEN(&diag, stage, settings, n);

    if (!status && room > 0) status = BIS_FLAT_GIVEN(&diag, wi, which);
    if (!status) status = bis_flat_stage_ask(stage, settings, &diag);
    if (!status && runs > 1 << 20)
        status = bis_error(&diag, BIS_INPUT, nowhere, "rays of %u estimates: give 1048576 at most", (unsigned)runs);
    if (!status) {
        const uint64_t pixel = pixel_of(&sampler, stage, seed);
        status = bis_pixel_rays_record(&r, &stage->pt, &stage->asked.view.settings, &sampler, pixel, runs, &diag);
    }
    for (size_t i = 0; !status && i < r.n && i < room; i++) {
        memcpy(wi + 3 * i, &r.ray[i].wi, 3 * sizeof *wi);
        which[2 * i] = r.ray[i].run;
        which[2 * i + 1] = r.ray[i].seen;
    }
    if (!status) *n = r.n;
    bis_pixel_rays_clear(&r);
    return bis_flat_end(status, &diag, say, size);
}

/* ---- given directions ---- */

/* The i-th direction as a unit vector. What is one already keeps its bits: it may come from here. */
static bis_status direction(vec3 *w, const float *wi, size_t i, bis_diag *diag)
{
    *w = (vec3){wi[3 * i], wi[3 * i + 1], wi[3 * i + 2]};
    if (fabs(dot(*w, *w) - 1) <= 8 * (double)FLT_EPSILON) return BIS_OK;
    return bis_flat_direction(w, wi, i, diag);
}

int bis_flat_stage_look(bis_flat_stage *stage, size_t n, const float *wi, double *density, char *say, size_t size)
{
    bis_diag diag = {0};
    bis_status status = BIS_FLAT_GIVEN(&diag, stage);

    if (!status && n > 0) status = BIS_FLAT_GIVEN(&diag, wi, density);
    if (!status) status = bis_flat_stage_hit(stage, &diag);
    for (size_t i = 0; !status && i < n; i++) {
        vec3 w;
        status = direction(&w, wi, i, &diag);
        if (status) break;
        density[3 * i] = bis_light_pdf(stage->pt.light, w);
        density[3 * i + 1] = bis_bsdf_pdf(&stage->pt.bsdf, w);
        density[3 * i + 2] = bis_pixel_product(&stage->pt, w);
    }
    return bis_flat_end(status, &diag, say, size);
}

int bis_flat_stage_sees(bis_flat_stage *stage, size_t n, const float *wi, uint8_t *seen, char *say, size_t size)
{
    bis_diag diag = {0};
    bis_status status = BIS_FLAT_GIVEN(&diag, stage);

    if (!status && n > 0) status = BIS_FLAT_GIVEN(&diag, wi, seen);
    if (!status) status = bis_flat_stage_hit(stage, &diag);
    for (size_t i = 0; !status && i < n; i++) {
        vec3 w;
        status = direction(&w, wi, i, &diag);
        if (!status) seen[i] = bis_point_sees(&stage->pt, w);
    }
    return bis_flat_end(status, &diag, say, size);
}

int bis_flat_stage_angles(bis_flat_stage *stage, size_t n, const float *wi, double *angle, char *say, size_t size)
{
    bis_diag diag = {0};
    bis_status status = BIS_FLAT_GIVEN(&diag, stage);

    if (!status && n > 0) status = BIS_FLAT_GIVEN(&diag, wi, angle);
    for (size_t i = 0; !status && i < n; i++) {
        const vec3 w = {wi[3 * i], wi[3 * i + 1], wi[3 * i + 2]};
        if (!(isfinite(w.x) && isfinite(w.y) && isfinite(w.z))) {
            status = bis_error(&diag, BIS_INPUT, nowhere, "direction %zu is not finite", i);
            break;
        }
        const bis_pixel_direction d = bis_pixel_direction_of(&stage->desc.light.to_world, w);
        angle[2 * i] = d.theta;
        angle[2 * i + 1] = d.phi;
    }
    return bis_flat_end(status, &diag, say, size);
}

/* ---- the whole sphere ---- */

/* q_L (eq. 4.2); f cos, of which eq. 4.3 is the density; the product (eq. 4.4); the part of it that is seen. */
enum { MAP, BRDF, PRODUCT, SEEN, N_FIELDS };

static void look_there(double sum[N_FIELDS], const bis_point *pt, vec3 wi, double share)
{
    double q_L;
    const rgb Le = bis_light_Le_pdf(pt->light, wi, &q_L);
    const double cos_theta = bis_bsdf_cos(&pt->bsdf, wi);

    sum[MAP] += share * q_L;
    if (cos_theta <= 0) return;
    const rgb f = bis_bsdf_f(&pt->bsdf, wi);
    const double f_L = (double)f.r * (double)Le.r + (double)f.g * (double)Le.g + (double)f.b * (double)Le.b;
    const double product = f_L * cos_theta;
    sum[BRDF] += share * rgb_sum(f) * cos_theta;
    sum[PRODUCT] += share * product;
    if (product > 0 && bis_point_sees(pt, wi)) sum[SEEN] += share * product;
}

/* Fields of so many cells, each cell the mean over sub x sub directions. */
typedef struct sphere {
    float *field;
    int columns, rows, sub;
} sphere;

static void fill_row(const sphere *s, const bis_xform *light_to_world, const bis_point *pt, int y)
{
    const int sub = s->sub;
    const size_t cells = (size_t)s->columns * (size_t)s->rows;

    for (int x = 0; x < s->columns; x++) {
        double sum[N_FIELDS] = {0};
        for (int i = 0; i < sub * sub; i++) {
            const double v = y + (i / sub + 0.5) / sub, u = x + (i % sub + 0.5) / sub;
            const double theta = PI * v / s->rows, phi = 2 * PI * u / s->columns;
            const vec3 w = vec3_from(sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta));
            look_there(sum, pt, normalize(bis_xform_vector(light_to_world, w)), 1.0 / (sub * sub));
        }
        for (size_t k = 0; k < N_FIELDS; k++)
            s->field[k * cells + (size_t)y * (size_t)s->columns + (size_t)x] = (float)fmin(sum[k], (double)FLT_MAX);
    }
}

int bis_flat_stage_sphere(bis_flat_stage *stage, int columns, int rows, int sub, float *field, char *say, size_t size)
{
    bis_diag diag = {0};
    bis_status status = BIS_FLAT_GIVEN(&diag, stage, field);

    if (!status) status = bis_flat_stage_field(columns, rows, &diag);
    if (!status) status = bis_flat_stage_hit(stage, &diag);
    if (!status && !(sub >= 1 && sub <= 64))
        status = bis_error(&diag, BIS_INPUT, nowhere, "%d directions a side of a cell: give 1 to 64", sub);
    if (status) return bis_flat_end(status, &diag, say, size);
    const sphere s = {field, columns, rows, sub};
#pragma omp parallel for schedule(dynamic, 4)
    for (int y = 0; y < rows; y++) {
        bis_counters counters = {0};
        bis_point mine = stage->pt;
        mine.counters = &counters;
        fill_row(&s, &stage->desc.light.to_world, &mine, y);
    }
    return bis_flat_end(BIS_OK, &diag, say, size);
}
