/* SPDX-License-Identifier: BSD-2-Clause */
/* display: a viewer that speaks tev's protocol by its published layout: what it gets is the picture; and a viewer that
 * is missing, goes, or never reads stops nothing. */
#include "bis/files/image_file.h"
#include "cli/display.h"
#include "claim.h"
#include "lack.h"
#include "program.h"

#include <arpa/inet.h>
#include <dlfcn.h>
#include <errno.h>
#include <netdb.h>
#include <poll.h>
#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#define DIR "build/test_display"
#define SCENE DIR "/scene.txt"
#define BIG DIR "/big.txt" /* nothing but light: 23 MB at once */

static int make_scene(void **state)
{
    program_folder(DIR);
    program_write_scene(DIR, "Sampler \"stratified\" \"integer pixelsamples\" 4\n");
    program_write_file(BIG, "Film \"rgb\" \"integer xresolution\" 1600 \"integer yresolution\" 1200 Sampler \"sobol\" "
                            "\"integer pixelsamples\" 1 WorldBegin LightSource \"infinite\" \"rgb L\" [1 2 3]\n");
    return 0;
}

/* ---- the viewer ---- */

typedef enum behaviour { READS, LEAVES, NEVER_READS } behaviour;

typedef struct viewer {
    behaviour behaviour;
    int listener, port;
    pthread_t thread;
    unsigned char *data;
    size_t n, capacity;
    atomic_int connections;
} viewer;

static void *serve(void *arg)
{
    viewer *v = arg;
    struct pollfd ready = {.fd = v->listener, .events = POLLIN};
    if (poll(&ready, 1, 20000) != 1) return NULL;
    const int fd = accept(v->listener, NULL, NULL);
    v->connections = fd >= 0;
    for (ssize_t got = 1; fd >= 0 && got > 0 && v->behaviour != NEVER_READS;) {
        if (v->n + 65536 > v->capacity) v->data = realloc(v->data, v->capacity = 2 * v->capacity + 65536);
        got = read(fd, v->data + v->n, 65536);
        if (got > 0) v->n += (size_t)got;
        if (v->behaviour == LEAVES && v->n > 100) break;
    }
    if (v->behaviour == NEVER_READS) { /* until the listener is shut down */
        ready.events = POLLIN;
        poll(&ready, 1, 20000);
    }
    if (fd >= 0) close(fd);
    return NULL;
}

static void open_viewer(viewer *v, behaviour b)
{
    struct sockaddr_in at = {.sin_family = AF_INET, .sin_addr = {htonl(INADDR_LOOPBACK)}};
    socklen_t size = sizeof at;
    *v = (viewer){.behaviour = b, .listener = socket(AF_INET, SOCK_STREAM, 0)};
    assert_int_equal(bind(v->listener, (struct sockaddr *)&at, sizeof at), 0);
    assert_int_equal(listen(v->listener, 1), 0);
    assert_int_equal(getsockname(v->listener, (struct sockaddr *)&at, &size), 0);
    v->port = ntohs(at.sin_port);
    assert_int_equal(pthread_create(&v->thread, NULL, serve, v), 0);
}

/* Whoever has connected is waited for, because a shut listener loses what it has not yet taken. */
static void close_viewer(viewer *v)
{
    for (int k = 0; k < 20000 && !v->connections; k++) usleep(1000);
    shutdown(v->listener, SHUT_RDWR);
    pthread_join(v->thread, NULL);
    close(v->listener);
}

/* ---- what came, read by tev's layout ---- */

typedef struct reader {
    const unsigned char *at, *end;
} reader;

static uint32_t take_int(reader *r)
{
    assert_true(r->end - r->at >= 4);
    const unsigned char *b = r->at;
    r->at += 4;
    return (uint32_t)b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 | (uint32_t)b[3] << 24;
}

static const char *take_text(reader *r)
{
    const char *text = (const char *)r->at;
    const unsigned char *zero = memchr(r->at, 0, (size_t)(r->end - r->at));
    assert_non_null(zero);
    r->at = zero + 1;
    return text;
}

