/* The same formulas for many directions at once, and here for one after the other. */
/* [phong-lanes] */
/* One by one in this kit, by your functions in phong.c. In units of the light's mean radiance. */
static double weigh(float *w, const bis_bsdf *b, const bis_lanes *y, uint32_t n, double beta)
{
    for (uint32_t i = 0; i < bis_lanes_round_up(n); i++) {
        const vec3 wi = {y->x[i], y->y[i], y->z[i]};
        const double cos_theta = bis_bsdf_cos(b, wi);
        double q_f;
        const rgb f = bis_bsdf_f_pdf(b, wi, &q_f);
        const double phat = cos_theta * (double)(f.r * y->r[i] + f.g * y->g[i] + f.b * y->b[i]);
        const double q = beta * (double)y->q[i] + (1 - beta) * q_f;
        w[i] = cos_theta > 0 && q > 0 ? (float)(phat / q) : 0;
    }
    return 1;
}

static void colour(const bis_bsdf *b, const bis_lanes *y, uint32_t n)
{
    for (uint32_t i = 0; i < bis_lanes_round_up(n); i++) {
        const rgb f = bis_bsdf_f(b, (vec3){y->x[i], y->y[i], y->z[i]});
        const rgb fLe = {f.r * y->r[i], f.g * y->g[i], f.b * y->b[i]};
        const float sum = fLe.r + fLe.g + fLe.b, share = sum > 0 ? 1 / sum : 0;
        y->r[i] = fLe.r * share;
        y->g[i] = fLe.g * share;
        y->b[i] = fLe.b * share;
    }
}

/* The bound of the whole sphere is one of each cone. */
static void reach(float *w, const bis_bsdf *b, const bis_lanes *cone, const float *sine, uint32_t n)
{
    (void)b, (void)sine;
    for (uint32_t i = 0; i < bis_lanes_round_up(n); i++) w[i] = cone->r[i] + cone->g[i] + cone->b[i];
}

static void sample(const bis_lanes *y, const bis_bsdf *b, const float *u1, const float *u2, uint32_t n)
{
    for (uint32_t i = 0; i < bis_lanes_round_up(n); i++) {
        const bool specular = (double)u1[i] < b->p_specular;
        const double p = b->p_specular, u = specular ? (double)u1[i] / p : ((double)u1[i] - p) / (1 - p);
        vec3 wi = b->local.z;
        bis_bsdf_sample(b, (double)u1[i], u < 1 ? u : 1 - 0x1p-53, (double)u2[i], &wi);
        y->x[i] = wi.x;
        y->y[i] = wi.y;
        y->z[i] = wi.z;
    }
}
/* [end] */
