/* SPDX-License-Identifier: BSD-2-Clause */
/* mesh_help: see the header. */
#include "lack.h"
#include "mesh_help.h"

#include "bis/base/mem.h"
#include "shape/triangle.h"
#include "claim.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

bool right_intersect(const bis_accel *a, const ray *r, bis_hit *hit)
{
    return bis_accel_intersect(((const accel_twin *)a)->right, r, hit);
}

bool sheared_occluded(const bis_accel *a, const ray *r)
{
    const bis_geometry *g = a->geometry;
    const sheared_ray sheared = shear_ray(r);
    for (size_t i = 0; i < g->n_triangles; i++) {
        float v[9];
        double e[3], det, z;
        for (size_t k = 0; k < 3; k++) memcpy(v + 3 * k, &g->p[g->index[3 * i + k]], 3 * sizeof *v);
        if (shear_test(&sheared, v, e, &det, &z) && z / det > 0) return true;
    }
    return false;
}

const char *shared_file(const char *name)
{
    static char path[1024];
    const char *folder = getenv("BIS_SHARED");

    snprintf(path, sizeof path, "%s/%s", folder ? folder : "../shared/data", name);
    if (access(path, R_OK) == 0) return path;
    print_message("no shared test data: %s (BIS_SHARED)\n", path);
    return NULL;
}

static void assert_message(const bis_diag *diag, const char *path, int line, const char *kind, const char *text)
{
    char expected[1024];

    assert_int_equal(diag->n, 1);
    if (line > 0) {
        snprintf(expected, sizeof expected, "%s:%d: %s: %s", path, line, kind, text);
    } else {
        snprintf(expected, sizeof expected, "%s: %s: %s", path, kind, text);
    }
    assert_string_equal(diag->messages[0].text, expected);
}

void expect_mesh_of(mesh_reader *read, bis_mesh *m, const bytes *b, const char *name, const char *text)
{
    const char *path = scratch(name);
    bis_diag diag = {0};

    store(path, b->data, b->n);
    keep_as_seed(path);
    bis_status status = read(m, path, (bis_loc){0}, &diag);
    if (status) print_message("%s\n", diag.n ? diag.messages[diag.n - 1].text : "no message");
    assert_int_equal(status, BIS_OK);
    assert_sound(m);
    if (text) {
        assert_message(&diag, path, 0, "warning", text);
    } else {
        assert_int_equal(diag.n, 0);
    }
    bis_diag_clear(&diag);
}

void expect_mesh_refusal_of(mesh_reader *read, const bytes *b, const char *name, int line, const char *text)
{
    const char *path = scratch(name);
    bis_diag diag = {0};
    bis_mesh m;

    store(path, b->data, b->n);
    keep_as_seed(path);
    assert_int_equal(read(&m, path, (bis_loc){0}, &diag), BIS_INPUT);
    assert_null(m.p);
    assert_null(m.index);
    assert_int_equal(m.n_triangles, 0);
    assert_message(&diag, path, line, "error", text);
    bis_diag_clear(&diag);
}

/* Its vertices, each with its normal and texture coordinates where it has them, then its triangles. */
static const char *words_of(const bis_mesh *m)
{
    static char words[4096];
    size_t n = 0;
#define SAY(...) (n += (size_t)snprintf(words + n, sizeof words - n, __VA_ARGS__), assert_true(n < sizeof words))
    for (size_t i = 0; i < m->n_vertices; i++) {
        SAY("%s%.7g %.7g %.7g", i ? ", " : "", (double)m->p[i].x, (double)m->p[i].y, (double)m->p[i].z);
        if (m->n) SAY(" n %.7g %.7g %.7g", (double)m->n[i].x, (double)m->n[i].y, (double)m->n[i].z);
        if (m->uv && isnan(m->uv[i].u) && m->uv[i].v == 0) SAY(" t none");
        else if (m->uv) SAY(" t %.7g %.7g", (double)m->uv[i].u, (double)m->uv[i].v);
    }
    SAY("; ");
    for (size_t i = 0; i < m->n_triangles; i++) {
        const uint32_t *const c = &m->index[3 * i];
        SAY("%s%u %u %u", i ? ", " : "", (unsigned)c[0], (unsigned)c[1], (unsigned)c[2]);
    }
#undef SAY
    return words;
}

void expect_mesh_words(mesh_reader *read, const bytes *b, const char *name, const char *warning, const char *claim,
                       const char *words)
{
    bis_mesh m;
    expect_mesh_of(read, &m, b, name, warning);
    if (strcmp(words_of(&m), words) != 0) fail_msg("%s: %s, not %s", claim, words_of(&m), words);
    bis_mesh_clear(&m);
}

