/* SPDX-License-Identifier: BSD-2-Clause */
/* lack: what is made while memory is short. Each row of the table makes one thing and frees it. Its first allocation
 * fails, then its second, and so on until none does. Each time there is the thing, or BIS_NOMEM with one error that
 * says so; and no block stays. tests/whole/test_alloc.c and tests/cli/test_no_memory.c do the same with whole renders
 * and whole commands. */
#include "base/names.h"
#include "beyond/guide.h"
#include "bis/base/file.h"
#include "bis/base/mem.h"
#include "bis/base/threads.h"
#include "bis/beyond/mapping.h"
#include "bis/beyond/pool.h"
#include "bis/files/image_file.h"
#include "bis/render/film.h"
#include "bis/scene/scene.h"
#include "bis/shape/make.h"
#include "bis/thesis/alias.h"
#include "bis/thesis/cdf.h"
#include "bis/thesis/importance.h"
#include "bis/thesis/marsaglia.h"
#include "bis/thesis/regions.h"
#include "claim.h"
#include "files/gzip.h"
#include "files/obj.h"
#include "files/ply.h"
#include "lit.h"
#include "map_help.h"
#include "mesh_help.h"
#include "parse/lexer.h"
#include "render/wave.h"
#include "scene/scene_needs.h"
#include "tools/memory.h"
#include "tools/verify/verify.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef BIS_JPEG
#include <jpeglib.h>
#endif

static bis_envmap map;           /* 16 x 8 random pixels */
static bis_light *light;
static bis_scene_desc *scene;    /* textured, of meshes of files and of the scene, with an object and its instance */
static const double weights[] = {1, 2, 3};
static const double whole[4] = {0, 1, 0, 1};

/* ROW defines what makes a thing and frees it. `it` may be freed though it was not made. */
#define ROW(name, it, make, free_it)                                                                                   \
    static bis_status name(bis_diag *diag)                                                                             \
    {                                                                                                                  \
        it;                                                                                                            \
        const bis_status status = make;                                                                                \
        free_it;                                                                                                       \
        return status;                                                                                                 \
    }

/* ---- base ---- */

static bis_status set_names(bis_names *t)
{
    for (uint32_t i = 0; i < 20; i++) {
        char name[8];
        snprintf(name, sizeof name, "%u", (unsigned)i);
        if (!bis_names_set(t, name, i)) return bis_error(NULL, BIS_NOMEM, (bis_loc){0}, "no memory");
    }
    return BIS_OK;
}

ROW(names, bis_names t = {0}; (void)diag, set_names(&t), bis_names_clear(&t))
ROW(threads, , bis_threads_check(3, (bis_loc){0}, diag), )
ROW(whole_file, unsigned char *data = NULL; size_t n,
    bis_file_read(&data, &n, scratch("a.gz"), (bis_loc){0}, diag), bis_free(data))
ROW(compressed_file, unsigned char *data = NULL; size_t n,
    bis_gzip_read(&data, &n, scratch("a.gz"), (bis_loc){0}, diag), bis_free(data))
ROW(new_file, bis_outfile *f = NULL, bis_outfile_open(&f, scratch("new"), diag), bis_outfile_abort(f))

/* ---- shape ---- */

static bis_status make_geometry(bis_geometry *g, bis_diag *diag)
{
    const bis_xform identity = bis_xform_identity(), aside = bis_xform_translate(1, 0, 0);
    const bis_quadric q = {BIS_SPHERE, 1, 0, aside, 0};
    bis_mesh a = {0}, b = {0};
    bis_status status = bis_obj_read_uv(&a, scratch("a.obj"), (bis_loc){0}, diag);
    if (!status) status = bis_obj_read(&b, scratch("a.obj"), (bis_loc){0}, diag);
    if (!status) status = bis_mesh_smooth_normals(&b, diag);
    if (!status) status = bis_geometry_add_mesh(g, &a, &identity, 1, diag);
    if (!status) status = bis_geometry_add_mesh(g, &b, &aside, 2, diag);
    if (!status) status = bis_geometry_add_quadric(g, &q, diag);
    bis_mesh_clear(&a);
    bis_mesh_clear(&b);
    return status;
}

static bis_status make_accel(bis_accel_kind kind, bis_diag *diag)
{
    bis_geometry g = {0};
    bis_accel *a = NULL;
    bis_status status = make_geometry(&g, diag);
    if (!status) status = bis_accel_new(&a, &g, &(bis_accel_options){kind, 8, 1, NULL}, diag);
    bis_accel_free(a);
    bis_geometry_clear(&g);
    return status;
}

