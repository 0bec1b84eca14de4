/* SPDX-License-Identifier: BSD-2-Clause */
/* image_exr_write: write OpenEXR through OpenEXRCore's C interface: float32, ZIP, scanlines from the top, any channels,
 * text and numbers as attributes.
 *
 * Core writes through our function to the stream of a temporary file, which image.c renames at the end: its own way of
 * writing would destroy an older file on failure. It is that function, not Core, which keeps the disk's reason for the
 * message.
 * Threads compress chunks at the same time, and write them one after the other from the top: the file is the same for
 * any number of threads.
 * The table of chunks is written by exr_finish, so that its result counts as well.
 * A chunk that ZIP makes exactly as long as it was must be stored as it was, since that is how readers take it; Core
 * up to 3.4.7 stores ZIP's (OpenEXR issue 2306), and a noisy picture loses 16 rows now and then. So we look at what it
 * made.
 * ZIP at level 4 instead of zlib's 6: half the time, files 2 to 4% longer (three maps of 1 Mpixel, 0.15 s against 0.3
 * s). */
#include "image_io.h"

#include "image_exr_core.h"

#include <errno.h>
#include <string.h>
#include <unistd.h>

typedef struct exr_output {
    int fd;
    int disk_error; /* errno of the first write that failed, or 0 */
} exr_output;

static int64_t write_bytes(exr_const_context_t context, void *user_data, const void *buffer, uint64_t n,
                           uint64_t offset, exr_stream_error_func_ptr_t complain)
{
    exr_output *out = user_data;
    (void)context; /* OpenEXR waits for ever if this callback calls `complain`: see image_exr_core.c */
    (void)complain;
    for (uint64_t done = 0; done < n;) {
        ssize_t wrote = pwrite(out->fd, (const char *)buffer + done, n - done, (off_t)(offset + done));
        if (wrote > 0) {
            done += (uint64_t)wrote;
        } else if (wrote == 0 || errno != EINTR) {
            if (!out->disk_error) out->disk_error = wrote == 0 ? ENOSPC : errno;
            return -1;
        }
    }
    return (int64_t)n;
}

static exr_result_t set_windows(exr_context_t file, const bis_picture *p)
{
    const exr_attr_box2i_t display = {.max = {.x = p->full_width - 1, .y = p->full_height - 1}};
    const exr_attr_box2i_t data = {.min = {.x = p->x0, .y = p->y0},
                                   .max = {.x = p->x0 + p->width - 1, .y = p->y0 + p->height - 1}};
    const exr_attr_v2f_t centre = {.x = 0, .y = 0};
    return exr_initialize_required_attr(file, 0, &display, &data, 1, &centre, 1, EXR_LINEORDER_INCREASING_Y,
                                        EXR_COMPRESSION_ZIP);
}

/* Names that have a meaning and a type of their own in a header; Core would write ours, and no reader would show it.
 * (Those of the required attributes Core refuses by itself.) */
static bool is_reserved(const char *name)
{
    const char *const reserved[] = {"name", "type", "version", "chunkCount", "tiles", "maxSamplesPerPixel"};
    for (size_t i = 0; i < sizeof reserved / sizeof reserved[0]; i++)
        if (!strcmp(name, reserved[i])) return true;
    return false;
}

static exr_result_t describe(exr_context_t file, const bis_picture *p)
{
    int part;
    exr_result_t code = exr_add_part(file, "bis", EXR_STORAGE_SCANLINE, &part);
    if (!code) code = exr_set_longname_support(file, 1); /* names of up to 255 bytes instead of 31 */
    if (!code) code = set_windows(file, p);
    for (int i = 0; i < p->n_channels && !code; i++)
        code = exr_add_channel(file, part, p->channels[i].name, EXR_PIXEL_FLOAT, EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1);
    for (int i = 0; i < p->n_attributes && !code; i++) {
        const bis_attribute *a = &p->attributes[i];
        code = a->text ? exr_attr_set_string(file, part, a->name, a->text)
                       : exr_attr_set_double(file, part, a->name, a->number);
    }
    return code ? code : exr_write_header(file);
}

static const bis_channel *find_channel(const bis_picture *p, const char *name)
{
    for (int i = 0; i < p->n_channels; i++)
        if (!strcmp(p->channels[i].name, name)) return &p->channels[i];
    return NULL;
}

