/* SPDX-License-Identifier: BSD-2-Clause */
/* identity: each field of the scene, the view and the options that a picture depends on changes one part of the
 * identity, and that part alone; what a picture does not depend on changes none. The fields are changed one at a time,
 * in their lowest bit. */
#include "render/identity.h"

#include "claim.h"
#include "world.h"

#include "bis/thesis/light.h"

#include <ctype.h>
#include <glob.h>
#include <stdio.h>
#include <string.h>

#define COUNT(a) (sizeof(a) / sizeof *(a))

/* The parts in their order, by the words of messages. */
enum {
    NONE = -1,
    SIZE,
    LAYERS,
    CAMERA,
    SAMPLER,
    DIVISION,
    JITTER,
    SETTINGS,
    SHAPES,
    MATERIALS,
    MAP,
    LIGHT,
    ACCELERATOR
};

/* A render of which everything is known: no field that counts is 0 beside one that is not. */
typedef struct known {
    world w;
    bis_film film;
    bis_view view;
    bis_render_options options;
    bis_workspace of;
    unsigned char edge;
    vec3 p[4], n[4];
    bis_uv uv[4];
    uint32_t index[6];
    bis_range ranges[2];
    bis_quadric quadrics[2];
    bis_texture list[2];
    bis_material_textures of_material[2];
    bis_texture_image images[2];
    rgb texels[2][6];
} known;

static void fill_xform(bis_xform *x, double first)
{
    for (int i = 0; i < 16; i++) x->m[i / 4][i % 4] = first + i;
}

static void fill_geometry(known *k)
{
    for (int i = 0; i < 4; i++) {
        const float v = (float)(10 * i);
        k->p[i] = (vec3){v + 1, v + 2, v + 3};
        k->n[i] = (vec3){v + 4, v + 5, v + 6};
        k->uv[i].u = v + 7, k->uv[i].v = v + 8;
    }
    for (uint32_t i = 0; i < 6; i++) k->index[i] = i % 4;
    for (uint32_t i = 0; i < 2; i++) {
        k->ranges[i] = (bis_range){i, 5 + i, i};
        k->quadrics[i] = (bis_quadric){.kind = BIS_DISK, .radius = 3 + i, .height = 6 + i, .material = 9 + i};
        fill_xform(&k->quadrics[i].to_world, 20 + 100 * i);
    }
    k->w.scene.geometry = (bis_geometry){.p = k->p, .n = k->n, .uv = k->uv, .index = k->index, .n_vertices = 4,
                                         .n_triangles = 2, .ranges = k->ranges, .n_ranges = 2,
                                         .quadrics = k->quadrics, .n_quadrics = 2};
}

static void fill_textures(known *k)
{
    for (uint32_t i = 0; i < 2; i++) {
        const double v = 100 * (i + 1);
        bis_texture *t = &k->list[i];
        *t = (bis_texture){.kind = BIS_TEXTURE_MIX, .of = {1 + i, 2 + i, 3 + i}, .value = {v + 1, v + 2, v + 3},
                           .mapping = BIS_TEXTURE_PLANAR, .factor = {v + 4, v + 5}, .offset = {v + 6, v + 7},
                           .image = 4 + i, .wrap = BIS_WRAP_BLACK, .scale = v + 8};
        for (int j = 0; j < 12; j++) t->from_world[j / 4][j % 4] = v + 10 + j;
        k->of_material[i] = (bis_material_textures){.Kd = 7 + i, .Ks = 8 + i, .width = 9 + i, .power = v + 30};
        k->images[i].image = (bis_image){.width = 3, .height = 2, .pixels = k->texels[i]};
        for (int j = 0; j < 6; j++) {
            const float c = (float)(10 * j);
            k->texels[i][j] = (rgb){c + 1, c + 2, c + 3};
        }
    }
    k->w.desc.textures = (bis_textures){.list = k->list, .n = 2, .of_material = k->of_material, .n_of_material = 2};
    k->w.scene.images = k->images;
    k->w.scene.n_images = 2;
}

