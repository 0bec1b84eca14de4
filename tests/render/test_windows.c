/* SPDX-License-Identifier: BSD-2-Clause */
/* windows: the openings of rooms, against the numbers that the rooms are made of; what is none; and the bits of a
 * picture, which are those with the same portal given by hand. Nothing is drawn at random. */
#include "render/windows.h"

#include "claim.h"
#include "image_help.h"
#include "program.h"
#include "scene_help.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define DIR "build/test_windows"

enum { TEXT = 1 << 16 };

static int setup(void **state)
{
    (void)state;
    program_folder(DIR);
    return 0;
}

/* ---- rooms ---- */

/* A box as 12 triangles. */
static void put_box(char *text, const double b[6])
{
    size_t n = strlen(text);

    n += (size_t)snprintf(text + n, TEXT - n, "Shape \"trianglemesh\" \"point3 P\" [");
    for (int i = 0; i < 24; i++)
        n += (size_t)snprintf(text + n, TEXT - n, "%.9g ", b[i % 3 + 3 * (i / 3 >> i % 3 & 1)]);
    snprintf(text + n, TEXT - n, "] \"integer indices\" [0 1 3 0 3 2 4 5 7 4 7 6 0 1 5 0 5 4 2 3 7 2 7 6 0 2 6 0 6 4 "
             "1 3 7 1 7 5]\n");
}

/* In the wall x = side, or with `axis` 1 y = side, of which the outside is at side + 0.1. */
typedef struct opening {
    int axis;
    double a, b, low, high;
} opening;

/* A wall from -2.1 to 2.1 and -0.1 to 3.1 with an opening, in which the pieces meet as the letter T does. */
static void put_wall(char *text, int axis, double side, const opening *o)
{
    const double a = o ? o->a : 0, b = o ? o->b : 0, low = o ? o->low : 0, high = o ? o->high : 0;
    const double part[4][4] = {{-2.1, a, -.1, 3.1}, {b, 2.1, -.1, 3.1}, {a, b, -.1, low}, {a, b, high, 3.1}};

    for (int i = 0; i < (o ? 4 : 2); i++) {
        const double *p = part[i];
        put_box(text, axis ? (double[]){p[0], side, p[2], p[1], side + .1, p[3]}
                           : (double[]){side, p[0], p[2], side + .1, p[1], p[3]});
    }
}

/* What stands in a room, or in its place. */
static const double blinds[] = {2, -.5, 1.05, 2.06, .5, 1.06, 2, -.5, 1.35, 2.06, .5, 1.36, 2, -.5, 1.65, 2.06, .5,
                                1.66},
                    panes[] = {2.04, -.02, 1, 2.2, .02, 2, 2.04, -.5, 1.48, 2.2, .5, 1.52},
                    table[] = {-.2, -.4, .7, 1, .8, .75, .9, .7, 0, 1, .8, .7, .2, 0, .75, .5, .3, 1.1},
                    /* the room behind x = 2, and the same without a window */
                    next_room[] = {2, -2.1, -.1, 4.1, 2.1, 0, 2, -2.1, 3, 4.1, 2.1, 3.1, 2, -2.1, -.1, 4.1, -2, 3.1,
                                   2, 2, -.1, 4.1, 2.1, 3.1, 4, -2.1, -.1, 4.1, -.5, 3.1, 4, .5, -.1, 4.1, 2.1, 3.1,
                                   4, -.5, -.1, 4.1, .5, 1, 4, -.5, 2, 4.1, .5, 3.1},
                    chamber[] = {2, -2.1, -.1, 4.1, 2.1, 0, 2, -2.1, 3, 4.1, 2.1, 3.1, 2, -2.1, -.1, 4.1, -2, 3.1,
                                 2, 2, -.1, 4.1, 2.1, 3.1, 4, -2.1, -.1, 4.1, 2.1, 3.1},
                    tub[] = {-2.1, -2.1, -.1, 2.1, 2.1, 0, -2.1, -2.1, -.1, -2, 2.1, 3.1, 2, -2.1, -.1, 2.1, 2.1, 3.1,
                             -2.1, -2.1, -.1, 2.1, -2, 3.1, -2.1, 2, -.1, 2.1, 2.1, 3.1},
                    /* a T in place of a rectangle */
                    notch[] = {2, -.5, 1, 2.1, -.2, 1.5, 2, .2, 1, 2.1, .5, 1.5},
                    things[] = {-9, -9, -.1, 9, 9, 0, 0, 0, 0, 1, 1, 1, 1, -1, 0, 1.5, -.5, 2};

