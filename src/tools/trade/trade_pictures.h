/* SPDX-License-Identifier: BSD-2-Clause */
/* trade_pictures: what is rendered beside the runs: references (trade_reference.c) and pictures of equal time. */
#pragma once

#include "trade.h"

/* bis_trade_make_references reads what references/ holds and renders what it lacks. If it is interrupted, is_ready
 * stays false where replicates are missing. */
bis_status bis_trade_make_references(bis_trade *t, bis_diag *diag);

/* bis_trade_thin makes of a given reference, which has the size of film `all`, that of the thin film `some` of the same
 * picture. Errors: BIS_NOMEM. */
bis_status bis_trade_thin(bis_image *out, const bis_image *full, const bis_film *all, const bis_film *some,
                          bis_diag *diag);

/* bis_trade_make_pictures reads from pictures/, or renders, pictures of equal time of the best setting of each
 * integrator. */
bis_status bis_trade_make_pictures(bis_trade *t, bis_diag *diag);
