/* SPDX-License-Identifier: BSD-2-Clause */
/* help_topics: what a user wants to look up without a browser. Names, defaults and ranges of a scene stand in the
 * tables of docs/scene-format.md, those of integrators in src/scene/parameters.c, those of options in cmd_render.c: all
 * are read here, and none is written again. */
#include "help.h"

#include <assert.h>
#include <string.h>

/* Terms that stand for an entry for each integrator and for each parameter; bis_help_open makes their texts. */
static const char of_integrators[] = "", of_parameters[] = "";

static const bis_help_entry scene[] = {
    {NULL, "A scene says how it is looked at, then WorldBegin, then what there is. # begins a comment. Parameters are "
           "\"type name\" value, as in \"float fov\" 45. A parameter or directive that nobody knows is an error, what "
           "pbrt has and bis leaves out a warning or an error that says so."},
    {"Camera \"perspective\" \"float fov\" 45", NULL},
    {"Sampler \"sobol\" \"integer pixelsamples\" 64", NULL},
    {"Integrator \"sir\" \"integer candidates\" 256", NULL},
    {"WorldBegin", NULL},
    {"LightSource \"infinite\" \"string filename\" \"map.exr\"", NULL},
    {"Material \"phong\" \"rgb Kd\" [0.1 0.1 0.2] \"float Ks\" 0.6", NULL},
    {"Shape \"plymesh\" \"string filename\" \"dragon.ply\"", NULL},
    {NULL, "Anywhere: what acts on the current transformation, from the right (the world is left-handed), and"},
    {"Include \"file\"", "go on reading there"},
    {BIS_HELP_PAGE "Transformations", NULL},
    {NULL, "Before WorldBegin (of a parameter: default; range):"},
    {"Camera", "\"perspective\" or \"orthographic\", with"},
    {BIS_HELP_PAGE "Camera", NULL},
    {"Film", "\"rgb\", with"},
    {BIS_HELP_PAGE "Film", NULL},
    {"Sampler", "a kind, and parameters"},
    {BIS_HELP_PAGE "Sampler", NULL},
    {"Integrator", "see integrators"},
    {"Accelerator", "\"embree\" (the default where it is built in) or \"grid\", with"},
    {BIS_HELP_PAGE "Accelerator", NULL},
    {"Option", "\"bool disablepixeljitter\" (false); \"string asprinted\" (see errata)"},
    {NULL, "A scene without a Sampler has the first of these, one without an Integrator the second:"},
    {BIS_HELP_PAGE "A scene without a Sampler or an Integrator", NULL},
    {NULL, "After WorldBegin:"},
    {"LightSource", "see lights"},
    {"Material, MakeNamedMaterial, NamedMaterial", "see materials"},
    {"Texture", "see textures"},
    {"ObjectBegin, ObjectEnd, ObjectInstance", "shapes that are kept by a name, and shown by it"},
    {"AttributeBegin, AttributeEnd, TransformBegin, TransformEnd",
     "save and restore transformation and material; the transformation alone"},
    {"Shape", "one of"},
    {BIS_HELP_PAGE "Shape", NULL},
    {NULL, NULL},
};

static const bis_help_entry integrators[] = {
    {NULL, "Integrator \"NAME\" in a scene, --integrator NAME on the command line. Counts are per camera sample; "
           "defaults in parentheses, the first of several "
           "names is the default. \"sir\" with its defaults is the method of the thesis."},
    {of_integrators, NULL},
    {NULL, "A scene that names none has the second of these:"},
    {BIS_HELP_PAGE "A scene without a Sampler or an Integrator", NULL},
    {NULL, "The parameters:"},
    {of_parameters, NULL},
    {NULL, "The words mean: em, from the environment map; mix, half of the candidates from each; choose, one or the "
           "other by the material; product, by clusters of "
           "the map after the BRDF's value there. `bis trade SCENE` measures which is best for a scene."},
    {NULL, NULL},
};

static const bis_help_entry materials[] = {
    {NULL, "Colours are \"rgb Kd\" [r g b] or \"float Kd\" x; default and range in parentheses. Until a Material "
           "comes, all is \"diffuse\" 0.5."},
    {BIS_HELP_PAGE "Material", NULL},
    {NULL, "Every material takes what bends its normals:"},
    {BIS_HELP_PAGE "Bump and normal maps", NULL},
    {NULL, "MakeNamedMaterial \"ivory\" \"string type\" \"phong\" ... gives a name, NamedMaterial \"ivory\" uses it. "
           "Each value may be a texture, see textures. --approximate replaces pbrt's other materials by the nearest of "
           "these."},
    {NULL, NULL},
};

