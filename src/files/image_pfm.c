/* SPDX-License-Identifier: BSD-2-Clause */
/* image_pfm: portable float maps: a line "PF" (colour), "Pf" (grey) or "PF4" (colour and alpha, which is dropped), one
 * with width and height, one with the scale, then the rows from the bottom up as raw floats.
 *
 * The scale's sign tells the byte order (negative: the low byte first); its size means "units" to some programs and
 * nothing to most, so that it is ignored. Exactly one white space ends the header, or CR LF where
 * the file is so much longer: text mode of Windows writes that. What follows must be at least as long as width and
 * height promise: that is held against the file's size before anything is allocated. We write colour, low byte first.
 * Source: P. Debevec's description of the format for HDR Shop; PF4: G. Larson and others, ImageMagick. */
#include "image_io.h"

#include "bis/base/file.h"
#include "bis/base/mem.h"

#include <string.h>

typedef struct pfm_header {
    int width, height, channels;
    bool low_byte_first;
    size_t data; /* where the rows begin */
} pfm_header;

static bool is_space(unsigned char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

bool bis_pfm_is_mine(const unsigned char *data, size_t size)
{
    return size >= 3 && data[0] == 'P' && (data[1] == 'F' || data[1] == 'f') &&
           (is_space(data[2]) || (size > 3 && data[1] == 'F' && data[2] == '4' && is_space(data[3])));
}

/* The next word of the header: digits of a size. 0 when there are none, -1 when it is far too large or no number. */
static int parse_side(const unsigned char **p)
{
    int side = 0;
    while (is_space(**p)) ++*p;
    for (; **p >= '0' && **p <= '9'; ++*p) {
        if (side > BIS_IMAGE_MAX_SIDE) return -1;
        side = 10 * side + (**p - '0');
    }
    return is_space(**p) ? side : -1;
}

static bis_status parse_header(pfm_header *h, const image_input *in)
{
    const unsigned char *p = in->data + 2; /* the zero behind the data stops every loop */
    h->channels = in->data[1] == 'f' ? 1 : *p == '4' ? 4 : 3;
    if (h->channels == 4) p++;
    h->width = parse_side(&p);
    h->height = parse_side(&p);
    if (h->width < 1 || h->height < 1 || h->width > BIS_IMAGE_MAX_SIDE || h->height > BIS_IMAGE_MAX_SIDE)
        return bis_image_refuse(in, BIS_INPUT, "the PFM header must give width and height, each 1 to %d",
                                BIS_IMAGE_MAX_SIDE);

    while (is_space(*p)) p++;
    const char *end;
    double scale = bis_parse_double((const char *)p, &end);
    if (end == (const char *)p || !isfinite(scale) || scale == 0 || !is_space((unsigned char)*end))
        return bis_image_refuse(in, BIS_INPUT,
                                "the PFM header's scale must be a number other than 0 and one white space "
                                "(its sign is the byte order: -1 for the low byte first)");
    h->low_byte_first = scale < 0;
    h->data = (size_t)(end + 1 - (const char *)in->data);
    /* one white space, or the LF would be the first byte of a value */
    const size_t promised = 4 * (size_t)h->channels * (size_t)h->width * (size_t)h->height;
    if (end[0] == '\r' && end[1] == '\n' && in->size > h->data + promised) h->data++;
    return BIS_OK;
}

static float load_float(const unsigned char *p, bool low_byte_first)
{
    uint32_t bits = 0;
    float v;
    for (int i = 0; i < 4; i++) bits |= (uint32_t)p[i] << 8 * (low_byte_first ? i : 3 - i);
    memcpy(&v, &bits, sizeof v);
    return v;
}

static void read_row(rgb *row, const unsigned char *p, const pfm_header *h)
{
    for (int x = 0; x < h->width; x++, p += 4 * h->channels) {
        float r = load_float(p, h->low_byte_first);
        bool grey = h->channels == 1;
        row[x] =
            (rgb){r, grey ? r : load_float(p + 4, h->low_byte_first), grey ? r : load_float(p + 8, h->low_byte_first)};
    }
}

bis_status bis_pfm_read(bis_image *image, const image_input *in)
{
    pfm_header h = {0};
    bis_status status = parse_header(&h, in);
    if (status) return status;

    size_t row = 4 * (size_t)h.channels * (size_t)h.width;
    size_t promised = row * (size_t)h.height, found = in->size - h.data; /* at most 16 * 2^30: fits */
    if (found < promised)
        return bis_image_refuse(in, BIS_INPUT,
                                "%d x %d pixels of %d bytes are %zu bytes, but %zu follow the header (which "
                                "ends at byte %zu)",
                                h.width, h.height, 4 * h.channels, promised, found, h.data);
    status = bis_image_make(image, in, h.width, h.height);
    if (status) return status;
    if (found > promised) bis_image_remark(in, "%zu bytes behind the last row are ignored", found - promised);
    for (int y = 0; y < h.height; y++)
        read_row(image->pixels + (size_t)y * (size_t)h.width, in->data + h.data + row * (size_t)(h.height - 1 - y), &h);
    return BIS_OK;
}

static unsigned char *store_float(unsigned char *p, float v)
{
    uint32_t bits;
    memcpy(&bits, &v, sizeof bits);
    for (int i = 0; i < 4; i++) *p++ = (unsigned char)(bits >> 8 * i);
    return p;
}

bis_status bis_pfm_write(FILE *stream, const bis_picture *picture, const char *path, bis_diag *diag)
{
    const bis_channel *c = picture->channels;
    size_t width = (size_t)picture->width;
    unsigned char *row = bis_alloc(width, 12);
    if (!row) return bis_error(diag, BIS_NOMEM, (bis_loc){path, 0, 0}, "no memory to write \"%s\"", path);

    fprintf(stream, "PF\n%d %d\n-1.0\n", picture->width, picture->height);
    for (int y = picture->height - 1; y >= 0; y--) {
        unsigned char *p = row;
        for (size_t i = (size_t)y * width; i < ((size_t)y + 1) * width; i++)
            for (int k = 0; k < 3; k++) p = store_float(p, c[k].data[i * (size_t)c[k].stride]);
        fwrite(row, 12, width, stream);
    }
    bis_free(row);
    return BIS_OK;
}
