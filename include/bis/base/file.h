/* SPDX-License-Identifier: BSD-2-Clause */
/* file: reading and writing whole files.
 *
 * A file is read whole, because maps and meshes are parsed from memory and every count in them is checked against the
 * file's size. Output is written to another file of the same folder, which takes the place of the older one on
 * commit. A failure (a full disk, a crash, Ctrl-C) therefore leaves no partial file and loses no older one. Numbers
 * are read and written independently of the locale. */
#pragma once

#include "bis/base/status.h"

#include <limits.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

/* bis_file_read reads all of path. *data receives the *size bytes and one zero byte after them; the caller frees it
 * with bis_free. Errors: BIS_IO (missing, unreadable, a directory, a read error), BIS_NOMEM. If at.file is set,
 * messages name `at` (the scene line that named the file), otherwise path. */
bis_status bis_file_read(unsigned char **data, size_t *size, const char *path, bis_loc at, bis_diag *diag);

/* bis_file_read_open does the same with what is left in fd, which may be a pipe; it waits for its end, and leaves fd
 * open. name stands in messages. Errors: BIS_IO, BIS_NOMEM. */
bis_status bis_file_read_open(unsigned char **data, size_t *size, int fd, const char *name, bis_diag *diag);

/* bis_file_target stores in target what path names after all links are followed. The file need not exist yet. Errors:
 * BIS_IO (links in a ring, a name that is too long). */
bis_status bis_file_target(char target[PATH_MAX], const char *path, bis_diag *diag);

/* bis_file_is_same returns whether a and b name one file after all links are followed. Existing files are compared by
 * device and inode, files that do not exist yet by folder and name. */
bool bis_file_is_same(const char *a, const char *b);

/* A file that is being written. Until the commit it has no name, or a temporary name in the folder of its final
 * name. */
typedef struct bis_outfile bis_outfile;

/* bis_outfile_open begins to write the file that path names after all links are followed. The file will have the mode
 * of the older file in its place; a new file has 0666 without the bits of the umask. Errors: BIS_IO, BIS_NOMEM. */
bis_status bis_outfile_open(bis_outfile **out, const char *path, bis_diag *diag);

/* bis_outfile_stream returns the stream to write to. It belongs to f. */
FILE *bis_outfile_stream(bis_outfile *f);

/* bis_outfile_commit flushes the file, checks for write errors, calls fsync, puts the file in the place of the older
 * one and frees f. Errors: BIS_IO. The new file is then gone, the older file at path is untouched, and the message
 * names path and the reason. */
bis_status bis_outfile_commit(bis_outfile *f, bis_diag *diag);

/* bis_outfile_abort removes the new file and frees f; NULL is allowed. */
void bis_outfile_abort(bis_outfile *f);

/* bis_outfile_name_at_once gives files that are opened from now on a temporary name at once, as on a file system that
 * has no files without a name. For tests. */
void bis_outfile_name_at_once(bool yes);

/* bis_byte_order_mark returns the length of the mark by which Windows begins texts in UTF-8, 3, or 0 without one. */
static inline size_t bis_byte_order_mark(const void *text, size_t size)
{
    return size >= 3 && memcmp(text, "\xef\xbb\xbf", 3) == 0 ? 3 : 0;
}

/* bis_path_relative_to returns the folder of `of` + "/" + name, or a copy of name if name is absolute. The caller
 * frees it with bis_free. Returns NULL without memory. */
char *bis_path_relative_to(const char *of, const char *name);

/* bis_path_extension returns the extension of path in lower case with its dot, in buf (at most 8 bytes with the
 * zero); "" if there is none. */
const char *bis_path_extension(char buf[8], const char *path);

/* bis_parse_double reads a number as strtod does in the "C" locale, correctly rounded. It skips no white space. *end
 * = s if no number starts at s. It accepts inf and nan, as strtod does; a caller that wants neither checks with
 * isfinite. The text must end in a byte that cannot belong to a number (a zero will do). */
double bis_parse_double(const char *s, const char **end);

/* bis_format_double writes the shortest text that reads back as the same double, with '.' as the point. Returns buf. */
const char *bis_format_double(char buf[32], double v);

/* bis_format_float does the same for a float. */
const char *bis_format_float(char buf[32], float v);
