/* pixel_plots: figures 4.1 and 4.2 of the thesis for one point, as the map sees directions: a lat-long plot of the
 * whole sphere in the light's frame.
 *
 * A place of the plot is the mean of a density over a few directions in it, as many as the map has pixels there (at
 * most 8 x 8), so that a lamp of one pixel is not missed. All densities are per steradian and share one logarithmic
 * scale: where the product is brighter than a proposal, the proposal draws too little. What is below the scale is
 * black. Shadow rays are dots on the product. */
#include "pixel.h"

#include "bis/base/mem.h"

#include "out/canvas.h"
#include "out/palette.h"

#include <float.h>
#include <stdio.h>
#include <string.h>

enum { WIDTH = BIS_PIXEL_PLOT_WIDTH, HEIGHT = BIS_PIXEL_PLOT_HEIGHT, PLACES = WIDTH * HEIGHT, MAX_SUB = 8, DECADES = 7 };
enum { LEFT = 56, TOP = 84, RIGHT = 40, GAP_X = 64, GAP_Y = 70, BOTTOM = 66, BAR = 96, COLUMNS = 2 };

/* ---- directions ---- */

static vec3 direction_at(const bis_xform *light_to_world, double theta, double phi)
{
    return normalize(bis_xform_vector(light_to_world, vec3_from(sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta))));
}

