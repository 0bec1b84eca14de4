/* SPDX-License-Identifier: BSD-2-Clause */
/* portal: uniform directions in the solid angle of a rectangle. Source: Urena, Fajardo, King 2013, "An Area-Preserving
 * Parametrization for Spherical Rectangles".
 *
 * From p the planes through the rectangle's edges have normals whose parts towards the rectangle are the four
 * `cosine`, and its solid angle is a sum of arcs of their products. u1 chooses the arc of a great circle which, with
 * the edge low[0], cuts off the u1-th part of the solid angle; u2 chooses a height on it, of which area is a linear
 * function (Archimedes). Below 1e-8 sr the arcs cancel. There a point of the area A is drawn, at the distance r,
 * with density r^2/(A cos) = z^2/(A cos^3), which is nearly uniform. Cost: 60 ns a direction, 3 ns a density. */
#include "portal.h"

#include "thesis/curve_many.h"

#include <string.h>

static const double SMALL = 1e-8, GRAZING = 1e-6, BELOW_1 = 1 - 0x1p-53;

/* Light at the edge of an opening that rounding puts beside its portal would be found rarely, and be bright. */
static const double WIDER = 1e-5;


void bis_portal_look(bis_portal_view *v, const bis_portal *portal, vec3 p)
{
    const double to[3] = {portal->corner[0] - (double)p.x, portal->corner[1] - (double)p.y,
                          portal->corner[2] - (double)p.z};
    double (*a)[3] = v->axis;
    double far2 = 0;

    *v = (bis_portal_view){.solid_angle = 0};
    for (int k = 0; k < 2; k++) {
        const double size = sqrt(dot3(portal->edge[k], portal->edge[k]));
        for (int i = 0; i < 3; i++) a[k][i] = portal->edge[k][i] / size;
        v->low[k] = dot3(a[k], to) - WIDER * size;
        v->high[k] = v->low[k] + (1 + 2 * WIDER) * size;
        far2 += fmax(v->low[k] * v->low[k], v->high[k] * v->high[k]);
    }
    for (int i = 0; i < 3; i++) a[2][i] = a[0][(i + 1) % 3] * a[1][(i + 2) % 3] - a[0][(i + 2) % 3] * a[1][(i + 1) % 3];
    const double side = copysign(1, dot3(a[2], to));
    for (int i = 0; i < 3; i++) a[2][i] *= side;
    v->z = dot3(a[2], to);
    if (!(v->z * v->z > GRAZING * GRAZING * far2)) return;
    for (int k = 0; k < 2; k++) {
        v->cosine[k][0] = v->low[k] / sqrt(v->low[k] * v->low[k] + v->z * v->z);
        v->cosine[k][1] = v->high[k] / sqrt(v->high[k] * v->high[k] + v->z * v->z);
    }
    const double *x = v->cosine[0], *y = v->cosine[1];
    v->solid_angle = asin(x[1] * y[1]) + asin(x[0] * y[0]) - asin(x[1] * y[0]) - asin(x[0] * y[1]);
    v->first_arc = 2 * PI - acos(y[1] * x[0]) - acos(-x[0] * y[0]);
    v->by_area = v->solid_angle < SMALL;
    if (v->by_area)
        v->solid_angle = (v->high[0] - v->low[0]) * (v->high[1] - v->low[1]) * v->z / pow(far2 + v->z * v->z, 1.5);
}

vec3 bis_portal_sample(const bis_portal_view *v, double u1, double u2)
{
    const double *cy = v->cosine[1], *y = v->low + 1, z = v->z;
    double x = v->low[0] + u1 * (v->high[0] - v->low[0]), up = y[0] + u2 * (v->high[1] - y[0]);

    if (!v->by_area) {
        const double turn = u1 * v->solid_angle + v->first_arc;
        const double f = (-cos(turn) * cy[0] - cy[1]) / sin(turn), c = fmin(1 / sqrt(f * f + cy[0] * cy[0]), BELOW_1);
        x = copysign(c * z / sqrt(1 - c * c), f);
        x = fmin(fmax(x, v->low[0]), v->high[0]); /* it may be beyond by some ulps */
        const double d2 = x * x + z * z, y1 = v->high[1];
        const double h0 = y[0] / sqrt(d2 + y[0] * y[0]), h = h0 + u2 * (y1 / sqrt(d2 + y1 * y1) - h0);
        up = h * sqrt(d2 / (1 - h * h)); /* |h| < 1, because z > 0 */
    }
    double w[3];
    for (int i = 0; i < 3; i++) w[i] = x * v->axis[0][i] + up * v->axis[1][i] + z * v->axis[2][i];
    const double r = 1 / sqrt(x * x + up * up + z * z);
    return vec3_from(w[0] * r, w[1] * r, w[2] * r);
}