static bis_status take_parts(bis_diag *diag)
{
    bis_mesh m = {0}, out = {0};
    bis_mesh_parts parts = {0};
    bis_obj_materials o = {0};
    size_t n = 0;
    bis_status status = bis_obj_read_materials(&o, scratch("a.obj"), (bis_loc){0}, diag);
    if (!status) status = bis_obj_read_parts(&m, &n, scratch("a.obj"), true, (bis_loc){0}, diag);
    if (!status) status = bis_mesh_sort_parts(&parts, &m, n + 1, diag);
    if (!status) status = bis_mesh_take_part(&out, &m, &parts, 1, diag);
    bis_mesh_clear(&out);
    bis_mesh_parts_clear(&parts);
    bis_mesh_clear(&m);
    bis_obj_materials_clear(&o);
    return status;
}

static bis_status read_a(bis_mesh *m, bis_diag *diag) { return bis_obj_read(m, scratch("a.obj"), (bis_loc){0}, diag); }

static const uint32_t corners[1][4] = {{0, 1, 2, 3}};
static const bis_revolved cone = {.p = {{1.5, 0, 0}, {0, 0, 3}}, .phi_max_deg = 360};

ROW(geometry, bis_geometry g = {0}, make_geometry(&g, diag), bis_geometry_clear(&g))
ROW(grid, , make_accel(BIS_ACCEL_GRID, diag), )
ROW(embree, , bis_accel_embree_version() ? make_accel(BIS_ACCEL_EMBREE, diag) : grid(diag), )
ROW(subdivided, bis_mesh m, read_a(&m, diag) ?: bis_make_subdivided(&m, 2, (bis_loc){0}, diag), bis_mesh_clear(&m))
ROW(patches, bis_mesh m, read_a(&m, diag) ?: bis_make_patches(&m, corners, 1, (bis_loc){0}, diag), bis_mesh_clear(&m))
ROW(height_field, bis_mesh m = {0}, bis_make_height_field(&m, (const double[12]){0}, 4, 3, (bis_loc){0}, diag),
    bis_mesh_clear(&m))
ROW(revolved, bis_mesh m = {0}, bis_make_revolved(&m, &cone, (bis_loc){0}, diag), bis_mesh_clear(&m))

/* ---- files ---- */

/* The file that is there stays. */
static bis_status write_image(const char *name, bis_diag *diag)
{
    bis_image image;
    bis_status status = bis_image_init(&image, 16, 8, diag);
    if (status) return status;
    store(scratch(name), "older", 5);
    status = bis_image_save(&image, scratch(name), diag);
    if (status) assert_true(holds(scratch(name), "older", 5));
    bis_image_clear(&image);
    return status;
}

