/* SPDX-License-Identifier: BSD-2-Clause */
/* Numbers of 16 bits, as for the columns of a map: right up to 65536 items. */
/* loses: tables_hold_for_a_contrast_of_1e12_and_a_million_items */
/* [alias-build] */
/* "Assign alias indices." */
static void assign_aliases(double *prob, uint32_t *alias, stacks *s)
{
    while (s->n_large > 0 && s->n_small > 0) {
        uint32_t sm = pop_small(s);
        uint16_t lg = (uint16_t)top_large(s);

        prob[lg] -= 1 - prob[sm];
        alias[sm] = lg;
        if (prob[lg] <= 1) push_small(s, pop_large(s));
    }
}
/* [end] */
