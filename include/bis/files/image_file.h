/* SPDX-License-Identifier: BSD-2-Clause */
/* image_file: RGB pixels in linear radiance, read from .hdr, .exr and .pfm, and written to these and to .png.
 *
 * When reading, the first bytes of the file decide the format; when writing, the ending of its name. */
#pragma once

#include "bis/base/image.h"

/* Where an image lies in its picture: at column x0 and row y0 of full_width x full_height pixels. Only EXR tells (the
 * data window in the display window); the others are the whole picture. left, top: where the picture lies. */
typedef struct bis_image_place {
    int x0, y0, full_width, full_height, left, top;
} bis_image_place;

/* bis_image_read reads the pixels of an image, of an EXR its data window. `at` is the place in a scene that named the
 * file, or {0}. Warnings (a second part was ignored, a layer was chosen) go to diag. Errors: BIS_IO (cannot read),
 * BIS_INPUT (an unknown format, a damaged file, no colour channels), BIS_NOMEM. */
bis_status bis_image_read(bis_image *image, const char *path, bis_loc at, bis_diag *diag);

/* bis_image_read_map reads an environment map. *is_cube_strip becomes whether an EXR says that it is a cube map: its
 * faces then stand as in BIS_MAPPING_CUBE_STRIP, whatever their order in the file. OpenEXR's own lat-long and cube
 * maps, whose pixels lie on edges, become maps of pixels in cells. Errors: those of bis_image_read; BIS_INPUT (an EXR
 * whose data window does not fill its display window). */
bis_status bis_image_read_map(bis_image *image, bool *is_cube_strip, const char *path, bis_loc at, bis_diag *diag);

/* bis_image_read_colours reads an image whose values are colours of a surface, and no radiance: it takes a .png, too. A
 * .png's value v in [0,1] becomes v^gamma, or what the curve of sRGB makes of it (BIS_GAMMA_SRGB); the other formats
 * are linear, and gamma does not count. Transparency is dropped. It is the whole picture, black where an EXR has no
 * pixels. Errors: those of bis_image_read. */
bis_status bis_image_read_colours(bis_image *image, const char *path, double gamma, bis_loc at, bis_diag *diag);

/* bis_image_read_alpha does the same, and reads the alpha of an EXR and a PNG, by which the pixels are then
 * premultiplied. */
bis_status bis_image_read_alpha(bis_image *image, const char *path, double gamma, bis_loc at, bis_diag *diag);

/* bis_image_reads_jpeg returns whether bis is built with libjpeg. */
bool bis_image_reads_jpeg(void);

/* bis_image_check_colours returns whether bis_image_read_colours takes a file, and adds its errors as warnings if it
 * does not. A large PNG or JPEG that begins and ends as such is believed, because reading takes time. */
bool bis_image_check_colours(const char *path, bis_loc at, bis_diag *diag);

/* bis_image_looks_cut returns whether a file begins as a PNG or a JPEG and does not end as such. */
bool bis_image_looks_cut(const char *path);

/* bis_image_check_head looks at the first bytes of a file, and tells whether bis_image_read, or with of_colours
 * bis_image_read_colours, knows its format. It is for a plan, which reads no file whole. Errors: theirs. */
bis_status bis_image_check_head(const char *path, bool of_colours, bis_loc at, bis_diag *diag);

/* bis_image_read_any reads what bis_image_read does, and a PNG, too: *is_screen then becomes true, and the pixels are
 * the linear colours that a screen shows, in [0,1], as the gAMA chunk says if there is one. It is the whole picture. If
 * an EXR or a PNG has alpha, it is read, too, and the pixels are premultiplied by it. */
bis_status bis_image_read_any(bis_image *image, bool *is_screen, const char *path, bis_loc at, bis_diag *diag);

/* bis_image_read_part reads as bis_image_read_any does, or as bis_image_read if is_screen is NULL, but only the pixels
 * of the file; *place says where they lie. */
bis_status bis_image_read_part(bis_image *image, bool *is_screen, bis_image_place *place, const char *path, bis_loc at,
                               bis_diag *diag);

/* bis_image_cut drops all but width x height pixels from column x and row y on, which lie inside. */
void bis_image_cut(bis_image *image, int x, int y, int width, int height);

/* One header attribute of an EXR: text, or a number if text is NULL. OpenEXR reserves some names ("version", "type",
 * "name", "tiles", ...). Writing one of these is BIS_INPUT; names with a prefix avoid this. */
typedef struct bis_attribute {
    const char *name;
    const char *text;
    double number;
} bis_attribute;

/* A picture to be written. channels[0..2] are R, G, B. EXR writes all channels and attributes; its data window is
 * [x0, x0+width) x [y0, y0+height) in a display window of full_width x full_height. PNG writes R, G, B and, where there
 * is a channel "A", alpha; the others write only R, G, B. Colours are premultiplied by alpha. */
typedef struct bis_picture {
    int width, height;
    int x0, y0, full_width, full_height;
    const bis_channel *channels;
    int n_channels;
    const bis_channel *subject; /* png: the share of the subject in each pixel, for the exposure; NULL: alpha is it */
    const bis_attribute *attributes;
    int n_attributes;
    bool has_exposure; /* png: false: the exposure comes from the image's own log-average */
    double exposure;   /* png: in EV; radiance is multiplied by 2^EV */
} bis_picture;

/* bis_image_write writes a picture in the format of the ending: .exr (float32, ZIP), .pfm, .hdr, .png (sRGB, 8 bit).
 * It writes a temporary file and renames it. Errors: BIS_INPUT (an unknown ending; a value that .hdr cannot hold:
 * negative or non-finite), BIS_IO, BIS_NOMEM. */
bis_status bis_image_write(const char *path, const bis_picture *picture, bis_diag *diag);

/* bis_image_can_write returns whether bis_image_write knows the ending of path. The check is for before hours of
 * rendering. */
bool bis_image_can_write(const char *path);

/* bis_image_picture returns a picture of R, G, B and, where there is one, A of image. A caller may then add to it. The
 * picture points to image and to channels. */
bis_picture bis_image_picture(const bis_image *image, bis_channel channels[4]);

/* bis_image_save writes that picture to path. Errors: those of bis_image_write. */
bis_status bis_image_save(const bis_image *image, const char *path, bis_diag *diag);

/* bis_image_save_colours does the same for colours that the eye shall see as they are (levels, a difference): a png
 * gets no exposure. */
bis_status bis_image_save_colours(const bis_image *image, const char *path, bis_diag *diag);
