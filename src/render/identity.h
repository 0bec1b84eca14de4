/* SPDX-License-Identifier: BSD-2-Clause */
/* identity: who a render is, as a hash of each of its parts: the scene, the view, the settings. For the files of
 * src/render. */
#pragma once

#include "workspace.h"

#include "base/fields.h"

/* src/render/identity.c names the parts. */
enum { BIS_IDENTITY_PARTS = 12 };

/* The fields of a struct that count, and the names of the others. */
typedef struct bis_identity_struct {
    const char *type; /* NULL ends the list; a struct may have several lists of fields */
    const bis_field *fields;
    const char *rest;
} bis_identity_struct;

/* The structs whose fields are hashed: for the test that no field is missing. */
extern const bis_identity_struct bis_identity_structs[];

/* bis_identify hashes the parts of a render, whose edges must be known. */
void bis_identify(uint64_t parts[BIS_IDENTITY_PARTS], const bis_workspace *of);

/* bis_identity_differs writes to list[size] the names of the parts in which a and b differ, and returns whether there
 * are any. */
bool bis_identity_differs(char *list, size_t size, const uint64_t a[BIS_IDENTITY_PARTS],
                          const uint64_t b[BIS_IDENTITY_PARTS]);
