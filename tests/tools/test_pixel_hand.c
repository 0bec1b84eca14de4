/* SPDX-License-Identifier: BSD-2-Clause */
/* `bis pixel` by hand: a report whose figures stand in this file, in a frame of the light that is turned by 90 degrees
 * about z, under a constant light on a surface that faces z. Text, JSON, tables and drawings say each of them in its
 * place; what is drawn was worked out on paper. */
#include "tools/pixel/pixel_report.h"

#include "bis/base/file.h"
#include "bis/base/mem.h"
#include "bis/scene/light_load.h"
#include "bis/thesis/phong.h"
#include "bis/beyond/microfacet.h"
#include "further.h"
#include "html_check.h"
#include "lit.h"
#include "out/palette.h"
#include "picture_help.h"
#include "program.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define DIR "build/test_pixel_hand"

/* ---- the report ---- */

typedef struct forged {
    lit l;
    bis_shape_desc shape;
    bis_mesh_desc mesh;
    bis_scene_desc desc;
    bis_scene scene;
    bis_pixel_candidate c[5];
    bis_pixel_ray ray[2];
    bis_pixel_report r;
} forged;

static void add_method(bis_pixel_report *r, const char *name, const bis_integrator *integrator, double sum, double se,
                       double error, double z, double skewness, double true_skewness, double rays)
{
    bis_pixel_method *m = &r->methods[r->n_methods++];
    *m = (bis_pixel_method){.settings = bis_settings_default(integrator), .repeats = 50, .L = {{1, 2, 3, sum}, {0.1,
        0.2, 0.3, se}},
                            .error = error, .z = z, .skewness = skewness, .true_skewness = true_skewness,
                                .rays = rays, .accepted = 3.5};
    snprintf(m->name, sizeof m->name, "%s", name);
}

/* f: where all of it stays, since parts point at one another. */
static void forge(forged *f)
{
    const double none = (double)NAN;
    *f = (forged){.shape = {.kind = BIS_SHAPE_PLY, .loc = {"s", 8, 1}}, .mesh = {.filename = (char *)"mesh.ply"}};
    lit_init(&f->l, lit_new_light(LIT_CONSTANT, 1, 1, false), bis_phong((rgb){0.3f, 0.2f, 0.4f}, (rgb){0, 0, 0}, 20),
        (vec3){0, 0, 1}, 0, LIT_HALF);
    f->desc = (bis_scene_desc){.path = (char *)"dir/scene.txt", .shapes = &f->shape, .meshes = &f->mesh,
        .view.film = {.width = 8, .height = 4},
                               .light = {.to_world = bis_xform_rotate(90, 0, 0, 1),
                                   .filename = (char *)"maps/sky.exr", .visible = true},
                               .view.sampler = {.seed = 5}};
    f->scene.light = f->l.light;
    bis_pixel_report *r = &f->r;
    *r = (bis_pixel_report){.desc = &f->desc, .scene = &f->scene, .x = 3, .y = 2, .folder = DIR, .is_hit = true,
        .eye = {.d = {0, 0, -1}},
                            .hit = {.t = 2.5, .part = 6, .material = &f->l.material}, .pt = f->l.pt,
                            .exact = {.by_patches = true, .patches = 100, .rays = 250, .lit = {{1, 2, 3, 6}, {0.1,
                                0.2, 0.3, 0.5}},
                                      .open = {{2, 4, 6, 12}, {0.4, 0.5, 0.6, 0.25}}}};
    r->pt.p = (vec3){1, 2, 3};
    r->pt.wo = (vec3){0.6f, 0, 0.8f};
    bis_bsdf_init(&r->pt.bsdf, &f->l.material, r->pt.n, r->pt.wo);
    add_method(r, "em", &bis_em, 6.5, 0.25, 0.5, 2, 0.05, 0.06, 16);
    add_method(r, "rejection plain", &bis_rejection, 6, 0.5, none, -1.5, 0.05, -0.2, 7.25);
    add_method(r, "sir", &bis_sir, 9, 0.125, 1.25, none, none, none, 4);
    add_method(r, "unoccluded", &bis_unoccluded, 12, 0.5, 0.25, 0.5, -0.2, none, 0);
    r->methods[0].settings.samples = 16;
    r->methods[2].settings.candidates = r->methods[3].settings.candidates = 64;
    r->methods[2].settings.shadowrays = 4;
    r->methods[3].is_open = true;
    /* weights 0, 1, 4, 100 and 0.01 of a sum of 5: an area of 1 is a radius of 2.4, from 0.9 to 9 */
    f->c[0] = (bis_pixel_candidate){.q_L = none, .q_f = none, .q = none};
    f->c[1] = (bis_pixel_candidate){.wi = {0, 1, 0}, .w = 1, .from_map = true, .q_L = 0.5, .q_f = 0.25,
        .q = 0.75, .product = 7};
    f->c[2] = (bis_pixel_candidate){.wi = {0.6f, 0, 0.8f}, .w = 4, .q_L = 1, .q_f = 2, .q = 3, .product = 4,
        .chosen = 3, .seen = true};
    f->c[3] = (bis_pixel_candidate){.wi = {0, -1, 0}, .w = 100, .from_map = true, .q_L = 5, .q_f = 6, .q = 7,
        .product = 8, .chosen = 1};
    f->c[4] = (bis_pixel_candidate){.wi = {-0.6f, 0, 0.8f}, .w = 0.01, .q_L = 9, .q_f = 10, .q = 11,
        .product = 12};
    r->candidates = (bis_pixel_candidates){.M = 5, .N = 4, .c = f->c, .W = 5, .square_sum = 30, .ess = 2.125,
        .largest = 0.625, .share_em = 0.4, .n_map = 2, .positive = 4,
                                           .distinct = 2, .seen = 3, .L = {0.1, 0.2, 0.3}, .L_ns = {0.25, 0.5, 0.75}};
    f->ray[0] = (bis_pixel_ray){{0.6f, 0, 0.8f}, 1, true};
    f->ray[1] = (bis_pixel_ray){{0, 0, -1}, 0, false};
    r->rays[0] = (bis_pixel_rays){.ray = f->ray, .n = 2, .runs = 3};
    r->rays[2] = (bis_pixel_rays){.ray = f->ray, .n = 1, .runs = 1};
}

