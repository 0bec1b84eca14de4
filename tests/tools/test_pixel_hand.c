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
#include "claim.h"
#include "expect.h"
#include "file_help.h"
#include "further.h"
#include "html_check.h"
#include "json_check.h"
#include "lit.h"
#include "map_help.h"
#include "page_help.h"
#include "program.h"

#include <stdlib.h>
#include <string.h>

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
                            .hit = {.eye = {.d = {0, 0, -1}}, .t = 2.5, .part = 6, .material = &f->l.material},
                            .pt = f->l.pt,
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
    static char *text; /* static, because GCC 12 takes where it points for its own place, and warns */
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

/* `text begin`, `text end`: what stands before, and behind, the words that explain the table of methods. */
static int text_word(const expect_command *c)
{
    static const char explains[] = "error of one: the\n", explained[] = "ask for more --repeats.\n";
    forged f;
    forge(&f);
    char *text = said(&f.r, bis_pixel_print_text);
    if (strcmp(c->arguments, "end") == 0) {
        const char *const from = strstr(text, explained);
        fputs(from ? from : text, c->output);
    } else {
        const char *const to = strstr(text, explains);
        fprintf(c->output, "%.*s", to ? (int)(to - text + (long)sizeof explains - 1) : -1, text);
    }
    free(text);
    clear(&f);
    return 0;
}

static void the_text_knows_other_shapes_and_what_is_not_known(void **state)
{
    forged f;
    char *text;
    forge(&f);
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
        f.r.exact.open.mean[3] = i ? 12 : 0;
        text = said(&f.r, bis_pixel_print_text);
        assert_non_null(strstr(text, i ? "\nseen        0.00 %\n" : "\nseen        -\n")); /* no share of nothing */
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

/* `json`: a line for each key. */
static int json_word(const expect_command *c)
{
    forged f;
    forge(&f);
    f.r.pt.ng = (vec3){0, 1, 0};
    f.r.pt.wo = (vec3){0.5f, 0, 0.75f}; /* in binary */
    f.r.pt.bsdf.r = (vec3){-0.5f, 0, 0.75f};
    f.r.pt.bsdf.p_specular = 0.375;
    f.l.material.Kd = (rgb){0.25f, 0.5f, 0.75f};
    f.l.material.Ks = (rgb){0.125f, 0, 0};
    char *text = json_of(&f.r);
    for (const char *at = text; *at; at++) {
        fputc(*at, c->output);
        if (*at == ',' && (at[1] == '"' || at[1] == '{')) fputc('\n', c->output);
    }
    fputc('\n', c->output);
    free(text);
    clear(&f);
    return 0;
}

static bis_bsdf_width own_width(const bis_material *m)
{
    return (bis_bsdf_width){"spread", "spread", m->alpha, m->alpha, 0, 1};
}

/* The width of a model that calls it otherwise stands under its name. */
static void the_json_has_the_width_of_another_model(void **state)
{
    bis_bsdf_model model = bis_microfacet_model;
    forged f;
    forge(&f);
    f.l.material = bis_microfacet((rgb){0.25f, 0.5f, 0.75f}, (rgb){0.125f, 0, 0}, 0.5);
    f.l.material.model = &model;
    f.r.pt.bsdf.p_specular = 0.375;
    for (int twin = 0; twin < 2; twin++) {
        if (!twin) model.width = own_width;
        else model.width = bis_microfacet_model.width;
        char *text = json_of(&f.r);
        assert_true((strstr(text, "\"alpha\": null,\"p_specular\": 0.375,\"spread\": 0.25}") != NULL) == !twin);
        free(text);
    }
    clear(&f);
}

static void the_json_knows_other_shapes_and_materials(void **state)
{
    forged f;
    forge(&f);
    f.r.exact.by_patches = false;
    f.shape.kind = BIS_SHAPE_SPHERE;
    f.l.material = bis_microfacet((rgb){0.25f, 0.5f, 0.75f}, (rgb){0.125f, 0, 0}, 0.5); /* alpha: roughness squared */
    char *text = json_of(&f.r);
    assert_non_null(
        strstr(text, "\"model\": \"microfacet\",\"Kd\": [0.25,0.5,0.75],\"Ks\": [0.125,0,0],\"exponent\": null,"
                     "\"alpha\": 0.25,\"p_specular\""));
    assert_non_null(strstr(text, "\"shape\": \"sphere\",\"file\": null,\"line\": 8,\"triangle\": null,"));
    assert_non_null(strstr(text, "\"exact\": {\"by\": \"mis\""));
    free(text);
    clear(&f);
}

/* Past all shapes the light's own radiance, where the camera sees it; at a surface that reflects nothing, 0. */
static void nothing_is_said_with_its_radiance(void **state)
{
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
        assert_true(
            list[3].settings.estimator == BIS_ESTIMATOR_RATIO && list[4].settings.estimator == BIS_ESTIMATOR_PLAIN);
    }
}

