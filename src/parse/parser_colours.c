/* SPDX-License-Identifier: BSD-2-Clause */
/* parser_colours: pbrt's other ways to say a colour: spectra, files of them, XYZ, black bodies; docs/scene-format.md,
 * "Colours".
 *
 * bis computes in RGB. What a spectrum becomes is what it looks like under D65 (src/parse/spectrum.h), and what lies
 * outside of RGB's colours is cut off with a warning. */
#include "bis/base/file.h"
#include "spectrum.h"
#include "approximate.h"
#include "base/grow.h"
#include "parser_ask.h"
#include "parser_colours.h"
#include "parser_version.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

/* ---- spectra ---- */

void bis_parser_spectrum_clear(bis_parser_spectrum *s)
{
    bis_free(s->own);
    *s = (bis_parser_spectrum){{NULL, 0}, NULL};
}

/* Are n numbers pairs of ascending wavelengths and values >= 0? */
static bool is_spectrum(const double (*v)[2], size_t n)
{
    for (size_t i = 0; i < n; i++) {
        if (!(v[i][0] > 0 && v[i][0] <= (double)FLT_MAX && v[i][1] >= 0 && v[i][1] <= (double)FLT_MAX)) return false;
        if (i > 0 && v[i][0] <= v[i - 1][0]) return false;
    }
    return n > 0;
}

static int compare_wavelengths(const void *a, const void *b)
{
    const double *x = a, *y = b;
    return (x[0] > y[0]) - (x[0] < y[0]);
}

/* pbrt-v1 to v3 sort what does not ascend; v4 refuses it. False: complained. */
static bool sort_pairs(bis_parser *p, double (*v)[2], size_t n, bis_loc at, const char *name)
{
    static const char kind[] = "a spectrum whose wavelengths descend", sorted[] = "sorted by wavelength";
    size_t i = 1;
    while (i < n && !(v[i][0] < v[i - 1][0])) i++;
    if (i >= n) return true;
    if (bis_parser_predates_v4(p)) bis_approximate_pass(p, at, "sorted by wavelength, as in pbrt-v1 to v3", kind);
    else if (!bis_approximate_or_refuse(p, at, kind, sorted, "the wavelengths of the spectrum \"%s\" descend from %g "
                                        "to %g: sort its pairs", name, v[i - 1][0], v[i][0]))
        return false;
    qsort(v, n, sizeof *v, compare_wavelengths);
    return true;
}

/* n numbers from v, or one that is the same everywhere. v NULL: what there is, is no spectrum. */
static bool keep_pairs(bis_parser *p, bis_parser_spectrum *s, const double *v, size_t n, bis_loc at, const char *name)
{
    const double constant[2] = {550, v ? v[0] : 0};
    if (v && n == 1) {
        v = constant;
        n = 2;
    }
    const bool are_pairs = v && n >= 2 && n % 2 == 0;
    s->own = are_pairs ? bis_alloc(n / 2, sizeof *s->own) : NULL;
    if (are_pairs && !s->own) return bis_parser_nomem(p, at);
    if (are_pairs) memcpy(s->own, v, n * sizeof *v);
    if (are_pairs && !sort_pairs(p, s->own, n / 2, at, name)) return false;
    if (!are_pairs || !is_spectrum((const double (*)[2])s->own, n / 2))
        return bis_parser_error(p, at, "the spectrum \"%s\" must be one number, or pairs of a wavelength in nm and a "
                                "value >= 0, wavelengths ascending", name);
    s->is = (bis_spectrum){(const double (*)[2])s->own, n / 2};
    return true;
}

