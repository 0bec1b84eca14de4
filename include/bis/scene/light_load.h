/* SPDX-License-Identifier: BSD-2-Clause */
/* light_load: makes a light from its description in a scene: it reads the file, checks it and warns. */
#pragma once

#include "bis/base/image.h"
#include "bis/beyond/mapping.h"
#include "bis/thesis/light.h"
#include "bis/thesis/sampler.h"
#include "bis/thesis/envmap.h"
#include "bis/thesis/importance.h"
#include "bis/base/xform.h"

/* pbrt's light from one direction. In a map it is a disc of half a degree, as wide as the sun. */
#define BIS_DISTANT_HALF_ANGLE (0.25 * PI / 180)
typedef struct bis_distant {
    double towards[3]; /* unit vector to the light, in the frame of the map */
    rgb irradiance;    /* of a surface that faces it */
} bis_distant;

/* A light as LightSource "infinite" describes it (docs/scene-format.md). */
typedef struct bis_light_desc {
    char *filename;      /* NULL: constant; resolved path, owned */
    const bis_image *image; /* what the file would hold, borrowed; filename then only names it. NULL: it is read */
    rgb L;               /* radiance of a constant; factor of a map */
    double scale;
    double illuminance;  /* that scales the light, as in pbrt-v4 (light_load.c); 0: it does not */
    bis_mapping mapping; /* default: latlong */
    bool has_mapping;    /* the scene gives the mapping; a square map without it is an error, but of pbrt-v4: */
    bool is_v4;          /* the map is named by "filename", as in pbrt-v4: a square without mapping is equal-area */
    int width;           /* of the lat-long map that others are resampled to; 0: bis_mapping_width */
    double area_exponent; /* b of thesis 3.4; default BIS_AREA_EXPONENT */
    int levels;          /* of thesis 3.4; default BIS_LEVELS */
    bool has_table_kind; /* the scene gives sampler "alias" or "cdf"; otherwise bis_light_table_kind decides */
    bis_table_kind table_kind;
    unsigned as_printed; /* BIS_E* of the importance; the scene copies them from its settings */
    bool visible;        /* camera rays see the light */
    bool is_smooth;      /* they see a map interpolated; what surfaces receive is made of its pixels all the same */
    bis_distant *distants; /* --approximate: discs in the map, which a constant light then becomes; owned */
    size_t n_distants, capacity_distants;
    bis_portal portals[BIS_PORTALS_MAX];
    uint32_t n_portals;
    bool windows;        /* where there are none, openings of a room are looked for (src/render/windows.h) */
    bis_xform to_world;  /* a rotation or reflection */
    bis_loc loc;         /* the place of the directive */
} bis_light_desc;

/* bis_light_desc_default returns what a LightSource without parameters describes: a constant of radiance 1. */
bis_light_desc bis_light_desc_default(void);

/* bis_light_table_kind returns the kind of table that serves an integrator with these needs: what the scene says, else
 * CDFs for evenly spread points (BIS_NEED_SPREAD and a low-discrepancy sampler), and alias tables (thesis appendix A)
 * for all others, because independent numbers lose nothing by them and take 14 to 29 % less time (docs/errata.md
 * E12). */
bis_table_kind bis_light_table_kind(const bis_light_desc *desc, unsigned needs, bis_sampler_kind sampler);

/* bis_light_desc_has_map returns whether the light is more than a constant. */
static inline bool bis_light_desc_has_map(const bis_light_desc *d) { return d->filename || d->n_distants; }

/* bis_light_take_layout gives the description the mapping that a file has by itself (bis_image_read_map), unless the
 * description has one. */
void bis_light_take_layout(bis_light_desc *desc, bool is_cube_strip);

/* bis_light_mapping returns the mapping of a map of width x height pixels: pbrt-v4's square ones are equal-area. */
static inline bis_mapping bis_light_mapping(const bis_light_desc *desc, long width, long height)
{
    return width == height && desc->is_v4 && !desc->has_mapping ? BIS_MAPPING_EQUALAREA : desc->mapping;
}

/* bis_light_check_size tells whether a map of width x height pixels fits the description. It warns of a square map that
 * is taken for pbrt-v4's, and of one that is higher than wide. Errors: BIS_INPUT. */
bis_status bis_light_check_size(const bis_light_desc *desc, int width, int height, bis_diag *diag);

/* bis_light_seen returns the radiance that a camera ray of direction d sees which meets no surface: that of the pixel
 * there, or with is_smooth bilinear between the centres of pixels; black if the light is not visible. */
rgb bis_light_seen(const bis_light_desc *desc, const bis_light *light, vec3 d);

/* bis_light_load reads the map's file, if there is one, and builds what `needs` (BIS_NEED_*) asks for. seconds (may
 * be NULL) receives the time for reading in [0] and for building in [1]. Warnings: bad values with their share of
 * solid angle; no light. Errors: those of bis_image_read and bis_light_from_image. */
bis_status bis_light_load(bis_light **out, const bis_light_desc *desc, unsigned needs, double seconds[2],
                          bis_diag *diag);

/* bis_light_from_image does the same with an image that was read already. It takes over the image, which is empty
 * afterwards, on failure too. desc->filename names the image in messages. Errors: BIS_INPUT (a square map without
 * mapping, a shape that its mapping does not have, a frame that is no rotation or reflection, a scale that overflows),
 * BIS_NOMEM. */
bis_status bis_light_from_image(bis_light **out, bis_image *image, const bis_light_desc *desc, unsigned needs,
                                bis_diag *diag);

/* bis_light_from_envmap does the same with a map. It takes over em. It reads area_exponent, levels, table_kind,
 * as_printed, to_world and loc of desc. Errors: BIS_INPUT (the frame), BIS_NOMEM. */
bis_status bis_light_from_envmap(bis_light **out, bis_envmap *em, const bis_light_desc *desc, unsigned needs,
                                 bis_diag *diag);
