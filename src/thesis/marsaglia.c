/* SPDX-License-Identifier: BSD-2-Clause */
/* marsaglia: the list L of thesis 3.2.2 and figure 3.3 (Marsaglia 1963, "Generating Discrete Random Variables in a
 * Computer").
 *
 *     P = {0.1, 0.2, 0.4, 0.3}    L = {0, 1, 1, 2, 2, 2, 2, 3, 3, 3}    x = L[floor(u |L|)]
 *
 * |L| is the least common denominator of P: the sum of the weights after their greatest common divisor is cancelled.
 * {1/2953, 2952/2953} needs 2953 elements (docs/errata.md E11), and two irrational numbers have no list at all. The
 * alias method was invented for this reason. L is sorted, so the probability of i is the length of its run over |L|. */
#include "bis/thesis/marsaglia.h"
#include "bis/base/mem.h"

#include <assert.h>

static uint64_t gcd(uint64_t a, uint64_t b)
{
    while (b) {
        uint64_t rest = a % b;
        a = b;
        b = rest;
    }
    return a;
}

bis_status bis_marsaglia_init(bis_marsaglia *m, const uint64_t *w, size_t n, bis_diag *diag)
{
    const bis_loc nowhere = {0};
    uint64_t divisor = 0;
    double length = 0; /* a double, because the sum of the weights may exceed 2^64 */
    size_t k = 0;

    *m = (bis_marsaglia){.n = n};
    assert(n <= UINT32_MAX);
    for (size_t i = 0; i < n; i++)
        divisor = gcd(divisor, w[i]);
    if (divisor == 0) return BIS_OK;
    for (size_t i = 0; i < n; i++)
        length += (double)(w[i] / divisor);
    if (length > (double)BIS_MARSAGLIA_MAX_LENGTH)
        return bis_error(diag, BIS_INPUT, nowhere,
                         "Marsaglia's list for %zu items would have %.0f elements, at most %zu are allowed: "
                         "use the alias method, whose tables have %zu",
                         n, length, BIS_MARSAGLIA_MAX_LENGTH, n);
    m->list = bis_alloc((size_t)length, sizeof *m->list);
    if (!m->list)
        return bis_error(diag, BIS_NOMEM, nowhere, "no memory for Marsaglia's list of %.0f elements", length);
    m->length = (size_t)length;
    for (size_t i = 0; i < n; i++)
        for (uint64_t copies = w[i] / divisor; copies > 0; copies--)
            m->list[k++] = (uint32_t)i;
    return BIS_OK;
}

void bis_marsaglia_clear(bis_marsaglia *m)
{
    bis_free(m->list);
    *m = (bis_marsaglia){0};
}

size_t bis_marsaglia_sample(const bis_marsaglia *m, double u)
{
    assert(m->length > 0 && u >= 0 && u < 1);
    return m->list[(size_t)(u * (double)m->length)]; /* below length: see src/thesis/alias.c */
}

/* Returns where the run of the first item >= i begins in L. */
static size_t run_begin(const bis_marsaglia *m, size_t i)
{
    size_t low = 0, high = m->length;
    while (low < high) {
        size_t middle = (low + high) / 2;
        if (m->list[middle] < i)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

double bis_marsaglia_pmf(const bis_marsaglia *m, size_t i)
{
    if (m->length == 0) return 0;
    return (double)(run_begin(m, i + 1) - run_begin(m, i)) / (double)m->length;
}
