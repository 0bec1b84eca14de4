/* SPDX-License-Identifier: BSD-2-Clause */
/* ply: the body of a PLY file, element by element, as the header describes it.
 *
 * One road for everything: a row is a sequence of numbers, each taken as a double (which holds every type exactly), in
 * ascii or in either byte order. Two short cuts, for what nearly all large files contain, in native byte order: rows of
 * plain floats, and lists of three 4-byte indices behind a 1-byte count (871k triangles: 25 ms with, 60 ms without
 * them).
 * Nothing is allocated by the header's word alone: an element's count times its least row must fit into what is left of
 * the file. Faces become fans and strips as their rows come by (polygon.h). */
#include "ply.h"

#include "bis/base/file.h"
#include "base/grow.h"
#include "corners.h"
#include "gzip.h"
#include "ply_header.h"
#include "polygon.h"

#include <float.h>
#include <string.h>

enum { X, Y, Z, NX, NY, NZ, U, V, N_ROLES, NAMES = 4 };

/* The names of U and V are pbrt's; the first that occurs counts. */
static const char *const role_names[N_ROLES][NAMES] = {
    {"x"}, {"y"}, {"z"}, {"nx"}, {"ny"}, {"nz"}, {"u", "s", "texture_u", "texture_s"},
    {"v", "t", "texture_v", "texture_t"},
};

/* The state of reading. */
typedef struct reader {
    const mesh_input *in;
    const ply_header *header;
    const unsigned char *p, *end;
    bis_mesh *mesh;
    int n_roles;         /* those that are wanted: without texture coordinates U */
    size_t capacity;     /* of mesh->index, in triangles */
    size_t n_vertices;   /* as the header says: faces may come first */
    size_t n_too_small;  /* faces of fewer than 3 vertices */
    size_t n_bad_normals;
    size_t n_bad_uv;
    size_t n_long_lines; /* ascii rows with more numbers than the header says */
    uint32_t *corners;   /* of one face */
    size_t n_corners, capacity_corners;
    double *texcoord;    /* its list of this name: u and v of each corner */
    size_t n_texcoord, capacity_texcoord;
    bis_uv *first_uv;    /* first_uv[n_vertices]: of the first corner of each; NULL: no face has had any */
    split_corners further; /* (vertex, bits of u, bits of v), numbered behind the file's vertices */
    size_t n_bad_texcoord; /* lists of another length than the corners ask */
    double texnumber;      /* of the last face; the first has made it has_texnumber */
    bool has_texnumber, has_texnumbers;
    polygons polygons;
    bis_status status;   /* of the first error: from then on nothing is taken */
} reader;

/* ---- numbers ---- */

