/* SPDX-License-Identifier: BSD-2-Clause */
/* [facet-density] */
FORMULA real density(const constants *k, const facet *f)
{
    /* Yours to write: the density of what draw draws, at the direction that facet f mirrors wo to. */
    (void)k, (void)f;
    return 1;
}
/* [end] */
/* [facet-draw] */
/* Yours to write: what draw needs of a point. */
typedef struct draws {
    frame local;
} draws;

FORMULA draws draws_of(const bis_bsdf *b)
{
    return (draws){b->local};
}

FORMULA direction draw(const draws *k, int specular, real u1, real u2)
{
    /* Yours to write: a direction from two uniform numbers; of the lobe if specular, as proposals count on it. */
    (void)specular, (void)u1, (void)u2;
    return (direction){(real)k->local.z.x, (real)k->local.z.y, (real)k->local.z.z};
}
/* [end] */
/* [facet-bound] */
static double max_ratio(const bis_bsdf *b)
{
    /* Yours to write: a bound of f cos/pdf over all wi. Of use: most_fresnel, most_base. */
    (void)b;
    return 0;
}
/* [end] */
