/* SPDX-License-Identifier: BSD-2-Clause */
/* parser_params: "type name" value or [values], all of a directive's, read before any is looked at (parser_ask.c).
 *
 * What is checked here is what can be told without knowing the directive: the type is one of pbrt's, the values are of
 * its class (numbers, strings, true or false), numbers are finite as floats. Values go into arrays that the next
 * directive uses again. Invariant: strings and names are offsets, since the text moves when it grows. */
#include "base/grow.h"
#include "approximate.h"
#include "parser.h"
#include "parser_params.h"
#include "parser_version.h"

#include <float.h>
#include <string.h>

/* EITHER: numbers, or strings if the first value is one */
typedef enum value_class { NUMBERS, STRINGS, BOOLS, ANYTHING, EITHER } value_class;

typedef struct param_type {
    const char *name, *shown;
    unsigned type;
    value_class values;
} param_type;

static const param_type types[] = {
    {"integer", "integer", BIS_TYPE_INTEGER, NUMBERS}, {"float", "float", BIS_TYPE_FLOAT, NUMBERS},
    {"bool", "bool", BIS_TYPE_BOOL, BOOLS},            {"string", "string", BIS_TYPE_STRING, STRINGS},
    {"rgb", "rgb", BIS_TYPE_RGB, NUMBERS},             {"color", "rgb", BIS_TYPE_RGB, NUMBERS},
    {"point3", "point3", BIS_TYPE_POINT3, NUMBERS},    {"point", "point3", BIS_TYPE_POINT3, NUMBERS},
    {"vector3", "vector3", BIS_TYPE_VECTOR3, NUMBERS}, {"vector", "vector3", BIS_TYPE_VECTOR3, NUMBERS},
    {"normal", "normal", BIS_TYPE_NORMAL, NUMBERS},    {"normal3", "normal", BIS_TYPE_NORMAL, NUMBERS},
    {"point2", "point2", BIS_TYPE_POINT2, NUMBERS},    {"vector2", "vector2", BIS_TYPE_OTHER, ANYTHING},
    {"spectrum", "spectrum", BIS_TYPE_SPECTRUM, EITHER}, {"xyz", "xyz", BIS_TYPE_XYZ, NUMBERS},
    {"blackbody", "blackbody", BIS_TYPE_BLACKBODY, NUMBERS}, {"texture", "texture", BIS_TYPE_TEXTURE, STRINGS},
};

const char *bis_param_type_names(char buf[64], unsigned mask)
{
    buf[0] = '\0';
    for (size_t i = 0; i < BIS_COUNT(types); i++)
        if (types[i].type & mask && strcmp(types[i].name, types[i].shown) == 0)
            bis_append(buf, 64, "%s%s", *buf ? " or " : "", types[i].name);
    return buf;
}

const char *bis_parser_text(const bis_parser *p, size_t offset) { return p->params.text + offset; }

void bis_params_start(bis_parser *p)
{
    bis_params *ps = &p->params;
    ps->n = ps->n_numbers = ps->n_strings = ps->n_text = ps->n_asked = 0;
}

void bis_params_clear(bis_params *ps)
{
    bis_free(ps->numbers);
    bis_free(ps->strings);
    bis_free(ps->text);
}

/* The token's text with a zero byte behind it goes to the pool; its offset, or SIZE_MAX. */
static size_t add_text(bis_parser *p)
{
    bis_params *ps = &p->params;
    if (!BIS_ROOM(ps->text, ps->capacity_text, ps->n_text + p->token.length)) {
        bis_parser_nomem(p, p->token.at);
        return SIZE_MAX;
    }
    size_t offset = ps->n_text;
    ps->n_text += bis_token_unescape(ps->text + offset, &p->token) + 1;
    return offset;
}

/* A mesh has millions of numbers: BIS_ROOM is asked only when the pool is full. */
static bool add_number(bis_parser *p, double number)
{
    bis_params *ps = &p->params;
    const bool is_full = ps->n_numbers == ps->capacity_numbers || !ps->numbers;
    if (is_full && !BIS_ROOM(ps->numbers, ps->capacity_numbers, ps->n_numbers))
        return bis_parser_nomem(p, p->token.at);
    ps->numbers[ps->n_numbers++] = number;
    return true;
}

static bool add_string(bis_parser *p)
{
    bis_params *ps = &p->params;
    if (!BIS_ROOM(ps->strings, ps->capacity_strings, ps->n_strings)) return bis_parser_nomem(p, p->token.at);
    ps->strings[ps->n_strings] = add_text(p);
    return ps->strings[ps->n_strings++] != SIZE_MAX;
}

static bool token_is(const bis_token *t, const char *word)
{
    return t->length == strlen(word) && memcmp(t->text, word, t->length) == 0;
}

