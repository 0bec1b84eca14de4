/* SPDX-License-Identifier: BSD-2-Clause */
/* image_png_read: the colours of a PNG, for textures. Read by libpng; maps are never read from it, because 8 bits of a
 * screen are no radiance.
 *
 * Every kind of PNG becomes 8 or 16 bits of red, green and blue; what it says of transparency is dropped. A table turns
 * these numbers into linear values. libpng leaves by longjmp on errors: see image_png.c.
 * What a header claims is held against the file: deflate makes at most 1032 bytes of one. */
#include "image_png.h"

#include "bis/base/mem.h"
#include "image_io.h"

#include "png_failure.h"

#include <png.h>
#include <setjmp.h>
#include <stdint.h>
#include <string.h>

enum { DEFLATE_MOST = 1032 };

typedef struct png_job {
    const image_input *in;
    size_t at; /* of the next byte that libpng gets */
    png_structp png;
    png_infop info;
    png_uint_32 width, height;
    int kept_depth, kept_colour; /* of the file, before the conversion */
    size_t row_bytes;
    int depth;           /* 8 or 16, after the conversion */
    size_t channels;     /* 3, or 4 with alpha, after the conversion */
    int passes;          /* over the rows */
    double gamma;        /* of its gAMA chunk; BIS_GAMMA_SRGB: it has none, or is sRGB */
    unsigned char *rows; /* all of them */
    png_failure failure;
} png_job;

static void take_bytes(png_structp png, png_bytep out, size_t n)
{
    png_job *job = png_get_io_ptr(png);
    if (n > job->in->size - job->at) png_error(png, "the file is cut off");
    memcpy(out, job->in->data + job->at, n);
    job->at += n;
}

/* The header, and the conversion to 8 or 16 bits of RGB. False: libpng failed. */
static bool read_header(png_job *job)
{
    if (setjmp(png_jmpbuf(job->png))) return false;
    png_set_user_limits(job->png, BIS_IMAGE_MAX_SIDE, BIS_IMAGE_MAX_SIDE);
    png_set_chunk_malloc_max(job->png, 1 << 24);
    png_set_read_fn(job->png, job, take_bytes);
    png_read_info(job->png, job->info);
    png_get_IHDR(job->png, job->info, &job->width, &job->height, &job->kept_depth, &job->kept_colour, NULL, NULL, NULL);
    double encoded; /* sRGB says more than the gamma beside it */
    const bool is_srgb = png_get_valid(job->png, job->info, PNG_INFO_sRGB);
    if (!is_srgb && png_get_gAMA(job->png, job->info, &encoded) && encoded >= 0.1 && encoded <= 10)
        job->gamma = 1 / encoded;
    png_set_expand(job->png); /* palettes, fewer bits than 8 */
    png_set_gray_to_rgb(job->png);
    if (!job->in->wants_alpha) png_set_strip_alpha(job->png);
    job->passes = png_set_interlace_handling(job->png);
    png_read_update_info(job->png, job->info);
    job->row_bytes = png_get_rowbytes(job->png, job->info);
    job->depth = png_get_bit_depth(job->png, job->info);
    job->channels = png_get_channels(job->png, job->info);
    return true;
}

/* An interlaced file visits its rows several times, so that all of them are kept. */
static bool read_rows(png_job *job)
{
    if (setjmp(png_jmpbuf(job->png))) return false;
    for (int pass = 0; pass < job->passes; pass++)
        for (png_uint_32 y = 0; y < job->height; y++)
            png_read_row(job->png, job->rows + y * job->row_bytes, NULL);
    return true;
}

/* What follows the pixels is no reason to do without them. */
static bool read_end(png_job *job)
{
    if (setjmp(png_jmpbuf(job->png))) return false;
    png_read_end(job->png, NULL);
    return true;
}

