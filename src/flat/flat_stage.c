/* SPDX-License-Identifier: BSD-2-Clause */
/* flat_stage: one point of a scene: which, what is exact there, and what lies in which direction. */
#include "flat/stage.h"

#include "bis/base/mem.h"
#include "bis/thesis/envmap.h"
#include "flat/face.h"
#include "tools/verify/verify.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

/* ---- opening ---- */

/* A stage of a scene that somebody keeps open. What it looks at may have another light. */
static bis_status begin(bis_flat_stage *s, const bis_scene *scene, const bis_light *light, bis_diag *diag)
{
    const bis_flat_wishes w = {.light = light};
    bis_status status = BIS_OK;

    s->scene = *scene;
    s->desc = *scene->desc;
    s->scene.desc = &s->desc;
    if (light) {
        if (!s->desc.light.filename) s->desc.light.to_world = s->desc.upright; /* as bis_scene_parse_as has it */
        status = bis_flat_scene_given(&s->own_light, &s->desc, &w, BIS_VERIFY_LIGHT_NEEDS, diag);
    } else if (s->desc.light_needs & BIS_NEED_COMPENSATED) { /* of one method alone; the others would draw by it, too */
        bis_light_desc *own = &s->desc.light;
        own->as_printed = s->desc.view.settings.as_printed;
        own->table_kind = bis_light_table_kind(own, BIS_VERIFY_LIGHT_NEEDS, s->desc.view.sampler.kind);
        status = bis_light_load(&s->own_light, own, BIS_VERIFY_LIGHT_NEEDS, NULL, NULL);
        if (status) bis_error(diag, status, nowhere, "the light cannot be built without compensation");
    }
    if (s->own_light) s->scene.light = s->own_light;
    return status;
}

static bis_status new_stage(bis_flat_stage **stage, bis_diag *diag)
{
    *stage = bis_alloc(1, sizeof **stage);
    return *stage ? BIS_OK : bis_error(diag, BIS_NOMEM, nowhere, "no memory for a stage");
}

/* A stage that could not be made is none. */
static bis_status opened(bis_flat_stage **stage, bis_status status)
{
    if (!status) return BIS_OK;
    bis_flat_stage_close(*stage);
    *stage = NULL;
    return status;
}

bis_status bis_do_stage_open(bis_flat_stage **stage, const char *scene, const char *const *settings, bis_diag *diag)
{
    bis_flat_wishes w = {0};
    bis_status status = new_stage(stage, diag);

    if (!status) status = bis_flat_scene_begin(&(*stage)->own, scene, settings, &w, true, diag);
    if (!status && !bis_light_envmap((*stage)->own.scene->light))
        status = bis_flat_refuse(diag, "the light is a constant: give a map");
    if (!status) status = begin(*stage, (*stage)->own.scene, NULL, diag);
    return opened(stage, status);
}

bis_status bis_do_stage_of(bis_flat_stage **stage, const bis_flat_scene *scene, const bis_light *light, bis_diag *diag)
{
    const bis_status status = new_stage(stage, diag);
    return opened(stage, status ? status : begin(*stage, scene->scene, light, diag));
}

void bis_flat_stage_close(bis_flat_stage *stage)
{
    if (!stage) return;
    bis_light_free(stage->own_light);
    bis_flat_scene_end(&stage->own);
    free(stage->about); /* of the C library */
    bis_free(stage);
}

/* ---- the point ---- */

bis_status bis_do_stage_at(bis_flat_stage *stage, int x, int y, double *found, bis_diag *diag)
{
    const bis_film_desc *film = &stage->desc.view.film;

    if (!(x >= 0 && x < film->width && y >= 0 && y < film->height))
        return bis_flat_refuse(diag, "pixel (%d, %d) is outside %d x %d", x, y, film->width, film->height);
    memset(found, 0, 8 * sizeof *found);
    stage->knows_exact = false;
    stage->is_chosen = true;
    stage->x = x;
    stage->y = y;
    stage->is_hit = bis_pixel_find(&stage->hit, &stage->pt, &stage->scene, x, y, &stage->counters);
    if (!stage->is_hit) return BIS_OK;
    const vec3 p = stage->pt.p, n = stage->pt.n;
    const double all[8] = {1, (double)p.x, (double)p.y, (double)p.z, (double)n.x, (double)n.y, (double)n.z,
                           stage->hit.t};
    memcpy(found, all, sizeof all);
    return BIS_OK;
}

