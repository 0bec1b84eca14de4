/* SPDX-License-Identifier: BSD-2-Clause */
/* image_exr: read OpenEXR through OpenEXRCore's C interface.
 *
 * Which channels: image_exr_choice.c. Which pixels: those of the data window; image_place.c makes the picture of them.
 * Of tiled files the finest level is read; half, float and uint become float.
 *
 * Bad files: Core checks the header against the file's size; we check, before we allocate, that the window's sides are
 * sane, that the table of chunks fits into the file, and that the file is not shorter than its compression could ever
 * make it (best_ratio). The same ratio bounds every chunk before Core allocates what the chunk's header promises.
 * What Core cannot decode, image_exr_rgba.c does.
 * Source: the documentation of OpenEXRCore 3.1 and "OpenEXR File Layout", both of the OpenEXR project. */
#include "image_io.h"

#include "bis/base/mem.h"
#include "image_exr_choice.h"
#include "image_exr_core.h"
#include "primaries.h"

#include <limits.h>
#include <string.h>

/* What hangs on the context as its user data. */
typedef struct exr_input {
    const image_input *in;
    char reason[200];   /* Core's first complaint, which tells the cause; later ones tell what that prevented */
    exr_result_t cause; /* its code */
    long n_failures;    /* of allocations, before */
} exr_input;

bool bis_exr_is_mine(const unsigned char *data, size_t size)
{
    const unsigned char magic[4] = {0x76, 0x2f, 0x31, 0x01};
    return size >= 4 && !memcmp(data, magic, 4);
}

/* ---- the file as a stream ---- */

/* As pread: fewer bytes at the end of the file. */
static int64_t read_bytes(exr_const_context_t context, void *user_data, void *buffer, uint64_t n, uint64_t offset,
                          exr_stream_error_func_ptr_t complain)
{
    const image_input *in = ((const exr_input *)user_data)->in;
    uint64_t left = offset < in->size ? in->size - offset : 0;
    (void)context;
    (void)complain;
    if (n > left) n = left;
    memcpy(buffer, in->data + (in->size - left), n);
    return (int64_t)n;
}

static int64_t size_of_stream(exr_const_context_t context, void *user_data)
{
    (void)context;
    return (int64_t)((const exr_input *)user_data)->in->size;
}

static void keep_first(exr_const_context_t context, exr_result_t code, const char *text)
{
    void *user_data = NULL;
    if (!context || exr_get_user_data(context, &user_data) || !user_data) return;
    exr_input *source = user_data;
    if (source->reason[0]) return;
    snprintf(source->reason, sizeof source->reason, "%s", text);
    source->cause = code;
}

/* Core's own "out of memory" may mean damaged data (PIZ), and a lack of memory may end in any other code, or none. */
static bool lacks_memory(const exr_input *source) { return bis_mem_failures() > source->n_failures; }

static bis_status refuse(const exr_input *source, exr_result_t code)
{
    bis_status status = lacks_memory(source) ? BIS_NOMEM : BIS_INPUT;
    if (code == EXR_ERR_OUT_OF_MEMORY && status == BIS_INPUT) code = EXR_ERR_CORRUPT_CHUNK;
    const char *reason = source->reason[0] ? source->reason : exr_get_default_error_message(code);
    return bis_image_refuse(source->in, status, "%s", reason);
}

/* ---- what else the header says ---- */

/* Does the header name primaries that are not those of Rec. 709? Then *m takes them there. */
static bool has_own_primaries(double m[3][3], exr_const_context_t file, int part, const image_input *in)
{
    const float half_digit = .0005f; /* of the third digit: some programs write no more */
    exr_attr_chromaticities_t c;
    const exr_attribute_t *a;

    if (exr_get_attribute_by_name(file, part, "chromaticities", &a) ||
        exr_attr_get_chromaticities(file, part, "chromaticities", &c))
        return false;
    const float found[8] = {c.red_x, c.red_y, c.green_x, c.green_y, c.blue_x, c.blue_y, c.white_x, c.white_y};
    bool same = true;
    for (int i = 0; i < 8; i++) same &= fabsf(found[i] - bis_rec709[i]) <= half_digit;
    if (same) return false;
    if (bis_primaries_matrix(m, found)) return true;
    bis_image_remark(in, "its chromaticities are no three primaries and a white; the values are taken as they are");
    return false;
}

