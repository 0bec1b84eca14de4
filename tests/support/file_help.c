/* SPDX-License-Identifier: BSD-2-Clause */
/* file_help: see the header. */
#include "file_help.h"

#include "bis/base/file.h"
#include "bis/base/mem.h"
#include "claim.h"

#include <stdio.h>

void store(const char *path, const void *data, size_t n)
{
    FILE *f = fopen(path, "wb");
    assert_non_null(f);
    if (n) assert_int_equal(fwrite(data, 1, n, f), n);
    assert_int_equal(fclose(f), 0);
}

unsigned char *read_bytes(const char *path, size_t *n)
{
    unsigned char *data;
    assert_int_equal(bis_file_read(&data, n, path, (bis_loc){0}, NULL), BIS_OK);
    return data;
}

char *read_whole(const char *path)
{
    size_t n;
    return (char *)read_bytes(path, &n);
}

void read_text(char *text, size_t size, const char *path)
{
    FILE *f = fopen(path, "rb");
    if (!f) fail_msg("no %s", path);
    const size_t n = fread(text, 1, size, f);
    assert_int_equal(fclose(f), 0);
    assert_true(n < size);
    text[n] = '\0';
}

size_t differing_bytes(const char *path_a, const char *path_b)
{
    size_t n_a, n_b, n = 0;
    unsigned char *a = read_bytes(path_a, &n_a), *b = read_bytes(path_b, &n_b);
    for (size_t i = 0; i < n_a && n_a == n_b; i++) n += a[i] != b[i];
    bis_free(a);
    bis_free(b);
    return n_a == n_b ? n : SIZE_MAX;
}

void assert_same_file(const char *path_a, const char *path_b)
{
    const size_t n = differing_bytes(path_a, path_b);
    if (n) fail_msg("%s and %s differ in %s%zu bytes", path_a, path_b, n == SIZE_MAX ? "their size, not in " : "", n);
}

void assert_same_exr(const char *path_a, const char *path_b)
{
    assert_in_range(differing_bytes(path_a, path_b), 0, 8);
}
