/* SPDX-License-Identifier: BSD-2-Clause */
/* `bis verify` of a material must be able to fail: right ones pass, forged ones do not. */
#include "tools/verify/verify.h"
#include "bis/beyond/microfacet.h"
#include "bis/thesis/phong.h"
#include "claim.h"
#include "verify_help.h"

#include <string.h>

static void right_materials_pass(void **state)
{
    const double exponents[] = {0, 1, 2.5, 50, 1e4, 1e6};
    for (size_t i = 0; i < 6; i++) {
        const bis_material m = verify_glossy(&bis_phong_model, exponents[i]);
        bis_settings s[] = {bis_settings_default(&bis_brdf), bis_settings_default(&bis_sir)};
        s[1].candidates = 64;
        bis_verify v = {.seed = i};
        for (int k = 0; k < 3; k++) {
            const double degrees[] = {0, 60, 89.5};
            assert_int_equal(bis_verify_material(&v, &(bis_verify_lobe){"right", &m, degrees[k]}, s, 2, NULL), BIS_OK);
        }
        assert_int_equal(v.n, 12);
        /* quadrature is as good as it was measured; its limit is three times that */
        for (int k = 0; k < 3; k++) assert_true(v.tests[4 * k].statistic < 1.7e-5 + 1e-7 * sqrt(exponents[i]));
        verify_assert_accepted(&v);
    }
}

/* Models that draw a half vector have their cells about the normal, in its angles. Rough, smooth, a metal; the drawn
 * density alone tells whether a direction is counted where it lies. */
static void right_microfacets_pass(void **state)
{
    const rgb Kd = {0.1f, 0.3f, 0.2f}, Ks = {0.6f, 0.4f, 0.5f};
    bis_material m[3] = {bis_microfacet(Kd, Ks, 1), bis_microfacet(Kd, Ks, 0.2),
                         bis_microfacet((rgb){0, 0, 0}, Ks, 0.5)};
    m[2].eta = (rgb){1.5f, 0.8f, 0.4f};
    for (size_t i = 0; i < 3; i++) {
        const bis_settings s = bis_settings_default(&bis_brdf);
        const double degrees[] = {0, 50, 80};
        bis_verify v = {.seed = i};
        for (int k = 0; k < 3; k++)
            assert_int_equal(bis_verify_material(&v, &(bis_verify_lobe){"right", &m[i], degrees[k]}, &s, 1, NULL),
                BIS_OK);
        assert_int_equal(v.n, 9);
        verify_assert_accepted(&v);
    }
}

/* n + 1 for n: the material's exponent, raised while the model draws. */
static bool draw_sharper(const bis_bsdf *b, double u0, double u1, double u2, vec3 *wi)
{
    bis_material m = *b->material;
    bis_bsdf sharper = *b;
    m.exponent++;
    sharper.material = &m;
    return bis_phong_model.sample(&sharper, u0, u1, u2, wi);
}

static rgb pdf_without_factor(const bis_bsdf *b, vec3 wi, double *pdf)
{
    const rgb f = bis_phong_model.f_pdf(b, wi, pdf);
    *pdf *= 0.98;
    return f;
}

/* A draw below the horizon is drawn again (E34). */
static bool draw_above(const bis_bsdf *b, double u0, double u1, double u2, vec3 *wi)
{
    bool drawn = bis_phong_model.sample(b, u0, u1, u2, wi);
    for (int i = 0; drawn && i < 100 && bis_bsdf_cos(b, *wi) <= 0; i++) {
        u1 = fmod(u1 * 7 + 0.37, 1);
        u2 = fmod(u2 * 5 + 0.21, 1);
        drawn = bis_phong_model.sample(b, u0, u1, u2, wi);
    }
    return drawn;
}

static rgb pdf_too_small(const bis_bsdf *b, vec3 wi, double *pdf)
{
    const rgb f = bis_phong_model.f_pdf(b, wi, pdf);
    *pdf *= 0.9; /* weights too large by a ninth */
    return f;
}

static bool draw_lobes_exchanged(const bis_bsdf *b, double u0, double u1, double u2, vec3 *wi)
{
    return bis_phong_model.sample(b, 1 - u0, u1, u2, wi);
}

