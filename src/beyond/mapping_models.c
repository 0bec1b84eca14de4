/* SPDX-License-Identifier: BSD-2-Clause */
/* mapping_models: the mappings, each by three functions (docs/scene-format.md, "LightSource").
 *
 * angular: the pixel at polar position (r, a) of the disc (r = 1 at the rim, a from image right, counter-clockwise) is
 * the direction (-cos(pi r), -sin(pi r) cos a, sin(pi r) sin a). The disc's area element r dr da is sin(pi r) pi dr da
 * on the sphere. A pixel of area (2/side)^2 therefore subtends pi^2 sin(pi r)/(pi r) (2/side)^2.
 * mirrorball: what a small mirror ball shows to a far eye, turned so that its middle looks where that of an angular map
 * does. The angle t of the middle is 2 asin r, and sin t dt da = 4 r dr da: all pixels subtend 4 (2/side)^2.
 * equalarea: |x| + |y| <= 1 of the square [-1, 1]^2 is the upper hemisphere, r = 1 - |1 - |x| - |y|| with
 * |cos theta| = 1 - r^2, and the azimuth goes linearly along the diagonals of constant r; the corners are the lower
 * hemisphere, folded out.
 * cube: the pixel at (a, b) in [-1, 1]^2 of a face is the direction (1, a, b)/|(1, a, b)| of the face's own axes. The
 * solid angle of [0, a] x [0, b] is atan(a b / sqrt(1 + a^2 + b^2)).
 *
 * Places and directions are floats in lanes, because a map of 10^6 pixels is looked up at 2 * 10^7 places: 2 to 4 ns
 * each, where one place after the other in double took 90. A direction is wrong by less than 10^-6, so a place that
 * close to an edge of a pixel may be given to the neighbour: a thousandth of a pixel in a map 8192 wide. */
#include "mapping_models.h"

#include "bis/thesis/lanes.h"
#include "thesis/light_many.h"

#include <math.h>
#include <string.h>

#include <assert.h>

/* Of a loop over lanes: i within [0, n). */
static inline BIS_INLINE int32_t clamp(int32_t i, int32_t n) { return i < 0 ? 0 : i < n ? i : n - 1; }

/* |x|, and x with the sign of `of`. */
static inline BIS_INLINE float magnitude(float x) { return bis_lanes_choose(x < 0, -x, x); }
static inline BIS_INLINE float with_sign(float x, float of) { return bis_lanes_choose(of < 0, -x, x); }

/* ---- lat-long ---- */

BIS_LANES
static void latlong_lanes(bis_samples *s, float u0, float v0, float column, float row, const bis_places *places)
{
    const bis_places p = *places;
#pragma omp simd
    for (uint32_t i = 0; i < p.n; i++) {
        float sin_theta, cos_theta, sin_phi, cos_phi;
        bis_lanes_sincos2pi((v0 + p.dy[i] * row) / 2, &sin_theta, &cos_theta);
        bis_lanes_sincos2pi(u0 + p.dx[i] * column, &sin_phi, &cos_phi);
        s->x[i] = sin_theta * cos_phi;
        s->y[i] = sin_theta * sin_phi;
        s->z[i] = cos_theta;
        s->weight[i] = sin_theta;
    }
}

static void latlong_directions(bis_samples *s, const bis_raster *r, int x, int y, const bis_places *places)
{
    latlong_lanes(s, (float)((x + 0.5) / r->width), (float)((y + 0.5) / r->height), 1 / (float)r->width,
                  1 / (float)r->height, places);
}

