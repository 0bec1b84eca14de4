/* parser_shapes: Shape, docs/scene-format.md, "Shape".
 *
 * Files are only looked for, not read: bis_scene_build reads each of them once, however many shapes and instances name
 * it. The numbers of a "trianglemesh" are checked against one another here, where the place is known. */
#include "bis/base/file.h"
#include "base/grow.h"
#include "approximate.h"
#include "parser.h"

#include <string.h>

static const bis_interval positive = {0, HUGE_VAL, true, false};
static const bis_interval any = {-HUGE_VAL, HUGE_VAL, false, false};

/* ---- meshes ---- */

static bool add_mesh(bis_parser *p, const bis_mesh_desc *mesh, uint32_t *index)
{
    bis_scene_desc *d = p->desc;
    if (!BIS_ROOM(d->meshes, d->capacity_meshes, d->n_meshes) || d->n_meshes >= UINT32_MAX)
        return bis_parser_nomem(p, mesh->loc);
    *index = (uint32_t)d->n_meshes;
    d->meshes[d->n_meshes++] = *mesh;
    return true;
}

/* The mesh of a file: a new one, or the one that has been named before. Takes over path. */
static bool file_mesh(bis_parser *p, char *path, const bis_mesh_desc *desc, uint32_t *index)
{
    const size_t room = strlen(path) + 4;
    char *key = bis_alloc(room, 1); /* kind, smooth, parts, path */
    bis_mesh_desc mesh = *desc;
    bool ok = key != NULL;

    if (ok) snprintf(key, room, "%c%c%c%s", desc->kind == BIS_SHAPE_PLY ? 'p' : 'o', desc->smooth ? 's' : 'f',
                     desc->has_parts ? 'm' : '-', path);
    if (ok && bis_names_find(&p->mesh_names, key, index)) {
        bis_free(path);
    } else {
        mesh.filename = path;
        ok = ok && add_mesh(p, &mesh, index);
        if (!ok) bis_free(path);
        if (ok && !bis_names_set(&p->mesh_names, key, *index)) ok = false;
    }
    if (!ok && !p->stop) bis_parser_nomem(p, desc->loc);
    bis_free(key);
    return ok;
}

static bool read_file(bis_parser *p, bis_shape_desc *shape)
{
    const char *name;
    bis_mesh_desc mesh = {.kind = shape->kind};
    bis_params_bool(p, "smooth", &mesh.smooth);
    if (shape->kind == BIS_SHAPE_OBJ) bis_params_bool(p, "materials", &mesh.has_parts);
    const bool given = bis_params_has(p, "filename");
    const bis_loc at = bis_params_at(p, "filename");
    if (!bis_params_string(p, "filename", &name)) {
        if (!given) bis_parser_error(p, p->name_at, "Shape needs \"string filename\"");
        return false;
    }
    char *path = bis_parser_path(p, at, name);
    mesh.loc = at;
    return path && file_mesh(p, path, &mesh, &shape->mesh);
}

/* ---- trianglemesh ---- */

/* numbers as vectors, three each; NULL: complained. */
static vec3 *vectors(bis_parser *p, const bis_param *param, const char *name)
{
    const double *v = p->params.numbers + param->first;
    const size_t n = param->n / 3;
    if (param->n % 3) {
        bis_parser_error(p, param->at, "\"%s\" has %zu values, must have a multiple of 3", name, param->n);
        return NULL;
    }
    vec3 *out = bis_alloc(n, sizeof *out);
    if (!out) bis_parser_nomem(p, param->at);
    for (size_t i = 0; out && i < n; i++) out[i] = vec3_from(v[3 * i], v[3 * i + 1], v[3 * i + 2]);
    return out;
}

static bool check_index(bis_parser *p, const bis_param *param, size_t i, size_t n_points)
{
    char buf[32];
    const double v = p->params.numbers[param->first + i];
    if (v >= 0 && v < (double)n_points && v == floor(v)) return true;
    return bis_parser_error(p, param->at, "\"indices\" holds %s as its value %zu, must be a whole number in [0, %zu]",
                            bis_format_double(buf, v), i + 1, n_points - 1);
}

/* The three points of one triangle need no indices, as in pbrt. */
static bool read_indices(bis_parser *p, bis_mesh *m)
{
    const bool given = bis_params_has(p, "indices");
    const bis_param *param = bis_params_take(p, "indices", BIS_TYPE_INTEGER, 0);
    if (!param && given) return false;
    if (!param && m->n_vertices != 3)
        return bis_parser_error(p, p->name_at,
                                "trianglemesh needs \"integer indices\", unless it has 3 points; it has %zu",
                                m->n_vertices);
    const size_t n = param ? param->n : 3;
    if (n % 3)
        return bis_parser_error(p, param->at, "\"indices\" has %zu values, must have a multiple of 3", n);
    m->index = bis_alloc(n, sizeof *m->index);
    if (!m->index) return bis_parser_nomem(p, p->name_at);
    for (size_t i = 0; i < n; i++) {
        if (param && !check_index(p, param, i, m->n_vertices)) return false;
        m->index[i] = param ? (uint32_t)p->params.numbers[param->first + i] : (uint32_t)i;
    }
    m->n_triangles = n / 3;
    return true;
}

