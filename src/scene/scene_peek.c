/* SPDX-License-Identifier: BSD-2-Clause */
/* scene_peek: searches the first 64 kB of a file for the words that tell its size. Nothing is allocated. */
#include "scene_peek.h"

#include "bis/base/file.h"
#include "bis/base/image.h"
#include "files/gzip.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

typedef struct head {
    char text[65536 + 1]; /* ends with a zero byte, may hold others */
    size_t n;
} head;

static bool read_head(head *h, const char *path)
{
    h->n = bis_gzip_head(h->text, sizeof h->text - 1, path);
    h->text[h->n] = '\0';
    return h->n > 0;
}

static bool starts_with(const head *h, const char *magic, size_t n)
{
    return h->n >= n && memcmp(h->text, magic, n) == 0;
}

/* The integer behind the first occurrence of the word. */
static bool number_after(const head *h, const char *word, long *value)
{
    const char *at = strstr(h->text, word);
    if (!at) return false;
    char *end;
    *value = strtol(at + strlen(word), &end, 10);
    return end > at + strlen(word) && *value > 0;
}

/* "\n-Y 512 +X 1024\n", with either sign and either axis first. */
static bool hdr_size(const head *h, long *width, long *height)
{
    bool has_x = number_after(h, "+X ", width) || number_after(h, "-X ", width);
    bool has_y = number_after(h, "-Y ", height) || number_after(h, "+Y ", height);
    return has_x && has_y;
}

static bool pfm_size(const head *h, long *width, long *height)
{
    char *rest;
    *width = strtol(h->text + 2, &rest, 10);
    *height = strtol(rest, NULL, 10);
    return *width > 0 && *height > 0;
}

static int32_t little_endian(const char *s)
{
    const unsigned char *b = (const unsigned char *)s;
    return (int32_t)((uint32_t)b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 | (uint32_t)b[3] << 24);
}

/* The attribute: name, type, size 16, then x0, y0, x1, y1 inclusive. */
static bool exr_size(const head *h, long *width, long *height)
{
    static const char key[] = "dataWindow\0box2i\0\x10\0\0";
    const char *at = memmem(h->text, h->n, key, sizeof key);
    if (!at || (size_t)(at - h->text) + sizeof key + 16 > h->n) return false;
    at += sizeof key;
    *width = (long)little_endian(at + 8) - little_endian(at) + 1;
    *height = (long)little_endian(at + 12) - little_endian(at + 4) + 1;
    return *width > 0 && *height > 0;
}

static long big_endian(const char *s)
{
    const unsigned char *b = (const unsigned char *)s;
    return (long)b[0] << 24 | (long)b[1] << 16 | (long)b[2] << 8 | (long)b[3];
}

/* Its first chunk, IHDR, begins with them. */
static bool png_size(const head *h, long *width, long *height)
{
    if (h->n < 24) return false;
    *width = big_endian(h->text + 16);
    *height = big_endian(h->text + 20);
    return *width > 0 && *height > 0;
}

size_t bis_scene_peek_bytes(const char *path)
{
    struct stat st;
    return stat(path, &st) == 0 && st.st_size > 0 ? (size_t)st.st_size : 0;
}

/* A claim that reading would refuse: a side is at most BIS_IMAGE_MAX_SIDE, and deflate makes at most 1032 bytes of one,
 * each of eight pixels at most. */
static bool is_possible(const char *path, bool is_png, long width, long height)
{
    if (width > BIS_IMAGE_MAX_SIDE || height > BIS_IMAGE_MAX_SIDE) return false;
    return !is_png || (double)width * (double)height <= 8 * 1032 * (double)bis_scene_peek_bytes(path);
}

