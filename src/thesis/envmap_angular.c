/* envmap_angular: resamples one of Debevec's light probes once to a lat-long map (docs/scene-format.md,
 * "LightSource").
 *
 * The pixel at polar position (r, a) of the disc (r = 1 at the rim, a from image right, counter-clockwise) is the
 * direction (-cos(pi r), -sin(pi r) cos a, sin(pi r) sin a). The disc's area element r dr da is sin(pi r) pi dr da on
 * the sphere. A pixel of area (2/side)^2 therefore subtends pi^2 sin(pi r)/(pi r) (2/side)^2.
 *
 * Each lat-long patch becomes the mean of k x k directions that are evenly spread over its solid angle. Each
 * direction is looked up in the nearest probe pixel. Gathering in this way leaves no holes and keeps a constant probe
 * constant; distributing the probe's pixels over the patches does neither. Its weak point is a lamp of a few pixels,
 * because the lamp's area is measured only by the number of samples that fall on it. With n samples on a pixel, this
 * number is wrong by about n^(-3/4). Therefore k is such that a pixel at the centre gets about 64 samples. A pixel
 * that alone holds more than a thousandth of the probe's energy (there are at most 1000) gets 16 times as many in
 * each direction, in the patches around it.
 *
 * Cost: O(W H k^2) on all threads. The result does not depend on their number. */
#include "bis/thesis/envmap.h"

#include "bis/base/mem.h"
#include "bis/base/image.h"
#include "envmap_parts.h"

#include <assert.h>

enum { FINER = 16 };              /* in each direction, at the brightest pixels */
#define BRIGHT_SHARE 1e-3         /* of the energy, in one probe pixel */

typedef struct probe {
    rgb *pixels; /* cleaned; pixels outside the disc are never read */
    int side;
} probe;

/* Stores the centre of pixel (x, y) on the disc: q[0] to the right, q[1] up, |q| = 1 at the rim. x and y may be
 * fractional. */
static void disc_position(int side, double x, double y, double q[2])
{
    q[0] = 2 * (x + 0.5) / side - 1;
    q[1] = 1 - 2 * (y + 0.5) / side;
}

static bool in_disc(int side, int x, int y)
{
    double q[2];
    disc_position(side, x, y, q);
    return q[0] * q[0] + q[1] * q[1] <= 1;
}

/* Returns pi^2 sinc(pi r) dA, see above. */
static double pixel_solid_angle(int side, int x, int y)
{
    double q[2];
    disc_position(side, x, y, q);
    const double t = PI * hypot(q[0], q[1]);
    const double sinc = t > 0 ? sin(t) / t : 1;
    return 4 * PI * PI * sinc / side / side;
}

static vec3 disc_to_direction(const double q[2])
{
    const double r = hypot(q[0], q[1]);
    if (r == 0) return (vec3){-1, 0, 0};
    const double s = sin(PI * r) / r;
    return vec3_from(-cos(PI * r), -s * q[0], s * q[1]);
}

/* Returns the radiance of the probe pixel that sees direction (x, y, z). */
static rgb probe_lookup(const probe *p, double x, double y, double z)
{
    const double h = sqrt(y * y + z * z);
    const double cos_a = h > 0 ? -y / h : 1, sin_a = h > 0 ? z / h : 0;
    double r = atan2(h, -x) / PI;
    for (;;) {
        int column = (int)((r * cos_a + 1) / 2 * p->side), row = (int)((1 - r * sin_a) / 2 * p->side);
        if (column == p->side) column--; /* the rim itself */
        if (row == p->side) row--;

        /* All points of a pixel lie within half a diagonal, sqrt(2)/side, of its centre. A rim pixel whose centre
         * lies outside the disc is ignored; its neighbour towards the centre is used instead. */
        const double surely_inside = 1 - sqrt(2) / p->side;
        if (r < surely_inside || in_disc(p->side, column, row))
            return p->pixels[(size_t)row * (size_t)p->side + (size_t)column];
        r -= sqrt(2) / p->side;
    }
}