#define WINDOW {0, -.5, .5, 1, 2}
#define BACK {1, -.6, .6, 1, 2}
#define DOOR {0, -.4, .5, 0, 2.1}
#define THINGS(list) .more = list, .n_more = sizeof(list) / sizeof *(list) / 6

static const struct row {
    const char *name;
    opening in[2]; /* of the room; b = 0: none */
    const double *more;
    size_t n_more;
    const char *text;
    double turn; /* degrees, of everything */
    int n;       /* windows to be found: */
    opening found[2];
    double outside; /* 0: 2.1 */
    bool no_room;
} rows[] = {
    {"one window", {WINDOW}, .n = 1, .found = {WINDOW}},
    {"two windows", {WINDOW, BACK}, .n = 2, .found = {WINDOW, BACK}},
    {"a door", {DOOR}, .n = 1, .found = {DOOR}},
    {"blinds", {WINDOW}, THINGS(blinds), .n = 1, .found = {WINDOW}},
    {"panes are one", {WINDOW}, THINGS(panes), .n = 1, .found = {WINDOW}},
    {"furniture", {WINDOW}, THINGS(table), .n = 1, .found = {WINDOW}},
    {"turned", {WINDOW, BACK}, .turn = 40, .n = 2, .found = {WINDOW, BACK}},
    {"a window behind a door", {DOOR}, THINGS(next_room), .n = 1, .found = {WINDOW}, .outside = 4.1},
    {"a door that leads nowhere", {DOOR, BACK}, THINGS(chamber), .n = 1, .found = {BACK}},
    {"on a wide floor", {WINDOW}, .text = "Shape \"trianglemesh\" \"point3 P\" [-9e3 -9e3 -.2 9e3 -9e3 -.2 0 9e3 -.2]",
     .n = 1, .found = {WINDOW}},
    {"a ball", {WINDOW}, .text = "Shape \"sphere\" \"float radius\" .5", .n = 1, .found = {WINDOW}},
    {"closed", .n = 0},
    {"a T", {WINDOW}, THINGS(notch)},
    {"without a lid", THINGS(tub), .no_room = true},
    {"in the open", THINGS(things), .no_room = true},
    {"a sphere from inside", .text = "Shape \"sphere\" \"float radius\" 5", .no_room = true},
};

static void write_room(char *text, const struct row *r)
{
    snprintf(text, TEXT, "Scale -1 1 1 LookAt -1.7 -1.7 1.6  1 .6 .9  0 0 1 Rotate %g 1 2 3 "
             "Camera \"perspective\" \"float fov\" 70 WorldBegin LightSource \"infinite\" \"bool visible\" false\n"
             "Rotate %g 1 2 3\n%s\n", -r->turn, r->turn, r->text ? r->text : "");
    if (!r->no_room) {
        put_box(text, (const double[]){-2.1, -2.1, -.1, 2.1, 2.1, 0});
        put_box(text, (const double[]){-2.1, -2.1, 3, 2.1, 2.1, 3.1});
        for (int axis = 0; axis < 2; axis++) {
            const opening *o = r->in;
            while (o < r->in + 2 && !(o->b > 0 && o->axis == axis)) o++;
            put_wall(text, axis, 2, o < r->in + 2 ? o : NULL);
            put_wall(text, axis, -2.1, NULL);
        }
    }
    for (size_t i = 0; i < r->n_more; i++) put_box(text, r->more + 6 * i);
}

/* The box around a portal, in the room before it was turned: low in [0], high in [1]. */
static void bounds_of(double box[2][3], const bis_portal *w, double turn)
{
    const bis_xform back = bis_xform_rotate(-turn, 1, 2, 3);

    for (int k = 0; k < 4; k++) {
        double v[3], x[3];
        for (int i = 0; i < 3; i++) v[i] = w->corner[i] + k % 2 * w->edge[0][i] + k / 2 * w->edge[1][i];
        for (int i = 0; i < 3; i++) {
            x[i] = back.m[i][0] * v[0] + back.m[i][1] * v[1] + back.m[i][2] * v[2];
            box[0][i] = k ? fmin(box[0][i], x[i]) : x[i];
            box[1][i] = k ? fmax(box[1][i], x[i]) : x[i];
        }
    }
}

static bool is_at(const bis_portal *w, const struct row *r, const opening *o)
{
    const double side = r->outside > 0 ? r->outside : 2.1;
    const double wanted[2][3] = {{o->axis ? o->a : side, o->axis ? side : o->a, o->low},
                                 {o->axis ? o->b : side, o->axis ? side : o->b, o->high}};
    double box[2][3], off = 0;

    bounds_of(box, w, r->turn);
    for (int i = 0; i < 6; i++) off = fmax(off, fabs(box[i / 3][i % 3] - wanted[i / 3][i % 3]));
    return off < 2e-6; /* some ulps of 2.1 as a float, turned twice */
}

