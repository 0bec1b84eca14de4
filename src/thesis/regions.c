/* SPDX-License-Identifier: BSD-2-Clause */
/* regions: the light sources of a map, as in thesis 3.4 and figure 3.6.
 *
 * There are three steps, and each is linear. (1) Every pixel gets a level: equal bins of the logarithm of its
 * intensity. (2) A breadth-first search from each pixel without a label gives one label to its whole component. (3)
 * The solid angles of the pixels are summed by label.
 *
 * A search through a map of 10^8 pixels would wait for memory at each step. The map is therefore cut into bands of
 * rows. Each is searched on its own, all threads share the bands, and a pixel enters the queue of its band once. The
 * first label is the pixel where the search began. Components of two bands that touch are then joined by union and
 * find: the larger of their first pixels gets the smaller one as its label. Labels become numbers from 0 on, in the
 * order of the first pixels, so the bands change no label.
 *
 * On the sphere the left and right edges of the map touch. All pixels of the first row also touch, at the pole, and
 * likewise all of the last row (docs/errata.md E19; "the pixel opposite" would depend on whether W is even). To visit
 * a whole row from each of its pixels would cost W^2. Instead, the first pixel of a level that a search meets in such
 * a row enqueues all pixels of this level in the row, and the level is then done for this row. */
#include "bis/thesis/regions.h"

#include "bis/base/mem.h"

#include <assert.h>
#include <float.h>
#include <stdatomic.h>
#include <string.h>

