/* bsdf: prepares the frame at a shading point, and answers whether anything is reflected there. All else depends on
 * the model and stands behind the model's functions. */
#include "bis/thesis/bsdf.h"

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

bool bis_bsdf_is_black(const bis_bsdf *b)
{
    const bis_material *m = b->material;

    return (rgb_is_black(m->Kd) && rgb_is_black(m->Ks)) || bis_bsdf_cos(b, b->wo) <= 0;
}
