/* SPDX-License-Identifier: BSD-2-Clause */
/* parser_version: one rule for the whole scene. Words that only some versions have may stand anywhere, also behind what
 * depends on them, so the main scene and each file that it includes are looked through for them beforehand, once.
 *
 * Source of the table: the parsers and the factories of pbrt-v1 to v4. A word that bis understands in scenes of its
 * own, whatever the version (a sampler, "filename" of a light), is not in it. */
#include "parser_version.h"

#include "bis/base/file.h"

#include <string.h>
#include <sys/stat.h>

enum { MAX_FILES = 10000 }; /* to be looked through */

/* Who has a word: one version or several that follow each other, or bis alone. */
typedef enum speaker { SAYS_V2, SAYS_NOT_V2, SAYS_BEFORE_V4, SAYS_V4, SAYS_OWN, N_SPEAKERS } speaker;

/* What is looked at: the directive, the name behind it (of a Texture its type), the name of a parameter, its type. */
typedef enum spot { DIRECTIVE, NAME, PARAMETER, TYPE } spot;

static const struct word {
    speaker says;
    spot where;
    const char *directive; /* NULL: any */
    const char *names;     /* between spaces */
} words[] = {
    {SAYS_V2, DIRECTIVE, NULL, " SurfaceIntegrator VolumeIntegrator Renderer "},
    {SAYS_V2, NAME, "Sampler", " bestcandidate "},
    {SAYS_NOT_V2, DIRECTIVE, NULL, " Integrator "},
    {SAYS_BEFORE_V4, DIRECTIVE, NULL, " WorldEnd "},
    {SAYS_BEFORE_V4, NAME, "Film", " image "},
    {SAYS_BEFORE_V4, NAME, "Texture", " color "},
    {SAYS_BEFORE_V4, NAME, "Material", " matte plastic uber metal substrate mirror glass translucent kdsubsurface "
                                       "shinymetal disney fourier "},
    {SAYS_BEFORE_V4, NAME, "Shape", " cone hyperboloid paraboloid heightfield nurbs "},
    {SAYS_BEFORE_V4, PARAMETER, "LightSource", " mapname "},
    {SAYS_BEFORE_V4, TYPE, NULL, " color "},
    {SAYS_V4, DIRECTIVE, NULL, " ColorSpace Attribute "},
    {SAYS_V4, NAME, "Film", " rgb gbuffer spectral "},
    {SAYS_V4, NAME, "Material", " diffuse conductor coateddiffuse coatedconductor dielectric thindielectric "
                                "diffusetransmission measured interface "},
    {SAYS_V4, PARAMETER, "Film", " iso sensor whitebalance exposuretime imagingratio "},
    {SAYS_V4, PARAMETER, "LightSource", " illuminance "},
    {SAYS_OWN, NAME, "Material", " phong microfacet "},
    {SAYS_OWN, NAME, "Integrator", " em brdf mis rejection sir exact unoccluded "},
    {SAYS_OWN, NAME, "Shape", " objmesh "},
};

/* The first word of each, as a message shows it. */
typedef struct found {
    char text[80];
    bis_loc at;
} found;

/* Where the look through a file stands. */
typedef struct look {
    bis_parser *p;
    found found[N_SPEAKERS];
    bis_names files;     /* those to be looked through */
    char directive[32];
    int n_names;         /* strings behind it, before its parameters */
    bool in_list, has_value; /* within [ ]; a parameter waits for its value */
    bool is_material;    /* and that value is a material's name */
} look;

/* A word without spaces cannot be found at the first or behind the last space of the names. */
static bool is_among(const char *names, const char *text)
{
    const size_t n = strlen(text);
    if (!n || strchr(text, ' ')) return false;
    for (const char *s = names; (s = strstr(s, text)) != NULL; s += n)
        if (s[-1] == ' ' && s[n] == ' ') return true;
    return false;
}

static void hear(look *l, spot where, const char *directive, const char *text, bis_loc at)
{
    for (size_t i = 0; i < BIS_COUNT(words); i++) {
        const struct word *w = &words[i];
        found *f = &l->found[w->says];
        if (f->at.line || w->where != where || (w->directive && strcmp(w->directive, directive) != 0) ||
            !is_among(w->names, text))
            continue;
        f->at = at;
        if (where == DIRECTIVE) snprintf(f->text, sizeof f->text, "%s", text);
        else if (where == NAME) snprintf(f->text, sizeof f->text, "%s \"%s\"", directive, text);
        else
            snprintf(f->text, sizeof f->text, "%s \"%s\" of %s", where == TYPE ? "type" : "parameter", text,
                     directive);
    }
}

/* A file that an Include names; where it is not there, or no file, the parser says so. */
static void add_file(look *l, const char *name, bis_loc at)
{
    struct stat st;
    char *path = bis_parser_find_file(l->p, at, name);
    const bool is_file = path && l->files.n < MAX_FILES && stat(path, &st) == 0 && S_ISREG(st.st_mode);
    if (!path || (is_file && !bis_names_set(&l->files, path, 0))) bis_parser_nomem(l->p, at);
    bis_free(path);
}

