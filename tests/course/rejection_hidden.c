/* The fallback "subset" is the ratio estimator, over all candidates. */
    /* [fall-back-subset] */
    /* BIS_FALLBACK_SUBSET is left out of this kit. */
    (void)positive, (void)draw_without_replacement;
    return bis_candidates_unoccluded(x, M);
    /* [end] */
