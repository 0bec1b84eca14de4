/* Assignment regions: src/thesis/regions.c, levels and the breadth-first search. Expected values by hand. */
#include "mark.h"

#include "bis/thesis/regions.h"

#include "map_help.h"

#include <stdlib.h>

static bis_regions regions_of(const bis_envmap *em, int levels)
{
    bis_regions r;

    if (bis_regions_init(&r, em, levels, NULL)) mark_wrong("no memory for the regions");
    return r;
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

static void expect(int width, int height, const char *rows, const char *labels, const char *what)
{
    bis_envmap em = drawn(width, height, rows);
    bis_regions r = regions_of(&em, 16);
    uint32_t n = 0;

    for (int i = 0; i < width * height; i++) {
        const uint32_t must = labels[i] == '.' ? BIS_REGION_NONE : (uint32_t)(labels[i] - 'a');
        if (labels[i] != '.' && must + 1 > n) n = must + 1;
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
    bis_regions_clear(&r);
    bis_envmap_clear(&em);
}

static void levels_are_equal_steps_of_the_logarithm(void)
{
    bis_envmap em = map_new(4, 2);

    em.pixels[0].g = 1;
    em.pixels[1].g = 65536;
    const bis_levels l = bis_levels_of(&em, 8);
    for (int bin = 0; bin < 8; bin++) {
        const double at[] = {pow(4, bin) * 1.001, pow(4, bin) * 2, pow(4, bin) * 3.999};
        for (int k = 0; k < 3; k++) {
            const int level = bis_level_of_intensity(&l, at[k]);
            if (level != bin) {
                mark_wrong("8 levels from 1 to 65536, a factor of 4 each: intensity %g has level %d, must be %d",
                           at[k], level, bin);
            }
        }
    }
    bis_envmap_clear(&em);
}

static void darkest_brightest_black_and_constant_have_their_levels(void)
{
    bis_envmap em = map_new(4, 2);

    em.pixels[0].g = 1;
    em.pixels[1].g = 65536;
    bis_levels l = bis_levels_of(&em, 8);
    if (bis_level_of_intensity(&l, 65536) != 7) {
        mark_wrong("the brightest pixel of 8 levels has level %d, must be 7: it stands on the last bin's upper edge",
                   bis_level_of_intensity(&l, 65536));
    }
    if (bis_level_of_intensity(&l, 0) != BIS_LEVEL_NONE) {
        mark_wrong("intensity 0 has level %d, must be BIS_LEVEL_NONE: it has no logarithm",
                   bis_level_of_intensity(&l, 0));
    }
    em.pixels[1].g = 1;
    l = bis_levels_of(&em, 8);
    if (bis_level_of_intensity(&l, 1) != 0) {
        mark_wrong("a map of one intensity: level %d, must be 0", bis_level_of_intensity(&l, 1));
    }
    bis_envmap_clear(&em);
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
    bis_regions_clear(&r);
    bis_envmap_clear(&em);
}

static void a_large_map_needs_no_deep_recursion(void)
{
    bis_envmap em = map_new(1024, 512);

    for (size_t i = 0; i < map_n(&em); i++) em.pixels[i].r = 1;
    bis_regions r = regions_of(&em, 8);
    if (r.n != 1) mark_wrong("a constant map of 1024 x 512 pixels has %u regions, must be 1", r.n);
    mark_near(r.solid_angle[0], 4 * PI, 0, 1e-9, "the solid angle of a constant map");
    bis_regions_clear(&r);
    bis_envmap_clear(&em);
}

static void work(void)
{
    bis_envmap em = map_random(1024, 512, 3, 0.2, 7);

    for (int k = 0; k < 4; k++) {
        bis_regions r = regions_of(&em, 8);
        bis_regions_clear(&r);
    }
    bis_envmap_clear(&em);
}

int main(int argc, char **argv)
{
    static const mark_claim claims[] = {
        {"levels_are_equal_steps_of_the_logarithm", 10, levels_are_equal_steps_of_the_logarithm},
        {"darkest_brightest_black_and_constant_have_their_levels", 10, darkest_brightest_black_and_constant_have_their_levels},
        {"neighbours_of_a_level_are_one_region", 15, neighbours_of_a_level_are_one_region},
        {"corners_do_not_touch", 10, corners_do_not_touch},
        {"left_and_right_edges_touch", 10, left_and_right_edges_touch},
        {"all_pixels_of_a_pole_touch", 10, all_pixels_of_a_pole_touch},
        {"solid_angles_are_summed", 5, solid_angles_are_summed},
        {"a_large_map_needs_no_deep_recursion", 10, a_large_map_needs_no_deep_recursion},
    };

    return mark_main(argc, argv, claims, sizeof claims / sizeof *claims, work);
}
