/* SPDX-License-Identifier: BSD-2-Clause */
/* fuzz_mtl: the materials of an OBJ. The OBJ and the scene that names it are always the same; the library varies. */
#include "bis/scene/scene.h"
#include "input.h"

#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

/* A file of memory with this text. */
static void store(char name[32], const char *text)
{
    const int fd = memfd_create("fuzz", MFD_CLOEXEC);
    const size_t n = strlen(text);

    fuzz_require(fd >= 0 && write(fd, text, n) == (ssize_t)n, "a file in memory");
    snprintf(name, 32, "/proc/self/fd/%d", fd);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static char scene[32] = "", obj[32];
    const char *mtl = fuzz_file(data, size);
    bis_diag diag = {0};
    bis_scene_desc *d;
    char text[256];

    if (!*scene) {
        snprintf(
            text, sizeof text, "mtllib %s\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\nusemtl b\nf 1 3 2\n", mtl);
        store(obj, text);
        snprintf(text, sizeof text, "WorldBegin Shape \"objmesh\" \"string filename\" \"%s\" \"bool materials\" true\n",
            obj);
        store(scene, text);
    }
    const bis_status status = bis_scene_parse(&d, scene, &diag);
    fuzz_check_diag(status, &diag);
    if (!status) fuzz_require(d->n_shapes == 2 && d->n_materials == 3, "a material for each part");
    for (size_t i = 0; !status && i < d->n_shapes; i++) {
        const bis_material *m = &d->materials[d->shapes[i].material];
        fuzz_require(rgb_max(m->Kd) <= 1 && rgb_max(m->Ks) <= 1 && m->exponent >= 0, "values in range");
    }
    bis_scene_desc_free(d);
    bis_diag_clear(&diag);
    return 0;
}
