/* team: ranks that are threads of this program, and a crew that is a box of letters for each. So what travels can be
 * counted, and a rank can be made slow. The expected pictures are those of one process. What a tile has learned is
 * worth more than its pixels, in bytes: a rank that sends to another one than rank 0, or rank 0 more than numbers of
 * tiles, moves what was learned. */
#include "bis/base/mem.h"
#include "render/checkpoint.h"
#include "render/crew.h"

#include "world.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define DIR_NAME "build/test_team"
#define STATE DIR_NAME "/state"

enum { MOST_RANKS = 18, SIDE = 100, TILES = 49, LEARNED = 8192 /* bytes of a tile */ };

/* ---- a crew of threads ---- */

typedef struct letter {
    struct letter *next;
    int from;
    size_t n;
    unsigned char data[];
} letter;

typedef struct post post;

typedef struct member {
    bis_crew crew; /* first: the crew leads to it */
    post *post;
    letter *first, **last, *opened;
    int nap; /* microseconds, each time that it looks for a letter */
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
    size_t from_0, to_0, between_others; /* bytes of letters */
    int held[MOST_RANKS]; /* tiles that rank 0 has sent to a rank to render, and has not got back */
    int n_batches, n_too_early;
};

/* A letter begins with its kind and its number of tiles (team.c). A rank is to have at most one batch besides the one
 * that it gets. */
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

/* Stops the render at the first letter to rank 0 after so many broadcasts: a tile is then done in that pass. */
static volatile sig_atomic_t interrupted;
static int broadcasts_left;

static void broadcast(bis_crew *crew, void *data, size_t n)
{
    post *p = ((member *)crew)->post;
    if (crew->rank == 0) {
        p->shared = data;
        broadcasts_left--;
    }
    pthread_barrier_wait(&p->all);
    if (crew->rank > 0) memcpy(data, p->shared, n);
    pthread_barrier_wait(&p->all);
}

static void join_bits(bis_crew *crew, unsigned char *data, size_t n)
{
    post *p = ((member *)crew)->post;
    if (crew->rank == 0) p->shared = data;
    pthread_barrier_wait(&p->all);
    pthread_mutex_lock(&p->lock);
    for (size_t i = 0; i < n && crew->rank > 0; i++) ((unsigned char *)p->shared)[i] |= data[i];
    pthread_mutex_unlock(&p->lock);
    pthread_barrier_wait(&p->all);
    if (crew->rank > 0) memcpy(data, p->shared, n);
    pthread_barrier_wait(&p->all);
}

static void send_letter(bis_crew *crew, int to, const void *data, size_t n)
{
    post *p = ((member *)crew)->post;
    letter *l = malloc(sizeof *l + n);
    if (!l) abort();
    *l = (letter){.from = crew->rank, .n = n};
    memcpy(l->data, data, n);
    pthread_mutex_lock(&p->lock);
    *(crew->rank == 0 ? &p->from_0 : to == 0 ? &p->to_0 : &p->between_others) += n;
    if (to == 0 && broadcasts_left == 0) interrupted = 1;
    if (crew->rank == 0) count_held(p, to, data);
    *p->members[to].last = l;
    p->members[to].last = &l->next;
    pthread_mutex_unlock(&p->lock);
}

