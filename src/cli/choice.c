/* SPDX-License-Identifier: BSD-2-Clause */
/* choice: integrator "auto" under `bis render`: a pilot renders a little, and chooses. */
#include "choice.h"

#include "render/ranks.h"
#include "tools/describe.h"

/* desc->view.settings becomes what the pilot chose, or the default if the render is too short for one, and is told. */
static bis_status run_pilot(bis_auto_report *choice, const bis_scene *scene, bis_scene_desc *desc,
                            const bis_render_options *options, bool quiet, bis_diag *diag)
{
    char line[BIS_MAX_LINE];
    bis_status status = bis_auto_choose(choice, scene, desc, options, diag);

    if (status) return status;
    desc->view.settings = choice->settings;
    if (quiet) return BIS_OK;
    fprintf(stderr, "bis: note: auto %s%s\n", choice->is_chosen ? "chose " : "takes the default, ",
            bis_describe_choice(line, choice));
    return BIS_OK;
}

/* A checkpoint knows what was chosen: no pilot. */
static void choose_again(bis_auto_report *choice, bis_scene_desc *desc, const bis_checkpoint *c, bool quiet)
{
    char line[BIS_MAX_LINE];

    *choice = (bis_auto_report){.is_chosen = true, .settings = c->head.settings, .seconds = c->head.pilot_seconds};
    desc->view.settings = choice->settings;
    bis_describe_line(line, &choice->settings, true);
    if (!quiet) fprintf(stderr, "bis: note: auto goes on with %s, as the checkpoint says\n", line);
}

/* What rank 0 has chosen, to all ranks. */
static bis_status tell_choice(bis_scene_desc *desc, bis_status status, bis_diag *diag)
{
    bis_ranks *ranks = bis_cli_ranks;
    char name[32] = "";

    status = bis_ranks_agree(ranks, status, diag);
    if (status || !ranks) return status;
    bis_settings s = desc->view.settings;
    snprintf(name, sizeof name, "%s", s.integrator->name);
    ranks->broadcast(ranks, name, sizeof name);
    ranks->broadcast(ranks, &s, sizeof s);
    s.integrator = bis_integrator_find(name); /* an address is of one process */
    desc->view.settings = s;
    return BIS_OK;
}

bis_status bis_choice_make(bis_auto_report *choice, const bis_scene *scene, bis_scene_desc *desc,
                           const bis_render_options *options, const bis_checkpoint *checkpoint, bool quiet,
                           bis_diag *diag)
{
    bis_status status = BIS_OK;

    if (bis_rank_leads(bis_cli_ranks)) {
        if (checkpoint->head.settings.integrator) choose_again(choice, desc, checkpoint, quiet);
        else status = run_pilot(choice, scene, desc, options, quiet, diag);
    }
    return tell_choice(desc, status, diag);
}
