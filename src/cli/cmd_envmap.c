/* SPDX-License-Identifier: BSD-2-Clause */
/* cmd_envmap: `bis envmap MAP`: what is in an environment map (survey.h), as text, JSON or a page, and its levels,
 * regions and importance as pictures (thesis figures 3.5 and 3.6). */
#include "base/text.h"
#include "bis/base/file.h"
#include "bis/scene/light_load.h"
#include "bis/base/mem.h"
#include "bis/files/image_file.h"

#include "cli.h"
#include "out/json.h"
#include "out/page.h"
#include "tools/pixel/pixel.h"
#include "tools/survey/survey.h"

#include <stdlib.h>
#include <string.h>

typedef struct envmap_options {
    const char *out, *outdir, *html, *mapping, *to;
    uint64_t levels, width, samples;
    double area_exponent;
    bool json;
} envmap_options;

/* ---- the report ---- */

static bool has_direction(vec3 w) { return w.x != 0 || w.y != 0 || w.z != 0; }

static vec3 pixel_direction(const bis_envmap *em, size_t pixel)
{
    return bis_envmap_direction(em, (int)(pixel % (size_t)em->width), (int)(pixel / (size_t)em->width), 0.5, 0.5);
}

static void print_levels(FILE *out, const bis_survey *s)
{
    fprintf(out, "\nlevel       from         to    pixels    sphere     power   regions\n");
    for (int k = 0; k < s->n_levels; k++) {
        const bis_survey_level *l = &s->level[k];
        fprintf(out, "%5d %10.4g %10.4g %9zu %8.4f%% %8.4f%% %9u\n", k, l->least, l->most, l->pixels, 100 * l->sphere,
               100 * l->power, l->regions);
    }
}

static void print_largest(FILE *out, const bis_survey *s)
{
    fprintf(out, "\nregions with most power\n  rank level     power   solid angle  theta    phi   direction\n");
    for (int k = 0; k < s->n_largest; k++) {
        const bis_survey_region *r = &s->largest[k];
        fprintf(out, "%6d %5d %8.4f%% %10.4g sr", k + 1, r->level, 100 * r->power, r->solid_angle);
        const bis_pixel_direction d = bis_pixel_angles(r->direction);
        if (has_direction(r->direction))
            fprintf(out, " %6.1f %6.1f   (%.3f %.3f %.3f)\n", d.theta, d.phi, (double)r->direction.x,
                   (double)r->direction.y, (double)r->direction.z);
        else fprintf(out, "  on all sides\n");
    }
}

/* In percent. */
static double change(double before, double after) { return before > 0 ? 100 * (after / before - 1) : 0; }

static void print_text(FILE *out, const char *path, const bis_survey *s, const bis_envmap *em, size_t bytes)
{
    const char *from = em->resampled_from;
    char black[BIS_PERCENT];
    fprintf(out, "map         %s, %d x %d, %s%s\n", path, em->width, em->height, from ? "resampled from " : "",
           from ? from : bis_mapping_names[BIS_MAPPING_LATLONG]);
    if (from)
        fprintf(out, "power       %.6g before, %.6g after resampling (%+.3f%%)\n", em->power_before, em->power_after,
               change(em->power_before, em->power_after));
    fprintf(out,
            "intensity   min %.4g, median %.4g, mean %.4g, max %.4g (r+g+b; min: of the pixels that are not black)\n",
           s->least, s->median, s->mean, s->most);
    fprintf(out, "mean        %.4g %.4g %.4g (red, green, blue)\n", s->mean_rgb[0], s->mean_rgb[1], s->mean_rgb[2]);
    fprintf(out, "power       %.6g (r+g+b integrated over the sphere)\n", s->power);
    fprintf(out, "bad values  %zu NaN, %zu infinite, %zu negative, set to 0\n", em->defects.n_nan,
            em->defects.n_infinite, em->defects.n_negative);
    fprintf(out, "black       %s of the sphere\n", bis_percent(black, s->black));
    if (s->power > 0) {
        const vec3 w = pixel_direction(em, s->peak);
        const bis_pixel_direction d = bis_pixel_angles(w);
        fprintf(out, "contrast    %.4g : 1\n", s->most / s->least);
        fprintf(out, "brightest   0.1%% of the sphere holds %.2f%% of the power\n", 100 * s->brightest);
        fprintf(out, "peak        pixel (%zu, %zu), theta %.1f, phi %.1f degrees, direction (%.3f %.3f %.3f)\n",
               s->peak % (size_t)em->width, s->peak / (size_t)em->width, d.theta, d.phi, (double)w.x, (double)w.y,
               (double)w.z);
    }
    fprintf(out, "regions     %u in %d level%s\n", s->n_regions, s->n_levels, s->n_levels == 1 ? "" : "s");
    fprintf(out, "table       %.1f bytes a pixel beyond the map\n", (double)bytes / ((double)em->width * em->height));
    if (s->power == 0) return;
    print_levels(out, s);
    print_largest(out, s);
}

