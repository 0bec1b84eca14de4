/* SPDX-License-Identifier: BSD-2-Clause */
/* What the parser makes of shapes by formulas or of a few points: pbrt's defaults, limits and names, by rays at what
 * was built. */
#include "bis/base/mem.h"
#include "bis/scene/scene.h"
#include "bis/shape/make.h"
#include "claim.h"
#include "image_help.h"
#include "scene_help.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Without a word. */
static built build(const char *shapes)
{
    const built b = scene_build("WorldBegin LightSource \"infinite\" %s", shapes);
    assert_int_equal(b.diag.n, 0);
    return b;
}

/* How far a ray from o along d goes; infinity: it meets nothing. */
static double distance(const built *b, double ox, double oy, double oz, double dx, double dy, double dz)
{
    const ray r = {vec3_from(ox, oy, oz), vec3_from(dx, dy, dz), INFINITY};
    bis_hit hit;
    return bis_accel_intersect(b->scene->accel, &r, &hit) ? (double)hit.t : (double)INFINITY;
}

#define ABOUT(x, expected) assert_true(fabs((x) - (expected)) < 1e-3)
#define MISSES(x) assert_true(isinf(x))

static void equal_shapes_share_a_mesh_and_names_of_older_versions_are_known(void **state)
{
    built b = build("Shape \"cylinder\" \"float radius\" 2 Translate 9 0 0 Shape \"cylinder\" \"float radius\" 2 "
                    "Shape \"cylinder\" \"float zmax\" -1 \"float zmin\" 1 \"float radius\" 2 Shape \"cylinder\" "
                    "\"float radius\" 3 "
                    "Shape \"loopsubdiv\" \"integer nlevels\" [1] \"string scheme\" \"loop\" \"point P\" [0 0 0 1 0 0 "
                    "0 1 0] \"integer indices\" [0 1 2]");
    assert_int_equal(b.desc->n_meshes, 3);
    assert_int_equal(b.desc->meshes[2].size.triangles, 4);
    ABOUT(distance(&b, 20, 0, 0, -1, 0, 0), 20 - 12); /* the radius of 3, about 9 */
    scene_clear(&b);
}

/* ---- the same as made by hand ---- */

#define SHOWN "WorldBegin LightSource \"infinite\" Texture \"t\" \"spectrum\" \"checkerboard\" " \
              "\"string aamode\" \"none\" Material \"diffuse\" \"texture reflectance\" \"t\"\n"

/* The scene of these shapes, whose texture keeps their coordinates. */
static bis_scene_desc *described(const char *shapes, unsigned how)
{
    char text[2048];
    bis_scene_desc *d;
    snprintf(text, sizeof text, SHOWN "%s", shapes);
    store(scratch("scene.txt"), text, strlen(text));
    if (bis_scene_parse_as(&d, scratch("scene.txt"), how, NULL)) fail_msg("refused: %s", shapes);
    return d;
}

static void assert_same_array(const char *what, const void *a, const void *b, size_t n)
{
    if (!a != !b || (a && memcmp(a, b, n) != 0)) fail_msg("another mesh: %s", what);
}

/* Mesh i of the scene is m, which is freed. */
static void assert_mesh(const char *what, const bis_scene_desc *d, size_t i, bis_mesh *m)
{
    assert_true(i < d->n_meshes);
    bis_mesh made, *found = &made;
    assert_int_equal(bis_mesh_desc_make(found, &d->meshes[i], NULL), BIS_OK);
    assert_int_equal(found->n_vertices, d->meshes[i].size.vertices);
    assert_int_equal(found->n_triangles, d->meshes[i].size.triangles);
    if (found->n_vertices != m->n_vertices || found->n_triangles != m->n_triangles)
        fail_msg("%s: %zu vertices, %zu triangles", what, found->n_vertices, found->n_triangles);
    assert_same_array(what, found->p, m->p, m->n_vertices * sizeof *m->p);
    assert_same_array(what, found->n, m->n, m->n_vertices * sizeof *m->n);
    assert_same_array(what, found->uv, m->uv, m->n_vertices * sizeof *m->uv);
    assert_same_array(what, found->index, m->index, 3 * m->n_triangles * sizeof *m->index);
    bis_mesh_clear(found);
    assert_int_equal(d->meshes[i].kind, BIS_SHAPE_TRIANGLES);
    bis_mesh_clear(m);
}

