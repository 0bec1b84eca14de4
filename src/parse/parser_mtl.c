/* SPDX-License-Identifier: BSD-2-Clause */
/* parser_mtl: the materials of a Wavefront OBJ, for Shape "objmesh" "bool materials" true.
 *
 * The OBJ tells its parts apart by usemtl and names libraries by mtllib; each part that has a face becomes a shape of
 * its own with a material of its own, so that all else sees shapes with one material. A material of a library is
 * Phong's: Kd, Ks and Ns, with map_Kd as an image that multiplies Kd. illum 0 and 1 have no highlight. map_bump (bump)
 * is a displacement, norm a normal map. What a library says of other maps, of transparency and of light is ignored with
 * a warning. Source: Wavefront's "MTL material format" (1995), and the files of the wild, where norm comes from.
 *
 * An OBJ is read in src/files/obj.c alone, a library here alone. A library is not read in src/files, because nearly
 * each of its lines makes a texture or a material of the scene, or is replaced with --approximate: a reader there would
 * have to return all of them, and this file to walk over them again. */
#include "bis/base/file.h"
#include "bis/thesis/phong.h"
#include "base/grow.h"
#include "files/obj.h"
#include "approximate.h"
#include "parser_materials.h"
#include "parser_shapes.h"
#include "parser_textures.h"

#include <string.h>
#include <strings.h>
#include <unistd.h>

/* A material of a library while it is read. */
typedef struct mtl {
    bool exists, has_Kd, has_comment; /* the name is the part's without a comment alone */
    rgb Kd, Ks;
    double Ns;
    bool is_matte; /* illum 0 or 1 */
    bool lacks_map; /* of map_Kd, replaced with --approximate */
    uint32_t map;  /* the texture of map_Kd */
    uint32_t bump; /* the texture of map_bump */
    uint32_t normals; /* the image of norm */
    bis_loc at;
} mtl;

/* A line of a library. */
typedef struct line {
    char *words; /* behind the first one; blanks cut off at the end */
    bis_loc at;
} line;

/* A map while it is read: the texture, the gamma of its image, and whether -imfchan says that it holds numbers. */
typedef struct map {
    bis_texture x;
    double gamma;
    bool names_channel;
} map;

/* What a material is of which nothing is said. */
static const mtl grey = {.Kd = {0.5f, 0.5f, 0.5f}, .Ns = 50, .map = BIS_NO_TEXTURE, .bump = BIS_NO_TEXTURE,
                         .normals = BIS_NO_TEXTURE};

static const char blanks[] = " \t\v\f";

/* ---- values ---- */

static bool is_one_of(const char *word, const char *const *words, size_t n)
{
    for (size_t i = 0; i < n; i++)
        if (strcasecmp(word, words[i]) == 0) return true;
    return false;
}

static bool is_word(const char *word, const char *of_a_library) { return strcasecmp(word, of_a_library) == 0; }

/* n numbers; with one alone, but for a comment, all are that. */
static bool read_numbers(bis_parser *p, const line *l, const char *what, double *v, int n)
{
    const char *s = l->words, *end;
    int got = 0;
    for (; got < n && *s; got++, s = end) {
        s += strspn(s, blanks);
        v[got] = bis_parse_double(s, &end);
        if (end == s || !isfinite(v[got]) || (*end && !strchr(blanks, *end))) break;
    }
    const bool alone = got == 1 && (!*s || s[strspn(s, blanks)] == '#');
    for (int i = 1; alone && i < n; i++) v[i] = v[0];
    if (got == n || alone) return true;
    return bis_parser_error(p, l->at, "%s is \"%s\", must be %s", what, bis_parser_word(p, l->words),
                            n == 1 ? "a number" : "three numbers");
}

static void read_colour(bis_parser *p, const line *l, const char *what, rgb *c)
{
    static const bis_interval unit = {0, 1, false, false};
    double v[3];
    if (!read_numbers(p, l, what, v, 3)) return;
    for (int i = 0; i < 3; i++)
        if (!bis_parser_in_range(p, l->at, what, &v[i], unit)) return;
    *c = rgb_from(v[0], v[1], v[2]);
}

static void read_Ns(bis_parser *p, const line *l, double *Ns)
{
    static const bis_interval positive_or_0 = {0, HUGE_VAL, false, false};
    double v;
    if (read_numbers(p, l, "Ns", &v, 1) && bis_parser_in_range(p, l->at, "Ns", &v, positive_or_0)) *Ns = v;
}

