/* SPDX-License-Identifier: BSD-2-Clause */
/* image_exr_core: what the reader and the writer of OpenEXR share of OpenEXRCore. For src/files/image_exr*.c alone. */
#pragma once

#include <openexr.h>

/* bis_exr_context returns OpenEXR's settings of a context that allocates by bis/base/mem.h and prints nothing. */
exr_context_initializer_t bis_exr_context(void *user_data);
