/* errata_plots: pictures of docs/errata.md for the items that have no switch: FOLDER/errata-E1.png, ...
 *
 *     errata_plots FOLDER [E1...]        (default: all, some ten seconds)
 *
 * Seeds are fixed: the same pictures every time. The items that have a switch are rendered, by
 * scripts/figures/errata_figures.sh. */
#include "bis/files/image_file.h"
#include "errata_plots.h"

#include "out/canvas.h"

#include <stdio.h>
#include <string.h>

static const struct item {
    const char *name;
    errata_plot *draw;
} items[] = {
    {"E1", errata_E1}, {"E2", errata_E2}, {"E4", errata_E4}, {"E5", errata_E5}, {"E8", errata_E8},
    {"E9", errata_E9}, {"E10", errata_E10}, {"E11", errata_E11}, {"E12", errata_E12}, {"E14", errata_E14},
    {"E15", errata_E15}, {"E17", errata_E17}, {"E18", errata_E18}, {"E19", errata_E19}, {"E24", errata_E24},
    {"E25", errata_E25}, {"E26", errata_E26}, {"E28", errata_E28}, {"E30", errata_E30}, {"E31", errata_E31},
    {"E32", errata_E32}, {"E33", errata_E33}, {"E35", errata_E35}, {"E36", errata_E36}, {"E37", errata_E37},
};

enum { N_ITEMS = sizeof items / sizeof *items };

static void make(const struct item *item, const char *folder)
{
    bis_image im;
    char path[1024];

    errata_check(bis_image_init(&im, ERRATA_WIDTH, ERRATA_HEIGHT, NULL));
    bis_canvas_box(&im, 0, 0, ERRATA_WIDTH, ERRATA_HEIGHT, errata_grey(1));
    item->draw(&im);

    const float *first = &im.pixels[0].r;
    const bis_channel channels[3] = {{"R", first, 3}, {"G", first + 1, 3}, {"B", first + 2, 3}};
    const bis_picture picture = {.width = im.width, .height = im.height, .full_width = im.width, .full_height = im.height,
                                 .channels = channels, .n_channels = 3, .has_exposure = true};
    snprintf(path, sizeof path, "%s/errata-%s.png", folder, item->name);
    errata_check(bis_image_write(path, &picture, NULL));
    bis_image_clear(&im);
}

int main(int argc, char **argv)
{
    int made = 0;

    for (int i = 0; argc > 1 && i < N_ITEMS; i++) {
        bool wanted = argc == 2;
        for (int k = 2; k < argc; k++) wanted |= strcmp(argv[k], items[i].name) == 0;
        if (wanted) make(&items[i], argv[1]), made++;
    }
    if (made > 0 && (argc == 2 || made == argc - 2)) return 0;
    fprintf(stderr, "usage: errata_plots FOLDER [ITEM...], items that have no switch\n");
    return 2;
}
