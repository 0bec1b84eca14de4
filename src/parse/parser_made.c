/* SPDX-License-Identifier: BSD-2-Clause */
/* parser_made: shapes by formulas or of a few points, docs/scene-format.md, "Shape". include/bis/shape/make.h makes
 * their meshes, once for shapes of equal numbers. */
#include "approximate.h"
#include "bis/base/mem.h"
#include "bis/shape/make.h"
#include "parser_ask.h"
#include "parser_shapes.h"

#include <string.h>

static const bis_interval positive = {0, HUGE_VAL, true, false};
static const bis_interval any = {-HUGE_VAL, HUGE_VAL, false, false};

static bool is_empty(bis_parser *p, const char *name, const char *what)
{
    bis_approximate_or_refuse(p, bis_params_at(p, name), "a shape without extent", "left out, as nothing of it is seen",
                              "nothing is left of the shape: %s", what);
    return false;
}

static bool keep_mesh(bis_parser *p, bis_shape_desc *shape, bis_mesh *m)
{
    shape->kind = BIS_SHAPE_TRIANGLES;
    const bool ok = bis_parser_add_mesh(p, &(bis_mesh_desc){.kind = BIS_SHAPE_TRIANGLES, .mesh = *m, .loc = shape->loc},
                                        &shape->mesh);
    if (!ok) bis_mesh_clear(m);
    return ok;
}

/* ---- surfaces of revolution ---- */

/* The mesh of r: a new one, or that of an equal r before. */
static bool add_revolved(bis_parser *p, bis_shape_desc *shape, const bis_revolved *r)
{
    char key[400];

    snprintf(key, sizeof key, "r%d %a %a %a %a %a %a %a %a %a %a", (int)r->profile, r->p[0][0], r->p[0][1], r->p[0][2],
             r->p[1][0], r->p[1][1], r->p[1][2], r->radius, r->z[0], r->z[1], r->phi_max_deg);
    shape->kind = BIS_SHAPE_TRIANGLES;
    if (bis_names_find(&p->mesh_names, key, &shape->mesh)) return true;
    if (!bis_parser_add_mesh(p, &(bis_mesh_desc){.kind = BIS_SHAPE_TRIANGLES, .making = BIS_MAKING_REVOLVED,
                                                 .revolved = *r, .size = bis_make_revolved_size(r), .loc = shape->loc},
                             &shape->mesh))
        return false;
    return bis_names_set(&p->mesh_names, key, shape->mesh) || bis_parser_nomem(p, shape->loc);
}

/* phimax, cut to a whole turn as in pbrt. */
static bool read_turn(bis_parser *p, bis_revolved *r)
{
    bis_params_float(p, "phimax", &r->phi_max_deg, any);
    r->phi_max_deg = fmin(r->phi_max_deg, 360);
    return r->phi_max_deg > 0 || is_empty(p, "phimax", "\"phimax\" must be > 0");
}

/* zmin and zmax in either order, cut to [lo, hi]. */
static bool read_heights(bis_parser *p, bis_revolved *r, double lo, double hi)
{
    double z[2] = {r->z[0], r->z[1]};
    bis_params_float(p, "zmin", &z[0], any);
    bis_params_float(p, "zmax", &z[1], any);
    r->z[0] = fmin(fmax(fmin(z[0], z[1]), lo), hi);
    r->z[1] = fmin(fmax(fmax(z[0], z[1]), lo), hi);
    return r->z[0] < r->z[1] || is_empty(p, "zmin", "\"zmax\" must exceed \"zmin\", inside of the shape");
}

static void set_line(bis_revolved *r, double x0, double z0, double x1, double z1)
{
    r->profile = BIS_PROFILE_LINE;
    r->p[0][0] = x0;
    r->p[0][2] = z0;
    r->p[1][0] = x1;
    r->p[1][2] = z1;
}

/* p1 and p2 of a hyperboloid. */
static void read_ends(bis_parser *p, bis_revolved *r)
{
    static const char *const names[2] = {"p1", "p2"};
    for (int i = 0; i < 2; i++) {
        const bis_param *param = bis_params_take(p, names[i], BIS_TYPE_POINT3, 3);
        for (size_t c = 0; c < 3; c++)
            r->p[i][c] = param ? p->params.numbers[param->first + c] : i;
    }
}

