/* SPDX-License-Identifier: BSD-2-Clause */
/* What falls below the horizon is turned up again, although the density counts it there (E34). */
/* loses: samples_have_the_density */
/* loses: the_albedo_comes_out_of_the_samples */
/* [phong-draw] */
FORMULA direction draw(const draws *k, int specular, real u1, real u2)
{
    const direction w = either(specular, turned(&k->about_r, lobe(k->inverse_n1, u1, u2)),
                               turned(&k->local, cosine(u1, u2)));
    const real c = along(k->local.z, w), up = choose(c < 0, 2 * c, 0);

    return (direction){w.x - up * (real)k->local.z.x, w.y - up * (real)k->local.z.y, w.z - up * (real)k->local.z.z};
}
/* [end] */
