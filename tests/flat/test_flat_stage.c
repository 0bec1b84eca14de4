/* SPDX-License-Identifier: BSD-2-Clause */
/* flat_stage, flat_methods: chapter 4 at one point of a scene, on arrays. Expected values are closed forms, quadrature,
 * and the library's own maps. tests/python/test_stage.py holds the rest of a stage against a second renderer. */
#include "flat_claims.h"

#include "bis/base/vec.h"
#include "program.h"

#define DIR "build/test_flat_stage"
#define PICTURE "text=Film \"rgb\" \"integer xresolution\" 8 \"integer yresolution\" 8\n"
#define EYE "LookAt 0 -4 2  0 0 0  0 0 1\nCamera \"perspective\" \"float fov\" 20\nWorldBegin\n"
#define SKY(name) "LightSource \"infinite\" \"string filename\" \"" DIR "/" name ".pfm\"\n"
#define FLOOR(Kd, Ks) "Material \"phong\" \"float Kd\" " Kd " \"float Ks\" " Ks "\nShape \"disk\" \"float radius\" 5\n"
#define SCENE PICTURE EYE SKY("white") FLOOR("0.5", "0")
/* A wall across the floor behind the point: what goes towards +y is hidden. */
#define WALL \
    "Shape \"trianglemesh\" \"point3 P\" [-9999 .5 -9999  9999 .5 -9999  0 .5 99999] \"integer indices\" [0 1 2]\n"

/* white: 16 x 8 pixels of radiance 1. lamp: with 4 in two pixels of row 2. */
static int setup(void **state)
{
    float white[3 * 16 * 8], lamp[3 * 16 * 8];

    program_folder(DIR);
    for (int i = 0; i < 3 * 16 * 8; i++) {
        white[i] = 1;
        lamp[i] = i / 48 == 5 && i / 3 % 16 / 2 == 1 ? 4 : 1; /* from the bottom row */
    }
    write_pfm(DIR "/white.pfm", 16, 8, white);
    write_pfm(DIR "/lamp.pfm", 16, 8, lamp);
    return 0;
}

static bis_flat_stage *stage_at(const char *scene, int x, int y)
{
    bis_flat_stage *stage;
    double found[8];

    GIVES(stage_open, &stage, "scene", LIST(scene));
    GIVES(stage_at, stage, x, y, found);
    return stage;
}

static const char *const sir64[] = {
    "integrator=sir", "candidates=64", "shadowrays=8", "proposal=mix", "learn=false", NULL};

/* A diffuse floor under radiance 1 in R, G and B reflects 3 Kd = 1.5 everywhere, and nothing hides the light. */
static void a_point_of_a_diffuse_floor_is_known(void **state)
{
    bis_flat_stage *stage;
    double found[8], value[4], sum[6], L[64], w[64], u[64], bound[2], height[64];
    float wi[192];
    uint32_t chosen[64], kind[64], taken[64], accepted, n = 0, distinct = 0;

    GIVES(stage_open, &stage, "scene", LIST(SCENE));
    NO("no point was chosen", stage_exact, stage, 1, value);
    GIVES(stage_at, stage, 4, 4, found);
    assert_true(found[0] == 1 && fabs(found[6] - 1) < 1e-6);
    GIVES(stage_exact, stage, 1, value);
    assert_true(fabs(value[0] - 1.5) <= 6 * value[1] + 1e-6 && fabs(value[2] - 1.5) <= 6 * value[3] + 1e-6);
    GIVES(stage_runs, stage, sir64, 1, 64, L, sum);
    assert_true(fabs(sum[0] - 1.5) <= 6 * sum[1] / 8 + 1e-6);
    GIVES(stage_candidates, stage, sir64, 1, 64, wi, w, chosen, kind, sum);
    /* M, N, and nothing is hidden: the estimate with V is the one without, and each that was chosen has a ray */
    for (int i = 0; i < 64; i++) n += chosen[i], distinct += chosen[i] > 0;
    assert_true(sum[0] == 64 && sum[1] == 8 && n == 8 && sum[2] > 1 && sum[2] <= 64 && sum[5] == distinct);
    assert_true(fabs(sum[3] - sum[4]) < 1e-6); /* floats */
    GIVES(stage_bounds, stage, bound);
    for (int i = 0; i < 64; i++) assert_true(w[i] <= fmax(bound[0], bound[1]) * (1 + 1e-5));
    /* u times the bound of 1 over w itself: every other candidate lies just below its weight, the others just above */
    for (int k = 0; k < 2; k++) {
        const double B = bound[k];
        for (int i = 0; i < 64; i++) u[i] = w[i] / B * (i % 2 ? 1.001 : 0.999);
        GIVES(stage_accept, stage, k ? "brdf" : "em", 64, w, u, height, taken, &accepted);
        n = 0;
        for (int i = 0; i < 64; i++) {
            assert_true(taken[i] == (w[i] > 0 && i % 2 == 0) && fabs(height[i] - u[i] * B) <= 1e-12 * B);
            n += taken[i];
        }
        assert_true(accepted == n && n > 0);
    }
    NO("candidate 0 is no number", stage_accept, stage, "em", 1, D((double)NAN), u, height, taken, &accepted);
    NO("candidate 0 is no number", stage_accept, stage, "em", 1, w, D((double)NAN), height, taken, &accepted);
    NO("proposal \"mix\" has no bound: give em or brdf", stage_accept, stage, "mix", 1, w, u, height, taken, &accepted);
    NO("64 candidates do not fit into arrays of 63", stage_candidates, stage, sir64, 1, 63, wi, w, chosen, kind, sum);
    NO("integrator \"em\" has no candidates to show: give sir", stage_candidates, stage, LIST("integrator=em"), 1, 64,
        wi, w, chosen, kind, sum);
    bis_flat_stage_close(stage);
}

