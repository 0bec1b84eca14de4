/* SPDX-License-Identifier: BSD-2-Clause */
/* fuzz_map: an image of any kind as a map of any mapping, resampled to lat-long and from there to any other. Byte 0
 * chooses the mappings, byte 1 the width; the rest is the file. Fixes the resampler's promises: finite, and the energy
 * is kept. */
#include "bis/beyond/mapping.h"
#include "bis/files/image_file.h"
#include "input.h"

#include <math.h>

static void require_radiance(const rgb *pixels, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        const double v = fmax(fmax((double)pixels[i].r, (double)pixels[i].g), (double)pixels[i].b);
        fuzz_require(isfinite(v) && pixels[i].r >= 0 && pixels[i].g >= 0 && pixels[i].b >= 0, "finite radiance");
    }
}

/* Where float has its full precision: below 1e-30 a pixel may lose its bits. */
static void require_energy(double before, double after)
{
    if (before > 1e-30) fuzz_require(fabs(after / before - 1) < 1e-3, "energy is kept");
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    bis_image image, other;
    bis_envmap em;
    double power[2];
    if (size < 2 || bis_image_read(&image, fuzz_file(data + 2, size - 2), (bis_loc){0}, NULL)) return 0;
    const bis_mapping from = (bis_mapping)(data[0] % BIS_N_MAPPINGS), to = (bis_mapping)(data[0] / 8 % BIS_N_MAPPINGS);
    const int width = data[1] % 40;
    if ((int64_t)image.width * image.height < 5000 && !bis_envmap_from_mapping(&em, &image, from, width, NULL)) {
        require_radiance(em.pixels, (size_t)em.width * (size_t)em.height);
        if (from != BIS_MAPPING_LATLONG) require_energy(em.power_before, em.power_after);
        if (!bis_envmap_to_mapping(&other, &em, to, width, power, NULL)) {
            require_radiance(other.pixels, (size_t)other.width * (size_t)other.height);
            require_energy(power[0], power[1]);
            bis_image_clear(&other);
        }
        bis_envmap_clear(&em);
    }
    bis_image_clear(&image);
    return 0;
}
