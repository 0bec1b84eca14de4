/* SPDX-License-Identifier: BSD-2-Clause */
/* settings: the table of parameters says of every integrator what a scene may say, and nothing twice. */
#include "bis/scene/scene.h"
#include "tools/describe.h"

#include "claim.h"
#include "file_help.h"
#include "further.h"
#include "program.h"

#include <math.h>
#include <string.h>

#define SCENE "build/test_settings.txt"

static bool is_in_range(const bis_parameter *p, double v)
{
    if (p->type == BIS_PARAMETER_CHOICE) return p->choices >> (unsigned)v & 1;
    return v >= p->lo && v <= p->hi;
}

/* Some value of the row that is not v. */
static double another(const bis_parameter *p, double v)
{
    if (p->type == BIS_PARAMETER_COUNT) return v + 1;
    if (p->type == BIS_PARAMETER_FRACTION) return (p->lo + 3 * p->hi) / 4;
    for (unsigned k = 0;; k++)
        if (k != v && is_in_range(p, k)) return k;
}

/* Each field is changed alone, through the table; a scene's line of these settings is parsed, and is the same settings.
 * The twin: the default settings are not the same. */
static void every_parameter_is_told_and_read_back(void **state)
{
    int n = 0;

    for (const bis_integrator *const *i = bis_integrators; *i; i++) {
        const bis_settings usual = bis_settings_default(*i);
        for (const bis_parameter *p = NULL; (p = bis_parameter_next(*i, p)) != NULL; n += !is_further(*i)) {
            bis_settings s = usual;
            bis_scene_desc *d;
            char line[BIS_MAX_LINE], scene[BIS_MAX_LINE + 32];
            const double v = another(p, bis_parameter_get(p, &s));
            bis_parameter_set(p, &s, v);
            assert_true(bis_parameter_get(p, &s) == v);
            for (int all = 0; all < 2; all++) {
                snprintf(scene, sizeof scene, "%s\nWorldBegin\n", bis_describe_line(line, &s, all));
                program_write_file(SCENE, scene);
                if (bis_scene_parse(&d, SCENE, NULL)) fail_msg("not read: %s", line);
                if (!bis_settings_equal(&d->view.settings, &s)) fail_msg("read as something else: %s", line);
                assert_false(bis_settings_equal(&d->view.settings, &usual));
                bis_scene_desc_free(d);
            }
        }
    }
    assert_int_equal(n, 21); /* the pairs of integrator and parameter in docs/scene-format.md */
}

/* The page: `integer NAME` (DEFAULT), `bool NAME` (DEFAULT), `string NAME` `"DEFAULT"`, in the integrator's row or in
 * one below it that has no name. */
static void defaults_are_those_of_the_page(void **state)
{
    static char page[1 << 17];
    read_text(page, sizeof page, "docs/scene-format.md");
    for (const bis_integrator *const *i = bis_integrators; *i; i++) {
        char start[64], told[128], buf[32];
        snprintf(start, sizeof start, "\n| `\"%s\"`", (*i)->name);
        char *row = strstr(strstr(page, "\n### Integrator"), start);
        assert_non_null(row);
        char *end = strchr(row + 1, '\n');
        while (strncmp(end, "\n| |", 4) == 0) end = strchr(end + 1, '\n');
        *end = '\0';
        for (const bis_parameter *p = NULL; (p = bis_parameter_next(*i, p)) != NULL;) {
            const char *usual = bis_parameter_text(buf, p, p->usual);
            if (p->type == BIS_PARAMETER_CHOICE) snprintf(told, sizeof told, "`string %s` `\"%s\"`", p->name, usual);
            else snprintf(told, sizeof told, " %s` (%s)", p->name, usual);
            if (!strstr(row, told)) fail_msg("%s: no %s in its row", (*i)->name, told);
        }
        *end = '\n';
    }
}

static bis_scene_desc *scene_of(const char *lines)
{
    bis_scene_desc *d;
    char text[1024];

    snprintf(text, sizeof text, "%s\nWorldBegin\nLightSource \"infinite\"\n", lines);
    program_write_file(SCENE, text);
    if (bis_scene_parse(&d, SCENE, NULL)) fail_msg("not read: %s", lines);
    return d;
}

static bool same_sampler(const bis_view *a, const bis_view *b)
{
    return a->sampler.kind == b->sampler.kind && a->sampler.spp == b->sampler.spp &&
           a->sampler.seed == b->sampler.seed && a->edge_samples == b->edge_samples &&
           fabs(a->edge_light - b->edge_light) < 1e-12;
}

/* The lines that the page says a scene without a Sampler or an Integrator has. The twins: a named one of the same name
 * has other values. */
