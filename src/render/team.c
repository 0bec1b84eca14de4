/* team: rank 0 deals out the tiles of a pass to the ranks, as they get done, and collects what they make of them.
 *
 * So a rank that is slow, or has other work beside, holds up nobody: it gets fewer tiles. Each rank has one batch of
 * tiles to work on and one in its queue, so that it does not wait for the answer of rank 0. Batches become smaller
 * towards the end of a pass, and tiles that took long in the pass before come first: what is left for the end is small.
 *
 * Nothing that a rank knows decides what a pixel gets. What a tile has learned (visibility.h), 8 KB, stays with the
 * rank that rendered the tile, its owner. Only rank 0 knows who owns what. A rank first gets the tiles that it owns;
 * then those of nobody, which are all in the first pass; and then those of the rank that has most work left. Such a
 * tile moves: rank 0 asks its owner to GIVE it, and the owner sends the WORK to the new one, with what the tile has
 * learned. So as a rule nothing travels but pixels, 4 KB a tile.
 *
 * What a tile has counted in a pass becomes part of what it has learned when the next call of rank 0 says that the pass
 * is complete: a pass that is given up leaves no trace. For a checkpoint rank 0 asks the owners for all that has been
 * learned; they stay the owners. So checkpoints, budgets and the next pass do not know how many ranks there are.
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

enum { FEW = 16, MOST_TILES = 32, TOGETHER = 8, PIECES = 4, BUCKETS = 64, NOBODY = -1 };
enum { TILE_PIXELS = BIS_RENDER_TILE * BIS_RENDER_TILE };

/* Tiles to render; tiles that are done; tiles that their owner is to send as WORK to another rank; no more tiles. */
typedef enum kind { WORK, DONE, GIVE, STOP } kind;

/* Before each message. */
typedef struct head {
    int32_t kind, n_tiles;
    int32_t to;      /* of GIVE: a rank */
    int32_t learned; /* of WORK: what each tile has learned follows it */
} head;

/* Before each tile of a message. */
typedef struct tile_head {
    int32_t tile;
    uint32_t samples; /* of WORK and GIVE: of adapt.h */
    double seconds;   /* of DONE */
} tile_head;

struct bis_team {
    bis_crew *crew;
    bis_workspace *w;
    void (*progress)(double share, void *user);
    void *user;
    double *seconds; /* seconds[n_tiles] of the last pass */
    unsigned char *message;
    uint32_t passes; /* complete ones, when the last one began */

    /* tiles that came by WORK, and those that were rendered here: under the lock but for `over` and n_sent */
    int *queue, n_queued, n_taken;
    int *finished, n_finished, n_sent;
    bool over;

    /* rank 0: list i < size of tiles to render has those that rank i owns, list `size` those of nobody */
    int *owner;    /* owner[n_tiles], or NOBODY */
    int *order;    /* order[n_tiles]: list after list, each as it is dealt out */
    double *until; /* until[n_tiles + 1]: seconds of the tiles before, in that order; while nothing is known, tiles */
    int *bucket;   /* bucket[(size + 1) BUCKETS + 1]: for the sort */
    int *next, *end; /* next[size + 1], end[size + 1] of the lists in order[] */
    double left;   /* seconds of the tiles in all lists */
    int *threads;  /* threads[size] of the ranks */
    int *held;     /* held[size]: tiles that were dealt to a rank and did not come back, or to rank 0, did not arrive */
    double *work;  /* work[size]: the seconds of these tiles */
    int n_held, n_received, n_all_threads;
    bool knows;    /* seconds */
};

