/* SPDX-License-Identifier: BSD-2-Clause */
/* clone_phong: see clones.h. */
#include "clone.h"
#define bis_phong_model CLONE(phong_model)
#define bis_phong CLONE(phong)
#define bis_phong_power CLONE(phong_power)
#define bis_phong_lobe_pdf CLONE(phong_lobe_pdf)
#define bis_phong_lobe_sample CLONE(phong_lobe_sample)
#include "thesis/phong.c"