/* k must stay where it is. */
static void fill(known *k)
{
    *k = (known){.edge = 1};
    make_world(&k->w, &bis_sir);
    bis_geometry_clear(&k->w.scene.geometry);
    fill_geometry(k);
    fill_textures(k);
    k->w.desc.light.width = 4;
    k->w.desc.light.has_table_kind = true;
    k->w.desc.accel.density = 2;
    for (int i = 0; i < 2; i++) {
        k->w.materials[i].eta = (rgb){1.5f, 2.5f, 3.5f};
        k->w.materials[i].alpha = 0.5;
    }
    k->view = k->w.desc.view;
    k->view.edge_samples = 3;
    k->view.edge_light = 0.5;
    k->view.camera.has_screen = true;
    k->view.camera.frame_aspect = 2;
    for (int i = 0; i < 4; i++) k->view.camera.screen[i] = 1 + i;
    k->film = (bis_film){.full_width = 40, .full_height = 30, .step = 2, .picture_width = 80, .picture_height = 60,
                         .x0 = 4, .y0 = 6, .width = 20, .height = 10, .layers.asked = 5};
    k->options = (bis_render_options){.budget.error = 0.25, .pass_size = 4, .n_threads = 2};
    k->of = (bis_workspace){.scene = &k->w.scene, .desc = &k->w.desc, .view = &k->view, .options = &k->options,
                            .film = &k->film, .edge = &k->edge};
}

static void clear(known *k)
{
    k->w.scene.geometry = (bis_geometry){0};
    k->w.scene.images = NULL;
    k->w.scene.n_images = 0;
    k->w.desc.textures = (bis_textures){0};
    clear_world(&k->w);
}

/* A field changes the named part alone; NONE: it changes none. */
static void expect(const known *k, void *field, int part, const char *name)
{
    unsigned char *byte = field;
    uint64_t before[BIS_IDENTITY_PARTS], after[BIS_IDENTITY_PARTS];

    bis_identify(before, &k->of);
    *byte ^= 1;
    bis_identify(after, &k->of);
    *byte ^= 1;
    for (int i = 0; i < BIS_IDENTITY_PARTS; i++)
        if ((before[i] != after[i]) != (i == part)) fail_msg("%s: part %d", name, i);
}

#define EXPECT(field, part) expect(k, &(field), part, #field)

static void expect_rgb(const known *k, rgb *c, int part, const char *name)
{
    expect(k, &c->r, part, name);
    expect(k, &c->g, part, name);
    expect(k, &c->b, part, name);
}

static void expect_vector(const known *k, vec3 *v, const char *name)
{
    expect(k, &v->x, SHAPES, name);
    expect(k, &v->y, SHAPES, name);
    expect(k, &v->z, SHAPES, name);
}

/* The tables of fields, in their order, beside the things of this render and the part that each is of. */
static void each_field_of_the_tables_counts(void **state)
{
    known own, *k = &own;
    const struct {
        const char *type;
        void *of;
        int part;
    } things[] = {
        {"bis_film", &k->film, SIZE}, {"bis_camera", &k->view.camera, CAMERA},
        {"bis_sampler", &k->view.sampler, SAMPLER}, {"bis_sampler", &k->view.sampler, DIVISION},
        {"bis_view", &k->view, JITTER},
        {"bis_quadric", &k->quadrics[1], SHAPES}, {"bis_material_textures", &k->of_material[1], MATERIALS},
        {"bis_texture", &k->list[1], MATERIALS}, {"bis_light_desc", &k->w.desc.light, LIGHT},
        {"bis_accel_options", &k->w.desc.accel, ACCELERATOR}};
    size_t n = 0;
    fill(k);
    for (const bis_identity_struct *s = bis_identity_structs; s->type; s++) {
        if (!s->fields->name) continue; /* by hand, below */
        assert_true(n < COUNT(things));
        assert_string_equal(s->type, things[n].type);
        for (const bis_field *f = s->fields; f->name; f++)
            for (size_t i = 0; i < f->n; i++)
                if (things[n].part != SAMPLER || strcmp(f->name, "kind") != 0) /* which divides a pixel or not, below */
                    expect(k, (char *)things[n].of + f->offset + i * f->bytes, things[n].part, f->name);
        n++;
    }
    assert_int_equal(n, COUNT(things));
    clear(k);
}