static void json_direction(bis_json *j, const char *key, vec3 w)
{
    const bis_pixel_direction d = bis_pixel_angles(w);

    if (!has_direction(w)) bis_json_null(j, key);
    else
        BIS_JSON_OBJECT(j, key, {"theta_deg", d.theta}, {"phi_deg", d.phi}, {"x", (double)w.x}, {"y", (double)w.y},
                        {"z", (double)w.z});
}

static void json_peak(bis_json *j, const bis_survey *s, const bis_envmap *em)
{
    if (s->power == 0) {
        bis_json_null(j, "peak");
        return;
    }
    bis_json_open(j, "peak", '{');
    BIS_JSON_NUMBERS(j, {"x", (double)(s->peak % (size_t)em->width)}, {"y", (double)(s->peak / (size_t)em->width)});
    json_direction(j, "direction", pixel_direction(em, s->peak));
    bis_json_close(j);
}

static void json_levels(bis_json *j, const bis_survey *s)
{
    bis_json_open(j, "levels", '[');
    for (int k = 0; k < s->n_levels; k++) {
        const bis_survey_level *l = &s->level[k];
        BIS_JSON_OBJECT(j, NULL, {"from", l->least}, {"to", l->most}, {"pixels", (double)l->pixels},
                        {"sphere_share", l->sphere}, {"power_share", l->power}, {"regions", l->regions});
    }
    bis_json_close(j);
}

static void json_largest(bis_json *j, const bis_survey *s)
{
    bis_json_open(j, "largest_regions", '[');
    for (int k = 0; k < s->n_largest; k++) {
        const bis_survey_region *r = &s->largest[k];
        bis_json_open(j, NULL, '{');
        BIS_JSON_NUMBERS(j, {"level", r->level}, {"power_share", r->power}, {"solid_angle", r->solid_angle});
        json_direction(j, "direction", r->direction);
        bis_json_close(j);
    }
    bis_json_close(j);
}

static void put_json(bis_json *j, const char *path, const bis_survey *s, const bis_envmap *em, size_t bytes)
{
    const char *from = em->resampled_from;
    const bis_envmap_defects *bad = &em->defects;

    bis_json_text(j, "map", path);
    BIS_JSON_NUMBERS(j, {"width", em->width}, {"height", em->height});
    bis_json_text(j, "mapping", from ? from : bis_mapping_names[BIS_MAPPING_LATLONG]);
    BIS_JSON_NUMBERS(j, {"power_before", from ? em->power_before : (double)NAN},
                     {"power_after", from ? em->power_after : (double)NAN}, {"min", s->least},
                     {"median", s->median}, {"mean", s->mean}, {"max", s->most});
    bis_json_triple(j, "mean_rgb", s->mean_rgb[0], s->mean_rgb[1], s->mean_rgb[2]);
    BIS_JSON_NUMBERS(j, {"contrast", s->power > 0 ? s->most / s->least : (double)NAN}, {"power", s->power},
                     {"black_share", s->black}, {"brightest_0.1_percent", s->brightest});
    json_peak(j, s, em);
    BIS_JSON_OBJECT(j, "bad_values", {"nan", (double)bad->n_nan}, {"infinite", (double)bad->n_infinite},
                    {"negative", (double)bad->n_negative}, {"sphere_share", bad->solid_angle / (4 * PI)});
    BIS_JSON_NUMBERS(j, {"regions", s->n_regions}, {"table_bytes", (double)bytes});
    json_levels(j, s);
    json_largest(j, s);
}

