/* SPDX-License-Identifier: BSD-2-Clause */
/* trade_reference: what the runs are compared with.
 *
 * No method may judge itself: an error that its render and its reference share would not be seen. So there are two
 * references, by the best mis of the pilot for sir and rejection, and by the best sir for em, brdf and mis, each the
 * mean of eight renders with seeds of their own. That shows a bias. Noise needs no other method, but the least noise:
 * it is measured from the mean of both references, weighted by 1/variance (a reference by mis may be ten times as noisy
 * as what it judges, and would hide which is the better).
 * The eight say what the reference itself is worth: the standard error of its mean, and its noise as a share of relMSE,
 * which adds to that of whoever is compared with it (the errors are independent) and can be subtracted. Each is a file
 * in references/, so an interrupted measurement loses one at most. A given reference is trusted: nothing tells its
 * noise. */
#include "trade_files.h"
#include "trade_pictures.h"
#include "trade_scene.h"

#include "bis/base/mem.h"
#include "bis/files/image_file.h"

#include <unistd.h>

static const char *const makers[2] = {"mis", "sir"};

static const char *path_of(char buf[4096], const bis_trade *t, int which, int replicate)
{
    char name[64];
    snprintf(name, sizeof name, "references/%s-%d.exr", makers[which], replicate + 1);
    return bis_trade_path(buf, t, name);
}

/* Seeds that no run has. */
static uint64_t seed_of(const bis_trade *t, int which, int replicate)
{
    return bis_hash(bis_hash(~t->plan.seed) + (uint64_t)(BIS_TRADE_REPLICATES * which + replicate)) >> 11;
}

static double mean_of(const bis_image *image)
{
    const size_t n = (size_t)image->width * (size_t)image->height;
    double sum = 0;
    for (size_t i = 0; i < n; i++) sum += rgb_sum(image->pixels[i]);
    return sum / (3 * (double)n);
}

/* ---- from replicates to one ---- */

static void set_channel(rgb *c, int k, double v) { *(k == 0 ? &c->r : k == 1 ? &c->g : &c->b) = (float)v; }

/* The mean over replicates in ref->image; returns the variance of that mean summed over pixels and channels, each
 * divided by (mean^2 + m^2/100), m the mean of all. */
static void combine(bis_trade_reference *ref, const bis_image *replicates)
{
    enum { R = BIS_TRADE_REPLICATES };
    const size_t n = (size_t)ref->image.width * (size_t)ref->image.height;
    double means[R], m2 = 0, relative = 0;

    ref->mean = 0;
    for (int r = 0; r < R; r++) means[r] = mean_of(&replicates[r]);
    for (int r = 0; r < R; r++) ref->mean += means[r] / R;
    for (int r = 0; r < R; r++) m2 += (means[r] - ref->mean) * (means[r] - ref->mean);
    ref->se = sqrt(m2 / (R - 1) / R);
    for (size_t i = 0; i < n; i++) {
        for (int k = 0; k < 3; k++) {
            double mean = 0, squares = 0;
            for (int r = 0; r < R; r++) mean += bis_trade_channel(replicates[r].pixels[i], k) / R;
            for (int r = 0; r < R; r++) squares += pow(bis_trade_channel(replicates[r].pixels[i], k) - mean, 2);
            const double scale = mean * mean + ref->mean * ref->mean / 100;
            set_channel(&ref->image.pixels[i], k, mean);
            if (scale > 0) relative += squares / (R - 1) / R / scale;
        }
    }
    ref->relmse = relative / (3 * (double)n);
    ref->is_ready = true;
}

/* ---- making it ---- */

static bis_status render_replicate(bis_image *image, bis_trade *t, const bis_trade_job *job, const char *path,
                                   bool *complete, bis_diag *diag)
{
    bis_render_result result;
    bis_status status = bis_trade_render(t, job, image, &result, diag);

    *complete = !status && !result.interrupted;
    return *complete ? bis_image_save(image, path, diag) : status;
}

static bis_status check_size(const bis_trade *t, const bis_image *image, const char *path, bis_diag *diag)
{
    const bis_film film = bis_trade_film(t, t->plan.step);

    if (image->width == film.width && image->height == film.height) return BIS_OK;
    return bis_error(diag, BIS_INPUT, (bis_loc){path, 0, 0},
                     "%d x %d pixels, must have the %d x %d of plan.txt; remove it and it is made again", image->width,
                     image->height, film.width, film.height);
}

