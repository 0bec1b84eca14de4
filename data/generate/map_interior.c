/* SPDX-License-Identifier: BSD-2-Clause */
/* map_interior: a vaulted hall, seen from where its visitor stands: in the manner of the thesis's cathedrals tiny
 * lamps, coloured windows, and corners ten million times darker than a lamp.
 *
 * The hall is a nave of stone walls with pointed windows, a barrel vault painted blue with gold stars, two rows of
 * columns, three rings of candles and a polished floor. One ray is traced for each direction against these few shapes,
 * all by closed forms; what it hits is lit by the candles (as three point lights), by the windows (each as a small
 * area) and by the sun, if it is seen through a pane: that throws the window's colours on the floor. The floor reflects
 * once. The lamps themselves are added in the end (map_add_disc), for they are as small as a pixel.
 *
 * Metres; the eye is at the origin, 1.6 above the floor; the nave runs along y, the windows on -x face the sun. */
#include "map.h"

#include <math.h>

static const double FLOOR = -1.6, WALL = 7, SPRING = 7.2, FRONT = 18,
                    BACK = -14; /* the vault's axis is at height SPRING */
static const double BAY = 4;                                                     /* columns stand at multiples of it */
static const double COLUMN_X = 5.1, COLUMN_R = 0.36;
static const double SUN[3] = {-0.74, 0.28, 0.61};                                 /* towards the sun, about unit */

/* Rings of candles. */
enum { RINGS = 3, CANDLES = 14, SCONCES = 16 };
static const double RING_Y[RINGS] = {-7.5, 4.5, 12.5}, RING_Z = 2.9, RING_R = 1.05;
static const double FLAME_R = 0.017;
static const rgb FLAME = {7200, 4900, 2500};

/* A rough mean of what comes through the glass, for the light that the windows throw on the walls. */
static const rgb SUN_SIDE = {0.62f, 0.42f, 0.55f}, SHADE_SIDE = {0.15f, 0.16f, 0.30f}, ROSE = {0.5f, 0.35f, 0.5f};

typedef struct surface {
    double t;
    vec3 p, n;
    rgb albedo, emitted;
    double polish; /* share that is mirrored */
} surface;

static double frac(double x) { return x - floor(x); }

/* Distance to the nearest multiple of `step`. */
static double to_line(double x, double step) { return fabs(x - step * round(x / step)); }

/* --- glass --- */

static const rgb RUBY = {0.80f, 0.030f, 0.040f}, COBALT = {0.035f, 0.10f, 0.85f}, GOLD = {0.95f, 0.62f, 0.10f},
                 GREEN = {0.06f, 0.48f, 0.16f}, CLEAR = {0.85f, 0.88f, 0.80f}, VIOLET = {0.36f, 0.07f, 0.50f},
                 LEAD = {0, 0, 0};

/* A pointed window of half width 1.15 about u = 0, from z = 0.4 up: the pane's colour at (u, z); alpha 0 outside the
 * frame. */
static bool window_shape(double u, double z, double grow)
{
    const double w = 1.15 + grow, spring = 4.3;

    if (z < 0.4 - grow || fabs(u) > w) return false;
    return z < spring || hypot(fabs(u) + w, z - spring) < 2 * w;
}

static rgb window_glass(double u, double z, int bay)
{
    if (fabs(u) < 0.06 || to_line(z - 0.4, 1.3) < 0.035) return LEAD;             /* mullion, bars */
    if (!window_shape(u, z, -0.10)) {                                              /* border of small panes */
        if (to_line(u + z, 0.36) < 0.02) return LEAD;
        return (int64_t)floor((u + z) / 0.36) & 1 ? RUBY : COBALT;
    }
    double mu = fabs(u) - 0.56, mz = (frac((z - 0.4) / 1.3) - 0.5) * 1.3,
           r = hypot(mu, mz); /* two medallions side by side */
    if (fabs(r - 0.36) < 0.018 || fabs(r - 0.20) < 0.015) return LEAD;
    if (r < 0.20) return bay & 1 ? CLEAR : GOLD;
    if (r < 0.36) {
        if (fabs(frac(atan2(mz, mu) * 4 / PI) - 0.5) > 0.46) return LEAD;
        return bay & 1 ? RUBY : VIOLET;
    }
    double a = (u + z) / 0.26, b = (u - z) / 0.26;                                 /* diamonds */
    if (fabs(frac(a) - 0.5) > 0.45 || fabs(frac(b) - 0.5) > 0.45) return LEAD;
    double h = map_hash((int64_t)floor(a), (int64_t)floor(b), bay);
    return h < 0.40 ? COBALT : h < 0.62 ? GREEN : h < 0.82 ? RUBY : GOLD;
}