/* OpenEXR's own layout of a map. */
static bis_exr_layout layout_of(exr_const_context_t file, int part)
{
    exr_envmap_t shape;
    const exr_attribute_t *a;

    if (exr_get_attribute_by_name(file, part, "envmap", &a) || exr_attr_get_envmap(file, part, "envmap", &shape))
        return BIS_EXR_PICTURE;
    return shape == EXR_ENVMAP_CUBE ? BIS_EXR_CUBE : BIS_EXR_LATLONG;
}

/* ---- sizes ---- */

/* The most bytes that one byte of a file can stand for. RLE: 128 from 2. Deflate: 1032 (258 from 2 bits), and PXR24
 * leaves out the fourth byte of a float first. PIZ: a run of 255 halves from 9 bits at least, so 454. B44A: 32 from 3.
 * DWA: an 8 x 8 block of halves leaves two halves, or its alpha runs of 128, and these go through deflate. */
static uint64_t best_ratio(exr_compression_t compression)
{
    switch (compression) {
    case EXR_COMPRESSION_NONE: return 1;
    case EXR_COMPRESSION_RLE: return 64;
    case EXR_COMPRESSION_ZIPS:
    case EXR_COMPRESSION_ZIP: return 1032;
    case EXR_COMPRESSION_PIZ: return 454;
    case EXR_COMPRESSION_PXR24: return 1376;
    case EXR_COMPRESSION_B44:
    case EXR_COMPRESSION_B44A: return 11;
    default: return 64 * 1032;
    }
}

/* At least so many bytes are the channels of a part, uncompressed (rounded down where a channel is subsampled). */
static uint64_t least_bytes(const exr_attr_chlist_t *list, uint64_t width, uint64_t height)
{
    uint64_t sum = 0;
    for (int i = 0; i < list->num_channels; i++) {
        const exr_attr_chlist_entry_t *c = &list->entries[i];
        uint64_t bytes = c->pixel_type == EXR_PIXEL_HALF ? 2 : 4;
        sum += bytes * (width / (uint64_t)c->x_sampling) * (height / (uint64_t)c->y_sampling);
    }
    return sum;
}

static bis_status check_sampling(const exr_choice *c, const image_input *in)
{
    for (int i = 0; i < (c->colour ? 3 : 1) + (c->alpha != NULL); i++) {
        const exr_attr_chlist_entry_t *channel = i == (c->colour ? 3 : 1) ? c->alpha : c->channel[i];
        if (channel->x_sampling != 1 || channel->y_sampling != 1)
            return bis_image_refuse(in, BIS_INPUT, "its channel %s has a sampling of %d x %d, must be 1 x 1",
                                    channel->name.str, channel->x_sampling, channel->y_sampling);
    }
    return BIS_OK;
}

static int32_t int_at(const unsigned char *p)
{
    return (int32_t)((uint32_t)p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24);
}

/* Of a damaged header Core makes up what it did not understand, a data window of 64 x 64 among it, and may not tell. So
 * a window must stand in the file, in some part's header, behind these words of n bytes. */
static bool says_window(const image_input *in, const exr_attr_box2i_t *w, const char *words, size_t n)
{
    const unsigned char *p = in->data, *end = in->data + in->size;

    while ((p = memmem(p, (size_t)(end - p), words, n)) != NULL) {
        p += n;
        if (end - p < 16) return false;
        if (int_at(p) == w->min.x && int_at(p + 4) == w->min.y && int_at(p + 8) == w->max.x &&
            int_at(p + 12) == w->max.y)
            return true;
    }
    return false;
}

