/* trade_tables: trade.csv, pareto.csv, equal_time.csv, equal_error.csv. Numbers are written so that they read back as
 * the same doubles; what is not known is an empty field. docs/command-line.md says what each column is. */
#include "trade.h"

#include "bis/base/file.h"

#include <string.h>

static void put_number(FILE *out, double v)
{
    char text[32];
    if (isfinite(v)) fputs(bis_format_double(text, v), out);
}

/* A comma, then the number. */
static void put(FILE *out, double v)
{
    fputc(',', out);
    put_number(out, v);
}

/* A comma before each; empty where the integrator has no such thing. */
static void put_parameters(FILE *out, const bis_trade_setting *s)
{
    static const char *const names[] = {"candidates", "shadowrays", "samples", "proposal"};
    char buf[32];

    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        const bis_parameter *p = bis_parameter_of(s->settings.integrator, names[i]);
        fprintf(out, ",%s", p ? bis_parameter_text(buf, p, bis_parameter_get(p, &s->settings)) : "");
    }
    put(out, s->area_exponent);
}

static void put_point(FILE *out, const bis_trade *t, const bis_trade_point *p)
{
    const bis_trade_setting *s = &t->plan.settings[p->setting];
    const double values[] = {p->passes,     p->n,       p->seconds,      p->camera_rays, p->shadow_rays,
                             p->candidates, p->rmse,    p->relmse,       p->relmse_se,   p->noise,
                             p->bias,       p->bias_se, p->cost_variance};

    fprintf(out, "%s,%s", s->name, s->settings.integrator->name);
    put_parameters(out, s);
    for (size_t i = 0; i < sizeof values / sizeof *values; i++) put(out, values[i]);
    fprintf(out, ",%d\n", p->on_front);
}

static const char points_header[] = "setting,integrator,candidates,shadowrays,samples,proposal,areaexponent,passes,"
                                    "seeds,seconds,camera_rays,shadow_rays,"
                                    "candidates_drawn,rmse,relmse,relmse_se,noise,bias,bias_se,cost_variance,pareto\n";

static void put_trade(FILE *out, const bis_trade *t)
{
    fputs(points_header, out);
    for (int i = 0; i < t->result.n_points; i++) put_point(out, t, &t->result.points[i]);
}

/* In the order of time. */
static void put_pareto(FILE *out, const bis_trade *t)
{
    fputs(points_header, out);
    for (const bis_trade_point *p = NULL; (p = bis_trade_next_on_front(&t->result, p));) put_point(out, t, p);
}

static void put_curve(FILE *out, const bis_trade *t, int i)
{
    const bis_trade_curve *c = &t->result.curves[i];
    fputs(t->plan.settings[i].name, out);
    put(out, c->cost_variance);
    put(out, c->cost_variance_se);
    put(out, c->slope);
    put(out, c->slope_se);
}

/* What a setting comes to at some time, or for some error: bis_trade_error_at, bis_trade_seconds_to. */
typedef double reach(const bis_trade_result *r, const bis_trade_plan *p, int setting, double at, bool *extrapolated);

/* A row a setting, a pair of columns for each of at[n], which stands in the heading between two words; no two columns
 * have one name. */
static void put_curves(FILE *out, const bis_trade *t, const char *before, int digits, const char *after,
                       const double *at, int n, reach *value)
{
    fputs("setting,cost_variance,cost_variance_se,slope,slope_se", out);
    for (int k = 0; k < n; k++)
        fprintf(out, ",%s%.*g%s,%s%.*g%s_extrapolated", before, digits, at[k], after, before, digits, at[k], after);
    fputc('\n', out);
    for (int i = 0; i < t->plan.n_settings; i++) {
        if (!t->result.curves[i].n) continue;
        put_curve(out, t, i);
        for (int k = 0; k < n; k++) {
            bool extrapolated;
            put(out, value(&t->result, &t->plan, i, at[k], &extrapolated));
            fprintf(out, ",%d", extrapolated);
        }
        fputc('\n', out);
    }
}

static void put_equal_time(FILE *out, const bis_trade *t)
{
    double seconds[BIS_TRADE_COLUMNS];
    const int n = bis_trade_times(t, seconds);

    put_curves(out, t, "error_at_", 4, "s", seconds, n, bis_trade_error_at);
}

static void put_equal_error(FILE *out, const bis_trade *t)
{
    double error[BIS_TRADE_COLUMNS];
    const int n = bis_trade_errors(t, error);

    put_curves(out, t, "seconds_to_", 6, "", error, n, bis_trade_seconds_to);
}

static bis_status write_table(const bis_trade *t, const char *name, void (*put_rows)(FILE *, const bis_trade *),
                              bis_diag *diag)
{
    char path[4096];
    bis_outfile *file;
    bis_status status = bis_outfile_open(&file, bis_trade_path(path, t, name), diag);

    if (status) return status;
    put_rows(bis_outfile_stream(file), t);
    return bis_outfile_commit(file, diag);
}

bis_status bis_trade_write_tables(const bis_trade *t, bis_diag *diag)
{
    static const struct {
        const char *name;
        void (*put_rows)(FILE *, const bis_trade *);
    } tables[] = {{"trade.csv", put_trade},
                  {"pareto.csv", put_pareto},
                  {"equal_time.csv", put_equal_time},
                  {"equal_error.csv", put_equal_error}};
    bis_status status = BIS_OK;

    for (int i = 0; i < 4 && !status; i++) status = write_table(t, tables[i].name, tables[i].put_rows, diag);
    return status;
}
