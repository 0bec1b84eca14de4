/* SPDX-License-Identifier: BSD-2-Clause */
/* file: whole files in, whole files out, and numbers that no locale can change. Files are made below
 * build/test_file/. */
#include "bis/base/file.h"
#include "bis/base/mem.h"
#include "bis/thesis/rng.h"
#include "claim.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <float.h>
#include <locale.h>
#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#define DIR_NAME "build/test_file"

static int make_folder(void **state)
{
    bis_outfile_name_at_once(false);
    mkdir("build", 0777);
    if (system("rm -rf " DIR_NAME)) return -1;
    return mkdir(DIR_NAME, 0777);
}

static void write_file(const char *path, const void *bytes, size_t n)
{
    FILE *f = fopen(path, "wb");
    assert_non_null(f);
    assert_int_equal(fwrite(bytes, 1, n, f), n);
    assert_int_equal(fclose(f), 0);
}

static void assert_file_is(const char *path, const char *text)
{
    unsigned char *data;
    size_t size;
    assert_int_equal(bis_file_read(&data, &size, path, (bis_loc){0}, NULL), BIS_OK);
    assert_int_equal(size, strlen(text));
    assert_memory_equal(data, text, size + 1);
    bis_free(data);
}

static size_t files_in_folder(void)
{
    size_t n = 0;
    DIR *d = opendir(DIR_NAME);
    assert_non_null(d);
    for (struct dirent *e = readdir(d); e; e = readdir(d))
        n += strcmp(e->d_name, ".") && strcmp(e->d_name, "..");
    closedir(d);
    return n;
}

/* ---- in ---- */

static void files_of_any_size_are_read_whole_and_end_in_a_zero(void **state)
{
    const size_t sizes[] = {0, 1, 4095, 4096, 4097, 4098, 8192, 1000000};
    unsigned char *bytes = bis_alloc(1000000, 1);
    bis_rng r;
    bis_rng_init(&r, 1, 0, 0, 0);
    for (size_t i = 0; i < 1000000; i++)
        bytes[i] = (unsigned char)bis_rng_u64(&r);
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        unsigned char *data;
        size_t size;
        write_file(DIR_NAME "/sized", bytes, sizes[i]);
        errno = i % 2 ? EINTR : EBADF; /* of a call long before: nobody has set it back */
        assert_int_equal(bis_file_read(&data, &size, DIR_NAME "/sized", (bis_loc){0}, NULL), BIS_OK);
        assert_int_equal(size, sizes[i]);
        assert_memory_equal(data, bytes, size);
        assert_int_equal(data[size], 0);
        bis_free(data);
    }
    bis_free(bytes);
}

static void expect_refusal(const char *path, bis_loc at, const char *message)
{
    bis_diag d = {0};
    unsigned char *data;
    size_t size = 7;
    assert_int_equal(bis_file_read(&data, &size, path, at, &d), BIS_IO);
    assert_null(data);
    assert_int_equal(size, 0);
    assert_int_equal(d.n, 1);
    assert_string_equal(d.messages[0].text, message);
    bis_diag_clear(&d);
}

static void what_is_no_regular_file_is_refused_with_its_kind(void **state)
{
    assert_int_equal(mkfifo(DIR_NAME "/fifo", 0666), 0); /* nobody writes to it: must not hang */
    expect_refusal(DIR_NAME "/fifo", (bis_loc){0},
                   DIR_NAME "/fifo: error: \"" DIR_NAME "/fifo\" is a pipe, must be a regular file");
    expect_refusal(DIR_NAME, (bis_loc){0}, DIR_NAME ": error: \"" DIR_NAME "\" is a folder, must be a regular file");
    expect_refusal("/dev/zero", (bis_loc){0}, "/dev/zero: error: \"/dev/zero\" is a device, must be a regular file");
    unlink(DIR_NAME "/fifo");
}

