/* SPDX-License-Identifier: BSD-2-Clause */
/* survey: looks around before the first samples of a picture. Nothing is kept of them but what is learned of V: where
 * little light arrives, a pixel that knows nothing is a hundred times as noisy as one that knows the window.
 *
 * A look at a place, a tile or a square of tiles, goes round by round. A round is a camera sample in each quarter of
 * the place. It is guided by the rounds before, and by the squares around the place. The rounds end when a quarter of
 * the rays of one comes through, or after 16: in the open a look costs 4 camera samples, in a room 64.
 *
 * Squares are 2 x 2 tiles, then 2 x 2 of these, up to the whole picture. They are counted from the picture's corner,
 * and all that a look does depends on the picture, the seed and the squares around it. So a crop, a part and each rank
 * find the same as the whole picture does, and a resumed render finds it again. The squares of a picture are looked at
 * before its first pass, and a tile before its own first samples. All squares together cost a third of what the tiles
 * cost; a part or a rank looks at all squares of its picture. Those of 128 pixels and more cost a 16th of all squares,
 * a third of a glimpse (first_light.h), so they come before it and the others after it: the first light does not wait,
 * and knows a window.
 *
 * The random numbers of a look are not those of a pass, nor those of a look of another size, so no estimate depends on
 * the rays that it weighs. */
#include "survey.h"

#include "ranks.h"

#include "bis/base/clock.h"

#include <math.h>
#include <string.h>

enum { TILE = BIS_RENDER_TILE, PIXELS = TILE * TILE, WIDER = 2, MOST_LEVELS = 28, COARSE = 128 };

/* Of the random number that is the seed of all looks around of a size: beyond all purposes of sampler.c. */
static const uint64_t LOOK = UINT64_MAX, PURPOSE_SEED = (uint64_t)4 << 32;

/* ---- where squares are ---- */

/* The squares of one size: across x down of them, of `side` x `side` pixels, from number `first` on. */
typedef struct squares {
    size_t first;
    int side, across, down;
} squares;

/* The squares of all sizes, from the smallest on, whose number is returned. */
static int find_squares(squares level[MOST_LEVELS], const bis_film *f)
{
    int n = 0;
    size_t first = 0;

    for (int64_t side = WIDER * TILE; n < MOST_LEVELS; side *= WIDER) {
        const int across = (int)((f->full_width + side - 1) / side), down = (int)((f->full_height + side - 1) / side);
        level[n++] = (squares){first, (int)side, across, down};
        first += (size_t)across * (size_t)down;
        if (across == 1 && down == 1) break;
    }
    return n;
}

static uint32_t square_at(const squares *s, int x, int y)
{
    return (uint32_t)(s->first + (size_t)(y / s->side) * (size_t)s->across + (size_t)(x / s->side));
}

size_t bis_survey_squares(const bis_film *f)
{
    squares level[MOST_LEVELS];
    const squares *last = &level[find_squares(level, f) - 1];

    return last->first + (size_t)last->across * (size_t)last->down;
}

void bis_survey_place(bis_visibility *v, const bis_film *f)
{
    squares level[MOST_LEVELS];
    const int n = find_squares(level, f);

    for (size_t t = 0; t < v->n_tiles; t++) {
        const bis_rect r = bis_film_tile(f, TILE, (int)t);
        v->above[t] = square_at(&level[0], r.x0, r.y0);
    }
    for (int i = 0; i + 1 < n; i++) {
        for (int y = 0; y < level[i].down; y++) {
            for (int x = 0; x < level[i].across; x++)
                v->above[v->n_tiles + level[i].first + (size_t)y * (size_t)level[i].across + (size_t)x] =
                    square_at(&level[i + 1], x * level[i].side, y * level[i].side);
        }
    }
}

/* ---- looks ---- */

void bis_survey_pixel(int i, int *x, int *y)
{
    *x = *y = 0;
    for (int bit = 0; 1 << 2 * bit < PIXELS; bit++) {
        *x |= (i >> 2 * bit & 1) << bit;
        *y |= (i >> (2 * bit + 1) & 1) << bit;
    }
}

/* The sampler of the looks at places of a size: one camera sample with a seed of its own. */
static bis_sampler sampler_of_look(const bis_workspace *w, int side)
{
    bis_sampler s = w->view->sampler;
    bis_rng rng;

    bis_rng_init(&rng, s.seed, LOOK, (uint64_t)(side / TILE - 1), PURPOSE_SEED);
    s.seed = bis_rng_u64(&rng);
    bis_sampler_set_spp(&s, 1);
    return s;
}

