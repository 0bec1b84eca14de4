/* SPDX-License-Identifier: BSD-2-Clause */
/* scheduler: ranks that are threads of this program, whose messages are a box of messages for each. So what travels can
 * be counted, and a rank can be made slow. The expected pictures are those of one process. What a tile has learned is
 * worth more than its pixels, in bytes: a rank that sends to another one than rank 0, or rank 0 more than numbers of
 * tiles, moves what was learned. */
#include "bis/base/clock.h"
#include "bis/base/mem.h"
#include "render/checkpoint.h"
#include "render/pass.h"
#include "render/ranks.h"
#include "render/scheduler_parts.h"

#include "claim.h"
#include "lack.h"
#include "world.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define DIR_NAME "build/test_scheduler"
#define STATE DIR_NAME "/state"

enum { MOST_RANKS = 18, SIDE = 100, TILES = 49, LEARNED = 8192 /* bytes of a tile */ };

/* ---- the ranks of threads ---- */

typedef struct message {
    struct message *next;
    int from;
    size_t n;
    unsigned char data[];
} message;

typedef struct post post;

typedef struct member {
    bis_ranks ranks; /* first: ranks lead to it */
    post *post;
    message *first, **last, *opened;
    int nap; /* microseconds, each time that it looks for a message */
    pthread_t thread;
    const struct job *job;
    bis_status status;
} member;

/* What all have in common: under the lock. */
struct post {
    pthread_mutex_t lock;
    pthread_barrier_t all;
    member members[MOST_RANKS];
    void *shared;
    size_t from_0, to_0, between_others; /* bytes of messages */
    int held[MOST_RANKS]; /* tiles that rank 0 has sent to a rank to render, and has not got back */
    int n_batches, n_too_early;
};

/* A message begins with its kind and its number of tiles (scheduler.c). A rank is to have at most one batch besides the
 * one that it gets. */
enum { LETTER_WORK, LETTER_DONE };

static void count_held(post *p, int rank, const unsigned char *data)
{
    int32_t head[2];
    memcpy(head, data, sizeof head);
    if (head[0] == LETTER_DONE) p->held[rank] -= head[1];
    if (head[0] != LETTER_WORK) return;
    p->n_batches++;
    p->n_too_early += p->held[rank] > head[1];
    p->held[rank] += head[1];
}

/* Stops the render at the first message to rank 0 after so many broadcasts: a tile is then done in that pass. */
static volatile sig_atomic_t interrupted;
static int broadcasts_left;

static void broadcast(bis_ranks *ranks, void *data, size_t n)
{
    post *p = ((member *)ranks)->post;
    if (ranks->rank == 0) {
        p->shared = data;
        broadcasts_left--;
    }
    pthread_barrier_wait(&p->all);
    if (ranks->rank > 0) memcpy(data, p->shared, n);
    pthread_barrier_wait(&p->all);
}

static void join_bits(bis_ranks *ranks, unsigned char *data, size_t n)
{
    post *p = ((member *)ranks)->post;
    if (ranks->rank == 0) p->shared = data;
    pthread_barrier_wait(&p->all);
    pthread_mutex_lock(&p->lock);
    for (size_t i = 0; i < n && ranks->rank > 0; i++) ((unsigned char *)p->shared)[i] |= data[i];
    pthread_mutex_unlock(&p->lock);
    pthread_barrier_wait(&p->all);
    if (ranks->rank > 0) memcpy(data, p->shared, n);
    pthread_barrier_wait(&p->all);
}

static void send_message(bis_ranks *ranks, int to, const void *data, size_t n)
{
    post *p = ((member *)ranks)->post;
    message *l = malloc(sizeof *l + n);
    if (!l) abort();
    *l = (message){.from = ranks->rank, .n = n};
    memcpy(l->data, data, n);
    pthread_mutex_lock(&p->lock);
    *(ranks->rank == 0 ? &p->from_0 : to == 0 ? &p->to_0 : &p->between_others) += n;
    if (to == 0 && broadcasts_left == 0) __atomic_store_n(&interrupted, 1, __ATOMIC_RELAXED);
    if (ranks->rank == 0) count_held(p, to, data);
    *p->members[to].last = l;
    p->members[to].last = &l->next;
    pthread_mutex_unlock(&p->lock);
}

static unsigned char *receive(bis_ranks *ranks, int *from, size_t *n, bool wait)
{
    member *me = (member *)ranks;

    free(me->opened);
    me->opened = NULL;
    if (me->nap) usleep((useconds_t)me->nap);
    for (;; usleep(20)) {
        pthread_mutex_lock(&me->post->lock);
        message *l = me->opened = me->first;
        if (l) me->first = l->next;
        if (!me->first) me->last = &me->first;
        if (l && ranks->rank == 0 && !wait) count_held(me->post, l->from, l->data);
        pthread_mutex_unlock(&me->post->lock);
        if (!l && wait) continue;
        if (!l) return NULL;
        *from = l->from;
        *n = l->n;
        return l->data;
    }
}

/* ---- renders ---- */

typedef struct job {
    const world *w;
    bis_render_options options;
    bis_film *film; /* of rank 0 */
    bis_render_result *result;
} job;

static const double all[4] = {0, 1, 0, 1};

static bis_status render_one(bis_film *f, bis_render_result *result, const job *j, bis_ranks *ranks)
{
    bis_render_options options = j->options;

    options.ranks = ranks;
    if (!bis_rank_leads(ranks)) options.checkpoint = NULL, options.interrupted = NULL;
    bis_status status = bis_film_init(f, SIDE, SIDE, all, (bis_loc){0}, NULL);
    if (!status) status = bis_film_want(f, BIS_LAYERS_ALL, NULL);
    if (!status) status = bis_render(result, f, &j->w->scene, &j->w->desc.view, &options, NULL);
    if (options.checkpoint) bis_checkpoint_clear(options.checkpoint);
    return status;
}

static void *run_rank(void *argument)
{
    member *me = argument;
    bis_film film;
    bis_render_result result;

    me->status = render_one(&film, &result, me->job, &me->ranks);
    bis_film_clear(&film);
    return NULL;
}

/* Renders with so many ranks; `slow` naps. What it returns, of what travelled, is good until the next call. */
static const post *render_ranks(int ranks, int slow, const job *j)
{
    static post p;
    p = (post){.from_0 = 0};
    assert_int_equal(pthread_mutex_init(&p.lock, NULL), 0);
    assert_int_equal(pthread_barrier_init(&p.all, NULL, (unsigned)ranks), 0);
    for (int i = 0; i < ranks; i++) {
        member *m = &p.members[i];
        m->ranks = (bis_ranks){.rank = i, .size = ranks, .host = "here", .broadcast = broadcast, .join_bits = join_bits,
                             .send = send_message, .receive = receive};
        m->post = &p;
        m->last = &m->first;
        m->job = j;
        m->nap = i == slow ? 3000 : 0;
    }
    for (int i = 1; i < ranks; i++)
        assert_int_equal(pthread_create(&p.members[i].thread, NULL, run_rank, &p.members[i]), 0);
    assert_int_equal(render_one(j->film, j->result, j, &p.members[0].ranks), BIS_OK);
    for (int i = 1; i < ranks; i++) {
        assert_int_equal(pthread_join(p.members[i].thread, NULL), 0);
        assert_int_equal(p.members[i].status, BIS_OK);
    }
    for (int i = 0; i < ranks; i++) {
        assert_null(p.members[i].first); /* no message is left */
        free(p.members[i].opened);
    }
    pthread_barrier_destroy(&p.all);
    pthread_mutex_destroy(&p.lock);
    return &p;
}

static void make_learning_world(world *w)
{
    make_world(w, &bis_sir);
    w->desc.view.settings.proposal = BIS_PROPOSAL_PRODUCT;
    w->desc.view.settings.learn = true;
    w->desc.view.edge_samples = 3;
}

