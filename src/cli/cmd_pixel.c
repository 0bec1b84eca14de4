/* SPDX-License-Identifier: BSD-2-Clause */
/* cmd_pixel: `bis pixel SCENE X Y`: everything about one pixel (pixel.h), as text or JSON, and CSV files and a page in
 * a folder. */

#include "bis/base/file.h"
#include "bis/base/mem.h"
#include "tools/verify/verify.h"

#include "cli.h"
#include "out/json.h"
#include "tools/pixel/pixel_report.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

typedef struct pixel_options {
    const char *output, *proposal;
    bool json, html, has_candidates, has_shadowrays, has_samples, has_seed;
    uint64_t candidates, shadowrays, samples, seed, repeats;
    bool approximate;
} pixel_options;

/* ---- what is asked ---- */

static bis_status read_places(int place[2], const char *const text[2], const bis_film_desc *film, bis_diag *diag)
{
    const int limit[2] = {film->width, film->height};
    bis_status status = BIS_OK;
    for (int i = 0; i < 2; i++) {
        const char *end = bis_cli_digits(text[i], 0, limit[i] - 1, &place[i]);
        if (end && !*end) continue;
        status = bis_error(diag, BIS_INPUT, bis_cli_loc,
                           "%c is \"%s\", must be an integer in [0, %d]: the film of the scene has %d x %d pixels",
                           "XY"[i], text[i], limit[i] - 1, film->width, film->height);
    }
    return status;
}

/* The scene's integrator with the command line's parameters; those that do not apply to it apply to the others. */
static bis_status override_settings(bis_settings *s, const pixel_options *o, bis_diag *diag)
{
    if (o->has_candidates) s->candidates = (uint32_t)o->candidates;
    if (o->has_shadowrays) s->shadowrays = (uint32_t)o->shadowrays;
    if (o->has_samples) s->samples = (uint32_t)o->samples;
    return bis_settings_check(s, bis_cli_loc, diag);
}

/* The proposal of this name for sir and unoccluded, which has no product. */
static void override_proposal(bis_settings *s, const char *name)
{
    if (s->integrator != &bis_sir && s->integrator != &bis_unoccluded) return;
    for (bis_proposal p = BIS_PROPOSAL_EM; p <= BIS_PROPOSAL_PRODUCT; p++)
        if (strcmp(name, bis_proposal_name(p)) == 0) s->proposal = p;
    if (s->integrator == &bis_unoccluded && s->proposal == BIS_PROPOSAL_PRODUCT) s->proposal = BIS_PROPOSAL_MIX;
}

/* All methods take the command line's numbers. */
static bis_status make_methods(bis_pixel_method list[BIS_PIXEL_MAX_METHODS], size_t *n, const bis_settings *own,
                               const pixel_options *o, bis_diag *diag)
{
    bis_status status = BIS_OK;
    *n = bis_pixel_methods(list, own);
    for (size_t i = 0; i < *n && !status; i++) {
        bis_settings *s = &list[i].settings;
        if (o->proposal) override_proposal(s, o->proposal);
        status = override_settings(s, o, diag);
    }
    return status;
}

/* ---- what is found ---- */

/* Enough estimates for some 150 dots. */
static uint32_t runs_to_show(const bis_settings *s)
{
    const uint32_t rays = bis_parameter_of(s->integrator, "shadowrays") ? s->shadowrays : s->samples;
    return rays >= 150 ? 1 : (150 + rays - 1) / rays;
}

static bis_status ask_methods(bis_pixel_report *r, const pixel_options *o, const bis_sampler *sampler, uint64_t pixel,
                              bis_diag *diag)
{
    bis_status status = BIS_OK;
    for (size_t i = 0; i < r->n_methods && !status; i++) {
        bis_pixel_method *m = &r->methods[i];
        status = bis_pixel_method_run(m, &r->pt, &r->exact, sampler->kind, (uint32_t)o->repeats,
                                      bis_hash(sampler->seed ^ (((uint64_t)i + 2) << 40)), diag);
        if (!status && !m->is_open)
            status = bis_pixel_rays_record(&r->rays[i], &r->pt, &m->settings, sampler, pixel,
                                           runs_to_show(&m->settings), diag);
    }
    return status;
}

