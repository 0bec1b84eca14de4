/* SPDX-License-Identifier: BSD-2-Clause */
/* fuzz_gz: gzip files: several members, bytes behind them, cut off anywhere. zlib's inflate has fuzzers of its own;
 * what is ours is the loop around it, its limit, and what it hands on to the formats behind. */
#include "bis/base/mem.h"
#include "files/gzip.h"
#include "input.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    bis_diag diag = {0};
    unsigned char *out;
    size_t n;
    const char *path = fuzz_file(data, size);
    const bis_status status = bis_gzip_read(&out, &n, path, (bis_loc){0}, &diag);
    fuzz_check_diag(status, &diag);
    fuzz_require((status == BIS_OK) == (out != NULL), "all of the file or nothing");
    fuzz_require(n <= BIS_GZIP_FREE || n <= size * BIS_GZIP_RATIO, "no more than the limit");
    if (out) fuzz_require(out[n] == 0, "a zero byte behind it");
    char head[256];
    fuzz_require(bis_gzip_head(head, sizeof head, path) <= sizeof head, "no more than asked for");
    bis_free(out);
    bis_diag_clear(&diag);
    fuzz_image(data, size);
    return 0;
}
