/* SPDX-License-Identifier: BSD-2-Clause */
/* pixel_files: the folder of `bis pixel`: three tables (RFC 4180: commas, a header, an empty field for what is not
 * known) and a page. */
#include "pixel_report.h"

#include "out/csv.h"

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

static bis_status path_of(char path[MAX_PATH], const bis_pixel_report *r, const char *name, bis_diag *diag)
{
    if (snprintf(path, MAX_PATH, "%s/%s", r->folder, name) < MAX_PATH) return BIS_OK;
    return bis_error(diag, BIS_IO, (bis_loc){0}, "\"%s\": the name of the folder is too long", r->folder);
}

static bis_status write_table(const bis_pixel_report *r, const char *name,
                              void (*write)(FILE *f, const bis_pixel_report *r), bis_diag *diag)
{
    char path[MAX_PATH];
    bis_outfile *out;
    bis_status status = path_of(path, r, name, diag);
    if (!status) status = bis_outfile_open(&out, path, diag);
    if (status) return status;
    write(bis_outfile_stream(out), r);
    return bis_outfile_commit(out, diag);
}

bis_status bis_pixel_write_files(const bis_pixel_report *r, bis_diag *diag)
{
    char path[MAX_PATH];
    bis_status status = write_table(r, "methods.csv", write_methods, diag);
    if (!status) status = write_table(r, "candidates.csv", write_candidates, diag);
    if (!status) status = write_table(r, "rays.csv", write_rays, diag);
    if (status || !r->html) return status;
    status = path_of(path, r, "pixel.html", diag);
    return status ? status : bis_pixel_write_page(path, r, diag);
}