static const bis_settings *settings_of_sir(const bis_pixel_report *r)
{
    size_t i = 0;
    while (r->methods[i].settings.integrator != &bis_sir) i++;
    return &r->methods[i].settings;
}

static bis_status ask(bis_pixel_report *r, const pixel_options *o, const bis_scene_desc *desc, bis_diag *diag)
{
    const bis_sampler *sampler = &desc->view.sampler;
    const uint64_t pixel = (uint64_t)r->y * (uint64_t)desc->view.film.width + (uint64_t)r->x;
    bis_stream stream;

    bis_status status = bis_pixel_exact_of(&r->exact, &r->pt, BIS_PIXEL_MAX_PATCHES,
                                           bis_hash(sampler->seed ^ ((uint64_t)1 << 40)), diag);
    if (!status) status = ask_methods(r, o, sampler, pixel, diag);
    if (status) return status;
    bis_stream_init(&stream, sampler, pixel, 0);
    return bis_pixel_candidates_draw(&r->candidates, &r->pt, settings_of_sir(r), &stream, diag);
}

/* ---- where it goes ---- */

static bis_status make_folder(const char *path, bis_diag *diag)
{
    struct stat st;
    if (mkdir(path, 0777) == 0) return BIS_OK;
    const int reason = errno;
    if (reason == EEXIST && stat(path, &st) == 0 && S_ISDIR(st.st_mode)) return BIS_OK;
    if (reason == EEXIST)
        return bis_error(diag, BIS_IO, bis_cli_loc, "--output \"%s\": it is there already, and is no folder", path);
    return bis_error(diag, BIS_IO, bis_cli_loc, "--output \"%s\": the folder cannot be made: %s", path,
                     strerror(reason));
}

static bis_status check_files(const char *folder, bis_diag *diag)
{
    char path[PATH_MAX];
    if (snprintf(path, sizeof path, "%s/methods.csv", folder) < (int)sizeof path)
        return bis_cli_check_writable(path, diag);
    return bis_error(diag, BIS_IO, bis_cli_loc, "--output \"%s\": the name is too long", folder);
}

/* An answer without files: nothing is hit, or nothing reflected. */
static bis_status report_all(bis_pixel_report *r, const pixel_options *o, const bis_scene_desc *desc, bis_diag *diag)
{
    if (!r->why_nothing) {
        bis_status status = make_folder(r->folder, diag); /* before the work, whose files could go nowhere */
        if (!status) status = check_files(r->folder, diag);
        if (!status) status = ask(r, o, desc, diag);
        if (!status) status = bis_pixel_write_files(r, diag);
        if (status) return status;
    }
    if (o->json) bis_pixel_print_json(stdout, r);
    else bis_pixel_print_text(stdout, r);
    return BIS_OK;
}

static const char *why_nothing(const bis_pixel_report *r)
{
    if (!r->is_hit) return "no surface: the camera looks past all shapes";
    if (bis_light_is_black(r->scene->light)) return "no light: the scene has none, or a black one";
    if (rgb_is_black(r->hit.material->Kd) && rgb_is_black(r->hit.material->Ks))
        return "no reflection: the material is black";
    if (bis_bsdf_is_black(&r->pt.bsdf)) return "no reflection: the eye lies below the horizon of the shading normal";
    return NULL;
}

static bis_status build_and_report(bis_pixel_report *r, const pixel_options *o, bis_scene_desc *desc, bis_diag *diag)
{
    bis_scene *scene = NULL;
    bis_counters counters = {0};

    desc->light_needs = BIS_VERIFY_LIGHT_NEEDS;
    bis_status status = bis_scene_build(&scene, desc, diag);
    if (!status) {
        r->scene = scene;
        r->is_hit = bis_pixel_find(&r->hit, &r->pt, scene, r->x, r->y, &counters);
        r->why_nothing = why_nothing(r);
        status = report_all(r, o, desc, diag);
    }
    bis_scene_free(scene);
    return status;
}

