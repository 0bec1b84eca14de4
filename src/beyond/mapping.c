/* SPDX-License-Identifier: BSD-2-Clause */
/* mapping: resamples a picture of one mapping to another.
 *
 * Each pixel becomes the mean of k x k directions that are spread over it, weighted by solid angle; each direction is
 * looked up in the nearest pixel of the source, in lanes (mapping_models.c). Gathering in this way leaves no holes,
 * keeps a constant map constant and gives a lamp of few pixels its shape. Distributing the source's pixels would need
 * far more samples for that, where pixels of the result are narrow, as near the poles of a lat-long map.
 *
 * The weak point of gathering is energy: a pixel of the source counts by the samples that happen to fall on it, about
 * 16 (of an angular map 64, because its pixels get narrow towards the rim). Where much energy lies in one pixel, this
 * number is therefore measured. A pixel that alone holds more than a thousandth of the energy of a channel is a lamp;
 * there are less than 3000. The first pass adds up the solid angle that each lamp receives in the result. The pixels
 * that met one are gathered again, with the lamp's radiance times (its solid angle) / (what it received). So its
 * energy is exact, however few the samples are, and they only have to be enough for its shape: pixels that show an
 * edge of a lamp get at least FINE x FINE. A lamp that lies between all samples, like a sliver at a pole, goes to the
 * pixel that shows its centre. The errors of all other pixels, in sum, are corrected by one factor per channel, which
 * is 1 for a constant map.
 *
 * Cost: O(W H k^2) on all threads. The result does not depend on their number, because rows are added up in their
 * order. */
#include "mapping_models.h"

#include "bis/base/mem.h"
#include "bis/thesis/lanes.h"
#include "thesis/envmap_parts.h"

#include <assert.h>
#include <float.h>
#include <string.h>

#define BRIGHT_SHARE 1e-3 /* of the energy, in one pixel */
enum { MOST_LAMPS = 3000, FINE = 32 };

/* The places of k x k samples in each of some neighbours in a row, which are looked up together: a call for 16 samples
 * alone would take half as long again, because it waits for each of its results. */
typedef struct pattern {
    int k;
    uint32_t samples; /* k x k */
    int pixels;       /* that fit into one bis_samples, or 1 */
    float *dx, *dy;   /* for whole blocks: pixels from the centre of the first one */
} pattern;

typedef struct resampling {
    const bis_raster *to, *from;
    pattern usual, fine;
    uint16_t *lamp_of; /* lamp_of[pixel of the source]: the lamp that it is; 0: none */
    int n_lamps;       /* they are 1 to n_lamps */
    size_t pixel_of[MOST_LAMPS];
    double factor[MOST_LAMPS]; /* of a lamp's radiance, 0 until it is known; factor[0] is 1 */
} resampling;

static const bis_mapping_model *model_of(const bis_raster *r) { return &bis_mapping_models[r->mapping]; }

/* In sr; 0: outside. */
static double solid_angle(const bis_raster *r, int x, int y) { return r->scale * model_of(r)->solid_angle(r, x, y); }

/* The same, if that of the pixel before is known: in a row of a lat-long map all are equal. */
static double next_solid_angle(const bis_raster *r, int x, int y, double before)
{
    return x > 0 && r->mapping == BIS_MAPPING_LATLONG ? before : solid_angle(r, x, y);
}

static double solid_angle_at(const bis_raster *r, size_t i)
{
    return solid_angle(r, (int)(i % (size_t)r->width), (int)(i / (size_t)r->width));
}

/* A pixel belongs to a disc if its centre does. Together they are the disc but for some pixels on its rim, up to 0.2 %
 * of the pixels of a ball of usual size. Therefore their solid angles are scaled to be a sphere's. Counting the share
 * of each pixel on the rim would be exact, too, but would read pixels that show the background for the most part. */
static bis_raster raster_of(bis_mapping mapping, int width, int height, rgb *pixels)
{
    bis_raster r = {mapping, width, height, 1, pixels};
    double sum = 0;
    if (mapping != BIS_MAPPING_ANGULAR && mapping != BIS_MAPPING_MIRRORBALL) return r;
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++) sum += solid_angle(&r, x, y);
    r.scale = 4 * PI / sum;
    return r;
}

