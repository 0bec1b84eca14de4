/* The first N candidates, as plain importance sampling has it: unbiased, as noisy as N samples. */
/* loses: unbiased_for_few_candidates */
/* loses: unbiased_for_many_candidates */
/* loses: rays_add_no_noise_where_nothing_is_hidden */
    /* [sir-estimate] */
    double Zhat = W / M;
    rgbd L = {0, 0, 0};
    uint32_t n = N < M ? N : M;
    for (uint32_t i = 0; i < n; i++) {
        if (x[i].w > 0 && bis_point_sees(pt, x[i].wi)) L = rgbd_add(L, rgbd_scale(x[i].C, 1 / (double)n));
    }
    /* [end] */
