/* SPDX-License-Identifier: BSD-2-Clause */
/* image_help: see the header. */
#include "bis/base/mem.h"
#include "bis/files/image_file.h"
#include "claim.h"
#include "image_help.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define FOLDER "build/scratch"

const char *scratch(const char *name)
{
    static char paths[8][128];
    static int next;
    char *path = paths[next++ % 8];
    mkdir("build", 0777);
    mkdir(FOLDER, 0777);
    snprintf(path, sizeof paths[0], FOLDER "/%ld-%s", (long)getpid(), name);
    return path;
}

/* Temporary files of bis_outfile begin with a dot and name the process in hexadecimal. */
static bool is_ours(const char *name)
{
    char ours[2][32];
    snprintf(ours[0], sizeof ours[0], "%ld-", (long)getpid());
    snprintf(ours[1], sizeof ours[1], ".bis-%lx-", (unsigned long)getpid());
    return !strncmp(name, ours[0], strlen(ours[0])) || !strncmp(name, ours[1], strlen(ours[1]));
}

static int visit_scratch(bool remove_them)
{
    int n = 0;
    DIR *folder = opendir(FOLDER);
    if (!folder) return 0;
    for (struct dirent *entry = readdir(folder); entry; entry = readdir(folder)) {
        char path[512];
        if (!is_ours(entry->d_name)) continue;
        n++;
        snprintf(path, sizeof path, FOLDER "/%s", entry->d_name);
        if (remove_them) remove(path);
    }
    closedir(folder);
    return n;
}

int scratch_count(void) { return visit_scratch(false); }

int scratch_remove(void **state)
{
    visit_scratch(true);
    return 0;
}

void put(bytes *b, const void *data, size_t n)
{
    if (!b->data || b->n + n > b->capacity) { /* nothing is put somewhere, too: no sums with NULL */
        b->capacity = 2 * (b->n + n) + 1;
        b->data = realloc(b->data, b->capacity);
        assert_non_null(b->data);
    }
    if (n > 0) memcpy(b->data + b->n, data, n);
    b->n += n;
}

void put_text(bytes *b, const char *text) { put(b, text, strlen(text)); }

void put_int(bytes *b, uint64_t v, int n_bytes)
{
    for (int i = 0; i < n_bytes; i++) {
        unsigned char byte = i < 8 ? (unsigned char)(v >> 8 * i) : 0;
        put(b, &byte, 1);
    }
}

void put_float(bytes *b, float v)
{
    uint32_t bits;
    memcpy(&bits, &v, sizeof bits);
    put_int(b, bits, 4);
}

void bytes_clear(bytes *b)
{
    free(b->data);
    *b = (bytes){0};
}

/* Named by its content (FNV-1a), so that the same file comes once. */
void keep_as_seed(const char *path)
{
    const char *folder = getenv("BIS_SEEDS"), *dot = strrchr(path, '.');
    char name[512];
    unsigned char data[1 << 16];
    FILE *f = folder ? fopen(path, "rb") : NULL;
    if (!f) return;
    size_t n = fread(data, 1, sizeof data, f);
    fclose(f);
    if (n == sizeof data) return; /* a fuzzer learns little from large files */
    uint64_t hash = 0xcbf29ce484222325;
    for (size_t i = 0; i < n; i++) hash = (hash ^ data[i]) * 0x100000001b3;
    snprintf(name, sizeof name, "%s/%016llx%s", folder, (unsigned long long)hash, dot ? dot : "");
    store(name, data, n);
}

bool holds(const char *path, const void *data, size_t n)
{
    FILE *f = fopen(path, "rb");
    unsigned char *found = malloc(n + 1);
    bool same = f && found && fread(found, 1, n + 1, f) == n && !memcmp(found, data, n);
    if (f) fclose(f);
    free(found);
    return same;
}

void expect_refusal(const char *path, bis_status status, const char *text)
{
    char expected[1024];
    bis_image image;
    bis_diag diag = {0};
    keep_as_seed(path);
    assert_int_equal(bis_image_read(&image, path, (bis_loc){0}, &diag), status);
    assert_null(image.pixels);
    snprintf(expected, sizeof expected, "%s: error: cannot read \"%s\": %s", path, path, text);
    assert_true(diag.n > 0);
    assert_string_equal(diag.messages[diag.n - 1].text, expected);
    assert_int_equal(diag.n_errors, 1);
    bis_diag_clear(&diag);
}

void expect_refusal_of(const bytes *b, const char *name, const char *text)
{
    store(scratch(name), b->data, b->n);
    expect_refusal(scratch(name), BIS_INPUT, text);
}

void expect_refusals(const bad_file *files, size_t n, const char *name)
{
    for (const bad_file *f = files; f < files + n; f++) {
        bytes b = {0};
        put(&b, f->bytes, f->n);
        expect_refusal_of(&b, name, f->text);
        bytes_clear(&b);
    }
}

void expect_image(bis_image *image, const char *path, const char *text)
{
    char expected[1024];
    bis_diag diag = {0};
    keep_as_seed(path);
    bis_status status = bis_image_read(image, path, (bis_loc){0}, &diag);
    if (status) print_message("%s\n", diag.n ? diag.messages[diag.n - 1].text : "no message");
    assert_int_equal(status, BIS_OK);
    assert_non_null(image->pixels);
    assert_int_equal(diag.n, text ? 1 : 0);
    if (text) {
        snprintf(expected, sizeof expected, "%s: warning: \"%s\": %s", path, path, text);
        assert_string_equal(diag.messages[0].text, expected);
    }
    bis_diag_clear(&diag);
}

uint32_t next_random(uint32_t *state)
{
    *state ^= *state << 13;
    *state ^= *state >> 17;
    *state ^= *state << 5;
    return *state;
}

static bis_status try_read(const char *path)
{
    bis_image image;
    bis_diag diag = {0};
    bis_status status = bis_image_read(&image, path, (bis_loc){0}, &diag);
    assert_int_equal(status == BIS_OK, image.pixels != NULL);
    assert_int_equal(status == BIS_OK, diag.n_errors == 0);
    bis_image_clear(&image);
    bis_diag_clear(&diag);
    return status;
}

void try_damage(const bytes *b, const char *name, int n, uint32_t seed)
{
    const char *path = scratch(name);
    store(path, b->data, b->n);
    keep_as_seed(path);
    for (size_t length = 0; length < b->n; length++) {
        store(path, b->data, length);
        assert_int_equal(try_read(path), BIS_INPUT);
    }
    unsigned char *changed = malloc(b->n);
    assert_non_null(changed);
    for (int i = 0; i < n; i++) {
        memcpy(changed, b->data, b->n);
        for (uint32_t k = next_random(&seed) % 4; k < 4; k++)
            changed[next_random(&seed) % b->n] = (unsigned char)next_random(&seed);
        store(path, changed, b->n);
        try_read(path);
    }
    free(changed);
}
