/* texture: values, their ranges, and the materials that they make.
 *
 * A texture is a small tree; its leaves are constants and images. An image is interpolated bilinearly between the
 * centres of its texels, and never filtered: where texels are smaller than pixels, the camera samples average them.
 * No value is cut off, but an alpha of pbrt-v3's: what leaves its range is refused when the images are known, with the
 * largest value in the message, because a picture that differs from what the scene says should not look as if it did
 * not. */
#include "bis/scene/texture.h"

#include "bis/base/mem.h"
#include "bis/files/image_file.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

void bis_textures_clear(bis_textures *t)
{
    for (size_t i = 0; i < t->n_files; i++) bis_free(t->files[i].filename);
    bis_free(t->list);
    bis_free(t->files);
    bis_free(t->of_material);
    *t = (bis_textures){0};
}

static int n_parts(const bis_texture *x)
{
    return x->kind == BIS_TEXTURE_MIX                                             ? 3
           : x->kind == BIS_TEXTURE_SCALE || x->kind == BIS_TEXTURE_CHECKERBOARD ? 2
           : x->kind == BIS_TEXTURE_COAT || x->kind == BIS_TEXTURE_ALPHA         ? 1
                                                                                  : 0;
}

/* As deep as BIS_TEXTURE_MAX_STEPS at most, like all that follow the tree. */
void bis_textures_mark(bool *is_used, const bis_textures *t, uint32_t texture)
{
    if (texture == BIS_NO_TEXTURE) return;
    const bis_texture *x = &t->list[texture];
    if (x->kind == BIS_TEXTURE_IMAGE) is_used[x->image] = true;
    for (int i = 0; i < n_parts(x); i++) bis_textures_mark(is_used, t, x->of[i]);
}

static bool wants_uv(const bis_textures *t, uint32_t texture)
{
    if (texture == BIS_NO_TEXTURE) return false;
    const bis_texture *x = &t->list[texture];
    bool wants = (x->kind == BIS_TEXTURE_IMAGE || x->kind == BIS_TEXTURE_CHECKERBOARD) && x->mapping == BIS_TEXTURE_UV;
    for (int i = 0; i < n_parts(x) && !wants; i++) wants = wants_uv(t, x->of[i]);
    return wants;
}

