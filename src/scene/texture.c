/* SPDX-License-Identifier: BSD-2-Clause */
/* texture: the images of textures, the ranges of their values, and the materials that they make.
 *
 * A texture is a small tree; its leaves are constants, images and patterns.
 * No value is cut off, but an alpha of pbrt-v3's: what leaves its range is refused when the images are known, with the
 * largest value in the message, because a picture that differs from what the scene says should not look as if it did
 * not. */
#include "bis/scene/texture.h"

#include "bis/base/mem.h"
#include "bis/files/image_file.h"

#include "noise.h"
#include "texture_value.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

const char *const bis_texture_names[] = {
    "constant", "imagemap", "scale", "mix", "checkerboard", "bilerp", "dots", "fbm", "marble", "uv", "windy",
    "wrinkled", "checkerboard in space", "coated", "remapped"};

void bis_textures_clear(bis_textures *t)
{
    for (size_t i = 0; i < t->n_files; i++) bis_free(t->files[i].filename);
    bis_free(t->list);
    bis_free(t->files);
    bis_free(t->of_material);
    *t = (bis_textures){0};
}

/* As deep as BIS_TEXTURE_MAX_STEPS at most, like all that follow the tree. */
void bis_textures_mark(bool *is_used, const bis_textures *t, uint32_t texture)
{
    if (texture == BIS_NO_TEXTURE) return;
    const bis_texture *x = &t->list[texture];
    if (x->kind == BIS_TEXTURE_IMAGE) is_used[x->image] = true;
    for (int i = 0; i < bis_texture_n_parts(x); i++) bis_textures_mark(is_used, t, x->of[i]);
}

static bool wants_uv(const bis_textures *t, uint32_t texture)
{
    if (texture == BIS_NO_TEXTURE) return false;
    const bis_texture *x = &t->list[texture];
    bool wants = bis_texture_maps_uv(x);
    for (int i = 0; i < bis_texture_n_parts(x) && !wants; i++) wants = wants_uv(t, x->of[i]);
    return wants;
}

void bis_textures_mark_all(bool *is_used, const bis_textures *t, const bis_material_textures *of)
{
    const bis_texture_slots slots = bis_texture_slots_of(of);

    for (int i = 0; i < BIS_MATERIAL_TEXTURES; i++) bis_textures_mark(is_used, t, slots.of[i]);
    if (of->normals != BIS_NO_TEXTURE) is_used[of->normals] = true;
}

bool bis_textures_want_uv(const bis_textures *t, const bis_material_textures *of)
{
    const bis_texture_slots slots = bis_texture_slots_of(of);
    bool wants = of->normals != BIS_NO_TEXTURE;

    for (int i = 0; i < BIS_MATERIAL_TEXTURES; i++) wants |= wants_uv(t, slots.of[i]);
    return wants;
}

/* ---- images ---- */

static bis_status find_range(bis_texture_image *image, const bis_texture_file *file, bis_diag *diag)
{
    const bis_image *im = &image->image;
    const size_t n = (size_t)im->width * (size_t)im->height;

    for (int k = 0; k < 4; k++) {
        image->lo[k] = (double)INFINITY;
        image->hi[k] = -(double)INFINITY;
    }
    for (size_t i = 0; i < n; i++) {
        const rgb c = im->pixels[i];
        const double v[4] = {(double)c.r, (double)c.g, (double)c.b, rgb_sum(c) / 3};
        if (!rgb_is_finite(c) || c.r < 0 || c.g < 0 || c.b < 0) {
            return bis_error(diag, BIS_INPUT, file->loc,
                             "\"%s\": texel (%zu, %zu), counted from the top left, is %g %g %g; those of a texture "
                             "must be finite and >= 0",
                             file->filename, i % (size_t)im->width, i / (size_t)im->width, v[0], v[1], v[2]);
        }
        for (int k = 0; k < 4; k++) {
            image->lo[k] = fmin(image->lo[k], v[k]);
            image->hi[k] = fmax(image->hi[k], v[k]);
        }
    }
    return BIS_OK;
}

