/* SPDX-License-Identifier: BSD-2-Clause */
/* efficiency: what makes an estimate less noisy leaves as much of the squared error as the table below says.
 *
 * A mistake that leaves every mean right is seen by no test of means. So each row of the table renders the same small
 * picture with a feature and without it, by pairs of renders. The variance of each value over the seeds, divided
 * by its mean squared, is summed over all values: that is the squared error, and no reference is needed. The claim is
 * the ratio of the two sums. Both renders of a pair have one seed, because shared chance then leaves the ratio.
 *
 * The jackknife over pairs tells the ratio's standard error. A row demands that the ratio lies within a third of the
 * effect (of 1 - claim) of the claim, and that the standard error is so small that chance alone leaves this range with
 * the probability of stat_level at most. The twin of each row is a half of the renders without the feature, beside the
 * other half: its ratio is near 1, and must be rejected.
 *
 * The claims were measured here with EFFICIENCY_PAIRS=4 in the environment, which takes four times as many pairs. */
#include "beyond/guide.h"
#include "bis/base/mem.h"
#include "bis/base/stats.h"
#include "bis/render/render.h"
#include "bis/thesis/phong.h"
#include "claim.h"
#include "file_help.h"
#include "lit.h"
#include "program.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define FOLDER "build/test_efficiency"

/* ---- a feature, and the same without it ---- */

/* What is left out of the guide of learned visibility. */
typedef enum missing { NOTHING, STEERED_CLUSTERS, STEERING, CONTROL, MORE_RAYS, CAP_OF_LAMP } missing;

typedef struct version {
    const char *options, *world; /* of pictures */
    missing lack;                /* of points, as the next four */
    uint32_t shadowrays, candidates;
    double edge;                 /* light from smaller x is hidden */
    bool lamp;                   /* there is one, and the squared error counts times the rays */
    bool even;                   /* of places in the unit square */
} version;

/* ---- the measure ---- */

/* value[n_seeds][n]: pictures, or what else has values. */
typedef struct series {
    double *value;
    size_t n_seeds, n;
} series;

typedef struct ratio {
    double value, se; /* of the squared errors; by the jackknife */
} ratio;

/* The sum over all values of their variance over the seeds, `left_out` left out (n_seeds: none), each divided by
 * scale. */
static double squared_error(const series *s, size_t left_out, const double *scale)
{
    const double k = (double)(s->n_seeds - (left_out < s->n_seeds));
    double total = 0;

    for (size_t i = 0; i < s->n; i++) {
        double sum = 0, squares = 0;
        for (size_t seed = 0; seed < s->n_seeds; seed++) {
            const double x = s->value[seed * s->n + i] - s->value[i]; /* a shift, so that squares do not cancel */
            if (seed != left_out) sum += x, squares += x * x;
        }
        total += (squares - sum * sum / k) / (k - 1) / scale[i];
    }
    return total;
}

/* As relMSE (docs/trust.md): m^2 + (mean of all m)^2/100, m the mean of both series. */
static double *scale_of(const series *a, const series *b)
{
    double *scale = bis_alloc(a->n, sizeof *scale), all = 0;

    for (size_t i = 0; i < a->n; i++) {
        for (size_t seed = 0; seed < a->n_seeds; seed++)
            scale[i] += (a->value[seed * a->n + i] + b->value[seed * a->n + i]) / 2 / (double)a->n_seeds;
        all += scale[i] / (double)a->n;
    }
    for (size_t i = 0; i < a->n; i++) scale[i] = scale[i] * scale[i] + all * all / 100;
    return scale;
}

static ratio ratio_of(const series *with, const series *without)
{
    const size_t k = with->n_seeds;
    double *scale = scale_of(with, without), mean = 0, square = 0;
    ratio r = {.value = squared_error(with, k, scale) / squared_error(without, k, scale)};

    for (size_t seed = 0; seed < k; seed++) {
        const double x = squared_error(with, seed, scale) / squared_error(without, seed, scale);
        mean += x / (double)k;
        square += x * x / (double)k;
    }
    r.se = sqrt((double)(k - 1) * fmax(0, square - mean * mean));
    bis_free(scale);
    return r;
}

/* ---- pictures ---- */

