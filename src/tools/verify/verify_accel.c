/* verify_accel: do two accelerators see the same scene?
 *
 * Rays start anywhere in and around the scene; half of them run towards a point of its box, half towards one in that of
 * a random primitive, so that small parts are looked at as often as large ones. Both backends must find the same
 * distance, and `occluded` what `intersect` finds. Where a ray passes an edge within rounding, either answer is right:
 * a difference counts as explained where each backend gives the other's answer, too, to one of 32 rays that are moved
 * by 2^-18 of their length. What is left must be 0: a backend that loses a hit in the middle of a triangle does not
 * lose those beside it in the other's eyes.
 * Cost: four queries a ray. */
#include "verify.h"

#include <stdio.h>

enum { MOVED = 32 };

static const uint64_t purpose_rays = (uint64_t)0x79 << 40;
static const double small = 0x1p-18; /* 32 ulps of a float: more than either backend's rounding, less than any detail */

static vec3 point_in(const bis_box *b, bis_rng *rng)
{
    const double x = bis_rng_double(rng), y = bis_rng_double(rng), z = bis_rng_double(rng);
    return vec3_from((double)b->lo.x + x * ((double)b->hi.x - (double)b->lo.x), (double)b->lo.y + y * ((double)b->hi.y - (double)b->lo.y),
                     (double)b->lo.z + z * ((double)b->hi.z - (double)b->lo.z));
}

/* The scene's box and a tenth of its diagonal around it: so that a flat scene, too, is seen from outside. */
static bis_box around(const bis_geometry *g)
{
    const double margin = 0.1 * length(sub(g->box.hi, g->box.lo));
    const vec3 m = vec3_from(margin, margin, margin);
    return (bis_box){sub(g->box.lo, m), add(g->box.hi, m)};
}

static vec3 target(const bis_geometry *g, bis_rng *rng)
{
    if (bis_rng_double(rng) < 0.5) return point_in(&g->box, rng);
    const bis_box box = bis_geometry_bounds(g, (uint32_t)bis_rng_below(rng, bis_geometry_primitives(g)));
    return point_in(&box, rng);
}

static ray ray_between(vec3 from, vec3 to)
{
    const vec3 d = sub(to, from);
    const double l = length(d);
    return (ray){from, l > 0 ? mul(d, 1 / l) : (vec3){0, 0, 1}, INFINITY};
}

/* Distance to the nearest hit, infinite for none. */
static double distance(const bis_accel *a, const ray *r)
{
    bis_hit hit;
    return bis_accel_intersect(a, r, &hit) ? (double)hit.t : (double)INFINITY;
}

static double size_of(vec3 a, vec3 b) { return length(a) + length(b); }

static bool same(double s, double t, double size)
{
    if (isinf(s) || isinf(t)) return s == t;
    return fabs(s - t) <= small * (size + fmin(s, t));
}

/* Do moved rays of `a` give t, or distances on both sides of it? */
static bool explained(const bis_accel *a, vec3 from, vec3 to, double t, bis_rng *rng)
{
    const double size = size_of(from, to), d = 2 * small * size;
    double nearest = (double)INFINITY, farthest = 0;
    for (int i = 0; i < MOVED; i++) {
        const bis_box cube = {vec3_from(-d, -d, -d), vec3_from(d, d, d)};
        const vec3 shift_from = point_in(&cube, rng), shift_to = point_in(&cube, rng);
        const ray r = ray_between(add(from, shift_from), add(to, shift_to));
        const double moved = distance(a, &r);
        if (same(moved, t, size)) return true;
        nearest = fmin(nearest, moved);
        if (isfinite(moved)) farthest = fmax(farthest, moved);
    }
    return nearest <= t && t <= farthest;
}

typedef struct differences {
    size_t explained, left;
} differences;

static void compare(differences *d, const bis_accel *a, const bis_accel *b, vec3 from, vec3 to, bis_rng *rng)
{
    const ray r = ray_between(from, to);
    const double ta = distance(a, &r), tb = distance(b, &r), size = size_of(from, to);
    const bool hidden_a = bis_accel_occluded(a, &r), hidden_b = bis_accel_occluded(b, &r);
    if (same(ta, tb, size) && hidden_a == isfinite(ta) && hidden_b == isfinite(tb)) return;

    bool all = same(ta, tb, size) || (explained(a, from, to, tb, rng) && explained(b, from, to, ta, rng));
    /* An edge that `occluded` saw and `intersect` did not, or the other way round: then moved rays hit and miss. */
    if (hidden_a != isfinite(ta)) all &= explained(a, from, to, (double)INFINITY, rng);
    if (hidden_b != isfinite(tb)) all &= explained(b, from, to, (double)INFINITY, rng);
    d->explained += all;
    d->left += !all;
}

void bis_verify_backends(bis_verify *v, const bis_accel *a, const bis_accel *b, size_t n)
{
    const uint64_t seed = bis_verify_seed(v, "accelerators");
    const bis_box room = around(a->geometry);
    size_t at_edges = 0, left = 0;
    char note[120];

#pragma omp parallel for schedule(dynamic, 256) reduction(+ : at_edges, left)
    for (size_t i = 0; i < n; i++) {
        differences d = {0, 0};
        bis_rng rng;
        bis_rng_init(&rng, seed, i, 0, purpose_rays);
        const vec3 from = point_in(&room, &rng), to = target(a->geometry, &rng);
        compare(&d, a, b, from, to, &rng);
        at_edges += d.explained;
        left += d.left;
    }
    snprintf(note, sizeof note, "differences in %zu rays; %zu more where a ray grazes an edge", n, at_edges);
    bis_verify_bound(v, "accelerators", (double)left, 0, note, "%s and %s see the same", bis_accel_name(a), bis_accel_name(b));
}
