/* SPDX-License-Identifier: BSD-2-Clause */
/* n where eq. 3.16 has n + 1, and a sine from the rounded cosine. */
/* loses: the_lobe_is_drawn_by_eq_3_16 */
/* loses: narrow_lobes_keep_their_precision */
/* [phong-lobe] */
FORMULA OF(direction) OF(lobe)(REAL inverse_n1, REAL u1, REAL u2)
{
    const REAL n = 1 / inverse_n1 - 1, cos_theta = OF(exp)(OF(log1m)(u1) / OF(choose)(n > 0, n, 1));
    const REAL sine = OF(sqrt)(1 - cos_theta * cos_theta);
    REAL s, c;

    OF(sincos2pi)(u2, &s, &c);
    return (OF(direction)){sine * c, sine * s, cos_theta};
}
/* [end] */
