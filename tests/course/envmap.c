/* SPDX-License-Identifier: BSD-2-Clause */
/* Assignment envmap: src/thesis/envmap.c, src/thesis/importance.c, src/thesis/importance_table.c: solid angles,
 * directions, pixels, and a draw in two passes. Expected values by closed forms and by lat-long geometry in long
 * double. Statistical tests: 7. */
#include "mark.h"

#include "bis/thesis/regions.h"

#include "map_help.h"

#include <string.h>

static const long double pi = 3.14159265358979323846264338327950288L;

/* The solid angle of a pixel, by another form than the thesis's. */
static double solid_angle(int width, int height, int y)
{
    return (double)(2 * pi / width * 2 * sinl(pi * (2 * y + 1) / (2.0L * height)) * sinl(pi / (2.0L * height)));
}

/* The student's solid angles[height] and cosines[height + 1]. */
static void tables_of(int width, int height, double *angle, double *cosine)
{
    const ask_map m = {.width = width, .height = height};

    ASK(ASK_MAP, GIVE(&m, 1), TAKE(angle, (size_t)height), TAKE(cosine, (size_t)height + 1));
}

static void a_pixel_of_each_row_has_its_solid_angle(void)
{
    const int sizes[][2] = {{8, 4}, {1, 1}, {7, 5}, {(int)mark_size(64), (int)mark_size(32)},
                            {16, (int)mark_size(4000)}};

    for (int k = 0; k < 5; k++) {
        const int width = sizes[k][0], height = sizes[k][1];
        double *angle = mark_alloc((size_t)height, sizeof *angle),
            *cosine = mark_alloc((size_t)height + 1, sizeof *cosine);
        tables_of(width, height, angle, cosine);
        for (int y = 0; y < height; y++) {
            mark_near(angle[y], solid_angle(width, height, y), 0, 1e-6, "the solid angle of a pixel in row %d of a "
                      "%d x %d map", y, width, height);
            mark_near(cosine[y], (double)cosl(pi * y / height), 1e-12, 0, "cos_edge[%d] of a %d x %d map", y, width,
                      height);
        }
        mark_near(cosine[height], -1, 1e-12, 0, "cos_edge[%d] of a %d x %d map", height, width, height);
    }
}

static void all_pixels_together_are_4_pi(void)
{
    const int sizes[][2] = {{8, 4}, {5, 3}, {64, 32}, {4, 2048}};
    static double angle[2048], cosine[2049];

    for (int k = 0; k < 4; k++) {
        double sum = 0;
        tables_of(sizes[k][0], sizes[k][1], angle, cosine);
        for (int y = 0; y < sizes[k][1]; y++) sum += sizes[k][0] * angle[y];
        mark_near(sum, 4 * PI, 0, 1e-9, "the solid angle of the whole sphere");
    }
}

static void directions_of_a_pixel_lie_in_it(void)
{
    enum { W = 8, H = 6, EACH = 64, N = W * H * EACH };
    const ask_map m = {.width = W, .height = H};
    static ask_place p[N];
    static vec3 at[N];

    for (int k = 0; k < N; k++) {
        p[k] = (ask_place){k / EACH % W, k / EACH / W, (k % 8 + 0.5) / 8, (k / 8 % 8 + 0.5) / 8};
    }
    ASK(ASK_DIRECTIONS, GIVE(&m, 1), GIVE(p, N), TAKE(at, N));
    for (int k = 0; k < N; k++) {
        const int x = p[k].x, y = p[k].y;
        const vec3 w = at[k];
        if (!(fabs(length(w) - 1) < 1e-6)) {
            mark_wrong("the direction of pixel (%d, %d) has length %g, must be 1", x, y, length(w));
        }
        const double theta = acos(fmax(-1, fmin(1, (double)w.z))), phi = atan2((double)w.y, (double)w.x),
            turn = phi < 0 ? phi + 2 * PI : phi;
        if ((int)(theta / PI * H) != y) {
            mark_wrong("a direction of pixel (%d, %d) has theta = %.4f, in row %d. Row 0 is at +z", x, y, theta,
                       (int)(theta / PI * H));
        }
        if ((int)(turn / (2 * PI) * W) != x) {
            mark_wrong("a direction of pixel (%d, %d) has phi = %.4f, in column %d", x, y, turn,
                       (int)(turn / (2 * PI) * W));
        }
    }
}

/* cos theta of a direction uniform in solid angle is uniform between the edges of the row: at u2 = 1/2, in the
 * middle. */
