/* SPDX-License-Identifier: BSD-2-Clause */
/* The draw for short columns is that of the assignment. */
/* [pick-column] */
static size_t pick_column(const bis_table *t, size_t y, double u)
{
    uint32_t alias[UINT16_MAX + 1]; /* in this kit, slowly: a copy for yours */

    for (size_t x = 0; x < t->width; x++) alias[x] = t->alias[y * t->width + x];
    return bis_alias_pick(t->prob + y * t->width, alias, t->width, u);
}
/* [end] */
