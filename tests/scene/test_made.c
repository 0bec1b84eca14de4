/* SPDX-License-Identifier: BSD-2-Clause */
/* What the parser makes of shapes by formulas or of a few points: pbrt's defaults, limits and names, by rays at what
 * was built. */
#include "bis/base/mem.h"
#include "bis/scene/scene.h"
#include "claim.h"
#include "image_help.h"
#include "lack.h"
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

static void shapes_have_pbrts_defaults(void **state)
{
    built b = build("Shape \"cylinder\"");
    ABOUT(distance(&b, 5, 0, .9, -1, 0, 0), 4);
    MISSES(distance(&b, 5, 0, 1.1, -1, 0, 0));
    MISSES(distance(&b, .5, 0, 9, 0, 0, -1)); /* open at both ends */
    scene_clear(&b);
    b = build("Shape \"cone\"");
    ABOUT(distance(&b, 5, .0, .5, -1, 0, 0), 4.5);
    ABOUT(distance(&b, 0, .25, 9, 0, 0, -1), 8.25);
    scene_clear(&b);
    b = build("Shape \"paraboloid\"");
    ABOUT(distance(&b, 5, 0, .25, -1, 0, 0), 4.5);
    ABOUT(distance(&b, .5, 0, -9, 0, 0, 1), 9.25);
    scene_clear(&b);
    b = build("Shape \"hyperboloid\""); /* (0 0 0) to (1 1 1): the cone of radius sqrt 2 z */
    ABOUT(distance(&b, 5, 0, .5, -1, 0, 0), 5 - .5 * sqrt(2));
    scene_clear(&b);
    b = build("Shape \"hyperboloid\" \"point3 p1\" [1 -1 -1] \"point3 p2\" [1 1 1]"); /* x^2 + y^2 = 1 + z^2 */
    ABOUT(distance(&b, 5, 0, 0, -1, 0, 0), 4);
    ABOUT(distance(&b, 5, 0, .5, -1, 0, 0), 5 - sqrt(1.25));
    scene_clear(&b);
    b = build("Shape \"sphere\" \"float zmin\" 0 \"float zmax\" 0.5 \"float radius\" 2 \"float phimax\" 180");
    ABOUT(distance(&b, 0, 5, .25, 0, -1, 0), 5 - sqrt(4 - .0625));
    MISSES(distance(&b, 0, -5, .25, 0, 1, -.2)); /* the half that is cut off, and under the rest */
    MISSES(distance(&b, 0, 5, .75, 0, -1, 0));
    scene_clear(&b);
    b = build("Shape \"disk\" \"float innerradius\" 0.5 \"float height\" 2 \"float phimax\" 90");
    ABOUT(distance(&b, .6, .3, 5, 0, 0, -1), 3);
    MISSES(distance(&b, .2, .2, 5, 0, 0, -1));
    MISSES(distance(&b, -.6, .3, 5, 0, 0, -1));
    scene_clear(&b);
    b = build("Shape \"heightfield\" \"integer nu\" 2 \"integer nv\" 3 \"float Pz\" [0 0 1 1 0 0]");
    ABOUT(distance(&b, .5, .25, 5, 0, 0, -1), 4.5);
    ABOUT(distance(&b, .5, .5, 5, 0, 0, -1), 4);
    scene_clear(&b);
    b = build("Shape \"bilinearmesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 1]"); /* z = x y */
    ABOUT(distance(&b, .5, .6, 5, 0, 0, -1), 4.7);
    scene_clear(&b);
    b = build("Shape \"nurbs\" \"integer nu\" 3 \"integer uorder\" 3 \"float uknots\" [0 0 0 1 1 1] \"integer nv\" 2 "
              "\"integer vorder\" 2 "
              "\"float vknots\" [0 0 1 1] \"point3 P\" [-1 0 0 0 0 1 1 0 0  -1 1 0 0 1 1 1 1 0]");
    ABOUT(distance(&b, 0, .5, 5, 0, 0, -1), 4.5);       /* 2 (1/2) (1/2) of the middle's height */
    ABOUT(distance(&b, -.5, .5, 5, 0, 0, -1), 5 - .375); /* u = 1/4 */
    scene_clear(&b);
    /* an octahedron; a vertex of valence 4 has beta 3/32 and 1/(4 + 3/(8 beta)) = 1/8: half of the way to 0 */
    b = build("Shape \"loopsubdiv\" \"point3 P\" [1 0 0 -1 0 0 0 1 0 0 -1 0 0 0 1 0 0 -1] "
              "\"integer indices\" [0 2 4 2 1 4 1 3 4 3 0 4 2 0 5 1 2 5 3 1 5 0 3 5]");
    ABOUT(distance(&b, 5, 1e-4, 2e-4, -1, 0, 0), 4.5);
    assert_int_equal(b.scene->geometry.n_triangles, 8 * 64);
    scene_clear(&b);
}

