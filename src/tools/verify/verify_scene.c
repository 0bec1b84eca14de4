/* SPDX-License-Identifier: BSD-2-Clause */
/* verify_scene: what of all the checks applies to a scene: its map, its materials, its accelerator, its picture by its
 * own integrator (verify_picture.c), and a few pixels of its view by all integrators.
 *
 * These pixels lie on a plane lattice (Roberts's R2, the plane's golden ratio), spread for any number of them; those
 * that see nothing, something black, or next to no light are passed over. Their camera ray runs through the pixel's
 * centre: then every integrator estimates one number, the reflected radiance at one point.
 * Cost: the reference visits all patches of the light 4 times for a pixel, `exact` twice more: fewer pixels for larger
 * maps, none beyond 2^24 patches. */
#include "verify.h"

#include "bis/base/mem.h"
#include "bis/beyond/microfacet.h"

#include <stdio.h>
#include <string.h>

enum {
    MAX_MATERIALS = 24,
    MAX_PIXELS = 6,
    MAX_TRIES = 4096,
    N_RAYS = 100000,
    MAX_PATCHES = 1 << 24,
    PATCH_VISITS = 1 << 25
};
enum { VISITS_OF_A_PIXEL = 6, MAX_CANDIDATES = 4096, MAX_SHADOWRAYS = 1024, MAX_SAMPLES = 4096 };

/* ---- materials ---- */

/* A material; one with textures as it is in the middle of them, (1/2, 1/2), or at the origin. */
static bis_material material_of(const bis_scene *scene, const bis_scene_desc *desc, uint32_t index)
{
    const bis_material_textures *of = bis_textures_of(&desc->textures, index);
    const bis_material *base = &desc->materials[index];

    if (!of) return *base;
    return bis_textures_material(&desc->textures, scene->images, of, base, (double[]){0.5, 0.5}, (vec3){0, 0, 0});
}

static bool equal_materials(const bis_material *a, const bis_material *b)
{
    double x[BIS_MATERIAL_NUMBERS], y[BIS_MATERIAL_NUMBERS];

    bis_material_numbers(x, a);
    bis_material_numbers(y, b);
    return a->model == b->model && memcmp(x, y, sizeof x) == 0;
}

/* Those that shapes have, each once, in the order of the scene. Returns their number, beyond MAX_MATERIALS too. */
static size_t find_materials(bis_material found[MAX_MATERIALS], const bis_scene *scene, const bis_scene_desc *desc)
{
    size_t n = 0;
    for (size_t i = 0; i < desc->n_shapes; i++) {
        const bis_material m = material_of(scene, desc, desc->shapes[i].material);
        bool known = false;
        for (size_t k = 0; k < n && k < MAX_MATERIALS && !known; k++) known = equal_materials(&found[k], &m);
        if (known) continue;
        if (n < MAX_MATERIALS) found[n] = m;
        n++;
    }
    return n;
}

static bis_status check_material(bis_verify *v, const bis_material *m, size_t number, bis_diag *diag)
{
    static const double degrees[] = {0, 45, 75, 89};
    bis_settings furnace[] = {bis_settings_default(&bis_brdf), bis_settings_default(&bis_sir)};
    bis_status status = BIS_OK;
    char name[64];

    furnace[0].as_printed = furnace[1].as_printed = v->as_printed;
    furnace[1].candidates = 64;
    furnace[1].shadowrays = 4;
    if (rgb_is_black(m->Kd) && rgb_is_black(m->Ks)) {
        bis_verify_skip(bis_verify_new(v, "materials", "%zu", number), "it is black: nothing is drawn");
        return BIS_OK;
    }
    if (!m->model->of_half_vector && bis_verify_width(m) > 1e8) {
        bis_verify_skip(bis_verify_new(v, "materials", "%zu, n %g", number, bis_verify_width(m)),
                        "unit vectors in float cannot resolve exponents beyond 1e8");
        return BIS_OK;
    }
    for (size_t i = 0; i < sizeof degrees / sizeof *degrees && !status; i++) {
        const bis_bsdf_width w = m->model->width(m); /* the exponent is n, as in the thesis; the name is a seed, too */
        snprintf(name, sizeof name, "%zu, %s %g, %g degrees", number, strcmp(w.name, "exponent") == 0 ? "n" : w.name,
                 w.value, degrees[i]);
        const bis_verify_lobe lobe = {name, m, degrees[i]};
        status = bis_verify_material(v, &lobe, furnace, sizeof furnace / sizeof *furnace, diag);
    }
    return status;
}

