/* SPDX-License-Identifier: BSD-2-Clause */
/* errata_maps: pictures of the errata of the map (thesis 3.1, 3.3) and of area weighting (3.4): E1, E2, E4, E5, E17,
 * E18, E19. */
#include "errata_plots.h"

#include "bis/scene/parameters.h"
#include "bis/thesis/phong.h"
#include "bis/thesis/regions.h"

#include "drawing.h"
#include "out/palette.h"

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

void errata_E1(FILE *svg)
{
    enum { TILTS = 18, DRAWS = 40000 };
    bis_light *sky = errata_light(64, 32, upper_half, BIS_TABLE_ALIAS);
    errata_plane p = errata_plane_over(svg, 0, 180, 0, 1.3);
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
    errata_axes(&p, "tilt from the zenith, degrees", "0 45 90 135 180", "reflected by a white patch, sky L = 1 above", "0 0.5 1");
    errata_line(&p, degrees, printed, TILTS, errata_printed());
    errata_line(&p, degrees, ours, TILTS, errata_right());
    errata_dots(&p, degrees, printed, TILTS, errata_printed());
    errata_dots(&p, degrees, ours, TILTS, errata_right());
    errata_say(svg, 225, 50, errata_printed(), "as printed: below the horizon, not counted");
    errata_say(svg, 60, 180, errata_right(), "right: (1 + cos tilt)/2");
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
static void shadow(FILE *svg, int left, const bis_envmap *em, int side)
{
    enum { SIZE = 190, TOP = 42, MAX = 6 * 64 };
    vec3 w[MAX];
    double weight[MAX], all = 0;
    int n = 0;
    bis_image field = errata_field(SIZE, SIZE);

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
                const double dx = x + (double)w[k].x / (double)w[k].z - 0.65, dy = y + (double)w[k].y / (double)w[k].z - 0.76;
                if (fabs(dx) > 0.3 || fabs(dy) > 0.3) E += weight[k];
            }
            field.pixels[py * SIZE + px] = rgb_scale(bis_palette_srgb(1, 0.97, 0.9), E / all);
        }
    }
    errata_show(svg, left, TOP, &field);
}

void errata_E2(FILE *svg)
{
    bis_envmap em;

    errata_map(&em, 32, 16, window);
    errata_heads(svg, "6 lit pixels are 6 point lights", "6 lit pixels are 6 patches");
    shadow(svg, 25, &em, 1);
    shadow(svg, 265, &em, 8);
    bis_envmap_clear(&em);
}

/* ---- E4: one lit pixel ---- */

enum { LIT_X = 20, LIT_Y = 14, ZOOM = 36, AROUND = 5 };

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

static void lit_pixel(FILE *svg, int left, const bis_light *light, double (*look_up)(double x, double y), rgb colour)
{
    enum { DRAWS = 100000, SHOWN = 120, TOP = 38, SIZE = ZOOM * AROUND };
    const double x0 = LIT_X - AROUND / 2, y0 = LIT_Y - AROUND / 2;
    double found = 0, u[4], x, y;
    bis_image field = errata_field(SIZE, SIZE);
    bis_rng r;

    for (int i = 0; i < SIZE * SIZE; i++) {
        const double L = look_up(x0 + (i % SIZE + 0.5) / ZOOM, y0 + ((int)(i / SIZE) + 0.5) / ZOOM);
        field.pixels[i] = bis_palette_heat(0.95 * sqrt(L));
    }
    errata_show(svg, left, TOP, &field);
    for (int k = 0; k <= AROUND; k++) {
        drawing_line(svg, left + ZOOM * k, TOP, left + ZOOM * k, TOP + SIZE, 1, errata_grey(0.4));
        drawing_line(svg, left, TOP + ZOOM * k, left + SIZE, TOP + ZOOM * k, 1, errata_grey(0.4));
    }
    bis_rng_init(&r, ERRATA_SEED, 0, 0, 0);
    for (int k = 0; k < DRAWS; k++) {
        bis_light_point s;
        draw_numbers(u, &r);
        bis_light_sample(light, u, &s);
        place_in_map(&x, &y, s.wi);
        found += look_up(x, y) / s.pdf / DRAWS;
        if (k < SHOWN) drawing_disc(svg, left + ZOOM * (x - x0), TOP + ZOOM * (y - y0), 1.5, errata_ink());
    }
    errata_say_middle(svg, left + SIZE / 2.0, 234, colour, "found: %.2f %% of the flux", 300 * found / bis_light_power(light));
}

