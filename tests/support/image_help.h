/* SPDX-License-Identifier: BSD-2-Clause */
/* image_help: what the tests of image share: scratch files below build/, files made byte by byte, exact messages. */
#ifndef TESTS_IMAGE_HELP_H
#define TESTS_IMAGE_HELP_H

#include "bis/base/image.h"
#include "file_help.h"

#include <stdint.h>

/* build/scratch/PID-NAME, for this run of this test alone. The string lives until the eighth call from now. */
const char *scratch(const char *name);

/* Remove what this run has left in build/scratch; a group teardown of cmocka. */
int scratch_remove(void **state);

/* How many files of this run are in build/scratch: a temporary file left behind counts. */
int scratch_count(void);

/* A growing file. */
typedef struct bytes {
    unsigned char *data;
    size_t n, capacity;
} bytes;

void put(bytes *b, const void *data, size_t n);
void put_text(bytes *b, const char *text);            /* without its zero */
void put_int(bytes *b, uint64_t v, int n_bytes);      /* the low byte first */
void put_float(bytes *b, float v);
void bytes_clear(bytes *b);

/* Where BIS_SEEDS names a folder: a copy of the file there, for a fuzzer to begin with (make fuzz). */
void keep_as_seed(const char *path);

/* Does the file hold exactly these bytes? */
bool holds(const char *path, const void *data, size_t n);

/* Reading path must fail with this status, no image, and exactly the message `PATH: error: cannot read "PATH":
 * TEXT`. */
void expect_refusal(const char *path, bis_status status, const char *text);

/* The same for a file with these bytes. */
void expect_refusal_of(const bytes *b, const char *name, const char *text);

/* A file of n bytes, and the text for which it is refused. BYTES: a string with its length. */
typedef struct bad_file {
    const char *bytes;
    size_t n;
    const char *text;
} bad_file;

#define BYTES(text) text, sizeof(text) - 1

/* The same for each of n files. */
void expect_refusals(const bad_file *files, size_t n, const char *name);

/* Reading must succeed, without a word when text is NULL, else with the one warning `PATH: warning: "PATH": TEXT`. */
void expect_image(bis_image *image, const char *path, const char *text);

/* Read every prefix of the file's bytes (each must be refused) and n files with up to four bytes changed (any status,
 * but no crash, and pixels only with BIS_OK). seed: of the changes. */
void try_damage(const bytes *b, const char *name, int n, uint32_t seed);

/* xorshift32: numbers for tests, never 0 for a seed other than 0. */
uint32_t next_random(uint32_t *state);

#endif