static void assert_same(const bis_film *a, const bis_film *b, const bis_render_result *r, const bis_render_result *s)
{
    const size_t n = (size_t)SIDE * SIDE * (size_t)a->layers.n_values;
    assert_same_bits(a, b);
    assert_memory_equal(a->layers.sum, b->layers.sum, n * sizeof *a->layers.sum);
    assert_int_equal(a->passes, b->passes);
    assert_memory_equal(&r->counters, &s->counters, sizeof r->counters);
}

/* The picture of one process, with one thread. */
typedef struct picture {
    bis_film film;
    bis_render_result result;
} picture;

static void make_alone(picture *one, const world *w, bis_budget budget)
{
    const job j = {.w = w, .options = {.budget = budget, .n_threads = 1}};

    assert_int_equal(render_one(&one->film, &one->result, &j, NULL), BIS_OK);
}

/* The picture of a scheduler. */
static const post *assert_team_makes_the_same(const picture *one, const world *w, bis_render_options options,
                                              int ranks, int slow)
{
    picture many;
    job j = {.w = w, .options = options, .film = &many.film, .result = &many.result};

    const post *p = render_ranks(ranks, slow, &j);
    assert_same(&one->film, &many.film, &one->result, &many.result);
    assert_true(many.result.bytes > one->result.bytes); /* there is a scheduler as well */
    bis_film_clear(&many.film);
    return p;
}

static const uint32_t spp = 24; /* 1 + 1 + 2 + 5 passes of 4 */
enum { PASSES = 8 };

/* Whoever is slow, its tiles go to others. When they go is a matter of time: so tiles of another rank than 0 are moved
 * in one of many renders, usually the first, and each has the same bits. */
static void tiles_of_a_slow_rank_move_and_the_bits_stay(void **state)
{
    world w;
    picture one, to_an_error;
    size_t moved = 0;
    const bis_budget error = {.error = 0.1, .spp = 60};
    const bis_render_options narrow = {.budget = {.spp = spp}, .n_threads = 1},
                             wide = {.budget = {.spp = spp}, .n_threads = 2};

    make_learning_world(&w);
    make_alone(&one, &w, narrow.budget);
    assert_team_makes_the_same(&one, &w, narrow, 3, 0);
    for (int i = 0; i < 20 && moved == 0; i++)
        moved = assert_team_makes_the_same(&one, &w, narrow, 3, 1 + i % 2)->between_others / LEARNED;
    assert_true(moved > 0);
    assert_team_makes_the_same(&one, &w, wide, 4, 2);
    assert_team_makes_the_same(&one, &w, narrow, MOST_RANKS, 5);
    assert_team_makes_the_same(&one, &w, wide, MOST_RANKS, 0);
    make_alone(&to_an_error, &w, error);
    assert_team_makes_the_same(&to_an_error, &w, (bis_render_options){.budget = error, .n_threads = 1}, 3, 2);
    bis_film_clear(&one.film);
    bis_film_clear(&to_an_error.film);
    clear_world(&w);
}

/* Two ranks: half of the tiles are the other's, whose pixels have 16 bytes and 4 for each value of a layer. What
 * they learned would be more. The first pass has no owners, and at the end of each some may move: so less than half
 * of what would travel if all did. */
static void as_a_rule_only_pixels_travel(void **state)
{
    world w;
    picture one;
    const bis_render_options options = {.budget = {.spp = spp}, .n_threads = 1};

    make_learning_world(&w);
    make_alone(&one, &w, options.budget);
    const post *p = assert_team_makes_the_same(&one, &w, options, 2, -1);
    assert_int_equal(p->between_others, 0);
    assert_true(p->from_0 < (size_t)PASSES * TILES / 2 * LEARNED / 2);
    bis_film_clear(&one.film);
    clear_world(&w);
}

/* A world that learns, what one process makes of it, and no checkpoint yet. */
static void begin_afresh(world *w, bis_film *one, bis_render_result *result)
{
    job j = {.w = w, .options = {.budget = {.spp = spp}, .n_threads = 1}, .film = one, .result = result};

    make_learning_world(w);
    unlink(STATE);
    assert_int_equal(render_one(one, result, &j, NULL), BIS_OK);
}

/* 3 ranks, one process, 5 ranks; each goes on from the checkpoint of the one before, and the slow one loses tiles. */
static void a_checkpoint_has_what_all_have_learned(void **state)
{
    static const struct {
        int ranks;
        uint32_t spp;
    } runs[] = {{3, 8}, {1, 12}, {5, 24}};
    world w;
    bis_film one, f;
    bis_render_result result_one, result;
    job j;

    begin_afresh(&w, &one, &result_one);
    for (size_t i = 0; i < sizeof runs / sizeof *runs; i++) {
        bis_checkpoint c = {.path = STATE, .every = i == 0 ? 0 : 1e9}; /* after each pass, or at the end */
        if (i > 0) assert_int_equal(bis_checkpoint_read(&c, STATE, NULL), BIS_OK);
        j = (job){.w = &w, .film = &f, .result = &result,
                  .options = {.budget = {.spp = runs[i].spp}, .n_threads = 1, .checkpoint = &c}};
        if (runs[i].ranks > 1) {
            const post *p = render_ranks(runs[i].ranks, 1, &j);
            /* two batches for each other rank, out of the checkpoint that rank 0 has read */
            if (i > 0) assert_true(p->from_0 >= 2 * (size_t)(runs[i].ranks - 1) * LEARNED);
        } else assert_int_equal(render_one(&f, &result, &j, NULL), BIS_OK);
        assert_false(c.failed);
        if (runs[i].spp == spp) assert_same(&one, &f, &result_one, &result);
        bis_film_clear(&f);
    }
    bis_film_clear(&one);
    clear_world(&w);
}

/* A pass that is given up leaves no trace, also not in what was learned: the next run goes on to the bits of one. */
static void a_pass_that_is_given_up_is_not_learned_from(void **state)
{
    world w;
    bis_film one, f;
    bis_render_result result_one, result;
    job j;

    begin_afresh(&w, &one, &result_one);
    for (uint32_t done = 3; done < 7; done += 3) {
        bis_checkpoint c = {.path = STATE, .every = 1e9};
        if (done > 3) assert_int_equal(bis_checkpoint_read(&c, STATE, NULL), BIS_OK);
        interrupted = 0;
        broadcasts_left = 6; /* two before the first pass; the fourth is stopped */
        j = (job){.w = &w, .film = &f, .result = &result,
                  .options = {.budget = {.spp = spp}, .n_threads = 1, .checkpoint = &c, .interrupted = &interrupted}};
        render_ranks(3, 2, &j);
        assert_true(result.interrupted);
        assert_int_equal(result.passes, done);
        bis_film_clear(&f);
    }
    bis_checkpoint c = {.path = STATE, .every = 1e9};
    assert_int_equal(bis_checkpoint_read(&c, STATE, NULL), BIS_OK);
    j = (job){.w = &w, .film = &f, .result = &result,
              .options = {.budget = {.spp = spp}, .n_threads = 1, .checkpoint = &c}};
    render_ranks(4, 0, &j);
    assert_same(&one, &f, &result_one, &result);
    bis_film_clear(&f);
    bis_film_clear(&one);
    clear_world(&w);
}

/* Without learning every batch goes straight to the rank that renders it. With one thread in a rank a batch is never
 * cut off by the end of its list, so it is as large as the batch that the rank may have in its queue. All tiles come
 * back. */
static void a_rank_has_one_batch_in_its_queue_at_most(void **state)
{
    world w;
    picture one;
    const bis_render_options options = {.budget = {.spp = spp}, .n_threads = 1};

    make_world(&w, &bis_em);
    make_alone(&one, &w, options.budget);
    for (int i = 0; i < 6; i++) {
        const int ranks = 2 + i;
        const post *p = assert_team_makes_the_same(&one, &w, options, ranks, i % ranks);
        for (int k = 1; k < ranks; k++) assert_int_equal(p->held[k], 0);
        assert_true(p->n_batches > ranks);
        assert_int_equal(p->n_too_early, 0);
    }
    bis_film_clear(&one.film);
    clear_world(&w);
}

