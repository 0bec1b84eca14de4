/* SPDX-License-Identifier: BSD-2-Clause */
/* bench_accel: the voxel grid against Embree on one mesh. usage: bench_accel MESH [RAYS [DENSITY...]]
 *
 * Rays, one thread, in the order of the pixels of one view (`spread`: of 16 views, few pixels each, so that caches are
 * cold):
 *   nearest     from an eye outside to random points around the mesh
 *   hemisphere  any hit, from each point that the eye sees into one uniform direction of its hemisphere
 *   sir         any hit, 15 from each such point about the mirror direction, cos^10, as SIR sends them
 * They leave the surface as the renderer's do. Both backends get the same rays in turns, 16384 by 16384, and of each
 * such chunk the best of nine runs counts, in processor time: so a busy machine is so for both. Builds: the best of
 * five, in turns. Without Embree only the grid's figures are printed. */
#include "bis/shape/accel.h"
#include "bis/base/file.h"
#include "files/obj.h"
#include "files/ply.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { CHUNK = 16384, RUNS = 9, BUILDS = 5, N_SETS = 4, SIR_N = 15 };

static double clock_seconds(clockid_t clock)
{
    struct timespec t;

    clock_gettime(clock, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* splitmix64 (Steele et al. 2014): the bench needs no more. */
static double uniform(uint64_t *state)
{
    uint64_t z = *state += 0x9e3779b97f4a7c15;

    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9;
    z = (z ^ z >> 27) * 0x94d049bb133111eb;
    return (double)((z ^ z >> 31) >> 11) * 0x1p-53;
}

/* Density proportional to cos^n about f.z; n = 0: the uniform hemisphere. */
static vec3 lobe_direction(const frame *f, double n, uint64_t *state)
{
    const double c = pow(1 - uniform(state), 1 / (n + 1)), s = sqrt(1 - c * c), phi = 2 * PI * uniform(state);

    return to_world(f, vec3_from(s * cos(phi), s * sin(phi), c));
}

/* ---- rays ---- */

enum { GRID, EMBREE };

typedef struct rays {
    const char *name;
    ray *r;
    bis_hit *hits[2];  /* of each backend, for nearest */
    bool *hit[2];
    size_t n, capacity;
    double ns[2];
} rays;

static bool allocate(rays *set, const char *name, size_t n)
{
    bool ok;

    *set = (rays){.name = name, .capacity = n};
    set->r = calloc(n, sizeof *set->r);
    ok = set->r != NULL;
    for (int b = 0; b < 2; b++) {
        set->hits[b] = calloc(n, sizeof *set->hits[b]);
        set->hit[b] = calloc(n, sizeof *set->hit[b]);
        ok = ok && set->hits[b] && set->hit[b];
    }
    return ok;
}

static void free_rays(rays *set)
{
    free(set->r);
    for (int b = 0; b < 2; b++) {
        free(set->hits[b]);
        free(set->hit[b]);
    }
}

/* Eyes on a sphere about the box; each view is scanned in rows. */
static void make_camera_rays(rays *set, const bis_box *box, size_t views)
{
    const vec3 centre = mul(add(box->lo, box->hi), 0.5);
    const double radius = length(sub(box->hi, box->lo));
    const size_t side = (size_t)sqrt((double)set->capacity / (double)views);
    uint64_t state = 1;

    for (size_t v = 0; v < views; v++) {
        const double z = 2 * uniform(&state) - 1, phi = 2 * PI * uniform(&state), s = sqrt(1 - z * z);
        const vec3 w = vec3_from(s * cos(phi), s * sin(phi), z), eye = add(centre, mul(w, radius));
        const frame f = frame_about(w);
        for (size_t p = 0; p < side * side; p++) {
            double x = ((double)(p % side) + uniform(&state)) / (double)side - 0.5;
            double y = ((double)(p / side) + uniform(&state)) / (double)side - 0.5;
            vec3 target = add(centre, add(mul(f.x, x * radius * 0.8), mul(f.y, y * radius * 0.8)));
            set->r[set->n++] = (ray){eye, normalize(sub(target, eye)), INFINITY};
        }
    }
}

/* From each point that the camera sees: one ray into the hemisphere, or SIR_N about the mirror direction. */
static void make_shadow_rays(rays *shadow, const rays *camera, const bis_accel *a, bool sir)
{
    uint64_t state = 2;

    for (size_t i = 0; i < camera->n; i++) {
        const ray *c = &camera->r[i];
        bis_surface s;
        bis_hit hit;
        if (!bis_accel_intersect(a, c, &hit)) continue;
        bis_geometry_surface(a->geometry, hit.prim, c, &s);
        const vec3 mirror = normalize(sub(c->d, mul(s.ng, 2 * dot(c->d, s.ng))));
        const frame f = frame_about(sir ? mirror : s.ng);
        for (int k = 0; k < (sir ? SIR_N : 1); k++) {
            vec3 w = lobe_direction(&f, sir ? 10 : 0, &state);
            if (shadow->n == shadow->capacity) return;
            if (dot(w, s.ng) > 0) shadow->r[shadow->n++] = (ray){bis_surface_offset(&s), w, INFINITY};
        }
    }
}

/* The sets; `a` tells where surfaces are. */
static bool make_rays(rays sets[N_SETS], const bis_accel *a, size_t n)
{
    static const char *const names[N_SETS] = {"nearest", "hemisphere", "sir", "spread"};
    rays spread;
    bool ok = allocate(&spread, "", n);

    for (int i = 0; i < N_SETS; i++) ok = allocate(&sets[i], names[i], n) && ok;
    if (ok) {
        make_camera_rays(&sets[0], &a->geometry->box, 1);
        make_camera_rays(&spread, &a->geometry->box, 16);
        make_shadow_rays(&sets[1], &sets[0], a, false);
        make_shadow_rays(&sets[2], &sets[0], a, true);
        make_shadow_rays(&sets[3], &spread, a, false);
    }
    free_rays(&spread);
    return ok;
}

/* ---- times ---- */

/* Seconds of processor time for rays [from, to). */
static double time_chunk(const bis_accel *a, rays *set, int b, bool any, size_t from, size_t to)
{
    const double start = clock_seconds(CLOCK_THREAD_CPUTIME_ID);

    for (size_t i = from; i < to; i++) {
        set->hit[b][i] = any ? bis_accel_occluded(a, &set->r[i]) : bis_accel_intersect(a, &set->r[i], &set->hits[b][i]);
    }
    return clock_seconds(CLOCK_THREAD_CPUTIME_ID) - start;
}

static void time_rays(bis_accel *const a[2], rays *set, bool any)
{
    double total[2] = {0};

    for (size_t from = 0; from < set->n; from += CHUNK) {
        const size_t to = from + CHUNK < set->n ? from + CHUNK : set->n;
        double best[2] = {(double)INFINITY, (double)INFINITY};
        for (int run = 0; run < RUNS; run++) {
            for (int b = 0; b < 2 && a[b]; b++) best[b] = fmin(best[b], time_chunk(a[b], set, b, any, from, to));
        }
        for (int b = 0; b < 2 && a[b]; b++) total[b] += best[b];
    }
    for (int b = 0; b < 2; b++) set->ns[b] = 1e9 * total[b] / (double)set->n;
}

/* Builds both, in turns; the last ones stay. */
static bool build(
    bis_accel *a[2], double seconds[2], const bis_geometry *g, double density, int n_threads, bis_diag *diag)
{
    seconds[GRID] = seconds[EMBREE] = (double)INFINITY;
    for (int run = 0; run < BUILDS; run++) {
        for (int b = 0; b < (bis_accel_embree_version() ? 2 : 1); b++) {
            const bis_accel_options options = {b == GRID ? BIS_ACCEL_GRID : BIS_ACCEL_EMBREE, density, n_threads, NULL};
            bis_accel_free(a[b]);
            a[b] = NULL;
            const double start = clock_seconds(CLOCK_MONOTONIC);
            if (bis_accel_new(&a[b], g, &options, diag)) return false;
            seconds[b] = fmin(seconds[b], clock_seconds(CLOCK_MONOTONIC) - start);
        }
    }
    return true;
}

/* ---- what is printed ---- */

static void print_build(int n_threads, const double seconds[2], bool embree)
{
    printf("build, %d thread%s  grid %.3f s", n_threads, n_threads > 1 ? "s" : " ", seconds[GRID]);
    if (embree) printf("  embree %.3f s  ratio %.2f", seconds[EMBREE], seconds[GRID] / seconds[EMBREE]);
    printf("\n");
}

static void print_rays(const rays *set, bool embree)
{
    size_t occluded = 0, hit = 0, prim = 0;

    for (size_t i = 0; i < set->n; i++) {
        occluded += set->hit[GRID][i];
        hit += set->hit[GRID][i] != set->hit[EMBREE][i];
        prim += set->hit[GRID][i] && set->hit[EMBREE][i] && set->hits[GRID][i].prim != set->hits[EMBREE][i].prim;
    }
    printf("%-10s  %7zu rays, %2.0f%% hit  grid %4.0f ns", set->name, set->n, 100 * (double)occluded / (double)set->n,
        set->ns[GRID]);
    if (embree) {
        printf("  embree %4.0f ns  ratio %.2f  disagree %zu, other triangle named %zu", set->ns[EMBREE],
            set->ns[GRID] / set->ns[EMBREE], hit, prim);
    }
    printf("\n");
}

static bool bench(const bis_geometry *g, rays sets[N_SETS], size_t n, double density, bis_diag *diag)
{
    const double triangles = (double)bis_geometry_primitives(g);
    bis_accel *a[2] = {NULL, NULL};
    double seconds[2];
    bool ok = false;

    for (int n_threads = 2; n_threads >= 1; n_threads--) {
        if (!build(a, seconds, g, density, n_threads, diag)) goto done;
        print_build(n_threads, seconds, a[EMBREE]);
    }
    printf("bytes a triangle: mesh %.1f, grid %.1f, embree %.1f\n", (double)bis_geometry_bytes(g) / triangles,
           (double)bis_accel_bytes(a[GRID]) / triangles, (double)bis_accel_bytes(a[EMBREE]) / triangles);
    if (!sets[0].r && !make_rays(sets, a[GRID], n)) goto done;
    for (int i = 0; i < N_SETS; i++) {
        time_rays(a, &sets[i], i > 0);
        print_rays(&sets[i], a[EMBREE]);
    }
    ok = true;
done:
    for (int b = 0; b < 2; b++) bis_accel_free(a[b]);
    return ok;
}

static bis_status load(bis_geometry *g, const char *path, bis_diag *diag)
{
    const bis_xform identity = bis_xform_identity();
    bis_mesh mesh = {0};
    char ending[8];
    bool obj = strcmp(bis_path_extension(ending, path), ".obj") == 0;
    double start = clock_seconds(CLOCK_MONOTONIC);
    bis_status status =
        obj ? bis_obj_read(&mesh, path, (bis_loc){0}, diag) : bis_ply_read(&mesh, path, (bis_loc){0}, diag);

    if (!status) {
        printf("%s: %zu triangles, read in %.3f s\n", path, mesh.n_triangles, clock_seconds(CLOCK_MONOTONIC) - start);
        status = bis_geometry_add_mesh(g, &mesh, &identity, 0, diag);
    }
    bis_mesh_clear(&mesh);
    return status;
}

int main(int argc, char **argv)
{
    const size_t n = argc > 2 ? (size_t)atof(argv[2]) : 300000;
    rays sets[N_SETS] = {0};
    bis_geometry g = {0};
    bis_diag diag = {0};
    int code = 1;

    if (argc < 2 || load(&g, argv[1], &diag)) goto done;
    for (int i = 3; i < (argc > 3 ? argc : 4); i++) {
        const double density = i < argc ? atof(argv[i]) : 0;
        if (density > 0) printf("density %g\n", density);
        if (!bench(&g, sets, n, density, &diag)) goto done;
    }
    code = 0;
done:
    for (size_t i = 0; i < diag.n; i++) fprintf(stderr, "%s\n", diag.messages[i].text);
    if (argc < 2) fprintf(stderr, "usage: bench_accel MESH [RAYS [DENSITY...]]\n");
    bis_geometry_clear(&g);
    bis_diag_clear(&diag);
    for (int i = 0; i < N_SETS; i++) free_rays(&sets[i]);
    return code;
}
