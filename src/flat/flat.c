/* SPDX-License-Identifier: BSD-2-Clause */
/* flat: maps, alias tables and materials on arrays. Every loop checks its own values, so a caller's NaN ends here. */
#include "bis/flat/flat.h"

#include "base/text.h"
#include "bis/base/fresnel.h"
#include "bis/base/mem.h"
#include "bis/base/version.h"
#include "bis/beyond/microfacet.h"
#include "bis/scene/light_load.h"
#include "bis/scene/scene.h"
#include "bis/thesis/alias.h"
#include "bis/thesis/phong.h"
#include "flat/say.h"

#include <inttypes.h>
#include <float.h>
#include <stdlib.h>
#include <string.h>

static const bis_loc nowhere = {0};

const char *bis_flat_version(void) { return BIS_VERSION; }

/* All messages of this thread's last call, where they did not fit. */
static _Thread_local char *whole;

static void append_all(char *say, size_t size, const bis_diag *diag)
{
    *say = '\0';
    for (size_t i = 0; i < diag->n; i++) bis_append(say, size, "%s%s", i ? "\n" : "", diag->messages[i].text);
}

int bis_flat_end(bis_status status, bis_diag *diag, char *say, size_t size)
{
    size_t length = 1;

    free(whole);
    whole = NULL;
    for (size_t i = 0; i < diag->n; i++) length += strlen(diag->messages[i].text) + 1;
    if (say && size > 0) append_all(say, size, diag);
    if (say && length > size) whole = malloc(length); /* not bis_alloc: nobody need ask for it */
    if (whole) append_all(whole, length, diag);
    bis_diag_clear(diag);
    return (int)status;
}

size_t bis_flat_said(char *say, size_t size)
{
    const size_t length = whole ? strlen(whole) + 1 : 0;

    if (!say || size < length || !whole) return length;
    memcpy(say, whole, length);
    free(whole);
    whole = NULL;
    return length;
}

bis_status bis_flat_given(const char *names, const void *const *pointers, size_t n, bis_diag *diag)
{
    for (size_t i = 0; i < n; i++) {
        const size_t length = strcspn(names, ",");
        if (!pointers[i])
            return bis_error(diag, BIS_INPUT, nowhere, "%.*s is NULL: give what was opened, or an array",
                             (int)length, names);
        names += length + strspn(names + length, ", ");
    }
    return BIS_OK;
}

bis_status bis_flat_check_numbers(size_t n, size_t k, const double *u, bis_diag *diag)
{
    for (size_t i = 0; i < n * k; i++) {
        if (u[i] >= 0 && u[i] < 1) continue;
        return bis_error(diag, BIS_INPUT, nowhere, "u of sample %zu is %g: give random numbers in [0, 1)", i / k, u[i]);
    }
    return BIS_OK;
}

bis_status bis_flat_direction(vec3 *w, const float *all, size_t i, bis_diag *diag)
{
    const double x = (double)all[3 * i], y = (double)all[3 * i + 1], z = (double)all[3 * i + 2];
    const double most = fmax(fabs(x), fmax(fabs(y), fabs(z)));

    if (!(isfinite(x) && isfinite(y) && isfinite(z) && most > 0))
        return bis_error(diag, BIS_INPUT, nowhere, "direction %zu is (%g, %g, %g): give finite vectors that are not 0",
                         i, x, y, z);
    const double l = most * sqrt(x / most * (x / most) + y / most * (y / most) + z / most * (z / most));
    *w = vec3_from(x / l, y / l, z / l);
    return BIS_OK;
}

static void store(float *to, float a, float b, float c)
{
    to[0] = a;
    to[1] = b;
    to[2] = c;
}

/* The value and density of a map or a material in n directions. */
static int look(rgb (*value_of)(const void *self, vec3 w, double *pdf), const void *handle, size_t n, const float *w,
                float *value, double *pdf, char *say, size_t size)
{
    bis_diag diag = {0};
    bis_status status = BIS_FLAT_GIVEN(&diag, handle);

    if (!status && n > 0) status = BIS_FLAT_GIVEN(&diag, w, value, pdf);
    for (size_t i = 0; !status && i < n; i++) {
        vec3 wi;
        status = bis_flat_direction(&wi, w, i, &diag);
        if (status) break;
        const rgb v = value_of(handle, wi, &pdf[i]);
        store(value + 3 * i, v.r, v.g, v.b);
    }
    return bis_flat_end(status, &diag, say, size);
}

