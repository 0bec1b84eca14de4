/* SPDX-License-Identifier: BSD-2-Clause */
/* parser_ask: what a directive wants to know of its parameters.
 *
 * A directive asks for each parameter that it knows by name and type, with the range that the value must lie in;
 * bis_params_end then complains of those that nobody asked for, and knows from the questions which names could have
 * been meant. A value outside its range leaves the default in place and one complaint behind, so that a directive can
 * look at all of its parameters. */
#include "approximate.h"
#include "bis/base/file.h"
#include "parser_ask.h"

#include <string.h>

bool bis_params_has(bis_parser *p, const char *name) { return bis_params_find(p, name) != NULL; }

bis_loc bis_params_at(bis_parser *p, const char *name)
{
    const bis_param *param = bis_params_find(p, name);
    return param ? param->at : p->name_at;
}

const bis_param *bis_params_take(bis_parser *p, const char *name, unsigned wanted, size_t count)
{
    char buf[64];
    bis_params *ps = &p->params;
    if (ps->n_asked < BIS_MAX_PARAMS) ps->asked[ps->n_asked++] = name;
    bis_param *param = bis_params_find(p, name);
    if (!param) return NULL;
    param->used = true;
    if (!(param->type & wanted) && p->convert) p->convert(p, param, wanted);
    if (!param->type) return NULL; /* complained of already */
    if (!(param->type & wanted) && p->approximate) { /* pbrt does not find it, and goes on */
        bis_approximate_note(p, param->at, "the default is taken", "\"%s %s\"", param->type_name, name);
        return NULL;
    }
    if (!(param->type & wanted)) {
        bis_parser_error(p, param->at, "\"%s\" is of type %s, must be %s", name, param->type_name,
                         bis_param_type_names(buf, wanted));
        return NULL;
    }
    if (param->type == BIS_TYPE_RGB && wanted & BIS_TYPE_FLOAT) count = 3; /* rgb where a float would do, too */
    if (count ? param->n == count : param->n > 0) return param;
    if (count) {
        char kind[BIS_APPROXIMATION_KIND];
        snprintf(kind, sizeof kind, "\"%s\" of %zu value%s", name, param->n, param->n == 1 ? "" : "s");
        bis_approximate_or_refuse(p, param->at, kind, "the default is taken", "\"%s\" has %zu value%s, must have %zu",
                                  name, param->n, param->n == 1 ? "" : "s", count);
    } else
        bis_parser_error(p, param->at, "\"%s\" has no value", name);
    return NULL;
}

bool bis_parser_in_range(bis_parser *p, bis_loc at, const char *name, double *v_io, bis_interval r)
{
    char v[32], lo[32], hi[32], rule[80];
    const double value = *v_io;
    const bool high = r.hi_open ? value >= r.hi : value > r.hi, low = r.lo_open ? value <= r.lo : value < r.lo;
    if (!high && !low) return true;
    const bool has_end = high ? !r.hi_open : !r.lo_open;
    bis_format_double(lo, r.lo);
    bis_format_double(hi, r.hi);
    if (isinf(r.hi)) snprintf(rule, sizeof rule, "%s %s", r.lo_open ? ">" : ">=", lo);
    else snprintf(rule, sizeof rule, "in %c%s, %s%c", r.lo_open ? '(' : '[', lo, hi, r.hi_open ? ')' : ']');
    bis_format_double(v, value);
    if (!has_end) return bis_parser_error(p, at, "\"%s\" is %s, must be %s", name, v, rule);
    char kind[BIS_APPROXIMATION_KIND];
    snprintf(kind, sizeof kind, "\"%s\" out of its range", name);
    if (!bis_approximate_or_refuse(p, at, kind, "the nearest value that it may have", "\"%s\" is %s, must be %s", name,
                                   v, rule))
        return false;
    *v_io = high ? r.hi : r.lo;
    return true;
}

bool bis_params_floats(bis_parser *p, const char *name, double *values, size_t n, bis_interval range)
{
    const bis_param *param = bis_params_take(p, name, BIS_TYPE_FLOAT, n);
    if (!param) return false;
    double *numbers = p->params.numbers + param->first;
    for (size_t i = 0; i < n; i++)
        if (!bis_parser_in_range(p, param->at, name, &numbers[i], range)) return false;
    memcpy(values, numbers, n * sizeof *values);
    return true;
}

bool bis_params_float(bis_parser *p, const char *name, double *value, bis_interval range)
{
    return bis_params_floats(p, name, value, 1, range);
}

bool bis_params_integer(bis_parser *p, const char *name, uint64_t *value, uint64_t lo, uint64_t hi)
{
    const bis_param *param = bis_params_take(p, name, BIS_TYPE_INTEGER, 1);
    if (!param) return false;
    double v = p->params.numbers[param->first];
    char buf[32];
    if (v != floor(v))
        return bis_parser_error(p, param->at, "\"%s\" is %s, must be a whole number", name, bis_format_double(buf, v));
    const bis_interval range = {(double)lo, (double)hi, false, false};
    if (!bis_parser_in_range(p, param->at, name, &v, range)) return false;
    *value = (uint64_t)v;
    return true;
}