/* Is it a normal map? Its texels are c = (n + 1)/2 of unit vectors n that point out of the surface: blue is the
 * largest by more than .1 in the mean, and | |2c - 1| - 1 | is below .1 in 95 % of the texels. 8 bits and the smaller
 * levels of mipmaps shorten most vectors by less than that, and so does JPEG, but not of the roughest maps: *may_hold
 * is what blue says alone. Heights are grey, where blue is no larger; a coloured photograph has few texels of that
 * length. */
static bool holds_normals(const bis_image *im, bool *may_hold)
{
    const size_t n = (size_t)im->width * (size_t)im->height;
    size_t n_unit = 0;
    double blue = 0;

    for (size_t i = 0; i < n; i++) {
        const rgb c = im->pixels[i];
        const double x = 2 * (double)c.r - 1, y = 2 * (double)c.g - 1, z = 2 * (double)c.b - 1;
        n_unit += fabs(sqrt(x * x + y * y + z * z) - 1) < 0.1;
        blue += (double)c.b - fmax((double)c.r, (double)c.g);
    }
    *may_hold = blue > 0.1 * (double)n;
    return *may_hold && (double)n_unit >= 0.95 * (double)n;
}

/* Grey stays as it is to the bit. Source: convertIn in src/textures/imagemap.h of pbrt-v3, and its weights. */
static void take_luminance(bis_image *im, const bis_texture_file *file)
{
    const bool is_linear = bis_image_check_head(file->filename, false, file->loc, NULL) == BIS_OK;
    const double gamma = is_linear ? 1 : file->gamma;
    for (size_t i = 0; i < (size_t)im->width * (size_t)im->height; i++) {
        const rgb c = im->pixels[i];
        if ((c.r == c.g && c.g == c.b) || !rgb_is_finite(c)) continue;
        const double y = 0.212671 * bis_image_from_linear((double)c.r, gamma) +
                         0.715160 * bis_image_from_linear((double)c.g, gamma) +
                         0.072169 * bis_image_from_linear((double)c.b, gamma);
        const double v = bis_image_to_linear(y, gamma);
        im->pixels[i] = rgb_from(v, v, v);
    }
}

/* Alpha takes the place of the colours, unless all of it is 1. Source: MIPMap::CreateFromFile and Bilerp in
 * src/pbrt/util/mipmap.cpp of pbrt-v4. */
static void take_alpha(bis_image *im)
{
    const size_t n = (size_t)im->width * (size_t)im->height;
    bool some = false;
    for (size_t i = 0; i < n && im->alpha; i++) some |= im->alpha[i] < 1;
    for (size_t i = 0; i < n && some; i++) im->pixels[i] = (rgb){im->alpha[i], im->alpha[i], im->alpha[i]};
    bis_free(im->alpha);
    im->alpha = NULL;
}

bis_status bis_textures_load(bis_texture_image *image, const bis_texture_file *file, bis_diag *diag)
{
    const bool is_bump = file->meaning == BIS_IMAGE_BUMP;
    const double gamma = is_bump ? 1 : file->gamma;
    bool may_hold = false;

    *image = (bis_texture_image){.image = {0}};
    bis_status status = (file->meaning == BIS_IMAGE_ALPHA ? bis_image_read_alpha : bis_image_read_colours)(
        &image->image, file->filename, gamma, file->loc, diag);
    image->holds_normals = !status && is_bump && holds_normals(&image->image, &may_hold);
    if (may_hold && !image->holds_normals)
        bis_warn(diag, file->loc, "%s is taken for heights, but it is blue as a normal map is. If it is one, as a JPEG "
                 "of rough ground, write \"norm\" in the place of \"map_Bump\"; else put \"-imfchan l\" before its "
                 "name", file->filename);
    if (image->holds_normals) {
        bis_warn(diag, file->loc, "%s holds normals and no heights: it is taken as a normal map (\"norm\"), -bm as a "
                 "factor of its x and y. For heights put \"-imfchan l\" before its name. Where dents look like bumps, "
                 "its green channel is DirectX's: invert it", file->filename);
    } else if (!status && gamma != file->gamma) {
        bis_image_clear(&image->image);
        status = bis_image_read_colours(&image->image, file->filename, file->gamma, file->loc, diag);
    }
    if (!status && file->meaning == BIS_IMAGE_LUMINANCE) take_luminance(&image->image, file);
    if (!status) take_alpha(&image->image);
    if (!status) status = find_range(image, file, diag);
    if (status) bis_image_clear(&image->image);
    return status;
}

