/* SPDX-License-Identifier: BSD-2-Clause */
/* team: ranks that are threads of this program, which meet at barriers. The expected pictures are those of one
 * process. */
#include "render/checkpoint.h"
#include "render/ranks.h"

#include "claim.h"
#include "threads.h"
#include "world.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define DIR_NAME "build/test_team"
#define STATE DIR_NAME "/state"

enum { MOST_RANKS = 60, SIDE = 100, TILES = 49 };

/* ---- the ranks of threads ---- */

typedef struct meeting meeting;
typedef struct member {
    bis_ranks ranks; /* first: ranks lead to it */
    meeting *at;
    pthread_t thread;
    void *(*work)(void *member);
    const void *job;
    bis_status status;
} member;

struct meeting {
    pthread_mutex_t lock;
    pthread_barrier_t all;
    member members[MOST_RANKS];
    void *shared;
};

/* Stops the render when so many sums of counters were asked for: in the middle of a pass. */
static volatile sig_atomic_t interrupted;
static int sums_left;

static void broadcast(bis_ranks *ranks, int from, void *data, size_t n)
{
    meeting *p = ((member *)ranks)->at;
    if (ranks->rank == from) p->shared = data;
    pthread_barrier_wait(&p->all);
    if (ranks->rank != from) memcpy(data, p->shared, n);
    pthread_barrier_wait(&p->all);
}

/* Each rank adds its data to that of rank 0, and then takes it. */
static void reduce(bis_ranks *ranks, void *data, size_t n, void (*join)(void *to, const void *from, size_t n))
{
    meeting *p = ((member *)ranks)->at;
    if (ranks->rank == 0) p->shared = data;
    pthread_barrier_wait(&p->all);
    pthread_mutex_lock(&p->lock);
    if (ranks->rank > 0) join(p->shared, data, n);
    pthread_mutex_unlock(&p->lock);
    pthread_barrier_wait(&p->all);
    if (ranks->rank > 0) memcpy(data, p->shared, n);
    pthread_barrier_wait(&p->all);
}

static void or_bytes(void *to, const void *from, size_t n)
{
    for (size_t i = 0; i < n; i++) ((unsigned char *)to)[i] |= ((const unsigned char *)from)[i];
}

static void add_numbers(void *to, const void *from, size_t n)
{
    for (size_t i = 0; i < n / sizeof(uint64_t); i++) ((uint64_t *)to)[i] += ((const uint64_t *)from)[i];
}

static void join_bits(bis_ranks *ranks, unsigned char *data, size_t n)
{
    reduce(ranks, data, n, or_bytes);
}

static void add_up(bis_ranks *ranks, uint64_t *data, size_t n)
{
    if (ranks->rank == 0 && --sums_left == 0) __atomic_store_n(&interrupted, 1, __ATOMIC_RELAXED);
    reduce(ranks, data, n * sizeof *data, add_numbers);
}

/* Lets so many ranks work, and waits for them. */
static const meeting *let_work(int n_ranks, void *(*work)(void *member), const void *job)
{
    static meeting p;
    p = (meeting){.shared = NULL};
    assert_int_equal(pthread_mutex_init(&p.lock, NULL), 0);
    assert_int_equal(pthread_barrier_init(&p.all, NULL, (unsigned)n_ranks), 0);
    for (int i = 0; i < n_ranks; i++)
        p.members[i] = (member){.ranks = {.rank = i, .size = n_ranks, .host = "here", .broadcast = broadcast,
                                          .join_bits = join_bits, .add = add_up},
                                .at = &p, .work = work, .job = job};
    for (int i = 1; i < n_ranks; i++)
        assert_int_equal(pthread_create(&p.members[i].thread, NULL, work, &p.members[i]), 0);
    work(&p.members[0]);
    for (int i = 1; i < n_ranks; i++) assert_int_equal(pthread_join(p.members[i].thread, NULL), 0);
    pthread_barrier_destroy(&p.all);
    pthread_mutex_destroy(&p.lock);
    return &p;
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
    const job *j = me->job;
    bis_film film;
    bis_render_result result;

    if (me->ranks.rank == 0) {
        me->status = render_one(j->film, j->result, j, &me->ranks);
        return NULL;
    }
    me->status = render_one(&film, &result, j, &me->ranks);
    bis_film_clear(&film);
    return NULL;
}

static const meeting *render_ranks(int n_ranks, const job *j)
{
    const meeting *p = let_work(n_ranks, run_rank, j);
    for (int i = 0; i < n_ranks; i++) assert_int_equal(p->members[i].status, BIS_OK);
    return p;
}

static void make_learning_world(world *w)
{
    make_world(w, &bis_sir);
    w->desc.view.settings.proposal = BIS_PROPOSAL_PRODUCT;
    w->desc.view.settings.learn = true;
    w->desc.view.edge_samples = 3;
}

