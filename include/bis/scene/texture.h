/* SPDX-License-Identifier: BSD-2-Clause */
/* texture: a value that varies over a surface with its texture coordinates (u, v), as pbrt has it. It takes the place
 * of a colour or a number of a material. The parser makes the list of textures; bis_textures_load reads their images; a
 * point's material is made of their values there (bis_scene_point_at), before an integrator sees the point. */
#pragma once

#include "bis/base/image.h"
#include "bis/thesis/bsdf.h"

#include <stdint.h>

/* First pbrt's, in the order in which messages list them. */
typedef enum bis_texture_kind {
    BIS_TEXTURE_CONSTANT,
    BIS_TEXTURE_IMAGE,
    BIS_TEXTURE_SCALE,       /* of[0] times of[1] */
    BIS_TEXTURE_MIX,         /* (1 - of[2]) of[0] + of[2] of[1] */
    BIS_TEXTURE_CHECKERBOARD, /* of[0] where floor(s) + floor(t) is even, else of[1] */
    /* pbrt's patterns. DOTS: of[0] inside of discs, else of[1]. BILERP: of[0], of[1], of[2], of[3] at (s, t) = (0,0),
     * (0,1), (1,0), (1,1), and bilinear in s and t, also beyond. UV_COLOUR: (s, t, 0) less their whole parts. The
     * others are functions of the point in the space of the texture; CHECKERBOARD_3D takes floor(x) + floor(y) +
     * floor(z). */
    BIS_TEXTURE_BILERP, BIS_TEXTURE_DOTS, BIS_TEXTURE_FBM, BIS_TEXTURE_MARBLE, BIS_TEXTURE_UV_COLOUR,
    BIS_TEXTURE_WINDY, BIS_TEXTURE_WRINKLED,
    BIS_TEXTURE_PBRTS, /* the number of those before, which a scene names */
    BIS_TEXTURE_CHECKERBOARD_3D = BIS_TEXTURE_PBRTS,
    /* (1 - scale) x / (1 - scale x) of x = of[0] <= 1: what leaves a base below a coat */
    BIS_TEXTURE_COAT,
    BIS_TEXTURE_ALPHA, /* pbrt-v3's alpha of a roughness of[0] (bis_texture_alpha), and 1 at most, as bis has it */
} bis_texture_kind;
extern const char *const bis_texture_names[];

/* What an image is outside [0,1]: it goes on, its border goes on, or it is 0. */
typedef enum bis_wrap { BIS_WRAP_REPEAT, BIS_WRAP_CLAMP, BIS_WRAP_BLACK } bis_wrap;

/* Where (s, t) come from: the surface's (u, v), or the point, in the space of the texture. */
typedef enum bis_texture_mapping {
    BIS_TEXTURE_UV,          /* factor (u, v) + offset */
    BIS_TEXTURE_SPHERICAL,   /* (theta/pi, phi/(2 pi)) */
    BIS_TEXTURE_CYLINDRICAL, /* ((pi + atan2(y, x))/(2 pi), z) */
    BIS_TEXTURE_PLANAR       /* (x, y) */
} bis_texture_mapping;

typedef struct bis_texture {
    bis_texture_kind kind;
    /* the parts: textures of the list, all before this one, so that there are no cycles */
    uint32_t of[4];
    /* CONSTANT: its value. Else: a typical value, for those who plan. It is 0 only if the texture is 0 everywhere */
    rgbd value;
    bis_texture_mapping mapping; /* IMAGE, CHECKERBOARD, DOTS, BILERP, UV_COLOUR */
    double factor[2], offset[2];
    double from_world[3][4];     /* rows of an affine matrix, all below 1e100 */
    uint32_t image;  /* IMAGE: index into images */
    bis_wrap wrap;
    uint32_t octaves; /* FBM, WRINKLED, MARBLE: at most BIS_TEXTURE_MAX_OCTAVES, each `roughness` times the last */
    double roughness, variation; /* MARBLE: how far the noise bends the layers */
    double scale;    /* COAT: the share that is reflected back inside. MARBLE: of the point. IMAGE: multiplies, */
    bool invert;     /* and then 1 - it is taken */
    bool is_float;   /* IMAGE: the mean of its three channels */
    uint32_t steps;  /* textures that one value asks, this one included: at most BIS_TEXTURE_MAX_STEPS */
} bis_texture;

#define BIS_TEXTURE_MAX_STEPS 256
#define BIS_TEXTURE_MAX_OCTAVES 64 /* 1.99^64 = 1.3e19, beyond the digits of any point */
#define BIS_NO_TEXTURE UINT32_MAX

/* What the values of an image are taken for. */
typedef enum bis_image_meaning {
    BIS_IMAGE_COLOURS,   /* numbers are their mean */
    BIS_IMAGE_LUMINANCE, /* numbers of pbrt-v1 to v3: the luminance of what the file holds, made linear after it */
    BIS_IMAGE_ALPHA,     /* numbers of pbrt-v4: alpha, unless all of it is 1 */
    BIS_IMAGE_BUMP       /* map_Bump of an .mtl: heights, or a normal map */
} bis_image_meaning;

/* An image of the list. Textures of the same file, gamma and meaning share it. */
typedef struct bis_texture_file {
    char *filename; /* resolved path; owned */
    double gamma;   /* of a .png, see bis_image_read_colours */
    bis_loc loc;    /* the place of its name */
    bis_image_meaning meaning;
} bis_texture_file;

