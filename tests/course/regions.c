/* SPDX-License-Identifier: BSD-2-Clause */
/* Assignment regions: src/thesis/regions.c, levels and the breadth-first search. Expected values by hand. */
#include "mark.h"

#include "bis/thesis/regions.h"

#include "bis/thesis/rng.h"

#include "map_help.h"

/* The student's regions of a map. A label may be any number. */
static bis_regions regions_of(const bis_envmap *em, int levels)
{
    const ask_map m = {.width = em->width, .height = em->height, .levels = levels};
    const size_t n = map_n(em);
    bis_regions r = {.label = mark_alloc(n, sizeof *r.label), .solid_angle = mark_alloc(n, sizeof *r.solid_angle)};

    ASK(ASK_REGIONS, GIVE(&m, 1), GIVE(em->pixels, n), TAKE(&r.n, 1), TAKE(r.label, n), TAKE(r.solid_angle, n));
    return r;
}

/* The student's levels of intensity[n], each by the levels l[n]. */
static void levels_of(uint8_t *level, const bis_levels *l, const double *intensity, size_t n)
{
    ASK(ASK_LEVELS, GIVE(l, n), GIVE(intensity, n), TAKE(level, n));
}

/* A map from a drawing: '.' black, '1' to '9' radiances a factor of 10 apart. */
static bis_envmap drawn(int width, int height, const char *rows)
{
    bis_envmap em = map_new(width, height);

    for (int i = 0; i < width * height; i++) {
        if (rows[i] != '.') em.pixels[i] = rgb_from(0, pow(10, rows[i] - '1'), 0);
    }
    return em;
}

static void expect_labels(int width, int height, const char *rows, const uint32_t *labels, const char *what)
{
    bis_envmap em = drawn(width, height, rows);
    bis_regions r = regions_of(&em, 16);
    uint32_t n = 0;

    for (int i = 0; i < width * height; i++) {
        const uint32_t must = labels[i];
        if (must != BIS_REGION_NONE && must + 1 > n) n = must + 1;
        if (r.label[i] == must) continue;
        if (r.label[i] == BIS_REGION_NONE) {
            mark_wrong("%s: pixel (%d, %d) has no label, must be in region %u", what, i % width, i / width, must);
        }
        if (must == BIS_REGION_NONE) {
            mark_wrong("%s: pixel (%d, %d) is black, but in region %u", what, i % width, i / width, r.label[i]);
        }
        mark_wrong("%s: pixel (%d, %d) is in region %u, must be in %u", what, i % width, i / width, r.label[i], must);
    }
    if (r.n != n) mark_wrong("%s: %u regions, must be %u", what, r.n, n);
}

/* Pixels of one letter are one region, and those of two are two. What has no letter is dim, not black, and of no
 * interest, so that a mistake with black, or with the numbers of regions, costs other claims. */
static void expect(int width, int height, const char *rows, const char *letters, const char *what)
{
    bis_envmap em = drawn(width, height, rows);
    for (int i = 0; i < width * height; i++) {
        if (rows[i] == '.') em.pixels[i] = rgb_from(0, 0.1, 0);
    }
    bis_regions r = regions_of(&em, 16);

    for (int i = 0; i < width * height; i++) {
        if (letters[i] == '.') continue;
        if (r.label[i] == BIS_REGION_NONE)
            mark_wrong("%s: pixel (%d, %d) has no label", what, i % width, i / width);
        for (int k = 0; k < i; k++) {
            if (letters[k] == '.' || (letters[k] == letters[i]) == (r.label[k] == r.label[i])) continue;
            mark_wrong("%s: pixels (%d, %d) and (%d, %d) are %s", what, k % width, k / width, i % width,
                       i / width, letters[k] == letters[i] ? "in two regions, must be in one" :
                       "in one region, must be in two");
        }
    }
}

