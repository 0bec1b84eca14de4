/* SPDX-License-Identifier: BSD-2-Clause */
/* No search: the whole level gets one label, by one pass over the band. Whatever connects, connects. */
/* loses: neighbours_of_a_level_are_one_region */
/* loses: corners_do_not_touch */
/* loses: all_pixels_of_a_pole_touch */
/* [bfs] */
static void flood(bis_search *s, uint32_t start, uint32_t label)
{
    (void)visit_row, (void)visit;
    for (uint32_t i = 0; i < s->width * s->height; i++) {
        if (s->level[i] == s->level[start]) s->label[i] = label;
    }
}
/* [end] */
