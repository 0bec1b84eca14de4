/* SPDX-License-Identifier: BSD-2-Clause */
/* embree: a bounding volume hierarchy by Embree, the fast backend and the grid's witness.
 *
 * The scene is ROBUST: Embree's watertight triangle test, so that it and the grid agree but for ties. Buffers are
 * shared with the geometry, which is why its vertices have a spare one at the end (Embree reads 16 bytes for the last
 * 12).
 * Two things are put right here, so that both backends say the same:
 * - a triangle without area is never hit. In Embree's float arithmetic a collinear one can get a little area; such
 *   triangles get one vertex three times, in an index buffer of our own that exists only if there are any;
 * - t comes from the same double test as the grid's (src/shape/triangle.h), not from Embree's float one.
 * Limits (accel.h; accel.c refuses what lies beyond). Embree takes no ray and no vertex beyond its FLT_LARGE, 1.844e18
 * (kernels of 3.13 and 4): a vertex is left out without a word, a ray fails an assertion. Long before, its float test
 * overflows: with no coordinate difference beyond D, 2 (v - o).(e x f) is at most 2 * 3 D * 2 D^2 = 12 D^3, finite
 * for D up to 3.05e12; what is infinite is no hit. A triangle of size d at a distance D gives D d^2, which is 0 in
 * floats below 1e-45 and has all its digits from 1e-38 on: in a scene of 1e-10 that is so for d > 1e-14, a ten
 * thousandth of it. The source compiles against Embree 3 and 4, whose queries take other arguments. Cost: O(n log n)
 * build. */
#include "embree.h"

#ifndef BIS_EMBREE

bis_status bis_embree_new(bis_accel **out, const bis_geometry *g, int n_threads, bis_diag *diag)
{
    (void)g;
    (void)n_threads;
    *out = NULL;
    return bis_error(
        diag, BIS_INPUT, (bis_loc){0},
        "this program was built without Embree: use the accelerator \"grid\" (--accelerator grid), or install "
        "libembree-dev and build again");
}

const char *bis_accel_embree_version(void) { return NULL; }

#else

#include "bis/base/mem.h"
#include "bis/shape/geometry.h"
#include "triangle.h"

#include <float.h>
#include <stdalign.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#if BIS_EMBREE == 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

enum { TRIANGLES, QUADRICS }; /* Embree's geometry ids */

/* From so many triangles on, Embree keeps indices instead of copies of the vertices: 50 bytes less a triangle. The
 * pictures have the same bits, but rays took a tenth longer with 10^7 triangles, hence not always. */
static const size_t compact_from = BIS_EMBREE_COMPACT;

typedef struct bis_embree {
    bis_accel base;
    RTCDevice device;
    RTCScene scene;
    uint32_t *index;     /* a copy without triangles of no area; NULL: there are none, the geometry's is used */
    atomic_llong bytes;  /* what Embree holds, by its own account */
} bis_embree;

const char *bis_accel_embree_version(void) { return RTC_VERSION_STRING; }

/* ---- queries ---- */

/* Embree's range is closed, [tnear, tfar], ours open. */
static inline struct RTCRay query_ray(const ray *r)
{
    return (struct RTCRay){.org_x = r->o.x, .org_y = r->o.y, .org_z = r->o.z, .tnear = FLT_TRUE_MIN,
                           .dir_x = r->d.x, .dir_y = r->d.y, .dir_z = r->d.z,
                           .tfar = r->tmax < INFINITY ? nextafterf(r->tmax, 0) : FLT_MAX, .mask = UINT32_MAX};
}

/* t of the triangle's plane in double. Embree's own stands where that is no t of the ray: at a tie of an end of the
 * ray, or edge-on. */
static float distance(const bis_geometry *g, uint32_t prim, const ray *r, float embrees)
{
    const uint32_t *index = g->index + 3 * (size_t)prim;
    const sheared_ray sheared = shear_ray(r);
    float v[9];
    double e[3], det, z;

    for (int i = 0; i < 3; i++) memcpy(v + 3 * i, &g->p[index[i]], 3 * sizeof *v);
    if (!shear_test(&sheared, v, e, &det, &z)) return embrees;
    float t = (float)(z / det);
    return t > 0 && t < r->tmax ? t : embrees;
}

