/* SPDX-License-Identifier: BSD-2-Clause */
/* bsdf: prepares the frame at a shading point, and answers whether anything is reflected there. All else depends on
 * the model and stands behind the model's functions. */
#include "bis/thesis/bsdf.h"

#include "thesis/real_double.h"

#include "thesis/direction_formulas.h"

void bis_material_numbers(double v[BIS_MATERIAL_NUMBERS], const bis_material *m)
{
    const rgb colours[] = {m->Kd, m->Ks, m->eta};

    for (int i = 0; i < 3; i++) {
        *v++ = (double)colours[i].r;
        *v++ = (double)colours[i].g;
        *v++ = (double)colours[i].b;
    }
    *v++ = m->exponent;
    *v++ = m->alpha;
}

void bis_bsdf_init(bis_bsdf *b, const bis_material *m, vec3 n, vec3 wo)
{
    *b = (bis_bsdf){.material = m, .local = frame_about(n), .wo = wo};
    m->model->init(b);
}

bool bis_bsdf_draw(const bis_bsdf *b, const double u[2], vec3 *wi)
{
    const parts lobes = parts_of(b->p_specular);

    return bis_bsdf_sample(b, u[0], place_in_part(&lobes, u[0]), u[1], wi);
}

bool bis_bsdf_is_black(const bis_bsdf *b)
{
    const bis_material *m = b->material;

    return (rgb_is_black(m->Kd) && rgb_is_black(m->Ks)) || bis_bsdf_cos(b, b->wo) <= 0;
}

/* ---- many directions: by the model's own loops, or one after the other ---- */

/* f over the largest f cos, so that it fits a float whatever the reflectance. */
static double one_by_one(const bis_reflected *f, const bis_bsdf *b, const bis_lanes *y, uint32_t n)
{
    const double unit = bis_bsdf_max_f_cos(b);

    for (uint32_t i = 0; i < bis_lanes_round_up(n); i++) {
        const vec3 wi = i < n ? (vec3){y->x[i], y->y[i], y->z[i]} : b->local.z;
        double q;
        const rgb v = bis_bsdf_f_pdf(b, wi, &q);
        f->r[i] = (float)((double)v.r / unit);
        f->g[i] = (float)((double)v.g / unit);
        f->b[i] = (float)((double)v.b / unit);
        f->cos[i] = (float)bis_bsdf_cos(b, wi);
        f->q[i] = (float)q;
    }
    return unit;
}

double bis_bsdf_f_many(const bis_reflected *f, const bis_bsdf *b, const bis_lanes *y, uint32_t n)
{
    const bis_bsdf_many *many = b->material->model->many;

    return (many ? many->f : one_by_one)(f, b, y, n);
}

static void draw_one_by_one(const bis_lanes *y, const bis_bsdf *b, const float *u1, const float *u2, uint32_t n)
{
    for (uint32_t i = 0; i < bis_lanes_round_up(n); i++) {
        vec3 wi = b->local.z;
        if (i < n) bis_bsdf_draw(b, (double[2]){(double)u1[i], (double)u2[i]}, &wi);
        y->x[i] = wi.x;
        y->y[i] = wi.y;
        y->z[i] = wi.z;
    }
}

void bis_bsdf_sample_many(const bis_lanes *y, const bis_bsdf *b, const float *u1, const float *u2, uint32_t n)
{
    const bis_bsdf_many *many = b->material->model->many;

    (many ? many->sample : draw_one_by_one)(y, b, u1, u2, n);
}

/* All cones alike: where the light is alone decides. */
static void reach_of_light(float *w, const bis_bsdf *b, const bis_cones *cones, uint32_t n)
{
    (void)b;
    for (uint32_t i = 0; i < bis_lanes_round_up(n); i++) w[i] = i < n ? cones->r[i] + cones->g[i] + cones->b[i] : 0;
}

void bis_bsdf_reach(float *w, const bis_bsdf *b, const bis_cones *cones, uint32_t n)
{
    const bis_bsdf_many *many = b->material->model->many;

    (many && many->reach ? many->reach : reach_of_light)(w, b, cones, n);
}