bis_levels bis_levels_of(const bis_envmap *em, int levels)
{
    assert(levels >= 1 && levels < BIS_LEVEL_NONE);
    const size_t n = (size_t)em->width * (size_t)em->height;
    double least = DBL_MAX, most = 0;
#pragma omp parallel for reduction(min : least) reduction(max : most)
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

enum { BAND = 16 /* rows: of a map 16384 wide a thread searches 2.4 MB, which lie in its cache */ };

/* The state of the searches in a band: a piece of the map of full width. Pixels are counted from its first one. */
typedef struct search {
    const uint8_t *level; /* level[height * width] */
    uint32_t *label;
    uint32_t *queue; /* queue[height * width]: each pixel enters once */
    size_t head, tail;
    uint32_t width, height;
    bool first_row_done[BIS_LEVEL_NONE], last_row_done[BIS_LEVEL_NONE]; /* by level; all, if the row is at no pole */
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

/* Stores the least intensity of each level, so that no pixel needs a logarithm: levels grow with the intensity. Doubles
 * above 0 are in the order of their bits, of which one after the other is found. */
static void find_bounds(double bound[BIS_LEVEL_NONE + 1], const bis_levels *l)
{
    bound[0] = 0;
    for (int k = 1; k < l->n; k++) {
        uint64_t bits = 0;
        for (uint64_t bit = (uint64_t)1 << 62; bit; bit >>= 1) { /* the most bits of a lower level */
            const uint64_t more = bits | bit;
            double intensity;
            memcpy(&intensity, &more, sizeof intensity);
            if (intensity < l->least) bits = more; /* below all levels */
            else if (intensity < DBL_MAX && bis_level_of_intensity(l, intensity) < k) bits = more;
        }
        bits++;
        memcpy(&bound[k], &bits, sizeof bits);
    }
    bound[l->n] = (double)INFINITY;
}

/* Finds the levels of n pixels, each from that of the pixel before, because few differ much from their neighbours. */
static void find_levels(uint8_t *level, const double *bound, const rgb *pixels, size_t n)
{
    int k = 0;
    for (size_t i = 0; i < n; i++) {
        const double intensity = rgb_sum(pixels[i]);
        while (intensity >= bound[k + 1]) k++;
        while (intensity < bound[k]) k--;
        level[i] = intensity > 0 ? (uint8_t)k : BIS_LEVEL_NONE;
    }
}

/* Finds the levels of the band that begins at row y0, and labels its components. queue[BAND * width] is scratch. */
static void search_band(uint8_t *level, uint32_t *label, uint32_t *queue, const bis_envmap *em, const double *bound,
                        uint32_t y0)
{
    const uint32_t width = (uint32_t)em->width, below = (uint32_t)em->height - y0, first = y0 * width;
    search s = {level + first, label + first, queue, 0, 0, width, below < BAND ? below : BAND, {false}, {false}};
    const uint32_t n = s.height * width;

    if (y0 > 0) memset(s.first_row_done, true, sizeof s.first_row_done);
    if (s.height < below) memset(s.last_row_done, true, sizeof s.last_row_done);
    find_levels(level + first, bound, em->pixels + first, n);
    for (uint32_t i = 0; i < n; i++) s.label[i] = BIS_REGION_NONE;
    for (uint32_t i = 0; i < n; i++) {
        if (s.level[i] != BIS_LEVEL_NONE && s.label[i] == BIS_REGION_NONE) flood(&s, i, first + i);
    }
}

static bis_status search_bands(uint8_t *level, uint32_t *label, const bis_envmap *em, const double *bound)
{
    const uint32_t width = (uint32_t)em->width, height = (uint32_t)em->height;
    const size_t rows = height < BAND ? height : BAND;
    atomic_bool failed = false;
#pragma omp parallel
    {
        uint32_t *queue = bis_alloc(rows * width, sizeof *queue);
        if (!queue) failed = true;
#pragma omp for schedule(dynamic)
        for (uint32_t y = 0; y < height; y += BAND) {
            if (queue) search_band(level, label, queue, em, bound, y);
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

static void join_bands(uint32_t *label, const uint8_t *level, const bis_envmap *em)
{
    const uint32_t width = (uint32_t)em->width, n = width * (uint32_t)em->height;
    for (uint32_t row = BAND * width; row < n; row += BAND * width) {
        for (uint32_t i = row; i < row + width; i++) {
            if (level[i] != level[i - width]) continue;
            if (label[i] == BIS_REGION_NONE || label[i - width] == BIS_REGION_NONE) continue; /* black */
            const uint32_t above = first_pixel(label, i - width), here = first_pixel(label, i);
            if (above < here) label[here] = above;
            else label[above] = here;
        }
    }
}

/* Numbers the components, and computes the solid angle and the level of each. A label that is no number yet is a pixel
 * before this one, which has its number. */
static void sum_up(bis_regions *r, const bis_envmap *em, const uint8_t *level)
{
    const uint32_t width = (uint32_t)em->width;
    uint32_t n = 0;
    for (uint32_t y = 0, i = 0; y < (uint32_t)em->height; y++) {
        for (const uint32_t end = i + width; i < end;) {
            const uint32_t label = r->label[i];
            const uint32_t k = label == BIS_REGION_NONE ? label : label < i ? r->label[label] : n++;
            if (label == i) r->level[k] = level[i];
            double sum = k == BIS_REGION_NONE ? 0 : r->solid_angle[k];
            for (; i < end && r->label[i] == label; i++) {
                r->label[i] = k;
                sum += em->row_solid_angle[y];
            }
            if (k != BIS_REGION_NONE) r->solid_angle[k] = sum;
        }
    }
}

bis_status bis_regions_init(bis_regions *r, const bis_envmap *em, int levels, bis_diag *diag)
{
    const uint32_t n = (uint32_t)em->width * (uint32_t)em->height;
    const bis_levels l = bis_levels_of(em, levels);
    double bound[BIS_LEVEL_NONE + 1];
    uint8_t *level = bis_alloc(n, sizeof *level);
    uint32_t n_regions = 0;
    find_bounds(bound, &l);
    *r = (bis_regions){.label = bis_alloc(n, sizeof *r->label)};
    bis_status status = level && r->label ? search_bands(level, r->label, em, bound) : BIS_NOMEM;
    if (status) goto done;
    join_bands(r->label, level, em);
#pragma omp parallel for reduction(+ : n_regions)
    for (uint32_t i = 0; i < n; i++) n_regions += r->label[i] == i;
    r->n = n_regions;
    r->solid_angle = bis_alloc(r->n, sizeof *r->solid_angle);
    r->level = bis_alloc(r->n, sizeof *r->level);
    if (r->solid_angle && r->level) sum_up(r, em, level);
    else status = BIS_NOMEM;
done:
    bis_free(level);
    if (!status) return BIS_OK;
    bis_regions_clear(r);
    return bis_error(diag, status, (bis_loc){0}, "no memory for the regions of a %d x %d map", em->width, em->height);
}

void bis_regions_clear(bis_regions *r)
{
    bis_free(r->label);
    bis_free(r->solid_angle);
    bis_free(r->level);
    *r = (bis_regions){0};
}

double bis_area_factor(double solid_angle, double b) { return pow(fmin(1, solid_angle / BIS_AREA_CLAMP), b); }
