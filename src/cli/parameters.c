/* SPDX-License-Identifier: BSD-2-Clause */
/* parameters: the table of bis/thesis/settings.h as options and as help. No parameter is known here by its name. */
#include "parameters.h"

#include "base/text.h"

#include <assert.h>
#include <ctype.h>
#include <string.h>

/* ---- words ---- */

/* A choice is told by its names, since they differ between integrators; else the first row of a name has the words. */
const char *bis_parameter_words(char buf[BIS_PARAMETER_WORDS], const char *name)
{
    const bis_parameter *first = NULL;
    char list[128];

    *buf = '\0';
    for (const bis_integrator *const *i = bis_integrators; *i; i++) {
        const bis_parameter *p = bis_parameter_of(*i, name);
        if (!p) continue;
        const bool is_choice = p->type == BIS_PARAMETER_CHOICE;
        bis_append(buf, BIS_PARAMETER_WORDS, "%s%s", !*buf ? "" : is_choice ? "; " : ", ", (*i)->name);
        if (is_choice) bis_append(buf, BIS_PARAMETER_WORDS, ": %s", bis_parameter_list(list, p, ""));
    }
    for (first = bis_parameters; strcmp(first->name, name) != 0;) first++;
    if (first->type != BIS_PARAMETER_CHOICE) bis_append(buf, BIS_PARAMETER_WORDS, ": %s", first->words);
    return buf;
}

/* The default first, then the other names of a choice. */
static void append_default(char *buf, const bis_parameter *p)
{
    char number[32];

    bis_append(buf, BIS_INTEGRATOR_WORDS, "%s (%s", p->name, bis_parameter_text(number, p, p->usual));
    for (unsigned v = 0; p->type == BIS_PARAMETER_CHOICE && p->choices >> v; v++)
        if (p->choices >> v & 1 && v != p->usual) bis_append(buf, BIS_INTEGRATOR_WORDS, ", %s", p->names[v]);
    if (p->note) bis_append(buf, BIS_INTEGRATOR_WORDS, "; %s", p->note);
    bis_append(buf, BIS_INTEGRATOR_WORDS, ")");
}

const char *bis_integrator_words(char buf[BIS_INTEGRATOR_WORDS], const bis_integrator *integrator)
{
    const char *between = ". ";

    *buf = '\0';
    bis_append(buf, BIS_INTEGRATOR_WORDS, "%s", integrator->words);
    for (const bis_parameter *p = NULL; (p = bis_parameter_next(integrator, p)) != NULL; between = ", ") {
        bis_append(buf, BIS_INTEGRATOR_WORDS, "%s", between);
        append_default(buf, p);
    }
    bis_append(buf, BIS_INTEGRATOR_WORDS, ". %c%s", toupper((unsigned char)*integrator->claim), integrator->claim + 1);
    return buf;
}

/* ---- options ---- */

/* What rows of p's name allow, all together. */
static bis_option option_of(const bis_parameter *p, bis_parameter_option *value)
{
    bis_option o = {.name = p->name, .help = bis_parameter_words(value->help, p->name), .given = &value->given};
    unsigned choices = 0;
    size_t n = 0;

    value->parameter = p;
    o.lo = p->lo;
    for (const bis_parameter *q = p; q->name; q++) {
        if (strcmp(q->name, p->name) != 0) continue;
        choices |= q->choices;
    }
    o.hi = p->hi;
    if (p->type == BIS_PARAMETER_COUNT) {
        o.argument = strcmp(p->name, "candidates") == 0 ? "M" : "N";
        o.kind = BIS_OPTION_COUNT;
        o.value = &value->count;
        return o;
    }
    assert(p->type == BIS_PARAMETER_BOOL || p->type == BIS_PARAMETER_CHOICE);
    for (unsigned v = 0; p->type == BIS_PARAMETER_CHOICE && v < BIS_MAX_CHOICES; v++)
        if (choices >> v & 1) value->names[n++] = p->names[v];
    if (p->type == BIS_PARAMETER_BOOL) {
        value->names[0] = "on";
        value->names[1] = "off";
    }
    o.argument = p->type == BIS_PARAMETER_BOOL ? "on|off" : "P";
    o.kind = BIS_OPTION_NAME;
    o.value = &value->name;
    o.names = value->names;
    return o;
}

void bis_parameter_options(bis_option *options, size_t *n, bis_parameter_option values[BIS_PARAMETER_OPTIONS])
{
    int k = 0;

    for (const bis_parameter *p = bis_parameters; p->name; p++) {
        if (!p->is_option || !p->words) continue;
        assert(k < BIS_PARAMETER_OPTIONS);
        options[(*n)++] = option_of(p, &values[k++]);
    }
}

bool bis_parameter_given(const bis_parameter_option values[BIS_PARAMETER_OPTIONS], const char *name)
{
    for (int i = 0; i < BIS_PARAMETER_OPTIONS && values[i].parameter; i++)
        if (values[i].given && strcmp(values[i].parameter->name, name) == 0) return true;
    return false;
}

static double value_of(const bis_parameter *p, const bis_parameter_option *value)
{
    unsigned v = 0;

    if (p->type == BIS_PARAMETER_COUNT) return (double)value->count;
    if (p->type == BIS_PARAMETER_BOOL) return strcmp(value->name, "on") == 0;
    while (strcmp(p->names[v], value->name) != 0) v++; /* option_of offers no other name */
    return v;
}

/* An option that this integrator does not read is a slip worth a word, but harmless: scripts loop over integrators. */
void bis_parameter_override(bis_settings *s, const bis_parameter_option values[BIS_PARAMETER_OPTIONS], bis_diag *diag)
{
    for (int i = 0; i < BIS_PARAMETER_OPTIONS && values[i].parameter; i++) {
        if (!values[i].given) continue;
        const char *name = values[i].parameter->name;
        const bis_parameter *p = bis_parameter_of(s->integrator, name);
        if (p) bis_parameter_set(p, s, value_of(p, &values[i]));
        else bis_warn(diag, bis_cli_loc, "--%s has no effect on integrator \"%s\"", name, s->integrator->name);
    }
}