/* Pixel (4, 3) of 8 x 8 lies half a pixel aside and half a pixel above the middle, which is the origin; the camera sees
 * 10 degrees to each side, and looks along (0, 2, -1). Up in its picture is (0, 1, 2), and aside is -x, as in pbrt,
 * whose hands are left ones. A camera that looks at the sky sees nothing. */
static void a_pixel_shows_the_point_on_the_floor(void **state)
{
    static const char *const up[] = {SCENE, "camera=LookAt 0 -4 2  0 -4 9  0 1 0 Camera \"perspective\"", NULL};
    const double a = tan(10 * PI / 180) / 8, l = sqrt(5);
    const double d[3] = {-a, (2 + a) / l, (2 * a - 1) / l}, k = -2 / d[2];
    const double right[8] = {1, k * d[0], k * d[1] - 4, 0, 0, 0, 1,
                             k * sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2])};
    const int outside[4][2] = {{8, 0}, {0, 8}, {-1, 3}, {3, -1}};
    bis_flat_stage *stage = stage_at(SCENE, 0, 0);
    double found[9] = {7, 7, 7, 7, 7, 7, 7, 7, 7}, bound[2];

    GIVES(stage_at, stage, 4, 3, found);
    for (int i = 0; i < 8; i++) assert_true(fabs(found[i] - right[i]) < 1e-5);
    assert_true(found[8] == 7);
    for (int i = 0; i < 2; i++) GIVES(stage_at, stage, 7 * i, 7 * i, found);
    for (int i = 0; i < 4; i++) {
        char text[64];
        snprintf(text, sizeof text, "pixel (%d, %d) is outside 8 x 8", outside[i][0], outside[i][1]);
        NO(text, stage_at, stage, outside[i][0], outside[i][1], found);
    }
    bis_flat_stage_close(stage);
    GIVES(stage_open, &stage, "scene", up);
    GIVES(stage_at, stage, 4, 3, found);
    for (int i = 0; i < 8; i++) assert_true(found[i] == 0);
    NO("no point was chosen, or its pixel sees no surface: choose another one", stage_bounds, stage, bound);
    bis_flat_stage_close(stage);
}

/* Candidates of a diffuse floor of 0.5 under radiance 1: f cos Le is 1.5 cos/pi, the map draws by 1/(4 pi), the BRDF by
 * cos/pi; a mixture by both, in proportion to what is from the map. So each weight follows from the direction. The wall
 * hides half of the sky: which candidates are seen follows from the direction, too, and the estimate is L_ns times the
 * share of the choices that are. Behind the candidates all is 0. */