static int pixel(void *options, const char *const *operand, bis_diag *diag)
{
    const pixel_options *o = options;
    bis_pixel_report *r = bis_alloc(1, sizeof *r);
    bis_scene_desc *desc = NULL;
    bis_status status = BIS_NOMEM;
    int place[2];
    char folder[64];

    if (!r) {
        bis_error(diag, BIS_NOMEM, bis_cli_loc, "no memory");
        goto done;
    }
    status = bis_cli_parse_scene(&desc, operand[0], o->approximate ? BIS_PARSE_APPROXIMATE : 0, diag);
    if (!status) status = read_places(place, operand + 1, &desc->view.film, diag);
    if (status) goto done;
    if (o->has_seed) desc->view.sampler.seed = o->seed;
    status = make_methods(r->methods, &r->n_methods, &desc->view.settings, o, diag);
    if (status) goto done;
    snprintf(folder, sizeof folder, "pixel_%d_%d", place[0], place[1]);
    r->x = place[0];
    r->y = place[1];
    r->desc = desc;
    r->folder = o->output ? o->output : folder;
    r->html = o->html;
    status = build_and_report(r, o, desc, diag);
done:
    bis_pixel_report_clear(r);
    bis_free(r);
    bis_scene_desc_free(desc);
    return bis_cli_exit_status(status);
}

int bis_cmd_pixel(int argc, char **argv)
{
    static const char *const proposals[] = {"em", "brdf", "mix", "product", NULL};
    pixel_options o = {.repeats = 2000};
    const bis_option options[] = {
        {.help = "what to write"},
        {.name = "output", .argument = "DIR",
         .help = "the folder for CSV files and the page, made where it is missing (pixel_X_Y)", .kind = BIS_OPTION_TEXT,
         .value = &o.output},
        {.name = "html", .help = "write pixel.html, too: a page to explore, in one file that needs nothing else",
         .kind = BIS_OPTION_FLAG, .value = &o.html},
        {.name = "json", .help = "print JSON instead of text", .kind = BIS_OPTION_FLAG, .value = &o.json},
        {.help = "what to compute (these override the scene file, for all methods)"},
        {.name = "approximate",
         .help = "what of pbrt bis does not model is replaced by the nearest that it does, and listed",
         .kind = BIS_OPTION_FLAG, .value = &o.approximate},
        {.name = "candidates", .argument = "M", .help = "rejection, sir, unoccluded: candidates",
         .kind = BIS_OPTION_COUNT, .value = &o.candidates, .given = &o.has_candidates, .lo = 1, .hi = 1 << 20},
        {.name = "shadowrays", .argument = "N", .help = "rejection, sir: candidates that are shadow-tested",
         .kind = BIS_OPTION_COUNT, .value = &o.shadowrays, .given = &o.has_shadowrays, .lo = 1, .hi = 1 << 20},
        {.name = "samples", .argument = "N", .help = "em, brdf, mis: light samples, at least 2",
         .kind = BIS_OPTION_COUNT, .value = &o.samples, .given = &o.has_samples, .lo = 2, .hi = 1 << 20},
        {.name = "proposal", .argument = "P", .help = "sir, unoccluded: em, brdf or mix; sir: product",
         .kind = BIS_OPTION_NAME, .value = &o.proposal, .names = proposals},
        {.name = "repeats", .argument = "R", .help = "estimates by each method, for its mean and its error (2000)",
         .kind = BIS_OPTION_COUNT, .value = &o.repeats, .lo = 2, .hi = 1e8},
        {.name = "seed", .argument = "N", .help = "of the random numbers (the scene's)", .kind = BIS_OPTION_COUNT,
         .value = &o.seed, .given = &o.has_seed, .hi = BIS_SEED_MAX},
    };
    const bis_command command = {
        .name = "pixel",
        .usage = "pixel [options] SCENE X Y",
        .summary = "everything about one pixel: the hit, the exact integral, every method against it; candidates, "
                   "weights and samples",
        .options = options, .n_options = sizeof options / sizeof *options,
        .min_operands = 3, .max_operands = 3,
        .notes = BIS_CLI_SCENE_NOTE
                 "\n"
                 "X counts from the left, Y from the top, both from 0, in the scene's film. The\n"
                 "ray goes through the pixel's centre. The folder gets methods.csv, candidates.csv\n"
                 "and rays.csv; with --html also pixel.html: figure 4.1 of the thesis (map, BRDF,\n"
                 "product), figure 4.2 (where each method looks), and the tables.\n",
    };
    return bis_cli_run(&command, argc, argv, pixel, &o);
}
