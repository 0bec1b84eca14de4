/* SPDX-License-Identifier: BSD-2-Clause */
/* memory: what a render will take, foretold from the description of the scene and the first bytes of its files. */
#pragma once

#include "bis/scene/scene.h"

enum { BIS_MEMORY_ADVICE = 320 };

/* Bytes of a pixel in the pass under way; of a value of a layer, in its sum and in the pass. */
enum { BIS_PASS_BYTES = 16, BIS_LAYER_SUM_BYTES = 8, BIS_LAYER_PASS_BYTES = 4 };

/* Bytes. */
typedef struct bis_memory {
    double film;   /* sums, the pass under way, layers, learned visibility */
    double map;    /* pixels, and what directions are drawn with */
    double meshes, textures;
    double accel;
    double peak;   /* of all, at the worst moment */
    double before; /* at the worst moment before the first pass */
    double merged; /* when the parts of the picture are put together */
    bool guessed;  /* a file did not tell its size, and its length served instead */
} bis_memory;

/* bis_memory_map_size stores the size of the lat-long map that will be made of the light's file, and the mapping of the
 * file. Returns false if the file's head does not tell. */
bool bis_memory_map_size(const bis_light_desc *light, long *width, long *height, bis_mapping *mapping);

/* bis_memory_foresee foretells the memory of a render with these settings. It reads no more than the heads of files.
 * The peak is right within 15 % where it is above 100 MB (tests/tools/test_memory.c). Errors: BIS_NOMEM. */
bis_status bis_memory_foresee(bis_memory *m, const bis_scene_desc *desc, bis_diag *diag);

/* bis_memory_advise writes into text what makes this render, of which *m was foretold, take less than `room` bytes, or
 * less at all, each with what is then taken: "--layers none (1.2 GB), ..."; "" where nothing does. Errors:
 * BIS_NOMEM. */
bis_status bis_memory_advise(char text[BIS_MEMORY_ADVICE], const bis_memory *m, const bis_scene_desc *desc,
                             double room, bis_diag *diag);

/* bis_memory_free returns the bytes that the system can give without swapping; 0: unknown. */
double bis_memory_free(void);