/* The image as the messages have made it; returns how many updates there were. */
static int read_messages(const viewer *v, float **pixels, int *width, int *height, const char *name)
{
    int updates = 0;
    *pixels = NULL;
    for (size_t n = 0; n < v->n;) {
        reader r = {v->data + n, v->data + v->n};
        const uint32_t length = take_int(&r);
        assert_true(length >= 6 && length <= v->n - n);
        r.end = v->data + n + length;
        n += length;
        const int kind = *r.at++;
        assert_true(*r.at++ == 0); /* the focus is left alone */
        assert_string_equal(take_text(&r), name);
        if (!*pixels) {
            assert_int_equal(kind, 4); /* create comes first */
            *width = (int)take_int(&r);
            *height = (int)take_int(&r);
            assert_int_equal(take_int(&r), 3);
            for (int i = 0; i < 3; i++) assert_string_equal(take_text(&r), &"R\0G\0B"[2 * i]);
            *pixels = calloc((size_t)(*width * *height) * 3, sizeof **pixels);
        } else {
            assert_int_equal(kind, 3);
            updates++;
            const char *channel = take_text(&r);
            const int c = (int)(strchr("RGB", channel[0]) - "RGB");
            assert_true(c >= 0 && c < 3 && !channel[1]);
            const int x0 = (int)take_int(&r), y0 = (int)take_int(&r), w = (int)take_int(&r), h = (int)take_int(&r);
            assert_true(x0 >= 0 && y0 >= 0 && x0 + w <= *width && y0 + h <= *height);
            assert_int_equal(r.end - r.at, 4 * w * h);
            for (int i = 0; i < w * h; i++) {
                const uint32_t bits = take_int(&r);
                memcpy(&(*pixels)[3 * ((y0 + i / w) * *width + x0 + i % w) + c], &bits, 4);
            }
        }
        assert_true(r.at == r.end);
    }
    return updates;
}

/* ---- a connection that is slow, without waiting ---- */

/* This program's own send and poll, which the library calls: after the first message each piece of at most 1000 bytes
 * is taken after so many refusals, by turns because the connection is full and because a signal came. To wait for it
 * takes no time. */
static struct {
    atomic_bool is_on, breaks; /* breaks: instead of all that, with another reason from the second time on */
    atomic_int refusals, calls, refused, waits;
} slow;

static void slow_down(int refusals)
{
    slow.refusals = refusals;
    slow.calls = slow.refused = slow.waits = 0;
    slow.is_on = true;
}

ssize_t send(int fd, const void *data, size_t n, int flags)
{
    if (slow.is_on && slow.calls++ > 0) {
        if (slow.breaks) {
            errno = slow.calls == 2 ? ECONNRESET : EPIPE;
            return -1;
        }
        if (slow.refused < slow.refusals) {
            errno = slow.refused++ % 2 ? EINTR : EAGAIN;
            return -1;
        }
        slow.refused = 0;
        if (n > 1000) n = 1000;
    }
    return sendto(fd, data, n, flags, NULL, 0);
}

int poll(struct pollfd *of, nfds_t n, int ms)
{
    if (slow.is_on && ms == 100) {
        slow.waits++;
        return 0;
    }
    const struct timespec t = {ms / 1000, ms % 1000 * 1000000L};
    return ppoll(of, n, ms < 0 ? NULL : &t, NULL);
}

/* This program's own resolver, which the library calls: it answers when it is told to. */
static struct {
    atomic_bool hangs, is_asked, has_answered;
} resolver;

int getaddrinfo(const char *restrict host, const char *restrict port, const struct addrinfo *restrict hints,
    struct addrinfo **restrict all)
{
    static int (*real)(const char *, const char *, const struct addrinfo *, struct addrinfo **);
    if (!real) *(void **)&real = dlsym(RTLD_NEXT, "getaddrinfo");
    resolver.is_asked = true;
    for (int k = 0; k < 60000 && resolver.hangs; k++) usleep(1000);
    const int answer = real(host, port, hints, all);
    resolver.has_answered = true;
    return answer;
}

/* This program's own clock, which the library reads: once it is set, it stands where it was put, and goes on by `step`
 * seconds whenever somebody reads it. A thread has used `used` seconds of a processor. */
static struct {
    atomic_bool is_set;
    atomic_int now, step, used, readings; /* of what a thread has used */
} watch;

