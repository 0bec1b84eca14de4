/* auto_pilot: every k-th pixel rendered with several settings, for cost and variance of each. For src/tools/auto/auto.c. */
#ifndef BIS_AUTO_PILOT_H
#define BIS_AUTO_PILOT_H

#include "auto.h"

/* Replicates in all, half of them in each of the first two rounds; cells of pixels. */
enum { BIS_AUTO_REPLICATES = 4, BIS_AUTO_CELLS = 9 };

/* What the report does not tell of a setting. */
typedef struct bis_auto_trial {
    int family, wanted;    /* wanted: replicates in this round */
    bis_status status;
    double *sum, *squares; /* [pixels][3] over replicates */
    double seconds, fill;  /* of a replicate, the least so far: the pilot's film, and a film of one pixel */
    double shading[BIS_AUTO_MOST_GROUPS]; /* seconds, the least so far; with several groups */
    double cell[BIS_AUTO_MOST_GROUPS][BIS_AUTO_CELLS]; /* what each cell of pixels adds to the relMSE, up to a factor: nothing is forgiven here */
} bis_auto_trial;

typedef struct bis_auto_pilot {
    const bis_scene *scene;
    bis_scene_desc desc; /* a shallow copy, with the pilot's film and sampler; each replicate makes its own of it */
    bis_settings base;   /* what was asked for */
    bis_render_options options;
    int n_threads;
    bool is_quick;       /* the short list */
    uint32_t passes;     /* of a replicate */
    double scale;        /* pixels of the picture : pixels of the pilot */
    size_t n_pixels;
    double *picture;     /* [n_pixels][3] the mean of all trials */
    bool *shaded;        /* [n_pixels] has been seen to show a surface: the others are the same with any setting */
    unsigned char *shows; /* [n_pixels] the group; NULL: there is one */
    double reading;      /* seconds that reading the clock takes */
    bool diffuse[BIS_AUTO_MOST_GROUPS];
    bool is_mixed;       /* different settings look promising */
    bis_auto_trial trials[BIS_AUTO_MOST_TRIED];
    bis_auto_report *report;
} bis_auto_pilot;

bis_status bis_auto_no_memory(const bis_scene_desc *desc, bis_diag *diag);
bool bis_auto_is_interrupted(const bis_auto_pilot *p);

/* Of the pilot are known: desc, passes, scale, options, n_pixels, shows, and the report's groups. */
bis_status bis_auto_pilot_start(bis_auto_pilot *p, bis_diag *diag);
void bis_auto_pilot_clear(bis_auto_pilot *p);

/* Put a setting on the list, for a set of groups, with so many replicates wanted. The first of all is the one that tells which pixels show a
 * surface. */
bis_status bis_auto_pilot_add(bis_auto_pilot *p, int family, unsigned groups, const bis_settings *s, int wanted, bis_diag *diag);

/* All replicates that are wanted, by all threads. */
bis_status bis_auto_pilot_run(bis_auto_pilot *p, bis_diag *diag);

/* Costs and variances of the report, from all replicates so far. */
void bis_auto_pilot_measure(bis_auto_pilot *p);

#endif
