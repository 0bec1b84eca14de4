/* parser_integrator: Integrator and Sampler (docs/scene-format.md).
 *
 * Each integrator has its own parameters; one that belongs to another is unknown here, because a scene that gives
 * `candidates` to "em" does not mean what it says. One Integrator counts for all materials, up to three more for those
 * that they name by number (scene_materials.c); the numbers are known when the last shape is. pbrt's integrators and
 * samplers are replaced, with a warning, by what comes nearest. */
#include "bis/base/file.h"
#include "bis/base/mem.h"
#include "parser.h"

#include <assert.h>

#define MAX_SPP 1000000000u

/* ---- Integrator ---- */

enum { MAX_INTEGRATORS = 32 };

static void read_choice(bis_parser *p, const bis_parameter *parameter, bis_settings *s)
{
    const char *names[BIS_MAX_CHOICES];
    unsigned values[BIS_MAX_CHOICES];
    size_t n = 0;
    int i;

    for (unsigned v = 0; v < BIS_MAX_CHOICES; v++) {
        if (!(parameter->choices >> v & 1)) continue;
        names[n] = parameter->names[v];
        values[n++] = v;
    }
    if (bis_params_choice(p, parameter->name, &i, names, n)) bis_parameter_set(parameter, s, values[i]);
}

static void read_parameter(bis_parser *p, const bis_parameter *parameter, bis_settings *s)
{
    const bis_interval range = {parameter->lo, parameter->hi, false, false};
    uint32_t count;
    double fraction;
    bool is;

    switch (parameter->type) {
    case BIS_PARAMETER_COUNT: /* where lo is 2, bis_settings_check says why */
        if (bis_params_uint32(p, parameter->name, &count, parameter->or_auto ? 0 : 1, (uint32_t)parameter->hi))
            bis_parameter_set(parameter, s, count);
        break;
    case BIS_PARAMETER_FRACTION:
        if (bis_params_float(p, parameter->name, &fraction, range)) bis_parameter_set(parameter, s, fraction);
        break;
    case BIS_PARAMETER_BOOL:
        if (bis_params_bool(p, parameter->name, &is)) bis_parameter_set(parameter, s, is);
        break;
    case BIS_PARAMETER_CHOICE: read_choice(p, parameter, s); break;
    }
}

static bis_settings read_settings(bis_parser *p, const bis_integrator *integrator)
{
    bis_settings s = bis_settings_default(integrator);

    s.as_printed = p->desc->settings.as_printed; /* an Option's, not an integrator's */
    for (const bis_parameter *q = NULL; (q = bis_parameter_next(integrator, q)) != NULL;) read_parameter(p, q, &s);
    bis_settings_leave_open(&s);
    return s;
}

void bis_parser_clear_excepted(bis_parser *p)
{
    for (int i = 0; i < BIS_MAX_EXCEPTIONS; i++) {
        bis_free(p->excepted[i].numbers);
        p->excepted[i].numbers = NULL;
        p->excepted[i].n = 0;
    }
}

/* The numbers, as they stand; what they mean is known when the scene has been read. */
static bool read_numbers(bis_parser *p, const bis_param *param, int exception)
{
    char buf[32];
    uint32_t *numbers = bis_alloc(param->n, sizeof *numbers);

    if (!numbers) {
        bis_parser_nomem(p, param->at);
        return false;
    }
    for (size_t i = 0; i < param->n; i++) {
        const double v = p->params.numbers[param->first + i];
        if (!(v >= 0 && v < (double)UINT32_MAX && v == floor(v))) {
            bis_parser_error(p, param->at,
                             "\"material\" holds %s: must be the number of a material, from 0 (bis --plan lists them)",
                             bis_format_double(buf, v));
            bis_free(numbers);
            return false;
        }
        numbers[i] = (uint32_t)v;
    }
    p->excepted[exception].numbers = numbers;
    p->excepted[exception].n = param->n;
    return true;
}

/* An Integrator with "material" counts for these alone. */
static void except_materials(bis_parser *p, const bis_integrator *integrator)
{
    bis_exceptions *e = &p->desc->exceptions;
    const bis_param *param = bis_params_take(p, "material", BIS_TYPE_INTEGER, 0);
    const bis_settings s = read_settings(p, integrator);

    if (!param) return;
    if (!p->seen[BIS_SINGLE_INTEGRATOR].line) {
        bis_parser_error(
            p, param->at,
            "\"material\" in the first Integrator: one without must come before it, for all other materials");
    } else if (s.integrator == &bis_auto || p->desc->settings.integrator == &bis_auto) {
        bis_parser_error(p, param->at,
                         "\"material\" and \"auto\": a pilot chooses for every material by itself; give \"auto\" "
                         "alone, or fixed integrators alone");
    } else if (e->n == BIS_MAX_EXCEPTIONS) {
        bis_parser_error(p, param->at,
                         "more than %d Integrators with \"material\": one may hold several, as in [0 3 4]",
                         BIS_MAX_EXCEPTIONS);
    } else if (read_numbers(p, param, e->n)) {
        e->settings[e->n] = s;
        e->loc[e->n++] = p->name_at;
    }
}

