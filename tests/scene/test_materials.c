/* SPDX-License-Identifier: BSD-2-Clause */
/* Materials have numbers by their values, in the order of the shapes, and --plan lists them. */
#include "bis/base/mem.h"
#include "bis/beyond/microfacet.h"
#include "bis/scene/scene.h"
#include "bis/thesis/phong.h"

#include "claim.h"
#include "program.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define DIR "build/test_materials"

/* ---- numbers ---- */

/* Any one value that differs makes another number, and equal ones never do. */
static void each_value_of_a_material_tells_it_from_others(void **state)
{
    enum { N = 17 };
    const rgb a = {0.5f, 0.25f, 0.125f}, b = {0.25f, 0.125f, 0.5f};
    bis_material materials[2 * N];
    bis_shape_desc shapes[2 * N];
    for (int i = 0; i < 2 * N; i++) {
        bis_material *m = &materials[i];
        const bis_material model = i % N == 16 ? bis_microfacet(a, b, 0.5) : bis_phong(a, b, 7);
        *m = bis_phong(a, b, 7);
        m->eta = (rgb){1, 2, 3};
        m->alpha = 0.25;
        m->model = model.model;
        float *const values[] = {
            &m->Kd.r, &m->Kd.g, &m->Kd.b, &m->Ks.r, &m->Ks.g, &m->Ks.b, &m->eta.r, &m->eta.g, &m->eta.b};
        if (i % N > 0 && i % N < 10) *values[i % N - 1] += 0.0625f;
        if (i % N == 10) m->exponent = 8;
        if (i % N == 11) m->alpha = 0.5;
        shapes[i] = (bis_shape_desc){.material = (uint32_t)(2 * N - 1 - i)};
    }
    /* 12 to 15: the same values with textures */
    bis_material_textures of[2 * N];
    for (int i = 0; i < 2 * N; i++) {
        of[i] = BIS_NO_TEXTURES;
        if (i % N == 12) of[i].Kd = 3;
        if (i % N == 13) of[i].Ks = 3;
        if (i % N == 14) of[i].width = 3;
        if (i % N == 15) of[i].width = 3, of[i].power = 0.5;
    }
    bis_scene_desc d = {.materials = materials, .n_materials = 2 * N, .shapes = shapes, .n_shapes = 2 * N};
    d.textures = (bis_textures){.of_material = of, .n_of_material = 2 * N};
    uint32_t *number, n;
    assert_int_equal(bis_scene_number_materials(&number, &n, &d, NULL), BIS_OK);
    assert_int_equal(n, N);
    for (int i = 0; i < 2 * N; i++) assert_int_equal(number[i], N - 1 - i % N); /* the shapes name the last one first */
    bis_free(number);
}

/* ---- the program ---- */

static void the_plan_lists_materials_by_number(void **state)
{
    program_run r;
    program_write_file(DIR "/a.txt", "WorldBegin LightSource \"infinite\"\n"
                       "Material \"phong\" \"float Ks\" 0.5 \"float Kd\" 0.4 \"float exponent\" 40\nShape \"sphere\"\n"
                       "Material \"diffuse\"\nShape \"disk\"\nShape \"disk\"\n"
                       "Material \"microfacet\" \"float roughness\" 0.25 \"rgb Ks\" [0.9 0.8 0.5]\nShape \"sphere\"\n"
                       "Material \"phong\" \"float Ks\" 0.5 \"float Kd\" 0.4 \"float exponent\" 40\nShape \"disk\"\n");
    program_expect(&r, 0, DIR "/a.txt --plan");
    assert_non_null(strstr(r.output, "material     0: phong, Kd 0.4, Ks 0.5, exponent 40; 2 shapes\n"
                                     "material     1: phong, Kd 0.5, Ks 0, exponent 50; 2 shapes\n"
                                     "material     2: microfacet, Kd 0, Ks 0.9 0.8 0.5, roughness 0.25; 1 shape\n"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_value_of_a_material_tells_it_from_others),
        cmocka_unit_test(the_plan_lists_materials_by_number),
    };
    program_folder(DIR);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
