/* SPDX-License-Identifier: BSD-2-Clause */
/* cmd_verify: `bis verify SCENE`, `bis verify MAP`: the checks of verify.h on the user's own files, as a table or as
 * JSON. `bis verify --bits`: are the bits of this build those of every build? */
#include "tools/describe.h"
#include "tools/verify/verify.h"

#include "bis/base/mem.h"
#include "bis/files/image_file.h"
#include "bis/scene/light_load.h"

#include "cli.h"
#include "tools/json.h"

#include <string.h>
#include <strings.h>
#include <unistd.h>

#define USAGE "verify [options] SCENE | MAP | --bits"

typedef struct verify_options {
    const char *mapping;
    uint64_t seed;
    bool json, approximate, bits;
} verify_options;

/* ---- the report ---- */

static const char *verdict_of(const bis_verify_test *t)
{
    static const char *const words[] = {
        [BIS_VERDICT_PASSED] = "passed", [BIS_VERDICT_FAILED] = "FAILED", [BIS_VERDICT_SKIPPED] = "skipped"};
    return words[t->verdict];
}

/* A number in ten columns, "-" for none. */
static void print_number(double x)
{
    if (isnan(x)) printf(" %10s", "-");
    else printf(" %10.3g", x);
}

static void print_table(const bis_verify *v)
{
    const char *group = "";
    for (size_t i = 0; i < v->n; i++) {
        const bis_verify_test *t = &v->tests[i];
        if (strcmp(group, t->group) != 0)
            printf("%s%-46s  statistic          p  threshold  verdict\n", i ? "\n" : "", t->group);
        group = t->group;
        printf("  %-44s", t->name);
        print_number(t->statistic);
        print_number(t->p);
        print_number(t->threshold);
        printf("  %s%s%s\n", verdict_of(t), *t->note ? ": " : "", t->note);
    }
    printf("\n%zu tests, %zu failed, %zu skipped. %zu of them are statistical: each fails below p = %.3g, so that all "
           "together\n"
           "raise a false alarm at most once in %.0f runs (Sidak). The others fail above their threshold.\n",
           v->n, v->n_failed, v->n_skipped, v->n_statistical, v->threshold, 1 / BIS_VERIFY_ALPHA);
    printf("seed %llu\n%s\n", (unsigned long long)v->seed, v->n_failed ? "FAILED" : "passed");
}

static void print_json(const bis_verify *v, const char *path)
{
    bis_json j = {.out = stdout};
    bis_json_open(&j, NULL, '{');
    bis_json_text(&j, "file", path);
    bis_json_count(&j, "seed", v->seed);
    BIS_JSON_NUMBERS(&j, {"significance", BIS_VERIFY_ALPHA}, {"statistical", (double)v->n_statistical},
                     {"corrected", v->threshold}, {"failed", (double)v->n_failed}, {"skipped", (double)v->n_skipped});
    bis_json_bool(&j, "passed", v->n_failed == 0);
    bis_json_open(&j, "tests", '[');
    for (size_t i = 0; i < v->n; i++) {
        const bis_verify_test *t = &v->tests[i];
        bis_json_open(&j, NULL, '{');
        bis_json_text(&j, "group", t->group);
        bis_json_text(&j, "name", t->name);
        bis_json_text(&j, "verdict", t->verdict == BIS_VERDICT_FAILED ? "failed" : verdict_of(t));
        BIS_JSON_NUMBERS(&j, {"statistic", t->statistic}, {"dof", t->dof > 0 ? t->dof : (double)NAN}, {"p", t->p},
                         {"threshold", t->threshold});
        bis_json_text(&j, "note", t->note);
        bis_json_close(&j);
    }
    bis_json_close(&j);
    bis_json_close(&j);
}

static void print_bits(const bis_bits rows[BIS_N_BITS], int n_different)
{
    printf("%-30s %-16s  of every build\n", "", "this build");
    for (int i = 0; i < BIS_N_BITS; i++) {
        const bis_bits *r = &rows[i];
        printf("%-30s %016llx", r->name, (unsigned long long)r->hash);
        if (r->hash == r->expected) printf("  the same\n");
        else
            printf("  %016llx DIFFERS: sum %.17g, off by %.2g of it\n", (unsigned long long)r->expected, r->sum,
                   r->departs);
    }
    if (!n_different) printf("\nall %d are the same\n", BIS_N_BITS);
    else
        printf("\n%d of %d differ. Each row rests on those above it: look at the first.\n"
               "docs/trust.md, \"The same bits\", says what is promised.\n",
               n_different, BIS_N_BITS);
}

/* ---- what is verified ---- */

static bool is_map(const char *path)
{
    static const char *const endings[] = {".hdr", ".exr", ".pfm"};
    const size_t n = strlen(path);
    for (int i = 0; i < 3; i++)
        if (n > 4 && strcasecmp(path + n - 4, endings[i]) == 0) return true;
    return false;
}

static int verify_map(bis_verify *v, const verify_options *o, const char *map, bis_diag *diag)
{
    bis_light_desc desc = bis_light_desc_default();
    bis_light *light;
    int exit_status = bis_cli_load_map(&light, &desc, map, o->mapping, 0, diag);

    if (!exit_status)
        exit_status = bis_cli_exit_status(
            bis_verify_map(v, bis_light_envmap(light), desc.area_exponent, desc.levels, diag));
    bis_light_free(light);
    return exit_status;
}