static void directions_are_uniform_in_solid_angle(void)
{
    enum { W = 8, H = 4, N = W * H * 4 };
    const ask_map m = {.width = W, .height = H};
    ask_place p[N];
    vec3 at[N];

    for (int k = 0; k < N; k++) p[k] = (ask_place){k % W, k / W % H, (k / W / H + 0.25) / 4, (k / W / H + 0.5) / 4};
    ASK(ASK_DIRECTIONS, GIVE(&m, 1), GIVE(p, N), TAKE(at, N));
    for (int k = 0; k < N; k++) {
        const int x = p[k].x, y = p[k].y;
        const double c0 = cos(PI * y / H), c1 = cos(PI * (y + 1) / H), phi = 2 * PI * (x + p[k].u1) / W;
        mark_near((double)at[k].z, c0 + p[k].u2 * (c1 - c0), 1e-6, 0, "row %d of 4, u2 = %g: cos theta", y, p[k].u2);
        mark_near((double)at[k].x * cos(phi) + (double)at[k].y * sin(phi), hypot((double)at[k].x, (double)at[k].y),
                  1e-6, 0, "pixel (%d, %d), u1 = %g: how "
                  "far the direction lies along the phi of 2 pi (x + u1)/W, which", x, y, p[k].u1);
    }
}

static void check_known_pixels(const ask_map *m)
{
    enum { N = 8, ENDS = 7 };
    static const struct { vec3 w; int x, y; } known[N] = { /* x: -1 where any will do */
        {{0, 0, 1}, -1, 0}, {{0, 0, -1}, -1, 6}, {{1, 1e-3f, 0}, 0, 3}, {{1, -1e-3f, 0}, 9, 3},
            {{-1, 1e-3f, 0}, 4, 3}, {{-1, -1e-3f, 0}, 5, 3},
        {{1e-3f, 1e-5f, 1}, 0, 0}, {{1e-3f, -1e-5f, -1}, 9, 6}};
    vec3 w[N + ENDS] = {[N] = {0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {1, -0.0f, 0}, {1, -1e-20f, 0}, {-1, 0, 0},
                        {-1, -1e-20f, 0}};
    size_t pixel[N + ENDS];

    for (size_t k = 0; k < N; k++) w[k] = normalize(known[k].w);
    ASK(ASK_PIXELS, GIVE(m, 1), GIVE(w, N + ENDS), TAKE(pixel, N + ENDS));
    for (size_t k = 0; k < N; k++) {
        const size_t x = pixel[k] % 10, y = pixel[k] / 10;
        if (y != (size_t)known[k].y || (known[k].x >= 0 && x != (size_t)known[k].x)) {
            mark_wrong("direction (%g %g %g) of a 10 x 7 map: pixel (%zu, %zu), must be (%d, %d) (-1: any)",
                       (double)w[k].x, (double)w[k].y,
                       (double)w[k].z, x, y, known[k].x, known[k].y);
        }
    }
    for (size_t k = N; k < N + ENDS; k++) {
        if (pixel[k] >= 70) {
            mark_wrong("direction (%g %g %g): pixel %zu of 70. The south pole and the seam want care",
                       (double)w[k].x, (double)w[k].y, (double)w[k].z, pixel[k]);
        }
    }
}

static void a_direction_finds_its_pixel(void)
{
    enum { N = 20000 };
    const ask_map m = {.width = 10, .height = 7};
    double *u = mark_uniforms(2 * N, mark_seed(1), 0);
    vec3 *w = mark_alloc(N, sizeof *w);
    size_t *pixel = mark_alloc(N, sizeof *pixel);

    for (int k = 0; k < N; k++) {
        const double theta = PI * u[2 * k], phi = 2 * PI * u[2 * k + 1];
        w[k] = vec3_from(sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta));
    }
    ASK(ASK_PIXELS, GIVE(&m, 1), GIVE(w, N), TAKE(pixel, N));
    for (int k = 0; k < N; k++) {
        const double down = 7 * u[2 * k], along = 10 * u[2 * k + 1];
        const double from_edge = fmin(fabs(remainder(down, 1)), fabs(remainder(along, 1)));
        if (from_edge < 1e-4 || sin(PI * u[2 * k]) < 1e-3) continue; /* rounding to float may carry it over */
        if (pixel[k] != (size_t)((int)down * 10 + (int)along)) {
            mark_wrong("theta = %.4f, phi = %.4f of a 10 x 7 map: pixel (%zu, %zu), must be (%d, %d)", PI * u[2 * k],
                       2 * PI * u[2 * k + 1],
                       pixel[k] % 10, pixel[k] / 10, (int)along, (int)down);
        }
    }
    check_known_pixels(&m);
}

