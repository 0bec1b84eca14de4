/* SPDX-License-Identifier: BSD-2-Clause */
/* image_png: 8 bit sRGB, to look at, never to measure by. Written by libpng.
 *
 * Exposure: radiance times 2^EV, or, when none is given, times 0.18 / L, where L is the log-average of the luminance:
 * the picture's middle lands on a middle grey (E. Reinhard et al., "Photographic Tone Reproduction for Digital Images",
 * 2002, eq. 1 and 2; where they add a small delta so that black has a logarithm, we leave black pixels out, so that a
 * large black background changes nothing). Like a photographer we meter on the subject: the mean is weighted by the
 * share of geometry in a pixel, else a dark background makes the subject white. There is no tone curve: what is
 * brighter than white is white. NaN is black.
 *
 * Alpha: a PNG's colours are not premultiplied (its specification, 12.4), and alpha is linear. So radiance is divided
 * by alpha before the exposure and the curve; where alpha is 0, the colour is 0.
 * libpng leaves by longjmp on errors: the one function with setjmp changes no local variable after it, and all that is
 * to be freed hangs on a struct of its caller. */
#include "image_png.h"

#include "bis/base/mem.h"

#include "png_failure.h"

#include <png.h>
#include <setjmp.h>
#include <string.h>

static double value_of(const bis_channel *c, size_t i) { return (double)c->data[i * (size_t)c->stride]; }

static double luminance(const bis_picture *picture, size_t i)
{
    const bis_channel *c = picture->channels;
    return 0.2126 * value_of(c, i) + 0.7152 * value_of(c + 1, i) + 0.0722 * value_of(c + 2, i);
}

/* NULL: the picture is opaque. */
static const bis_channel *find_alpha(const bis_picture *picture)
{
    for (int k = 0; k < picture->n_channels; k++)
        if (strcmp(picture->channels[k].name, "A") == 0) return &picture->channels[k];
    return NULL;
}

/* The weights of the mean; NULL where nothing tells, or where all is background: each pixel counts as much. */
static const bis_channel *find_subject(const bis_picture *picture)
{
    const bis_channel *c = picture->subject ? picture->subject : find_alpha(picture);
    const size_t n = (size_t)picture->width * (size_t)picture->height;

    for (size_t i = 0; c && i < n; i++)
        if (value_of(c, i) > 0) return c;
    return NULL;
}

/* What radiance is multiplied by. A picture without a finite positive luminance is black at any exposure: 1. */
static double scale_of(const bis_picture *picture)
{
    const double key = 0.18;
    const bis_channel *subject = find_subject(picture);
    size_t n = (size_t)picture->width * (size_t)picture->height;
    double sum = 0, weights = 0;

    if (picture->has_exposure) return exp2(picture->exposure);
    for (size_t i = 0; i < n; i++) {
        const double L = luminance(picture, i), weight = subject ? value_of(subject, i) : 1;
        if (!(L > 0 && isfinite(L))) continue;
        sum += weight * log(L);
        weights += weight;
    }
    return weights > 0 ? key / exp(sum / weights) : 1;
}

double bis_png_exposure(const bis_picture *picture)
{
    return picture->has_exposure ? picture->exposure : log2(scale_of(picture));
}

/* The sRGB curve (IEC 61966-2-1), rounded to 8 bit. */
static unsigned char to_srgb(double v)
{
    if (!(v > 0)) return 0; /* NaN, too */
    if (v >= 1) return 255;
    double s = bis_image_from_linear(v, BIS_GAMMA_SRGB);
    return (unsigned char)(255 * s + 0.5);
}

static void convert_row(unsigned char *row, const bis_picture *picture, const bis_channel *alpha, int y, double scale)
{
    const size_t width = (size_t)picture->width, n = alpha ? 4 : 3;
    for (size_t x = 0; x < width; x++) {
        const size_t i = (size_t)y * width + x;
        const double a = alpha ? value_of(alpha, i) : 1;
        const unsigned char code = (unsigned char)(255 * fmin(fmax(a, 0), 1) + 0.5);
        for (size_t k = 0; k < 3; k++)
            row[n * x + k] = code ? to_srgb(scale * value_of(&picture->channels[k], i) / a) : 0;
        if (alpha) row[4 * x + 3] = code;
    }
}

typedef struct png_job {
    const bis_picture *picture;
    FILE *stream;
    unsigned char *row;
    png_structp png;
    png_infop info;
    png_failure failure;
} png_job;

/* All calls that may longjmp. False: it failed, job->failure.reason says why. */
static bool write_rows(png_job *job)
{
    const bis_picture *picture = job->picture;
    const bis_channel *alpha = find_alpha(picture);
    if (setjmp(png_jmpbuf(job->png))) return false;
    png_init_io(job->png, job->stream);
    png_set_IHDR(job->png, job->info, (png_uint_32)picture->width, (png_uint_32)picture->height, 8,
                 alpha ? PNG_COLOR_TYPE_RGB_ALPHA : PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_sRGB_gAMA_and_cHRM(job->png, job->info, PNG_sRGB_INTENT_PERCEPTUAL);
    png_write_info(job->png, job->info);
    const double scale = scale_of(picture);
    for (int y = 0; y < picture->height; y++) {
        convert_row(job->row, picture, alpha, y, scale);
        png_write_row(job->png, job->row);
    }
    png_write_end(job->png, job->info);
    return true;
}

bis_status bis_png_write(FILE *stream, const bis_picture *picture, const char *path, bis_diag *diag)
{
    bis_status status = BIS_OK;
    bis_loc at = {path, 0, 0};
    png_job job = {.picture = picture, .stream = stream};

    job.row = bis_alloc((size_t)picture->width, 4);
    if (job.row)
        job.png = png_create_write_struct_2(PNG_LIBPNG_VER_STRING, &job.failure, png_on_error, png_on_warning,
                                           &job.failure, png_allocate, png_release);
    if (job.png) job.info = png_create_info_struct(job.png);
    if (!job.info) {
        status = bis_error(diag, BIS_NOMEM, at, "no memory to write \"%s\"", path);
        goto done;
    }
    if (write_rows(&job)) goto done;
    if (job.failure.out_of_memory)
        status = bis_error(diag, BIS_NOMEM, at, "no memory to write \"%s\"", path);
    else
        status = bis_error(diag, BIS_IO, at, "cannot write \"%s\": %s", path, job.failure.reason);
done:
    png_destroy_write_struct(&job.png, &job.info);
    bis_free(job.row);
    return status;
}