/* The width of a cell of the picture. */
static int cell_of(const bis_raster *r)
{
    if (r->mapping == BIS_MAPPING_LATLONG) return r->width;
    const bool is_column = r->mapping == BIS_MAPPING_CUBE_STRIP && r->height > r->width;
    return is_column ? r->width : r->width / model_of(r)->columns;
}

/* Pixels around the sphere. */
static double turn_of(const bis_raster *r)
{
    if (r->mapping == BIS_MAPPING_LATLONG) return fmax(r->width, 2.0 * r->height);
    return model_of(r)->turn * cell_of(r);
}

static bool pattern_init(pattern *p, int k)
{
    const uint32_t samples = (uint32_t)k * (uint32_t)k, pixels = samples < BIS_SAMPLES ? BIS_SAMPLES / samples : 1;
    const uint32_t n = pixels * samples, lanes = bis_lanes_round_up(n);
    *p = (pattern){k, samples, (int)pixels, bis_alloc(lanes, 2 * sizeof *p->dx), NULL};
    if (!p->dx) return false;
    p->dy = p->dx + lanes;
    for (uint32_t i = 0; i < n; i++) {
        const uint32_t within = i % samples;
        p->dx[i] = (float)(i / samples + (within / (uint32_t)k + 0.5) / k - 0.5);
        p->dy[i] = (float)((within % (uint32_t)k + 0.5) / k - 0.5);
    }
    return true;
}

/* n samples of the pattern, from sample `first` on. */
static bis_places places_of(const pattern *p, uint32_t first, uint32_t n)
{
    return (bis_places){p->dx + first, p->dy + first, bis_lanes_round_up(n)};
}

static void look_up(bis_samples *at, const resampling *s, int x, int y, const bis_places *places)
{
    model_of(s->to)->directions(at, s->to, x, y, places);
    model_of(s->from)->pixels(s->from, at, places->n);
}

/* Adds n samples to sum and met. Returns their weight; *last: the lamp of the last one. */
static double add_samples(const resampling *s, const bis_samples *at, uint32_t n, double sum[3], double met[MOST_LAMPS],
                          int *last)
{
    double weights = 0;
    for (uint32_t i = 0; i < n; i++) {
        const double weight = (double)at->weight[i];
        if (weight <= 0) continue;
        const rgb c = s->from->pixels[at->pixel[i]];
        *last = s->lamp_of[at->pixel[i]];
        const double w = weight * s->factor[*last];
        sum[0] += w * (double)c.r;
        sum[1] += w * (double)c.g;
        sum[2] += w * (double)c.b;
        met[*last] += weight;
        weights += weight;
    }
    return weights;
}

/* Stores the samples of pixel (x, y) of the result, added up, and in met[], which is all 0, the weight of those that
 * meet each lamp. Returns the weight of all; *last: the lamp of the last one. */
static double gather(const resampling *s, int x, int y, const pattern *p, double sum[3], double met[MOST_LAMPS],
                     int *last)
{
    double weights = 0;
    bis_samples at;
    sum[0] = sum[1] = sum[2] = 0;
    for (uint32_t i = 0; i < p->samples; i += BIS_SAMPLES) {
        const uint32_t n = p->samples - i < BIS_SAMPLES ? p->samples - i : BIS_SAMPLES;
        const bis_places places = places_of(p, i, n);
        look_up(&at, s, x, y, &places);
        weights += add_samples(s, &at, n, sum, met, last);
    }
    return weights;
}

static void forget(const resampling *s, double met[MOST_LAMPS])
{
    memset(met, 0, ((size_t)s->n_lamps + 1) * sizeof *met);
}

/* The same with as many samples as the pixel needs. */
static double look(const resampling *s, int x, int y, double sum[3], double met[MOST_LAMPS])
{
    int lamp = 0;
    const double weights = gather(s, x, y, &s->usual, sum, met, &lamp);
    if (met[lamp] == weights || s->usual.k >= FINE) return weights;
    forget(s, met);
    return gather(s, x, y, &s->fine, sum, met, &lamp);
}

