/* SPDX-License-Identifier: BSD-2-Clause */
/* `bis verify` of a point in view rejects an integrator `exact` that is 1 % too bright. A program of its own, because
 * `exact` takes long. */
#include "tools/verify/verify.h"
#include "bis/thesis/phong.h"
#include "claim.h"
#include "lit.h"
#include "verify_help.h"

static rgb Lo_exact_one_percent_more(
    const bis_settings *s, const bis_point *pt, bis_stream *stream, bis_scratch *scratch)
{
    return rgb_scale(bis_exact.Lo(s, pt, stream, scratch), 1.01);
}

static void exact_that_is_one_percent_off_is_rejected(void **state)
{
    bis_light *light = lit_new_light(LIT_SMOOTH, 1, 0.15, false);
    bis_integrator forged = bis_exact;
    bis_settings s = bis_settings_default(&bis_exact);
    lit l;
    bool tested;
    lit_init(&l, light, verify_glossy(&bis_phong_model, 10), normalize(vec3_from(0.2, -0.3, 0.8)), 40, LIT_HALF);
    forged.Lo = Lo_exact_one_percent_more;
    s.integrator = &forged;
    for (uint64_t seed = 0; seed < VERIFY_SEEDS; seed++) {
        bis_verify v = {.seed = seed, .halvings = 1};
        assert_int_equal(
            bis_verify_point(&v, &(bis_verify_place){"wrong", &l.pt, BIS_SAMPLER_STRATIFIED}, &s, 1, &tested, NULL),
            BIS_OK);
        assert_true(verify_failures(&v) > 0);
    }
    bis_light_free(light);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(exact_that_is_one_percent_off_is_rejected),
    };
    return cmocka_run_group_tests_name("verify_exact", tests, NULL, NULL);
}
