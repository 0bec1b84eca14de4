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
 * Precision: s is the exact sum of the two float vectors, all else double. Directions in float blur a lobe whose width
 * across, a c_o, comes near 6e-8; f c_i/q does not feel it. Cost: two square roots, three quotients for f and q. */
#include "bis/beyond/microfacet.h"

#include "bis/base/fresnel.h"
#include "bis/thesis/warp.h"

#include <assert.h>

/* Floats are good to this: a direction nearer to the horizon counts as on it, and reflects nothing. So f stays below
 * 1/(2 pi a^3 2^-24) = 3e18 and, where it is not 0, is no denormal float: rounding cannot carry it above the bounds
 * below. */
static const double least_cos = 0x1p-24;

/* ---- the parts ---- */

static double fifth_power(double x)
{
    const double x2 = x * x;

    return x2 * x2 * x;
}

static double fresnel(bool is_plastic, double Ks, double eta, double cos_d)
{
    const double head_on = is_plastic ? bis_fresnel(eta, 0, 1) : 0;

    if (head_on > 0) return Ks / head_on * bis_fresnel(eta, 0, cos_d);
    if (is_plastic) return 0; /* of an index of 1 */
    if (eta > 0 && Ks > 0 && Ks < 1) return bis_fresnel(eta, bis_fresnel_k2(Ks, eta), cos_d);
    return Ks > 0 ? Ks + (1 - Ks) * fifth_power(1 - cos_d) : 0;
}

/* A(c) = 1 - (1 - x)^5 of x = c/2, multiplied out: no difference near 0. In plastic the same for all c: its base is
 * Lambert's, base_norm A A = 1. */
static double through_coat(const bis_material *m, double c)
{
    const double x = c / 2;

    if (m->model == &bis_plastic_model) return BIS_PLASTIC_A;
    return x * (5 + x * (-10 + x * (10 + x * (-5 + x))));
}

static double stretched(double a, double c)
{
    return sqrt(a * a + (1 - a * a) * c * c);
}

/* In each channel, F times `specular` and Kd (1 - Ks) times `diffuse`, in plastic Kd times `diffuse`. */
static rgbd blend(const bis_material *m, double cos_d, double specular, double diffuse)
{
    const rgb Kd = m->Kd, Ks = m->Ks;
    const bool is_plastic = m->model == &bis_plastic_model;
    const double F[3] = {fresnel(is_plastic, (double)Ks.r, (double)m->eta.r, cos_d),
                         fresnel(is_plastic, (double)Ks.g, (double)m->eta.g, cos_d),
                         fresnel(is_plastic, (double)Ks.b, (double)m->eta.b, cos_d)};
    const double taken = is_plastic ? 0 : 1;

    return (rgbd){F[0] * specular + (double)Kd.r * (1 - taken * (double)Ks.r) * diffuse,
                  F[1] * specular + (double)Kd.g * (1 - taken * (double)Ks.g) * diffuse,
                  F[2] * specular + (double)Kd.b * (1 - taken * (double)Ks.b) * diffuse};
}

/* What makes the mean of A cos over the hemisphere 1. */
static const double base_norm = 28 / 23.0;

/* D of the facet that mirrors wi to wo, and the cosine between it and them. False: that facet would lie face down. */
static bool facet_between(const bis_bsdf *b, vec3 wi, double s_z, double *D, double *cos_d)
{
    const double x = (double)wi.x + (double)b->wo.x, y = (double)wi.y + (double)b->wo.y,
                 z = (double)wi.z + (double)b->wo.z;
    const frame *f = &b->local;
    const double s_x = x * (double)f->x.x + y * (double)f->x.y + z * (double)f->x.z;
    const double s_y = x * (double)f->y.x + y * (double)f->y.y + z * (double)f->y.z;
    const double a = b->material->alpha, across = s_x * s_x + s_y * s_y, along = s_z * s_z;

    if (s_z <= 0) return false;
    const double ratio = (across + along) / (a * a * along + across);
    *D = INV_PI * a * a * ratio * ratio;
    *cos_d = sqrt(across + along) / 2;
    return true;
}

/* ---- the mixture ---- */

/* A lobe's probability is its share of what is reflected: Fresnel's at the view, the base's albedo; means over RGB.
 * Below 1 while there is a base. */
static void init(bis_bsdf *b)
{
    const bis_material *m = b->material;
    const vec3 n = b->local.z;
    const double c_o = fmax(0, dot(n, b->wo)); /* below the horizon all is black, and this stays finite */
    const double specular = rgbd_sum(blend(m, c_o, 1, 0)), diffuse = rgbd_sum(blend(m, c_o, 0, through_coat(m, c_o)));

    b->r = normalize(sub(mul(n, 2 * dot(n, b->wo)), b->wo));
    b->lobe = frame_about(b->r);
    b->p_specular = specular > 0 ? specular / (specular + diffuse) : 0;
    if (b->p_specular == 1 && !rgb_is_black(m->Kd)) b->p_specular = 1 - 0x1p-53;
}

/* [facet-density] */
static rgb f_pdf(const bis_bsdf *b, vec3 wi, double *pdf)
{
    const double a = b->material->alpha, c_i = bis_bsdf_cos(b, wi), c_o = bis_bsdf_cos(b, b->wo);
    double D = 0, cos_d = 0;

    *pdf = 0;
    if (c_o <= 0) return (rgb){0, 0, 0};
    const double S_o = stretched(a, c_o);
    if (b->p_specular > 0 && facet_between(b, wi, c_i + c_o, &D, &cos_d)) *pdf = b->p_specular * D / (2 * (c_o + S_o));
    *pdf += (1 - b->p_specular) * bis_warp_cosine_pdf(c_i);
    if (c_i < least_cos || c_o < least_cos) return (rgb){0, 0, 0};
    const double specular = D / (2 * (c_i * S_o + c_o * stretched(a, c_i)));
    const double base = base_norm * INV_PI * through_coat(b->material, c_i) * through_coat(b->material, c_o);
    return rgbd_round(blend(b->material, cos_d, specular, base));
}
/* [end] */

