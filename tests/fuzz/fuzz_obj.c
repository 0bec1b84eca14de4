/* SPDX-License-Identifier: BSD-2-Clause */
/* fuzz_obj: meshes in Wavefront's text format, with and without texture coordinates and parts. */
#include "input.h"
#include "files/obj.h"

static bis_status read_parts(bis_mesh *m, const char *path, bis_loc at, bis_diag *diag)
{
    size_t n;
    bis_status status = bis_obj_read_parts(m, &n, path, true, at, diag);

    for (size_t i = 0; !status && i < m->n_triangles; i++) fuzz_require(m->part[i] <= n, "parts are in range");
    return status;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    fuzz_mesh(bis_obj_read, data, size);
    fuzz_mesh(bis_obj_read_uv, data, size);
    fuzz_mesh(read_parts, data, size);
    return 0;
}
