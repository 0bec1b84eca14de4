/* SPDX-License-Identifier: BSD-2-Clause */
/* All accepted ones are traced, however few rays there are; the ratio estimator is the plain one. */
/* loses: fewer_rays_than_accepted_are_right */
/* loses: the_ratio_estimator_is_right_to_two_percent */
/* loses: at_most_N_of_the_accepted_are_traced */
    /* [rejection-estimate] */
    (void)N, (void)draw_without_replacement;
    bis_set_take(set, A);
    return rgbd_round(bis_set_trace((rgbd){0, 0, 0}, set, pt, B / M));
    /* [end] */