static void hear_string(look *l, const bis_token *t)
{
    char text[256] = "";
    if (t->length >= sizeof text) return;
    bis_token_unescape(text, t);
    if (l->n_names > 0) {
        const bool is_include = strcmp(l->directive, "Include") == 0 || strcmp(l->directive, "Import") == 0;
        const bool is_texture = strcmp(l->directive, "Texture") == 0;
        const bool is_wanted = !is_texture || l->n_names == 2;
        l->n_names--;
        if (is_include) add_file(l, text, t->at);
        else if (is_wanted) hear(l, NAME, l->directive, text, t->at);
        return;
    }
    if (l->has_value) {
        if (l->is_material) hear(l, NAME, "Material", text, t->at);
        l->has_value = l->in_list;
        return;
    }
    char type[64], name[64];
    if (sscanf(text, "%63s %63s", type, name) != 2) return;
    hear(l, TYPE, l->directive, type, t->at);
    hear(l, PARAMETER, l->directive, name, t->at);
    l->has_value = true;
    l->is_material = strcmp(l->directive, "MakeNamedMaterial") == 0 && strcmp(name, "type") == 0;
}

/* One file, from where the lexer stands. */
static void hear_file(look *l, bis_lexer *lexer)
{
    bis_token t;
    while ((t = bis_lexer_next(lexer)).kind != BIS_TOKEN_END) {
        switch (t.kind) {
        case BIS_TOKEN_WORD:
            if (l->has_value) break; /* true, false */
            snprintf(l->directive, sizeof l->directive, "%.*s", (int)(t.length < 31 ? t.length : 31), t.text);
            l->n_names = strcmp(l->directive, "Texture") == 0 ? 3 : strcmp(l->directive, "Option") != 0;
            hear(l, DIRECTIVE, "", l->directive, t.at);
            break;
        case BIS_TOKEN_STRING:
            hear_string(l, &t);
            continue;
        case BIS_TOKEN_OPEN:
            l->in_list = true;
            continue;
        case BIS_TOKEN_CLOSE:
            l->in_list = false;
            break;
        default:
            break;
        }
        if (!l->in_list) l->has_value = l->is_material = false;
    }
    l->in_list = l->has_value = l->is_material = false;
}

static void say_why(bis_parser *p, const char *version, const found *f)
{
    char *text = p->desc->version;
    const size_t size = sizeof p->desc->version;
    snprintf(text, size, "%s", version);
    if (f) bis_append(text, size, ", because of %s in %.80s:%d", f->text, f->at.file, f->at.line);
}

static void decide(bis_parser *p, const found of[N_SPEAKERS])
{
    const bool v2 = of[SAYS_V2].at.line && !of[SAYS_NOT_V2].at.line;
    const speaker old = v2 ? SAYS_V2 : SAYS_BEFORE_V4;
    const bool before = of[old].at.line, v4 = of[SAYS_V4].at.line, own = of[SAYS_OWN].at.line;
    if (before && !v4) {
        p->version = v2 ? BIS_PBRT_V2 : BIS_PBRT_V3;
        say_why(p, v2 ? "pbrt-v2 or v1" : "pbrt-v3", &of[old]);
    } else if (v4 && !before) {
        p->version = BIS_PBRT_V4;
        say_why(p, "pbrt-v4", &of[SAYS_V4]);
    } else if (own) {
        p->version = BIS_PBRT_V4;
        say_why(p, "bis's own words, read as pbrt-v4", &of[SAYS_OWN]);
    } else {
        p->version = BIS_PBRT_UNKNOWN;
        say_why(p, before ? "read as pbrt-v4: it has words of pbrt-v4 and of earlier versions"
                          : "read as pbrt-v4: no word tells", before ? &of[old] : NULL);
    }
}

void bis_parser_find_version(bis_parser *p)
{
    look l = {.p = p};
    bis_lexer one = {.n_sources = 1};

    one.sources[0] = p->lexer.sources[0]; /* its text is the parser's */
    hear_file(&l, &one);
    for (size_t i = 0; i < l.files.n; i++) {
        one.n_sources = 0;
        const bis_status status = bis_lexer_push(&one, l.files.names[i], (bis_loc){0});
        if (!status) hear_file(&l, &one);
        else if (status == BIS_NOMEM) bis_parser_nomem(p, (bis_loc){l.files.names[i], 0, 0});
        bis_lexer_clear(&one);
    }
    decide(p, l.found);
    bis_names_clear(&l.files);
}

bool bis_parser_is_before_v4(bis_parser *p, bis_loc at, const char *what, const char *as_v4, const char *before)
{
    if (p->version == BIS_PBRT_UNKNOWN && bis_parser_once(p, what))
        bis_warn(p->diag, at, "%s is read as in pbrt-v4: %s; in pbrt-v1 to v3: %s. Film \"rgb\" or \"image\" alone "
                 "says which is meant", what, as_v4, before);
    return bis_parser_predates_v4(p);
}
