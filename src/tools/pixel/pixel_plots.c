/* SPDX-License-Identifier: BSD-2-Clause */
/* pixel_plots: figures 4.1 and 4.2 of the thesis for one point, as the map sees directions: a lat-long plot of the
 * whole sphere in the light's frame.
 *
 * A place of the plot is the mean of a density over a few directions in it, as many as the map has pixels there (at
 * most 8 x 8), so that a lamp of one pixel is not missed. All densities are per steradian and share one logarithmic
 * scale: where the product is brighter than a proposal, the proposal draws too little. What is below the scale is
 * black. Shadow rays are dots on the product. */
#include "pixel.h"

#include "bis/base/mem.h"

#include "out/palette.h"
#include "out/svg.h"

#include <float.h>
#include <string.h>

enum { WIDTH = BIS_PIXEL_PLOT_WIDTH, HEIGHT = BIS_PIXEL_PLOT_HEIGHT, PLACES = WIDTH * HEIGHT };
enum { MAX_SUB = 8, DECADES = 7 };
enum { LEFT = 56, TOP = 84, RIGHT = 40, GAP_X = 64, GAP_Y = 70, BOTTOM = 66, BAR = 96, COLUMNS = 2 };

/* ---- directions ---- */

static vec3 direction_at(const bis_xform *light_to_world, double theta, double phi)
{
    const vec3 w = vec3_from(sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta));
    return normalize(bis_xform_vector(light_to_world, w));
}

bis_pixel_direction bis_pixel_angles(vec3 w)
{
    const double phi = atan2((double)w.y, (double)w.x) * 180 / PI;
    const double theta = atan2(hypot((double)w.x, (double)w.y), (double)w.z) * 180 / PI;
    return (bis_pixel_direction){theta, phi < 0 ? phi + 360 : phi};
}

bis_pixel_direction bis_pixel_direction_of(const bis_xform *light_to_world, vec3 wi)
{
    const bis_xform to_light = bis_xform_inverse(light_to_world);
    return bis_pixel_angles(bis_xform_vector(&to_light, wi));
}

/* ---- the densities ---- */

/* What is plotted, [HEIGHT][WIDTH] each, 1/sr. */
enum { MAP, BRDF, PRODUCT, SEEN, N_DENSITIES };
typedef struct densities {
    float *of[N_DENSITIES];
    float *cos_theta; /* about the shading normal, in the middle of a place */
} densities;

typedef struct place {
    double value[N_DENSITIES];
} place;

static void look(place *sum, const bis_point *pt, vec3 wi, double share)
{
    double q_L;
    const rgb Le = bis_light_Le_pdf(pt->light, wi, &q_L);
    const double cos_theta = bis_bsdf_cos(&pt->bsdf, wi);

    sum->value[MAP] += share * q_L;
    if (cos_theta <= 0) return;
    const rgb f = bis_bsdf_f(&pt->bsdf, wi);
    const double f_L = (double)f.r * (double)Le.r + (double)f.g * (double)Le.g + (double)f.b * (double)Le.b;
    const double product = f_L * cos_theta;
    sum->value[BRDF] += share * rgb_sum(f) * cos_theta;
    sum->value[PRODUCT] += share * product;
    if (product > 0 && bis_point_sees(pt, wi)) sum->value[SEEN] += share * product;
}

static void fill_row(densities *d, const bis_pixel_figure *fig, const bis_point *pt, int y, int sub)
{
    for (int x = 0; x < WIDTH; x++) {
        const size_t at = (size_t)y * WIDTH + (size_t)x;
        place sum = {{0}};
        for (int i = 0; i < sub * sub; i++) {
            const double v = y + (i / sub + 0.5) / sub, u = x + (i % sub + 0.5) / sub;
            look(&sum, pt, direction_at(fig->light_to_world, PI * v / HEIGHT, 2 * PI * u / WIDTH), 1.0 / (sub * sub));
        }
        for (int k = 0; k < N_DENSITIES; k++) d->of[k][at] = (float)fmin(sum.value[k], (double)FLT_MAX);
        const vec3 middle = direction_at(fig->light_to_world, PI * (y + 0.5) / HEIGHT, 2 * PI * (x + 0.5) / WIDTH);
        d->cos_theta[at] = (float)bis_bsdf_cos(&pt->bsdf, middle);
    }
}

