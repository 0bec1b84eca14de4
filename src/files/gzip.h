/* SPDX-License-Identifier: BSD-2-Clause */
/* gzip: whole files, expanded if they are compressed by gzip. For the readers of maps and meshes, and for a look at
 * their first bytes. */
#pragma once

#include "bis/base/status.h"

/* A file may expand to this many bytes in any case, and beyond them to this many times its own size. Maps and meshes
 * stay below ten times; deflate can reach a thousand times, with zeros that fill the memory. */
#define BIS_GZIP_FREE ((size_t)64 << 20)
#define BIS_GZIP_RATIO 100

/* bis_gzip_read does what bis_file_read does (bis/base/file.h), and expands a file that begins with the bytes 1f 8b,
 * whatever its name is. Errors: those of bis_file_read; BIS_INPUT (damaged or cut off, or expands beyond the limit
 * above). */
bis_status bis_gzip_read(unsigned char **data, size_t *size, const char *path, bis_loc at, bis_diag *diag);

/* bis_gzip_head stores at most n of the file's first bytes, expanded. Returns how many; 0: it cannot be read,
 * or is no regular file. */
size_t bis_gzip_head(char *head, size_t n, const char *path);
