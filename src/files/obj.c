/* SPDX-License-Identifier: BSD-2-Clause */
/* obj: two passes over the lines. The first counts v, vt and vn, so that arrays are allocated once and a face may name
 * a vertex that comes later; the second reads.
 *
 * Normals and texture coordinates are indexed apart from positions, our meshes have one index: each (v, vt, vn) becomes
 * a vertex. The first of v keeps number v, further ones get numbers behind the file's, found again by a hash table.
 * O(n) in all. Where no texture coordinates are wanted, vt is 0 in all of them, and the vertices are the pairs (v, vn).
 * A line may go on behind a backslash. Source: Wavefront's appendix B1, "Object files", and the files of the wild. */
#include "obj.h"

#include "bis/base/file.h"
#include "gzip.h"
#include "base/grow.h"
#include "base/names.h"
#include "corners.h"
#include "mesh_io.h"
#include "polygon.h"

#include <float.h>
#include <string.h>

/* No normal: in a face's corner, and for a vertex that no corner has taken yet. */
enum { NONE = 0, FREE = CORNER_FREE };

typedef struct reader {
    mesh_input in;
    const unsigned char *p, *end;
    int line;
    bis_mesh *mesh;
    size_t capacity_triangles, capacity_vertices;
    bool wants_uv;
    size_t n_v, n_vt, n_vn;     /* of the whole file; n_vt: 0 where none are wanted */
    size_t seen_v, seen_vt, seen_vn; /* so far: negative indices count from here */
    vec3 *normals;              /* normals[n_vn], as in the file */
    bis_uv *uv;                 /* uv[n_vt], as in the file */
    /* first_vn[n_v]: the normal of vertex v's own corner, or FREE; NULL: no normals in the file. first_vt[n_v]: the
     * same for texture coordinates, FREE where first_vn is */
    uint32_t *first_vn, *first_vt;
    split_corners further;      /* (v, vt, vn), where vt and vn count from 1, NONE for none */
    polygons polygons;
    bool any_normal, any_uv;    /* does a face use one? */
    bool lacks_normals;         /* does one use a normal where the file has none at all? */
    bool wants_parts;
    bis_names parts;            /* of usemtl, with numbers from 1 */
    uint32_t part;              /* of the faces that come */
    size_t capacity_part;
    size_t n_too_small;         /* faces of fewer than 3 corners */
    size_t n_bad_normals, n_bad_uv;
    size_t n_lost;              /* indices of a vt or vn that is not there */
    bis_status status;          /* of the first error: from then on nothing is read */
} reader;

/* ---- words ---- */