static bool intersect(const bis_accel *a, const ray *r, bis_hit *hit)
{
    const bis_embree *embree = (const bis_embree *)a;
    struct RTCRayHit query = {.ray = query_ray(r), .hit = {.geomID = RTC_INVALID_GEOMETRY_ID}};

#if BIS_EMBREE == 4
    rtcIntersect1(embree->scene, &query, NULL);
#else
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(embree->scene, &context, &query);
#endif
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
    if (query.hit.geomID == TRIANGLES) {
        *hit = (bis_hit){distance(a->geometry, query.hit.primID, r, query.ray.tfar), query.hit.primID};
    } else {
        *hit = (bis_hit){query.ray.tfar, (uint32_t)a->geometry->n_triangles + query.hit.primID};
    }
    return true;
}

static bool occluded(const bis_accel *a, const ray *r)
{
    const bis_embree *embree = (const bis_embree *)a;
    struct RTCRay query = query_ray(r);

#if BIS_EMBREE == 4
    rtcOccluded1(embree->scene, &query, NULL);
#else
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(embree->scene, &context, &query);
#endif
    return query.tfar < 0; /* -inf: occluded */
}

/* Packets of 16 rays: one ray's boxes and triangles are in the cache for its neighbours. Embree answers the same for a
 * packet as for its rays one by one (tests/shape/test_accel.c). Where the processor has no vectors of 16, Embree takes
 * the packet apart. */
enum { PACKET = 16 };

/* The n <= PACKET rays r[n]; the other lanes repeat the first and are not valid. */
static void fill_packet(struct RTCRay16 *packet, int valid[PACKET], const ray *r, uint32_t n)
{
    for (uint32_t i = 0; i < PACKET; i++) {
        const struct RTCRay q = query_ray(&r[i < n ? i : 0]);
        valid[i] = i < n ? -1 : 0;
        packet->org_x[i] = q.org_x, packet->org_y[i] = q.org_y, packet->org_z[i] = q.org_z;
        packet->dir_x[i] = q.dir_x, packet->dir_y[i] = q.dir_y, packet->dir_z[i] = q.dir_z;
        packet->tnear[i] = q.tnear, packet->tfar[i] = q.tfar;
        packet->mask[i] = q.mask, packet->time[i] = 0, packet->id[i] = i, packet->flags[i] = 0;
    }
}

/* Camera rays: neighbours run side by side, "coherent" in Embree's words. */
static void intersect_many(const bis_accel *a, const ray *r, uint32_t n, uint32_t *prim)
{
    const bis_embree *embree = (const bis_embree *)a;
    alignas(64) struct RTCRayHit16 packet;
    alignas(64) int valid[PACKET];
#if BIS_EMBREE == 4
    struct RTCIntersectArguments how;
    rtcInitIntersectArguments(&how);
    how.flags = RTC_RAY_QUERY_FLAG_COHERENT;
#else
    struct RTCIntersectContext how;
    rtcInitIntersectContext(&how);
    how.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
#endif

    for (uint32_t first = 0; first < n; first += PACKET) {
        const uint32_t count = n - first < PACKET ? n - first : PACKET;
        fill_packet(&packet.ray, valid, r + first, count);
        for (uint32_t i = 0; i < PACKET; i++) packet.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
#if BIS_EMBREE == 4
        rtcIntersect16(valid, embree->scene, &packet, &how);
#else
        rtcIntersect16(valid, embree->scene, &how, &packet);
#endif
        for (uint32_t i = 0; i < count; i++) {
            const unsigned geometry = packet.hit.geomID[i], id = packet.hit.primID[i];
            prim[first + i] = geometry == RTC_INVALID_GEOMETRY_ID ? BIS_NO_PRIM
                              : geometry == TRIANGLES             ? id
                                                      : (uint32_t)a->geometry->n_triangles + id;
        }
    }
}

/* Shadow rays: neighbours start together and run apart. */
static void occluded_many(const bis_accel *a, const ray *r, uint32_t n, bool *occluded)
{
    const bis_embree *embree = (const bis_embree *)a;
    alignas(64) struct RTCRay16 packet;
    alignas(64) int valid[PACKET];
#if BIS_EMBREE != 4
    struct RTCIntersectContext how;
    rtcInitIntersectContext(&how);
#endif

    for (uint32_t first = 0; first < n; first += PACKET) {
        const uint32_t count = n - first < PACKET ? n - first : PACKET;
        fill_packet(&packet, valid, r + first, count);
#if BIS_EMBREE == 4
        rtcOccluded16(valid, embree->scene, &packet, NULL);
#else
        rtcOccluded16(valid, embree->scene, &how, &packet);
#endif
        for (uint32_t i = 0; i < count; i++) occluded[first + i] = packet.tfar[i] < 0;
    }
}

