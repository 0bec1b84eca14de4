/* SPDX-License-Identifier: BSD-2-Clause */
/* help_topics: what a user wants to look up without a browser. The pages in docs/ explain; this reminds of names,
 * defaults and ranges.
 *
 * tests/cli/test_help.c reads docs/scene-format.md and the program's own lists: a name, parameter or layer that is
 * missing here fails there. */
#include "help.h"

#include <assert.h>

const char bis_help_of_integrators[] = "", bis_help_of_parameters[] = "";

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
    {NULL, "Anywhere:"},
    {"Identity, Translate, Scale, Rotate, LookAt, Transform, ConcatTransform",
     "act on the current transformation, from the right. The world is left-handed"},
    {"CoordinateSystem, CoordSysTransform", "remember the transformation by a name; go back to it"},
    {"Include \"file\"", "go on reading there"},
    {NULL, "Before WorldBegin:"},
    {"Camera", "\"perspective\" or \"orthographic\": fov (90), screenwindow, frameaspectratio; lensradius must be 0"},
    {"Film",
     "\"rgb\": xresolution (1280), yresolution (720), filename (bis.exr), cropwindow (0 1 0 1), scale (1), "
     "layers (see output)"},
    {"Sampler", "\"stratified\", \"sobol\", \"halton\", \"random\" or \"independent\": pixelsamples "
                "(16), seed (0), "
                "edgesamples (1; more on outlines), edgelight (1; their share of the light samples); stratified: "
                "xsamples, ysamples (4), jitter (true). A scene without a Sampler has \"sobol\" with edgesamples 8 and "
                "edgelight 0.25"},
    {"Integrator", "see integrators, also for a scene without one"},
    {"Accelerator", "\"embree\" (the default where it is built in) or \"grid\": density, cells per primitive (2; 8 "
                    "where triangles span many cells)"},
    {"Option", "\"bool disablepixeljitter\" (false); \"string asprinted\" (see errata)"},
    {NULL, "After WorldBegin:"},
    {"LightSource", "see lights"},
    {"Material, MakeNamedMaterial, NamedMaterial", "see materials"},
    {"Texture", "see textures"},
    {"Shape", "\"plymesh\" and \"objmesh\": filename, smooth (false); \"objmesh\": materials (false: without its "
              ".mtl); \"trianglemesh\": P, indices, N, uv; \"sphere\": radius (1), zmin, zmax, phimax; \"disk\": "
              "radius (1), height (0), innerradius (0), phimax"},
    {"Shape, as fine meshes",
     "\"cylinder\": radius, zmin (-1), zmax; \"cone\": radius, height; \"paraboloid\": radius, zmin (0), zmax; "
     "\"hyperboloid\": p1, p2; \"loopsubdiv\": levels (3), P, indices; \"bilinearmesh\": P, indices, N, uv; "
     "\"heightfield\": nu, nv, Pz; \"nurbs\": nu, uorder, uknots, u0, u1, the same of v, P or Pw"},
    {"ObjectBegin, ObjectEnd, ObjectInstance", "shapes that are kept by a name, and shown by it"},
    {"AttributeBegin, AttributeEnd, TransformBegin, TransformEnd",
     "save and restore transformation and material; the transformation alone"},
    {NULL, NULL},
};

static const bis_help_entry integrators[] = {
    {NULL, "Integrator \"NAME\" in a scene, --integrator NAME on the command line. Counts are per camera sample; "
           "defaults in parentheses, the first of several "
           "names is the default. \"sir\" with its defaults is the method of the thesis."},
    {bis_help_of_integrators, NULL},
    {"no Integrator: sir", "with proposal product, 64 candidates, 24 shadow rays, learn true: what a scene has that "
                           "names none"},
    {NULL, "The parameters:"},
    {bis_help_of_parameters, NULL},
    {NULL, "The words mean: em, from the environment map; mix, half of the candidates from each; choose, one or the "
           "other by the material; product, by clusters of "
           "the map after the BRDF's value there. `bis trade SCENE` measures which is best for a scene."},
    {NULL, NULL},
};

static const bis_help_entry materials[] = {
    {NULL, "Colours are \"rgb Kd\" [r g b] or \"float Kd\" x, in [0, 1]; defaults in parentheses. Until a Material "
           "comes, all is \"diffuse\" 0.5."},
    {"phong", "the thesis's energy-preserving model (eq. 3.14). Kd (0.5), Ks (0), exponent (50, >= 0)"},
    {"microfacet", "GGX facets over a diffuse base. Kd (0), Ks (0.9, the reflectance head on: a metal's colour, 0.04 "
                   "for plastic), roughness (0.5, in [0.01, 1]; the lobe's alpha is its square)"},
    {"diffuse, matte", "reflectance, or Kd (0.5)"},
    {"conductor, metal", "pbrt's: reflectance, or eta and k (copper); roughness (0; metal 0.01), or uroughness and "
                         "vroughness; remaproughness (true)"},
    {"coateddiffuse", "pbrt's: reflectance (0.5), eta (1.5), thickness (0.01), roughness (0)"},
    {"plastic, uber, substrate", "pbrt's: Kd, Ks (0.25; substrate 0.5), roughness (0.1); uber: eta or index (1.5), "
                                 "no Kr, Kt or opacity"},
    {"displacement, normalmap", "of every material: a texture of numbers, or an image of normals, that bends the "
                                "normal (bumpmap is pbrt-v3's)"},
    {NULL, "MakeNamedMaterial \"ivory\" \"string type\" \"phong\" ... gives a name, NamedMaterial \"ivory\" uses it. "
           "Each value may be a texture, see textures. --approximate replaces pbrt's other materials by the nearest of "
           "these."},
    {NULL, NULL},
};

