/* SPDX-License-Identifier: BSD-2-Clause */
/* The fallback "subset" traces a choice of the candidates, as the ratio estimator does. */
    /* [fall-back-subset] */
    /* BIS_FALLBACK_SUBSET is left out of this kit. */
    return bis_set_mean(set);
    /* [end] */
