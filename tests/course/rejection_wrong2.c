/* SPDX-License-Identifier: BSD-2-Clause */
/* Accepting ends when there are enough to trace (E22), here four, and the first N are traced; the larger bound is
 * preferred. */
/* loses: candidates_of_the_brdf_are_accepted_with_probability_w_over_B */
/* loses: the_smaller_bound_is_chosen_more_often */
/* loses: fewer_rays_than_accepted_are_right */
/* loses: at_most_N_of_the_accepted_are_traced */
/* [choose-proposal] */
-    return bis_stream_random(stream) * (c_em + c_brdf) < c_brdf ? BIS_PROPOSAL_EM : BIS_PROPOSAL_BRDF;
+    return bis_stream_random(stream) * (c_em + c_brdf) < c_em ? BIS_PROPOSAL_EM : BIS_PROPOSAL_BRDF;
/* [end] */
/* [accept] */
-    for (uint32_t i = 0; i < set->choice.n; i++) {
+    for (uint32_t i = 0; i < set->choice.n && A < 4; i++) {
/* [end] */
