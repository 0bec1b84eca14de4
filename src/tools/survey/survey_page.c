/* SPDX-License-Identifier: BSD-2-Clause */
/* survey_page: the page of `bis envmap --html`. Written here is what it shows beyond `--json` (docs/live.md): the map,
 * of each pixel its level, its region and the density by which directions are drawn, and directions so drawn.
 * page.html draws them.
 *
 * A page of a large map has of each step x step pixels the one in the middle, and the mean of their densities, so that
 * it has at most BIS_SURVEY_PAGE_WIDTH columns. */
#include "survey.h"

#include "bis/base/mem.h"
#include "bis/thesis/rng.h"
#include "out/page.h"

#include <float.h>
#include <stdlib.h>

enum { CODES = 65535 };

typedef struct places {
    const bis_envmap *em;
    int step, width, height;
} places;

static places places_of(const bis_envmap *em)
{
    const int step = (em->width + BIS_SURVEY_PAGE_WIDTH - 1) / BIS_SURVEY_PAGE_WIDTH;
    return (places){em, step, (em->width + step - 1) / step, (em->height + step - 1) / step};
}

/* The pixel in the middle of place i, as far as the map goes. */
static size_t pixel_of(const places *p, size_t i)
{
    const int x = (int)(i % (size_t)p->width) * p->step + p->step / 2;
    const int y = (int)(i / (size_t)p->width) * p->step + p->step / 2;
    const int width = p->em->width, height = p->em->height;
    return (size_t)(y < height ? y : height - 1) * (size_t)width + (size_t)(x < width ? x : width - 1);
}

/* The mean density of a place, 1/sr. */
static double density_of(const places *p, const bis_importance *im, size_t i)
{
    const int x0 = (int)(i % (size_t)p->width) * p->step, y0 = (int)(i / (size_t)p->width) * p->step;
    double sum = 0;
    int n = 0;
    for (int y = y0; y < y0 + p->step && y < p->em->height; y++) {
        for (int x = x0; x < x0 + p->step && x < p->em->width; x++, n++)
            sum += bis_importance_pdf_pixel(im, (size_t)y * (size_t)p->em->width + (size_t)x);
    }
    return sum / n;
}

static const char what[] = "the page of a map";

/* Codes of the density: 0 is a density of 0, else 1 + (CODES - 1) log(q/least)/log(most/least). */
static bis_status put_densities(bis_json *j, const places *p, const bis_importance *im, uint32_t *v, bis_diag *diag)
{
    const size_t n = (size_t)p->width * (size_t)p->height;
    double *q = bis_alloc(n, sizeof *q), least = DBL_MAX, most = 0;

    if (!q) return bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for %s", what);
    for (size_t i = 0; i < n; i++) {
        q[i] = density_of(p, im, i);
        most = fmax(most, q[i]);
        if (q[i] > 0) least = fmin(least, q[i]);
    }
    for (size_t i = 0; i < n; i++) {
        const double t = most > least ? log(q[i] / least) / log(most / least) : 1;
        v[i] = q[i] > 0 ? 1 + (uint32_t)lround((CODES - 1) * t) : 0;
    }
    bis_free(q);
    BIS_JSON_NUMBERS(j, {"least", most > 0 ? least : 0}, {"most", most});
    return bis_page_numbers(j, "density", v, n, 2, what, diag);
}

/* Where directions are drawn, as those of the picture (bis_survey_importance_picture): theta and phi in turns. */
static void put_samples(bis_json *j, const bis_envmap *em, const bis_importance *im, int n_samples)
{
    bis_rng rng;

    bis_rng_init(&rng, 0, 0, 0, 0);
    bis_json_open(j, "samples", '[');
    for (int i = 0; i < n_samples; i++) {
        const double u[4] = {bis_rng_double(&rng), bis_rng_double(&rng), bis_rng_double(&rng), bis_rng_double(&rng)};
        bis_map_sample s;
        if (!bis_importance_sample(im, u, &s)) continue;
        const double x = (double)(s.pixel % (size_t)em->width), y = (double)(s.pixel / (size_t)em->width);
        BIS_JSON_OBJECT(j, NULL, {"theta_deg", 180 * (y + 0.5) / em->height}, {"phi_deg", 360 * (x + 0.5) / em->width});
    }
    bis_json_close(j);
}

/* The map at the places, for a screen: scaled so that the mean is a middle grey. */
static bis_status put_picture(bis_json *j, const places *p, const bis_survey *s, bis_diag *diag)
{
    bis_image image;
    const bis_status status = bis_image_init(&image, p->width, p->height, diag);

    if (status) return status;
    for (size_t i = 0; i < (size_t)p->width * (size_t)p->height; i++) image.pixels[i] = p->em->pixels[pixel_of(p, i)];
    const double middle = fmax(s->median, s->mean / 8) / 3; /* of a channel */
    char *png = bis_page_png(&image, middle > 0 ? log2(0.18 / middle) : 0, diag);
    bis_image_clear(&image);
    if (!png) return BIS_NOMEM;
    bis_json_text(j, "picture", png);
    free(png);
    return BIS_OK;
}

bis_status bis_survey_put_page(bis_json *j, const bis_survey *s, const bis_light *light, const bis_regions *regions,
                               int n_samples, bis_diag *diag)
{
    const bis_envmap *em = bis_light_envmap(light);
    const bis_importance *im = bis_light_importance(light);
    const places p = places_of(em);
    const size_t n = (size_t)p.width * (size_t)p.height;
    const bis_levels levels = bis_levels_of(em, s->n_levels ? s->n_levels : 1); /* none: all is black, in no level */
    uint32_t *v = bis_alloc(n, sizeof *v);

    if (!v) return bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for %s", what);
    bis_json_open(j, "places", '{');
    BIS_JSON_NUMBERS(j, {"width", p.width}, {"height", p.height}, {"step", p.step});
    bis_status status = put_picture(j, &p, s, diag);
    for (size_t i = 0; i < n; i++) v[i] = bis_level_of_intensity(&levels, rgb_sum(em->pixels[pixel_of(&p, i)]));
    if (!status) status = bis_page_numbers(j, "level", v, n, 1, what, diag);
    for (size_t i = 0; i < n; i++) v[i] = regions->label[pixel_of(&p, i)];
    if (!status) status = bis_page_numbers(j, "region", v, n, 4, what, diag);
    if (!status) status = put_densities(j, &p, im, v, diag);
    bis_json_close(j);
    bis_free(v);
    put_samples(j, em, im, n_samples);
    return status;
}
