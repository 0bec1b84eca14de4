/* SPDX-License-Identifier: BSD-2-Clause */
/* regression: files that once led a reader astray, most of them found by `make fuzz`. Each must give what its row
 * says. */
#include "bis/files/image_file.h"
#include "bis/scene/scene.h"
#include "files/obj.h"
#include "files/ply.h"
#include "claim.h"

#include <dirent.h>
#include <stdio.h>
#include <string.h>

#define FOLDER "tests/data/regression"

/* text: how the last message ends, NULL: none may come. */
typedef struct outcome {
    const char *file;
    bis_status status;
    const char *text;
} outcome;

static const outcome outcomes[] = {
    /* An offset was added to a header's property list that was NULL. */
    {"faces-without-properties.ply", BIS_INPUT, "the element \"face\" has no list \"vertex_indices\""},
    /* OpenEXRCore 3.1.5 wrote channels that nobody wanted to address 0. The file is damaged, too. */
    {"luminance-among-halves.exr", BIS_INPUT, "packed data size says 18446744073709551582, must be between 0 and 32"},
    /* OpenEXRCore went on with a data window of its own; OpenEXR's older interface then asked for 2 GB. */
    {"attribute-of-2-gigabytes.exr", BIS_INPUT, "Invalid size 1946181888"},
    /* The same without a complaint. */
    {"made-up-window.exr", BIS_INPUT, "its header is damaged"},
};

enum { N_OUTCOMES = sizeof outcomes / sizeof outcomes[0] };

static bool ends_in(const char *name, const char *ending)
{
    const size_t n = strlen(name), k = strlen(ending);
    return n >= k && strcmp(name + n - k, ending) == 0;
}

static bis_status read_mesh(const char *path, bis_diag *diag)
{
    bis_mesh m;
    bis_status status =
        ends_in(path, ".ply") ? bis_ply_read(&m, path, (bis_loc){0}, diag) : bis_obj_read(&m, path, (bis_loc){0}, diag);
    bis_mesh_clear(&m);
    return status;
}

/* As far as it goes: parsed, planned, built. */
static bis_status read_scene(const char *path, bis_diag *diag)
{
    bis_scene_desc *d;
    bis_scene *s = NULL;
    bis_status status = bis_scene_parse(&d, path, diag);
    if (!status) status = bis_scene_build(&s, d, diag);
    bis_scene_free(s);
    bis_scene_desc_free(d);
    return status;
}

static bis_status read_image(const char *path, bis_diag *diag)
{
    bis_image image;
    bis_status status = bis_image_read(&image, path, (bis_loc){0}, diag);
    bis_image_clear(&image);
    return status;
}

static bis_status read_any(const char *path, bis_diag *diag)
{
    if (ends_in(path, ".ply") || ends_in(path, ".obj")) return read_mesh(path, diag);
    if (ends_in(path, ".txt")) return read_scene(path, diag);
    return read_image(path, diag);
}

static void every_file_gives_what_was_agreed(void **state)
{
    for (size_t i = 0; i < N_OUTCOMES; i++) {
        const outcome *o = &outcomes[i];
        char path[256];
        bis_diag diag = {0};
        snprintf(path, sizeof path, FOLDER "/%s", o->file);
        assert_int_equal(read_any(path, &diag), o->status);
        const char *said = diag.n ? diag.messages[diag.n - 1].text : "nothing";
        if (o->text ? !ends_in(said, o->text) : diag.n > 0) fail_msg("%s: said \"%s\"", path, said);
        bis_diag_clear(&diag);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_file_gives_what_was_agreed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