/* Cell by cell; numbers to 6 digits, since directions are floats. */
static void assert_rows(const char *path, const char *expected)
{
    char *text = read_whole(path);
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
    f.r.candidates.share_em = (double)NAN; /* who drew them cannot be told; no weight */
    f.r.candidates.W = 0;
    for (int i = 0; i < 5; i++) f.c[i].w = 0;
    f.desc.light.filename = NULL;
    f.r.html = true;
    assert_int_equal(bis_pixel_write_files(&f.r, NULL), BIS_OK);
    char *text = read_whole(DIR "/candidates.csv");
    assert_non_null(strstr(text, "\n1,,,,,,,0.5,0.25,0.75,7,0,0,0,\n"));
    bis_free(text);
    text = page_shown(DIR "/pixel.html", DIR);
    if (text)
        page_in_order(
            text, (const char *const[]){"under a constant light; phong, exponent 20, Ks 0, Kd 0.3 (means of r, g, b)",
                      "No candidate weighs anything", NULL});
    free(text);
    clear(&f);
}

/* Each failure has its status and leaves no file under a name of its own behind. */
static void what_cannot_be_written_is_an_error(void **state)
{
    static char long_name[5000];
    static const char *const names[] = {"methods.csv", "candidates.csv", "rays.csv", "pixel.html"};
    forged f;
    bis_diag diag = {0};
    forge(&f);
    f.r.html = true;
    for (int i = 0; i < 4; i++) { /* a folder stands where the file should */
        char path[128];
        snprintf(path, sizeof path, DIR "/%s", names[i]);
        assert_int_equal(system("rm -rf " DIR), 0);
        program_folder(DIR);
        program_folder(path);
        assert_int_equal(bis_pixel_write_files(&f.r, &diag), BIS_IO);
        assert_int_equal(diag.n, 1);
        if (!strstr(diag.messages[0].text, names[i])) fail_msg("%s: %s", names[i], diag.messages[0].text);
        bis_diag_clear(&diag);
        assert_int_equal(system("test $(ls -A " DIR " | grep -vc '^[a-z]*[.]csv$\\|^[a-z]*[.]html$') = 0"), 0);
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
        assert_int_equal(system("test $(ls -A " DIR " | grep -vc '^[a-z]*[.]csv$\\|^[a-z]*[.]html$') = 0"), 0);
    }
    assert_true(k > 5);
    memset(long_name, 'x', sizeof long_name - 1);
    f.r.folder = long_name;
    assert_int_equal(bis_pixel_write_files(&f.r, &diag), BIS_IO);
    assert_non_null(strstr(diag.messages[0].text, "xxx\": the name of the folder is too long"));
    bis_diag_clear(&diag);
    clear(&f);
}

/* ---- the page ---- */

/* The page's data, to be freed. */
static char *page_of(forged *f)
{
    f->r.html = true;
    assert_int_equal(bis_pixel_write_files(&f->r, NULL), BIS_OK);
    char *text = page_data(DIR "/pixel.html");
    assert_true(json_is_valid(text));
    return text;
}