static void each_other_field_of_the_view_counts(void **state)
{
    known own, *k = &own;
    bis_view *v = &own.view;
    fill(k);
    EXPECT(k->film.layers.asked, LAYERS);
    EXPECT(k->options.pass_size, JITTER);
    EXPECT(v->settings.candidates, SETTINGS);
    EXPECT(v->settings.shadowrays, SETTINGS);
    EXPECT(v->settings.proposal, SETTINGS);
    EXPECT(v->settings.as_printed, SETTINGS);
    EXPECT(v->settings.samples, NONE); /* sir reads none */
    EXPECT(k->options.n_threads, NONE);
    EXPECT(k->film.passes, NONE);

    /* what nothing reads, and what is not there */
    v->camera.has_screen = false;
    for (int i = 0; i < 4; i++) EXPECT(v->camera.screen[i], NONE);
    k->of.edge = NULL;
    EXPECT(v->edge_samples, NONE);
    EXPECT(v->edge_light, NONE);
    k->view.sampler.kind = BIS_SAMPLER_SOBOL; /* divides no pixel */
    EXPECT(v->sampler.spp, NONE);
    clear(k);
}

/* An error that is asked for decides only when a render ends. */
static void an_error_that_is_asked_for_does_not_count(void **state)
{
    known own, *k = &own;
    uint64_t none[BIS_IDENTITY_PARTS], some[BIS_IDENTITY_PARTS];
    fill(k);
    bis_identify(some, &k->of);
    k->options.budget.error = 0;
    bis_identify(none, &k->of);
    assert_memory_equal(some, none, sizeof some);
    clear(k);
}

/* The camera samples that divide a pixel count where the sampler divides one, and the cells of "stratified". */
static void camera_samples_count_where_they_divide_a_pixel(void **state)
{
    static const struct {
        bis_sampler_kind kind;
        bool divides;
    } kinds[] = {{BIS_SAMPLER_STRATIFIED, true}, {BIS_SAMPLER_HALTON, true}, {BIS_SAMPLER_SOBOL, false},
                 {BIS_SAMPLER_RANDOM, false}};
    known own, *k = &own;
    uint64_t first[BIS_IDENTITY_PARTS], parts[BIS_IDENTITY_PARTS];
    fill(k);
    bis_identify(first, &k->of);
    for (size_t i = 0; i < COUNT(kinds); i++) {
        k->view.sampler.kind = kinds[i].kind;
        EXPECT(k->view.sampler.spp, kinds[i].divides ? DIVISION : NONE);
        EXPECT(k->view.sampler.xsamples, i == 0 ? DIVISION : NONE);
        EXPECT(k->view.sampler.ysamples, i == 0 ? DIVISION : NONE);
        bis_identify(parts, &k->of);
        for (int j = 0; j < BIS_IDENTITY_PARTS; j++)
            assert_int_equal(parts[j] != first[j], (j == SAMPLER || j == DIVISION) && i > 0);
    }
    clear(k);
}

static void each_field_of_the_shapes_counts(void **state)
{
    known own, *k = &own;
    fill(k);
    for (int i = 0; i < 4; i++) {
        expect_vector(k, &k->p[i], "vertex");
        expect_vector(k, &k->n[i], "normal");
        EXPECT(k->uv[i].u, SHAPES);
        EXPECT(k->uv[i].v, SHAPES);
    }
    for (int i = 0; i < 6; i++) EXPECT(k->index[i], SHAPES);
    for (int i = 0; i < 2; i++) {
        EXPECT(k->ranges[i].first, SHAPES);
        EXPECT(k->ranges[i].material, SHAPES);
        EXPECT(k->ranges[i].mirrored, SHAPES);
        EXPECT(k->quadrics[i].radius, SHAPES);
    }
    EXPECT(k->w.scene.geometry.box.lo.x, NONE); /* it follows from the rest */
    clear(k);
}

