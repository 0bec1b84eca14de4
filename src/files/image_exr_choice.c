/* SPDX-License-Identifier: BSD-2-Clause */
/* image_exr_choice: which part and which channels of an OpenEXR file are the picture.
 *
 * A channel "ViewLayer.Combined.R" is the R of the layer "ViewLayer.Combined", whose own name is "Combined". A part of
 * a file of several parts is a layer, too, named by its part, if its channels name none. Colours without a layer come
 * first, then the layers whose names mean the picture (picture_names), then grey without a layer, then a part of
 * another name, then a layer that is the only one. Others are not guessed, because a file sorts its channels: the first
 * is "albedo" or "AO".
 * R, G, B may be small letters or words. Y is luminance, perhaps with chroma RY and BY; beside an X it is a coordinate.
 * A single R, G or B is refused: grey and "the others are 0" are both in use.
 * Source: "OpenEXR Technical Introduction" (layers); Blender, Arnold, Nuke, Houdini (their names of the picture). */
#include "image_exr_choice.h"

#include "base/text.h"

#include <limits.h>
#include <string.h>
#include <strings.h>

static const char *const picture_names[] = {"Combined", "beauty", "rgba", "C"};
enum { N_NAMES = sizeof picture_names / sizeof *picture_names };

/* Ranks of a choice, two of each: colours come before luminance. */
enum { BARE = 0, NAMED = 2, BARE_GREY = NAMED + 2 * N_NAMES, OF_OTHER_PART = BARE_GREY + 2,
       UNKNOWN = OF_OTHER_PART + 2 };

/* All that is looked at. */
typedef struct exr_search {
    exr_const_context_t file;
    int n_parts, n_deep;
    int rank, n_alike;  /* of the best so far; how many have its rank */
    int n_layers;       /* with colours or not */
    char layers[200];   /* those with colours, for a message */
} exr_search;

/* The length of what stands before the channel's own name: 0, or that of a layer's name and a dot. */
static int layer_length(const char *name)
{
    const char *dot = strrchr(name, '.');
    return dot ? (int)(dot + 1 - name) : 0;
}

/* The channel of the layer of `of` that has one of two names, in any case of letters. */
static const exr_attr_chlist_entry_t *beside(const exr_attr_chlist_t *list, const char *of, const char *name,
                                             const char *word)
{
    const int n = layer_length(of);
    for (int i = 0; i < list->num_channels; i++) {
        const char *s = list->entries[i].name.str;
        if (layer_length(s) != n || strncmp(s, of, (size_t)n) != 0) continue;
        if (!strcasecmp(s + n, name) || !strcasecmp(s + n, word)) return &list->entries[i];
    }
    return NULL;
}

/* Is channel i the R of colours, or the Y of luminance? Then *c has the channels. */
static bool begins_choice(exr_choice *c, const exr_attr_chlist_t *list, int i)
{
    const exr_attr_chlist_entry_t *first = &list->entries[i];
    const char *name = first->name.str;

    c->channel[0] = first;
    c->colour = beside(list, name, "R", "red") == first;
    c->channel[1] = c->colour ? beside(list, name, "G", "green") : NULL;
    c->channel[2] = c->colour ? beside(list, name, "B", "blue") : NULL;
    c->chroma = !c->colour && beside(list, name, "RY", "RY") && beside(list, name, "BY", "BY");
    if (c->colour) return c->channel[1] && c->channel[2];
    return !strcmp(name + layer_length(name), "Y") && !beside(list, name, "X", "X");
}

/* Its place in picture_names, by what stands behind the last dot; N_NAMES: none. */
static int find_name(const char *layer, int length)
{
    int start = length, k = 0;
    while (start > 0 && layer[start - 1] != '.') start--;
    while (k < N_NAMES && ((int)strlen(picture_names[k]) != length - start ||
                           strncasecmp(picture_names[k], layer + start, (size_t)(length - start)) != 0))
        k++;
    return k;
}

/* The layer's name, which is the part's where the channels have none. */
static const char *layer_of(int *length, const exr_search *s, const exr_choice *c)
{
    const char *name = c->channel[0]->name.str, *part = NULL;
    *length = layer_length(name) - 1;
    if (*length >= 0) return name;
    if (s->n_parts < 2 || exr_get_name(s->file, c->part, &part)) part = NULL;
    *length = part ? (int)strlen(part) : 0;
    return part ? part : "";
}

