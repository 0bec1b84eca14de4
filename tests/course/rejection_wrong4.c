/* SPDX-License-Identifier: BSD-2-Clause */
/* One random number for all candidates: in the mean as many are accepted, but all or none. */
/* loses: candidates_of_the_map_are_accepted_with_probability_w_over_B */
/* loses: candidates_of_the_brdf_are_accepted_with_probability_w_over_B */
/* loses: the_smaller_bound_is_chosen_more_often */
/* loses: the_ratio_estimator_is_right_to_two_percent */
/* loses: at_most_N_of_the_accepted_are_traced */
/* [accept] */
 {
+    const double u = bis_stream_random(stream);
-        const double w = bis_set_weight(set, i);
-        if (w > 0 && bis_stream_random(stream) * B < w) set->choice.item[A++] = i;
+        if (u * B < bis_set_weight(set, i)) set->choice.item[A++] = i;
/* [end] */
