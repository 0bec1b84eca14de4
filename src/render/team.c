/* team: rank 0 deals out the tiles of a pass to the ranks, as they get done, and collects what they make of them.
 *
 * So a rank that is slow, or has other work beside, holds up nobody: it gets fewer tiles. Each rank has one batch of
 * tiles to work on and one in its queue, so that it does not wait for the answer of rank 0. Batches become smaller
 * towards the end of a pass, and tiles that took long in the pass before come first: what is left for the end is small.
 *
 * Nothing that a rank knows decides what a pixel gets. What a tile has learned (visibility.h) goes with the tile, 8
 * KB, and what it has counted comes back with its pixels: only rank 0 keeps it, so checkpoints, budgets and the next
 * pass do not know how many ranks there are. That is 16 KB more for each tile and pass, beside 4 KB of pixels; to keep
 * tiles with their ranks would save it, but a tile that moves would need it all the same.
 *
 * Rank 0 renders, too, and looks after the others between two of its tiles. Where there are more than FEW ranks, its
 * thread 0 does nothing else.
 *
 * Only thread 0 of a rank talks to other ranks. Its other threads find tiles in a queue, and leave those that are done
 * in a list, which thread 0 sends. Numbers are sent as they are in memory: all machines must be of one kind. */
#include "team.h"

#include "pass.h"

#include "bis/base/mem.h"

#include <string.h>
#include <time.h>

enum { FEW = 16, MOST_TILES = 32, PIECES = 4, BUCKETS = 64, TILE_PIXELS = BIS_RENDER_TILE * BIS_RENDER_TILE };

typedef enum kind { WORK, DONE, STOP, COUNTS } kind;

/* Before each message. */
typedef struct head {
    int32_t kind, n_tiles;
} head;

/* Before each tile of a message. */
typedef struct tile_head {
    int32_t tile;
    uint32_t samples; /* to the rank: of adapt.h */
    double seconds;   /* from the rank */
} tile_head;

struct bis_team {
    bis_crew *crew;
    bis_workspace *w;
    void (*progress)(double share, void *user);
    void *user;
    double *seconds; /* seconds[n_tiles] of the last pass */
    unsigned char *message;

    /* rank 0 */
    int *order;     /* order[n_tiles]: in which tiles are dealt out */
    double *until;  /* until[n_tiles + 1]: seconds of the tiles before, in that order; while nothing is known, tiles */
    int *threads;   /* threads[size] of the ranks */
    int *held;      /* held[size]: tiles that a rank has */
    int next;       /* in order[] */
    int n_held, n_done, n_all_threads;
    bool knows;     /* seconds */

    /* other ranks: under the lock but for `over` and n_sent */
    int *queue, n_queued, n_taken;
    int *finished, n_finished, n_sent;
    bool over;
};

size_t bis_team_bytes(const bis_team *team)
{
    const size_t n = (size_t)team->w->n_tiles;
    return sizeof *team + n * (2 * sizeof(double) + 3 * sizeof(int)) + 2 * (size_t)team->crew->size * sizeof(int);
}

/* What a tile has learned or counted. */
static bis_seen *cells_of(const bis_workspace *w, bis_seen *cells, int tile)
{
    return cells + (size_t)tile * w->visibility.cells;
}

static size_t cells_bytes(const bis_workspace *w) { return w->visibility.cells * sizeof(bis_seen); }

/* Of one tile in a message of a rank, at most. */
static size_t tile_bytes(const bis_workspace *w)
{
    const size_t pixel = sizeof(bis_pixel_mean) + (size_t)w->film->layers.n_values * sizeof(float);
    return sizeof(tile_head) + TILE_PIXELS * pixel + cells_bytes(w);
}

bis_team *bis_team_new(bis_crew *crew, bis_workspace *w)
{
    const size_t n = (size_t)w->n_tiles, size = (size_t)crew->size;
    bis_team *team = bis_alloc(1, sizeof *team);

    if (!team) return NULL;
    *team = (bis_team){.crew = crew, .w = w};
    team->seconds = bis_alloc(n, sizeof *team->seconds);
    team->order = bis_alloc(n, sizeof *team->order);
    team->until = bis_alloc(n + 1, sizeof *team->until);
    team->queue = bis_alloc(n, sizeof *team->queue);
    team->finished = bis_alloc(n, sizeof *team->finished);
    team->threads = bis_alloc(size, sizeof *team->threads);
    team->held = bis_alloc(size, sizeof *team->held);
    team->message = bis_alloc(1, sizeof(head) + MOST_TILES * tile_bytes(w));
    if (team->seconds && team->order && team->until && team->queue && team->finished && team->threads && team->held &&
        team->message)
        return team;
    bis_team_free(team);
    return NULL;
}

