/* SPDX-License-Identifier: BSD-2-Clause */
/* markup: entities (HTML 4, XML 1.0) and base64 (RFC 4648). */
#include "markup.h"

#include "base/text.h"
#include "files/image_png.h"

#include <stdlib.h>
#include <string.h>

void bis_markup_text(FILE *out, const char *text, size_t n)
{
    for (const char *end = text + n; text < end;) {
        const size_t length = bis_utf8_length(text, end);
        if (*text == '&') fputs("&amp;", out);
        else if (*text == '<') fputs("&lt;", out);
        else if (*text == '>') fputs("&gt;", out);
        else if (*text == '"') fputs("&quot;", out);
        else if (*text == '\'') fputs("&#39;", out);
        else if (length == 0 || (unsigned char)*text < 0x20 || *text == 0x7f) fputs("\xef\xbf\xbd", out);
        else fwrite(text, 1, length, out);
        text += length ? length : 1;
    }
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

char *bis_markup_png(const bis_image *image, double exposure, bis_diag *diag)
{
    bis_channel channels[3];
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