rgbd bis_textures_value(const bis_textures *t, const bis_texture_image *images, uint32_t texture, const double uv[2],
                        vec3 p)
{
    return bis_texture_value(t, images, texture, uv, (double[]){(double)p.x, (double)p.y, (double)p.z});
}

/* ---- ranges ---- */

typedef struct range {
    double lo[3], hi[3];
} range;

static range image_range(const bis_texture *x, const bis_texture_image *image)
{
    range r;

    for (int k = 0; k < 3; k++) {
        const int channel = x->is_float ? 3 : k;
        const double least = x->wrap == BIS_WRAP_BLACK ? 0 : image->lo[channel];
        const double a = bis_texture_of_image(x, least), b = bis_texture_of_image(x, image->hi[channel]);
        r.lo[k] = fmin(a, b);
        r.hi[k] = fmax(a, b);
    }
    return r;
}

/* Of a x b, or of (1 - w) a + w b: both are largest and least at corners, because they are linear in each of the
 * variables. */
static void combine(double *lo, double *hi, const bis_texture *x, const range part[4], int k)
{
    *lo = (double)INFINITY;
    *hi = -(double)INFINITY;
    for (int i = 0; i < 8; i++) {
        const double a = i & 1 ? part[0].lo[k] : part[0].hi[k], b = i & 2 ? part[1].lo[k] : part[1].hi[k];
        const bool is_mix = x->kind == BIS_TEXTURE_MIX;
        const double w = !is_mix ? 0 : i & 4 ? part[2].lo[k] : part[2].hi[k];
        const double v = is_mix ? (1 - w) * a + w * b : a * b;
        *lo = fmin(*lo, v);
        *hi = fmax(*hi, v);
    }
}

static range around_0(double most) { return (range){{-most, -most, -most}, {most, most, most}}; }

/* Of a texture without parts. */
static range leaf_range(const bis_texture *x, const bis_texture_image *images)
{
    const double most = BIS_NOISE_MOST * bis_noise_weights(x->roughness, x->octaves);
    range r = {{x->value.r, x->value.g, x->value.b}, {x->value.r, x->value.g, x->value.b}};

    switch (x->kind) {
    case BIS_TEXTURE_IMAGE:
        return image_range(x, &images[x->image]);
    case BIS_TEXTURE_UV_COLOUR:
        return (range){{0, 0, 0}, {1, 1, 0}};
    case BIS_TEXTURE_FBM:
        return around_0(most);
    case BIS_TEXTURE_WRINKLED: { /* the last part is always there */
        const double rest = 0.2 * pow(x->roughness, x->octaves);
        return (range){{rest, rest, rest}, {most + rest, most + rest, most + rest}};
    }
    case BIS_TEXTURE_WINDY:
        return around_0(BIS_NOISE_MOST * bis_noise_weights(0.5, 3) * BIS_NOISE_MOST * bis_noise_weights(0.5, 6));
    case BIS_TEXTURE_MARBLE: /* a Bezier curve stays among its points */
        for (int k = 0; k < 3; k++) {
            r.lo[k] = r.hi[k] = BIS_MARBLE_SCALE * bis_marble_colours[0][k];
            for (int i = 1; i < BIS_MARBLE_COLOURS; i++) {
                r.lo[k] = fmin(r.lo[k], BIS_MARBLE_SCALE * bis_marble_colours[i][k]);
                r.hi[k] = fmax(r.hi[k], BIS_MARBLE_SCALE * bis_marble_colours[i][k]);
            }
        }
        return r;
    default:
        return r;
    }
}

