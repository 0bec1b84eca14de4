/* SPDX-License-Identifier: BSD-2-Clause */
/* file_help: whole files: written, read, compared. */
#ifndef TESTS_FILE_HELP_H
#define TESTS_FILE_HELP_H

#include <stddef.h>

void store(const char *path, const void *data, size_t n);

/* read_bytes returns the n bytes of a file and a zero behind them; the caller frees them by bis_free. */
unsigned char *read_bytes(const char *path, size_t *n);

/* The same as text. */
char *read_whole(const char *path);

/* read_text reads a file, which must be there, into text; it and its zero fit into size bytes. */
void read_text(char *text, size_t size, const char *path);

/* differing_bytes returns at how many places two files differ; SIZE_MAX: they are not of one size. */
size_t differing_bytes(const char *path_a, const char *path_b);
void assert_same_file(const char *path_a, const char *path_b);

/* EXRs of one picture, which differ in render_seconds: some bytes of a float. */
void assert_same_exr(const char *path_a, const char *path_b);

#endif
