/* visibility: counts, and what they say. */
#include "bis/beyond/visibility.h"

#include "bis/base/mem.h"

#include <math.h>

enum { PARTS = BIS_VISIBILITY_PARTS };

static const double floor_of_v = 0.02; /* what was never seen is still looked at with a seventh of the weight */

bis_status bis_visibility_init(bis_visibility *v, size_t n_tiles, bis_diag *diag)
{
    *v = (bis_visibility){.n_tiles = n_tiles};
    v->known = bis_alloc(n_tiles, sizeof *v->known);
    v->counted = bis_alloc(n_tiles, sizeof *v->counted);
    if (v->known && v->counted) return BIS_OK;
    bis_visibility_clear(v);
    return bis_error(diag, BIS_NOMEM, (bis_loc){0},
                     "no memory for the visibility learned in %zu tiles; \"bool learn\" false needs none", n_tiles);
}

void bis_visibility_clear(bis_visibility *v)
{
    bis_free(v->known);
    bis_free(v->counted);
    *v = (bis_visibility){0};
}

size_t bis_visibility_bytes(const bis_visibility *v) { return 2 * v->n_tiles * sizeof *v->known; }

/* v from few counts is drawn towards 1, as if two rays had come through. */
void bis_visibility_factors(float *g, uint32_t n, const bis_visibility *v, size_t tile)
{
    const bis_seen *known = v->known[tile];
    float of_part[PARTS];

    for (int i = 0; i < PARTS; i++)
        of_part[i] = (float)sqrt((known[i].seen + 2.0) / (known[i].rays + 2.0) + floor_of_v);
    for (uint32_t k = 0; k < n; k++) g[k] = of_part[bis_visibility_part(k, n)];
}

void bis_visibility_learn(bis_visibility *v, int n_threads)
{
    (void)n_threads;
#pragma omp parallel for num_threads(n_threads)
    for (size_t t = 0; t < v->n_tiles; t++) {
        for (int i = 0; i < PARTS; i++) {
            v->known[t][i].rays += v->counted[t][i].rays;
            v->known[t][i].seen += v->counted[t][i].seen;
            v->counted[t][i] = (bis_seen){0, 0};
        }
    }
}