/* ---- drawing ---- */

/* What is asked of the importance of a map: the densities of its pixels, and draws. */
typedef struct drawing {
    bis_envmap em;
    ask_map map;
    size_t n;
    double *angle; /* [height]: the student's, of a pixel: a wrong one costs the claims about it, and no others */
    double *pdf_pixel, *pdf;
    ask_drawn *drawn;
} drawing;

/* The map is taken over. u[4 n_draws] are borrowed. */
static drawing draw_from(bis_envmap em, const bis_importance_options *options, const double *u, size_t n_draws,
                         bool with_pdf)
{
    drawing d = {.em = em, .map = {.width = em.width, .height = em.height, .options = *options}, .n = map_n(&em)};
    double *cosine = mark_alloc((size_t)em.height + 1, sizeof *cosine);

    d.angle = mark_alloc((size_t)em.height, sizeof *d.angle);
    tables_of(em.width, em.height, d.angle, cosine);
    d.pdf_pixel = mark_alloc(d.n, sizeof *d.pdf_pixel);
    d.drawn = mark_alloc(n_draws, sizeof *d.drawn);
    if (with_pdf) d.pdf = mark_alloc(n_draws, sizeof *d.pdf);
    ASK(ASK_IMPORTANCE, GIVE(&d.map, 1), GIVE(em.pixels, d.n), GIVE(u, 4 * n_draws), TAKE(d.pdf_pixel, d.n),
        TAKE(d.drawn, n_draws),
        TAKE(d.pdf, with_pdf ? n_draws : 0));
    return d;
}

static double angle_of(const drawing *d, size_t pixel) { return d->angle[pixel / (size_t)d->em.width]; }
static double power_of(const drawing *d, size_t pixel) { return map_intensity(&d->em, pixel) * angle_of(d, pixel); }

static const bis_importance_options by_alias = {.table = true, .table_kind = BIS_TABLE_ALIAS, .levels = 8};
static const bis_importance_options by_cdf = {.table = true, .table_kind = BIS_TABLE_CDF, .levels = 8};

/* Not I, but the w of bis_weight: with area weighting it has a factor for each region. */
static void check_weighted_density(void)
{
    bis_importance_options options = by_alias;
    bis_regions regions;
    double total = 0;

    options.area_exponent = 0.5;
    /* so fine that regions have less than BIS_AREA_CLAMP */
    drawing d = draw_from(map_random(128, 64, 3, 0.5, mark_seed(8)), &options, NULL, 0, false);
    if (bis_regions_init(&regions, &d.em, 8, NULL)) mark_wrong("no memory");
    for (uint32_t k = 0; k < regions.n; k++) regions.solid_angle[k] = 0;
    for (size_t i = 0; i < d.n; i++) {
        if (regions.label[i] != BIS_REGION_NONE) regions.solid_angle[regions.label[i]] += angle_of(&d, i);
    }
    for (int pass = 0; pass < 2; pass++) {
        for (size_t i = 0; i < d.n; i++) {
            const double intensity = map_intensity(&d.em, i);
            const double w = intensity > 0 ? intensity * bis_area_factor(regions.solid_angle[regions.label[i]],
                    0.5) : 0;
            if (pass == 0) total += w * angle_of(&d, i);
            else mark_near(d.pdf_pixel[i], w / total, 0, 1e-5, "with area weighting: the density of pixel (%zu, %zu)",
                           i % 128, i / 128);
        }
    }
}

static void check_density(const drawing *d)
{
    const size_t width = (size_t)d->em.width;
    double power = 0, sum = 0;

    for (size_t i = 0; i < d->n; i++) power += power_of(d, i);
    for (size_t i = 0; i < d->n; i++) {
        mark_near(d->pdf_pixel[i], map_intensity(&d->em, i) / power, 0, 1e-6,
                  "the density per steradian of pixel (%zu, %zu), "
                  "whose intensity is %.4g,", i % width, i / width, map_intensity(&d->em, i));
        sum += d->pdf_pixel[i] * angle_of(d, i);
    }
    mark_near(sum, 1, 1e-6, 0, "the integral of the density over the sphere");
}

static void the_density_is_the_intensity_over_the_power(void)
{
    drawing d = draw_from(map_random(16, 8, 3, 0.2, mark_seed(5)), &by_alias, NULL, 0, false);

    check_density(&d);
    check_weighted_density();
}

