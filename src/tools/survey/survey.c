/* SPDX-License-Identifier: BSD-2-Clause */
/* survey: the figures by which one judges a map before rendering with it: contrast, and how little of the sphere holds
 * how much of the power, which is what importance sampling (thesis 3.3) lives on; the levels and regions of 3.4.
 *
 * Median and brightest share are quantiles by solid angle. Instead of sorting the pixels we count them into cells of
 * equal leading bits of the intensity (its exponent and 12 bits of the mantissa): linear time, 16 MB whatever the map,
 * and the quantile is known to 1 part in 4096. */
#include "survey.h"

#include "bis/base/mem.h"

#include <float.h>
#include <string.h>

static size_t pixels_of(const bis_envmap *em) { return (size_t)em->width * (size_t)em->height; }

/* Of pixel i, in sr. */
static double solid_angle_of(const bis_envmap *em, size_t i) { return em->row_solid_angle[i / (size_t)em->width]; }

/* ---- quantiles ---- */

enum { MANTISSA_BITS = 12 };
/* Intensities reach from 2^-149, the smallest float, to 3 * 2^128. */
#define FIRST_CELL ((uint64_t)(1023 - 149) << MANTISSA_BITS)
#define N_CELLS ((size_t)(149 + 130) << MANTISSA_BITS)

typedef struct cell {
    double solid_angle, power;
} cell;

static size_t cell_of(double intensity)
{
    uint64_t bits;
    memcpy(&bits, &intensity, sizeof bits);
    return (size_t)((bits >> (52 - MANTISSA_BITS)) - FIRST_CELL);
}

static void fill_cells(cell *cells, const bis_envmap *em)
{
    for (size_t i = 0; i < pixels_of(em); i++) {
        const double intensity = rgb_sum(em->pixels[i]);
        if (intensity == 0) continue;
        cell *c = &cells[cell_of(intensity)];
        c->solid_angle += solid_angle_of(em, i);
        c->power += intensity * solid_angle_of(em, i);
    }
}

/* Walk from the brightest cell down until `share` of the sphere is covered. Returns the mean intensity of the cell
 * reached (0: the black part is); *power: what lies above, the last cell in proportion. */
static double from_the_top(const cell *cells, double share, double *power)
{
    double left = share * 4 * PI;
    *power = 0;
    for (size_t k = N_CELLS; k-- > 0;) {
        const cell *c = &cells[k];
        if (c->solid_angle == 0) continue;
        if (c->solid_angle >= left) {
            *power += c->power * (left / c->solid_angle);
            return c->power / c->solid_angle;
        }
        left -= c->solid_angle;
        *power += c->power;
    }
    return 0;
}

/* ---- the whole map ---- */

static void sum_map(bis_survey *s, const bis_envmap *em)
{
    s->least = DBL_MAX;
    for (size_t i = 0; i < pixels_of(em); i++) {
        const rgb c = em->pixels[i];
        const double intensity = rgb_sum(c), solid_angle = solid_angle_of(em, i);
        s->mean_rgb[0] += (double)c.r * solid_angle / (4 * PI);
        s->mean_rgb[1] += (double)c.g * solid_angle / (4 * PI);
        s->mean_rgb[2] += (double)c.b * solid_angle / (4 * PI);
        if (intensity == 0) s->black += solid_angle / (4 * PI);
        if (intensity > 0 && intensity < s->least) s->least = intensity;
        if (intensity <= s->most) continue;
        s->most = intensity;
        s->peak = i;
    }
    if (s->most == 0) s->least = 0;
    s->power = bis_envmap_power(em);
    s->mean = s->power / (4 * PI);
}

/* ---- levels and regions ---- */

