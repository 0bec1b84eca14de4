/* SPDX-License-Identifier: BSD-2-Clause */
/* mark: the words of the claims, and the ways to run them. */
#include "mark.h"

#include "bis/base/mem.h"
#include "bis/files/image_file.h"
#include "bis/thesis/rng.h"
#include "claim.h"
#include "every.h"
#include "mark_run.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* ---- for the claims ---- */

uint64_t mark_seed(uint64_t kit)
{
    return mark_secret() ? mark_mix(mark_secret() + mark_mix(kit)) >> 11 : kit;
}

size_t mark_size(size_t kit)
{
    return mark_secret() ? kit + mark_mix(mark_secret() ^ mark_mix(kit)) % (kit / 4 + 1) : kit;
}

void *mark_alloc(size_t n, size_t size)
{
    void *p = bis_alloc(n, size);

    if (!p) mark_wrong("no memory for the test itself");
    return p;
}

double *mark_uniforms(size_t n, uint64_t seed, uint64_t pixel)
{
    double *u = mark_alloc(n, sizeof *u);
    bis_rng r;

    bis_rng_init(&r, seed, pixel, 0, 0);
    for (size_t i = 0; i < n; i++)
        u[i] = bis_rng_double(&r);
    return u;
}

_Noreturn void mark_wrong(const char *format, ...)
{
    static char text[2000];
    va_list arguments;

    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    mark_conclude(MARK_WRONG, text);
}

void mark_near(double value, double expected, double absolute, double relative, const char *what, ...)
{
    const double tolerance = fmax(absolute, relative * fabs(expected));
    va_list arguments;

    if (fabs(value - expected) <= tolerance) return;
    char name[512];
    va_start(arguments, what);
    vsnprintf(name, sizeof name, what, arguments);
    va_end(arguments);
    mark_wrong("%s is %.9g, must be %.9g", name, value, expected);
}

/* Returns whether a picture is written to $BIS_PICTURE: for each cell, bars of what was drawn and of what was expected,
 * as high as the square roots, of which chance is equally wide everywhere. */
static bool draw_fit(const double *observed, const double *expected, size_t n)
{
    enum { HEIGHT = 240 };
    static const rgb white = {1, 1, 1}, of_drawn = {1, 0.3f, 0}, of_expected = {0.1f, 0.3f, 0.8f};
    const char *path = getenv("BIS_PICTURE");
    const size_t cell = n <= 100 ? 10 : 4, width = n * cell;
    bis_image image;
    double most = 1;

    if (!path || bis_image_init(&image, (int)width, HEIGHT, NULL)) return false;
    for (size_t i = 0; i < n; i++) most = fmax(most, fmax(observed[i], expected[i]));
    for (size_t k = 0; k < width * HEIGHT; k++) {
        const size_t i = k % width / cell, side = 10 * (k % cell) / cell; /* 0 to 4: drawn, 5 to 8: expected */
        const double up = 1 - (double)(k / width) / HEIGHT, high = sqrt((side < 5 ? observed : expected)[i] / most);
        image.pixels[k] = side > 8 || up > high ? white : side < 5 ? of_drawn : of_expected;
    }
    const bis_status status = bis_image_save_colours(&image, path, NULL);
    bis_image_clear(&image);
    return status == BIS_OK;
}

void mark_fit(const double *observed, const double *expected, size_t n, double alpha, const char *what,
              const char *hint)
{
    const stat_result r = stat_chi_square(observed, expected, n, alpha);
    size_t worst = 0;

    if (!r.rejected) return;
    for (size_t i = 0; i < n; i++) {
        const double here = (observed[i] - expected[i]) * (observed[i] - expected[i]) / fmax(expected[i], 1);
        const double there =
            (observed[worst] - expected[worst]) * (observed[worst] - expected[worst]) / fmax(expected[worst], 1);
        if (here > there) worst = i;
    }
    const bool drawn = draw_fit(observed, expected, n);
    mark_wrong("%s: not drawn with the right probabilities (chi-square test, p = %.2g). The worst of %zu cells is "
               "number %zu: drawn %.0f times, expected %.1f. %s%s%s",
               what, r.p, n, worst, observed[worst], expected[worst], hint,
               drawn ? " Each cell, drawn (orange) beside expected (blue), as square roots: " : "",
               drawn ? getenv("BIS_PICTURE") : "");
}

