/* SPDX-License-Identifier: BSD-2-Clause */
/* image_exr_core: what the reader and the writer of OpenEXR share of OpenEXRCore. For src/files/image_exr*.c alone. */
#pragma once

#include <openexr.h>

/* How to begin a context that allocates through bis/mem.h and prints nothing. */
exr_context_initializer_t bis_exr_context(void *user_data);
