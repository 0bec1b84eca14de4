/* SPDX-License-Identifier: BSD-2-Clause */
/* cmd_compare: `bis compare A B`: the figures of bis/compare.h as lines of "key value" or as JSON. */
#include "bis/tools/compare.h"
#include "bis/base/file.h"
#include "bis/files/image_file.h"

#include "cli.h"
#include "tools/json.h"

typedef struct compare_options {
    bool json, has_tolerance;
    double tolerance;
    const char *diff;
} compare_options;

/* As lines "rmse 0.0123" or as JSON: the same keys in the same order. */
static void print_figures(const bis_comparison *c, bool as_json)
{
    const bis_json_member figures[] = {
        {"mean_a", c->mean_a}, {"mean_b", c->mean_b}, {"bias", c->bias}, {"bias_se", c->bias_se},
        {"rmse", c->rmse}, {"relmse", c->relmse}, {"max_abs", c->max_abs},
        {"pixels", (double)c->pixels}, {"nonfinite", (double)c->nonfinite},
    };
    const size_t n = sizeof figures / sizeof *figures;
    bis_json j = {.out = stdout};
    char number[32];

    for (size_t i = 0; i < n && !as_json; i++) {
        const double v = figures[i].value;
        printf("%s %s\n", figures[i].key, isnan(v) ? "nan" : bis_format_double(number, v));
    }
    if (!as_json) return;
    bis_json_open(&j, NULL, '{');
    bis_json_numbers(&j, figures, n);
    bis_json_close(&j);
}

static bis_status write_difference(const char *path, const bis_image *a, const bis_image *b, bis_diag *diag)
{
    bis_image image;
    bis_status status = bis_compare_picture(&image, a, b, diag);
    if (status) return status;
    status = bis_image_save_colours(&image, path, diag);
    bis_image_clear(&image);
    return status;
}

static bis_status check_output(const char *path, bis_diag *diag)
{
    if (!bis_image_can_write(path))
        return bis_error(diag, BIS_INPUT, bis_cli_loc, "--diff \"%s\": the ending must be .exr, .pfm, .hdr or .png",
                         path);
    return bis_cli_check_writable(path, diag);
}

/* Pictures of one size whose files have other parts of it are compared where both have pixels. A file of the size of
 * the other's part, as the PFM of a crop, tells no place. paths: of messages. */
static bis_status align(bis_image image[2], const bis_image_place place[2], const char *const *paths, bis_diag *diag)
{
    const bis_image_place *a = &place[0], *b = &place[1];
    const bool same_picture = a->full_width == b->full_width && a->full_height == b->full_height;
    const bool whole[2] = {image[0].width == a->full_width && image[0].height == a->full_height,
                           image[1].width == b->full_width && image[1].height == b->full_height};
    if (whole[0] && whole[1] && same_picture && (a->left != b->left || a->top != b->top))
        bis_warn(diag, (bis_loc){0}, "their display windows begin at (%d, %d) and (%d, %d): if they are crops of one "
                 "picture, these are other places of it", a->left, a->top, b->left, b->top);
    if ((whole[0] && whole[1]) || (same_picture && a->x0 == b->x0 && a->y0 == b->y0 &&
                                   image[0].width == image[1].width && image[0].height == image[1].height))
        return BIS_OK; /* or sizes that bis_compare refuses */
    if (!same_picture && whole[0] == whole[1])
        return bis_error(diag, BIS_INPUT, (bis_loc){0}, "they are parts of pictures (display windows) of %d x %d and "
                         "%d x %d pixels, which cannot be compared", a->full_width, a->full_height, b->full_width,
                         b->full_height);
    if (!same_picture) {
        bis_warn(diag, (bis_loc){paths[whole[1]], 0, 0}, "its data window is a part of its display window, and the "
                 "other file tells no window: it is taken for the same part");
        return BIS_OK;
    }
    const int x = a->x0 > b->x0 ? a->x0 : b->x0, y = a->y0 > b->y0 ? a->y0 : b->y0;
    const int right[2] = {a->x0 + image[0].width, b->x0 + image[1].width};
    const int bottom[2] = {a->y0 + image[0].height, b->y0 + image[1].height};
    const int width = right[right[1] < right[0]] - x, height = bottom[bottom[1] < bottom[0]] - y;
    if (width < 1 || height < 1)
        return bis_error(diag, BIS_INPUT, (bis_loc){0}, "their data windows lie at other places of the picture, and no "
                         "pixel is in both: they cannot be compared");
    bis_warn(diag, (bis_loc){0}, "their data windows differ: the %d x %d pixels are compared that both have", width,
             height);
    for (int i = 0; i < 2; i++) bis_image_cut(&image[i], x - place[i].x0, y - place[i].y0, width, height);
    return BIS_OK;
}

