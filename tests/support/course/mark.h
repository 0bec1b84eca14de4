/* SPDX-License-Identifier: BSD-2-Clause */
/* mark: tests that mark an assignment (docs/assignments/). One program an assignment: claims, each worth some points.
 *
 * The code under test is a student's, and may crash, loop, leak or cheat. So it is in another process than the claim
 * (answers.h), one for each claim: what a claim wants of it, it asks by mark_ask, and it trusts nothing
 * but the bytes that come back. A claim holds when its function returns.
 *     PROGRAM                      as cmocka tests, with the kit's seeds and sizes
 *     PROGRAM --check, --clean     points and speed; memory, if the program is sanitized: `make check` in a kit
 *     PROGRAM --list               a line a claim: points, a tab, name
 *     PROGRAM --claim ..., --work  started by mark_judge alone (mark_run.h)
 *     PROGRAM --serve              the student's process, in a kit */
#ifndef TESTS_MARK_H
#define TESTS_MARK_H

#include "answers.h"

/* Significance of each statistical test in a claim. No assignment has more than 50 of them, so the probability that
 * one of 100 right solutions loses a point by chance is below 100 * 50 * 2e-7 = 1e-3 (union bound; the tests need not
 * be independent). */
#define MARK_ALPHA 2e-7

typedef struct mark_claim {
    const char *name; /* is the claim */
    int points;
    void (*check)(void);
} mark_claim;

/* mark_main runs as the arguments say, see above. The points of all claims sum to 80: the other 20 are for speed and
 * for clean memory (scripts/course/grade.sh). `work` asks for the load whose processor time is compared; `ours` is what
 * our own code takes for it, in units of a load that every kit has (--check; docs/assignments/README.md says how to
 * measure it). Returns the program's exit status. */
int mark_main(int argc, char **argv, const mark_claim *claims, size_t n, void (*work)(void), double ours);

/* A part of a question, from or to an array of n elements. */
typedef struct mark_part {
    void *at;
    size_t bytes;
    bool taken;
} mark_part;
#define GIVE(array, n) {(void *)(uintptr_t)(array), (n) * sizeof *(array), false}
#define TAKE(array, n) {(array), (n) * sizeof *(array), true}

/* mark_ask asks the student's process, and fills the parts that are taken. Their values may be anything. A process that
 * ends, or gives no answer in time, ends the claim. ASK is the same for parts that are written one after the other. */
void mark_ask(ask_question question, size_t n, const mark_part parts[]);
#define ASK(question, ...)                                                                                             \
    mark_ask(question, sizeof((mark_part[]){__VA_ARGS__}) / sizeof(mark_part), (mark_part[]){__VA_ARGS__})

/* mark_seed returns what a claim draws with, where the kit has the seed `kit`. In the kit and in `make test` it is
 * `kit`. When a hand-in is graded it is made from a secret of the run, below 2^53, so that no answer can be
 * prepared. */
uint64_t mark_seed(uint64_t kit);

/* mark_size returns how large a table or a map is, or a count, where the kit has `kit`: the same in the kit and in
 * `make test`, from kit to kit + kit/4 when a hand-in is graded. */
size_t mark_size(size_t kit);

/* mark_alloc returns n zeros of this size; without memory the claim ends. Nothing that a claim holds is freed, because
 * its process ends with it. */
void *mark_alloc(size_t n, size_t size);

/* mark_uniforms returns n numbers, uniform in [0, 1), of this seed and pixel. */
double *mark_uniforms(size_t n, uint64_t seed, uint64_t pixel);

/* mark_wrong ends the claim, which does not hold. In words that a student understands: what was asked, what came, where
 * to look. */
_Noreturn void mark_wrong(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* mark_note says something of a claim that will hold: one line, which stands beside its points. */
void mark_note(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* mark_near does so unless the value is near; the larger of the two tolerances counts. what is a format, as in "the
 * solid angle of row %d". */
void mark_near(double value, double expected, double absolute, double relative, const char *what, ...)
    __attribute__((format(printf, 5, 6)));

/* mark_fit does so unless counts fit expected counts by a chi-square test. hint: what such a difference usually comes
 * from. */
void mark_fit(const double *observed, const double *expected, size_t n, double alpha, const char *what,
              const char *hint);

/* mark_mean does so if this mean, of independent values, differs from what is expected by more than chance. */
void mark_mean(const stat_moments *m, double expected, double alpha, const char *what, const char *hint);

/* mark_scene returns a scene whose normal is tilted, seen at 40 degrees, with stratified directions. */
ask_scene mark_scene(lit_map map, bis_material m, lit_hidden hidden, int integrator, const bis_settings *s);

/* mark_lit makes what brute force needs of a scene. l must stay where it is. */
void mark_lit(lit *l, const ask_scene *scene);

/* mark_run asks for estimates of a scene, which are finite or the claim ends. */
ask_estimate *mark_run(const ask_scene *scene, uint32_t runs, uint64_t seed);

/* mark_moments returns the moments of estimates, r, g, b, r + g + b. */
void mark_moments(stat_moments m[4], const ask_estimate *e, uint32_t runs);

/* mark_most_rays returns the most shadow rays that one of the estimates casts. */
uint64_t mark_most_rays(const ask_estimate *e, uint32_t runs);

/* mark_estimates tests each channel of estimates against the truth by brute force. */
void mark_estimates(const ask_estimate *e, const lit *l, uint32_t runs, double alpha, const char *what,
                    const char *hint);

#endif
