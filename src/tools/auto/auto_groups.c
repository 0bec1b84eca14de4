/* auto_groups: which materials are alike?
 *
 * To choose for each material alone would spread the pilot's samples over too many questions. What decides between
 * methods, proposals, M and N is mostly how narrowly a surface reflects: a diffuse one wants directions of the map and
 * little else, a mirror those of its lobe. So materials are sorted by that, and neighbours merged, those first whose
 * merging widens the groups least (Ward 1963: the sum of squares within groups grows by w1 w2/(w1 + w2) d^2, d the
 * distance of their means), until at most four are left, each with a share of the picture that a pilot can judge and
 * apart from the next by a factor of two.
 *
 * The narrowness is 1/Omega, Omega = (int p)^2 / int p^2 with p = f cos: for a lobe of constant p its solid angle. */
#include "auto_groups.h"

#include "bis/thesis/bsdf.h"
#include "bis/base/mem.h"

#include <math.h>
#include <stdlib.h>

/* A group of fewer points is too small a sample, and too small a part of the time. */
static const double least_share = 0.03;

/* Of the logarithm of the narrowness. */
static const double least_distance = 0.7;

double bis_auto_narrowness(const bis_material *m)
{
    enum { N = 256 };
    const vec3 n = {0, 0, 1}, wo = vec3_from(sqrt(0.5), 0, sqrt(0.5));
    double sum = 0, squares = 0;
    bis_bsdf b;

    bis_bsdf_init(&b, m, n, wo);
    if (bis_bsdf_is_black(&b)) return 0;
    for (int i = 0; i < N; i++) { /* Kronecker's sequence: even in three dimensions (Roberts 2018) */
        const double u0 = fmod(0.5 + i * 0.8191725133961645, 1), u1 = fmod(0.5 + i * 0.6710436067037893, 1), u2 = fmod(0.5 + i * 0.5497004779019703, 1);
        double pdf;
        vec3 wi;
        if (!bis_bsdf_sample(&b, u0, u1, u2, &wi)) continue;
        const double cosine = bis_bsdf_cos(&b, wi), p = rgb_sum(bis_bsdf_f_pdf(&b, wi, &pdf)) * cosine;
        if (!(cosine > 0 && pdf > 0)) continue;
        sum += p / pdf;
        squares += p * p / pdf;
    }
    return sum > 0 ? N * squares / (sum * sum) : 0;
}

/* ---- merging ---- */

/* A group: neighbours in the list. */
typedef struct run {
    double weight, mean;
} run;

static run run_at(const bis_auto_kind *kinds, int n, int *i)
{
    const int group = kinds[*i].group;
    run r = {0, 0};

    for (; *i < n && kinds[*i].group == group; ++*i) {
        r.weight += kinds[*i].weight;
        r.mean += kinds[*i].weight * kinds[*i].key;
    }
    r.mean /= r.weight;
    return r;
}

/* The group whose merging with the next costs least, of those that should be merged; -1: none. O(n). */
static int to_merge(const bis_auto_kind *kinds, int n, int n_groups, double total)
{
    double least = (double)INFINITY;
    int best = -1, i = 0;
    run before = run_at(kinds, n, &i);

    for (int g = 0; i < n; g++) {
        const run r = run_at(kinds, n, &i);
        const double distance = r.mean - before.mean, growth = before.weight * r.weight / (before.weight + r.weight) * distance * distance;
        const bool small = fmin(r.weight, before.weight) < least_share * total;
        if ((n_groups > BIS_AUTO_MOST_GROUPS || small || distance < least_distance) && growth < least) {
            least = growth;
            best = g;
        }
        before = r;
    }
    return best;
}

int bis_auto_merge(bis_auto_kind *kinds, int n)
{
    double total = 0;
    int n_groups = n;

    for (int i = 0; i < n; i++) {
        kinds[i].group = i;
        total += kinds[i].weight;
    }
    for (int g; (g = to_merge(kinds, n, n_groups, total)) >= 0; n_groups--)
        for (int i = 0; i < n; i++)
            if (kinds[i].group > g) kinds[i].group--;
    return n_groups;
}

/* ---- the scene's ---- */

/* Those that were met come first. */
static int by_key(const void *a, const void *b)
{
    const bis_auto_kind *x = a, *y = b;
    if ((x->weight > 0) != (y->weight > 0)) return x->weight > 0 ? -1 : 1;
    if (x->key != y->key) return x->key < y->key ? -1 : 1;
    return (x->number > y->number) - (x->number < y->number);
}

