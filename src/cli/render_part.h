/* SPDX-License-Identifier: BSD-2-Clause */
/* render_part: `bis render --part K/N`: which commands may have it, and the file that it writes in place of a picture.
 */
#pragma once

#include "render/part.h"
#include "render_files.h"

typedef struct bis_render_part {
    bis_part share; /* n is 0: the whole picture, of which bis_render_part_name and bis_render_part_check ask nothing */
    char command[BIS_PART_COMMAND]; /* see bis_render_part_keep_command */
} bis_render_part;

/* bis_render_part_read is the `read` of the option, whose value is bis_part. "2/5": the second of five. */
bool bis_render_part_read(void *value, const char *text);

/* bis_render_part_keep_command writes the command that makes the same part of a picture, or another one: all but --part
 * and the files of one part. */
void bis_render_part_keep_command(char command[BIS_PART_COMMAND], int argc, char **argv);

/* bis_render_part_name moves the one output from files->pictures to files->part. Errors: BIS_INPUT (it is none, or not
 * named as a part). */
bis_status bis_render_part_name(bis_part share, bis_render_files *files, bis_diag *diag);

/* bis_render_part_check refuses what needs the whole picture, because it would make another picture of its parts.
 * Errors: BIS_INPUT. */
bis_status bis_render_part_check(bis_part share, const bis_budget *budget, bis_diag *diag);

/* bis_render_part_write writes the sums of the part to files->part, unless the render was interrupted; says which. c is
 * the checkpoint of the render. Errors: those of bis_part_write. */
bis_status bis_render_part_write(const bis_render_part *part, const bis_render_files *files, const bis_checkpoint *c,
                                 bis_film *film, const bis_stats *stats, bool quiet, bis_diag *diag);
