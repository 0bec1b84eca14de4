/* SPDX-License-Identifier: BSD-2-Clause */
/* gzip: maps and meshes that are compressed, by members made byte by byte (RFC 1952) and by zlib; damage; a limit. */
#include "files/gzip.h"

#include "bis/base/mem.h"
#include "bis/files/image_file.h"
#include "files/obj.h"
#include "files/ply.h"
#include "claim.h"
#include "image_help.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

/* CRC-32 bit by bit, as RFC 1952 defines it. */
static uint32_t crc_of(const unsigned char *data, size_t n)
{
    uint32_t crc = 0xffffffff;
    for (size_t i = 0; i < n; i++) {
        crc ^= data[i];
        for (int bit = 0; bit < 8; bit++) crc = crc & 1 ? crc >> 1 ^ 0xedb88320 : crc >> 1;
    }
    return ~crc;
}

/* A member whose deflate stream is one stored block. */
static void put_member(bytes *file, const void *data, size_t n)
{
    const unsigned char header[10] = {0x1f, 0x8b, 8, 0, 0, 0, 0, 0, 0, 3};
    assert_true(n < 65536);
    put(file, header, sizeof header);
    put_int(file, 1, 1); /* the last block, stored */
    put_int(file, n, 2);
    put_int(file, ~n & 0xffff, 2);
    put(file, data, n);
    put_int(file, crc_of(data, n), 4);
    put_int(file, n, 4);
}

/* What zlib makes of n bytes. */
static void put_compressed(bytes *file, const void *data, size_t n)
{
    z_stream z = {.next_in = (z_const Bytef *)(uintptr_t)data, .avail_in = (uInt)n};
    assert_int_equal(deflateInit2(&z, 9, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY), Z_OK);
    const size_t room = deflateBound(&z, (uLong)n);
    unsigned char *out = malloc(room);
    assert_non_null(out);
    z.next_out = out;
    z.avail_out = (uInt)room;
    assert_int_equal(deflate(&z, Z_FINISH), Z_STREAM_END);
    put(file, out, z.total_out);
    deflateEnd(&z);
    free(out);
}

