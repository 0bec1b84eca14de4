/* SPDX-License-Identifier: BSD-2-Clause */
/* ranks: all ranks agree before they begin. */
#include "ranks.h"

#include "base/text.h"

#include <string.h>

enum { MOST_TEXT = 1024, HOST = 64 };

/* What a rank tells of itself. */
typedef struct report {
    int32_t status, n_threads;
    char host[HOST], text[MOST_TEXT];
    uint64_t parts[BIS_IDENTITY_PARTS];
} report;

static report report_of(const bis_ranks *ranks)
{
    report r;
    memset(&r, 0, sizeof r);
    bis_append(r.host, sizeof r.host, "%s", ranks->host);
    return r;
}

/* Without the head of a message that has no place, of the library or of the program: the one that it becomes a part of
 * has it, too. */
static const char *first_error(const bis_diag *diag)
{
    static const char *const heads[] = {"error: ", "bis: error: "};
    size_t i = 0;

    while (diag && i < diag->n && !diag->messages[i].is_error) i++;
    if (!diag || i == diag->n) return "no memory for a message";
    const char *text = diag->messages[i].text;
    for (int k = 0; k < 2; k++)
        if (strncmp(text, heads[k], strlen(heads[k])) == 0) return text + strlen(heads[k]);
    return text;
}

/* The report of a rank, which all then have. */
static report told_by(bis_ranks *ranks, int rank, const report *own)
{
    report r = *own;
    ranks->broadcast(ranks, rank, &r, sizeof r);
    return r;
}

bis_status bis_ranks_agree(bis_ranks *ranks, bis_status status, bis_diag *diag)
{
    if (!ranks) return status;
    report own = report_of(ranks), worst = {0};
    int failing = 0;

    own.status = (int32_t)status;
    if (status) bis_append(own.text, sizeof own.text, "%s", first_error(diag));
    for (int i = 0; i < ranks->size; i++) {
        const report r = told_by(ranks, i, &own);
        if (r.status && !worst.status) worst = r, failing = i;
    }
    if (ranks->rank == 0 && !status && worst.status)
        bis_error(diag, (bis_status)worst.status, (bis_loc){0}, "rank %d on \"%s\" cannot go on: %s", failing,
                  worst.host, worst.text);
    return (bis_status)worst.status;
}

bis_status bis_ranks_compare(bis_ranks *ranks, const uint64_t parts[BIS_IDENTITY_PARTS], int *n_threads,
                             bis_diag *diag)
{
    report own = report_of(ranks), first = own;
    bis_status status = BIS_OK;
    int sum = 0;

    own.n_threads = *n_threads;
    memcpy(own.parts, parts, sizeof own.parts);
    for (int i = 0; i < ranks->size; i++) {
        char list[1024];
        const report r = told_by(ranks, i, &own);
        if (i == 0) first = r;
        sum += r.n_threads;
        if (!bis_identity_differs(list, sizeof list, first.parts, r.parts)) continue;
        status = BIS_INPUT;
        if (ranks->rank == 0)
            bis_error(diag, BIS_INPUT, (bis_loc){0}, "rank %d on \"%s\" has read another scene than rank 0 on \"%s\". "
                      "These differ: %s. Give all machines the same files", i, r.host, ranks->host, list);
    }
    *n_threads = sum;
    return status;
}
