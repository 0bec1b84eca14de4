/* SPDX-License-Identifier: BSD-2-Clause */
/* alias: Walker's method with Vose's linear-time tables. Source: thesis 3.2.2, figure 3.4 and appendix A (Walker
 * 1977; Vose 1991, "A Linear Algorithm for Generating Random Numbers with a Given Distribution").
 *
 * Draw the histogram of N P_0, ..., N P_{N-1} and a horizontal line at 1, the average. The parts above the line are
 * cut off and fill the bins that end below it. One donor, the alias, fills each bin:
 *
 *     bin j:   [ j: prob_j | alias_j: 1 - prob_j ]          x = frac(u N) < prob_j ? j : alias_j,  j = floor(u N)
 *
 * Invariant of the build: at any time, what prob[i] has above 1 is what item i must still give, and what it has below
 * 1 is what bin i still lacks. Every part that was cut off has a place. The pmf that the finished tables imply is
 * therefore P, up to rounding.
 *
 * Departures from appendix A; a test covers each of them:
 *   - The weights are copied and scaled by N / sum. The thesis compares raw weights with 1/N (docs/errata.md E13).
 *   - An item is kept if `frac < prob`. The thesis tests `u - i > prob`, which returns an item of probability 0 when
 *     the fraction is 0 (E14).
 *   - Items that rounding leaves over are settled (E15).
 *   - alias_i starts as i, and a sum of 0 means "nothing to draw" (E16). */
#include "bis/thesis/alias.h"
#include "bis/base/mem.h"
#include "weights.h"

#include <assert.h>
#include <math.h>

/* Returns the sum of w[n]. It adds by halves, because the error then grows with log n and not with n. */
static double pairwise_sum(const double *w, size_t n)
{
    if (n > 32) return pairwise_sum(w, n / 2) + pairwise_sum(w + n / 2, n - n / 2);
    double sum = 0;
    for (size_t i = 0; i < n; i++)
        sum += w[i];
    return sum;
}

/* Sets prob[i] = N P_i. Returns the sum of the given weights. */
static double normalise(double *prob, const double *w, size_t n)
{
    weight_scale s = weight_scale_of(w, n);
    for (size_t i = 0; i < n; i++)
        prob[i] = weight_scaled(s, w[i]);
    double sum = pairwise_sum(prob, n);
    if (sum == 0) return 0;
    double to_average_1 = (double)n / sum;
    for (size_t i = 0; i < n; i++)
        prob[i] *= to_average_1;
    return ldexp(sum, s.exponent);
}

/* The two vectors of appendix A share one array, because together they hold each item at most once. `small` is
 * items[0 .. n_small - 1] and grows up; `large` is items[n - n_large .. n - 1] and grows down. */
typedef struct stacks {
    uint32_t *items;
    size_t n, n_small, n_large;
} stacks;

static uint32_t pop_small(stacks *s) { return s->items[--s->n_small]; }
static void push_small(stacks *s, uint32_t i) { s->items[s->n_small++] = i; }
static uint32_t top_large(const stacks *s) { return s->items[s->n - s->n_large]; }
static uint32_t pop_large(stacks *s) { return s->items[s->n - s->n_large--]; }

/* "Classify the normalized weights as being either large (> 1/N) or small (<= 1/N)." The loop writes the item to both
 * ends and then increases one count, because a branch would often be mispredicted. The other copy lies on a free
 * place. */
static stacks classify(const double *prob, uint32_t *work, size_t n)
{
    stacks s = {work, n, 0, 0};
    for (size_t i = 0; i < n; i++) {
        bool is_large = prob[i] > 1;
        work[s.n_small] = work[n - 1 - s.n_large] = (uint32_t)i;
        s.n_small += !is_large;
        s.n_large += is_large;
    }
    return s;
}

/* [alias-build] */
/* "Assign alias indices." */
static void assign_aliases(double *prob, uint32_t *alias, stacks *s)
{
    while (s->n_large > 0 && s->n_small > 0) {
        uint32_t sm = pop_small(s), lg = top_large(s);

        prob[lg] -= 1 - prob[sm]; /* lg gives what bin sm lacks ... */
        alias[sm] = lg;           /* ... and bin sm is full */
        if (prob[lg] <= 1) push_small(s, pop_large(s)); /* lg has nothing left to give: now its own bin lacks */
    }
}
/* [end] */

