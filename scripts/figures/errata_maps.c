/* SPDX-License-Identifier: BSD-2-Clause */
/* errata_maps: the numbers behind the errata of the map (thesis 3.1, 3.3) and of area weighting (3.4): E1, E2, E4, E5,
 * E17, E18, E19. */
#include "still.h"

#include "bis/scene/parameters.h"
#include "bis/thesis/phong.h"
#include "bis/thesis/regions.h"


static rgb grey(double v) { return rgb_from(v, v, v); }

static void draw_numbers(double u[4], bis_rng *r)
{
    for (int k = 0; k < 4; k++) u[k] = bis_rng_double(r);
}

/* ---- E1: a patch that is turned away from the sky ---- */

static rgb upper_half(int x, int y, int width, int height)
{
    (void)x;
    (void)width;
    return grey(y < height / 2 ? 1 : 0);
}

void errata_E1(bis_json *j)
{
    enum { TILTS = 18, DRAWS = 40000 };
    bis_light *sky = errata_light(64, 32, upper_half, BIS_TABLE_ALIAS);
    bis_settings em = bis_settings_default(&bis_em);
    double degrees[TILTS], ours[TILTS], printed[TILTS];

    em.samples = 16;
    for (int i = 0; i < TILTS; i++) {
        const double t = (degrees[i] = 10 * i) * PI / 180;
        double sum = 0, u[4];
        int above = 0;
        errata_spot s;
        bis_rng r;
        errata_spot_init(&s, sky, bis_phong(grey(1), grey(0), 1), vec3_from(sin(t), 0, cos(t)), 0, false);
        ours[i] = errata_run(&s, &em, DRAWS / 16).mean / 3;
        bis_rng_init(&r, ERRATA_SEED, 0, 0, 0);
        for (int k = 0; k < DRAWS; k++) { /* a mean over the hemisphere alone */
            bis_light_point y;
            draw_numbers(u, &r);
            bis_light_sample(sky, u, &y);
            const double c = dot(s.pt.n, y.wi);
            if (c <= 0) continue;
            sum += (double)y.Le.r / PI * c / y.pdf;
            above++;
        }
        printed[i] = above ? sum / above : 0;
    }
    still_list(j, "tilt_deg", degrees, TILTS);
    still_list(j, "printed", printed, TILTS);
    still_list(j, "right", ours, TILTS);
    bis_light_free(sky);
}

/* ---- E2: the shadow of a square, from above ---- */

static rgb window(int x, int y, int width, int height)
{
    (void)width;
    (void)height;
    return grey(x >= 3 && x < 6 && y >= 3 && y < 5 ? 1 : 0);
}

/* A square of side 0.6 hovers at height 1; how much of the window is seen from each place of the floor, by side^2
 * directions a pixel of the map. */
static void shadow(bis_json *j, const char *key, const bis_envmap *em, int side)
{
    enum { SIZE = 190, MAX = 6 * 64 };
    vec3 w[MAX];
    double weight[MAX], all = 0;
    int n = 0;
    bis_image field = still_field(SIZE, SIZE);

    for (int y = 3; y < 5; y++) {
        for (int x = 3; x < 6; x++) {
            for (int k = 0; k < side * side; k++) {
                w[n] = bis_envmap_direction(em, x, y, (k % side + 0.5) / side, ((int)(k / side) + 0.5) / side);
                weight[n] = em->row_solid_angle[y] / (side * side) * (double)w[n].z;
                all += weight[n++];
            }
        }
    }
    for (int py = 0; py < SIZE; py++) {
        for (int px = 0; px < SIZE; px++) {
            const double x = 2 * ((px + 0.5) / SIZE - 0.5), y = 2 * ((py + 0.5) / SIZE - 0.5);
            double E = 0;
            for (int k = 0; k < n; k++) {
                const double dx = x + (double)w[k].x / (double)w[k].z - 0.65,
                             dy = y + (double)w[k].y / (double)w[k].z - 0.76;
                if (fabs(dx) > 0.3 || fabs(dy) > 0.3) E += weight[k];
            }
            field.pixels[py * SIZE + px] = rgb_scale(rgb_from(1, 0.93, 0.79), E / all);
        }
    }
    still_picture(j, key, &field);
}