/* The patches of "bilinearmesh", with --approximate: two triangles each. */
static bool read_patches(bis_parser *p, bis_mesh *m)
{
    /* the corners of a patch are (0, 0), (1, 0), (0, 1), (1, 1) */
    static const uint32_t corner[6] = {0, 1, 3, 0, 3, 2};
    const bis_param *param = bis_params_take(p, "indices", BIS_TYPE_INTEGER, 0);
    const size_t n = param ? param->n : 4;

    if (n % 4 || (!param && m->n_vertices != 4))
        return bis_parser_error(p, p->name_at, "bilinearmesh needs \"integer indices\", four for a patch, unless it "
                                "has 4 points; it has %zu and %zu points", param ? n : 0, m->n_vertices);
    m->index = bis_alloc(n / 4 * 6, sizeof *m->index);
    if (!m->index) return bis_parser_nomem(p, p->name_at);
    for (size_t i = 0; i < n / 4 * 6; i++) {
        const size_t k = i / 6 * 4 + corner[i % 6];
        if (param && !check_index(p, param, k, m->n_vertices)) return false;
        m->index[i] = param ? (uint32_t)p->params.numbers[param->first + k] : (uint32_t)k;
    }
    m->n_triangles = n / 4 * 2;
    return true;
}

static bool read_normals(bis_parser *p, bis_mesh *m)
{
    const bool given = bis_params_has(p, "N");
    const bis_param *param = bis_params_take(p, "N", BIS_TYPE_NORMAL, 0);
    if (!param) return !given;
    if (param->n != 3 * m->n_vertices)
        return bis_parser_error(p, param->at, "\"N\" has %zu values, must have 3 for each of the %zu points", param->n,
                                m->n_vertices);
    m->n = vectors(p, param, "N");
    return m->n != NULL;
}

/* pbrt-v4's point2 uv, pbrt-v3's float uv or st. */
static bool read_uv(bis_parser *p, bis_mesh *m)
{
    const char *name = bis_params_has(p, "uv") ? "uv" : "st";
    const bool given = bis_params_has(p, name);
    const bis_param *param = bis_params_take(p, name, BIS_TYPE_POINT2 | BIS_TYPE_FLOAT, 0);
    if (!param) return !given;
    if (param->n != 2 * m->n_vertices)
        return bis_parser_error(p, param->at, "\"%s\" has %zu values, must have 2 for each of the %zu points", name,
                                param->n, m->n_vertices);
    m->uv = bis_alloc(m->n_vertices, sizeof *m->uv);
    if (!m->uv) return bis_parser_nomem(p, param->at);
    const double *v = p->params.numbers + param->first;
    for (size_t i = 0; i < m->n_vertices; i++) m->uv[i] = (bis_uv){(float)v[2 * i], (float)v[2 * i + 1]};
    return true;
}

/* patches: of four indices each, with --approximate. */
static bool read_triangles(bis_parser *p, bis_shape_desc *shape, bool patches)
{
    bis_mesh m = {0};
    const bool given = bis_params_has(p, "P");
    const bis_param *points = bis_params_take(p, "P", BIS_TYPE_POINT3, 0);
    bool ok = points != NULL;

    if (!given) bis_parser_error(p, p->name_at, "trianglemesh needs \"point3 P\"");
    if (ok) {
        m.p = vectors(p, points, "P");
        m.n_vertices = points->n / 3;
        ok = m.p != NULL;
    }
    if (ok && m.n_vertices > UINT32_MAX) ok = bis_parser_error(p, points->at, "more than 2^32 - 1 points");
    ok = ok && (patches ? read_patches(p, &m) : read_indices(p, &m)) && read_normals(p, &m) && read_uv(p, &m) &&
         add_mesh(p, &(bis_mesh_desc){.kind = BIS_SHAPE_TRIANGLES, .mesh = m, .loc = shape->loc}, &shape->mesh);
    if (!ok) {
        static const char *const rest[] = {"indices", "N"};
        bis_params_skip(p, rest, BIS_COUNT(rest)); /* not asked for, but known */
        bis_mesh_clear(&m);
    }
    return ok;
}

/* ---- sphere and disk ---- */

/* pbrt cuts pieces off its quadrics; ours are whole. */
static bool is_whole(bis_parser *p, const char *name, double whole, double given)
{
    char a[32], b[32], kind[32];
    if (given == whole) return true;
    snprintf(kind, sizeof kind, "\"%s\"", name);
    return bis_approximate_or_refuse(p, bis_params_at(p, name), kind, "spheres and disks are whole",
                                     "\"%s\" is %s: only whole spheres and disks are modelled (%s)", name,
                                     bis_format_double(a, given), bis_format_double(b, whole));
}

