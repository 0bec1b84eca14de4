/* SPDX-License-Identifier: BSD-2-Clause */
/* mapping: resamples a picture of one mapping to another.
 *
 * Each pixel becomes the mean of k x k directions that are spread over it, weighted by solid angle; each direction is
 * looked up in the nearest pixel of the source. Gathering in this way leaves no holes, keeps a constant map constant
 * and gives a lamp of few pixels its shape. Distributing the source's pixels would need far more samples for that,
 * where pixels of the result are narrow, as near the poles of a lat-long map.
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
#include "thesis/envmap_parts.h"

#include <assert.h>
#include <float.h>
#include <string.h>

#define BRIGHT_SHARE 1e-3 /* of the energy, in one pixel */
enum { MOST_LAMPS = 3000, FINE = 32 };

typedef struct resampling {
    const bis_raster *to, *from;
    int k;
    uint16_t *lamp_of; /* lamp_of[pixel of the source]: the lamp that it is; 0: none */
    int n_lamps;       /* they are 1 to n_lamps */
    size_t pixel_of[MOST_LAMPS];
    double factor[MOST_LAMPS]; /* of a lamp's radiance, 0 until it is known; factor[0] is 1 */
} resampling;

static const bis_mapping_model *model_of(const bis_raster *r) { return &bis_mapping_models[r->mapping]; }

/* In sr; 0: outside. */
static double solid_angle(const bis_raster *r, int x, int y) { return r->scale * model_of(r)->solid_angle(r, x, y); }

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

/* Pixels around the sphere. */
static double turn_of(const bis_raster *r)
{
    const bis_mapping_model *m = model_of(r);
    if (r->mapping == BIS_MAPPING_LATLONG) return fmax(r->width, 2.0 * r->height);
    const bool is_strip = r->mapping == BIS_MAPPING_CUBE_STRIP && r->height > r->width;
    return m->turn * (is_strip ? r->width : r->width / m->columns);
}

/* Stores k x k samples of pixel (x, y) of the result, added up, and in met[] the weight of those that meet each lamp.
 * Returns the weight of all; *last: the lamp of the last one. */
static double gather(const resampling *s, int x, int y, int k, double sum[3], double met[MOST_LAMPS], int *last)
{
    double weights = 0;
    sum[0] = sum[1] = sum[2] = 0;
    memset(met, 0, ((size_t)s->n_lamps + 1) * sizeof *met);
    for (int i = 0; i < k; i++) {
        for (int j = 0; j < k; j++) {
            double d[3];
            const double weight =
                model_of(s->to)->direction(s->to, x, y, (i + 0.5) / k - 0.5, (j + 0.5) / k - 0.5, d);
            if (weight <= 0) continue;
            const size_t pixel = model_of(s->from)->pixel(s->from, d);
            const rgb c = s->from->pixels[pixel];
            *last = s->lamp_of[pixel];
            const double w = weight * s->factor[*last];
            sum[0] += w * (double)c.r;
            sum[1] += w * (double)c.g;
            sum[2] += w * (double)c.b;
            met[*last] += weight;
            weights += weight;
        }
    }
    return weights;
}

/* The same with as many samples as the pixel needs. */
static double look(const resampling *s, int x, int y, double sum[3], double met[MOST_LAMPS])
{
    int lamp = 0;
    const double weights = gather(s, x, y, s->k, sum, met, &lamp);
    if (met[lamp] == weights || s->k >= FINE) return weights;
    return gather(s, x, y, FINE, sum, met, &lamp);
}

/* Gathers all pixels, or, if `again`, those that met a lamp the first time, which marked them by a red of -1. Adds to
 * received[lamp] its solid angle in the result. */
static void gather_all(const resampling *s, bool again, double received[MOST_LAMPS])
{
    const bis_raster *to = s->to;
#pragma omp parallel for ordered schedule(dynamic)
    for (int y = 0; y < to->height; y++) {
        double row[MOST_LAMPS] = {0}, met[MOST_LAMPS], sum[3];
        for (int x = 0; x < to->width; x++) {
            const double area = solid_angle(to, x, y);
            rgb *const c = &to->pixels[(size_t)y * (size_t)to->width + (size_t)x];
            if (area <= 0 || (again && c->r >= 0)) continue; /* what is outside stays black */
            const double weights = look(s, x, y, sum, met);
            for (int lamp = 1; lamp <= s->n_lamps; lamp++) row[lamp] += met[lamp] / weights * area;
            if (met[0] < weights && !again) *c = (rgb){-1, 0, 0};
            else *c = rgb_from(sum[0] / weights, sum[1] / weights, sum[2] / weights);
        }
#pragma omp ordered
        for (int lamp = 1; lamp <= s->n_lamps; lamp++) received[lamp] += row[lamp];
    }
}

/* The integrals of red, green and blue. */
static void power_of(const bis_raster *r, double power[3])
{
    power[0] = power[1] = power[2] = 0;
    for (int y = 0; y < r->height; y++)
        for (int x = 0; x < r->width; x++) {
            const double area = solid_angle(r, x, y);
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
    double d[3];
    model_of(from)->direction(from, x, y, 0, 0, d);
    const size_t i = model_of(to)->pixel(to, d);
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

/* Fills `to`. power: the integrals of r+g+b before and after. */
static bis_status resample(const bis_raster *to, const bis_raster *from, double power[2], bis_diag *diag)
{
    const int per_pixel = from->mapping == BIS_MAPPING_ANGULAR ? 8 : 4;
    const int k = (int)ceil(per_pixel * turn_of(from) / turn_of(to));
    resampling s = {to, from, k > 2 ? k : 2, bis_alloc((size_t)from->width * (size_t)from->height, 2), .factor = {1}};
    double before[3], after[3], received[MOST_LAMPS] = {0};

    if (!s.lamp_of)
        return bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for the lamps of a map of %d x %d", from->width,
                         from->height);
    power_of(from, before);
    find_lamps(&s, before);
    gather_all(&s, false, received);
    for (int lamp = 1; lamp <= s.n_lamps; lamp++)
        if (received[lamp] > 0) s.factor[lamp] = solid_angle_at(from, s.pixel_of[lamp]) / received[lamp];
    gather_all(&s, true, received); /* which has served */
    for (int lamp = 1; lamp <= s.n_lamps; lamp++)
        if (s.factor[lamp] == 0) add_lamp(&s, s.pixel_of[lamp]);
    bis_free(s.lamp_of);
    scale_to(to, before);
    power_of(to, after);
    power[0] = before[0] + before[1] + before[2];
    power[1] = after[0] + after[1] + after[2];
    if (isfinite(power[1])) return BIS_OK;
    return bis_error(diag, BIS_INPUT, (bis_loc){0}, "a map of mapping \"%s\" would get a radiance of more than %g, "
                     "which no float holds; divide the map by 1000", model_of(to)->name, (double)FLT_MAX);
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
    assert(width >= 0);
    if (width == 0) width = bis_mapping_width(mapping, image->width, image->height);
    width += width % 2;
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
                         "multiple of %d", m->name, m->shape, width, m->columns);
    if (to->width > BIS_IMAGE_MAX_SIDE || to->height > BIS_IMAGE_MAX_SIDE)
        return bis_error(diag, BIS_INPUT, (bis_loc){0}, "an image of mapping \"%s\" would have %d x %d pixels, a side "
                         "must be at most %d: give a smaller width", m->name, to->width, to->height,
                         BIS_IMAGE_MAX_SIDE);
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