/* A sample lies in its pixel and has its density. Returns in which quarter of the pixel it lies. */
static size_t check_sample(const drawing *d, const ask_drawn *drawn, const char *what)
{
    const bis_map_sample s = drawn->s;
    const size_t width = (size_t)d->em.width;
    const double height = d->em.height;

    if (!drawn->drawn) mark_wrong("%s: nothing is drawn from a map that has light", what);
    if (s.pixel >= d->n) mark_wrong("%s: pixel %zu of %zu", what, s.pixel, d->n);
    const double phi = atan2((double)s.w_local.y, (double)s.w_local.x),
        x = (phi < 0 ? phi / (2 * PI) + 1 : phi / (2 * PI)) * (double)width;
    const double row = (double)(s.pixel / width), column = (double)(s.pixel % width);
    const double c0 = cos(PI * row / height), c1 = cos(PI * (row + 1) / height),
        down = (c0 - (double)s.w_local.z) / (c0 - c1);
    /* floats: a direction's z is good to 1e-7, and its phi to 1e-7 over the sine */
    const double room = 2e-7 / (c0 - c1) + 1e-5, aside = 1e-5 + 1e-7 * (double)width / sqrt(1 - c0 * c0 + 1e-9);
    const bool inside = down > -room && down < 1 + room && x > column - aside && x < column + 1 + aside;
    if (!inside && s.pixel % width != width - 1 && s.pixel % width != 0) {
        mark_wrong("%s: the direction drawn does not lie in the pixel that is told, %zu", what, s.pixel);
    }
    if (!(fabs(s.pdf - d->pdf_pixel[s.pixel]) <= 1e-9 * s.pdf)) {
        mark_wrong("%s: the sample's density is %g, its pixel's %g", what, s.pdf, d->pdf_pixel[s.pixel]);
    }
    return (down > 0.5 ? 2u : 0u) + (x - floor(x) > 0.5 ? 1u : 0u);
}

static void draw(const bis_importance_options *options, const char *what)
{
    enum { W = 8, H = 4, CELLS = W * H * 4, DRAWS = 200000 };
    double *u = mark_uniforms(4 * DRAWS, mark_seed(2), 0), observed[CELLS] = {0}, expected[CELLS], power = 0;
    drawing d = draw_from(map_random(W, H, 2, 0.2, mark_seed(6)), options, u, DRAWS, false);

    for (int k = 0; k < DRAWS; k++) {
        const size_t quarter = check_sample(&d, &d.drawn[k], what);
        observed[4 * d.drawn[k].s.pixel + quarter]++;
    }
    for (size_t i = 0; i < W * H; i++) power += power_of(&d, i);
    for (size_t i = 0; i < CELLS; i++) expected[i] = DRAWS * power_of(&d, i / 4) / power / 4;
    mark_fit(observed, expected, CELLS, MARK_ALPHA, what, "Cell c is a quarter of pixel c/4. Rows by their sum, then a "
             "pixel of the row, then a place in it.");
}

/* Which of the four numbers may matter: the place has u[2] and u[3] with alias tables; u[0] and u[1] alone do it all
 * with CDFs. */
static void check_numbers(const bis_importance_options *options, const char *what)
{
    enum { N = 1000, DRAWS = 3 * N };
    double *random = mark_uniforms(3 * N, mark_seed(5), 0), *u = mark_alloc(4 * DRAWS, sizeof *u);

    for (size_t k = 0; k < N; k++) {
        const double u0 = random[3 * k], u1 = random[3 * k + 1],
            three[12] = {u0, u1, 0.1, 0.2, u0, u1, 0.8, 0.9, u0, random[3 * k + 2], 0, 0};
        memcpy(u + 12 * k, three, sizeof three);
    }
    drawing d = draw_from(map_random(8, 4, 2, 0.2, mark_seed(9)), options, u, DRAWS, false);
    for (size_t k = 0; k < N; k++) {
        const ask_drawn *three = d.drawn + 3 * k;
        const vec3 a = three[0].s.w_local, b = three[1].s.w_local;
        const double turn = fabs((double)a.x - (double)b.x) + fabs((double)a.y - (double)b.y);
        if (!three[0].drawn || !three[1].drawn || !three[2].drawn) {
            mark_wrong("%s: nothing is drawn from a map that has light", what);
        }
        if (three[0].s.pixel != three[1].s.pixel) {
            mark_wrong("%s: u[2] and u[3] change the pixel; it is u[0]'s row and u[1]'s pixel of it", what);
        }
        if (options->table_kind == BIS_TABLE_CDF && (turn != 0 || a.z != b.z)) {
            mark_wrong("%s: u[2] and u[3] change the direction; its place in the pixel is told by the two remainders",
                       what);
        }
        if (options->table_kind == BIS_TABLE_CDF && a.z != three[2].s.w_local.z) {
            mark_wrong("%s: u[1] changes theta; the row and the place in it, vertically, are u[0]'s and its "
                       "remainder's", what);
        }
        if (options->table_kind == BIS_TABLE_ALIAS && (turn == 0 || a.z == b.z)) {
            mark_wrong("%s: u[2] and u[3] do not move the place in the pixel", what);
        }
    }
}