/* pbrt's .spd: numbers between white space and commas, '#' to the end of a line. */
static bool read_spd(bis_parser *p, bis_parser_spectrum *s, const char *path, bis_loc at, const char *name)
{
    unsigned char *data = NULL;
    double *v = NULL;
    size_t size, n = 0, capacity = 0;
    const bis_status status = bis_file_read(&data, &size, path, at, p->diag);
    bis_parser_note(p, status);
    if (status) return false;
    bool ok = strlen((const char *)data) == size ||
              bis_parser_error(p, at, "%s is no spectrum: there is a zero byte in it", path);
    const char *c = (const char *)data + bis_byte_order_mark(data, size);
    while (ok && *c) {
        const char *end;
        c += strspn(c, " \t\r\n,");
        if (*c == '#') c += strcspn(c, "\r\n");
        if (!*c || *c == '\r' || *c == '\n') continue;
        if (!BIS_ROOM(v, capacity, n)) {
            ok = bis_parser_nomem(p, at);
            break;
        }
        v[n++] = bis_parse_double(c, &end);
        if (end == c || !strchr(" \t\r\n,#", *end))
            ok = bis_parser_error(p, at, "%s is no spectrum: its value %zu is no number", path, n);
        c = end;
    }
    ok = ok && keep_pairs(p, s, n == 1 ? NULL : v, n, at, name);
    bis_free(v);
    bis_free(data);
    return ok;
}

/* One of pbrt-v4's illuminants, by its name; bis has the constants of D65 alone. */
static bool is_illuminant(const bis_parser *p, const bis_param *param)
{
    if (!param || !param->is_strings || !param->n) return false;
    const char *name = bis_parser_text(p, p->params.strings[param->first]);
    return strncmp(name, "stdillum-", 9) == 0 || strncmp(name, "illum-", 6) == 0;
}

bool bis_params_spectrum(bis_parser *p, const char *name, bis_parser_spectrum *s)
{
    const bis_param *param = bis_params_take(p, name, BIS_TYPE_SPECTRUM, 0);
    *s = (bis_parser_spectrum){{NULL, 0}, NULL};
    if (!param) return false;
    if (!param->is_strings) return keep_pairs(p, s, p->params.numbers + param->first, param->n, param->at, name);
    const char *file = bis_parser_text(p, p->params.strings[param->first]);
    if (p->approximate && is_illuminant(p, param)) {
        static const double white = 1;
        bis_approximate_note(p, param->at, "white", "the illuminant \"%s\"", bis_parser_word(p, file));
        return keep_pairs(p, s, &white, 1, param->at, name);
    }
    char *path = bis_parser_path(p, param->at, file, NULL);
    const bool ok = path && !bis_parser_is_missing(p, path) && read_spd(p, s, path, param->at, name);
    bis_free(path);
    return ok;
}

/* ---- colours ---- */

static bool is_in_unit(double v) { return v >= 0 && v <= 1; }

rgb bis_parser_into_unit(bis_parser *p, rgbd c, const char *name, bis_loc at)
{
    const rgbd cut = {fmin(fmax(c.r, 0), 1), fmin(fmax(c.g, 0), 1), fmin(fmax(c.b, 0), 1)};
    /* the sums over wavelengths round: 1 + 2e-16 is no colour outside */
    const double one = 1 + 1e-12;
    if (!(is_in_unit(c.r / one) && is_in_unit(c.g / one) && is_in_unit(c.b / one)))
        bis_warn(p->diag, at, "\"%s\" is the colour (%.4g, %.4g, %.4g) of RGB; it is cut off to [0, 1]", name, c.r, c.g,
                 c.b);
    return rgbd_round(cut);
}

/* The temperature: with luminance 1, as in pbrt-v4; or pbrt-v1's to v3's temperature and scale, of the spectrum whose
 * peak is 1. The number of values says which, because neither reads the other's. */
static bool take_blackbody(bis_parser *p, const char *name, rgbd *c)
{
    static const bis_interval kelvins = {500, 1e6, false, false};
    const bis_param *param = bis_params_take(p, name, BIS_TYPE_BLACKBODY, 0);
    if (!param) return false;
    double *v = p->params.numbers + param->first;
    if (param->n > 2)
        return bis_parser_error(p, param->at, "\"blackbody %s\" has %zu values, must have one, the temperature in "
                                "kelvin, or as in pbrt-v3 two, the temperature and a factor", name, param->n);
    if (!bis_parser_in_range(p, param->at, name, &v[0], kelvins)) return false;
    *c = param->n == 1 ? bis_spectrum_blackbody(v[0]) : rgbd_scale(bis_spectrum_blackbody_peak(v[0]), v[1]);
    return true;
}