static const bis_help_entry textures[] = {
    {NULL, "Texture \"NAME\" \"float\" or \"spectrum\" \"KIND\" ..., before its first use; then \"texture Kd\" "
           "\"NAME\" in a material. Values must stay in the range that constants have. The kinds, and the parameters "
           "of the mapping:"},
    {BIS_HELP_PAGE "Texture", NULL},
    {NULL, NULL},
};

static const bis_help_entry lights[] = {
    {NULL, "LightSource \"infinite\", at most one: an environment map, or a constant from all around. In its own "
           "frame z is up, the map's top row; the transformation at its place, a rotation, turns it into the world."},
    {BIS_HELP_PAGE "LightSource", NULL},
    {NULL, "The mappings:"},
    {BIS_HELP_PAGE "How a map covers the sphere", NULL},
    {NULL, "`bis envmap MAP` shows what is in a map."},
    {NULL, NULL},
};

static const bis_help_entry output[] = {
    {NULL, "The ending of --outfile, or of the Film's filename, tells the format. A file is written beside its name, "
           "then renamed."},
    {".exr", "float32 R, G, B, A and layers; the header holds scene, integrator, parameters, seed, seconds and error"},
    {".pfm, .hdr", "R, G, B"},
    {".png", "sRGB of 8 bits, without a tone curve; --exposure EV multiplies by 2^EV"},
    {NULL, "Layers of an EXR (--layers, or layers of the Film); all, none or several:"},
    {"stderr, interval", "standard error of a pixel, and the half-width of its 95% interval"},
    {"samples, shadowrays, candidates", "what a pixel took"},
    {"unoccluded, visibility", "the light without shadows (eq. 4.5), and the share that arrives"},
    {"albedo, normal, depth", "of what is seen"},
    {NULL, "--stats F writes time, rays, memory, parameters and the estimated error as JSON. Standard output carries "
           "results alone, messages go to standard error as FILE:LINE:COLUMN: error: WHAT."},
    {NULL, "Exit status:"},
    {"0", "done"},
    {"1", "could not read or write, or out of memory; compare: beyond --tolerance; verify: a test failed"},
    {"2", "bad usage or bad scene; nothing was written"},
    {"130", "interrupted, after the complete passes have been written"},
    {NULL, NULL},
};

static const bis_help_entry budgets[] = {
    {NULL, "Passes take 1, 1, 2, then 4 camera samples of every pixel. Budgets are looked at between passes, --time in "
           "the first pass, too; the one that is used up first ends the render. Without any, the scene's pixelsamples "
           "count. --error says what it will cost as soon as the error is known."},
    {BIS_HELP_OPTION "spp", NULL},
    {BIS_HELP_OPTION "time", NULL},
    {BIS_HELP_OPTION "error", NULL},
    {NULL, "Ctrl-C ends a render soon: what is done is written, and the exit status is 130. The "
           "picture depends on the scene, the seed and the number "
           "of camera samples, never on the number of threads."},
    {BIS_HELP_OPTION "checkpoint", NULL},
    {BIS_HELP_OPTION "checkpoint-every", NULL},
    {BIS_HELP_OPTION "resume", NULL},
    {BIS_HELP_OPTION "part", NULL},
    {NULL, NULL},
};

static const bis_help_entry errata[] = {
    {NULL, "Some equations of the thesis are misprinted. bis computes what is right, but can follow them as printed, "
           "to see what that does to the picture. The list is printed by"},
    {"bis --as-printed list", NULL},
    {NULL, "with the section, the integrators concerned and what one sees. In a scene: Option \"string asprinted\" "
           "[\"E6\" \"E20\"]."},
    {NULL, NULL},
};

