/* SPDX-License-Identifier: BSD-2-Clause */
/* Uniform in theta instead of in its cosine: directions crowd at the poles. */
/* loses: directions_are_uniform_in_solid_angle */
/* loses: directions_are_drawn_from_alias_tables */
/* loses: directions_are_drawn_from_cdfs */
/* [patch] */
void bis_envmap_circle(const bis_envmap *em, int y, double u2, double *sin_theta, double *cos_theta)
{
    const double theta = PI * (y + u2) / em->height;
    *sin_theta = sin(theta);
    *cos_theta = cos(theta);
}

vec3 bis_envmap_direction(const bis_envmap *em, int x, int y, double u1, double u2)
{
    double sin_theta, cos_theta;
    bis_envmap_circle(em, y, u2, &sin_theta, &cos_theta);
    const double phi = 2 * PI * (x + u1) / em->width;
    return vec3_from(sin_theta * cos(phi), sin_theta * sin(phi), cos_theta);
}
/* [end] */