/* The densities at all places, from their codes: [y * 720 + x]. */
static double *sphere_of(const char *text, const char *name)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const size_t size = strlen(text) + 1;
    char *codes = malloc(size), path[32];
    double *q = calloc(720 * 360, sizeof *q);
    const double top = json_number(text, "sphere.top"), decades = json_number(text, "sphere.decades");
    unsigned long bits = 0, byte = 0;
    size_t n = 0;
    snprintf(path, sizeof path, "sphere.%s", name);
    json_value(codes, size, text, path);
    for (size_t i = 1; strchr(digits, codes[i]); i++) { /* behind the quotation mark */
        bits = bits << 6 | (unsigned long)(strchr(digits, codes[i]) - digits);
        if (i % 4 == 1) continue;
        const unsigned long next = bits >> (6 - 2 * ((i - 1) % 4)) & 255;
        const unsigned long code = byte << 8 | next;
        if (n % 2 && code) q[n / 2] = pow(10, top - decades * (1 - (double)(code - 1) / 65534));
        byte = next;
        n++;
    }
    assert_int_equal(n, 2 * 720 * 360);
    free(codes);
    return q;
}

/* Half a step of a code is a factor of 10^(7/65534/2), 1.2e-4, and the sphere holds floats. What is below the scale,
 * here 10^-7, is 0. */
static void assert_density(double q, double expected, int x, int y)
{
    if (expected < 1e-7 ? q != 0 : !(fabs(q / expected - 1) < 1.3e-4))
        fail_msg("(%d, %d): %g, not %g", x, y, q, expected);
}

/* A row is half a degree. The map has 1/(4 pi) everywhere, the BRDF cos/pi, whose integral is 1, the product 0.5 cos/pi
 * over L_ns, said to be 12. Seen is what lies at y <= 0, which are the light's x <= 0: phi from 90 to 270. The scale
 * ends at 1, since 1/pi, the largest, is below that. */
static void the_sphere_has_the_densities_in_the_lights_frame(void **state)
{
    static const char *const names[] = {"map", "brdf", "product", "seen"};
    forged f;
    forge(&f);
    char *text = page_of(&f);
    assert_true(json_number(text, "sphere.top") == 0 && json_number(text, "sphere.decades") == 7);
    assert_true(json_number(text, "sphere.width") == 720 && json_number(text, "sphere.height") == 360);
    for (int k = 0; k < 4; k++) {
        double *q = sphere_of(text, names[k]);
        for (int y = 0; y < 360; y += y >= 176 && y < 184 ? 1 : y == 352 ? 7 : 8) {
            for (int x = 5; x < 720; x += 50) {
                /* the mean over 2 x 2 directions, a quarter of a row away */
                const double at = (y + 0.5) / 360 * PI, cosine = fmax(cos(at) * cos(PI / 1440), 0),
                             product = 0.5 * cosine / PI / 12;
                const double expected[] = {1 / (4 * PI), cosine / PI, product, x > 180 && x < 540 ? product : 0};
                if (y < 179 || y > 180) assert_density(q[y * 720 + x], expected[k], x, y);
            }
        }
        free(q);
    }
    free(text);

    /* dark where it could be reflected: the product is over nothing and stays as it is, 0.5/pi at most */
    f.r.exact.open = (bis_pixel_value){{0}, {0}};
    text = page_of(&f);
    double *q = sphere_of(text, "product");
    assert_density(q[0], 0.5 / PI * cos(0.5 / 360 * PI) * cos(PI / 1440), 0, 0);
    free(q);
    free(text);

    /* the product is the largest: 0.5/pi over 0.001 is 159 */
    f.r.exact.open = (bis_pixel_value){{0, 0, 0, 0.001}, {0}};
    text = page_of(&f);
    assert_true(json_number(text, "sphere.top") == 3);
    free(text);
    clear(&f);
}

/* A map of 2160 x 1080 has 3 x 3 pixels in each place. A lamp in the middle one is seen: of a place's nine directions
 * one meets it, no less and no more. With four directions none would. */
