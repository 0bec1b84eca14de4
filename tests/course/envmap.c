/* Assignment envmap: src/thesis/envmap.c, src/thesis/importance.c, src/thesis/importance_table.c: solid angles, directions, pixels, and a draw in two
 * passes. Expected values by closed forms and by lat-long geometry in long double. Statistical tests: 6. */
#include "mark.h"

#include "bis/thesis/importance.h"
#include "bis/thesis/regions.h"
#include "bis/base/mem.h"
#include "bis/thesis/rng.h"

#include "map_help.h"

static void a_pixel_of_each_row_has_its_solid_angle(void)
{
    const int sizes[][2] = {{8, 4}, {1, 1}, {7, 5}, {(int)mark_size(64), (int)mark_size(32)}, {16, (int)mark_size(4000)}};

    for (int k = 0; k < 5; k++) {
        const int width = sizes[k][0], height = sizes[k][1];
        bis_envmap em = map_new(width, height);
        for (int y = 0; y < height; y++) {
            const long double pi = 3.14159265358979323846264338327950288L;
            const long double expected = 2 * pi / width * 2 * sinl(pi * (2 * y + 1) / (2.0L * height)) * sinl(pi / (2.0L * height));
            mark_near(em.row_solid_angle[y], (double)expected, 0, 1e-6, "the solid angle of a pixel in row %d of a "
                      "%d x %d map", y, width, height);
            mark_near(em.cos_edge[y], (double)cosl(pi * y / height), 1e-12, 0, "cos_edge[%d] of a %d x %d map", y, width, height);
        }
        mark_near(em.cos_edge[height], -1, 1e-12, 0, "cos_edge[%d] of a %d x %d map", height, width, height);
        bis_envmap_clear(&em);
    }
}

static void all_pixels_together_are_4_pi(void)
{
    const int sizes[][2] = {{8, 4}, {5, 3}, {64, 32}, {4, 2048}};

    for (int k = 0; k < 4; k++) {
        bis_envmap em = map_new(sizes[k][0], sizes[k][1]);
        double sum = 0;
        for (int y = 0; y < em.height; y++) sum += em.width * em.row_solid_angle[y];
        mark_near(sum, 4 * PI, 0, 1e-9, "the solid angle of the whole sphere");
        bis_envmap_clear(&em);
    }
}

static void directions_of_a_pixel_lie_in_it(void)
{
    bis_envmap em = map_new(8, 6);

    for (int y = 0; y < 6; y++) {
        for (int k = 0; k < 8 * 64; k++) {
            const int x = k / 64;
            const double u1 = (k % 8 + 0.5) / 8, u2 = (k / 8 % 8 + 0.5) / 8;
            const vec3 w = bis_envmap_direction(&em, x, y, u1, u2);
            if (!(fabs(length(w) - 1) < 1e-6)) {
                mark_wrong("the direction of pixel (%d, %d) has length %g, must be 1", x, y, length(w));
            }
            const double theta = acos((double)w.z), phi = atan2((double)w.y, (double)w.x), turn = phi < 0 ? phi + 2 * PI : phi;
            if ((int)(theta / PI * 6) != y) {
                mark_wrong("a direction of pixel (%d, %d) has theta = %.4f, in row %d. Row 0 is at +z", x, y, theta,
                           (int)(theta / PI * 6));
            }
            if ((int)(turn / (2 * PI) * 8) != x) {
                mark_wrong("a direction of pixel (%d, %d) has phi = %.4f, in column %d", x, y, turn,
                           (int)(turn / (2 * PI) * 8));
            }
        }
    }
    bis_envmap_clear(&em);
}

/* cos theta of a direction uniform in solid angle is uniform between the edges of the row: at u2 = 1/2, in the middle. */
static void directions_are_uniform_in_solid_angle(void)
{
    bis_envmap em = map_new(8, 4);

    for (int y = 0; y < 4; y++) {
        for (int k = 0; k < 4; k++) {
            const double u2 = (k + 0.5) / 4, c0 = cos(PI * y / 4), c1 = cos(PI * (y + 1) / 4);
            const vec3 w = bis_envmap_direction(&em, 3, y, 0.5, u2);
            mark_near((double)w.z, c0 + u2 * (c1 - c0), 1e-6, 0, "row %d of 4, u2 = %g: cos theta", y, u2);
            for (int x = 0; x < 8; x++) {
                const double u1 = (k + 0.25) / 4, phi = 2 * PI * (x + u1) / 8;
                const vec3 at = bis_envmap_direction(&em, x, y, u1, u2);
                mark_near((double)at.x * cos(phi) + (double)at.y * sin(phi), hypot((double)at.x, (double)at.y), 1e-6, 0, "pixel (%d, %d), u1 = %g: how "
                          "far the direction lies along the phi of 2 pi (x + u1)/W, which", x, y, u1);
            }
        }
    }
    bis_envmap_clear(&em);
}