/* -imfchan names the channel of a map of numbers. A map of colours has all three, whatever it says. */
static bool read_channel(bis_parser *p, const line *l, char **s, map *m)
{
    const size_t n = strcspn(*s, blanks);
    const bool is_mean = n == 1 && **s == 'l';
    m->names_channel = true;
    if (m->x.is_float && !is_mean &&
        !bis_approximate_or_refuse(p, l->at, "-imfchan of a map", "the mean of red, green and blue",
                                   "-imfchan %.*s is not modelled, because a map of numbers is the mean of red, green "
                                   "and blue: save the channel as a grey image and remove the option",
                                   (int)(n < 8 ? n : 8), bis_parser_word(p, *s)))
        return false;
    *s += n;
    return true;
}

/* Up to `most` numbers at *s, each with a blank behind it, because a file's name may begin with a digit. Returns how
 * many, and leaves *s at the next word. */
static int take_numbers(char **s, double *v, int most)
{
    int n = 0;
    for (const char *end; n < most; n++, *s = (char *)end + strspn(end, blanks)) {
        v[n] = bis_parse_double(*s, &end);
        if (end == *s || !*end || !strchr(blanks, *end) || !isfinite(v[n])) break;
    }
    return n;
}

/* -colorspace, a word of tinyobjloader's: what the numbers of the image mean. */
static bool read_colour_space(bis_parser *p, const line *l, const char *word, double *gamma)
{
    if (strcasecmp(word, "sRGB") == 0) *gamma = BIS_GAMMA_SRGB;
    else if (strcasecmp(word, "linear") == 0) *gamma = 1;
    else
        return bis_approximate_or_refuse(p, l->at, "a colour space of a map that is not known", "the usual one",
                                         "the colour space \"%s\" of a map is not known, must be sRGB or linear",
                                         bis_parser_word(p, word));
    return true;
}

static bool refuse_option(bis_parser *p, const line *l, const char *word)
{
    return bis_approximate_or_refuse(p, l->at, "an option of a map that is not modelled", "ignored",
                                     "the option %s of a map is not modelled: remove it", bis_parser_word(p, word));
}

/* Options that bis does not have: those of numbers pass if these are the usual ones, which change nothing. The others
 * say how a program keeps and filters an image; no value of a texel depends on them. */
static bool pass_option(bis_parser *p, const line *l, const char *word, char **s)
{
    static const struct { const char *name; int most; double usual[3]; } of_numbers[] = {
        {"-mm", 2, {0, 1}}, {"-t", 3, {0, 0, 0}}, {"-bm", 1, {1}}};
    static const char *const ignored[] = {"-texres", "-blendu", "-blendv", "-boost", "-cc"};
    for (size_t i = 0; i < BIS_COUNT(of_numbers); i++) {
        if (!is_word(word, of_numbers[i].name)) continue;
        double v[3];
        bool is_usual = true;
        const int n = take_numbers(s, v, of_numbers[i].most);
        for (int k = 0; k < n; k++) is_usual &= v[k] == of_numbers[i].usual[k];
        return is_usual || refuse_option(p, l, word);
    }
    *s += strcspn(*s, blanks); /* its value */
    if (!is_one_of(word, ignored, BIS_COUNT(ignored))) return refuse_option(p, l, word);
    if (bis_parser_once(p, "options of a map"))
        bis_warn(p->diag, l->at, "%s of a map is ignored: images are taken as they are", bis_parser_word(p, word));
    return true;
}

/* The options before a map's name. Those that change what is seen are refused, but -clamp on, -o and -s, -imfchan of
 * colours, -colorspace, and -bm of a displacement, which is a map of numbers. */
static bool read_options(bis_parser *p, const line *l, char **name, map *m)
{
    bis_texture *x = &m->x;
    char *s = l->words;
    while (*s == '-') {
        char *word = s;
        s += strcspn(s, blanks);
        if (*s) *s++ = '\0';
        s += strspn(s, blanks);
        if (is_word(word, "-clamp")) {
            x->wrap = strncasecmp(s, "on", 2) == 0 ? BIS_WRAP_CLAMP : BIS_WRAP_REPEAT;
            s += strcspn(s, blanks);
        } else if (is_word(word, "-s") || is_word(word, "-o")) {
            double v[3];
            const int n = take_numbers(&s, v, 3);
            for (int i = 0; i < 2 && i < n; i++) (is_word(word, "-s") ? x->factor : x->offset)[i] = v[i];
        } else if (is_word(word, "-bm") && x->is_float) {
            if (take_numbers(&s, &x->scale, 1) != 1)
                return bis_parser_error(p, l->at, "-bm is \"%s\", must be a number", bis_parser_word(p, s));
        } else if (is_word(word, "-imfchan")) {
            if (!read_channel(p, l, &s, m)) return false;
        } else if (is_word(word, "-colorspace")) {
            char *space = s;
            s += strcspn(s, blanks);
            if (*s) *s++ = '\0';
            if (!read_colour_space(p, l, space, &m->gamma)) return false;
        } else if (!pass_option(p, l, word, &s)) {
            return false;
        }
        s += strspn(s, blanks);
    }
    *name = s;
    return true;
}