/* Stores both windows. Errors: BIS_INPUT. */
static bis_status find_windows(exr_choice *c, exr_const_context_t file, const exr_input *source)
{
    static const char data[] = "dataWindow\0box2i\0\x10\0\0", display[] = "displayWindow\0box2i\0\x10\0\0";
    const image_input *in = source->in; /* of the words, the last zero is the string's own */
    exr_attr_box2i_t shown = {0};
    exr_result_t code = exr_get_data_window(file, c->part, &c->window);
    if (!code) code = exr_get_display_window(file, c->part, &shown);
    if (code) return refuse(source, code);
    if (!says_window(in, &c->window, data, sizeof data) || !says_window(in, &shown, display, sizeof display))
        return bis_image_refuse(in, BIS_INPUT, "its header is damaged");
    const long long width = (long long)shown.max.x - shown.min.x + 1, height = (long long)shown.max.y - shown.min.y + 1;
    const long long x0 = (long long)c->window.min.x - shown.min.x, y0 = (long long)c->window.min.y - shown.min.y;
    if (width < 1 || height < 1 || width > BIS_IMAGE_MAX_SIDE || height > BIS_IMAGE_MAX_SIDE)
        return bis_image_refuse(in, BIS_INPUT, "its display window has %lld x %lld pixels, a side must be 1 to %d",
                                width, height, BIS_IMAGE_MAX_SIDE);
    if (x0 != (int)x0 || y0 != (int)y0 || x0 < -INT_MAX / 2 || y0 < -INT_MAX / 2)
        return bis_image_refuse(in, BIS_INPUT, "its data window lies outside of its display window");
    *in->place = (bis_image_place){(int)x0, (int)y0, (int)width, (int)height, shown.min.x, shown.min.y};
    return BIS_OK;
}

/* Everything that must hold before pixels are allocated; then they are. */
static bis_status make_image(bis_image *image, exr_choice *c, exr_const_context_t file, const exr_input *source)
{
    const exr_attr_chlist_t *list = NULL;
    int32_t n_chunks = 0;
    exr_result_t code = exr_get_channels(file, c->part, &list);
    if (!code) code = exr_get_compression(file, c->part, &c->compression);
    if (!code) code = exr_get_chunk_count(file, c->part, &n_chunks);
    if (code) return refuse(source, code);
    bis_status status = find_windows(c, file, source);
    if (!status) status = check_sampling(c, source->in);
    if (status) return status;

    long long width = (long long)c->window.max.x - c->window.min.x + 1;
    long long height = (long long)c->window.max.y - c->window.min.y + 1;
    /* _make complains */
    bool sane = width >= 1 && height >= 1 && width <= BIS_IMAGE_MAX_SIDE && height <= BIS_IMAGE_MAX_SIDE;
    size_t size = source->in->size;
    if (sane && (n_chunks < 1 || (uint64_t)n_chunks > size / 8))
        return bis_image_refuse(source->in, BIS_INPUT,
                                "its %d chunks need a table of 8 bytes each, but the file has %zu bytes", n_chunks,
                                size);
    if (sane && least_bytes(list, (uint64_t)width, (uint64_t)height) / best_ratio(c->compression) > size)
        return bis_image_refuse(source->in, BIS_INPUT,
                                "%lld x %lld pixels cannot be in %zu bytes (the file is cut off or damaged)",
                                width, height, size);
    status = bis_image_make(image, source->in, width, height);
    return status || !c->alpha ? status : bis_image_add_alpha(image, source->in->diag);
}

/* ---- pixels ---- */

/* A walk over the chunks of a part. */
typedef struct exr_walk {
    exr_const_context_t file;
    const exr_choice *choice;
    bis_image *image;
    exr_decode_pipeline_t pipe;
    exr_result_t (*decompress)(exr_decode_pipeline_t *pipe); /* Core's */
    bool begun;
    float *unwanted; /* where a chunk's unwanted channels go, if anywhere */
} exr_walk;

/* Where the channel's pixel (x, y) goes, and its stride in floats; NULL: it is not wanted. Luminance goes to r. */
static float *place_of(int *stride, const exr_walk *w, const char *name, int x, int y)
{
    const size_t at = (size_t)y * (size_t)w->image->width + (size_t)x;
    rgb *pixel = w->image->pixels + at;
    float *const parts[3] = {&pixel->r, &pixel->g, &pixel->b};
    *stride = 3;
    for (int i = 0; i < (w->choice->colour ? 3 : 1); i++)
        if (!strcmp(name, w->choice->channel[i]->name.str)) return parts[i];
    *stride = 1;
    return w->choice->alpha && !strcmp(name, w->choice->alpha->name.str) ? w->image->alpha + at : NULL;
}

/* A chunk that compression does not shorten is stored as it is. Core 3.1.5 decodes it all the same if it is one of B44,
 * and makes other pixels of it. */
static exr_result_t decompress(exr_decode_pipeline_t *pipe)
{
    const exr_walk *w = pipe->decoding_user_data;
    if (pipe->chunk.packed_size != pipe->chunk.unpacked_size) return w->decompress(pipe);
    if (pipe->unpacked_buffer != pipe->packed_buffer)
        memcpy(pipe->unpacked_buffer, pipe->packed_buffer, pipe->chunk.packed_size);
    return EXR_ERR_SUCCESS;
}