int clock_gettime(clockid_t of, struct timespec *t)
{
    static int (*real)(clockid_t, struct timespec *);
    if (!real) *(void **)&real = dlsym(RTLD_NEXT, "clock_gettime");
    if (!watch.is_set || (of != CLOCK_MONOTONIC && of != CLOCK_THREAD_CPUTIME_ID)) return real(of, t);
    *t = (struct timespec){of == CLOCK_MONOTONIC ? atomic_fetch_add(&watch.now, watch.step) : watch.used, 0};
    watch.readings += of == CLOCK_THREAD_CPUTIME_ID;
    return 0;
}

/* A film of one pass, each value another. */
static void make_film(bis_film *f)
{
    static const double whole[4] = {0, 1, 0, 1};
    assert_int_equal(bis_film_init(f, 24, 20, whole, (bis_loc){0}, NULL), BIS_OK);
    for (int y = 0; y < 20; y++)
        for (int x = 0; x < 24; x++) {
            const float v = (float)(3 * (24 * y + x));
            bis_film_add(f, x, y, (rgb){v, v + 1, v + 2}, 1, 1);
        }
    bis_film_end_pass(f, 1);
}

/* At the end a viewer has a second for each piece: 10 waits of a tenth are not too many, again and again; after 11 it
 * reads no more. While the render goes on it may take its time. */
static void a_slow_viewer_has_a_second_for_each_piece_at_the_end(void **state)
{
    static const struct {
        int refusals;
        bool meanwhile, arrives;
    } cases[] = {{0, false, true}, {10, false, true}, {11, false, false}, {1000000, false, false}, {500, true, true}};
    bis_film f;
    make_film(&f);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        viewer v;
        bis_display *d;
        bis_diag diag = {0};
        float *shown;
        char where[64];
        int width = 0, height = 0;
        open_viewer(&v, READS);
        snprintf(where, sizeof where, "127.0.0.1:%d", v.port);
        slow_down(cases[i].refusals);
        assert_int_equal(bis_display_open(&d, where, "slow", &f, NULL), BIS_OK);
        if (cases[i].meanwhile) {
            while (slow.calls < 2) bis_display_offer(d, &f); /* until the viewer is met */
            while (slow.waits < 9 * 500) sched_yield(); /* nine pieces, the last of which is then sent */
        }
        bis_display_close(d, cases[i].meanwhile ? NULL : &f, &diag);
        slow.is_on = false;
        close_viewer(&v);
        if (cases[i].arrives) {
            assert_int_equal(diag.n, 0);
            assert_int_equal(read_messages(&v, &shown, &width, &height, "slow"), 6); /* 16 rows and 4, of 3 channels */
            assert_true(width == 24 && height == 20);
            for (int k = 0; k < 3 * 24 * 20; k++) assert_true(shown[k] == (float)k);
            free(shown);
            if (!cases[i].meanwhile) /* 16 rows are two pieces, 4 rows are one */
                assert_int_equal(slow.waits, 9 * cases[i].refusals);
        } else {
            assert_int_equal(diag.n, 1);
            assert_non_null(strstr(diag.messages[0].text, "it reads no more; the render went on without"));
            assert_int_equal(slow.waits, 11);
        }
        bis_diag_clear(&diag);
        free(v.data);
    }
    bis_film_clear(&f);
}

/* To copy and send two million pixels takes more than a share of the time that has passed. What comes right after the
 * first picture must wait for its share. */
static void the_first_picture_waits_for_nothing(void **state)
{
    static const double whole[4] = {0, 1, 0, 1};
    bis_film f;
    viewer v;
    bis_display *d;
    bis_diag diag = {0};
    char where[64];
    float *shown;
    int width = 0, height = 0;
    assert_int_equal(bis_film_init(&f, 1600, 1200, whole, (bis_loc){0}, NULL), BIS_OK);
    const size_t n = (size_t)f.width * (size_t)f.height;
    float *rgba = calloc(n, 4 * sizeof *rgba);
    for (size_t i = 0; i < 4 * n; i++) rgba[i] = i % 4 == 3 ? 1 : (float)(i % 9973);
    open_viewer(&v, READS);
    snprintf(where, sizeof where, "127.0.0.1:%d", v.port);
    assert_int_equal(bis_display_open(&d, where, "first", &f, NULL), BIS_OK);
    bis_display_offer_pixels(d, rgba);
    bis_display_offer_pixels(d, rgba);
    bis_display_close(d, NULL, &diag);
    close_viewer(&v);
    assert_int_equal(diag.n, 0);
    assert_int_equal(read_messages(&v, &shown, &width, &height, "first"), 3 * 1200 / 16);
    for (size_t i = 0; i < n; i++)
        for (size_t c = 0; c < 3; c++) assert_true(shown[3 * i + c] == rgba[4 * i + c]);
    free(shown);
    free(rgba);
    free(v.data);
    bis_film_clear(&f);
}

