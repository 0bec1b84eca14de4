/* SPDX-License-Identifier: BSD-2-Clause */
/* still: the list of figures that need no scene, and how their numbers are written. Seeds are fixed: the same numbers
 * every time. The items of docs/errata.md that have a switch are rendered, by scripts/figures/errata_figures.sh. */
#include "still.h"

#include "bis/base/file.h"
#include "out/page.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const struct item {
    const char *name;
    still_figure *write;
} items[] = {
    {"3.3", thesis_marsaglia}, {"3.4", thesis_alias}, {"3.8", thesis_phong}, {"3.9", thesis_draws},
    {"4.3", thesis_rejection}, {"4.4", thesis_bounds}, {"4.5", thesis_resampling},
    {"E1", errata_E1}, {"E2", errata_E2}, {"E4", errata_E4}, {"E5", errata_E5}, {"E8", errata_E8},
    {"E9", errata_E9}, {"E10", errata_E10}, {"E11", errata_E11}, {"E12", errata_E12}, {"E14", errata_E14},
    {"E15", errata_E15}, {"E17", errata_E17}, {"E18", errata_E18}, {"E19", errata_E19}, {"E24", errata_E24},
    {"E25", errata_E25}, {"E26", errata_E26}, {"E28", errata_E28}, {"E30", errata_E30}, {"E31", errata_E31},
    {"E32", errata_E32}, {"E33", errata_E33}, {"E35", errata_E35}, {"E36", errata_E36}, {"E37", errata_E37},
};

enum { N_ITEMS = sizeof items / sizeof *items };

void still_check(bis_status status)
{
    if (!status) return;
    fprintf(stderr, "figures: the library returned status %d\n", (int)status);
    exit(1);
}

void still_list(bis_json *j, const char *key, const double *v, int n)
{
    bis_json_open(j, key, '[');
    for (int i = 0; i < n; i++) bis_json_number(j, NULL, v[i]);
    bis_json_close(j);
}

bis_image still_field(int width, int height)
{
    bis_image field;

    still_check(bis_image_init(&field, width, height, NULL));
    return field;
}

void still_picture(bis_json *j, const char *key, bis_image *image)
{
    char *png = bis_page_png(image, 0, NULL);

    if (!png) still_check(BIS_NOMEM);
    bis_json_text(j, key, png);
    free(png);
    bis_image_clear(image);
}

static void write_item(const struct item *item, const char *folder)
{
    bis_outfile *file;
    char path[1024];

    snprintf(path, sizeof path, "%s/%s.json", folder, item->name);
    still_check(bis_outfile_open(&file, path, NULL));
    bis_json j = {.out = bis_outfile_stream(file)};
    bis_json_open(&j, NULL, '{');
    item->write(&j);
    bis_json_close(&j);
    still_check(bis_outfile_commit(file, NULL));
}

bool still_write(const char *folder, char *const *names, int n)
{
    int made = 0;

    for (int i = 0; i < N_ITEMS; i++) {
        bool wanted = n == 0;
        for (int k = 0; k < n; k++) wanted |= strcmp(names[k], items[i].name) == 0;
        if (wanted) write_item(&items[i], folder), made++;
    }
    return n == 0 || made == n;
}
