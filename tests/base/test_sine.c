/* SPDX-License-Identifier: BSD-2-Clause */
/* sine: the nearest double, by 128-bit or 80-bit functions where long double has them, and the same on every machine.
 */
#include "base/sine.h"

#include "bis/base/vec.h"
#include "bis/thesis/rng.h"
#include "claim.h"

#include <float.h>
#include <math.h>
#include <string.h>

static double nth(bis_rng *g, int i)
{
    const double u = bis_rng_double(g);
    return PI / 2 * (i % 4 ? u : pow(10, -15 * u));
}

/* sin and cos in long double. Its own error is below 2^-11 of a double's half unit on x86, less elsewhere: where the
 * nearest doubles on both sides of it are not one, x is too near a middle for it to judge. */
typedef long double function(long double x);

static int count_wrong(double (*ours)(double), function *f)
{
    enum { N = 200000 };
    int wrong = 0, judged = 0;
    bis_rng g;

    bis_rng_init(&g, 29, 0, 0, 0);
    for (int i = 0; i < N; i++) {
        const double x = fmin(nth(&g, i), PI / 2 - 1e-7);
        const long double y = f((long double)x), slack = 2 * LDBL_EPSILON * y;
        if ((double)(y - slack) != (double)(y + slack)) continue;
        wrong += ours(x) != (double)y;
        judged++;
    }
    assert_true(judged > N - N / 100);
    return wrong;
}

static void they_are_the_nearest_doubles(void **state)
{
    if (LDBL_MANT_DIG < 64) skip(); /* a long double is a double here */
    assert_int_equal(count_wrong(bis_sine, sinl), 0);
    assert_int_equal(count_wrong(bis_cosine, cosl), 0);
}

/* sin(9 pi/32) is 0.4901 units from one double and 0.5099 from the next, which musl's sin takes; x is 9 PI / 32 in
 * double. sin x of the least x is x. The middle row of an odd map rounds pi/2 upwards. */
static void known_values(void **state)
{
    assert_true(bis_sine(9 * PI / 32) == 0.77301045336273699);
    assert_true(bis_sine(0) == 0 && bis_cosine(0) == 1);
    assert_true(bis_sine(DBL_TRUE_MIN) == DBL_TRUE_MIN && bis_sine(1e-300) == 1e-300);
    assert_true(bis_sine(PI / 2) == 1 && bis_sine(nextafter(PI / 2, 2)) == 1);
}

/* The promise: one hash of what 4096 rows of a map take, on every machine. */
static void bits_are_those_of_every_machine(void **state)
{
    uint64_t hash = UINT64_C(0xcbf29ce484222325);

    for (int y = 0; y < 4096; y++) {
        const double v[2] = {bis_sine(PI * (y + 0.5) / 8192), bis_cosine(PI * y / 8192)};
        for (int k = 0; k < 2; k++) {
            uint64_t bits;
            memcpy(&bits, &v[k], sizeof bits);
            hash = (hash ^ bits) * UINT64_C(0x100000001b3);
        }
    }
    if (hash != UINT64_C(0xfab89b41f0225b22)) fail_msg("the hash is 0x%016llx", (unsigned long long)hash);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(they_are_the_nearest_doubles),
        cmocka_unit_test(known_values),
        cmocka_unit_test(bits_are_those_of_every_machine),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