void bis_team_free(bis_team *team)
{
    if (!team) return;
    bis_free(team->seconds);
    bis_free(team->order);
    bis_free(team->until);
    bis_free(team->queue);
    bis_free(team->finished);
    bis_free(team->threads);
    bis_free(team->held);
    bis_free(team->message);
    bis_free(team);
}

bis_status bis_team_meet(bis_team *team, const bis_workspace *w, int *n_threads, bis_diag *diag)
{
    uint64_t parts[BIS_IDENTITY_PARTS];

    bis_identify(parts, w);
    const bis_status status = bis_crew_compare(team->crew, parts, w->n_threads, team->threads, diag);
    for (int i = 0; i < team->crew->size; i++) team->n_all_threads += team->threads[i];
    *n_threads = team->n_all_threads;
    return status;
}

/* ---- passes ---- */

typedef struct call {
    int32_t more, status;
    bis_pass pass;
} call;

void bis_team_call(bis_team *team, const bis_pass *pass, bis_status status)
{
    call c;
    memset(&c, 0, sizeof c);
    c.more = pass != NULL;
    c.status = (int32_t)status;
    if (pass) c.pass = *pass;
    team->crew->broadcast(team->crew, &c, sizeof c);
}

bool bis_team_follow(bis_team *team, bis_pass *pass, bis_status *status)
{
    call c;
    team->crew->broadcast(team->crew, &c, sizeof c);
    *pass = c.pass;
    *status = (bis_status)c.status;
    return c.more;
}

/* ---- messages ---- */

static unsigned char *put(unsigned char *to, const void *data, size_t n)
{
    memcpy(to, data, n);
    return to + n;
}

static unsigned char *get(void *data, unsigned char *from, size_t n)
{
    memcpy(data, from, n);
    return from + n;
}

/* Copies n bytes of memory to a message, or from it; returns what follows in the message. */
typedef unsigned char *copier(unsigned char *message, void *memory, size_t n);

static unsigned char *copy_out(unsigned char *message, void *memory, size_t n) { return put(message, memory, n); }
static unsigned char *copy_in(unsigned char *message, void *memory, size_t n) { return get(memory, message, n); }

/* What a pass has made of a tile. */
static unsigned char *copy_tile(unsigned char *m, bis_workspace *w, int t, copier *copy)
{
    const bis_film *f = w->film;
    const bis_rect r = bis_film_tile_of_crop(f, BIS_RENDER_TILE, t);
    const size_t n = (size_t)(r.x1 - r.x0), n_values = (size_t)f->layers.n_values;

    for (int y = r.y0; y < r.y1; y++) {
        const size_t i = (size_t)(y - f->y0) * (size_t)f->width + (size_t)(r.x0 - f->x0);
        m = copy(m, &w->pass[i], n * sizeof *w->pass);
        if (w->pass_layers) m = copy(m, bis_workspace_layers(w, i), n * n_values * sizeof *w->pass_layers);
    }
    if (w->visibility.n_tiles) m = copy(m, cells_of(w, w->visibility.counted, t), cells_bytes(w));
    return m;
}

/* ---- rank 0 ---- */

/* Costly tiles first, by the seconds of the last pass; among those that are alike, neighbours beside each other. */
static void make_order(bis_team *team)
{
    const int n = team->w->n_tiles;
    int first[BUCKETS + 1] = {0};
    double most = 0;

    for (int t = 0; t < n; t++) most = team->seconds[t] > most ? team->seconds[t] : most;
    const double scale = team->knows && most > 0 ? (BUCKETS - 1) / most : 0;
#define BUCKET_OF(t) (BUCKETS - 1 - (int)(team->seconds[t] * scale))
    for (int t = 0; t < n; t++) first[BUCKET_OF(t) + 1]++;
    for (int b = 0; b < BUCKETS; b++) first[b + 1] += first[b];
    for (int t = 0; t < n; t++) team->order[first[BUCKET_OF(t)]++] = t;
#undef BUCKET_OF
    for (int i = 0; i < n; i++) team->until[i + 1] = team->until[i] + (scale > 0 ? team->seconds[team->order[i]] : 1);
}

