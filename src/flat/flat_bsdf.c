/* SPDX-License-Identifier: BSD-2-Clause */
/* flat_bsdf: materials at a point (thesis 3.5). */
#include "bis/base/fresnel.h"
#include "bis/base/mem.h"
#include "bis/beyond/microfacet.h"
#include "bis/thesis/phong.h"
#include "bis/thesis/warp.h"
#include "flat/face.h"

#include <float.h>
#include <string.h>

/* ---- opening ---- */

/* The material lives beside the bsdf, which points to it. */
typedef struct owned {
    bis_bsdf bsdf; /* first, so that its address is that of the block */
    bis_material material;
} owned;

static bis_status check_colour(const char *name, const double *c, bis_diag *diag)
{
    for (int i = 0; i < 3; i++) {
        if (c[i] >= 0 && c[i] <= 1) continue;
        return bis_flat_refuse(diag, "%s is (%g, %g, %g): give numbers in [0, 1]", name, c[0], c[1], c[2]);
    }
    return BIS_OK;
}

/* A material, whose values are known to be right, at a point. */
static bis_status place(bis_bsdf **bsdf, bis_material material, const double *normal, const double *wo,
                        bis_diag *diag)
{
    vec3 n, out;
    bis_status status = bis_flat_unit(&n, "normal", normal, diag);

    if (!status) status = bis_flat_unit(&out, "wo", wo, diag);
    if (status) return status;
    owned *o = bis_alloc(1, sizeof *o);
    if (!o) return bis_error(diag, BIS_NOMEM, nowhere, "no memory for a material");
    o->material = material;
    bis_bsdf_init(&o->bsdf, &o->material, n, out);
    *bsdf = &o->bsdf;
    return BIS_OK;
}

static bis_status check_roughness(double roughness, bis_diag *diag)
{
    if (roughness >= BIS_MICROFACET_MIN_ROUGHNESS && roughness <= 1) return BIS_OK;
    return bis_flat_refuse(diag, "the roughness is %g: give a number in [%g, 1]", roughness,
                           BIS_MICROFACET_MIN_ROUGHNESS);
}

static rgb colour(const double *c) { return rgb_from(c[0], c[1], c[2]); }

bis_status bis_do_bsdf_open(bis_bsdf **bsdf, const char *model, const double *Kd, const double *Ks, double width,
                            const double *normal, const double *wo, bis_diag *diag)
{
    const bool is_phong = strcmp(model, "phong") == 0;

    if (!is_phong && strcmp(model, "microfacet") != 0)
        return bis_flat_refuse(diag, "there is no model \"%.40s\": give \"phong\" or \"microfacet\"", model);
    if (is_phong && !(width >= 0 && width <= (double)FLT_MAX)) /* above, f is beyond a float */
        return bis_flat_refuse(diag, "the exponent is %g: give a number in [0, 3.4e38]", width);
    bis_status status = is_phong ? BIS_OK : check_roughness(width, diag);
    if (!status) status = check_colour("Kd", Kd, diag);
    if (!status) status = check_colour("Ks", Ks, diag);
    if (status) return status;
    return place(bsdf, is_phong ? bis_phong(colour(Kd), colour(Ks), width)
                                : bis_microfacet(colour(Kd), colour(Ks), width), normal, wo, diag);
}

bis_status bis_do_bsdf_metal(bis_bsdf **bsdf, const double *eta, const double *k, double roughness,
                             const double *normal, const double *wo, bis_diag *diag)
{
    const double most = 1e15; /* bis_fresnel wants squares below 1e30 */
    double Ks[3];
    const bis_status status = check_roughness(roughness, diag);

    for (int i = 0; !status && i < 3; i++) {
        if (!(eta[i] > 0 && eta[i] <= most && k[i] >= 0 && k[i] <= most))
            return bis_flat_refuse(diag, "eta and k of channel %d are %g and %g: give eta in (0, %g] and k in [0, %g]",
                                   i, eta[i], k[i], most, most);
        Ks[i] = bis_fresnel(eta[i], k[i] * k[i], 1);
    }
    return status ? status : place(bsdf, bis_microfacet_metal(colour(Ks), colour(eta), roughness), normal, wo, diag);
}

