/* SPDX-License-Identifier: BSD-2-Clause */
/* textures: a vase with texture coordinates, two crates with a library of materials, and the images on them, for
 * data/scenes/pbrt. */
#include "textures.h"

#include "bis/base/file.h"
#include "bis/files/image_file.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>

enum { AROUND = 64, UP = 40 };

/* ---- images ---- */

static double smooth(double a, double b, double x)
{
    const double t = fmin(fmax((x - a) / (b - a), 0), 1);
    return t * t * (3 - 2 * t);
}

/* A tile: a star of eight points in a ring, between joints. Linear values. */
static rgb tile(double u, double v)
{
    const double x = 2 * u - 1, y = 2 * v - 1, r = hypot(x, y), phi = atan2(y, x);
    const double star = smooth(0.02, -0.02, r - 0.45 - 0.12 * cos(8 * phi)),
                 ring = smooth(0.03, 0, fabs(r - 0.78) - 0.06);
    const double joint = smooth(0.94, 0.97, fmax(fabs(x), fabs(y)));
    const double glaze[3] = {0.70, 0.66, 0.55}, blue[3] = {0.04, 0.10, 0.35}, rust[3] = {0.45, 0.13, 0.05},
                 grey[3] = {0.25, 0.24, 0.22};
    double c[3];
    for (int k = 0; k < 3; k++) {
        c[k] = glaze[k] + (blue[k] - glaze[k]) * star;
        c[k] += (rust[k] - c[k]) * ring;
        c[k] += (grey[k] - c[k]) * joint;
    }
    return rgb_from(c[0], c[1], c[2]);
}

/* Roughness of the same tile: joints are rough, the glaze is polished, the star less so. */
static rgb polish(double u, double v)
{
    const double x = 2 * u - 1, y = 2 * v - 1, r = hypot(x, y), phi = atan2(y, x);
    const double star = smooth(0.02, -0.02, r - 0.45 - 0.12 * cos(8 * phi)),
                 joint = smooth(0.94, 0.97, fmax(fabs(x), fabs(y)));
    const double value = fmax(0.05 + 0.2 * star, 0.8 * joint);
    return rgb_from(value, value, value);
}

/* A woven cloth: threads of two colours, over and under each other in turn. */
static rgb weave(double u, double v)
{
    const double x = 4 * u, y = 4 * v, a = x - floor(x), b = y - floor(y);
    const bool warp = ((int)floor(x) + (int)floor(y)) % 2 == 0;
    const double across = warp ? a : b, along = warp ? b : a;
    const double light = sqrt(fmax(0, 1 - pow(2 * across - 1, 2))) * (0.6 + 0.4 * sin(PI * along));
    const rgb straw = {0.75f, 0.62f, 0.38f}, blue = {0.10f, 0.22f, 0.40f};
    return rgb_scale(warp ? straw : blue, light);
}

/* The growth rings of a plank, cut a little beside the heart. */
static rgb rings(double u, double v)
{
    const double r = 9 * hypot(u - 0.4 + 0.03 * sin(6 * v), 0.35 * (v - 0.6)), t = r - floor(r), late = t * t * t;
    return rgb_from(0.55 - 0.33 * late, 0.34 - 0.23 * late, 0.17 - 0.12 * late);
}

/* A medal: rays about its middle, dark at the rim. */
static rgb medal(double u, double v)
{
    const double x = 2 * u - 1, y = 2 * v - 1, r = hypot(x, y), rays = 0.5 + 0.5 * cos(12 * atan2(y, x));
    const double value = smooth(1, 0.9, r) * (0.25 + 0.65 * smooth(0.2, 0.3, r) * rays);
    return rgb_from(value, 0.8 * value, 0.45 * value);
}

/* A normal map, (n + 1)/2: a round stud, whose height is cos^2 of the distance from its middle, on a flat plate. */
static rgb stud(double u, double v)
{
    const double x = 2 * u - 1, y = 2 * v - 1, r = hypot(x, y), edge = 0.7;
    const double fall = r > 0 && r < edge ? 0.45 * sin(PI * r / edge) / r : 0, size = sqrt(1 + fall * fall * r * r);
    return rgb_from((fall * x / size + 1) / 2, (fall * y / size + 1) / 2, (1 / size + 1) / 2);
}

/* Row 0 is at the top, v = 1. The writer makes sRGB of linear values. */
static bis_status write_image(const char *path, int side, rgb (*at)(double u, double v), bis_diag *diag)
{
    bis_image image;
    bis_status status = bis_image_init(&image, side, side, diag);

    if (status) return status;
    for (int y = 0; y < side; y++)
        for (int x = 0; x < side; x++) image.pixels[y * side + x] = at((x + 0.5) / side, 1 - (y + 0.5) / side);
    status = bis_image_save_colours(&image, path, diag);
    bis_image_clear(&image);
    return status;
}