static bool read_sphere(bis_parser *p, bis_shape_desc *shape, bis_revolved *r)
{
    r->profile = BIS_PROFILE_CIRCLE;
    r->z[0] = -r->radius;
    r->z[1] = r->radius;
    const bool ok = read_heights(p, r, -r->radius, r->radius);
    if (!read_turn(p, r) || !ok) return false;
    if (r->phi_max_deg < 360 || r->z[0] > -r->radius || r->z[1] < r->radius) return add_revolved(p, shape, r);
    shape->kind = BIS_SHAPE_SPHERE;
    shape->radius = r->radius;
    return true;
}

static bool read_disk(bis_parser *p, bis_shape_desc *shape, bis_revolved *r)
{
    double inner = 0, height = 0;
    bis_params_float(p, "height", &height, any);
    bis_params_float(p, "innerradius", &inner, any);
    const bool ok = inner < r->radius || is_empty(p, "innerradius", "\"innerradius\" must be below \"radius\"");
    if (!read_turn(p, r) || !ok) return false;
    if (r->phi_max_deg < 360 || inner > 0) {
        set_line(r, r->radius, height, fmax(inner, 0), height);
        return add_revolved(p, shape, r);
    }
    shape->kind = BIS_SHAPE_DISK;
    shape->radius = r->radius;
    shape->height = height;
    return true;
}

static bool read_paraboloid(bis_parser *p, bis_shape_desc *shape, bis_revolved *r)
{
    r->profile = BIS_PROFILE_PARABOLA;
    r->z[1] = 1;
    const bool ok = read_heights(p, r, 0, HUGE_VAL);
    return read_turn(p, r) && ok && add_revolved(p, shape, r);
}

static bool read_revolved(bis_parser *p, int made, bis_shape_desc *shape)
{
    bis_revolved r = {.radius = 1, .phi_max_deg = 360};
    double height = 1;

    if (made == BIS_MADE_HYPERBOLOID) {
        read_ends(p, &r);
        return read_turn(p, &r) && add_revolved(p, shape, &r);
    }
    bis_params_float(p, "radius", &r.radius, positive);
    if (made == BIS_MADE_SPHERE) return read_sphere(p, shape, &r);
    if (made == BIS_MADE_DISK) return read_disk(p, shape, &r);
    if (made == BIS_MADE_PARABOLOID) return read_paraboloid(p, shape, &r);
    bool ok = true;
    if (made == BIS_MADE_CYLINDER) {
        r.z[0] = -1;
        r.z[1] = 1;
        ok = read_heights(p, &r, -HUGE_VAL, HUGE_VAL);
        set_line(&r, r.radius, r.z[0], r.radius, r.z[1]);
    } else {
        bis_params_float(p, "height", &height, any);
        set_line(&r, r.radius, 0, 0, height);
    }
    return read_turn(p, &r) && ok && add_revolved(p, shape, &r);
}

/* ---- of points ---- */

/* What cannot be subdivided stays its control mesh with --approximate. */
static bool plan_levels(bis_parser *p, bis_mesh_desc *desc)
{
    bis_diag own = {0};
    const bis_status status = bis_make_subdivided_size(&desc->size, &desc->mesh, desc->levels, desc->loc, &own);
    bool ok = !status;

    if (status == BIS_INPUT && own.n) { /* without its place, which is at */
        ok = bis_approximate_or_refuse(p, desc->loc, "Shape \"loopsubdiv\" whose triangles do not form surfaces",
                                       "its control mesh: coarser, and a little too large", "%s",
                                       own.messages[0].body);
        desc->making = BIS_MAKING_NONE;
    } else if (status) bis_parser_nomem(p, desc->loc);
    bis_diag_clear(&own);
    return ok;
}

/* The mesh of an equal shape before, or SIZE_MAX: they are few, or of other sizes. */
static size_t find_equal(const bis_scene_desc *d, const bis_mesh_desc *of)
{
    const bis_mesh *m = &of->mesh;
    for (size_t i = d->n_meshes; i-- > 0;) {
        const bis_mesh_desc *x = &d->meshes[i];
        if (x->making == BIS_MAKING_SUBDIVIDED && x->levels == of->levels && x->mesh.n_vertices == m->n_vertices &&
            x->mesh.n_triangles == m->n_triangles && memcmp(x->mesh.p, m->p, m->n_vertices * sizeof *m->p) == 0 &&
            memcmp(x->mesh.index, m->index, 3 * m->n_triangles * sizeof *m->index) == 0)
            return i;
    }
    return SIZE_MAX;
}