/* ---- maps ---- */

bis_status bis_flat_light_describe(bis_light_desc *desc, const char *name, const char *kind, double area_exponent,
                                   const char *mapping, bis_diag *diag)
{
    *desc = bis_light_desc_default();
    desc->filename = (char *)(uintptr_t)name; /* only read */
    desc->has_table_kind = true;
    desc->table_kind = strcmp(kind, "cdf") == 0 ? BIS_TABLE_CDF : BIS_TABLE_ALIAS;
    desc->area_exponent = area_exponent;
    desc->has_mapping = mapping != NULL;
    if (mapping) desc->mapping = bis_mapping_find(mapping);
    if (strcmp(kind, "cdf") != 0 && strcmp(kind, "alias") != 0)
        return bis_error(diag, BIS_INPUT, nowhere, "there is no table \"%.40s\": give \"alias\" or \"cdf\"", kind);
    if (!(area_exponent >= 0 && area_exponent <= BIS_AREA_EXPONENT_MAX))
        return bis_error(diag, BIS_INPUT, nowhere, "area_exponent is %g: give a number in [0, %g]", area_exponent,
                         BIS_AREA_EXPONENT_MAX);
    if (mapping && desc->mapping == BIS_N_MAPPINGS)
        return bis_error(diag, BIS_INPUT, nowhere,
                         "there is no mapping \"%.40s\"; `bis help lights` lists them, as \"latlong\"", mapping);
    return BIS_OK;
}

int bis_flat_light_open(bis_light **light, const char *path, const char *kind, double area_exponent,
                        const char *mapping, char *say, size_t size)
{
    bis_diag diag = {0};
    bis_light_desc desc;
    bis_status status = BIS_FLAT_GIVEN(&diag, light, path, kind);

    if (light) *light = NULL;
    if (!status) status = bis_flat_light_describe(&desc, path, kind, area_exponent, mapping, &diag);
    if (!status) status = bis_light_load(light, &desc, BIS_NEED_TABLE, NULL, &diag);
    return bis_flat_end(status, &diag, say, size);
}

int bis_flat_light_make(bis_light **light, int width, int height, const float *pixels, const char *kind,
                        double area_exponent, const char *mapping, char *say, size_t size)
{
    bis_diag diag = {0};
    bis_light_desc desc;
    bis_image image = {0};
    bis_status status = BIS_FLAT_GIVEN(&diag, light, pixels, kind);

    if (light) *light = NULL;
    if (!status) status = bis_flat_light_describe(&desc, "the array", kind, area_exponent, mapping, &diag);
    if (!status) status = bis_image_init(&image, width, height, &diag);
    if (status) return bis_flat_end(status, &diag, say, size);
    const size_t n = (size_t)width * (size_t)height;
    for (size_t i = 0; i < n; i++) image.pixels[i] = (rgb){pixels[3 * i], pixels[3 * i + 1], pixels[3 * i + 2]};
    status = bis_light_from_image(light, &image, &desc, BIS_NEED_TABLE, &diag);
    return bis_flat_end(status, &diag, say, size);
}

void bis_flat_light_close(bis_light *light) { bis_light_free(light); }

void bis_flat_light_shape(const bis_light *light, int shape[2])
{
    if (!shape) return;
    shape[0] = light ? bis_light_envmap(light)->width : 0;
    shape[1] = light ? bis_light_envmap(light)->height : 0;
}

void bis_flat_light_pixels(const bis_light *light, float *pixels)
{
    if (!light || !pixels) return;
    const bis_envmap *em = bis_light_envmap(light);
    const size_t n = (size_t)em->width * (size_t)em->height;

    for (size_t i = 0; i < n; i++) store(pixels + 3 * i, em->pixels[i].r, em->pixels[i].g, em->pixels[i].b);
}