void bis_directive_integrator(bis_parser *p, bis_loc at)
{
    static const char *const pbrt[] = {
        "path",      "volpath",    "bdpt",             "mlt",      "sppm",      "directlighting", "whitted", "ao",
        "lightpath", "randomwalk", "ambientocclusion", "function", "photonmap", "exphotonmap",    "igi",
        "irradiancecache", "simplepath", "simplevolpath",
    };
    bis_choice choices[BIS_COUNT(pbrt) + MAX_INTEGRATORS];
    size_t n = 0;

    for (; bis_integrators[n]; n++) choices[n] = (bis_choice){bis_integrators[n]->name, 0};
    assert(n < MAX_INTEGRATORS);
    choices[n++] = (bis_choice){bis_auto.name, 0};
    for (size_t i = 0; i < BIS_COUNT(pbrt); i++) choices[n++] = (bis_choice){pbrt[i], BIS_REPLACED};
    if (!bis_parser_name(p, "Integrator") || !bis_params_read(p)) return;
    const bis_choice *chosen = bis_parser_choose(p, "Integrator", bis_parser_text(p, p->name), p->name_at, choices, n);
    if (!chosen) return;
    const bis_integrator *integrator = bis_integrator_find(chosen->name);
    if (integrator && bis_params_has(p, "material")) {
        except_materials(p, integrator);
        bis_params_end(p, "Integrator", chosen->name);
        return;
    }
    bis_parser_single(p, BIS_SINGLE_INTEGRATOR, "Integrator", at);
    bis_parser_clear_excepted(p);
    bis_scene_drop_exceptions(p->desc, NULL, NULL);
    p->desc->integrator_loc = p->name_at;
    if (!integrator) {
        bis_warn(p->diag, p->name_at,
                 "Integrator \"%s\" is pbrt's and replaced by the default, \"%s\"; its parameters are ignored",
                 chosen->name, bis_sir.name);
        const unsigned as_printed = p->desc->settings.as_printed;
        p->desc->settings = bis_settings_default(&bis_sir);
        p->desc->settings.as_printed = as_printed;
        return;
    }
    p->desc->settings = read_settings(p, integrator);
    bis_params_end(p, "Integrator", chosen->name);
}

/* ---- which material has which ---- */

static void check_numbers(bis_parser *p, const uint32_t *class_of, uint32_t n_classes)
{
    bis_exceptions *e = &p->desc->exceptions;
    int *owner = bis_alloc(n_classes, sizeof *owner); /* of a number: its exception, from 1 */

    e->of_material = bis_alloc(p->desc->n_materials, sizeof *e->of_material);
    if (!owner || !e->of_material) bis_parser_nomem(p, e->loc[0]);
    for (int i = 0; i < e->n && owner && e->of_material; i++) {
        for (size_t k = 0; k < p->excepted[i].n; k++) {
            const uint32_t number = p->excepted[i].numbers[k];
            if (number >= n_classes) {
                bis_parser_error(p, e->loc[i],
                                 "\"material\" holds %u: the shapes use %u different materials, numbered from 0 (bis "
                                 "--plan lists them)",
                                 (unsigned)number, (unsigned)n_classes);
            } else if (owner[number]) {
                const bis_loc first = e->loc[owner[number] - 1];
                bis_parser_error(p, e->loc[i], "\"material\" holds %u, which has an Integrator already, that of %s:%d",
                                 (unsigned)number, first.file, first.line);
            } else {
                owner[number] = i + 1;
            }
        }
    }
    for (size_t i = 0; owner && e->of_material && i < p->desc->n_materials; i++)
        if (class_of[i] != BIS_NO_NUMBER) e->of_material[i] = (unsigned char)owner[class_of[i]];
    bis_free(owner);
}

/* Compensated tables are made for mis alone: whoever else drew from them would miss the light that they leave out. */
static void check_compensation(bis_parser *p)
{
    const bis_scene_desc *d = p->desc;

    if (!(bis_scene_light_needs(d) & BIS_NEED_COMPENSATED)) return;
    for (int i = 0; i <= d->exceptions.n; i++) {
        const bis_settings *s = bis_scene_settings(d, i);
        const unsigned needs = s->integrator->light_needs(s);
        if (!bis_scene_uses_method(d, i) || !(needs & (BIS_NEED_TABLE | BIS_NEED_CURVE)) ||
            needs & BIS_NEED_COMPENSATED)
            continue;
        bis_parser_error(p, i ? d->exceptions.loc[i - 1] : d->integrator_loc,
                         "integrator \"%s\" draws from the map, whose table another Integrator of this scene has "
                         "compensated for \"mis\": give \"compensate\" to all "
                         "that draw from the map, or to none",
                         s->integrator->name);
    }
}

