/* SPDX-License-Identifier: BSD-2-Clause */
/* grade: what scripts/course/grade.sh has done by a program without a student's code in it: compile in a sandbox, judge
 * the claims, compare speeds, read hand-ins.
 *     grade run [-d DIR] [-c SECONDS] [-r PATH]... [-w PATH]... -- CMD
 *         run CMD in DIR; it may read PATHs (-r) and write there (-w)
 *     grade claims [-a] [-s SECRET]... [-k MARKS] STUDENT CLAIMS
 *         a line a claim of CLAIMS, which asks STUDENT: "ok" or "wrong", points, name, message, with tabs between.
 *         -a: STUDENT is sanitized; -k: only what MARKS, such lines, has as ok. A second secret is tried where a claim
 *         is wrong by the first
 *     grade speed [-s SECRET]... STUDENT OURS CLAIMS
 *         how many times OURS's time STUDENT takes for the load of CLAIMS; status 1 and why: its answers are wrong
 *     grade look TEMPLATE FILE [PRINTS [PLAIN FOLDER...]]
 *         status 3: something of ours is changed; 4: it cannot be read; 5: a line is refused. Hashes for `alike` go to
 *         PRINTS, and what is left without comments to PLAIN. "x.h" of an #include must lie in a FOLDER
 *     grade alike SHARE BLANK FILE...
 *         a line "LEAST MOST I J ..." for each group of PRINTS (counted from 1), in which each shares so much of what
 *         BLANK has not with another one: the least and the most percent of the shorter one that two of them share
 * BIS_SANDBOX says which sandbox (bwrap, none); BIS_CLAIM_SECONDS is kept. All that runs has an empty environment, no
 * terminal, and limits of time, memory and files. */
#include "mark_run.h"
#include "tokens.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

enum { MAX_WORDS = 400, NOT_JUDGED = 75 /* exit status: the machine was busy (EX_TEMPFAIL of sysexits.h) */ };

typedef struct options {
    const char *folder, *marks;
    const char *read[16], *write[16];
    size_t n_read, n_write, n_secrets;
    uint64_t secrets[2];
    double cpu;
    bool sanitized;
} options;

static bool has_bwrap(void)
{
    const char *chosen = getenv("BIS_SANDBOX");

    return chosen && strcmp(chosen, "bwrap") == 0;
}

/* The words of the sandbox: the system's programs and libraries, o->read and o->write at their places, nothing else; no
 * network, other processes, rights. */
static size_t sandbox(const char **words, const options *o)
{
    static const char *const base[] = {
        "bwrap", "--unshare-all", "--die-with-parent", "--new-session", "--cap-drop", "ALL",
        "--ro-bind", "/usr", "/usr",
        "--ro-bind-try", "/bin", "/bin",
        "--ro-bind-try", "/lib", "/lib",
        "--ro-bind-try", "/lib32", "/lib32",
        "--ro-bind-try", "/lib64", "/lib64",
        "--ro-bind-try", "/etc/ld.so.cache", "/etc/ld.so.cache",
        "--ro-bind-try", "/etc/alternatives", "/etc/alternatives",
        "--proc", "/proc", "--dev", "/dev", "--size", "67108864", "--tmpfs", "/tmp"};
    size_t n = 0;

    if (!has_bwrap()) return 0;
    for (size_t i = 0; i < sizeof base / sizeof *base; i++)
        words[n++] = base[i];
    for (size_t i = 0; i < o->n_read + o->n_write; i++) {
        const bool reads = i < o->n_read;
        words[n++] = reads ? "--ro-bind" : "--bind";
        words[n] = words[n + 1] = reads ? o->read[i] : o->write[i - o->n_read];
        n += 2;
    }
    words[n++] = "--chdir";
    words[n++] = o->folder ? o->folder : "/";
    words[n++] = "--";
    return n;
}

