/* SPDX-License-Identifier: BSD-2-Clause */
/* page: entities (HTML 4), base64 (RFC 4648), and JSON inside HTML, where no < may stand. */
#include "page.h"

#include "base/text.h"
#include "bis/base/file.h"
#include "bis/base/mem.h"
#include "files/image_png.h"

#include <stdlib.h>
#include <string.h>

/* &, < and > become entities. A byte that no UTF-8 holds and a control character become U+FFFD. */
static void put_text(FILE *out, const char *text)
{
    for (const char *end = text + strlen(text); text < end;) {
        const size_t length = bis_utf8_length(text, end);
        const bool is_control = ((unsigned char)*text < 0x20 && *text != '\n') || *text == 0x7f;
        if (*text == '&') fputs("&amp;", out);
        else if (*text == '<') fputs("&lt;", out);
        else if (*text == '>') fputs("&gt;", out);
        else if (length == 0 || is_control) fputs("\xef\xbf\xbd", out);
        else fwrite(text, 1, length, out);
        text += length ? length : 1;
    }
}

/* In JSON a < stands in strings alone, which may have it as an escape. */
static void put_json(FILE *out, const char *json)
{
    for (; *json; json++) {
        if (*json == '<') fputs("\\u003c", out);
        else fputc(*json, out);
    }
}

/* Prints page up to the end of mark and returns what is behind it; NULL: there is no mark. */
static const char *put_until(FILE *out, const char *page, const char *mark)
{
    const char *at = strstr(page, mark);
    if (!at) return NULL;
    at += strlen(mark);
    fwrite(page, 1, (size_t)(at - page), out);
    return at;
}

bis_status bis_page_write(FILE *out, const char *page, const char *json, const char *text, bis_diag *diag)
{
    const char *rest = put_until(out, page, "<pre id=\"text\">");

    if (rest) put_text(out, text), rest = put_until(out, rest, "<script type=\"application/json\" id=\"data\">");
    if (!rest) return bis_error(diag, BIS_INPUT, (bis_loc){0}, "the page has no place for its data");
    put_json(out, json);
    fputs(rest + strcspn(rest, "<"), out); /* without the null */
    return BIS_OK;
}

static bis_status save(const char *path, const char *page, const char *json, const char *text, bis_diag *diag)
{
    bis_outfile *file;
    bis_status status = bis_outfile_open(&file, path, diag);

    if (status) return status;
    status = bis_page_write(bis_outfile_stream(file), page, json, text, diag);
    if (!status) return bis_outfile_commit(file, diag);
    bis_outfile_abort(file);
    return status;
}

/* The streams are then gone; what they held stays, which is the C library's and not ours. */
static bool close_streams(bis_page *p)
{
    const bool json = p->json && fclose(p->json) == 0, text = p->text && fclose(p->text) == 0;
    p->json = p->text = NULL;
    return json && text;
}

static void free_parts(bis_page *p)
{
    free(p->parts[0]);
    free(p->parts[1]);
}

static bis_status no_memory(const char *what, bis_diag *diag)
{
    return bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for %s", what);
}

bis_status bis_page_begin(bis_page *p, const char *what, bis_diag *diag)
{
    *p = (bis_page){0};
    p->json = open_memstream(&p->parts[0], &p->bytes[0]);
    p->text = open_memstream(&p->parts[1], &p->bytes[1]);
    if (p->json && p->text) return BIS_OK;
    close_streams(p);
    free_parts(p);
    return no_memory(what, diag);
}

bis_status bis_page_end(bis_page *p, bis_status status, const char *path, const char *page, const char *what,
                        bis_diag *diag)
{
    const bool ok = close_streams(p);

    if (!status && !ok) status = no_memory(what, diag);
    if (!status) status = save(path, page, p->parts[0], p->parts[1], diag);
    free_parts(p);
    return status;
}

static void put_base64(FILE *out, const unsigned char *data, size_t n)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t i = 0; i < n; i += 3) {
        const unsigned second = i + 1 < n ? data[i + 1] : 0, third = i + 2 < n ? data[i + 2] : 0;
        const unsigned v = (unsigned)data[i] << 16 | second << 8 | third;
        fputc(digits[v >> 18], out);
        fputc(digits[v >> 12 & 63], out);
        fputc(i + 1 < n ? digits[v >> 6 & 63] : '=', out);
        fputc(i + 2 < n ? digits[v & 63] : '=', out);
    }
}

bis_status bis_page_numbers(bis_json *j, const char *key, const uint32_t *v, size_t n, int size, const char *what,
                            bis_diag *diag)
{
    const size_t width = (size_t)size;
    unsigned char *bytes = bis_alloc(n, width);
    char *text = NULL;
    size_t length = 0;
    FILE *out = bytes ? open_memstream(&text, &length) : NULL;

    for (size_t i = 0; bytes && i < n; i++)
        for (size_t k = 0; k < width; k++) bytes[i * width + k] = (unsigned char)(v[i] >> 8 * (width - 1 - k));
    if (out) put_base64(out, bytes, n * width);
    const bool ok = out && fclose(out) == 0;
    if (ok) bis_json_text(j, key, text);
    free(text); /* the C library's, not ours */
    bis_free(bytes);
    return ok ? BIS_OK : no_memory(what, diag);
}

char *bis_page_png(const bis_image *image, double exposure, bis_diag *diag)
{
    bis_channel channels[4];
    bis_picture picture = bis_image_picture(image, channels);
    char *png = NULL, *text = NULL;
    size_t n = 0, n_text = 0;
    FILE *binary = open_memstream(&png, &n), *base64 = open_memstream(&text, &n_text);

    picture.has_exposure = true;
    picture.exposure = exposure;
    bool ok = binary && base64 && bis_png_write(binary, &picture, "picture", NULL) == BIS_OK;
    ok = (!binary || fclose(binary) == 0) && ok;
    if (ok) fputs("data:image/png;base64,", base64), put_base64(base64, (const unsigned char *)png, n);
    ok = (!base64 || fclose(base64) == 0) && ok;
    free(png);
    if (ok) return text;
    free(text);
    bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for a picture of %d x %d", image->width, image->height);
    return NULL;
}
