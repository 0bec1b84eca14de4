/* SPDX-License-Identifier: BSD-2-Clause */
/* flat: what all functions of flat share. Every loop over a caller's array checks its values, so a NaN ends here. */
#include "bis/flat/flat.h"

#include "base/text.h"
#include "bis/base/version.h"
#include "flat/say.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

const char *bis_flat_version(void) { return BIS_VERSION; }

/* ---- messages ---- */

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

bis_status bis_flat_refuse(bis_diag *diag, const char *fmt, ...)
{
    va_list args;

    va_start(args, fmt);
    bis_verror(diag, BIS_INPUT, nowhere, fmt, args);
    va_end(args);
    return BIS_INPUT;
}

/* ---- what callers give ---- */

bis_status bis_flat_given(const bis_flat_pointer *all, bis_diag *diag)
{
    while (all->name && (all->pointer || all->n == 0)) all++;
    if (!all->name) return BIS_OK;
    return bis_flat_refuse(diag, "%s is NULL: give what was opened, or an array", all->name);
}

bis_status bis_flat_numbers(size_t n, size_t k, const double *u, bis_diag *diag)
{
    for (size_t i = 0; i < n * k; i++) {
        if (u[i] >= 0 && u[i] < 1) continue;
        return bis_flat_refuse(diag, "u of sample %zu is %g: give random numbers in [0, 1)", i / k, u[i]);
    }
    return BIS_OK;
}

bis_status bis_flat_weights(size_t n, const double *w, bis_diag *diag)
{
    bool is_black = true;

    if (n == 0 || n > UINT32_MAX)
        return bis_flat_refuse(diag, "there are %zu weights: give 1 to %" PRIu32, n, UINT32_MAX);
    for (size_t i = 0; i < n; i++) {
        if (!(isfinite(w[i]) && w[i] >= 0))
            return bis_flat_refuse(diag, "weight %zu is %g: give finite numbers >= 0", i, w[i]);
        is_black &= w[i] == 0;
    }
    if (is_black) return bis_flat_refuse(diag, "all weights are 0: there is nothing to draw");
    return BIS_OK;
}

bis_status bis_flat_direction(vec3 *w, const float *all, size_t i, bis_diag *diag)
{
    const double x = (double)all[3 * i], y = (double)all[3 * i + 1], z = (double)all[3 * i + 2];
    const double most = fmax(fabs(x), fmax(fabs(y), fabs(z)));

    if (!(isfinite(x) && isfinite(y) && isfinite(z) && most > 0))
        return bis_flat_refuse(diag, "direction %zu is (%g, %g, %g): give finite vectors that are not 0", i, x, y, z);
    const double l = most * sqrt(x / most * (x / most) + y / most * (y / most) + z / most * (z / most));
    *w = vec3_from(x / l, y / l, z / l);
    return BIS_OK;
}

bis_status bis_flat_unit(vec3 *w, const char *name, const double *v, bis_diag *diag)
{
    const bool is_finite = isfinite(v[0]) && isfinite(v[1]) && isfinite(v[2]);
    const double most = fmax(fmax(fabs(v[0]), fabs(v[1])), fabs(v[2]));
    int e;

    if (!(is_finite && most > 0))
        return bis_flat_refuse(diag, "%s is (%g, %g, %g): give a finite vector that is not 0", name, v[0], v[1], v[2]);
    frexp(most, &e); /* a power of two changes no bit, but squares of 1e200 would be infinite, those of 1e-200 be 0 */
    const double x = ldexp(v[0], -e), y = ldexp(v[1], -e), z = ldexp(v[2], -e), l = sqrt(x * x + y * y + z * z);
    *w = vec3_from(x / l, y / l, z / l);
    return BIS_OK;
}

/* ---- arrays ---- */

bis_status bis_flat_look(bis_flat_looker *value_of, const void *handle, size_t n, const float *w, float *value,
                         double *pdf, bis_diag *diag)
{
    for (size_t i = 0; i < n; i++) {
        vec3 wi;
        const bis_status status = bis_flat_direction(&wi, w, i, diag);
        if (status) return status;
        const rgb v = value_of(handle, wi, &pdf[i]);
        memcpy(value + 3 * i, &v, 3 * sizeof *value);
    }
    return BIS_OK;
}

bis_status bis_flat_image_of(bis_image *image, int width, int height, int channels, const float *pixels,
                             bis_diag *diag)
{
    const bis_status status = bis_image_init(image, width, height, diag);

    for (size_t i = 0; !status && i < (size_t)width * (size_t)height; i++, pixels += channels)
        image->pixels[i] = (rgb){pixels[0], pixels[1], pixels[2]};
    return status;
}