/* ---- rank 0 alone, whose messages are read by hand ---- */

enum { MOST_SENT = 128, MOST_DEALT = 32 };

typedef struct sent {
    int to;
    bis_sched_head head;
    int tiles[MOST_DEALT];
    bis_sched_tile last;   /* before the last tile */
    unsigned char known;  /* the last byte of what the last tile has learned */
    bool are_own;         /* of DONE: each pixel has the number of its tile */
} sent;

/* ranks that note what rank 0 sends and answer with the messages that the test has left for them. */
typedef struct fake_ranks {
    bis_ranks ranks; /* first: ranks lead to it */
    world world;
    bis_film film;
    bis_workspace w;
    bis_render_options options;
    bis_sched *sched;
    sent sent[MOST_SENT];
    int n_sent, answer_from;
    unsigned char answer[sizeof(bis_sched_head) + MOST_DEALT * (sizeof(bis_sched_tile) + LEARNED)];
    size_t n_answer;
    bool stops;              /* once nothing else is left */
    bool ends;               /* once no message is left for rank 0, no rank holds a tile */
    bool answers_all, gives; /* each message is answered in its turn; or only where tiles are to go to rank 0 */
    int n_answered;
    int n_waits, n_looks; /* how often rank 0 has waited for a message, and looked for one */
    bis_sched_step step; /* the last that was broadcast */
    double progress;
} fake_ranks;

static void note(bis_ranks *ranks, int to, const void *data, size_t n)
{
    fake_ranks *d = (fake_ranks *)ranks;
    const unsigned char *m = data;
    sent *s = &d->sent[d->n_sent++];

    assert_true(d->n_sent < MOST_SENT && n >= sizeof s->head);
    *s = (sent){.to = to, .are_own = true};
    memcpy(&s->head, m, sizeof s->head);
    assert_in_range(s->head.n_tiles, 0, MOST_DEALT);
    m += sizeof s->head;
    for (int i = 0; i < s->head.n_tiles; i++) {
        memcpy(&s->last, m, sizeof s->last);
        m += sizeof s->last;
        s->tiles[i] = s->last.tile;
        const bis_rect r = bis_film_tile(&d->film, BIS_RENDER_TILE, s->last.tile);
        const int n_pixels = s->head.kind == BIS_SCHED_DONE ? (r.x1 - r.x0) * (r.y1 - r.y0) : 0;
        for (int k = 0; k < n_pixels; k++, m += sizeof(bis_pixel_mean)) {
            bis_pixel_mean mean;
            memcpy(&mean, m, sizeof mean);
            s->are_own &= mean.L.r == (float)s->last.tile;
        }
        if (s->head.learned) s->known = (m += LEARNED)[-1];
    }
    assert_int_equal(m - (const unsigned char *)data, n);
}

static void note_step(bis_ranks *ranks, void *data, size_t n)
{
    fake_ranks *d = (fake_ranks *)ranks;
    assert_int_equal(n, sizeof d->step);
    memcpy(&d->step, data, n);
}

static void note_progress(double share, void *user) { ((fake_ranks *)user)->progress = share; }

/* Rank `from` has done n tiles: their pixels are as many as a tile has in the picture, each with the tile's number. */
static void leave_done(fake_ranks *d, int from, double seconds, const int *tiles, int n)
{
    const bis_sched_head h = {.kind = BIS_SCHED_DONE, .n_tiles = n};
    unsigned char *m = bis_sched_put(d->answer, &h, sizeof h);

    for (int k = 0; k < n; k++) {
        const int t = tiles[k];
        const bis_rect r = bis_film_tile(&d->film, BIS_RENDER_TILE, t);
        const bis_sched_tile head = {.tile = t, .seconds = seconds};
        const bis_pixel_mean mean = {{(float)t, (float)(2 * t), 1}, 0.5f};
        m = bis_sched_put(m, &head, sizeof head);
        for (int i = 0; i < (r.x1 - r.x0) * (r.y1 - r.y0); i++) m = bis_sched_put(m, &mean, sizeof mean);
    }
    d->answer_from = from;
    d->n_answer = (size_t)(m - d->answer);
}

/* Rank `from` gives n tiles to rank 0: what a tile has learned is its number, byte for byte. */
static void leave_work(fake_ranks *d, int from, const int *tiles, int n)
{
    const bis_sched_head h = {.kind = BIS_SCHED_WORK, .n_tiles = n, .learned = true};
    unsigned char *m = bis_sched_put(d->answer, &h, sizeof h);

    for (int k = 0; k < n; k++) {
        m = bis_sched_put(m, &(bis_sched_tile){.tile = tiles[k]}, sizeof(bis_sched_tile));
        memset(m, tiles[k], LEARNED);
        m += LEARNED;
    }
    d->answer_from = from;
    d->n_answer = (size_t)(m - d->answer);
}

static void answer_message(fake_ranks *d, const sent *s)
{
    if (s->head.kind == BIS_SCHED_GIVE && s->head.to == 0) leave_work(d, s->to, s->tiles, s->head.n_tiles);
    else if (d->answers_all && s->head.kind == BIS_SCHED_GIVE) leave_done(d, s->head.to, 1, s->tiles, s->head.n_tiles);
    else if (d->answers_all && s->head.kind == BIS_SCHED_WORK) leave_done(d, s->to, 1, s->tiles, s->head.n_tiles);
}

static unsigned char *answer(bis_ranks *ranks, int *from, size_t *n, bool wait)
{
    fake_ranks *d = (fake_ranks *)ranks;

    d->n_waits += wait;
    d->n_looks += !wait;
    while ((d->answers_all || d->gives) && !d->n_answer && d->n_answered < d->n_sent)
        answer_message(d, &d->sent[d->n_answered++]);
    if (!d->n_answer && d->stops) {
        const bis_sched_head stop = {.kind = BIS_SCHED_STOP};
        d->stops = false;
        d->n_answer = (size_t)(bis_sched_put(d->answer, &stop, sizeof stop) - d->answer);
    }
    assert_true(d->n_answer || !wait);
    if (!d->n_answer && d->ends) d->sched->n_held = 0;
    if (!d->n_answer) return NULL;
    *from = d->answer_from;
    *n = d->n_answer;
    d->n_answer = 0;
    return d->answer;
}

/* A scheduler of so many ranks, rank i with threads[i], none of them there; a picture of so many tiles. */
static void open_fake_ranks(fake_ranks *d, int ranks, const int *threads, int columns, int rows, bool learns)
{
    *d = (fake_ranks){.ranks = {.size = ranks, .host = "here", .broadcast = note_step, .send = note,
                                .receive = answer}, .options = {.n_threads = 1}};
    if (learns) make_learning_world(&d->world);
    else make_world(&d->world, &bis_em);
    assert_int_equal(bis_film_init(&d->film, 16 * columns - 3, 16 * rows, all, (bis_loc){0}, NULL), BIS_OK);
    d->w = (bis_workspace){.scene = &d->world.scene, .desc = &d->world.desc, .view = &d->world.desc.view,
                           .options = &d->options, .film = &d->film};
    assert_int_equal(bis_workspace_init(&d->w, NULL), BIS_OK);
    assert_int_equal(d->w.n_tiles, columns * rows);
    d->sched = bis_sched_new(&d->ranks, &d->w);
    for (int i = 0; i < ranks; i++) {
        d->sched->threads[i] = threads ? threads[i] : 1;
        d->sched->n_all_threads += d->sched->threads[i];
    }
}

static void close_fake_ranks(fake_ranks *d)
{
    bis_sched_free(d->sched);
    bis_workspace_clear(&d->w);
    bis_film_clear(&d->film);
    clear_world(&d->world);
}

#define LIST(...) (const int[]){__VA_ARGS__}, (int)(sizeof((int[]){__VA_ARGS__}) / sizeof(int))