bool bis_textures_want_uv(const bis_textures *t, const bis_material_textures *of)
{
    return wants_uv(t, of->Kd) || wants_uv(t, of->Ks) || wants_uv(t, of->width);
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

bis_status bis_textures_load(bis_texture_image *image, const bis_texture_file *file, bis_diag *diag)
{
    *image = (bis_texture_image){{0}, {0}, {0}};
    bis_status status = bis_image_read_colours(&image->image, file->filename, file->gamma, file->loc, diag);
    if (!status) status = find_range(image, file, diag);
    if (status) bis_image_clear(&image->image);
    return status;
}

/* The texel, or one of the image's border, or of its repetition. False: it is black. i may be any whole number. */
static bool wrap_index(double i, int n, bis_wrap wrap, size_t *index)
{
    if (wrap == BIS_WRAP_REPEAT) i -= n * floor(i / n);
    else if (wrap == BIS_WRAP_BLACK && (i < 0 || i >= n)) return false;
    *index = i <= 0 ? 0 : i >= n - 1 ? (size_t)n - 1 : (size_t)i; /* also what rounding makes of a huge i */
    return true;
}

static rgbd texel(const bis_image *image, double x, double y, bis_wrap wrap)
{
    size_t column, row;

    if (!wrap_index(x, image->width, wrap, &column) || !wrap_index(y, image->height, wrap, &row))
        return (rgbd){0, 0, 0};
    const rgb c = image->pixels[row * (size_t)image->width + column];
    return (rgbd){(double)c.r, (double)c.g, (double)c.b};
}

static rgbd lerp(double w, rgbd a, rgbd b) { return rgbd_add(rgbd_scale(a, 1 - w), rgbd_scale(b, w)); }

/* Texel i has its centre at (i + 1/2)/n. Row 0 is at the top, where t = 1. */
static rgbd bilinear(const bis_image *image, double s, double t, bis_wrap wrap)
{
    const double x = s * image->width - 0.5, y = (1 - t) * image->height - 0.5, x0 = floor(x), y0 = floor(y);
    const rgbd top = lerp(x - x0, texel(image, x0, y0, wrap), texel(image, x0 + 1, y0, wrap));
    const rgbd bottom = lerp(x - x0, texel(image, x0, y0 + 1, wrap), texel(image, x0 + 1, y0 + 1, wrap));

    return lerp(y - y0, top, bottom);
}

static double of_image(const bis_texture *x, double v) { return x->invert ? 1 - x->scale * v : x->scale * v; }

static rgbd image_value(const bis_texture *x, const bis_image *image, double s, double t)
{
    rgbd v = bilinear(image, s, t, x->wrap);

    if (x->is_float) v.r = v.g = v.b = rgbd_sum(v) / 3;
    return (rgbd){of_image(x, v.r), of_image(x, v.g), of_image(x, v.b)};
}

/* ---- values ---- */

static rgbd mix(rgbd a, rgbd b, rgbd w)
{
    return (rgbd){(1 - w.r) * a.r + w.r * b.r, (1 - w.g) * a.g + w.g * b.g, (1 - w.b) * a.b + w.b * b.b};
}

/* Values above 1 pass only where they are cut off (cuts_off). */
static double coated(const bis_texture *x, double v)
{
    v = fmin(v, 1);
    return (1 - x->scale) * v / (1 - x->scale * v);
}

double bis_texture_alpha(double roughness)
{
    const double x = log(fmax(roughness, 1e-3));
    return 1.62142 + x * (0.819955 + x * (0.1734 + x * (0.0171201 + x * 0.000640711)));
}

static double own_alpha(double roughness) { return fmin(bis_texture_alpha(roughness), 1); }

/* As in pbrt-v4, "Texture coordinate generation". */
static void map_point(double st[2], const bis_texture *x, const double uv[2], vec3 p)
{
    double q[3];

    if (x->mapping == BIS_TEXTURE_UV) {
        for (int i = 0; i < 2; i++) st[i] = x->factor[i] * uv[i] + x->offset[i];
        return;
    }
    for (int i = 0; i < 3; i++)
        q[i] = x->from_world[i][0] * (double)p.x + x->from_world[i][1] * (double)p.y +
               x->from_world[i][2] * (double)p.z + x->from_world[i][3];
    const double phi = atan2(q[1], q[0]);
    if (x->mapping == BIS_TEXTURE_SPHERICAL) {
        st[0] = atan2(hypot(q[0], q[1]), q[2]) / PI;
        st[1] = (phi < 0 ? phi + 2 * PI : phi) / (2 * PI);
    } else if (x->mapping == BIS_TEXTURE_CYLINDRICAL) {
        st[0] = (PI + phi) / (2 * PI);
        st[1] = q[2];
    } else {
        st[0] = q[0];
        st[1] = q[1];
    }
}

rgbd bis_textures_value(const bis_textures *textures, const bis_texture_image *images, uint32_t texture,
                        const double uv[2], vec3 p)
{
    const bis_texture *x = &textures->list[texture];
    double st[2];
    rgbd v[3];

    switch (x->kind) {
    case BIS_TEXTURE_IMAGE:
        map_point(st, x, uv, p);
        return image_value(x, &images[x->image].image, st[0], st[1]);
    case BIS_TEXTURE_CHECKERBOARD:
        map_point(st, x, uv, p);
        return bis_textures_value(textures, images, x->of[fmod(floor(st[0]) + floor(st[1]), 2) != 0], uv, p);
    case BIS_TEXTURE_SCALE:
    case BIS_TEXTURE_MIX:
        for (int i = 0; i < n_parts(x); i++) v[i] = bis_textures_value(textures, images, x->of[i], uv, p);
        if (x->kind == BIS_TEXTURE_MIX) return mix(v[0], v[1], v[2]);
        return (rgbd){v[0].r * v[1].r, v[0].g * v[1].g, v[0].b * v[1].b};
    case BIS_TEXTURE_COAT:
        v[0] = bis_textures_value(textures, images, x->of[0], uv, p);
        return (rgbd){coated(x, v[0].r), coated(x, v[0].g), coated(x, v[0].b)};
    case BIS_TEXTURE_ALPHA:
        v[0] = bis_textures_value(textures, images, x->of[0], uv, p);
        return (rgbd){own_alpha(v[0].r), own_alpha(v[0].g), own_alpha(v[0].b)};
    case BIS_TEXTURE_CONSTANT:
        break;
    }
    return x->value;
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
        const double a = of_image(x, least), b = of_image(x, image->hi[channel]);
        r.lo[k] = fmin(a, b);
        r.hi[k] = fmax(a, b);
    }
    return r;
}