void errata_E2(bis_json *j)
{
    bis_envmap em;

    errata_map(&em, 32, 16, window);
    shadow(j, "printed", &em, 1);
    shadow(j, "right", &em, 8);
    bis_envmap_clear(&em);
}

/* ---- E4: one lit pixel ---- */

enum { LIT_X = 20, LIT_Y = 14, ZOOM = 20, AROUND = 5 };

static rgb one_lit(int x, int y, int width, int height)
{
    (void)width;
    (void)height;
    return grey(x == LIT_X && y == LIT_Y ? 1 : 0);
}

/* Place of a direction in the map, in pixels. */
static void place_in_map(double *x, double *y, vec3 w)
{
    const double phi = atan2((double)w.y, (double)w.x);

    *x = 64 * (phi < 0 ? phi + 2 * PI : phi) / (2 * PI);
    *y = 32 * atan2(hypot((double)w.x, (double)w.y), (double)w.z) / PI;
}

static double bilinear(double x, double y)
{
    return fmax(0, 1 - fabs(x - LIT_X - 0.5)) * fmax(0, 1 - fabs(y - LIT_Y - 0.5));
}

static double nearest(double x, double y) { return floor(x) == LIT_X && floor(y) == LIT_Y; }

/* What the look-up finds in AROUND x AROUND pixels about the lit one, ZOOM x ZOOM places in each; the first draws, in
 * pixels from their corner; and the share of the flux that all draws find. */
static void lit_pixel(bis_json *j, const char *key, const bis_light *light, double (*look_up)(double x, double y))
{
    enum { DRAWS = 100000, SHOWN = 120, SIZE = ZOOM * AROUND };
    const double x0 = LIT_X - AROUND / 2, y0 = LIT_Y - AROUND / 2;
    double found = 0, u[4], L[SIZE * SIZE], x[SHOWN], y[SHOWN];
    bis_rng r;

    for (int i = 0; i < SIZE * SIZE; i++)
        L[i] = look_up(x0 + (i % SIZE + 0.5) / ZOOM, y0 + ((int)(i / SIZE) + 0.5) / ZOOM);
    bis_rng_init(&r, ERRATA_SEED, 0, 0, 0);
    for (int k = 0; k < DRAWS; k++) {
        double px, py;
        bis_light_point s;
        draw_numbers(u, &r);
        bis_light_sample(light, u, &s);
        place_in_map(&px, &py, s.wi);
        found += look_up(px, py) / s.pdf / DRAWS;
        if (k < SHOWN) x[k] = px - x0, y[k] = py - y0;
    }
    bis_json_open(j, key, '{');
    BIS_JSON_NUMBERS(j, {"pixels", AROUND}, {"side", SIZE}, {"found", 3 * found / bis_light_power(light)});
    still_list(j, "radiance", L, SIZE * SIZE);
    still_list(j, "x", x, SHOWN);
    still_list(j, "y", y, SHOWN);
    bis_json_close(j);
}

void errata_E4(bis_json *j)
{
    bis_light *light = errata_light(64, 32, one_lit, BIS_TABLE_ALIAS);

    lit_pixel(j, "printed", light, bilinear);
    lit_pixel(j, "right", light, nearest);
    bis_light_free(light);
}

/* ---- E5: a white ball between a red and a blue half of the sky ---- */

static rgb red_blue(int x, int y, int width, int height)
{
    (void)y;
    (void)height;
    return x < width / 4 || x >= width - width / 4 ? (rgb){1, 0.1f, 0.1f} : (rgb){0.1f, 0.1f, 1};
}

enum { BALL_DRAWS = 4096 };