static range range_of(const bis_textures *t, const bis_texture_image *images, uint32_t texture)
{
    const bis_texture *x = &t->list[texture];
    const int n = bis_texture_n_parts(x);
    range r, part[4];

    if (n == 0) return leaf_range(x, images);
    for (int i = 0; i < n; i++) part[i] = range_of(t, images, x->of[i]);
    for (int k = 0; k < 3; k++) {
        if (x->kind == BIS_TEXTURE_COAT) { /* it grows with what is below, as far as 1; beyond, that shows */
            r.lo[k] = part[0].lo[k] <= 1 ? bis_texture_coated(x, part[0].lo[k]) : part[0].lo[k];
            r.hi[k] = part[0].hi[k] <= 1 ? bis_texture_coated(x, part[0].hi[k]) : part[0].hi[k];
        } else if (x->kind == BIS_TEXTURE_ALPHA) {
            r.lo[k] = bis_texture_own_alpha(part[0].lo[k]);
            r.hi[k] = bis_texture_own_alpha(part[0].hi[k]);
        } else if (x->kind == BIS_TEXTURE_SCALE || x->kind == BIS_TEXTURE_MIX) {
            combine(&r.lo[k], &r.hi[k], x, part, k);
        } else { /* one of the parts, or between them */
            r.lo[k] = part[0].lo[k];
            r.hi[k] = part[0].hi[k];
            for (int i = 1; i < n; i++) {
                r.lo[k] = fmin(r.lo[k], part[i].lo[k]);
                r.hi[k] = fmax(r.hi[k], part[i].hi[k]);
            }
        }
    }
    return r;
}

void bis_textures_range(rgbd *lo, rgbd *hi, const bis_textures *t, const bis_texture_image *images, uint32_t texture)
{
    const range r = range_of(t, images, texture);

    *lo = (rgbd){r.lo[0], r.lo[1], r.lo[2]};
    *hi = (rgbd){r.hi[0], r.hi[1], r.hi[2]};
}

/* ---- materials ---- */

/* What a texture's values are called, and where they must lie. */
typedef struct use {
    uint32_t texture;
    const char *what;
    double lo, hi;
} use;

static bis_status check_range(range *found, const bis_textures *t, const bis_texture_image *images, use u, bis_loc at,
                              bis_diag *diag)
{
    const range r = range_of(t, images, u.texture);
    const double lo = u.lo, hi = u.hi;

    *found = r;
    for (int k = 0; k < 3 && t->cuts_off; k++) {
        found->lo[k] = fmin(fmax(r.lo[k], lo), hi);
        found->hi[k] = fmin(fmax(r.hi[k], lo), hi);
    }
    for (int k = 0; k < 3; k++) {
        /* floats, because that is what materials keep: 0.01 as a float is no less than 0.01 */
        const bool is_low = (float)r.lo[k] < (float)lo, is_high = (float)r.hi[k] > (float)hi;
        if (!is_low && !is_high) continue;
        char rule[64] = "";
        if (isinf(hi)) snprintf(rule, sizeof rule, ">= %g", lo);
        else snprintf(rule, sizeof rule, "in [%g, %g]", lo, hi);
        if (t->cuts_off) {
            bis_warn(diag, at, "the texture of \"%s\" has values %s %.7g, must be %s: what lies outside is cut off",
                     u.what, is_low ? "down to" : "up to", is_low ? r.lo[k] : r.hi[k], rule);
            return BIS_OK;
        }
        return bis_error(diag, BIS_INPUT, at,
                         "the texture of \"%s\" has values %s %.7g, must be %s: change it by its \"float scale\", or "
                         "by a Texture \"scale\" or \"mix\"",
                         u.what, is_low ? "down to" : "up to", is_low ? r.lo[k] : r.hi[k], rule);
    }
    return BIS_OK;
}