typedef struct picture {
    bis_film film;
    bis_render_result result;
} picture;

static void assert_same(const picture *a, const picture *b)
{
    const size_t n = (size_t)SIDE * SIDE * (size_t)a->film.layers.n_values;
    assert_same_bits(&a->film, &b->film);
    assert_memory_equal(a->film.layers.sum, b->film.layers.sum, n * sizeof *a->film.layers.sum);
    assert_int_equal(a->film.passes, b->film.passes);
    assert_memory_equal(&a->result.counters, &b->result.counters, sizeof a->result.counters);
}

/* Of one process, with one thread; of ranks. */
static void make_alone(picture *one, const world *w, bis_render_options options)
{
    const job j = {.w = w, .options = options};
    assert_int_equal(render_one(&one->film, &one->result, &j, NULL), BIS_OK);
}

static const meeting *make_by_ranks(picture *many, const world *w, bis_render_options options, int n_ranks)
{
    const job j = {.w = w, .options = options, .film = &many->film, .result = &many->result};
    return render_ranks(n_ranks, &j);
}

enum { SPP = 24 };
static const bis_render_options narrow = {.budget = {.spp = SPP}, .n_threads = 1};

/* Up to more ranks than tiles, with any number of threads, under both budgets. */
static void any_number_of_ranks_makes_the_bits_of_one(void **state)
{
    static const struct {
        int ranks, threads;
        double error;
    } cases[] = {{2, 1, 0}, {3, 2, 0}, {18, 1, 0}, {TILES + 3, 1, 0}, {3, 1, 0.1}};
    world w;

    make_learning_world(&w);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        bis_render_options options = {.budget = {.spp = cases[i].error > 0 ? 60 : SPP, .error = cases[i].error},
                                      .n_threads = 1};
        picture one, many;
        make_alone(&one, &w, options);
        options.n_threads = cases[i].threads;
        make_by_ranks(&many, &w, options, cases[i].ranks);
        assert_same(&one, &many);
        assert_int_equal(many.result.n_threads, cases[i].ranks * threads_of(cases[i].threads));
        bis_film_clear(&one.film);
        bis_film_clear(&many.film);
    }
    clear_world(&w);
}

/* 3 ranks, one process, 5 ranks; each goes on from the checkpoint of the one before. */
static void a_checkpoint_has_what_all_have_learned(void **state)
{
    static const struct {
        int ranks;
        uint32_t spp;
    } runs[] = {{3, 8}, {1, 12}, {5, SPP}};
    world w;
    picture one, f;

    make_learning_world(&w);
    unlink(STATE);
    make_alone(&one, &w, narrow);
    for (size_t i = 0; i < sizeof runs / sizeof *runs; i++) {
        bis_checkpoint c = {.path = STATE, .every = i == 0 ? 0 : 1e9}; /* after each pass, or at the end */
        if (i > 0) assert_int_equal(bis_checkpoint_read(&c, STATE, NULL), BIS_OK);
        const bis_render_options options = {.budget = {.spp = runs[i].spp}, .n_threads = 1, .checkpoint = &c};
        if (runs[i].ranks > 1) make_by_ranks(&f, &w, options, runs[i].ranks);
        else make_alone(&f, &w, options);
        assert_false(c.failed);
        if (runs[i].spp == SPP) assert_same(&one, &f);
        bis_film_clear(&f.film);
    }
    bis_film_clear(&one.film);
    clear_world(&w);
}

/* A pass that is given up leaves no trace, also not in what was learned: the next run goes on to the bits of one. */
static void a_pass_that_is_given_up_is_not_learned_from(void **state)
{
    world w;
    picture one, f;

    make_learning_world(&w);
    unlink(STATE);
    make_alone(&one, &w, narrow);
    for (uint32_t done = 3; done < 7; done += 3) {
        bis_checkpoint c = {.path = STATE, .every = 1e9};
        if (done > 3) assert_int_equal(bis_checkpoint_read(&c, STATE, NULL), BIS_OK);
        interrupted = 0;
        sums_left = 3; /* the flag is set at the end of the third pass, which all have seen complete */
        const bis_render_options options = {.budget = {.spp = SPP}, .n_threads = 1, .checkpoint = &c,
                                            .interrupted = &interrupted};
        make_by_ranks(&f, &w, options, 3);
        assert_true(f.result.interrupted);
        assert_int_equal(f.result.passes, done);
        bis_film_clear(&f.film);
    }
    bis_checkpoint c = {.path = STATE, .every = 1e9};
    assert_int_equal(bis_checkpoint_read(&c, STATE, NULL), BIS_OK);
    make_by_ranks(&f, &w, (bis_render_options){.budget = {.spp = SPP}, .n_threads = 1, .checkpoint = &c}, 4);
    assert_same(&one, &f);
    bis_film_clear(&f.film);
    bis_film_clear(&one.film);
    clear_world(&w);
}