static void clear(forged *f) { bis_light_free(f->l.light); }

/* ---- text and JSON ---- */

static char *said(const bis_pixel_report *r, void (*print)(FILE *out, const bis_pixel_report *))
{
    char *text;
    size_t n;
    FILE *out = open_memstream(&text, &n);
    print(out, r);
    fclose(out);
    return text;
}

#define HIT "pixel       (3, 2) of 8 x 4, dir/scene.txt\n" \
    "shape       plymesh \"mesh.ply\" of line 8, triangle 6; 2.5 from the eye\n" \
    "point       (1 2 3)\n" \
    "normal      (0 0 1)   in the map: theta 0.00, phi 0.00 degrees\n"
#define SEEN_AT "to the eye  (0.6 0 0.8)   in the map: theta 36.87, phi 270.00 degrees\n" \
    "mirrored    (-0.6 0 0.8)   in the map: theta 36.87, phi 90.00 degrees\n" \
    "material    phong, exponent 20, Kd (0.3 0.2 0.4), Ks (0 0 0); seen at 36.87 degrees\n"

static void the_text_has_each_figure(void **state)
{
    (void)state;
    static const char expected[] = HIT SEEN_AT
        "\nreflected radiance, r+g+b and (r g b), by 250 rays, at least 2 in each patch above the horizon, of 100\n"
        "exact       6 +- 0.5   (1 2 3)\n"
        "unoccluded  12 +- 0.2   (2 4 6)\n"
        "seen        50.00 %\n"
        "\nmethod               draws        mean         +- of exact        z error of one     rays\n"
        "em                      16         6.5       0.25   1.0833    2.00          50 %       16\n"
        "rejection plain     15/800           6        0.5   1.0000   -1.50?            -     7.25\n"
        "sir                   4/64           9       0.12   1.5000        -        125 %        4\n"
        "unoccluded              64          12        0.5   1.0000    0.50?         25 %        0\n"
        "Means of 50 estimates; z: the difference from exact (unoccluded: from that) in standard errors; error of "
            "one: the\n";
    static const char end[] = "ask for more --repeats.\n"
        "\none estimate by sir\n"
        "candidates  5 drawn, 2 from the map, 3 from the BRDF; 4 weigh something\n"
        "weights     sum 5, mean 1 (estimates 12); the largest is 62.5 % of all\n"
        "effective   sample size 2.125 = (sum w)^2 / sum w^2\n"
        "chosen      4 rays at 2 candidates, 3 of them see the light\n"
        "estimate    0.6   (0.1 0.2 0.3)\n"
        "\nwritten     " DIR "/densities.svg samples.svg methods.csv candidates.csv rays.csv\n";
    forged f;
    forge(&f);
    char *text = said(&f.r, bis_pixel_print_text), cut[sizeof expected];
    snprintf(cut, sizeof cut, "%s", text);
    assert_string_equal(cut, expected);
    assert_true(strlen(text) > sizeof end);
    assert_string_equal(text + strlen(text) - strlen(end), end);
    free(text);

    /* what is not known, and other shapes */
    static const struct { bis_shape_kind kind; const char *line; } kinds[] = {{BIS_SHAPE_OBJ,
        "objmesh \"mesh.ply\" of line 8, triangle 6;"},
        {BIS_SHAPE_TRIANGLES, "trianglemesh of line 8, triangle 6;"}, {BIS_SHAPE_SPHERE, "sphere of line 8;"},
            {BIS_SHAPE_DISK, "disk of line 8;"}};
    for (int i = 0; i < 4; i++) {
        f.shape.kind = kinds[i].kind;
        f.r.pt.ng = (vec3){0, 1, 0};
        f.r.exact.by_patches = false;
        f.r.exact.lit.mean[3] = 0;
        f.r.candidates.share_em = (double)NAN;
        f.r.candidates.W = i ? 5 : 0;
        text = said(&f.r, bis_pixel_print_text);
        assert_non_null(strstr(text, kinds[i].line));
        assert_non_null(strstr(text, "of the face (0 1 0)   in the map: theta 90.00, phi 0.00 degrees\n"));
        assert_non_null(strstr(text, "by 16384 runs of mis; 100 patches are too many for their sum\nexact       0 +- "
            "0.5   (1 2 3)\n"));
        assert_non_null(strstr(text, "em                      16         6.5       0.25        -    2.00          50 "
            "%       16\n"));
        assert_non_null(strstr(text, "candidates  5 drawn; 4 weigh something\n"));
        assert_int_equal(strstr(text, "weights     sum 5") != NULL, i > 0);
        free(text);
    }
    clear(&f);
}

#define OWN(sum, se) "\"radiance\": [1,2,3],\"standard_error\": [0.1,0.2,0.3],\"sum\": " \
    "" sum ",\"sum_standard_error\": " se

/* Without the line breaks. */
static char *json_of(const bis_pixel_report *r)
{
    char *text = said(r, bis_pixel_print_json), *to = text;
    for (const char *at = text; *at; at++) {
        if (*at == '\n') at += strspn(at + 1, " ");
        else *to++ = *at;
    }
    *to = '\0';
    return text;
}

