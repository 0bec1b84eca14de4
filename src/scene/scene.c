/* SPDX-License-Identifier: BSD-2-Clause */
/* scene: from the description to what rays can be shot at: geometry, then light, then accelerator.
 *
 * Only what a scene requires is built (scene_needs.h). A mesh file is read when its first shape comes and dropped after
 * its last, so that at most the meshes in use are held twice. */
#include "bis/scene/scene.h"

#include "bis/base/clock.h"
#include "bis/base/mem.h"
#include "bis/base/threads.h"
#include "bis/thesis/phong.h"
#include "bump.h"
#include "files/obj.h"
#include "files/ply.h"
#include "scene_needs.h"

#include <assert.h>
#include <float.h>
#include <string.h>

static void *copy_of(const void *from, size_t n, size_t size)
{
    void *to = bis_alloc(n, size);
    if (to && n) memcpy(to, from, n * size);
    return to;
}

/* The caller clears *to, after a failure, too. */
static bis_status copy_mesh(bis_mesh *to, const bis_mesh *from, bis_loc at, bis_diag *diag)
{
    *to = (bis_mesh){.n_vertices = from->n_vertices, .n_triangles = from->n_triangles};
    to->p = copy_of(from->p, from->n_vertices, sizeof *to->p);
    to->index = copy_of(from->index, from->n_triangles, 3 * sizeof *to->index);
    if (from->n) to->n = copy_of(from->n, from->n_vertices, sizeof *to->n);
    if (from->uv) to->uv = copy_of(from->uv, from->n_vertices, sizeof *to->uv);
    if (to->p && to->index && (to->n || !from->n) && (to->uv || !from->uv)) return BIS_OK;
    return bis_error(diag, BIS_NOMEM, at, "no memory for a mesh of %zu triangles", from->n_triangles);
}

static bis_status read_file(bis_mesh *m, const bis_mesh_desc *desc, bool wants_uv, bis_diag *diag)
{
    if (desc->kind == BIS_SHAPE_PLY)
        return (wants_uv ? bis_ply_read_uv : bis_ply_read)(m, desc->filename, desc->loc, diag);
    if (!desc->has_parts) return (wants_uv ? bis_obj_read_uv : bis_obj_read)(m, desc->filename, desc->loc, diag);
    size_t n_parts;
    bis_status status = bis_obj_read_parts(m, &n_parts, desc->filename, wants_uv, desc->loc, diag);
    if (!status && n_parts != desc->n_parts)
        status = bis_error(diag, BIS_INPUT, desc->loc, "%s was changed while the scene was read: try again",
                           desc->filename);
    return status;
}

bis_status bis_mesh_desc_make(bis_mesh *m, const bis_mesh_desc *desc, bis_diag *diag)
{
    if (desc->making != BIS_MAKING_REVOLVED) {
        const bis_status status = copy_mesh(m, &desc->mesh, desc->loc, diag);
        if (status || desc->making == BIS_MAKING_NONE) return status;
        return bis_make_subdivided(m, desc->levels, desc->loc, diag);
    }
    const bis_status status = bis_make_revolved(m, &desc->revolved, desc->loc, diag);
    if (desc->lacks_uv) {
        bis_free(m->uv);
        m->uv = NULL;
    }
    return status;
}

/* wants_uv: a shape of it has textures that ask for them. */
static bis_status read_mesh(bis_mesh *m, const bis_mesh_desc *desc, bool wants_uv, bis_diag *diag)
{
    const bool of_file = desc->kind != BIS_SHAPE_TRIANGLES;
    bis_status status =
        of_file ? read_file(m, desc, wants_uv, diag) : bis_mesh_desc_make(m, desc, diag);

    if (!status && wants_uv && !m->uv)
        bis_warn(diag, desc->loc,
                 "%s has no texture coordinates: each of its triangles gets pbrt's, (0,0), (1,0), (1,1)",
                 of_file ? desc->filename : "the mesh");
    if (!status && of_file && desc->smooth && !m->n) status = bis_mesh_smooth_normals(m, diag);
    return status;
}

/* What puts a mesh that has a `fit` on the origin: the middle of its box's lowest side comes there. A box without a
 * side stays as large as it is. */