static const bis_help_entry textures[] = {
    {NULL, "Texture \"NAME\" \"float\" or \"spectrum\" \"KIND\" ..., before its first use; then \"texture Kd\" "
           "\"NAME\" in a material. Values must stay in the range that constants have."},
    {"imagemap", "filename (.png, .jpg, .tga, .bmp, .exr, .hdr, .pfm), wrap (repeat, clamp or black), scale (1), "
                 "invert (false), encoding of a .png (sRGB, linear or \"gamma X\")"},
    {"constant", "value (1)"},
    {"scale", "tex times scale (1, 1), or tex1 times tex2"},
    {"mix", "from tex1 (0) to tex2 (1) by amount (0.5)"},
    {"checkerboard", "tex1 (1) and tex2 (0); dimension (2, or 3: in space)"},
    {"dots, bilerp, uv", "inside (1) and outside (0); v00, v01, v10, v11 (0 1 0 1); the coordinates as a colour"},
    {"fbm, wrinkled, marble, windy", "noise in the space of the current transformation: octaves (8), roughness (0.5); "
                                     "marble: scale (1), variation (0.2)"},
    {"uscale, vscale, udelta, vdelta", "of those in the plane: s = uscale u + udelta, t = vscale v + vdelta "
                                       "(1 1 0 0). v = 0 is the bottom of an image"},
    {"mapping", "uv; or planar (v1, v2), spherical, cylindrical: by the point, in the space of the current "
                "transformation"},
    {NULL, NULL},
};

static const bis_help_entry lights[] = {
    {NULL, "LightSource \"infinite\", at most one: an environment map, or a constant from all around. In its own "
           "frame z is up, the map's top row; the transformation at its place, a rotation, turns it into the world."},
    {"filename", "the map: .hdr, .exr or .pfm, also .gz; none: a constant (mapname is pbrt-v3's)"},
    {"L, scale", "radiance of a constant (1 1 1); what a map is multiplied by (1)"},
    {"mapping", "latlong, angular: a light probe, equalarea: pbrt-v4's squares (and what a square filename is taken "
                "for), mirrorball, verticalcross, horizontalcross, cubestrip"},
    {"width", "of the lat-long map that others are resampled to (twice a square, four faces of a cube)"},
    {"areaexponent", "b of thesis 3.4 (0.15, in [0, 10]): how far small bright sources give up samples to large ones; "
                     "0: not at all. Never changes the mean"},
    {"levels", "of intensity, thesis 3.4 (8, in [1, 254])"},
    {"sampler", "alias, or cdf (the default with the samplers sobol and halton). Never changes the mean"},
    {"visible", "false: camera rays that hit nothing see black (true)"},
    {"filter", "bilinear: camera rays see the map interpolated (point: its pixels). Surfaces receive the same light"},
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
    {NULL, "Passes take 1, 1, 2, then 4 camera samples of every pixel. Budgets are looked at between passes; the one "
           "that is used up first ends the render. Without any, the scene's pixelsamples count."},
    {"--spp N", "N camera samples of every pixel"},
    {"--time SECONDS", "of rendering alone, as in 10, 10s, 2min, 1.5h; ends within a pass of it, the first one too"},
    {"--error E", "until an upper 95% bound of the relative RMSE is at most E, as in 0.05 or 5%; says what it "
                  "will cost as soon as the error is known"},
    {NULL, "Ctrl-C ends a render soon: what is done is written, and the exit status is 130. The "
           "picture depends on the scene, the seed and the number "
           "of camera samples, never on the number of threads."},
    {"--checkpoint F", "keeps the state of the render in F: each minute (--checkpoint-every), at the end, at Ctrl-C"},
    {"--resume F", "goes on from F, or starts afresh where there is none; the picture has the bits of one render. "
                   "--spp, --time and --error count from the very start"},
    {"--part K/N", "renders the K-th of N shares of the tiles into --outfile F.bispart; `bis merge` makes the picture "
                   "of the N files, which may come from N machines"},
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

const bis_help_entry *bis_help_open(bis_help_page *page, const bis_topic *t)
{
    size_t n = 0;

    for (const bis_help_entry *e = t->entries; e->term || e->text; e++) {
        if (e->term == bis_help_of_integrators) add_integrators(page, &n);
        else if (e->term == bis_help_of_parameters) add_parameters(page, &n);
        else add_entry(page, &n, *e);
    }
    page->entries[n] = (bis_help_entry){NULL, NULL};
    return page->entries;
}
