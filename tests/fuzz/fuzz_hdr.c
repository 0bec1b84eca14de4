/* SPDX-License-Identifier: BSD-2-Clause */
/* fuzz_hdr: Radiance .hdr. The reader goes by the first bytes, so the other formats are within reach, too. */
#include "input.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    fuzz_image(data, size);
    return 0;
}