/* The next message; of GIVE with the rank that is to get the tiles. */
static void expect_message(const fake_ranks *d, int *at, int to, bis_sched_kind kind, int give_to, bool learned,
                           const int *tiles, int n)
{
    const sent *s = &d->sent[(*at)++];

    assert_true(*at <= d->n_sent);
    assert_int_equal(s->to, to);
    assert_int_equal(s->head.kind, kind);
    assert_int_equal(s->head.learned, learned);
    if (kind == BIS_SCHED_GIVE) assert_int_equal(s->head.to, give_to);
    assert_int_equal(s->head.n_tiles, n);
    for (int i = 0; i < n; i++) assert_int_equal(s->tiles[i], tiles[i]);
}

static void expect_work(const fake_ranks *d, int *at, int to, const int *tiles, int n)
{
    expect_message(d, at, to, BIS_SCHED_WORK, 0, false, tiles, n);
}

/* 49 tiles that are alike, nobody's; threads 1, 2, 1. A batch is worth left x threads/16, but has a tile for each
 * thread: 49 x 2/16 = 6.1 for rank 1, then 43/16 = 2.7 for rank 2. Next rank 1 has 6 > 41 x 2/16 = 5.1 tiles and
 * waits; rank 2 gets 41/16 = 2.6. */
static void the_first_batches_are_those_by_hand(void **state)
{
    static fake_ranks d;
    int at = 0;

    open_fake_ranks(&d, 3, (const int[]){1, 2, 1}, 7, 7, false);
    bis_sched_begin(d.sched, note_progress, &d);
    expect_work(&d, &at, 1, LIST(0, 1, 2, 3, 4, 5));
    expect_work(&d, &at, 2, LIST(6, 7));
    expect_work(&d, &at, 2, LIST(8, 9));
    assert_int_equal(d.n_sent, at);
    assert_int_equal(bis_sched_deal_next(d.sched), 10); /* its own; 38 are left */
    assert_int_equal(d.n_sent, at);
    bis_sched_finish(d.sched, 0, 10, 1);
    assert_true(d.progress == 1 / 49.0);

    /* 2 of 4 come back, and 38/16 = 2.4 go; rank 0 takes the next */
    leave_done(&d, 2, 0.25, LIST(6, 7));
    assert_int_equal(bis_sched_deal_next(d.sched), 13);
    expect_work(&d, &at, 2, LIST(11, 12));
    assert_true(d.progress == 3 / 49.0);
    assert_true(d.sched->seconds[6] == 0.25 && d.sched->seconds[7] == 0.25 && d.sched->seconds[8] == 0);
    for (int y = 0; y < d.film.height; y++)
        for (int x = 0; x < d.film.width; x++) {
            const int t = y / 16 * 7 + x / 16;
            const bis_pixel_mean *p = &d.w.pass[y * d.film.width + x];
            const float wanted = t == 6 || t == 7 ? (float)t : 0;
            assert_true(p->L.r == wanted && p->L.g == 2 * wanted && p->hit == (wanted > 0 ? 0.5f : 0));
        }

    /* one of 4 is not enough: 3 held; 35 x 2/16 = 4.4 */
    leave_done(&d, 1, 1, LIST(0));
    assert_int_equal(bis_sched_deal_next(d.sched), 14);
    assert_int_equal(d.n_sent, at); /* holds 5, and may hold 4 */
    leave_done(&d, 1, 1, LIST(1));
    assert_int_equal(bis_sched_deal_next(d.sched), 19); /* 34 x 2/16 = 4.25 */
    expect_work(&d, &at, 1, LIST(15, 16, 17, 18));
    assert_int_equal(d.n_sent, at);
    close_fake_ranks(&d);
}

/* The next pass: no message is on its way, and no rank has a tile. */
static void begin_anew(fake_ranks *d, int *at)
{
    memset(d->sched->held, 0, 3 * sizeof *d->sched->held);
    d->n_sent = *at = 0;
    bis_sched_begin(d->sched, note_progress, d);
}

/* The seconds of the last pass: 0.64 for tile 20, 0.32 and 0.325 for 33 and 7, which are alike to a 64th of the most,
 * 0.01 for the others, 1.745 in all. Rank 1 gets a tile for each thread, 20 and 7, though they are worth more than
 * 1.745 x 2/16 = 0.22; rank 2 tile 33, though it is worth more than 0.78/16. Then 0.46 x 2/16 = 0.0575 and 0.41/16 =
 * 0.0256 seconds: 5 tiles, 2 tiles. */
static void costly_tiles_come_first_and_batches_are_shares_of_seconds(void **state)
{
    static fake_ranks d;
    int at = 0;

    open_fake_ranks(&d, 3, (const int[]){1, 2, 1}, 7, 7, false);
    for (int t = 0; t < 49; t++) d.sched->seconds[t] = t == 20 ? 0.64 : t == 33 ? 0.32 : t == 7 ? 0.325 : 0.01;
    d.sched->knows = true;
    bis_sched_begin(d.sched, note_progress, &d);
    expect_work(&d, &at, 1, LIST(20, 7));
    expect_work(&d, &at, 2, LIST(33));
    expect_work(&d, &at, 1, LIST(0, 1, 2, 3, 4));
    expect_work(&d, &at, 2, LIST(5, 6));
    assert_int_equal(d.n_sent, at);
    assert_int_equal(bis_sched_deal_next(d.sched), 8);
    assert_int_equal(bis_sched_deal_next(d.sched), 9);
    /* nothing is known: no order, whatever stands in the seconds */
    d.sched->knows = false;
    for (int t = 0; t < 49; t++) d.sched->seconds[t] *= 100;
    begin_anew(&d, &at);
    expect_work(&d, &at, 1, LIST(0, 1, 2, 3, 4, 5));
    close_fake_ranks(&d);
}

/* Who owns what decides who gets what: first its own tiles, then those of nobody, then those of the rank that has
 * most left: from rank 0 with what they have learned, from another one by a GIVE. The batches: 49 x 2/16 = 6.1, 43/16
 * = 2.7 and so on, as far as the list goes. */
static void tiles_go_to_their_owners_first(void **state)
{
    static fake_ranks d;
    int at = 0;

    open_fake_ranks(&d, 3, (const int[]){1, 2, 1}, 7, 7, true);
    assert_true(d.w.visibility.n_tiles == 49 && d.w.visibility.cells * sizeof(bis_seen) == LEARNED);

    /* 10 of rank 1, 10 of rank 2, 10 of rank 0, 19 of nobody */
    for (int t = 0; t < 49; t++) d.sched->owner[t] = t < 10 ? 1 : t < 20 ? 2 : t < 30 ? 0 : BIS_SCHED_NOBODY;
    bis_sched_begin(d.sched, note_progress, &d);
    expect_work(&d, &at, 1, LIST(0, 1, 2, 3, 4, 5));
    expect_work(&d, &at, 2, LIST(10, 11));
    expect_work(&d, &at, 2, LIST(12, 13));
    assert_int_equal(d.n_sent, at);
    leave_done(&d, 1, 1, LIST(0, 1, 2, 3, 4, 5)); /* 39 left: 4.9, but there are 4 in its list */
    assert_int_equal(bis_sched_deal_next(d.sched), 20);
    expect_work(&d, &at, 1, LIST(6, 7, 8, 9));
    leave_done(&d, 1, 1, LIST(6, 7, 8, 9)); /* 34 left: 4.25 */
    assert_int_equal(bis_sched_deal_next(d.sched), 21);
    expect_work(&d, &at, 1, LIST(30, 31, 32, 33));
    assert_int_equal(d.n_sent, at);
    for (int t = 28; t < 37; t++)
        assert_int_equal(d.sched->owner[t], t < 30 ? 0 : t < 34 ? 1 : BIS_SCHED_NOBODY);

    /* 2 of rank 1, 38 of rank 2, 9 of rank 0: rank 1 gets those of rank 2: 45 x 2/16 = 5.6; 40/16 = 2.5 */
    for (int t = 0; t < 49; t++) d.sched->owner[t] = t < 2 ? 1 : t < 40 ? 2 : 0;
    begin_anew(&d, &at);
    expect_work(&d, &at, 1, LIST(0, 1));
    expect_work(&d, &at, 2, LIST(2, 3));
    expect_message(&d, &at, 2, BIS_SCHED_GIVE, 1, false, LIST(4, 5, 6, 7, 8));
    expect_work(&d, &at, 2, LIST(9, 10));
    assert_int_equal(d.n_sent, at);
    assert_true(d.sched->owner[4] == 1 && d.sched->owner[8] == 1 && d.sched->owner[9] == 2);

    /* 1 of rank 1, 1 of nobody: two batches are all that is dealt ahead, though rank 1 could hold a third; 48/16 = 3 */
    for (int t = 0; t < 49; t++) d.sched->owner[t] = t == 0 ? 1 : t == 1 ? BIS_SCHED_NOBODY : t >= 10 && t < 20 ? 2 : 0;
    begin_anew(&d, &at);
    expect_work(&d, &at, 1, LIST(0));
    expect_work(&d, &at, 2, LIST(10, 11, 12));
    expect_work(&d, &at, 1, LIST(1));
    assert_int_equal(d.n_sent, at);

    /* 10 of rank 2, 37 of rank 0 */
    for (int t = 0; t < 49; t++) d.sched->owner[t] = t < 2 ? 1 : t < 12 ? 2 : 0;
    begin_anew(&d, &at);
    expect_work(&d, &at, 1, LIST(0, 1));
    expect_work(&d, &at, 2, LIST(2, 3));
    expect_message(&d, &at, 1, BIS_SCHED_WORK, 0, true, LIST(12, 13, 14, 15, 16));
    expect_work(&d, &at, 2, LIST(4, 5));
    assert_int_equal(d.n_sent, at);
    close_fake_ranks(&d);
}

