/* SPDX-License-Identifier: BSD-2-Clause */
/* file: whole files in, whole files out, numbers without a locale.
 *
 * Reading: the size that the system reports is only a first guess (it is 0 for files of /proc, and a file may grow), so
 * we read until the end and grow the buffer on the way.
 * Writing: to a file of the same folder, hence on the same disk, that gets its name when it is complete, so that at any
 * moment path is either the whole old file or the whole new one. Until then it has no name (O_TMPFILE), and a process
 * that is killed leaves nothing behind that the next one does not remove; where the file system cannot do that it has a
 * temporary one.
 * Numbers: strtod and printf obey the locale's decimal point; ours obey nothing. Parsing: two doubles that are exact
 * give a product or quotient that is correctly rounded (Clinger 1990, "How to Read Floating Point Numbers Accurately"),
 * which covers nearly all numbers of a mesh or scene; the rest goes to the C library. */
#include "bis/base/file.h"
#include "bis/base/mem.h"
#include "text.h"

#include <errno.h>
#include <fcntl.h>
#include <float.h>
#include <inttypes.h>
#include <locale.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

/* ---- in ---- */

/* What `mode` is, for a message; NULL: a regular file. */
static const char *irregular(mode_t mode)
{
    if (S_ISREG(mode)) return NULL;
    if (S_ISDIR(mode)) return "a folder";
    if (S_ISFIFO(mode)) return "a pipe";
    if (S_ISSOCK(mode)) return "a socket";
    return "a device";
}

static ssize_t read_some(int fd, unsigned char *buffer, size_t room)
{
    ssize_t got;
    do
        got = read(fd, buffer, room);
    while (got < 0 && errno == EINTR);
    return got;
}

/* An open file. */
typedef struct source {
    int fd;
    const char *path;
    bis_loc at; /* of messages */
} source;

static bis_status no_room(const source *from, size_t capacity, bis_diag *diag)
{
    return bis_error(diag, BIS_NOMEM, from->at, "no memory to read \"%s\" (%zu bytes)", from->path, capacity);
}

/* Everything to the end of the file, and a zero byte. *data is the caller's also on failure. */
static bis_status read_all(unsigned char **data, size_t *size, const source *from, size_t guess, bis_diag *diag)
{
    const size_t spare = 2; /* one for the zero, one so that the read that meets the end has room to ask for a byte */
    size_t capacity = guess > 4096 ? guess : 4096, n = 0;

    *data = bis_alloc(capacity + spare, 1);
    for (;;) {
        if (!*data) return no_room(from, capacity, diag);
        ssize_t got = read_some(from->fd, *data + n, capacity + spare - 1 - n);
        if (got < 0)
            return bis_error(diag, BIS_IO, from->at, "cannot read \"%s\": %s", from->path, strerror(errno));
        if (got == 0) break;
        n += (size_t)got;
        if (n <= capacity) continue;
        capacity *= 2;
        unsigned char *grown = bis_realloc(*data, capacity + spare, 1);
        if (!grown) return no_room(from, capacity, diag);
        *data = grown;
    }
    (*data)[n] = 0;
    *size = n;
    return BIS_OK;
}

bis_status bis_file_read_open(unsigned char **data, size_t *size, int fd, const char *name, bis_diag *diag)
{
    *size = 0;
    const bis_status status = read_all(data, size, &(source){fd, name, {name, 0, 0}}, 0, diag);

    if (!status) return BIS_OK;
    bis_free(*data);
    *data = NULL;
    return status;
}

bis_status bis_file_read(unsigned char **data, size_t *size, const char *path, bis_loc at, bis_diag *diag)
{
    bis_status status;
    struct stat info;
    const char *what;
    unsigned char *bytes = NULL;
    bis_loc place = at.file ? at : (bis_loc){path, 0, 0};

    *data = NULL;
    *size = 0;
    int fd = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC); /* O_NONBLOCK: do not wait for a pipe's writer */
    if (fd < 0 || fstat(fd, &info)) {
        status = bis_error(diag, BIS_IO, place, "cannot open \"%s\": %s", path, strerror(errno));
        goto done;
    }
    what = irregular(info.st_mode);
    if (what) {
        status = bis_error(diag, BIS_IO, place, "\"%s\" is %s, must be a regular file", path, what);
        goto done;
    }
    status = read_all(&bytes, size, &(source){fd, path, place}, (size_t)info.st_size, diag);
    if (status) goto done;
    *data = bytes;
    bytes = NULL;
