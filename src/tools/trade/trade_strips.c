/* trade_strips: the pictures of the page: equal-time strips with crops and false-colour errors, and the slider.
 *
 * A picture is a PNG in base64, once in the page, as a CSS variable; what shows it, whole or a crop of it, is an
 * element with that background. All have one exposure, from the reference, so that what differs is the method. Crops
 * are windows of a quarter of the picture's sides: the one in which the methods err most, and the next that does not
 * overlap it. Errors are those of `bis compare --diff`. */
#include "trade.h"

#include "bis/tools/compare.h"
#include "bis/base/mem.h"
#include "bis/files/image_file.h"
#include "files/image_png.h"

#include <stdlib.h>

enum { CROP = 4, N_CROPS = 2 }; /* a crop is 1/CROP of the sides */

/* ---- data URIs ---- */

static void put_base64(FILE *out, const unsigned char *data, size_t n)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t i = 0; i < n; i += 3) {
        const unsigned v = (unsigned)data[i] << 16 | (i + 1 < n ? (unsigned)data[i + 1] << 8 : 0) | (i + 2 < n ? (unsigned)data[i + 2] : 0);
        fputc(digits[v >> 18], out);
        fputc(digits[v >> 12 & 63], out);
        fputc(i + 1 < n ? digits[v >> 6 & 63] : '=', out);
        fputc(i + 2 < n ? digits[v & 63] : '=', out);
    }
}

/* "--NAME:url(data:image/png;base64,...);" */
static bis_status put_image(FILE *out, const char *name, const bis_image *image, double exposure, bis_diag *diag)
{
    bis_channel channels[3];
    bis_picture picture = bis_image_picture(image, channels);
    char *data = NULL;
    size_t n = 0;
    FILE *memory = open_memstream(&data, &n);

    picture.has_exposure = true;
    picture.exposure = exposure;
    if (!memory) return bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for the pictures of the report");
    bis_status status = bis_png_write(memory, &picture, "report.html", diag);
    if (fclose(memory) != 0 && !status) status = bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for the pictures of the report");
    if (!status) {
        fprintf(out, "--%s:url(data:image/png;base64,", name);
        put_base64(out, (const unsigned char *)data, n);
        fputs(");\n", out);
    }
    free(data); /* the C library's, not ours */
    return status;
}

/* The share of geometry in each pixel of the measured window, by 16 rays a pixel, for channel "A" of the reference: its
 * files hold colours alone. NULL: no memory. */
static float *new_coverage(const bis_trade *t, int width, int height)
{
    enum { SIDE = 4 };
    const int full_width = t->plan.width, full_height = t->plan.height;
    bis_film film;
    float *coverage = bis_alloc((size_t)width * (size_t)height, sizeof *coverage);

    if (!coverage || bis_film_init(&film, full_width, full_height, t->desc->film.crop, (bis_loc){0}, NULL)) {
        bis_free(coverage);
        return NULL;
    }
    const int x0 = film.x0, y0 = film.y0;
    bis_film_clear(&film);
    for (int i = 0; i < width * height; i++) {
        int hits = 0;
        for (int k = 0; k < SIDE * SIDE; k++) {
            const double x = x0 + i % width + (k % SIDE + 0.5) / SIDE, y = y0 + i / width + (k / SIDE + 0.5) / SIDE;
            const ray eye = bis_camera_ray(&t->desc->camera, full_width, full_height, x, y);
            bis_hit hit;
            hits += bis_accel_intersect(t->scene->accel, &eye, &hit);
        }
        coverage[i] = (float)hits / (SIDE * SIDE);
    }
    return coverage;
}

bis_status bis_trade_exposure(double *exposure, const bis_trade *t, bis_diag *diag)
{
    const bis_image *image = &t->both.image;
    bis_channel channels[4];
    bis_picture picture = bis_image_picture(image, channels);
    float *coverage = new_coverage(t, image->width, image->height);

    if (!coverage) return bis_error(diag, BIS_NOMEM, (bis_loc){0}, "no memory for the pictures of the report");
    channels[3] = (bis_channel){"A", coverage, 1};
    picture.n_channels = 4;
    *exposure = bis_png_exposure(&picture);
    bis_free(coverage);
    return BIS_OK;
}

