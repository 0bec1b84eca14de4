/* SPDX-License-Identifier: BSD-2-Clause */
/* image_exr_choice: which channels of an OpenEXR file are the picture. For src/files/image_exr*.c alone. */
#pragma once

#include "image_io.h"

#include <openexr.h>

/* What to read of a part. The channels belong to the context of the file. */
typedef struct exr_choice {
    int part;
    const exr_attr_chlist_entry_t *channel[3]; /* R, G, B; or Y alone */
    const exr_attr_chlist_entry_t *alpha;      /* A; NULL: it has none, or nobody asks */
    bool colour;   /* R, G, B; else Y */
    bool chroma;   /* RY and BY, too */
    bool is_plain; /* R, G, B or Y by these very names, without a layer, in the first part */
    exr_attr_box2i_t window;
    exr_compression_t compression;
} exr_choice;

/* bis_exr_choose stores the part, the channels and what they are in *c, and says what a file of several parts or layers
 * has beside them. Errors: BIS_INPUT (no colours; deep data alone; layers, and none of a name that means the picture).
 */
bis_status bis_exr_choose(exr_choice *c, exr_const_context_t file, const image_input *in);