/* ---- the page ---- */

static bis_status write_page(const envmap_options *o, const char *path, const bis_survey *s, const bis_light *light,
                             const bis_regions *regions, bis_diag *diag)
{
    const bis_envmap *em = bis_light_envmap(light);
    const bis_importance *im = bis_light_importance(light);
    static const char what[] = "the page of a map";
    bis_page page;
    bis_status status = bis_page_begin(&page, what, diag);
    bis_json j = {.out = page.json};

    if (status) return status;
    bis_json_open(&j, NULL, '{');
    put_json(&j, path, s, em, bis_importance_bytes(im));
    status = bis_survey_put_page(&j, s, light, regions, (int)o->samples, diag);
    bis_json_close(&j);
    print_text(page.text, path, s, em, bis_importance_bytes(im));
    return bis_page_end(&page, status, o->html, bis_survey_page, what, diag);
}

/* ---- the pictures ---- */

/* "dir/NAME.png" and "levels" make "dir/NAME-levels.png". Returns path. */
static const char *picture_path(char path[4096], const char *out, const char *what)
{
    const char *slash = strrchr(out, '/'), *dot = strrchr(slash ? slash : out, '.');
    snprintf(path, 4096, "%.*s-%s%s", (int)(dot - out), out, what, dot);
    return path;
}

/* The map itself takes the exposure of its own log-average. */
static bis_status write_pictures(const envmap_options *o, const char *out, const bis_light *light,
                                 const bis_regions *regions, bis_diag *diag)
{
    const bis_envmap *em = bis_light_envmap(light);
    const bis_image map = {em->width, em->height, em->pixels, NULL};
    char path[4096];
    bis_image image;
    bis_status status = bis_image_save(&map, picture_path(path, out, "map"), diag);
    for (int k = 0; k < 3 && !status; k++) {
        static const char *const what[] = {"levels", "regions", "importance"};
        status = k == 0 ? bis_survey_levels_picture(&image, em, (int)o->levels, diag)
                 : k == 1
                     ? bis_survey_regions_picture(&image, em, regions, diag)
                     : bis_survey_importance_picture(&image, em, bis_light_importance(light), (int)o->samples, diag);
        if (status) break;
        status = bis_image_save_colours(&image, picture_path(path, out, what[k]), diag);
        bis_image_clear(&image);
    }
    return status;
}

/* Stores where pictures go: --out itself, or --outdir with the map's name and .png. Sets *any if at least one picture
 * was asked for. */
static bis_status find_out(char out[4096], const envmap_options *o, const char *map, bool *any, bis_diag *diag)
{
    const char *slash = strrchr(map, '/'), *name = slash ? slash + 1 : map, *dot = strrchr(name, '.');
    const int stem = dot && dot > name ? (int)(dot - name) : (int)strlen(name);
    char picture[4096];

    *any = o->out || o->outdir;
    bis_status status = o->html ? bis_cli_check_writable(o->html, diag) : BIS_OK;
    if (!status && o->html) status = bis_cli_check_distinct(&map, 1, &o->html, 1, diag);
    if (status || !*any) return status;
    if (o->out && o->outdir) return bis_error(diag, BIS_INPUT, bis_cli_loc, "--out and --outdir exclude each other");
    const int length =
        o->out ? snprintf(out, 4096, "%s", o->out) : snprintf(out, 4096, "%s/%.*s.png", o->outdir, stem, name);
    if (length > 4000) return bis_error(diag, BIS_INPUT, bis_cli_loc, "--out: the name is longer than 4000 bytes");
    if (!bis_image_can_write(out)) {
        return bis_error(diag, BIS_INPUT, bis_cli_loc, "--out \"%s\": the ending must be .exr, .pfm, .hdr or .png",
                         out);
    }
    for (int i = 0; i < 4 && !status; i++) {
        static const char *const pictures[] = {"map", "levels", "regions", "importance"};
        const char *const path = picture_path(picture, out, pictures[i]);
        status = bis_cli_check_writable(path, diag);
        if (!status) status = bis_cli_check_distinct(&map, 1, &path, 1, diag);
    }
    return status;
}