bis_status bis_flat_stage_hit(const bis_flat_stage *stage, bis_diag *diag)
{
    if (stage->is_hit) return BIS_OK;
    return bis_flat_refuse(diag, "no point was chosen, or its pixel sees no surface: choose another one");
}

/* Computes stage->exact, unless it is known for this seed. */
static bis_status know(bis_flat_stage *stage, uint64_t seed, bis_diag *diag)
{
    bis_status status = bis_flat_stage_hit(stage, diag);

    if (status || (stage->knows_exact && stage->exact_seed == seed)) return status;
    status = bis_pixel_exact_of(&stage->exact, &stage->pt, BIS_PIXEL_MAX_PATCHES, seed, diag);
    stage->knows_exact = !status;
    stage->exact_seed = seed;
    return status;
}

bis_status bis_do_stage_exact(bis_flat_stage *stage, uint32_t seed, double *value, bis_diag *diag)
{
    const bis_status status = know(stage, seed, diag);
    const bis_pixel_exact *e = &stage->exact;

    if (status) return status;
    memcpy(value, (double[]){e->lit.mean[3], e->lit.se[3], e->open.mean[3], e->open.se[3]}, 4 * sizeof *value);
    return BIS_OK;
}

bis_status bis_do_stage_truth(bis_flat_stage *stage, uint64_t seed, double *value, double *moments, uint64_t *count,
                              bis_diag *diag)
{
    const bis_status status = know(stage, seed, diag);
    const bis_pixel_exact *e = &stage->exact;
    const double *const values[4] = {e->lit.mean, e->lit.se, e->open.mean, e->open.se};

    if (status) return status;
    for (int k = 0; k < 4; k++) memcpy(value + 4 * k, values[k], 4 * sizeof *value);
    memcpy(moments, e->variance, sizeof e->variance);
    memcpy(moments + 3, e->third, sizeof e->third);
    memcpy(count, (uint64_t[]){e->by_patches, e->patches, e->rays}, 3 * sizeof *count);
    return BIS_OK;
}

/* ---- directions of a lat-long field in the light's frame ---- */

/* The light's frame in world space; a constant has that which the scene gives it. */
static frame frame_of(const bis_flat_stage *stage)
{
    const bis_xform *to_world = &stage->desc.light.to_world;
    vec3 axis[3];

    if (!bis_light_is_constant(stage->scene.light)) bis_light_axes(stage->scene.light, axis);
    else for (int i = 0; i < 3; i++) axis[i] = bis_xform_vector(to_world, vec3_from(i == 0, i == 1, i == 2));
    return (frame){axis[0], axis[1], axis[2]};
}

/* The direction at column u and row v, which count cells. */
static vec3 at_cell(double u, double v, int columns, int rows)
{
    const double theta = PI * v / rows, phi = 2 * PI * u / columns;
    return vec3_from(sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta));
}

static bis_status check_field(int columns, int rows, bis_diag *diag)
{
    if (columns >= 1 && columns <= 4096 && rows >= 1 && rows <= 4096) return BIS_OK;
    return bis_flat_refuse(diag, "a field of %d x %d: give 1 to 4096 each", columns, rows);
}

bis_status bis_do_stage_densities(bis_flat_stage *stage, int columns, int rows, float *q_L, float *q_f, float *product,
                                  float *seen, float *peak, bis_diag *diag)
{
    bis_status status = check_field(columns, rows, diag);

    if (!status) status = bis_flat_stage_hit(stage, diag);
    if (status) return status;
    const frame light = frame_of(stage);
    memset(peak, 0, 4 * sizeof *peak);
    for (int i = 0; i < columns * rows; i++) {
        const vec3 w = at_cell(i % columns + 0.5, i / columns + 0.5, columns, rows);
        const vec3 wi = normalize(to_world(&light, w));
        q_L[i] = (float)bis_light_pdf(stage->pt.light, wi);
        q_f[i] = (float)bis_bsdf_pdf(&stage->pt.bsdf, wi);
        product[i] = (float)bis_pixel_product(&stage->pt, wi);
        seen[i] = product[i] > 0 && bis_point_sees(&stage->pt, wi) ? product[i] : 0;
        const float all[4] = {q_L[i], q_f[i], product[i], seen[i]};
        for (int k = 0; k < 4; k++) peak[k] = fmaxf(peak[k], all[k]);
    }
    return BIS_OK;
}