bool bis_params_uint32(bis_parser *p, const char *name, uint32_t *value, uint32_t lo, uint32_t hi)
{
    uint64_t wide;
    if (!bis_params_integer(p, name, &wide, lo, hi)) return false;
    *value = (uint32_t)wide;
    return true;
}

bool bis_params_bool(bis_parser *p, const char *name, bool *value)
{
    const bis_param *param = bis_params_take(p, name, BIS_TYPE_BOOL, 1);
    if (param) *value = p->params.numbers[param->first] > 0;
    return param != NULL;
}

bool bis_params_string(bis_parser *p, const char *name, const char **value)
{
    const bis_param *param = bis_params_take(p, name, BIS_TYPE_STRING, 1);
    if (param) *value = bis_parser_text(p, p->params.strings[param->first]);
    return param != NULL;
}

bool bis_params_rgb(bis_parser *p, const char *name, rgb *value, bis_interval range, bool or_float)
{
    const bis_param *param = or_float ? bis_params_take(p, name, BIS_TYPE_RGB | BIS_TYPE_FLOAT, 1)
                                      : bis_params_take(p, name, BIS_TYPE_RGB, 3);
    if (!param) return false;
    double *v = p->params.numbers + param->first;
    const bool grey = param->type == BIS_TYPE_FLOAT;
    for (size_t i = 0; i < (grey ? 1 : 3); i++)
        if (!bis_parser_in_range(p, param->at, name, &v[i], range)) return false;
    *value = grey ? rgb_from(v[0], v[0], v[0]) : rgb_from(v[0], v[1], v[2]);
    return true;
}

bool bis_params_choice(bis_parser *p, const char *name, int *value, const char *const *choices, size_t n)
{
    char list[192] = "";
    const char *chosen;
    if (!bis_params_string(p, name, &chosen)) return false;
    for (size_t i = 0; i < n; i++) {
        if (strcmp(chosen, choices[i]) == 0) {
            *value = (int)i;
            return true;
        }
        bis_append(list, sizeof list, "%s\"%s\"", i == 0 ? "" : i + 1 < n ? ", " : " or ", choices[i]);
    }
    char kind[BIS_APPROXIMATION_KIND];
    snprintf(kind, sizeof kind, "\"%s\" that is \"%s\"", name, bis_parser_word(p, chosen));
    bis_approximate_or_refuse(p, bis_params_at(p, name), kind, "the default is taken",
                              "\"%s\" is \"%s\", must be %s%s", name, bis_parser_word(p, chosen), list,
                              bis_parser_hint(p, bis_nearest_name(chosen, choices, n)));
    return false;
}

void bis_params_skip(bis_parser *p, const char *const *names, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        bis_param *param = bis_params_find(p, names[i]);
        if (param) param->used = true;
    }
}

#define CHANGES "ignored, which changes "

/* A parameter that is passed over, and what changes by it: nothing, noise, brightness, colour or shape. */
static const struct ignored {
    const char *directive, *name, *consequence; /* "ignored, which changes ..." */
    const char *idle; /* the value of which nothing is said, because it changes nothing; NULL: none */
} ignored[] = {
    {"Camera", "shutteropen", CHANGES "nothing", NULL},
    {"Camera", "shutterclose", CHANGES "nothing", NULL},
    {"Film", "diagonal", CHANGES "nothing", NULL},
    {"Film", "display", CHANGES "nothing", NULL},
    {"Film", "savefp16", CHANGES "nothing but the digits of the file", "false"},
    {"Film", "sensor", CHANGES "colour: the film sees as the CIE 1931 observer", "cie1931"},
    {"Film", "whitebalance", CHANGES "colour: white is D65", "0"},
    {"Film", "maxcomponentvalue", CHANGES "brightness: samples above it are not cut off", NULL},
    {"Film", "maxsampleluminance", CHANGES "brightness: samples above it are not cut off", NULL},
    {"Film", "pixelbounds", CHANGES "shape: the whole picture is rendered (cropwindow renders a part)", NULL},
    {"Sampler", "dimensions", CHANGES "nothing but noise", NULL},
    {"Sampler", "randomization", CHANGES "nothing but noise", NULL},
    {"Sampler", "scramble", CHANGES "nothing but noise", NULL},
    {"Sampler", "samplepixelcenter", CHANGES "shape: edges are smooth", "false"},
    {"Integrator", "vectorize", CHANGES "nothing", NULL},
    {"LightSource", "samples", CHANGES "nothing but noise", NULL},
    {"LightSource", "nsamples", CHANGES "nothing but noise", NULL},
    {"Texture", "filter", CHANGES "nothing but sharpness: between texels it is bilinear", NULL},
    {"Option", "disabletexturefiltering", CHANGES "nothing", NULL},
    {"Option", "disablewavelengthjitter", CHANGES "nothing", NULL},
    {"Option", "displacementedgescale", CHANGES "shape: displaced meshes stay as they are", "1"},
    {"Option", "forcediffuse", CHANGES "colour: materials stay as they are", "false"},
    {"Option", "msereferenceimage", CHANGES "nothing", NULL},
    {"Option", "msereferenceout", CHANGES "nothing", NULL},
    {"Option", "pixelstats", CHANGES "nothing", NULL},
    {"Option", "rendercoordsys", CHANGES "nothing", NULL},
    {"Option", "seed", CHANGES "nothing but noise", NULL},
    {"Option", "wavefront", CHANGES "nothing", NULL},
};

