/* SPDX-License-Identifier: BSD-2-Clause */
/* One fallback of rejection is SIR. */
/* without: docs/extending.md */
    /* [fall-back-resample] */
    /* BIS_FALLBACK_RESAMPLE is left out of this kit. */
    if (s->fallback == BIS_FALLBACK_RESAMPLE) return bis_set_mean(set);
    /* [end] */
