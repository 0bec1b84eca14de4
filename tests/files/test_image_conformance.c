/* SPDX-License-Identifier: BSD-2-Clause */
/* The conformance files of the shared data: each is read with the pixels that other readers see, or refused, as the
 * table says (made by tests/support/image_checksums.py; the refused ones were looked at one by one). Of the damaged
 * files none is read. */
#include "bis/files/image_file.h"
#include "claim.h"
#include "image_help.h"

#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct known_file {
    const char *name;
    int width, height; /* 0: see luminance */
    uint64_t checksum;
    double luminance; /* the mean, for luminance with chroma; 0: the file must be refused */
} known_file;

static const known_file files[] = {
    {"exr/000-issue194.exr", 1024, 1024, 0xb813b20a5bd88000, 0},
    {.name = "exr/11.deep.exr"}, /* deep data alone */
    {"exr/AllHalfValues.exr", 256, 256, 0x9f9d16eeb5000000, 0},
    {"exr/BrightRings.exr", 800, 800, 0x530af2d330568000, 0},
    {"exr/BrightRingsNanInf.exr", 800, 800, 0x53e082aed4d68000, 0},
    {.name = "exr/Flowers.exr", .luminance = 0.791611713},
    {"exr/Fog.exr", 1000, 672, 0xb22d8856a610a000, 0},
    {"exr/Garden.exr", 874, 493, 0x76639c2f37ecc000, 0},
    {"exr/GrayRampsDiagonal.exr", 800, 800, 0x74fa0f59e36a0000, 0},
    {"exr/MirrorPattern.exr", 512, 512, 0xc26d5d7e3c100000, 0},
    {"exr/PeriodicPattern.exr", 517, 517, 0x29e2a06af5222000, 0},
    {"exr/Rec709.exr", 610, 406, 0x60a5c9f9308e000, 0},
    {"exr/SquaresSwirls.exr", 1000, 1000, 0x977a82c67c96e000, 0},
    {"exr/WavyLinesCube.exr", 256, 1536, 0x8912efbfb3eb0000, 0},
    {"exr/WavyLinesLatLong.exr", 1024, 512, 0x94e20cc1cbd98000, 0},
    {"exr/WavyLinesSphere.exr", 480, 480, 0x2fa1a26bd3036000, 0},
    {"exr/WideColorGamut.exr", 800, 800, 0xd6df75717eb1a000, 0},
    {.name = "exr/WideFloatRange.exr"}, /* G alone */
    {.name = "exr/XYZ_YC.exr", .luminance = 0.284759086},
    {"exr/bad.exr", 64, 64, 0x11dc49d45c00000, 0},
    {.name = "exr/comp_bad_neg_bounds_pxr24.exr"}, /* bad header */
    {.name = "exr/comp_bad_pos_bounds_piz.exr"}, /* bad header */
    {.name = "exr/comp_bad_pos_bounds_pxr24.exr"}, /* bad header */
    {"exr/comp_dwab_v1.exr", 587, 675, 0x1f4217d8cb09c000, 0},
    {"exr/comp_dwab_v2.exr", 587, 675, 0x1f4217d8cb09c000, 0},
    {.name = "exr/comp_early_eof_piz.exr"}, /* cut off */
    {"exr/comp_rle.exr", 587, 675, 0x204b8244b6f3c000, 0},
    {"exr/comp_zips.exr", 587, 675, 0x204b8244b6f3c000, 0},
    {"exr/compressed-b44.exr", 128, 96, 0x138e91d8cf5da000, 0},
    {"exr/compressed-b44a.exr", 128, 96, 0x138e91d8cf5da000, 0},
    {"exr/compressed-dwaa.exr", 128, 96, 0x138687e01a27e000, 0},
    {"exr/compressed-dwab.exr", 128, 96, 0x138687e01a27e000, 0},
    {"exr/compressed-pxr24.exr", 128, 96, 0x136c368108f9a000, 0},
    {.name = "exr/deep-nosamples.exr"}, /* deep data alone */
    {.name = "exr/incomplete.exr"}, /* cut off */
    {.name = "exr/invalid.exr"}, /* text */
    {"exr/issue-160-piz-decode.exr", 420, 32, 0xb8b2def04bbb7b4, 0},
    {"exr/layers.exr", 4, 4, 0x23f58000000, 0},
    {"exr/lineOrder_decreasing.exr", 237, 119, 0x75101394a958c000, 0},
    {.name = "exr/manifest.exr"}, /* deep data alone */
    {"exr/manifest_id.exr", 100, 100, 0xd2c33a31adf0000, 0},
    {"exr/multipart-preview.exr", 64, 48, 0x13e10feddb90000, 0},
    {"exr/multipart.0001.exr", 877, 876, 0x87c6cd80d919e000, 0},
    {.name = "exr/multivariate.deep.exr"}, /* deep data alone */
    {"exr/normoffset.exr", 3, 3, 0xb2f1d34000, 0},
    {"exr/out-b44.exr", 128, 96, 0x138e91d8cf5da000, 0},
    {"exr/out-dwaa.exr", 128, 96, 0x138687e01a27e000, 0},
    {"exr/out-zip.exr", 128, 96, 0x136c368108f9a000, 0},
    {"exr/piz-bug-issue-100.exr", 35, 1, 0x9a09800000, 0},
    {"exr/resized-offset.exr", 32, 32, 0x2325b3ff480000, 0},
    {"exr/scanline_with_deeptiled_type.exr", 40, 40, 0x419bad47534000, 0},
    {.name = "exr/scanline_with_tiledimage_type.exr"}, /* OpenEXR 3.5 reads it; Core 3.1.5 believes its type */
    {"exr/seed.exr", 32, 32, 0x0, 0},
    {.name = "exr/single_channel_r.exr"}, /* R alone */
    {"exr/single_channel_y.exr", 64, 64, 0x271e577f95cc000, 0},
    {"exr/stripes.exr", 100, 50, 0x34cdd0dbb640000, 0},
    {"exr/subimagemissing.exr", 2, 1, 0x8ee000000, 0},
    {"exr/t01.exr", 400, 300, 0xe2c571ac04800000, 0},
    {"exr/t02.exr", 399, 299, 0xdcc6d279ca800000, 0},
    {"exr/t04.exr", 370, 280, 0x680e537053000000, 0},
    {"exr/t05.exr", 340, 260, 0x5d50c7a7b000000, 0},
    {"exr/t06.exr", 400, 300, 0xe2c571ac04800000, 0},
    {"exr/t07.exr", 400, 300, 0xe2c571ac04800000, 0},
    {"exr/t08.exr", 400, 300, 0xe2c571ac04800000, 0},
    {.name = "exr/t12.exr"}, /* nothing inside of the display window */
    {"exr/t14.exr", 1, 1, 0xfe000000, 0},
    {"exr/t15.exr", 400, 300, 0xe2c571ac04800000, 0},
    {"exr/t16.exr", 400, 300, 0xe2c571ac04800000, 0},
    {.name = "exr/tiled.exr"}, /* bad table of chunks */
    {.name = "exr/tiled_half_1x1_alpha.exr"}, /* A alone */
    {"exr/tiled_with_deepscanline_type.exr", 40, 40, 0x419bad47534000, 0},
    {"exr/tiled_with_deeptile_type.exr", 40, 40, 0x419bad47534000, 0},
    {"exr/tiled_with_scanlineimage_type.exr", 40, 40, 0x419bad47534000, 0},
    {"exr/tiny-az.exr", 4, 4, 0x23658000000, 0},
    {.name = "exr/unfinished_multipart.exr"}, /* Z alone */
    {.name = "exr/v1.7.test.interleaved.exr"}, /* R alone */
    {"exr/v1.7.test.planar.exr", 178, 155, 0x64a1c6331450e000, 0},
    {.name = "exr/v1.7.test.tiled.exr"}, /* G alone */
    {.name = "hdr/bomb-40000.hdr"}, /* 40000 x 40000 */
    {.name = "hdr/crash-res.hdr"}, /* no magic */
    {"hdr/image1.hdr", 128, 85, 0xf6816e254f00000, 0},
    {"hdr/memorial_512x768.hdr", 512, 768, 0xefdc85508f0d0000, 0},
    {"hdr/old-rle.hdr", 551, 276, 0xd0daec6e54000000, 0},
    {"hdr/scale.hdr", 256, 8, 0x91612072d78000, 0},
    {"hdr/seed.hdr", 64, 64, 0x0, 0},
};

