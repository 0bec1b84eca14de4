/* SPDX-License-Identifier: BSD-2-Clause */
/* Draws the lobe and the cosine rightly, with numbers of its own: u1 and u2 only seed them. */
/* loses: the_lobe_is_drawn_by_eq_3_16 */
/* loses: narrow_lobes_keep_their_precision */
/* [phong-lobe] */
FORMULA direction lobe(real inverse_n1, real u1, real u2)
{
    const real v1 = u1 * 4093 - (real)(int)(u1 * 4093), v2 = u2 * 4093 - (real)(int)(u2 * 4093);
    const real one_minus_cos = one_minus_exp(log1m(v1) * inverse_n1);
    const real sine = root(one_minus_cos * (2 - one_minus_cos));
    real s, c;

    sincos2pi(v2, &s, &c);
    return (direction){sine * c, sine * s, 1 - one_minus_cos};
}
/* [end] */
