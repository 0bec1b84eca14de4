/* SPDX-License-Identifier: BSD-2-Clause */
/* image_hdr: Radiance .hdr pictures (RGBE: three mantissas and one exponent, a byte each).
 *
 * Layout: a line "#?NAME", lines VARIABLE=value, an empty line, the resolution line ("-Y 512 +X 1024": scanlines from
 * the top, each from the left), then the scanlines, each flat, in the old or in the new run-length encoding.
 * value = mantissa * 2^(exponent - 136), black where the exponent is 0, divided by the product of all EXPOSURE
 * lines and, per channel, by that of all COLORCORR lines: both are factors that somebody has multiplied the radiance
 * by. An EXPOSURE that is 0, negative or not finite is no factor and is left out with a warning: FreeImage writes 0
 * where it does not know. FORMAT says whether the channels are R, G, B or X, Y, Z.
 *
 * Why a reader of our own: Radiance's is not packaged as a library, and the usual single-file reader ignores EXPOSURE,
 * the axes of the resolution line and the old encoding, each a silently wrong map.
 * Bad files: nothing is read behind the end of the data (every reader below gets the end); a picture is allocated only
 * if its file is at least as long as the shortest that the format allows (smallest_scanline).
 * Source: G. Ward, "Real Pixels", Graphics Gems II (1991); the file format pages of Radiance. */
#include "image_io.h"

#include "bis/base/file.h"
#include "bis/base/mem.h"
#include "primaries.h"

#include <string.h>

enum {
    MIN_RLE = 8,     /* the new encoding holds scanlines of this length ... */
    MAX_RLE = 32767, /* ... to this one: 15 bits */
    MAX_RUN = 127,
    MIN_RUN = 4, /* shorter runs cost more than they save: they break a literal in two */
    LITERAL = 128 /* a count up to this is a literal's, above it that of a run (count - 128) */
};

/* ---- header ---- */

typedef struct hdr_header {
    double exposure[3]; /* what every channel is to be divided by */
    bool has_format, is_xyz;
    int length, n; /* of a scanline in pixels; how many scanlines */
    bool columns;  /* scanlines are columns: the resolution line begins with X */
    bool flip_x, flip_y;
    size_t data; /* where the scanlines begin */
} hdr_header;

bool bis_hdr_is_mine(const unsigned char *data, size_t size) { return size >= 2 && data[0] == '#' && data[1] == '?'; }

/* n numbers behind the name of a variable, and nothing else in the line. */
static bool parse_numbers(double *v, int n, const char *s, const char *line_end)
{
    for (int i = 0; i < n; i++) {
        const char *end;
        while (*s == ' ' || *s == '\t') s++;
        v[i] = bis_parse_double(s, &end);
        if (end == s) return false;
        s = end;
    }
    while (*s == ' ' || *s == '\t' || *s == '\r') s++;
    return s == line_end;
}

/* EXPOSURE and COLORCORR lines accumulate: every program that scales a picture adds one. */
static bis_status take_factor(hdr_header *h, const char *name, int n, const char *s, const char *line_end,
                              const image_input *in)
{
    double v[3];
    bool good = parse_numbers(v, n, s, line_end);
    if (good && n == 1 && !(v[0] > 0 && isfinite(v[0]))) {
        bis_image_remark(in, "its EXPOSURE is \"%.*s\", which is no factor: 1 is taken (some programs write 0 where "
                         "they do not know it)", (int)(line_end - s < 60 ? line_end - s : 60), s);
        return BIS_OK;
    }
    for (int i = 0; good && i < 3; i++) {
        h->exposure[i] *= v[n == 1 ? 0 : i];
        good = h->exposure[i] > 0 && isfinite(h->exposure[i]);
    }
    if (good) return BIS_OK;
    return bis_image_refuse(in, BIS_INPUT,
                            "%s is \"%.*s\", must be %s above 0, as must be the product of all such lines", name,
                            (int)(line_end - s < 60 ? line_end - s : 60), s, n == 1 ? "a number" : "three numbers");
}

