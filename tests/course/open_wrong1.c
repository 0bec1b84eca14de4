/* SPDX-License-Identifier: BSD-2-Clause */
/* The cosine for all: a density, and the one that is drawn, but noisy; the bound is still the other one's. */
/* loses: the_bound_of_rejection_holds */
/* loses: it_is_less_noisy_than_the_cosine */
/* loses: it_is_nearly_as_good_as_visible_normals */
/* [facet-density] */
FORMULA REAL OF(density)(const OF(constants) *k, const OF(facet) *f)
{
    (void)k;
    return (REAL)INV_PI * OF(choose)(f->c_i > 0, f->c_i, 0);
}
/* [end] */
/* [facet-draw] */
typedef struct OF(draws) {
    frame local;
} OF(draws);

static OF(draws) OF(draws_of)(const bis_bsdf *b)
{
    return (OF(draws)){b->local};
}

FORMULA OF(direction) OF(draw)(const OF(draws) *k, int specular, REAL u1, REAL u2)
{
    (void)specular;
    return OF(turned)(&k->local, OF(cosine)(u1, u2));
}
/* [end] */