/* Called when a chunk is compressed and not yet written. */
static exr_result_t mend_size(exr_encode_pipeline_t *pipe)
{
    if (pipe->compressed_bytes == pipe->packed_bytes)
        memcpy(pipe->compressed_buffer, pipe->packed_buffer, pipe->packed_bytes);
    return EXR_ERR_SUCCESS;
}

/* Compresses the chunk that begins with row y; the first one of a pipe also chooses how. */
static exr_result_t compress_chunk(exr_context_t file, exr_encode_pipeline_t *pipe, const bis_picture *p, int y)
{
    const bool is_first = !pipe->context;
    exr_chunk_info_t chunk;
    exr_result_t code = exr_write_scanline_chunk_info(file, 0, p->y0 + y, &chunk);
    if (code) return code;
    code = is_first ? exr_encoding_initialize(file, 0, &chunk, pipe) : exr_encoding_update(file, 0, &chunk, pipe);
    if (code) return code;
    for (int i = 0; i < pipe->channel_count; i++) { /* sorted by name */
        exr_coding_channel_info_t *c = &pipe->channels[i];
        const bis_channel *from = find_channel(p, c->channel_name);
        c->user_data_type = EXR_PIXEL_FLOAT;
        c->user_bytes_per_element = sizeof(float);
        c->user_pixel_stride = (int32_t)sizeof(float) * from->stride;
        c->user_line_stride = c->user_pixel_stride * p->width;
        c->encode_from_ptr = (const uint8_t *)(from->data + (size_t)y * (size_t)p->width * (size_t)from->stride);
    }
    if (is_first) code = exr_encoding_choose_default_routines(file, 0, pipe);
    pipe->yield_until_ready_fn = mend_size;
    pipe->write_fn = NULL; /* write_chunk does it, when it is its turn */
    return code ? code : exr_encoding_run(file, 0, pipe);
}

static exr_result_t write_chunk(exr_context_t file, const exr_encode_pipeline_t *pipe)
{
    return exr_write_scanline_chunk(file, 0, pipe->chunk.start_y, pipe->compressed_buffer, pipe->compressed_bytes);
}

/* Each thread has a pipe, and a chunk in it, which waits until those above are written. After the first failure, whose
 * code is returned, chunks are neither compressed nor written. */
static exr_result_t encode(exr_context_t file, const bis_picture *p)
{
    int32_t step = 0;
    exr_result_t result = exr_get_scanlines_per_chunk(file, 0, &step);

    if (result) return result;
#pragma omp parallel
    {
        exr_encode_pipeline_t pipe = EXR_ENCODE_PIPELINE_INITIALIZER;
#pragma omp for ordered schedule(dynamic)
        for (int y = 0; y < p->height; y += step) {
            exr_result_t code;
#pragma omp atomic read
            code = result;
            if (!code) code = compress_chunk(file, &pipe, p, y);
#pragma omp ordered
            if (!result) {
                if (!code) code = write_chunk(file, &pipe);
#pragma omp atomic write
                result = code;
            }
        }
        exr_encoding_destroy(file, &pipe);
    }
    return result;
}

bis_status bis_exr_write(FILE *stream, const bis_picture *picture, const char *path, bis_diag *diag)
{
    const bis_loc at = {path, 0, 0};
    exr_output out = {.fd = fileno(stream)};
    exr_context_t file = NULL;
    for (int i = 0; i < picture->n_attributes; i++)
        if (is_reserved(picture->attributes[i].name))
            return bis_error(diag, BIS_INPUT, at,
                             "cannot write \"%s\": OpenEXR reserves the attribute \"%s\"; a prefix makes it "
                             "ours (\"bis:%s\")",
                             path, picture->attributes[i].name, picture->attributes[i].name);
    exr_context_initializer_t init = bis_exr_context(&out);
    init.write_fn = write_bytes;
    init.zip_level = 4;

    exr_result_t code = exr_start_write(&file, path, EXR_WRITE_FILE_DIRECTLY, &init);
    if (!code) code = describe(file, picture);
    if (!code) code = encode(file, picture);
    exr_result_t finished = exr_finish(&file);
    if (!code) code = finished;
    if (!code && !out.disk_error) return BIS_OK;

    const char *reason = out.disk_error ? strerror(out.disk_error) : exr_get_default_error_message(code);
    bis_status status = out.disk_error ? BIS_IO : code == EXR_ERR_OUT_OF_MEMORY ? BIS_NOMEM : BIS_INPUT;
    return bis_error(diag, status, at, "cannot write \"%s\": %s", path, reason);
}