/* Takes at most n tiles out of the order; returns how many, from *first on. */
static int take(bis_team *team, int n, int *first)
{
    int left = 0;

#pragma omp critical(bis_team)
    if (!bis_workspace_interrupted(team->w)) {
        left = team->w->n_tiles - team->next;
        if (left < n) n = left;
        *first = team->next;
        team->next += n;
    }
    return left > 0 ? n : 0;
}

/* A batch is a share of what is left, so that there is some for everybody later, but a tile for each thread. A share of
 * the seconds, not of the tiles, because the first tiles are the costly ones: a batch of many of them would outlast the
 * pass. */
static int batch_size(const bis_team *team, int rank)
{
    const int own = team->threads[rank], n_tiles = team->w->n_tiles;
    int next, n = own;

#pragma omp atomic read
    next = team->next;
    const double *until = team->until + next;
    const double most = (team->until[n_tiles] - *until) * own / ((double)PIECES * team->n_all_threads);
    while (n < MOST_TILES && next + n < n_tiles && until[n + 1] - *until <= most) n++;
    return n < MOST_TILES ? n : MOST_TILES;
}

static void send_work(bis_team *team, int rank, int n)
{
    bis_workspace *w = team->w;
    int first;

    n = take(team, n, &first);
    if (n == 0) return;
    unsigned char *m = put(team->message, &(head){WORK, n}, sizeof(head));
    for (int i = 0; i < n; i++) {
        const int t = team->order[first + i];
        const tile_head h = {.tile = t, .samples = w->adapt.n_tiles ? w->adapt.samples[t] : 0};
        m = put(m, &h, sizeof h);
        if (w->visibility.n_tiles) m = put(m, cells_of(w, w->visibility.known, t), cells_bytes(w));
    }
    team->crew->send(team->crew, rank, team->message, (size_t)(m - team->message));
    team->held[rank] += n;
    team->n_held += n;
}

static void tell_progress(bis_team *team)
{
    int n;

#pragma omp atomic read
    n = team->n_done;
    team->progress((double)n / team->w->n_tiles, team->user);
}

/* Tiles that a rank has done; it gets others. */
static void take_in(bis_team *team, int rank, unsigned char *m)
{
    head h;

    m = get(&h, m, sizeof h);
    for (int i = 0; i < h.n_tiles; i++) {
        tile_head t;
        m = get(&t, m, sizeof t);
        m = copy_tile(m, team->w, t.tile, copy_in);
        team->seconds[t.tile] = t.seconds;
    }
    team->held[rank] -= h.n_tiles;
    team->n_held -= h.n_tiles;
#pragma omp atomic
    team->n_done += h.n_tiles;
    const int n = batch_size(team, rank);
    if (team->held[rank] <= n) send_work(team, rank, n);
    tell_progress(team);
}

static int lead(bis_team *team)
{
    bis_crew *crew = team->crew;
    unsigned char *m;
    int from, first;
    size_t n;

    while ((m = crew->receive(crew, &from, &n, false)) != NULL) take_in(team, from, m);
    if (crew->size <= FEW && take(team, 1, &first)) return team->order[first];
    while (team->n_held > 0) {
        m = crew->receive(crew, &from, &n, true);
        take_in(team, from, m);
    }
    for (int i = 1; i < crew->size; i++) crew->send(crew, i, &(head){STOP, 0}, sizeof(head));
    return -1;
}

/* ---- other ranks ---- */

static void read_message(bis_team *team, unsigned char *m)
{
    bis_workspace *w = team->w;
    head h;

    m = get(&h, m, sizeof h);
    if (h.kind == STOP) {
#pragma omp atomic write
        team->over = true;
    }
    for (int i = 0; i < h.n_tiles; i++) {
        tile_head t;
        m = get(&t, m, sizeof t);
        if (w->adapt.n_tiles) w->adapt.samples[t.tile] = t.samples;
        if (w->visibility.n_tiles) m = get(cells_of(w, w->visibility.known, t.tile), m, cells_bytes(w));
#pragma omp critical(bis_team)
        team->queue[team->n_queued++] = t.tile;
    }
}

