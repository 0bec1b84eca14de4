/* mark: a claim is checked by this same program, run again with --claim K, its output read through a pipe. */
#include "mark.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

/* Not 0, which a student's exit(0) would give. */
enum { HOLDS = 8, WRONG = 9 };

typedef struct job {
    const char *program, *claim;
    size_t number;
} job;

typedef struct outcome {
    bool ok;
    char text[4096];
} outcome;

/* ---- for the claims ---- */

/* 0 in a kit: what the kit says counts. */
static uint64_t salt(void)
{
    const char *given = getenv("BIS_MARK_SALT");

    return given ? strtoull(given, NULL, 10) : 0;
}

/* The finalizer of splitmix64: near seeds give far results. */
static uint64_t scrambled(uint64_t x)
{
    x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9u;
    x = (x ^ x >> 27) * 0x94d049bb133111ebu;
    return x ^ x >> 31;
}

uint64_t mark_seed(uint64_t kit) { return salt() ? scrambled(kit + salt() * 0x9e3779b97f4a7c15u) : kit; }

size_t mark_size(size_t kit) { return salt() ? kit + (size_t)(scrambled(kit + salt() * 0x9e3779b97f4a7c15u) % (kit / 4 + 1)) : kit; }

_Noreturn void mark_wrong(const char *format, ...)
{
    va_list arguments;

    va_start(arguments, format);
    vprintf(format, arguments);
    va_end(arguments);
    fflush(stdout);
    _exit(WRONG); /* what the claim holds is not a leak of the student's */
}

void mark_near(double value, double expected, double absolute, double relative, const char *what, ...)
{
    const double tolerance = fmax(absolute, relative * fabs(expected));
    va_list arguments;

    if (fabs(value - expected) <= tolerance) return;
    va_start(arguments, what);
    vprintf(what, arguments);
    va_end(arguments);
    mark_wrong(" is %.9g, must be %.9g", value, expected);
}

void mark_fit(const double *observed, const double *expected, size_t n, double alpha, const char *what, const char *hint)
{
    const stat_result r = stat_chi_square(observed, expected, n, alpha);
    size_t worst = 0;

    if (!r.rejected) return;
    for (size_t i = 0; i < n; i++) {
        const double here = (observed[i] - expected[i]) * (observed[i] - expected[i]) / fmax(expected[i], 1);
        const double there = (observed[worst] - expected[worst]) * (observed[worst] - expected[worst]) / fmax(expected[worst], 1);
        if (here > there) worst = i;
    }
    mark_wrong("%s: not drawn with the right probabilities (chi-square test, p = %.2g). The worst of %zu cells is number %zu: drawn %.0f times, "
               "expected %.1f. %s", what, r.p, n, worst, observed[worst], expected[worst], hint);
}

void mark_mean(const stat_moments *m, double expected, double alpha, const char *what, const char *hint)
{
    if (!isfinite(m->mean)) mark_wrong("%s: the mean is not a finite number. A division by 0?", what);
    if (stat_mean(m, expected, alpha).rejected) {
        mark_wrong("%s: the mean of %.0f estimates is %.6g +- %.2g, must be %.6g. %s", what, m->n, m->mean, sqrt(stat_variance(m) / m->n), expected,
                   hint);
    }
}

void mark_run(stat_moments m[4], lit *l, const bis_settings *s, uint32_t runs, uint64_t seed)
{
    bis_scratch scratch;

    for (int i = 0; i < 4; i++) m[i] = (stat_moments){0};
    if (bis_scratch_init(&scratch, s, NULL)) mark_wrong("no memory for the test itself");
    for (uint32_t run = 0; run < runs; run++) {
        const rgb L = lit_once(l, s, &scratch, seed, run);
        if (!rgb_is_finite(L)) mark_wrong("estimate %u is (%g %g %g): not finite. A division by 0?", run, (double)L.r, (double)L.g, (double)L.b);
        stat_add(&m[0], (double)L.r);
        stat_add(&m[1], (double)L.g);
        stat_add(&m[2], (double)L.b);
        stat_add(&m[3], rgb_sum(L));
    }
    bis_scratch_clear(&scratch);
}

void mark_estimates(lit *l, const bis_settings *s, uint32_t runs, uint64_t seed, double alpha, const char *what, const char *hint)
{
    static const char *const channels[] = {"red", "green", "blue"};
    const rgbd truth = lit_truth(l, true);
    const double expected[] = {truth.r, truth.g, truth.b};
    stat_moments m[4];

    mark_run(m, l, s, runs, seed);
    for (int i = 0; i < 3; i++) {
        char name[256];
        snprintf(name, sizeof name, "%s, %s", what, channels[i]);
        mark_mean(&m[i], expected[i], alpha, name, hint);
    }
}

/* ---- one claim, in its own process ---- */

