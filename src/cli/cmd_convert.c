/* SPDX-License-Identifier: BSD-2-Clause */
/* cmd_convert: `bis convert A B`: a picture from one format to another, with exposure and a tone curve. */
#include "bis/base/file.h"
#include "bis/files/image_file.h"
#include "files/image_png.h"

#include "cli.h"
#include "tone.h"

#include <string.h>

typedef struct convert_options {
    bool has_exposure;
    double exposure;
    const char *tone;
} convert_options;

static bis_status check(const convert_options *o, const char *const *paths, bool to_png, bis_diag *diag)
{
    if (!bis_image_can_write(paths[1]))
        return bis_error(diag, BIS_INPUT, bis_cli_loc,
                         "output file \"%s\": the ending must be .exr, .pfm, .hdr or .png", paths[1]);
    if (o->tone && !to_png)
        return bis_error(diag, BIS_INPUT, bis_cli_loc,
                         "--tone is for a .png: the other formats hold radiance, which a curve would spoil");
    bis_status status = bis_cli_check_writable(paths[1], diag);
    if (!status) status = bis_cli_check_distinct(paths, 1, paths + 1, 1, diag);
    return status;
}

static bis_status save(const convert_options *o, bis_image *image, bool is_screen, const char *path, bool to_png,
                       bis_diag *diag)
{
    bis_channel channels[4];
    const bis_picture picture = bis_image_picture(image, channels);
    const bis_tone tone = o->tone ? bis_tone_find(o->tone) : BIS_TONE_NONE;
    /* a picture that was exposed already keeps its exposure */
    const double own = to_png && !is_screen ? bis_png_exposure(&picture) : 0, ev = o->has_exposure ? o->exposure : own;

    if (ev != 0 || tone != BIS_TONE_NONE) bis_tone_apply(image, ev, tone);
    bis_status status = bis_image_save_colours(image, path, diag);
    if (status) return status;
    printf("wrote %s: %d x %d pixels", path, image->width, image->height);
    if (to_png) printf(", exposure %.4g, tone %s", ev, bis_tone_names[tone]);
    printf("\n");
    return BIS_OK;
}

static int convert(void *options, const char *const *paths, bis_diag *diag)
{
    const convert_options *o = options;
    char ending[8];
    const bool to_png = strcmp(bis_path_extension(ending, paths[1]), ".png") == 0;
    bis_image image = {0};
    bool is_screen;

    bis_status status = check(o, paths, to_png, diag);
    if (status) return bis_cli_exit_status(status);
    if (bis_image_read_any(&image, &is_screen, paths[0], (bis_loc){0}, diag)) return BIS_EXIT_FAILED;
    if (is_screen && !to_png)
        bis_warn(diag, (bis_loc){paths[0], 0, 0}, "it holds what a screen shows, exposed and clipped, no radiance");
    status = save(o, &image, is_screen, paths[1], to_png, diag);
    bis_image_clear(&image);
    return bis_cli_exit_status(status);
}

int bis_cmd_convert(int argc, char **argv)
{
    convert_options o = {0};
    const bis_option options[] = {
        {.help = "options"},
        {.name = "exposure", .argument = "EV",
         .help = "multiply by 2^EV (default: 0, and for a PNG what takes the log-average of the luminance to middle "
                 "grey)", .kind = BIS_OPTION_REAL, .value = &o.exposure, .given = &o.has_exposure, .lo = -100,
         .hi = 100},
        {.name = "tone", .argument = "CURVE",
         .help = "of a PNG: none (the default: what is brighter than white is white), reinhard (L/(1+L) of the "
                 "luminance) or filmic (a fit of the ACES curve)", .kind = BIS_OPTION_NAME, .value = &o.tone,
         .names = bis_tone_names},
    };
    const bis_command command = {
        .name = "convert",
        .usage = "convert [options] A B",
        .summary = "write picture A (EXR, PFM, HDR, PNG) as B, by its ending .exr, .pfm, .hdr or .png",
        .options = options, .n_options = sizeof options / sizeof *options,
        .min_operands = 2, .max_operands = 2,
        .notes = "R, G, B and alpha are converted (PFM and HDR have no alpha); layers and the\n"
                 "header of an EXR stay behind.\n",
    };
    return bis_cli_run(&command, argc, argv, convert, &o);
}
