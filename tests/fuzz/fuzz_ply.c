/* SPDX-License-Identifier: BSD-2-Clause */
/* fuzz_ply: meshes in polygon file format: header, ascii, both binary orders. */
#include "input.h"
#include "files/ply.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    fuzz_mesh(bis_ply_read, data, size);
    fuzz_mesh(bis_ply_read_uv, data, size);
    return 0;
}
