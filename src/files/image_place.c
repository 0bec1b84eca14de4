/* SPDX-License-Identifier: BSD-2-Clause */
/* image_place: what the pixels of an OpenEXR file cover.
 *
 * The picture is the display window. The file has the pixels of its data window: what that lacks of the picture is
 * black, what it has beyond is cut. Of a map that lacks a part nobody knows the light, so that it is refused.
 * OpenEXR's own maps have their pixels on edges: the first and the last column of a lat-long map are one direction, its
 * first and last row are the poles, and the faces of a cube share their edges. Ours have pixels that are cells. A
 * lat-long map keeps its size, and takes values between four pixels; a cube's face of n x n pixels becomes
 * (n - 1) x (n - 1) cells, each the mean of its four corners, which keeps the light.
 * The faces stand as +x -x +y -y +z -z, with +z in the middle of the lat-long map, y up, and -x to its right; ours are
 * right, left, up, down, front, back. Up and down are turned by 180 degrees. Source: OpenEXR, ImfEnvmap.h and
 * ImfEnvmap.cpp ("Environment Maps"). */
#include "image_io.h"

#include "bis/base/mem.h"

#include <string.h>

static int min_int(int a, int b) { return a < b ? a : b; }
static int max_int(int a, int b) { return a > b ? a : b; }

void bis_image_cut(bis_image *image, int x, int y, int width, int height)
{
    for (int j = 0; j < height; j++) {
        const size_t to = (size_t)j * (size_t)width, from = (size_t)(y + j) * (size_t)image->width + (size_t)x;
        memmove(image->pixels + to, image->pixels + from, (size_t)width * sizeof *image->pixels);
        if (image->alpha) memmove(image->alpha + to, image->alpha + from, (size_t)width * sizeof *image->alpha);
    }
    image->width = width;
    image->height = height;
}

bis_status bis_place_cut(bis_image *image, const image_input *in)
{
    bis_image_place *p = in->place;
    if (p->full_width == 0) *p = (bis_image_place){0, 0, image->width, image->height, 0, 0};
    const int left = max_int(-p->x0, 0), right = min_int(image->width, p->full_width - p->x0);
    const int top = max_int(-p->y0, 0), bottom = min_int(image->height, p->full_height - p->y0);

    if (left >= right || top >= bottom)
        return bis_image_refuse(in, BIS_INPUT, "its data window lies outside of its display window");
    if (right - left == image->width && bottom - top == image->height) return BIS_OK;
    bis_image_remark(in, "its data window, %d x %d pixels, goes beyond its display window, %d x %d: what lies outside "
                     "is cut", image->width, image->height, p->full_width, p->full_height);
    bis_image_cut(image, left, top, right - left, bottom - top);
    p->x0 += left;
    p->y0 += top;
    return BIS_OK;
}

static bool fills(const bis_image *image, const bis_image_place *p)
{
    return image->width == p->full_width && image->height == p->full_height;
}

/* A header of some bytes must not fill the memory: it may have so many pixels in any case, 192 MiB, and beyond them so
 * many for each that the file has. */
enum { FREE_PIXELS = 1 << 24, MOST_FOR_ONE = 100 };

bis_status bis_place_fill(bis_image *image, const image_input *in)
{
    const bis_image_place *p = in->place;
    const double all = (double)p->full_width * p->full_height, own = (double)image->width * image->height;
    bis_image whole;

    if (fills(image, p)) return BIS_OK;
    if (all > FREE_PIXELS && all > MOST_FOR_ONE * own)
        return bis_image_refuse(in, BIS_INPUT, "its data window, %d x %d pixels, is less than 1 %% of its display "
                                "window, %d x %d", image->width, image->height, p->full_width, p->full_height);
    bis_status status = bis_image_make(&whole, in, p->full_width, p->full_height);
    if (!status && in->wants_alpha) status = bis_image_add_alpha(&whole, in->diag);
    if (status) {
        bis_image_clear(&whole);
        return status;
    }
    for (int y = 0; y < image->height; y++) {
        const size_t width = (size_t)image->width, from = (size_t)y * width;
        const size_t to = (size_t)(p->y0 + y) * (size_t)whole.width + (size_t)p->x0;
        memcpy(whole.pixels + to, image->pixels + from, width * sizeof *image->pixels);
        for (size_t i = 0; whole.alpha && i < width; i++)
            whole.alpha[to + i] = image->alpha ? image->alpha[from + i] : 1;
    }
    bis_image_remark(in, "its data window is %d x %d pixels at (%d, %d) of a display window of %d x %d: the rest is "
                     "black", image->width, image->height, p->x0, p->y0, p->full_width, p->full_height);
    bis_image_clear(image);
    *image = whole;
    return BIS_OK;
}

/* ---- maps ---- */

/* Between the four pixels around (x, y); the centre of a pixel is a whole number. */
static rgb between(const bis_image *image, double x, double y)
{
    const int i = (int)x, j = (int)y;
    const double s = x - i, t = y - j;
    const rgb *p = image->pixels + (size_t)j * (size_t)image->width + i;
    const rgb *q = j + 1 < image->height ? p + image->width : p;
    const int next = i + 1 < image->width;
    return rgb_add(rgb_scale(rgb_add(rgb_scale(p[0], 1 - s), rgb_scale(p[next], s)), 1 - t),
                   rgb_scale(rgb_add(rgb_scale(q[0], 1 - s), rgb_scale(q[next], s)), t));
}

static void cells_of_latlong(bis_image *out, const bis_image *image)
{
    for (int y = 0; y < out->height; y++)
        for (int x = 0; x < out->width; x++)
            out->pixels[(size_t)y * (size_t)out->width + (size_t)x] =
                between(image, (x + 0.5) * (image->width - 1) / out->width,
                        (y + 0.5) * (image->height - 1) / out->height);
}

static void cells_of_cube(bis_image *out, const bis_image *image)
{
    static const struct { int face; bool turned; } from[6] = {{1, 0}, {0, 0}, {2, 1}, {3, 1}, {4, 0}, {5, 0}};
    const int n = out->width;

    for (int y = 0; y < out->height; y++)
        for (int x = 0; x < n; x++) {
            const int k = y / n;
            const double u = x + 0.5, v = y % n + 0.5;
            out->pixels[(size_t)y * (size_t)n + (size_t)x] =
                between(image, from[k].turned ? n - u : u, (n + 1) * from[k].face + (from[k].turned ? n - v : v));
        }
}

bis_status bis_place_map(bis_image *image, const image_input *in)
{
    const bis_image_place *p = in->place;
    const bool is_cube = *in->layout == BIS_EXR_CUBE;
    const int n = image->width;
    bis_image out;

    if (!fills(image, p))
        return bis_image_refuse(in, BIS_INPUT, "its data window, %d x %d pixels at (%d, %d), does not fill its display "
                                "window of %d x %d: a map needs all directions", image->width, image->height, p->x0,
                                p->y0, p->full_width, p->full_height);
    if (*in->layout == BIS_EXR_PICTURE) return BIS_OK;
    if (is_cube && (n < 2 || image->height != 6 * n))
        return bis_image_refuse(in, BIS_INPUT, "its envmap attribute says that it is OpenEXR's cube map, but %d x %d "
                                "pixels are no six square faces one below the other", n, image->height);
    const bis_status status = bis_image_make(&out, in, is_cube ? n - 1 : n, is_cube ? 6 * (n - 1) : image->height);
    if (status) return status;
    if (is_cube) cells_of_cube(&out, image);
    else cells_of_latlong(&out, image);
    bis_image_clear(image);
    *image = out;
    return BIS_OK;
}
