/* bsdf: the material at one point seen from one direction: f, sample, pdf. Integrators know this interface alone; the
 * models (phong.h, microfacet.h) plug in behind it by a const struct of functions. */
#ifndef BIS_BSDF_H
#define BIS_BSDF_H

#include "bis/base/vec.h"

#include <stdbool.h>

typedef struct bis_bsdf_model bis_bsdf_model;

/* A material, constant over a surface. Ks, Kd in [0,1] per channel; what a model has no use for is 0. */
typedef struct bis_material {
    const bis_bsdf_model *model;
    rgb Kd, Ks;
    double exponent; /* phong: finite, >= 0 */
    double alpha;    /* microfacet: in [1e-4, 1] */
} bis_material;

/* The material at a point, for one wo: what is the same for all wi is computed once. */
typedef struct bis_bsdf {
    const bis_material *material;
    frame local;       /* z = shading normal, on wo's side as far as smooth normals allow */
    vec3 wo;
    vec3 r;            /* wo mirrored about the normal: where the specular lobe is, phong's axis */
    frame lobe;        /* z = r */
    double p_specular; /* probability of drawing from the specular lobe: sample does so where u0 < p_specular (docs/errata.md E35) */
} bis_bsdf;

/* All functions of a model. wi, wo unit, world space, away from the surface. f and the density of `sample` come from one
 * function: they share the lobe's power, the dearest part of both. */
struct bis_bsdf_model {
    const char *name;
    void (*init)(bis_bsdf *b);
    bool (*sample)(const bis_bsdf *b, double u0, double u1, double u2, vec3 *wi);
    rgb (*f_pdf)(const bis_bsdf *b, vec3 wi, double *pdf);
    double (*max_f_cos)(const bis_bsdf *b);
    double (*max_ratio)(const bis_bsdf *b);
    bool of_half_vector; /* the lobe is a bump over the half vector, about the normal; else over wi, about r. For quadrature (src/tools/verify/verify_bsdf.c) */
};

/* n: unit shading normal, wo: unit. */
void bis_bsdf_init(bis_bsdf *b, const bis_material *m, vec3 n, vec3 wo);

/* Nothing is reflected, whatever the light: Ks = Kd = 0, or wo lies below the shading horizon. No candidates are
 * needed. */
bool bis_bsdf_is_black(const bis_bsdf *b);

/* Cosine of wi about the shading normal; may be negative. */
static inline double bis_bsdf_cos(const bis_bsdf *b, vec3 wi) { return dot(b->local.z, wi); }

/* f(wi, wo) in 1/sr, without the cosine; 0 where wi or wo lies below the shading horizon. */
static inline rgb bis_bsdf_f(const bis_bsdf *b, vec3 wi)
{
    double pdf;

    if (bis_bsdf_cos(b, wi) <= 0) return (rgb){0, 0, 0}; /* saves the power */
    return b->material->model->f_pdf(b, wi, &pdf);
}

/* Draw wi: u0 picks the lobe, u1, u2 the place in it. Directions below the horizon are returned, too: their f is 0 and
 * they count (docs/errata.md E1, E34).
 * False: black, nothing drawn. The density is bis_bsdf_pdf(b, *wi). */
static inline bool bis_bsdf_sample(const bis_bsdf *b, double u0, double u1, double u2, vec3 *wi)
{
    return b->material->model->sample(b, u0, u1, u2, wi);
}

/* Density of bis_bsdf_sample in 1/sr, the mixture of the lobes; it integrates to 1 over the sphere, directions below
 * the horizon included. */
static inline double bis_bsdf_pdf(const bis_bsdf *b, vec3 wi)
{
    double pdf;

    b->material->model->f_pdf(b, wi, &pdf);
    return pdf;
}

/* Both at once, for the price of one. The same bits as one by one. */
static inline rgb bis_bsdf_f_pdf(const bis_bsdf *b, vec3 wi, double *pdf)
{
    return b->material->model->f_pdf(b, wi, pdf);
}

/* An upper bound of max over channels and wi of f cos (rejection, E27), and one of max over channels and wi of f cos /
 * pdf. */
static inline double bis_bsdf_max_f_cos(const bis_bsdf *b) { return b->material->model->max_f_cos(b); }
static inline double bis_bsdf_max_ratio(const bis_bsdf *b) { return b->material->model->max_ratio(b); }

#endif