/* Integral over the sphere, by rows of equal solid angle. */
static double integral(const float *density)
{
    double sum = 0;
    for (int y = 0; y < HEIGHT; y++) {
        const double solid_angle = 2 * PI / WIDTH * 2 * sin(PI * (y + 0.5) / HEIGHT) * sin(PI / 2 / HEIGHT);
        double row = 0;
        for (int x = 0; x < WIDTH; x++) row += (double)density[(size_t)y * WIDTH + (size_t)x];
        sum += row * solid_angle;
    }
    return sum;
}

static void scale(float *density, double divisor)
{
    for (size_t i = 0; divisor > 0 && i < PLACES; i++) density[i] = (float)((double)density[i] / divisor);
}

static void densities_clear(densities *d)
{
    for (int k = 0; k < N_DENSITIES; k++) bis_free(d->of[k]);
    bis_free(d->cos_theta);
    *d = (densities){.cos_theta = NULL};
}

/* Normalised: the BRDF by its own integral (eq. 4.3), the product by L_ns (eq. 4.4), so that what is seen integrates to
 * L/L_ns. */
static bis_status densities_init(densities *d, const bis_pixel_figure *fig, bis_diag *diag)
{
    const bis_envmap *em = bis_light_envmap(fig->pt->light);
    const int wanted = em ? (em->width + WIDTH - 1) / WIDTH : 1;
    const int sub = wanted < 2 ? 2 : wanted > MAX_SUB ? MAX_SUB : wanted;
    bool ok = true;

    *d = (densities){.cos_theta = bis_alloc(PLACES, sizeof(float))};
    for (int k = 0; k < N_DENSITIES; k++) ok = (d->of[k] = bis_alloc(PLACES, sizeof(float))) && ok;
    if (!ok || !d->cos_theta) {
        densities_clear(d);
        return bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for a plot of %d x %d", WIDTH, HEIGHT);
    }
#pragma omp parallel for schedule(dynamic, 4)
    for (int y = 0; y < HEIGHT; y++) {
        bis_counters counters = {0};
        bis_point mine = *fig->pt;
        mine.counters = &counters;
        fill_row(d, fig, &mine, y, sub);
    }
    scale(d->of[BRDF], integral(d->of[BRDF]));
    scale(d->of[PRODUCT], fig->exact->open.mean[3]);
    scale(d->of[SEEN], fig->exact->open.mean[3]);
    return BIS_OK;
}

/* ---- a panel ---- */

static rgb ink(void) { return bis_palette_srgb(0.12, 0.13, 0.16); }
static rgb faint(void) { return bis_palette_srgb(0.45, 0.47, 0.52); }
static rgb paper(void) { return bis_palette_srgb(1, 1, 1); }
static rgb night(void) { return bis_palette_srgb(0.02, 0.02, 0.05); }
static rgb seen_colour(void) { return bis_palette_srgb(0.35, 1.0, 0.92); }
static rgb hidden_colour(void) { return bis_palette_srgb(1.0, 0.42, 0.32); }
static rgb brdf_colour(void) { return bis_palette_srgb(0.75, 0.98, 0.35); }

/* Powers of ten: the colour scale reaches from 10^(top - DECADES) to 10^top. */
static int find_top(const densities *d)
{
    double most = 0;
    for (int k = 0; k < SEEN; k++) {
        for (size_t i = 0; i < PLACES; i++) most = fmax(most, (double)d->of[k][i]);
    }
    return most > 0 ? (int)ceil(log10(most)) : 0;
}

static rgb grey_colour(double t) { return bis_palette_srgb(0.05 + 0.72 * t, 0.05 + 0.73 * t, 0.09 + 0.76 * t); }

/* Where cos theta changes its sign: a line of even width, by the slope of cos theta. How much of it a pixel has. */
static double horizon_at(const float *cos_theta, int x, int y)
{
    if (y == 0 || y + 1 == HEIGHT) return 0;
    const float *row = cos_theta + (size_t)y * WIDTH;
    const double dx = (double)(row[(x + 1) % WIDTH] - row[(x + WIDTH - 1) % WIDTH]) / 2;
    const double dy = (double)(row[x + WIDTH] - row[x - WIDTH]) / 2, slope = hypot(dx, dy);
    return slope > 0 ? 0.75 * fmin(fmax(1.1 - fabs((double)row[x]) / slope, 0), 1) : 0;
}