static const char *shared_path(const char *name)
{
    static char path[1024];
    const char *root = getenv("BIS_SHARED");
    snprintf(path, sizeof path, "%s/conformance/%s", root ? root : "../shared/data", name);
    return path;
}

static bool is_there(const char *name)
{
    DIR *folder = opendir(shared_path(name));
    if (folder) closedir(folder);
    return folder != NULL;
}

/* As in image_checksums.py. */
static uint64_t checksum_of(const bis_image *image)
{
    const float *v = &image->pixels->r;
    size_t n = 3 * (size_t)image->width * (size_t)image->height;
    uint64_t sum = 0;
    for (size_t i = 0; i < n; i++) {
        uint32_t bits;
        memcpy(&bits, &v[i], sizeof bits);
        sum += (2 * (uint64_t)i + 1) * (isnan(v[i]) ? 0x7fc00000 : bits);
    }
    return sum;
}

static double mean_luminance(const bis_image *image, const double weights[3])
{
    size_t n = (size_t)image->width * (size_t)image->height;
    double sum = 0;
    for (size_t i = 0; i < n; i++) {
        rgb v = image->pixels[i];
        sum += weights[0] * (double)v.r + weights[1] * (double)v.g + weights[2] * (double)v.b;
    }
    return sum / (double)n;
}

