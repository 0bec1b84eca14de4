/* SPDX-License-Identifier: BSD-2-Clause */
/* display: a client of tev's protocol.
 *
 * A message is its length in bytes (4 bytes, the low one first, counting themselves), its kind (1 byte) and what
 * belongs to the kind. Texts end with a zero byte, integers have 4 bytes, truths 1. We send two kinds, as tev has known
 * them from the beginning:
 *     4, create image: grab the focus, name, width, height, number of channels, their names
 *     3, update image: grab the focus, name, channel, x, y, width, height, the floats row by row
 * Source: the comments and headers of tev (README, include/tev/Ipc.h).
 *
 * Two threads share the picture: the render's copies it while `busy` is false, then sets it; ours sends it and clears
 * it. Nothing is sent twice at once, and a picture that comes while another is sent is left out.
 *
 * Looking up a name (getaddrinfo) cannot be interrupted and takes a minute where name servers are silent. A thread
 * still at it CONNECT_MS after the render is left alone: the program ends with it, or it frees what is left. */
#include "display.h"

#include "bis/base/clock.h"
#include "bis/base/mem.h"
#include "cli.h"

#include <errno.h>
#include <netdb.h>
#include <poll.h>
#include <pthread.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

enum { CREATE_IMAGE = 4, UPDATE_IMAGE = 3, ROWS = 16, HEADER = 512, PATIENCE_MS = 1000, CONNECT_MS = 3000 };

struct bis_display {
    char host[256], port[8], name[256];
    int x0, y0, width, height, full_width, full_height;
    float *rgba;          /* of the film */
    unsigned char *message;
    pthread_t thread;

    pthread_mutex_t lock; /* of all below */
    pthread_cond_t change;
    bool busy;            /* rgba is being sent */
    bool hurry;           /* the render is over: a viewer that reads nothing has PATIENCE_MS left */
    bool over;            /* no more pictures will come */
    bool met;             /* the viewer was reached, or cannot be */
    bool alone;           /* the render's side has left: the thread frees all */
    bool gone;            /* the viewer: nothing is sent any more */
    char why[160];        /* it is gone; "": it is not */
    double cost;          /* processor seconds of the thread */

    double start, spent, last_cost; /* of the render's thread: seconds spent on copying, of the last copy */
    double cost_before;             /* of the thread, before the last picture */
    uint32_t passes;                /* of the last picture */
    bool has_given;                 /* a picture */
};

bool bis_display_is_address(const char *text)
{
    const char *colon = strrchr(text, ':');
    int port;
    if (!colon || colon == text || strlen(text) >= 256) return false;
    const bool brackets = text[0] == '[' && colon[-1] == ']';
    if (!brackets && memchr(text, ':', (size_t)(colon - text))) return false;
    const char *rest = bis_cli_digits(colon + 1, 1, 65535, &port);
    return rest && !*rest && strlen(colon + 1) < 6;
}

/* ---- messages ---- */

static size_t put_int(unsigned char *at, size_t n, uint32_t v)
{
    for (int i = 0; i < 4; i++) at[n + (size_t)i] = (unsigned char)(v >> 8 * i);
    return n + 4;
}

static size_t put_text(unsigned char *at, size_t n, const char *text)
{
    const size_t length = strlen(text) + 1;
    memcpy(at + n, text, length);
    return n + length;
}

static size_t begin(const bis_display *d, int kind)
{
    d->message[4] = (unsigned char)kind;
    d->message[5] = 0; /* the focus stays where it is */
    return put_text(d->message, 6, d->name);
}

static void fail(bis_display *d, const char *why)
{
    pthread_mutex_lock(&d->lock);
    d->gone = true;
    snprintf(d->why, sizeof d->why, "%s", why);
    pthread_mutex_unlock(&d->lock);
}

static bool must_hurry(bis_display *d)
{
    pthread_mutex_lock(&d->lock);
    const bool hurry = d->hurry;
    pthread_mutex_unlock(&d->lock);
    return hurry;
}

/* All n bytes of the message. While the render goes on a viewer may take its time; at the end it has a second. */
static bool send_message(bis_display *d, int fd, size_t n)
{
    int waited = 0;
    put_int(d->message, 0, (uint32_t)n);
    for (size_t sent = 0; sent < n;) {
        const ssize_t got = send(fd, d->message + sent, n - sent, MSG_NOSIGNAL | MSG_DONTWAIT);
        if (got > 0) {
            sent += (size_t)got;
            waited = 0;
            continue;
        }
        if (got < 0 && errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR) {
            fail(d, strerror(errno));
            return false;
        }
        struct pollfd ready = {.fd = fd, .events = POLLOUT};
        poll(&ready, 1, 100);
        if (!must_hurry(d)) waited = 0;
        else if ((waited += 100) > PATIENCE_MS) {
            fail(d, "it reads no more");
            return false;
        }
    }
    return true;
}

