/* SPDX-License-Identifier: BSD-2-Clause */
/* parser_transform: the directives that change the current transformation matrix (CTM), as pbrt's: each is multiplied
 * from the right, so that the last one stands nearest to the object and acts on it first.
 *
 * Invariant: the CTM and its inverse are finite. A step that would break this is an error at its place, and is left
 * out. */
#include "base/grow.h"
#include "directives.h"

#include "bis/base/file.h"

#include <string.h>

/* Take n numbers. brackets: they may stand in [ ]. */
static bool take_numbers(bis_parser *p, const char *directive, double *v, int n, bool brackets)
{
    char buf[64];
    const bool open = brackets && p->token.kind == BIS_TOKEN_OPEN;
    if (open) bis_parser_advance(p);
    for (int i = 0; i < n; i++) {
        if (p->token.kind != BIS_TOKEN_NUMBER) {
            if (p->token.kind != BIS_TOKEN_BAD)
                bis_parser_error(p, p->token.at, "%s wants %d numbers, found %s after %d", directive, n,
                                 bis_token_name(buf, &p->token), i);
            p->lost = true;
            return false;
        }
        v[i] = p->token.number;
        bis_parser_advance(p);
    }
    if (open && p->token.kind != BIS_TOKEN_CLOSE)
        return bis_parser_lose(p, p->token.at, "%s wants ] after %d numbers, found %s", directive, n,
                               bis_token_name(buf, &p->token));
    if (open) bis_parser_advance(p);
    return true;
}

bool bis_parser_is_usable(const bis_xform *t)
{
    double sum = 0;
    for (int i = 0; i < 16; i++) sum += 0 * t->m[i / 4][i % 4] + 0 * t->inv[i / 4][i % 4];
    return sum == 0; /* NaN where any element is infinite or NaN */
}

/* --approximate: what is flat stays flat, whatever it is multiplied by: the shapes under it are left out. */
static bool flatten(bis_parser *p)
{
    p->now.is_flat |= p->approximate && !p->now.at_end;
    return p->approximate;
}

/* A camera may have a perspective matrix; shapes and lights have none. */
static void set(bis_parser *p, const char *directive, bis_loc at, const bis_xform *t)
{
    if (p->now.at_end) return; /* of a motion the start is shown */
    if (bis_parser_is_usable(t) && (!p->in_world || bis_xform_is_affine(t))) p->now.ctm = *t;
    else if (flatten(p)) return;
    else if (!bis_parser_is_usable(t))
        bis_parser_error(p, at, "%s makes the transformation singular or infinite", directive);
    else
        bis_parser_error(p, at, "%s makes a transformation with a perspective: the last row of its matrix is %g %g %g "
                         "%g, must be 0 0 0 1 (numbers 4, 8, 12, 16) for shapes and lights; with --approximate: the "
                         "shapes under it are left out", directive, t->m[3][0], t->m[3][1], t->m[3][2], t->m[3][3]);
}

static void concat(bis_parser *p, const char *directive, bis_loc at, const bis_xform *t)
{
    bis_xform product = bis_xform_compose(&p->now.ctm, t);
    set(p, directive, at, &product);
}

void bis_directive_identity(bis_parser *p, bis_loc at)
{
    (void)at;
    if (p->now.at_end) return;
    p->now.ctm = bis_xform_identity();
    p->now.is_flat = false;
}

void bis_directive_translate(bis_parser *p, bis_loc at)
{
    double v[3];
    if (!take_numbers(p, "Translate", v, 3, false)) return;
    bis_xform t = bis_xform_translate(v[0], v[1], v[2]);
    concat(p, "Translate", at, &t);
}

void bis_directive_scale(bis_parser *p, bis_loc at)
{
    double v[3];
    if (!take_numbers(p, "Scale", v, 3, false)) return;
    if (v[0] == 0 || v[1] == 0 || v[2] == 0) {
        if (flatten(p)) return;
        bis_parser_error(p, at, "Scale by 0 is singular: no factor may be 0; with --approximate: the shapes under it "
                         "are left out");
        return;
    }
    bis_xform t = bis_xform_scale(v[0], v[1], v[2]);
    concat(p, "Scale", at, &t);
}

void bis_directive_rotate(bis_parser *p, bis_loc at)
{
    double v[4];
    if (!take_numbers(p, "Rotate", v, 4, false)) return;
    if (v[1] == 0 && v[2] == 0 && v[3] == 0) {
        bis_parser_error(p, at, "Rotate about the axis 0 0 0, which has no direction");
        return;
    }
    bis_xform t = bis_xform_rotate(v[0], v[1], v[2], v[3]);
    concat(p, "Rotate", at, &t);
}

void bis_directive_look_at(bis_parser *p, bis_loc at)
{
    double v[9];
    bis_xform t;
    if (!take_numbers(p, "LookAt", v, 9, false)) return;
    if (!bis_xform_look_at(&t, v, v + 3, v + 6)) {
        bis_parser_error(p, at,
                         "LookAt wants an eye other than the point looked at, and an up vector not along the view");
        return;
    }
    if (!p->in_world) memcpy(p->up, v + 6, sizeof p->up);
    concat(p, "LookAt", at, &t);
}

static bool take_matrix(bis_parser *p, const char *directive, bis_loc at, bis_xform *t)
{
    double v[16];
    if (!take_numbers(p, directive, v, 16, true)) return false;
    if (bis_xform_from_columns(t, v)) return true;
    if (flatten(p)) return false;
    return bis_parser_error(p, at, "the matrix of %s is singular", directive);
}

void bis_directive_transform(bis_parser *p, bis_loc at)
{
    bis_xform t;
    if (!take_matrix(p, "Transform", at, &t)) return;
    if (!p->now.at_end) p->now.is_flat = false;
    set(p, "Transform", at, &t);
}

void bis_directive_concat_transform(bis_parser *p, bis_loc at)
{
    bis_xform t;
    if (take_matrix(p, "ConcatTransform", at, &t)) concat(p, "ConcatTransform", at, &t);
}

void bis_parser_name_system(bis_parser *p, const char *name, const bis_xform *t, bis_loc at)
{
    if (BIS_ROOM(p->systems, p->capacity_systems, p->n_systems) &&
        bis_names_set(&p->system_names, name, (uint32_t)p->n_systems))
        p->systems[p->n_systems++] = (bis_system){*t, p->now.is_flat};
    else bis_parser_nomem(p, at);
}

void bis_directive_coordinate_system(bis_parser *p, bis_loc at)
{
    if (!bis_parser_name(p, "CoordinateSystem")) return;
    bis_parser_name_system(p, bis_parser_text(p, p->name), &p->now.ctm, at);
}

void bis_directive_coord_sys_transform(bis_parser *p, bis_loc at)
{
    uint32_t i;
    if (!bis_parser_name(p, "CoordSysTransform")) return;
    const char *name = bis_parser_text(p, p->name);
    if (bis_names_find(&p->system_names, name, &i)) {
        if (!p->now.at_end) p->now.is_flat = p->systems[i].is_flat;
        set(p, "CoordSysTransform", at, &p->systems[i].ctm);
        return;
    }
    bis_parser_error(p, p->name_at, "coordinate system \"%s\" is not defined%s", bis_parser_word(p, name),
                     bis_parser_hint(p, bis_names_nearest(&p->system_names, name)));
}
