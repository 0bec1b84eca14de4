/* SPDX-License-Identifier: BSD-2-Clause */
/* verify_pixels: what the pixels of a film should be, without anything that src/render and src/beyond are made of.
 *
 * A sample is a camera ray through a place in the pixel's area and two directions from the point that it meets: one
 * from the map, of density q_L = I(Le)/Z, and one from the material, of density q_f. Each adds F V/(q_L + q_f), so
 * that the sum of both has the mean L (Veach and Guibas 1995, balance heuristic). I is bis_verify_measure, and Z the
 * sum of I times solid angle over all patches: the map's own tables are not used. Because F V/(q_L + q_f) is at most
 * Z f cos, a small sun leaves no rare, bright samples.
 *
 * Sample j of n takes the numbers frac(s + j a), s being random and the a irrational: each by itself is uniform, and
 * together they are spread (Cranley and Patterson 1976). The error is told by the scatter of whole batches, each with
 * an s of its own for every pixel.
 * Cost: a camera ray and two shadow rays a sample, 3 us. */
#include "verify.h"

#include "bis/base/mem.h"


static const uint64_t purpose_pixels = (uint64_t)0x79 << 40;

enum { X, Y, MAP, LOBE, ANGLE, HEIGHT, DIMENSIONS };

/* 1/p and 1/p^2 with p^3 = p + 1 (Roberts's R2), the golden ratio, and the fractional parts of the roots of 7, 2 and 3.
 * They are rationally independent: no sum of them with whole factors is whole. So the points k step (mod 1) never
 * repeat and fill all dimensions together evenly (Weyl). */
static const double step[DIMENSIONS] = {0.75487766624669276, 0.56984029099805327, 0.61803398874989485,
                                        0.64575131106459059, 0.41421356237309505, 0.73205080756887729};

/* ---- the light's own table ---- */

static double measure(rgb c) { return bis_verify_measure((rgbd){(double)c.r, (double)c.g, (double)c.b}); }

bis_status bis_verify_table_init(bis_verify_table *t, const bis_light *light, bis_diag *diag)
{
    *t = (bis_verify_table){.light = light, .n = bis_light_patches(light)};
    t->sum = bis_alloc(t->n + 1, sizeof *t->sum);
    if (!t->sum) return bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for the sums over %zu patches", t->n);
    for (size_t i = 0; i < t->n; i++) {
        bis_light_point y;
        bis_light_patch(light, i, (double[]){0.5, 0.5}, &y);
        t->sum[i + 1] = t->sum[i] + measure(y.Le) / y.pdf;
    }
    return BIS_OK;
}

void bis_verify_table_clear(bis_verify_table *t)
{
    bis_free(t->sum);
    *t = (bis_verify_table){0};
}

static double all_of(const bis_verify_table *t) { return t->sum[t->n]; }

/* A direction of density I(Le)/Z. Needs Z > 0. */
static void draw(bis_light_point *y, const bis_verify_table *t, double u, bis_rng *rng)
{
    const double place[2] = {bis_rng_double(rng), bis_rng_double(rng)}, at = u * all_of(t);
    size_t lo = 0, hi = t->n; /* sum[lo] <= at < sum[hi] */

    while (hi - lo > 1) {
        const size_t middle = (lo + hi) / 2;
        if (t->sum[middle] <= at) lo = middle;
        else hi = middle;
    }
    bis_light_patch(t->light, lo, place, y);
}

/* ---- one sample ---- */

/* F V/(q_L + q_f) of a direction; 0 where nothing comes from there. */
static double share_of(const bis_verify_eye *e, const bis_point *pt, vec3 wi, rgb Le)
{
    const double cos_theta = bis_bsdf_cos(&pt->bsdf, wi);
    double q_f;

    if (cos_theta <= 0) return 0;
    const rgb f = bis_bsdf_f_pdf(&pt->bsdf, wi, &q_f);
    const double F = measure(rgb_mul(f, Le)) * cos_theta;
    if (F <= 0 || !(e->without_shadows || bis_point_sees(pt, wi))) return 0;
    return F / (measure(Le) / all_of(e->table) + q_f);
}

static double reflected(const bis_verify_eye *e, const bis_point *pt, const double u[DIMENSIONS], bis_rng *rng)
{
    bis_light_point y;
    vec3 wi;
    double L = 0;

    if (bis_bsdf_is_black(&pt->bsdf) || all_of(e->table) <= 0) return 0;
    draw(&y, e->table, u[MAP], rng);
    L += share_of(e, pt, y.wi, y.Le);
    if (bis_bsdf_sample(&pt->bsdf, u[LOBE], u[ANGLE], u[HEIGHT], &wi))
        L += share_of(e, pt, wi, bis_light_Le(e->table->light, wi));
    return L;
}

/* The same surface, for an eye that looks for outlines? As docs/trust.md says it. */
static bool is_alike(const bis_verify_pixel *p, bool hit, uint32_t material, const bis_point *pt)
{
    if (hit != (p->material != BIS_NO_NUMBER)) return false;
    return !hit || (material == p->material && dot(pt->n, p->n) >= 0.5);
}

/* The mean over n samples of film pixel (x, y). p: may be NULL. */
static double mean_of(const bis_verify_eye *e, int x, int y, uint32_t n, bis_rng *rng, bis_verify_pixel *p)
{
    const bis_film *f = e->film;
    bis_counters counters = {0};
    double s[DIMENSIONS], sum = 0;

    for (int d = 0; d < DIMENSIONS; d++) s[d] = bis_rng_double(rng);
    for (uint32_t j = 0; j < n; j++) {
        double u[DIMENSIONS], whole;
        bis_own_material m;
        bis_point pt;
        for (int d = 0; d < DIMENSIONS; d++) u[d] = modf(s[d] + j * step[d], &whole);
        if (!e->view->pixel_jitter) u[X] = u[Y] = 0.5;
        const ray eye = bis_camera_ray(&e->view->camera, f->picture_width, f->picture_height,
                                       x * f->step + f->step / 2 + u[X], y * f->step + f->step / 2 + u[Y]);
        const bool hit = bis_scene_point(&pt, &m, e->scene, eye, &counters, NULL);
        const double L = hit ? reflected(e, &pt, u, rng)
                             : measure(bis_light_seen(&e->desc->light, e->table->light, eye.d));
        sum += L;
        if (!p) continue;
        if (j == 0 && hit) {
            p->material = m.index;
            p->n = pt.n;
        }
        p->is_outline |= !is_alike(p, hit, hit ? m.index : BIS_NO_NUMBER, &pt);
        p->square += L * L / n;
        p->slope[0] += L * (u[X] - 0.5) / n;
        p->slope[1] += L * (u[Y] - 0.5) / n;
    }
    return sum / n;
}

/* ---- all of them ---- */

void bis_verify_means(double *mean, bis_verify_pixel *pixels, const bis_verify_eye *e, const uint32_t *n, uint64_t seed)
{
    const int width = e->film->width, height = e->film->height;

#pragma omp parallel for schedule(dynamic, 8) collapse(2)
    for (int y = 0; y < height; y++) {
        for (int x = 0; x < width; x++) {
            const size_t i = (size_t)y * (size_t)width + (size_t)x;
            bis_rng rng;
            bis_rng_init(&rng, seed, i, 0, purpose_pixels);
            if (pixels) pixels[i] = (bis_verify_pixel){.material = BIS_NO_NUMBER};
            mean[i] = mean_of(e, e->film->x0 + x, e->film->y0 + y, n[i], &rng, pixels ? &pixels[i] : NULL);
        }
    }
}