static void a_lamp_of_one_pixel_is_in_its_place(void **state)
{
    enum { X = 100, Y = 120 };
    bis_light_desc desc = bis_light_desc_default();
    bis_image map;
    forged f;
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
    char *text = page_of(&f);
    assert_true(json_number(text, "sphere.top") == ceil(log10(sum / 9)));
    double *q = sphere_of(text, "map");
    assert_density(q[Y * 720 + X], sum / 9, X, Y);
    free(q);
    free(text);
    clear(&f);
}

static void assert_text(const char *text, const char *path, const char *wanted)
{
    char is[64];
    if (strcmp(json_value(is, sizeof is, text, path), wanted) != 0) fail_msg("%s is %s, not %s", path, is, wanted);
}

/* The light is turned by 90 degrees: the eye and the first ray, (0.6, 0, 0.8), are at phi 270 and theta 36.87. The
 * first candidate weighs nothing. */
static void rays_candidates_and_marks_are_those_of_the_report(void **state)
{
    static const struct {
        const char *path;
        double value;
    } numbers[] = {
        {"x", 3}, {"exact.sum", 6}, {"methods.0.sum", 6.5}, {"sphere.n.theta_deg", 0},
        {"sphere.eye.theta_deg", 36.8699},
        {"sphere.eye.phi_deg", 270}, {"sphere.R.phi_deg", 90}, {"shown.0.estimates", 3}, {"shown.0.rays", 2},
        {"shown.2.rays", 1},
        {"shown.3.rays", 0}, {"rays.0.sample", 1}, {"rays.0.theta_deg", 36.8699}, {"rays.0.phi_deg", 270},
        {"rays.1.theta_deg", 180},
        {"rays.0.q_map", 1 / (4 * PI)}, {"rays.0.q_brdf", 0.8 / PI},
        {"candidate_list.0.candidate", 1}, {"candidate_list.0.theta_deg", 90}, {"candidate_list.0.phi_deg", 0},
        {"candidate_list.0.q_map", 0.5}, {"candidate_list.0.q_brdf", 0.25}, {"candidate_list.0.q", 0.75},
        {"candidate_list.0.product", 7}, {"candidate_list.0.weight", 1}, {"candidate_list.0.share", 0.2},
        {"candidate_list.1.chosen", 3}, {"candidate_list.2.phi_deg", 180}};
    forged f;
    forge(&f);
    char *text = page_of(&f);
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        const double is = json_number(text, numbers[i].path);
        if (!(fabs(is - numbers[i].value) <= 1e-5 * fmax(1, fabs(is))))
            fail_msg("%s is %g, not %g", numbers[i].path, is, numbers[i].value);
    }
    const double product = bis_pixel_product(&f.r.pt, f.ray[0].wi);
    assert_true(product > 0 && fabs(json_number(text, "rays.0.product") / product - 1) < 1e-12);
    assert_text(text, "shown.0.too_skew", "false");
    assert_text(text, "shown.1.too_skew", "true"); /* -0.2 */
    assert_text(text, "rays.0.method", "\"em\"");
    assert_text(text, "rays.0.seen", "true");
    assert_text(text, "rays.1.seen", "false");
    assert_text(text, "rays.2.method", "\"sir\"");
    assert_text(text, "candidate_list.0.from", "\"map\"");
    assert_text(text, "candidate_list.0.seen", "null");
    assert_text(text, "candidate_list.1.from", "\"brdf\"");
    assert_text(text, "candidate_list.1.seen", "true");
    assert_text(text, "candidate_list.2.seen", "false");
    assert_text(text, "light", "\"maps/sky.exr\"");
    free(text);
    clear(&f);
}

/* The page shows 4096 rays of each method and 4096 of the candidates that were not chosen, in their order; those that
 * were chosen are beside the limit, and those without weight nowhere. */