static const bis_stand_in no_image = {"an image of a library that is not there", "the material without it",
                                      "an image of a library that cannot be read", true};
static const bis_stand_in no_embedded = { /* assimp's name for it is *0 */
    "an image that is inside of a model, and was not written with its library",
    "the material without it. It is inside of the model that was converted: Python's trimesh writes it (README)",
    NULL, true};
static const bis_stand_in no_library = {"a library of materials that is not there", "its materials are diffuse grey",
                                        NULL, true};

/* A name as other systems write it: in quotes, with backslashes for slashes, but for one before a blank, which keeps a
 * name together there. In place. */
static char *clean_name(char *name)
{
    const size_t n = strlen(name);
    char *to = name;
    if (n >= 2 && name[0] == '"' && name[n - 1] == '"') {
        name[n - 1] = '\0';
        to = ++name;
    }
    for (const char *s = name; *s; s++) {
        if (*s != '\\') *to++ = *s;
        else if (!s[1] || !strchr(blanks, s[1])) *to++ = '/';
    }
    *to = '\0';
    return name;
}

static bool is_beside(bis_parser *p, bis_loc at, const char *name)
{
    char *path = name ? bis_path_relative_to(at.file, name) : NULL;
    const bool is = path && access(path, R_OK) == 0;
    if (!path) bis_parser_nomem(p, at);
    bis_free(path);
    return is;
}

/* How long a name is without a comment. But a name may hold " #", too, as 3ds Max's "Material #25". */
static size_t name_length(const char *name)
{
    const char *comment = strstr(name, " #");
    size_t n = comment ? (size_t)(comment - name) : strlen(name);
    while (n > 0 && strchr(blanks, name[n - 1])) n--;
    return n;
}

/* It is a comment if there is no file of the whole name. */
static void cut_comment(bis_parser *p, bis_loc at, char *name)
{
    const size_t n = name_length(name);
    if (name[n] && !is_beside(p, at, name)) name[n] = '\0';
}

/* A map, whose options go to *m and its image to *image. False: there is none, and that was said. */
static bool read_map(bis_parser *p, const line *l, map *m, uint32_t *image)
{
    char *name = l->words;
    if (!read_options(p, l, &name, m)) return false;
    cut_comment(p, l->at, name);
    name = clean_name(name);
    bool lacks;
    char *path = bis_approximate_path(p, &lacks, l->at, name, name[0] == '*' ? &no_embedded : &no_image);
    const bool is_bump = m->x.is_float && !m->names_channel;
    const bis_texture_file as = {.gamma = m->gamma, .loc = l->at,
                                 .meaning = is_bump ? BIS_IMAGE_BUMP : BIS_IMAGE_COLOURS};
    return !lacks && bis_parser_add_image(p, path, &as, image);
}

/* Heights and normals are linear numbers, whatever the format means by its own. */
static map plain_map(bool is_float, double gamma)
{
    return (map){{.kind = BIS_TEXTURE_IMAGE, .value = {0.5, 0.5, 0.5}, .factor = {1, 1}, .scale = 1, .steps = 1,
                  .is_float = is_float}, gamma, false};
}

static bool read_map_Kd(bis_parser *p, const line *l, uint32_t *texture)
{
    map m = plain_map(false, BIS_GAMMA_SRGB);
    return read_map(p, l, &m, &m.x.image) && bis_parser_add_texture(p, &m.x, texture);
}

static void read_map_bump(bis_parser *p, const line *l, uint32_t *texture)
{
    map m = plain_map(true, 1);
    if (read_map(p, l, &m, &m.x.image) && m.x.scale != 0) bis_parser_add_texture(p, &m.x, texture);
}

