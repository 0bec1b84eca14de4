/* mark: a claim is checked by this same program, run again with --claim K (tests/support/mark_run.h judges it). */
#include "mark.h"

#include "every.h"
#include "mark_run.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <errno.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#ifdef _OPENMP
#include <omp.h>
#endif
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

typedef struct job {
    const char *program, *claim;
    size_t number;
} job;

/* ---- the claim's end of the socket ---- */

static mark_greeting greeting;
static int channel = -1;

uint64_t mark_seed(uint64_t kit)
{
    return greeting.secret ? mark_mix(greeting.secret + mark_mix(kit)) >> 11 : kit;
}

size_t mark_size(size_t kit)
{
    return greeting.secret ? kit + mark_mix(greeting.secret ^ mark_mix(kit)) % (kit / 4 + 1) : kit;
}

static void tell(mark_message *m)
{
    if (channel >= 0) send(channel, m, sizeof *m, MSG_NOSIGNAL);
}

/* ---- for the claims ---- */

_Noreturn void mark_wrong(const char *format, ...)
{
    static mark_message m = {.kind = MARK_SAYS_WRONG};
    va_list arguments;

    va_start(arguments, format);
    vsnprintf(m.text, sizeof m.text, format, arguments);
    va_end(arguments);
    if (channel < 0) puts(m.text);
    fflush(stdout);
    tell(&m);
    _exit(MARK_STATUS_WRONG); /* what the claim holds is not a leak of the student's */
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
    mark_wrong("%s: not drawn with the right probabilities (chi-square test, p = %.2g). The worst of %zu cells is "
               "number %zu: drawn %.0f times, "
               "expected %.1f. %s",
               what, r.p, n, worst, observed[worst], expected[worst], hint);
}

void mark_mean(const stat_moments *m, double expected, double alpha, const char *what, const char *hint)
{
    if (!isfinite(m->mean)) mark_wrong("%s: the mean is not a finite number. A division by 0?", what);
    if (stat_mean(m, expected, alpha).rejected) {
        mark_wrong("%s: the mean of %.0f estimates is %.6g +- %.2g, must be %.6g. %s", what, m->n, m->mean,
                   sqrt(stat_variance(m) / m->n), expected, hint);
    }
}

void mark_run(stat_moments m[4], lit *l, const bis_settings *s, uint32_t runs, uint64_t seed)
{
    bis_scratch scratch;

    for (int i = 0; i < 4; i++)
        m[i] = (stat_moments){0};
    if (bis_scratch_init(&scratch, s, NULL)) mark_wrong("no memory for the test itself");
    for (uint32_t run = 0; run < runs; run++) {
        const rgb L = lit_once(l, s, &scratch, seed, run);
        if (!rgb_is_finite(L))
            mark_wrong("estimate %u is (%g %g %g): not finite. A division by 0?", run, (double)L.r, (double)L.g,
                       (double)L.b);
        stat_add(&m[0], (double)L.r);
        stat_add(&m[1], (double)L.g);
        stat_add(&m[2], (double)L.b);
        stat_add(&m[3], rgb_sum(L));
    }
    bis_scratch_clear(&scratch);
}

void mark_estimates(lit *l, const bis_settings *s, uint32_t runs, uint64_t seed, double alpha, const char *what,
                    const char *hint)
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

extern void __asan_init(void) __attribute__((weak));

/* When it is graded, a claim starts no process, opens no file and no connection, and touches no other process. Where
 * the system has no such filter, or the sanitizers are at work, which need what it forbids, that is left to the
 * sandbox. Threads are allowed, clone3 is not known: its flags are out of reach. */
static void give_up_rights(void)
{
#if defined(SYS_open) && defined(SYS_fork) && defined(__x86_64__) || defined(__aarch64__)
#define REFUSE(call, code)                                                                                             \
    BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, call, 0, 1), BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | (code))
    struct sock_filter rules[] = {
        BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(struct seccomp_data, nr)),
