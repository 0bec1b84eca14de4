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
 * solid angle of [0, a] x [0, b] is atan(a b / sqrt(1 + a^2 + b^2)). */
#include "mapping_models.h"

#include <math.h>
#include <string.h>

#include <assert.h>

static int clamp(int i, int n) { return i < 0 ? 0 : i < n ? i : n - 1; }

static size_t index_of(const bis_raster *r, int x, int y) { return (size_t)y * (size_t)r->width + (size_t)x; }

/* ---- lat-long ---- */

static double latlong_direction(const bis_raster *r, int x, int y, double dx, double dy, double d[3])
{
    const double phi = 2 * PI * (x + dx + 0.5) / r->width, v = (y + dy + 0.5) / r->height;
    const double theta = PI * fmin(fmax(v, 0), 1);
    d[0] = sin(theta) * cos(phi);
    d[1] = sin(theta) * sin(phi);
    d[2] = cos(theta);
    return sin(theta);
}

static size_t latlong_pixel(const bis_raster *r, const double d[3])
{
    const bis_envmap size = {.width = r->width, .height = r->height};
    return bis_envmap_pixel(&size, vec3_from(d[0], d[1], d[2]));
}

static double latlong_solid_angle(const bis_raster *r, int x, int y)
{
    (void)x;
    return 4 * PI / r->width * sin(PI * (y + 0.5) / r->height) * sin(PI / 2 / r->height);
}

/* ---- discs ---- */

/* Stores the centre of pixel (x, y) on the disc: q[0] to the right, q[1] up, |q| = 1 at the rim. x and y may be
 * fractional. */
static void disc_position(const bis_raster *r, double x, double y, double q[2])
{
    q[0] = 2 * (x + 0.5) / r->width - 1;
    q[1] = 1 - 2 * (y + 0.5) / r->width;
}

static bool in_disc(const bis_raster *r, int x, int y)
{
    double q[2];
    disc_position(r, x, y, q);
    return q[0] * q[0] + q[1] * q[1] <= 1;
}

/* The pixel at distance `radius` of the middle, on the ray along (cos_a, sin_a). */
static size_t disc_pixel(const bis_raster *p, double radius, double cos_a, double sin_a)
{
    const int side = p->width;
    for (;;) {
        int column = (int)((radius * cos_a + 1) / 2 * side), row = (int)((1 - radius * sin_a) / 2 * side);
        if (column == side) column--; /* the rim itself */
        if (row == side) row--;

        /* All points of a pixel lie within half a diagonal, sqrt(2)/side, of its centre. A rim pixel whose centre
         * lies outside the disc is ignored; its neighbour towards the centre is used instead. */
        const double surely_inside = 1 - sqrt(2) / side;
        if (radius < surely_inside || in_disc(p, column, row)) return index_of(p, column, row);
        radius -= sqrt(2) / side;
    }
}

/* The direction's angle from the middle of the disc, in [0, pi], and its azimuth there. */
static double angle_from_middle(const double d[3], double *cos_a, double *sin_a)
{
    const double h = sqrt(d[1] * d[1] + d[2] * d[2]);
    *cos_a = h > 0 ? -d[1] / h : 1;
    *sin_a = h > 0 ? d[2] / h : 0;
    return atan2(h, -d[0]);
}

static double sinc(double t) { return t > 0 ? sin(t) / t : 1; }

static double angular_direction(const bis_raster *r, int x, int y, double dx, double dy, double d[3])
{
    double q[2];
    disc_position(r, x + dx, y + dy, q);
    const double radius = hypot(q[0], q[1]);
    if (q[0] * q[0] + q[1] * q[1] > 1) return 0;
    const double s = radius > 0 ? sin(PI * radius) / radius : 0;
    d[0] = -cos(PI * radius);
    d[1] = -s * q[0];
    d[2] = s * q[1];
    return sinc(PI * radius);
}

static size_t angular_pixel(const bis_raster *r, const double d[3])
{
    double cos_a, sin_a;
    const double angle = angle_from_middle(d, &cos_a, &sin_a);
    return disc_pixel(r, angle / PI, cos_a, sin_a);
}

/* Returns pi^2 sinc(pi r) dA, see above. */
static double angular_solid_angle(const bis_raster *r, int x, int y)
{
    double q[2];
    disc_position(r, x, y, q);
    if (!in_disc(r, x, y)) return 0;
    return 4 * PI * PI * sinc(PI * hypot(q[0], q[1])) / r->width / r->width;
}

static double ball_direction(const bis_raster *r, int x, int y, double dx, double dy, double d[3])
{
    double q[2];
    disc_position(r, x + dx, y + dy, q);
    const double radius2 = q[0] * q[0] + q[1] * q[1];
    if (radius2 > 1) return 0;
    const double s = 2 * sqrt(1 - radius2); /* sin t / r, where r = sin(t/2) */
    d[0] = 2 * radius2 - 1;
    d[1] = -s * q[0];
    d[2] = s * q[1];
    return 1;
}

