/* SPDX-License-Identifier: BSD-2-Clause */
/* vec: a frame about any direction. Numbers and colours by component show in every picture. */
#include "bis/base/vec.h"

#include "bis/thesis/rng.h"
#include "claim.h"

static void assert_basis(vec3 z)
{
    const frame f = frame_about(z);
    const vec3 w = to_world(&f, to_local(&f, (vec3){2, 3, 5})), third = sub(cross(f.x, f.y), f.z);
    assert_true(f.z.x == z.x && f.z.y == z.y && f.z.z == z.z);
    assert_true(fabs(length(f.x) - 1) < 1e-6 && fabs(length(f.y) - 1) < 1e-6);
    assert_true(fabs(dot(f.x, f.y)) < 1e-6 && fabs(dot(f.x, f.z)) < 1e-6 && fabs(dot(f.y, f.z)) < 1e-6);
    assert_true(length(third) < 2e-6); /* right-handed; three components, each wrong by 1e-6 */
    assert_true(length(sub(w, (vec3){2, 3, 5})) < 4e-5); /* length 6.2, six components of 1e-6 each */
}

/* Directions all around, the poles, and directions beside them, where other formulas fail. */
static void a_frame_about_any_direction_is_orthonormal_and_right_handed(void **state)
{
    bis_rng g;
    bis_rng_init(&g, 5, 0, 0, 0);
    for (int i = 0; i < 20000; i++) {
        double c[3];
        for (int k = 0; k < 3; k++) c[k] = 2 * bis_rng_double(&g) - 1;
        assert_basis(normalize(vec3_from(c[0], c[1], c[2])));
        const double small = pow(10, -12 * bis_rng_double(&g)); /* from the pole on */
        assert_basis(normalize(vec3_from(small * c[0], small * c[1], i % 2 ? 1 : -1)));
    }
    assert_basis((vec3){0, 0, 1});
    assert_basis((vec3){0, 0, -1});
    assert_basis((vec3){0, 1, -0.f});
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_frame_about_any_direction_is_orthonormal_and_right_handed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