static void a_direction_finds_its_pixel(void)
{
    bis_envmap em = map_new(10, 7);
    bis_rng r;

    bis_rng_init(&r, mark_seed(1), 0, 0, 0);
    for (int k = 0; k < 20000; k++) {
        const double theta = PI * bis_rng_double(&r), phi = 2 * PI * bis_rng_double(&r);
        const int y = (int)(theta / PI * 7), x = (int)(phi / (2 * PI) * 10);
        const double from_edge = fmin(fabs(remainder(theta / PI * 7, 1)), fabs(remainder(phi / (2 * PI) * 10, 1)));
        const size_t pixel = bis_envmap_pixel(&em, vec3_from(sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta)));
        if (from_edge < 1e-4 || sin(theta) < 1e-3) continue; /* rounding to float may carry it over */
        if (pixel != (size_t)(y * 10 + x)) {
            mark_wrong("theta = %.4f, phi = %.4f of a 10 x 7 map: pixel (%zu, %zu), must be (%d, %d)", theta, phi,
                       pixel % 10, pixel / 10, x, y);
        }
    }
    const vec3 ends[] = {{0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {1, -0.0f, 0}, {1, -1e-20f, 0}, {-1, 0, 0}, {-1, -1e-20f, 0}};
    const struct { vec3 w; int x, y; } known[] = { /* x: -1 where any will do */
        {{0, 0, 1}, -1, 0}, {{0, 0, -1}, -1, 6}, {{1, 1e-3f, 0}, 0, 3}, {{1, -1e-3f, 0}, 9, 3}, {{-1, 1e-3f, 0}, 4, 3}, {{-1, -1e-3f, 0}, 5, 3},
        {{1e-3f, 1e-5f, 1}, 0, 0}, {{1e-3f, -1e-5f, -1}, 9, 6}};
    for (size_t k = 0; k < sizeof known / sizeof *known; k++) {
        const vec3 w = normalize(known[k].w);
        const size_t pixel = bis_envmap_pixel(&em, w), x = pixel % 10, y = pixel / 10;
        if (y != (size_t)known[k].y || (known[k].x >= 0 && x != (size_t)known[k].x)) {
            mark_wrong("direction (%g %g %g) of a 10 x 7 map: pixel (%zu, %zu), must be (%d, %d) (-1: any)", (double)w.x, (double)w.y, (double)w.z, x, y,
                       known[k].x, known[k].y);
        }
    }
    for (size_t k = 0; k < sizeof ends / sizeof *ends; k++) {
        const size_t pixel = bis_envmap_pixel(&em, ends[k]);
        if (pixel >= 70) {
            mark_wrong("direction (%g %g %g): pixel %zu of 70. The south pole and the seam want care",
                       (double)ends[k].x, (double)ends[k].y, (double)ends[k].z, pixel);
        }
    }
    bis_envmap_clear(&em);
}

static bis_importance *importance_of(const bis_envmap *em, bis_table_kind kind)
{
    bis_importance *im;
    const bis_importance_options options = {.table = true, .table_kind = kind, .levels = 8};

    if (bis_importance_new(&im, em, &options, NULL)) mark_wrong("no memory for the importance");
    return im;
}

/* Not I, but the w of bis_weight: with area weighting it has a factor for each region. */
static void check_weighted_density(void)
{
    const bis_importance_options options = {.table = true, .table_kind = BIS_TABLE_ALIAS, .levels = 8, .area_exponent = 0.5};
    bis_envmap em = map_random(128, 64, 3, 0.5, mark_seed(8)); /* so fine that regions have less than BIS_AREA_CLAMP */
    bis_importance *im;
    bis_regions regions;
    double total = 0;

    if (bis_importance_new(&im, &em, &options, NULL) || bis_regions_init(&regions, &em, 8, NULL)) mark_wrong("no memory");
    for (int pass = 0; pass < 2; pass++) {
        for (size_t i = 0; i < map_n(&em); i++) {
            const double intensity = map_intensity(&em, i);
            const double w = intensity > 0 ? intensity * bis_area_factor(regions.solid_angle[regions.label[i]], 0.5) : 0;
            if (pass == 0) total += w * map_solid_angle(&em, i);
            else mark_near(bis_importance_pdf_pixel(im, i), w / total, 0, 1e-5, "with area weighting: the density of pixel (%zu, %zu)", i % 128, i / 128);
        }
    }
    bis_regions_clear(&regions);
    bis_importance_free(im);
    bis_envmap_clear(&em);
}