/* 5 bytes and 20000, more than the first read asks for; fd stays open. */
static void an_open_pipe_is_read_to_its_end(void **state)
{
    for (size_t n = 5; n <= 20000; n += 19995) {
        bis_diag d = {0};
        unsigned char *data;
        size_t size;
        int ends[2];
        assert_int_equal(pipe(ends), 0);
        for (size_t i = 0; i < n; i++) assert_int_equal(write(ends[1], &(char){(char)(i % 251)}, 1), 1);
        close(ends[1]);
        assert_int_equal(bis_file_read_open(&data, &size, ends[0], "<pipe>", NULL), BIS_OK);
        assert_int_equal(size, n);
        for (size_t i = 0; i <= n; i++) assert_int_equal(data[i], i < n ? i % 251 : 0);
        bis_free(data);
        assert_int_equal(close(ends[0]), 0);
        assert_int_equal(bis_file_read_open(&data, &size, ends[0], "<pipe>", &d), BIS_IO);
        assert_true(!data && size == 0);
        assert_string_equal(d.messages[0].text, "<pipe>: error: cannot read \"<pipe>\": Bad file descriptor");
        bis_diag_clear(&d);
    }
}

static void a_missing_file_is_reported_where_it_was_named(void **state)
{
    expect_refusal("no/such", (bis_loc){"s.txt", 3, 14},
                   "s.txt:3:14: error: cannot open \"no/such\": No such file or directory");
    expect_refusal("no/such", (bis_loc){0}, "no/such: error: cannot open \"no/such\": No such file or directory");
}

/* ---- out ---- */

static void commit_puts_the_new_file_in_the_place_of_the_old_one(void **state)
{
    bis_outfile *f;
    write_file(DIR_NAME "/out", "old", 3);
    size_t n = files_in_folder();
    assert_int_equal(bis_outfile_open(&f, DIR_NAME "/out", NULL), BIS_OK);
    fprintf(bis_outfile_stream(f), "new");
    assert_file_is(DIR_NAME "/out", "old");
    assert_int_equal(bis_outfile_commit(f, NULL), BIS_OK);
    assert_file_is(DIR_NAME "/out", "new");
    assert_int_equal(files_in_folder(), n);
}

static void a_new_file_has_the_mode_that_the_umask_leaves(void **state)
{
    struct stat info;
    bis_outfile *f;
    mode_t before = umask(027);
    assert_int_equal(bis_outfile_open(&f, DIR_NAME "/mode", NULL), BIS_OK);
    assert_int_equal(bis_outfile_commit(f, NULL), BIS_OK);
    umask(before);
    assert_int_equal(stat(DIR_NAME "/mode", &info), 0);
    assert_int_equal(info.st_mode & 0777, 0640);
    before = umask(0);
    assert_int_equal(bis_outfile_open(&f, DIR_NAME "/open", NULL), BIS_OK);
    assert_int_equal(bis_outfile_commit(f, NULL), BIS_OK);
    umask(before);
    assert_int_equal(stat(DIR_NAME "/open", &info), 0);
    assert_int_equal(info.st_mode & 0777, 0666);
}

static void abort_leaves_the_old_file_and_nothing_else(void **state)
{
    bis_outfile *f;
    write_file(DIR_NAME "/kept", "old", 3);
    size_t n = files_in_folder();
    assert_int_equal(bis_outfile_open(&f, DIR_NAME "/kept", NULL), BIS_OK);
    fprintf(bis_outfile_stream(f), "half");
    bis_outfile_abort(f);
    bis_outfile_abort(NULL);
    assert_file_is(DIR_NAME "/kept", "old");
    assert_int_equal(files_in_folder(), n);
}

/* The file size limit stands in for a full disk: a write beyond it fails in the same way. */
static void a_full_disk_keeps_the_old_file_and_removes_the_new_one(void **state)
{
    struct rlimit old_limit, limit;
    char block[4096] = {0};
    const int n_blocks[] = {1, 100}; /* fails when flushed at last; fails on the way, seen by ferror alone */
    getrlimit(RLIMIT_FSIZE, &old_limit);
    limit = old_limit;
    limit.rlim_cur = 1000;
    void (*handler)(int) = signal(SIGXFSZ, SIG_IGN);

    for (int i = 0; i < 2; i++) {
        bis_outfile *f;
        bis_diag d = {0};
        write_file(DIR_NAME "/full", "old", 3);
        size_t n = files_in_folder();
        assert_int_equal(bis_outfile_open(&f, DIR_NAME "/full", &d), BIS_OK);
        setrlimit(RLIMIT_FSIZE, &limit);
        for (int j = 0; j < n_blocks[i]; j++)
            (void)!fwrite(block, 1, sizeof block - 1, bis_outfile_stream(f));
        bis_status status = bis_outfile_commit(f, &d);
        setrlimit(RLIMIT_FSIZE, &old_limit);

        assert_int_equal(status, BIS_IO);
        assert_int_equal(d.n, 1);
        assert_non_null(strstr(d.messages[0].text, DIR_NAME "/full: error: cannot write \"" DIR_NAME "/full\": "));
        assert_file_is(DIR_NAME "/full", "old");
        assert_int_equal(files_in_folder(), n);
        bis_diag_clear(&d);
    }
    signal(SIGXFSZ, handler);
}

