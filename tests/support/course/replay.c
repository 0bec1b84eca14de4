/* SPDX-License-Identifier: BSD-2-Clause */
/* replay: see replay.h. */
#include "replay.h"

#include "bis/base/mem.h"
#include "mark_run.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double tolerance = 1e-4;

void replay_freshen(ask_scene *scene)
{
    bis_material *m = &scene->material;

    if (!mark_secret()) return;
    double *u = mark_uniforms(8, mark_seed(31), (uint64_t)scene->map);
    scene->scale = 2 + u[0]; /* no unit of anything is near to 1 */
    scene->area_exponent = 0.3 * u[1];
    m->Kd = rgb_scale(m->Kd, 0.5 + 0.5 * u[2]);
    m->Ks = rgb_scale(m->Ks, 0.5 + 0.5 * u[3]);
    m->exponent *= 0.8 + 0.4 * u[4];
    scene->n = normalize(vec3_from((double)scene->n.x + 0.3 * u[5], (double)scene->n.y, (double)scene->n.z));
    scene->degrees += 10 * u[6];
    if (scene->hidden == LIT_HALF && u[7] < 0.5) scene->hidden = LIT_OTHER_HALF;
    bis_free(u);
}

static void make(ask_estimate made[], const replay *r, const bis_settings *settings)
{
    bis_scratch scratch;
    lit l;

    mark_lit(&l, &r->scene);
    if (bis_scratch_init(&scratch, settings, NULL)) mark_wrong("no memory for the test itself");
    for (uint32_t k = 0; k < r->n; k++)
        made[k] = answers_estimate(&l, settings, &scratch, r->scene.seed, r->run[k]);
    bis_scratch_clear(&scratch);
    bis_light_free(l.light);
}

void replay_by(ask_estimate made[REPLAY_RUNS], const replay *r, const bis_integrator *given, uint32_t samples)
{
    bis_settings s = r->scene.settings;

    s.integrator = given;
    s.samples = samples;
    make(made, r, &s);
}

void replay_ask(replay *r, const ask_scene *scene, const bis_integrator *ours, uint32_t runs,
                const double recorded[REPLAY_KIT])
{
    const bool is_graded = mark_secret() != 0, records = getenv("BIS_RECORD") != NULL;
    const uint32_t n = is_graded ? REPLAY_RUNS : REPLAY_KIT;

    *r = (replay){.scene = *scene, .n = n < runs ? n : runs, .knows_rays = is_graded, .knows_sum_only = !is_graded};
    r->scene.seed = mark_seed(32);
    replay_freshen(&r->scene);
    ask_estimate *e = mark_run(&r->scene, runs, r->scene.seed);
    for (uint32_t k = 0; k < r->n; k++) {
        r->run[k] = is_graded && runs > n ? mark_mix(mark_secret() + k) % runs : k;
        r->mine[k] = e[r->run[k]];
        const double third = recorded ? recorded[k] / 3 : 0;
        r->must[k].L = rgb_from(third, third, third);
    }
    bis_free(e);
    if (is_graded || records) {
        bis_settings s = r->scene.settings;
        s.integrator = ours;
        make(r->must, r, &s);
    }
    for (uint32_t k = 0; records && k < r->n; k++)
        printf("%s%.6g%s", k ? ", " : "{", rgb_sum(r->must[k].L), k + 1 < r->n ? "" : "}, accepted: ");
    for (uint32_t k = 0; records && k < r->n; k++)
        printf("%u%s", (unsigned)r->must[k].accepted, k + 1 < r->n ? "" : "\n");
}

/* ---- near ---- */

static double sum_of(const ask_estimate e[], uint32_t n)
{
    double sum = 0;

    for (uint32_t k = 0; k < n; k++)
        sum += rgb_sum(e[k].L);
    return sum;
}

bool replay_is_near(const replay *r, uint32_t k, rgb must)
{
    const rgb mine = r->mine[k].L;
    const double mean = sum_of(r->must, r->n) / r->n, most = tolerance * fmax(mean, rgb_sum(must));
    const rgb d = {mine.r - must.r, mine.g - must.g, mine.b - must.b};

    if (r->knows_sum_only) return fabs(rgb_sum(d)) <= most;
    return fabs((double)d.r) <= most && fabs((double)d.g) <= most && fabs((double)d.b) <= most;
}

uint32_t replay_first_wrong(const replay *r)
{
    uint32_t first = r->n, wrong = 0;

    for (uint32_t k = r->n; k-- > 0;) {
        if (replay_is_near(r, k, r->must[k].L)) continue;
        first = k;
        wrong++;
    }
    return wrong > r->n / 100 ? first : r->n;
}

/* ---- what a student reads ---- */

/* Ray j of both, or where one has none: the end of either. */
static void check_rays(const replay *r, uint32_t k, const char *what, const char *drawn)
{
    const ask_estimate *mine = &r->mine[k], *must = &r->must[k];

    for (uint32_t j = 0; j < mine->first.n && j < must->first.n; j++) {
        const vec3 a = mine->first.to[j], b = must->first.to[j];
        if (length(sub(a, b)) < 1e-4) continue;
        mark_wrong("%s: your directions are not those of %s; the first that differs is that of shadow ray %u in "
                   "estimate %u: it goes to (%.4f %.4f %.4f), must go to (%.4f %.4f %.4f). The handout says by what "
                   "and in which order they are drawn", what, drawn, j + 1, (unsigned)r->run[k], (double)a.x,
                   (double)a.y, (double)a.z, (double)b.x, (double)b.y, (double)b.z);
    }
    if (mine->rays != must->rays) {
        mark_wrong("%s: your directions are not those of %s; the first that differs is in estimate %u, which casts %u "
                   "shadow rays, must cast %u: one for each direction that can bring light", what, drawn,
                   (unsigned)r->run[k], (unsigned)mine->rays, (unsigned)must->rays);
    }
}

/* What all estimates are, in parts of what they must be; 0: they are not all the same parts. */
static double factor_of_all(const replay *r)
{
    const double factor = sum_of(r->mine, r->n) / sum_of(r->must, r->n);

    for (uint32_t k = 0; k < r->n; k++) {
        const double mine = rgb_sum(r->mine[k].L), must = rgb_sum(r->must[k].L);
        if (!(fabs(mine - factor * must) <= 1e-3 * factor * must)) return 0;
    }
    return factor;
}

void replay_check(const replay *r, const char *what, const char *drawn, const char *hint)
{
    const uint32_t k = replay_first_wrong(r);

    if (k == r->n) return;
    if (r->knows_rays) check_rays(r, k, what, drawn);
    const double mine = sum_of(r->mine, r->n), must = sum_of(r->must, r->n), factor = factor_of_all(r);
    if (factor > 0) mark_wrong("%s: each estimate is %.4g times what its directions give. %s", what, factor, hint);
    mark_wrong("%s: estimate %u is %.6g (r + g + b), must be %.6g by the directions of %s; the mean of %u is %.4g, "
               "must be %.4g. %s", what, (unsigned)r->run[k], rgb_sum(r->mine[k].L), rgb_sum(r->must[k].L), drawn,
               (unsigned)r->n, mine / r->n, must / r->n, hint);
}