/* ---- the command ---- */

static bis_status survey(const envmap_options *o, const char *path, const char *out, const bis_light *light,
                         bis_diag *diag)
{
    const bis_envmap *em = bis_light_envmap(light);
    bis_survey s;
    bis_regions regions;
    bis_status status = bis_regions_init(&regions, em, (int)o->levels, diag);
    if (status) return status;
    status = bis_survey_init(&s, em, &regions, (int)o->levels, diag);
    if (!status && out) status = write_pictures(o, out, light, &regions, diag);
    if (!status && o->html) status = write_page(o, path, &s, light, &regions, diag);
    bis_regions_clear(&regions);
    if (status) return status;
    const size_t bytes = bis_importance_bytes(bis_light_importance(light));
    if (!o->json) {
        print_text(stdout, path, &s, em, bytes);
        return BIS_OK;
    }
    bis_json j = {.out = stdout};
    bis_json_open(&j, NULL, '{');
    put_json(&j, path, &s, em, bytes);
    bis_json_close(&j);
    return BIS_OK;
}

/* ---- --to ---- */

static bis_status check_conversion(const envmap_options *o, const char *map, bis_diag *diag)
{
    if (!o->out || o->outdir || o->json || o->html)
        return bis_error(diag, BIS_INPUT, bis_cli_loc,
                         "--to %s writes one map: name it by --out FILE, without --outdir, --html and --json", o->to);
    if (!bis_image_can_write(o->out))
        return bis_error(diag, BIS_INPUT, bis_cli_loc, "--out \"%s\": the ending must be .exr, .pfm, .hdr or .png",
                         o->out);
    bis_status status = bis_cli_check_writable(o->out, diag);
    if (!status) status = bis_cli_check_distinct(&map, 1, &o->out, 1, diag);
    return status;
}

/* The map's file in another mapping. What it was before it was read is lat-long or resampled to it. */
static bis_status convert(const envmap_options *o, const bis_light *light, bis_diag *diag)
{
    const bis_envmap *em = bis_light_envmap(light);
    const bis_attribute mapping = {.name = "bis:mapping", .text = o->to};
    bis_channel channels[4];
    bis_image image;
    double power[2];

    bis_status status =
        bis_envmap_to_mapping(&image, em, bis_mapping_find(o->to), (int)o->width, power, diag);
    if (status) return status;
    bis_picture picture = bis_image_picture(&image, channels);
    picture.attributes = &mapping;
    picture.n_attributes = 1;
    status = bis_image_write(o->out, &picture, diag);
    if (em->resampled_from) power[0] = em->power_before;
    if (!status)
        printf("wrote       %s, %d x %d, %s\npower       %.6g before, %.6g after resampling (%+.3f%%)\n", o->out,
               image.width, image.height, o->to, power[0], power[1], change(power[0], power[1]));
    bis_image_clear(&image);
    return status;
}