static void a_place_that_cannot_be_written_is_refused_at_once(void **state)
{
    bis_diag d = {0};
    bis_outfile *f;
    assert_int_equal(bis_outfile_open(&f, "no/such/folder/x", &d), BIS_IO);
    assert_null(f);
    assert_int_equal(bis_outfile_open(&f, DIR_NAME, &d), BIS_IO);
    assert_int_equal(bis_outfile_open(&f, "/dev/null", &d), BIS_IO); /* not replaced by a file, whoever we are */
    assert_string_equal(d.messages[0].text, "no/such/folder/x: error: cannot create a file beside "
                                            "\"no/such/folder/x\": No such file or directory");
    assert_string_equal(d.messages[1].text, DIR_NAME ": error: cannot write \"" DIR_NAME
                                                     "\": it is a folder, must be a regular file or new");
    bis_diag_clear(&d);
}

static void through_a_link_the_linked_file_is_replaced(void **state)
{
    struct stat info;
    bis_outfile *f;
    write_file(DIR_NAME "/target", "old", 3);
    assert_int_equal(symlink("target", DIR_NAME "/link"), 0);
    assert_int_equal(bis_outfile_open(&f, DIR_NAME "/link", NULL), BIS_OK);
    fprintf(bis_outfile_stream(f), "new");
    assert_int_equal(bis_outfile_commit(f, NULL), BIS_OK);
    assert_int_equal(lstat(DIR_NAME "/link", &info), 0);
    assert_true(S_ISLNK(info.st_mode));
    assert_file_is(DIR_NAME "/target", "new");
}

static void write_new(const char *path)
{
    bis_outfile *f;
    bis_diag d = {0};
    if (bis_outfile_open(&f, path, &d)) fail_msg("%s", d.messages[0].text);
    fprintf(bis_outfile_stream(f), "new");
    assert_int_equal(bis_outfile_commit(f, NULL), BIS_OK);
}

static void assert_link(const char *path)
{
    struct stat info;
    assert_int_equal(lstat(path, &info), 0);
    assert_true(S_ISLNK(info.st_mode));
}

/* Links may be made before what they point to: one, several, absolute, through a folder. */
static void through_a_dangling_link_its_target_is_made(void **state)
{
    char folder[PATH_MAX], absolute[PATH_MAX + 16];
    assert_non_null(realpath(DIR_NAME, folder));
    snprintf(absolute, sizeof absolute, "%s/made3", folder);
    mkdir(DIR_NAME "/in", 0777);
    assert_int_equal(symlink("made1", DIR_NAME "/dangling1"), 0);
    assert_int_equal(symlink("in/dangling", DIR_NAME "/dangling2"), 0);
    assert_int_equal(symlink("../made2", DIR_NAME "/in/dangling"), 0);
    assert_int_equal(symlink(absolute, DIR_NAME "/dangling3"), 0);
    for (int i = 1; i <= 3; i++) {
        char path[64], made[64];
        snprintf(path, sizeof path, DIR_NAME "/dangling%d", i);
        snprintf(made, sizeof made, DIR_NAME "/made%d", i);
        write_new(path);
        assert_link(path);
        assert_file_is(made, "new");
    }
    assert_link(DIR_NAME "/in/dangling");
}

static void a_ring_of_links_and_a_long_name_are_refused(void **state)
{
    bis_outfile *f;
    bis_diag d = {0};
    char path[512];
    assert_int_equal(symlink("ring2", DIR_NAME "/ring1"), 0);
    assert_int_equal(symlink("ring1", DIR_NAME "/ring2"), 0);
    assert_int_equal(bis_outfile_open(&f, DIR_NAME "/ring1", &d), BIS_IO);
    assert_string_equal(d.messages[0].text,
        DIR_NAME "/ring1: error: cannot write \"" DIR_NAME "/ring1\": Too many levels of symbolic links");
    snprintf(path, sizeof path, DIR_NAME "/%0300d", 0);
    assert_int_equal(bis_outfile_open(&f, path, &d), BIS_IO);
    assert_non_null(strstr(d.messages[1].text, "File name too long"));
    bis_diag_clear(&d);
}

