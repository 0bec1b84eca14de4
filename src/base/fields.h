/* SPDX-License-Identifier: BSD-2-Clause */
/* fields: tables of the fields of a struct, for what is done to one after the other. Field by field, and not to the
 * bytes of the struct, whose padding is anything. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <string.h>

/* n numbers of `bytes` bytes. */
typedef struct bis_field {
    const char *name; /* NULL ends a table */
    size_t offset, n, bytes;
} bis_field;

#define BIS_FIELD(type, member, of) \
    {#member, offsetof(type, member), sizeof ((type *)NULL)->member / (sizeof(of)), sizeof(of)}
#define BIS_FIELDS_END {NULL, 0, 0, 0}

/* bis_fields_are_equal returns whether structs a and b have the same bits in the fields of a table. */
static inline bool bis_fields_are_equal(const void *a, const void *b, const bis_field *fields)
{
    const bis_field *f = fields;

    while (f->name && memcmp((const char *)a + f->offset, (const char *)b + f->offset, f->n * f->bytes) == 0) f++;
    return !f->name;
}