static void the_json_has_each_figure(void **state)
{
    (void)state;
    static const char expected[] = "{\"scene\": \"dir/scene.txt\",\"x\": 3,\"y\": 2,\"width\": 8,\"height\": "
        "4,\"seed\": 5,"
        "\"hit\": {\"shape\": \"plymesh\",\"file\": \"mesh.ply\",\"line\": 8,\"triangle\": 6,\"distance\": "
            "2.5,\"point\": [1,2,3],\"normal\": [0,0,1],"
        "\"geometric_normal\": [0,1,0],\"wo\": [0.5,0,0.75],\"mirrored\": [-0.5,0,0.75],\"cos_wo\": "
            "0.75,\"material\": {\"model\": \"phong\","
        "\"Kd\": [0.25,0.5,0.75],\"Ks\": [0.125,0,0],\"exponent\": 20,\"alpha\": null,\"p_specular\": "
            "0.375}},\"nothing\": null,"
        "\"exact\": {\"by\": \"patches\",\"patches\": 100," OWN("6", "0.5") "},"
        "\"unoccluded\": {\"radiance\": [2,4,6],\"standard_error\": [0.4,0.5,0.6],\"sum\": "
            "12,\"sum_standard_error\": 0.25},"
        "\"methods\": [{\"method\": \"em\",\"claim\": \"unbiased\",\"samples\": 16,\"candidates\": "
            "null,\"shadowrays\": null,\"repeats\": 50," OWN("6.5", "0.25")
        ",\"z\": 2,\"skewness\": 0.05,\"relative_error\": 0.5,\"rays\": 16,\"accepted\": null},"
        "{\"method\": \"rejection plain\",\"claim\": \"\\\"plain\\\": unbiased; \\\"ratio\\\": bias O(1/M), more "
            "with fallback \\\"subset\\\" or "
        "\\\"unoccluded\\\"\",\"samples\": null,\"candidates\": 800,\"shadowrays\": 15,\"repeats\": 50," OWN("6", "0.5")
        ",\"z\": -1.5,\"skewness\": 0.05,\"relative_error\": null,\"rays\": 7.25,\"accepted\": 3.5},"
        "{\"method\": \"sir\",\"claim\": \"unbiased for every M, N >= 1\",\"samples\": null,\"candidates\": "
            "64,\"shadowrays\": 4,\"repeats\": 50,"
        OWN("9", "0.125") ",\"z\": null,\"skewness\": null,\"relative_error\": 1.25,\"rays\": 4,\"accepted\": null},"
        "{\"method\": \"unoccluded\",\"claim\": \"biased: without shadows; unbiased for L_ns\",\"samples\": "
            "null,\"candidates\": 64,\"shadowrays\": null,"
        "\"repeats\": 50," OWN("12", "0.5") ",\"z\": 0.5,\"skewness\": -0.2,\"relative_error\": 0.25,\"rays\": "
            "0,\"accepted\": null}],"
        "\"candidates\": {\"drawn\": 5,\"share_of_map\": 0.4,\"positive\": 4,\"weights\": 5,\"squared_weights\": "
            "30,\"effective_sample_size\": 2.125,"
        "\"largest_share\": 0.625,\"shadowrays\": 4,\"distinct\": 2,\"seen\": 3,\"estimate\": "
            "[0.1,0.2,0.3],\"estimate_unoccluded\": [0.25,0.5,0.75]},"
        "\"folder\": \"" DIR "\"}";
    forged f;
    forge(&f);
    f.r.pt.ng = (vec3){0, 1, 0};
    f.r.pt.wo = (vec3){0.5f, 0, 0.75f}; /* in binary */
    f.r.pt.bsdf.r = (vec3){-0.5f, 0, 0.75f};
    f.r.pt.bsdf.p_specular = 0.375;
    f.l.material.Kd = (rgb){0.25f, 0.5f, 0.75f};
    f.l.material.Ks = (rgb){0.125f, 0, 0};
    char *text = json_of(&f.r);
    assert_string_equal(text, expected);
    free(text);

    f.r.exact.by_patches = false;
    f.shape.kind = BIS_SHAPE_SPHERE;
    f.l.material = bis_microfacet((rgb){0.25f, 0.5f, 0.75f}, (rgb){0.125f, 0, 0}, 0.5); /* alpha: roughness squared */
    text = json_of(&f.r);
    assert_non_null(strstr(text, "\"model\": \"microfacet\",\"Kd\": [0.25,0.5,0.75],\"Ks\": [0.125,0,0],\"exponent\": null,"
                                 "\"alpha\": 0.25,\"p_specular\""));
    assert_non_null(strstr(text, "\"shape\": \"sphere\",\"file\": null,\"line\": 8,\"triangle\": null,"));
    assert_non_null(strstr(text, "\"exact\": {\"by\": \"mis\""));
    free(text);
    clear(&f);
}

/* Past all shapes the light's own radiance, where the camera sees it; at a surface that reflects nothing, 0. */
static void nothing_is_said_with_its_radiance(void **state)
{
    (void)state;
    static const struct {
        bool is_hit, visible;
        const char *text, *json;
    } cases[] = {{false, true, "nothing     why: so\nradiance    (1 0.5 0.25), the light's own\n",
        "\"hit\": null,\"nothing\": \"why: so\",\"radiance\": [1,0.5,0.25]}"},
                 {false, false, "nothing     why: so\nradiance    (0 0 0), the light's own\n",
                     "\"hit\": null,\"nothing\": \"why: so\",\"radiance\": [0,0,0]}"},
                 {true, true, HIT SEEN_AT "nothing     why: so\nradiance    (0 0 0)\n",
                     "},\"nothing\": \"why: so\",\"radiance\": [0,0,0]}"}};
    for (int i = 0; i < 3; i++) {
        forged f;
        forge(&f);
        f.r.why_nothing = "why: so";
        f.r.is_hit = cases[i].is_hit;
        f.desc.light.visible = cases[i].visible;
        char *text = said(&f.r, bis_pixel_print_text), *json = json_of(&f.r);
        assert_string_equal(text + strlen(text) - strlen(cases[i].text), cases[i].text);
        assert_string_equal(json + strlen(json) - strlen(cases[i].json), cases[i].json);
        free(text);
        free(json);
        clear(&f);
    }
}

