/* auto_choose: one setting for each group of materials.
 *
 * What a render takes to reach an error is in proportion to the cost of a pass times its variance. Both are sums over
 * the groups, for each point is shaded once and each pixel shows (nearly) one group:
 *
 *     P = (C0 + sum_g C_g(s_g)) (sum_g V_g(s_g)),     s_g the setting of group g.
 *
 * So no group can be optimised by itself: where others make most of the noise, time is better spent there, and a group
 * that costs little may cost more. What holds at the least P is that every group minimises C_g + lambda V_g, with one
 * lambda = C/V for all (C, V the two sums): were C_g + lambda V_g smaller by e > 0 with another setting, C + lambda V
 * would fall from 2C by e, and C V with it, since by the means' inequality lambda C V <= (C + lambda V)^2/4, with
 * equality now. A second more then saves the same variance in every group.
 *
 * A scan over lambda would find it, but for the fills: pools and clusters of a setting are made once for all groups that
 * have it, a cost that is no sum over groups. There are at most four groups with some fifteen settings: all 50,000
 * combinations are tried, in some milliseconds. tests/tools/test_auto.c compares with the scan over lambda where
 * nothing is shared. */
#include "auto_choose.h"

#include <assert.h>
#include <math.h>
#include <stdbool.h>

/* Whether nobody before group g has what it has. */
static bool is_new(const int *now, const bis_auto_offer *const *offers, int g)
{
    for (int h = 0; h < g; h++)
        if (offers[h][now[h]].id == offers[g][now[g]].id) return false;
    return true;
}

static double product(double *cost, const int *now, const bis_auto_offer *const *offers, int n_groups, double base, double dearer)
{
    double variance = 0, factor = 1;

    *cost = base;
    for (int g = 0; g < n_groups; g++) {
        const bis_auto_offer *o = &offers[g][now[g]];
        *cost += o->cost;
        variance += o->variance;
        if (!is_new(now, offers, g)) continue;
        *cost += o->fill;
        if (g > 0) factor *= dearer;
    }
    return *cost * variance * factor;
}

double bis_auto_combine(int *chosen, const bis_auto_offer *const *offers, const int *n, int n_groups, double base, double dearer)
{
    int now[BIS_AUTO_MOST_CHOSEN] = {0}, g = 0;
    double least = (double)INFINITY, cheapest = (double)INFINITY;

    assert(n_groups >= 1 && n_groups <= BIS_AUTO_MOST_CHOSEN);
    while (g < n_groups) {
        double cost;
        const double p = product(&cost, now, offers, n_groups, base, dearer);
        if (p < least || (p == least && cost < cheapest)) {
            least = p;
            cheapest = cost;
            for (int i = 0; i < n_groups; i++) chosen[i] = now[i];
        }
        for (g = 0; g < n_groups && ++now[g] == n[g]; g++) now[g] = 0; /* count on, the first group fastest */
    }
    return least;
}
