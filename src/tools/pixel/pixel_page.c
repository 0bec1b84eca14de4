/* SPDX-License-Identifier: BSD-2-Clause */
/* pixel_page: pixel.html, in which figures 4.1 and 4.2 of the thesis for one point, the table and the CSV files are one
 * thing to explore. Written here is what it shows beyond `--json` (docs/live.md): the densities over the whole sphere
 * of directions, as the map sees it, every shadow ray and every candidate. page.html draws them.
 *
 * A place of the sphere has the mean of a density over a few directions in it, as many as the map has pixels there (at
 * most 8 x 8), so that a lamp of one pixel is not missed. */
#include "pixel_report.h"

#include "bis/base/mem.h"
#include "out/page.h"

#include <float.h>
#include <stdlib.h>

enum { WIDTH = BIS_PIXEL_SPHERE_WIDTH, HEIGHT = BIS_PIXEL_SPHERE_HEIGHT, PLACES = WIDTH * HEIGHT };
enum { SHOWN = 4096 }; /* rays of a method, and candidates that were not chosen: a page should not have 10^6 dots */
enum { MAX_SUB = 8, DECADES = BIS_PIXEL_SPHERE_DECADES, CODES = 65535 };

/* page.html with its scripts, as make puts it into the program. */
extern const char bis_pixel_page[];

/* ---- the densities ---- */

/* [HEIGHT][WIDTH] each, 1/sr: eq. 4.2, 4.3 and 4.4, and what of the last one is seen. */
enum { MAP, BRDF, PRODUCT, SEEN, N_DENSITIES };
typedef struct densities {
    float *of[N_DENSITIES];
} densities;

typedef struct place {
    double value[N_DENSITIES];
} place;

static vec3 direction_at(const bis_xform *light_to_world, double theta, double phi)
{
    const vec3 w = vec3_from(sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta));
    return normalize(bis_xform_vector(light_to_world, w));
}

static void look(place *sum, const bis_point *pt, vec3 wi, double share)
{
    double q_L;
    const rgb Le = bis_light_Le_pdf(pt->light, wi, &q_L);
    const double cos_theta = bis_bsdf_cos(&pt->bsdf, wi);

    sum->value[MAP] += share * q_L;
    if (cos_theta <= 0) return;
    const rgb f = bis_bsdf_f(&pt->bsdf, wi);
    const double f_L = (double)f.r * (double)Le.r + (double)f.g * (double)Le.g + (double)f.b * (double)Le.b;
    const double product = f_L * cos_theta;
    sum->value[BRDF] += share * rgb_sum(f) * cos_theta;
    sum->value[PRODUCT] += share * product;
    if (product > 0 && bis_point_sees(pt, wi)) sum->value[SEEN] += share * product;
}

static void fill_row(densities *d, const bis_xform *light_to_world, const bis_point *pt, int y, int sub)
{
    for (int x = 0; x < WIDTH; x++) {
        place sum = {{0}};
        for (int i = 0; i < sub * sub; i++) {
            const double v = y + (i / sub + 0.5) / sub, u = x + (i % sub + 0.5) / sub;
            look(&sum, pt, direction_at(light_to_world, PI * v / HEIGHT, 2 * PI * u / WIDTH), 1.0 / (sub * sub));
        }
        for (int k = 0; k < N_DENSITIES; k++)
            d->of[k][(size_t)y * WIDTH + (size_t)x] = (float)fmin(sum.value[k], (double)FLT_MAX);
    }
}

/* Integral over the sphere, by rows of equal solid angle. */
static double integral(const float *density)
{
    double sum = 0;
    for (int y = 0; y < HEIGHT; y++) {
        const double solid_angle = 2 * PI / WIDTH * 2 * sin(PI * (y + 0.5) / HEIGHT) * sin(PI / 2 / HEIGHT);
        double row = 0;
        for (int x = 0; x < WIDTH; x++) row += (double)density[(size_t)y * WIDTH + (size_t)x];
        sum += row * solid_angle;
    }
    return sum;
}

static void scale(float *density, double divisor)
{
    for (size_t i = 0; divisor > 0 && i < PLACES; i++) density[i] = (float)((double)density[i] / divisor);
}

