/* SPDX-License-Identifier: BSD-2-Clause */
/* mesh_io: messages with the mesh's own line in them, and a growing list of triangles. */
#include "mesh_io.h"

#include "base/grow.h"

#include <limits.h>
#include <stdarg.h>
#include <stdio.h>

static bis_status no_memory(const mesh_input *in, size_t n)
{
    return bis_mesh_refuse(in, 0, BIS_NOMEM, "no memory for %zu triangles", n);
}

/* A message longer than this is cut: it quotes at most a word or two of the file. */
enum { MAX_TEXT = 512 };

bis_status bis_mesh_refuse(const mesh_input *in, int line, bis_status code, const char *fmt, ...)
{
    char text[MAX_TEXT];
    va_list args;

    va_start(args, fmt);
    vsnprintf(text, sizeof text, fmt, args);
    va_end(args);
    if (!in->at.file) return bis_error(in->diag, code, (bis_loc){in->path, line, 0}, "%s", text);
    if (line == 0) return bis_error(in->diag, code, in->at, "%s: %s", in->path, text);
    return bis_error(in->diag, code, in->at, "%s:%d: %s", in->path, line, text);
}

void bis_mesh_remark(const mesh_input *in, const char *fmt, ...)
{
    char text[MAX_TEXT];
    va_list args;

    va_start(args, fmt);
    vsnprintf(text, sizeof text, fmt, args);
    va_end(args);
    if (in->at.file) bis_warn(in->diag, in->at, "%s: %s", in->path, text);
    else bis_warn(in->diag, (bis_loc){in->path, 0, 0}, "%s", text);
}

int bis_mesh_line(const mesh_input *in, const unsigned char *p)
{
    int line = 1;

    for (const unsigned char *c = in->data; c < p && line < INT_MAX; c++)
        if (*c == '\n' || (*c == '\r' && c[1] != '\n')) line++;
    return line;
}

bis_status bis_mesh_add_triangle(bis_mesh *m, size_t *capacity, const uint32_t v[3], const mesh_input *in)
{
    if (m->n_triangles == *capacity && !bis_room(&m->index, capacity, m->n_triangles + 1, 3 * sizeof *m->index))
        return no_memory(in, m->n_triangles + 1);
    for (size_t i = 0; i < 3; i++) m->index[3 * m->n_triangles + i] = v[i];
    m->n_triangles++;
    return BIS_OK;
}

bis_status bis_mesh_finish(bis_mesh *m, size_t capacity, const mesh_input *in)
{
    if (m->n_triangles == 0)
        bis_mesh_remark(in, "no triangles: nothing of this mesh will be seen (%zu vertices)", m->n_vertices);
    if (m->n_triangles == capacity) return BIS_OK;
    uint32_t *index = bis_realloc(m->index, m->n_triangles, 3 * sizeof *index);
    if (!index) return no_memory(in, m->n_triangles);
    m->index = index;
    return BIS_OK;
}
