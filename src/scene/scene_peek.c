/* SPDX-License-Identifier: BSD-2-Clause */
/* scene_peek: searches the first 64 kB of a file for the words that tell its size. Nothing is allocated. */
#include "scene_peek.h"

#include "bis/base/file.h"
#include "bis/base/image.h"
#include "files/gzip.h"
#include "files/image_io.h"

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
    *width = strtol(h->text + (h->text[2] == '4' ? 3 : 2), &rest, 10);
    *height = strtol(rest, NULL, 10);
    return *width > 0 && *height > 0;
}

static int32_t little_endian(const char *s)
{
    const unsigned char *b = (const unsigned char *)s;
    return (int32_t)((uint32_t)b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 | (uint32_t)b[3] << 24);
}

/* An attribute: name, type, size 16, then x0, y0, x1, y1 inclusive. NULL: there is none. */
static const char *exr_window(const head *h, const char *key, size_t n)
{
    const char *at = memmem(h->text, h->n, key, n);
    return at && (size_t)(at - h->text) + n + 16 <= h->n ? at + n : NULL;
}

/* False also where the picture is not what the file has pixels of, or a cube of OpenEXR: the loader knows. */
static bool exr_size(const head *h, long *width, long *height)
{
    static const char data[] = "dataWindow\0box2i\0\x10\0\0", display[] = "displayWindow\0box2i\0\x10\0\0",
                      cube[] = "envmap\0envmap\0\1\0\0\0\1";
    const char *at = exr_window(h, data, sizeof data), *shown = exr_window(h, display, sizeof display);
    if (!at || !shown || memcmp(at, shown, 16) != 0 || memmem(h->text, h->n, cube, sizeof cube - 1)) return false;
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

static long big_endian_2(const char *s) { return (long)(unsigned char)s[0] << 8 | (long)(unsigned char)s[1]; }

/* Segments: 0xff, a kind, then its length, which counts itself but not these two bytes. The frame, 0xc0 to 0xcf but for
 * three kinds of tables, holds them. The segments are walked, because a thumbnail inside one has a frame of its own. */
static bool jpeg_size(const head *h, long *width, long *height)
{
    size_t at = 2;
    while (at + 9 <= h->n && (unsigned char)h->text[at] == 0xff) {
        const int kind = (unsigned char)h->text[at + 1];
        if (kind == 0xff) {
            at++; /* a byte that only fills */
            continue;
        }
        if (kind >= 0xc0 && kind <= 0xcf && kind != 0xc4 && kind != 0xc8 && kind != 0xcc) {
            *height = big_endian_2(h->text + at + 5);
            *width = big_endian_2(h->text + at + 7);
            return *width > 0 && *height > 0;
        }
        at += 2 + (size_t)big_endian_2(h->text + at + 2);
    }
    return false;
}

/* The header behind the file's own has them; a negative height counts from the top. */
static bool bmp_size(const head *h, long *width, long *height)
{
    if (h->n < 26) return false;
    *width = (long)little_endian(h->text + 18);
    *height = labs((long)little_endian(h->text + 22));
    return *width > 0 && *height > 0;
}

static bool tga_size(const head *h, long *width, long *height)
{
    if (!bis_tga_is_mine((const unsigned char *)h->text, h->n)) return false;
    *width = (unsigned char)h->text[12] | (long)(unsigned char)h->text[13] << 8;
    *height = (unsigned char)h->text[14] | (long)(unsigned char)h->text[15] << 8;
    return true;
}

size_t bis_scene_peek_bytes(const char *path)
{
    struct stat st;
    return stat(path, &st) == 0 && st.st_size > 0 ? (size_t)st.st_size : 0;
}

/* How a format's size is found; how many pixels a byte of it can hold, which bounds what its header may claim: deflate
 * makes at most 1032 bytes of one, each of eight pixels at most; a JPEG spends a bit on 8 x 8; a run of a TGA has 128
 * pixels and takes two bytes; a BMP has eight in a byte. 0: a loader refuses what does not fit, but not by this. */
typedef struct peeked_format {
    const char *magic; /* NULL: none, the size knows its own */
    size_t n_magic;
    bool (*size)(const head *h, long *width, long *height);
    double most_pixels;
} peeked_format;

static const peeked_format formats[] = {
    {"\x76\x2f\x31\x01", 4, exr_size, 0}, {"PF", 2, pfm_size, 0},    {"Pf", 2, pfm_size, 0},
    {"\x89PNG", 4, png_size, 8 * 1032},     {"#?", 2, hdr_size, 0},    {"\xff\xd8\xff", 3, jpeg_size, 8 * 64},
    {"BM", 2, bmp_size, 8},                 {NULL, 0, tga_size, 64},
};

bool bis_scene_peek_image(const char *path, long *width, long *height)
{
    head h;
    if (!read_head(&h, path)) return false;
    const peeked_format *f = formats;
    while (f->magic && !starts_with(&h, f->magic, f->n_magic)) f++;
    if (!f->size(&h, width, height) || *width > BIS_IMAGE_MAX_SIDE || *height > BIS_IMAGE_MAX_SIDE) return false;
    return f->most_pixels == 0 ||
           (double)*width * (double)*height <= f->most_pixels * (double)bis_scene_peek_bytes(path);
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

typedef struct stranger {
    const char *mark, *what;
    bis_stranger_kind kind;
} stranger;

static const stranger models[] = {
    {"glTF", "a glTF model", BIS_STRANGER_MODEL},
    {"Kaydara FBX", "an FBX model", BIS_STRANGER_MODEL},
    {"; FBX", "an FBX model", BIS_STRANGER_MODEL},
    {"BLENDER", "a Blender file", BIS_STRANGER_MODEL},
    {"PXR-USDC", "a USD scene", BIS_STRANGER_MODEL},
    {"#usda", "a USD scene", BIS_STRANGER_MODEL},
    {"#VRML", "a VRML scene", BIS_STRANGER_MODEL},
};

static const stranger model_endings[] = {
    {".glb", "a glTF model", BIS_STRANGER_MODEL},   {".gltf", "a glTF model", BIS_STRANGER_MODEL},
    {".fbx", "an FBX model", BIS_STRANGER_MODEL},   {".blend", "a Blender file", BIS_STRANGER_MODEL},
    {".stl", "an STL mesh", BIS_STRANGER_MODEL},    {".dae", "a Collada model", BIS_STRANGER_MODEL},
    {".3ds", "a 3DS model", BIS_STRANGER_MODEL},    {".off", "an OFF mesh", BIS_STRANGER_MODEL},
    {".usd", "a USD scene", BIS_STRANGER_MODEL},    {".usda", "a USD scene", BIS_STRANGER_MODEL},
    {".usdc", "a USD scene", BIS_STRANGER_MODEL},   {".usdz", "a USD scene", BIS_STRANGER_MODEL},
    {".3mf", "a 3MF model", BIS_STRANGER_MODEL},    {".x3d", "an X3D model", BIS_STRANGER_MODEL},
    {".wrl", "a VRML scene", BIS_STRANGER_MODEL},   {".abc", "an Alembic scene", BIS_STRANGER_MODEL},
    {".lwo", "a LightWave model", BIS_STRANGER_MODEL}, {".ma", "a Maya scene", BIS_STRANGER_MODEL},
    {".mb", "a Maya scene", BIS_STRANGER_MODEL},    {".max", "a 3ds Max scene", BIS_STRANGER_MODEL},
};

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

static const stranger *find_bytes(const stranger *list, size_t n, const head *h)
{
    for (size_t i = 0; i < n; i++)
        if (starts_with(h, list[i].mark, strlen(list[i].mark))) return &list[i];
    return NULL;
}

static const stranger *find_ending(const stranger *list, size_t n, const char *path)
{
    char ending[8];

    bis_path_extension(ending, path);
    for (size_t i = 0; i < n; i++)
        if (strcmp(ending, list[i].mark) == 0) return &list[i];
    return NULL;
}

#define COUNT(list) (sizeof(list) / sizeof *(list))

const char *bis_scene_peek_stranger(const char *path, bis_stranger_kind *kind)
{
    head h;

    if (!read_head(&h, path)) return NULL;
    /* models first: some are XML or JSON */
    const stranger *found = find_bytes(models, COUNT(models), &h);
    if (!found) found = find_ending(model_endings, COUNT(model_endings), path);
    if (!found) found = find_bytes(by_bytes, COUNT(by_bytes), &h);
    if (!found) found = find_ending(by_ending, COUNT(by_ending), path);
    if (!found) return NULL;
    *kind = found->kind;
    return found->what;
}
