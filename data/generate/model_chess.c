/* SPDX-License-Identifier: BSD-2-Clause */
/* model_chess: a set of turned chess pieces after Staunton's pattern, on squares of side 1.
 *
 * All but the knight's head and the king's cross come from the lathe: a drawing of corners, each more or less rounded,
 * is turned about z.
 * What the lathe cannot do is a bend of the turned surface (model_bend): the queen's points, the rook's battlements,
 * the bishop's slot. The knight's head and the king's cross are carved (model_carve.c) and stand in the turned part as
 * a second closed part.
 * The king is 1.75 high on a foot of 0.76, as in the usual proportions of king to square. */
#include "model.h"

#include <math.h>

#define N_OF(a) (sizeof(a) / sizeof((a)[0]))

enum { AROUND = 72 };
static const double STEP = 0.04;

static double smooth(double lo, double hi, double x)
{
    double t = fmin(1, fmax(0, (x - lo) / (hi - lo)));
    return t * t * (3 - 2 * t);
}

static bis_status turn(bis_mesh *m, const model_corner *corners, size_t n, model_bend bend, bis_diag *diag)
{
    model_profile profile;

    model_profile_draw(&profile, corners, n, STEP);
    return model_turn(m, &profile, AROUND, bend, NULL, diag);
}

bis_status model_pawn(bis_mesh *m, bis_diag *diag)
{
    static const model_corner corners[] = {
        {0, 0, 0},          {0.275, 0, 0.35},    {0.290, 0.075, 1},  {0.245, 0.110, 0.6}, {0.250, 0.135, 0.8},
        {0.205, 0.160, 0.7},
        {0.150, 0.240, 0.9}, {0.090, 0.470, 0.8}, {0.100, 0.520, 0.5}, {0.170, 0.532, 0.9}, {0.165, 0.562, 0.9},
        {0.095, 0.580, 0.6},
        {0.155, 0.625, 1},  {0.160, 0.775, 1},   {0.085, 0.815, 1},  {0, 0.815, 0}};

    return turn(m, corners, N_OF(corners), model_round, diag);
}

/* Six merlons: the rim above RIM_Z is lowered to almost nothing in between, and the angles crowd where its walls
 * stand. */
static const double ROOK_RIM_Z = 0.80;

static vec3 rook_bend(const void *data, double r, double z, double theta)
{
    double rim = fmax(0, z - ROOK_RIM_Z), at = theta - 0.88 * sin(12 * theta) / 12;
    double open = smooth(-0.10, 0.10, sin(6 * at + PI));

    return model_round(data, r, z - rim * 0.93 * open * smooth(0.12, 0.14, r), at);
}

bis_status model_rook(bis_mesh *m, bis_diag *diag)
{
    static const model_corner corners[] = {
        {0, 0, 0},           {0.325, 0, 0.35},    {0.340, 0.085, 1},   {0.290, 0.125, 0.6}, {0.295, 0.155, 0.8},
        {0.245, 0.180, 0.7},
        {0.200, 0.280, 0.9}, {0.155, 0.580, 0.7}, {0.165, 0.625, 0.5}, {0.225, 0.640, 0.9}, {0.220, 0.672, 0.9},
        {0.190, 0.690, 0.7},
        {0.215, 0.760, 0.5}, {0.240, 0.775, 0.7}, {0.245, 0.925, 0.25}, {0.175, 0.925, 0.25}, {0.170, 0.800, 0.25},
        {0, 0.785, 0}};

    return turn(m, corners, N_OF(corners), rook_bend, diag);
}

/* The slot of the mitre: matter is pushed in where the surface comes near a slanted plane, on the side of +x. */
static vec3 bishop_bend(const void *data, double r, double z, double theta)
{
    double x = r * cos(theta), d = (z - 1.035) * cos(0.95) - (x - 0.055) * sin(0.95);
    double cut = (1 - smooth(0.004, 0.030, fabs(d))) * smooth(-0.03, 0.07, x);

    return model_round(data, r * (1 - 0.50 * cut), z, theta);
}

bis_status model_bishop(bis_mesh *m, bis_diag *diag)
{
    static const model_corner corners[] = {
        {0, 0, 0},           {0.315, 0, 0.35},    {0.330, 0.085, 1},   {0.280, 0.125, 0.6}, {0.285, 0.150, 0.8},
        {0.235, 0.178, 0.7},
        {0.170, 0.280, 0.9}, {0.092, 0.640, 0.8}, {0.100, 0.700, 0.5}, {0.185, 0.715, 0.9}, {0.180, 0.748, 0.9},
        {0.115, 0.762, 0.6},
        {0.145, 0.785, 0.9}, {0.140, 0.812, 0.9}, {0.095, 0.830, 0.7}, {0.170, 0.900, 1},   {0.150, 1.040, 1},
           {0.060, 1.150, 0.8},
        {0.030, 1.160, 0.8}, {0.060, 1.185, 1},   {0.052, 1.232, 1},   {0, 1.235, 0}};
    model_profile profile;

    model_profile_draw(&profile, corners, N_OF(corners), 0.02);
    return model_turn(m, &profile, AROUND, bishop_bend, NULL, diag);
}