bis_status bis_do_bsdf_read(bis_bsdf **bsdf, const char *text, const double *normal, const double *wo, bis_diag *diag)
{
    static const char world[] = "WorldBegin\nLightSource \"infinite\"\n", shape[] = "\nShape \"sphere\"\n";
    const size_t room = strlen(text) + sizeof world + sizeof shape;
    bis_scene_desc *d = NULL;
    char *scene = bis_alloc(room, 1);

    if (!scene) return bis_error(diag, BIS_NOMEM, nowhere, "no memory for a material");
    snprintf(scene, room, "%s%s%s", world, text, shape);
    bis_status status = bis_scene_parse_text(&d, "material", scene, 0, diag);
    bis_free(scene);
    const uint32_t at = status ? 0 : d->shapes[d->n_shapes - 1].material;
    if (!status && bis_textures_of(&d->textures, at))
        status = bis_flat_refuse(diag, "the material has a texture: give it values");
    if (!status) status = place(bsdf, d->materials[at], normal, wo, diag);
    bis_scene_desc_free(d);
    return status;
}

void bis_flat_bsdf_close(bis_bsdf *bsdf) { bis_free(bsdf); }

/* ---- directions ---- */

bis_status bis_do_bsdf_sample(const bis_bsdf *bsdf, size_t n, const double *u, float *wi, uint8_t *lobe, bis_diag *diag)
{
    const bis_status status = bis_flat_numbers(n, 3, u, diag);

    if (!status && bis_bsdf_is_black(bsdf))
        return bis_flat_refuse(diag, "the material is black as seen from wo: it has no directions to draw");
    for (size_t i = 0; !status && i < n; i++) {
        vec3 w;
        bis_bsdf_sample(bsdf, u[3 * i], u[3 * i + 1], u[3 * i + 2], &w); /* only a black material returns false */
        memcpy(wi + 3 * i, &w, 3 * sizeof *wi);
        lobe[i] = u[3 * i] < bsdf->p_specular;
    }
    return status;
}

static rgb value_of(const void *bsdf, vec3 wi, double *pdf) { return bis_bsdf_f_pdf(bsdf, wi, pdf); }

bis_status bis_do_bsdf_look(const bis_bsdf *bsdf, size_t n, const float *wi, float *f, double *pdf, bis_diag *diag)
{
    return bis_flat_look(value_of, bsdf, n, wi, f, pdf, diag);
}

bis_status bis_do_bsdf_below(const bis_bsdf *bsdf, size_t n, const float *wi, uint8_t *below, uint32_t *count,
                             bis_diag *diag)
{
    *count = 0;
    for (size_t i = 0; i < n; i++) {
        const double cosine = bis_bsdf_cos(bsdf, (vec3){wi[3 * i], wi[3 * i + 1], wi[3 * i + 2]});
        if (isnan(cosine)) return bis_flat_refuse(diag, "direction %zu is no number", i);
        *count += below[i] = cosine <= 0;
    }
    return BIS_OK;
}

bis_status bis_do_bsdf_plane(const bis_bsdf *bsdf, const double *normal, size_t n, const double *degrees,
                             double *f_cos, double *pdf, bis_diag *diag)
{
    vec3 up;
    const bis_status status = bis_flat_unit(&up, "normal", normal, diag);

    if (status) return status;
    /* away from the eye; 0 where it looks straight down */
    const vec3 across = sub(mul(up, dot(up, bsdf->wo)), bsdf->wo);
    const vec3 side = dot(across, across) > 0 ? normalize(across) : frame_about(up).x;
    for (size_t i = 0; i < n; i++) {
        const double t = degrees[i] * PI / 180;
        if (!isfinite(t)) return bis_flat_refuse(diag, "angle %zu is %g: give a number", i, degrees[i]);
        const vec3 wi = normalize(add(mul(up, cos(t)), mul(side, sin(t))));
        f_cos[i] = (double)bis_bsdf_f(bsdf, wi).r * fmax(0, bis_bsdf_cos(bsdf, wi));
        pdf[i] = bis_bsdf_pdf(bsdf, wi);
    }
    return BIS_OK;
}

bis_status bis_do_bsdf_albedo(const bis_bsdf *bsdf, const double *normal, int n, double *sum, bis_diag *diag)
{
    vec3 up;

    if (!(n >= 1 && n <= 4096)) return bis_flat_refuse(diag, "n is %d: give 1 to 4096", n);
    const bis_status status = bis_flat_unit(&up, "normal", normal, diag);
    if (status) return status;
    const frame about = frame_about(up);
    const double cell = 2 * PI / n / n;
    double reflected = 0, above = 0;
    for (int i = 0; i < n * n; i++) {
        const double cosine = (i / n + 0.5) / n;
        const vec3 wi = to_world(&about, bis_warp_cosine(1 - cosine * cosine, (i % n + 0.5) / n));
        reflected += cell * cosine * rgb_sum(bis_bsdf_f(bsdf, wi)) / 3;
        above += cell * bis_bsdf_pdf(bsdf, wi);
    }
    memcpy(sum, (double[]){reflected, above, 1 - above}, 3 * sizeof *sum);
    return BIS_OK;
}