static void directions_are_drawn_from_alias_tables(void)
{
    draw(&by_alias, "alias tables");
    check_numbers(&by_alias, "alias tables");
}

static void directions_are_drawn_from_cdfs(void)
{
    draw(&by_cdf, "CDFs");
    check_numbers(&by_cdf, "CDFs");
}

static void irradiance_of_a_constant_map_is_pi_on_every_side(void)
{
    enum { DRAWS = 40000 };
    const vec3 sides[] = {{0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {0, -1, 0}};

    for (int k = 0; k < 4; k++) {
        bis_envmap em = map_new(16, 8);
        for (size_t i = 0; i < map_n(&em); i++) em.pixels[i] = (rgb){1, 1, 1};
        double *u = mark_uniforms(4 * DRAWS, mark_seed(3), (uint64_t)k);
        drawing d = draw_from(em, &by_alias, u, DRAWS, false);
        stat_moments m = {0};
        for (int i = 0; i < DRAWS; i++) {
            if (!d.drawn[i].drawn) mark_wrong("nothing is drawn from a constant map");
            stat_add(&m, fmax(0, dot(d.drawn[i].s.w_local, sides[k])) / d.drawn[i].s.pdf);
        }
        mark_mean(&m, PI, MARK_ALPHA, "irradiance under a map of radiance 1", "What is drawn and what the density says "
                  "must be the same.");
    }
}

static void work(void)
{
    static const char what[] = "the load that is timed";
    const size_t n = mark_size(400000);
    double *u = mark_uniforms(4 * n, mark_seed(4), 0);
    drawing d = draw_from(map_random((int)mark_size(256), (int)mark_size(128), 3, 0.2, mark_seed(7)), &by_alias, u, n,
                          true);
    const size_t width = (size_t)d.em.width, height = (size_t)d.em.height;
    double *observed = mark_alloc(height, sizeof *observed), *expected = mark_alloc(height, sizeof *expected);
    size_t elsewhere = 0;

    check_density(&d);
    for (size_t k = 0; k < n; k++) {
        check_sample(&d, &d.drawn[k], what);
        observed[d.drawn[k].s.pixel / width]++;
        if (!(fabs(d.pdf[k] - d.drawn[k].s.pdf) <= 1e-9 * d.pdf[k])) elsewhere++;
    }
    for (size_t i = 0; i < d.n; i++) expected[i / width] += (double)n * d.pdf_pixel[i] * angle_of(&d, i);
    mark_fit(observed, expected, height, MARK_ALPHA, what, "A cell is a row.");
    /* rounding may carry a direction over the edge of its pixel */
    if (elsewhere > n / 1000) mark_wrong("%s: %zu of %zu directions have another density than was drawn by", what,
                                         elsewhere, n);
}

int main(int argc, char **argv)
{
    static const mark_claim claims[] = {
        {"a_pixel_of_each_row_has_its_solid_angle", 10, a_pixel_of_each_row_has_its_solid_angle},
        {"all_pixels_together_are_4_pi", 5, all_pixels_together_are_4_pi},
        {"directions_of_a_pixel_lie_in_it", 10, directions_of_a_pixel_lie_in_it},
        {"directions_are_uniform_in_solid_angle", 10, directions_are_uniform_in_solid_angle},
        {"a_direction_finds_its_pixel", 10, a_direction_finds_its_pixel},
        {"the_density_is_the_intensity_over_the_power", 10, the_density_is_the_intensity_over_the_power},
        {"directions_are_drawn_from_alias_tables", 10, directions_are_drawn_from_alias_tables},
        {"directions_are_drawn_from_cdfs", 5, directions_are_drawn_from_cdfs},
        {"irradiance_of_a_constant_map_is_pi_on_every_side", 10, irradiance_of_a_constant_map_is_pi_on_every_side},
    };

    return mark_main(argc, argv, claims, sizeof claims / sizeof *claims, work, 7.7);
}