/* Two chessmen on a floor before the hall's map, or under the sun; `world` begins with the material. */
#define CAMERA "Scale -1 1 1 LookAt 0 -7.5 3.4  0 0 0.45  0 0 1 Camera \"perspective\" \"float fov\" 17\n"
#define MAP(name) "LightSource \"infinite\" \"string filename\" \"../../data/maps/" name ".hdr\" "
#define PIECE(name, x, y) \
    "AttributeBegin Translate " x " " y " 0 Shape \"plymesh\" \"string filename\" \"../../data/models/" name \
    ".ply\" AttributeEnd\n"
#define CHESS "Shape \"disk\" \"float radius\" 30\n" PIECE("pawn", "-0.55", "0") PIECE("rook", "0.55", "0.3")
#define DULL "Material \"diffuse\" \"rgb reflectance\" [0.7 0.7 0.7]\n"
#define PHONG(Kd, Ks, n) "Material \"phong\" \"float Kd\" " Kd " \"float Ks\" " Ks " \"float exponent\" " n "\n"
#define SIR(M, N) "Integrator \"sir\" \"integer candidates\" " M " \"integer shadowrays\" " N " "
#define ONE "Sampler \"stratified\" \"integer pixelsamples\" 1 \"bool jitter\" false\n"

typedef struct picture {
    bis_scene_desc *desc;
    bis_scene *scene;
} picture;

static picture open_picture(const char *options, const char *world)
{
    static char text[8192];
    picture p;
    bis_diag diag = {0};

    snprintf(text, sizeof text,
             "Film \"rgb\" \"integer xresolution\" 40 \"integer yresolution\" 30\n%s\n" CAMERA "WorldBegin %s", options,
             world);
    program_write_file(FOLDER "/scene.txt", text);
    if (bis_scene_parse(&p.desc, FOLDER "/scene.txt", &diag)) fail_msg("%s", text);
    assert_int_equal(bis_scene_build(&p.scene, p.desc, &diag), BIS_OK);
    bis_diag_clear(&diag);
    return p;
}

static void close_picture(picture *p)
{
    bis_scene_free(p->scene);
    bis_scene_desc_free(p->desc);
}

static series pictures_of(const version *v, size_t n_seeds, uint64_t first)
{
    static const double whole[4] = {0, 1, 0, 1};
    picture p = open_picture(v->options, v->world);
    series s = {.n_seeds = n_seeds};

    for (uint64_t seed = 0; seed < n_seeds; seed++) {
        bis_film film;
        bis_render_result result;
        bis_view view = p.desc->view;
        assert_int_equal(bis_film_init(&film, view.film.width, view.film.height, whole, (bis_loc){0}, NULL), BIS_OK);
        view.sampler.seed = first + seed;
        assert_int_equal(bis_render(&result, &film, p.scene, &view, &(bis_render_options){0}, NULL), BIS_OK);
        s.n = 3 * (size_t)film.width * (size_t)film.height;
        if (!s.value) s.value = bis_alloc(n_seeds * s.n, sizeof *s.value);
        for (size_t i = 0; i < s.n; i++) s.value[seed * s.n + i] = film.sum[i] / film.weight;
        bis_film_clear(&film);
    }
    close_picture(&p);
    return s;
}

/* ---- points whose light is hidden by chance ---- */

/* Light from x < edge is hidden: with 0 a half. Near the border V of a direction is a coin of its own, as in a cell of
 * a picture that a shadow's edge crosses. */
static double edge_of_light;

static bool hidden_by_chance(const bis_accel *a, const ray *r)
{
    uint32_t x, y;

    memcpy(&x, &r->d.x, sizeof x);
    memcpy(&y, &r->d.y, sizeof y);
    const double coin = (double)(bis_hash((uint64_t)x << 32 | y) >> 11) * 0x1p-53;
    return coin > 4 * ((double)r->d.x - edge_of_light) + 0.5;
}

static const bis_accel_ops coins = {.name = "coins", .occluded = hidden_by_chance};

static float even[2 * BIS_CLUSTERS + 64];
static bool (*honest_draw)(bis_guide *, bis_set *, uint32_t, const bis_point *, bis_stream *);