bool bis_scene_peek_image(const char *path, long *width, long *height)
{
    head h;
    if (!read_head(&h, path)) return false;
    const bool is_png = starts_with(&h, "\x89PNG", 4), is_exr = starts_with(&h, "\x76\x2f\x31\x01", 4);
    const bool is_pfm = starts_with(&h, "PF", 2) || starts_with(&h, "Pf", 2);
    const bool is_known = is_exr   ? exr_size(&h, width, height)
                          : is_pfm ? pfm_size(&h, width, height)
                          : is_png ? png_size(&h, width, height)
                                   : starts_with(&h, "#?", 2) && hdr_size(&h, width, height);
    return is_known && is_possible(path, is_png, *width, *height);
}

bool bis_scene_peek_ply(const char *path, long *n_vertices, long *n_faces)
{
    head h;
    return read_head(&h, path) && starts_with(&h, "ply", 3) && number_after(&h, "element vertex ", n_vertices) &&
           number_after(&h, "element face ", n_faces);
}

/* A text has no zero byte. What cannot be read counts as text: the loader will say why. */
bool bis_scene_peek_is_text(const char *path)
{
    head h;
    return !read_head(&h, path) || strlen(h.text) == h.n;
}

/* These two stand here because the parser may not include src/files: it knows files by what a scene may ask of them. */
bis_status bis_scene_peek_obj(bis_obj_materials *out, const char *path, bis_loc at, bis_diag *diag)
{
    return bis_obj_read_materials(out, path, at, diag);
}

bis_status bis_scene_peek_text(unsigned char **data, size_t *size, const char *path, bis_loc at, bis_diag *diag)
{
    return bis_gzip_read(data, size, path, at, diag);
}

typedef struct stranger {
    const char *mark, *what;
    bis_stranger_kind kind;
} stranger;

static const stranger by_bytes[] = {
    {"#?RADIANCE", "a Radiance map", BIS_STRANGER_MAP},
    {"#?RGBE", "a Radiance map", BIS_STRANGER_MAP},
    {"\x76\x2f\x31\x01", "an OpenEXR image", BIS_STRANGER_MAP},
    {"PF\n", "a PFM image", BIS_STRANGER_MAP},
    {"Pf\n", "a PFM image", BIS_STRANGER_MAP},
    {"ply\n", "a PLY mesh", BIS_STRANGER_PLY},
    {"ply\r", "a PLY mesh", BIS_STRANGER_PLY},
    {"\x89PNG", "a PNG picture", BIS_STRANGER_OTHER},
    {"\xff\xd8\xff", "a JPEG picture", BIS_STRANGER_OTHER},
    {"\x7f" "ELF", "a program", BIS_STRANGER_OTHER},
    {"%PDF", "a PDF document", BIS_STRANGER_OTHER},
    {"<", "a page or scene in XML or HTML", BIS_STRANGER_OTHER},
    {"{", "a file in JSON", BIS_STRANGER_OTHER},
};

static const stranger by_ending[] = {
    {".md", "a page in Markdown", BIS_STRANGER_OTHER},
    {".obj", "a Wavefront mesh", BIS_STRANGER_OBJ},
    {".mtl", "the materials of a Wavefront mesh", BIS_STRANGER_OTHER},
    {".c", "a program's source", BIS_STRANGER_OTHER},
    {".h", "a program's source", BIS_STRANGER_OTHER},
    {".sh", "a script", BIS_STRANGER_OTHER},
    {".csv", "a table", BIS_STRANGER_OTHER},
};

const char *bis_scene_peek_stranger(const char *path, bis_stranger_kind *kind)
{
    char ending[8];
    head h;

    if (!read_head(&h, path)) return NULL;
    bis_path_extension(ending, path);
    const stranger *found = NULL;
    for (size_t i = 0; i < sizeof by_bytes / sizeof *by_bytes && !found; i++) {
        if (starts_with(&h, by_bytes[i].mark, strlen(by_bytes[i].mark))) found = &by_bytes[i];
    }
    for (size_t i = 0; i < sizeof by_ending / sizeof *by_ending && !found; i++) {
        if (strcmp(ending, by_ending[i].mark) == 0) found = &by_ending[i];
    }
    if (!found) return NULL;
    *kind = found->kind;
    return found->what;
}