/* The pixels of a panel: a density, and the horizon of the surface. */
static bis_status draw_density(FILE *page, const char *name, const densities *d, int which, int top,
                               rgb (*colour)(double), bis_diag *diag)
{
    const rgb line = bis_palette_srgb(0.85, 0.9, 1);
    bis_image image;
    bis_status status = bis_image_init(&image, WIDTH, HEIGHT, diag);

    if (status) return status;
    for (int i = 0; i < PLACES; i++) {
        const double t = 1 + (log10((double)d->of[which][i]) - top) / DECADES; /* of 0: below all */
        const double share = horizon_at(d->cos_theta, i % WIDTH, i / WIDTH);
        image.pixels[i] = rgb_add(rgb_scale(t >= 0 ? colour(t) : night(), 1 - share), rgb_scale(line, share));
    }
    status = bis_svg_picture(page, name, WIDTH, HEIGHT, &image, diag);
    bis_image_clear(&image);
    return status;
}

static void place_of(double *x, double *y, const bis_pixel_figure *fig, vec3 wi)
{
    const bis_pixel_direction d = bis_pixel_direction_of(fig->light_to_world, wi);
    *x = d.phi / 360 * WIDTH;
    *y = d.theta / 180 * HEIGHT;
}

/* A cross that is open in the middle, where a narrow lobe may be. right, below: where the name stands, for marks that
 * are close to one another. */