static bool is_right(const known_file *f, const bis_image *image)
{
    const double rec709[3] = {0.2126, 0.7152, 0.0722};
    if (f->luminance == 0)
        return image->width == f->width && image->height == f->height && checksum_of(image) == f->checksum;
    double found = mean_luminance(image, rec709);
    return fabs(found / f->luminance - 1) < 1e-3; /* halves are good to 5e-4 */
}

static void each_known_file_is_read_as_others_read_it_or_refused(void **state)
{
    int n_wrong = 0;
    if (!is_there("exr") || !is_there("hdr")) {
        print_message("no conformance files at %s\n", shared_path(""));
        skip();
    }
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
        const known_file *f = &files[i];
        bis_image image;
        bis_diag diag = {0};
        bis_status status = bis_image_read(&image, shared_path(f->name), (bis_loc){0}, &diag);
        bool readable = f->width > 0 || f->luminance > 0;
        bool good = readable ? status == BIS_OK && is_right(f, &image) : status == BIS_INPUT && diag.n_errors == 1;
        if (!good) print_message("%s: status %d: %s\n", f->name, status, diag.n ? diag.messages[diag.n - 1].text : "");
        n_wrong += !good;
        bis_image_clear(&image);
        bis_diag_clear(&diag);
    }
    assert_int_equal(n_wrong, 0);
}

static void a_wrong_pixel_changes_the_checksum(void **state)
{
    bis_image image;
    assert_int_equal(bis_image_init(&image, 8, 4, NULL), BIS_OK);
    image.pixels[5] = (rgb){1, 2, 3};
    uint64_t right = checksum_of(&image);
    image.pixels[5] = (rgb){3, 2, 1};
    assert_true(checksum_of(&image) != right);
    image.pixels[5] = (rgb){0, 0, 0};
    image.pixels[6] = (rgb){1, 2, 3};
    assert_true(checksum_of(&image) != right);
    bis_image_clear(&image);
}

static void every_damaged_file_is_refused_with_one_error(void **state)
{
    int n_read = 0;
    DIR *folder = opendir(shared_path("exr-damaged"));
    if (!folder) {
        print_message("no damaged files at %s\n", shared_path("exr-damaged"));
        skip();
    }
    for (struct dirent *entry = readdir(folder); entry; entry = readdir(folder)) {
        char name[512];
        bis_image image;
        bis_diag diag = {0};
        if (entry->d_name[0] == '.') continue;
        snprintf(name, sizeof name, "exr-damaged/%s", entry->d_name);
        bis_status status = bis_image_read(&image, shared_path(name), (bis_loc){0}, &diag);
        if (status != BIS_INPUT || diag.n_errors != 1) {
            print_message("%s: status %d\n", name, status);
            n_read++;
        }
        assert_int_equal(status == BIS_OK, image.pixels != NULL);
        bis_image_clear(&image);
        bis_diag_clear(&diag);
    }
    closedir(folder);
    assert_int_equal(n_read, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_known_file_is_read_as_others_read_it_or_refused),
        cmocka_unit_test(a_wrong_pixel_changes_the_checksum),
        cmocka_unit_test(every_damaged_file_is_refused_with_one_error),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
