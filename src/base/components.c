/* SPDX-License-Identifier: BSD-2-Clause */
/* components: bands are searched, then joined. */
#include "bis/base/components.h"

#include "bis/base/mem.h"

#include <stdatomic.h>
#include <string.h>

enum { BAND = 16 /* rows: of a map 16384 wide a thread searches 2.4 MB, which lie in its cache */ };

/* A map, and the labels that its pixels get. */
typedef struct map {
    uint32_t *label;
    const uint8_t *level;
    uint32_t width, height;
} map;

/* Labels the components of the band that begins at row y0. queue[BAND * width] is scratch. */
static void search_band(const map *m, uint32_t *queue, bis_flood *flood, uint32_t y0)
{
    const uint32_t width = m->width, below = m->height - y0, first = y0 * width;
    bis_search s = {m->level + first, m->label + first, queue, 0, 0, width, below < BAND ? below : BAND,
                    {false}, {false}};
    const uint32_t n = s.height * width;

    if (y0 > 0) memset(s.first_row_done, true, sizeof s.first_row_done);
    if (s.height < below) memset(s.last_row_done, true, sizeof s.last_row_done);
    for (uint32_t i = 0; i < n; i++) s.label[i] = BIS_COMPONENT_NONE;
    for (uint32_t i = 0; i < n; i++) {
        if (s.level[i] != BIS_LEVEL_NONE && s.label[i] == BIS_COMPONENT_NONE) flood(&s, i, first + i);
    }
}

static bis_status search_bands(const map *m, bis_flood *flood)
{
    const size_t rows = m->height < BAND ? m->height : BAND;
    atomic_bool failed = false;
#pragma omp parallel
    {
        uint32_t *queue = bis_alloc(rows * m->width, sizeof *queue);
        if (!queue) failed = true;
#pragma omp for schedule(dynamic)
        for (uint32_t y = 0; y < m->height; y += BAND) {
            if (queue) search_band(m, queue, flood, y);
        }
        bis_free(queue);
    }
    return failed ? BIS_NOMEM : BIS_OK;
}

/* Returns the first pixel of pixel i's component, as far as components are joined. Labels on the way get shorter. */
static uint32_t first_pixel(uint32_t *label, uint32_t i)
{
    while (label[i] != i) i = label[i] = label[label[i]];
    return i;
}

static void join_bands(const map *m)
{
    const uint32_t width = m->width, n = width * m->height;
    const uint8_t *level = m->level;
    uint32_t *label = m->label;

    for (uint32_t row = BAND * width; row < n; row += BAND * width) {
        for (uint32_t i = row; i < row + width; i++) {
            if (level[i] != level[i - width]) continue;
            if (label[i] == BIS_COMPONENT_NONE || label[i - width] == BIS_COMPONENT_NONE) continue; /* black */
            const uint32_t above = first_pixel(label, i - width), here = first_pixel(label, i);
            if (above < here) label[here] = above;
            else label[above] = here;
        }
    }
}

bis_status bis_components_find(uint32_t *label, const uint8_t *level, uint32_t width, uint32_t height,
                               bis_flood *flood)
{
    const map m = {label, level, width, height};
    const bis_status status = search_bands(&m, flood);

    if (!status) join_bands(&m);
    return status;
}