static void who_has_no_tiles_gets_those_of_who_has_most(void **state)
{
    static fake_ranks d;
    int at = 0;

    open_fake_ranks(&d, 3, (const int[]){1, 2, 1}, 7, 7, true);
    /* all of rank 1: rank 2 gets 43/16 = 2.7 and 41/16; rank 0 has none, and asks for 39/16 */
    for (int t = 0; t < 49; t++) d.sched->owner[t] = 1;
    bis_sched_begin(d.sched, note_progress, &d);
    expect_work(&d, &at, 1, LIST(0, 1, 2, 3, 4, 5));
    expect_message(&d, &at, 1, BIS_SCHED_GIVE, 2, false, LIST(6, 7));
    expect_message(&d, &at, 1, BIS_SCHED_GIVE, 2, false, LIST(8, 9));
    assert_int_equal(d.n_sent, at);
    assert_int_equal(bis_sched_deal_take(d.sched), -1);
    /* rank 1 has done 4, and gets 39 x 2/16 = 4.9; rank 0 asks for 35/16 = 2.2 and waits; later for 33/16 */
    leave_done(&d, 1, 1, LIST(0, 1, 2, 3));
    d.gives = true;
    d.n_answered = d.n_sent;
    assert_int_equal(bis_sched_deal_next(d.sched), 14);
    expect_work(&d, &at, 1, LIST(10, 11, 12, 13));
    expect_message(&d, &at, 1, BIS_SCHED_GIVE, 0, false, LIST(14, 15));
    assert_int_equal(d.n_sent, at);
    assert_true(d.sched->owner[14] == 0 && d.sched->owner[16] == 1 && d.sched->held[0] == 0);
    const unsigned char *known = (const unsigned char *)d.w.visibility.known;
    for (size_t i = 0; i < 49 * LEARNED; i++)
        assert_int_equal(known[i], i / LEARNED == 14 || i / LEARNED == 15 ? i / LEARNED : 0);
    assert_int_equal(bis_sched_deal_next(d.sched), 15);
    expect_message(&d, &at, 1, BIS_SCHED_GIVE, 0, false, LIST(16, 17));
    assert_int_equal(d.n_sent, at);
    close_fake_ranks(&d);
}

/* 17 ranks of one thread: rank 0 only deals. 160 tiles that are alike: left/68 is 2 for as long as 136 are left,
 * which is when rank 13 gets its own; the last three get one. Then 131/68 = 1.9: whoever holds 2 has enough, and gets
 * none. */
static void among_many_ranks_who_has_enough_to_do_gets_none(void **state)
{
    static fake_ranks d;
    int at = 0;

    open_fake_ranks(&d, 17, NULL, 16, 10, false);
    bis_sched_begin(d.sched, note_progress, &d);
    for (int i = 1; i <= 13; i++) expect_work(&d, &at, i, LIST(2 * i - 2, 2 * i - 1));
    for (int i = 14; i <= 16; i++) expect_work(&d, &at, i, LIST(12 + i));
    for (int i = 14; i <= 16; i++) expect_work(&d, &at, i, LIST(15 + i));
    assert_int_equal(d.n_sent, at);
    /* one of two comes back: the other one is worth less than 128/68 = 1.9, so one goes; then one less than 127/68 */
    d.ends = true;
    for (int t = 0; t < 2; t++) {
        leave_done(&d, 1, 1, LIST(t));
        assert_int_equal(bis_sched_deal_next(d.sched), -1);
        expect_work(&d, &at, 1, LIST(32 + t));
        for (int i = 1; i < 17; i++) expect_message(&d, &at, i, BIS_SCHED_STOP, 0, false, NULL, 0);
        assert_int_equal(d.n_sent, at);
    }
    close_fake_ranks(&d);

    /* up to 16 ranks each gets a second one, though 49/64 is less than a tile, and rank 0 renders */
    for (int ranks = 16; ranks <= 17; ranks++) {
        at = 0;
        open_fake_ranks(&d, ranks, NULL, 7, 7, false);
        bis_sched_begin(d.sched, note_progress, &d);
        for (int i = 1; i < ranks; i++) expect_work(&d, &at, i, LIST(i - 1));
        for (int i = 1; i < ranks && ranks == 16; i++) expect_work(&d, &at, i, LIST(14 + i));
        assert_int_equal(d.n_sent, at);
        if (ranks == 16) assert_int_equal(bis_sched_deal_next(d.sched), 30);
        close_fake_ranks(&d);
    }
}

/* 17 ranks: the thread of rank 0 that deals renders no tiles, and asks for none unless there is another thread. All
 * tiles are rank 1's, and each rank gets one; two threads then need two. */
static void among_many_ranks_the_first_asks_for_its_other_threads(void **state)
{
    for (int threads = 1; threads <= 2; threads++) {
        static fake_ranks d;
        int at = 0, of[17];

        for (int i = 0; i < 17; i++) of[i] = i ? 1 : threads;
        open_fake_ranks(&d, 17, of, 7, 7, true);
        for (int t = 0; t < 49; t++) d.sched->owner[t] = 1;
        bis_sched_begin(d.sched, note_progress, &d);
        expect_work(&d, &at, 1, LIST(0));
        for (int i = 2; i <= 16; i++) expect_message(&d, &at, 1, BIS_SCHED_GIVE, i, false, LIST(i - 1));
        assert_int_equal(d.n_sent, at);
        d.gives = d.ends = true;
        assert_int_equal(bis_sched_deal_next(d.sched), -1);
        if (threads == 2) expect_message(&d, &at, 1, BIS_SCHED_GIVE, 0, false, LIST(16, 17));
        for (int i = 1; i < 17; i++) expect_message(&d, &at, i, BIS_SCHED_STOP, 0, false, NULL, 0);
        assert_int_equal(d.n_sent, at);
        close_fake_ranks(&d);
    }
}

/* Another rank: 20 tiles come. What is done goes as soon as it is as much as waits in the queue, or 8: after 8 (12
 * wait), 14 (6 wait), 17 (3), 19 (1) and 20. Tiles that rank 0 wants for another rank go there, with what they have
 * learned. */