/* met: the number of the material in each pixel's centre. */
static void look(uint32_t *met, const uint32_t *number, const bis_film *f, const bis_scene *scene, const bis_scene_desc *desc)
{
    for (int y = f->y0; y < f->y0 + f->height; y++) {
        for (int x = f->x0; x < f->x0 + f->width; x++) {
            const ray eye = bis_camera_ray(&desc->camera, f->full_width, f->full_height, x + 0.5, y + 0.5);
            bis_point pt;
            const bool is_met = bis_scene_point(&pt, scene, desc, eye, NULL, NULL);
            *met++ = is_met ? number[bis_scene_material_of(desc, &pt)] : BIS_NO_NUMBER;
        }
    }
}

/* Returns how many were met. */
static int make_kinds(bis_auto_kind *kinds, uint32_t n_numbers, const uint32_t *met, size_t n_pixels, const uint32_t *number, const bis_scene_desc *desc)
{
    const double widest = 1 / (2 * PI); /* black ones may be with the widest, it does not matter */
    int n = 0;

    for (size_t k = 0; k < n_pixels; k++)
        if (met[k] != BIS_NO_NUMBER) kinds[met[k]].weight++;
    for (size_t i = 0, next = 0; i < desc->n_shapes; i++) { /* numbers come in the order of shapes */
        const uint32_t m = desc->shapes[i].material;
        if (number[m] != next) continue;
        kinds[next].number = (uint32_t)next;
        if (kinds[next].weight > 0) {
            kinds[next].key = log(fmax(bis_auto_narrowness(&desc->materials[m]), widest));
            n++;
        }
        next++;
    }
    qsort(kinds, n_numbers, sizeof *kinds, by_key);
    return n;
}

/* Shares, and the largest group. */
static int weigh_groups(double share[BIS_AUTO_MOST_GROUPS], const bis_auto_kind *kinds, int n)
{
    double total = 0;
    int largest = 0;

    for (int i = 0; i < n; i++) total += kinds[i].weight;
    for (int g = 0; g < BIS_AUTO_MOST_GROUPS; g++) share[g] = 0;
    for (int i = 0; i < n; i++) share[kinds[i].group] += kinds[i].weight / total;
    for (int g = 1; g < BIS_AUTO_MOST_GROUPS; g++)
        if (share[g] > share[largest]) largest = g;
    return largest;
}

bis_status bis_auto_group(unsigned char *group, int *n_groups, double share[BIS_AUTO_MOST_GROUPS], unsigned char **shows, const bis_film *film,
                          const bis_scene *scene, const bis_scene_desc *desc, bis_diag *diag)
{
    const size_t n_pixels = (size_t)film->width * (size_t)film->height;
    uint32_t *number, n_numbers;
    bis_status status = bis_scene_number_materials(&number, &n_numbers, desc, diag);

    *n_groups = 1;
    *shows = NULL;
    share[0] = 1;
    if (status || n_numbers < 2) {
        bis_free(number);
        return status;
    }
    bis_auto_kind *kinds = bis_alloc(n_numbers, sizeof *kinds);
    uint32_t *met = bis_alloc(n_pixels, sizeof *met);
    unsigned char *of = bis_alloc(n_numbers, sizeof *of);
    *shows = bis_alloc(n_pixels, sizeof **shows);
    if (!kinds || !met || !of || !*shows) {
        status = bis_error(diag, BIS_NOMEM, desc->integrator_loc, "no memory to compare %u materials for integrator \"auto\"; a fixed integrator needs none",
                           (unsigned)n_numbers);
        goto done;
    }
    look(met, number, film, scene, desc);
    const int n = make_kinds(kinds, n_numbers, met, n_pixels, number, desc);
    if (n < 2) goto done;
    *n_groups = bis_auto_merge(kinds, n);
    const int largest = weigh_groups(share, kinds, n);
    for (uint32_t i = 0; i < n_numbers; i++) of[kinds[i].number] = (unsigned char)(i < (uint32_t)n ? kinds[i].group : largest);
    for (size_t i = 0; i < desc->n_materials; i++) group[i] = (unsigned char)(number[i] == BIS_NO_NUMBER ? largest : of[number[i]]);
    for (size_t k = 0; k < n_pixels; k++) (*shows)[k] = (unsigned char)(met[k] == BIS_NO_NUMBER ? largest : of[met[k]]);
done:
    if (*n_groups == 1) {
        bis_free(*shows);
        *shows = NULL;
    }
    bis_free(number);
    bis_free(kinds);
    bis_free(met);
    bis_free(of);
    return status;
}
