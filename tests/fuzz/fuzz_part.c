/* SPDX-License-Identifier: BSD-2-Clause */
/* fuzz_part: parts of pictures, as `bis merge` reads them. The checksum at the end is made right first, because no
 * mutation would: what stands behind it must hold on its own. */
#include "base/text.h"
#include "bis/base/mem.h"
#include "input.h"
#include "render/part.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static uint8_t sealed[1 << 17];
    static bis_merged m;
    bis_diag diag = {0};

    if (size < 8 || size > sizeof sealed) return 0;
    memcpy(sealed, data, size);
    const uint64_t hash = bis_fnv1a(BIS_FNV1A, sealed, size - 8);
    for (int i = 0; i < 8; i++) sealed[size - 8 + (size_t)i] = (uint8_t)(hash >> 8 * i);
    const char *path = fuzz_file(sealed, size);
    const bis_status status = bis_part_merge(&m, &path, 1, &diag);
    fuzz_check_diag(status, &diag);
    fuzz_require((status == BIS_OK) == (m.film.sum != NULL), "all of the picture or none");
    const size_t n = (size_t)m.film.width * (size_t)m.film.height;
    for (size_t i = 0; i < n; i++) fuzz_require(isfinite(m.film.sum[3 * i + 2]), "sums are finite");
    if (!status) fuzz_require(n * 52 <= size, "no more pixels than the file has");
    if (!status) fuzz_require(strlen(m.about.command) < size, "a command out of the file");
    bis_film_clear(&m.film);
    bis_diag_clear(&diag);
    return 0;
}