static bis_status take_format(hdr_header *h, const char *s, const char *line_end, const image_input *in)
{
    const char rgbe[] = "32-bit_rle_rgbe", xyze[] = "32-bit_rle_xyze";
    while (s < line_end && (*s == ' ' || *s == '\t')) s++;
    while (s < line_end && (line_end[-1] == '\r' || line_end[-1] == ' ')) line_end--;
    int length = (int)(line_end - s < 60 ? line_end - s : 60);
    h->is_xyz = length == (int)strlen(xyze) && !memcmp(s, xyze, strlen(xyze));
    h->has_format = h->is_xyz || (length == (int)strlen(rgbe) && !memcmp(s, rgbe, strlen(rgbe)));
    if (h->has_format) return BIS_OK;
    return bis_image_refuse(in, BIS_INPUT, "its FORMAT is \"%.*s\", must be %s or %s", length, s, rgbe, xyze);
}

/* Are these the primaries of Radiance or of Rec. 709? They are printed with three or four digits: within half a unit of
 * the third. Some programs write eight zeros, which say nothing. */
static bool are_standard(const double primaries[8])
{
    const double radiance[8] = {.64, .33, .29, .6, .15, .06, 1. / 3, 1. / 3};
    const double rec709[8] = {.64, .33, .3, .6, .15, .06, .3127, .329};
    const double half_digit = .0005;
    bool is_radiance = true, is_rec709 = true, is_empty = true;
    for (int i = 0; i < 8; i++) {
        is_empty &= primaries[i] == 0;
        is_radiance &= fabs(primaries[i] - radiance[i]) <= half_digit;
        is_rec709 &= fabs(primaries[i] - rec709[i]) <= half_digit;
    }
    return is_radiance || is_rec709 || is_empty;
}

/* What follows name in the line, or NULL. Variables begin a line: an indented one is an earlier picture's, kept as
 * history. */
static const char *value_of(const char *name, const char *line)
{
    size_t n = strlen(name);
    return strncmp(line, name, n) ? NULL : line + n;
}

static bis_status take_line(hdr_header *h, const char *line, const char *line_end, const image_input *in)
{
    const char *value;
    double primaries[8];

    if ((value = value_of("FORMAT=", line))) return take_format(h, value, line_end, in);
    if ((value = value_of("EXPOSURE=", line))) return take_factor(h, "EXPOSURE", 1, value, line_end, in);
    if ((value = value_of("COLORCORR=", line))) return take_factor(h, "COLORCORR", 3, value, line_end, in);
    value = value_of("PRIMARIES=", line);
    if (value && !(parse_numbers(primaries, 8, value, line_end) && are_standard(primaries)))
        bis_image_remark(in, "its PRIMARIES are not those of Rec. 709; the values are taken as they are");
    return BIS_OK;
}

/* "-Y" and "+X" and the like, and a number. */
static bool parse_axis(char *axis, bool *negative, int *size, const char **p)
{
    const char *s = *p;
    *negative = *s == '-';
    if (*s != '-' && *s != '+') return false;
    *axis = *++s;
    if (*axis != 'X' && *axis != 'Y') return false;
    if (*++s != ' ') return false;
    while (*s == ' ') s++;
    for (*size = 0; *s >= '0' && *s <= '9' && *size <= BIS_IMAGE_MAX_SIDE; s++)
        *size = 10 * *size + (*s - '0');
    *p = s;
    return *size >= 1 && *size <= BIS_IMAGE_MAX_SIDE;
}

/* All eight orientations. The first axis runs over scanlines, the second within one. Y grows upwards, X to the
 * right. */
static bis_status take_resolution(hdr_header *h, const char *line, const char *line_end, const image_input *in)
{
    const char *s = line;
    char slow = 0, fast = 0;
    bool slow_negative = false, fast_negative = false;
    bool good = parse_axis(&slow, &slow_negative, &h->n, &s) && *s == ' ';
    while (good && *s == ' ') s++;
    good = good && parse_axis(&fast, &fast_negative, &h->length, &s) && slow != fast;
    while (good && (*s == ' ' || *s == '\r')) s++;
    if (!good || s != line_end)
        return bis_image_refuse(in, BIS_INPUT,
                                "its resolution line is \"%.*s\", must be like \"-Y 512 +X 1024\", with sides "
                                "from 1 to %d",
                                (int)(line_end - line < 60 ? line_end - line : 60), line, BIS_IMAGE_MAX_SIDE);
    h->columns = slow == 'X';
    h->flip_x = h->columns ? slow_negative : fast_negative;
    h->flip_y = !(h->columns ? fast_negative : slow_negative); /* our rows run downwards: -Y */
    return BIS_OK;
}

static bool is_blank(const char *line, const char *line_end)
{
    return line == line_end || (line + 1 == line_end && *line == '\r');
}