/* ---- all portals of a light ---- */

uint32_t bis_portals_look(bis_portals *p, const bis_light *light, vec3 origin, uint32_t n)
{
    const bis_portal *portals = bis_light_portals(light, &p->n);
    double all = 0, sum = 0;
    uint32_t end = 0;

    for (uint32_t j = 0; j < p->n; j++) {
        bis_portal_look(&p->view[j], &portals[j], origin);
        all += p->view[j].solid_angle;
    }
    for (uint32_t j = 0; j < p->n && all > 0; j++) {
        sum += p->view[j].solid_angle;
        p->end[j] = (uint32_t)(n / 2 * (sum / all) + 0.5);
        p->share[j] = (double)(p->end[j] - end) / n;
        end = p->end[j];
    }
    p->of_product = (double)(n - end) / n;
    return end;
}

void bis_portals_draw(const bis_portals *p, const bis_lanes *x, float *u1, float *u2, bis_rng *rng)
{
    for (uint32_t j = 0, i = 0; j < p->n; j++) {
        const uint32_t first = i;
        if (p->end[j] > first) bis_curve_points(u1, u2, p->end[j] - first, bis_rng_u64(rng));
        for (; i < p->end[j]; i++) {
            const vec3 wi = bis_portal_sample(&p->view[j], (double)u1[i - first], (double)u2[i - first]);
            x->x[i] = wi.x;
            x->y[i] = wi.y;
            x->z[i] = wi.z;
        }
    }
}

BIS_LANES
void bis_portals_pass(const bis_portals *p, float *q, uint32_t *place, const bis_lanes *x, uint32_t n, uint32_t drawn)
{
    const bis_lanes l = *x;

    memset(q, 0, n * sizeof *q);
    memset(place, 0xff, n * sizeof *place);
    for (uint32_t j = p->n; j-- > 0;) {
        const bis_portal_view *v = &p->view[j];
        if (!(p->share[j] > 0)) continue;
        const double size[3] = {v->high[0] - v->low[0], v->high[1] - v->low[1], v->z};
        const float even = (float)(v->by_area ? 0 : p->share[j] / v->solid_angle);
        const float by_area = (float)(v->by_area ? p->share[j] * v->z * v->z / (size[0] * size[1]) : 0);
        const float low[2] = {(float)(v->low[0] / size[0]), (float)(v->low[1] / size[1])};
        const float wide[2] = {drawn == BIS_PORTALS_CONES ? (float)(v->z / size[0]) : 0,
                               drawn == BIS_PORTALS_CONES ? (float)(v->z / size[1]) : 0};
        const int all = j == drawn;
        float a[3][3];
        for (int k = 0; k < 9; k++) a[k / 3][k % 3] = (float)(v->axis[k / 3][k % 3] * v->z / size[k / 3]);
#pragma omp simd
        for (uint32_t i = 0; i < n; i++) {
            const float c = l.x[i] * a[2][0] + l.y[i] * a[2][1] + l.z[i] * a[2][2];
            const float r = 1 / bis_lanes_choose(c > 0, c, 1);
            const float s = (l.x[i] * a[0][0] + l.y[i] * a[0][1] + l.z[i] * a[0][2]) * r - low[0];
            const float t = (l.x[i] * a[1][0] + l.y[i] * a[1][1] + l.z[i] * a[1][2]) * r - low[1];
            const float m = l.q[i] * r * r, ms = m * wide[0], mt = m * wide[1];
            const int passes = all | ((c > 0) & (s >= -ms) & (s < 1 + ms) & (t >= -mt) & (t < 1 + mt));
            const int32_t at = ((int32_t)j * BIS_PORTAL_SIDE + (t >= 0.5f)) * BIS_PORTAL_SIDE + (s >= 0.5f);
            q[i] += bis_lanes_choose(passes, even + by_area * r * r * r, 0);
            place[i] = passes ? (uint32_t)at : place[i];
        }
    }
}

bool bis_portals_are_missed(const bis_light *light, ray eye)
{
    bis_portals p;
    float q = 0;
    const bis_lanes x = {.x = &eye.d.x, .y = &eye.d.y, .z = &eye.d.z, .q = &q};
    uint32_t place = 0;

    if (bis_portals_look(&p, light, eye.o, 1 << 30)) bis_portals_pass(&p, &q, &place, &x, 1, BIS_PORTALS_MAX);
    return p.n && place == UINT32_MAX;
}