size_t bis_team_bytes(const bis_team *team)
{
    const size_t n = (size_t)team->w->n_tiles, size = (size_t)team->crew->size;
    const size_t tile = 2 * sizeof(double) + 4 * sizeof(int), rank = (4 + BUCKETS) * sizeof(int) + sizeof(double);
    return sizeof *team + n * tile + size * rank;
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
    team->queue = bis_alloc(n, sizeof *team->queue);
    team->finished = bis_alloc(n, sizeof *team->finished);
    team->owner = bis_alloc(n, sizeof *team->owner);
    team->order = bis_alloc(n, sizeof *team->order);
    team->until = bis_alloc(n + 1, sizeof *team->until);
    team->bucket = bis_alloc((size + 1) * BUCKETS + 1, sizeof *team->bucket);
    team->next = bis_alloc(size + 1, sizeof *team->next);
    team->end = bis_alloc(size + 1, sizeof *team->end);
    team->threads = bis_alloc(size, sizeof *team->threads);
    team->held = bis_alloc(size, sizeof *team->held);
    team->work = bis_alloc(size, sizeof *team->work);
    team->message = bis_alloc(1, sizeof(head) + MOST_TILES * tile_bytes(w));
    if (team->seconds && team->queue && team->finished && team->owner && team->order && team->until && team->bucket &&
        team->next && team->end && team->threads && team->held && team->work && team->message) {
        for (size_t t = 0; t < n; t++) team->owner[t] = NOBODY;
        return team;
    }
    bis_team_free(team);
    return NULL;
}

void bis_team_free(bis_team *team)
{
    if (!team) return;
    bis_free(team->seconds);
    bis_free(team->queue);
    bis_free(team->finished);
    bis_free(team->owner);
    bis_free(team->order);
    bis_free(team->until);
    bis_free(team->bucket);
    bis_free(team->next);
    bis_free(team->end);
    bis_free(team->threads);
    bis_free(team->held);
    bis_free(team->work);
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

/* What a pass has made of the pixels of a tile. */
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
    return m;
}

static unsigned char *put_head(const bis_team *team, head h) { return put(team->message, &h, sizeof h); }

static void send_message(bis_team *team, int to, const unsigned char *end)
{
    team->crew->send(team->crew, to, team->message, (size_t)(end - team->message));
}

static unsigned char *put_learned(unsigned char *m, const bis_workspace *w, int tile)
{
    return put(m, cells_of(w, w->visibility.known, tile), cells_bytes(w));
}

static unsigned char *get_learned(const bis_workspace *w, int tile, unsigned char *m)
{
    return get(cells_of(w, w->visibility.known, tile), m, cells_bytes(w));
}

/* Sends the n tiles behind the head of a GIVE as WORK. */
static void give(bis_team *team, const head *h, unsigned char *m)
{
    unsigned char *out = put_head(team, (head){.kind = WORK, .n_tiles = h->n_tiles, .learned = true});

    for (int i = 0; i < h->n_tiles; i++) {
        tile_head t;
        m = get(&t, m, sizeof t);
        out = put_learned(put(out, &t, sizeof t), team->w, t.tile);
    }
    send_message(team, h->to, out);
}

/* The tiles behind the head of a WORK come into the queue. */
static void take_work(bis_team *team, const head *h, unsigned char *m)
{
    bis_workspace *w = team->w;

    for (int i = 0; i < h->n_tiles; i++) {
        tile_head t;
        m = get(&t, m, sizeof t);
        if (w->adapt.n_tiles) w->adapt.samples[t.tile] = t.samples;
        if (h->learned) m = get_learned(w, t.tile, m);
#pragma omp critical(bis_team)
        team->queue[team->n_queued++] = t.tile;
    }
}

/* The next tile of the queue, -1: none. */
static int take_queued(bis_team *team)
{
    int t = -1;

#pragma omp critical(bis_team)
    if (team->n_taken < team->n_queued) t = team->queue[team->n_taken++];
    return t;
}

static void wait_a_little(void) { nanosleep(&(struct timespec){0, 50000}, NULL); }

/* ---- rank 0 ---- */

static double cost_of(const bis_team *team, int tile) { return team->knows ? team->seconds[tile] : 1; }

/* The lists. In each, costly tiles come first, by the seconds of the last pass; among those that are alike, neighbours
 * beside each other. */
static void make_lists(bis_team *team)
{
    const int n = team->w->n_tiles, size = team->crew->size;
    int *first = team->bucket;
    double most = 0;

    for (int t = 0; t < n; t++) most = team->seconds[t] > most ? team->seconds[t] : most;
    const double scale = team->knows && most > 0 ? (BUCKETS - 1) / most : 0;
#define LIST_OF(t) (team->owner[t] == NOBODY ? size : team->owner[t])
#define BUCKET_OF(t) (LIST_OF(t) * BUCKETS + BUCKETS - 1 - (int)(team->seconds[t] * scale))
    memset(first, 0, ((size_t)(size + 1) * BUCKETS + 1) * sizeof *first);
    for (int t = 0; t < n; t++) first[BUCKET_OF(t) + 1]++;
    for (int b = 0; b < (size + 1) * BUCKETS; b++) first[b + 1] += first[b];
    for (int i = 0; i <= size; i++) {
        team->next[i] = first[i * BUCKETS];
        team->end[i] = first[(i + 1) * BUCKETS];
    }
    for (int t = 0; t < n; t++) team->order[first[BUCKET_OF(t)]++] = t;
#undef BUCKET_OF
#undef LIST_OF
    for (int i = 0; i < n; i++) team->until[i + 1] = team->until[i] + cost_of(team, team->order[i]);
    team->left = team->until[n];
}

