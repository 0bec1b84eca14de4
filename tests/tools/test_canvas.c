/* Tests of canvas and palette: areas of what is drawn against geometry, letters against one another, what lies outside
 * against nothing. */
#include "out/canvas.h"
#include "map_help.h"
#include "out/palette.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { W = 200, H = 120 };

static const rgb white = {1, 1, 1};

static bis_image blank(void)
{
    bis_image image;
    assert_int_equal(bis_image_init(&image, W, H, NULL), BIS_OK);
    return image;
}

/* Pixels covered. */
static double ink(const bis_image *image)
{
    double sum = 0;
    for (int i = 0; i < W * H; i++) {
        assert_true(image->pixels[i].r >= 0 && image->pixels[i].r <= 1);
        sum += (double)image->pixels[i].r;
    }
    return sum;
}

static void shapes_cover_their_areas(void **state)
{
    (void)state;
    bis_image a = blank();
    bis_canvas_box(&a, 10, 20, 30, 40, white);
    assert_near(ink(&a), 1200, 0);
    bis_image_clear(&a);
    a = blank();
    bis_canvas_disc(&a, 100.3, 60.7, 20, white);
    assert_near(ink(&a) / (PI * 400), 1, 2e-3);
    bis_image_clear(&a);
    a = blank();
    bis_canvas_ring(&a, 100.3, 60.7, 20, 3, white);
    assert_near(ink(&a) / (2 * PI * 20 * 3), 1, 5e-3);
    bis_image_clear(&a);
    for (int i = 0; i < 12; i++) { /* at any angle: a rectangle and two half discs */
        a = blank();
        const double dx = 40 * cos(i * 0.5), dy = 40 * sin(i * 0.5);
        bis_canvas_line(&a, 100 - dx, 60 - dy, 100 + dx, 60 + dy, 4, white);
        assert_near(ink(&a) / (80 * 4 + PI * 4), 1, 0.03); /* edges aslant are right to the eye */
        bis_image_clear(&a);
    }
}

static void what_lies_outside_is_cut_off(void **state)
{
    (void)state;
    bis_image a = blank();
    bis_canvas_box(&a, -10, -10, 5, 5, white);
    bis_canvas_disc(&a, -50, 60, 20, white);
    bis_canvas_ring(&a, W + 50, 60, 20, 3, white);
    bis_canvas_line(&a, -1e9, -20, 1e9, -20, 3, white);
    bis_canvas_text(&a, W + 10, 20, 10, white, "out");
    assert_near(ink(&a), 0, 0);
    bis_canvas_disc(&a, 0, 0, 20, white); /* a quarter of it */
    assert_near(ink(&a) / (PI * 100), 1, 5e-3);
    bis_image_clear(&a);
}

static void colours_blend(void **state)
{
    (void)state;
    bis_image a = blank();
    bis_canvas_blend(&a, 3, 4, (rgb){1, 0.5f, 0}, 0.25);
    assert_near((double)a.pixels[4 * W + 3].r, 0.25, 1e-6);
    bis_canvas_blend(&a, 3, 4, white, 7); /* more than all is all */
    assert_near((double)a.pixels[4 * W + 3].b, 1, 1e-6);
    bis_image_clear(&a);
}

static void every_letter_is_drawn_and_unlike_all_others(void **state)
{
    (void)state;
    const char *letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijkmnopqrstuvwxyz0123456789.,:;!?()[]<>+-*/=%'\"_|~";
    const size_t n = strlen(letters);
    bis_image *drawn = calloc(n, sizeof *drawn);
    for (size_t i = 0; i < n; i++) {
        const char text[2] = {letters[i], '\0'};
        drawn[i] = blank();
        bis_canvas_text(&drawn[i], 40, 60, 27, white, text);
        assert_true(ink(&drawn[i]) > 8);
        for (size_t k = 0; k < i; k++) {
            double difference = 0;
            for (int p = 0; p < W * H; p++) difference += fabs((double)drawn[i].pixels[p].r - (double)drawn[k].pixels[p].r);
            if (difference < 8) fail_msg("'%c' looks like '%c': %g", letters[i], letters[k], difference);
        }
    }
    for (size_t i = 0; i < n; i++) bis_image_clear(&drawn[i]);
    free(drawn);
}