static bis_status no_memory(bis_diag *diag)
{
    return bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for a sphere of %d x %d", WIDTH, HEIGHT);
}

static void densities_clear(densities *d)
{
    for (int k = 0; k < N_DENSITIES; k++) bis_free(d->of[k]);
    *d = (densities){{NULL}};
}

/* Normalised: the BRDF by its own integral (eq. 4.3), the product by L_ns (eq. 4.4), so that what is seen integrates to
 * L/L_ns. */
static bis_status densities_init(densities *d, const bis_pixel_report *r, bis_diag *diag)
{
    const bis_envmap *em = bis_light_envmap(r->pt.light);
    const int wanted = em ? (em->width + WIDTH - 1) / WIDTH : 1;
    const int sub = wanted < 2 ? 2 : wanted > MAX_SUB ? MAX_SUB : wanted;
    bool ok = true;

    *d = (densities){{NULL}};
    for (int k = 0; k < N_DENSITIES; k++) ok = (d->of[k] = bis_alloc(PLACES, sizeof(float))) && ok;
    if (!ok) {
        densities_clear(d);
        return no_memory(diag);
    }
#pragma omp parallel for schedule(dynamic, 4)
    for (int y = 0; y < HEIGHT; y++) {
        bis_counters counters = {0};
        bis_point mine = r->pt;
        mine.counters = &counters;
        fill_row(d, &r->desc->light.to_world, &mine, y, sub);
    }
    scale(d->of[BRDF], integral(d->of[BRDF]));
    scale(d->of[PRODUCT], r->exact.open.mean[3]);
    scale(d->of[SEEN], r->exact.open.mean[3]);
    return BIS_OK;
}

/* ---- as JSON ---- */

/* Powers of ten: codes reach from 10^(top - DECADES) to 10^top. */
static int find_top(const densities *d)
{
    double most = 0;
    for (int k = 0; k < SEEN; k++) {
        for (size_t i = 0; i < PLACES; i++) most = fmax(most, (double)d->of[k][i]);
    }
    return most > 0 ? (int)ceil(log10(most)) : 0;
}

/* Codes of two bytes: 0 is below the scale, else 1 + (CODES - 1) t. */
static bis_status put_codes(bis_json *j, const char *key, const float *density, int top, bis_diag *diag)
{
    uint32_t *codes = bis_alloc(PLACES, sizeof *codes);

    if (!codes) return no_memory(diag);
    for (size_t i = 0; i < PLACES; i++) {
        const double t = 1 + (log10((double)density[i]) - top) / DECADES; /* of 0: -inf */
        codes[i] = t >= 0 ? 1 + (uint32_t)lround((CODES - 1) * fmin(t, 1)) : 0;
    }
    const bis_status status = bis_page_numbers(j, key, codes, PLACES, 2, "a sphere of directions", diag);
    bis_free(codes);
    return status;
}

static void put_mark(bis_json *j, const char *key, const bis_pixel_report *r, vec3 w)
{
    const bis_pixel_direction d = bis_pixel_direction_of(&r->desc->light.to_world, w);
    BIS_JSON_OBJECT(j, key, {"theta_deg", d.theta}, {"phi_deg", d.phi});
}

static bis_status put_sphere(bis_json *j, const bis_pixel_report *r, bis_diag *diag)
{
    static const char *const names[N_DENSITIES] = {"map", "brdf", "product", "seen"};
    densities d;
    bis_status status = densities_init(&d, r, diag);

    if (status) return status;
    const int top = find_top(&d);
    bis_json_open(j, "sphere", '{');
    BIS_JSON_NUMBERS(j, {"width", WIDTH}, {"height", HEIGHT}, {"top", top}, {"decades", DECADES});
    for (int k = 0; k < N_DENSITIES && !status; k++) status = put_codes(j, names[k], d.of[k], top, diag);
    put_mark(j, "n", r, r->pt.n);
    put_mark(j, "eye", r, r->pt.wo);
    put_mark(j, "R", r, r->pt.bsdf.r);
    bis_json_close(j);
    densities_clear(&d);
    return status;
}