double bis_flat_light_power(const bis_light *light) { return light ? bis_light_power(light) : (double)NAN; }

int bis_flat_light_sample(const bis_light *light, size_t n, const double *u, float *w, float *L, double *pdf,
                          char *say, size_t size)
{
    bis_diag diag = {0};
    bis_status status = BIS_FLAT_GIVEN(&diag, light);

    if (!status && n > 0) status = BIS_FLAT_GIVEN(&diag, u, w, L, pdf);
    if (!status) status = bis_flat_check_numbers(n, 4, u, &diag);
    for (size_t i = 0; !status && i < n; i++) {
        bis_light_point p;
        if (!bis_light_sample(light, u + 4 * i, &p)) {
            status = bis_error(&diag, BIS_INPUT, nowhere, "the map is black: it has no directions to draw");
            break;
        }
        store(w + 3 * i, p.wi.x, p.wi.y, p.wi.z);
        store(L + 3 * i, p.Le.r, p.Le.g, p.Le.b);
        pdf[i] = p.pdf;
    }
    return bis_flat_end(status, &diag, say, size);
}

static rgb light_value(const void *light, vec3 w, double *pdf) { return bis_light_Le_pdf(light, w, pdf); }

int bis_flat_light_look(const bis_light *light, size_t n, const float *w, float *L, double *pdf, char *say,
                        size_t size)
{
    return look(light_value, light, n, w, L, pdf, say, size);
}

/* ---- alias tables ---- */

bis_status bis_flat_weights(size_t n, const double *w, bis_diag *diag)
{
    bool is_black = true;

    if (n == 0 || n > UINT32_MAX)
        return bis_error(diag, BIS_INPUT, nowhere, "there are %zu weights: give 1 to %" PRIu32, n, UINT32_MAX);
    for (size_t i = 0; i < n; i++) {
        if (!(isfinite(w[i]) && w[i] >= 0))
            return bis_error(diag, BIS_INPUT, nowhere, "weight %zu is %g: give finite numbers >= 0", i, w[i]);
        is_black &= w[i] == 0;
    }
    if (is_black) return bis_error(diag, BIS_INPUT, nowhere, "all weights are 0: there is nothing to draw");
    return BIS_OK;
}

int bis_flat_alias_build(size_t n, const double *w, double *prob, uint32_t *alias, double *total, char *say,
                         size_t size)
{
    bis_diag diag = {0};
    bis_alias a = {0};
    bis_status status = n > 0 ? BIS_FLAT_GIVEN(&diag, w, prob, alias, total) : BIS_OK;

    if (!status) status = bis_flat_weights(n, w, &diag);
    if (!status) status = bis_alias_init(&a, w, n, &diag);
    if (!status) {
        memcpy(prob, a.prob, n * sizeof *prob);
        memcpy(alias, a.alias, n * sizeof *alias);
        *total = a.total;
    }
    bis_alias_clear(&a);
    return bis_flat_end(status, &diag, say, size);
}

static bis_status check_tables(size_t n, const double *prob, const uint32_t *alias, bis_diag *diag)
{
    if (n > UINT32_MAX)
        return bis_error(diag, BIS_INPUT, nowhere, "there are %zu bins: give 1 to %" PRIu32, n, UINT32_MAX);
    for (size_t i = 0; i < n; i++) {
        if (!(prob[i] >= 0 && prob[i] <= 1))
            return bis_error(diag, BIS_INPUT, nowhere, "prob of bin %zu is %g: give numbers in [0, 1]", i, prob[i]);
        if (alias[i] >= n)
            return bis_error(diag, BIS_INPUT, nowhere, "alias of bin %zu is %" PRIu32 ": give items below %zu", i,
                             alias[i], n);
    }
    return BIS_OK;
}