static void read_norm(bis_parser *p, const line *l, uint32_t *image)
{
    map m = plain_map(false, 1);
    uint32_t read;
    if (!read_map(p, l, &m, &read)) return;
    const bool moves = m.x.factor[0] != 1 || m.x.factor[1] != 1 || m.x.offset[0] != 0 || m.x.offset[1] != 0;
    if (!moves || bis_approximate_or_refuse(p, l->at, "-s or -o of a normal map", "the map lies as if it had neither",
                                            "the options -s and -o of norm are not modelled: remove them"))
        *image = read;
}

/* ---- a library ---- */

/* What says nothing that bis could show, and what it will not show: a warning for each word. */
static void read_other(bis_parser *p, const line *l, const char *word)
{
    static const char *const silent[] = {"Ka", "Ni", "Tf", "sharpness", "map_Ka"};
    static const char gloss[] = "highlights: they are as Ks and Ns say";
    static const char *const ignored[][2] = {
        {"map_Ks", gloss}, {"map_Ns", gloss}, {"refl", gloss}, {"Pr", gloss}, {"Pm", gloss}, {"Ps", gloss},
        {"Pc", gloss}, {"map_Pr", gloss}, {"map_Pm", gloss}, {"aniso", gloss},
        {"map_d", "shape: there are no holes"},
        {"map_Ke", "brightness: no surface gives light"},
        {"disp", "shape: the mesh stays as it is"},
        {"decal", "colour: it is as Kd says"},
    };
    double v[3] = {0, 0, 0};
    if (is_one_of(word, silent, BIS_COUNT(silent))) return;
    for (size_t i = 0; i < BIS_COUNT(ignored); i++) {
        if (!is_word(word, ignored[i][0])) continue;
        if (bis_parser_once(p, ignored[i][0]))
            bis_warn(p->diag, l->at, "%s is ignored, which changes %s", ignored[i][0], ignored[i][1]);
        return;
    }
    if (is_word(word, "d") || is_word(word, "Tr")) {
        const bool ok = read_numbers(p, l, word, v, 1), opaque = is_word(word, "d") ? v[0] >= 1 : v[0] <= 0;
        if (ok && !opaque && bis_parser_once(p, "Tr"))
            bis_warn(p->diag, l->at, "%s is ignored, which changes shape: the material is opaque", word);
    } else if (is_word(word, "Ke")) {
        if (read_numbers(p, l, word, v, 3) && v[0] + v[1] + v[2] > 0 && bis_parser_once(p, "Ke"))
            bis_warn(p->diag, l->at, "Ke is ignored, which changes brightness: no surface gives light");
    } else if (bis_parser_once(p, "mtl")) {
        bis_warn(p->diag, l->at, "the unknown word \"%s\" is ignored, and others like it", bis_parser_word(p, word));
    }
}

static void read_statement(bis_parser *p, const line *l, const char *word, mtl *m)
{
    static const char *const bumps[] = {"map_bump", "bump"}, *const normals[] = {"norm", "map_Kn"};
    double illum;
    if (is_word(word, "Kd")) {
        read_colour(p, l, "Kd", &m->Kd);
        m->has_Kd = true;
    } else if (is_word(word, "Ks")) read_colour(p, l, "Ks", &m->Ks);
    else if (is_word(word, "Ns")) read_Ns(p, l, &m->Ns);
    else if (is_word(word, "map_Kd")) m->lacks_map = !read_map_Kd(p, l, &m->map);
    else if (is_one_of(word, bumps, BIS_COUNT(bumps))) read_map_bump(p, l, &m->bump);
    else if (is_one_of(word, normals, BIS_COUNT(normals))) read_norm(p, l, &m->normals);
    else if (is_word(word, "illum")) m->is_matte = read_numbers(p, l, "illum", &illum, 1) && illum < 2;
    else read_other(p, l, word);
}

/* Cut the next line off *next and split it: its first word, or "" for a line without one. */
static char *take_line(line *l, char **next)
{
    char *word = *next + strspn(*next, blanks), *end = *next + strcspn(*next, "\r\n");
    *next = end + (end[0] == '\r' && end[1] == '\n' ? 2 : *end ? 1 : 0);
    *end = '\0';
    while (end > word && strchr(blanks, end[-1])) *--end = '\0';
    if (*word == '#') *word = '\0';
    char *rest = word + strcspn(word, blanks);
    if (*rest) *rest++ = '\0';
    l->words = rest + strspn(rest, blanks);
    return word;
}

