/* SPDX-License-Identifier: BSD-2-Clause */
/* describe: settings and figures as attributes of an EXR, as lines of a scene and as the JSON of --stats. */
#include "describe.h"

#include "bis/base/file.h"
#include "bis/base/mem.h"
#include "bis/base/version.h"
#include "base/text.h"
#include "tools/json.h"

#include <assert.h>
#include <string.h>
#include <sys/resource.h>

static bis_attribute attribute(const bis_parameter *p, const bis_settings *s)
{
    const double v = bis_parameter_get(p, s);
    const bool is_number = p->type == BIS_PARAMETER_COUNT || p->type == BIS_PARAMETER_FRACTION;

    return (bis_attribute){p->name, is_number ? NULL : bis_parameter_text(NULL, p, v), is_number ? v : 0};
}

int bis_describe_settings(const bis_settings *s, bis_attribute parameters[BIS_MAX_PARAMETERS])
{
    int n = 0;

    for (const bis_parameter *p = NULL; (p = bis_parameter_next(s->integrator, p)) != NULL;) {
        assert(n < BIS_MAX_PARAMETERS);
        parameters[n++] = attribute(p, s);
    }
    return n;
}

const char *bis_describe_line(char line[BIS_MAX_LINE], const bis_settings *s, bool all)
{
    static const char *const types[] = {[BIS_PARAMETER_COUNT] = "integer", [BIS_PARAMETER_FRACTION] = "float",
                                        [BIS_PARAMETER_BOOL] = "bool", [BIS_PARAMETER_CHOICE] = "string"};
    char buf[32];

    *line = '\0';
    bis_append(line, BIS_MAX_LINE, "Integrator \"%s\"", s->integrator->name);
    for (const bis_parameter *p = NULL; (p = bis_parameter_next(s->integrator, p)) != NULL;) {
        const double v = bis_parameter_get(p, s);
        const char *quote = p->type == BIS_PARAMETER_CHOICE ? "\"" : "";
        if (!all && p->type != BIS_PARAMETER_COUNT && v == p->usual) continue;
        bis_append(line, BIS_MAX_LINE, " \"%s %s\" %s%s%s", types[p->type], p->name, quote,
                   bis_parameter_text(buf, p, v), quote);
    }
    return line;
}

const char *bis_describe_portal(char text[BIS_MAX_LINE], const bis_portal *portal)
{
    char buf[32];

    *text = '\0';
    for (int k = 0; k < 12; k++) {
        const int i = k % 3;
        const double v = portal->corner[i] + (k / 3 % 3 ? portal->edge[0][i] : 0) + (k > 5 ? portal->edge[1][i] : 0);
        bis_append(text, BIS_MAX_LINE, "%s%s", k ? " " : "\"point3 portal\" [", bis_format_double(buf, v));
    }
    bis_append(text, BIS_MAX_LINE, "]");
    return text;
}

/* `3 x AreaLightSource: its light is missing; ...`, behind what text holds. */
static void list_approximations(char text[BIS_APPROXIMATED_TEXT], const bis_scene_desc *desc)
{
    for (size_t i = 0; i < desc->n_approximations; i++) {
        char one[BIS_APPROXIMATION_TEXT];
        bis_append(text, BIS_APPROXIMATED_TEXT, "%s%s", i ? "; " : "",
                   bis_approximation_text(one, &desc->approximations[i]));
    }
}

bis_stats bis_stats_of(const bis_scene_desc *desc, bis_scene_figures scene, bis_scene_seconds seconds,
                       const bis_film *film, const bis_render_result *result)
{
    bis_stats s = {.desc = desc, .scene = scene, .film = film, .result = result, .seconds = seconds};
    bis_describe_line(s.line, &desc->view.settings, true);
    bis_errata_text(s.as_printed, desc->view.settings.as_printed);
    list_approximations(s.approximated, desc);
    s.seconds.render = result->seconds;
    return s;
}

/* Names of our own begin with "bis:", because other programs may give a plain one another meaning. What was not the
 * case has no attribute. */
int bis_describe_picture(const bis_stats *s, bis_attribute attributes[BIS_MAX_ATTRIBUTES])
{
    const bis_render_result *r = s->result;
    int n = 0;

    attributes[n++] = (bis_attribute){"scene", s->desc->path, 0};
    attributes[n++] = (bis_attribute){"integrator", s->desc->view.settings.integrator->name, 0};
    n += bis_describe_settings(&s->desc->view.settings, attributes + n);
    if (*s->as_printed) attributes[n++] = (bis_attribute){"asprinted", s->as_printed, 0};
    if (s->desc->view.edge_samples > 1)
        attributes[n++] = (bis_attribute){"edgesamples", NULL, s->desc->view.edge_samples};
    if (s->desc->view.edge_samples > 1 && s->desc->view.edge_light > 0 && s->desc->view.edge_light < 1)
        attributes[n++] = (bis_attribute){"edgelight", NULL, s->desc->view.edge_light};
    if (*s->approximated) attributes[n++] = (bis_attribute){"bis:approximated", s->approximated, 0};
    attributes[n++] = (bis_attribute){"spp", NULL, (double)r->spp};
    if (r->missing > 0) attributes[n++] = (bis_attribute){"bis:missing", NULL, r->missing};
    attributes[n++] = (bis_attribute){"seed", NULL, (double)s->desc->view.sampler.seed};
    attributes[n++] = (bis_attribute){"render_seconds", NULL, r->seconds};
    if (r->error.is_known)
        attributes[n++] = (bis_attribute){"estimated_relative_rmse", NULL, r->error.relative_rmse};
    if (r->error.has_upper) attributes[n++] = (bis_attribute){"relative_rmse_at_most", NULL, r->error.upper};
    const double raised = bis_film_raised(s->film);
    if (raised > 0) attributes[n++] = (bis_attribute){"bis:raised", NULL, raised};
    attributes[n++] = (bis_attribute){"bis:version", BIS_VERSION, 0};
    return n;
}

