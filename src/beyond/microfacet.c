/* SPDX-License-Identifier: BSD-2-Clause */
/* microfacet: GGX, of which only the facets that the eye sees are drawn.
 *
 * Facets with normal h about n: D(h) = a^2 / (pi cos^4 (a^2 + tan^2)^2), a = alpha. Of these the eye sees
 * D_v(h) = G1 max(0, wo h) D(h) / cos theta_o, a density over h (Heitz 2014). Seen from wo, GGX is the picture of a
 * uniform unit sphere squeezed by a along n: stretch wo, draw a point c uniform on the cap of directions that the
 * sphere mirrors into the hemisphere, h = c + wo, squeeze back (Heitz 2018; Dupuy and Benyoub 2023). Mirroring wo about
 * h divides the density by 4 wo h. What is left is free of differences and of quotients that grow at grazing angles:
 *
 *     s = wi + wo,   c = cos theta,   S(c) = sqrt(a^2 + (1 - a^2) c^2)         Smith's Lambda = (S/c - 1)/2
 *     D = |s|^4 a^2 / (pi (a^2 s_z^2 + s_x^2 + s_y^2)^2),                      cos theta_d = |s|/2
 *     q = D / (2 (c_o + S_o)),   f = F D / (2 (c_i S_o + c_o S_i)).
 *
 * So f c_i/q = F G2/G1 <= F: candidates from the lobe have nearly equal weights. G2 counts light that bounces once and
 * is not shadowed; what facets throw at each other is lost: a white surface keeps 99.99 % head on at roughness 0.1,
 * 31 % at roughness 1 (table in docs/scene-format.md).
 * A mirror direction may fall below the horizon: it is returned, has f = 0 and counts (docs/errata.md E34).
 *
 * Plastic is pbrt's: Fresnel's equations of a dielectric in the place of Schlick's curve, times Ks over what they give
 * head on, and Lambert's base, whole.
 *
 * The formulas stand in microfacet_formulas.h; microfacet_many.c has the loops over many directions. Directions in
 * float blur a lobe whose width across, a c_o, comes near 6e-8; f c_i/q does not feel it. Cost: three square roots,
 * three quotients for f and q: 0.7 ns a direction with AVX-512. */
#include "bis/beyond/microfacet.h"

#include <assert.h>

#include "thesis/real_double.h"

#include "beyond/microfacet_formulas.h"

#include "thesis/model_one.h"

/* ---- the mixture ---- */

/* F at a cosine, in each channel. */
static rgbd fresnel_at(const bis_material *m, double c)
{
    const bool plastic = is_plastic(m);
    const coat r = coat_of(plastic, m->Ks.r, m->eta.r), g = coat_of(plastic, m->Ks.g, m->eta.g),
               b = coat_of(plastic, m->Ks.b, m->eta.b);
    const double x5 = fifth_power(1 - c);

    return (rgbd){fresnel(&r, c, c * c, x5, FRESNEL), fresnel(&g, c, c * c, x5, FRESNEL),
                  fresnel(&b, c, c * c, x5, FRESNEL)};
}

/* The base's reflectance times A(c), in each channel. */
static rgbd base_at(const bis_material *m, double c)
{
    const bool plastic = is_plastic(m);
    const double A = through_coat(c, plastic ? PLASTIC : BASE);

    return (rgbd){(double)m->Kd.r * share_of_base(plastic, m->Ks.r) * A,
                  (double)m->Kd.g * share_of_base(plastic, m->Ks.g) * A,
                  (double)m->Kd.b * share_of_base(plastic, m->Ks.b) * A};
}

/* A lobe's probability is its share of what is reflected: Fresnel's at the view, the base's albedo; means over RGB.
 * Below 1 while there is a base. */
static void init(bis_bsdf *b)
{
    const bis_material *m = b->material;
    const vec3 n = b->local.z;
    const double c_o = fmax(0, dot(n, b->wo)); /* below the horizon all is black, and this stays finite */
    const double specular = rgbd_sum(fresnel_at(m, c_o)), diffuse = rgbd_sum(base_at(m, c_o));

    b->r = normalize(sub(mul(n, 2 * dot(n, b->wo)), b->wo));
    b->lobe = frame_about(b->r);
    b->p_specular = specular > 0 ? specular / (specular + diffuse) : 0;
    if (b->p_specular == 1 && !rgb_is_black(m->Kd)) b->p_specular = 1 - 0x1p-53;
}

/* ---- the bounds of rejection (docs/errata.md E27) ---- */

/* As Phong's: vectors unit to 2^-23 only, and the rounding of f to float. */
static const double unit_slack = 1 + 0x1p-21;

/* Schlick's F is largest where wi and wo are farthest apart: wi at the horizon, opposite. There 2 cos^2 theta_d = 1 +
 * cos(theta_o + 90 degrees) = 1 - sin theta_o. Vectors that are unit to 2^-23 move |s|/2 by as much. A metal's F has
 * one minimum and no maximum but at the ends: it is largest there, or head on. */
