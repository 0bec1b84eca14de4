/* SPDX-License-Identifier: BSD-2-Clause */
/* Levels are rounded to the nearest instead of down. */
/* loses: levels_are_equal_steps_of_the_logarithm */
/* [level] */
uint8_t bis_level_of_intensity(const bis_levels *l, double intensity)
{
    if (intensity == 0) return BIS_LEVEL_NONE;
    if (l->log_range == 0) return 0;
    const double bin = l->n * log(intensity / l->least) / l->log_range + 0.5;
    return (uint8_t)fmin(bin, l->n - 1); /* the brightest pixel stands on the last bin's upper edge */
}
/* [end] */