/* Of a x b, or of (1 - w) a + w b: both are largest and least at corners, because they are linear in each of the
 * variables. */
static void combine(double *lo, double *hi, const bis_texture *x, const range part[3], int k)
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

static range range_of(const bis_textures *t, const bis_texture_image *images, uint32_t texture)
{
    const bis_texture *x = &t->list[texture];
    range r = {{x->value.r, x->value.g, x->value.b}, {x->value.r, x->value.g, x->value.b}}, part[3];

    if (x->kind == BIS_TEXTURE_CONSTANT) return r;
    if (x->kind == BIS_TEXTURE_IMAGE) return image_range(x, &images[x->image]);
    for (int i = 0; i < n_parts(x); i++) part[i] = range_of(t, images, x->of[i]);
    for (int k = 0; k < 3; k++) {
        if (x->kind == BIS_TEXTURE_CHECKERBOARD) {
            r.lo[k] = fmin(part[0].lo[k], part[1].lo[k]);
            r.hi[k] = fmax(part[0].hi[k], part[1].hi[k]);
        } else if (x->kind == BIS_TEXTURE_COAT) { /* it grows with what is below, as far as 1; beyond, that shows */
            r.lo[k] = part[0].lo[k] <= 1 ? coated(x, part[0].lo[k]) : part[0].lo[k];
            r.hi[k] = part[0].hi[k] <= 1 ? coated(x, part[0].hi[k]) : part[0].hi[k];
        } else if (x->kind == BIS_TEXTURE_ALPHA) {
            r.lo[k] = own_alpha(part[0].lo[k]);
            r.hi[k] = own_alpha(part[0].hi[k]);
        } else {
            combine(&r.lo[k], &r.hi[k], x, part, k);
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
static bis_status check_range(range *found, const bis_textures *t, const bis_texture_image *images, uint32_t texture,
                              const char *what, double lo, double hi, bis_loc at, bis_diag *diag)
{
    const range r = range_of(t, images, texture);

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
                     what, is_low ? "down to" : "up to", is_low ? r.lo[k] : r.hi[k], rule);
            return BIS_OK;
        }
        return bis_error(diag, BIS_INPUT, at,
                         "the texture of \"%s\" has values %s %.7g, must be %s: change it by its \"float scale\", or "
                         "by a Texture \"scale\" or \"mix\"",
                         what, is_low ? "down to" : "up to", is_low ? r.lo[k] : r.hi[k], rule);
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
        bis_warn(diag, at, "Kd + Ks may reach %.7g in %s: the material would reflect more light than it receives",
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
    if (of->Kd != BIS_NO_TEXTURE) status = check_range(&Kd, t, images, of->Kd, "Kd", 0, 1, of->loc, diag);
    if (!status && of->Ks != BIS_NO_TEXTURE)
        status = check_range(&Ks, t, images, of->Ks, "Ks", 0, 1, of->loc, diag);
    if (!status && of->width != BIS_NO_TEXTURE)
        status = check_range(&width, t, images, of->width, w.scene_name, pow(w.least, 1 / of->power),
                             pow(w.most, 1 / of->power), of->loc, diag);
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