static rgbd most_fresnel(const bis_bsdf *b)
{
    const double c_o = bis_bsdf_cos(b, b->wo), sin_o = sqrt(fmax(0, 1 - c_o * c_o));
    const double least_cos_d = c_o / sqrt(2 * (1 + sin_o));

    const rgbd F = fresnel_at(b->material, fmax(0, least_cos_d - 0x1p-23));
    const rgb Ks = b->material->Ks;

    return (rgbd){fmax(F.r, (double)Ks.r), fmax(F.g, (double)Ks.g), fmax(F.b, (double)Ks.b)};
}

/* A(c_i) <= A(1). */
static rgbd most_base(const bis_bsdf *b)
{
    const int kind = is_plastic(b->material) ? PLASTIC : BASE;

    return rgbd_scale(base_at(b->material, fmax(0, bis_bsdf_cos(b, b->wo))), base_norm * through_coat(1, kind));
}

static double rgbd_max(rgbd a)
{
    return fmax(a.r, fmax(a.g, a.b));
}

/* S_i >= c_i, so f c_i <= F D / (2 (S_o + c_o)) with D <= 1/(pi a^2); the base: cos <= 1. Each term at its own
 * maximum. */
static double max_f_cos(const bis_bsdf *b)
{
    const double a2 = b->material->alpha * b->material->alpha, c_o = fmax(0, bis_bsdf_cos(b, b->wo));
    const double specular = INV_PI / a2 / (2 * (c_o + stretched(a2, 1 - a2, c_o)));
    const rgbd F = most_fresnel(b), base = most_base(b);

    return rgbd_max(rgbd_add(rgbd_scale(F, specular), rgbd_scale(base, INV_PI))) * unit_slack;
}

/* [facet-bound] */
/* A ratio of sums is at most the largest ratio of their terms: F G2/G1 / p_s with G2 <= G1, and the base's f cos over
 * p_d cos/pi. */
static double max_ratio(const bis_bsdf *b)
{
    const double p = b->p_specular;
    const double specular = p > 0 ? rgbd_max(most_fresnel(b)) / p : 0;
    const double diffuse = p < 1 ? rgbd_max(most_base(b)) / (1 - p) : 0;

    return fmax(specular, diffuse) * unit_slack;
}
/* [end] */

static bis_bsdf_width width(const bis_material *m)
{
    return (bis_bsdf_width){"alpha", "roughness", m->alpha, sqrt(m->alpha), BIS_MICROFACET_MIN_ROUGHNESS, 1};
}

/* The model and the index stay, so that this serves metals and plastic, too. */
static bis_material remake(const bis_material *m, rgb Kd, rgb Ks, const double *roughness)
{
    bis_material other = bis_microfacet(Kd, Ks, roughness ? *roughness : 1);

    if (!roughness) other.alpha = m->alpha;
    other.model = m->model;
    other.eta = m->eta;
    return other;
}

/* The functions of both are the same: those that compute F ask which model they serve. */
#define FACETS(called, loops) \
    {.name = called, .init = init, .sample = sample, .f_pdf = f_pdf, .max_f_cos = max_f_cos, .max_ratio = max_ratio, \
     .usual = {{0, 0, 0}, {0.9f, 0.9f, 0.9f}, 0.5}, .remake = remake, .of_half_vector = true, .width = width, \
     .many = &loops}

const bis_bsdf_model bis_microfacet_model = FACETS("microfacet", bis_microfacet_many),
                     bis_plastic_model = FACETS("plastic", bis_plastic_many);

/* As Phong's: what reflects less than 2^-67 is black. */
static bool is_visible(double k)
{
    return k >= 0x1p-67;
}

static float visible_base(float Kd, float Ks)
{
    return is_visible((double)Kd * (1 - (double)Ks)) ? Kd : 0;
}

bis_material bis_microfacet(rgb Kd, rgb Ks, double roughness)
{
    const rgb lobe = {is_visible((double)Ks.r) ? Ks.r : 0, is_visible((double)Ks.g) ? Ks.g : 0,
                      is_visible((double)Ks.b) ? Ks.b : 0};
    const rgb diffuse = {visible_base(Kd.r, lobe.r), visible_base(Kd.g, lobe.g), visible_base(Kd.b, lobe.b)};

    assert(roughness >= BIS_MICROFACET_MIN_ROUGHNESS && roughness <= 1);
    return (bis_material){.model = &bis_microfacet_model, .Kd = diffuse, .Ks = lobe, .alpha = roughness * roughness};
}

bis_material bis_microfacet_metal(rgb Ks, rgb eta, double roughness)
{
    bis_material m = bis_microfacet((rgb){0, 0, 0}, Ks, roughness);

    m.eta = eta;
    return m;
}

bis_material bis_plastic(rgb Kd, rgb Ks, double eta, double roughness)
{
    bis_material m = bis_microfacet(Kd, Ks, roughness);

    m.model = &bis_plastic_model;
    m.eta = rgb_from(eta, eta, eta);
    return m;
}
