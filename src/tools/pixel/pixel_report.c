/* SPDX-License-Identifier: BSD-2-Clause */
/* pixel_report: text and JSON of `bis pixel`. Both say the same; what is not known is "-" or null. */
#include "pixel_report.h"

#include "tools/describe.h"

#include <string.h>

void bis_pixel_report_clear(bis_pixel_report *r)
{
    if (!r) return;
    bis_pixel_candidates_clear(&r->candidates);
    for (size_t i = 0; i < r->n_methods; i++) bis_pixel_rays_clear(&r->rays[i]);
}

static const char *kind_of(const bis_shape_desc *s)
{
    static const char *const kinds[] = {[BIS_SHAPE_PLY] = "plymesh",
                                        [BIS_SHAPE_OBJ] = "objmesh",
                                        [BIS_SHAPE_TRIANGLES] = "trianglemesh",
                                        [BIS_SHAPE_SPHERE] = "sphere",
                                        [BIS_SHAPE_DISK] = "disk"};
    return kinds[s->kind];
}

/* NULL for a shape that comes from no file. */
static const char *file_of(const bis_pixel_report *r)
{
    const bis_shape_desc *s = &r->desc->shapes[r->hit.shape];
    return s->kind == BIS_SHAPE_PLY || s->kind == BIS_SHAPE_OBJ ? r->desc->meshes[s->mesh].filename : NULL;
}

static bool is_mesh(const bis_pixel_report *r)
{
    const bis_shape_kind kind = r->desc->shapes[r->hit.shape].kind;
    return bis_shape_is_mesh(kind);
}

/* What the camera sees where there is no surface. */
static rgb background(const bis_pixel_report *r)
{
    return bis_light_seen(&r->desc->light, r->scene->light, r->hit.eye.d);
}

static bool has_samples(const bis_settings *s)
{
    return bis_parameter_of(s->integrator, "samples") != NULL;
}

/* ---- text ---- */

/* Beyond, tails at 3 standard errors are off by more than exp(0.1 3^3/6), a factor of 1.6. */
static const double too_skew = 0.1;

static void print_vector(FILE *out, const char *name, vec3 v, const bis_pixel_report *r, bool direction)
{
    fprintf(out, "%-12s(%.6g %.6g %.6g)", name, (double)v.x, (double)v.y, (double)v.z);
    if (direction) {
        const bis_pixel_direction d = bis_pixel_direction_of(&r->desc->light.to_world, v);
        fprintf(out, "   in the map: theta %.2f, phi %.2f degrees", d.theta, d.phi);
    }
    putc('\n', out);
}

static void print_hit(FILE *out, const bis_pixel_report *r)
{
    const bis_shape_desc *s = &r->desc->shapes[r->hit.shape];
    const bis_material *m = r->hit.material;
    const char *file = file_of(r);
    char material[64];

    fprintf(out, "shape       %s", kind_of(s));
    if (file) fprintf(out, " \"%s\"", file);
    fprintf(out, " of line %d", s->loc.line);
    if (is_mesh(r)) fprintf(out, ", triangle %zu", r->hit.part);
    fprintf(out, "; %.6g from the eye\n", r->hit.t);
    print_vector(out, "point", r->pt.p, r, false);
    print_vector(out, "normal", r->pt.n, r, true);
    if (memcmp(&r->pt.n, &r->pt.ng, sizeof r->pt.n) != 0) print_vector(out, "of the face", r->pt.ng, r, true);
    print_vector(out, "to the eye", r->pt.wo, r, true);
    print_vector(out, "mirrored", r->pt.bsdf.r, r, true);
    fprintf(out, "material    %s, Kd (%.4g %.4g %.4g), Ks (%.4g %.4g %.4g); seen at %.2f degrees\n",
            bis_pixel_material_name(material, m), (double)m->Kd.r, (double)m->Kd.g, (double)m->Kd.b, (double)m->Ks.r,
            (double)m->Ks.g, (double)m->Ks.b,
            atan2(length(cross(r->pt.n, r->pt.wo)), dot(r->pt.n, r->pt.wo)) * 180 / PI);
}

