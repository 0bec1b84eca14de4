/* SPDX-License-Identifier: BSD-2-Clause */
/* display: shows a render in tev (https://github.com/Tom94/tev) while it is made, by tev's protocol over TCP.
 *
 * A thread of its own sends, so that a viewer that is slow, stuck or gone never holds up the render. The picture is
 * copied between two passes, or in the first one as far as it is. After the first copy that is only done while all
 * copying and sending has taken less than BIS_DISPLAY_SHARE of the time. */
#pragma once

#include "bis/render/film.h"

#define BIS_DISPLAY_SHARE 0.02

typedef struct bis_display bis_display;

/* bis_display_is_address returns whether text is HOST:PORT with a port in [1, 65535], or [ADDRESS]:PORT. */
bool bis_display_is_address(const char *text);

/* bis_display_open starts the thread, which connects to `where` and makes an image called `name` of the film's full
 * size. The film must be initialised. Errors: BIS_NOMEM. That nobody listens is no error: bis_display_close tells. */
bis_status bis_display_open(bis_display **out, const char *where, const char *name, const bis_film *film,
                            bis_diag *diag);

/* bis_display_is_left returns true if a thread was left to wait for a name server when its display was closed. The
 * thread keeps its memory until the process ends. */
bool bis_display_is_left(void);

/* bis_display_offer sends the film's complete passes, if there are new ones, the thread has sent the last ones, and the
 * time allows it. It may be called by any one thread while no pass is being added to the film. */
void bis_display_offer(bis_display *d, const bis_film *film);

/* bis_display_offer_pixels sends rgba[height][width][4] of the film's size on the same terms; they are always new. */
void bis_display_offer_pixels(bis_display *d, const float *rgba);

/* bis_display_close sends the film, if it is given, waits until it is sent or the viewer has read nothing for a second,
 * and frees d; NULL is allowed. If there is no connection after 3 s, because no name server answers, it leaves d to the
 * thread. A warning says what went wrong. */
void bis_display_close(bis_display *d, const bis_film *film, bis_diag *diag);
