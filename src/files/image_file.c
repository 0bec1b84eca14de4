/* SPDX-License-Identifier: BSD-2-Clause */
/* image_file: which format, and the rules that hold for all of them.
 *
 * Reading goes by a file's first bytes, because names lie; writing by the name's ending, because there is nothing else.
 * A file is read whole and parsed from memory; whatever is written goes to a temporary file that is renamed at the end,
 * so that a failure leaves an older file as it was. A format is a row of a table below and a pair of functions in its
 * own file; a value that a format cannot hold is found before the temporary file is made. */
#include "bis/files/image_file.h"

#include "bis/base/file.h"
#include "bis/base/mem.h"
#include "gzip.h"
#include "image_io.h"
#include "image_png.h"

#include <assert.h>
#include <string.h>

typedef struct image_reader {
    bool (*is_mine)(const unsigned char *data, size_t size);
    bis_status (*read)(bis_image *image, const image_input *in);
} image_reader;

typedef struct image_writer {
    const char *ending;
    bis_status (*check)(const bis_picture *picture, const char *path, bis_diag *diag); /* NULL: it holds any value */
    bis_status (*write)(FILE *stream, const bis_picture *picture, const char *path, bis_diag *diag);
} image_writer;

static const image_reader readers[] = {
    {bis_hdr_is_mine, bis_hdr_read},
    {bis_exr_is_mine, bis_exr_read},
    {bis_pfm_is_mine, bis_pfm_read},
};

/* Of colours as a screen shows them. */
typedef struct screen_reader {
    bool (*is_mine)(const unsigned char *data, size_t size);
    bis_status (*read)(bis_image *image, const image_input *in, double gamma);
} screen_reader;

static const screen_reader screens[] = {
    {bis_png_is_mine, bis_png_read},
    {bis_jpeg_is_mine, bis_jpeg_read},
    {bis_bmp_is_mine, bis_bmp_read},
    {bis_tga_is_mine, bis_tga_read}, /* the last, because its mark is weak */
};

static const image_writer writers[] = {
    {".exr", NULL, bis_exr_write},
    {".pfm", NULL, bis_pfm_write},
    {".hdr", bis_hdr_check, bis_hdr_write},
    {".png", NULL, bis_png_write},
};

#define LENGTH(array) (sizeof(array) / sizeof(array)[0])

static const image_reader *find_reader(const unsigned char *data, size_t size)
{
    for (size_t i = 0; i < LENGTH(readers); i++)
        if (readers[i].is_mine(data, size)) return &readers[i];
    return NULL;
}

static const screen_reader *find_screen(const unsigned char *data, size_t size)
{
    for (size_t i = 0; i < LENGTH(screens); i++)
        if (screens[i].is_mine(data, size)) return &screens[i];
    return NULL;
}

/* What is made of the pixels of a file: themselves, the picture that they lie in, or a map. */
typedef enum image_use { USE_PIXELS, USE_PICTURE, USE_MAP } image_use;

/* How an image is read, and what becomes known of it. gamma NULL: of radiance. is_any: of either. */
typedef struct image_request {
    image_use use;
    const double *gamma;
    bool is_any, is_screen, wants_alpha;
    bis_image_place place;
    bis_exr_layout layout;
} image_request;

static bis_status read_image(bis_image *image, image_request *r, const char *path, bis_loc at, bis_diag *diag)
{
    unsigned char *data;
    image_input in = {.path = path, .at = at.file ? at : (bis_loc){path, 0, 0}, .diag = diag, .place = &r->place,
                      .layout = &r->layout, .wants_alpha = r->wants_alpha};

    *image = (bis_image){0};
    bis_status status = bis_gzip_read(&data, &in.size, path, at, diag);
    if (status) return status;
    in.data = data;
    const image_reader *reader = find_reader(data, in.size);
    const screen_reader *screen = r->gamma && !reader ? find_screen(data, in.size) : NULL;
    if (reader) status = reader->read(image, &in);
    else if (screen) status = screen->read(image, &in, *r->gamma);
    else status = bis_image_refuse_unknown(&in, r->gamma && !r->is_any);
    r->is_screen = screen != NULL;
    if (!status) status = bis_place_cut(image, &in);
    if (!status && r->use == USE_PICTURE) status = bis_place_fill(image, &in);
    if (!status && r->use == USE_MAP) status = bis_place_map(image, &in);
    if (status) bis_image_clear(image);
    bis_free(data);
    assert(!status == !!image->pixels); /* all of the image or none */
    return status;
}

bis_status bis_image_read(bis_image *image, const char *path, bis_loc at, bis_diag *diag)
{
    image_request r = {.use = USE_PIXELS};
    return read_image(image, &r, path, at, diag);
}

bis_status bis_image_read_map(bis_image *image, bool *is_cube_strip, const char *path, bis_loc at, bis_diag *diag)
{
    image_request r = {.use = USE_MAP};
    const bis_status status = read_image(image, &r, path, at, diag);
    *is_cube_strip = r.layout == BIS_EXR_CUBE;
    return status;
}

bis_status bis_image_read_colours(bis_image *image, const char *path, double gamma, bis_loc at, bis_diag *diag)
{
    image_request r = {.use = USE_PICTURE, .gamma = &gamma};
    return read_image(image, &r, path, at, diag);
}

bis_status bis_image_read_alpha(bis_image *image, const char *path, double gamma, bis_loc at, bis_diag *diag)
{
    image_request r = {.use = USE_PICTURE, .gamma = &gamma, .wants_alpha = true};
    return read_image(image, &r, path, at, diag);
}

