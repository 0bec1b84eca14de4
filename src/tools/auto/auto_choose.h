/* auto_choose: of the settings that were measured for each group of materials, those that together are best. For
 * src/tools/auto/auto.c. */
#ifndef BIS_AUTO_CHOOSE_H
#define BIS_AUTO_CHOOSE_H

enum { BIS_AUTO_MOST_CHOSEN = 4 }; /* groups */

/* One setting for one group. Equal ids are equal settings. */
typedef struct bis_auto_offer {
    int id;
    double fill;           /* of a pass, once for all groups that have this setting */
    double cost, variance; /* that the group's points add to a pass */
} bis_auto_offer;

/* chosen[n_groups]: one of offers[g][n[g]], n[g] >= 1, for each, such that (base + costs + fills) x variances is least,
 * each setting beyond the first counting as `dearer` (>= 1) times as long. Without any variance: the cheapest. Returns
 * that product. */
double bis_auto_combine(int *chosen, const bis_auto_offer *const *offers, const int *n, int n_groups, double base, double dearer);

#endif