/* Which window's wall coordinate: u from the middle of the bay, and the bay's number. */
static double window_u(double y, int *bay)
{
    *bay = (int)floor(y / BAY);
    return y - (*bay + 0.5) * BAY;
}

static bool in_wall_window(double y, double z, rgb *glass)
{
    int bay;
    double u = window_u(y, &bay);

    if (bay < -3 || bay > 3 || !window_shape(u, z, 0)) return false;
    *glass = window_glass(u, z, bay);
    return true;
}

static bool in_rose(double x, double z, rgb *glass)
{
    const double r = hypot(x, z - 7.0), a = atan2(z - 7.0, x);

    if (r > 3.3) return false;
    *glass = LEAD;
    if (r < 0.5) *glass = GOLD;
    if (r > 0.6 && r < 1.5 && fabs(frac(a * 6 / PI) - 0.5) < 0.42)
        *glass = (int)floor(a * 6 / PI + 12) & 1 ? COBALT : RUBY;
    if (r > 1.6 && r < 2.6) {
        double u = (frac(a * 6 / PI) - 0.5) * r * PI / 6, v = r - 2.1;
        if (hypot(u, v) < 0.42) *glass = hypot(u, v) < 0.20 ? CLEAR : VIOLET;
        else if (hypot(u, v) > 0.47) *glass = COBALT;
    }
    if (r > 2.7 && r < 3.2 && fabs(frac(a * 12 / PI) - 0.5) < 0.44)
        *glass = (int)floor(a * 12 / PI + 24) & 1 ? GREEN : GOLD;
    return true;
}

/* --- stone --- */

static rgb stone(vec3 p, rgb tint)
{
    double grain = 0.75 + 0.5 * map_clouds(2 * (double)p.x, 2 * (double)p.y, 2 * (double)p.z, 3);
    return rgb_scale(tint, grain);
}

static const rgb LIMESTONE = {0.42f, 0.38f, 0.31f}, OAK = {0.075f, 0.038f, 0.018f}, RIB = {0.50f, 0.44f, 0.33f};

/* u along the wall, z up: joints between blocks, a dado of oak, a cornice. */
static rgb wall_albedo(vec3 p, double u)
{
    double z = (double)p.z;
    rgb c = stone(p, LIMESTONE);

    if (z < FLOOR + 1.5)
        return rgb_scale(OAK, to_line(u, 0.5) < 0.03 || to_line(z - FLOOR - 1.4, 10) < 0.04 ? 0.25 : 1);
    if (fabs(z - SPRING) < 0.25) return rgb_scale(RIB, to_line(u, 0.4) < 0.12 && z < SPRING + 0.1 ? 0.6 : 1);
    double row = floor(z / 0.55), shift = map_hash((int64_t)row, 1, 2);
    if (to_line(z, 0.55) < 0.012 || to_line(u + shift, 1.1) < 0.012) c = rgb_scale(c, 0.5);
    return rgb_scale(c, 0.85 + 0.3 * map_hash((int64_t)row, (int64_t)floor((u + shift) / 1.1 + 0.5), 3));
}

static void hit_wall(surface *s, double u, double window_light)
{
    rgb glass;
    int bay;
    double y = (double)s->p.y, z = (double)s->p.z;

    s->albedo = wall_albedo(s->p, u);
    if (in_wall_window(y, z, &glass)) {
        s->albedo = (rgb){0.01f, 0.01f, 0.01f};
        s->emitted = rgb_scale(glass, window_light * (0.75 + 0.5 * map_noise(1.5 * y, 1.5 * z, 4)));
    } else if (window_shape(window_u(y, &bay), z, 0.22) && bay >= -3 && bay <= 3) {
        s->albedo = RIB;
    }
}

static void hit_end(surface *s)
{
    double x = (double)s->p.x, z = (double)s->p.z;
    rgb glass;

    s->albedo = wall_albedo(s->p, x);
    if (s->p.y > 0) {
        if (in_rose(x, z, &glass)) {
            s->albedo = (rgb){0.01f, 0.01f, 0.01f};
            s->emitted = rgb_scale(glass, 5);
        } else if (hypot(x, z - 7) < 3.6) {
            s->albedo = RIB;
        }
    }
    if (fabs(x) < 1.6 && (z < 1.4 || hypot(fabs(x) + 1.6, z - 1.4) < 3.2)) { /* a door */
        s->albedo = rgb_scale(OAK, to_line(x, 0.4) < 0.02 || fabs(x) < 0.02 ? 0.08 : 0.35);
    }
}

