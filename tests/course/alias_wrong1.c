/* SPDX-License-Identifier: BSD-2-Clause */
/* A giver stays with the large ones, although it has come to lie below the line: its own bin is never filled. */
/* loses: every_table_gives_the_weights */
/* [alias-build] */
/* "Assign alias indices." */
static void assign_aliases(double *prob, uint32_t *alias, stacks *s)
{
    (void)push_small;
    while (s->n_large > 0 && s->n_small > 0) {
        uint32_t sm = pop_small(s), lg = top_large(s);

        prob[lg] -= 1 - prob[sm];
        alias[sm] = lg;
        if (prob[lg] <= 1) pop_large(s);
    }
}
/* [end] */
