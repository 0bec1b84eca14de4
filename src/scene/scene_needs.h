/* SPDX-License-Identifier: BSD-2-Clause */
/* scene_needs: what a scene requires, found once from its description. scene.c builds it, scene_check.c looks at the
 * heads of its files, `bis --plan` prints it, and the forecast of memory adds it up (src/tools). None of them decides
 * for itself. */
#pragma once

#include "bis/scene/scene.h"

typedef struct bis_scene_needs {
    size_t *uses;     /* uses[n_meshes]: how many shapes each mesh has; 0: it is not read */
    bool *with_uv;    /* with_uv[n_meshes]: a shape of it has textures that ask for (u, v) */
    bool *materials;  /* materials[n_materials]: a shape shows it */
    bool *images;     /* images[textures.n_files]: a shape shows it */
    size_t n_quadrics;
    unsigned light;   /* BIS_NEED_*: what is built of the light */
    bis_table_kind table;
    const char *why_no_drawing; /* why nothing is built to draw from the light; NULL: it is */
    bool embree;      /* the accelerator is Embree, if the scene's size is within its reach (src/shape/accel.c) */
} bis_scene_needs;

/* bis_scene_needs_of finds what *desc requires. *needs is to be cleared, after a failure, too. Errors: BIS_NOMEM. */
bis_status bis_scene_needs_of(bis_scene_needs *needs, const bis_scene_desc *desc, bis_diag *diag);

/* bis_scene_learns returns whether some surface learns from its neighbours in the picture, unless the light turns out
 * to be black. */
bool bis_scene_learns(const bis_scene_desc *desc);

/* bis_scene_needs_clear frees it. */
void bis_scene_needs_clear(bis_scene_needs *needs);