static bis_status make_reference(bis_trade *t, int which, bis_diag *diag)
{
    bis_trade_reference *ref = &t->references[which];
    bis_image replicates[BIS_TRADE_REPLICATES] = {{0}};
    bis_status status = BIS_OK;
    bool complete = true;
    char path[4096];

    for (int r = 0; r < BIS_TRADE_REPLICATES && complete && !status; r++) {
        const bis_trade_job job = {&t->plan.settings[t->plan.reference[which]], t->plan.step,
                                   t->plan.reference_passes[which], seed_of(t, which, r)};
        path_of(path, t, which, r);
        bis_trade_tell(t, which ? "reference by sir" : "reference by mis", (double)r / BIS_TRADE_REPLICATES,
                       job.setting->pass_seconds * job.passes * (BIS_TRADE_REPLICATES - r));
        if (access(path, F_OK) == 0) status = bis_image_read(&replicates[r], path, (bis_loc){0}, diag);
        else status = render_replicate(&replicates[r], t, &job, path, &complete, diag);
        if (!status && complete) status = check_size(t, &replicates[r], path, diag);
    }
    if (!status && complete) status = bis_image_init(&ref->image, replicates[0].width, replicates[0].height, diag);
    if (!status && complete) combine(ref, replicates);
    for (int r = 0; r < BIS_TRADE_REPLICATES; r++) bis_image_clear(&replicates[r]);
    return status;
}

/* Of the two references, or what there is of them. */
static bis_status combine_both(bis_trade *t, bis_diag *diag)
{
    const bis_trade_reference *a = &t->references[0], *b = &t->references[1], *one = a->is_ready ? a : b;
    bis_trade_reference *both = &t->both;

    if (!one->is_ready) return BIS_OK;
    bis_status status = bis_image_init(&both->image, one->image.width, one->image.height, diag);
    if (status) return status;
    /* of given ones no noise is known; they are the same */
    const double w = !b->is_ready ? 1 : !a->is_ready ? 0 : b->relmse > 0 ? b->relmse / (a->relmse + b->relmse) : 0.5;
    for (size_t i = 0; i < (size_t)one->image.width * (size_t)one->image.height; i++) {
        for (int k = 0; k < 3; k++) {
            const double from_a = w > 0 ? w * bis_trade_channel(a->image.pixels[i], k) : 0,
                         from_b = w < 1 ? (1 - w) * bis_trade_channel(b->image.pixels[i], k) : 0;
            set_channel(&both->image.pixels[i], k, from_a + from_b);
        }
    }
    both->relmse = w * w * a->relmse + (1 - w) * (1 - w) * b->relmse;
    both->mean = w * a->mean + (1 - w) * b->mean;
    both->is_ready = true;
    return BIS_OK;
}

static bis_status read_given(bis_trade *t, bis_diag *diag)
{
    char path[4096];

    bis_trade_path(path, t, "references/given.exr");
    for (int k = 0; k < 2; k++) {
        bis_trade_reference *ref = &t->references[k];
        bis_status status = bis_image_read(&ref->image, path, (bis_loc){0}, diag);
        if (!status) status = check_size(t, &ref->image, path, diag);
        if (status) return status;
        ref->mean = mean_of(&ref->image);
        ref->is_ready = true;
    }
    return BIS_OK;
}

bis_status bis_trade_make_references(bis_trade *t, bis_diag *diag)
{
    bis_status status = bis_trade_make_folder(t, "references", diag);

    if (!status && t->plan.is_given) status = read_given(t, diag);
    for (int k = 0; k < 2 && !status && !bis_trade_interrupted(t); k++)
        if (t->plan.reference[k] >= 0) status = make_reference(t, k, diag);
    return status ? status : combine_both(t, diag);
}

bis_status bis_trade_thin(bis_image *out, const bis_image *full, const bis_film *all, const bis_film *some,
                          bis_diag *diag)
{
    const int k = some->step;
    bis_status status = bis_image_init(out, some->width, some->height, diag);

    for (int y = 0; y < some->height && !status; y++) {
        for (int x = 0; x < some->width; x++) {
            const int there_x = (some->x0 + x) * k + k / 2 - all->x0, there_y = (some->y0 + y) * k + k / 2 - all->y0;
            out->pixels[(size_t)y * (size_t)out->width + (size_t)x] =
                full->pixels[(size_t)there_y * (size_t)full->width + (size_t)there_x];
        }
    }
    return status;
}
