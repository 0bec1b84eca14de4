/* SPDX-License-Identifier: BSD-2-Clause */
/* moon: dust, by the law of Lommel and Seeliger. */
#include "bis/thesis/bsdf.h"

extern const bis_bsdf_model bis_moon_model;

/* f cos = Kd/(4 pi) c_i/(c_i + c_o) grows with c_i. Unit vectors are such to 2^-23, f is rounded to float: 2^-21. */
static double max_f_cos(const bis_bsdf *b)
{
    return rgb_max(b->material->Kd) * INV_PI / 4 / (1 + bis_bsdf_cos(b, b->wo)) * (1 + 0x1p-21);
}

static double unit_of(const bis_bsdf *b) { return max_f_cos(b); }

#define MODEL moon
#define FORMULAS "beyond/moon_formulas.h"
#define KINDS 1
#include "thesis/model.h"

/* f cos/(cos/pi) = Kd/(4 (c_i + c_o)) falls with c_i. */
static double max_ratio(const bis_bsdf *b)
{
    return rgb_max(b->material->Kd) / 4 / bis_bsdf_cos(b, b->wo) * (1 + 0x1p-21);
}

static void init(bis_bsdf *b)
{
    b->r = b->local.z;
    b->lobe = b->local;
    b->p_specular = 0;
}

static bis_bsdf_width width(const bis_material *m)
{
    return (bis_bsdf_width){.name = "Kd", .value = (double)m->Kd.g};
}

static bis_material remake(const bis_material *m, rgb Kd, rgb Ks, const double *width)
{
    (void)Ks, (void)width; /* there is no lobe */
    return (bis_material){.model = m->model, .Kd = Kd};
}

const bis_bsdf_model bis_moon_model = {.name = "moon", .init = init, .sample = sample, .f_pdf = f_pdf,
    .max_f_cos = max_f_cos, .max_ratio = max_ratio, .usual = {.Kd = {0.5f, 0.5f, 0.5f}}, .remake = remake,
    .width = width, .f_many = f_many, .sample_many = sample_many};
