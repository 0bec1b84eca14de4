/* SPDX-License-Identifier: BSD-2-Clause */
/* The map taken for a flat picture: its edges do not touch, nor do the pixels of a pole. */
/* loses: left_and_right_edges_touch */
/* loses: all_pixels_of_a_pole_touch */
/* loses: solid_angles_are_summed */
/* [bfs] */
static void flood(bis_search *s, uint32_t start, uint32_t label)
{
    const uint8_t level = s->level[start];
    const uint32_t width = s->width;
    (void)visit_row;
    visit(s, start, level, label);
    while (s->head < s->tail) {
        const uint32_t pixel = s->queue[s->head++];
        const uint32_t x = pixel % width, y = pixel / width;
        if (x > 0) visit(s, pixel - 1, level, label);
        if (x + 1 < width) visit(s, pixel + 1, level, label);
        if (y > 0) visit(s, pixel - width, level, label);
        if (y + 1 < s->height) visit(s, pixel + width, level, label);
    }
}
/* [end] */