/* Tiles of one list: order[first], ..., n of them. */
typedef struct batch {
    int list, first, n;
} batch;

/* The list that a rank's next tiles come from; -1: there are no more, or, unless they may move, none that it may have
 * at once. */
static int find_list(const bis_team *team, int rank, bool may_move)
{
    const int nobodys = team->crew->size;
    double most = -1;
    int found = -1;

    if (team->next[rank] < team->end[rank]) return rank;
    if (team->next[nobodys] < team->end[nobodys]) return nobodys;
    for (int i = 0; may_move && i < nobodys; i++) {
        const double left = team->until[team->end[i]] - team->until[team->next[i]];
        if (team->next[i] < team->end[i] && left > most) most = left, found = i;
    }
    return found;
}

/* May a rank get more tiles? n: of a batch, which is worth `most` seconds. Where rank 0 renders, too, its answer takes
 * as long as a tile, and each rank needs a batch in its queue. Otherwise a rank that has enough to do gets none: a
 * costly tile that it has not begun can then go to another one. */
static bool may_get(const bis_team *team, int rank, int n, double most)
{
    if (team->crew->size <= FEW) return team->held[rank] <= n;
    return team->held[rank] < team->threads[rank] || team->work[rank] <= most;
}

/* Takes tiles for a rank out of the lists: one, or a batch. A batch is a share of what is left, so that there is some
 * for everybody later, but a tile for each thread. A share of the seconds, not of the tiles, because the first tiles
 * are the costly ones: a batch of many of them would outlast the pass. */
static batch take(bis_team *team, int rank, bool one)
{
    batch b = {.n = 0};

#pragma omp critical(bis_team)
    if (!bis_workspace_interrupted(team->w) && (b.list = find_list(team, rank, !one)) >= 0) {
        const int own = team->threads[rank], left = team->end[b.list] - team->next[b.list];
        b.first = team->next[b.list];
        const double *until = team->until + b.first, most = team->left * own / ((double)PIECES * team->n_all_threads);
        int n = one ? 1 : own;
        while (!one && n < MOST_TILES && n < left && until[n + 1] - *until <= most) n++;
        n = n < MOST_TILES ? n : MOST_TILES;
        if (one || may_get(team, rank, n, most)) {
            b.n = n < left ? n : left;
            team->next[b.list] += b.n;
            team->left -= until[b.n] - *until;
        }
    }
    for (int i = 0; i < b.n && team->w->visibility.n_tiles; i++) team->owner[team->order[b.first + i]] = rank;
    return b;
}

static tile_head head_of(const bis_team *team, int tile)
{
    const bis_adapt *a = &team->w->adapt;
    return (tile_head){.tile = tile, .samples = a->n_tiles ? a->samples[tile] : 0};
}

/* The next batch for a rank: its own tiles or nobody's, or those of rank 0 with what they have learned; others are
 * given by their owner. */
static void deal(bis_team *team, int rank)
{
    const batch b = take(team, rank, false);
    const bool moves = b.list != rank && b.list < team->crew->size, gives = moves && b.list > 0;

    if (b.n == 0) return;
    unsigned char *m = put_head(team, (head){.kind = gives ? GIVE : WORK, .n_tiles = b.n, .to = rank,
                                             .learned = moves && !gives});
    for (int i = 0; i < b.n; i++) {
        const tile_head h = head_of(team, team->order[b.first + i]);
        m = put(m, &h, sizeof h);
        if (moves && !gives) m = put_learned(m, team->w, h.tile);
    }
    send_message(team, gives ? b.list : rank, m);
    team->held[rank] += b.n;
    team->work[rank] += team->until[b.first + b.n] - team->until[b.first];
    team->n_held += b.n;
}