static void print_value(FILE *out, const char *name, const bis_pixel_value *v)
{
    fprintf(out, "%-12s%.6g +- %.1g   (%.6g %.6g %.6g)\n", name, v->mean[3], v->se[3], v->mean[0], v->mean[1],
            v->mean[2]);
}

static void print_exact(FILE *out, const bis_pixel_report *r)
{
    const bis_pixel_exact *e = &r->exact;
    fprintf(out, "\nreflected radiance, r+g+b and (r g b), ");
    if (e->by_patches)
        fprintf(out, "by %zu rays, at least 2 in each patch above the horizon, of %zu\n", e->rays, e->patches);
    else fprintf(out, "by %d runs of mis; %zu patches are too many for their sum\n", BIS_PIXEL_MIS_RUNS, e->patches);
    print_value(out, "exact", &e->lit);
    print_value(out, "unoccluded", &e->open);
    if (e->open.mean[3] > 0) fprintf(out, "seen        %.2f %%\n", 100 * e->lit.mean[3] / e->open.mean[3]);
    else fputs("seen        -\n", out); /* no light to be seen */
}

static void print_percent(FILE *out, double x)
{
    if (isfinite(x)) fprintf(out, " %10.3g %%", 100 * x);
    else fprintf(out, " %12s", "-");
}

bool bis_pixel_is_too_skew(const bis_pixel_method *m)
{
    return fabs(m->skewness) > too_skew || fabs(m->true_skewness) > too_skew; /* false for NAN */
}

static void print_methods(FILE *out, const bis_pixel_report *r)
{
    fprintf(out, "\n%-16s %9s %11s %10s %8s %8s %12s %8s\n", "method", "draws", "mean", "+-", "of exact", "z",
            "error of one", "rays");
    for (size_t i = 0; i < r->n_methods; i++) {
        const bis_pixel_method *m = &r->methods[i];
        const double truth = (m->is_open ? &r->exact.open : &r->exact.lit)->mean[3];
        char draws[32];
        if (has_samples(&m->settings)) snprintf(draws, sizeof draws, "%u", (unsigned)m->settings.samples);
        else if (m->is_open) snprintf(draws, sizeof draws, "%u", (unsigned)m->settings.candidates);
        else snprintf(draws, sizeof draws, "%u/%u", (unsigned)m->settings.shadowrays, (unsigned)m->settings.candidates);
        fprintf(out, "%-16s %9s %11.6g %10.2g", m->name, draws, m->L.mean[3], m->L.se[3]);
        if (truth > 0) fprintf(out, " %8.4f", m->L.mean[3] / truth);
        else fprintf(out, " %8s", "-");
        if (isfinite(m->z)) fprintf(out, " %7.2f%c", m->z, bis_pixel_is_too_skew(m) ? '?' : ' ');
        else fprintf(out, " %8s", "-");
        print_percent(out, m->error);
        fprintf(out, " %8.4g\n", m->rays);
    }
    fprintf(
        out,
        "Means of %u estimates; z: the difference from exact (unoccluded: from that) in standard errors; error of one: "
        "the\n"
        "root mean square difference of a single estimate from exact; rays: cast by one. z with a ?: rare and bright "
        "estimates\n"
        "make the mean too skew for its standard error, which misses what has not been hit: ask for more --repeats.\n",
        (unsigned)r->methods[0].repeats);
}

