/* mark_run: the supervisor's end of the socket. */
#include "mark_run.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

uint64_t mark_mix(uint64_t x)
{
    x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9;
    x = (x ^ x >> 27) * 0x94d049bb133111eb;
    return x ^ x >> 31;
}

uint64_t mark_proof(uint64_t key, uint64_t number)
{
    return mark_mix(mark_mix(key) + number);
}

uint64_t mark_random(void)
{
    uint64_t x = 0;

    while (x == 0) {
        if (getrandom(&x, sizeof x, 0) != (ssize_t)sizeof x) abort();
    }
    return x;
}

box_limits mark_limits(void)
{
    const char *given = getenv("BIS_CLAIM_SECONDS");
    const double seconds = given ? strtod(given, NULL) : 20;

    return (box_limits){.cpu = seconds, .wall = 6 * seconds, .file = 1 << 20};
}

typedef struct talk {
    int fd;
    uint64_t key, number;
    bool asked, proved, wrong;
    mark_outcome *o;
} talk;

static void hear(void *state)
{
    talk *t = state;
    mark_message m;
    ssize_t got;

    while ((got = recv(t->fd, &m, sizeof m, MSG_DONTWAIT)) == (ssize_t)sizeof m) {
        m.text[sizeof m.text - 1] = '\0';
        if (m.kind == MARK_SAYS_DONE && !t->asked) {
            t->asked = true;
            t->number = mark_random();
            t->o->seconds = m.seconds;
            send(t->fd, &t->number, sizeof t->number, MSG_NOSIGNAL | MSG_DONTWAIT);
        } else if (m.kind == MARK_SAYS_PROOF && t->asked) {
            t->proved |= m.proof == mark_proof(t->key, t->number);
        } else if (m.kind == MARK_SAYS_WRONG) {
            t->wrong = true;
            snprintf(t->o->text, sizeof t->o->text, "%s", m.text);
        }
    }
}

static const char *why_it_ended(const box_end *end, const talk *t)
{
    if (end->printed >= 1 << 20) return "it printed a million bytes";
    if (end->late) return "no answer, and little work either: does it wait for something?";
    if (WIFSIGNALED(end->status)) {
        const int number = WTERMSIG(end->status);
        return number == SIGXCPU || number == SIGKILL ? "no answer in the time allowed: a loop without end?"
               : number == SIGSEGV                    ? "it crashed (segmentation fault): an index out of its range?"
               : number == SIGABRT                    ? "it was aborted: an assertion failed, see there what it demands"
                                                      : strsignal(number);
    }
    /* A sandbox says 128 + signal. */
    const int status = WEXITSTATUS(end->status);
    if (status == 128 + SIGXCPU || status == 128 + SIGKILL) return "no answer in the time allowed: a loop without end?";
    if (status == 128 + SIGSEGV) return "it crashed (segmentation fault): an index out of its range?";
    if (status == 128 + SIGABRT) return "it was aborted: an assertion failed, see there what it demands";
    if (!t->asked && !end->n) return "it ended before the test did: a call of exit?";
    return end->n ? NULL : "it ended without a word";
}

void mark_judge(mark_outcome *o, const mark_order *order)
{
    char number[24];
    const char *words[64];
    size_t n = 0;
    int channel[2];
    talk t = {.key = mark_random(), .o = o};
    box_end end;

    *o = (mark_outcome){.verdict = MARK_DIED};
    snprintf(number, sizeof number, "%zu", order->claim);
    for (const char *const *word = order->before; word && *word && n < 60; word++)
        words[n++] = *word;
    words[n++] = order->program;
    words[n++] = order->claim == MARK_WORK ? "--work" : "--claim";
    words[n++] = number;
    words[n] = NULL;
    if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, channel) != 0) return;
    t.fd = channel[0];
    send(t.fd, &(mark_greeting){order->secret, t.key}, sizeof(mark_greeting), MSG_NOSIGNAL);
    const bool ran = box_run(&end, &order->limits, (char *const *)(uintptr_t)words, channel, hear, &t);
    close(channel[0]);
    if (!ran) {
        snprintf(o->text, sizeof o->text, "no process for the test");
        return;
    }
    if (t.proved && !end.late && WIFEXITED(end.status) && WEXITSTATUS(end.status) == MARK_STATUS_HOLDS) {
        o->verdict = MARK_HOLDS;
        return;
    }
    const char *why = t.wrong ? NULL : why_it_ended(&end, &t);
    if (t.wrong)
        o->verdict = MARK_WRONG;
    else
        o->text[0] = '\0';
    if (end.n)
        snprintf(o->text + strlen(o->text), sizeof o->text - strlen(o->text), "%s%.2000s",
                 t.wrong ? "\nIt printed: " : "", end.output);
    if (why) snprintf(o->text + strlen(o->text), sizeof o->text - strlen(o->text), "%s%s", end.n ? "\n" : "", why);
}
