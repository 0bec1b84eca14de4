/* SPDX-License-Identifier: BSD-2-Clause */
/* The look-up of many directions at once is that of one, and here asks it. */
/* [pixels-of-lanes] */
/* One by one in this kit, by your bis_envmap_pixel. */
void bis_envmap_pixels(const bis_envmap *em, const vec3 axis[3], uint32_t *pixel, const bis_lanes *y, uint32_t n)
{
    for (uint32_t i = 0; i < bis_lanes_round_up(n); i++) {
        const vec3 w = {y->x[i], y->y[i], y->z[i]};
        pixel[i] = (uint32_t)bis_envmap_pixel(em, vec3_from(dot(w, axis[0]), dot(w, axis[1]), dot(w, axis[2])));
    }
}
/* [end] */