/* Both estimators of rejection, whichever the scene has; its M and N go to all that have them. */
static void each_estimator_has_a_row_of_its_own(void **state)
{
    (void)state;
    static const char *const names[] = {"em", "brdf", "mis", "rejection ratio", "rejection plain", "sir", "unoccluded"};
    for (int plain = 0; plain < 2; plain++) {
        bis_pixel_method list[BIS_PIXEL_MAX_METHODS];
        bis_settings own = bis_settings_default(&bis_rejection);
        own.estimator = plain ? BIS_ESTIMATOR_PLAIN : BIS_ESTIMATOR_RATIO;
        own.candidates = 33;
        own.shadowrays = 5;
        assert_int_equal(bis_pixel_methods(list, &own), 7 + n_further());
        for (int i = 0; i < 7; i++) {
            const bis_settings *const s = &list[i].settings;
            assert_string_equal(list[i].name, names[i]);
            assert_int_equal(list[i].is_open, i == 6);
            if (i >= 3) assert_int_equal(s->candidates, 33);
            if (i >= 3 && i < 6) assert_int_equal(s->shadowrays, 5);
            if (i < 3) assert_int_equal(s->samples, 16);
        }
        assert_true(list[3].settings.estimator == BIS_ESTIMATOR_RATIO && list[4].settings.estimator == BIS_ESTIMATOR_PLAIN);
    }
}

/* ---- files ---- */

static char *read_text(const char *path)
{
    unsigned char *text;
    size_t size;
    assert_int_equal(bis_file_read(&text, &size, path, (bis_loc){0}, NULL), BIS_OK);
    return (char *)text;
}

/* Cell by cell; numbers to 6 digits, since directions are floats. */
static void assert_rows(const char *path, const char *expected)
{
    char *text = read_text(path);
    const char *a = text, *b = expected;
    while (*a || *b) {
        const char *end_a, *end_b;
        const int n = (int)strcspn(a, ",\n"), m = (int)strcspn(b, ",\n");
        const double x = bis_parse_double(a, &end_a), y = bis_parse_double(b, &end_b);
        const bool numbers = n && m && end_a == a + n && end_b == b + m;
        const bool same = numbers ? fabs(x - y) <= 1e-6 * (1 + fabs(y)) : n == m && strncmp(a, b, (size_t)n) == 0;
        if (!same || a[n] != b[m]) fail_msg("%s: \"%.*s\" must be \"%.*s\"", path, (int)strcspn(a, "\n"), a,
            (int)strcspn(b, "\n"), b);
        a += n + (a[n] != '\0');
        b += m + (b[m] != '\0');
    }
    bis_free(text);
}

#define OWN_ROW "1,2,3,"
#define OWN_SE ",0.1,0.2,0.3,"

/* Towards (0.6, 0, 0.8), phi = 270 in the light's frame, the density of the map is 1/(4 pi), of the BRDF 0.8/pi, and
 * the product (0.3 x 1 + 0.2 x 0.5 + 0.4 x 0.25) 0.8/pi. */
#define RAY "36.8698976458,270,0.6,0,0.8,0.0795774715459,0.254647908947,0.127323954474,1\n"

static void tables_have_each_figure_in_its_column(void **state)
{
    (void)state;
    forged f;
    forge(&f);
    program_folder(DIR);
    assert_int_equal(bis_pixel_write_files(&f.r, NULL), BIS_OK);
    assert_rows(DIR "/methods.csv",
                "method,repeats,r,g,b,sum,se_r,se_g,se_b,se_sum,z,skewness,relative_error,rays,accepted\n"
                "exact,," OWN_ROW "6" OWN_SE "0.5,,,,,\n"
                "without visibility,,2,4,6,12,0.4,0.5,0.6,0.25,,,,,\n"
                "em,50," OWN_ROW "6.5" OWN_SE "0.25,2,0.05,0.5,16,\n"
                "rejection plain,50," OWN_ROW "6" OWN_SE "0.5,-1.5,0.05,,7.25,3.5\n"
                "sir,50," OWN_ROW "9" OWN_SE "0.125,,,1.25,4,\n"
                "unoccluded,50," OWN_ROW "12" OWN_SE "0.5,0.5,-0.2,0.25,0,\n");
    assert_rows(DIR "/candidates.csv",
                "candidate,from,theta_deg,phi_deg,x,y,z,q_map,q_brdf,q,product,weight,share,chosen,seen\n"
                "0,brdf,,,,,,,,,0,0,0,0,\n"
                "1,map,90,0,0,1,0,0.5,0.25,0.75,7,1,0.2,0,\n"
                "2,brdf,36.8698976458,270,0.6,0,0.8,1,2,3,4,4,0.8,3,1\n"
                "3,map,90,180,0,-1,0,5,6,7,8,100,20,1,0\n"
                "4,brdf,36.8698976458,90,-0.6,0,0.8,9,10,11,12,0.01,0.002,0,\n");
    assert_rows(DIR "/rays.csv", "method,sample,theta_deg,phi_deg,x,y,z,q_map,q_brdf,product,seen\nem,1," RAY
                "em,0,180,0,0,0,-1,0.0795774715459,0,0,0\nsir,1," RAY);

    /* its title says which pixel, under which map */
    char *text = read_text(DIR "/densities.svg");
    assert_non_null(strstr(text, ">Pixel (3, 2) of scene.txt</text>"));
    assert_non_null(strstr(text, ">under sky.exr; phong, exponent 20, Ks 0, Kd 0.3 (means of r, g, b), seen at 36.9 "
        "degrees</text>"));
    bis_free(text);
    f.r.candidates.share_em = (double)NAN; /* who drew them cannot be told; no weight */
    f.r.candidates.W = 0;
    for (int i = 0; i < 5; i++) f.c[i].w = 0;
    f.desc.light.filename = NULL;
    assert_int_equal(bis_pixel_write_files(&f.r, NULL), BIS_OK);
    text = read_text(DIR "/candidates.csv");
    assert_non_null(strstr(text, "\n1,,,,,,,0.5,0.25,0.75,7,0,0,0,\n"));
    bis_free(text);
    text = read_text(DIR "/samples.svg");
    assert_non_null(strstr(text, ">under a constant light; phong"));
    bis_free(text);
    clear(&f);
}