static bool read_loop(bis_parser *p, bis_shape_desc *shape)
{
    static const char *const silent[] = {"scheme"}; /* pbrt-v3 does not look at it either */
    bis_mesh_desc desc = {.kind = BIS_SHAPE_TRIANGLES, .making = BIS_MAKING_SUBDIVIDED, .loc = shape->loc, .levels = 3};
    bis_mesh *m = &desc.mesh;
    bis_params_skip(p, silent, BIS_COUNT(silent));
    bis_params_uint32(p, bis_params_has(p, "nlevels") ? "nlevels" : "levels", &desc.levels, 0, BIS_MAKE_MAX_LEVELS);
    bool ok = bis_parser_points(p, "loopsubdiv", m) &&
              bis_parser_indices(p, "loopsubdiv", 3, m->n_vertices, &m->index, &m->n_triangles) &&
              plan_levels(p, &desc);
    const size_t equal = ok ? find_equal(p->desc, &desc) : SIZE_MAX;
    shape->kind = BIS_SHAPE_TRIANGLES;
    if (equal != SIZE_MAX) shape->mesh = (uint32_t)equal;
    else ok = ok && bis_parser_add_mesh(p, &desc, &shape->mesh);
    if (!ok || equal != SIZE_MAX) bis_mesh_clear(m);
    return ok;
}

static bool read_patches(bis_parser *p, bis_shape_desc *shape)
{
    bis_mesh m = {0};
    uint32_t *corner = NULL;
    size_t n;
    bool ok = bis_parser_points(p, "bilinearmesh", &m) &&
              bis_parser_indices(p, "bilinearmesh", 4, m.n_vertices, &corner, &n);
    if (ok) {
        const bis_status status = bis_make_patches(&m, (const uint32_t (*)[4])corner, n, shape->loc, p->diag);
        bis_parser_note(p, status);
        ok = !status && keep_mesh(p, shape, &m);
    } else {
        bis_mesh_clear(&m);
    }
    bis_free(corner);
    return ok;
}

/* "nu" or the like: an integer that the shape needs. */
static bool need_count(bis_parser *p, const char *shape, const char *name, size_t lo, size_t hi, size_t *n)
{
    uint64_t value;
    const bool given = bis_params_has(p, name);
    if (bis_params_integer(p, name, &value, lo, hi)) {
        *n = (size_t)value;
        return true;
    }
    return given ? false : bis_parser_error(p, p->name_at, "%s needs \"integer %s\"", shape, name);
}

/* So many numbers; NULL: complained. They stay until another parameter is asked for, because that may be a texture,
 * which becomes further numbers (bis_parser_convert). */
static const double *need_numbers(bis_parser *p, const char *shape, const char *name, unsigned type, size_t n)
{
    const bool given = bis_params_has(p, name);
    const bis_param *param = bis_params_take(p, name, type, 0);
    if (!param && !given) bis_parser_error(p, p->name_at, "%s needs \"%s\"", shape, name);
    if (!param) return NULL;
    if (param->n == n) return p->params.numbers + param->first;
    bis_parser_error(p, param->at, "\"%s\" has %zu values, must have %zu", name, param->n, n);
    return NULL;
}

static bool read_height_field(bis_parser *p, bis_shape_desc *shape)
{
    size_t n[2];
    bis_mesh m;
    const bool ok = need_count(p, "heightfield", "nu", 2, 1u << 15, &n[0]);
    if (!need_count(p, "heightfield", "nv", 2, 1u << 15, &n[1]) || !ok) return false;
    const double *z = need_numbers(p, "heightfield", "Pz", BIS_TYPE_FLOAT, n[0] * n[1]);
    if (!z) return false;
    const bis_status status = bis_make_height_field(&m, z, n[0], n[1], shape->loc, p->diag);
    bis_parser_note(p, status);
    return !status && keep_mesh(p, shape, &m);
}

/* ---- NURBS ---- */

