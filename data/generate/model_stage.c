/* SPDX-License-Identifier: BSD-2-Clause */
/* model_stage: what the figures stand on, and the plain shapes: board, pedestal, paving, louvres, sphere.
 *
 * A block with mouldings is turned, too: its profile's radius is taken as half the side of a square with rounded
 * corners (square_bend).
 * A face that should look flat gets a ring of vertices close inside its edge, so that the smooth normals bend in that
 * narrow band only. */
#include "model.h"

#include "bis/base/mem.h"
#include "bis/thesis/rng.h"

#include <math.h>

#define N_OF(a) (sizeof(a) / sizeof((a)[0]))

/* A square with rounded corners: n_around / 4 points on each corner's arc, its radius `corner` times half the side. */
typedef struct square {
    size_t n_around;
    double corner;
} square;

static vec3 square_bend(const void *data, double r, double z, double theta)
{
    const square *s = data;
    size_t per = s->n_around / 4, i = (size_t)(theta / (2 * PI) * (double)s->n_around + 0.5);
    double a = PI / 2 * ((double)(i / per) + (double)(i % per) / (double)(per - 1)),
           mid = PI / 2 * (double)(i / per) + PI / 4;
    double x = (1 - s->corner) * sqrt(2) * cos(mid) + s->corner * cos(a),
           y = (1 - s->corner) * sqrt(2) * sin(mid) + s->corner * sin(a);

    return vec3_from(r * x, r * y, z);
}

static bis_status square_turn(
    bis_mesh *m, const model_corner *corners, size_t n, double step, const square *s, bis_diag *diag)
{
    model_profile profile;

    model_profile_draw(&profile, corners, n, step);
    return model_turn(m, &profile, s->n_around, square_bend, s, diag);
}

bis_status model_squares(bis_mesh *m, bool dark, bis_diag *diag)
{
    static const model_corner corners[] = {
        {0, -0.08, 0}, {0.492, -0.08, 0}, {0.492, -0.016, 0}, {0.492, 0, 1}, {0.476, 0, 0}, {0.470, 0, 0}, {0, 0, 0}};
    const square shape = {12, 0.05};
    bis_mesh tile = {0};
    bis_status status = square_turn(&tile, corners, N_OF(corners), 1, &shape, diag);

    *m = (bis_mesh){0};
    for (int i = 0; i < 64 && !status; i++) {
        int x = i % 8, y = i / 8;
        if (((x + y) % 2 == 0) == dark) status = model_append(m, &tile, vec3_from(x - 3.5, y - 3.5, 0), diag);
    }
    bis_mesh_clear(&tile);
    return status;
}

bis_status model_board(bis_mesh *m, bis_diag *diag)
{
    /* The well that the squares lie in is sunk a little below their tops; the rim stands as high as they do. */
    static const model_corner corners[] = {
        {0, -0.50, 0},       {4.62, -0.50, 0},  {4.72, -0.50, 0.5}, {4.76, -0.42, 1},   {4.70, -0.34, 0.5},
        {4.66, -0.32, 0.5}, {4.66, -0.20, 0.5},
        {4.60, -0.17, 0.6},  {4.585, -0.06, 1}, {4.54, 0.002, 1},   {4.44, 0.002, 0},   {4.16, 0.002, 0},
           {4.12, 0.002, 0.3},  {4.085, -0.022, 0.5},
        {4.05, 0.002, 0},    {4.035, 0.002, 0}, {4.012, 0.002, 0},  {4.0, -0.010, 0},  {3.994, -0.028, 0},
          {3.98, -0.034, 0},   {0, -0.034, 0}};
    const square shape = {48, 0.03};

    return square_turn(m, corners, N_OF(corners), 1, &shape, diag);
}

