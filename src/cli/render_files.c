/* SPDX-License-Identifier: BSD-2-Clause */
/* render_files: the files that `bis render` writes. Whatever can be known to fail is found before the render: the
 * endings and folders of the outputs, an output that would replace what is read. */
#include "base/text.h"
#include "render_files.h"

#include "bis/base/file.h"
#include "bis/base/mem.h"
#include "files/image_png.h"
#include "progress.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>
#include <sys/stat.h>

/* A pipe or a device is written to directly, since it cannot be replaced by a renamed file. */
static bool is_stream(const char *path)
{
    struct stat st;
    return stat(path, &st) == 0 && !S_ISREG(st.st_mode) && !S_ISDIR(st.st_mode);
}

bis_status bis_render_files_check(const bis_render_files *files, bis_diag *diag)
{
    bis_status first = BIS_OK;

    for (int i = 0; i < files->pictures.n; i++) {
        const char *path = files->pictures.text[i];
        bis_status status = bis_image_can_write(path)
                                ? bis_cli_check_writable(path, diag)
                                : bis_error(diag, BIS_INPUT, bis_cli_loc,
                                            "output file \"%s\": the ending must be .exr, .pfm, .hdr or .png", path);
        if (!first) first = status;
    }
    if (files->stats && strcmp(files->stats, "-") != 0 && !is_stream(files->stats)) {
        bis_status status = bis_cli_check_writable(files->stats, diag);
        if (!first) first = status;
    }
    const char *const others[] = {files->checkpoint, files->part};
    for (int i = 0; i < 2; i++) {
        if (!others[i]) continue;
        bis_status status = bis_cli_check_writable(others[i], diag);
        if (!first) first = status;
    }
    return first;
}

/* Layers need an EXR to go to. */
static void check_layers(const bis_film_desc *film, const bis_texts *outfiles, bis_diag *diag)
{
    char ending[8];

    for (int i = 0; i < outfiles->n; i++)
        if (strcmp(bis_path_extension(ending, outfiles->text[i]), ".exr") == 0) return;
    if (film->layers)
        bis_warn(diag, bis_cli_loc, "layers go into an .exr, and no output file is one: they will be lost");
}

void bis_render_files_warn_of_alpha(const bis_texts *outfiles, bis_diag *diag)
{
    char ending[8];

    for (int i = 0; i < outfiles->n; i++) {
        bis_path_extension(ending, outfiles->text[i]);
        if (strcmp(ending, ".exr") != 0 && strcmp(ending, ".png") != 0)
            bis_warn(diag, bis_cli_loc, "\"%s\" cannot hold alpha: its background is black; take an .exr or a .png",
                     outfiles->text[i]);
    }
}

bis_status bis_render_files_check_distinct(const bis_render_files *files, const bis_scene_desc *desc, bis_diag *diag)
{
    const size_t n_inputs = desc->n_files + desc->n_meshes + desc->textures.n_files + 2;
    const char **inputs = bis_alloc(n_inputs, sizeof *inputs), *outputs[BIS_MAX_TEXTS + 3];
    size_t n = 0, n_outputs = 0;

    if (!inputs) return bis_error(diag, BIS_NOMEM, bis_cli_loc, "no memory for the names of %zu files", n_inputs);
    for (size_t i = 0; i < desc->n_files; i++) inputs[n++] = desc->files[i];
    for (size_t i = 0; i < desc->n_meshes; i++)
        if (desc->meshes[i].filename) inputs[n++] = desc->meshes[i].filename;
    for (size_t i = 0; i < desc->textures.n_files; i++) inputs[n++] = desc->textures.files[i].filename;
    if (desc->light.filename) inputs[n++] = desc->light.filename;
    for (int i = 0; i < files->pictures.n; i++) outputs[n_outputs++] = files->pictures.text[i];
    if (files->stats) outputs[n_outputs++] = files->stats;
    if (files->checkpoint) outputs[n_outputs++] = files->checkpoint;
    if (files->part) outputs[n_outputs++] = files->part;
    if (files->resume && !bis_file_is_same(files->resume, files->checkpoint)) inputs[n++] = files->resume;
    if (!files->part) check_layers(&desc->view.film, &files->pictures, diag);
    const bis_status status = bis_cli_check_distinct(inputs, n, outputs, n_outputs, diag);
    bis_free(inputs);
    return status;
}

/* Lists the picture's own channels, alpha among them only where the background is transparent, because "over" would add
 * what stands behind to the light that is there; then those of the layers. The layers' channels point into *planes; the
 * caller frees it. Warns if error bars were asked for and cannot be computed. */