bis_status bis_trade_put_images(FILE *out, const bis_trade *t, bis_diag *diag)
{
    double exposure;
    bis_status status = bis_trade_exposure(&exposure, t, diag);

    if (status) return status;
    fprintf(out, ":root{--ratio:%d/%d;\n", t->both.image.width, t->both.image.height);
    status = put_image(out, "ref", &t->both.image, exposure, diag);
    for (int i = 0; i < t->n_strip && !status; i++) {
        const bis_trade_picture *p = &t->strip[i];
        bis_image error;
        char name[16];
        snprintf(name, sizeof name, "p%d", i);
        status = put_image(out, name, &p->image, exposure, diag);
        if (!status) status = bis_compare_picture(&error, &p->image, &t->both.image, diag);
        if (status) break;
        snprintf(name, sizeof name, "e%d", i);
        status = put_image(out, name, &error, 0, diag);
        bis_image_clear(&error);
    }
    fputs("}\n", out);
    return status;
}

/* ---- crops ---- */

typedef struct window {
    int x, y;
} window;

/* The methods' squared differences in a window, each pixel's bounded: one firefly does not choose the place. */
static double error_in(const bis_trade *t, window w, int width, int height)
{
    double sum = 0;
    for (int i = 0; i < t->n_strip; i++) {
        const bis_image *a = &t->strip[i].image, *b = &t->both.image;
        for (int y = w.y; y < w.y + height; y++) {
            for (int x = w.x; x < w.x + width; x++) {
                const size_t at = (size_t)y * (size_t)a->width + (size_t)x;
                const double va = rgb_sum(a->pixels[at]), vb = rgb_sum(b->pixels[at]), d = fabs(va - vb);
                sum += d > 0 ? fmin(d / fmax(va, vb), 0.5) : 0;
            }
        }
    }
    return sum;
}

static bool overlap(window a, window b, int width, int height) { return abs(a.x - b.x) < width && abs(a.y - b.y) < height; }

static void find_crops(const bis_trade *t, window crops[N_CROPS])
{
    const bis_image *image = &t->both.image;
    const int width = (image->width + CROP - 1) / CROP, height = (image->height + CROP - 1) / CROP;

    for (int k = 0; k < N_CROPS; k++) {
        double most = -1;
        crops[k] = (window){0, 0};
        for (int y = 0; y + height <= image->height; y += height / 3 + 1) {
            for (int x = 0; x + width <= image->width; x += width / 3 + 1) {
                const window w = {x, y};
                if (k > 0 && overlap(w, crops[0], width, height)) continue;
                const double error = error_in(t, w, width, height);
                if (error <= most) continue;
                most = error;
                crops[k] = w;
            }
        }
    }
}

/* Where a window lies, in percent as CSS counts for backgrounds: of what is left beside it. */
static double share(int at, int full)
{
    const int left = full - (full + CROP - 1) / CROP;
    return left > 0 ? 100.0 * at / left : 0;
}

/* ---- strips ---- */

static void put_crops(FILE *out, const char *name, const bis_image *image, const window crops[N_CROPS])
{
    fputs("<div class=\"crops\">", out);
    for (int k = 0; k < N_CROPS; k++) {
        fprintf(out, "<div class=\"pic crop crop%d\" style=\"background-image:var(--%s);background-position:%.2f%% %.2f%%\"></div>", k, name,
                share(crops[k].x, image->width), share(crops[k].y, image->height));
    }
    fputs("</div>", out);
}

static void put_frames(FILE *out, const bis_image *image, const window crops[N_CROPS])
{
    for (int k = 0; k < N_CROPS; k++) {
        fprintf(out, "<i class=\"frame crop%d\" style=\"left:%.2f%%;top:%.2f%%\"></i>", k, 100.0 * crops[k].x / image->width, 100.0 * crops[k].y / image->height);
    }
}