/* Whether no sample of pixel i among these meets a lamp. If so, *c is their mean. */
static bool mean_of(const resampling *s, const bis_samples *at, uint32_t i, rgb *c)
{
    const uint32_t first = i * s->usual.samples;
    double r = 0, g = 0, b = 0, weights = 0;
    unsigned lamps = 0;
    for (uint32_t k = first; k < first + s->usual.samples; k++) {
        const double w = (double)at->weight[k];
        const rgb seen = s->from->pixels[at->pixel[k]];
        lamps |= s->lamp_of[at->pixel[k]];
        r += w * (double)seen.r;
        g += w * (double)seen.g;
        b += w * (double)seen.b;
        weights += w;
    }
    *c = rgb_from(r / weights, g / weights, b / weights);
    return !lamps;
}

/* Gathers all pixels that meet no lamp. The others are marked by a red of -1; so are all, if the samples of one are too
 * many to be looked up together. */
static void gather_plain(const resampling *s)
{
    const bis_raster *to = s->to;
    const int cell = cell_of(to);
#pragma omp parallel for schedule(dynamic)
    for (int y = 0; y < to->height; y++) {
        bis_samples at;
        double area = 0;
        for (int x = 0, n; x < to->width; x += n) {
            n = cell - x % cell < s->usual.pixels ? cell - x % cell : s->usual.pixels;
            const bool together = s->usual.samples <= BIS_SAMPLES;
            const bis_places places = places_of(&s->usual, 0, (uint32_t)n * s->usual.samples);
            if (together) look_up(&at, s, x, y, &places);
            for (int i = 0; i < n; i++) {
                area = next_solid_angle(to, x + i, y, area);
                rgb *const c = &to->pixels[(size_t)y * (size_t)to->width + (size_t)(x + i)];
                if (area > 0 && !(together && mean_of(s, &at, (uint32_t)i, c))) *c = (rgb){-1, 0, 0};
            }
        }
    }
}

/* Gathers the pixels that are marked. Those that meet a lamp stay marked the first time. Adds to received[lamp] its
 * solid angle in the result. */
static void gather_marked(const resampling *s, bool again, double received[MOST_LAMPS])
{
    const bis_raster *to = s->to;
#pragma omp parallel for ordered schedule(dynamic)
    for (int y = 0; y < to->height; y++) {
        double row[MOST_LAMPS] = {0}, met[MOST_LAMPS] = {0}, sum[3];
        for (int x = 0; x < to->width; x++) {
            rgb *const c = &to->pixels[(size_t)y * (size_t)to->width + (size_t)x];
            if (c->r >= 0) continue; /* what is outside stays black */
            const double weights = look(s, x, y, sum, met), area = solid_angle(to, x, y);
            if (again || met[0] == weights) *c = rgb_from(sum[0] / weights, sum[1] / weights, sum[2] / weights);
            for (int lamp = 1; lamp <= s->n_lamps; lamp++) row[lamp] += met[lamp] / weights * area;
            forget(s, met);
        }
#pragma omp ordered
        for (int lamp = 1; lamp <= s->n_lamps; lamp++) received[lamp] += row[lamp];
    }
}

/* The integrals of red, green and blue. */
static void power_of(const bis_raster *r, double power[3])
{
    double area = 0;
    power[0] = power[1] = power[2] = 0;
    for (int y = 0; y < r->height; y++)
        for (int x = 0; x < r->width; x++) {
            area = next_solid_angle(r, x, y, area);
            const rgb c = r->pixels[(size_t)y * (size_t)r->width + (size_t)x];
            if (area <= 0) continue;
            power[0] += (double)c.r * area;
            power[1] += (double)c.g * area;
            power[2] += (double)c.b * area;
        }
}

/* Copies the image without its bad values, as far as it is a part of the map. */
static void clean(bis_raster *r, const bis_image *image, bis_envmap_defects *defects)
{
    for (int y = 0; y < r->height; y++) {
        for (int x = 0; x < r->width; x++) {
            const double area = solid_angle(r, x, y);
            const size_t i = (size_t)y * (size_t)r->width + (size_t)x;
            if (area > 0) r->pixels[i] = bis_envmap_clean(defects, image->pixels[i], x, y, area);
        }
    }
}