static bool send_create(bis_display *d, int fd)
{
    size_t n = begin(d, CREATE_IMAGE);
    n = put_int(d->message, n, (uint32_t)d->full_width);
    n = put_int(d->message, n, (uint32_t)d->full_height);
    n = put_int(d->message, n, 3);
    n = put_text(d->message, n, "R");
    n = put_text(d->message, n, "G");
    n = put_text(d->message, n, "B");
    return send_message(d, fd, n);
}

static bool send_rows(bis_display *d, int fd, int channel, int y, int rows)
{
    static const char *const names[3] = {"R", "G", "B"};
    size_t n = begin(d, UPDATE_IMAGE);
    n = put_text(d->message, n, names[channel]);
    n = put_int(d->message, n, (uint32_t)d->x0);
    n = put_int(d->message, n, (uint32_t)(d->y0 + y));
    n = put_int(d->message, n, (uint32_t)d->width);
    n = put_int(d->message, n, (uint32_t)rows);
    const float *from = d->rgba + 4 * (size_t)y * (size_t)d->width + channel;
    for (size_t i = 0; i < (size_t)rows * (size_t)d->width; i++) {
        uint32_t bits;
        memcpy(&bits, &from[4 * i], sizeof bits);
        n = put_int(d->message, n, bits);
    }
    return send_message(d, fd, n);
}

static bool send_picture(bis_display *d, int fd)
{
    for (int y = 0; y < d->height; y += ROWS)
        for (int channel = 0; channel < 3; channel++)
            if (!send_rows(d, fd, channel, y, d->height - y < ROWS ? d->height - y : ROWS)) return false;
    return true;
}

/* ---- the thread ---- */

/* Waits at most CONNECT_MS for one address. -1, with errno. */
static int connect_to(const struct addrinfo *a)
{
    int reason = 0;
    socklen_t size = sizeof reason;
    const int fd = socket(a->ai_family, a->ai_socktype | SOCK_NONBLOCK | SOCK_CLOEXEC, a->ai_protocol);
    if (fd < 0) return -1;
    if (connect(fd, a->ai_addr, a->ai_addrlen) == 0) return fd;
    reason = errno;
    if (reason == EINPROGRESS) {
        struct pollfd ready = {.fd = fd, .events = POLLOUT};
        if (poll(&ready, 1, CONNECT_MS) < 1) reason = ETIMEDOUT;
        else getsockopt(fd, SOL_SOCKET, SO_ERROR, &reason, &size);
    }
    if (!reason) return fd;
    close(fd);
    errno = reason;
    return -1;
}

static int connect_to_viewer(bis_display *d)
{
    const struct addrinfo hints = {.ai_family = AF_UNSPEC, .ai_socktype = SOCK_STREAM};
    struct addrinfo *all;
    int fd = -1;
    const int unknown = getaddrinfo(d->host, d->port, &hints, &all);

    if (unknown) {
        fail(d, gai_strerror(unknown));
        return -1;
    }
    for (const struct addrinfo *a = all; a && fd < 0; a = a->ai_next) fd = connect_to(a);
    if (fd < 0) fail(d, strerror(errno));
    freeaddrinfo(all);
    return fd;
}

/* Waits for a picture. False: none will come. */
static bool next_picture(bis_display *d)
{
    pthread_mutex_lock(&d->lock);
    while (!d->busy && !d->over) pthread_cond_wait(&d->change, &d->lock);
    const bool any = d->busy;
    pthread_mutex_unlock(&d->lock);
    return any;
}

static void done_with_picture(bis_display *d)
{
    pthread_mutex_lock(&d->lock);
    d->busy = false;
    d->cost = bis_clock_processor();
    pthread_cond_broadcast(&d->change);
    pthread_mutex_unlock(&d->lock);
}

static void free_display(bis_display *d)
{
    pthread_cond_destroy(&d->change);
    pthread_mutex_destroy(&d->lock);
    bis_free(d->rgba);
    bis_free(d->message);
    bis_free(d);
}

/* Tells that there is an answer from the viewer's side. False: nobody waits for it any more. */
static bool meet(bis_display *d)
{
    pthread_mutex_lock(&d->lock);
    d->met = true;
    const bool alone = d->alone;
    pthread_cond_broadcast(&d->change);
    pthread_mutex_unlock(&d->lock);
    return !alone;
}

static void *run(void *arg)
{
    bis_display *d = arg;
    const int fd = connect_to_viewer(d);

    if (!meet(d)) {
        if (fd >= 0) close(fd);
        free_display(d);
        return NULL;
    }
    bool good = fd >= 0 && send_create(d, fd);

    while (next_picture(d)) {
        good = good && send_picture(d, fd);
        done_with_picture(d);
    }
    if (fd >= 0) close(fd);
    return NULL;
}

/* ---- the render's side ---- */

static void set_address(bis_display *d, const char *where)
{
    const char *colon = strrchr(where, ':');
    const bool brackets = where[0] == '[';
    const int length = (int)(colon - where) - 2 * brackets;
    snprintf(d->host, sizeof d->host, "%.*s", length, where + brackets);
    snprintf(d->port, sizeof d->port, "%s", colon + 1);
}

