/* SPDX-License-Identifier: BSD-2-Clause */
/* components: the connected sets of pixels of one level, of a map of any size, by all threads.
 *
 * A search through a map of 10^8 pixels would wait for memory at each step. The map is therefore cut into bands of
 * rows. Each is searched on its own, all threads share the bands, and a pixel enters the queue of its band once. The
 * first label is the pixel where the search began. Components of two bands that touch are then joined by union and
 * find: the larger of their first pixels gets the smaller one as its label. So the bands change no label.
 *
 * The search itself, and with it what is connected, is the caller's: a bis_flood. */
#pragma once

#include "bis/base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define BIS_COMPONENT_NONE UINT32_MAX /* the label of a pixel that is in no component */
#define BIS_LEVEL_NONE UINT8_MAX      /* the level of such a pixel */

/* The state of the searches in a band: a piece of the map of full width. Pixels are counted from its first one. */
typedef struct bis_search {
    const uint8_t *level; /* level[height * width] */
    uint32_t *label;      /* label[height * width]; BIS_COMPONENT_NONE: not yet met */
    uint32_t *queue;      /* queue[height * width]: each pixel enters once */
    size_t head, tail;
    uint32_t width, height;
    bool first_row_done[BIS_LEVEL_NONE], last_row_done[BIS_LEVEL_NONE]; /* by level; all, if the row is not the map's */
} bis_search;

/* A search from pixel start, which has a level and no label. It gives `label` to all pixels of the band that are
 * connected with it, and leaves the queue empty: head = tail. */
typedef void bis_flood(bis_search *s, uint32_t start, uint32_t label);

/* bis_components_find stores in label[height * width] the first pixel of the component of each pixel, or
 * BIS_COMPONENT_NONE. Pixels of equal level that lie one above the other are connected, too. height * width <
 * UINT32_MAX. Memory: 64 bytes a column for each thread. Errors: BIS_NOMEM. */
bis_status bis_components_find(uint32_t *label, const uint8_t *level, uint32_t width, uint32_t height,
                               bis_flood *flood);