/* An image that cannot be read, be it missing or damaged, is status 1; images that cannot be compared are bad usage. */
static int compare(void *options, const char *const *paths, bis_diag *diag)
{
    const compare_options *o = options;
    bis_image image[2] = {{0}};
    bis_image_place place[2];
    bool is_screen[2];
    bis_comparison c;
    int exit_status = BIS_EXIT_FAILED;
    bis_status status;

    if (o->diff) {
        status = check_output(o->diff, diag);
        if (!status) status = bis_cli_check_distinct(paths, 2, &o->diff, 1, diag);
        if (status) return bis_cli_exit_status(status);
    }
    for (int i = 0; i < 2; i++)
        if (bis_image_read_part(&image[i], &is_screen[i], &place[i], paths[i], (bis_loc){0}, diag)) goto done;
    if (is_screen[0] != is_screen[1])
        bis_warn(diag, (bis_loc){paths[is_screen[1]], 0, 0},
                 "it holds what a screen shows, exposed and clipped: compare it with another such");
    status = align(image, place, paths, diag);
    if (!status) status = bis_compare(&c, &image[0], &image[1], diag);
    if (!status && o->diff) status = write_difference(o->diff, &image[0], &image[1], diag);
    exit_status = bis_cli_exit_status(status);
    if (status) goto done;
    print_figures(&c, o->json);
    /* Written so that a relMSE of NaN, no pixel compared, is no success. */
    if (o->has_tolerance && !(c.relmse <= o->tolerance)) exit_status = BIS_EXIT_FAILED;
done:
    for (int i = 0; i < 2; i++) bis_image_clear(&image[i]);
    return exit_status;
}

int bis_cmd_compare(int argc, char **argv)
{
    compare_options o = {0};
    const bis_option options[] = {
        {.help = "options"},
        {.name = "json", .help = "print JSON instead of lines of \"key value\"", .kind = BIS_OPTION_FLAG,
         .value = &o.json},
        {.name = "tolerance", .argument = "T", .help = "exit with status 1 where relmse exceeds T",
         .kind = BIS_OPTION_REAL, .value = &o.tolerance, .given = &o.has_tolerance, .hi = (double)INFINITY},
        {.name = "diff", .argument = "F",
         .help = "write the relative difference in false colours: black, blue, red, yellow, white from 1e-3 to 10 on "
                 "a logarithmic scale; magenta: not finite", .kind = BIS_OPTION_TEXT, .value = &o.diff},
    };
    const bis_command command = {
        .name = "compare",
        .usage = "compare [options] A B",
        .summary = "compare image A with reference B (EXR, PFM, HDR, PNG)",
        .options = options, .n_options = sizeof options / sizeof *options,
        .min_operands = 2, .max_operands = 2,
        .notes = "Printed: mean_a mean_b bias bias_se rmse relmse max_abs pixels nonfinite.\n"
                 "  bias     mean_a - mean_b\n"
                 "  bias_se  standard deviation of the pixels' differences / sqrt(pixels)\n"
                 "  relmse   mean of (a-b)^2 / (b^2 + m^2/100) over pixels and channels,\n"
                 "           m the mean of b\n"
                 "Pixels with a NaN or infinity in either image are counted as nonfinite and\n"
                 "left out of all else. Crops of one picture (EXR) are compared where both have\n"
                 "pixels. Images of other sizes or places: exit status 2.\n",
    };
    return bis_cli_run(&command, argc, argv, compare, &o);
}