void bis_parser_check_integrators(bis_parser *p)
{
    bis_exceptions *e = &p->desc->exceptions;
    uint32_t *class_of, n_classes;

    bis_parser_note(p, bis_settings_check(&p->desc->settings, p->desc->integrator_loc, p->diag));
    if (!e->n) return;
    for (int i = 0; i < e->n; i++) {
        e->settings[i].as_printed = p->desc->settings.as_printed; /* an Option may come later than they do */
        bis_parser_note(p, bis_settings_check(&e->settings[i], e->loc[i], p->diag));
    }
    bis_parser_note(p, bis_scene_number_materials(&class_of, &n_classes, p->desc, p->diag));
    if (class_of) check_numbers(p, class_of, n_classes);
    bis_free(class_of);
    if (!p->status) check_compensation(p);
}

/* ---- Sampler ---- */

/* pbrt's xsamples and ysamples; pixelsamples alone is divided as squarely as possible. */
static void read_stratified(bis_parser *p, bis_sampler *s, bool has_spp)
{
    uint32_t x = 4, y = 4;
    const bool has_x = bis_params_uint32(p, "xsamples", &x, 1, 65535);
    const bool has_y = bis_params_uint32(p, "ysamples", &y, 1, 65535);
    bis_params_bool(p, "jitter", &s->jitter);
    if (!has_x && !has_y) return;
    if ((uint64_t)x * y > MAX_SPP || (has_spp && x * y != s->spp)) {
        bis_parser_error(p, bis_params_at(p, has_x ? "xsamples" : "ysamples"),
                         "\"xsamples\" %u times \"ysamples\" %u is %llu, must be %s%u", x, y, (unsigned long long)x * y,
                         has_spp ? "\"pixelsamples\" " : "at most ", has_spp ? (unsigned)s->spp : MAX_SPP);
        return;
    }
    s->xsamples = x;
    s->ysamples = y;
    s->spp = x * y;
}

void bis_directive_sampler(bis_parser *p, bis_loc at)
{
    static const bis_choice samplers[] = {{"random", BIS_SAMPLER_RANDOM},
                                          {"independent", BIS_SAMPLER_RANDOM},
                                          {"stratified", BIS_SAMPLER_STRATIFIED},
                                          {"sobol", BIS_SAMPLER_SOBOL},
                                          {"halton", BIS_SAMPLER_HALTON},
                                          {"zsobol", BIS_REPLACED},
                                          {"paddedsobol", BIS_REPLACED},
                                          {"pmj02bn", BIS_REPLACED},
                                          {"02sequence", BIS_REPLACED},
                                          {"lowdiscrepancy", BIS_REPLACED},
                                          {"maxmindist", BIS_REPLACED},
                                          {"bestcandidate", BIS_REPLACED},
                                          {"adaptive", BIS_REPLACED}};
    static const char *const ignored[] = {"dimensions", "randomization", "samplepixelcenter", "scramble"};
    uint32_t spp = 16;

    if (!bis_parser_name(p, "Sampler") || !bis_params_read(p)) return;
    const bis_choice *chosen =
        bis_parser_choose(p, "Sampler", bis_parser_text(p, p->name), p->name_at, samplers, BIS_COUNT(samplers));
    if (!chosen) return;
    bis_parser_single(p, BIS_SINGLE_SAMPLER, "Sampler", at);
    const bool replaced = chosen->value == BIS_REPLACED;
    if (replaced) bis_warn(p->diag, p->name_at, "Sampler \"%s\" is replaced by \"sobol\"", chosen->name);

    const bool has_spp = bis_params_uint32(p, "pixelsamples", &spp, 1, MAX_SPP);
    bis_sampler *s = &p->desc->sampler;
    *s = (bis_sampler){.kind = replaced ? BIS_SAMPLER_SOBOL : (bis_sampler_kind)chosen->value, .jitter = true};
    bis_scene_set_spp(p->desc, spp);
    bis_params_integer(p, "seed", &s->seed, 0, (UINT64_C(1) << 53) - 1);
    p->desc->adaptive = false;
    bis_params_bool(p, "adaptive", &p->desc->adaptive);
    p->desc->edge_samples = 1;
    bis_params_uint32(p, "edgesamples", &p->desc->edge_samples, 1, 1024);
    if (s->kind == BIS_SAMPLER_STRATIFIED) read_stratified(p, s, has_spp);
    bis_params_ignore(p, ignored, BIS_COUNT(ignored));
    if (!replaced) bis_params_end(p, "Sampler", chosen->name);
}