static bool draw_unsteered(bis_guide *guide, bis_set *x, uint32_t n, const bis_point *pt, bis_stream *stream)
{
    bis_product_guide *g = (bis_product_guide *)guide;
    float *const own = g->guess.own, *const of_square = g->guess.of_square;
    float bound[2 * BIS_CLUSTERS + 64];

    if (!bis_product_weigh(&g->product, g->clusters, &pt->bsdf)) return false;
    memcpy(bound, g->product.clusters.w, bis_lanes_round_up(g->clusters->n) * sizeof *bound);
    const double W = g->product.W;
    g->guess.own = g->guess.of_square = even;
    const bool drawn = honest_draw(guide, x, n, pt, stream);
    g->guess.own = own;
    g->guess.of_square = of_square;
    bis_guess_mix(&g->guess, bound, W, g->clusters->n); /* h of the weights is as it was */
    return drawn;
}

static bool has_none(const bis_guide *guide, const bis_set *x, const bis_point *pt)
{
    return false;
}

/* A candidate stands for itself alone. */
static bool draw_all_of_lamps(bis_guide *guide, bis_set *x, uint32_t n, const bis_point *pt, bis_stream *stream)
{
    void (*const weigh)(bis_guide *, bis_set *) = guide->weigh;

    guide->weigh = NULL;
    const bool drawn = honest_draw(guide, x, n, pt, stream);
    guide->weigh = weigh;
    for (uint32_t i = 0; i < n; i++) x->stands_for[i] = 1;
    return drawn;
}

static void take_away(bis_product_guide *g, missing lack)
{
    honest_draw = g->steps.draw;
    for (size_t k = 0; k < sizeof even / sizeof *even; k++) even[k] = 1;
    if (lack == STEERED_CLUSTERS) g->steps.draw = draw_unsteered;
    if (lack == CAP_OF_LAMP) g->steps.draw = draw_all_of_lamps;
    if (lack == CONTROL) g->steps.has_control = has_none;
    if (lack == MORE_RAYS) g->steps.rays = NULL;
    for (uint32_t k = 0; lack == STEERING && k < g->clusters->n; k++) g->guess.own[k] = g->guess.of_square[k] = 1;
}

/* An even sky, and at x = 0.6, where no point has it hidden, a pixel of 0.35 degrees that sends 2.7 times as much. */
static bis_light *new_lamp(void)
{
    enum { WIDTH = 1024, HEIGHT = 512 };
    const bis_light_desc desc = {
        .L = {1, 1, 1}, .scale = 1, .area_exponent = 0.15, .levels = 8, .to_world = bis_xform_identity()};
    bis_image image;
    bis_envmap em;
    bis_light *light;

    assert_int_equal(bis_image_init(&image, WIDTH, HEIGHT, NULL), BIS_OK);
    for (int i = 0; i < WIDTH * HEIGHT; i++) image.pixels[i] = grey(i == 105 * WIDTH ? 1.5e6 : 1);
    assert_int_equal(bis_envmap_from_latlong(&em, &image, NULL), BIS_OK);
    assert_int_equal(bis_light_from_envmap(&light, &em, &desc, BIS_NEED_TABLE | BIS_NEED_CURVE, NULL), BIS_OK);
    return light;
}

enum { POINTS = 40, LESSONS = 200, OF_A_FILL = 16 };

/* One estimate of each of several points, after LESSONS others have taught what is seen in a square, and as many what
 * is seen in a tile of it. */