static void tell_progress(bis_team *team)
{
    int n;

#pragma omp critical(bis_team)
    n = team->n_finished;
    team->progress((double)(n + team->n_received) / team->w->n_tiles, team->user);
}

/* Tiles that a rank has done, or that it gives to rank 0. */
static void take_in(bis_team *team, int from, unsigned char *m)
{
    head h;

    m = get(&h, m, sizeof h);
    const int holder = h.kind == WORK ? 0 : from;
    team->held[holder] -= h.n_tiles;
    team->n_held -= h.n_tiles;
    if (h.kind == WORK) {
        team->work[0] = 0;
        take_work(team, &h, m);
        return;
    }
    for (int i = 0; i < h.n_tiles; i++) {
        tile_head t;
        m = get(&t, m, sizeof t);
        m = copy_tile(m, team->w, t.tile, copy_in);
        team->work[from] -= cost_of(team, t.tile);
        team->seconds[t.tile] = t.seconds;
    }
    team->n_received += h.n_tiles;
    deal(team, from);
    tell_progress(team);
}

/* A tile for a thread of rank 0, -1: none at the moment. */
static int take_at_rank_0(bis_team *team)
{
    const int t = take_queued(team);
    if (t >= 0) return t;
    const batch b = take(team, 0, true);
    return b.n ? team->order[b.first] : -1;
}

/* Once rank 0 has only tiles that others own, it asks for them, before its threads need them. */
static void ask_for_more(bis_team *team)
{
    bool has_enough;

#pragma omp critical(bis_team)
    has_enough = find_list(team, 0, false) >= 0 ||
                 team->n_queued - team->n_taken + team->held[0] >= team->threads[0];
    if (!has_enough) deal(team, 0);
}

static int lead(bis_team *team)
{
    bis_crew *crew = team->crew;
    const bool renders = crew->size <= FEW;
    unsigned char *m;
    int from, t = -1;
    size_t n;

    for (;;) {
        while ((m = crew->receive(crew, &from, &n, false)) != NULL) take_in(team, from, m);
        if (renders) t = take_at_rank_0(team);
        if (renders || team->threads[0] > 1) ask_for_more(team);
        if (t >= 0) return t;
        if (team->n_held == 0) break;
        wait_a_little();
    }
    for (int i = 1; i < crew->size; i++) crew->send(crew, i, &(head){.kind = STOP}, sizeof(head));
#pragma omp atomic write
    team->over = true;
    return -1;
}

/* ---- other ranks ---- */

static void read_message(bis_team *team, unsigned char *m)
{
    head h;

    m = get(&h, m, sizeof h);
    if (h.kind == GIVE) give(team, &h, m);
    if (h.kind == WORK) take_work(team, &h, m);
    if (h.kind == STOP) {
#pragma omp atomic write
        team->over = true;
    }
}

/* Tiles that are done are sent together, if as many wait in the queue: rank 0 hears of them long before this rank has
 * nothing left. */
static void send_finished(bis_team *team)
{
    bis_workspace *w = team->w;
    int n, enough;

#pragma omp critical(bis_team)
    {
        n = team->n_finished;
        enough = team->n_queued - team->n_taken;
    }
    enough = enough < TOGETHER ? enough : TOGETHER;
    while (team->n_sent < n && n - team->n_sent >= enough) {
        const int n_tiles = n - team->n_sent < MOST_TILES ? n - team->n_sent : MOST_TILES;
        unsigned char *m = put_head(team, (head){.kind = DONE, .n_tiles = n_tiles});
        for (int i = 0; i < n_tiles; i++) {
            const int t = team->finished[team->n_sent++];
            const tile_head h = {.tile = t, .seconds = team->seconds[t]};
            m = copy_tile(put(m, &h, sizeof h), w, t, copy_out);
        }
        send_message(team, 0, m);
    }
}

static int follow(bis_team *team)
{
    bis_crew *crew = team->crew;

    for (;;) {
        unsigned char *m;
        int from;
        size_t n;
        send_finished(team);
        while (!team->over && (m = crew->receive(crew, &from, &n, false)) != NULL) read_message(team, m);
        const int t = take_queued(team);
        if (t >= 0 || team->over) return t;
        wait_a_little();
    }
}

/* ---- both ---- */

typedef enum next_step { PASS, GATHER, END } next_step;