/* Is the one value of the parameter, a text or a number, that of the row that changes nothing? */
static bool is_idle(const bis_parser *p, const bis_param *param, const char *idle)
{
    const char *end;
    if (!idle || param->n != 1 || !param->type || param->type == BIS_TYPE_OTHER) return false;
    if (param->is_strings) return strcmp(bis_parser_text(p, p->params.strings[param->first]), idle) == 0;
    const double value = strcmp(idle, "false") == 0 ? 0 : bis_parse_double(idle, &end);
    return p->params.numbers[param->first] == value;
}

void bis_params_ignore(bis_parser *p, const char *directive)
{
    for (size_t i = 0; i < BIS_COUNT(ignored); i++) {
        const struct ignored *row = &ignored[i];
        bis_param *param = strcmp(row->directive, directive) == 0 ? bis_params_find(p, row->name) : NULL;
        if (!param) continue;
        param->used = true;
        if (is_idle(p, param, row->idle)) continue;
        if (p->approximate) bis_approximate_note(p, param->at, row->consequence, "parameter \"%s\"", row->name);
        else if (bis_parser_once(p, row->name))
            bis_warn(p->diag, param->at, "\"%s\" is %s", row->name, row->consequence);
    }
}

void bis_params_end(bis_parser *p, const char *directive, const char *what)
{
    bis_params *ps = &p->params;
    for (size_t i = 0; i < ps->n; i++) {
        if (ps->list[i].used) continue;
        const char *name = bis_parser_text(p, ps->list[i].name), *quote = what ? "\"" : "";
        char kind[BIS_APPROXIMATION_KIND];
        snprintf(kind, sizeof kind, "parameter \"%s\" of %s%s%s%s%s", name, directive, what ? " " : "", quote,
                 what ? what : "", quote);
        bis_approximate_or_refuse(p, ps->list[i].at, kind, "ignored", "unknown %s%s", kind,
                                  bis_parser_hint(p, bis_nearest_name(name, ps->asked, ps->n_asked)));
    }
}

/* ---- names of things ---- */

/* `"a", "b"`: those that are ours. */
static const char *our_names(char buf[256], const bis_choice *choices, size_t n)
{
    buf[0] = '\0';
    for (size_t i = 0; i < n && strlen(buf) < 200; i++)
        if (choices[i].value >= 0) bis_append(buf, 256, "%s\"%s\"", *buf ? ", " : "", choices[i].name);
    return buf;
}

const bis_choice *bis_parser_choose(bis_parser *p, const char *directive, const char *name, bis_loc at,
                                    const bis_choice *choices, size_t n)
{
    const char *names[BIS_MAX_PARAMS] = {NULL};
    char list[256];
    size_t n_names = 0;

    for (size_t i = 0; i < n; i++) {
        if (strcmp(name, choices[i].name) == 0) {
            if (choices[i].value != BIS_FOREIGN || bis_approximate(p, directive, name, at)) return &choices[i];
            bis_parser_error(p, at, "%s \"%s\" is pbrt's and not modelled; bis has %s%s", directive, name,
                             our_names(list, choices, n), bis_approximate_hint(p, directive, name));
            return NULL;
        }
        if (choices[i].value != BIS_FOREIGN && n_names < BIS_MAX_PARAMS) names[n_names++] = choices[i].name;
    }
    const char *instead = bis_approximate_unknown(p, directive, name, at);
    for (size_t i = 0; i < n && instead; i++)
        if (strcmp(instead, choices[i].name) == 0) return &choices[i];
    bis_parser_error(p, at, "unknown %s \"%s\"%s%s", directive, bis_parser_word(p, name),
                     bis_parser_hint(p, bis_nearest_name(name, names, n_names)),
                     bis_approximate_unknown_hint(p, directive));
    return NULL;
}

const bis_choice *bis_parser_begin(bis_parser *p, const char *directive, const bis_choice *choices, size_t n)
{
    if (!bis_parser_name(p, directive) || !bis_params_read(p)) return NULL;
    return bis_parser_choose(p, directive, bis_parser_text(p, p->name), p->name_at, choices, n);
}

void bis_parser_single(bis_parser *p, bis_single which, const char *directive, bis_loc at)
{
    const bis_loc first = p->seen[which];
    if (first.line)
        bis_warn(p->diag, at, "%s is given again and replaces that of %s:%d", directive, first.file, first.line);
    p->seen[which] = at;
}