/* Colours are not premultiplied in the file, and alpha is linear. */
static void convert(bis_image *image, const png_job *job, const float *table)
{
    const bool wide = job->depth == 16;
    const size_t n = job->channels;
    const double most = wide ? 65535 : 255;

    for (size_t y = 0; y < job->height; y++) {
        const unsigned char *row = job->rows + y * job->row_bytes;
        for (size_t x = 0; x < job->width; x++) {
            const size_t at = y * job->width + x;
            int code[4] = {0};
            for (size_t k = 0; k < n; k++) {
                const size_t i = n * x + k;
                code[k] = wide ? row[2 * i] << 8 | row[2 * i + 1] : row[i];
            }
            const rgb c = {table[code[0]], table[code[1]], table[code[2]]};
            image->pixels[at] = n == 4 ? rgb_scale(c, code[3] / most) : c;
            if (n == 4) image->alpha[at] = (float)(code[3] / most);
        }
    }
}

static bis_status refuse(const png_job *job)
{
    if (job->failure.out_of_memory) return bis_image_refuse(job->in, BIS_NOMEM, "no memory for the picture");
    return bis_image_refuse(job->in, BIS_INPUT, "the PNG is damaged: %s", job->failure.reason);
}

/* Numbers that the file keeps of a pixel. */
static unsigned channels_of(int colour)
{
    if (colour & PNG_COLOR_MASK_PALETTE) return 1;
    return (colour & PNG_COLOR_MASK_COLOR ? 3u : 1u) + (colour & PNG_COLOR_MASK_ALPHA ? 1u : 0u);
}

/* Makes room for the rows, once the header's size has been believed. */
static bis_status make_rows(bis_image *image, png_job *job)
{
    const png_uint_32 width = job->width, height = job->height;

    if (job->row_bytes != job->channels * (size_t)job->width * (size_t)(job->depth / 8))
        return bis_image_refuse(job->in, BIS_INPUT, "a PNG of colour type %d and %d bits is not read", job->kept_colour,
                                job->kept_depth);
    const uint64_t bits = (uint64_t)width * (uint64_t)job->kept_depth * channels_of(job->kept_colour);
    if (bits / 8 * height > (uint64_t)job->in->size * DEFLATE_MOST)
        return bis_image_refuse(job->in, BIS_INPUT, "%zu bytes cannot hold %u x %u pixels", job->in->size,
                                (unsigned)width, (unsigned)height);
    bis_status status = bis_image_make(image, job->in, width, height);
    if (!status && job->channels == 4) status = bis_image_add_alpha(image, job->in->diag);
    if (status) return status;
    job->rows = bis_alloc(job->height, job->row_bytes);
    return job->rows ? BIS_OK : bis_image_refuse(job->in, BIS_NOMEM, "no memory for its rows");
}

bool bis_png_is_mine(const unsigned char *data, size_t size)
{
    return size >= 4 && memcmp(data, "\x89PNG", 4) == 0;
}

bis_status bis_png_read(bis_image *image, const image_input *in, double gamma)
{
    bis_status status = BIS_OK;
    png_job job = {.in = in, .gamma = BIS_GAMMA_SRGB};
    float *table = NULL;

    job.png = png_create_read_struct_2(PNG_LIBPNG_VER_STRING, &job.failure, png_on_error, png_on_warning,
                                       &job.failure, png_allocate, png_release);
    if (job.png) job.info = png_create_info_struct(job.png);
    if (!job.info) {
        status = bis_image_refuse(in, BIS_NOMEM, "no memory for the picture");
        goto done;
    }
    if (!read_header(&job)) {
        status = refuse(&job);
        goto done;
    }
    status = make_rows(image, &job);
    if (!status) status = bis_image_table(&table, job.depth, gamma == BIS_GAMMA_FILE ? job.gamma : gamma, in);
    if (status) goto done;
    if (read_rows(&job)) convert(image, &job, table);
    else status = refuse(&job);
    if (!status && !read_end(&job)) {
        if (job.failure.out_of_memory) status = refuse(&job);
        else bis_image_remark(in, "all of its pixels are there, but not its end: %s", job.failure.reason);
    }
done:
    if (status) bis_image_clear(image);
    png_destroy_read_struct(&job.png, &job.info, NULL);
    bis_free(job.rows);
    bis_free(table);
    return status;
}