/* Each failure has its status and leaves no file under a name of its own behind. */
static void what_cannot_be_written_is_an_error(void **state)
{
    (void)state;
    static char long_name[5000];
    static const char *const names[] = {"methods.csv", "candidates.csv", "rays.csv", "densities.svg", "samples.svg"};
    forged f;
    bis_diag diag = {0};
    forge(&f);
    for (int i = 0; i < 5; i++) { /* a folder stands where the file should */
        char path[128];
        snprintf(path, sizeof path, DIR "/%s", names[i]);
        assert_int_equal(system("rm -rf " DIR), 0);
        program_folder(DIR);
        program_folder(path);
        assert_int_equal(bis_pixel_write_files(&f.r, &diag), BIS_IO);
        assert_int_equal(diag.n, 1);
        if (!strstr(diag.messages[0].text, names[i])) fail_msg("%s: %s", names[i], diag.messages[0].text);
        bis_diag_clear(&diag);
        assert_int_equal(system("test $(ls -A " DIR " | grep -vc '^[a-z]*[.]csv$\\|^[a-z]*[.]svg$') = 0"), 0);
    }
    assert_int_equal(system("rm -rf " DIR), 0);
    program_folder(DIR);
    long k = 1;
    for (bool over = false; !over; k += 1 + k / 8) {
        bis_mem_fail_at(k);
        const bis_status status = bis_pixel_write_files(&f.r, NULL);
        over = bis_mem_count() < k;
        bis_mem_fail_at(0);
        assert_int_equal(status, over ? BIS_OK : BIS_NOMEM);
        assert_in_range(k, 1, 2000);
        assert_int_equal(system("test $(ls -A " DIR " | grep -vc '^[a-z]*[.]csv$\\|^[a-z]*[.]svg$') = 0"), 0);
    }
    assert_true(k > 5);
    memset(long_name, 'x', sizeof long_name - 1);
    f.r.folder = long_name;
    assert_int_equal(bis_pixel_write_files(&f.r, &diag), BIS_IO);
    assert_non_null(strstr(diag.messages[0].text, "xxx\": the name of the folder is too long"));
    bis_diag_clear(&diag);
    clear(&f);
}

/* ---- drawings ---- */

static void draw(char *text[2], const forged *f)
{
    const bis_pixel_report *r = &f->r;
    const bis_pixel_figure figure = {.title = "T", .subtitle = "S", .pt = &r->pt, .exact = &r->exact,
        .light_to_world = &f->desc.light.to_world,
                                     .candidates = &r->candidates, .methods = r->methods, .rays = r->rays,
                                         .n_methods = r->n_methods};
    size_t n;
    FILE *out[2] = {open_memstream(&text[0], &n), open_memstream(&text[1], &n)};
    assert_int_equal(bis_pixel_figures(out[0], out[1], &figure, NULL), BIS_OK);
    for (int i = 0; i < 2; i++) fclose(out[i]);
}

static rgb mix(rgb a, rgb b, double share) { return rgb_add(rgb_scale(a, 1 - share), rgb_scale(b, share)); }

/* A step of 1/255 in sRGB is at most 0.009 of linear light. */
static void assert_colour(const bis_image *panel, int x, int y, rgb expected)
{
    const rgb c = panel->pixels[y * panel->width + x];
    const double most = fmax(fmax(fabs((double)(c.r - expected.r)), fabs((double)(c.g - expected.g))),
        fabs((double)(c.b - expected.b)));
    if (most > 0.01) fail_msg("(%d, %d): (%g %g %g), not (%g %g %g)", x, y, (double)c.r, (double)c.g, (double)c.b,
        (double)expected.r, (double)expected.g, (double)expected.b);
}

/* The colour of a density: the scale begins at 10^-7, since 1/pi, the largest, is below 1. */
static rgb heat(double q) { return q > 0 ? bis_palette_heat(1 + log10(q) / 7) : bis_palette_srgb(0.02, 0.02, 0.05); }

/* A row of the plot is half a degree. The map has 1/(4 pi) everywhere, the BRDF cos/pi, whose integral is 1, the
 * product 0.5 cos/pi over L_ns, said to be 12. Seen is what lies at y <= 0, which are the light's x <= 0: phi from 90
 * to 270. The horizon lies between the rows 179 and 180, half a row from the middle of each: a line of 0.75 (1.1 -
 * 0.5). */
static void panels_have_the_densities_in_the_lights_frame(void **state)
{
    (void)state;
    static const char *const names[] = {"map", "brdf", "product", "seen"};
    const rgb line = bis_palette_srgb(0.85, 0.9, 1);
    forged f;
    char *text[2];
    forge(&f);
    draw(text, &f);
    for (int k = 0; k < 5; k++) { /* the ground of the samples is the product in grey */
        bis_image panel;
        picture_in(&panel, text[k == 4], names[k < 4 ? k : 2]);
        for (int y = 0; y < 360; y += y >= 176 && y < 184 ? 1 : y == 352 ? 7 : 8) {
            for (int x = 5; x < 720; x += 50) {
                const double cosine = fmax(cos(PI * (y + 0.5) / 360), 0), product = 0.5 * cosine / PI / 12;
                const double q[] = {1 / (4 * PI), cosine / PI, product, x > 180 && x < 540 ? product : 0};
                rgb colour = k < 4 ? heat(q[k]) : heat(0);
                if (k == 4 && product > 0) {
                    const double t = 1 + log10(product) / 7;
                    colour = bis_palette_srgb(0.05 + 0.72 * t, 0.05 + 0.73 * t, 0.09 + 0.76 * t);
                }
                assert_colour(&panel, x, y, y == 179 || y == 180 ? mix(colour, line, 0.45) : colour);
            }
        }
        bis_image_clear(&panel);
    }
    for (int i = 0; i < 2; i++) free(text[i]);
    clear(&f);
}

