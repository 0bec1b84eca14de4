/* SPDX-License-Identifier: BSD-2-Clause */
/* input: the bytes of one fuzzing run as a file that our readers can open, and what must hold of any outcome. */
#ifndef TESTS_FUZZ_INPUT_H
#define TESTS_FUZZ_INPUT_H

#include "bis/shape/geometry.h"
#include "bis/base/image.h"

#include <stdint.h>

/* A file in memory with these bytes; its name, under /proc, is valid until the next call. */
const char *fuzz_file(const uint8_t *data, size_t size);

/* libFuzzer takes an abort for a finding: unlike assert, this one stays in every build. */
void fuzz_require(bool claim, const char *text);

/* Success without an error message, or failure with one. */
void fuzz_check_diag(bis_status status, const bis_diag *diag);

/* Read it as an image, or by a reader of meshes; all of it or nothing, indices in range, coordinates finite. */
void fuzz_image(const uint8_t *data, size_t size);
typedef bis_status fuzz_mesh_reader(bis_mesh *m, const char *path, bis_loc at, bis_diag *diag);
void fuzz_mesh(fuzz_mesh_reader *read, const uint8_t *data, size_t size);

/* libFuzzer's entry, one in each fuzz_*.c. */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

#endif
