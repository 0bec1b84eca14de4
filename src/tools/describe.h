/* SPDX-License-Identifier: BSD-2-Clause */
/* describe: what was rendered and how, in names and numbers, for EXR attributes and --stats. For src/cli/cmd_*.c. */
#pragma once

#include "bis/files/image_file.h"
#include "bis/render/render.h"

enum { BIS_MAX_PARAMETERS = 8, BIS_MAX_ATTRIBUTES = BIS_MAX_PARAMETERS + 16, BIS_MAX_LINE = 512,
       BIS_APPROXIMATED_TEXT = 4096 };

/* bis_describe_settings stores the parameters that the integrator reads, in the order of docs/scene-format.md, and
 * returns their number. Texts are static. */
int bis_describe_settings(const bis_settings *s, bis_attribute parameters[BIS_MAX_PARAMETERS]);

/* bis_describe_line writes the same as a scene file would say it: Integrator "sir" "integer candidates" 256 ... all:
 * what has its default, too; else counts and what differs. */
const char *bis_describe_line(char line[BIS_MAX_LINE], const bis_settings *s, bool all);

/* bis_describe_portal writes a portal as a LightSource would say it: "point3 portal" [...]. */
const char *bis_describe_portal(char text[BIS_MAX_LINE], const bis_portal *portal);

/* Everything that --stats tells. seconds.write and .total are those so far. */
typedef struct bis_stats {
    const bis_scene_desc *desc;
    bis_scene_figures scene;
    const bis_film *film;
    const bis_render_result *result;
    bis_scene_seconds seconds;
    char as_printed[BIS_ERRATA_TEXT]; /* of the settings, by bis_errata_text */
    const bis_box *extent;            /* of all shapes; NULL: there are none, or it is not known, after a merge */
    char line[BIS_MAX_LINE];          /* of the Integrator, by bis_describe_line */
    char approximated[BIS_APPROXIMATED_TEXT]; /* what --approximate has replaced; "": nothing was */
} bis_stats;

/* bis_stats_of returns what there is to say of a render: the figures given, the seconds of the render, and the texts
 * that desc makes. The caller adds extent, the seconds of parsing and writing, and the total. desc, film and
 * result are borrowed. */
bis_stats bis_stats_of(const bis_scene_desc *desc, bis_scene_figures scene, bis_scene_seconds seconds,
                       const bis_film *film, const bis_render_result *result);

/* bis_describe_picture stores the header attributes of an EXR and returns their number: scene, integrator, its
 * parameters, asprinted (where some are), bis:approximated (where something is), spp, seed, render_seconds,
 * estimated_relative_rmse (where known), bis:version ("version" alone is reserved by OpenEXR). */
int bis_describe_picture(const bis_stats *s, bis_attribute attributes[BIS_MAX_ATTRIBUTES]);

/* bis_stats_print prints the JSON of --stats, with the keys of docs/command-line.md. What does not apply is null. */
void bis_stats_print(const bis_stats *s, FILE *out);