/* ---- quadrics: Embree's "user geometry" ---- */

static void quadric_bounds(const struct RTCBoundsFunctionArguments *args)
{
    const bis_embree *embree = args->geometryUserPtr;
    const bis_geometry *g = embree->base.geometry;
    const bis_box box = bis_geometry_bounds(g, (uint32_t)g->n_triangles + args->primID);

    *args->bounds_o = (struct RTCBounds){.lower_x = box.lo.x, .lower_y = box.lo.y, .lower_z = box.lo.z,
                                         .upper_x = box.hi.x, .upper_y = box.hi.y, .upper_z = box.hi.z};
}

/* Rays come one by one or in packets: N of them, as arrays of N one behind the other, the hits behind the rays.
 * Embree's header has accessors for C++ alone. */
enum { ORG_X, ORG_Y, ORG_Z, TNEAR, DIR_X, DIR_Y, DIR_Z, TIME, TFAR, PRIM_ID = 17, GEOM_ID, INST_ID };

/* Ray i of N. The range's far end belongs to it: hence the float behind tfar. */
static bool quadric_hit(const bis_embree *embree, uint32_t prim, const float *rays, unsigned N, unsigned i, float *t)
{
    const float *f = rays + i;
    const ray r = {{f[ORG_X * N], f[ORG_Y * N], f[ORG_Z * N]}, {f[DIR_X * N], f[DIR_Y * N], f[DIR_Z * N]},
                   nextafterf(f[TFAR * N], INFINITY)};

    return bis_quadric_intersect(&embree->base.geometry->quadrics[prim], &r, t);
}

static void quadric_intersect(const struct RTCIntersectFunctionNArguments *args)
{
    const unsigned N = args->N;
    float *f = (float *)args->rayhit, t;
    unsigned *id = (unsigned *)args->rayhit;

    for (unsigned i = 0; i < N; i++) {
        if (!args->valid[i] || !quadric_hit(args->geometryUserPtr, args->primID, f, N, i, &t)) continue;
        f[TFAR * N + i] = t;
        id[GEOM_ID * N + i] = args->geomID;
        id[PRIM_ID * N + i] = args->primID;
        id[INST_ID * N + i] = RTC_INVALID_GEOMETRY_ID;
    }
}

static void quadric_occluded(const struct RTCOccludedFunctionNArguments *args)
{
    const unsigned N = args->N;
    float *f = (float *)args->ray, t;

    for (unsigned i = 0; i < N; i++)
        if (args->valid[i] && quadric_hit(args->geometryUserPtr, args->primID, f, N, i, &t))
            f[TFAR * N + i] = -INFINITY;
}

/* ---- construction ---- */

static bool count_bytes(void *embree, ssize_t bytes, bool post)
{
    (void)post;
    atomic_fetch_add(&((bis_embree *)embree)->bytes, bytes);
    return true;
}

/* Embree's last error as one of ours. */
static bis_status check_device(RTCDevice device, bis_diag *diag)
{
    const bis_loc nowhere = {0};

    switch (rtcGetDeviceError(device)) {
    case RTC_ERROR_NONE:
        return BIS_OK;
    case RTC_ERROR_OUT_OF_MEMORY:
        return bis_error(diag, BIS_NOMEM, nowhere,
                         "no memory for Embree's hierarchy; the accelerator \"grid\" needs less");
    case RTC_ERROR_UNSUPPORTED_CPU:
        return bis_error(diag, BIS_INPUT, nowhere,
                         "Embree does not support this processor: use the accelerator \"grid\" (--accelerator grid)");
    default:
        return bis_error(diag, BIS_INPUT, nowhere,
                         "Embree failed for a reason of its own: try the accelerator \"grid\" (--accelerator grid)");
    }
}

static bool triangle_has_area(const bis_geometry *g, size_t i)
{
    const uint32_t *index = g->index + 3 * i;
    const vec3 v[3] = {g->p[index[0]], g->p[index[1]], g->p[index[2]]};

    return has_area(v);
}

