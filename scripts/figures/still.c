/* SPDX-License-Identifier: BSD-2-Clause */
/* still: the list of figures that need no scene, and how their numbers are written. Seeds are fixed: the same numbers
 * every time. */
#include "still.h"

#include "bis/base/file.h"
#include "files/image_png.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const struct item {
    const char *name;
    still_figure *write;
} items[] = {
    {"3.3", thesis_marsaglia}, {"3.4", thesis_alias}, {"3.8", thesis_phong}, {"3.9", thesis_draws},
    {"4.3", thesis_rejection}, {"4.4", thesis_bounds}, {"4.5", thesis_resampling},
};

enum { N_ITEMS = sizeof items / sizeof *items };

void still_check(bis_status status)
{
    if (!status) return;
    fprintf(stderr, "figures: the library returned status %d\n", (int)status);
    exit(1);
}

void still_list(bis_json *j, const char *key, const double *v, int n)
{
    bis_json_open(j, key, '[');
    for (int i = 0; i < n; i++) bis_json_number(j, NULL, v[i]);
    bis_json_close(j);
}

bis_image still_field(int width, int height)
{
    bis_image field;

    still_check(bis_image_init(&field, width, height, NULL));
    return field;
}

/* RFC 4648. */
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

void still_picture(bis_json *j, const char *key, bis_image *image)
{
    bis_channel channels[4];
    bis_picture picture = bis_image_picture(image, channels);
    char *bytes = NULL, *png = NULL;
    size_t n = 0, length = 0;
    FILE *binary = open_memstream(&bytes, &n), *text = open_memstream(&png, &length);

    picture.has_exposure = true; /* 0: the colours as they are */
    still_check(binary && text ? bis_png_write(binary, &picture, "picture", NULL) : BIS_NOMEM);
    still_check(fclose(binary) == 0 ? BIS_OK : BIS_NOMEM);
    fputs("data:image/png;base64,", text);
    put_base64(text, (const unsigned char *)bytes, n);
    still_check(fclose(text) == 0 ? BIS_OK : BIS_NOMEM);
    free(bytes);

    if (!png) still_check(BIS_NOMEM);
    bis_json_text(j, key, png);
    free(png);
    bis_image_clear(image);
}

static void write_item(const struct item *item, const char *folder)
{
    bis_outfile *file;
    char path[1024];

    snprintf(path, sizeof path, "%s/%s.json", folder, item->name);
    still_check(bis_outfile_open(&file, path, NULL));
    bis_json j = {.out = bis_outfile_stream(file)};
    bis_json_open(&j, NULL, '{');
    item->write(&j);
    bis_json_close(&j);
    still_check(bis_outfile_commit(file, NULL));
}

bool still_write(const char *folder, char *const *names, int n)
{
    int made = 0;

    for (int i = 0; i < N_ITEMS; i++) {
        bool wanted = n == 0;
        for (int k = 0; k < n; k++) wanted |= strcmp(names[k], items[i].name) == 0;
        if (wanted) write_item(&items[i], folder), made++;
    }
    return n == 0 || made == n;
}
