/* SPDX-License-Identifier: BSD-2-Clause */
/* verify_bits: twelve small tables and pictures whose bits every build has (docs/trust.md, "The same bits").
 *
 * Each row is a hash of what a part computes, and rests on the rows above it: numbers, tables, a map, then pictures by
 * each method. So the first row that differs says where a build departs, and by how much: beside the hash stands a sum
 * of the same values, and a last bit changes it by 1e-16, a wrong formula by more. Nothing comes from files, so that a
 * program alone can be asked. Pictures are traced by the grid, because Embree rounds by its version and processor. */
#include "verify.h"

#include "base/text.h"
#include "bis/base/mem.h"
#include "bis/beyond/microfacet.h"
#include "bis/thesis/alias.h"
#include "bis/thesis/cdf.h"
#include "bis/thesis/phong.h"
#include "bis/thesis/regions.h"
#include "bis/thesis/rng.h"

#include <string.h>

enum { ITEMS = 1000, MAP_WIDTH = 32, MAP_HEIGHT = 16, WIDTH = 32, HEIGHT = 24, SPP = 4 };

/* ---- a hash that does not see the machine's order of bytes or its size of a size_t ---- */

static void add_bits(bis_bits *row, uint64_t v)
{
    unsigned char bytes[8];
    for (int i = 0; i < 8; i++) bytes[i] = (unsigned char)(v >> 8 * i);
    row->hash = bis_fnv1a(row->hash, bytes, sizeof bytes);
}

static void add_count(bis_bits *row, uint64_t v)
{
    add_bits(row, v);
    row->sum += (double)v;
}

static void add_real(bis_bits *row, double v)
{
    uint64_t bits;
    memcpy(&bits, &v, sizeof bits);
    add_bits(row, bits);
    row->sum += v;
}

/* ---- numbers and tables ---- */

static bis_status numbers(bis_bits *row, bis_diag *diag)
{
    static const bis_sampler_kind kinds[] = {BIS_SAMPLER_RANDOM, BIS_SAMPLER_STRATIFIED, BIS_SAMPLER_SOBOL,
                                             BIS_SAMPLER_HALTON};
    (void)diag;
    for (int k = 0; k < 4; k++) {
        bis_sampler sampler = {.kind = kinds[k], .seed = 1, .jitter = true};
        bis_stream stream;
        double u[ITEMS][2];
        bis_sampler_set_spp(&sampler, SPP);
        bis_stream_init(&stream, &sampler, 7, 1);
        bis_stream_points(&stream, 0, ITEMS, u);
        for (int i = 0; i < ITEMS; i++)
            for (int d = 0; d < 2; d++) add_real(row, u[i][d]);
        add_real(row, bis_stream_random(&stream));
    }
    return BIS_OK;
}

/* w[n]: v^4 of random v, by products alone; each fourth is 0. */
static void weights(double *w, int n)
{
    bis_rng rng;
    bis_rng_init(&rng, 1, 0, 0, 0);
    for (int i = 0; i < n; i++) {
        const double v = bis_rng_double(&rng);
        w[i] = i % 4 == 3 ? 0 : v * v * v * v;
    }
}

static bis_status alias_table(bis_bits *row, bis_diag *diag)
{
    double w[ITEMS];
    bis_alias a;
    weights(w, ITEMS);
    const bis_status status = bis_alias_init(&a, w, ITEMS, diag);
    if (status) return status;
    for (int i = 0; i < ITEMS; i++) {
        add_real(row, a.prob[i]);
        add_count(row, a.alias[i]);
    }
    bis_alias_clear(&a);
    return BIS_OK;
}

static bis_status cdf_table(bis_bits *row, bis_diag *diag)
{
    double w[ITEMS];
    bis_cdf c;
    weights(w, ITEMS);
    const bis_status status = bis_cdf_init(&c, w, ITEMS, diag);
    if (status) return status;
    for (int i = 0; i <= ITEMS; i++) add_real(row, c.c[i]);
    bis_cdf_clear(&c);
    return BIS_OK;
}

/* ---- a map ---- */

/* A dim sky with a few bright pixels, a thousand times brighter. */
static bis_status make_map(bis_envmap *em, bis_diag *diag)
{
    double w[3 * MAP_WIDTH * MAP_HEIGHT];
    bis_image image;
    bis_status status = bis_image_init(&image, MAP_WIDTH, MAP_HEIGHT, diag);

    if (status) return status;
    weights(w, 3 * MAP_WIDTH * MAP_HEIGHT);
    for (int i = 0; i < MAP_WIDTH * MAP_HEIGHT; i++) {
        const double *v = w + 3 * i, scale = i % 61 == 0 ? 1000 : 1;
        image.pixels[i] = rgb_scale(rgb_from(v[0], v[1], v[2]), scale);
    }
    return bis_envmap_from_latlong(em, &image, diag);
}