static void candidates_are_known_by_their_directions(void **state)
{
    enum { M = 48, N = 6, ROOM = 50 };
    static const char *const proposals[3] = {"proposal=em", "proposal=brdf", "proposal=mix"};
    bis_flat_stage *stage = stage_at(SCENE WALL, 4, 4);

    for (int k = 0; k < 3; k++) {
        const char *const sir[] = {
            "integrator=sir", "candidates=48", "shadowrays=6", proposals[k], "learn=false", NULL};
        float wi[3 * ROOM + 1];
        double w[ROOM + 1], sum[7], W = 0, squares = 0, seen = 0, other[ROOM];
        uint32_t chosen[ROOM + 1], kind[ROOM + 1], n = 0, n_map = 0, distinct = 0;
        wi[3 * ROOM] = 7, w[ROOM] = sum[6] = 7, chosen[ROOM] = kind[ROOM] = 7;
        GIVES(stage_candidates, stage, sir, 5, ROOM, wi, w, chosen, kind, sum);
        for (int i = 0; i < M; i++) n_map += kind[i] & 1;
        const double beta = (double)n_map / M;
        for (int i = 0; i < M; i++) {
            const double z = (double)wi[3 * i + 2], y = (double)wi[3 * i + 1], x = (double)wi[3 * i];
            n += chosen[i];
            distinct += chosen[i] > 0;
            W += w[i];
            squares += w[i] * w[i];
            if (w[i] <= 0) continue;
            assert_true(fabs(x * x + y * y + z * z - 1) < 1e-6);
            assert_true(fabs(w[i] - 6 * z / (beta + 4 * (1 - beta) * z)) < 1e-5);
            if (chosen[i]) assert_int_equal(kind[i] & 2, y < 0 ? 2 : 0);
            if (kind[i] & 2) seen += chosen[i];
        }
        assert_int_equal(n, N);
        assert_true(k == 0 ? n_map == M : k == 1 ? n_map == 0 : n_map > 0 && n_map < M);
        for (int i = M; i < ROOM; i++)
            assert_true(wi[3 * i] == 0 && wi[3 * i + 1] == 0 && wi[3 * i + 2] == 0 && w[i] == 0 && chosen[i] == 0 &&
                        kind[i] == 0);
        assert_true(wi[3 * ROOM] == 7 && w[ROOM] == 7 && sum[6] == 7 && chosen[ROOM] == 7 && kind[ROOM] == 7);
        assert_true(sum[0] == M && sum[1] == N && sum[5] == distinct && fabs(sum[2] - W * W / squares) < 1e-9 * M);
        assert_true(seen > 0 && seen < N);
        assert_true(fabs(sum[4] - W / M) < 1e-5 && fabs(sum[3] - W / M * seen / N) < 1e-5);
        /* the seed is used, and nothing else */
        GIVES(stage_candidates, stage, sir, 5, ROOM, wi, other, chosen, kind, sum);
        assert_memory_equal(other, w, sizeof other);
        GIVES(stage_candidates, stage, sir, 6, ROOM, wi, other, chosen, kind, sum);
        if (k != 1) assert_memory_not_equal(other, w, sizeof other);
    }
    bis_flat_stage_close(stage);
}

/* The estimates' own mean and deviation; by the BRDF each has its 7 rays, because none of a diffuse floor go down. Half
 * of the light is hidden. The exact value is another one at another point and by another seed, and it is kept. */
