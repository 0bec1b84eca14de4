/* SPDX-License-Identifier: BSD-2-Clause */
/* render_files: the files that `bis render` writes: checked before the render, written after it. */
#pragma once

#include "cli.h"
#include "tools/describe.h"

typedef struct bis_render_files {
    bis_texts pictures; /* paths; the ending tells the format */
    const char *part;   /* path of the sums of a part, in place of pictures; NULL: none */
    const char *stats;  /* path of the JSON, "-": standard output; NULL: none */
    const char *checkpoint, *resume; /* paths; NULL: none */
    bool has_exposure;
    double exposure; /* of a PNG, in stops */
} bis_render_files;

/* bis_render_files_check tries whether all files can be written. Errors: BIS_INPUT for an unknown ending, those of
 * bis_cli_check_writable. */
bis_status bis_render_files_check(const bis_render_files *files, bis_diag *diag);

/* bis_render_files_warn_of_alpha warns of each output whose format has no alpha, because --transparent asks for it. */
void bis_render_files_warn_of_alpha(const bis_texts *outfiles, bis_diag *diag);

/* bis_render_files_check_distinct refuses an output that is the scene, one of its meshes, its map, or another output.
 * It warns if layers are asked for and no picture is an .exr. Errors: BIS_INPUT, BIS_NOMEM. */
bis_status bis_render_files_check_distinct(const bis_render_files *files, const bis_scene_desc *desc, bis_diag *diag);

/* bis_render_files_write_pictures writes all pictures. It tries each file even if one fails, because hours of rendering
 * should end up somewhere; *written receives the paths that were written, *exposure that of a PNG, in EV (NAN: none was
 * written), the status is that of the first failure. */
bis_status bis_render_files_write_pictures(bis_texts *written, double *exposure, const bis_render_files *files,
                                           const bis_stats *stats, bis_diag *diag);

/* bis_render_files_write_stats writes the JSON of --stats, if it is asked for. Errors: BIS_IO. */
bis_status bis_render_files_write_stats(const bis_render_files *files, const bis_stats *stats, bis_diag *diag);

/* bis_render_files_why_unknown returns the reason, as words, why an error is not known. */
const char *bis_render_files_why_unknown(const bis_film_error *error);

/* bis_render_files_print_result prints one line to standard error: what was written, camera samples, passes, time,
 * error, and the exposure that bis_render_files_write_pictures stored. */
void bis_render_files_print_result(const bis_texts *written, double exposure, const bis_stats *stats);

/* bis_render_files_warn_of_counts warns if there were estimates that are not finite, or light beside all portals. */
void bis_render_files_warn_of_counts(const bis_counters *counters, bis_diag *diag);

/* bis_render_files_warn_of_black warns if every pixel is black, and says what can be done: where the camera sees no
 * shape, it names a LookAt that sees all of them, in the direction of the scene's camera. For after a pass. */
void bis_render_files_warn_of_black(const bis_film *film, const bis_scene *scene, const bis_camera *camera,
                                    bis_diag *diag);
