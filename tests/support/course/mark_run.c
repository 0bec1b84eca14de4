/* SPDX-License-Identifier: BSD-2-Clause */
/* mark_run: who asks for a mark, and the claim's end of the socket to the student's process. */
#include "mark_run.h"

#include "mark.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { MOST_WORDS = 100, SHOWN = 200 /* characters of what a student's code printed */ };

/* The clock's limit only ends what no other limit does. */
static const double patience = 600;

uint64_t mark_mix(uint64_t x)
{
    x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9;
    x = (x ^ x >> 27) * 0x94d049bb133111eb;
    return x ^ x >> 31;
}

double mark_seconds(void)
{
    const char *given = getenv("BIS_CLAIM_SECONDS");

    return given ? strtod(given, NULL) : 20;
}

/* ---- who asks ---- */

void mark_judge(mark_outcome *o, const mark_order *order)
{
    char claim[24], secret[24], cpu[32];
    const char *words[MOST_WORDS] = {order->judge, order->claim == MARK_WORK ? "--work" : "--claim",
                                     claim,        secret,
                                     cpu,          order->sanitized ? "sanitized" : "plain"};
    size_t n = 6;
    static box b;

    *o = (mark_outcome){.verdict = MARK_DIED};
    snprintf(claim, sizeof claim, "%zu", order->claim);
    snprintf(secret, sizeof secret, "%llx", (unsigned long long)order->secret);
    snprintf(cpu, sizeof cpu, "%g", order->cpu);
    for (const char *const *word = order->student; *word && n + 1 < MOST_WORDS; word++)
        words[n++] = *word;
    words[n] = NULL;
    const box_limits limits = {.cpu = patience, .wall = 2 * patience, .file = 1 << 20};
    if (!box_run(&b, &limits, (char *const *)(uintptr_t)words)) {
        snprintf(o->text, sizeof o->text, "no process for the test");
        return;
    }
    const int status = WIFEXITED(b.end.status) ? WEXITSTATUS(b.end.status) - MARK_STATUS : -1;
    if (b.end.late) o->verdict = MARK_BUSY;
    if (b.end.late || status < MARK_HOLDS || status > MARK_BUSY) {
        snprintf(o->text, sizeof o->text, "the test itself came to no end: %.2000s", b.end.output);
        return;
    }
    o->verdict = (mark_verdict)status;
    char *note;
    o->seconds = strtod(b.end.output, &note);
    snprintf(o->text, sizeof o->text, "%.4000s", o->verdict == MARK_HOLDS ? note + strspn(note, " ") : b.end.output);
}

/* ---- the claim's process ---- */

static struct student {
    box box;
    int fd;
    bool said_hello;
    double cpu; /* the limit */
    char *const *words; /* that start it */
    bool sanitized;
    double before; /* of its time: before the first question */
    pid_t pid;  /* as the kernel tells it, through any sandbox */
    clockid_t clock;
    uint64_t secret;
} student;

uint64_t mark_secret(void)
{
    return student.secret;
}