static bis_status parse_header(hdr_header *h, const image_input *in)
{
    const char *line = (const char *)in->data, *end = line + in->size;
    bool in_variables = true;

    *h = (hdr_header){.exposure = {1, 1, 1}};
    for (;;) {
        const char *line_end = memchr(line, '\n', (size_t)(end - line));
        if (!line_end) return bis_image_refuse(in, BIS_INPUT, "the file ends within the header");
        if (!in_variables) {
            h->data = (size_t)(line_end + 1 - (const char *)in->data);
            return take_resolution(h, line, line_end, in);
        }
        in_variables = !is_blank(line, line_end);
        bis_status status = in_variables ? take_line(h, line, line_end, in) : BIS_OK;
        if (status) return status;
        line = line_end + 1;
    }
}

/* ---- scanlines ---- */

typedef unsigned char rgbe[4];

/* What is wrong with a scanline, or NULL. *p moves on. */
typedef const char *read_fn(rgbe *line, int n, const unsigned char **p, const unsigned char *end);

static const char *const ends = "the file ends within it";

/* Old encoding: a pixel with mantissas 1 1 1 stands for "the pixel before, exponent times"; such pixels in a row are
 * the digits of one number to the base 256, the lowest first. Without runs it is the flat encoding. */
static const char *read_old(rgbe *line, int n, const unsigned char **p, const unsigned char *end)
{
    int shift = 0, i = 0;
    while (i < n) {
        if (end - *p < 4) return ends;
        const unsigned char *pixel = *p;
        *p += 4;
        if (pixel[0] != 1 || pixel[1] != 1 || pixel[2] != 1) {
            memcpy(line[i++], pixel, 4);
            shift = 0;
            continue;
        }
        if (i == 0) return "it begins with a run, which has no pixel to repeat";
        if (shift > 16 || (pixel[3] << shift) > n - i) return "a run leads beyond its end";
        for (int stop = i + (pixel[3] << shift); i < stop; i++) memcpy(line[i], line[i - 1], 4);
        shift += 8;
    }
    return NULL;
}

/* New encoding, the scanline's four planes one after the other: a count c <= 128 and c bytes, or c > 128 and the byte
 * that fills c - 128 places. */
static const char *read_plane(unsigned char *plane, int n, const unsigned char **p, const unsigned char *end)
{
    for (int i = 0; i < n;) {
        if (end - *p < 2) return ends;
        int count = *(*p)++;
        bool run = count > LITERAL;
        if (run) count -= LITERAL;
        if (count == 0) return "it has a run of length 0";
        if (count > n - i) return "a run leads beyond its end";
        if (run) {
            memset(plane + i, *(*p)++, (size_t)count);
        } else {
            if (end - *p < count) return ends;
            memcpy(plane + i, *p, (size_t)count);
            *p += count;
        }
        i += count;
    }
    return NULL;
}

static const char *read_new(unsigned char *planes, int n, const unsigned char **p, const unsigned char *end)
{
    const char *wrong = NULL;
    for (int k = 0; k < 4 && !wrong; k++) wrong = read_plane(planes + k * n, n, p, end);
    return wrong;
}

/* ---- values ---- */

/* scale[e][k]: what a mantissa of channel k with exponent e is worth. Exact where there is no EXPOSURE, otherwise off
 * by an ulp of double before the one rounding to float. */
typedef double scale_table[256][3];

static void make_scales(scale_table scale, const double exposure[3])
{
    for (int e = 0; e < 256; e++)
        for (int k = 0; k < 3; k++) scale[e][k] = e == 0 ? 0 : ldexp(1, e - 136) / exposure[k];
}

/* Where scanline i begins in the picture, and the step to its next pixel. */
static rgb *place_scanline(ptrdiff_t *step, const bis_image *image, const hdr_header *h, int i)
{
    int x = 0, y = 0;
    *(h->columns ? &x : &y) = i;
    if (h->flip_x) x = image->width - 1 - x;
    if (h->flip_y) y = image->height - 1 - y;
    *step = h->columns ? (h->flip_y ? -image->width : image->width) : (h->flip_x ? -1 : 1);
    return image->pixels + (size_t)y * (size_t)image->width + x;
}

