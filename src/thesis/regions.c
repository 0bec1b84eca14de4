/* SPDX-License-Identifier: BSD-2-Clause */
/* regions: the light sources of a map, as in thesis 3.4 and figure 3.6.
 *
 * There are three steps, and each is linear. (1) Every pixel gets a level: equal bins of the logarithm of its
 * intensity. (2) A breadth-first search from each pixel without a label gives one label to its whole component. (3)
 * The solid angles of the pixels are summed by label. A pixel enters the queue once, so one array of the map's size
 * serves all searches.
 *
 * On the sphere the left and right edges of the map touch. All pixels of the first row also touch, at the pole, and
 * likewise all of the last row (docs/errata.md E19; "the pixel opposite" would depend on whether W is even). To visit
 * a whole row from each of its pixels would cost W^2. Instead, the first pixel of a level that a search meets in such
 * a row enqueues all pixels of this level in the row, and the level is then done for this row. */
#include "bis/thesis/regions.h"

#include "bis/base/mem.h"

#include <assert.h>
#include <float.h>

bis_levels bis_levels_of(const bis_envmap *em, int levels)
{
    assert(levels >= 1 && levels < BIS_LEVEL_NONE);
    const size_t n = (size_t)em->width * (size_t)em->height;
    double least = DBL_MAX, most = 0;
    for (size_t i = 0; i < n; i++) {
        const double intensity = rgb_sum(em->pixels[i]);
        if (intensity > 0 && intensity < least) least = intensity;
        if (intensity > most) most = intensity;
    }
    return (bis_levels){levels, least, most > 0 ? log(most / least) : 0};
}

/* [level] */
uint8_t bis_level_of_intensity(const bis_levels *l, double intensity)
{
    if (intensity == 0) return BIS_LEVEL_NONE;
    if (l->log_range == 0) return 0;
    const double bin = l->n * log(intensity / l->least) / l->log_range;
    return (uint8_t)fmin(bin, l->n - 1); /* the brightest pixel stands on the last bin's upper edge */
}
/* [end] */

/* The state of one search. */
typedef struct search {
    const uint8_t *level; /* level[height * width] */
    uint32_t *label;
    uint32_t *queue; /* queue[height * width]: each pixel enters once */
    size_t head, tail;
    uint32_t width, height;
    bool first_row_done[BIS_LEVEL_NONE], last_row_done[BIS_LEVEL_NONE]; /* by level */
} search;

static void visit(search *s, uint32_t pixel, uint8_t level, uint32_t label)
{
    if (s->level[pixel] != level || s->label[pixel] != BIS_REGION_NONE) return;
    s->label[pixel] = label;
    s->queue[s->tail++] = pixel;
}

static void visit_row(search *s, uint32_t y, uint8_t level, uint32_t label, bool *done)
{
    if (*done) return;
    *done = true;
    for (uint32_t x = 0; x < s->width; x++) visit(s, y * s->width + x, level, label);
}

/* [bfs] */
static void flood(search *s, uint32_t start, uint32_t label)
{
    const uint8_t level = s->level[start];
    const uint32_t width = s->width;
    visit(s, start, level, label);
    while (s->head < s->tail) {
        const uint32_t pixel = s->queue[s->head++];
        const uint32_t x = pixel % width, y = pixel / width;
        visit(s, x > 0 ? pixel - 1 : pixel + (width - 1), level, label);
        visit(s, x + 1 < width ? pixel + 1 : pixel - (width - 1), level, label);
        if (y > 0) {
            visit(s, pixel - width, level, label);
        } else {
            visit_row(s, y, level, label, &s->first_row_done[level]);
        }
        if (y + 1 < s->height) {
            visit(s, pixel + width, level, label);
        } else {
            visit_row(s, y, level, label, &s->last_row_done[level]);
        }
    }
}
/* [end] */

static void find_levels(uint8_t *level, const bis_envmap *em, int levels)
{
    const bis_levels l = bis_levels_of(em, levels);
#pragma omp parallel for
    for (int y = 0; y < em->height; y++) {
        const size_t row = (size_t)y * (size_t)em->width;
        for (size_t i = row; i < row + (size_t)em->width; i++)
            level[i] = bis_level_of_intensity(&l, rgb_sum(em->pixels[i]));
    }
}

/* Computes the solid angle and the level of each component, after their number is known. */
static bis_status sum_up(bis_regions *r, const bis_envmap *em, const uint8_t *level, bis_diag *diag)
{
    r->solid_angle = bis_alloc(r->n, sizeof *r->solid_angle);
    r->level = bis_alloc(r->n, sizeof *r->level);
    if (!r->solid_angle || !r->level) {
        return bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for the %u regions of a map", r->n);
    }
    for (int y = 0; y < em->height; y++) {
        const size_t row = (size_t)y * (size_t)em->width;
        for (size_t i = row; i < row + (size_t)em->width; i++) {
            if (r->label[i] == BIS_REGION_NONE) continue;
            r->solid_angle[r->label[i]] += em->row_solid_angle[y];
            r->level[r->label[i]] = level[i];
        }
    }
    return BIS_OK;
}

bis_status bis_regions_init(bis_regions *r, const bis_envmap *em, int levels, bis_diag *diag)
{
    bis_status status = BIS_OK;
    const size_t n = (size_t)em->width * (size_t)em->height;
    uint8_t *level = bis_alloc(n, sizeof *level);
    uint32_t *queue = bis_alloc(n, sizeof *queue);
    *r = (bis_regions){.label = bis_alloc(n, sizeof *r->label)};
    if (!level || !queue || !r->label) {
        status = bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for the regions of a %d x %d map", em->width,
                           em->height);
        goto done;
    }
    find_levels(level, em, levels);
    for (size_t i = 0; i < n; i++) r->label[i] = BIS_REGION_NONE;
    search s = {.level = level,
                .label = r->label,
                .queue = queue,
                .width = (uint32_t)em->width,
                .height = (uint32_t)em->height};
    for (uint32_t i = 0; i < n; i++) {
        if (level[i] != BIS_LEVEL_NONE && r->label[i] == BIS_REGION_NONE) flood(&s, i, r->n++);
    }
    bis_free(queue);
    queue = NULL;
    status = sum_up(r, em, level, diag);
done:
    bis_free(level);
    bis_free(queue);
    if (status) bis_regions_clear(r);
    return status;
}

void bis_regions_clear(bis_regions *r)
{
    bis_free(r->label);
    bis_free(r->solid_angle);
    bis_free(r->level);
    *r = (bis_regions){0};
}

double bis_area_factor(double solid_angle, double b) { return pow(fmin(1, solid_angle / BIS_AREA_CLAMP), b); }