static void the_density_is_the_intensity_over_the_power(void)
{
    bis_envmap em = map_random(16, 8, 3, 0.2, mark_seed(5));
    bis_importance *im = importance_of(&em, BIS_TABLE_ALIAS);
    double power = 0, sum = 0;

    for (size_t i = 0; i < map_n(&em); i++) power += map_intensity(&em, i) * map_solid_angle(&em, i);
    for (size_t i = 0; i < map_n(&em); i++) {
        const double pdf = bis_importance_pdf_pixel(im, i);
        mark_near(pdf, map_intensity(&em, i) / power, 0, 1e-6, "the density per steradian of pixel (%zu, %zu), "
                  "whose intensity is %.4g,", i % 16, i / 16, map_intensity(&em, i));
        sum += pdf * map_solid_angle(&em, i);
    }
    mark_near(sum, 1, 1e-6, 0, "the integral of the density over the sphere");
    bis_importance_free(im);
    bis_envmap_clear(&em);
    check_weighted_density();
}

/* Of a table: the pixels, and with `inside` quarters of each. */
static void draw(bis_table_kind kind, const char *what)
{
    enum { W = 8, H = 4, CELLS = W * H * 4, DRAWS = 200000 };
    bis_envmap em = map_random(W, H, 2, 0.2, mark_seed(6));
    bis_importance *im = importance_of(&em, kind);
    double observed[CELLS] = {0}, expected[CELLS], power = 0;
    bis_rng r;

    bis_rng_init(&r, mark_seed(2), 0, 0, 0);
    for (int k = 0; k < DRAWS; k++) {
        const double u[4] = {bis_rng_double(&r), bis_rng_double(&r), bis_rng_double(&r), bis_rng_double(&r)};
        bis_map_sample s;
        if (!bis_importance_sample(im, u, &s)) mark_wrong("%s: nothing is drawn from a map that has light", what);
        if (s.pixel >= W * H) mark_wrong("%s: pixel %zu of %d", what, s.pixel, W * H);
        const double phi = atan2((double)s.w_local.y, (double)s.w_local.x), x = (phi < 0 ? phi / (2 * PI) + 1 : phi / (2 * PI)) * W;
        const size_t row = s.pixel / W;
        const double c0 = cos(PI * (double)row / H), c1 = cos(PI * (double)(row + 1) / H), down = (c0 - (double)s.w_local.z) / (c0 - c1);
        const bool inside = down > -1e-5 && down < 1 + 1e-5 && x > (double)(s.pixel % W) - 1e-5 && x < (double)(s.pixel % W) + 1 + 1e-5;
        if (!inside && s.pixel % W != W - 1 && s.pixel % W != 0) {
            mark_wrong("%s: the direction drawn does not lie in the pixel that is told, %zu", what, s.pixel);
        }
        if (fabs(s.pdf - bis_importance_pdf_pixel(im, s.pixel)) > 1e-9 * s.pdf) {
            mark_wrong("%s: the sample's density is %g, its pixel's %g", what, s.pdf,
                       bis_importance_pdf_pixel(im, s.pixel));
        }
        observed[4 * s.pixel + (down > 0.5 ? 2u : 0u) + (x - floor(x) > 0.5 ? 1u : 0u)]++;
    }
    for (size_t i = 0; i < W * H; i++) power += map_intensity(&em, i) * map_solid_angle(&em, i);
    for (size_t i = 0; i < CELLS; i++) expected[i] = DRAWS * map_intensity(&em, i / 4) * map_solid_angle(&em, i / 4) / power / 4;
    mark_fit(observed, expected, CELLS, MARK_ALPHA, what, "Cell c is a quarter of pixel c/4. Rows by their sum, then a "
             "pixel of the row, then a place in it.");
    bis_importance_free(im);
    bis_envmap_clear(&em);
}