/* A PNG or a JPEG, by its first bytes: does it end as such? Of others nothing is known. *size: all of its bytes. */
static enum { UNKNOWN, CUT, WHOLE } look_at_end(const char *path, long *size)
{
    unsigned char head[4] = {0}, tail[8] = {0};
    FILE *f = fopen(path, "rb");
    if (!f) return UNKNOWN;
    const bool read = fread(head, 1, sizeof head, f) == sizeof head && fseek(f, -(long)sizeof tail, SEEK_END) == 0 &&
                      fread(tail, 1, sizeof tail, f) == sizeof tail;
    *size = ftell(f);
    fclose(f);
    if (read && bis_png_is_mine(head, 4)) return memcmp(tail, "IEND", 4) == 0 ? WHOLE : CUT;
    if (read && bis_jpeg_is_mine(head, 4) && bis_image_reads_jpeg())
        return memcmp(tail + 6, "\xff\xd9", 2) == 0 ? WHOLE : CUT;
    return UNKNOWN;
}

bool bis_image_looks_cut(const char *path)
{
    long size;
    return look_at_end(path, &size) == CUT;
}

/* A picture of so many bytes is read within some hundredths of a second. */
enum { READ_AT_ONCE = 1 << 18 };

bool bis_image_check_colours(const char *path, bis_loc at, bis_diag *diag)
{
    bis_diag why = {0};
    bis_image image;
    long size = 0;

    if (look_at_end(path, &size) == WHOLE && size > READ_AT_ONCE) return true;
    const bis_status status = bis_image_read_colours(&image, path, BIS_GAMMA_SRGB, at, &why);
    bis_image_clear(&image);
    for (size_t i = 0; i < why.n && status == BIS_INPUT; i++) bis_warn(diag, at, "%s", why.messages[i].body);
    bis_diag_clear(&why);
    return status != BIS_INPUT;
}

bis_status bis_image_check_head(const char *path, bool of_colours, bis_loc at, bis_diag *diag)
{
    const double gamma = BIS_GAMMA_SRGB;
    image_request r = {.use = of_colours ? USE_PICTURE : USE_MAP, .gamma = of_colours ? &gamma : NULL};
    unsigned char head[64] = {0};
    bis_image image;
    const size_t n = bis_gzip_head((char *)head, sizeof head, path);

    if (find_reader(head, n) || (of_colours && find_screen(head, n))) return BIS_OK;
    /* it says why not */
    const bis_status status = read_image(&image, &r, path, at, diag);
    bis_image_clear(&image);
    return status;
}

bis_status bis_image_read_any(bis_image *image, bool *is_screen, const char *path, bis_loc at, bis_diag *diag)
{
    const double gamma = BIS_GAMMA_FILE;
    image_request r = {.use = USE_PICTURE, .gamma = &gamma, .is_any = true, .wants_alpha = true};
    const bis_status status = read_image(image, &r, path, at, diag);
    *is_screen = r.is_screen;
    return status;
}

bis_status bis_image_read_part(bis_image *image, bool *is_screen, bis_image_place *place, const char *path, bis_loc at,
                               bis_diag *diag)
{
    const double gamma = BIS_GAMMA_FILE;
    image_request r = {.use = USE_PIXELS, .gamma = is_screen ? &gamma : NULL, .is_any = true};
    const bis_status status = read_image(image, &r, path, at, diag);
    if (is_screen) *is_screen = r.is_screen;
    *place = r.place;
    return status;
}

static const image_writer *find_writer(const char *path)
{
    char ending[8];
    bis_path_extension(ending, path);
    for (size_t i = 0; i < LENGTH(writers); i++)
        if (!strcmp(ending, writers[i].ending)) return &writers[i];
    return NULL;
}

bool bis_image_can_write(const char *path) { return find_writer(path) != NULL; }

bis_status bis_image_write(const char *path, const bis_picture *picture, bis_diag *diag)
{
    bis_outfile *out;
    const image_writer *writer = find_writer(path);

    assert(picture->width >= 1 && picture->height >= 1 && picture->n_channels >= 3);
    if (!writer)
        return bis_error(diag, BIS_INPUT, (bis_loc){path, 0, 0},
                         "cannot write \"%s\": its ending must be .exr, .pfm, .hdr or .png",
                         path);
    bis_status status = writer->check ? writer->check(picture, path, diag) : BIS_OK;
    if (!status) status = bis_outfile_open(&out, path, diag);
    if (status) return status;
    status = writer->write(bis_outfile_stream(out), picture, path, diag);
    if (!status) return bis_outfile_commit(out, diag);
    bis_outfile_abort(out);
    return status;
}

bis_picture bis_image_picture(const bis_image *image, bis_channel channels[4])
{
    const float *first = &image->pixels->r;

    channels[0] = (bis_channel){"R", first, 3};
    channels[1] = (bis_channel){"G", first + 1, 3};
    channels[2] = (bis_channel){"B", first + 2, 3};
    if (image->alpha) channels[3] = (bis_channel){"A", image->alpha, 1};
    return (bis_picture){
        .width = image->width,
        .height = image->height,
        .full_width = image->width,
        .full_height = image->height,
        .channels = channels,
        .n_channels = image->alpha ? 4 : 3,
    };
}

bis_status bis_image_save(const bis_image *image, const char *path, bis_diag *diag)
{
    bis_channel channels[4];
    const bis_picture picture = bis_image_picture(image, channels);

    return bis_image_write(path, &picture, diag);
}

bis_status bis_image_save_colours(const bis_image *image, const char *path, bis_diag *diag)
{
    bis_channel channels[4];
    bis_picture picture = bis_image_picture(image, channels);

    picture.has_exposure = true;
    return bis_image_write(path, &picture, diag);
}