/* A map of 2160 x 1080 has 3 x 3 pixels in each place. A lamp in the middle one is seen: of a place's nine directions one
 * meets it, no less and no more. With four directions none would. */
static void a_lamp_of_one_pixel_is_in_its_place(void **state)
{
    (void)state;
    enum { X = 100, Y = 120 };
    bis_light_desc desc = bis_light_desc_default();
    bis_image map, panel;
    forged f;
    char *text[2];
    forge(&f);
    bis_light_free(f.l.light);
    desc.to_world = f.desc.light.to_world;
    assert_int_equal(bis_image_init(&map, 2160, 1080, NULL), BIS_OK);
    for (size_t i = 0; i < 2160 * 1080; i++) map.pixels[i] = (rgb){1, 1, 1};
    map.pixels[(3 * Y + 1) * 2160 + 3 * X + 1] = (rgb){1e5f, 1e5f, 1e5f};
    assert_int_equal(bis_light_from_image(&f.l.light, &map, &desc, BIS_NEED_TABLE, NULL), BIS_OK);
    f.r.pt.light = f.scene.light = f.l.light;
    double sum = 0, most = 0;
    for (int i = 0; i < 9; i++) {
        const double theta = PI * (Y + (i / 3 + 0.5) / 3) / 360, phi = 2 * PI * (X + (i % 3 + 0.5) / 3) / 720;
        const vec3 w = vec3_from(sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta));
        const double q = bis_light_pdf(f.l.light, bis_xform_vector(&f.desc.light.to_world, w));
        sum += q;
        most = fmax(most, q);
    }
    assert_true(most > 0.9 * sum);
    draw(text, &f);
    picture_in(&panel, text[0], "map");
    const double top = ceil(log10(sum / 9));
    assert_colour(&panel, X, Y, bis_palette_heat(1 + (log10(sum / 9) - top) / 7));
    bis_image_clear(&panel);
    for (int i = 0; i < 2; i++) free(text[i]);
    clear(&f);
}

static void assert_in_order(const char *text, const char *const *parts, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        const char *at = strstr(text, parts[i]);
        if (!at) fail_msg("%s is not in\n%.3000s", parts[i], text);
        text = at + strlen(parts[i]);
    }
}

#define ASSERT_IN_ORDER(text, parts) assert_in_order(text, parts, sizeof parts / sizeof *parts)
#define NIGHT "#05050d"
#define FAINT "#737885"
#define INK "#1f2129"
#define SEEN "#59ffeb"
#define HIDDEN "#ff6b52"
#define BRDF "#bffa59"
#define DISC(x, y, r, fill) "<circle cx=\"" x "\" cy=\"" y "\" r=\"" r "\" fill=\"" fill "\"/>\n"
#define RING(x, y, r, stroke, width) "<circle cx=\"" x "\" cy=\"" y "\" r=\"" r "\" stroke=\"" stroke "\" " \
    "stroke-width=\"" width "\" fill=\"none\"/>\n"
#define LINE(path, stroke, width) "<path d=\"" path "\" stroke=\"" stroke "\" stroke-width=\"" width "\" " \
    "fill=\"none\"/>\n"
#define TEXT(x, y, size, anchor, fill, text) "<text x=\"" x "\" y=\"" y "\" font-size=\"" size "\"" anchor " " \
    "fill=\"" fill "\">" text "</text>\n"
#define END " text-anchor=\"end\""
#define MIDDLE " text-anchor=\"middle\""
#define ON " stroke=\"" NIGHT "\" stroke-width=\"4\" paint-order=\"stroke\""

/* Marks of a panel at (56, 110): n at (0, 0), its name inside; the eye at phi 270, theta 36.87: (540, 73.74); R at phi
 * 90, (180, 73.74). Texts are 1/0.72 of their capitals. */
