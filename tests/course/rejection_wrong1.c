/* SPDX-License-Identifier: BSD-2-Clause */
/* The mean over the traced ones, times B/M: how many were accepted is lost. */
/* loses: many_rays_are_right */
/* loses: fewer_rays_than_accepted_are_right */
    /* [rejection-estimate] */
    const uint32_t n = A < N ? A : N;
    draw_without_replacement(set->choice.item, A, n, stream);
    bis_set_take(set, n);
    const double Z = s->estimator == BIS_ESTIMATOR_PLAIN ? B / M : Zhat;
    return rgbd_round(bis_set_trace((rgbd){0, 0, 0}, set, pt, Z / n));
    /* [end] */
