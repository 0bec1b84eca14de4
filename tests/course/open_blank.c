/* SPDX-License-Identifier: BSD-2-Clause */
/* [facet-density] */
FORMULA REAL OF(density)(const OF(constants) *k, const OF(facet) *f)
{
    /* Yours to write: the density of what OF(draw) draws, at the direction that facet f mirrors wo to. */
    (void)k, (void)f;
    return 1;
}
/* [end] */
/* [facet-draw] */
/* Yours to write: what OF(draw) needs of a point. */
typedef struct OF(draws) {
    frame local;
} OF(draws);

static OF(draws) OF(draws_of)(const bis_bsdf *b)
{
    return (OF(draws)){b->local};
}

FORMULA OF(direction) OF(draw)(const OF(draws) *k, int specular, REAL u1, REAL u2)
{
    /* Yours to write: a direction from two uniform numbers; of the lobe if specular, as proposals count on it. */
    (void)specular, (void)u1, (void)u2;
    return (OF(direction)){(REAL)k->local.z.x, (REAL)k->local.z.y, (REAL)k->local.z.z};
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