static bool is_space(unsigned char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

static bool machine_is_little(void)
{
    const uint16_t one = 1;
    unsigned char first;

    memcpy(&first, &one, 1);
    return first == 1;
}

static bool is_native(const ply_header *h) { return h->format == (machine_is_little() ? PLY_LITTLE : PLY_BIG); }

/* The binary number at p. */
static double decode(const unsigned char *p, ply_type type, bool big)
{
    const size_t n = ply_size(type);
    uint64_t bits = 0;

    for (size_t i = 0; i < n; i++) bits |= (uint64_t)p[i] << 8 * (big ? n - 1 - i : i);
    switch (type) {
    case PLY_I8:
        return (int8_t)bits;
    case PLY_I16:
        return (int16_t)bits;
    case PLY_I32:
        return (int32_t)bits;
    case PLY_F32: {
        const uint32_t half = (uint32_t)bits;
        float v;
        memcpy(&v, &half, sizeof v);
        return (double)v;
    }
    case PLY_F64: {
        double v;
        memcpy(&v, &bits, sizeof v);
        return v;
    }
    default:
        return (double)bits;
    }
}

static double cut_off(reader *r, const ply_element *e, size_t row)
{
    r->status = bis_mesh_refuse(r->in, 0, BIS_INPUT, "the file ends in %.*s %zu of %zu", e->name.length, e->name.text,
                                row, e->count);
    return 0;
}

/* The next number of the file; 0 after an error. e and row are for the message. */
static double take(reader *r, ply_type type, const ply_element *e, size_t row)
{
    if (r->status) return 0;
    if (r->header->format != PLY_ASCII) {
        if ((size_t)(r->end - r->p) < ply_size(type)) return cut_off(r, e, row);
        const unsigned char *number = r->p;
        r->p += ply_size(type);
        return decode(number, type, r->header->format == PLY_BIG);
    }
    while (r->p < r->end && is_space(*r->p)) r->p++;
    if (r->p == r->end) return cut_off(r, e, row);
    const char *stop, *start = (const char *)r->p;
    const double v = bis_parse_double(start, &stop);
    r->p = (const unsigned char *)stop;
    if (stop > start && (r->p == r->end || is_space(*r->p))) return v;
    int length = 0;
    while (length < 32 && start[length] > ' ') length++;
    r->status = bis_mesh_refuse(r->in, bis_mesh_line(r->in, (const unsigned char *)start), BIS_INPUT,
                                "\"%.*s\" where a number of %.*s %zu should stand", length, start, e->name.length,
                                e->name.text, row);
    return 0;
}

/* A list's count. */
static size_t take_count(reader *r, const ply_property *p, const ply_element *e, size_t row)
{
    const double v = take(r, p->count_type, e, row);

    if (v >= 0 && v <= (double)UINT32_MAX && v == floor(v)) return (size_t)v;
    r->status = bis_mesh_refuse(r->in, 0, BIS_INPUT, "%.*s %zu: the list \"%.*s\" has %g items", e->name.length,
                                e->name.text, row, p->name.length, p->name.text, v);
    return 0;
}

static void skip_property(reader *r, const ply_property *p, const ply_element *e, size_t row)
{
    const size_t n = ply_is_list(p) ? take_count(r, p, e, row) : 1;
    for (size_t i = 0; i < n && !r->status; i++) take(r, p->type, e, row);
}

/* In ascii a row begins on a new line, and what else is on its last line is skipped: VCGLIB has written files with more
 * numbers in a row than their headers say. */
static void end_row(reader *r)
{
    if (r->header->format != PLY_ASCII) return;
    while (r->p < r->end && (*r->p == ' ' || *r->p == '\t')) r->p++;
    if (r->p < r->end && *r->p != '\n' && *r->p != '\r') r->n_long_lines++;
    while (r->p < r->end && *r->p != '\n' && *r->p != '\r') r->p++;
}

/* ---- vertices ---- */

/* The last property of that name, or SIZE_MAX. */
static size_t find_property(const ply_header *h, const ply_element *e, const char *name)
{
    for (size_t i = e->n_properties; i-- > 0;) {
        const ply_property *p = &h->properties[e->first_property + i];
        if (!ply_is_list(p) && ply_word_is(p->name, name)) return i;
    }
    return SIZE_MAX;
}

/* Which role, if any, each property has; the index of each role's property, or SIZE_MAX. */
static void find_roles(const reader *r, const ply_element *e, size_t property[N_ROLES])
{
    for (int role = 0; role < N_ROLES; role++) {
        property[role] = SIZE_MAX;
        for (int i = 0; i < NAMES && role < r->n_roles && role_names[role][i] && property[role] == SIZE_MAX; i++)
            property[role] = find_property(r->header, e, role_names[role][i]);
    }
}

static void take_vertex(reader *r, const ply_element *e, size_t row, const size_t property[N_ROLES], double v[N_ROLES])
{
    for (size_t i = 0; i < e->n_properties; i++) {
        const ply_property *p = &r->header->properties[e->first_property + i];
        int role = 0;
        while (role < r->n_roles && property[role] != i) role++;
        if (role < r->n_roles) v[role] = take(r, p->type, e, row);
        else skip_property(r, p, e, row);
    }
}

static bool fits_float(double v) { return fabs(v) <= (double)FLT_MAX; }

static void store_uv(reader *r, size_t row, double u, double v)
{
    if (fits_float(u) && fits_float(v)) {
        r->mesh->uv[row] = (bis_uv){(float)u, (float)v};
        return;
    }
    r->mesh->uv[row] = (bis_uv){NAN, 0};
    r->n_bad_uv++;
}

static void store_vertex(reader *r, size_t row, const double v[N_ROLES])
{
    for (int i = X; i <= Z && !r->status; i++)
        if (!fits_float(v[i]))
            r->status = bis_mesh_refuse(r->in, 0, BIS_INPUT, "vertex %zu has %s = %g, must be a finite float", row,
                                        role_names[i][0], v[i]);
    if (r->status) return;
    r->mesh->p[row] = vec3_from(v[X], v[Y], v[Z]);
    if (r->mesh->uv) store_uv(r, row, v[U], v[V]);
    if (!r->mesh->n) return;
    if (fits_float(v[NX]) && fits_float(v[NY]) && fits_float(v[NZ]))
        r->mesh->n[row] = vec3_from(v[NX], v[NY], v[NZ]);
    else r->n_bad_normals++; /* stays (0,0,0) */
}

/* Short cut: the row is float x, y, z, of which none is a list, because those have no role. Stops at a vertex that is
 * not finite, for the long road to complain about. */
static size_t copy_plain_vertices(reader *r, const ply_element *e)
{
    const ply_property *p = &r->header->properties[e->first_property];
    const bool plain = is_native(r->header) && e->n_properties == 3 && p[0].type == PLY_F32 && p[1].type == PLY_F32 &&
                       p[2].type == PLY_F32 && ply_word_is(p[0].name, "x") && ply_word_is(p[1].name, "y") &&
                       ply_word_is(p[2].name, "z");
    size_t row = 0;

    for (; plain && row < e->count; row++, r->p += sizeof(vec3)) {
        memcpy(&r->mesh->p[row], r->p, sizeof(vec3));
        if (!vec3_is_finite(r->mesh->p[row])) break;
    }
    return row;
}

static bis_status read_vertices(reader *r, const ply_element *e)
{
    bis_mesh *m = r->mesh;
    size_t property[N_ROLES];

    if (m->p) return bis_mesh_refuse(r->in, 0, BIS_INPUT, "the element \"vertex\" occurs twice");
    find_roles(r, e, property);
    for (int i = X; i <= Z; i++)
        if (property[i] == SIZE_MAX)
            return bis_mesh_refuse(r->in, 0, BIS_INPUT, "a vertex has no property \"%s\"", role_names[i][0]);
    const bool normals = property[NX] != SIZE_MAX && property[NY] != SIZE_MAX && property[NZ] != SIZE_MAX;
    const bool uv = property[U] != SIZE_MAX && property[V] != SIZE_MAX;
    m->p = bis_alloc(e->count, sizeof *m->p);
    if (normals) m->n = bis_alloc(e->count, sizeof *m->n);
    if (uv) m->uv = bis_alloc(e->count, sizeof *m->uv);
    if (!m->p || (normals && !m->n) || (uv && !m->uv))
        return bis_mesh_refuse(r->in, 0, BIS_NOMEM, "no memory for %zu vertices", e->count);
    m->n_vertices = e->count;
    for (size_t row = copy_plain_vertices(r, e); row < e->count; row++) {
        double v[N_ROLES];
        take_vertex(r, e, row, property, v);
        store_vertex(r, row, v);
        if (r->status) break;
        end_row(r);
    }
    return r->status;
}

/* ---- faces and strips ---- */

/* v as the number of a vertex; 0 after an error. */
static uint32_t index_of(reader *r, const ply_element *e, size_t row, double v)
{
    if (r->status) return 0;
    if (v >= 0 && v < (double)r->n_vertices && v == floor(v)) return (uint32_t)v;
    r->status = bis_mesh_refuse(r->in, 0, BIS_INPUT, "%.*s %zu has the index %.15g, but there are %zu vertices",
                                e->name.length, e->name.text, row, v, r->n_vertices);
    return 0;
}

static void no_memory(reader *r, const ply_element *e)
{
    r->status = bis_mesh_refuse(r->in, 0, BIS_NOMEM, "no memory for %zu rows of \"%.*s\"", e->count, e->name.length,
                                e->name.text);
}

static void read_corners(reader *r, const ply_property *p, const ply_element *e, size_t row)
{
    const size_t count = take_count(r, p, e, row);

    for (r->n_corners = 0; r->n_corners < count && !r->status; r->n_corners++) {
        const uint32_t v = index_of(r, e, row, take(r, p->type, e, row));
        if (!BIS_ROOM(r->corners, r->capacity_corners, r->n_corners)) no_memory(r, e);
        else r->corners[r->n_corners] = v;
    }
}

static void read_texcoord(reader *r, const ply_property *p, const ply_element *e, size_t row)
{
    const size_t count = take_count(r, p, e, row);

    for (r->n_texcoord = 0; r->n_texcoord < count && !r->status; r->n_texcoord++) {
        const double v = take(r, p->type, e, row);
        if (!BIS_ROOM(r->texcoord, r->capacity_texcoord, r->n_texcoord)) no_memory(r, e);
        else r->texcoord[r->n_texcoord] = v;
    }
}

/* MeshLab numbers the textures of faces; -1: none. */
static void read_texnumber(reader *r, const ply_property *p, const ply_element *e, size_t row)
{
    const double v = take(r, p->type, e, row);

    r->has_texnumbers |= r->has_texnumber && v >= 0 && v != r->texnumber;
    if (v < 0) return;
    r->has_texnumber = true;
    r->texnumber = v;
}

/* No coordinates are NAN; no corner yet is INFINITY, which no coordinates are. */
static bool start_texcoord(reader *r)
{
    if (r->first_uv) return true;
    r->first_uv = bis_alloc(r->n_vertices, sizeof *r->first_uv);
    for (size_t i = 0; r->first_uv && i < r->n_vertices; i++) r->first_uv[i] = (bis_uv){INFINITY, 0};
    return r->first_uv != NULL;
}

/* The vertex of corner i with the coordinates of the list: the first keeps the number of the file. */
static uint32_t split_vertex(reader *r, size_t i, const ply_element *e)
{
    const uint32_t v = r->corners[i];
    const double *c = r->n_texcoord ? &r->texcoord[2 * i] : (double[]){(double)NAN, 0};
    const bool good = fits_float(c[0]) && fits_float(c[1]);
    const bis_uv uv = good ? (bis_uv){(float)c[0], (float)c[1]} : (bis_uv){NAN, 0};
    uint32_t bits[2];

    r->n_bad_uv += !good && r->n_texcoord;
    if (isinf(r->first_uv[v].u)) r->first_uv[v] = uv;
    if (memcmp(&r->first_uv[v], &uv, sizeof uv) == 0) return v;
    memcpy(bits, &uv, sizeof bits);
    split_corner *further = bis_corners_find(&r->further, v, bits[0], bits[1]);
    if (!further || r->n_vertices + r->further.n >= UINT32_MAX) {
        no_memory(r, e);
        return 0;
    }
    if (further->vertex == CORNER_FREE) further->vertex = (uint32_t)(r->n_vertices + r->further.n - 1);
    return further->vertex;
}

/* The fan of a row's corners about the first one, for now (polygon.h). */
static void add_polygon(reader *r, const ply_element *e)
{
    const size_t first = r->mesh->n_triangles;
    bool splits = r->n_texcoord > 0 || r->first_uv;

    r->n_too_small += r->n_corners < 3;
    if (r->n_texcoord && r->n_texcoord != 2 * r->n_corners) {
        r->n_bad_texcoord++;
        r->n_texcoord = 0;
    }
    if (splits && !start_texcoord(r)) no_memory(r, e);
    for (size_t i = 0; i < r->n_corners && splits && !r->status; i++) r->corners[i] = split_vertex(r, i, e);
    for (size_t i = 2; i < r->n_corners && !r->status; i++)
        r->status = bis_mesh_add_triangle(r->mesh, &r->capacity,
                                          (uint32_t[]){r->corners[0], r->corners[i - 1], r->corners[i]}, r->in);
    if (!r->status && !bis_polygons_note(&r->polygons, r->mesh, first)) no_memory(r, e);
}

/* Each vertex makes a triangle with the two before it; every other one is turned. -1 begins a new strip. */
static void read_strip(reader *r, const ply_property *p, const ply_element *e, size_t row)
{
    const size_t count = take_count(r, p, e, row);
    uint32_t last[2] = {0, 0};
    size_t length = 0;

    for (size_t i = 0; i < count && !r->status; i++) {
        const double v = take(r, p->type, e, row);
        if (v == -1) {
            length = 0;
            continue;
        }
        const uint32_t current = index_of(r, e, row, v);
        const bool turned = length % 2 == 1;
        const uint32_t corner[3] = {last[turned], last[!turned], current};
        if (length >= 2 && !r->status) r->status = bis_mesh_add_triangle(r->mesh, &r->capacity, corner, r->in);
        last[0] = last[1];
        last[1] = current;
        length++;
    }
}

/* Short cut: rows that are a list of three indices and nothing else. Stops at the first other row. */
static size_t copy_plain_triangles(reader *r, const ply_element *e)
{
    const ply_property *p = &r->header->properties[e->first_property];
    const bool plain = is_native(r->header) && e->n_properties == 1 && ply_size(p->count_type) == 1 &&
                       (p->type == PLY_I32 || p->type == PLY_U32);
    size_t row = 0;

    for (; plain && row < e->count && r->end - r->p >= 13 && *r->p == 3; row++, r->p += 13) {
        uint32_t v[3];
        memcpy(v, r->p + 1, sizeof v);
        if (v[0] >= r->n_vertices || v[1] >= r->n_vertices || v[2] >= r->n_vertices) break;
        memcpy(r->mesh->index + 3 * r->mesh->n_triangles++, v, sizeof v);
    }
    return row;
}

/* Which property lists the corners; n_properties: none. An element may have no properties at all, and a header none to
 * point at. */
static size_t find_indices(const ply_header *h, const ply_element *e)
{
    for (size_t i = 0; i < e->n_properties; i++) {
        const ply_property *p = &h->properties[e->first_property + i];
        if (ply_is_list(p) && (ply_word_is(p->name, "vertex_indices") || ply_word_is(p->name, "vertex_index")))
            return i;
    }
    return e->n_properties;
}

static bis_status read_faces(reader *r, const ply_element *e, bool strips)
{
    const size_t list = find_indices(r->header, e);
    size_t row = 0;

    if (list == e->n_properties)
        return bis_mesh_refuse(r->in, 0, BIS_INPUT, "the element \"%.*s\" has no list \"vertex_indices\"",
                               e->name.length, e->name.text);
    if (!strips && !r->mesh->index) {
        r->mesh->index = bis_alloc(e->count, 3 * sizeof *r->mesh->index);
        if (!r->mesh->index) return bis_mesh_refuse(r->in, 0, BIS_NOMEM, "no memory for %zu triangles", e->count);
        r->capacity = e->count;
        row = copy_plain_triangles(r, e);
    }
    for (; row < e->count && !r->status; row++) {
        r->n_texcoord = 0;
        for (size_t i = 0; i < e->n_properties; i++) {
            const ply_property *p = &r->header->properties[e->first_property + i];
            const bool of_faces = r->n_roles > U && !strips;
            if (i == list && strips) read_strip(r, p, e, row);
            else if (i == list) read_corners(r, p, e, row);
            else if (of_faces && ply_is_list(p) && ply_word_is(p->name, "texcoord")) read_texcoord(r, p, e, row);
            else if (of_faces && !ply_is_list(p) && ply_word_is(p->name, "texnumber")) read_texnumber(r, p, e, row);
            else skip_property(r, p, e, row);
        }
        if (!strips && !r->status) add_polygon(r, e);
        end_row(r);
    }
    return r->status;
}

/* Positions and normals of split vertices, and the coordinates of all. */
static void finish_corners(reader *r)
{
    bis_mesh *m = r->mesh;
    const size_t n = m->n_vertices + r->further.n;
    vec3 *p = r->first_uv ? bis_realloc(m->p, n, sizeof *p) : NULL, *normals = NULL;

    if (!r->first_uv) return;
    if (p) m->p = p;
    if (m->n) normals = bis_realloc(m->n, n, sizeof *normals);
    if (normals) m->n = normals;
    bis_uv *uv = bis_realloc(r->first_uv, n, sizeof *uv);
    if (uv) r->first_uv = uv;
    if (!p || (m->n && !normals) || !uv) {
        r->status = bis_mesh_refuse(r->in, 0, BIS_NOMEM, "no memory for %zu vertices", n);
        return;
    }
    for (size_t i = 0; i < m->n_vertices; i++)
        if (isinf(uv[i].u)) uv[i] = (bis_uv){NAN, 0};
    for (size_t i = 0; i < r->further.size; i++) {
        const split_corner *c = &r->further.table[i];
        if (c->vertex == CORNER_FREE) continue;
        m->p[c->vertex] = m->p[c->v];
        if (m->n) m->n[c->vertex] = m->n[c->v];
        memcpy(&uv[c->vertex], (uint32_t[]){c->a, c->b}, sizeof *uv);
    }
    bis_free(m->uv);
    m->uv = uv;
    m->n_vertices = n;
    r->first_uv = NULL;
}

/* ---- elements ---- */

static bis_status skip_element(reader *r, const ply_element *e)
{
    /* Without properties a row is empty, and there may be 2^64 of them. */
    for (size_t row = 0; row < e->count && e->n_properties > 0 && !r->status; row++) {
        for (size_t i = 0; i < e->n_properties; i++)
            skip_property(r, &r->header->properties[e->first_property + i], e, row);
        end_row(r);
    }
    return r->status;
}

static bis_status read_element(reader *r, const ply_element *e)
{
    const size_t least = bis_ply_least_row(r->header, e), left = (size_t)(r->end - r->p);
    const size_t lacks = r->header->format == PLY_ASCII; /* the last white space may lack */

    if (least > 0 && e->count > (left + lacks) / least)
        return bis_mesh_refuse(r->in, 0, BIS_INPUT,
                               "%zu rows of \"%.*s\" of at least %zu bytes each, but the file has %zu bytes left",
                               e->count, e->name.length, e->name.text, least, left);
    if (e->count == 0) return BIS_OK;
    if (ply_word_is(e->name, "vertex")) return read_vertices(r, e);
    if (ply_word_is(e->name, "face")) return read_faces(r, e, false);
    if (ply_word_is(e->name, "tristrips")) return read_faces(r, e, true);
    return skip_element(r, e);
}

static bis_status count_vertices(reader *r)
{
    for (size_t i = 0; i < r->header->n_elements; i++)
        if (ply_word_is(r->header->elements[i].name, "vertex")) r->n_vertices = r->header->elements[i].count;
    if (r->n_vertices < UINT32_MAX) return BIS_OK;
    return bis_mesh_refuse(r->in, 0, BIS_INPUT, "%zu vertices, must be below 2^32 - 1", r->n_vertices);
}

static void report(const reader *r)
{
    if (r->n_long_lines > 0)
        bis_mesh_remark(r->in, "%zu lines hold more numbers than the header says: the rest of them is skipped",
                        r->n_long_lines);
    if (r->n_too_small > 0)
        bis_mesh_remark(r->in, "%zu faces have fewer than 3 vertices and are left out", r->n_too_small);
    if (r->n_bad_normals > 0)
        bis_mesh_remark(r->in, "%zu vertex normals are not finite: the faces' normals are used there",
                        r->n_bad_normals);
    if (r->n_bad_uv > 0)
        bis_mesh_remark(r->in, "%zu texture coordinates are not finite: triangles there get (0,0), (1,0), (1,1)",
                        r->n_bad_uv);
    if (r->n_bad_texcoord > 0)
        bis_mesh_remark(r->in, "%zu faces have a \"texcoord\" that is not two numbers for each corner: they get (0,0), "
                        "(1,0), (1,1)", r->n_bad_texcoord);
    if (r->has_texnumbers)
        bis_mesh_remark(r->in, "faces have different numbers of textures (\"texnumber\"), but a PLY has one material "
                        "here: all show its textures. Split the mesh, or save it as OBJ with its materials");
}

static bis_status read_ply(bis_mesh *m, const char *path, int n_roles, bis_loc at, bis_diag *diag)
{
    unsigned char *data = NULL;
    mesh_input in = {.path = path, .at = at, .diag = diag};
    ply_header header = {0};
    bis_status status;

    *m = (bis_mesh){0};
    status = bis_gzip_read(&data, &in.size, path, at, diag);
    if (status) goto done;
    in.data = data;
    status = bis_ply_header_read(&header, &in);
    if (status) goto done;
    reader r = {.in = &in, .header = &header, .p = header.body, .end = in.data + in.size, .mesh = m,
                .n_roles = n_roles};
    status = count_vertices(&r);
    for (size_t i = 0; !status && i < header.n_elements; i++) status = read_element(&r, &header.elements[i]);
    if (!status) finish_corners(&r);
    if (!status) status = r.status;
    if (!status) status = bis_polygons_triangulate(m, &r.polygons, &in);
    if (!status) report(&r);
    if (!status) status = bis_mesh_finish(m, r.capacity, &in);
    bis_free(r.corners);
    bis_free(r.texcoord);
    bis_free(r.first_uv);
    bis_free(r.further.table);
    bis_free(r.polygons.list);
done:
    if (status) bis_mesh_clear(m);
    bis_ply_header_clear(&header);
    bis_free(data);
    return status;
}

bis_status bis_ply_read(bis_mesh *m, const char *path, bis_loc at, bis_diag *diag)
{
    return read_ply(m, path, U, at, diag);
}

bis_status bis_ply_read_uv(bis_mesh *m, const char *path, bis_loc at, bis_diag *diag)
{
    return read_ply(m, path, N_ROLES, at, diag);
}
