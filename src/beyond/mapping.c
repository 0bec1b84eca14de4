/* mapping: resamples a picture of one mapping to another.
 *
 * Each pixel becomes the mean of k x k directions that are spread over it, weighted by solid angle; each direction is
 * looked up in the nearest pixel of the source. Gathering in this way leaves no holes and keeps a constant map
 * constant; distributing the source's pixels does neither. Its weak point is a lamp of a few pixels, because the lamp's
 * area is measured only by the number of samples that fall on it. With n samples of a square grid on a pixel, this
 * number is wrong by about n^(-3/4), and by n^(-1/2) where the pixel's edges run along the grid. Therefore k is such
 * that a source pixel gets about 64 (angular) or 16 samples. A pixel that alone holds more than a thousandth of the
 * energy (there are at most 1000) gets 256 x 256 of them: the pixels of the result around it take more, and the rows
 * and columns of their grid are shifted against each other by multiples of the golden ratio, so that an edge meets no
 * whole row at once, but for a few slopes. An angular map, whose edges run in all directions, has 128 x 128 on the
 * plain grid. No pixel of the result gets more than MOST x MOST for the sake of a bright one: where it covers many
 * pixels of the source, their errors cancel.
 *
 * Cost: O(W H k^2) on all threads. The result does not depend on their number. */
#include "mapping_models.h"

#include "bis/base/mem.h"
#include "thesis/envmap_parts.h"

#include <assert.h>

#define BRIGHT_SHARE 1e-3 /* of the energy, in one pixel */
#define GOLDEN 0.6180339887498949
enum { MOST = 1024 };

static const bis_mapping_model *model_of(const bis_raster *r) { return &bis_mapping_models[r->mapping]; }

/* Samples in each direction on any pixel of the source, and times as many on a bright one. `shift`: see above. Those of
 * a probe's rim subtend next to nothing. */
typedef struct density {
    int any, times;
    double shift;
} density;

static density density_on(const bis_raster *from)
{
    return from->mapping == BIS_MAPPING_ANGULAR ? (density){8, 16, 0} : (density){4, 64, GOLDEN};
}

/* Pixels around the sphere. */
static double turn_of(const bis_raster *r)
{
    const bis_mapping_model *m = model_of(r);
    if (r->mapping == BIS_MAPPING_LATLONG) return r->width;
    const bool is_strip = r->mapping == BIS_MAPPING_CUBE_STRIP && r->height > r->width;
    return m->turn * (is_strip ? r->width : r->width / m->columns);
}

static rgb mean_of(const double sum[3], double weight)
{
    return weight > 0 ? rgb_from(sum[0] / weight, sum[1] / weight, sum[2] / weight) : (rgb){0, 0, 0};
}

static void add_lookup(double sum[3], const bis_raster *from, const double d[3], double weight)
{
    const rgb c = from->pixels[model_of(from)->pixel(from, d)];
    sum[0] += weight * (double)c.r;
    sum[1] += weight * (double)c.g;
    sum[2] += weight * (double)c.b;
}

/* Position i of k in [0, 1), in row j of a grid whose rows are shifted by `shift`, in samples. */
static double position(int i, int j, int k, double shift) { return (i + fmod(0.5 + j * shift, 1)) / k; }

/* A patch of a lat-long map: directions uniform by solid angle. */
static rgb gather_patch(const bis_envmap *em, const bis_raster *from, int x, int y, int k, double shift)
{
    double sum[3] = {0, 0, 0}, cos_phi = 1, sin_phi = 0;
    /* narrower patches near the poles need fewer columns of samples; the plain grid of an angular map is as it was */
    const int columns = shift > 0 ? (int)ceil(k * sin(PI * (y + 0.5) / em->height)) : k;
    for (int i = 0; i < columns; i++) {
        for (int j = 0; j < k; j++) {
            double sin_theta, cos_theta;
            if (j == 0 || shift > 0) { /* else it stays */
                const double phi = 2 * PI * (x + position(i, j, columns, shift)) / em->width;
                cos_phi = cos(phi);
                sin_phi = sin(phi);
            }
            bis_envmap_circle(em, y, position(j, i, k, shift), &sin_theta, &cos_theta);
            add_lookup(sum, from, (double[]){sin_theta * cos_phi, sin_theta * sin_phi, cos_theta}, 1);
        }
    }
    return mean_of(sum, (double)columns * k);
}

static rgb gather_pixel(const bis_raster *to, const bis_raster *from, int x, int y, int k, double shift)
{
    double sum[3] = {0, 0, 0}, weights = 0;
    if (model_of(to)->solid_angle(to, x, y) <= 0) return (rgb){0, 0, 0};
    for (int i = 0; i < k; i++) {
        for (int j = 0; j < k; j++) {
            double d[3];
            const double u = position(i, j, k, shift) - 0.5, v = position(j, i, k, shift) - 0.5;
            const double weight = model_of(to)->direction(to, x, y, u, v, d);
            if (weight <= 0) continue;
            add_lookup(sum, from, d, weight);
            weights += weight;
        }
    }
    return mean_of(sum, weights);
}

