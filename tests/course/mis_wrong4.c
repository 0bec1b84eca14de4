/* SPDX-License-Identifier: BSD-2-Clause */
/* Always the balance heuristic; rays before anybody asks whether they are worth it. */
/* loses: the_power_heuristic_is_right */
/* loses: the_weights_are_those_of_the_power_heuristic */
/* loses: each_sample_casts_one_ray_at_most */
/* [mis-weight] */
static double weight(bis_heuristic heuristic, double own, double other)
{
    (void)heuristic;
    return own / (own + other);
}
/* [end] */
/* [mis-brdf] */
-        if (rgbd_sum(C) <= 0) continue;
-        C = rgbd_scale(C, weight(s->heuristic, (double)n_brdf * q_brdf, (double)n_em * q_em));
-        bis_point_add(sum, pt, wi, C, NULL);
+        if (!bis_point_sees(pt, wi)) continue;
+        *sum = rgbd_add(*sum, rgbd_scale(C, weight(s->heuristic, (double)n_brdf * q_brdf, (double)n_em * q_em)));
/* [end] */
