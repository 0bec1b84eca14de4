/* SPDX-License-Identifier: BSD-2-Clause */
/* verify_accel: do the accelerators see what is there?
 *
 * Rays start anywhere in and around the scene; half of them run towards a point of its box, half towards one in that of
 * a random primitive, so that small parts are looked at as often as large ones. Where such a ray meets a surface, a
 * shadow ray leaves it, as a renderer's does (bis_surface_offset), to a random direction of the outer side: it must not
 * meet what it left. Where backends differ, or `occluded` differs from `intersect`, and for a share of all rays, a
 * search over all primitives decides (verify_oracle.c), which knows where rounding leaves either answer right. What is
 * wrong then must be 0. The share is larger for a backend that is alone, because nobody else can contradict it. Cost:
 * eight queries for each ray and its shadow ray, and the searches: twice TESTS_OF_TWO or TESTS_OF_ONE tests of
 * primitives, and those of the rays where answers differ. */
#include "verify.h"

#include <stdio.h>

enum { TESTS_OF_ONE = 1 << 24, TESTS_OF_TWO = 1 << 21, LEAST_OF_ONE = 64, LEAST_OF_TWO = 4 };

static const uint64_t purpose_rays = (uint64_t)0x79 << 40;

static vec3 point_in(const bis_box *b, bis_rng *rng)
{
    const double x = bis_rng_double(rng), y = bis_rng_double(rng), z = bis_rng_double(rng);
    return vec3_from((double)b->lo.x + x * ((double)b->hi.x - (double)b->lo.x),
                     (double)b->lo.y + y * ((double)b->hi.y - (double)b->lo.y),
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

/* What a says of r. Where it meets, *prim. */
static bis_verify_answer ask(const bis_accel *a, const ray *r, uint32_t *prim)
{
    bis_hit hit = {0, BIS_NO_PRIM};
    const bool met = bis_accel_intersect(a, r, &hit);

    *prim = met ? hit.prim : BIS_NO_PRIM;
    return (bis_verify_answer){met ? (double)hit.t : (double)INFINITY, bis_accel_occluded(a, r)};
}

typedef struct differences {
    size_t wrong, explained, searched, on_surfaces;
} differences;

/* The answers of all n backends to one ray; `search`: even if they agree. Returns what the first one meets. */
static uint32_t judge(differences *d, const bis_accel *const *a, int n, const ray *r, uint32_t left, bool search)
{
    bis_verify_answer answer[BIS_VERIFY_ANSWERS] = {{0, false}};
    uint32_t prim[BIS_VERIFY_ANSWERS];
    bool differ = false, right[BIS_VERIFY_ANSWERS], all = true;

    for (int i = 0; i < n; i++) {
        answer[i] = ask(a[i], r, &prim[i]);
        differ |= answer[i].t != answer[0].t || answer[i].occluded != isfinite(answer[i].t) ||
                  (left != BIS_NO_PRIM && prim[i] == left);
    }
    if (!differ && !search) return prim[0];
    bis_verify_search(right, a[0]->geometry, r, left, answer, n);
    for (int i = 0; i < n; i++) all &= right[i];
    d->searched++;
    d->wrong += !all;
    d->explained += all && differ;
    return prim[0];
}

/* A ray into the scene, and a shadow ray from where it ends. */
static void try_rays(differences *d, const bis_accel *const *a, int n, bis_rng *rng, const bis_box *room, bool search)
{
    const bis_geometry *g = a[0]->geometry;
    const vec3 from = point_in(room, rng), to = target(g, rng);
    const ray r = ray_between(from, to);
    const uint32_t prim = judge(d, a, n, &r, BIS_NO_PRIM, search);
    bis_surface s;

    if (prim == BIS_NO_PRIM) return;
    bis_geometry_surface(g, prim, &r, &s);
    const double z = 1 - 2 * bis_rng_double(rng), phi = 2 * PI * bis_rng_double(rng), side = sqrt(1 - z * z);
    vec3 w = vec3_from(side * cos(phi), side * sin(phi), z);
    if (dot(w, s.ng) < 0) w = neg(w);
    if (dot(w, s.ng) < 0x1p-20) return; /* ng is a float's: nearer to the plane a direction has no side */
    const ray shadow = {bis_surface_offset(&s), w, INFINITY};
    d->on_surfaces++;
    const bool sphere =
        prim >= g->n_triangles && g->quadrics[prim - g->n_triangles].kind == BIS_SPHERE; /* its inside is met again */
    judge(d, a, n, &shadow, sphere ? BIS_NO_PRIM : prim, search);
}

/* How many rays are searched although the answers agree. */
static size_t searches_of(const bis_verify *v, size_t primitives, int n_accels)
{
    const size_t tests = n_accels > 1 ? TESTS_OF_TWO : TESTS_OF_ONE, least = n_accels > 1 ? LEAST_OF_TWO : LEAST_OF_ONE;
    return (tests / primitives > least ? tests / primitives : least) >> v->halvings;
}

void bis_verify_backends(bis_verify *v, const bis_accel *a, const bis_accel *b, size_t n)
{
    const uint64_t seed = bis_verify_seed(v, "accelerators");
    const bis_box room = around(a->geometry);
    const bis_accel *const both[] = {a, b};
    const int n_accels = b ? 2 : 1;
    const size_t searches = searches_of(v, bis_geometry_primitives(a->geometry), n_accels);
    size_t wrong = 0, explained = 0, searched = 0, on_surfaces = 0;
    bis_verify_test *t;
    char note[120];

#pragma omp parallel for schedule(dynamic, 256) reduction(+ : wrong, explained, searched, on_surfaces)
    for (size_t i = 0; i < n; i++) {
        differences d = {0, 0, 0, 0};
        bis_rng rng;
        bis_rng_init(&rng, seed, i, 0, purpose_rays);
        try_rays(&d, both, n_accels, &rng, &room, i < searches);
        wrong += d.wrong;
        explained += d.explained;
        searched += d.searched;
        on_surfaces += d.on_surfaces;
    }
    snprintf(note, sizeof note, "wrong of %zu rays and %zu from surfaces, %zu of them searched; %zu more graze an edge",
             n, on_surfaces, searched, explained);
    if (b) t = bis_verify_new(v, "accelerators", "%s and %s see the same", bis_accel_name(a), bis_accel_name(b));
    else t = bis_verify_new(v, "accelerators", "%s sees what a search sees", bis_accel_name(a));
    bis_verify_bound(t, (double)wrong, 0, note);
}
