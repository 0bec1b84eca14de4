/* SPDX-License-Identifier: BSD-2-Clause */
/* image_exr_core: how we meet OpenEXRCore: its memory comes from bis/mem.h, so that a test can make the k-th allocation
 * fail, and its complaints, which it would print to standard error, end here unless the caller takes them.
 * Only the reader may: a context for writing holds its lock while it complains, and every question to it from there
 * (exr_get_user_data, say) waits for that lock for ever. */
#include "image_exr_core.h"

#include "bis/base/mem.h"

static void *allocate(size_t bytes) { return bis_alloc(bytes, 1); }

static void say_nothing(exr_const_context_t context, exr_result_t code, const char *text)
{
    (void)context;
    (void)code;
    (void)text;
}

exr_context_initializer_t bis_exr_context(void *user_data)
{
    exr_context_initializer_t init = EXR_DEFAULT_CONTEXT_INITIALIZER;
    init.error_handler_fn = say_nothing;
    init.alloc_fn = allocate;
    init.free_fn = bis_free;
    init.user_data = user_data;
    return init;
}