static void each_field_of_materials_and_textures_counts(void **state)
{
    known own, *k = &own;
    fill(k);
    for (int i = 0; i < 2; i++) {
        bis_material *m = &k->w.materials[i];
        expect_rgb(k, &m->Kd, MATERIALS, "Kd");
        expect_rgb(k, &m->Ks, MATERIALS, "Ks");
        expect_rgb(k, &m->eta, MATERIALS, "eta");
        EXPECT(m->exponent, MATERIALS);
        EXPECT(m->alpha, MATERIALS);

        EXPECT(k->of_material[i].Kd, MATERIALS);
        EXPECT(k->list[i].value.r, MATERIALS);
        EXPECT(k->list[i].steps, NONE); /* it follows from the rest */
        for (int j = 0; j < 6; j++) expect_rgb(k, &k->texels[i][j], MATERIALS, "texel");
    }
    EXPECT(k->images[1].holds_normals, MATERIALS);
    /* an image of 2 x 3 texels is another than one of 3 x 2 */
    uint64_t wide[BIS_IDENTITY_PARTS], high[BIS_IDENTITY_PARTS];
    bis_identify(wide, &k->of);
    k->images[0].image.width = 2, k->images[0].image.height = 3;
    bis_identify(high, &k->of);
    for (int i = 0; i < BIS_IDENTITY_PARTS; i++) assert_int_equal(wide[i] != high[i], i == MATERIALS);
    clear(k);
}

static void each_field_of_the_light_counts(void **state)
{
    known own, *k = &own;
    bis_light_desc *l = &own.w.desc.light;
    fill(k);
    const bis_envmap *em = bis_light_envmap(k->w.scene.light);
    for (int i = 0; i < em->width * em->height; i++) expect_rgb(k, &em->pixels[i], MAP, "pixel");
    EXPECT(k->w.desc.accel.n_threads, NONE);
    l->has_table_kind = false;
    EXPECT(l->table_kind, NONE);
    clear(k);
}

/* ---- no field is missing ---- */

static char *read_headers(void)
{
    static char text[1 << 20];
    size_t n = 0;
    glob_t all;
    assert_int_equal(glob("include/bis/*/*.h", 0, NULL, &all), 0);
    for (size_t i = 0; i < all.gl_pathc; i++) {
        FILE *f = fopen(all.gl_pathv[i], "r");
        assert_non_null(f);
        n += fread(text + n, 1, sizeof text - 1 - n, f);
        fclose(f);
    }
    globfree(&all);
    assert_true(n < sizeof text - 1);
    return text;
}

static bool is_in(const char *words, const char *name, size_t n)
{
    for (const char *at = words; (at = strstr(at, name)) != NULL; at++)
        if ((at == words || at[-1] == ' ') && (at[n] == ' ' || !at[n])) return true;
    return false;
}

static bool is_listed(const char *type, const char *name, const char *also)
{
    bool any = is_in(also, name, strlen(name));
    for (const bis_identity_struct *s = bis_identity_structs; s->type; s++) {
        if (strcmp(s->type, type) != 0) continue;
        any |= is_in(s->rest, name, strlen(name));
        for (const bis_field *f = s->fields; f->name; f++) any |= strcmp(f->name, name) == 0;
    }
    return any;
}

/* Looks at each field that the text declares of the struct: a name before ',', ';' or '[', or behind "(*", whose
 * arguments are no fields. Returns how many there are. Fields that are neither in its tables nor in `also` are counted
 * in *n_missing. */
