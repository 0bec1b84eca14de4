/* SPDX-License-Identifier: BSD-2-Clause */
/* verify_bsdf: does a material draw by the density that it claims, does that integrate to 1, and do integrators reflect
 * what f says?
 *
 * The sphere is cut into cells about the lobe's axis R: rings at the lobe's own quantiles (1 - t)^(n+1) = 1 - k/8 and
 * 2^-j, t = 1 - cos alpha (thesis eq. 3.16), and at equal steps of t for the rest, times 8 sectors. In each cell the
 * density is smooth for any exponent, but for the horizon's kink, and Gauss's rule on a few pieces integrates it. A
 * lobe of microfacets is smooth over the half vector h, about the normal, and only there where the view is grazing:
 * then the rings are those of h, at quantiles of GGX, tan^2 = a^2 u/(1 - u), and d wi = 4 (wo h) dh.
 * Nothing of the model is used but f, pdf and sample, and the width that it tells, n or alpha, to place the rings.
 *
 * The furnace: under a constant light the reflected radiance is L times the integral of f cos, by the same quadrature.
 * Cost: 10^5 densities and 10^5 draws for each angle. */
#include "verify.h"

#include "bis/base/mem.h"

#include <float.h>
#include <stdlib.h>

enum { OCTILES = 8, HALVINGS = 30, STEPS = 24, MAX_EDGES = OCTILES + HALVINGS + STEPS + 2, SECTORS = 8 };
enum { PIECES = 4, NODES = 4, NODES_PHI = 32 };
enum { MOST_DRAWS = 1 << 17, MOST_RUNS = 2048 };
static const double least_alpha = 1e-4; /* of microfacets; below it no rounding is bounded */

double bis_verify_width(const bis_material *m)
{
    const bis_bsdf_width w = m->model->width(m);
    const double width = w.scene_name ? w.value : 0; /* no lobe: n = 0 */
    return m->model->of_half_vector ? fmax(width, least_alpha) : width;
}

/* What quadrature may be off by, relative: measured at most 1.6e-5, the horizon's kink, for n from 0 to 1e8 and 0 to
 * 89.9 degrees, 2.2e-5 for alpha from 1e-3 to 1 up to 89 degrees; unit vectors in float add 1e-7 sqrt(n)
 * (src/thesis/phong.c), or 1e-8/alpha (3.3e-5 in all at 1e-4 and 89 degrees). */
static double quadrature_error(const bis_material *m)
{
    const double width = bis_verify_width(m);
    return 5e-5 + (m->model->of_half_vector ? 1e-8 / width : 1e-7 * sqrt(width));
}

static const uint64_t purpose_lobes = (uint64_t)0x77 << 40;

typedef struct rings {
    double t[MAX_EDGES]; /* ascending from 0 to 2 */
    int n;               /* edges */
} rings;