/* Of a light. pbrt-v4 divides by what the eye sees of it (SpectrumToPhotometric in src/pbrt/lights.cpp). */
static bool take_emitted(bis_parser *p, const char *name, rgbd *c)
{
    bis_parser_spectrum s;
    const bis_param *param = bis_params_find(p, name);
    const bis_loc at = bis_params_at(p, name);
    if (is_illuminant(p, param)) {
        const char *which = bis_parser_text(p, p->params.strings[param->first]);
        *c = (rgbd){1, 1, 1};
        bis_params_skip(p, &name, 1);
        return strcmp(which, "stdillum-D65") == 0 ||
               bis_approximate_or_refuse(p, at, "an illuminant that is not D65", "white", "the illuminant \"%s\" is "
                                         "not known; bis has \"stdillum-D65\"", bis_parser_word(p, which));
    }
    const bool is_before = bis_parser_is_before_v4(p, at, "a light's spectrum", "with luminance 1, and 0 outside of "
                                                   "its wavelengths", "as bright as its values are");
    const bool ok = bis_params_spectrum(p, name, &s);
    if (ok) *c = bis_spectrum_emitted(&s.is, !is_before && s.is.n > 1);
    bis_parser_spectrum_clear(&s);
    if (!ok || is_before) return ok;
    const double luminance = 0.2126729 * c->r + 0.7151522 * c->g + 0.0721750 * c->b; /* Y of bis_xyz_to_rgb */
    if (!(luminance > 0)) return bis_parser_error(p, at, "\"%s\" is a spectrum that no eye sees", name);
    *c = rgbd_scale(*c, 1 / luminance);
    return true;
}

/* A reflectance. */
bool bis_params_reflectance(bis_parser *p, const char *name, rgb *value)
{
    bis_param *param = bis_params_find(p, name);
    bis_parser_spectrum s;
    if (param && param->type == BIS_TYPE_SPECTRUM) {
        const bool ok = bis_params_spectrum(p, name, &s);
        if (ok) *value = bis_parser_into_unit(p, bis_spectrum_reflected(&s.is), name, param->at);
        bis_parser_spectrum_clear(&s);
        return ok;
    }
    if (param && param->type == BIS_TYPE_BLACKBODY) {
        rgbd c;
        if (!take_blackbody(p, name, &c)) return false;
        *value = bis_parser_into_unit(p, c, name, param->at);
        return true;
    }
    const bis_param *xyz = bis_params_take(p, name, BIS_TYPE_XYZ, 3);
    if (!xyz) return false;
    const double *v = p->params.numbers + xyz->first;
    *value = bis_parser_into_unit(p, bis_xyz_to_rgb(v[0], v[1], v[2]), name, xyz->at);
    return true;
}

bool bis_params_emission(bis_parser *p, const char *name, rgb *value)
{
    const bis_param *param = bis_params_find(p, name);
    rgbd c;
    if (!param) return false;
    if (param->type == BIS_TYPE_XYZ) {
        const bis_param *xyz = bis_params_take(p, name, BIS_TYPE_XYZ, 0);
        if (!xyz) return false;
        if (xyz->n != 3)
            return bis_parser_error(p, xyz->at, "\"%s\" has %zu values, must have 3", name, xyz->n);
        const double *v = p->params.numbers + xyz->first;
        c = bis_xyz_to_rgb(v[0], v[1], v[2]);
    } else if (param->type == BIS_TYPE_SPECTRUM) {
        if (!take_emitted(p, name, &c)) return false;
    } else if (!take_blackbody(p, name, &c)) {
        return false;
    }
    if (c.r < 0 || c.g < 0 || c.b < 0)
        bis_warn(p->diag, param->at, "\"%s\" is the colour (%.4g, %.4g, %.4g) of RGB; what is negative becomes 0", name,
                 c.r, c.g, c.b);
    *value = rgb_from(fmax(c.r, 0), fmax(c.g, 0), fmax(c.b, 0));
    if (rgb_is_finite(*value)) return true;
    *value = (rgb){1, 1, 1};
    return bis_parser_error(p, param->at, "\"%s\" is not finite as RGB", name);
}