/* Any rank's flag ends the render of all, without a picture of that pass. */
static void *end_by_a_rank(void *argument)
{
    static volatile sig_atomic_t set = 1, unset;
    member *me = argument;
    const world *w = me->job;
    bis_film film;
    bis_render_result result;
    const bis_render_options options = {.budget = {.spp = SPP}, .n_threads = 1, .ranks = &me->ranks,
                                        .interrupted = me->ranks.rank == 1 ? &set : &unset};

    me->status = bis_film_init(&film, SIDE, SIDE, all, (bis_loc){0}, NULL);
    if (!me->status) me->status = bis_render(&result, &film, &w->scene, &w->desc.view, &options, NULL);
    if (me->ranks.rank == 0 && (!result.interrupted || result.passes)) me->status = BIS_INPUT;
    bis_film_clear(&film);
    return NULL;
}

static void a_rank_that_is_interrupted_ends_all(void **state)
{
    world w;

    make_learning_world(&w);
    const meeting *p = let_work(3, end_by_a_rank, &w);
    for (int i = 0; i < 3; i++) assert_int_equal(p->members[i].status, BIS_OK);
    clear_world(&w);
}

/* ---- before they begin ---- */

typedef struct agreement {
    const char *file; /* of the first error of rank 1 */
    int line;
    bool says, fails;
    bis_diag own; /* of rank 0 */
} agreement;

static void *agree(void *argument)
{
    member *me = argument;
    agreement *a = (agreement *)(uintptr_t)me->job;
    bis_diag theirs = {0};
    bis_status status = BIS_OK;

    if (a->fails && me->ranks.rank > 0) status = me->ranks.rank == 2 ? BIS_NOMEM : BIS_INPUT;
    bis_warn(&theirs, (bis_loc){0}, "no error");
    if (a->says && me->ranks.rank == 1) bis_error(&theirs, BIS_INPUT, (bis_loc){a->file, a->line, 0}, "gone");
    me->status = bis_ranks_agree(&me->ranks, status, me->ranks.rank ? &theirs : &a->own);
    bis_diag_clear(&theirs);
    return NULL;
}

/* Of two that fail the lower one is named, by its first error, whose head is said once. */
static void ranks_end_together_where_one_cannot_go_on(void **state)
{
    static const struct {
        const char *file;
        int line;
        bool says;
        const char *message;
    } cases[] = {
        {"a.txt", 3, true, "error: rank 1 on \"here\" cannot go on: a.txt:3: error: gone"},
        {NULL, 0, true, "error: rank 1 on \"here\" cannot go on: gone"},
        {"bis", 0, true, "error: rank 1 on \"here\" cannot go on: gone"},
        {NULL, 0, false, "error: rank 1 on \"here\" cannot go on: no memory for a message"},
        {NULL, 0, false, NULL}, /* the twin: nobody fails */
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        agreement a = {.file = cases[i].file, .line = cases[i].line, .says = cases[i].says,
                       .fails = cases[i].message != NULL};
        const meeting *p = let_work(3, agree, &a);
        for (int k = 0; k < 3; k++) assert_int_equal(p->members[k].status, a.fails ? BIS_INPUT : BIS_OK);
        assert_int_equal(a.own.n, a.fails);
        if (a.fails) assert_string_equal(a.own.messages[0].text, cases[i].message);
        bis_diag_clear(&a.own);
    }
}

static void *compare(void *argument)
{
    static const uint64_t same[BIS_IDENTITY_PARTS] = {1, 2, 3}, other[BIS_IDENTITY_PARTS] = {1, 0, 4};
    member *me = argument;
    int n_threads = 4 + me->ranks.rank;

    me->status = bis_ranks_compare(&me->ranks, me->ranks.rank == 2 ? other : same, &n_threads,
                                   me->ranks.rank ? NULL : (bis_diag *)(uintptr_t)me->job);
    if (n_threads != 15) me->status = BIS_IO;
    return NULL;
}

static void ranks_with_another_scene_are_named(void **state)
{
    bis_diag diag = {0};
    const meeting *p = let_work(3, compare, &diag);

    for (int i = 0; i < 3; i++) assert_int_equal(p->members[i].status, BIS_INPUT);
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
        cmocka_unit_test(any_number_of_ranks_makes_the_bits_of_one),
        cmocka_unit_test(a_checkpoint_has_what_all_have_learned),
        cmocka_unit_test(a_pass_that_is_given_up_is_not_learned_from),
        cmocka_unit_test(a_rank_that_is_interrupted_ends_all),
        cmocka_unit_test(ranks_end_together_where_one_cannot_go_on),
        cmocka_unit_test(ranks_with_another_scene_are_named),
    };
    return cmocka_run_group_tests(tests, setup, NULL);
}