/* n pixels whose four bytes stand in planes of n, or one pixel after the other. */
static void convert(rgb *out, ptrdiff_t step, const unsigned char *in, int n, bool in_planes, const scale_table scale)
{
    const ptrdiff_t plane = in_planes ? n : 1, next = in_planes ? 1 : 4;

    for (ptrdiff_t i = 0; i < n; i++) {
        const unsigned char *p = in + i * next;
        const double *s = scale[p[3 * plane]];
        out[i * step] = rgb_from(p[0] * s[0], p[plane] * s[1], p[2 * plane] * s[2]);
    }
}

static bis_status read_scanlines(bis_image *image, unsigned char *buffer, const hdr_header *h, const image_input *in)
{
    const unsigned char *p = in->data + h->data, *end = in->data + in->size;
    const int n = h->length;
    scale_table scale;

    make_scales(scale, h->exposure);
    for (int i = 0; i < h->n; i++) {
        const unsigned char *start = p;
        const char *wrong;
        bool is_new = n >= MIN_RLE && n <= MAX_RLE && end - p >= 4 && p[0] == 2 && p[1] == 2 && p[2] < 128;
        if (!is_new) {
            wrong = read_old((rgbe *)buffer, n, &p, end);
        } else if (p[2] << 8 != (n & 0x7f00) || p[3] != (n & 255)) {
            wrong = "its length is not that of the resolution line";
        } else {
            p += 4;
            wrong = read_new(buffer, n, &p, end);
        }
        if (wrong)
            return bis_image_refuse(in, BIS_INPUT, "scanline %d of %d, at byte %td, is damaged: %s", i + 1, h->n,
                                    start - in->data, wrong);
        ptrdiff_t step;
        rgb *out = place_scanline(&step, image, h, i);
        convert(out, step, buffer, n, is_new, scale);
    }
    if (p < end) bis_image_remark(in, "%td bytes behind the last scanline are ignored", end - p);
    return BIS_OK;
}

/* The fewest bytes that hold a scanline: a pixel and, in the old encoding, runs of up to 255 and of up to 255 * 256. */
static size_t smallest_scanline(int n) { return n == 1 ? 4 : n <= 256 ? 8 : 12; }

bis_status bis_hdr_read(bis_image *image, const image_input *in)
{
    hdr_header h;
    bis_status status = parse_header(&h, in);
    unsigned char *buffer = NULL;

    if (status) goto done;
    double m[3][3];
    if (!h.has_format) bis_image_remark(in, "it has no FORMAT line; 32-bit_rle_rgbe is assumed");
    size_t needed = (size_t)h.n * smallest_scanline(h.length);
    if (in->size - h.data < needed) {
        status = bis_image_refuse(in, BIS_INPUT,
                                  "%d scanlines of %d pixels need %zu bytes or more, but %zu follow the header "
                                  "(the file is cut off)",
                                  h.n, h.length, needed, in->size - h.data);
        goto done;
    }
    status = bis_image_make(image, in, h.columns ? h.n : h.length, h.columns ? h.length : h.n);
    if (status) goto done;
    buffer = bis_alloc((size_t)h.length, sizeof(rgbe));
    if (buffer)
        status = read_scanlines(image, buffer, &h, in);
    else
        status = bis_image_refuse(in, BIS_NOMEM, "no memory for a scanline of %d pixels", h.length);
    if (!status && h.is_xyz && bis_primaries_matrix(m, bis_xyz)) {
        bis_primaries_convert(image, m, in);
        bis_image_remark(in, "its Y is taken as luminance of radiance 1; Radiance's own programs write 179 times as "
                             "much (lumen by watt): \"float scale\" 0.00559 of the light makes up for it");
    }
done:
    bis_free(buffer);
    if (status) bis_image_clear(image);
    return status;
}

/* ---- writing ---- */

/* The nearest mantissa; halves go up. */
static unsigned char mantissa_of(double v, double unit) { return (unsigned char)floor(v / unit + 0.5); }

/* The rgbe nearest to a colour; false where an .hdr cannot hold it. The largest channel gets a mantissa of 128 to 255,
 * so that it is right to 1/256; only below 2^-128 the exponent stays at its smallest, 1, and mantissas get smaller. v /
 * unit is exact: unit is a power of two. */