/* The clock of time-outs is one that nobody sets. */
static void init_lock(bis_display *d)
{
    pthread_condattr_t of_change;

    pthread_condattr_init(&of_change);
    pthread_condattr_setclock(&of_change, CLOCK_MONOTONIC);
    pthread_mutex_init(&d->lock, NULL);
    pthread_cond_init(&d->change, &of_change);
    pthread_condattr_destroy(&of_change);
}

bis_status bis_display_open(bis_display **out, const char *where, const char *name, const bis_film *film,
                            bis_diag *diag)
{
    const size_t n = (size_t)film->width * (size_t)film->height;
    bis_display *d = bis_alloc(1, sizeof *d);
    bool has_thread = false;

    *out = d;
    if (d) {
        d->rgba = bis_alloc(n, 4 * sizeof *d->rgba);
        d->message = bis_alloc(HEADER + (size_t)film->width * ROWS * sizeof(float), 1);
        d->x0 = film->x0;
        d->y0 = film->y0;
        d->width = film->width;
        d->height = film->height;
        d->full_width = film->full_width;
        d->full_height = film->full_height;
        d->start = bis_clock_now();
        set_address(d, where);
        snprintf(d->name, sizeof d->name, "%s", name);
        init_lock(d);
        if (d->rgba && d->message) has_thread = pthread_create(&d->thread, NULL, run, d) == 0;
    }
    if (has_thread) return BIS_OK;
    *out = NULL;
    if (d) free_display(d);
    return bis_error(diag, BIS_NOMEM, bis_cli_loc, "no memory or no thread for --display %s", where);
}

/* Takes the film, or pixels of its size, and wakes the thread; the thread is idle. */
static void give(bis_display *d, const bis_film *film, const float *rgba)
{
    const double before = bis_clock_now();
    if (film) bis_film_resolve(film, d->rgba);
    else memcpy(d->rgba, rgba, (size_t)d->width * (size_t)d->height * 4 * sizeof *rgba);
    d->passes = film ? film->passes : 0;
    d->has_given = true;
    d->cost_before = d->cost;
    const double copying = bis_clock_now() - before;
    d->spent += copying;
    d->last_cost = copying;
    pthread_mutex_lock(&d->lock);
    d->busy = true;
    pthread_cond_broadcast(&d->change);
    pthread_mutex_unlock(&d->lock);
}

/* The first picture waits for nothing: somebody who sees an empty window does not know that the render runs. */
static bool has_time(bis_display *d)
{
    pthread_mutex_lock(&d->lock);
    const bool idle = !d->busy && !d->gone;
    const double cost = d->cost, sending = cost - d->cost_before;
    pthread_mutex_unlock(&d->lock);
    const double all = d->spent + cost + d->last_cost + sending;
    return idle && (!d->has_given || all <= BIS_DISPLAY_SHARE * (bis_clock_now() - d->start));
}

void bis_display_offer(bis_display *d, const bis_film *film)
{
    if (film->passes && film->passes != d->passes && has_time(d)) give(d, film, NULL);
}

void bis_display_offer_pixels(bis_display *d, const float *rgba)
{
    if (has_time(d)) give(d, NULL, rgba);
}

/* Until the thread has sent what it has, or has given up; a stuck viewer has a second from now. */
static void wait_until_idle(bis_display *d)
{
    pthread_mutex_lock(&d->lock);
    d->hurry = true;
    while (d->busy) pthread_cond_wait(&d->change, &d->lock);
    pthread_mutex_unlock(&d->lock);
}

static void end_thread(bis_display *d)
{
    pthread_mutex_lock(&d->lock);
    d->over = true;
    pthread_cond_broadcast(&d->change);
    pthread_mutex_unlock(&d->lock);
    pthread_join(d->thread, NULL);
}

static void warn(const bis_display *d, const char *why, bis_diag *diag)
{
    bis_warn(diag, bis_cli_loc, "--display %s:%s: %s; the render went on without", d->host, d->port, why);
}

static bool is_left; /* by the main thread for the main thread */

bool bis_display_is_left(void) { return is_left; }

/* Waits CONNECT_MS at most for the connection. False: there is none yet, and d is the thread's from now on. */
static bool wait_until_met(bis_display *d, bis_diag *diag)
{
    struct timespec until;
    int late = 0;

    clock_gettime(CLOCK_MONOTONIC, &until);
    until.tv_sec += CONNECT_MS / 1000;
    pthread_mutex_lock(&d->lock);
    while (!d->met && !late) late = pthread_cond_timedwait(&d->change, &d->lock, &until);
    const bool met = d->met;
    if (!met) {
        warn(d, "no answer from the name server or the viewer", diag);
        pthread_detach(d->thread);
        d->alone = is_left = true;
    }
    pthread_mutex_unlock(&d->lock);
    return met;
}

void bis_display_close(bis_display *d, const bis_film *film, bis_diag *diag)
{
    if (!d || !wait_until_met(d, diag)) return;
    wait_until_idle(d);
    if (film) give(d, film, NULL);
    wait_until_idle(d);
    end_thread(d);
    if (*d->why) warn(d, d->why, diag);
    free_display(d);
}