static void whole_spheres_and_disks_stay_exact(void **state)
{
    built b = build("Shape \"sphere\" \"float radius\" 2 \"float zmin\" -2 \"float zmax\" 7 \"float phimax\" 400 "
                    "Shape \"disk\" \"float innerradius\" 0 \"float phimax\" 360");
    assert_true(b.scene->geometry.n_quadrics == 2 && b.scene->geometry.n_triangles == 0);
    scene_clear(&b);
}

static void equal_shapes_share_a_mesh_and_names_of_older_versions_are_known(void **state)
{
    built b = build("Shape \"cylinder\" \"float radius\" 2 Translate 9 0 0 Shape \"cylinder\" \"float radius\" 2 "
                    "Shape \"cylinder\" \"float zmax\" -1 \"float zmin\" 1 \"float radius\" 2 Shape \"cylinder\" "
                    "\"float radius\" 3 "
                    "Shape \"loopsubdiv\" \"integer nlevels\" [1] \"string scheme\" \"loop\" \"point P\" [0 0 0 1 0 0 "
                    "0 1 0] \"integer indices\" [0 1 2]");
    assert_int_equal(b.desc->n_meshes, 3);
    assert_int_equal(b.desc->meshes[2].mesh.n_triangles, 4);
    ABOUT(distance(&b, 20, 0, 0, -1, 0, 0), 20 - 12); /* the radius of 3, about 9 */
    scene_clear(&b);
}

/* Textures of such shapes have their coordinates without a word; shapes without textures keep none. */
static void coordinates_are_kept_for_textures_alone(void **state)
{
    built b = build("Shape \"cone\" \"float radius\" 2 Texture \"t\" \"spectrum\" \"checkerboard\" \"float uscale\" 8 "
                    "Material \"matte\" \"texture Kd\" \"t\" Shape \"cone\"");
    assert_null(b.desc->meshes[0].mesh.uv);
    assert_non_null(b.desc->meshes[1].mesh.uv);
    scene_clear(&b);
}

static void every_allocation_may_fail(void **state)
{
    static const char scene[] = "WorldBegin LightSource \"infinite\" Shape \"cone\" Shape \"cone\" "
        "Shape \"loopsubdiv\" \"integer levels\" 1 \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1 2] "
        "Shape \"bilinearmesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 0] Shape \"heightfield\" \"integer nu\" 2 "
        "\"integer nv\" 2 "
        "\"float Pz\" [0 0 0 0] Shape \"nurbs\" \"integer nu\" 2 \"integer uorder\" 2 \"float uknots\" [0 0 1 1] "
        "\"integer nv\" 2 "
        "\"integer vorder\" 2 \"float vknots\" [0 0 1 1] \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 0]";
    store(scratch("scene.txt"), scene, sizeof scene - 1);
    for (unsigned how = 0; how < 2; how++) {
        FOR_LACK(l) {
            bis_scene_desc *d;
            bis_diag diag = {0};
            LACK(l, bis_scene_parse_as(&d, scratch("scene.txt"), how ? BIS_PARSE_APPROXIMATE : 0, &diag));
            bis_scene_desc_free(d);
            bis_diag_clear(&diag);
        }
    }
    assert_int_equal(bis_mem_live(), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shapes_have_pbrts_defaults),
        cmocka_unit_test(whole_spheres_and_disks_stay_exact),
        cmocka_unit_test(equal_shapes_share_a_mesh_and_names_of_older_versions_are_known),
        cmocka_unit_test(coordinates_are_kept_for_textures_alone),
        cmocka_unit_test(every_allocation_may_fail),
    };
    return cmocka_run_group_tests(tests, NULL, scratch_remove);
}