static void sum_levels(bis_survey *s, const bis_envmap *em, const bis_regions *regions, int levels)
{
    const bis_levels l = bis_levels_of(em, levels);
    if (s->most == 0) return;
    s->n_levels = l.log_range > 0 ? levels : 1;
    for (int k = 0; k < s->n_levels; k++) {
        s->level[k].least = l.least * exp(l.log_range * k / s->n_levels);
        s->level[k].most = l.least * exp(l.log_range * (k + 1) / s->n_levels);
    }
    for (uint32_t k = 0; k < regions->n; k++) s->level[regions->level[k]].regions++;
    for (size_t i = 0; i < pixels_of(em); i++) {
        if (regions->label[i] == BIS_REGION_NONE) continue;
        bis_survey_level *level = &s->level[regions->level[regions->label[i]]];
        level->pixels++;
        level->sphere += solid_angle_of(em, i) / (4 * PI);
        level->power += rgb_sum(em->pixels[i]) * solid_angle_of(em, i) / s->power;
    }
}

/* Insert region k among the largest, sorted by power. */
static void insert_largest(bis_survey *s, bis_survey_region candidate)
{
    int place = s->n_largest;
    while (place > 0 && s->largest[place - 1].power < candidate.power) place--;
    if (place == BIS_SURVEY_LARGEST) return;
    if (s->n_largest < BIS_SURVEY_LARGEST) s->n_largest++;
    for (int i = s->n_largest - 1; i > place; i--) s->largest[i] = s->largest[i - 1];
    s->largest[place] = candidate;
}

/* Of the largest regions alone: their centres of power. */
static void find_centres(bis_survey *s, const bis_envmap *em, const bis_regions *regions)
{
    double sum[BIS_SURVEY_LARGEST][3] = {{0}};
    size_t i = 0;
    for (int y = 0; y < em->height; y++) {
        for (int x = 0; x < em->width; x++, i++) {
            for (int k = 0; k < s->n_largest; k++) {
                if (s->largest[k].label != regions->label[i]) continue;
                const vec3 w = bis_envmap_direction(em, x, y, 0.5, 0.5);
                const double power = rgb_sum(em->pixels[i]) * em->row_solid_angle[y] / s->power;
                sum[k][0] += (double)w.x * power;
                sum[k][1] += (double)w.y * power;
                sum[k][2] += (double)w.z * power;
            }
        }
    }
    for (int k = 0; k < s->n_largest; k++) {
        const double norm = sqrt(sum[k][0] * sum[k][0] + sum[k][1] * sum[k][1] + sum[k][2] * sum[k][2]);
        /* The centre of the whole sphere is what rounding leaves, below float's precision of the directions summed. */
        if (norm <= (double)FLT_EPSILON * s->largest[k].power) continue;
        s->largest[k].direction = vec3_from(sum[k][0] / norm, sum[k][1] / norm, sum[k][2] / norm);
    }
}

static void rank_regions(bis_survey *s, const bis_envmap *em, const bis_regions *regions, double *power)
{
    for (size_t i = 0; i < pixels_of(em); i++)
        if (regions->label[i] != BIS_REGION_NONE)
            power[regions->label[i]] += rgb_sum(em->pixels[i]) * solid_angle_of(em, i);
    for (uint32_t k = 0; k < regions->n; k++) {
        insert_largest(
            s, (bis_survey_region){k, regions->level[k], regions->solid_angle[k], power[k] / s->power, {0, 0, 0}});
    }
    find_centres(s, em, regions);
}

bis_status bis_survey_init(bis_survey *s, const bis_envmap *em, const bis_regions *regions, int levels, bis_diag *diag)
{
    bis_status status = BIS_OK;
    cell *cells = bis_alloc(N_CELLS, sizeof *cells);
    double *power = bis_alloc(regions->n, sizeof *power), above;

    *s = (bis_survey){.n_regions = regions->n};
    if (!cells || !power) {
        status = bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory to survey a %d x %d map", em->width, em->height);
        goto done;
    }
    sum_map(s, em);
    fill_cells(cells, em);
    s->median = from_the_top(cells, 0.5, &above);
    from_the_top(cells, 0.001, &above);
    s->brightest = s->power > 0 ? above / s->power : 0;
    sum_levels(s, em, regions, levels);
    rank_regions(s, em, regions, power);
done:
    bis_free(cells);
    bis_free(power);
    return status;
}