static void what_is_done_goes_before_the_queue_is_empty(void **state)
{
    static const int batches[21] = {[8] = 8, [14] = 6, [17] = 3, [19] = 2, [20] = 1};
    static fake_ranks d;
    int at = 0;

    open_fake_ranks(&d, 3, (const int[]){1, 2, 1}, 7, 7, true);
    d.ranks.rank = 1;
    for (int i = 0; i < d.film.width * d.film.height; i++)
        d.w.pass[i].L.r = (float)(i / d.film.width / 16 * 7 + i % d.film.width / 16);
    bis_sched_begin(d.sched, note_progress, &d);
    assert_int_equal(d.n_sent, 0);
    leave_work(&d, 0, LIST(40, 41, 42, 43, 44, 45, 46, 47, 48, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20));
    for (int k = 1; k <= 20; k++) {
        const int wanted = k < 10 ? 39 + k : k;
        assert_int_equal(bis_sched_work_next(d.sched), wanted);
        bis_sched_finish(d.sched, 0, wanted, 0.5 * k);
        if (k < 20) continue;
        d.stops = true;
        assert_int_equal(bis_sched_work_next(d.sched), -1);
        assert_true(d.sched->over);
    }
    for (int k = 1; k <= 20; k++) {
        if (!batches[k]) continue;
        const sent *s = &d.sent[at++];
        assert_true(s->to == 0 && s->head.kind == BIS_SCHED_DONE && s->are_own && s->head.n_tiles == batches[k]);
        for (int i = 0; i < s->head.n_tiles; i++) {
            const int number = k - s->head.n_tiles + 1 + i;
            assert_int_equal(s->tiles[i], number < 10 ? 39 + number : number);
        }
        assert_true(s->last.seconds == 0.5 * k);
    }
    assert_int_equal(d.n_sent, at);

    /* the next pass: rank 0 wants two of those tiles for rank 2, and one itself */
    for (int to = 2; to >= 0; to -= 2) {
        bis_sched_head give = {.kind = BIS_SCHED_GIVE, .n_tiles = to ? 2 : 1, .to = to};
        unsigned char *m = bis_sched_put(d.answer, &give, sizeof give);
        m = bis_sched_put(m, &(bis_sched_tile){.tile = 10}, sizeof(bis_sched_tile));
        if (to) m = bis_sched_put(m, &(bis_sched_tile){.tile = 47}, sizeof(bis_sched_tile));
        d.n_answer = (size_t)(m - d.answer);
        d.stops = true; /* the next message */
        bis_sched_begin(d.sched, note_progress, &d);
        assert_int_equal(bis_sched_work_next(d.sched), -1);
        if (to) expect_message(&d, &at, 2, BIS_SCHED_WORK, 0, true, LIST(10, 47));
        else expect_message(&d, &at, 0, BIS_SCHED_WORK, 0, true, LIST(10));
        const sent *s = &d.sent[at - 1];
        assert_true(s->known == s->last.tile);
    }
    assert_int_equal(d.n_sent, at);
    close_fake_ranks(&d);
}

/* Tiles that took no time by the clock: a batch is as many as a message holds, and the rest, 17, can be moved as well.
 */
static void tiles_that_took_no_time_are_dealt_out_too(void **state)
{
    static fake_ranks d;
    int at = 0, tiles[49];

    open_fake_ranks(&d, 3, (const int[]){1, 2, 1}, 7, 7, true);
    for (int t = 0; t < 49; t++) tiles[t] = t, d.sched->owner[t] = 1;
    d.sched->knows = true;
    bis_sched_begin(d.sched, note_progress, &d);
    expect_work(&d, &at, 1, tiles, 32);
    expect_message(&d, &at, 1, BIS_SCHED_GIVE, 2, false, tiles + 32, 17);
    assert_int_equal(d.n_sent, at);
    close_fake_ranks(&d);
}

/* For a checkpoint: 40 tiles of rank 1 are more than a message holds; 5 of rank 2; those of rank 0 and nobody stay. */
static void what_others_have_learned_is_asked_for(void **state)
{
    static fake_ranks d;
    int at = 0, tiles[40];

    open_fake_ranks(&d, 3, (const int[]){1, 2, 1}, 7, 7, true);
    for (int t = 0; t < 49; t++) d.sched->owner[t] = t < 2 ? 0 : t < 42 ? 1 : t < 47 ? 2 : BIS_SCHED_NOBODY;
    for (int i = 0; i < 40; i++) tiles[i] = 2 + i;
    d.film.passes = 7;
    d.gives = true;
    bis_sched_gather(d.sched);
    expect_message(&d, &at, 1, BIS_SCHED_GIVE, 0, false, tiles, 32);
    expect_message(&d, &at, 1, BIS_SCHED_GIVE, 0, false, tiles + 32, 8);
    expect_message(&d, &at, 1, BIS_SCHED_STOP, 0, false, tiles, 0);
    expect_message(&d, &at, 2, BIS_SCHED_GIVE, 0, false, LIST(42, 43, 44, 45, 46));
    expect_message(&d, &at, 2, BIS_SCHED_STOP, 0, false, tiles, 0);
    assert_int_equal(d.n_sent, at);
    assert_true(d.n_waits == 3 && d.n_looks == 0); /* the other ranks need time to answer */
    assert_true(d.step.next == BIS_SCHED_GATHER && d.step.passes == 7 && d.step.status == BIS_OK);
    const unsigned char *known = (const unsigned char *)d.w.visibility.known;
    for (size_t i = 0; i < 49 * LEARNED; i++) {
        const size_t t = i / LEARNED;
        assert_int_equal(known[i], t >= 2 && t < 47 ? t : 0);
    }
    for (int t = 0; t < 49; t++) /* they stay the owners */
        assert_int_equal(d.sched->owner[t], t < 2 ? 0 : t < 42 ? 1 : t < 47 ? 2 : BIS_SCHED_NOBODY);

    /* the first pass after a checkpoint that was read: rank 0 has it all, and sends it with its tiles */
    d.n_sent = at = 0;
    bis_sched_begin(d.sched, note_progress, &d);
    expect_message(&d, &at, 1, BIS_SCHED_WORK, 0, true, LIST(0, 1, 2, 3, 4, 5));
    expect_message(&d, &at, 2, BIS_SCHED_WORK, 0, true, LIST(6, 7));
    assert_int_equal(bis_sched_deal_next(d.sched), 10);
    assert_true(d.sched->owner[0] == 1 && d.sched->owner[6] == 2 && d.sched->owner[10] == 0 && d.sched->owner[48] == 0);
    close_fake_ranks(&d);

    /* nothing is learned: nothing is asked for, and nobody owns anything */
    open_fake_ranks(&d, 3, (const int[]){1, 2, 1}, 7, 7, false);
    d.film.passes = 7;
    bis_sched_gather(d.sched);
    assert_true(d.n_sent == 0 && d.step.passes == 0);
    bis_sched_begin(d.sched, note_progress, &d);
    for (int t = 0; t < 49; t++) assert_int_equal(d.sched->owner[t], BIS_SCHED_NOBODY);

    const bis_pass pass = {.number = 8, .first = 9, .n = 10, .weight = 11};
    bis_sched_call(d.sched, &pass, BIS_OK);
    assert_true(d.step.next == BIS_SCHED_PASS && d.step.passes == 7 && d.step.status == BIS_OK);
    assert_memory_equal(&d.step.pass, &pass, sizeof pass);
    bis_sched_call(d.sched, NULL, BIS_INPUT);
    assert_true(d.step.next == BIS_SCHED_END && d.step.status == BIS_INPUT);
    close_fake_ranks(&d);
}

