/* SPDX-License-Identifier: BSD-2-Clause */
/* mapped: maps that are not lat-long, and compressed files, for data/scenes/pbrt.
 *
 * Every pixel is the mean of N x N directions through it, each looked up in a lat-long map of data/maps. The directions
 * are written down here from the mappings' definitions (docs/scene-format.md, "How a map covers the sphere"), without
 * src/beyond/mapping.c: tests/whole/test_data.c reads the maps back and compares. To resample exactly, as `bis envmap
 * --to` does, takes seconds a map; this takes a tenth of one. */
#include "mapped.h"

#include "bis/base/file.h"
#include "bis/base/mem.h"
#include "bis/files/image_file.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <zlib.h>

/* ---- directions ---- */

typedef struct direction {
    double front, right, up; /* along -x, -y, +z of the light's frame */
} direction;

/* The direction through the picture's point (x, y), of [0,1], y downwards. False: there is none. */
typedef bool (*direction_at)(double x, double y, direction *d);

static direction around(double angle, double x, double y)
{
    const double r = hypot(x, y), s = r > 0 ? sin(angle) / r : 0;
    return (direction){cos(angle), s * x, -s * y};
}

static bool angular(double x, double y, direction *d)
{
    const double r = hypot(2 * x - 1, 2 * y - 1);
    *d = around(PI * r, 2 * x - 1, 2 * y - 1);
    return r <= 1;
}

static bool mirrorball(double x, double y, direction *d)
{
    const double r = hypot(2 * x - 1, 2 * y - 1);
    *d = around(2 * asin(fmin(r, 1)), 2 * x - 1, 2 * y - 1);
    return r <= 1;
}

/* Clarberg 2008: along a line from the middle, r is what makes equal areas; the corners are folded under. */
static bool equalarea(double x, double y, direction *d)
{
    const double u = fabs(2 * x - 1), v = fabs(2 * y - 1), fold = 1 - u - v, r = 1 - fabs(fold);
    const double phi = r > 0 ? (1 + (v - u) / r) * PI / 4 : 0, s = r * sqrt(2 - r * r);
    *d = (direction){-copysign(s * cos(phi), 2 * x - 1), -copysign(s * sin(phi), 2 * y - 1), copysign(1 - r * r, fold)};
    return true;
}

typedef enum face { NONE, UP, DOWN, LEFT, FRONT, RIGHT, BACK, BACK_TURNED } face;

/* Through the point of a face, a to the right and b up, of [-1,1]. */
static bool through(face f, double a, double b, direction *d)
{
    switch (f) {
    case NONE: return false;
    case UP: *d = (direction){-b, a, 1}; break;
    case DOWN: *d = (direction){b, a, -1}; break;
    case LEFT: *d = (direction){a, -1, b}; break;
    case FRONT: *d = (direction){1, a, b}; break;
    case RIGHT: *d = (direction){-a, 1, b}; break;
    case BACK: *d = (direction){-1, -a, b}; break;
    case BACK_TURNED: *d = (direction){-1, a, -b}; break;
    }
    return true;
}

static bool of_faces(const face *faces, int columns, int rows, double x, double y, direction *d)
{
    const int i = (int)(x * columns), j = (int)(y * rows);
    return through(faces[j * columns + i], 2 * (x * columns - i) - 1, 1 - 2 * (y * rows - j), d);
}

static bool verticalcross(double x, double y, direction *d)
{
    static const face faces[12] = {NONE, UP, NONE, LEFT, FRONT, RIGHT, NONE, DOWN, NONE, NONE, BACK_TURNED, NONE};
    return of_faces(faces, 3, 4, x, y, d);
}

static bool horizontalcross(double x, double y, direction *d)
{
    static const face faces[12] = {NONE, UP, NONE, NONE, LEFT, FRONT, RIGHT, BACK, NONE, DOWN, NONE, NONE};
    return of_faces(faces, 4, 3, x, y, d);
}

static bool cubestrip(double x, double y, direction *d)
{
    static const face faces[6] = {RIGHT, LEFT, UP, DOWN, FRONT, BACK};
    return of_faces(faces, 6, 1, x, y, d);
}

/* ---- maps ---- */

enum { N = 21 }; /* directions along the side of a pixel */

/* What the lat-long map shows in a direction of any length. */
static rgb seen(const bis_image *map, direction d)
{
    double u = atan2(-d.right, -d.front) / (2 * PI);
    const double v = acos(d.up / sqrt(d.front * d.front + d.right * d.right + d.up * d.up)) / PI;

    u -= floor(u);
    const int x = (int)fmin(u * map->width, map->width - 1), y = (int)fmin(v * map->height, map->height - 1);
    return map->pixels[(size_t)y * (size_t)map->width + (size_t)x];
}

/* Outside of a disc or a cross it is black; a pixel on the rim of a disc has the mean of its directions. */
static rgb pixel(const bis_image *map, direction_at at, double x, double y, double w, double h)
{
    double sum[3] = {0}, n = 0;

    for (int i = 0; i < N * N; i++) {
        direction d;
        if (!at((x + (i % N + 0.5) / N) / w, (y + (i / N + 0.5) / N) / h, &d)) continue;
        const rgb c = seen(map, d);
        sum[0] += (double)c.r;
        sum[1] += (double)c.g;
        sum[2] += (double)c.b;
        n++;
    }
    return n > 0 ? rgb_from(sum[0] / n, sum[1] / n, sum[2] / n) : (rgb){0, 0, 0};
}

