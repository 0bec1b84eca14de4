/* SPDX-License-Identifier: BSD-2-Clause */
/* bsdf: the material at one point, seen from one direction. It answers three questions: f, a sample, the density of
 * that sample. Integrators know only this interface. The models (phong.h, microfacet.h) stand behind it, each as a
 * const struct of functions. */
#pragma once

#include "bis/base/vec.h"
#include "bis/thesis/cone.h"

#include <stdbool.h>

typedef struct bis_bsdf_model bis_bsdf_model;

/* A material, constant over a surface. Ks and Kd are in [0,1] per channel. A field that the model does not use is 0. A
 * model that needs another number adds a field here and a line in bis_material_numbers. */
typedef struct bis_material {
    const bis_bsdf_model *model;
    rgb Kd, Ks;
    double exponent; /* phong: the exponent n, finite, >= 0 */
    double alpha;    /* microfacet: in [1e-4, 1], */
    rgb eta;         /* and the refractive index of a metal; 0: Schlick's curve */
} bis_material;

enum { BIS_MATERIAL_NUMBERS = 11 };

/* bis_material_numbers stores all numbers of a material, its fields but the model, in v. Whoever compares materials or
 * makes a hash of one asks here, so that no field is forgotten in one of these places. */
void bis_material_numbers(double v[BIS_MATERIAL_NUMBERS], const bis_material *m);

/* The material at a point for one direction wo. What is the same for all wi is computed once and stored here. */
typedef struct bis_bsdf {
    const bis_material *material;
    frame local;       /* z is the shading normal. It is on wo's side, unless smooth normals turn it away */
    vec3 wo;
    vec3 r;            /* wo mirrored about the normal: the axis of phong's specular lobe */
    frame lobe;        /* z = r */
    /* the probability of drawing from the specular lobe, which `sample` does if u0 < p_specular (docs/errata.md E35) */
    double p_specular;
} bis_bsdf;

/* What the width of a material's lobe depends on: the name and value in formulas; those in scenes, where a texture may
 * take the value's place, and the range of the latter. scene_name is NULL where there is no lobe: scenes then give Kd
 * alone. By the value `bis verify` places its cells: it is n where the lobe is nearly cos^n over wi, and alpha where it
 * is nearly GGX's over the half vector. */
typedef struct bis_bsdf_width {
    const char *name, *scene_name;
    double value, scene_value, least, most; /* the last three are in the scene's unit */
} bis_bsdf_width;

/* What a material says of n directions: f over a unit in r, g, b; the cosine between wi and the normal; the density
 * q_f of bis_bsdf_sample. Arrays hold whole blocks of lanes. */
typedef struct bis_reflected {
    float *r, *g, *b, *cos, *q;
} bis_reflected;

/* The functions of a model for many directions at once, for sets of candidates (src/thesis/set.h): bis_bsdf_f_many,
 * bis_bsdf_sample_many and bis_bsdf_reach say what they do. They are computed in float, in a file of their own. reach
 * may be NULL: cones are then all alike. */
typedef struct bis_bsdf_many {
    double (*f)(const bis_reflected *f, const bis_bsdf *b, const bis_lanes *y, uint32_t n);
    void (*sample)(const bis_lanes *y, const bis_bsdf *b, const float *u1, const float *u2, uint32_t n);
    void (*reach)(float *w, const bis_bsdf *b, const bis_cones *cones, uint32_t n);
} bis_bsdf_many;

/* The functions of a model. wi and wo are unit vectors in world space that point away from the surface. One function
 * computes f and the density of `sample`, because both need the power of the lobe, which is the most expensive part
 * of each. */
struct bis_bsdf_model {
    const char *name;
    void (*init)(bis_bsdf *b);
    bool (*sample)(const bis_bsdf *b, double u0, double u1, double u2, vec3 *wi);
    rgb (*f_pdf)(const bis_bsdf *b, vec3 wi, double *pdf);
    double (*max_f_cos)(const bis_bsdf *b);
    double (*max_ratio)(const bis_bsdf *b);
    /* What Material "name" of a scene is where the scene does not say it; the width in the scene's unit. */
    struct {
        rgb Kd, Ks;
        double width;
    } usual;
    /* Returns material *m with other values, those that the scene gives, or textures at a point: Kd, Ks, and the width
     * in the scene's unit and range. width = NULL keeps that of *m, to the bit. May be NULL: a texture is then an
     * error, and the model is no Material of scenes. */
    bis_material (*remake)(const bis_material *m, rgb Kd, rgb Ks, const double *width);
    /* true if the surface reflects more than it receives where Kd + Ks > 1: textures that can reach it get a warning */
    bool gains_beyond_1;
    /* true if the lobe is a bump over the half vector, about the normal; false if it is a bump over wi, about r. Only
     * quadrature asks (src/tools/verify/verify_bsdf.c) */
    bool of_half_vector;
    /* for --plan, `bis pixel` and `bis verify`, which describe materials */
    bis_bsdf_width (*width)(const bis_material *m);