static bis_status regions(bis_bits *row, bis_diag *diag)
{
    bis_envmap em;
    bis_regions r;
    bis_status status = make_map(&em, diag);

    if (status) return status;
    status = bis_regions_init(&r, &em, BIS_LEVELS, diag);
    for (int i = 0; i < MAP_WIDTH * MAP_HEIGHT && !status; i++) add_count(row, r.label[i]);
    for (uint32_t k = 0; k < r.n && !status; k++) add_real(row, r.solid_angle[k]);
    if (!status) bis_regions_clear(&r);
    bis_envmap_clear(&em);
    return status;
}

static bis_status draws(bis_bits *row, bis_diag *diag)
{
    const bis_importance_options options = {
        .table = true, .curve = true, .area_exponent = BIS_AREA_EXPONENT, .levels = BIS_LEVELS};
    bis_importance *im = NULL;
    bis_envmap em;
    bis_rng rng;
    bis_status status = make_map(&em, diag);

    if (status) return status;
    status = bis_importance_new(&im, &em, &options, diag);
    bis_rng_init(&rng, 2, 0, 0, 0);
    for (int i = 0; i < ITEMS && !status; i++) {
        bis_map_sample s[2];
        double u[4];
        for (int d = 0; d < 4; d++) u[d] = bis_rng_double(&rng);
        bis_importance_sample(im, u, &s[0]);
        bis_importance_sample_curve(im, u[0], u + 1, &s[1]);
        for (int way = 0; way < 2; way++) {
            add_count(row, s[way].pixel);
            add_real(row, (double)s[way].w_local.x);
            add_real(row, (double)s[way].w_local.z);
            add_real(row, s[way].pdf);
        }
    }
    bis_importance_free(im);
    bis_envmap_clear(&em);
    return status;
}

/* ---- pictures ---- */

/* A ball of each material and a triangle that throws a shadow, over a floor. */
enum { SHAPES = 4, MATERIALS = 3 };
typedef struct stage {
    bis_scene_desc desc;
    bis_material materials[MATERIALS];
    bis_shape_desc shapes[SHAPES];
    bis_mesh_desc mesh;
    vec3 corners[3];
    uint32_t triangle[3];
} stage;

static void place_shapes(stage *s)
{
    const bis_xform identity = bis_xform_identity();
    s->materials[0] = bis_phong(rgb_from(0.5, 0.4, 0.3), rgb_from(0.25, 0.25, 0.25), 20);
    s->materials[1] = bis_microfacet(rgb_from(0.1, 0.2, 0.3), rgb_from(0.5, 0.4, 0.3), 0.25);
    s->materials[2] = bis_phong(rgb_from(0.5, 0.5, 0.5), rgb_from(0, 0, 0), 1);
    for (uint32_t k = 0; k < 2; k++)
        s->shapes[k] = (bis_shape_desc){.kind = BIS_SHAPE_SPHERE, .radius = 0.75, .material = k,
                                        .to_world = bis_xform_translate(1.75 * k - 0.875, 0.25 * k, 0.75)};
    s->shapes[2] = (bis_shape_desc){.kind = BIS_SHAPE_DISK, .radius = 6, .to_world = identity, .material = 2};
    s->shapes[3] = (bis_shape_desc){.kind = BIS_SHAPE_TRIANGLES, .to_world = identity, .material = 2};
    s->corners[0] = (vec3){-1.5f, 1, 1};
    s->corners[1] = (vec3){1.5f, 1.5f, 1.25f};
    s->corners[2] = (vec3){0, 0.5f, 2.5f};
    for (uint32_t k = 0; k < 3; k++) s->triangle[k] = k;
    s->mesh = (bis_mesh_desc){.kind = BIS_SHAPE_TRIANGLES,
                              .mesh = {.p = s->corners, .index = s->triangle, .n_vertices = 3, .n_triangles = 1}};
}