/* PATH alone stays of the environment. */
static void poor_environment(void)
{
    char path[4096], which[16], scratch[4096], seconds[32];

    snprintf(path, sizeof path, "%s", getenv("PATH") ? getenv("PATH") : "/usr/bin:/bin");
    snprintf(which, sizeof which, "%s", has_bwrap() ? "bwrap" : "none");
    snprintf(scratch, sizeof scratch, "%s", !has_bwrap() && getenv("TMPDIR") ? getenv("TMPDIR") : "/tmp");
    snprintf(seconds, sizeof seconds, "%s", getenv("BIS_CLAIM_SECONDS") ? getenv("BIS_CLAIM_SECONDS") : "20");
    clearenv();
    setenv("BIS_CLAIM_SECONDS", seconds, 1);
    setenv("PATH", path, 1);
    setenv("BIS_SANDBOX", which, 1);
    setenv("TMPDIR", scratch, 1);
    setenv("HOME", "/", 1);
    setenv("LC_ALL", "C", 1);
    setenv("CCACHE_DISABLE", "1", 1);
    setenv("OMP_NUM_THREADS", "1", 1);
    /* without a sandbox no program may be run to find the names of functions (scripts/course/server.c) */
    char asan[128];
    snprintf(asan, sizeof asan, "hard_rss_limit_mb=2000:allocator_may_return_null=1:color=never%s",
             has_bwrap() ? "" : ":external_symbolizer_path=");
    setenv("ASAN_OPTIONS", asan, 1);
}

/* The limits are of the processor's time, because the machine may have other work; the clock's only ends what no other
 * limit does. */
static int run(options *o, char **given)
{
    box_limits limits = {.cpu = 15, .wall = 600, .memory = (size_t)1 << 30, .file = 64 << 20};
    static box b;
    const char *words[MAX_WORDS];
    size_t n = sandbox(words, o);

    if (o->cpu > 0) {
        limits.cpu = o->cpu;
        limits.memory = (size_t)4 << 30;
    }
    while (*given && n + 1 < MAX_WORDS)
        words[n++] = *given++;
    words[n] = NULL;
    if (!has_bwrap() && o->folder && chdir(o->folder) != 0) return 1;
    if (!box_run(&b, &limits, (char *const *)(uintptr_t)words)) return 1;
    fwrite(b.end.output, 1, b.end.n, stdout);
    const bool killed = !b.end.late && (!WIFEXITED(b.end.status) || WEXITSTATUS(b.end.status) > 128);
    if (b.end.late) printf("\nstopped after %g s: the machine was busy; mark it again\n", limits.wall);
    if (killed) printf("\nstopped after %g s of the processor\n", limits.cpu);
    if (b.end.late) return NOT_JUDGED;
    return WIFEXITED(b.end.status) ? WEXITSTATUS(b.end.status) : 124;
}

/* ---- claims and speed ---- */

/* One claim of OURS, which asks the program `student` in the sandbox. */
static void judge(mark_outcome *result, const char *student, const char *ours, const options *given, size_t claim,
                  uint64_t secret)
{
    const char *words[MAX_WORDS];
    options o = *given;

    o.read[o.n_read++] = student;
    const size_t n = sandbox(words, &o);
    words[n] = student;
    words[n + 1] = NULL;
    mark_judge(result, &(mark_order){.judge = ours,
                                     .student = words,
                                     .claim = claim,
                                     .secret = secret,
                                     .cpu = (o.cpu > 0 ? o.cpu : mark_seconds()) * (o.sanitized ? 3 : 1),
                                     .sanitized = o.sanitized});
    for (char *c = result->text; *c; c++) {
        if (*c < ' ' || *c > '~') *c = ' '; /* one line, and valid in JSON, whatever the student prints */
    }
}

/* Is the claim of number `i` to be looked at? `marks`: lines of an earlier run. */
static bool wanted(FILE *marks)
{
    char line[8192];

    return !marks || (fgets(line, sizeof line, marks) && strncmp(line, "ok\t", 3) == 0);
}

static int claims(options *o, const char *student, const char *ours)
{
    char command[4200], line[512], name[400];
    FILE *marks = o->marks ? fopen(o->marks, "r") : NULL;
    int points, died = 0, status = 0;

    snprintf(command, sizeof command, "'%s' --list", ours);
    FILE *list = popen(command, "r");
    if (!list) return 1;
    for (size_t i = 0; fgets(line, sizeof line, list); i++) {
        static mark_outcome result;
        if (sscanf(line, "%d\t%399[^\n]", &points, name) != 2) return 1;
        if (!wanted(marks)) {
            printf("left\t%d\t%s\t\n", points, name);
            continue;
        }
        judge(&result, student, ours, o, i, o->secrets[0]);
        if (result.verdict == MARK_WRONG && o->n_secrets > 1) judge(&result, student, ours, o, i, o->secrets[1]);
        /* who has let two of them run out of time will not get all of it for the others */
        died += result.verdict == MARK_SLOW;
        if (result.verdict == MARK_BUSY) status = NOT_JUDGED;
        if (died == 2 && o->cpu > 1) o->cpu = 1;
        printf("%s\t%d\t%s\t%s\n", result.verdict == MARK_HOLDS ? "ok" : "wrong", points, name, result.text);
        fflush(stdout);
    }
    pclose(list);
    if (marks) fclose(marks);
    return status;
}