/* ---- models ---- */

static double radius_at(double v)
{
    return 0.28 + 0.34 * sin(PI * pow(v, 0.8)) * (1 - 0.35 * v) - 0.06 * sin(2 * PI * v);
}

/* A vase of height 2 about z, open at the top: u around, v from the foot to the lip. */
static void print_vase(FILE *f)
{
    fprintf(f, "ply\nformat ascii 1.0\nelement vertex %d\nproperty float x\nproperty float y\nproperty float z\n"
            "property float nx\nproperty float ny\nproperty float nz\nproperty float u\nproperty float v\n"
            "element face %d\nproperty list uchar int vertex_indices\nend_header\n", (AROUND + 1) * (UP + 1),
            2 * AROUND * UP);
    for (int j = 0; j <= UP; j++) {
        const double v = (double)j / UP, r = radius_at(v), h = 1e-4;
        const double slope =
            (radius_at(fmin(v + h, 1)) - radius_at(fmax(v - h, 0))) / (2 * (fmin(v + h, 1) - fmax(v - h, 0)));
        const double n = hypot(1, slope);
        for (int i = 0; i <= AROUND; i++) {
            const double phi = 2 * PI * i / AROUND, c = cos(phi), s = sin(phi);
            fprintf(f, "%.6g %.6g %.6g %.6g %.6g %.6g %.6g %.6g\n", r * c, r * s, 2 * v, c / n, s / n, -slope / n,
                (double)i / AROUND, v);
        }
    }
    for (int j = 0; j < UP; j++)
        for (int i = 0; i < AROUND; i++) {
            const int a = j * (AROUND + 1) + i;
            fprintf(f, "3 %d %d %d\n3 %d %d %d\n", a, a + 1, a + AROUND + 2, a, a + AROUND + 2, a + AROUND + 1);
        }
}

static void print_crate(FILE *f, const char *material, double x, double y, double side, int first)
{
    static const int face[6][4] = {{1, 5, 7, 3}, {4, 0, 2, 6}, {0, 1, 3, 2}, {5, 4, 6, 7}, {2, 3, 7, 6}, {4, 5, 1, 0}};
    for (int i = 0; i < 8; i++)
        fprintf(f, "v %g %g %g\n", x + (i & 1 ? side : -side) / 2, y + (i & 4 ? side : -side) / 2, i & 2 ? side : 0);
    fprintf(f, "usemtl %s\n", material);
    for (int i = 0; i < 6; i++)
        fprintf(f, "f %d/1 %d/2 %d/3 %d/4\n", first + face[i][0], first + face[i][1], first + face[i][2],
            first + face[i][3]);
}

static void print_crates(FILE *f)
{
    fprintf(f, "mtllib crates.mtl\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n");
    print_crate(f, "painted", -0.7, 0, 1, 1);
    print_crate(f, "iron", 0.5, 0.3, 0.6, 9);
}

static void print_library(FILE *f)
{
    fprintf(f, "newmtl painted\nKd 1 1 1\nKs 0.04 0.04 0.04\nNs 60\nillum 2\nmap_Kd ../maps/tiles.png\n"
            "newmtl iron\nKd 0.1 0.1 0.11\nKs 0.5 0.5 0.5\nNs 200\nillum 2\n");
}

static bis_status write_text(const char *path, void (*print)(FILE *f), bis_diag *diag)
{
    bis_outfile *out;
    const bis_status status = bis_outfile_open(&out, path, diag);

    if (status) return status;
    print(bis_outfile_stream(out));
    return bis_outfile_commit(out, diag);
}

bis_status textures_make(const char *dir, bis_diag *diag)
{
    static const struct {
        const char *name;
        int side;
        rgb (*image)(double u, double v);
        void (*print)(FILE *f);
    } files[] = {{"maps/tiles.png", 128, tile, NULL},        {"maps/polish.png", 128, polish, NULL},
                 {"maps/weave.pfm", 32, weave, NULL},        {"maps/rings.exr", 64, rings, NULL},
                 {"maps/medal.hdr", 64, medal, NULL},        {"maps/stud.pfm", 32, stud, NULL},
                 {"models/vase.ply", 0, NULL, print_vase},
                 {"models/crates.obj", 0, NULL, print_crates}, {"models/crates.mtl", 0, NULL, print_library}};
    bis_status status = BIS_OK;

    for (size_t i = 0; i < sizeof files / sizeof *files && !status; i++) {
        char path[PATH_MAX];
        if (snprintf(path, sizeof path, "%s/%s", dir, files[i].name) >= (int)sizeof path)
            return bis_error(diag, BIS_IO, (bis_loc){dir, 0, 0}, "the folder's name is too long");
        status = files[i].image ? write_image(path, files[i].side, files[i].image, diag)
                                : write_text(path, files[i].print, diag);
    }
    return status;
}