int bis_flat_alias_sample(size_t n, const double *prob, const uint32_t *alias, size_t m, const double *u,
                          uint32_t *item, char *say, size_t size)
{
    bis_diag diag = {0};
    bis_status status = BIS_OK;

    if (n == 0) status = bis_error(&diag, BIS_INPUT, nowhere, "the tables are empty: there is nothing to draw");
    if (!status) status = BIS_FLAT_GIVEN(&diag, prob, alias);
    if (!status && m > 0) status = BIS_FLAT_GIVEN(&diag, u, item);
    if (!status) status = check_tables(n, prob, alias, &diag);
    if (!status) status = bis_flat_check_numbers(m, 1, u, &diag);
    for (size_t i = 0; !status && i < m; i++) item[i] = (uint32_t)bis_alias_pick(prob, alias, n, u[i]);
    return bis_flat_end(status, &diag, say, size);
}

/* ---- materials ---- */

/* The material lives beside the bsdf, which points to it. */
typedef struct owned {
    bis_bsdf bsdf; /* first, so that its address is that of the block */
    bis_material material;
} owned;

static bis_status check_colour(const char *name, const double *c, bis_diag *diag)
{
    for (int i = 0; i < 3; i++) {
        if (c[i] >= 0 && c[i] <= 1) continue;
        return bis_error(diag, BIS_INPUT, nowhere, "%s is (%g, %g, %g): give numbers in [0, 1]", name, c[0], c[1],
                         c[2]);
    }
    return BIS_OK;
}

bis_status bis_flat_unit(vec3 *w, const char *name, const double *v, bis_diag *diag)
{
    const bool is_finite = isfinite(v[0]) && isfinite(v[1]) && isfinite(v[2]);
    const double most = fmax(fmax(fabs(v[0]), fabs(v[1])), fabs(v[2]));
    int e;

    if (!(is_finite && most > 0))
        return bis_error(diag, BIS_INPUT, nowhere, "%s is (%g, %g, %g): give a finite vector that is not 0", name,
                         v[0], v[1], v[2]);
    frexp(most, &e); /* a power of two changes no bit, but squares of 1e200 would be infinite, those of 1e-200 be 0 */
    const double x = ldexp(v[0], -e), y = ldexp(v[1], -e), z = ldexp(v[2], -e), l = sqrt(x * x + y * y + z * z);
    *w = vec3_from(x / l, y / l, z / l);
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
    return bis_error(diag, BIS_INPUT, nowhere, "the roughness is %g: give a number in [%g, 1]", roughness,
                     BIS_MICROFACET_MIN_ROUGHNESS);
}

static rgb colour(const double *c) { return rgb_from(c[0], c[1], c[2]); }

int bis_flat_bsdf_open(bis_bsdf **bsdf, const char *model, const double *Kd, const double *Ks, double width,
                       const double *normal, const double *wo, char *say, size_t size)
{
    bis_diag diag = {0};
    bis_status status = BIS_FLAT_GIVEN(&diag, bsdf, model, Kd, Ks, normal, wo);

    if (bsdf) *bsdf = NULL;
    if (status) return bis_flat_end(status, &diag, say, size);
    const bool is_phong = strcmp(model, "phong") == 0, is_facet = strcmp(model, "microfacet") == 0;
    if (!is_phong && !is_facet)
        status = bis_error(&diag, BIS_INPUT, nowhere, "there is no model \"%.40s\": give \"phong\" or \"microfacet\"",
                           model);
    else if (is_phong && !(width >= 0 && width <= (double)FLT_MAX)) /* above, f is beyond a float */
        status = bis_error(&diag, BIS_INPUT, nowhere, "the exponent is %g: give a number in [0, 3.4e38]", width);
    else if (is_facet)
        status = check_roughness(width, &diag);
    if (!status) status = check_colour("Kd", Kd, &diag);
    if (!status) status = check_colour("Ks", Ks, &diag);
    if (!status)
        status = place(bsdf, is_phong ? bis_phong(colour(Kd), colour(Ks), width)
                                      : bis_microfacet(colour(Kd), colour(Ks), width), normal, wo, &diag);
    return bis_flat_end(status, &diag, say, size);
}

