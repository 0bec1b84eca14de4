/* fuzz_map: an image of any kind as a map of any mapping, resampled to lat-long and from there to any other. Byte 0
 * chooses the mappings, byte 1 the width; the rest is the file. Fixes the resampler's promises: finite, no light from
 * nowhere. */
#include "bis/beyond/mapping.h"
#include "bis/files/image_file.h"
#include "input.h"

#include <math.h>

static double most_of(const rgb *pixels, size_t n)
{
    double most = 0;
    for (size_t i = 0; i < n; i++) {
        const double v = fmax(fmax((double)pixels[i].r, (double)pixels[i].g), (double)pixels[i].b);
        fuzz_require(isfinite(v) && pixels[i].r >= 0 && pixels[i].g >= 0 && pixels[i].b >= 0, "finite radiance");
        most = fmax(most, v);
    }
    return most;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    bis_image image, other;
    bis_envmap em;
    double power[2];
    if (size < 2 || bis_image_read(&image, fuzz_file(data + 2, size - 2), (bis_loc){0}, NULL)) return 0;
    const bis_mapping from = (bis_mapping)(data[0] % BIS_N_MAPPINGS), to = (bis_mapping)(data[0] / 8 % BIS_N_MAPPINGS);
    const int width = data[1] % 5; /* a lamp takes 65536 samples in each pixel about it */
    double most = 0;
    for (int i = 0; i < image.width * image.height && (int64_t)image.width * image.height < 50; i++) {
        const rgb c = image.pixels[i];
        if (isfinite(c.r)) most = fmax(most, (double)c.r);
        if (isfinite(c.g)) most = fmax(most, (double)c.g);
        if (isfinite(c.b)) most = fmax(most, (double)c.b);
    }
    if ((int64_t)image.width * image.height < 50 && !bis_envmap_from_mapping(&em, &image, from, width, NULL)) {
        fuzz_require(most_of(em.pixels, (size_t)em.width * (size_t)em.height) <= most, "no light from nowhere");
        if (!bis_envmap_to_mapping(&other, &em, to, width, power, NULL)) {
            fuzz_require(most_of(other.pixels, (size_t)other.width * (size_t)other.height) <= most, "nor from the map");
            bis_image_clear(&other);
        }
        bis_envmap_clear(&em);
    }
    bis_image_clear(&image);
    return 0;
}