#define CIRCLE(r, z0, z1, turn) {.profile = BIS_PROFILE_CIRCLE, .radius = r, .z = {z0, z1}, .phi_max_deg = turn}
#define PARABOLA(r, z0, z1, turn) {.profile = BIS_PROFILE_PARABOLA, .radius = r, .z = {z0, z1}, .phi_max_deg = turn}
#define LINE(x0, z0, x1, z1, turn) {.profile = BIS_PROFILE_LINE, .p = {{x0, 0, z0}, {x1, 0, z1}}, .phi_max_deg = turn}
#define ENDS(x0, y0, z0, x1, y1, z1, turn) \
    {.profile = BIS_PROFILE_LINE, .p = {{x0, y0, z0}, {x1, y1, z1}}, .phi_max_deg = turn}

/* Each other row is another mesh. */
static const struct { const char *shape; bis_revolved is; } revolved[] = {
    {"\"cylinder\"", LINE(1, -1, 1, 1, 360)},
    {"\"cylinder\" \"float radius\" 2 \"float zmin\" 3 \"float zmax\" -1 \"float phimax\" 90", LINE(2, -1, 2, 3, 90)},
    {"\"cylinder\" \"float zmin\" -3e9 \"float zmax\" 2e9", LINE(1, -3e9, 1, 2e9, 360)},
    {"\"cone\"", LINE(1, 0, 0, 1, 360)},
    {"\"cone\" \"float radius\" 3 \"float height\" -2 \"float phimax\" 400", LINE(3, 0, 0, -2, 360)},
    {"\"cone\" \"float height\" 7 \"float phimax\" 359", LINE(1, 0, 0, 7, 359)},
    {"\"paraboloid\"", PARABOLA(1, 0, 1, 360)},
    {"\"paraboloid\" \"float radius\" 2 \"float zmin\" 4 \"float zmax\" 0.5", PARABOLA(2, .5, 4, 360)},
    {"\"paraboloid\" \"float zmin\" -3 \"float zmax\" 2 \"float phimax\" 1", PARABOLA(1, 0, 2, 1)},
    {"\"hyperboloid\"", ENDS(0, 0, 0, 1, 1, 1, 360)},
    {"\"hyperboloid\" \"point3 p1\" [1 2 3] \"point3 p2\" [-4 5 6] \"float phimax\" 45",
     ENDS(1, 2, 3, -4, 5, 6, 45)},
    {"\"hyperboloid\" \"point3 p1\" [1 2 3]", ENDS(1, 2, 3, 1, 1, 1, 360)},
    {"\"hyperboloid\" \"point3 p2\" [1 2 3]", ENDS(0, 0, 0, 1, 2, 3, 360)},
    {"\"sphere\" \"float zmin\" -0.5", CIRCLE(1, -.5, 1, 360)},
    {"\"sphere\" \"float radius\" 2 \"float zmax\" 0.5 \"float zmin\" -9", CIRCLE(2, -2, .5, 360)},
    {"\"sphere\" \"float radius\" 2 \"float zmin\" 1.5 \"float zmax\" -1", CIRCLE(2, -1, 1.5, 360)},
    {"\"sphere\" \"float radius\" 3 \"float phimax\" 90", CIRCLE(3, -3, 3, 90)},
    {"\"paraboloid\" \"float zmax\" 0.5", PARABOLA(1, 0, .5, 360)},
    {"\"sphere\" \"float zmin\" 0 \"float zmax\" 0.5", CIRCLE(1, 0, .5, 360)}, /* the same numbers, a circle */
    {"\"disk\" \"float innerradius\" 0.5 \"float height\" 2", LINE(1, 2, .5, 2, 360)},
    {"\"disk\" \"float innerradius\" 1 \"float radius\" 1.25", LINE(1.25, 0, 1, 0, 360)},
    {"\"disk\" \"float radius\" 3 \"float phimax\" 90 \"float height\" -1", LINE(3, -1, 0, -1, 90)},
    {"\"disk\" \"float phimax\" 90 \"float innerradius\" -2", LINE(1, 0, 0, 0, 90)},
};
enum { N_REVOLVED = sizeof revolved / sizeof *revolved };