static void runs_are_summed_up_and_the_exact_value_is_of_its_point(void **state)
{
    enum { N = 50 };
    static const char *const brdf[] = {"integrator=brdf", "samples=7", NULL};
    bis_flat_stage *stage = stage_at(SCENE WALL, 4, 4);
    double found[8], L[N + 1], sum[4], first[5], again[5], mean = 0, square = 0;

    L[N] = sum[3] = first[4] = again[4] = 7;
    GIVES(stage_runs, stage, brdf, 1, N, L, sum);
    for (int i = 0; i < N; i++) mean += L[i] / N;
    for (int i = 0; i < N; i++) square += (L[i] - mean) * (L[i] - mean) / (N - 1);
    assert_true(fabs(sum[0] - mean) < 1e-12 && fabs(sum[1] - sqrt(square)) < 1e-12 && square > 1e-3 && sum[2] == 7);
    assert_true(L[N] == 7 && sum[3] == 7);
    NO("1 estimates: give 2 to 1000000", stage_runs, stage, brdf, 1, 1, L, sum);
    NO("1000001 estimates: give 2 to 1000000", stage_runs, stage, brdf, 1, 1000001, L, sum);
    GIVES(stage_runs, stage, brdf, 1, 2, L, sum);
    /* the integrator of a question is forgotten */
    NO("no parameter", stage_runs, stage, LIST("samples=7"), 1, 2, L, sum);

    GIVES(stage_exact, stage, 3, first);
    assert_true(fabs(first[0] - 0.75) <= 6 * first[1] + 1e-3 && first[1] < 1e-3);
    assert_true(fabs(first[2] - 1.5) <= 6 * first[3]);
    /* row and seed (0 is one as any other): the first value comes back where both do */
    const int asked[][2] = {{4, 3}, {4, 0}, {4, 3}, {4, 4}, {4, 3}, {7, 3}, {4, 3}};
    for (size_t i = 0; i < N_OF(asked); i++) {
        if (asked[i][0] != 4 || (i > 0 && asked[i - 1][0] != 4)) GIVES(stage_at, stage, 4, asked[i][0], found);
        GIVES(stage_exact, stage, (uint32_t)asked[i][1], again);
        assert_true((memcmp(first, again, sizeof first) == 0) == (asked[i][0] == 4 && asked[i][1] == 3));
        assert_true((again[0] == first[0]) == (asked[i][0] == 4 && asked[i][1] == 3));
    }
    bis_flat_stage_close(stage);
}

/* A grid of 4 columns and 3 rows over the map: directions by phi and theta. The lower pole belongs to the last row, and
 * a phi that rounds to a whole turn to the last column. */
static void a_direction_is_found_in_its_cell(void **state)
{
    const float wi[8 * 3] = {0, 0, 1,      1, 0.1f, 0, 0.1f, 1, 0, -1, 0.1f, 0, 0.1f, -1, 0, 0, 0.1f, -1,
                             0, 0, -1, 1, -1e-30f, 0};
    static const uint32_t wanted[8] = {0, 4, 4, 5, 7, 9, 8, 7};
    bis_flat_stage *stage = stage_at(SCENE, 4, 4);
    uint32_t cell[8];
    float unit[8 * 3];

    for (int i = 0; i < 8; i++) {
        const vec3 w = normalize((vec3){wi[3 * i], wi[3 * i + 1], wi[3 * i + 2]});
        unit[3 * i] = w.x, unit[3 * i + 1] = w.y, unit[3 * i + 2] = w.z;
    }
    GIVES(stage_find, stage, 4, 3, 8, unit, cell);
    for (int i = 0; i < 8; i++)
        if (cell[i] != wanted[i]) fail_msg("direction %d: cell %u", i, (unsigned)cell[i]);
    /* of any length: an azimuth of 225 degrees is column 10 of 16, 125.3 degrees from the zenith row 5 of 8 */
    GIVES(stage_find, stage, 16, 8, 1, F(-1e30f, -1e30f, -1e30f), cell);
    assert_int_equal(cell[0], 5 * 16 + 10);
    GIVES(stage_find, stage, 4096, 4096, 1, wi, cell);
    GIVES(stage_find, stage, 16, 8, 1, F(0, 0, 0), cell); /* no candidate */
    assert_int_equal(cell[0], 0);
    NO("direction 1 is (0, 0, nan)", stage_find, stage, 1, 1, 2, F(0, 0, 0, 0, 0, NAN), cell);
    const int sides[][2] = {{0, 1}, {1, 0}, {4097, 1}, {1, 4097}, {4096, 4097}};
    for (size_t i = 0; i < N_OF(sides); i++) {
        char text[64];
        snprintf(text, sizeof text, "a field of %d x %d: give 1 to 4096 each", sides[i][0], sides[i][1]);
        NO(text, stage_find, stage, sides[i][0], sides[i][1], 1, unit, cell);
    }
    bis_flat_stage_close(stage);
}

/* A candidate from the white map is accepted with the probability E w / c, where E w, the mean weight, is the 1.5 that
 * the floor reflects, and c is the bound. 6 standard deviations of the share of 64 n candidates are allowed. Each
 * accepted candidate has a ray, because 64 are allowed. The twin: the bound of the other proposal gives another share.
 */
