/* SPDX-License-Identifier: BSD-2-Clause */
/* program: run bis as a user does, and see what it said, wrote and returned. For the end-to-end tests. */
#ifndef TESTS_PROGRAM_H
#define TESTS_PROGRAM_H

#include <stdbool.h>
#include <stddef.h>
#include <sys/types.h>

/* What a run left behind. Killed by signal s: exit_status is 128 + s, as in a shell. */
typedef struct program_run {
    int exit_status;
    char output[1 << 16], messages[1 << 14]; /* standard output and error, cut to size */
} program_run;

/* Where the runs happen, below build/: made empty. Names of files in `arguments` are relative to the repository's
 * root. */
void program_folder(const char *folder);

/* Run the program (BIS_PROGRAM, default build/release/bis) with these arguments, separated by single blanks.
 * `file_limit` > 0: no file may grow beyond that many bytes, which is what a full disk looks like. */
void program_run_limited(program_run *run, long file_limit, const char *arguments);
void program_runf(program_run *run, const char *fmt, ...) __attribute__((format(printf, 2, 3)));

/* Run, and assert the exit status; on a surprise both streams are shown. */
void program_expect(program_run *run, int exit_status, const char *fmt, ...) __attribute__((format(printf, 3, 4)));

/* Assert that standard error holds the one line about what was written, "bis: wrote FILES: ...", and nothing else. */
void program_expect_only_the_result(const program_run *run);

/* Start without waiting; then wait until it catches signal `number`, at most a minute, so that no clock decides the
 * test. */
pid_t program_start(const char *arguments);
void program_wait_for_handler(pid_t pid, int number);
void program_finish(program_run *run, pid_t pid);

void program_write_file(const char *path, const char *text);

extern const char program_world[]; /* a camera, map.pfm beside the scene, a ball and a floor */

/* FOLDER/scene.txt and its map.pfm: a ball on a floor, 24 x 16 pixels into FOLDER/film.exr, by sir, under a map of 8 x
 * 4 pixels with one bright lamp. `options` are lines before the camera. */
void program_write_scene(const char *folder, const char *options);

bool program_exists(const char *path);

/* Entries of a folder; its hidden and temporary files, too. */
int program_count_files(const char *folder);

#endif