static series points_of(const version *v, size_t n_seeds, uint64_t first)
{
    bis_settings s = bis_settings_default(&bis_sir);
    bis_light *light = v->lamp ? new_lamp() : lit_new_light(LIT_SPOTTY, 1, 0.15, false);
    uint64_t rays = 0;
    series all = {.value = bis_alloc(n_seeds * POINTS, sizeof *all.value), .n_seeds = n_seeds, .n = POINTS};
    bis_clusters c;
    bis_visibility seen;
    bis_product_guide guide;
    bis_scratch scratch;

    s.proposal = BIS_PROPOSAL_PRODUCT;
    s.candidates = v->candidates;
    s.shadowrays = v->shadowrays;
    s.learn = true;
    edge_of_light = v->edge;
    assert_int_equal(bis_clusters_init(&c, light, s.candidates, NULL), BIS_OK);
    for (size_t i = 0; i < POINTS; i++) {
        const vec3 n = normalize(vec3_from(cos(2.4 * (double)i), sin(2.4 * (double)i), 2));
        lit l;
        lit_init(&l, light, bis_phong(grey(0.8), grey(0), 1), n, 40, LIT_OPEN);
        l.accel.accel.ops = &coins;
        assert_int_equal(bis_visibility_init(&seen, 1, 1, 1, NULL), BIS_OK);
        seen.above[0] = 0;
        assert_int_equal(bis_product_guide_init(&guide, &c, &seen, NULL), BIS_OK);
        assert_int_equal(bis_scratch_init(&scratch, &s, NULL), BIS_OK);
        bis_scratch_share(&scratch, NULL, &guide.steps);
        bis_clusters_fill(&c, light, first, 0, 1);
        for (int place = 1; place >= 0; place--) { /* the square, then the tile in it */
            bis_product_guide_look(&guide, bis_visibility_first_cell(&seen, (size_t)place));
            for (uint64_t k = 0; k < LESSONS; k++) lit_once(&l, &s, &scratch, (uint64_t)place + 3, first + k);
            bis_visibility_learn(&seen, &place, 1, 1);
            if (place == 1) bis_visibility_close(&seen, 0, c.n);
        }
        bis_product_guide_look(&guide, 0);
        guide.steps.learns = false;
        take_away(&guide, v->lack);
        l.counters.shadow_rays = 0;
        for (uint64_t seed = 0; seed < n_seeds; seed++) {
            if (seed % OF_A_FILL == 0) bis_clusters_fill(&c, light, first, 1 + (uint32_t)seed, 1);
            all.value[seed * POINTS + i] = rgb_sum(lit_once(&l, &s, &scratch, 2, first + seed));
        }
        rays += l.counters.shadow_rays;
        bis_scratch_clear(&scratch);
        bis_product_guide_clear(&guide);
        bis_visibility_clear(&seen);
    }
    bis_clusters_clear(&c);
    bis_light_free(light);
    /* both renders of a pair have one scale, so the ratio is that of squared error times rays */
    for (size_t i = 0; v->lamp && i < n_seeds * POINTS; i++) all.value[i] *= sqrt((double)rays);
    return all;
}

/* ---- places in the unit square ---- */

/* A pixel that an edge crosses, beside which the radiance rises in proportion to the place, by two camera samples.
 * These mirror each other. Other dimensions of the same sampler are scrambled without mirroring. */
static series pixels_of(const version *v, size_t n_seeds, uint64_t first)
{
    enum { PIXELS = 400, SAMPLES = 2 };
    series s = {.value = bis_alloc(n_seeds * PIXELS, sizeof *s.value), .n_seeds = n_seeds, .n = PIXELS};

    for (uint64_t k = 0; k < n_seeds * PIXELS * SAMPLES; k++) {
        const uint64_t i = k / SAMPLES, pixel = i % PIXELS;
        const double angle = 2.4 * (double)pixel, offset = 0.6 * ((double)pixel / PIXELS - 0.5);
        bis_sampler sampler = {.kind = BIS_SAMPLER_SOBOL, .seed = first + i / PIXELS, .jitter = true};
        bis_stream stream;
        double u[1][2];
        bis_sampler_set_spp(&sampler, SAMPLES);
        bis_stream_init(&stream, &sampler, pixel, k % SAMPLES);
        if (v->even) bis_stream_camera(&stream, u[0]);
        else bis_stream_points(&stream, 5, 1, u);
        const double along = (u[0][0] - 0.5) * cos(angle) + (u[0][1] - 0.5) * sin(angle);
        s.value[i] += (along > offset ? 1 + along : 0.2) / SAMPLES;
    }
    return s;
}

/* The share of 16 points in a band along the diagonal, where Sobol's two dimensions must not be scrambled alike: with
 * one key for both the squared error is that of random points. */
static series bands_of(const version *v, size_t n_seeds, uint64_t first)
{
    enum { BANDS = 400, SET = 16 };
    series s = {.value = bis_alloc(n_seeds * BANDS, sizeof *s.value), .n_seeds = n_seeds, .n = BANDS};

    for (uint64_t i = 0; i < n_seeds * BANDS; i++) {
        bis_sampler sampler = {.kind = v->even ? BIS_SAMPLER_SOBOL : BIS_SAMPLER_RANDOM, .seed = first + i / BANDS};
        bis_stream stream;
        double u[SET][2];
        bis_sampler_set_spp(&sampler, 1);
        bis_stream_init(&stream, &sampler, i % BANDS, 0);
        bis_stream_points(&stream, 0, SET, u);
        for (int k = 0; k < SET; k++) s.value[i] += (fabs(u[k][0] - u[k][1]) < 0.1) / (double)SET;
    }
    return s;
}