/* [facet-visible] */
/* A visible facet, not of unit length, in the frame of the normal. v = wo stretched; c = (sin cos phi, sin sin phi, z),
 * z uniform between -v_z and 1. With t = 1 + v_z, 1 - z = u1 t and 1 + z = 2 (1 - u1) + u1 (1 - v_z): no difference of
 * equals, h_z > 0 for every u1 < 1. */
static void visible_facet(double h[3], double a, const double wo[3], double u1, double u2)
{
    const double scale = 1 / sqrt(a * a * (wo[0] * wo[0] + wo[1] * wo[1]) + wo[2] * wo[2]);
    const double v[3] = {a * wo[0] * scale, a * wo[1] * scale, wo[2] * scale}, t = 1 + v[2];
    const double one_minus_v = (v[0] * v[0] + v[1] * v[1]) / t;
    const double sin_theta = sqrt(u1 * t * (2 * (1 - u1) + u1 * one_minus_v)), phi = 2 * PI * u2;

    h[0] = a * (sin_theta * cos(phi) + v[0]);
    h[1] = a * (sin_theta * sin(phi) + v[1]);
    h[2] = (1 - u1) * t;
}

/* wo mirrored about h: 2 (wo h) h / |h|^2 - wo, of wo's length whatever that of h and of the frame's axes. */
static vec3 mirrored(const frame *f, vec3 wo, const double h[3])
{
    const double x = h[0] * (double)f->x.x + h[1] * (double)f->y.x + h[2] * (double)f->z.x;
    const double y = h[0] * (double)f->x.y + h[1] * (double)f->y.y + h[2] * (double)f->z.y;
    const double z = h[0] * (double)f->x.z + h[1] * (double)f->y.z + h[2] * (double)f->z.z;
    const double k = 2 * (x * (double)wo.x + y * (double)wo.y + z * (double)wo.z) / (x * x + y * y + z * z);

    return vec3_from(k * x - (double)wo.x, k * y - (double)wo.y, k * z - (double)wo.z);
}
/* [end] */

/* [facet-sample] */
static bool sample(const bis_bsdf *b, double u0, double u1, double u2, vec3 *wi)
{
    const frame *n = &b->local;
    double h[3];

    if (bis_bsdf_is_black(b)) return false;
    if (u0 >= b->p_specular) {
        *wi = to_world(n, bis_warp_cosine(u1, u2));
        return true;
    }
    visible_facet(h, b->material->alpha, (double[]){dot(b->wo, n->x), dot(b->wo, n->y), dot(b->wo, n->z)}, u1, u2);
    *wi = mirrored(n, b->wo, h);
    return true;
}
/* [end] */

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

    const rgbd F = blend(b->material, fmax(0, least_cos_d - 0x1p-23), 1, 0);
    const rgb Ks = b->material->Ks;

    return (rgbd){fmax(F.r, (double)Ks.r), fmax(F.g, (double)Ks.g), fmax(F.b, (double)Ks.b)};
}

/* S_i >= c_i, so f c_i <= F D / (2 (S_o + c_o)) with D <= 1/(pi a^2); the base: A <= A(1), cos <= 1. Each term at its
 * own maximum. */
static double max_f_cos(const bis_bsdf *b)
{
    const bis_material *m = b->material;
    const double a = m->alpha, c_o = fmax(0, bis_bsdf_cos(b, b->wo));
    const double specular = INV_PI / (a * a) / (2 * (c_o + stretched(a, c_o)));
    const rgbd F = most_fresnel(b),
               Kd = blend(m, 1, 0, base_norm * INV_PI * through_coat(m, c_o) * through_coat(m, 1));

    return fmax(F.r * specular + Kd.r, fmax(F.g * specular + Kd.g, F.b * specular + Kd.b)) * unit_slack;
}

/* A ratio of sums is at most the largest ratio of their terms: F G2/G1 / p_s with G2 <= G1, and the base's f cos over
 * p_d cos/pi. */
/* [facet-bound] */
static double max_ratio(const bis_bsdf *b)
{
    const double A = through_coat(b->material, fmax(0, bis_bsdf_cos(b, b->wo))) * through_coat(b->material, 1);
    const rgbd F = most_fresnel(b), Kd = blend(b->material, 1, 0, base_norm * A);
    const double specular = b->p_specular > 0 ? fmax(F.r, fmax(F.g, F.b)) / b->p_specular : 0;
    const double diffuse = b->p_specular < 1 ? fmax(Kd.r, fmax(Kd.g, Kd.b)) / (1 - b->p_specular) : 0;

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

const bis_bsdf_model bis_microfacet_model = {.name = "microfacet",
                                             .init = init,
                                             .sample = sample,
                                             .f_pdf = f_pdf,
                                             .max_f_cos = max_f_cos,
                                             .max_ratio = max_ratio,
                                             .remake = remake,
                                             .of_half_vector = true,
                                             .width = width};

const bis_bsdf_model bis_plastic_model = {.name = "plastic",
                                          .init = init,
                                          .sample = sample,
                                          .f_pdf = f_pdf,
                                          .max_f_cos = max_f_cos,
                                          .max_ratio = max_ratio,
                                          .remake = remake,
                                          .of_half_vector = true,
                                          .width = width};

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