done:
    bis_free(bytes);
    if (fd >= 0) close(fd);
    return status;
}

/* ---- out ---- */

struct bis_outfile {
    char *path; /* what is replaced, behind all links */
    char *temp; /* room for the name of the temporary file; "": it has none */
    FILE *stream;
};

enum { MOST_LINKS = 40 }; /* Linux follows as many */

static size_t folder_length(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? (size_t)(slash - path) + 1 : 0;
}

/* The folder that path stands in, "." where it names none. */
static void copy_folder(char folder[PATH_MAX], const char *path)
{
    const size_t n = folder_length(path);
    memcpy(folder, n ? path : "./", n ? n : 2);
    folder[n ? n : 2] = '\0';
}

/* target, a link, becomes what it points to. Returns 0 or an errno. */
static int follow_link(char target[PATH_MAX])
{
    char link[PATH_MAX];
    const ssize_t got = readlink(target, link, sizeof link);
    if (got < 0) return errno;
    const size_t base = link[0] == '/' ? 0 : folder_length(target);
    if (base + (size_t)got >= PATH_MAX) return ENAMETOOLONG;
    memcpy(target + base, link, (size_t)got);
    target[base + (size_t)got] = '\0';
    return 0;
}

/* realpath would want the file to exist, but a link may come first and its file later. */
static int follow_links(char target[PATH_MAX], const char *path)
{
    struct stat info;
    int reason = strlen(path) < PATH_MAX ? 0 : ENAMETOOLONG;

    if (reason) return reason;
    memcpy(target, path, strlen(path) + 1);
    for (int i = 0; i <= MOST_LINKS && !reason; i++) {
        /* else it is new, or making it says why not */
        if (lstat(target, &info)) return errno == ENAMETOOLONG || errno == ELOOP ? errno : 0;
        if (!S_ISLNK(info.st_mode)) return 0;
        reason = follow_link(target);
    }
    return reason ? reason : ELOOP;
}

bis_status bis_file_target(char target[PATH_MAX], const char *path, bis_diag *diag)
{
    const int reason = follow_links(target, path);
    return reason ? bis_error(diag, BIS_IO, (bis_loc){path, 0, 0}, "cannot write \"%s\": %s", path, strerror(reason))
                  : BIS_OK;
}

static bool is_same_inode(const struct stat *a, const struct stat *b)
{
    return a->st_dev == b->st_dev && a->st_ino == b->st_ino;
}

bool bis_file_is_same(const char *a, const char *b)
{
    char target_a[PATH_MAX], target_b[PATH_MAX], folder_a[PATH_MAX], folder_b[PATH_MAX];
    struct stat info_a, info_b;
    const bool has_a = stat(a, &info_a) == 0, has_b = stat(b, &info_b) == 0;

    if (has_a && has_b) return is_same_inode(&info_a, &info_b);
    if (has_a || has_b || follow_links(target_a, a) || follow_links(target_b, b)) return false;
    copy_folder(folder_a, target_a);
    copy_folder(folder_b, target_b);
    return stat(folder_a, &info_a) == 0 && stat(folder_b, &info_b) == 0 && is_same_inode(&info_a, &info_b) &&
           strcmp(target_a + folder_length(target_a), target_b + folder_length(target_b)) == 0;
}

/* Where the kernel shows an open file under a name, by which a file without one can be given its name. */
static void name_of_descriptor(char name[32], int fd) { snprintf(name, 32, "/proc/self/fd/%d", fd); }

static bool named_at_once;

void bis_outfile_name_at_once(bool yes) { named_at_once = yes; }