bis_pixel_direction bis_pixel_direction_of(const bis_xform *light_to_world, vec3 wi)
{
    const bis_xform to_light = bis_xform_inverse(light_to_world);
    const vec3 w = bis_xform_vector(&to_light, wi);
    const double phi = atan2((double)w.y, (double)w.x) * 180 / PI;
    return (bis_pixel_direction){atan2(hypot((double)w.x, (double)w.y), (double)w.z) * 180 / PI, phi < 0 ? phi + 360 : phi};
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
    const double product = ((double)f.r * (double)Le.r + (double)f.g * (double)Le.g + (double)f.b * (double)Le.b) * cos_theta;
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
        d->cos_theta[at] = (float)bis_bsdf_cos(&pt->bsdf, direction_at(fig->light_to_world, PI * (y + 0.5) / HEIGHT, 2 * PI * (x + 0.5) / WIDTH));
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
    const int wanted = em ? (em->width + WIDTH - 1) / WIDTH : 1, sub = wanted < 2 ? 2 : wanted > MAX_SUB ? MAX_SUB : wanted;
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

static void draw_density(bis_image *image, int x0, int y0, const float *density, int top, rgb (*colour)(double))
{
    for (int y = 0; y < HEIGHT; y++) {
        for (int x = 0; x < WIDTH; x++) {
            const double q = (double)density[(size_t)y * WIDTH + (size_t)x], t = q > 0 ? 1 + (log10(q) - top) / DECADES : -1;
            bis_canvas_blend(image, x0 + x, y0 + y, t >= 0 ? colour(t) : night(), 1);
        }
    }
}

/* Where cos theta changes its sign: a line of even width, by the slope of cos theta. */
static void draw_horizon(bis_image *image, int x0, int y0, const float *cos_theta, rgb colour)
{
    for (int y = 1; y + 1 < HEIGHT; y++) {
        for (int x = 0; x < WIDTH; x++) {
            const float *row = cos_theta + (size_t)y * WIDTH;
            const double dx = (double)(row[(x + 1) % WIDTH] - row[(x + WIDTH - 1) % WIDTH]) / 2, dy = (double)(row[x + WIDTH] - row[x - WIDTH]) / 2;
            const double slope = hypot(dx, dy);
            if (slope > 0) bis_canvas_blend(image, x0 + x, y0 + y, colour, 0.75 * fmin(fmax(1.1 - fabs((double)row[x]) / slope, 0), 1));
        }
    }
}

static void place_of(double *x, double *y, const bis_pixel_figure *fig, vec3 wi)
{
    const bis_pixel_direction d = bis_pixel_direction_of(fig->light_to_world, wi);
    *x = d.phi / 360 * WIDTH;
    *y = d.theta / 180 * HEIGHT;
}

/* A cross that is open in the middle, where a narrow lobe may be. right, below: where the name stands, for marks that
 * are close to one another. */
static void draw_mark(bis_image *image, int x0, int y0, const bis_pixel_figure *fig, vec3 w, const char *name, bool right, bool below)
{
    const double width = bis_canvas_text_width(10, name);
    static const int arms[4][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
    double x, y;
    place_of(&x, &y, fig, w);
    for (int k = 0; k < 8; k++) {
        const int *arm = arms[k % 4];
        bis_canvas_line(image, x0 + x + 4 * arm[0], y0 + y + 4 * arm[1], x0 + x + 9 * arm[0], y0 + y + 9 * arm[1], k < 4 ? 4 : 1.5, k < 4 ? night() : paper());
    }
    right = x < width + 14 || (right && x < WIDTH - width - 14);
    below = y < 20 || (below && y < HEIGHT - 20);
    bis_canvas_text_halo(image, x0 + (right ? x + 8 : x - 5 - width), y0 + (below ? y + 16 : y - 6), 10, paper(), night(), name);
}

static void draw_marks(bis_image *image, int x0, int y0, const bis_pixel_figure *fig)
{
    draw_mark(image, x0, y0, fig, fig->pt->n, "n", true, false);
    draw_mark(image, x0, y0, fig, fig->pt->wo, "eye", false, false);
    draw_mark(image, x0, y0, fig, fig->pt->bsdf.r, "R", true, true);
}

static void draw_axes(bis_image *image, int x0, int y0)
{
    char text[16];
    for (int phi = 0; phi <= 360; phi += 90) {
        const double x = x0 + phi / 360.0 * WIDTH;
        bis_canvas_line(image, x, y0 + HEIGHT + 1, x, y0 + HEIGHT + 5, 1, faint());
        snprintf(text, sizeof text, "%d", phi);
        bis_canvas_text_middle(image, x, y0 + HEIGHT + 17, 8, faint(), text);
    }
    for (int theta = 0; theta <= 180; theta += 45) {
        const double y = y0 + theta / 180.0 * HEIGHT;
        bis_canvas_line(image, x0 - 5, y, x0 - 1, y, 1, faint());
        snprintf(text, sizeof text, "%d", theta);
        bis_canvas_text_right(image, x0 - 8, y + 4, 8, faint(), text);
    }
}

static void panel_place(int *x, int *y, size_t k)
{
    *x = LEFT + (int)(k % COLUMNS) * (WIDTH + GAP_X);
    *y = TOP + 26 + (int)(k / COLUMNS) * (HEIGHT + GAP_Y);
}

/* ---- a page ---- */

static bis_status page_init(bis_image *page, const bis_pixel_figure *fig, size_t n_panels, bis_diag *diag)
{
    const int rows = (int)((n_panels + COLUMNS - 1) / COLUMNS), width = LEFT + COLUMNS * WIDTH + GAP_X + BAR + RIGHT;
    const bis_status status = bis_image_init(page, width, TOP + rows * (HEIGHT + GAP_Y) + BOTTOM - 26, diag);
    if (status) return status;
    bis_canvas_box(page, 0, 0, page->width, page->height, paper());
    bis_canvas_text(page, LEFT, 36, 17, ink(), fig->title);
    bis_canvas_text(page, LEFT, 62, 10.5, faint(), fig->subtitle);
    return BIS_OK;
}

static void draw_bar(bis_image *page, int top, rgb (*colour)(double))
{
    const int x = LEFT + COLUMNS * WIDTH + GAP_X + 34, y = TOP + 26, height = HEIGHT;
    for (int j = 0; j < height; j++) bis_canvas_box(page, x, y + j, 18, 1, colour(1 - (j + 0.5) / height));
    for (int k = 0; k <= DECADES; k++) {
        char text[24];
        const double tick = y + (double)height * k / DECADES;
        bis_canvas_line(page, x + 18, tick, x + 23, tick, 1, ink());
        snprintf(text, sizeof text, "10^%d", top - k);
        bis_canvas_text(page, x + 28, tick + 5, 9.5, ink(), text);
    }
    bis_canvas_text(page, x, y + height + 24, 9.5, ink(), "1/sr");
}

static void draw_panel(bis_image *page, size_t k, const densities *d, int which, int top, rgb (*colour)(double),
                       const char *title, const char *note)
{
    int x, y;
    panel_place(&x, &y, k);
    const double end = bis_canvas_text(page, x, y - 9, 12, ink(), title);
    bis_canvas_text(page, x + end + 14, y - 9, 9.5, faint(), note);
    draw_density(page, x, y, d->of[which], top, colour);
    draw_horizon(page, x, y, d->cos_theta, bis_palette_srgb(0.85, 0.9, 1));
    draw_axes(page, x, y);
}

static bis_status draw_densities(bis_image *page, const bis_pixel_figure *fig, const densities *d, int top, bis_diag *diag)
{
    static const char *const titles[N_DENSITIES] = {"Map: q`L", "BRDF: q`f", "Product: p", "Product, seen: p V"};
    static const char *const formulas[] = {"importance by which directions are drawn from it, eq. 4.2", "f cos over its integral, eq. 4.3",
                                           "f cos L over L`ns , eq. 4.4"};
    char seen[80];
    const bis_status status = page_init(page, fig, N_DENSITIES, diag);
    if (status) return status;
    const double open = fig->exact->open.mean[3];
    if (open > 0) snprintf(seen, sizeof seen, "what no surface hides: L/L`ns = %.4g", fig->exact->lit.mean[3] / open);
    else snprintf(seen, sizeof seen, "what no surface hides: of nothing"); /* the map is dark where it could be reflected */
    for (int k = 0; k < N_DENSITIES; k++) {
        int x, y;
        draw_panel(page, (size_t)k, d, k, top, bis_palette_heat, titles[k], k < SEEN ? formulas[k] : seen);
        panel_place(&x, &y, (size_t)k);
        draw_marks(page, x, y, fig);
    }
    draw_bar(page, top, bis_palette_heat);
    bis_canvas_text(page, LEFT, page->height - 22, 9.5, faint(),
                    "Directions in the map's frame: phi to the right, theta downwards, in degrees. Line: the horizon of the surface. n: its normal, "
                    "R: the mirror direction, eye: to the camera.");
    return BIS_OK;
}

/* ---- figure 4.2 ---- */

static void draw_dot(bis_image *page, int x0, int y0, const bis_pixel_figure *fig, vec3 wi, double radius, rgb colour, bool filled)
{
    double x, y;
    place_of(&x, &y, fig, wi);
    bis_canvas_disc(page, x0 + x, y0 + y, radius + 1.3, night());
    if (filled) bis_canvas_disc(page, x0 + x, y0 + y, radius, colour);
    else bis_canvas_ring(page, x0 + x, y0 + y, radius - 0.6, 1.7, colour);
}

static void draw_rays(bis_image *page, size_t k, const bis_pixel_figure *fig, const bis_pixel_rays *rays)
{
    int x, y;
    panel_place(&x, &y, k);
    for (size_t i = 0; i < rays->n; i++) {
        const bis_pixel_ray *r = &rays->ray[i];
        draw_dot(page, x, y, fig, r->wi, 3.6, r->seen ? seen_colour() : hidden_colour(), r->seen);
    }
}

/* Their areas tell their weights, between a dot that can be seen and a large one. */
static void draw_candidates(bis_image *page, size_t k, const bis_pixel_figure *fig)
{
    const bis_pixel_candidates *c = fig->candidates;
    int x, y;
    panel_place(&x, &y, k);
    for (int chosen = 0; chosen < 2; chosen++) {
        for (uint32_t i = 0; i < c->M; i++) {
            const bis_pixel_candidate *q = &c->c[i];
            if (q->x.w <= 0 || (q->chosen > 0) != chosen) continue;
            const double radius = fmin(fmax(2.4 * sqrt(q->x.w / c->W * c->M), 0.9), 9);
            draw_dot(page, x, y, fig, q->x.wi, radius, q->from_map ? seen_colour() : brdf_colour(), true);
            if (!chosen) continue;
            double px, py;
            place_of(&px, &py, fig, q->x.wi);
            bis_canvas_ring(page, x + px, y + py, radius + 3, 1.5, paper());
        }
    }
}

static void note_of(char note[160], const bis_pixel_method *m, const bis_pixel_rays *r)
{
    const int n = snprintf(note, 160, "%zu shadow rays of %u estimate%s", r->n, (unsigned)r->runs, r->runs == 1 ? "" : "s");
    if (isfinite(m->error)) snprintf(note + n, 160 - (size_t)n, "; error of one: %.3g %%", 100 * m->error);
}

static bool has_panel(const bis_pixel_method *m) { return !m->is_open && strcmp(m->name, "rejection plain") != 0; }

static void draw_legend(bis_image *page)
{
    const int y = page->height - 22;
    double x = LEFT;
    bis_canvas_disc(page, x + 4, y - 4, 5, night());
    bis_canvas_disc(page, x + 4, y - 4, 3.6, seen_colour());
    x += 16 + bis_canvas_text(page, x + 14, y, 9.5, faint(), "ray that saw the light") + 22;
    bis_canvas_disc(page, x + 4, y - 4, 5, night());
    bis_canvas_ring(page, x + 4, y - 4, 3, 1.7, hidden_colour());
    x += 16 + bis_canvas_text(page, x + 14, y, 9.5, faint(), "ray that was blocked") + 22;
    x += bis_canvas_text(page, x, y, 9.5, faint(), "Candidates, area by weight:") + 10;
    bis_canvas_disc(page, x + 4, y - 4, 5, night());
    bis_canvas_disc(page, x + 4, y - 4, 3.6, seen_colour());
    x += 16 + bis_canvas_text(page, x + 14, y, 9.5, faint(), "from the map") + 16;
    bis_canvas_disc(page, x + 4, y - 4, 5, night());
    bis_canvas_disc(page, x + 4, y - 4, 3.6, brdf_colour());
    x += 16 + bis_canvas_text(page, x + 14, y, 9.5, faint(), "from the BRDF, ringed: chosen") + 22;
    bis_canvas_text(page, x, y, 9.5, faint(), "Ground: the product p.");
}

static bis_status draw_samples(bis_image *page, const bis_pixel_figure *fig, const densities *d, int top, bis_diag *diag)
{
    size_t n = 1, k = 0;
    char note[160];

    for (size_t i = 0; i < fig->n_methods; i++) n += has_panel(&fig->methods[i]);
    const bis_status status = page_init(page, fig, n, diag);
    if (status) return status;
    for (size_t i = 0; i < fig->n_methods; i++) {
        const bis_pixel_method *m = &fig->methods[i];
        if (!has_panel(m)) continue;
        if (m->settings.integrator == &bis_sir) {
            snprintf(note, sizeof note, "%u drawn, %u weigh something; effective sample size %.4g", (unsigned)fig->candidates->M,
                     (unsigned)fig->candidates->positive, fig->candidates->ess);
            draw_panel(page, k, d, PRODUCT, top, grey_colour, "candidates of sir", note);
            draw_candidates(page, k++, fig);
        }
        note_of(note, m, &fig->rays[i]);
        draw_panel(page, k, d, PRODUCT, top, grey_colour, m->name, note);
        draw_rays(page, k++, fig, &fig->rays[i]);
    }
    draw_bar(page, top, grey_colour);
    draw_legend(page);
    return BIS_OK;
}

bis_status bis_pixel_figures(bis_image *densities_page, bis_image *samples_page, const bis_pixel_figure *fig, bis_diag *diag)
{
    densities d;
    bis_status status = densities_init(&d, fig, diag);

    *densities_page = *samples_page = (bis_image){0};
    if (status) return status;
    const int top = find_top(&d);
    status = draw_densities(densities_page, fig, &d, top, diag);
    if (!status) status = draw_samples(samples_page, fig, &d, top, diag);
    if (status) {
        bis_image_clear(densities_page);
        bis_image_clear(samples_page);
    }
    densities_clear(&d);
    return status;
}