/* Nine points: the coronet's rim is lowered between them, and leans out a little at them. */
static vec3 queen_bend(const void *data, double r, double z, double theta)
{
    double rim = smooth(1.28, 1.405, z) * smooth(0.125, 0.16, r), point = 0.5 + 0.5 * cos(9 * theta);

    return model_round(data, r * (1 + 0.06 * rim * point), z - 0.075 * rim * (1 - pow(point, 0.7)), theta);
}

bis_status model_queen(bis_mesh *m, bis_diag *diag)
{
    static const model_corner corners[] = {
        {0, 0, 0},           {0.355, 0, 0.35},    {0.370, 0.095, 1},   {0.320, 0.140, 0.6}, {0.325, 0.170, 0.8},
        {0.270, 0.198, 0.7},
        {0.195, 0.310, 0.9}, {0.105, 0.850, 0.8}, {0.112, 0.920, 0.5}, {0.215, 0.937, 0.9}, {0.210, 0.972, 0.9},
        {0.135, 0.988, 0.6},
        {0.170, 1.012, 0.9}, {0.165, 1.042, 0.9}, {0.112, 1.060, 0.7}, {0.128, 1.150, 0.8}, {0.205, 1.405, 0.12},
        {0.178, 1.405, 0.15},
        {0.130, 1.340, 0.5}, {0.105, 1.385, 0.8}, {0.045, 1.420, 0.6}, {0.032, 1.432, 0.8}, {0.066, 1.455, 1},
          {0.060, 1.515, 1},
        {0, 1.520, 0}};

    return turn(m, corners, N_OF(corners), queen_bend, diag);
}

static double cross_half_thickness(double x, double z)
{
    (void)x, (void)z;
    return 0.036;
}

/* A cross pattee, its foot let into the ball below it. */
static bis_status king_cross(bis_mesh *m, bis_diag *diag)
{
    static const double x[] = {
        -0.052, 0.052, 0.022, 0.100, 0.100, 0.022, 0.050, -0.050, -0.022, -0.100, -0.100, -0.022};
    static const double z[] = {1.530, 1.530, 1.632, 1.604, 1.706, 1.678, 1.765, 1.765, 1.678, 1.706, 1.604, 1.632};
    const model_block block = {x, z, N_OF(x), 0.018, 0.0055, cross_half_thickness, NULL};

    return model_carve(m, &block, diag);
}

bis_status model_king(bis_mesh *m, bis_diag *diag)
{
    static const model_corner corners[] = {
        {0, 0, 0},           {0.365, 0, 0.35},    {0.380, 0.100, 1},   {0.330, 0.148, 0.6}, {0.335, 0.180, 0.8},
        {0.280, 0.208, 0.7},
        {0.205, 0.325, 0.9}, {0.115, 0.930, 0.8}, {0.122, 1.010, 0.5}, {0.235, 1.028, 0.9}, {0.230, 1.065, 0.9},
        {0.145, 1.082, 0.6},
        {0.185, 1.108, 0.9}, {0.180, 1.140, 0.9}, {0.122, 1.160, 0.7}, {0.135, 1.250, 0.8}, {0.200, 1.445, 0.4},
        {0.205, 1.475, 0.9},
        {0.170, 1.490, 0.5}, {0.110, 1.520, 0.9}, {0.045, 1.530, 0.6}, {0.055, 1.560, 1},   {0.030, 1.580, 1},
           {0, 1.580, 0}};
    bis_mesh cross = {0};
    bis_status status = turn(m, corners, N_OF(corners), model_round, diag);

    if (!status) status = king_cross(&cross, diag);
    if (!status) status = model_append(m, &cross, (vec3){0, 0, 0}, diag);
    bis_mesh_clear(&cross);
    return status;
}

/* --- the knight --- */

/* The head looks along +x. Cheek and neck are thick, the muzzle and the crest thin. */
static double knight_half_thickness(double x, double z)
{
    double cheek = exp(-(pow((x - 0.03) / 0.13, 2) + pow((z - 0.84) / 0.13, 2)));
    double neck = 1 - smooth(0.30, 0.75, z), muzzle = smooth(0.12, 0.30, x) * smooth(0.55, 0.62, z);
    double crest = smooth(0.02, -0.20, x);

    return 0.115 + 0.055 * cheek + 0.050 * neck - 0.030 * muzzle - 0.030 * crest * (1 - neck);
}