static bool is_truth(const bis_token *t)
{
    return (t->kind == BIS_TOKEN_WORD || t->kind == BIS_TOKEN_STRING) && (token_is(t, "true") || token_is(t, "false"));
}

static bool is_value(const bis_token *t)
{
    return t->kind == BIS_TOKEN_NUMBER || t->kind == BIS_TOKEN_STRING || is_truth(t);
}

bool bis_token_is_nonfinite(const bis_token *t)
{
    static const char *const words[] = {"nan", "NaN", "NAN", "inf", "Inf", "INF", "infinity", "Infinity"};
    for (size_t i = 0; t->kind == BIS_TOKEN_WORD && i < BIS_COUNT(words); i++)
        if (token_is(t, words[i])) return true;
    return false;
}

bool bis_parser_peek_name(bis_parser *p, const char *directive)
{
    char buf[64];
    bis_params_start(p);
    p->name_at = p->token.at;
    if (p->token.kind != BIS_TOKEN_STRING) {
        if (p->token.kind != BIS_TOKEN_BAD)
            bis_parser_error(p, p->token.at, "%s wants a quoted name, found %s", directive,
                             bis_token_name(buf, &p->token));
        p->lost = true;
        return false;
    }
    p->name = add_text(p);
    return p->name != SIZE_MAX;
}

bool bis_parser_next_name(bis_parser *p, const char *directive, size_t *text, bis_loc *at)
{
    char buf[64];
    *at = p->token.at;
    if (p->token.kind != BIS_TOKEN_STRING) {
        if (p->token.kind != BIS_TOKEN_BAD) /* else it is lost by itself */
            bis_parser_lose(p, p->token.at, "%s wants another quoted name, found %s", directive,
                            bis_token_name(buf, &p->token));
        return false;
    }
    *text = add_text(p);
    if (*text == SIZE_MAX) return false;
    bis_parser_advance(p);
    return true;
}

bool bis_parser_name(bis_parser *p, const char *directive)
{
    if (!bis_parser_peek_name(p, directive)) return false;
    bis_parser_advance(p);
    return true;
}

/* Complains of a value of the wrong kind. After it nobody knows where the list ends, so the directive is lost. */
static bool lost_value(bis_parser *p, const char *name, value_class wanted)
{
    static const char *const wants[] = {"numbers", "strings", "true or false", "a value"};
    const bis_token *t = &p->token;
    char found[64];
    p->lost = true;
    bis_token_name(found, t);
    if (bis_token_is_nonfinite(t)) bis_parser_error(p, t->at, "non-finite number %s", found);
    else if (t->kind != BIS_TOKEN_BAD)
        bis_parser_error(p, t->at, "\"%s\" wants %s, found %s", name, wants[wanted], found);
    return false;
}

static bool read_value(bis_parser *p, const bis_param *param, value_class values)
{
    const bis_token *t = &p->token;
    bool ok;

    if (t->kind == BIS_TOKEN_NUMBER && values == NUMBERS) {
        char buf[64];
        /* integers keep a double's range, because a seed may have 53 bits; all else becomes a float */
        if (param->type != BIS_TYPE_INTEGER && fabs(t->number) > (double)FLT_MAX)
            return bis_parser_lose(p, t->at, "non-finite number %s: the largest float is 3.4e38",
                                   bis_token_name(buf, t));
        ok = add_number(p, t->number);
    } else if (is_truth(t) && values == BOOLS) {
        ok = add_number(p, token_is(t, "true"));
    } else if (t->kind == BIS_TOKEN_STRING && values == STRINGS) {
        ok = add_string(p);
    } else if (is_value(t) && values == ANYTHING) {
        ok = true;
    } else {
        return lost_value(p, bis_parser_text(p, param->name), values);
    }
    bis_parser_advance(p);
    return ok;
}

static bool read_values(bis_parser *p, bis_param *param, value_class values)
{
    bis_params *ps = &p->params;
    size_t n = 0;

    const bool is_list = p->token.kind == BIS_TOKEN_OPEN;
    const bis_loc open = p->token.at;
    if (is_list) bis_parser_advance(p);
    if (values == EITHER) values = p->token.kind == BIS_TOKEN_STRING ? STRINGS : NUMBERS;
    param->is_strings = values == STRINGS;
    param->first = param->is_strings ? ps->n_strings : ps->n_numbers;
    if (!is_list) {
        if (!read_value(p, param, values)) return false;
        param->n = 1;
        if (p->token.kind != BIS_TOKEN_NUMBER) return true;
        return bis_parser_lose(p, p->token.at, "several values of \"%s\" must stand between [ and ]",
                               bis_parser_text(p, param->name));
    }
    for (; p->token.kind != BIS_TOKEN_CLOSE; n++) {
        /* a word begins the next directive: the ] was forgotten, and the place to name is that of the [ */
        if (p->token.kind == BIS_TOKEN_END ||
            (p->token.kind == BIS_TOKEN_WORD && !is_truth(&p->token) && !bis_token_is_nonfinite(&p->token)))
            return bis_parser_lose(p, open, "the [ of \"%s\" has no ]", bis_parser_text(p, param->name));
        if (!read_value(p, param, values)) return false;
    }
    bis_parser_advance(p);
    param->n = n;
    return true;
}