static size_t ball_pixel(const bis_raster *r, const double d[3])
{
    double cos_a, sin_a;
    const double angle = angle_from_middle(d, &cos_a, &sin_a);
    return disc_pixel(r, sin(angle / 2), cos_a, sin_a);
}

static double ball_solid_angle(const bis_raster *r, int x, int y)
{
    return in_disc(r, x, y) ? 16.0 / r->width / r->width : 0;
}

/* ---- equal-area square ---- */

static double equalarea_direction(const bis_raster *r, int x, int y, double dx, double dy, double d[3])
{
    const double u = 2 * (x + dx + 0.5) / r->width - 1, v = 2 * (y + dy + 0.5) / r->width - 1;
    if (fabs(u) > 1 || fabs(v) > 1) return 0;
    const double above = 1 - fabs(u) - fabs(v), radius = 1 - fabs(above); /* above 0: the upper hemisphere */
    const double phi = radius > 0 ? PI / 4 * ((fabs(v) - fabs(u)) / radius + 1) : 0;
    const double sin_theta = radius * sqrt(2 - radius * radius);
    d[0] = copysign(sin_theta * cos(phi), u);
    d[1] = copysign(sin_theta * sin(phi), v);
    d[2] = copysign(1 - radius * radius, above);
    return 1;
}

static size_t equalarea_pixel(const bis_raster *r, const double d[3])
{
    /* 1 - |z| without cancellation */
    const double radius = sqrt((d[0] * d[0] + d[1] * d[1]) / (1 + fabs(d[2])));
    const double share = atan2(fabs(d[1]), fabs(d[0])) / (PI / 2);
    double u = radius * (1 - share), v = radius * share;
    if (d[2] < 0) {
        const double folded = 1 - v;
        v = 1 - u;
        u = folded;
    }
    return index_of(r, clamp((int)((copysign(u, d[0]) + 1) / 2 * r->width), r->width),
                    clamp((int)((copysign(v, d[1]) + 1) / 2 * r->width), r->width));
}

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

static void add_axis(double d[3], int axis, double times)
{
    const double t = axis < 0 ? -times : times;
    switch (axis < 0 ? -axis : axis) {
    case FRONT: d[0] -= t; break;
    case RIGHT: d[1] -= t; break;
    default: d[2] += t;
    }
}

static double along(const double d[3], int axis)
{
    const double v[4] = {0, -d[0], -d[1], d[2]};
    return axis < 0 ? -v[-axis] : v[axis];
}

static double cube_direction(const bis_raster *r, int x, int y, double dx, double dy, double d[3])
{
    double a, b;
    int side;
    const cube_face *f = face_at(r, x, y, &a, &b, &side);
    if (!f) return 0;
    a += 2 * dx / side;
    b -= 2 * dy / side;
    const double length = sqrt(1 + a * a + b * b);
    d[0] = d[1] = d[2] = 0;
    add_axis(d, f->ahead, 1 / length);
    add_axis(d, f->right, a / length);
    add_axis(d, f->up, b / length);
    return 1 / (length * length * length);
}

static size_t cube_pixel(const bis_raster *r, const double d[3])
{
    int side, best = 0;
    const cube_face *faces = faces_of(r, &side);
    for (int i = 1; i < 6; i++)
        if (along(d, faces[i].ahead) > along(d, faces[best].ahead)) best = i;
    const cube_face *f = &faces[best];
    const double ahead = along(d, f->ahead), a = along(d, f->right) / ahead, b = along(d, f->up) / ahead;
    return index_of(r, f->column * side + clamp((int)((a + 1) / 2 * side), side),
                    f->row * side + clamp((int)((1 - b) / 2 * side), side));
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
    {"latlong", "twice as wide as high", 2, 1, 2, 2, latlong_direction, latlong_pixel, latlong_solid_angle},
    {"angular", "square", 1, 1, 1, 2, angular_direction, angular_pixel, angular_solid_angle},
    {"equalarea", "square", 1, 1, 1.7724538509055161, 2, equalarea_direction, equalarea_pixel, equalarea_solid_angle},
    {"mirrorball", "square", 1, 1, PI / 2, 2, ball_direction, ball_pixel, ball_solid_angle},
    {"verticalcross", "of 3 x 4 square faces", 3, 4, 4, 4, cube_direction, cube_pixel, cube_solid_angle},
    {"horizontalcross", "of 4 x 3 square faces", 4, 3, 4, 4, cube_direction, cube_pixel, cube_solid_angle},
    {"cubestrip", "a row or column of 6 square faces", 6, 1, 4, 4, cube_direction, cube_pixel, cube_solid_angle},
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

int bis_mapping_width(bis_mapping mapping, int width, int height)
{
    const bis_mapping_model *m = &bis_mapping_models[mapping];
    assert(bis_mapping_fits(mapping, width, height));
    if (mapping == BIS_MAPPING_LATLONG) return width;
    return m->detail * (height > width ? height / (m->rows > m->columns ? m->rows : m->columns) : width / m->columns);
}
