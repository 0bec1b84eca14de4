/* file: whole files in, whole files out.
 *
 * In: a file is read whole (maps and meshes are parsed from memory, every count is checked against the size).
 * Out: everything is written to another file of the same folder that takes its place on commit, so that a failure (a
 * full disk, a crash, Ctrl-C) leaves neither a partial file nor a lost older one.
 * Numbers are read and written independent of the locale. */
#ifndef BIS_FILE_H
#define BIS_FILE_H

#include "bis/base/status.h"

#include <limits.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

/* Read all of path. *data: size bytes and one zero byte behind them; bis_free it. Errors: BIS_IO (missing, unreadable,
 * a directory, a read error), BIS_NOMEM. Messages stand at `at` when at.file is set (the scene line that named the
 * file), else at path itself. */
bis_status bis_file_read(unsigned char **data, size_t *size, const char *path, bis_loc at, bis_diag *diag);

/* bis_file_target: what path names behind all links, also one whose file does not exist yet. Errors: BIS_IO (links in a
 * ring, a name that is too long). */
bis_status bis_file_target(char target[PATH_MAX], const char *path, bis_diag *diag);

/* bis_file_is_same: do a and b name one file, by device and inode; of two that do not exist yet, by folder and name,
 * behind all links? */
bool bis_file_is_same(const char *a, const char *b);

/* A file being written. Opaque: a file without a name, or with a temporary one, in the folder of its final name. */
typedef struct bis_outfile bis_outfile;

/* bis_outfile_open: begin to write the file that path names behind all links. It will have the mode of the older file
 * there; a new one has what the umask leaves of 0666. Errors: BIS_IO, BIS_NOMEM. */
bis_status bis_outfile_open(bis_outfile **out, const char *path, bis_diag *diag);
FILE *bis_outfile_stream(bis_outfile *f);

/* Flush, check for write errors, fsync, put in the place of the older file, free. On failure the new file is gone, the
 * older file at path is untouched, and the message names path and the reason. */
bis_status bis_outfile_commit(bis_outfile *f, bis_diag *diag);

/* Remove the new file and free; NULL is fine. */
void bis_outfile_abort(bis_outfile *f);

/* bis_outfile_name_at_once: give files that are opened from now on a temporary name, as on a file system that has no
 * others. For tests. */
void bis_outfile_name_at_once(bool yes);

/* dir(of) + "/" + name unless name is absolute; bis_free it; NULL without memory. */
char *bis_path_relative_to(const char *of, const char *name);

/* The extension with its dot, lower case, in buf (at most 8 bytes with the zero); "" when there is none. */
const char *bis_path_extension(char buf[8], const char *path);

/* strtod in the "C" locale: skips no white space, *end = s when no number starts at s. Accepts what strtod accepts, inf
 * and nan included: the caller refuses those by isfinite. Correctly rounded. s must end in a byte that is no part of a
 * number (a zero will do). */
double bis_parse_double(const char *s, const char **end);

/* Shortest text that reads back as the same double or float, '.' as the point. Returns buf. */
const char *bis_format_double(char buf[32], double v);
const char *bis_format_float(char buf[32], float v);

#endif