static bool read_quadric(bis_parser *p, bis_shape_desc *shape)
{
    double v;
    bool ok = true;
    shape->radius = 1;
    bis_params_float(p, "radius", &shape->radius, positive);
    if (bis_params_float(p, "phimax", &v, any)) ok = is_whole(p, "phimax", 360, v) && ok;
    if (shape->kind == BIS_SHAPE_SPHERE) {
        /* pbrt clamps z to the sphere: beyond it means all of it */
        const double r = shape->radius;
        if (bis_params_float(p, "zmin", &v, any)) ok = is_whole(p, "zmin", -r, fmax(v, -r)) && ok;
        if (bis_params_float(p, "zmax", &v, any)) ok = is_whole(p, "zmax", r, fmin(v, r)) && ok;
    } else {
        bis_params_float(p, "height", &shape->height, any);
        if (bis_params_float(p, "innerradius", &v, any)) ok = is_whole(p, "innerradius", 0, v) && ok;
    }
    return ok;
}

/* ---- Shape ---- */

void bis_parser_drop_uv(bis_parser *p)
{
    bis_scene_desc *d = p->desc;
    bool some = false;
    for (size_t i = 0; i < d->n_meshes; i++) some |= d->meshes[i].mesh.uv != NULL;
    bool *is_used = some ? bis_alloc(d->n_meshes, sizeof *is_used) : NULL;
    if (some && !is_used) bis_parser_nomem(p, (bis_loc){d->files[0], 0, 0});
    if (!is_used) return;
    for (size_t i = 0; i < d->n_shapes; i++) {
        const bis_shape_desc *s = &d->shapes[i];
        if (s->kind == BIS_SHAPE_TRIANGLES && bis_textures_of(&d->textures, s->material)) is_used[s->mesh] = true;
    }
    for (size_t i = 0; i < d->n_meshes; i++) {
        if (is_used[i]) continue;
        bis_free(d->meshes[i].mesh.uv);
        d->meshes[i].mesh.uv = NULL;
    }
    bis_free(is_used);
}

static bool has_parts(const bis_parser *p, const bis_shape_desc *shape)
{
    return shape->kind == BIS_SHAPE_OBJ && p->desc->meshes[shape->mesh].has_parts;
}

void bis_directive_shape(bis_parser *p, bis_loc at)
{
    static const bis_choice shapes[] = {
        {"plymesh", BIS_SHAPE_PLY},      {"objmesh", BIS_SHAPE_OBJ}, {"trianglemesh", BIS_SHAPE_TRIANGLES},
        {"sphere", BIS_SHAPE_SPHERE},    {"disk", BIS_SHAPE_DISK},   {"bilinearmesh", BIS_FOREIGN},
        {"cone", BIS_FOREIGN},           {"curve", BIS_FOREIGN},     {"cylinder", BIS_FOREIGN},
        {"heightfield", BIS_FOREIGN},    {"hyperboloid", BIS_FOREIGN}, {"loopsubdiv", BIS_FOREIGN},
        {"nurbs", BIS_FOREIGN},          {"paraboloid", BIS_FOREIGN},
    };
    /* what changes nothing here: texture coordinates that are of no use, tangents, and numbers of faces for other
     * textures */
    static const char *const silent[] = {"uv", "st", "S", "faceIndices"};
    static const char *const ignored[] = {"alpha", "shadowalpha"};

    const bis_choice *chosen = bis_parser_begin(p, "Shape", shapes, BIS_COUNT(shapes));
    if (!chosen) return;
    const bool patches = strcmp(chosen->name, "bilinearmesh") == 0;
    if (chosen->value == BIS_FOREIGN && !patches && strcmp(chosen->name, "loopsubdiv") != 0) return; /* left out */
    if (p->approximate && (bis_params_has(p, "alpha") || bis_params_has(p, "shadowalpha")))
        bis_approximate_note(p, at, "the shape has no holes", "\"alpha\" of Shape \"%s\"", chosen->name);
    bis_shape_desc shape = {
        .kind = chosen->value == BIS_FOREIGN ? BIS_SHAPE_TRIANGLES : (bis_shape_kind)chosen->value,
        .to_world = p->now.ctm, .material = p->now.material, .loc = at};
    bool ok;
    if (shape.kind == BIS_SHAPE_TRIANGLES) ok = read_triangles(p, &shape, patches);
    else if (shape.kind == BIS_SHAPE_SPHERE || shape.kind == BIS_SHAPE_DISK) ok = read_quadric(p, &shape);
    else ok = read_file(p, &shape);
    bis_params_skip(p, silent, BIS_COUNT(silent));
    bis_params_ignore(p, ignored, BIS_COUNT(ignored));
    bis_params_end(p, "Shape", chosen->name);
    if (ok && has_parts(p, &shape)) bis_parser_add_parts(p, &shape);
    else if (ok) bis_parser_add_shape(p, &shape);
}
