/* SPDX-License-Identifier: BSD-2-Clause */
/* claim: cmocka, by which a test makes its claims, behind the headers that it wants before it. */
#ifndef TESTS_CLAIM_H
#define TESTS_CLAIM_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#endif