static double power_of(const bis_raster *r)
{
    double power = 0;
    for (int y = 0; y < r->height; y++)
        for (int x = 0; x < r->width; x++) {
            const double solid_angle = model_of(r)->solid_angle(r, x, y);
            if (solid_angle > 0) power += rgb_sum(r->pixels[(size_t)y * (size_t)r->width + (size_t)x]) * solid_angle;
        }
    return power;
}

/* Copies the image without its bad values, as far as it is a part of the map. */
static void clean(bis_raster *r, const bis_image *image, bis_envmap_defects *defects)
{
    for (int y = 0; y < r->height; y++) {
        for (int x = 0; x < r->width; x++) {
            const double solid_angle = model_of(r)->solid_angle(r, x, y);
            const size_t i = (size_t)y * (size_t)r->width + (size_t)x;
            if (solid_angle > 0) r->pixels[i] = bis_envmap_clean(defects, image->pixels[i], x, y, solid_angle);
        }
    }
}

/* Marks the pixels of `to` that pixel (x, y) of the source, with a margin of half a pixel around it, falls on. It tests
 * points that are at most 1/8 pixel apart, and nearer where the result is the finer one. */
static void mark_pixels(const bis_raster *to, unsigned char *fine, const bis_raster *from, int x, int y)
{
    const double finer = turn_of(to) / turn_of(from) / 2;
    const int n = finer > 1 ? (int)ceil(8 * finer) : 8;
    for (int i = -n; i <= n; i++) {
        for (int j = -n; j <= n; j++) {
            double d[3];
            if (model_of(from)->direction(from, x, y, (double)i / n, (double)j / n, d) > 0)
                fine[model_of(to)->pixel(to, d)] = 1;
        }
    }
}

/* Bright is what has a thousandth of the energy and, in a small map, four times its share. */
static void mark_bright(const bis_raster *to, unsigned char *fine, const bis_raster *from, double power)
{
    const bool is_angular = from->mapping == BIS_MAPPING_ANGULAR;
    const double share = is_angular ? BRIGHT_SHARE : fmax(BRIGHT_SHARE, 4.0 / ((double)from->width * from->height));
    for (int y = 0; y < from->height; y++) {
        for (int x = 0; x < from->width; x++) {
            const double intensity = rgb_sum(from->pixels[(size_t)y * (size_t)from->width + (size_t)x]);
            if (intensity * model_of(from)->solid_angle(from, x, y) > share * power)
                mark_pixels(to, fine, from, x, y);
        }
    }
}

/* Fills `to`. em (else NULL): the rows of `to`, which is a lat-long map. fine[n_pixels]: zeros at first. */
static void resample(const bis_raster *to, const bis_envmap *em, const bis_raster *from, double power,
                     unsigned char *fine)
{
    const density per = density_on(from);
    const int coarse = (int)ceil(per.any * turn_of(from) / turn_of(to));
    const int k = coarse > 2 ? coarse : 2, most = k > MOST ? k : MOST;

    mark_bright(to, fine, from, power);
#pragma omp parallel for schedule(dynamic)
    for (int y = 0; y < to->height; y++) {
        for (int x = 0; x < to->width; x++) {
            const size_t i = (size_t)y * (size_t)to->width + (size_t)x;
            const int n = !fine[i] ? k : k > most / per.times ? most : per.times * k;
            const double shift = fine[i] ? per.shift : 0;
            to->pixels[i] = em ? gather_patch(em, from, x, y, n, shift) : gather_pixel(to, from, x, y, n, shift);
        }
    }
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
    bis_raster from = {mapping, image->width, image->height,
                       bis_alloc((size_t)image->width * (size_t)image->height, sizeof *from.pixels)};
    unsigned char *fine = bis_alloc(n, 1);
    em->pixels = bis_alloc(n, sizeof *em->pixels);
    bis_status status = bis_envmap_init_rows(em, width, height, diag);
    if (status) goto done;
    if (!from.pixels || !fine || !em->pixels) {
        status = bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for a map of %d x %d and its lat-long of %d x %d",
                           image->width, image->height, width, height);
        goto done;
    }
    clean(&from, image, &em->defects);
    em->power_before = power_of(&from);
    const bis_raster to = {BIS_MAPPING_LATLONG, width, height, em->pixels};
    resample(&to, em, &from, em->power_before, fine);
    em->power_after = bis_envmap_power(em);
done:
    bis_free(from.pixels);
    bis_free(fine);
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
    const bis_raster from = {BIS_MAPPING_LATLONG, em->width, em->height, em->pixels};
    bis_raster to = {.mapping = mapping};

    *image = (bis_image){0};
    bis_status status = find_size(&to, em, width, diag);
    if (status) return status;
    unsigned char *fine = bis_alloc((size_t)to.width * (size_t)to.height, 1);
    status = fine ? bis_image_init(image, to.width, to.height, diag)
                  : bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for a map of %d x %d", to.width, to.height);
    if (!status) {
        to.pixels = image->pixels;
        power[0] = bis_envmap_power(em);
        resample(&to, NULL, &from, power[0], fine);
        power[1] = power_of(&to);
    }
    bis_free(fine);
    return status;
}