static bis_xform fit_of(const bis_mesh *m, const bis_mesh_desc *desc)
{
    bis_box b = {{HUGE_VALF, HUGE_VALF, HUGE_VALF}, {-HUGE_VALF, -HUGE_VALF, -HUGE_VALF}};

    for (size_t i = 0; i < 3 * m->n_triangles; i++) bis_box_include(&b, m->p[m->index[i]]);
    const double lo[3] = {(double)b.lo.x, (double)b.lo.y, (double)b.lo.z};
    const double side[3] = {(double)b.hi.x - lo[0], (double)b.hi.y - lo[1], (double)b.hi.z - lo[2]};
    const double longest = fmax(fmax(side[0], side[1]), side[2]), s = longest > 0 ? desc->fit / longest : 1;
    double origin[3];
    for (int k = 0; k < 3; k++) origin[k] = lo[k] + (k == (desc->is_y_up ? 1 : 2) ? 0 : side[k] / 2);
    const bis_xform move = bis_xform_translate(-origin[0], -origin[1], -origin[2]);
    const bis_xform turn = bis_xform_rotate(desc->is_y_up ? 90 : 0, 1, 0, 0), size = bis_xform_scale(s, s, s);
    const bis_xform placed = bis_xform_compose(&size, &move);
    return bis_xform_compose(&turn, &placed);
}

/* A mesh while it is in use. */
typedef struct loaded {
    bis_mesh mesh;
    bis_xform fit;
    bis_mesh_parts parts; /* of a mesh that has_parts */
    size_t shapes_left; /* that still want it */
    bool is_read, wants_uv;
} loaded;

static void clear_loaded(loaded *l)
{
    bis_mesh_clear(&l->mesh);
    bis_mesh_parts_clear(&l->parts);
}

static bis_status add_mesh(bis_geometry *g, loaded *l, const bis_mesh_desc *desc, const bis_shape_desc *shape,
                           bis_diag *diag)
{
    bis_mesh own = {0};
    bis_status status = l->is_read ? BIS_OK : read_mesh(&l->mesh, desc, l->wants_uv, diag);
    if (!status && !l->is_read && desc->has_parts)
        status = bis_mesh_sort_parts(&l->parts, &l->mesh, desc->n_parts + 1, diag);
    if (status) return status;
    if (!l->is_read && desc->fit > 0) l->fit = fit_of(&l->mesh, desc);
    l->is_read = true;
    const bis_xform to_world = desc->fit > 0 ? bis_xform_compose(&shape->to_world, &l->fit) : shape->to_world;
    const bool last = --l->shapes_left == 0;
    if (desc->has_parts) {
        status = bis_mesh_take_part(&own, &l->mesh, &l->parts, shape->part, diag);
        if (!status) status = bis_geometry_add_mesh(g, &own, &to_world, shape->material, diag);
        bis_mesh_clear(&own);
    } else if (!last && g->n_vertices == 0) { /* the first mesh may be moved into the geometry: others want it, too */
        status = copy_mesh(&own, &l->mesh, desc->loc, diag);
        if (!status) status = bis_geometry_add_mesh(g, &own, &to_world, shape->material, diag);
        bis_mesh_clear(&own);
    } else {
        status = bis_geometry_add_mesh(g, &l->mesh, &to_world, shape->material, diag);
    }
    if (last) clear_loaded(l);
    return status;
}

static bis_status add_quadric(bis_geometry *g, const bis_shape_desc *shape, bis_diag *diag)
{
    const bis_quadric q = {.kind = shape->kind == BIS_SHAPE_SPHERE ? BIS_SPHERE : BIS_DISK,
                           .radius = shape->radius,
                           .height = shape->height,
                           .to_world = shape->to_world,
                           .material = shape->material};
    return bis_geometry_add_quadric(g, &q, diag);
}

static bis_status load_geometry(bis_scene *s, const bis_scene_desc *desc, const bis_scene_needs *needs, bis_diag *diag)
{
    bis_status status = BIS_OK;
    bis_geometry *g = &s->geometry;
    loaded *meshes = bis_alloc(desc->n_meshes, sizeof *meshes);

    s->shape_end = bis_alloc(desc->n_shapes, sizeof *s->shape_end);
    if (!meshes || !s->shape_end) {
        status = bis_error(diag, BIS_NOMEM, (bis_loc){desc->path, 0, 0}, "no memory for %zu meshes", desc->n_meshes);
        goto done;
    }
    for (size_t i = 0; i < desc->n_meshes; i++)
        meshes[i] = (loaded){.shapes_left = needs->uses[i], .wants_uv = needs->with_uv[i]};
    for (size_t i = 0; i < desc->n_shapes && !status; i++) {
        const bis_shape_desc *shape = &desc->shapes[i];
        if (bis_shape_is_mesh(shape->kind))
            status = add_mesh(g, &meshes[shape->mesh], &desc->meshes[shape->mesh], shape, diag);
        else status = add_quadric(g, shape, diag);
        s->shape_end[i] = g->n_triangles;
    }
done:
    for (size_t i = 0; meshes && i < desc->n_meshes; i++) clear_loaded(&meshes[i]);
    bis_free(meshes);
    return status;
}

