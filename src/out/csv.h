/* SPDX-License-Identifier: BSD-2-Clause */
/* csv: numbers as fields of a table (RFC 4180), each behind a comma. They read back as the same doubles; what is not
 * known, NaN or infinite, is an empty field. */
#pragma once

#include "bis/base/file.h"

#include <math.h>

/* bis_csv_numbers writes n fields, each behind a comma. */
static inline void bis_csv_numbers(FILE *out, const double *v, size_t n)
{
    char text[32];
    for (size_t i = 0; i < n; i++) fprintf(out, ",%s", isfinite(v[i]) ? bis_format_double(text, v[i]) : "");
}

/* BIS_CSV(out, a, b, ...) */
#define BIS_CSV(out, ...)                                                                                              \
    bis_csv_numbers(out, (const double[]){__VA_ARGS__}, sizeof((const double[]){__VA_ARGS__}) / sizeof(double))
