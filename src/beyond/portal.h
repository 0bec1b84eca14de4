/* SPDX-License-Identifier: BSD-2-Clause */
/* portal: a rectangle through which light is expected, such as a window, as one point sees it. Directions through it
 * are drawn evenly over its solid angle. */
#pragma once

#include "bis/thesis/lanes.h"
#include "bis/thesis/light.h"
#include "bis/thesis/point.h"
#include "bis/thesis/rng.h"

typedef struct bis_portal_view {
    double axis[3][3];         /* unit vectors: along the edges, and towards the portal's plane */
    double low[2], high[2], z; /* the portal's extent along the edges, and the distance of its plane */
    double cosine[2][2];       /* low/hypot(low, z), high/hypot(high, z) */
    double arc[2];             /* where u1 = 0: cosine and sine of 2 pi less two angles between its edges' planes */
    double solid_angle;        /* 0: nothing is drawn */
    bool by_area;              /* it is so small that points of its area are drawn */
} bis_portal_view;

/* bis_portal_look stores how p sees the portal: with the solid angle 0 if p is on the portal's plane or near it (1e-6
 * of the distance of a corner), where floats cannot tell what passes. */
void bis_portal_look(bis_portal_view *v, const bis_portal *portal, vec3 p);

/* bis_portal_sample stores n unit directions through the portal, uniform over its solid angle, or over its area if
 * by_area. u1[n], u2[n] are uniform in [0,1). The solid angle must be > 0. */
void bis_portal_sample(const bis_lanes *x, const bis_portal_view *v, const float *u1, const float *u2, uint32_t n);

/* Each portal is divided into 2 x 2 squares. (4 x 4 have the same error within 5 %.) */
enum { BIS_PORTAL_SIDE = 2, BIS_PORTAL_SQUARES = 4, BIS_PORTALS_CONES = BIS_PORTALS_MAX + 1 };

/* The portals of a light as a point sees them, and what they get of its candidates. */
typedef struct bis_portals {
    uint32_t n, end[BIS_PORTALS_MAX]; /* portal j draws candidates end[j-1] to end[j] - 1 */
    double share[BIS_PORTALS_MAX], of_product; /* of all candidates that come from the light */
    bis_portal_view view[BIS_PORTALS_MAX];
} bis_portals;

/* bis_portals_look stores how a point sees portals, and returns how many of n candidates are drawn through them:
 * half, fewer for a lobe that is narrower than they are, or none if no portal is seen. Each portal gets as many as its
 * solid angle is worth. */
uint32_t bis_portals_look(bis_portals *p, const bis_portal *portals, uint32_t n_portals, const bis_point *pt,
                          uint32_t n);

/* bis_portals_draw stores as many directions in x: each portal's evenly spread, in the order of a curve. u1, u2: room
 * for as many numbers, in whole blocks. */
void bis_portals_draw(const bis_portals *p, const bis_lanes *x, float *u1, float *u2, bis_rng *rng);

/* bis_portals_pass stores in q[n] the sum of share times density over the portals that directions x pass, and in
 * place[n] the number of a square of the first of these portals; UINT32_MAX: none. Of portal `drawn` it is known that
 * all pass it; BIS_PORTALS_MAX: of none; BIS_PORTALS_CONES: x are axes of cones, x.q the sines of their angles, and a
 * cone passes if a part of it does. */
void bis_portals_pass(const bis_portals *p, float *q, uint32_t *place, const bis_lanes *x, uint32_t n, uint32_t drawn);

/* bis_portals_are_missed returns whether the light has portals and a ray that escapes passes none of them. */
bool bis_portals_are_missed(const bis_light *light, ray eye);