static double dent(double x, double z, double cx, double cz, double radius)
{
    return 1 - smooth(0, 1, hypot(x - cx, z - cz) / radius);
}

/* Distance to the segment from a to b. */
static double segment(double x, double z, double ax, double az, double bx, double bz)
{
    double t = ((x - ax) * (bx - ax) + (z - az) * (bz - az)) / (pow(bx - ax, 2) + pow(bz - az, 2));

    t = fmin(1, fmax(0, t));
    return hypot(x - ax - t * (bx - ax), z - az - t * (bz - az));
}

/* Mane, mouth, nostril, eye (a ring with a ball in it), and the line of the jaw. `inside`: depth behind the outline. */
static double knight_groove(double x, double y, double z, double inside)
{
    double behind = smooth(0.03, -0.06, x - 0.42 * (z - 0.75)) * smooth(0.30, 0.36, z);
    double lock = cos(2 * PI * (z - 0.75 * x - 1.3 * inside) / 0.105);
    double mane = behind * smooth(0.135, 0.095, inside) * smooth(1.075, 1.02, z) * (0.07 + 0.06 * lock);
    double eye = hypot(x - 0.085, z - 0.965);
    double socket = 0.16 * (1 - smooth(0.022, 0.056, eye)) - 0.28 * (1 - smooth(0.0, 0.036, eye));
    double mouth = 0.24 * (1 - smooth(0.000, 0.026, segment(x, z, 0.400, 0.690, 0.290, 0.735)));
    double nostril = 0.26 * dent(x, z, 0.345, 0.800, 0.038);
    double jaw =
        0.10 * (1 - smooth(0.0, 0.03, fabs(hypot(x - 0.045, z - 0.835) - 0.135))) * smooth(0.0, -0.06, x - 0.07);

    (void)y;
    return mane + socket + mouth + nostril + jaw;
}

/* Control points of the head's outline, counter-clockwise, made round by Catmull and Rom's spline. */
static size_t knight_outline(double *x, double *z)
{
    static const double px[] = {-0.235, 0.000, 0.225, 0.215, 0.150, 0.125, 0.165, 0.215, 0.300, 0.345, 0.395, 0.415,
        0.405, 0.330, 0.235, 0.165, 0.135, 0.105, 0.045, 0.000, -0.060, -0.160, -0.235, -0.270, -0.275, -0.255};
    static const double pz[] = {0.190, 0.175, 0.190, 0.330, 0.450, 0.560, 0.660, 0.700, 0.675, 0.645, 0.660, 0.720,
        0.800, 0.890, 0.985, 1.050, 1.095, 1.195, 1.130, 1.085, 1.050, 0.960, 0.830, 0.660, 0.480, 0.330};
    enum { PER = 8 };
    size_t n = N_OF(px);

    for (size_t i = 0; i < n; i++) {
        size_t a = (i + n - 1) % n, b = i, c = (i + 1) % n, d = (i + 2) % n;
        for (size_t j = 0; j < PER; j++) {
            double t = (double)j / PER, t2 = t * t, t3 = t2 * t;
            double wa = (-t3 + 2 * t2 - t) / 2, wb = (3 * t3 - 5 * t2 + 2) / 2, wc = (-3 * t3 + 4 * t2 + t) / 2,
                   wd = (t3 - t2) / 2;
            x[i * PER + j] = wa * px[a] + wb * px[b] + wc * px[c] + wd * px[d];
            z[i * PER + j] = wa * pz[a] + wb * pz[b] + wc * pz[c] + wd * pz[d];
        }
    }
    return n * PER;
}

bis_status model_knight(bis_mesh *m, bis_diag *diag)
{
    static const model_corner corners[] = {{0, 0, 0}, {0.325, 0, 0.35}, {0.340, 0.085, 1}, {0.290, 0.125, 0.6},
        {0.295, 0.155, 0.8}, {0.265, 0.180, 0.7}, {0.260, 0.232, 0.9}, {0.15, 0.255, 0.5}, {0, 0.262, 0}};
    double x[MODEL_MAX_OUTLINE], z[MODEL_MAX_OUTLINE];
    size_t n = knight_outline(x, z);
    const model_block block = {x, z, n, 0.085, 0.0125, knight_half_thickness, knight_groove};
    bis_mesh head = {0};
    bis_status status = turn(m, corners, N_OF(corners), model_round, diag);

    if (!status) status = model_carve(&head, &block, diag);
    if (!status) status = model_append(m, &head, (vec3){0, 0, 0}, diag);
    bis_mesh_clear(&head);
    return status;
}
