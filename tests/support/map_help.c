/* SPDX-License-Identifier: BSD-2-Clause */
#include "map_help.h"

#include "bis/thesis/rng.h"
#include "bis/base/image.h"
#include "claim.h"

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

bis_envmap map_new(int width, int height)
{
    bis_image image;
    bis_envmap em;
    assert_int_equal(bis_image_init(&image, width, height, NULL), BIS_OK);
    assert_int_equal(bis_envmap_from_latlong(&em, &image, NULL), BIS_OK);
    return em;
}

bis_envmap map_random(int width, int height, double decades, double black, uint64_t seed)
{
    bis_envmap em = map_new(width, height);
    bis_rng r;
    bis_rng_init(&r, seed, 0, 0, 0);
    for (size_t i = 0; i < map_n(&em); i++) {
        const double intensity = pow(10, decades * (bis_rng_double(&r) - 0.5));
        const double a = bis_rng_double(&r), b = (1 - a) * bis_rng_double(&r);
        if (bis_rng_double(&r) >= black) em.pixels[i] = rgb_from(a * intensity, b * intensity, (1 - a - b) * intensity);
    }
    return em;
}

bis_envmap map_rolled(const bis_envmap *em, int k)
{
    bis_envmap rolled = map_new(em->width, em->height);
    for (int y = 0; y < em->height; y++) {
        for (int x = 0; x < em->width; x++) {
            rolled.pixels[y * em->width + (x + k) % em->width] = em->pixels[y * em->width + x];
        }
    }
    return rolled;
}

size_t map_n(const bis_envmap *em) { return (size_t)em->width * (size_t)em->height; }
double map_intensity(const bis_envmap *em, size_t pixel) { return rgb_sum(em->pixels[pixel]); }
double map_solid_angle(const bis_envmap *em, size_t pixel) { return em->row_solid_angle[pixel / (size_t)em->width]; }

void map_assert_near(double a, double b, double tolerance, const char *file, int line)
{
    if (fabs(a - b) <= tolerance) return;
    print_error("%.17g and %.17g differ by %g, more than %g\n", a, b, fabs(a - b), tolerance);
    _fail(file, line);
}

const char *shared_data(const char *name)
{
    static char path[4096];
    const char *folder = getenv("BIS_SHARED");
    snprintf(path, sizeof path, "%s/%s", folder ? folder : "../shared/data", name);
    return access(path, R_OK) == 0 ? path : NULL;
}