static void an_older_file_keeps_its_mode(void **state)
{
    static const mode_t modes[] = {0600, 0644, 0400, 0755, 0666};
    for (int i = 0; i < 5; i++) {
        struct stat info;
        write_file(DIR_NAME "/modes", "old", 3);
        assert_int_equal(chmod(DIR_NAME "/modes", modes[i]), 0);
        write_new(DIR_NAME "/modes");
        assert_file_is(DIR_NAME "/modes", "new");
        assert_int_equal(stat(DIR_NAME "/modes", &info), 0);
        assert_int_equal(info.st_mode & 07777, modes[i]);
    }
}

/* By any spelling, through links hard and soft, and before they exist. */
static void one_file_under_two_names_is_known(void **state)
{
    write_file(DIR_NAME "/there", "x", 1);
    write_file(DIR_NAME "/other", "x", 1);
    assert_int_equal(symlink("there", DIR_NAME "/soft"), 0);
    assert_int_equal(link(DIR_NAME "/there", DIR_NAME "/hard"), 0);
    assert_int_equal(symlink("to_come", DIR_NAME "/early"), 0);
    assert_int_equal(symlink(".", DIR_NAME "/here"), 0);
    const struct { const char *a, *b; bool same; } cases[] = {
        {"there", "there", true},          {"there", "./there", true},      {"there", "soft", true},
        {"there", "hard", true},
        {"there", "here/there", true},     {"there", "other", false},       {"to_come", "to_come", true},
        {"to_come", "here/to_come", true}, {"to_come", "early", true},      {"here/early", "to_come", true},
        {"to_come", "to_com", false},      {"to_come", "there", false},     {"in_no/folder", "in_no/folder", false},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char a[64], b[64];
        snprintf(a, sizeof a, DIR_NAME "/%s", cases[i].a);
        snprintf(b, sizeof b, DIR_NAME "/%s", cases[i].b);
        if (bis_file_is_same(a, b) != cases[i].same || bis_file_is_same(b, a) != cases[i].same)
            fail_msg("%s and %s", a, b);
    }
    /* names without a folder, of files to come: they stand in the working folder */
    assert_true(bis_file_is_same("no_such_file", "./no_such_file"));
    assert_true(bis_file_is_same("no_such_file", "no_such_file"));
    assert_false(bis_file_is_same("no_such_file", "no_such_filf"));
    assert_false(bis_file_is_same("no_such_file", DIR_NAME "/no_such_file"));
}

static bool has_unnamed_files(void)
{
    const int fd = open(DIR_NAME, O_TMPFILE | O_WRONLY, 0600);
    if (fd >= 0) close(fd);
    return fd >= 0;
}

/* A killed process has no chance to remove anything. In this folder's file system or not at all. */
static void a_killed_process_leaves_the_old_file_and_nothing_else(void **state)
{
    if (!has_unnamed_files()) skip();
    write_file(DIR_NAME "/survivor", "old", 3);
    const size_t n = files_in_folder();
    for (int i = 0; i < 2; i++) {
        const char *const names[] = {DIR_NAME "/survivor", DIR_NAME "/never"};
        int status;
        fflush(NULL);
        const pid_t pid = fork();
        assert_true(pid >= 0);
        if (pid == 0) {
            bis_outfile *f;
            if (bis_outfile_open(&f, names[i], NULL)) _exit(1);
            for (int k = 0; k < 10000; k++) fprintf(bis_outfile_stream(f), "half");
            fflush(bis_outfile_stream(f));
            kill(getpid(), SIGKILL);
        }
        assert_int_equal(waitpid(pid, &status, 0), pid);
        assert_true(WIFSIGNALED(status));
        assert_int_equal(files_in_folder(), n);
        assert_file_is(DIR_NAME "/survivor", "old");
    }
}

/* Stands in the place of the system's: a test may be killed here, or another process may do something first. */
static void (*before_rename)(const char *from, const char *to);

int rename(const char *from, const char *to)
{
    if (before_rename) before_rename(from, to);
    return renameat(AT_FDCWD, from, AT_FDCWD, to);
}

static void be_killed(const char *from, const char *to)
{
    kill(getpid(), SIGKILL);
}