/* Rounding empties one stack before the other. In exact arithmetic all items that remain would have 1, so they get 1,
 * as in appendix A. If rounding were as large as a whole bin, as in float tables, an item of weight 0 could remain.
 * It must not be drawn, so its bin goes to the largest item (docs/errata.md E15). */
static void settle_leftovers(double *prob, uint32_t *alias, stacks *s, uint32_t largest)
{
    while (s->n_large > 0)
        prob[pop_large(s)] = 1;
    while (s->n_small > 0) {
        uint32_t sm = pop_small(s);
        if (prob[sm] == 0)
            alias[sm] = largest;
        else
            prob[sm] = 1;
    }
}

/* Turns prob[i] = N P_i into the tables. */
static void build_from(double *prob, uint32_t *alias, uint32_t *work, size_t n)
{
    uint32_t largest = 0;

    for (size_t i = 0; i < n; i++) {
        alias[i] = (uint32_t)i;
        if (prob[i] > prob[largest]) largest = (uint32_t)i;
    }
    if (n == 0 || prob[largest] == 0) return;
    stacks s = classify(prob, work, n);
    assign_aliases(prob, alias, &s);
    settle_leftovers(prob, alias, &s, largest);
}

double bis_alias_build(double *prob, uint32_t *alias, const double *w, uint32_t *work, size_t n)
{
    double total = normalise(prob, w, n);
    build_from(prob, alias, work, n);
    return total;
}

double bis_alias_build_raw(double *prob, uint32_t *alias, const double *w, uint32_t *work, size_t n)
{
    double total = pairwise_sum(w, n);
    for (size_t i = 0; i < n; i++)
        prob[i] = (double)n * w[i];
    build_from(prob, alias, work, n);
    return total;
}

bis_status bis_alias_init_by(bis_alias *a, bis_alias_builder *build, const double *w, size_t n, bis_diag *diag)
{
    bis_status status = BIS_OK;
    assert(n <= UINT32_MAX);
    *a = (bis_alias){.n = n};
    a->prob = bis_alloc(n, sizeof *a->prob);
    a->alias = bis_alloc(n, sizeof *a->alias);
    uint32_t *work = bis_alloc(n, sizeof *work);
    if (!a->prob || !a->alias || !work) {
        bis_alias_clear(a);
        status = bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for an alias table of %zu items", n);
        goto done;
    }
    a->total = build(a->prob, a->alias, w, work, n);
done:
    bis_free(work);
    return status;
}

bis_status bis_alias_init(bis_alias *a, const double *w, size_t n, bis_diag *diag)
{
    return bis_alias_init_by(a, bis_alias_build, w, n, diag);
}

void bis_alias_clear(bis_alias *a)
{
    bis_free(a->prob);
    bis_free(a->alias);
    *a = (bis_alias){0};
}

/* u N < N also after rounding: u <= 1 - 2^-53, and N 2^-53 is more than half the distance from N to the next double
 * below (or all of this distance, if N is a power of two). x - j is exact. */
/* [alias-sample] */
size_t bis_alias_pick(const double *prob, const uint32_t *alias, size_t n, double u)
{
    assert(u >= 0 && u < 1);
    double x = u * (double)n;
    size_t j = (size_t)x;
    return x - (double)j < prob[j] ? j : alias[j];
}
/* [end] */

size_t bis_alias_sample(const bis_alias *a, double u)
{
    assert(a->total > 0);
    return bis_alias_pick(a->prob, a->alias, a->n, u);
}

void bis_alias_implied_pmf(const bis_alias *a, double *pmf)
{
    for (size_t i = 0; i < a->n; i++)
        pmf[i] = 0;
    if (a->total == 0) return;
    for (size_t j = 0; j < a->n; j++) {
        pmf[j] += a->prob[j];
        pmf[a->alias[j]] += 1 - a->prob[j];
    }
    for (size_t i = 0; i < a->n; i++)
        pmf[i] /= (double)a->n;
}

size_t bis_alias_bytes(const bis_alias *a) { return a->n * (sizeof *a->prob + sizeof *a->alias); }