static double used(void)
{
    struct timespec t = {0};

    clock_gettime(student.clock, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static char note[200];

void mark_note(const char *format, ...)
{
    va_list arguments;

    va_start(arguments, format);
    vsnprintf(note, sizeof note, format, arguments);
    va_end(arguments);
}

/* Seconds in which the student's process could have run, but other processes had the processor. */
static double kept_waiting(void)
{
    char path[64];
    unsigned long long ran, waited = 0;

    snprintf(path, sizeof path, "/proc/%d/schedstat", (int)student.pid);
    FILE *f = fopen(path, "r");
    if (f && fscanf(f, "%llu %llu", &ran, &waited) != 2) waited = 0;
    if (f) fclose(f);
    return 1e-9 * (double)waited;
}

/* Does the student's process sleep now, or is it stopped? A loop is not, even where the whole machine stood still for
 * seconds, which no account of who waits tells. */
static bool sleeps(void)
{
    char path[64], line[256];

    snprintf(path, sizeof path, "/proc/%d/stat", (int)student.pid);
    FILE *f = fopen(path, "r");
    const char *name_end = f && fgets(line, sizeof line, f) ? strrchr(line, ')') : NULL; /* a name may have its own */
    if (f) fclose(f);
    const char state = name_end && name_end[1] ? name_end[2] : 'S';
    return state != 'R' && state != 'D'; /* nor waits for a page */
}

/* What the student's code printed: its beginning, up to the end of a word. */
static void show_output(const box_end *end)
{
    size_t n = end->n;

    while (n > 0 && strchr("\n\t ", end->output[n - 1]))
        n--;
    if (n == 0) return;
    if (n > SHOWN) {
        for (n = SHOWN; n > SHOWN / 2 && end->output[n] != ' ' && end->output[n] != '\n'; n--)
            continue;
    }
    printf("\nIt printed: %.*s%s", (int)n, end->output, n < end->n ? " ..." : "");
}

_Noreturn void mark_conclude(mark_verdict verdict, const char *why)
{
    box_finish(&student.box);
    fputs(why, stdout);
    if (verdict != MARK_HOLDS) show_output(&student.box.end);
    fflush(stdout);
    _exit(MARK_STATUS + (int)verdict); /* what the claim holds is not a leak of the student's */
}

static const char *why_it_ended(int number)
{
    return number == SIGXCPU || number == SIGKILL ? "no answer in the time allowed: a loop without end?"
           : number == SIGSEGV                    ? "it crashed (segmentation fault): an index out of its range?"
           : number == SIGFPE                     ? "it crashed (a division of whole numbers by 0?)"
           : number != SIGABRT                    ? strsignal(number)
           : strstr(student.box.end.output, "Assertion")
               ? "it was aborted: an assertion failed, see there what it demands"
               : "it was aborted: a call of abort? Or memory was spoilt, and the C library says so";
}

/* The student's process has ended before its time. A sandbox says 128 + signal. */
static _Noreturn void conclude_end(void)
{
    box_finish(&student.box);
    const int status = student.box.end.status;
    const int code = WIFEXITED(status) ? WEXITSTATUS(status) : 0;
    const int number = WIFSIGNALED(status) ? WTERMSIG(status) : code > 128 ? code - 128 : 0;

    if (student.box.end.printed >= 1 << 20) mark_conclude(MARK_DIED, "it printed a million bytes");
    if (number == SIGXCPU || number == SIGKILL) mark_conclude(MARK_SLOW, why_it_ended(number));
    if (number) mark_conclude(MARK_DIED, why_it_ended(number));
    if (strstr(student.box.end.output, "Sanitizer") || strstr(student.box.end.output, "runtime error")) {
        mark_conclude(MARK_DIED, "a sanitizer has stopped it.");
    }
    if (!student.box.end.n) mark_conclude(MARK_DIED, "it ended before the test did: a call of exit?");
    mark_conclude(MARK_DIED, "it ended before the test did.");
}

/* When a question was asked: by the clock, by the process's time, by what others took of it. */
typedef struct asked {
    double at, used, kept;
} asked;

static asked ask_now(void)
{
    return student.said_hello ? (asked){box_now(), used(), kept_waiting()} : (asked){box_now(), 0, 0};
}

/* Waits for the socket; false: the process has ended. Time in which others had the processor is nobody's fault; time in
 * which it neither worked nor wanted to is. */
static bool wait_for(short events, asked since)
{
    const double asleep = fmin(10, 10 * student.cpu);
    char text[160];

    if (!box_wait(&student.box, student.fd, events)) {
        if (!student.box.end.late) return false;
        snprintf(text, sizeof text,
                 "no answer in %.0f s, of which it had the processor for %.3g s: the machine was busy; mark it again",
                 patience, student.said_hello ? used() : 0);
        mark_conclude(MARK_BUSY, text);
    }
    if (!student.said_hello) return true;
    const double now = used(), idle = box_now() - since.at - (now - since.used);
    if (now > student.cpu) mark_conclude(MARK_SLOW, why_it_ended(SIGXCPU));
    if (idle > asleep && idle - (kept_waiting() - since.kept) > asleep && sleeps()) {
        mark_conclude(MARK_SLOW, "no answer, and no work either: does it wait for something?");
    }
    return true;
}

/* The first byte comes with the process's number, which the kernel writes. */
static void hear_hello(void)
{
    union {
        char room[CMSG_SPACE(sizeof(struct ucred))];
        struct cmsghdr align;
    } control;
    char byte;
    struct iovec into = {&byte, 1};
    struct msghdr m = {.msg_iov = &into, .msg_iovlen = 1, .msg_control = &control, .msg_controllen = sizeof control};
    const asked since = ask_now();

    while (recvmsg(student.fd, &m, MSG_DONTWAIT) != 1) {
        if (!wait_for(POLLIN, since)) conclude_end();
    }
    for (struct cmsghdr *c = CMSG_FIRSTHDR(&m); c; c = CMSG_NXTHDR(&m, c)) {
        if (c->cmsg_type == SCM_CREDENTIALS) student.pid = ((struct ucred *)(void *)CMSG_DATA(c))->pid;
    }
    if (student.pid == 0 || clock_getcpuclockid(student.pid, &student.clock) != 0) {
        mark_conclude(MARK_DIED, "the clock of the student's process cannot be read");
    }
    student.said_hello = true;
}

/* All of it there, or back. */
static void move(void *at, size_t bytes, bool taken, asked since)
{
    for (char *c = at; bytes > 0;) {
        const ssize_t n = taken ? recv(student.fd, c, bytes, MSG_DONTWAIT)
                                : send(student.fd, c, bytes, MSG_DONTWAIT | MSG_NOSIGNAL);
        if (n > 0) {
            c += n;
            bytes -= (size_t)n;
        } else if (!wait_for(taken ? POLLIN : POLLOUT, since)) {
            conclude_end();
        }
    }
}

void mark_ask(ask_question question, size_t n, const mark_part parts[])
{
    ask_header h = {.question = question, .n = n};
    const asked since = ask_now();

    for (size_t i = 0; i < n; i++) {
        h.bytes[i] = parts[i].bytes;
        h.taken[i] = parts[i].taken;
    }
    move(&h, sizeof h, false, since);
    for (size_t i = 0; i < n; i++) {
        if (!parts[i].taken) move(parts[i].at, parts[i].bytes, false, since);
    }
    for (size_t i = 0; i < n; i++) {
        if (parts[i].taken) move(parts[i].at, parts[i].bytes, true, since);
    }
}

/* Nothing more will be asked: what the sanitizers say of its end counts. */
static void see_it_end(void)
{
    const asked since = ask_now();

    close(student.fd);
    student.fd = -1;
    while (wait_for(0, since))
        continue;
    if (student.box.end.status != 0) conclude_end();
    box_finish(&student.box);
}

static void start(void)
{
    int channel[2];
    const box_limits limits = {
        .cpu = student.cpu + 1, .wall = patience, .memory = student.sanitized ? 0 : (size_t)4 << 30, .file = 1 << 20};

    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, channel) != 0 ||
        setsockopt(channel[0], SOL_SOCKET, SO_PASSCRED, &(int){1}, sizeof(int)) != 0 ||
        !box_start(&student.box, &limits, student.words, channel[1])) {
        mark_conclude(MARK_DIED, "no process for the student's code");
    }
    student.fd = channel[0];
    student.said_hello = false;
    student.pid = 0;
    hear_hello();
    student.before = used();
}

extern void __asan_init(void) __attribute__((weak));

/* The student's program may be sanitized, and is if this one is, because they are built alike. */
_Noreturn void mark_claim_main(char *const words[], void (*check)(void))
{
    char seconds[250];

    box_end_with_us();
    student.secret = strtoull(words[1], NULL, 16);
    student.cpu = strtod(words[2], NULL);
    student.sanitized = &__asan_init || strcmp(words[3], "sanitized") == 0;
    student.words = words + 4;
    start();
    check();
    snprintf(seconds, sizeof seconds, "%.9f %s", used() - student.before, note);
    see_it_end();
    mark_conclude(MARK_HOLDS, seconds);
}