/* The images that shapes show are read, and the textures of each of their materials looked at once. */
static bis_status load_textures(bis_scene *s, const bis_scene_desc *desc, const bis_scene_needs *needs, bis_diag *diag)
{
    const bis_textures *t = &desc->textures;
    bis_status status = BIS_OK;

    s->images = bis_alloc(t->n_files, sizeof *s->images);
    if (!s->images)
        return bis_error(diag, BIS_NOMEM, (bis_loc){desc->path, 0, 0}, "no memory for %zu textures", t->n);
    s->n_images = t->n_files;
    for (size_t i = 0; i < t->n_files && !status; i++)
        if (needs->images[i]) status = bis_textures_load(&s->images[i], &t->files[i], diag);
    for (uint32_t i = 0; i < t->n_of_material && !status; i++) {
        const bis_material_textures *m = needs->materials[i] ? bis_textures_of(t, i) : NULL;
        if (m) status = bis_textures_check(t, s->images, m, &desc->materials[i], diag);
    }
    return status;
}

/* Shapes may turn out to be empty: then nothing is drawn from the light. */
static bis_status load_light(bis_scene *s, const bis_scene_desc *desc, const bis_scene_needs *needs, bis_diag *diag)
{
    const unsigned wanted = bis_geometry_primitives(&s->geometry) > 0 ? needs->light : 0;
    double seconds[2] = {0, 0};
    bis_light_desc light = desc->light;

    if (!desc->has_light) return bis_light_constant(&s->light, (rgb){0, 0, 0}, diag);
    light.table_kind = needs->table;
    light.as_printed = desc->view.settings.as_printed;
    bis_status status = bis_light_load(&s->light, &light, wanted, seconds, diag);
    s->seconds.load += seconds[0];
    s->seconds.envmap = seconds[1];
    return status;
}

/* The box where camera rays start; it must fit into floats. */
static bis_status find_eyes(bis_box *eyes, const bis_scene_desc *desc, bis_diag *diag)
{
    double b[6];

    bis_camera_eyes(&desc->view.camera, desc->view.film.width, desc->view.film.height, b);
    for (int i = 0; i < 6; i++) {
        if (!(fabs(b[i]) <= (double)FLT_MAX)) {
            return bis_error(diag, BIS_INPUT, (bis_loc){desc->path, 0, 0},
                             "the camera stands at %c = %g, beyond the largest float, %g: scale the scene", 'x' + i % 3,
                             b[i], (double)FLT_MAX);
        }
    }
    *eyes = (bis_box){vec3_from(b[0], b[1], b[2]), vec3_from(b[3], b[4], b[5])};
    return BIS_OK;
}

bis_status bis_scene_accel(bis_accel **out, const bis_scene *s, const bis_scene_desc *desc, bis_accel_kind kind,
                           bis_diag *diag)
{
    bis_accel_options options = desc->accel;
    bis_box eyes;
    bis_status status = find_eyes(&eyes, desc, diag);

    *out = NULL;
    if (status) return status;
    options.kind = kind;
    options.eyes = &eyes;
    return bis_accel_new(out, &s->geometry, &options, diag);
}

bool bis_scene_accel_suits(const bis_scene *s, const bis_scene_desc *desc)
{
    bis_box now, then;
    bis_accel_options options = desc->accel;
    const bool is_known = !find_eyes(&now, desc, NULL) && !find_eyes(&then, s->desc, NULL);

    options.eyes = &now;
    const bool takes_embree = is_known && bis_accel_takes_embree(&s->geometry, &options);
    options.eyes = &then;
    return is_known && takes_embree == bis_accel_takes_embree(&s->geometry, &options);
}

bis_status bis_scene_build(bis_scene **out, const bis_scene_desc *desc, bis_diag *diag)
{
    bis_scene *s = bis_alloc(1, sizeof *s);
    double start = bis_clock_now();
    bis_scene_needs needs;
    bis_status status = bis_scene_needs_of(&needs, desc, diag);

    *out = NULL;
    if (status) goto done;
    if (!s) {
        status = bis_error(diag, BIS_NOMEM, (bis_loc){desc->path, 0, 0}, "no memory for a scene");
        goto done;
    }
    s->desc = desc;
    /* geometry first: shapes that turn out to be empty need no tables of the light and no accelerator */
    status = bis_threads_check(desc->accel.n_threads, (bis_loc){desc->path, 0, 0}, diag);
    if (!status) status = load_geometry(s, desc, &needs, diag);
    if (!status && desc->textures.n_of_material > 0) status = load_textures(s, desc, &needs, diag);
    if (status) goto done;
    s->seconds.load = bis_clock_now() - start;
    status = load_light(s, desc, &needs, diag);
    if (status) goto done;
    if (bis_geometry_primitives(&s->geometry) > 0) {
        start = bis_clock_now();
        status = bis_scene_accel(&s->accel, s, desc, desc->accel.kind, diag);
        if (status) goto done;
        s->seconds.accel = bis_clock_now() - start;
    }
    *out = s;
    s = NULL;
done:
    bis_scene_needs_clear(&needs);
    bis_scene_free(s);
    return status;
}