static int verify_scene(bis_verify *v, const verify_options *o, const char *path, bis_diag *diag)
{
    bis_scene_desc *desc = NULL;
    bis_scene *scene = NULL;

    if (o->mapping) bis_warn(diag, bis_cli_loc, "--mapping has no effect on a scene: its LightSource says it");
    bis_verify_begin(v, "reading the scene");
    bis_status status = bis_cli_parse_scene(&desc, path, o->approximate ? BIS_PARSE_APPROXIMATE : 0, diag);
    if (status) return bis_cli_exit_status(status);
    desc->light_needs = BIS_VERIFY_LIGHT_NEEDS;
    status = bis_scene_build(&scene, desc, diag);
    if (!status) status = bis_verify_scene(v, scene, desc, &desc->view.settings, diag);
    bis_scene_free(scene);
    bis_scene_desc_free(desc);
    return bis_cli_exit_status(status);
}

/* ---- the command ---- */

static void print_progress(const char *what, void *user)
{
    (void)user;
    fprintf(stderr, "\r%s ...\033[K", what);
    fflush(stderr);
}

static int verify_bits(bis_diag *diag)
{
    bis_bits rows[BIS_N_BITS];
    int n_different = 0;
    const bis_status status = bis_verify_bits(rows, diag);

    if (status) return bis_cli_exit_status(status);
    for (int i = 0; i < BIS_N_BITS; i++) n_different += rows[i].hash != rows[i].expected;
    print_bits(rows, n_different);
    return n_different ? BIS_EXIT_FAILED : BIS_EXIT_DONE;
}

static int verify(void *options, const char *const *operands, bis_diag *diag)
{
    const verify_options *o = options;
    const char *path = operands[0];

    if (o->bits == (path != NULL))
        return bis_cli_exit_status(bis_error(diag, BIS_INPUT, bis_cli_loc, "%s; usage: bis %s",
                                             path ? "--bits takes no file" : "too few operands: 0 given", USAGE));
    if (o->bits) return verify_bits(diag);
    const bool show = isatty(STDERR_FILENO);
    bis_verify v = {.seed = o->seed, .progress = show ? print_progress : NULL};
    int exit_status = is_map(path) ? verify_map(&v, o, path, diag) : verify_scene(&v, o, path, diag);

    if (show) fputs("\r\033[K", stderr);
    fflush(stderr);
    if (exit_status == BIS_EXIT_DONE) exit_status = bis_cli_exit_status(bis_verify_judge(&v, diag));
    if (exit_status == BIS_EXIT_DONE) { /* a report that lacks a test would say that all passed */
        if (o->json) print_json(&v, path);
        else print_table(&v);
        if (v.n_failed) exit_status = BIS_EXIT_FAILED;
    }
    bis_verify_clear(&v);
    return exit_status;
}

int bis_cmd_verify(int argc, char **argv)
{
    verify_options o = {.seed = 1};
    const bis_option options[] = {
        {.help = "what to verify"},
        {.name = "mapping", .argument = "M",
         .help = "of a map: latlong (the default), angular, equalarea, mirrorball, verticalcross, horizontalcross or "
                 "cubestrip; a square map must say which",
         .kind = BIS_OPTION_NAME, .value = &o.mapping, .names = bis_mapping_names},
        {.name = "approximate",
         .help = "what of pbrt bis does not model is replaced by the nearest that it does, and listed",
         .kind = BIS_OPTION_FLAG, .value = &o.approximate},
        {.name = "seed", .argument = "N", .help = "of the random numbers (1)", .kind = BIS_OPTION_COUNT,
         .value = &o.seed, .hi = BIS_SEED_MAX},
        {.name = "bits",
         .help = "no file: are twelve small tables and pictures, bit for bit, those of every build?",
         .kind = BIS_OPTION_FLAG, .value = &o.bits},
        {.help = "what to write"},
        {.name = "json", .help = "print JSON instead of a table", .kind = BIS_OPTION_FLAG, .value = &o.json},
    };
    const bis_command command = {
        .name = "verify",
        .usage = USAGE,
        .summary = "are samplers, materials and integrators right for this scene, or this map (.hdr, .exr, .pfm)?",
        .options = options, .n_options = sizeof options / sizeof *options,
        .min_operands = 0, .max_operands = 1,
        .notes = BIS_CLI_SCENE_NOTE
                 "\n"
                 "A scene's own integrator is tested by what `bis SCENE` renders, all others at\n"
                 "single points.\n"
                 "\n"
                 "Each test is a number below a limit that rounding explains, or a statistic with\n"
                 "its p-value. All together reject what is right once in 100 runs: try another\n"
                 "--seed before you believe a single failure just below its threshold.\n"
                 "\n"
                 "Exit status: 0 all passed; 1 a test failed, or a file could not be read, or out\n"
                 "of memory; 2 bad usage or bad scene.\n",
    };
    return bis_cli_run(&command, argc, argv, verify, &o);
}