/* Offers pictures so many seconds after the display was opened, and returns how many it has sent. The copy of one takes
 * `copying` seconds; the thread has used `used` seconds by the time it has sent it, which it says then. */
typedef struct offer {
    int now, copying, used;
} offer;

static int pictures_sent(const offer *offers, int n)
{
    viewer v;
    bis_film f;
    bis_display *d;
    char where[64];
    float *shown, rgba[24 * 20 * 4] = {0};
    int width = 0, height = 0;
    make_film(&f);
    open_viewer(&v, READS);
    snprintf(where, sizeof where, "127.0.0.1:%d", v.port);
    watch.now = 1000;
    watch.step = watch.used = watch.readings = 0;
    watch.is_set = true;
    const bis_status status = bis_display_open(&d, where, "share", &f, NULL);
    for (int i = 0; i < n; i++) {
        watch.now = 1000 + offers[i].now;
        watch.step = offers[i].copying;
        watch.used = offers[i].used;
        bis_display_offer_pixels(d, rgba);
        for (int k = 0; k < 5000 && i + 1 < n && watch.readings == i; k++) usleep(1000);
    }
    watch.is_set = false;
    bis_display_close(d, NULL, NULL);
    close_viewer(&v);
    assert_int_equal(status, BIS_OK);
    const int updates = read_messages(&v, &shown, &width, &height, "share");
    free(shown);
    free(v.data);
    bis_film_clear(&f);
    return updates / 6; /* 16 rows and 4, of 3 channels */
}

/* All copying and sending, and once more as much as the last picture took, may take 2 % of the time. The first one
 * takes 1 s and 3 s: 1 + 3 + 1 + 3 s are 2 % of 400. The second takes 2 s and 1 s: 3 + 4 + 2 + 1 s are 2 % of 500. */
static void pictures_wait_for_their_share_of_the_time(void **state)
{
    const offer first = {5, 1, 3}, second = {401, 2, 4};
    assert_int_equal(pictures_sent((offer[]){first, {399, 0, 4}}, 2), 1);
    assert_int_equal(pictures_sent((offer[]){first, {401, 0, 4}}, 2), 2);
    assert_int_equal(pictures_sent((offer[]){first, second, {499, 0, 5}}, 3), 2);
    assert_int_equal(pictures_sent((offer[]){first, second, {501, 0, 5}}, 3), 3);
}

/* Once a connection has broken nothing is sent any more, and the first reason is the one that is told. */
static void nothing_is_sent_to_a_viewer_that_has_gone(void **state)
{
    bis_film f;
    viewer v;
    bis_display *d;
    bis_diag diag = {0};
    char where[64], expected[256];
    make_film(&f);
    open_viewer(&v, READS);
    snprintf(where, sizeof where, "127.0.0.1:%d", v.port);
    slow_down(0);
    slow.breaks = true;
    assert_int_equal(bis_display_open(&d, where, "broken", &f, NULL), BIS_OK);
    bis_display_close(d, &f, &diag);
    slow.is_on = slow.breaks = false;
    close_viewer(&v);
    assert_int_equal(slow.calls, 2);
    assert_int_equal(diag.n, 1);
    assert_int_equal(diag.n_errors, 0);
    snprintf(expected, sizeof expected, "--display %s: %s; the render went on without", where, strerror(ECONNRESET));
    assert_non_null(strstr(diag.messages[0].text, expected));
    bis_diag_clear(&diag);
    bis_film_clear(&f);
    free(v.data);
}

/* A name server that says nothing for a minute: the render's side leaves before, and the thread cleans up when it
 * hears. */