static void densities_have_marks_axes_and_words(void **state)
{
    (void)state;
    static const char *const parts[] = {
        "width=\"1696\" height=\"984\" viewBox=\"0 0 1696 984\"",
            /* 56 + 2 x 720 + 64 + 96 + 40; 84 + 2 x 430 + 66 - 26 */
        TEXT("56", "36", "23.61", "", INK, "T"), TEXT("56", "62", "14.58", "", FAINT, "S"),
        "<image id=\"map\" width=\"720\" height=\"360\"",
        TEXT("56", "101", "16.67", "", INK, "Map: q<tspan dy=\"3\" font-size=\"11.67\">L</tspan>"),
        TEXT("776", "101", "13.19", END, FAINT, "importance by which directions are drawn from it, eq. 4.2"),
        "<use href=\"#map\" x=\"56\" y=\"110\"/>\n",
        LINE("M56 471L56 475", FAINT, "1") TEXT("56", "487", "11.11", MIDDLE, FAINT, "0"),
        LINE("M236 471L236 475", FAINT, "1") TEXT("236", "487", "11.11", MIDDLE, FAINT, "90"),
        LINE("M776 471L776 475", FAINT, "1") TEXT("776", "487", "11.11", MIDDLE, FAINT, "360"),
        LINE("M51 110L55 110", FAINT, "1") TEXT("48", "114", "11.11", END, FAINT, "0"),
        LINE("M51 200L55 200", FAINT, "1") TEXT("48", "204", "11.11", END, FAINT, "45"),
        LINE("M51 470L55 470", FAINT, "1") TEXT("48", "474", "11.11", END, FAINT, "180"),
        LINE("M60 110L65 110", NIGHT, "4"),
        "<text x=\"64\" y=\"126\" font-size=\"13.89\" fill=\"#ffffff\"" ON ">n</text>\n",
        LINE("M600 183.74L605 183.74", NIGHT, "4") LINE("M592 183.74L587 183.74", NIGHT,
            "4") LINE("M596 187.74L596 192.74", NIGHT, "4")
        LINE("M596 179.74L596 174.74", NIGHT, "4") LINE("M600 183.74L605 183.74", "#ffffff",
            "1.5") LINE("M592 183.74L587 183.74", "#ffffff", "1.5")
        LINE("M596 187.74L596 192.74", "#ffffff", "1.5") LINE("M596 179.74L596 174.74", "#ffffff", "1.5")
        "<text x=\"591\" y=\"177.74\" font-size=\"13.89\" text-anchor=\"end\" fill=\"#ffffff\"" ON ">eye</text>\n",
        "<text x=\"244\" y=\"199.74\" font-size=\"13.89\" fill=\"#ffffff\"" ON ">R</text>\n",
        "<image id=\"brdf\"", "f cos over its integral, eq. 4.3", "<use href=\"#brdf\" x=\"840\" y=\"110\"/>\n",
        LINE("M1384 183.74L1389 183.74", NIGHT, "4"), /* the eye, 784 further */
        "<image id=\"product\"", "f cos L over L", "<use href=\"#product\" x=\"56\" y=\"540\"/>\n",
            LINE("M600 613.74L605 613.74", NIGHT, "4"),
        "<image id=\"seen\"", "Product, seen: p V", "what no surface hides: L/L", " = 0.5</t",
            "<use href=\"#seen\" x=\"840\" y=\"540\"/>\n",
        "<rect x=\"1594\" y=\"110\" width=\"18\" height=\"4\"", "<rect x=\"1594\" y=\"467\" width=\"18\" height=\"3\"",
        LINE("M1612 110L1617 110", INK, "1"), "<text x=\"1622\" y=\"115\" font-size=\"13.19\" fill=\"" INK "\">10",
            ">0</tspan></text>\n",
        LINE("M1612 161.43L1617 161.43", INK, "1"), ">-1</tspan></text>\n", LINE("M1612 470L1617 470", INK, "1"),
            ">-7</tspan></text>\n",
        TEXT("1594", "494", "13.19", "", INK, "1/sr"),
        "<text x=\"56\" y=\"962\" font-size=\"13.19\" fill=\"" FAINT "\">Directions in the map",
    };
    forged f;
    char *text[2];
    forge(&f);
    draw(text, &f);
    ASSERT_IN_ORDER(text[0], parts);
    assert_int_equal(html_count(text[0], "<rect x=\"1594\""), 120);
    for (int i = 0; i < 2; i++) free(text[i]);
    /* close to the right and the lower border names stand at the other side: theta 175, phi 350, in the world phi 80 */
    f.r.pt.bsdf.r = vec3_from(sin(175 * PI / 180) * cos(80 * PI / 180), sin(175 * PI / 180) * sin(80 * PI / 180),
        cos(175 * PI / 180));
    draw(text, &f);
    const char *at = strstr(text[0], ">R</text>");
    double x, y;
    while (strncmp(at, "<text", 5) != 0) at--;
    assert_int_equal(sscanf(at, "<text x=\"%lf\" y=\"%lf\" font-size=\"13.89\" text-anchor=\"end\"", &x, &y), 2);
    assert_true(fabs(x - (56 + 700 - 5)) < 0.02 && fabs(y - (110 + 350 - 6)) < 0.02);
    for (int i = 0; i < 2; i++) free(text[i]);
    clear(&f);
}

/* Where the first of these texts stands on the page, and whether it ends there. */
static void text_place(const char *page, const char *end, double *x, double *y, bool *is_end)
{
    const char *at = strstr(page, end);
    assert_non_null(at);
    while (strncmp(at, "<text", 5) != 0) at--;
    assert_int_equal(sscanf(at, "<text x=\"%lf\" y=\"%lf\"", x, y), 2);
    const char *anchor = strstr(at, "text-anchor=\"end\"");
    *is_end = anchor && anchor < strchr(at, '>');
}

/* Three marks at one place, far from the borders: phi 180, theta 90, (416, 290) on the page. Their names stand around
 * it: n above at the right, the eye above at the left, R below at the right. */
static void names_of_marks_that_meet_stand_apart(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        double x, y;
        bool is_end;
    } names[] = {{">n</text>", 416 + 8, 290 - 6, false}, {">eye</text>", 416 - 5, 290 - 6, true},
                 {">R</text>", 416 + 8, 290 + 16, false}};
    forged f;
    char *text[2];
    forge(&f);
    f.r.pt.n = f.r.pt.wo = f.r.pt.bsdf.r = (vec3){0, -1, 0};
    draw(text, &f);
    for (int i = 0; i < 3; i++) {
        double x, y;
        bool is_end;
        text_place(text[0], names[i].text, &x, &y, &is_end);
        if (!(fabs(x - names[i].x) < 0.02 && fabs(y - names[i].y) < 0.02 && is_end == names[i].is_end))
            fail_msg("%s: at (%g, %g)", names[i].text, x, y);
    }
    for (int i = 0; i < 2; i++) free(text[i]);
    clear(&f);
}

/* The bar's boxes have the colours of the scale from its top. */
static void the_bar_is_the_scale(void **state)
{
    (void)state;
    forged f;
    char *text[2];
    forge(&f);
    draw(text, &f);
    for (int k = 0; k < 2; k++) {
        const char *at = text[k];
        for (int j = 0; j < 120; j++) {
            int y;
            unsigned c[3];
            at = strstr(at, "<rect x=\"1594\"");
            assert_non_null(at);
            assert_int_equal(sscanf(at, "<rect x=\"1594\" y=\"%d\" width=\"18\" height=\"%*d\" fill=\"#%2x%2x%2x\"",
                &y, &c[0], &c[1], &c[2]), 4);
            assert_int_equal(y, 110 + 3 * j);
            const double t = 1 - (j + 0.5) / 120;
            const rgb said = bis_palette_srgb(c[0] / 255.0, c[1] / 255.0, c[2] / 255.0);
            const rgb right = k ? bis_palette_srgb(0.05 + 0.72 * t, 0.05 + 0.73 * t,
                0.09 + 0.76 * t) : bis_palette_heat(t);
            assert_true(fabs((double)(said.r - right.r)) < 0.005 && fabs((double)(said.g - right.g)) < 0.005);
            assert_true(fabs((double)(said.b - right.b)) < 0.005);
            at++;
        }
        free(text[k]);
    }
    clear(&f);
}