/* The least processor times, taken in turn until neither has fallen by 2 % for three rounds, or ten where the ratio is
 * near to a limit of the points: what else the machine does adds to a time, and never takes from it. Who takes more
 * than 6 times our time, or 20 s in all, is not asked for ever. What the load gives is looked at each time. */
static int speed(const options *o, const char *student, const char *reference, const char *ours)
{
    static mark_outcome result;
    double least[2] = {HUGE_VAL, HUGE_VAL}, sum = 0, ratio = 0;
    uint64_t secret = o->secrets[0];
    int quiet = 0;

    judge(&result, student, ours, o, MARK_WORK, secret);
    if (result.verdict == MARK_WRONG && o->n_secrets > 1) secret = o->secrets[1];
    for (int round = 0; round < 60; round++) {
        quiet++;
        for (int who = 0; who < 2; who++) {
            judge(&result, who ? reference : student, ours, o, MARK_WORK, secret);
            if (result.verdict != MARK_HOLDS) {
                puts(result.text);
                return result.verdict == MARK_BUSY ? NOT_JUDGED : 1;
            }
            if (result.seconds < 0.98 * least[who]) quiet = 0;
            sum += result.seconds;
            least[who] = fmin(least[who], result.seconds);
        }
        ratio = least[0] / least[1];
        const bool near = (ratio > 1.2 && ratio < 2) || (ratio > 2.5 && ratio < 3.7);
        if (quiet >= (near ? 10 : 3) || (round >= 3 && (sum > 20 || ratio > 6))) break;
    }
    printf("%.2f\n", ratio);
    return 0;
}

/* ---- hand-ins as text ---- */

static int look(const char *ours, const char *path, const char *prints, char *const *plain)
{
    token_file template, f;
    unsigned line = 0;
    char text[200];
    int status = 0;

    if (!tokens_read(&template, ours, true)) {
        fprintf(stderr, "%s: %s\n", ours, template.fault);
        return 1;
    }
    if (!tokens_read(&f, path, false)) {
        printf("%s\n", f.fault);
        return 4;
    }
    if (!tokens_compare(&f, &template, &line)) {
        printf("what is line %u in the kit is missing or changed\n", line);
        status = 3;
    } else if (tokens_refuse(&f, &template, *plain ? plain + 1 : plain, text, sizeof text)) {
        printf("%s\n", text);
        status = 5;
    } else if (*plain && !tokens_write(&f, *plain)) {
        return 1;
    }
    FILE *out = prints && status == 0 ? fopen(prints, "w") : NULL;
    if (out) {
        uint64_t *p;
        const size_t n = tokens_prints(&f, &template, &p);
        for (size_t i = 0; i < n; i++)
            fprintf(out, "%016llx\n", (unsigned long long)p[i]);
        free(p);
        fclose(out);
    }
    tokens_clear(&f);
    tokens_clear(&template);
    return status;
}

typedef struct print_set {
    uint64_t *p;
    size_t n;
} print_set;

static int by_value(const void *a, const void *b)
{
    const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;

    return (x > y) - (x < y);
}

static bool holds(const print_set *s, uint64_t p)
{
    return s->n > 0 && bsearch(&p, s->p, s->n, sizeof p, by_value);
}

/* Without those of `template`. */
static print_set read_prints(const char *path, const print_set *template)
{
    print_set s = {0};
    unsigned long long x;
    size_t room = 0, n = 0;
    FILE *f = fopen(path, "r");

    while (f && fscanf(f, "%llx", &x) == 1) {
        if (template && holds(template, x)) continue;
        if (s.n == room) {
            room = 2 * room + 64;
            uint64_t *more = realloc(s.p, room * sizeof *more);
            if (!more) break;
            s.p = more;
        }
        s.p[s.n++] = x;
    }
    if (f) fclose(f);
    if (s.n) qsort(s.p, s.n, sizeof *s.p, by_value);
    for (size_t i = 0; i < s.n; i++) {
        if (i == 0 || s.p[i] != s.p[i - 1]) s.p[n++] = s.p[i];
    }
    s.n = n;
    return s;
}