static void try_read(mesh_reader *read, const char *path)
{
    bis_diag diag = {0};
    bis_mesh m;
    bis_status status = read(&m, path, (bis_loc){0}, &diag);

    assert_int_equal(status == BIS_OK, diag.n_errors == 0);
    assert_true(status == BIS_OK || status == BIS_INPUT);
    assert_sound(&m);
    bis_mesh_clear(&m);
    bis_diag_clear(&diag);
}

void try_mesh_damage(mesh_reader *read, const bytes *b, const char *name, int n, uint32_t seed)
{
    const char *path = scratch(name);
    unsigned char *changed = malloc(b->n);

    assert_non_null(changed);
    for (size_t length = 0; length < b->n; length++) {
        store(path, b->data, length);
        try_read(read, path);
    }
    for (int i = 0; i < n; i++) {
        memcpy(changed, b->data, b->n);
        for (uint32_t k = next_random(&seed) % 4; k < 4; k++) {
            changed[next_random(&seed) % b->n] = (unsigned char)next_random(&seed);
        }
        store(path, changed, b->n);
        try_read(read, path);
    }
    free(changed);
}

size_t try_mesh_memory(mesh_reader *read, const bytes *b, const char *name)
{
    const char *path = scratch(name);
    size_t n_located = 0;

    store(path, b->data, b->n);
    FOR_LACK(l) {
        bis_diag diag = {0};
        bis_mesh m;
        LACK(l, read(&m, path, (bis_loc){0}, &diag));
        if (!l.over && !l.status) assert_int_equal(diag.n_lost + diag.n, 1); /* a warning may be lost */
        if (l.status) {
            assert_int_equal(diag.n_errors, 1);
            assert_null(m.p);
            assert_null(m.index);
            for (size_t i = 0; i < diag.n; i++)
                n_located += strncmp(diag.messages[i].text + strlen(path), ": error: ", strlen(": error: ")) != 0;
        }
        bis_mesh_clear(&m);
        bis_diag_clear(&diag);
    }
    return n_located;
}

void assert_sound(const bis_mesh *m)
{
    for (size_t i = 0; i < m->n_vertices; i++) {
        assert_true(vec3_is_finite(m->p[i]));
        if (m->n) assert_true(vec3_is_finite(m->n[i]));
    }
    for (size_t i = 0; i < 3 * m->n_triangles; i++) assert_true(m->index[i] < m->n_vertices);
}

void assert_triangle(const bis_mesh *m, size_t i, uint32_t a, uint32_t b, uint32_t c)
{
    assert_true(i < m->n_triangles);
    assert_int_equal(m->index[3 * i], a);
    assert_int_equal(m->index[3 * i + 1], b);
    assert_int_equal(m->index[3 * i + 2], c);
}

double random_double(uint64_t *state)
{
    uint64_t z = *state += 0x9e3779b97f4a7c15;

    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9;
    z = (z ^ z >> 27) * 0x94d049bb133111eb;
    return (double)((z ^ z >> 31) >> 11) * 0x1p-53;
}

double random_between(uint64_t *state, double lo, double hi) { return lo + (hi - lo) * random_double(state); }

vec3 random_point(uint64_t *state, double lo, double hi)
{
    const double x = random_between(state, lo, hi), y = random_between(state, lo, hi),
                 z = random_between(state, lo, hi);

    return vec3_from(x, y, z);
}

vec3 random_direction(uint64_t *state)
{
    double z = random_between(state, -1, 1), phi = random_between(state, 0, 2 * PI), s = sqrt(1 - z * z);

    return normalize(vec3_from(s * cos(phi), s * sin(phi), z));
}

bis_mesh new_mesh(size_t n_vertices, size_t n_triangles)
{
    bis_mesh m = {.n_vertices = n_vertices, .n_triangles = n_triangles};

    m.p = bis_alloc(n_vertices, sizeof *m.p);
    m.index = bis_alloc(n_triangles, 3 * sizeof *m.index);
    assert_non_null(m.p);
    assert_non_null(m.index);
    return m;
}

static void set_triangle(bis_mesh *m, size_t i, size_t a, size_t b, size_t c)
{
    m->index[3 * i] = (uint32_t)a;
    m->index[3 * i + 1] = (uint32_t)b;
    m->index[3 * i + 2] = (uint32_t)c;
}