static void print_candidates(FILE *out, const bis_pixel_report *r)
{
    const bis_pixel_candidates *c = &r->candidates;
    fprintf(out, "\none estimate by sir\n");
    fprintf(out, "candidates  %u drawn", (unsigned)c->M);
    if (isfinite(c->share_em))
        fprintf(out, ", %u from the map, %u from the BRDF", (unsigned)c->n_map, (unsigned)(c->M - c->n_map));
    fprintf(out, "; %u weigh something\n", (unsigned)c->positive);
    if (c->W <= 0) return;
    fprintf(out, "weights     sum %.6g, mean %.6g (estimates %.6g); the largest is %.3g %% of all\n", c->W,
            c->W / c->M, r->exact.open.mean[3], 100 * c->largest);
    fprintf(out, "effective   sample size %.4g = (sum w)^2 / sum w^2\n", c->ess);
    fprintf(out, "chosen      %u rays at %u candidates, %u of them see the light\n", (unsigned)c->N,
            (unsigned)c->distinct, (unsigned)c->seen);
    fprintf(out, "estimate    %.6g   (%.6g %.6g %.6g)\n", rgbd_sum(c->L), c->L.r, c->L.g, c->L.b);
}

void bis_pixel_print_text(FILE *out, const bis_pixel_report *r)
{
    fprintf(out, "pixel       (%d, %d) of %d x %d, %s\n", r->x, r->y, r->desc->view.film.width,
            r->desc->view.film.height, r->desc->path);
    if (r->is_hit) print_hit(out, r);
    if (r->why_nothing) {
        const rgb L = r->is_hit ? (rgb){0, 0, 0} : background(r);
        fprintf(out, "nothing     %s\nradiance    (%.6g %.6g %.6g)%s\n", r->why_nothing, (double)L.r, (double)L.g,
                (double)L.b, r->is_hit ? "" : ", the light's own");
        return;
    }
    print_exact(out, r);
    print_methods(out, r);
    print_candidates(out, r);
    fprintf(out, "\nwritten     %s/%smethods.csv candidates.csv rays.csv\n", r->folder, r->html ? "pixel.html " : "");
}

/* ---- JSON ---- */

static void json_vector(bis_json *j, const char *key, vec3 v)
{
    bis_json_triple(j, key, (double)v.x, (double)v.y, (double)v.z);
}

static void json_colour(bis_json *j, const char *key, rgb c)
{
    bis_json_triple(j, key, (double)c.r, (double)c.g, (double)c.b);
}

static void json_hit(bis_json *j, const bis_pixel_report *r)
{
    if (!r->is_hit) {
        bis_json_null(j, "hit");
        return;
    }
    bis_json_open(j, "hit", '{');
    bis_json_text(j, "shape", kind_of(&r->desc->shapes[r->hit.shape]));
    bis_json_text(j, "file", file_of(r));
    BIS_JSON_NUMBERS(j, {"line", r->desc->shapes[r->hit.shape].loc.line},
                     {"triangle", is_mesh(r) ? (double)r->hit.part : (double)NAN}, {"distance", r->hit.t});
    json_vector(j, "point", r->pt.p);
    json_vector(j, "normal", r->pt.n);
    json_vector(j, "geometric_normal", r->pt.ng);
    json_vector(j, "wo", r->pt.wo);
    json_vector(j, "mirrored", r->pt.bsdf.r);
    bis_json_number(j, "cos_wo", dot(r->pt.n, r->pt.wo));
    const bis_bsdf_width w = r->hit.material->model->width(r->hit.material);
    bis_json_open(j, "material", '{');
    bis_json_text(j, "model", r->hit.material->model->name);
    json_colour(j, "Kd", r->hit.material->Kd);
    json_colour(j, "Ks", r->hit.material->Ks);
    const bool has_exponent = strcmp(w.name, "exponent") == 0, has_alpha = strcmp(w.name, "alpha") == 0;
    BIS_JSON_NUMBERS(j, {"exponent", has_exponent ? w.value : (double)NAN},
                     {"alpha", has_alpha ? w.value : (double)NAN}, {"p_specular", r->pt.bsdf.p_specular});
    if (w.scene_name && !has_exponent && !has_alpha) bis_json_number(j, w.name, w.value); /* of a model of one's own */
    bis_json_close(j);
    bis_json_close(j);
}