static bis_status list_channels(bis_channel *channels, int *n, float **planes, const bis_film *f, const float *rgba,
                                bis_diag *diag)
{
    static const char *const names[4] = {"R", "G", "B", "A"};
    const int n_own = f->transparent ? 4 : 3;

    for (int i = 0; i < n_own; i++) channels[i] = (bis_channel){names[i], rgba + i, 4};
    const int n_layers = bis_film_layers(f, channels + n_own, NULL);
    *n = n_own + n_layers;
    if (f->passes < 2 &&
        (bis_layers_has(&f->layers, BIS_LAYER_STDERR) || bis_layers_has(&f->layers, BIS_LAYER_INTERVAL))) {
        bis_warn(diag, bis_cli_loc,
                 "one pass has no scatter: layers \"stderr\" and \"interval\" are left out; take --spp 2 or more");
    }
    if (n_layers == 0) return BIS_OK;
    *planes = bis_alloc((size_t)f->width * (size_t)f->height, (size_t)n_layers * sizeof **planes);
    if (!*planes) {
        *n = n_own; /* rather the picture alone than nothing */
        return bis_error(diag, BIS_NOMEM, bis_cli_loc, "no memory to write %d layer channels of %d x %d pixels",
                         n_layers, f->width, f->height);
    }
    bis_film_layers(f, channels + n_own, *planes);
    return BIS_OK;
}

const char *bis_render_files_why_unknown(const bis_film_error *error)
{
    if (isnan(error->relative_rmse)) return "one pass is too few";
    return error->has_upper ? "a few pixels carry most of it" : "pixels may not have found their light yet";
}

void bis_render_files_print_result(const bis_texts *written, double exposure, const bis_stats *stats)
{
    const bis_render_result *r = stats->result;
    char seconds[BIS_DURATION], error[BIS_PERCENT];

    if (r->interrupted && r->missing > 0) fputs("bis: interrupted in the first pass; wrote", stderr);
    else if (r->interrupted)
        fprintf(stderr, "bis: interrupted after %" PRIu64 " camera sample%s a pixel; wrote", r->spp,
                r->spp == 1 ? "" : "s");
    else fputs("bis: wrote", stderr);
    for (int i = 0; i < written->n; i++) fprintf(stderr, "%s %s", i ? "," : "", written->text[i]);
    fprintf(stderr, ": %d x %d pixels, ", stats->film->width, stats->film->height);
    if (r->missing > 0)
        fprintf(stderr, "%s of them without a camera sample and like a neighbour, ", bis_percent(error, r->missing));
    else
        fprintf(stderr, "%" PRIu64 " camera sample%s a pixel in %u pass%s, ", r->spp, r->spp == 1 ? "" : "s", r->passes,
                r->passes == 1 ? "" : "es");
    fprintf(stderr, "%s, ", bis_duration(seconds, r->seconds));
    if (r->error.is_known) fprintf(stderr, "error about %s", bis_percent(error, r->error.relative_rmse));
    else if (r->error.has_upper) fprintf(stderr, "error at most %s", bis_percent_above(error, r->error.upper));
    else fprintf(stderr, "error unknown: %s", bis_render_files_why_unknown(&r->error));
    if (!isnan(exposure)) fprintf(stderr, "; exposure %.4g", exposure);
    fputs("\n", stderr);
}

bis_status bis_render_files_write_pictures(bis_texts *written, double *exposure, const bis_render_files *files,
                                           const bis_stats *stats, bis_diag *diag)
{
    const bis_film *f = stats->film;
    float *rgba = bis_alloc((size_t)f->width * (size_t)f->height, 4 * sizeof *rgba);
    if (!rgba) return bis_error(diag, BIS_NOMEM, bis_cli_loc, "no memory to write %d x %d pixels", f->width, f->height);
    bis_film_resolve(f, rgba);

    bis_channel channels[4 + BIS_FILM_MAX_CHANNELS];
    float *planes = NULL;
    int n_channels;
    bis_status first = list_channels(channels, &n_channels, &planes, f, rgba, diag);
    bis_attribute attributes[BIS_MAX_ATTRIBUTES];
    const bis_channel hits = {"A", rgba + 3, 4};
    const bis_picture picture = {
        .width = f->width,
        .height = f->height,
        .x0 = f->x0,
        .y0 = f->y0,
        .full_width = f->full_width,
        .full_height = f->full_height,
        .channels = channels,
        .n_channels = n_channels,
        .subject = &hits,
        .attributes = attributes,
        .n_attributes = bis_describe_picture(stats, attributes),
        .has_exposure = files->has_exposure,
        .exposure = files->exposure,
    };
    *exposure = NAN;
    for (int i = 0; i < files->pictures.n; i++) {
        char ending[8];
        if (strcmp(bis_path_extension(ending, files->pictures.text[i]), ".png") == 0)
            *exposure = bis_png_exposure(&picture);
        bis_status status = bis_image_write(files->pictures.text[i], &picture, diag);
        if (!status) written->text[written->n++] = files->pictures.text[i];
        if (!first) first = status;
    }
    bis_free(planes);
    bis_free(rgba);
    return first;
}