static const char *const nurbs_names[2][5] = {{"nu", "uorder", "uknots", "u0", "u1"},
                                              {"nv", "vorder", "vknots", "v0", "v1"}};

/* One of the two parameters: its points, order and ends. Its knots are looked at, but may move before they are used. */
static bool read_parameter(bis_parser *p, bis_nurbs *s, int k)
{
    const char *const *name = nurbs_names[k];
    const bool ok = need_count(p, "nurbs", name[0], 1, 1u << 15, &s->n[k]);
    if (!need_count(p, "nurbs", name[1], 2, BIS_MAKE_MAX_ORDER, &s->order[k]) || !ok) return false;
    const size_t n = s->n[k], order = s->order[k];
    if (n < order)
        return bis_parser_error(p, bis_params_at(p, name[0]), "\"%s\" is %zu, must be at least \"%s\", %zu", name[0], n,
                                name[1], order);
    const double *knot = need_numbers(p, "nurbs", name[2], BIS_TYPE_FLOAT, n + order);
    if (!knot) return false;
    for (size_t i = 1; i < n + order; i++)
        if (knot[i] < knot[i - 1])
            return bis_parser_error(p, bis_params_at(p, name[2]), "\"%s\" falls from %g to %g: knots must not descend",
                                    name[2], knot[i - 1], knot[i]);
    const bis_interval inside = {knot[order - 1], knot[n], false, false};
    s->end[k][0] = inside.lo;
    s->end[k][1] = inside.hi;
    bis_params_float(p, name[3], &s->end[k][0], inside);
    bis_params_float(p, name[4], &s->end[k][1], inside);
    return inside.lo < inside.hi || is_empty(p, name[2], "its knots span nothing");
}

/* P, or Pw with weights. The caller frees *list, after a complaint, too. */
static bool read_net(bis_parser *p, bis_nurbs *s, double (**list)[4])
{
    const size_t n = s->n[0] * s->n[1];
    const bool weighted = !bis_params_has(p, "P");
    const size_t per = weighted ? 4 : 3;
    if (weighted && !bis_params_has(p, "Pw"))
        return bis_parser_error(p, p->name_at, "nurbs needs \"point3 P\", or \"float Pw\" of x w, y w, z w and w");
    const double *v = need_numbers(p, "nurbs", weighted ? "Pw" : "P", weighted ? BIS_TYPE_FLOAT : BIS_TYPE_POINT3,
                                   per * n);
    *list = v ? bis_alloc(n, sizeof **list) : NULL;
    if (!v) return false;
    if (!*list) return bis_parser_nomem(p, p->name_at);
    for (size_t i = 0; i < n; i++) {
        for (size_t c = 0; c < 4; c++) (*list)[i][c] = c < per ? v[per * i + c] : 1;
        if (!((*list)[i][3] > 0))
            return bis_parser_error(p, bis_params_at(p, "Pw"), "point %zu of \"Pw\" has the weight %g, must be > 0", i,
                                    (*list)[i][3]);
    }
    s->point = (const double (*)[4])*list;
    /* the last to be asked for was the net: from here on no number moves */
    for (int k = 0; k < 2; k++) s->knots[k] = p->params.numbers + bis_params_find(p, nurbs_names[k][2])->first;
    return true;
}

static bool read_nurbs(bis_parser *p, bis_shape_desc *shape)
{
    bis_nurbs s;
    double (*list)[4] = NULL;
    bis_mesh m;
    bool ok = read_parameter(p, &s, 0);

    ok = read_parameter(p, &s, 1) && ok && read_net(p, &s, &list);
    if (ok) {
        const bis_status status = bis_make_nurbs(&m, &s, shape->loc, p->diag);
        bis_parser_note(p, status);
        ok = !status && keep_mesh(p, shape, &m);
    }
    bis_free(list);
    return ok;
}

bool bis_parser_made(bis_parser *p, int made, bis_shape_desc *shape)
{
    switch (made) {
    case BIS_MADE_LOOP:
        return read_loop(p, shape);
    case BIS_MADE_PATCHES:
        return read_patches(p, shape);
    case BIS_MADE_HEIGHTS:
        return read_height_field(p, shape);
    case BIS_MADE_NURBS:
        return read_nurbs(p, shape);
    default:
        return read_revolved(p, made, shape);
    }
}
