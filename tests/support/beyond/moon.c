/* SPDX-License-Identifier: BSD-2-Clause */
/* moon: dust, by the law of Lommel and Seeliger. */
#include "thesis/real_double.h"

#include "beyond/moon_formulas.h"

#include "thesis/model_one.h"

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
    .max_f_cos = unit_of, .max_ratio = max_ratio, .usual = {.Kd = {0.5f, 0.5f, 0.5f}}, .remake = remake,
    .width = width, .many = &bis_moon_many};
