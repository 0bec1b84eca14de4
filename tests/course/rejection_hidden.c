/* Two fallbacks trace a choice of the candidates, as the ratio estimator does. */
    /* [fall-back-resample] */
    /* BIS_FALLBACK_RESAMPLE and BIS_FALLBACK_SUBSET are left out of this kit. */
    (void)N, (void)Zhat, (void)stream, (void)black;
    /* [end] */
    /* [fall-back-subset] */
    return bis_set_mean(x);
    /* [end] */