static int by_value(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* t outside of which the lobe has a share of exp(log_rest). */
static double quantile(const bis_material *m, double log_rest)
{
    const double width = bis_verify_width(m);
    if (!m->model->of_half_vector) return -expm1(log_rest / (width + 1));
    const double tan2 = width * width * expm1(-log_rest), secant = sqrt(1 + tan2);
    return tan2 / (secant * (1 + secant));
}

static rings rings_of(const bis_material *m)
{
    rings r = {.n = 0};
    for (int k = 1; k < OCTILES; k++) r.t[r.n++] = quantile(m, log1p(-(double)k / OCTILES));
    for (int j = 4; j <= HALVINGS; j++) r.t[r.n++] = quantile(m, -j * log(2));
    for (int k = 0; k <= STEPS; k++) r.t[r.n++] = 2.0 * k / STEPS;
    qsort(r.t, (size_t)r.n, sizeof *r.t, by_value);
    return r;
}

static const frame *axes(const bis_bsdf *b) { return b->material->model->of_half_vector ? &b->local : &b->lobe; }

/* wi at t and at phi of this cosine and sine; returns d wi / (dt dphi), 0 where no wi is. */
static double direction(vec3 *wi, const bis_bsdf *b, double t, double cosine, double sine)
{
    const frame *f = axes(b);
    const double sin_alpha = sqrt(t * (2 - t)), x = sin_alpha * cosine, y = sin_alpha * sine, z = 1 - t;
    const double d[3] = {x * (double)f->x.x + y * (double)f->y.x + z * (double)f->z.x,
                         x * (double)f->x.y + y * (double)f->y.y + z * (double)f->z.y,
                         x * (double)f->x.z + y * (double)f->y.z + z * (double)f->z.z};
    const double cos_d = d[0] * (double)b->wo.x + d[1] * (double)b->wo.y + d[2] * (double)b->wo.z;
    const bool half = b->material->model->of_half_vector;
    const double k = 2 * cos_d;
    *wi = half ? vec3_from(k * d[0] - (double)b->wo.x, k * d[1] - (double)b->wo.y, k * d[2] - (double)b->wo.z)
               : vec3_from(d[0], d[1], d[2]);
    return half ? 4 * fmax(0, cos_d) : 1;
}

typedef struct integrals {
    double pdf;
    rgbd f_cos;
} integrals;

static void add_node(integrals *sum, const bis_bsdf *b, vec3 wi, double weight)
{
    const double c = fmax(0, bis_bsdf_cos(b, wi));
    double pdf;
    const rgb f = bis_bsdf_f_pdf(b, wi, &pdf);
    sum->pdf += weight * pdf;
    sum->f_cos =
        rgbd_add(sum->f_cos, (rgbd){weight * c * (double)f.r, weight * c * (double)f.g, weight * c * (double)f.b});
}

/* A lobe's cells: cell[ring * SECTORS + sector]. */
typedef struct cells {
    const bis_bsdf *b;
    rings r;
    int n;
    integrals cell[MAX_EDGES * SECTORS];
} cells;

/* The integrals over all cells: Gauss's rule in t on PIECES equal pieces, midpoints in phi. */
static void integrate(cells *c, const bis_bsdf *b)
{
    static const double x[NODES] = {-0.86113631159405257522, -0.33998104358485626480, 0.33998104358485626480,
                                    0.86113631159405257522};
    static const double w[NODES] = {0.34785484513745385737, 0.65214515486254614263, 0.65214515486254614263,
                                    0.34785484513745385737};
    const double dphi = 2 * PI / SECTORS / NODES_PHI;
    double cosine[SECTORS * NODES_PHI], sine[SECTORS * NODES_PHI];

    *c = (cells){.b = b, .r = rings_of(b->material)};
    c->n = (c->r.n - 1) * SECTORS;
    for (int k = 0; k < SECTORS * NODES_PHI; k++) {
        cosine[k] = cos(dphi * (k + 0.5));
        sine[k] = sin(dphi * (k + 0.5));
    }
    for (int i = 0; i < (c->r.n - 1) * PIECES * NODES; i++) {
        const int ring = i / (PIECES * NODES), piece = i / NODES % PIECES;
        const double h = (c->r.t[ring + 1] - c->r.t[ring]) / PIECES,
                     t = c->r.t[ring] + h * (piece + (1 + x[i % NODES]) / 2);
        for (int k = 0; k < SECTORS * NODES_PHI; k++) {
            vec3 wi;
            const double area = direction(&wi, b, t, cosine[k], sine[k]);
            if (area > 0) add_node(&c->cell[ring * SECTORS + k / NODES_PHI], b, wi, w[i % NODES] / 2 * h * dphi * area);
        }
    }
}

/* The cell of a drawn direction. */
static int cell_of(const rings *r, const bis_bsdf *b, vec3 wi)
{
    const frame *f = axes(b);
    double d[3] = {(double)wi.x, (double)wi.y, (double)wi.z};
    if (b->material->model->of_half_vector) {
        const double s[3] = {d[0] + (double)b->wo.x, d[1] + (double)b->wo.y, d[2] + (double)b->wo.z};
        const double norm = sqrt(s[0] * s[0] + s[1] * s[1] + s[2] * s[2]);
        for (int i = 0; i < 3; i++) d[i] = s[i] / norm;
    }
    const double x = d[0] - (double)f->z.x, y = d[1] - (double)f->z.y, z = d[2] - (double)f->z.z,
                 t = (x * x + y * y + z * z) / 2;
    const double phi = atan2(d[0] * (double)f->y.x + d[1] * (double)f->y.y + d[2] * (double)f->y.z,
                             d[0] * (double)f->x.x + d[1] * (double)f->x.y + d[2] * (double)f->x.z);
    const int sector = (int)floor((phi < 0 ? phi + 2 * PI : phi) / (2 * PI) * SECTORS) % SECTORS;
    int lo = 0, hi = r->n - 1;
    while (hi - lo > 1) {
        const int mid = (lo + hi) / 2;
        if (r->t[mid] <= t) lo = mid;
        else hi = mid;
    }
    return lo * SECTORS + sector;
}

static vec3 wo_at(double degrees)
{
    const double a = degrees * PI / 180;
    return normalize(vec3_from(0.6 * sin(a), 0.8 * sin(a), cos(a)));
}

static void check_lobes(bis_verify *v, const cells *c, const char *name)
{
    const bis_bsdf *b = c->b;
    double expected[MAX_EDGES * SECTORS], observed[MAX_EDGES * SECTORS] = {0}, sum = 0;
    bis_rng rng;

    for (int i = 0; i < c->n; i++) sum += c->cell[i].pdf;
    bis_verify_bound(bis_verify_new(v, "materials", "%s: density integrates to 1", name), fabs(sum - 1),
                     quadrature_error(b->material), "error of the integral");
    const int n_draws = MOST_DRAWS >> v->halvings;
    /* DBL_MIN: nodes below the horizon cannot tell a cell that just touches it from one where nothing is drawn. */
    for (int i = 0; i < c->n; i++) expected[i] = fmax(c->cell[i].pdf * (n_draws / sum), DBL_MIN);
    bis_rng_init(&rng, bis_verify_seed(v, "%s: draws by its density", name), 0, 0, purpose_lobes);
    for (int i = 0; i < n_draws; i++) {
        vec3 wi;
        const double u0 = bis_rng_double(&rng), u1 = bis_rng_double(&rng), u2 = bis_rng_double(&rng);
        if (bis_bsdf_sample(b, u0, u1, u2, &wi)) observed[cell_of(&c->r, b, wi)]++;
    }
    bis_verify_fit(bis_verify_new(v, "materials", "%s: draws by its density", name), observed, expected, (size_t)c->n);
}

/* ---- the furnace ---- */

static bis_status check_furnace(bis_verify *v, const cells *c, const bis_settings *settings, size_t n,
                                const char *name, bis_diag *diag)
{
    const bis_bsdf *b = c->b;
    const rgb L = {1, 0.5f, 0.25f};
    const uint32_t n_runs = MOST_RUNS >> v->halvings;
    bis_counters counters = {0};
    bis_light *light = NULL;
    rgb *estimate = bis_alloc(n_runs, sizeof *estimate);
    bis_status status = estimate ? bis_light_constant(&light, L, diag)
                                 : bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for a furnace");
    if (status) goto done;

    const bis_point pt = {
        .n = {0, 0, 1}, .ng = {0, 0, 1}, .wo = b->wo, .light = light, .counters = &counters, .bsdf = *b};
    rgbd R = {0, 0, 0};
    for (int i = 0; i < c->n; i++) R = rgbd_add(R, c->cell[i].f_cos);
    const double expected = bis_verify_measure((rgbd){(double)L.r * R.r, (double)L.g * R.g, (double)L.b * R.b});
    for (size_t i = 0; i < n && !status; i++) {
        const char *integrator = settings[i].integrator->name;
        bis_verify_moments runs = {0};
        const bis_verify_job job = {&pt, &settings[i], BIS_SAMPLER_STRATIFIED, n_runs,
                                    bis_verify_seed(v, "%s: furnace, %s", name, integrator), NULL};
        status = bis_verify_runs(estimate, &job, &counters, diag);
        for (uint32_t run = 0; run < n_runs && !status; run++) {
            bis_verify_add(&runs, bis_verify_measure((rgbd){(double)estimate[run].r, (double)estimate[run].g,
                                                            (double)estimate[run].b}));
        }
        if (!status)
            bis_verify_mean(bis_verify_new(v, "materials", "%s: furnace, %s", name, integrator), &runs, expected,
                            quadrature_error(b->material) * expected);
    }
done:
    bis_light_free(light);
    bis_free(estimate);
    return status;
}

bis_status bis_verify_material(bis_verify *v, const bis_verify_lobe *lobe, const bis_settings *settings, size_t n,
                               bis_diag *diag)
{
    bis_bsdf b;
    cells c;

    bis_bsdf_init(&b, lobe->material, (vec3){0, 0, 1}, wo_at(lobe->degrees));
    integrate(&c, &b);
    check_lobes(v, &c, lobe->name);
    return check_furnace(v, &c, settings, n, lobe->name, diag);
}
