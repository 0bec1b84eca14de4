/* SPDX-License-Identifier: BSD-2-Clause */
/* fuzz_spd: spectra. The scene that names the file is always the same. */
#include "bis/scene/scene.h"
#include "input.h"

#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static char scene[32] = "";
    const char *spd = fuzz_file(data, size);
    bis_diag diag = {0};
    bis_scene_desc *d;
    char text[256];

    if (!*scene) {
        const int fd = memfd_create("fuzz", MFD_CLOEXEC);
        snprintf(text, sizeof text,
            "WorldBegin LightSource \"infinite\" \"spectrum L\" \"%s\" Material \"matte\" \"spectrum Kd\" \"%s\" "
            "Shape \"sphere\"\n", spd, spd); /* of pbrt-v3, which sorts */
        fuzz_require(fd >= 0 && write(fd, text, strlen(text)) == (ssize_t)strlen(text), "a file in memory");
        snprintf(scene, sizeof scene, "/proc/self/fd/%d", fd);
    }
    const bis_status status = bis_scene_parse(&d, scene, &diag);
    fuzz_check_diag(status, &diag);
    if (!status) fuzz_require(rgb_max(d->materials[1].Kd) <= 1 && rgb_is_finite(d->materials[1].Kd), "values in range");
    bis_scene_desc_free(d);
    bis_diag_clear(&diag);
    return 0;
}
