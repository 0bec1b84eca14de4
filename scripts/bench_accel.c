/* bench_accel: the voxel grid against Embree on one mesh. usage: bench_accel MESH [RAYS [DENSITY...]]
 *
 * Rays: from points that a camera sees, one thread, in the order of the pixels: `nearest` from a sphere around the mesh
 * to random points in its box, `any-hit` from each point found into a random direction of its hemisphere, leaving the
 * surface as the renderer does. Both backends get the same rays. Times are the best of three. */
#include "bis/accel.h"
#include "bis/file.h"
#include "obj.h"
#include "ply.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static double now(void)
{
    struct timespec t;

    clock_gettime(CLOCK_MONOTONIC, &t);
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

static vec3 direction(uint64_t *state)
{
    double z = 2 * uniform(state) - 1, phi = 2 * PI * uniform(state), s = sqrt(1 - z * z);

    return vec3_from(s * cos(phi), s * sin(phi), z);
}

typedef struct rays {
    ray *r;
    bis_hit *hits;
    bool *hit;
    size_t n;
} rays;

/* Camera rays: eye on a sphere about the box, 16 views, each scanned in rows. */
static void make_camera_rays(rays *set, const bis_box *box)
{
    const vec3 centre = mul(add(box->lo, box->hi), 0.5);
    const double radius = length(sub(box->hi, box->lo));
    const size_t views = 16, side = (size_t)sqrt((double)set->n / (double)views);
    uint64_t state = 1;

    set->n = views * side * side;
    for (size_t i = 0, v = 0; v < views; v++) {
        const vec3 w = direction(&state), eye = add(centre, mul(w, radius));
        const frame f = frame_about(w);
        for (size_t p = 0; p < side * side; p++, i++) {
            double x = ((double)(p % side) + uniform(&state)) / (double)side - 0.5;
            double y = ((double)(p / side) + uniform(&state)) / (double)side - 0.5;
            vec3 target = add(centre, add(mul(f.x, x * radius * 0.8), mul(f.y, y * radius * 0.8)));
            set->r[i] = (ray){eye, normalize(sub(target, eye)), INFINITY};
        }
    }
}

/* From each point that the camera rays found. */
static void make_shadow_rays(rays *shadow, const rays *camera, const bis_geometry *g)
{
    uint64_t state = 2;

    shadow->n = 0;
    for (size_t i = 0; i < camera->n; i++) {
        bis_surface s;
        if (!camera->hit[i]) continue;
        bis_geometry_surface(g, camera->hits[i].prim, &camera->r[i], &s);
        vec3 w = direction(&state);
        shadow->r[shadow->n++] = (ray){bis_surface_offset(&s), dot(w, s.ng) < 0 ? neg(w) : w, INFINITY};
    }
}

static bool allocate(rays *set, size_t n)
{
    set->r = calloc(n, sizeof *set->r);
    set->hits = calloc(n, sizeof *set->hits);
    set->hit = calloc(n, sizeof *set->hit);
    set->n = n;
    return set->r && set->hits && set->hit;
}

static void free_rays(rays *set)
{
    free(set->r);
    free(set->hits);
    free(set->hit);
}

/* ns per ray, best of three. */
static double time_nearest(const bis_accel *a, rays *set)
{
    double best = INFINITY;

    for (int run = 0; run < 3; run++) {
        double start = now();
        for (size_t i = 0; i < set->n; i++) set->hit[i] = bis_accel_intersect(a, &set->r[i], &set->hits[i]);
        best = fmin(best, now() - start);
    }
    return 1e9 * best / (double)set->n;
}

static double time_any(const bis_accel *a, rays *set)
{
    double best = INFINITY;

    for (int run = 0; run < 3; run++) {
        double start = now();
        for (size_t i = 0; i < set->n; i++) set->hit[i] = bis_accel_occluded(a, &set->r[i]);
        best = fmin(best, now() - start);
    }
    return 1e9 * best / (double)set->n;
}

static double build(bis_accel **a, const bis_geometry *g, bis_accel_kind kind, double density, bis_diag *diag)
{
    double best = INFINITY;

    for (int run = 0; run < 3; run++) {
        const bis_accel_options options = {kind, density, 1};
        double start = now();
        bis_accel_free(*a);
        if (bis_accel_new(a, g, &options, diag)) return INFINITY;
        best = fmin(best, now() - start);
    }
    return best;
}

/* One line of the table, and how far `set`'s answers are from those of the reference. */
static void measure(const char *name, const bis_accel *a, double seconds, rays *camera, rays *shadow, const rays *camera_ref,
                    const rays *shadow_ref, const double ns_ref[2])
{
    size_t other_prim = 0, other_hit = 0, other_shadow = 0;
    double nearest = time_nearest(a, camera), any = time_any(a, shadow);

    for (size_t i = 0; i < camera->n; i++) {
        other_hit += camera->hit[i] != camera_ref->hit[i];
        other_prim += camera->hit[i] && camera_ref->hit[i] && camera->hits[i].prim != camera_ref->hits[i].prim;
    }
    for (size_t i = 0; i < shadow->n; i++) other_shadow += shadow->hit[i] != shadow_ref->hit[i];
    printf("%-12s build %.3f s  %5.1f B/triangle  nearest %4.0f ns (%.2fx)  any-hit %4.0f ns (%.2fx)  differ: hit %zu, prim %zu of "
           "%zu; shadow %zu of %zu\n", name, seconds,
           (double)bis_accel_bytes(a) / (double)bis_geometry_primitives(a->geometry), nearest, nearest / ns_ref[0], any,
           any / ns_ref[1], other_hit, other_prim, camera->n, other_shadow, shadow->n);
}

static bis_status load(bis_geometry *g, const char *path, bis_diag *diag)
{
    const bis_xform identity = bis_xform_identity();
    bis_mesh mesh = {0};
    char ending[8];
    bool obj = strcmp(bis_path_extension(ending, path), ".obj") == 0;
    double start = now();
    bis_status status = obj ? bis_obj_read(&mesh, path, (bis_loc){0}, diag) : bis_ply_read(&mesh, path, (bis_loc){0}, diag);

    if (!status) {
        printf("%s: %zu triangles, read in %.3f s\n", path, mesh.n_triangles, now() - start);
        status = bis_geometry_add_mesh(g, &mesh, &identity, 0, diag);
    }
    bis_mesh_clear(&mesh);
    return status;
}

int main(int argc, char **argv)
{
    const size_t n = argc > 2 ? (size_t)atof(argv[2]) : 1000000;
    rays camera = {0}, shadow = {0}, camera_ref = {0}, shadow_ref = {0};
    bis_accel *reference = NULL, *grid = NULL;
    bis_geometry g = {0};
    bis_diag diag = {0};
    int code = 1;

    if (argc < 2 || load(&g, argv[1], &diag)) goto done;
    if (!allocate(&camera, n) || !allocate(&shadow, n) || !allocate(&camera_ref, n) || !allocate(&shadow_ref, n)) goto done;
    const bool embree = bis_accel_embree_version() != NULL;
    double seconds = build(&reference, &g, BIS_ACCEL_DEFAULT, 0, &diag);
    if (!reference) goto done;
    make_camera_rays(&camera, &g.box);
    make_camera_rays(&camera_ref, &g.box);
    const double nearest = time_nearest(reference, &camera_ref);
    make_shadow_rays(&shadow, &camera_ref, &g);
    make_shadow_rays(&shadow_ref, &camera_ref, &g);
    const double ns_ref[2] = {nearest, time_any(reference, &shadow_ref)};
    measure(embree ? "embree" : "grid", reference, seconds, &camera, &shadow, &camera_ref, &shadow_ref, ns_ref);
    for (int i = 3; i < (argc > 3 ? argc : 4) && embree; i++) {
        const double density = i < argc ? atof(argv[i]) : 0;
        char name[32];
        snprintf(name, sizeof name, density > 0 ? "grid %g" : "grid", density);
        seconds = build(&grid, &g, BIS_ACCEL_GRID, density, &diag);
        if (!grid) goto done;
        measure(name, grid, seconds, &camera, &shadow, &camera_ref, &shadow_ref, ns_ref);
    }
    code = 0;
done:
    for (size_t i = 0; i < diag.n; i++) fprintf(stderr, "%s\n", diag.messages[i].text);
    if (argc < 2) fprintf(stderr, "usage: bench_accel MESH [RAYS [DENSITY...]]\n");
    bis_accel_free(reference);
    bis_accel_free(grid);
    bis_geometry_clear(&g);
    bis_diag_clear(&diag);
    free_rays(&camera);
    free_rays(&shadow);
    free_rays(&camera_ref);
    free_rays(&shadow_ref);
    return code;
}