/* All in one scene, twice: shapes of equal numbers share their mesh, and no others do. */
static void each_surface_of_revolution_has_its_numbers(void **state)
{
    static char shapes[1 << 14];
    bis_scene_desc *d;
    size_t n = (size_t)snprintf(shapes, sizeof shapes, SHOWN);
    for (int i = 0; i < 2 * N_REVOLVED; i++)
        n += (size_t)snprintf(shapes + n, sizeof shapes - n, "Shape %s\n", revolved[i % N_REVOLVED].shape);
    assert_true(n < sizeof shapes);
    store(scratch("scene.txt"), shapes, n);
    assert_int_equal(bis_scene_parse(&d, scratch("scene.txt"), NULL), BIS_OK);
    assert_int_equal(d->n_shapes, 2 * N_REVOLVED);
    assert_int_equal(d->n_meshes, N_REVOLVED);
    for (size_t i = 0; i < N_REVOLVED; i++) {
        bis_mesh m;
        assert_int_equal(bis_make_revolved(&m, &revolved[i].is, (bis_loc){0}, NULL), BIS_OK);
        assert_mesh(revolved[i].shape, d, i, &m);
        assert_int_equal(d->meshes[i].loc.line, 2 + (int)i);
        for (size_t k = i; k < 2 * N_REVOLVED; k += N_REVOLVED)
            assert_true(d->shapes[k].mesh == i && d->shapes[k].kind == BIS_SHAPE_TRIANGLES);
    }
    bis_scene_desc_free(d);
}

static void each_whole_quadric_has_its_numbers(void **state)
{
    static const struct { const char *shape; bis_shape_kind kind; double radius, height; } cases[] = {
        {"\"sphere\"", BIS_SHAPE_SPHERE, 1, 0},
        {"\"sphere\" \"float radius\" 2.5", BIS_SHAPE_SPHERE, 2.5, 0},
        {"\"sphere\" \"float radius\" 2 \"float zmin\" -2 \"float zmax\" 2", BIS_SHAPE_SPHERE, 2, 0},
        {"\"sphere\" \"float zmin\" 3 \"float zmax\" -4 \"float phimax\" 361", BIS_SHAPE_SPHERE, 1, 0},
        {"\"disk\"", BIS_SHAPE_DISK, 1, 0},
        {"\"disk\" \"float radius\" 3 \"float height\" -2 \"float phimax\" 720", BIS_SHAPE_DISK, 3, -2},
        {"\"disk\" \"float innerradius\" -1 \"float height\" 0.5", BIS_SHAPE_DISK, 1, .5},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[256];
        snprintf(text, sizeof text, "Shape %s", cases[i].shape);
        bis_scene_desc *d = described(text, 0);
        assert_true(d->n_shapes == 1 && d->n_meshes == 0);
        const bis_shape_desc *s = &d->shapes[0];
        if (s->kind != cases[i].kind || s->radius != cases[i].radius || s->height != cases[i].height)
            fail_msg("%s: kind %d, radius %g, height %g", cases[i].shape, (int)s->kind, s->radius, s->height);
        bis_scene_desc_free(d);
    }
}

/* A mesh of these points alone, which bis_mesh_clear frees. */
static bis_mesh mesh_of(const vec3 *points, size_t n)
{
    bis_mesh m = {.n_vertices = n, .p = bis_alloc(n, sizeof *points)};
    assert_non_null(m.p);
    memcpy(m.p, points, n * sizeof *points);
    return m;
}

#define FOUR_POINTS "\"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 2] "
#define KITE "\"integer indices\" [0 1 2 2 1 3] "

static void each_subdivided_mesh_has_its_levels(void **state)
{
    static const struct { const char *words; unsigned levels; } cases[] = {
        {FOUR_POINTS KITE, 3},
        {FOUR_POINTS KITE "\"integer levels\" 0", 0},
        {FOUR_POINTS KITE "\"integer levels\" 1", 1},
        {FOUR_POINTS KITE "\"integer nlevels\" 2 \"string scheme\" \"loop\"", 2}};
    const vec3 points[4] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 2}};
    const uint32_t index[2][6] = {{0, 1, 2, 2, 1, 3}, {0, 1, 2, 0, 1, 3}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases + 1; i++) {
        const bool is_bad = i == sizeof cases / sizeof *cases; /* two triangles that turn against each other */
        char text[256];
        bis_mesh m = mesh_of(points, 4);
        m.n_triangles = 2;
        m.index = bis_alloc(6, sizeof *m.index);
        memcpy(m.index, index[is_bad], sizeof index[0]);
        snprintf(text, sizeof text, "Shape \"loopsubdiv\" %s",
                 is_bad ? FOUR_POINTS "\"integer indices\" [0 1 2 0 1 3]" : cases[i].words);
        bis_scene_desc *d = described(text, is_bad ? BIS_PARSE_APPROXIMATE : 0);
        if (!is_bad) assert_int_equal(bis_make_subdivided(&m, cases[i].levels, (bis_loc){0}, NULL), BIS_OK);
        assert_mesh(text, d, 0, &m);
        assert_int_equal(d->n_approximations, is_bad);
        bis_scene_desc_free(d);
    }
}

