/* SPDX-License-Identifier: BSD-2-Clause */
/* Every scene that we ship is rendered with both accelerators, with the same random numbers: the mean of the pixels'
 * differences must be 0. A z-test for each scene, its standard error from the scatter of the differences; together they
 * reject what is right with probability ALPHA. Single pixels may differ (rays at edges), areas may not. Both are
 * compared with a third road, too: the sheared triangle test of the grid alone, which shadows floors at 0, is the twin
 * and must be rejected. Without Embree the plain grid takes its place. */
#include "bis/base/stats.h"
#include "claim.h"
#include "mesh_help.h"
#include "stat.h"
#include "bis/render/render.h"
#include "bis/scene/scene.h"

#include <stdio.h>
#include <string.h>

#include <dirent.h>

static const double ALPHA = 0.01;

enum { WIDTH = 48, HEIGHT = 36, MOST_SCENES = 64, SPP = 8 };

/* The scene by brdf, 4 samples for each camera sample: nothing of the light has to be built. */
static void load(bis_scene_desc **d, bis_scene **s, const char *path)
{
    bis_diag diag = {0};

    if (bis_scene_parse(d, path, &diag)) fail_msg("%s", diag.messages[0].text);
    (*d)->view.settings = (bis_settings){.integrator = &bis_brdf, .samples = 4};
    (*d)->view.film.width = WIDTH;
    (*d)->view.film.height = HEIGHT;
    (*d)->view.edge_samples = 0;
    (*d)->accel.kind = BIS_ACCEL_GRID;
    bis_sampler_set_spp(&(*d)->view.sampler, SPP);
    if (bis_scene_build(s, *d, &diag)) fail_msg("%s", diag.messages[0].text);
    bis_diag_clear(&diag);
}

static void render(double sum[WIDTH * HEIGHT], const bis_scene *s, const bis_scene_desc *d)
{
    const double whole[4] = {0, 1, 0, 1};
    bis_film film;
    bis_render_result result;

    assert_int_equal(bis_film_init(&film, WIDTH, HEIGHT, whole, (bis_loc){0}, NULL), BIS_OK);
    assert_int_equal(
        bis_render(&result, &film, s, &d->view, &(bis_render_options){.budget = {.spp = SPP}}, NULL), BIS_OK);
    for (int i = 0; i < WIDTH * HEIGHT; i++)
        sum[i] = (film.sum[3 * i] + film.sum[3 * i + 1] + film.sum[3 * i + 2]) / SPP;
    bis_film_clear(&film);
}

/* The z of the mean difference; 0 where all are equal. *pixels differ. */
static double z_of(const double a[WIDTH * HEIGHT], const double b[WIDTH * HEIGHT], int *pixels)
{
    double mean = 0, m2 = 0;

    *pixels = 0;
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        const double x = a[i] - b[i], step = x - mean;
        mean += step / (i + 1);
        m2 += step * (x - mean);
        *pixels += x != 0;
    }
    return *pixels ? mean / sqrt(m2 / (WIDTH * HEIGHT - 1) / (WIDTH * HEIGHT)) : 0;
}

static int find_scenes(char path[MOST_SCENES][256])
{
    int n = 0;
    DIR *folder = opendir("data/scenes");

    assert_non_null(folder);
    snprintf(path[n++], 256, "scene.txt");
    for (const struct dirent *e; (e = readdir(folder));) {
        const char *end = strrchr(e->d_name, '.');
        if (!end || strcmp(end, ".txt") != 0) continue;
        assert_true(n < MOST_SCENES);
        assert_true(snprintf(path[n++], 256, "data/scenes/%s", e->d_name) < 256);
    }
    closedir(folder);
    return n;
}