static void a_name_server_that_is_silent_is_not_waited_for(void **state)
{
    bis_film f;
    viewer v;
    bis_display *d;
    bis_diag diag = {0};
    char where[64];
    make_film(&f);
    for (int hangs = 0; hangs < 2; hangs++) {
        open_viewer(&v, READS);
        snprintf(where, sizeof where, "127.0.0.1:%d", v.port);
        resolver.is_asked = resolver.has_answered = false;
        resolver.hangs = hangs;
        assert_int_equal(bis_display_open(&d, where, "slow", &f, NULL), BIS_OK);
        bis_display_offer(d, &f);
        bis_display_close(d, &f, &diag);
        assert_true(resolver.has_answered == !hangs); /* the twin is answered, and shows its picture */
        assert_int_equal(diag.n, hangs);
        assert_int_equal(bis_display_is_left(), hangs); /* bis then says nothing of the memory of the thread */
        if (hangs)
            assert_non_null(strstr(diag.messages[0].text, "no answer from the name server or the viewer; the render "
                                                          "went on without"));
        resolver.hangs = false;
        close_viewer(&v);
        assert_int_equal(v.n > 0, !hangs);
        free(v.data);
    }
    bis_diag_clear(&diag);
    bis_film_clear(&f);
}

/* ---- tests ---- */

static void the_viewer_gets_the_picture_bit_by_bit(void **state)
{
    static const char *const crops[] = {"", " --cropwindow 0.25,0.75,0.5,1"};
    for (int i = 0; i < 2; i++) {
        viewer v;
        program_run r;
        bis_image image;
        float *shown;
        int width = 0, height = 0;
        open_viewer(&v, READS);
        program_expect(&r, 0, SCENE " --display 127.0.0.1:%d --outfile " DIR "/a.pfm%s", v.port, crops[i]);
        close_viewer(&v);
        program_expect_only_the_result(&r);
        assert_int_equal(bis_image_read(&image, DIR "/a.pfm", (bis_loc){0}, NULL), BIS_OK);
        assert_true(read_messages(&v, &shown, &width, &height, DIR "/a.pfm") >= 3);
        assert_true(width == 24 && height == 16); /* also of a crop, in its place */
        const int x0 = i ? 6 : 0, y0 = i ? 8 : 0;
        assert_true(image.width == (i ? 12 : 24) && image.height == (i ? 8 : 16));
        for (int y = 0; y < image.height; y++)
            assert_memory_equal(
                &shown[3 * ((y + y0) * width + x0)], &image.pixels[y * image.width], 12 * (size_t)image.width);
        bis_image_clear(&image);
        free(shown);
        free(v.data);
    }
}

/* Closed standard input, as of a service: the connection is the first file that is opened, and has the number 0. */
static void the_viewer_gets_a_picture_from_a_program_without_input(void **state)
{
    viewer v;
    float *shown;
    int width = 0, height = 0;
    char command[512];
    open_viewer(&v, READS);
    snprintf(command, sizeof command,
        "${BIS_PROGRAM:-build/release/bis} " SCENE " --quiet --display 127.0.0.1:%d --outfile " DIR "/c.pfm <&-",
        v.port);
    assert_int_equal(system(command), 0);
    close_viewer(&v);
    assert_true(read_messages(&v, &shown, &width, &height, DIR "/c.pfm") >= 3);
    free(shown);
    free(v.data);
}

static void a_viewer_that_is_missing_goes_or_never_reads_stops_nothing(void **state)
{
    program_run r;
    viewer v;
    program_expect(&r, 0, BIG " --outfile " DIR "/alone.pfm");
    open_viewer(&v, LEAVES);
    program_expect(
        &r, 0, BIG " --display localhost:%d --outfile " DIR "/left.pfm", v.port); /* more than a connection holds */
    close_viewer(&v);
    assert_non_null(strstr(r.messages, "bis: warning: --display localhost:"));
    assert_non_null(strstr(r.messages, "; the render went on without\n"));
    program_expect(&r, 0, "compare --tolerance 0 " DIR "/left.pfm " DIR "/alone.pfm");
    free(v.data);

    /* nobody listens at that port any more */
    program_expect(&r, 0, BIG " --display 127.0.0.1:%d --outfile " DIR "/none.pfm", v.port);
    assert_non_null(strstr(r.messages, "Connection refused; the render went on without\n"));
    program_expect(&r, 0, "compare --tolerance 0 " DIR "/none.pfm " DIR "/alone.pfm");

    open_viewer(&v, NEVER_READS);
    program_expect(&r, 0, BIG " --display 127.0.0.1:%d --outfile " DIR "/stuck.pfm", v.port);
    assert_non_null(strstr(r.messages, "it reads no more; the render went on without\n"));
    close_viewer(&v);
    free(v.data);
}

