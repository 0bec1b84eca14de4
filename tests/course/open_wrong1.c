/* SPDX-License-Identifier: BSD-2-Clause */
/* The cosine for all: a density, and the one that is drawn, but noisy; the bound is still the other one's. */
/* loses: the_bound_of_rejection_holds */
/* loses: it_is_less_noisy_than_the_cosine */
/* loses: it_is_nearly_as_good_as_visible_normals */
/* [facet-density] */
FORMULA real density(const constants *k, const facet *f)
{
    (void)k;
    return (real)INV_PI * choose(f->c_i > 0, f->c_i, 0);
}
/* [end] */
/* [facet-draw] */
typedef struct draws {
    frame local;
} draws;

FORMULA draws draws_of(const bis_bsdf *b)
{
    return (draws){b->local};
}

FORMULA direction draw(const draws *k, int specular, real u1, real u2)
{
    (void)specular;
    return turned(&k->local, cosine(u1, u2));
}
/* [end] */