    const bis_bsdf_many *many; /* or NULL: directions are asked one by one, and cones are all alike */
};

/* bis_bsdf_init prepares *b for material m and direction wo. n is the shading normal. n and wo are unit vectors in
 * world space; m is borrowed for the life of *b. */
void bis_bsdf_init(bis_bsdf *b, const bis_material *m, vec3 n, vec3 wo);

/* bis_bsdf_is_black returns whether nothing is reflected, whatever the light: Ks = Kd = 0, or wo lies below the
 * shading horizon. Such a point needs no candidates. */
bool bis_bsdf_is_black(const bis_bsdf *b);

/* bis_bsdf_cos returns the cosine between wi and the shading normal. It may be negative. */
static inline double bis_bsdf_cos(const bis_bsdf *b, vec3 wi) { return dot(b->local.z, wi); }

/* bis_bsdf_f returns f(wi, wo) in 1/sr, without the cosine. It is 0 if wi or wo lies below the shading horizon. */
static inline rgb bis_bsdf_f(const bis_bsdf *b, vec3 wi)
{
    double pdf;

    if (bis_bsdf_cos(b, wi) <= 0) return (rgb){0, 0, 0}; /* saves the power */
    return b->material->model->f_pdf(b, wi, &pdf);
}

/* bis_bsdf_sample draws a direction *wi with the density bis_bsdf_pdf(b, *wi). u0, u1 and u2 are uniform in [0,1) and
 * independent: u0 selects the lobe, u1 and u2 the place in it. Directions below the horizon are returned, too: their
 * f is 0, and an estimator must count them (docs/errata.md E1, E34). Returns false if the material is black; *wi is
 * then not set. */
static inline bool bis_bsdf_sample(const bis_bsdf *b, double u0, double u1, double u2, vec3 *wi)
{
    return b->material->model->sample(b, u0, u1, u2, wi);
}

/* bis_bsdf_pdf returns the density of bis_bsdf_sample at wi in 1/sr. It is a mixture of the densities of the lobes.
 * It integrates to 1 over the whole sphere, which includes directions below the horizon. */
static inline double bis_bsdf_pdf(const bis_bsdf *b, vec3 wi)
{
    double pdf;

    b->material->model->f_pdf(b, wi, &pdf);
    return pdf;
}

/* bis_bsdf_f_pdf returns f and stores the density in *pdf, for the price of one of them. The bits are the same as
 * from bis_bsdf_f and bis_bsdf_pdf. */
static inline rgb bis_bsdf_f_pdf(const bis_bsdf *b, vec3 wi, double *pdf)
{
    return b->material->model->f_pdf(b, wi, pdf);
}

/* bis_bsdf_max_f_cos returns an upper bound of f cos over all channels and all wi, in 1/sr. Rejection uses it
 * (docs/errata.md E27). */
static inline double bis_bsdf_max_f_cos(const bis_bsdf *b) { return b->material->model->max_f_cos(b); }

/* bis_bsdf_max_ratio returns an upper bound of f cos / pdf over all channels and all wi. */
static inline double bis_bsdf_max_ratio(const bis_bsdf *b) { return b->material->model->max_ratio(b); }

/* bis_bsdf_draw draws *wi by two numbers. u[0] selects the lobe. Rescaled to [0,1) within that lobe's interval it is
 * uniform again, so it is used once more, with u[1], to sample the lobe. A well-spread set of points then gives each
 * lobe its share almost exactly (E35: as unbiased as a coin, with less noise). Returns false if the material is black.
 * */
bool bis_bsdf_draw(const bis_bsdf *b, const double u[2], vec3 *wi);

/* bis_bsdf_f_many stores f over the result, its unit, the cosine, and the density of bis_bsdf_sample for n directions
 * in *f, to the end of the last block. Of y only x, y, z are read. With the unit, which is > 0, a material of any
 * reflectance fits into floats. Below the horizon of wi f is not set to 0: the caller looks at the cosine. The material
 * is not black. */
double bis_bsdf_f_many(const bis_reflected *f, const bis_bsdf *b, const bis_lanes *y, uint32_t n);

/* bis_bsdf_sample_many stores in x, y, z of y the directions that bis_bsdf_draw draws at the points (u1, u2) in
 * [0,1)^2, to the end of the last block. The material is not black. */
void bis_bsdf_sample_many(const bis_lanes *y, const bis_bsdf *b, const float *u1, const float *u2, uint32_t n);

/* bis_bsdf_reach stores in w a bound of f cos (energy.r + energy.g + energy.b) over each of n cones, in some unit. The
 * bound is positive wherever f cos is. The material is not black. */
void bis_bsdf_reach(float *w, const bis_bsdf *b, const bis_cones *cones, uint32_t n);