/* As all of pbrt's are, and fit for a message. */
static bool is_name(const char *s)
{
    static const char allowed[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.:-";
    const size_t n = strspn(s, allowed);
    return n > 0 && n <= BIS_MAX_PARAM_NAME && s[n] == '\0';
}

/* Splits the string at `offset` into type and name, by white space, in the pool itself. */
static bool split_declaration(bis_parser *p, bis_param *param, size_t offset)
{
    static const char space[] = " \t\r";
    char *text = p->params.text + offset, buf[128];
    bis_printable(buf, text, strlen(text));
    char *type = text + strspn(text, space);
    char *name = type + strcspn(type, space);
    if (*name) *name++ = '\0';
    name += strspn(name, space);
    char *rest = name + strcspn(name, space);
    if (*rest) *rest++ = '\0';
    if (!is_name(name) || rest[strspn(rest, space)])
        return bis_parser_lose(p, param->at, "a parameter is declared as \"type name\", not \"%s\"", buf);
    param->type_name = type;
    param->name = (size_t)(name - p->params.text);
    return true;
}

/* The type's row, or that of a type that takes anything after a complaint. */
static const param_type *find_type(bis_parser *p, const bis_param *param)
{
    static const param_type unknown = {"", "", 0, ANYTHING};
    const char *names[BIS_COUNT(types)];

    for (size_t i = 0; i < BIS_COUNT(types); i++) {
        if (strcmp(param->type_name, types[i].name) == 0) return &types[i];
        names[i] = types[i].name;
    }
    bis_parser_error(p, param->at, "unknown parameter type \"%s\"%s", bis_parser_word(p, param->type_name),
                     bis_parser_hint(p, bis_nearest_name(param->type_name, names, BIS_COUNT(types))));
    return &unknown;
}

bis_param *bis_params_find(bis_parser *p, const char *name)
{
    for (size_t i = 0; i < p->params.n; i++) {
        bis_param *param = &p->params.list[i];
        if (strcmp(bis_parser_text(p, param->name), name) == 0) return param;
    }
    return NULL;
}

/* Of two parameters of one name the last counts, in the place of the first; but pbrt-v1 to v3 look for a texture before
 * they look for a value. */
static void repeat(bis_parser *p, bis_param *before, const bis_param *param)
{
    const bool is_texture = param->type == BIS_TYPE_TEXTURE, was_texture = before->type == BIS_TYPE_TEXTURE;
    const bool by_texture = is_texture != was_texture &&
                            bis_parser_is_before_v4(p, param->at, "a texture and a value of one name",
                                                    "the last one counts", "the texture counts");
    bis_approximate_pass(p, param->at, by_texture ? "the texture counts" : "the last one counts",
                         "\"%s\" given twice", bis_parser_text(p, param->name));
    if (is_texture || !by_texture) *before = *param;
}

static bool read_param(bis_parser *p)
{
    bis_param param = {.at = p->token.at};
    size_t offset = add_text(p);

    if (offset == SIZE_MAX || !split_declaration(p, &param, offset)) return false;
    const param_type *type = find_type(p, &param);
    param.type = type->type;
    param.type_name = type->shown;
    const char *name = bis_parser_text(p, param.name);
    bis_param *before = bis_params_find(p, name);
    bis_parser_advance(p);
    if (p->token.kind != BIS_TOKEN_OPEN && !is_value(&p->token) && p->token.kind != BIS_TOKEN_BAD &&
        !bis_token_is_nonfinite(&p->token))
        return bis_parser_lose(p, param.at, "\"%s\" has no value", name);
    if (!read_values(p, &param, type->values)) return false;
    if (!before) p->params.list[p->params.n++] = param;
    else repeat(p, before, &param);
    return true;
}

bool bis_params_read(bis_parser *p)
{
    while (p->token.kind == BIS_TOKEN_STRING && !p->stop) {
        if (p->params.n == BIS_MAX_PARAMS)
            return bis_parser_lose(p, p->token.at, "more than %d parameters", BIS_MAX_PARAMS);
        if (!read_param(p)) return false;
    }
    return !p->stop;
}
