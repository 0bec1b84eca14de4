/* SPDX-License-Identifier: BSD-2-Clause */
/* fuzz_scene: the parser, the plan, and where the scene is small: building it and shooting rays at what was built.
 *
 * The scene stands alone in a folder of this process below build/fuzz, and '/' is read as '_': no Include, map or mesh
 * leads out of it. Transformations, vertices and radii of every size reach geometry and the grid from here. */
#include "bis/scene/scene.h"
#include "input.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static char folder[64], path[80];

static void remove_folder(void)
{
    unlink(path);
    rmdir(folder);
}

/* Does a "levels" or "nlevels" ask for more than 64 triangles for each? The parser subdivides, and would do so for
 * minutes. */
static bool is_too_fine(const uint8_t *data, size_t size)
{
    for (size_t i = 0; i + 8 < size; i++) {
        if (memcmp(data + i, "levels", 6) != 0) continue;
        for (size_t k = i + 6; k < size && k < i + 20; k++)
            if (data[k] >= '4' && data[k] <= '9') return true;
        for (size_t k = i + 6; k + 1 < size && k < i + 20; k++)
            if (data[k] == '1' && data[k + 1] >= '0' && data[k + 1] <= '9') return true;
    }
    return false;
}

static void write_scene(const uint8_t *data, size_t size)
{
    if (!folder[0]) {
        mkdir("build", 0777);
        mkdir("build/fuzz", 0777);
        snprintf(folder, sizeof folder, "build/fuzz/scene-%ld", (long)getpid());
        snprintf(path, sizeof path, "%s/scene.txt", folder);
        mkdir(folder, 0777);
        atexit(remove_folder);
    }
    FILE *f = fopen(path, "wb");
    fuzz_require(f != NULL, "a file below build/fuzz");
    for (size_t i = 0; i < size; i++) putc(data[i] == '/' ? '_' : data[i], f);
    fuzz_require(fclose(f) == 0, "a file below build/fuzz");
}

static bool is_small(const bis_scene_desc *d)
{
    size_t n = d->n_shapes;
    for (size_t i = 0; i < d->n_shapes; i++)
        if (d->shapes[i].kind == BIS_SHAPE_TRIANGLES) n += d->meshes[d->shapes[i].mesh].mesh.n_triangles;
    return n < 1200; /* a cylinder has 512 */
}

static void shoot(const bis_scene *s, const bis_scene_desc *d)
{
    for (int i = 0; i < 9; i++) {
        const ray r = bis_camera_ray(&d->view.camera, 3, 3, i % 3 + 0.5, i / 3 + 0.5);
        bis_hit hit;
        bis_surface at;
        if (!bis_accel_intersect(s->accel, &r, &hit)) continue;
        fuzz_require(bis_accel_occluded(s->accel, &r), "what is hit is hidden");
        fuzz_require(hit.prim < bis_geometry_primitives(&s->geometry) && hit.t > 0, "a hit is a primitive in front");
        bis_geometry_surface(&s->geometry, hit.prim, &r, &at);
        fuzz_require(vec3_is_finite(at.n) && vec3_is_finite(at.ng), "normals are finite");
    }
}

static void build(bis_scene_desc *d)
{
    bis_diag diag = {0};
    bis_scene *s;

    d->accel.kind = BIS_ACCEL_GRID;
    d->accel.n_threads = 1;
    bis_status status = bis_scene_build(&s, d, &diag);
    fuzz_check_diag(status, &diag);
    fuzz_require((status == BIS_OK) == (s != NULL), "all of the scene or none");
    if (s) shoot(s, d);
    bis_scene_free(s);
    bis_diag_clear(&diag);
}

/* how: as bis_scene_parse_as. What lists missing files cannot be built. */
static bool parse(unsigned how)
{
    static FILE *nowhere;
    bis_diag diag = {0};
    bis_scene_desc *d;

    if (!nowhere) nowhere = fopen("/dev/null", "w");
    bis_status status = bis_scene_parse_as(&d, path, how, &diag);
    fuzz_check_diag(status, &diag);
    fuzz_require((status == BIS_OK) == (d != NULL), "all of the description or none");
    if (d) bis_scene_plan(d, nowhere);
    for (size_t i = 0; d && i < d->n_shapes; i++)
        fuzz_require(d->materials[d->shapes[i].material].model != NULL, "a shape has a material");
    if (d && is_small(d) && !d->n_missing) build(d);
    const bool approximated = d && d->n_approximations > 0;
    bis_scene_desc_free(d);
    bis_diag_clear(&diag);
    return status == BIS_OK && !approximated;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    if (is_too_fine(data, size)) return 0;
    write_scene(data, size);
    if (!parse(0)) parse(BIS_PARSE_APPROXIMATE | BIS_PARSE_LIST_MISSING);
    return 0;
}