static void rejection_accepts_the_mean_weight_over_the_bound(void **state)
{
    const char *const rejection[] = {"integrator=rejection", "candidates=64", "shadowrays=64", "proposal=em", NULL};
    enum { N = 4000 };
    bis_flat_stage *stage = stage_at(SCENE, 4, 4);
    double bound[2], count[3];

    GIVES(stage_bounds, stage, bound);
    GIVES(stage_accepted, stage, rejection, 1, N, count);
    const double p = 1.5 / bound[0], other = 1.5 / bound[1], allowed = 6 * sqrt(p * (1 - p) / (64. * N));
    assert_true(fabs(count[0] / 64 - p) <= allowed && fabs(other - p) > allowed);
    assert_true(count[1] == 64 && count[2] == count[0]);
    NO("1 estimates: give 2 to 100000", stage_accepted, stage, rejection, 1, 1, count);
    NO("100001 estimates: give 2 to 100000", stage_accepted, stage, rejection, 1, 100001, count);
    bis_flat_stage_close(stage);
}

/* Nothing hides a white map from a floor: which candidates are chosen changes nothing but roundings. A wall hides a
 * part: the noises are uncorrelated, so their squares add up to the square of the whole; the sample's covariance of n =
 * 4000 pairs has a standard deviation of about a b/sqrt(n), and 6 of these, twice, are allowed. The twin: were the
 * noise of the rays left out, the sum would miss by more than that. */
static void the_two_noises_add_up_E31(void **state)
{
    const char *const sir[] = {"integrator=sir", "candidates=16", "shadowrays=2", "proposal=mix", "learn=false", NULL};
    const char *const scenes[2] = {
        SCENE, SCENE "Shape \"trianglemesh\" \"point3 P\" [-3 .3 0  3 .3 0  0 .3 4] \"integer indices\" [0 1 2]\n"};
    bis_flat_stage *stage;
    double sum[5];

    for (int k = 0; k < 2; k++) {
        stage = stage_at(scenes[k], 4, 5);
        GIVES(stage_noises, stage, sir, 7, 4000, sum);
        const double all = sum[1] * sum[1], a = sum[2], b = sum[3], allowed = 12 * a * b / sqrt(4000);
        if (k == 0) assert_true(b < 1e-5 * sum[0]);
        else assert_true(fabs(all - a * a - b * b) <= allowed && fabs(all - a * a) > allowed && fabs(all - b * b) > 0);
        NO("1 estimates: give 2 to 100000", stage_noises, stage, sir, 7, 1, sum);
        NO("100001 estimates: give 2 to 100000", stage_noises, stage, sir, 7, 100001, sum);
        GIVES(stage_noises, stage, sir, 7, 2, sum);
        bis_flat_stage_close(stage);
    }
    NO("the light is a constant: give a map", stage_open, &stage, "scene",
        LIST("text=WorldBegin LightSource \"infinite\" Shape \"sphere\""));
    assert_null(stage);
}

/* Cells that are the map's pixels, of a light that is turned by 90 degrees about x: what is its (x, y, z) is (x, -z, y)
 * in the world. The map's own densities are the other road. Without a lobe q_f and the product follow from the cosine.
 * The wall hides what goes towards +y. */
