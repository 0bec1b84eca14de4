/* SPDX-License-Identifier: BSD-2-Clause */
/* lack: what happens without memory. A loop whose k-th turn lets the k-th allocation fail, until none fails:
 *     FOR_LACK(l) {
 *         LACK(l, bis_file_read(...));       l.status is what it returned; l.over: nothing failed
 *     } */
#ifndef TESTS_LACK_H
#define TESTS_LACK_H

#include "bis/base/mem.h"
#include "bis/base/status.h"
#include "claim.h"

#include <stdbool.h>

typedef struct lack {
    long k;
    bis_status status;
    bool over;
} lack;

#define FOR_LACK(l) for (lack l = {.k = 1}; !l.over; l.k++)
#define LACK(l, call) (bis_mem_fail_at((l).k), (l).status = (call), lack_judge(&(l)))

/* lack_judge demands that the call succeeded or says that there is no memory, and that the turns come to an end. */
static inline void lack_judge(lack *l)
{
    l->over = bis_mem_count() < l->k;
    bis_mem_fail_at(0);
    if (l->status != BIS_OK && (l->over || l->status != BIS_NOMEM))
        fail_msg("allocation %ld: status %d", l->k, (int)l->status);
    assert_true(l->k < 10000);
}

#endif