typedef struct call {
    int32_t next, status;
    uint32_t passes; /* complete ones */
    bis_pass pass;
} call;

static void call_others(bis_team *team, next_step next, const bis_pass *pass, bis_status status)
{
    call c;
    memset(&c, 0, sizeof c);
    c.next = next;
    c.status = (int32_t)status;
    c.passes = team->w->film->passes;
    if (pass) c.pass = *pass;
    team->crew->broadcast(team->crew, &c, sizeof c);
}

void bis_team_call(bis_team *team, const bis_pass *pass, bis_status status)
{
    call_others(team, pass ? PASS : END, pass, status);
}

void bis_team_learn(bis_team *team)
{
    bis_visibility_learn(&team->w->visibility, team->finished, (size_t)team->n_finished, team->w->n_threads);
    team->n_finished = 0;
}

/* Another rank: what rank 0 asks for. */
static void give_all(bis_team *team)
{
    bis_crew *crew = team->crew;
    head h;

    do {
        int from;
        size_t n;
        unsigned char *m = get(&h, crew->receive(crew, &from, &n, true), sizeof h);
        if (h.kind == GIVE) give(team, &h, m);
    } while (h.kind == GIVE);
}

bool bis_team_follow(bis_team *team, bis_pass *pass, bis_status *status)
{
    call c;

    for (;;) {
        team->crew->broadcast(team->crew, &c, sizeof c);
        if (c.passes > team->passes) bis_team_learn(team);
        team->passes = c.passes;
        if (c.next != GATHER) break;
        give_all(team);
    }
    *pass = c.pass;
    *status = (bis_status)c.status;
    return c.next == PASS;
}

/* Asks a rank for n tiles and takes what they have learned. */
static void fetch(bis_team *team, int rank, const int *tiles, int n)
{
    bis_crew *crew = team->crew;
    unsigned char *m = put_head(team, (head){.kind = GIVE, .n_tiles = n, .to = 0});
    int from;
    size_t size;

    for (int i = 0; i < n; i++) m = put(m, &(tile_head){.tile = tiles[i]}, sizeof(tile_head));
    send_message(team, rank, m);
    m = crew->receive(crew, &from, &size, true) + sizeof(head);
    for (int i = 0; i < n; i++) m = get_learned(team->w, tiles[i], m + sizeof(tile_head));
}

void bis_team_gather(bis_team *team)
{
    bis_crew *crew = team->crew;

    if (!team->w->visibility.n_tiles) return;
    call_others(team, GATHER, NULL, BIS_OK);
    make_lists(team);
    for (int rank = 1; rank < crew->size; rank++) {
        for (int i = team->next[rank], n; i < team->end[rank]; i += n) {
            n = team->end[rank] - i < MOST_TILES ? team->end[rank] - i : MOST_TILES;
            fetch(team, rank, team->order + i, n);
        }
        crew->send(crew, rank, &(head){.kind = STOP}, sizeof(head));
    }
}

/* Before the first pass after a checkpoint rank 0 has all that was learned. */
static void own_all(bis_team *team)
{
    for (int t = 0; t < team->w->n_tiles; t++) team->owner[t] = 0;
}

void bis_team_begin(bis_team *team, void (*progress)(double share, void *user), void *user)
{
    const bis_workspace *w = team->w;

    team->progress = progress;
    team->user = user;
    team->over = false;
    team->n_held = team->n_received = 0;
    team->n_queued = team->n_taken = team->n_finished = team->n_sent = 0;
    if (team->crew->rank > 0) return;
    if (!team->knows && w->film->passes && w->visibility.n_tiles) own_all(team);
    make_lists(team);
    memset(team->work, 0, (size_t)team->crew->size * sizeof *team->work);
    for (int round = 0; round < 2; round++)
        for (int i = 1; i < team->crew->size; i++) deal(team, i);
}

int bis_team_next(bis_team *team, int thread)
{
    const bool leads = team->crew->rank == 0;
    bool over;

    if (thread == 0) return leads ? lead(team) : follow(team);
    for (;;) {
        const int t = leads ? take_at_rank_0(team) : take_queued(team);
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
#pragma omp critical(bis_team)
    team->finished[team->n_finished++] = tile;
    if (team->crew->rank == 0 && thread == 0) tell_progress(team);
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