static void the_page_has_the_first_of_many(void **state)
{
    enum { MOST = 4096, RAYS = MOST + 2, CANDIDATES = MOST + 6 };
    forged f;
    char path[64];
    forge(&f);
    bis_pixel_ray *rays = bis_alloc(RAYS, sizeof *rays);
    bis_pixel_candidate *c = bis_alloc(CANDIDATES, sizeof *c);
    for (uint32_t i = 0; i < RAYS; i++) rays[i] = (bis_pixel_ray){{0.6f, 0, 0.8f}, i, true};
    for (uint32_t i = 0; i < CANDIDATES; i++)
        c[i] = (bis_pixel_candidate){.wi = {0.6f, 0, 0.8f}, .w = i == 2 ? 0 : 1, .chosen = i == 0 || i == MOST + 5};
    f.r.rays[0] = (bis_pixel_rays){.ray = rays, .n = RAYS, .runs = RAYS};
    f.r.rays[2] = (bis_pixel_rays){.ray = rays, .n = MOST, .runs = MOST};
    f.r.candidates.c = c;
    f.r.candidates.M = CANDIDATES;
    char *text = page_of(&f);
    assert_near(json_number(text, "shown.0.rays"), RAYS, 0);
    static const struct { const char *list, *key; int at; double is; } shown[] = {
        {"rays", "sample", MOST - 1, MOST - 1}, {"rays", "sample", MOST, 0}, {"rays", "sample", 2 * MOST - 1, MOST - 1},
        {"candidate_list", "candidate", 0, 0}, {"candidate_list", "candidate", 2, 3},
        {"candidate_list", "candidate", MOST, MOST + 1}, {"candidate_list", "candidate", MOST + 1, MOST + 5}};
    for (size_t i = 0; i < sizeof shown / sizeof *shown; i++) {
        snprintf(path, sizeof path, "%s.%d.%s", shown[i].list, shown[i].at, shown[i].key);
        if (json_number(text, path) != shown[i].is) fail_msg("%s is %g", path, json_number(text, path));
    }
    assert_text(text, "rays.8192.sample", "");
    assert_text(text, "candidate_list.4098.candidate", "");
    free(text);
    bis_free(rays);
    bis_free(c);
    clear(&f);
}

#define NIGHT "#05050d"
#define DISC(x, y, r, fill) "<circle cx=`" x "` cy=`" y "` r=`" r "` fill=`" fill "`/>"
#define RING(x, y, r, stroke) \
    "<circle cx=`" x "` cy=`" y "` r=`" r "` fill=`none` stroke-width=`1.7` stroke=`" stroke "`/>"

/* Fields begin at (34, 8), two pixels for a degree. A candidate's area is its weight over the mean one: 1, 4, 100 and
 * 0.01 of a sum of 5, where 1 is a radius of 2.4, from 0.9 to 9; the chosen come last, ringed. */
