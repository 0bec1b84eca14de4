/* SPDX-License-Identifier: BSD-2-Clause */
/* regions: the light sources of a map, as in thesis 3.4 and figure 3.6.
 *
 * There are three steps, and each is linear. (1) Every pixel gets a level: equal bins of the logarithm of its
 * intensity. (2) A breadth-first search from each pixel without a label gives one label to its whole component. (3)
 * The solid angles of the pixels are summed by label.
 *
 * The first label is the pixel where the search began. A large map is searched in bands of rows by all threads, and the
 * components of bands that touch are joined (bis/base/components.h). Labels become numbers from 0 on, in the order of
 * the first pixels.
 *
 * On the sphere the left and right edges of the map touch. All pixels of the first row also touch, at the pole, and
 * likewise all of the last row (docs/errata.md E19; "the pixel opposite" would depend on whether W is even). To visit
 * a whole row from each of its pixels would cost W^2. Instead, the first pixel of a level that a search meets in such
 * a row enqueues all pixels of this level in the row, and the level is then done for this row. */
#include "bis/thesis/regions.h"

#include "bis/base/components.h"
#include "bis/base/mem.h"

#include <assert.h>
#include <float.h>
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

static void visit(bis_search *s, uint32_t pixel, uint8_t level, uint32_t label)
{
    if (s->level[pixel] != level || s->label[pixel] != BIS_REGION_NONE) return;
    s->label[pixel] = label;
    s->queue[s->tail++] = pixel;
}

static void visit_row(bis_search *s, uint32_t y, uint8_t level, uint32_t label, bool *done)
{
    if (*done) return;
    *done = true;
    for (uint32_t x = 0; x < s->width; x++) visit(s, y * s->width + x, level, label);
}

/* [bfs] */
static void flood(bis_search *s, uint32_t start, uint32_t label)
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

/* Finds the levels of all pixels, each from that of the pixel before, because few differ much from their neighbours. */
static void find_levels(uint8_t *level, const double *bound, const bis_envmap *em)
{
    const size_t width = (size_t)em->width, height = (size_t)em->height;
#pragma omp parallel for
    for (size_t y = 0; y < height; y++) {
        int k = 0;
        for (size_t i = y * width; i < (y + 1) * width; i++) {
            const double intensity = rgb_sum(em->pixels[i]);
            while (intensity >= bound[k + 1]) k++;
            while (intensity < bound[k]) k--;
            level[i] = intensity > 0 ? (uint8_t)k : BIS_LEVEL_NONE;
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
    bis_status status = BIS_NOMEM;
    *r = (bis_regions){.label = bis_alloc(n, sizeof *r->label)};
    if (!level || !r->label) goto done;
    find_bounds(bound, &l);
    find_levels(level, bound, em);
    status = bis_components_find(r->label, level, (uint32_t)em->width, (uint32_t)em->height, flood);
    if (status) goto done;
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
