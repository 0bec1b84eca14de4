/* SPDX-License-Identifier: BSD-2-Clause */
/* mapping: how a picture covers the sphere, and the resampling of one such picture to another.
 *
 * The thesis and all of bis compute with lat-long maps (bis/thesis/envmap.h). Maps in other mappings are resampled to
 * one when they are read; `bis envmap --to` resamples into the others. Sources: P. Debevec, "Light Probe Image Gallery"
 * (angular); P. Clarberg, "Fast Equal-Area Mapping of the (Hemi)Sphere using SIMD", Journal of Graphics Tools 13(3),
 * 2008 (equal-area, as pbrt-v4 has it). */
#pragma once

#include "bis/base/image.h"
#include "bis/thesis/envmap.h"

/* All pictures are seen from inside, and up is +z of the light's frame. The middle of angular, mirrorball and the
 * crosses looks along -x, as the middle column of a lat-long map does; -y is to its right. */
typedef enum bis_mapping {
    BIS_MAPPING_LATLONG,         /* 2:1, but any shape is taken */
    BIS_MAPPING_ANGULAR,         /* a disc in a square; the distance from the middle is the angle from -x over pi */
    BIS_MAPPING_EQUALAREA,       /* Clarberg's square: an octahedron unfolded, all pixels of one solid angle */
    BIS_MAPPING_MIRRORBALL,      /* a disc in a square; the distance is the sine of half the angle */
    BIS_MAPPING_VERTICAL_CROSS,  /* 3:4 faces: up; left, front, right; down; back upside down */
    BIS_MAPPING_HORIZONTAL_CROSS, /* 4:3 faces: up; left, front, right, back; down */
    BIS_MAPPING_CUBE_STRIP,      /* 6:1 or 1:6 faces: right, left, up, down, front, back */
    BIS_N_MAPPINGS
} bis_mapping;

/* The mappings' names in scenes and options, in the order of bis_mapping, ended by NULL. */
extern const char *const bis_mapping_names[BIS_N_MAPPINGS + 1];

/* bis_mapping_find returns the mapping of this name, or BIS_N_MAPPINGS. */
bis_mapping bis_mapping_find(const char *name);

/* bis_mapping_fits returns whether a picture of width x height pixels can have this mapping; bis_mapping_shape says
 * what shape it must have ("square", "of 3 x 4 square faces"). */
bool bis_mapping_fits(bis_mapping mapping, int width, int height);
const char *bis_mapping_shape(bis_mapping mapping);

/* bis_mapping_width returns the width of the lat-long map that shows all detail of a picture of width x height pixels:
 * twice the side of a square, four times the side of a cube's face, or `wanted` if that is not 0; made even. A
 * lat-long map keeps its width. The shape must fit. */
int bis_mapping_width(bis_mapping mapping, int width, int height, int wanted);

/* bis_envmap_from_mapping makes a lat-long map of the image; bis_mapping_width takes width as `wanted`. Each patch
 * is the mean over its solid angle; em->power_before and em->power_after are the integrals of r+g+b over the sphere. A
 * lat-long image is taken as it is (bis_envmap_from_latlong). Bad values inside the map are set to 0 and counted; what
 * lies outside a disc or a cross is not read. The image is borrowed, but of a lat-long image the pixels are taken over.
 * Errors: BIS_INPUT (the shape does not fit, a radiance that no float holds), BIS_NOMEM. */
bis_status bis_envmap_from_mapping(bis_envmap *em, bis_image *image, bis_mapping mapping, int width, bis_diag *diag);

/* bis_envmap_to_mapping resamples a lat-long map to a new image in another mapping; what lies outside a disc or a cross
 * is black. width is that of the image; 0: as many pixels around the sphere as the map has. power[0] and power[1]
 * receive the integrals of r+g+b before and after, which agree but for the rounding of floats. Errors: BIS_INPUT (a
 * cross whose width is no multiple of its faces, an image too large, a radiance that no float holds), BIS_NOMEM. */
bis_status bis_envmap_to_mapping(bis_image *image, const bis_envmap *em, bis_mapping mapping, int width,
                                 double power[2], bis_diag *diag);