/* Returns the status of a child that writes `text` to path with `before` in front of its renaming. */
static int write_in_child(const char *path, const char *text, void (*before)(const char *, const char *))
{
    int status;
    fflush(NULL);
    const pid_t pid = fork();
    assert_true(pid >= 0);
    if (pid == 0) {
        bis_outfile *f;
        before_rename = before;
        if (bis_outfile_open(&f, path, NULL)) _exit(1);
        fputs(text, bis_outfile_stream(f));
        _exit(bis_outfile_commit(f, NULL) ? 2 : 0);
    }
    assert_int_equal(waitpid(pid, &status, 0), pid);
    return status;
}

/* Two processes are killed at the worst moment: one left-over between them, and none after the next that is not. Names
 * as long as the file system takes, too. A neighbour whose name has the same
 * letters is another file. */
static void what_a_kill_while_renaming_leaves_the_next_writer_removes(void **state)
{
    char longest[sizeof DIR_NAME + 256];
    snprintf(longest, sizeof longest, DIR_NAME "/%0255d", 7);
    const char *const names[] = {DIR_NAME "/window", longest};
    if (!has_unnamed_files()) skip();
    for (int i = 0; i < 2; i++) {
        write_file(names[i], "old", 3);
        write_file(DIR_NAME "/wodniw", "old", 3);
        const size_t n = files_in_folder();
        assert_true(WIFSIGNALED(write_in_child(names[i], "never", be_killed)));
        assert_true(WIFSIGNALED(write_in_child(names[i], "nor this", be_killed)));
        assert_file_is(names[i], "old");
        assert_int_equal(files_in_folder(), n + 1);
        assert_int_equal(write_in_child(DIR_NAME "/wodniw", "new", NULL), 0);
        assert_file_is(DIR_NAME "/wodniw", "new");
        assert_int_equal(files_in_folder(), n + 1);
        assert_int_equal(write_in_child(names[i], "new", NULL), 0);
        assert_file_is(names[i], "new");
        assert_int_equal(files_in_folder(), n);
    }
}

/* Eight processes replace one file a hundred times each, with 1000 letters of their own. */
static void many_writers_leave_one_whole_file(void **state)
{
    pid_t pids[8];
    if (!has_unnamed_files()) skip();
    write_file(DIR_NAME "/many", "old", 3);
    const size_t n = files_in_folder();
    fflush(NULL);
    for (int i = 0; i < 8; i++) {
        pids[i] = fork();
        if (pids[i]) continue;
        for (int k = 0; k < 100; k++) {
            bis_outfile *f;
            if (bis_outfile_open(&f, DIR_NAME "/many", NULL)) _exit(1);
            for (int j = 0; j < 1000; j++) fputc('a' + i, bis_outfile_stream(f));
            if (bis_outfile_commit(f, NULL)) _exit(2);
        }
        _exit(0);
    }
    for (int i = 0; i < 8; i++) {
        int status;
        assert_int_equal(waitpid(pids[i], &status, 0), pids[i]);
        assert_int_equal(status, 0);
    }
    char text[1001];
    FILE *in = fopen(DIR_NAME "/many", "r");
    assert_non_null(in);
    assert_int_equal(fread(text, 1, sizeof text, in), 1000);
    fclose(in);
    for (int j = 0; j < 1000; j++) assert_true(text[j] == text[0] && text[0] >= 'a' && text[0] <= 'h');
    assert_int_equal(files_in_folder(), n);
}

/* All of it once more, as where files have a name from the beginning. */
static void the_same_holds_where_no_file_can_be_unnamed(void **state)
{
    void (*const tests[])(void **) = {
        commit_puts_the_new_file_in_the_place_of_the_old_one,
        a_new_file_has_the_mode_that_the_umask_leaves,
        abort_leaves_the_old_file_and_nothing_else,
        a_full_disk_keeps_the_old_file_and_removes_the_new_one,
        a_place_that_cannot_be_written_is_refused_at_once,
        through_a_link_the_linked_file_is_replaced,
        through_a_dangling_link_its_target_is_made,
        a_ring_of_links_and_a_long_name_are_refused,
        an_older_file_keeps_its_mode,
    };
    assert_int_equal(make_folder(state), 0);
    bis_outfile_name_at_once(true);
    for (size_t i = 0; i < sizeof tests / sizeof *tests; i++) tests[i](state);
    bis_outfile_name_at_once(false);
}

/* ---- names ---- */