static void a_field_has_the_frame_of_its_light(void **state)
{
    enum { W = 16, H = 8, N = W * H };
    static const char turned[] = PICTURE EYE "AttributeBegin Rotate 90 1 0 0 " SKY("lamp") "AttributeEnd "
        FLOOR("0.3", "0") WALL;
    float f[4][N + 1], peak[5], world[N][3], local[N][3];
    double pdf[N], most, share[H];
    uint32_t at[N + 1], wanted[N];
    bis_flat_stage *stage = stage_at(turned, 4, 4);
    bis_light *light;

    GIVES(light_open_as, &light, DIR "/lamp.pfm", NONE);
    GIVES(light_density, light, pdf, &most, share);
    for (int k = 0; k < 4; k++) f[k][N] = 7;
    peak[4] = 7, at[N] = 7;
    GIVES(stage_densities, stage, W, H, f[0], f[1], f[2], f[3], peak);
    for (int i = 0; i < N; i++) {
        const double theta = PI * (i / W + 0.5) / H, phi = 2 * PI * (i % W + 0.5) / W;
        const double x = sin(theta) * cos(phi), y = sin(theta) * sin(phi), z = cos(theta), up = fmax(0, y);
        const double lamp = i / W == 2 && i % W / 2 == 1 ? 4 : 1, product = 3 * 0.3 / PI * up * lamp;
        assert_true(f[0][i] == (float)pdf[i] && fabs((double)f[1][i] - up / PI) < 1e-6);
        assert_true(fabs((double)f[2][i] - product) < 1e-6 && f[3][i] == (-z > 0 ? 0 : f[2][i]));
        memcpy(local[i], F((float)x, (float)y, (float)z), sizeof local[i]);
        memcpy(world[i], F((float)(x * 3), (float)(-z * 3), (float)(y * 3)), sizeof world[i]);
    }
    for (int k = 0; k < 4; k++) {
        float largest = 0;
        for (int i = 0; i < N; i++) largest = fmaxf(largest, f[k][i]);
        assert_true(f[k][N] == 7 && peak[k] == largest && largest > 0);
    }
    assert_true(peak[4] == 7 && peak[0] == (float)most);
    GIVES(light_find, light, N, local[0], wanted);
    GIVES(stage_find, stage, W, H, N, world[0], at);
    for (uint32_t i = 0; i < N; i++) assert_true(at[i] == i && wanted[i] == i);
    assert_int_equal(at[N], 7);
    GIVES(stage_find, stage, 1, 1, N, world[0], at);
    for (uint32_t i = 0; i < N; i++) assert_int_equal(at[i], 0);
    bis_flat_stage_close(stage);
    bis_flat_light_close(light);
}

/* The formulas of docs/theory.md, by midpoints of 1024 x 512 cells, 64 x 64 in each pixel, and nothing hidden: mean,
 * standard deviations by balance and best weights, beta, overlap. */
static void best_weights_by_quadrature(double out[5], bis_flat_stage *stage, double n1, double n2)
{
    enum { W = 1024, H = 512 };
    float *f = test_calloc(4 * W * H, sizeof *f), peak[4];
    double a = 0, b1 = 0, b2 = 0, square = 0;
    float most[4] = {0, 0, 0, 0};

    GIVES(stage_densities, stage, W, H, f, f + W * H, f + 2 * W * H, f + 3 * W * H, peak);
    for (int i = 0; i < W * H; i++) {
        const double q1 = (double)f[i], q2 = (double)f[W * H + i], F = (double)f[2 * W * H + i];
        for (int k = 0; k < 4; k++) most[k] = fmaxf(most[k], f[k * W * H + i]);
        const double area = 2 * PI / W * PI / H * sin(PI * (i / W + 0.5) / H), c = n1 * q1 + n2 * q2;
        a += area * q1 * q2 / c;
        b1 += area * q1 * F / c;
        b2 += area * q2 * F / c;
        square += area * F * F / c;
    }
    assert_memory_equal(peak, most, sizeof peak);
    const double balance = square - n1 * b1 * b1 - n2 * b2 * b2, rest = 1 - (n1 + n2) * a;
    out[0] = n1 * b1 + n2 * b2;
    out[1] = sqrt(balance);
    out[2] = sqrt(balance - a * n1 * n2 * (b1 - b2) * (b1 - b2) / rest);
    out[3] = n1 * n2 / (n1 + n2) * (b1 - b2) / rest; /* alpha_1 = n_1 (b_1 - a I)/(1 - N a), less its part along c */
    out[4] = (n1 + n2) * a;
    test_free(f);
}

/* Three roads: the page's formulas by quadrature, runs of `mis` itself, and a white map over a diffuse floor: there F
 * is in proportion to q_f, so the best weights leave no noise. RUNS estimates of 8 samples: a variance has a relative
 * standard error of 1/sqrt(RUNS) times the root of the kurtosis less 1, below 3 here, so half of that for a standard
 * deviation; 6 of these are allowed, and 6 of the mean's. beta and the overlap are means of numbers below 1, too. The
 * twin: the balance heuristic lies farther from the best weights than is allowed. */