static void ball(bis_json *j, const char *key, const bis_light_point *s, const rgb *value)
{
    enum { radius = 92, side = 2 * radius + 1 };
    bis_image field = still_field(side, side);

    for (int j0 = -radius; j0 <= radius; j0++) {
        for (int i = -radius; i <= radius; i++) {
            const double a = (double)i / radius, b = -(double)j0 / radius, c = 1 - a * a - b * b;
            rgbd L = {0, 0, 0};
            field.pixels[(j0 + radius) * side + i + radius] = rgb_from(1, 1, 1);
            if (c <= 0) continue;
            const vec3 n = vec3_from(a, sqrt(c), b);
            for (int k = 0; k < BALL_DRAWS; k++) {
                const double share = fmax(0, dot(n, s[k].wi)) / PI / BALL_DRAWS;
                L = rgbd_add(
                    L, (rgbd){(double)value[k].r * share, (double)value[k].g * share, (double)value[k].b * share});
            }
            field.pixels[(j0 + radius) * side + i + radius] = rgbd_round(L);
        }
    }
    still_picture(j, key, &field);
}

void errata_E5(bis_json *j)
{
    static bis_light_point s[BALL_DRAWS];
    static rgb ours[BALL_DRAWS], printed[BALL_DRAWS];
    bis_light *light = errata_light(64, 32, red_blue, BIS_TABLE_CDF);
    const double power = bis_light_power(light);
    bis_rng r;

    bis_rng_init(&r, ERRATA_SEED, 0, 0, 0);
    for (int k = 0; k < BALL_DRAWS; k++) {
        const double u[4] = {
            (k + bis_rng_double(&r)) / BALL_DRAWS, bis_rng_double(&r), bis_rng_double(&r), bis_rng_double(&r)};
        bis_light_sample(light, u, &s[k]);
        ours[k] = rgb_scale(s[k].Le, 1 / s[k].pdf); /* F_rgb/q */
        printed[k] = grey(power / 3);               /* L/q cancelled: the same for all */
    }
    ball(j, "printed", s, printed);
    ball(j, "right", s, ours);
    bis_light_free(light);
}

/* ---- E17: what area a light's importance is multiplied with ---- */

void errata_E17(bis_json *j)
{
    enum { N = 101 };
    const double b = 0.15, pixel = 2 * PI / 512 * 2 * sin(PI / 512); /* 512 x 256, at the equator */
    double A[N], ours[N], unlimited[N], of_sphere[N], own[N];

    for (int i = 0; i < N; i++) {
        A[i] = 1e-5 * pow(10, 6.0 * i / (N - 1));
        ours[i] = bis_area_factor(A[i], b);
        unlimited[i] = pow(A[i] / 0.01, b);
        of_sphere[i] = pow(fmin(0.01 * 4 * PI, A[i]) / 0.01, b);
        own[i] = pow(fmin(0.01, pixel) / 0.01, b);
    }
    bis_json_number(j, "b", b);
    still_list(j, "A", A, N);
    still_list(j, "unlimited", unlimited, N);
    still_list(j, "of_sphere", of_sphere, N);
    still_list(j, "own_pixel", own, N);
    still_list(j, "right", ours, N);
}

/* ---- E18: levels of a sky, as it is and in another exposure ---- */

static rgb sky(int x, int y, int width, int height)
{
    const double phi = 2 * PI * (x + 0.5) / width, theta = PI * (y + 0.5) / height;
    const double c = sin(theta) * cos(phi - 2.2) * sin(0.9) + cos(theta) * cos(0.9);
    const double air = theta < PI / 2 ? 0.5 + 1.5 * exp(-3 * (PI / 2 - theta)) : 0.08;

    return grey(air + 0.8 * exp(12 * (c - 1)) + (c > 0.995 ? 3000 : 0));
}

static rgb dim_sky(int x, int y, int width, int height) { return rgb_scale(sky(x, y, width, height), 0.001); }

enum { LEVELS = 8 };