/* ---- the claims ---- */

#define HALL(material) MAP("interior") material CHESS
#define SOBOL "Sampler \"sobol\" \"integer pixelsamples\" 1\n"
#define RANDOM "Sampler \"random\" \"integer pixelsamples\" 1\n"
#define EIGHT "Sampler \"stratified\" \"integer pixelsamples\" 8 \"bool jitter\" false\n"
#define TWO "Sampler \"stratified\" \"integer pixelsamples\" 2 "
#define OUTLINES "\"integer edgesamples\" 8 \"float edgelight\" 0.25 "
#define EM "Integrator \"em\" "
#define MIS "Integrator \"mis\" "
#define PRODUCT(M, N) SIR(M, N) "\"string proposal\" \"product\" "
#define LEARN PRODUCT("64", "24") "\"bool learn\" true "
#define MULTINOMIAL "\"string resampling\" \"multinomial\" "
#define LOOSE "\"bool stratify\" false "
#define SHINY(n) PHONG("0", "0.9", n)
#define HALF_SHINY(n) PHONG("0.5", "0.5", n)
#define PICTURE(o, w) {.options = o, .world = w}
#define COUNTS(N, M) .shadowrays = N, .candidates = M

typedef struct claim {
    const char *name; /* the feature */
    double leaves;    /* of the squared error without it */
    size_t pairs;
    series (*make)(const version *v, size_t n_seeds, uint64_t first); /* value: the caller frees it by bis_free */
    version with, without;
} claim;

