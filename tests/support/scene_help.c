/* SPDX-License-Identifier: BSD-2-Clause */
#include "scene_help.h"

#include "claim.h"
#include "image_help.h"

#include <stdio.h>
#include <string.h>

bis_status scene_parse(built *b, const char *text)
{
    *b = (built){0};
    store(scratch("scene.txt"), text, strlen(text));
    return bis_scene_parse(&b->desc, scratch("scene.txt"), &b->diag);
}

bis_status scene_try(built *b, const char *text)
{
    const bis_status status = scene_parse(b, text);
    return status ? status : bis_scene_build(&b->scene, b->desc, &b->diag);
}

void scene_assert(const built *b, bis_status status)
{
    for (size_t i = 0; i < b->diag.n && status; i++) print_error("%s\n", b->diag.messages[i].text);
    assert_int_equal(status, BIS_OK);
}

built scene_build(const char *fmt, ...)
{
    char text[8192];
    built b;
    va_list args;
    va_start(args, fmt);
    vsnprintf(text, sizeof text, fmt, args);
    va_end(args);
    scene_assert(&b, scene_try(&b, text));
    return b;
}

void scene_clear(built *b)
{
    bis_scene_free(b->scene);
    bis_scene_desc_free(b->desc);
    bis_diag_clear(&b->diag);
}
