/* SPDX-License-Identifier: BSD-2-Clause */
/* Weights as they lie in the set, in a unit that is not that of B. */
/* loses: candidates_of_the_map_are_accepted_with_probability_w_over_B */
/* loses: candidates_of_the_brdf_are_accepted_with_probability_w_over_B */
/* loses: the_smaller_bound_is_chosen_more_often */
/* loses: one_candidate_and_one_ray_are_right */
/* loses: many_rays_are_right */
/* loses: fewer_rays_than_accepted_are_right */
/* loses: at_most_N_of_the_accepted_are_traced */
/* [accept] */
-        const double w = bis_set_weight(set, i);
+        const double w = (double)set->choice.w[i];
/* [end] */