static bool encode(rgbe out, const double v[3])
{
    double largest = fmax(v[0], fmax(v[1], v[2]));
    int exponent;

    if (!(v[0] >= 0 && v[1] >= 0 && v[2] >= 0 && isfinite(largest))) return false; /* NaN compares false */
    frexp(largest, &exponent);
    exponent = exponent + 128 > 1 ? exponent + 128 : 1;
    if (largest / ldexp(1, exponent - 136) >= 255.5) exponent++; /* it would round up to 256 */
    if (exponent > 255) return false;
    for (int k = 0; k < 3; k++) out[k] = mantissa_of(v[k], ldexp(1, exponent - 136));
    out[3] = out[0] || out[1] || out[2] ? (unsigned char)exponent : 0;
    return true;
}

/* Channels of pixel i. */
static void load_pixel(double v[3], const bis_picture *picture, size_t i)
{
    for (int k = 0; k < 3; k++)
        v[k] = (double)picture->channels[k].data[i * (size_t)picture->channels[k].stride];
}

bis_status bis_hdr_check(const bis_picture *picture, const char *path, bis_diag *diag)
{
    size_t width = (size_t)picture->width, n = width * (size_t)picture->height;
    for (size_t i = 0; i < n; i++) {
        double v[3];
        rgbe pixel;
        load_pixel(v, picture, i);
        if (!encode(pixel, v))
            return bis_error(diag, BIS_INPUT, (bis_loc){path, 0, 0},
                             "cannot write \"%s\": pixel (%zu, %zu) is (%g, %g, %g), but "
                             "an .hdr holds values from 0 to 1.69e38 only (.exr and .pfm hold any)",
                             path, i % width, i / width, v[0], v[1], v[2]);
    }
    return BIS_OK;
}

/* How many bytes from p on are equal, at most limit. */
static int run_length(const unsigned char *p, int limit)
{
    int n = 1;
    while (n < limit && p[n] == p[0]) n++;
    return n;
}

/* A plane in the new encoding: runs of MIN_RUN or more as runs, what lies between as literals. */
static void write_plane(FILE *stream, const unsigned char *plane, int n)
{
    for (int i = 0; i < n;) {
        int literal = 0, run = 0;
        while (literal < LITERAL && i + literal < n && run < MIN_RUN) {
            int rest = n - i - literal;
            run = run_length(plane + i + literal, rest < MAX_RUN ? rest : MAX_RUN);
            if (run < MIN_RUN) literal += literal + run <= LITERAL ? run : 1;
        }
        if (literal) {
            putc(literal, stream);
            fwrite(plane + i, 1, (size_t)literal, stream);
            i += literal;
        }
        if (run >= MIN_RUN) {
            putc(LITERAL + run, stream);
            putc(plane[i], stream);
            i += run;
        }
    }
}

/* Flat, for lengths that the new encoding has no room for. Readers take mantissas 1 1 1 for a run; only a grey of
 * 2^-135 has them, which we write 2^-135 too bright in blue. */
static void write_flat(FILE *stream, const unsigned char *planes, int n)
{
    for (int i = 0; i < n; i++) {
        rgbe pixel = {planes[i], planes[n + i], planes[2 * n + i], planes[3 * n + i]};
        if (pixel[0] == 1 && pixel[1] == 1 && pixel[2] == 1) pixel[2] = 2;
        fwrite(pixel, 1, sizeof pixel, stream);
    }
}

bis_status bis_hdr_write(FILE *stream, const bis_picture *picture, const char *path, bis_diag *diag)
{
    const int n = picture->width;
    unsigned char *planes = bis_alloc((size_t)n, sizeof(rgbe));
    if (!planes) return bis_error(diag, BIS_NOMEM, (bis_loc){path, 0, 0}, "no memory to write \"%s\"", path);

    fprintf(stream, "#?RADIANCE\nSOFTWARE=bis\nFORMAT=32-bit_rle_rgbe\n\n-Y %d +X %d\n", picture->height, n);
    for (int y = 0; y < picture->height; y++) {
        for (int x = 0; x < n; x++) {
            double v[3];
            rgbe pixel = {0};
            load_pixel(v, picture, (size_t)y * (size_t)n + (size_t)x);
            encode(pixel, v);
            for (int k = 0; k < 4; k++) planes[k * n + x] = pixel[k];
        }
        if (n < MIN_RLE || n > MAX_RLE) {
            write_flat(stream, planes, n);
            continue;
        }
        const unsigned char leader[4] = {2, 2, (unsigned char)(n >> 8), (unsigned char)(n & 255)};
        fwrite(leader, 1, sizeof leader, stream);
        for (int k = 0; k < 4; k++) write_plane(stream, planes + k * n, n);
    }
    bis_free(planes);
    return BIS_OK;
}
