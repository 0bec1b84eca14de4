/* SPDX-License-Identifier: BSD-2-Clause */
/* With CDFs, too, the place in a pixel is told by u[2] and u[3]; the density of the intensities, without their weights.
 */
/* loses: the_density_is_the_intensity_over_the_power */
/* loses: directions_are_drawn_from_cdfs */
/* [density] */
double bis_importance_pdf_pixel(const bis_importance *im, size_t pixel)
{
    return im->total > 0 ? (double)rgb_sum(im->weights.em->pixels[pixel]) / im->total : 0;
}
/* [end] */
/* [two-passes] */
bis_drawn bis_table_draw(const bis_table *t, const double u[4])
{
    bis_drawn d;
    if (t->kind == BIS_TABLE_ALIAS) {
        d.y = bis_alias_sample(&t->row_alias, u[0]);
        d.x = pick_column(t, d.y, u[1]);
    } else {
        d.y = bis_cdf_sample(&t->row_cdf, u[0], NULL);
        d.x = bis_cdf_sample(&t->columns[d.y], u[1], NULL);
    }
    d.u[0] = u[2];
    d.u[1] = u[3];
    return d;
}
/* [end] */
