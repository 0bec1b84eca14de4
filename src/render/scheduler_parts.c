/* SPDX-License-Identifier: BSD-2-Clause */
/* scheduler_parts: what rank 0 and the other ranks share: the pieces of a message, and the queue of tiles. */
#include "scheduler_parts.h"

#include <string.h>
#include <time.h>

unsigned char *bis_sched_put(unsigned char *m, const void *data, size_t n)
{
    memcpy(m, data, n);
    return m + n;
}

unsigned char *bis_sched_get(unsigned char *m, void *data, size_t n)
{
    memcpy(data, m, n);
    return m + n;
}

unsigned char *bis_sched_message(const bis_sched *sched, bis_sched_head h)
{
    return bis_sched_put(sched->message, &h, sizeof h);
}

void bis_sched_send(bis_sched *sched, int to, const unsigned char *end)
{
    sched->ranks->send(sched->ranks, to, sched->message, (size_t)(end - sched->message));
}

/* bis_sched_put or bis_sched_get. */
typedef unsigned char *copier(unsigned char *m, void *data, size_t n);

static unsigned char *put(unsigned char *m, void *data, size_t n) { return bis_sched_put(m, data, n); }

static unsigned char *copy_pixels(unsigned char *m, bis_workspace *w, int t, copier *copy)
{
    const bis_film *f = w->film;
    const bis_rect r = bis_film_tile_of_crop(f, BIS_RENDER_TILE, t);
    const size_t n = (size_t)(r.x1 - r.x0), n_values = (size_t)f->layers.n_values;

    for (int y = r.y0; y < r.y1; y++) {
        const size_t i = (size_t)(y - f->y0) * (size_t)f->width + (size_t)(r.x0 - f->x0);
        m = copy(m, &w->pass[i], n * sizeof *w->pass);
        if (w->pass_layers) m = copy(m, bis_workspace_layers(w, i), n * n_values * sizeof *w->pass_layers);
    }
    for (bis_twin twin = {0}; w->pass_twins && bis_film_next_twin(f, r, &twin);)
        m = copy(m, &w->pass_twins[twin.at], sizeof *w->pass_twins);
    return m;
}

unsigned char *bis_sched_put_pixels(unsigned char *m, bis_workspace *w, int tile)
{
    return copy_pixels(m, w, tile, put);
}

unsigned char *bis_sched_get_pixels(unsigned char *m, bis_workspace *w, int tile)
{
    return copy_pixels(m, w, tile, bis_sched_get);
}

/* What a tile has learned. */
static bis_seen *learned(const bis_workspace *w, int tile)
{
    return w->visibility.known + (size_t)tile * w->visibility.cells;
}

static size_t learned_bytes(const bis_workspace *w) { return w->visibility.cells * sizeof(bis_seen); }

unsigned char *bis_sched_put_learned(unsigned char *m, const bis_workspace *w, int tile)
{
    return bis_sched_put(m, learned(w, tile), learned_bytes(w));
}

unsigned char *bis_sched_get_learned(unsigned char *m, const bis_workspace *w, int tile)
{
    return bis_sched_get(m, learned(w, tile), learned_bytes(w));
}

size_t bis_sched_tile_bytes(const bis_workspace *w)
{
    const size_t pixel = sizeof(bis_pixel_mean) + (size_t)w->film->layers.n_values * sizeof(float);
    return sizeof(bis_sched_tile) + BIS_RENDER_TILE * BIS_RENDER_TILE * pixel +
           BIS_RENDER_TILE_TWINS * sizeof *w->pass_twins + learned_bytes(w);
}

void bis_sched_queue(bis_sched *sched, const bis_sched_head *h, unsigned char *m)
{
    bis_workspace *w = sched->w;

    for (int i = 0; i < h->n_tiles; i++) {
        bis_sched_tile t;
        m = bis_sched_get(m, &t, sizeof t);
        /* before the tile is in the queue: who takes it needs what it has learned */
        if (h->learned) m = bis_sched_get_learned(m, w, t.tile);
#pragma omp critical(bis_sched)
        sched->queue[sched->n_queued++] = t.tile;
    }
}

int bis_sched_take_queued(bis_sched *sched)
{
    int t = -1;

#pragma omp critical(bis_sched)
    if (sched->n_taken < sched->n_queued) t = sched->queue[sched->n_taken++];
    return t;
}

/* 50 us: short beside a tile, which takes milliseconds, and long enough to leave the processor to who renders. */
void bis_sched_wait(void) { nanosleep(&(struct timespec){0, 50000}, NULL); }

void bis_sched_learn(bis_sched *sched)
{
    bis_visibility_learn(&sched->w->visibility, sched->finished, (size_t)sched->n_finished, sched->w->n_threads);
    sched->n_finished = 0;
}