static void json_value(bis_json *j, const bis_pixel_value *v)
{
    bis_json_triple(j, "radiance", v->mean[0], v->mean[1], v->mean[2]);
    bis_json_triple(j, "standard_error", v->se[0], v->se[1], v->se[2]);
    BIS_JSON_NUMBERS(j, {"sum", v->mean[3]}, {"sum_standard_error", v->se[3]});
}

static void json_exact(bis_json *j, const bis_pixel_exact *e)
{
    bis_json_open(j, "exact", '{');
    bis_json_text(j, "by", e->by_patches ? "patches" : "mis");
    bis_json_count(j, "patches", e->patches);
    json_value(j, &e->lit);
    bis_json_close(j);
    bis_json_open(j, "unoccluded", '{');
    json_value(j, &e->open);
    bis_json_close(j);
}

static void json_method(bis_json *j, const bis_pixel_method *m)
{
    const bool by_samples = has_samples(&m->settings);
    bis_json_open(j, NULL, '{');
    bis_json_text(j, "method", m->name);
    bis_json_text(j, "claim", m->settings.integrator->claim);
    BIS_JSON_NUMBERS(j, {"samples", by_samples ? m->settings.samples : (double)NAN},
                     {"candidates", by_samples ? (double)NAN : m->settings.candidates},
                     {"shadowrays", by_samples || m->is_open ? (double)NAN : m->settings.shadowrays},
                     {"repeats", m->repeats});
    json_value(j, &m->L);
    BIS_JSON_NUMBERS(j, {"z", m->z}, {"skewness", m->skewness}, {"relative_error", m->error}, {"rays", m->rays},
                     {"accepted", bis_parameter_of(m->settings.integrator, "estimator") ? m->accepted : (double)NAN});
    bis_json_close(j);
}

static void json_candidates(bis_json *j, const bis_pixel_candidates *c)
{
    bis_json_open(j, "candidates", '{');
    BIS_JSON_NUMBERS(j, {"drawn", c->M}, {"share_of_map", c->share_em}, {"positive", c->positive}, {"weights", c->W},
                     {"squared_weights", c->square_sum}, {"effective_sample_size", c->ess},
                     {"largest_share", c->largest}, {"shadowrays", c->N}, {"distinct", c->distinct},
                     {"seen", c->seen});
    bis_json_triple(j, "estimate", c->L.r, c->L.g, c->L.b);
    bis_json_triple(j, "estimate_unoccluded", c->L_ns.r, c->L_ns.g, c->L_ns.b);
    bis_json_close(j);
}

void bis_pixel_put_report(bis_json *j, const bis_pixel_report *r)
{
    bis_json_text(j, "scene", r->desc->path);
    BIS_JSON_NUMBERS(j, {"x", r->x}, {"y", r->y}, {"width", r->desc->view.film.width},
                     {"height", r->desc->view.film.height});
    bis_json_count(j, "seed", r->desc->view.sampler.seed);
    json_hit(j, r);
    bis_json_text(j, "nothing", r->why_nothing);
    if (r->why_nothing) {
        json_colour(j, "radiance", r->is_hit ? (rgb){0, 0, 0} : background(r));
        return;
    }
    json_exact(j, &r->exact);
    bis_json_open(j, "methods", '[');
    for (size_t i = 0; i < r->n_methods; i++) json_method(j, &r->methods[i]);
    bis_json_close(j);
    json_candidates(j, &r->candidates);
    bis_json_text(j, "folder", r->folder);
}

void bis_pixel_print_json(FILE *out, const bis_pixel_report *r)
{
    bis_json j = {.out = out};
    bis_json_open(&j, NULL, '{');
    bis_pixel_put_report(&j, r);
    bis_json_close(&j);
}
