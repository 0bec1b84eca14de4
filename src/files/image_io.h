/* SPDX-License-Identifier: BSD-2-Clause */
/* image_io: what the readers of .hdr, .exr and .pfm share, and the functions of the formats. For src/files/image*.c
 * alone, but for bis_tga_is_mine, which a look at a file's head needs, too. */
#pragma once

#include "bis/files/image_file.h"

#include <stdio.h>

/* How an OpenEXR file says that it covers the sphere. The pixels of its maps lie on edges: image_place.c. */
typedef enum bis_exr_layout { BIS_EXR_PICTURE, BIS_EXR_LATLONG, BIS_EXR_CUBE } bis_exr_layout;

/* A whole file in memory, with one zero byte behind it, and where to complain. A reader stores in *place and *layout
 * what the file says; of most formats that is nothing, and they stay 0. */
typedef struct image_input {
    const unsigned char *data;
    size_t size;
    const char *path;
    bis_loc at; /* the scene line that named the file, else the file itself */
    bool wants_alpha;
    bis_diag *diag;
    bis_image_place *place;
    bis_exr_layout *layout;
} image_input;

/* bis_image_refuse adds the error `cannot read "PATH": TEXT` and returns code. */
bis_status bis_image_refuse(const image_input *in, bis_status code, const char *fmt, ...) BIS_PRINTF(3, 4);

/* bis_image_remark adds the warning `"PATH": TEXT`. */
void bis_image_remark(const image_input *in, const char *fmt, ...) BIS_PRINTF(2, 3);

/* bis_image_make allocates *image. It holds the size against BIS_IMAGE_MAX_SIDE; the caller has held it against the
 * file's size. Errors: BIS_INPUT, BIS_NOMEM. */
bis_status bis_image_make(bis_image *image, const image_input *in, long long width, long long height);

/* bis_image_table makes (*table)[2^depth], by bis_alloc: what numbers of this many bits stand for, in [0,1]: v^gamma,
 * or sRGB's curve (BIS_GAMMA_SRGB). Errors: BIS_NOMEM. */
bis_status bis_image_table(float **table, int depth, double gamma, const image_input *in);

/* bis_image_refuse_unknown adds the error of a file that no reader knows, which names the format that its first bytes
 * are a mark of, and the way out. of_colours: of a texture, else of a map. Returns BIS_INPUT. */
bis_status bis_image_refuse_unknown(const image_input *in, bool of_colours);

/* ---- image_place.c: from the pixels of a data window to a picture, or to a map ---- */

/* bis_place_cut drops what lies outside of the display window, and says so. Errors: BIS_INPUT (that is all). */
bis_status bis_place_cut(bis_image *image, const image_input *in);

/* bis_place_fill makes a cut image the whole display window, black where it has no pixels, and says so. Errors:
 * BIS_INPUT (the display window is too large for these few pixels), BIS_NOMEM. */
bis_status bis_place_fill(bis_image *image, const image_input *in);

/* bis_place_map makes a map of a cut image: of OpenEXR's own layouts a lat-long map or a strip of six faces as bis has
 * them. Errors: BIS_INPUT (it does not fill its display window; a cube whose faces are no squares), BIS_NOMEM. */
bis_status bis_place_map(bis_image *image, const image_input *in);

/* ---- the formats; of the writers: the stream keeps the errors of the disk ---- */

/* bis_hdr_is_mine and the next two return whether a file is of this format; bis_hdr_read and the next two read it.
 * Errors: BIS_INPUT, BIS_NOMEM. */
bool bis_hdr_is_mine(const unsigned char *data, size_t size);
bool bis_exr_is_mine(const unsigned char *data, size_t size);
bool bis_pfm_is_mine(const unsigned char *data, size_t size);
bis_status bis_hdr_read(bis_image *image, const image_input *in);
bis_status bis_exr_read(bis_image *image, const image_input *in);
bis_status bis_pfm_read(bis_image *image, const image_input *in);

/* bis_bmp_is_mine and the next ones do the same for colours of a screen, as bis_image_read_colours says. A TGA has no
 * mark of its own: what is asked last is whether its header makes sense. */
bool bis_bmp_is_mine(const unsigned char *data, size_t size);
bool bis_jpeg_is_mine(const unsigned char *data, size_t size);
bool bis_tga_is_mine(const unsigned char *data, size_t size);
bis_status bis_bmp_read(bis_image *image, const image_input *in, double gamma);
bis_status bis_jpeg_read(bis_image *image, const image_input *in, double gamma);
bis_status bis_tga_read(bis_image *image, const image_input *in, double gamma);

/* bis_exr_read_rgba reads by OpenEXR's older reader: the first part's R, G, B, or Y, RY, BY, with half precision. (x0,
 * y0) is the corner of the data window, which the image, already made, fills; OpenEXRCore has read it from the same
 * header. */
bis_status bis_exr_read_rgba(bis_image *image, const image_input *in, int x0, int y0);

/* bis_hdr_check returns BIS_INPUT if an .hdr cannot hold every R, G, B of the picture; the message names the first. */
bis_status bis_hdr_check(const bis_picture *picture, const char *path, bis_diag *diag);

/* bis_hdr_write, bis_exr_write and bis_pfm_write write a picture; that of bis_hdr_write has passed bis_hdr_check.
 * Errors: BIS_NOMEM; of bis_exr_write also BIS_INPUT (the name of an attribute that OpenEXR reserves) and BIS_IO. */
bis_status bis_hdr_write(FILE *stream, const bis_picture *picture, const char *path, bis_diag *diag);
bis_status bis_exr_write(FILE *stream, const bis_picture *picture, const char *path, bis_diag *diag);
bis_status bis_pfm_write(FILE *stream, const bis_picture *picture, const char *path, bis_diag *diag);
