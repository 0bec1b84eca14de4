/* SPDX-License-Identifier: BSD-2-Clause */
/* flat_claims: what the tests of flat share. A call of bis_flat_NAME whose status and words are judged:
 *     GIVES(light_shrink, &small, light, 8);                      it succeeds
 *     NO("0 columns", light_shrink, &none, light, 0);             it is BIS_INPUT and says so */
#ifndef TESTS_FLAT_CLAIMS_H
#define TESTS_FLAT_CLAIMS_H

#include "bis/base/status.h"
#include "bis/flat/stage.h"
#include "claim.h"
#include "lack.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static char say[512];
#define SAY say, sizeof say
#define GIVES(name, ...) gives(bis_flat_##name(__VA_ARGS__, SAY), #name, __LINE__)
#define NO(text, name, ...) refuses(bis_flat_##name(__VA_ARGS__, SAY), text, __LINE__)
/* The lists of settings and numbers that calls take. */
#define LIST(...) ((const char *const[]){__VA_ARGS__, NULL})
#define NONE ((const char *const[]){NULL})
#define D(...) ((double[]){__VA_ARGS__})
#define F(...) ((float[]){__VA_ARGS__})
#define U(...) ((uint32_t[]){__VA_ARGS__})
#define N_OF(a) (sizeof(a) / sizeof *(a))

static inline void gives(int status, const char *name, int line)
{
    if (status) fail_msg("line %d: %s: status %d, %s", line, name, status, say);
}

static inline void refuses(int status, const char *text, int line)
{
    if (status != BIS_INPUT || !strstr(say, text))
        fail_msg("line %d: status %d, no \"%s\" in: %s", line, status, text, say);
}

static inline void assert_about(double a, double b, double tolerance)
{
    if (!(fabs(a - b) <= tolerance)) fail_msg("%.12g is not %.12g", a, b);
}

/* Each of the steps 0 to n - 1, a call that frees what it made, while memory is short: it says so, and keeps no
 * block. */
static inline void assert_steps_without_memory(int (*step)(int k, void *of), int n, void *of)
{
    for (int k = 0; k < n; k++) {
        FOR_LACK(l) {
            const long live = bis_mem_live();
            LACK(l, (bis_status)step(k, of));
            if ((l.status == BIS_NOMEM) != (*say != 0)) fail_msg("step %d: %s", k, say);
            assert_int_equal(bis_mem_live(), live);
            assert_true(!l.over || l.k > 1);
        }
    }
}

/* The rows of a PFM go from the bottom up. */
static inline void write_pfm(const char *path, int width, int height, const float *rgb_bottom_up)
{
    FILE *out = fopen(path, "wb");
    assert_non_null(out);
    fprintf(out, "PF\n%d %d\n-1.0\n", width, height);
    fwrite(rgb_bottom_up, sizeof *rgb_bottom_up, 3 * (size_t)width * (size_t)height, out);
    assert_int_equal(fclose(out), 0);
}

#endif