static void windows_are_the_openings_that_lead_outside(void **state)
{
    static char text[TEXT];

    (void)state;
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        const struct row *r = &rows[i];
        bis_portal w[BIS_PORTALS_MAX];
        uint32_t n;
        built b;
        write_room(text, r);
        scene_assert(&b, scene_try(&b, text));
        const bis_film film = {.picture_width = 160, .picture_height = 120};
        assert_int_equal(bis_windows_find(w, &n, b.scene, &b.desc->view.camera, &film, NULL), BIS_OK);
        if (n != (uint32_t)r->n) fail_msg("%s: %u windows", r->name, n);
        for (int k = 0; k < r->n; k++) {
            uint32_t j = 0;
            while (j < n && !is_at(&w[j], r, &r->found[k])) j++;
            if (j == n) fail_msg("%s: window %d is not found, but one at %g %g %g", r->name, k, w[0].corner[0],
                                 w[0].corner[1], w[0].corner[2]);
        }
        scene_clear(&b);
    }
}

/* ---- pictures ---- */

/* The room with two windows and n lights, which have words[n][512]. */
static void write_scene(const char *path, char words[][512], int n)
{
    static char text[TEXT], whole[TEXT + 2048];

    write_room(text, &rows[1]);
    char *light = strstr(text, "LightSource"), *rest = strchr(light, '\n');
    *light = '\0';
    snprintf(whole, sizeof whole, "Film \"rgb\" \"integer xresolution\" 56 \"integer yresolution\" 40 "
             "Sampler \"sobol\" \"integer pixelsamples\" 6 %s", text);
    for (int i = 0; i < n; i++)
        snprintf(whole + strlen(whole), sizeof whole - strlen(whole), "LightSource \"infinite\" %s\n", words[i]);
    snprintf(whole + strlen(whole), sizeof whole - strlen(whole), "%s", rest);
    program_write_file(path, whole);
}

/* Twin: without them the bits are others. */
static void a_picture_has_the_bits_of_one_with_these_portals(void **state)
{
    static const char *const ways[] = {"", "--nthreads 3", "--cropwindow 0.2,0.7,0.1,0.9", "--accelerator grid"};
    char words[2][512] = {"", "\"bool windows\" false"};
    program_run r;
    int n = 0;

    (void)state;
    write_scene(DIR "/room.txt", words, 1);
    write_scene(DIR "/without.txt", words + 1, 1);
    program_expect(&r, 0, DIR "/room.txt --stats - --outfile " DIR "/a.pfm");
    for (const char *at = r.output; n < 2 && (at = strstr(at, "3 portal\\\" [")) != NULL; n++) {
        at += strlen("3 portal\\\" [");
        snprintf(words[n], sizeof words[n], "\"point3 portal\" [%.*s]", (int)strcspn(at, "]"), at);
    }
    assert_int_equal(n, 2);
    write_scene(DIR "/given.txt", words, 2);
    for (size_t i = 0; i < sizeof ways / sizeof *ways; i++) {
        program_expect(&r, 0, DIR "/room.txt %s --outfile " DIR "/a.pfm", ways[i]);
        program_expect(&r, 0, DIR "/given.txt %s --outfile " DIR "/b.pfm", ways[i]);
        assert_same_file(DIR "/a.pfm", DIR "/b.pfm");
        program_expect(&r, 0, DIR "/without.txt %s --outfile " DIR "/b.pfm", ways[i]);
        assert_int_not_equal(differing_bytes(DIR "/a.pfm", DIR "/b.pfm"), 0);
    }
}

static void parts_find_the_windows_of_the_whole(void **state)
{
    static const char *const scenes[] = {"room", "given"}; /* given: of the test before */
    program_run r;

    (void)state;
    for (int i = 0; i < 2; i++) {
        for (int k = 1; k <= 3; k++)
            program_expect(&r, 0, DIR "/%s.txt --part %d/3 --outfile " DIR "/%d.bispart", scenes[i], k, k);
        program_expect(&r, 0, "merge " DIR "/1.bispart " DIR "/2.bispart " DIR "/3.bispart --outfile " DIR "/a.pfm");
        program_expect(&r, 0, DIR "/%s.txt --outfile " DIR "/b.pfm", scenes[i]);
        assert_same_file(DIR "/a.pfm", DIR "/b.pfm");
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(windows_are_the_openings_that_lead_outside),
        cmocka_unit_test(a_picture_has_the_bits_of_one_with_these_portals),
        cmocka_unit_test(parts_find_the_windows_of_the_whole),
    };
    return cmocka_run_group_tests_name("windows", tests, setup, scratch_remove);
}
