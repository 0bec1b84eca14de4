/* SPDX-License-Identifier: BSD-2-Clause */
/* input: see the header. */
#include "bis/files/image_file.h"
#include "input.h"

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

void fuzz_require(bool claim, const char *text)
{
    if (claim) return;
    fprintf(stderr, "does not hold: %s\n", text);
    abort();
}

const char *fuzz_file(const uint8_t *data, size_t size)
{
    static int fd = -1;
    static char name[32];

    if (fd < 0) fd = memfd_create("fuzz", MFD_CLOEXEC);
    fuzz_require(fd >= 0 && ftruncate(fd, 0) == 0 && pwrite(fd, data, size, 0) == (ssize_t)size, "a file in memory");
    snprintf(name, sizeof name, "/proc/self/fd/%d", fd);
    return name;
}

void fuzz_check_diag(bis_status status, const bis_diag *diag)
{
    fuzz_require((status == BIS_OK) == (diag->n_errors == 0), "an error message if and only if it fails");
    fuzz_require(diag->n_lost == 0 && status != BIS_NOMEM, "sizes are checked before memory is asked for");
}

/* Its pixels, the map or the whole picture that is made of them: one of these, by the size, for speed. */
void fuzz_image(const uint8_t *data, size_t size)
{
    const char *name = fuzz_file(data, size);
    bis_diag diag = {0};
    bis_image image;
    bool is_strip;
    const bis_status status = size % 3 == 0   ? bis_image_read(&image, name, (bis_loc){0}, &diag)
                              : size % 3 == 1 ? bis_image_read_map(&image, &is_strip, name, (bis_loc){0}, &diag)
                                              : bis_image_read_colours(&image, name, 1, (bis_loc){0}, &diag);

    fuzz_check_diag(status, &diag);
    fuzz_require((status == BIS_OK) == (image.pixels != NULL), "all of the image or none");
    volatile float sum = 0; /* touch every pixel: the sanitizer knows how many there are */
    for (size_t i = 0; !status && i < (size_t)image.width * (size_t)image.height; i++) sum = sum + image.pixels[i].b;
    bis_image_clear(&image);
    bis_diag_clear(&diag);
}

void fuzz_mesh(fuzz_mesh_reader *read, const uint8_t *data, size_t size)
{
    bis_diag diag = {0};
    bis_mesh m;
    bis_status status = read(&m, fuzz_file(data, size), (bis_loc){0}, &diag);

    fuzz_check_diag(status, &diag);
    if (status) fuzz_require(!m.p && !m.n && !m.index && m.n_triangles == 0, "no mesh after a failure");
    volatile float sum = 0;
    for (size_t i = 0; m.uv && i < m.n_vertices; i++) sum = sum + m.uv[i].u + m.uv[i].v; /* NaN: has none */
    for (size_t i = 0; i < m.n_vertices; i++)
        fuzz_require(vec3_is_finite(m.p[i]) && (!m.n || vec3_is_finite(m.n[i])), "coordinates are finite");
    for (size_t i = 0; i < 3 * m.n_triangles; i++) fuzz_require(m.index[i] < m.n_vertices, "indices are in range");
    if (!status && !m.n) fuzz_require(bis_mesh_smooth_normals(&m, &diag) == BIS_OK, "normals for any mesh");
    bis_mesh_clear(&m);
    bis_diag_clear(&diag);
}