static range range_of_constant(rgb c)
{
    return (range){{(double)c.r, (double)c.g, (double)c.b}, {(double)c.r, (double)c.g, (double)c.b}};
}

static void warn_energy(const range *Kd, const range *Ks, bis_loc at, bis_diag *diag)
{
    const double one = 1 + (double)FLT_EPSILON / 2; /* two floats, each rounded by half an ulp of its own */

    for (int k = 0; k < 3; k++) {
        if (Kd->hi[k] + Ks->hi[k] <= one) continue;
        bis_warn(diag, at, "Kd + Ks may reach %.7g in %s: the material would reflect more light than it receives. Make "
                 "one of them smaller, a texture by its \"float scale\", or in an .mtl by the Kd or Ks beside it",
                 Kd->hi[k] + Ks->hi[k], (const char *const[]){"red", "green", "blue"}[k]);
        return;
    }
}

bis_status bis_textures_check(const bis_textures *t, const bis_texture_image *images, const bis_material_textures *of,
                              const bis_material *base, bis_diag *diag)
{
    const bis_bsdf_width w = base->model->width(base);
    range Kd = range_of_constant(base->Kd), Ks = range_of_constant(base->Ks), width;
    bis_status status = BIS_OK;

    if (!base->model->remake)
        return bis_error(diag, BIS_INPUT, of->loc,
                         "a texture of material \"%s\", whose model has no `remake`: give constants",
                         base->model->name);
    if (of->Kd != BIS_NO_TEXTURE) status = check_range(&Kd, t, images, (use){of->Kd, "Kd", 0, 1}, of->loc, diag);
    if (!status && of->Ks != BIS_NO_TEXTURE)
        status = check_range(&Ks, t, images, (use){of->Ks, "Ks", 0, 1}, of->loc, diag);
    if (!status && of->width != BIS_NO_TEXTURE) {
        const use u = {of->width, w.scene_name, pow(w.least, 1 / of->power), pow(w.most, 1 / of->power)};
        status = check_range(&width, t, images, u, of->loc, diag);
    }
    if (!status && base->model->gains_beyond_1) warn_energy(&Kd, &Ks, of->loc, diag);
    return status;
}

/* In [0,1] but for rounding, unless it is cut off. */
static rgb round_value(rgbd v)
{
    return rgb_from(fmin(fmax(v.r, 0), 1), fmin(fmax(v.g, 0), 1), fmin(fmax(v.b, 0), 1));
}

bis_material bis_textures_material(const bis_textures *t, const bis_texture_image *images,
                                   const bis_material_textures *of, const bis_material *base, const double uv[2],
                                   vec3 p)
{
    const rgb Kd = of->Kd == BIS_NO_TEXTURE ? base->Kd : round_value(bis_textures_value(t, images, of->Kd, uv, p));
    const rgb Ks = of->Ks == BIS_NO_TEXTURE ? base->Ks : round_value(bis_textures_value(t, images, of->Ks, uv, p));

    if (of->width == BIS_NO_TEXTURE) return base->model->remake(base, Kd, Ks, NULL);
    const bis_bsdf_width w = base->model->width(base);
    /* fmax and fmin: a sum of weights may miss the range by an ulp */
    const double width = pow(fmax(0, bis_textures_value(t, images, of->width, uv, p).r), of->power);
    return base->model->remake(base, Kd, Ks, &(double){fmin(w.most, fmax(w.least, width))});
}