int bis_flat_bsdf_metal(bis_bsdf **bsdf, const double *eta, const double *k, double roughness, const double *normal,
                        const double *wo, char *say, size_t size)
{
    const double most = 1e15; /* bis_fresnel wants squares below 1e30 */
    double Ks[3];
    bis_diag diag = {0};
    bis_status status = BIS_FLAT_GIVEN(&diag, bsdf, eta, k, normal, wo);

    if (bsdf) *bsdf = NULL;
    if (!status) status = check_roughness(roughness, &diag);
    for (int i = 0; !status && i < 3; i++) {
        if (!(eta[i] > 0 && eta[i] <= most && k[i] >= 0 && k[i] <= most))
            status = bis_error(&diag, BIS_INPUT, nowhere,
                               "eta and k of channel %d are %g and %g: give eta in (0, %g] and k in [0, %g]", i, eta[i],
                               k[i], most, most);
        else Ks[i] = bis_fresnel(eta[i], k[i] * k[i], 1);
    }
    if (!status) status = place(bsdf, bis_microfacet_metal(colour(Ks), colour(eta), roughness), normal, wo, &diag);
    return bis_flat_end(status, &diag, say, size);
}

int bis_flat_bsdf_read(bis_bsdf **bsdf, const char *text, const double *normal, const double *wo, char *say,
                       size_t size)
{
    static const char world[] = "WorldBegin\nLightSource \"infinite\"\n", shape[] = "\nShape \"sphere\"\n";
    bis_diag diag = {0};
    bis_scene_desc *d = NULL;
    bis_status status = BIS_FLAT_GIVEN(&diag, bsdf, text, normal, wo);
    const size_t room = status ? 0 : strlen(text) + sizeof world + sizeof shape;
    char *scene = status ? NULL : bis_alloc(room, 1);

    if (bsdf) *bsdf = NULL;
    if (!status && !scene) status = bis_error(&diag, BIS_NOMEM, nowhere, "no memory for a material");
    if (!status) {
        snprintf(scene, room, "%s%s%s", world, text, shape);
        status = bis_scene_parse_text(&d, "material", scene, 0, &diag);
    }
    bis_free(scene);
    const uint32_t at = status ? 0 : d->shapes[d->n_shapes - 1].material;
    if (!status && bis_textures_of(&d->textures, at))
        status = bis_error(&diag, BIS_INPUT, nowhere, "the material has a texture: give it values");
    if (!status) status = place(bsdf, d->materials[at], normal, wo, &diag);
    bis_scene_desc_free(d);
    return bis_flat_end(status, &diag, say, size);
}

void bis_flat_bsdf_close(bis_bsdf *bsdf) { bis_free(bsdf); }

int bis_flat_bsdf_sample(const bis_bsdf *bsdf, size_t n, const double *u, float *wi, uint8_t *lobe, char *say,
                         size_t size)
{
    bis_diag diag = {0};
    bis_status status = BIS_FLAT_GIVEN(&diag, bsdf);

    if (!status && n > 0) status = BIS_FLAT_GIVEN(&diag, u, wi, lobe);
    if (!status) status = bis_flat_check_numbers(n, 3, u, &diag);
    if (!status && bis_bsdf_is_black(bsdf))
        status = bis_error(&diag, BIS_INPUT, nowhere,
                           "the material is black as seen from wo: it has no directions to draw");
    for (size_t i = 0; !status && i < n; i++) {
        vec3 w;
        bis_bsdf_sample(bsdf, u[3 * i], u[3 * i + 1], u[3 * i + 2], &w); /* only a black material returns false */
        store(wi + 3 * i, w.x, w.y, w.z);
        lobe[i] = u[3 * i] < bsdf->p_specular;
    }
    return bis_flat_end(status, &diag, say, size);
}

static rgb bsdf_value(const void *bsdf, vec3 wi, double *pdf) { return bis_bsdf_f_pdf(bsdf, wi, pdf); }

int bis_flat_bsdf_look(const bis_bsdf *bsdf, size_t n, const float *wi, float *f, double *pdf, char *say, size_t size)
{
    return look(bsdf_value, bsdf, n, wi, f, pdf, say, size);
}