/* Is the material that newmtl names asked for, by its whole name or without a comment? */
static bool find_part(const bis_obj_materials *obj, const char *name, uint32_t *part, bool *exact)
{
    const size_t n = name_length(name);
    *exact = bis_names_find(&obj->parts, name, part);
    for (size_t k = 0; !*exact && k < obj->parts.n; k++) {
        const char *other = obj->parts.names[k];
        *part = (uint32_t)k + 1;
        if (name_length(other) == n && strncmp(other, name, n) == 0) return true;
    }
    return *exact;
}

/* The materials of parts that have faces; wanted[n]: by the part's number. */
static void read_library(bis_parser *p, const char *path, char *text, const bis_obj_materials *obj, mtl *wanted)
{
    line l = {.at = {path, 0, 0}};
    mtl other, *m = NULL;
    for (char *next = text; *next && !p->stop;) {
        uint32_t part;
        const char *word = take_line(&l, &next);
        l.at.line++;
        if (!*word) continue;
        if (is_word(word, "newmtl")) {
            bool exact;
            const bool shown = find_part(obj, l.words, &part, &exact) && part < obj->n_shown && obj->is_shown[part];
            /* of two by one name the first counts */
            const bool counts = shown && (!wanted[part].exists || (exact && wanted[part].has_comment));
            m = counts ? &wanted[part] : &other;
            *m = grey;
            m->has_comment = !exact;
            m->at = l.at;
            m->exists = true;
        } else if (!m) {
            bis_parser_error(p, l.at, "\"%s\" stands before the first newmtl", bis_parser_word(p, word));
            return;
        } else if (m != &other) {
            read_statement(p, &l, word, m);
        }
    }
}

/* A library, unless it has been read: some programs name one for each object. */
static void read_file(bis_parser *p, bis_loc at, char *library, bis_names *read, const bis_obj_materials *obj,
                      mtl *wanted)
{
    unsigned char *data;
    size_t size;
    bool lacks;
    if (bis_names_find(read, library, NULL)) return;
    if (!bis_names_set(read, library, 0)) {
        bis_parser_nomem(p, at);
        return;
    }
    char *path = bis_approximate_path(p, &lacks, at, library, &no_library);
    if (lacks) return;
    const char *name = path ? bis_scene_desc_add_file(p->desc, path) : NULL;
    if (path && !name) bis_parser_nomem(p, at);
    if (!name) return;
    const bis_status status = bis_file_read(&data, &size, name, at, p->diag);
    bis_parser_note(p, status);
    if (status) return;
    char *text = (char *)data + bis_byte_order_mark(data, size);
    if (strlen((const char *)data) == size) read_library(p, name, text, obj, wanted);
    else bis_parser_error(p, (bis_loc){name, 0, 0}, "no library of materials: there is a zero byte in it");
    bis_free(data);
}

/* The end of the longest row of words that is a file, because names may hold blanks; NULL: none is. */
static char *end_of_file(bis_parser *p, bis_loc at, char *names)
{
    enum { MOST = 16 }; /* words of a name */
    char *end = names, *found = NULL;
    for (int i = 0; i < MOST && *end && !p->stop; i++) {
        end += strspn(end, blanks);
        end += strcspn(end, blanks);
        char *name = bis_strndup(names, (size_t)(end - names));
        if (is_beside(p, at, name ? clean_name(name) : NULL)) found = end;
        bis_free(name);
    }
    return found;
}

/* What one mtllib names: one library, or several. What is no file, up to the next one that is, is a missing one. */
static void read_mtllib(bis_parser *p, bis_loc at, char *names, bis_names *read, const bis_obj_materials *obj,
                        mtl *wanted)
{
    cut_comment(p, at, names);
    while (*names && !p->stop) {
        char *end = end_of_file(p, at, names), *next = end;
        for (next = names; !end && *next && (next == names || !end_of_file(p, at, next)); next += strspn(next, blanks))
            next += strcspn(next, blanks);
        if (!end) end = next;
        next = end + strspn(end, blanks);
        while (end > names && strchr(blanks, end[-1])) end--;
        char *name = bis_strndup(names, (size_t)(end - names));
        if (name) read_file(p, at, clean_name(name), read, obj, wanted);
        else bis_parser_nomem(p, at);
        bis_free(name);
        names = next;
    }
}

static void read_libraries(bis_parser *p, const char *obj_path, const bis_obj_materials *obj, mtl *wanted)
{
    bis_names read = {0};
    for (size_t i = 0; i < obj->n_libraries && !p->stop; i++)
        read_mtllib(p, (bis_loc){obj_path, obj->libraries[i].line, 0}, obj->libraries[i].name, &read, obj, wanted);
    bis_names_clear(&read);
}