/* A lamp has a thousandth of the energy and, in a small map, four times its share, so that a constant map has none. */
static void find_lamps(resampling *s, const double power[3])
{
    const bis_raster *from = s->from;
    const size_t n = (size_t)from->width * (size_t)from->height;
    const double share = fmax(BRIGHT_SHARE, 4 / (double)n);
    for (size_t i = 0; i < n; i++) {
        const double area = solid_angle_at(from, i);
        const rgb c = from->pixels[i];
        if ((double)c.r * area > share * power[0] || (double)c.g * area > share * power[1] ||
            (double)c.b * area > share * power[2]) {
            s->lamp_of[i] = (uint16_t)++s->n_lamps;
            assert(s->n_lamps < MOST_LAMPS);
            s->pixel_of[s->n_lamps] = i;
        }
    }
}

/* Adds the lamp to the pixel that shows its centre. */
static void add_lamp(const resampling *s, size_t pixel)
{
    const bis_raster *to = s->to, *from = s->from;
    const int x = (int)(pixel % (size_t)from->width), y = (int)(pixel / (size_t)from->width);
    const float centre[BIS_LANES_BLOCK] = {0};
    bis_samples at;
    model_of(from)->directions(&at, from, x, y, &(bis_places){centre, centre, BIS_LANES_BLOCK});
    model_of(to)->pixels(to, &at, BIS_LANES_BLOCK);
    const size_t i = at.pixel[0];
    const double times = solid_angle(from, x, y) / solid_angle_at(to, i);
    to->pixels[i] = rgb_add(to->pixels[i], rgb_scale(from->pixels[pixel], times));
}

static void scale_to(const bis_raster *to, const double power[3])
{
    double factor[3];
    power_of(to, factor);
    for (int c = 0; c < 3; c++) factor[c] = factor[c] > 0 ? power[c] / factor[c] : 1;
    for (size_t i = 0; i < (size_t)to->width * (size_t)to->height; i++) {
        const rgb c = to->pixels[i];
        to->pixels[i] = rgb_from((double)c.r * factor[0], (double)c.g * factor[1], (double)c.b * factor[2]);
    }
}

static void resampling_clear(resampling *s)
{
    bis_free(s->lamp_of);
    bis_free(s->usual.dx);
    bis_free(s->fine.dx);
}

static bis_status resampling_init(resampling *s, const bis_raster *to, const bis_raster *from, bis_diag *diag)
{
    const int per_pixel = from->mapping == BIS_MAPPING_ANGULAR ? 8 : 4;
    const int k = (int)ceil(per_pixel * turn_of(from) / turn_of(to));
    *s = (resampling){.to = to, .from = from, .factor = {1}};
    s->lamp_of = bis_alloc((size_t)from->width * (size_t)from->height, sizeof *s->lamp_of);
    if (s->lamp_of && pattern_init(&s->usual, k > 2 ? k : 2) && pattern_init(&s->fine, FINE)) return BIS_OK;
    resampling_clear(s);
    return bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for the lamps of a map of %d x %d", from->width,
                     from->height);
}

/* Fills `to`. power: the integrals of r+g+b before and after. */
static bis_status resample(const bis_raster *to, const bis_raster *from, double power[2], bis_diag *diag)
{
    double before[3], after[3], received[MOST_LAMPS] = {0};
    resampling s;

    const bis_status status = resampling_init(&s, to, from, diag);
    if (status) return status;
    power_of(from, before);
    find_lamps(&s, before);
    gather_plain(&s);
    gather_marked(&s, false, received);
    for (int lamp = 1; lamp <= s.n_lamps; lamp++)
        if (received[lamp] > 0) s.factor[lamp] = solid_angle_at(from, s.pixel_of[lamp]) / received[lamp];
    gather_marked(&s, true, received); /* which has served */
    for (int lamp = 1; lamp <= s.n_lamps; lamp++)
        if (s.factor[lamp] == 0) add_lamp(&s, s.pixel_of[lamp]);
    resampling_clear(&s);
    scale_to(to, before);
    power_of(to, after);
    power[0] = before[0] + before[1] + before[2];
    power[1] = after[0] + after[1] + after[2];
    if (isfinite(power[1])) return BIS_OK;
    return bis_error(diag, BIS_INPUT, (bis_loc){0}, "a map of mapping \"%s\" would get a radiance of more than %g, "
                     "which no float holds; divide the map by 1000", bis_mapping_names[to->mapping], (double)FLT_MAX);
}