static void hit_vault(surface *s)
{
    double y = (double)s->p.y, a = atan2((double)s->p.z - SPRING, (double)s->p.x) / PI; /* 0 to 1 from side to side */
    double across = 2 * frac(y / BAY) - 1, up = 2 * a - 1;

    s->albedo = stone(s->p, (rgb){0.045f, 0.075f, 0.23f});
    double cu = a * 44, cv = y * 2, du = frac(cu) - 0.5, dv = frac(cv) - 0.5;
    double star = hypot(du, dv) * (1 + 0.35 * cos(5 * atan2(dv, du)));
    if (star < 0.16) s->albedo = (rgb){0.62f, 0.42f, 0.10f};
    if (to_line(y, BAY) < 0.26 || fabs(fabs(across) - fabs(up)) < 0.045 || fabs(up) < 0.02)
        s->albedo = stone(s->p, RIB);
}

static void hit_floor(surface *s)
{
    double x = (double)s->p.x, y = (double)s->p.y;
    bool dark = ((int64_t)floor(x / 0.9) + (int64_t)floor(y / 0.9)) & 1;
    double vein = fabs(map_clouds(1.7 * x, 1.7 * y, 9, 4) - 0.5);

    s->albedo = dark ? (rgb){0.030f, 0.028f, 0.030f} : (rgb){0.48f, 0.44f, 0.37f};
    if (vein < 0.012) s->albedo = map_mix(s->albedo, (rgb){0.30f, 0.28f, 0.25f}, 0.6);
    if (to_line(x, 0.9) < 0.008 || to_line(y, 0.9) < 0.008) s->albedo = rgb_scale(s->albedo, 0.3);
    if (fabs(x) > 4.2 && fabs(x) < 4.5) s->albedo = (rgb){0.16f, 0.045f, 0.03f};
    s->polish = 0.06;
}

/* --- the one ray --- */

static bool nearer(surface *s, vec3 o, vec3 d, double t)
{
    if (!(t > 1e-6 && t < s->t)) return false;
    s->t = t;
    s->p = add(o, mul(d, t));
    s->emitted = (rgb){0, 0, 0};
    s->polish = 0;
    return true;
}

/* Column k: a shaft with flutes, a plinth and a capital that are wider. */
static void trace_column(surface *s, vec3 o, vec3 d, double cx, double cy, double r, double z0, double z1)
{
    double ox = (double)o.x - cx, oy = (double)o.y - cy, dx = (double)d.x, dy = (double)d.y;
    double a = dx * dx + dy * dy, b = ox * dx + oy * dy, c = ox * ox + oy * oy - r * r, disc = b * b - a * c;

    if (disc <= 0 || a == 0) return;
    double t = (-b - sqrt(disc)) / a, z = (double)o.z + t * (double)d.z;
    if (z < z0 || z > z1 || !nearer(s, o, d, t)) return;
    double phi = atan2((double)s->p.y - cy, (double)s->p.x - cx), flute = 0.35 * sin(20 * phi);
    s->n = vec3_from(cos(phi + flute), sin(phi + flute), 0);
    s->albedo = stone(s->p, LIMESTONE);
}

/* Does the line pass the axis at (cx, cy) within r? */
static bool passes(vec3 o, vec3 d, double cx, double cy, double r)
{
    double away = (cx - (double)o.x) * (double)d.y - (cy - (double)o.y) * (double)d.x;
    return away * away < r * r * ((double)d.x * (double)d.x + (double)d.y * (double)d.y);
}

static void trace_columns(surface *s, vec3 o, vec3 d)
{
    for (int k = -3; k <= 4; k++) {
        for (int side = -1; side <= 1; side += 2) {
            double x = side * COLUMN_X, y = k * BAY;
            if (!passes(o, d, x, y, COLUMN_R + 0.16)) continue;
            trace_column(s, o, d, x, y, COLUMN_R, FLOOR, SPRING);
            trace_column(s, o, d, x, y, COLUMN_R + 0.14, FLOOR, FLOOR + 0.7);
            trace_column(s, o, d, x, y, COLUMN_R + 0.16, SPRING - 0.8, SPRING);
        }
    }
}