/* ---- materials ---- */

/* map_Kd times Kd. Without Kd it is the map alone, as in other programs (the format does not say), and beside a Kd of
 * 0, too, because Maya writes that and means the map. */
static bool multiply(bis_parser *p, const mtl *m, uint32_t *texture)
{
    const bis_texture c = {.kind = BIS_TEXTURE_CONSTANT, .steps = 1,
                           .value = {(double)m->Kd.r, (double)m->Kd.g, (double)m->Kd.b}};
    bis_texture x = {.kind = BIS_TEXTURE_SCALE, .of = {m->map}, .scale = 1, .steps = 3,
                     .value = rgbd_scale(c.value, 0.5)};
    *texture = m->map;
    if (m->has_Kd && rgb_is_black(m->Kd))
        bis_warn(p->diag, m->at, "Kd 0 0 0 beside map_Kd: taken for 1 1 1, because the map would be black. To have it "
                 "so, remove map_Kd");
    if (!m->has_Kd || rgb_is_black(m->Kd) || (m->Kd.r == 1 && m->Kd.g == 1 && m->Kd.b == 1)) return true;
    return bis_parser_add_texture(p, &c, &x.of[1]) && bis_parser_add_texture(p, &x, texture);
}

static bool make_material(bis_parser *p, const mtl *m, uint32_t *index)
{
    bis_material_textures t = BIS_NO_TEXTURES;
    t.loc = m->at;
    if (!bis_parser_add_material(p, index)) return false;
    const bool hides_map = m->lacks_map && rgb_is_black(m->Kd); /* Maya writes a Kd of 0 beside a map */
    p->desc->materials[*index] = bis_phong(hides_map ? grey.Kd : m->Kd, m->is_matte ? (rgb){0, 0, 0} : m->Ks, m->Ns);
    t.bump = m->bump;
    t.normals = m->normals;
    if (m->map == BIS_NO_TEXTURE)
        bis_parser_warn_energy(p, m->at, p->desc->materials[*index].Kd, p->desc->materials[*index].Ks);
    else if (!multiply(p, m, &t.Kd)) return false;
    if (!bis_textures_any(&t)) return true;
    return bis_scene_desc_set_textures(p->desc, *index, &t) || bis_parser_nomem(p, m->at);
}

/* The shape of one part. */
static void add_part(bis_parser *p, const bis_shape_desc *shape, const bis_obj_materials *obj, uint32_t part,
                     const mtl *m)
{
    bis_shape_desc own = *shape;
    own.part = part;
    if (part > 0 && !m->exists) {
        if (!bis_approximate_or_refuse(p, shape->loc, "a material that is in no library of its mesh", "diffuse grey",
                                       "material \"%s\" of %s is in none of its libraries (mtllib): add it, or leave "
                                       "out \"bool materials\"", bis_parser_word(p, obj->parts.names[part - 1]),
                                       p->desc->meshes[shape->mesh].filename))
            return;
        m = &grey;
    }
    if (part == 0 || make_material(p, m, &own.material)) bis_parser_add_shape(p, &own);
}

void bis_parser_add_parts(bis_parser *p, const bis_shape_desc *shape)
{
    bis_mesh_desc *mesh = &p->desc->meshes[shape->mesh];
    bis_obj_materials obj;
    const bis_status status = bis_obj_read_materials(&obj, mesh->filename, mesh->loc, p->diag);
    bis_parser_note(p, status);
    if (status) return;
    const unsigned errors = p->n_errors;
    mesh->n_parts = obj.parts.n;
    if (!obj.n_shown) /* the last of these has a face */
        bis_parser_error(p, mesh->loc, "\"%s\" has no faces: it is no OBJ, or an empty one", mesh->filename);
    mtl *wanted = bis_alloc(obj.n_shown, sizeof *wanted);
    char *name = bis_strdup(mesh->filename); /* the place of messages: it must live as long as they do */
    const char *path = name ? bis_scene_desc_add_file(p->desc, name) : NULL;
    if (!wanted || !path) bis_parser_nomem(p, shape->loc);
    else read_libraries(p, path, &obj, wanted);
    for (size_t k = 0; k < obj.n_shown && p->n_errors == errors && !p->stop; k++)
        if (obj.is_shown[k]) add_part(p, shape, &obj, (uint32_t)k, &wanted[k]);
    bis_free(wanted);
    bis_obj_materials_clear(&obj);
}