void errata_E4(FILE *svg)
{
    bis_light *light = errata_light(64, 32, one_lit, BIS_TABLE_ALIAS);

    errata_heads(svg, "bilinear look-up", "nearest pixel");
    lit_pixel(svg, 30, light, bilinear, errata_printed());
    lit_pixel(svg, 270, light, nearest, errata_right());
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

static void ball(FILE *svg, int x, int y, int radius, const bis_light_point *s, const rgb *value)
{
    const int side = 2 * radius + 1;
    bis_image field = errata_field(side, side);

    for (int j = -radius; j <= radius; j++) {
        for (int i = -radius; i <= radius; i++) {
            const double a = (double)i / radius, b = -(double)j / radius, c = 1 - a * a - b * b;
            rgbd L = {0, 0, 0};
            if (c <= 0) continue;
            const vec3 n = vec3_from(a, sqrt(c), b);
            for (int k = 0; k < BALL_DRAWS; k++) {
                const double share = fmax(0, dot(n, s[k].wi)) / PI / BALL_DRAWS;
                L = rgbd_add(L, (rgbd){(double)value[k].r * share, (double)value[k].g * share, (double)value[k].b * share});
            }
            field.pixels[(j + radius) * side + i + radius] = rgbd_round(L);
        }
    }
    errata_show(svg, x - radius, y - radius, &field);
}

void errata_E5(FILE *svg)
{
    static bis_light_point s[BALL_DRAWS];
    static rgb ours[BALL_DRAWS], printed[BALL_DRAWS];
    bis_light *light = errata_light(64, 32, red_blue, BIS_TABLE_CDF);
    const double power = bis_light_power(light);
    bis_rng r;

    bis_rng_init(&r, ERRATA_SEED, 0, 0, 0);
    for (int k = 0; k < BALL_DRAWS; k++) {
        const double u[4] = {(k + bis_rng_double(&r)) / BALL_DRAWS, bis_rng_double(&r), bis_rng_double(&r), bis_rng_double(&r)};
        bis_light_sample(light, u, &s[k]);
        ours[k] = rgb_scale(s[k].Le, 1 / s[k].pdf); /* F_rgb/q */
        printed[k] = grey(power / 3);               /* L/q cancelled: the same for all */
    }
    errata_heads(svg, "L/q is one number", "L is red, green, blue");
    ball(svg, 120, 136, 92, s, printed);
    ball(svg, 360, 136, 92, s, ours);
    bis_light_free(light);
}

/* ---- E17: what area a light's importance is multiplied with ---- */

void errata_E17(FILE *svg)
{
    enum { N = 101 };
    const double b = 0.15, pixel = 2 * PI / 512 * 2 * sin(PI / 512); /* 512 x 256, at the equator */
    double A[N], ours[N], unlimited[N], of_sphere[N], own[N];
    errata_plane p = errata_plane_over(svg, 1e-5, 10, 0.2, 2.8);

    for (int i = 0; i < N; i++) {
        A[i] = 1e-5 * pow(10, 6.0 * i / (N - 1));
        ours[i] = bis_area_factor(A[i], b);
        unlimited[i] = pow(A[i] / 0.01, b);
        of_sphere[i] = pow(fmin(0.01 * 4 * PI, A[i]) / 0.01, b);
        own[i] = pow(fmin(0.01, pixel) / 0.01, b);
    }
    p.log_x = true;
    errata_axes(&p, "solid angle A of the light, sr", "1e-5 1e-4 1e-3 1e-2 1e-1 1 10", "factor of its importance", "0.5 1 1.5 2 2.5");
    errata_line(&p, A, unlimited, N, errata_printed());
    errata_line(&p, A, of_sphere, N, errata_printed());
    errata_line(&p, A, own, N, errata_printed());
    errata_line(&p, A, ours, N, errata_right());
    errata_say(svg, 60, 50, errata_printed(), "as printed, three readings; b = %.2f", b);
    errata_say(svg, 350, 60, errata_printed(), "no limit");
    errata_say(svg, 365, errata_y(&p, of_sphere[N - 1]) + 13, errata_printed(), "0.01 of the sphere");
    errata_say(svg, 330, errata_y(&p, own[N - 1]) - 6, errata_printed(), "the pixel's own dOmega");
    errata_say(svg, 260, errata_y(&p, 1) + 13, errata_right(), "right: min(0.01 sr, A)^b");
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

static int level_by_log_1_plus_I(double I, double most) { return (int)fmin(LEVELS - 1, floor(LEVELS * log1p(I) / log1p(most))); }

static void levels(FILE *svg, int left, int top, errata_paint *paint, bool as_printed)
{
    enum { WIDTH = 170, HEIGHT = 85 };
    bis_image field = errata_field(WIDTH, HEIGHT);
    bis_envmap em;
    int used[LEVELS] = {0}, n = 0;

    errata_map(&em, WIDTH, HEIGHT, paint);
    const bis_levels scale = bis_levels_of(&em, LEVELS);
    const double most = bis_envmap_max_intensity(&em);
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        const double I = rgb_sum(em.pixels[i]);
        const int level = as_printed ? level_by_log_1_plus_I(I, most) : bis_level_of_intensity(&scale, I);
        field.pixels[i] = bis_palette_heat((level + 0.5) / LEVELS);
        used[level] = 1;
    }
    errata_show(svg, left, top, &field);
    for (int k = 0; k < LEVELS; k++) n += used[k];
    errata_say(svg, left + WIDTH + 5, top + 40, errata_ink(), "%d of", n);
    errata_say(svg, left + WIDTH + 5, top + 54, errata_ink(), "%d levels", LEVELS);
    bis_envmap_clear(&em);
}

void errata_E18(FILE *svg)
{
    errata_heads(svg, "nothing said of the steps: log(1 + I)", "equal steps of log I");
    for (int k = 0; k < 2; k++) {
        levels(svg, k ? 245 : 5, 42, sky, k == 0);
        levels(svg, k ? 245 : 5, 142, dim_sky, k == 0);
    }
    errata_say_middle(svg, ERRATA_WIDTH / 2.0, 237, errata_faint(), "above: a sky; below: the same, exposed 1000 times shorter");
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

static void seam(FILE *svg, int left, errata_paint *paint, int width, rgb colour)
{
    enum { CELL = 15, ACROSS = 14, DOWN = 10, TOP = 40 };
    bis_regions regions;
    uint32_t first = BIS_REGION_NONE;
    bis_envmap em;
    double A = 0, b = 0.15;
    int n = 0;

    errata_map(&em, width, SEAM_H, paint);
    errata_check(bis_regions_init(&regions, &em, 8, NULL));
    for (uint32_t k = 0; k < regions.n; k++)
        if (regions.solid_angle[k] < 1) n++, A = regions.solid_angle[k];
    for (int j = 0; j < DOWN; j++) {
        for (int i = 0; i < ACROSS; i++) {
            const int x = (i - ACROSS / 2 + SEAM_W) % SEAM_W, y = SUN_ROW - DOWN / 2 + j;
            const uint32_t label = regions.label[y * width + x];
            const bool is_sun = regions.solid_angle[label] < 1;
            if (is_sun && first == BIS_REGION_NONE) first = label;
            drawing_box(svg, left + CELL * i, TOP + CELL * j, CELL - 1, CELL - 1,
                           !is_sun ? errata_grey(0.85) : label == first ? colour : rgb_add(rgb_scale(colour, 0.35), grey(0.3)));
        }
    }
    drawing_line(svg, left + CELL * ACROSS / 2.0 - 0.5, TOP - 6, left + CELL * ACROSS / 2.0 - 0.5, TOP + CELL * DOWN + 6, 2, errata_ink());
    errata_say_middle(svg, left + CELL * ACROSS / 2.0, TOP + CELL * DOWN + 20, colour, n == 1 ? "%d light of %.4f sr" : "%d lights of %.4f sr", n, A);
    errata_say_middle(svg, left + CELL * ACROSS / 2.0, TOP + CELL * DOWN + 36, colour, "importance x %.3f", bis_area_factor(A, b));
    bis_regions_clear(&regions);
    bis_envmap_clear(&em);
}

void errata_E19(FILE *svg)
{
    errata_heads(svg, "the map ends at its edge", "its edges are joined");
    seam(svg, 15, sun_before_the_end, SEAM_W + 1, errata_printed());
    seam(svg, 255, sun_on_the_seam, SEAM_W, errata_right());
}