/* Core 3.1.5 has shortcuts for 3 and 4 channels (half to float, say) that write all of them, also those without a place
 * to go, which ends at address 0. So such a part's unwanted channels get a place. The first chunk is the largest. */
static exr_result_t make_unwanted(exr_walk *w, const exr_chunk_info_t *chunk)
{
    int n_wanted = 0, stride;
    for (int i = 0; i < w->pipe.channel_count; i++)
        n_wanted += place_of(&stride, w, w->pipe.channels[i].channel_name, 0, 0) != NULL;
    if (w->unwanted || w->pipe.channel_count > 4 || n_wanted == w->pipe.channel_count) return EXR_ERR_SUCCESS;
    w->unwanted = bis_alloc((size_t)chunk->width * (size_t)chunk->height, sizeof *w->unwanted);
    return w->unwanted ? EXR_ERR_SUCCESS : EXR_ERR_OUT_OF_MEMORY;
}

/* Decode a chunk whose first pixel is (x, y) of the image. */
static exr_result_t decode_chunk(exr_walk *w, const exr_chunk_info_t *chunk, int x, int y)
{
    const bis_image *image = w->image;
    const int part = w->choice->part;
    exr_decode_pipeline_t *pipe = &w->pipe;

    if (chunk->width > image->width - x || chunk->height > image->height - y ||
        chunk->unpacked_size / best_ratio(w->choice->compression) > chunk->packed_size)
        return EXR_ERR_CORRUPT_CHUNK;
    exr_result_t code = w->begun ? exr_decoding_update(w->file, part, chunk, pipe)
                                 : exr_decoding_initialize(w->file, part, chunk, pipe);
    if (!code) code = make_unwanted(w, chunk);
    if (code) return code;
    for (int i = 0; i < pipe->channel_count; i++) { /* anew for every chunk: _update resets them */
        exr_coding_channel_info_t *c = &pipe->channels[i];
        int stride;
        float *to = place_of(&stride, w, c->channel_name, x, y);
        c->user_data_type = EXR_PIXEL_FLOAT;
        c->user_bytes_per_element = sizeof(float);
        c->user_pixel_stride = (int32_t)sizeof(float) * stride;
        c->user_line_stride = c->user_pixel_stride * (to ? image->width : chunk->width);
        c->decode_to_ptr = (uint8_t *)(to ? to : w->unwanted);
    }
    if (!w->begun) {
        code = exr_decoding_choose_default_routines(w->file, part, pipe);
        w->decompress = pipe->decompress_fn;
        pipe->decoding_user_data = w;
        if (w->decompress) pipe->decompress_fn = decompress;
    }
    w->begun = true;
    return code ? code : exr_decoding_run(w->file, part, pipe);
}

static exr_result_t decode_scanlines(exr_walk *w)
{
    int32_t step = 0;
    exr_result_t code = exr_get_scanlines_per_chunk(w->file, w->choice->part, &step);
    for (int y = 0; y < w->image->height && !code; y += step) {
        exr_chunk_info_t chunk;
        code = exr_read_scanline_chunk_info(w->file, w->choice->part, w->choice->window.min.y + y, &chunk);
        if (!code) code = decode_chunk(w, &chunk, 0, y);
    }
    return code;
}

/* The finest level of a tiled part. */
static exr_result_t decode_tiles(exr_walk *w)
{
    int32_t width = 0, height = 0;
    exr_result_t code = exr_get_tile_sizes(w->file, w->choice->part, 0, 0, &width, &height);
    if (!code && (width < 1 || height < 1)) code = EXR_ERR_FILE_BAD_HEADER;
    if (code) return code;
    const int n_x = (w->image->width - 1) / width + 1, n_y = (w->image->height - 1) / height + 1;
    for (int i = 0; i < n_x * n_y && !code; i++) {
        exr_chunk_info_t chunk;
        code = exr_read_tile_chunk_info(w->file, w->choice->part, i % n_x, i / n_x, 0, 0, &chunk);
        if (!code) code = decode_chunk(w, &chunk, i % n_x * width, i / n_x * height);
    }
    return code;
}