static const bis_help_entry examples[] = {
    {NULL, "The default picture; a good one after ten seconds, with figures as JSON; a part of it, until its relative "
           "error is below 5%:"},
    {"bis scene.txt", NULL},
    {"bis scene.txt --time 10 --outfile clean.exr --outfile clean.png --stats -", NULL},
    {"bis scene.txt --error .05 --cropwindow 0.4,0.6,0.3,0.6 --outfile crop.exr", NULL},
    {NULL, "A long render, in as many runs as it takes; the same line for each:"},
    {"bis scene.txt --error .01 --resume state.bis --outfile long.exr", NULL},
    {NULL, "Two methods with the same number of rays; how far apart are they, and where?"},
    {"bis scene.txt --integrator em --samples 4 --outfile em.exr", NULL},
    {"bis scene.txt --integrator sir --shadowrays 4 --outfile sir.exr", NULL},
    {"bis compare em.exr sir.exr --diff difference.png", NULL},
    {"bis convert sir.exr sir.png --exposure 1 --tone filmic", NULL},
    {NULL, "What is in a map, where samples go; what a scene requires:"},
    {"bis envmap data/maps/interior.hdr --out map.png", NULL},
    {"bis envmap data/maps/interior.hdr --to equalarea --out for-pbrt-v4.exr", NULL},
    {"bis --plan scene.txt", NULL},
    {NULL, "Everything about a pixel; what to use for this scene; is it right?"},
    {"bis pixel scene.txt 350 300", NULL},
    {"bis trade scene.txt", NULL},
    {"bis verify scene.txt", NULL},
    {NULL, NULL},
};

const bis_topic bis_topics[] = {
    {"scene", "the scene format in brief", scene},
    {"integrators", "the methods and their parameters", integrators},
    {"materials", "the materials and their parameters", materials},
    {"textures", "values that vary over a surface", textures},
    {"lights", "the environment map and its parameters", lights},
    {"output", "formats, layers, figures, exit statuses", output},
    {"budgets", "how long: samples, time, error", budgets},
    {"errata", "the thesis to the letter, to see why not", errata},
    {"examples", "command lines to begin with", examples},
    {NULL, NULL, NULL},
};

static void add_entry(bis_help_page *page, size_t *n, bis_help_entry e)
{
    assert(*n < BIS_HELP_ENTRIES);
    page->heading[*n] = NULL;
    page->entries[(*n)++] = e;
}

static void add_integrators(bis_help_page *page, size_t *n)
{
    for (const bis_integrator *const *i = bis_integrators; *i; i++)
        add_entry(page, n, (bis_help_entry){(*i)->name, bis_integrator_words(page->text[*n], *i)});
}

static void add_parameters(bis_help_page *page, size_t *n)
{
    for (const bis_parameter *p = bis_parameters; p->name; p++) {
        char words[BIS_PARAMETER_WORDS], *text = page->text[*n];
        if (!p->words) continue;
        bis_parameter_words(words, p->name);
        if (p->type == BIS_PARAMETER_CHOICE) snprintf(text, sizeof page->text[0], "%s; %s", p->words, words);
        else snprintf(text, sizeof page->text[0], "%s", words);
        add_entry(page, n, (bis_help_entry){p->name, text});
    }
}

static void add_rows(bis_help_page *page, size_t *n, const char *heading)
{
    const size_t before = *n;

    for (const bis_help_row *r = bis_help_rows; r->heading; r++) {
        if (strcmp(r->heading, heading) != 0) continue;
        add_entry(page, n, r->entry);
        page->heading[*n - 1] = r->heading;
    }
    assert(*n > before); /* the page has this heading */
    (void)before;
}

const bis_help_entry *bis_help_open(bis_help_page *page, const bis_topic *t)
{
    size_t n = 0;

    for (const bis_help_entry *e = t->entries; e->term || e->text; e++) {
        if (e->term == of_integrators) add_integrators(page, &n);
        else if (e->term == of_parameters) add_parameters(page, &n);
        else if (e->term && !e->text && strncmp(e->term, BIS_HELP_OPTION, strlen(BIS_HELP_OPTION)) == 0)
            add_entry(page, &n, bis_render_option(page->text[n], e->term + strlen(BIS_HELP_OPTION)));
        else if (e->term && strncmp(e->term, BIS_HELP_PAGE, strlen(BIS_HELP_PAGE)) == 0)
            add_rows(page, &n, e->term + strlen(BIS_HELP_PAGE));
        else add_entry(page, &n, *e);
    }
    page->entries[n] = (bis_help_entry){NULL, NULL};
    return page->entries;
}