/* Any least and largest intensity, any number of levels; away from the edges of a level, where rounding decides. */
static void check_random_levels(void)
{
    enum { N = 2000 };
    bis_levels *l = mark_alloc(2 * N, sizeof *l);
    double *intensity = mark_alloc(2 * N, sizeof *intensity), *most = mark_alloc(N, sizeof *most),
        *exact = mark_alloc(N, sizeof *exact);
    uint8_t *level = mark_alloc(2 * N, sizeof *level);
    bis_rng r;

    bis_rng_init(&r, mark_seed(1), 0, 0, 0);
    for (int k = 0; k < N; k++) {
        const int n = 1 + (int)bis_rng_below(&r, 200);
        const double least = (double)(float)pow(10, 6 * bis_rng_double(&r) - 3);
        most[k] = (double)(float)(least * pow(10, 0.1 + 6 * bis_rng_double(&r)));
        bis_envmap em = map_new(2, 1);
        em.pixels[0].g = (float)least;
        em.pixels[1].g = (float)most[k];
        const double at = bis_rng_double(&r);
        l[2 * k] = l[2 * k + 1] = bis_levels_of(&em, n);
        intensity[2 * k] = least * pow(most[k] / least, at);
        intensity[2 * k + 1] = least;
        exact[k] = n * at;
    }
    levels_of(level, l, intensity, 2 * N);
    for (int k = 0; k < N; k++) {
        const int n = l[2 * k].n;
        if (fabs(exact[k] - round(exact[k])) > 1e-6 && level[2 * k] != (int)exact[k]) {
            mark_wrong("%d levels from %g to %g: intensity %g has level %d, must be %d", n, intensity[2 * k + 1],
                       most[k], intensity[2 * k],
                       level[2 * k], (int)exact[k]);
        }
        if (level[2 * k + 1] != 0) {
            mark_wrong("%d levels from %g to %g: the least intensity has level %d, must be 0", n,
                       intensity[2 * k + 1], most[k], level[2 * k + 1]);
        }
    }
}

/* Two lit pixels of these intensities, and 8 levels. */
static bis_levels eight_levels(float least, float most)
{
    bis_envmap em = map_new(4, 2);

    em.pixels[0].g = least;
    em.pixels[1].g = most;
    const bis_levels l = bis_levels_of(&em, 8);
    return l;
}

static void levels_are_equal_steps_of_the_logarithm(void)
{
    enum { N = 24 };
    bis_levels l[N];
    double at[N];
    uint8_t level[N];

    for (int k = 0; k < N; k++) {
        l[k] = eight_levels(1, 65536);
        at[k] = pow(4, k / 3) * (k % 3 == 0 ? 1.001 : k % 3 == 1 ? 2 : 3.999);
    }
    levels_of(level, l, at, N);
    for (int k = 0; k < N; k++) {
        if (level[k] != k / 3) {
            mark_wrong("8 levels from 1 to 65536, a factor of 4 each: intensity %g has level %d, must be %d", at[k],
                       level[k], k / 3);
        }
    }
    check_random_levels();
}

static void darkest_brightest_black_and_constant_have_their_levels(void)
{
    const bis_levels l[] = {eight_levels(1, 65536), eight_levels(1, 65536), eight_levels(3, 3)};
    const double at[] = {65536, 0, 3};
    uint8_t level[3];

    levels_of(level, l, at, 3);
    if (level[0] != 7) {
        mark_wrong("the brightest pixel of 8 levels has level %d, must be 7: it stands on the last bin's upper edge",
                   level[0]);
    }
    if (level[1] != BIS_LEVEL_NONE) {
        mark_wrong("intensity 0 has level %d, must be BIS_LEVEL_NONE: it has no logarithm", level[1]);
    }
    if (level[2] != 0) mark_wrong("a map of one intensity: level %d, must be 0", level[2]);
}

/* The first pixel of a region, by way of pixels that were found to be in it. */
static size_t first_of(size_t *first, size_t i)
{
    while (first[i] != i)
        i = first[i] = first[first[i]];
    return i;
}

/* Random pixels of two levels between black edges, so that neither poles nor seam matter, against disjoint sets: a
 * pixel joins its left and its upper neighbour's. Regions are numbered in the order of their first pixels. */
static void check_random_map(size_t width, size_t height, uint64_t seed)
{
    const size_t n = width * height;
    char *rows = mark_alloc(n + 1, 1);
    uint32_t *labels = mark_alloc(n, sizeof *labels), next = 0;
    size_t *first = mark_alloc(n, sizeof *first);
    bis_rng r;

    bis_rng_init(&r, mark_seed(seed), 0, 0, 0);
    for (size_t i = 0; i < n; i++) {
        const bool edge = i < width || i >= n - width || i % width == 0 || i % width == width - 1;
        rows[i] = edge ? '.' : ".1199"[bis_rng_below(&r, 5)];
        first[i] = i;
        for (int k = 0; !edge && k < 2; k++) {
            const size_t near = k ? i - width : i - 1;
            if (rows[near] != rows[i]) continue;
            const size_t a = first_of(first, near), b = first_of(first, i);
            first[a > b ? a : b] = a < b ? a : b;
        }
    }
    for (size_t i = 0; i < n; i++) {
        const size_t its = first_of(first, i);
        labels[i] = rows[i] == '.' ? BIS_REGION_NONE : its == i ? next++ : labels[its];
    }
    expect_labels((int)width, (int)height, rows, labels, "random pixels of two levels");
}

