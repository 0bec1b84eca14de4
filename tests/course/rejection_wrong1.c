/* The mean over the traced ones, times B/M: how many were accepted is lost. */
/* loses: many_rays_are_right */
/* loses: fewer_rays_than_accepted_are_right */
    /* [rejection-estimate] */
    uint32_t n = A < N ? A : N;
    draw_without_replacement(scratch->chosen, A, n, stream);
    double Z = s->estimator == BIS_ESTIMATOR_PLAIN ? B / M : W / M;
    return rgbd_round(bis_candidates_trace(pt, x, scratch->chosen, n, Z / n));
    /* [end] */