/* A whole pass: each message is answered in its turn. */
static void every_tile_is_rendered_once(void **state)
{
    static fake_ranks d;

    for (int kind = 0; kind < 6; kind++) {
        int times[49] = {0}, stops[17] = {0}, t;

        open_fake_ranks(&d, kind < 4 ? 4 : 17, NULL, 7, 7, kind & 1);
        for (int i = 0; i < 49 && kind & 1; i++) d.sched->owner[i] = kind == 1 ? 1 : kind == 3 ? i % 5 - 1 : i % 18 - 1;
        d.answers_all = true;
        bis_sched_begin(d.sched, note_progress, &d);
        while ((t = bis_sched_deal_next(d.sched)) >= 0) {
            times[t]++;
            bis_sched_finish(d.sched, 0, t, 1);
        }
        for (int i = 0; i < d.n_sent; i++) {
            const sent *s = &d.sent[i];
            if (s->head.kind == BIS_SCHED_STOP) stops[s->to]++;
            for (int k = 0; k < s->head.n_tiles && s->head.to + (s->head.kind == BIS_SCHED_WORK) > 0; k++)
                times[s->tiles[k]]++;
        }
        for (int i = 0; i < 49; i++) assert_int_equal(times[i], 1);
        for (int i = 0; i < d.ranks.size; i++) {
            assert_int_equal(stops[i], i > 0);
            assert_int_equal(d.sched->held[i], 0);
        }
        assert_true(d.progress == 1 && d.sched->over);
        assert_int_equal(bis_sched_next(d.sched, 1), -1); /* the other threads stop */
        close_fake_ranks(&d);
    }
}

/* What a pass has made of a crop, tile by tile into a message and out of it: all of its pixels, layers and twins, and
 * no other bytes. */
static void pixels_of_a_crop_travel(void **state)
{
    static const double crop[4] = {0.3, 0.95, 0.2, 0.7};
    bis_film f;
    bis_workspace w[2];
    size_t travelled = 0;
    int across;

    assert_int_equal(bis_film_init(&f, SIDE, SIDE, crop, (bis_loc){0}, NULL), BIS_OK);
    assert_int_equal(bis_film_want(&f, BIS_LAYERS_ALL, NULL), BIS_OK);
    assert_int_equal(bis_film_want_twins(&f, NULL), BIS_OK);
    const size_t n = (size_t)f.width * (size_t)f.height, n_values = n * (size_t)f.layers.n_values,
                 n_twins = bis_film_twins(&f);
    for (int k = 0; k < 2; k++)
        w[k] = (bis_workspace){.film = &f, .pass = bis_alloc(n, sizeof *w->pass),
                               .pass_layers = bis_alloc(n_values, sizeof *w->pass_layers),
                               .pass_twins = bis_alloc(n_twins, sizeof *w->pass_twins)};
    for (size_t i = 0; i < n; i++) w->pass[i] = (bis_pixel_mean){{(float)i, 1, 2}, 0.5f};
    for (size_t i = 0; i < n_values; i++) w->pass_layers[i] = (float)i;
    size_t n_here = 0; /* twins in the crop */
    for (bis_twin t = {0}; bis_film_next_twin(&f, bis_film_crop(&f), &t); n_here++)
        w->pass_twins[t.at] = (rgb){(float)t.x, (float)t.y, 3};
    unsigned char *buffer = bis_alloc(1, bis_sched_tile_bytes(w));
    for (int t = 0; t < bis_film_tiles(&f, BIS_RENDER_TILE, &across); t++) {
        const unsigned char *end = bis_sched_put_pixels(buffer, &w[0], t);
        assert_true((size_t)(end - buffer) <= bis_sched_tile_bytes(w));
        assert_ptr_equal(bis_sched_get_pixels(buffer, &w[1], t), end);
        travelled += (size_t)(end - buffer);
    }
    assert_memory_equal(w[1].pass, w[0].pass, n * sizeof *w->pass);
    assert_memory_equal(w[1].pass_layers, w[0].pass_layers, n_values * sizeof *w->pass_layers);
    assert_memory_equal(w[1].pass_twins, w[0].pass_twins, n_twins * sizeof *w->pass_twins);
    assert_int_equal(travelled, 16 * n + 4 * n_values + 12 * n_here);
    for (int k = 0; k < 2; k++) {
        bis_free(w[k].pass);
        bis_free(w[k].pass_layers);
        bis_free(w[k].pass_twins);
    }
    bis_free(buffer);
    bis_film_clear(&f);
}

/* Other threads than the first take tiles from the queue, rank 0's from its lists as well, and tell no progress. */
static void other_threads_take_tiles_and_tell_nothing(void **state)
{
    static fake_ranks d;

    open_fake_ranks(&d, 1, NULL, 7, 7, false);
    d.progress = -1;
    bis_sched_begin(d.sched, note_progress, &d);
    for (int t = 0; t < 49; t++) {
        assert_int_equal(bis_sched_next(d.sched, t % 2), t);
        bis_sched_finish(d.sched, 1, t, 0.5 + t);
        assert_true(d.progress == -1 && d.sched->seconds[t] == 0.5 + t);
        assert_true(d.sched->n_finished == t + 1 && d.sched->finished[t] == t);
    }
    assert_int_equal(bis_sched_next(d.sched, 0), -1);
    assert_int_equal(bis_sched_next(d.sched, 1), -1);
    close_fake_ranks(&d);

    open_fake_ranks(&d, 3, (const int[]){1, 2, 1}, 7, 7, true);
    d.ranks.rank = 1;
    d.progress = -1;
    bis_sched_begin(d.sched, note_progress, &d);
    leave_work(&d, 0, LIST(5, 0, 7));
    assert_int_equal(bis_sched_next(d.sched, 0), 5);
    assert_int_equal(bis_sched_next(d.sched, 1), 0);
    assert_int_equal(bis_sched_next(d.sched, 1), 7);
    for (int t = 5; t <= 7; t++) bis_sched_finish(d.sched, t % 2, t, 1);
    assert_true(d.progress == -1);
    close_fake_ranks(&d);
}

/* What a rank's own tiles have counted is learned, once. */
static void a_rank_learns_from_the_tiles_that_it_has_done(void **state)
{
    static fake_ranks d;

    open_fake_ranks(&d, 3, NULL, 7, 7, true);
    const bis_visibility *v = &d.w.visibility;
    for (int t = 0; t < 49; t++) v->counted[(size_t)t * v->cells].rays[1] = (uint16_t)(t + 1);
    bis_sched_begin(d.sched, note_progress, &d);
    bis_sched_finish(d.sched, 1, 5, 1);
    bis_sched_finish(d.sched, 1, 3, 1);
    for (int k = 0; k < 2; k++) {
        bis_sched_learn(d.sched);
        assert_int_equal(d.sched->n_finished, 0);
        for (int t = 0; t < 49; t++)
            assert_int_equal(v->known[(size_t)t * v->cells].rays[1], t == 3 || t == 5 ? t + 1 : 0);
        v->counted[5 * v->cells].rays[1] = 9;
    }
    close_fake_ranks(&d);
}

static bis_counters counters_sent;

static void keep_counters(bis_ranks *ranks, int to, const void *data, size_t n)
{
    assert_true(to == 0 && n == sizeof counters_sent);
    memcpy(&counters_sent, data, n);
}

static unsigned char *give_counters(bis_ranks *ranks, int *from, size_t *n, bool wait)
{
    assert_true(wait);
    return (unsigned char *)&counters_sent;
}

/* Two threads: rank 1 sends the sum of what they have counted, and rank 0 adds that of two others to its own. */
static void at_the_end_of_a_pass_counters_are_added_up(void **state)
{
    static fake_ranks d;

    for (int rank = 1; rank >= 0; rank--) {
        open_fake_ranks(&d, 3, NULL, 7, 7, false);
        bis_workspace_clear(&d.w);
        d.options.n_threads = 2;
        d.w = (bis_workspace){.scene = &d.world.scene, .desc = &d.world.desc, .view = &d.world.desc.view,
                              .options = &d.options, .film = &d.film};
        assert_int_equal(bis_workspace_init(&d.w, NULL), BIS_OK);
        if (d.w.n_threads < 2) { /* a compiler without OpenMP */
            close_fake_ranks(&d);
            skip();
        }
        d.ranks.rank = rank;
        d.ranks.send = keep_counters;
        d.ranks.receive = give_counters;
        d.w.workers[0].counters = (bis_counters){1, 2, 3, 4, 5, 6};
        d.w.workers[1].counters = (bis_counters){10, 20, 30, 40, 50, 60};
        bis_sched_end(d.sched);
        assert_true(d.sched->knows == (rank == 0));
        if (rank == 1) {
            assert_memory_equal(&counters_sent, &((bis_counters){11, 22, 33, 44, 55, 66}), sizeof counters_sent);
        } else {
            const bis_counters *c = &d.w.workers[0].counters;
            assert_memory_equal(c, &((bis_counters){23, 46, 69, 92, 115, 138}), sizeof *c);
            assert_int_equal(d.w.workers[1].counters.camera_rays, 10);
        }
        close_fake_ranks(&d);
    }
}

