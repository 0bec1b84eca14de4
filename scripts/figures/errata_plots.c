/* SPDX-License-Identifier: BSD-2-Clause */
/* errata_plots: pictures of docs/errata.md for the items that have no switch: FOLDER/errata-E1.json, ... (drawing.h)
 *
 *     errata_plots FOLDER [E1...]        (default: all, some ten seconds)
 *
 * Seeds are fixed: the same pictures every time. The items that have a switch are rendered, by
 * scripts/figures/errata_figures.sh. */
#include "bis/base/file.h"
#include "errata_plots.h"

#include "drawing.h"

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
    bis_outfile *file;
    char path[1024];

    snprintf(path, sizeof path, "%s/errata-%s.json", folder, item->name);
    errata_check(bis_outfile_open(&file, path, NULL));
    drawing_begin(bis_outfile_stream(file), ERRATA_WIDTH, ERRATA_HEIGHT);
    item->draw(bis_outfile_stream(file));
    drawing_end(bis_outfile_stream(file));
    errata_check(bis_outfile_commit(file, NULL));
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