#ifdef __x86_64__
        BPF_JUMP(BPF_JMP | BPF_JGE | BPF_K, 0x40000000, 0, 1),
        BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | EPERM), /* the x32 numbers */
        REFUSE(SYS_open, EACCES),
        REFUSE(SYS_creat, EACCES),
        REFUSE(SYS_fork, EPERM),
        REFUSE(SYS_vfork, EPERM),
        REFUSE(SYS_unlink, EPERM),
        REFUSE(SYS_rename, EPERM),
        REFUSE(SYS_mkdir, EPERM),
        REFUSE(SYS_link, EPERM),
        REFUSE(SYS_symlink, EPERM),
        REFUSE(SYS_chmod, EPERM),
#endif
        REFUSE(SYS_openat, EACCES),
        REFUSE(437 /* openat2 */, EACCES),
        REFUSE(SYS_execve, EPERM),
        REFUSE(SYS_execveat, EPERM),
        REFUSE(SYS_ptrace, EPERM),
        REFUSE(SYS_process_vm_readv, EPERM),
        REFUSE(SYS_process_vm_writev, EPERM),
        REFUSE(SYS_kill, EPERM),
        REFUSE(SYS_socket, EPERM),
        REFUSE(SYS_connect, EPERM),
        REFUSE(SYS_unlinkat, EPERM),
        REFUSE(SYS_renameat, EPERM),
        REFUSE(SYS_renameat2, EPERM),
        REFUSE(SYS_mkdirat, EPERM),
        REFUSE(SYS_linkat, EPERM),
        REFUSE(SYS_symlinkat, EPERM),
        REFUSE(SYS_fchmodat, EPERM),
        REFUSE(SYS_truncate, EPERM),
        REFUSE(425 /* io_uring_setup */, ENOSYS),
        REFUSE(435 /* clone3 */, ENOSYS),
        BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_clone, 0, 3),
        BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(struct seccomp_data, args[0])),
        BPF_JUMP(BPF_JMP | BPF_JSET | BPF_K, CLONE_THREAD, 1, 0),
        BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | EPERM),
        BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
    };
    const struct sock_fprog program = {sizeof rules / sizeof *rules, rules};

#ifdef _OPENMP
    omp_get_max_threads(); /* LLVM's OpenMP opens a file when it starts, which later is forbidden */
#endif
    if (&__asan_init || prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) return;
    prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program);
#endif
}

static void greet(void)
{
    if (recv(BOX_CHANNEL, &greeting, sizeof greeting, 0) != (ssize_t)sizeof greeting) return; /* started by hand */
    channel = (int)(16 + mark_random() % 200);
    dup2(BOX_CHANNEL, channel);
    close(BOX_CHANNEL);
    if (greeting.secret) give_up_rights();
}

static double now(void)
{
    struct timespec t;

    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* The number comes after the check, and only then is the proof made. */
static int check_and_prove(void (*check)(void))
{
    uint64_t number;

    greet();
    const double begin = now();
    check();
    mark_message m = {.kind = MARK_SAYS_DONE, .seconds = now() - begin};
    tell(&m);
    if (channel >= 0 && recv(channel, &number, sizeof number, 0) == (ssize_t)sizeof number) {
        m.kind = MARK_SAYS_PROOF;
        m.proof = mark_proof(greeting.key, number);
        tell(&m);
    }
    return MARK_STATUS_HOLDS;
}

/* ---- the ways to run ---- */

static void as_test(void **state)
{
    const job *j = *state;
    mark_outcome o;

    mark_judge(&o, &(mark_order){.program = j->program, .claim = j->number, .limits = mark_limits()});
    if (o.verdict != MARK_HOLDS) fail_msg("%s\n(how it is tested: %s in tests/test_assignment.c)", o.text, j->claim);
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

int mark_main(int argc, char **argv, const mark_claim *claims, size_t n, void (*work)(void))
{
    /* A student's leak costs the points for clean memory, which the sanitizer judges, and no others. */
    every_finds_leaks = false;
    const char *how = argc > 1 ? argv[1] : "";

    if (argc == 3 && strcmp(how, "--claim") == 0) {
        const size_t number = (size_t)strtoul(argv[2], NULL, 10);
        return number < n ? check_and_prove(claims[number].check) : 1;
    }
    if (argc == 3 && strcmp(how, "--work") == 0) return check_and_prove(work);
    if (strcmp(how, "--list") == 0) {
        for (size_t i = 0; i < n; i++)
            printf("%d\t%s\n", claims[i].points, claims[i].name);
        return 0;
    }
    box_end_with_us();
    return run_claims(argv[0], claims, n);
}
