/* batch: sir.c for all candidates of a point at once. For src/thesis/sir.c and the workspace of integrator.c alone. */
#ifndef BIS_BATCH_H
#define BIS_BATCH_H

#include "bis/thesis/integrator.h"

/* Do these settings want a batch? Its workspace is made then. */
bool bis_batch_wanted(const bis_settings *s);

/* Its workspace. NULL: no memory. */
bis_batch *bis_batch_new(const bis_settings *s);
void bis_batch_free(bis_batch *b);
size_t bis_batch_bytes(const bis_settings *s);

/* Can it be used at pt? There is a workspace and a pool with lanes, the material knows lanes, and something is
 * reflected. */
bool bis_batch_fits(const bis_point *pt, const bis_scratch *scratch);

/* One estimate, as bis_sir.Lo. Neither the material nor the light is black. */
rgb bis_batch_Lo(const bis_settings *s, const bis_point *pt, bis_stream *stream, bis_scratch *scratch);

#endif
