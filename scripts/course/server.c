/* SPDX-License-Identifier: BSD-2-Clause */
/* server: the program of a graded hand-in (answers.h). Before it answers anything it gives up all that
 * plain code does not need: it may read and write what is open, take memory, start threads of its own and end. It opens
 * no file and no connection, starts no process and touches none. What else is asked of the kernel fails with EPERM.
 *
 * The sanitizers need more: they read files, and a copy of the process stops it and looks at its memory. So a sanitized
 * program may open files to read, fork, and attach to itself. Outside of a sandbox it runs no other program, writes to
 * no file that it opens, and stops, signals and changes no other process. */
#include "answers.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <stdio.h>
#if defined(__clang__) && defined(_OPENMP)
#include <omp.h>
#include <sys/mman.h>
#endif
#include <sched.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/ptrace.h>
#include <sys/syscall.h>
#include <unistd.h>

extern void __asan_init(void) __attribute__((weak));

#if defined(__x86_64__) || defined(__aarch64__)
#ifdef __x86_64__
enum { NATIVE = AUDIT_ARCH_X86_64 };
#else
enum { NATIVE = AUDIT_ARCH_AARCH64 };
#endif

/* A test skips so many rules where it holds, and so many where it does not. */
#define TEST(value, yes, no) BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, value, yes, no)
#define TEST_BITS(bits, yes, no) BPF_JUMP(BPF_JMP | BPF_JSET | BPF_K, bits, yes, no)
#define LOAD(member) BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(struct seccomp_data, member))
#define YES BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW)
#define NO BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | EPERM)
#define ALLOW(call) TEST(call, 0, 1), YES

typedef struct rule_list {
    struct sock_filter rules[256];
    unsigned short n;
} rule_list;

static void append(rule_list *l, const struct sock_filter *rules, size_t n)
{
    memcpy(l->rules + l->n, rules, n * sizeof *rules);
    l->n = (unsigned short)(l->n + n);
}
#define LIST(...) (struct sock_filter[]){__VA_ARGS__}
#define ADD(list, ...) append(list, LIST(__VA_ARGS__), sizeof(LIST(__VA_ARGS__)) / sizeof(struct sock_filter))

/* clone3 is not known, because its flags are out of reach: clone is used then. */
static void add_plain(rule_list *l)
{
    ADD(l, LOAD(arch), TEST(NATIVE, 1, 0), /* else numbers mean other calls */
        BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_KILL_PROCESS), LOAD(nr),
        ALLOW(SYS_read), ALLOW(SYS_write), ALLOW(SYS_writev), ALLOW(SYS_lseek), ALLOW(SYS_fstat), ALLOW(SYS_close),
        ALLOW(SYS_newfstatat), ALLOW(SYS_mmap), ALLOW(SYS_munmap), ALLOW(SYS_mremap), ALLOW(SYS_mprotect),
        ALLOW(SYS_madvise), ALLOW(SYS_brk), ALLOW(SYS_futex), ALLOW(SYS_sched_yield), ALLOW(SYS_sched_getaffinity),
        ALLOW(SYS_set_robust_list), ALLOW(__NR_rseq), ALLOW(SYS_rt_sigprocmask),
        ALLOW(SYS_rt_sigaction), ALLOW(SYS_rt_sigreturn), ALLOW(SYS_restart_syscall), ALLOW(SYS_getpid),
        ALLOW(SYS_gettid), ALLOW(SYS_getrandom), ALLOW(SYS_clock_gettime), ALLOW(SYS_nanosleep),
        ALLOW(SYS_clock_nanosleep), ALLOW(SYS_exit), ALLOW(SYS_exit_group),
        TEST(435 /* clone3 */, 0, 1), BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | ENOSYS));
}

/* Open to read; limits of its own; attach to it, look at registers, and let go without a signal. No fcntl: a descriptor
 * may send any signal to any process. */
static void add_sanitized(rule_list *l)
{
    enum { WRITES = O_WRONLY | O_RDWR | O_CREAT | O_TRUNC, GETREGS = 12 };

    ADD(l, ALLOW(SYS_clone), ALLOW(SYS_wait4), ALLOW(SYS_getppid), ALLOW(SYS_prctl), ALLOW(SYS_sigaltstack),
        ALLOW(SYS_getdents64), ALLOW(SYS_readlinkat), ALLOW(SYS_pread64), ALLOW(SYS_pipe2), ALLOW(SYS_mincore),
        ALLOW(SYS_getrusage),
        TEST(SYS_openat, 0, 4), LOAD(args[2]), TEST_BITS(WRITES, 0, 1), NO, YES,
        TEST(SYS_prlimit64, 0, 4), LOAD(args[0]), TEST(0, 1, 0), NO, YES,
        TEST(SYS_ptrace, 0, 16), LOAD(args[1]), TEST((uint32_t)getpid(), 1, 0), NO, LOAD(args[0]),
        ALLOW(PTRACE_ATTACH), ALLOW(PTRACE_GETREGSET), ALLOW(GETREGS),
        TEST(PTRACE_DETACH, 1, 0), TEST(PTRACE_CONT, 0, 2), LOAD(args[3]), TEST(0, 1, 0), NO, YES);
#ifdef __x86_64__
    ADD(l, ALLOW(SYS_readlink), ALLOW(SYS_stat), ALLOW(SYS_lstat), ALLOW(SYS_access), ALLOW(SYS_pipe),
        ALLOW(SYS_getdents), TEST(SYS_open, 0, 4), LOAD(args[1]), TEST_BITS(WRITES, 0, 1), NO, YES);
#endif
}

/* Where the system has no such filter, that is left to the sandbox; and where there is a sandbox, what the sanitizers
 * do is, because clang's run another program to find the names of functions. abort sends a signal to its own process;
 * a thread is of it. */
static void give_up_rights(void)
{
    static rule_list l;
    const char *sandbox = getenv("BIS_SANDBOX");

    if (&__asan_init && sandbox && strcmp(sandbox, "bwrap") == 0) return;
    add_plain(&l);
    if (&__asan_init) add_sanitized(&l);
    ADD(&l, TEST(SYS_tgkill, 0, 2), LOAD(args[0]), TEST((uint32_t)getpid(), 3, 4),
        TEST(SYS_clone, 0, 3), LOAD(args[0]), TEST_BITS(CLONE_THREAD, 0, 1), YES, NO);
    if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) return;
    prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &(struct sock_fprog){l.n, l.rules});
}
#else
static void give_up_rights(void) {}
#endif

/* clang's OpenMP makes a file of shared memory when it is first used, which is refused later on, and only it removes
 * the file when it ends well. It would choose the processors of its threads, too, which is refused. */
static void start_openmp(void)
{
#if defined(__clang__) && defined(_OPENMP)
    char name[64];

    setenv("KMP_AFFINITY", "disabled", 1);
    omp_get_max_threads();
    snprintf(name, sizeof name, "/__KMP_REGISTERED_LIB_%d_%d", (int)getpid(), (int)getuid());
    shm_unlink(name);
#endif
}

/* In the place of what no hand-in calls (scripts/course/accept.sh). */
_Noreturn void bis_refused(void);
_Noreturn void bis_refused(void)
{
    puts("a function was called that is refused; the remarks name it");
    fflush(stdout);
    abort();
}

int main(void)
{
    start_openmp();
    give_up_rights();
    return answers_serve();
}
