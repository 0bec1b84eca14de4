/* SPDX-License-Identifier: BSD-2-Clause */
/* data: what the generator makes is what scene.txt, data/scenes and the docs rely on: meshes closed and wound one way,
 * maps with the stated contrast, the same bytes twice; and every scene file that we ship parses and renders.
 *
 * The generator (bis-data, beside the program) runs here, into build/test-data; PLY files are read by a strict reader
 * of the one layout that it writes, not by the library's. No statistical test. */
#include "bis/base/file.h"
#include "bis/beyond/mapping.h"
#include "bis/files/image_file.h"
#include "bis/base/mem.h"
#include "bis/scene/scene.h"
#include "claim.h"

#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>

#define ONE "build/test-data/one"
#define TWO "build/test-data/two"

static const char *const models[] = {"king", "queen", "bishop", "knight", "rook", "pawn", "squares_light",
    "squares_dark", "board", "knot", "pedestal", "paving", "louvres", "sphere"};
static const char *const maps[] = {"interior.hdr", "outdoor.hdr", "overcast.hdr", "studio.hdr", "lamps.hdr",
    "squares.hdr", "one_pixel.exr", "halves.exr", "constant.exr"};
/* What mapped.c makes of the lat-long maps. */
static const struct {
    const char *name, *of;
    bis_mapping mapping;
} mapped[] = {
    {"sky_equalarea.exr", "outdoor.hdr", BIS_MAPPING_EQUALAREA},
    {"sky_mirrorball.hdr", "outdoor.hdr", BIS_MAPPING_MIRRORBALL},
    {"sky_cubestrip.exr", "outdoor.hdr", BIS_MAPPING_CUBE_STRIP},
    {"clouds_angular.hdr", "overcast.hdr", BIS_MAPPING_ANGULAR},
    {"clouds_verticalcross.hdr.gz", "overcast.hdr", BIS_MAPPING_VERTICAL_CROSS},
    {"clouds_horizontalcross.pfm", "overcast.hdr", BIS_MAPPING_HORIZONTAL_CROSS},
};
enum { N_MODELS = sizeof models / sizeof models[0], N_MAPS = sizeof maps / sizeof maps[0],
       N_MAPPED = sizeof mapped / sizeof mapped[0] };

/* --- running programs --- */

static const char *program(void)
{
    const char *p = getenv("BIS_PROGRAM");
    return p ? p : "build/release/bis";
}

/* The exit status of the shell command. */
static int run(const char *format, ...) __attribute__((format(printf, 1, 2)));
static int run(const char *format, ...)
{
    char command[4096];
    va_list args;

    va_start(args, format);
    assert_true(vsnprintf(command, sizeof command, format, args) < (int)sizeof command);
    va_end(args);
    int status = system(command);
    assert_true(WIFEXITED(status));
    return WEXITSTATUS(status);
}

/* bis-data lies beside bis. */
static int run_generator(const char *environment, const char *arguments)
{
    const char *p = program(), *slash = strrchr(p, '/');

    return run(
        "%s %.*sbis-data %s 2> build/test-data/messages", environment, slash ? (int)(slash - p + 1) : 0, p, arguments);
}

static int make_both(void **state)
{
    assert_int_equal(run("mkdir -p build/test-data"), 0);
    assert_int_equal(run_generator("OMP_NUM_THREADS=1", ONE), 0);
    assert_int_equal(run_generator("OMP_NUM_THREADS=3", TWO), 0);
    return 0;
}

static void read_file(const char *path, unsigned char **data, size_t *size)
{
    bis_diag diag = {0};

    if (bis_file_read(data, size, path, (bis_loc){0}, &diag)) fail_msg("%s", diag.messages[0].text);
}

/* --- meshes --- */

static uint32_t little_endian(const unsigned char *p)
{
    return (uint32_t)p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
}

static vec3 three_floats(const unsigned char *p)
{
    float f[3];

    for (int i = 0; i < 3; i++) {
        uint32_t bits = little_endian(p + 4 * i);
        memcpy(&f[i], &bits, sizeof bits);
    }
    return (vec3){f[0], f[1], f[2]};
}

