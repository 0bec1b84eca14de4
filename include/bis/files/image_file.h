/* image_file: RGB pixels in linear radiance, read from .hdr, .exr and .pfm, written to those and to .png.
 *
 * The format is told by the file's first bytes when reading and by the ending when writing. What plugs in from the side
 * (src/files/image_hdr.h, src/files/image_exr.h, src/files/image_pfm.h, src/files/image_png.h) is seen by src/files/image_file.c alone. */
#ifndef BIS_IMAGE_FILE_H
#define BIS_IMAGE_FILE_H

#include "bis/base/image.h"

/* Errors: BIS_IO (cannot read), BIS_INPUT (not an image we know, damaged, no colour channels), BIS_NOMEM. `at`: the
 * place in a scene that named the file, or {0}. Warnings (a second part ignored, a layer chosen) go to diag as well. */
bis_status bis_image_read(bis_image *image, const char *path, bis_loc at, bis_diag *diag);
/* One header attribute of an EXR; text, or a number when text is NULL. OpenEXR reserves some names ("version", "type",
 * "name", "tiles", ...): writing one is BIS_INPUT; give yours a prefix. */
typedef struct bis_attribute {
    const char *name;
    const char *text;
    double number;
} bis_attribute;

/* What to write. channels[0..2] are R, G, B. EXR takes all channels and attributes; the data window is [x0, x0+width) x
 * [y0, y0+height) in a display window of full_width x full_height. The other formats take R, G, B alone. */
typedef struct bis_picture {
    int width, height;
    int x0, y0, full_width, full_height;
    const bis_channel *channels;
    int n_channels;
    const bis_attribute *attributes;
    int n_attributes;
    bool has_exposure; /* png: else the exposure comes from the image's own log-average */
    double exposure;   /* png: EV, radiance is multiplied by 2^EV */
} bis_picture;

/* By ending: .exr (float32, ZIP), .pfm, .hdr, .png (sRGB, 8 bit). Written to a temporary file and renamed. Errors:
 * BIS_INPUT (an unknown ending; a value an .hdr cannot hold: negative or non-finite), BIS_IO, BIS_NOMEM. */
bis_status bis_image_write(const char *path, const bis_picture *picture, bis_diag *diag);

/* Is the ending one that bis_image_write knows? For a check before hours of rendering. */
bool bis_image_can_write(const char *path);

/* R, G, B of image and nothing else: where to begin when there is more to say. It points to image and to channels. */
bis_picture bis_image_picture(const bis_image *image, bis_channel channels[3]);

/* Write that; and the same for colours that are meant for the eye as they are (levels, a difference): no exposure. */
bis_status bis_image_save(const bis_image *image, const char *path, bis_diag *diag);
bis_status bis_image_save_colours(const bis_image *image, const char *path, bis_diag *diag);

#endif