static void without_memory_there_is_no_display(void **state)
{
    bis_film f;
    make_film(&f);
    const long live = bis_mem_live();
    FOR_LACK(l) {
        bis_display *d;
        bis_diag diag = {0};
        LACK(l, bis_display_open(&d, "127.0.0.1:1", "none", &f, &diag));
        assert_true((d == NULL) == (l.status != BIS_OK));
        if (d) bis_display_close(d, &f, &diag);
        else assert_string_equal(diag.messages[0].text, "bis: error: no memory or no thread for --display 127.0.0.1:1");
        bis_diag_clear(&diag);
        /* on a busy machine the thread may be left alone, and frees what it has when it ends */
        for (int i = 0; i < 6000 && bis_mem_live() != live; i++) usleep(10000);
        assert_int_equal(bis_mem_live(), live);
    }
    bis_film_clear(&f);
}

static void an_address_is_a_host_and_a_port(void **state)
{
    static const char *const good[] = {"localhost:14158", "127.0.0.1:1", "[::1]:65535", "a.b-c.example:80"};
    static const char *const bad[] = {"", "localhost", ":80", "localhost:", "localhost:0", "localhost:65536",
        "localhost:80x", "localhost:-1", "::1:80", "localhost:0000080",
        "localhost:014158"};
    for (size_t i = 0; i < sizeof good / sizeof *good; i++) assert_true(bis_display_is_address(good[i]));
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) assert_false(bis_display_is_address(bad[i]));
    char longest[258]; /* 255 characters and no more */
    memset(longest, 'a', sizeof longest);
    snprintf(longest + 253, 4, ":1");
    assert_true(bis_display_is_address(longest));
    longest[253] = 'a';
    snprintf(longest + 254, 4, ":1");
    assert_false(bis_display_is_address(longest));
    program_run r;
    program_expect(&r, 2, SCENE " --display nowhere");
    assert_string_equal(r.messages,
        "bis: error: --display is \"nowhere\", must be HOST:PORT with a port in [1, 65535], as in localhost:14158\n");
    int input[2]; /* nothing is sent to standard input in place of the host */
    char sent;
    const int own = dup(STDIN_FILENO);
    assert_true(own >= 0 && socketpair(AF_UNIX, SOCK_STREAM, 0, input) == 0 && dup2(input[0], STDIN_FILENO) == 0);
    program_expect(&r, 0, SCENE " --outfile " DIR "/b.pfm --display no-such-host.invalid:80");
    assert_true(dup2(own, STDIN_FILENO) == 0 && close(own) == 0 && close(input[0]) == 0);
    assert_int_equal(read(input[1], &sent, 1), 0);
    close(input[1]);
    assert_non_null(strstr(r.messages, "bis: warning: --display no-such-host.invalid:80: "));
    /* nobody listens at port 1; the brackets of an address are not part of it */
    program_expect(&r, 0, SCENE " --outfile " DIR "/b.pfm --display [::1]:1");
    assert_non_null(strstr(r.messages, "bis: warning: --display ::1:1: "));
    assert_null(strstr(r.messages, "Name or service not known"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_viewer_gets_the_picture_bit_by_bit),
        cmocka_unit_test(the_viewer_gets_a_picture_from_a_program_without_input),
        cmocka_unit_test(a_viewer_that_is_missing_goes_or_never_reads_stops_nothing),
        cmocka_unit_test(a_slow_viewer_has_a_second_for_each_piece_at_the_end),
        cmocka_unit_test(the_first_picture_waits_for_nothing),
        cmocka_unit_test(pictures_wait_for_their_share_of_the_time),
        cmocka_unit_test(nothing_is_sent_to_a_viewer_that_has_gone),
        cmocka_unit_test(a_name_server_that_is_silent_is_not_waited_for),
        cmocka_unit_test(without_memory_there_is_no_display),
        cmocka_unit_test(an_address_is_a_host_and_a_port),
    };
    return cmocka_run_group_tests(tests, make_scene, NULL);
}