static int envmap(void *options, const char *const *operands, bis_diag *diag)
{
    const envmap_options *o = options;
    bis_light_desc desc = bis_light_desc_default();
    bis_light *light;
    char out[4096];
    bool any = false;

    const bis_status status =
        o->to ? check_conversion(o, operands[0], diag) : find_out(out, o, operands[0], &any, diag);
    if (status) return bis_cli_exit_status(status);
    if (!o->to) desc.width = (int)o->width;
    desc.area_exponent = o->area_exponent;
    desc.levels = (int)o->levels;
    int exit_status = bis_cli_load_map(&light, &desc, operands[0], o->mapping, o->to ? 0 : BIS_NEED_TABLE, diag);
    if (!exit_status)
        exit_status = bis_cli_exit_status(o->to ? convert(o, light, diag)
                                                : survey(o, operands[0], any ? out : NULL, light, diag));
    bis_light_free(light);
    return exit_status;
}

int bis_cmd_envmap(int argc, char **argv)
{
    envmap_options o = {.levels = BIS_LEVELS, .samples = 300, .area_exponent = BIS_AREA_EXPONENT};
    const bis_option options[] = {
        {.help = "what to read"},
        {.name = "mapping", .argument = "M",
         .help = "latlong (the default), angular (a light probe), equalarea (pbrt-v4's), mirrorball, verticalcross, "
                 "horizontalcross or cubestrip; a square map must say which",
         .kind = BIS_OPTION_NAME, .value = &o.mapping, .names = bis_mapping_names},
        {.name = "width", .argument = "N",
         .help = "of the lat-long map that another one is resampled to (default: twice a square, four faces of a "
                 "cube); with --to, of what is written (default: all detail)",
         .kind = BIS_OPTION_COUNT, .value = &o.width, .lo = 1, .hi = 2 * BIS_IMAGE_MAX_SIDE},
        {.name = "levels", .argument = "N", .help = "levels of intensity (8)", .kind = BIS_OPTION_COUNT,
         .value = &o.levels, .lo = 1, .hi = BIS_LEVELS_MAX},
        {.name = "areaexponent", .argument = "B",
         .help = "importance goes with min(0.01 sr, a region's solid angle) to the power of B (0.15)",
         .kind = BIS_OPTION_REAL, .value = &o.area_exponent, .lo = 0, .hi = BIS_AREA_EXPONENT_MAX},
        {.help = "what to write"},
        {.name = "to", .argument = "M",
         .help = "no report, but the map itself in mapping M, to the file of --out; energy is kept, and printed",
         .kind = BIS_OPTION_NAME, .value = &o.to, .names = bis_mapping_names},
        {.name = "json", .help = "print JSON instead of text", .kind = BIS_OPTION_FLAG, .value = &o.json},
        {.name = "html", .argument = "F",
         .help = "write a page to explore the map, in one file that needs nothing else",
         .kind = BIS_OPTION_TEXT, .value = &o.html},
        {.name = "out", .argument = "F",
         .help = "write pictures: NAME.png makes NAME-map.png, NAME-levels.png, NAME-regions.png and "
                 "NAME-importance.png; also .exr, .pfm, .hdr", .kind = BIS_OPTION_TEXT, .value = &o.out},
        {.name = "outdir", .argument = "D", .help = "the same into folder D, by the map's own name, as PNG",
         .kind = BIS_OPTION_TEXT, .value = &o.outdir},
        {.name = "samples", .argument = "N", .help = "directions drawn as dots on the importance (300)",
         .kind = BIS_OPTION_COUNT, .value = &o.samples, .hi = 1000000},
    };
    const bis_command command = {
        .name = "envmap",
        .usage = "envmap [options] MAP",
        .summary = "what is in a map; levels, regions, importance as pictures",
        .options = options, .n_options = sizeof options / sizeof *options,
        .min_operands = 1, .max_operands = 1,
        .notes = "Directions are in the map's own frame: z is up, towards row 0; theta is the\n"
                 "angle from it, phi runs with the columns. Levels are equal steps of the\n"
                 "logarithm of r+g+b, regions are connected pixels of one level, a light\n"
                 "source each. On the pictures brighter is more; the importance is the\n"
                 "density by which directions are drawn, on a logarithmic scale.\n",
    };
    return bis_cli_run(&command, argc, argv, envmap, &o);
}