static void a_name_is_relative_to_the_file_that_uses_it(void **state)
{
    const char *const cases[][3] = {{"a/b/s.txt", "m.hdr", "a/b/m.hdr"}, {"s.txt", "m.hdr", "m.hdr"},
                                    {"/s.txt", "m.hdr", "/m.hdr"},       {"a/s.txt", "/m.hdr", "/m.hdr"},
                                    {"a/s.txt", "../m.hdr", "a/../m.hdr"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char *path = bis_path_relative_to(cases[i][0], cases[i][1]);
        assert_string_equal(path, cases[i][2]);
        bis_free(path);
    }
}

static void an_extension_is_what_follows_the_last_dot_of_the_name(void **state)
{
    const char *const cases[][2] = {{"a.EXR", ".exr"}, {"a.b/c", ""},          {"a.tar.gz", ".gz"}, {"", ""},
                                    {"a/.hdr", ""},    {"a.abcdef", ".abcdef"}, {"a.abcdefg", ""},   {"a.", "."}};
    char buf[8];
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        assert_string_equal(bis_path_extension(buf, cases[i][0]), cases[i][1]);
    assert_string_equal(bis_path_extension(buf, "a.AZaz@["), ".azaz@[");
}

/* ---- numbers ---- */

static void assert_parses_like_strtod(const char *s)
{
    const char *end;
    char *expected_end;
    double expected = strtod(s, &expected_end), v = bis_parse_double(s, &end);
    if (end != expected_end || (memcmp(&v, &expected, sizeof v) && !(isnan(v) && isnan(expected))))
        fail_msg("\"%s\": %a, %d bytes; strtod: %a, %d bytes", s, v, (int)(end - s), expected, (int)(expected_end - s));
}

static void every_form_of_number_parses_as_by_strtod(void **state)
{
    const char *const forms[] = {"0", "-0", "+0.0", "1", ".5", "5.", "-.5e1", "1e", "1e+", "1e-x", "1e5x", "1.5.5", ".",
        "-", "+", "", "e5", ".e5", "x", "--1", "0x10", "0x1.8p3", "0xg", "00x1", "inf", "-INF", "infinity", "nan",
        "-nan", "nan(1)", "1e22", "1e23", "1e-22", "1e-23", "9007199254740991", "9007199254740992", "9007199254740993",
        "9007199254740993e0", "18446744073709551615", "18446744073709551616", "99999999999999999999", "1e400", "-1e400",
        "1e-400", "4.9406564584124654e-324", "2.4703282292062327e-324", "2.2250738585072011e-308",
        "1.7976931348623158e308", "0.000000000000000000000000000001e30", "100000000000000000000000000000e-29",
        "1e99999999999999999999", "0e99999999999999999999", "1e-99999999999999999999",
        "000000000000000000000000000000.1", "123456789012345678901234567890",
        "0.1000000000000000055511151231257827021181583404541015625"};
    for (size_t i = 0; i < sizeof forms / sizeof *forms; i++)
        assert_parses_like_strtod(forms[i]);
}

static void random_decimals_parse_as_by_strtod(void **state)
{
    bis_rng r;
    char s[64];
    bis_rng_init(&r, 2, 0, 0, 0);
    for (int i = 0; i < 200000; i++) {
        uint64_t digits = bis_rng_u64(&r) >> bis_rng_below(&r, 64);
        int exponent = (int)bis_rng_below(&r, 70) - 35;
        snprintf(s, sizeof s, i % 2 ? "%llu.%llue%d" : "-%llu.%06llu", (unsigned long long)(digits >> 20),
                 (unsigned long long)(digits & 0xfffff), exponent);
        assert_parses_like_strtod(s);
    }
}

static void assert_shortest_double(double v)
{
    char buf[32], other[32];
    bis_format_double(buf, v);
    assert_true(strtod(buf, NULL) == v);
    size_t n_digits = strspn(buf, "-0123456789.");
    for (int digits = 1; digits < 17; digits++) {
        snprintf(other, sizeof other, "%.*g", digits, v);
        if (strtod(other, NULL) == v && strspn(other, "-0123456789.") < n_digits)
            fail_msg("%s is longer than %s", buf, other);
    }
}

static void formatted_numbers_are_the_shortest_that_read_back(void **state)
{
    char buf[32];
    bis_rng r;
    bis_rng_init(&r, 3, 0, 0, 0);
    for (int i = 0; i < 5000; i++) {
        union {
            uint64_t bits;
            double v;
        } d = {bis_rng_u64(&r)};
        union {
            uint32_t bits;
            float v;
        } f = {(uint32_t)bis_rng_u64(&r)};
        if (isfinite(d.v)) assert_shortest_double(d.v);
        if (isfinite(f.v)) assert_true(strtof(bis_format_float(buf, f.v), NULL) == f.v);
    }
    assert_string_equal(bis_format_double(buf, 0.1), "0.1");
    assert_string_equal(bis_format_double(buf, 1.0 / 3), "0.3333333333333333");
    assert_string_equal(bis_format_double(buf, 5e-324), "5e-324");
    assert_string_equal(bis_format_double(buf, -DBL_MAX), "-1.7976931348623157e+308");
    assert_string_equal(bis_format_double(buf, 0), "0");
    assert_string_equal(bis_format_float(buf, 0.1f), "0.1");
    assert_string_equal(bis_format_float(buf, 1e-45f), "1e-45");
    assert_string_equal(bis_format_float(buf, 16777216.0f), "16777216");
}

/* Any locale with a decimal comma will do; where none is installed, one is made, where its source is installed. */
static void a_decimal_comma_changes_nothing(void **state)
{
    const char *const commas[] = {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "nl_NL.UTF-8", "de_DE"};
    const char *name = NULL, *end;
    char buf[32];
    for (size_t i = 0; !name && i < sizeof commas / sizeof *commas; i++)
        name = setlocale(LC_ALL, commas[i]);
    if (!name && !system("localedef -c -i de_DE -f UTF-8 " DIR_NAME "/de_DE.UTF-8 >/dev/null 2>&1")) {
        setenv("LOCPATH", DIR_NAME, 1);
        name = setlocale(LC_ALL, "de_DE.UTF-8");
    }
    if (!name) {
        print_message("skipped: no locale with a decimal comma is installed\n");
        skip();
    }
    snprintf(buf, sizeof buf, "%g", 0.5);
    bool has_comma = strcmp(buf, "0,5") == 0;
    double fast = bis_parse_double("0.5", &end), slow = bis_parse_double("0.12345678901234567890123", &end);
    bool all_read = *end == '\0';
    bis_format_double(buf, 1.5);
    setlocale(LC_ALL, "C");
    assert_true(has_comma);
    assert_true(fast == 0.5 && slow == 0.12345678901234567890123 && all_read);
    assert_string_equal(buf, "1.5");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(files_of_any_size_are_read_whole_and_end_in_a_zero),
        cmocka_unit_test(what_is_no_regular_file_is_refused_with_its_kind),
        cmocka_unit_test(an_open_pipe_is_read_to_its_end),
        cmocka_unit_test(a_missing_file_is_reported_where_it_was_named),
        cmocka_unit_test(commit_puts_the_new_file_in_the_place_of_the_old_one),
        cmocka_unit_test(a_new_file_has_the_mode_that_the_umask_leaves),
        cmocka_unit_test(abort_leaves_the_old_file_and_nothing_else),
        cmocka_unit_test(a_full_disk_keeps_the_old_file_and_removes_the_new_one),
        cmocka_unit_test(a_place_that_cannot_be_written_is_refused_at_once),
        cmocka_unit_test(through_a_link_the_linked_file_is_replaced),
        cmocka_unit_test(through_a_dangling_link_its_target_is_made),
        cmocka_unit_test(a_ring_of_links_and_a_long_name_are_refused),
        cmocka_unit_test(an_older_file_keeps_its_mode),
        cmocka_unit_test(one_file_under_two_names_is_known),
        cmocka_unit_test(a_killed_process_leaves_the_old_file_and_nothing_else),
        cmocka_unit_test(what_a_kill_while_renaming_leaves_the_next_writer_removes),
        cmocka_unit_test(many_writers_leave_one_whole_file),
        cmocka_unit_test(the_same_holds_where_no_file_can_be_unnamed),
        cmocka_unit_test(a_name_is_relative_to_the_file_that_uses_it),
        cmocka_unit_test(an_extension_is_what_follows_the_last_dot_of_the_name),
        cmocka_unit_test(every_form_of_number_parses_as_by_strtod),
        cmocka_unit_test(random_decimals_parse_as_by_strtod),
        cmocka_unit_test(formatted_numbers_are_the_shortest_that_read_back),
        cmocka_unit_test(a_decimal_comma_changes_nothing),
    };
    return cmocka_run_group_tests(tests, make_folder, NULL);
}