/* Left, right, top and bottom of the ink. */
static void extent(int box[4], const bis_image *a)
{
    box[0] = W;
    box[1] = box[3] = -1;
    box[2] = H;
    for (int y = 0; y < H; y++) {
        for (int x = 0; x < W; x++) {
            if (a->pixels[y * W + x].r < 0.2f) continue;
            box[0] = x < box[0] ? x : box[0];
            box[1] = x > box[1] ? x : box[1];
            box[2] = y < box[2] ? y : box[2];
            box[3] = y > box[3] ? y : box[3];
        }
    }
}

static void text_stands_where_it_is_put(void **state)
{
    (void)state;
    int box[4];
    bis_image a = blank();
    const double width = bis_canvas_text(&a, 30, 80, 18, white, "HIH");
    assert_near(width, bis_canvas_text_width(18, "HIH"), 1e-12);
    extent(box, &a);
    assert_near(box[0], 29, 1.5);  /* half a pen to the left */
    assert_near(box[2], 61, 1.5);  /* the height of a capital above the base line, and half a pen */
    assert_near(box[3], 80, 1.5);
    assert_true(box[1] < 30 + width && box[1] > 30 + width - 9);
    bis_image_clear(&a);
    a = blank();
    bis_canvas_text_right(&a, 190, 80, 18, white, "HIH");
    extent(box, &a);
    assert_true(box[1] < 190 && box[1] > 181);
    bis_image_clear(&a);
    a = blank();
    bis_canvas_text_middle(&a, 100, 80, 18, white, "HIH");
    extent(box, &a);
    assert_near((box[0] + box[1]) / 2.0, 100, 4);
    bis_image_clear(&a);
}

static void exponents_are_raised_and_indices_lowered_to_the_next_blank(void **state)
{
    (void)state;
    int plain[4], raised[4], lowered[4], after[4];
    const char *texts[] = {"H", "^H", "`H", "^ H"};
    int *boxes[] = {plain, raised, lowered, after};
    for (int i = 0; i < 4; i++) {
        bis_image a = blank();
        bis_canvas_text(&a, 30, 80, 18, white, texts[i]);
        extent(boxes[i], &a);
        bis_image_clear(&a);
    }
    assert_true(raised[3] < plain[3] - 5 && raised[2] < plain[2]);
    assert_true(lowered[3] > plain[3] + 2 && lowered[2] > plain[2]);
    assert_true(after[3] == plain[3] && after[2] == plain[2]);
}

static void hotter_is_lighter(void **state)
{
    (void)state;
    double last = -1;
    for (int i = 0; i <= 1000; i++) {
        const rgb c = bis_palette_heat(i / 1000.0);
        const double grey = 0.2126 * (double)c.r + 0.7152 * (double)c.g + 0.0722 * (double)c.b;
        assert_true(grey > last);
        last = grey;
    }
    assert_true(memcmp(&(rgb){bis_palette_heat(-3).r, bis_palette_heat(-3).g, bis_palette_heat(-3).b},
                       &(rgb){bis_palette_heat(0).r, bis_palette_heat(0).g, bis_palette_heat(0).b}, sizeof(rgb)) == 0);
    assert_near((double)bis_palette_srgb(0.5, 0, 0).r, 0.21404, 1e-5); /* IEC 61966-2-1 */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shapes_cover_their_areas),
        cmocka_unit_test(what_lies_outside_is_cut_off),
        cmocka_unit_test(colours_blend),
        cmocka_unit_test(every_letter_is_drawn_and_unlike_all_others),
        cmocka_unit_test(text_stands_where_it_is_put),
        cmocka_unit_test(exponents_are_raised_and_indices_lowered_to_the_next_blank),
        cmocka_unit_test(hotter_is_lighter),
    };
    return cmocka_run_group_tests_name("canvas", tests, NULL, NULL);
}