/* The iron of a chandelier: a band seen from in- and outside, and the rod that it hangs by. */
static void trace_ring(surface *s, vec3 o, vec3 d, double cy)
{
    double oy = (double)o.y - cy, dx = (double)d.x, dy = (double)d.y, ox = (double)o.x;
    double a = dx * dx + dy * dy, b = ox * dx + oy * dy, c = ox * ox + oy * oy - RING_R * RING_R, disc = b * b - a * c;

    trace_column(s, o, d, 0, cy, 0.03, RING_Z, SPRING + WALL);
    if (disc <= 0 || a == 0) return;
    for (int sign = -1; sign <= 1; sign += 2) {
        double t = (-b + sign * sqrt(disc)) / a, z = (double)o.z + t * (double)d.z;
        if (fabs(z - RING_Z + 0.16) > 0.07 || !nearer(s, o, d, t)) continue;
        s->n = mul(vec3_from((double)s->p.x, (double)s->p.y - cy, 0), -sign / RING_R);
        s->albedo = (rgb){0.05f, 0.035f, 0.02f};
    }
}

static void trace_shell(surface *s, vec3 o, vec3 d)
{
    double dz = (double)d.z, ox = (double)o.x, oz = (double)o.z - SPRING, dx = (double)d.x;

    if (dz < 0 && nearer(s, o, d, (FLOOR - (double)o.z) / dz)) {
        s->n = (vec3){0, 0, 1};
        hit_floor(s);
    }
    if (dx != 0) {
        double side = dx > 0 ? 1 : -1, t = (side * WALL - ox) / dx;
        if ((double)o.z + t * dz < SPRING && nearer(s, o, d, t)) {
            s->n = vec3_from(-side, 0, 0);
            hit_wall(s, (double)s->p.y, side < 0 ? 9 : 2);
        }
    }
    if (d.y != 0) {
        double t = ((d.y > 0 ? FRONT : BACK) - (double)o.y) / (double)d.y;
        if (nearer(s, o, d, t)) {
            s->n = vec3_from(0, d.y > 0 ? -1 : 1, 0);
            hit_end(s);
        }
    }
    double a = dx * dx + dz * dz, b = ox * dx + oz * dz, c = ox * ox + oz * oz - WALL * WALL, disc = b * b - a * c;
    if (a == 0 || disc <= 0) return;
    double t = (-b + sqrt(disc)) / a;
    if ((double)o.z + t * dz >= SPRING && nearer(s, o, d, t)) {
        s->n = mul(vec3_from((double)s->p.x, 0, (double)s->p.z - SPRING), -1 / WALL);
        hit_vault(s);
    }
}

static surface trace(vec3 o, vec3 d)
{
    surface s = {.t = (double)INFINITY};

    trace_columns(&s, o, d);
    for (int i = 0; i < RINGS; i++) trace_ring(&s, o, d, RING_Y[i]);
    trace_shell(&s, o, d);
    return s;
}

/* --- its light --- */

/* Irradiance of a small source of intensity `I cos` (cos = 1 without a normal of its own) at q. */
static double from_point(vec3 p, vec3 n, vec3 q, double soften)
{
    vec3 to = sub(q, p);
    double d2 = dot(to, to), cosine = dot(n, to) / sqrt(d2);

    return cosine > 0 ? cosine / (d2 + soften) : 0;
}

static rgb candle_light(vec3 p, vec3 n)
{
    const double intensity = PI * FLAME_R * FLAME_R * CANDLES;
    double sum = 0;

    for (int i = 0; i < RINGS; i++) sum += from_point(p, n, vec3_from(0, RING_Y[i], RING_Z), RING_R * RING_R);
    return rgb_scale(FLAME, intensity * sum);
}

/* The windows throw their mean radiance, by the cosine to their wall: two and a third windows at a time. */
static rgb window_light(vec3 p, vec3 n)
{
    const double area = 23;
    rgb sum = {0, 0, 0};

    for (int side = -1; side <= 1; side += 2) {
        for (int k = -1; k <= 1; k++) {
            vec3 q = vec3_from(side * (WALL + 0.05), 9.4 * k + 2, 3.2), to = sub(q, p);
            double away = WALL + 0.05 - side * (double)p.x, e = from_point(p, n, q, 3) * away / length(to) * area;
            sum = rgb_add(sum, rgb_scale(side < 0 ? SUN_SIDE : SHADE_SIDE, e));
        }
    }
    vec3 rose = vec3_from(0, FRONT + 0.1, 7);
    double e = from_point(p, n, rose, 4) * (FRONT + 0.1 - (double)p.y) / length(sub(rose, p)) * 30;
    return rgb_add(sum, rgb_scale(ROSE, e));
}