/* ---- JSON ---- */

/* A parameter of the integrator, null where it has none of that name. */
static void print_parameter(bis_json *j, const bis_settings *s, const char *name)
{
    const bis_parameter *p = bis_parameter_of(s->integrator, name);
    const bis_attribute a = p ? attribute(p, s) : (bis_attribute){name, NULL, (double)NAN};

    if (a.text) bis_json_text(j, name, a.text);
    else bis_json_number(j, name, a.number);
}

/* A count, null where it does not apply. */
static double count(bool applies, uint64_t v) { return applies ? (double)v : (double)NAN; }

/* Linux counts in KiB. */
static uint64_t peak_memory(void)
{
    struct rusage usage;
    return getrusage(RUSAGE_SELF, &usage) == 0 ? 1024 * (uint64_t)usage.ru_maxrss : 0;
}

static void print_memory(bis_json *j, const bis_stats *s)
{
    bis_json_count(j, "peak_memory_bytes", peak_memory());
    BIS_JSON_OBJECT(j, "memory", {"mesh", s->scene.mesh}, {"accel", s->scene.accel},
                    {"envmap", s->scene.envmap},
                    {"film", (double)(bis_film_bytes(s->film) + s->result->bytes)});
}

/* Without --approximate there is no such key. A picture of parts has them as one text. */
static void print_approximations(bis_json *j, const bis_scene_desc *d, const char *text)
{
    if (!d->n_approximations && *text) bis_json_text(j, "approximated", text);
    if (!d->n_approximations) return;
    bis_json_open(j, "approximated", '[');
    for (size_t i = 0; i < d->n_approximations; i++) {
        const bis_approximation *a = &d->approximations[i];
        bis_json_open(j, NULL, '{');
        bis_json_text(j, "kind", a->kind);
        bis_json_count(j, "count", a->n);
        bis_json_text(j, "consequence", a->consequence);
        bis_json_close(j);
    }
    bis_json_close(j);
}

/* Each as the text of a parameter of the light. Where there is none there is no such key. */
static void print_portals(bis_json *j, const bis_render_result *r)
{
    char text[BIS_MAX_LINE];

    if (!r->n_portals) return;
    bis_json_open(j, "portals", '[');
    for (uint32_t i = 0; i < r->n_portals; i++) bis_json_text(j, NULL, bis_describe_portal(text, &r->portals[i]));
    bis_json_close(j);
}

static void print_extent(bis_json *j, const bis_box *b)
{
    if (!b) {
        bis_json_null(j, "extent");
        return;
    }
    bis_json_open(j, "extent", '{');
    bis_json_triple(j, "low", (double)b->lo.x, (double)b->lo.y, (double)b->lo.z);
    bis_json_triple(j, "high", (double)b->hi.x, (double)b->hi.y, (double)b->hi.z);
    bis_json_close(j);
}

void bis_stats_print(const bis_stats *s, FILE *out)
{
    const bis_settings *settings = &s->desc->view.settings;
    const bis_render_result *r = s->result;
    const bool rejects = bis_parameter_of(settings->integrator, "estimator") != NULL;
    const bis_scene_seconds *t = &s->seconds;
    bis_json j = {.out = out};

    bis_json_open(&j, NULL, '{');
    bis_json_text(&j, "version", BIS_VERSION);
    bis_json_text(&j, "scene", s->desc->path);
    bis_json_text(&j, "integrator", settings->integrator->name);
    print_parameter(&j, settings, "proposal");
    print_parameter(&j, settings, "candidates");
    print_parameter(&j, settings, "shadowrays");
    print_parameter(&j, settings, "samples");
    bis_json_count(&j, "spp", r->spp);
    bis_json_count(&j, "seed", s->desc->view.sampler.seed);
    bis_json_count(&j, "threads", (uint64_t)r->n_threads);
    bis_json_text(&j, "accelerator", *s->scene.accelerator ? s->scene.accelerator : NULL);
    BIS_JSON_NUMBERS(&j, {"triangles", (double)s->scene.triangles}, {"width", s->film->width},
                     {"height", s->film->height});
    print_extent(&j, s->extent);
    BIS_JSON_OBJECT(&j, "seconds", {"parse", t->parse}, {"load", t->load}, {"envmap", t->envmap}, {"accel", t->accel},
                    {"render", t->render}, {"write", t->write}, {"total", t->total});
    BIS_JSON_OBJECT(&j, "rays", {"camera", (double)r->counters.camera_rays},
                    {"shadow", (double)r->counters.shadow_rays});
    BIS_JSON_NUMBERS(&j, {"candidates_drawn", count(settings->integrator != &bis_exact, r->counters.candidates)},
                     {"accepted", count(rejects, r->counters.accepted)},
                     {"fallbacks", count(rejects && settings->estimator == BIS_ESTIMATOR_RATIO,
                                         r->counters.fallbacks)});
    print_approximations(&j, s->desc, s->approximated);
    print_portals(&j, r);
    print_memory(&j, s);
    bis_json_number(&j, "estimated_relative_rmse", r->error.is_known ? r->error.relative_rmse : (double)NAN);
    bis_json_number(&j, "relative_rmse_at_most", r->error.has_upper ? r->error.upper : (double)NAN);
    bis_json_bool(&j, "interrupted", r->interrupted);
    if (r->missing > 0) bis_json_number(&j, "missing", r->missing);
    bis_json_close(&j);
}