/* Embree->index: see the top. */
static bis_status mask_triangles(bis_embree *embree, bis_diag *diag)
{
    const bis_geometry *g = embree->base.geometry;
    size_t first = 0;

    while (first < g->n_triangles && triangle_has_area(g, first)) first++;
    if (first == g->n_triangles) return BIS_OK;
    embree->index = bis_alloc(g->n_triangles, 3 * sizeof *embree->index);
    if (!embree->index) {
        return bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for %zu triangles", g->n_triangles);
    }
    memcpy(embree->index, g->index, 3 * g->n_triangles * sizeof *g->index);
    for (size_t i = first; i < g->n_triangles; i++) {
        if (!triangle_has_area(g, i)) embree->index[3 * i + 1] = embree->index[3 * i + 2] = embree->index[3 * i];
    }
    return BIS_OK;
}

static void attach(const bis_embree *embree, RTCGeometry geometry, unsigned id)
{
    rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_MEDIUM);
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(embree->scene, geometry, id);
    rtcReleaseGeometry(geometry);
}

static void attach_triangles(const bis_embree *embree)
{
    const bis_geometry *g = embree->base.geometry;
    const uint32_t *index = embree->index ? embree->index : g->index;
    RTCGeometry triangles = rtcNewGeometry(embree->device, RTC_GEOMETRY_TYPE_TRIANGLE);

    rtcSetSharedGeometryBuffer(triangles, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, g->p, 0, sizeof *g->p,
                               g->n_vertices);
    rtcSetSharedGeometryBuffer(triangles, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, index, 0, 3 * sizeof *index,
                               g->n_triangles);
    attach(embree, triangles, TRIANGLES);
}

static void attach_quadrics(bis_embree *embree)
{
    RTCGeometry quadrics = rtcNewGeometry(embree->device, RTC_GEOMETRY_TYPE_USER);

    rtcSetGeometryUserPrimitiveCount(quadrics, (unsigned)embree->base.geometry->n_quadrics);
    rtcSetGeometryUserData(quadrics, embree);
    rtcSetGeometryBoundsFunction(quadrics, quadric_bounds, NULL);
    rtcSetGeometryIntersectFunction(quadrics, quadric_intersect);
    rtcSetGeometryOccludedFunction(quadrics, quadric_occluded);
    attach(embree, quadrics, QUADRICS);
}

static size_t bytes(const bis_accel *a)
{
    const bis_embree *embree = (const bis_embree *)a;
    size_t own = sizeof *embree + (embree->index ? 3 * a->geometry->n_triangles * sizeof *embree->index : 0);

    return own + (size_t)atomic_load(&embree->bytes);
}

static void free_embree(bis_accel *a)
{
    bis_embree *embree = (bis_embree *)a;

    if (!embree) return;
    if (embree->scene) rtcReleaseScene(embree->scene);
    if (embree->device) rtcReleaseDevice(embree->device);
    bis_free(embree->index);
    bis_free(embree);
}

static const bis_accel_ops embree_ops = {"embree",    intersect,      occluded,     bytes,
                                         free_embree, intersect_many, occluded_many};

bis_status bis_embree_new(bis_accel **out, const bis_geometry *g, int n_threads, bis_diag *diag)
{
    bis_embree *embree = bis_alloc(1, sizeof *embree);
    char config[32] = "";
    bis_status status;

    *out = NULL;
    if (!embree) return bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for Embree's hierarchy");
    embree->base = (bis_accel){&embree_ops, g};
    status = mask_triangles(embree, diag);
    if (status) goto done;
    if (n_threads > 0) snprintf(config, sizeof config, "threads=%d", n_threads);
    embree->device = rtcNewDevice(config);
    if (!embree->device) {
        status = check_device(NULL, diag);
        goto done;
    }
    rtcSetDeviceMemoryMonitorFunction(embree->device, count_bytes, embree);
    embree->scene = rtcNewScene(embree->device);
    rtcSetSceneFlags(embree->scene, g->n_triangles < compact_from ? RTC_SCENE_FLAG_ROBUST
                                                                  : RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_COMPACT);
    rtcSetSceneBuildQuality(embree->scene, RTC_BUILD_QUALITY_MEDIUM);
    if (g->n_triangles > 0) attach_triangles(embree);
    if (g->n_quadrics > 0) attach_quadrics(embree);
    rtcCommitScene(embree->scene);
    status = check_device(embree->device, diag);
    if (status) goto done;
    *out = &embree->base;
    embree = NULL;
done:
    free_embree((bis_accel *)embree);
    return status;
}

#endif