/* *s must stay where it is. It owns nothing. */
static void make_stage(stage *s, const bis_settings *settings)
{
    static const double camera[16] = {1, 0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0, -4, 1, 1}; /* looks along y, z up */
    bis_scene_desc *d = &s->desc;

    *s = (stage){0};
    place_shapes(s);
    d->materials = s->materials;
    d->n_materials = MATERIALS;
    d->shapes = s->shapes;
    d->n_shapes = SHAPES;
    d->meshes = &s->mesh;
    d->n_meshes = 1;
    d->accel.kind = BIS_ACCEL_GRID;
    d->has_light = true;
    d->light = bis_light_desc_default();
    d->view = (bis_view){.camera = {.fov_deg = 50},
                         .film = {.width = WIDTH, .height = HEIGHT, .crop = {0, 1, 0, 1}},
                         .sampler = {.kind = BIS_SAMPLER_SOBOL, .seed = 1, .jitter = true},
                         .pixel_jitter = true,
                         .edge_samples = 8,
                         .edge_light = 0.25,
                         .settings = *settings};
    bis_xform_from_columns(&d->view.camera.to_world, camera);
    bis_sampler_set_spp(&d->view.sampler, SPP);
}

/* The constant light of the description is replaced by our map. */
static bis_status build(bis_scene **scene, const bis_scene_desc *desc, bis_diag *diag)
{
    const bis_settings *settings = &desc->view.settings;
    bis_envmap em;
    bis_status status = bis_scene_build(scene, desc, diag);

    if (!status) status = make_map(&em, diag);
    if (status) return status;
    bis_light_free((*scene)->light);
    return bis_light_from_envmap(&(*scene)->light, &em, &desc->light, settings->integrator->light_needs(settings),
                                 diag);
}

static bis_status picture(bis_bits *row, const bis_settings *settings, bis_diag *diag)
{
    const bis_render_options options = {.budget.spp = SPP};
    bis_render_result result;
    bis_scene *scene = NULL;
    bis_film film = {0};
    stage s;

    make_stage(&s, settings);
    bis_status status = build(&scene, &s.desc, diag);
    if (!status) status = bis_film_init(&film, WIDTH, HEIGHT, s.desc.view.film.crop, (bis_loc){0}, diag);
    if (!status) status = bis_render(&result, &film, scene, &s.desc.view, &options, diag);
    for (int i = 0; i < 3 * WIDTH * HEIGHT && !status; i++) add_real(row, film.sum[i] / film.weight);
    bis_film_clear(&film);
    bis_scene_free(scene);
    return status;
}

/* ---- all of it ---- */

/* What every build must have. After a change of what a part computes: `bis verify --bits` prints the new values. */
static const struct {
    const char *name;
    bis_status (*table)(bis_bits *row, bis_diag *diag); /* NULL: a picture by */
    const bis_integrator *integrator;                   /* NULL: what a scene has that names none */
    uint64_t hash;
    double sum;
} expected[BIS_N_BITS] = {
    {"numbers of the four samplers", numbers, NULL, UINT64_C(0xbec675bddea1da4a), 4007.8456401404319},
    {"alias table", alias_table, NULL, UINT64_C(0xae18f172e181e6ea), 515521.78154573427},
    {"CDF", cdf_table, NULL, UINT64_C(0x277976515334342b), 486.26822676237686},
    {"regions of a map", regions, NULL, UINT64_C(0x66c41e77476f493d), 20985.566370614353},
    {"directions from a map", draws, NULL, UINT64_C(0xafb515edffedf989), 518059.94157794636},
    {"picture, em", NULL, &bis_em, UINT64_C(0x580aa735befc0643), 2119.8368910906038},
    {"picture, brdf", NULL, &bis_brdf, UINT64_C(0x6dface4d2281dd5d), 2054.7433203741698},
    {"picture, mis", NULL, &bis_mis, UINT64_C(0x0ad34287421cf44d), 2142.99569899978},
    {"picture, rejection", NULL, &bis_rejection, UINT64_C(0x6ea509f3d31959a6), 2104.1756067930974},
    {"picture, sir", NULL, &bis_sir, UINT64_C(0x54dbdb74b1311d68), 2092.9894400547705},
    {"picture, exact", NULL, &bis_exact, UINT64_C(0x293c7162b5ea6773), 2084.2327532091463},
    {"picture, the default", NULL, NULL, UINT64_C(0xfa4f8cd0e0376b6f), 2093.1084336872964},
};

bis_status bis_verify_bits(bis_bits rows[BIS_N_BITS], bis_diag *diag)
{
    bis_status status = BIS_OK;

    for (int i = 0; i < BIS_N_BITS && !status; i++) {
        const bis_integrator *integrator = expected[i].integrator;
        const bis_settings settings = integrator ? bis_settings_default(integrator) : bis_settings_unnamed();
        rows[i] = (bis_bits){.name = expected[i].name, .hash = BIS_FNV1A, .expected = expected[i].hash};
        status = expected[i].table ? expected[i].table(&rows[i], diag) : picture(&rows[i], &settings, diag);
        rows[i].departs = fabs(rows[i].sum - expected[i].sum) / fabs(expected[i].sum);
    }
    return status;
}