static void draw_mark(FILE *page, int x0, int y0, const bis_pixel_figure *fig, vec3 w, const char *name, bool right,
                      bool below)
{
    enum { ROOM = 40 }; /* for the longest name */
    static const int arms[4][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
    double x, y;
    place_of(&x, &y, fig, w);
    for (int k = 0; k < 8; k++) {
        const int *arm = arms[k % 4];
        bis_svg_line(page, x0 + x + 4 * arm[0], y0 + y + 4 * arm[1], x0 + x + 9 * arm[0], y0 + y + 9 * arm[1],
                     k < 4 ? 4 : 1.5, k < 4 ? night() : paper());
    }
    right = x < ROOM || (right && x < WIDTH - ROOM);
    below = y < 20 || (below && y < HEIGHT - 20);
    bis_svg_text_on(page, x0 + (right ? x + 8 : x - 5), y0 + (below ? y + 16 : y - 6), 10,
                    right ? BIS_SVG_LEFT : BIS_SVG_RIGHT, paper(), night(), name);
}

static void draw_marks(FILE *page, int x0, int y0, const bis_pixel_figure *fig)
{
    draw_mark(page, x0, y0, fig, fig->pt->n, "n", true, false);
    draw_mark(page, x0, y0, fig, fig->pt->wo, "eye", false, false);
    draw_mark(page, x0, y0, fig, fig->pt->bsdf.r, "R", true, true);
}

static void draw_axes(FILE *page, int x0, int y0)
{
    char text[16];
    for (int phi = 0; phi <= 360; phi += 90) {
        const double x = x0 + phi / 360.0 * WIDTH;
        bis_svg_line(page, x, y0 + HEIGHT + 1, x, y0 + HEIGHT + 5, 1, faint());
        snprintf(text, sizeof text, "%d", phi);
        bis_svg_text(page, x, y0 + HEIGHT + 17, 8, BIS_SVG_MIDDLE, faint(), text);
    }
    for (int theta = 0; theta <= 180; theta += 45) {
        const double y = y0 + theta / 180.0 * HEIGHT;
        bis_svg_line(page, x0 - 5, y, x0 - 1, y, 1, faint());
        snprintf(text, sizeof text, "%d", theta);
        bis_svg_text(page, x0 - 8, y + 4, 8, BIS_SVG_RIGHT, faint(), text);
    }
}

static void panel_place(int *x, int *y, size_t k)
{
    *x = LEFT + (int)(k % COLUMNS) * (WIDTH + GAP_X);
    *y = TOP + 26 + (int)(k / COLUMNS) * (HEIGHT + GAP_Y);
}

/* ---- a page ---- */

static int rows_of(size_t n_panels) { return (int)((n_panels + COLUMNS - 1) / COLUMNS); }
static int height_of(size_t n_panels) { return TOP + rows_of(n_panels) * (HEIGHT + GAP_Y) + BOTTOM - 26; }

static void begin_page(FILE *page, const bis_pixel_figure *fig, size_t n_panels)
{
    bis_svg_begin(page, LEFT + COLUMNS * WIDTH + GAP_X + BAR + RIGHT, height_of(n_panels));
    bis_svg_text(page, LEFT, 36, 17, BIS_SVG_LEFT, ink(), fig->title);
    bis_svg_text(page, LEFT, 62, 10.5, BIS_SVG_LEFT, faint(), fig->subtitle);
}

static void draw_bar(FILE *page, int top, rgb (*colour)(double))
{
    const int x = LEFT + COLUMNS * WIDTH + GAP_X + 34, y = TOP + 26, height = HEIGHT, step = 3;
    for (int j = 0; j < height; j += step)
        bis_svg_box(page, x, y + j, 18, j + step < height ? step + 1 : step, colour(1 - (j + 0.5 * step) / height));
    for (int k = 0; k <= DECADES; k++) {
        char text[24];
        const double tick = y + (double)height * k / DECADES;
        bis_svg_line(page, x + 18, tick, x + 23, tick, 1, ink());
        snprintf(text, sizeof text, "10^%d", top - k);
        bis_svg_text(page, x + 28, tick + 5, 9.5, BIS_SVG_LEFT, ink(), text);
    }
    bis_svg_text(page, x, y + height + 24, 9.5, BIS_SVG_LEFT, ink(), "1/sr");
}

/* The title stands over the panel's left end, the note over its right end. */
static void draw_panel(FILE *page, size_t k, const char *picture, const char *title, const char *note)
{
    int x, y;
    panel_place(&x, &y, k);
    bis_svg_text(page, x, y - 9, 12, BIS_SVG_LEFT, ink(), title);
    bis_svg_text(page, x + WIDTH, y - 9, 9.5, BIS_SVG_RIGHT, faint(), note);
    bis_svg_show(page, picture, x, y);
    draw_axes(page, x, y);
}

static bis_status draw_densities(FILE *page, const bis_pixel_figure *fig, const densities *d, int top, bis_diag *diag)
{
    static const char *const names[N_DENSITIES] = {"map", "brdf", "product", "seen"};
    static const char *const titles[N_DENSITIES] = {"Map: q`L", "BRDF: q`f", "Product: p", "Product, seen: p V"};
    static const char *const formulas[] = {"importance by which directions are drawn from it, eq. 4.2",
                                           "f cos over its integral, eq. 4.3", "f cos L over L`ns , eq. 4.4"};
    const double open = fig->exact->open.mean[3];
    bis_status status = BIS_OK;
    char seen[80];

    begin_page(page, fig, N_DENSITIES);
    if (open > 0) snprintf(seen, sizeof seen, "what no surface hides: L/L`ns = %.4g", fig->exact->lit.mean[3] / open);
    else snprintf(seen, sizeof seen, "what no surface hides: of nothing"); /* dark where it could be reflected */
    for (int k = 0; k < N_DENSITIES && !status; k++) {
        int x, y;
        status = draw_density(page, names[k], d, k, top, bis_palette_heat, diag);
        draw_panel(page, (size_t)k, names[k], titles[k], k < SEEN ? formulas[k] : seen);
        panel_place(&x, &y, (size_t)k);
        draw_marks(page, x, y, fig);
    }
    draw_bar(page, top, bis_palette_heat);
    bis_svg_text(page, LEFT, height_of(N_DENSITIES) - 22, 9.5, BIS_SVG_LEFT, faint(),
                 "Directions in the map's frame: phi to the right, theta downwards, in degrees. Line: the horizon of "
                 "the surface. n: its normal, R: the mirror direction, eye: to the camera.");
    bis_svg_end(page);
    return status;
}

/* ---- figure 4.2 ---- */

/* On a dark disc that sets it off from the ground. */
static void draw_dot(FILE *page, double x, double y, double radius, rgb colour, bool filled)
{
    bis_svg_disc(page, x, y, radius + 1.3, night());
    if (filled) bis_svg_disc(page, x, y, radius, colour);
    else bis_svg_ring(page, x, y, radius - 0.6, 1.7, colour);
}

static void draw_rays(FILE *page, size_t k, const bis_pixel_figure *fig, const bis_pixel_rays *rays)
{
    int x0, y0;
    panel_place(&x0, &y0, k);
    for (size_t i = 0; i < rays->n; i++) {
        const bis_pixel_ray *r = &rays->ray[i];
        double x, y;
        place_of(&x, &y, fig, r->wi);
        draw_dot(page, x0 + x, y0 + y, 3.6, r->seen ? seen_colour() : hidden_colour(), r->seen);
    }
}

/* Their areas tell their weights, between a dot that can be seen and a large one. */
static void draw_candidates(FILE *page, size_t k, const bis_pixel_figure *fig)
{
    const bis_pixel_candidates *c = fig->candidates;
    int x0, y0;
    panel_place(&x0, &y0, k);
    for (int chosen = 0; chosen < 2; chosen++) {
        for (uint32_t i = 0; i < c->M; i++) {
            const bis_pixel_candidate *q = &c->c[i];
            double x, y;
            if (q->w <= 0 || (q->chosen > 0) != chosen) continue;
            const double radius = fmin(fmax(2.4 * sqrt(q->w / c->W * c->M), 0.9), 9);
            place_of(&x, &y, fig, q->wi);
            draw_dot(page, x0 + x, y0 + y, radius, q->from_map ? seen_colour() : brdf_colour(), true);
            if (chosen) bis_svg_ring(page, x0 + x, y0 + y, radius + 3, 1.5, paper());
        }
    }
}

static void note_of(char note[160], const bis_pixel_method *m, const bis_pixel_rays *r)
{
    const char *plural = r->runs == 1 ? "" : "s";
    const int n = snprintf(note, 160, "%zu shadow rays of %u estimate%s", r->n, (unsigned)r->runs, plural);
    if (isfinite(m->error)) snprintf(note + n, 160 - (size_t)n, "; error of one: %.3g %%", 100 * m->error);
}

static bool has_panel(const bis_pixel_method *m) { return !m->is_open && strcmp(m->name, "rejection plain") != 0; }

/* Places by eye: no font is 20 % wider than what they were chosen for. */
static void draw_legend(FILE *page, int y)
{
    static const double at[] = {0, 180, 350, 570, 700};
    const char *const words[] = {"ray that saw the light", "ray that was blocked", "Candidates, area by weight:",
                                 "from the map", "from the BRDF, ringed: chosen. Ground: the product p."};
    const rgb colours[] = {seen_colour(), hidden_colour(), ink(), seen_colour(), brdf_colour()};
    for (int i = 0; i < 5; i++) {
        if (i != 2) draw_dot(page, LEFT + at[i] + 4, y - 4, 3.6, colours[i], i != 1);
        bis_svg_text(page, LEFT + at[i] + 14, y, 9.5, BIS_SVG_LEFT, faint(), words[i]);
    }
}

static bis_status draw_samples(FILE *page, const bis_pixel_figure *fig, const densities *d, int top, bis_diag *diag)
{
    size_t n = 1, k = 0;
    char note[160];

    for (size_t i = 0; i < fig->n_methods; i++) n += has_panel(&fig->methods[i]);
    begin_page(page, fig, n);
    const bis_status status = draw_density(page, "product", d, PRODUCT, top, grey_colour, diag);
    for (size_t i = 0; i < fig->n_methods; i++) {
        const bis_pixel_method *m = &fig->methods[i];
        if (!has_panel(m)) continue;
        if (m->settings.integrator == &bis_sir) {
            snprintf(note, sizeof note, "%u drawn, %u weigh something; effective sample size %.4g",
                     (unsigned)fig->candidates->M, (unsigned)fig->candidates->positive, fig->candidates->ess);
            draw_panel(page, k, "product", "candidates of sir", note);
            draw_candidates(page, k++, fig);
        }
        note_of(note, m, &fig->rays[i]);
        draw_panel(page, k, "product", m->name, note);
        draw_rays(page, k++, fig, &fig->rays[i]);
    }
    draw_bar(page, top, grey_colour);
    draw_legend(page, height_of(n) - 22);
    bis_svg_end(page);
    return status;
}

bis_status bis_pixel_figures(FILE *densities_page, FILE *samples_page, const bis_pixel_figure *fig, bis_diag *diag)
{
    densities d;
    bis_status status = densities_init(&d, fig, diag);

    if (status) return status;
    const int top = find_top(&d);
    status = draw_densities(densities_page, fig, &d, top, diag);
    if (!status) status = draw_samples(samples_page, fig, &d, top, diag);
    densities_clear(&d);
    return status;
}