bis_status bis_envmap_from_mapping(bis_envmap *em, bis_image *image, bis_mapping mapping, int width, bis_diag *diag)
{
    if (mapping == BIS_MAPPING_LATLONG) return bis_envmap_from_latlong(em, image, diag);
    *em = (bis_envmap){.resampled_from = bis_mapping_names[mapping]};
    if (!bis_mapping_fits(mapping, image->width, image->height)) {
        *em = (bis_envmap){0};
        return bis_error(diag, BIS_INPUT, (bis_loc){0}, "a map of mapping \"%s\" must be %s, this one is %d x %d; is "
                         "it a \"latlong\" map?", bis_mapping_names[mapping], bis_mapping_shape(mapping), image->width,
                         image->height);
    }
    width = bis_mapping_width(mapping, image->width, image->height, width);
    const int height = width / 2;
    const size_t n = (size_t)width * (size_t)height;
    bis_raster from = raster_of(mapping, image->width, image->height,
                                bis_alloc((size_t)image->width * (size_t)image->height, sizeof *from.pixels));
    em->pixels = bis_alloc(n, sizeof *em->pixels);
    bis_status status = bis_envmap_init_rows(em, width, height, diag);
    if (status) goto done;
    if (!from.pixels || !em->pixels) {
        status = bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for a map of %d x %d and its lat-long of %d x %d",
                           image->width, image->height, width, height);
        goto done;
    }
    clean(&from, image, &em->defects);
    const bis_raster to = raster_of(BIS_MAPPING_LATLONG, width, height, em->pixels);
    double power[2];
    status = resample(&to, &from, power, diag);
    em->power_before = power[0];
    em->power_after = power[1];
done:
    bis_free(from.pixels);
    if (status) bis_envmap_clear(em);
    return status;
}

/* The size of an image of this width. */
static bis_status find_size(bis_raster *to, const bis_envmap *em, int width, bis_diag *diag)
{
    const bis_mapping_model *m = model_of(to);
    const double cell = em->width / m->turn; /* as many pixels around the sphere */
    if (width == 0 && to->mapping == BIS_MAPPING_LATLONG) width = em->width;
    if (width == 0) width = (int)fmin(ceil(cell - 1e-9) * m->columns, BIS_IMAGE_MAX_SIDE + 1.0);
    to->width = width;
    to->height = to->mapping == BIS_MAPPING_LATLONG ? (width + 1) / 2 : width / m->columns * m->rows;
    if (to->mapping != BIS_MAPPING_LATLONG && width % m->columns)
        return bis_error(diag, BIS_INPUT, (bis_loc){0}, "a map of mapping \"%s\" must be %s: its width, %d, must be a "
                         "multiple of %d", bis_mapping_names[to->mapping], m->shape, width, m->columns);
    if (to->width > BIS_IMAGE_MAX_SIDE || to->height > BIS_IMAGE_MAX_SIDE)
        return bis_error(diag, BIS_INPUT, (bis_loc){0}, "an image of mapping \"%s\" would have %d x %d pixels, a side "
                         "must be at most %d: give a smaller width", bis_mapping_names[to->mapping], to->width,
                         to->height, BIS_IMAGE_MAX_SIDE);
    return BIS_OK;
}

bis_status bis_envmap_to_mapping(bis_image *image, const bis_envmap *em, bis_mapping mapping, int width,
                                 double power[2], bis_diag *diag)
{
    const bis_raster from = raster_of(BIS_MAPPING_LATLONG, em->width, em->height, em->pixels);
    bis_raster to = {.mapping = mapping};

    *image = (bis_image){0};
    bis_status status = find_size(&to, em, width, diag);
    if (status) return status;
    status = bis_image_init(image, to.width, to.height, diag);
    if (status) return status;
    to = raster_of(mapping, to.width, to.height, image->pixels);
    status = resample(&to, &from, power, diag);
    if (status) bis_image_clear(image);
    return status;
}
