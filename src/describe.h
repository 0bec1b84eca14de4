/* describe: what was rendered and how, in names and numbers, for EXR attributes and --stats. For src/cmd_*.c. */
#ifndef BIS_DESCRIBE_H
#define BIS_DESCRIBE_H

#include "auto.h"

#include "bis/image.h"
#include "bis/render.h"
#include "bis/scene.h"

#include <stdio.h>

enum { BIS_MAX_PARAMETERS = 8, BIS_MAX_ATTRIBUTES = BIS_MAX_PARAMETERS + 10, BIS_MAX_LINE = 512 };

/* Has this integrator the parameter of SPEC 3 with that name ("candidates")? */
bool bis_integrator_uses(const bis_integrator *integrator, const char *parameter);

/* The parameters that the integrator reads, in the order of SPEC 3; returns their number. Texts are static. */
int bis_describe_settings(const bis_settings *s, bis_attribute parameters[BIS_MAX_PARAMETERS]);

/* The same as a scene file would say it: Integrator "sir" "integer candidates" 256 ... */
const char *bis_describe_line(char line[BIS_MAX_LINE], const bis_settings *s);

/* What auto has chosen, and how much longer the best of each other method would take to the same error, in one line.
 * The report must have a choice. */
const char *bis_describe_choice(char line[BIS_MAX_LINE], const bis_auto_report *r);

/* Everything that --stats tells. seconds.write and .total are those so far. */
typedef struct bis_stats {
    const bis_scene_desc *desc;
    const bis_scene *scene;
    const bis_film *film;
    const bis_render_result *result;
    bis_scene_seconds seconds;
    char as_printed[BIS_ERRATA_TEXT]; /* of the settings, by bis_errata_text */
    const bis_auto_report *choice;    /* NULL: nothing was to choose */
    char line[BIS_MAX_LINE];          /* of the settings, by bis_describe_line */
} bis_stats;

/* Header attributes of an EXR: scene, integrator, its parameters, asprinted (where some are), adaptive (where it is),
 * bis:auto (the chosen line for a scene, where auto chose), spp, seed, render_seconds, estimated_relative_rmse (where
 * known), bis:version ("version" alone is reserved by OpenEXR). */
int bis_describe_picture(const bis_stats *s, bis_attribute attributes[BIS_MAX_ATTRIBUTES]);

/* The JSON of --stats, keys as SPEC 5; what does not apply is null. */
void bis_stats_print(const bis_stats *s, FILE *out);

#endif
