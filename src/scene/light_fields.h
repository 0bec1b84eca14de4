/* SPDX-License-Identifier: BSD-2-Clause */
/* light_fields: which fields of a light's description count. For the identity of a render, and for the parser, which
 * asks whether a second light is the first one. */
#pragma once

#include "base/fields.h"

/* The fields of bis_light_desc on which pictures depend, but for what is made into the pixels of its map. */
extern const bis_field bis_light_fields[];
