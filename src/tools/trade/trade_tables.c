/* SPDX-License-Identifier: BSD-2-Clause */
/* trade_tables: trade.csv, pareto.csv, equal_time.csv, equal_error.csv. Numbers are written so that they read back as
 * the same doubles; what is not known is an empty field. docs/command-line.md says what each column is. */
#include "trade_files.h"
#include "trade_stats.h"
#include "trade_tables.h"

#include "out/csv.h"

#include <string.h>

/* A comma before each; empty where the integrator has no such thing. */
static void put_parameters(FILE *out, const bis_trade_setting *s)
{
    static const char *const names[] = {"candidates", "shadowrays", "samples", "proposal"};
    char buf[32];

    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        const bis_parameter *p = bis_parameter_of(s->settings.integrator, names[i]);
        fprintf(out, ",%s", p ? bis_parameter_text(buf, p, bis_parameter_get(p, &s->settings)) : "");
    }
    BIS_CSV(out, s->area_exponent);
}

static void put_point(FILE *out, const bis_trade *t, const bis_trade_point *p)
{
    const bis_trade_setting *s = &t->plan.settings[p->setting];

    fprintf(out, "%s,%s", s->name, s->settings.integrator->name);
    put_parameters(out, s);
    BIS_CSV(out, p->passes, p->n, p->seconds, p->camera_rays, p->shadow_rays, p->candidates, p->rmse, p->relmse,
            p->relmse_se, p->noise, p->bias, p->bias_se, p->cost_variance);
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

const bis_trade_point *bis_trade_next_on_front(const bis_trade_result *r, const bis_trade_point *last)
{
    const bis_trade_point *next = NULL;
    for (int i = 0; i < r->n_points; i++) {
        const bis_trade_point *p = &r->points[i];
        const bool is_later = !last || p->seconds > last->seconds || (p->seconds == last->seconds && p > last);
        if (p->on_front && is_later && (!next || p->seconds < next->seconds)) next = p;
    }
    return next;
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
    BIS_CSV(out, c->cost_variance, c->cost_variance_se, c->slope, c->slope_se);
}

/* What a setting comes to at some time, or for some error: bis_trade_error_at, bis_trade_seconds_to. */
typedef double reach(const bis_trade_result *r, const bis_trade_plan *p, int setting, double at, bool *extrapolated);

/* Pairs of columns: one for each of at[n], which stands in the heading between two words. */
typedef struct columns {
    const char *before, *after;
    int digits, n;
    const double *at;
    reach *value;
} columns;

/* A row a setting. No two columns have one name. */
static void put_curves(FILE *out, const bis_trade *t, const columns *c)
{
    fputs("setting,cost_variance,cost_variance_se,slope,slope_se", out);
    for (int k = 0; k < c->n; k++)
        fprintf(out, ",%s%.*g%s,%s%.*g%s_extrapolated", c->before, c->digits, c->at[k], c->after, c->before, c->digits,
                c->at[k], c->after);
    fputc('\n', out);
    for (int i = 0; i < t->plan.n_settings; i++) {
        if (!t->result.curves[i].n) continue;
        put_curve(out, t, i);
        for (int k = 0; k < c->n; k++) {
            bool extrapolated;
            BIS_CSV(out, c->value(&t->result, &t->plan, i, c->at[k], &extrapolated));
            fprintf(out, ",%d", extrapolated);
        }
        fputc('\n', out);
    }
}

static void put_equal_time(FILE *out, const bis_trade *t)
{
    double seconds[BIS_TRADE_COLUMNS];
    const int n = bis_trade_times(t, seconds);

    put_curves(out, t, &(columns){"error_at_", "s", 4, n, seconds, bis_trade_error_at});
}

static void put_equal_error(FILE *out, const bis_trade *t)
{
    double error[BIS_TRADE_COLUMNS];
    const int n = bis_trade_errors(t, error);

    put_curves(out, t, &(columns){"seconds_to_", "", 6, n, error, bis_trade_seconds_to});
}

bis_status bis_trade_write_tables(const bis_trade *t, bis_diag *diag)
{
    bis_status status = bis_trade_write(t, "trade.csv", put_trade, diag);
    if (!status) status = bis_trade_write(t, "pareto.csv", put_pareto, diag);
    if (!status) status = bis_trade_write(t, "equal_time.csv", put_equal_time, diag);
    if (!status) status = bis_trade_write(t, "equal_error.csv", put_equal_error, diag);
    return status;
}