static int rank_of(const exr_search *s, const exr_choice *c)
{
    int length;
    const char *layer = layer_of(&length, s, c);
    const int named = find_name(layer, length);
    const int rank = length == 0                        ? (c->colour || c->chroma ? BARE : BARE_GREY)
                     : named < N_NAMES                  ? NAMED + 2 * named
                     : layer == c->channel[0]->name.str ? UNKNOWN
                                                        : OF_OTHER_PART;
    return rank + !c->colour;
}

/* Does channel i begin a layer? Those of a layer stand together, because a file sorts them by name. */
static bool begins_layer(const exr_attr_chlist_t *list, int i)
{
    const char *s = list->entries[i].name.str, *before = i ? list->entries[i - 1].name.str : NULL;
    const int n = layer_length(s);
    return !before || layer_length(before) != n || strncmp(s, before, (size_t)n) != 0;
}

static void search_part(exr_choice *best, exr_search *s, int part)
{
    exr_storage_t storage;
    const exr_attr_chlist_t *list;

    if (exr_get_storage(s->file, part, &storage) || exr_get_channels(s->file, part, &list)) return;
    const bool deep = storage == EXR_STORAGE_DEEP_SCANLINE || storage == EXR_STORAGE_DEEP_TILED;
    s->n_deep += deep;
    for (int i = 0; i < list->num_channels && !deep; i++) {
        exr_choice c = {.part = part};
        int length;
        s->n_layers += layer_length(list->entries[i].name.str) > 0 && begins_layer(list, i);
        if (!begins_choice(&c, list, i)) continue;
        const int rank = rank_of(s, &c);
        const char *layer = layer_of(&length, s, &c);
        if (length > 0)
            bis_append(s->layers, sizeof s->layers, "%s\"%.*s\"", *s->layers ? ", " : "", length, layer);
        s->n_alike = rank < s->rank ? 1 : s->n_alike + (rank == s->rank);
        if (rank >= s->rank) continue;
        s->rank = rank;
        *best = c;
    }
}

/* For a message: the channels of all parts, as many as fit. */
static void list_channels(char *text, size_t room, exr_const_context_t file, int n_parts)
{
    text[0] = '\0';
    for (int part = 0; part < n_parts; part++) {
        const exr_attr_chlist_t *list;
        if (exr_get_channels(file, part, &list)) continue;
        for (int i = 0; i < list->num_channels; i++)
            bis_append(text, room, "%s\"%s\"", *text ? ", " : "", list->entries[i].name.str);
    }
}

static bis_status refuse(const exr_search *s, const image_input *in)
{
    char names[200];

    if (s->n_deep == s->n_parts)
        return bis_image_refuse(in, BIS_INPUT, "it holds deep data alone (many samples a pixel); flatten it first");
    if (s->rank >= UNKNOWN && s->layers[0])
        return bis_image_refuse(in, BIS_INPUT, "it has no R, G, B without a layer, and which of its layers %s is the "
                                "picture is not known: name it Combined, beauty, rgba or C, or save it as R, G, B",
                                s->layers);
    list_channels(names, sizeof names, s->file, s->n_parts);
    return bis_image_refuse(in, BIS_INPUT, "its channels are %s, must be R, G and B, or Y, perhaps in a layer", names);
}

bis_status bis_exr_choose(exr_choice *c, exr_const_context_t file, const image_input *in)
{
    exr_search s = {.file = file, .rank = INT_MAX};
    int length;

    *c = (exr_choice){0};
    if (exr_get_count(file, &s.n_parts)) return bis_image_refuse(in, BIS_INPUT, "its header is damaged");
    for (int part = 0; part < s.n_parts; part++) search_part(c, &s, part);
    if (s.rank == INT_MAX || (s.rank >= UNKNOWN && s.n_layers > 1)) return refuse(&s, in);

    const char *const name = c->channel[0]->name.str, *const layer = layer_of(&length, &s, c);
    const exr_attr_chlist_t *list;
    if (in->wants_alpha && !exr_get_channels(file, c->part, &list)) c->alpha = beside(list, name, "A", "alpha");
    c->is_plain = c->part == 0 && !strcmp(name, c->colour ? "R" : "Y") &&
                  (!c->colour || (!strcmp(c->channel[1]->name.str, "G") && !strcmp(c->channel[2]->name.str, "B")));
    if (s.n_parts > 1) bis_image_remark(in, "part %d of %d is read, the others are ignored", c->part + 1, s.n_parts);
    if (layer == name)
        bis_image_remark(in, "it has no R, G, B at the top; layer \"%.*s\" is read%s", length, layer,
                         s.n_alike > 1 ? ", the first of several such" : "");
    return BIS_OK;
}