static int level_by_log_1_plus_I(double I, double most)
{
    return (int)fmin(LEVELS - 1, floor(LEVELS * log1p(I) / log1p(most)));
}

static void levels(bis_json *j, errata_paint *paint, bool as_printed)
{
    enum { WIDTH = 170, HEIGHT = 85 };
    bis_envmap em;

    errata_map(&em, WIDTH, HEIGHT, paint);
    const bis_levels scale = bis_levels_of(&em, LEVELS);
    const double most = bis_envmap_max_intensity(&em);
    bis_json_open(j, NULL, '{');
    BIS_JSON_NUMBERS(j, {"width", WIDTH}, {"height", HEIGHT}, {"levels", LEVELS});
    bis_json_open(j, "level", '[');
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        const double I = rgb_sum(em.pixels[i]);
        bis_json_number(j, NULL, as_printed ? level_by_log_1_plus_I(I, most) : bis_level_of_intensity(&scale, I));
    }
    bis_json_close(j);
    bis_json_close(j);
    bis_envmap_clear(&em);
}

/* Of each, the sky and the same, exposed 1000 times shorter. */
void errata_E18(bis_json *j)
{
    for (int k = 0; k < 2; k++) {
        bis_json_open(j, k ? "right" : "printed", '[');
        levels(j, sky, k == 0);
        levels(j, dim_sky, k == 0);
        bis_json_close(j);
    }
}

/* ---- E19: a sun on the seam ---- */

enum { SEAM_W = 256, SEAM_H = 128, SUN_ROW = 50 };

static rgb sun_on_the_seam(int x, int y, int width, int height)
{
    const double dx = x + 0.5 < width / 2.0 ? x + 0.5 : x + 0.5 - width, dy = y + 0.5 - SUN_ROW;

    (void)height;
    return grey(dx * dx + dy * dy < 2.3 * 2.3 ? 1000 : 1);
}

/* As if the map ended at the seam: a black column, which belongs to no component, stands there. */
static rgb sun_before_the_end(int x, int y, int width, int height)
{
    return x == width - 1 ? grey(0) : sun_on_the_seam(x, y, width - 1, height);
}

/* Pixels about the seam, which is in their middle: 0 sky, 1 the first light, 2 another. */
static void seam(bis_json *j, const char *key, errata_paint *paint, int width)
{
    enum { ACROSS = 14, DOWN = 10 };
    bis_regions regions;
    uint32_t first = BIS_REGION_NONE;
    bis_envmap em;
    double A = 0;
    int n = 0;

    errata_map(&em, width, SEAM_H, paint);
    still_check(bis_regions_init(&regions, &em, 8, NULL));
    for (uint32_t k = 0; k < regions.n; k++)
        if (regions.solid_angle[k] < 1) n++, A = regions.solid_angle[k];
    bis_json_open(j, key, '{');
    BIS_JSON_NUMBERS(j, {"lights", n}, {"solid_angle", A}, {"factor", bis_area_factor(A, 0.15)}, {"columns", ACROSS},
        {"rows", DOWN});
    bis_json_open(j, "light", '[');
    for (int i = 0; i < ACROSS * DOWN; i++) {
        const int x = (i % ACROSS - ACROSS / 2 + SEAM_W) % SEAM_W, y = SUN_ROW - DOWN / 2 + i / ACROSS;
        const uint32_t label = regions.label[y * width + x];
        const bool is_sun = regions.solid_angle[label] < 1;
        if (is_sun && first == BIS_REGION_NONE) first = label;
        bis_json_number(j, NULL, !is_sun ? 0 : label == first ? 1 : 2);
    }
    bis_json_close(j);
    bis_json_close(j);
    bis_regions_clear(&regions);
    bis_envmap_clear(&em);
}

void errata_E19(bis_json *j)
{
    seam(j, "printed", sun_before_the_end, SEAM_W + 1);
    seam(j, "right", sun_on_the_seam, SEAM_W);
}