/* The sun, if it is seen through a pane of the wall at -x; columns in the way count. */
static rgb sun_light(vec3 p, vec3 n)
{
    vec3 w = normalize(vec3_from(SUN[0], SUN[1], SUN[2]));
    double cosine = dot(n, w), t = (-WALL - (double)p.x) / (double)w.x;
    surface column = {.t = t};
    rgb glass;

    if (cosine <= 0 || t <= 0.1) return (rgb){0, 0, 0};
    vec3 q = add(p, mul(w, t));
    if (!in_wall_window((double)q.y, (double)q.z, &glass)) return (rgb){0, 0, 0};
    trace_columns(&column, add(p, mul(n, 1e-3)), w);
    if (column.t < t) return (rgb){0, 0, 0};
    return rgb_scale(rgb_mul(glass, (rgb){1, 0.9f, 0.75f}), 26 * cosine);
}

/* Corners see little of the hall: the ambient light fades near the floor's edge and behind the columns. */
static double openness(vec3 p)
{
    double wall = WALL - fabs((double)p.x), low = (double)p.z - FLOOR;

    return (0.02 + 0.98 * map_smooth(-0.3, 3.2, wall + 0.35 * low)) *
           (0.15 + 0.85 * map_smooth(0, 1.8, low + 0.5 * wall));
}

static rgb shade(const surface *s)
{
    const rgb bounced = {0.055f, 0.045f, 0.038f};
    double open = openness(s->p);
    rgb e = rgb_scale(rgb_add(candle_light(s->p, s->n), window_light(s->p, s->n)), 0.04 + 0.96 * open);

    e = rgb_add(e, rgb_add(sun_light(s->p, s->n), rgb_scale(bounced, open)));
    return rgb_add(s->emitted, rgb_scale(rgb_mul(s->albedo, e), INV_PI));
}

/* Schlick's approximation of Fresnel's reflectance. */
static double mirrored(double polish, double cosine) { return polish + (1 - polish) * pow(1 - cosine, 5); }

static rgb hall(const void *data, vec3 w)
{
    const vec3 eye = {0, 0, 0};
    surface s = trace(eye, w);
    rgb L = shade(&s);

    (void)data;
    if (s.polish == 0) return L;
    surface behind = trace(add(s.p, vec3_from(0, 0, 1e-4)), (vec3){w.x, w.y, -w.z});
    double share = mirrored(s.polish, -(double)w.z);
    return rgb_add(rgb_scale(L, 1 - share), rgb_scale(shade(&behind), share));
}

/* A flame at p and its image in the floor. */
static void add_flame(bis_image *image, vec3 p)
{
    const vec3 eye = {0, 0, 0}, image_p = vec3_from((double)p.x, (double)p.y, 2 * FLOOR - (double)p.z);
    vec3 w = normalize(p), down = normalize(image_p);
    surface on_floor = trace(eye, down);

    if (trace(eye, w).t > length(p)) map_add_disc(image, w, FLAME_R / length(p), FLAME);
    if (on_floor.polish == 0) return;
    if (trace(add(on_floor.p, vec3_from(0, 0, 1e-4)), normalize(sub(p, on_floor.p))).t < length(sub(p, on_floor.p)))
        return;
    map_add_disc(image, down, FLAME_R / length(image_p), rgb_scale(FLAME, mirrored(on_floor.polish, -(double)down.z)));
}

static void add_flames(bis_image *image)
{
    for (int i = 0; i < RINGS; i++) {
        for (int k = 0; k < CANDLES; k++) {
            double a = 2 * PI * (k + 0.3) / CANDLES;
            add_flame(image, vec3_from(RING_R * cos(a), RING_Y[i] + RING_R * sin(a), RING_Z));
        }
    }
    for (int i = 0; i < SCONCES; i++) { /* one on the inner side of each column */
        double side = i % 2 ? 1 : -1;
        add_flame(image, vec3_from(side * (COLUMN_X - COLUMN_R - 0.2), (i / 2 - 3) * BAY, 0.55));
    }
}

bis_status map_interior(bis_image *image, bis_diag *diag)
{
    bis_status status = map_paint(image, 1024, 2, hall, NULL, diag);

    if (!status) add_flames(image);
    return status;
}
