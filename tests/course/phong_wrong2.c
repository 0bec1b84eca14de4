/* SPDX-License-Identifier: BSD-2-Clause */
/* What falls below the horizon is turned up again, although the density counts it there (E34). */
/* loses: samples_have_the_density */
/* loses: the_albedo_comes_out_of_the_samples */
/* [phong-draw] */
FORMULA OF(direction) OF(draw)(const OF(draws) *k, int specular, REAL u1, REAL u2)
{
    const OF(direction) w = OF(either)(specular, OF(turned)(&k->about_r, OF(lobe)(k->inverse_n1, u1, u2)),
                                       OF(turned)(&k->local, OF(cosine)(u1, u2)));
    const REAL c = OF(along)(k->local.z, w), up = OF(choose)(c < 0, 2 * c, 0);

    return (OF(direction)){w.x - up * (REAL)k->local.z.x, w.y - up * (REAL)k->local.z.y, w.z - up * (REAL)k->local.z.z};
}
/* [end] */