/* Panels: em at (56, 110); the candidates, of which rejection plain and unoccluded have none, at (840, 110); sir's rays
 * at (56, 540). Those not chosen come first. */
static void samples_have_dots_where_the_rays_go(void **state)
{
    (void)state;
    static const char *const parts[] = {
        "width=\"1696\" height=\"984\"",
        ">em</text>\n", TEXT("776", "101", "13.19", END, FAINT, "2 shadow rays of 3 estimates; error of one: 50 %"),
        "<use href=\"#product\" x=\"56\" y=\"110\"/>\n",
        DISC("596", "183.74", "4.9", NIGHT) DISC("596", "183.74", "3.6", SEEN),
        DISC("56", "470", "4.9", NIGHT) RING("56", "470", "3", HIDDEN, "1.7"),
        ">candidates of sir</text>\n", TEXT("1560", "101", "13.19", END, FAINT,
            "5 drawn, 4 weigh something; effective sample size 2.125"),
        "<use href=\"#product\" x=\"840\" y=\"110\"/>\n",
        DISC("840", "290", "3.7", NIGHT) DISC("840", "290", "2.4", SEEN) /* phi 0, theta 90 */
        DISC("1020", "183.74", "2.2", NIGHT) DISC("1020", "183.74", "0.9", BRDF)
        DISC("1380", "183.74", "6.1", NIGHT) DISC("1380", "183.74", "4.8", BRDF) RING("1380", "183.74", "7.8",
            "#ffffff", "1.5")
        DISC("1200", "290", "10.3", NIGHT) DISC("1200", "290", "9", SEEN) RING("1200", "290", "12", "#ffffff", "1.5"),
        ">sir</text>\n", TEXT("776", "531", "13.19", END, FAINT, "1 shadow rays of 1 estimate; error of one: 125 %"),
        "<use href=\"#product\" x=\"56\" y=\"540\"/>\n",
        DISC("596", "613.74", "4.9", NIGHT) DISC("596", "613.74", "3.6", SEEN),
        "<rect x=\"1594\"",
        DISC("60", "958", "4.9", NIGHT) DISC("60", "958", "3.6", SEEN) TEXT("70", "962", "13.19", "", FAINT,
            "ray that saw the light")
        DISC("240", "958", "4.9", NIGHT) RING("240", "958", "3", HIDDEN, "1.7") TEXT("250", "962", "13.19", "", FAINT,
            "ray that was blocked")
        TEXT("420", "962", "13.19", "", FAINT, "Candidates, area by weight:")
        DISC("630", "958", "4.9", NIGHT) DISC("630", "958", "3.6", SEEN) TEXT("640", "962", "13.19", "", FAINT,
            "from the map")
        DISC("760", "958", "4.9", NIGHT) DISC("760", "958", "3.6", BRDF)
        TEXT("770", "962", "13.19", "", FAINT, "from the BRDF, ringed: chosen. Ground: the product p."),
        "</svg>\n",
    };
    forged f;
    char *text[2];
    forge(&f);
    draw(text, &f);
    ASSERT_IN_ORDER(text[1], parts);
    assert_int_equal(html_count(text[1], "<use "), 3);
    assert_null(strstr(text[1], "rejection"));
    for (int i = 0; i < 2; i++) free(text[i]);

    f.r.n_methods = 1; /* one panel, a row less */
    f.r.methods[0].error = (double)NAN;
    f.r.exact.open = (bis_pixel_value){{0}, {0}};
    draw(text, &f);
    assert_non_null(strstr(text[1], "width=\"1696\" height=\"554\""));
    assert_non_null(strstr(text[1], ">2 shadow rays of 3 estimates</text>"));
    assert_non_null(strstr(text[0], "what no surface hides: of nothing"));
    /* what is over nothing stays as it is: the product is 0.5/pi at most, the BRDF 1/pi, and the scale ends at 1 */
    assert_non_null(strstr(text[0], " y=\"115\" font-size=\"13.19\" fill=\"" INK "\">10<tspan dy=\"-5.23\" "
                                    "font-size=\"9.24\">0</tspan>"));
    for (int i = 0; i < 2; i++) free(text[i]);

    f.r.n_methods = 3; /* the last one has a panel: em, sir's candidates, sir */
    draw(text, &f);
    assert_non_null(strstr(text[1], "width=\"1696\" height=\"984\""));
    assert_int_equal(html_count(text[1], "<use "), 3);
    for (int i = 0; i < 2; i++) free(text[i]);
    clear(&f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_text_has_each_figure),
        cmocka_unit_test(the_json_has_each_figure),
        cmocka_unit_test(nothing_is_said_with_its_radiance),
        cmocka_unit_test(each_estimator_has_a_row_of_its_own),
        cmocka_unit_test(tables_have_each_figure_in_its_column),
        cmocka_unit_test(what_cannot_be_written_is_an_error),
        cmocka_unit_test(panels_have_the_densities_in_the_lights_frame),
        cmocka_unit_test(a_lamp_of_one_pixel_is_in_its_place),
        cmocka_unit_test(densities_have_marks_axes_and_words),
        cmocka_unit_test(names_of_marks_that_meet_stand_apart),
        cmocka_unit_test(the_bar_is_the_scale),
        cmocka_unit_test(samples_have_dots_where_the_rays_go),
    };
    return cmocka_run_group_tests_name("pixel by hand", tests, NULL, NULL);
}