void mark_mean(const stat_moments *m, double expected, double alpha, const char *what, const char *hint)
{
    if (!isfinite(m->mean)) mark_wrong("%s: the mean is not a finite number. A division by 0?", what);
    if (stat_mean(m, expected, alpha).rejected) {
        mark_wrong("%s: the mean of %.0f estimates is %.6g +- %.2g, must be %.6g. %s", what, m->n, m->mean,
                   sqrt(stat_variance(m) / m->n), expected, hint);
    }
}

/* ---- estimates ---- */

ask_scene mark_scene(lit_map map, bis_material m, lit_hidden hidden, int integrator, const bis_settings *s)
{
    ask_scene scene = {.map = map,
                       .scale = 1,
                       .material = m,
                       .n = normalize(vec3_from(0.2, -0.3, 0.8)),
                       .degrees = 40,
                       .hidden = hidden,
                       .kind = BIS_SAMPLER_STRATIFIED,
                       .integrator = integrator,
                       .settings = *s};

    scene.settings.integrator = NULL; /* an address of this process */
    scene.material.model = NULL;
    return scene;
}

void mark_lit(lit *l, const ask_scene *scene)
{
    answers_lit(l, scene);
}

ask_estimate *mark_run(const ask_scene *scene, uint32_t runs, uint64_t seed)
{
    ask_estimate *e = mark_alloc(runs, sizeof *e);
    uint64_t *run = mark_alloc(runs, sizeof *run);
    ask_scene with = *scene;

    with.seed = seed;
    for (uint32_t i = 0; i < runs; i++)
        run[i] = i;
    ASK(ASK_ESTIMATES, GIVE(&with, 1), GIVE(run, runs), TAKE(e, runs));
    bis_free(run);
    for (uint32_t i = 0; i < runs; i++) {
        const rgb L = e[i].L;
        if (!rgb_is_finite(L))
            mark_wrong("estimate %u is (%g %g %g): not finite. A division by 0?", i, (double)L.r, (double)L.g,
                       (double)L.b);
    }
    return e;
}

void mark_moments(stat_moments m[4], const ask_estimate *e, uint32_t runs)
{
    for (int i = 0; i < 4; i++)
        m[i] = (stat_moments){0};
    for (uint32_t i = 0; i < runs; i++) {
        stat_add(&m[0], (double)e[i].L.r);
        stat_add(&m[1], (double)e[i].L.g);
        stat_add(&m[2], (double)e[i].L.b);
        stat_add(&m[3], rgb_sum(e[i].L));
    }
}

uint64_t mark_most_rays(const ask_estimate *e, uint32_t runs)
{
    uint64_t most = 0;

    for (uint32_t i = 0; i < runs; i++)
        most = e[i].rays > most ? e[i].rays : most;
    return most;
}

void mark_estimates(const ask_estimate *e, const lit *l, uint32_t runs, double alpha, const char *what,
                    const char *hint)
{
    static const char *const channels[] = {"red", "green", "blue"};
    const rgbd truth = lit_truth(l, true);
    const double expected[] = {truth.r, truth.g, truth.b};
    stat_moments m[4];

    mark_moments(m, e, runs);
    for (int i = 0; i < 3; i++) {
        char name[256];
        snprintf(name, sizeof name, "%s, %s", what, channels[i]);
        mark_mean(&m[i], expected[i], alpha, name, hint);
    }
}

/* ---- the ways to run ---- */

typedef struct job {
    const char *claim;
    mark_order order;
} job;

static void as_test(void **state)
{
    const job *j = *state;
    mark_outcome o;

    mark_judge(&o, &j->order);
    if (o.verdict != MARK_HOLDS) fail_msg("%s\n(how it is tested: %s in tests/test_assignment.c)", o.text, j->claim);
}

static int run_claims(const char *program, const mark_claim *claims, size_t n)
{
    const char *const student[] = {program, "--serve", NULL};
    struct CMUnitTest *tests = calloc(n, sizeof *tests);
    job *jobs = calloc(n, sizeof *jobs);

    if (!tests || !jobs) return 1;
    for (size_t i = 0; i < n; i++) {
        jobs[i] = (job){claims[i].name, {.judge = program, .student = student, .claim = i, .cpu = mark_seconds()}};
        tests[i] = (struct CMUnitTest){.name = claims[i].name, .test_func = as_test, .initial_state = &jobs[i]};
    }
    const int failed = _cmocka_run_group_tests("assignment", tests, n, NULL, NULL);
    free(tests);
    free(jobs);
    return failed;
}