static bis_status resample(bis_image *image, const bis_image *map, direction_at at, int width, int height,
                           bis_diag *diag)
{
    const bis_status status = bis_image_init(image, width, height, diag);

    for (int i = 0; !status && i < width * height; i++)
        image->pixels[i] = pixel(map, at, i % width, i / width, width, height);
    return status;
}

/* ---- compressed files ---- */

static bis_status write_gzip(const char *path, const unsigned char *data, size_t size, bis_diag *diag)
{
    gzFile f = gzopen(path, "wb9"); /* without name and time: the same bytes twice */
    const bool good = f && gzwrite(f, data, (unsigned)size) == (int)size;

    if (f && gzclose(f) == Z_OK && good) return BIS_OK;
    return bis_error(diag, BIS_IO, (bis_loc){path, 0, 0}, "cannot write this file");
}

static bis_status compress_file(const char *path, const char *compressed, bis_diag *diag)
{
    unsigned char *data;
    size_t size;
    bis_status status = bis_file_read(&data, &size, path, (bis_loc){0}, diag);

    if (status) return status;
    status = write_gzip(compressed, data, size, diag);
    bis_free(data);
    return status;
}

/* A Radiance file of an image that is `factor` times brighter than what its header then says, compressed. */
static bis_status write_exposed(bis_image *image, int factor, const char *path, bis_diag *diag)
{
    unsigned char *data;
    char plain[PATH_MAX + 8], line[32];
    size_t size;

    for (int i = 0; i < image->width * image->height; i++) image->pixels[i] = rgb_scale(image->pixels[i], factor);
    snprintf(plain, sizeof plain, "%s.hdr", path);
    bis_status status = bis_image_save(image, plain, diag);
    if (!status) status = bis_file_read(&data, &size, plain, (bis_loc){0}, diag);
    remove(plain);
    if (status) return status;
    const size_t first = strcspn((char *)data, "\n") + 1;
    const size_t n = (size_t)snprintf(line, sizeof line, "EXPOSURE=%d\n", factor);
    unsigned char *whole = bis_alloc(size + n, 1);
    status = whole ? BIS_OK : bis_error(diag, BIS_NOMEM, (bis_loc){path, 0, 0}, "no memory");
    if (!status) {
        memcpy(whole, data, first);
        memcpy(whole + first, line, n);
        memcpy(whole + first + n, data + first, size - first);
        status = write_gzip(path, whole, size + n, diag);
    }
    bis_free(whole);
    bis_free(data);
    return status;
}

/* ---- all ---- */

static const struct {
    const char *name, *of;
    direction_at at;
    int width, height, exposure; /* 0: no such line, and not compressed */
} maps[] = {
    {"sky_equalarea.exr", "outdoor.hdr", equalarea, 96, 96, 0},
    {"clouds_verticalcross.hdr.gz", "overcast.hdr", verticalcross, 96, 128, 4},
    {"clouds_horizontalcross.pfm", "overcast.hdr", horizontalcross, 128, 96, 0},
    {"sky_cubestrip.exr", "outdoor.hdr", cubestrip, 192, 32, 0},
    {"sky_mirrorball.hdr", "outdoor.hdr", mirrorball, 64, 64, 0},
    {"clouds_angular.hdr", "overcast.hdr", angular, 64, 64, 0},
};

static bis_status join(char path[PATH_MAX], const char *dir, const char *folder, const char *name, bis_diag *diag)
{
    if (snprintf(path, PATH_MAX, "%s/%s/%s", dir, folder, name) < PATH_MAX) return BIS_OK;
    return bis_error(diag, BIS_IO, (bis_loc){dir, 0, 0}, "the folder's name is too long");
}

static bis_status make_map(const char *dir, size_t i, bis_diag *diag)
{
    char from[PATH_MAX], to[PATH_MAX];
    bis_image map = {0}, image = {0};
    bis_status status = join(from, dir, "maps", maps[i].of, diag);

    if (!status) status = join(to, dir, "maps", maps[i].name, diag);
    if (!status) status = bis_image_read(&map, from, (bis_loc){0}, diag);
    if (!status) status = resample(&image, &map, maps[i].at, maps[i].width, maps[i].height, diag);
    if (!status) status = maps[i].exposure ? write_exposed(&image, maps[i].exposure, to, diag)
                                           : bis_image_save(&image, to, diag);
    bis_image_clear(&map);
    bis_image_clear(&image);
    return status;
}

bis_status mapped_make(const char *dir, bis_diag *diag)
{
    static const char *const files[][2] = {{"vase.ply", "vase.ply.gz"}, {"crates.obj", "crates.obj.gz"}};
    bis_status status = BIS_OK;

    for (size_t i = 0; i < sizeof maps / sizeof *maps && !status; i++) status = make_map(dir, i, diag);
    for (size_t i = 0; i < sizeof files / sizeof *files && !status; i++) {
        char plain[PATH_MAX], compressed[PATH_MAX];
        status = join(plain, dir, "models", files[i][0], diag);
        if (!status) status = join(compressed, dir, "models", files[i][1], diag);
        if (!status) status = compress_file(plain, compressed, diag);
    }
    return status;
}