static void send_finished(bis_team *team)
{
    bis_workspace *w = team->w;
    int n;

#pragma omp critical(bis_team)
    n = team->n_finished;
    while (team->n_sent < n) {
        const int n_tiles = n - team->n_sent < MOST_TILES ? n - team->n_sent : MOST_TILES;
        unsigned char *m = put(team->message, &(head){DONE, n_tiles}, sizeof(head));
        for (int i = 0; i < n_tiles; i++) {
            const int t = team->finished[team->n_sent++];
            const tile_head h = {.tile = t, .seconds = team->seconds[t]};
            m = put(m, &h, sizeof h);
            m = copy_tile(m, w, t, copy_out);
            if (w->visibility.n_tiles) memset(cells_of(w, w->visibility.counted, t), 0, cells_bytes(w));
        }
        team->crew->send(team->crew, 0, team->message, (size_t)(m - team->message));
    }
}

/* The next tile of the queue, -1: none; *at_work: other threads are rendering tiles. */
static int take_queued(bis_team *team, bool *at_work)
{
    int t = -1;

#pragma omp critical(bis_team)
    {
        *at_work = team->n_taken > team->n_finished;
        if (team->n_taken < team->n_queued) t = team->queue[team->n_taken++];
    }
    return t;
}

static void wait_a_little(void) { nanosleep(&(struct timespec){0, 50000}, NULL); }

static int follow(bis_team *team)
{
    bis_crew *crew = team->crew;

    for (;;) {
        unsigned char *m;
        int from;
        size_t n;
        bool at_work;
        send_finished(team);
        while (!team->over && (m = crew->receive(crew, &from, &n, false)) != NULL) read_message(team, m);
        const int t = take_queued(team, &at_work);
        if (t >= 0 || team->over) return t;
        if (at_work) wait_a_little(); /* what they finish must be sent */
        else if (team->n_sent == team->n_finished) read_message(team, crew->receive(crew, &from, &n, true));
    }
}

/* ---- both ---- */

void bis_team_begin(bis_team *team, void (*progress)(double share, void *user), void *user)
{
    team->progress = progress;
    team->user = user;
    team->over = false;
    team->next = team->n_held = team->n_done = 0;
    team->n_queued = team->n_taken = team->n_finished = team->n_sent = 0;
    if (team->crew->rank > 0) return;
    make_order(team);
    for (int round = 0; round < 2; round++)
        for (int i = 1; i < team->crew->size; i++) send_work(team, i, batch_size(team, i));
}

int bis_team_next(bis_team *team, int thread)
{
    int first;
    bool at_work, over;

    if (thread == 0) return team->crew->rank == 0 ? lead(team) : follow(team);
    if (team->crew->rank == 0) return take(team, 1, &first) ? team->order[first] : -1;
    for (;;) {
        const int t = take_queued(team, &at_work);
        if (t >= 0) return t;
#pragma omp atomic read
        over = team->over;
        if (over) return -1;
        wait_a_little();
    }
}

void bis_team_finish(bis_team *team, int thread, int tile, double seconds)
{
    team->seconds[tile] = seconds;
    if (team->crew->rank == 0) {
#pragma omp atomic
        team->n_done++;
        if (thread == 0) tell_progress(team);
        return;
    }
#pragma omp critical(bis_team)
    team->finished[team->n_finished++] = tile;
}

void bis_team_end(bis_team *team)
{
    bis_crew *crew = team->crew;
    bis_workspace *w = team->w;
    bis_counters sum = {0};

    for (int i = 0; i < w->n_threads; i++) bis_counters_add(&sum, &w->workers[i].counters);
    if (crew->rank > 0) {
        crew->send(crew, 0, &sum, sizeof sum);
        return;
    }
    for (int i = 1; i < crew->size; i++) {
        int from;
        size_t n;
        bis_counters c;
        memcpy(&c, crew->receive(crew, &from, &n, true), sizeof c);
        bis_counters_add(&w->workers[0].counters, &c);
    }
    team->knows = true;
}
