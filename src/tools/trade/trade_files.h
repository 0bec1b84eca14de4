/* SPDX-License-Identifier: BSD-2-Clause */
/* trade_files: what the folder holds: plan.txt, runs.csv, and whatever else is written into it. */
#pragma once

#include "trade.h"

/* bis_trade_path writes folder/name to buf and returns it. */
const char *bis_trade_path(char buf[4096], const bis_trade *t, const char *name);

typedef void bis_trade_put(FILE *out, const bis_trade *t);

/* bis_trade_write writes a file of the folder: what put prints. Errors: BIS_IO, BIS_NOMEM. */
bis_status bis_trade_write(const bis_trade *t, const char *name, bis_trade_put *put, bis_diag *diag);

/* bis_trade_check_folder makes the folder. It must be new or empty or, with --resume, one of ours; an empty one turns
 * o.resume off. bis_trade_make_folder makes one in it. Errors: BIS_INPUT, BIS_IO. */
bis_status bis_trade_check_folder(bis_trade *t, bis_diag *diag);
bis_status bis_trade_make_folder(const bis_trade *t, const char *name, bis_diag *diag);

/* bis_trade_write_plan writes plan.txt, bis_trade_write_runs runs.csv; the others read them. Errors: BIS_INPUT, BIS_IO,
 * BIS_NOMEM. */
bis_status bis_trade_write_plan(bis_trade *t, bis_diag *diag);
bis_status bis_trade_read_plan(bis_trade *t, bis_diag *diag);
bis_status bis_trade_write_runs(const bis_trade *t, bis_diag *diag);
bis_status bis_trade_read_runs(bis_trade *t, bis_diag *diag);

/* bis_trade_find_run returns the run of these, or NULL. */
const bis_trade_run *bis_trade_find_run(const bis_trade *t, int setting, int level, int replicate);

/* bis_trade_add_run adds a run to the list and to runs.csv. Errors: BIS_IO, BIS_NOMEM. */
bis_status bis_trade_add_run(bis_trade *t, const bis_trade_run *run, bis_diag *diag);
