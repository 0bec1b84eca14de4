/* SPDX-License-Identifier: BSD-2-Clause */
/* pixel_files: the folder of `bis pixel`: two drawings and three tables (RFC 4180: commas, a header, an empty field for
 * what is not known). */
#include "pixel_report.h"

#include "out/csv.h"

#include <string.h>

enum { MAX_PATH = 4096 };

/* ---- tables ---- */

static void put_direction(FILE *f, const bis_pixel_report *r, vec3 w)
{
    const bis_pixel_direction d = bis_pixel_direction_of(&r->desc->light.to_world, w);
    BIS_CSV(f, d.theta, d.phi, (double)w.x, (double)w.y, (double)w.z);
}

static void put_value(FILE *f, const bis_pixel_value *v)
{
    bis_csv_numbers(f, v->mean, 4);
    bis_csv_numbers(f, v->se, 4);
}

static void write_methods(FILE *f, const bis_pixel_report *r)
{
    fputs("method,repeats,r,g,b,sum,se_r,se_g,se_b,se_sum,z,skewness,relative_error,rays,accepted\nexact,", f);
    put_value(f, &r->exact.lit);
    fputs(",,,,,\nwithout visibility,", f);
    put_value(f, &r->exact.open);
    fputs(",,,,,\n", f);
    for (size_t i = 0; i < r->n_methods; i++) {
        const bis_pixel_method *m = &r->methods[i];
        fprintf(f, "%s,%u", m->name, (unsigned)m->repeats);
        put_value(f, &m->L);
        BIS_CSV(f, m->z, m->skewness, m->error, m->rays,
                bis_parameter_of(m->settings.integrator, "estimator") ? m->accepted : (double)NAN);
        fputc('\n', f);
    }
}

static void write_candidates(FILE *f, const bis_pixel_report *r)
{
    const bis_pixel_candidates *c = &r->candidates;
    fputs("candidate,from,theta_deg,phi_deg,x,y,z,q_map,q_brdf,q,product,weight,share,chosen,seen\n", f);
    for (uint32_t i = 0; i < c->M; i++) {
        const bis_pixel_candidate *q = &c->c[i];
        fprintf(f, "%u,%s", (unsigned)i, isnan(c->share_em) ? "" : q->from_map ? "map" : "brdf");
        if (q->w > 0) put_direction(f, r, q->wi);
        else fputs(",,,,,", f);
        BIS_CSV(f, q->q_L, q->q_f, q->q, q->product, q->w, c->W > 0 ? q->w / c->W : 0);
        fprintf(f, ",%u,%s\n", (unsigned)q->chosen, q->chosen == 0 ? "" : q->seen ? "1" : "0");
    }
}

static void write_rays(FILE *f, const bis_pixel_report *r)
{
    fputs("method,sample,theta_deg,phi_deg,x,y,z,q_map,q_brdf,product,seen\n", f);
    for (size_t i = 0; i < r->n_methods; i++) {
        for (size_t k = 0; k < r->rays[i].n; k++) {
            const bis_pixel_ray *q = &r->rays[i].ray[k];
            fprintf(f, "%s,%u", r->methods[i].name, (unsigned)q->run);
            put_direction(f, r, q->wi);
            BIS_CSV(f, bis_light_pdf(r->pt.light, q->wi), bis_bsdf_pdf(&r->pt.bsdf, q->wi),
                    bis_pixel_product(&r->pt, q->wi));
            fprintf(f, ",%d\n", q->seen);
        }
    }
}

static bis_status open_file(bis_outfile **out, const bis_pixel_report *r, const char *name, bis_diag *diag)
{
    char path[MAX_PATH];
    if (snprintf(path, MAX_PATH, "%s/%s", r->folder, name) < MAX_PATH) return bis_outfile_open(out, path, diag);
    return bis_error(diag, BIS_IO, (bis_loc){0}, "\"%s\": the name of the folder is too long", r->folder);
}

static bis_status write_table(const bis_pixel_report *r, const char *name,
                              void (*write)(FILE *f, const bis_pixel_report *r), bis_diag *diag)
{
    bis_outfile *out;
    const bis_status status = open_file(&out, r, name, diag);
    if (status) return status;
    write(bis_outfile_stream(out), r);
    return bis_outfile_commit(out, diag);
}

/* ---- pictures ---- */

static const char *file_name(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

static bis_status write_pictures(const bis_pixel_report *r, bis_diag *diag)
{
    const bis_material *m = r->hit.material;
    const char *map = r->desc->light.filename ? file_name(r->desc->light.filename) : "a constant light";
    char title[160], subtitle[240], material[64];

    snprintf(title, sizeof title, "Pixel (%d, %d) of %.80s", r->x, r->y, file_name(r->desc->path));
    snprintf(subtitle, sizeof subtitle,
             "under %.80s; %s, Ks %.3g, Kd %.3g (means of r, g, b), seen at %.1f degrees", map,
             bis_pixel_material_name(material, m), rgb_sum(m->Ks) / 3, rgb_sum(m->Kd) / 3,
             atan2(length(cross(r->pt.n, r->pt.wo)), dot(r->pt.n, r->pt.wo)) * 180 / PI);
    const bis_pixel_figure figure = {
        .title = title,
        .subtitle = subtitle,
        .pt = &r->pt,
        .exact = &r->exact,
        .light_to_world = &r->desc->light.to_world,
        .candidates = &r->candidates,
        .methods = r->methods,
        .rays = r->rays,
        .n_methods = r->n_methods,
    };
    bis_outfile *densities = NULL, *samples = NULL;
    bis_status status = open_file(&densities, r, "densities.svg", diag);
    if (!status) status = open_file(&samples, r, "samples.svg", diag);
    if (!status)
        status = bis_pixel_figures(bis_outfile_stream(densities), bis_outfile_stream(samples), &figure, diag);
    if (!status) {
        status = bis_outfile_commit(densities, diag);
        densities = NULL;
    }
    if (!status) return bis_outfile_commit(samples, diag);
    bis_outfile_abort(densities);
    bis_outfile_abort(samples);
    return status;
}

bis_status bis_pixel_write_files(const bis_pixel_report *r, bis_diag *diag)
{
    bis_status status = write_table(r, "methods.csv", write_methods, diag);
    if (!status) status = write_table(r, "candidates.csv", write_candidates, diag);
    if (!status) status = write_table(r, "rays.csv", write_rays, diag);
    return status ? status : write_pictures(r, diag);
}