static void a_scene_without_the_lines_has_those_of_the_page(void **state)
{
    static char page[1 << 17];
    char told[512];
    bis_scene_desc *none = scene_of("");

    read_text(page, sizeof page, "docs/scene-format.md");
    const char *line = strstr(page, "# A scene without a");
    assert_non_null(line);
    line = strchr(strstr(line, "\n```pbrt\n") + 1, '\n');
    const char *end = strstr(line, "\n```");
    assert_true(end && end - line < (int)sizeof told);
    snprintf(told, sizeof told, "%.*s", (int)(end - line), line);
    bis_scene_desc *d = scene_of(told);
    assert_true(bis_settings_equal(&d->view.settings, &none->view.settings));
    assert_true(same_sampler(&d->view, &none->view));
    bis_scene_desc_free(d);
    bis_scene_desc *named = scene_of("Sampler \"sobol\" Integrator \"sir\"");
    assert_false(bis_settings_equal(&named->view.settings, &none->view.settings));
    assert_false(same_sampler(&named->view, &none->view));
    bis_scene_desc_free(named);
    bis_scene_desc_free(none);
}

/* The page's table of the Sampler: | `integer NAME` | DEFAULT | ..., as a named sampler has them. */
static void defaults_of_a_named_sampler_are_those_of_the_page(void **state)
{
    static char page[1 << 17];
    FILE *f = fopen("docs/scene-format.md", "r");
    bis_scene_desc *d = scene_of("Sampler \"stratified\"");
    const bis_sampler *s = &d->view.sampler;
    char rows[7][64];

    assert_non_null(f);
    page[fread(page, 1, sizeof page - 1, f)] = '\0';
    fclose(f);
    assert_true(s->xsamples == s->ysamples);
    snprintf(rows[0], sizeof rows[0], "\n| `integer pixelsamples` | %u |", (unsigned)s->spp);
    snprintf(rows[1], sizeof rows[1], "\n| `integer seed` | %u |", (unsigned)s->seed);
    snprintf(rows[2], sizeof rows[2], "\n| `integer xsamples`, `ysamples` | %u |", (unsigned)s->xsamples);
    snprintf(rows[3], sizeof rows[3], "\n| `bool jitter` | %s |", s->jitter ? "true" : "false");
    snprintf(rows[4], sizeof rows[4], "\n| `integer edgesamples` | %u |", (unsigned)d->view.edge_samples);
    snprintf(rows[5], sizeof rows[5], "\n| `float edgelight` | %g |", d->view.edge_light);
    for (int i = 0; i < 6; i++)
        if (!strstr(strstr(page, "\n### Sampler"), rows[i])) fail_msg("no row %s", rows[i] + 1);
    bis_scene_desc_free(d);
}

/* Worked out by hand. The last column: what is left of candidates, shadowrays, samples. */
static void a_share_of_the_light_samples_is_rounded_up(void **state)
{
    static const struct {
        const bis_integrator *integrator;
        bis_proposal proposal;
        bool stratify;
        uint32_t M, N, samples;
        double share;
        uint32_t left[3];
    } cases[] = {
        {&bis_sir, BIS_PROPOSAL_PRODUCT, true, 64, 24, 16, 0.25, {16, 6, 16}},
        {&bis_sir, BIS_PROPOSAL_PRODUCT, true, 200, 15, 16, 0.25, {50, 4, 16}},
        {&bis_sir, BIS_PROPOSAL_PRODUCT, true, 40, 2, 16, 0.1, {16, 1, 16}}, /* a vector holds 16 */
        {&bis_sir, BIS_PROPOSAL_MIX, true, 800, 15, 16, 0.25, {800, 4, 16}}, /* its candidates come in whole sets */
        {&bis_sir, BIS_PROPOSAL_EM, true, 800, 16, 16, 0.25, {800, 4, 16}},
        {&bis_rejection, BIS_PROPOSAL_CHOOSE, true, 800, 15, 16, 0.5, {800, 8, 16}},
        {&bis_brdf, BIS_PROPOSAL_MIX, true, 800, 15, 5, 0.5, {800, 8, 3}},
        {&bis_em, BIS_PROPOSAL_MIX, false, 800, 15, 3, 0.25, {800, 4, 1}},
        {&bis_em, BIS_PROPOSAL_MIX, true, 800, 15, 16, 0.25, {800, 4, 16}}, /* stratified: whole sets */
        {&bis_mis, BIS_PROPOSAL_MIX, false, 800, 15, 3, 0.25, {800, 4, 2}}, /* mis needs two */
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        bis_settings s = bis_settings_default(cases[i].integrator);
        s.proposal = cases[i].proposal;
        s.stratify = cases[i].stratify;
        s.candidates = cases[i].M;
        s.shadowrays = cases[i].N;
        s.samples = cases[i].samples;
        const bis_settings thin = bis_settings_thin(&s, cases[i].share);
        const uint32_t left[3] = {thin.candidates, thin.shadowrays, thin.samples};
        for (int k = 0; k < 3; k++)
            if (left[k] != cases[i].left[k]) fail_msg("case %zu, %d: %u", i, k, (unsigned)left[k]);
        s.candidates = thin.candidates, s.shadowrays = thin.shadowrays, s.samples = thin.samples;
        assert_true(bis_settings_equal(&s, &thin)); /* nothing else changes */
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_parameter_is_told_and_read_back),
        cmocka_unit_test(defaults_are_those_of_the_page),
        cmocka_unit_test(a_scene_without_the_lines_has_those_of_the_page),
        cmocka_unit_test(defaults_of_a_named_sampler_are_those_of_the_page),
        cmocka_unit_test(a_share_of_the_light_samples_is_rounded_up),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