static bis_status check_materials(bis_verify *v, const bis_scene *scene, const bis_scene_desc *desc, bis_diag *diag)
{
    bis_material materials[MAX_MATERIALS];
    const size_t n = find_materials(materials, scene, desc);
    bis_status status = BIS_OK;

    bis_verify_begin(v, "materials");
    for (size_t i = 0; i < n && i < MAX_MATERIALS && !status; i++)
        status = check_material(v, &materials[i], i + 1, diag);
    if (n > MAX_MATERIALS)
        bis_verify_skip(bis_verify_new(v, "materials", "%d and on", MAX_MATERIALS + 1),
                        "too many: only the first are looked at");
    return status;
}

/* ---- the view ---- */

/* The same with numbers that are not too dear, and unbiased. */
static bis_settings unbiased(bis_settings s)
{
    s.estimator = BIS_ESTIMATOR_PLAIN;
    s.compensate = false;
    s.perpatch = 1;
    if (s.candidates > MAX_CANDIDATES) s.candidates = MAX_CANDIDATES;
    if (s.shadowrays > MAX_SHADOWRAYS) s.shadowrays = MAX_SHADOWRAYS;
    if (s.samples > MAX_SAMPLES) s.samples = MAX_SAMPLES;
    return s;
}

/* All integrators by their defaults; the scene's own keeps its numbers. */
static size_t make_settings(bis_settings list[BIS_VERIFY_MAX_INTEGRATORS], const bis_settings *own)
{
    size_t n = 0;
    for (int i = 0; bis_integrators[i] && n < BIS_VERIFY_MAX_INTEGRATORS; i++) {
        const bool is_own = bis_integrators[i] == own->integrator;
        list[n] = unbiased(is_own ? *own : bis_settings_default(bis_integrators[i]));
        list[n++].as_printed = own->as_printed;
    }
    return n;
}

/* Where the k-th point of the lattice falls in the film's crop window. */
static void pixel_of(int *x, int *y, int k, const bis_film_desc *f)
{
    double whole;
    const double u = modf(0.5 + k * 0.75487766624669276, &whole), w = modf(0.5 + k * 0.56984029099805327, &whole);
    *x = (int)fmin((f->crop[0] + (f->crop[1] - f->crop[0]) * u) * f->width, f->width - 1);
    *y = (int)fmin((f->crop[2] + (f->crop[3] - f->crop[2]) * w) * f->height, f->height - 1);
}

/* A small film or crop window meets the lattice again. */
static bool is_known(int x, int y, int (*known)[2], int n)
{
    for (int i = 0; i < n; i++) {
        if (known[i][0] == x && known[i][1] == y) return true;
    }
    return false;
}

/* False: nothing is hit, or it is black. */
static bool find_point(bis_point *pt, bis_own_material *m, const bis_scene *scene, int x, int y, bis_counters *counters)
{
    const bis_view *view = &scene->desc->view;
    const ray eye = bis_camera_ray(&view->camera, view->film.width, view->film.height, x + 0.5, y + 0.5);
    return bis_scene_point(pt, m, scene, eye, counters, NULL) && !bis_bsdf_is_black(&pt->bsdf);
}

static const char *why_no_view(const bis_scene *scene)
{
    if (!scene->accel) return "there is no geometry";
    if (bis_light_is_black(scene->light)) return "there is no light";
    if (bis_light_patches(scene->light) > MAX_PATCHES)
        return "the map is too large for the exact sum; resample it to 4096 x 2048";
    return NULL;
}

