/* SPDX-License-Identifier: BSD-2-Clause */
/* parser_convert: what a parameter becomes that is of another type than its directive asks for: a colour in other words
 * than rgb becomes rgb, and with --approximate a texture becomes its mean. */
#include "approximate.h"
#include "base/grow.h"
#include "parser_colours.h"
#include "parser_textures.h"

/* The mean of an image's values, or what is typical of it where it cannot be read. */
static rgbd mean_of_image(const bis_parser *p, const bis_texture *x)
{
    bis_texture_image image;
    rgbd sum = {0, 0, 0};
    if (bis_textures_load(&image, &p->desc->textures.files[x->image], NULL)) return x->value;
    const size_t n = (size_t)image.image.width * (size_t)image.image.height;
    for (size_t i = 0; i < n; i++) {
        const rgb c = image.image.pixels[i];
        sum = rgbd_add(sum, (rgbd){(double)c.r, (double)c.g, (double)c.b});
    }
    bis_image_clear(&image.image);
    sum = rgbd_scale(sum, x->scale / (double)n);
    return x->invert ? (rgbd){1 - sum.r, 1 - sum.g, 1 - sum.b} : sum;
}

bool bis_params_mean(bis_parser *p, const char *name, rgbd *value)
{
    const bis_param *param = bis_params_find(p, name);
    uint32_t index;
    if (!p->approximate || !param || param->type != BIS_TYPE_TEXTURE) return false;
    if (!bis_params_take(p, name, BIS_TYPE_TEXTURE, 1)) return false;
    if (!bis_parser_find_texture(p, param, false, &index)) return false;
    const bis_texture *x = &p->desc->textures.list[index];
    *value = x->kind == BIS_TEXTURE_IMAGE ? mean_of_image(p, x) : x->value;
    if (x->kind != BIS_TEXTURE_CONSTANT)
        bis_approximate_note(p, param->at, "its mean", "a texture as \"%s\"", name);
    return true;
}

void bis_parser_convert(bis_parser *p, bis_param *param, unsigned wanted)
{
    bis_params *ps = &p->params;
    const char *name = bis_parser_text(p, param->name);
    const bool as_rgb = wanted & BIS_TYPE_RGB;
    rgbd mean;
    rgb c;

    if (param->type & BIS_TYPES_OF_COLOUR && as_rgb) {
        if (!bis_params_reflectance(p, name, &c)) {
            param->type = 0; /* said already */
            return;
        }
    } else if (wanted & (BIS_TYPE_RGB | BIS_TYPE_FLOAT) && bis_params_mean(p, name, &mean)) {
        c = rgb_from(mean.r, mean.g, mean.b);
    } else {
        return;
    }
    if (!BIS_ROOM(ps->numbers, ps->capacity_numbers, ps->n_numbers + 3)) {
        bis_parser_nomem(p, param->at);
        return;
    }
    param->type = as_rgb ? BIS_TYPE_RGB : BIS_TYPE_FLOAT;
    param->first = ps->n_numbers;
    param->n = as_rgb ? 3 : 1;
    const double v[3] = {(double)c.r, (double)c.g, (double)c.b};
    for (int i = 0; i < 3; i++) ps->numbers[ps->n_numbers++] = as_rgb ? v[i] : rgb_sum(c) / 3;
}