static unsigned char *receive(bis_crew *crew, int *from, size_t *n, bool wait)
{
    member *me = (member *)crew;

    free(me->opened);
    me->opened = NULL;
    if (me->nap) usleep((useconds_t)me->nap);
    for (;; usleep(20)) {
        pthread_mutex_lock(&me->post->lock);
        letter *l = me->opened = me->first;
        if (l) me->first = l->next;
        if (!me->first) me->last = &me->first;
        if (l && crew->rank == 0 && !wait) count_held(me->post, l->from, l->data);
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

static bis_status render_one(bis_film *f, bis_render_result *result, const job *j, bis_crew *crew)
{
    bis_render_options options = j->options;

    options.crew = crew;
    if (!bis_crew_leads(crew)) options.checkpoint = NULL, options.interrupted = NULL;
    bis_status status = bis_film_init(f, SIDE, SIDE, all, (bis_loc){0}, NULL);
    if (!status) status = bis_film_want(f, BIS_LAYERS_ALL, NULL);
    if (!status) status = bis_render(result, f, &j->w->scene, &j->w->desc, &j->w->desc.view, &options, NULL);
    if (options.checkpoint) bis_checkpoint_clear(options.checkpoint);
    return status;
}

static void *run_rank(void *argument)
{
    member *me = argument;
    bis_film film;
    bis_render_result result;

    me->status = render_one(&film, &result, me->job, &me->crew);
    bis_film_clear(&film);
    return NULL;
}

/* Renders with so many ranks; `slow` naps. What it returns, of what travelled, is good until the next call. */
static const post *render_team(int ranks, int slow, const job *j)
{
    static post p;
    p = (post){.from_0 = 0};
    assert_int_equal(pthread_mutex_init(&p.lock, NULL), 0);
    assert_int_equal(pthread_barrier_init(&p.all, NULL, (unsigned)ranks), 0);
    for (int i = 0; i < ranks; i++) {
        member *m = &p.members[i];
        m->crew = (bis_crew){.rank = i, .size = ranks, .host = "here", .broadcast = broadcast, .join_bits = join_bits,
                             .send = send_letter, .receive = receive};
        m->post = &p;
        m->last = &m->first;
        m->job = j;
        m->nap = i == slow ? 3000 : 0;
    }
    for (int i = 1; i < ranks; i++)
        assert_int_equal(pthread_create(&p.members[i].thread, NULL, run_rank, &p.members[i]), 0);
    assert_int_equal(render_one(j->film, j->result, j, &p.members[0].crew), BIS_OK);
    for (int i = 1; i < ranks; i++) {
        assert_int_equal(pthread_join(p.members[i].thread, NULL), 0);
        assert_int_equal(p.members[i].status, BIS_OK);
    }
    for (int i = 0; i < ranks; i++) {
        assert_null(p.members[i].first); /* no letter is left */
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

/* The picture of one process; then that of a team. */
static const post *assert_team_makes_the_same(const world *w, bis_render_options options, int ranks, int slow)
{
    bis_film one, many;
    bis_render_result result_one, result_many;
    job j = {.w = w, .options = options, .film = &one, .result = &result_one};

    assert_int_equal(render_one(&one, &result_one, &j, NULL), BIS_OK);
    j.film = &many;
    j.result = &result_many;
    const post *p = render_team(ranks, slow, &j);
    assert_same(&one, &many, &result_one, &result_many);
    bis_film_clear(&one);
    bis_film_clear(&many);
    return p;
}

static const uint32_t spp = 24; /* 1 + 1 + 2 + 5 passes of 4 */
enum { PASSES = 8 };

/* Whoever is slow, its tiles go to others. When they go is a matter of time: so tiles of another rank than 0 are moved
 * in one of many renders, usually the first, and each has the same bits. */
static void tiles_of_a_slow_rank_move_and_the_bits_stay(void **state)
{
    (void)state;
    world w;
    size_t moved = 0;

    make_learning_world(&w);
    assert_team_makes_the_same(&w, (bis_render_options){.budget = {.spp = spp}, .n_threads = 1}, 3, 0);
    for (int i = 0; i < 20 && moved == 0; i++)
        moved = assert_team_makes_the_same(&w, (bis_render_options){.budget = {.spp = spp}, .n_threads = 1}, 3,
                                           1 + i % 2)->between_others / LEARNED;
    assert_true(moved > 0);
    assert_team_makes_the_same(&w, (bis_render_options){.budget = {.spp = spp}, .n_threads = 2}, 4, 2);
    assert_team_makes_the_same(&w, (bis_render_options){.budget = {.spp = spp}, .n_threads = 1}, MOST_RANKS, 5);
    assert_team_makes_the_same(&w, (bis_render_options){.budget = {.spp = spp}, .n_threads = 2}, MOST_RANKS, 0);
    w.desc.view.adaptive = true;
    assert_team_makes_the_same(&w, (bis_render_options){.budget = {.spp = spp}, .n_threads = 1}, 3, 1);
    w.desc.view.adaptive = false;
    assert_team_makes_the_same(&w, (bis_render_options){.budget = {.error = 0.1, .spp = 60}, .n_threads = 1}, 3, 2);
    clear_world(&w);
}

/* Two ranks: half of the tiles are the other's, whose pixels have 16 bytes and 4 for each value of a layer. What
 * they learned would be more. The first pass has no owners, and at the end of each some may move: so less than half
 * of what would travel if all did. */
static void as_a_rule_only_pixels_travel(void **state)
{
    (void)state;
    world w;

    make_learning_world(&w);
    const post *p = assert_team_makes_the_same(&w, (bis_render_options){.budget = {.spp = spp}, .n_threads = 1}, 2, -1);
    assert_int_equal(p->between_others, 0);
    assert_true(p->from_0 < (size_t)PASSES * TILES / 2 * LEARNED / 2);
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
    (void)state;
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
            const post *p = render_team(runs[i].ranks, 1, &j);
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
    (void)state;
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
        render_team(3, 2, &j);
        assert_true(result.interrupted);
        assert_int_equal(result.passes, done);
        bis_film_clear(&f);
    }
    bis_checkpoint c = {.path = STATE, .every = 1e9};
    assert_int_equal(bis_checkpoint_read(&c, STATE, NULL), BIS_OK);
    j = (job){.w = &w, .film = &f, .result = &result,
              .options = {.budget = {.spp = spp}, .n_threads = 1, .checkpoint = &c}};
    render_team(4, 0, &j);
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
    (void)state;
    world w;

    make_world(&w, &bis_em);
    for (int i = 0; i < 6; i++) {
        const int ranks = 2 + i;
        const post *p = assert_team_makes_the_same(
            &w, (bis_render_options){.budget = {.spp = spp}, .n_threads = 1}, ranks, i % ranks);
        for (int k = 1; k < ranks; k++) assert_int_equal(p->held[k], 0);
        assert_true(p->n_batches > ranks);
        assert_int_equal(p->n_too_early, 0);
    }
    clear_world(&w);
}

static int setup(void **state)
{
    (void)state;
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
    };
    return cmocka_run_group_tests(tests, setup, NULL);
}
