/* SPDX-License-Identifier: BSD-2-Clause */
/* make_data: makes what the repository does not carry, the models and maps that scene.txt and data/scenes use.
 *
 *     bis-data DIR                     writes DIR/models/NAME.ply and DIR/maps/NAME.hdr or .exr, what textures.c has
 *                                      (a .ply, an .obj and images with texture coordinates), and what mapped.c makes
 *                                      of these: maps that are not lat-long, compressed files
 *     bis-data --knot TRIANGLES FILE   writes one carved knot, for the scaling benchmark
 *
 * Everything is drawn by formulas (model_*.c, map_*.c) with noise that is a fixed function of the place, so that two
 * runs, on any number of threads, give the same bytes. Exit status: 0 done, 1 could not write or ran out of memory, 2
 * bad usage. */
#include "map.h"
#include "mapped.h"
#include "model.h"
#include "textures.h"

#include "bis/base/file.h"
#include "bis/base/mem.h"
#include "bis/files/image_file.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

typedef struct job {
    const char *name;
    bis_status (*model)(bis_mesh *m, bis_diag *diag); /* either a model ... */
    bis_status (*map)(bis_image *image, bis_diag *diag); /* ... or a map */
} job;

/* At least as many triangles as the statue stand-in is asked to have. */
enum { KNOT_TRIANGLES = 100000, KNOT_MIN = 1000, KNOT_MAX = 100000000 };

static bis_status knot(bis_mesh *m, bis_diag *diag) { return model_knot(m, KNOT_TRIANGLES, diag); }
static bis_status light_squares(bis_mesh *m, bis_diag *diag) { return model_squares(m, false, diag); }
static bis_status dark_squares(bis_mesh *m, bis_diag *diag) { return model_squares(m, true, diag); }
static bis_status sphere(bis_mesh *m, bis_diag *diag) { return model_sphere(m, 96, diag); }

static const job jobs[] = {
    {"models/king.ply", model_king, NULL},
    {"models/queen.ply", model_queen, NULL},
    {"models/bishop.ply", model_bishop, NULL},
    {"models/knight.ply", model_knight, NULL},
    {"models/rook.ply", model_rook, NULL},
    {"models/pawn.ply", model_pawn, NULL},
    {"models/squares_light.ply", light_squares, NULL},
    {"models/squares_dark.ply", dark_squares, NULL},
    {"models/board.ply", model_board, NULL},
    {"models/knot.ply", knot, NULL},
    {"models/pedestal.ply", model_pedestal, NULL},
    {"models/paving.ply", model_paving, NULL},
    {"models/louvres.ply", model_louvres, NULL},
    {"models/sphere.ply", sphere, NULL},
    {"maps/interior.hdr", NULL, map_interior},
    {"maps/outdoor.hdr", NULL, map_outdoor},
    {"maps/overcast.hdr", NULL, map_overcast},
    {"maps/studio.hdr", NULL, map_studio},
    {"maps/lamps.hdr", NULL, map_lamps},
    {"maps/squares.hdr", NULL, map_squares},
    {"maps/one_pixel.exr", NULL, map_one_pixel},
    {"maps/halves.exr", NULL, map_halves},
    {"maps/constant.exr", NULL, map_constant},
};

/* DIR/name in path. */
static bis_status join(char path[PATH_MAX], const char *dir, const char *name, bis_diag *diag)
{
    if (snprintf(path, PATH_MAX, "%s/%s", dir, name) < PATH_MAX) return BIS_OK;
    return bis_error(diag, BIS_IO, (bis_loc){dir, 0, 0}, "the folder's name is too long");
}

static bis_status make_folder(const char *path, bis_diag *diag)
{
    if (mkdir(path, 0777) == 0 || errno == EEXIST) return BIS_OK;
    return bis_error(diag, BIS_IO, (bis_loc){path, 0, 0}, "cannot make this folder: %s", strerror(errno));
}

static bis_status make(const char *dir, const job *j, bis_diag *diag)
{
    char path[PATH_MAX];
    bis_mesh mesh = {0};
    bis_image image = {0};
    bis_status status = join(path, dir, j->name, diag);

    if (status) return status;
    if (j->model) {
        status = j->model(&mesh, diag);
        if (!status) status = model_write(&mesh, path, diag);
    } else {
        status = j->map(&image, diag);
        if (!status) status = bis_image_save(&image, path, diag);
    }
    bis_mesh_clear(&mesh);
    bis_image_clear(&image);
    return status;
}

static bis_status make_all(const char *dir, bis_diag *diag)
{
    static const char *const folders[] = {"models", "maps"};
    char path[PATH_MAX];
    bis_status status = make_folder(dir, diag);

    for (size_t i = 0; i < 2 && !status; i++) {
        status = join(path, dir, folders[i], diag);
        if (!status) status = make_folder(path, diag);
    }
    for (size_t i = 0; i < sizeof jobs / sizeof jobs[0] && !status; i++) status = make(dir, &jobs[i], diag);
    if (!status) status = textures_make(dir, diag);
    return status ? status : mapped_make(dir, diag);
}

static bis_status make_knot(const char *count, const char *path, bis_diag *diag)
{
    const char *end;
    double n = bis_parse_double(count, &end);
    bis_mesh mesh = {0};

    if (end == count || *end || !(n >= KNOT_MIN && n <= KNOT_MAX)) {
        return bis_error(diag, BIS_INPUT, (bis_loc){0}, "--knot: \"%s\" is no number of triangles from %d to %d", count,
            KNOT_MIN, KNOT_MAX);
    }
    bis_status status = model_knot(&mesh, (size_t)n, diag);
    if (!status) status = model_write(&mesh, path, diag);
    bis_mesh_clear(&mesh);
    return status;
}

int main(int argc, char **argv)
{
    bis_diag diag = {0};
    bis_status status;

    if (argc == 2 && argv[1][0] != '-') {
        status = make_all(argv[1], &diag);
    } else if (argc == 4 && strcmp(argv[1], "--knot") == 0) {
        status = make_knot(argv[2], argv[3], &diag);
    } else {
        fprintf(stderr, "usage: bis-data DIR | bis-data --knot TRIANGLES FILE\n");
        return 2;
    }
    for (size_t i = 0; i < diag.n; i++) fprintf(stderr, "%s\n", diag.messages[i].text);
    bis_diag_clear(&diag);
    return status == BIS_OK ? 0 : status == BIS_INPUT ? 2 : 1;
}
