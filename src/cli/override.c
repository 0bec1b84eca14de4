/* SPDX-License-Identifier: BSD-2-Clause */
/* override: what the command line of `bis render` says of the integrator, the sampler, the film and the accelerator is
 * put in place of what the scene file says. */
#include "override.h"

#include "base/text.h"
#include "bis/base/file.h"
#include "bis/base/mem.h"
#include "bis/render/film.h"

#include <string.h>

bool bis_override_read_crop(void *value, const char *text) { return bis_film_read_crop(value, text); }

/* The errata to render as printed: those of the scene and of the command line. */
static bis_status switch_errata(bis_settings *s, const bis_texts *names, bis_diag *diag)
{
    bis_status status = BIS_OK;
    char hint[BIS_HINT];

    for (int i = 0; i < names->n; i++) {
        const bis_erratum *e = bis_erratum_find(names->text[i]);
        if (e) s->as_printed |= e->flag;
        else
            status = bis_error(diag, BIS_INPUT, bis_cli_loc,
                               "--as-printed: no erratum \"%s\" can be switched%s; `bis --as-printed list` lists them",
                               names->text[i], bis_hint(hint, bis_erratum_nearest(names->text[i])));
    }
    for (const bis_erratum *e = bis_errata; e->name; e++) {
        if (!(s->as_printed & e->flag) || bis_erratum_reaches(e, s->integrator->name)) continue;
        bis_warn(diag, bis_cli_loc, "%s as printed has no effect on integrator \"%s\", only on: %s", e->name,
                 s->integrator->name, e->integrators);
    }
    return status;
}

static bis_status override_settings(bis_scene_desc *d, const bis_override *o, bis_diag *diag)
{
    bis_settings *s = &d->view.settings;

    if (o->integrator) bis_scene_name_integrator(d, bis_integrator_find(o->integrator), bis_cli_loc);
    bis_parameter_override(s, o->parameters, diag);
    if (bis_parameter_given(o->parameters, "learn") && s->learn && s->proposal != BIS_PROPOSAL_PRODUCT &&
        bis_parameter_of(s->integrator, "learn"))
        bis_warn(diag, bis_cli_loc, "--learn has no effect on proposal \"%s\", only on \"product\"",
                 bis_proposal_name(s->proposal));
    bis_status status = switch_errata(s, &o->as_printed, diag);
    return status ? status : bis_settings_check(s, bis_cli_loc, diag);
}

/* --light MAP: the description has a constant in its place, whose frame stands upright (BIS_PARSE_OTHER_LIGHT). */
static bis_status override_light(bis_light_desc *light, const bis_override *o, bis_diag *diag)
{
    const bis_xform turn = bis_xform_rotate(o->light_rotate, 0, 0, 1);

    if (!o->light) {
        if (!o->has_light_rotate && !o->has_light_scale && !o->light_mapping) return BIS_OK;
        return bis_error(diag, BIS_INPUT, bis_cli_loc, "--light-rotate, --light-scale and --light-mapping are about "
                         "the map that --light names: give --light MAP, too");
    }
    light->filename = bis_strdup(o->light);
    if (!light->filename) return bis_error(diag, BIS_NOMEM, bis_cli_loc, "no memory");
    light->is_v4 = true; /* a square map is pbrt-v4's, with a warning */
    light->has_mapping = o->light_mapping != NULL;
    if (light->has_mapping) light->mapping = bis_mapping_find(o->light_mapping);
    light->scale = o->has_light_scale ? o->light_scale : 1;
    light->to_world = bis_xform_compose(&light->to_world, &turn);
    light->loc = bis_cli_loc;
    return BIS_OK;
}

bis_status bis_override_scene(bis_scene_desc *d, const bis_override *o, bis_diag *diag)
{
    bis_status status = override_settings(d, o, diag);
    if (!status) status = override_light(&d->light, o, diag);
    if (!status && o->layers) status = bis_layers_read(&d->view.film.layers, o->layers, "--layers", bis_cli_loc, diag);
    if (status) return status;

    if (o->has_spp) bis_sampler_set_spp(&d->view.sampler, (uint32_t)o->spp);
    if (o->has_seed) d->view.sampler.seed = o->seed;
    if (o->accelerator) d->accel.kind = strcmp(o->accelerator, "grid") == 0 ? BIS_ACCEL_GRID : BIS_ACCEL_EMBREE;
    if (d->accel.kind == BIS_ACCEL_EMBREE && !bis_accel_embree_version())
        return bis_error(diag, BIS_INPUT, bis_cli_loc,
                         "accelerator \"embree\" is not built in; use \"grid\", or build with Embree installed");
    if (o->threads) d->accel.n_threads = (int)o->threads;
    bis_cli_use_threads(o->threads);
    if (o->has_resolution) {
        d->view.film.width = o->resolution[0];
        d->view.film.height = o->resolution[1];
    }
    if (o->has_crop) memcpy(d->view.film.crop, o->crop, sizeof o->crop);
    if (o->no_jitter) d->view.pixel_jitter = false;
    if (o->transparent) d->light.visible = false;
    return BIS_OK;
}