static void every_scene_has_one_picture(void **state)
{
    char path[MOST_SCENES][256];
    const int n = find_scenes(path);
    const double alpha = stat_level(ALPHA, n);
    assert_true(n >= 24);
    for (int i = 0; i < n; i++) {
        static double one[WIDTH * HEIGHT], other[WIDTH * HEIGHT];
        bis_scene_desc *d;
        bis_scene *s;
        int pixels;
        load(&d, &s, path[i]);
        render(one, s, d);
        bis_accel *second, *first = s->accel;
        d->accel.density = bis_accel_embree_version() ? 0 : 64; /* not packed */
        assert_int_equal(
            bis_scene_accel(&second, s, d, bis_accel_embree_version() ? BIS_ACCEL_EMBREE : BIS_ACCEL_GRID, NULL),
            BIS_OK);
        s->accel = second;
        render(other, s, d);
        const double z = z_of(one, other, &pixels), p = bis_stats_normal_p(z);
        stat_judges(1);
        if (pixels) print_message("%s: %d pixels differ, z = %.2f\n", path[i], pixels, z);
        if (p < alpha)
            fail_msg(
                "%s: %s and %s differ, z = %g, p = %g", path[i], bis_accel_name(first), bis_accel_name(second), z, p);
        bis_accel_free(first);
        bis_scene_free(s);
        bis_scene_desc_free(d);
    }
}

/* ---- the twin ---- */

static void floors_that_shadow_themselves_are_rejected(void **state)
{
    static const bis_accel_ops ops = {.name = "sheared", .intersect = right_intersect, .occluded = sheared_occluded};
    static double one[WIDTH * HEIGHT], other[WIDTH * HEIGHT];
    bis_scene_desc *d;
    bis_scene *s;
    int pixels;
    load(&d, &s, "data/scenes/trianglemesh.txt");
    render(one, s, d);
    bis_accel *right = s->accel;
    accel_twin wrong = {{&ops, &s->geometry}, right};
    s->accel = &wrong.accel;
    render(other, s, d);
    s->accel = right;
    const double z = z_of(one, other, &pixels);
    print_message("the twin: %d pixels differ, z = %.1f\n", pixels, z);
    assert_true(bis_stats_normal_p(z) < bis_stats_sidak(ALPHA, MOST_SCENES));
    bis_scene_free(s);
    bis_scene_desc_free(d);
}

/* ---- the furnace ---- */

static const char *const names[] = {"grid", "embree"};

static int n_accelerators(void) { return bis_accel_embree_version() ? 2 : 1; }

/* The mean of the scene's picture by accelerator i of `names`. */
static double mean_by(int i, const char *path)
{
    static double sum[WIDTH * HEIGHT];
    bis_scene_desc *d;
    bis_scene *s;
    double mean = 0;

    load(&d, &s, path);
    bis_accel_free(s->accel);
    assert_int_equal(bis_scene_accel(&s->accel, s, d, i ? BIS_ACCEL_EMBREE : BIS_ACCEL_GRID, NULL), BIS_OK);
    render(sum, s, d);
    for (int p = 0; p < WIDTH * HEIGHT; p++) mean += sum[p] / (3 * WIDTH * HEIGHT);
    bis_scene_free(s);
    bis_scene_desc_free(d);
    return mean;
}

/* Point p of a scene that is scaled, moved by h along z, and whose axes change places k times. */
static const char *placed(const double p[3], double h, double scale, int k)
{
    static char text[4][128];
    static int n;
    const double q[3] = {scale * p[0], scale * p[1], scale * p[2] + h};
    char *out = text[n++ % 4];

    snprintf(out, sizeof text[0], "%.9g %.9g %.9g ", q[k % 3], q[(k + 1) % 3], q[(k + 2) % 3]);
    return out;
}