static rgb gather_patch(const bis_envmap *em, const probe *p, int x, int y, int k)
{
    double sum[3] = {0, 0, 0};
    for (int i = 0; i < k; i++) {
        const double phi = 2 * PI * (x + (i + 0.5) / k) / em->width;
        const double cos_phi = cos(phi), sin_phi = sin(phi);
        for (int j = 0; j < k; j++) {
            double sin_theta, cos_theta;
            bis_envmap_circle(em, y, (j + 0.5) / k, &sin_theta, &cos_theta);
            const rgb c = probe_lookup(p, sin_theta * cos_phi, sin_theta * sin_phi, cos_theta);
            sum[0] += (double)c.r;
            sum[1] += (double)c.g;
            sum[2] += (double)c.b;
        }
    }
    const double n = (double)k * k;
    return rgb_from(sum[0] / n, sum[1] / n, sum[2] / n);
}

/* Copies the image without its bad values. Returns the integral of the intensity over the disc's pixels. */
static double clean_probe(probe *p, const bis_image *image, bis_envmap_defects *defects)
{
    double power = 0;
    for (int y = 0; y < p->side; y++) {
        for (int x = 0; x < p->side; x++) {
            if (!in_disc(p->side, x, y)) continue;
            const size_t i = (size_t)y * (size_t)p->side + (size_t)x;
            const double solid_angle = pixel_solid_angle(p->side, x, y);
            p->pixels[i] = bis_envmap_clean(defects, image->pixels[i], x, y, solid_angle);
            power += rgb_sum(p->pixels[i]) * solid_angle;
        }
    }
    return power;
}

/* Marks the patches that pixel (x, y), with a margin of half a pixel around it, falls on. It tests points that are
 * 1/8 pixel apart. */
static void mark_patches(const bis_envmap *em, unsigned char *fine, int side, int x, int y)
{
    for (int i = -8; i <= 8; i++) {
        for (int j = -8; j <= 8; j++) {
            double q[2];
            disc_position(side, x + i / 8.0, y + j / 8.0, q);
            if (q[0] * q[0] + q[1] * q[1] <= 1) fine[bis_envmap_pixel(em, disc_to_direction(q))] = 1;
        }
    }
}

static void mark_bright(const bis_envmap *em, unsigned char *fine, const probe *p, double power)
{
    for (int y = 0; y < p->side; y++) {
        for (int x = 0; x < p->side; x++) {
            if (!in_disc(p->side, x, y)) continue;
            const double intensity = rgb_sum(p->pixels[(size_t)y * (size_t)p->side + (size_t)x]);
            if (intensity * pixel_solid_angle(p->side, x, y) > BRIGHT_SHARE * power)
                mark_patches(em, fine, p->side, x, y);
        }
    }
}

bis_status bis_envmap_from_angular(bis_envmap *em, const bis_image *image, int width, bis_diag *diag)
{
    *em = (bis_envmap){0};
    if (image->width != image->height) {
        return bis_error(diag, BIS_INPUT, (bis_loc){0},
                         "an angular map must be square, this one is %d x %d; is it a \"latlong\" map?", image->width,
                         image->height);
    }
    assert(width >= 0);
    const int side = image->width;
    if (width == 0) width = 2 * side;
    width += width % 2;
    const int height = width / 2;
    const size_t n = (size_t)width * (size_t)height;
    probe p = {bis_alloc((size_t)side * (size_t)side, sizeof *p.pixels), side};
    unsigned char *fine = bis_alloc(n, 1);
    em->pixels = bis_alloc(n, sizeof *em->pixels);
    bis_status status = bis_envmap_init_rows(em, width, height, diag);
    if (status) goto done;
    if (!p.pixels || !fine || !em->pixels) {
        status =
            bis_error(diag, BIS_NOMEM, (bis_loc){0},
                      "no memory for an angular map of %d x %d and its lat-long of %d x %d", side, side, width, height);
        goto done;
    }
    em->angular_power_before = clean_probe(&p, image, &em->defects);
    mark_bright(em, fine, &p, em->angular_power_before);

    /* A patch on the equator is side/width pixels wide at the disc's centre: such a pixel gets 8 samples in each
     * direction. */
    const int k = side >= width / 4 ? (8 * side + width - 1) / width : 2;
#pragma omp parallel for schedule(dynamic)
    for (int y = 0; y < height; y++) {
        for (int x = 0; x < width; x++) {
            const size_t i = (size_t)y * (size_t)width + (size_t)x;
            em->pixels[i] = gather_patch(em, &p, x, y, fine[i] ? FINER * k : k);
        }
    }
    em->angular_power_after = bis_envmap_power(em);
done:
    bis_free(p.pixels);
    bis_free(fine);
    if (status) bis_envmap_clear(em);
    return status;
}