/* Vertices 0 and 1 are the poles, then n - 1 rings of 2 n. Rings are planar, so quads are, too, but for rounding. */
bis_mesh sphere_mesh(int n)
{
    const size_t sides = 2 * (size_t)n, rings = (size_t)n - 1;
    bis_mesh m = new_mesh(2 + rings * sides, 2 * sides * rings);
    size_t t = 0;

    m.p[0] = (vec3){0, 0, 1};
    m.p[1] = (vec3){0, 0, -1};
    for (size_t i = 0; i < rings; i++) {
        double theta = PI * (double)(i + 1) / n;
        for (size_t j = 0; j < sides; j++) {
            double phi = 2 * PI * (double)j / (double)sides;
            m.p[2 + i * sides + j] = vec3_from(sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta));
        }
    }
    for (size_t j = 0; j < sides; j++) {
        const size_t next = (j + 1) % sides, last = 2 + (rings - 1) * sides;
        set_triangle(&m, t++, 0, 2 + j, 2 + next);
        set_triangle(&m, t++, 1, last + next, last + j);
        for (size_t i = 0; i + 1 < rings; i++) {
            const size_t a = 2 + i * sides, b = a + sides;
            set_triangle(&m, t++, a + j, b + j, b + next);
            set_triangle(&m, t++, a + j, b + next, a + next);
        }
    }
    assert_int_equal(t, m.n_triangles);
    return m;
}

bis_mesh soup_mesh(size_t n, double size, uint64_t seed)
{
    bis_mesh m = new_mesh(3 * n, n);

    for (size_t i = 0; i < n; i++) {
        const vec3 at = random_point(&seed, 0, 1);
        for (size_t k = 0; k < 3; k++) m.p[3 * i + k] = add(at, random_point(&seed, -size, size));
        set_triangle(&m, i, 3 * i, 3 * i + 1, 3 * i + 2);
    }
    return m;
}

void add_mesh(bis_geometry *g, bis_mesh *m, const bis_xform *t, uint32_t material)
{
    const bis_xform identity = bis_xform_identity();
    bis_diag diag = {0};
    bis_status status = bis_geometry_add_mesh(g, m, t ? t : &identity, material, &diag);

    if (status) print_message("%s\n", diag.messages[0].text);
    assert_int_equal(status, BIS_OK);
    bis_mesh_clear(m);
    bis_diag_clear(&diag);
}

/* The distance of the origin from the segment a b in the plane. */
static long double segment_distance(const long double a[2], const long double b[2])
{
    const long double d[2] = {b[0] - a[0], b[1] - a[1]}, dd = d[0] * d[0] + d[1] * d[1];
    long double t = dd > 0 ? -(a[0] * d[0] + a[1] * d[1]) / dd : 0;

    t = t < 0 ? 0 : t > 1 ? 1 : t;
    const long double x = a[0] + t * d[0], y = a[1] + t * d[1];
    return sqrtl(x * x + y * y);
}

/* Seen along the ray, which becomes a point, the triangle's edges are segments in the plane across it. */
bool is_tie(const bis_geometry *g, uint32_t prim, const ray *r, double ulps)
{
    const frame f = frame_about(normalize(r->d));
    const long double axes[2][3] = {{(long double)f.x.x, (long double)f.x.y, (long double)f.x.z},
                                    {(long double)f.y.x, (long double)f.y.y, (long double)f.y.z}};
    const long double o[3] = {(long double)r->o.x, (long double)r->o.y, (long double)r->o.z};
    const long double d[3] = {(long double)r->d.x, (long double)r->d.y, (long double)r->d.z};
    const long double dd = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    long double at[3][2], largest = 0, distance = (long double)INFINITY;

    for (int i = 0; i < 3; i++) {
        const vec3 p = g->p[g->index[3 * (size_t)prim + (size_t)i]];
        const long double v[3] = {(long double)p.x - o[0], (long double)p.y - o[1], (long double)p.z - o[2]};
        const long double along = (v[0] * d[0] + v[1] * d[1] + v[2] * d[2]) / dd;
        /* f is only a float frame: take out the part along d first, exactly enough. */
        for (int k = 0; k < 2; k++) {
            at[i][k] = 0;
            for (int a = 0; a < 3; a++) at[i][k] += axes[k][a] * (v[a] - along * d[a]);
        }
        largest =
            fmaxl(largest, fmaxl(fabsl((long double)p.x), fmaxl(fabsl((long double)p.y), fabsl((long double)p.z))));
    }
    for (int a = 0; a < 3; a++) largest = fmaxl(largest, fabsl(o[a]));
    for (int i = 0; i < 3; i++) distance = fminl(distance, segment_distance(at[i], at[(i + 1) % 3]));
    return distance <= (long double)ulps * 0x1p-23L * largest;
}