static bis_status check_view(bis_verify *v, const bis_scene *scene, const bis_scene_desc *desc, const bis_settings *own,
                             bis_diag *diag)
{
    const char *why = why_no_view(scene);
    bis_settings settings[BIS_VERIFY_MAX_INTEGRATORS];
    const bis_settings rendered = unbiased(*own);
    bis_counters counters = {0};
    bool is_rendered;
    double visits = 0;
    const int n_wanted = MAX_PIXELS >> v->halvings ? MAX_PIXELS >> v->halvings : 1;
    int n_pixels = 0, known[MAX_PIXELS][2];

    if (why) {
        bis_verify_skip(bis_verify_new(v, "view", "all integrators"), why);
        return BIS_OK;
    }
    bis_status status = bis_verify_picture(v, bis_render, scene, &rendered, &is_rendered, diag);
    const size_t n = make_settings(settings, own);
    const double patches = (double)bis_light_patches(scene->light);
    for (int k = 0; k < MAX_TRIES && n_pixels < n_wanted && !status; k++) {
        if (visits > 0 && visits + VISITS_OF_A_PIXEL * patches > PATCH_VISITS) break;
        bis_own_material m;
        bis_point pt;
        bool tested;
        int x, y;
        char name[64];
        pixel_of(&x, &y, k, &desc->view.film);
        if (is_known(x, y, known, n_pixels)) continue;
        if (!find_point(&pt, &m, scene, x, y, &counters)) continue;
        snprintf(name, sizeof name, "pixel (%d, %d)", x, y);
        bis_verify_begin(v, name);
        const bis_verify_place at = {name, &pt, desc->view.sampler.kind};
        status = bis_verify_point(v, &at, settings, n, &tested, diag);
        visits += VISITS_OF_A_PIXEL * patches;
        known[n_pixels][0] = x;
        known[n_pixels][1] = y;
        n_pixels += tested;
    }
    if (!status && n_pixels == 0)
        bis_verify_skip(bis_verify_new(v, "view", "all integrators"),
                        "no pixel was found that sees a surface in the light");
    return status;
}

/* ---- accelerators ---- */

static bis_status check_backends(bis_verify *v, const bis_scene *scene, const bis_scene_desc *desc, bis_diag *diag)
{
    if (!scene->accel) {
        bis_verify_skip(bis_verify_new(v, "accelerators", "grid and embree"), "there is no geometry");
        return BIS_OK;
    }
    bis_verify_begin(v, "accelerators");
    const bool grid = strcmp(bis_accel_name(scene->accel), "grid") == 0;
    bis_diag refusal = {0};
    bis_accel *other = NULL;
    bis_status status = BIS_OK;
    /* Embree may not be built in, or the scene be beyond its limits: then the grid is looked at alone */
    if (!grid || bis_accel_embree_version())
        status = bis_scene_accel(&other, scene, desc, grid ? BIS_ACCEL_EMBREE : BIS_ACCEL_GRID, &refusal);
    bis_diag_clear(&refusal);
    if (status == BIS_NOMEM) return bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for a second accelerator");
    bis_verify_backends(v, scene->accel, other, N_RAYS >> v->halvings);
    if (other) bis_accel_free(other);
    return BIS_OK;
}

bis_status bis_verify_scene(bis_verify *v, const bis_scene *scene, const bis_scene_desc *desc,
                            const bis_settings *settings, bis_diag *diag)
{
    bis_status status = BIS_OK;
    v->as_printed = settings->as_printed;
    if (bis_light_is_constant(scene->light)) {
        bis_verify_skip(bis_verify_new(v, "map", "alias, cdf, curve"), "the light is a constant, there is no map");
    } else {
        status = bis_verify_map(v, bis_light_envmap(scene->light), desc->light.area_exponent, desc->light.levels, diag);
    }
    if (!status) status = check_materials(v, scene, desc, diag);
    if (!status) status = check_view(v, scene, desc, settings, diag);
    if (!status) status = check_backends(v, scene, desc, diag);
    return status;
}