/* Rank 0 alone: each of its tiles takes some of the time that passes, and no more than all of it together. */
static void what_tiles_took_is_less_than_the_time_that_passed(void **state)
{
    static fake_ranks d;
    const bis_pass pass = {.number = 0, .n = 1, .first = 0, .weight = 1};
    double sum = 0;

    open_fake_ranks(&d, 1, NULL, 7, 7, false);
    d.w.sched = d.sched;
    const double began = bis_clock_now();
    assert_true(bis_pass_render(&d.w, &pass, note_progress, &d));
    const double passed = bis_clock_now() - began;
    for (int t = 0; t < 49; t++) {
        assert_true(d.sched->seconds[t] > 0);
        sum += d.sched->seconds[t];
    }
    assert_true(sum <= passed && d.sched->knows && d.progress == 1);
    assert_int_equal(d.w.workers[0].counters.camera_rays, d.film.width * d.film.height);
    close_fake_ranks(&d);
}

static void without_memory_there_is_no_scheduler(void **state)
{
    fake_ranks d;
    open_fake_ranks(&d, 3, NULL, 3, 2, false);
    const long live = bis_mem_live();
    FOR_LACK(l) {
        bis_sched *sched;
        LACK(l, (sched = bis_sched_new(&d.ranks, &d.w)) != NULL ? BIS_OK : BIS_NOMEM);
        assert_true((sched != NULL) == l.over);
        bis_sched_free(sched);
        assert_int_equal(bis_mem_live(), live);
        assert_true(!l.over || l.k > 2);
    }
    close_fake_ranks(&d);
}

/* ---- before they begin ---- */

/* Ranks one after the other: the others' reports are kept until rank 0, the last one, asks for them. */
typedef struct reports {
    bis_ranks ranks;
    unsigned char data[2][4096];
    size_t n;
} reports;

static void keep_report(bis_ranks *ranks, int to, const void *data, size_t n)
{
    reports *r = (reports *)ranks;
    assert_true(to == 0 && n <= sizeof r->data[0]);
    memcpy(r->data[ranks->rank - 1], data, n);
    r->n = n;
}

/* Rank 2's comes first. */
static unsigned char *give_report(bis_ranks *ranks, int *from, size_t *n, bool wait)
{
    reports *r = (reports *)ranks;
    static int last = 1;
    *from = last = 3 - last;
    *n = r->n;
    return r->data[*from - 1];
}

static void keep_own(bis_ranks *ranks, void *data, size_t n) {}

static reports three_ranks(void)
{
    return (reports){.ranks = {.size = 3, .host = "here", .broadcast = keep_own, .send = keep_report,
                               .receive = give_report}};
}

/* Of two that fail the lower one is named, by its first error, whose head is said once. */
static void ranks_end_together_where_one_cannot_go_on(void **state)
{
    static const struct { const char *file, *message; } cases[] = {
        {"a.txt", "error: rank 1 on \"here\" cannot go on: a.txt:3: error: gone"},
        {NULL, "error: rank 1 on \"here\" cannot go on: gone"},
        {"bis", "error: rank 1 on \"here\" cannot go on: gone"},
        {NULL, "error: rank 1 on \"here\" cannot go on: no memory for a message"},
    };
    for (size_t i = 0; i < 4; i++) {
        reports r = three_ranks();
        bis_diag theirs = {0}, own = {0};
        r.ranks.rank = 2;
        assert_int_equal(bis_ranks_agree(&r.ranks, BIS_NOMEM, NULL), BIS_NOMEM);
        r.ranks.rank = 1;
        bis_warn(&theirs, (bis_loc){0}, "no error");
        if (i < 3) bis_error(&theirs, BIS_INPUT, (bis_loc){cases[i].file, i ? 0 : 3, 0}, "gone");
        assert_int_equal(bis_ranks_agree(&r.ranks, BIS_INPUT, &theirs), BIS_INPUT);
        r.ranks.rank = 0;
        assert_int_equal(bis_ranks_agree(&r.ranks, BIS_OK, &own), BIS_INPUT);
        assert_int_equal(own.n, 1);
        assert_string_equal(own.messages[0].text, cases[i].message);
        bis_diag_clear(&theirs);
        bis_diag_clear(&own);
    }
    reports r = three_ranks(); /* the twin: nobody fails */
    for (int rank = 2; rank >= 0; rank--) {
        r.ranks.rank = rank;
        assert_int_equal(bis_ranks_agree(&r.ranks, BIS_OK, NULL), BIS_OK);
    }
}

static void ranks_with_another_scene_are_named(void **state)
{
    const uint64_t same[BIS_IDENTITY_PARTS] = {1, 2, 3}, other[BIS_IDENTITY_PARTS] = {1, 0, 4};
    reports r = three_ranks();
    int threads[3];
    bis_diag diag = {0};
    for (int rank = 2; rank >= 1; rank--) {
        r.ranks.rank = rank;
        assert_int_equal(bis_ranks_compare(&r.ranks, rank == 2 ? other : same, 4 + rank, threads, NULL), BIS_OK);
    }
    r.ranks.rank = 0;
    assert_int_equal(bis_ranks_compare(&r.ranks, same, 4, threads, &diag), BIS_INPUT);
    assert_true(threads[0] == 4 && threads[1] == 5 && threads[2] == 6);
    assert_int_equal(diag.n, 1);
    assert_string_equal(diag.messages[0].text, "error: rank 2 on \"here\" has read another scene than rank 0 on "
                        "\"here\". These differ: the layers; the camera. Give all machines the same files");
    bis_diag_clear(&diag);
}

static int setup(void **state)
{
    if (system("rm -rf " DIR_NAME)) return -1;
    return mkdir(DIR_NAME, 0777);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(tiles_of_a_slow_rank_move_and_the_bits_stay),
        cmocka_unit_test(as_a_rule_only_pixels_travel),
        cmocka_unit_test(a_checkpoint_has_what_all_have_learned),
        cmocka_unit_test(a_pass_that_is_given_up_is_not_learned_from),
        cmocka_unit_test(a_rank_has_one_batch_in_its_queue_at_most),
        cmocka_unit_test(the_first_batches_are_those_by_hand),
        cmocka_unit_test(costly_tiles_come_first_and_batches_are_shares_of_seconds),
        cmocka_unit_test(tiles_go_to_their_owners_first),
        cmocka_unit_test(who_has_no_tiles_gets_those_of_who_has_most),
        cmocka_unit_test(among_many_ranks_who_has_enough_to_do_gets_none),
        cmocka_unit_test(among_many_ranks_the_first_asks_for_its_other_threads),
        cmocka_unit_test(what_is_done_goes_before_the_queue_is_empty),
        cmocka_unit_test(tiles_that_took_no_time_are_dealt_out_too),
        cmocka_unit_test(what_others_have_learned_is_asked_for),
        cmocka_unit_test(every_tile_is_rendered_once),
        cmocka_unit_test(pixels_of_a_crop_travel),
        cmocka_unit_test(a_rank_learns_from_the_tiles_that_it_has_done),
        cmocka_unit_test(other_threads_take_tiles_and_tell_nothing),
        cmocka_unit_test(at_the_end_of_a_pass_counters_are_added_up),
        cmocka_unit_test(what_tiles_took_is_less_than_the_time_that_passed),
        cmocka_unit_test(without_memory_there_is_no_scheduler),
        cmocka_unit_test(ranks_end_together_where_one_cannot_go_on),
        cmocka_unit_test(ranks_with_another_scene_are_named),
    };
    return cmocka_run_group_tests(tests, setup, NULL);
}