static unsigned seconds(void)
{
    const char *given = getenv("BIS_CLAIM_SECONDS");

    return given ? (unsigned)strtoul(given, NULL, 10) : 20;
}

/* Of the processor; and six times that by the clock, for what waits without end. */
static void limit_time(void)
{
    const struct rlimit limit = {seconds(), seconds() + 1}, no_core = {0, 0};

    setrlimit(RLIMIT_CPU, &limit);
    setrlimit(RLIMIT_CORE, &no_core);
    alarm(6 * seconds());
}

static void run_alone(const job *j)
{
    char number[24];

    limit_time();
    snprintf(number, sizeof number, "%zu", j->number);
    execl(j->program, j->program, "--claim", number, (char *)NULL);
    _exit(127);
}

static void describe_end(char *text, size_t room, int status)
{
    const char *why = "it ended without a word";

    if (WIFSIGNALED(status)) {
        const int number = WTERMSIG(status);
        why = number == SIGXCPU || number == SIGKILL ? "no answer in the time allowed: a loop without end?"
              : number == SIGALRM ? "no answer, and no work either: does it wait for something?"
              : number == SIGSEGV ? "it crashed (segmentation fault): an index out of its range?"
              : number == SIGABRT ? "it was aborted: an assertion failed, see there what it demands"
                                  : strsignal(number);
    } else if (WEXITSTATUS(status) == 0) {
        why = "it ended before the test did: a call of exit?";
    } else if (text[0]) {
        return;
    }
    const size_t used = strlen(text);
    snprintf(text + used, room - used, "%s%s", used ? "\n" : "", why);
}

static outcome check(const job *j)
{
    outcome o = {false, ""};
    int ends[2], status = 0;
    size_t n = 0;

    fflush(NULL);
    if (pipe(ends) != 0) return o;
    const pid_t child = fork();
    if (child == 0) {
        dup2(ends[1], STDOUT_FILENO);
        dup2(ends[1], STDERR_FILENO);
        close(STDIN_FILENO);
        close(ends[0]);
        run_alone(j);
    }
    close(ends[1]);
    for (;;) {
        char chunk[1024];
        const ssize_t got = read(ends[0], chunk, sizeof chunk);
        if (got <= 0) break;
        for (ssize_t i = 0; i < got && n < sizeof o.text - 128; i++) o.text[n++] = chunk[i];
    }
    o.text[n] = '\0';
    close(ends[0]);
    waitpid(child, &status, 0);
    o.ok = WIFEXITED(status) && WEXITSTATUS(status) == HOLDS;
    if (!o.ok) describe_end(o.text, sizeof o.text, status);
    return o;
}

/* ---- the three ways to run ---- */

static void as_test(void **state)
{
    const job *j = *state;
    const outcome o = check(j);

    if (!o.ok) fail_msg("%s\n(how it is tested: %s in tests/test_assignment.c)", o.text, j->claim);
}

static int run_claims(const char *program, const mark_claim *claims, size_t n)
{
    struct CMUnitTest *tests = calloc(n, sizeof *tests);
    job *jobs = calloc(n, sizeof *jobs);

    if (!tests || !jobs) return 1;
    for (size_t i = 0; i < n; i++) {
        jobs[i] = (job){program, claims[i].name, i};
        tests[i] = (struct CMUnitTest){.name = claims[i].name, .test_func = as_test, .initial_state = &jobs[i]};
    }
    const int failed = _cmocka_run_group_tests("assignment", tests, n, NULL, NULL);
    free(tests);
    free(jobs);
    return failed;
}

static int grade(const char *program, const mark_claim *claims, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        const job j = {program, claims[i].name, i};
        outcome o = check(&j);
        for (char *c = o.text; *c; c++) {
            if (*c < ' ' || *c > '~') *c = ' '; /* one line, and valid in JSON, whatever the student prints */
        }
        printf("%s\t%d\t%s\t%s\n", o.ok ? "ok" : "wrong", claims[i].points, claims[i].name, o.ok ? "" : o.text);
    }
    return 0;
}

static double now(void)
{
    struct timespec t;

    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int measure(void (*work)(void))
{
    double least = HUGE_VAL;

    limit_time();
    for (int i = 0; i < 5; i++) {
        const double begin = now();
        work();
        least = fmin(least, now() - begin);
    }
    printf("%.9f\n", least);
    return 0;
}

int mark_main(int argc, char **argv, const mark_claim *claims, size_t n, void (*work)(void))
{
    if (argc == 3 && strcmp(argv[1], "--claim") == 0) {
        const size_t number = (size_t)strtoul(argv[2], NULL, 10);
        if (number >= n) return 1;
        claims[number].check();
        return HOLDS;
    }
    if (argc == 2 && strcmp(argv[1], "--work") == 0) return measure(work);
    if (argc == 2 && strcmp(argv[1], "--grade") == 0) return grade(argv[0], claims, n);
    return run_claims(argv[0], claims, n);
}