static const char ply[] =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
static const char obj[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
static const char hdr[] = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n\x80\x40\x20\x81";

static void maps_and_meshes_are_read_whatever_they_are_called(void **state)
{
    for (int way = 0; way < 3; way++) { /* stored, compressed, in two members */
        bytes file = {0};
        bis_image image;
        bis_mesh mesh;
        const struct { const char *name, *text; size_t n; } files[] = {
            {"a.hdr.gz", hdr, sizeof hdr - 1}, {"a.ply.gz", ply, sizeof ply - 1}, {"a.obj.gz", obj, sizeof obj - 1}};
        for (int i = 0; i < 3; i++) {
            const size_t half = way == 2 ? files[i].n / 2 : 0;
            if (way == 1) put_compressed(&file, files[i].text, files[i].n);
            if (way == 2) put_member(&file, files[i].text, half);
            if (way != 1) put_member(&file, files[i].text + half, files[i].n - half);
            store(scratch(files[i].name), file.data, file.n);
            store(scratch("plain"), file.data, file.n);
            keep_as_seed(scratch(files[i].name));
            for (int named = 0; named < 2; named++) {
                const char *path = scratch(named ? files[i].name : "plain");
                if (i == 0) {
                    expect_image(&image, path, NULL);
                    assert_true(image.pixels[0].r == 1 && image.pixels[0].g == .5f && image.pixels[0].b == .25f);
                    bis_image_clear(&image);
                    continue;
                }
                assert_int_equal((i == 1 ? bis_ply_read : bis_obj_read)(&mesh, path, (bis_loc){0}, NULL), BIS_OK);
                assert_true(mesh.n_vertices == 3 && mesh.n_triangles == 1 && mesh.p[1].x == 1 && mesh.p[2].y == 1);
                bis_mesh_clear(&mesh);
            }
            bytes_clear(&file);
            file = (bytes){0};
        }
    }
}

static void what_follows_the_last_member_is_ignored_with_a_warning_zeros_without(void **state)
{
    bytes file = {0};
    bis_image image;
    put_member(&file, hdr, sizeof hdr - 1);
    put_int(&file, 0, 8);
    store(scratch("zeros.gz"), file.data, file.n);
    expect_image(&image, scratch("zeros.gz"), NULL);
    bis_image_clear(&image);
    put_text(&file, "more");
    store(scratch("more.gz"), file.data, file.n);
    expect_image(&image, scratch("more.gz"), "4 bytes after its end are no part of the gzip file and are ignored");
    bis_image_clear(&image);
    bytes_clear(&file);
}

static void damage_is_named(void **state)
{
    bytes file = {0};
    put_member(&file, hdr, sizeof hdr - 1);
    const size_t n = file.n;
    for (file.n = 3; file.n < n; file.n++)
        expect_refusal_of(&file, "cut.gz", "the gzip file is cut off (gzip -t tells more)");
    file.n = n;
    file.data[n - 8] ^= 1; /* the checksum */
    expect_refusal_of(&file, "crc.gz", "the gzip file is damaged (gzip -t tells more)");
    bytes_clear(&file);
}

/* 70 MB of zeros are 68 kB, and more than BIS_GZIP_FREE; zeros are no map, but the limit comes first. 60 MB pass it. */
static void a_file_made_to_fill_the_memory_is_refused_by_a_limit(void **state)
{
    const size_t large = 70000000, allowed = 60000000;
    bytes file = {0};
    char text[300];
    unsigned char *zeros = calloc(large, 1);
    assert_non_null(zeros);
    put_compressed(&file, zeros, large);
    assert_true(file.n < BIS_GZIP_FREE / BIS_GZIP_RATIO);
    snprintf(text, sizeof text,
        "its %zu bytes expand to more than 67108864, which is more than maps and meshes need and "
        "may be made to fill the memory; if you trust the file, expand it with gunzip and name the result",
        file.n);
    expect_refusal_of(&file, "bomb.gz", text);
    bytes_clear(&file);
    file = (bytes){0};
    put_compressed(&file, zeros, allowed);
    expect_refusal_of(&file, "zeros.gz", "it begins with the bytes 00 00 00 00, must be a Radiance .hdr (#?), OpenEXR "
                      "(76 2f 31 01) or PFM (PF, Pf)");
    bytes_clear(&file);
    free(zeros);
}

/* Noise does not shrink: a large file may expand to more than the free part. */
static void a_large_file_may_be_larger_than_the_free_part(void **state)
{
    const size_t n = 2000000, times = 45; /* 90 MB of one block of noise each 2 MB: a ratio of about 1 */
    unsigned char *noise = malloc(n), *data;
    uint32_t seed = 1;
    size_t size;
    bytes file = {0};
    assert_non_null(noise);
    for (size_t i = 0; i < n; i++) noise[i] = (unsigned char)(next_random(&seed) >> 8);
    bytes one = {0};
    put_compressed(&one, noise, n);
    for (size_t i = 0; i < times; i++) put(&file, one.data, one.n);
    store(scratch("noise.gz"), file.data, file.n);
    assert_int_equal(bis_gzip_read(&data, &size, scratch("noise.gz"), (bis_loc){0}, NULL), BIS_OK);
    assert_true(size == n * times && memcmp(data, noise, n) == 0 && memcmp(data + n * (times - 1), noise, n) == 0);
    bis_free(data);
    bytes_clear(&one);
    bytes_clear(&file);
    free(noise);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(maps_and_meshes_are_read_whatever_they_are_called),
        cmocka_unit_test(what_follows_the_last_member_is_ignored_with_a_warning_zeros_without),
        cmocka_unit_test(damage_is_named),
        cmocka_unit_test(a_file_made_to_fill_the_memory_is_refused_by_a_limit),
        cmocka_unit_test(a_large_file_may_be_larger_than_the_free_part),
    };
    return cmocka_run_group_tests(tests, NULL, scratch_remove);
}
