/* alias: Walker's method with Vose's linear-time tables, thesis 3.2.2, figure 3.4 and appendix A.
 *
 * Draw the histogram of N P_0, ..., N P_{N-1} and a horizontal line at 1, the average. What stands out above the line is
 * chopped off and fills the bins that end below it; each bin is filled by one donor, its alias:
 *
 *     bin j:   [ j: prob_j | alias_j: 1 - prob_j ]          x = frac(u N) < prob_j ? j : alias_j,  j = floor(u N)
 *
 * Invariant of the build: at any time, item i has left to give (or lacks) what prob[i] shows above (below) 1; all that
 * was chopped off has its place; so the implied pmf of the tables is P, up to rounding.
 *
 * Departures from appendix A, each tested: the weights are copied and scaled by N / sum, the thesis compares raw weights
 * with 1/N (docs/errata.md E13); `frac < prob`, where the thesis has `u - i > prob` and so returns an item of probability 0
 * when the fraction is 0 (E14); leftovers (E15); alias_i = i to begin with, and a sum of 0 means "nothing to draw" (E16).
 * Source: Walker 1977; Vose 1991, "A Linear Algorithm for Generating Random Numbers with a Given Distribution". */
#include "bis/alias.h"
#include "bis/mem.h"
#include "weights.h"

#include <assert.h>
#include <math.h>

/* Sum by halves: the error grows with log n, not with n. */
static double pairwise_sum(const double *w, size_t n)
{
    if (n > 32) return pairwise_sum(w, n / 2) + pairwise_sum(w + n / 2, n - n / 2);
    double sum = 0;
    for (size_t i = 0; i < n; i++)
        sum += w[i];
    return sum;
}

/* prob[i] = N P_i. Returns the sum of the weights as given. */
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

/* Appendix A's two vectors, in the two ends of one array: they hold each item once. */
typedef struct stacks {
    uint32_t *small, *large; /* small grows up from the array's begin, large down from its end */
    size_t n_small, n_large;
} stacks;

/* "Classify the normalized weights as being either large (> 1/N) or small (<= 1/N)." Both writes, then one count: no branch
 * to predict. What the other one writes lies on a free place. */
static stacks classify(const double *prob, uint32_t *work, size_t n)
{
    stacks s = {work, work + n - 1, 0, 0};
    for (size_t i = 0; i < n; i++) {
        bool is_large = prob[i] > 1;
        s.small[s.n_small] = *(s.large - s.n_large) = (uint32_t)i;
        s.n_small += !is_large;
        s.n_large += is_large;
    }
    return s;
}

/* [alias-build] "Assign alias indices." */
static void assign_aliases(double *prob, uint32_t *alias, stacks *s)
{
    while (s->n_large > 0 && s->n_small > 0) {
        uint32_t sm = s->small[--s->n_small];
        uint32_t lg = *(s->large - (s->n_large - 1));

        prob[lg] -= 1 - prob[sm]; /* lg fills what bin sm lacks ... */
        alias[sm] = lg;           /* ... and bin sm is done */
        if (prob[lg] > 1) continue;
        s->n_large--; /* chopped off below the line: now it lacks itself */
        s->small[s->n_small++] = lg;
    }
}
/* [end] */

/* Rounding empties one stack too early. Exactly computed, what is left would stand at the line, so appendix A sets it to
 * 1. An item of weight 0 must not be drawn all the same: its bin goes to the largest item. */
static void settle_leftovers(double *prob, uint32_t *alias, const stacks *s, uint32_t largest)
{
    for (size_t k = 0; k < s->n_small; k++) {
        uint32_t i = s->small[k];
        if (prob[i] == 0)
            alias[i] = largest;
        else
            prob[i] = 1;
    }
    for (size_t k = 0; k < s->n_large; k++)
        prob[*(s->large - k)] = 1;
}

double bis_alias_build(double *prob, uint32_t *alias, const double *w, uint32_t *work, size_t n)
{
    double total = normalise(prob, w, n);
    uint32_t largest = 0;

    for (size_t i = 0; i < n; i++) {
        alias[i] = (uint32_t)i;
        if (prob[i] > prob[largest]) largest = (uint32_t)i;
    }
    if (total == 0) return 0;
    stacks s = classify(prob, work, n);
    assign_aliases(prob, alias, &s);
    settle_leftovers(prob, alias, &s, largest);
    return total;
}

bis_status bis_alias_init(bis_alias *a, const double *w, size_t n, bis_diag *diag)
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
    a->total = bis_alias_build(a->prob, a->alias, w, work, n);
done:
    bis_free(work);
    return status;
}

void bis_alias_clear(bis_alias *a)
{
    bis_free(a->prob);
    bis_free(a->alias);
    *a = (bis_alias){0};
}

/* [alias-sample] u N < N after rounding, too: u <= 1 - 2^-53, and N - N 2^-53 is at least half an ulp below N (exactly that, and a
 * double, only when N is a power of two). Subtracting the bin is exact. */
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
