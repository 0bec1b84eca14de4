/* SPDX-License-Identifier: BSD-2-Clause */
/* part: a share of the tiles of a picture in a file, and the picture from its parts. For src/cli. */
#pragma once

#include "state.h"

#include <limits.h>

enum { BIS_PART_MOST = 100000, BIS_PART_COMMAND = 1 << 13, BIS_PART_APPROXIMATED = 1 << 12 };

/* What the header and the figures of the picture need, beside what a render has done. */
typedef struct bis_part_about {
    char scene[PATH_MAX];
    char command[BIS_PART_COMMAND]; /* that made the part, without --part and the names of outputs */
    char approximated[BIS_PART_APPROXIMATED]; /* what is not modelled and was replaced; "": nothing */
    uint64_t seed;
    uint32_t edge_samples, n_threads;
    double edge_light;
    uint64_t bytes; /* of bis_render_result */
    bis_scene_seconds seconds;
    bis_scene_figures figures;
} bis_part_about;

/* bis_part_write writes what bis_render has made of head->part. Of *result it takes spp, passes, counters, seconds,
 * threads and bytes. Errors: BIS_IO, BIS_NOMEM; an older file then stays. */
bis_status bis_part_write(const char *path, const bis_state_head *head, const bis_part_about *about, bis_film *film,
                          const bis_render_result *result, bis_diag *diag);

/* A picture from its parts. Seconds and counters are sums over them, threads and bytes the largest of them. */
typedef struct bis_merged {
    bis_state_head head;
    bis_part_about about;
    bis_film film;
    bis_render_result result;
} bis_merged;

/* bis_part_merge makes a picture of the n > 0 parts in any order; a part may stand there twice. Each file is read
 * twice, and no memory is taken for the picture before all parts are known to be there. bis_film_clear frees m->film.
 * Errors: BIS_IO, BIS_NOMEM, BIS_INPUT (a file is no part, is damaged, or of another render or another number of parts;
 * a part is missing: the message has the command that makes it). */
bis_status bis_part_merge(bis_merged *m, const char *const *paths, int n, bis_diag *diag);
