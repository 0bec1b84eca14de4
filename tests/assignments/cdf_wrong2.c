/* "Pre-inverting C" (E10): what the guide says, without a search. The plain sum. */
/* [cdf-sum] */
static double accumulate(double *c, const double *f, size_t n, weight_scale s)
{
    c[0] = 0;
    for (size_t i = 0; i < n; i++)
        c[i + 1] = c[i] + weight_scaled(s, f[i]);
    return c[n];
}
/* [end] */
/* [cdf-search] */
size_t bis_cdf_sample(const bis_cdf *c, double u, double *remainder)
{
    size_t i = c->guide[(size_t)(u * (double)c->n_guide)];
    if (remainder) *remainder = fmin((u - c->c[i]) / (c->c[i + 1] - c->c[i]), 1 - DBL_EPSILON / 2);
    return i;
}
/* [end] */
