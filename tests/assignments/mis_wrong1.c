/* The counts are forgotten in the weight: these still sum to 1, so the mean is right, and the noise is not. */
/* [mis-weight] */
static double weight(bis_heuristic heuristic, double own, double other)
{
    (void)heuristic, (void)other;
    return own > 0 ? 0.5 : 0;
}
/* [end] */