/* Which of the four numbers may matter: the place has u[2] and u[3] with alias tables; u[0] and u[1] alone do it all with CDFs. */
static void check_numbers(bis_table_kind kind, const char *what)
{
    bis_envmap em = map_random(8, 4, 2, 0.2, mark_seed(9));
    bis_importance *im = importance_of(&em, kind);
    bis_rng r;

    bis_rng_init(&r, mark_seed(5), 0, 0, 0);
    for (int k = 0; k < 1000; k++) {
        const double u0 = bis_rng_double(&r), u1 = bis_rng_double(&r);
        bis_map_sample a, b;
        if (!bis_importance_sample(im, (double[]){u0, u1, 0.1, 0.2}, &a) || !bis_importance_sample(im, (double[]){u0, u1, 0.8, 0.9}, &b)) {
            mark_wrong("%s: nothing is drawn from a map that has light", what);
        }
        const double turn = fabs((double)a.w_local.x - (double)b.w_local.x) + fabs((double)a.w_local.y - (double)b.w_local.y);
        if (a.pixel != b.pixel) mark_wrong("%s: u[2] and u[3] change the pixel; it is u[0]'s row and u[1]'s pixel of it", what);
        if (kind == BIS_TABLE_CDF && (turn != 0 || a.w_local.z != b.w_local.z)) {
            mark_wrong("%s: u[2] and u[3] change the direction; its place in the pixel is told by the two remainders", what);
        }
        if (kind == BIS_TABLE_CDF) {
            if (!bis_importance_sample(im, (double[]){u0, bis_rng_double(&r), 0, 0}, &b)) mark_wrong("%s: nothing is drawn", what);
            if (a.w_local.z != b.w_local.z) mark_wrong("%s: u[1] changes theta; the row and the place in it, vertically, are u[0]'s and its remainder's", what);
        }
        if (kind == BIS_TABLE_ALIAS && (turn == 0 || a.w_local.z == b.w_local.z)) mark_wrong("%s: u[2] and u[3] do not move the place in the pixel", what);
    }
    bis_importance_free(im);
    bis_envmap_clear(&em);
}

static void directions_are_drawn_from_alias_tables(void)
{
    draw(BIS_TABLE_ALIAS, "alias tables");
    check_numbers(BIS_TABLE_ALIAS, "alias tables");
}

static void directions_are_drawn_from_cdfs(void)
{
    draw(BIS_TABLE_CDF, "CDFs");
    check_numbers(BIS_TABLE_CDF, "CDFs");
}

static void irradiance_of_a_constant_map_is_pi_on_every_side(void)
{
    const vec3 sides[] = {{0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {0, -1, 0}};
    bis_envmap em = map_new(16, 8);

    for (size_t i = 0; i < map_n(&em); i++) em.pixels[i] = (rgb){1, 1, 1};
    bis_importance *im = importance_of(&em, BIS_TABLE_ALIAS);
    for (int k = 0; k < 4; k++) {
        stat_moments m = {0};
        bis_rng r;
        bis_rng_init(&r, mark_seed(3), (uint64_t)k, 0, 0);
        for (int i = 0; i < 40000; i++) {
            const double u[4] = {bis_rng_double(&r), bis_rng_double(&r), bis_rng_double(&r), bis_rng_double(&r)};
            bis_map_sample s = {.pdf = 0};
            if (!bis_importance_sample(im, u, &s)) mark_wrong("nothing is drawn from a constant map");
            stat_add(&m, fmax(0, dot(s.w_local, sides[k])) / s.pdf);
        }
        mark_mean(&m, PI, MARK_ALPHA, "irradiance under a map of radiance 1", "What is drawn and what the density says "
                  "must be the same.");
    }
    bis_importance_free(im);
    bis_envmap_clear(&em);
}

static void work(void)
{
    bis_envmap em = map_random(256, 128, 3, 0.2, mark_seed(7));
    bis_importance *im = importance_of(&em, BIS_TABLE_ALIAS);
    double sum = 0;
    bis_rng r;

    bis_rng_init(&r, mark_seed(4), 0, 0, 0);
    for (int k = 0; k < 400000; k++) {
        const double u[4] = {bis_rng_double(&r), bis_rng_double(&r), bis_rng_double(&r), bis_rng_double(&r)};
        bis_map_sample s = {.pdf = 0};
        bis_importance_sample(im, u, &s);
        sum += bis_importance_pdf(im, s.w_local);
    }
    if (sum == 0) mark_wrong("all densities are 0");
    bis_importance_free(im);
    bis_envmap_clear(&em);
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

    return mark_main(argc, argv, claims, sizeof claims / sizeof *claims, work);
}
