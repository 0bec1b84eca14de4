/* SPDX-License-Identifier: BSD-2-Clause */
#include "verify_help.h"

#include "bis/files/image_file.h"
#include "bis/thesis/phong.h"
#include "claim.h"
#include "map_help.h"
#include "program.h"
#include "stat.h"

#include <stdio.h>
#include <string.h>

size_t verify_failures(bis_verify *v)
{
    assert_int_equal(bis_verify_judge(v, NULL), BIS_OK);
    assert_true(v->n > 0);
    const size_t n = v->n_failed;
    for (size_t i = 0; i < v->n; i++) {
        const bis_verify_test *t = &v->tests[i];
        if (t->verdict == BIS_VERDICT_FAILED)
            print_message("  rejected: %s: %s (%g, p %g)\n", t->name, t->note, t->statistic, t->p);
    }
    bis_verify_clear(v);
    return n;
}

size_t verify_judged(const bis_verify *v)
{
    size_t n = 0;
    for (size_t i = 0; i < v->n; i++) n += !isnan(v->tests[i].p) || strstr(v->tests[i].note, "too few");
    return n;
}

void verify_assert_accepted(bis_verify *v)
{
    assert_int_equal(bis_verify_judge(v, NULL), BIS_OK);
    stat_judges((int)verify_judged(v));
    for (size_t i = 0; i < v->n; i++) {
        const bis_verify_test *t = &v->tests[i];
        const unsigned seed = (unsigned)v->seed;
        if (!isnan(t->p))
            stat_later(1e-3, t->p, "%s: %s: statistic %g, seed %u", t->name, t->note, t->statistic, seed);
        else if (t->verdict == BIS_VERDICT_FAILED)
            fail_msg("%s: %s: %g, seed %u", t->name, t->note, t->statistic, seed);
    }
    bis_verify_clear(v);
}

bis_material verify_glossy(const bis_bsdf_model *model, double exponent)
{
    bis_material m = bis_phong((rgb){0.3f, 0.2f, 0.1f}, (rgb){0.5f, 0.6f, 0.7f}, exponent);
    m.model = model;
    return m;
}

const char verify_one_pixel[] = "Film \"rgb\" \"integer xresolution\" 1 \"integer yresolution\" 1\n";

void verify_write_map(void)
{
    program_folder(VERIFY_DIR);
    bis_envmap em = map_random(32, 16, 4, 0.1, 2);
    const bis_image image = {32, 16, em.pixels, NULL};
    assert_int_equal(bis_image_save(&image, VERIFY_DIR "/map.pfm", NULL), BIS_OK);
    bis_envmap_clear(&em);
}

void verify_write_scene(const char *name, const char *options)
{
    char path[64], text[2048];
    snprintf(path, sizeof path, VERIFY_DIR "/%s", name);
    snprintf(text, sizeof text, "%s%s", options, program_world);
    program_write_file(path, text);
}

verify_built verify_build(const char *path)
{
    verify_built b = {NULL, NULL};
    bis_diag diag = {0};
    if (bis_scene_parse(&b.desc, path, &diag)) fail_msg("%s", path);
    b.desc->light_needs = BIS_VERIFY_LIGHT_NEEDS;
    assert_int_equal(bis_scene_build(&b.scene, b.desc, &diag), BIS_OK);
    bis_diag_clear(&diag);
    return b;
}

void verify_clear(verify_built *b)
{
    bis_scene_free(b->scene);
    bis_scene_desc_free(b->desc);
}

void verify_run_file(bis_verify *v, const char *path)
{
    verify_built b = verify_build(path);
    assert_int_equal(bis_verify_scene(v, b.scene, b.desc, &b.desc->view.settings, NULL), BIS_OK);
    verify_clear(&b);
}