static void patches_and_heights_are_those_of_their_numbers(void **state)
{
    const vec3 points[5] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 2}, {3, 2, 1}};
    const uint32_t corners[][4] = {{0, 1, 2, 3}, {1, 4, 3, 2}};
    const double z[6] = {1, 2, 3, 4, 5, 6};
    static const struct { const char *shape; size_t n_points, n; } cases[] = {
        /* n: how many patches, or heights along x */
        {"Shape \"bilinearmesh\" " FOUR_POINTS, 4, 1},
        {"Shape \"bilinearmesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 2 3 2 1] \"integer indices\" [0 1 2 3 1 4 3 2]",
         5, 2},
        {"Shape \"heightfield\" \"integer nu\" 2 \"integer nv\" 3 \"float Pz\" [1 2 3 4 5 6]", 0, 2},
        {"Shape \"heightfield\" \"integer nu\" 3 \"integer nv\" 2 \"float Pz\" [1 2 3 4 5 6]", 0, 3},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const size_t n = cases[i].n;
        bis_scene_desc *d = described(cases[i].shape, 0);
        bis_mesh m;
        if (cases[i].n_points) {
            m = mesh_of(points, cases[i].n_points);
            assert_int_equal(bis_make_patches(&m, corners, n, (bis_loc){0}, NULL), BIS_OK);
        } else {
            assert_int_equal(bis_make_height_field(&m, z, n, 6 / n, (bis_loc){0}, NULL), BIS_OK);
        }
        assert_mesh(cases[i].shape, d, 0, &m);
        bis_scene_desc_free(d);
    }
}

#define NURBS "Shape \"nurbs\" \"integer nu\" 3 \"integer uorder\" 3 \"float uknots\" [0 0 1 4 5 6] " \
              "\"integer nv\" 3 \"integer vorder\" 2 \"float vknots\" [-1 0 2 3 3] "
#define NET "\"point3 P\" [1 2 3 4 5 6 7 8 9  1 3 2 4 6 5 7 9 8  0 0 1 0 1 0 1 0 0] "

/* Its ends are knots 2 and 3 of u, 1 and 3 of v, unless the scene names others. Pw has x w, y w, z w and w. */
static void each_nurbs_has_its_net_and_its_ends(void **state)
{
    static const double knots[2][6] = {{0, 0, 1, 4, 5, 6}, {-1, 0, 2, 3, 3}},
                        P[9][3] = {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}, {1, 3, 2}, {4, 6, 5}, {7, 9, 8}, {0, 0, 1},
                                   {0, 1, 0}, {1, 0, 0}};
    static const struct { const char *words; double end[2][2]; bool weighted; } cases[] = {
        {NET, {{1, 4}, {0, 3}}, false},
        {NET "\"float u0\" 2 \"float v0\" 1", {{2, 4}, {1, 3}}, false},
        {NET "\"float u1\" 3 \"float v1\" 2.5", {{1, 3}, {0, 2.5}}, false},
        {"\"float Pw\" [1 2 3 1  4 5 6 2  7 8 9 3  1 3 2 4  4 6 5 5  7 9 8 6  0 0 1 7  0 1 0 8  1 0 0 9]",
         {{1, 4}, {0, 3}}, true},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        double net[9][4];
        bis_mesh m;
        char text[512];
        for (int k = 0; k < 9; k++) {
            memcpy(net[k], P[k], sizeof P[k]);
            net[k][3] = cases[i].weighted ? k + 1 : 1;
        }
        bis_nurbs s = {.n = {3, 3}, .order = {3, 2}, .knots = {knots[0], knots[1]}, .point = (const double (*)[4])net};
        memcpy(s.end, cases[i].end, sizeof s.end);
        snprintf(text, sizeof text, NURBS "%s", cases[i].words);
        bis_scene_desc *d = described(text, 0);
        assert_int_equal(bis_make_nurbs(&m, &s, (bis_loc){0}, NULL), BIS_OK);
        assert_mesh(cases[i].words, d, 0, &m);
        bis_scene_desc_free(d);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(equal_shapes_share_a_mesh_and_names_of_older_versions_are_known),
        cmocka_unit_test(each_surface_of_revolution_has_its_numbers),
        cmocka_unit_test(each_whole_quadric_has_its_numbers),
        cmocka_unit_test(each_subdivided_mesh_has_its_levels),
        cmocka_unit_test(patches_and_heights_are_those_of_their_numbers),
        cmocka_unit_test(each_nurbs_has_its_net_and_its_ends),
    };
    return cmocka_run_group_tests(tests, NULL, scratch_remove);
}
