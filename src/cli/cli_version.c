/* SPDX-License-Identifier: BSD-2-Clause */
/* cli_version: what `bis --version` prints: the program, the accelerators built in, the libraries that it runs with
 * (not those of the headers that it was compiled with: a bug report wants the former). */
#include "bis/base/version.h"

#include "bis/files/image_file.h"
#include "bis/shape/accel.h"
#include "cli.h"

#include <openexr.h>
#include <png.h>

void bis_cli_version(FILE *out)
{
    const char *embree = bis_accel_embree_version(), *extra;
    int major, minor, patch;

    exr_get_library_version(&major, &minor, &patch, &extra);
    fprintf(out, "bis %s\n", BIS_VERSION);
    fprintf(out, "accelerators: grid%s\n", embree ? ", embree (default)" : " (default)");
    fprintf(out, "Embree: %s\n", embree ? embree : "not built in");
    fprintf(out, "OpenEXR: %d.%d.%d%s%s\n", major, minor, patch, extra && *extra ? "-" : "", extra ? extra : "");
    fprintf(out, "libpng: %s\n", png_get_libpng_ver(NULL));
    fprintf(out, "libjpeg: %s\n", bis_image_reads_jpeg() ? "built in" : "not built in");
#ifdef _OPENMP
    fprintf(out, "threads: OpenMP %d\n", _OPENMP);
#else
    fprintf(out, "threads: none (built without OpenMP)\n");
#endif
}
