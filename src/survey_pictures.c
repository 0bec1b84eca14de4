/* survey_pictures: levels, regions and importance of a map in colours that a lecture hall can tell apart.
 *
 * Colours are chosen as they appear (sRGB) and stored as what images here hold (linear light). */
#include "survey.h"

#include "bis/rng.h"

#include <float.h>

/* sRGB's transfer function, IEC 61966-2-1. */
static double to_linear(double v) { return v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4); }

static rgb colour(double r, double g, double b) { return rgb_from(to_linear(r), to_linear(g), to_linear(b)); }

/* Dark blue over purple, red and orange to pale yellow, each lighter than the one before: reads in grey print, too. */
static rgb heat(double t)
{
    static const double stops[][3] = {
        {0.05, 0.03, 0.20}, {0.25, 0.07, 0.43}, {0.53, 0.13, 0.42}, {0.80, 0.24, 0.30}, {0.95, 0.47, 0.12}, {0.98, 0.76, 0.22}, {1.0, 0.99, 0.80},
    };
    enum { LAST = sizeof stops / sizeof *stops - 1 };
    const double place = fmin(fmax(t, 0), 1) * LAST;
    const int i = place < LAST ? (int)place : LAST - 1;
    const double f = place - i, *a = stops[i], *b = stops[i + 1];
    return colour(a[0] + f * (b[0] - a[0]), a[1] + f * (b[1] - a[1]), a[2] + f * (b[2] - a[2]));
}

/* Hue in turns, by the hexagon. */
static rgb hsv(double hue, double saturation, double value)
{
    double c[3];
    for (int i = 0; i < 3; i++) {
        const double turn = hue + (3 - i) / 3.0, place = 6 * (turn - floor(turn));
        c[i] = value * (1 - saturation * (1 - fmin(fmax(fabs(place - 3) - 1, 0), 1)));
    }
    return colour(c[0], c[1], c[2]);
}

bis_status bis_survey_levels_picture(bis_image *out, const bis_envmap *em, int levels, bis_diag *diag)
{
    const bis_status status = bis_image_init(out, em->width, em->height, diag);
    if (status) return status;
    const bis_levels l = bis_levels_of(em, levels);
    const double last = levels > 1 ? levels - 1 : 1;
    for (size_t i = 0; i < (size_t)em->width * (size_t)em->height; i++) {
        const uint8_t level = bis_level_of_intensity(&l, rgb_sum(em->pixels[i]));
        if (level != BIS_LEVEL_NONE) out->pixels[i] = heat(level / last); /* black pixels stay black */
    }
    return BIS_OK;
}

bis_status bis_survey_regions_picture(bis_image *out, const bis_envmap *em, const bis_regions *regions, bis_diag *diag)
{
    const bis_status status = bis_image_init(out, em->width, em->height, diag);
    if (status) return status;
    double last = 1;
    for (uint32_t k = 0; k < regions->n; k++) last = fmax(last, regions->level[k]);
    for (size_t i = 0; i < (size_t)em->width * (size_t)em->height; i++) {
        const uint32_t label = regions->label[i];
        if (label == BIS_REGION_NONE) continue;
        const double hue = label * 0.6180339887498949; /* the golden section: successive labels get hues far apart */
        const double height = regions->level[label] / last;
        out->pixels[i] = hsv(hue, 0.75 - 0.45 * height, 0.25 + 0.75 * height);
    }
    return BIS_OK;
}

/* A dot with a dark rim, its width a hundredth of the picture's height; wraps around like the map. */
static void draw_dot(bis_image *out, size_t pixel)
{
    const int width = out->width, x0 = (int)(pixel % (size_t)width), y0 = (int)(pixel / (size_t)width);
    const double radius = fmax(out->height / 200.0, 0.5);
    const int reach = (int)ceil(1.6 * radius);
    for (int dy = -reach; dy <= reach; dy++) {
        for (int dx = -reach; dx <= reach; dx++) {
            const double d = hypot(dx, dy) / radius;
            const int x = ((x0 + dx) % width + width) % width, y = y0 + dy;
            if (d > 1.6 || y < 0 || y >= out->height) continue;
            rgb *p = &out->pixels[(size_t)y * (size_t)width + (size_t)x];
            *p = d <= 1 ? colour(0.55, 1, 0.95) : rgb_scale(*p, 0.3);
        }
    }
}

bis_status bis_survey_importance_picture(bis_image *out, const bis_envmap *em, const bis_importance *im, int n_samples, bis_diag *diag)
{
    const bis_status status = bis_image_init(out, em->width, em->height, diag);
    if (status) return status;
    const size_t n = (size_t)em->width * (size_t)em->height;
    double least = DBL_MAX, most = 0;
    for (size_t i = 0; i < n; i++) {
        const double q = bis_importance_pdf_pixel(im, i);
        most = fmax(most, q);
        if (q > 0) least = fmin(least, q);
    }
    for (size_t i = 0; i < n; i++) {
        const double q = bis_importance_pdf_pixel(im, i);
        if (q > 0) out->pixels[i] = heat(most > least ? log(q / least) / log(most / least) : 1);
    }
    bis_rng rng;
    bis_rng_init(&rng, 0, 0, 0, 0);
    for (int i = 0; i < n_samples; i++) {
        const double u[4] = {bis_rng_double(&rng), bis_rng_double(&rng), bis_rng_double(&rng), bis_rng_double(&rng)};
        bis_map_sample s;
        if (bis_importance_sample(im, u, &s)) draw_dot(out, s.pixel);
    }
    return BIS_OK;
}