static void the_best_weights_are_what_they_say(void **state)
{
    const char *const mis[] = {"integrator=mis", "samples=8", "heuristic=balance", NULL};
    const char *const uneven[] = {"integrator=mis", "samples=8", "split=0.25", NULL};
    enum { RUNS = 40000 };
    const double allowed = 6 * sqrt(3.0) / 2 / sqrt(RUNS);
    bis_flat_stage *stage = stage_at(PICTURE "Sampler \"random\"\n" EYE SKY("lamp")
        FLOOR("0.3", "0.4 \"float exponent\" 20"), 4, 4);
    double sum[5], right[5], runs[3], *L = test_calloc(RUNS, sizeof *L);

    for (int k = 0; k < 2; k++) {
        const char *const *settings = k ? uneven : mis;
        best_weights_by_quadrature(right, stage, k ? 2 : 4, k ? 6 : 4);
        GIVES(stage_mis, stage, settings, 1, RUNS, sum);
        GIVES(stage_runs, stage, settings, 3, RUNS, L, runs);
        assert_true(fabs(sum[0] - right[0]) <= 6 * right[1] / sqrt(RUNS));
        assert_true(fabs(sum[1] / right[1] - 1) <= allowed && fabs(runs[1] / right[1] - 1) <= allowed);
        assert_true(fabs(sum[2] / right[2] - 1) <= allowed && fabs(sum[4] - right[4]) <= allowed);
        assert_true(fabs(sum[3] / right[3] - 1) <= 3 * allowed);
        assert_true(right[1] / right[2] - 1 > 1.5 * allowed);
    }
    NO("integrator \"em\" does not combine two techniques: give mis", stage_mis, stage, LIST("integrator=em"), 1, 100,
        sum);
    NO("1 estimates: give 2 to 1000000", stage_mis, stage, mis, 1, 1, sum);
    NO("1000001 estimates: give 2 to 1000000", stage_mis, stage, mis, 1, 1000001, sum);
    GIVES(stage_mis, stage, mis, 1, 2, sum);
    bis_flat_stage_close(stage);
    stage = stage_at(SCENE, 4, 4);
    GIVES(stage_mis, stage, mis, 1, 1000, sum);
    assert_true(sum[1] > 0.1 && sum[2] < 1e-6); /* directions are floats */
    bis_flat_stage_close(stage);
    test_free(L);
}

/* One step of those that take memory; what it makes is freed. */
static int step_without_memory(int k, void *of)
{
    bis_flat_stage *stage = of;
    static double v[64], x[64];
    static uint32_t i[64], j[64];
    static float f[3 * 64];
    bis_flat_stage *other;

    switch (k) {
    case 0: return bis_flat_stage_candidates(stage, sir64, 1, 64, f, v, i, j, x, SAY);
    case 1: return bis_flat_stage_runs(stage, sir64, 1, 4, v, x, SAY);
    case 2: return bis_flat_stage_mis(stage, LIST("integrator=mis", "samples=4"), 1, 4, v, SAY);
    case 3: return bis_flat_stage_noises(stage, sir64, 1, 4, v, SAY);
    case 4: return bis_flat_stage_accepted(stage, LIST("integrator=rejection"), 1, 4, v, SAY);
    }
    const int status = bis_flat_stage_open(&other, "scene", LIST(SCENE, "threads=1"), SAY);
    assert_true((status == BIS_OK) == (other != NULL));
    bis_flat_stage_close(other);
    return status;
}

static void without_memory_a_step_says_so_and_keeps_none(void **state)
{
    bis_flat_stage *stage = stage_at(SCENE, 4, 4);

    assert_steps_without_memory(step_without_memory, 6, stage);
    bis_flat_stage_close(stage);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_point_of_a_diffuse_floor_is_known),
        cmocka_unit_test(a_pixel_shows_the_point_on_the_floor),
        cmocka_unit_test(candidates_are_known_by_their_directions),
        cmocka_unit_test(runs_are_summed_up_and_the_exact_value_is_of_its_point),
        cmocka_unit_test(a_direction_is_found_in_its_cell),
        cmocka_unit_test(rejection_accepts_the_mean_weight_over_the_bound),
        cmocka_unit_test(the_two_noises_add_up_E31),
        cmocka_unit_test(a_field_has_the_frame_of_its_light),
        cmocka_unit_test(the_best_weights_are_what_they_say),
        cmocka_unit_test(without_memory_a_step_says_so_and_keeps_none),
    };
    return cmocka_run_group_tests_name("flat stage", tests, setup, NULL);
}