/* How much of the shorter one both have: what a copyist adds changes nothing. Of too little, nobody can tell: 0. */
static double in_common(const print_set *a, const print_set *b)
{
    enum { FEWEST = 12 };
    size_t both = 0;

    if (a->n < FEWEST || b->n < FEWEST) return 0;
    for (size_t j = 0; j < a->n; j++)
        both += holds(b, a->p[j]);
    return (double)both / (double)(a->n < b->n ? a->n : b->n);
}

/* Groups in which each is like another one: group[i] is the first of those that i is with. */
static void join(int *group, int n, int a, int b)
{
    const int first = group[a] < group[b] ? group[a] : group[b], other = group[a] + group[b] - first;

    for (int i = 0; i < n; i++)
        if (group[i] == other) group[i] = first;
}

static int alike(double share, const char *blank, char **paths, int n)
{
    const print_set template = read_prints(blank, NULL);
    print_set *sets = calloc((size_t)n + 1, sizeof *sets);
    int *group = calloc((size_t)n + 1, sizeof *group);
    double *least = calloc((size_t)n + 1, sizeof *least), *most = calloc((size_t)n + 1, sizeof *most);

    if (!sets || !group || !least || !most) return 1;
    for (int i = 0; i < n; i++) {
        sets[i] = read_prints(paths[i], &template);
        group[i] = i;
    }
    for (int pass = 0; pass < 2; pass++) { /* who is with whom; then how much they share */
        for (int i = 0; i < n; i++) {
            for (int k = i + 1; k < n; k++) {
                const int g = group[i];
                if (pass == 1 && group[k] != g) continue;
                const double both = in_common(&sets[i], &sets[k]);
                if (pass == 0 && both >= share) join(group, n, i, k);
                if (pass == 1 && (most[g] == 0 || both < least[g])) least[g] = both;
                if (pass == 1) most[g] = fmax(most[g], both);
            }
        }
    }
    for (int g = 0; g < n; g++) {
        if (most[g] == 0) continue;
        printf("%.0f %.0f", 100 * least[g], 100 * most[g]);
        for (int i = 0; i < n; i++)
            if (group[i] == g) printf(" %d", i + 1);
        puts("");
    }
    for (int i = 0; i < n; i++)
        free(sets[i].p);
    free(sets);
    free(group);
    free(least);
    free(most);
    free(template.p);
    return 0;
}

int main(int argc, char **argv)
{
    options o = {0};
    int c;

    if (argc < 2) return 2;
    const char *mode = argv[1];
    argc--, argv++;
    while ((c = getopt(argc, argv, "+ad:r:w:s:c:k:")) != -1) {
        if (c == 'a')
            o.sanitized = true;
        else if (c == 'd')
            o.folder = optarg;
        else if (c == 'r' && o.n_read < 12)
            o.read[o.n_read++] = optarg;
        else if (c == 'w' && o.n_write < 12)
            o.write[o.n_write++] = optarg;
        else if (c == 's' && o.n_secrets < 2)
            o.secrets[o.n_secrets++] = strtoull(optarg, NULL, 16);
        else if (c == 'c')
            o.cpu = strtod(optarg, NULL);
        else if (c == 'k')
            o.marks = optarg;
        else
            return 2;
    }
    argv += optind, argc -= optind;
    if (strcmp(mode, "look") == 0 && argc >= 2) return look(argv[0], argv[1], argv[2], argv + (argc > 3 ? 3 : argc));
    if (strcmp(mode, "alike") == 0 && argc >= 2) return alike(strtod(argv[0], NULL), argv[1], argv + 2, argc - 2);
    box_end_with_us();
    poor_environment();
    if (strcmp(mode, "run") == 0 && argc > 0) return run(&o, argv);
    if (strcmp(mode, "claims") == 0 && argc == 2) return claims(&o, argv[0], argv[1]);
    if (strcmp(mode, "speed") == 0 && argc == 3) return speed(&o, argv[0], argv[1], argv[2]);
    return 2;
}
