/* SPDX-License-Identifier: BSD-2-Clause */
/* envelope: the table of docs/envelope.md: what extremes were tried, what came out, how wrong it was at most, and the
 * bound that holds.
 *
 * A test tries an extreme many times and tells each try's error, against a value found by another road; the row keeps
 * the largest. Closing the row asserts the bound. The last test of each program writes its rows to build/envelope/,
 * puts the sections together in build/envelope.md, and compares names and bounds with the committed page, so that the
 * page cannot go stale; measured figures may differ between machines. `make envelope` writes the page anew. */
#ifndef TESTS_ENVELOPE_H
#define TESTS_ENVELOPE_H

#include <stdbool.h>
#include <stddef.h>

typedef struct envelope {
    const char *tried, *measure; /* the first two columns */
    double bound, worst;
    unsigned long long n_tries;
    char where[160]; /* the worst try */
    bool is_long;
} envelope;

/* A row. Where an outcome is right or wrong, the error is the number of wrong ones, and the bound is 0. */
envelope envelope_row(const char *tried, const char *measure, double bound);

/* A row that only `make test-long` makes (envelope_long() is true there); the page marks it. */
envelope envelope_long_row(const char *tried, const char *measure, double bound);
bool envelope_long(void);

/* One try. An error of NaN is worse than any; a right-or-wrong outcome is told by envelope_expect. The text says what
 * was tried, for the message of a failure. */
void envelope_try(envelope *e, double error, const char *fmt, ...) __attribute__((format(printf, 3, 4)));
void envelope_expect(envelope *e, bool right, const char *fmt, ...) __attribute__((format(printf, 3, 4)));

/* Assert the bound, and that something was tried; keep the row for the page. */
void envelope_close(envelope *e);

/* |a - b| / |b|; 0 where both are 0 or both the same infinity. */
double relative_error(double a, double b);

/* Has the page's section the rows that were closed so far, by name and bound, and no others? If not, the complaint says
 * where they differ. */
bool envelope_agrees_with(const char *path, const char *title, char *complaint, size_t size);

/* For programs that make thousands of tiny maps: threads would only wait for one another. */
void envelope_one_thread(void);

/* The body of each program's last test. `number` orders the sections. */
void envelope_finish(int number, const char *title);

#endif