bis_status bis_render_files_write_stats(const bis_render_files *files, const bis_stats *stats, bis_diag *diag)
{
    const char *path = files->stats;

    if (!path) return BIS_OK;
    if (strcmp(path, "-") == 0) {
        bis_stats_print(stats, stdout); /* bis_cli_finish looks for errors */
        return BIS_OK;
    }
    if (is_stream(path)) {
        FILE *out = fopen(path, "w");
        if (!out) return bis_error(diag, BIS_IO, bis_cli_loc, "\"%s\" cannot be written", path);
        bis_stats_print(stats, out);
        bool failed = ferror(out) != 0;
        failed |= fclose(out) != 0;
        return failed ? bis_error(diag, BIS_IO, bis_cli_loc, "\"%s\" cannot be written", path) : BIS_OK;
    }
    bis_outfile *file;
    bis_status status = bis_outfile_open(&file, path, diag);
    if (status) return status;
    bis_stats_print(stats, bis_outfile_stream(file));
    return bis_outfile_commit(file, diag);
}

void bis_render_files_warn_of_counts(const bis_counters *counters, bis_diag *diag)
{
    if (counters->beside_portals)
        bis_warn(diag, bis_cli_loc, "%llu camera rays see the light beside its portals: give other openings a portal"
                 ", too, because light that comes through them is found later",
                 (unsigned long long)counters->beside_portals);
    if (!counters->nonfinite) return;
    bis_warn(diag, bis_cli_loc,
             "%llu estimates were not finite and count as black: the picture is too dark. A light near the largest "
             "float, 3.4e38, needs a smaller \"scale\" (docs/trust.md); with any other light this is a defect, "
             "please report it", (unsigned long long)counters->nonfinite);
}

/* A camera that looks in the direction of c sees the ball around the box: it stands radius / sin(fov / 2) away. */
static void say_camera(char text[256], const bis_box *b, const bis_camera *c)
{
    const double mid[3] = {((double)b->lo.x + (double)b->hi.x) / 2, ((double)b->lo.y + (double)b->hi.y) / 2,
                           ((double)b->lo.z + (double)b->hi.z) / 2};
    const double radius = hypot(hypot((double)b->hi.x - mid[0], (double)b->hi.y - mid[1]), (double)b->hi.z - mid[2]);
    const vec3 ahead = bis_xform_vector(&c->to_world, (vec3){0, 0, 1});
    const vec3 up = bis_xform_vector(&c->to_world, (vec3){0, 1, 0});
    const double length = sqrt((double)dot(ahead, ahead));
    const double k = radius / sin(c->fov_deg / 2 * PI / 180) / length;

    *text = '\0';
    bis_append(text, 256, "They lie in x %.6g to %.6g, y %.6g to %.6g, z %.6g to %.6g", (double)b->lo.x,
               (double)b->hi.x, (double)b->lo.y, (double)b->hi.y, (double)b->lo.z, (double)b->hi.z);
    if (!c->orthographic && !c->has_screen)
        bis_append(text, 256, "; \"LookAt %.6g %.6g %.6g  %.6g %.6g %.6g  %.6g %.6g %.6g\" as all that moves its "
                   "Camera sees all of them",
                   mid[0] - k * (double)ahead.x, mid[1] - k * (double)ahead.y, mid[2] - k * (double)ahead.z, mid[0],
                   mid[1], mid[2], (double)up.x, (double)up.y, (double)up.z);
}

void bis_render_files_warn_of_black(const bis_film *f, const bis_scene *scene, const bis_camera *camera,
                                    bis_diag *diag)
{
    const size_t n = (size_t)f->width * (size_t)f->height;
    bool sees = false;
    char where[256];

    for (size_t i = 0; i < n; i++) {
        if (f->sum[3 * i] != 0 || f->sum[3 * i + 1] != 0 || f->sum[3 * i + 2] != 0) return;
        sees = sees || f->hits[i] > 0;
    }
    if (sees) {
        bis_warn(diag, bis_cli_loc, "the picture is black: no light from infinity reaches what the camera sees. In a "
                 "closed room there is none: leave out a wall or the ceiling, and see what --plan says of the scene's "
                 "own lights");
        return;
    }
    if (bis_geometry_primitives(&scene->geometry) > 0) say_camera(where, &scene->geometry.box, camera);
    else snprintf(where, sizeof where, "The scene has none: add a Shape");
    bis_warn(diag, bis_cli_loc, "the picture is black: the camera sees no shape, and no light behind them. %s", where);
}