/* In the order of rays.csv, which has all. */
static void put_rays(bis_json *j, const bis_pixel_report *r)
{
    bis_json_open(j, "rays", '[');
    for (size_t i = 0; i < r->n_methods; i++) {
        for (size_t k = 0; k < r->rays[i].n && k < SHOWN; k++) {
            const bis_pixel_ray *q = &r->rays[i].ray[k];
            const bis_pixel_direction d = bis_pixel_direction_of(&r->desc->light.to_world, q->wi);
            bis_json_open(j, NULL, '{');
            bis_json_text(j, "method", r->methods[i].name);
            BIS_JSON_NUMBERS(j, {"sample", q->run}, {"theta_deg", d.theta}, {"phi_deg", d.phi},
                             {"q_map", bis_light_pdf(r->pt.light, q->wi)}, {"q_brdf", bis_bsdf_pdf(&r->pt.bsdf, q->wi)},
                             {"product", bis_pixel_product(&r->pt, q->wi)});
            bis_json_bool(j, "seen", q->seen);
            bis_json_close(j);
        }
    }
    bis_json_close(j);
}

/* For each method: how many estimates cast how many rays, and whether z deserves its question mark. */
static void put_shown(bis_json *j, const bis_pixel_report *r)
{
    bis_json_open(j, "shown", '[');
    for (size_t i = 0; i < r->n_methods; i++) {
        bis_json_open(j, NULL, '{');
        bis_json_text(j, "method", r->methods[i].name);
        BIS_JSON_NUMBERS(j, {"estimates", r->rays[i].runs}, {"rays", (double)r->rays[i].n});
        bis_json_bool(j, "too_skew", bis_pixel_is_too_skew(&r->methods[i]));
        bis_json_close(j);
    }
    bis_json_close(j);
}

/* Those that weigh something, in the order of candidates.csv: the others have no direction. */
static void put_candidates(bis_json *j, const bis_pixel_report *r)
{
    const bis_pixel_candidates *c = &r->candidates;
    int n = 0;

    bis_json_open(j, "candidate_list", '[');
    for (uint32_t i = 0; i < c->M; i++) {
        const bis_pixel_candidate *q = &c->c[i];
        if (q->w <= 0 || (!q->chosen && n++ >= SHOWN)) continue;
        const bis_pixel_direction d = bis_pixel_direction_of(&r->desc->light.to_world, q->wi);
        bis_json_open(j, NULL, '{');
        bis_json_text(j, "from", isnan(c->share_em) ? NULL : q->from_map ? "map" : "brdf");
        BIS_JSON_NUMBERS(j, {"candidate", i}, {"theta_deg", d.theta}, {"phi_deg", d.phi}, {"q_map", q->q_L},
                         {"q_brdf", q->q_f}, {"q", q->q}, {"product", q->product}, {"weight", q->w},
                         {"share", q->w / c->W}, {"chosen", q->chosen});
        if (q->chosen) bis_json_bool(j, "seen", q->seen);
        else bis_json_null(j, "seen");
        bis_json_close(j);
    }
    bis_json_close(j);
}

/* What the page shows beyond the report, into an open object. */
static bis_status put_page(bis_json *j, const bis_pixel_report *r, bis_diag *diag)
{
    char material[64];
    const bis_status status = put_sphere(j, r, diag);

    put_shown(j, r);
    put_rays(j, r);
    put_candidates(j, r);
    bis_json_text(j, "light", r->desc->light.filename);
    bis_json_text(j, "material_name", bis_pixel_material_name(material, r->hit.material));
    return status;
}

bis_status bis_pixel_write_page(const char *path, const bis_pixel_report *r, bis_diag *diag)
{
    static const char what[] = "the page of a pixel";
    bis_page page;
    bis_status status = bis_page_begin(&page, what, diag);
    bis_json j = {.out = page.json};

    if (status) return status;
    bis_json_open(&j, NULL, '{');
    bis_pixel_put_report(&j, r);
    status = put_page(&j, r, diag);
    bis_json_close(&j);
    bis_pixel_print_text(page.text, r);
    return bis_page_end(&page, status, path, bis_pixel_page, what, diag);
}