static int look_for_fields(const char *text, const char *type, const char *also, int *n_missing)
{
    char begin[64], name[64] = "";
    size_t n = 0;
    int n_fields = 0;
    bool in_brackets = false;
    snprintf(begin, sizeof begin, "typedef struct %s {", type);
    const char *at = strstr(text, begin);
    if (!at) fail_msg("no struct %s in the headers", type);
    for (at += strlen(begin); *at != '}'; at++) {
        if (at[0] == '/' && at[1] == '*') at = strstr(at, "*/") + 1;
        else if (in_brackets) in_brackets = *at != ']';
        else if (at[0] == ')' && at[1] == '(') at = strchr(at + 1, ')');
        else if (isalnum((unsigned char)*at) || *at == '_') name[n < sizeof name - 1 ? n++ : n] = *at, name[n] = '\0';
        else if (*at == '[' || *at == ',' || *at == ';') {
            in_brackets = *at == '[';
            if (!*name) continue; /* behind brackets */
            n_fields++;
            if (!is_listed(type, name, also)) {
                print_message("%s.%s is in no table of src/render/identity.c\n", type, name);
                ++*n_missing;
            }
            name[n = 0] = '\0';
        } else n = 0; /* the next word is another one */
    }
    return n_fields;
}

/* Each field of a struct counts, or is said not to; of the settings, those that are no parameter. */
static void no_field_of_a_struct_is_missing(void **state)
{
    const char *headers = read_headers();
    char parameters[1024] = "integrator as_printed";
    int n_missing = 0;
    for (const bis_identity_struct *s = bis_identity_structs; s->type; s++)
        assert_true(look_for_fields(headers, s->type, "", &n_missing) > 2);
    for (const bis_parameter *p = bis_parameters; p->name; p++) {
        const size_t length = strlen(parameters);
        snprintf(parameters + length, sizeof parameters - length, " %s", p->name);
    }
    assert_true(look_for_fields(headers, "bis_settings", parameters, &n_missing) > 10);
    assert_int_equal(n_missing, 0);
}

/* The twin: a field is added at each place where one may stand, also where the struct does not grow by it. */
static void a_field_that_is_added_is_missing(void **state)
{
    static const char *const with[] = {"bool orthographic, is_new;", "bool is_new, orthographic;",
                                       "bool orthographic; /* a; b */ float is_new[4];", "char *is_new; bool x0;",
                                       "int x0; void (*is_new)(int a, char b);"};
    char text[256];
    for (size_t i = 0; i < COUNT(with); i++) {
        int n_missing = 0;
        snprintf(text, sizeof text, "typedef struct bis_camera {\n %s double screen[4]; } bis_camera;", with[i]);
        assert_int_equal(look_for_fields(text, "bis_camera", "x0", &n_missing), 3);
        assert_int_equal(n_missing, 1);
    }
}

/* Integrators that read the same parameters are two: of the same ones with another name only this part differs. So are
 * accelerators. */
static void names_of_integrators_and_accelerators_count(void **state)
{
    known own, *k = &own;
    uint64_t parts[3][BIS_IDENTITY_PARTS];
    fill(k);
    const bis_integrator *const of[] = {&bis_em, &bis_brdf, &bis_em};
    for (int i = 0; i < 3; i++) {
        k->view.settings = bis_settings_default(of[i]);
        bis_identify(parts[i], &k->of);
    }
    assert_memory_equal(parts[0], parts[2], sizeof parts[0]);
    for (int j = 0; j < BIS_IDENTITY_PARTS; j++) assert_int_equal(parts[0][j] != parts[1][j], j == SETTINGS);

    bis_accel *const built = k->w.scene.accel;
    bis_geometry g = {0};
    const bis_quadric q = {.kind = BIS_SPHERE, .radius = 1, .to_world = bis_xform_identity()};
    bis_accel *a[2] = {0};
    const int n = bis_accel_embree_version() ? 2 : 1;
    assert_int_equal(bis_geometry_add_quadric(&g, &q, NULL), BIS_OK);
    for (int i = 0; i < 3; i++) {
        const bis_accel_options options = {i ? BIS_ACCEL_EMBREE : BIS_ACCEL_GRID, 0, 1, NULL};
        if (i < n) assert_int_equal(bis_accel_new(&a[i], &g, &options, NULL), BIS_OK);
        k->w.scene.accel = i < n ? a[i] : NULL;
        bis_identify(parts[i], &k->of);
        if (i >= n) break;
    }
    for (int i = 0; i < n; i++)
        for (int j = 0; j < BIS_IDENTITY_PARTS; j++) assert_int_equal(parts[i][j] != parts[n][j], j == ACCELERATOR);
    for (int j = 0; j < BIS_IDENTITY_PARTS; j++) assert_int_equal(parts[0][j] != parts[1][j], j == ACCELERATOR);
    for (int i = 0; i < n; i++) bis_accel_free(a[i]);
    bis_geometry_clear(&g);
    k->w.scene.accel = built;
    clear(k);
}