static exr_result_t decode(bis_image *image, const exr_choice *c, exr_const_context_t file)
{
    exr_walk w = {.file = file, .choice = c, .image = image, .pipe = EXR_DECODE_PIPELINE_INITIALIZER};
    exr_storage_t storage;
    exr_result_t code = exr_get_storage(file, c->part, &storage);
    if (!code) code = storage == EXR_STORAGE_TILED ? decode_tiles(&w) : decode_scanlines(&w);
    exr_decoding_destroy(file, &w.pipe); /* fine on one that was never begun */
    bis_free(w.unwanted);
    return code;
}

static void spread_luminance(bis_image *image)
{
    size_t n = (size_t)image->width * (size_t)image->height;
    for (size_t i = 0; i < n; i++) image->pixels[i].g = image->pixels[i].b = image->pixels[i].r;
}

static bis_status read_pixels(bis_image *image, const exr_choice *c, exr_const_context_t file, const exr_input *source)
{
    exr_result_t code = c->chroma ? EXR_ERR_FEATURE_NOT_IMPLEMENTED : decode(image, c, file);
    if (code == EXR_ERR_FEATURE_NOT_IMPLEMENTED) {
        if (c->is_plain)
            return bis_exr_read_rgba(image, source->in, c->window.min.x, c->window.min.y);
        return bis_image_refuse(source->in, BIS_INPUT,
                                "%s is only read at the top of a file's first part; save it with ZIP "
                                "compression as R, G, B",
                                c->chroma ? "luminance with chroma" : "DWA compression");
    }
    if (code) return refuse(source, code);
    if (!c->colour) spread_luminance(image);
    return BIS_OK;
}

/* What newer versions of OpenEXR write: Core refuses a whole file by the number, or lets one pass and fails later.
 * Source: the enumerations of OpenEXR 3.4 and 3.5. */
static bis_status check_compression(const image_input *in)
{
    enum { FIRST = 10 };
    static const char words[] = "compression\0compression\0\1\0\0"; /* the last zero is the string's own */
    static const char *const later[] = {"HTJ2K, of OpenEXR 3.4", "HTJ2K, of OpenEXR 3.4", "LJ2K, of OpenEXR 3.5",
                                        "ZSTD, of OpenEXR 3.5"};
    const unsigned char *p = in->data, *end = in->data + in->size;

    while ((p = memmem(p, (size_t)(end - p), words, sizeof words)) != NULL) {
        p += sizeof words;
        if (p == end || *p < EXR_COMPRESSION_LAST_TYPE) continue;
        const size_t k = (size_t)*p - FIRST;
        return bis_image_refuse(in, BIS_INPUT, "its compression has the number %d (%s), which this bis does not read; "
                                "save it with ZIP compression, as `exrmetrics` of that version does, or Blender", *p,
                                k < sizeof later / sizeof *later ? later[k] : "of a newer OpenEXR");
    }
    return BIS_OK;
}

bis_status bis_exr_read(bis_image *image, const image_input *in)
{
    exr_input source = {.in = in, .n_failures = bis_mem_failures()};
    exr_context_t file = NULL;
    exr_choice choice = {0};
    exr_context_initializer_t init = bis_exr_context(&source);
    init.error_handler_fn = keep_first;
    init.read_fn = read_bytes;
    init.size_fn = size_of_stream;
    init.max_tile_width = init.max_tile_height = BIS_IMAGE_MAX_SIDE;

    bis_status status = check_compression(in);
    if (status) return status;
    exr_result_t code = exr_start_read(&file, in->path, &init);
    /* Core goes on after either, without the rest of the header. */
    if (!code && lacks_memory(&source)) code = EXR_ERR_OUT_OF_MEMORY;
    if (!code && source.cause == EXR_ERR_ATTR_SIZE_MISMATCH) code = source.cause;
    status = code ? refuse(&source, code) : bis_exr_choose(&choice, file, in);
    if (!status) status = make_image(image, &choice, file, &source);
    if (!status) *in->layout = layout_of(file, choice.part);
    if (!status) status = read_pixels(image, &choice, file, &source);
    double m[3][3];
    if (!status && (choice.colour || choice.chroma) && has_own_primaries(m, file, choice.part, in))
        bis_primaries_convert(image, m, in);
    exr_finish(&file);
    if (status) bis_image_clear(image);
    return status;
}
