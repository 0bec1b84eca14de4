/* SPDX-License-Identifier: BSD-2-Clause */
/* What a scene requires is found once (src/scene/scene_needs.h): what is built, printed by --plan, foretold of memory
 * and looked at before a render follows from it. A checkpoint's identity counts what is built. */
#include "bis/base/mem.h"
#include "claim.h"
#include "program.h"
#include "render/identity.h"
#include "scene/scene_needs.h"
#include "tools/memory.h"

#include <stdlib.h>
#include <string.h>

#define DIR "build/test_needs"

static bool wants_image(const bis_scene_needs *n) { return n->images[0]; }
static bool wants_mesh(const bis_scene_needs *n) { return n->uses[0] > 0; }
static bool wants_uv(const bis_scene_needs *n) { return n->with_uv[0]; }
static bool wants_table(const bis_scene_needs *n) { return n->light & BIS_NEED_TABLE && !n->why_no_drawing; }
static bool wants_accel(const bis_scene_needs *n) { return n->n_quadrics > 0; }
static bool has_image(const bis_scene *s) { return s->images && s->images[0].image.pixels; }
static bool has_mesh(const bis_scene *s) { return s->geometry.n_triangles > 0; }
static bool has_uv(const bis_scene *s) { return s->geometry.uv != NULL; }
static bool has_table(const bis_scene *s) { return bis_light_importance(s->light) != NULL; }
static bool has_accel(const bis_scene *s) { return s->accel != NULL; }

static double image_bytes(const bis_memory *m) { return m->textures; }
static double mesh_bytes(const bis_memory *m) { return m->meshes; }
static double map_bytes(const bis_memory *m) { return m->map; }

#define IMAGE "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"t.pfm\" "
#define SHOWN "Material \"diffuse\" \"texture reflectance\" \"t\" "
#define MESH "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"point2 uv\" [0 0 1 0 0 1] "
#define MAP "LightSource \"infinite\" \"string filename\" \"map.pfm\" "
#define SPHERE "Shape \"sphere\" "

/* The same scene twice, first with something that is required, then without. */
typedef struct required {
    const char *what, *with, *without; /* the scenes differ in this alone */
    bool (*wants)(const bis_scene_needs *n), (*has)(const bis_scene *s);
    double (*bytes)(const bis_memory *m); /* NULL: not told apart */
    const char *build;                     /* the line of --plan */
    const char *identity;                  /* the parts of a checkpoint's identity that differ */
} required;

static const required all[] = {
    {"an image", "WorldBegin " MAP IMAGE SHOWN SPHERE, "WorldBegin " MAP IMAGE SPHERE, wants_image, has_image,
     image_bytes, "build        texture build/test_needs/t.pfm",
     "the shapes; the materials, or their textures"}, /* the sphere names another material */
    {"a mesh", "WorldBegin " MAP MESH SPHERE, "WorldBegin " MAP "ObjectBegin \"o\" " MESH "ObjectEnd " SPHERE,
     wants_mesh, has_mesh, mesh_bytes, "build        mesh of the scene file", "the shapes"},
    {"texture coordinates", "WorldBegin " MAP IMAGE SHOWN MESH, "WorldBegin " MAP IMAGE MESH, wants_uv, has_uv,
     mesh_bytes, "build        texture coordinates", "the shapes; the materials, or their textures"},
    {"a table", "Integrator \"em\" WorldBegin " MAP SPHERE, "Integrator \"brdf\" WorldBegin " MAP SPHERE, wants_table,
     has_table, map_bytes, "build        light table", "the integrator, or its parameters"},
    {"an accelerator", "WorldBegin " MAP SPHERE, "WorldBegin " MAP, wants_accel, has_accel, NULL,
     "build        accelerator", "the shapes; the accelerator"},
};