static void put_truth(FILE *out, const bis_trade *t, const window crops[N_CROPS])
{
    fputs("<figure class=\"shot\"><figcaption><b>reference</b><span>", out);
    if (t->plan.is_given) fputs("as given", out);
    else fputs("the mean of both", out);
    fputs("</span></figcaption><div class=\"pic\" role=\"img\" aria-label=\"reference\" style=\"background-image:var(--ref)\">", out);
    put_frames(out, &t->both.image, crops);
    fputs("</div>", out);
    put_crops(out, "ref", &t->both.image, crops);
    fputs("<div class=\"scale\"><span>error of each pixel</span><i></i><div><span>0.1%</span><span>1%</span><span>10%</span><span>1</span><span>10</span></div></div>"
          "</figure>\n", out);
}

static void put_shot(FILE *out, const bis_trade *t, int i, const window crops[N_CROPS])
{
    const bis_trade_picture *p = &t->strip[i];
    const bis_trade_setting *s = &t->plan.settings[p->setting];
    char name[16], time[24], error[24];

    snprintf(name, sizeof name, "p%d", i);
    fprintf(out, "<figure class=\"shot k-%s\"><figcaption><b>", s->settings.integrator->name);
    bis_trade_put_text(out, s->name);
    fprintf(out, "</b><span>%u pass%s, %s%s</span></figcaption>", (unsigned)p->passes, p->passes == 1 ? "" : "es", bis_trade_duration(time, p->seconds),
            s->is_biased ? ", biased" : "");
    fprintf(out, "<div class=\"pic\" role=\"img\" aria-label=\"%s\" style=\"background-image:var(--%s)\"></div>", s->settings.integrator->name, name);
    put_crops(out, name, &p->image, crops);
    fprintf(out, "<div class=\"pic\" role=\"img\" aria-label=\"error of %s\" style=\"background-image:var(--e%d)\"></div>", s->settings.integrator->name, i);
    fprintf(out, "<p class=\"figure\">error <b>%s</b></p></figure>\n", bis_trade_percent(error, sqrt(p->relmse)));
}

void bis_trade_put_strips(FILE *out, const bis_trade *t)
{
    window crops[N_CROPS];

    find_crops(t, crops);
    fputs("<div class=\"strip\">\n", out);
    put_truth(out, t, crops);
    for (int i = 0; i < t->n_strip; i++) put_shot(out, t, i, crops);
    fputs("</div>\n", out);
}

/* ---- the slider ---- */

static void put_options(FILE *out, const bis_trade *t, int chosen)
{
    fprintf(out, "<option value=\"ref\"%s>reference</option>", chosen < 0 ? " selected=\"selected\"" : "");
    for (int i = 0; i < t->n_strip; i++) {
        fprintf(out, "<option value=\"p%d\"%s>", i, chosen == i ? " selected=\"selected\"" : "");
        bis_trade_put_text(out, t->plan.settings[t->strip[i].setting].name);
        fputs("</option>", out);
    }
}

/* The worst against the best, to begin with. */
void bis_trade_put_slider(FILE *out, const bis_trade *t)
{
    int worst = 0, best = 0;

    for (int i = 1; i < t->n_strip; i++) {
        if (t->strip[i].relmse > t->strip[worst].relmse) worst = i;
        if (t->strip[i].relmse < t->strip[best].relmse) best = i;
    }
    if (worst == best) worst = -1;
    fputs("<div class=\"choose\"><label>left <select id=\"left\">", out);
    put_options(out, t, worst);
    fputs("</select></label><label>right <select id=\"right\">", out);
    put_options(out, t, best);
    fputs("</select></label></div>\n<div class=\"pair\" id=\"pair\">", out);
    fprintf(out, "<div class=\"pic\" id=\"under\" style=\"background-image:var(--p%d)\"></div>", best);
    if (worst < 0) fputs("<div class=\"pic\" id=\"over\" style=\"background-image:var(--ref)\"></div>", out);
    else fprintf(out, "<div class=\"pic\" id=\"over\" style=\"background-image:var(--p%d)\"></div>", worst);
    fputs("<i class=\"cut\"></i><input id=\"cut\" type=\"range\" min=\"0\" max=\"100\" step=\"0.5\" value=\"50\" aria-label=\"where the left picture ends\"/></div>\n", out);
}