/* ---- what a student sees before handing in ---- */

static double processor_time(void)
{
    struct timespec t;

    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* The time of a load that is the same in every kit: look-ups, whole numbers, roots. A kit has no code of ours to
 * compare with; it has the time of ours in this unit. */
static double yardstick(void)
{
    enum { ROOM = 1 << 15 };
    static double table[ROOM];
    const double begin = processor_time();
    uint64_t x = 1;

    for (int i = 0; i < 3000000; i++) {
        x = mark_mix(x + (uint64_t)i);
        table[x % ROOM] = sqrt(table[x / ROOM % ROOM] + 1 + (double)(x >> 40));
    }
    return table[0] < 0 ? 0 : processor_time() - begin;
}

static void show_speed(mark_order *order, double ours)
{
    double least = HUGE_VAL, unit = HUGE_VAL;

    order->claim = MARK_WORK;
    for (int round = 0; round < 8; round++) {
        mark_outcome o;
        mark_judge(&o, order);
        if (o.verdict != MARK_HOLDS) {
            printf(" 0 of 10  speed: %s\n", o.text);
            return;
        }
        least = fmin(least, o.seconds);
        unit = fmin(unit, yardstick());
    }
    const double times = least / unit / ours;
    printf("%2d of 10  speed: about %.1f times our time; 1.5 are worth 10 points, 3 are worth 5\n",
           times <= 1.5 ? 10 : times <= 3 ? 5 : 0, times);
}

/* sanitized: this program is, and only memory is looked at. What a claim says is not so does not count there, but what
 * the student's process died of. */
static int show_points(const char *program, const mark_claim *claims, size_t n, double ours, bool sanitized)
{
    const char *const student[] = {program, "--serve", NULL};
    const double cpu = mark_seconds() * (sanitized ? 3 : 1);
    mark_order order = {.judge = program, .student = student, .cpu = cpu, .sanitized = sanitized};
    int points = 0;

    for (size_t i = 0; i < n; i++) {
        mark_outcome o;
        char picture[300];
        order.claim = i;
        snprintf(picture, sizeof picture, "build/%s.png", claims[i].name);
        if (!sanitized) setenv("BIS_PICTURE", picture, 1);
        mark_judge(&o, &order);
        const int got = o.verdict == MARK_HOLDS ? claims[i].points : 0;
        points += got;
        if (sanitized && (o.verdict == MARK_DIED || o.verdict == MARK_SLOW)) {
            printf(" 0 of 10  clean memory: %s: %s\n", claims[i].name, o.text);
            return 0;
        }
        if (sanitized) continue;
        printf("%2d of %d  %s%s%s\n", got, claims[i].points, claims[i].name, *o.text ? ": " : "", o.text);
    }
    if (sanitized) printf("%2d of 10  clean memory, in the share of the tests that pass\n", points / 8);
    else if (points == 80) show_speed(&order, ours);
    else puts(" 0 of 10  speed: measured once all tests pass");
    return 0;
}

int mark_main(int argc, char **argv, const mark_claim *claims, size_t n, void (*work)(void), double ours)
{
    /* A student's leak costs the points for clean memory, which the sanitizer judges, and no others. */
    every_finds_leaks = false;
    const char *how = argc > 1 ? argv[1] : "";

    if (strcmp(how, "--serve") == 0) return answers_serve();
    if (argc > 6 && strcmp(how, "--claim") == 0) {
        const size_t number = (size_t)strtoul(argv[2], NULL, 10);
        if (number < n) mark_claim_main(argv + 2, claims[number].check);
        return 1;
    }
    if (argc > 6 && strcmp(how, "--work") == 0) mark_claim_main(argv + 2, work);
    if (strcmp(how, "--list") == 0) {
        for (size_t i = 0; i < n; i++)
            printf("%d\t%s\n", claims[i].points, claims[i].name);
        return 0;
    }
    box_end_with_us();
    if (strcmp(how, "--check") == 0 || strcmp(how, "--clean") == 0) {
        return show_points(argv[0], claims, n, ours, strcmp(how, "--clean") == 0);
    }
    return run_claims(argv[0], claims, n);
}