/* A look at a place of the picture, whose corner is (x0, y0). Of a square, a pixel is any of those in the place of a
 * pixel of a tile. */
static void look(const bis_workspace *w, bis_worker *me, int place, int x0, int y0, int side)
{
    enum { ROUNDS = 16, QUARTER = PIXELS / 4 };
    const bis_visibility *v = &w->visibility;
    const size_t first = bis_visibility_first_cell(v, (size_t)place),
                 cells = bis_visibility_first_cell(v, (size_t)place + 1) - first;
    const bis_rect picture = {0, 0, w->film->full_width, w->film->full_height};
    const bis_sampler sampler = sampler_of_look(w, side);
    const int step = side / TILE;
    bis_pixel_sum dropped = {.settings = &w->view->settings};

    for (int round = 0; round < ROUNDS; round++) {
        const int at = round % 4 * (QUARTER / 4) + (7 * round + 5) % (QUARTER / 4);
        for (int i = at; i < PIXELS; i += QUARTER) {
            int x, y;
            bis_survey_pixel(i, &x, &y);
            x = x0 + x * step, y = y0 + y * step;
            const uint64_t any = bis_hash(sampler.seed + ((uint64_t)x << 32 | (uint64_t)y));
            x += (int)(any % (uint64_t)step);
            y += (int)((any >> 32) % (uint64_t)step);
            if (!bis_is_in(picture, x, y)) continue;
            dropped.cell = first + (size_t)i * cells / PIXELS;
            bis_wave_add(me->wave, &sampler, x, y, 0, &dropped);
        }
        bis_wave_end(me->wave);
        if (bis_workspace_interrupted(w)) return;
        uint32_t rays, seen;
        bis_visibility_counted(&rays, &seen, v, place);
        bis_visibility_learn(v, &place, 1, 1);
        if (rays > 0 && 4 * seen >= rays) return;
    }
}

void bis_survey_tile(const bis_workspace *w, bis_worker *me, int t)
{
    const bis_rect r = bis_film_tile(w->film, TILE, t);

    look(w, me, t, r.x0, r.y0, TILE);
}

static void look_at_squares(bis_workspace *w, const squares *s, double late, bis_pass_progress *progress, void *user)
{
    bis_visibility *v = &w->visibility;
    const bis_rect a = w->area;

#pragma omp parallel for schedule(dynamic) num_threads(w->n_threads)
    for (int i = 0; i < s->across * s->down; i++) {
        const int x0 = i % s->across * s->side, y0 = i / s->across * s->side;
        const size_t k = s->first + (size_t)i;
        if (x0 >= a.x1 || y0 >= a.y1 || x0 + s->side <= a.x0 || y0 + s->side <= a.y0) continue;
        if (bis_workspace_interrupted(w) || bis_clock_now() >= late) continue;
        look(w, &w->workers[bis_workspace_thread()], (int)(v->n_tiles + k), x0, y0, s->side);
        bis_visibility_close(v, k, w->clusters.n_parts);
        if (bis_workspace_thread() == 0) progress(0, user);
    }
}

static void forget(bis_visibility *v)
{
    const size_t first = bis_visibility_first_cell(v, v->n_tiles);

    memset(v->known + first, 0, v->n_squares * sizeof *v->known);
    memset(v->counted + first, 0, v->n_squares * sizeof *v->counted);
    memset(v->squares, 0, v->n_squares * sizeof *v->squares);
}

void bis_survey(bis_workspace *w, bool is_fine, bool counts, bis_pass_progress *progress, void *user)
{
    squares level[MOST_LEVELS];
    const int n = find_squares(level, w->film);
    const bool is_first = w->options->part.k <= 1 && (!w->options->ranks || w->options->ranks->rank == 0);
    const double late = w->fine && is_fine ? w->late : HUGE_VAL;

    if (!is_fine) forget(&w->visibility);
    for (int i = 0; i < w->n_threads; i++) w->workers[i].scratch.guide->learns = true;
    for (int i = n - 1; i >= 0; i--) {
        const bool is_coarse = level[i].side >= COARSE || i == n - 1;
        if (is_coarse != is_fine) look_at_squares(w, &level[i], late, progress, user);
    }
    w->surveyed = is_fine && !bis_workspace_interrupted(w) && bis_clock_now() < late;
    for (int i = 0; i < w->n_threads && !(counts && is_first); i++) w->workers[i].counters = (bis_counters){0};
}
