/* SPDX-License-Identifier: BSD-2-Clause */
/* Eight neighbours, by recursion, the queue unused; the brightest pixel falls into a level of its own. */
/* loses: darkest_brightest_black_and_constant_have_their_levels */
/* loses: neighbours_of_a_level_are_one_region */
/* loses: corners_do_not_touch */
/* loses: all_pixels_of_a_pole_touch */
/* loses: solid_angles_are_summed */
/* loses: a_large_map_needs_no_deep_recursion */
/* [level] */
-    const double bin = l->n * log(intensity / l->least) / l->log_range;
-    return (uint8_t)fmin(bin, l->n - 1); /* the brightest pixel stands on the last bin's upper edge */
+    return (uint8_t)(l->n * log(intensity / l->least) / l->log_range);
/* [end] */
/* [bfs] */
static void flood(bis_search *s, uint32_t start, uint32_t label)
{
    const int width = (int)s->width, x = (int)start % width, y = (int)start / width;
    (void)visit_row, (void)visit;
    s->label[start] = label;
    for (int dy = -1; dy <= 1; dy++) {
        for (int dx = -1; dx <= 1; dx++) {
            if (y + dy < 0 || y + dy >= (int)s->height) continue;
            const uint32_t next = (uint32_t)((y + dy) * width + (x + dx + width) % width);
            if (s->level[next] == s->level[start] && s->label[next] == BIS_REGION_NONE) flood(s, next, label);
        }
    }
}
/* [end] */