static void latlong_pixels(const bis_raster *r, bis_samples *s, uint32_t n)
{
    static const vec3 axis[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    const bis_envmap size = {.width = r->width, .height = r->height};
    bis_envmap_pixels(&size, axis, s->pixel, &(bis_lanes){.x = s->x, .y = s->y, .z = s->z}, n);
}

static double latlong_solid_angle(const bis_raster *r, int x, int y)
{
    (void)x;
    return 4 * PI / r->width * sin(PI * (y + 0.5) / r->height) * sin(PI / 2 / r->height);
}

/* ---- discs ---- */

/* Stores the centre of pixel (x, y) on the disc: q[0] to the right, q[1] up, |q| = 1 at the rim. */
static void disc_position(const bis_raster *r, int x, int y, double q[2])
{
    q[0] = 2 * (x + 0.5) / r->width - 1;
    q[1] = 1 - 2 * (y + 0.5) / r->width;
}

/* Directions of a disc, by the lanes of its own formula. */
static void disc_directions(bis_samples *s, void lanes(bis_samples *, float, float, float, const bis_places *),
                            const bis_raster *r, int x, int y, const bis_places *places)
{
    double q[2];
    disc_position(r, x, y, q);
    lanes(s, (float)q[0], (float)q[1], 2 / (float)r->width, places);
}

/* Whether a pixel's centre lies on the disc: in integers, so that all who ask have one answer. A side has at most 2^15
 * pixels, so the sum of the two squares is at most 2^31. */
static inline BIS_INLINE bool in_disc(int32_t side, int32_t x, int32_t y)
{
    const uint32_t a = (uint32_t)(2 * x + 1 - side), b = (uint32_t)(2 * y + 1 - side);
    return a * a + b * b <= (uint32_t)side * (uint32_t)side;
}

static inline BIS_INLINE int32_t column_of(float place, float sides, int32_t side)
{
    return clamp((int32_t)((place + 1) / 2 * sides), side);
}

/* The pixel at distance `radius` of the middle, on the ray along (right, up), a vector of length h. All points of a
 * pixel lie within half a diagonal, sqrt(2)/side, of its centre. A pixel on the rim whose centre lies outside the disc
 * is ignored; the one half a diagonal nearer to the middle (and a little more, for the rounding of floats) is used
 * instead, which is inside. */
static inline BIS_INLINE uint32_t disc_pixel(int32_t side, float radius, float right, float up, float h)
{
    const float sides = (float)side, step = 1.4143f / sides;
    const float length = bis_lanes_choose(h > 0, h, 1), cos_a = right / length, sin_a = up / length;
    const bool inside = in_disc(side, column_of(radius * cos_a, sides, side), column_of(-radius * sin_a, sides, side));
    const float r = bis_lanes_choose(inside, radius, radius - step);
    return (uint32_t)(column_of(-r * sin_a, sides, side) * side + column_of(r * cos_a, sides, side));
}

BIS_LANES
static void angular_lanes(bis_samples *s, float u0, float v0, float pixel, const bis_places *places)
{
    const bis_places p = *places;
#pragma omp simd
    for (uint32_t i = 0; i < p.n; i++) {
        const float u = u0 + p.dx[i] * pixel, v = v0 - p.dy[i] * pixel, radius = sqrtf(u * u + v * v);
        float sine, cosine;
        bis_lanes_sincos2pi(radius / 2, &sine, &cosine);
        const float times = bis_lanes_choose(radius > 0, sine / bis_lanes_choose(radius > 0, radius, 1), 3.14159265f);
        s->x[i] = -cosine;
        s->y[i] = -times * u;
        s->z[i] = times * v;
        s->weight[i] = bis_lanes_choose(radius > 1, 0, times);
    }
}

static void angular_directions(bis_samples *s, const bis_raster *r, int x, int y, const bis_places *places)
{
    disc_directions(s, angular_lanes, r, x, y, places);
}

BIS_LANES
static void angular_pixel_lanes(int32_t side, bis_samples *s, uint32_t n)
{
#pragma omp simd
    for (uint32_t i = 0; i < n; i++) {
        const float h = sqrtf(s->y[i] * s->y[i] + s->z[i] * s->z[i]);
        const float radius = bis_lanes_atan2(h, -s->x[i]) * 0.318309886f; /* 1/pi */
        s->pixel[i] = disc_pixel(side, radius, -s->y[i], s->z[i], h);
    }
}

static void angular_pixels(const bis_raster *r, bis_samples *s, uint32_t n) { angular_pixel_lanes(r->width, s, n); }

static double sinc(double t) { return t > 0 ? sin(t) / t : 1; }

/* Returns pi^2 sinc(pi r) dA, see above. */
static double angular_solid_angle(const bis_raster *r, int x, int y)
{
    double q[2];
    disc_position(r, x, y, q);
    if (!in_disc(r->width, x, y)) return 0;
    return 4 * PI * PI * sinc(PI * hypot(q[0], q[1])) / r->width / r->width;
}

BIS_LANES
static void ball_lanes(bis_samples *s, float u0, float v0, float pixel, const bis_places *places)
{
    const bis_places p = *places;
#pragma omp simd
    for (uint32_t i = 0; i < p.n; i++) {
        const float u = u0 + p.dx[i] * pixel, v = v0 - p.dy[i] * pixel, radius2 = u * u + v * v;
        const float times = 2 * sqrtf(bis_lanes_choose(radius2 > 1, 0, 1 - radius2)); /* sin t / r, r = sin(t/2) */
        s->x[i] = bis_lanes_choose(radius2 > 1, 1, 2 * radius2 - 1);
        s->y[i] = -times * u;
        s->z[i] = times * v;
        s->weight[i] = bis_lanes_choose(radius2 > 1, 0, 1);
    }
}

static void ball_directions(bis_samples *s, const bis_raster *r, int x, int y, const bis_places *places)
{
    disc_directions(s, ball_lanes, r, x, y, places);
}

/* Of the angle t from the middle, -x is the cosine and h the sine: sin(t/2) = h / sqrt(2 (1 - x)) in front and
 * sqrt((1 + x) / 2) behind, where neither cancels. */
BIS_LANES
static void ball_pixel_lanes(int32_t side, bis_samples *s, uint32_t n)
{
#pragma omp simd
    for (uint32_t i = 0; i < n; i++) {
        const float x = s->x[i], h = sqrtf(s->y[i] * s->y[i] + s->z[i] * s->z[i]);
        const float ahead = bis_lanes_choose(x < 0, 1 - x, 1), behind = bis_lanes_choose(x < 0, 0, 1 + x);
        const float radius = bis_lanes_choose(x < 0, h / sqrtf(2 * ahead), sqrtf(behind / 2));
        s->pixel[i] = disc_pixel(side, radius, -s->y[i], s->z[i], h);
    }
}

static void ball_pixels(const bis_raster *r, bis_samples *s, uint32_t n) { ball_pixel_lanes(r->width, s, n); }

static double ball_solid_angle(const bis_raster *r, int x, int y)
{
    return in_disc(r->width, x, y) ? 16.0 / r->width / r->width : 0;
}

/* ---- equal-area square ---- */

BIS_LANES
static void equalarea_lanes(bis_samples *s, float u0, float v0, float pixel, const bis_places *places)
{
    const bis_places p = *places;
#pragma omp simd
    for (uint32_t i = 0; i < p.n; i++) {
        const float u = u0 + p.dx[i] * pixel, v = v0 + p.dy[i] * pixel, au = magnitude(u), av = magnitude(v);
        const float above = 1 - au - av, radius = 1 - magnitude(above); /* above 0: the upper hemisphere */
        const float turn = (av - au) / bis_lanes_choose(radius > 0, radius, 1) / 8 + 0.125f;
        const float sin_theta = radius * sqrtf(2 - radius * radius);
        float sine, cosine;
        bis_lanes_sincos2pi(turn, &sine, &cosine);
        s->x[i] = with_sign(sin_theta * cosine, u);
        s->y[i] = with_sign(sin_theta * sine, v);
        s->z[i] = with_sign(1 - radius * radius, above);
        s->weight[i] = 1;
    }
}

static void equalarea_directions(bis_samples *s, const bis_raster *r, int x, int y, const bis_places *places)
{
    equalarea_lanes(s, (float)(2 * (x + 0.5) / r->width - 1), (float)(2 * (y + 0.5) / r->width - 1),
                    2 / (float)r->width, places);
}

BIS_LANES
static void equalarea_pixel_lanes(int32_t side, bis_samples *s, uint32_t n)
{
    const float sides = (float)side;
#pragma omp simd
    for (uint32_t i = 0; i < n; i++) {
        const float x = s->x[i], y = s->y[i], z = s->z[i];
        const float radius = sqrtf((x * x + y * y) / (1 + magnitude(z))); /* 1 - |z| without cancellation */
        const float share = bis_lanes_atan2(magnitude(y), magnitude(x)) * 0.636619772f; /* 2/pi */
        const float u = radius * (1 - share), v = radius * share;
        const float folded_u = bis_lanes_choose(z < 0, 1 - v, u), folded_v = bis_lanes_choose(z < 0, 1 - u, v);
        s->pixel[i] = (uint32_t)(column_of(with_sign(folded_v, y), sides, side) * side +
                                 column_of(with_sign(folded_u, x), sides, side));
    }
}

static void equalarea_pixels(const bis_raster *r, bis_samples *s, uint32_t n) { equalarea_pixel_lanes(r->width, s, n); }

static double equalarea_solid_angle(const bis_raster *r, int x, int y)
{
    (void)x;
    (void)y;
    return 4 * PI / r->width / r->width;
}

/* ---- cubes ---- */

/* Where a face lies in the picture, in faces, and its axes: 1 front, 2 right, 3 up; negative: the opposite. */
typedef struct cube_face {
    int column, row, ahead, right, up;
} cube_face;

enum { FRONT = 1, RIGHT = 2, UP = 3 };

static const cube_face vertical_cross[6] = {
    {1, 0, UP, RIGHT, -FRONT},  {0, 1, -RIGHT, FRONT, UP},    {1, 1, FRONT, RIGHT, UP},
    {2, 1, RIGHT, -FRONT, UP},  {1, 2, -UP, RIGHT, FRONT},    {1, 3, -FRONT, RIGHT, -UP},
};
static const cube_face horizontal_cross[6] = {
    {1, 0, UP, RIGHT, -FRONT},  {0, 1, -RIGHT, FRONT, UP},    {1, 1, FRONT, RIGHT, UP},
    {2, 1, RIGHT, -FRONT, UP},  {3, 1, -FRONT, -RIGHT, UP},   {1, 2, -UP, RIGHT, FRONT},
};
/* The order and the orientation of the faces of a cube map in OpenGL and Direct3D: +x -x +y -y +z -z, with +z front. */
static const cube_face strip_across[6] = {
    {0, 0, RIGHT, -FRONT, UP},  {1, 0, -RIGHT, FRONT, UP},    {2, 0, UP, RIGHT, -FRONT},
    {3, 0, -UP, RIGHT, FRONT},  {4, 0, FRONT, RIGHT, UP},     {5, 0, -FRONT, -RIGHT, UP},
};
static const cube_face strip_down[6] = {
    {0, 0, RIGHT, -FRONT, UP},  {0, 1, -RIGHT, FRONT, UP},    {0, 2, UP, RIGHT, -FRONT},
    {0, 3, -UP, RIGHT, FRONT},  {0, 4, FRONT, RIGHT, UP},     {0, 5, -FRONT, -RIGHT, UP},
};

static const cube_face *faces_of(const bis_raster *r, int *side)
{
    switch (r->mapping) {
    case BIS_MAPPING_VERTICAL_CROSS: *side = r->width / 3; return vertical_cross;
    case BIS_MAPPING_HORIZONTAL_CROSS: *side = r->width / 4; return horizontal_cross;
    default: break;
    }
    const bool down = r->height > r->width;
    *side = down ? r->width : r->height;
    return down ? strip_down : strip_across;
}

/* The centre of pixel (x, y) on the face that it lies on, each in (-1, 1), b up. NULL: it lies on none. */
static const cube_face *face_at(const bis_raster *r, int x, int y, double *a, double *b, int *side)
{
    const cube_face *faces = faces_of(r, side);
    const double u = (x + 0.5) / *side, v = (y + 0.5) / *side;
    for (int i = 0; i < 6; i++) {
        *a = 2 * (u - faces[i].column) - 1;
        *b = 1 - 2 * (v - faces[i].row);
        if (fabs(*a) < 1 && fabs(*b) < 1) return &faces[i];
    }
    return NULL;
}

/* The unit vector of an axis in the light's frame. */
static vec3 axis_vector(int axis)
{
    const float sign = axis < 0 ? -1.f : 1.f;
    switch (axis < 0 ? -axis : axis) {
    case FRONT: return (vec3){-sign, 0, 0};
    case RIGHT: return (vec3){0, -sign, 0};
    default: return (vec3){0, 0, sign};
    }
}

static inline BIS_INLINE float along(vec3 axis, float x, float y, float z)
{
    return x * axis.x + y * axis.y + z * axis.z;
}

BIS_LANES
static void cube_lanes(bis_samples *s, const vec3 axis[3], float a0, float b0, float pixel, const bis_places *places)
{
    const bis_places p = *places;
    const vec3 ahead = axis[0], right = axis[1], up = axis[2];
#pragma omp simd
    for (uint32_t i = 0; i < p.n; i++) {
        const float a = a0 + p.dx[i] * pixel, b = b0 - p.dy[i] * pixel, t = 1 / sqrtf(1 + a * a + b * b);
        s->x[i] = t * (ahead.x + a * right.x + b * up.x);
        s->y[i] = t * (ahead.y + a * right.y + b * up.y);
        s->z[i] = t * (ahead.z + a * right.z + b * up.z);
        s->weight[i] = t * t * t;
    }
}

static void cube_directions(bis_samples *s, const bis_raster *r, int x, int y, const bis_places *places)
{
    double a, b;
    int side;
    const cube_face *f = face_at(r, x, y, &a, &b, &side);
    if (!f) { /* where a picture shows nothing; x, y and z only have to be numbers */
        memset(s, 0, sizeof *s);
        return;
    }
    const vec3 axis[3] = {axis_vector(f->ahead), axis_vector(f->right), axis_vector(f->up)};
    cube_lanes(s, axis, (float)a, (float)b, 2 / (float)side, places);
}

/* The pixels of the directions that this face shows; first: its first pixel. A direction on an edge has two faces, of
 * which the later one stays. */
BIS_LANES
static void cube_pixel_lanes(const vec3 axis[3], int32_t first, int32_t width, int32_t side, bis_samples *s, uint32_t n)
{
    const vec3 ahead = axis[0], right = axis[1], up = axis[2];
    const float sides = (float)side;
#pragma omp simd
    for (uint32_t i = 0; i < n; i++) {
        const float x = s->x[i], y = s->y[i], z = s->z[i], c = along(ahead, x, y, z);
        const float divisor = bis_lanes_choose(c > 0, c, 1);
        const float a = along(right, x, y, z) / divisor, b = along(up, x, y, z) / divisor;
        const int32_t here = first + column_of(-b, sides, side) * width + column_of(a, sides, side);
        const int32_t mask = -((int32_t)(c > 0) & (int32_t)(magnitude(a) <= 1) & (int32_t)(magnitude(b) <= 1));
        s->pixel[i] = (s->pixel[i] & (uint32_t)~mask) | (uint32_t)(here & mask);
    }
}

static void cube_pixels(const bis_raster *r, bis_samples *s, uint32_t n)
{
    int side;
    const cube_face *faces = faces_of(r, &side);
    for (const cube_face *f = faces; f < faces + 6; f++) {
        const vec3 axis[3] = {axis_vector(f->ahead), axis_vector(f->right), axis_vector(f->up)};
        cube_pixel_lanes(axis, (f->row * r->width + f->column) * side, r->width, side, s, n);
    }
}

static double solid_angle_to(double a, double b) { return atan(a * b / sqrt(1 + a * a + b * b)); }

static double cube_solid_angle(const bis_raster *r, int x, int y)
{
    double a, b;
    int side;
    if (!face_at(r, x, y, &a, &b, &side)) return 0;
    const double h = 1.0 / side; /* half of a pixel */
    return solid_angle_to(a + h, b + h) - solid_angle_to(a - h, b + h) - solid_angle_to(a + h, b - h) +
           solid_angle_to(a - h, b - h);
}

/* ---- the table ---- */

/* turn: of an equal-area pixel, of solid angle 4 pi / n^2, the side is 2 sqrt(pi) / n; of a mirror ball's it is 4/n. */
const bis_mapping_model bis_mapping_models[BIS_N_MAPPINGS] = {
    {"twice as wide as high", 2, 1, 2, 2, latlong_directions, latlong_pixels, latlong_solid_angle},
    {"square", 1, 1, 1, 2, angular_directions, angular_pixels, angular_solid_angle},
    {"square", 1, 1, 1.7724538509055161, 2, equalarea_directions, equalarea_pixels, equalarea_solid_angle},
    {"square", 1, 1, PI / 2, 2, ball_directions, ball_pixels, ball_solid_angle},
    {"of 3 x 4 square faces", 3, 4, 4, 4, cube_directions, cube_pixels, cube_solid_angle},
    {"of 4 x 3 square faces", 4, 3, 4, 4, cube_directions, cube_pixels, cube_solid_angle},
    {"a row or column of 6 square faces", 6, 1, 4, 4, cube_directions, cube_pixels, cube_solid_angle},
};

const char *const bis_mapping_names[BIS_N_MAPPINGS + 1] = {
    "latlong", "angular", "equalarea", "mirrorball", "verticalcross", "horizontalcross", "cubestrip", NULL};

bis_mapping bis_mapping_find(const char *name)
{
    int i = 0;
    while (i < BIS_N_MAPPINGS && strcmp(bis_mapping_names[i], name) != 0) i++;
    return (bis_mapping)i;
}

const char *bis_mapping_shape(bis_mapping mapping) { return bis_mapping_models[mapping].shape; }

bool bis_mapping_fits(bis_mapping mapping, int width, int height)
{
    const bis_mapping_model *m = &bis_mapping_models[mapping];
    const bool is_column = mapping == BIS_MAPPING_CUBE_STRIP && height > width;
    const int columns = is_column ? m->rows : m->columns, rows = is_column ? m->columns : m->rows;

    if (mapping == BIS_MAPPING_LATLONG) return width > 0 && height > 0;
    return width > 0 && width % columns == 0 && (int64_t)height * columns == (int64_t)width * rows;
}

int bis_mapping_width(bis_mapping mapping, int width, int height, int wanted)
{
    const bis_mapping_model *m = &bis_mapping_models[mapping];
    const int cell = height > width ? height / (m->rows > m->columns ? m->rows : m->columns) : width / m->columns;
    assert(bis_mapping_fits(mapping, width, height) && wanted >= 0);
    if (mapping == BIS_MAPPING_LATLONG) return width;
    if (wanted == 0) wanted = m->detail * cell;
    return wanted + wanted % 2;
}