static void forged_materials_are_rejected(void **state)
{
    bis_bsdf_model forged[5];
    for (int i = 0; i < 5; i++) forged[i] = bis_phong_model;
    forged[0].sample = draw_sharper;
    forged[1].f_pdf = pdf_without_factor;
    forged[2].sample = draw_above;
    forged[3].sample = draw_lobes_exchanged;
    forged[4].f_pdf = pdf_too_small;
    for (int i = 0; i < 5; i++) {
        const bis_material m = verify_glossy(&forged[i], 20);
        const bis_settings s = bis_settings_default(&bis_brdf);
        for (uint64_t seed = 0; seed < VERIFY_SEEDS; seed++) {
            bis_verify v = {.seed = seed};
            assert_int_equal(bis_verify_material(&v, &(bis_verify_lobe){"forged", &m, 75}, &s, 1, NULL), BIS_OK);
            assert_int_equal(bis_verify_judge(&v, NULL), BIS_OK);
            assert_int_equal(v.n, 3);
            /* the last one is so wrong that its furnace tells it, too */
            const bool by_furnace = v.tests[2].verdict == BIS_VERDICT_FAILED;
            if (verify_failures(&v) == 0 || (i == 4 && !by_furnace)) fail_msg("forgery %d was accepted", i);
        }
    }
}

/* ---- a width in a field of its own ---- */

/* Microfacets that keep alpha in `exponent`, as a model may that has its number in a field of its own. */
static bis_material usual(const bis_material *m)
{
    bis_material other = *m;
    other.model = &bis_microfacet_model;
    other.alpha = m->exponent;
    return other;
}

static bool own_sample(const bis_bsdf *b, double u0, double u1, double u2, vec3 *wi)
{
    const bis_material m = usual(b->material);
    bis_bsdf other = *b;
    other.material = &m;
    return bis_microfacet_model.sample(&other, u0, u1, u2, wi);
}

static rgb own_f_pdf(const bis_bsdf *b, vec3 wi, double *pdf)
{
    const bis_material m = usual(b->material);
    bis_bsdf other = *b;
    other.material = &m;
    return bis_microfacet_model.f_pdf(&other, wi, pdf);
}

static rgb own_pdf_too_large(const bis_bsdf *b, vec3 wi, double *pdf)
{
    const rgb f = own_f_pdf(b, wi, pdf);
    *pdf *= 3;
    return f;
}

static bis_bsdf_width own_width(const bis_material *m)
{
    const bis_material other = usual(m);
    return bis_microfacet_model.width(&other);
}

static void a_width_is_what_the_model_says(void **state)
{
    const bis_settings s = bis_settings_default(&bis_brdf);
    for (int twin = 0; twin < 2; twin++) {
        bis_bsdf_model model = bis_microfacet_model;
        bis_material m = bis_microfacet((rgb){0.1f, 0.3f, 0.2f}, (rgb){0.6f, 0.4f, 0.5f}, 0.5);
        bis_verify v = {.seed = 1};
        model.sample = own_sample;
        model.f_pdf = twin ? own_pdf_too_large : own_f_pdf;
        model.width = own_width;
        m.model = &model;
        m.exponent = m.alpha;
        m.alpha = 0;
        assert_int_equal(bis_verify_material(&v, &(bis_verify_lobe){"own", &m, 30}, &s, 1, NULL), BIS_OK);
        assert_int_equal(v.n, 3);
        if (!twin) {
            verify_assert_accepted(&v);
            continue;
        }
        assert_int_equal(bis_verify_judge(&v, NULL), BIS_OK);
        assert_int_equal(v.tests[0].verdict, BIS_VERDICT_FAILED); /* it integrates to 3 */
        assert_int_equal(v.tests[2].verdict, BIS_VERDICT_FAILED); /* and reflects a third */
        bis_verify_clear(&v);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(right_materials_pass),
        cmocka_unit_test(right_microfacets_pass),
        cmocka_unit_test(forged_materials_are_rejected),
        cmocka_unit_test(a_width_is_what_the_model_says),
    };
    return cmocka_run_group_tests_name("verify_bsdf", tests, NULL, NULL);
}
