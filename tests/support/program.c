/* SPDX-License-Identifier: BSD-2-Clause */
/* program: fork, exec, files for the streams. One run at a time. */
#include "program.h"

#include "bis/files/image_file.h"
#include "claim.h"

#include <dirent.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

static const char out_path[] = "build/program.out", err_path[] = "build/program.err";

static void redirect(int fd, const char *path)
{
    int file = open(path, O_WRONLY | O_CREAT | O_TRUNC, 0666);
    if (file < 0 || dup2(file, fd) < 0) _exit(126);
    close(file);
}

/* In the child. An argument ">PATH" sends standard output there. */
static void become_program(long file_limit, const char *arguments)
{
    static char words[1 << 14];
    const char *program = getenv("BIS_PROGRAM");
    char *argv[128] = {0};
    int argc = 0;

    redirect(STDOUT_FILENO, out_path);
    redirect(STDERR_FILENO, err_path);
    snprintf(words, sizeof words, "%s %s", program && *program ? program : "build/release/bis", arguments);
    for (char *word = strtok(words, " "); word && argc < 127; word = strtok(NULL, " ")) {
        if (*word == '>')
            redirect(STDOUT_FILENO, word + 1);
        else
            argv[argc++] = word;
    }
    if (file_limit > 0) {
        const struct rlimit limit = {(rlim_t)file_limit, (rlim_t)file_limit};
        setrlimit(RLIMIT_FSIZE, &limit);
    }
    execv(argv[0], argv);
    _exit(127);
}

static pid_t start(long file_limit, const char *arguments)
{
    fflush(stdout);
    fflush(stderr);
    pid_t pid = fork();
    assert_true(pid >= 0);
    if (pid == 0) become_program(file_limit, arguments);
    return pid;
}

static void read_text(char *buf, size_t size, const char *path)
{
    FILE *f = fopen(path, "r");
    buf[0] = '\0';
    if (!f) return;
    buf[fread(buf, 1, size - 1, f)] = '\0';
    fclose(f);
}

void program_finish(program_run *run, pid_t pid)
{
    int status;
    assert_int_equal(waitpid(pid, &status, 0), pid);
    run->exit_status = WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
    read_text(run->output, sizeof run->output, out_path);
    read_text(run->messages, sizeof run->messages, err_path);
    if (run->exit_status == 127) fail_msg("no program at $BIS_PROGRAM or build/release/bis");
    if (strstr(run->messages, "error in bis itself")) fail_msg("%s", run->messages); /* whatever the test is about */
}

pid_t program_start(const char *arguments) { return start(0, arguments); }

void program_run_limited(program_run *run, long file_limit, const char *arguments)
{
    program_finish(run, start(file_limit, arguments));
}

void program_runf(program_run *run, const char *fmt, ...)
{
    char arguments[8192];
    va_list args;
    va_start(args, fmt);
    vsnprintf(arguments, sizeof arguments, fmt, args);
    va_end(args);
    program_run_limited(run, 0, arguments);
}

void program_expect(program_run *run, int exit_status, const char *fmt, ...)
{
    char arguments[8192];
    va_list args;
    va_start(args, fmt);
    vsnprintf(arguments, sizeof arguments, fmt, args);
    va_end(args);
    program_run_limited(run, 0, arguments);
    if (run->exit_status != exit_status) {
        fail_msg("bis %s: exit status %d instead of %d\n%s%s", arguments, run->exit_status, exit_status, run->messages,
            run->output);
    }
}

void program_expect_only_the_result(const program_run *run)
{
    static const char begin[] = "bis: wrote ";
    const char *end = strchr(run->messages, '\n');
    if (strncmp(run->messages, begin, sizeof begin - 1) != 0 || !end || end[1])
        fail_msg("standard error holds: %s", run->messages);
}

/* Linux tells which signals a process catches: "SigCgt: 0000000000000002". */
void program_wait_for_handler(pid_t pid, int number)
{
    char path[64], text[4096];
    const struct timespec pause = {0, 1000000};

    snprintf(path, sizeof path, "/proc/%d/status", (int)pid);
    for (int i = 0; i < 60000; i++) {
        read_text(text, sizeof text, path);
        const char *mask = strstr(text, "SigCgt:");
        if (mask && strtoull(mask + 7, NULL, 16) >> (number - 1) & 1) return;
        nanosleep(&pause, NULL);
    }
    fail_msg("the program never caught signal %d", number);
}

void program_write_file(const char *path, const char *text)
{
    FILE *f = fopen(path, "w");
    assert_non_null(f);
    assert_true(fputs(text, f) >= 0);
    assert_int_equal(fclose(f), 0);
}

static void write_map(const char *path)
{
    bis_image image;
    assert_int_equal(bis_image_init(&image, 8, 4, NULL), BIS_OK);
    for (int i = 0; i < 32; i++) image.pixels[i] = (rgb){0.2f, 0.25f, 0.1f + 0.01f * (float)i};
    image.pixels[9] = (rgb){50, 40, 30};
    assert_int_equal(bis_image_save(&image, path, NULL), BIS_OK);
    bis_image_clear(&image);
}

const char program_world[] =
    "Camera \"perspective\" \"float fov\" 60\n"
    "WorldBegin\n"
    "AttributeBegin Rotate -90 1 0 0 LightSource \"infinite\" \"string filename\" \"map.pfm\" AttributeEnd\n"
    "Material \"phong\" \"rgb Kd\" [.5 .4 .3] \"rgb Ks\" [.2 .2 .2] \"float exponent\" 20\n"
    "AttributeBegin Translate 0 0 4 Shape \"sphere\" AttributeEnd\n"
    "Shape \"trianglemesh\" \"integer indices\" [0 1 2 0 2 3] \"point3 P\" [-9 -1 -9  9 -1 -9  9 -1 9  -9 -1 9]\n";

void program_write_scene(const char *folder, const char *options)
{
    static const char format[] =
        "Film \"rgb\" \"integer xresolution\" 24 \"integer yresolution\" 16 \"string filename\" \"%s/film.exr\"\n"
        "%sIntegrator \"sir\" \"integer candidates\" 20 \"integer shadowrays\" 2\n%s";
    char text[2048], path[512];

    snprintf(text, sizeof text, format, folder, options, program_world);
    snprintf(path, sizeof path, "%s/scene.txt", folder);
    program_write_file(path, text);
    snprintf(path, sizeof path, "%s/map.pfm", folder);
    write_map(path);
}

bool program_exists(const char *path) { return access(path, F_OK) == 0; }

int program_count_files(const char *folder)
{
    DIR *dir = opendir(folder);
    int n = 0;
    assert_non_null(dir);
    for (const struct dirent *e = readdir(dir); e; e = readdir(dir))
        n += strcmp(e->d_name, ".") != 0 && strcmp(e->d_name, "..") != 0;
    closedir(dir);
    return n;
}

void program_folder(const char *folder)
{
    char path[512];
    mkdir("build", 0777);
    mkdir(folder, 0777);
    DIR *dir = opendir(folder);
    assert_non_null(dir);
    for (const struct dirent *e = readdir(dir); e; e = readdir(dir)) {
        snprintf(path, sizeof path, "%s/%s", folder, e->d_name);
        unlink(path);
    }
    closedir(dir);
}
