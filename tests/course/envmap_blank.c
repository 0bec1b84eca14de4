/* SPDX-License-Identifier: BSD-2-Clause */
/* [solid-angle] */
    /* Yours to write: cos_edge[y], the cosine of the circle above row y, and row_solid_angle[y], of ONE pixel of row y.
     * Of use: sin_polar, cos_polar. The values below only keep the program alive. */
    (void)sin_polar, (void)cos_polar;
    for (int y = 0; y < height; y++) {
        em->cos_edge[y] = 0;
        em->row_solid_angle[y] = 1;
    }
    em->cos_edge[height] = 0;
/* [end] */
/* [lookup] */
size_t bis_envmap_pixel(const bis_envmap *em, vec3 w_local)
{
    /* Yours to write: the pixel, row * width + column, that the direction lies in. */
    (void)em, (void)w_local;
    return 0;
}
/* [end] */
/* [patch] */
void bis_envmap_circle(const bis_envmap *em, int y, double u2, double *sin_theta, double *cos_theta)
{
    /* Yours to write: theta of a point that lies at u2 of row y, uniform in solid angle. */
    (void)em, (void)y, (void)u2;
    *sin_theta = 0;
    *cos_theta = 1;
}

vec3 bis_envmap_direction(const bis_envmap *em, int x, int y, double u1, double u2)
{
    /* Yours to write: the direction at (u1, u2) of pixel (x, y). */
    (void)em, (void)x, (void)y, (void)u1, (void)u2;
    return (vec3){0.6f, 0, 0.8f};
}
/* [end] */
/* [density] */
double bis_importance_pdf_pixel(const bis_importance *im, size_t pixel)
{
    /* Yours to write: the density per steradian. Of use: bis_weight(&im->weights, pixel), and im->total, the sum of
     * weights times solid angles. */
    (void)im, (void)pixel;
    return 1;
}
/* [end] */
/* [two-passes] */
bis_drawn bis_table_draw(const bis_table *t, const double u[4])
{
    /* Yours to write: a row, a pixel of it, a place in it. Of use: bis_alias_sample with pick_column; bis_cdf_sample
     * with its remainders. */
    (void)t, (void)u, (void)pick_column;
    return (bis_drawn){.x = 0, .y = 0};
}
/* [end] */