/* What a checkpoint of the scene would be known by. */
static void identify(uint64_t parts[BIS_IDENTITY_PARTS], const bis_scene_desc *desc, const bis_scene *scene)
{
    bis_film film = {.full_width = 4, .full_height = 3, .width = 4, .height = 3};
    const bis_render_options options = {.pass_size = 1};
    const bis_workspace of = {.scene = scene, .desc = desc, .view = &desc->view, .options = &options, .film = &film};
    bis_identify(parts, &of);
}

/* Whether each of the readers says that it is required, how many bytes, and the identity. */
static void look(bool found[3], double *bytes, uint64_t parts[BIS_IDENTITY_PARTS], const required *r, const char *text)
{
    bis_scene_desc *desc;
    bis_scene_needs needs;
    bis_scene *scene;
    bis_memory memory;
    char *plan = NULL;
    size_t size;

    assert_int_equal(bis_scene_parse_text(&desc, DIR "/scene", text, 0, NULL), BIS_OK);
    assert_int_equal(bis_scene_needs_of(&needs, desc, NULL), BIS_OK);
    assert_int_equal(bis_scene_build(&scene, desc, NULL), BIS_OK);
    assert_int_equal(bis_memory_foresee(&memory, desc, NULL), BIS_OK);
    FILE *out = open_memstream(&plan, &size);
    bis_scene_plan(desc, out);
    fclose(out);
    found[0] = r->wants(&needs);
    found[1] = r->has(scene);
    found[2] = strstr(plan, r->build) != NULL;
    *bytes = r->bytes ? r->bytes(&memory) : 0;
    identify(parts, desc, scene);
    free(plan);
    bis_scene_free(scene);
    bis_scene_needs_clear(&needs);
    bis_scene_desc_free(desc);
}

static void what_is_required_is_built_planned_foreseen_and_identified(void **state)
{
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
        bool with[3], without[3];
        double most, least;
        uint64_t one[BIS_IDENTITY_PARTS], other[BIS_IDENTITY_PARTS];
        char differs[256];
        look(with, &most, one, &all[i], all[i].with);
        look(without, &least, other, &all[i], all[i].without);
        for (int k = 0; k < 3; k++)
            if (!with[k] || without[k]) fail_msg("%s, reader %d: %d, %d", all[i].what, k, with[k], without[k]);
        if (all[i].bytes && !(most > least)) fail_msg("%s: %g bytes with it, %g without", all[i].what, most, least);
        bis_identity_differs(differs, sizeof differs, one, other);
        assert_string_equal(differs, all[i].identity);
    }
}

/* What no shape shows is not looked at: a file that is no image is then no error. */
static void only_what_is_required_is_checked(void **state)
{
    program_write_file(DIR "/bad.pfm", "no image");
    for (int shown = 0; shown < 2; shown++) {
        char text[512];
        bis_scene_desc *desc;
        snprintf(text, sizeof text,
                 "WorldBegin " MAP "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"bad.pfm\" %s" SPHERE,
                 shown ? SHOWN : "");
        assert_int_equal(bis_scene_parse_text(&desc, DIR "/scene", text, 0, NULL), BIS_OK);
        assert_int_equal(bis_scene_check_files(desc, NULL), shown ? BIS_INPUT : BIS_OK);
        bis_scene_desc_free(desc);
    }
}

static void write_image(const char *path, int width, int height)
{
    FILE *out = fopen(path, "wb");
    assert_non_null(out);
    fprintf(out, "PF\n%d %d\n-1.0\n", width, height);
    for (int i = 0; i < width * height; i++) fwrite((const float[3]){0.5f, 0.5f, 0.25f}, sizeof(float), 3, out);
    fclose(out);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_required_is_built_planned_foreseen_and_identified),
        cmocka_unit_test(only_what_is_required_is_checked),
    };
    if (system("mkdir -p " DIR) != 0) return 1;
    write_image(DIR "/t.pfm", 8, 4);
    write_image(DIR "/map.pfm", 64, 32);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
