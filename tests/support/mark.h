/* mark: tests that mark an assignment (docs/assignments/). One program an assignment: claims, each worth some points.
 *
 * The code under test is a student's, and may crash, loop or leak. So each claim runs in a process of its own
 * (tests/support/mark_run.h); what it dies of becomes a message. A claim holds when its function returns.
 *     PROGRAM                              as cmocka tests, with the kit's seeds and sizes
 *     PROGRAM --list                       a line a claim: points, a tab, name. No student's code runs
 *     PROGRAM --claim K, PROGRAM --work K  started by mark_judge alone */
#ifndef TESTS_MARK_H
#define TESTS_MARK_H

#include "lit.h"

/* Significance of each statistical test in a claim. No assignment has more than 50 of them, so the probability that one of
 * 100 right solutions loses a point by chance is below 100 * 50 * 2e-7 = 1e-3 (union bound; the tests need not be independent). */
#define MARK_ALPHA 2e-7

typedef struct mark_claim {
    const char *name; /* is the claim */
    int points;
    void (*check)(void);
} mark_claim;

/* The points of all claims sum to 80: the other 20 are for speed and for clean memory (scripts/course/grade.sh). */
int mark_main(int argc, char **argv, const mark_claim *claims, size_t n, void (*work)(void));

/* mark_seed: what a claim draws with, where the kit has the seed `kit`. In the kit and in `make test` it is `kit`. When a
 * hand-in is graded it is made from a secret of the run, below 2^53, so that no answer can be prepared. */
uint64_t mark_seed(uint64_t kit);

/* mark_size: how large a table or a map is, or a count, where the kit has `kit`: the same in the kit and in `make test`,
 * from kit to kit + kit/4 when a hand-in is graded. */
size_t mark_size(size_t kit);

/* The claim does not hold. In words that a student understands: what was asked, what came, where to look. */
_Noreturn void mark_wrong(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* The same for something that must be near: the larger of the two tolerances counts. what is a format, as in "the solid
 * angle of row %d". */
void mark_near(double value, double expected, double absolute, double relative, const char *what, ...)
    __attribute__((format(printf, 5, 6)));

/* Counts against expected counts by a chi-square test. hint: what such a difference usually comes from. */
void mark_fit(const double *observed, const double *expected, size_t n, double alpha, const char *what,
              const char *hint);

/* Does this mean, of independent values, differ from what is expected by more than chance? */
void mark_mean(const stat_moments *m, double expected, double alpha, const char *what, const char *hint);

/* `runs` estimates at a point (tests/support/lit.h), each channel against the truth by brute force. A NaN or infinity
 * ends the claim. */
void mark_estimates(lit *l, const bis_settings *s, uint32_t runs, uint64_t seed, double alpha, const char *what,
                    const char *hint);

/* The moments of such estimates, r, g, b, r + g + b. */
void mark_run(stat_moments m[4], lit *l, const bis_settings *s, uint32_t runs, uint64_t seed);

#endif