/* A floor, and perhaps a box that rests on it, under a constant light 1. */
static void write_floor(const char *path, double h, double scale, int k, bool has_box)
{
    static const double floor_of[4][3] = {{-40, -40, 0}, {40, -40, 0}, {40, 40, 0}, {-40, 40, 0}};
    static const int faces[12][3] = {{0, 2, 1}, {0, 3, 2}, {4, 5, 6}, {4, 6, 7}, {0, 1, 5}, {0, 5, 4},
                                     {1, 2, 6}, {1, 6, 5}, {2, 3, 7}, {2, 7, 6}, {3, 0, 4}, {3, 4, 7}};
    FILE *f = fopen(path, "w");

    assert_non_null(f);
    fprintf(f, "Film \"rgb\" \"integer xresolution\" 48 \"integer yresolution\" 36 \"string filename\" \"x.pfm\"\n"
               "Sampler \"random\"\nIntegrator \"brdf\"\n");
    fprintf(f, "LookAt %s", placed((double[3]){4, 5, 4}, h, scale, k));
    fprintf(f, "%s", placed((double[3]){0, 0, 0.5}, h, scale, k));
    fprintf(f, "%s\n", placed((double[3]){0, 0, 1}, 0, 1, k));
    fprintf(f, "Camera \"perspective\" \"float fov\" 30\nWorldBegin\nLightSource \"infinite\" \"rgb L\" [1 1 1]\n"
               "Material \"phong\" \"rgb Kd\" [.5 .5 .5] \"rgb Ks\" [0 0 0]\nShape \"trianglemesh\" \"point3 P\" [");
    for (int i = 0; i < 4; i++) fprintf(f, "%s", placed(floor_of[i], h, scale, k));
    fprintf(f, "] \"integer indices\" [0 1 2 0 2 3]\n");
    if (has_box) fprintf(f, "Shape \"trianglemesh\" \"point3 P\" [");
    for (int i = 0; has_box && i < 8; i++) {
        const double corner[3] = {i % 4 == 1 || i % 4 == 2 ? 1 : -1, i % 4 >= 2 ? 1 : -1, i >= 4 ? 1.5 : 0};
        fprintf(f, "%s", placed(corner, h, scale, k));
    }
    if (has_box) fprintf(f, "] \"integer indices\" [");
    for (int i = 0; has_box && i < 12; i++) fprintf(f, "%d %d %d ", faces[i][0], faces[i][1], faces[i][2]);
    if (has_box) fprintf(f, "]\n");
    assert_int_equal(fclose(f), 0);
}

static const double heights[] = {0, 1e-30, 1e-10, 1, -1e5}, scales[] = {1, 1e-6, 1e6};
static const char path[] = "build/test_two_accelerators.txt";

/* The picture's mean is expected[turn] at all heights up to `farthest` sizes, at all sizes, by all accelerators. 0:
 * what the first one is, which is stored. Without a box to 1e-6; with one to 3e-5, because a ray may pass its edge so
 * closely that floats decide, and one ray is 9e-6. */
static void assert_same_everywhere(double expected[3], bool has_box, double farthest)
{
    for (int j = 0; j < 5 * 3 * 3; j++) {
        const double h = heights[j / 9], scale = scales[j / 3 % 3];
        if (fabs(h) > farthest * scale) continue;
        write_floor(path, h, scale, j % 3, has_box);
        for (int i = 0; i < n_accelerators(); i++) {
            const double mean = mean_by(i, path);
            if (expected[j % 3] == 0) expected[j % 3] = mean;
            if (!(fabs(mean - expected[j % 3]) < (has_box ? 3e-5 : 1e-6)))
                fail_msg("%s, at %g, size %g, turned %d: %.9g, not %.9g", names[i], h, scale, j % 3, mean,
                         expected[j % 3]);
        }
    }
}

/* Half of a constant light 1 comes back from Kd = 0.5, where nothing else is in the way. (Where a float's step is
 * larger than the floor, the camera cannot be put above it.) */
static void open_floors_give_half_of_the_light(void **state)
{
    assert_same_everywhere((double[3]){0.5, 0.5, 0.5}, false, 1e5);
}

/* A closed box that rests on a floor: its picture does not depend on where both lie, how large they are and how they
 * are turned, nor on the accelerator. (Not so far away that a float's step moves the box's points by 10^-5 of its
 * size.) */
static void a_box_on_a_floor_looks_the_same_everywhere(void **state)
{
    double expected[3] = {0}; /* of each turn: directions are drawn about the normal in a frame that it decides */
    assert_same_everywhere(expected, true, 100);
    for (int k = 0; k < 3; k++) assert_true(expected[k] > 0.4 && expected[k] < 0.499); /* some of it is hidden */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_scene_has_one_picture),
        cmocka_unit_test(floors_that_shadow_themselves_are_rejected),
        cmocka_unit_test(open_floors_give_half_of_the_light),
        cmocka_unit_test(a_box_on_a_floor_looks_the_same_everywhere),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