static void neighbours_of_a_level_are_one_region(void)
{
    expect(6, 4,
           "......"
           ".11.5."
           ".1..5."
           "......",
           "......"
           ".aa.b."
           ".a..b."
           "......", "two patches");
    expect(6, 5,
           "......"
           ".1951."
           ".1.51."
           ".1111."
           "......",
           "......"
           ".abca."
           ".a.ca."
           ".aaaa."
           "......", "a U about two other levels");
    for (uint64_t k = 0; k < 20; k++) check_random_map(mark_size(12), 7, k);
}

static void corners_do_not_touch(void)
{
    expect(6, 5,
           "......"
           ".1.1.."
           "..1..."
           ".1.1.."
           "......",
           "......"
           ".a.b.."
           "..c..."
           ".d.e.."
           "......", "pixels that meet at corners");
}

static void left_and_right_edges_touch(void)
{
    expect(6, 4,
           "......"
           "1....1"
           ".2...."
           "......",
           "......"
           "a....a"
           ".b...."
           "......", "two pixels at the ends of a row");
}

static void all_pixels_of_a_pole_touch(void)
{
    expect(8, 4,
           "1..1.5.5"
           "........"
           "........"
           "2.....2.",
           "a..a.b.b"
           "........"
           "........"
           "c.....c.", "pixels about the poles, which meet there");
    expect(5, 3,
           "1.1.."
           "....."
           ".2.2.",
           "a.a.."
           "....."
           ".b.b.", "poles of a map of odd width");
    expect(6, 4,
           "1.1.9."
           "......"
           "......"
           ".1..1.",
           "a.a.b."
           "......"
           "......"
           ".c..c.", "one level at both poles: two regions");
    expect(6, 4,
           "1..1.."
           ".....9"
           ".....9"
           "9.9..9",
           "a..a.."
           ".....b"
           ".....b"
           "b.b..b", "a pole reached from its neighbour row");
    expect(6, 1, "1.19.9", "a.ab.b", "a map of one row, which is both poles");
}

static void solid_angles_are_summed(void)
{
    bis_envmap em = drawn(8, 4,
                          "1..1...."
                          "...1...."
                          "........"
                          "3.....33");
    bis_regions r = regions_of(&em, 16);

    if (r.n != 2) mark_wrong("%u regions, must be 2", r.n);
    mark_near(r.solid_angle[0], 2 * map_solid_angle(&em, 0) + map_solid_angle(&em, 8), 0, 1e-12,
              "the solid angle of three pixels about the north pole");
    mark_near(r.solid_angle[1], 3 * map_solid_angle(&em, 24), 0, 1e-12, "the solid angle of three pixels about the "
              "south pole");
}

static void a_large_map_needs_no_deep_recursion(void)
{
    bis_envmap em = map_new(1024, (int)mark_size(512));

    for (size_t i = 0; i < map_n(&em); i++) em.pixels[i].r = 1;
    bis_regions r = regions_of(&em, 8);
    if (r.n != 1) mark_wrong("a constant map of 1024 x %d pixels has %u regions, must be 1", em.height, r.n);
    mark_near(r.solid_angle[0], 4 * PI, 0, 1e-9, "the solid angle of a constant map");

    /* Were a pole's row walked anew for each of its pixels, these were 60 * 2 * 2^30 steps, far beyond the time of a
     * claim. */
    em = map_new(32768, 3);
    for (size_t i = 0; i < map_n(&em); i++) em.pixels[i].r = 1;
    for (int k = 0; k < 60; k++) {
        r = regions_of(&em, 8);
        if (r.n != 1) mark_wrong("a constant map of 32768 x 3 pixels has %u regions, must be 1", r.n);
    }
}

static void work(void)
{
    /* other maps each time: what is kept of the last one is of no use */
    for (uint64_t k = 0; k < 4; k++) check_random_map(mark_size(1024), mark_size(512), 70 + k);
}

int main(int argc, char **argv)
{
    static const mark_claim claims[] = {
        {"levels_are_equal_steps_of_the_logarithm", 10, levels_are_equal_steps_of_the_logarithm},
        {"darkest_brightest_black_and_constant_have_their_levels", 10,
         darkest_brightest_black_and_constant_have_their_levels},
        {"neighbours_of_a_level_are_one_region", 15, neighbours_of_a_level_are_one_region},
        {"corners_do_not_touch", 10, corners_do_not_touch},
        {"left_and_right_edges_touch", 10, left_and_right_edges_touch},
        {"all_pixels_of_a_pole_touch", 10, all_pixels_of_a_pole_touch},
        {"solid_angles_are_summed", 5, solid_angles_are_summed},
        {"a_large_map_needs_no_deep_recursion", 10, a_large_map_needs_no_deep_recursion},
    };

    return mark_main(argc, argv, claims, sizeof claims / sizeof *claims, work, 14.5);
}