static void read_ply(bis_mesh *m, const char *path)
{
    unsigned char *data;
    size_t size;
    char header[512];

    read_file(path, &data, &size);
    assert_int_equal(sscanf((char *)data, "ply format binary_little_endian 1.0 element vertex %zu", &m->n_vertices), 1);
    const char *faces = strstr((char *)data, "element face ");
    assert_non_null(faces);
    assert_int_equal(sscanf(faces, "element face %zu", &m->n_triangles), 1);
    int n = snprintf(header, sizeof header,
        "ply\nformat binary_little_endian 1.0\nelement vertex %zu\nproperty float x\nproperty float y\n"
        "property float z\nproperty float nx\nproperty float ny\nproperty float nz\nelement face %zu\n"
        "property list uchar int vertex_indices\nend_header\n",
        m->n_vertices, m->n_triangles);
    assert_memory_equal(data, header, (size_t)n);
    assert_int_equal(size, (size_t)n + 24 * m->n_vertices + 13 * m->n_triangles);
    m->p = bis_alloc(m->n_vertices, sizeof *m->p);
    m->n = bis_alloc(m->n_vertices, sizeof *m->n);
    m->index = bis_alloc(m->n_triangles, 3 * sizeof *m->index);
    const unsigned char *at = data + n;
    for (size_t i = 0; i < m->n_vertices; i++, at += 24) {
        m->p[i] = three_floats(at);
        m->n[i] = three_floats(at + 12);
    }
    for (size_t i = 0; i < m->n_triangles; i++, at += 13) {
        assert_int_equal(at[0], 3);
        for (size_t j = 0; j < 3; j++) {
            m->index[3 * i + j] = little_endian(at + 1 + 4 * j);
            assert_true(m->index[3 * i + j] < m->n_vertices);
        }
    }
    bis_free(data);
}

static void read_model(bis_mesh *m, const char *name)
{
    char path[256];

    snprintf(path, sizeof path, ONE "/models/%s.ply", name);
    read_ply(m, path);
}