bis_status model_pedestal(bis_mesh *m, bis_diag *diag)
{
    static const model_corner corners[] = {
        {0, -2.40, 0},      {0.98, -2.40, 0},   {1.00, -2.40, 0},    {1.02, -2.40, 1},    {1.02, -2.38, 0},
           {1.02, -2.08, 0},  {1.02, -2.05, 1},
        {0.98, -2.04, 0},   {0.95, -2.04, 0.4}, {0.95, -1.98, 0.4},  {0.90, -1.97, 0.4},  {0.78, -1.90, 1},
           {0.74, -1.76, 0.5}, {0.70, -1.74, 0.4},
        {0.70, -1.70, 0},   {0.70, -0.62, 0},   {0.70, -0.56, 0.4},  {0.74, -0.54, 0.4},  {0.74, -0.48, 0.4},
        {0.78, -0.40, 1},  {0.92, -0.33, 1},
        {0.94, -0.27, 0.4}, {0.98, -0.25, 0.4}, {0.98, -0.07, 0},    {0.98, -0.05, 1},    {0.95, -0.045, 0.4},
        {0.93, -0.02, 1}, {0.90, 0, 1},
        {0.86, 0, 0},       {0, 0, 0}};
    const square shape = {64, 0.06};

    return square_turn(m, corners, N_OF(corners), 0.05, &shape, diag);
}

/* In (-1, 1), a fixed function of i and j. */
static double noise(int i, int j)
{
    return 2 * (double)(bis_hash(bis_hash((uint64_t)(i + 1000)) + (uint64_t)(j + 1000)) >> 11) * 0x1p-53 - 1;
}

/* Stones of side 1, each set a little uneven: tilted by up to a third of a degree, 4 mm of 1 m up or down. */
bis_status model_paving(bis_mesh *m, bis_diag *diag)
{
    static const model_corner corners[] = {{0, -0.10, 0}, {0.490, -0.10, 0}, {0.490, -0.014, 0}, {0.486, -0.004, 0},
        {0.476, 0, 0}, {0.462, 0, 0}, {0, 0, 0}};
    const square shape = {8, 0.06};
    bis_mesh stone = {0}, set = {0};
    bis_status status = square_turn(&stone, corners, N_OF(corners), 1, &shape, diag);

    *m = (bis_mesh){0};
    if (!status) status = model_append(&set, &stone, (vec3){0, 0, 0}, diag);
    for (int i = 0; i < 256 && !status; i++) {
        int x = i % 16, y = i / 16;
        double dx = 0.006 * noise(x, y), dy = 0.006 * noise(x + 100, y), dz = 0.004 * noise(x + 200, y);
        for (size_t k = 0; k < stone.n_vertices; k++) {
            vec3 p = stone.p[k];
            set.p[k] = vec3_from((double)p.x, (double)p.y, (double)p.z + dx * (double)p.x + dy * (double)p.y);
        }
        status = model_append(m, &set, vec3_from(x - 7.5, y - 7.5, dz), diag);
    }
    bis_mesh_clear(&set);
    bis_mesh_clear(&stone);
    return status;
}

/* One louvre: a bar along x, its section an ellipse 0.3 wide and 0.05 thick, tilted by 35 degrees. */
static vec3 louvre_bend(const void *data, double r, double z, double theta)
{
    double a = 0.15 * r * cos(theta), b = 0.025 * r * sin(theta), c = cos(35 * PI / 180), s = sin(35 * PI / 180);

    (void)data;
    return vec3_from(-z, a * s + b * c, a * c - b * s);
}

bis_status model_louvres(bis_mesh *m, bis_diag *diag)
{
    static const model_corner corners[] = {{0, -1, 0}, {1, -1, 1}, {1, -0.9, 0}, {1, 0.9, 0}, {1, 1, 1}, {0, 1, 0}};
    model_profile profile;
    bis_mesh bar = {0};

    *m = (bis_mesh){0};
    model_profile_draw(&profile, corners, N_OF(corners), 0.1);
    bis_status status = model_turn(&bar, &profile, 24, louvre_bend, NULL, diag);
    for (int i = 0; i < 5 && !status; i++) status = model_append(m, &bar, vec3_from(0, 0, 0.4 * (i - 2)), diag);
    bis_mesh_clear(&bar);
    return status;
}

bis_status model_sphere(bis_mesh *m, size_t n_around, bis_diag *diag)
{
    model_profile p = {.n = n_around / 2 + 1};

    for (size_t i = 0; i < p.n; i++) {
        double theta = PI * (double)i / (double)(p.n - 1);
        p.r[i] = sin(theta);
        p.z[i] = -cos(theta);
    }
    p.r[0] = p.r[p.n - 1] = 0;
    return model_turn(m, &p, n_around, model_round, NULL, diag);
}