static void the_page_has_dots_where_the_rays_go(void **state)
{
    static const char *const parts[] = {
        "<h1>Pixel (3, 2) of scene.txt</h1>", "under sky.exr; ", "seen at 36.9 degrees", "reflects 6 (r+g+b)", "be 12.",
        "<b>Map: q<sub>L</sub></b>", "eq. 4.2", "<b>BRDF: q<sub>f</sub></b>", "eq. 4.3", "<b>Product: p</b>", "eq. 4.4",
        "<b>Product, seen: p V</b>",
        "L/L<sub>ns</sub> = 0.5", ">n</text>", "text-anchor=`end` class=`p-on`>eye</text>", ">R</text>",
        "data-choose=`em` aria-pressed=`false`", "data-choose=`candidates of sir`", "data-choose=`sir`",
        "data-choose=`all` aria-pressed=`true`",
        "<figure data-panel=`em`>", "<span>2 shadow rays of 3 estimates, 1 saw the light; error of one: 50 %</span>",
        DISC("574", "81.74", "4.8", NIGHT) DISC("574", "81.74", "3.6", "#59ffeb"),
        DISC("34", "368", "4.8", NIGHT) RING("34", "368", "3", "#ff6b52"),
        "<figure data-panel=`candidates of sir`>", "5 drawn, 4 weigh something; effective sample size 2.125",
        DISC("34", "188", "3.6", NIGHT) DISC("34", "188", "2.4", "#59ffeb"), DISC("214", "81.74", "0.9", "#bffa59"),
        DISC("574", "81.74", "4.8", "#bffa59") "<circle cx=`574` cy=`81.74` r=`7.8` fill=`none` stroke=`#fff`",
        DISC("394", "188", "9", "#59ffeb") "<circle cx=`394` cy=`188` r=`12`",
        "<figure data-panel=`sir`>", "<span>1 shadow rays of 1 estimate, 1 saw the light; error of one: 125 %</span>",
        "save this list",
        "<th>1</th><td>36.87</td><td>270</td>", "<td>yes</td>",
        "exact</th><td></td><td>6</td> <td>0.5</td>", "em</th><td>16</td> <td>6.5</td><td>0.25</td><td>1.0833</td>",
        "2.00</td> <td>50 %</td><td>16</td>",
        "rejection plain</th>", "-1.50?</td> <td>–</td>", "sir</th><td>4/64</td> <td>9</td>",
        ">–</td> <td>125 %</td><td>4</td>",
        "unoccluded</th><td>64</td> <td>12</td><td>0.5</td><td>1.0000</td>", "effective sample size", NULL};
    forged f;
    forge(&f);
    free(page_of(&f));
    char *page = page_shown(DIR "/pixel.html#all", DIR);
    if (page) {
        page_in_order(page, parts);
        assert_null(strstr(page, "data-panel=\"rejection"));
        assert_null(strstr(page, "data-panel=\"unoccluded"));
    }
    free(page);
    page = page_shown(DIR "/pixel.html#em", DIR);
    if (page) assert_int_equal(html_count(page, "<figure data-panel"), 1);
    free(page);

    f.r.exact.open = (bis_pixel_value){{0}, {0}};
    f.r.methods[0].error = (double)NAN;
    f.r.n_methods = 1;
    free(page_of(&f));
    page = page_shown(DIR "/pixel.html", DIR); /* without sir the first method is shown */
    if (page)
        page_in_order(
            page, (const char *const[]){"of nothing", "<figure data-panel=`em`>", "1 saw the light</span>", NULL});
    free(page);
    clear(&f);
}

/* A browser without JavaScript gets what the command prints. */
static void without_a_script_the_page_is_the_text(void **state)
{
    forged f;
    char why[200];
    forge(&f);
    free(page_of(&f));
    char *page = read_whole(DIR "/pixel.html");
    if (!html_is_well_formed(page, why, sizeof why)) fail_msg("%s", why);
    if (!html_is_self_contained(page, why, sizeof why)) fail_msg("%s", why);
    page_in_order(
        page, (const char *const[]){"<noscript>", "<pre id=`text`>pixel       (3, 2) of 8 x 4", "one estimate by sir",
                  "/pixel.html methods.csv candidates.csv rays.csv\n</pre>", "</noscript>", NULL});
    bis_free(page);
    clear(&f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_text_knows_other_shapes_and_what_is_not_known),
        cmocka_unit_test(the_json_knows_other_shapes_and_materials),
        cmocka_unit_test(the_json_has_the_width_of_another_model),
        cmocka_unit_test(nothing_is_said_with_its_radiance),
        cmocka_unit_test(each_estimator_has_a_row_of_its_own),
        cmocka_unit_test(tables_have_each_figure_in_its_column),
        cmocka_unit_test(what_cannot_be_written_is_an_error),
        cmocka_unit_test(the_sphere_has_the_densities_in_the_lights_frame),
        cmocka_unit_test(a_lamp_of_one_pixel_is_in_its_place),
        cmocka_unit_test(rays_candidates_and_marks_are_those_of_the_report),
        cmocka_unit_test(the_page_has_the_first_of_many),
        cmocka_unit_test(the_page_has_dots_where_the_rays_go),
        cmocka_unit_test(without_a_script_the_page_is_the_text),
    };
    static const expect_word words[] = {{"text", text_word}, {"json", json_word}, {NULL, NULL}};
    static const expect_text texts[] = {{"folder", DIR}, {NULL, NULL}};
    return expect_run("pixel by hand", tests, sizeof tests / sizeof *tests, NULL, NULL,
                      &(expect_folder){"tests/data/expect/pixel", words, texts});
}