static int compare_edges(const void *a, const void *b)
{
    uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

/* Is each directed edge there once, and so is its opposite? Then every edge joins two triangles that are wound the same
 * way. */
static bool is_closed_and_consistent(const bis_mesh *m)
{
    size_t n = 3 * m->n_triangles;
    uint64_t *there = bis_alloc(n, sizeof *there), *back = bis_alloc(n, sizeof *back);
    bool good = true;

    for (size_t i = 0; i < n; i++) {
        uint64_t a = m->index[i], b = m->index[i % 3 == 2 ? i - 2 : i + 1];
        there[i] = a << 32 | b;
        back[i] = b << 32 | a;
    }
    qsort(there, n, sizeof *there, compare_edges);
    qsort(back, n, sizeof *back, compare_edges);
    for (size_t i = 0; i < n; i++) good &= there[i] == back[i] && (i == 0 || there[i] != there[i - 1]);
    bis_free(there);
    bis_free(back);
    return good;
}

typedef struct d3 {
    double x, y, z;
} d3;

static d3 minus(vec3 a, vec3 b)
{
    return (d3){(double)a.x - (double)b.x, (double)a.y - (double)b.y, (double)a.z - (double)b.z};
}
static double d3_length(d3 a) { return sqrt(a.x * a.x + a.y * a.y + a.z * a.z); }

/* Twice the area times the normal, of triangle i, in double from the corners. */
static d3 triangle_normal(const bis_mesh *m, size_t i, double *longest)
{
    vec3 a = m->p[m->index[3 * i]], b = m->p[m->index[3 * i + 1]], c = m->p[m->index[3 * i + 2]];
    d3 u = minus(b, a), v = minus(c, a);

    *longest = fmax(d3_length(u), fmax(d3_length(v), d3_length(minus(c, b))));
    return (d3){u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
}

/* Six times the enclosed volume: positive when the triangles face outwards. */
static double volume6(const bis_mesh *m)
{
    double sum = 0, longest;

    for (size_t i = 0; i < m->n_triangles; i++) {
        d3 n = triangle_normal(m, i, &longest);
        vec3 p = m->p[m->index[3 * i]];
        sum += n.x * (double)p.x + n.y * (double)p.y + n.z * (double)p.z;
    }
    return sum;
}

static void every_mesh_is_closed_and_wound_outwards(void **state)
{
    for (int i = 0; i < N_MODELS; i++) {
        bis_mesh m = {0};
        read_model(&m, models[i]);
        if (!is_closed_and_consistent(&m))
            fail_msg("%s.ply is open or pinched, or its triangles are wound differently", models[i]);
        if (!(volume6(&m) > 0)) fail_msg("%s.ply is wound inwards", models[i]);
        bis_mesh_clear(&m);
    }
}

/* The twin. */
static void one_turned_or_missing_triangle_is_found(void **state)
{
    bis_mesh m = {0};

    read_model(&m, "pawn");
    uint32_t keep = m.index[3 * 777];
    m.index[3 * 777] = m.index[3 * 777 + 1];
    m.index[3 * 777 + 1] = keep;
    assert_false(is_closed_and_consistent(&m));
    m.index[3 * 777 + 1] = m.index[3 * 777];
    m.index[3 * 777] = keep;
    assert_true(is_closed_and_consistent(&m));
    m.n_triangles--;
    assert_false(is_closed_and_consistent(&m));
    bis_mesh_clear(&m);
}

static void vertex_normals_are_unit_and_face_outwards(void **state)
{
    for (int i = 0; i < N_MODELS; i++) {
        bis_mesh m = {0};
        size_t wrong = 0;
        read_model(&m, models[i]);
        for (size_t k = 0; k < m.n_vertices; k++) assert_true(fabs(length(m.n[k]) - 1) < 1e-6);
        for (size_t k = 0; k < 3 * m.n_triangles; k++) {
            double longest;
            d3 ng = triangle_normal(&m, k / 3, &longest);
            vec3 n = m.n[m.index[k]];
            wrong += ng.x * (double)n.x + ng.y * (double)n.y + ng.z * (double)n.z <= 0;
        }
        /* The bishop's slot is steeper than its mesh is fine: a vertex at its bottom may join faces more than 90
         * degrees apart. */
        if (wrong > m.n_triangles / 1000)
            fail_msg("%s.ply: %zu of %zu corners face away from their triangle", models[i], wrong, 3 * m.n_triangles);
        bis_mesh_clear(&m);
    }
}

static void a_benchmark_knot_has_the_triangles_asked_for(void **state)
{
    static const size_t counts[] = {10000, 31623, 300000};

    for (int i = 0; i < 3; i++) {
        char arguments[64];
        bis_mesh m = {0};
        snprintf(arguments, sizeof arguments, "--knot %zu build/test-data/knot.ply", counts[i]);
        assert_int_equal(run_generator("", arguments), 0);
        read_ply(&m, "build/test-data/knot.ply");
        assert_true(m.n_triangles >= counts[i] && m.n_triangles <= counts[i] + counts[i] / 100 + 1000);
        assert_true(is_closed_and_consistent(&m));
        bis_mesh_clear(&m);
    }
}

/* --- files --- */

static void one_thread_and_three_make_the_same_bytes(void **state)
{
    assert_int_equal(run("diff -r " ONE " " TWO), 0);
}

static void bad_usage_and_an_unwritable_place_are_told(void **state)
{
    assert_int_equal(run_generator("", ""), 2);
    assert_int_equal(run_generator("", "--knot 12x build/test-data/x.ply"), 2);
    assert_int_equal(run_generator("", "--knot 1e12 build/test-data/x.ply"), 2);
    assert_int_equal(run_generator("", "/dev/null/x"), 1);
    assert_int_equal(run("grep -q /dev/null/x build/test-data/messages"), 0);
}

/* --- maps --- */

static void read_map(bis_image *image, const char *name)
{
    char path[256];
    bis_diag diag = {0};

    snprintf(path, sizeof path, ONE "/maps/%s", name);
    if (bis_image_read(image, path, (bis_loc){0}, &diag)) fail_msg("%s", diag.messages[0].text);
    assert_int_equal(diag.n, 0);
    assert_int_equal(image->width, 2 * image->height);
}

typedef struct patch {
    double L, sr; /* luminance, solid angle */
} patch;

static int brighter_first(const void *a, const void *b)
{
    double x = ((const patch *)a)->L, y = ((const patch *)b)->L;
    return (x < y) - (x > y);
}

/* Ratios of the largest luminance to the median over the sphere and to the smallest; share of the brightest 0.1% of the
 * sphere in the whole. */
typedef struct contrast {
    double to_median, to_min, share;
} contrast;

static contrast contrast_of(const char *name)
{
    bis_image image;

    read_map(&image, name);
    size_t n = (size_t)image.width * (size_t)image.height;
    patch *patches = bis_alloc(n, sizeof *patches);
    double total = 0;
    for (size_t i = 0; i < n; i++) {
        double y = (double)(i / (size_t)image.width);
        rgb L = image.pixels[i];
        patches[i].L = 0.2126 * (double)L.r + 0.7152 * (double)L.g + 0.0722 * (double)L.b;
        patches[i].sr = 2 * PI / image.width * (cos(PI * y / image.height) - cos(PI * (y + 1) / image.height));
        total += patches[i].L * patches[i].sr;
    }
    qsort(patches, n, sizeof *patches, brighter_first);
    contrast c = {0};
    double sr = 0, bright = 0;
    for (size_t i = 0; i < n; i++) {
        if (sr < 0.001 * 4 * PI) bright += patches[i].L * patches[i].sr;
        sr += patches[i].sr;
        if (c.to_median == 0 && sr >= 2 * PI) c.to_median = patches[0].L / patches[i].L;
    }
    c.to_min = patches[0].L / patches[n - 1].L;
    c.share = bright / total;
    bis_free(patches);
    bis_image_clear(&image);
    return c;
}

static void every_map_is_finite_and_lit(void **state)
{
    for (int i = 0; i < N_MAPS; i++) {
        bis_image image;
        double sum = 0;
        read_map(&image, maps[i]);
        for (int k = 0; k < image.width * image.height; k++) {
            rgb L = image.pixels[k];
            assert_true(rgb_is_finite(L) && L.r >= 0 && L.g >= 0 && L.b >= 0);
            sum += rgb_sum(L);
        }
        assert_true(sum > 0);
        bis_image_clear(&image);
    }
}

/* Figures of photographed maps: max/median 1e4 to 1e6, 15% to 80% of the energy in the brightest 0.1%. */
static void the_hall_has_a_contrast_of_ten_million(void **state)
{
    contrast c = contrast_of("interior.hdr");
    assert_true(c.to_min >= 1e7);
    assert_true(c.to_median > 1e4 && c.to_median < 1e6);
    assert_true(c.share > 0.15 && c.share < 0.80);
}

static void outdoor_and_studio_concentrate_their_energy_like_photographed_ones(void **state)
{
    static const char *const names[] = {"outdoor.hdr", "studio.hdr"};

    for (int i = 0; i < 2; i++) {
        contrast c = contrast_of(names[i]);
        assert_true(c.to_median > 1e4 && c.to_median < 1e6);
        assert_true(c.share > 0.15 && c.share < 0.80);
    }
}

static void the_overcast_sky_is_smooth(void **state)
{
    contrast c = contrast_of("overcast.hdr");
    assert_true(c.to_median < 10);
    assert_true(c.share < 0.01);
}

/* The disc of half angle 0.265 degrees and radiance 62000 gives L 2 pi (1 - cos r) on a surface that faces it; RGBE
 * keeps 1%, the 16 x 16 directions of a pixel another 2%; the sky within one degree adds less than 3%. */
static void the_sun_gives_the_irradiance_of_its_disc(void **state)
{
    const double azimuth = atan2(-0.62, -0.50), height = atan2(0.60, hypot(0.50, 0.62));
    const double expected = 62000 * 2 * PI * (1 - cos(0.265 * PI / 180));
    bis_image image;
    double e = 0;

    read_map(&image, "outdoor.hdr");
    for (int y = 0; y < image.height; y++) {
        for (int x = 0; x < image.width; x++) {
            double theta = PI * (y + 0.5) / image.height, phi = 2 * PI * (x + 0.5) / image.width;
            double c = cos(theta) * sin(height) + sin(theta) * cos(height) * cos(phi - azimuth);
            double sr = 2 * PI / image.width * (cos(PI * y / image.height) - cos(PI * (y + 1) / image.height));
            if (c > cos(PI / 180)) e += (double)image.pixels[y * image.width + x].r * sr;
        }
    }
    bis_image_clear(&image);
    assert_true(e > 0.97 * expected && e < 1.06 * expected);
}

static void the_plain_maps_hold_their_idea(void **state)
{
    bis_image image;
    int lit = 0;

    read_map(&image, "one_pixel.exr");
    for (int i = 0; i < image.width * image.height; i++) lit += !rgb_is_black(image.pixels[i]);
    assert_int_equal(lit, 1);
    bis_image_clear(&image);

    read_map(&image, "halves.exr");
    for (int i = 0; i < image.width * image.height; i++) {
        int column = i % image.width;
        bool red = column >= image.width / 4 && column < 3 * image.width / 4; /* cos phi < 0 */
        assert_true(image.pixels[i].r == (red ? 1 : 0) && image.pixels[i].g == 0 && image.pixels[i].b == (red ? 0 : 1));
    }
    bis_image_clear(&image);

    read_map(&image, "constant.exr");
    for (int i = 0; i < image.width * image.height; i++) {
        assert_true(image.pixels[i].r == 1 && image.pixels[i].g == 1 && image.pixels[i].b == 1);
    }
    bis_image_clear(&image);
}

/* The mean radiance in a cell of COLUMNS x COLUMNS/2 of the sphere, of r+g+b; a cell is many pixels of any of the maps.
 */
enum { COLUMNS = 16, CELLS = COLUMNS * COLUMNS / 2 };

static void cell_means(double mean[CELLS], const bis_image *latlong)
{
    double weight[CELLS] = {0};

    for (int c = 0; c < CELLS; c++) mean[c] = 0;
    for (int i = 0; i < latlong->width * latlong->height; i++) {
        const int x = i % latlong->width, y = i / latlong->width;
        const int c = y * (COLUMNS / 2) / latlong->height * COLUMNS + x * COLUMNS / latlong->width;
        const double w = sin((y + 0.5) / latlong->height * acos(-1)); /* as the solid angle */
        mean[c] += w * rgb_sum(latlong->pixels[i]);
        weight[c] += w;
    }
    for (int c = 0; c < CELLS; c++) mean[c] /= weight[c];
}

/* How far apart the cells are, in the mean of |a - b|/(a + b); flip: b is mirrored from left to right. */
static double cells_apart(const double *a, const double *b, bool flip)
{
    double sum = 0;
    for (int c = 0; c < CELLS; c++) {
        const double other = b[flip ? c / COLUMNS * COLUMNS + COLUMNS - 1 - c % COLUMNS : c];
        sum += fabs(a[c] - other) / (a[c] + other) / CELLS;
    }
    return sum;
}

/* mapped.c has formulas of its own, and the library reads what they drew. A pixel is 3 to 6 degrees wide, a cell 22.5:
 * what pixels on its border take from the next cell is some thousandths. The twin is the mirrored picture, what a wrong
 * sign would make; a cloudy sky is nearly its own mirror image, and still differs twice as much. */
static void maps_in_other_mappings_show_the_map_that_they_are_of(void **state)
{
    for (int i = 0; i < N_MAPPED; i++) {
        bis_image image, source;
        bis_envmap em;
        bis_diag diag = {0};
        double a[CELLS], b[CELLS];
        char path[256];

        snprintf(path, sizeof path, ONE "/maps/%s", mapped[i].name);
        assert_int_equal(bis_image_read(&image, path, (bis_loc){0}, &diag), BIS_OK);
        assert_int_equal(bis_envmap_from_mapping(&em, &image, mapped[i].mapping, 0, &diag), BIS_OK);
        bis_image_clear(&image);
        read_map(&source, mapped[i].of);
        bis_image shown = {.width = em.width, .height = em.height, .pixels = em.pixels};
        cell_means(a, &shown);
        cell_means(b, &source);
        const double apart = cells_apart(a, b, false), mirrored = cells_apart(a, b, true);
        if (!(apart < 0.006 && mirrored > 0.012)) fail_msg("%s: %g, mirrored %g", mapped[i].name, apart, mirrored);
        bis_envmap_clear(&em);
        bis_image_clear(&source);
    }
}

/* --- scenes --- */

typedef void (*scene_check)(const char *path);

/* scene.txt and data/scenes/NAME.txt. Returns how many there are. */
static int for_each_scene(scene_check check)
{
    DIR *dir = opendir("data/scenes");
    int n = 1;

    assert_non_null(dir);
    check("scene.txt");
    for (struct dirent *entry = readdir(dir); entry; entry = readdir(dir)) {
        char path[512];
        const char *dot = strrchr(entry->d_name, '.');
        if (!dot || strcmp(dot, ".txt") != 0) continue;
        snprintf(path, sizeof path, "data/scenes/%s", entry->d_name);
        check(path);
        n++;
    }
    closedir(dir);
    return n;
}

static void check_says_what_to_look_for(const char *path)
{
    unsigned char *data;
    size_t size;

    read_file(path, &data, &size);
    if (data[0] != '#' || strchr((char *)data, '\n') - (char *)data < 40)
        fail_msg("%s does not open with a comment that tells its idea", path);
    bis_free(data);
}

static void check_renders(const char *path)
{
    int status =
        run("%s --quiet --resolution 32x24 --spp 1 --outfile build/test-data/scene.exr %s 2> build/test-data/messages",
            program(), path);

    if (status != 0) {
        run("cat build/test-data/messages");
        fail_msg("%s: exit status %d", path, status);
    }
    if (run("test ! -s build/test-data/messages") != 0) {
        run("cat build/test-data/messages");
        fail_msg("%s: has something to complain about", path);
    }
}

static void every_scene_says_what_to_look_for(void **state)
{
    for_each_scene(check_says_what_to_look_for);
}

static void every_scene_renders_without_a_warning(void **state)
{
    assert_true(for_each_scene(check_renders) >= 20);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_thread_and_three_make_the_same_bytes),
        cmocka_unit_test(bad_usage_and_an_unwritable_place_are_told),
        cmocka_unit_test(every_mesh_is_closed_and_wound_outwards),
        cmocka_unit_test(one_turned_or_missing_triangle_is_found),
        cmocka_unit_test(vertex_normals_are_unit_and_face_outwards),
        cmocka_unit_test(a_benchmark_knot_has_the_triangles_asked_for),
        cmocka_unit_test(every_map_is_finite_and_lit),
        cmocka_unit_test(the_hall_has_a_contrast_of_ten_million),
        cmocka_unit_test(outdoor_and_studio_concentrate_their_energy_like_photographed_ones),
        cmocka_unit_test(the_overcast_sky_is_smooth),
        cmocka_unit_test(the_sun_gives_the_irradiance_of_its_disc),
        cmocka_unit_test(the_plain_maps_hold_their_idea),
        cmocka_unit_test(maps_in_other_mappings_show_the_map_that_they_are_of),
        cmocka_unit_test(every_scene_says_what_to_look_for),
        cmocka_unit_test(every_scene_renders_without_a_warning),
    };

    return cmocka_run_group_tests_name("data", tests, make_both, NULL);
}