#define WRITE_AND_READ(name, ending)                                                                                   \
    ROW(written_##name, , write_image("w." ending, diag), )                                                            \
    ROW(read_##name, bis_image i, bis_image_read_colours(&i, scratch("r." ending), 1, (bis_loc){0}, diag),             \
        bis_image_clear(&i))
WRITE_AND_READ(hdr, "hdr")
WRITE_AND_READ(exr, "exr")
WRITE_AND_READ(pfm, "pfm")
WRITE_AND_READ(png, "png")
ROW(read_tga, bis_image i, bis_image_read_colours(&i, scratch("a.tga"), 1, (bis_loc){0}, diag), bis_image_clear(&i))
ROW(read_bmp, bis_image i, bis_image_read_colours(&i, scratch("a.bmp"), 1, (bis_loc){0}, diag), bis_image_clear(&i))
#ifdef BIS_JPEG
ROW(read_jpg, bis_image i, bis_image_read_colours(&i, scratch("a.jpg"), 1, (bis_loc){0}, diag), bis_image_clear(&i))
#endif
ROW(read_ply, bis_mesh m, bis_ply_read_uv(&m, scratch("a.ply"), (bis_loc){0}, diag), bis_mesh_clear(&m))
ROW(read_strip, bis_mesh m, bis_ply_read(&m, scratch("strip.ply"), (bis_loc){0}, diag), bis_mesh_clear(&m))

/* ---- thesis ---- */

static bis_status make_importance(bis_table_kind kind, bis_diag *diag)
{
    const bis_importance_options o = {true, true, kind, 0.15, 8, false, 0};
    static double pmf[16 * 8];
    bis_importance *im = NULL;
    bis_status status = bis_importance_new(&im, &map, &o, diag);
    if (!status) status = bis_importance_implied_pmf(im, pmf, diag);
    bis_importance_free(im);
    return status;
}

static bis_status copy_map(bis_mapping mapping, bis_diag *diag)
{
    bis_image image = {0};
    bis_envmap em = {0};
    double power[2];
    bis_status status = bis_envmap_to_mapping(&image, &map, mapping, 12, power, diag);
    if (!status) status = bis_envmap_from_mapping(&em, &image, mapping, 0, diag);
    bis_envmap_clear(&em);
    bis_image_clear(&image);
    return status;
}

static bis_status make_scratch(const bis_integrator *integrator, bis_diag *diag)
{
    const bis_settings s = bis_settings_default(integrator);
    bis_scratch x;
    const bis_status status = bis_scratch_init(&x, &s, diag);
    if (!status) bis_scratch_clear(&x);
    return status;
}

ROW(alias, bis_alias a, bis_alias_init(&a, weights, 3, diag), bis_alias_clear(&a))
ROW(cdf, bis_cdf c, bis_cdf_init(&c, weights, 3, diag), bis_cdf_clear(&c))
ROW(marsaglia, bis_marsaglia m, bis_marsaglia_init(&m, (const uint64_t[]){1, 2}, 2, diag), bis_marsaglia_clear(&m))
ROW(regions, bis_regions r, bis_regions_init(&r, &map, 8, diag), bis_regions_clear(&r))
ROW(alias_tables, , make_importance(BIS_TABLE_ALIAS, diag), )
ROW(cdfs, , make_importance(BIS_TABLE_CDF, diag), )
ROW(latlong_map, , copy_map(BIS_MAPPING_LATLONG, diag), )
ROW(angular_map, , copy_map(BIS_MAPPING_ANGULAR, diag), )
ROW(octahedral_map, , copy_map(BIS_MAPPING_EQUALAREA, diag), )
ROW(scratch_of_sir, , make_scratch(&bis_sir, diag), )
ROW(scratch_of_rejection, , make_scratch(&bis_rejection, diag), )

/* ---- beyond, render ---- */

static bis_status make_guide(bis_diag *diag)
{
    bis_clusters c = {0};
    bis_visibility v = {0};
    bis_product_guide g = {0};
    bis_status status = bis_clusters_init(&c, light, 256, diag);
    if (!status) status = bis_visibility_init(&v, 3, 0, 1, diag);
    if (!status) status = bis_product_guide_init(&g, &c, &v, diag);
    bis_product_guide_clear(&g);
    bis_visibility_clear(&v);
    bis_clusters_clear(&c);
    return status;
}

static bis_status make_probe(bis_diag *diag)
{
    bis_settings s = lit_settings(&bis_sir, BIS_PROPOSAL_PRODUCT, 64, 3);
    bis_probe p = {0};
    s.stratify = s.learn = true;
    const bis_status status = bis_probe_init(&p, &s, light, diag);
    bis_probe_clear(&p);
    return status;
}

ROW(pool, bis_pool p, bis_pool_init(&p, 8, diag), bis_pool_clear(&p))
ROW(guess, bis_visibility_guess f, bis_guess_init(&f, 100, diag), bis_guess_clear(&f))
ROW(film, bis_film f, bis_film_init(&f, 8, 6, whole, (bis_loc){0}, diag), bis_film_clear(&f))

static bis_status make_wave(bis_diag *diag)
{
    const bis_wave_task task = {.desc = scene};
    bis_wave *w = bis_wave_new(&task, NULL, NULL, NULL);
    const bis_status status = w ? BIS_OK : bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for a wave");
    bis_wave_free(w);
    return status;
}

/* ---- tools ---- */

static bis_status advise(bis_diag *diag)
{
    char text[BIS_MEMORY_ADVICE];
    bis_memory m;
    const bis_status status = bis_memory_foresee(&m, scene, diag);
    return status ? status : bis_memory_advise(text, &m, scene, 1000, diag);
}

static bis_status define(bis_diag *diag)
{
    static double pmf[16 * 8];
    bool has_light;
    return bis_verify_definition(pmf, &has_light, &map, 0.15, 8, diag);
}

/* ---- scene, parse ---- */

ROW(description, bis_scene_desc *d, bis_scene_parse(&d, scratch("scene.txt"), diag), bis_scene_desc_free(d))
ROW(approximation, bis_scene_desc *d,
    bis_scene_parse_as(&d, scratch("foreign.txt"), BIS_PARSE_APPROXIMATE | BIS_PARSE_LIST_MISSING, diag),
    bis_scene_desc_free(d))
ROW(built_scene, bis_scene *s, bis_scene_build(&s, scene, diag), bis_scene_free(s))
ROW(needs, bis_scene_needs n, bis_scene_needs_of(&n, scene, diag), bis_scene_needs_clear(&n))
ROW(check_of_files, , bis_scene_check_files(scene, diag), )
ROW(text_of_the_caller, bis_lexer l = {.diag = diag}, bis_lexer_push_text(&l, "here", "a"), bis_lexer_clear(&l))

static const struct {
    const char *name;
    bis_status (*make)(bis_diag *diag);
} rows[] = {
#define R(name) {#name, name}
    R(names), R(threads), R(whole_file), R(compressed_file), R(new_file), R(geometry), R(take_parts), R(grid),
    R(embree), R(subdivided), R(patches), R(height_field), R(revolved), R(written_hdr), R(read_hdr), R(written_exr),
    R(read_exr), R(written_pfm), R(read_pfm), R(written_png), R(read_png), R(read_tga), R(read_bmp),
#ifdef BIS_JPEG
    R(read_jpg),
#endif
   
    R(read_ply), R(read_strip), R(alias), R(cdf), R(marsaglia), R(regions), R(alias_tables), R(cdfs), R(latlong_map),
    R(angular_map), R(octahedral_map), R(scratch_of_sir), R(scratch_of_rejection), R(make_guide), R(make_probe),
    R(pool), R(guess), R(film), R(description), R(approximation), R(built_scene), R(needs), R(check_of_files),
    R(text_of_the_caller), R(make_wave), R(advise), R(define)
#undef R
};

/* The k-th allocation fails. Returns whether there was none. A library may do without a piece of memory, and a message
 * may lose its text. */
static bool make_without(size_t i, long k, int *n_failed)
{
    bis_diag diag = {0};
    const long live = bis_mem_live();
    const int files = scratch_count();
    bis_mem_fail_at(k);
    const bis_status status = rows[i].make(&diag);
    const bool over = bis_mem_count() < k;
    bis_mem_fail_at(0);
    const char *said = "no memory";
    for (size_t n = diag.n; n-- > 0;)
        if (diag.messages[n].is_error) said = diag.messages[n].text;
    const bool says_memory = (strstr(said, "memory") || strstr(said, "allocate")) && !strstr(said, "for 0 ");
    const size_t n_errors = status && rows[i].make != names;
    if (status && (status != BIS_NOMEM || over || !says_memory))
        fail_msg("%s, allocation %ld: status %d, %s", rows[i].name, k, (int)status, said);
    if (diag.n_errors != n_errors) fail_msg("%s, allocation %ld: %zu errors", rows[i].name, k, diag.n_errors);
    bis_diag_clear(&diag);
    if (bis_mem_live() != live || (status && scratch_count() != files))
        fail_msg("%s, allocation %ld: something stays", rows[i].name, k);
    *n_failed += status != BIS_OK;
    return over;
}

static void without_memory_nothing_is_made_and_nothing_stays(void **state)
{
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        int n_failed = 0;
        for (long k = 1; !make_without(i, k, &n_failed); k++) assert_true(k < 10000);
        if (!n_failed) fail_msg("%s allocates nothing", rows[i].name);
    }
}

