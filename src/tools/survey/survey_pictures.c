/* SPDX-License-Identifier: BSD-2-Clause */
/* survey_pictures: levels, regions and importance of a map in the colours of palette.h. */
#include "survey.h"

#include "bis/thesis/rng.h"

#include "out/palette.h"

#include <float.h>

/* Hue in turns, by the hexagon. */
static rgb hsv(double hue, double saturation, double value)
{
    double c[3];
    for (int i = 0; i < 3; i++) {
        const double turn = hue + (3 - i) / 3.0, place = 6 * (turn - floor(turn));
        c[i] = value * (1 - saturation * (1 - fmin(fmax(fabs(place - 3) - 1, 0), 1)));
    }
    return bis_palette_srgb(c[0], c[1], c[2]);
}

bis_status bis_survey_levels_picture(bis_image *out, const bis_envmap *em, int levels, bis_diag *diag)
{
    const bis_status status = bis_image_init(out, em->width, em->height, diag);
    if (status) return status;
    const bis_levels l = bis_levels_of(em, levels);
    const double last = levels > 1 ? levels - 1 : 1;
    for (size_t i = 0; i < (size_t)em->width * (size_t)em->height; i++) {
        const uint8_t level = bis_level_of_intensity(&l, rgb_sum(em->pixels[i]));
        if (level != BIS_LEVEL_NONE) out->pixels[i] = bis_palette_heat(level / last); /* black pixels stay black */
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
            *p = d <= 1 ? bis_palette_srgb(0.55, 1, 0.95) : rgb_scale(*p, 0.3);
        }
    }
}

bis_status bis_survey_importance_picture(bis_image *out, const bis_envmap *em, const bis_importance *im, int n_samples,
                                         bis_diag *diag)
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
        if (q > 0) out->pixels[i] = bis_palette_heat(most > least ? log(q / least) / log(most / least) : 1);
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
