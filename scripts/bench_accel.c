/* bench_accel: the voxel grid against Embree on one mesh. usage: bench_accel MESH [RAYS [DENSITY...]]
 *
 * Rays: from points that a camera sees, one thread, in the order of the pixels: `nearest` from a sphere around the mesh
 * to random points in its box, `any-hit` from each point found into a random direction of its hemisphere, leaving the
 * surface as the renderer does. Both backends get the same rays, in turns, so that a busy machine is so for both; times are
 * the best of five. Without Embree only the grid's figures are printed. */
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

/* One run over the rays, in ns per ray. */
static double time_nearest(const bis_accel *a, rays *set)
{
    double start = now();

    for (size_t i = 0; i < set->n; i++) set->hit[i] = bis_accel_intersect(a, &set->r[i], &set->hits[i]);
    return 1e9 * (now() - start) / (double)set->n;
}

static double time_any(const bis_accel *a, rays *set)
{
    double start = now();

    for (size_t i = 0; i < set->n; i++) set->hit[i] = bis_accel_occluded(a, &set->r[i]);
    return 1e9 * (now() - start) / (double)set->n;
}

static double build(bis_accel **a, const bis_geometry *g, bis_accel_kind kind, double density, bis_diag *diag)
{
    double best = (double)INFINITY;

    for (int run = 0; run < 3; run++) {
        const bis_accel_options options = {kind, density, 1};
        double start = now();
        bis_accel_free(*a);
        if (bis_accel_new(a, g, &options, diag)) return (double)INFINITY;
        best = fmin(best, now() - start);
    }
    return best;
}

/* One backend with its rays' answers. */
typedef struct bench {
    const char *name;
    bis_accel *accel;
    double build, nearest, any; /* s, ns, ns */
    rays camera, shadow;
} bench;

static void print(const bench *b)
{
    const size_t n = bis_geometry_primitives(b->accel->geometry);

    printf("%-8s build %.3f s  %5.1f B/triangle  nearest %4.0f ns  any-hit %4.0f ns\n", b->name, b->build,
           (double)bis_accel_bytes(b->accel) / (double)n, b->nearest, b->any);
}

/* Times in turns, the ratio, and on how many rays the two differ. */
static void compare(bench *embree, bench *grid)
{
    size_t other_hit = 0, other_prim = 0, other_shadow = 0;

    embree->nearest = embree->any = grid->nearest = grid->any = (double)INFINITY;
    for (int run = 0; run < 5; run++) {
        embree->nearest = fmin(embree->nearest, time_nearest(embree->accel, &embree->camera));
        grid->nearest = fmin(grid->nearest, time_nearest(grid->accel, &grid->camera));
        embree->any = fmin(embree->any, time_any(embree->accel, &embree->shadow));
        grid->any = fmin(grid->any, time_any(grid->accel, &grid->shadow));
    }
    for (size_t i = 0; i < grid->camera.n; i++) {
        const bool both = grid->camera.hit[i] && embree->camera.hit[i];
        other_hit += grid->camera.hit[i] != embree->camera.hit[i];
        other_prim += both && grid->camera.hits[i].prim != embree->camera.hits[i].prim;
    }
    for (size_t i = 0; i < grid->shadow.n; i++) other_shadow += grid->shadow.hit[i] != embree->shadow.hit[i];
    print(embree);
    print(grid);
    printf("grid : embree  build %.2f  nearest %.2f  any-hit %.2f\n", grid->build / embree->build, grid->nearest / embree->nearest,
           grid->any / embree->any);
    printf("disagreements  hit or miss: %zu of %zu nearest, %zu of %zu any-hit; neighbour named on a shared edge: %zu\n", other_hit,
           grid->camera.n, other_shadow, grid->shadow.n, other_prim);
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

/* The two sets of rays, from what `a` sees. */
static bool make_rays(bench *b, const bis_accel *a, size_t n)
{
    if (!allocate(&b->camera, n) || !allocate(&b->shadow, n)) return false;
    make_camera_rays(&b->camera, &a->geometry->box);
    time_nearest(a, &b->camera);
    make_shadow_rays(&b->shadow, &b->camera, a->geometry);
    return true;
}

int main(int argc, char **argv)
{
    const size_t n = argc > 2 ? (size_t)atof(argv[2]) : 1000000;
    bench embree = {.name = "embree"}, grid = {.name = "grid"};
    bis_geometry g = {0};
    bis_diag diag = {0};
    int code = 1;

    if (argc < 2 || load(&g, argv[1], &diag)) goto done;
    for (int i = 3; i < (argc > 3 ? argc : 4); i++) {
        const double density = i < argc ? atof(argv[i]) : 0;
        if (density > 0) printf("density %g\n", density);
        grid.build = build(&grid.accel, &g, BIS_ACCEL_GRID, density, &diag);
        if (!grid.accel || (!grid.camera.r && !make_rays(&grid, grid.accel, n))) goto done;
        if (!bis_accel_embree_version()) {
            grid.nearest = time_nearest(grid.accel, &grid.camera);
            grid.any = time_any(grid.accel, &grid.shadow);
            print(&grid);
            continue;
        }
        if (!embree.accel) embree.build = build(&embree.accel, &g, BIS_ACCEL_EMBREE, 0, &diag);
        if (!embree.accel || (!embree.camera.r && !make_rays(&embree, grid.accel, n))) goto done;
        compare(&embree, &grid);
    }
    code = 0;
done:
    for (size_t i = 0; i < diag.n; i++) fprintf(stderr, "%s\n", diag.messages[i].text);
    if (argc < 2) fprintf(stderr, "usage: bench_accel MESH [RAYS [DENSITY...]]\n");
    bis_accel_free(embree.accel);
    bis_accel_free(grid.accel);
    bis_geometry_clear(&g);
    bis_diag_clear(&diag);
    free_rays(&embree.camera);
    free_rays(&embree.shadow);
    free_rays(&grid.camera);
    free_rays(&grid.shadow);
    return code;
}