static void store_text(const char *name, const char *text) { store(scratch(name), text, strlen(text)); }

/* Where the last "%s" of a scene is a file of this run. */
static void store_scene(const char *name, const char *format, const char *file)
{
    char text[2048];
    snprintf(text, sizeof text, format, strrchr(scratch(file), '/') + 1);
    store_text(name, text);
}

static const char described[] =
    "Accelerator \"grid\" WorldBegin LightSource \"infinite\"\n"
    "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"%s\" \"float scale\" .1\n"
    "Texture \"c\" \"spectrum\" \"checkerboard\"\n"
    "ObjectBegin \"o\" Shape \"sphere\" ObjectEnd ObjectInstance \"o\"\n"
    "Material \"plastic\" \"texture Kd\" \"c\" \"texture Ks\" \"t\" Shape \"cone\" Shape \"disk\"\n"
    "Material \"conductor\" \"spectrum eta\" [400 1 500 2] \"spectrum k\" [400 1 500 2] \"float roughness\" 0.1\n"
    "Shape \"loopsubdiv\" \"integer levels\" 1 \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1 2]\n"
    "Shape \"heightfield\" \"integer nu\" 2 \"integer nv\" 2 \"float Pz\" [0 0 0 0]\n"
    "Shape \"nurbs\" \"integer nu\" 2 \"integer uorder\" 2 \"float uknots\" [0 0 1 1] \"integer nv\" 2\n"
    "  \"integer vorder\" 2 \"float vknots\" [0 0 1 1] \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 0]\n";