static bool is_blank(unsigned char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f'; }
static bool is_line_end(const reader *r) { return r->p == r->end || *r->p == '\n' || *r->p == '\r'; }

/* Over blanks, and over a backslash with the line's end behind it. */
static void skip_blanks(reader *r)
{
    for (;;) {
        while (r->p < r->end && is_blank(*r->p)) r->p++;
        if (r->p == r->end || *r->p != '\\' || (r->p[1] != '\n' && r->p[1] != '\r')) return;
        r->p += r->p[1] == '\r' && r->p[2] == '\n' ? 3 : 2;
        r->line++;
    }
}

/* To the start of the next line, also over continued ones. */
static void skip_line(reader *r)
{
    for (;;) {
        while (!is_line_end(r)) r->p++;
        if (r->p == r->end) return;
        const bool continued = r->p > r->in.data && r->p[-1] == '\\';
        r->p += r->p[0] == '\r' && r->p[1] == '\n' ? 2 : 1;
        r->line++;
        if (!continued) return;
    }
}

/* Is the line's first word this one? Then p stands behind it. */
static bool take_word(reader *r, const char *word)
{
    const size_t n = strlen(word);

    if ((size_t)(r->end - r->p) < n || memcmp(r->p, word, n) != 0) return false;
    if (r->p + n < r->end && r->p[n] > ' ' && r->p[n] != '\\') return false;
    r->p += n;
    return true;
}

/* For a message: the word at p. */
static int word_length(const reader *r)
{
    int n = 0;

    while (n < 32 && r->p + n < r->end && r->p[n] > ' ') n++;
    return n;
}

/* ---- vertices and normals ---- */

static void take_numbers(reader *r, const char *what, double *v, int n)
{
    for (int i = 0; i < n && !r->status; i++) {
        const char *stop;
        skip_blanks(r);
        v[i] = bis_parse_double((const char *)r->p, &stop);
        if (is_line_end(r))
            r->status = bis_mesh_refuse(&r->in, r->line, BIS_INPUT, "\"%s\" has %d numbers, must have %d", what, i,
                                        n);
        else if (stop == (const char *)r->p || ((unsigned char)*stop > ' ' && *stop != '\\'))
            r->status = bis_mesh_refuse(&r->in, r->line, BIS_INPUT, "\"%.*s\" in \"%s\" is no number", word_length(r),
                                        (const char *)r->p, what);
        r->p = (const unsigned char *)stop;
    }
}

static bool fits_float(double v) { return fabs(v) <= (double)FLT_MAX; }

static void read_vertex(reader *r)
{
    const int line = r->line;
    double v[3];

    take_numbers(r, "v", v, 3);
    for (int i = 0; i < 3 && !r->status; i++)
        if (!fits_float(v[i]))
            r->status = bis_mesh_refuse(&r->in, line, BIS_INPUT, "the vertex has %c = %g, must be a finite float",
                                        "xyz"[i], v[i]);
    if (!r->status) r->mesh->p[r->seen_v++] = vec3_from(v[0], v[1], v[2]);
}

/* One that is not finite stays (0,0,0): the face's is used there. */
static void read_normal(reader *r)
{
    double n[3];

    take_numbers(r, "vn", n, 3);
    if (r->status) return;
    if (fits_float(n[0]) && fits_float(n[1]) && fits_float(n[2]))
        r->normals[r->seen_vn] = vec3_from(n[0], n[1], n[2]);
    else r->n_bad_normals++;
    r->seen_vn++;
}

/* u, and v if it is there; a third number is skipped. One that is not finite stands for none. */
static void read_uv(reader *r)
{
    double u, v = 0;

    take_numbers(r, "vt", &u, 1);
    skip_blanks(r);
    if (!r->status && !is_line_end(r) && *r->p != '#') take_numbers(r, "vt", &v, 1);
    if (r->status) return;
    const bool good = fits_float(u) && fits_float(v);
    r->n_bad_uv += !good;
    r->uv[r->seen_vt++] = good ? (bis_uv){(float)u, (float)v} : (bis_uv){NAN, 0};
}

/* ---- corners ---- */

static void no_memory(reader *r, size_t n, const char *what)
{
    r->status = bis_mesh_refuse(&r->in, r->line, BIS_NOMEM, "no memory for %zu %s", n, what);
}

static void no_vertices(reader *r) { no_memory(r, r->mesh->n_vertices, "vertices"); }

static uint32_t no_further_vertex(reader *r)
{
    no_memory(r, r->mesh->n_vertices + 1, "vertices");
    return 0;
}

/* Is (v, vt, vn) the corner that keeps number v? It is if no other one has come before. */
static bool is_first(reader *r, uint32_t v, uint32_t vt, uint32_t vn)
{
    const bool is_free = r->first_vn ? r->first_vn[v] == FREE : r->first_vt[v] == FREE;

    if (is_free && r->first_vn) r->first_vn[v] = vn;
    if (is_free && r->first_vt) r->first_vt[v] = vt;
    return (!r->first_vn || r->first_vn[v] == vn) && (!r->first_vt || r->first_vt[v] == vt);
}

/* The vertex of the corner (v, vt, vn); 0 after an error. */
static uint32_t find_vertex(reader *r, uint32_t v, uint32_t vt, uint32_t vn)
{
    bis_mesh *m = r->mesh;

    if (vn != NONE) r->any_normal = true;
    if (vt != NONE) r->any_uv = true;
    if (!r->first_vn && !r->first_vt) return v;
    if (is_first(r, v, vt, vn)) return v;
    split_corner *c = bis_corners_find(&r->further, v, vt, vn);
    if (!c) return no_further_vertex(r);
    if (c->vertex != FREE) return c->vertex;
    if (m->n_vertices >= UINT32_MAX - 1) {
        r->status = bis_mesh_refuse(&r->in, r->line, BIS_INPUT, "more than 2^32 - 2 vertices");
        return 0;
    }
    if (!BIS_ROOM(m->p, r->capacity_vertices, m->n_vertices)) return no_further_vertex(r);
    /* The source position may not have been read yet: finish_vertices copies it. */
    c->vertex = (uint32_t)m->n_vertices++;
    return c->vertex;
}

/* ---- faces ---- */

/* An index at p, as a number from 0. Absent, or after an error, or of a vt or vn that is not there: SIZE_MAX. */
static size_t take_index(reader *r, const char *what, size_t total, size_t seen)
{
    const bool negative = r->p < r->end && *r->p == '-';
    const unsigned char *p = r->p + negative;
    size_t n = 0;

    for (; p < r->end && *p >= '0' && *p <= '9'; p++)
        if (n < SIZE_MAX / 16) n = 10 * n + (size_t)(*p - '0');
    if (p == r->p) return SIZE_MAX;
    const int length = (int)(p - r->p) < 32 ? (int)(p - r->p) : 32;
    const bool is_out = n == 0 || n > (negative ? seen : total);
    if (is_out && what[1]) { /* as trimesh writes them, where some meshes of a scene have coordinates and others none */
        r->n_lost++;
        r->p = p;
        return SIZE_MAX;
    }
    if (is_out) {
        r->status = bis_mesh_refuse(&r->in, r->line, BIS_INPUT,
                                    "the face has the index %.*s, but there are %zu \"%s\"%s", length,
                                    (const char *)r->p, negative ? seen : total, what, negative ? " up to here" : "");
        return SIZE_MAX;
    }
    r->p = p;
    return negative ? seen - n : n - 1;
}

/* Over the digits of an index; whether there were any. */
static bool skip_index(reader *r)
{
    const unsigned char *start = r->p;

    while (r->p < r->end && (*r->p == '-' || (*r->p >= '0' && *r->p <= '9'))) r->p++;
    return r->p > start;
}

/* v, v/vt, v//vn or v/vt/vn, with nothing behind a slash allowed as well. */
static uint32_t take_corner(reader *r)
{
    const unsigned char *start = r->p;
    size_t v = take_index(r, "v", r->n_v, r->seen_v), vt = SIZE_MAX, vn = SIZE_MAX;

    if (v != SIZE_MAX && r->p < r->end && *r->p == '/') {
        r->p++;
        if (r->wants_uv) vt = take_index(r, "vt", r->n_vt, r->seen_vt);
        skip_index(r); /* a vt that nobody wants */
        if (r->p < r->end && *r->p == '/') {
            r->p++;
            if (r->n_vn > 0) vn = take_index(r, "vn", r->n_vn, r->seen_vn);
            else if (skip_index(r)) r->lacks_normals = true;
        }
    }
    if (r->status) return 0;
    if (v == SIZE_MAX || (r->p < r->end && *r->p > ' ' && *r->p != '\\')) {
        r->p = start;
        r->status = bis_mesh_refuse(&r->in, r->line, BIS_INPUT,
                                    "\"%.*s\" is no corner of a face: v, v/vt, v//vn or v/vt/vn", word_length(r),
                                    (const char *)r->p);
        return 0;
    }
    return find_vertex(r, (uint32_t)v, vt == SIZE_MAX ? NONE : (uint32_t)vt + 1,
                       vn == SIZE_MAX ? NONE : (uint32_t)vn + 1);
}

/* ---- materials ---- */

/* What stands behind a word, without blanks at its ends; NULL: no memory. */
static char *take_rest(reader *r)
{
    skip_blanks(r);
    const unsigned char *start = r->p, *end;
    while (!is_line_end(r)) r->p++;
    end = r->p;
    if (r->p < r->end && end > start && end[-1] == '\\') end--; /* it says that the line goes on, and is no text */
    while (end > start && is_blank(end[-1])) end--;
    return bis_strndup((const char *)start, (size_t)(end - start));
}

/* The faces that come are of another part. */
static void read_usemtl(reader *r)
{
    char *name = take_rest(r);
    const size_t n = r->parts.n + 1;
    bool ok = name != NULL;

    if (ok && !bis_names_find(&r->parts, name, &r->part)) {
        r->part = (uint32_t)n;
        ok = bis_names_set(&r->parts, name, r->part);
    }
    if (!ok) no_memory(r, n, "materials");
    bis_free(name);
}

/* For all triangles that are new. */
static void set_parts(reader *r, size_t first)
{
    bis_mesh *m = r->mesh;

    for (size_t i = first; i < m->n_triangles && !r->status; i++) {
        if (BIS_ROOM(m->part, r->capacity_part, i)) m->part[i] = r->part;
        else no_memory(r, m->n_triangles, "triangles");
    }
}

/* A fan about the first corner, for now (polygon.h). */
static void read_face(reader *r)
{
    const size_t first = r->mesh->n_triangles;
    uint32_t corner[3];
    size_t n = 0;

    for (skip_blanks(r); !is_line_end(r) && *r->p != '#'; skip_blanks(r), n++) {
        corner[n < 2 ? n : 2] = take_corner(r);
        if (n >= 2 && !r->status)
            r->status = bis_mesh_add_triangle(r->mesh, &r->capacity_triangles, corner, &r->in);
        if (r->status) return;
        if (n >= 2) corner[1] = corner[2];
    }
    if (n < 3) r->n_too_small++;
    if (!bis_polygons_note(&r->polygons, r->mesh, first)) no_memory(r, r->polygons.n + 1, "polygons");
}

/* ---- the passes ---- */

static void rewind_file(reader *r)
{
    r->p = r->in.data + bis_byte_order_mark(r->in.data, r->in.size);
    r->line = 1;
}

static void count_lines(reader *r)
{
    for (rewind_file(r); r->p < r->end; skip_line(r)) {
        skip_blanks(r);
        if (take_word(r, "v")) r->n_v++;
        else if (take_word(r, "vn")) r->n_vn++;
        else if (r->wants_uv && take_word(r, "vt")) r->n_vt++;
    }
}

static void allocate(reader *r)
{
    bis_mesh *m = r->mesh;

    if (r->n_v >= UINT32_MAX - 1 || r->n_vn >= UINT32_MAX - 1 || r->n_vt >= UINT32_MAX - 1) {
        r->status = bis_mesh_refuse(&r->in, 0, BIS_INPUT, "%zu vertices and %zu normals, must be below 2^32 - 2",
                                    r->n_v, r->n_vn);
        return;
    }
    m->n_vertices = r->capacity_vertices = r->n_v;
    m->p = bis_alloc(r->n_v, sizeof *m->p);
    r->normals = bis_alloc(r->n_vn, sizeof *r->normals);
    if (r->n_vn > 0) r->first_vn = bis_alloc(r->n_v, sizeof *r->first_vn);
    if (r->n_vt > 0) {
        r->uv = bis_alloc(r->n_vt, sizeof *r->uv);
        r->first_vt = bis_alloc(r->n_v, sizeof *r->first_vt);
    }
    if (!m->p || !r->normals || (r->n_vn > 0 && !r->first_vn) || (r->n_vt > 0 && !(r->uv && r->first_vt)))
        no_vertices(r);
    for (size_t i = 0; r->first_vt && i < r->n_v; i++) r->first_vt[i] = FREE;
    for (size_t i = 0; r->first_vn && i < r->n_v; i++) r->first_vn[i] = FREE;
}

static void read_lines(reader *r)
{
    for (rewind_file(r); !r->status && r->p < r->end; skip_line(r)) {
        skip_blanks(r);
        if (take_word(r, "v")) read_vertex(r);
        else if (take_word(r, "vn")) read_normal(r);
        else if (r->wants_uv && take_word(r, "vt")) read_uv(r);
        else if (take_word(r, "f")) {
            const size_t first = r->mesh->n_triangles;
            read_face(r);
            if (r->wants_parts) set_parts(r, first);
        } else if (r->wants_parts && take_word(r, "usemtl")) read_usemtl(r);
    }
}

static void finish_uv(reader *r)
{
    bis_mesh *m = r->mesh;

    m->uv = bis_alloc(m->n_vertices, sizeof *m->uv);
    if (!m->uv) {
        no_vertices(r);
        return;
    }
    for (size_t i = 0; i < m->n_vertices; i++) m->uv[i] = (bis_uv){NAN, 0};
    for (size_t i = 0; i < r->n_v; i++)
        if (r->first_vt[i] != FREE && r->first_vt[i] != NONE) m->uv[i] = r->uv[r->first_vt[i] - 1];
    for (size_t i = 0; i < r->further.size; i++) {
        const split_corner *c = &r->further.table[i];
        if (c->vertex != FREE && c->a != NONE) m->uv[c->vertex] = r->uv[c->a - 1];
    }
}

/* Positions of split vertices, and all normals and texture coordinates. */
static void finish_vertices(reader *r)
{
    bis_mesh *m = r->mesh;

    for (size_t i = 0; i < r->further.size; i++) {
        const split_corner *c = &r->further.table[i];
        if (c->vertex != FREE) m->p[c->vertex] = m->p[c->v];
    }
    if (r->any_uv) finish_uv(r);
    if (r->any_normal) m->n = bis_alloc(m->n_vertices, sizeof *m->n);
    if (r->any_normal && !m->n) no_vertices(r);
    if (!m->n) return;
    for (size_t i = 0; i < r->n_v; i++)
        if (r->first_vn[i] != FREE && r->first_vn[i] != NONE) m->n[i] = r->normals[r->first_vn[i] - 1];
    for (size_t i = 0; i < r->further.size; i++) {
        const split_corner *c = &r->further.table[i];
        if (c->vertex != FREE && c->b != NONE) m->n[c->vertex] = r->normals[c->b - 1];
    }
}

static void report(const reader *r)
{
    if (r->n_too_small > 0)
        bis_mesh_remark(&r->in, "%zu faces have fewer than 3 vertices and are left out", r->n_too_small);
    if (r->lacks_normals)
        bis_mesh_remark(&r->in, "faces name normals, but there is no \"vn\": the mesh is flat, unless \"smooth\" is "
                        "true");
    if (r->n_lost > 0)
        bis_mesh_remark(&r->in, "%zu corners of faces name a \"vt\" or \"vn\" that is not there, and have none: "
                        "textures may be wrong there", r->n_lost);
    if (r->n_bad_normals > 0)
        bis_mesh_remark(&r->in, "%zu vertex normals are not finite: the faces' normals are used there",
                        r->n_bad_normals);
    if (r->n_bad_uv > 0)
        bis_mesh_remark(&r->in, "%zu texture coordinates are not finite: triangles there get (0,0), (1,0), (1,1)",
                        r->n_bad_uv);
}

/* n_parts: NULL, if they are not wanted. */
static bis_status read_obj(bis_mesh *m, const char *path, bool wants_uv, size_t *n_parts, bis_loc at, bis_diag *diag)
{
    unsigned char *data = NULL;
    reader r = {.in = {.path = path, .at = at, .diag = diag}, .mesh = m, .wants_uv = wants_uv, .wants_parts = n_parts};

    *m = (bis_mesh){0};
    r.status = bis_gzip_read(&data, &r.in.size, path, at, diag);
    if (r.status) goto done;
    r.in.data = data;
    r.end = data + r.in.size;
    if (memchr(data, 0, r.in.size))
        r.status = bis_mesh_refuse(&r.in, 0, BIS_INPUT, "not an OBJ file: it is no text, there is a zero byte in it");
    if (!r.status) count_lines(&r);
    if (!r.status) allocate(&r);
    if (!r.status) read_lines(&r);
    if (!r.status) finish_vertices(&r);
    if (!r.status) r.status = bis_polygons_triangulate(m, &r.polygons, &r.in);
    if (r.status) goto done;
    report(&r);
    if (n_parts) *n_parts = r.parts.n;
    r.status = bis_mesh_finish(m, r.capacity_triangles, &r.in);
done:
    if (r.status) bis_mesh_clear(m);
    bis_free(r.normals);
    bis_free(r.first_vn);
    bis_free(r.uv);
    bis_free(r.first_vt);
    bis_names_clear(&r.parts);
    bis_free(r.further.table);
    bis_free(r.polygons.list);
    bis_free(data);
    return r.status;
}

bis_status bis_obj_read(bis_mesh *m, const char *path, bis_loc at, bis_diag *diag)
{
    return read_obj(m, path, false, NULL, at, diag);
}

bis_status bis_obj_read_uv(bis_mesh *m, const char *path, bis_loc at, bis_diag *diag)
{
    return read_obj(m, path, true, NULL, at, diag);
}

bis_status bis_obj_read_parts(bis_mesh *m, size_t *n_parts, const char *path, bool wants_uv, bis_loc at, bis_diag *diag)
{
    *n_parts = 0;
    return read_obj(m, path, wants_uv, n_parts, at, diag);
}

/* ---- what it says of materials ---- */

/* Libraries are few: a line each. */
static void read_mtllib(reader *r, bis_obj_materials *out)
{
    const int line = r->line;
    char *name = take_rest(r);

    if (name && BIS_ROOM(out->libraries, out->capacity_libraries, out->n_libraries)) {
        out->libraries[out->n_libraries++] = (bis_obj_library){name, line};
    } else {
        bis_free(name);
        no_memory(r, out->n_libraries + 1, "libraries of materials");
    }
}

static void note_face(reader *r, bis_obj_materials *out)
{
    while (out->n_shown <= r->part && !r->status) {
        if (BIS_ROOM(out->is_shown, out->capacity_shown, out->n_shown)) out->is_shown[out->n_shown++] = false;
        else no_memory(r, r->part + (size_t)1, "materials");
    }
    if (!r->status) out->is_shown[r->part] = true;
}

bis_status bis_obj_read_materials(bis_obj_materials *out, const char *path, bis_loc at, bis_diag *diag)
{
    unsigned char *data = NULL;
    bis_mesh none = {0};
    reader r = {.in = {.path = path, .at = at, .diag = diag}, .mesh = &none};

    *out = (bis_obj_materials){0};
    r.status = bis_gzip_read(&data, &r.in.size, path, at, diag);
    r.in.data = data;
    r.end = data ? data + r.in.size : NULL;
    if (!r.status) rewind_file(&r);
    for (; !r.status && r.p < r.end; skip_line(&r)) {
        skip_blanks(&r);
        if (take_word(&r, "f")) note_face(&r, out);
        else if (take_word(&r, "usemtl")) read_usemtl(&r);
        else if (take_word(&r, "mtllib")) read_mtllib(&r, out);
    }
    out->parts = r.parts;
    if (r.status) bis_obj_materials_clear(out);
    bis_free(data);
    return r.status;
}

void bis_obj_materials_clear(bis_obj_materials *m)
{
    for (size_t i = 0; i < m->n_libraries; i++) bis_free(m->libraries[i].name);
    bis_free(m->libraries);
    bis_free(m->is_shown);
    bis_names_clear(&m->parts);
    *m = (bis_obj_materials){0};
}