bis_status bis_do_stage_find(bis_flat_stage *stage, int columns, int rows, size_t n, const float *wi, uint32_t *cell,
                             bis_diag *diag)
{
    bis_status status = check_field(columns, rows, diag);

    if (status) return status;
    const frame light = frame_of(stage);
    for (size_t i = 0; i < n; i++) {
        const float *d = wi + 3 * i;
        vec3 w = {0, 0, 0};
        if (d[0] != 0 || d[1] != 0 || d[2] != 0) status = bis_flat_direction(&w, wi, i, diag);
        if (status) return status;
        w = to_local(&light, w);
        const double theta = atan2(hypot((double)w.x, (double)w.y), (double)w.z);
        const double phi = atan2((double)w.y, (double)w.x), turn = phi < 0 ? phi + 2 * PI : phi;
        const int x = (int)(turn / (2 * PI) * columns), y = (int)(theta / PI * rows);
        /* the last edges belong to the last cells, and phi = -tiny rounds to 2 pi */
        cell[i] = (uint32_t)((y < rows ? y : rows - 1) * columns + (x < columns ? x : columns - 1));
    }
    return BIS_OK;
}

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
            const vec3 w = at_cell(x + (i % sub + 0.5) / sub, y + (i / sub + 0.5) / sub, s->columns, s->rows);
            look_there(sum, pt, normalize(bis_xform_vector(light_to_world, w)), 1.0 / (sub * sub));
        }
        for (size_t k = 0; k < N_FIELDS; k++)
            s->field[k * cells + (size_t)y * (size_t)s->columns + (size_t)x] = (float)fmin(sum[k], (double)FLT_MAX);
    }
}

bis_status bis_do_stage_sphere(bis_flat_stage *stage, int columns, int rows, int sub, float *field, bis_diag *diag)
{
    bis_status status = check_field(columns, rows, diag);

    if (!status) status = bis_flat_stage_hit(stage, diag);
    if (!status && !(sub >= 1 && sub <= 64))
        status = bis_flat_refuse(diag, "%d directions a side of a cell: give 1 to 64", sub);
    if (status) return status;
    const sphere s = {field, columns, rows, sub};
#pragma omp parallel for schedule(dynamic, 4)
    for (int y = 0; y < rows; y++) {
        bis_counters counters = {0};
        bis_point mine = stage->pt;
        mine.counters = &counters;
        fill_row(&s, &stage->desc.light.to_world, &mine, y);
    }
    return BIS_OK;
}

/* ---- given directions ---- */

/* The i-th direction as a unit vector. What is one already keeps its bits: it may come from here. */
static bis_status direction(vec3 *w, const float *wi, size_t i, bis_diag *diag)
{
    *w = (vec3){wi[3 * i], wi[3 * i + 1], wi[3 * i + 2]};
    if (fabs(dot(*w, *w) - 1) <= 8 * (double)FLT_EPSILON) return BIS_OK;
    return bis_flat_direction(w, wi, i, diag);
}

bis_status bis_do_stage_look(bis_flat_stage *stage, size_t n, const float *wi, double *density, bis_diag *diag)
{
    bis_status status = bis_flat_stage_hit(stage, diag);

    for (size_t i = 0; !status && i < n; i++) {
        vec3 w;
        status = direction(&w, wi, i, diag);
        if (status) break;
        density[3 * i] = bis_light_pdf(stage->pt.light, w);
        density[3 * i + 1] = bis_bsdf_pdf(&stage->pt.bsdf, w);
        density[3 * i + 2] = bis_pixel_product(&stage->pt, w);
    }
    return status;
}

bis_status bis_do_stage_sees(bis_flat_stage *stage, size_t n, const float *wi, uint8_t *seen, bis_diag *diag)
{
    bis_status status = bis_flat_stage_hit(stage, diag);

    for (size_t i = 0; !status && i < n; i++) {
        vec3 w;
        status = direction(&w, wi, i, diag);
        if (!status) seen[i] = bis_point_sees(&stage->pt, w);
    }
    return status;
}

bis_status bis_do_stage_angles(bis_flat_stage *stage, size_t n, const float *wi, double *angle, bis_diag *diag)
{
    for (size_t i = 0; i < n; i++) {
        const vec3 w = {wi[3 * i], wi[3 * i + 1], wi[3 * i + 2]};
        if (!(isfinite(w.x) && isfinite(w.y) && isfinite(w.z)))
            return bis_flat_refuse(diag, "direction %zu is not finite", i);
        const bis_pixel_direction d = bis_pixel_direction_of(&stage->desc.light.to_world, w);
        angle[2 * i] = d.theta;
        angle[2 * i + 1] = d.phi;
    }
    return BIS_OK;
}
