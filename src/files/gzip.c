/* SPDX-License-Identifier: BSD-2-Clause */
/* gzip: expands .gz files in memory, by zlib (RFC 1952).
 *
 * The size that a gzip file claims for itself stands at its end, modulo 2^32, and is not read: the buffer grows with
 * what comes, up to a limit that depends on the file's own size. */
#include "gzip.h"

#include "bis/base/file.h"
#include "bis/base/mem.h"

#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

enum { GZIP_WINDOW = 15 + 16 }; /* zlib: the largest window, and a header of gzip's */

static voidpf take_memory(voidpf opaque, uInt n, uInt size)
{
    (void)opaque;
    return bis_alloc(n, size);
}

static void give_memory(voidpf opaque, voidpf block)
{
    (void)opaque;
    bis_free(block);
}

/* What is expanded so far, and room for one zero byte more. */
typedef struct buffer {
    unsigned char *data;
    size_t n, capacity, limit;
} buffer;

static uInt at_most(size_t n) { return (uInt)(n < (size_t)1 << 30 ? n : (size_t)1 << 30); }

static bool grow(buffer *b)
{
    const size_t wanted = b->capacity ? 2 * b->capacity : 65536, capacity = wanted < b->limit ? wanted : b->limit;
    unsigned char *data = bis_realloc(b->data, capacity + 1, 1);
    if (!data) return false;
    b->data = data;
    b->capacity = capacity;
    return true;
}

/* The next member of the file: several may follow each other, and the content is one after the other. Returns what
 * zlib says; Z_BUF_ERROR: the file is cut off, or the limit is reached. */
static int expand_member(buffer *b, z_stream *z, const unsigned char *end)
{
    for (;;) {
        if (b->n == b->capacity && b->capacity == b->limit) return Z_BUF_ERROR;
        if (b->n == b->capacity && !grow(b)) return Z_MEM_ERROR;
        z->avail_in = at_most((size_t)(end - z->next_in));
        z->next_out = b->data + b->n;
        z->avail_out = at_most(b->capacity - b->n);
        const uInt room = z->avail_out;
        const int result = inflate(z, Z_NO_FLUSH);
        b->n += room - z->avail_out;
        if (result != Z_OK && !(result == Z_BUF_ERROR && b->n == b->capacity)) return result;
    }
}

static bool begins_member(const unsigned char *data, size_t size)
{
    return size >= 2 && data[0] == 0x1f && data[1] == 0x8b;
}

static bis_status expand(buffer *b, const unsigned char *data, size_t size, const char *path, bis_loc at,
                         bis_diag *diag)
{
    const unsigned char *end = data + size;
    z_stream z = {.next_in = (z_const Bytef *)(uintptr_t)data, .zalloc = take_memory, .zfree = give_memory};
    int result = inflateInit2(&z, GZIP_WINDOW);

    while (result == Z_OK) {
        result = expand_member(b, &z, end);
        if (result != Z_STREAM_END || !begins_member(z.next_in, (size_t)(end - z.next_in))) break;
        result = inflateReset(&z);
    }
    const unsigned char *rest = z.next_in;
    inflateEnd(&z);
    while (rest < end && *rest == 0) rest++; /* as a tape fills its last block */
    if (result == Z_STREAM_END && rest < end)
        bis_warn(diag, at, "\"%s\": %zu bytes after its end are no part of the gzip file and are ignored", path,
                 (size_t)(end - rest));
    if (result == Z_STREAM_END) return BIS_OK;
    if (result == Z_MEM_ERROR)
        return bis_error(diag, BIS_NOMEM, at, "no memory to expand \"%s\" (%zu bytes so far)", path, b->n);
    if (b->n == b->limit)
        return bis_error(diag, BIS_INPUT, at,
                         "cannot read \"%s\": its %zu bytes expand to more than %zu, which is more than maps and "
                         "meshes need and may be made to fill the memory; if you trust the file, expand it with gunzip "
                         "and name the result", path, size, b->limit);
    return bis_error(diag, BIS_INPUT, at, "cannot read \"%s\": the gzip file is %s (gzip -t tells more)", path,
                     result == Z_BUF_ERROR || result == Z_OK ? "cut off" : "damaged");
}

bis_status bis_gzip_read(unsigned char **data, size_t *size, const char *path, bis_loc at, bis_diag *diag)
{
    buffer b = {0};
    bis_status status = bis_file_read(data, size, path, at, diag);

    if (status || !begins_member(*data, *size)) return status;
    b.limit = *size > BIS_GZIP_FREE / BIS_GZIP_RATIO ? *size * BIS_GZIP_RATIO : BIS_GZIP_FREE;
    status = expand(&b, *data, *size, path, at.file ? at : (bis_loc){path, 0, 0}, diag);
    bis_free(*data);
    *data = NULL;
    *size = 0;
    if (status) {
        bis_free(b.data);
        return status;
    }
    b.data[b.n] = 0;
    *data = b.data;
    *size = b.n;
    return BIS_OK;
}

size_t bis_gzip_head(char *head, size_t n, const char *path)
{
    struct stat info;
    /* as bis_file_read: a pipe waits for its writer, and /proc/kmsg calls itself regular and waits for the kernel */
    const int fd = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    const bool is_regular = fd >= 0 && fstat(fd, &info) == 0 && S_ISREG(info.st_mode);
    gzFile file = is_regular ? gzdopen(fd, "rb") : NULL; /* reads what is no gzip file as it is */
    if (!file) {
        if (fd >= 0) close(fd);
        return 0;
    }
    const int got = gzread(file, head, (unsigned)n);
    gzclose(file);
    return got > 0 ? (size_t)got : 0;
}