/* The textures of a material, each BIS_NO_TEXTURE where the material has a value of its own. */
typedef struct bis_material_textures {
    uint32_t Kd, Ks;
    uint32_t width; /* of what the model calls scene_name (bis_bsdf_width): an exponent, a roughness; */
    double power;   /* it is the texture's value to this power */
    bis_loc loc;
    uint32_t bump;    /* of numbers: the surface is displaced by so much along its normal */
    uint32_t normals; /* a normal map: an image of bis_textures.files */
} bis_material_textures;

/* What a material without textures has. */
#define BIS_NO_TEXTURES \
    ((bis_material_textures){.Kd = BIS_NO_TEXTURE, .Ks = BIS_NO_TEXTURE, .width = BIS_NO_TEXTURE, .power = 1, \
                             .bump = BIS_NO_TEXTURE, .normals = BIS_NO_TEXTURE})

/* What the parser makes. It owns what its pointers point to. */
typedef struct bis_textures {
    bis_texture *list;
    size_t n, capacity;
    bis_texture_file *files;
    size_t n_files, capacity_files;
    bis_material_textures *of_material; /* by the material's index; a material beyond the end has none */
    size_t n_of_material, capacity_of_material;
    bool cuts_off; /* --approximate: values outside of their range are cut off with a warning, and no error */
} bis_textures;

/* An image in memory, and the least and the largest value of each channel and of the channels' mean. */
typedef struct bis_texture_image {
    bis_image image;
    double lo[4], hi[4];
    bool holds_normals; /* it may, and does: a displacement by it is a normal map */
} bis_texture_image;

/* bis_texture_alpha returns what pbrt-v3's remapping makes of a roughness: a polynomial of its logarithm, which
 * grows with it. */
double bis_texture_alpha(double roughness);

/* bis_textures_clear frees everything. *t is empty afterwards. */
void bis_textures_clear(bis_textures *t);

/* The textures of a material, one after the other, for whatever concerns all of them. */
enum { BIS_MATERIAL_TEXTURES = 4 };
typedef struct bis_texture_slots {
    uint32_t of[BIS_MATERIAL_TEXTURES];
} bis_texture_slots;

/* bis_texture_slots_of returns them; normals is not among them, because it is an image and no texture. */
static inline bis_texture_slots bis_texture_slots_of(const bis_material_textures *m)
{
    return (bis_texture_slots){{m->Kd, m->Ks, m->width, m->bump}};
}

/* bis_textures_any returns whether a material has textures at all. */
static inline bool bis_textures_any(const bis_material_textures *m)
{
    const bis_texture_slots slots = bis_texture_slots_of(m);
    bool any = m->normals != BIS_NO_TEXTURE;

    for (int i = 0; i < BIS_MATERIAL_TEXTURES; i++) any |= slots.of[i] != BIS_NO_TEXTURE;
    return any;
}

/* bis_textures_of returns the textures of a material, or NULL if it has none. */
static inline const bis_material_textures *bis_textures_of(const bis_textures *t, uint32_t material)
{
    if (material >= t->n_of_material) return NULL;
    const bis_material_textures *m = &t->of_material[material];
    return bis_textures_any(m) ? m : NULL;
}

/* bis_textures_mark sets is_used[n_files] for the images that texture `texture` needs, bis_textures_mark_all for those
 * that a material needs. */
void bis_textures_mark(bool *is_used, const bis_textures *t, uint32_t texture);
void bis_textures_mark_all(bool *is_used, const bis_textures *t, const bis_material_textures *of);

/* bis_textures_load reads the image of a file of the list. One that may hold normals is looked at: if it does, its
 * values are linear whatever the gamma, and a warning says so. Errors: those of bis_image_read_colours; BIS_INPUT (a
 * value that is negative or not finite). */
bis_status bis_textures_load(bis_texture_image *image, const bis_texture_file *file, bis_diag *diag);

/* bis_textures_want_uv returns whether a value of these textures asks for (u, v). */
bool bis_textures_want_uv(const bis_textures *t, const bis_material_textures *of);

/* bis_textures_value returns the value of a texture at (u, v) and the point p of the world, all of which must be
 * finite. Images are interpolated between the centres of texels; t = 0 is the bottom of an image, as in pbrt.
 * images[t->n_files] must be loaded where the texture needs them. Nothing is cut off: see bis_textures_range. */
rgbd bis_textures_value(const bis_textures *t, const bis_texture_image *images, uint32_t texture, const double uv[2],
                        vec3 p);

/* bis_textures_range stores bounds of all values of a texture. They are attained by a constant and by an image with
 * BIS_WRAP_REPEAT or BIS_WRAP_CLAMP, and may be wider for textures that are made of others. */
void bis_textures_range(rgbd *lo, rgbd *hi, const bis_textures *t, const bis_texture_image *images, uint32_t texture);

/* bis_textures_check looks whether the textures of material *base stay in the ranges that constants have: Kd and Ks in
 * [0,1], the width in the range that the model states (bis_bsdf_width). It warns if Kd + Ks can exceed 1 and the model
 * then reflects more than it receives. Errors: BIS_INPUT, at the material (a range, unless t->cuts_off;
 * a model without `remake`). */
bis_status bis_textures_check(const bis_textures *t, const bis_texture_image *images, const bis_material_textures *of,
                              const bis_material *base, bis_diag *diag);

/* bis_textures_material returns material *base with the values of its textures at (u, v) and p. bis_textures_check must
 * have accepted them. */
bis_material bis_textures_material(const bis_textures *t, const bis_texture_image *images,
                                   const bis_material_textures *of, const bis_material *base, const double uv[2],
                                   vec3 p);
