/* file: whole files in, whole files out.
 *
 * In: a file is read whole (maps and meshes are parsed from memory, every count is checked against the size).
 * Out: everything is written to a temporary file in the same folder and renamed on commit, so that a failure (a full
 * disk, a crash, Ctrl-C) leaves neither a partial file nor a lost older one.
 * Numbers are read and written independent of the locale. */
#ifndef BIS_FILE_H
#define BIS_FILE_H

#include "bis/base/status.h"

#include <stdint.h>
#include <stdio.h>

/* Read all of path. *data: size bytes and one zero byte behind them; bis_free it. Errors: BIS_IO (missing, unreadable,
 * a directory, a read error), BIS_NOMEM. Messages stand at `at` when at.file is set (the scene line that named the
 * file), else at path itself. */
bis_status bis_file_read(unsigned char **data, size_t *size, const char *path, bis_loc at, bis_diag *diag);

/* A file being written. Opaque: a temporary file beside its final name. */
typedef struct bis_outfile bis_outfile;

/* Open a temporary file beside path. Errors: BIS_IO, BIS_NOMEM. */
bis_status bis_outfile_open(bis_outfile **out, const char *path, bis_diag *diag);
FILE *bis_outfile_stream(bis_outfile *f);
const char *bis_outfile_temp_name(const bis_outfile *f);

/* Flush, check for write errors, fsync, rename over the final name, free. On failure the temporary file is removed, the
 * older file at path is untouched, and the message names path and the reason. */
bis_status bis_outfile_commit(bis_outfile *f, bis_diag *diag);

/* Remove the temporary file and free; NULL is fine. */
void bis_outfile_abort(bis_outfile *f);


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