/* What one array loses the next one does not get: a smaller n is another identity. */
static void numbers_of_things_count(void **state)
{
    known own, *k = &own;
    fill(k);
    size_t *const numbers[] = {&k->w.scene.geometry.n_vertices, &k->w.scene.geometry.n_triangles,
                               &k->w.scene.geometry.n_ranges, &k->w.scene.geometry.n_quadrics,
                               &k->w.desc.n_materials, &k->w.desc.textures.n, &k->w.desc.textures.n_of_material,
                               &k->w.scene.n_images};
    for (size_t i = 0; i < COUNT(numbers); i++) {
        uint64_t before[BIS_IDENTITY_PARTS], after[BIS_IDENTITY_PARTS];
        bis_identify(before, &k->of);
        --*numbers[i];
        bis_identify(after, &k->of);
        ++*numbers[i];
        for (int j = 0; j < BIS_IDENTITY_PARTS; j++)
            assert_int_equal(before[j] != after[j], j == (i < 4 ? SHAPES : MATERIALS));
    }
    clear(k);
}

/* Each part has its words, in this order; where nothing differs, there are none. */
static void what_differs_is_named(void **state)
{
    static const char *const names[BIS_IDENTITY_PARTS] = {
        "the size of the picture, or its crop", "the layers", "the camera", "the sampler, or its seed",
        "the camera samples for which samplers \"stratified\" and \"halton\" divide a pixel (--spp)",
        "pixel jitter, or camera samples on edges",
        "the integrator, or its parameters", "the shapes",
        "the materials, or their textures", "the pixels of the map", "the parameters of the light", "the accelerator"};
    uint64_t a[BIS_IDENTITY_PARTS] = {0}, b[BIS_IDENTITY_PARTS] = {0};
    char list[1024] = "before";

    assert_false(bis_identity_differs(list, sizeof list, a, b));
    assert_string_equal(list, "");
    for (int i = 0; i < BIS_IDENTITY_PARTS; i++) {
        b[i] = 1;
        assert_true(bis_identity_differs(list, sizeof list, a, b));
        assert_string_equal(list, names[i]);
        b[i] = 0;
    }
    b[0] = b[11] = 7;
    assert_true(bis_identity_differs(list, sizeof list, a, b));
    assert_string_equal(list, "the size of the picture, or its crop; the accelerator");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_field_of_the_tables_counts),
        cmocka_unit_test(each_other_field_of_the_view_counts),
        cmocka_unit_test(an_error_that_is_asked_for_does_not_count),
        cmocka_unit_test(camera_samples_count_where_they_divide_a_pixel),
        cmocka_unit_test(each_field_of_the_shapes_counts),
        cmocka_unit_test(each_field_of_materials_and_textures_counts),
        cmocka_unit_test(each_field_of_the_light_counts),
        cmocka_unit_test(no_field_of_a_struct_is_missing),
        cmocka_unit_test(a_field_that_is_added_is_missing),
        cmocka_unit_test(names_of_integrators_and_accelerators_count),
        cmocka_unit_test(numbers_of_things_count),
        cmocka_unit_test(what_differs_is_named),
    };
    return cmocka_run_group_tests_name("identity", tests, NULL, NULL);
}