void bis_scene_free(bis_scene *s)
{
    if (!s) return;
    if (s->accel) bis_accel_free(s->accel);
    bis_light_free(s->light);
    bis_geometry_clear(&s->geometry);
    for (size_t i = 0; i < s->n_images; i++) bis_image_clear(&s->images[i].image);
    bis_free(s->images);
    bis_free(s->shape_end);
    bis_free(s);
}

/* The shading normal, on ng's side, of a material that bends it. */
static vec3 bent_normal(const bis_scene *s, const bis_material_textures *of, const bis_surface *at, uint32_t prim,
                        const ray *eye, const double uv[2])
{
    bis_tangents t;

    bis_geometry_tangents(&s->geometry, prim, eye, &t);
    const vec3 n = bis_bump_normal(&s->desc->textures, s->images, of, &t, uv, at->p);
    return dot(n, at->ng) < 0 ? neg(n) : n;
}

void bis_scene_point_at(bis_point *pt, bis_own_material *m, const bis_scene *s, ray eye, uint32_t prim,
                        bis_counters *counters)
{
    const bis_scene_desc *desc = s->desc;
    bis_surface at;

    bis_geometry_surface(&s->geometry, prim, &eye, &at);
    *pt = (bis_point){
        .p = at.p,
        .n = at.n,
        .ng = at.ng,
        .origin = bis_surface_offset(&at),
        .wo = neg(eye.d),
        .light = s->light,
        .accel = s->accel,
        .counters = counters,
    };
    if (m) m->index = at.material;
    const bis_material *base = &desc->materials[at.material];
    const bis_material_textures *textures = bis_textures_of(&desc->textures, at.material);
    if (textures) {
        double uv[2];
        bis_geometry_uv(&s->geometry, prim, &eye, uv);
        m->own = bis_textures_material(&desc->textures, s->images, textures, base, uv, at.p);
        if (textures->bump != BIS_NO_TEXTURE || textures->normals != BIS_NO_TEXTURE)
            pt->n = bent_normal(s, textures, &at, prim, &eye, uv);
    }
    bis_bsdf_init(&pt->bsdf, textures ? &m->own : base, pt->n, pt->wo);
}

bool bis_scene_point(bis_point *pt, bis_own_material *m, const bis_scene *s, ray eye, bis_counters *counters,
                     bis_hit *hit)
{
    bis_hit first;

    if (!bis_accel_intersect(s->accel, &eye, &first)) return false;
    if (hit) *hit = first;
    bis_scene_point_at(pt, m, s, eye, first.prim, counters);
    return true;
}

void bis_scene_point_given(bis_point *pt, const bis_scene *s, ray eye, bis_counters *counters)
{
    static const bis_material white = {.model = &bis_phong_model, .Kd = {1, 1, 1}};
    const vec3 n = neg(eye.d);

    *pt = (bis_point){.p = eye.o, .n = n, .ng = n, .origin = eye.o, .wo = n, .light = s->light, .accel = s->accel,
        .counters = counters};
    bis_bsdf_init(&pt->bsdf, &white, n, n);
}

/* Spheres and disks come behind all triangles, in the order of the shapes. */
static size_t quadric_shape(const bis_scene_desc *desc, size_t number)
{
    size_t i = 0;
    while (bis_shape_is_mesh(desc->shapes[i].kind) || number-- > 0) i++;
    return i;
}

size_t bis_scene_shape_of(const bis_scene *s, uint32_t prim, size_t *part)
{
    *part = 0;
    assert(prim < bis_geometry_primitives(&s->geometry));
    if (prim >= s->geometry.n_triangles) return quadric_shape(s->desc, prim - s->geometry.n_triangles);
    size_t i = 0;
    while (s->shape_end[i] <= prim) i++;
    *part = prim - (i ? s->shape_end[i - 1] : 0);
    return i;
}

bis_scene_figures bis_scene_figures_of(const bis_scene *s)
{
    bis_scene_figures f = {.triangles = s->geometry.n_triangles,
                           .mesh = (double)bis_geometry_bytes(&s->geometry),
                           .accel = s->accel ? (double)bis_accel_bytes(s->accel) : (double)NAN,
                           .envmap = bis_light_is_constant(s->light) ? (double)NAN : (double)bis_light_bytes(s->light)};

    snprintf(f.accelerator, sizeof f.accelerator, "%s", s->accel ? bis_accel_name(s->accel) : "");
    return f;
}
