/* SPDX-License-Identifier: BSD-2-Clause */
/* wasm: what the library of `make web` has in the place of the files that need libraries or threads, with the reason of
 * each. The rest of src/ below the command line is compiled as it stands.
 *
 *   image_exr*.c    OpenEXRCore and Imath are no packages for wasm32, and both together would be as large as bis. The
 *                   maps of the pages are .hdr; a dropped .exr is told so.
 *   image_png*.c    libpng needs setjmp, which wasm32-wasi has not. Pages draw pictures themselves.
 *   gzip.c          zlib is no package for wasm32. The browser expands what ends in .gz before the library sees it.
 *   threads.c       there is one thread, which is here already. */
#include "bis/base/file.h"
#include "bis/base/threads.h"
#include "files/gzip.h"
#include "files/image_io.h"
#include "files/image_png.h"

#include <stdio.h>
#include <string.h>

static bis_status refuse(const image_input *in, const char *format)
{
    return bis_image_refuse(in, BIS_INPUT, "it is an %s, which bis reads everywhere but in a browser; take an .hdr or "
                            ".pfm (`bis convert MAP NAME.hdr` makes one)", format);
}

bool bis_exr_is_mine(const unsigned char *data, size_t size) { return size >= 4 && !memcmp(data, "v/1\x01", 4); }

bis_status bis_exr_read(bis_image *image, const image_input *in)
{
    (void)image;
    return refuse(in, "OpenEXR");
}

bis_status bis_exr_write(FILE *stream, const bis_picture *picture, const char *path, bis_diag *diag)
{
    (void)stream, (void)picture;
    return bis_error(diag, BIS_INPUT, (bis_loc){path, 0, 0}, "cannot write OpenEXR in a browser: take .hdr or .pfm");
}

bool bis_png_is_mine(const unsigned char *data, size_t size) { return size >= 4 && !memcmp(data, "\x89PNG", 4); }

bis_status bis_png_read(bis_image *image, const image_input *in, double gamma)
{
    (void)image, (void)gamma;
    return refuse(in, "image of PNG's kind");
}

bis_status bis_png_write(FILE *stream, const bis_picture *picture, const char *path, bis_diag *diag)
{
    (void)stream, (void)picture;
    return bis_error(diag, BIS_INPUT, (bis_loc){path, 0, 0}, "cannot write a PNG in a browser: take .hdr or .pfm");
}

bis_status bis_gzip_read(unsigned char **data, size_t *size, const char *path, bis_loc at, bis_diag *diag)
{
    return bis_file_read(data, size, path, at, diag);
}

size_t bis_gzip_head(char *head, size_t n, const char *path)
{
    FILE *f = fopen(path, "rb");
    const size_t got = f ? fread(head, 1, n, f) : 0;
    if (f) fclose(f);
    return got;
}

bis_status bis_threads_check(int n, bis_loc loc, bis_diag *diag)
{
    (void)n, (void)loc, (void)diag;
    return BIS_OK;
}

/* ---- calls of the system that wasi-libc lacks; each fails, and src/ goes on without ---- */

int madvise(void *start, size_t n, int advice) /* large pages: advice */
{
    (void)start, (void)n, (void)advice;
    return -1;
}

int fchmod(int fd, unsigned mode) /* files have no modes */
{
    (void)fd, (void)mode;
    return 0;
}

int dup(int fd) /* src/base/file.c writes standard output by it, which pages do not have */
{
    (void)fd;
    return -1;
}
