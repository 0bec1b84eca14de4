/* SPDX-License-Identifier: BSD-2-Clause */
/* phong: the energy-preserving Phong model. Source: thesis 3.5.
 *
 * The model is a specular lobe about the mirror direction R and a diffuse term (eq. 3.14). Its product with the
 * cosine (eq. 3.17) cannot be sampled analytically. A direction is therefore drawn from one of two densities that
 * can: that of the lobe (eq. 3.15, drawn by eq. 3.16), or the cosine about the normal. One of the two is chosen at
 * random by Ks : Kd. The density of the direction is that of the mixture, whichever lobe it came from (docs/errata.md
 * E35):
 *
 *     q_mix(wi) = p_s (n+1)/(2 pi) max(0, cos alpha)^n + p_d max(0, cos theta)/pi,     p_s + p_d = 1.
 *
 * Neither lobe reflects all light that arrives, as eq. 3.13 would have it (E33). Part of the specular lobe may lie
 * below the horizon. Its directions there are returned, have f = 0 and count, because the mean would otherwise be too
 * high (E34: +64 % at 85 degrees, n = 10).
 *
 * Precision for n from 0 to 1e8 (E36): cos alpha itself is never used, because it is next to 1 where n is large.
 * 1 - cos alpha = |R - wi|^2 / 2 has no cancellation. Unit vectors in float limit the relative error of the power to
 * about 1e-7 (1 + sqrt(n)).
 *
 * The formulas stand in phong_formulas.h; phong_many.c has the loops over many directions. Cost: one logarithm and one
 * exponential for f and the density together; none if Ks = 0. */
#include "bis/thesis/phong.h"

#include "thesis/real_double.h"

#include "thesis/phong_formulas.h"

#include "thesis/model_one.h"

double bis_phong_power(vec3 a, vec3 b, double n)
{
    return power(a, n, (direction){(double)b.x, (double)b.y, (double)b.z});
}

/* Eq. 3.15. */
double bis_phong_lobe_pdf(vec3 axis, vec3 wi, double n)
{
    return (n + 1) * (INV_PI / 2) * bis_phong_power(axis, wi, n);
}

void bis_phong_lobe_sample(vec3 *wi, double *pdf, double n, double u1, double u2)
{
    const direction w = lobe(1 / (n + 1), u1, u2);

    *wi = vec3_from(w.x, w.y, w.z);
    *pdf = (n + 1) * (INV_PI / 2) * exp(n * log1p(-u1) / (n + 1)); /* eq. 3.15 */
}

/* Sets the lobe's axis R and the probability of the specular lobe: Ks / (Ks + Kd), means over RGB (E35). Any positive
 * probabilities would be unbiased, but 0 for a lobe that reflects would not. p_s therefore stays below 1, by the
 * smallest step, if Kd is not black. */
static void init(bis_bsdf *b)
{
    const bis_material *m = b->material;
    vec3 n = b->local.z;
    double Ks = rgb_sum(m->Ks), Kd = rgb_sum(m->Kd);

    b->r = normalize(sub(mul(n, 2 * dot(n, b->wo)), b->wo));
    b->lobe = frame_about(b->r);
    b->p_specular = Ks > 0 ? Ks / (Ks + Kd) : 0;
    if (b->p_specular == 1 && Kd > 0) b->p_specular = 1 - 0x1p-53;
}

/* The slack of rejection's bounds (E27). Both bounds are products of two cosines, or of a cosine and f. Float vectors
 * are unit only to 2^-23, so a cosine may reach (1 + 2^-23)^2. 2^-21 contains this and the rounding of f to float. */
static const double unit_slack = 1 + 0x1p-21;

/* Returns max f cos <= Ks (n+1)/(2 pi) + Kd/pi: each factor at its own maximum. */
static double max_f_cos(const bis_bsdf *b)
{
    const bis_material *m = b->material;
    double lobe = (m->exponent + 1) * (INV_PI / 2);
    rgb bound =
        rgb_from((double)m->Ks.r * lobe + (double)m->Kd.r * INV_PI, (double)m->Ks.g * lobe + (double)m->Kd.g * INV_PI,
                 (double)m->Ks.b * lobe + (double)m->Kd.b * INV_PI);

    return rgb_max(bound) * unit_slack;
}

/* Returns a bound of max f cos / q_mix: a ratio of sums is at most the largest ratio of their terms, Ks cos/p_s and
 * Kd/p_d. */
static double max_ratio(const bis_bsdf *b)
{
    const bis_material *m = b->material;
    double specular = b->p_specular > 0 ? rgb_max(m->Ks) / b->p_specular : 0;
    double diffuse = b->p_specular < 1 ? rgb_max(m->Kd) / (1 - b->p_specular) : 0;

    return fmax(specular, diffuse) * unit_slack;
}

static bis_bsdf_width width(const bis_material *m)
{
    return (bis_bsdf_width){"exponent", "exponent", m->exponent, m->exponent, 0, (double)INFINITY};
}

static bis_material remake(const bis_material *m, rgb Kd, rgb Ks, const double *exponent)
{
    return bis_phong(Kd, Ks, exponent ? *exponent : m->exponent);
}

const bis_bsdf_model bis_phong_model = {.name = "phong", .init = init, .sample = sample, .f_pdf = f_pdf,
    .max_f_cos = max_f_cos, .max_ratio = max_ratio, .of_half_vector = false,
    .usual = {{0.5f, 0.5f, 0.5f}, {0, 0, 0}, 50}, .remake = remake,
    .gains_beyond_1 = true, .width = width, .many = &bis_phong_many};

/* Returns k with 0 for each channel below 2^-67. A direction that was drawn has an f of at least Ks 2^-53/(2 pi) by
 * eq. 3.16. With a smaller Ks this could be a denormal float, whose rounding could exceed the bounds above. */
static rgb visible(rgb k)
{
    const float least = 0x1p-67f;

    return (rgb){k.r < least ? 0 : k.r, k.g < least ? 0 : k.g, k.b < least ? 0 : k.b};
}

bis_material bis_phong(rgb Kd, rgb Ks, double exponent)
{
    return (bis_material){.model = &bis_phong_model, .Kd = visible(Kd), .Ks = visible(Ks), .exponent = exponent};
}