/* A file without a name in the folder of path: whatever ends this process, it leaves nothing behind. -1 where the file
 * system or the kernel has no such thing. */
static int create_unnamed(const char *path)
{
    char folder[PATH_MAX], name[32];
    if (named_at_once) return -1;
    copy_folder(folder, path);
    int fd = open(folder, O_TMPFILE | O_WRONLY | O_CLOEXEC, 0666);
    if (fd < 0) return -1;
    name_of_descriptor(name, fd);
    if (access(name, F_OK) == 0) return fd;
    close(fd); /* no /proc: it could never be named */
    return -1;
}

static void choose_name_beside(char *temp, size_t room, const char *path)
{
    struct timespec now;
    clock_gettime(CLOCK_REALTIME, &now);
    snprintf(temp, room, "%.*s.bis-%lx-%lx", (int)folder_length(path), path, (unsigned long)getpid(),
             (unsigned long)now.tv_nsec);
}

static size_t room_beside(const char *path) { return folder_length(path) + sizeof ".bis-" + 2 * 16 + 1; }

enum { MOST_NAMES = 100 };

/* Create a new file beside path, with the mode that any new file gets (mkstemp would make it private). Returns its
 * descriptor, or -1 with errno. Its name is left in temp, "" where there is none. */
static int create_beside(char *temp, const char *path)
{
    int fd = -1;

    for (int i = 0; i < MOST_NAMES && fd < 0; i++) {
        choose_name_beside(temp, room_beside(path), path);
        fd = open(temp, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (fd < 0 && errno != EEXIST) break;
    }
    if (fd < 0) temp[0] = '\0'; /* not ours to remove */
    return fd;
}

/* An older file keeps its mode. Where the file system knows no modes, it has none to keep. */
static void keep_mode(int fd, const char *path)
{
    struct stat info;
    if (stat(path, &info) == 0) (void)!fchmod(fd, info.st_mode & 07777);
}

bis_status bis_outfile_open(bis_outfile **out, const char *path, bis_diag *diag)
{
    bis_status status = BIS_NOMEM;
    bis_loc at = {path, 0, 0};
    struct stat info;
    char target[PATH_MAX];
    const char *what = stat(path, &info) ? NULL : irregular(info.st_mode);
    int fd = -1;

    *out = NULL;
    if (what) /* renaming onto /dev/null would remove it */
        return bis_error(diag, BIS_IO, at, "cannot write \"%s\": it is %s, must be a regular file or new", path, what);
    if (bis_file_target(target, path, diag)) return BIS_IO;
    bis_outfile *f = bis_alloc(1, sizeof *f);
    if (f) f->path = bis_strdup(target);
    if (f && f->path) f->temp = bis_alloc(room_beside(target), 1);
    if (!f || !f->path || !f->temp) {
        bis_error(diag, status, at, "no memory to write \"%s\"", path);
        goto done;
    }
    fd = create_unnamed(target);
    if (fd < 0) fd = create_beside(f->temp, target);
    if (fd < 0) {
        status = bis_error(diag, BIS_IO, at, "cannot create a file beside \"%s\": %s", target, strerror(errno));
        goto done;
    }
    keep_mode(fd, target);
    f->stream = fdopen(fd, "wb");
    if (!f->stream) {
        status = bis_error(diag, BIS_IO, at, "cannot open a stream to \"%s\": %s", path, strerror(errno));
        close(fd);
        goto done;
    }
    *out = f;
    return BIS_OK;
done:
    bis_outfile_abort(f);
    return status;
}

FILE *bis_outfile_stream(bis_outfile *f) { return f->stream; }

/* All the ways in which the disk can say no. ferror: an earlier write failed, and its errno is gone. */
static const char *first_failure(bis_outfile *f)
{
    bool earlier = ferror(f->stream) != 0;
    bool flushed = fflush(f->stream) == 0 && fsync(fileno(f->stream)) == 0;
    int reason = flushed ? 0 : errno;
    bool closed = fclose(f->stream) == 0;
    if (!reason && !closed) reason = errno;
    f->stream = NULL;
    if (reason) return strerror(reason);
    return earlier ? "a write failed (disk full?)" : NULL;
}

/* The same name for each writer of path: what stands behind .bis- is a hash of its name. */
static void name_beside(char *temp, const char *path)
{
    const int n = (int)folder_length(path);
    const uint64_t hash = bis_fnv1a(BIS_FNV1A, path + n, strlen(path + n));
    snprintf(temp, room_beside(path), "%.*s.bis-%" PRIx64, n, path, hash);
}

/* The file that fd holds gets a name: path itself where that is new. A link replaces nothing, so where there is an
 * older file it is a name beside, which is renamed at once. A process that is killed between the two leaves a whole
 * file of that name, and the next writer of path renames it in its place; that writer may also be faster than one who
 * lives, who then finds it done. Returns 0, or -1 with errno. */
static int give_name(bis_outfile *f, int fd)
{
    char unnamed[32];
    name_of_descriptor(unnamed, fd);
    if (linkat(AT_FDCWD, unnamed, AT_FDCWD, f->path, AT_SYMLINK_FOLLOW) == 0) return 0;
    name_beside(f->temp, f->path);
    for (int i = 0; i < MOST_NAMES && errno == EEXIST; i++) {
        const bool is_ours = linkat(AT_FDCWD, unnamed, AT_FDCWD, f->temp, AT_SYMLINK_FOLLOW) == 0;
        if (!is_ours && errno != EEXIST) return -1;
        if (rename(f->temp, f->path) && errno != ENOENT) return -1;
        if (is_ours) return 0;
        errno = EEXIST;
    }
    return -1;
}

bis_status bis_outfile_commit(bis_outfile *f, bis_diag *diag)
{
    bis_status status = BIS_OK;
    const int fd = f->temp[0] ? -1 : dup(fileno(f->stream)); /* what has no name yet must outlive its stream */
    const bool has_name = f->temp[0];
    const char *failure = first_failure(f);

    if (!failure && (has_name ? rename(f->temp, f->path) : give_name(f, fd))) failure = strerror(errno);
    if (fd >= 0) close(fd);
    if (failure)
        status = bis_error(diag, BIS_IO, (bis_loc){f->path, 0, 0}, "cannot write \"%s\": %s", f->path, failure);
    else
        f->temp[0] = '\0'; /* it is path now */
    bis_outfile_abort(f);
    return status;
}

void bis_outfile_abort(bis_outfile *f)
{
    if (!f) return;
    if (f->stream) fclose(f->stream);
    if (f->temp && f->temp[0]) unlink(f->temp);
    bis_free(f->temp);
    bis_free(f->path);
    bis_free(f);
}

/* ---- names ---- */

char *bis_path_relative_to(const char *of, const char *name)
{
    if (name[0] == '/') return bis_strdup(name);
    size_t folder = folder_length(of), length = strlen(name);
    char *path = bis_alloc(folder + length + 1, 1);
    if (!path) return NULL;
    memcpy(path, of, folder);
    memcpy(path + folder, name, length);
    return path;
}

const char *bis_path_extension(char buf[8], const char *path)
{
    const char *name = path + folder_length(path), *dot = strrchr(name, '.');
    size_t i = 0;

    buf[0] = '\0';
    if (!dot || dot == name || strlen(dot) > 7) return buf;
    for (; dot[i]; i++) buf[i] = dot[i] >= 'A' && dot[i] <= 'Z' ? (char)(dot[i] - 'A' + 'a') : dot[i];
    buf[i] = '\0';
    return buf;
}

/* ---- numbers ---- */

static bool is_digit(char c) { return c >= '0' && c <= '9'; }

/* The C library's parser and its "C" locale. In glibc that locale is a constant: newlocale neither allocates nor
 * fails. */
static double parse_slowly(const char *s, const char **end)
{
    locale_t c = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    char *stop = (char *)(uintptr_t)s;
    double v = c ? strtod_l(s, &stop, c) : 0;
    if (c) freelocale(c);
    *end = stop;
    return v;
}

/* Digits of s, added to *mantissa while they fit 19 decimal digits (below 2^64); *n counts them all but leading
 * zeros. */
static const char *take_digits(const char *s, uint64_t *mantissa, int *n)
{
    for (; is_digit(*s); s++) {
        if (*n < 19) *mantissa = 10 * *mantissa + (uint64_t)(*s - '0');
        if (*mantissa && *n < INT_MAX) ++*n;
    }
    return s;
}

/* "e-12" at s: adds to *exponent and returns what follows; s itself when no exponent stands there. */
static const char *take_exponent(const char *s, long *exponent)
{
    if (*s != 'e' && *s != 'E') return s;
    const char *p = s + 1;
    bool negative = *p == '-';
    if (*p == '-' || *p == '+') p++;
    if (!is_digit(*p)) return s;
    long e = 0;
    for (; is_digit(*p); p++)
        if (e < 100000) e = 10 * e + (*p - '0'); /* far beyond any double, far below overflow */
    *exponent += negative ? -e : e;
    return p;
}

/* Behind 1. or -1.: #IND, #QNAN, #INF, or #J and the like where digits were rounded. So Microsoft's C library wrote
 * what is no number, until 2015. */
static bool is_no_number(const char *p) { return *p == '#' && p[1] >= 'A' && p[1] <= 'Z'; }

double bis_parse_double(const char *s, const char **end)
{
    static const double power[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                   1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
    const char *p = s;
    bool negative = *p == '-';
    uint64_t mantissa = 0;
    int n = 0;
    long exponent = 0;

    *end = s;
    if (*s == ' ' || (*s >= '\t' && *s <= '\r')) return 0;
    if (*p == '-' || *p == '+') p++;
    const char *whole = p;
    p = take_digits(p, &mantissa, &n);
    ptrdiff_t n_digits = p - whole;
    if (*p == '.') {
        const char *fraction = p + 1;
        p = take_digits(fraction, &mantissa, &n);
        exponent = -(long)(p - fraction);
        n_digits += p - fraction;
    }
    bool hexadecimal = n_digits == 1 && *whole == '0' && (*p == 'x' || *p == 'X');
    if (n_digits == 0 || hexadecimal) return parse_slowly(s, end);
    if (mantissa == 1 && is_no_number(p)) {
        for (p++; (*p >= 'A' && *p <= 'Z') || is_digit(*p);) p++;
        *end = p;
        return (double)NAN;
    }
    p = take_exponent(p, &exponent);

    bool exact = n <= 19 && mantissa <= (uint64_t)1 << 53 && exponent >= -22 && exponent <= 22;
    if (!exact) return parse_slowly(s, end);
    double v = exponent < 0 ? (double)mantissa / power[-exponent] : (double)mantissa * power[exponent];
    *end = p;
    return negative ? -v : v;
}

/* %.*g in the "C" locale, for this thread only. */
static void print_digits(char buf[32], int digits, double v)
{
    locale_t c = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    locale_t ours = c ? uselocale(c) : (locale_t)0;
    snprintf(buf, 32, "%.*g", digits, v);
    if (!c) return;
    uselocale(ours);
    freelocale(c);
}

/* DBL_DIG (15) digits survive any normal double, so whatever is shorter appears as 15 digits with zeros, which %g
 * drops.
 * Subnormal numbers hold fewer: there we start from 1. DBL_DECIMAL_DIG (17) always read back. */
const char *bis_format_double(char buf[32], double v)
{
    const char *end;
    for (int digits = fabs(v) < DBL_MIN ? 1 : DBL_DIG; digits <= DBL_DECIMAL_DIG; digits++) {
        print_digits(buf, digits, v);
        if (bis_parse_double(buf, &end) == v) break;
    }
    return buf;
}

const char *bis_format_float(char buf[32], float v)
{
    const char *end;
    for (int digits = fabsf(v) < FLT_MIN ? 1 : FLT_DIG; digits <= FLT_DECIMAL_DIG; digits++) {
        print_digits(buf, digits, (double)v);
        if ((float)bis_parse_double(buf, &end) == v) break;
    }
    return buf;
}