static const char foreign[] =
    "WorldBegin LightSource \"infinite\" ObjectBegin \"o\" Shape \"sphere\" ObjectEnd ObjectInstance \"o\"\n"
    "Texture \"t\" \"float\" \"constant\" Material \"uber\" \"texture opacity\" \"t\" Material \"glass\"\n"
    "Shape \"plymesh\" \"string filename\" \"no.ply\" AreaLightSource \"x\"\n"
    "Shape \"bilinearmesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 0] Shape \"objmesh\" \"string filename\" \"%s\"\n"
    "MakeNamedMaterial \"m\" \"string type\" \"matte\" Material \"mix\" \"string materials\" [\"m\" \"m\"]\n";

#ifdef BIS_JPEG
static void store_jpeg(const char *path)
{
    struct jpeg_compress_struct jpeg;
    struct jpeg_error_mgr errors;
    unsigned char *out = NULL, pixel[3] = {1, 2, 3}, *row = pixel;
    unsigned long n = 0;
    jpeg.err = jpeg_std_error(&errors);
    jpeg_create_compress(&jpeg);
    jpeg_mem_dest(&jpeg, &out, &n);
    jpeg.image_width = jpeg.image_height = 1;
    jpeg.input_components = 3;
    jpeg.in_color_space = JCS_RGB;
    jpeg_set_defaults(&jpeg);
    jpeg_start_compress(&jpeg, TRUE);
    jpeg_write_scanlines(&jpeg, &row, 1);
    jpeg_finish_compress(&jpeg);
    jpeg_destroy_compress(&jpeg);
    store(path, out, n);
    free(out);
}
#endif

static int prepare(void **state)
{
    static const char tga[] = "\0\0\2\0\0\0\0\0\0\0\0\0\1\0\1\0\30\0abc";
    static const char bmp[] = "BM\0\0\0\0\0\0\0\0\66\0\0\0\50\0\0\0\1\0\0\0\1\0\0\0\1\0\30\0\0\0\0\0\0\0\0\0"
                              "\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0abc";
    static const char gz[] = "\37\213\10\0\0\0\0\0\2\3KLJ\6\0\xc2\x41\x24\x35\3\0\0\0";
    static const char *const images[] = {"r.hdr", "r.exr", "r.pfm", "r.png", "w.hdr", "w.exr", "w.pfm", "w.png"};
    map = map_random(16, 8, 4, 0.1, 1);
    light = lit_new_light(LIT_SPOTTY, 1, 0, false);
    const bis_image image = {16, 8, map.pixels, NULL};
    for (int i = 0; i < 8; i++) assert_int_equal(bis_image_save(&image, scratch(images[i]), NULL), BIS_OK);
    store(scratch("a.tga"), tga, sizeof tga - 1);
    store(scratch("a.bmp"), bmp, sizeof bmp);
#ifdef BIS_JPEG
    store_jpeg(scratch("a.jpg"));
#endif
    store(scratch("a.gz"), gz, sizeof gz - 1);
    store_text("a.obj", "mtllib a\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 1 2\nvt 3 4\nvn 0 0 1\nusemtl a\n"
                        "f 1/1/1 2/2/1 3/1/1\nusemtl b\nf 1/2/1 3/1/1 4/2/1\n");
    store_text("a.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                        "property float z\nproperty float u\nproperty float v\nelement face 1\n"
                        "property list uchar int vertex_indices\nend_header\n0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 1\n"
                        "3 0 1 2\n");
    store_text("strip.ply", "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
                            "property float z\nelement tristrips 1\nproperty list int int vertex_indices\n"
                            "end_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n14 0 1 2 3 0 1 2 3 0 1 2 3 0 1\n");
    store_scene("scene.txt", described, "r.pfm");
    store_scene("foreign.txt", foreign, "a.obj");
    assert_int_equal(bis_scene_parse(&scene, scratch("scene.txt"), NULL), BIS_OK);
    return 0;
}

static int finish(void **state)
{
    bis_scene_desc_free(scene);
    bis_light_free(light);
    bis_envmap_clear(&map);
    return scratch_remove(state);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(without_memory_nothing_is_made_and_nothing_stays),
    };
    return cmocka_run_group_tests(tests, prepare, finish);
}
