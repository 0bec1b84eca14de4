/* SPDX-License-Identifier: BSD-2-Clause */
/* All pixels are of one size, as if the map were a cylinder: no sin theta anywhere. */
/* loses: a_pixel_of_each_row_has_its_solid_angle */
/* loses: irradiance_of_a_constant_map_is_pi_on_every_side */
/* [solid-angle] */
    for (int y = 0; y < height; y++) {
        em->cos_edge[y] = cos_polar(y, height);
        em->row_solid_angle[y] = 4 * PI / width / height;
    }
    (void)sin_polar;
    em->cos_edge[height] = -1;
/* [end] */