static const claim claims[] = {
    {"sir 15/800, dull: strata and equally spaced marks", 0.71, 16, pictures_of,
     PICTURE(ONE SIR("800", "15"), HALL(DULL)),
     PICTURE(ONE SIR("800", "15") LOOSE MULTINOMIAL, HALL(DULL))},
    {"sir 15/800, dull: strata", 0.72, 24, pictures_of, PICTURE(ONE SIR("800", "15"), HALL(DULL)),
     PICTURE(ONE SIR("800", "15") LOOSE, HALL(DULL))},
    {"sir 15/800, dull: equally spaced marks", 0.75, 16, pictures_of, PICTURE(ONE SIR("800", "15"), HALL(DULL)),
     PICTURE(ONE SIR("800", "15") MULTINOMIAL, HALL(DULL))},
    {"em, dull: strata along the curve", 0.64, 24, pictures_of, PICTURE(ONE EM "\"bool stratify\" true", HALL(DULL)),
     PICTURE(ONE EM, HALL(DULL))},
    {"em, dull: Sobol's points", 0.44, 24, pictures_of, PICTURE(SOBOL EM, HALL(DULL)), PICTURE(RANDOM EM, HALL(DULL))},
    {"em with Sobol's points, dull: CDFs", 0.83, 64, pictures_of,
     PICTURE(SOBOL EM, MAP("interior") "\"string sampler\" \"cdf\" " DULL CHESS),
     PICTURE(SOBOL EM, MAP("interior") "\"string sampler\" \"alias\" " DULL CHESS)},
    {"mis, half dull, n = 50: strata and compensation", 0.40, 24, pictures_of,
     PICTURE(ONE MIS "\"bool stratify\" true \"bool compensate\" true", HALL(HALF_SHINY("50"))),
     PICTURE(ONE MIS, HALL(HALF_SHINY("50")))},
    {"sir 15/64, n = 50: candidates from the product", 0.18, 16, pictures_of,
     PICTURE(ONE PRODUCT("64", "15"), HALL(SHINY("50"))), PICTURE(ONE SIR("64", "15"), HALL(SHINY("50")))},
    {"sir with the product, n = 2000: 24/128", 0.68, 64, pictures_of,
     PICTURE(ONE PRODUCT("128", "24"), HALL(SHINY("2000"))), PICTURE(ONE PRODUCT("64", "24"), HALL(SHINY("2000")))},
    {"sir with the product, dull: 24 shadow rays for 16", 0.65, 16, pictures_of,
     PICTURE(ONE PRODUCT("64", "24"), HALL(DULL)), PICTURE(ONE PRODUCT("64", "16"), HALL(DULL))},
    {"sir 24/64 with the product, dull, 8 passes: learn", 0.48, 12, pictures_of, PICTURE(EIGHT LEARN, HALL(DULL)),
     PICTURE(EIGHT PRODUCT("64", "24"), HALL(DULL))},
    {"points, half of the light hidden, 4/8: h in the choice of clusters", 0.11, 400, points_of,
     {COUNTS(4, 8)}, {COUNTS(4, 8), .lack = STEERED_CLUSTERS}},
    {"points, half of the light hidden, 4/8: h", 0.11, 400, points_of,
     {COUNTS(4, 8)}, {COUNTS(4, 8), .lack = STEERING}},
    {"points, half of the light hidden, 4/8: control variate", 0.87, 4000, points_of,
     {COUNTS(4, 8)}, {COUNTS(4, 8), .lack = CONTROL}},
    {"points, most of the light hidden, 4/64: rays by what is known", 0.34, 800, points_of,
     {COUNTS(4, 64), .edge = 0.3}, {COUNTS(4, 64), .edge = 0.3, .lack = MORE_RAYS}},
    {"points under a lamp, 24/64, squared error times rays: 4 rays to a lamp", 0.76, 600, points_of,
     {COUNTS(24, 64), .lamp = true}, {COUNTS(24, 64), .lamp = true, .lack = CAP_OF_LAMP}},
    {"2 passes, dull: 8 samples of a quarter on outlines", 0.70, 24, pictures_of,
     PICTURE(TWO OUTLINES LEARN, HALL(DULL)),
     PICTURE(TWO LEARN, HALL(DULL))},
    {"2 passes, n = 50: 8 samples on outlines, 4 where the lobe turns", 0.19, 24, pictures_of,
     PICTURE(TWO OUTLINES LEARN, HALL(SHINY("50"))), PICTURE(TWO LEARN, HALL(SHINY("50")))},
    {"a pixel with an edge and a slope: 2 mirrored camera samples", 0.84, 100, pixels_of,
     {.even = true}, {.even = false}},
    {"a band along the diagonal: 16 points of Sobol", 0.57, 100, bands_of, {.even = true}, {.even = false}},
};
enum { N_CLAIMS = sizeof claims / sizeof *claims };

static double alpha(void) { return stat_level(1e-3, N_CLAIMS); }

static bool holds(double said, double left) { return fabs(left - said) <= (1 - said) / 3; }

/* Rejects also what is known too badly: chance would leave the range, by Student's t. */
static void judge(const claim *c, size_t pairs)
{
    const double said = c->leaves;
    const series with = c->make(&c->with, pairs, 1), without = c->make(&c->without, pairs, 1);
    const ratio r = ratio_of(&with, &without);
    const size_t half = pairs / 2;
    const series first = {without.value, half, without.n}, second = {without.value + half * without.n, half, without.n};
    const double twin = ratio_of(&first, &second).value;
    const double p = bis_stats_student_p((1 - said) / 3 / r.se, (double)(pairs - 1));

    bis_free(with.value);
    bis_free(without.value);
    stat_judges(1);
    print_message("  %-70s %.3f +- %.3f, said %.2f; twin %.2f\n", c->name, r.value, r.se, said, twin);
    if (!(p < alpha())) fail_msg("%s: %zu pairs are too few, p %g", c->name, pairs, p);
    if (!holds(said, r.value)) fail_msg("%s leaves %g of the squared error, not %g", c->name, r.value, said);
    if (holds(said, twin)) fail_msg("%s: the render without it passes with %g, too", c->name, twin);
}

static void each_feature_leaves_as_much_of_the_squared_error_as_is_said(void **state)
{
    const char *more = getenv("EFFICIENCY_PAIRS");

    program_folder(FOLDER);
    for (size_t k = 0; k < N_CLAIMS; k++) judge(&claims[k], claims[k].pairs * (size_t)(more ? atoi(more) : 1));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_feature_leaves_as_much_of_the_squared_error_as_is_said),
    };
    return cmocka_run_group_tests_name("efficiency", tests, NULL, NULL);
}
